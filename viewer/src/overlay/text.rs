//! Words in a fixed-width bitmap font.

use super::pen::blend;
use embedded_graphics::Drawable;
use embedded_graphics::Pixel;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::iso_8859_1::{FONT_6X13, FONT_7X13, FONT_9X18, FONT_10X20};
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle};
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::text::{Baseline, Text};
use image::RgbImage;
use std::borrow::Cow;
use std::convert::Infallible;

/// What stands in the place of words that do not fit.
const CUT: &str = "..";

/// What text is written on, so that it can be read on any picture.
pub(super) const GROUND: [u8; 3] = [12, 14, 18];
pub(super) const GROUND_OPACITY: f32 = 0.62;

/// A font, at a size that suits a picture.
#[derive(Clone, Copy)]
pub(super) struct Lettering {
    font: &'static MonoFont<'static>,
    /// Pixels of the picture on a side of a pixel of the font.
    scale: u32,
}

impl Lettering {
    /// For a picture of this width, in pixels.
    pub(super) fn for_width(width: u32) -> Self {
        let font = match width {
            0..=500 => &FONT_6X13,
            501..=1000 => &FONT_7X13,
            1001..=1500 => &FONT_9X18,
            _ => &FONT_10X20,
        };
        Self { font, scale: 1 + width / 3000 }
    }

    /// For labels in the midst of a picture of this width, which are smaller.
    pub(super) fn for_labels(width: u32) -> Self {
        Self::for_width(width * 3 / 4)
    }

    /// From letter to letter, in pixels.
    pub(super) fn advance(&self) -> u32 {
        self.scale * (self.font.character_size.width + self.font.character_spacing)
    }

    /// From line to line, in pixels.
    pub(super) fn height(&self) -> u32 {
        self.scale * self.font.character_size.height
    }

    /// The width of a text of one line, in pixels.
    pub(super) fn width_of(&self, text: &str) -> u32 {
        self.advance() * text.chars().count() as u32
    }

    /// How many letters fit into a width in pixels.
    pub(super) fn capacity(&self, width: u32) -> usize {
        (width / self.advance()) as usize
    }

    /// The text, cut so that it fits into a width in pixels.
    pub(super) fn fit<'t>(&self, text: &'t str, width: u32) -> Cow<'t, str> {
        let capacity = self.capacity(width);
        if text.chars().count() <= capacity {
            return Cow::Borrowed(text);
        }
        let kept = text.chars().take(capacity.saturating_sub(CUT.len()));
        kept.chain(CUT.chars()).take(capacity).collect::<String>().into()
    }

    /// Writes one line of text whose upper left corner is `at`; what lies outside the image is left out.
    pub(super) fn write(
        &self,
        image: &mut RgbImage,
        at: (i64, i64),
        text: &str,
        colour: [u8; 3],
        opacity: f32,
    ) {
        let mut paper = Paper { image, at, scale: self.scale, colour, opacity };
        let style = MonoTextStyle::new(self.font, BinaryColor::On);
        let Ok(_) = Text::with_baseline(text, Point::zero(), style, Baseline::Top).draw(&mut paper);
    }

    /// Writes text as [`write`](Self::write) does, on a dark ground, so that it can be read on any picture.
    pub(super) fn write_on_ground(
        &self,
        image: &mut RgbImage,
        (left, top): (i64, i64),
        text: &str,
        colour: [u8; 3],
        opacity: f32,
    ) {
        let (width, height) = (i64::from(self.width_of(text)), i64::from(self.height()));
        let margin = 2 * i64::from(self.scale);
        for y in (top..top + height).filter(|_| width > 0) {
            for x in left - margin..left + width + margin {
                blend(image, x, y, GROUND, GROUND_OPACITY * opacity);
            }
        }
        self.write(image, (left, top), text, colour, opacity);
    }
}

/// An image as the library of fonts draws on it.
struct Paper<'i> {
    image: &'i mut RgbImage,
    at: (i64, i64),
    scale: u32,
    colour: [u8; 3],
    opacity: f32,
}

impl OriginDimensions for Paper<'_> {
    fn size(&self) -> Size {
        Size::new(self.image.width(), self.image.height())
    }
}

impl DrawTarget for Paper<'_> {
    type Color = BinaryColor;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<BinaryColor>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        let scale = i64::from(self.scale);
        for Pixel(point, _) in pixels.into_iter().filter(|Pixel(_, colour)| colour.is_on()) {
            let (x, y) = (self.at.0 + scale * i64::from(point.x), self.at.1 + scale * i64::from(point.y));
            for (dx, dy) in (0..scale * scale).map(|k| (k % scale, k / scale)) {
                blend(self.image, x + dx, y + dy, self.colour, self.opacity);
            }
        }
        Ok(())
    }
}
