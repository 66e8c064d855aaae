//! The colours of the subject: those of the real cameras that see a point best, blended.
//!
//! A camera counts by the angle between its ray and the picture's (Buehler et al. 2001, unstructured lumigraph), by
//! whether the hull hides the point from it, and less near its silhouette's edge, where its pixels are mixed with
//! background.

use super::depth_map::DepthMap;
use super::march::{Line, March, MarchView, Ray};
use crate::picture::Colour;
use crate::scene::{Scene, SceneView};
use image::RgbImage;
use nalgebra::{Point3, Vector3};
use std::sync::OnceLock;

/// The number of cameras whose colours are blended.
pub const BEST: usize = 3;

/// Cameras whose directions from the subject differ by less than this from the viewpoint's may count, in radians.
const SAME_SIDE: f32 = 1.9;

/// The fourth power of the angle, in radians, from which on angles are told apart.
const SAME_ANGLE: f32 = 1e-6;

/// Pixels from the silhouette's edge within which a camera counts less.
const FEATHER_PX: f32 = 3.0;

/// How much a camera counts that does not see a point: the hull of few cameras is so large that it often does.
const UNSEEN: f32 = 0.1;

/// How far into the hull colours may agree better than on its surface, in metres, and the number of steps to there.
const REFINED_DEPTH: f32 = 0.08;
const REFINED_STEPS: u32 = 4;

/// How much more colours have to agree for a metre more of depth, in grey levels.
const DEPTH_PENALTY: f32 = 60.0;

/// A depth at which colours agree worse by this, in grey levels, counts less by e.
const SOFTNESS: f32 = 5.0;

/// The cameras that give the subject its colours.
#[derive(Debug)]
pub struct Blend<'s> {
    scene: &'s Scene,
    cameras: Vec<ColourCamera<'s>>,
}

/// A real camera that gives colours.
#[derive(Debug)]
struct ColourCamera<'s> {
    /// Its index among the scene's views.
    view: usize,
    centre: Point3<f32>,
    photo: &'s RgbImage,
    /// Made for the first picture in which the camera may count.
    depth_map: OnceLock<DepthMap>,
}

/// The best cameras for a point, the best first.
type Choice = [Chosen; BEST];

/// A camera that gives a point its colour.
#[derive(Debug, Clone, Copy, Default)]
struct Chosen {
    camera: usize,
    /// How much its colour counts; 0 for a place that no camera has.
    weight: f32,
}

/// The colours of the chosen cameras at a point.
struct Agreement {
    /// Their weighted mean.
    mean: Colour,
    /// Their mean distance from a common colour, in grey levels.
    deviation: f32,
}

impl<'s> Blend<'s> {
    /// The cameras of `scene` with colours.
    pub fn new(scene: &'s Scene) -> Self {
        let camera = |(view, one): (usize, &'s SceneView)| {
            let photo = one.colours()?;
            Some(ColourCamera { view, centre: one.centre().cast(), photo, depth_map: OnceLock::new() })
        };
        Self { scene, cameras: scene.views.iter().enumerate().filter_map(camera).collect() }
    }

    /// Makes the depth maps of the cameras that count in a picture from `origin`: of those that are on the same side of the
    /// subject, or of all if there are none.
    pub fn prepare(&self, march: &March, origin: &Point3<f32>) {
        let middle: Point3<f32> = self.scene.hull.aabb().centre().cast();
        let is_near = |camera: &&ColourCamera| (camera.centre - middle).angle(&(origin - middle)) < SAME_SIDE;
        let mut near: Vec<_> = self.cameras.iter().filter(is_near).collect();
        if near.is_empty() {
            near.extend(&self.cameras);
        }
        for camera in near {
            camera
                .depth_map
                .get_or_init(|| DepthMap::new(march, &self.scene.views[camera.view], camera.view));
        }
    }

