//! Read and write access to geoms.

use nalgebra::{Isometry3, Point3, Unit, UnitQuaternion, Vector3};
use ode_sys::{
    dGeomClearOffset, dGeomCopyOffsetPosition, dGeomCopyPosition, dGeomDisable, dGeomEnable, dGeomGetBody,
    dGeomGetCategoryBits, dGeomGetCollideBits, dGeomGetOffsetQuaternion, dGeomGetQuaternion, dGeomID,
    dGeomIsEnabled, dGeomMoved, dGeomRaySetBackfaceCull, dGeomRaySetClosestHit, dGeomRaySetFirstContact,
    dGeomSetBody, dGeomSetCategoryBits, dGeomSetCollideBits, dGeomSetOffsetPosition,
    dGeomSetOffsetQuaternion, dGeomSetPosition, dGeomSetQuaternion, dSpaceAdd, dSpaceRemove,
};

use super::{GeomRecord, RayFlags};
use crate::hull::Aabb;
use crate::ode::arena::{BodyId, GeomId, SpaceId};
use crate::ode::shape::{checked, resize};
use crate::ode::world::World;
use crate::ode::{check, convert};
use crate::shape::Shape;
use crate::{Error, Result};

/// Read access to a geom of a [`World`].
#[derive(Debug, Clone, Copy)]
pub struct Geom<'w> {
    world: &'w World,
    record: &'w GeomRecord,
    id: GeomId,
}

impl<'w> Geom<'w> {
    pub(in crate::ode) fn new(world: &'w World, record: &'w GeomRecord, id: GeomId) -> Self {
        Self { world, record, id }
    }

    /// The geom's id.
    pub fn id(&self) -> GeomId {
        self.id
    }

    /// The geom's shape; `None` for a visual hull, and for an adopted geom whose shape ODE does not tell.
    pub fn shape(&self) -> Option<&'w Shape> {
        self.record.shape.as_ref()
    }

    /// The space that contains the geom.
    pub fn space(&self) -> SpaceId {
        SpaceId(self.record.space)
    }

    /// The body that the geom is attached to.
    pub fn body(&self) -> Option<BodyId> {
        // SAFETY: the view borrows the world, so the geom is alive, and so is its body.
        unsafe { self.world.body_id(dGeomGetBody(self.record.raw)) }
    }

    /// The transform from the geom's frame to the world's, including the body's pose and the offset. It is the identity
    /// for a plane.
    pub fn pose(&self) -> Isometry3<f64> {
        if !self.record.is_placeable() {
            return Isometry3::identity();
        }
        let (mut position, mut quaternion) = ([0.0; 4], [0.0; 4]);
        // SAFETY: the geom is alive and placeable, and both arrays hold four numbers.
        unsafe {
            dGeomCopyPosition(self.record.raw, position.as_mut_ptr());
            dGeomGetQuaternion(self.record.raw, quaternion.as_mut_ptr());
        }
        convert::pose(&position, &quaternion)
    }

    /// The transform from the geom's frame to its body's; the identity without a body.
    pub fn offset(&self) -> Isometry3<f64> {
        if !self.record.is_placeable() {
            return Isometry3::identity();
        }
        let (mut position, mut quaternion) = ([0.0; 4], [0.0; 4]);
        // SAFETY: the geom is alive and placeable, and both arrays hold four numbers.
        unsafe {
            dGeomCopyOffsetPosition(self.record.raw, position.as_mut_ptr());
            dGeomGetOffsetQuaternion(self.record.raw, quaternion.as_mut_ptr());
        }
        convert::pose(&position, &quaternion)
    }

    /// The geom's bounding box in the world's frame; infinite for most planes and for repeated heightfields.
    pub fn aabb(&self) -> Aabb {
        // SAFETY: the geom is alive.
        unsafe { convert::aabb_of(self.record.raw) }
    }

    /// The bits of the geom's categories. Two geoms can collide only if the categories of one have a bit in common with
    /// the [`collide_bits`](Self::collide_bits) of the other.
    pub fn category_bits(&self) -> u32 {
        // SAFETY: the geom is alive.
        let bits = unsafe { dGeomGetCategoryBits(self.record.raw) };
        bits as u32
    }

    /// The bits of the categories that the geom collides with, see [`category_bits`](Self::category_bits).
    pub fn collide_bits(&self) -> u32 {
        // SAFETY: the geom is alive.
        let bits = unsafe { dGeomGetCollideBits(self.record.raw) };
        bits as u32
    }

    /// Whether the geom is enabled. A disabled geom does not collide.
    pub fn is_enabled(&self) -> bool {
        // SAFETY: the geom is alive.
        unsafe { dGeomIsEnabled(self.record.raw) != 0 }
    }

    /// ODE's own id of the geom.
    ///
    /// # Safety
    ///
    /// The id is valid until the geom is removed, and its use must follow the rules of [`World::raw`].
    pub unsafe fn raw(&self) -> dGeomID {
        self.record.raw
    }
}

