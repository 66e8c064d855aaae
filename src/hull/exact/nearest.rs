//! The silhouette edges nearest to many points, and the ways out that they give.
//!
//! Points that one view decides are put together, so that its silhouette is asked for many of them at a time.

use super::super::batch::rings::{NEAR, Pixels, nearest};
use super::super::lanes::{either, floor, ones};
use super::super::points::LANES;
use super::super::response::towards;
use super::super::search::window_half_width;
use super::sight::{Block, Field};
use super::{Start, Wide};
use crate::silhouette::{self, Edge, EdgePixel};
use crate::vectorised::vectorised;
use nalgebra::{Point2, Vector3};

/// Points inside, by the view that decides the window search.
#[derive(Debug, Default)]
pub(super) struct Decided {
    /// A list for each view, of those near its background, and one of the others.
    points: Vec<[Vec<Point>; 2]>,
    /// Of one view: the background pixels nearest to the points of a list, those of both lists as edge pixels, and
    /// those whose edges are new.
    found: Vec<(i32, i32)>,
    nearest: [Vec<EdgePixel>; 2],
    new_edges: Vec<EdgePixel>,
}

/// A point as the view sees it that decides.
#[derive(Debug, Clone, Copy)]
struct Point {
    /// The place of its way out.
    way: u32,
    pixel: (i32, i32),
    /// Chebyshev distance to the background, and the half-width of the window in which that is searched.
    first: i32,
    half: i32,
}

/// The view that decides the window search for each point, at which iteration, and how fast its window grows.
struct Decision {
    field: Wide,
    iteration: Wide,
    growth: Wide,
}

/// Lines in the image: a point of each and its unit normal.
struct Tangents {
    u: Wide,
    v: Wide,
    normal_u: Wide,
    normal_v: Wide,
}

impl Decided {
    /// Takes up the points `inside` of a block, the first of which has the place `first`, and makes room in `ways` for
    /// their directions.
    #[inline(always)]
    pub(super) fn add(
        &mut self,
        fields: &[Field],
        block: &mut Block,
        inside: u32,
        first: usize,
        ways: &mut Vec<(usize, Start)>,
    ) {
        let decision = decide(fields, block);
        self.points.resize_with(self.points.len().max(fields.len()), Default::default);
        for k in ones(inside) {
            let place = decision.field[k] as usize;
            let (field, sighting) = (&fields[place], &block.sightings[place]);
            let first_background = sighting.clear[k] as i32;
            let half = window_half_width(decision.iteration[k] as i64, decision.growth[k]);
            self.points[place][usize::from(first_background > NEAR)].push(Point {
                way: ways.len() as u32,
                pixel: (sighting.column[k] as i32, sighting.row[k] as i32),
                first: first_background,
                half: half.max(first_background),
            });
            let start = Start { point: block.point(k), direction: Vector3::zeros(), view: field.index };
            ways.push((first + k, start));
        }
    }

    /// Writes the directions of the ways out of all points taken up, and forgets them.
    pub(super) fn find_directions(&mut self, fields: &[Field], ways: &mut [(usize, Start)]) {
        let Self { points, nearest, found, new_edges } = self;
        for (field, lists) in fields.iter().zip(points) {
            let silhouette = field.view.silhouette();
            new_edges.clear();
            for (points, nearest) in lists.iter().zip(nearest.iter_mut()) {
                found.clear();
                find_nearest(field, points, found);
                nearest.clear();
                nearest.extend(found.iter().map(|&at| silhouette.edge_pixel(at)));
                new_edges.extend(nearest.iter().filter(|pixel| silhouette.claim_edge(pixel)));
            }
            silhouette::compute_edges(silhouette, new_edges);
            for (points, nearest) in lists.iter_mut().zip(nearest.iter()) {
                find_directions(field, points, nearest, ways);
                points.clear();
            }
        }
    }
}

vectorised! {
    /// Adds the background pixels nearest to `points`, all of which the view decides, to `found`.
    fn find_nearest(field: &Field, points: &[Point], found: &mut Vec<(i32, i32)>) {
        let (tables, (x, y)) = (field.view.silhouette().tables(), field.corner);
        for points in points.chunks(LANES) {
            let (mut middle, mut first, mut half) = (Pixels::default(), [0; LANES], [0; LANES]);
            for k in 0..LANES {
                let point = points[k.min(points.len() - 1)];
                (middle.column[k], middle.row[k]) = (point.pixel.0 - x, point.pixel.1 - y);
                (first[k], half[k]) = (point.first, point.half);
            }
            let nearest = nearest(&tables, &middle, &first, &half);
            found.extend((0..points.len()).map(|k| (nearest.column[k] + x, nearest.row[k] + y)));
        }
    }
}

