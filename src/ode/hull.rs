//! Hull geoms in a world.

use super::arena::{GeomId, SpaceId};
use super::hull_geom::{self, HullGeom};
use super::world::World;
use super::{body_samples, check, convert, hull_class};
use crate::contact::{self, BodyResponse, Mode, Settings};
use crate::hull::{Hull, HullData};
use crate::sample::Samples;
use crate::{Error, Result};
use nalgebra::{Isometry3, Point3, Vector3};
use ode_sys::{dCreateGeom, dGeomID};
use std::sync::Arc;

impl World {
    /// A geom of the visual hull class, bound to `data`, with its capture space at the world's origin.
    ///
    /// It collides with the latest frame that `data` has published when a collide begins; without a frame with
    /// nothing. Any number of geoms may share one data object, and the data lives as long as they do.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the space is gone, [`Error::Ode`] if ODE's table of user classes is full.
    pub fn add_hull(&mut self, space: SpaceId, data: &Arc<HullData>) -> Result<GeomId> {
        let number = hull_class::number()?;
        let geom = Box::new(HullGeom::new(data.clone()));
        // SAFETY: ODE is open as long as the world lives, and the number is one of its classes; the data is given
        // before the geom comes into a space, and its boxes are finite.
        unsafe {
            let raw = dCreateGeom(number);
            hull_class::give_data(raw, geom);
            self.insert_geom(space, raw)
        }
    }

    /// A hull geom to ask.
    ///
    /// # Panics
    ///
    /// If the geom was removed, is of another world, or is no hull. [`get_hull`](Self::get_hull) does not.
    #[track_caller]
    pub fn hull(&self, id: GeomId) -> HullView<'_> {
        self.get_hull(id).unwrap_or_else(|error| panic!("{error}"))
    }

    /// A hull geom to ask.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the geom was removed, is of another world, or is no hull.
    pub fn get_hull(&self, id: GeomId) -> Result<HullView<'_>> {
        let raw = self.geoms.find(id)?.raw;
        // SAFETY: the record is alive as long as the view borrows the world.
        let geom = unsafe { hull_class::data(raw) };
        let geom = geom.ok_or_else(|| {
            Error::argument(format!("{id:?}: expected a visual hull, found a geom of another class"))
        })?;
        Ok(HullView { world: self, raw, geom })
    }

    /// A hull geom to change.
    ///
    /// # Panics
    ///
    /// As [`hull`](Self::hull).
    #[track_caller]
    pub fn hull_mut(&mut self, id: GeomId) -> HullMut<'_> {
        HullMut { view: self.hull(id) }
    }

    /// Gives a geom surface samples of the user's own, for classes that have none or better ones, until
    /// [`clear_samples`](Self::clear_samples).
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the geom is gone.
    pub fn set_samples(&mut self, id: GeomId, samples: Samples) -> Result<()> {
        let raw = self.geoms.find(id)?.raw;
        // SAFETY: the record is alive.
        unsafe { body_samples::give(raw, samples) };
        Ok(())
    }

    /// Goes back to the samples of the geom's class.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the geom is gone.
    pub fn clear_samples(&mut self, id: GeomId) -> Result<()> {
        body_samples::take_away(self.geoms.find(id)?.raw);
        Ok(())
    }

    /// Brings the latest published frames into force. Runs before each collide, when no space is locked.
    pub(super) fn adopt_frames(&mut self) {
        for (_, record) in self.geoms.iter() {
            // SAFETY: the record is alive, and the world is borrowed mutably, so that nothing collides.
            unsafe {
                if let Some(hull) = hull_class::data(record.raw) {
                    hull_geom::adopt(record.raw, hull);
                }
            }
        }
    }
}

/// A hull geom to ask, in world coordinates: it answers by the frame in force, that of the last collide.
#[derive(Debug, Clone, Copy)]
pub struct HullView<'w> {
    world: &'w World,
    raw: dGeomID,
    geom: &'w HullGeom,
}

