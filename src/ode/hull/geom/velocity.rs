//! The velocity of the real surface, in the world's frame, once for points close to one another.

use super::{HullGeom, pose};
use crate::hull::{Motion, SurfaceVelocity};
use crate::lock::lock;
use nalgebra::Point3;
use ode_sys::dGeomID;

/// Velocities of the surface at points of one frame, in the hull's frame of reference.
#[derive(Debug, Default)]
pub(super) struct Velocities {
    /// The [`State::frame_count`] of the frame.
    frame: u64,
    found: Vec<(Point3<f64>, Option<SurfaceVelocity>)>,
}

/// Points closer to one another than this share a velocity, in metres. It is fitted to edges much farther away.
const SAME_VELOCITY: f64 = 0.03;

impl HullGeom {
    /// The velocity of the real surface near `p`, both in the world; `None` where it is not known.
    ///
    /// # Safety
    /// `geom` is the living geom that owns this data.
    pub(in crate::ode::hull) unsafe fn velocity(
        &self,
        geom: dGeomID,
        p: &Point3<f64>,
    ) -> Option<SurfaceVelocity> {
        // SAFETY: the caller vouches for the geom.
        let world_from_hull = unsafe { pose(geom) };
        let p = world_from_hull.inverse_transform_point(p);
        let (hull, frame) = {
            let state = self.lock();
            (state.hull.clone().filter(|_| state.motion != Motion::Held)?, state.frame_count)
        };

        let mut velocities = lock(&self.velocities);
        if velocities.frame != frame {
            velocities.found.clear();
            velocities.frame = frame;
        }
        let is_near = |known: &Point3<f64>| (p - known).norm_squared() < SAME_VELOCITY * SAME_VELOCITY;
        let known = velocities.found.iter().find(|(known, _)| is_near(known)).map(|&(_, velocity)| velocity);
        let found = known.unwrap_or_else(|| {
            let found = hull.surface_velocity(&p);
            velocities.found.push((p, found));
            found
        })?;
        let (velocity, mean) = (world_from_hull * found.velocity, world_from_hull * found.mean);
        Some(SurfaceVelocity { velocity, mean, ..found })
    }
}
