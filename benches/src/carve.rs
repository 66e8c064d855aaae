//! Voxels of the hull, carved with the library's own inside test. Every mesh and voxel candidate starts from them.

use crate::ours::Frame;
use nalgebra::{Isometry3, Point3};
use ode_visual_hull::hull::{Points, Workspace};

/// Cubic cells over the hull's bounding box, with one layer of empty cells around it.
#[derive(Debug)]
pub struct Grid {
    /// Edge of a cell, in metres.
    pub cell: f64,
    /// Cells along x, y and z.
    pub size: [usize; 3],
    /// The lower corner of cell (0, 0, 0).
    pub origin: Point3<f64>,
    /// Whether a cell's centre is inside; x runs fastest.
    pub inside: Vec<bool>,
    workspace: Workspace,
}

impl Grid {
    /// An empty grid of cells `cell` metres wide.
    pub fn new(cell: f64) -> Self {
        let origin = Point3::origin();
        Self { cell, size: [0; 3], origin, inside: Vec::new(), workspace: Workspace::new() }
    }

    /// Fits the grid to the hull of `frame` and tests every cell, one layer of constant z at a time.
    pub fn carve(&mut self, frame: &Frame) {
        let aabb = frame.aabb();
        self.origin = aabb.min.map(|x| x - self.cell);
        self.size =
            std::array::from_fn(|axis| ((aabb.max[axis] - aabb.min[axis]) / self.cell).ceil() as usize + 2);

        let [nx, ny, nz] = self.size;

        // The lowest layer; the others are the same points moved up.
        let mut layer = Vec::with_capacity(nx * ny);
        for j in 0..ny {
            layer.extend((0..nx).map(|i| self.centre([i, j, 0])));
        }
        let layer = Points::new(&layer);

        self.inside.clear();
        self.inside.resize(nx * ny * nz, false);

        for (k, cells) in self.inside.chunks_exact_mut(nx * ny).enumerate() {
            let up = Isometry3::translation(0.0, 0.0, k as f64 * self.cell);
            frame.inside(&layer, &up, &mut self.workspace).iter().for_each(|cell| cells[cell] = true);
        }
    }

    /// The centre of a cell, in metres in the world.
    pub fn centre(&self, [i, j, k]: [usize; 3]) -> Point3<f64> {
        let along = |n: usize| (n as f64 + 0.5) * self.cell;
        Point3::new(self.origin.x + along(i), self.origin.y + along(j), self.origin.z + along(k))
    }

    /// Indices of the cells inside; x runs fastest.
    pub fn cells_inside(&self) -> impl Iterator<Item = [usize; 3]> {
        let [nx, ny, _] = self.size;
        let inside = self.inside.iter().enumerate().filter(|(_, inside)| **inside);
        inside.map(move |(n, _)| [n % nx, n / nx % ny, n / (nx * ny)])
    }
}
