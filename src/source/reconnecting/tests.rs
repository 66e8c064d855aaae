use super::super::testing::{Fed, assert_says, frame, grey_image};
use super::super::{Device, DeviceOptions, ReadAhead, WhenFull};
use super::*;
use std::time::Instant;

/// Options that open a lost source again soon.
fn soon() -> ReconnectOptions {
    ReconnectOptions { retry: Duration::from_millis(1), ..ReconnectOptions::default() }
}

/// Opens one of `sources` after the other, and fails after the last.
fn opens(sources: impl IntoIterator<Item = Fed>) -> impl FnMut() -> Result<Box<dyn Source>> + Send {
    let mut sources = sources.into_iter().collect::<VecDeque<_>>();
    move || match sources.pop_front() {
        Some(source) => Ok(Box::new(source)),
        None => Err(Error::argument("no further source")),
    }
}

/// A test pattern from ffmpeg.
fn pattern(input: &str, epoch: Instant) -> Result<Box<dyn Source>> {
    let options = DeviceOptions { format: Some("lavfi".into()), ..DeviceOptions::default() };
    Ok(Box::new(Device::start(input, &options, epoch)?))
}

fn next(source: &mut Reconnecting) -> Frame {
    source.next_frame().unwrap().unwrap()
}

fn said(status: &StatusHandle) -> Result<()> {
    status.status().last_error.map_or(Ok(()), |said| Err(Error::argument(said)))
}

#[test]
fn a_stream_that_ends_is_opened_again_and_its_numbers_and_times_go_on() {
    let epoch = Instant::now();
    let mut source = Reconnecting::new(soon(), move || pattern("testsrc=s=32x24:r=10:d=0.3", epoch)).unwrap();
    let status = source.status_handle();
    assert_eq!(status.status(), StreamStatus::default());

    let frames: Vec<_> = (0..7).map(|_| next(&mut source)).collect();
    assert!(frames.iter().map(|frame| frame.number).eq(0..7));
    assert!(frames.is_sorted_by(|a, b| a.time < b.time));
    let now = status.status();
    assert_eq!((now.is_connected, now.losses, now.frames), (true, 2, 7));
    assert_says(said(&status), &["testsrc", "disconnected"]);
}

#[test]
fn a_camera_that_is_ended_from_outside_comes_back() {
    let handles = Arc::new(std::sync::Mutex::new(Vec::new()));
    let opened = Arc::clone(&handles);
    let epoch = Instant::now();
    let open = move || {
        let source = pattern("testsrc=s=32x24", epoch)?;
        opened.lock().unwrap().push(source.cancel_handle());
        Ok(source)
    };

    let mut source = Reconnecting::new(soon(), open).unwrap();
    next(&mut source);
    handles.lock().unwrap()[0].stop();
    while handles.lock().unwrap().len() < 2 {
        next(&mut source);
    }
    next(&mut source);
    let status = source.status_handle().status();
    assert_eq!((status.losses, status.is_connected), (1, true));
}

#[test]
fn a_camera_that_is_silent_is_lost_and_opened_again() {
    let silent = Fed::default();
    silent.send(Ok(frame(0, 0.0)));
    let patience = Duration::from_millis(30);
    let options = ReconnectOptions { patience, first_patience: patience, ..soon() };
    let never = Fed::default();
    let again = Fed::with([Ok(frame(0, 1.0))]);
    let mut source = Reconnecting::new(options, opens([silent, never, again])).unwrap();
    let status = source.status_handle();

    next(&mut source);
    let lost_from = Instant::now();
    assert_eq!(next(&mut source).time, 1.0);
    assert!(lost_from.elapsed() >= 2 * patience);
    // The source that never gave an image could not be lost.
    assert_eq!(status.status().losses, 1);
    assert_says(said(&status), &["found none for 0.0 s"]);
}

#[test]
fn a_source_that_cannot_be_opened_is_tried_again_and_told() {
    let mut tries = 0;
    let open = move || {
        tries += 1;
        match tries {
            1..4 => Err(Error::argument(format!("try {tries}"))),
            _ => Ok(Box::new(Fed::with([Ok(frame(0, 0.0))])) as Box<dyn Source>),
        }
    };
    let mut source = Reconnecting::new(soon(), open).unwrap();
    let status = source.status_handle();
    next(&mut source);
    assert_says(said(&status), &["try 3"]);
    let now = status.status();
    assert_eq!((now.losses, now.frames, now.is_connected), (0, 1, true));
}

#[test]
fn an_error_of_the_source_is_a_loss_and_no_error() {
    let first = Fed::with([Ok(frame(0, 0.0)), Err(Error::argument("broken")), Ok(frame(1, 1.0))]);
    let mut source = Reconnecting::new(soon(), opens([first, Fed::with([Ok(frame(5, 2.0))])])).unwrap();
    let frames = [(); 2].map(|()| next(&mut source));
    assert_eq!(frames.map(|frame| (frame.number, frame.time)), [(0, 0.0), (1, 2.0)]);
    assert_says(said(&source.status_handle()), &["broken"]);
}

#[test]
fn images_of_another_size_or_without_a_later_time_are_left_out_and_told() {
    let wide = Frame { image: grey_image(0, (3, 1)).into(), ..frame(1, 1.0) };
    let images = [frame(0, 0.0), wide, frame(2, 2.0), frame(3, 2.0), frame(4, f64::NAN), frame(5, 3.0)];
    let options = ReconnectOptions { size: Some((2, 1)), ..soon() };
    let mut source = Reconnecting::new(options, opens([Fed::with(images.map(Ok))])).unwrap();
    let status = source.status_handle();

    let first = [(); 2].map(|()| next(&mut source));
    assert_eq!(first.map(|frame| (frame.number, frame.time)), [(0, 0.0), (1, 2.0)]);
    assert_says(said(&status), &["expected images of 2 x 1", "found 3 x 1", "calibrated"]);
    assert_eq!(next(&mut source).time, 3.0);
    assert_says(said(&status), &["expected a time after", "2 s", "found NaN s"]);
    let now = status.status();
    assert_eq!((now.left_out, now.losses, now.is_connected), (3, 0, true));
}

#[test]
fn the_rate_is_measured_by_the_times_and_forgotten_with_a_loss() {
    let at = |times: &[f64]| Fed::with(times.iter().map(|&time| Ok(frame(0, time))));
    let mut source = Reconnecting::new(soon(), opens([at(&[0.0, 0.25, 0.5]), at(&[9.0, 9.5])])).unwrap();
    let status = source.status_handle();
    let rates = [(); 5].map(|()| {
        next(&mut source);
        status.status().measured_rate
    });
    assert_eq!(rates, [None, Some(4.0), Some(4.0), None, Some(2.0)]);
}

#[test]
fn cancelling_ends_a_wait_for_an_image_and_a_wait_between_tries() {
    let silent = Fed::default();
    let ahead = {
        let source = Reconnecting::new(ReconnectOptions::default(), opens([silent.clone()])).unwrap();
        ReadAhead::spawn("left", source, 1, WhenFull::DropOldest).unwrap()
    };
    silent.wait_until_starved();
    drop(ahead);

    let retry = Duration::from_secs(3600);
    let source =
        Reconnecting::new(ReconnectOptions { retry, ..ReconnectOptions::default() }, opens([])).unwrap();
    let status = source.status_handle();
    let ahead = ReadAhead::spawn("left", source, 1, WhenFull::DropOldest).unwrap();
    while status.status().last_error.is_none() {
        std::thread::yield_now();
    }
    drop(ahead);
    assert_says(said(&status), &["no further source"]);
}
