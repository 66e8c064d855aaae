//! Contacts and surface samples of bodies.

use super::{Dot, Ink, Line, Overlay};
use nalgebra::{Point3, Vector3};

/// How long the normal of a contact is for each metre of its depth, and at least, in metres.
const NORMAL_FOR_DEPTH: f64 = 10.0;
const LEAST_NORMAL: f64 = 0.03;

/// The time in seconds in which a surface moves by the length of its arrow, and the least speed that has one, in m/s.
const ARROW_SECONDS: f64 = 0.2;
const LEAST_SPEED: f64 = 0.02;

/// The length of an arrow's head, as a part of the arrow's.
const HEAD: f64 = 0.25;

/// Opacity of a contact behind a surface. All are between two surfaces, and would hardly be seen if they were as faint as
/// lines.
const HIDDEN_CONTACT: f32 = 0.6;

/// Width of a contact's lines, as a multiple of that of plain lines.
const WIDTH: f64 = 1.5;

/// The largest radius of a sample, in metres: from afar, a body must not vanish behind its samples.
const SAMPLE_RADIUS: f64 = 0.0025;

/// Opacity of a sample on the other side of its body.
const HIDDEN_SAMPLE: f32 = 0.1;

const POINT: [u8; 3] = [255, 60, 200];
const NORMAL: [u8; 3] = [255, 230, 60];
const ARROW: [u8; 3] = [60, 230, 255];
const SAMPLE: [u8; 3] = [255, 255, 255];

impl Overlay {
    /// Adds a contact: a dot, a yellow line along its unit `normal`, ten times as long as the contact is deep and at least 3 cm,
    /// and a blue arrow along the `velocity` of the real surface in m/s, as long as its way in 0.2 s. `depth` is in metres.
    pub fn add_contact(
        &mut self,
        position: Point3<f64>,
        normal: Vector3<f64>,
        depth: f64,
        velocity: Vector3<f64>,
    ) {
        let ink = |colour| Ink { colour, hidden: HIDDEN_CONTACT };
        let tip = position + normal * (NORMAL_FOR_DEPTH * depth).max(LEAST_NORMAL);
        self.lines.push(Line { ends: [position, tip], width: WIDTH, ink: ink(NORMAL) });
        if velocity.norm() > LEAST_SPEED {
            self.add_arrow(position, velocity * ARROW_SECONDS, ink(ARROW));
        }
        self.points.push(Dot { at: position, radius: 2.2, most: f64::INFINITY, ink: ink(POINT) });
    }

    /// Adds a point of a body's surface, as a small dot.
    pub fn add_sample(&mut self, point: Point3<f64>) {
        let ink = Ink { colour: SAMPLE, hidden: HIDDEN_SAMPLE };
        self.points.push(Dot { at: point, radius: 0.5, most: SAMPLE_RADIUS, ink });
    }

    /// Adds an arrow with four lines at its head, so that it is one from all sides.
    fn add_arrow(&mut self, from: Point3<f64>, way: Vector3<f64>, ink: Ink) {
        let tip = from + way;
        let across = way.cross(&Vector3::ith(way.iamin(), 1.0)).normalize();
        let sides = [across, across.cross(&way).normalize()].map(|side| 0.4 * HEAD * way.norm() * side);
        self.lines.push(Line { ends: [from, tip], width: WIDTH, ink });
        for side in sides.into_iter().flat_map(|side| [side, -side]) {
            self.lines.push(Line { ends: [tip, tip - HEAD * way + side], width: WIDTH, ink });
        }
    }
}
