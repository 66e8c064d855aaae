//! The velocity of the real surface, from the motion of the silhouettes' edges around a point.
//!
//! An edge only shows how fast it moves along its own normal, and a view only what crosses its line of sight. So all
//! edge points around the point, in all views, are put together: each is one equation for the three components of the
//! velocity that they share, and those that do not fit lose their weight.

use super::{Hull, View};
use nalgebra::{Matrix3, Point2, Point3, Vector3};

/// Edges within this distance of a point are taken to move as it does, in metres. The second applies where the edges
/// within the first leave a direction open, as in the middle of a large flat side.
const REACHES: [f64; 2] = [0.13, 0.25];

/// The least part of the equations' weight in every direction that determines a velocity.
const LEAST_WEIGHT: f64 = 0.02;

/// The most edge points of a view that are used.
const MAX_EDGES: usize = 32;

/// The scales at which an equation's error halves its weight, in m/s, one for each solution. The first is wide: edges
/// that carry the motion along the surface are few, and a narrow one would take them for errors.
const SCALES: [f64; 6] = [2.0, 1.0, 0.5, 0.25, 0.15, 0.1];

/// Part of the equations' weight that pulls directions in which no edge moves to rest.
const DAMPING: f64 = 1e-3;

/// Speeds below this count as rest, in m/s, where edges deviate by this much or more, in metres, since noise looks as fast;
/// where they deviate less, in proportion.
const DEAD_BAND: f64 = 0.1;
const NOISY: f64 = 3e-4;

/// The greatest speed, in m/s, that is believed.
pub(crate) const MAX_SPEED: f64 = 20.0;

/// What an edge point tells of a velocity: its component along `direction`, a unit vector.
#[derive(Debug, Clone, Copy)]
struct Equation {
    direction: Vector3<f64>,
    speed: f64,
    /// The time over which the speed is the mean.
    seconds: f64,
    /// By how much it is faster now, as the last frame shows.
    gained: f64,
}

/// The velocity of the real surface near a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SurfaceVelocity {
    /// In m/s, in the hull's frame.
    pub(crate) velocity: Vector3<f64>,
    /// Its mean over the last tenth of a second: less noisy, but late where the surface accelerates.
    pub(crate) mean: Vector3<f64>,
    /// The standard deviation of the edges around the point from where they would be if they all moved so, in metres: how noisy the
    /// masks are.
    pub(crate) deviation: f64,
}

impl Hull {
    /// The velocity of the real surface near `p`, in m/s in the hull's frame, fitted to the motion of the silhouettes'
    /// edges within 0.13 m of it. `None` where no edge with a known motion is near. Only hulls in
    /// [`Motion`](super::Motion) know how their silhouettes move, and only until they stand still because the next frame is
    /// late, by half the time between frames.
    ///
    /// It is that of the hull's time: the mean over the last tenth of a second, or over the last two frames where they are
    /// farther apart, and what the last frame shows that it has gained since, as far as masks so noisy tell. Speeds that may
    /// be noise are zero: those below 0.1 m/s where the edges deviate by 0.3 mm or more, less where they deviate less. None
    /// exceeds 20 m/s.
    pub fn velocity(&self, p: &Point3<f64>) -> Option<Vector3<f64>> {
        self.surface_velocity(p).map(|found| found.velocity)
    }

    /// [`Self::velocity`] with the deviation of the edges from it.
    pub(crate) fn surface_velocity(&self, p: &Point3<f64>) -> Option<SurfaceVelocity> {
        let mut equations = Vec::new();
        for reach in REACHES {
            equations.clear();
            for view in self.enabled_views().filter(|view| view.has_motion()) {
                view.collect_motion(p, reach, &mut equations);
            }
            if determine_all_directions(&equations) {
                break;
            }
        }
        let (mean, gained) = solve(&equations)?;
        let speed = mean.norm();
        if !speed.is_finite() || speed > MAX_SPEED {
            return None;
        }
        // An equation's speed is the difference of two positions.
        let error = |equation: &Equation| {
            (equation.direction.dot(&mean) - equation.speed) * equation.seconds / std::f64::consts::SQRT_2
        };
        let deviation_of_edges = deviation(&mut equations, error);
        let error = |equation: &Equation| equation.direction.dot(&gained) - equation.gained;
        let velocity = mean + believed(gained, deviation(&mut equations, error));
        if velocity.norm() < DEAD_BAND * (deviation_of_edges / NOISY).min(1.0) {
            let rest = Vector3::zeros();
            return Some(SurfaceVelocity { velocity: rest, mean: rest, deviation: deviation_of_edges });
        }
        Some(SurfaceVelocity { velocity, mean, deviation: deviation_of_edges })
    }
}

