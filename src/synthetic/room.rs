//! The room around the subject: a floor, walls hung with green cloth, a ceiling and one lamp.

use super::texture::{checker, noise};
use crate::camera::Ray;
use crate::{Error, Result};
use nalgebra::{Point3, Vector3};

/// A rectangular room about the z axis, its floor at z = 0.
///
/// Its faces are visible from the inside only: a camera outside looks through the near wall.
#[derive(Debug, Clone, PartialEq)]
pub struct Room {
    size: Vector3<f64>,
}

/// The colour of rays that miss the room.
const NOTHING: [f64; 3] = [24.0; 3];

const CLOTH: [f64; 3] = [72.0, 158.0, 92.0];
const FLOOR: [f64; 3] = [104.0, 158.0, 118.0];
const CEILING: [f64; 3] = [96.0, 122.0, 104.0];

impl Room {
    /// A room of `size` metres along x, y and z.
    ///
    /// # Errors
    /// A length that is not positive and finite.
    pub fn new(size: Vector3<f64>) -> Result<Self> {
        if size.iter().all(|&length| length > 0.0 && length.is_finite()) {
            return Ok(Self { size });
        }
        Err(Error::argument(format!(
            "expected a room's lengths positive and finite, in metres, found {} x {} x {}",
            size.x, size.y, size.z
        )))
    }

    /// The lengths along x, y and z, in metres.
    pub fn size(&self) -> Vector3<f64> {
        self.size
    }

    /// The position of the lamp in the world, below the ceiling and off the centre.
    pub fn light_position(&self) -> Point3<f64> {
        Point3::new(0.15 * self.size.x, -0.2 * self.size.y, 0.95 * self.size.z)
    }

    /// The distance at which `ray` leaves the room, and the inward normal there; `None` if it misses the room.
    pub(super) fn far_side(&self, ray: &Ray) -> Option<(f64, Vector3<f64>)> {
        let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
        let mut normal = Vector3::zeros();
        for i in 0..3 {
            let (least, most) =
                if i == 2 { (0.0, self.size.z) } else { (-0.5 * self.size[i], 0.5 * self.size[i]) };

            let (origin, direction) = (ray.origin[i], ray.direction[i]);
            if direction == 0.0 {
                if origin < least || origin > most {
                    return None;
                }
                continue;
            }

            let (near, far) = if direction > 0.0 { (least, most) } else { (most, least) };
            enter = enter.max((near - origin) / direction);
            let t = (far - origin) / direction;
            if t < leave {
                leave = t;
                normal = Vector3::zeros();
                normal[i] = -direction.signum();
            }
        }

        (enter <= leave && leave.is_finite()).then_some((leave, normal))
    }

    /// The colour of the room along `ray`, 0 to 255.
    pub(super) fn colour(&self, ray: &Ray) -> Vector3<f64> {
        let Some((t, normal)) = self.far_side(ray) else { return NOTHING.into() };
        let point = ray.at(t);
        self.surface(&point, &normal) * self.light(&point, &normal)
    }

    /// The brightness of `point` on a surface with this unit normal: soft light from above and the lamp, without
    /// shadows.
    pub(super) fn light(&self, point: &Point3<f64>, normal: &Vector3<f64>) -> f64 {
        let to_lamp = (self.light_position() - point).normalize();
        0.46 + 0.12 * normal.z + 0.42 * normal.dot(&to_lamp).max(0.0)
    }

    /// The colour of the surface at `point`.
    fn surface(&self, point: &Point3<f64>, normal: &Vector3<f64>) -> Vector3<f64> {
        let grain = 0.10 * (noise(point, 0.05) - 0.5) + 0.16 * (noise(point, 0.4) - 0.5);
        if normal.z > 0.5 {
            let above_floor = Point3::new(point.x, point.y, 0.0);
            return Vector3::from(FLOOR) * (1.0 + grain - 0.12 * checker(&above_floor, 0.5));
        }
        if normal.z < -0.5 {
            return Vector3::from(CEILING) * (1.0 + grain);
        }

        // The cloth hangs in folds, which vary slightly with the height.
        let along = point.x + point.y + 0.15 * noise(point, 0.7);
        let fold = 0.08 * (along * 14.0).sin();
        Vector3::from(CLOTH) * (1.0 + fold + grain)
    }
}

impl Default for Room {
    /// 10 m by 10 m, 5 m high.
    fn default() -> Self {
        Self { size: Vector3::new(10.0, 10.0, 5.0) }
    }
}
