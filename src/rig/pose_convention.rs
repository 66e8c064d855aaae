//! The other ways in which a calibration's poses are often meant.

use super::{Rig, pose};
use crate::Result;
use crate::camera::Camera;
use nalgebra::Isometry3;

/// What the numbers of a pose may mean, beside what they were read as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PoseConvention {
    /// World to camera, but the camera's y axis up and its z axis backwards: OpenGL's.
    OpenGl,
    /// Camera to world.
    CameraToWorld,
    /// Camera to world, and OpenGL's axes: what nerfstudio and Blender write.
    CameraToWorldOpenGl,
}

impl PoseConvention {
    /// All.
    pub const ALL: [Self; 3] = [Self::OpenGl, Self::CameraToWorld, Self::CameraToWorldOpenGl];

    /// For people.
    pub fn describe(self) -> &'static str {
        match self {
            Self::OpenGl => "y and z of the camera axes flipped (OpenGL's axes instead of OpenCV's)",
            Self::CameraToWorld => "poses taken as camera to world instead of world to camera",
            Self::CameraToWorldOpenGl => {
                "poses taken as camera to world, y and z of the camera axes flipped (as nerfstudio and Blender write)"
            }
        }
    }

    fn apply(self, pose: &Isometry3<f64>) -> Isometry3<f64> {
        let flip = pose::opengl_axes();
        match self {
            Self::OpenGl => flip * pose,
            Self::CameraToWorld => pose.inverse(),
            Self::CameraToWorldOpenGl => flip * pose.inverse(),
        }
    }
}

impl Rig {
    /// The same rig with its poses meant in another way.
    ///
    /// # Errors
    /// A pose that is no longer finite.
    pub fn read_as(&self, reading: PoseConvention) -> Result<Self> {
        let camera = |camera: &Camera| {
            let pose = reading.apply(camera.cam_from_world());
            Camera::new(camera.name(), camera.size(), *camera.intrinsics(), *camera.lens(), pose)
        };
        Self::new(self.cameras().iter().map(camera).collect::<Result<_>>()?)
    }

    /// The cameras that see the spot that all look at, in their images and before them; all of them in a rig that
    /// surrounds a subject.
    ///
    /// # Errors
    /// As [`focus`](Self::focus).
    pub fn seeing_focus(&self) -> Result<Vec<usize>> {
        let focus = self.focus()?;
        Ok((0..self.len()).filter(|&k| self.cameras()[k].sees(&focus)).collect())
    }
}
