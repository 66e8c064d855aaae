//! How far from a swept hull's surface the hull may meet something within the next step, by which its box grows.

use super::HullGeom;
use crate::Error;
use crate::hull::{Aabb, Hull, Motion};
use crate::ode::hull::swept::Swept;

impl HullGeom {
    /// Records once that views of a hull in motion stand still, which a sweep takes for the truth.
    fn tell_of_still_views(&self, hull: Option<&Hull>) {
        let (in_motion, known, data) = {
            let state = self.lock();
            (
                state.swept == Swept::On && state.motion != Motion::Held,
                state.has_still_views,
                state.data.clone(),
            )
        };
        // There is no motion before the second frame.
        let has_two_frames = data.latest().is_some_and(|(count, _)| count > 1);
        let mut still =
            hull.filter(|_| in_motion && has_two_frames).into_iter().flat_map(Hull::views_without_motion);
        let first = still.next().map(|view| view.name().to_string());
        self.lock().has_still_views = first.is_some();
        if let Some(first) = first.filter(|_| !known) {
            let count = 1 + still.count();
            self.record_left_out(Error::view(
                &first,
                format!(
                    "sweep: expected a motion, found none in {count} view(s), whose last two masks are more than 0.5 s \
                     apart or have equal times, or whose next one is late: they stand still in the sweep until masks \
                     follow one another again"
                ),
            ));
        }
    }

    /// Finds how far beyond its surface the hull may meet something within the next step, where bodies of its neighbours are
    /// no faster than `speed` m/s, and returns whether that has changed.
    pub(super) fn look_ahead(&self, speed: f64) -> bool {
        let seconds = self.step_size.seconds();
        let (hull, swept) = {
            let state = self.lock();
            (state.hull.clone(), state.swept)
        };
        self.tell_of_still_views(hull.as_deref());
        let reach = match (hull, seconds) {
            (Some(hull), Some(seconds)) if swept != Swept::Off => {
                let Aabb { min, max } = hull.bounds();
                let (reach, most) = (speed * seconds, (max - min).norm());
                if reach > most {
                    self.record_left_out(Error::argument(format!(
                        "sweep: expected bodies that move less than the work volume's diagonal in a step, {most:.3} m, \
                         found one that moves {reach:.3} m, so that it is looked for no farther than {most:.3} m from the \
                         hull; shorten the step"
                    )));
                }
                reach.min(most) + hull.farthest_motion(seconds)
            }
            _ => 0.0,
        };
        std::mem::replace(&mut self.lock().swept_reach, reach) != reach
    }
}
