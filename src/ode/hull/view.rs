//! Hull geoms in a world.

use super::raw::{self, RawHull};
use super::{body_samples, class, geom};
use crate::contact::{BodyResponse, Mode, Settings};
use crate::hull::{Hull, HullData};
use crate::ode::arena::{GeomId, SpaceId};
use crate::ode::world::World;
use crate::sample::Samples;
use crate::{Error, Result};
use nalgebra::{Point3, Vector3};
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
        let number = class::number()?;
        // SAFETY: ODE is open as long as the world lives, and the number is one of its classes; the class's boxes are
        // finite.
        unsafe { self.insert_geom(space, raw::create(number, data.clone())) }
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
        let hull = RawHull::find(self.geoms.find(id)?.raw)?;
        Ok(HullView { world: self, hull })
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
        unsafe { body_samples::set_samples(raw, samples) };
        Ok(())
    }

    /// Goes back to the samples of the geom's class.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the geom is gone.
    pub fn clear_samples(&mut self, id: GeomId) -> Result<()> {
        body_samples::clear_samples(self.geoms.find(id)?.raw);
        Ok(())
    }

    /// Brings the latest published frames into force. Runs before each collide, when no space is locked.
    pub(in crate::ode) fn adopt_frames(&mut self) {
        for (_, record) in self.geoms.iter() {
            if let Some(hull) = class::find(record.raw) {
                // SAFETY: the record is alive, and the world is borrowed mutably, so that nothing collides.
                unsafe { geom::apply_latest_frame(record.raw, &hull) };
            }
        }
    }
}

/// A hull geom to ask, in world coordinates: it answers by the frame in force, that of the last collide.
#[derive(Debug, Clone)]
pub struct HullView<'w> {
    world: &'w World,
    hull: RawHull,
}

impl HullView<'_> {
    /// The data that it is bound to.
    pub fn data(&self) -> Arc<HullData> {
        self.hull.data()
    }

    /// The frame in force, in the hull's frame of reference; `None` before the first.
    pub fn frame(&self) -> Option<Arc<Hull>> {
        self.hull.frame()
    }

    /// How contacts are made.
    pub fn settings(&self) -> Settings {
        self.hull.settings()
    }

    /// The diameter, in metres, of the thinnest real feature that must not slip between a body's samples.
    pub fn min_feature(&self) -> f64 {
        self.hull.min_feature()
    }

    /// What the collider could not tell ODE, once: a body too large to sample, a degenerate mesh. Such bodies do not
    /// collide.
    pub fn take_error(&self) -> Option<Error> {
        self.hull.take_error()
    }

    /// Whether a point of the world is inside.
    pub fn inside(&self, p: &Point3<f64>) -> bool {
        self.hull.inside(p)
    }

    /// The paper's response vector of a point of the world; `None` outside.
    pub fn point_response(&self, p: &Point3<f64>) -> Option<Vector3<f64>> {
        self.hull.point_response(p)
    }

    /// The paper's response of the body shape of geom `body`, in the world.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the geom is gone or cannot be sampled.
    pub fn body_response(&self, body: GeomId) -> Result<BodyResponse> {
        let other = self.world.geoms.find(body)?.raw;
        // SAFETY: the record is alive.
        unsafe { self.hull.body_response(other) }
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
        self.view.clone()
    }

    /// Binds the geom to other data, from the next collide on.
    pub fn set_data(&mut self, data: &Arc<HullData>) {
        self.view.hull.set_data(data.clone());
    }

    /// Sets how contacts are made.
    pub fn set_mode(&mut self, mode: Mode) {
        self.view.hull.set_mode(mode);
    }

    /// Sets the most contacts for a pair; the caller of a collide may ask for fewer.
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

    /// Sets the diameter, in metres, of the thinnest real feature that must not slip between a body's samples.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] unless it is positive and finite.
    pub fn set_min_feature(&mut self, diameter: f64) -> Result<()> {
        self.view.hull.set_min_feature(diameter)
    }
}
