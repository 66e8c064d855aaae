//! Contacts that carry the velocity of a real surface, in both orders of the geoms and with a body on either side.

use nalgebra::{Isometry3, Vector3};
use ode_visual_hull::hull::{HullData, Motion};
use ode_visual_hull::ode::{BodyId, ContactGeom, GeomId, Ode, SpaceKind, Surface, SurfaceMotion, World};
use ode_visual_hull::synthetic::{Subject, layout};
use ode_visual_hull_testing::scene::{at, cuboid, data_with, show};
use ode_visual_hull_testing::world::{add_body, cube};
use std::sync::{Arc, LazyLock};

/// The velocity of the real cube: out of its front along x, and along the front in both directions.
const VELOCITY: Vector3<f64> = Vector3::new(0.5, 0.4, -0.3);

/// The side length of the real cube, in metres.
const SIDE: f64 = 0.3;

/// The side length of the virtual cube, in metres.
const OTHER: f64 = 0.2;

/// Seconds of a step.
const DT: f64 = 0.001;

/// Seconds from frame to frame.
const PERIOD: f64 = 1.0 / 30.0;

/// Three frames of the real cube, which reaches the origin at time 0.
fn moving_cube() -> Arc<HullData> {
    static DATA: LazyLock<Arc<HullData>> = LazyLock::new(|| {
        let lengths = Vector3::repeat(SIDE);
        let cameras = layout::face_on(lengths, &Isometry3::identity(), 2.8, 0.2, (320, 240), 0.45).unwrap();
        let data = data_with(&cameras);
        for time in [-2.0 * PERIOD, -PERIOD, 0.0] {
            let place = Isometry3::from(VELOCITY * time);
            show(&data, &cameras, &Subject::new(vec![cuboid(lengths, place)]), time);
        }
        data
    });
    DATA.clone()
}

/// Which geoms of the pair have a body, and in which order they are.
#[derive(Debug, Clone, Copy)]
struct Case {
    hull_has_body: bool,
    other_has_body: bool,
    is_hull_first: bool,
}

/// A hull of the moving cube and a virtual cube that is some depth in its front.
struct Scene {
    world: World,
    hull: GeomId,
    hull_body: Option<BodyId>,
    other_body: Option<BodyId>,
}

impl Scene {
    fn new(case: Case, depth: f64) -> Self {
        let mut world = World::with_space(&Ode::init().unwrap(), SpaceKind::Simple).unwrap();
        world.set_cfm(0.0).unwrap();
        let root = world.root_space();
        let other_pose = at(0.5 * (SIDE + OTHER) - depth, 0.0, 0.0);
        let add_other = |world: &mut World| {
            if case.other_has_body {
                return Some(add_body(world, &cube(OTHER), &other_pose).0);
            }
            let geom = world.add_geom(root, &cube(OTHER)).unwrap();
            world.geom_mut(geom).set_pose(&other_pose).unwrap();
            None
        };

        // The geom that was added last is the first of its pair.
        let before = if case.is_hull_first { add_other(&mut world) } else { None };
        let hull = world.add_hull(root, &moving_cube()).unwrap();
        let after = if case.is_hull_first { None } else { add_other(&mut world) };

        world.hull_mut(hull).set_motion(Motion::Predicted);
        world.hull_mut(hull).set_time(0.0).unwrap();
        let hull_body = case.hull_has_body.then(|| {
            let body = world.add_body();
            world.geom_mut(hull).set_body(Some(body)).unwrap();
            body
        });
        let other_body = before.or(after);

        // Along none of the surface's directions, so that slip and velocity have different directions.
        for (body, velocity) in [(hull_body, [0.1, 0.3, -0.6]), (other_body, [-0.1, 0.7, 0.2])] {
            if let Some(body) = body {
                world.body_mut(body).set_linear_velocity(&velocity.into()).unwrap();
            }
        }
        Self { world, hull, hull_body, other_body }
    }

    /// The velocity of a body's point; zero for the world.
    fn velocity(&self, body: Option<BodyId>, arm: &Vector3<f64>) -> Vector3<f64> {
        body.map_or_else(Vector3::zeros, |body| {
            let body = self.world.body(body);
            body.linear_velocity() + body.angular_velocity().cross(arm)
        })
    }
}

/// Calls `check` for each case in which ODE has a body to move.
fn for_each_case(mut check: impl FnMut(Case)) {
    for bits in 0..8 {
        let [hull_has_body, other_has_body, is_hull_first] = [1, 2, 4].map(|bit| bits & bit != 0);
        if hull_has_body || other_has_body {
            check(Case { hull_has_body, other_has_body, is_hull_first });
        }
    }
}

