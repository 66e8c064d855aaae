//! Whether silhouettes and cameras fit together: what two views say of the outermost planes that touch the subject.
//!
//! ```text
//!     camera a o--------------o camera b       planes through both centres turn about the line between them;
//!               \ .--------. /                 the last one that touches the subject touches both silhouettes
//!                (  subject )
//!     =========== '--------' =======  <- the plane, a line in either image
//! ```
//!
//! Two silhouettes of one subject lie between the same two planes, whatever its shape (the frontier points of Cipolla
//! and Giblin, *Visual Motion of Curves and Surfaces*, 2000). Where they do not, one view cuts off what the other sees:
//! its image is shifted, by a calibration that is off, or its mask has lost a part. Many pairs and frames tell which.

use crate::hull::{Hull, View};
use crate::silhouette::Rect;
use image::{GrayImage, Luma};
use imageproc::region_labelling::{Connectivity, connected_components};
use nalgebra::{DMatrix, DVector, Matrix3x2, Point2, Vector2, Vector3};

/// Parts of a silhouette that are smaller than this share of its largest part are specks.
const MIN_PART_FRACTION: f64 = 0.1;

/// Every so many pixels of a part, each way, it is asked whether the hull fills it.
const SPARSE: u32 = 3;

/// Silhouettes that end so near to the image's border, in pixels, may go on beyond it.
const BORDER: i32 = 2;

/// The widest angle between a pair's two planes, in radians: more, and the silhouette surrounds the other camera.
const WIDEST: f64 = 2.5;

/// The largest turn of a plane for a pixel, in radians: more, and the silhouette lies at the other camera.
const STEEPEST: f64 = 0.02;

/// Gaps below this, in pixels, are pixels' own; larger ones count by their size, not its square.
const HUBER_PX: f64 = 0.5;

/// What it costs to shift a view by a pixel, beside a gap of a pixel at one of its planes. Shifts of all views together
/// that follow a motion of the subject change no gap: of those the ones with the fewest views shifted are taken.
const SHIFT_PRIOR: f64 = 0.1;

/// What silhouettes of several frames say of how the views' images lie to one another.
#[derive(Debug, Clone, Default)]
pub struct EpipolarTangency {
    views: usize,
    planes: Vec<Plane>,
}

/// One outermost plane, seen by two views.
#[derive(Debug, Clone, Copy)]
struct Plane {
    views: [usize; 2],
    /// How far the views disagree, in pixels of both together.
    error: f64,
    /// How a shift of each view's image, in pixels, changes that.
    slopes: [Vector2<f64>; 2],
}

/// How one view's silhouettes lie to those of the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewShift {
    /// The shift of the view's image that lets its silhouettes fit the others', rightwards and downwards, in pixels;
    /// the principal point of its calibration is off by as much the other way.
    pub shift: Vector2<f64>,
    /// The median disagreement with the other views as they are, in pixels.
    pub gap: f64,
    /// The same after all views have been shifted.
    pub gap_after: f64,
    /// By how many pixels the mean disagreement would grow if of all shifts this one were left out. Pairs of cameras
    /// tell little of some shifts: a long one that gains little means nothing.
    pub gain: f64,
    /// How many planes say so; with none, nothing is known.
    pub planes: usize,
}

impl EpipolarTangency {
    /// Nothing seen yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes in a frame. Its views have to be those of the frames before; disabled ones and such as see no subject
    /// are left out, and so are pairs in which one camera stands within the other's silhouette.
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

    /// How each view lies to the others. Least absolute gaps over all planes, so that masks which now and then lose a
    /// foot do not count for more than those that do not; and of the shifts that do equally well those of the fewest
    /// views.
    pub fn shifts(&self) -> Vec<ViewShift> {
        let shifts = self.solve();
        let none = DVector::zeros(2 * self.views);
        let of = |view: usize| {
            let own = || self.planes.iter().filter(move |plane| plane.views.contains(&view));
            let mut others = shifts.clone();
            others.fixed_rows_mut::<2>(2 * view).fill(0.0);
            let sum = |shifts: &DVector<f64>| own().map(|plane| plane.error_with(shifts).abs()).sum::<f64>();
            ViewShift {
                shift: shifts.fixed_rows::<2>(2 * view).into(),
                gap: median(own().map(|plane| plane.error_with(&none).abs())),
                gap_after: median(own().map(|plane| plane.error_with(&shifts).abs())),
                gain: (sum(&others) - sum(&shifts)) / own().count().max(1) as f64,
                planes: own().count(),
            }
        };
        (0..self.views).map(of).collect()
    }

