//! The energy that random bodies gain where they fall on the table.

use super::{Ground, beside_native, bouncing};
use crate::studio::*;
use nalgebra::{Isometry3, Point3, Vector3};
use ode_visual_hull::ode::{BodyId, Shape, World};
use ode_visual_hull::shape::Convex;
use ode_visual_hull_testing::figure::Figure;
use ode_visual_hull_testing::random::Random;
use ode_visual_hull_testing::world::add_body;
use std::sync::Arc;

/// Number of drops in a batch, of which each world holds [`TOGETHER`] that do not touch one another.
const DROPS: usize = 10_000;
const TOGETHER: usize = 50;

/// Number of batches, since the largest gain of one rests on a few rare drops.
const BATCHES: u64 = 10;

/// Steps a second, in turns.
const RATES: [f64; 3] = [60.0, 120.0, 240.0];

/// How long a drop lasts, in seconds: bodies fall for a third of a second and bounce once or twice.
const SECONDS: f64 = 0.8;

/// The largest coefficient of restitution.
const MAX_RESTITUTION: f64 = 0.9;

/// A body before it falls.
#[derive(Debug, Clone)]
struct Drop {
    shape: Shape,
    pose: Isometry3<f64>,
    velocity: Vector3<f64>,
    spin: Vector3<f64>,
    mu: f64,
    restitution: f64,
}

/// The largest gain of energy on the hull and on ODE's box, over all batches and as the median of the batches, and the
/// shares of the drops that gain more than a hundredth: on the hull impacts at several points with friction, of which
/// each alone would add nothing.
pub fn figures(grounds: &[Ground; 2], progress: &dyn Fn(&str)) -> Vec<Figure> {
    let mut largest: [Vec<f64>; 2] = Default::default();
    let mut share = [0.0; 2];
    for batch in 0..BATCHES {
        progress(&format!("the energy of {DROPS} drops, {} of {BATCHES}", batch + 1));
        for (k, ground) in grounds.iter().enumerate() {
            let gains = gains(ground, batch);
            largest[k].push(gains.iter().copied().fold(0.0, f64::max));
            let all = (DROPS as u64 * BATCHES) as f64;
            share[k] += gains.iter().filter(|&&gain| gain > 0.01).count() as f64 / all;
        }
    }

    largest.iter_mut().for_each(|largest| largest.sort_by(f64::total_cmp));
    let of_all = largest.each_ref().map(|largest| largest[largest.len() - 1]);
    let median = largest.each_ref().map(|largest| largest[largest.len() / 2]);
    let mut figures = Vec::from(beside_native("energy_gain_max", of_all, 0.0));
    figures.extend(beside_native("energy_gain_max_median", median, 0.0));
    let names = ["energy_gain_share", "energy_gain_share_native"];
    figures.extend(names.iter().zip(share).map(|(name, share)| Figure::reported(name, share)));
    figures
}

/// The largest relative gain of the energy of each drop of a batch.
fn gains(ground: &Ground, batch: u64) -> Vec<f64> {
    let mut random = Random(11 + batch);
    let worlds = (0..DROPS / TOGETHER).flat_map(|world| {
        let drops: Vec<Drop> = (0..TOGETHER).map(|_| random_drop(&mut random)).collect();
        gains_of(ground, &drops, RATES[world % RATES.len()])
    });
    worlds.collect()
}

