//! A hull geom by ODE's own id: queries and settings, whether a [`World`](super::super::World) or the program owns it.

use super::events::TouchEvent;
use super::geom::{self, HullGeom};
use super::swept::Swept;
use super::{body_samples, class};
use crate::contact::{self, BodyResponse, Mode, Settings};
use crate::hull::{Hull, HullData, Motion};
use crate::ode::{check, convert};
use crate::sample::Samples;
use crate::{Error, Result};
use nalgebra::{Isometry3, Point3, Vector3};
use ode_sys::{dBodyID, dCreateGeom, dGeomID, dSpaceAdd, dSpaceID};
use std::sync::Arc;

/// A living hull geom.
#[derive(Debug, Clone)]
pub(crate) struct RawHull {
    raw: dGeomID,
    geom: Arc<HullGeom>,
}

/// Creates a geom of the class with this number, in no space, bound to `data`.
///
/// # Safety
/// ODE is open and `number` is the class's.
pub(super) unsafe fn create(number: i32, data: Arc<HullData>) -> dGeomID {
    // SAFETY: the caller vouches for the number; the data is bound before the geom comes into a space.
    unsafe {
        let raw = dCreateGeom(number);
        class::give_data(raw, HullGeom::new(data));
        raw
    }
}

/// Creates a hull geom in `space`, or in none where that is null, with the latest frame of `data` in force.
///
/// # Errors
/// The class is not open, or ODE is closed.
///
/// # Safety
/// `space` is null or a living space that is not being collided.
pub(crate) unsafe fn create_in(space: dSpaceID, data: Arc<HullData>) -> Result<dGeomID> {
    let number = super::open_class::number()?;
    // SAFETY: ODE is open; the caller vouches for the space; the geom is new.
    unsafe {
        let raw = create(number, data);
        if !space.is_null() {
            dSpaceAdd(space, raw);
        }
        if let Some(geom) = class::data(raw) {
            geom::apply_latest_frame(raw, geom);
        }
        Ok(raw)
    }
}

/// Brings the latest frame of `data` into force in all hull geoms bound to it.
///
/// # Safety
/// No space that holds one of them is being collided, nor is one of them being destroyed. Geoms bound to other data
/// may be.
pub(crate) unsafe fn apply_latest_frame_everywhere(data: &Arc<HullData>) {
    if !class::is_still_registered() {
        return;
    }
    for (raw, geom) in class::all() {
        if Arc::ptr_eq(&geom.data(), data) {
            // SAFETY: the geom is listed, and so it is living; the caller vouches that it stays so, and for its space.
            unsafe { geom::apply_latest_frame(raw, &geom) };
        }
    }
}

impl RawHull {
    /// Finds the hull geom `raw` by its address, which is not followed.
    ///
    /// # Errors
    /// An address at which there is no hull geom.
    pub(crate) fn find(raw: dGeomID) -> Result<Self> {
        let geom = class::find_current(raw).ok_or_else(|| {
            let found = if raw.is_null() {
                "NULL"
            } else {
                "a geom of another class, or one that was destroyed, also by closing ODE"
            };
            Error::argument(format!("geom: expected a visual hull, found {found}"))
        })?;
        Ok(Self { raw, geom })
    }

    /// Brings the latest frame of the geom's data into force.
    ///
    /// # Safety
    /// No space that holds the geom is being collided, nor is the geom being destroyed.
    pub(crate) unsafe fn apply_latest_frame(&self) {
        // SAFETY: the geom was listed as living, and the caller vouches for the rest.
        unsafe { geom::apply_latest_frame(self.raw, &self.geom) };
    }

    pub(crate) fn data(&self) -> Arc<HullData> {
        self.geom.data()
    }

    /// Binds the geom to other data, from its next frame on.
    pub(crate) fn set_data(&self, data: Arc<HullData>) {
        self.geom.set_data(data);
    }

    /// Whether bodies that touch the geom stick to it.
    pub(crate) fn is_held(&self) -> bool {
        self.geom.hold.is_on()
    }

    /// Lets bodies that touch the geom stick to it, or releases them.
    pub(crate) fn hold(&self, on: bool) {
        self.geom.hold.set(on);
    }

    /// Whether the body at this address, which is not followed, sticks to the geom.
    pub(crate) fn holds(&self, body: dBodyID) -> bool {
        self.geom.hold.holds(body as usize)
    }

    pub(crate) fn motion(&self) -> Motion {
        self.geom.motion()
    }

    pub(crate) fn set_motion(&self, motion: Motion) {
        self.geom.set_motion(motion);
    }

    /// Sets the simulation's time, and brings the hull at it into force.
    ///
    /// # Safety
    /// As [`Self::apply_latest_frame`].
    pub(crate) unsafe fn set_time(&self, time: f64) -> Result<()> {
        self.geom.set_time(time)?;
        // SAFETY: the caller vouches for the geom.
        unsafe { self.apply_latest_frame() };
        Ok(())
    }

