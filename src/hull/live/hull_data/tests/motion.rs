//! Hulls at a simulation's own time, between and after the frames of discs that move and grow.

use super::*;
use crate::hull::MaskFilter;
use crate::silhouette::SUBJECT;

/// Seconds between two frames of [`publish`].
const PERIOD: f64 = 0.03;

/// The bytes of a view's mask.
fn mask_of(hull: &Hull, view: usize) -> GrayImage {
    hull.views()[view].silhouette().to_mask()
}

/// Which pixels of a view are subject.
fn subject_of(hull: &Hull, view: usize) -> Vec<bool> {
    mask_of(hull, view).iter().map(|&byte| byte >= SUBJECT).collect()
}

/// The mean column of a view's subject.
fn mean_column(hull: &Hull, view: usize) -> f64 {
    let (mut sum, mut area) = (0.0, 0.0);
    for (i, _, Luma([byte])) in mask_of(hull, view).enumerate_pixels() {
        sum += (f64::from(i) + 0.5) * f64::from(*byte);
        area += f64::from(*byte);
    }
    sum / area
}

#[test]
fn a_held_hull_is_the_latest_frame() {
    let data = data();
    assert!(data.in_motion(Motion::Held, 0.0).unwrap_err().to_string().contains("call update first"));
    let latest = publish(&data, 0);
    assert!(Arc::ptr_eq(&data.in_motion(Motion::Held, 7.0).unwrap(), &latest));
}

#[test]
fn one_frame_alone_is_held_in_every_mode() {
    let (data, points) = (data(), points());
    let latest = publish(&data, 0);
    for motion in [Motion::Interpolated, Motion::Predicted] {
        for time in [0.0, 0.01, 100.0] {
            let hull = data.in_motion(motion, time).unwrap();
            assert_eq!(query(&hull, &points), query(&latest, &points));
            assert_eq!(hull.velocity(&Point3::origin()), None);
        }
    }
}

#[test]
fn at_the_times_of_frames_an_interpolated_hull_shows_their_masks_one_frame_late() {
    let data = data();
    let frames: Vec<_> = (0..6).map(|frame| publish(&data, frame)).collect();
    // The last view has a new mask in every third frame only.
    for view in 0..data.view_count() - 1 {
        for (time, frame) in [(5.0 * PERIOD, 4), (6.0 * PERIOD, 5), (60.0 * PERIOD, 5)] {
            let hull = data.in_motion(Motion::Interpolated, time).unwrap();
            assert_eq!(subject_of(&hull, view), subject_of(&frames[frame], view), "view {view} at {time}");
        }
        let hull = data.in_motion(Motion::Predicted, 5.0 * PERIOD).unwrap();
        assert_eq!(subject_of(&hull, view), subject_of(&frames[5], view), "view {view}, predicted");
    }
}

#[test]
fn between_frames_a_disc_moves_steadily() {
    let data = data();
    let frames: Vec<_> = (0..4).map(|frame| publish(&data, frame)).collect();
    let before = mean_column(&frames[2], 0);
    // Discs move by 2 px a frame, and grow. An interpolated hull at the time of frame 3 shows frame 2.
    for part in [0.25, 0.5, 0.75] {
        let hull = data.in_motion(Motion::Interpolated, (3.0 + part) * PERIOD).unwrap();
        assert!((hull.time() - (2.0 + part) * PERIOD).abs() < 1e-12);
        let moved = mean_column(&hull, 0) - before;
        // A tenth of a cell of the flow.
        assert!((moved - 2.0 * part).abs() < 0.4, "{moved} px after {part} of a frame");

        let hull = data.in_motion(Motion::Predicted, (3.0 + part) * PERIOD).unwrap();
        let moved = mean_column(&hull, 0) - before;
        assert!((moved - 2.0 * (1.0 + part)).abs() < 0.5, "{moved} px, predicted {part} of a frame ahead");
    }
}

