//! Merges points that represent the same corner.

use nalgebra::{Point3, Vector3};
use std::collections::HashMap;

/// Corners closer than this, relative to the body's size, are merged; points this close to a plane lie in it. It is
/// above the rounding of single precision coordinates and below what a camera can resolve.
pub(super) const TOLERANCE: f64 = 1e-6;

/// The diagonal of the points' bounding box.
pub(super) fn extent<'a>(points: impl IntoIterator<Item = &'a Point3<f64>>) -> f64 {
    let (mut lower, mut upper) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    for point in points {
        lower = lower.inf(&point.coords);
        upper = upper.sup(&point.coords);
    }
    (upper - lower).norm()
}

/// The distinct points (each the first of its cluster), and for every point the index of its distinct point.
pub(super) fn weld(points: &[Point3<f64>], tolerance: f64) -> (Vec<Point3<f64>>, Vec<usize>) {
    let mut distinct: Vec<Point3<f64>> = Vec::new();
    let mut cubes: HashMap<[i64; 3], Vec<usize>> = HashMap::new();

    let index_of = |point: &Point3<f64>| {
        let [x, y, z]: [i64; 3] = (point - points[0]).map(|x| (x / tolerance).floor() as i64).into();
        let around = (0..27).map(|k| [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1]);
        let mut near = around.filter_map(|cube| cubes.get(&cube)).flatten();
        if let Some(index) = near.find(|index| (distinct[**index] - point).norm() <= tolerance) {
            return *index;
        }
        distinct.push(*point);
        cubes.entry([x, y, z]).or_default().push(distinct.len() - 1);
        distinct.len() - 1
    };

    let indices = points.iter().map(index_of).collect();
    (distinct, indices)
}
