use super::*;
use image::{Rgb, RgbImage};
use nalgebra::{Vector3, vector};
use ode_visual_hull::camera::Distortion;
use ode_visual_hull::hull::Aabb;

const RED: [u8; 3] = [255, 0, 0];
const SIZE: (u32, u32) = (64, 48);

/// A camera 2 m in front of the origin that looks along +x, with +y on the left and 32 pixels for a metre there.
fn viewpoint(size: (u32, u32)) -> Camera {
    // A width of 2 m at a depth of 2 m.
    let field_of_view = 2.0 * 0.5_f64.atan();
    let eye = Point3::new(-2.0, 0.0, 0.0);
    Camera::look_at("viewpoint", size, field_of_view, eye, Point3::origin(), Vector3::z()).unwrap()
}

fn drawn(overlay: &Overlay, surface: f32) -> RgbImage {
    let mut picture = Picture::new(SIZE.0, SIZE.1);
    picture.depth.fill(surface);
    overlay.draw(&mut picture, &viewpoint(SIZE));
    picture.colour
}

fn line(from: Point3<f64>, to: Point3<f64>) -> Overlay {
    let mut overlay = Overlay::new();
    overlay.add_line(from, to, RED);
    overlay
}

/// The sum of the red of all pixels, in pixels that are fully red.
fn area(image: &RgbImage) -> f64 {
    image.pixels().map(|Rgb([red, ..])| f64::from(*red)).sum::<f64>() / 255.0
}

/// The centre of what is red, in pixels.
fn centroid(image: &RgbImage) -> (f64, f64) {
    let weighted = |of: fn(u32, u32) -> u32| {
        let sum: f64 =
            image.enumerate_pixels().map(|(x, y, p)| (f64::from(of(x, y)) + 0.5) * f64::from(p[0])).sum();
        sum / 255.0 / area(image)
    };
    (weighted(|x, _| x), weighted(|_, y| y))
}

#[test]
fn a_line_is_as_long_and_as_wide_as_its_projection() {
    // 32 pixels for a metre; rounding to 8 bits is at most a five hundredth of each pixel.
    for (dy, dz) in [(0.5, 0.0), (0.0, 0.5), (0.4, 0.3), (-0.3, 0.4), (0.3, 0.3)] {
        let image = drawn(&line(Point3::new(0.0, -dy, -dz), Point3::new(0.0, dy, dz)), f32::INFINITY);
        assert!((area(&image) - 32.0 * 2.0 * f64::hypot(dy, dz)).abs() < 0.5, "{dy}, {dz}: {}", area(&image));
        let (u, v) = centroid(&image);
        assert!((u - 32.0).abs() < 0.05 && (v - 24.0).abs() < 0.05, "{u}, {v}");
    }
}

#[test]
fn lines_of_wide_pictures_are_two_pixels_wide() {
    let mut picture = Picture::new(1024, 768);
    line(Point3::origin(), Point3::new(0.0, 0.5, 0.0)).draw(&mut picture, &viewpoint((1024, 768)));
    assert!((area(&picture.colour) - 2.0 * 256.0).abs() < 2.0, "{}", area(&picture.colour));
}

#[test]
fn what_is_behind_the_viewpoint_or_outside_the_picture_is_cut_off() {
    // From behind the viewpoint, straight ahead and a little down: from the lower border to the middle.
    let image = drawn(&line(Point3::new(-4.0, 0.0, -0.2), Point3::new(1e4, 0.0, -0.2)), f32::INFINITY);
    assert!((area(&image) - 24.0).abs() < 0.5, "{}", area(&image));
    let (u, v) = centroid(&image);
    assert!((u - 32.0).abs() < 0.05 && (v - 36.0).abs() < 0.3, "{u}, {v}");

    let whole_width = drawn(&line(Point3::new(0.0, -1e6, 0.0), Point3::new(0.0, 1e6, 0.0)), f32::INFINITY);
    assert!((area(&whole_width) - 64.0).abs() < 0.5, "{}", area(&whole_width));
    let nothing = [
        line(Point3::new(-3.0, 0.0, 0.0), Point3::new(-2.5, 1.0, 0.0)),
        line(Point3::new(0.0, 1.2, 0.0), Point3::new(0.0, 3.0, 0.0)),
        line(Point3::new(0.0, f64::NAN, 0.0), Point3::new(0.0, 1.0, 0.0)),
        line(Point3::new(0.0, 0.0, f64::INFINITY), Point3::new(0.0, 0.0, f64::NEG_INFINITY)),
    ];
    for overlay in nothing {
        assert_eq!(area(&drawn(&overlay, f32::INFINITY)), 0.0, "{overlay:?}");
    }
}

#[test]
fn what_lies_behind_a_surface_is_faint_from_the_pixel_on_where_it_passes_it() {
    // A line from 1 m to 4 m away; the surface is 2 m away. Its image goes from 48 to 36 pixels, and reaches 2 m at 40.
    let slanted = line(Point3::new(-1.0, -0.25, 0.0), Point3::new(2.0, -0.25, 0.0));
    let image = drawn(&slanted, 2.0);
    let brightest = |x: u32| (0..SIZE.1).map(|y| u32::from(image.get_pixel(x, y)[0])).sum::<u32>();
    for (x, expected) in [(46, 255.0), (41, 255.0), (38, 64.0), (36, 64.0), (35, 0.0), (49, 0.0)] {
        assert!((f64::from(brightest(x)) - expected).abs() <= 2.0, "{x}: {}", brightest(x));
    }
    let on_surface = drawn(&line(Point3::origin(), Point3::new(0.0, 0.5, 0.0)), 2.0);
    assert!((area(&on_surface) - 16.0).abs() < 0.1, "{}", area(&on_surface));
}

