//! Reads the pose that belongs to a `camera_info` from a file beside it.

use super::super::document::{self, Node};
use super::super::source::{self, Source};
use super::at;
use crate::{Error, Result};
use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};
use std::path::Path;

/// How far a quaternion's length may be from 1: programs print as few as three digits.
const LENGTH_TOLERANCE: f64 = 5e-3;

const FORM: &str = "give translation: {x, y, z} and rotation: {x, y, z, w} of the camera's optical frame in the world, as \
                    tf2_echo prints them";

/// The world-to-camera pose of the camera called `name` whose file's stem is `stem`.
pub(super) fn of(source: &Source, stem: &str, name: &str) -> Result<(UnitQuaternion<f64>, Vector3<f64>)> {
    if let Some(own) = source.beside(&format!("{stem}_pose.yaml")) {
        return open(&own, cam_from_world).map_err(|e| at(&own, e));
    }

    let Some(shared) = source.beside("poses.yaml") else {
        return Err(Error::argument(format!(
            "expected its pose in {stem}_pose.yaml or, under `{name}`, in poses.yaml beside its file, found neither; {}",
            source.next_step(&format!("ROS keeps no poses in files: {FORM}"))
        )));
    };

    let of_camera = |document: &Node| {
        let entry = document.entry(name).or(document.entry(stem));
        let node = entry.map_or_else(|| document.require(name, FORM), Ok)?.node;
        cam_from_world(node)
    };
    open(&shared, of_camera).map_err(|e| at(&shared, e))
}

fn open<T>(path: &Path, read: impl FnOnce(&Node) -> Result<T>) -> Result<T> {
    read(&document::parse(&source::read(path)?)?)
}

/// The pose in a node, inverted to world to camera.
fn cam_from_world(node: &Node) -> Result<(UnitQuaternion<f64>, Vector3<f64>)> {
    let inner = ["transform", "pose"].iter().find_map(|key| node.entry(key)).map_or(node, |entry| entry.node);
    if ["transform", "pose"].iter().any(|key| inner.entry(key).is_some()) {
        return cam_from_world(inner);
    }

    let part = |keys: [&str; 2]| match inner.entry(keys[1]) {
        Some(entry) => Ok(entry.node),
        None => Ok::<_, Error>(inner.require(keys[0], FORM)?.node),
    };
    let (translation, rotation) = (part(["translation", "position"])?, part(["rotation", "orientation"])?);

    let number = |node: &Node, key: &str| node.require(key, FORM)?.number();
    let [x, y, z] = ["x", "y", "z"].map(|key| number(translation, key));
    let translation = Vector3::new(x?, y?, z?);
    let [i, j, k, w] = ["x", "y", "z", "w"].map(|key| number(rotation, key));
    let quaternion = Quaternion::new(w?, i?, j?, k?);

    if (quaternion.norm() - 1.0).abs() > LENGTH_TOLERANCE {
        return Err(Error::argument(format!(
            "line {}: expected a quaternion of length 1, found one of length {:.4}; {FORM}",
            rotation.line,
            quaternion.norm()
        )));
    }

    let world_from_cam =
        Isometry3::from_parts(translation.into(), UnitQuaternion::from_quaternion(quaternion));
    let cam_from_world = world_from_cam.inverse();
    Ok((cam_from_world.rotation, cam_from_world.translation.vector))
}
