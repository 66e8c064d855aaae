//! Virtual boxes drawn into a camera's picture, hidden where the real subject is in front.
//!
//! Each box is ray-cast per pixel through the camera's own lens, so that it lands where the camera would see it.
//! Real surfaces close to a box are shaded a little, or the box would seem to float.

use super::simulation::Drawn;
use image::imageops::{FilterType, resize};
use image::{Rgb, RgbImage};
use nalgebra::{Point3, Vector3};
use ode_visual_hull::camera::{Camera, Ray};
use ode_visual_hull::synthetic::Hit;

/// Rays along a pixel's edge.
const RAYS: u32 = 3;

/// Half the width of the dark lines along a box's edges, in metres.
const LINE: f64 = 0.003;

/// How far from a box the surfaces around it are shaded, in metres, and how much at most.
const REACH: f64 = 0.07;
const SHADE: f64 = 0.6;

/// A place to paint what one camera sees, at a size of its own.
pub struct Easel {
    size: (u32, u32),
    lamp: Point3<f64>,
    /// The rays of each pixel, `RAYS` squared of them; `None` beyond the lens model.
    rays: Vec<Option<Ray>>,
}

/// Where a ray meets a box.
struct BoxHit {
    t: f64,
    colour: Vector3<f64>,
}

impl Easel {
    /// For pictures of `camera`, painted `width` pixels wide and lit from `lamp`.
    pub fn new(camera: &Camera, width: u32, lamp: Point3<f64>) -> Self {
        let (w, h) = camera.size();
        let width = width.min(w);
        let height = (h * width).div_ceil(w);
        let pixel = f64::from(w) / f64::from(width) / f64::from(RAYS);
        let ray = |i: u32, j: u32| camera.ray((f64::from(i) + 0.5) * pixel, (f64::from(j) + 0.5) * pixel);
        let of_pixel =
            |x: u32, y: u32| (0..RAYS * RAYS).map(move |k| ray(x * RAYS + k % RAYS, y * RAYS + k / RAYS));
        let rays = (0..height).flat_map(|y| (0..width).flat_map(move |x| of_pixel(x, y))).collect();
        Self { size: (width, height), lamp, rays }
    }

    /// `picture` with `boxes` in it; `real` tells where a ray meets the real subject.
    pub fn paint(&self, picture: &RgbImage, boxes: &[Drawn], real: &dyn Fn(&Ray) -> Option<Hit>) -> RgbImage {
        let (width, height) = self.size;
        let mut image = if picture.dimensions() == self.size {
            picture.clone()
        } else {
            resize(picture, width, height, FilterType::CatmullRom)
        };
        let rays_of_pixel = (RAYS * RAYS) as usize;
        for (pixel, rays) in image.pixels_mut().zip(self.rays.chunks(rays_of_pixel)) {
            let Some(middle) = &rays[rays_of_pixel / 2] else { continue };
            let near: Vec<&Drawn> = boxes.iter().filter(|one| passes(middle, one)).collect();
            if !near.is_empty() {
                *pixel = self.blend(*pixel, middle, rays, &near, boxes, real);
            }
        }
        image
    }

    fn blend(
        &self,
        pixel: Rgb<u8>,
        middle: &Ray,
        rays: &[Option<Ray>],
        near: &[&Drawn],
        boxes: &[Drawn],
        real: &dyn Fn(&Ray) -> Option<Hit>,
    ) -> Rgb<u8> {
        let seen = surface(middle, real);
        let shade = seen.map_or(1.0, |point| 1.0 - shade_at(&point, near.iter().copied()));
        let background = Vector3::from(pixel.0.map(f64::from)) * shade;
        let colour = |ray: &Option<Ray>| {
            let Some(ray) = ray else { return background };
            let Some(hit) = self.box_hit(ray, near, boxes) else { return background };
            if real(ray).is_some_and(|real| real.t < hit.t) { background } else { hit.colour }
        };
        let mean = rays.iter().map(colour).sum::<Vector3<f64>>() / rays.len() as f64;
        Rgb(mean.map(|value| value.round().clamp(0.0, 255.0) as u8).into())
    }

