//! The calibration that Qualisys Track Manager exports (`.qca.txt`, XML).
//!
//! ```xml
//! <calibration><cameras>
//!   <camera active="1" serial="26580" model="Miqus Video" viewrotation="0">
//!     <fov_video left="0" top="0" right="1919" bottom="1087"/>
//!     <transform x="4263.3" y="2283.8" z="1794.3" r11="1" r12="0" .. r33="1"/>
//!     <intrinsic focalLengthU="107872.6" focalLengthV=".." centerPointU="60827.2" centerPointV=".." skew="0"
//!       radialDistortion1="-0.045" radialDistortion2=".." radialDistortion3="0"
//!       tangentalDistortion1="0.0006" tangentalDistortion2=".."/>
//!   </camera></cameras></calibration>
//! ```
//!
//! Intrinsic parameters are in 1/64 px of the whole sensor, of which the images are the part `fov_video`; distortion
//! has no unit and is OpenCV's. `x y z` is the camera's centre in millimetres; its axes point right, up and backwards,
//! so that with the matrix M of `r11 .. r33` `x_cam = diag(1, -1, -1) M (X - C)`. The export does not specify pixel
//! centres; whole numbers are assumed, as in Pose2Sim. A camera is named by its serial number.

use super::format::{Format, Hints, PixelCentres, RawCalibration, RawCamera, pixels};
use super::source::Source;
use super::{document, lines, pose};
use crate::camera::Distortion;
use crate::{Error, Result};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use roxmltree::{Document, Node};

pub(super) const FORMAT: Format = Format { name: "Qualisys' .qca.txt", recognise, read };

const EXPORT: &str = "export the calibration from Qualisys Track Manager again";
const MILLIMETRE: f64 = 0.001;
/// Units of the intrinsic parameters per pixel.
const SUBPIXELS: f64 = 64.0;
/// Rows of the sensor's full resolution; `video_resolution="540p"` is half of it.
const FULL_RESOLUTION: f64 = 1080.0;

fn recognise(source: &Source) -> bool {
    let text = source.text().unwrap_or_default();
    text.contains("<calibration") && (text.contains("qtm-version") || text.contains("focalLengthU"))
}

fn read(source: &Source, _: &Hints) -> Result<RawCalibration> {
    let document = document::open_xml(source.text().unwrap_or_default())?;
    let all: Vec<_> = document
        .descendants()
        .filter(|node| node.has_tag_name("camera"))
        .map(|node| Element { document: &document, node })
        .collect();

    let mut notes = Vec::new();
    let cameras = used(&all, &mut notes)?;
    if cameras.is_empty() {
        let found = all.len();
        return Err(Error::argument(format!(
            "expected a calibrated camera at least, found {found} <camera> of which none is; {EXPORT}"
        )));
    }

    let names = cameras.iter().map(|camera| camera.text("serial")).collect::<Result<Vec<_>>>()?;
    lines::distinct(names, |i| cameras[i].line())?;

    Ok(RawCalibration {
        cameras: cameras.iter().map(|camera| found(camera, &mut notes)).collect::<Result<_>>()?,
        pixel_centres: PixelCentres::Whole,
        metres_per_unit: Some(MILLIMETRE),
        notes,
    })
}

/// The calibrated cameras; if the system has video cameras, only those.
fn used<'a>(all: &[Element<'a>], notes: &mut Vec<String>) -> Result<Vec<Element<'a>>> {
    let is_video =
        |camera: &Element| camera.node.attribute("model").is_some_and(|model| model.contains("Video"));
    let off = |camera: &Element| {
        camera.node.attribute("active") == Some("0") || camera.node.attribute("calibrated") == Some("false")
    };

    let some_video = all.iter().any(is_video);

    let mut cameras = Vec::new();
    for camera in all {
        let why = if off(camera) {
            "is not calibrated"
        } else if some_video && !is_video(camera) {
            "records no video"
        } else {
            cameras.push(*camera);
            continue;
        };
        notes.push(format!("camera {} is left out: it {why}", camera.text("serial")?));
    }
    Ok(cameras)
}

