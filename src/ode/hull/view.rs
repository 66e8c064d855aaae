//! Hull geoms in a [`World`]: adding, querying and changing them.

use super::raw::{self, RawHull};
use super::swept::Swept;
use super::{body_samples, class, geom};
use crate::contact::{BodyResponse, Mode, Settings};
use crate::hull::{Hull, HullData, Motion};
use crate::ode::arena::{BodyId, GeomId, SpaceId};
use crate::ode::world::World;
use crate::sample::Samples;
use crate::{Error, Result};
use nalgebra::{Point3, Vector3};
use ode_sys::{dBodyEnable, dGeomGetBody, dGeomID};
use std::sync::Arc;

impl World {
    /// Adds a geom of the visual hull class, bound to `data`, with the origin of the capture volume at the world's origin.
    ///
    /// The geom collides with the latest frame that `data` has published when a collide begins, and with nothing before
    /// the first frame. Any number of geoms may share one data object, which lives as long as they do.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the space is gone, [`Error::Ode`] if ODE's table of user classes is full.
    pub fn add_hull(&mut self, space: SpaceId, data: &Arc<HullData>) -> Result<GeomId> {
        let number = class::number()?;
        // SAFETY: ODE is open as long as the world lives, and the number is one of its classes; the class's boxes are
        // finite.
        unsafe { self.insert_geom(space, raw::create(number, data.clone())) }
    }

    /// A hull geom, for queries.
    ///
    /// # Panics
    ///
    /// Panics if the geom was removed, is of another world, or is no hull. [`get_hull`](Self::get_hull) returns an error.
    #[track_caller]
    pub fn hull(&self, id: GeomId) -> HullView<'_> {
        self.get_hull(id).unwrap_or_else(|error| panic!("{error}"))
    }

    /// A hull geom, for queries.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the geom was removed, is of another world, or is no hull.
    pub fn get_hull(&self, id: GeomId) -> Result<HullView<'_>> {
        let hull = RawHull::find(self.geoms.find(id)?.raw)?;
        Ok(HullView { world: self, hull })
    }

    /// A hull geom, for changes.
    ///
    /// # Panics
    ///
    /// Panics where [`hull`](Self::hull) does.
    #[track_caller]
    pub fn hull_mut(&mut self, id: GeomId) -> HullMut<'_> {
        HullMut { view: self.hull(id) }
    }

    /// Sets the surface samples of a geom, in place of those of its class, until [`clear_samples`](Self::clear_samples).
    /// For classes that have no samples, and for shapes whose samples a program knows better.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the geom is gone.
    pub fn set_samples(&mut self, id: GeomId, samples: Samples) -> Result<()> {
        let raw = self.geoms.find(id)?.raw;
        // SAFETY: the record is alive.
        unsafe { body_samples::set_samples(raw, samples) };
        Ok(())
    }

    /// Returns to the samples of the geom's class.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the geom is gone.
    pub fn clear_samples(&mut self, id: GeomId) -> Result<()> {
        body_samples::clear_samples(self.geoms.find(id)?.raw);
        Ok(())
    }

    /// Whether the geom at this address is a visual hull.
    pub(in crate::ode) fn is_hull(&self, raw: dGeomID) -> bool {
        class::find(raw).is_some()
    }

    /// Wakes the bodies that touched the hull geom `raw` when they were last collided, since it is about to leave them.
    /// Does nothing for a geom of another class.
    pub(in crate::ode) fn wake_bodies_on(&mut self, raw: dGeomID) {
        let Some(hull) = class::find(raw) else { return };
        let touching = hull.last_contacts.touching_geoms();
        for (_, record) in self.geoms.iter().filter(|(_, record)| touching.contains(&(record.raw as usize))) {
            // SAFETY: the record is alive, and so is its body, if it has one.
            unsafe {
                let body = dGeomGetBody(record.raw);
                if !body.is_null() {
                    dBodyEnable(body);
                }
            }
        }
    }

    /// Brings the latest published frames into force. Runs before each collide, while no space is locked.
    pub(in crate::ode) fn apply_latest_frames(&mut self) {
        for (_, record) in self.geoms.iter() {
            if let Some(hull) = class::find(record.raw) {
                hull.step_size.tell(self.last_dt);
                // SAFETY: the record is alive, and the world is borrowed mutably, so that nothing collides.
                unsafe { geom::apply_latest_frame(record.raw, &hull) };
            }
        }
    }
}

