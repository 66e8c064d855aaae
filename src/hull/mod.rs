//! The visual hull of one frame: the set of points that every view sees as subject.
//!
//! ```text
//!   camera 1 >- - - - .###. - - -          inside: subject in every view
//!                     #####   \            response: out along the silhouette's normal, to the nearest exit
//!                    camera 2  v
//! ```
//!
//! Nothing is reconstructed. Each question is answered in the images: a point is projected into the views, the
//! nearest silhouette edge is found there, its normal is taken back to the world, and the line along it is walked
//! through the masks (paper, section 4). [`mod@reference`] is the same algorithm written to be read.

mod batch;
mod cull;
mod live;
mod many;
mod query;
pub mod reference;
mod view;

pub use crate::math::aabb::Aabb;
pub use crate::math::point_cloud::Points;
pub(crate) use batch::{ExitRay, Scratch};
pub use live::HullData;
pub use many::{Inside, PointResponse, Workspace};
pub use query::{ExitVector, NearestEdge, RayHit, Response};
pub use view::{EdgeModel, Verdict, View};

use crate::silhouette::{Border, Silhouette};
use nalgebra::Point3;
use std::sync::Arc;

/// What a view that does not see a point says of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unseen {
    /// The point is outside, as in the paper: the image's border cuts the hull off.
    Outside,
    /// Nothing; but at least this many views must see a point that is inside.
    Abstain {
        /// At least 1; two by default, since one view alone bounds nothing in depth.
        min_views: usize,
    },
}

impl Unseen {
    /// Abstain, with two views needed.
    pub const ABSTAIN: Self = Self::Abstain { min_views: 2 };

    /// How many of `enabled` views have to see a point that is inside.
    fn min_views(self, enabled: usize) -> usize {
        match self {
            Self::Outside => enabled.max(1),
            Self::Abstain { min_views } => min_views.max(1),
        }
    }

    /// Whether a point is inside that `inside` of `enabled` views see as subject and `outside` as background.
    pub fn decides_inside(self, inside: usize, outside: usize, enabled: usize) -> bool {
        outside == 0 && inside >= self.min_views(enabled)
    }
}

/// Which bounding volumes are tested before the masks (paper, section 4.1). All of them change speed, never a verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Culls {
    /// Per view, the silhouette's bounding rectangle in the image.
    pub rectangle: bool,
    /// Per view, the frustum of that rectangle.
    pub frustum: bool,
    /// The intersection of the frustums' boxes.
    pub frustum_box: bool,
    /// A whole body's box against the hull's.
    pub body_box: bool,
}

impl Culls {
    /// All.
    pub const ALL: Self = Self { rectangle: true, frustum: true, frustum_box: true, body_box: true };
    /// None.
    pub const NONE: Self = Self { rectangle: false, frustum: false, frustum_box: false, body_box: false };
    /// The ones in use: four plane tests a view cost more than the projection they would save, so the frustums
    /// themselves are left out.
    pub const DEFAULT: Self = Self { rectangle: true, frustum: false, frustum_box: true, body_box: true };
}

/// Why a hull holds no point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EmptyReason {
    /// No view takes part.
    NoViews,
    /// This view's mask has no subject pixel.
    EmptySilhouette {
        /// Its index.
        view: usize,
    },
    /// What this view sees of its silhouette has no point in common with the work volume and the views before it.
    NothingInCommon {
        /// Its index.
        view: usize,
    },
}

/// The visual hull of one frame. Immutable: any number of threads may ask it.
#[derive(Debug, Clone)]
pub struct Hull {
    views: Vec<View>,
    bounds: Aabb,
    unseen: Unseen,
    culls: Culls,
    time: f64,
    aabb: Aabb,
    empty_reason: Option<EmptyReason>,
}

impl Hull {
    /// The hull of `views` inside the work volume `bounds`, seen at `time` seconds.
    pub fn new(views: Vec<View>, bounds: Aabb, unseen: Unseen, time: f64) -> Self {
        let (aabb, emptiness) = bounding_box(&views, &bounds, unseen);
        Self { views, bounds, unseen, culls: Culls::DEFAULT, time, aabb, empty_reason: emptiness }
    }

    /// Removes the views of a dropped frame, and returns their silhouettes; the memory of the list of views stays.
    fn drain_silhouettes(&mut self) -> impl Iterator<Item = Arc<Silhouette>> {
        self.views.drain(..).map(View::into_silhouette)
    }

    /// The memory of the list of views.
    fn take_views(&mut self) -> Vec<View> {
        self.views.clear();
        std::mem::take(&mut self.views)
    }

