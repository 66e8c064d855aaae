//! What a hull geom knows: its data object, the frame it collides with, its settings, and what it touched last.

use super::prefetch::Ahead;
use crate::Error;
use crate::contact::Settings;
use crate::contact::tuning::{MIN_FEATURE, WAKE_PX};
use crate::hull::{Aabb, Hull, HullData};
use crate::lock::lock;
use crate::ode::convert;
use nalgebra::{Isometry3, Point3, Vector3};
use ode_sys::{dGeomCopyPosition, dGeomGetQuaternion, dGeomID, dGeomMoved};
use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard};

/// Touches that were not renewed for this many collides are forgotten.
const FORGET_AFTER: u64 = 1000;

thread_local! {
    /// The last error of a collider on this thread, for callers who own ODE themselves and may have no geom to ask.
    static LAST_ERROR: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// What went wrong last in a collider on this thread, once.
pub(crate) fn take_last_error() -> Option<String> {
    LAST_ERROR.take()
}

/// The data behind a hull geom. ODE owns it, as the geom's class data.
#[derive(Debug)]
pub(super) struct HullGeom {
    state: Mutex<State>,
    /// What is known already of the step; taken out while somebody uses it.
    pub(super) ahead: Mutex<Option<Box<Ahead>>>,
}

#[derive(Debug)]
struct State {
    data: Arc<HullData>,
    hull: Option<Arc<Hull>>,
    /// How many frames were taken up.
    adopted: u64,
    settings: Settings,
    min_feature: f64,
    /// Where the hull was before the frame in force: bodies there must meet the collider once more, to learn that it
    /// left.
    previous_aabb: Aabb,
    /// Whether the collider ran since the frame in force was adopted.
    collided_since_update: bool,
    touches: HashMap<usize, Touch>,
    clock: u64,
    /// The first thing that went wrong in the collider since somebody last asked.
    error: Option<Error>,
}

/// How a body met the hull when it was last awake. A hint only: the address it is stored under may be another geom's
/// by now, and is never followed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    /// The deepest contact's depth; `None` without contact.
    depth: Option<f64>,
    /// The escape direction chosen, in the hull's frame.
    pub(super) escape: Option<Vector3<f64>>,
    clock: u64,
}

/// What a collider needs, taken out of the geom at once so that no lock is held over ODE's calls.
#[derive(Debug, Clone)]
pub(super) struct Collidable {
    pub(super) hull: Arc<Hull>,
    pub(super) settings: Settings,
    pub(super) min_feature: f64,
    /// How many frames were taken up: tells this one from others.
    pub(super) adopted: u64,
}

impl HullGeom {
    pub(super) fn new(data: Arc<HullData>) -> Self {
        let state = State {
            data,
            hull: None,
            adopted: 0,
            settings: Settings::default(),
            min_feature: MIN_FEATURE,
            previous_aabb: Aabb::EMPTY,
            collided_since_update: false,
            touches: HashMap::new(),
            clock: 0,
            error: None,
        };
        Self { state: Mutex::new(state), ahead: Mutex::new(Some(Box::default())) }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        lock(&self.state)
    }

    pub(super) fn data(&self) -> Arc<HullData> {
        self.lock().data.clone()
    }

    /// Binds the geom to other data, from the next adoption on.
    pub(super) fn set_data(&self, data: Arc<HullData>) {
        self.lock().data = data;
    }

    pub(super) fn settings(&self) -> Settings {
        self.lock().settings
    }

    pub(super) fn change_settings(&self, change: impl FnOnce(&mut Settings)) {
        change(&mut self.lock().settings);
    }

    pub(super) fn min_feature(&self) -> f64 {
        self.lock().min_feature
    }

    pub(super) fn set_min_feature(&self, diameter: f64) {
        self.lock().min_feature = diameter;
    }

    /// The frame that collides, `None` before the first.
    pub(super) fn hull(&self) -> Option<Arc<Hull>> {
        self.lock().hull.clone()
    }

    /// Notes what the collider cannot tell its caller.
    pub(super) fn record_error(&self, error: Error) {
        LAST_ERROR.set(Some(error.to_string()));
        self.lock().error.get_or_insert(error);
    }

    /// What the collider could not tell, once.
    pub(super) fn take_error(&self) -> Option<Error> {
        self.lock().error.take()
    }

