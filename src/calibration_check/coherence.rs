//! What becomes of each view's silhouette in the hull: how much of it the hull fills, and which other view cuts off the
//! rest.

use crate::camera::Ray;
use crate::hull::{Hull, View};
use nalgebra::Point3;

/// Stretches of a ray inside the hull that are looked at, and points along each.
const MAX_INTERVALS: usize = 4;
const POINTS_PER_INTERVAL: usize = 8;

/// How far a ray goes on behind a stretch before the next one may begin, in metres.
const BETWEEN: f64 = 1e-6;

/// How one view's silhouette fits the hull.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SilhouetteCoherence {
    /// Pixels of its silhouette that were looked at.
    pub pixels: usize,
    /// Of these, those whose viewing ray meets the hull. The hull of silhouettes that fit fills all of them.
    pub filled_pixels: usize,
    /// Pixels of the other views' silhouettes that are not filled because of this view alone.
    pub carved_pixels: usize,
    /// By how many pixels of this view its silhouette would have to be wider for half of these: the median, since a
    /// part that its mask has lost lies far from the rest.
    pub carved_depth_px: f64,
}

impl SilhouetteCoherence {
    /// The share of its silhouette that the hull fills; 1 where there is no silhouette.
    pub fn filled_share(&self) -> f64 {
        if self.pixels == 0 { 1.0 } else { self.filled_pixels as f64 / self.pixels as f64 }
    }
}

impl Hull {
    /// How each view's silhouette fits the hull, by the rays of every `step`-th pixel of every `step`-th row.
    /// Disabled views neither fit nor cut.
    pub fn silhouette_coherence(&self, step: usize) -> Vec<SilhouetteCoherence> {
        let n = self.views().len();
        let mut fits = vec![SilhouetteCoherence::default(); n];
        let mut missing = Vec::new();
        for (index, view) in self.views().iter().enumerate().filter(|(_, view)| view.is_enabled()) {
            for ray in rays(view, step) {
                fits[index].pixels += 1;
                if self.ray_cast(&ray).is_some() {
                    fits[index].filled_pixels += 1;
                } else {
                    missing.push((index, ray));
                }
            }
        }
        for (index, view) in self.views().iter().enumerate().filter(|(_, view)| view.is_enabled()) {
            let others = self.without(index);
            let cut = missing.iter().filter(|(of, _)| *of != index);
            let stretches: Vec<_> =
                cut.map(|(_, ray)| points_inside(&others, ray)).filter(|points| !points.is_empty()).collect();
            fits[index].carved_pixels = stretches.len();
            fits[index].carved_depth_px = depth_px(view, &stretches);
        }
        fits
    }

    /// The hull of the other views.
    fn without(&self, view: usize) -> Self {
        let views = self.views().iter().cloned().enumerate();
        let views = views.map(|(k, v)| {
            let enabled = v.is_enabled() && k != view;
            v.with_enabled(enabled)
        });
        Self::new(views.collect(), *self.bounds(), self.unseen(), self.time())
    }
}

/// The rays of a silhouette's pixels, through their centres.
fn rays(view: &View, step: usize) -> impl Iterator<Item = Ray> {
    let rect = view.silhouette().rect();
    let step = step.max(1);
    let subject = move |&(i, j): &(i32, i32)| view.silhouette().is_subject(i, j) && view.sees(i, j);
    let pixels = (rect.y0..rect.y1)
        .step_by(step)
        .flat_map(move |j| (rect.x0..rect.x1).step_by(step).map(move |i| (i, j)));
    pixels.filter(subject).filter_map(|(i, j)| view.camera().ray(f64::from(i) + 0.5, f64::from(j) + 0.5))
}

/// Points of `ray` inside the hull.
fn points_inside(hull: &Hull, ray: &Ray) -> Vec<Point3<f64>> {
    let (mut points, mut start) = (Vec::new(), 0.0);
    for _ in 0..MAX_INTERVALS {
        let Some((entry, exit)) = hull.ray_cast(&Ray { origin: ray.at(start), ..*ray }) else { break };
        let (from, to) = (start + entry.map_or(0.0, |entry| entry.t), start + exit.t);
        let at = |k: usize| ray.at(from + (to - from) * (k as f64 + 0.5) / POINTS_PER_INTERVAL as f64);
        points.extend((0..POINTS_PER_INTERVAL).map(at));
        start = to + BETWEEN;
    }
    points
}

/// How far from a view's silhouette stretches of rays pass, in pixels: the median.
fn depth_px(view: &View, stretches: &[Vec<Point3<f64>>]) -> f64 {
    let silhouette = view.silhouette();
    if stretches.is_empty() || silhouette.rect().is_empty() {
        return 0.0;
    }
    let distances = silhouette.signed_distance(&silhouette.image());
    // The edge lies half a pixel before the subject's nearest pixel.
    let distance = |point: &Point3<f64>| {
        let (i, j) = view.pixel(point)?;
        Some((f64::from(distances.at(i, j)) + 0.5).max(0.0))
    };
    let nearest = |points: &Vec<Point3<f64>>| points.iter().filter_map(distance).min_by(f64::total_cmp);
    let mut depths: Vec<f64> = stretches.iter().filter_map(nearest).collect();
    depths.sort_by(f64::total_cmp);
    depths.get(depths.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests;
