//! What the tests of the shapes share: the claims that hold for every shape.

use super::Samples;
use nalgebra::Point3;
use ode_visual_hull_random::Random;
use std::collections::HashMap;

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
pub fn assert_covers(
    samples: &Samples,
    min_feature: f64,
    mut surface: impl FnMut(&mut Random) -> Point3<f64>,
) {
    assert!(samples.covering_radius() <= min_feature / 2.0 + 1e-9);
    let grid = Grid::new(samples, min_feature / 2.0 + 1e-6);
    let mut random = Random(7);
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
