use super::super::testing::{Fed, assert_says, frame};
use super::super::{Source, WhenFull};
use super::*;
use ode_visual_hull_random::Random;

fn streams<S: Source + 'static>(sources: impl IntoIterator<Item = S>) -> Vec<ReadAhead> {
    let names = ["a", "b", "c"].into_iter();
    names
        .zip(sources)
        .map(|(name, source)| ReadAhead::spawn(name, source, 4, WhenFull::Wait).unwrap())
        .collect()
}

/// One stream per list, with images at these times in seconds.
fn at(times: &[&[f64]]) -> Vec<ReadAhead> {
    streams(times.iter().map(|times| Fed::with((0..).zip(*times).map(|(n, &time)| Ok(frame(n, time))))))
}

/// The times of a set's images.
fn times(set: &ImageSet) -> Vec<Option<f64>> {
    set.images.iter().map(|frame| frame.as_ref().map(|frame| frame.time)).collect()
}

/// The times of all sets' images.
fn sets(streams: Vec<ReadAhead>, bound: f64) -> Vec<Vec<Option<f64>>> {
    Synchroniser::new(streams, bound).unwrap().map(|set| times(&set.unwrap())).collect()
}

#[test]
fn images_within_the_bound_form_a_set_and_every_image_is_in_one() {
    let streams = at(&[&[0.0, 1.0, 2.0, 3.0], &[0.2, 1.4, 3.1], &[0.9, 2.1, 2.9]]);
    let (some, none) = (Some, None);
    assert_eq!(
        sets(streams, 0.5),
        [
            [some(0.0), some(0.2), none],
            [some(1.0), some(1.4), some(0.9)],
            [some(2.0), none, some(2.1)],
            [some(3.0), some(3.1), some(2.9)],
        ]
    );
}

#[test]
fn a_difference_equal_to_the_bound_is_within_it() {
    assert_eq!(sets(at(&[&[1.0], &[1.5]]), 0.5).len(), 1);
    assert_eq!(sets(at(&[&[1.0], &[1.51]]), 0.5).len(), 2);
    assert_eq!(sets(at(&[&[1.0, 2.0], &[1.0, 2.0]]), 0.0).len(), 2);
}

#[test]
fn a_set_has_its_time_its_spread_and_the_missing_cameras() {
    let mut synchroniser = Synchroniser::new(at(&[&[2.0], &[10.0, 11.0], &[10.5]]), 0.5).unwrap();
    let first = synchroniser.next().unwrap().unwrap();
    assert_eq!((first.is_complete(), first.missing().collect::<Vec<_>>()), (false, vec![1, 2]));
    assert_eq!((first.time, first.time_spread, first.number()), (2.0, 0.0, 0));
    let second = synchroniser.next().unwrap().unwrap();
    assert_eq!((second.time, second.time_spread), (10.25, 0.5));
    assert_eq!(second.missing().collect::<Vec<_>>(), [0]);
    assert_eq!(synchroniser.next().unwrap().unwrap().number(), 1);
    assert!(synchroniser.next().is_none() && synchroniser.next().is_none());
}

#[test]
fn streams_of_unequal_length_end_with_flagged_sets() {
    let sets = sets(at(&[&[0.0, 1.0, 2.0], &[0.0]]), 0.5);
    assert_eq!(sets, [[Some(0.0), Some(0.0)], [Some(1.0), None], [Some(2.0), None]]);
}

