//! The views, masks and frames of one subject, shared between the cameras' threads and simulations.

use super::mask_filter::MaskFilter;
use super::view_state::ViewState;
use crate::camera::Camera;
use crate::hull::{Aabb, Hull, Unseen, View};
use crate::lock::lock;
use crate::silhouette::{Border, IncomingMask, MaskView, PackedMask};
use crate::{Error, Result};
use std::sync::{Arc, Mutex, MutexGuard};

/// The views of a subject and their latest masks. All methods may be called from any thread; put it in an `Arc` to
/// share it.
///
/// [`set_mask`](Self::set_mask) prepares a mask on the thread that calls it. The mask takes effect with the next
/// [`update`](Self::update), which publishes the latest masks of all views as one frame. A view without a new mask
/// keeps its last one, which is not prepared again.
#[derive(Debug, Default)]
pub struct HullData {
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    views: Vec<ViewState>,
    bounds: Option<Aabb>,
    unseen: Unseen,
    overrule_depth: Option<f64>,
    filter: MaskFilter,
    /// In seconds; `None` for no limit.
    max_age: Option<f64>,
    latest: Option<Arc<Hull>>,
    /// Past frames, whose memory is reused for the next ones once they have no other owner.
    retired: Vec<Arc<Hull>>,
    published: u64,
    /// The time between the last two frames, in seconds; 0 before the second.
    period: f64,
    /// [`Self::published`] when a moving frame was asked for last.
    motion_asked: Option<u64>,
}

impl Default for State {
    fn default() -> Self {
        Self {
            views: Vec::new(),
            bounds: None,
            unseen: Unseen::Outside,
            overrule_depth: None,
            filter: MaskFilter::default(),
            max_age: None,
            latest: None,
            retired: Vec::new(),
            published: 0,
            period: 0.0,
            motion_asked: None,
        }
    }
}

impl HullData {
    /// No views, no work volume, the policy [`Unseen::Outside`].
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a view of `camera` and returns its index.
    ///
    /// # Errors
    /// A name that another view has; a lens whose undistorted image would have too many pixels.
    pub fn add_view(&self, camera: Camera) -> Result<usize> {
        self.add_views(&[camera])
    }

    /// Adds a view for each of `cameras`, all or none, and returns the index of the first.
    ///
    /// # Errors
    /// As [`add_view`](Self::add_view).
    pub fn add_views(&self, cameras: &[Camera]) -> Result<usize> {
        let added = cameras.iter().cloned().map(ViewState::new).collect::<Result<Vec<ViewState>>>()?;

        let mut state = self.lock();
        let first = state.views.len();
        for view in added {
            if state.views.iter().any(|other| other.name() == view.name()) {
                let problem = "expected a name of its own, found another view with the same name; rename one";
                let error = Error::view(view.name(), problem);
                state.views.truncate(first);
                return Err(error);
            }
            state.views.push(view);
        }

        Ok(first)
    }

    /// Number of views.
    pub fn view_count(&self) -> usize {
        self.lock().views.len()
    }

    /// The calibrated camera of a view, including its lens.
    ///
    /// # Errors
    /// A view index out of range.
    pub fn camera(&self, view: usize) -> Result<Arc<Camera>> {
        Ok(self.lock().view(view)?.camera().clone())
    }

    /// Sets the work volume, in world coordinates and metres: a point outside it is outside the hull.
    ///
    /// # Errors
    /// Inverted or non-finite bounds.
    pub fn set_bounds(&self, bounds: Aabb) -> Result<()> {
        self.lock().bounds = Some(Aabb::new(bounds.min, bounds.max)?);
        Ok(())
    }

    /// The work volume, if it was set.
    pub fn bounds(&self) -> Option<Aabb> {
        self.lock().bounds
    }

