mod tiles;

use super::*;
use crate::camera::{Distortion, Fisheye};
use nalgebra::{Isometry3, Vector3, point};
use ode_visual_hull_random::Random;

const SIZE: (u32, u32) = (322, 243);

fn camera(focal: f64, coefficients: &[f64]) -> Camera {
    with_lens(focal, Distortion::from_opencv(coefficients).unwrap())
}

fn fisheye(focal: f64, coefficients: &[f64]) -> Camera {
    with_lens(focal, Fisheye::from_opencv(coefficients).unwrap())
}

fn with_lens(focal: f64, lens: impl Into<Lens>) -> Camera {
    let k = Matrix3::new(focal, 0.0, 167.0, 0.0, focal * 1.005, 111.5, 0.0, 0.0, 1.0);
    let pose = Isometry3::new(Vector3::new(0.2, -0.1, 3.0), Vector3::new(1.2, 0.4, -0.3));
    Camera::new("test", SIZE, k, lens, pose).unwrap()
}

/// The cameras of most tests. Their lenses are: barrel, pincushion, rational, one that folds back inside its image, and
/// a thin prism before a tilted sensor; fisheyes that see 58 and 87 degrees off the axis, and one that folds back in
/// the corners.
fn cameras() -> [Camera; 8] {
    [
        camera(270.0, &[-0.369, 0.203, 3e-4, 2e-5, -0.071]),
        camera(245.0, &[0.15, 0.02, -8e-4, 1e-3]),
        camera(200.0, &[0.4, 0.02, 1e-4, -2e-4, 0.001, 0.6, 0.05, 0.003]),
        camera(130.0, &[-0.3, 0.0, 0.0, 0.0]),
        camera(260.0, &[-0.2, 0.05, 1e-3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.01, -2e-3, -8e-3, 1e-3, 0.04, -0.03]),
        fisheye(200.0, &[0.03, -0.01, 2e-3, -1e-4]),
        fisheye(140.0, &[0.0; 4]),
        fisheye(170.0, &[-0.3, 0.0, 0.0, 0.0]),
    ]
}

fn centre(x: u32, y: u32) -> Point2<f64> {
    Point2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)
}

fn is_in(p: &Point2<f64>, (width, height): (u32, u32)) -> bool {
    (0.0..f64::from(width)).contains(&p.x) && (0.0..f64::from(height)).contains(&p.y)
}

/// The position in the image of `to` of the direction that `from` sees at `p`.
fn seen_by(to: &Camera, from: &Camera, p: Point2<f64>) -> Option<Point2<f64>> {
    to.project(&from.unproject(p.x, p.y, 2.0)?).map(|pixel| Point2::new(pixel.u, pixel.v))
}

fn value_at(mask: &GrayImage, p: &Point2<f64>) -> u8 {
    mask.get_pixel(p.x as u32, p.y as u32).0[0]
}

/// The distance from `p` to the nearest pixel whose verdict differs from that of the pixel at `p`, within 3 px.
fn distance_to_edge(mask: &GrayImage, p: &Point2<f64>) -> f64 {
    let own = value_at(mask, p) >= 128;
    let around = |x: f64, length: u32| (x as u32).saturating_sub(3)..(x as u32 + 4).min(length);
    let mut nearest = f64::INFINITY;
    for y in around(p.y, mask.height()) {
        for x in around(p.x, mask.width()) {
            if (mask.get_pixel(x, y).0[0] >= 128) != own {
                let offset = p - centre(x, y);
                let outside = offset.abs().add_scalar(-0.5).sup(&nalgebra::Vector2::zeros());
                nearest = nearest.min(outside.norm());
            }
        }
    }
    nearest
}

/// A star with thin arms: edges of every direction, and details of a few pixels.
fn star() -> GrayImage {
    GrayImage::from_fn(SIZE.0, SIZE.1, |x, y| {
        let offset = centre(x, y) - Point2::new(150.0, 120.0);
        let angle = offset.y.atan2(offset.x);
        Luma([if offset.norm() < 75.0 + 70.0 * (9.0 * angle).sin() { 255 } else { 0 }])
    })
}

