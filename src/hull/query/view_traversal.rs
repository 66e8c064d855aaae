//! The traversal of one view along a half-line: of its mask and, where its lens leaves parts of the image unseen on which
//! the view abstains, of what the lens sees.
//!
//! The two have grids of their own: by coverage the cells of the mask are the squares between four pixel centres,
//! whereas sight ends at the borders of pixels.

use super::line_walk::MaskTraversal;
use crate::camera::ImageLine;
use crate::hull::{EdgeModel, Verdict, View};
use nalgebra::{Point3, Vector3};

/// The state of a traversal: the verdict that holds now, and up to which `t` it surely holds.
#[derive(Debug)]
pub(super) struct ViewTraversal<'a> {
    view: &'a View,
    mask: MaskTraversal<'a>,
    /// The traversal of the field of view, whose inside is what the lens sees; `None` where the mask says all.
    sight: Option<MaskTraversal<'a>>,
}

impl<'a> ViewTraversal<'a> {
    /// The traversal from `origin` along `direction`.
    pub(super) fn new(
        view: &'a View,
        origin: &Point3<f64>,
        direction: &Vector3<f64>,
        edge: EdgeModel,
    ) -> Self {
        let line = ImageLine::new(view.homogeneous(origin), view.homogeneous_direction(direction));
        let mask = MaskTraversal::from_start(view.silhouette(), line, edge);
        let sight = view
            .blind_spots()
            .map(|field_of_view| MaskTraversal::from_start(field_of_view, line, EdgeModel::Pixel));
        Self { view, mask, sight }
    }

    pub(super) fn view(&self) -> &'a View {
        self.view
    }

    /// The verdict since the last step.
    pub(super) fn verdict(&self) -> Verdict {
        match &self.sight {
            Some(sight) if sight.verdict() != Verdict::Inside => Verdict::Unseen,
            _ => self.mask.verdict(),
        }
    }

    /// The `t`, in metres, up to which the verdict surely holds.
    pub(super) fn until(&self) -> f64 {
        self.sight.as_ref().map_or(f64::INFINITY, MaskTraversal::until).min(self.mask.until())
    }

    /// Advances to the verdict that holds after `until`.
    pub(super) fn step(&mut self) {
        match &mut self.sight {
            Some(sight) if sight.until() <= self.mask.until() => sight.step(),
            _ => self.mask.step(),
        }
    }
}