/// One camera, with its part of the sensor and its resolution taken into account.
fn found(camera: &Element, notes: &mut Vec<String>) -> Result<RawCamera> {
    let name = camera.text("serial")?.to_owned();
    match camera.node.attribute("viewrotation") {
        None | Some("0") => {}
        Some(angle) => notes.push(format!(
            "camera {name} is displayed rotated by {angle} degrees; its calibration is for the images as the sensor records them"
        )),
    }

    let fov = camera.child("fov_video").or_else(|_| camera.child("fov_marker"))?;
    let (left, top) = (fov.number("left")?, fov.number("top")?);
    let size = [fov.number("right")? - left + 1.0, fov.number("bottom")? - top + 1.0];

    let scale = match camera.node.attribute("video_resolution") {
        None | Some("") => 1.0,
        Some(rows) => {
            let rows = rows.trim_end_matches('p').parse::<f64>().ok().filter(|rows| *rows > 0.0);
            let problem = "expected a video_resolution like 1080p, found another; write that of the images";
            rows.ok_or_else(|| camera.fail(problem))? / FULL_RESOLUTION
        }
    };
    let [width, height] = size.map(|side| (side * scale).round());
    let (Some(width), Some(height)) = (pixels(width), pixels(height)) else {
        return Err(
            fov.fail(format!("expected an image of 1 to 65535 pixels, found {width} x {height}; {EXPORT}"))
        );
    };

    let intrinsic = camera.child("intrinsic")?;
    let transform = camera.child("transform")?;
    let rotation = rotation(&transform)?;
    let centre = Vector3::new(transform.number("x")?, transform.number("y")?, transform.number("z")?);

    Ok(RawCamera {
        name,
        size: Some((width, height)),
        k: intrinsics(&intrinsic, left, top, scale)?,
        lens: distortion(&intrinsic)?.into(),
        translation: -(rotation * centre),
        rotation,
    })
}

/// The intrinsic matrix of the images: the sensor's, cropped and scaled.
fn intrinsics(intrinsic: &Element, left: f64, top: f64, scale: f64) -> Result<Matrix3<f64>> {
    let pixels = |name| Ok::<_, Error>(intrinsic.number(name)? / SUBPIXELS);
    let [fx, fy, skew] =
        [pixels("focalLengthU")?, pixels("focalLengthV")?, pixels("skew")?].map(|length| length * scale);
    // Scaling keeps the image's corner, which lies half a pixel before the first pixel's centre.
    let scaled = |centre: f64| (centre + 0.5) * scale - 0.5;
    let (cx, cy) = (scaled(pixels("centerPointU")? - left), scaled(pixels("centerPointV")? - top));
    Ok(Matrix3::new(fx, skew, cx, 0.0, fy, cy, 0.0, 0.0, 1.0))
}

fn distortion(intrinsic: &Element) -> Result<Distortion> {
    let names = [
        "radialDistortion1",
        "radialDistortion2",
        "tangentalDistortion1",
        "tangentalDistortion2",
        "radialDistortion3",
    ];
    let coefficients = names.map(|name| intrinsic.number(name));
    Distortion::from_opencv(&coefficients.into_iter().collect::<Result<Vec<_>>>()?)
}

fn rotation(transform: &Element) -> Result<UnitQuaternion<f64>> {
    let names = ["r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"];
    let numbers: Vec<_> = names.iter().map(|name| transform.number(name)).collect::<Result<_>>()?;
    let rotation = pose::rotation(&Matrix3::from_row_slice(&numbers))
        .map_err(|problem| transform.fail(format!("r11 .. r33: {problem}")))?;
    Ok(pose::opengl_axes() * rotation)
}

/// An XML element, with the document for the line in its error messages.
#[derive(Clone, Copy)]
struct Element<'a> {
    document: &'a Document<'a>,
    node: Node<'a, 'a>,
}

impl<'a> Element<'a> {
    fn child(&self, tag: &str) -> Result<Self> {
        let node = self.node.children().find(|node| node.has_tag_name(tag));
        let node =
            node.ok_or_else(|| self.fail(format!("expected a <{tag}> in it, found none; {EXPORT}")))?;
        Ok(Self { document: self.document, node })
    }

    fn text(&self, name: &str) -> Result<&'a str> {
        let found = self.node.attribute(name);
        found.ok_or_else(|| self.fail(format!("expected an attribute {name}, found none; {EXPORT}")))
    }

    fn number(&self, name: &str) -> Result<f64> {
        let text = self.text(name)?;
        text.trim().parse::<f64>().ok().filter(|number| number.is_finite()).ok_or_else(|| {
            self.fail(format!("expected a finite number in {name}, found \"{text}\"; {EXPORT}"))
        })
    }

    fn line(&self) -> usize {
        self.document.text_pos_at(self.node.range().start).row as usize
    }

    fn fail(&self, problem: impl std::fmt::Display) -> Error {
        Error::argument(format!("line {}, <{}>: {problem}", self.line(), self.node.tag_name().name()))
    }
}

#[cfg(test)]
pub(super) mod tests;
