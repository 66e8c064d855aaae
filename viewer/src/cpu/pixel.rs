//! One pixel: the nearest of body, subject and surroundings along its ray, in its light.

use super::CpuRenderer;
use super::eye::Eye;
use super::lanes::LANES;
use super::march::{Entry, Lines, Packets, Ray};
use super::raster::Fragment;
use super::shadow::shaded;
use super::surroundings::{Backdrop, BarePixels, backdrop, bare_pixels, floor_distance, photo_colours};
use crate::picture::{Colour, Content, DrawOptions, Method, Picture};
use nalgebra::{Point3, Vector3};

/// The grey of the subject's shape, by the method hull.
const GREY: f32 = 190.0;

/// Pixels along the side of a tile, for which the subject is looked for together first.
pub const TILE: usize = LANES;

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

    /// The pixels of one row of a tile, from column `x` on in row `y`, if they show nothing but floor and sky for sure: no body's
    /// `fragments`, and no subject, which `start` tells.
    pub fn bare(
        &self,
        (x, y): (usize, usize),
        fragments: &[Fragment],
        start: Option<f32>,
    ) -> Option<BarePixels> {
        let is_bare = start.is_none() && self.options.surroundings;
        if !is_bare || fragments.iter().any(|fragment| fragment.depth.is_finite()) {
            return None;
        }
        let floor = self.renderer.scene.floor.map(|floor| floor as f32);
        let light = self.options.shadows.then(|| &self.renderer.shadows().past_both);
        Some(bare_pixels(self.eye, (x, y), floor, light))
    }

    /// The pixels of one row of a tile, from column `x` on in row `y`, which show `fragments` where no subject is in front of
    /// them. The subject is nowhere nearer than `start` metres; it is not there at all if that is `None`.
    pub fn paint(
        &self,
        (x, y): (usize, usize),
        fragments: &[Fragment],
        start: Option<f32>,
        packets: &mut Packets,
    ) -> impl Iterator<Item = Seen> {
        let rays = std::array::from_fn(|k| self.eye.ray((x + k) as f32 + 0.5, y as f32 + 0.5));
        let photo = self.photo(&rays);
        let subject = match (start, self.layer) {
            (None, _) => [None; TILE],
            (Some(_), Some(layer)) => self.in_layer(layer, (x, y), &rays, &photo, packets),
            (Some(start), None) => self.in_hull(&rays, fragments, start, &photo, packets),
        };
        let mut behind = None;
        let pixel = move |k: usize| {
            let in_front = self.in_front(&rays[k], &fragments[k], subject[k]);
            in_front.unwrap_or_else(|| self.surroundings(&rays, k, photo[k], &mut behind))
        };
        (0..fragments.len()).map(pixel)
    }

    /// The subject or body along `ray`, where the `subject` has this colour at this distance.
    fn in_front(&self, ray: &Ray, fragment: &Fragment, subject: Option<(Colour, f32)>) -> Option<Seen> {
        let scale = self.eye.depth_per_metre(&ray.direction);
        let body = fragment.depth / scale;
        if let Some((colour, t)) = subject.filter(|(_, t)| *t < body) {
            let light = if self.options.shadows { self.subject_light(&ray.at(t)) } else { 1.0 };
            return Some(Seen {
                colour: colour * shaded(light),
                content: Content::Subject,
                depth: t * scale,
            });
        }
        fragment.depth.is_finite().then(|| {
            let colour = self.body(&ray.at(body), fragment);
            Seen { colour, content: Content::Body, depth: fragment.depth }
        })
    }

    /// The colours of the subject along `rays`, which is nowhere nearer than `start`, and its distances, where its hull is in
    /// front of the `fragments`; `photo` are its colours from the place of a real camera.
    fn in_hull(
        &self,
        rays: &[Ray; TILE],
        fragments: &[Fragment],
        start: f32,
        photo: &[Option<Colour>; TILE],
        packets: &mut Packets,
    ) -> [Option<(Colour, f32)>; TILE] {
        let range = |k: usize| match fragments.get(k) {
            Some(fragment) => start..fragment.depth / self.eye.depth_per_metre(&rays[k].direction),
            None => f32::INFINITY..0.0,
        };
        let entries = self.renderer.march.entries(rays, &std::array::from_fn(range), packets);
        let entries = std::array::from_fn(|k| entries[k].or_else(|| self.filled(&rays[k])));
        self.coloured(rays, &entries, photo, packets)
    }

    /// The colours of the subject in pixels of the `layer` from column `x` on in row `y`, and its distances along their `rays`.
    fn in_layer(
        &self,
        layer: &Picture,
        (x, y): (usize, usize),
        rays: &[Ray; TILE],
        photo: &[Option<Colour>; TILE],
        packets: &mut Packets,
    ) -> [Option<(Colour, f32)>; TILE] {
        let width = layer.colour.width() as usize;
        let drawn: [_; TILE] = std::array::from_fn(|k| {
            let index = y * width + x + k;
            if x + k >= width || layer.content[index] != Content::Subject {
                return None;
            }
            let pixel = &layer.colour.as_raw()[3 * index..3 * index + 3];
            let drawn = Colour::new(f32::from(pixel[0]), f32::from(pixel[1]), f32::from(pixel[2]));
            let t = layer.depth[index] / self.eye.depth_per_metre(&rays[k].direction);
            Some((photo[k].unwrap_or(drawn), t))
        });
        let filled = std::array::from_fn(|k| if drawn[k].is_some() { None } else { self.filled(&rays[k]) });
        let filled = self.coloured(rays, &filled, photo, packets);
        std::array::from_fn(|k| drawn[k].or(filled[k]))
    }

    /// The colours of the subject where `rays` enter the hull, and the distances of its surface; `photo` are its colours from the
    /// place of a real camera.
    fn coloured(
        &self,
        rays: &[Ray; TILE],
        entries: &[Option<Entry>; TILE],
        photo: &[Option<Colour>; TILE],
        packets: &mut Packets,
    ) -> [Option<(Colour, f32)>; TILE] {
        let march = &self.renderer.march;
        let needs_colour = |k: usize| entries[k].is_some() && photo[k].is_none();
        let blended = ((0..TILE).any(needs_colour) && self.options.method != Method::Hull).then(|| {
            let t = entries.map(|entry| entry.map_or(0.0, |entry| entry.t));
            self.renderer.blend.colours(march, rays, &t, self.options.refine, packets)
        });
        std::array::from_fn(|k| {
            let entry = entries[k]?;
            Some(match (photo[k], &blended) {
                (Some(colour), _) => (colour, entry.t),
                (None, Some(blended)) => blended.of_ray(k),
                (None, None) => {
                    let normal = march.normal(&rays[k].at(entry.t), entry.view);
                    (Colour::repeat(GREY) * self.brightness(&normal), entry.t)
                }
            })
        })
    }

    /// Where the subject is along `ray`, which misses the hull, but belongs to the silhouette of the real camera at this place:
    /// that silhouette has no holes.
    fn filled(&self, ray: &Ray) -> Option<Entry> {
        let own = self.own?;
        let view = &self.renderer.march.views()[own];
        view.is_subject(&view.homogeneous(&ray.at(1.0)))
            .then(|| self.renderer.march.least_outside(ray, own))?
    }

    /// The colours along `rays` in the image of the real camera at this place, if that is shown.
    fn photo(&self, rays: &[Ray; TILE]) -> [Option<Colour>; TILE] {
        let own = self.own.filter(|_| self.options.snap);
        let photo = own.and_then(|own| Some((self.renderer.scene.views[own].colours()?, own)));
        photo.map_or([None; TILE], |(photo, own)| {
            photo_colours(photo, &self.renderer.march.views()[own], rays)
        })
    }

    /// The colour of a body at `point`.
    fn body(&self, point: &Point3<f32>, fragment: &Fragment) -> Colour {
        let light = if self.options.shadows { self.body_light(point, &fragment.normal) } else { 1.0 };
        fragment.colour * self.brightness(&fragment.normal) * shaded(light)
    }

    /// Floor, sky or the photograph's colour `photo` along ray number `k`; `behind` keeps what all rays see of floor and sky.
    fn surroundings(
        &self,
        rays: &[Ray; TILE],
        k: usize,
        photo: Option<Colour>,
        behind: &mut Option<Backdrop>,
    ) -> Seen {
        let floor = self.renderer.scene.floor.map(|floor| floor as f32);
        let (colour, t) = match photo {
            Some(colour) => self.photographed(&rays[k], colour, floor),
            None if self.options.surroundings => {
                let light = self.options.shadows.then(|| &self.renderer.shadows().past_both);
                let all = || backdrop(rays, floor, self.eye.radians_per_pixel(), light);
                behind.get_or_insert_with(all).seen(k)
            }
            None => {
                let t = floor.and_then(|floor| floor_distance(&rays[k], floor));
                (Colour::zeros(), t.unwrap_or(f32::INFINITY))
            }
        };
        let depth = t * self.eye.depth_per_metre(&rays[k].direction);
        Seen { colour, content: Content::Surroundings, depth }
    }

    /// The `colour` of a photograph along `ray` in the shadows of the bodies, and the distance of the floor. The photograph
    /// shows the subject's own shadow.
    fn photographed(&self, ray: &Ray, colour: Colour, floor: Option<f32>) -> (Colour, f32) {
        let floor = floor.and_then(|floor| floor_distance(ray, floor));
        let light = match floor {
            Some(t) if self.options.shadows => self.renderer.shadows().past_bodies.at(&ray.at(t)),
            _ => 1.0,
        };
        (colour * shaded(light), floor.unwrap_or(f32::INFINITY))
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
