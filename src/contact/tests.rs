//! Contacts on a hull that equals the box it was made from, so that their points, directions and depths are known.

use super::*;
use crate::hull::{Aabb, Unseen, View};
use crate::sample::{self, Samples};
use crate::shape::Shape;
use crate::silhouette::{Border, Silhouette};
use crate::synthetic::{Placed, Solid, Subject, Texture, coverage, layout};
use nalgebra::{UnitQuaternion, point, vector};
use std::sync::{Arc, LazyLock};

/// Size of a pixel at the table, in metres: 0.45 rad over 640 pixels at a distance of about 3 m.
const PIXEL: f64 = 0.0022;

/// The hull of a table of 0.5 x 0.5 x 0.4 m around the origin, from masks with coverage. It is drawn once for all
/// tests.
fn table() -> &'static Hull {
    static TABLE: LazyLock<Hull> = LazyLock::new(draw_table);
    &TABLE
}

fn draw_table() -> Hull {
    let lengths = vector![0.5, 0.5, 0.4];
    let placed =
        Placed::new(Solid::cuboid(lengths).unwrap(), Isometry3::identity(), Texture::plain([200, 60, 40]));
    let subject = Subject::new(vec![placed]);

    let cameras = layout::face_on(lengths, &Isometry3::identity(), 2.8, 0.2, (640, 480), 0.45).unwrap();
    let view = |camera| {
        let silhouette = Silhouette::new(&coverage(&camera, &subject), Border::Background);
        View::new(Arc::new(camera), Arc::new(silhouette), None)
    };
    let bounds = Aabb::new(point![-0.6, -0.6, -0.3], point![0.6, 0.6, 0.8]).unwrap();
    Hull::new(cameras.into_iter().map(view).collect(), bounds, Unseen::Outside, 0.0)
}

fn cube() -> Samples {
    sample::box_(vector![0.2, 0.2, 0.2], 0.03).unwrap()
}

fn at(x: f64, y: f64, z: f64) -> Isometry3<f64> {
    Isometry3::translation(x, y, z)
}

fn contacts(body: &Samples, pose: &Isometry3<f64>) -> Vec<Contact> {
    collide(table(), body, pose, &Settings::default(), None).contacts().collect()
}

/// The pose in which the cube stands 5 mm deep in the table's top at (0.03, -0.02), rotated a little about z.
fn standing() -> Isometry3<f64> {
    at(0.03, -0.02, 0.295) * UnitQuaternion::from_euler_angles(0.0, 0.0, 0.3)
}

#[test]
fn a_box_on_the_table_is_pushed_straight_up_at_its_corners() {
    let found = contacts(&cube(), &standing());
    assert_eq!(found.len(), 8);
    for contact in &found {
        // Coverage normals are accurate to two degrees, coverage edges to a third of a pixel.
        assert!(contact.direction.angle(&Vector3::z()) < 0.035, "{contact:?}");
        assert!((contact.depth - 0.005).abs() < 0.33 * PIXEL, "{contact:?}");
    }

    for (x, y) in [(-0.1, -0.1), (-0.1, 0.1), (0.1, -0.1), (0.1, 0.1)] {
        let corner = standing() * point![x, y, -0.1];
        assert!(found.iter().any(|contact| (contact.point - corner).norm() < 1e-9), "no contact at {corner}");
    }
}

#[test]
fn a_deep_rim_does_not_push_sideways() {
    // The cube is 4 cm deep and half over the edge: the nearest exit of its lower rim is at the table's side.
    let found = contacts(&cube(), &at(0.24, 0.0, 0.26));
    let up = found.iter().filter(|contact| contact.direction.z > 0.95).count();
    assert!(up >= 4, "{found:?}");
    let sideways =
        found.iter().filter(|contact| contact.direction.z < 0.3 && contact.direction.x < 0.3).count();
    assert_eq!(sideways, 0, "{found:?}");
}

#[test]
fn a_box_at_the_side_is_pushed_sideways() {
    let found = contacts(&cube(), &at(0.346, 0.01, 0.0));
    assert!(!found.is_empty());
    assert!(found.iter().all(|contact| contact.direction.angle(&Vector3::x()) < 0.035), "{found:?}");
}

