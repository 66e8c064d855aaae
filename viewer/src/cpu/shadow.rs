//! Shadows: what the light meets first, seen from above along the light.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::lanes::{LANES, whole};
use super::march::{March, Packets, Ray};
use super::raster::{Projection, Triangles};
use crate::scene::Scene;
use nalgebra::{Matrix3, Matrix3x4, Point3, RowVector4, Vector3};
use rayon::prelude::*;

/// Cells along a side of a map.
const CELLS: usize = 80;

/// Bodies up to this far from the work volume cast shadows, in metres.
const MARGIN: f64 = 1.0;

/// A point this far behind what the light meets first is still lit, in metres: cells are coarse.
const BIAS: f32 = 0.03;

/// Shadows are complete on surfaces whose normal has at least the inverse of this part along the light.
const GRAZING: f32 = 2.0;

/// The part of a shadow map over which its edge fades, in cells to each side.
const BLUR: usize = 2;

/// The part of the light that a full shadow takes away.
const DARKNESS: f32 = 0.45;

/// The light's view of a box in the world.
#[derive(Debug, Clone)]
pub struct LightView {
    /// World axes of the map: along its rows, along its columns, along the light.
    axes: Matrix3<f32>,
    /// The least coordinates of the box along the axes.
    least: Vector3<f32>,
    /// Metres that a cell covers along a row and along a column.
    cell: [f32; 2],
}

/// The shadow of bodies or of the subject.
#[derive(Debug)]
pub struct Shadow {
    view: LightView,
    /// Distances along the light at which it meets something, infinite where it does not.
    depths: Vec<f32>,
}

/// What part of the light reaches the ground, which is below everything.
#[derive(Debug)]
pub struct GroundLight {
    view: LightView,
    /// Blurred: 0 in full shadow.
    parts: Vec<f32>,
}

impl LightView {
    /// The view along the light of `scene` of its bodies and of the subject, which is within its
    /// bounds.
    pub fn new(scene: &Scene, bodies: &Triangles) -> Self {
        let along: Vector3<f32> = scene.light.cast();
        let x = Vector3::ith(along.iamin(), 1.0).cross(&along).normalize();
        let axes = Matrix3::from_rows(&[x.transpose(), along.cross(&x).transpose(), along.transpose()]);
        let subject = Some(scene.hull.aabb()).filter(|subject| !subject.is_empty());
        let subject = subject.into_iter().flat_map(|subject| subject.corners().map(|corner| corner.cast()));
        // What has rolled far away would make all cells coarse.
        let shown = scene.hull.bounds().grown(MARGIN);
        let (min, max): (Point3<f32>, Point3<f32>) = (shown.min.cast(), shown.max.cast());
        let near = |point: &Point3<f32>| point.sup(&min).inf(&max);
        let points = bodies.points().map(near).chain(subject).map(|point| axes * point.coords);
        let (least, most) = points
            .fold((Vector3::repeat(f32::MAX), Vector3::repeat(f32::MIN)), |(least, most), point| {
                (least.inf(&point), most.sup(&point))
            });
        // Without bodies and a subject the map shows nothing.
        let (least, most) = if least <= most { (least, most) } else { (Vector3::zeros(), Vector3::zeros()) };

        // A border of some cells stays lit.
        let border = (most - least).map(|length| 0.05 * length.max(0.1));
        let (least, most) = (least - border, most + border);
        let cell = [0, 1].map(|axis| (most[axis] - least[axis]) / CELLS as f32);
        Self { axes, least, cell }
    }

    /// Row, column and depth of a point, in cells and metres.
    fn place(&self, point: &Point3<f32>) -> Vector3<f32> {
        let p = self.axes * point.coords - self.least;
        Vector3::new(p.x / self.cell[0], p.y / self.cell[1], p.z)
    }

    /// The light's ray through the middle of a cell.
    fn ray(&self, x: usize, y: usize) -> Ray {
        let along = |k: usize, axis: usize| self.least[axis] + (k as f32 + 0.5) * self.cell[axis];
        let at = Vector3::new(along(x, 0), along(y, 1), self.least.z);
        let origin = Point3::from(self.axes.tr_mul(&at));
        Ray { origin, direction: self.axes.row(2).transpose() }
    }

    fn projection(&self) -> Projection {
        let row = |axis: usize, cell: f32| {
            let r = self.axes.row(axis) / cell;
            RowVector4::new(r.x, r.y, r.z, -self.least[axis] / cell)
        };
        let one = RowVector4::new(0.0, 0.0, 0.0, 1.0);
        let image = Matrix3x4::from_rows(&[row(0, self.cell[0]), row(1, self.cell[1]), one]);
        Projection { image, depth: row(2, 1.0) }
    }
}

impl Shadow {
    /// The shadow of the bodies.
    pub fn of_bodies(view: &LightView, bodies: &Triangles) -> Self {
        let mut fragments = Vec::new();
        bodies.in_image(&view.projection()).draw(CELLS, &(0..CELLS), &mut fragments);
        Self { view: view.clone(), depths: fragments.iter().map(|fragment| fragment.depth).collect() }
    }

