//! A person of capsules who walks to and fro among 100 boxes, and seven cameras around.

use nalgebra::{Isometry3, Point3, Vector3, vector};
use ode_visual_hull::Result;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::Aabb;
use ode_visual_hull::shape::Shape;
use ode_visual_hull::synthetic::{PERSON_PERIOD, Subject};
use ode_visual_hull_film::{Scenario, Simulation};

/// Number of boxes.
pub const BOXES: usize = 100;

/// The thinnest feature of the person that must not pass through a box, in metres.
pub const MIN_FEATURE: f64 = 0.02;

/// The time after which the person's motion repeats, in seconds.
pub const PERIOD: f64 = 4.0 * PERSON_PERIOD;

/// Until when the person stands and the boxes fall, and when the film ends, in seconds.
const STILL_UNTIL: f64 = 1.2;
const END: f64 = STILL_UNTIL + PERIOD + 1.0;

/// How far the person walks to either side, along x, in metres.
const REACH: f64 = 0.6;

/// Boxes around the person in a layer, at these distances, in metres.
const RINGS: [(f64, usize); 2] = [(0.46, 14), (0.70, 20)];

/// From one layer of boxes to the next, in metres.
const LAYER: f64 = 0.17;

const IMAGE: (u32, u32) = (640, 480);

/// Distance of the cameras from the middle, in metres, and their horizontal angle of view, in radians.
const DISTANCE: f64 = 3.6;
const FIELD: f64 = 0.85;

/// About the size of a pixel at the middle, in metres.
pub const PIXEL: f64 = DISTANCE * FIELD / IMAGE.0 as f64;

const COLOURS: [[u8; 3]; 6] =
    [[222, 86, 62], [66, 118, 202], [240, 188, 60], [146, 92, 186], [236, 236, 228], [240, 150, 190]];

/// A person who walks to and fro.
pub struct Wanderer;

impl Wanderer {
    /// The person who has walked for a time, in seconds.
    pub fn walked(time: f64) -> Subject {
        let along = REACH * (std::f64::consts::TAU * time / PERIOD).sin();
        Subject::person_at(time).transformed(&Isometry3::translation(along, 0.0, 0.0))
    }
}

impl Scenario for Wanderer {
    fn name(&self) -> &str {
        "person"
    }

    fn subject(&self, time: f64) -> Result<Subject> {
        Ok(Self::walked((time - STILL_UNTIL).max(0.0)))
    }

    fn top(&self, _: f64) -> Option<f64> {
        None
    }

    fn still_until(&self) -> f64 {
        STILL_UNTIL
    }

    fn end(&self) -> f64 {
        END
    }

    fn moments(&self) -> [f64; 3] {
        [STILL_UNTIL, STILL_UNTIL + 0.25 * PERIOD, STILL_UNTIL + 0.75 * PERIOD]
    }
}

/// The work volume.
pub fn bounds() -> Result<Aabb> {
    Aabb::new(Point3::new(-1.4, -1.0, -0.1), Point3::new(1.4, 1.0, 2.0))
}

/// A place near the person.
pub fn middle() -> Point3<f64> {
    Point3::new(0.0, 0.0, 0.8)
}

/// Seven cameras, the last of which shows the scene.
pub fn cameras() -> Result<Vec<Camera>> {
    let target = Point3::new(0.0, 0.0, 0.85);
    let at = |k: usize, azimuth: f64, height: f64| {
        let (sin, cos) = azimuth.to_radians().sin_cos();
        let eye = Point3::new(DISTANCE * cos, DISTANCE * sin, height);
        Camera::look_at(format!("camera{k}"), IMAGE, FIELD, eye, target, Vector3::z())
    };
    let azimuths = [5.0, 56.0, 108.0, 160.0, 211.0, 318.0, 265.0];
    let heights = [1.0, 1.5, 0.9, 1.4, 1.0, 0.8, 1.9];
    azimuths
        .into_iter()
        .zip(heights)
        .enumerate()
        .map(|(k, (azimuth, height))| at(k, azimuth, height))
        .collect()
}

/// The boxes, in layers of rings around the person: each has 250 to 500 samples.
pub fn add_boxes(simulation: &mut Simulation) -> Result<()> {
    simulation.set_min_feature(MIN_FEATURE)?;
    let mut added = 0;
    for layer in 0.. {
        for (ring, (radius, count)) in RINGS.into_iter().enumerate() {
            for k in 0..count {
                if added == BOXES {
                    return Ok(());
                }
                let turned = 0.5 * (layer + ring) as f64;
                let angle = std::f64::consts::TAU * (k as f64 + turned) / count as f64;
                let side = 0.085 + 0.006 * ((5 * added + 3 * layer) % 6) as f64;
                let height = 0.5 * side + 0.02 + LAYER * layer as f64;
                let place = vector![radius * angle.cos(), radius * angle.sin(), height];
                let pose = Isometry3::new(place, Vector3::z() * angle);
                simulation.add(&Shape::cube(side), &pose, COLOURS[added % COLOURS.len()])?;
                added += 1;
            }
        }
    }
    Ok(())
}