    /// The same hull with other culls.
    pub fn with_culls(mut self, culls: Culls) -> Self {
        self.culls = culls;
        self
    }

    /// All views, the disabled ones too.
    pub fn views(&self) -> &[View] {
        &self.views
    }

    /// The work volume: points outside are outside the hull.
    pub fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// The policy for views that do not see a point.
    pub fn unseen(&self) -> Unseen {
        self.unseen
    }

    /// When its silhouettes were seen, in seconds.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// A box around the hull: the intersection of the frustums' boxes with the work volume. Empty for an empty hull.
    pub fn aabb(&self) -> &Aabb {
        &self.aabb
    }

    /// Why the hull is empty and which view emptied it, as far as its bounding volumes tell; `None` where they
    /// leave room for a point.
    pub fn empty_reason(&self) -> Option<EmptyReason> {
        self.empty_reason
    }

    /// Whether a body whose points lie within `radius` of `centre` can touch the hull at all.
    pub fn may_touch(&self, centre: &Point3<f64>, radius: f64) -> bool {
        !self.culls.body_box || self.aabb.grown(radius).contains(centre)
    }

    /// Whether `p` is inside: subject in every view (paper, section 4.1), see [`Unseen`] for views that miss it.
    pub fn inside(&self, p: &Point3<f64>) -> bool {
        self.inside_by(p, EdgeModel::Pixel)
    }

    /// Whether `p` is inside with the silhouettes' edges taken by `edge`. Contacts begin at the coverage edge, where
    /// their exits end.
    pub fn inside_by(&self, p: &Point3<f64>, edge: EdgeModel) -> bool {
        if !self.in_boxes(p) {
            return false;
        }
        let (mut inside, mut enabled) = (0, 0);
        for view in self.enabled_views() {
            match self.verdict(view, p, edge) {
                Verdict::Inside => inside += 1,
                Verdict::Unseen => {}
                Verdict::Outside => return false,
            }
            enabled += 1;
        }
        self.unseen.decides_inside(inside, 0, enabled)
    }

    /// Whether `p` lies in the work volume, and in the hull's box where that is asked.
    fn in_boxes(&self, p: &Point3<f64>) -> bool {
        self.bounds.contains(p) && (!self.culls.frustum_box || self.aabb.contains(p))
    }

    /// Metres that a pixel covers at `p` in the view that sees it largest; the work volume's diagonal where none does.
    pub fn pixel_size(&self, p: &Point3<f64>) -> f64 {
        let sizes = self
            .enabled_views()
            .filter_map(|view| view.project(p).map(|pixel| view.footprint().at(pixel.depth)));
        sizes.fold((self.bounds.max - self.bounds.min).norm(), f64::min)
    }

    fn verdict(&self, view: &View, p: &Point3<f64>, edge: EdgeModel) -> Verdict {
        // A view that may abstain has to say first whether it sees the point.
        if self.culls.frustum && self.unseen == Unseen::Outside && view.outside_frustum(p) {
            return Verdict::Outside;
        }
        view.verdict(p, edge, self.culls.rectangle)
    }

    /// Whether what `view` does not see is outside, as the background of its mask says already.
    fn is_closed(&self, view: &View) -> bool {
        self.unseen == Unseen::Outside && view.silhouette().border() == Border::Background
    }

    fn enabled_views(&self) -> impl Iterator<Item = &View> {
        self.views.iter().filter(|view| view.is_enabled())
    }
}

/// The intersection of the views' frustum boxes inside `bounds`, and who emptied it.
fn bounding_box(views: &[View], bounds: &Aabb, unseen: Unseen) -> (Aabb, Option<EmptyReason>) {
    if !views.iter().any(View::is_enabled) {
        return (Aabb::EMPTY, Some(EmptyReason::NoViews));
    }
    let mut aabb = *bounds;
    for (index, view) in views.iter().enumerate().filter(|(_, view)| view.is_enabled()) {
        // A view bounds nothing where it abstains.
        if unseen != Unseen::Outside && !view.sees_all_of(bounds) {
            continue;
        }
        aabb = aabb.intersection(&view.frustum_box(bounds));
        if aabb.is_empty() {
            let empty = view.silhouette().rect().is_empty();
            let why = if empty {
                EmptyReason::EmptySilhouette { view: index }
            } else {
                EmptyReason::NothingInCommon { view: index }
            };
            return (Aabb::EMPTY, Some(why));
        }
    }
    (aabb, None)
}

#[cfg(test)]
mod tests;