#[test]
fn no_image_is_in_two_sets_or_in_none() {
    // Independent streams with steps of 3 ms to 11 ms.
    let mut random = Random(1);
    let mut stream = || {
        (0..200)
            .scan(0.0, |time, _| {
                *time += random.between(0.003, 0.011);
                Some(*time)
            })
            .collect::<Vec<f64>>()
    };
    let (a, b, c) = (stream(), stream(), stream());

    let synchroniser = Synchroniser::new(at(&[&a, &b, &c]), 0.004).unwrap();
    let mut collected = [const { Vec::new() }; 3];
    let mut last = 0.0;

    for set in synchroniser.map(Result::unwrap) {
        let present: Vec<f64> = times(&set).into_iter().flatten().collect();
        let (least, greatest) =
            (present.iter().copied().fold(f64::MAX, f64::min), present.iter().copied().fold(0.0, f64::max));
        assert!(greatest - least <= 0.004 && set.time_spread == greatest - least, "{set:?}");
        assert!((least..=greatest).contains(&set.time) && least > last, "{set:?}");
        last = least;
        times(&set).into_iter().zip(&mut collected).for_each(|(time, stream)| stream.extend(time));
    }

    assert_eq!(collected, [a, b, c]);
}

#[test]
fn an_error_of_one_stream_loses_only_that_image() {
    let broken = [Ok(frame(0, 0.0)), Err(Error::argument("corrupt")), Ok(frame(2, 2.0))];
    let valid = (0..3).map(|n| Ok(frame(n, f64::from(n))));
    let mut synchroniser = Synchroniser::new(streams([Fed::with(valid), Fed::with(broken)]), 0.5).unwrap();
    assert!(synchroniser.next().unwrap().unwrap().is_complete());
    assert_says(synchroniser.next().unwrap(), &["view \"b\"", "corrupt"]);
    let rest: Vec<_> = synchroniser.map(|set| times(&set.unwrap())).collect();
    assert_eq!(rest, [[Some(1.0), None], [Some(2.0), Some(2.0)]]);
}

#[test]
fn times_that_do_not_increase_are_errors() {
    for bad in [1.0, 0.5, f64::NAN, f64::INFINITY] {
        let mut synchroniser = Synchroniser::new(at(&[&[0.0, 1.0, bad, 3.0]]), 0.5).unwrap();
        let mut next = || synchroniser.next().unwrap();
        assert!(next().is_ok() && next().is_ok());
        assert_says(next(), &["view \"a\"", "frame 2", "1 s", &format!("found {bad} s")]);
        assert_eq!(next().unwrap().time, 3.0);
    }
}

#[test]
fn a_camera_that_stalls_is_flagged_and_its_late_images_are_counted() {
    let (running, stalled) = (Fed::default(), Fed::default());
    let mut synchroniser = Synchroniser::new(streams([running.clone(), stalled.clone()]), 0.5).unwrap();
    synchroniser.set_patience(Some(Duration::from_millis(1)));
    let mut next = || {
        let set = synchroniser.next().unwrap().unwrap();
        (times(&set), synchroniser.late(1))
    };

    (0..2).for_each(|n| running.send(Ok(frame(n, f64::from(n)))));
    // Ensures that the running stream does not miss a set.
    running.wait_until_starved();
    assert_eq!(next(), (vec![Some(0.0), None], 0));
    assert_eq!(next(), (vec![Some(1.0), None], 0));

    // Two images arrive after their sets; the third one is in time again.
    stalled.wait_until_starved();
    (0..3).for_each(|n| stalled.send(Ok(frame(n, f64::from(n)))));
    stalled.wait_until_starved();
    running.send(Ok(frame(2, 2.0)));
    running.wait_until_starved();
    assert_eq!(next(), (vec![Some(2.0), Some(2.0)], 2));

    running.end();
    stalled.end();
    assert!(synchroniser.next().is_none());
    assert_eq!((synchroniser.late(0), synchroniser.late(7), synchroniser.dropped(0)), (0, 0, 0));
}

#[test]
fn an_empty_list_of_streams_and_an_invalid_bound_are_refused() {
    assert_says(Synchroniser::new(Vec::new(), 0.1), &["at least one", "none"]);
    for bound in [-0.1, f64::NAN, f64::INFINITY] {
        assert_says(Synchroniser::new(at(&[&[]]), bound), &["bound", &bound.to_string()]);
    }
}
