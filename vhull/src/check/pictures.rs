//! Overlays of each view's silhouette and the hull on the view's image.

use crate::output::make_folder;
use crate::progress;
use image::{GrayImage, Rgb, RgbImage};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::Hull;
use ode_visual_hull::silhouette::SUBJECT;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::{BackgroundImages, FrameTimes, RecordedHulls};
use std::path::Path;

/// Colour of the part of the silhouette that the hull fills.
const FILLED: [f64; 3] = [60.0, 200.0, 90.0];

/// Colour of the part of the silhouette that other views cut away from the hull.
const CUT: [f64; 3] = [235.0, 50.0, 40.0];

/// Colour of the silhouette's edge.
const EDGE: [f64; 3] = [255.0, 230.0, 60.0];

/// Opacity of the overlay.
const OPACITY: f64 = 0.55;

/// Writes a picture for each view of `frame`, by default the middle frame, into folder `out`.
pub fn write(recorded: &RecordedHulls, frame: Option<u32>, out: &Path) -> Result<()> {
    let recording = &recorded.recording;
    let frames = recording.frames();
    let frame = frame.unwrap_or(frames[frames.len() / 2]);
    let hull = recorded.hull(frame)?;
    make_folder(out)?;
    let masks = recording.masks(frame)?;

    let frame_times = FrameTimes::of(recording, None)?;
    let time = frames.binary_search(&frame).map_or(0.0, |k| frame_times.times[k]);
    let bar = progress::bar(masks.len(), "pictures");
    for (k, (camera, mask)) in recording.rig().cameras().iter().zip(&masks).enumerate() {
        let moment = (frame, time);
        let (streaming, bound) = (&frame_times.streaming, frame_times.bound());
        let mut background = BackgroundImages::open(recording, k, moment, streaming, bound)?;
        let mut picture = background.at(recording, moment)?;
        draw_overlay(&mut picture, camera, mask, &hull);

        let path = out.join(format!("{}_{frame:06}.png", camera.name()));
        picture
            .save(&path)
            .map_err(|e| Error::file(&path, format!("expected to write a png, found: {e}")))?;
        bar.inc(1);
    }

    bar.finish_and_clear();
    println!("  pictures of frame {frame} in {}:", out.display());
    println!("  green: filled by the hull; red: silhouette without hull; yellow: edge of the silhouette");
    Ok(())
}

/// Colours the pixels of the silhouette in `picture`, the image or mask of `camera`.
fn draw_overlay(picture: &mut RgbImage, camera: &Camera, mask: &GrayImage, hull: &Hull) {
    let is_subject = |x: u32, y: u32| mask.get_pixel_checked(x, y).is_some_and(|p| p.0[0] >= SUBJECT);
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        let subject = is_subject(x, y);
        let neighbours = [(x.wrapping_sub(1), y), (x + 1, y), (x, y.wrapping_sub(1)), (x, y + 1)];
        let ray = || camera.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);

        let colour = if subject && neighbours.iter().any(|&(x, y)| !is_subject(x, y)) {
            EDGE
        } else if !subject {
            continue;
        } else if ray().is_some_and(|ray| hull.ray_cast(&ray).is_some()) {
            FILLED
        } else {
            CUT
        };

        let mixed = |c: usize| f64::from(pixel.0[c]) * (1.0 - OPACITY) + colour[c] * OPACITY;
        *pixel = Rgb([mixed(0) as u8, mixed(1) as u8, mixed(2) as u8]);
    }
}