#[test]
fn a_prediction_ends_one_frame_ahead() {
    let data = data();
    (0..4).for_each(|frame| drop(publish(&data, frame)));
    let [one, many] =
        [1.0, 50.0].map(|ahead| data.in_motion(Motion::Predicted, (3.0 + ahead) * PERIOD).unwrap());
    for view in 0..data.view_count() - 1 {
        assert_eq!(mask_of(&one, view), mask_of(&many, view));
    }
}

#[test]
fn the_thread_that_asks_computes_the_flow_where_no_mask_has() {
    let points = points();
    let [asked_early, asked_late] = [data(), data()];
    for frame in 0..5 {
        for data in [&asked_early, &asked_late] {
            publish(data, frame);
        }
        asked_early.in_motion(Motion::Interpolated, PERIOD * f64::from(frame)).unwrap();
    }
    let queries = [&asked_early, &asked_late]
        .map(|data| query(&data.in_motion(Motion::Interpolated, 4.4 * PERIOD).unwrap(), &points));
    assert_eq!(queries[0], queries[1]);
}

#[test]
fn times_that_are_not_finite_are_refused() {
    let data = data();
    publish(&data, 0);
    for motion in [Motion::Held, Motion::Interpolated, Motion::Predicted] {
        for time in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let message = data.in_motion(motion, time).unwrap_err().to_string();
            assert!(message.contains("expected a finite frame time"), "{message}");
        }
    }
}

#[test]
fn equal_times_and_long_gaps_between_frames_give_no_motion_and_no_velocity() {
    for gap in [0.0, 0.6, 3.0] {
        let data = data();
        publish(&data, 0);
        publish_at(&data, 1, gap);
        let latest = data.latest().unwrap().1;
        for motion in [Motion::Interpolated, Motion::Predicted] {
            for time in [gap, gap + 0.01, gap + 10.0] {
                let hull = data.in_motion(motion, time).unwrap();
                assert_eq!(hull.velocity(&Point3::new(0.3, 0.0, 0.0)), None, "{gap} {motion:?}");
                if time == gap + 10.0 {
                    assert_eq!(mask_of(&hull, 0), mask_of(&latest, 0), "{gap} {motion:?}");
                }
            }
        }
    }
}

#[test]
fn a_hull_whose_next_frames_are_late_stands_still_and_has_no_velocity() {
    let (data, points) = (data(), points());
    (0..4).for_each(|frame| drop(publish(&data, frame)));
    // The last view has a new mask in every third frame only, and so a longer period.
    data.set_view_enabled(data.view_count() - 1, false).unwrap();
    let has_velocity = |motion: Motion, frames: f64| {
        let hull = data.in_motion(motion, frames * PERIOD).unwrap();
        points.iter().any(|p| hull.velocity(p).is_some())
    };
    // Both hulls stand still from the time of frame 4 on, which does not come. The motion is believed for half a period
    // more.
    for motion in [Motion::Interpolated, Motion::Predicted] {
        assert!(has_velocity(motion, 3.5) && has_velocity(motion, 4.4), "{motion:?}");
        assert!(!has_velocity(motion, 4.6), "{motion:?}");
    }
}

#[test]
fn no_velocity_exceeds_its_bound_or_is_nan_whatever_the_times() {
    let (data, mut random) = (data(), Random(23));
    let mut time = 0.0;
    for frame in 0..20 {
        time += [0.0, 1e-9, 1e-3, 0.03, 0.4, 2.0][random.below(6_usize)];
        publish_at(&data, frame, time);
        for motion in [Motion::Interpolated, Motion::Predicted] {
            let hull = data.in_motion(motion, time + random.between(-0.1, 0.5)).unwrap();
            for p in &points() {
                let speed = hull.velocity(p).map_or(0.0, |velocity| velocity.norm());
                // The bound that the documentation states.
                assert!(speed <= 20.0, "{speed} m/s");
            }
        }
    }
}

