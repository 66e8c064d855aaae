//! Cameras with other pixels: images scaled after the calibration, and principal points that are off.

use super::Rig;
use crate::camera::Camera;
use crate::{Error, Result};
use nalgebra::{Matrix3, Vector2};

impl Rig {
    /// The rig for images scaled by `factor`; their sizes are rounded to whole pixels.
    ///
    /// # Errors
    /// A factor that is not positive and finite, or that leaves an image without pixels.
    pub fn scaled(&self, factor: f64) -> Result<Self> {
        if !(factor.is_finite() && factor > 0.0) {
            return Err(Error::argument(format!("expected a positive scale of the images, found {factor}")));
        }

        let length = |length: u32| (f64::from(length) * factor).round() as u32;
        let scaled = |camera: &Camera| {
            let (w, h) = camera.size();
            let mut k = *camera.intrinsics() * factor;
            k[(2, 2)] = 1.0;
            with_pixels(camera, (length(w), length(h)), k)
        };
        Ok(Self { cameras: self.cameras.iter().map(scaled).collect::<Result<_>>()? })
    }

    /// The rig with the principal point of one camera moved `by` pixels right and down; its image size stays.
    ///
    /// # Errors
    /// No camera of this name; a shift that is not finite.
    pub fn shifted(&self, camera: &str, by: Vector2<f64>) -> Result<Self> {
        let Some(index) = self.index_of(camera) else {
            let names: Vec<_> = self.cameras.iter().map(Camera::name).collect();
            return Err(Error::camera(camera, format!("expected one of {}, found none", names.join(", "))));
        };

        let mut cameras = self.cameras.clone();
        let mut k = *cameras[index].intrinsics();
        k[(0, 2)] += by.x;
        k[(1, 2)] += by.y;
        cameras[index] = with_pixels(&cameras[index], cameras[index].size(), k)?;
        Ok(Self { cameras })
    }
}

fn with_pixels(camera: &Camera, size: (u32, u32), k: Matrix3<f64>) -> Result<Camera> {
    Camera::new(camera.name(), size, k, *camera.lens(), *camera.cam_from_world())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::layout;
    use nalgebra::Point3;

    fn rig() -> Rig {
        Rig::new(layout::ring(3, 2.0, 1.0, Point3::new(0.0, 0.0, 0.8), (640, 480), 0.5).unwrap()).unwrap()
    }

    /// The image of one point in each camera.
    fn pixels(rig: &Rig) -> Vec<Vector2<f64>> {
        let point = Point3::new(0.1, -0.2, 0.9);
        rig.cameras().iter().map(|c| c.project(&point).map(|p| Vector2::new(p.u, p.v)).unwrap()).collect()
    }

    #[test]
    fn in_a_scaled_image_everything_appears_at_scaled_coordinates() {
        let half = rig().scaled(0.5).unwrap();
        assert_eq!(half.cameras()[0].size(), (320, 240));
        for (before, after) in pixels(&rig()).iter().zip(pixels(&half)) {
            assert!((0.5 * before - after).norm() < 1e-9, "{before} {after}");
        }
    }

    #[test]
    fn a_shift_moves_the_image_of_one_camera_and_no_other() {
        let by = Vector2::new(3.0, -1.5);
        let name = rig().cameras()[1].name().to_owned();
        let shifted = rig().shifted(&name, by).unwrap();
        for (i, (before, after)) in pixels(&rig()).iter().zip(pixels(&shifted)).enumerate() {
            let expected = if i == 1 { by } else { Vector2::zeros() };
            assert!((after - before - expected).norm() < 1e-9, "camera {i}");
        }
    }

    #[test]
    fn invalid_scales_unknown_cameras_and_shifts_that_are_not_finite_are_refused() {
        for factor in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-4] {
            assert!(rig().scaled(factor).is_err(), "{factor}");
        }
        assert!(
            rig().shifted("missing", Vector2::zeros()).unwrap_err().to_string().contains("expected one of")
        );
        let name = rig().cameras()[0].name().to_owned();
        assert!(rig().shifted(&name, Vector2::new(f64::NAN, 0.0)).is_err());
    }
}