vectorised! {
    /// Writes the directions of the ways out of `points`, given by the edges at the pixels `nearest` to them.
    fn find_directions(
        field: &Field,
        points: &[Point],
        nearest: &[EdgePixel],
        ways: &mut [(usize, Start)],
    ) {
        for (points, nearest) in points.chunks(LANES).zip(nearest.chunks(LANES)) {
            let (zero, one) = ([0.0; LANES], [1.0; LANES]);
            let mut lines = Tangents { u: zero, v: zero, normal_u: zero, normal_v: one };
            for (k, (point, nearest)) in points.iter().zip(nearest).enumerate() {
                let Edge { point, normal } = edge(field, point, nearest);
                (lines.u[k], lines.v[k]) = (point.x, point.y);
                (lines.normal_u[k], lines.normal_v[k]) = (normal.x, normal.y);
            }
            let [x, y, z] = field.backproject(&lines);
            for (k, point) in points.iter().enumerate() {
                ways[point.way as usize].1.direction = Vector3::new(x[k], y[k], z[k]);
            }
        }
    }
}

/// The edge at the pixel nearest to a point, or what stands in for it: a line across the way there.
#[inline(always)]
fn edge(field: &Field, point: &Point, nearest: &EdgePixel) -> Edge {
    field.view.silhouette().edge_at(nearest).unwrap_or_else(|| {
        let (i, j) = nearest.at;
        Edge {
            point: Point2::new(f64::from(i) + 0.5, f64::from(j) + 0.5),
            normal: towards(i - point.pixel.0, j - point.pixel.1),
        }
    })
}

impl Field<'_> {
    /// The unit normals in the world of the planes through the camera's centre and lines in the image: the sums of
    /// [`View::backproject_normal`](super::super::View::backproject_normal).
    #[inline(always)]
    fn backproject(&self, lines: &Tangents) -> [Wide; 3] {
        let ([p0, p1, p2], mut normal) = (&self.p, [[0.0; LANES]; 3]);
        for k in 0..LANES {
            let across = |axis: usize| {
                (p0[axis] - p2[axis] * lines.u[k]) * lines.normal_u[k]
                    + (p1[axis] - p2[axis] * lines.v[k]) * lines.normal_v[k]
            };
            let [x, y, z] = [across(0), across(1), across(2)];
            let length = (x * x + y * y + z * z).sqrt();
            (normal[0][k], normal[1][k], normal[2][k]) = (x / length, y / length, z / length);
        }
        normal
    }
}

/// The first k at which a window, `1 + floor(k d_max / d_i)`, reaches the view's distance; the first view among
/// equals. As [`Hull::nearest_edge`](super::super::Hull::nearest_edge) has it.
#[inline(always)]
fn decide(fields: &[Field], block: &mut Block) -> Decision {
    let mut largest = [0.0; LANES];
    for (field, sighting) in fields.iter().zip(&mut block.sightings) {
        field.footprint.at_each(&sighting.at[2], &mut sighting.footprint);
        for k in 0..LANES {
            largest[k] = either(sighting.footprint[k] > largest[k], sighting.footprint[k], largest[k]);
        }
    }
    let mut decision =
        Decision { field: [0.0; LANES], iteration: [f64::INFINITY; LANES], growth: [0.0; LANES] };
    for (place, sighting) in block.sightings.iter().enumerate() {
        for k in 0..LANES {
            let growth = largest[k] / sighting.footprint[k];
            let beside = sighting.clear[k] - 1.0;
            // The closed form; the division rounds to below a whole number where that reaches already, so that one
            // more is all it may need. The point's own pixel is at -1.
            let whole = floor(either(beside > 0.0, beside / growth, 0.0));
            let iteration = either(whole * growth < beside, whole + 1.0, whole);
            let iteration = either(beside < 0.0, -1.0, iteration);
            let sooner = iteration < decision.iteration[k];
            decision.iteration[k] = either(sooner, iteration, decision.iteration[k]);
            decision.growth[k] = either(sooner, growth, decision.growth[k]);
            decision.field[k] = either(sooner, place as f64, decision.field[k]);
        }
    }
    decision
}
