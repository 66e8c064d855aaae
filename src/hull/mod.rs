//! The visual hull of one frame: the set of points that project to subject in every view.
//!
//! ```text
//!   camera 1 >- - - - .###. - - -          inside: subject in every view
//!                     #####   \            response: along the silhouette's outward normal, to the nearest exit
//!                    camera 2  v
//! ```
//!
//! The hull is never reconstructed; queries work on the masks. A point is projected into the views, the nearest
//! silhouette edge is found there, its normal is back-projected to the world, and the half-line along that normal is
//! traversed through the masks up to the exit (paper, section 4). [`mod@reference`] is a plain version of the
//! algorithm.

mod batch;
mod cull;
mod live;
mod many;
mod motion;
mod overrule;
#[cfg(feature = "ode")]
mod parts;
mod query;
pub mod reference;
mod sweep;
#[cfg(feature = "ode")]
mod track;
mod velocity;
mod view;

pub use crate::math::aabb::Aabb;
pub use crate::math::point_cloud::Points;
pub(crate) use batch::{ExitRay, Scratch};
pub use live::{HullData, MaskFilter};
pub use many::{Inside, PointResponse, Workspace};
pub use motion::Motion;
#[cfg(feature = "ode")]
pub(crate) use parts::{AT_SURFACE, NEAR_SURFACE, PartId, Parts};
pub use query::{ExitVector, NearestEdge, RayHit, Response};
pub use sweep::Entry;
#[cfg(feature = "ode")]
pub(crate) use sweep::{MovingPoint, Sweep};
#[cfg(feature = "ode")]
pub(crate) use track::{Followed, RigidMotion, Track};
#[cfg(feature = "ode")]
pub(crate) use velocity::SurfaceVelocity;
pub use view::{EdgeModel, Verdict, View};

use crate::silhouette::{Border, Silhouette};
use nalgebra::Point3;
use query::ViewSamples;
use std::sync::Arc;

/// The policy for views that do not see a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unseen {
    /// The point is outside, as in the paper: the image's border cuts the hull off.
    Outside,
    /// The view does not count, but a point is inside only if at least `min_views` views see it.
    Abstain {
        /// At least 1. Two is a good choice, since one view alone does not bound the hull in depth.
        min_views: usize,
    },
}

impl Unseen {
    /// Abstention with `min_views` of two.
    pub const ABSTAIN: Self = Self::Abstain { min_views: 2 };

    /// How many of `enabled` views have to see a point for it to be inside.
    fn min_views(self, enabled: usize) -> usize {
        match self {
            Self::Outside => enabled.max(1),
            Self::Abstain { min_views } => min_views.max(1),
        }
    }

    /// Whether a point is inside the hull, where `inside` of the `enabled` views see it as subject and `outside` of
    /// them as background.
    pub fn decides_inside(self, inside: usize, outside: usize, enabled: usize) -> bool {
        outside == 0 && inside >= self.min_views(enabled)
    }
}

/// Which bounding volumes are tested before the masks (paper, section 4.1). They change the speed of queries, never
/// their results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Culls {
    /// Per view, the silhouette's bounding rectangle in the image.
    pub rectangle: bool,
    /// Per view, the frustum of that rectangle.
    pub frustum: bool,
    /// The intersection of the frustums' boxes.
    pub frustum_box: bool,
    /// A bounding sphere around a whole body against the hull's box.
    pub body_box: bool,
}

impl Culls {
    /// All bounding volumes.
    pub const ALL: Self = Self { rectangle: true, frustum: true, frustum_box: true, body_box: true };
    /// No bounding volumes.
    pub const NONE: Self = Self { rectangle: false, frustum: false, frustum_box: false, body_box: false };
    /// The bounding volumes in use: all but the frustums, whose four plane tests cost more than the projection that
    /// they would save.
    pub const DEFAULT: Self = Self { rectangle: true, frustum: false, frustum_box: true, body_box: true };
}

