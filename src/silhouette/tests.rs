use super::*;
use nalgebra::Vector2;

mod tables;

/// Numbers that look random, the same in each run.
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub(super) fn below(&mut self, end: u32) -> u32 {
        (self.unit() * f64::from(end)) as u32
    }
}

/// A mask whose subject is where `inside` holds at the pixel's centre.
fn drawn(width: u32, height: u32, inside: impl Fn(f64, f64) -> bool) -> GrayImage {
    GrayImage::from_fn(width, height, |i, j| {
        image::Luma([if inside(f64::from(i) + 0.5, f64::from(j) + 0.5) { 255 } else { 0 }])
    })
}

/// The same with area coverage from 16x16 samples a pixel.
fn covered(width: u32, height: u32, inside: impl Fn(f64, f64) -> bool) -> GrayImage {
    GrayImage::from_fn(width, height, |i, j| {
        let at = |k: u32| (f64::from(k % 16) + 0.5) / 16.0;
        let hits = (0..256).filter(|&k| inside(f64::from(i) + at(k), f64::from(j) + at(k / 16))).count();
        image::Luma([(hits as f64 / 256.0 * 255.0).round() as u8])
    })
}

/// A ring with a bite out of it: curved, concave, touching the image's right border.
fn blob(u: f64, v: f64) -> bool {
    let r = (u - 40.0).hypot(v - 25.0);
    (r < 22.0 && r > 6.0 && u + v > 40.0) || (u > 50.0 && (v - 30.0).abs() < 4.0)
}

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
fn nearest_background_is_the_euclidean_then_row_major_first() {
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
fn rect_is_the_tightest() {
    let s = Silhouette::new(
        &drawn(70, 50, |u, v| u > 10.0 && u < 20.0 && v > 30.0 && v < 33.0),
        Border::Background,
    );
    assert_eq!(s.rect(), Rect { x0: 10, y0: 30, x1: 20, y1: 33 });
    assert!(Silhouette::new(&GrayImage::new(8, 8), Border::Background).rect().is_empty());
}

#[test]
fn distances_beyond_a_byte_are_exact() {
    // Deep, and wider than a byte from one side only where the border is open.
    let mask = drawn(700, 620, |u, v| (u - 330.0).abs() < 300.0 && (v - 310.0).abs() < 290.0);
    for border in [Border::Background, Border::Unknown] {
        let s = Silhouette::new(&mask, border);
        assert_eq!((s.distance(330, 310), s.distance(31, 310), s.distance(330, 20)), (290, 2, 1));
        assert_eq!(s.distance(330, 310 - 40), 251);
        assert_eq!(s.distance(330, 310 - 30), 261);
    }
    let half = Silhouette::new(&drawn(900, 40, |u, _| u < 800.0), Border::Unknown);
    assert_eq!([800, 799, 500, 0].map(|i| half.distance(i, 20)), [0, 1, 300, 800]);
}

#[test]
fn tiles_never_miss_a_subject_pixel_and_know_empty_ones() {
    let s = Silhouette::new(&drawn(200, 150, |u, v| blob(u - 90.0, v - 60.0)), Border::Background);
    let (region, tiles) = (s.crop.rect(), s.tables().occupancy.lookup());
    let may_touch = |rect: &Rect| {
        // As the queries ask: what lies beyond the region is brought to its rim.
        let column = |i: i32| (i - region.x0).clamp(0, region.width() as i32) as u32;
        let row = |j: i32| (j - region.y0).clamp(0, region.height() as i32) as u32;
        tiles.any_occupied([column(rect.x0), row(rect.y0)], [column(rect.x1), row(rect.y1)])
    };
    let mut empty = 0;
    for k in 0..2000 {
        let (x0, y0) = (k * 37 % 190, k * 53 % 140);
        let rect = Rect { x0, y0, x1: x0 + 1 + k % 19, y1: y0 + 1 + k % 23 };
        let any = |rect: &Rect| (rect.y0..rect.y1).any(|j| (rect.x0..rect.x1).any(|i| s.is_subject(i, j)));
        assert!(may_touch(&rect) || !any(&rect), "{rect:?}");
        // A tile is 8 pixels wide: with seven more on each side every tile asked is in sight.
        assert!(!may_touch(&rect) || any(&rect.grown(7)), "{rect:?}");
        empty += i32::from(!may_touch(&rect));
    }
    assert!(empty > 500);
}

#[test]
fn a_silhouette_made_in_the_memory_of_another_is_the_same() {
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

    // Any of the queries may be the first one.
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

    // A silhouette of no image has no tables to take, and answers too.
    let mut blank = Silhouette::blank(Border::Background);
    assert!(blank.take_tables().is_none());
    assert_eq!((blank.distance(3, 4), blank.edge(3, 4)), (0, None));
}

#[test]
fn an_edge_is_the_same_when_asked_again() {
    let s = Silhouette::new(&covered(70, 50, blob), Border::Background);
    let once: Vec<_> = s.edge_pixels().map(|(i, j)| s.edge(i, j)).collect();
    assert!(once.len() > 100 && s.edge_pixels().map(|(i, j)| s.edge(i, j)).eq(once.iter().copied()));
    assert!(s.edge_pixels().map(|(i, j)| contact_edge::at(&s, (i, j))).eq(once));
}

/// The mean vector to the background around `(i, j)`, weighted, pixel by pixel.
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
fn contact_normals_are_the_weighted_mean_to_the_bit_however_many_are_asked() {
    for (mask, border) in [
        (drawn(70, 50, blob), Border::Background),
        (drawn(70, 50, blob), Border::Unknown),
        (covered(70, 50, blob), Border::Background),
        (drawn(9, 7, |u, _| u > 4.0), Border::Background),
    ] {
        let (one_by_one, together) = (Silhouette::new(&mask, border), Silhouette::new(&mask, border));
        let asked: Vec<_> = together.edge_pixels().map(|at| together.edge_pixel(at)).collect();
        compute_edges(&together, &asked);
        assert!(!asked.is_empty());
        for pixel in &asked {
            let (i, j) = pixel.at;
            assert!(!together.claim_edge(pixel) && one_by_one.claim_edge(&one_by_one.edge_pixel((i, j))));
            let normal = weighted_mean(&one_by_one, i, j).try_normalize(0.3);
            assert_eq!(one_by_one.edge(i, j).map(|edge| edge.normal), normal, "{border:?} ({i}, {j})");
            assert_eq!(one_by_one.edge(i, j), together.edge(i, j));
        }
    }
}

#[test]
fn a_full_open_image_has_no_edge_and_a_full_closed_one_has_its_border() {
    let full = drawn(9, 9, |_, _| true);
    assert_eq!(Silhouette::new(&full, Border::Unknown).distance(4, 4), u16::MAX);
    assert_eq!(Silhouette::new(&full, Border::Background).distance(4, 4), 5);
}

#[test]
fn contact_normals_of_a_straight_edge_are_right_at_every_slope() {
    for degrees in [0.0_f64, 10.0, 20.0, 30.0, 40.0, 45.0, 77.0] {
        let normal = Vector2::new(degrees.to_radians().sin(), -degrees.to_radians().cos());
        let inside = |u: f64, v: f64| (u - 30.3) * normal.x + (v - 30.2) * normal.y < 0.0;
        // Binary: half a pixel of stair over the 6 px that the window sees, atan(0.5 / 6). Coverage has no stairs.
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
fn coverage_normals_of_a_straight_edge_are_right_to_a_tenth_of_a_degree_on_average() {
    // A table's top seen from its height, by cameras rolled by all these angles: a sphere at rest on it rolls away
    // where the normals tilt. With weights cut off at a square window the mean error is 0.08 degrees.
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

/// How much of pixel `(x, y)` lies where `n . p < offset`, `n` within 45 degrees of up: exact in its columns, of
/// which there are 64.
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
        // Bilinear interpolation of area coverage: within a tenth of a pixel.
        assert!(offset(point.x, point.y).abs() < 0.1);
    }
}

#[test]
fn paper_normals_have_the_bias_of_their_square_window() {
    // Edge slope and the bias of a 5x5 window, in degrees, on the staircase's average.
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
