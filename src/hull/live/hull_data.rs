//! The views, masks and frames of one subject: what cameras write and simulations read.

use super::view_state::ViewState;
use crate::camera::Camera;
use crate::hull::{Aabb, Hull, Unseen, View};
use crate::lock::lock;
use crate::silhouette::{Border, IncomingMask, MaskView, PackedMask};
use crate::{Error, Result};
use std::sync::{Arc, Mutex, MutexGuard};

/// The views of a subject and their latest masks. Shared by cloning an `Arc`; all methods may be called from any
/// thread.
///
/// A mask is prepared by [`set_mask`](Self::set_mask), on the thread that calls it, and takes effect with the next
/// [`update`](Self::update), which publishes all masks as one frame. A view that got no new mask keeps its last one.
/// Nothing else is rebuilt.
#[derive(Debug, Default)]
pub struct HullData {
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    views: Vec<ViewState>,
    bounds: Option<Aabb>,
    unseen: Unseen,
    latest: Option<Arc<Hull>>,
    /// Past frames: their memory is for the next ones, once they have no other owner.
    retired: Vec<Arc<Hull>>,
    published: u64,
}

impl Default for State {
    fn default() -> Self {
        Self {
            views: Vec::new(),
            bounds: None,
            unseen: Unseen::Outside,
            latest: None,
            retired: Vec::new(),
            published: 0,
        }
    }
}

impl HullData {
    /// No views, no work volume, the policy [`Unseen::Outside`].
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a view and returns its index.
    ///
    /// # Errors
    /// A name that another view has; a lens whose undistorted image would have too many pixels.
    pub fn add_view(&self, camera: Camera) -> Result<usize> {
        self.add_views(&[camera])
    }

    /// Adds views, all or none, and returns the index of the first.
    ///
    /// # Errors
    /// As [`add_view`](Self::add_view).
    pub fn add_views(&self, cameras: &[Camera]) -> Result<usize> {
        let slots = cameras.iter().cloned().map(ViewState::new).collect::<Result<Vec<ViewState>>>()?;
        let mut state = self.lock();
        let first = state.views.len();
        for slot in slots {
            if state.views.iter().any(|other| other.name() == slot.name()) {
                let problem = "expected a name of its own, found another view with the same name; rename one";
                let taken = Error::view(slot.name(), problem);
                state.views.truncate(first);
                return Err(taken);
            }
            state.views.push(slot);
        }
        Ok(first)
    }

    /// Number of views.
    pub fn view_count(&self) -> usize {
        self.lock().views.len()
    }

    /// The calibrated camera of a view, lens included.
    ///
    /// # Errors
    /// An index out of range.
    pub fn camera(&self, view: usize) -> Result<Arc<Camera>> {
        Ok(self.lock().view(view)?.camera().clone())
    }

    /// Sets the work volume: points outside are outside the hull.
    ///
    /// # Errors
    /// Inverted or non-finite bounds.
    pub fn set_bounds(&self, bounds: Aabb) -> Result<()> {
        self.lock().bounds = Some(Aabb::new(bounds.min, bounds.max)?);
        Ok(())
    }

    /// Sets the policy for views that do not see a point. It holds from the next [`update`](Self::update) on.
    ///
    /// # Errors
    /// `min_views` of zero.
    pub fn set_unseen(&self, unseen: Unseen) -> Result<()> {
        if unseen == (Unseen::Abstain { min_views: 0 }) {
            return Err(Error::argument(
                "min_views: expected at least 1, found 0; one view alone bounds no depth",
            ));
        }
        let mut state = self.lock();
        if border_of(state.unseen) != border_of(unseen) {
            state.views.iter_mut().for_each(|slot| slot.change_border(border_of(unseen)));
        }
        state.unseen = unseen;
        Ok(())
    }

    /// Takes a view out, so that it abstains whatever the policy, or puts it back; from the next update on.
    ///
    /// # Errors
    /// An index out of range.
    pub fn set_view_enabled(&self, view: usize, enabled: bool) -> Result<()> {
        self.lock().view_mut(view)?.enabled = enabled;
        Ok(())
    }

