use super::*;
use crate::hull::tests::{Random, bounds, cameras};
use crate::hull::{EdgeModel, ExitVector};
use image::{GrayImage, Luma};
use nalgebra::{Point3, Vector3};
use std::sync::Barrier;

/// Frames whose answers are compared.
const FRAMES: u32 = 24;

fn data() -> HullData {
    let data = HullData::new();
    data.add_views(&cameras()).unwrap();
    data.set_bounds(bounds()).unwrap();
    data
}

fn points() -> Vec<Point3<f64>> {
    let mut random = Random(17);
    (0..300).map(|_| random.point(&bounds())).collect()
}

/// A disc that moves from frame to frame, with coverage in every second view; the last view gets a new mask in every
/// third frame only.
fn show(data: &HullData, frame: u32) -> Arc<Hull> {
    let views = data.view_count();
    for view in (0..views).filter(|view| view + 1 < views || frame.is_multiple_of(3)) {
        let steepness = if view % 2 == 0 { 100.0 } else { 1e6 };
        let mask = GrayImage::from_fn(160, 120, |i, j| {
            let (x, y) = (f64::from(i) - 60.0 - 2.0 * f64::from(frame), f64::from(j) - 60.0);
            let inwards = 30.2 + f64::from(frame) - x.hypot(y);
            Luma([(127.5 + steepness * inwards).clamp(0.0, 255.0) as u8])
        });
        data.set_mask(view, &mask).unwrap();
    }
    data.update(0.03 * f64::from(frame)).unwrap()
}

/// What a frame says of a point.
#[derive(Debug, PartialEq)]
struct Answer {
    inside: bool,
    response: Option<Vector3<f64>>,
    push: Option<ExitVector>,
    /// Metres upwards, for a point inside.
    exit: Option<f64>,
}

fn answers(hull: &Hull, points: &[Point3<f64>]) -> Vec<Answer> {
    let answer = |p: &Point3<f64>| {
        let inside = hull.inside(p);
        Answer {
            inside,
            response: hull.respond(p).map(|response| response.w()),
            push: hull.exit_vector(p),
            exit: inside.then(|| hull.exit(p, &Vector3::z(), EdgeModel::Pixel)),
        }
    };
    points.iter().map(answer).collect()
}

/// The last frame but one and the last.
fn last_two(data: &HullData) -> [Arc<Hull>; 2] {
    let (_, latest) = data.latest().unwrap();
    // A little later than 0.03 s before, which may be rounded down.
    [data.at(latest.time() - 0.029).unwrap(), latest]
}

/// Bytes that the silhouettes of a frame work in.
fn working_memory(hull: &Hull) -> usize {
    hull.views().iter().map(|view| view.silhouette().working_memory()).sum()
}

#[test]
fn past_frames_answer_as_when_they_were_new_while_newer_masks_recycle_their_memory() {
    let (data, points) = (data(), points());
    let (mut when_new, mut held) = (Vec::new(), Vec::new());
    for frame in 0..FRAMES {
        let hull = show(&data, frame);
        when_new.push(answers(&hull, &points));

        // Some frames are held by their `Arc` for the whole time.
        if frame % 5 == 2 {
            held.push((frame as usize, hull));
        }
        assert!(held.iter().all(|(frame, hull)| answers(hull, &points) == when_new[*frame]));

        // The others are found by their times: the masks of a tenth of a second and one more are kept.
        if frame >= 11 && frame % 4 == 3 {
            for past in (0..5).map(|back| frame - back) {
                let hull = data.at(0.03 * f64::from(past)).unwrap();
                assert_eq!(answers(&hull, &points), when_new[past as usize], "{past} at {frame}");
            }
        }
    }
    assert!(when_new.windows(2).all(|two| two[0] != two[1]));
    assert!(when_new.iter().all(|answers| answers.iter().any(|answer| answer.response.is_some())));
}

#[test]
fn a_past_frame_keeps_no_tables_until_it_is_asked() {
    let (data, points) = (data(), points());
    for frame in 0..FRAMES {
        show(&data, frame);
    }
    let [past, latest] = last_two(&data);
    let before = working_memory(&past);
    assert!(2 * before < working_memory(&latest), "{before} of {}", working_memory(&latest));
    answers(&past, &points);
    assert!(working_memory(&past) > 2 * before);
}

#[test]
fn threads_that_ask_a_past_frame_at_the_same_time_agree() {
    let (data, points) = (data(), points());
    let mut before = Vec::new();
    for frame in 0..FRAMES {
        let when_new = std::mem::replace(&mut before, answers(&show(&data, frame), &points));
        if frame % 4 != 3 {
            continue;
        }
        let [past, latest] = last_two(&data);
        assert!(2 * working_memory(&past) < working_memory(&latest), "the tables have been taken out");

        // Both start together, so that either may be the one that derives the tables.
        let start = Barrier::new(2);
        let ask = || {
            start.wait();
            answers(&past, &points)
        };
        let [one, other] = std::thread::scope(|scope| {
            [scope.spawn(ask), scope.spawn(ask)].map(|thread| thread.join().unwrap())
        });
        assert_eq!(one, when_new);
        assert_eq!(other, one);
    }
}