    /// All views' shifts, by least squares weighted anew with each round.
    fn solve(&self) -> DVector<f64> {
        let n = 2 * self.views;
        let mut shifts = DVector::<f64>::zeros(n);
        let reluctance = SHIFT_PRIOR * 2.0 * self.planes.len() as f64 / self.views.max(1) as f64;
        for _ in 0..100 {
            let (mut matrix, mut vector) = (DMatrix::<f64>::identity(n, n) * 1e-9, DVector::<f64>::zeros(n));
            for view in 0..self.views {
                let length = shifts.fixed_rows::<2>(2 * view).norm();
                let weight = reluctance / length.max(0.1 * HUBER_PX);
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
            if change < 1e-4 {
                break;
            }
        }
        shifts
    }
}

impl Plane {
    /// The places of its views' shifts among all, and how each changes the gap.
    fn entries(&self) -> [(usize, f64); 4] {
        let [i, j] = self.views;
        let [a, b] = self.slopes;
        [(2 * i, a.x), (2 * i + 1, a.y), (2 * j, b.x), (2 * j + 1, b.y)]
    }

    fn error_with(&self, shifts: &DVector<f64>) -> f64 {
        self.error + self.entries().iter().map(|&(place, slope)| slope * shifts[place]).sum::<f64>()
    }
}

/// A corner of a silhouette's convex outline.
#[derive(Debug, Clone, Copy)]
struct Corner {
    at: Point2<f64>,
    /// Whether the silhouette may go on beyond it.
    is_cut: bool,
}

/// Where a silhouette ends about the line between two cameras, to one side: the plane's angle, what a pixel's shift
/// changes, and whether it is the subject that ends.
#[derive(Debug, Clone, Copy)]
struct End {
    angle: f64,
    slope: Vector2<f64>,
    is_cut: bool,
}

/// Both ends of both views' silhouettes.
fn spans(views: [&View; 2], outlines: [&[Corner]; 2]) -> Option<[[End; 2]; 2]> {
    if outlines.iter().any(|outline| outline.is_empty()) {
        return None;
    }
    let centres = views.map(|view| view.camera().centre());
    let line = (centres[1] - centres[0]).try_normalize(1e-6)?;
    // Angles count from the middle of the first silhouette.
    let sum: Vector2<f64> = outlines[0].iter().map(|corner| corner.at.coords).sum();
    let middle = direction(views[0], &Point2::from(sum / outlines[0].len() as f64))?;
    let ahead = (middle - line * line.dot(&middle)).try_normalize(1e-6)?;
    let axes = (ahead, line.cross(&ahead));
    let first = span(views[0], outlines[0], &axes)?;
    Some([first, span(views[1], outlines[1], &axes)?])
}

fn span(view: &View, outline: &[Corner], (ahead, aside): &(Vector3<f64>, Vector3<f64>)) -> Option<[End; 2]> {
    let inverse = view.camera().intrinsics().try_inverse()?;
    let world_from_cam = view.camera().cam_from_world().rotation.inverse().to_rotation_matrix();
    let per_pixel: Matrix3x2<f64> = world_from_cam.matrix() * inverse.fixed_columns::<2>(0);
    let end = |corner: &Corner| {
        let ray = direction(view, &corner.at)?;
        let (x, y) = (ray.dot(ahead), ray.dot(aside));
        let slope = per_pixel.transpose() * (aside * x - ahead * y) / (x * x + y * y);
        Some(End { angle: y.atan2(x), slope, is_cut: corner.is_cut })
    };
    let ends: Vec<End> = outline.iter().filter_map(end).collect();
    let low = *ends.iter().min_by(|a, b| a.angle.total_cmp(&b.angle))?;
    let high = *ends.iter().max_by(|a, b| a.angle.total_cmp(&b.angle))?;
    (high.angle - low.angle < WIDEST).then_some([low, high])
}

/// A vector from the camera's centre towards an image position, of depth 1, in the world.
fn direction(view: &View, at: &Point2<f64>) -> Option<Vector3<f64>> {
    let camera = view.camera();
    let in_camera = camera.intrinsics().try_inverse()? * at.to_homogeneous();
    Some(camera.cam_from_world().inverse_transform_vector(&in_camera))
}

fn planes(views: [usize; 2], spans: &[[End; 2]; 2]) -> impl Iterator<Item = Plane> {
    (0..2).filter_map(move |side| {
        let [a, b] = [spans[0][side], spans[1][side]];
        let size = a.slope.norm().hypot(b.slope.norm());
        let fits = !a.is_cut && !b.is_cut && a.slope.norm().max(b.slope.norm()) < STEEPEST;
        let gap = (a.angle - b.angle) / size;
        fits.then_some(Plane { views, error: gap, slopes: [a.slope / size, -b.slope / size] })
    })
}

/// The corners of the convex outline of a view's silhouette, without specks and what is surely another subject; none for
/// a view that takes no part.
fn outline(hull: &Hull, view: &View) -> Vec<Corner> {
    let rect = view.silhouette().rect();
    if !view.is_enabled() || rect.is_empty() {
        return Vec::new();
    }
    let subject = GrayImage::from_fn(rect.width() as u32, rect.height() as u32, |i, j| {
        let (i, j) = (rect.x0 + i as i32, rect.y0 + j as i32);
        Luma([if view.silhouette().is_subject(i, j) && view.sees(i, j) { 255 } else { 0 }])
    });
    let subject = shared(&subject, |i, j| {
        let ray = view.camera().ray(f64::from(rect.x0) + i, f64::from(rect.y0) + j);
        ray.is_some_and(|ray| hull.ray_cast(&ray).is_some())
    });
    let mut points = Vec::new();
    for (j, row) in subject.rows().enumerate() {
        let is_subject: Vec<bool> = row.map(|pixel| pixel.0[0] > 0).collect();
        let first = is_subject.iter().position(|&is| is);
        let last = is_subject.iter().rposition(|&is| is);
        let (Some(first), Some(last)) = (first, last) else { continue };
        for i in [first as i32, last as i32] {
            let (i, j) = (rect.x0 + i, rect.y0 + j as i32);
            let is_cut = is_at_border(view, i, j);
            let corner = |di, dj| Corner { at: Point2::new(f64::from(i + di), f64::from(j + dj)), is_cut };
            points.extend([corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)]);
        }
    }
    convex(points)
}

