use super::*;
use nalgebra::Vector2;

mod tables;

/// A binary mask whose subject pixels are those for whose centres `inside` holds.
fn drawn(width: u32, height: u32, inside: impl Fn(f64, f64) -> bool) -> GrayImage {
    GrayImage::from_fn(width, height, |i, j| {
        image::Luma([if inside(f64::from(i) + 0.5, f64::from(j) + 0.5) { 255 } else { 0 }])
    })
}

/// A mask with coverage: the fraction of 16x16 samples per pixel for which `inside` holds.
fn covered(width: u32, height: u32, inside: impl Fn(f64, f64) -> bool) -> GrayImage {
    GrayImage::from_fn(width, height, |i, j| {
        let at = |k: u32| (f64::from(k % 16) + 0.5) / 16.0;
        let hits = (0..256).filter(|&k| inside(f64::from(i) + at(k), f64::from(j) + at(k / 16))).count();
        image::Luma([(hits as f64 / 256.0 * 255.0).round() as u8])
    })
}

/// A ring with a corner cut off, and an arm that touches the right border of an image of 70x50 pixels: it has curved,
/// concave and straight edges.
fn blob(u: f64, v: f64) -> bool {
    let r = (u - 40.0).hypot(v - 25.0);
    (r < 22.0 && r > 6.0 && u + v > 40.0) || (u > 50.0 && (v - 30.0).abs() < 4.0)
}

/// The Chebyshev distance to background by growing a window.
fn brute_force_distance(s: &Silhouette, i: i32, j: i32) -> u16 {
    (0..)
        .find(|&half| {
            let window = Rect::window(i, j, half);
            let mut pixels = (window.y0..window.y1).flat_map(|y| (window.x0..window.x1).map(move |x| (x, y)));
            pixels.any(|(x, y)| !s.is_subject(x, y))
        })
        .unwrap() as u16
}

#[test]
fn distance_is_the_half_width_of_the_first_window_with_background() {
    for border in [Border::Background, Border::Unknown] {
        let s = Silhouette::new(&drawn(70, 50, blob), border);
        for j in 0..50 {
            for i in 0..70 {
                assert_eq!(s.distance(i, j), brute_force_distance(&s, i, j), "{border:?} ({i}, {j})");
            }
        }
    }
}

#[test]
fn nearest_background_is_the_first_in_row_major_order_of_the_least_euclidean_distance() {
    let s = Silhouette::new(&drawn(70, 50, blob), Border::Background);
    for (i, j) in (0..50).flat_map(|j| (0..70).map(move |i| (i, j))) {
        let half = 3 * i32::from(s.distance(i, j));
        let window = Rect::window(i, j, half);
        let pixels = (window.y0..window.y1).flat_map(|y| (window.x0..window.x1).map(move |x| (x, y)));
        let brute = pixels
            .filter(|&(x, y)| !s.is_subject(x, y))
            .min_by_key(|&(x, y)| ((x - i).pow(2) + (y - j).pow(2), y, x));
        assert_eq!(s.nearest_background(i, j, half), brute, "({i}, {j})");
    }
}

#[test]
fn rect_is_the_bounding_rectangle_of_the_subject() {
    let s = Silhouette::new(
        &drawn(70, 50, |u, v| u > 10.0 && u < 20.0 && v > 30.0 && v < 33.0),
        Border::Background,
    );
    assert_eq!(s.rect(), Rect { x0: 10, y0: 30, x1: 20, y1: 33 });
    assert!(Silhouette::new(&GrayImage::new(8, 8), Border::Background).rect().is_empty());
}

#[test]
fn distances_beyond_a_byte_are_exact() {
    let mask = drawn(700, 620, |u, v| (u - 330.0).abs() < 300.0 && (v - 310.0).abs() < 290.0);
    for border in [Border::Background, Border::Unknown] {
        let s = Silhouette::new(&mask, border);
        assert_eq!((s.distance(330, 310), s.distance(31, 310), s.distance(330, 20)), (290, 2, 1));
        assert_eq!(s.distance(330, 310 - 40), 251);
        assert_eq!(s.distance(330, 310 - 30), 261);
    }

    // With an unknown border the distances from the only edge grow up to the image's width.
    let half = Silhouette::new(&drawn(900, 40, |u, _| u < 800.0), Border::Unknown);
    assert_eq!([800, 799, 500, 0].map(|i| half.distance(i, 20)), [0, 1, 300, 800]);
}

