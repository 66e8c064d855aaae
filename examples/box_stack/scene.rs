//! A real box that stands, is lifted, and is tilted; eight cameras around it; and the stack of virtual boxes on it.
//!
//! Above a flat top the visual hull is a tent unless a camera looks along the top. So seven cameras stand at heights
//! through which the top moves. Two of them stand on the axis of the tilt and look along the top at any angle. The
//! eighth camera looks down and shows the scene.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3, vector};
use ode_visual_hull::Result;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::Aabb;
use ode_visual_hull::shape::Shape;
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture};
use ode_visual_hull_film::{Scenario, Simulation};

/// The real box, in metres.
const REAL: Vector3<f64> = Vector3::new(0.5, 0.5, 0.35);

/// Times at which the real box starts and stops moving and the film ends, in seconds.
const STILL_UNTIL: f64 = 1.8;
const MOVED_BY: f64 = 3.6;
const END: f64 = 5.8;

/// Height of the lift in metres, and angle of the tilt towards +x in radians.
const LIFT: f64 = 0.25;
const TILT: f64 = 28.0 * std::f64::consts::PI / 180.0;

/// Positions of the grazing cameras: azimuth in degrees, counter-clockwise from +x, and height in metres.
const GRAZING: [(f64, f64); 7] =
    [(0.0, 0.35), (45.0, 0.35), (90.0, 0.42), (135.0, 0.35), (180.0, 0.50), (225.0, 0.35), (270.0, 0.62)];

const IMAGE: (u32, u32) = (640, 480);

/// Distance of the grazing cameras from the middle, in metres, and their horizontal angle of view, in radians.
const DISTANCE: f64 = 3.0;
const FIELD: f64 = 0.46;

/// The real box, lifted and tilted.
pub struct LiftedBox;

impl Scenario for LiftedBox {
    fn name(&self) -> &str {
        "real box"
    }

    fn subject(&self, time: f64) -> Result<Subject> {
        let cardboard = Texture::plain([206, 150, 92]);
        Ok(Subject::new(vec![Placed::new(Solid::cuboid(REAL)?, real_pose(time), cardboard)]))
    }

    fn top(&self, time: f64) -> Option<f64> {
        Some((real_pose(time) * Point3::new(0.0, 0.0, 0.5 * REAL.z)).z)
    }

    fn still_until(&self) -> f64 {
        STILL_UNTIL
    }

    fn end(&self) -> f64 {
        END
    }

    fn moments(&self) -> [f64; 3] {
        [STILL_UNTIL - 0.1, MOVED_BY - 0.2, END]
    }
}

/// The work volume.
pub fn bounds() -> Result<Aabb> {
    Aabb::new(Point3::new(-0.8, -0.8, -0.1), Point3::new(0.8, 0.8, 1.2))
}

/// The middle of the real box's top, where the virtual boxes stand.
pub fn top() -> Point3<f64> {
    Point3::new(0.0, 0.0, REAL.z)
}

/// The cameras; the last one shows the scene.
pub fn cameras() -> Result<Vec<Camera>> {
    let target = Point3::new(0.0, 0.0, 0.4);
    let grazing = GRAZING.iter().enumerate().map(|(i, &(azimuth, height))| {
        let (sin, cos) = azimuth.to_radians().sin_cos();
        let eye = Point3::new(DISTANCE * cos, DISTANCE * sin, height);
        Camera::look_at(format!("grazing{i}"), IMAGE, FIELD, eye, target, Vector3::z())
    });
    let (eye, target) = (Point3::new(-0.55, -3.05, 1.6), Point3::new(0.38, 0.0, 0.52));
    let overview = Camera::look_at("overview", IMAGE, 0.66, eye, target, Vector3::z());
    grazing.chain([overview]).collect()
}

/// Stacks the five virtual boxes, with a gap of a millimetre.
pub fn stack(simulation: &mut Simulation) -> Result<()> {
    let boxes = [
        (vector![0.26, 0.25, 0.15], 0.05, [222, 86, 62]),
        (vector![0.24, 0.24, 0.14], -0.12, [66, 118, 202]),
        (vector![0.25, 0.22, 0.13], 0.20, [240, 188, 60]),
        (vector![0.22, 0.24, 0.14], -0.06, [146, 92, 186]),
        (vector![0.21, 0.21, 0.13], 0.30, [236, 236, 228]),
    ];
    let mut top = REAL.z;
    for (sides, yaw, colour) in boxes {
        top += 0.001;
        let pose = Isometry3::new(vector![0.0, 0.0, top + 0.5 * sides.z], Vector3::z() * yaw);
        simulation.add(&Shape::Box { sides }, &pose, colour)?;
        top += sides.z;
    }

    Ok(())
}

/// The real box's pose at `time`.
fn real_pose(time: f64) -> Isometry3<f64> {
    let s = ((time - STILL_UNTIL) / (MOVED_BY - STILL_UNTIL)).clamp(0.0, 1.0);
    let moved = s * s * (3.0 - 2.0 * s);
    let centre = vector![0.0, 0.0, 0.5 * REAL.z + LIFT * moved];
    Isometry3::from_parts(centre.into(), UnitQuaternion::from_axis_angle(&Vector3::y_axis(), TILT * moved))
}
