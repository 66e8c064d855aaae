//! One pixel: the nearest of body, subject and surroundings along its ray, in its light.

use super::CpuRenderer;
use super::eye::Eye;
use super::march::{Entry, Lines, Ray};
use super::raster::Fragment;
use super::shadow::DARKNESS;
use super::surroundings::{floor_colour, floor_distance, photo_colour, sky_colour};
use crate::picture::{Colour, Content, DrawOptions, Method, Picture};
use nalgebra::{Point3, Vector3};
use std::ops::Range;

/// The grey of the subject's shape, by the method hull.
const GREY: f32 = 190.0;

/// Pixels along the side of a tile, for which the subject is looked for together first.
pub const TILE: usize = 8;

/// Pixels from a tile's middle to its corner, and a tenth more.
const TILE_REACH: f32 = 6.3;

/// Draws the pixels of one picture.
pub struct PixelPainter<'r, 's> {
    renderer: &'r CpuRenderer<'s>,
    eye: &'r Eye,
    options: DrawOptions,
    /// The subject alone, where a GPU has drawn it.
    layer: Option<&'r Picture>,
    /// The view from whose place the picture is drawn.
    own: Option<usize>,
    light: Vector3<f32>,
}

/// What a pixel shows.
pub struct Seen {
    pub colour: Colour,
    pub content: Content,
    /// Metres along the camera's axis.
    pub depth: f32,
}

impl<'r, 's> PixelPainter<'r, 's> {
    /// Draws what `renderer` has prepared, from `eye`; the subject is taken from `layer` where there is one.
    pub fn new(
        renderer: &'r CpuRenderer<'s>,
        eye: &'r Eye,
        options: DrawOptions,
        layer: Option<&'r Picture>,
    ) -> Self {
        let own = eye.real_view(renderer.scene);
        Self { renderer, eye, options, layer, own, light: renderer.scene.light.cast() }
    }

    /// For each tile in row `j` of tiles, of a picture of this width, the distance before which the subject is in none of its
    /// pixels; `None` if it is in none at all.
    pub fn tile_starts(&self, j: usize, width: usize, lines: &mut Lines) -> Vec<Option<f32>> {
        let middle = |k: usize| (k as f32 + 0.5) * TILE as f32;
        let spread = TILE_REACH * self.eye.radians_per_pixel();
        let start = |i: usize| {
            // The subject is drawn already, or a real camera's silhouette holds pixels that the hull does not.
            if self.layer.is_some() || self.own.is_some() {
                return Some(0.0);
            }
            self.renderer.march.cone_entry(&self.eye.ray(middle(i), middle(j)), spread, lines)
        };
        (0..width.div_ceil(TILE)).map(start).collect()
    }

    /// The pixel in column `x` and row `y`, which shows `fragment` where no subject is in front of it.
    ///
    /// The subject is nowhere nearer than `start` metres; it is not there at all if that is `None`.
    pub fn paint(
        &self,
        (x, y): (usize, usize),
        fragment: &Fragment,
        start: Option<f32>,
        lines: &mut Lines,
    ) -> Seen {
        let ray = self.eye.ray(x as f32 + 0.5, y as f32 + 0.5);
        let scale = self.eye.depth_per_metre(&ray.direction);
        let body = fragment.depth / scale;
        let subject = start.and_then(|start| match self.layer {
            Some(layer) => self.in_layer(layer, (x, y), &ray, scale),
            None => self.marched(&ray, start..body, lines),
        });
        if let Some((colour, t)) = subject.filter(|(_, t)| *t < body) {
            let light = if self.options.shadows { self.subject_light(&ray.at(t)) } else { 1.0 };
            return Seen { colour: colour * shaded(light), content: Content::Subject, depth: t * scale };
        }
        if fragment.depth.is_finite() {
            let colour = self.body(&ray.at(body), fragment);
            return Seen { colour, content: Content::Body, depth: fragment.depth };
        }
        let (colour, t) = self.surroundings(&ray);
        Seen { colour, content: Content::Surroundings, depth: t * scale }
    }

    /// The colour of the subject in a pixel of the `layer`, and its distance along the pixel's ray.
    fn in_layer(
        &self,
        layer: &Picture,
        (x, y): (usize, usize),
        ray: &Ray,
        scale: f32,
    ) -> Option<(Colour, f32)> {
        let index = y * layer.colour.width() as usize + x;
        if layer.content[index] != Content::Subject {
            return self.filled(ray).map(|entry| self.coloured(ray, &entry));
        }
        let pixel = &layer.colour.as_raw()[3 * index..3 * index + 3];
        let drawn = Colour::new(f32::from(pixel[0]), f32::from(pixel[1]), f32::from(pixel[2]));
        Some((self.photo(ray).unwrap_or(drawn), layer.depth[index] / scale))
    }

