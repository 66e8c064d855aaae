//! Tangent planes of pairs of silhouettes, which show whether the views' images are shifted.
//!
//! ```text
//!     camera a o--------------o camera b       planes through both centres rotate about the line between them;
//!               \ .--------. /                 the last one that touches the subject touches both silhouettes
//!                (  subject )
//!     =========== '--------' =======  <- the plane, a line in either image
//! ```
//!
//! Two silhouettes of one subject lie between the same two planes, whatever its shape (the frontier points of Cipolla
//! and Giblin, *Visual Motion of Curves and Surfaces*, 2000). Where they do not, one view cuts off what the other sees:
//! its image is shifted by a wrong calibration, or its mask has lost a part. Many pairs and frames show which.

use crate::median;
use crate::outline::{Corner, outline};
use nalgebra::{DMatrix, DVector, Matrix3x2, Point2, Vector2, Vector3};
use ode_visual_hull::hull::{Hull, View};

/// Largest angle between the two planes of a pair, in radians: beyond it the silhouette surrounds the other camera.
const MAX_SPAN: f64 = 2.5;

/// Largest rotation of a plane for a pixel, in radians: beyond it the silhouette lies at the other camera.
const MAX_SLOPE: f64 = 0.02;

/// Tangency errors up to this, in pixels, count by their square, larger ones by their size. Pixels alone cause the
/// small ones.
const HUBER_PX: f64 = 0.5;

/// Cost of shifting a view by a pixel, relative to a tangency error of a pixel at one of its planes. Shifts of all
/// views that follow a motion of the subject change no error: among those, the prior selects the fewest shifted views.
const SHIFT_PRIOR: f64 = 0.1;

/// Limits of the iteration for the shifts: rounds, and the change in pixels below which it has converged.
const MAX_ROUNDS: usize = 100;
const CONVERGED_PX: f64 = 1e-4;

/// Tangent planes of the silhouettes of several frames, from which follows how the views' images are shifted.
#[derive(Debug, Clone, Default)]
pub struct EpipolarTangency {
    views: usize,
    planes: Vec<Plane>,
}

/// One outermost plane through the centres of two views.
#[derive(Debug, Clone, Copy)]
struct Plane {
    views: [usize; 2],
    /// How far the two silhouettes disagree on the plane, in pixels of both together.
    error: f64,
    /// Change of `error` for a pixel's shift of each view's image.
    slopes: [Vector2<f64>; 2],
}

/// How the silhouettes of one view lie relative to those of the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewShift {
    /// The shift of the view's image, right and down in pixels, that makes its silhouettes fit the others'. The
    /// principal point of its calibration is off by the opposite.
    pub shift: Vector2<f64>,
    /// The median disagreement with the other views as they are, in pixels.
    pub error: f64,
    /// The median disagreement after all views have been shifted, in pixels.
    pub error_after: f64,
    /// By how many pixels the mean disagreement would grow if this view alone were not shifted. Some shifts
    /// are poorly determined by the pairs of cameras: a long shift that gains little means nothing.
    pub gain: f64,
    /// Number of planes that the result rests on; with none, nothing is known.
    pub planes: usize,
}

impl EpipolarTangency {
    /// A collection without frames.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a frame. Its views have to be those of the frames before. Disabled views and views without a subject are
    /// left out, and so are pairs in which one camera stands within the other's silhouette.
    pub fn add(&mut self, hull: &Hull) {
        let outlines: Vec<Vec<Corner>> = hull.views().iter().map(|view| outline(hull, view)).collect();
        self.views = self.views.max(outlines.len());
        for j in 0..outlines.len() {
            for i in 0..j {
                let views = [&hull.views()[i], &hull.views()[j]];
                if let Some(spans) = spans(views, [&outlines[i], &outlines[j]]) {
                    self.planes.extend(planes([i, j], &spans));
                }
            }
        }
    }

    /// How each view lies relative to the others: the least absolute errors over all planes, so that masks which lose a
    /// foot in some frames count no more than the others, and among equally good shifts those of the fewest views.
    pub fn shifts(&self) -> Vec<ViewShift> {
        let shifts = self.solve();
        let unshifted = DVector::zeros(2 * self.views);

        let of = |view: usize| {
            let own = || self.planes.iter().filter(move |plane| plane.views.contains(&view));
            let errors = |shifts| own().map(move |plane: &Plane| plane.error_with(shifts).abs());
            let mut others = shifts.clone();
            others.fixed_rows_mut::<2>(2 * view).fill(0.0);
            ViewShift {
                shift: shifts.fixed_rows::<2>(2 * view).into(),
                error: median(errors(&unshifted)),
                error_after: median(errors(&shifts)),
                gain: (errors(&others).sum::<f64>() - errors(&shifts).sum::<f64>())
                    / own().count().max(1) as f64,
                planes: own().count(),
            }
        };
        (0..self.views).map(of).collect()
    }

