//! Queries of many points at once.

use super::batch::{self, ExitRay};
use super::cull;
use super::{EdgeModel, Hull};
use crate::Result;
use crate::math::point_cloud::Points;
use nalgebra::{Isometry3, Point3, Vector3};

/// Reusable memory for queries of many points. A workspace that is kept between calls stops allocating once it has
/// grown. It may be used with any hull and any points; each query overwrites the results of the one before.
#[derive(Debug, Default)]
pub struct Workspace {
    cull: cull::Scratch,
    batch: batch::Scratch,
    inside: Vec<u64>,
    places: Vec<usize>,
    rays: Vec<ExitRay>,
    exits: Vec<f64>,
    responses: Vec<PointResponse>,
}

/// Which of the queried points are inside.
#[derive(Debug, Clone, Copy)]
pub struct Inside<'w> {
    words: &'w [u64],
    count: usize,
}

/// The paper's response of one of many points (section 4.2), in the hull's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointResponse {
    /// Index of the point in the list that was queried.
    pub point: usize,
    /// Index of the view whose edge gave the normal.
    pub view: usize,
    /// Unit outward normal.
    pub normal: Vector3<f64>,
    /// Metres along the normal to the exit.
    pub depth: f64,
}

impl PointResponse {
    /// The response vector `w = c - a`, in metres.
    pub fn w(&self) -> Vector3<f64> {
        self.normal * self.depth
    }
}

impl<'w> Inside<'w> {
    /// Sets in `words` the bits of the points at `places` in the blocks of `points`.
    fn mark(points: &Points, places: &[u32], words: &'w mut Vec<u64>) -> Self {
        words.clear();
        words.resize(points.len().div_ceil(64), 0);
        for &place in places {
            let point = points.original_index(place as usize);
            words[point / 64] |= 1 << (point % 64);
        }
        Self { words, count: places.len() }
    }

    /// Number of points inside.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Whether the point at index `point` of the list that was queried is inside; false beyond the last point.
    pub fn contains(&self, point: usize) -> bool {
        self.words.get(point / 64).is_some_and(|word| word >> (point % 64) & 1 == 1)
    }

    /// The indices of the points inside, ascending.
    pub fn iter(&self) -> impl Iterator<Item = usize> {
        let bits = |word: u64| {
            std::iter::successors(Some(word), |word| Some(word & word.wrapping_sub(1)))
                .take_while(|&word| word != 0)
                .map(|word| word.trailing_zeros() as usize)
        };
        self.words.iter().enumerate().flat_map(move |(k, &word)| bits(word).map(move |bit| 64 * k + bit))
    }
}

impl Workspace {
    /// An empty workspace, which grows with use.
    pub fn new() -> Self {
        Self::default()
    }
}

impl Hull {
    /// Which of `points`, placed by the pose `hull_from_points`, are inside.
    ///
    /// The query runs in single precision: a point whose image lies within a few ten-thousandths of a pixel of a
    /// pixel's border may be counted to the neighbouring pixel.
    ///
    /// # Errors
    /// A pose that is not finite.
    pub fn inside_many<'w>(
        &self,
        points: &Points,
        hull_from_points: &Isometry3<f64>,
        workspace: &'w mut Workspace,
    ) -> Result<Inside<'w>> {
        let Workspace { cull, inside, .. } = workspace;
        let places = cull.find_inside(self, points, hull_from_points)?;
        Ok(Inside::mark(points, places, inside))
    }

    /// The paper's responses (section 4.2) of the points that are inside, in the order of `points`, which are in the
    /// hull's frame. Each is bit by bit what [`respond`](Self::respond) returns.
    pub fn respond_many<'w>(
        &self,
        points: &[Point3<f64>],
        workspace: &'w mut Workspace,
    ) -> &'w [PointResponse] {
        let Workspace { batch, places, rays, exits, responses, .. } = workspace;
        self.exit_rays(points, EdgeModel::Pixel, usize::MAX, batch, places, rays);

        // The view that gave the normal is read first, as `exits_within` overwrites it.
        responses.clear();
        responses.extend(places.iter().zip(&*rays).map(|(&point, ray)| PointResponse {
            point,
            view: ray.view,
            normal: ray.direction,
            depth: 0.0,
        }));

        self.exits_within(rays, EdgeModel::Pixel, f64::INFINITY, batch, exits);
        responses.iter_mut().zip(exits).for_each(|(response, exit)| response.depth = *exit);
        responses
    }

    /// Calls `visit` with the index of each of `bodies` that has points that may be inside by some edge model, and with
    /// these points: all but those surely outside. Bodies in a pose that is not finite are skipped.
    pub(crate) fn candidates<'b>(
        &self,
        bodies: impl Iterator<Item = (&'b Points, Isometry3<f64>)>,
        workspace: &mut Workspace,
        mut visit: impl FnMut(usize, Inside),
    ) {
        let Workspace { cull, inside, .. } = workspace;
        cull.each_candidate(self, bodies, |body, points, places| {
            visit(body, Inside::mark(points, places, inside));
        });
    }
}