    /// The shadow of the subject.
    pub fn of_subject(view: &LightView, march: &March) -> Self {
        let mut depths = vec![f32::INFINITY; CELLS * CELLS];
        depths.par_chunks_mut(CELLS).enumerate().for_each(|(y, depths)| {
            let mut packets = Packets::default();
            for (x, depths) in (0..).step_by(LANES).zip(depths.chunks_mut(LANES)) {
                let rays = std::array::from_fn(|k| view.ray(x + k, y));
                let entries = march.entries(&rays, &[const { 0.0..f32::MAX }; LANES], &mut packets);
                for (depth, entry) in depths.iter_mut().zip(entries) {
                    *depth = entry.map_or(f32::INFINITY, |entry| entry.t);
                }
            }
        });
        Self { view: view.clone(), depths }
    }

    /// The part of the light that reaches `point` of a surface with this outward unit normal, 0 to 1.
    pub fn at(&self, point: &Point3<f32>, normal: &Vector3<f32>) -> f32 {
        // A surface that faces away from the light, or hardly towards it, is dark by itself, and cells are too coarse for it.
        let facing = (-GRAZING * self.view.axes.row(2).transpose().dot(normal)).clamp(0.0, 1.0);
        if facing == 0.0 {
            return 1.0;
        }

        // A little above the surface, or cells that it crosses would lie in its own shadow.
        let place = self.view.place(&(point + normal * (1.5 * self.view.cell[0].max(self.view.cell[1]))));
        let lit = mixed(&place, |index| f32::from(self.depths[index] + BIAS >= place.z));
        1.0 - facing * (1.0 - lit)
    }
}

impl GroundLight {
    /// The light that comes past all of `shadows`, of which there is at least one.
    pub fn past(shadows: &[&Shadow]) -> Self {
        let is_lit = |index: usize| shadows.iter().all(|shadow| shadow.depths[index].is_infinite());
        let lit: Vec<f32> = (0..CELLS * CELLS).map(|index| f32::from(is_lit(index))).collect();
        // A square window is the same along rows and then along columns.
        let mean = |from: &[f32], x: usize, y: usize, along: usize| {
            let k = if along == 1 { x } else { y };
            let near = k.saturating_sub(BLUR)..(k + BLUR + 1).min(CELLS);
            let first = y * CELLS + x - k * along;
            let count = near.len() as f32;
            near.map(|k| from[first + k * along]).sum::<f32>() / count
        };
        let rows: Vec<f32> =
            (0..CELLS * CELLS).map(|index| mean(&lit, index % CELLS, index / CELLS, 1)).collect();
        let parts =
            (0..CELLS * CELLS).map(|index| mean(&rows, index % CELLS, index / CELLS, CELLS)).collect();
        Self { view: shadows[0].view.clone(), parts }
    }

    /// The parts that reach several points, whose coordinates are given axis by axis.
    #[inline(always)]
    pub fn at_many(&self, points: &[[f32; LANES]; 3]) -> [f32; LANES] {
        let LightView { axes, least, cell } = &self.view;
        let last = (CELLS - 1) as f32;
        let (mut index, mut right, mut below) = ([0; LANES], [0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            let along = |axis: usize| {
                let row = axes[(axis, 0)] * points[0][k]
                    + axes[(axis, 1)] * points[1][k]
                    + axes[(axis, 2)] * points[2][k];
                (row - least[axis]) / cell[axis] - 0.5
            };
            let (x, y) = (along(0), along(1));
            let is_inside = (x >= 0.0) & (x < last) & (y >= 0.0) & (y < last);
            // Beyond the map it is lit as in the first cell: a border of the map is lit.
            let (x, y) = (if is_inside { x } else { 0.0 }, if is_inside { y } else { 0.0 });
            let (i, j) = (whole(x), whole(y));
            index[k] = j * CELLS as i32 + i;
            (right[k], below[k]) = (x - i as f32, y - j as f32);
        }

        let mut lit = [1.0; LANES];
        for k in 0..LANES {
            let at = index[k] as usize;
            let rows = self.parts.get(at..at + 2).zip(self.parts.get(at + CELLS..at + CELLS + 2));
            let Some((upper, lower)) = rows else { continue };
            let along = |row: &[f32]| row[0] + (row[1] - row[0]) * right[k];
            lit[k] = along(upper) + (along(lower) - along(upper)) * below[k];
        }
        lit
    }

    /// The part that reaches `point`, 0 to 1.
    pub fn at(&self, point: &Point3<f32>) -> f32 {
        mixed(&self.view.place(point), |index| self.parts[index])
    }
}

/// How bright a surface is that `light` of the light reaches.
#[inline(always)]
pub fn shaded(light: f32) -> f32 {
    1.0 - DARKNESS * (1.0 - light)
}

/// `of` at a place of a map, bilinear between the middles of cells; 1 beyond the map.
fn mixed(place: &Vector3<f32>, of: impl Fn(usize) -> f32) -> f32 {
    let (x, y) = (place.x - 0.5, place.y - 0.5);
    let last = (CELLS - 1) as f32;
    if !(0.0..last).contains(&x) || !(0.0..last).contains(&y) {
        return 1.0;
    }
    let (i, j) = (x as usize, y as usize);
    let (right, below) = (x - i as f32, y - j as f32);
    let row = |j: usize| of(j * CELLS + i) * (1.0 - right) + of(j * CELLS + i + 1) * right;
    row(j) * (1.0 - below) + row(j + 1) * below
}
