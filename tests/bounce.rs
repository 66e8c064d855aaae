//! Restitution on a hull where a body touches at several points, some of which part from the hull already.

use nalgebra::{UnitQuaternion, Vector3, vector};
use ode_visual_hull::ode::{BodyId, Shape, SpaceKind, Surface, World};
use ode_visual_hull_testing::random::Random;
use ode_visual_hull_testing::scene::*;
use ode_visual_hull_testing::world::*;

const STEP: f64 = 1.0 / 240.0;

/// The coefficient of restitution.
const E: f64 = 0.9;

/// A surface without friction.
fn rubber() -> Surface {
    Surface { bounce: Some(E), bounce_velocity: 0.1, ..Surface::with_friction(0.0) }
}

/// A world with the hull of the table, and a cube that is a millimetre deep in its top.
fn touching() -> (World, BodyId) {
    let mut world = world(SpaceKind::default());
    let root = world.root_space();
    world.add_hull(root, &table()).unwrap();
    let (body, _) = add_body(&mut world, &cube(0.2), &at(0.01, 0.02, TOP + 0.099));
    (world, body)
}

/// The normal velocities of all contacts of the cube at this velocity.
fn normal_velocities(velocity: Vector3<f64>) -> Vec<Option<f64>> {
    let (mut world, body) = touching();
    world.body_mut(body).set_linear_velocity(&velocity).unwrap();
    let mut found = Vec::new();
    let collided = world.collide(|pair| {
        let contacts = pair.contacts(8);
        found.extend(contacts.iter().map(|at| pair.surface_at(at, &rubber(), STEP).normal_velocity));
    });
    collided.unwrap();
    assert!(!found.is_empty());
    found
}

#[test]
fn a_contact_that_parts_may_come_back_by_the_coefficient_of_restitution() {
    for found in normal_velocities(vector![0.2, 0.0, 0.5]) {
        // The hull's normals are exact to two degrees.
        assert!((found.expect("a normal velocity") + E * 0.5).abs() < 0.2 * 2_f64.to_radians() + 1e-3);
    }
    // Towards the hull, and no faster than what bounces.
    assert!(normal_velocities(vector![0.2, 0.0, -0.5]).iter().all(Option::is_none));
    assert!(normal_velocities(vector![0.0, 0.0, 0.05]).iter().all(Option::is_none));
}

/// The energy of a box of 1 kg without gravity, in joules.
fn energy(world: &World, body: BodyId) -> f64 {
    let body = world.body(body);
    let spin = body.pose().rotation.inverse() * body.angular_velocity();
    0.5 * (body.mass().total() * body.linear_velocity().norm_squared()
        + spin.dot(&(body.mass().inertia() * spin)))
}

#[test]
fn a_box_that_meets_an_edge_while_it_turns_gains_no_energy_without_friction() {
    let mut random = Random(5);
    for _ in 0..200 {
        let (mut world, _) = touching();
        world.set_gravity(&Vector3::zeros()).unwrap();
        world.set_erp(0.0).unwrap();
        let pose = at(0.25, random.between(-0.1, 0.1), TOP) * random.rotation();
        let (body, geom) = add_body(&mut world, &Shape::cuboid(0.1, 0.06, 0.14), &pose);
        world.geom_mut(geom).set_category_bits(2);
        world.body_mut(body).set_linear_velocity(&(random.direction() * random.between(0.0, 2.0))).unwrap();
        world.body_mut(body).set_angular_velocity(&(random.direction() * random.between(0.0, 20.0))).unwrap();
        let before = energy(&world, body);
        world.default_collide(&rubber(), 8).unwrap();
        world.step(STEP).unwrap();
        let gained = energy(&world, body) / before - 1.0;
        assert!(gained < 1e-6, "{gained}");
    }
}

/// The energy that a box gains, as a part of what it had, where one corner meets the top of the table, and how fast that
/// corner parts, as a part of the speed at which it came.
fn gain_at_a_corner(turned: UnitQuaternion<f64>, velocity: Vector3<f64>, mu: f64) -> (f64, f64) {
    let mut world = world(SpaceKind::default());
    world.set_gravity(&Vector3::zeros()).unwrap();
    world.set_erp(0.0).unwrap();
    let root = world.root_space();
    world.add_hull(root, &table()).unwrap();
    let shape = Shape::cuboid(0.1, 0.06, 0.14);
    let corners = (0..8_u8).map(|k| {
        let side = |bit: u8, half: f64| if k & bit == 0 { half } else { -half };
        turned * vector![side(1, 0.05), side(2, 0.03), side(4, 0.07)]
    });
    let corner = corners.min_by(|a, b| a.z.total_cmp(&b.z)).unwrap();
    let (body, _) = add_body(&mut world, &shape, &(at(0.0, 0.0, TOP - 0.002 - corner.z) * turned));
    world.body_mut(body).set_linear_velocity(&velocity).unwrap();
    let before = energy(&world, body);
    world.default_collide(&Surface { mu, ..rubber() }, 8).unwrap();
    world.step(STEP).unwrap();
    let of_corner = world.body(body).linear_velocity() + world.body(body).angular_velocity().cross(&corner);
    (energy(&world, body) / before - 1.0, of_corner.z / -velocity.z)
}

#[test]
fn a_corner_that_sticks_while_it_bounces_adds_no_energy_and_others_keep_their_restitution() {
    let mut random = Random(6);
    let mut kept = 0;
    for _ in 0..300 {
        let velocity = vector![random.between(-3.0, 3.0), random.between(-3.0, 3.0), -1.0];
        let (gained, restitution) = gain_at_a_corner(random.rotation(), velocity, random.between(0.0, 1.0));
        // Rounding.
        assert!(gained < 1e-9, "{velocity:?}: {gained}");
        kept += u32::from((restitution - E).abs() < 0.01);
    }
    assert!(kept > 200, "{kept}");
}
