//! The distance between runs on the hull and the references, and figures of it.

use super::reference::Reference;
use super::stage::{Ends, Scene, State, Support, run, run_for};
use ode_visual_hull::ode::Shape;

/// RMS over the reference's rows of the distance between body centres, of the worst body, in pixels of the rig.
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
    /// Its speed in the direction of the native body, divided by the native body's speed, at the end of the scene.
    pub over_native: f64,
}

/// The speeds of a scene in which a sphere or a cylinder rolls; `None` for the others.
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

/// `trajectory_<scene>_px` of every scene; `trajectory_worst_px` and `trajectory_edge_first_px`, the worst of them; and
/// `rolling_speed_over_native_sphere`, `_cylinder` and without either, those farthest from 1. `progress` takes the name of each
/// scene.
pub fn figures(progress: &dyn Fn(&str)) -> Vec<(String, f64)> {
    let mut figures = Vec::new();
    let (mut worst, mut edge_first) = (0.0, 0.0);
    let mut rolling: [(&str, f64); 2] = [("sphere", 1.0), ("cylinder", 1.0)];
    for scene in &super::all() {
        progress(scene.name);
        let reference = Reference::read(scene);
        let off = rms_px(&reference, &run_for(scene, Support::Hull, reference.last()));
        figures.push((format!("trajectory_{}_px", scene.name), off));
        let class = if scene.edge_first { &mut edge_first } else { &mut worst };
        *class = f64::max(*class, off);
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
