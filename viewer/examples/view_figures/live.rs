//! A live system without a window: pictures a second, what is late, and how late the picture is.

use image::RgbImage;
use nalgebra::{Isometry3, Point3};
use ode_visual_hull::Result;
use ode_visual_hull::hull::Motion;
use ode_visual_hull::source::{Clock, ReadAhead, Synchroniser, WhenFull};
use ode_visual_hull::synthetic::{PERSON_PERIOD, Placed, Solid, Subject, Texture};
use ode_visual_hull_film::VolumeOptions;
use ode_visual_hull_testing::figure::{Bound, Figure};
use ode_visual_hull_testing::random::Random;
use ode_visual_hull_viewer::live::{
    Bodies, Live, LiveCameras, LiveOptions, LiveReport, Marks, Request, Scenery, Shown, Viewpoint,
};
use ode_visual_hull_viewer::{Method, RendererKind};
use std::f64::consts::TAU;
use std::sync::{Arc, Mutex};
use std::thread::sleep;
use std::time::Duration;

const CAMERAS: usize = 7;
const VGA: (u32, u32) = (640, 480);
const RATE: f64 = 30.0;

/// Seconds of a measurement, and those before it that do not count.
const SECONDS: f64 = 60.0;
const WARM_UP: f64 = 5.0;

/// Starts after which pairs of images are looked at, and sets of each.
const STARTS: usize = 200;
const SETS: usize = 8;

/// Measures the person in a rain of boxes, starts, and a pendulum.
pub fn measure() -> Result<Vec<Figure>> {
    eprintln!("view: live");
    let (refined, growth) = run(true)?;
    let (plain, _) = run(false)?;
    Ok(vec![
        Figure::bounded("live_fps", refined.rate(), Bound::AtLeast(10.0)),
        Figure::bounded("live_steps_late", late(&refined), Bound::AtMost(0.0)),
        Figure::bounded("live_wrong_pairs", wrong_pairs()? as f64, Bound::AtMost(0.0)),
        Figure::reported("live_fps_plain", plain.rate()),
        Figure::reported("live_steps_late_plain", late(&plain)),
        Figure::reported("live_sets_left_out", refined.sets[2] as f64),
        Figure::reported("live_memory_growth_mb", growth),
        Figure::reported("live_image_to_contact_p50_ms", milliseconds(refined.to_contact[0])),
        Figure::reported("live_image_to_contact_p99_ms", milliseconds(refined.to_contact[1])),
        Figure::reported("live_image_to_picture_p50_ms", milliseconds(refined.to_pixel[0])),
        Figure::reported("live_image_to_picture_p99_ms", milliseconds(refined.to_pixel[1])),
        Figure::reported("live_pendulum_lag_ms", 1e3 * pendulum_lag()?),
    ])
}

/// A time in milliseconds, of one in seconds.
pub fn milliseconds(time: Option<f64>) -> f64 {
    1e3 * time.unwrap_or(f64::NAN)
}

fn late(report: &LiveReport) -> f64 {
    (report.steps.late + report.steps.dropped) as f64
}

/// A person in a rain of boxes: the report, and by how many megabytes the program has grown meanwhile.
fn run(refine: bool) -> Result<(LiveReport, f64)> {
    report_of(LiveCameras::synthetic(CAMERAS, VGA, RATE, &Clock::new())?, refine)
}

/// What `cameras` capture in a rain of boxes: the report, and by how many megabytes the program has grown meanwhile.
pub fn report_of(cameras: LiveCameras, refine: bool) -> Result<(LiveReport, f64)> {
    let live = Live::start(cameras, &options(20), |_| ())?;
    live.request(request(&live, refine));
    sleep(Duration::from_secs_f64(WARM_UP));
    let (before, memory) = (live.report(), resident_mb());
    sleep(Duration::from_secs_f64(SECONDS));
    let growth = resident_mb() - memory;
    Ok((since(&before, live.stop()), growth))
}

/// What of `report` came after `before`.
fn since(before: &LiveReport, mut report: LiveReport) -> LiveReport {
    report.seconds -= before.seconds;
    report.pictures -= before.pictures;
    report.steps.in_time -= before.steps.in_time;
    report.steps.late -= before.steps.late;
    report.steps.dropped -= before.steps.dropped;
    report.sets.iter_mut().zip(before.sets).for_each(|(after, before)| *after -= before);
    report
}

fn options(count: usize) -> LiveOptions {
    LiveOptions {
        bodies: Bodies { scenery: Scenery::Rain, count, side: 0.12 },
        motion: Motion::Interpolated,
        volume: VolumeOptions::default(),
        renderer: RendererKind::Cpu,
        is_real_time: true,
        record: None,
    }
}

