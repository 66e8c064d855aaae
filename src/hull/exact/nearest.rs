//! The silhouette edges nearest to many points, and the ways out that they give.

use super::super::lanes::{either, floor, ones};
use super::super::points::LANES;
use super::super::search::window_half_width;
use super::super::{Hull, NearestEdge};
use super::sight::{Block, Field};
use super::{Start, Wide};
use crate::camera::Pixel;
use crate::silhouette;

/// The view that decides the window search for each point, at which iteration, and how fast its window grows.
struct Decided {
    field: Wide,
    iteration: Wide,
    growth: Wide,
}

/// Adds the ways out of the points `inside`, with their places, the first of which is `first`.
#[inline(always)]
pub(super) fn add_ways(
    hull: &Hull,
    fields: &[Field],
    block: &mut Block,
    inside: u32,
    first: usize,
    ways: &mut Vec<(usize, Start)>,
) {
    let decided = decide(fields, block);
    let (mut has_way, mut background) = (0, [(0, 0); LANES]);
    let (mut new, mut count) = ([(fields[0].view.silhouette(), (0, 0)); LANES], 0);
    for k in ones(inside) {
        let place = decided.field[k] as usize;
        let (silhouette, sighting) = (fields[place].view.silhouette(), &block.sightings[place]);
        let half = window_half_width(decided.iteration[k] as i64, decided.growth[k]);
        let (i, j) = (sighting.column[k] as i32, sighting.row[k] as i32);
        let Some(b) = silhouette.nearest_background(i, j, half) else { continue };
        background[k] = b;
        has_way |= 1 << k;
        if !silhouette.knows_edge(b) {
            new[count] = (silhouette, b);
            count += 1;
        }
    }
    silhouette::compute_edges(&new[..count]);
    for k in ones(has_way) {
        let place = decided.field[k] as usize;
        let (field, at) = (&fields[place], block.sightings[place].at.map(|at| at[k]));
        let a = Pixel { u: at[0] / at[2], v: at[1] / at[2], depth: at[2] };
        let direction = hull.contact_normal(&NearestEdge { view: field.view, a, b: background[k] });
        ways.push((first + k, Start { point: block.point(k), direction, view: field.index }));
    }
}

/// The first k at which a window, `1 + floor(k d_max / d_i)`, reaches the view's distance; the first view among
/// equals. As [`Hull::nearest_edge`](super::super::Hull::nearest_edge) has it.
#[inline(always)]
fn decide(fields: &[Field], block: &mut Block) -> Decided {
    let mut largest = [0.0; LANES];
    for (field, sighting) in fields.iter().zip(&mut block.sightings) {
        field.footprint.at_each(&sighting.at[2], &mut sighting.footprint);
        for k in 0..LANES {
            largest[k] = either(sighting.footprint[k] > largest[k], sighting.footprint[k], largest[k]);
        }
    }
    let mut decided =
        Decided { field: [0.0; LANES], iteration: [f64::INFINITY; LANES], growth: [0.0; LANES] };
    for (place, sighting) in block.sightings.iter().enumerate() {
        for k in 0..LANES {
            let growth = largest[k] / sighting.footprint[k];
            let beside = sighting.clear[k] - 1.0;
            // The closed form; the division rounds to below a whole number where that reaches already, so that one
            // more is all it may need. The point's own pixel is at -1.
            let whole = floor(either(beside > 0.0, beside / growth, 0.0));
            let iteration = either(whole * growth < beside, whole + 1.0, whole);
            let iteration = either(beside < 0.0, -1.0, iteration);
            let sooner = iteration < decided.iteration[k];
            decided.iteration[k] = either(sooner, iteration, decided.iteration[k]);
            decided.growth[k] = either(sooner, growth, decided.growth[k]);
            decided.field[k] = either(sooner, place as f64, decided.field[k]);
        }
    }
    decided
}