    /// The colour of the subject where `ray` enters the hull, at distance `t`, and the distance of the surface along the ray: `t`,
    /// or behind it where `refine` finds that colours agree better there.
    pub fn colour(&self, march: &March, ray: &Ray, t: f32, refine: bool) -> (Colour, f32) {
        let choice = self.choose(march, &ray.at(t), &ray.direction);
        let lines = choice.map(|chosen| march.views()[self.cameras[chosen.camera].view].line(ray));
        if !refine {
            return (self.agreement(&lines, t, &choice).mean, t);
        }

        // The mean over depths, weighted by how well colours agree: the best depth alone changes with each frame's noise.
        let (mut colour, mut mean_t, mut total) = (Colour::zeros(), 0.0, 0.0);
        for step in 0..=REFINED_STEPS {
            let deeper = REFINED_DEPTH * step as f32 / REFINED_STEPS as f32;
            let found = self.agreement(&lines, t + deeper, &choice);
            let weight = (-(found.deviation + DEPTH_PENALTY * deeper) / SOFTNESS).exp();
            colour += found.mean * weight;
            mean_t += (t + deeper) * weight;
            total += weight;
        }
        (colour / total, mean_t / total)
    }

    /// The best cameras for `point` as seen along `direction`.
    fn choose(&self, march: &March, point: &Point3<f32>, direction: &Vector3<f32>) -> Choice {
        let mut best = [Chosen::default(); BEST + 1];
        for (camera, one) in self.cameras.iter().enumerate() {
            let Some(depth_map) = one.depth_map.get() else { continue };
            let seen = one.visibility(depth_map, &march.views()[one.view], point);
            let weight = seen / one.squared_angle(point, direction).powi(2).max(SAME_ANGLE);
            if let Some(place) = best.iter().position(|other| weight > other.weight) {
                best[place..].rotate_right(1);
                best[place] = Chosen { camera, weight };
            }
        }

        // Less the weight of the first camera that is left out: none comes or goes with a step of the colour.
        let rest = best[BEST].weight;
        [0, 1, 2].map(|k| Chosen { weight: (best[k].weight - rest).max(0.0), ..best[k] })
    }

    /// What the chosen cameras show at distance `t` along a ray, which has these images in them.
    fn agreement(&self, lines: &[Line; BEST], t: f32, choice: &Choice) -> Agreement {
        let colour = |chosen: &Chosen, line: &Line| match chosen.weight > 0.0 {
            true => self.colour_in(chosen.camera, &line.at(t)),
            false => Colour::zeros(),
        };
        let colours = [0, 1, 2].map(|k| colour(&choice[k], &lines[k]));
        let weighted = colours.iter().zip(choice).map(|(colour, chosen)| colour * chosen.weight);
        let total: f32 = choice.iter().map(|chosen| chosen.weight).sum();
        let mean = weighted.sum::<Colour>() / total.max(f32::MIN_POSITIVE);

        // All cameras that count should agree, whatever their weights.
        let counted = choice.iter().filter(|chosen| chosen.weight > 0.0).count();
        let share = 1.0 / counted.max(1) as f32;
        let middle = colours.iter().take(counted).sum::<Colour>() * share;
        let off: f32 = colours.iter().take(counted).map(|colour| (colour - middle).abs().sum()).sum();
        Agreement { mean, deviation: off * share / 3.0 }
    }

    /// The colour that a camera has at homogeneous image coordinates.
    fn colour_in(&self, camera: usize, h: &Vector3<f32>) -> Colour {
        sample(self.cameras[camera].photo, h.x / h.z, h.y / h.z)
    }
}

impl ColourCamera<'_> {
    /// How well the camera, which is `view`, sees `point`.
    fn visibility(&self, depth_map: &DepthMap, view: &MarchView, point: &Point3<f32>) -> f32 {
        let h = view.homogeneous(point);
        let (u, v) = (h.x / h.z, h.y / h.z);
        let (width, height) = (self.photo.width() as f32, self.photo.height() as f32);
        if h.z <= 0.0 || u < 0.0 || v < 0.0 || u >= width || v >= height {
            return 0.0;
        }
        let feather = (-view.distance(u, v) / FEATHER_PX).clamp(0.0, 1.0);
        (depth_map.visibility(&h) * feather).max(UNSEEN)
    }

    /// The squared angle at `point` between the camera's ray and `direction`, in radians.
    fn squared_angle(&self, point: &Point3<f32>, direction: &Vector3<f32>) -> f32 {
        // Twice one minus the cosine is the square of a small angle.
        2.0 * (1.0 - (point - self.centre).normalize().dot(direction)).max(0.0)
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
