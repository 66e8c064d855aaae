use super::*;
use image::{GrayImage, Luma};
use ode_visual_hull_random::Random;

/// A mask whose subject pixels are those for which `is_subject` holds.
fn drawn(width: u32, height: u32, is_subject: impl Fn(i32, i32) -> bool) -> GrayImage {
    GrayImage::from_fn(width, height, |i, j| Luma([if is_subject(i as i32, j as i32) { 255 } else { 0 }]))
}

/// A mask in which about `percent` percent of the pixels, chosen at random, are subject.
fn scattered(width: u32, height: u32, percent: u32, seed: u64) -> GrayImage {
    let mut random = Random(seed);
    GrayImage::from_fn(width, height, |_, _| Luma([if random.below(100) < percent { 255 } else { 0 }]))
}

fn disc(radius: f64) -> impl Fn(i32, i32) -> bool {
    move |i, j| (f64::from(i) + 0.5 - 60.2).hypot(f64::from(j) + 0.5 - 49.7) < radius
}

fn pixels(rect: &Rect) -> impl Iterator<Item = (i32, i32)> + use<> {
    let rect = *rect;
    (rect.y0..rect.y1).flat_map(move |j| (rect.x0..rect.x1).map(move |i| (i, j)))
}

/// Compares every distance with the least of the distances to all pixels of the other kind in and around the image.
fn assert_brute_force(distance: &SignedDistance, s: &Silhouette, what: &str) {
    // One row and column of background around the image suffice: pixels farther out are not nearer.
    let known = if s.border() == Border::Unknown { s.image() } else { s.image().grown(1) };
    let (subject, background): (Vec<_>, Vec<_>) = pixels(&known).partition(|&(x, y)| s.is_subject(x, y));
    for (i, j) in pixels(&distance.rect()) {
        let is_subject = s.is_subject(i, j);
        let others = if is_subject { &background } else { &subject };
        let nearest = others.iter().map(|&(x, y)| (x - i).pow(2) + (y - j).pow(2)).min();
        let length = nearest.map_or(f32::INFINITY, |squared| (squared as f32).sqrt() - 0.5);
        let expected = if is_subject { -length } else { length };
        assert_eq!(distance.at(i, j), expected, "{what}, {:?}, pixel ({i}, {j})", s.border());
    }
}

/// The rectangle of an image, and rectangles around, in, across and beside it.
fn rectangles(width: i32, height: i32) -> [Rect; 5] {
    let rect = |x0, y0, x1, y1| Rect { x0, y0, x1, y1 };
    [
        rect(0, 0, width, height),
        rect(-5, -3, width + 7, height + 4),
        rect(width / 3, height / 4, width / 2 + 1, height / 2 + 1),
        rect(width / 2, -9, width + 2, height / 2),
        rect(width + 3, height + 1, width + 8, height + 9),
    ]
}

#[test]
fn distances_are_those_of_the_nearest_pixel_of_the_other_kind() {
    for (seed, (width, height)) in (1..).zip([(1, 1), (1, 37), (53, 1), (33, 17), (65, 31)]) {
        for percent in [1, 10, 50, 90, 99] {
            let mask = scattered(width, height, percent, seed);
            for border in [Border::Background, Border::Unknown] {
                let s = Silhouette::new(&mask, border);
                let what = format!("{percent} % of {width}x{height}");
                for rect in rectangles(width as i32, height as i32) {
                    assert_brute_force(&s.signed_distance(&rect), &s, &what);
                }
            }
        }
    }
}