impl HullView<'_> {
    /// The data that it is bound to.
    pub fn data(&self) -> Arc<HullData> {
        self.geom.data()
    }

    /// The frame in force, in the hull's frame of reference; `None` before the first.
    pub fn frame(&self) -> Option<Arc<Hull>> {
        self.geom.hull()
    }

    /// How contacts are made.
    pub fn settings(&self) -> Settings {
        self.geom.settings()
    }

    /// The diameter, in metres, of the thinnest real feature that must not slip between a body's samples.
    pub fn min_feature(&self) -> f64 {
        self.geom.min_feature()
    }

    /// What the collider could not tell ODE, once: a body too large to sample, a degenerate mesh. Such bodies do not
    /// collide.
    pub fn take_trouble(&self) -> Option<Error> {
        self.geom.take_trouble()
    }

    /// Whether a point of the world is inside.
    pub fn inside(&self, p: &Point3<f64>) -> bool {
        self.frame().is_some_and(|hull| hull.inside(&self.pose().inverse_transform_point(p)))
    }

    /// The paper's response vector of a point of the world; `None` outside.
    pub fn point_response(&self, p: &Point3<f64>) -> Option<Vector3<f64>> {
        let (hull, pose) = (self.frame()?, self.pose());
        hull.respond(&pose.inverse_transform_point(p)).map(|response| pose * response.w())
    }

    /// The paper's response of the body shape of geom `body`, in the world.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the geom is gone or cannot be sampled.
    pub fn body_response(&self, body: GeomId) -> Result<BodyResponse> {
        let other = self.world.geoms.find(body)?.raw;
        let nothing = BodyResponse { vector: Vector3::zeros(), colliding: 0 };
        // SAFETY: the record is alive.
        let (world_from_body, samples) = unsafe {
            let pose = convert::any_pose(other);
            (pose, body_samples::of(other, &pose, self.min_feature())?)
        };
        let (Some(hull), Some(samples)) = (self.frame(), samples) else { return Ok(nothing) };
        let pose = self.pose();
        let response = contact::body_response(&hull, &samples, &(pose.inverse() * world_from_body));
        Ok(BodyResponse { vector: pose * response.vector, ..response })
    }

    fn pose(&self) -> Isometry3<f64> {
        // SAFETY: the view borrows the world, so that the geom is alive; the class is placeable.
        unsafe { hull_geom::pose(self.raw) }
    }
}

/// A hull geom to change.
#[derive(Debug)]
pub struct HullMut<'w> {
    view: HullView<'w>,
}

impl HullMut<'_> {
    /// The same geom to ask.
    pub fn view(&self) -> HullView<'_> {
        self.view
    }

    /// Binds the geom to other data, from the next collide on.
    pub fn set_data(&mut self, data: &Arc<HullData>) {
        self.view.geom.set_data(data.clone());
    }

    /// Sets how contacts are made.
    pub fn set_mode(&mut self, mode: Mode) {
        self.view.geom.change_settings(|settings| settings.mode = mode);
    }

    /// Sets the most contacts for a pair; the caller of a collide may ask for fewer.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for zero.
    pub fn set_max_contacts(&mut self, most: usize) -> Result<()> {
        if most == 0 {
            return Err(Error::argument(
                "max_contacts: expected at least 1, found 0; disable the geom instead",
            ));
        }
        self.view.geom.change_settings(|settings| settings.max_contacts = most);
        Ok(())
    }

    /// Sets the largest depth of a contact, in metres.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] unless it is positive and finite.
    pub fn set_max_depth(&mut self, depth: f64) -> Result<()> {
        check::length("max_depth of the hull", depth)?;
        self.view.geom.change_settings(|settings| settings.max_depth = depth);
        Ok(())
    }

    /// Sets the diameter, in metres, of the thinnest real feature that must not slip between a body's samples.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] unless it is positive and finite.
    pub fn set_min_feature(&mut self, diameter: f64) -> Result<()> {
        check::length("min_feature of the hull", diameter)?;
        self.view.geom.set_min_feature(diameter);
        Ok(())
    }
}
