//! The scenes of virtual bodies to choose from.

use nalgebra::{Isometry3, Point3, Vector3};
use ode_visual_hull::Result;
use ode_visual_hull::hull::Aabb;
use ode_visual_hull::shape::Shape;
use ode_visual_hull_film::{DrawnPart, Simulation};

const COLOURS: [[u8; 3]; 6] =
    [[222, 86, 62], [66, 118, 202], [240, 188, 60], [146, 92, 186], [236, 236, 228], [64, 168, 160]];

/// Gap between boxes that lie on one another, in metres.
const GAP: f64 = 0.001;

/// Gap between boxes beside one another in a pile, in metres.
const GAP_IN_LAYER: f64 = 0.02;

/// Distance of a stack or a pile from the subject, in metres.
const CLEARANCE: f64 = 0.15;

/// Seconds between two boxes of the rain.
const RAIN_PERIOD: f64 = 0.25;

/// Height above the subject from which it rains, in metres, and how far beside it.
const RAIN_HEIGHT: f64 = 0.6;
const RAIN_REACH: f64 = 0.25;

/// Which bodies there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Scenery {
    /// Boxes on one another beside the subject.
    #[default]
    Stack,
    /// Boxes in a wall of layers, each one box shorter than that below it.
    Pile,
    /// Boxes that fall on the subject, one after the other, again and again.
    Rain,
}

/// Virtual bodies of one kind.
#[derive(Debug, Clone, Copy)]
pub struct Bodies {
    /// Which there are.
    pub scenery: Scenery,
    /// How many.
    pub count: usize,
    /// Edge of the boxes, in metres.
    pub side: f64,
}

impl Scenery {
    /// The one after it, and the first after the last.
    pub fn next(self) -> Self {
        match self {
            Self::Stack => Self::Pile,
            Self::Pile => Self::Rain,
            Self::Rain => Self::Stack,
        }
    }
}

impl Bodies {
    /// Adds the bodies to `simulation`, in which a subject stands within `subject`; those that rain come later.
    ///
    /// # Errors
    /// A side that is not positive.
    pub fn add_to(&self, simulation: &mut Simulation, subject: &Aabb) -> Result<()> {
        match self.scenery {
            Scenery::Stack => self.add_stack(simulation, subject),
            Scenery::Pile => self.add_pile(simulation, subject),
            Scenery::Rain => Ok(()),
        }
    }

    /// What they are, in words.
    pub fn description(&self) -> String {
        let (name, count) = (format!("{:?}", self.scenery).to_lowercase(), self.count);
        format!("a {name} of {count} boxes")
    }

    fn add_stack(&self, simulation: &mut Simulation, subject: &Aabb) -> Result<()> {
        let foot = beside(subject, 0.5 * self.side);
        let heights = (0..self.count).map(|k| (k, (k as f64 + 0.5) * (self.side + GAP)));
        let mut boxes = heights.map(|(k, height)| (k, foot + Vector3::z() * height));
        boxes.try_for_each(|(k, place)| self.add_box(simulation, k, place).map(|_| ()))
    }

    /// The box of the bodies as they are at first, beside a `subject`; empty for those that come later.
    pub fn extent(&self, subject: &Aabb) -> Aabb {
        let (wide, high) = match self.scenery {
            Scenery::Stack => (1, self.count),
            Scenery::Pile => (self.base_of_pile(), self.base_of_pile()),
            Scenery::Rain => return Aabb::EMPTY,
        };
        let half = 0.5 * self.side;
        let (foot, across) = (beside(subject, half), 0.5 * (self.side + GAP_IN_LAYER) * wide as f64);
        Aabb {
            min: foot - Vector3::new(half, across, 0.0),
            max: foot + Vector3::new(half, across, (self.side + GAP) * high as f64),
        }
    }

    /// Boxes in the lowest layer of a pile: the fewest that leave room for all others above them.
    fn base_of_pile(&self) -> usize {
        (1..).find(|base| base * (base + 1) / 2 >= self.count).unwrap_or(1)
    }

    fn add_pile(&self, simulation: &mut Simulation, subject: &Aabb) -> Result<()> {
        let base = self.base_of_pile();
        let foot = beside(subject, 0.5 * self.side);
        let places = (0..base).flat_map(|layer| (0..base - layer).map(move |column| (layer, column)));
        let place = |(layer, column): (usize, usize)| {
            let across = column as f64 - 0.5 * (base - layer - 1) as f64;
            let height = (layer as f64 + 0.5) * (self.side + GAP);
            foot + Vector3::new(0.0, across * (self.side + GAP_IN_LAYER), height)
        };
        let mut places = places.take(self.count).map(place).enumerate();
        places.try_for_each(|(k, place)| self.add_box(simulation, k, place).map(|_| ()))
    }