fn is_at_border(view: &View, i: i32, j: i32) -> bool {
    let image = view.silhouette().image();
    let near = |rect: Rect| !rect.grown(-BORDER).contains(i, j);
    near(image) || view.field_of_view().is_some_and(|seen| i32::from(seen.distance(i, j)) <= BORDER)
}

/// The parts of a mask that are no specks and of which the hull fills something, as `is_filled` tells of the middles of
/// pixels; where it fills nothing, all that are no specks.
fn shared(mask: &GrayImage, is_filled: impl Fn(f64, f64) -> bool) -> GrayImage {
    let parts = connected_components(mask, Connectivity::Eight, Luma([0]));
    let count = parts.iter().max().map_or(0, |&most| most as usize) + 1;
    let (mut sizes, mut filled) = (vec![0_usize; count], vec![false; count]);
    for (x, y, part) in parts.enumerate_pixels() {
        let part = part.0[0] as usize;
        sizes[part] += 1;
        let is_asked = part > 0 && !filled[part] && x % SPARSE == 0 && y % SPARSE == 0;
        if is_asked && is_filled(f64::from(x) + 0.5, f64::from(y) + 0.5) {
            filled[part] = true;
        }
    }
    sizes[0] = 0;
    let least = MIN_PART_FRACTION * sizes.iter().max().map_or(0.0, |&size| size as f64);
    let any = filled.iter().any(|&is| is);
    let mut kept = mask.clone();
    for (pixel, part) in kept.iter_mut().zip(parts.iter().map(|&part| part as usize)) {
        if (sizes[part] as f64) < least || (any && !filled[part]) {
            *pixel = 0;
        }
    }
    kept
}

/// The convex outline of `points` (Andrew's monotone chain, 1979).
fn convex(mut points: Vec<Corner>) -> Vec<Corner> {
    points.sort_by(|a, b| a.at.x.total_cmp(&b.at.x).then(a.at.y.total_cmp(&b.at.y)));
    let turns = |a: &Corner, b: &Corner, c: &Corner| (b.at - a.at).perp(&(c.at - a.at)) > 0.0;
    let half = |points: &mut dyn Iterator<Item = Corner>| {
        let mut chain: Vec<Corner> = Vec::new();
        for point in points {
            while chain.len() >= 2 && !turns(&chain[chain.len() - 2], &chain[chain.len() - 1], &point) {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut outline = half(&mut points.iter().copied());
    outline.extend(half(&mut points.iter().rev().copied()));
    outline
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests;
