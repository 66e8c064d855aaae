//! How much of each view's silhouette the hull fills, and which other view cuts away the rest.

use crate::median;
use nalgebra::Point3;
use ode_visual_hull::camera::Ray;
use ode_visual_hull::hull::{Hull, View};

/// Intervals of a ray inside the hull that are examined, and points along each.
const MAX_INTERVALS: usize = 4;
const POINTS_PER_INTERVAL: usize = 8;

/// Where the search for the next interval starts behind the end of one, in metres.
const INTERVAL_GAP: f64 = 1e-6;

/// How one view's silhouette fits the hull.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SilhouetteCoherence {
    /// Pixels of the view's silhouette that were examined.
    pub pixels: usize,
    /// Number of examined pixels whose viewing ray meets the hull. All do where the silhouettes fit one another.
    pub filled_pixels: usize,
    /// Pixels of the other views' silhouettes that are not filled because of this view alone.
    pub carved_pixels: usize,
    /// By how many pixels this view's silhouette would have to be wider for half of the carved pixels to be filled.
    /// This is a median, because a part that the mask has lost lies far from the rest.
    pub carved_depth_px: f64,
}

impl SilhouetteCoherence {
    /// The share of the silhouette that the hull fills; 1 where there is no silhouette.
    pub fn filled_share(&self) -> f64 {
        if self.pixels == 0 { 1.0 } else { self.filled_pixels as f64 / self.pixels as f64 }
    }
}

/// How the silhouette of each view fits the hull, by the viewing rays of every `step`-th pixel of every `step`-th row.
/// Disabled views count no pixels.
pub fn silhouette_coherence(hull: &Hull, step: usize) -> Vec<SilhouetteCoherence> {
    let mut coherence = vec![SilhouetteCoherence::default(); hull.views().len()];
    let enabled = || hull.views().iter().enumerate().filter(|(_, view)| view.is_enabled());

    let mut missing = Vec::new();
    for (index, view) in enabled() {
        for ray in rays(view, step) {
            coherence[index].pixels += 1;
            if hull.ray_cast(&ray).is_some() {
                coherence[index].filled_pixels += 1;
            } else {
                missing.push((index, ray));
            }
        }
    }

    // A view carves a pixel of another one if the hull of all other views has points on that pixel's ray.
    for (index, view) in enabled() {
        let others = without(hull, index);
        let rays_of_others = missing.iter().filter(|(of, _)| *of != index);
        let carved: Vec<_> = rays_of_others
            .map(|(_, ray)| points_inside(&others, ray))
            .filter(|points| !points.is_empty())
            .collect();
        coherence[index].carved_pixels = carved.len();
        coherence[index].carved_depth_px = carved_depth_px(view, &carved);
    }

    coherence
}

/// The coherence of each view over several frames, each of which lists all views: pixels are added up, and the depth is
/// the median over the frames in which the view carves something.
pub fn total_coherence(frames: &[Vec<SilhouetteCoherence>]) -> Vec<SilhouetteCoherence> {
    let views = frames.first().map_or(0, Vec::len);
    let total = |view: usize| {
        let own = || frames.iter().map(move |frame| &frame[view]);
        let carving = own().filter(|one| one.carved_pixels > 0);
        SilhouetteCoherence {
            pixels: own().map(|one| one.pixels).sum(),
            filled_pixels: own().map(|one| one.filled_pixels).sum(),
            carved_pixels: own().map(|one| one.carved_pixels).sum(),
            carved_depth_px: median(carving.map(|one| one.carved_depth_px)),
        }
    };
    (0..views).map(total).collect()
}

/// The hull of all views but `view`.
fn without(hull: &Hull, view: usize) -> Hull {
    let views = hull.views().iter().cloned().enumerate();
    let views = views.map(|(k, v)| {
        let enabled = v.is_enabled() && k != view;
        v.with_enabled(enabled)
    });
    Hull::new(views.collect(), *hull.bounds(), hull.unseen(), hull.time())
}

/// The viewing rays through the centres of a silhouette's pixels.
fn rays(view: &View, step: usize) -> impl Iterator<Item = Ray> {
    let rect = view.silhouette().rect();
    let step = step.max(1);
    let subject = move |&(i, j): &(i32, i32)| view.silhouette().is_subject(i, j) && view.sees(i, j);
    let pixels = (rect.y0..rect.y1)
        .step_by(step)
        .flat_map(move |j| (rect.x0..rect.x1).step_by(step).map(move |i| (i, j)));
    pixels.filter(subject).filter_map(|(i, j)| view.camera().ray(f64::from(i) + 0.5, f64::from(j) + 0.5))
}

/// Points of `ray` inside the hull, spread evenly over each interval.
fn points_inside(hull: &Hull, ray: &Ray) -> Vec<Point3<f64>> {
    let (mut points, mut start) = (Vec::new(), 0.0);
    for _ in 0..MAX_INTERVALS {
        let Some((entry, exit)) = hull.ray_cast(&Ray { origin: ray.at(start), ..*ray }) else { break };
        let (from, to) = (start + entry.map_or(0.0, |entry| entry.t), start + exit.t);
        let at = |k: usize| ray.at(from + (to - from) * (k as f64 + 0.5) / POINTS_PER_INTERVAL as f64);
        points.extend((0..POINTS_PER_INTERVAL).map(at));
        start = to + INTERVAL_GAP;
    }
    points
}

/// The median over `carved`, the points of one ray each, of how far the ray passes from the view's silhouette, in
/// pixels.
fn carved_depth_px(view: &View, carved: &[Vec<Point3<f64>>]) -> f64 {
    let silhouette = view.silhouette();
    if carved.is_empty() || silhouette.rect().is_empty() {
        return 0.0;
    }

    let distances = silhouette.signed_distance(&silhouette.image());
    // The edge lies half a pixel before the centre of the nearest subject pixel.
    let distance = |point: &Point3<f64>| {
        let (i, j) = view.pixel(point)?;
        Some((f64::from(distances.at(i, j)) + 0.5).max(0.0))
    };

    let nearest = |points: &Vec<Point3<f64>>| points.iter().filter_map(distance).min_by(f64::total_cmp);
    median(carved.iter().filter_map(nearest))
}

#[cfg(test)]
mod tests;
