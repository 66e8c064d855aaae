//! Objects by ODE's own ids: finding the world's ids of them, and taking over objects made with ODE's own functions.

use ode_sys::{
    dBodyGetData, dBodyGetWorld, dBodyID, dBodySetData, dGeomGetAABB, dGeomGetBody, dGeomGetClass,
    dGeomGetData, dGeomGetSpace, dGeomID, dGeomIsSpace, dGeomMoved, dGeomTransformClass, dJointID, dSpaceAdd,
    dSpaceID,
};

use super::arena::{BodyId, GeomId, JointId, SpaceId};
use super::body::Body;
use super::check::REACH;
use super::geom::GeomRecord;
use super::shape::{checked, shape_of};
use super::step::is_valid;
use super::world::World;
use crate::{Error, Result};

impl World {
    /// The id of ODE's body `raw`, if this world owns it.
    ///
    /// # Safety
    ///
    /// `raw` is null or a living body.
    pub unsafe fn body_id(&self, raw: dBodyID) -> Option<BodyId> {
        if raw.is_null() {
            return None;
        }
        // SAFETY: the caller guarantees a living body.
        let data = unsafe { dBodyGetData(raw) } as usize;
        // A body made elsewhere may carry any user data, so the record found with it must name this body.
        self.bodies.by_user_data(data).filter(|&(_, &own)| own == raw).map(|(key, _)| BodyId(key))
    }

    /// The id of ODE's geom `raw`, if this world owns it.
    ///
    /// # Safety
    ///
    /// `raw` is null or a living geom.
    pub unsafe fn geom_id(&self, raw: dGeomID) -> Option<GeomId> {
        if raw.is_null() {
            return None;
        }
        // SAFETY: the caller guarantees a living geom.
        let data = unsafe { dGeomGetData(raw) } as usize;
        self.geoms.by_user_data(data).filter(|(_, own)| own.raw == raw).map(|(key, _)| GeomId(key))
    }

    /// The id of ODE's space `raw`, if this world owns it. The search compares addresses and does not follow `raw`.
    pub fn space_id(&self, raw: dSpaceID) -> Option<SpaceId> {
        self.spaces.iter().find(|(_, own)| own.raw == raw).map(|(key, _)| SpaceId(key))
    }

    /// The id of ODE's joint `raw`, if this world owns it and it is no contact of the last collide. The search compares
    /// addresses and does not follow `raw`.
    pub fn joint_id(&self, raw: dJointID) -> Option<JointId> {
        self.joints.iter().find(|(_, own)| own.raw == raw).map(|(key, _)| JointId(key))
    }

    /// Takes over a geom made with ODE's own functions, so that [`collide`](Self::collide) reports it. A geom in no
    /// space is added to `space`.
    ///
    /// The world then destroys the geom, and uses its user data. Geoms that were added to the world's spaces and are
    /// not adopted are left out of all pairs, and destroyed with their space.
    ///
    /// The geom has a [`shape`](super::Geom::shape) if it is a ball, box, capsule, cylinder, plane or ray.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if `space` was removed or the geom is in another one; for null, a space, a transform, and a
    /// geom that this world owns already; if the geom is on a body of another world; and if its sizes or bounding box
    /// are NaN or beyond [`REACH`]. The geom still belongs to the caller then.
    ///
    /// # Safety
    ///
    /// - `raw` is null or a living geom, and no other code destroys it.
    /// - What the geom refers to, such as the data of a mesh, polyhedron or heightfield, lives until the geom is
    ///   removed or the world is dropped, and no other thread uses it while one uses the world. A heightfield was
    ///   created as placeable.
    /// - ODE can collide the geom with all others of the world without an abort. For a heightfield see
    ///   [`Shape::Heightfield`](super::Shape::Heightfield): this world cannot count the cells of an adopted one.
    /// - No collide is running.
    /// - The rules of [`World::raw`] hold for the geom from now on. It may be attached to raw bodies of this world, but
    ///   not of another one.
    pub unsafe fn adopt_geom(&mut self, raw: dGeomID, space: SpaceId) -> Result<GeomId> {
        let raw_space = self.spaces.find(space)?.raw;
        // SAFETY: the caller guarantees null or a living geom.
        let shape = unsafe {
            self.check_geom(raw, raw_space)?;
            shape_of(raw)
        };
        if let Some(shape) = &shape {
            checked(shape)?;
        }

        // A geom keeps its "clean" flag when it comes into a space, which would overlook it without `dGeomMoved`.
        // SAFETY: geom and space are alive, the geom is in this space or in none, and no collide is running.
        unsafe {
            if dGeomGetSpace(raw).is_null() {
                dSpaceAdd(raw_space, raw);
            }
            dGeomMoved(raw);
        }
        Ok(self.keep_geom(GeomRecord::adopted(raw, space.0, shape)))
    }