    pub(crate) fn frame(&self) -> Option<Arc<Hull>> {
        self.geom.hull()
    }

    pub(crate) fn settings(&self) -> Settings {
        self.geom.settings()
    }

    pub(crate) fn min_feature(&self) -> f64 {
        self.geom.min_feature()
    }

    pub(crate) fn take_error(&self) -> Option<Error> {
        self.geom.take_error()
    }

    pub(crate) fn take_left_out(&self) -> Option<Error> {
        self.geom.take_left_out()
    }

    pub(crate) fn inside(&self, p: &Point3<f64>) -> bool {
        self.frame().is_some_and(|hull| hull.inside(&self.pose().inverse_transform_point(p)))
    }

    pub(crate) fn point_response(&self, p: &Point3<f64>) -> Option<Vector3<f64>> {
        let (hull, pose) = (self.frame()?, self.pose());
        hull.respond(&pose.inverse_transform_point(p)).map(|response| pose * response.w())
    }

    /// The velocity of the real surface near `p`, both in the world.
    pub(crate) fn point_velocity(&self, p: &Point3<f64>) -> Option<Vector3<f64>> {
        // SAFETY: the geom is listed as living, and its owner does not destroy it meanwhile.
        unsafe { self.geom.velocity(self.raw, p) }.map(|found| found.velocity)
    }

    /// The paper's response of the shape of `other`, in the world.
    ///
    /// # Safety
    /// `other` is a living geom.
    pub(crate) unsafe fn body_response(&self, other: dGeomID) -> Result<BodyResponse> {
        let nothing = BodyResponse { vector: Vector3::zeros(), colliding: 0 };
        // SAFETY: the caller vouches for the geom.
        let (world_from_body, samples) = unsafe { (convert::any_pose(other), self.samples(other)?) };
        let (Some(hull), Some(samples)) = (self.frame(), samples) else { return Ok(nothing) };
        let pose = self.pose();
        let response = contact::body_response(&hull, &samples, &(pose.inverse() * world_from_body));
        Ok(BodyResponse { vector: pose * response.vector, ..response })
    }

    /// The surface samples by which `other` collides with the hull, in its own frame.
    ///
    /// # Safety
    /// `other` is a living geom.
    pub(crate) unsafe fn samples(&self, other: dGeomID) -> Result<Option<Arc<Samples>>> {
        // SAFETY: the caller vouches for the geom.
        let found = unsafe { body_samples::of(other, &convert::any_pose(other), self.min_feature())? };
        if let Some(error) = found.outdated {
            self.geom.record_error(error);
        }
        Ok(found.samples)
    }

    fn pose(&self) -> Isometry3<f64> {
        // SAFETY: the geom is listed as living, and its owner does not destroy it meanwhile; the class is placeable.
        unsafe { geom::pose(self.raw) }
    }

    pub(crate) fn swept(&self) -> Swept {
        self.geom.swept()
    }

    /// Sets whether the geom collides with what it will meet within the next step, from its next frame or time on.
    pub(crate) fn set_swept(&self, swept: Swept) {
        self.geom.set_swept(swept);
    }

    pub(crate) fn has_events(&self) -> bool {
        self.geom.has_events()
    }

    pub(crate) fn set_events(&self, on: bool) {
        self.geom.set_events(on);
    }

    pub(crate) fn event_wait(&self) -> f64 {
        self.geom.event_wait()
    }

    pub(crate) fn set_event_wait(&self, seconds: f64) -> Result<()> {
        check::not_negative("event wait of the hull", seconds)?;
        self.geom.set_event_wait(seconds);
        Ok(())
    }

    /// Passes up to `most` events to `fetch`, and returns how many remain.
    pub(crate) fn fetch_events(&self, most: usize, fetch: impl FnMut(TouchEvent)) -> Result<usize> {
        self.geom.fetch_events(most, fetch)
    }

    pub(crate) fn set_mode(&self, mode: Mode) {
        self.geom.change_settings(|settings| settings.mode = mode);
    }

    pub(crate) fn set_max_contacts(&self, most: usize) -> Result<()> {
        if most == 0 {
            return Err(Error::argument(
                "max_contacts: expected at least 1, found 0; disable the geom instead",
            ));
        }
        self.geom.change_settings(|settings| settings.max_contacts = most);
        Ok(())
    }

    pub(crate) fn set_max_depth(&self, depth: f64) -> Result<()> {
        check::length("max_depth of the hull", depth)?;
        self.geom.change_settings(|settings| settings.max_depth = depth);
        Ok(())
    }

    pub(crate) fn set_min_feature(&self, diameter: f64) -> Result<()> {
        check::length("min_feature of the hull", diameter)?;
        self.geom.set_min_feature(diameter);
        Ok(())
    }
}