    /// Prepares `mask` (0 background .. 255 subject) as the next mask of a view.
    ///
    /// An empty mask is valid, since the subject may have left the image.
    ///
    /// # Errors
    /// A view index out of range; a mask whose size differs from the camera's image; a mask without background, which
    /// indicates that the segmentation failed. The view then keeps its last mask.
    pub fn set_mask<'a>(&self, view: usize, mask: impl Into<MaskView<'a>>) -> Result<()> {
        self.set(view, IncomingMask::Bytes(mask.into()), None)
    }

    /// Prepares `mask` as the next mask of a view, taken at `time` seconds. A mask without a time counts as taken at
    /// the time of the first frame that contains it.
    ///
    /// # Errors
    /// A time that is not finite or lies before that of the view's last mask; otherwise as
    /// [`set_mask`](Self::set_mask).
    pub fn set_mask_at<'a>(&self, view: usize, mask: impl Into<MaskView<'a>>, time: f64) -> Result<()> {
        self.set(view, IncomingMask::Bytes(mask.into()), Some(time))
    }

    /// Prepares a packed mask as the next mask of a view.
    ///
    /// # Errors
    /// As [`set_mask`](Self::set_mask).
    pub fn set_packed(&self, view: usize, mask: &PackedMask) -> Result<()> {
        self.set(view, IncomingMask::Packed(mask), None)
    }

    /// Prepares a packed mask as the next mask of a view, taken at `time` seconds.
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
            let (filter, is_motion_asked) = (state.filter, state.is_motion_asked());
            let view = state.view_mut(view)?;
            view.check_time(time)?;
            (view.take_buffers(time, filter, is_motion_asked), border)
        };

        // The mask is prepared outside the lock, so that cameras on several threads do not wait for one another.
        preparation.prepare(mask, border)?;
        preparation.find_motion();

        // The policy may have changed meanwhile.
        let mut state = self.lock();
        if border != border_of(state.unseen) {
            preparation.prepare(mask, border_of(state.unseen))?;
            preparation.forget_motion();
        }
        state.view_mut(view)?.commit(preparation, time)
    }

    /// Publishes the latest masks as the frame at `time` seconds, and returns it.
    ///
    /// # Errors
    /// No views; no work volume; an enabled view without a mask, or one that sees nothing of the work volume; a time
    /// that is not finite or lies before the last frame's. The last frame then stays the latest.
    pub fn update(&self, time: f64) -> Result<Arc<Hull>> {
        let mut state = self.lock();
        if let Some(last) = state.latest.as_ref().map(|frame| frame.time()).filter(|&last| time < last) {
            return Err(Error::argument(format!(
                "expected a frame time not before the last frame's, {last} s, found {time} s; pass the times of one \
                 clock"
            )));
        }

        let oldest = state.oldest_mask(time);
        let hull = state.frame(time, |_, view, bounds| view.next_view(bounds, time, oldest))?;
        state.views.iter_mut().for_each(|view| view.publish(time));

        let past = state.latest.replace(hull.clone());
        state.period = past.as_ref().map_or(0.0, |past| time - past.time());
        state.retired.extend(past);
        state.recycle();
        state.published += 1;
        Ok(hull)
    }

    /// The latest frame and its serial number, counted from 1; `None` before the first frame.
    pub fn latest(&self) -> Option<(u64, Arc<Hull>)> {
        let state = self.lock();
        Some((state.published, state.latest.clone()?))
    }

    /// The hull as the views saw it at `time` seconds, from the masks that are kept. Each view shows its latest mask
    /// that was not taken after `time`, or its earliest if all were. A view keeps the masks of its last tenth of a
    /// second, and one more.
    ///
    /// The first query of a past mask may have to compute its tables again, in about 0.03 ms for a VGA view.
    ///
    /// # Errors
    /// A time that is not finite; otherwise as [`update`](Self::update).
    pub fn at(&self, time: f64) -> Result<Arc<Hull>> {
        let mut state = self.lock();
        let oldest = state.oldest_mask(time);
        state.frame(time, |_, view, bounds| view.view_at(bounds, time, oldest))
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        lock(&self.state)
    }
}

impl State {
    /// Whether a moving frame was asked for since the last frame but one.
    fn is_motion_asked(&self) -> bool {
        self.motion_asked.is_some_and(|asked| asked + 2 >= self.published)
    }

    /// The time of the oldest mask that counts in a frame at `time`.
    fn oldest_mask(&self, time: f64) -> f64 {
        self.max_age.map_or(f64::NEG_INFINITY, |age| time - age)
    }

    fn view(&self, view: usize) -> Result<&ViewState> {
        let count = self.views.len();
        self.views.get(view).ok_or_else(|| no_such_view(view, count))
    }

    fn view_mut(&mut self, view: usize) -> Result<&mut ViewState> {
        let count = self.views.len();
        self.views.get_mut(view).ok_or_else(|| no_such_view(view, count))
    }

    /// A frame at `time`, whose views `view_at` returns for the work volume and that time.
    fn frame(
        &mut self,
        time: f64,
        mut view_at: impl FnMut(usize, &mut ViewState, &Aabb) -> Result<View>,
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
        check_time(time)?;

        // The frame and its list of views are built in the memory of a past frame, if there is one.
        let mut hull = self.take_recycled_frame();
        let mut views = Arc::get_mut(&mut hull).map(Hull::take_views).unwrap_or_default();
        for (k, view) in self.views.iter_mut().enumerate() {
            views.push(view_at(k, view, &bounds)?);
        }

        let frame = Hull::new(views, bounds, self.unseen, time).with_overrule_depth(self.overrule_depth);
        match Arc::get_mut(&mut hull) {
            Some(recycled) => *recycled = frame,
            None => hull = Arc::new(frame),
        }
        Ok(hull)
    }

    /// A past frame without views, whose memory can be reused, or a new one.
    fn take_recycled_frame(&mut self) -> Arc<Hull> {
        let recycled = self.retired.iter().position(|frame| frame.views().is_empty());
        let recycled = recycled.map(|k| self.retired.swap_remove(k));
        recycled.unwrap_or_else(|| Arc::new(Hull::new(Vec::new(), Aabb::EMPTY, self.unseen, 0.0)))
    }

    /// Recycles the memory of past frames without another owner, and of the masks that they alone held.
    fn recycle(&mut self) {
        for frame in self.retired.iter_mut().filter_map(Arc::get_mut) {
            for (silhouette, view) in frame.drain_silhouettes().zip(&mut self.views) {
                view.recycle(silhouette);
            }
        }
        self.views.iter_mut().for_each(ViewState::recycle_past_tables);
    }
}

fn check_time(time: f64) -> Result<()> {
    if !time.is_finite() {
        return Err(Error::argument(format!(
            "expected a finite frame time in seconds, found {time}; pass a clock's reading"
        )));
    }
    Ok(())
}

/// The border of silhouettes under a policy: where views abstain, the image's border is no silhouette edge.
fn border_of(unseen: Unseen) -> Border {
    match unseen {
        Unseen::Outside => Border::Background,
        Unseen::Abstain { .. } => Border::Unknown,
    }
}

fn no_such_view(view: usize, count: usize) -> Error {
    Error::argument(format!("expected a view index below {count}, found {view}; use what add_view returned"))
}

mod in_motion;
mod settings;

#[cfg(test)]
mod tests;
