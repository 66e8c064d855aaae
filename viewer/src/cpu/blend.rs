//! The colours of the subject: those of the real cameras that see a point best, blended.
//!
//! A camera counts by the angle between its ray and the picture's (Buehler et al. 2001, unstructured lumigraph), by
//! whether the hull hides the point from it, and less near its silhouette's edge, where its pixels are mixed with
//! background.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::depth_map::DepthMap;
use super::lanes::{LANES, Lanes, Mask, any, mask, select};
use super::march::{March, MarchView, PacketLines, Packets, Ray};
use super::photos::Photos;
use crate::picture::Colour;
use crate::scene::{Scene, SceneView};
use image::RgbImage;
use nalgebra::Point3;
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

/// The colours of the subject along a packet of rays.
#[derive(Debug, Default)]
pub struct Coloured {
    /// Red, green and blue.
    pub colour: [Lanes; 3],
    /// The distances of the surface along the rays, in metres.
    pub t: Lanes,
}

impl Coloured {
    /// The colour and the distance along ray number `k`.
    pub fn of_ray(&self, k: usize) -> (Colour, f32) {
        (Colour::from(self.colour.map(|channel| channel[k])), self.t[k])
    }
}

/// For each ray of a packet one of the best cameras for the place where it enters the hull.
struct Chosen<'s> {
    /// How much its colour counts; 0 for a ray that is seen by fewer cameras.
    weight: Lanes,
    photos: Photos<'s>,
    lines: PacketLines,
}

/// The best cameras by weight for each ray of a packet, the best first.
struct Ranking {
    weights: [Lanes; BEST + 1],
    cameras: [[u32; LANES]; BEST + 1],
}

/// The colours of the chosen cameras at a place of each ray.
struct Agreement {
    /// Their weighted mean.
    mean: [Lanes; 3],
    /// Their mean distance from a common colour, in grey levels.
    deviation: Lanes,
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

    /// The colours of the subject where `rays` enter the hull, at distances `t`, and the distances of the surface along them: `t`,
    /// or behind it where `refine` finds that colours agree better there.
    pub fn colours(
        &self,
        march: &March,
        rays: &[Ray; LANES],
        t: &Lanes,
        refine: bool,
        packets: &mut Packets,
    ) -> Coloured {
        if self.cameras.is_empty() {
            return Coloured { t: *t, ..Coloured::default() };
        }
        blended(self, march, rays, t, refine, packets.lines())
    }

    /// The best cameras for the places at distances `t` along `rays`. `lines` is memory for the images of the rays.
    #[inline(always)]
    fn choose(
        &self,
        march: &March,
        rays: &[Ray; LANES],
        t: &Lanes,
        lines: &mut Vec<PacketLines>,
    ) -> [Chosen<'s>; BEST] {
        let mut ranking = Ranking { weights: [[0.0; LANES]; BEST + 1], cameras: [[0; LANES]; BEST + 1] };
        for (index, camera) in self.cameras.iter().enumerate() {
            let view = &march.views()[camera.view];
            lines.push(PacketLines::new(rays, view));
            if let Some(depth_map) = camera.depth_map.get() {
                ranking.insert(index, camera.weights(depth_map, view, &lines[index], rays, t));
            }
        }

        // Less the weight of the first camera that is left out: none comes or goes with a step of the colour.
        std::array::from_fn(|rank| {
            let cameras = ranking.cameras[rank].map(|camera| camera as usize);
            let mut chosen = Chosen {
                weight: [0.0; LANES],
                photos: Photos::new(cameras.map(|camera| self.cameras[camera].photo)),
                lines: PacketLines::default(),
            };
            for k in 0..LANES {
                chosen.weight[k] = (ranking.weights[rank][k] - ranking.weights[BEST][k]).max(0.0);
                chosen.lines.copy_ray(k, &lines[cameras[k]]);
            }
            chosen
        })
    }
}

impl Ranking {
    /// Gives the camera of this index its place for each ray, for which it has these weights.
    #[inline(always)]
    fn insert(&mut self, camera: usize, weights: Lanes) {
        let (mut weights, mut cameras) = (weights, [camera as u32; LANES]);
        for (placed, placed_cameras) in self.weights.iter_mut().zip(&mut self.cameras) {
            for k in 0..LANES {
                let is_better = mask(weights[k] > placed[k]);
                let (weight, camera) = (placed[k], placed_cameras[k]);
                placed[k] = select(is_better, weights[k], weight);
                placed_cameras[k] = is_better & cameras[k] | !is_better & camera;
                weights[k] = select(is_better, weight, weights[k]);
                cameras[k] = is_better & camera | !is_better & cameras[k];
            }
        }
    }
}