/// A contact, and what a step made of it.
struct Stepped {
    contact: ContactGeom,
    motion: SurfaceMotion,
    /// The velocity at which the two bodies part at the contact.
    parting: Vector3<f64>,
}

/// Attaches one contact of some depth that sticks and has no error correction, and steps once.
fn step_with_one_contact(case: Case, depth: f64) -> Stepped {
    let mut scene = Scene::new(case, depth);
    let hull = scene.hull;
    let sticky =
        Surface { soft_erp: Some(0.0), soft_cfm: Some(0.0), ..Surface::with_friction(f64::INFINITY) };

    let mut found = None;
    let collided = scene.world.collide(|pair| {
        assert_eq!(pair.geoms()[0] == hull, case.is_hull_first, "{case:?}");
        let contact = pair.contacts(1)[0];
        let motion = pair.surface_motion(&contact, DT).unwrap();
        pair.attach(&contact, &sticky.with_motion(&motion));
        found = Some((motion, contact));
    });
    collided.unwrap();
    let (motion, contact) = found.unwrap();

    // The bodies' arms before the step, at which ODE's equations hold.
    let [hull_arm, other_arm] = [scene.hull_body, scene.other_body].map(|body| {
        body.map_or_else(Vector3::zeros, |body| contact.position - scene.world.body(body).position())
    });
    scene.world.step(DT).unwrap();
    let parting = scene.velocity(scene.other_body, &other_arm) - scene.velocity(scene.hull_body, &hull_arm);
    Stepped { contact, motion, parting }
}

#[test]
fn a_body_in_contact_gets_the_velocity_of_the_surface_in_both_orders_of_the_geoms() {
    for_each_case(|case| {
        // Deeper than where a body takes on a part of the speed.
        let Stepped { motion, parting, .. } = step_with_one_contact(case, 0.01);
        // ODE solves the contact's three equations exactly, up to rounding.
        assert!((parting - motion.velocity).norm() < 1e-9, "{case:?}: {parting} of {motion:?}");
        // The mean error of a velocity from masks without noise is below a tenth.
        assert!((motion.velocity - VELOCITY).norm() < 0.1 * VELOCITY.norm(), "{case:?}: {motion:?}");
    });
}

#[test]
fn a_body_takes_on_the_speed_of_an_approaching_surface_in_proportion_to_its_depth_at_first() {
    for_each_case(|case| {
        let Stepped { contact, motion, .. } = step_with_one_contact(case, 0.005);
        let speed = (contact.normal.dot(&motion.velocity)).abs();
        assert!(contact.depth < 0.008 && motion.soft_depth == 0.016, "{case:?}: {motion:?}");
        let expected = contact.depth / 0.008 * speed;
        assert!((motion.normal_velocity - expected).abs() < 1e-12, "{case:?}: {motion:?}");
    });
}

#[test]
fn a_body_that_turns_gets_no_more_speed_at_its_centre_than_the_surface_has() {
    let case = Case { hull_has_body: false, other_has_body: true, is_hull_first: true };
    // The centre already moves as the surface does, and the point that touches lags behind, however the body turns.
    for spin in [-4.0, -1.0, 1.0, 4.0] {
        let mut scene = Scene::new(case, 0.005);
        let body = scene.other_body.unwrap();
        scene.world.body_mut(body).set_linear_velocity(&VELOCITY).unwrap();
        scene.world.body_mut(body).set_angular_velocity(&Vector3::new(0.0, spin, 2.0 * spin)).unwrap();

        let (mut surface, mut contacts) = (Vector3::zeros(), 0);
        let collided = scene.world.collide(|pair| {
            for contact in pair.contacts(8).iter() {
                let motion = pair.surface_motion(contact, DT).unwrap();
                (surface, contacts) = (motion.velocity, contacts + 1);
                pair.attach(contact, &Surface::with_friction(0.0).with_motion(&motion));
            }
        });
        collided.unwrap();
        scene.world.step(DT).unwrap();
        let speed = scene.world.body(body).linear_velocity().x;
        // The surface's normal is along x up to a few degrees.
        let most = surface.x.max(VELOCITY.x) * 1.005;
        assert!(contacts > 0 && speed <= most, "{speed} m/s of {most}, {contacts} contacts, spin {spin}");
    }
}
