//! The renderer without a GPU, which is also the reference for the one with it.

mod blend;
mod depth_map;
mod eye;
mod march;

use crate::picture::{Colour, Content, DrawOptions, Method, Picture, to_rgb};
use crate::scene::Scene;
use blend::Blend;
use eye::Eye;
use march::{Lines, March, Ray};
use ode_visual_hull::Result;
use ode_visual_hull::camera::Camera;
use rayon::prelude::*;

/// Draws pictures of one scene on the processor.
#[derive(Debug)]
pub struct CpuRenderer<'s> {
    scene: &'s Scene,
    march: March<'s>,
    blend: Blend<'s>,
}

impl<'s> CpuRenderer<'s> {
    /// Prepares to draw `scene`.
    pub fn new(scene: &'s Scene) -> Self {
        let march = March::new(scene);
        let blend = Blend::new(scene, &march);
        Self { scene, march, blend }
    }

    /// The scene from the place of `camera`.
    ///
    /// # Errors
    /// A camera inside the subject.
    pub fn draw(&self, camera: &Camera, options: &DrawOptions) -> Result<Picture> {
        let eye = Eye::new(camera);
        let (width, height) = eye.size();
        let mut picture = Picture::new(width, height);
        let Picture { colour, content, depth } = &mut picture;
        let w = width as usize;
        let rows = colour.par_chunks_mut(3 * w).zip(content.par_chunks_mut(w)).zip(depth.par_chunks_mut(w));
        rows.enumerate().for_each(|(y, ((colour, content), depth))| {
            let mut lines = Lines::default();
            let pixels = colour.chunks_exact_mut(3).zip(content).zip(depth);
            for (x, ((colour, content), depth)) in pixels.enumerate() {
                let ray = eye.ray(x as f32 + 0.5, y as f32 + 0.5);
                let Some((found, t)) = self.subject(&ray, f32::MAX, options, &mut lines) else { continue };
                colour.copy_from_slice(&to_rgb(found));
                *content = Content::Subject;
                *depth = t * eye.depth_per_metre(&ray.direction);
            }
        });
        Ok(picture)
    }

    /// The colour of the subject along `ray`, and its distance, if that is less than `within` metres.
    fn subject(
        &self,
        ray: &Ray,
        within: f32,
        options: &DrawOptions,
        lines: &mut Lines,
    ) -> Option<(Colour, f32)> {
        let entry = self.march.entry(ray, 0.0..within, lines)?;
        Some(match options.method {
            Method::Hull => {
                let normal = self.march.normal(&ray.at(entry.t), entry.view);
                let light = -normal.dot(&self.scene.light.cast());
                (Colour::repeat(140.0 + 80.0 * light), entry.t)
            }
            _ => self.blend.colour(&self.march, ray, entry.t, options.refine),
        })
    }
}