    /// The colour of the subject along `ray`, if it enters the hull in this `range` of distances, and the surface's distance.
    fn marched(&self, ray: &Ray, range: Range<f32>, lines: &mut Lines) -> Option<(Colour, f32)> {
        let entry = self.renderer.march.entry(ray, range, lines).or_else(|| self.filled(ray))?;
        Some(self.coloured(ray, &entry))
    }

    /// The colour of the subject where `ray` enters the hull, and the distance of its surface.
    fn coloured(&self, ray: &Ray, entry: &Entry) -> (Colour, f32) {
        let march = &self.renderer.march;
        match (self.photo(ray), self.options.method) {
            (Some(colour), _) => (colour, entry.t),
            (None, Method::Hull) => {
                let normal = march.normal(&ray.at(entry.t), entry.view);
                (Colour::repeat(GREY) * self.brightness(&normal), entry.t)
            }
            (None, _) => self.renderer.blend.colour(march, ray, entry.t, self.options.refine),
        }
    }

    /// Where the subject is along `ray`, which misses the hull, but belongs to the silhouette of the real camera at this place:
    /// that silhouette has no holes.
    fn filled(&self, ray: &Ray) -> Option<Entry> {
        let own = self.own?;
        let view = &self.renderer.march.views()[own];
        view.is_subject(&view.homogeneous(&ray.at(1.0)))
            .then(|| self.renderer.march.least_outside(ray, own))?
    }

    /// The colour along `ray` in the image of the real camera at this place, if that is shown.
    fn photo(&self, ray: &Ray) -> Option<Colour> {
        let own = self.own.filter(|_| self.options.snap)?;
        let photo = self.renderer.scene.views[own].colours()?;
        photo_colour(photo, &self.renderer.march.views()[own].homogeneous(&ray.at(1.0)))
    }

    /// The colour of a body at `point`.
    fn body(&self, point: &Point3<f32>, fragment: &Fragment) -> Colour {
        let light = if self.options.shadows { self.body_light(point, &fragment.normal) } else { 1.0 };
        fragment.colour * self.brightness(&fragment.normal) * shaded(light)
    }

    /// Floor, sky or photograph along `ray`, and the distance of the floor.
    fn surroundings(&self, ray: &Ray) -> (Colour, f32) {
        let floor = self.renderer.scene.floor.and_then(|floor| floor_distance(ray, floor as f32));
        let t = floor.unwrap_or(f32::INFINITY);
        if let Some(colour) = self.photo(ray) {
            // The photograph shows the subject's own shadow.
            let light = match floor {
                Some(t) if self.options.shadows => self.renderer.shadows().past_bodies.at(&ray.at(t)),
                _ => 1.0,
            };
            return (colour * shaded(light), t);
        }
        if !self.options.surroundings {
            return (Colour::zeros(), t);
        }
        let Some(t) = floor.filter(|_| ray.direction.z < 0.0) else { return (sky_colour(ray), t) };
        let point = ray.at(t);
        let light = if self.options.shadows { self.renderer.shadows().past_both.at(&point) } else { 1.0 };
        (floor_colour(&point, t, self.eye.footprint(t) / -ray.direction.z, shaded(light)), t)
    }

    /// The part of the light that reaches `point` of the subject past the bodies; its images show its own shadows.
    fn subject_light(&self, point: &Point3<f32>) -> f32 {
        let lit = self.renderer.shadows().bodies.at(point, &-self.light);
        if lit == 1.0 {
            return lit;
        }
        // Most points are in no shadow, so that few need a normal.
        self.renderer.shadows().bodies.at(point, &self.renderer.march.normal_near(point))
    }

    /// The part of the light that reaches `point` on a body.
    fn body_light(&self, point: &Point3<f32>, normal: &Vector3<f32>) -> f32 {
        let shadows = self.renderer.shadows();
        shadows.bodies.at(point, normal).min(shadows.subject.at(point, normal))
    }

    /// Brightness of a surface with this outward normal.
    fn brightness(&self, normal: &Vector3<f32>) -> f32 {
        0.60 + 0.12 * normal.z + 0.16 * normal.dot(&Vector3::new(0.5, -0.7, 0.5))
            - 0.16 * normal.dot(&self.light)
    }
}

/// How bright a surface is that `light` of the light reaches.
fn shaded(light: f32) -> f32 {
    1.0 - DARKNESS * (1.0 - light)
}
