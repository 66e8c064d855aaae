//! The paper's vectors of bodies (section 5), on one thread or several.

use super::super::lanes::ones;
use super::super::points::{Block, LANES, Points};
use super::super::{EdgeModel, Hull};
use super::folded_hull::FoldedHull;
use super::inside::{self, Within};
use super::pool::{ENOUGH, Pool};
use super::respond::{Responses, WayOut};
use super::{Workspace, exit::Exits};
use crate::lock::lock;
use crate::{Error, Result};
use nalgebra::{Isometry3, Vector3};
use std::sync::Mutex;

/// The least bodies that one of several threads takes at once: few enough that none waits long for another's last ones.
const AT_ONCE: usize = 32;

/// How often one point a body is asked before all that are left.
const LEADERS: usize = 2;

/// A body to ask for: its samples, and its pose (world from body).
pub type Body<'a> = (&'a Points, Isometry3<f64>);

/// The paper's response of a body (section 5).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyResponse {
    /// The vector that moves the body out, in metres; zero where nothing collides.
    pub vector: Vector3<f64>,
    /// How many samples collide.
    pub colliding: usize,
}

impl BodyResponse {
    const NONE: Self = Self { vector: Vector3::new(0.0, 0.0, 0.0), colliding: 0 };
}

/// Bodies and the places of their answers, handed out from the front to so many threads.
struct Queue<'q, 'b> {
    bodies: &'q [Body<'b>],
    responses: &'q mut [BodyResponse],
    threads: usize,
}

/// What the points of a body say together.
#[derive(Debug, Clone, Copy, Default)]
struct Verdict {
    colliding: usize,
    sum: Vector3<f64>,
    /// The longest way out.
    depth: f32,
    /// The normal there, and then the unit direction of V.
    direction: Vector3<f64>,
    longest: f32,
}

/// Verdicts on the bodies of a pool.
#[derive(Debug, Default)]
pub(super) struct Verdicts {
    bodies: Vec<Verdict>,
    directions: Vec<Block>,
    exits: Exits,
    /// Points whose exits are asked now, and those that may have to be asked.
    asked: Vec<u32>,
    left: Vec<u32>,
}

impl Hull {
    /// The paper's vector of a body (section 5) with these samples: the mean of the responses gives the direction,
    /// the longest exit along it the length. Where the responses cancel out, the deepest sample's stands in.
    ///
    /// Many bodies are sooner answered together, by [`respond_bodies`](Self::respond_bodies).
    ///
    /// # Errors
    /// A pose that is not finite.
    pub fn respond_body(
        &self,
        samples: &Points,
        world_from_body: &Isometry3<f64>,
        workspace: &mut Workspace,
    ) -> Result<BodyResponse> {
        let mut response = [BodyResponse::NONE];
        self.respond_together(&[(samples, *world_from_body)], &mut response, workspace)?;
        Ok(response[0])
    }

    /// [`Self::respond_body`] of each of `bodies`, in their order, written to `responses`.
    ///
    /// With the feature `threads` as many threads of a pool that persists work as there are `workspaces`; else, or with
    /// one workspace, the caller's thread alone. The answers have the same bits however many there are: no body's
    /// answer depends on another's.
    ///
    /// # Errors
    /// A pose that is not finite; no workspace.
    pub fn respond_bodies(
        &self,
        bodies: &[Body],
        workspaces: &mut [Workspace],
        responses: &mut Vec<BodyResponse>,
    ) -> Result<()> {
        responses.clear();
        responses.resize(bodies.len(), BodyResponse::NONE);
        match workspaces {
            [] => Err(Error::argument("expected at least one workspace, found none; pass one a thread")),
            [one] => self.respond_together(bodies, responses, one),
            several => self.respond_on_threads(bodies, responses, several),
        }
    }

    fn respond_on_threads(
        &self,
        bodies: &[Body],
        responses: &mut [BodyResponse],
        workspaces: &mut [Workspace],
    ) -> Result<()> {
        let queue = Mutex::new(Queue { bodies, responses, threads: workspaces.len() });
        let failed = Mutex::new(None);
        on_threads(workspaces, |workspace| {
            if let Err(error) = self.respond_from(&queue, workspace) {
                lock(&failed).get_or_insert(error);
            }
        });
        lock(&failed).take().map_or(Ok(()), Err)
    }

