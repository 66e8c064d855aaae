//! The names that people give to the parts of a camera, which OpenCV leaves to them.

use super::super::document::{Entry, Node, Value};
use crate::Result;

/// Names of one letter are taken as they are; of longer ones neither case nor `_` and `-` matter.
const MATRIX: &[&str] = &["cameramatrix", "intrinsicmatrix", "intrinsics", "intrinsic", "mtx", "K", "M"];
const DISTORTION: &[&str] = &[
    "distortioncoefficients",
    "distortioncoeffs",
    "distortioncoeff",
    "distortion",
    "distcoeffs",
    "distcoeff",
    "distcoefs",
    "distcoef",
    "dist",
    "D",
    "d",
];
const ROTATION: &[&str] =
    &["rotationmatrix", "rotationvector", "rotation", "rotmat", "rot", "rvec", "R", "r"];
const TRANSLATION: &[&str] = &["translationvector", "translation", "trans", "tvec", "T", "t"];
const MOTION: &[&str] = &["extrinsicmatrix", "extrinsics", "extrinsic", "camfromworld", "RT", "Rt"];
const WIDTH: &[&str] = &["imagewidth", "imgwidth", "width", "W", "w"];
const HEIGHT: &[&str] = &["imageheight", "imgheight", "height", "H", "h"];
const SIZE: &[&str] = &["imagesize", "imgsize", "resolution", "size"];
/// Lenses that OpenCV's samples mark by a key of their own, and the mirror parameter of its omnidirectional model.
const OTHER_LENS: &[&str] = &["fisheyemodel", "fisheye", "xi"];

/// The parts of one camera in a document, by whatever name.
pub(super) struct Keys<'a> {
    node: &'a Node,
    number: &'a str,
}

impl<'a> Keys<'a> {
    /// Of the names that end in `number`, which is empty where there is one camera.
    pub(super) fn new(node: &'a Node, number: &'a str) -> Self {
        Self { node, number }
    }

    /// The numbers that names of camera matrices end in, in the document's order.
    pub(super) fn numbers(node: &Node) -> Vec<String> {
        let mut numbers: Vec<String> = Vec::new();
        for entry in node.entries() {
            let number = &entry.key[entry.key.trim_end_matches(|c: char| c.is_ascii_digit()).len()..];
            let parts = Keys::new(node, number);
            let is_part = !number.is_empty()
                && [parts.matrix(), parts.rotation(), parts.translation()].iter().flatten().count() > 0;
            if is_part && !numbers.iter().any(|known| known == number) {
                numbers.push(number.to_owned());
            }
        }
        numbers
    }

    pub(super) fn matrix(&self) -> Option<Entry<'a>> {
        self.find(MATRIX).filter(is_matrix)
    }

    pub(super) fn distortion(&self) -> Option<Entry<'a>> {
        self.find(DISTORTION).filter(is_matrix)
    }

    pub(super) fn rotation(&self) -> Option<Entry<'a>> {
        self.find(ROTATION).filter(is_matrix)
    }

    pub(super) fn translation(&self) -> Option<Entry<'a>> {
        self.find(TRANSLATION).filter(is_matrix)
    }

    pub(super) fn motion(&self) -> Option<Entry<'a>> {
        self.find(MOTION).filter(is_matrix)
    }

    pub(super) fn size(&self) -> Result<Option<(u32, u32)>> {
        match (self.find(WIDTH), self.find(HEIGHT)) {
            (Some(width), Some(height)) => Ok(Some((width.pixels()?, height.pixels()?))),
            _ => self.find(SIZE).map(|entry| entry.size()).transpose(),
        }
    }

    pub(super) fn refuse_other_lenses(&self) -> Result<()> {
        let Some(entry) = self.find(OTHER_LENS) else { return Ok(()) };
        let off = ["0", "0.", "0.0", "false"];
        match &entry.node.value {
            Value::Scalar(text) if off.contains(&text.to_ascii_lowercase().as_str()) => Ok(()),
            _ => Err(entry.fail(
                "expected a pinhole with OpenCV's polynomial lens, found a fisheye or mirror, which are not supported \
                 yet; undistort the images first and calibrate them as a pinhole",
            )),
        }
    }

    fn find(&self, names: &[&str]) -> Option<Entry<'a>> {
        let matches = |entry: &Entry| {
            let stem = entry.key.strip_suffix(self.number)?.trim_end_matches('_');
            if stem.ends_with(|c: char| c.is_ascii_digit()) {
                return None; // Of another number, which ends in this one.
            }
            let plain = stem.replace(['_', '-', ' '], "").to_ascii_lowercase();
            let is_one = |name: &&str| **name == *(if name.len() <= 2 { stem } else { &plain });
            names.iter().position(is_one)
        };
        // The first of the names that there is, since some files have several (a matrix and a vector).
        self.node
            .entries()
            .filter_map(|entry| Some((matches(&entry)?, entry)))
            .min_by_key(|(i, _)| *i)
            .map(|(_, e)| e)
    }
}

/// A list or a matrix, and no single number such as a coefficient `k1`.
fn is_matrix(entry: &Entry) -> bool {
    match &entry.node.value {
        Value::Sequence(_) => true,
        Value::Map(_) => entry.node.entry("data").is_some() || entry.node.entry("rows").is_some(),
        Value::Scalar(_) => false,
    }
}