#[test]
fn depth_is_capped_except_in_paper_mode() {
    let deep = at(0.0, 0.0, 0.15);
    let hull = table();
    let deepest = |mode| {
        let settings = Settings { mode, ..Settings::default() };
        let found = collide(hull, &cube(), &deep, &settings, None);
        found.points.iter().map(|point| point.depth).fold(0.0, f64::max)
    };
    assert_eq!(deepest(Mode::Clustered), 0.05);
    assert_eq!(deepest(Mode::Point), 0.05);
    assert_eq!(deepest(Mode::Single), 0.05);
    assert!(deepest(Mode::Paper) > 0.1);
}

#[test]
fn a_sphere_touches_at_its_lowest_point() {
    let ball = sample::sphere(0.1, 0.03).unwrap();
    let found = contacts(&ball, &at(0.02, 0.03, 0.297));
    assert_eq!(found.len(), 1);
    assert!((found[0].point - point![0.02, 0.03, 0.197]).norm() < 0.004, "{found:?}");
    assert!((found[0].depth - 0.003).abs() < 0.33 * PIXEL);
}

#[test]
fn a_ball_on_an_edge_is_pushed_through_its_centre() {
    // The ball's centre is beyond both faces of the edge at x = 0.25 m, z = 0.2 m, and 94 mm from it.
    let ball = sample::sphere(0.1, 0.03).unwrap();
    for (degrees, y) in [(30.0_f64, 0.02), (40.0, -0.05), (45.0, 0.0), (50.0, 0.1), (60.0, -0.1)] {
        let (up, out) = degrees.to_radians().sin_cos();
        let centre = at(0.25 + 0.094 * out, y, 0.2 + 0.094 * up);
        let found = contacts(&ball, &centre);
        assert!(!found.is_empty());
        for Contact { point, direction, .. } in found {
            let off = (point + direction * 0.1).coords - centre.translation.vector;
            assert!(off.norm() < 1e-9, "{degrees} degrees: passes {off} m by the centre");
        }
    }
}

#[test]
fn a_rod_deep_in_an_edge_is_no_deeper_than_the_way_that_frees_it() {
    // The rod's lower end is beside the table's side, its upper end near the top: the way up frees the upper half, the way
    // aside the lower half, each by 5 cm. Up from the lower end it would be 9 cm, aside from the upper end 8 cm.
    let rod = sample::cylinder(0.031, 0.161, 0.03).unwrap();
    let axis = UnitQuaternion::rotation_between(&Vector3::z(), &vector![0.58, 0.34, -0.74]).unwrap();
    let settings = Settings { max_depth: 1.0, ..Settings::default() };
    let found = collide(table(), &rod, &(at(0.201, 0.041, 0.188) * axis), &settings, None);
    let directions: Vec<_> = found.manifolds.iter().map(|manifold| manifold.direction).collect();
    assert!(directions.iter().any(|direction| direction.z > 0.95), "{directions:?}");
    assert!(directions.iter().any(|direction| direction.x > 0.95), "{directions:?}");
    for contact in found.contacts() {
        // The 5 cm, and the greatest distance of a point of the surface from a sample.
        assert!(contact.depth < 0.05 + rod.covering_radius(), "{contact:?}");
    }
}

#[test]
fn a_lying_cylinder_touches_at_both_rims() {
    let roll = sample::cylinder(0.1, 0.3, 0.03).unwrap();
    let lying =
        at(0.0, 0.0, 0.296) * UnitQuaternion::from_euler_angles(0.0, std::f64::consts::FRAC_PI_2, 0.0);
    let mut along: Vec<f64> = contacts(&roll, &lying).iter().map(|contact| contact.point.x).collect();
    along.sort_by(f64::total_cmp);
    assert_eq!(along.len(), 2);
    assert!((along[0] + 0.15).abs() < 0.01 && (along[1] - 0.15).abs() < 0.01);
}

#[test]
fn a_swallowed_box_is_pushed_to_the_nearest_exit() {
    let tiny = sample::box_(vector![0.04, 0.04, 0.04], 0.03).unwrap();
    let found = contacts(&tiny, &at(0.05, 0.02, 0.12));
    assert!(!found.is_empty() && found.iter().all(|contact| contact.direction.z > 0.95), "{found:?}");
}

