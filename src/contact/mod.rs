//! Contacts between a hull and rigid bodies: pure geometry, in the hull's frame.
//!
//! ```text
//!       +-----------+   body             each colliding sample has an exit vector, w
//!       |           |                    samples with like exit vectors form a cluster, V its mean
//!    ---*--*--*--*--*---  hull           each sample's depth is its own exit along V
//!          ^  V  ^                       a few samples a cluster are kept: deepest, then farthest apart
//! ```

mod body_response;
mod cluster;
mod escape;
mod manifold;
mod pipeline;
mod reduce;
mod share_out;
mod tilt;
pub(crate) mod tuning;

pub use body_response::{body_response, body_responses};

use crate::hull::{EdgeModel, ExitRay, Hull};
use crate::sample::Samples;
use nalgebra::{Isometry3, Point3, Vector3};
use pipeline::ContactPipeline;
use share_out::share_out;

/// How contacts are made from the colliding samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Mode {
    /// Samples with like exit directions form clusters, guided by the body's own normals: bodies neither tip, nor are
    /// flung, nor roll away.
    #[default]
    Clustered,
    /// The paper's section 5 to the letter: one direction for the body from the paper's normals, each colliding
    /// sample a contact with its own exit as depth, however deep.
    Paper,
    /// Each colliding sample along its own exit direction.
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
        Self { mode: Mode::Clustered, max_depth: tuning::MAX_DEPTH, max_contacts: tuning::MAX_CONTACTS }
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

/// Contact points that leave the hull in one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Manifold {
    /// Unit outward direction of the hull, in the hull's frame.
    pub direction: Vector3<f64>,
    /// Index of the view whose silhouette edge gave the direction of the deepest sample. `None` where the direction is
    /// no sample's: that of a body that is swallowed or pierced, and the paper's V.
    pub view: Option<usize>,
}

/// A point of a manifold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ManifoldPoint {
    /// A point of the body's surface, inside the hull, in the hull's frame.
    pub point: Point3<f64>,
    /// Metres to go along the manifold's direction, not negative.
    pub depth: f64,
    /// Index among the body's samples. `None` for a support point of a smooth body, which is none of them.
    pub sample: Option<usize>,
    /// Index of its manifold.
    pub manifold: usize,
}

/// The contacts of one body, and what the next step wants to know of them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BodyContacts {
    /// The deepest first; each has points.
    pub manifolds: Vec<Manifold>,
    /// The points of all manifolds, the most important first: manifolds give one in turn.
    pub points: Vec<ManifoldPoint>,
    /// The direction that was chosen for a body that is swallowed or pierced, to be preferred in the next step.
    pub escape: Option<Vector3<f64>>,
}

impl BodyContacts {
    /// The points with their directions, in their order.
    pub fn contacts(&self) -> impl ExactSizeIterator<Item = Contact> {
        self.points.iter().map(|&ManifoldPoint { point, depth, manifold, .. }| Contact {
            point,
            direction: self.manifolds[manifold].direction,
            depth,
        })
    }

    /// The points of one manifold, in their order.
    pub fn points_of(&self, manifold: usize) -> impl Iterator<Item = &ManifoldPoint> {
        self.points.iter().filter(move |point| point.manifold == manifold)
    }

    /// Removes all, and keeps the memory.
    fn reset(&mut self) {
        self.manifolds.clear();
        self.points.clear();
        self.escape = None;
    }

    /// Becomes like `other`, in the same memory.
    #[cfg(feature = "ode")]
    pub(crate) fn copy(&mut self, other: &Self) {
        self.manifolds.clone_from(&other.manifolds);
        self.points.clone_from(&other.points);
        self.escape = other.escape;
    }
}

/// The paper's response of a body: the vector that moves it out of the hull.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyResponse {
    /// In metres, in the hull's frame; zero where nothing collides.
    pub vector: Vector3<f64>,
    /// How many samples collide.
    pub colliding: usize,
}

impl BodyResponse {
    /// That of a body that does not touch the hull.
    pub(crate) const NONE: Self = Self { vector: Vector3::new(0.0, 0.0, 0.0), colliding: 0 };
}

/// A body to collide.
#[derive(Debug, Clone, Copy)]
pub struct SampledBody<'a> {
    /// Its surface, in its own frame.
    pub samples: &'a Samples,
    /// Its pose. In one that is not finite it touches nothing.
    pub hull_from_body: Isometry3<f64>,
    /// The [`BodyContacts::escape`] of the step before.
    pub last_escape: Option<Vector3<f64>>,
}

/// A body sample inside the hull, in the hull's frame.
#[derive(Debug, Clone, Copy)]
struct PenetratingSample {
    /// Its index among the body's samples.
    index: usize,
    point: Point3<f64>,
    /// The body's outward normal there; zero where it is not known.
    normal: Vector3<f64>,
    /// Index of the view whose edge gave the exit direction.
    view: usize,
    /// Unit exit direction.
    direction: Vector3<f64>,
    /// Metres along it to the exit; zero where that was not asked.
    depth: f64,
}

impl PenetratingSample {
    fn ray(&self) -> ExitRay {
        ExitRay { point: self.point, direction: self.direction, view: self.view }
    }
}

/// The contacts of `body` in pose `hull_from_body` with `hull`. `last_escape` is the [`BodyContacts::escape`] of the
/// step before.
///
/// Many bodies are sooner collided together, by [`collide_many`].
pub fn collide(
    hull: &Hull,
    body: &Samples,
    hull_from_body: &Isometry3<f64>,
    settings: &Settings,
    last_escape: Option<Vector3<f64>>,
) -> BodyContacts {
    let mut contacts = [BodyContacts::default()];
    let body = SampledBody { samples: body, hull_from_body: *hull_from_body, last_escape };
    collide_into(&mut contacts, hull, &[body], settings);
    let [contacts] = contacts;
    contacts
}

