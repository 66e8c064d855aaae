//! Tours: the viewpoint of a film over time, from keyframes in a TOML file.
//!
//! ```toml
//! [[key]]
//! time = 0.0                  # seconds of the film
//! eye = [2.5, 1.0, 1.5]       # metres, world
//! target = [0.0, 0.0, 0.8]
//! field_of_view = 50.0        # horizontal, in degrees; 50 where it is missing
//!
//! [[key]]
//! time = 4.0
//! azimuth = 180.0             # instead of an eye: around the target, in degrees counter-clockwise from +x
//! elevation = 20.0
//! distance = 3.0
//! target = [0.0, 0.0, 0.8]
//!
//! [[key]]
//! time = 6.0
//! camera = "cam01"            # the place and direction of a real camera
//! ```

use crate::orbit::Orbit;
use nalgebra::Point3;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::Aabb;
use ode_visual_hull::{Error, Result};
use serde::Deserialize;
use std::f64::consts::TAU;
use std::path::Path;

/// Horizontal angle of view of a key that has none, in degrees.
const FIELD_OF_VIEW: f64 = 50.0;

/// The viewpoint over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Tour {
    /// Times in seconds, which increase, and viewpoints, whose azimuths change by less than half a turn from one to the next.
    keys: Vec<(f64, Orbit)>,
}

/// A tour's file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TourFile {
    key: Vec<Key>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Key {
    time: f64,
    camera: Option<String>,
    eye: Option<[f64; 3]>,
    target: Option<[f64; 3]>,
    azimuth: Option<f64>,
    elevation: Option<f64>,
    distance: Option<f64>,
    field_of_view: Option<f64>,
}

impl Tour {
    /// The tour in the file at `path`. Keys that name a camera take its place and direction from `cameras`; the middle of
    /// `subject` tells how far away they look.
    ///
    /// # Errors
    /// A file that cannot be read or is no tour: the error names the key.
    pub fn read(path: &Path, cameras: &[Camera], subject: &Aabb) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|e| {
            Error::file(path, format!("expected a tour, a TOML file with [[key]] tables, found: {e}"))
        })?;
        Self::parse(&text, cameras, subject).map_err(|problem| Error::file(path, problem))
    }

    fn parse(text: &str, cameras: &[Camera], subject: &Aabb) -> std::result::Result<Self, String> {
        let file: TourFile =
            toml::from_str(text).map_err(|e| format!("expected a tour with [[key]] tables: {e}"))?;
        let mut keys: Vec<(f64, Orbit)> = Vec::new();
        for (number, key) in (1..).zip(&file.key) {
            let orbit = key.orbit(cameras, subject).map_err(|problem| format!("key {number}: {problem}"))?;
            let last = keys.last();
            if !key.time.is_finite() || last.is_some_and(|(time, _)| key.time <= *time) {
                return Err(format!(
                    "key {number}: expected a time in seconds after that of the key before, found {}",
                    key.time
                ));
            }
            keys.push((key.time, last.map_or(orbit, |(_, before)| orbit.unwound_towards(before))));
        }
        if keys.is_empty() {
            return Err("expected at least one [[key]], found none".into());
        }
        Ok(Self { keys })
    }

    /// One turn around `subject` in `duration` seconds, from the azimuth `start` in radians.
    pub fn circle(subject: &Aabb, start: f64, duration: f64) -> Self {
        let orbit = |turn: f64| Orbit::around(subject, start + turn * TAU);
        // Keys a quarter apart, so that the turn is even but for its ends.
        Self {
            keys: (0..=4).map(|k| 0.25 * f64::from(k)).map(|turn| (turn * duration, orbit(turn))).collect(),
        }
    }

    /// The viewpoint at `time`: through all keys, and smooth between them (cubic, Catmull and Rom 1974); before the first
    /// and after the last key it stands still.
    pub fn at(&self, time: f64) -> Orbit {
        let next = self.keys.partition_point(|(at, _)| *at <= time);
        if next == 0 || next == self.keys.len() {
            return self.keys[next.saturating_sub(1)].1;
        }
        let key = |k: usize| &self.keys[k.min(self.keys.len() - 1)];
        let around = [key(next.saturating_sub(2)), key(next - 1), key(next), key(next + 1)];
        let numbers = around.map(|(at, orbit)| (*at, numbers(orbit)));
        let [target_x, target_y, target_z, azimuth, elevation, log_distance, field_of_view] =
            std::array::from_fn(|k| smooth(&numbers.each_ref().map(|(at, numbers)| (*at, numbers[k])), time));
        Orbit {
            target: Point3::new(target_x, target_y, target_z),
            azimuth,
            elevation,
            distance: log_distance.exp(),
            field_of_view,
        }
    }
}