/// See [`Blend::colours`]; there is at least one camera.
#[multiversion::multiversion(targets("x86_64+avx2+fma+bmi1+bmi2+popcnt+lzcnt"))]
fn blended(
    blend: &Blend,
    march: &March,
    rays: &[Ray; LANES],
    t: &Lanes,
    refine: bool,
    lines: &mut Vec<PacketLines>,
) -> Coloured {
    let chosen = blend.choose(march, rays, t, lines);
    if !refine {
        return Coloured { colour: agreement(&chosen, t).mean, t: *t };
    }

    // The mean over depths, weighted by how well colours agree: the best depth alone changes with each frame's noise.
    let (mut sum, mut total) = (Coloured::default(), [0.0; LANES]);
    for step in 0..=REFINED_STEPS {
        let deeper = REFINED_DEPTH * step as f32 / REFINED_STEPS as f32;
        let at = t.map(|t| t + deeper);
        let found = agreement(&chosen, &at);
        for k in 0..LANES {
            let weight = (-(found.deviation[k] + DEPTH_PENALTY * deeper) / SOFTNESS).exp();
            for c in 0..3 {
                sum.colour[c][k] += found.mean[c][k] * weight;
            }
            sum.t[k] += at[k] * weight;
            total[k] += weight;
        }
    }
    for k in 0..LANES {
        for c in 0..3 {
            sum.colour[c][k] /= total[k];
        }
        sum.t[k] /= total[k];
    }
    sum
}

/// What the `chosen` cameras show at distances `t` along the rays of a packet.
#[inline(always)]
fn agreement(chosen: &[Chosen; BEST], t: &Lanes) -> Agreement {
    let mut colours = [[[0.0; LANES]; 3]; BEST];
    let (mut weighted, mut total) = ([[0.0; LANES]; 3], [0.0; LANES]);
    let (mut middle, mut count) = ([[0.0; LANES]; 3], [0.0; LANES]);
    for (one, colours) in chosen.iter().zip(&mut colours) {
        let counts: Mask = one.weight.map(|weight| mask(weight > 0.0));
        if !any(&counts) {
            continue;
        }
        let [u, v, _] = one.lines.images_at(t);
        *colours = one.photos.colours(&u, &v);
        for k in 0..LANES {
            for c in 0..3 {
                weighted[c][k] += one.weight[k] * colours[c][k];
                middle[c][k] += select(counts[k], colours[c][k], 0.0);
            }
            total[k] += one.weight[k];
            count[k] += select(counts[k], 1.0, 0.0);
        }
    }

    // All cameras that count should agree, whatever their weights.
    let mut found = Agreement { mean: weighted, deviation: [0.0; LANES] };
    for k in 0..LANES {
        let (whole, share) = (1.0 / total[k].max(f32::MIN_POSITIVE), 1.0 / count[k].max(1.0));
        for c in 0..3 {
            found.mean[c][k] *= whole;
            for (one, colours) in chosen.iter().zip(&colours) {
                let off = (colours[c][k] - middle[c][k] * share).abs() * share / 3.0;
                found.deviation[k] += select(mask(one.weight[k] > 0.0), off, 0.0);
            }
        }
    }
    found
}

impl ColourCamera<'_> {
    /// How much the colour of the camera, which is `view`, counts at distances `t` along `rays`, whose images in it are `lines`.
    #[inline(always)]
    fn weights(
        &self,
        depth_map: &DepthMap,
        view: &MarchView,
        lines: &PacketLines,
        rays: &[Ray; LANES],
        t: &Lanes,
    ) -> Lanes {
        let [u, v, depth] = lines.images_at(t);
        let visibility = depth_map.visibilities(&u, &v, &depth);
        let distance = view.distances(&u, &v);
        let (width, height) = (self.photo.width() as f32, self.photo.height() as f32);

        let mut weights = [0.0; LANES];
        for k in 0..LANES {
            let is_seen = mask(depth[k] > 0.0)
                & (mask(u[k] >= 0.0) & mask(v[k] >= 0.0) & mask(u[k] < width) & mask(v[k] < height));
            let feather = (-distance[k] / FEATHER_PX).clamp(0.0, 1.0);
            let seen = (visibility[k] * feather).max(UNSEEN);

            // Twice one minus the cosine of the angle to the camera's ray is the square of a small angle.
            let ray = &rays[k];
            let off = |axis: usize| ray.origin[axis] + ray.direction[axis] * t[k] - self.centre[axis];
            let (x, y, z) = (off(0), off(1), off(2));
            let along = x * ray.direction[0] + y * ray.direction[1] + z * ray.direction[2];
            let squared_angle = 2.0 * (1.0 - along / (x * x + y * y + z * z).sqrt()).max(0.0);
            let weight = seen / (squared_angle * squared_angle).max(SAME_ANGLE);
            weights[k] = select(is_seen, weight, 0.0);
        }
        weights
    }
}
