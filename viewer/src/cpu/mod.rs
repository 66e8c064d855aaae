//! The renderer without a GPU, which is also the reference for the one with it.
//!
//! Each pixel's ray is followed to the nearest of body, subject and floor:
//!
//! ```text
//!   march ──► blend ──┐
//!   raster ───────────┼──► pixel
//!   shadow, surroundings ┘
//! ```

mod blend;
mod depth_map;
mod eye;
mod march;
mod pixel;
mod raster;
mod shadow;
mod surroundings;

use crate::picture::{DrawOptions, Picture, to_rgb};
use crate::scene::Scene;
use blend::Blend;
use eye::Eye;
use march::{Lines, March};
use ode_visual_hull::camera::Camera;
use pixel::{PixelPainter, TILE};
use raster::Triangles;
use rayon::prelude::*;
use shadow::{LightView, Shadow};

/// Draws pictures of one scene on the processor.
#[derive(Debug)]
pub struct CpuRenderer<'s> {
    scene: &'s Scene,
    march: March<'s>,
    blend: Blend<'s>,
    bodies: Triangles,
    shadow_of_bodies: Shadow,
    shadow_of_subject: Shadow,
}

impl<'s> CpuRenderer<'s> {
    /// Prepares to draw `scene` from any place.
    pub fn new(scene: &'s Scene) -> Self {
        let march = March::new(scene);
        let blend = Blend::new(scene, &march);
        let bodies = Triangles::new(scene);
        let light = LightView::new(scene, &bodies);
        let shadow_of_bodies = Shadow::of_bodies(&light, &bodies);
        let shadow_of_subject = Shadow::of_subject(&light, &march);
        Self { scene, march, blend, bodies, shadow_of_bodies, shadow_of_subject }
    }

    /// The scene from the place of `camera`, whose lens is ignored.
    pub fn draw(&self, camera: &Camera, options: &DrawOptions) -> Picture {
        let eye = Eye::new(camera);
        let (width, height) = eye.size();
        let fragments = self.bodies.draw(&eye.projection(), eye.size());
        let painter = PixelPainter::new(self, &eye, *options);

        let mut picture = Picture::new(width, height);
        let Picture { colour, content, depth } = &mut picture;
        let w = width as usize;
        let band = w * TILE;
        let bands =
            colour.par_chunks_mut(3 * band).zip(content.par_chunks_mut(band)).zip(depth.par_chunks_mut(band));
        bands.zip(fragments.par_chunks(band)).enumerate().for_each(
            |(j, (((colour, content), depth), fragments))| {
                let mut lines = Lines::default();
                let starts = painter.tile_starts(j, w, &mut lines);
                let pixels = colour.chunks_exact_mut(3).zip(content).zip(depth).zip(fragments);
                for (index, (((colour, content), depth), fragment)) in pixels.enumerate() {
                    let (x, y) = (index % w, j * TILE + index / w);
                    let at = (x as f32 + 0.5, y as f32 + 0.5);
                    let seen = painter.paint(at, fragment, starts[x / TILE], &mut lines);
                    colour.copy_from_slice(&to_rgb(seen.colour));
                    (*content, *depth) = (seen.content, seen.depth);
                }
            },
        );
        picture
    }
}