    /// Answers for bodies of the queue until it is empty.
    fn respond_from(&self, queue: &Mutex<Queue>, workspace: &mut Workspace) -> Result<()> {
        let next = || lock(queue).next();
        while let Some((bodies, responses)) = next() {
            self.respond_together(bodies, responses, workspace)?;
        }
        Ok(())
    }

    /// Answers for as many bodies at a time as fill a pool.
    fn respond_together(
        &self,
        bodies: &[Body],
        responses: &mut [BodyResponse],
        workspace: &mut Workspace,
    ) -> Result<()> {
        let mut folded = workspace.fold(self);
        let mut answer = || -> Result<()> {
            let Workspace { found, pool, ways, verdicts, .. } = workspace;
            let mut first = 0;
            pool.clear();
            for (k, (samples, world_from_body)) in bodies.iter().enumerate() {
                found.places.clear();
                let posed = folded.find(samples, world_from_body, Within::Subject, found)?;
                pool.take(k - first, samples, &found.places, &posed);
                if pool.len() >= ENOUGH || k + 1 == bodies.len() {
                    verdicts.fill(&folded, pool, ways, &mut responses[first..=k]);
                    pool.clear();
                    first = k + 1;
                }
            }
            Ok(())
        };
        let answered = answer();
        workspace.take_back(folded);
        answered
    }
}

impl<'q, 'b> Queue<'q, 'b> {
    /// A part of what is left: large ones first, whose points fill the lanes, small ones in the end.
    fn next(&mut self) -> Option<(&'q [Body<'b>], &'q mut [BodyResponse])> {
        let share = self.bodies.len() / (2 * self.threads);
        let count = share.max(AT_ONCE).min(self.bodies.len());
        let (bodies, responses) = (self.bodies.split_off(..count)?, self.responses.split_off_mut(..count)?);
        (count > 0).then_some((bodies, responses))
    }
}

impl Verdict {
    /// Takes a colliding point's response into account.
    fn add(&mut self, way: &WayOut) {
        if self.colliding == 0 || way.depth > self.depth {
            (self.depth, self.direction) = (way.depth, way.normal.cast::<f64>());
        }
        self.colliding += 1;
        self.sum += (way.normal * way.depth).cast::<f64>();
    }
}

impl Verdicts {
    /// Writes the vectors of the bodies whose points are in `pool`.
    fn fill(
        &mut self,
        hull: &FoldedHull,
        pool: &mut Pool,
        ways: &mut Responses,
        responses: &mut [BodyResponse],
    ) {
        responses.fill(BodyResponse::NONE);
        if pool.len() == 0 {
            return;
        }
        ways.fill(hull, pool);
        self.weigh(pool, ways, responses.len());
        self.measure(hull, pool);
        for (response, verdict) in responses.iter_mut().zip(&self.bodies) {
            let vector = verdict.direction * f64::from(verdict.longest);
            *response = BodyResponse { vector, colliding: verdict.colliding };
        }
    }

    /// The direction of each body's V.
    fn weigh(&mut self, pool: &Pool, ways: &Responses, bodies: usize) {
        self.bodies.clear();
        self.bodies.resize(bodies, Verdict::default());
        let mut points = 0..;
        for of_one in pool.owners.chunk_by(|a, b| a == b) {
            let mut verdict = Verdict::default();
            points
                .by_ref()
                .take(of_one.len())
                .filter_map(|point| ways.get(point))
                .for_each(|way| verdict.add(&way));
            verdict.direction = verdict.sum.try_normalize(0.0).unwrap_or(verdict.direction);
            self.bodies[of_one[0] as usize] = verdict;
        }
    }

    /// The longest exit of each body's points along its V: first that of the hindmost point. Of the others only those
    /// that are still inside so far along V may have a longer one, and of these the hindmost is asked next.
    fn measure(&mut self, hull: &FoldedHull, pool: &Pool) {
        if !hull.hull.every_view_tells() {
            self.measure_one_by_one(hull, pool);
            return;
        }
        self.aim(pool);
        self.exits.start_at_walls(&hull.volume, pool, &self.directions);
        self.left.clear();
        self.left.extend(0..pool.len() as u32);
        for _ in 0..LEADERS {
            self.choose_hindmost(pool);
            self.ask(hull, pool);
            self.leave_behind(hull, pool);
        }
        std::mem::swap(&mut self.asked, &mut self.left);
        self.ask(hull, pool);
    }