#[test]
fn distances_from_a_disc_equal_distances_from_its_circle_within_a_pixels_diagonal() {
    let s = Silhouette::new(&drawn(120, 100, disc(30.0)), Border::Background);
    let distance = s.signed_distance(&s.image());
    for (i, j) in pixels(&s.image()) {
        let analytic = (f64::from(i) + 0.5 - 60.2).hypot(f64::from(j) + 0.5 - 49.7) - 30.0;
        // The nearest centre of the other kind lies beyond the circle by at most a diagonal: a disc with a radius of
        // half a diagonal that touches the circle there from the other side always holds a centre. The distance is half
        // a pixel less.
        let excess = (f64::from(distance.at(i, j)) - analytic) * analytic.signum();
        assert!((-0.5 - 1e-5..=std::f64::consts::SQRT_2 - 0.5).contains(&excess), "({i}, {j}): {excess}");
    }
}

#[test]
fn distances_are_negative_for_subject_and_positive_for_background() {
    for border in [Border::Background, Border::Unknown] {
        let s = Silhouette::new(&scattered(61, 45, 60, 7), border);
        let distance = s.signed_distance(&s.image().grown(4));
        for (i, j) in pixels(&distance.rect()) {
            assert!(distance.at(i, j).abs() >= 0.5);
            assert_eq!(distance.at(i, j) < 0.0, s.is_subject(i, j), "{border:?} ({i}, {j})");
        }
    }
}

#[test]
fn distances_of_adjacent_pixels_differ_by_at_most_one() {
    for mask in [drawn(120, 100, disc(30.0)), scattered(120, 100, 3, 5)] {
        let s = Silhouette::new(&mask, Border::Background);
        let distance = s.signed_distance(&s.image());
        for (i, j) in pixels(&s.image()) {
            let here = distance.at(i, j);
            for next in [distance.at(i + 1, j), distance.at(i, j + 1)] {
                // Both distances are below 256, so that each is rounded by at most 2^-24 of 128.
                assert!((next - here).abs() <= 1.0 + 2e-5, "({i}, {j}): {here} and {next}");
            }
        }
    }
}

#[test]
fn distances_move_with_the_mask() {
    let (right, down) = (13, 7);
    let [here, there] = [(0, 0), (right, down)].map(|(x, y)| {
        let mask = drawn(160, 130, |i, j| disc(21.0)(i - x, j - y) || disc(4.0)(i - x - 30, j - y));
        Silhouette::new(&mask, Border::Background)
    });
    let rect = here.rect().grown(20);
    let moved = Rect { x0: rect.x0 + right, y0: rect.y0 + down, x1: rect.x1 + right, y1: rect.y1 + down };
    assert_eq!(here.signed_distance(&rect).values(), there.signed_distance(&moved).values());
}

#[test]
fn reused_memory_gives_equal_distances() {
    let mut distance = SignedDistance::default();
    for (width, height, percent) in [(70, 60, 50), (30, 90, 2), (90, 20, 98), (5, 4, 0), (70, 60, 100)] {
        for border in [Border::Unknown, Border::Background] {
            let s = Silhouette::new(&scattered(width, height, percent, width.into()), border);
            let rect = s.image().grown(3);
            distance.refill(&s, &rect);
            assert_eq!(distance.rect(), rect);
            assert_eq!(distance.values(), s.signed_distance(&rect).values(), "{width}x{height}, {border:?}");
        }
    }
}

#[test]
fn distances_are_infinite_in_a_silhouette_without_an_edge() {
    let all = |distance: &SignedDistance, value: f32| distance.values().iter().all(|&v| v == value);
    let (empty, full) = (GrayImage::new(9, 7), drawn(9, 7, |_, _| true));

    for border in [Border::Background, Border::Unknown] {
        let s = Silhouette::new(&empty, border);
        assert!(all(&s.signed_distance(&s.image()), f32::INFINITY), "{border:?}");
    }

    let s = Silhouette::new(&full, Border::Unknown);
    let distance = s.signed_distance(&s.image().grown(2));
    assert!(all(&distance, f32::NEG_INFINITY));
    assert_eq!(distance.sample(4.25, 3.0), f64::NEG_INFINITY);

    // With background beyond the image, the edge of a full mask is the image's border.
    let s = Silhouette::new(&full, Border::Background);
    assert_eq!(s.signed_distance(&s.image()).at(0, 3), -0.5);
    assert_eq!(s.signed_distance(&s.image()).at(4, 3), -3.5);
}

