//! Contacts that a body will have with the hull before the next step ends: samples that are outside the hull now and enter
//! it on their way.

use super::tuning::{MAX_SWEPT_CONTACTS, SUPPORTED_COSINE};
use crate::hull::{Hull, MovingPoint, Sweep};
use crate::sample::{Sample, Samples};
use nalgebra::{Isometry3, Point3, Vector3};

/// How much later than a round body its samples may be met, in seconds: of a ball of 2 cm they lie up to 7 mm behind the
/// point between them that is met first.
const BETWEEN_SAMPLES: f64 = 0.02;

/// The first and the last angle, in radians, between directions in which a round body may be met first: from the distance
/// of samples to that at which a ball of 5 cm is met a tenth of a millimetre earlier.
const FIRST_ANGLE: f64 = 0.5;
const LAST_ANGLE: f64 = 0.05;

/// How a body moves, in the hull's frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyMotion {
    /// The velocity of `centre`, in m/s.
    pub(crate) linear: Vector3<f64>,
    /// In radians a second.
    pub(crate) angular: Vector3<f64>,
    /// The point about which it turns.
    pub(crate) centre: Point3<f64>,
}

/// A sample that will enter the hull.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SweptContact {
    /// Where the sample is now, in the hull's frame.
    pub(crate) point: Point3<f64>,
    /// Unit direction out of the hull where it enters.
    pub(crate) direction: Vector3<f64>,
    /// Seconds until it enters.
    pub(crate) seconds: f64,
}

impl BodyMotion {
    /// The velocity of a point of the body.
    pub(crate) fn at(&self, point: &Point3<f64>) -> Vector3<f64> {
        self.linear + self.angular.cross(&(point - self.centre))
    }
}

/// Writes to `found` the contacts that `body` in pose `hull_from_body` will have within `seconds`, the earliest first, and
/// then those farthest from the ones before. There are at most `most`.
pub(crate) fn sweep(
    found: &mut Vec<SweptContact>,
    hull: &Hull,
    body: &Samples,
    hull_from_body: &Isometry3<f64>,
    motion: &BodyMotion,
    seconds: f64,
    most: usize,
) {
    found.clear();
    let further = if body.smooth().is_some() { BETWEEN_SAMPLES } else { 0.0 };
    let mut sweep = Sweep::new(hull, seconds + further);
    let (centre, radius) = body.bounding_sphere();
    let centre = hull_from_body * centre;
    let sphere = MovingPoint { start: centre, velocity: motion.at(&centre) };
    if most == 0 || !sweep.may_enter(&sphere, radius, motion.angular.norm() * radius) {
        return;
    }

    let mut contact_of = |sample: &Sample| contact_of(&mut sweep, sample, hull_from_body, motion);
    let of_samples = body.points().iter().filter_map(|sample| Some((sample.normal, contact_of(sample)?)));
    let mut earliest: Option<(Vector3<f64>, SweptContact)> = None;
    for (normal, contact) in of_samples {
        found.push(contact);
        if earliest.is_none_or(|(_, before)| contact.seconds < before.seconds) {
            earliest = Some((normal, contact));
        }
    }
    match (body.smooth(), earliest) {
        (Some(smooth), Some((normal, _))) => {
            *found = first_touch(&normal, |outwards| {
                let points = smooth.support(outwards);
                let facing = |sample: &Sample| {
                    let contact = contact_of(sample)?;
                    Some(SweptContact { direction: hull_from_body * -sample.normal, ..contact })
                };
                points.iter().filter_map(facing).collect()
            });
            found.retain(|contact| contact.seconds <= seconds);
        }
        _ => keep_farthest(found, most.min(MAX_SWEPT_CONTACTS)),
    }
}

/// The contact of one sample; `None` where it does not enter the hull.
fn contact_of(
    sweep: &mut Sweep,
    Sample { point, normal }: &Sample,
    hull_from_body: &Isometry3<f64>,
    motion: &BodyMotion,
) -> Option<SweptContact> {
    let start = hull_from_body * point;
    let entry = sweep.first_entry(&MovingPoint { start, velocity: motion.at(&start) })?;
    // A sample is met by what it faces; what comes from behind meets others first.
    let outwards = hull_from_body * normal;
    let is_faced = outwards == Vector3::zeros() || outwards.dot(&entry.normal) < SUPPORTED_COSINE;
    is_faced.then_some(SweptContact { point: start, direction: entry.normal, seconds: entry.seconds })
}

/// The first contacts of a round body, which is met between its samples, and faces there what it meets: a search for the
/// outward direction, from `start` on, whose points enter first. `contacts_at` returns the contacts of a direction's points.
fn first_touch(
    start: &Vector3<f64>,
    mut contacts_at: impl FnMut(&Vector3<f64>) -> Vec<SweptContact>,
) -> Vec<SweptContact> {
    let first = |contacts: &[SweptContact]| {
        contacts.iter().map(|contact| contact.seconds).fold(f64::INFINITY, f64::min)
    };
    let mut outwards = *start;
    let mut best = contacts_at(&outwards);
    let mut angle = FIRST_ANGLE;
    while angle > LAST_ANGLE {
        let right = outwards.cross(&Vector3::ith(outwards.iamin(), 1.0)).normalize();
        let up = outwards.cross(&right);
        let mut has_improved = false;
        for aside in [right, -right, up, -up] {
            let direction = outwards * angle.cos() + aside * angle.sin();
            let contacts = contacts_at(&direction);
            if first(&contacts) < first(&best) {
                (outwards, best, has_improved) = (direction, contacts, true);
                break;
            }
        }
        if !has_improved {
            angle *= 0.5;
        }
    }
    best
}

/// Keeps the earliest contact, and up to `most` in all of which each is the farthest from those before it.
fn keep_farthest(contacts: &mut Vec<SweptContact>, most: usize) {
    let earliest = (0..contacts.len()).min_by(|&a, &b| contacts[a].seconds.total_cmp(&contacts[b].seconds));
    let Some(mut next) = earliest else { return };
    for kept in 0..contacts.len().min(most) {
        contacts.swap(kept, next);
        let to_kept = |k: usize| {
            let distances = contacts[..=kept].iter().map(|other| (contacts[k].point - other.point).norm_squared());
            distances.fold(f64::INFINITY, f64::min)
        };
        let farthest = (kept + 1..contacts.len()).max_by(|&a, &b| to_kept(a).total_cmp(&to_kept(b)));
        next = farthest.unwrap_or(kept);
    }
    contacts.truncate(most);
}
