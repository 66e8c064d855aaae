//! The subject on a GPU, or on a rasteriser on the processor, as [`CpuRenderer`](crate::cpu::CpuRenderer) draws it.
//!
//! ```text
//!   Scene ──► Upload ──► DepthAtlas ──┐
//!       (texture arrays)  (hull)      ▼
//!   Camera ──► Tiles ──► entries ──► subject ──► Target ──► Picture
//!        (where rays start)  (where they enter)
//! ```
//!
//! What lies above is drawn once a scene, what lies below once a picture. A rasteriser on the processor skips what the depth test
//! rejects, but not the branches of a shader that no pixel takes. So each pass leaves out what the last one has ruled out.

mod depth_atlas;
mod device;
mod eye;
mod frame;
mod layouts;
mod pipelines;
mod prepared;
mod shader;
mod target;
mod tiles;
mod upload;

pub use device::Device;

use crate::picture::{DrawOptions, Picture};
use crate::scene::Scene;
use eye::Placement;
use frame::Frame;
use layouts::Layouts;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::{Error, Result};
use pipelines::Pipelines;
use prepared::Prepared;
use target::Target;

/// Draws pictures of scenes on a device. What has been compiled and allocated is used again for the next scene.
#[derive(Debug)]
pub struct GpuRenderer {
    device: Device,
    layouts: Layouts,
    pipelines: Pipelines,
    prepared: Option<Prepared>,
    target: Option<Target>,
}

impl GpuRenderer {
    /// A renderer without a scene.
    pub fn new(device: &Device) -> Self {
        Self {
            device: device.clone(),
            layouts: Layouts::new(device),
            pipelines: Pipelines::default(),
            prepared: None,
            target: None,
        }
    }

    /// The device that draws.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// Prepares to draw `scene`, from now on.
    ///
    /// # Errors
    /// A device that has failed, or that is too small for the views.
    pub fn set_scene(&mut self, scene: &Scene) -> Result<()> {
        let device = self.device.clone();
        let _turn = device.turn();
        device.check()?;
        let prepared = self.prepared.take().filter(|prepared| prepared.fits(scene));
        let mut prepared = match prepared {
            Some(prepared) => prepared,
            None => Prepared::new(&self.device, &self.layouts, scene)?,
        };
        prepared.set_scene(&self.device, &self.layouts, &mut self.pipelines, scene);
        self.prepared = Some(prepared);
        self.device.check()
    }

    /// The subject alone from the place of `camera`: its colours and depths, without light, bodies and surroundings.
    ///
    /// # Errors
    /// No scene, a device that has failed, or a picture that is too large for it.
    pub fn draw(&mut self, camera: &Camera, options: &DrawOptions) -> Result<Picture> {
        let device = self.device.clone();
        let _turn = device.turn();
        device.check()?;
        let Some(prepared) = &self.prepared else {
            return Err(Error::argument("draw: expected a scene, found none; set one first"));
        };
        let target = match self.target.take().filter(|target| target.size() == camera.size()) {
            Some(target) => target,
            None => Target::new(&self.device, &self.layouts, camera.size())?,
        };
        let placement = Placement { scale: 1.0, shift: [0.0; 2], own: 0, planes: options.planes.max(1) };
        prepared.write_eye(&self.device, camera, placement);
        let mut encoder = self.device.raw().create_command_encoder(&Default::default());
        let mut frame = Frame {
            device: &self.device,
            layouts: &self.layouts,
            pipelines: &mut self.pipelines,
            prepared,
            target: &target,
            encoder: &mut encoder,
            area: prepared.area(camera),
        };
        frame.entries();
        frame.subject(options);
        target.copy(&mut encoder);
        self.device.queue().submit([encoder.finish()]);
        let picture = target.read(&self.device);
        self.target = Some(target);
        picture
    }
}