/// Why a hull contains no point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EmptyReason {
    /// Every view is disabled or late.
    NoViews,
    /// The mask of `view` has no subject pixel.
    EmptySilhouette {
        /// Index of the view.
        view: usize,
    },
    /// The frustum of this view's silhouette does not meet the work volume and the frustums of the views before it.
    NothingInCommon {
        /// Index of the view.
        view: usize,
    },
}

/// The visual hull of one frame, in world coordinates and metres. It is immutable: any number of threads may query it.
#[derive(Debug, Clone)]
pub struct Hull {
    views: Vec<View>,
    bounds: Aabb,
    unseen: Unseen,
    overrule_depth: Option<f64>,
    culls: Culls,
    time: f64,
    aabb: Aabb,
    empty_reason: Option<EmptyReason>,
}

impl Hull {
    /// The hull of `views` inside the work volume `bounds`, as seen at `time` seconds.
    pub fn new(views: Vec<View>, bounds: Aabb, unseen: Unseen, time: f64) -> Self {
        let (aabb, empty_reason) = bounding_box(&views, None, &bounds, unseen);
        let (overrule_depth, culls) = (None, Culls::DEFAULT);
        Self { views, bounds, unseen, overrule_depth, culls, time, aabb, empty_reason }
    }

    /// This hull, but with views overruled where all others are deeper by this many metres: see
    /// [`HullData::set_overrule_depth`].
    pub fn with_overrule_depth(mut self, depth: Option<f64>) -> Self {
        // The box depends on whether views are overruled, not from which depth on.
        if depth.is_some() != self.overrule_depth.is_some() {
            let Self { views, bounds, unseen, .. } = &self;
            (self.aabb, self.empty_reason) = match depth {
                Some(_) => box_without_any_one(views, bounds, *unseen),
                None => bounding_box(views, None, bounds, *unseen),
            };
        }
        self.overrule_depth = depth;
        self
    }

    /// Removes the views of a dropped frame and returns their silhouettes. The list of views keeps its capacity.
    fn drain_silhouettes(&mut self) -> impl Iterator<Item = Arc<Silhouette>> {
        self.views.drain(..).map(View::into_silhouette)
    }

    /// Takes the list of views, emptied, so that its memory can be reused.
    fn take_views(&mut self) -> Vec<View> {
        self.views.clear();
        std::mem::take(&mut self.views)
    }

    /// This hull with other culls.
    pub fn with_culls(mut self, culls: Culls) -> Self {
        self.culls = culls;
        self
    }

    /// This hull, but with other views in the places of some, each with its index.
    #[cfg(feature = "ode")]
    pub(crate) fn with_views(&self, others: &[(usize, View)]) -> Self {
        let mut views = self.views.clone();
        others.iter().for_each(|(k, view)| views[*k] = view.clone());
        Self::new(views, self.bounds, self.unseen, self.time)
            .with_overrule_depth(self.overrule_depth)
            .with_culls(self.culls)
    }

    /// All views, including the disabled ones.
    pub fn views(&self) -> &[View] {
        &self.views
    }

    /// The work volume: a point outside it is outside the hull.
    pub fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// The policy for views that do not see a point.
    pub fn unseen(&self) -> Unseen {
        self.unseen
    }

    /// By how many metres all other views, at least three, have to be deeper at a point than one that is overruled there;
    /// `None` where none is. See [`HullData::set_overrule_depth`].
    pub fn overrule_depth(&self) -> Option<f64> {
        self.overrule_depth
    }

    /// The time of the frame, in seconds.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// A box around the hull: the intersection of the frustums' boxes with the work volume. It is empty where
    /// [`empty_reason`](Self::empty_reason) gives a reason.
    pub fn aabb(&self) -> &Aabb {
        &self.aabb
    }

    /// Why the hull is empty and which view emptied it, judged by bounding volumes alone; `None` where these overlap,
    /// although the hull may be empty even then.
    pub fn empty_reason(&self) -> Option<EmptyReason> {
        self.empty_reason
    }

    /// Whether a body whose points lie within `radius` metres of `centre` can touch the hull at all.
    pub fn may_touch(&self, centre: &Point3<f64>, radius: f64) -> bool {
        !self.culls.body_box || self.aabb.grown(radius).contains(centre)
    }