#[test]
fn a_pinhole_needs_no_undistortion() {
    assert!(Undistortion::new(&camera(245.0, &[])).is_none());
    assert!(Undistortion::new(&camera(245.0, &[0.0; 5])).is_none());
}

#[test]
fn the_pinhole_stands_where_the_camera_stands() {
    for camera in cameras() {
        let undistortion = Undistortion::new(&camera).unwrap();
        let pinhole = undistortion.pinhole();
        assert!(pinhole.lens().is_none());
        assert_eq!((pinhole.name(), pinhole.cam_from_world()), (camera.name(), camera.cam_from_world()));
        let shift = camera.intrinsics() - pinhole.intrinsics();
        assert_eq!((shift[(0, 2)].fract(), shift[(1, 2)].fract()), (0.0, 0.0));
        assert_eq!(shift.fixed_columns::<2>(0).abs().max(), 0.0);
        assert_eq!(undistortion.field_of_view().dimensions(), pinhole.size());
    }
}

#[test]
fn world_points_find_the_same_verdict_in_both_images_but_at_the_edge() {
    let mask = star();
    for camera in cameras() {
        let undistortion = Undistortion::new(&camera).unwrap();
        let undistorted = undistortion.apply(&mask, 0).unwrap();
        let mut random = Random(7);
        let (mut compared, mut differ) = (0, 0);
        for _ in 0..100_000 {
            let world = random.point(point![-4.0, -4.0, -4.0], point![4.0, 4.0, 4.0]);
            let (Some(a), Some(b)) = (camera.project(&world), undistortion.pinhole().project(&world)) else {
                continue;
            };
            let (a, b) = (Point2::new(a.u, a.v), Point2::new(b.u, b.v));
            if !is_in(&a, SIZE) || !is_in(&b, undistorted.dimensions()) {
                continue;
            }

            compared += 1;
            if (value_at(&mask, &a) >= 128) != (value_at(&undistorted, &b) >= 128) && {
                value_at(undistortion.field_of_view(), &b) == 255
            } {
                differ += 1;
                assert!(distance_to_edge(&mask, &a) <= 1.0, "{a} is {} px", distance_to_edge(&mask, &a));
            }
        }
        assert!(compared > 2_000, "only {compared} points seen");
        // No point of the star is far from an edge, so that a wrong map would differ at a third of the points.
        assert!(differ * 20 < compared, "{differ} of {compared} differ");
    }
}

#[test]
fn unseen_pixels_are_exactly_those_whose_source_is_outside() {
    for camera in cameras() {
        let undistortion = Undistortion::new(&camera).unwrap();
        for (x, y, seen) in undistortion.field_of_view().enumerate_pixels() {
            let source = seen_by(&camera, undistortion.pinhole(), centre(x, y));
            let expected = source.is_some_and(|p| is_in(&p, SIZE));

            // Rounding decides if the source is within 1e-9 px of the border.
            let at_border =
                source.is_some_and(|p| is_in(&(p + nalgebra::Vector2::repeat(1e-9)), SIZE) != expected);
            assert!((seen.0[0] == 255) == expected || at_border, "pixel {x}, {y}: source {source:?}");
        }
    }
}

#[test]
fn the_pinhole_covers_all_that_the_camera_sees_and_no_more() {
    let [barrel, pincushion, rational, _, prism, fisheye, ..] = cameras();
    for camera in [barrel, pincushion, rational, prism, fisheye] {
        let undistortion = Undistortion::new(&camera).unwrap();
        let pinhole = undistortion.pinhole();
        for (x, y) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))) {
            let place = seen_by(pinhole, &camera, centre(x, y)).unwrap();
            assert!(is_in(&place, pinhole.size()), "source pixel {x}, {y} would fall on {place}");
        }

        // The field of view reaches into the outermost rows and columns, but need not reach their centres. So it holds
        // pixels of the second ones.
        let (width, height) = pinhole.size();
        let seen = |x, y| undistortion.field_of_view().get_pixel(x, y).0[0] == 255;
        assert!((0..height).any(|y| seen(1, y)) && (0..height).any(|y| seen(width - 2, y)));
        assert!((0..width).any(|x| seen(x, 1)) && (0..width).any(|x| seen(x, height - 2)));
    }
}