#[test]
fn a_disabled_view_abstains_in_motion_too() {
    let data = data();
    (0..3).for_each(|frame| drop(publish(&data, frame)));
    data.set_view_enabled(1, false).unwrap();
    let hull = data.in_motion(Motion::Interpolated, 2.5 * PERIOD).unwrap();
    assert!(!hull.views()[1].is_enabled() && hull.views()[0].is_enabled());
}

/// A disc at column `x` whose edge has 26 lobes of 1.5 pixels in the phase `phase`.
fn lobed_disc(x: f64, phase: f64) -> GrayImage {
    GrayImage::from_fn(160, 120, |i, j| {
        let (u, v) = (f64::from(i) + 0.5 - x, f64::from(j) + 0.5 - 60.0);
        let inwards = 25.0 + 1.5 * (26.0 * v.atan2(u) + phase).sin() - u.hypot(v);
        Luma([(127.5 + 255.0 * inwards).clamp(0.0, 255.0) as u8])
    })
}

#[test]
fn an_average_of_masks_is_calmer_than_their_noisy_edges_and_does_not_lag() {
    // The mean difference from the true disc, and how far the mean column lags behind it.
    let follow = |new_weight: f64| {
        let (data, mut random) = (data(), Random(5));
        data.set_mask_filter(MaskFilter { new_weight, ..MaskFilter::default() }).unwrap();
        let (mut difference, mut lag) = (0.0, 0.0);
        for frame in 0..24 {
            let x = 40.0 + 2.0 * f64::from(frame);
            let phase = random.between(0.0, std::f64::consts::TAU);
            data.set_mask(0, &lobed_disc(x, phase)).unwrap();
            (1..data.view_count()).for_each(|view| data.set_mask(view, &disc(x, 60.0, 25.0)).unwrap());
            let hull = data.update(PERIOD * f64::from(frame)).unwrap();
            if frame >= 8 {
                let (found, truth) = (mask_of(&hull, 0), disc(x, 60.0, 25.0));
                let pairs = found.iter().zip(truth.iter());
                difference += pairs.map(|(a, b)| f64::from(a.abs_diff(*b)) / 255.0).sum::<f64>();
                lag += (x - mean_column(&hull, 0)) / 16.0;
            }
        }
        (difference, lag)
    };
    let ((plain, _), (calm, lag)) = (follow(1.0), follow(0.5));
    // Independent noise falls to 0.58 with a weight of one half.
    assert!(calm < 0.75 * plain, "{calm} of {plain}");
    // Without the flow it would lag by 2 px.
    assert!(lag.abs() < 0.3, "lags by {lag} px");
}

#[test]
fn the_deviation_of_edges_from_their_velocity_tells_how_noisy_masks_are() {
    // The discs of all views stand still, and grow and shrink at random by up to 1.5 px, of about 13 mm each.
    let deviation = |is_noisy: bool| {
        let (data, mut random) = (data(), Random(6));
        for frame in 0..6 {
            for view in 0..data.view_count() {
                let error = if is_noisy { random.between(-1.5, 1.5) } else { 0.0 };
                data.set_mask(view, &disc(80.0, 60.0, 14.0 + error)).unwrap();
            }
            data.update(PERIOD * f64::from(frame)).unwrap();
            data.in_motion(Motion::Interpolated, 0.0).unwrap();
        }
        let hull = data.in_motion(Motion::Interpolated, 6.0 * PERIOD).unwrap();
        hull.surface_velocity(&Point3::new(0.05, 0.0, 0.35)).unwrap().deviation
    };
    let (clean, noisy) = (deviation(false), deviation(true));
    // Numbers between -1 and 1 deviate by 0.58.
    assert!(clean < 0.001 && (0.004..0.025).contains(&noisy), "{clean} m and {noisy} m");
}

