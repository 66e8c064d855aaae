//! A person of capsules who walks along x, eight cameras around the way, and the stack of virtual boxes in it.

use nalgebra::{Isometry3, Point3, Vector3, vector};
use ode_visual_hull::Result;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::Aabb;
use ode_visual_hull::shape::Shape;
use ode_visual_hull::synthetic::{PERSON_PERIOD, Subject};
use ode_visual_hull_film::{Scenario, Simulation};

/// Until when the person stands and the boxes settle, and when the film ends, in seconds.
const STILL_UNTIL: f64 = 1.0;
const END: f64 = 4.6;

/// Where the person stands at first, along x, and the mean length of two steps, in metres.
const START: f64 = -0.75;
const STRIDE: f64 = 0.68;

/// Where the stack stands, along x.
const STACK: f64 = 0.2;

/// The side lengths of the boxes, in metres, and how they are turned, in radians, from the floor up.
const BOXES: [(Vector3<f64>, f64, [u8; 3]); 5] = [
    (Vector3::new(0.34, 0.36, 0.28), 0.05, [222, 86, 62]),
    (Vector3::new(0.32, 0.32, 0.26), -0.12, [66, 118, 202]),
    (Vector3::new(0.32, 0.30, 0.26), 0.20, [240, 188, 60]),
    (Vector3::new(0.28, 0.30, 0.24), -0.06, [146, 92, 186]),
    (Vector3::new(0.26, 0.26, 0.22), 0.30, [236, 236, 228]),
];

/// Positions of the cameras around: azimuth in degrees, counter-clockwise from +x, and height in metres.
const AROUND: [(f64, f64); 7] =
    [(20.0, 1.0), (70.0, 1.5), (120.0, 0.9), (165.0, 1.4), (215.0, 1.0), (260.0, 1.6), (315.0, 0.8)];

const IMAGE: (u32, u32) = (640, 480);

/// Distance of the cameras around from the middle, in metres, and their horizontal angle of view, in radians.
const DISTANCE: f64 = 3.6;
const FIELD: f64 = 0.95;

/// A person who walks through the stack.
pub struct Walker;

impl Scenario for Walker {
    fn name(&self) -> &str {
        "person"
    }

    fn subject(&self, time: f64) -> Result<Subject> {
        let walked = (time - STILL_UNTIL).max(0.0);
        let along = START + STRIDE * walked / PERSON_PERIOD;
        Ok(Subject::person_at(walked).transformed(&Isometry3::translation(along, 0.0, 0.0)))
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
        [STILL_UNTIL, 3.2, 4.0]
    }
}

/// The work volume.
pub fn bounds() -> Result<Aabb> {
    Aabb::new(Point3::new(-1.4, -0.9, -0.1), Point3::new(1.9, 0.9, 2.0))
}

/// Where the stack stands.
pub fn foot() -> Point3<f64> {
    Point3::new(STACK, 0.0, 0.0)
}

/// The cameras; the last one shows the scene.
pub fn cameras() -> Result<Vec<Camera>> {
    let target = Point3::new(0.2, 0.0, 0.85);
    let around = AROUND.iter().enumerate().map(|(i, &(azimuth, height))| {
        let (sin, cos) = azimuth.to_radians().sin_cos();
        let eye = Point3::new(0.2 + DISTANCE * cos, DISTANCE * sin, height);
        Camera::look_at(format!("around{i}"), IMAGE, FIELD, eye, target, Vector3::z())
    });
    let (eye, target) = (Point3::new(0.8, -4.1, 1.6), Point3::new(0.65, 0.0, 0.75));
    let overview = Camera::look_at("overview", IMAGE, FIELD, eye, target, Vector3::z());
    around.chain([overview]).collect()
}

/// Stacks the boxes on `foot`, `scale` times as large as they are, with a gap of a millimetre.
pub fn stack(simulation: &mut Simulation, foot: &Point3<f64>, scale: f64) -> Result<()> {
    let mut top = foot.z;
    for (sides, yaw, colour) in BOXES {
        let sides = sides * scale;
        top += 0.001;
        let pose = Isometry3::new(vector![foot.x, foot.y, top + 0.5 * sides.z], Vector3::z() * yaw);
        simulation.add(&Shape::Box { sides }, &pose, colour)?;
        top += sides.z;
    }
    Ok(())
}

/// The width and the height of the stack.
pub fn extent() -> (f64, f64) {
    let width = BOXES.iter().map(|(sides, ..)| sides.x.max(sides.y)).fold(0.0, f64::max);
    (width, BOXES.iter().map(|(sides, ..)| sides.z).sum())
}
