//! A point as every view sees it: projected once, asked for the verdict and the nearest edge.

use crate::camera::{Pixel, floor_pixel};
use crate::hull::{EdgeModel, Hull, Verdict, View};
use crate::silhouette::HALF_COVERAGE;
use nalgebra::Point3;
use std::cell::Cell;

/// Where one view sees a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct ViewSample {
    /// Index of the view.
    pub(super) index: usize,
    pub(super) at: Pixel,
    pub(super) pixel: (i32, i32),
    /// Chebyshev distance of its pixel to the background.
    pub(super) distance: u16,
    /// Metres that a pixel covers there (design: d_i of the window search).
    pub(super) footprint: f64,
}

/// How the enabled views see a point.
#[derive(Debug, Default)]
pub(super) struct ViewSamples {
    pub(super) seen: Vec<ViewSample>,
    /// How many views do not see it.
    pub(super) unseen: usize,
}

thread_local! {
    /// Memory for one point at a time.
    static SCRATCH: Cell<Option<ViewSamples>> = const { Cell::new(None) };
}

impl ViewSamples {
    /// Runs `ask` on memory that is used again.
    pub(super) fn with<R>(ask: impl FnOnce(&mut Self) -> R) -> R {
        let mut sightings = SCRATCH.take().unwrap_or_default();
        let answer = ask(&mut sightings);
        SCRATCH.set(Some(sightings));
        answer
    }

    /// Takes up how all views see `p`.
    pub(super) fn project(&mut self, hull: &Hull, p: &Point3<f64>) {
        self.clear_samples();
        for (index, view) in hull.views().iter().enumerate().filter(|(_, view)| view.is_enabled()) {
            self.add(index, view, p);
        }
    }

    /// The same, but only as far as all views see `p` inside: false where some view sees it outside.
    pub(super) fn project_if_inside(&mut self, hull: &Hull, p: &Point3<f64>, edge: EdgeModel) -> bool {
        self.clear_samples();
        for (index, view) in hull.views().iter().enumerate().filter(|(_, view)| view.is_enabled()) {
            if let Some(sighting) = self.add(index, view, p)
                && sighting.verdict(view, edge) == Verdict::Outside
            {
                return false;
            }
        }
        hull.unseen().decides_inside(self.seen.len(), 0, self.seen.len() + self.unseen)
    }

    fn clear_samples(&mut self) {
        self.seen.clear();
        self.unseen = 0;
    }

    fn add(&mut self, index: usize, view: &View, p: &Point3<f64>) -> Option<ViewSample> {
        let sighting = ViewSample::of(index, view, p);
        match sighting {
            Some(sighting) => self.seen.push(sighting),
            None => self.unseen += 1,
        }
        sighting
    }
}

impl ViewSample {
    fn of(index: usize, view: &View, p: &Point3<f64>) -> Option<Self> {
        let at = view.project(p)?;
        let pixel = floor_pixel(at.u, at.v);
        if !view.judges(pixel.0, pixel.1) {
            return None;
        }
        let distance = view.silhouette().distance(pixel.0, pixel.1);
        Some(Self { index, at, pixel, distance, footprint: view.footprint().at(at.depth) })
    }

    fn verdict(&self, view: &View, edge: EdgeModel) -> Verdict {
        let silhouette = view.silhouette();
        let inside = if edge == EdgeModel::Pixel || !silhouette.has_coverage() {
            self.distance > 0
        } else {
            // Between four centres of subject pixels coverage cannot fall below one half.
            self.distance > 1
                || (view.may_contain_subject(self.pixel)
                    && silhouette.coverage(self.at.u, self.at.v) >= HALF_COVERAGE)
        };
        if inside { Verdict::Inside } else { Verdict::Outside }
    }
}