    /// The nearest of the boxes that `ray` meets.
    fn box_hit(&self, ray: &Ray, near: &[&Drawn], boxes: &[Drawn]) -> Option<BoxHit> {
        let hits = near.iter().filter_map(|one| entry(ray, one).map(|(t, axis)| (t, axis, *one)));
        let (t, axis, one) = hits.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let point = ray.at(t);
        let local = one.world_from_box.inverse_transform_point(&point);
        let mut normal = Vector3::zeros();
        normal[axis] = local[axis].signum();
        let normal = one.world_from_box * normal;
        let others = boxes.iter().filter(|other| !std::ptr::eq(*other, one));
        let light = self.light(&point, &normal) * (1.0 - 0.5 * shade_at(&point, others));
        let line = line_at(&local, &one.half, axis);
        Some(BoxHit { t, colour: Vector3::from(one.colour.map(f64::from)) * light * line })
    }

    fn light(&self, point: &Point3<f64>, normal: &Vector3<f64>) -> f64 {
        let to_lamp = (self.lamp - point).normalize();
        0.52 + 0.10 * normal.z + 0.44 * normal.dot(&to_lamp).max(0.0)
    }
}

/// Whether `ray` passes so close to a box that it is seen, or the surfaces around it are shaded.
fn passes(ray: &Ray, one: &Drawn) -> bool {
    let to_box = one.world_from_box.translation.vector - ray.origin.coords;
    let reach = one.half.norm() + REACH;
    to_box.norm_squared() - to_box.dot(&ray.direction).powi(2) <= reach * reach
}

/// The real surface on `ray`: the subject, else the floor.
fn surface(ray: &Ray, real: &dyn Fn(&Ray) -> Option<Hit>) -> Option<Point3<f64>> {
    let floor = (ray.direction.z < 0.0).then(|| -ray.origin.z / ray.direction.z).filter(|&t| t > 0.0);
    real(ray).map(|hit| hit.t).or(floor).map(|t| ray.at(t))
}

/// How much the boxes darken a surface close to them, 0 to `SHADE`.
fn shade_at<'b>(point: &Point3<f64>, boxes: impl Iterator<Item = &'b Drawn>) -> f64 {
    let nearness = |one: &Drawn| (1.0 - distance(point, one) / REACH).max(0.0).powi(2);
    SHADE * boxes.map(nearness).fold(0.0, f64::max)
}

fn distance(point: &Point3<f64>, one: &Drawn) -> f64 {
    let local = one.world_from_box.inverse_transform_point(point);
    (local.coords.abs() - one.half).map(|x| x.max(0.0)).norm()
}

/// Where `ray` enters a box, and across which axis.
fn entry(ray: &Ray, one: &Drawn) -> Option<(f64, usize)> {
    let origin = one.world_from_box.inverse_transform_point(&ray.origin);
    let direction = one.world_from_box.inverse_transform_vector(&ray.direction);
    let (mut enter, mut leave) = ((0.0, 0), f64::INFINITY);
    for axis in 0..3 {
        let (a, b) = (-one.half[axis] - origin[axis], one.half[axis] - origin[axis]);
        let (near, far) = if direction[axis] >= 0.0 { (a, b) } else { (b, a) };
        // A direction of zero gives infinities of the right signs, or NaN on the face itself, which is a miss.
        let (near, far) = (near / direction[axis], far / direction[axis]);
        if near > enter.0 {
            enter = (near, axis);
        }
        leave = leave.min(far);
    }
    (enter.0 > 0.0 && enter.0 < leave).then_some(enter)
}

/// A dark line along the edges of the face across `axis`, with a soft inner side.
fn line_at(local: &Point3<f64>, half: &Vector3<f64>, axis: usize) -> f64 {
    let to_edge = (0..3).filter(|&other| other != axis).map(|other| half[other] - local[other].abs());
    let inwards = to_edge.fold(f64::INFINITY, f64::min) / LINE;
    0.45 + 0.55 * (inwards - 0.5).clamp(0.0, 1.0)
}