#[test]
fn a_pierced_body_leaves_in_one_direction_and_keeps_it() {
    // The table sticks out of a wide plate on both sides: no sample's exit direction runs against the plate's normal.
    let plate = sample::box_(vector![0.8, 0.8, 0.2], 0.05).unwrap();
    let (hull, settings) = (table(), Settings::default());
    let first = collide(hull, &plate, &at(0.0, 0.0, 0.0), &settings, None);
    let escape = first.escape.expect("no sample is supported");
    assert!(escape.angle(&Vector3::z()) < 0.1, "up is the shortest exit: {escape}");
    assert!(first.contacts().all(|contact| contact.direction == escape));

    // The last step's direction is kept, unless its exit is more than three times as long as the shortest.
    let second = collide(hull, &plate, &at(0.0, 0.0, 0.0), &settings, Some(Vector3::x()));
    assert_eq!(second.escape, Some(Vector3::x()));
}

#[test]
fn a_body_that_reaches_over_the_table_rests_on_it() {
    let plate = sample::box_(vector![0.6, 0.3, 0.3], 0.03).unwrap();
    let found = contacts(&plate, &at(0.0, 0.0, 0.348));
    assert!(!found.is_empty() && found.iter().all(|contact| contact.direction.z > 0.95), "{found:?}");
}

#[test]
fn reduction_keeps_a_deep_point_and_the_spread_for_every_cap() {
    let hull = table();
    let tilted = at(0.0, 0.0, 0.293) * UnitQuaternion::from_euler_angles(0.001, 0.002, 0.0);
    let with_cap = |cap| {
        let settings = Settings { max_contacts: cap, ..Settings::default() };
        collide(hull, &cube(), &tilted, &settings, None).contacts().collect::<Vec<_>>()
    };

    let all = with_cap(10_000);
    let deepest = all.iter().map(|contact| contact.depth).fold(0.0, f64::max);
    for cap in 1..12 {
        let kept = with_cap(cap);
        assert_eq!(kept.len(), cap.min(all.len()));
        assert!(kept[0].depth >= 0.8 * deepest);
        assert!(kept.iter().all(|contact| all.contains(contact)));
    }

    let four = with_cap(4);
    let spread =
        four.iter().flat_map(|a| four.iter().map(move |b| (a.point - b.point).norm())).fold(0.0, f64::max);
    assert!(spread > 0.27, "expected nearly the base's diagonal of 0.28 m, found {spread}");
}

#[test]
fn the_choice_of_samples_does_not_flicker_while_a_box_jitters() {
    let (hull, body) = (table(), cube());
    let chosen = |jitter: f64| -> Vec<Point3<f64>> {
        // The box rests 3 mm deep and jitters by up to 20 micrometres and 20 microradians.
        let pose = at(0.03 + jitter, -0.02, 0.297 - jitter)
            * UnitQuaternion::from_euler_angles(jitter, -0.5 * jitter, 0.3);
        let found = collide(hull, &body, &pose, &Settings::default(), None);
        found.points.iter().map(|point| pose.inverse_transform_point(&point.point)).collect()
    };

    let at_rest = chosen(0.0);
    for jitter in [-2e-5, -7e-6, 3e-6, 1e-5, 2e-5] {
        let jittered = chosen(jitter);
        assert_eq!(jittered.len(), at_rest.len());
        let is_close = jittered.iter().zip(&at_rest).all(|(a, b)| (a - b).norm() < 1e-9);
        assert!(is_close, "{jittered:?}\n{at_rest:?}");
    }
}

#[test]
fn equal_queries_give_equal_bits() {
    let hull = table();
    let query = || collide(hull, &cube(), &standing(), &Settings::default(), None);
    assert_eq!(query(), query());
}

#[test]
fn the_body_response_moves_the_body_out() {
    let hull = table();
    for (x, z) in [(0.0, 0.29), (0.34, 0.05), (0.33, 0.26)] {
        let pose = at(x, 0.0, z);
        let response = body_response(hull, &cube(), &pose);
        assert!(response.colliding > 0);
        let moved = Isometry3::translation(response.vector.x, response.vector.y, response.vector.z) * pose;
        for sample in cube().points() {
            // Rounding may leave a sample on the border of the last pixel.
            let depth = hull.respond(&(moved * sample.point)).map_or(0.0, |response| response.depth);
            assert!(depth < 1e-9, "still {depth} m inside");
        }
    }
}