#[test]
fn occupancy_misses_no_subject_pixel_and_is_exact_to_a_tile() {
    let s = Silhouette::new(&drawn(200, 150, |u, v| blob(u - 90.0, v - 60.0)), Border::Background);
    let (crop, occupancy) = (s.crop.rect(), s.tables().occupancy.lookup());

    // Queries clamp pixels beyond the crop to its rim.
    let is_occupied = |rect: &Rect| {
        let column = |i: i32| (i - crop.x0).clamp(0, crop.width() as i32) as u32;
        let row = |j: i32| (j - crop.y0).clamp(0, crop.height() as i32) as u32;
        occupancy.any_occupied([column(rect.x0), row(rect.y0)], [column(rect.x1), row(rect.y1)])
    };

    let mut empty = 0;
    for k in 0..2000 {
        let (x0, y0) = (k * 37 % 190, k * 53 % 140);
        let rect = Rect { x0, y0, x1: x0 + 1 + k % 19, y1: y0 + 1 + k % 23 };
        let any = |rect: &Rect| (rect.y0..rect.y1).any(|j| (rect.x0..rect.x1).any(|i| s.is_subject(i, j)));
        assert!(is_occupied(&rect) || !any(&rect), "{rect:?}");

        // A tile is 8 pixels wide: every tile that overlaps the rectangle lies within 7 pixels of it.
        assert!(!is_occupied(&rect) || any(&rect.grown(7)), "{rect:?}");
        empty += i32::from(!is_occupied(&rect));
    }
    assert!(empty > 500);
}

#[test]
fn a_silhouette_in_reused_memory_equals_a_new_one() {
    let masks = [
        drawn(70, 50, blob),
        GrayImage::new(70, 50),
        drawn(200, 150, |u, v| blob(u - 90.0, v - 60.0)),
        covered(70, 50, blob),
        drawn(700, 620, |u, v| (u - 330.0).abs() < 300.0 && (v - 310.0).abs() < 290.0),
    ];

    let mut reused = Silhouette::blank(Border::Unknown);
    for (mask, border) in
        masks.iter().cycle().zip([Border::Background, Border::Unknown].iter().cycle()).take(10)
    {
        reused.refill(mask, *border);
        let fresh = Silhouette::new(mask, *border);
        assert_eq!(reused.rect(), fresh.rect());
        assert_eq!(reused.has_coverage(), fresh.has_coverage());
        assert!(reused.edge_pixels().eq(fresh.edge_pixels()));
        assert!(reused.edge_pixels().all(|(i, j)| reused.edge(i, j) == fresh.edge(i, j)));

        let pixels = (-3..53).flat_map(|j| (-3..73).map(move |i| (i, j)));
        for (i, j) in pixels {
            assert_eq!(reused.value(i, j), fresh.value(i, j));
            assert_eq!(reused.distance(i, j), fresh.distance(i, j));
        }
    }
}

#[test]
fn tables_that_were_taken_out_are_derived_again_by_the_next_query() {
    let mask = covered(70, 50, blob);
    let fresh = Silhouette::new(&mask, Border::Background);
    let mut s = Silhouette::new(&mask, Border::Background);
    let full = s.working_memory();

    // Any query may be the first one.
    let pixels: Vec<_> = (0..50).flat_map(|j| (0..70).map(move |i| (i, j))).collect();
    assert!(s.take_tables().is_some() && s.take_tables().is_none());
    assert!(2 * s.working_memory() < full);
    assert!(pixels.iter().all(|&(i, j)| s.distance(i, j) == fresh.distance(i, j)));
    s.take_tables();
    assert!(s.edge_pixels().eq(fresh.edge_pixels()));
    s.take_tables();
    assert!(fresh.edge_pixels().all(|(i, j)| s.edge(i, j) == fresh.edge(i, j)));
    s.take_tables();
    assert_eq!(s.tables().distance_words, fresh.tables().distance_words);

    // A silhouette of an image without pixels has no tables to take, and can be queried.
    let mut blank = Silhouette::blank(Border::Background);
    assert!(blank.take_tables().is_none());
    assert_eq!((blank.distance(3, 4), blank.edge(3, 4)), (0, None));
}

