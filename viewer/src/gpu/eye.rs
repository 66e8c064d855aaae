//! What shaders know of a viewpoint: the rays of its pixels, and their images in all views.
//!
//! A ray is `origin + t direction`, and `t` is the depth along the viewpoint's axis. Its image in a view is
//! `at_origin + t slope` in homogeneous coordinates of the view's layer. Both directions and slopes are linear in the image
//! position, so a shader multiplies by one matrix for each view.

use super::tiles::TILE;
use super::upload::Upload;
use crate::scene::{Scene, SceneView};
use nalgebra::{Matrix3, Matrix3x4, Vector3};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::Aabb;

/// Rows of four numbers before those of the views, and for each view: `Eye` and `Line` in eye.wgsl.
const HEAD_ROWS: usize = 9;
const LINE_ROWS: usize = 4;

/// The least depth of the planes of a sweep.
const MIN_DEPTH: f64 = 1e-3;

/// Pixels from the middle of a tile to its corner, and a little more.
const TILE_RADIUS: f64 = 0.75 * TILE as f64;

/// Where a viewpoint is drawn: its image position is `scale` times the position in the texture, plus `shift`.
#[derive(Debug, Clone, Copy)]
pub struct Placement {
    /// Image pixels for each pixel of the texture.
    pub scale: f32,
    /// In image pixels.
    pub shift: [f32; 2],
    /// The number of the view whose depth map is drawn.
    pub own: usize,
    /// The number of planes of a sweep.
    pub planes: u32,
}

/// What the blocks of all viewpoints of a scene have in common.
#[derive(Debug)]
pub struct Eyes {
    /// From the world to positions in the layer of each view.
    projections: Vec<Matrix3x4<f64>>,
    bounds: Aabb,
    light: Vector3<f64>,
    /// The greater focal length of each view in pixels.
    focal_lengths: Vec<f32>,
    layer_size: [f32; 2],
}

impl Eyes {
    /// The viewpoints of `scene`.
    pub fn new(scene: &Scene, upload: &Upload) -> Self {
        let projection = |view: &SceneView| upload.texture_from_image() * view.projection();
        Self {
            projections: scene.views.iter().map(projection).collect(),
            bounds: *scene.hull.aabb(),
            light: scene.light,
            focal_lengths: scene.views.iter().map(|view| focal_length(view.camera())).collect(),
            layer_size: upload.layer_size(),
        }
    }

    /// The bytes of a viewpoint's block for `count` views.
    pub fn block_size(count: usize) -> u64 {
        ((HEAD_ROWS + LINE_ROWS * count) * 16) as u64
    }

    /// The block of `camera` as the viewpoint, whose lens is ignored.
    pub fn block(&self, camera: &Camera, placement: Placement) -> Vec<[f32; 4]> {
        let turn = *camera.cam_from_world().rotation.inverse().to_rotation_matrix().matrix();
        // The intrinsic matrix of a camera is invertible: its focal lengths are positive.
        let inverse = camera.intrinsics().try_inverse().unwrap_or_else(Matrix3::identity);
        let world_from_image = turn * inverse;
        let origin = camera.centre().coords;

        // What lies at one depth lies parallel to the image.
        let focal = camera.intrinsics();
        let widening = f64::from(placement.scale) * TILE_RADIUS / focal[(0, 0)].min(focal[(1, 1)]);
        let (least, most) = (self.bounds.min.coords, self.bounds.max.coords);
        let farthest = (least - origin).abs().sup(&(most - origin).abs()).norm();

        let mut rows: Vec<[f32; 4]> = Vec::with_capacity(HEAD_ROWS + LINE_ROWS * self.projections.len());
        rows.extend(columns(&world_from_image));
        rows.push(row(&origin, widening as f32));
        rows.push([placement.scale, placement.shift[0], placement.shift[1], placement.own as f32]);
        rows.push(row(&least, self.layer_size[0]));
        rows.push(row(&most, self.layer_size[1]));
        rows.push(row(&self.light, (widening * farthest) as f32));
        let depths = self.corners().map(|corner| camera.forward().dot(&(corner - origin)));
        let nearest = depths.iter().fold(f64::INFINITY, |a, &b| a.min(b)).max(MIN_DEPTH);
        let farthest = depths.iter().fold(nearest, |a, &b| a.max(b));
        rows.push([nearest as f32, farthest as f32, placement.planes as f32, 0.0]);
        for (projection, focal_length) in self.projections.iter().zip(&self.focal_lengths) {
            let turn = projection.fixed_columns::<3>(0);
            rows.push(row(&(turn * origin + projection.column(3)), *focal_length));
            rows.extend(columns(&(turn * world_from_image)));
        }
        rows
    }

    /// The pixels in which `camera` may see the subject: first column and row, and their numbers.
    pub fn area(&self, camera: &Camera) -> [u32; 4] {
        let (width, height) = camera.size();
        let mut rect = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        for corner in self.corners() {
            let h = camera.projection_matrix() * corner.push(1.0);
            if h.z < MIN_DEPTH {
                return [0, 0, width, height];
            }
            let (u, v) = (h.x / h.z, h.y / h.z);
            rect = [rect[0].min(u), rect[1].min(v), rect[2].max(u), rect[3].max(v)];
        }
        let within = |position: f64, size: u32| position.clamp(0.0, f64::from(size)) as u32;
        let (x, y) = (within(rect[0].floor(), width), within(rect[1].floor(), height));
        [x, y, within(rect[2].ceil(), width) - x, within(rect[3].ceil(), height) - y]
    }

    fn corners(&self) -> [Vector3<f64>; 8] {
        let (least, most) = (self.bounds.min, self.bounds.max);
        let pick =
            |corner: usize, axis: usize| if corner >> axis & 1 == 1 { most[axis] } else { least[axis] };
        std::array::from_fn(|corner| Vector3::new(pick(corner, 0), pick(corner, 1), pick(corner, 2)))
    }
}

fn focal_length(camera: &Camera) -> f32 {
    let matrix = camera.intrinsics();
    matrix[(0, 0)].max(matrix[(1, 1)]) as f32
}

fn row(vector: &Vector3<f64>, last: f32) -> [f32; 4] {
    [vector.x as f32, vector.y as f32, vector.z as f32, last]
}

fn columns(matrix: &Matrix3<f64>) -> [[f32; 4]; 3] {
    [0, 1, 2].map(|k| row(&matrix.column(k).into(), 0.0))
}