/// A hull geom, for queries in world coordinates. They refer to the frame in force, which is that of the last collide.
#[derive(Debug, Clone)]
pub struct HullView<'w> {
    pub(super) world: &'w World,
    pub(super) hull: RawHull,
}

impl HullView<'_> {
    /// The data object that the geom is bound to.
    pub fn data(&self) -> Arc<HullData> {
        self.hull.data()
    }

    /// The frame in force, in the hull's frame of reference; `None` before the first.
    pub fn frame(&self) -> Option<Arc<Hull>> {
        self.hull.frame()
    }

    /// Which hull the geom shows at the simulation's time.
    pub fn motion(&self) -> Motion {
        self.hull.motion()
    }

    /// Whether the geom collides with what it will meet within the next step.
    pub fn swept(&self) -> Swept {
        self.hull.swept()
    }

    /// Whether bodies that touch the hull stick to it: see [`HullMut::hold`].
    pub fn is_held(&self) -> bool {
        self.hull.is_held()
    }

    /// Whether a body sticks to the hull; `false` also for a body that is gone.
    pub fn holds(&self, body: BodyId) -> bool {
        self.world.bodies.find(body).is_ok_and(|&raw| self.hull.holds(raw))
    }

    /// How contacts are made.
    pub fn settings(&self) -> Settings {
        self.hull.settings()
    }

    /// The diameter, in metres, of the thinnest real feature that must not pass between a body's samples.
    pub fn min_feature(&self) -> f64 {
        self.hull.min_feature()
    }

    /// Takes the first error of the collider since the last call, such as a body too large to sample or a degenerate mesh.
    /// Such bodies do not collide, and ODE has no way to report why.
    pub fn take_error(&self) -> Option<Error> {
        self.hull.take_error()
    }

    /// Takes the first thing that was left out of a sweep since the last call, or the first body that a held hull has not kept:
    /// see [`HullMut::set_swept`] and [`HullMut::hold`]. All else was swept and collided.
    pub fn take_left_out(&self) -> Option<Error> {
        self.hull.take_left_out()
    }

    /// Whether a point, in world coordinates, is inside the hull.
    pub fn inside(&self, p: &Point3<f64>) -> bool {
        self.hull.inside(p)
    }

    /// The paper's response vector `w` (section 4.2) of a point, both in world coordinates; `None` outside the hull.
    pub fn point_response(&self, p: &Point3<f64>) -> Option<Vector3<f64>> {
        self.hull.point_response(p)
    }

    /// The velocity of the real surface near a point, m/s, both in world coordinates; `None` where it is not known, and
    /// always with [`Motion::Held`]. See [`Hull::velocity`].
    pub fn point_velocity(&self, p: &Point3<f64>) -> Option<Vector3<f64>> {
        self.hull.point_velocity(p)
    }

    /// The paper's response `V` (section 5) of the shape of geom `body`, in world coordinates.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the geom is gone or cannot be sampled.
    pub fn body_response(&self, body: GeomId) -> Result<BodyResponse> {
        let other = self.world.geoms.find(body)?.raw;
        // SAFETY: the record is alive.
        unsafe { self.hull.body_response(other) }
    }

    /// The surface samples by which geom `body` collides with the hull, in the geom's own frame: those that were set, else
    /// those of its class and sizes for [`min_feature`](Self::min_feature). `None` for a class that has none.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the geom is gone or cannot be sampled.
    pub fn samples(&self, body: GeomId) -> Result<Option<Arc<Samples>>> {
        let other = self.world.geoms.find(body)?.raw;
        // SAFETY: the record is alive.
        unsafe { self.hull.samples(other) }
    }
}

/// A hull geom, for changes.
#[derive(Debug)]
pub struct HullMut<'w> {
    pub(super) view: HullView<'w>,
}