#[test]
fn a_lens_that_folds_back_inside_its_image_is_used_up_to_the_fold() {
    // x (1 - 0.3 r2) folds at r = 1 / sqrt 0.9 = 1.054: 137 px from the axis, within the 260 px allowed.
    let undistortion = Undistortion::new(&cameras()[3]).unwrap();
    let (width, height) = undistortion.pinhole().size();
    let fold = 130.0 / 0.9_f64.sqrt();
    assert!((f64::from(width) - 2.0 * fold).abs() < 2.0, "{width}");
    assert!((f64::from(height) - 2.0 * fold * 1.005).abs() < 2.0, "{height}");
    assert_eq!(undistortion.field_of_view().get_pixel(0, 0).0[0], 0);
    assert_eq!(undistortion.field_of_view().get_pixel(width / 2, height / 2).0[0], 255);
}

#[test]
fn of_a_wide_fisheye_the_part_around_the_axis_is_kept_in_an_image_of_twice_the_size() {
    let undistortion = Undistortion::new(&cameras()[6]).unwrap();
    let pinhole = undistortion.pinhole();
    assert_eq!(pinhole.size(), (2 * SIZE.0, 2 * SIZE.1));
    let axis = Point2::from(pinhole.intrinsics().column(2).xy());
    assert!(is_in(&axis, pinhole.size()) && value_at(undistortion.field_of_view(), &axis) == 255);
    // The original's corner is 86.5 degrees off the axis, which the pinhole would see 16 focal lengths from it.
    let corner = pinhole.project(&cameras()[6].unproject(0.5, 242.5, 1.0).unwrap()).unwrap();
    assert!(!is_in(&Point2::new(corner.u, corner.v), pinhole.size()));
}

#[test]
fn what_lies_beyond_the_fold_of_a_fisheye_is_unseen() {
    // theta (1 - 0.3 theta^2) folds at theta = 1 / sqrt 0.9, which a pinhole sees 170 tan(theta) px from its axis.
    let undistortion = Undistortion::new(&cameras()[7]).unwrap();
    let pinhole = undistortion.pinhole();
    let fold = (1.0 / 0.9_f64.sqrt()).tan();
    let to_plane = pinhole.intrinsics().try_inverse().unwrap();
    let seen = undistortion.field_of_view().enumerate_pixels().filter(|(_, _, value)| value.0[0] == 255);
    let farthest =
        seen.map(|(x, y, _)| apply_affine(&to_plane, centre(x, y)).coords.norm()).fold(0.0, f64::max);
    // The tolerance is a pixel, 1/170 on the plane.
    assert!((fold - farthest).abs() < 1.0 / 170.0, "{farthest} {fold}");
}

#[test]
fn the_pinhole_is_at_most_twice_as_wide_and_high() {
    // x (1 - 0.2 r2 + 0.0185 r4) does not fold, but shrinks to 0.46 of itself on the way to the image's sides.
    let camera = camera(145.0, &[-0.2, 0.0185, 0.0, 0.0]);
    let undistortion = Undistortion::new(&camera).unwrap();
    let (width, height) = undistortion.pinhole().size();
    assert!(width <= 2 * SIZE.0 && height <= 2 * SIZE.1, "{width} x {height}");
    assert!(width == 2 * SIZE.0 || height == 2 * SIZE.1, "{width} x {height}");
    let k = undistortion.pinhole().intrinsics();
    assert!(is_in(&Point2::new(k[(0, 2)], k[(1, 2)]), (width, height)));
}

