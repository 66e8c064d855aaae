//! Bodies deep inside the hull, pierced by it, and held by it.

use crate::studio::*;
use nalgebra::{UnitQuaternion, Vector3, vector};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::ode::Shape;
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, coverage, layout};
use ode_visual_hull_testing::figure::{
    Bound::{AtLeast, AtMost},
    Figure,
};

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    progress("bodies inside, pierced and held");
    let arm = Placed::new(
        Solid::capsule(0.04, 0.8).expect("positive sizes"),
        at(0.0, 0.0, 0.0) * UnitQuaternion::from_euler_angles(0.0, std::f64::consts::FRAC_PI_2, 0.0),
        Texture::plain([210, 160, 130]),
    );
    let plate = cuboid(vector![0.8, 0.5, 0.03], at(0.0, 0.0, 0.0));

    let swallowed = exit_speed(&table(), 0.15, vector![0.03, 0.01, 0.0]);
    let pierced = exit_speed(&Subject::new(vec![arm]), 0.2, vector![0.0, 0.02, 0.01]);
    let cut = exit_speed(&Subject::new(vec![plate]), 0.2, vector![0.0, 0.0, 0.02]);

    vec![
        Figure::bounded("swallowed_exit_speed_m_s", swallowed.max(pierced).max(cut), AtMost(2.0)),
        Figure::reported("swallowed_exit_speed_m_s_inside", swallowed),
        Figure::reported("swallowed_exit_speed_m_s_arm", pierced),
        Figure::reported("swallowed_exit_speed_m_s_plate", cut),
        Figure::bounded("pinch_holds", f64::from(u8::from(pinch_holds())), AtLeast(1.0)),
    ]
}

/// Eight cameras around the origin, every other one at its height, of which two look through the gap between the hands.
/// Without such cameras, the hull bulges into the gap from both sides and would hold a body between two wedges.
fn cameras() -> Vec<Camera> {
    layout::staggered(8, 3.0, &[0.0, 1.0], ORIGIN, (640, 480), 0.5).expect("a ring")
}

/// The greatest speed, in m/s, within two seconds of a cube that appears at `place` inside `subject`, as the median
/// over seeds. There is no gravity, so that the hull alone accelerates the cube.
fn exit_speed(subject: &Subject, side: f64, place: Vector3<f64>) -> f64 {
    let cameras = cameras();
    let masks = masks(&cameras, subject, coverage);

    let once = |seed| {
        let data = data(&cameras);
        publish(&data, &masks, 0.0);
        let mut world = world(seed, 0.001);
        world.set_gravity(&Vector3::zeros()).expect("finite");
        let root = world.root_space();
        world.add_hull(root, &data).expect("room for the class");

        let cube = Shape::cuboid(side, side, side);
        let (body, _) = add_body(&mut world, &cube, &at(place.x, place.y, place.z));

        let mut fastest = 0.0_f64;
        for _ in 0..(2.0 / DT) as usize {
            step(&mut world);
            fastest = fastest.max(speed(&world, body));
        }
        fastest
    };
    median(SEEDS.map(once))
}

/// Whether two hands hold a box for three seconds, if the gap between them is 4 mm narrower than the box.
fn pinch_holds() -> bool {
    let width = 0.2;
    let hand =
        |side: f64| cuboid(vector![0.08, 0.12, 0.16], at(side * (0.5 * width + 0.04 - 0.002), 0.0, 0.0));
    let subject = Subject::new(vec![hand(-1.0), hand(1.0)]);
    let cameras = cameras();
    let masks = masks(&cameras, &subject, coverage);

    let holds = |seed| {
        let data = data(&cameras);
        publish(&data, &masks, 0.0);
        let mut world = world(seed, 0.0005);
        let root = world.root_space();
        world.add_hull(root, &data).expect("room for the class");
        let (body, _) = add_body(&mut world, &Shape::cuboid(width, 0.15, 0.15), &at(0.0, 0.0, 0.0));

        for _ in 0..(3.0 / DT) as usize {
            step(&mut world);
        }
        world.body(body).position().coords.norm() < 0.02
    };

    SEEDS.map(holds).filter(|&held| held).count() == SEEDS.count()
}
