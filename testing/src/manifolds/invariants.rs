//! The judge of one body's contacts.

use super::{Body, Findings, NANOMETRE, Scene, are_close, ties};
use crate::random::Random;
use nalgebra::{Isometry3, Point3};
use ode_visual_hull::contact::{BodyContacts, Contact, Mode, Settings, collide};
use ode_visual_hull::hull::{EdgeModel, Hull, View, reference};
use ode_visual_hull::sample::Samples;

/// One in so many contacts is held against the reference's exit, which tries every border of a pixel, and one
/// in so many bodies is collided in other orders.
const REFERENCE_EVERY: usize = 97;
const ORDERS_EVERY: usize = 2;

/// Collides `body` with the scene's hull, and adds what is found to `findings`.
pub(super) fn check(
    scene: &Scene,
    body: &Body,
    pose: &Isometry3<f64>,
    settings: &Settings,
    random: &mut Random,
    findings: &mut Findings,
) {
    let found = collide(&scene.hull, &body.samples, pose, settings, None);
    let context = |what: &str| format!("{what}; {:?} at {pose:?} in {}", body.shape, scene.name);
    if let Some(what) = set_violation(&found, settings) {
        findings.add_violation(context(&what));
    }
    for contact in found.contacts() {
        findings.contacts += 1;
        let by_reference =
            scene.is_exactly_the_reference && findings.contacts.is_multiple_of(REFERENCE_EVERY);
        if let Some(what) = violation(&scene.hull, body, pose, settings, &contact, by_reference) {
            findings.add_violation(context(&what));
        }
    }

    if !found.points.is_empty() {
        findings.touching += 1;
        if findings.touching.is_multiple_of(ORDERS_EVERY) {
            check_view_order(scene, body, pose, (settings, &found), random, (findings, &context));
            check_sample_order(scene, body, pose, settings, random, (findings, &context));
        }
    }
}

/// What is wrong with a set of contacts as such; `None` if nothing is.
fn set_violation(found: &BodyContacts, settings: &Settings) -> Option<String> {
    let (count, most) = (found.points.len(), settings.max_contacts);
    if count > most {
        return Some(format!("{count} contacts where {most} are allowed"));
    }
    let is_empty = |manifold: &usize| found.points_of(*manifold).next().is_none();
    (0..found.manifolds.len()).find(is_empty).map(|manifold| format!("manifold {manifold} is empty"))
}

/// What is wrong with one contact; `None` if nothing is.
fn violation(
    hull: &Hull,
    body: &Body,
    pose: &Isometry3<f64>,
    settings: &Settings,
    &Contact { point, direction, depth }: &Contact,
    by_reference: bool,
) -> Option<String> {
    let off = body.signed_distance(&pose.inverse_transform_point(&point));
    if off.is_nan() || off.abs() > NANOMETRE {
        return Some(format!("{off} m off the surface"));
    }
    if !hull.inside_by(&point, EdgeModel::Coverage)
        || (hull.overrule_depth().is_none() && !is_near_subject(hull, &point))
    {
        return Some(format!("not inside, at {point}"));
    }
    if (direction.norm() - 1.0).abs() > NANOMETRE {
        return Some(format!("direction {direction} of length {}", direction.norm()));
    }

    let exit = hull.exit(&point, &direction, EdgeModel::Coverage).min(settings.max_depth);
    if depth.is_nan() || (depth - exit).abs() > NANOMETRE {
        return Some(format!("depth {depth} where the exit is {exit}"));
    }
    if by_reference {
        let exit = reference::exit(hull, &point, &direction).min(settings.max_depth);
        if !reference::inside(hull, &point) || (depth - exit).abs() > NANOMETRE {
            return Some(format!("depth {depth} where the reference's exit is {exit}"));
        }
    }
    None
}

/// Whether each view that sees a point has subject at its pixel or beside it.
fn is_near_subject(hull: &Hull, point: &Point3<f64>) -> bool {
    let has_subject = |view: &View| {
        let Some((i, j)) = view.pixel(point) else { return true };
        let beside = |d: i32| (i + d % 3 - 1, j + d / 3 - 1);
        (0..9).map(beside).any(|(i, j)| view.silhouette().is_subject(i, j))
    };
    hull.views().iter().filter(|view| view.is_enabled()).all(has_subject)
}

/// Collides the body with the hull of the same views in another order.
fn check_view_order(
    scene: &Scene,
    body: &Body,
    pose: &Isometry3<f64>,
    (settings, found): (&Settings, &BodyContacts),
    random: &mut Random,
    (findings, context): (&mut Findings, &dyn Fn(&str) -> String),
) {
    let hull = &scene.hull;
    let views = shuffled(hull.views().len(), random).into_iter().map(|k| hull.views()[k].clone()).collect();
    let other = Hull::new(views, *hull.bounds(), hull.unseen(), hull.time())
        .with_overrule_depth(hull.overrule_depth());
    let in_other_order = collide(&other, &body.samples, pose, settings, None);

    findings.compared[0] += 1;
    if !are_same_set(found, &in_other_order) {
        if ties::of_views([hull, &other], &body.samples, pose) {
            findings.ties[0] += 1;
        } else {
            findings.add_violation(context("the contacts depend on the order of the views"));
        }
    }
}

/// Collides the body's samples in their order and in another one, without a limit of the number of contacts.
fn check_sample_order(
    scene: &Scene,
    body: &Body,
    pose: &Isometry3<f64>,
    settings: &Settings,
    random: &mut Random,
    (findings, context): (&mut Findings, &dyn Fn(&str) -> String),
) {
    /// A swallowed or pierced body is rated by so many of its samples, evenly spaced in their order.
    const ESCAPE_SAMPLES: usize = 64;
    // The first of equally deep samples is the only contact of this mode.
    if settings.mode == Mode::Single {
        return;
    }
    let settings = Settings { max_contacts: usize::MAX, ..*settings };
    let count = body.samples.points().len();
    let [given, other] =
        [(0..count).collect(), shuffled(count, random)].map(|order| body.samples_in_order(&order));
    let contacts = |samples: &Samples| collide(&scene.hull, samples, pose, &settings, None);
    let (in_given, in_other) = (contacts(&given), contacts(&other));
    if in_given.escape.is_some() && in_given.points.len() > ESCAPE_SAMPLES {
        return;
    }

    findings.compared[1] += 1;
    if !are_same_set(&in_given, &in_other) {
        if ties::of_samples(&scene.hull, &given, pose) {
            findings.ties[1] += 1;
        } else {
            findings.add_violation(context("the contacts depend on the order of the samples"));
        }
    }
}

/// The numbers from 0 to `count - 1` in a random order.
fn shuffled(count: usize, random: &mut Random) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    for k in (1..count).rev() {
        order.swap(k, random.below(k + 1));
    }
    order
}

/// Whether two sets hold the same contacts in any order, but for rounding.
fn are_same_set(a: &BodyContacts, b: &BodyContacts) -> bool {
    let mut rest: Vec<Contact> = b.contacts().collect();
    a.points.len() == b.points.len()
        && a.contacts().all(|contact| {
            let is_equal = |other: &Contact| {
                are_close(&contact.point.coords, &other.point.coords)
                    && are_close(&contact.direction, &other.direction)
                    && (contact.depth - other.depth).abs() <= NANOMETRE
            };
            rest.iter().position(is_equal).map(|k| rest.swap_remove(k)).is_some()
        })
}
