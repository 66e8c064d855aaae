//! What the window asks to be drawn.

use crate::orbit::Orbit;
use crate::picture::{DrawOptions, Method};
use nalgebra::Matrix3;
use ode_visual_hull::Result;
use ode_visual_hull::camera::{Camera, Lens};

/// Where the picture is seen from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Viewpoint {
    /// Anywhere.
    Free(Orbit),
    /// The place of a real camera, by its index.
    Camera(usize),
}

/// What is drawn over the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Marks {
    /// Contacts of bodies with the hull: normal, depth and velocity.
    pub contacts: bool,
    /// The points of the bodies' surfaces that are tested against the hull.
    pub samples: bool,
    /// The real cameras, with their frusta and names.
    pub cameras: bool,
    /// The axes of the world.
    pub axes: bool,
    /// The work volume.
    pub work_volume: bool,
    /// How fast everything is.
    pub info: bool,
    /// The list of keys.
    pub keys: bool,
}

/// A picture that is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// Where it is seen from.
    pub viewpoint: Viewpoint,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// How many of these pixels one that is drawn covers along its side: more than one while the viewpoint moves.
    pub coarseness: u32,
    /// How the subject is drawn.
    pub method: Method,
    /// See [`DrawOptions::refine`].
    pub refine: bool,
    /// What is drawn over it.
    pub marks: Marks,
}

impl Request {
    /// What is drawn of the scene.
    pub fn draw_options(&self) -> DrawOptions {
        DrawOptions { method: self.method, refine: self.refine, ..DrawOptions::default() }
    }

    /// The camera from whose place the picture is drawn, where the real ones are `pinholes`; its pixels are the coarse ones.
    ///
    /// # Errors
    /// A viewpoint that is no camera.
    pub fn camera<'c>(&self, pinhole: impl Fn(usize) -> &'c Camera) -> Result<Camera> {
        let size = self.coarse_size();
        match &self.viewpoint {
            Viewpoint::Free(orbit) => orbit.camera(size),
            Viewpoint::Camera(view) => fitted(pinhole(*view), size),
        }
    }

    /// Width and height of what is drawn, in coarse pixels.
    pub fn coarse_size(&self) -> (u32, u32) {
        let length = |pixels: u32| pixels.div_ceil(self.coarseness.max(1)).max(1);
        (length(self.size.0), length(self.size.1))
    }
}

/// `camera` with pictures of `size` pixels, which show all that its own show, and more on two sides if the shape differs.
fn fitted(camera: &Camera, size: (u32, u32)) -> Result<Camera> {
    let (width, height) = (f64::from(camera.size().0), f64::from(camera.size().1));
    let scale = (f64::from(size.0) / width).min(f64::from(size.1) / height);
    let [left, top] =
        [(size.0, width), (size.1, height)].map(|(own, one)| 0.5 * (f64::from(own) - scale * one));
    let place = Matrix3::new(scale, 0.0, left, 0.0, scale, top, 0.0, 0.0, 1.0);
    Camera::new(camera.name(), size, place * camera.intrinsics(), Lens::none(), *camera.cam_from_world())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point3, Vector3};

    #[test]
    fn the_picture_of_a_real_camera_is_all_in_the_window_and_in_its_middle() {
        let eye = Point3::new(3.0, 1.0, 1.5);
        let camera = Camera::look_at("left", (640, 480), 0.8, eye, Point3::origin(), Vector3::z()).unwrap();
        let shown = fitted(&camera, (500, 240)).unwrap();
        for (u, v) in [(0.0, 0.0), (640.0, 480.0), (320.0, 240.0), (100.0, 400.0)] {
            let place = camera.ray(u, v).unwrap().at(2.0);
            let pixel = shown.project(&place).unwrap();
            let expected = (90.0 + 0.5 * u, 0.5 * v);
            assert!((pixel.u - expected.0).abs() + (pixel.v - expected.1).abs() < 1e-6, "{pixel:?}");
        }
    }
}
