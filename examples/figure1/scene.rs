//! A person of capsules who walks to and fro among 100 boxes, and seven cameras around.

use nalgebra::{Isometry3, Point3, Vector3, vector};
use ode_visual_hull::Result;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, Hull};
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

/// From one layer of boxes to the next, and at least from one box to the next in a ring, in metres.
const LAYER: f64 = 0.17;

/// From one ring to the next around a recorded subject, and between it and the boxes, in metres.
const GAP_OF_RINGS: f64 = 0.18;
const ROOM: f64 = 0.02;

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

/// Adds the boxes, in layers of rings around the person: each has 250 to 500 samples.
pub fn add_boxes(simulation: &mut Simulation) -> Result<()> {
    simulation.set_min_feature(MIN_FEATURE)?;
    let places = (0..).flat_map(|layer| {
        let ring = move |(ring, (radius, count))| ring_of(layer, ring, radius, count);
        RINGS.into_iter().enumerate().flat_map(ring)
    });
    for (k, place) in places.take(BOXES).enumerate() {
        let (side, pose) = place.box_of(k, &Point3::origin());
        simulation.add(&Shape::cube(side), &pose, COLOURS[k % COLOURS.len()])?;
    }
    Ok(())
}

/// Adds the boxes as near around the subject of `hull` as it leaves room, in layers of the same number. Returns the distance
/// of the farthest one from the middle of the subject.
pub fn add_boxes_around(simulation: &mut Simulation, hull: &Hull) -> Result<f64> {
    simulation.set_min_feature(MIN_FEATURE)?;
    let middle = hull.aabb().centre();
    let middle = Point3::new(middle.x, middle.y, 0.0);
    let of_layer: usize = RINGS.iter().map(|(_, count)| count).sum();
    let (mut added, mut farthest) = (0, 0.0_f64);
    for layer in 0..BOXES.div_ceil(of_layer) {
        let rings = (1..).map(|ring| (ring, GAP_OF_RINGS * ring as f64));
        let places = rings.flat_map(|(ring, radius)| {
            ring_of(layer, ring, radius, (std::f64::consts::TAU * radius / LAYER) as usize)
        });
        let end = BOXES.min(added + of_layer);
        for place in places {
            let (side, pose) = place.box_of(added, &middle);
            if leaves_room(hull, side, &pose) {
                simulation.add(&Shape::cube(side), &pose, COLOURS[added % COLOURS.len()])?;
                added += 1;
                farthest = farthest.max(place.radius + side);
            }
            if added == end {
                break;
            }
        }
    }
    Ok(farthest)
}

/// A place of a box.
#[derive(Debug, Clone, Copy)]
struct Place {
    layer: usize,
    /// From the middle, in metres.
    radius: f64,
    angle: f64,
}

impl Place {
    /// The side length and the pose of box number `k`.
    fn box_of(&self, k: usize, middle: &Point3<f64>) -> (f64, Isometry3<f64>) {
        let side = 0.085 + 0.006 * ((5 * k + 3 * self.layer) % 6) as f64;
        let height = 0.5 * side + 0.02 + LAYER * self.layer as f64;
        let (sin, cos) = self.angle.sin_cos();
        let place = middle.coords + vector![self.radius * cos, self.radius * sin, height];
        (side, Isometry3::new(place, Vector3::z() * self.angle))
    }
}

/// The places of a ring, turned by half a place from one ring and one layer to the next.
fn ring_of(layer: usize, ring: usize, radius: f64, count: usize) -> impl Iterator<Item = Place> {
    let turned = 0.5 * (layer + ring) as f64;
    let angle = move |k: usize| std::f64::consts::TAU * (k as f64 + turned) / count as f64;
    (0..count).map(move |k| Place { layer, radius, angle: angle(k) })
}

/// Whether no point of a cube is inside the hull, nor near it.
fn leaves_room(hull: &Hull, side: f64, pose: &Isometry3<f64>) -> bool {
    let across = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|part| part * (0.5 * side + ROOM));
    let in_layer = |z: f64| across.into_iter().flat_map(move |x| across.map(|y| Point3::new(x, y, z)));
    !across.into_iter().flat_map(in_layer).any(|point| hull.inside(&(pose * point)))
}
