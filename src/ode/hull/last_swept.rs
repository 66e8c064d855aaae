//! The contacts that bodies were about to have with a hull when they were last collided.

use super::query::ContactQuery;
use crate::contact::{BodyMotion, SweptContact};
use crate::lock::lock;
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;
use std::sync::Mutex;

/// Number of bodies from which on announced contacts are forgotten: addresses accumulate.
const MAX_ANNOUNCED: usize = 1 << 12;

/// A body has moved by its velocity if its way differs by at most this part of itself. Gravity and forces change it a little.
const SAME_WAY: f64 = 0.05;

/// The contacts that bodies were about to have when they were last collided, by the addresses of their geoms, which are
/// compared and never followed.
///
/// ODE moves a body over a whole step by the velocity that it has after the contact. So a contact leaves it as much of its
/// velocity as takes it to the surface. If it has slid off the surface by then, nothing would take the rest.
#[derive(Debug, Default)]
pub(super) struct LastSwept(Mutex<HashMap<usize, Announced>>);

#[derive(Debug, Clone, Copy, Default)]
struct Announced {
    /// The first contact that the body will have within the next step.
    first: Option<Touching>,
    /// The one that it was to have within the last step.
    before: Option<Touching>,
}

#[derive(Debug, Clone, Copy)]
struct Touching {
    /// The sample, in the body's frame.
    sample: Point3<f64>,
    /// The contact's direction, in the hull's frame.
    direction: Vector3<f64>,
    /// The body's origin, in the hull's frame, when the contact was found.
    origin: Point3<f64>,
}

impl LastSwept {
    /// Remembers the first of the contacts `found` of a body, and returns the one that it has had at the end of the last step.
    pub(super) fn renew(
        &self,
        query: &ContactQuery,
        motion: &BodyMotion,
        seconds: f64,
        found: &[SweptContact],
    ) -> Option<SweptContact> {
        let pose = &query.stamp.hull_from_other;
        let origin = Point3::from(pose.translation.vector);
        let mut table = lock(&self.0);
        let Announced { first, before } = table.remove(&query.other).unwrap_or_default();

        // A body may be collided several times in a step. If it has not moved, the contacts are those of that collide.
        let is_next_step = first.is_some_and(|first| first.origin != origin);
        let before = if is_next_step { first } else { before };
        let way = motion.at(&origin) * seconds;
        let is_one_step_ago = |last: &Touching| (origin - last.origin - way).norm() <= SAME_WAY * way.norm();
        let before = before.filter(is_one_step_ago);

        let first = found.first().map(|contact| Touching {
            sample: pose.inverse_transform_point(&contact.point),
            direction: contact.direction,
            origin,
        });
        if first.is_some() || before.is_some() {
            if table.len() >= MAX_ANNOUNCED {
                table.clear();
            }
            table.insert(query.other, Announced { first, before });
        }
        before.map(|last| {
            let (point, direction) = (pose * last.sample, last.direction);
            SweptContact { point, direction, surface: direction, seconds: 0.0 }
        })
    }
}
