//! The convex outline of a view's silhouette, without specks and other subjects.

use image::{GrayImage, Luma};
use imageproc::geometry::convex_hull;
use imageproc::region_labelling::{Connectivity, connected_components};
use nalgebra::Point2;
use ode_visual_hull::hull::{Hull, View};
use ode_visual_hull::silhouette::Rect;

/// Parts of a silhouette that are smaller than this share of its largest part are specks.
const MIN_PART_FRACTION: f64 = 0.1;

/// Distance of the pixels, in columns and in rows, at which a part is tested against the hull.
const SAMPLE_STEP: u32 = 3;

/// A silhouette that ends so near to the image's border, in pixels, may continue beyond it.
const BORDER: i32 = 2;

/// A corner of a silhouette's convex outline.
#[derive(Debug, Clone, Copy)]
pub struct Corner {
    /// In pixels, from the image's upper-left corner.
    pub position: Point2<f64>,
    /// Whether the silhouette may continue beyond the corner, outside the field of view.
    pub is_cut: bool,
}

/// The corners of the convex outline of a view's silhouette, without specks and without parts that belong to another
/// subject. A disabled view has none.
pub fn outline(hull: &Hull, view: &View) -> Vec<Corner> {
    let rect = view.silhouette().rect();
    if !view.is_enabled() || rect.is_empty() {
        return Vec::new();
    }

    let subject = GrayImage::from_fn(rect.width() as u32, rect.height() as u32, |i, j| {
        let (i, j) = (rect.x0 + i as i32, rect.y0 + j as i32);
        Luma([if view.silhouette().is_subject(i, j) && view.sees(i, j) { 255 } else { 0 }])
    });
    let subject = without_specks_and_others(&subject, |i, j| {
        let ray = view.camera().ray(f64::from(rect.x0) + i, f64::from(rect.y0) + j);
        ray.is_some_and(|ray| hull.ray_cast(&ray).is_some())
    });

    let is_cut = |x: i32, y: i32| {
        let touching = [(x - 1, y - 1), (x, y - 1), (x - 1, y), (x, y)];
        touching.iter().any(|&(i, j)| is_set(&subject, i, j) && is_at_border(view, rect.x0 + i, rect.y0 + j))
    };
    let corner = |x: i32, y: i32| Corner {
        position: Point2::new(f64::from(rect.x0 + x), f64::from(rect.y0 + y)),
        is_cut: is_cut(x, y),
    };
    convex_hull(row_ends(&subject)).iter().map(|point| corner(point.x, point.y)).collect()
}

/// The corners of the first and last set pixels of all rows, each corner once.
fn row_ends(mask: &GrayImage) -> Vec<imageproc::point::Point<i32>> {
    let mut points = Vec::new();
    for (j, row) in mask.rows().enumerate() {
        let is_set: Vec<bool> = row.map(|pixel| pixel.0[0] > 0).collect();
        let first = is_set.iter().position(|&is| is);
        let last = is_set.iter().rposition(|&is| is);
        let (Some(first), Some(last)) = (first, last) else { continue };
        for (x, y) in [(first, j), (last + 1, j), (first, j + 1), (last + 1, j + 1)] {
            points.push((x as i32, y as i32));
        }
    }

    // `convex_hull` sorts by a comparison that is no total order where a point occurs twice.
    points.sort_unstable();
    points.dedup();
    points.into_iter().map(|(x, y)| imageproc::point::Point::new(x, y)).collect()
}

fn is_set(mask: &GrayImage, i: i32, j: i32) -> bool {
    let pixel = u32::try_from(i).ok().zip(u32::try_from(j).ok());
    pixel.and_then(|(i, j)| mask.get_pixel_checked(i, j)).is_some_and(|pixel| pixel.0[0] > 0)
}

fn is_at_border(view: &View, i: i32, j: i32) -> bool {
    let is_near = |rect: Rect| !rect.grown(-BORDER).contains(i, j);
    is_near(view.silhouette().image())
        || view.field_of_view().is_some_and(|field| i32::from(field.distance(i, j)) <= BORDER)
}

/// The parts of a mask that are not specks and that the hull fills at least in part; if the hull fills no part, all
/// that are not specks. `is_filled` takes the centre of a pixel of `mask`.
fn without_specks_and_others(mask: &GrayImage, is_filled: impl Fn(f64, f64) -> bool) -> GrayImage {
    let parts = connected_components(mask, Connectivity::Eight, Luma([0]));
    let count = parts.iter().max().map_or(0, |&most| most as usize) + 1;

    let (mut sizes, mut filled) = (vec![0_usize; count], vec![false; count]);
    for (x, y, part) in parts.enumerate_pixels() {
        let part = part.0[0] as usize;
        sizes[part] += 1;
        let is_sample = part > 0 && x % SAMPLE_STEP == 0 && y % SAMPLE_STEP == 0;
        if is_sample && !filled[part] && is_filled(f64::from(x) + 0.5, f64::from(y) + 0.5) {
            filled[part] = true;
        }
    }

    // Part 0 is the background.
    sizes[0] = 0;
    let min_size = MIN_PART_FRACTION * sizes.iter().max().map_or(0.0, |&size| size as f64);
    let any_filled = filled.iter().any(|&is| is);
    let mut kept = mask.clone();
    for (pixel, part) in kept.iter_mut().zip(parts.iter().map(|&part| part as usize)) {
        if (sizes[part] as f64) < min_size || (any_filled && !filled[part]) {
            *pixel = 0;
        }
    }

    kept
}
