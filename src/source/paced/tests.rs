use super::super::testing::{Fed, assert_says, frame, grey_image};
use super::super::{Images, ReadAhead, Synchroniser, WhenFull};
use super::*;
use std::sync::atomic::AtomicU32;

/// A clock that stands at 0.
fn paused() -> Clock {
    let clock = Clock::new();
    clock.pause();
    clock
}

/// A paused clock that is later than all images of a test, so that none of them is waited for.
fn late() -> Clock {
    let clock = paused();
    clock.advance(1000.0);
    clock
}

/// Opens a source with images of these numbers and times.
fn opens(images: &[(u32, f64)]) -> impl FnMut() -> Result<Box<dyn Source>> + Send + 'static {
    let images = images.to_vec();
    move || Ok(Box::new(Fed::with(images.iter().map(|&(number, time)| Ok(frame(number, time))))))
}

fn taken(source: &mut impl Source, count: usize) -> Vec<(u32, f64)> {
    let frames = std::iter::from_fn(|| source.next_frame()).take(count);
    frames.map(|frame| frame.unwrap()).map(|frame| (frame.number, frame.time)).collect()
}

#[test]
fn a_round_begins_at_its_start_with_number_0() {
    let round = Round::new(4..7, 10.0, 10.5, 0.25).unwrap();
    assert_eq!((round.length(), round.numbers()), (0.75, 4..7));
    let mut paced =
        Paced::looped(&paused(), round, -100.0, opens(&[(4, 10.0), (5, 10.25), (6, 10.5)])).unwrap();
    assert_eq!(taken(&mut paced, 3), [(0, -100.0), (1, -99.75), (2, -99.5)]);
}

#[test]
fn a_repetition_follows_one_period_after_the_last_image() {
    let clock = paused();
    let start = clock.now();
    let round = Round::at_rate(2, 4.0).unwrap();
    let mut paced = Paced::looped(&clock, round, start, opens(&[(0, 0.0), (1, 0.25)])).unwrap();
    for number in 0..7_u32 {
        let expected = start + f64::from(number) * 0.25;
        // Steps of a quarter of a second are exact, but for the rounding of the start.
        let (found, time) = taken(&mut paced, 1)[0];
        assert_eq!(found, number);
        assert!((time - expected).abs() < 1e-12, "{time} {expected}");
        clock.advance(0.25 + 1e-9);
    }
}

#[test]
fn cameras_with_different_images_stay_together_over_the_repetitions() {
    let clock = paused();
    let (round, start) = (Round::at_rate(3, 4.0).unwrap(), clock.now());
    // The second camera lacks the last image, and its exposures are 10 ms later.
    let cameras = [&[(0, 0.0), (1, 0.25), (2, 0.5)][..], &[(0, 0.01), (1, 0.26)]];
    let streams = cameras.map(|images| {
        let paced = Paced::looped(&clock, round.clone(), start, opens(images)).unwrap();
        ReadAhead::spawn("camera", paced, 2, WhenFull::Wait).unwrap()
    });
    clock.resume();
    let sets = Synchroniser::new(streams.into(), 0.02).unwrap().take(7);
    for (n, set) in sets.enumerate() {
        let set = set.unwrap();
        let numbers: Vec<_> = set.images.iter().flatten().map(|frame| frame.number).collect();
        let expected = if n % 3 == 2 { vec![n as u32] } else { vec![n as u32; 2] };
        assert_eq!(numbers, expected, "set {n}");
    }
}

#[test]
fn sources_that_share_a_start_begin_together_when_one_is_first_asked() {
    let clock = paused();
    let (round, start) = (Round::at_rate(1, 1.0).unwrap(), Start::default());
    let [mut left, mut right] =
        [(); 2].map(|()| Paced::looped(&clock, round.clone(), start.clone(), opens(&[(0, 0.0)])).unwrap());
    clock.advance(5.0);
    let asked = clock.now();
    assert_eq!(taken(&mut left, 1), [(0, asked)]);
    clock.advance(0.5);
    assert_eq!(taken(&mut right, 1), [(0, asked)]);
}

#[test]
fn the_next_repetition_is_opened_after_its_part_of_this_one_and_at_its_end_at_the_latest() {
    for (part, opened) in [(0.5, [1, 1, 2, 2]), (2.0, [1, 1, 1, 1])] {
        let count = Arc::new(AtomicU32::new(0));
        let mut open = opens(&[(0, 0.0), (1, 1.0), (2, 2.0), (3, 3.0)]);
        let counted = count.clone();
        let open = move || {
            counted.fetch_add(1, Ordering::Relaxed);
            open()
        };
        let round = Round::at_rate(4, 1.0).unwrap();
        let mut paced = Paced::looped(&late(), round, 0.0, open).unwrap().opening_after(part);
        for expected in opened {
            taken(&mut paced, 1);
            // A thread of its own opens it.
            while count.load(Ordering::Relaxed) < expected {
                std::thread::yield_now();
            }
            assert_eq!(count.load(Ordering::Relaxed), expected, "{part}");
        }
        taken(&mut paced, 1);
        assert!(count.load(Ordering::Relaxed) >= 2);
    }
}

