//! Contacts between a hull and rigid bodies: pure geometry, in the hull's frame.
//!
//! ```text
//!       +-----------+   body             each penetrating sample has an exit vector, w
//!       |           |                    samples with similar exit vectors form a cluster, V is their mean
//!    ---*--*--*--*--*---  hull           a sample's depth is its own exit distance along V
//!          ^  V  ^                       a few samples per cluster are kept: the deepest, then the farthest apart
//! ```

mod body_response;
mod cluster;
mod escape;
mod manifold;
mod pipeline;
mod reduce;
mod share_out;
#[cfg(feature = "ode")]
mod sweep;
mod tilt;
pub(crate) mod tuning;

pub use body_response::{body_response, body_responses};
#[cfg(feature = "ode")]
pub(crate) use sweep::{BodyMotion, SweptContact, sweep};

use crate::hull::{EdgeModel, ExitRay, Hull};
use crate::sample::Samples;
use nalgebra::{Isometry3, Point3, Vector3};
use pipeline::ContactPipeline;
use share_out::share_out;

/// How contacts are made from the samples of a body that are inside the hull.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Mode {
    /// Samples with similar exit directions form clusters, and the body's own normals decide which samples belong
    /// together. Bodies neither tip over nor are thrown off, and round ones do not roll away.
    #[default]
    Clustered,
    /// The paper's section 5: the body has one direction, computed from the paper's normals. Each sample inside is a
    /// contact, and its depth is its own exit distance along that direction, without a limit.
    Paper,
    /// Each sample inside is a contact with its own exit direction.
    Point,
    /// The deepest sample is the only contact, as in Lok et al.; provided for comparison.
    Single,
}

/// How contacts with a hull are made, and their limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// How contacts are made.
    pub mode: Mode,
    /// Largest depth reported, in metres; [`Mode::Paper`] ignores it. It limits how fast a body that is deep inside is
    /// pushed out. In ODE a hull geom may report less, by the length of the step.
    pub max_depth: f64,
    /// Largest number of contacts per body.
    pub max_contacts: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { mode: Mode::Clustered, max_depth: tuning::MAX_DEPTH, max_contacts: tuning::MAX_CONTACTS }
    }
}

/// One contact, in the hull's frame.
///
/// ```
/// # use nalgebra::{Isometry3, Point3, Vector3};
/// # use ode_visual_hull::contact::{Contact, Settings, collide};
/// # use ode_visual_hull::hull::{Aabb, HullData};
/// # use ode_visual_hull::sample;
/// # use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, layout, silhouette};
/// # fn main() -> ode_visual_hull::Result<()> {
/// # let (sides, origin) = (Vector3::new(0.5, 0.5, 0.4), Isometry3::identity());
/// # let table = Subject::new(vec![Placed::new(Solid::cuboid(sides)?, origin, Texture::plain([200; 3]))]);
/// # let data = HullData::new();
/// # data.set_bounds(Aabb::new(Point3::new(-0.6, -0.6, -0.3), Point3::new(0.6, 0.6, 0.8))?)?;
/// # for camera in layout::face_on(sides, &origin, 2.8, 0.2, (320, 240), 0.45)? {
/// #     data.set_mask(data.add_view(camera.clone())?, &silhouette(&camera, &table))?;
/// # }
/// # let hull = data.update(0.0)?;
/// // A ball of radius 0.1 m lies 5 mm deep in the top of a table, at z = 0.2 m.
/// let (ball, pose) = (sample::sphere(0.1, 0.03)?, Isometry3::translation(0.0, 0.0, 0.295));
/// let found = collide(&hull, &ball, &pose, &Settings::default(), None);
/// let Contact { point, direction, depth } = found.contacts().next().expect("the ball touches the table");
///
/// // The lowest point of the ball is pushed up, until it lies on the table's surface.
/// assert!(direction.z > 0.99 && (depth - 0.005).abs() < 0.005);
/// assert!(!hull.inside(&(point + direction * (depth + 0.005))));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// A point of the body's surface that is inside the hull.
    pub point: Point3<f64>,
    /// Unit direction out of the hull, in which the body is pushed.
    pub direction: Vector3<f64>,
    /// Distance from the point to the exit along the direction, in metres; not negative.
    pub depth: f64,
}

