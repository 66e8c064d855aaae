//! One view of a [`HullData`](crate::hull::HullData): its camera, its latest silhouettes, and recycled memory.

use super::mask_filter::MaskFilter;
use super::moving_mask::{LastWarped, MovingMask, distances_of, motion_between};
use super::preparation::{Preparation, ViewCalibration, unseen_value};
use crate::camera::Camera;
use crate::hull::{Aabb, View};
use crate::silhouette::{
    Border, EdgeDistances, MaskMotion, MaskRing, MaskScratch, SUBJECT, Silhouette, Tables, TimedMask,
};
use crate::{Error, Result};
use std::sync::Arc;

/// The largest number of silhouettes, and of sets of tables, whose memory a view keeps for its next masks.
const MAX_RECYCLED: usize = 3;

/// The longest time between two masks, in seconds, over which a motion is believed.
const MAX_PERIOD: f64 = 0.5;

/// How long a motion is believed before its first and after its last mask, in times between the two. Less would lose it
/// where frames come a little late; later the silhouette stands still, and so do the bodies that it carries.
const BELIEVED_BEYOND: f64 = 0.5;

/// A view's camera, its latest silhouettes, and recycled memory.
#[derive(Debug)]
pub(super) struct ViewState {
    calibration: Arc<ViewCalibration>,
    masks: MaskRing,
    pub(super) enabled: bool,
    /// The last work volume, and whether the camera sees some of it.
    sees_volume: Option<(Aabb, bool)>,
    /// Silhouettes without another owner and without tables, whose memory is reused for the bits of the next masks.
    recycled_silhouettes: Vec<Arc<Silhouette>>,
    /// Tables of past silhouettes, whose memory is reused for the next masks. They take nine tenths of the memory.
    recycled_tables: Vec<Tables>,
    scratch: MaskScratch,
    /// Motions of past masks, whose memory is reused once no frame holds them.
    retired_motions: Vec<Arc<MaskMotion>>,
    last_warped: Option<LastWarped>,
}
impl ViewState {
    /// # Errors
    /// A lens that cannot be undistorted within the largest image.
    pub(super) fn new(camera: Camera) -> Result<Self> {
        Ok(Self {
            calibration: Arc::new(ViewCalibration::new(camera)?),
            masks: MaskRing::default(),
            enabled: true,
            sees_volume: None,
            recycled_silhouettes: Vec::new(),
            recycled_tables: Vec::new(),
            scratch: MaskScratch::default(),
            retired_motions: Vec::new(),
            last_warped: None,
        })
    }

    pub(super) fn name(&self) -> &str {
        self.calibration.camera.name()
    }

    pub(super) fn camera(&self) -> &Arc<Camera> {
        &self.calibration.camera
    }

    /// Takes the buffers in which the next mask is prepared: recycled ones if there are any. `wants_motion` tells whether
    /// its motion will be computed.
    pub(super) fn take_buffers(
        &mut self,
        time: Option<f64>,
        filter: MaskFilter,
        wants_motion: bool,
    ) -> Preparation {
        let silhouette = self.take_silhouette();
        let spare = (wants_motion || filter.averages()).then(|| self.take_spare_motion());
        let predecessor = self.masks.predecessor();
        let gap = predecessor.and_then(|mask| mask.time).zip(time).map(|(before, time)| time - before);
        Preparation {
            calibration: self.calibration.clone(),
            silhouette,
            scratch: std::mem::take(&mut self.scratch),
            predecessor: predecessor.and_then(|mask| mask.distances.clone()),
            distances: None,
            motion: None,
            spare,
            filter,
            is_after_gap: gap.is_some_and(|gap| gap > MAX_PERIOD),
        }
    }

    /// Memory for a mask's distances and its motion.
    fn take_spare_motion(&mut self) -> (Arc<EdgeDistances>, Arc<MaskMotion>) {
        let unshared = self.retired_motions.iter_mut().position(|motion| Arc::get_mut(motion).is_some());
        let mut motion = unshared.map(|k| self.retired_motions.remove(k)).unwrap_or_default();
        let distances = Arc::get_mut(&mut motion).map(MaskMotion::take_earlier).unwrap_or_default();
        (distances, motion)
    }

    /// A silhouette whose memory can be reused, or a new one.
    fn take_silhouette(&mut self) -> Arc<Silhouette> {
        let blank = || Arc::new(Silhouette::blank(Border::Background));
        let mut silhouette = self.recycled_silhouettes.pop().unwrap_or_else(blank);
        if let Some(unshared) = Arc::get_mut(&mut silhouette)
            && let Some(tables) = self.recycled_tables.pop()
        {
            unshared.recycle_tables(tables);
        }
        silhouette
    }