    /// Refuses a geom that cannot be adopted into `space`.
    ///
    /// # Safety
    ///
    /// `raw` is null or a living geom.
    unsafe fn check_geom(&self, raw: dGeomID, space: dSpaceID) -> Result<()> {
        let refuse = |expected: &str| Err(Error::argument(format!("geom to adopt: expected {expected}")));
        if raw.is_null() {
            return refuse("a geom, found null");
        }

        let mut bounds = [0.0; 6];
        // SAFETY: the caller guarantees a living geom, and so its body is alive; the array holds six numbers.
        unsafe {
            if dGeomIsSpace(raw) != 0 {
                return refuse("a geom, found a space; call `add_space` and add the geoms to it");
            }
            // Its inner geom may be a mesh, for which collides have to lock ODE's cache.
            if dGeomGetClass(raw) as u32 == dGeomTransformClass {
                return refuse(
                    "a plain geom, found a transform; adopt its geom, with an offset from the body",
                );
            }
            if let Some(id) = self.geom_id(raw) {
                return refuse(&format!("one that the world does not own yet, found {id:?}"));
            }
            let current = dGeomGetSpace(raw);
            if !current.is_null() && current != space {
                return refuse(
                    "one in no space or in the space given, found one in another space; name that space",
                );
            }
            let body = dGeomGetBody(raw);
            if !body.is_null() && dBodyGetWorld(body) != self.raw {
                return refuse(
                    "one without a body or on a body of this world, found one on a body of another world",
                );
            }
            dGeomGetAABB(raw, bounds.as_mut_ptr());
        }

        // Infinite bounds, as of planes, are valid.
        match bounds.iter().find(|bound| bound.is_nan() || (bound.is_finite() && bound.abs() > 3.0 * REACH)) {
            None => Ok(()),
            Some(bound) => refuse(&format!("a bounding box within {REACH} m of its position, found {bound}")),
        }
    }

    /// Takes over a body of this world that was made with ODE's own functions. The world then destroys the body, and
    /// uses its user data. Its geoms are to be [adopted](Self::adopt_geom) themselves.
    ///
    /// A step that leaves an adopted body beyond [`REACH`] or without finite motion stops it, as others; a body that is
    /// not adopted would make ODE abort then.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for null, a body of another world, and a body that this world owns already; if the body's
    /// pose or motion is not finite or beyond [`REACH`]. The body still belongs to the caller then.
    ///
    /// # Safety
    ///
    /// `raw` is null or a living body, and no other code destroys it. The rules of [`World::raw`] hold for it from now
    /// on.
    pub unsafe fn adopt_body(&mut self, raw: dBodyID) -> Result<BodyId> {
        let refuse = |expected: &str| Err(Error::argument(format!("body to adopt: expected {expected}")));
        if raw.is_null() {
            return refuse("a body, found null");
        }
        // SAFETY: the caller guarantees a living body.
        let (of_this_world, known) = unsafe { (dBodyGetWorld(raw) == self.raw, self.body_id(raw)) };
        if !of_this_world {
            return refuse(
                "one of this world, found one of another world; create it with the id of this world",
            );
        }
        if let Some(id) = known {
            return refuse(&format!("one that the world does not own yet, found {id:?}"));
        }

        let key = self.bodies.insert(raw);
        let id = BodyId(key);
        if !is_valid(&Body::new(raw, id)) {
            self.bodies.remove(key);
            return refuse(&format!("a finite pose within {REACH} m and finite velocities; set them first"));
        }
        // SAFETY: the caller guarantees a living body, whose user data is the world's from now on.
        unsafe { dBodySetData(raw, key.user_data() as *mut _) };
        Ok(id)
    }
}
