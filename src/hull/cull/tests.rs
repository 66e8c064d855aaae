//! Queries of many points, which run through the filter, against the single queries.

use crate::hull::tests::{POLICIES, bounds, cameras, hull, point_in};
use crate::hull::*;
use crate::silhouette::{Border, Silhouette};
use image::{GrayImage, Luma};
use nalgebra::{Isometry3, UnitQuaternion, point, vector};
use ode_visual_hull_random::Random;
use std::sync::Arc;

/// Poses of the frame in which a batch's points are given: at the world's, near it and far from it.
fn poses() -> [Isometry3<f64>; 3] {
    let rotation = UnitQuaternion::from_euler_angles(0.4, -1.1, 2.5);
    [
        Isometry3::identity(),
        Isometry3::from_parts(vector![0.3, -0.2, 0.4].into(), rotation),
        Isometry3::from_parts(vector![5_000.0, -3_000.0, 900.0].into(), rotation),
    ]
}

/// `count` points around the hull in the world, and for each pose the batch of them in its frame.
fn batches(count: usize, seed: u64) -> Vec<(Vec<Point3<f64>>, Points, Isometry3<f64>)> {
    let mut random = Random(seed);
    let world: Vec<_> = (0..count).map(|_| point_in(&mut random, &bounds().grown(0.05))).collect();
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
        // Not a whole number of blocks.
        for (world, points, pose) in batches(10_007, 1) {
            let inside = hull.inside_many(&points, &pose, &mut workspace).unwrap();
            let wrong =
                world.iter().enumerate().filter(|(k, p)| inside.contains(*k) != hull.inside(p)).count();
            // Of ten thousand points few lie so near to a pixel's border that single precision moves them across it.
            assert!(wrong <= 5, "{unseen:?}: {wrong}");

            assert_eq!(inside.count(), inside.iter().count());
            assert!(inside.iter().all(|k| inside.contains(k)) && !inside.contains(world.len()));
            assert!(inside.count() > 300);
        }
    }
}

#[test]
fn the_padding_of_the_last_block_is_never_counted() {
    let hull = hull(Unseen::Outside, 1);
    let mut workspace = Workspace::new();
    let middle = point![0.05, 0.0, 0.35];
    for count in 0..70 {
        let points = Points::new(&vec![middle; count]);
        let identity = Isometry3::identity();
        assert_eq!(hull.inside_many(&points, &identity, &mut workspace).unwrap().count(), count);
        assert_eq!(hull.respond_many(&vec![middle; count], &mut workspace).len(), count);
    }
}

#[test]
fn candidates_include_every_point_that_is_inside_by_either_edge_model() {
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
fn beyond_an_open_border_a_batch_agrees_with_single_points() {
    // The image's borders cut the subject off; beyond them there is no background, but no view sees anything either.
    let mask = GrayImage::from_fn(160, 120, |i, _| Luma([if i < 100 { 255 } else { 0 }]));
    let view = |camera| View::new(Arc::new(camera), Arc::new(Silhouette::new(&mask, Border::Unknown)), None);
    let wide = bounds().grown(1.5);
    let hull = Hull::new(cameras().into_iter().map(view).collect(), wide, Unseen::Outside, 0.0);

    let (mut workspace, mut random) = (Workspace::new(), Random(7));
    let world: Vec<_> = (0..5_000).map(|_| point_in(&mut random, &wide)).collect();
    let inside = hull.inside_many(&Points::new(&world), &Isometry3::identity(), &mut workspace).unwrap();
    let wrong = world.iter().enumerate().filter(|(k, p)| inside.contains(*k) != hull.inside(p)).count();
    // Few points lie so near to a pixel's border that single precision moves them across it.
    assert!(inside.count() > 20 && wrong <= 2, "{wrong} of {}", inside.count());
}

#[test]
fn a_disabled_view_does_not_count() {
    // A view with an empty mask empties the hull.
    let mut views = hull(Unseen::Outside, 1).views().to_vec();
    let blank = Silhouette::new(&GrayImage::new(160, 120), Border::Background);
    views[2] = View::new(Arc::new(cameras().swap_remove(2)), Arc::new(blank), None);
    let mut workspace = Workspace::new();
    let points = Points::new(&[point![0.05, 0.0, 0.35]]);
    let identity = Isometry3::identity();
    let empty = Hull::new(views.clone(), bounds(), Unseen::Outside, 0.0);
    assert_eq!(empty.inside_many(&points, &identity, &mut workspace).unwrap().count(), 0);
    assert!(empty.respond_many(&[point![0.05, 0.0, 0.35]], &mut workspace).is_empty());

    // Once it is disabled, the other views decide.
    views[2] = views[2].clone().with_enabled(false);
    let without = Hull::new(views, bounds(), Unseen::Outside, 0.0);
    assert_eq!(without.inside_many(&points, &identity, &mut workspace).unwrap().count(), 1);
    let responses = without.respond_many(&[point![0.05, 0.0, 0.35]], &mut workspace);
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
    }
}
