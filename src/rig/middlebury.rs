//! `*_par.txt` of the multi-view stereo sets of Middlebury (Seitz, Curless, Diebel, Scharstein, Szeliski: A
//! comparison and evaluation of multi-view stereo reconstruction algorithms, 2006).
//!
//! ```text
//! 2
//! left.png  k11 k12 k13 k21 k22 k23 k31 k32 k33  r11 .. r33  t1 t2 t3
//! right.png ...
//! ```
//!
//! The first line is the number of images, followed by a line for each: `P = K [R t]`, world to camera, OpenCV's axes,
//! no distortion, metres. Pixel centres are taken as whole numbers: the data sets do not specify it, but the
//! dinosaur's silhouettes are then more consistent (with pixel corners their hull is 0.3 % smaller). A camera is named
//! after its image, without the extension. Image sizes are read from the images, beside the file or in `image/` beside
//! it.

use super::format::{Format, Hints, PixelCentres, RawCalibration, RawCamera, RawLens};
use super::lines::{self, Line, is_number};
use super::source::Source;
use super::{image_names, pose};
use crate::{Error, Result};
use nalgebra::{Matrix3, Vector3};

pub(super) const FORMAT: Format = Format { name: "Middlebury's _par.txt", recognise, read };

const LINE: &str = "write a line `image k11 .. k33 r11 .. r33 t1 t2 t3` for each";

/// Whether the first line is a single count and the next a name followed by numbers.
fn recognise(source: &Source) -> bool {
    let mut lines = lines::lines(source.text().unwrap_or_default());
    let count = lines.next().is_some_and(|line| count(&line).is_some());
    let camera =
        |line: Line| !is_number(line.words[0]) && line.words.get(1).is_some_and(|word| is_number(word));
    count && lines.next().is_some_and(camera)
}

fn count(line: &Line) -> Option<usize> {
    if let [word] = line.words[..] { word.parse().ok() } else { None }
}

fn read(source: &Source, _: &Hints) -> Result<RawCalibration> {
    let mut lines = lines::lines(source.text().unwrap_or_default());
    let expected = lines.next().and_then(|line| count(&line)).unwrap_or_default();
    let lines: Vec<_> = lines.collect();
    if lines.len() != expected {
        let found = lines.len();
        return Err(Error::argument(format!(
            "line 1: expected as many cameras as this line says, {expected}, found {found}; {LINE}, or fetch the \
             whole file"
        )));
    }

    let images: Vec<_> = lines.iter().map(|line| line.words[0]).collect();
    let names = image_names::names(&images);
    lines::distinct(names.iter().map(String::as_str), |i| lines[i].number)?;

    let cameras = lines.iter().zip(names).map(|(line, name)| camera(source, line, name));
    Ok(RawCalibration {
        cameras: cameras.collect::<Result<_>>()?,
        pixel_centres: PixelCentres::Whole,
        metres_per_unit: Some(1.0),
        notes: Vec::new(),
    })
}

fn camera(source: &Source, line: &Line, name: String) -> Result<RawCamera> {
    let numbers: [f64; 21] = line.numbers(1, LINE)?;
    let rotation = pose::rotation(&Matrix3::from_row_slice(&numbers[9..18]))
        .map_err(|problem| line.fail(format!("rotation r11 .. r33: {problem}")))?;

    let image = line.words[0];
    let size = match source.image_size(image)? {
        None => source.image_size(&format!("image/{image}"))?,
        found => found,
    };

    Ok(RawCamera {
        name,
        size,
        k: Matrix3::from_row_slice(&numbers[..9]),
        lens: RawLens::none(),
        rotation,
        translation: Vector3::from_row_slice(&numbers[18..]),
    })
}

#[cfg(test)]
pub(super) mod tests;