#[test]
fn through_a_lens_lines_bend_as_the_camera_sees_them() {
    let lens = Distortion::from_opencv(&[-0.3, 0.0, 0.0, 0.0]).unwrap();
    let viewpoint = viewpoint(SIZE).with_lens(lens).unwrap();
    let [from, middle, to] = [-0.6, 0.0, 0.6].map(|y| Point3::new(0.0, y, 0.5));
    let mut picture = Picture::new(SIZE.0, SIZE.1);
    line(from, to).draw(&mut picture, &viewpoint);
    for point in [middle, from + 0.3 * (to - from), from + 0.97 * (to - from)] {
        let pixel = viewpoint.project(&point).unwrap();
        let column = (0..SIZE.1).map(|y| f64::from(picture.colour.get_pixel(pixel.u as u32, y)[0]) / 255.0);
        let (sum, weighted) = column
            .enumerate()
            .fold((0.0, 0.0), |(sum, all), (y, red)| (sum + red, all + red * (y as f64 + 0.5)));
        // Half a column from the point, the line is up to a quarter of a pixel higher.
        assert!((weighted / sum - pixel.v).abs() < 0.3, "{point}: {} for {pixel:?}", weighted / sum);
    }
}

#[test]
fn points_are_discs_and_labels_stand_to_their_right() {
    let mut overlay = Overlay::new();
    overlay.add_point(Point3::new(0.0, 0.5, 0.0), RED);
    let image = drawn(&overlay, f32::INFINITY);
    // The soft edge of a disc of 2 pixels is a pixel wide.
    assert!((area(&image) - std::f64::consts::PI * 4.0).abs() < 1.0, "{}", area(&image));
    let (u, v) = centroid(&image);
    assert!((u - 16.0).abs() < 0.1 && (v - 24.0).abs() < 0.1, "{u}, {v}");

    let mut overlay = Overlay::new();
    overlay.add_label(Point3::new(0.0, 0.5, 0.0), "ab", RED);
    let image = drawn(&overlay, f32::INFINITY);
    let (u, v) = centroid(&image);
    assert!(u > 16.0 && (v - 24.0).abs() < 4.0 && area(&image) > 10.0, "{u}, {v}");
    assert!(area(&drawn(&overlay, 1.0)) < 0.75 * area(&image));
}

#[test]
fn a_box_and_the_axes_are_drawn_where_their_corners_and_ends_are() {
    let mut overlay = Overlay::new();
    overlay.add_box(&Aabb::new(Point3::new(-0.5, -0.6, -0.4), Point3::new(0.5, 0.6, 0.4)).unwrap(), RED);
    assert_eq!(overlay.lines.len(), 12);
    let ends: Vec<_> = overlay.lines.iter().map(|line| line.ends[1] - line.ends[0]).collect();
    let sum: Vector3<f64> = ends.iter().sum();
    assert!((sum - vector![4.0, 4.8, 3.2]).norm() < 1e-12, "{sum}");
    assert!(ends.iter().all(|way| way.iter().filter(|length| **length != 0.0).count() == 1));

    overlay.add_box(&Aabb::EMPTY, RED);
    assert_eq!(overlay.lines.len(), 12);
    overlay.add_axes(0.3);
    let names: Vec<_> = overlay.labels.iter().map(|label| (label.text.as_str(), label.at)).collect();
    let at = |axis: usize| Point3::from(Vector3::ith(axis, 0.3));
    assert_eq!(names, [("x", at(0)), ("y", at(1)), ("z", at(2))]);
}

#[test]
fn a_camera_is_a_pyramid_from_its_centre_over_its_image() {
    let camera = viewpoint(SIZE);
    let mut overlay = Overlay::new();
    overlay.add_camera(&camera, 0.5, RED, "cam0");
    assert_eq!(overlay.lines.iter().filter(|line| line.ends[0] == camera.centre()).count(), 4);
    let at_corner = |line: &Line| {
        camera.project(&line.ends[1]).is_some_and(|p| {
            let on = |x: f64, size: f64| x.abs().min((x - size).abs()) < 1e-6;
            on(p.u, 64.0) && on(p.v, 48.0) && (p.depth - 0.5).abs() < 1e-9
        })
    };
    assert_eq!(overlay.lines.iter().filter(|line| at_corner(line)).count(), 8);
    assert_eq!(overlay.labels[0].text, "cam0");
    // The mark is above the image.
    assert!(overlay.lines.iter().any(|line| line.ends[1].z > 0.5 * 0.375 + 0.01));
}

#[test]
fn the_normal_of_a_contact_shows_its_depth_and_the_arrow_its_speed() {
    let contact = |depth: f64, velocity: Vector3<f64>| {
        let mut overlay = Overlay::new();
        overlay.add_contact(Point3::origin(), Vector3::z(), depth, velocity);
        overlay.lines.iter().map(|line| line.ends[1] - Point3::origin()).collect::<Vec<_>>()
    };
    assert_eq!(contact(0.0, Vector3::zeros()), [vector![0.0, 0.0, 0.03]]);
    let [normal, arrow, head @ ..] =
        contact(0.01, vector![0.0, 1.0, 0.0]).try_into().map(|lines: [_; 6]| lines).unwrap();
    assert_eq!((normal, arrow), (vector![0.0, 0.0, 0.1], vector![0.0, 0.2, 0.0]));
    assert!(head.iter().all(|end| (0.1..0.2).contains(&end.y)), "{head:?}");
}
