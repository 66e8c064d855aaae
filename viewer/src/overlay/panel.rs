//! Lines of text on a dark panel in a corner of an image, and banners with warnings and errors.

use super::pen::blend;
use super::text::{GROUND, GROUND_OPACITY, Lettering};
use image::RgbImage;

/// A corner of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Corner {
    /// The first rows, on the left.
    UpperLeft,
    /// The first rows, on the right.
    UpperRight,
    /// The last rows, on the left.
    LowerLeft,
    /// The last rows, on the right.
    LowerRight,
}

/// How bad a banner's message is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// Something works less well than it could: black on yellow.
    Warning,
    /// Something does not work: white on red.
    Error,
}

/// How a panel looks.
struct Paint {
    ground: [u8; 3],
    opacity: f32,
    ink: [u8; 3],
}

const PANEL: Paint = Paint { ground: GROUND, opacity: GROUND_OPACITY, ink: [240, 240, 240] };
const WARNING: Paint = Paint { ground: [255, 208, 40], opacity: 0.92, ink: [20, 16, 0] };
const ERROR: Paint = Paint { ground: [190, 24, 24], opacity: 0.92, ink: [255, 255, 255] };

/// The most lines of a banner.
const BANNER_LINES: usize = 4;

/// Draws lines of text on a half-transparent dark panel in a corner of `image`. A line that does not fit the width is cut with
/// "..", and lines that do not fit the height are left out. Letters beyond ISO 8859-1 become question marks. Without lines
/// there is no panel.
pub fn draw_panel(image: &mut RgbImage, corner: Corner, lines: &[impl AsRef<str>]) {
    let lettering = Lettering::for_width(image.width());
    let inner = Area::around(image).shrunk(2 * padding(&lettering));
    let most = (inner.height / i64::from(lettering.height())).max(0) as usize;
    let lines: Vec<_> =
        lines.iter().take(most).map(|line| lettering.fit(line.as_ref(), inner.width as u32)).collect();
    let width = lines.iter().map(|line| i64::from(lettering.width_of(line))).max().unwrap_or(0);
    let height = lines.len() as i64 * i64::from(lettering.height());
    let (left, top) = match corner {
        Corner::UpperLeft => (0, 0),
        Corner::UpperRight => (inner.width - width, 0),
        Corner::LowerLeft => (0, inner.height - height),
        Corner::LowerRight => (inner.width - width, inner.height - height),
    };
    let text = Area { left: inner.left + left, top: inner.top + top, width, height };
    draw_lines(image, &lettering, &text, &lines, &PANEL);
}

/// Draws a message across the lower part of `image`, over several lines where it is long, the last of which is cut with
/// ".." where even they do not suffice. An empty message draws nothing.
pub fn draw_banner(image: &mut RgbImage, severity: Severity, message: &str) {
    let lettering = Lettering::for_width(image.width());
    let inner = Area::around(image).shrunk(2 * padding(&lettering));
    let lines = wrapped(message, lettering.capacity(inner.width as u32));
    let most = (inner.height / i64::from(lettering.height())).max(0) as usize;
    let lines: Vec<_> = lines.iter().take(most).collect();

    let height = lines.len() as i64 * i64::from(lettering.height());
    let text = Area { top: inner.top + inner.height - height, height, ..inner };
    let paint = if severity == Severity::Warning { &WARNING } else { &ERROR };
    draw_lines(image, &lettering, &text, &lines, paint);
}

/// Draws lines of text from the upper left corner of `text`, on a ground that reaches a little beyond it.
fn draw_lines(
    image: &mut RgbImage,
    lettering: &Lettering,
    text: &Area,
    lines: &[impl AsRef<str>],
    paint: &Paint,
) {
    if lines.is_empty() {
        return;
    }
    let ground = text.shrunk(-padding(lettering));
    for y in ground.top..ground.top + ground.height {
        for x in ground.left..ground.left + ground.width {
            blend(image, x, y, paint.ground, paint.opacity);
        }
    }
    let tops = (0..).map(|k| text.top + k * i64::from(lettering.height()));
    for (line, top) in lines.iter().zip(tops) {
        lettering.write(image, (text.left, top), line.as_ref(), paint.ink, 1.0);
    }
}

/// Between the edge of a panel and its text, in pixels.
fn padding(lettering: &Lettering) -> i64 {
    i64::from(lettering.height()) / 3
}

