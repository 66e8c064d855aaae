//! Bodies on the hull of a box move as they do on ODE's own box.
//!
//! `tests/trajectories/*.csv` hold the native trajectories; each file says what happens in it, with which parameters,
//! and how far the hull may be off, in pixels of the rig. After a change of a scene they are recorded again with
//! `RECORD_TRAJECTORIES=1 cargo test --test trajectories`.

#[path = "trajectories/scenes.rs"]
mod scenes;

use nalgebra::{Point3, Vector3};
use ode_visual_hull::camera::Ray;
use scenes::compare::rms_px;
use scenes::reference::Reference;
use scenes::rig::{RAMP, Rig, TABLE};
use scenes::stage::{Support, run, run_for};

#[test]
fn the_reference_files_are_what_native_geoms_do() {
    for scene in scenes::all() {
        let native = run(&scene, Support::Native);
        let fresh = Reference::of(&scene, &native);
        if std::env::var_os("RECORD_TRAJECTORIES").is_some() {
            fresh.write(&scene, &native);
        }
        let file = Reference::read(&scene);
        assert_eq!(
            (file.tolerance_px, file.rows.len()),
            (fresh.tolerance_px, fresh.rows.len()),
            "{}",
            scene.name
        );
        assert!((file.pixel - fresh.pixel).abs() < 1e-12);
        for ((k, written), (fresh_k, poses)) in file.rows.iter().zip(&fresh.rows) {
            assert_eq!(k, fresh_k, "{}", scene.name);
            for (a, b) in written.iter().zip(poses) {
                // Twelve decimals are written.
                let off = (a.translation.vector - b.translation.vector).norm();
                assert!(
                    off < 1e-9 && a.rotation.angle_to(&b.rotation) < 1e-6,
                    "{} at step {k}: {off} m",
                    scene.name
                );
            }
        }
    }
}

#[test]
fn on_the_hull_bodies_follow_the_reference_files() {
    // A run of record writes the files; the two tests must not race for them.
    if std::env::var_os("RECORD_TRAJECTORIES").is_some() {
        return;
    }
    for scene in scenes::all() {
        let reference = Reference::read(&scene);
        let states = run_for(&scene, Support::Hull, reference.last());
        let off = rms_px(&reference, &states);
        println!("{:24} {off:.2} px of {} allowed", scene.name, reference.tolerance_px);
        assert!(off <= reference.tolerance_px, "{}: {off} px", scene.name);
    }
}

#[test]
fn the_hull_of_each_rig_is_its_box_where_bodies_touch_it() {
    for rig in [&*TABLE, &*RAMP] {
        let mut state = 1_u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for k in 0..5000 {
            // A point 1 micrometre inside or outside one of the five faces, the underside apart. Bodies touch the
            // upper half of the sides.
            let half = rig.lengths / 2.0;
            let mut p =
                Vector3::new(2.0 * unit() - 1.0, 2.0 * unit() - 1.0, unit()).component_mul(&(half * 0.999));
            let (axis, side) = [(2, 1.0), (0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)][k % 5];
            let inside = k % 2 == 0;
            p[axis] = side * (half[axis] + if inside { -1e-6 } else { 1e-6 });
            let found = is_in_analytic_hull(rig, &(rig.world_from_box * Point3::from(p)));
            assert_eq!(found, inside, "{} of the {}", p, rig.name);
        }
    }
}

/// Whether the half-lines from all cameras through `p` meet the box.
fn is_in_analytic_hull(rig: &Rig, p: &Point3<f64>) -> bool {
    let placed = rig.placed();
    rig.cameras.iter().all(|camera| {
        let origin = camera.centre();
        placed.is_hit(&Ray { origin, direction: (p - origin).normalize() })
    })
}
