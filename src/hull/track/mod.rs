//! How a part of the real subject moves and turns, followed through many frames without drift.
//!
//! ```text
//!   rim ─► rim_fit ─► track ─► path
//!   points of the surface     where they are in a later hull     its velocity
//! ```
//!
//! The rim of the part, seen when it was first followed, is compared with the silhouettes of each later hull. Only when the
//! part has turned, so that other points of it are on the rim, is it seen anew. So errors do not add up from frame to frame.

mod path;
mod rim;
mod rim_fit;
#[cfg(test)]
mod tests;

use super::Hull;
use nalgebra::{Isometry3, Point3, Vector3};
use path::Path;
pub(crate) use path::RigidMotion;
use rim::RimPoint;

/// The rim is seen anew when the part has turned by this since then, in radians: a finger's rim slides by a third of its radius.
const TURN_OF_RENEWAL: f64 = 0.35;

/// The fewest points of a rim by which a part can be followed.
const LEAST_POINTS: usize = 24;

/// A part that is not found goes on as it moved for this long, in seconds, before it is lost.
const LOST_AFTER: f64 = 0.2;

/// A motion that no edge confirms slows down in this time, in seconds.
const FADING_SECONDS: f64 = 0.5;

/// A part of the real subject that is followed, in the hull's frame.
#[derive(Debug, Clone)]
pub(crate) struct Track {
    /// The middle of the part, when it was first seen.
    centre: Point3<f64>,
    /// The points of the rim, where they were at `rim_pose`.
    rim: Vec<RimPoint>,
    rim_pose: Isometry3<f64>,
    /// The part's pose now, from that when it was first seen.
    pose: Isometry3<f64>,
    /// The time of the last hull, and of the last in which the part was found, in seconds.
    seconds: f64,
    found_at: f64,
    path: Path,
    /// Whether the last hull had the same time as the one before.
    stands_still: bool,
    /// How it moves until its path tells.
    first_motion: RigidMotion,
}

/// What became of a part in a hull.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Followed {
    /// It was found.
    Found,
    /// It was not, and goes on as it moved.
    Hidden,
    /// It was not for 0.2 s.
    Lost,
}

impl Track {
    /// Begins to follow what is within 0.15 m of `centre`, both in the hull's frame; `None` where too few edges are seen there.
    pub(crate) fn begin(hull: &Hull, centre: &Point3<f64>) -> Option<Self> {
        let rim = rim::rim_around(hull, centre);
        if rim.len() < LEAST_POINTS {
            return None;
        }
        let linear = hull.surface_velocity(centre).map_or(Vector3::zeros(), |found| found.velocity);
        let mut track = Self {
            centre: *centre,
            rim,
            rim_pose: Isometry3::identity(),
            pose: Isometry3::identity(),
            seconds: hull.time(),
            found_at: hull.time(),
            path: Path::default(),
            stands_still: false,
            first_motion: RigidMotion { linear, ..RigidMotion::REST },
        };
        track.note_place();
        Some(track)
    }

    /// Finds the part in a later hull. A hull of the same time or an earlier one, as of a clock that was set anew, tells where the
    /// part is, but not how it moves.
    pub(crate) fn follow(&mut self, hull: &Hull) -> Followed {
        let passed = hull.time() - self.seconds;
        if passed < 0.0 {
            (self.path, self.first_motion, self.found_at) = (Path::default(), RigidMotion::REST, hull.time());
        }
        let passed = passed.max(0.0);
        (self.seconds, self.stands_still) = (hull.time(), passed == 0.0);
        let motion = self.motion().scaled((-passed / FADING_SECONDS).exp());
        let predicted = motion.advance(&self.pose, &self.place(), passed);

        let from_rim = self.rim_pose.inverse();
        let found = rim_fit::locate(&self.rim, hull, &(predicted * from_rim));
        self.pose = found.map_or(predicted, |moved| moved * self.rim_pose);
        self.pose.rotation.renormalize();
        if found.is_none() {
            let is_lost = self.seconds - self.found_at >= LOST_AFTER;
            return if is_lost { Followed::Lost } else { Followed::Hidden };
        }

        self.found_at = self.seconds;
        if passed > 0.0 || self.path.is_empty() {
            self.note_place();
        }
        if (self.pose.rotation * self.rim_pose.rotation.inverse()).angle() > TURN_OF_RENEWAL {
            self.renew(hull);
        }
        Followed::Found
    }

    /// Sees the rim anew, where enough of it is in sight.
    fn renew(&mut self, hull: &Hull) {
        let rim = rim::rim_around(hull, &self.place());
        if rim.len() >= LEAST_POINTS {
            (self.rim, self.rim_pose) = (rim, self.pose);
        }
    }

    fn note_place(&mut self) {
        self.path.push(self.seconds, self.place(), self.pose.rotation);
    }

    /// The pose of the part in the last hull, from that when it was first seen.
    pub(crate) fn pose(&self) -> &Isometry3<f64> {
        &self.pose
    }

    /// Where the middle of the part is in the last hull.
    pub(crate) fn place(&self) -> Point3<f64> {
        self.pose * self.centre
    }

    /// How the part moves there: its middle, and its turn about that.
    pub(crate) fn motion(&self) -> RigidMotion {
        self.path.motion().unwrap_or(self.first_motion)
    }

    /// Whether the last two hulls had the same time, as where the next frame is late.
    pub(crate) fn stands_still(&self) -> bool {
        self.stands_still
    }

    /// The time between the last two hulls in which it was found, in seconds; 0 before the second.
    pub(crate) fn period(&self) -> f64 {
        self.path.last_period().unwrap_or(0.0)
    }
}
