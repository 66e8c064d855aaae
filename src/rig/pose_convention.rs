//! Other conventions in which a calibration's poses are often written.

use super::{Rig, pose};
use crate::Result;
use crate::camera::Camera;
use nalgebra::Isometry3;

/// A convention of pose numbers other than world to camera with OpenCV's axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PoseConvention {
    /// World to camera with OpenGL's axes: the camera's y axis up and its z axis backwards.
    OpenGl,
    /// Camera to world.
    CameraToWorld,
    /// Camera to world with OpenGL's axes, as nerfstudio and Blender write.
    CameraToWorldOpenGl,
}

impl PoseConvention {
    /// All conventions.
    pub const ALL: [Self; 3] = [Self::OpenGl, Self::CameraToWorld, Self::CameraToWorldOpenGl];

    /// A description for messages.
    pub fn describe(self) -> &'static str {
        match self {
            Self::OpenGl => "y and z of the camera axes flipped (OpenGL's axes instead of OpenCV's)",
            Self::CameraToWorld => "poses taken as camera to world instead of world to camera",
            Self::CameraToWorldOpenGl => {
                "poses taken as camera to world, y and z of the camera axes flipped (as nerfstudio and Blender write)"
            }
        }
    }

    /// The world-to-camera pose with OpenCV's axes, where `pose` holds the numbers of this convention.
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
    /// This rig with its poses reinterpreted in another convention.
    ///
    /// # Errors
    /// A pose that is no longer finite.
    pub fn read_as(&self, convention: PoseConvention) -> Result<Self> {
        let camera = |camera: &Camera| {
            let pose = convention.apply(camera.cam_from_world());
            Camera::new(camera.name(), camera.size(), *camera.intrinsics(), *camera.lens(), pose)
        };
        Self::new(self.cameras().iter().map(camera).collect::<Result<_>>()?)
    }

    /// The indices of the cameras that see the [`focus`](Self::focus): in front of them and inside their images. In a
    /// rig that surrounds a subject these are all cameras.
    ///
    /// # Errors
    /// All errors of [`focus`](Self::focus).
    pub fn seeing_focus(&self) -> Result<Vec<usize>> {
        let focus = self.focus()?;
        Ok((0..self.len()).filter(|&k| self.cameras()[k].sees(&focus)).collect())
    }
}
