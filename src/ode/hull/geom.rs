//! The data behind a hull geom: the data object that it is bound to, the frame in force, and its settings.

use super::hold::Hold;
use super::last_contacts::LastContacts;
use super::last_swept::LastSwept;
use super::lost_views::LostViews;
use super::neighbours;
use super::prefetch::ContactPrefetch;
use super::query::CollideContext;
use super::step_size::StepSize;
use super::swept::Swept;
use crate::contact::Settings;
use crate::contact::tuning::MIN_FEATURE;
use crate::hull::{Aabb, Hull, HullData, Motion};
use crate::lock::lock;
use crate::ode::per_thread::per_thread;
use crate::ode::{convert, hash_space};
use crate::{Error, Result};
use nalgebra::{Isometry3, Point3, Rotation3, UnitQuaternion};
use ode_sys::{dGeomCopyPosition, dGeomCopyRotation, dGeomGetSpace, dGeomID, dGeomMoved};
use std::sync::{Arc, Mutex, MutexGuard};

per_thread! {
    /// The last error of a collider on this thread, for programs that own ODE themselves and may have no geom to query.
    static LAST_ERROR: String
}

/// Takes the message of the last error of a collider on this thread.
pub(crate) fn take_last_error() -> Option<String> {
    LAST_ERROR.take()
}

/// The data behind a hull geom. ODE owns it, as the geom's class data.
#[derive(Debug)]
pub(super) struct HullGeom {
    state: Mutex<State>,
    pub(super) last_contacts: LastContacts,
    pub(super) step_size: StepSize,
    pub(super) last_swept: LastSwept,
    pub(super) hold: Hold,
    /// Contacts of this step that are computed already; `None` while a thread uses them.
    pub(super) prefetch: Mutex<Option<Box<ContactPrefetch>>>,
    velocities: Mutex<Velocities>,
    events: Mutex<EventRecorder>,
}

#[derive(Debug)]
struct State {
    data: Arc<HullData>,
    /// The frame in force, `None` before the first.
    hull: Option<Arc<Hull>>,
    /// How many frames have come into force.
    frame_count: u64,
    /// The pose of the geom when it was last collided.
    collided_at: Option<Isometry3<f64>>,
    motion: Motion,
    /// The simulation's time in seconds, where it was told.
    time: Option<f64>,
    /// What the hull in force was warped for: the latest frame's number, and the time.
    warped_for: Option<(u64, f64)>,
    lost_views: LostViews,
    settings: Settings,
    swept: Swept,
    /// How far beyond the hull's surface the hull may meet something within the next step, in metres.
    swept_reach: f64,
    /// Whether views of the hull in motion stood still when its time was set last.
    has_still_views: bool,
    /// In metres.
    min_feature: f64,
    /// Whether contacts are recorded as events.
    has_events: bool,
    /// The first error of the collider since it was taken last.
    error: Option<Error>,
    /// The first thing that was left out of a sweep, or body that does not stick, since it was taken last.
    left_out: Option<Error>,
}