/// A group of contact points that are pushed out of the hull in one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Manifold {
    /// Unit direction out of the hull, in the hull's frame.
    pub direction: Vector3<f64>,
    /// Index of the view whose silhouette edge gave the exit direction of the deepest sample. `None` where the
    /// manifold's direction comes from no single sample: for a swallowed or pierced body, and for the paper's V.
    pub view: Option<usize>,
}

/// A point of a [`Manifold`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ManifoldPoint {
    /// A point of the body's surface that is inside the hull, in the hull's frame.
    pub point: Point3<f64>,
    /// Distance from the point to the exit along the manifold's direction, in metres; not negative.
    pub depth: f64,
    /// Index among the body's samples. `None` for a support point of a smooth body, which is not one of its samples.
    pub sample: Option<usize>,
    /// Index of the manifold in [`BodyContacts::manifolds`].
    pub manifold: usize,
}

/// The contacts of one body, and the escape direction to pass to the next step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BodyContacts {
    /// The manifolds, the deepest first. Each has at least one point.
    pub manifolds: Vec<Manifold>,
    /// The points of all manifolds, the most important first: the manifolds contribute one point each in turn.
    pub points: Vec<ManifoldPoint>,
    /// The exit direction chosen for a swallowed or pierced body; `None` for any other body. Pass it to the next step
    /// as [`SampledBody::last_escape`], which prefers it.
    pub escape: Option<Vector3<f64>>,
}

impl BodyContacts {
    /// The contacts: each point with the direction of its manifold, in the order of [`Self::points`].
    pub fn contacts(&self) -> impl ExactSizeIterator<Item = Contact> {
        self.points.iter().map(|&ManifoldPoint { point, depth, manifold, .. }| Contact {
            point,
            direction: self.manifolds[manifold].direction,
            depth,
        })
    }

    /// The points of one manifold, in the order of [`Self::points`].
    pub fn points_of(&self, manifold: usize) -> impl Iterator<Item = &ManifoldPoint> {
        self.points.iter().filter(move |point| point.manifold == manifold)
    }

    /// The depth of the deepest contact in metres; 0 without contacts.
    #[cfg(feature = "ode")]
    pub(crate) fn deepest(&self) -> f64 {
        self.points.iter().map(|point| point.depth).fold(0.0, f64::max)
    }

    /// Removes all contacts, and keeps the memory.
    fn reset(&mut self) {
        self.manifolds.clear();
        self.points.clear();
        self.escape = None;
    }

    /// Copies `other` without a new allocation where the memory suffices.
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
    /// The response vector in metres, in the hull's frame; zero for a body that does not touch the hull.
    pub vector: Vector3<f64>,
    /// Number of samples inside the hull.
    pub colliding: usize,
}

impl BodyResponse {
    /// The response of a body that does not touch the hull.
    pub(crate) const NONE: Self = Self { vector: Vector3::new(0.0, 0.0, 0.0), colliding: 0 };
}

/// A body to collide with a hull.
#[derive(Debug, Clone, Copy)]
pub struct SampledBody<'a> {
    /// Surface samples, in the body's frame.
    pub samples: &'a Samples,
    /// Pose of the body in the hull's frame. A body whose pose is not finite touches nothing.
    pub hull_from_body: Isometry3<f64>,
    /// [`BodyContacts::escape`] of the previous step.
    pub last_escape: Option<Vector3<f64>>,
}

/// A body sample inside the hull, in the hull's frame.
#[derive(Debug, Clone, Copy)]
struct PenetratingSample {
    /// Index among the body's samples.
    index: usize,
    point: Point3<f64>,
    /// The body's unit outward normal at the sample; zero where it is not known.
    normal: Vector3<f64>,
    /// Index of the view whose edge gave the exit direction.
    view: usize,
    /// Unit exit direction.
    direction: Vector3<f64>,
    /// Distance to the exit along the exit direction, in metres; zero until it is computed.
    depth: f64,
    /// Whether a view is overruled at the sample.
    overrules: bool,
}

