//! The renderer in use: a GPU's, or the one that needs none.

use crate::cpu::CpuRenderer;
use crate::picture::{DrawOptions, Method, Picture};
use crate::scene::Scene;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::{Error, Result};

/// Which renderer to use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum RendererKind {
    /// A GPU's where there is one, else the processor's.
    #[default]
    Auto,
    /// A GPU's, or that of a graphics library that runs on the processor.
    Gpu,
    /// The processor's, without a graphics library.
    Cpu,
}

/// Draws scenes.
#[derive(Debug)]
pub enum Renderer {
    /// On the processor.
    Cpu,
}

impl Renderer {
    /// Opens a renderer of this kind.
    ///
    /// # Errors
    /// A GPU that is wanted and missing, or cannot be used.
    pub fn open(kind: RendererKind, _method: Method) -> Result<Self> {
        match kind {
            RendererKind::Auto | RendererKind::Cpu => Ok(Self::Cpu),
            RendererKind::Gpu => Err(Error::argument("--renderer gpu: not yet")),
        }
    }

    /// The renderer in words.
    pub fn description(&self) -> String {
        "the processor".into()
    }

    /// The `scene` from the place of `camera`.
    ///
    /// # Errors
    /// A lost GPU, or a method that the renderer does not have.
    pub fn draw(&mut self, scene: &Scene, camera: &Camera, options: &DrawOptions) -> Result<Picture> {
        match self {
            Self::Cpu if options.method == Method::Sweep => Err(Error::argument(
                "method sweep: expected a GPU or a graphics library, found the renderer cpu; use --renderer gpu or --method blend",
            )),
            Self::Cpu => Ok(CpuRenderer::new(scene).draw(camera, options)),
        }
    }
}
