//! Contact manifolds of parry3d between cuboids and a triangle mesh or voxels that are built anew in each frame.

use crate::carve::Grid;
use crate::nets::Mesh;
use crate::scene::Bodies;
use parry3d::bounding_volume::BoundingVolume;
use parry3d::glamx::IVec3;
use parry3d::math::{Pose, Rotation, Vector};
use parry3d::query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry3d::shape::{Cuboid, Shape, TriMesh, Voxels};

/// The boxes as cuboids of parry3d.
#[derive(Debug)]
pub struct Boxes {
    shape: Cuboid,
    poses: Vec<Pose>,
    /// Buffer that is used again for each body.
    manifolds: Vec<ContactManifold<(), ()>>,
}

impl Boxes {
    /// Cuboids with the lengths and poses of `bodies`.
    pub fn new(bodies: &Bodies) -> Self {
        let vector = |v: [f64; 3]| Vector::from_array(v.map(|x| x as f32));
        let shape = Cuboid::new(vector(bodies.half_lengths().into()));
        let pose = |pose: &nalgebra::Isometry3<f64>| {
            let [i, j, k, w] = pose.rotation.coords.into();
            let rotation = Rotation::from_xyzw(i as f32, j as f32, k as f32, w as f32);
            Pose::from_parts(vector(pose.translation.vector.into()), rotation)
        };
        Self { shape, poses: bodies.poses.iter().map(pose).collect(), manifolds: Vec::new() }
    }

    /// Writes each box's number of contact points with `shape` at `world_from_shape` to `counts`.
    ///
    /// The shape is new in each frame, so that no manifold of the last frame can be kept.
    fn contacts(&mut self, shape: &dyn Shape, world_from_shape: Vector, counts: &mut Vec<usize>) {
        let aabb = shape.compute_local_aabb();
        counts.clear();
        for world_from_box in &self.poses {
            let shape_from_box = Pose::from_translation(-world_from_shape) * *world_from_box;
            self.manifolds.clear();
            if aabb.intersects(&self.shape.aabb(&shape_from_box)) {
                let found = DefaultQueryDispatcher.contact_manifolds(
                    &shape_from_box,
                    shape,
                    &self.shape,
                    0.0,
                    &mut self.manifolds,
                    &mut None,
                );
                found.expect("a pair of shapes that parry3d supports");
            }

            let points = self.manifolds.iter().flat_map(|manifold| &manifold.points);
            counts.push(points.filter(|point| point.dist <= 0.0).count());
        }
    }

    /// Writes each box's number of contact points with a triangle mesh to `counts`.
    pub fn with_mesh(&mut self, mesh: &Mesh, counts: &mut Vec<usize>) {
        let points = mesh.points.iter().map(|p| Vector::from_array(*p)).collect();
        let mesh = TriMesh::new(points, mesh.triangles.clone()).expect("a mesh with triangles");
        self.contacts(&mesh, Vector::ZERO, counts);
    }

    /// Writes each box's number of contact points with the voxels inside to `counts`.
    pub fn with_voxels(&mut self, grid: &Grid, counts: &mut Vec<usize>) {
        let cells: Vec<_> =
            grid.cells_inside().map(|cell| IVec3::from_array(cell.map(|n| n as i32))).collect();
        let voxels = Voxels::new(Vector::splat(grid.cell as f32), &cells);
        let origin = [grid.origin.x as f32, grid.origin.y as f32, grid.origin.z as f32];
        self.contacts(&voxels, Vector::from_array(origin), counts);
    }
}
