//! Bodies on the hull of a box move as they do on ODE's own box.
//!
//! The references in `tests/trajectories/*.csv` were recorded from ODE's own geoms. To record them anew:
//!
//! ```text
//! RECORD_TRAJECTORIES=1 cargo test --release --test trajectories
//! ```

use nalgebra::{Point3, Vector3, point};
use ode_visual_hull::camera::Ray;
use ode_visual_hull::hull::EdgeModel;
use ode_visual_hull_testing::random::Random;
use ode_visual_hull_testing::trajectories::compare::{Rolled, distance_px, rms_px, rolled};
use ode_visual_hull_testing::trajectories::reference::{Reference, tolerance_px};
use ode_visual_hull_testing::trajectories::rig::{RAMP, Rig, TABLE};
use ode_visual_hull_testing::trajectories::stage::{Ends, Scene, Support, run, run_for};
use ode_visual_hull_testing::trajectories::{self};
use std::sync::LazyLock;

/// All scenes. If `RECORD_TRAJECTORIES` is set, their references are recorded anew.
static SCENES: LazyLock<Vec<Scene>> = LazyLock::new(|| {
    let scenes = trajectories::all();
    if std::env::var_os("RECORD_TRAJECTORIES").is_some() {
        for scene in &scenes {
            let native = run(scene, Support::Native);
            Reference::of(scene, &native).write(scene, &native);
        }
    }
    scenes
});

#[test]
fn bodies_on_the_hull_follow_those_on_odes_box() {
    let mut missed = Vec::new();
    for scene in SCENES.iter() {
        let reference = Reference::read(scene);
        assert_eq!(reference.tolerance_px, tolerance_px(scene), "{}: the file's tolerance", scene.name);
        assert!((reference.pixel - scene.rig.pixel()).abs() < 1e-9, "{}: the file's pixel", scene.name);

        let hull = run_for(scene, Support::Hull, reference.last());
        let rms = rms_px(&reference, &hull);
        if rms > reference.tolerance_px {
            missed.push(format!("{} by {rms:.2} px of {}", scene.name, reference.tolerance_px));
        }
    }
    assert!(missed.is_empty(), "off their references: {missed:#?}");
}

#[test]
fn the_references_match_new_runs_on_odes_box() {
    for scene in SCENES.iter() {
        let reference = Reference::read(scene);
        let native = run(scene, Support::Native);
        assert_eq!(native.last, reference.last(), "{}: ends with the same step", scene.name);
        // The files have twelve decimals.
        let worst = distance_px(&reference, &native.states) * reference.pixel;
        assert!(worst < 1e-9, "{}: {worst} m from its file", scene.name);

        for (k, poses) in &reference.rows {
            for (pose, state) in poses.iter().zip(&native.states[*k]) {
                assert!(pose.rotation.angle_to(&state.pose.rotation) < 1e-7, "{}: turned", scene.name);
            }
        }
    }
}

#[test]
fn spheres_and_lying_cylinders_roll_at_the_native_speed() {
    for scene in SCENES.iter() {
        let Some(Rolled { shape, over_native }) = rolled(scene) else { continue };
        assert!((0.97..=1.03).contains(&over_native), "{} ({shape}): {over_native}", scene.name);
    }
}

#[test]
fn the_scenes_cover_all_kinds_of_contact() {
    let ends = |wanted: Ends| SCENES.iter().filter(|scene| scene.ends == wanted).count();
    assert!(ends(Ends::AtRest) >= 10 && ends(Ends::OffSupport) >= 5);
    assert!(SCENES.iter().filter(|scene| scene.edge_first).count() >= 3);
    assert!(
        SCENES.iter().any(|scene| scene.bodies.len() >= 3)
            && SCENES.iter().any(|scene| scene.joint.is_some())
    );
}

/// The five faces that a body may touch, as axis and side: all but the underside.
const FACES: [(usize, f64); 5] = [(2, 1.0), (0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)];

/// A random point near a face, in the box's frame: 1e-6 to 0.1 m from the face's plane, above the underside, and up to
/// 20 % beyond the face's edges.
fn near_face(rig: &Rig, (axis, side): (usize, f64), random: &mut Random) -> Point3<f64> {
    let half = rig.lengths / 2.0;
    let mut p = Vector3::from_fn(|i, _| 1.2 * half[i] * random.between(-1.0, 1.0));
    // Above the underside, which no camera sees.
    p.z = p.z.max(-0.99 * half.z);
    let off = 10f64.powf(random.between(-6.0, -1.0));
    p[axis] = side * half[axis] + off.copysign(random.between(-1.0, 1.0));
    p.into()
}

#[test]
fn the_exact_hull_of_the_box_equals_the_box_at_every_face_that_is_touched() {
    // Exact silhouettes, without pixels: a point is inside their hull iff the half-line of each camera through it hits
    // the box.
    for rig in [&*TABLE, &*RAMP] {
        let placed = rig.placed();
        let mut random = Random(7);
        let mut inside = 0;
        for face in FACES {
            for _ in 0..4000 {
                let p = rig.world_from_box * near_face(rig, face, &mut random);
                let in_hull = rig.cameras.iter().all(|camera| {
                    let direction = (p - camera.centre()).normalize();
                    placed.is_hit(&Ray { origin: camera.centre(), direction })
                });
                assert_eq!(in_hull, placed.contains(&p), "{}: {p}", rig.name);
                inside += usize::from(in_hull);
            }
        }
        assert!((4000..16000).contains(&inside), "points on both sides: {inside}");
    }
}

#[test]
fn every_camera_sees_the_whole_box() {
    for rig in [&*TABLE, &*RAMP] {
        for camera in &rig.cameras {
            for corner in 0..8 {
                let sign = |bit: i32| f64::from(corner >> bit & 1) - 0.5;
                let p = point![sign(0) * rig.lengths.x, sign(1) * rig.lengths.y, sign(2) * rig.lengths.z];
                let pixel = camera.project(&(rig.world_from_box * p)).expect("in front");
                let (width, height) = camera.size();
                // The window of the contact normal reaches six pixels.
                assert!(pixel.u > 7.0 && pixel.u < f64::from(width) - 7.0, "{}: {pixel:?}", rig.name);
                assert!(pixel.v > 7.0 && pixel.v < f64::from(height) - 7.0, "{}: {pixel:?}", rig.name);
            }
        }
    }
}

#[test]
fn the_hull_from_pixels_ends_where_the_box_does() {
    // From points a centimetre inside each face, away from its edges, the exit is straight out. Coverage is exact to a
    // fifth of a pixel, and pixels at the far end of the ramp cover more than at its centre.
    for rig in [&*TABLE, &*RAMP] {
        let (_, hull) = rig.hull_data().latest().unwrap();
        let mut random = Random(9);
        for (axis, side) in FACES {
            for _ in 0..200 {
                let mut p = Vector3::from_fn(|i, _| 0.4 * rig.lengths[i] * random.between(-1.0, 1.0));
                p[axis] = side * (rig.lengths[axis] / 2.0 - 0.01);

                let mut out = Vector3::zeros();
                out[axis] = side;
                let exit = hull.exit(
                    &(rig.world_from_box * Point3::from(p)),
                    &(rig.world_from_box * out),
                    EdgeModel::Coverage,
                );

                let off = (exit - 0.01).abs() / rig.pixel();
                assert!(off < 0.25, "{} face {axis} {side}: {off} px at {p}", rig.name);
            }
        }
    }
}
