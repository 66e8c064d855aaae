//! `transforms.json` of nerfstudio and instant-ngp (<https://docs.nerf.studio/quickstart/data_conventions.html>).
//!
//! ```json
//! {"camera_model": "OPENCV", "fl_x": 1072.0, "fl_y": 1068.0, "cx": 752.0, "cy": 500.0, "w": 1504, "h": 1000,
//!  "k1": 0.03, "k2": -0.01, "p1": 0.0, "p2": 0.0,
//!  "frames": [{"file_path": "images/left.png",
//!              "transform_matrix": [[1, 0, 0, 0.1], [0, 1, 0, 0.2], [0, 0, 1, 3.0], [0, 0, 0, 1]]}]}
//! ```
//!
//! There is one view per frame, named after its image; each intrinsic parameter stands at the top or in the frame. The
//! matrix maps camera to world, with OpenGL's camera axes (x right, y up, z backward). Without `fl_x`,
//! `camera_angle_x` is the horizontal field of view in radians; without `cx` and `cy` the principal point is the
//! image's centre. The first pixel's centre is (0.5, 0.5), as in nerfstudio's rays and in COLMAP, the usual source of
//! such files. The scale of the world is arbitrary.

use super::document::{self, Entry, Node};
use super::format::{Format, Hints, LensModel, PixelCentres, RawCalibration, RawCamera, RawLens};
use super::source::Source;
use super::{image_names, lines, pose};
use crate::{Error, MissingHint, Result};
use nalgebra::Matrix3;

pub(super) const FORMAT: Format = Format { name: "nerfstudio's transforms.json", recognise, read };

const FRAME: &str = "write file_path and transform_matrix for each frame";
const INTRINSICS: &str = "write fl_x, fl_y, cx, cy, w and h at the top or in each frame";
const UNDISTORT: &str = "undistort the images first, and write PINHOLE";

fn recognise(source: &Source) -> bool {
    let has = |key: &str| source.json().is_some_and(|text| text.contains(&format!("\"{key}\"")));
    has("transform_matrix") || has("frames") && has("fl_x")
}

fn read(source: &Source, hints: &Hints) -> Result<RawCalibration> {
    let document = document::parse(source.text().unwrap_or_default())?;
    let frames = document.require("frames", FRAME)?.items()?;
    let paths: Vec<_> =
        frames.iter().map(|frame| frame.require("file_path", FRAME)).collect::<Result<_>>()?;
    let names = image_names::names(&paths.iter().map(Entry::text).collect::<Result<Vec<_>>>()?);
    lines::distinct(names.iter().map(String::as_str), |i| frames[i].node.line)?;

    let view = |(frame, name): (&Entry, String)| FrameEntry { frame, document: &document, name }.found(hints);
    Ok(RawCalibration {
        cameras: frames.iter().zip(names).map(view).collect::<Result<_>>()?,
        pixel_centres: PixelCentres::Half,
        metres_per_unit: None,
        notes: Vec::new(),
    })
}

/// A frame, with the document that holds the common intrinsics.
struct FrameEntry<'a> {
    frame: &'a Entry<'a>,
    document: &'a Node,
    name: String,
}

impl<'a> FrameEntry<'a> {
    /// The camera of this frame.
    fn found(self, hints: &Hints) -> Result<RawCamera> {
        let size = self.size()?;
        let k = self.intrinsics(size.or(hints.size))?;

        let lens = self.lens()?;
        let (world_from_opengl, centre) = self.frame.require("transform_matrix", FRAME)?.motion()?;
        let rotation = pose::opengl_axes() * world_from_opengl.inverse();
        Ok(RawCamera { name: self.name, size, k, lens, rotation, translation: -(rotation * centre) })
    }