impl Key {
    fn orbit(&self, cameras: &[Camera], subject: &Aabb) -> std::result::Result<Orbit, String> {
        let numbers = [self.azimuth, self.elevation, self.distance, self.field_of_view];
        let places = self.eye.into_iter().chain(self.target).flatten();
        if numbers.into_iter().flatten().chain(places).any(|number| !number.is_finite()) {
            return Err("expected finite numbers, found nan or inf".into());
        }
        let field_of_view = self.field_of_view.unwrap_or(FIELD_OF_VIEW);
        if !(1.0..=150.0).contains(&field_of_view) {
            return Err(format!("field_of_view: expected 1 to 150 degrees, found {field_of_view}"));
        }
        let field_of_view = field_of_view.to_radians();
        let target = self.target.map_or(subject.centre(), Point3::from);
        let orbit = match (&self.camera, self.eye, self.azimuth, self.distance) {
            (Some(name), None, None, None) => self.of_camera(name, cameras, subject)?,
            (None, Some(eye), None, None) => Orbit::from_eye(&eye.into(), &target, field_of_view),
            (None, None, Some(azimuth), Some(distance)) => Orbit {
                target,
                azimuth: azimuth.to_radians(),
                elevation: self.elevation.unwrap_or(0.0).to_radians(),
                distance,
                field_of_view,
            },
            _ => return Err("expected either eye, or azimuth and distance, or camera".into()),
        };
        if orbit.distance <= 0.0 {
            return Err("expected an eye away from the target, found both at one place".into());
        }
        Ok(orbit)
    }

    fn of_camera(
        &self,
        name: &str,
        cameras: &[Camera],
        subject: &Aabb,
    ) -> std::result::Result<Orbit, String> {
        let Some(camera) = cameras.iter().find(|camera| camera.name() == name) else {
            let names: Vec<_> = cameras.iter().map(Camera::name).collect();
            return Err(format!("camera: expected one of {}, found {name}", names.join(", ")));
        };
        let depth = (subject.centre() - camera.centre()).dot(&camera.forward()).max(0.1);
        let target = camera.centre() + depth * camera.forward();
        let half_width = 0.5 * f64::from(camera.size().0) / camera.intrinsics()[(0, 0)];
        let of_camera = 2.0 * half_width.atan();
        let field_of_view = self.field_of_view.map_or(of_camera, f64::to_radians);
        Ok(Orbit::from_eye(&camera.centre(), &target, field_of_view))
    }
}

/// The numbers of a viewpoint between which there is a straight way.
fn numbers(orbit: &Orbit) -> [f64; 7] {
    let Orbit { target, azimuth, elevation, distance, field_of_view } = *orbit;
    [target.x, target.y, target.z, azimuth, elevation, distance.ln(), field_of_view]
}

/// The value at `time` of the cubic through the second and third of four points in time, whose slopes there are those between
/// their neighbours.
fn smooth(points: &[(f64, f64); 4], time: f64) -> f64 {
    let [before, from, to, after] = *points;
    let length = to.0 - from.0;
    let slope = |a: (f64, f64), b: (f64, f64)| (b.1 - a.1) / (b.0 - a.0) * length;
    // The viewpoint is at rest at the first and at the last key.
    let leaves = if before == from { 0.0 } else { slope(before, to) };
    let arrives = if after == to { 0.0 } else { slope(from, after) };
    let s = (time - from.0) / length;
    let (s2, s3) = (s * s, s * s * s);
    from.1 * (2.0 * s3 - 3.0 * s2 + 1.0)
        + leaves * (s3 - 2.0 * s2 + s)
        + to.1 * (3.0 * s2 - 2.0 * s3)
        + arrives * (s3 - s2)
}

#[cfg(test)]
mod tests;