    /// Lets it rain on a `subject` at time `time`, in seconds, if that is due: adds the next box, or lifts the one that fell
    /// first again.
    ///
    /// # Errors
    /// A side that is not positive.
    pub fn rain(
        &self,
        simulation: &mut Simulation,
        subject: &Aabb,
        fallen: &mut Rainfall,
        time: f64,
    ) -> Result<()> {
        if self.scenery != Scenery::Rain || self.count == 0 || time < fallen.next {
            return Ok(());
        }
        fallen.next = time + RAIN_PERIOD;
        let k = fallen.count;
        fallen.count += 1;

        // The golden angle spreads the places evenly.
        let (sin, cos) = (2.399_963 * k as f64).sin_cos();
        let out = RAIN_REACH * (k as f64 * 0.618_034).fract().sqrt();
        let subject = standing(subject);
        let height = subject.max.z + RAIN_HEIGHT;
        let centre = subject.centre();
        let place = Point3::new(centre.x + out * cos, centre.y + out * sin, height);
        if k < self.count {
            fallen.boxes.push(self.add_box(simulation, k, place)?);
            return Ok(());
        }
        simulation
            .place(fallen.boxes[k % self.count], &Isometry3::new(place.coords, Vector3::z() * 0.4 * k as f64))
    }

    /// What box `k` looks like.
    pub fn drawn_box(&self, k: usize) -> DrawnPart {
        let colour = COLOURS[k % COLOURS.len()];
        DrawnPart { shape: Shape::cube(self.side), body_from_part: Isometry3::identity(), colour }
    }

    fn add_box(&self, simulation: &mut Simulation, k: usize, place: Point3<f64>) -> Result<usize> {
        let pose = Isometry3::translation(place.x, place.y, place.z);
        let DrawnPart { shape, colour, .. } = self.drawn_box(k);
        simulation.add(&shape, &pose, colour)
    }
}

/// How far the rain has come.
#[derive(Debug, Clone, Default)]
pub struct Rainfall {
    /// When the next box falls, in seconds.
    next: f64,
    /// How many have fallen, those that fell again included.
    count: usize,
    /// The indices of the boxes among all bodies.
    boxes: Vec<usize>,
}

/// The box of a subject, or that of a person in the middle of the room where there is none.
fn standing(subject: &Aabb) -> Aabb {
    if subject.is_empty() {
        Aabb { min: Point3::new(-0.3, -0.3, 0.0), max: Point3::new(0.3, 0.3, 1.75) }
    } else {
        *subject
    }
}

/// A place on the floor beside the subject, towards +x, for something that reaches by `half` around it, in metres.
fn beside(subject: &Aabb, half: f64) -> Point3<f64> {
    let subject = standing(subject);
    Point3::new(subject.max.x + CLEARANCE + half, subject.centre().y, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ode_visual_hull::hull::{HullData, Motion};
    use std::sync::Arc;

    fn simulation() -> Simulation {
        Simulation::new(&Arc::new(HullData::new()), 0.001, Motion::Held).unwrap()
    }

    #[test]
    fn stacks_and_piles_of_any_number_of_boxes_stand_where_they_were_put() {
        for scenery in [Scenery::Stack, Scenery::Pile] {
            for count in [1, 4, 7] {
                let mut simulation = simulation();
                let bodies = Bodies { scenery, count, side: 0.2 };
                bodies.add_to(&mut simulation, &Aabb::EMPTY).unwrap();
                let before = simulation.states();
                simulation.advance(1.0).unwrap();
                assert_eq!(before.len(), count);
                for (before, after) in before.iter().zip(simulation.states()) {
                    let moved = (before.pose.translation.vector - after.pose.translation.vector).norm();
                    // The gaps below a box close, and soft contacts give way by no more than they.
                    assert!(moved < 2.0 * GAP * (count + 1) as f64, "{scenery:?} of {count}: {moved} m");
                }
            }
        }
    }

    #[test]
    fn all_boxes_are_in_their_extent_which_is_larger_by_one_box_at_most() {
        let subject = standing(&Aabb::EMPTY);
        for scenery in [Scenery::Stack, Scenery::Pile] {
            for count in [1, 4, 6] {
                let (mut simulation, bodies) = (simulation(), Bodies { scenery, count, side: 0.2 });
                bodies.add_to(&mut simulation, &subject).unwrap();
                let extent = bodies.extent(&subject);
                let mut found = Aabb::EMPTY;
                for state in simulation.states() {
                    let centre = Point3::from(state.pose.translation.vector);
                    found = found.union(&Aabb { min: centre, max: centre }.grown(0.1));
                }
                let room = [found.min - extent.min, extent.max - found.max];
                assert!(
                    room.iter().all(|room| room.min() > -1e-9 && room.max() < 0.21),
                    "{found:?}, {extent:?}"
                );
            }
        }
    }

    #[test]
    fn it_rains_with_no_more_boxes_than_asked_for() {
        let (mut simulation, mut fallen) = (simulation(), Rainfall::default());
        let bodies = Bodies { scenery: Scenery::Rain, count: 3, side: 0.1 };
        for k in 0..20 {
            let time = 0.1 * f64::from(k);
            bodies.rain(&mut simulation, &Aabb::EMPTY, &mut fallen, time).unwrap();
            simulation.advance(0.1).unwrap();
        }
        assert_eq!(simulation.bodies().len(), 3);
        // The last one that was lifted has fallen for less than a third of a second.
        let highest = simulation.states().iter().map(|one| one.pose.translation.z).fold(0.0, f64::max);
        assert!(highest > 1.75, "{highest} m");
    }
}