    /// Takes the latest published frame into force; true where it is a new one.
    fn swap_frame(&self) -> bool {
        let mut state = self.lock();
        let hull = state.data.latest().map(|(_, hull)| hull);
        let changed = match (&state.hull, &hull) {
            (Some(old), Some(new)) => !Arc::ptr_eq(old, new),
            (None, None) => false,
            _ => true,
        };
        if changed {
            let left = state.aabb();
            state.previous_aabb =
                if state.collided_since_update { left } else { state.previous_aabb.union(&left) };
            (state.hull, state.collided_since_update) = (hull, false);
            state.adopted += 1;
        }
        changed
    }

    /// The box around the hull and where it was just before, in the world, as ODE wants it: finite, never NaN.
    ///
    /// # Safety
    /// `geom` is the living geom that owns this data.
    pub(super) unsafe fn world_aabb(&self, geom: dGeomID) -> [f64; 6] {
        // SAFETY: the caller vouches for the geom; the class is placeable.
        let world_from_hull = unsafe { pose(geom) };
        let state = self.lock();
        let both = state.aabb().union(&state.previous_aabb);
        // An empty hull is a point, so that it is nowhere near anything, yet not NaN or infinite.
        let both = if both.is_empty() { Aabb { min: Point3::origin(), max: Point3::origin() } } else { both };
        let aabb = both.transformed(&world_from_hull);
        [aabb.min.x, aabb.max.x, aabb.min.y, aabb.max.y, aabb.min.z, aabb.max.z]
    }

    /// What is needed to collide once; `None` before the first frame.
    pub(super) fn begin(&self) -> Option<Collidable> {
        let mut state = self.lock();
        state.collided_since_update = true;
        state.clock += 1;
        let hull = state.hull.clone()?;
        let State { settings, min_feature, adopted, .. } = *state;
        Some(Collidable { hull, settings, min_feature, adopted })
    }

    /// The escape direction chosen last for the geom at address `other`, in the hull's frame.
    pub(super) fn last_escape(&self, other: usize) -> Option<Vector3<f64>> {
        self.lock().touches.get(&other)?.escape
    }

    /// Notes how the geom at `other` met the hull. True where its body is asleep and should wake: the hull's surface
    /// at it is no longer where it was when it fell asleep.
    pub(super) fn finish(
        &self,
        other: usize,
        asleep: bool,
        depth: Option<f64>,
        escape: Option<Vector3<f64>>,
        pixel: f64,
    ) -> bool {
        let mut state = self.lock();
        let clock = state.clock;
        if clock.is_multiple_of(FORGET_AFTER) {
            state.touches.retain(|_, touch| touch.clock + FORGET_AFTER >= clock);
        }
        match state.touches.get_mut(&other) {
            Some(touch) if asleep => {
                touch.clock = clock;
                let moved = match (touch.depth, depth) {
                    (Some(before), Some(now)) => (now - before).abs() > WAKE_PX * pixel,
                    (None, None) => false,
                    _ => true,
                };
                if moved {
                    touch.depth = depth;
                }
                moved
            }
            _ => {
                state.touches.insert(other, Touch { depth, escape, clock });
                false
            }
        }
    }
}

impl State {
    fn aabb(&self) -> Aabb {
        self.hull.as_ref().map_or(Aabb::EMPTY, |hull| *hull.aabb())
    }
}

/// Takes the latest published frame into force for `geom`, and tells ODE that its box has changed.
///
/// # Safety
/// `geom` is the living geom that owns `hull`, and no space that it is in is being collided.
pub(super) unsafe fn apply_latest_frame(geom: dGeomID, hull: &HullGeom) {
    if hull.swap_frame() {
        // SAFETY: the caller vouches that the space is not locked, where ODE would abort.
        unsafe { dGeomMoved(geom) };
    }
}

/// The pose of a hull geom, world from hull.
///
/// # Safety
/// `geom` is a living, placeable geom.
pub(super) unsafe fn pose(geom: dGeomID) -> Isometry3<f64> {
    let (mut position, mut quaternion) = ([0.0; 4], [0.0; 4]);
    // SAFETY: the caller vouches for the geom; both arrays hold four numbers.
    unsafe {
        dGeomCopyPosition(geom, position.as_mut_ptr());
        dGeomGetQuaternion(geom, quaternion.as_mut_ptr());
    }
    convert::pose(&position, &quaternion)
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_data_of_a_hull_geom_may_be_used_and_freed_on_any_thread() {
        fn assert_send_and_sync<T: Send + Sync>() {}
        assert_send_and_sync::<super::HullGeom>();
    }
}
