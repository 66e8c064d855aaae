//! Films as animated GIFs, with one palette and only the pixels that change, and strips of stills.

use color_quant::NeuQuant;
use gif::{DisposalMethod, Encoder, Frame, Repeat};
use image::codecs::png::{CompressionType, FilterType as PngFilter, PngEncoder};
use image::imageops::{FilterType, replace, resize};
use image::{Rgb, RgbImage};
use ode_visual_hull::{Error, Result};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Colours of the palette.
const COLOURS: usize = 255;

/// The index of a pixel that does not change.
const UNCHANGED: u8 = 255;

/// Weight of a pixel that changes in the choice of the palette; others have 1.
const MOVING_WEIGHT: usize = 12;

/// How long the last frame is shown, in hundredths of a second.
const LAST_DELAY: u16 = 150;

/// Width of a strip of stills and of the gaps in it, in pixels.
const STRIP_WIDTH: u32 = 1200;
const GAP: u32 = 6;

/// The frames of a film, in the order of time.
#[derive(Debug)]
pub struct Film {
    frames: Vec<RgbImage>,
    rate: f64,
}

impl Film {
    /// An empty film of `rate` frames a second.
    pub fn new(rate: f64) -> Self {
        Self { frames: Vec::new(), rate }
    }

    /// Adds a frame.
    pub fn push(&mut self, frame: RgbImage) {
        self.frames.push(frame);
    }

    /// Whether it has no frame.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// Writes the film as an animated GIF that repeats. Without frames no file is written.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let fail =
            |e: &dyn std::fmt::Display| Error::file(path, format!("expected to write a film, found: {e}"));
        let Some(first) = self.frames.first() else { return Ok(()) };
        let (width, height) = (first.width() as u16, first.height() as u16);
        let palette = Palette::of(&self.frames);
        let file = BufWriter::new(File::create(path).map_err(|e| fail(&e))?);
        let mut encoder = Encoder::new(file, width, height, &palette.colours).map_err(|e| fail(&e))?;
        encoder.set_repeat(Repeat::Infinite).map_err(|e| fail(&e))?;
        let mut shown = Vec::new();
        for (k, frame) in self.frames.iter().enumerate() {
            let pixels = palette.apply(frame);
            let mut encoded = changes(&pixels, &shown, width);
            encoded.delay = if k + 1 == self.frames.len() { LAST_DELAY } else { self.delay(k) };
            encoder.write_frame(&encoded).map_err(|e| fail(&e))?;
            shown = pixels;
        }

        let mut file = encoder.into_inner().map_err(|e| fail(&e))?;
        file.flush().map_err(|e| fail(&e))
    }

    /// How long frame `k` is shown, in hundredths of a second. Rounding errors do not add up.
    fn delay(&self, k: usize) -> u16 {
        let until = |k: usize| (100.0 * k as f64 / self.rate).round();
        (until(k + 1) - until(k)) as u16
    }

    /// Writes the frames at these times, in seconds, side by side into a PNG.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_strip(&self, times: &[f64], path: &Path) -> Result<()> {
        let Some(first) = self.frames.first() else { return Ok(()) };
        let width = (STRIP_WIDTH + GAP) / times.len() as u32 - GAP;
        let height = first.height() * width / first.width();
        let mut strip = RgbImage::from_pixel(STRIP_WIDTH, height, Rgb([255; 3]));
        for (i, time) in times.iter().enumerate() {
            let frame = &self.frames[((time * self.rate) as usize).min(self.frames.len() - 1)];
            let still = resize(frame, width, height, FilterType::Lanczos3);
            replace(&mut strip, &still, i64::from(width + GAP) * i as i64, 0);
        }

        let fail =
            |e: &dyn std::fmt::Display| Error::file(path, format!("expected to write a picture, found: {e}"));
        let mut file = BufWriter::new(File::create(path).map_err(|e| fail(&e))?);
        let encoder = PngEncoder::new_with_quality(&mut file, CompressionType::Best, PngFilter::Adaptive);
        strip.write_with_encoder(encoder).map_err(|e| fail(&e))?;

        file.flush().map_err(|e| fail(&e))
    }
}

/// The frame of the smallest rectangle in which `pixels` differ from those `shown`.
fn changes(pixels: &[u8], shown: &[u8], width: u16) -> Frame<'static> {
    let w = width as usize;
    let differs = |i: usize| shown.get(i) != Some(&pixels[i]);
    let (mut left, mut right, mut top, mut bottom) = (w, 0, usize::MAX, 0);
    for i in (0..pixels.len()).filter(|&i| differs(i)) {
        (left, right) = (left.min(i % w), right.max(i % w + 1));
        (top, bottom) = (top.min(i / w), bottom.max(i / w + 1));
    }

    if right == 0 {
        // Nothing differs, but a GIF's frame needs a pixel.
        (left, right, top, bottom) = (0, 1, 0, 1);
    }

    let index = |i: usize| if differs(i) { pixels[i] } else { UNCHANGED };
    let buffer: Vec<u8> =
        (top..bottom).flat_map(|y| (left..right).map(move |x| y * w + x)).map(index).collect();
    Frame {
        left: left as u16,
        top: top as u16,
        width: (right - left) as u16,
        height: (bottom - top) as u16,
        buffer: buffer.into(),
        transparent: Some(UNCHANGED),
        dispose: DisposalMethod::Keep,
        ..Frame::default()
    }
}

/// The colours of a whole film.
struct Palette {
    /// Red, green, blue of each.
    colours: Vec<u8>,
    /// Index of the nearest colour of each of 64 x 64 x 64 colours.
    nearest: Vec<u8>,
}

impl Palette {
    /// Chooses the colours by frames spread over the film. Pixels that change count more, since what moves is small and
    /// has colours of its own.
    fn of(frames: &[RgbImage]) -> Self {
        let first = &frames[0];
        let mut samples = Vec::new();
        for frame in frames.iter().step_by(frames.len().div_ceil(12)) {
            for (pixel, before) in frame.pixels().zip(first.pixels()) {
                let times = if pixel != before { MOVING_WEIGHT } else { 1 };
                let [r, g, b] = pixel.0;
                samples.extend(std::iter::repeat_n([r, g, b, 255], times).flatten());
            }
        }

        let quantiser = NeuQuant::new(7, COLOURS, &samples);
        let mut colours = quantiser.color_map_rgb();
        colours.resize(3 * 256, 0);
        let middle = |bits: usize| (bits << 2 | 2) as u8;
        let nearest = (0..1 << 18).map(|cell: usize| {
            let colour = [middle(cell >> 12), middle(cell >> 6 & 63), middle(cell & 63), 255];
            quantiser.index_of(&colour) as u8
        });

        Self { nearest: nearest.collect(), colours }
    }

    /// The colour index of each pixel, by ordered dithering (Bayer's 4 x 4 matrix), so that what rests does not
    /// flicker.
    fn apply(&self, frame: &RgbImage) -> Vec<u8> {
        const PATTERN: [[i16; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];
        let index = |(x, y, pixel): (u32, u32, &Rgb<u8>)| {
            let shift = (PATTERN[y as usize % 4][x as usize % 4] - 7) / 2;
            let [r, g, b] = pixel.0.map(|c| ((i16::from(c) + shift).clamp(0, 255) >> 2) as usize);
            self.nearest[r << 12 | g << 6 | b]
        };
        frame.enumerate_pixels().map(index).collect()
    }
}
