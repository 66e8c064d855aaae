//! The velocity of a real surface, from silhouettes of a board that moves in all directions.

use crate::studio::*;
use image::GrayImage;
use nalgebra::{Point3, Vector3};
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
    /// Along the board's normal, over the true speed, from 1 m/s on if there is noise.
    normal: Vec<f64>,
    /// Along the normal at 0.5 m/s, if there is noise.
    slow: Vec<f64>,
    /// In the board's plane, over the true speed.
    tangential: Vec<f64>,
    /// The number of points at which no velocity was found.
    unknown: usize,
}

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let pinholes = layout::ring(8, 5.0, 0.0, ORIGIN, (640, 480), 0.5).expect("a ring");
    let (mut figures, mut unknown) = (Vec::new(), 0);
    for (optics, cameras) in [("", pinholes.clone()), ("_lens", through_lenses(&pinholes))] {
        progress(&format!("the velocity of a board{optics}"));
        let (clean, noisy) = (clean_errors(&cameras), noisy_errors(&cameras));
        let mut add = |name: &str, errors: &[f64], most: f64| {
            let name = format!("velocity_error_{name}{optics}");
            figures.push(Figure::bounded(&name, mean(errors), AtMost(most)));
        };
        add("mean", &clean.normal, 0.10);
        add("tangential_mean", &clean.tangential, 0.15);
        add("mean_noisy", &noisy.normal, 0.10);
        add("mean_noisy_slow", &noisy.slow, 0.20);
        add("tangential_mean_noisy", &noisy.tangential, 0.30);
        unknown += clean.unknown + noisy.unknown;
    }
    figures.push(Figure::reported("velocity_unknown_points", unknown as f64));

    progress("a board that stands still");
    let mut still: Vec<f64> = (0..40)
        .flat_map(|seed| speeds(&pinholes, Vector3::zeros(), 30.0, 1.0, seed))
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

/// Errors without noise, at four speeds, filmed at two rates.
fn clean_errors(cameras: &[Camera]) -> Errors {
    let mut errors = Errors::default();
    for speed in [0.5, 1.0, 2.0, 3.0] {
        for rate in [10.0, 30.0] {
            errors.add(cameras, speed, rate, 0.0);
        }
    }
    errors
}

/// Errors with a pixel of noise, filmed at 30 Hz.
fn noisy_errors(cameras: &[Camera]) -> Errors {
    let mut errors = Errors::default();
    for speed in [0.5, 1.0, 2.0, 3.0] {
        errors.add(cameras, speed, 30.0, 1.0);
    }
    errors
}

impl Errors {
    /// Adds the errors of a board that moves along its normal, and of one that moves in its plane.
    fn add(&mut self, cameras: &[Camera], speed: f64, rate: f64, noise: f64) {
        let seeds = if noise > 0.0 { 0..4 } else { 0..1 };
        let along = Vector3::new(0.0, 0.8 * speed, 0.6 * speed);
        for (velocity, is_along) in [(Vector3::x() * speed, false), (along, true)] {
            for found in seeds.clone().flat_map(|seed| speeds(cameras, velocity, rate, noise, seed)) {
                let Some(found) = found else {
                    self.unknown += 1;
                    continue;
                };
                let error = (found - velocity) / speed;
                if is_along {
                    self.tangential.push(error.yz().norm());
                } else if noise > 0.0 && speed < 1.0 {
                    self.slow.push(error.x.abs());
                } else {
                    self.normal.push(error.x.abs());
                }
            }
        }
    }
}

/// The velocities found at points of the board's front, which moves with `velocity`.
fn speeds(
    cameras: &[Camera],
    velocity: Vector3<f64>,
    rate: f64,
    noise: f64,
    seed: u64,
) -> Vec<Option<Vector3<f64>>> {
    let data: Arc<HullData> = data(cameras);
    let place = |frame: usize| velocity * ((frame as f64 - LAST as f64 + 0.5) / rate);
    let first = (0..LAST).find(|&frame| place(frame).norm() < 0.7).unwrap_or(LAST - 1).min(LAST - 1);
    for frame in first..=LAST {
        let p = place(frame);
        let subject = Subject::new(vec![cuboid(BOARD, at(p.x, p.y, p.z))]);
        let masks: Vec<GrayImage> = masks(cameras, &subject, coverage);
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
    let points = [(0.0, 0.0), (0.14, 0.14), (-0.14, 0.14), (0.14, -0.14), (-0.14, -0.14), (0.0, 0.14)];
    points.iter().map(|&(y, z)| hull.velocity(&Point3::new(0.5 * BOARD.x, y, z))).collect()
}
