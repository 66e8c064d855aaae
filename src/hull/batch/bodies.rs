//! The paper's vectors of many bodies, on one thread or several.

use super::super::Hull;
use super::super::points::Points;
use super::{BodyResponse, Workspace};
use crate::lock::lock;
use crate::{Error, Result};
use nalgebra::{Isometry3, Vector3};
use std::sync::Mutex;

/// Bodies that a thread takes at once: few enough that no thread waits long for another's last ones.
const AT_ONCE: usize = 8;

/// A body to ask for: its samples, and its pose (world from body).
pub type Body<'a> = (&'a Points, Isometry3<f64>);

/// Bodies and the places of their answers, handed out from the front.
type Queue<'q, 'b> =
    std::iter::Zip<std::slice::Chunks<'q, Body<'b>>, std::slice::ChunksMut<'q, BodyResponse>>;

impl Hull {
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
        responses.resize(bodies.len(), BodyResponse { vector: Vector3::zeros(), colliding: 0 });
        let queue = Mutex::new(bodies.chunks(AT_ONCE).zip(responses.chunks_mut(AT_ONCE)));
        let failed = Mutex::new(None);
        let work = |workspace: &mut Workspace| {
            if let Err(error) = self.respond_from(&queue, workspace) {
                lock(&failed).get_or_insert(error);
            }
        };
        match workspaces {
            [] => {
                return Err(Error::argument(
                    "expected at least one workspace, found none; pass one a thread",
                ));
            }
            [one] => work(one),
            several => on_threads(several, work),
        }
        lock(&failed).take().map_or(Ok(()), Err)
    }

    /// Answers for bodies of the queue until it is empty.
    fn respond_from(&self, queue: &Mutex<Queue>, workspace: &mut Workspace) -> Result<()> {
        let next = || lock(queue).next();
        while let Some((bodies, responses)) = next() {
            for ((samples, world_from_body), response) in bodies.iter().zip(responses) {
                *response = self.respond_body(samples, world_from_body, workspace)?;
            }
        }
        Ok(())
    }
}

#[cfg(feature = "threads")]
fn on_threads(workspaces: &mut [Workspace], work: impl Fn(&mut Workspace) + Sync) {
    rayon::scope(|scope| {
        for workspace in workspaces {
            scope.spawn(|_| work(workspace));
        }
    });
}

#[cfg(not(feature = "threads"))]
fn on_threads(workspaces: &mut [Workspace], work: impl Fn(&mut Workspace)) {
    work(&mut workspaces[0]);
}
