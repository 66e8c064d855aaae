//! Shared by the tests of the shapes: a fixed random sequence, and the claims that hold for every shape.

use super::Samples;
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;

/// A linear congruential generator (Knuth's MMIX constants): the same sequence everywhere.
pub struct Lcg(u64);

impl Lcg {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(2654435769).wrapping_add(1))
    }

    pub fn between(&mut self, lower: f64, upper: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        lower + (upper - lower) * (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.between(0.0, n as f64) as usize).min(n - 1)
    }

    pub fn direction(&mut self) -> Vector3<f64> {
        loop {
            let v = Vector3::from_fn(|_, _| self.between(-1.0, 1.0));
            if v.norm() > 0.01 && v.norm() < 1.0 {
                return v.normalize();
            }
        }
    }
}

/// Samples in cubes with the edge length of the search radius: the 27 cubes around a point contain all samples within
/// it.
pub struct Grid<'a> {
    cubes: HashMap<[i64; 3], Vec<&'a Point3<f64>>>,
    size: f64,
}

impl<'a> Grid<'a> {
    pub fn new(samples: &'a Samples, size: f64) -> Self {
        let mut cubes: HashMap<_, Vec<_>> = HashMap::new();
        for sample in samples.points() {
            let cube = sample.point.coords.map(|x| (x / size).floor() as i64);
            cubes.entry(cube.into()).or_default().push(&sample.point);
        }
        Self { cubes, size }
    }

    pub fn nearest(&self, point: &Point3<f64>) -> f64 {
        let [x, y, z]: [i64; 3] = point.coords.map(|x| (x / self.size).floor() as i64).into();
        let around = (0..27).map(|k| [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1]);
        let near = around.filter_map(|cube| self.cubes.get(&cube)).flatten();
        near.map(|sample| (*sample - point).norm()).fold(f64::INFINITY, f64::min)
    }
}

/// Asserts that 20,000 random surface points are within `min_feature / 2` and the covering radius of a sample, and
/// inside the bounds.
pub fn assert_covers(samples: &Samples, min_feature: f64, mut surface: impl FnMut(&mut Lcg) -> Point3<f64>) {
    assert!(samples.covering_radius() <= min_feature / 2.0 + 1e-9);
    let grid = Grid::new(samples, min_feature / 2.0 + 1e-6);
    let mut random = Lcg::new(7);
    for _ in 0..20_000 {
        let point = surface(&mut random);
        let distance = grid.nearest(&point);
        assert!(
            distance <= samples.covering_radius() + 1e-9,
            "{point} is {distance} m from the nearest sample"
        );

        assert!(point.coords.norm() <= samples.bounding_radius() + 1e-9);
        let (center, radius) = samples.bounding_sphere();
        assert!((point - center).norm() <= radius + 1e-9);
    }
}

pub fn assert_unit_normals(samples: &Samples) {
    assert!(samples.points().iter().all(|sample| (sample.normal.norm() - 1.0).abs() < 1e-12));
}
