//! Draws virtual bodies into a camera's picture, hidden where the real subject is in front.
//!
//! Bodies are ray-cast pixel by pixel through the camera's own lens, so that they appear where the camera would see
//! them. Real surfaces close to a body are shaded a little, or the body would seem to float.

use crate::ray_cast::{self, EntryPoint};
use crate::window::Window;
use image::RgbImage;
use image::imageops::{FilterType, crop_imm, resize};
use nalgebra::{Isometry3, Point3, Vector3};
use ode_visual_hull::camera::{Camera, Ray};
use ode_visual_hull::shape::Shape;
use ode_visual_hull::synthetic::Hit;

/// Rays along the edge of a pixel.
const RAYS: u32 = 2;

const RAYS_OF_PIXEL: usize = (RAYS * RAYS) as usize;

/// Number of threads, each of which draws a band of rows.
const BANDS: u32 = 4;

/// Small windows are enlarged by at most this factor.
const MAX_SCALE: f64 = 2.5;

/// Distance from a body up to which surfaces are shaded, in metres.
const SHADE_DISTANCE: f64 = 0.07;

/// The darkest shade: the part of the light that is taken away.
const MAX_SHADE: f64 = 0.6;

/// A body to draw.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// A box, a sphere or a capsule; other shapes are not drawn.
    pub shape: Shape,
    /// Its pose.
    pub world_from_body: Isometry3<f64>,
    /// Red, green, blue.
    pub colour: [u8; 3],
}

/// Draws pictures of one camera, at a size of their own.
#[derive(Debug)]
pub struct Compositor {
    window: Window,
    size: (u32, u32),
    light: Point3<f64>,
    /// The rays of each pixel, `RAYS_OF_PIXEL` of them; `None` beyond the lens model.
    rays: Vec<Option<Ray>>,
}

/// Where a ray meets the real subject.
pub type Real<'r> = &'r (dyn Fn(&Ray) -> Option<Hit> + Sync);

/// Where a ray meets a body.
struct BodyHit {
    t: f64,
    colour: Vector3<f64>,
}

impl Compositor {
    /// A compositor for the `window` of pictures of `camera`, drawn with a longer side of `size` pixels and lit by a
    /// lamp at `light`.
    pub fn new(camera: &Camera, window: Window, size: u32, light: Point3<f64>) -> Self {
        let longer = window.width.max(window.height);
        let scale = (f64::from(size) / f64::from(longer)).min(MAX_SCALE);
        let scaled = |length: u32| (f64::from(length) * scale).round().max(1.0) as u32;
        let (width, height) = (scaled(window.width), scaled(window.height));
        let step = 1.0 / scale / f64::from(RAYS);
        let along = |first: u32, i: u32| f64::from(first) + (f64::from(i) + 0.5) * step;
        let ray = |i: u32, j: u32| camera.ray(along(window.left, i), along(window.top, j));
        let of_pixel =
            |x: u32, y: u32| (0..RAYS * RAYS).map(move |k| ray(x * RAYS + k % RAYS, y * RAYS + k / RAYS));
        let rays = (0..height).flat_map(|y| (0..width).flat_map(move |x| of_pixel(x, y))).collect();
        Self { window, size: (width, height), light, rays }
    }

    /// The window of `picture` with `bodies` in it. `real` finds where a ray meets the real subject.
    pub fn draw(&self, picture: &RgbImage, bodies: &[Drawn], real: Real) -> RgbImage {
        let Window { left, top, width, height } = self.window;
        let part = crop_imm(picture, left, top, width, height).to_image();
        let mut image = resize(&part, self.size.0, self.size.1, FilterType::CatmullRom);
        let rows = self.size.1.div_ceil(BANDS) as usize;
        let row = self.size.0 as usize;
        std::thread::scope(|scope| {
            let rays = self.rays.chunks(rows * row * RAYS_OF_PIXEL);
            for (pixels, rays) in image.chunks_mut(3 * rows * row).zip(rays) {
                scope.spawn(move || self.draw_pixels(pixels, rays, bodies, real));
            }
        });
        image
    }

