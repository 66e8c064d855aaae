//! Reduces the samples of bodies with faces much smaller than `min_feature` to fewer than their corners.

use super::Sample;
use super::facets::{Covering, Facets};
use super::limits::{check_count, spacing};
use crate::Result;
use std::collections::HashMap;

/// Samples that cover a surface of flat faces, and their covering radius in metres: as many as the faces need, or
/// fewer if corners are closer together than needed. For `own` see [`Facets::cover`].
pub(super) fn sample(facets: &Facets, body: &str, min_feature: f64, own: bool) -> Result<(Vec<Sample>, f64)> {
    let covering = facets.cover(body, min_feature, own)?;
    let (mut samples, mut radius) = (covering.samples, covering.radius);

    // If there are about as many corners as a square grid has nodes, try samples of twice the density, thinned.
    let fine = facets.corners.len() as f64 > 50.0 + 0.5 * facets.area() / spacing(min_feature)?.powi(2);
    if fine && let Ok(dense) = facets.cover(body, min_feature / 2.0, false) {
        let thinned = decimate(&dense, min_feature / 2.0 - dense.radius);
        if thinned.len() < samples.len() {
            (samples, radius) = (thinned, min_feature / 2.0);
        }
    }

    check_count(body, samples.len() as f64, min_feature)?;
    Ok((samples, radius))
}

/// A subset with a sample within `radius` of every sample. Sharp corners are kept before edges, edges before flat
/// places, and earlier samples before later ones.
fn decimate(covering: &Covering, radius: f64) -> Vec<Sample> {
    // The limits lie between a box's corner (0.58) and edge (0.71), and between an edge of 45 degrees (0.92) and none.
    let kind = |flatness: f64| u8::from(flatness > 0.64) + u8::from(flatness > 0.93);
    let mut order: Vec<usize> = (0..covering.samples.len()).collect();
    order.sort_by_key(|index| kind(covering.flatness[*index]));

    let mut cubes: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let mut kept = Vec::new();

    // First samples at the distance of corners of triangles that the radius just covers, then those in the gaps.
    for distance in [3.0_f64.sqrt() * radius, radius] {
        for index in &order {
            let point = covering.samples[*index].point;
            let [x, y, z]: [i64; 3] = point.coords.map(|x| (x / (2.0 * radius)).floor() as i64).into();
            let around = (0..27).map(|k| [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1]);
            let mut near = around.filter_map(|cube| cubes.get(&cube)).flatten();
            if !near.any(|other| (covering.samples[*other].point - point).norm() <= distance) {
                cubes.entry([x, y, z]).or_default().push(*index);
                kept.push(*index);
            }
        }
    }

    let mut rank = vec![0; covering.samples.len()];
    order.iter().enumerate().for_each(|(k, index)| rank[*index] = k);
    kept.sort_by_key(|index| rank[*index]);
    kept.into_iter().map(|index| covering.samples[index]).collect()
}