#[test]
fn holes_below_the_limit_are_filled() {
    let (data, mut mask) = (data(), disc(80.0, 60.0, 40.0));
    for (i, j) in [(70, 60), (71, 60), (90, 50)] {
        mask.put_pixel(i, j, Luma([0]));
    }
    let holes = |smallest_hole_px: u32| {
        data.set_mask_filter(MaskFilter { smallest_hole_px, ..MaskFilter::default() }).unwrap();
        (0..data.view_count()).for_each(|view| data.set_mask(view, &mask).unwrap());
        let hull = data.update(1.0).unwrap();
        [(70, 60), (90, 50)].map(|(i, j)| !hull.views()[0].silhouette().is_subject(i, j))
    };
    assert_eq!([holes(0), holes(2), holes(3)], [[true, true], [true, false], [false, false]]);
}

#[test]
fn weights_of_masks_from_zero_to_one_alone_are_accepted() {
    let data = data();
    for new_weight in [0.0, -0.5, 1.1, f64::NAN] {
        let message =
            data.set_mask_filter(MaskFilter { new_weight, ..MaskFilter::default() }).unwrap_err().to_string();
        assert!(message.contains("above 0 and at most 1"), "{message}");
    }
}

fn disc(x: f64, y: f64, radius: f64) -> GrayImage {
    GrayImage::from_fn(160, 120, |i, j| {
        let inwards = radius - (f64::from(i) + 0.5 - x).hypot(f64::from(j) + 0.5 - y);
        Luma([(127.5 + 255.0 * inwards).clamp(0.0, 255.0) as u8])
    })
}

#[test]
fn silhouettes_that_were_warped_ahead_are_found_again_after_the_next_frame() {
    let (ahead, fresh, points) = (data(), data(), points());
    let at = |data: &HullData, frames: f64| data.in_motion(Motion::Interpolated, frames * PERIOD).unwrap();
    // The last view has a new mask in every third frame only, and so other masks around a time.
    let warped = |hull: &Hull| -> Vec<_> {
        hull.views().iter().rev().skip(1).map(|view| std::ptr::from_ref(view.silhouette())).collect()
    };
    (0..3).for_each(|frame| [&ahead, &fresh].into_iter().for_each(|data| drop(publish(data, frame))));
    let before = at(&ahead, 2.4);
    [&ahead, &fresh].into_iter().for_each(|data| drop(publish(data, 3)));
    let after = at(&ahead, 2.4);
    assert_eq!(warped(&before), warped(&after));
    assert_eq!(query(&after, &points), query(&at(&fresh, 2.4), &points));

    // At another time they are others, and those of the first time stay as they are.
    let (kept, other) = (query(&after, &points), at(&ahead, 2.6));
    assert!(warped(&other).iter().zip(warped(&after)).all(|(one, other)| *one != other));
    assert_eq!(query(&other, &points), query(&at(&fresh, 2.6), &points));
    assert_eq!(query(&after, &points), kept);
}

#[test]
fn many_steps_too_small_to_warp_for_add_up_to_a_warp() {
    let data = data();
    (0..4).for_each(|frame| drop(publish(&data, frame)));
    let at =
        |step: u32| data.in_motion(Motion::Interpolated, (2.4 + 5e-5 * f64::from(step)) * PERIOD).unwrap();
    let first = at(0);
    let is_first = |step: u32| std::ptr::eq(first.views()[0].silhouette(), at(step).views()[0].silhouette());
    assert!(is_first(1), "a step of a two-hundredth of a percent of a frame is none");
    assert!(!(2..10).all(is_first));
}

#[test]
fn a_hull_that_was_prepared_equals_one_that_was_not() {
    let (prepared, other, points) = (data(), data(), points());
    assert!(prepared.prepare_motion(Motion::Interpolated, 0.0).is_err(), "there is no frame yet");
    (0..4).for_each(|frame| [&prepared, &other].into_iter().for_each(|data| drop(publish(data, frame))));
    for (motion, frames) in [(Motion::Interpolated, 2.4), (Motion::Predicted, 3.4), (Motion::Held, 3.4)] {
        prepared.prepare_motion(motion, frames * PERIOD).unwrap();
        let [hull, expected] =
            [&prepared, &other].map(|data| data.in_motion(motion, frames * PERIOD).unwrap());
        assert_eq!(query(&hull, &points), query(&expected, &points), "{motion:?}");
    }
}
