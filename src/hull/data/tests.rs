use super::super::tests::{Random, bounds, cameras};
use super::super::{EdgeModel, Push};
use super::*;
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
    push: Option<Push>,
    /// Metres upwards, for a point inside.
    exit: Option<f64>,
}

fn answers(hull: &Hull, points: &[Point3<f64>]) -> Vec<Answer> {
    let answer = |p: &Point3<f64>| {
        let inside = hull.inside(p);
        Answer {
            inside,
            response: hull.respond(p).map(|response| response.w()),
            push: hull.push(p),
            exit: inside.then(|| hull.exit(p, &Vector3::z(), EdgeModel::Pixel)),
        }
    };
    points.iter().map(answer).collect()
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

        // The others are found in the history, every fourth frame.
        if frame >= 11 && frame % 4 == 3 {
            let history = data.history();
            assert_eq!(history.len(), 5);
            for (past, hull) in history.iter().rev().enumerate() {
                assert_eq!(answers(hull, &points), when_new[frame as usize - past], "{frame} - {past}");
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
    let history = data.history();
    let [.., past, latest] = &history[..] else { panic!("expected two frames") };
    let before = working_memory(past);
    assert!(2 * before < working_memory(latest), "{before} of {}", working_memory(latest));
    answers(past, &points);
    assert!(working_memory(past) > 2 * before);
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
        let history = data.history();
        let [.., past, latest] = &history[..] else { panic!("expected two frames") };
        assert!(2 * working_memory(past) < working_memory(latest), "the tables have been taken out");

        // Both start together, so that either may be the one that derives the tables.
        let start = Barrier::new(2);
        let ask = || {
            start.wait();
            answers(past, &points)
        };
        let [one, other] = std::thread::scope(|scope| {
            [scope.spawn(ask), scope.spawn(ask)].map(|thread| thread.join().unwrap())
        });
        assert_eq!(one, when_new);
        assert_eq!(other, one);
    }
}