/// The words of a message in lines of at most `capacity` letters, and at most [`BANNER_LINES`] of them.
fn wrapped(message: &str, capacity: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in message.split_whitespace() {
        let length = word.chars().count();
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + length <= capacity => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    let is_cut = lines.len() > BANNER_LINES;
    lines.truncate(BANNER_LINES);
    if let Some(last) = lines.last_mut().filter(|_| is_cut) {
        last.push_str(" ..");
    }
    let cut = |line: &String| {
        if line.chars().count() <= capacity { line.clone() } else { shortened(line, capacity) }
    };
    lines.iter().map(cut).collect()
}

/// A line of more than `capacity` letters, cut.
fn shortened(line: &str, capacity: usize) -> String {
    line.chars().take(capacity.saturating_sub(2)).chain("..".chars()).take(capacity).collect()
}

/// A rectangle of pixels.
#[derive(Clone, Copy)]
struct Area {
    left: i64,
    top: i64,
    width: i64,
    height: i64,
}

impl Area {
    fn around(image: &RgbImage) -> Self {
        Self { left: 0, top: 0, width: i64::from(image.width()), height: i64::from(image.height()) }
    }

    /// The rectangle without this many pixels at each side.
    fn shrunk(&self, by: i64) -> Self {
        let size = |size: i64| (size - 2 * by).max(0);
        Self { left: self.left + by, top: self.top + by, width: size(self.width), height: size(self.height) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    const GREY: Rgb<u8> = Rgb([200, 200, 200]);
    const NONE: [&str; 0] = [];

    fn grey(width: u32, height: u32) -> RgbImage {
        RgbImage::from_pixel(width, height, GREY)
    }

    /// The smallest rectangle around all that was drawn: left, top, right, bottom, the last two past it.
    fn drawn(image: &RgbImage) -> Option<[u32; 4]> {
        let changed = image.enumerate_pixels().filter(|(.., pixel)| **pixel != GREY);
        changed
            .map(|(x, y, _)| [x, y, x + 1, y + 1])
            .reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])])
    }

    #[test]
    fn a_panel_lies_in_its_corner_and_is_as_large_as_its_text() {
        // Letters of 7 x 13 pixels, 4 pixels around the text, and 4 to the border.
        let (width, height) = (640, 480);
        let corners = [
            (Corner::UpperLeft, [4, 4]),
            (Corner::UpperRight, [636 - 29, 4]),
            (Corner::LowerLeft, [4, 476 - 34]),
            (Corner::LowerRight, [636 - 29, 476 - 34]),
        ];
        for (corner, [left, top]) in corners {
            let mut image = grey(width, height);
            draw_panel(&mut image, corner, &["abc", "d"]);
            assert_eq!(drawn(&image), Some([left, top, left + 29, top + 34]), "{corner:?}");
        }
        let mut image = grey(width, height);
        draw_panel(&mut image, Corner::UpperLeft, &NONE);
        draw_banner(&mut image, Severity::Error, " ");
        assert_eq!(drawn(&image), None);
    }

    #[test]
    fn text_that_does_not_fit_is_cut_and_small_images_do_no_harm() {
        let lettering = Lettering::for_width(640);
        assert_eq!(lettering.fit("abcdef", 6 * 7), "abcdef");
        assert_eq!(lettering.fit("abcdef", 6 * 7 - 1), "abc..");
        assert_eq!((lettering.fit("abcdef", 7), lettering.fit("abcdef", 0)), (".".into(), "".into()));

        let long = "word ".repeat(200);
        for (width, height) in [(1, 1), (3, 200), (200, 3), (20, 20), (100, 40), (640, 480)] {
            let mut image = grey(width, height);
            draw_panel(&mut image, Corner::LowerRight, &[&long, &long, &long]);
            draw_banner(&mut image, Severity::Warning, &long);
        }
    }

    #[test]
    fn a_banner_breaks_between_words_and_its_fourth_line_is_the_last() {
        assert_eq!(wrapped("one two  three", 8), ["one two", "three"]);
        assert_eq!(wrapped("incomprehensible is", 8), ["incomp..", "is"]);
        assert_eq!(wrapped("a b c d e f", 1), ["a", "b", "c", "."]);
        assert_eq!(wrapped("aa bb cc dd ee", 5), ["aa bb", "cc dd", "ee"]);
        assert_eq!(wrapped("aa bb cc dd ee", 4), ["aa", "bb", "cc", "dd.."]);
    }

    #[test]
    fn banners_are_yellow_for_warnings_and_red_for_errors() {
        for (severity, is_warning) in [(Severity::Warning, true), (Severity::Error, false)] {
            let mut image = grey(640, 480);
            draw_banner(&mut image, severity, "camera cam3 is late");
            let [left, top, right, bottom] = drawn(&image).unwrap();
            assert_eq!((left, right, bottom, bottom - top), (4, 636, 476, 13 + 8));
            let Rgb([red, green, blue]) = *image.get_pixel(320, 470);
            assert!(red > 150 && blue < 80 && (green > 150) == is_warning, "{severity:?}");
        }
    }
}
