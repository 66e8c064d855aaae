//! A recording of a real person, played by the clock into a live system: does the capture keep up?

use crate::live::{milliseconds, report_of};
use ode_visual_hull::source::Clock;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_testing::captures;
use ode_visual_hull_testing::figure::{Bound, Figure};
use ode_visual_hull_viewer::live::LiveCameras;
use std::path::{Path, PathBuf};
use std::process::Command;

const CAMERAS: [&str; 4] = ["cam01", "cam02", "cam03", "cam04"];

/// Images a second at which the videos are played, of which all have to be used; one set may be on its way at either end.
const RATE: f64 = 30.0;
const LEAST_RATE: f64 = 29.9;

/// Measures the capture `balancing_person`, if it is there.
pub fn measure() -> Result<Vec<Figure>> {
    let Some(capture) = captures::find("balancing_person") else { return Ok(Vec::new()) };
    eprintln!("view: live recording");
    let folder = Folder::new();
    prepare(&capture, &folder.0)?;
    let clock = Clock::new();
    let (report, growth) = report_of(LiveCameras::of_recording(&folder.0, Some(RATE), &clock)?, true)?;
    let [used, _, left_out] = report.sets;
    Ok(vec![
        Figure::bounded("live_recording_rate", used as f64 / report.seconds, Bound::AtLeast(LEAST_RATE)),
        Figure::bounded("live_recording_left_out", left_out as f64, Bound::AtMost(0.0)),
        Figure::reported("live_recording_fps", report.rate()),
        Figure::reported("live_recording_memory_growth_mb", growth),
        Figure::reported("live_recording_image_to_contact_p50_ms", milliseconds(report.to_contact[0])),
        Figure::reported("live_recording_image_to_contact_p99_ms", milliseconds(report.to_contact[1])),
        Figure::reported("live_recording_image_to_picture_p50_ms", milliseconds(report.to_pixel[0])),
        Figure::reported("live_recording_image_to_picture_p99_ms", milliseconds(report.to_pixel[1])),
    ])
}

/// Writes the recording to folder `to`, its videos in the size of the calibration.
fn prepare(capture: &Path, to: &Path) -> Result<()> {
    let copy = |file: &str| {
        std::fs::copy(capture.join(file), to.join(file)).map_err(|e| Error::file(capture.join(file), e))
    };
    copy("rig.toml")?;
    for camera in CAMERAS {
        std::fs::create_dir_all(to.join(camera)).map_err(|e| Error::file(to, e))?;
        copy(&format!("{camera}/background.png"))?;
        let (original, scaled) =
            (capture.join(format!("original/{camera}.mp4")), to.join(format!("{camera}/video.mp4")));
        let mut ffmpeg = Command::new("ffmpeg");
        ffmpeg.args(["-loglevel", "error", "-i"]).arg(&original).args(["-vf", "scale=544:960"]).arg(&scaled);
        let status = ffmpeg.status().map_err(|e| Error::file("ffmpeg", e))?;
        if !status.success() {
            return Err(Error::file(original, format!("expected ffmpeg to scale it, found {status}")));
        }
    }
    Ok(())
}

/// A folder that is removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        let path = std::env::temp_dir().join(format!("ode-visual-hull-live-{}", std::process::id()));
        // What an ended program of the same number has left; the next writing tells if it stays.
        let _ = std::fs::remove_dir_all(&path);
        let _ = std::fs::create_dir_all(&path);
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
