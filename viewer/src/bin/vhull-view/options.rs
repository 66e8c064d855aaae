//! Options that the subcommands share.

use image::RgbImage;
use nalgebra::Point3;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::{numbers, parse_size};
use ode_visual_hull_viewer::scene::Scene;
use ode_visual_hull_viewer::{DrawOptions, Method, Renderer, RendererKind};
use std::path::Path;

/// How pictures are drawn.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct DrawingOptions {
    /// How the real subject is drawn.
    #[arg(long, value_enum, default_value_t = Method::Blend, help_heading = "Drawing")]
    pub method: Method,
    /// What draws.
    #[arg(long, value_enum, default_value_t = RendererKind::Auto, help_heading = "Drawing")]
    pub renderer: RendererKind,
    /// Size of the pictures in pixels.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_picture_size, default_value = "640x480", help_heading = "Drawing")]
    pub size: (u32, u32),
    /// Rays along a pixel's side: more make smoother edges, and take longer.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4), default_value_t = 2, help_heading = "Drawing")]
    pub samples: u32,
    /// Planes of the method sweep.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1000), default_value_t = 100, help_heading = "Drawing")]
    pub planes: u32,
    /// Leave the subject's depth at the hull's: faster, but images of different cameras fit less.
    #[arg(long, help_heading = "Drawing")]
    pub no_refinement: bool,
    /// No shadows.
    #[arg(long, help_heading = "Drawing")]
    pub no_shadows: bool,
}

impl DrawingOptions {
    /// The renderer that these options ask for.
    pub fn open(&self) -> Result<Renderer> {
        Renderer::open(self.renderer, self.method)
    }

    /// A renderer that has all methods.
    pub fn open_for_all(&self) -> Result<Renderer> {
        Renderer::open(self.renderer, Method::Sweep)
    }

    /// What to draw. `snap` tells whether a picture from the place of a real camera shows its image.
    pub fn draw_options(&self, snap: bool) -> DrawOptions {
        DrawOptions {
            method: self.method,
            refine: !self.no_refinement,
            shadows: !self.no_shadows,
            planes: self.planes,
            snap,
            ..DrawOptions::default()
        }
    }
}

/// Prints what the cameras of a scene cannot tell.
pub fn warn(scene: &Scene) {
    for shortcoming in scene.shortcomings() {
        eprintln!("note: {shortcoming}");
    }
}

/// Writes a picture to `path`, whose folder is made if it is missing.
pub fn save(picture: &RgbImage, path: &Path) -> Result<()> {
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder)
            .map_err(|e| Error::file(folder, format!("expected to make this folder, found: {e}")))?;
    }
    picture
        .save(path)
        .map_err(|e| Error::file(path, format!("expected to write a picture, .png or .jpg, found: {e}")))
}

/// Parses a place, three numbers in metres separated by commas.
pub fn parse_place(text: &str) -> std::result::Result<Point3<f64>, String> {
    numbers(text, "x,y,z").map(Point3::from)
}

/// Parses width and height of a picture in pixels, as `640x480`.
pub fn parse_picture_size(text: &str) -> std::result::Result<(u32, u32), String> {
    let size = parse_size(text)?;
    let in_range = |length: u32| (16..=8192).contains(&length);
    if in_range(size.0) && in_range(size.1) {
        Ok(size)
    } else {
        Err(format!("expected 16 to 8192 pixels a side, found {text}"))
    }
}
