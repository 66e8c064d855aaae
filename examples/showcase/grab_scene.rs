//! Two virtual boxes, one of which real hands put on the other.

use crate::act::{Act, Claim};
use nalgebra::{Isometry3, Vector3, point, vector};
use ode_visual_hull::Result;
use ode_visual_hull::shape::Shape;
use ode_visual_hull::synthetic::Subject;
use ode_visual_hull_film::{Log, Simulation};

/// The sides of both boxes, in metres.
pub const BOX: [f64; 3] = [0.2, 0.15, 0.15];

/// Where the box is put, along y, and the height of hands at the middle of the lower and of the upper box, in metres.
pub const PLACE: f64 = 0.35;
pub const LOW: f64 = 0.5 * BOX[2];
pub const HIGH: f64 = 1.5 * BOX[2];

/// The hands as they move, in the film that they are in.
pub fn act(about: &'static str, subject: fn(f64) -> Result<Subject>, end: f64) -> Act {
    Act {
        about,
        who: "pair of hands",
        subject,
        still_until: 0.5,
        end,
        place: point![0.0, 0.1, 0.3],
        reach: 0.55,
        eye: point![1.25, 1.15, 0.75],
        target: point![0.0, 0.12, 0.2],
    }
}

/// Adds the box that is grabbed, and the one below the place for it.
pub fn add_boxes(simulation: &mut Simulation) -> Result<()> {
    let shape = Shape::Box { sides: BOX.into() };
    simulation.add(&shape, &Isometry3::translation(0.0, 0.0, LOW), [240, 188, 60])?;
    simulation.add(&shape, &Isometry3::translation(0.0, PLACE, LOW), [66, 118, 202])?;
    Ok(())
}

/// The first box stands on the second in the end.
pub fn stands_on_the_other(log: &Log) -> Claim {
    let Some(last) = log.entries.last() else { return Claim { holds: false, text: "no frame".into() } };
    let [upper, lower] = [0, 1].map(|index: usize| last.states[index].pose);
    let off = upper.translation.vector - lower.translation.vector - vector![0.0, 0.0, BOX[2]];
    let lean = (upper.rotation * Vector3::z()).z.clamp(-1.0, 1.0).acos().to_degrees();
    let (aside, above) = (1e3 * off.xy().norm(), 1e3 * off.z);
    Claim {
        holds: aside < 40.0 && above.abs() < 5.0 && lean < 2.0,
        text: format!(
            "the box stands on the other, {aside:.0} mm off its middle and {above:.1} mm above it, and leans by {lean:.1} degrees"
        ),
    }
}