#[test]
fn a_straight_line_in_the_world_is_straight_in_the_undistorted_mask() {
    let camera = &cameras()[0];
    let undistortion = Undistortion::new(camera).unwrap();
    let pinhole = undistortion.pinhole();
    // The subject is all that lies on one side of the plane through the camera and a line in space.
    let line = [camera.unproject(60.0, 5.0, 2.0).unwrap(), camera.unproject(25.0, 230.0, 3.0).unwrap()];
    let normal = (line[0] - camera.centre()).cross(&(line[1] - camera.centre())).normalize();
    let side = |p: Point2<f64>| camera.ray(p.x, p.y).unwrap().direction.dot(&normal);

    // Coverage by 8 x 8 samples per pixel, through the lens. A pixel is at most 0.004 rad wide.
    let coverage = |x: u32, y: u32| {
        let middle = centre(x, y);
        if side(middle).abs() > 0.01 {
            return f64::from(u8::from(side(middle) > 0.0));
        }
        let offset = |i: u32| (f64::from(i) - 3.5) / 8.0;
        let sample = |i: u32| middle + nalgebra::Vector2::new(offset(i % 8), offset(i / 8));
        (0..64).filter(|&i| side(sample(i)) > 0.0).count() as f64 / 64.0
    };
    let mask = GrayImage::from_fn(SIZE.0, SIZE.1, |x, y| Luma([(255.0 * coverage(x, y)).round() as u8]));
    let undistorted = undistortion.apply(&mask, 0).unwrap();

    // In each row the distance from the line's image to where the undistorted mask crosses half coverage.
    let [a, b] = line.map(|p| pinhole.project(&p).unwrap());
    let mut errors = Vec::new();
    for y in a.v as u32 + 3..b.v as u32 - 3 {
        let v = f64::from(y) + 0.5;
        let expected = a.u + (b.u - a.u) * (v - a.v) / (b.v - a.v);
        let value = |x: u32| f64::from(undistorted.get_pixel(x, y).0[0]) - 127.5;
        let near = (expected as u32).saturating_sub(4)..expected as u32 + 4;
        let Some(x) = near.into_iter().find(|&x| value(x) * value(x + 1) < 0.0) else {
            panic!("no edge near {expected} in row {y}");
        };
        let found = f64::from(x) + 0.5 + value(x) / (value(x) - value(x + 1));
        errors.push(found - expected);
    }
    assert!(errors.len() > 200);

    // Linear interpolation of coverage misplaces an edge by up to 0.086 px per axis and pass, equally to both sides.
    let worst = errors.iter().fold(0.0, |worst: f64, error| worst.max(error.abs()));
    assert!(worst < 0.2, "{worst}");
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    assert!(mean.abs() < 0.02, "{mean}");

    // Through the lens the line bows by several pixels, so that the test would detect a missing undistortion.
    let middle = camera.project(&nalgebra::center(&line[0], &line[1])).unwrap();
    let chord = line.map(|p| camera.project(&p).unwrap()).map(|p| Point2::new(p.u, p.v));
    let along = (chord[1] - chord[0]).normalize();
    assert!(along.perp(&(Point2::new(middle.u, middle.v) - chord[0])).abs() > 3.0);
}

#[test]
fn values_are_interpolated_between_pixel_centres() {
    let camera = &cameras()[0];
    let undistortion = Undistortion::new(camera).unwrap();
    let ramp = GrayImage::from_fn(200, SIZE.1, |x, _| Luma([x as u8]));
    let mask = GrayImage::from_fn(SIZE.0, SIZE.1, |x, y| *ramp.get_pixel(x.min(199), y));
    let undistorted = undistortion.apply(&mask, 77).unwrap();
    for (x, y, value) in undistorted.enumerate_pixels() {
        let source = seen_by(camera, undistortion.pinhole(), centre(x, y)).filter(|p| is_in(p, SIZE));
        match source {
            None => assert_eq!(value.0[0], 77),
            // Rounding to grey levels adds half a level, and the fixed-point weights add 1/512 px.
            Some(p) => {
                assert!((f64::from(value.0[0]) - (p.x - 0.5).clamp(0.0, 199.0)).abs() < 0.503, "{x}, {y}")
            }
        }
    }
}