/// Write access to a geom of a [`World`].
#[derive(Debug)]
pub struct GeomMut<'w> {
    world: &'w mut World,
    id: GeomId,
    raw: dGeomID,
}

impl<'w> GeomMut<'w> {
    pub(in crate::ode) fn new(world: &'w mut World, id: GeomId) -> Self {
        let raw = world.geoms.expect(id).raw;
        Self { world, id, raw }
    }

    /// Read access to this geom.
    pub fn view(&self) -> Geom<'_> {
        self.world.geom(self.id)
    }

    /// Attaches the geom to a body, at the body's origin. `None` detaches it, and it stays where it is.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the body was removed, or if the geom is a plane.
    pub fn set_body(&mut self, body: Option<BodyId>) -> Result<()> {
        self.expect_placeable()?;
        let raw_body = match body {
            Some(body) => *self.world.bodies.find(body)?,
            None => std::ptr::null_mut(),
        };
        // SAFETY: both are alive, the geom is placeable, and no collide runs while the world is borrowed mutably.
        unsafe { dGeomSetBody(self.raw, raw_body) };
        Ok(())
    }

    /// Sets the transform from the geom's frame to the world's, for a geom without a body.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the pose is not finite or its position is beyond [`REACH`](crate::ode::REACH), for a
    /// plane, and for a geom on a body, whose pose follows from the body's.
    pub fn set_pose(&mut self, pose: &Isometry3<f64>) -> Result<()> {
        check::pose("pose of the geom", pose)?;
        self.expect_placeable()?;
        if self.view().body().is_some() {
            return Err(Error::argument(format!(
                "{:?}: expected a geom without a body, found one on a body: move the body, or set the offset",
                self.id
            )));
        }

        let (position, quaternion) = (pose.translation.vector, convert::ode_quaternion(&pose.rotation));
        // SAFETY: the geom is alive and placeable; the numbers are finite.
        unsafe {
            dGeomSetPosition(self.raw, position.x, position.y, position.z);
            dGeomSetQuaternion(self.raw, quaternion.as_ptr());
        }
        Ok(())
    }

    /// Sets the transform from the geom's frame to its body's.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the offset is not finite or beyond [`REACH`](crate::ode::REACH), or if the geom has no
    /// body.
    pub fn set_offset(&mut self, offset: &Isometry3<f64>) -> Result<()> {
        check::pose("offset of the geom", offset)?;
        if self.view().body().is_none() {
            return Err(Error::argument(format!(
                "{:?}: expected a geom on a body, found one without: call `set_body` first",
                self.id
            )));
        }

        let (position, quaternion) = (offset.translation.vector, convert::ode_quaternion(&offset.rotation));
        // SAFETY: the geom is alive and on a body, so it is placeable; the numbers are finite.
        unsafe {
            dGeomSetOffsetPosition(self.raw, position.x, position.y, position.z);
            dGeomSetOffsetQuaternion(self.raw, quaternion.as_ptr());
        }
        Ok(())
    }

    /// Moves the geom back to its body's origin. A geom without an offset is left alone.
    pub fn clear_offset(&mut self) {
        if self.view().record.is_placeable() {
            // SAFETY: the geom is alive and placeable.
            unsafe { dGeomClearOffset(self.raw) };
        }
    }

    /// Moves the geom to another space.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the space was removed.
    pub fn set_space(&mut self, space: SpaceId) -> Result<()> {
        let to = self.world.spaces.find(space)?.raw;
        let from = self.world.spaces.expect(self.view().space()).raw;

        self.world.wake_bodies_on(self.raw);
        // A geom keeps its "clean" flag when it changes spaces. Without `dGeomMoved` the new space would overlook it.
        // SAFETY: the geom is in `from`, both spaces are alive, and no collide is running.
        unsafe {
            dSpaceRemove(from, self.raw);
            dSpaceAdd(to, self.raw);
            dGeomMoved(self.raw);
        }

        if let Some(record) = self.world.geoms.get_mut(self.id.0) {
            record.space = space.0;
        }
        Ok(())
    }

    /// Changes the geom's sizes. The kind of shape stays the same; polyhedra, meshes and heightfields cannot be
    /// changed.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a shape of another kind, for a polyhedron, mesh or heightfield, and for sizes that
    /// [`World::add_geom`] refuses.
    pub fn set_shape(&mut self, shape: &Shape) -> Result<()> {
        let shape = checked(shape)?;

        let old = self.view().shape().cloned().ok_or_else(|| {
            Error::argument(format!(
                "{:?}: expected a geom that was added with a shape, found a visual hull or an adopted geom",
                self.id
            ))
        })?;

        // SAFETY: the geom is alive and was made from a shape of the kind of `old`, and the new sizes are checked.
        unsafe { resize(&old, self.raw, &shape)? };
        if let Some(record) = self.world.geoms.get_mut(self.id.0) {
            record.shape = Some(shape);
        }
        Ok(())
    }

    /// Sets a ray's origin and direction, both in the world's frame. The direction may have any length but 0.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a geom that is not a ray, for a ray on a body, and for numbers that are not finite.
    pub fn set_ray(&mut self, origin: &Point3<f64>, direction: &Vector3<f64>) -> Result<()> {
        self.expect_ray()?;
        let direction = check::direction("direction of the ray", direction)?;
        self.set_pose(&Isometry3::from_parts((*origin).into(), rotation_from_z(&direction)))
    }

    /// Sets the options for the hits of a ray.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a geom that is not a ray.
    pub fn set_ray_flags(&mut self, flags: RayFlags) -> Result<()> {
        self.expect_ray()?;
        // SAFETY: the geom is alive and a ray.
        unsafe {
            dGeomRaySetFirstContact(self.raw, flags.first_contact.into());
            dGeomRaySetBackfaceCull(self.raw, flags.backface_cull.into());
            dGeomRaySetClosestHit(self.raw, flags.closest_hit.into());
        }
        Ok(())
    }

    /// Sets the bits of the geom's categories, see [`Geom::category_bits`]. Bodies that sleep on a visual hull wake.
    pub fn set_category_bits(&mut self, bits: u32) {
        self.world.wake_bodies_on(self.raw);
        // SAFETY: the geom is alive.
        unsafe { dGeomSetCategoryBits(self.raw, bits.into()) };
    }

    /// Sets the bits of the categories that the geom collides with, see [`Geom::category_bits`]. Bodies that
    /// sleep on a visual hull wake.
    pub fn set_collide_bits(&mut self, bits: u32) {
        self.world.wake_bodies_on(self.raw);
        // SAFETY: the geom is alive.
        unsafe { dGeomSetCollideBits(self.raw, bits.into()) };
    }

    /// Enables or disables the geom. A disabled geom does not collide. Bodies that sleep on a visual hull wake when it is
    /// disabled.
    pub fn set_enabled(&mut self, enabled: bool) {
        if !enabled {
            self.world.wake_bodies_on(self.raw);
        }
        // SAFETY: the geom is alive.
        unsafe { if enabled { dGeomEnable(self.raw) } else { dGeomDisable(self.raw) } };
    }

    fn expect_placeable(&self) -> Result<()> {
        if self.view().record.is_placeable() {
            Ok(())
        } else {
            Err(Error::argument(format!(
                "{:?}: expected a geom that can be placed, found a plane: call `set_shape` instead",
                self.id
            )))
        }
    }

    fn expect_ray(&self) -> Result<()> {
        match self.view().shape() {
            Some(Shape::Ray { .. }) => Ok(()),
            other => Err(Error::argument(format!("{:?}: expected a ray, found {other:?}", self.id))),
        }
    }
}

/// A rotation that maps the z axis to `direction`.
fn rotation_from_z(direction: &Unit<Vector3<f64>>) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between_axis(&Vector3::z_axis(), direction)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI))
}
