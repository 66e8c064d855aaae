//! The colours of the subject: those of the real cameras that see a point best, blended.
//!
//! A camera counts by the angle between its ray and the picture's (Buehler et al. 2001, unstructured lumigraph), by
//! whether the hull hides the point from it, and less near its silhouette's edge, where its pixels are mixed with
//! background.

use super::depth_map::DepthMap;
use super::march::{March, MarchView, Ray};
use crate::picture::Colour;
use crate::scene::{Scene, SceneView};
use image::RgbImage;
use nalgebra::{Point3, Vector3};

/// The number of cameras whose colours are blended.
pub const BEST: usize = 3;

/// The square of the angle, in radians, from which on angles are told apart.
const SAME_ANGLE: f32 = 1e-6;

/// Pixels from the silhouette's edge within which a camera counts less.
const FEATHER_PX: f32 = 3.0;

/// The weight of a camera that does not see a point, so that it is coloured even where no camera sees it.
const UNSEEN_WEIGHT: f32 = 1e-4;

/// Metres into the hull within which colours may agree better than on its surface, and the number of steps.
const REFINED_DEPTH: f32 = 0.08;
const REFINED_STEPS: u32 = 8;

/// How much more colours have to agree for a metre more of depth, in grey levels.
const DEPTH_PENALTY: f32 = 60.0;

/// The cameras that give the subject its colours.
#[derive(Debug)]
pub struct Blend<'s> {
    cameras: Vec<ColourCamera<'s>>,
}

/// A real camera that gives colours.
#[derive(Debug)]
struct ColourCamera<'s> {
    /// Its index among the scene's views.
    view: usize,
    centre: Point3<f32>,
    photo: &'s RgbImage,
    depth_map: DepthMap,
}

/// The best cameras for a point, with their weights, greatest first; weights of zero are cameras that do not count.
type Choice = [(usize, f32); BEST];

impl<'s> Blend<'s> {
    /// The cameras of `scene` with colours.
    pub fn new(scene: &'s Scene, march: &March) -> Self {
        let camera = |(view, one): (usize, &'s SceneView)| {
            one.colours().map(|photo| ColourCamera {
                view,
                centre: one.centre().cast(),
                photo,
                depth_map: DepthMap::new(march, one, view),
            })
        };
        Self { cameras: scene.views.iter().enumerate().filter_map(camera).collect() }
    }

    /// The colour of the subject where `ray` enters the hull, at distance `t`, and the distance of the surface along the ray: `t`,
    /// or behind it where `refine` finds colours that agree.
    pub fn colour(&self, march: &March, ray: &Ray, t: f32, refine: bool) -> (Colour, f32) {
        let point = ray.at(t);
        let choice = self.choose(march, &point, &ray.direction);
        let t = if refine { self.refined(march, ray, t, &choice) } else { t };
        let point = ray.at(t);
        let (mut sum, mut total) = (Colour::zeros(), 0.0);
        for (camera, weight) in choice.iter().filter(|(_, weight)| *weight > 0.0) {
            sum += self.colour_in(march, *camera, &point) * *weight;
            total += weight;
        }
        (if total > 0.0 { sum / total } else { sum }, t)
    }

    /// The best cameras for `point` as seen along `direction`.
    fn choose(&self, march: &March, point: &Point3<f32>, direction: &Vector3<f32>) -> Choice {
        let mut best = [(0, 0.0); BEST + 1];
        for (index, camera) in self.cameras.iter().enumerate() {
            let view = &march.views()[camera.view];
            let weight = camera.weight(view, point, direction);
            if let Some(place) = best.iter().position(|(_, other)| weight > *other) {
                best[place..].rotate_right(1);
                best[place] = (index, weight);
            }
        }

        // Less the weight of the first camera that is left out: none comes or goes with a step of the colour.
        let rest = best[BEST].1;
        [0, 1, 2].map(|k| (best[k].0, (best[k].1 - rest).max(0.0)))
    }

