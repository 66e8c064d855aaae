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
mod lanes;
mod march;
mod photos;
mod pixel;
mod raster;
mod shadow;
mod surroundings;

use crate::picture::{Content, DrawOptions, Method, Picture, to_rgb};
use crate::scene::Scene;
#[cfg(feature = "gpu")]
pub(crate) use depth_map::{CELL, VISIBILITY_BIAS};

use blend::Blend;
use eye::Eye;
use march::{Lines, March, Packets};
use ode_visual_hull::camera::Camera;
use pixel::{PixelPainter, TILE};
use raster::{Fragment, Triangles};
use rayon::prelude::*;
use shadow::{GroundLight, LightView, Shadow};
use std::sync::OnceLock;

/// Draws pictures of one scene on the processor. What a picture needs is prepared with the first one that needs it.
#[derive(Debug)]
pub struct CpuRenderer<'s> {
    scene: &'s Scene,
    march: March<'s>,
    bodies: Triangles,
    blend: Blend<'s>,
    shadows: OnceLock<Shadows>,
}

/// The shadows of bodies and subject.
#[derive(Debug)]
struct Shadows {
    bodies: Shadow,
    subject: Shadow,
    /// What reaches the ground past the bodies, and past both.
    past_bodies: GroundLight,
    past_both: GroundLight,
}

/// A row of pixels of a new picture, which shows surroundings alone.
struct Row<'p> {
    y: usize,
    colour: &'p mut [u8],
    content: &'p mut [Content],
    depth: &'p mut [f32],
}

impl Row<'_> {
    /// Paints the pixels, which show `fragments` where no subject is in front of them; it is behind the `starts` of the tiles.
    fn paint(
        self,
        painter: &PixelPainter,
        fragments: &[Fragment],
        starts: &[Option<f32>],
        packets: &mut Packets,
    ) {
        let tiles = self.colour.chunks_mut(3 * TILE).zip(self.content.chunks_mut(TILE));
        let tiles = tiles.zip(self.depth.chunks_mut(TILE)).zip(fragments.chunks(TILE)).zip(starts);
        for (x, ((((colour, content), depth), fragments), start)) in (0..).step_by(TILE).zip(tiles) {
            let at = (x, self.y);
            if let Some(bare) = painter.bare(at, fragments, *start) {
                colour.copy_from_slice(&bare.rgb.as_flattened()[..colour.len()]);
                depth.copy_from_slice(&bare.depth[..depth.len()]);
                continue;
            }
            let seen = painter.paint(at, fragments, *start, packets);
            for (seen, ((colour, content), depth)) in
                seen.zip(colour.chunks_exact_mut(3).zip(content).zip(depth))
            {
                colour.copy_from_slice(&to_rgb(seen.colour));
                (*content, *depth) = (seen.content, seen.depth);
            }
        }
    }
}

impl<'s> CpuRenderer<'s> {
    /// Draws `scene` from any place.
    pub fn new(scene: &'s Scene) -> Self {
        Self {
            scene,
            march: March::new(scene),
            bodies: Triangles::new(scene),
            blend: Blend::new(scene),
            shadows: OnceLock::new(),
        }
    }

    /// The scene from the place of `camera`, whose lens is ignored.
    ///
    /// The method sweep is drawn as blend: it needs a GPU.
    pub fn draw(&self, camera: &Camera, options: &DrawOptions) -> Picture {
        self.composed(camera, options, None)
    }

    /// The scene from the place of `camera` around the subject of `layer`, which a GPU has drawn from there.
    #[cfg(feature = "gpu")]
    pub(crate) fn compose(&self, camera: &Camera, options: &DrawOptions, layer: &Picture) -> Picture {
        self.composed(camera, options, Some(layer))
    }

    fn composed(&self, camera: &Camera, options: &DrawOptions, layer: Option<&Picture>) -> Picture {
        let eye = Eye::new(camera);
        let (width, height) = eye.size();
        // The shape has no colours, and those of a layer are needed only where the camera's own silhouette has more than it.
        let is_coloured_here = layer.is_none() || eye.real_view(self.scene).is_some();
        if options.method != Method::Hull && is_coloured_here {
            self.blend.prepare(&self.march, &eye.origin());
        }
        let bodies = self.bodies.in_image(&eye.projection());
        let painter = PixelPainter::new(self, &eye, *options, layer);

        let mut picture = Picture::new(width, height);
        let Picture { colour, content, depth } = &mut picture;
        let w = width as usize;
        let band = w * TILE;
        let bands = colour.par_chunks_mut(3 * band).zip(content.par_chunks_mut(band));
        let bands = bands.zip(depth.par_chunks_mut(band)).enumerate();
        // Bodies are drawn band by band too: the fragments of a whole picture are larger than the picture.
        bands.for_each_init(Vec::new, |fragments, (j, ((colour, content), depth))| {
            // What decided the last ray must not come from another band: threads take bands in any order.
            let (mut lines, mut packets) = (Lines::default(), Packets::default());
            let first = j * TILE;
            bodies.draw(w, &(first..first + content.len() / w), fragments);
            let starts = painter.tile_starts(j, w, &mut lines);
            let rows = colour
                .chunks_exact_mut(3 * w)
                .zip(content.chunks_exact_mut(w))
                .zip(depth.chunks_exact_mut(w));
            for ((y, ((colour, content), depth)), fragments) in
                (first..).zip(rows).zip(fragments.chunks_exact(w))
            {
                let row = Row { y, colour, content, depth };
                row.paint(&painter, fragments, &starts, &mut packets);
            }
        });
        picture
    }

    fn shadows(&self) -> &Shadows {
        self.shadows.get_or_init(|| {
            let light = LightView::new(self.scene, &self.bodies);
            let (bodies, subject) = rayon::join(
                || Shadow::of_bodies(&light, &self.bodies),
                || Shadow::of_subject(&light, &self.march),
            );
            let past_bodies = GroundLight::past(&[&bodies]);
            let past_both = GroundLight::past(&[&bodies, &subject]);
            Shadows { bodies, subject, past_bodies, past_both }
        })
    }
}
