//! What the contacts of a body with a hull depend on.

use super::body_samples::{self, BodySamples};
use super::geom::HullGeom;
use super::lost_views::Loss;
use super::swept::Swept;
use crate::Result;
use crate::contact::{SampledBody, Settings};
use crate::hull::{Hull, Motion};
use crate::ode::convert;
use crate::sample::Samples;
use nalgebra::{Isometry3, Vector3};
use ode_sys::dGeomID;
use std::sync::Arc;

/// A hull geom as one call of its collider sees it, copied at once so that no lock is held while ODE is called.
#[derive(Debug)]
pub(super) struct CollideContext<'g> {
    pub(super) hull: Arc<Hull>,
    /// Counts the geom's frames, and so tells this one from others.
    pub(super) frame: u64,
    pub(super) settings: Settings,
    pub(super) swept: Swept,
    pub(super) motion: Motion,
    /// The diameter in metres of the thinnest real feature that must not pass between a body's samples.
    pub(super) min_feature: f64,
    /// Whether contacts are recorded as events.
    pub(super) has_events: bool,
    /// The views that the frame lacks; `None` where it lacks none.
    pub(super) loss: Option<Arc<Loss>>,
    pub(super) hull_from_world: Isometry3<f64>,
    pub(super) geom: &'g HullGeom,
}

/// A request for the contacts of one body. Equal queries have equal contacts.
#[derive(Debug, Clone)]
pub(super) struct ContactQuery {
    /// The address of the body's geom.
    pub(super) other: usize,
    pub(super) samples: Arc<Samples>,
    pub(super) stamp: PoseStamp,
    pub(super) settings: Settings,
    pub(super) last_escape: Option<Vector3<f64>>,
}

/// Where a body is, in which frame of the hull.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PoseStamp {
    /// The [`CollideContext::frame`].
    pub(super) frame: u64,
    pub(super) hull_from_other: Isometry3<f64>,
}

impl ContactQuery {
    /// The query for `geom`; `None` for a class that has no surface, and in a pose that is not finite.
    ///
    /// # Errors
    /// A shape that cannot be sampled.
    ///
    /// # Safety
    /// `geom` is a living geom.
    pub(super) unsafe fn new(geom: dGeomID, context: &CollideContext) -> Result<Option<Self>> {
        // SAFETY: the caller vouches for the geom.
        let world_from_geom = unsafe { convert::any_pose(geom) };
        let hull_from_other = context.hull_from_world * world_from_geom;
        if !hull_from_other.to_homogeneous().iter().all(|x| x.is_finite()) {
            return Ok(None);
        }

        // SAFETY: as above; the pose is the geom's.
        let BodySamples { samples, outdated } =
            unsafe { body_samples::of(geom, &world_from_geom, context.min_feature)? };
        if let Some(error) = outdated {
            context.geom.record_error(error);
        }

        let other = geom as usize;
        Ok(samples.map(|samples| Self {
            other,
            samples,
            stamp: PoseStamp { frame: context.frame, hull_from_other },
            settings: context.settings,
            last_escape: context.geom.last_contacts.escape(other),
        }))
    }

    /// Whether `other`, a query for the same geom, has the contacts of this one.
    pub(super) fn matches(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.samples, &other.samples)
            && self.stamp == other.stamp
            && self.settings == other.settings
            && self.last_escape == other.last_escape
    }

    /// The body, as [`collide_many`](crate::contact::collide_many) takes it.
    pub(super) fn body(&self) -> SampledBody<'_> {
        SampledBody {
            samples: &self.samples,
            hull_from_body: self.stamp.hull_from_other,
            last_escape: self.last_escape,
        }
    }
}
