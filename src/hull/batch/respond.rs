//! The paper's responses of many points inside.

use super::super::points::{LANES, Lane, Points};
use super::exit::{Sightings, exits};
use super::fold::{Folded, FoldedBox, either};
use crate::vectorised::vectorised;
use nalgebra::Vector3;

/// The response of one point, in the points' own frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    /// Its place in the blocks.
    pub(super) place: u32,
    /// The deciding view's place among the folded ones.
    pub(super) view: u32,
    pub(super) normal: Vector3<f32>,
    pub(super) depth: f32,
}

vectorised! {
    /// Adds the ways out of the points at `places`, all of them inside; a point for which no view has an edge is
    /// left out.
    pub(super) fn ways_out(
        points: &Points,
        places: &[u32],
        views: &[Folded],
        volume: &FoldedBox,
        sightings: &mut Sightings,
        ways: &mut Vec<Way>,
    ) {
        for chunk in places.chunks(LANES) {
            sightings.take(views, |k| points.at(chunk[k.min(chunk.len() - 1)] as usize));
            let (first, half) = nearest_views(views, sightings);
            let (mut normal, mut used) = ([[0.0; LANES]; 3], 0);
            for k in 0..chunk.len() {
                if let Some(n) = normal_of(views, sightings, k, first[k], half[k]) {
                    (normal[0][k], normal[1][k], normal[2][k]) = (n.x, n.y, n.z);
                    used |= 1 << k;
                }
            }
            let depth = exits(views, volume, sightings, &normal, &first, used, -1.0);
            for (k, &place) in chunk.iter().enumerate() {
                if used >> k & 1 == 1 {
                    let normal = Vector3::new(normal[0][k], normal[1][k], normal[2][k]);
                    ways.push(Way { place, view: first[k] as u32, normal, depth: depth[k] });
                }
            }
        }
    }
}

vectorised! {
    /// The longest exit along `direction` of the points of `ways`.
    pub(super) fn longest_exit(
        points: &Points,
        ways: &[Way],
        direction: &Vector3<f32>,
        views: &[Folded],
        volume: &FoldedBox,
        sightings: &mut Sightings,
    ) -> f32 {
        let direction = [direction.x, direction.y, direction.z].map(|x| [x; LANES]);
        let mut longest = 0.0_f32;
        for chunk in ways.chunks(LANES) {
            let way = |k: usize| &chunk[k.min(chunk.len() - 1)];
            sightings.take(views, |k| points.at(way(k).place as usize));
            let mut first = [0; LANES];
            for (k, first) in first.iter_mut().enumerate() {
                *first = way(k).view as usize;
            }
            let exit = exits(views, volume, sightings, &direction, &first, u32::MAX, longest);
            longest = exit.into_iter().fold(longest, f32::max);
        }
        longest
    }
}

/// The view that decides the window search for each point, and the half-width of its window: the first k at which
/// `1 + floor(k d_max / d_i)` reaches the view's distance decides, the first view among equals.
#[inline(always)]
fn nearest_views(views: &[Folded], points: &Sightings) -> ([usize; LANES], Lane) {
    let mut largest = [0.0_f32; LANES];
    for (view, sighting) in views.iter().zip(&points.views) {
        for k in 0..LANES {
            let size = sighting.at.depth[k] * view.footprint;
            largest[k] = either(size > largest[k], size, largest[k]);
        }
    }
    let (mut soonest, mut first, mut half) = ([f32::INFINITY; LANES], [0.0; LANES], [0.0; LANES]);
    for (place, (view, sighting)) in views.iter().zip(&points.views).enumerate() {
        for k in 0..LANES {
            let growth = largest[k] / (sighting.at.depth[k] * view.footprint);
            let iteration = ((sighting.clear[k] - 1.0) / growth).ceil();
            let reach = 1.0 + (iteration * growth).floor();
            let reach = either(reach > sighting.clear[k], reach, sighting.clear[k]);
            let sooner = iteration < soonest[k];
            soonest[k] = either(sooner, iteration, soonest[k]);
            first[k] = either(sooner, place as f32, first[k]);
            half[k] = either(sooner, reach, half[k]);
        }
    }
    (first.map(|place| place as usize), half)
}

/// The unit normal of point k's nearest edge, outwards.
#[inline(always)]
fn normal_of(
    views: &[Folded],
    points: &Sightings,
    k: usize,
    place: usize,
    half: f32,
) -> Option<Vector3<f32>> {
    let (view, sighting) = (&views[place], &points.views[place]);
    let (i, j) = (sighting.column[k] as i32, sighting.row[k] as i32);
    let corner = view.tables.corner;
    let silhouette = view.silhouette;
    let (bi, bj) = silhouette.nearest_background(i + corner.0, j + corner.1, half as i32)?;
    let (bi, bj) = (bi - corner.0, bj - corner.1);
    let tangent = silhouette.paper_direction(bi + corner.0, bj + corner.1).unwrap_or((bi - i, bj - j));
    let tangent = (tangent.0 as f32, tangent.1 as f32);
    let (u, v) = (bi as f32 + 0.5, bj as f32 + 0.5);
    let [p0, p1, p2] = &view.p;
    let across = |axis: usize| (p0[axis] - u * p2[axis]) * tangent.0 + (p1[axis] - v * p2[axis]) * tangent.1;
    let normal = Vector3::new(across(0), across(1), across(2));
    let length = normal.norm();
    (length > 0.0).then(|| normal / length)
}
