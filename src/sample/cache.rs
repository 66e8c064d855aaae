//! A cache of samples, so that a body is sampled once instead of at every step.

use super::weld::extent;
use super::{Samples, convex, trimesh};
use crate::Result;
use crate::shape::Shape;
use nalgebra::Point3;
use std::collections::HashMap;
use std::sync::Arc;

/// The largest number of shapes kept.
const MAX_SHAPES: usize = 256;

/// The largest number of samples kept, of all shapes together (about 50 bytes each). The most recently used shape
/// always stays.
const MAX_KEPT_SAMPLES: usize = 4_000_000;

/// Vertices within this distance of the stored ones, relative to the body's size, count as unchanged: they are
/// recomputed at every step by the body's pose and its inverse.
const VERTEX_TOLERANCE: f64 = 1e-9;

/// A bounded cache of samples that evicts the least recently used shapes.
///
/// Spheres, boxes, capsules and cylinders are identified by their exact parameters. Convex bodies and meshes are
/// identified by a key from the caller, such as an id or an address, which may later belong to another body: therefore
/// the stored vertices are compared with the given ones each time.
#[derive(Debug, Default)]
pub struct SampleCache {
    entries: HashMap<Key, Entry>,
    samples: usize,
    use_count: u64,
}

/// The key of an entry; floats as their bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Key {
    Sphere([u64; 2]),
    Box([u64; 4]),
    Capsule([u64; 3]),
    Cylinder([u64; 3]),
    Convex(usize, u64),
    Trimesh(usize, u64),
}

#[derive(Debug)]
struct Entry {
    /// The vertices of a convex body or mesh; empty for shapes that the key defines completely.
    vertices: Vec<Point3<f64>>,
    samples: Arc<Samples>,
    used: u64,
}

impl SampleCache {
    /// An empty cache.
    pub fn new() -> Self {
        Self::default()
    }

    /// The number of cached shapes.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether the cache is empty.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The samples of `shape`. Convex bodies and meshes are not cached by this function, see [`Self::get_convex`] and
    /// [`Self::get_trimesh`].
    ///
    /// # Errors
    /// All errors of [`Shape::sample`].
    pub fn get(&mut self, shape: &Shape, min_feature: f64) -> Result<Arc<Samples>> {
        let d = min_feature;
        let key = match *shape {
            Shape::Sphere { radius } => Key::Sphere([radius, d].map(f64::to_bits)),
            Shape::Box { sides: l } => Key::Box([l.x, l.y, l.z, d].map(f64::to_bits)),
            Shape::Capsule { radius, length } => Key::Capsule([radius, length, d].map(f64::to_bits)),
            Shape::Cylinder { radius, length } => Key::Cylinder([radius, length, d].map(f64::to_bits)),
            Shape::Convex(_)
            | Shape::TriMesh(_)
            | Shape::Plane { .. }
            | Shape::Ray { .. }
            | Shape::Heightfield(_) => return shape.sample(d).map(Arc::new),
        };
        self.find(key, &[], || shape.sample(min_feature))
    }

    /// The samples of the convex hull of `vertices` (body frame), cached under `key_hint`; recomputed if the vertices
    /// cached there differ.
    ///
    /// # Errors
    /// All errors of [`convex`].
    pub fn get_convex(
        &mut self,
        key_hint: usize,
        vertices: &[Point3<f64>],
        min_feature: f64,
    ) -> Result<Arc<Samples>> {
        let key = Key::Convex(key_hint, min_feature.to_bits());
        self.find(key, vertices, || convex(vertices, min_feature))
    }

    /// The samples of a mesh (body frame), cached under `key_hint`; recomputed if the triangles cached there differ.
    ///
    /// # Errors
    /// All errors of [`trimesh`].
    pub fn get_trimesh(
        &mut self,
        key_hint: usize,
        triangles: &[[Point3<f64>; 3]],
        min_feature: f64,
    ) -> Result<Arc<Samples>> {
        let key = Key::Trimesh(key_hint, min_feature.to_bits());
        self.find(key, triangles.as_flattened(), || trimesh(triangles, min_feature))
    }

    /// Returns the cached samples if the vertices agree, else computes and caches them.
    fn find(
        &mut self,
        key: Key,
        vertices: &[Point3<f64>],
        sample: impl FnOnce() -> Result<Samples>,
    ) -> Result<Arc<Samples>> {
        self.use_count += 1;
        if let Some(entry) = self.entries.get_mut(&key).filter(|entry| agree(&entry.vertices, vertices)) {
            entry.used = self.use_count;
            return Ok(entry.samples.clone());
        }

        let samples = Arc::new(sample()?);
        let entry = Entry { vertices: vertices.to_vec(), samples: samples.clone(), used: self.use_count };
        self.samples += samples.points().len();
        if let Some(replaced) = self.entries.insert(key, entry) {
            self.samples -= replaced.samples.points().len();
        }

        self.trim();
        Ok(samples)
    }