/// Samples of a sphere, a cube, a capsule, a cylinder, and the convex hull of a cube's corners.
fn bodies() -> [Samples; 5] {
    let shapes = [
        Shape::Sphere { radius: 0.1 },
        Shape::cube(0.2),
        Shape::Capsule { radius: 0.05, length: 0.1 },
        Shape::Cylinder { radius: 0.05, length: 0.2 },
    ];
    let [sphere, cube, capsule, cylinder] = shapes.map(|shape| shape.sample(0.03).unwrap());

    let corners = [-0.1, 0.1].into_iter().flat_map(|x| [-0.1, 0.1].map(|y| (x, y)));
    let vertices: Vec<_> = corners.flat_map(|(x, y)| [-0.1, 0.1].map(|z| point![x, y, z])).collect();
    [sphere, cube, capsule, cylinder, sample::convex(&vertices, 0.03).unwrap()]
}

#[test]
fn bodies_get_the_same_contacts_in_a_batch_as_alone() {
    let hull = table();
    let plate = sample::box_(vector![0.8, 0.8, 0.2], 0.05).unwrap();
    let all: Vec<_> = bodies().into_iter().chain([plate]).collect();
    let escapes = [None, Some(Vector3::x()), None];

    // Bodies of all shapes in and above the table, and one without a finite pose at index 40.
    let body = |k: usize| {
        let (x, y) = (0.1 * (k % 7) as f64 - 0.3, 0.07 * (k % 9) as f64 - 0.3);
        let rotation = UnitQuaternion::from_euler_angles(0.2 * k as f64, 0.1 * k as f64, 0.0);
        let hull_from_body = at(x, y, 0.05 * (k % 8) as f64) * rotation;
        SampledBody { samples: &all[k % all.len()], hull_from_body, last_escape: escapes[k % 3] }
    };
    let not_finite = SampledBody { hull_from_body: at(f64::NAN, 0.0, 0.0), ..body(0) };
    let bodies: Vec<_> = (0..40).map(body).chain([not_finite]).chain((40..80).map(body)).collect();

    // The earlier contents of the list must not matter.
    let mut found = vec![BodyContacts { escape: Some(Vector3::y()), ..BodyContacts::default() }; 100];
    for (mode, max_contacts) in
        [(Mode::Clustered, 8), (Mode::Clustered, 3), (Mode::Paper, 8), (Mode::Point, 8), (Mode::Single, 8)]
    {
        let settings = Settings { mode, max_contacts, ..Settings::default() };
        collide_many(hull, &bodies, &settings, &mut found);
        assert_eq!(found.len(), bodies.len());

        for (k, (found, body)) in found.iter().zip(&bodies).enumerate() {
            let SampledBody { samples, hull_from_body, last_escape } = body;
            let alone = collide(hull, samples, hull_from_body, &settings, *last_escape);
            assert_eq!(*found, alone, "{k}, {mode:?}");
        }

        // The bodies cover all cases: many touch, and some are swallowed or pierced.
        assert!(found.iter().filter(|found| !found.points.is_empty()).count() > 40);
        assert!(found[40].points.is_empty());
        let escapes = found.iter().filter(|found| found.escape.is_some()).count();
        assert!((escapes > 0) == (mode == Mode::Clustered), "{escapes}");
    }
}

#[test]
fn every_shape_on_the_table_is_pushed_up() {
    let hull = table();
    let names = ["sphere", "cube", "capsule", "cylinder", "convex"];
    for (name, samples) in names.iter().zip(bodies()) {
        for mode in [Mode::Clustered, Mode::Paper, Mode::Point, Mode::Single] {
            let settings = Settings { mode, ..Settings::default() };
            let found = collide(hull, &samples, &at(0.0, 0.01, 0.296), &settings, None);
            let found: Vec<_> = found.contacts().collect();
            assert!(!found.is_empty(), "{name} {mode:?}");

            // The paper's 5x5 normals are biased by up to 6.6 degrees, and single ones deviate by more.
            let tolerance = if mode == Mode::Clustered { 0.035 } else { 0.4 };
            let is_up = |contact: &Contact| contact.direction.angle(&Vector3::z()) < tolerance;
            assert!(found.iter().all(is_up), "{name} {mode:?} {found:?}");
        }
    }
}
