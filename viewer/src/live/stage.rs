//! The scene to draw, made anew with each capture and each step.

use super::captures::Captures;
use super::simulate::WorldState;
use crate::scene::{RealCameras, Scene};
use ode_visual_hull::Result;
use ode_visual_hull::pipeline::Captured;
use std::sync::Arc;

/// The scene of the latest moment.
pub struct Stage {
    cameras: RealCameras,
    shown: Option<(Arc<Captured>, Scene)>,
}

impl Stage {
    /// A stage that shows nothing yet, seen by `cameras`.
    pub fn new(cameras: RealCameras) -> Self {
        Self { cameras, shown: None }
    }

    /// The real cameras.
    pub fn cameras(&self) -> &RealCameras {
        &self.cameras
    }

    /// Shows the capture that is nearest to the hull with which the bodies of `world` collided.
    ///
    /// # Errors
    /// Images of another size than the masks.
    pub fn show(&mut self, captures: &Captures, world: Option<&WorldState>) -> Result<()> {
        let time = world.map_or(f64::INFINITY, |world| world.hull_time);
        let captured = if time.is_finite() { captures.nearest(time) } else { captures.latest() };
        let Some(captured) = captured else { return Ok(()) };
        let is_other = self.shown.as_ref().is_none_or(|(shown, _)| !Arc::ptr_eq(shown, &captured));
        if is_other {
            let frames = captured.images.images.iter();
            let images = frames.map(|frame| frame.as_ref().map(|frame| frame.image.clone())).collect();
            let scene = self.cameras.any_scene(&captured.hull, images)?;
            self.shown = Some((captured, scene));
        }
        if let (Some((_, scene)), Some(world)) = (&mut self.shown, world) {
            scene.bodies.clone_from(&world.bodies);
        }
        Ok(())
    }

    /// The scene, and what it was captured from.
    pub fn shown(&self) -> Option<(&Captured, &Scene)> {
        self.shown.as_ref().map(|(captured, scene)| (&**captured, scene))
    }
}