/// The largest relative gain of each of `drops`, which fall through one another.
fn gains_of(ground: &Ground, drops: &[Drop], rate: f64) -> Vec<f64> {
    let mut world = ground.world();
    let bodies: Vec<BodyId> = drops.iter().map(|drop| add(&mut world, drop)).collect();
    let energies = |world: &World| -> Vec<f64> { bodies.iter().map(|&body| energy(world, body)).collect() };

    let at_start = energies(&world);
    let mut gains = vec![0.0_f64; drops.len()];
    let mut has_touched = vec![false; drops.len()];
    for _ in 0..(SECONDS * rate) as usize {
        let mut seen = vec![String::new(); drops.len()];
        let collided = world.collide(|pair| {
            let body = pair.bodies().into_iter().flatten().next().expect("the ground has no pair of its own");
            let drop = bodies.iter().position(|&other| other == body).expect("a body of this world");
            let contacts = pair.contacts(8);
            has_touched[drop] |= !contacts.is_empty();
            for contact in contacts.iter() {
                let b = pair.body(body).unwrap();
                let v = b.linear_velocity() + b.angular_velocity().cross(&(contact.position - b.position()));
                seen[drop] += &format!(
                    "\n    p {:.3?} n {:.3?} d {:.4} v {:.2?}",
                    contact.position.coords.data.0, contact.normal.data.0, contact.depth, v.data.0
                );
                let surface = bouncing(drops[drop].mu, drops[drop].restitution);
                pair.attach(contact, &pair.surface_at(contact, &surface, 1.0 / rate));
            }
        });
        collided.expect("valid contacts");
        world.step(1.0 / rate).expect("finite states");

        for (drop, energy) in energies(&world).into_iter().enumerate() {
            if has_touched[drop] {
                let g = energy / at_start[drop] - 1.0;
                if g > gains[drop].max(0.03) {
                    eprintln!(
                        "{} rate {rate} gain {g:.4}: {:?} mu {:.2} e {:.2} {}",
                        if matches!(ground, Ground::Native) { "native" } else { "hull" },
                        drops[drop].shape,
                        drops[drop].mu,
                        drops[drop].restitution,
                        seen[drop]
                    );
                }
                gains[drop] = gains[drop].max(energy / at_start[drop] - 1.0);
            }
        }
    }
    gains
}

/// Adds the body of a drop, which collides with the ground alone.
fn add(world: &mut World, drop: &Drop) -> BodyId {
    const GROUND: u32 = 1;
    const BODIES: u32 = 2;
    let ground = world.geoms().next().expect("the ground comes first");
    world.geom_mut(ground).set_category_bits(GROUND);
    let (body, geom) = add_body(world, &drop.shape, &drop.pose);
    world.geom_mut(geom).set_category_bits(BODIES);
    world.geom_mut(geom).set_collide_bits(GROUND);
    let mut view = world.body_mut(body);
    view.set_linear_velocity(&drop.velocity).expect("finite");
    view.set_angular_velocity(&drop.spin).expect("finite");
    body
}

/// The energy of a body's motion and of its height above the table's top, in joules.
fn energy(world: &World, body: BodyId) -> f64 {
    let body = world.body(body);
    let (mass, spin) = (body.mass(), body.pose().rotation.inverse() * body.angular_velocity());
    let of_motion =
        0.5 * (mass.total() * body.linear_velocity().norm_squared() + spin.dot(&(mass.inertia() * spin)));
    of_motion + mass.total() * 9.81 * (body.position().z - TOP)
}

/// A random body above the table.
fn random_drop(random: &mut Random) -> Drop {
    let shape = random_shape(random);
    let reach = 0.15;
    let height = TOP + reach + random.between(0.0, 0.5);
    let place = Point3::new(random.between(-0.25, 0.25), random.between(-0.25, 0.25), height);
    Drop {
        shape,
        pose: Isometry3::from_parts(place.into(), random.rotation()),
        velocity: random.direction() * random.between(0.0, 0.5),
        spin: random.direction() * random.between(0.0, 5.0),
        mu: random.between(0.0, 1.0),
        restitution: random.between(0.0, MAX_RESTITUTION),
    }
}

/// A random shape of 6 to 30 cm.
fn random_shape(random: &mut Random) -> Shape {
    let radius = random.between(0.03, 0.06);
    match random.below(5) {
        0 => Shape::Sphere { radius },
        1 => Shape::Capsule { radius, length: random.between(0.02, 0.15) },
        2 => Shape::Cylinder { radius, length: random.between(0.06, 0.2) },
        3 => Shape::Convex(Arc::new(octahedron([0; 3].map(|_| random.between(0.04, 0.1))))),
        _ => Shape::Box { sides: Vector3::from_fn(|_, _| random.between(0.05, 0.15)) },
    }
}

/// The octahedron with these distances of its corners from the centre, in metres.
fn octahedron([x, y, z]: [f64; 3]) -> Convex {
    let corners =
        [[x, 0.0, 0.0], [-x, 0.0, 0.0], [0.0, y, 0.0], [0.0, -y, 0.0], [0.0, 0.0, z], [0.0, 0.0, -z]];
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let faces = faces.map(|face| face.to_vec());
    Convex::new(corners.map(|[x, y, z]| Point3::new(x, y, z)).to_vec(), &faces).expect("a convex solid")
}