#[test]
fn repeated_queries_of_an_edge_give_equal_results() {
    let s = Silhouette::new(&covered(70, 50, blob), Border::Background);
    let once: Vec<_> = s.edge_pixels().map(|(i, j)| s.edge(i, j)).collect();
    assert!(once.len() > 100 && s.edge_pixels().map(|(i, j)| s.edge(i, j)).eq(once.iter().copied()));
    assert!(s.edge_pixels().map(|(i, j)| contact_edge::at(&s, (i, j))).eq(once));
}

/// The weighted mean vector from `(i, j)` to the background around it, computed pixel by pixel.
fn weighted_mean(s: &Silhouette, i: i32, j: i32) -> Vector2<f64> {
    let (mut sum, mut total) = (Vector2::zeros(), 0.0);
    for (dy, dx) in (-6..=6).flat_map(|dy| (-6..=6).map(move |dx| (dy, dx))) {
        let rest = f64::max(1.0 - f64::from(dx * dx + dy * dy) / 48.0, 0.0);
        let weight = f64::from(255 - s.value(i + dx, j + dy)) * (rest * rest * rest);
        sum += Vector2::new(f64::from(dx), f64::from(dy)) * weight;
        total += weight;
    }
    sum / total
}

#[test]
fn contact_normals_have_the_bits_of_the_weighted_mean_one_by_one_and_in_batches() {
    for (mask, border) in [
        (drawn(70, 50, blob), Border::Background),
        (drawn(70, 50, blob), Border::Unknown),
        (covered(70, 50, blob), Border::Background),
        (drawn(9, 7, |u, _| u > 4.0), Border::Background),
    ] {
        let (single, batch) = (Silhouette::new(&mask, border), Silhouette::new(&mask, border));
        let pixels: Vec<_> = batch.edge_pixels().map(|at| batch.edge_pixel(at)).collect();
        compute_edges(&batch, &pixels);
        assert!(!pixels.is_empty());

        for pixel in &pixels {
            let (i, j) = pixel.at;
            assert!(!batch.claim_edge(pixel) && single.claim_edge(&single.edge_pixel((i, j))));
            let normal = weighted_mean(&single, i, j).try_normalize(0.3);
            assert_eq!(single.edge(i, j).map(|edge| edge.normal), normal, "{border:?} ({i}, {j})");
            assert_eq!(single.edge(i, j), batch.edge(i, j));
        }
    }
}

#[test]
fn the_border_of_a_full_mask_is_an_edge_unless_it_is_unknown() {
    let full = drawn(9, 9, |_, _| true);
    assert_eq!(Silhouette::new(&full, Border::Unknown).distance(4, 4), u16::MAX);
    assert_eq!(Silhouette::new(&full, Border::Background).distance(4, 4), 5);
}

#[test]
fn contact_normals_of_a_straight_edge_are_accurate_at_every_slope() {
    for degrees in [0.0_f64, 10.0, 20.0, 30.0, 40.0, 45.0, 77.0] {
        let normal = Vector2::new(degrees.to_radians().sin(), -degrees.to_radians().cos());
        let inside = |u: f64, v: f64| (u - 30.3) * normal.x + (v - 30.2) * normal.y < 0.0;

        // Binary masks: half a pixel of stair over the window's 6 px, atan(0.5 / 6). Coverage has no stairs.
        for (mask, worst) in [(drawn(60, 60, inside), 4.8_f64), (covered(60, 60, inside), 1.0)] {
            let s = Silhouette::new(&mask, Border::Unknown);
            for (i, j) in s.edge_pixels().filter(|&(i, j)| (12..48).contains(&i) && (12..48).contains(&j)) {
                let edge = s.edge(i, j).unwrap();
                let error = edge.normal.angle(&normal).to_degrees();
                assert!(error < worst, "slope {degrees}: {error} degrees at ({i}, {j})");
            }
        }
    }
}