impl HullGeom {
    /// A geom bound to `data`, without a frame.
    pub(super) fn new(data: Arc<HullData>) -> Self {
        let state = State {
            data,
            hull: None,
            frame_count: 0,
            collided_at: None,
            motion: Motion::Held,
            time: None,
            warped_for: None,
            lost_views: LostViews::default(),
            settings: Settings::default(),
            swept: Swept::Off,
            swept_reach: 0.0,
            has_still_views: false,
            min_feature: MIN_FEATURE,
            has_events: false,
            error: None,
            left_out: None,
        };
        Self {
            state: Mutex::new(state),
            last_contacts: LastContacts::default(),
            step_size: StepSize::default(),
            last_swept: LastSwept::default(),
            hold: Hold::default(),
            prefetch: Mutex::new(Some(Box::default())),
            velocities: Mutex::default(),
            events: Mutex::default(),
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        lock(&self.state)
    }

    /// The data object that the geom is bound to.
    pub(super) fn data(&self) -> Arc<HullData> {
        self.lock().data.clone()
    }

    /// Binds the geom to another data object, from the next frame on. Bodies that stick to it are released.
    pub(super) fn set_data(&self, data: Arc<HullData>) {
        self.hold.set(false);
        {
            let mut state = self.lock();
            (state.data, state.time, state.warped_for) = (data, None, None);
            state.lost_views.begin_anew();
        }
        self.end_touches();
    }

    /// Sets the simulation's time in seconds.
    ///
    /// # Errors
    /// A time that is not finite or lies before the last one.
    pub(super) fn set_time(&self, time: f64) -> Result<()> {
        let mut state = self.lock();
        if !time.is_finite() {
            return Err(Error::argument(format!(
                "time of the hull: expected finite seconds, found {time}; pass the simulation's clock"
            )));
        }
        if let Some(last) = state.time.filter(|&last| time < last) {
            return Err(Error::argument(format!(
                "time of the hull: expected one not before the last, {last} s, found {time} s; pass the times of one \
                 clock, and bind the geom to new data where a simulation begins again"
            )));
        }
        if let Some(last) = state.time.replace(time) {
            self.step_size.tell(time - last);
        }
        drop(state);
        self.set_event_time(time);
        Ok(())
    }

    /// The frame in force, `None` before the first.
    pub(super) fn hull(&self) -> Option<Arc<Hull>> {
        self.lock().hull.clone()
    }

    /// Records an error of the collider, which cannot return one to ODE.
    pub(super) fn record_error(&self, error: Error) {
        LAST_ERROR.set(error.to_string());
        self.lock().error.get_or_insert(error);
    }

    /// Records what is left out of a sweep, or which body does not stick.
    pub(super) fn record_left_out(&self, what: Error) {
        LAST_ERROR.set(what.to_string());
        self.lock().left_out.get_or_insert(what);
    }

    /// Takes the first thing that was left out since the last call.
    pub(super) fn take_left_out(&self) -> Option<Error> {
        self.lock().left_out.take()
    }

    /// Takes the first error of the collider since the last call.
    pub(super) fn take_error(&self) -> Option<Error> {
        self.lock().error.take()
    }

    /// Brings the latest published frame into force, or the hull at the simulation's time where that is asked for; true
    /// where it is a new one.
    fn swap_frame(&self) -> bool {
        let (data, motion, time, warped_for) = {
            let state = self.lock();
            (state.data.clone(), state.motion, state.time, state.warped_for)
        };

        let latest = data.latest();
        let hull = match (&latest, time) {
            (Some((number, _)), Some(time)) if motion != Motion::Held => {
                if warped_for == Some((*number, time)) {
                    return false;
                }
                data.in_motion(motion, time).map(Some)
            }
            _ => Ok(latest.as_ref().map(|(_, hull)| hull.clone())),
        };
        let hull = hull.unwrap_or_else(|error| {
            self.record_error(error);
            latest.as_ref().map(|(_, hull)| hull.clone())
        });

        let mut state = self.lock();
        state.warped_for = latest.map(|(number, _)| number).zip(time);
        let is_new = match (&state.hull, &hull) {
            (Some(old), Some(new)) => !Arc::ptr_eq(old, new),
            (None, None) => false,
            _ => true,
        };

        if is_new {
            let last = std::mem::replace(&mut state.hull, hull);
            let State { lost_views, hull, .. } = &mut *state;
            lost_views.compare(last.as_deref(), hull.as_deref());
            state.frame_count += 1;
        }
        is_new
    }

    /// Whether the geom's pose is that of its last collide. It is not inside a geom transform, which gives it its pose in
    /// the world only while ODE collides it.
    ///
    /// # Safety
    /// `geom` is the living geom that owns this data.
    pub(super) unsafe fn is_where_it_collided(&self, geom: dGeomID) -> bool {
        // SAFETY: the caller vouches for the geom.
        let pose = unsafe { pose(geom) };
        self.lock().collided_at.is_none_or(|collided_at| collided_at == pose)
    }

    /// The box of the geom in the world: around the hull, around the bodies that touched it last and may sleep, so that the
    /// broad phase still pairs these with the hull when it has left, and around those that stick to it. Never NaN, on which ODE aborts.
    ///
    /// # Safety
    /// `geom` is the living geom that owns this data.
    pub(super) unsafe fn world_aabb(&self, geom: dGeomID) -> [f64; 6] {
        // SAFETY: the caller vouches for the geom.
        let (world_from_hull, space) = unsafe { (pose(geom), dGeomGetSpace(geom)) };
        let reach = self.lock().swept_reach;
        let hull = if !space.is_null() { Some(self.lock().aabb()) } else { self.lock().bounds() };
        let Some(hull) = hull else {
            const LOW: f64 = f64::NEG_INFINITY;
            const HIGH: f64 = f64::INFINITY;
            return [LOW, HIGH, LOW, HIGH, LOW, HIGH];
        };

        // An empty hull is a point, so that it is near nothing, yet neither NaN nor infinite.
        let is_empty = hull.is_empty();
        let hull =
            if is_empty { Aabb { min: Point3::origin(), max: Point3::origin() } } else { hull.grown(reach) };
        let touching = self.last_contacts.touching_bodies().union(&self.hold.bodies());
        let mut aabb = hull.transformed(&world_from_hull).union(&touching);
        // SAFETY: a geom's space is living.
        if let Some(min_level) = unsafe { hash_space::min_level_of(space) } {
            aabb = hash_space::out_of_unit_cells(&aabb, min_level);
        }
        [aabb.min.x, aabb.max.x, aabb.min.y, aabb.max.y, aabb.min.z, aabb.max.z]
    }

    /// What a call of the collider needs; `None` before the first frame.
    ///
    /// # Safety
    /// `geom` is the living geom that owns this data.
    pub(super) unsafe fn start_collide(&self, geom: dGeomID) -> Option<CollideContext<'_>> {
        // SAFETY: the caller vouches for the geom.
        let world_from_hull = unsafe { pose(geom) };
        let mut state = self.lock();
        state.collided_at = Some(world_from_hull);
        Some(CollideContext {
            hull: state.hull.clone()?,
            frame: state.frame_count,
            settings: state.settings,
            swept: state.swept,
            motion: state.motion,
            min_feature: state.min_feature,
            has_events: state.has_events,
            loss: state.lost_views.in_force(),
            hull_from_world: world_from_hull.inverse(),
            geom: self,
        })
    }
}

