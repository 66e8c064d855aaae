//! Contacts that a body will have with the hull before the next step ends: samples that are outside the hull now and enter
//! it on their way.

use super::tuning::{MAX_SWEPT_CONTACTS, SUPPORTED_COSINE};
use crate::hull::{EdgeModel, Hull, MovingPoint, Sweep};
use crate::sample::{Sample, Samples};
use nalgebra::{Isometry3, Point3, Vector3};

/// How much later than a round body its samples may be met, in seconds: of a ball of 2 cm they lie up to 7 mm behind the
/// point between them that is met first.
const BETWEEN_SAMPLES: f64 = 0.02;

/// The first and the last angle, in radians, between directions in which a round body may be met first: from the distance
/// of samples to that at which a ball of 5 cm is met a tenth of a millimetre earlier.
const FIRST_ANGLE: f64 = 0.5;
const LAST_ANGLE: f64 = 0.05;

/// Contacts are met at once where their times differ by less than this part of the step, or by less than the body needs for
/// this part of a pixel, whichever is less: times and edges are only so exact. At 40 m/s the part of the step is 0.7 mm, by
/// which an edge that a ball of 5 cm meets 15 degrees off would count as a face.
const SAME_TIME: f64 = 2e-3;
const SAME_PLACE_PX: f64 = 0.05;

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
    /// Unit direction out of the hull, along which the surface pushes.
    pub(crate) direction: Vector3<f64>,
    /// The surface's unit outward normal where it enters; at an edge of the surface, that of one side.
    pub(crate) surface: Vector3<f64>,
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
    found.extend(body.points().iter().filter_map(&mut contact_of));
    let Some(earliest) = earliest_of(found) else { return };

    let outwards = hull_from_body.inverse_transform_vector(&-found[earliest].direction);
    match body.smooth().filter(|smooth| !smooth.support(&outwards).is_empty()) {
        Some(smooth) => {
            let mut contacts_at = |outwards: &Vector3<f64>| -> Vec<SweptContact> {
                smooth.support(outwards).iter().filter_map(&mut contact_of).collect()
            };
            let of_place = SAME_PLACE_PX * hull.pixel_size(&centre) / sphere.velocity.norm();
            let same_time = of_place.min(SAME_TIME * seconds);
            *found = first_touch(&outwards, hull_from_body, same_time, &mut contacts_at);
            // Where the point that faces the surface is inside already, the body touches there.
            let touches = found.first().is_some_and(|first| {
                let opposite = hull_from_body.inverse_transform_vector(&-first.surface);
                let points = smooth.support(&opposite);
                points
                    .iter()
                    .any(|sample| hull.inside_by(&(hull_from_body * sample.point), EdgeModel::Coverage))
            });
            if touches {
                found.clear();
            }
        }
        None => order_by_distance(found, earliest),
    }
    found.retain(|contact| contact.seconds <= seconds);
    found.truncate(most.min(MAX_SWEPT_CONTACTS));
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
    let contact =
        SweptContact { point: start, direction: entry.normal, surface: entry.normal, seconds: entry.seconds };
    is_faced.then_some(contact)
}

/// The place of the earliest contact.
fn earliest_of(contacts: &[SweptContact]) -> Option<usize> {
    (0..contacts.len()).min_by(|&a, &b| contacts[a].seconds.total_cmp(&contacts[b].seconds))
}

/// The time of the earliest contact.
fn first_of(contacts: &[SweptContact]) -> f64 {
    earliest_of(contacts).map_or(f64::INFINITY, |first| contacts[first].seconds)
}

/// The first contacts of a round body, which is met between its samples: a search for the outward direction, from `start` on,
/// whose points enter first. `contacts_at` returns the contacts of a direction's points; times that differ by less than
/// `same_time` are equal.
fn first_touch(
    start: &Vector3<f64>,
    hull_from_body: &Isometry3<f64>,
    same_time: f64,
    contacts_at: &mut impl FnMut(&Vector3<f64>) -> Vec<SweptContact>,
) -> Vec<SweptContact> {
    let mut outwards = *start;
    let mut best = contacts_at(&outwards);
    let mut angle = FIRST_ANGLE;
    while angle > LAST_ANGLE {
        let right = outwards.cross(&Vector3::ith(outwards.iamin(), 1.0)).normalize();
        let up = outwards.cross(&right);
        let around = [right, -right, up, -up].map(|aside| outwards * angle.cos() + aside * angle.sin());
        let tried = around.map(|direction| (direction, contacts_at(&direction)));
        let earliest = tried.into_iter().min_by(|(_, a), (_, b)| first_of(a).total_cmp(&first_of(b)));
        match earliest {
            Some((direction, contacts)) if first_of(&contacts) < first_of(&best) => {
                (outwards, best) = (direction, contacts);
            }
            _ => angle *= 0.5,
        }
    }

    // A face is met by the point that faces it. An edge is met by one that faces neither of the faces beside it: there the
    // body's own normal is the contact's.
    let Some(first) = best.first() else { return best };
    let facing = contacts_at(&hull_from_body.inverse_transform_vector(&-first.direction));
    if first_of(&facing) <= first_of(&best) + same_time {
        return facing;
    }
    best.iter_mut().for_each(|contact| contact.direction = hull_from_body * -outwards);
    best
}

/// Moves the earliest contact, and after it those of which each is the farthest from those before, to the front.
fn order_by_distance(contacts: &mut [SweptContact], earliest: usize) {
    let mut next = earliest;
    for kept in 0..contacts.len().min(MAX_SWEPT_CONTACTS) {
        contacts.swap(kept, next);
        let to_kept = |k: usize| {
            let distances =
                contacts[..=kept].iter().map(|other| (contacts[k].point - other.point).norm_squared());
            distances.fold(f64::INFINITY, f64::min)
        };
        let farthest = (kept + 1..contacts.len()).max_by(|&a, &b| to_kept(a).total_cmp(&to_kept(b)));
        next = farthest.unwrap_or(kept);
    }
}
