//! The key names in common use for the parts of a camera; OpenCV leaves them to the program that writes the file.

use super::super::document::{Entry, Node, Value};
use crate::Result;

/// Names of up to two letters match exactly; longer ones match regardless of case, `_`, `-` and spaces.
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
/// Keys that mark a fisheye lens, in OpenCV's calibration sample and in other programs.
const FISHEYE: &[&str] = &["fisheyemodel", "fisheye"];
/// The mirror parameter of OpenCV's omnidirectional model.
const MIRROR: &[&str] = &["xi"];

const OFF: &[&str] = &["0", "0.", "0.0", "false"];
const ON: &[&str] = &["1", "1.", "1.0", "true"];

/// The parts of one camera in a document, found by their common names.
pub(super) struct Keys<'a> {
    node: &'a Node,
    /// The number that all names of this camera end in; empty where there is one camera.
    number: &'a str,
}

impl<'a> Keys<'a> {
    /// The parts whose names end in `number`, which is empty where there is one camera.
    pub(super) fn new(node: &'a Node, number: &'a str) -> Self {
        Self { node, number }
    }

    /// The distinct numbers at the end of key names, in the document's order.
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

    /// The entry that marks the lens as a fisheye; `None` for OpenCV's polynomial model.
    ///
    /// # Errors
    /// A mirror lens, which is not supported; a mark that is neither on nor off.
    pub(super) fn fisheye(&self) -> Result<Option<Entry<'a>>> {
        let value = |entry: &Entry| match &entry.node.value {
            Value::Scalar(text) => text.to_ascii_lowercase(),
            _ => String::new(),
        };
        if let Some(entry) = self.find(MIRROR).filter(|entry| !OFF.contains(&value(entry).as_str())) {
            return Err(entry.fail(
                "expected a pinhole or a fisheye, found a mirror, which is not supported yet; undistort the images \
                 first and calibrate them as a pinhole",
            ));
        }

        let Some(entry) = self.find(FISHEYE) else { return Ok(None) };
        match value(&entry).as_str() {
            value if OFF.contains(&value) => Ok(None),
            value if ON.contains(&value) => Ok(Some(entry)),
            _ => Err(entry.fail(format!(
                "expected 1 or true for a fisheye, 0 or false for a polynomial lens, found {}; write one of these",
                entry.node.outline()
            ))),
        }
    }

    /// The entry under the most preferred of `names`: some files have several forms, such as a matrix and a vector.
    fn find(&self, names: &[&str]) -> Option<Entry<'a>> {
        let matches = |entry: &Entry| {
            let stem = entry.key.strip_suffix(self.number)?.trim_end_matches('_');
            if stem.ends_with(|c: char| c.is_ascii_digit()) {
                return None; // Belongs to a longer number, such as 11 where `number` is 1.
            }
            let plain = stem.replace(['_', '-', ' '], "").to_ascii_lowercase();
            let is_one = |name: &&str| **name == *(if name.len() <= 2 { stem } else { &plain });
            names.iter().position(is_one)
        };

        self.node
            .entries()
            .filter_map(|entry| Some((matches(&entry)?, entry)))
            .min_by_key(|(i, _)| *i)
            .map(|(_, e)| e)
    }
}

/// Whether an entry is a list or a matrix instead of a single number such as a coefficient `k1`.
fn is_matrix(entry: &Entry) -> bool {
    match &entry.node.value {
        Value::Sequence(_) => true,
        Value::Map(_) => entry.node.entry("data").is_some() || entry.node.entry("rows").is_some(),
        Value::Scalar(_) => false,
    }
}
