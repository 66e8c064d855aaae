//! Batches against the single queries and against the reference.

use super::super::tests::{POLICIES, Random, bounds, cameras, hull};
use super::super::*;
use crate::silhouette::{Border, Silhouette};
use image::{GrayImage, Luma};
use nalgebra::{Isometry3, UnitQuaternion, Vector3, point, vector};
use std::sync::Arc;

/// Poses in which points of the world, taken into the frame, come back to the same places.
fn poses() -> [Isometry3<f64>; 3] {
    let turned = UnitQuaternion::from_euler_angles(0.4, -1.1, 2.5);
    [
        Isometry3::identity(),
        Isometry3::from_parts(vector![0.3, -0.2, 0.4].into(), turned),
        Isometry3::from_parts(vector![5_000.0, -3_000.0, 900.0].into(), turned),
    ]
}

/// `count` points about the hull, not a whole number of lanes, and the batch of them in each pose's frame.
fn batches(count: usize, seed: u64) -> Vec<(Vec<Point3<f64>>, Points, Isometry3<f64>)> {
    let mut random = Random(seed);
    let world: Vec<_> = (0..count).map(|_| random.point(&bounds().grown(0.05))).collect();
    let batch = |pose: Isometry3<f64>| {
        let local: Vec<_> = world.iter().map(|p| pose.inverse_transform_point(p)).collect();
        (world.clone(), Points::new(&local), pose)
    };
    poses().map(batch).into()
}

#[test]
fn a_batch_finds_the_points_inside() {
    let mut workspace = Workspace::new();
    for unseen in POLICIES {
        let hull = hull(unseen, 1);
        for (world, points, pose) in batches(10_007, 1) {
            let inside = hull.inside_many(&points, &pose, &mut workspace).unwrap();
            let wrong =
                world.iter().enumerate().filter(|(k, p)| inside.contains(*k) != hull.inside(p)).count();
            // Single precision: of ten thousand points hardly one lies that near to a pixel's border.
            assert!(wrong <= 5, "{unseen:?}: {wrong}");
            assert_eq!(inside.count(), inside.iter().count());
            assert!(inside.iter().all(|k| inside.contains(k)) && !inside.contains(world.len()));
            assert!(inside.count() > 300);
        }
    }
}

#[test]
fn every_number_of_points_fills_its_last_lanes() {
    let hull = hull(Unseen::Outside, 1);
    let mut workspace = Workspace::new();
    let middle = point![0.05, 0.0, 0.35];
    for count in 0..70 {
        let points = Points::new(&vec![middle; count]);
        let identity = Isometry3::identity();
        assert_eq!(hull.inside_many(&points, &identity, &mut workspace).unwrap().count(), count);
        assert_eq!(hull.respond_many(&points, &identity, &mut workspace).unwrap().len(), count);
    }
}

#[test]
fn a_batch_responds_as_the_reference_does() {
    let mut workspace = Workspace::new();
    for unseen in POLICIES {
        let hull = hull(unseen, 1);
        for (world, points, pose) in batches(801, 2) {
            let responses = hull.respond_many(&points, &pose, &mut workspace).unwrap();
            let (mut same, mut asked) = (0, 0);
            for response in responses {
                let p = &world[response.point];
                let Some(expected) = reference::respond(&hull, p) else { continue };
                let w = expected.normal * expected.depth;
                // A quarter of a pixel, of 160 over a field of 0.9 at about 2 m.
                let near = (response.w().cast::<f64>() - w).norm() < 0.25 * hull.pixel_size(p);
                same += usize::from(near && response.view == expected.view);
                asked += 1;
            }
            assert!(asked > 20 && same as f64 >= 0.985 * f64::from(asked), "{unseen:?}: {same} of {asked}");
        }
    }
}

#[test]
fn a_body_responds_as_its_points_do_one_by_one() {
    let hull = hull(Unseen::Outside, 1);
    let mut workspace = Workspace::new();
    let mut random = Random(3);
    let mut touching = 0;
    for _ in 0..200 {
        let at = random.point(&bounds());
        let corners: Vec<_> =
            (0..300).map(|_| random.point(&Aabb { min: at, max: at + Vector3::repeat(0.15) })).collect();
        let body = Points::new(&corners);
        let found = hull.respond_body(&body, &Isometry3::identity(), &mut workspace).unwrap();
        let responses: Vec<_> = corners.iter().filter_map(|p| Some((p, hull.respond(p)?))).collect();
        assert!(found.colliding.abs_diff(responses.len()) <= 1);
        let sum: Vector3<f64> = responses.iter().map(|(_, response)| response.w()).sum();
        // Where responses cancel, rounding turns their sum.
        if sum.norm() > 1e-3 {
            let along = sum.normalize();
            let longest =
                responses.iter().map(|(p, _)| hull.exit(p, &along, EdgeModel::Pixel)).fold(0.0, f64::max);
            assert!((found.vector - along * longest).norm() < 2e-3, "{} {}", found.vector, along * longest);
            touching += 1;
        }
    }
    assert!(touching > 20);
}

