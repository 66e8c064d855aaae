//! The projections of one point into all views, from which both the inside test and the window search read.

use crate::camera::{Pixel, floor_pixel};
use crate::hull::overrule::Overruled;
use crate::hull::{EdgeModel, Hull, Verdict, View};
use crate::recycle::{keep_scratch, take_scratch};
use crate::silhouette::HALF_COVERAGE;
use nalgebra::Point3;
use std::cell::Cell;

/// The projection of a point into one view that sees it.
#[derive(Debug, Clone, Copy)]
pub(in crate::hull) struct ViewSample {
    /// Index of the view.
    pub(in crate::hull) index: usize,
    pub(super) at: Pixel,
    pub(in crate::hull) pixel: (i32, i32),
    /// Chebyshev distance of the pixel to the background, in pixels.
    pub(in crate::hull) distance: u16,
    /// Metres that a pixel covers at the point: d_i of the window search.
    pub(in crate::hull) footprint: f64,
}

/// The projections of a point into the enabled views.
#[derive(Debug, Default)]
pub(in crate::hull) struct ViewSamples {
    pub(in crate::hull) visible: Vec<ViewSample>,
    /// Number of enabled views that do not see the point.
    pub(super) unseen: usize,
    /// The view that is overruled at the point.
    pub(in crate::hull) overruled: Option<Overruled>,
}

thread_local! {
    /// Memory that this thread's queries reuse, one at a time.
    static SCRATCH: Cell<Option<ViewSamples>> = const { Cell::new(None) };
}

impl ViewSamples {
    /// Runs `query` with reused memory.
    pub(in crate::hull) fn with<R>(query: impl FnOnce(&mut Self) -> R) -> R {
        let mut samples = take_scratch(&SCRATCH);
        let result = query(&mut samples);
        keep_scratch(&SCRATCH, samples);
        result
    }

    /// Projects `p` into all enabled views.
    pub(in crate::hull) fn project(&mut self, hull: &Hull, p: &Point3<f64>) {
        self.clear_samples();
        for (index, view) in hull.views().iter().enumerate().filter(|(_, view)| view.is_enabled()) {
            self.add(index, view, p);
        }
        self.overruled = hull.overruled_among(self);
    }

    /// Projects `p` into the enabled views until one sees it outside that cannot be overruled. Returns whether `p` is
    /// inside; only then are the samples complete.
    pub(in crate::hull) fn project_if_inside(
        &mut self,
        hull: &Hull,
        p: &Point3<f64>,
        edge: EdgeModel,
    ) -> bool {
        self.clear_samples();
        let mut outside = None;
        for (index, view) in hull.views().iter().enumerate().filter(|(_, view)| view.is_enabled()) {
            if let Some(sample) = self.add(index, view, p)
                && sample.verdict(view, edge) == Verdict::Outside
            {
                if outside.is_some() || hull.overrule_depth().is_none() {
                    return false;
                }
                outside = Some(index);
            }
        }
        self.overruled = hull.overruled_among(self);
        outside.is_none_or(|outside| self.overruled.is_some_and(|overruled| overruled.view == outside))
            && hull.unseen().decides_inside(self.visible.len(), 0, self.visible.len() + self.unseen)
    }

    /// The samples of the views that count: all that see the point, but for one that is overruled.
    pub(super) fn counting(&self) -> impl Iterator<Item = &ViewSample> {
        let overruled = self.overruled.map(|overruled| overruled.view);
        self.visible.iter().filter(move |sample| Some(sample.index) != overruled)
    }

    fn clear_samples(&mut self) {
        self.visible.clear();
        (self.unseen, self.overruled) = (0, None);
    }

    fn add(&mut self, index: usize, view: &View, p: &Point3<f64>) -> Option<ViewSample> {
        let sample = ViewSample::of(index, view, p);
        match sample {
            Some(sample) => self.visible.push(sample),
            None => self.unseen += 1,
        }
        sample
    }
}

impl ViewSample {
    /// `None` where the view does not see `p`.
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
            // Between four centres of subject pixels bilinear coverage is at least one half.
            self.distance > 1
                || (view.may_contain_subject(self.pixel)
                    && silhouette.coverage(self.at.u, self.at.v) >= HALF_COVERAGE)
        };
        if inside { Verdict::Inside } else { Verdict::Outside }
    }
}
