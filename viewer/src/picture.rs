//! Drawn pictures, and what to draw of a scene.

use image::RgbImage;
use nalgebra::Vector3;

/// How the real subject is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Method {
    /// The visual hull, its depth refined by the agreement of colours, coloured by the three best cameras.
    #[default]
    Blend,
    /// The photo hull, by a plane sweep with photo-consistency (Li, Magnor and Seidel 2004), as in the paper.
    Sweep,
    /// The visual hull's shape, shaded.
    Hull,
}

/// What of a scene is drawn, and how.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawOptions {
    /// How the real subject is drawn.
    pub method: Method,
    /// Whether the method blend moves the surface into the hull to where the colours of the cameras agree.
    pub refine: bool,
    /// Whether a picture from the place of a real camera shows the image of that camera.
    pub snap: bool,
    /// Whether bodies and subject cast shadows on each other and on the floor.
    pub shadows: bool,
    /// Whether floor and sky are drawn; otherwise what shows no body and no subject is black.
    pub surroundings: bool,
    /// The number of planes of the method sweep.
    pub planes: u32,
    /// Whether the method sweep begins where rays enter the visual hull, which makes it faster. Without it, each pixel tries
    /// all planes up to the first that is consistent, as published, and parts of the hull between two planes are left out.
    pub cull_planes: bool,
}

impl Default for DrawOptions {
    fn default() -> Self {
        let method = Method::default();
        Self {
            method,
            refine: true,
            snap: true,
            shadows: true,
            surroundings: true,
            planes: 100,
            cull_planes: true,
        }
    }
}

/// What a pixel shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum Content {
    /// Floor, sky, or the image of a real camera.
    #[default]
    Surroundings,
    /// The real subject.
    Subject,
    /// A virtual body.
    Body,
}

/// A drawn picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Its colours.
    pub colour: RgbImage,
    /// What each pixel shows, row by row.
    pub content: Vec<Content>,
    /// The depth of each pixel along the camera's z axis in metres, row by row; infinite where nothing is.
    pub depth: Vec<f32>,
}

impl Picture {
    /// A picture of surroundings, black and infinitely far.
    pub fn new(width: u32, height: u32) -> Self {
        let count = width as usize * height as usize;
        Self {
            colour: RgbImage::new(width, height),
            content: vec![Content::default(); count],
            depth: vec![f32::INFINITY; count],
        }
    }
}

/// Red, green, blue from 0 to 255, as arithmetic needs them.
pub(crate) type Colour = Vector3<f32>;

/// The nearest colour that an image holds.
pub(crate) fn to_rgb(colour: Colour) -> [u8; 3] {
    colour.map(|value| (value + 0.5).clamp(0.0, 255.0) as u8).into()
}