#[test]
fn bodies_respond_with_the_same_bits_on_any_number_of_threads() {
    let hull = hull(Unseen::Outside, 1);
    let mut random = Random(6);
    let samples: Vec<_> =
        (0..200).map(|_| random.point(&Aabb { min: Point3::origin(), max: point![0.1, 0.2, 0.1] })).collect();
    let samples = Points::new(&samples);
    let mut pose = || Isometry3::from(random.point(&bounds()).coords);
    let bodies: Vec<Body> = (0..100).map(|_| (&samples, pose())).collect();
    let (mut one, mut several) = (Vec::new(), Vec::new());
    hull.respond_bodies(&bodies, &mut [Workspace::new()], &mut one).unwrap();
    let mut workspaces: Vec<_> = (0..3).map(|_| Workspace::new()).collect();
    hull.respond_bodies(&bodies, &mut workspaces, &mut several).unwrap();
    assert_eq!(one, several);
    assert!(one.iter().any(|response| response.colliding > 0));
    let alone = bodies.iter().map(|(body, pose)| hull.respond_body(body, pose, &mut workspaces[0]).unwrap());
    assert!(alone.eq(one.iter().copied()));
    let lost: Body = (&samples, Isometry3::translation(f64::NAN, 0.0, 0.0));
    assert!(hull.respond_bodies(&[lost], &mut workspaces, &mut several).is_err());
    assert!(hull.respond_bodies(&bodies, &mut [], &mut several).is_err());
}

#[test]
fn candidates_miss_nothing_that_is_inside_by_any_edge() {
    let mut workspace = Workspace::new();
    for (unseen, samples) in POLICIES.into_iter().flat_map(|unseen| [(unseen, 1), (unseen, 4)]) {
        let hull = hull(unseen, samples);
        for (world, points, pose) in batches(5_000, 4) {
            let inside = |p: &Point3<f64>| hull.inside(p) || hull.inside_by(p, EdgeModel::Coverage);
            let count = world.iter().filter(|p| inside(p)).count();
            let mut found = 0;
            hull.candidates([(&points, pose)].into_iter(), &mut workspace, |_, candidates| {
                found = candidates.iter().filter(|&k| inside(&world[k])).count();
            });
            assert_eq!(found, count);
        }
    }
}

#[test]
fn deep_silhouettes_are_answered_exactly_beyond_a_byte() {
    // Two cameras across one another, each filled but for a rim: up to 340 pixels deep.
    let look = |eye, name: &str| {
        let camera =
            crate::camera::Camera::look_at(name, (900, 900), 0.5, eye, Point3::origin(), Vector3::z());
        let mask = GrayImage::from_fn(900, 900, |i, j| {
            Luma([if (110..790).contains(&i) && (105..795).contains(&j) { 255 } else { 0 }])
        });
        View::new(Arc::new(camera.unwrap()), Arc::new(Silhouette::new(&mask, Border::Background)), None)
    };
    let volume = Aabb::new(point![-2.0, -2.0, -2.0], point![2.0, 2.0, 2.0]).unwrap();
    let views = vec![look(point![3.0, 0.0, 0.0], "a"), look(point![0.0, 3.0, 0.0], "b")];
    let hull = Hull::new(views, volume, Unseen::Outside, 0.0);
    let mut random = Random(5);
    let middle = Aabb { min: point![-0.3, -0.3, -0.3], max: point![0.3, 0.3, 0.3] };
    let world: Vec<_> = (0..500).map(|_| random.point(&middle)).collect();
    let mut workspace = Workspace::new();
    let points = Points::new(&world);
    let responses = hull.respond_many(&points, &Isometry3::identity(), &mut workspace).unwrap();
    assert_eq!(responses.len(), 500);
    let same = |response: &&PointResponse| {
        let expected = hull.respond(&world[response.point]).unwrap();
        (response.w().cast::<f64>() - expected.w()).norm() < 1e-4
    };
    assert!(responses.iter().filter(same).count() >= 495);
}