    /// Evicts the least recently used shapes until the cache is within its bounds.
    fn trim(&mut self) {
        while self.entries.len() > MAX_SHAPES || (self.samples > MAX_KEPT_SAMPLES && self.entries.len() > 1) {
            let oldest = self.entries.iter().min_by_key(|(_, entry)| entry.used).map(|(key, _)| *key);
            let Some(removed) = oldest.and_then(|key| self.entries.remove(&key)) else { return };
            self.samples -= removed.samples.points().len();
        }
    }
}

/// Whether two lists of vertices are equal up to the tolerance.
fn agree(stored: &[Point3<f64>], given: &[Point3<f64>]) -> bool {
    if stored.len() != given.len() {
        return false;
    }
    let tolerance = VERTEX_TOLERANCE * extent(stored);
    stored.iter().zip(given).all(|(a, b)| (a - b).amax() <= tolerance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    fn cube(size: f64) -> Vec<Point3<f64>> {
        (0..8).map(|k| Point3::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2) as f64) * size).collect()
    }

    #[test]
    fn a_shape_is_sampled_once() {
        let mut cache = SampleCache::new();
        let shape = Shape::cuboid(0.1, 0.2, 0.3);
        let first = cache.get(&shape, 0.03).unwrap();
        assert!(Arc::ptr_eq(&first, &cache.get(&shape, 0.03).unwrap()));
        assert!(!Arc::ptr_eq(&first, &cache.get(&shape, 0.04).unwrap()));
        let ball = Shape::Sphere { radius: 0.1 };
        assert_eq!(*cache.get(&ball, 0.03).unwrap(), ball.sample(0.03).unwrap());
        assert_eq!(cache.len(), 3);
        assert!(cache.get(&Shape::Sphere { radius: -1.0 }, 0.03).is_err());
        assert_eq!(cache.len(), 3);
    }

    #[test]
    fn shapes_of_equal_parameters_and_different_class_are_distinct() {
        let mut cache = SampleCache::new();
        let capsule = cache.get(&Shape::Capsule { radius: 0.1, length: 0.2 }, 0.03).unwrap();
        let cylinder = cache.get(&Shape::Cylinder { radius: 0.1, length: 0.2 }, 0.03).unwrap();
        assert_ne!(capsule, cylinder);
    }

    #[test]
    fn noise_on_vertices_finds_the_stored_samples_and_a_change_does_not() {
        let mut cache = SampleCache::new();
        let first = cache.get_convex(7, &cube(0.2), 0.03).unwrap();
        let noisy: Vec<_> = cube(0.2).iter().map(|p| p + Vector3::new(1e-15, -1e-15, 3e-16)).collect();
        assert!(Arc::ptr_eq(&first, &cache.get_convex(7, &noisy, 0.03).unwrap()));
        let other = cache.get_convex(7, &cube(0.2001), 0.03).unwrap();
        assert!(!Arc::ptr_eq(&first, &other));
        assert_eq!(*other, convex(&cube(0.2001), 0.03).unwrap());
        assert_eq!(cache.len(), 1);
        assert!(cache.get_convex(7, &cube(0.2)[..4], 0.03).is_err());

        let triangle = [[cube(0.2)[0], cube(0.2)[1], cube(0.2)[2]]];
        let mesh = cache.get_trimesh(7, &triangle, 0.03).unwrap();
        assert!(Arc::ptr_eq(&mesh, &cache.get_trimesh(7, &triangle, 0.03).unwrap()));
    }

    #[test]
    fn the_least_recently_used_shape_is_evicted_first() {
        let mut cache = SampleCache::new();
        let shape = |k: usize| Shape::Sphere { radius: 1e-3 + k as f64 * 1e-6 };
        let first = cache.get(&shape(0), 0.03).unwrap();
        let second = cache.get(&shape(1), 0.03).unwrap();
        for k in 2..MAX_SHAPES + 1 {
            cache.get(&shape(k), 0.03).unwrap();
            assert!(Arc::ptr_eq(&first, &cache.get(&shape(0), 0.03).unwrap()));
        }
        assert_eq!(cache.len(), MAX_SHAPES);
        assert!(!Arc::ptr_eq(&second, &cache.get(&shape(1), 0.03).unwrap()));
        let kept: usize = cache.entries.values().map(|entry| entry.samples.points().len()).sum();
        assert_eq!(cache.samples, kept);
    }
}
