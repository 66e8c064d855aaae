//! Colours at places of photographs, for several rays at once.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::lanes::{LANES, Lanes, whole};
use image::RgbImage;

/// The photograph that each ray of a packet looks at.
#[derive(Debug, Clone, Copy)]
pub struct Photos<'p> {
    /// Red, green and blue, pixel by pixel.
    bytes: [&'p [u8]; LANES],
    /// The last column and row.
    last: [Lanes; 2],
    /// Bytes in a row.
    stride: [i32; LANES],
}

impl<'p> Photos<'p> {
    /// These photographs, one for each ray.
    #[inline(always)]
    pub fn new(photos: [&'p RgbImage; LANES]) -> Self {
        let last = |pixels: u32| pixels.saturating_sub(1) as f32;
        Self {
            bytes: photos.map(|photo| photo.as_raw().as_slice()),
            last: [photos.map(|photo| last(photo.width())), photos.map(|photo| last(photo.height()))],
            stride: photos.map(|photo| 3 * photo.width() as i32),
        }
    }

    /// Red, green and blue at image positions `(u, v)`, bilinear between pixel centres; those of the nearest pixel beyond them.
    #[inline(always)]
    pub fn colours(&self, u: &Lanes, v: &Lanes) -> [Lanes; 3] {
        let (mut at, mut right, mut below) = ([0; LANES], [0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            let (x, y) =
                ((u[k] - 0.5).max(0.0).min(self.last[0][k]), (v[k] - 0.5).max(0.0).min(self.last[1][k]));
            let (i, j) = (whole(x), whole(y));
            at[k] = j * self.stride[k] + 3 * i;
            (right[k], below[k]) = (x - i as f32, y - j as f32);
        }

        // The left and the right pixel of the upper and the lower row, each with the first byte of the next one.
        let mut corners = [[0; LANES]; 4];
        for k in 0..LANES {
            let rows = [at[k], at[k] + self.stride[k]];
            let [upper, lower] = rows.map(|at| two_pixels(self.bytes[k], at as usize));
            (corners[0][k], corners[1][k]) = (upper as u32, (upper >> 24) as u32);
            (corners[2][k], corners[3][k]) = (lower as u32, (lower >> 24) as u32);
        }

        let mut colours = [[0.0; LANES]; 3];
        for channel in 0..3 {
            for k in 0..LANES {
                let [a, b, c, d] = corners.map(|pixels| (pixels[k] >> (8 * channel) & 0xff) as i32 as f32);
                let (upper, lower) = (a + (b - a) * right[k], c + (d - c) * right[k]);
                colours[channel][k] = upper + (lower - upper) * below[k];
            }
        }
        colours
    }
}

/// The bytes of two pixels next to one another, the first of which begins at byte number `at`; zeros beyond the photograph.
#[inline(always)]
fn two_pixels(bytes: &[u8], at: usize) -> u64 {
    match bytes.get(at..).and_then(|from| from.first_chunk()) {
        Some(eight) => u64::from_le_bytes(*eight),
        None => last_pixels(bytes.get(at..).unwrap_or_default()),
    }
}

/// What is left of a photograph that ends.
#[cold]
fn last_pixels(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;
    use ode_visual_hull_testing::random::Random;

    /// Bilinear between pixel centres, one pixel after another.
    fn expected(photo: &RgbImage, u: f32, v: f32) -> [f32; 3] {
        let (width, height) = photo.dimensions();
        let (x, y) = ((u - 0.5).clamp(0.0, width as f32 - 1.0), (v - 0.5).clamp(0.0, height as f32 - 1.0));
        let (right, below) = (x.fract(), y.fract());
        [0, 1, 2].map(|c| {
            let at = |i: u32, j: u32| {
                f32::from(photo.get_pixel((x as u32 + i).min(width - 1), (y as u32 + j).min(height - 1))[c])
            };
            let (upper, lower) =
                (at(0, 0) * (1.0 - right) + at(1, 0) * right, at(0, 1) * (1.0 - right) + at(1, 1) * right);
            upper * (1.0 - below) + lower * below
        })
    }

    #[test]
    fn colours_are_bilinear_up_to_the_last_pixel_and_those_of_the_nearest_one_beyond() {
        let mut random = Random(7);
        for (width, height) in [(1, 1), (2, 1), (1, 3), (5, 4), (16, 9)] {
            let mut byte = || (256.0 * random.unit()) as u8;
            let photo = RgbImage::from_fn(width, height, |_, _| Rgb([byte(), byte(), byte()]));
            let photos = Photos::new([&photo; LANES]);
            for _ in 0..500 {
                // Halves and whole numbers are where one pixel or row of pixels ends.
                let mut place =
                    |length: u32| ((2 * length + 4) as f64 * random.unit()).round() as f32 / 2.0 - 1.0;
                let (whole_u, whole_v) = (place(width), place(height));
                let (u, v): (Lanes, Lanes) = (
                    std::array::from_fn(|k| whole_u + k as f32 / 16.0),
                    std::array::from_fn(|k| whole_v - k as f32 / 16.0),
                );
                let found = photos.colours(&u, &v);
                for k in 0..LANES {
                    for (c, expected) in expected(&photo, u[k], v[k]).into_iter().enumerate() {
                        // Single precision of numbers up to 255.
                        assert!((found[c][k] - expected).abs() < 1e-3, "{u:?}, {v:?}: {found:?}");
                    }
                }
            }
        }
    }
}
