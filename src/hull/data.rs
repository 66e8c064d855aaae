//! The views, masks and frames of one subject: what cameras write and simulations read.

use super::{Aabb, Hull, Unseen, View};
use crate::camera::Camera;
use crate::silhouette::{Border, SUBJECT, Silhouette, Undistortion};
use crate::{Error, Result};
use image::GrayImage;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// How far back in time past frames are kept, in seconds; one older than that is kept too.
const HISTORY: f64 = 0.1;

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
    views: Vec<Slot>,
    bounds: Option<Aabb>,
    unseen: Unseen,
    /// Published frames, the latest last.
    frames: VecDeque<Arc<Hull>>,
    published: u64,
}

/// One view's camera and latest mask.
#[derive(Debug, Clone)]
struct Slot {
    camera: Arc<Camera>,
    pinhole: Arc<Camera>,
    lens: Option<Arc<Undistortion>>,
    seen: Option<Arc<Silhouette>>,
    mask: Option<Arc<GrayImage>>,
    silhouette: Option<Arc<Silhouette>>,
    enabled: bool,
}

impl Default for State {
    fn default() -> Self {
        Self {
            views: Vec::new(),
            bounds: None,
            unseen: Unseen::Outside,
            frames: VecDeque::new(),
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
        let slot = Slot::new(camera)?;
        let mut state = self.lock();
        if state.views.iter().any(|other| other.name() == slot.name()) {
            return Err(Error::view(
                slot.name(),
                "expected a name of its own, found another view with the same name; rename one",
            ));
        }
        state.views.push(slot);
        Ok(state.views.len() - 1)
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
        Ok(self.lock().slot(view)?.camera.clone())
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
            state.views.iter_mut().try_for_each(|slot| slot.prepare(border_of(unseen)))?;
        }
        state.unseen = unseen;
        Ok(())
    }

    /// Takes a view out, so that it abstains whatever the policy, or puts it back; from the next update on.
    ///
    /// # Errors
    /// An index out of range.
    pub fn set_view_enabled(&self, view: usize, enabled: bool) -> Result<()> {
        self.lock().slot_mut(view)?.enabled = enabled;
        Ok(())
    }

    /// Gives a view its next mask, 0 background .. 255 subject, and prepares it.
    ///
    /// # Errors
    /// An index out of range; a mask of another size than the camera's image; a full mask, which says that the
    /// segmentation failed. The last good mask then stays. An empty mask is no error: the subject may have left.
    pub fn set_mask(&self, view: usize, mask: &GrayImage) -> Result<()> {
        let (mut slot, border) = {
            let state = self.lock();
            (state.slot(view)?.clone(), border_of(state.unseen))
        };
        slot.check(mask)?;
        // Prepared outside the lock, so that cameras on several threads do not wait for one another.
        slot.mask = Some(Arc::new(mask.clone()));
        slot.prepare(border)?;
        let mut state = self.lock();
        if border != border_of(state.unseen) {
            slot.prepare(border_of(state.unseen))?;
        }
        let place = state.slot_mut(view)?;
        (place.mask, place.silhouette) = (slot.mask, slot.silhouette);
        Ok(())
    }

    /// Publishes the masks as the frame of `time` seconds, and returns it.
    ///
    /// # Errors
    /// No views; no work volume; a view that never got a mask, or that sees nothing of the work volume; a time that
    /// is not finite or lies before the last frame's. The last frame then stays in force.
    pub fn update(&self, time: f64) -> Result<Arc<Hull>> {
        let mut state = self.lock();
        let hull = Arc::new(state.frame(time)?);
        state.frames.push_back(hull.clone());
        while state.frames.len() > 2 && state.frames[1].time() < time - HISTORY {
            state.frames.pop_front();
        }
        state.published += 1;
        Ok(hull)
    }

    /// The latest frame and its serial number; `None` before the first.
    pub fn latest(&self) -> Option<(u64, Arc<Hull>)> {
        let state = self.lock();
        Some((state.published, state.frames.back()?.clone()))
    }

    /// The frames of the last tenth of a second and one before, the latest last.
    pub fn history(&self) -> Vec<Arc<Hull>> {
        self.lock().frames.iter().cloned().collect()
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // A panic under the lock cannot leave the state half changed: every change is one assignment.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn slot(&self, view: usize) -> Result<&Slot> {
        let count = self.views.len();
        self.views.get(view).ok_or_else(|| no_such_view(view, count))
    }

