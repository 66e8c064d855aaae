//! A triangle mesh of carved voxels: naive surface nets, by the crate `fast-surface-nets`.

use crate::carve::Grid;
use fast_surface_nets::ndshape::{RuntimeShape, Shape};
use fast_surface_nets::{SignedDistance, SurfaceNetsBuffer, surface_nets};

/// The sign of a voxel's distance: -1 inside, 1 outside. It takes a byte to save memory.
#[derive(Debug, Clone, Copy)]
struct Sign(i8);

impl From<Sign> for f32 {
    fn from(sign: Sign) -> f32 {
        f32::from(sign.0)
    }
}

impl SignedDistance for Sign {
    fn is_negative(self) -> bool {
        self.0 < 0
    }
}

/// A closed triangle mesh around the voxels inside. Its buffers are used again in the next frame.
#[derive(Default)]
pub struct Mesh {
    signs: Vec<Sign>,
    buffer: SurfaceNetsBuffer,
    /// Vertices, in metres in the world.
    pub points: Vec<[f32; 3]>,
    /// Vertex indices, counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Meshes the voxels of `grid`.
    pub fn build(&mut self, grid: &Grid) {
        let size = grid.size.map(|n| n as u32);
        self.signs.clear();
        self.signs.extend(grid.inside.iter().map(|&inside| Sign(if inside { -1 } else { 1 })));

        // The mesher returns vertices in units of cells.
        let shape = RuntimeShape::<u32, 3>::new(size);
        debug_assert_eq!(shape.size() as usize, self.signs.len());
        surface_nets(&self.signs, &shape, [0; 3], size.map(|n| n - 1), &mut self.buffer);

        let world = |p: &[f32; 3]| {
            let along = |axis: usize| grid.origin[axis] as f32 + (p[axis] + 0.5) * grid.cell as f32;
            [along(0), along(1), along(2)]
        };
        self.points.clear();
        self.points.extend(self.buffer.positions.iter().map(world));
        self.triangles.clear();

        self.triangles.extend(self.buffer.indices.as_chunks::<3>().0);
    }
}

impl std::fmt::Debug for Mesh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Mesh")
            .field("points", &self.points.len())
            .field("triangles", &self.triangles.len())
            .finish()
    }
}