/// A disc of this radius in each mask; the bytes of the views' silhouettes tell them apart.
fn disc(radius: f64) -> GrayImage {
    GrayImage::from_fn(160, 120, |i, j| {
        let inside = (f64::from(i) - 80.0).hypot(f64::from(j) - 60.0) < radius;
        Luma([if inside { 255 } else { 0 }])
    })
}

#[test]
fn each_view_shows_its_latest_mask_that_was_not_taken_after_the_time_asked() {
    let data = data();
    let views = data.view_count();
    // The cameras run at 50 Hz, each a millisecond after the one before.
    let taken = |view: usize, k: usize| 0.02 * k as f64 + 0.001 * view as f64;
    for k in 0..12 {
        for view in 0..views {
            data.set_mask_at(view, &disc(5.0 + k as f64), taken(view, k)).unwrap();
        }
        data.update(taken(views, k)).unwrap();
    }
    for time in [0.219, 0.2, 0.1905, 0.15, 0.125] {
        let hull = data.at(time).unwrap();
        for (view, seen) in hull.views().iter().enumerate() {
            let k = (0..12).rev().find(|&k| taken(view, k) <= time).unwrap();
            assert_eq!(seen.time(), Some(taken(view, k)), "{view} at {time}");
            let expected =
                crate::silhouette::Silhouette::new(&disc(5.0 + k as f64), seen.silhouette().border());
            assert_eq!(seen.silhouette().rect(), expected.rect());
        }
    }

    // A tenth of a second and one more are kept; before them the earliest one stands.
    let earliest = data.at(-1.0).unwrap();
    let times = earliest.views().iter().enumerate().map(|(view, seen)| seen.time().unwrap() - taken(view, 0));
    assert!(times.into_iter().all(|time| (time - 0.1).abs() < 1e-12), "six of twelve");
}

#[test]
fn a_mask_without_a_time_counts_as_taken_when_its_frame_was() {
    let data = data();
    for view in 0..data.view_count() {
        data.set_mask(view, &disc(20.0)).unwrap();
        data.set_mask(view, &disc(30.0)).unwrap();
    }
    let first = data.update(3.0).unwrap();
    assert!(first.views().iter().all(|view| view.time() == Some(3.0)));
    data.set_mask_at(1, &disc(25.0), 3.5).unwrap();
    let second = data.update(4.0).unwrap();
    let times: Vec<_> = second.views().iter().map(|view| view.time().unwrap()).collect();
    assert_eq!((times[0], times[1], times[2]), (3.0, 3.5, 3.0));
}

#[test]
fn a_packed_mask_gives_the_silhouette_that_its_bytes_give() {
    let (bytes, packed) = (data(), data());
    for view in 0..bytes.view_count() {
        let mut mask = disc(20.0 + view as f64);
        mask.put_pixel(100, 60, Luma([77]));
        bytes.set_mask(view, &mask).unwrap();
        packed.set_packed(view, &PackedMask::new(&mask)).unwrap();
    }
    let (bytes, packed) = (bytes.update(0.0).unwrap(), packed.update(0.0).unwrap());
    let points = points();
    assert_eq!(answers(&bytes, &points), answers(&packed, &points));
}

#[test]
fn a_mask_whose_time_is_none_or_lies_before_the_last_ones_is_refused_and_the_last_one_stays() {
    let data = data();
    for view in 0..data.view_count() {
        data.set_mask_at(view, &disc(20.0), 1.0).unwrap();
    }
    let says = |time| data.set_mask_at(2, &disc(40.0), time).unwrap_err().to_string();
    let name = data.camera(2).unwrap().name().to_owned();
    for time in [f64::NAN, f64::INFINITY] {
        let message = says(time);
        assert!(message.contains(&name) && message.contains("a finite time in seconds"), "{message}");
    }
    let message = says(0.999);
    assert!(message.contains(&name) && message.contains("last mask's, 1 s, found 0.999 s"), "{message}");
    assert!(data.set_packed_at(2, &PackedMask::new(&disc(40.0)), 0.5).is_err());
    let hull = data.update(2.0).unwrap();
    assert_eq!(hull.views()[2].silhouette().rect(), hull.views()[1].silhouette().rect());

    // Of two masks of one time the later one stands.
    data.set_mask_at(2, &disc(40.0), 1.0).unwrap();
    let hull = data.update(2.0).unwrap();
    assert!(hull.views()[2].silhouette().rect().width() > hull.views()[1].silhouette().rect().width());
    assert!(data.at(f64::NAN).is_err());
}