    fn slot_mut(&mut self, view: usize) -> Result<&mut Slot> {
        let count = self.views.len();
        self.views.get_mut(view).ok_or_else(|| no_such_view(view, count))
    }

    fn frame(&self, time: f64) -> Result<Hull> {
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
        if let Some(last) = self.frames.back().map(|frame| frame.time()).filter(|&last| time < last) {
            return Err(Error::argument(format!(
                "expected a frame time not before the last frame's, {last} s, found {time} s; pass the times of one \
                 clock"
            )));
        }
        let views = self.views.iter().map(|slot| slot.view(&bounds)).collect::<Result<Vec<View>>>()?;
        Ok(Hull::new(views, bounds, self.unseen, time))
    }
}

impl Slot {
    fn new(camera: Camera) -> Result<Self> {
        let lens = Undistortion::new(&camera).map(Arc::new);
        if lens.is_none() && !camera.distortion().is_none() {
            let (width, height) = camera.size();
            let problem = format!(
                "expected a lens that can be undistorted within the largest image, found {width} x {height} pixels \
                 with distortion {:?}; scale the images down or undistort them first",
                camera.distortion().coefficients()
            );
            return Err(Error::view(camera.name(), problem));
        }
        let seen = lens.as_ref().map(|lens| Arc::new(Silhouette::new(lens.seen(), Border::Background)));
        let camera = Arc::new(camera);
        let pinhole = lens.as_ref().map_or_else(|| camera.clone(), |lens| Arc::new(lens.pinhole().clone()));
        Ok(Self { camera, pinhole, lens, seen, mask: None, silhouette: None, enabled: true })
    }

    fn name(&self) -> &str {
        self.camera.name()
    }

    fn check(&self, mask: &GrayImage) -> Result<()> {
        let (width, height) = self.camera.size();
        if mask.dimensions() != (width, height) {
            let found = format!("found {} x {}", mask.width(), mask.height());
            let problem = format!(
                "mask: expected {width} x {height} pixels as in the calibration, {found}; scale the mask or calibrate \
                 at its size"
            );
            return Err(Error::view(self.name(), problem));
        }
        if mask.as_raw().iter().all(|&byte| byte >= SUBJECT) {
            let problem = "mask: expected some background, found every pixel subject; \
                           it is inverted or the segmentation failed; the last good mask stays";
            return Err(Error::view(self.name(), problem));
        }
        Ok(())
    }

    /// Prepares the latest mask; what the view does not see is subject where it abstains, so that it has no edge.
    fn prepare(&mut self, border: Border) -> Result<()> {
        let Some(mask) = &self.mask else { return Ok(()) };
        let unseen = if border == Border::Open { 255 } else { 0 };
        let silhouette = match &self.lens {
            Some(lens) => Silhouette::new(&lens.apply(mask, unseen)?, border),
            None => Silhouette::new(mask, border),
        };
        self.silhouette = Some(Arc::new(silhouette));
        Ok(())
    }

    fn view(&self, bounds: &Aabb) -> Result<View> {
        let silhouette = match &self.silhouette {
            Some(silhouette) => silhouette.clone(),
            // Nobody asks a disabled view.
            None if !self.enabled => Arc::new(Silhouette::blank(Border::Open)),
            None => {
                let problem =
                    "expected a mask before the first update, found none; set one, or disable the view";
                return Err(Error::view(self.name(), problem));
            }
        };
        let view = View::new(self.pinhole.clone(), silhouette, self.seen.clone()).with_enabled(self.enabled);
        if self.enabled && !view.sees_some_of(bounds) {
            let centre = self.camera.centre();
            let forward = self.camera.forward();
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
}

/// Where views abstain the image's border is no silhouette edge.
fn border_of(unseen: Unseen) -> Border {
    match unseen {
        Unseen::Outside => Border::Background,
        Unseen::Abstain { .. } => Border::Open,
    }
}

fn no_such_view(view: usize, count: usize) -> Error {
    Error::argument(format!("expected a view index below {count}, found {view}; use what add_view returned"))
}