#[test]
fn an_unknown_border_is_not_an_edge() {
    // An arm from the left border to the middle.
    let mask = drawn(40, 30, |i, j| i < 20 && (10..16).contains(&j));
    let [unknown, background] = [Border::Unknown, Border::Background].map(|border| {
        let s = Silhouette::new(&mask, border);
        s.signed_distance(&s.image())
    });
    assert_eq!((unknown.at(0, 12), background.at(0, 12)), (-2.5, -0.5), "inside, at the border");
    assert_eq!((unknown.at(0, 4), background.at(0, 4)), (5.5, 5.5), "outside, at the border");
    assert_eq!((unknown.at(20, 12), background.at(20, 12)), (0.5, 0.5));
}

#[test]
fn distances_depend_only_on_which_pixels_are_subject() {
    let bytes = [0, 60, 127, 128, 200, 255];
    let mask = GrayImage::from_fn(48, 32, |i, j| Luma([bytes[((i * i + 3 * j) / 7 % 6) as usize]]));
    let binary = drawn(48, 32, |i, j| mask.get_pixel(i as u32, j as u32).0[0] >= crate::silhouette::SUBJECT);
    let [covered, binary] = [&mask, &binary].map(|mask| {
        let s = Silhouette::new(mask, Border::Unknown);
        s.signed_distance(&s.image())
    });
    assert_eq!(covered.values(), binary.values());
}

#[test]
fn samples_are_bilinear_between_centres_and_clamped_outside() {
    let s = Silhouette::new(&drawn(24, 20, |i, j| i < 10 && j < 12), Border::Unknown);
    let distance = s.signed_distance(&s.image());
    assert_eq!(distance.sample(3.5, 4.5), f64::from(distance.at(3, 4)));
    let mean = (distance.at(14, 15) + distance.at(15, 15) + distance.at(14, 16) + distance.at(15, 16)) / 4.0;
    // The mean of four values is rounded in single precision.
    assert!((distance.sample(15.0, 16.0) - f64::from(mean)).abs() < 1e-5);
    assert_eq!(distance.sample(-9.0, 50.0), f64::from(distance.at(0, 19)));
    assert_eq!(distance.sample(0.2, 5.5), f64::from(distance.at(0, 5)));
}

#[test]
fn an_empty_rectangle_has_no_distances() {
    let s = Silhouette::new(&drawn(12, 12, |i, _| i < 5), Border::Background);
    let distance = s.signed_distance(&Rect { x0: 4, y0: 4, x1: 2, y1: 9 });
    assert!(distance.values().is_empty() && distance.rect().is_empty());
    assert_eq!((distance.at(4, 4), distance.sample(4.0, 4.0)), (f32::INFINITY, f64::INFINITY));
}

#[test]
fn distances_near_the_edge_are_the_same_up_to_the_longest() {
    let masks = [
        scattered(65, 31, 1, 5),
        scattered(33, 17, 50, 6),
        scattered(90, 70, 99, 7),
        drawn(120, 100, disc(44.0)),
    ];
    let empty = drawn(20, 20, |_, _| false);
    for mask in masks.into_iter().chain([empty]) {
        let (width, height) = (mask.width() as i32, mask.height() as i32);
        for border in [Border::Background, Border::Unknown] {
            let s = Silhouette::new(&mask, border);
            for rect in rectangles(width, height) {
                let (all, near) = (s.signed_distance(&rect), s.signed_distance_near_edge(&rect));
                let most = SignedDistance::NEAR;
                for (i, j) in pixels(&rect) {
                    let expected = all.at(i, j).clamp(-most, most);
                    assert_eq!(
                        near.at(i, j),
                        expected,
                        "{width} x {height}, {border:?}, {rect:?}, pixel ({i}, {j})"
                    );
                }
            }
        }
    }
}
