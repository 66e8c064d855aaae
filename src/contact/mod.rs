//! Contacts between a hull and rigid bodies: pure geometry, in the hull's frame.
//!
//! ```text
//!       +-----------+   body             each colliding sample has a way out of the hull, w
//!       |           |                    samples with like ways out form a cluster, V its mean
//!    ---*--*--*--*--*---  hull           each sample's depth is its own exit along V
//!          ^  V  ^                       a few samples a cluster are kept: deepest, then farthest apart
//! ```

mod cluster;
mod escape;
mod group;
mod reduce;
mod room;
mod tilt;

pub use crate::hull::BodyResponse;
use crate::hull::{EdgeModel, Hull};
use crate::sample::Samples;
use nalgebra::{Isometry3, Point3, Vector3};
use room::Room;

/// How contacts are made from the colliding samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Mode {
    /// Samples with like ways out form clusters, guided by the body's own normals: neither tips, flings nor rolls
    /// away.
    #[default]
    Clustered,
    /// The paper's section 5 to the letter: one direction for the body from the paper's normals, each colliding
    /// sample a contact with its own exit as depth, however deep.
    Paper,
    /// Each colliding sample along its own way out.
    Point,
    /// The deepest sample alone, as Lok et al. have it; there to be compared with.
    Single,
}

/// What a hull asks of its contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// How they are made.
    pub mode: Mode,
    /// The largest depth reported, in metres (not in [`Mode::Paper`]): a body deep inside leaves slowly instead of
    /// being shot out.
    pub max_depth: f64,
    /// How many at most.
    pub max_contacts: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { mode: Mode::Clustered, max_depth: 0.05, max_contacts: 8 }
    }
}

/// One contact, in the hull's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// A point of the body's surface, inside the hull.
    pub point: Point3<f64>,
    /// Unit outward direction of the hull: the body leaves along it.
    pub direction: Vector3<f64>,
    /// Metres to go along it, not negative.
    pub depth: f64,
}

/// The contacts of one body, and what the next step wants to know of them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Contacts {
    /// Deepest cluster first.
    pub contacts: Vec<Contact>,
    /// The way out that was chosen for a body that is swallowed or pierced, to be preferred in the next step.
    pub escape: Option<Vector3<f64>>,
}

impl Contacts {
    /// None, in the same memory.
    fn clear(&mut self) {
        self.contacts.clear();
        self.escape = None;
    }

    /// Becomes like `other`, in the same memory.
    pub(crate) fn copy(&mut self, other: &Self) {
        self.contacts.clone_from(&other.contacts);
        self.escape = other.escape;
    }
}

/// A body to collide.
#[derive(Debug, Clone, Copy)]
pub struct Body<'a> {
    /// Its surface, in its own frame.
    pub samples: &'a Samples,
    /// Its pose. In one that is not finite it touches nothing.
    pub hull_from_body: Isometry3<f64>,
    /// The [`Contacts::escape`] of the step before.
    pub last_escape: Option<Vector3<f64>>,
}

/// A body sample inside the hull, in the hull's frame.
#[derive(Debug, Clone, Copy)]
struct Colliding {
    point: Point3<f64>,
    /// The body's outward normal there; zero where it is not known.
    normal: Vector3<f64>,
    /// Index of the view whose edge gave the way out.
    view: usize,
    /// Unit direction of its way out.
    direction: Vector3<f64>,
    /// Metres along it; zero where nobody has asked.
    depth: f64,
}

/// The contacts of `body` in pose `hull_from_body` with `hull`. `last_escape` is the [`Contacts::escape`] of the step
/// before.
///
/// Many bodies are sooner collided together, by [`collide_many`].
pub fn collide(
    hull: &Hull,
    body: &Samples,
    hull_from_body: &Isometry3<f64>,
    settings: &Settings,
    last_escape: Option<Vector3<f64>>,
) -> Contacts {
    let mut contacts = [Contacts::default()];
    let body = Body { samples: body, hull_from_body: *hull_from_body, last_escape };
    collide_into(&mut contacts, hull, &[body], settings);
    let [contacts] = contacts;
    contacts
}

