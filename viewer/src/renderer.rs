//! The renderer in use: a GPU with the processor's help, or the processor alone.

use crate::cpu::CpuRenderer;
#[cfg(feature = "gpu")]
use crate::gpu::{Device, GpuRenderer};
use crate::picture::{DrawOptions, Method, Picture};
use crate::scene::Scene;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::{Error, Result};

/// Which renderer to use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum RendererKind {
    /// A GPU where there is one, else the processor; for the method sweep, a rasteriser of a graphics library.
    #[default]
    Auto,
    /// A GPU, or the rasteriser of a graphics library that runs on the processor.
    Gpu,
    /// The processor, without a graphics library.
    Cpu,
}

/// Draws scenes. With a GPU the subject is drawn there, and bodies, floor and shadows by the processor.
#[derive(Debug)]
pub enum Renderer {
    /// The processor alone.
    Cpu,
    /// A GPU.
    #[cfg(feature = "gpu")]
    Gpu(Box<GpuRenderer>),
}

impl Renderer {
    /// Opens a renderer of this kind for pictures by `method`.
    ///
    /// # Errors
    /// A GPU that is wanted or needed and missing, or cannot be used.
    pub fn open(kind: RendererKind, method: Method) -> Result<Self> {
        match kind {
            RendererKind::Cpu => Ok(Self::Cpu),
            RendererKind::Gpu => Self::on_gpu(),
            RendererKind::Auto if method == Method::Sweep => Self::on_gpu(),
            RendererKind::Auto => Ok(Self::on_real_gpu().unwrap_or(Self::Cpu)),
        }
    }

    /// The renderer in words.
    pub fn description(&self) -> String {
        match self {
            Self::Cpu => "the processor".into(),
            #[cfg(feature = "gpu")]
            Self::Gpu(renderer) => {
                let device = renderer.device();
                let slow = if device.is_software() { ", a rasteriser on the processor" } else { "" };
                format!("{}{slow}", device.name())
            }
        }
    }

    /// The `scene` from the place of `camera`.
    ///
    /// # Errors
    /// A GPU that is lost or too small, or a method that the renderer does not have.
    pub fn draw(&mut self, scene: &Scene, camera: &Camera, options: &DrawOptions) -> Result<Picture> {
        let processor = CpuRenderer::new(scene);
        match self {
            Self::Cpu if options.method == Method::Sweep => Err(Error::argument(
                "method sweep: expected a GPU or the rasteriser of a graphics library, found the processor alone; use \
                 --renderer gpu or --method blend",
            )),
            Self::Cpu => Ok(processor.draw(camera, options)),
            #[cfg(feature = "gpu")]
            Self::Gpu(renderer) => {
                renderer.set_scene(scene)?;
                let subject = renderer.draw(camera, options)?;
                Ok(processor.compose(camera, options, &subject))
            }
        }
    }

    #[cfg(feature = "gpu")]
    fn on_gpu() -> Result<Self> {
        Ok(Self::Gpu(Box::new(GpuRenderer::new(&Device::new()?))))
    }

    #[cfg(feature = "gpu")]
    fn on_real_gpu() -> Option<Self> {
        let device = Device::new().ok().filter(|device| !device.is_software())?;
        Some(Self::Gpu(Box::new(GpuRenderer::new(&device))))
    }

    #[cfg(not(feature = "gpu"))]
    fn on_gpu() -> Result<Self> {
        Err(Error::argument(
            "renderer gpu: expected a build with the feature gpu, found one without; build without --no-default-features",
        ))
    }

    #[cfg(not(feature = "gpu"))]
    fn on_real_gpu() -> Option<Self> {
        None
    }
}
