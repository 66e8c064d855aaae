//! Surfaces and masses that are no surfaces and masses, and masses that differ a lot.

use super::*;
use ode_visual_hull::ode::{Amount, Mass, Surface};

#[test]
fn negative_or_nan_friction_and_bounce_are_refused_by_name() {
    with_table_kept(|data| {
        let (mut world, body) = drop_box_on(data);
        // Into the table, so that there are contacts to attach.
        world.body_mut(body).set_pose(&at(0.0, 0.0, TOP + 0.099)).unwrap();
        let plain = Surface::default();
        for bad in [-0.1, f64::NAN, f64::NEG_INFINITY] {
            let found = format!("found {bad}");
            for (name, surface) in [
                ("mu:", Surface { mu: bad, ..plain }),
                ("bounce:", Surface { bounce: Some(bad), ..plain }),
                ("bounce velocity:", Surface { bounce: Some(0.5), bounce_velocity: bad, ..plain }),
            ] {
                assert_says(world.default_collide(&surface, 8), &[name, "expected", &found]);
            }
        }
        // More than the full speed would add energy in each bounce.
        let gaining = Surface { bounce: Some(1.1), ..plain };
        assert_says(world.default_collide(&gaining, 8), &["bounce:", "from 0 to 1", "found 1.1"]);

        // The world remains usable.
        for _ in 0..20 {
            step(&mut world, 0.005);
            assert_finite(&world, body);
        }
    });
}

#[test]
fn a_mass_that_is_not_positive_is_refused() {
    for none in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let found = format!("found {none}");
        for amount in [Amount::Total(none), Amount::Density(none)] {
            assert_says(Mass::of(&cube(0.1), amount), &["expected a positive, finite number", &found]);
        }
        let inertia = Matrix3::identity();
        assert_says(Mass::new(none, Point3::origin(), inertia), &["expected a positive, finite", &found]);
    }
}

#[test]
fn a_gram_and_a_thousand_tons_rest_beside_each_other_and_on_each_other() {
    let data = table();
    let mut world = world(SpaceKind::default());
    // ODE's own: a force yields by the CFM times itself, and 1e7 N by 1e-5 would be 100 m/s.
    world.set_cfm(1e-10).unwrap();
    let root = world.root_space();
    world.add_hull(root, &data).unwrap();
    let add = |world: &mut World, kilograms: f64, x: f64, z: f64| {
        add_body_of(world, &cube(0.1), Amount::Total(kilograms), &at(x, 0.02, TOP + z)).0
    };
    let bodies = [
        add(&mut world, 1e-3, -0.1, 0.06),
        add(&mut world, 1e6, 0.1, 0.06),
        add(&mut world, 1e-3, 0.1, 0.17),
    ];

    for _ in 0..400 {
        step(&mut world, 0.005);
        bodies.iter().for_each(|&body| assert_finite(&world, body));
    }
    for (body, expected) in bodies.into_iter().zip([0.05, 0.05, 0.15]) {
        // The surface layer, 1 mm a contact, and the edges of the silhouettes, a third of a pixel.
        let off = height(&world, body) - TOP - expected;
        assert!(off.abs() < 0.002 + PIXEL / 3.0, "rests {off} m off");
    }
}