/// The contacts of each of `bodies` with `hull`, in their order, written to `contacts`, whose memory is used again.
///
/// What is asked of the hull is asked for all bodies side by side. With the feature `threads` the bodies are shared out
/// among the threads of rayon's current pool. No body's contacts depend on another's: they have the bits that
/// [`collide`] gives.
///
/// ```
/// use nalgebra::{Isometry3, Point3, Vector3};
/// use ode_visual_hull::contact::{SampledBody, Settings, collide_many};
/// use ode_visual_hull::hull::{Aabb, HullData};
/// use ode_visual_hull::sample;
/// use ode_visual_hull::synthetic::{Texture, Placed, Solid, Subject, layout, silhouette};
///
/// # fn main() -> ode_visual_hull::Result<()> {
/// // A table whose top lies at z = 0.2 m, before four cameras that look along it.
/// let (sides, origin) = (Vector3::new(0.5, 0.5, 0.4), Isometry3::identity());
/// let table = Subject::new(vec![Placed::new(Solid::cuboid(sides)?, origin, Texture::plain([200; 3]))]);
/// let data = HullData::new();
/// data.set_bounds(Aabb::new(Point3::new(-0.6, -0.6, -0.3), Point3::new(0.6, 0.6, 0.8))?)?;
/// for camera in layout::face_on(sides, &origin, 2.8, 0.2, (320, 240), 0.45)? {
///     data.set_mask(data.add_view(camera.clone())?, &silhouette(&camera, &table))?;
/// }
/// let hull = data.update(0.0)?;
///
/// // One box stands 5 mm deep in the table, one hangs above it.
/// let samples = sample::box_(Vector3::new(0.2, 0.2, 0.2), 0.03)?;
/// let at = |z: f64| Isometry3::translation(0.0, 0.0, z);
/// let bodies =
///     [0.295, 0.5].map(|z| SampledBody { samples: &samples, hull_from_body: at(z), last_escape: None });
/// let mut contacts = Vec::new();
/// collide_many(&hull, &bodies, &Settings::default(), &mut contacts);
/// let [standing, hanging] = &contacts[..] else { panic!("one for each body") };
/// assert!(hanging.points.is_empty());
///
/// // The points of the standing box leave together, upwards.
/// assert_eq!(standing.manifolds.len(), 1);
/// assert!(standing.manifolds[0].direction.z > 0.99);
/// assert!(standing.points_of(0).all(|point| (point.depth - 0.005).abs() < 0.005));
///
/// // Each with its direction, as ODE takes them.
/// for contact in standing.contacts() {
///     let moved = contact.point + contact.direction * (contact.depth + 0.005);
///     assert!(!hull.inside(&moved));
/// }
/// # Ok(())
/// # }
/// ```
pub fn collide_many(
    hull: &Hull,
    bodies: &[SampledBody],
    settings: &Settings,
    contacts: &mut Vec<BodyContacts>,
) {
    contacts.resize_with(bodies.len(), BodyContacts::default);
    collide_into(contacts, hull, bodies, settings);
}

/// [`collide_many`] with a place in `contacts` for each of `bodies`.
pub(crate) fn collide_into(
    contacts: &mut [BodyContacts],
    hull: &Hull,
    bodies: &[SampledBody],
    settings: &Settings,
) {
    contacts.iter_mut().for_each(BodyContacts::reset);
    if settings.max_contacts > 0 {
        share_out(bodies, contacts, &|bodies, contacts| collide_on_thread(contacts, hull, bodies, settings));
    }
}

/// [`collide_into`] on the calling thread, for `contacts` that are empty.
fn collide_on_thread(
    contacts: &mut [BodyContacts],
    hull: &Hull,
    bodies: &[SampledBody],
    settings: &Settings,
) {
    let edge = if settings.mode == Mode::Paper { EdgeModel::Pixel } else { EdgeModel::Coverage };
    ContactPipeline::with_scratch(|pipeline| {
        pipeline.collect_penetrating(hull, bodies, edge, usize::MAX);
        match settings.mode {
            Mode::Clustered => pipeline.group_by_clusters(hull, bodies, settings.max_depth),
            Mode::Paper => pipeline.group_by_paper(hull),
            Mode::Point => pipeline.leave_alone(hull, settings.max_depth),
            Mode::Single => pipeline.leave_deepest_alone(hull, settings.max_depth),
        }
        pipeline.reduce_to_contacts(hull, settings, contacts);
    });
}

/// Any contacts, the first found, up to `settings.max_contacts`, written to `contacts`: for callers who only want to
/// know whether there are some.
#[cfg(feature = "ode")]
pub(crate) fn collide_any(
    contacts: &mut BodyContacts,
    hull: &Hull,
    body: &Samples,
    hull_from_body: &Isometry3<f64>,
    settings: &Settings,
) {
    contacts.reset();
    let body = SampledBody { samples: body, hull_from_body: *hull_from_body, last_escape: None };
    ContactPipeline::with_scratch(|pipeline| {
        pipeline.collect_penetrating(hull, &[body], EdgeModel::Coverage, settings.max_contacts);
        pipeline.leave_first_alone(hull, settings);
        pipeline.reduce_to_contacts(hull, settings, std::slice::from_mut(contacts));
    });
}

#[cfg(test)]
mod tests;
