//! Differences between the motion of bodies on the hull of a box and on ODE's own box, and the speed of rolling, in the
//! scenes of the tests.

use ode_visual_hull_testing::figure::{
    Bound::{AtMost, Between},
    Figure,
};

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let figure = |(name, value): (String, f64)| {
        let bound = match name.as_str() {
            "trajectory_worst_px" => Some(AtMost(2.0)),
            "trajectory_edge_first_px" => Some(AtMost(4.0)),
            "rolling_speed_over_native" => Some(Between(0.97, 1.03)),
            _ => None,
        };
        Figure { name, value, bound }
    };
    ode_visual_hull_testing::trajectories::compare::figures(progress).into_iter().map(figure).collect()
}
