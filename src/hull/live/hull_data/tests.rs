//! Frames, masks and times of [`HullData`], on discs that move and grow.

use super::*;
use crate::hull::Motion;
use crate::hull::tests::{bounds, cameras, point_in};
use crate::hull::{EdgeModel, EmptyReason, ExitVector};
use image::{GrayImage, Luma};
use nalgebra::{Point3, Vector3};
use ode_visual_hull_random::Random;
use std::sync::Barrier;

/// Number of frames whose query results are compared.
const FRAMES: u32 = 24;

fn data() -> HullData {
    let data = HullData::new();
    data.add_views(&cameras()).unwrap();
    data.set_bounds(bounds()).unwrap();
    data
}

fn points() -> Vec<Point3<f64>> {
    let mut random = Random(17);
    (0..300).map(|_| point_in(&mut random, &bounds())).collect()
}

/// Sets masks of a disc that moves from frame to frame, with coverage in every second view, and publishes the frame.
/// The last view gets a new mask in every third frame only.
fn publish(data: &HullData, frame: u32) -> Arc<Hull> {
    publish_at(data, frame, 0.03 * f64::from(frame))
}

/// [`publish`] at a time in seconds.
fn publish_at(data: &HullData, frame: u32, time: f64) -> Arc<Hull> {
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
    data.update(time).unwrap()
}

/// The results of all queries of one point.
#[derive(Debug, PartialEq)]
struct PointQueries {
    inside: bool,
    response: Option<Vector3<f64>>,
    exit_vector: Option<ExitVector>,
    /// Metres upwards, for a point inside.
    exit: Option<f64>,
}

fn query(hull: &Hull, points: &[Point3<f64>]) -> Vec<PointQueries> {
    let query_point = |p: &Point3<f64>| {
        let inside = hull.inside(p);
        PointQueries {
            inside,
            response: hull.respond(p).map(|response| response.w()),
            exit_vector: hull.exit_vector(p),
            exit: inside.then(|| hull.exit(p, &Vector3::z(), EdgeModel::Pixel)),
        }
    };
    points.iter().map(query_point).collect()
}

/// The last frame but one and the last.
fn last_two(data: &HullData) -> [Arc<Hull>; 2] {
    let (_, latest) = data.latest().unwrap();
    // Frames are 0.03 s apart. A time of a millisecond more leaves room for rounding.
    [data.at(latest.time() - 0.029).unwrap(), latest]
}

/// Bytes of memory that the silhouettes of a frame hold.
fn working_memory(hull: &Hull) -> usize {
    hull.views().iter().map(|view| view.silhouette().working_memory()).sum()
}

#[test]
fn queries_of_past_frames_do_not_change_while_newer_masks_recycle_memory() {
    let (data, points) = (data(), points());
    let (mut when_new, mut held) = (Vec::new(), Vec::new());
    for frame in 0..FRAMES {
        let hull = publish(&data, frame);
        when_new.push(query(&hull, &points));

        // Every fifth frame is held by its `Arc` to the end.
        if frame % 5 == 2 {
            held.push((frame as usize, hull));
        }
        assert!(held.iter().all(|(frame, hull)| query(hull, &points) == when_new[*frame]));

        // All recent frames are found by their times: the masks of a tenth of a second and one more are kept.
        if frame >= 11 && frame % 4 == 3 {
            for past in (0..5).map(|back| frame - back) {
                let hull = data.at(0.03 * f64::from(past)).unwrap();
                assert_eq!(query(&hull, &points), when_new[past as usize], "{past} at {frame}");
            }
        }
    }

    // The frames differ from one another, and each has points inside.
    assert!(when_new.windows(2).all(|two| two[0] != two[1]));
    assert!(when_new.iter().all(|frame| frame.iter().any(|point| point.response.is_some())));
}

#[test]
fn a_past_frame_holds_no_tables_until_it_is_queried() {
    let (data, points) = (data(), points());
    for frame in 0..FRAMES {
        publish(&data, frame);
    }
    let [past, latest] = last_two(&data);
    let before = working_memory(&past);
    assert!(2 * before < working_memory(&latest), "{before} of {}", working_memory(&latest));
    query(&past, &points);
    assert!(working_memory(&past) > 2 * before);
}

