//! Whether bodies bounce off a hull as its surface says: how high they rise after an impact, whether they
//! gain energy, and whether their motion converges as steps get shorter; on the hull of a table and on ODE's
//! own box in its place.

mod drops;
mod time_steps;

use crate::studio::*;
use nalgebra::{Isometry3, UnitQuaternion};
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::{BodyId, Shape, Surface, World};
use ode_visual_hull_testing::figure::{Bound::AtMost, Figure};
use ode_visual_hull_testing::scene;
use ode_visual_hull_testing::world::add_body;
use std::sync::Arc;

/// Steps a second of the drops of the coefficient of restitution.
const RATES: [f64; 3] = [60.0, 240.0, 960.0];

/// Number of heights at each rate, spread over the way of one step at the impact, since how deep a body is at
/// its first contact depends on them.
const HEIGHTS: u32 = 16;

/// The least height of these drops, in metres.
const HEIGHT: f64 = 0.3;

/// By how much the error on a hull may exceed that on ODE's box, as a part of the drop's height.
const ALLOWED: f64 = 0.02;

/// What bodies fall on. Its top is at height [`TOP`].
#[derive(Debug, Clone)]
enum Ground {
    /// The hull of the table, from masks with coverage; but for its underside it is the table.
    Hull(Arc<HullData>),
    /// ODE's box.
    Native,
}

impl Ground {
    /// The hull and ODE's box.
    fn both() -> [Self; 2] {
        [Self::Hull(scene::table()), Self::Native]
    }

    /// A world with this ground.
    fn world(&self) -> World {
        let mut world = world(0, 0.001);
        let root = world.root_space();
        match self {
            Self::Hull(data) => world.add_hull(root, data).expect("room for the class"),
            Self::Native => world.add_geom(root, &Shape::Box { sides: TABLE }).expect("positive sizes"),
        };
        world
    }
}

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let grounds = Ground::both();
    let mut figures = Vec::new();
    let mut worst = [0.0_f64; 2];
    for rate in RATES {
        progress(&format!("heights after a bounce at {rate} Hz"));
        let errors = grounds.each_ref().map(|ground| restitution_error(ground, rate));
        figures.extend(beside_native(&format!("restitution_error_{rate}_hz"), errors, ALLOWED));
        worst = [0, 1].map(|k| worst[k].max(errors[k]));
    }
    figures.extend(beside_native("restitution_error", worst, ALLOWED));

    figures.extend(drops::figures(&grounds, progress));
    figures.extend(time_steps::figures(&grounds, progress));
    figures
}

/// A figure on the hull, which may exceed that on ODE's box by `allowed`, and the latter.
fn beside_native(name: &str, [hull, native]: [f64; 2], allowed: f64) -> [Figure; 2] {
    [
        Figure::bounded(name, hull, AtMost(native + allowed)),
        Figure::reported(&format!("{name}_native"), native),
    ]
}

/// A surface with friction and a coefficient of restitution.
fn bouncing(mu: f64, restitution: f64) -> Surface {
    Surface { bounce: Some(restitution), ..Surface::with_friction(mu) }
}

/// The largest difference between the height to which a body rises after its first impact, as a part of that
/// from which it fell, and the square of the coefficient of restitution: over coefficients from 0 to 1, a
/// ball, a cube that falls on its face, and heights.
fn restitution_error(ground: &Ground, rate: f64) -> f64 {
    let radius = 0.06;
    let turned = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.3);
    let way = (2.0 * 9.81 * HEIGHT).sqrt() / rate;
    let mut worst: f64 = 0.0;
    for shape in [Shape::Sphere { radius }, Shape::cube(2.0 * radius)] {
        for k in 0..HEIGHTS {
            let height = HEIGHT + way * f64::from(k) / f64::from(HEIGHTS);
            let start = at(0.03, -0.02, TOP + radius + height) * turned;
            for tenths in 0..=10 {
                let restitution = 0.1 * f64::from(tenths);
                let rise = rise(ground, &shape, &start, restitution, rate) - (TOP + radius);
                worst = worst.max((rise / height - restitution * restitution).abs());
            }
        }
    }
    worst
}

/// The largest height of the body's centre between its first impact and the moment when it falls again, in
/// metres.
fn rise(ground: &Ground, shape: &Shape, start: &Isometry3<f64>, restitution: f64, rate: f64) -> f64 {
    let mut world = ground.world();
    let (body, _) = add_body(&mut world, shape, start);
    let velocity = |world: &World, body: BodyId| world.body(body).linear_velocity().z;

    let (mut highest, mut before) = (f64::NEG_INFINITY, 0.0);
    for _ in 0..rate as usize {
        world.default_collide(&bouncing(0.5, restitution), 8).expect("a valid surface");
        world.step(1.0 / rate).expect("finite states");
        let now = velocity(&world, body);
        let has_hit = highest.is_finite() || now > before;
        if has_hit {
            highest = highest.max(world.body(body).position().z);
            if now <= 0.0 && before > 0.0 {
                break;
            }
        }
        before = now;
    }
    highest
}