    /// Of the points left asks each body's that lies farthest back along its V.
    fn choose_hindmost(&mut self, pool: &Pool) {
        let Self { directions, asked, left, .. } = self;
        asked.clear();
        for of_one in left.chunk_by(|&a, &b| pool.owners[a as usize] == pool.owners[b as usize]) {
            let (mut least, mut hindmost) = (f32::INFINITY, of_one[0]);
            for &point in of_one {
                let (block, lane) = (point as usize / LANES, point as usize % LANES);
                let ([x, y, z], [dx, dy, dz]) = (pool.at[block].get(lane), directions[block].get(lane));
                let along = x * dx + y * dy + z * dz;
                if along < least {
                    (least, hindmost) = (along, point);
                }
            }
            asked.push(hindmost);
        }
    }

    /// Takes the exits of the points asked into account.
    fn ask(&mut self, hull: &FoldedHull, pool: &Pool) {
        let Self { bodies, directions, exits, asked, .. } = self;
        exits.fill_some(&hull.views, pool, directions, asked);
        for &point in asked.iter() {
            let longest = &mut bodies[pool.owners[point as usize] as usize].longest;
            *longest = longest.max(exits.get(point as usize));
        }
    }

    /// Of the points left keeps those whose exits, as far as they are known, are longer than the longest so far, and
    /// that are still inside where that has brought them.
    fn leave_behind(&mut self, hull: &FoldedHull, pool: &Pool) {
        let Self { bodies, directions, exits, left, .. } = self;
        left.retain(|&point| {
            let body = pool.owners[point as usize];
            exits.get(point as usize) > bodies[body as usize].longest
        });
        let mut kept = 0;
        for start in (0..left.len()).step_by(LANES) {
            let count = LANES.min(left.len() - start);
            let mut moved = Block::default();
            for k in 0..LANES {
                let point = left[start + k.min(count - 1)] as usize;
                let ([x, y, z], way) =
                    (pool.at[point / LANES].get(point % LANES), directions[point / LANES].get(point % LANES));
                let longest = bodies[pool.owners[point] as usize].longest;
                moved.set(k, [x + longest * way[0], y + longest * way[1], z + longest * way[2]]);
            }
            let inside = inside::of_block(&hull.views, &moved) & (u32::MAX >> (LANES - count));
            for k in ones(inside) {
                left[kept] = left[start + k];
                kept += 1;
            }
        }
        left.truncate(kept);
    }

    /// Each point's direction is its body's.
    fn aim(&mut self, pool: &Pool) {
        self.directions.resize(pool.at.len(), Block::default());
        for (block, directions) in self.directions.iter_mut().enumerate() {
            for lane in 0..LANES {
                let body = pool.owners[(block * LANES + lane).min(pool.len() - 1)];
                directions.set(lane, self.bodies[body as usize].direction.cast::<f32>().into());
            }
        }
    }

    /// What a view's silence means, the single queries weigh.
    fn measure_one_by_one(&mut self, hull: &FoldedHull, pool: &Pool) {
        for (point, &body) in pool.owners.iter().enumerate() {
            let p = hull.volume.in_world(pool.at[point / LANES].get(point % LANES));
            let verdict = &mut self.bodies[body as usize];
            let exit = hull.hull.exit(&p, &verdict.direction, EdgeModel::Pixel);
            verdict.longest = verdict.longest.max(exit as f32);
        }
    }
}

#[cfg(feature = "threads")]
fn on_threads(workspaces: &mut [Workspace], work: impl Fn(&mut Workspace) + Sync) {
    let Some((own, others)) = workspaces.split_first_mut() else { return };
    // The caller's thread need not be woken.
    rayon::in_place_scope(|scope| {
        for workspace in others {
            scope.spawn(|_| work(workspace));
        }
        work(own);
    });
}

#[cfg(not(feature = "threads"))]
fn on_threads(workspaces: &mut [Workspace], work: impl Fn(&mut Workspace)) {
    work(&mut workspaces[0]);
}
