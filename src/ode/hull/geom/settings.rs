//! What a program sets of a hull geom.

use super::HullGeom;
use crate::contact::Settings;
use crate::hull::Motion;
use crate::ode::hull::swept::Swept;

impl HullGeom {
    /// Which hull the geom shows at the simulation's time.
    pub(in crate::ode::hull) fn motion(&self) -> Motion {
        self.lock().motion
    }

    /// Sets [`Self::motion`], from the next frame or time on.
    pub(in crate::ode::hull) fn set_motion(&self, motion: Motion) {
        let mut state = self.lock();
        (state.motion, state.warped_for) = (motion, None);
    }

    /// How contacts are made.
    pub(in crate::ode::hull) fn settings(&self) -> Settings {
        self.lock().settings
    }

    /// Changes how contacts are made.
    pub(in crate::ode::hull) fn change_settings(&self, change: impl FnOnce(&mut Settings)) {
        change(&mut self.lock().settings);
    }

    /// Whether the geom collides with what it will meet within the next step.
    pub(in crate::ode::hull) fn swept(&self) -> Swept {
        self.lock().swept
    }

    /// Sets [`Self::swept`].
    pub(in crate::ode::hull) fn set_swept(&self, swept: Swept) {
        self.lock().swept = swept;
    }

    /// The diameter in metres of the thinnest real feature that must not pass between a body's samples.
    pub(in crate::ode::hull) fn min_feature(&self) -> f64 {
        self.lock().min_feature
    }

    /// Sets [`Self::min_feature`].
    pub(in crate::ode::hull) fn set_min_feature(&self, diameter: f64) {
        self.lock().min_feature = diameter;
    }
}
