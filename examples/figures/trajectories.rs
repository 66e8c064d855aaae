//! How near bodies on a hull stay to what they do on ODE's own box, and how fast they roll.

#[path = "../../tests/trajectories/scenes.rs"]
mod scenes;

use crate::figure::{
    Bound::{AtMost, Within},
    Figure,
};
use scenes::compare::rms_px;
use scenes::reference::Reference;
use scenes::stage::{Support, run, run_for};

pub fn measure(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let (mut worst, mut edge_first) = (0.0_f64, 0.0_f64);
    let mut figures = Vec::new();
    let mut rolling = Vec::new();
    for scene in scenes::all() {
        progress(scene.name);
        let native = run(&scene, Support::Native);
        let hull = run_for(&scene, Support::Hull, native.last);
        let off = rms_px(&Reference::of(&scene, &native), &hull);
        figures.push(Figure::reported(&format!("trajectory_{}_px", scene.name), off));
        let of_its_kind = if scene.edge_first { &mut edge_first } else { &mut worst };
        *of_its_kind = of_its_kind.max(off);
        let ratio = hull[native.last][0].velocity.norm() / native.states[native.last][0].velocity.norm();
        rolling.push((scene.name, ratio));
    }
    let farther_from_one = |a: f64, b: f64| if (b - 1.0).abs() > (a - 1.0).abs() { b } else { a };
    let slowest_or_fastest = |shape: &str| {
        let of_shape = rolling.iter().filter(|(name, _)| name.starts_with(&format!("{shape}_rolls")));
        of_shape.map(|&(_, ratio)| ratio).fold(1.0, farther_from_one)
    };
    let (sphere, cylinder) = (slowest_or_fastest("sphere"), slowest_or_fastest("cylinder"));
    figures.extend([
        Figure::asked("trajectory_worst_px", worst, AtMost(2.0)),
        Figure::asked("trajectory_edge_first_px", edge_first, AtMost(4.0)),
        Figure::asked("rolling_speed_over_native", farther_from_one(sphere, cylinder), Within(0.97, 1.03)),
        Figure::reported("rolling_speed_over_native_sphere", sphere),
        Figure::reported("rolling_speed_over_native_cylinder", cylinder),
    ]);
    figures
}