    /// Refuses a time at which the next mask cannot have been taken.
    ///
    /// # Errors
    /// A time that is not finite or lies before the last mask's.
    pub(super) fn check_time(&self, time: Option<f64>) -> Result<()> {
        self.masks.check_time(time).map_err(|e| Error::view(self.name(), e))
    }

    /// Makes a prepared silhouette, taken at `time`, the view's latest one. The next frame shows it.
    ///
    /// # Errors
    /// As [`Self::check_time`].
    pub(super) fn commit(&mut self, preparation: Preparation, time: Option<f64>) -> Result<()> {
        let Preparation { silhouette, scratch, distances, motion, predecessor, .. } = preparation;
        self.scratch = scratch;

        // Another thread may have committed a later mask meanwhile.
        if let Err(e) = self.check_time(time) {
            self.recycle(silhouette);
            return Err(e);
        }

        // Another thread may have set a mask in between, from which the motion was not computed.
        let before = self.masks.predecessor().and_then(|mask| mask.distances.as_ref());
        let follows =
            before.zip(predecessor.as_ref()).is_some_and(|(before, from)| Arc::ptr_eq(before, from));
        let motion =
            motion.filter(|_| follows && self.masks.predecessor().is_some_and(|mask| mask.time != time));
        let mask = TimedMask { distances, motion, ..TimedMask::new(silhouette, time) };
        if let Some(replaced) = self.masks.push(mask) {
            self.retire(replaced);
        }
        self.recycle_old();
        Ok(())
    }

    /// Records that the latest mask is part of the frame at `time`.
    pub(super) fn publish(&mut self, time: f64) {
        self.masks.publish(time);
        self.recycle_old();
    }

    /// Recycles the masks that are too old to be kept.
    fn recycle_old(&mut self) {
        while let Some(old) = self.masks.pop_old() {
            self.retire(old);
        }
    }

    /// Recycles the memory of a mask that left the ring, and of its motion.
    fn retire(&mut self, mask: TimedMask) {
        self.recycle(mask.silhouette);
        if self.retired_motions.len() < MAX_RECYCLED {
            self.retired_motions.extend(mask.motion);
        }
    }

    /// Recycles the tables of past masks that no frame needs any more.
    pub(super) fn recycle_past_tables(&mut self) {
        // Only those of the last two masks: their memory is still in the processor's caches.
        for silhouette in self.masks.past().take(2).filter_map(Arc::get_mut) {
            keep_tables(&mut self.recycled_tables, silhouette.take_tables());
        }
    }

    /// Recycles the memory of a silhouette that is no longer needed here, unless it has another owner.
    pub(super) fn recycle(&mut self, mut silhouette: Arc<Silhouette>) {
        let Some(unshared) = Arc::get_mut(&mut silhouette) else { return };
        keep_tables(&mut self.recycled_tables, unshared.take_tables());
        if self.recycled_silhouettes.len() < MAX_RECYCLED {
            self.recycled_silhouettes.push(silhouette);
        }
    }

    /// Prepares all silhouettes again for another border, which changes what the unseen parts of their masks are.
    pub(super) fn change_border(&mut self, border: Border) {
        for silhouette in self.masks.all() {
            let mut mask = silhouette.to_mask();
            if let Some(lens) = &self.calibration.undistortion {
                let unseen = unseen_value(border);
                let pixels = mask.iter_mut().zip(lens.field_of_view().iter());
                pixels.filter(|(_, visible)| **visible < SUBJECT).for_each(|(pixel, _)| *pixel = unseen);
            }
            *silhouette = Arc::new(Silhouette::new(&mask, border));
        }
        self.masks.forget_motion();
    }

    /// What the view shows at `time`, in seconds, by the two masks around it.
    ///
    /// `is_ahead` tells that the time may lie after the last mask's, by at most the time between the last two. A view
    /// whose mask at that time is older than `oldest` shows nothing.
    pub(super) fn moving_mask(&mut self, time: f64, is_ahead: bool, oldest: f64) -> Option<MovingMask> {
        let later_index = self.masks.moving_at(if is_ahead { f64::INFINITY } else { time })?;
        let [earlier, later] = self.masks.pair(later_index)?;
        let (from, to) = (earlier.time?, later.time?);
        let period = to - from;
        if !(period > 0.0 && period <= MAX_PERIOD) || to < oldest {
            return None;
        }

        let (asked, most) = ((time - from) / period, if is_ahead { 2.0 } else { 1.0 });
        let s = asked.clamp(0.0, most);
        let is_moving = (-BELIEVED_BEYOND..=most + BELIEVED_BEYOND).contains(&asked);
        let border = later.silhouette.border();
        let distances = |mask: &mut TimedMask| {
            mask.distances.get_or_insert_with(|| distances_of(&mask.silhouette, Arc::default())).clone()
        };
        if later.motion.is_none() {
            let (first, second) = (distances(earlier), distances(later));
            later.motion = Some(motion_between(first, second, Arc::default()));
        }
        let motion = later.motion.clone()?;
        let warped = self.last_warped.as_ref().and_then(|last| last.at(&motion, s));
        Some(MovingMask {
            calibration: self.calibration.clone(),
            is_warped: warped.is_some(),
            silhouette: warped.unwrap_or_else(|| self.take_silhouette()),
            motion,
            chain: if is_moving { self.masks.chain(later_index) } else { None },
            s,
            time: from + s * period,
            border,
        })
    }