    fn draw_pixels(&self, pixels: &mut [u8], rays: &[Option<Ray>], bodies: &[Drawn], real: Real) {
        for (pixel, rays) in pixels.chunks_mut(3).zip(rays.chunks(RAYS_OF_PIXEL)) {
            let Some(first) = &rays[0] else { continue };
            let near: Vec<&Drawn> = bodies.iter().filter(|one| passes(first, one)).collect();
            if !near.is_empty() {
                let before = Vector3::from_fn(|c, _| f64::from(pixel[c]));
                let after = self.blend(&before, rays, first, &near, bodies, real);
                pixel.copy_from_slice(&<[u8; 3]>::from(
                    after.map(|value| value.round().clamp(0.0, 255.0) as u8),
                ));
            }
        }
    }

    /// A pixel's colour with the bodies that are `near` its rays.
    fn blend(
        &self,
        pixel: &Vector3<f64>,
        rays: &[Option<Ray>],
        first: &Ray,
        near: &[&Drawn],
        bodies: &[Drawn],
        real: Real,
    ) -> Vector3<f64> {
        let surface = surface(first, real);
        let background = pixel * surface.map_or(1.0, |point| 1.0 - shade_at(&point, near.iter().copied()));

        // Each ray shows the nearest of body and real subject.
        let colour = |ray: &Option<Ray>| {
            let Some(ray) = ray else { return background };
            let Some(hit) = self.body_hit(ray, near, bodies) else { return background };
            if real(ray).is_some_and(|real| real.t < hit.t) { background } else { hit.colour }
        };
        rays.iter().map(colour).sum::<Vector3<f64>>() / rays.len() as f64
    }

    /// The nearest of the bodies that `ray` meets.
    fn body_hit(&self, ray: &Ray, near: &[&Drawn], bodies: &[Drawn]) -> Option<BodyHit> {
        let hits = near.iter().filter_map(|one| entry(ray, one).map(|entry| (entry, *one)));
        let (entry, one) = hits.min_by(|a, b| a.0.t.total_cmp(&b.0.t))?;
        let point = ray.at(entry.t);
        let local = one.world_from_body.inverse_transform_point(&point);
        let normal = one.world_from_body * ray_cast::normal(&one.shape, &local, &entry);
        let others = bodies.iter().filter(|other| !std::ptr::eq(*other, one));

        // A body is lit by the lamp, and shaded by the others.
        let light = self.brightness(&point, &normal) * (1.0 - 0.5 * shade_at(&point, others));
        let line = ray_cast::line_brightness(&one.shape, &local, &entry);
        Some(BodyHit { t: entry.t, colour: Vector3::from(one.colour.map(f64::from)) * light * line })
    }

    /// Brightness of a surface in the light of the lamp and the surroundings.
    fn brightness(&self, point: &Point3<f64>, normal: &Vector3<f64>) -> f64 {
        let to_light = (self.light - point).normalize();
        0.58 + 0.10 * normal.z + 0.40 * normal.dot(&to_light).max(0.0)
    }
}

/// Whether `ray` passes so close to a body that it may show the body or its shade.
fn passes(ray: &Ray, one: &Drawn) -> bool {
    let to_body = one.world_from_body.translation.vector - ray.origin.coords;
    let reach = ray_cast::bounding_radius(&one.shape) + SHADE_DISTANCE;
    to_body.norm_squared() - to_body.dot(&ray.direction).powi(2) <= reach * reach
}

/// The real surface that `ray` meets: the subject, else the floor.
fn surface(ray: &Ray, real: Real) -> Option<Point3<f64>> {
    let floor = (ray.direction.z < 0.0).then(|| -ray.origin.z / ray.direction.z).filter(|&t| t > 0.0);
    real(ray).map(|hit| hit.t).or(floor).map(|t| ray.at(t))
}

/// The part of the light that the bodies take away from a surface close to them, 0 to [`MAX_SHADE`].
fn shade_at<'b>(point: &Point3<f64>, bodies: impl Iterator<Item = &'b Drawn>) -> f64 {
    let nearness = |one: &Drawn| (1.0 - distance(point, one) / SHADE_DISTANCE).max(0.0).powi(2);
    MAX_SHADE * bodies.map(nearness).fold(0.0, f64::max)
}

fn distance(point: &Point3<f64>, one: &Drawn) -> f64 {
    ray_cast::distance(&one.shape, &one.world_from_body.inverse_transform_point(point))
}

/// Where `ray` enters a body.
fn entry(ray: &Ray, one: &Drawn) -> Option<EntryPoint> {
    let in_body = Ray {
        origin: one.world_from_body.inverse_transform_point(&ray.origin),
        direction: one.world_from_body.inverse_transform_vector(&ray.direction),
    };
    ray_cast::entry(&one.shape, &in_body)
}