    /// Whether `p` is inside: subject in every view (paper, section 4.1). Views that do not see it follow [`Unseen`].
    pub fn inside(&self, p: &Point3<f64>) -> bool {
        self.inside_by(p, EdgeModel::Pixel)
    }

    /// Whether `p` is inside, by the edge model `edge`. Contacts use the coverage edge both here and for their exits.
    pub fn inside_by(&self, p: &Point3<f64>, edge: EdgeModel) -> bool {
        if !self.in_boxes(p) {
            return false;
        }

        if self.overrule_depth.is_some() {
            return ViewSamples::with(|samples| samples.project_if_inside(self, p, edge));
        }

        // One view that sees background decides alone.
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

    /// Whether `p` lies in the work volume, and in the hull's box if that cull is enabled.
    fn in_boxes(&self, p: &Point3<f64>) -> bool {
        self.bounds.contains(p) && (!self.culls.frustum_box || self.aabb.contains(p))
    }

    /// Metres that a pixel covers at `p`, in the view where that is least; the work volume's diagonal if no enabled
    /// view has `p` in front of it.
    pub fn pixel_size(&self, p: &Point3<f64>) -> f64 {
        let sizes = self
            .enabled_views()
            .filter_map(|view| view.project(p).map(|pixel| view.footprint().at(pixel.depth)));
        sizes.fold((self.bounds.max - self.bounds.min).norm(), f64::min)
    }

    fn verdict(&self, view: &View, p: &Point3<f64>, edge: EdgeModel) -> Verdict {
        // Where views abstain, it has to be known first whether the view sees the point.
        if self.culls.frustum && self.unseen == Unseen::Outside && view.outside_frustum(p) {
            return Verdict::Outside;
        }
        view.verdict(p, edge, self.culls.rectangle)
    }

    /// Whether every point that `view` does not see is outside, so that it can be treated as background of its mask.
    fn is_closed(&self, view: &View) -> bool {
        self.unseen == Unseen::Outside && view.silhouette().border() == Border::Background
    }

    fn enabled_views(&self) -> impl Iterator<Item = &View> {
        self.views.iter().filter(|view| view.is_enabled())
    }
}

/// The box around the intersections of all enabled views but one, and why it is empty if it is.
fn box_without_any_one(views: &[View], bounds: &Aabb, unseen: Unseen) -> (Aabb, Option<EmptyReason>) {
    let of_all = bounding_box(views, None, bounds, unseen);
    let without = (0..views.len()).map(|view| bounding_box(views, Some(view), bounds, unseen).0);
    let aabb = without.fold(of_all.0, |all, without| all.union(&without));
    (aabb, if aabb.is_empty() { of_all.1 } else { None })
}

/// The intersection of the views' frustum boxes inside `bounds`, but for one that is left out, and why it is empty if it
/// is.
fn bounding_box(
    views: &[View],
    left_out: Option<usize>,
    bounds: &Aabb,
    unseen: Unseen,
) -> (Aabb, Option<EmptyReason>) {
    if !views.iter().any(View::is_enabled) {
        return (Aabb::EMPTY, Some(EmptyReason::NoViews));
    }

    let mut aabb = *bounds;
    let counts = |index: usize, view: &View| view.is_enabled() && left_out != Some(index);
    for (index, view) in views.iter().enumerate().filter(|(index, view)| counts(*index, view)) {
        // Outside its field of view, a view that abstains does not bound the hull.
        if unseen != Unseen::Outside && !view.sees_all_of(bounds) {
            continue;
        }

        aabb = aabb.intersection(&view.frustum_box(bounds));
        if aabb.is_empty() {
            let has_subject = !view.silhouette().rect().is_empty();
            let reason = if has_subject {
                EmptyReason::NothingInCommon { view: index }
            } else {
                EmptyReason::EmptySilhouette { view: index }
            };
            return (Aabb::EMPTY, Some(reason));
        }
    }

    (aabb, None)
}

#[cfg(test)]
mod tests;