fn request(live: &Live, refine: bool) -> Request {
    Request {
        viewpoint: Viewpoint::Free(live.home()),
        size: VGA,
        coarseness: 1,
        method: Method::Blend,
        refine,
        marks: Marks::default(),
    }
}

/// Memory of the program that is in use, in megabytes; 0 where the system does not tell.
fn resident_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok());
    kilobytes.unwrap_or(0.0) / 1024.0
}

/// The number of sets whose images are of different moments, after many starts whose cameras begin at different times.
fn wrong_pairs() -> Result<usize> {
    let (mut random, mut wrong) = (Random(17), 0);
    for _ in 0..STARTS {
        let clock = Clock::new();
        let cameras = LiveCameras::synthetic(3, (32, 24), 120.0, &clock)?;
        let (rig, sources, period) = cameras.into_sources();
        let mut streams = Vec::new();
        for (camera, source) in rig.cameras().iter().zip(sources) {
            sleep(Duration::from_secs_f64(3.0 * period * random.unit()));
            streams.push(ReadAhead::spawn(camera.name(), source, 3, WhenFull::DropOldest)?);
        }
        let mut sets = Synchroniser::new(streams, 0.5 * period)?;
        sets.set_patience(Some(Duration::from_secs_f64(1.5 * period)));
        for set in sets.by_ref().take(SETS) {
            let set = set?;
            let mut numbers = set.images.iter().flatten().map(|frame| frame.number);
            let first = numbers.next();
            wrong += usize::from(numbers.any(|number| Some(number) != first));
        }
        clock.close();
    }
    Ok(wrong)
}

/// By how much the picture of a pendulum is behind the pendulum, in seconds, found in the pictures alone.
fn pendulum_lag() -> Result<f64> {
    let frames = (PERSON_PERIOD * RATE).round() as u32;
    let at = |k: u32| -> Result<Subject> {
        let place = Point3::new(0.0, 0.4 * (TAU * f64::from(k) / f64::from(frames)).sin(), 0.9);
        let ball = Placed::new(
            Solid::sphere(0.25)?,
            Isometry3::translation(place.x, place.y, place.z),
            Texture::plain([220, 30, 30]),
        );
        Ok(Subject::new(vec![ball]))
    };
    let clock = Clock::new();
    let subjects = (0..frames).map(at).collect::<Result<Vec<_>>>()?;
    let cameras = LiveCameras::rendered(&subjects, CAMERAS, VGA, RATE, &clock)?;
    let begun = clock.now();
    let seen: Arc<Mutex<Vec<(f64, f64)>>> = Arc::default();
    let (sink, watch) = (seen.clone(), clock.clone());
    let live = Live::start(cameras, &options(0), move |shown: Shown| {
        if let (Some(column), Ok(mut seen)) = (red_column(&shown.picture), sink.lock()) {
            seen.push((watch.now(), column));
        }
    })?;
    let mut seen_from = request(&live, true);
    // From +x, so that y is along the picture's rows.
    if let Viewpoint::Free(orbit) = &mut seen_from.viewpoint {
        (orbit.azimuth, orbit.elevation) = (0.0, 0.1);
    }
    live.request(seen_from);
    sleep(Duration::from_secs_f64(WARM_UP + 20.0 * PERSON_PERIOD));
    drop(live);
    let seen = seen.lock().map(|seen| seen.clone()).unwrap_or_default();
    Ok(lag(&seen, begun))
}

/// The mean column of the red pixels of a picture.
fn red_column(picture: &RgbImage) -> Option<f64> {
    let is_red = |rgb: &[u8; 3]| rgb[0] > 90 && rgb[1] < 60 && rgb[2] < 60;
    let columns =
        picture.enumerate_pixels().filter(|(_, _, pixel)| is_red(&pixel.0)).map(|(x, _, _)| f64::from(x));
    let (sum, count) = columns.fold((0.0, 0), |(sum, count), x| (sum + x, count + 1));
    (count > 100).then(|| sum / f64::from(count))
}

/// The delay of a sine of the pendulum's period that is seen at these times, which begins at time `begun`.
fn lag(seen: &[(f64, f64)], begun: f64) -> f64 {
    let after: Vec<_> = seen.iter().filter(|(time, _)| *time > begun + WARM_UP).collect();
    let mean = after.iter().map(|(_, x)| x).sum::<f64>() / after.len() as f64;
    let (mut along_sine, mut along_cosine) = (0.0, 0.0);
    for (time, x) in &after {
        let (sine, cosine) = (TAU * (time - begun) / PERSON_PERIOD).sin_cos();
        along_sine += sine * (x - mean);
        along_cosine += cosine * (x - mean);
    }
    // From +x, +y is to the right: x - mean = A sin(phase - delay).
    let delay = (-along_cosine).atan2(along_sine).rem_euclid(TAU);
    delay / TAU * PERSON_PERIOD
}