impl PenetratingSample {
    /// The ray from the sample along its own exit direction.
    fn ray(&self) -> ExitRay {
        let Self { point, direction, view, overrules, .. } = *self;
        ExitRay { point, direction, view, overrules }
    }
}

/// The contacts of `body` in pose `hull_from_body` with `hull`. `last_escape` is the [`BodyContacts::escape`] of the
/// previous step.
///
/// [`collide_many`] is faster for more than one body.
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

/// Computes the contacts of each of `bodies` with `hull` and writes them to `contacts` in the order of the bodies. The
/// memory of `contacts` is reused.
///
/// Queries of the hull are batched over all bodies. With the feature `threads` the bodies are divided among the threads
/// of rayon's current pool. The contacts of a body do not depend on the other bodies: they have the same bits as from
/// [`collide`].
///
/// ```
/// use nalgebra::{Isometry3, Point3, Vector3};
/// use ode_visual_hull::contact::{SampledBody, Settings, collide_many};
/// use ode_visual_hull::hull::{Aabb, HullData};
/// use ode_visual_hull::sample;
/// use ode_visual_hull::synthetic::{Texture, Placed, Solid, Subject, layout, silhouette};
///
/// # fn main() -> ode_visual_hull::Result<()> {
/// // A table whose top is at z = 0.2 m, seen from its sides by four cameras.
/// let (sides, origin) = (Vector3::new(0.5, 0.5, 0.4), Isometry3::identity());
/// let table = Subject::new(vec![Placed::new(Solid::cuboid(sides)?, origin, Texture::plain([200; 3]))]);
/// let data = HullData::new();
/// data.set_bounds(Aabb::new(Point3::new(-0.6, -0.6, -0.3), Point3::new(0.6, 0.6, 0.8))?)?;
/// for camera in layout::face_on(sides, &origin, 2.8, 0.2, (320, 240), 0.45)? {
///     data.set_mask(data.add_view(camera.clone())?, &silhouette(&camera, &table))?;
/// }
/// let hull = data.update(0.0)?;
///
/// // One box stands 5 mm deep in the table, the other hangs above it.
/// let samples = sample::box_(Vector3::new(0.2, 0.2, 0.2), 0.03)?;
/// let at = |z: f64| Isometry3::translation(0.0, 0.0, z);
/// let bodies =
///     [0.295, 0.5].map(|z| SampledBody { samples: &samples, hull_from_body: at(z), last_escape: None });
/// let mut contacts = Vec::new();
/// collide_many(&hull, &bodies, &Settings::default(), &mut contacts);
/// let [standing, hanging] = &contacts[..] else { panic!("each body has its contacts") };
/// assert!(hanging.points.is_empty());
///
/// // All points of the standing box are pushed in one direction, upwards.
/// assert_eq!(standing.manifolds.len(), 1);
/// assert!(standing.manifolds[0].direction.z > 0.99);
/// assert!(standing.points_of(0).all(|point| (point.depth - 0.005).abs() < 0.005));
///
/// // Each contact has its own direction, as ODE expects.
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

/// [`collide_many`] into a slice with one element for each of `bodies`.
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

/// [`collide_into`] on the calling thread; `contacts` are empty at the start.
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
            Mode::Point => pipeline.group_per_sample(hull, settings.max_depth),
            Mode::Single => pipeline.group_deepest_sample(hull, settings.max_depth),
        }

        pipeline.reduce_to_contacts(hull, settings, contacts);
    });
}

/// Computes the first contacts found, up to `settings.max_contacts`, and writes them to `contacts`. This serves callers
/// that only need to know whether the body touches the hull.
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
        pipeline.group_first_samples(hull, settings);
        pipeline.reduce_to_contacts(hull, settings, std::slice::from_mut(contacts));
    });
}

#[cfg(test)]
mod tests;