    /// The shifts of all views, two numbers a view, by iteratively reweighted least squares.
    fn solve(&self) -> DVector<f64> {
        let n = 2 * self.views;
        let mut shifts = DVector::<f64>::zeros(n);
        let prior = SHIFT_PRIOR * 2.0 * self.planes.len() as f64 / self.views.max(1) as f64;

        for _ in 0..MAX_ROUNDS {
            let (mut matrix, mut vector) = (DMatrix::<f64>::identity(n, n) * 1e-9, DVector::<f64>::zeros(n));

            // The prior pulls each shift to zero by its length, not by the square of it.
            for view in 0..self.views {
                let length = shifts.fixed_rows::<2>(2 * view).norm();
                let weight = prior / length.max(0.1 * HUBER_PX);
                (0..2).for_each(|axis| matrix[(2 * view + axis, 2 * view + axis)] += weight);
            }

            for plane in &self.planes {
                let weight = 1.0 / plane.error_with(&shifts).abs().max(HUBER_PX);
                let entries = plane.entries();
                for (row, a) in entries {
                    vector[row] -= weight * a * plane.error;
                    entries.iter().for_each(|&(column, b)| matrix[(row, column)] += weight * a * b);
                }
            }

            let Some(factors) = matrix.cholesky() else { break };
            let next = factors.solve(&vector);
            let change = (&next - &shifts).amax();
            shifts = next;
            if change < CONVERGED_PX {
                break;
            }
        }

        shifts
    }
}

impl Plane {
    /// The non-zero entries of the plane's row in the system of all shifts: index and slope.
    fn entries(&self) -> [(usize, f64); 4] {
        let [i, j] = self.views;
        let [a, b] = self.slopes;
        [(2 * i, a.x), (2 * i + 1, a.y), (2 * j, b.x), (2 * j + 1, b.y)]
    }

    /// The error after all views have been shifted.
    fn error_with(&self, shifts: &DVector<f64>) -> f64 {
        self.error + self.entries().iter().map(|&(index, slope)| slope * shifts[index]).sum::<f64>()
    }
}

/// The outermost plane through the line between two cameras that still touches a silhouette, to one side.
#[derive(Debug, Clone, Copy)]
struct Tangent {
    /// The plane's angle about the line between the cameras, in radians.
    angle: f64,
    /// Change of the angle for a pixel's shift of the image.
    slope: Vector2<f64>,
    /// Whether the silhouette ends there at the border of its image and the subject may continue.
    is_cut: bool,
}

/// Both tangents of both silhouettes: view by view, the one of the lower angle first.
fn spans(views: [&View; 2], outlines: [&[Corner]; 2]) -> Option<[[Tangent; 2]; 2]> {
    if outlines.iter().any(|outline| outline.is_empty()) {
        return None;
    }
    let centres = views.map(|view| view.camera().centre());
    let line = (centres[1] - centres[0]).try_normalize(1e-6)?;

    // Angles count from the middle of the first silhouette.
    let sum: Vector2<f64> = outlines[0].iter().map(|corner| corner.position.coords).sum();
    let middle = direction(views[0], &Point2::from(sum / outlines[0].len() as f64))?;
    let zero = (middle - line * line.dot(&middle)).try_normalize(1e-6)?;
    let axes = (zero, line.cross(&zero));

    let first = span(views[0], outlines[0], &axes)?;
    Some([first, span(views[1], outlines[1], &axes)?])
}

/// The two tangents of one silhouette. `axes` are perpendicular to the line between the cameras: the direction of angle
/// zero, and that of a right angle.
fn span(view: &View, outline: &[Corner], axes: &(Vector3<f64>, Vector3<f64>)) -> Option<[Tangent; 2]> {
    let (zero, right) = axes;
    let inverse = view.camera().intrinsics().try_inverse()?;
    let world_from_cam = view.camera().cam_from_world().rotation.inverse().to_rotation_matrix();
    let per_pixel: Matrix3x2<f64> = world_from_cam.matrix() * inverse.fixed_columns::<2>(0);

    let tangent = |corner: &Corner| {
        let ray = direction(view, &corner.position)?;
        let (x, y) = (ray.dot(zero), ray.dot(right));
        let slope = per_pixel.transpose() * (right * x - zero * y) / (x * x + y * y);
        Some(Tangent { angle: y.atan2(x), slope, is_cut: corner.is_cut })
    };
    let tangents: Vec<Tangent> = outline.iter().filter_map(tangent).collect();

    let low = *tangents.iter().min_by(|a, b| a.angle.total_cmp(&b.angle))?;
    let high = *tangents.iter().max_by(|a, b| a.angle.total_cmp(&b.angle))?;
    (high.angle - low.angle < MAX_SPAN).then_some([low, high])
}

/// The world direction of the viewing ray through an image position, of depth 1.
fn direction(view: &View, position: &Point2<f64>) -> Option<Vector3<f64>> {
    let camera = view.camera();
    let in_camera = camera.intrinsics().try_inverse()? * position.to_homogeneous();
    Some(camera.cam_from_world().inverse_transform_vector(&in_camera))
}

/// The tangent planes, at most two, that both silhouettes determine reliably.
fn planes(views: [usize; 2], spans: &[[Tangent; 2]; 2]) -> impl Iterator<Item = Plane> {
    (0..2).filter_map(move |side| {
        let [a, b] = [spans[0][side], spans[1][side]];
        let size = a.slope.norm().hypot(b.slope.norm());
        let is_reliable = !a.is_cut && !b.is_cut && a.slope.norm().max(b.slope.norm()) < MAX_SLOPE;
        let error = (a.angle - b.angle) / size;
        is_reliable.then_some(Plane { views, error, slopes: [a.slope / size, -b.slope / size] })
    })
}

#[cfg(test)]
mod tests;
