//! Segmentation of colour images, compared with OpenCV's mixture of Gaussians (MOG2) in a process of its own.
//!
//! The two take turns on the same images. Each runs on one thread and is timed by the CPU time of that thread.

use crate::session::{Session, StartTime};
use crate::timing::thread_seconds;
use image::{GrayImage, RgbImage};
use ode_visual_hull::recording::Recording;
use ode_visual_hull::segment::{CleanPlate, Learning, RunningGaussian, Segmenter, Thresholds};
use ode_visual_hull::synthetic::{Scene, Subject, add_noise, clean_plate, layout, render_over};
use ode_visual_hull_testing::captures;
use ode_visual_hull_testing::figure::Bound;
use ode_visual_hull_testing::median;
use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// How often all images are segmented in a round.
const REPEATS: usize = 4;

pub fn run_group(session: &mut Session) {
    let Capture { empty, images } = captured().unwrap_or_else(rendered);
    let mut plate = CleanPlate::new(&empty, Thresholds::default()).expect("thresholds in range");
    let mut gaussian = RunningGaussian::new(Learning::default()).expect("numbers in range");
    gaussian.learn(&empty).expect("an image");

    let mut peer = match Peer::start(&empty, &images) {
        Ok(peer) => Some(peer),
        Err(problem) => {
            session.leave_out(&format!("segment_ms_over_mog2: {problem}"));
            None
        }
    };

    let (mut ours, mut plates, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    let mut theirs = Vec::new();

    for _ in 0..session.rounds() {
        plates.push(milliseconds(&mut plate, &images));
        ours.push(milliseconds(&mut gaussian, &images));
        if let Some(time) = peer.as_mut().and_then(Peer::milliseconds) {
            ratios.push(ours[ours.len() - 1] / time);
            theirs.push(time);
        }
    }

    let what = "a colour image to a silhouette with coverage, cleaned up, in milliseconds";
    session.reported("segment_clean_plate_ms", median(plates), StartTime::Images, what);
    session.reported("segment_running_gaussian_ms", median(ours), StartTime::Images, what);

    if !ratios.is_empty() {
        session.reported(
            "segment_mog2_ms",
            median(theirs),
            StartTime::Images,
            "OpenCV's MOG2 alone, in milliseconds",
        );
        let what = "a running Gaussian with clean-up and coverage over OpenCV's MOG2 alone";
        session.bounded("segment_ms_over_mog2", median(ratios), Bound::AtMost(0.5), StartTime::Images, what);
    }
}

/// Milliseconds per image.
fn milliseconds(segmenter: &mut dyn Segmenter, images: &[RgbImage]) -> f64 {
    let mut mask = GrayImage::default();
    let mut run = || {
        for image in images {
            segmenter.segment_into(image, &mut mask).expect("an image of the camera's size");
            black_box(&mask);
        }
    };
    // An untimed run first: the other candidate has filled the caches.
    run();
    let start = thread_seconds();
    (0..REPEATS).for_each(|_| run());
    1e3 * (thread_seconds() - start) / (REPEATS * images.len()) as f64
}

/// Images of one camera, and of its background.
struct Capture {
    empty: RgbImage,
    images: Vec<RgbImage>,
}

/// The first camera of the capture of the seated person; `None` where the capture is absent.
fn captured() -> Option<Capture> {
    let recording = Recording::open(captures::find("seated_person")?).ok()?;
    let frames = recording.image_frames().iter();
    let images =
        frames.map(|&frame| Some(recording.images(frame).ok()?.swap_remove(0))).collect::<Option<_>>()?;
    Some(Capture { empty: recording.background(0).ok()?, images })
}

/// A synthetic walking person, at the size of the real capture.
fn rendered() -> Capture {
    let target = nalgebra::Point3::new(0.0, 0.0, 0.9);
    let camera = &layout::ring(1, 3.5, 0.9, target, (644, 486), 0.9).expect("a layout")[0];
    let noisy = |mut image: RgbImage, seed: u64| {
        add_noise(&mut image, 3.0, seed).expect("a deviation");
        image
    };

    let background = clean_plate(camera, &Scene::default().room);
    let image = |frame: u64| {
        let scene = Scene { subject: Subject::person_at(0.2 * frame as f64), ..Scene::default() };
        noisy(render_over(camera, &scene, &background).expect("a background of that size"), frame)
    };
    Capture { images: (0..5).map(image).collect(), empty: noisy(background, 99) }
}

/// A Python process with OpenCV, which runs a round for each line that it reads.
struct Peer {
    process: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Peer {
    /// Starts Python with the images, after installing OpenCV below `target` if it is missing.
    fn start(empty: &RgbImage, images: &[RgbImage]) -> Result<Self, String> {
        let crate_dir = Path::new(env!("CARGO_MANIFEST_DIR"));
        let folder = crate_dir.join("../target/mog2");
        let python = python(&folder)?;

        // The images cross to Python as a file of raw bytes.
        let frames = folder.join("frames.rgb");
        let bytes: Vec<u8> =
            [empty].into_iter().chain(images).flat_map(|image| image.as_raw()).copied().collect();
        std::fs::write(&frames, bytes).map_err(|e| format!("{}: {e}", frames.display()))?;

        let (width, height) = empty.dimensions();
        let mut process = Command::new(&python)
            .arg(crate_dir.join("mog2.py"))
            .arg(&frames)
            .args([width, height, REPEATS as u32].map(|n| n.to_string()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| format!("{}: {e}", python.display()))?;

        let (input, output) = (process.stdin.take(), process.stdout.take());
        let (Some(input), Some(output)) = (input, output) else {
            return Err("expected pipes to Python, found none".into());
        };
        Ok(Self { process, input, output: BufReader::new(output) })
    }

    /// Runs a round and returns the milliseconds per image; `None` if Python has stopped.
    fn milliseconds(&mut self) -> Option<f64> {
        writeln!(self.input, "go").ok()?;
        let mut line = String::new();
        self.output.read_line(&mut line).ok()?;
        line.trim().parse().ok()
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The path of Python in a virtual environment in `folder` that has OpenCV installed.
fn python(folder: &Path) -> Result<PathBuf, String> {
    let python = folder.join("bin/python");
    let run = |command: &mut Command| match command.output() {
        Ok(output) if output.status.success() => Ok(()),
        Ok(output) => {
            let message = String::from_utf8_lossy(&output.stderr);
            Err(format!("{command:?}: {}", message.lines().last().unwrap_or_default()))
        }
        Err(error) => Err(format!("{command:?}: {error}")),
    };

    if run(Command::new(&python).args(["-c", "import cv2"])).is_err() {
        run(Command::new("python3").args(["-m", "venv"]).arg(folder))?;
        run(Command::new(&python).args(["-m", "pip", "install", "--quiet", "opencv-python-headless"]))?;
    }

    Ok(python)
}
