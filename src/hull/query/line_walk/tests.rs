//! Traversals at an open border, and the roots of the coverage along a line.

use super::*;
use crate::hull::View;
use crate::hull::tests::cameras;
use crate::silhouette::{Border, Silhouette};
use image::{GrayImage, Luma};
use ode_visual_hull_random::Random;
use std::sync::Arc;

#[test]
fn a_line_that_enters_the_image_at_an_open_border_starts_in_its_first_pixel() {
    // Subject in the first column, and one pixel far from it.
    let mask =
        GrayImage::from_fn(160, 120, |i, j| Luma([if i == 0 || (i, j) == (50, 60) { 255 } else { 0 }]));
    let (camera, silhouette) = (cameras().swap_remove(0), Silhouette::new(&mask, Border::Unknown));
    let view = View::new(Arc::new(camera), Arc::new(silhouette), None);

    let mut random = Random(5);
    for _ in 0..300 {
        let row = 1.0 + 118.0 * random.unit();
        let mut point = |u: f64| view.camera().unproject(u, row, 1.0 + random.unit());
        let (Some(from), Some(to)) = (point(-20.0), point(40.0)) else { panic!("a pinhole sees both") };
        let direction = view.homogeneous_direction(&(to - from).normalize());
        let line = ImageLine::new(view.homogeneous(&from), direction);
        let mut traversal = MaskTraversal::from_start(view.silhouette(), line, EdgeModel::Pixel);
        assert_eq!(traversal.verdict(), Verdict::Unseen);
        traversal.step();
        assert_eq!(traversal.verdict(), Verdict::Inside);

        // It leaves where the first column ends; the crossing has a closed form, so that only rounding remains.
        let exit = traversal.advance_until_exit(0.0, f64::INFINITY);
        let u = traversal.line.at(exit).0;
        assert!((u - 1.0).abs() < 1e-9, "left at column {u}, entered in row {row}");
    }
}

#[test]
fn roots_are_the_sign_changes_in_order() {
    assert_eq!(roots_within_unit(-1.0, 2.0, 0.0), [Some(0.5), None]);
    assert_eq!(roots_within_unit(1.0, -2.0, 0.0), [Some(0.5), None]);
    assert_eq!(roots_within_unit(3.0, -16.0, 16.0), [Some(0.25), Some(0.75)]);
    assert_eq!(roots_within_unit(1.0, 0.0, 1.0), [None, None]);
    assert_eq!(roots_within_unit(1.0, 0.0, 0.0), [None, None]);
}
