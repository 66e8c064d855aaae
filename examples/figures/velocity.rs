//! The velocity of a real surface, from silhouettes of a board that moves in all directions.

use crate::studio::*;
use image::GrayImage;
use nalgebra::{Point3, UnitQuaternion, Vector3, vector};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{HullData, Motion};
use ode_visual_hull::synthetic::{Subject, coverage, layout};
use ode_visual_hull_testing::edge_noise::displace_edge;
use ode_visual_hull_testing::figure::{Bound::AtMost, Figure};
use std::sync::Arc;

/// The side lengths of the board.
const BOARD: Vector3<f64> = Vector3::new(0.04, 0.3, 0.3);

/// The last frame that is filmed; its middle lies at the origin.
const LAST: usize = 5;

/// Errors of the velocity at points of the board's surface.
#[derive(Debug, Default)]
struct Errors {
    /// Along the board's normal and in its plane, each over the true speed.
    normal: Vec<f64>,
    tangential: Vec<f64>,
    /// The number of points at which no velocity was found.
    unknown: usize,
}

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let mut figures = Vec::new();
    progress("the velocity of a board");
    let (mut clean, mut clean_along, mut unknown) = (Vec::new(), Vec::new(), 0);
    for speed in [0.5, 1.0, 2.0, 3.0] {
        for rate in [10.0, 30.0] {
            let across = errors(vector![speed, 0.0, 0.0], rate, 0.0);
            let along = errors(vector![0.0, 0.8 * speed, 0.6 * speed], rate, 0.0);
            unknown += across.unknown + along.unknown;
            clean.extend(across.normal);
            clean_along.extend(along.tangential);
        }
    }
    figures.push(Figure::bounded("velocity_error_mean", mean(&clean), AtMost(0.10)));
    figures.push(Figure::bounded("velocity_error_tangential_mean", mean(&clean_along), AtMost(0.15)));

    progress("the velocity of a board with 1 px of noise");
    let (mut slow, mut fast, mut along) = (Vec::new(), Vec::new(), Vec::new());
    for speed in [0.5, 1.0, 2.0, 3.0] {
        let errors_across = errors(vector![speed, 0.0, 0.0], 30.0, 1.0);
        let errors_along = errors(vector![0.0, 0.8 * speed, 0.6 * speed], 30.0, 1.0);
        if speed < 1.0 { &mut slow } else { &mut fast }.extend(errors_across.normal);
        unknown += errors_across.unknown + errors_along.unknown;
        along.extend(errors_along.tangential);
    }
    figures.push(Figure::bounded("velocity_error_mean_noisy", mean(&fast), AtMost(0.10)));
    figures.push(Figure::bounded("velocity_error_mean_noisy_slow", mean(&slow), AtMost(0.20)));
    figures.push(Figure::bounded("velocity_error_tangential_mean_noisy", mean(&along), AtMost(0.30)));
    figures.push(Figure::reported("velocity_unknown_points", unknown as f64));

    progress("a board that stands still");
    let mut still: Vec<f64> = (0..8)
        .flat_map(|seed| speeds(Vector3::zeros(), 30.0, 1.0, seed))
        .flatten()
        .map(|v| v.norm())
        .collect();
    still.sort_by(f64::total_cmp);
    let p95 = still[still.len() * 95 / 100];
    figures.push(Figure::bounded("still_speed_p95_m_s", p95, AtMost(0.15)));
    figures
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn errors(velocity: Vector3<f64>, rate: f64, noise: f64) -> Errors {
    let seeds = if noise > 0.0 { 0..4 } else { 0..1 };
    let mut errors = Errors::default();
    for found in seeds.flat_map(|seed| speeds(velocity, rate, noise, seed)) {
        match found {
            Some(found) => {
                let error = (found - velocity) / velocity.norm();
                errors.normal.push(error.x.abs());
                errors.tangential.push(error.yz().norm());
            }
            None => errors.unknown += 1,
        }
    }
    errors
}

/// The velocities found at points of the board's front, which moves with `velocity`.
fn speeds(velocity: Vector3<f64>, rate: f64, noise: f64, seed: u64) -> Vec<Option<Vector3<f64>>> {
    let cameras: Vec<Camera> = layout::ring(8, 5.0, 0.0, ORIGIN, (640, 480), 0.5).expect("a ring");
    let data: Arc<HullData> = data(&cameras);
    let place = |frame: usize| velocity * ((frame as f64 - LAST as f64 + 0.5) / rate);
    let first = (0..LAST).find(|&frame| place(frame).norm() < 0.7).unwrap_or(LAST - 1).min(LAST - 1);
    for frame in first..=LAST {
        let p = place(frame);
        let subject = Subject::new(vec![cuboid(BOARD, at(p.x, p.y, p.z))]);
        let masks: Vec<GrayImage> = masks(&cameras, &subject, coverage);
        let masks = masks.iter().enumerate().map(|(view, mask)| {
            if noise > 0.0 {
                displace_edge(mask, noise, seed << 32 | (frame << 8 | view) as u64)
            } else {
                mask.clone()
            }
        });
        publish(&data, &masks.collect::<Vec<_>>(), frame as f64 / rate);
    }
    // Half a frame before the last one the board's middle lies at the origin.
    let hull = data.in_motion(Motion::Interpolated, (LAST as f64 + 0.5) / rate).expect("a hull");
    let _ = UnitQuaternion::<f64>::identity();
    let points = [(0.0, 0.0), (0.14, 0.14), (-0.14, 0.14), (0.14, -0.14), (-0.14, -0.14), (0.0, 0.14)];
    points.iter().map(|&(y, z)| hull.velocity(&Point3::new(0.5 * BOARD.x, y, z))).collect()
}