#[test]
fn coverage_normals_of_a_straight_edge_are_accurate_to_a_few_hundredths_of_a_degree_on_average() {
    // The edge is a table's top at the height of a camera that is rolled by each of these angles. A sphere at rest on
    // the table rolls away if the normals tilt: weights that are cut off by a square window have a mean error of 0.08
    // degrees.
    let mut errors = Vec::new();
    for k in 0..=45 {
        let slope = f64::from(k).to_radians();
        let (n, offset) = (Vector2::new(slope.sin(), -slope.cos()), 30.3 * slope.sin() - 30.2 * slope.cos());
        let coverage = |i: u32, j: u32| half_plane_coverage(f64::from(i), f64::from(j), &n, offset);
        let mask = GrayImage::from_fn(60, 60, |i, j| image::Luma([(255.0 * coverage(i, j)).round() as u8]));

        let s = Silhouette::new(&mask, Border::Unknown);
        let inner = s.edge_pixels().filter(|&(i, j)| (14..46).contains(&i) && (14..46).contains(&j));
        errors.extend(inner.map(|(i, j)| s.edge(i, j).unwrap().normal.angle(&n).to_degrees()));
    }

    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let worst = errors.into_iter().fold(0.0, f64::max);
    assert!(mean < 0.03 && worst < 0.15, "mean {mean}, worst {worst} degrees");
}

/// The fraction of pixel `(x, y)` in which `n . p < offset`, for `n` within 45 degrees of up. It is the mean over 64
/// vertical lines, on which it is exact.
fn half_plane_coverage(x: f64, y: f64, n: &Vector2<f64>, offset: f64) -> f64 {
    let below = |k: i32| {
        let u = x + (f64::from(k) + 0.5) / 64.0;
        let edge = (offset - n.x * u) / n.y;
        (y + 1.0 - edge).clamp(0.0, 1.0)
    };
    (0..64).map(below).sum::<f64>() / 64.0
}

#[test]
fn edge_points_lie_on_a_straight_edge() {
    let normal = Vector2::new(0.6, -0.8);
    let offset = |u: f64, v: f64| (u - 30.3) * normal.x + (v - 30.2) * normal.y;
    let s = Silhouette::new(&covered(60, 60, |u, v| offset(u, v) < 0.0), Border::Unknown);
    for (i, j) in s.edge_pixels().filter(|&(i, j)| (12..48).contains(&i) && (12..48).contains(&j)) {
        let point = s.edge(i, j).unwrap().point;
        // Bilinear interpolation of area coverage is accurate to a tenth of a pixel.
        assert!(offset(point.x, point.y).abs() < 0.1);
    }
}

#[test]
fn paper_normals_have_the_bias_of_their_square_window() {
    // The slope of the edge and the mean bias of a 5x5 window, in degrees.
    for (slope, bias) in [(0.0_f64, 0.0), (20.0, 5.8), (30.0, 6.6), (45.0, 0.0)] {
        let normal = Vector2::new(slope.to_radians().sin(), -slope.to_radians().cos());
        let s = Silhouette::new(
            &drawn(200, 200, |u, v| (u - 100.3) * normal.x + (v - 100.2) * normal.y < 0.0),
            Border::Unknown,
        );

        let inner = s.edge_pixels().filter(|&(i, j)| (20..180).contains(&i) && (20..180).contains(&j));
        let errors: Vec<f64> =
            inner.map(|(i, j)| s.paper_normal(i, j).unwrap().angle(&normal).to_degrees()).collect();
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        assert!(mean >= bias - 2.5 && mean <= bias + 4.0, "slope {slope}: {mean} degrees");
    }
}
