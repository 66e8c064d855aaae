//! Overruled views against the definition, evaluated by scanning masks, and against the hulls of fewer views.

use crate::camera::Camera;
use crate::hull::tests::{POLICIES, bounds, cameras, hull, point_in};
use crate::hull::*;
use crate::silhouette::{Border, Silhouette};
use image::Luma;
use nalgebra::{Isometry3, point};
use ode_visual_hull_random::Random;
use std::sync::Arc;

/// The depth from which views overrule another, in metres: 3 to 4 pixels.
const DEPTH: f64 = 0.05;

/// The plain hull of the subject, and the hull in which views are overruled, without and with a hole in one mask.
fn pairs(unseen: Unseen) -> [(Hull, Hull); 2] {
    let plain = hull(unseen, 1);
    let mut views = plain.views().to_vec();
    views[1] = with_hole(&views[1]);
    let holed = Hull::new(views, *plain.bounds(), unseen, 0.0);
    [plain, holed].map(|hull| (hull.clone(), hull.with_overrule_depth(Some(DEPTH))))
}

/// The view with a hole of 8 pixels in radius, about the middle of the subject's ball.
fn with_hole(view: &View) -> View {
    let centre = view.project(&point![0.05, 0.0, 0.35]).unwrap();
    let mut mask = view.silhouette().to_mask();
    for (i, j, Luma([byte])) in mask.enumerate_pixels_mut() {
        if (f64::from(i) + 0.5 - centre.u).hypot(f64::from(j) + 0.5 - centre.v) < 8.0 {
            *byte = 0;
        }
    }
    let silhouette = Silhouette::new(&mask, view.silhouette().border());
    View::new(Arc::new(view.camera().clone()), Arc::new(silhouette), None)
}

/// The depth of a point in each view that sees it, by a search of the mask in growing squares.
fn depths(hull: &Hull, p: &Point3<f64>) -> Vec<f64> {
    let depth = |view: &View| -> Option<f64> {
        let (i, j) = view.pixel(p)?;
        let is_background =
            |d: i32| (-d..=d).any(|x| (-d..=d).any(|y| !view.silhouette().is_subject(i + x, j + y)));
        let pixels = (0..200).find(|&d| is_background(d))?;
        let focal_length = view.camera().intrinsics()[(0, 0)];
        Some(f64::from(pixels) * view.project(p)?.depth / focal_length)
    };
    hull.views().iter().filter_map(depth).collect()
}

#[test]
fn a_point_is_inside_if_all_views_see_it_or_one_sees_it_much_less_deep_than_all_others() {
    let mut random = Random(1);
    for (plain, overruling) in POLICIES.into_iter().flat_map(pairs) {
        let (mut gained, mut compared) = (0, 0);
        for _ in 0..6000 {
            let p = point_in(&mut random, &bounds());
            let mut depths = depths(&plain, &p);
            depths.sort_by(f64::total_cmp);
            let is_tolerated = depths.len() >= 4
                && depths[1] - depths[0] >= DEPTH
                && (plain.unseen() != Unseen::Outside || depths.len() == plain.views().len());
            let expected = plain.bounds().contains(&p) && (plain.inside(&p) || is_tolerated);
            assert_eq!(overruling.inside(&p), expected, "{p} {depths:?}");
            gained += usize::from(expected && !plain.inside(&p));
            compared += 1;
        }
        assert!(gained > 5, "{gained} of {compared}");
    }
}

#[test]
fn many_points_are_found_inside_as_single_ones_are() {
    let (mut workspace, mut random) = (Workspace::new(), Random(2));
    for (plain, overruling) in POLICIES.into_iter().flat_map(pairs) {
        let world: Vec<_> = (0..10_007).map(|_| point_in(&mut random, &bounds())).collect();
        let points = Points::new(&world);
        let inside = overruling.inside_many(&points, &Isometry3::identity(), &mut workspace).unwrap();
        let wrong = world.iter().enumerate().filter(|(k, p)| inside.contains(*k) != overruling.inside(p));
        // Of ten thousand points few lie so near to a pixel's border that single precision moves them across it.
        assert!(wrong.count() <= 5);
        assert!(inside.count() > world.iter().filter(|p| plain.inside(p)).count());

        let by_either =
            |p: &Point3<f64>| overruling.inside(p) || overruling.inside_by(p, EdgeModel::Coverage);
        let bodies = [(&points, Isometry3::identity())];
        overruling.candidates(bodies.into_iter(), &mut workspace, |_, found| {
            assert!(world.iter().enumerate().all(|(k, p)| found.contains(k) || !by_either(p)));
        });
    }
}

#[test]
fn the_box_holds_every_point_inside_even_where_a_mask_is_empty() {
    let mut views = hull(Unseen::Outside, 1).views().to_vec();
    let blank = Silhouette::new(&image::GrayImage::new(160, 120), Border::Background);
    views[3] = View::new(Arc::new(cameras().swap_remove(3)), Arc::new(blank), None);
    let emptied = Hull::new(views, bounds(), Unseen::Outside, 0.0);
    assert!(emptied.aabb().is_empty());

    let overruling = emptied.with_overrule_depth(Some(DEPTH));
    assert_eq!(overruling.empty_reason(), None);
    let (mut random, mut inside) = (Random(3), 0);
    for _ in 0..5000 {
        let p = point_in(&mut random, &bounds());
        assert!(!overruling.inside(&p) || overruling.aabb().contains(&p));
        inside += usize::from(overruling.inside(&p));
    }
    assert!(inside > 50, "{inside}");
}

#[test]
fn four_views_overrule_one_and_three_do_not() {
    let [_, (holed, _)] = pairs(Unseen::Outside);
    let middle = point![0.05, 0.0, 0.35];
    assert!(!holed.inside(&middle));
    for (disabled, is_inside) in [(0, true), (1, true), (2, false)] {
        // The view with the hole stays.
        let enabled = |k: usize| k <= 1 || k > 1 + disabled;
        let views = holed.views().iter().enumerate().map(|(k, view)| view.clone().with_enabled(enabled(k)));
        let hull = Hull::new(views.collect(), bounds(), Unseen::Outside, 0.0);
        assert_eq!(hull.with_overrule_depth(Some(DEPTH)).inside(&middle), is_inside, "{disabled}");
    }
}

#[test]
fn depths_grow_from_zero_where_a_hole_is_entered_and_the_edge_of_the_hole_gives_no_contact() {
    let [_, (_, overruling)] = pairs(Unseen::Outside);
    let camera: Camera = cameras().swap_remove(1);
    let sight = (point![0.05, 0.0, 0.35] - camera.centre()).normalize();

    // Along the line of sight through the middle of the hole, from in front of the ball to its middle.
    let mut before: Option<f64> = None;
    for mm in -320..0 {
        let p = point![0.05, 0.0, 0.35] + sight * 1e-3 * f64::from(mm);
        let Some(exit) = overruling.exit_vector(&p) else {
            assert!(before.is_none(), "outside again at {mm} mm");
            continue;
        };
        // A pixel is 13 mm: the depth in the image changes by one from point to point at most.
        let from = before.unwrap_or(0.0);
        assert!((exit.depth - from).abs() < 0.04, "from {from} m to {} m at {mm} mm", exit.depth);
        before = Some(exit.depth);

        // The hole's edge lies around the line: its normals would be across it.
        assert!(exit.direction.dot(&sight).abs() > 0.1, "{} at {mm} mm", exit.direction);
    }
    assert!(before.is_some_and(|depth| depth > 0.1), "{before:?}");
}