#[test]
fn empty_and_full_masks_stay_so() {
    for camera in cameras() {
        let undistortion = Undistortion::new(&camera).unwrap();
        let full = GrayImage::from_pixel(SIZE.0, SIZE.1, Luma([255]));
        assert_eq!(&undistortion.apply(&full, 0).unwrap(), undistortion.field_of_view());
        let empty = undistortion.apply(&GrayImage::new(SIZE.0, SIZE.1), 0).unwrap();
        assert!(empty.iter().all(|&value| value == 0));
    }
}

#[test]
fn a_mask_of_another_size_is_refused_with_both_sizes() {
    let undistortion = Undistortion::new(&cameras()[0]).unwrap();
    let message = undistortion.apply(&GrayImage::new(10, 20), 0).unwrap_err().to_string();
    assert!(message.starts_with("view \"test\": expected a mask of 322 x 243"), "{message}");
    assert!(message.contains("found 10 x 20"), "{message}");
}

#[test]
fn images_of_one_pixel_and_absurd_lenses_do_no_harm() {
    let pose = Isometry3::identity();
    for size in [(1, 1), (1, 9), (9, 1), (2, 2)] {
        for coefficients in
            [[-0.1, 0.0, 0.0, 0.0], [-1e6, 0.0, 0.0, 0.0], [1e9, 1e9, 1e3, 1e3], [0.0, 0.0, 5.0, 5.0]]
        {
            for axis in [0.5, 1e5, -1e5] {
                let k = Matrix3::new(3.0, 0.0, axis, 0.0, 3.0, 0.5, 0.0, 0.0, 1.0);
                let lens = Distortion::from_opencv(&coefficients).unwrap();
                let camera = Camera::new("tiny", size, k, lens, pose).unwrap();
                let undistortion = Undistortion::new(&camera).unwrap();
                let (width, height) = undistortion.pinhole().size();
                assert!(width <= 2 * size.0 && height <= 2 * size.1);
                undistortion.apply(&GrayImage::new(size.0, size.1), 0).unwrap();
            }
        }
    }
}

#[test]
fn colours_are_undistorted_as_masks_are_channel_by_channel_and_within_the_rectangle_alone() {
    for camera in cameras() {
        let undistortion = Undistortion::new(&camera).unwrap();
        let mut random = Random(5);
        let mut channel = || {
            let values = (0..SIZE.0 * SIZE.1).map(|_| random.below(256_u32) as u8);
            GrayImage::from_raw(SIZE.0, SIZE.1, values.collect()).unwrap()
        };
        let channels = [channel(), channel(), channel()];
        let image = RgbImage::from_fn(SIZE.0, SIZE.1, |x, y| {
            image::Rgb([0, 1, 2].map(|c| channels[c].get_pixel(x, y).0[0]))
        });
        let expected = channels.map(|channel| undistortion.apply(&channel, 0).unwrap());

        let (width, height) = undistortion.pinhole().size();
        let rect = Rect { x0: 20, y0: 15, x1: width as i32 - 7, y1: height as i32 + 9 };
        let mut found = RgbImage::default();
        undistortion.apply_to_image(&image, &rect, &mut found).unwrap();
        for (x, y, pixel) in found.enumerate_pixels() {
            let is_drawn = rect.contains(x as i32, y as i32);
            let value = |c: usize| if is_drawn { expected[c].get_pixel(x, y).0[0] } else { 0 };
            assert_eq!(pixel.0, [0, 1, 2].map(value), "{x}, {y}");
        }
    }
    let undistortion = Undistortion::new(&cameras()[0]).unwrap();
    let refused = undistortion.apply_to_image(&RgbImage::new(3, 4), &Rect::EMPTY, &mut RgbImage::default());
    assert!(refused.unwrap_err().to_string().contains("expected an image of 322 x 243"));
}
