//! How fast everything is, in words.

use super::capture::CaptureState;
use super::drawing::DrawingShared;
use super::simulate::WorldShared;
use crate::scene::Scene;
use ode_visual_hull::rig::Rig;
use ode_visual_hull_check::silhouette_coherence;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Pictures over which the rate and the latency are taken.
const PICTURES: usize = 30;

/// Pictures from one look at the coherence of the silhouettes to the next.
const COHERENCE_PERIOD: u64 = 100;

/// Pixels between those whose rays are looked at.
const COHERENCE_STEP: usize = 24;

/// The state of a live capture in words.
pub struct Info {
    rig: Rig,
    capture: Arc<CaptureState>,
    world: Arc<WorldShared>,
    drawing: Arc<DrawingShared>,
    /// The picture at which coherence was looked at last, and what was found.
    coherence: Option<(u64, String)>,
}

impl Info {
    /// The state of a capture of `rig` by these threads.
    pub fn new(
        rig: &Rig,
        capture: &Arc<CaptureState>,
        world: &Arc<WorldShared>,
        drawing: &Arc<DrawingShared>,
    ) -> Self {
        Self {
            rig: rig.clone(),
            capture: capture.clone(),
            world: world.clone(),
            drawing: drawing.clone(),
            coherence: None,
        }
    }

    /// A line for each thread.
    pub fn lines(&mut self, scene: Option<&Scene>) -> Vec<String> {
        let interval = self.drawing.intervals.quantile(0.5, PICTURES);
        let rate = interval.map_or("-".into(), |seconds| format!("{:.1}", 1.0 / seconds));
        let milliseconds = |seconds: Option<f64>| seconds.map_or("-".into(), |s| format!("{:.0}", 1e3 * s));
        let latency = milliseconds(self.drawing.to_pixel.quantile(0.5, PICTURES));
        let steps = self.world.latest.get().1.map(|world| world.steps).unwrap_or_default();
        let tally = &self.capture.tally;
        let count = |of: &std::sync::atomic::AtomicU64| of.load(Ordering::Relaxed);
        let mut lines = vec![
            format!("{rate} pictures/s, {latency} ms after the images"),
            format!("steps: {} late, {} left out", steps.late, steps.dropped),
            format!("images: {} incomplete, {} left out", count(&tally.incomplete), count(&tally.dropped)),
        ];
        lines.extend(self.worst_camera(scene));
        lines
    }

    /// The camera whose silhouette the hull fills least.
    fn worst_camera(&mut self, scene: Option<&Scene>) -> Option<String> {
        let scene = scene.filter(|scene| !scene.hull.aabb().is_empty())?;
        let now = self.drawing.pictures.load(Ordering::Relaxed);
        if self.coherence.as_ref().is_none_or(|(then, _)| now >= then + COHERENCE_PERIOD) {
            let coherence = silhouette_coherence(&scene.hull, COHERENCE_STEP);
            let cameras = self.rig.cameras().iter().zip(&coherence);
            let shares = cameras.map(|(camera, view)| (camera.name(), view.filled_share()));
            let (name, share) = shares.min_by(|a, b| a.1.total_cmp(&b.1))?;
            self.coherence = Some((now, format!("worst camera: {name}, {:.0} % filled", 100.0 * share)));
        }
        self.coherence.as_ref().map(|(_, text)| text.clone())
    }
}