    /// The view with a silhouette that was warped.
    ///
    /// # Errors
    /// As [`Self::next_view`].
    pub(super) fn moved_view(
        &mut self,
        mask: Option<MovingMask>,
        bounds: &Aabb,
        time: f64,
        oldest: f64,
    ) -> Result<View> {
        // One that was found again keeps its own time: many small steps would add up.
        let is_found =
            |mask: &&MovingMask| self.last_warped.as_ref().is_some_and(|last| last.is_shown_by(mask));
        let warped = mask.as_ref().filter(|mask| !is_found(mask)).map(MovingMask::to_last_warped);
        if let Some(replaced) = warped.and_then(|warped| self.last_warped.replace(warped)) {
            self.recycle(replaced.into_silhouette());
        }
        match mask {
            Some(MovingMask { silhouette, chain, s, time, .. }) => Ok(self
                .view(Some((silhouette, time)), bounds, oldest)?
                .with_motion(chain.map(|chain| (chain, 1.0 - s)))),
            None => self.view_at(bounds, time, oldest),
        }
    }

    /// The view with its latest mask, for the frame at `time`. It abstains if the mask is older than `oldest`.
    ///
    /// # Errors
    /// No mask, unless the view is disabled; a camera that sees nothing of `bounds`, unless the view abstains.
    pub(super) fn next_view(&mut self, bounds: &Aabb, time: f64, oldest: f64) -> Result<View> {
        let latest = self.masks.latest().map(|mask| mask.silhouette.clone());
        self.view(latest.zip(self.masks.time_in_frame(time)), bounds, oldest)
    }

    /// The view with the mask that it showed at `time`. It abstains if the mask is older than `oldest`.
    ///
    /// # Errors
    /// As [`Self::next_view`].
    pub(super) fn view_at(&mut self, bounds: &Aabb, time: f64, oldest: f64) -> Result<View> {
        let mask = self.masks.at(time).map(|mask| (mask.silhouette.clone(), mask.time.unwrap_or(time)));
        self.view(mask, bounds, oldest)
    }

    /// The view with a silhouette that was taken at a time. It abstains if that lies before `oldest`.
    fn view(&mut self, mask: Option<(Arc<Silhouette>, f64)>, bounds: &Aabb, oldest: f64) -> Result<View> {
        let (silhouette, time) = match mask {
            Some((silhouette, time)) => (silhouette, Some(time)),
            // A disabled view takes no part in queries.
            None if !self.enabled => (Arc::new(Silhouette::blank(Border::Unknown)), None),
            None => {
                let problem =
                    "expected a mask before the first update, found none; set one, or disable the view";
                return Err(Error::view(self.name(), problem));
            }
        };

        let ViewCalibration { pinhole, field_of_view, .. } = &*self.calibration;
        let view = View::new(pinhole.clone(), silhouette, field_of_view.clone());
        let is_enabled = self.enabled && time.is_none_or(|time| time >= oldest);
        let view = view.with_enabled(is_enabled).with_time(time);

        if is_enabled && !self.sees_some_of(&view, bounds) {
            let (centre, forward) = (self.camera().centre(), self.camera().forward());
            return Err(Error::view(
                self.name(),
                format!(
                    "expected a camera that sees the work volume, found one at ({:.3}, {:.3}, {:.3}) m that looks \
                     along ({:.3}, {:.3}, {:.3}), away from it; check that the pose maps world to camera with z \
                     forward, y down, or disable the view",
                    centre.x, centre.y, centre.z, forward.x, forward.y, forward.z
                ),
            ));
        }
        Ok(view)
    }

    /// Whether the camera sees some of the work volume, computed once for each.
    fn sees_some_of(&mut self, view: &View, bounds: &Aabb) -> bool {
        let (_, sees) = match self.sees_volume {
            Some(known) if known.0 == *bounds => known,
            _ => *self.sees_volume.insert((*bounds, view.sees_some_of(bounds))),
        };
        sees
    }
}
/// Adds tables to the recycled ones, unless there are enough.
fn keep_tables(recycled: &mut Vec<Tables>, tables: Option<Tables>) {
    if recycled.len() < MAX_RECYCLED {
        recycled.extend(tables);
    }
}