impl State {
    /// The box around the frame in force, in the hull's frame of reference.
    fn aabb(&self) -> Aabb {
        self.hull.as_ref().map_or(Aabb::EMPTY, |hull| *hull.aabb())
    }

    /// A box around the frames to come, in the hull's frame of reference: the work volume. It is for a geom in no space,
    /// which may be inside a geom transform: ODE does not tell the transform that a frame has changed the box inside it.
    /// `None` where it is not set yet.
    fn bounds(&self) -> Option<Aabb> {
        self.hull.as_ref().map(|hull| *hull.bounds()).or_else(|| self.data.bounds())
    }
}

/// Brings the latest published frame into force in `geom`, and tells ODE that its box has changed.
///
/// # Safety
/// `geom` is the living geom that owns `hull`, and no space that it is in is being collided.
pub(super) unsafe fn apply_latest_frame(geom: dGeomID, hull: &HullGeom) {
    let is_new = hull.swap_frame();
    if is_new {
        hull.follow_parts();
    }
    let is_swept = hull.swept() != Swept::Off;
    // SAFETY: the caller vouches for the geom and its space.
    let speed = if is_swept { unsafe { neighbours::fastest_neighbour(geom) } } else { 0.0 };
    let holds = hull.hold.count();
    if hull.look_ahead(speed) || is_new || holds {
        // SAFETY: the caller vouches that the space is not locked, where ODE would abort.
        unsafe { dGeomMoved(geom) };
    }
}

/// The pose of a hull geom, world from hull. It is read from ODE's rotation matrix, since the quaternion of a geom inside a
/// geom transform would be the body's.
///
/// # Safety
/// `geom` is a living geom of the class.
pub(super) unsafe fn pose(geom: dGeomID) -> Isometry3<f64> {
    let (mut position, mut rotation) = ([0.0; 4], [0.0; 12]);
    // SAFETY: the caller vouches for the geom, whose class is placeable; the arrays hold a vector and a matrix.
    unsafe {
        dGeomCopyPosition(geom, position.as_mut_ptr());
        dGeomCopyRotation(geom, rotation.as_mut_ptr());
    }
    let rotation = Rotation3::from_matrix_unchecked(convert::matrix(&rotation));
    Isometry3::from_parts(convert::vector(&position).into(), UnitQuaternion::from_rotation_matrix(&rotation))
}

mod events;
mod look_ahead;
mod settings;
mod velocity;

use events::EventRecorder;
use velocity::Velocities;

#[cfg(test)]
mod tests {
    #[test]
    fn the_data_of_a_hull_geom_may_be_used_and_freed_on_any_thread() {
        fn assert_send_and_sync<T: Send + Sync>() {}
        assert_send_and_sync::<super::HullGeom>();
    }
}