#[test]
fn no_image_comes_before_its_time() {
    let clock = Clock::new();
    let images = Images::new([grey_image(1, (2, 1)), grey_image(2, (2, 1))], 100.0).unwrap();
    let start = clock.now();
    let open = move || Ok(Box::new(images.clone()) as Box<dyn Source>);
    let mut paced = Paced::looped(&clock, Round::at_rate(2, 100.0).unwrap(), start, open).unwrap();
    assert_eq!(paced.period(), Some(0.01));
    for _ in 0..5 {
        let frame = paced.next_frame().unwrap().unwrap();
        assert!(clock.now() >= frame.time);
        assert_eq!(*frame.image, grey_image(1 + (frame.number % 2) as u8, (2, 1)));
    }
}

#[test]
fn a_late_image_keeps_its_time_and_repetitions_that_have_passed_are_left_out() {
    let clock = late();
    let (start, round) = (clock.now() - 10.1, Round::at_rate(2, 1.0).unwrap());
    let mut paced = Paced::looped(&clock, round, start, opens(&[(0, 0.0), (1, 1.0)])).unwrap();
    let numbers: Vec<_> = taken(&mut paced, 3).into_iter().map(|(number, _)| number).collect();
    // After 10.1 of rounds of 2 seconds, the sixth has begun.
    assert_eq!(numbers, [0, 1, 10]);
}

#[test]
fn images_outside_the_round_are_left_out() {
    let round = Round::new(1..3, 1.0, 2.0, 1.0).unwrap();
    let clock = late();
    let open = opens(&[(0, 0.0), (1, 1.0), (2, 2.0), (2, 3.5), (3, 2.5)]);
    let mut paced = Paced::looped(&clock, round, clock.now() - 2.0, open).unwrap();
    let numbers: Vec<_> = taken(&mut paced, 3).into_iter().map(|(number, _)| number).collect();
    assert_eq!(numbers, [0, 1, 2]);
}

#[test]
fn a_cancelled_or_closed_wait_is_the_end() {
    for close in [false, true] {
        let clock = paused();
        let (round, start) = (Round::at_rate(1, 1.0).unwrap(), clock.now() + 1.0);
        let paced = Paced::looped(&clock, round, start, opens(&[(0, 0.0)])).unwrap();
        let mut ahead = ReadAhead::spawn("left", paced, 1, WhenFull::Wait).unwrap();
        if close {
            clock.close();
            assert!(ahead.next().is_none());
        }
        // Dropping it cancels the wait and joins the thread.
        drop(ahead);
    }
}

#[test]
fn an_unreadable_image_is_an_error_and_the_next_is_read() {
    let open = || {
        let images = [Ok(frame(0, 0.0)), Err(Error::argument("broken")), Ok(frame(2, 2.0))];
        Ok(Box::new(Fed::with(images)) as Box<dyn Source>)
    };
    let mut paced = Paced::looped(&late(), Round::at_rate(3, 1.0).unwrap(), 0.0, open).unwrap();
    assert_eq!(taken(&mut paced, 1), [(0, 0.0)]);
    assert_says(paced.next_frame().unwrap(), &["broken"]);
    assert_eq!(taken(&mut paced, 1), [(2, 2.0)]);
}

#[test]
fn a_source_that_cannot_be_opened_again_or_lacks_the_round_is_an_error_and_the_end() {
    let mut first = true;
    let open = move || match std::mem::take(&mut first) {
        true => Ok(Box::new(Fed::with([Ok(frame(0, 0.0))])) as Box<dyn Source>),
        false => Err(Error::argument("gone")),
    };
    let mut paced = Paced::looped(&late(), Round::at_rate(1, 1.0).unwrap(), 0.0, open).unwrap();
    assert_eq!(taken(&mut paced, 1), [(0, 0.0)]);
    assert_says(paced.next_frame().unwrap(), &["gone"]);
    assert!(paced.next_frame().is_none());

    let round = Round::new(5..7, 5.0, 6.0, 1.0).unwrap();
    let mut other = Paced::looped(&late(), round, 0.0, opens(&[(0, 0.0)])).unwrap();
    assert_says(other.next_frame().unwrap(), &["from 5 to 6", "found none"]);
    assert!(other.next_frame().is_none());
}

#[test]
fn a_round_without_images_times_or_a_rate_is_refused() {
    assert_says(Round::at_rate(0, 30.0), &["at least one image"]);
    for rate in [0.0, -1.0, f64::NAN] {
        assert_says(Round::at_rate(2, rate), &["positive period"]);
    }
    assert_says(Round::new(0..2, 1.0, 0.5, 1.0), &["1 s to 0.5 s"]);
    let endless = Round::at_rate(1, 1.0).unwrap();
    assert_says(Paced::looped(&paused(), endless, f64::NAN, opens(&[])), &["start", "NaN"]);
}