impl View {
    /// Adds what the edges within `reach` metres of `p` tell of its velocity.
    fn collect_motion(&self, p: &Point3<f64>, reach: f64, equations: &mut Vec<Equation>) {
        let Some(pixel) = self.project(p) else { return };
        let reach = reach / self.footprint().at(pixel.depth);
        let centre = Point2::new(pixel.u, pixel.v);
        let window = crate::math::rect::Rect::window(pixel.u as i32, pixel.v as i32, reach.min(1e6) as i32);

        let is_near = |&(i, j): &(i32, i32)| (middle(i, j) - centre).norm() <= reach;
        let near = || self.silhouette().edge_pixels_in(window).filter(is_near);
        let stride = near().count().div_ceil(MAX_EDGES).max(1);
        for (i, j) in near().step_by(stride) {
            let point = middle(i, j);
            let Some(shift) = self.edge_shift(&point) else { continue };

            // The edge point is taken to lie as deep as `p`.
            let along = self.image_motion_along(pixel.depth, &point, &shift.normal);
            let scale = along.norm();
            if scale > 0.0 {
                equations.push(Equation {
                    direction: along / scale,
                    speed: shift.speed / scale,
                    seconds: shift.seconds,
                    gained: shift.gained / scale,
                });
            }
        }
    }
}

fn middle(i: i32, j: i32) -> Point2<f64> {
    Point2::new(f64::from(i) + 0.5, f64::from(j) + 0.5)
}

/// Whether the equations tell the velocity in every direction.
fn determine_all_directions(equations: &[Equation]) -> bool {
    let directions = equations.iter().map(|equation| equation.direction * equation.direction.transpose());
    let sum: Matrix3<f64> = directions.sum();
    let least = sum.symmetric_eigenvalues().min();
    least > LEAST_WEIGHT * equations.len() as f64
}

/// The standard deviation of the edges from where `error` is 0: from the third of them that fit best, since many around a
/// corner of the subject may not move as it does.
fn deviation(equations: &mut [Equation], error: impl Fn(&Equation) -> f64) -> f64 {
    /// The standard deviation of normally distributed numbers over the absolute value that a third of them are below.
    const FROM_THIRD: f64 = 2.322;

    let size = |equation: &Equation| error(equation).abs();
    let third = equations.len() / 3;
    let (_, at_third, _) = equations.select_nth_unstable_by(third, |a, b| size(a).total_cmp(&size(b)));
    FROM_THIRD * size(at_third)
}

/// The part of `gained` that is believed, where the edges deviate from it by `noise` m/s: half of what is as fast.
fn believed(gained: Vector3<f64>, noise: f64) -> Vector3<f64> {
    let signal = gained.norm_squared();
    if signal > 0.0 { gained * (signal / (signal + noise * noise)) } else { gained }
}

/// The velocity that fits most equations, by weighted least squares whose weights follow from the last solution, and what it
/// has gained, by the same weights.
fn solve(equations: &[Equation]) -> Option<(Vector3<f64>, Vector3<f64>)> {
    if equations.len() < 3 {
        return None;
    }
    let mut solution: Option<(Vector3<f64>, Vector3<f64>)> = None;
    for scale in SCALES {
        let (mut matrix, mut right, mut right_of_gain, mut total) =
            (Matrix3::zeros(), Vector3::zeros(), Vector3::zeros(), 0.0);
        for Equation { direction, speed, gained, .. } in equations {
            let error = solution.map_or(0.0, |(velocity, _)| (direction.dot(&velocity) - speed) / scale);
            let weight = 1.0 / (1.0 + error * error);
            matrix += direction * direction.transpose() * weight;
            right += direction * (speed * weight);
            right_of_gain += direction * (gained * weight);
            total += weight;
        }
        matrix += Matrix3::identity() * (DAMPING * total);
        let factors = matrix.cholesky()?;
        solution = Some((factors.solve(&right), factors.solve(&right_of_gain)));
    }
    solution
}
