//! The text form of COLMAP's models: `cameras.txt` and `images.txt` (<https://colmap.github.io/format.html>).
//!
//! ```text
//! # cameras.txt: CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]
//! 1 OPENCV 640 480 500 501 320 240 -0.1 0.01 0 0
//! # images.txt: IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME, and a line of POINTS2D[] as (X, Y, POINT3D_ID)
//! 1 1 0 0 0 0.1 0.2 3 1 left.png
//! 12.5 300.1 -1
//! ```
//!
//! There is one view per image, in the file's order, named after the image. Poses are world to camera with OpenCV's
//! axes. The first pixel's centre is (0.5, 0.5). The scale of the world is arbitrary.

mod lens;

use super::format::{Format, Hints, PixelCentres, RawCalibration, RawCamera, RawLens};
use super::image_names;
use super::lines::{self, Line, is_number};
use super::source::{self, Source};
use crate::{Error, Result};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use std::collections::HashMap;
use std::path::PathBuf;

pub(super) const FORMAT: Format = Format { name: "COLMAP's cameras.txt and images.txt", recognise, read };

const CAMERAS: &str = "cameras.txt";
const IMAGES: &str = "images.txt";
const IMAGE: &str = "write IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME";
const EXPORT: &str =
    "export the model as text: colmap model_converter --input_path . --output_path . --output_type TXT";

/// How far a quaternion's length may be from 1: files carry at least six digits.
const UNIT_TOLERANCE: f64 = 1e-3;

/// A line of `images.txt`, before its camera is looked up.
struct Image<'a> {
    line: Line<'a>,
    camera: &'a str,
    name: String,
}

/// A camera of `cameras.txt`, which several images may share.
struct Intrinsics {
    size: (u32, u32),
    k: Matrix3<f64>,
    lens: RawLens,
}

fn recognise(source: &Source) -> bool {
    let Some(text) = source.text() else {
        return [CAMERAS, IMAGES, "cameras.bin", "images.bin"]
            .iter()
            .any(|name| source.beside(name).is_some());
    };
    let is_beside_cameras = || source.is_in_memory() || source.beside(CAMERAS).is_some();
    holds_cameras(text)
        || text.starts_with("# Image list with two lines of data per image")
        || first_line(text).is_some_and(|line| is_image(&line)) && is_beside_cameras()
}

/// Whether a text is the content of `cameras.txt`.
fn holds_cameras(text: &str) -> bool {
    first_line(text).is_some_and(|line| lens::is_camera(&line))
        || text.starts_with("# Camera list with one line of data per camera")
}

fn first_line(text: &str) -> Option<Line<'_>> {
    lines::lines(text).find(|line| !line.text.starts_with('#'))
}

/// Whether a line describes an image and is not a list of its points, which are triples of numbers.
fn is_image(line: &Line) -> bool {
    line.words.len() >= 10 && line.words[..9].iter().all(|word| is_number(word)) && !is_points(line)
}

fn is_points(line: &Line) -> bool {
    line.words.len().is_multiple_of(3) && line.words.iter().all(|word| is_number(word))
}

fn read(source: &Source, _: &Hints) -> Result<RawCalibration> {
    let [(cameras_path, cameras), (images_path, images)] = [file(source, CAMERAS)?, file(source, IMAGES)?];
    let mut lenses = lenses(&cameras).map_err(|e| Error::file(&cameras_path, e))?;
    for Intrinsics { lens, .. } in lenses.values_mut() {
        *lens = lens.clone().in_file(&cameras_path);
    }
    let cameras = views(&images, &lenses).map_err(|e| Error::file(images_path, e))?;
    Ok(RawCalibration {
        cameras,
        pixel_centres: PixelCentres::Half,
        metres_per_unit: None,
        notes: Vec::new(),
    })
}

/// Path and text of one of the two files: the opened one, or its neighbour.
fn file(source: &Source, name: &str) -> Result<(PathBuf, String)> {
    if let Some(text) = source.text().filter(|_| source.is_in_memory()) {
        return Err(source.lacks(if holds_cameras(text) { IMAGES } else { CAMERAS }, ""));
    }
    if let Some(path) = source.beside(name) {
        let text = source::read(&path)?;
        return Ok((path, text));
    }
    let binary = source.beside(&name.replace(".txt", ".bin")).is_some();
    Err(if binary {
        Error::file(&source.path, format!("expected {name}, found the binary form alone; {EXPORT}"))
    } else {
        source.lacks(name, &format!("put the model's files into one folder, or {EXPORT}"))
    })
}

/// The cameras of `cameras.txt` by their ids.
fn lenses(text: &str) -> Result<HashMap<&str, Intrinsics>> {
    let mut lenses = HashMap::new();
    for line in lines::lines(text).filter(|line| !line.text.starts_with('#')) {
        let id = line.words[0];
        if lenses.insert(id, lens::read(&line)?).is_some() {
            return Err(line.fail(format!("expected camera {id} once, found it again; remove one")));
        }
    }
    Ok(lenses)
}

/// One camera per image of `images.txt`.
fn views(text: &str, lenses: &HashMap<&str, Intrinsics>) -> Result<Vec<RawCamera>> {
    let mut images = images(text)?;
    if images.is_empty() {
        return Err(Error::argument("expected an image at least, found none; export the whole model"));
    }
    let paths: Vec<_> = images.iter().map(|image| image.name.as_str()).collect();
    let names = image_names::names(&paths);
    for (image, name) in images.iter_mut().zip(names) {
        image.name = name;
    }
    lines::distinct(images.iter().map(|image| image.name.as_str()), |i| images[i].line.number)?;
    images.iter().map(|image| view(image, lenses)).collect()
}

/// The image lines of `images.txt`.
fn images(text: &str) -> Result<Vec<Image<'_>>> {
    let mut images = Vec::new();
    for line in lines::lines(text).filter(|line| !line.text.starts_with('#')) {
        // A line of points follows each image's, and is often empty or left out.
        if !images.is_empty() && is_points(&line) {
            continue;
        }
        if !is_image(&line) {
            return Err(line.fail(format!("expected an image, found {} words; {IMAGE}", line.words.len())));
        }
        let name = line.words[9..].join(" ");
        images.push(Image { camera: line.words[8], name, line });
    }
    Ok(images)
}

/// The camera of one image: its pose, with the intrinsics it refers to.
fn view(image: &Image, lenses: &HashMap<&str, Intrinsics>) -> Result<RawCamera> {
    let Image { line, camera, name } = image;
    let numbers =
        line.words[1..8].iter().map(|word| line.number_in(word, IMAGE)).collect::<Result<Vec<_>>>()?;

    let quaternion = Quaternion::new(numbers[0], numbers[1], numbers[2], numbers[3]);
    let length = quaternion.norm();
    if (length - 1.0).abs() > UNIT_TOLERANCE {
        return Err(line.fail(format!(
            "expected a rotation as a quaternion of length 1, found length {length:.4}; {IMAGE}"
        )));
    }

    let Some(Intrinsics { size, k, lens }) = lenses.get(camera) else {
        let problem =
            format!("expected camera {camera} of this image in {CAMERAS}, found none; export both together");
        return Err(line.fail(problem));
    };

    Ok(RawCamera {
        name: name.clone(),
        size: Some(*size),
        k: *k,
        lens: lens.clone(),
        rotation: UnitQuaternion::new_normalize(quaternion),
        translation: Vector3::from_column_slice(&numbers[4..]),
    })
}

#[cfg(test)]
pub(super) mod tests;