    /// The lens of this frame; refuses coefficients that its model does not have.
    fn lens(&self) -> Result<RawLens> {
        let model = self.lens_model()?;

        // The k4 of a polynomial lens in nerfstudio is the next power of the polynomial, not OpenCV's k4.
        let (used, unused) = match model {
            LensModel::OpenCv => (["k1", "k2", "p1", "p2", "k3"].as_slice(), ["k4"].as_slice()),
            LensModel::Fisheye => (["k1", "k2", "k3", "k4"].as_slice(), ["p1", "p2"].as_slice()),
        };

        for &key in unused {
            if let Some(entry) = self.find(key)
                && entry.number()? != 0.0
            {
                let used = used.join(", ");
                return Err(entry.fail(format!("expected a lens of {used}, found a {key}; {UNDISTORT}")));
            }
        }

        let coefficient = |key: &&str| Ok(self.number(key)?.unwrap_or_default());
        let coefficients = used.iter().map(coefficient).collect::<Result<Vec<_>>>()?;
        let place = self.find("k1").map_or_else(|| self.frame.place(), |entry| entry.place());
        RawLens::new(model, &coefficients, place)
    }

    /// The lens model by `camera_model` or instant-ngp's `is_fisheye`; if both exist they have to agree.
    fn lens_model(&self) -> Result<LensModel> {
        let of_flag = |entry: &Entry| if entry.is_true() { LensModel::Fisheye } else { LensModel::OpenCv };
        let flag = self.find("is_fisheye");
        let Some(entry) = self.find("camera_model") else {
            return Ok(flag.as_ref().map_or(LensModel::OpenCv, of_flag));
        };

        let model = match entry.text()? {
            "OPENCV" | "PINHOLE" | "SIMPLE_PINHOLE" | "PERSPECTIVE" => LensModel::OpenCv,
            "OPENCV_FISHEYE" => LensModel::Fisheye,
            other => {
                let expected = "expected OPENCV, OPENCV_FISHEYE or PINHOLE";
                return Err(entry.fail(format!("{expected}, found {other}; {UNDISTORT}")));
            }
        };

        match flag.filter(|flag| of_flag(flag) != model) {
            Some(flag) => {
                let found = entry.text()?;
                Err(flag
                    .fail(format!("expected it to agree with `camera_model`, found {found}; correct one")))
            }
            None => Ok(model),
        }
    }

    fn size(&self) -> Result<Option<(u32, u32)>> {
        match (self.find("w"), self.find("h")) {
            (Some(width), Some(height)) => Ok(Some((width.pixels()?, height.pixels()?))),
            _ => Ok(None),
        }
    }

    fn intrinsics(&self, size: Option<(u32, u32)>) -> Result<Matrix3<f64>> {
        let size = size.map(|(width, height)| [f64::from(width), f64::from(height)]);
        let angle = |key| Ok::<_, Error>(self.number(key)?.map(|angle| (angle / 2.0).tan()));
        let focal = |length, angle_tangent: Option<f64>, axis: usize| {
            let by_angle = || Some(size?[axis] / 2.0 / angle_tangent?);
            Ok::<_, Error>(self.number(length)?.or_else(by_angle))
        };

        let fx = focal("fl_x", angle("camera_angle_x")?, 0)?;
        let fy = focal("fl_y", angle("camera_angle_y")?, 1)?.or(fx);

        let middle = |axis: usize| size.map(|size| size[axis] / 2.0);
        let cx = self.number("cx")?.or_else(|| middle(0));
        let cy = self.number("cy")?.or_else(|| middle(1));

        match (fx, fy, cx, cy) {
            (Some(fx), Some(fy), Some(cx), Some(cy)) => {
                Ok(Matrix3::new(fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0))
            }
            _ => {
                let problem = "expected focal lengths and a principal point, found too little to know them";
                match size {
                    Some(_) => Err(self.frame.fail(format!("{problem}; {INTRINSICS}"))),
                    None => {
                        let e = self.frame.fail(format!("{problem}; {INTRINSICS}, or give width and height"));
                        Err(Error::missing_hint(MissingHint::Size, e))
                    }
                }
            }
        }
    }

    fn number(&self, key: &str) -> Result<Option<f64>> {
        self.find(key).map(|entry| entry.number()).transpose()
    }

    /// The value of `key` in the frame, else in the document.
    fn find(&self, key: &str) -> Option<Entry<'a>> {
        self.frame.entry(key).or_else(|| self.document.entry(key))
    }
}

#[cfg(test)]
pub(super) mod tests;
