//! Of samples that lie closer together than needed, some.

use super::Sample;
use super::facets::Covering;
use std::collections::HashMap;

/// A subset that has one of its samples within `radius` of every sample. Sharp corners stay rather than edges,
/// edges rather than flat places, earlier samples rather than later ones.
pub(super) fn thin(covering: &Covering, radius: f64) -> Vec<Sample> {
    // Between a box's corner (0.58) and edge (0.71), and between an edge of 45 degrees (0.92) and none.
    let kind = |flatness: f64| u8::from(flatness > 0.64) + u8::from(flatness > 0.93);
    let mut order: Vec<usize> = (0..covering.samples.len()).collect();
    order.sort_by_key(|index| kind(covering.flatness[*index]));

    let mut cubes: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let mut kept = Vec::new();
    for index in order {
        let point = covering.samples[index].point;
        let [x, y, z]: [i64; 3] = point.coords.map(|x| (x / radius).floor() as i64).into();
        let around = (0..27).map(|k| [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1]);
        let mut near = around.filter_map(|cube| cubes.get(&cube)).flatten();
        if !near.any(|other| (covering.samples[*other].point - point).norm() <= radius) {
            cubes.entry([x, y, z]).or_default().push(index);
            kept.push(covering.samples[index]);
        }
    }
    kept
}
