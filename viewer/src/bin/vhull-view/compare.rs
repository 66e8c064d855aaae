//! `vhull-view compare`: drawn pictures beside the images of real cameras.

use crate::options::{DrawingOptions, save};
use image::imageops::{FilterType, crop_imm, replace, resize};
use image::{Rgb, RgbImage};
use ode_visual_hull::Result;
use ode_visual_hull::silhouette::Rect;
use ode_visual_hull_film::VolumeOptions;
use ode_visual_hull_viewer::metrics::{Comparison, Truth};
use ode_visual_hull_viewer::record::CapturedFrames;
use ode_visual_hull_viewer::{DrawOptions, Method};
use std::path::PathBuf;

/// Draw the subject from the place of each camera without that camera's colours, beside its own image.
///
/// One row a camera: its image, then the methods blend, sweep and hull. Prints how close they come: PSNR and SSIM over all
/// pixels that belong to the subject in the image or in the picture, and how far the two overlap.
#[derive(Debug, clap::Args)]
pub struct Options {
    /// Folder of a recording with masks and images.
    recording: PathBuf,
    /// Number of the frame [default: the first one with masks and images].
    #[arg(long, value_name = "N")]
    frame: Option<u32>,
    /// Where to write the sheet.
    #[arg(long, short, value_name = "FILE", default_value = "comparison.png")]
    out: PathBuf,
    /// Leave the silhouette of the camera out as well, not its colours alone.
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    volume: VolumeOptions,
    #[command(flatten)]
    drawing: DrawingOptions,
}

/// Height of a picture in the sheet, and the gap between pictures, in pixels.
const HEIGHT: u32 = 320;
const GAP: u32 = 4;

/// The methods that are compared, in the order of the columns.
const METHODS: [Method; 3] = [Method::Blend, Method::Sweep, Method::Hull];

/// Margin around the silhouette, as a part of its longer side.
const MARGIN: i32 = 20;

pub fn run(options: &Options) -> Result<()> {
    let captured = CapturedFrames::open(&options.recording, &options.volume)?;
    let frame = options.frame.map_or_else(|| captured.first_frame(), Ok)?;
    let scene = captured.scene(frame)?;
    let mut renderer = options.drawing.open_for_all()?;

    let (mut rows, mut found) = (Vec::new(), vec![Vec::new(); METHODS.len()]);
    println!("camera       method   psnr dB    ssim     iou");
    for (view, of_camera) in scene.views.iter().enumerate() {
        let Some(truth) = Truth::of(of_camera) else { continue };
        let left_out = if options.strict { scene.without_view(view) } else { scene.without_colours_of(view) };
        let part = around(&of_camera.rect());
        let mut row = vec![cut(&truth.image, &part)];
        for (method, found) in METHODS.into_iter().zip(&mut found) {
            let drawn = DrawOptions {
                method,
                shadows: false,
                surroundings: false,
                ..options.drawing.draw_options(false)
            };
            let picture = renderer.draw(&left_out, of_camera.camera(), &drawn)?;
            let comparison = truth.compare(&picture);
            print_line(of_camera.camera().name(), method, &comparison);
            found.push(comparison);
            row.push(cut(&picture.colour, &part));
        }
        rows.push(row);
    }
    for (method, found) in METHODS.into_iter().zip(&found) {
        print_line("mean", method, &Comparison::mean(found));
    }

    save(&sheet(&rows), &options.out)?;
    println!("frame {frame}, columns image, blend, sweep, hull: {}", options.out.display());
    Ok(())
}

fn print_line(camera: &str, method: Method, found: &Comparison) {
    let method = format!("{method:?}").to_lowercase();
    println!("{camera:<12} {method:<7} {:>8.2} {:>7.3} {:>7.3}", found.psnr, found.ssim, found.iou);
}

/// The part of an image to show of a silhouette within `rect`.
fn around(rect: &Rect) -> Rect {
    let longer = (rect.x1 - rect.x0).max(rect.y1 - rect.y0);
    rect.grown(longer / MARGIN + 1)
}

/// That part of an image, at the sheet's height.
fn cut(image: &RgbImage, part: &Rect) -> RgbImage {
    let part = part.intersection(&Rect::of_image(image.width(), image.height()));
    let (width, height) = (part.width().max(1) as u32, part.height().max(1) as u32);
    let cut = crop_imm(image, part.x0.max(0) as u32, part.y0.max(0) as u32, width, height).to_image();
    resize(&cut, (width * HEIGHT / height).max(1), HEIGHT, FilterType::CatmullRom)
}

/// The pictures in rows and columns.
fn sheet(rows: &[Vec<RgbImage>]) -> RgbImage {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let widest = |k: usize| rows.iter().filter_map(|row| row.get(k)).map(RgbImage::width).max().unwrap_or(0);
    let widths: Vec<u32> = (0..columns).map(widest).collect();
    let width = widths.iter().map(|width| width + GAP).sum::<u32>().max(1);
    let mut sheet = RgbImage::from_pixel(width, (HEIGHT + GAP) * rows.len().max(1) as u32, Rgb([60; 3]));
    for (y, row) in (0..).zip(rows) {
        let mut left = 0;
        for (picture, width) in row.iter().zip(&widths) {
            let inset = (width - picture.width()) / 2;
            replace(&mut sheet, picture, i64::from(left + inset), i64::from(y * (HEIGHT + GAP)));
            left += width + GAP;
        }
    }
    sheet
}
