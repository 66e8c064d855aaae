//! A run that was written to disk, to be drawn again.

use crate::bodies_file::{BodiesFile, PlayedRecording};
use crate::capture::STEPS_PER_SECOND;
use crate::compositor::Drawn;
use crate::states::States;
use ode_visual_hull::{Error, Result};
use std::path::Path;

/// What the bodies of a run look like, and where they were.
#[derive(Debug, Clone, PartialEq)]
pub struct FinishedRun {
    bodies: BodiesFile,
    states: States,
}

impl FinishedRun {
    /// Puts the two together.
    ///
    /// # Errors
    /// Bodies of another number than the states have.
    pub fn new(bodies: BodiesFile, states: States) -> Result<Self> {
        let (found, expected) = (bodies.bodies.len(), states.body_count());
        if found != expected {
            return Err(Error::argument(format!(
                "expected {expected} bodies, as the states have, found {found}; take the {} of the same run",
                BodiesFile::NAME
            )));
        }
        Ok(Self { bodies, states })
    }

    /// Reads `states.csv` and `bodies.toml` at these paths.
    ///
    /// # Errors
    /// All errors of [`States::read`], [`BodiesFile::read`] and [`Self::new`].
    pub fn read(states: impl AsRef<Path>, bodies: impl AsRef<Path>) -> Result<Self> {
        let of_states = States::read(states)?;
        let of_bodies = BodiesFile::read(&bodies)?;
        Self::new(of_bodies, of_states).map_err(|e| Error::file(bodies, e))
    }

    /// The time of each entry, in seconds of the film: the end of each of its frames.
    pub fn times(&self) -> &[f64] {
        self.states.times()
    }

    /// The time at which the bodies met the subject last before entry `k`, in seconds of the film: a step earlier than the
    /// entry; 0 beyond the last entry. The hull of that time is the one in the film's own frame.
    pub fn collided_at(&self, k: usize) -> f64 {
        self.times().get(k).map_or(0.0, |time| (time - 1.0 / STEPS_PER_SECOND).max(0.0))
    }

    /// The bodies at entry `k`, and what is fixed, as they are drawn; what is fixed alone beyond the last entry.
    pub fn drawn(&self, k: usize) -> Vec<Drawn> {
        let poses = self.states.poses(k).unwrap_or_default();
        let bodies = self.bodies.bodies.iter().zip(poses);
        let parts = bodies.flat_map(|(parts, pose)| parts.iter().map(move |part| part.at(pose)));
        parts.chain(self.bodies.fixed.iter().cloned()).collect()
    }

    /// How the recording was played; `None` where the run had none.
    pub fn playback(&self) -> Option<&PlayedRecording> {
        self.bodies.playback.as_ref()
    }

    /// What the bodies look like.
    pub fn bodies(&self) -> &BodiesFile {
        &self.bodies
    }

    /// Where they were.
    pub fn states(&self) -> &States {
        &self.states
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bodies_file::DrawnPart;
    use crate::states::HEADER;
    use nalgebra::{Isometry3, Vector3};
    use ode_visual_hull::shape::Shape;

    /// The states of one body that has turned by a half about z.
    fn states() -> States {
        States::from_csv(&format!("{HEADER}\n0.1,1,1,0,0,0,0,0,1,0,0,0,0,0,0\n")).unwrap()
    }

    fn two_parts() -> Vec<DrawnPart> {
        let ball = |x| DrawnPart {
            shape: Shape::Sphere { radius: 0.1 },
            body_from_part: Isometry3::translation(x, 0.0, 0.0),
            colour: [1, 2, 3],
        };
        vec![ball(0.0), ball(0.5)]
    }

    #[test]
    fn parts_are_drawn_where_their_body_was_and_what_is_fixed_stays() {
        let fixed = vec![two_parts()[1].at(&Isometry3::identity())];
        let bodies = BodiesFile { bodies: vec![two_parts()], fixed: fixed.clone(), playback: None };
        let run = FinishedRun::new(bodies, states()).unwrap();
        let places: Vec<_> = run.drawn(0).iter().map(|one| one.world_from_body.translation.vector).collect();
        let expected = [1.0, 0.5, 0.5].map(|x| Vector3::new(x, 0.0, 0.0));
        assert!(places.iter().zip(&expected).all(|(a, b)| (a - b).norm() < 1e-15), "{places:?}");
        assert_eq!(places.len(), 3);
        assert_eq!(run.drawn(1), fixed);
        assert!((run.collided_at(0) - (0.1 - 1.0 / 240.0)).abs() < 1e-12);
    }

    #[test]
    fn bodies_and_states_of_different_runs_are_refused() {
        let bodies = BodiesFile { bodies: vec![two_parts(), two_parts()], ..BodiesFile::default() };
        let message = FinishedRun::new(bodies, states()).unwrap_err().to_string();
        assert!(message.contains("expected 1 bodies, as the states have, found 2"), "{message}");
    }
}