#[test]
fn a_line_that_leads_away_from_the_camera_ends_at_its_vanishing_point() {
    // Beside the tip of a slit, far off the axis of a wide lens: the normal leads into the depth, and its image past
    // the slit to the middle of a silhouette without any other edge there. Only the work volume ends it.
    let look = crate::camera::Camera::look_at;
    let camera =
        look("wide", (160, 120), 2.6, Point3::origin(), point![0.0, 1.0, 0.0], Vector3::z()).unwrap();
    let (tip, row) = (24, 106);
    let mask = GrayImage::from_fn(160, 120, |i, j| {
        Luma([if (tip..tip + 9).contains(&i) && j == row { 0 } else { 255 }])
    });
    let at = |column: f64| camera.unproject(f64::from(tip) - column, f64::from(row) + 0.4, 1.0).unwrap();
    let world = [at(1.5), at(3.2), at(4.7)];
    let silhouette = Arc::new(Silhouette::new(&mask, Border::Background));
    let volume = Aabb::new(point![-20.0, -20.0, -20.0], point![20.0, 20.0, 20.0]).unwrap();
    let view = View::new(Arc::new(camera), silhouette, None);
    let hull = Hull::new(vec![view], volume, Unseen::Outside, 0.0);
    let mut workspace = Workspace::new();
    let points = Points::new(&world);
    let responses = hull.respond_many(&points, &Isometry3::identity(), &mut workspace).unwrap();
    let mut endless = 0;
    for response in responses {
        let expected = hull.respond(&world[response.point]).unwrap();
        // Metres, over tens of metres in single precision.
        assert!(
            (f64::from(response.depth) - expected.depth).abs() < 1e-3,
            "{} {}",
            response.depth,
            expected.depth
        );
        endless += usize::from(expected.depth > 1.0);
    }
    assert!(endless > 0);
}

#[test]
fn beyond_an_open_border_a_batch_answers_as_single_points_do() {
    // A subject that the image's side cuts off: beyond it nothing is background, and nothing is seen.
    let mask = GrayImage::from_fn(160, 120, |i, _| Luma([if i < 100 { 255 } else { 0 }]));
    let view = |camera| View::new(Arc::new(camera), Arc::new(Silhouette::new(&mask, Border::Open)), None);
    let wide = bounds().grown(1.5);
    let hull = Hull::new(cameras().into_iter().map(view).collect(), wide, Unseen::Outside, 0.0);
    let (mut workspace, mut random) = (Workspace::new(), Random(7));
    let world: Vec<_> = (0..5_000).map(|_| random.point(&wide)).collect();
    let inside = hull.inside_many(&Points::new(&world), &Isometry3::identity(), &mut workspace).unwrap();
    let wrong = world.iter().enumerate().filter(|(k, p)| inside.contains(*k) != hull.inside(p)).count();
    assert!(inside.count() > 20 && wrong <= 2, "{wrong} of {}", inside.count());
}

#[test]
fn a_view_taken_out_is_not_asked() {
    let mut views = hull(Unseen::Outside, 1).views().to_vec();
    let blank = Silhouette::new(&GrayImage::new(160, 120), Border::Background);
    views[2] = View::new(Arc::new(cameras().swap_remove(2)), Arc::new(blank), None);
    let mut workspace = Workspace::new();
    let points = Points::new(&[point![0.05, 0.0, 0.35]]);
    let identity = Isometry3::identity();
    let empty = Hull::new(views.clone(), bounds(), Unseen::Outside, 0.0);
    assert_eq!(empty.inside_many(&points, &identity, &mut workspace).unwrap().count(), 0);
    assert_eq!(empty.respond_body(&points, &identity, &mut workspace).unwrap().colliding, 0);
    views[2] = views[2].clone().with_enabled(false);
    let without = Hull::new(views, bounds(), Unseen::Outside, 0.0);
    assert_eq!(without.inside_many(&points, &identity, &mut workspace).unwrap().count(), 1);
    let responses = without.respond_many(&points, &identity, &mut workspace).unwrap();
    assert_ne!(responses[0].view, 2);
}

#[test]
fn a_pose_that_is_not_finite_is_refused() {
    let hull = hull(Unseen::Outside, 1);
    let mut workspace = Workspace::new();
    let points = Points::new(&[point![0.05, 0.0, 0.35]]);
    for x in [f64::NAN, f64::INFINITY] {
        let pose = Isometry3::translation(x, 0.0, 0.0);
        assert!(hull.inside_many(&points, &pose, &mut workspace).is_err());
        assert!(hull.respond_many(&points, &pose, &mut workspace).is_err());
        assert!(hull.respond_body(&points, &pose, &mut workspace).is_err());
    }
}