    /// The distance along `ray` from `t` to a little into the hull at which the colours of the chosen cameras agree best.
    fn refined(&self, march: &March, ray: &Ray, t: f32, choice: &Choice) -> f32 {
        let mut best = (f32::INFINITY, t);
        for step in 0..=REFINED_STEPS {
            let deeper = REFINED_DEPTH * step as f32 / REFINED_STEPS as f32;
            let Some(deviation) = self.deviation(march, &ray.at(t + deeper), choice) else { break };
            let cost = deviation + DEPTH_PENALTY * deeper;
            if cost < best.0 {
                best = (cost, t + deeper);
            }
        }
        best.1
    }

    /// How far the colours of the chosen cameras at `point` are from their mean, in grey levels; `None` outside the hull, or
    /// with a single camera.
    fn deviation(&self, march: &March, point: &Point3<f32>, choice: &Choice) -> Option<f32> {
        let mut colours = [(Colour::zeros(), 0.0); BEST];
        let (mut mean, mut total) = (Colour::zeros(), 0.0);
        let mut count = 0;
        for ((camera, weight), colour) in choice.iter().zip(&mut colours) {
            if *weight > 0.0 {
                *colour = (self.colour_in(march, *camera, point), 1.0);
                mean += colour.0;
                total += 1.0;
                count += 1;
            }
        }
        if count < 2 {
            return None;
        }
        mean /= total;
        let sum: f32 = colours.iter().map(|(colour, weight)| (colour - mean).abs().sum() * weight).sum();
        Some(sum / (3.0 * total))
    }

    fn colour_in(&self, march: &March, camera: usize, point: &Point3<f32>) -> Colour {
        let camera = &self.cameras[camera];
        let h = march.views()[camera.view].homogeneous(point);
        sample(camera.photo, h.x / h.z, h.y / h.z)
    }
}

impl ColourCamera<'_> {
    /// How much the camera's colour counts at `point`, seen along `direction`.
    fn weight(&self, view: &MarchView, point: &Point3<f32>, direction: &Vector3<f32>) -> f32 {
        let h = view.homogeneous(point);
        let (u, v) = (h.x / h.z, h.y / h.z);
        let (width, height) = (self.photo.width() as f32, self.photo.height() as f32);
        if h.z <= 0.0 || u < 0.0 || v < 0.0 || u >= width || v >= height {
            return 0.0;
        }
        let to_point = (point - self.centre).normalize();
        // Twice one minus the cosine is the square of a small angle.
        let squared_angle = 2.0 * (1.0 - to_point.dot(direction)).max(0.0);
        let feather = (-view.distance(u, v) / FEATHER_PX).clamp(0.0, 1.0);
        let seen = self.depth_map.visibility(&h) * feather;
        (seen + UNSEEN_WEIGHT) / (squared_angle + SAME_ANGLE)
    }
}

/// The colour at image position `(u, v)`, bilinear between pixel centres.
pub fn sample(image: &RgbImage, u: f32, v: f32) -> Colour {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let x = (u - 0.5).clamp(0.0, (width - 1) as f32);
    let y = (v - 0.5).clamp(0.0, (height - 1) as f32);
    let (i, j) = (x as usize, y as usize);
    let (right, below) = (x - i as f32, y - j as f32);
    let step = if i + 1 < width { 3 } else { 0 };
    let stride = if j + 1 < height { 3 * width } else { 0 };
    let first = 3 * (j * width + i);
    let at = |index: usize| {
        let pixel = &image.as_raw()[index..index + 3];
        Colour::new(f32::from(pixel[0]), f32::from(pixel[1]), f32::from(pixel[2]))
    };
    let upper = at(first) * (1.0 - right) + at(first + step) * right;
    let lower = at(first + stride) * (1.0 - right) + at(first + stride + step) * right;
    upper * (1.0 - below) + lower * below
}