#[test]
fn threads_that_query_a_past_frame_at_the_same_time_agree() {
    let (data, points) = (data(), points());
    let mut before = Vec::new();

    for frame in 0..FRAMES {
        let when_new = std::mem::replace(&mut before, query(&publish(&data, frame), &points));
        if frame % 4 != 3 {
            continue;
        }

        let [past, latest] = last_two(&data);
        assert!(2 * working_memory(&past) < working_memory(&latest), "the tables have been taken out");

        // Both start together, so that either may be the one that computes the tables.
        let start = Barrier::new(2);
        let wait_and_query = || {
            start.wait();
            query(&past, &points)
        };
        let [one, other] = std::thread::scope(|scope| {
            [scope.spawn(wait_and_query), scope.spawn(wait_and_query)].map(|thread| thread.join().unwrap())
        });
        assert_eq!(one, when_new);
        assert_eq!(other, one);
    }
}

/// The mask of a disc with a radius in pixels. Discs of different radii have different rectangles.
fn disc(radius: f64) -> GrayImage {
    GrayImage::from_fn(160, 120, |i, j| {
        let inside = (f64::from(i) - 80.0).hypot(f64::from(j) - 60.0) < radius;
        Luma([if inside { 255 } else { 0 }])
    })
}

#[test]
fn each_view_shows_its_latest_mask_not_taken_after_the_requested_time() {
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
        for (index, view) in hull.views().iter().enumerate() {
            let k = (0..12).rev().find(|&k| taken(index, k) <= time).unwrap();
            assert_eq!(view.time(), Some(taken(index, k)), "{index} at {time}");
            let expected =
                crate::silhouette::Silhouette::new(&disc(5.0 + k as f64), view.silhouette().border());
            assert_eq!(view.silhouette().rect(), expected.rect());
        }
    }

    // The masks of a tenth of a second and one more are kept. For earlier times the earliest of them is shown.
    let earliest = data.at(-1.0).unwrap();
    let ages = earliest.views().iter().enumerate().map(|(k, view)| view.time().unwrap() - taken(k, 0));
    assert!(ages.into_iter().all(|age| (age - 0.1).abs() < 1e-12), "six of twelve");
}

#[test]
fn a_mask_without_a_time_counts_as_taken_at_the_time_of_its_first_frame() {
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
    assert_eq!(query(&bytes, &points), query(&packed, &points));
}

#[test]
fn a_mask_with_a_time_that_is_not_finite_or_before_the_last_is_refused_and_the_last_stays() {
    let data = data();
    for view in 0..data.view_count() {
        data.set_mask_at(view, &disc(20.0), 1.0).unwrap();
    }
    let refusal = |time| data.set_mask_at(2, &disc(40.0), time).unwrap_err().to_string();
    let name = data.camera(2).unwrap().name().to_owned();
    for time in [f64::NAN, f64::INFINITY] {
        let message = refusal(time);
        assert!(message.contains(&name) && message.contains("a finite time in seconds"), "{message}");
    }

    let message = refusal(0.999);
    assert!(message.contains(&name) && message.contains("last mask's, 1 s, found 0.999 s"), "{message}");
    assert!(data.set_packed_at(2, &PackedMask::new(&disc(40.0)), 0.5).is_err());

    let hull = data.update(2.0).unwrap();
    assert_eq!(hull.views()[2].silhouette().rect(), hull.views()[1].silhouette().rect());

    // Of two masks with one time, the one that was set last is shown.
    data.set_mask_at(2, &disc(40.0), 1.0).unwrap();
    let hull = data.update(2.0).unwrap();
    assert!(hull.views()[2].silhouette().rect().width() > hull.views()[1].silhouette().rect().width());
    assert!(data.at(f64::NAN).is_err());
}

/// The frame at 0.1 s of discs that were taken then, but for the disc of the view `late`, which was taken at 0 s.
fn frame_without_new_mask_of(data: &HullData, late: usize) -> Arc<Hull> {
    for view in 0..data.view_count() {
        data.set_mask_at(view, &disc(30.0), 0.0).unwrap();
    }
    data.update(0.0).unwrap();
    for view in (0..data.view_count()).filter(|&view| view != late) {
        data.set_mask_at(view, &disc(32.0), 0.1).unwrap();
    }
    data.update(0.1).unwrap()
}

