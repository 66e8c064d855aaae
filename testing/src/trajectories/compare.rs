//! Differences between runs on the hull and their references, and the figures made of them.

use super::reference::Reference;
use super::stage::{Ends, Scene, State, Support, run, run_for};
use ode_visual_hull::ode::Shape;

/// RMS distance between body centres over the reference's rows, for the worst body, in pixels of the rig.
pub fn rms_px(reference: &Reference, states: &[Vec<State>]) -> f64 {
    let bodies = reference.rows[0].1.len();
    let mean_square = |body: usize| {
        let squares = reference.rows.iter().map(|(k, poses)| {
            let here = states[*k][body].pose.translation.vector;
            (here - poses[body].translation.vector).norm_squared()
        });
        squares.sum::<f64>() / reference.rows.len() as f64
    };
    (0..bodies).map(mean_square).fold(0.0, f64::max).sqrt() / reference.pixel
}

/// The largest distance between body centres in any row, in pixels of the rig.
pub fn distance_px(reference: &Reference, states: &[Vec<State>]) -> f64 {
    let distances = reference.rows.iter().flat_map(|(k, poses)| {
        let pairs = poses.iter().zip(&states[*k]);
        pairs.map(|(pose, state)| (pose.translation.vector - state.pose.translation.vector).norm())
    });
    distances.fold(0.0, f64::max) / reference.pixel
}

/// The speed of a body that rolls on the hull.
pub struct Rolled {
    /// `sphere` or `cylinder`.
    pub shape: &'static str,
    /// Its speed in the direction of the body on ODE's box, divided by that body's speed, at the end of the scene.
    pub over_native: f64,
}

/// The relative speed in a scene in which a sphere or a cylinder rolls; `None` for other scenes.
pub fn rolled(scene: &Scene) -> Option<Rolled> {
    let shape = match scene.bodies[..] {
        _ if scene.ends != Ends::OffSupport => return None,
        [ref body] => match body.shape {
            Shape::Sphere { .. } => "sphere",
            Shape::Cylinder { .. } => "cylinder",
            _ => return None,
        },
        _ => return None,
    };

    let native = run(scene, Support::Native);
    let hull = run_for(scene, Support::Hull, native.last);
    let (on_hull, on_box) = (&hull[native.last][0].velocity, &native.states[native.last][0].velocity);

    Some(Rolled { shape, over_native: on_hull.dot(on_box) / on_box.norm_squared() })
}

/// The figures of all scenes. `progress` is called with the name of each scene.
///
/// - `trajectory_<scene>_px` of every scene, and the largest of them as `trajectory_worst_px`, or as
///   `trajectory_edge_first_px` for scenes in which a body falls on an edge;
/// - `rolling_speed_over_native_sphere` and `_cylinder`: the speeds farthest from 1, and the farther of the two without
///   suffix.
pub fn figures(progress: &dyn Fn(&str)) -> Vec<(String, f64)> {
    let mut figures = Vec::new();
    let (mut worst, mut edge_first) = (0.0, 0.0);
    let mut rolling: [(&str, f64); 2] = [("sphere", 1.0), ("cylinder", 1.0)];

    for scene in &super::all() {
        progress(scene.name);

        let reference = Reference::read(scene);
        let rms = rms_px(&reference, &run_for(scene, Support::Hull, reference.last()));
        figures.push((format!("trajectory_{}_px", scene.name), rms));
        let largest = if scene.edge_first { &mut edge_first } else { &mut worst };
        *largest = f64::max(*largest, rms);

        if let Some(Rolled { shape, over_native }) = rolled(scene) {
            let kept = rolling.iter_mut().find(|(name, _)| *name == shape);
            kept.into_iter().for_each(|(_, kept)| *kept = farther_from_one(*kept, over_native));
        }
    }

    figures.push(("trajectory_worst_px".into(), worst));
    figures.push(("trajectory_edge_first_px".into(), edge_first));
    for (shape, over_native) in rolling {
        figures.push((format!("rolling_speed_over_native_{shape}"), over_native));
    }
    let [(_, sphere), (_, cylinder)] = rolling;
    figures.push(("rolling_speed_over_native".into(), farther_from_one(sphere, cylinder)));

    figures
}

fn farther_from_one(a: f64, b: f64) -> f64 {
    if (b - 1.0).abs() > (a - 1.0).abs() { b } else { a }
}