impl HullMut<'_> {
    /// This geom, for queries.
    pub fn view(&self) -> HullView<'_> {
        self.view.clone()
    }

    /// Binds the geom to another data object, from the next collide on. Bodies that stick to the hull are released: see
    /// [`hold`](Self::hold).
    pub fn set_data(&mut self, data: &Arc<HullData>) {
        self.view.hull.set_data(data.clone());
    }

    /// Sets which hull the geom shows at the simulation's time, [`Motion::Held`] by default. The others need
    /// [`set_time`](Self::set_time) before each collide.
    pub fn set_motion(&mut self, motion: Motion) {
        self.view.hull.set_motion(motion);
    }

    /// Tells the simulation's time in seconds, by the clock of the frames, and brings the hull at that time into force.
    /// Does nothing more than that where the motion is [`Motion::Held`].
    ///
    /// A time beyond the frames is no error: the hull stays as it is at the nearest time that [`Motion`] allows.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a time that is not finite or lies before the last one.
    pub fn set_time(&mut self, time: f64) -> Result<()> {
        // SAFETY: the record is alive, and the world is borrowed mutably, so that nothing collides.
        unsafe { self.view.hull.set_time(time) }
    }

    /// Sets whether the geom collides with what it will meet within the next step, [`Swept::Off`] by default, from the next
    /// collide on.
    ///
    /// The hull moves ahead as its silhouettes do where its [`Motion`] is not [`Motion::Held`], and stands still otherwise;
    /// bodies move at their velocities. Bodies in a quadtree are not looked for: there only those that its box holds anyway
    /// are found. [`HullView::take_left_out`] tells where the length of a step is not known yet, where views have no motion and
    /// so stand still in the sweep, and where a body moves farther in a step than the work volume is large.
    pub fn set_swept(&mut self, swept: Swept) {
        self.view.hull.set_swept(swept);
    }

    /// Lets each body that touches the hull stick to it, from the next collide on, or releases all that do: the paper's button
    /// (section 7). Holding a hull that is held already, and releasing one that is not, changes nothing.
    ///
    /// A body that sticks moves and turns with the part of the subject that it touched: the edges of the silhouettes within
    /// 0.15 m of its contacts, which are followed from hull to hull. It has no contacts with the hull, and is not asleep. In each
    /// collide it gets the velocity that takes it to its place beside them; how far it is off falls to a third in 10 ms, over
    /// which frames that jump are spread too. With [`Motion::Held`] it goes on between two frames as the subject moved. Where no
    /// edges are found, it goes on as it moved for 0.2 s. In the first collide after its release it gets the velocity of the
    /// subject there, the derivative of a parabola fitted to its last 0.1 s, and its contacts are back.
    ///
    /// Geoms without a body and kinematic bodies do not stick; several geoms of one body count as one. A hull without a frame or
    /// without a point may be held: bodies stick once they touch it. [`set_data`](Self::set_data) releases all, and the hull is
    /// not held any more. If two held hulls touch a body, the first keeps it, and [`HullView::take_error`] of the second tells
    /// so. Bodies that do not stick, or not any more, are told by [`HullView::take_left_out`]: one at which too few edges are
    /// seen; one that something holds back from its place by more than 0.15 m for 0.1 s, one that is found
    /// more than 0.1 m from where its velocity has taken it, since the program has moved it, and one whose part of the subject is
    /// not found any more. A body that is destroyed, or is not collided with the hull in 40 collides, is
    /// forgotten; [`set_time`](Self::set_time) counts as one too.
    pub fn hold(&mut self, on: bool) {
        self.view.hull.hold(on);
    }

    /// Sets how contacts are made.
    pub fn set_mode(&mut self, mode: Mode) {
        self.view.hull.set_mode(mode);
    }

    /// Sets the largest number of contacts of a pair. The caller of a collide may ask for fewer.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for zero.
    pub fn set_max_contacts(&mut self, most: usize) -> Result<()> {
        self.view.hull.set_max_contacts(most)
    }

    /// Sets the largest depth of a contact, in metres.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] unless it is positive and finite.
    pub fn set_max_depth(&mut self, depth: f64) -> Result<()> {
        self.view.hull.set_max_depth(depth)
    }

    /// Sets the diameter, in metres, of the thinnest real feature that must not pass between a body's samples.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] unless it is positive and finite.
    pub fn set_min_feature(&mut self, diameter: f64) -> Result<()> {
        self.view.hull.set_min_feature(diameter)
    }
}