/// The indices of the views that abstain.
fn abstaining(hull: &Hull) -> Vec<usize> {
    let views = hull.views().iter().enumerate();
    views.filter(|(_, view)| !view.is_enabled()).map(|(index, _)| index).collect()
}

#[test]
fn a_view_with_a_mask_older_than_the_largest_age_abstains_as_a_disabled_one() {
    let points = points();
    for policy in [Unseen::Outside, Unseen::ABSTAIN] {
        let (late, disabled) = (data(), data());
        late.set_max_age(Some(0.09)).unwrap();
        disabled.set_view_enabled(3, false).unwrap();
        let [late, disabled] = [late, disabled].map(|data| {
            data.set_unseen(policy).unwrap();
            frame_without_new_mask_of(&data, 3)
        });
        assert_eq!(abstaining(&late), [3]);
        assert_eq!(query(&late, &points), query(&disabled, &points));
        assert_eq!(late.aabb(), disabled.aabb());
    }
}

#[test]
fn a_late_view_takes_part_again_in_the_first_frame_with_its_next_mask() {
    let data = data();
    data.set_max_age(Some(0.09)).unwrap();
    assert_eq!(abstaining(&frame_without_new_mask_of(&data, 1)), [1]);

    // A mask that was taken too long ago for this frame does not bring the view back.
    data.set_mask_at(1, &disc(32.0), 0.02).unwrap();
    assert_eq!(abstaining(&data.update(0.12).unwrap()), [1]);
    data.set_mask_at(1, &disc(32.0), 0.13).unwrap();
    assert_eq!(abstaining(&data.update(0.14).unwrap()), []);

    // Frames of the past are judged by their own times.
    assert_eq!(abstaining(&data.at(0.125).unwrap()), [1]);
    assert_eq!(abstaining(&data.at(0.05).unwrap()), []);
}

#[test]
fn views_are_late_in_a_moving_hull_by_the_time_that_it_shows() {
    let data = data();
    data.set_max_age(Some(0.09)).unwrap();
    frame_without_new_mask_of(&data, 2);

    // The interpolated hull shows a time a frame earlier, the predicted one goes by the latest frame.
    let at = |motion, time| abstaining(&data.in_motion(motion, time).unwrap());
    assert_eq!(at(Motion::Interpolated, 0.18), []);
    assert_eq!(at(Motion::Interpolated, 0.195), [2]);
    assert_eq!(at(Motion::Held, 0.15), [2]);
    assert_eq!(at(Motion::Predicted, 0.15), [2]);
    data.set_max_age(Some(0.11)).unwrap();
    assert_eq!(at(Motion::Predicted, 0.15), []);
}

#[test]
fn a_frame_of_late_views_alone_is_an_empty_hull_as_one_of_disabled_views() {
    let data = data();
    frame_without_new_mask_of(&data, 0);
    data.set_max_age(Some(0.5)).unwrap();
    let late = data.update(1.0).unwrap();
    assert_eq!(late.empty_reason(), Some(EmptyReason::NoViews));
    assert!(points().iter().all(|point| !late.inside(point)));

    data.set_max_age(None).unwrap();
    assert_eq!(abstaining(&data.update(1.0).unwrap()), []);
    (0..data.view_count()).for_each(|view| data.set_view_enabled(view, false).unwrap());
    assert_eq!(data.update(1.0).unwrap().empty_reason(), late.empty_reason());
}

#[test]
fn a_largest_age_that_is_not_positive_and_finite_is_refused_and_the_last_stays() {
    let data = data();
    data.set_max_age(Some(0.09)).unwrap();
    for age in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let message = data.set_max_age(Some(age)).unwrap_err().to_string();
        assert!(
            message.contains("max_age: expected a positive") && message.contains(&age.to_string()),
            "{message}"
        );
    }
    assert_eq!(abstaining(&frame_without_new_mask_of(&data, 4)), [4]);
}

mod motion;