/// The contacts of each of `bodies` with `hull`, in their order, written to `contacts`, whose memory is used again.
///
/// What is asked of the hull is asked for all bodies side by side. No body's contacts depend on another's: they have
/// the bits that [`collide`] gives.
pub fn collide_many(hull: &Hull, bodies: &[Body], settings: &Settings, contacts: &mut Vec<Contacts>) {
    contacts.resize_with(bodies.len(), Contacts::default);
    collide_into(contacts, hull, bodies, settings);
}

/// The same, a place in `contacts` for each of `bodies`.
pub(crate) fn collide_into(contacts: &mut [Contacts], hull: &Hull, bodies: &[Body], settings: &Settings) {
    contacts.iter_mut().for_each(Contacts::clear);
    let Settings { mode, max_depth, max_contacts } = *settings;
    if max_contacts == 0 {
        return;
    }
    Room::with(|room| {
        room.take_inside(hull, bodies, usize::MAX);
        match mode {
            Mode::Clustered => room.group_by_clusters(hull, bodies, max_depth),
            Mode::Paper => room.group_by_paper(hull, bodies),
            Mode::Point => room.group_by_body(hull, max_depth),
            Mode::Single => return room.contacts_of_deepest(hull, settings, contacts),
        }
        room.contacts_of_groups(hull, settings, contacts);
    });
}

/// Any contacts, the first found, up to `settings.max_contacts`: for callers who only want to know whether there are
/// some.
pub fn collide_any(
    hull: &Hull,
    body: &Samples,
    hull_from_body: &Isometry3<f64>,
    settings: &Settings,
) -> Vec<Contact> {
    let mut contacts = Contacts::default();
    collide_any_into(&mut contacts, hull, body, hull_from_body, settings);
    contacts.contacts
}

/// The same, written to `contacts`.
pub(crate) fn collide_any_into(
    contacts: &mut Contacts,
    hull: &Hull,
    body: &Samples,
    hull_from_body: &Isometry3<f64>,
    settings: &Settings,
) {
    contacts.clear();
    let body = Body { samples: body, hull_from_body: *hull_from_body, last_escape: None };
    Room::with(|room| {
        room.take_inside(hull, &[body], settings.max_contacts);
        room.contacts_of_first(hull, settings, contacts);
    });
}

/// The paper's response of a body (section 5): the mean of its colliding samples' responses gives the direction, the
/// longest exit along it the length. Where the responses cancel out, the deepest sample's stands in.
pub fn body_response(hull: &Hull, body: &Samples, hull_from_body: &Isometry3<f64>) -> BodyResponse {
    let points = || body.points().iter().map(|sample| hull_from_body * sample.point);
    let responses: Vec<_> = points().filter_map(|p| Some((p, hull.respond(&p)?))).collect();
    let colliding = responses.len();
    let deepest = responses.iter().rev().max_by(|(_, a), (_, b)| a.depth.total_cmp(&b.depth));
    let Some((_, deepest)) = deepest else { return BodyResponse { vector: Vector3::zeros(), colliding } };
    let sum: Vector3<f64> = responses.iter().map(|(_, response)| response.w()).sum();
    let direction = sum.try_normalize(0.0).unwrap_or(deepest.normal);
    let exits = responses.iter().map(|(p, _)| hull.exit(p, &direction, EdgeModel::Pixel));
    BodyResponse { vector: direction * exits.fold(0.0, f64::max), colliding }
}

fn own_contact(sample: &Colliding, max_depth: f64) -> Contact {
    Contact { point: sample.point, direction: sample.direction, depth: sample.depth.min(max_depth) }
}

#[cfg(test)]
mod tests;