    /// Gives a view its next mask, 0 background .. 255 subject, and prepares it.
    ///
    /// # Errors
    /// An index out of range; a mask of another size than the camera's image; a full mask, which says that the
    /// segmentation failed. The last good mask then stays. An empty mask is no error: the subject may have left.
    pub fn set_mask<'a>(&self, view: usize, mask: impl Into<MaskView<'a>>) -> Result<()> {
        self.set(view, IncomingMask::Bytes(mask.into()), None)
    }

    /// Gives a view its next mask, which was taken at `time` seconds. One without a time of its own counts as taken at
    /// the time of the first frame that it is in.
    ///
    /// # Errors
    /// A time that is not finite or lies before that of the view's last mask; otherwise as
    /// [`set_mask`](Self::set_mask).
    pub fn set_mask_at<'a>(&self, view: usize, mask: impl Into<MaskView<'a>>, time: f64) -> Result<()> {
        self.set(view, IncomingMask::Bytes(mask.into()), Some(time))
    }

    /// Gives a view its next mask, packed, and prepares it.
    ///
    /// # Errors
    /// As [`set_mask`](Self::set_mask).
    pub fn set_packed(&self, view: usize, mask: &PackedMask) -> Result<()> {
        self.set(view, IncomingMask::Packed(mask), None)
    }

    /// Gives a view its next mask, packed, which was taken at `time` seconds.
    ///
    /// # Errors
    /// As [`set_mask_at`](Self::set_mask_at).
    pub fn set_packed_at(&self, view: usize, mask: &PackedMask, time: f64) -> Result<()> {
        self.set(view, IncomingMask::Packed(mask), Some(time))
    }

    fn set(&self, view: usize, mask: IncomingMask, time: Option<f64>) -> Result<()> {
        let (mut preparation, border) = {
            let mut state = self.lock();
            let border = border_of(state.unseen);
            let slot = state.view_mut(view)?;
            slot.check_time(time)?;
            (slot.take_buffers(), border)
        };
        // Prepared outside the lock, so that cameras on several threads do not wait for one another.
        preparation.prepare(mask, border)?;
        let mut state = self.lock();
        if border != border_of(state.unseen) {
            preparation.prepare(mask, border_of(state.unseen))?;
        }
        state.view_mut(view)?.commit(preparation, time)
    }

    /// Publishes the masks as the frame of `time` seconds, and returns it.
    ///
    /// # Errors
    /// No views; no work volume; a view that never got a mask, or that sees nothing of the work volume; a time that
    /// is not finite or lies before the last frame's. The last frame then stays in force.
    pub fn update(&self, time: f64) -> Result<Arc<Hull>> {
        let mut state = self.lock();
        if let Some(last) = state.latest.as_ref().map(|frame| frame.time()).filter(|&last| time < last) {
            return Err(Error::argument(format!(
                "expected a frame time not before the last frame's, {last} s, found {time} s; pass the times of one \
                 clock"
            )));
        }
        let hull = state.frame(time, ViewState::next_view)?;
        state.views.iter_mut().for_each(|slot| slot.publish(time));
        let past = state.latest.replace(hull.clone());
        state.retired.extend(past);
        state.recycle();
        state.published += 1;
        Ok(hull)
    }

    /// The latest frame and its serial number; `None` before the first.
    pub fn latest(&self) -> Option<(u64, Arc<Hull>)> {
        let state = self.lock();
        Some((state.published, state.latest.clone()?))
    }

    /// What the views saw at `time` seconds: of each view the latest mask that was not taken after it, as far as masks are
    /// kept, which are those of the view's last tenth of a second and one more; else the earliest that is kept.
    ///
    /// The first query of a past mask may derive its tables again, about 0.03 ms a VGA view.
    ///
    /// # Errors
    /// A time that is not finite; otherwise as [`update`](Self::update).
    pub fn at(&self, time: f64) -> Result<Arc<Hull>> {
        self.lock().frame(time, ViewState::view_at)
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        lock(&self.state)
    }
}

impl State {
    fn view(&self, view: usize) -> Result<&ViewState> {
        let count = self.views.len();
        self.views.get(view).ok_or_else(|| no_such_view(view, count))
    }

    fn view_mut(&mut self, view: usize) -> Result<&mut ViewState> {
        let count = self.views.len();
        self.views.get_mut(view).ok_or_else(|| no_such_view(view, count))
    }

    /// A frame of the views that `view` makes for the bounds and `time`.
    fn frame(
        &mut self,
        time: f64,
        view: fn(&mut ViewState, &Aabb, f64) -> Result<View>,
    ) -> Result<Arc<Hull>> {
        if self.views.is_empty() {
            return Err(Error::argument(
                "expected at least one view, found none; add views before the update",
            ));
        }
        let Some(bounds) = self.bounds else {
            return Err(Error::argument(
                "expected a work volume, found none; set the bounds before the update",
            ));
        };
        if !time.is_finite() {
            return Err(Error::argument(format!(
                "expected a finite frame time in seconds, found {time}; pass a clock's reading"
            )));
        }
        let mut hull = self.take_recycled_frame();
        let mut views = Arc::get_mut(&mut hull).map(Hull::take_views).unwrap_or_default();
        for slot in &mut self.views {
            views.push(view(slot, &bounds, time)?);
        }
        let frame = Hull::new(views, bounds, self.unseen, time);
        match Arc::get_mut(&mut hull) {
            Some(place) => *place = frame,
            None => hull = Arc::new(frame),
        }
        Ok(hull)
    }

    /// A recycled frame, or a new one.
    fn take_recycled_frame(&mut self) -> Arc<Hull> {
        let recycled = self.retired.iter().position(|frame| frame.views().is_empty());
        let recycled = recycled.map(|k| self.retired.swap_remove(k));
        recycled.unwrap_or_else(|| Arc::new(Hull::new(Vec::new(), Aabb::EMPTY, self.unseen, 0.0)))
    }

    /// Recycles the memory of past frames with no other owner, and of the masks that they alone held.
    fn recycle(&mut self) {
        for frame in self.retired.iter_mut().filter_map(Arc::get_mut) {
            for (silhouette, slot) in frame.drain_silhouettes().zip(&mut self.views) {
                slot.recycle(silhouette);
            }
        }
        self.views.iter_mut().for_each(ViewState::recycle_past_tables);
    }
}

/// Where views abstain the image's border is no silhouette edge.
fn border_of(unseen: Unseen) -> Border {
    match unseen {
        Unseen::Outside => Border::Background,
        Unseen::Abstain { .. } => Border::Unknown,
    }
}

fn no_such_view(view: usize, count: usize) -> Error {
    Error::argument(format!("expected a view index below {count}, found {view}; use what add_view returned"))
}

#[cfg(test)]
mod tests;
