//! Geoms: shapes that collide.

use nalgebra::{Isometry3, Point3, Unit, UnitQuaternion, Vector3};
use ode_sys::{
    dGeomClearOffset, dGeomCopyOffsetPosition, dGeomCopyPosition, dGeomDestroy, dGeomDisable, dGeomEnable,
    dGeomGetAABB, dGeomGetBody, dGeomGetCategoryBits, dGeomGetCollideBits, dGeomGetOffsetQuaternion,
    dGeomGetQuaternion, dGeomID, dGeomIsEnabled, dGeomMoved, dGeomRaySetBackfaceCull, dGeomRaySetClosestHit,
    dGeomRaySetFirstContact, dGeomSetBody, dGeomSetCategoryBits, dGeomSetCollideBits, dGeomSetData,
    dGeomSetOffsetPosition, dGeomSetOffsetQuaternion, dGeomSetPosition, dGeomSetQuaternion, dSpaceAdd,
    dSpaceRemove,
};

use super::arena::{BodyId, GeomId, Key, SpaceId};
use super::shape::Shape;
use super::trimesh::MeshData;
use super::world::World;
use super::{check, convert};
use crate::hull::Aabb;
use crate::{Error, Result};

/// A geom of ODE that a world owns, and what it borrows from.
#[derive(Debug)]
pub(super) struct GeomRecord {
    pub(super) raw: dGeomID,
    pub(super) space: Key,
    /// `None` for classes that are not ODE's own.
    shape: Option<Shape>,
    /// Borrows from `shape`.
    _mesh: Option<MeshData>,
}

/// What a ray reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RayFlags {
    /// Any hit with a mesh will do.
    pub first_contact: bool,
    /// Triangles that face away are not hit.
    pub backface_cull: bool,
    /// Only the nearest hit with a mesh.
    pub closest_hit: bool,
}

impl World {
    /// A geom of this shape in `space`, at the origin.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the space is gone, or for sizes that are not positive, finite and within
    /// [`REACH`](super::REACH); [`Error::Ode`] if there is no memory.
    pub fn add_geom(&mut self, space: SpaceId, shape: &Shape) -> Result<GeomId> {
        let into = self.spaces.find(space)?.raw;
        let shape = shape.checked()?;
        // SAFETY: ODE is open as long as the world lives; the record keeps the shape and the search tree for as long
        // as the geom.
        let (raw, mesh) = unsafe { shape.create()? };
        // SAFETY: both were found alive, and a new geom is in no space.
        unsafe { dSpaceAdd(into, raw) };
        Ok(self.keep_geom(GeomRecord { raw, space: space.0, shape: Some(shape), _mesh: mesh }))
    }

    /// Takes over a geom of a class that is not ODE's own, and puts it into `space`.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the space is gone; the geom is destroyed then.
    ///
    /// # Safety
    ///
    /// `raw` is a living, placeable geom in no space and on no body, which nobody else destroys. Its class gives
    /// boxes without NaN, and finite ones within 3 [`REACH`](super::REACH).
    pub(super) unsafe fn insert_geom(&mut self, space: SpaceId, raw: dGeomID) -> Result<GeomId> {
        let into = match self.spaces.find(space) {
            Ok(record) => record.raw,
            Err(error) => {
                // SAFETY: the geom is the caller's to give away.
                unsafe { dGeomDestroy(raw) };
                return Err(error);
            }
        };
        // SAFETY: the space was found alive, the geom is in none.
        unsafe { dSpaceAdd(into, raw) };
        Ok(self.keep_geom(GeomRecord { raw, space: space.0, shape: None, _mesh: None }))
    }

    fn keep_geom(&mut self, record: GeomRecord) -> GeomId {
        let raw = record.raw;
        let key = self.geoms.insert(record);
        // SAFETY: the geom is alive, and its user data is the world's to set.
        unsafe { dGeomSetData(raw, key.user_data() as *mut _) };
        GeomId(key)
    }
}

/// A geom to read.
#[derive(Debug, Clone, Copy)]
pub struct Geom<'w> {
    world: &'w World,
    record: &'w GeomRecord,
    id: GeomId,
}

impl<'w> Geom<'w> {
    pub(super) fn new(world: &'w World, record: &'w GeomRecord, id: GeomId) -> Self {
        Self { world, record, id }
    }

    /// Its id.
    pub fn id(&self) -> GeomId {
        self.id
    }

    /// Its shape; `None` for a visual hull.
    pub fn shape(&self) -> Option<&'w Shape> {
        self.record.shape.as_ref()
    }

    /// The space that it is in.
    pub fn space(&self) -> SpaceId {
        SpaceId(self.record.space)
    }

    /// The body that carries it.
    pub fn body(&self) -> Option<BodyId> {
        // SAFETY: the view borrows the world, so the geom is alive, and so is its body.
        unsafe { self.world.body_id(dGeomGetBody(self.record.raw)) }
    }

    /// Where it is in the world, with the body's pose and the offset; the identity for a plane.
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

    /// Where it is on its body; the identity without a body.
    pub fn offset(&self) -> Isometry3<f64> {
        if !self.record.is_placeable() {
            return Isometry3::identity();
        }
        let (mut position, mut quaternion) = ([0.0; 4], [0.0; 4]);
        // SAFETY: as in `pose`.
        unsafe {
            dGeomCopyOffsetPosition(self.record.raw, position.as_mut_ptr());
            dGeomGetOffsetQuaternion(self.record.raw, quaternion.as_mut_ptr());
        }
        convert::pose(&position, &quaternion)
    }

    /// The box around it; infinite for most planes.
    pub fn aabb(&self) -> Aabb {
        let mut bounds = [0.0; 6];
        // SAFETY: the geom is alive, and the array holds six numbers.
        unsafe { dGeomGetAABB(self.record.raw, bounds.as_mut_ptr()) };
        let [x0, x1, y0, y1, z0, z1] = bounds;
        Aabb { min: Point3::new(x0, y0, z0), max: Point3::new(x1, y1, z1) }
    }

    /// What it is: pairs are looked at where one's category meets the other's [`collide_bits`](Self::collide_bits).
    pub fn category_bits(&self) -> u32 {
        // SAFETY: the geom is alive.
        let bits = unsafe { dGeomGetCategoryBits(self.record.raw) };
        bits as u32
    }

    /// What it collides with.
    pub fn collide_bits(&self) -> u32 {
        // SAFETY: the geom is alive.
        let bits = unsafe { dGeomGetCollideBits(self.record.raw) };
        bits as u32
    }

    /// Whether it collides at all.
    pub fn is_enabled(&self) -> bool {
        // SAFETY: the geom is alive.
        unsafe { dGeomIsEnabled(self.record.raw) != 0 }
    }

    /// ODE's own id.
    ///
    /// # Safety
    ///
    /// Valid until the geom is removed. As for [`World::raw`].
    pub unsafe fn raw(&self) -> dGeomID {
        self.record.raw
    }
}

impl GeomRecord {
    fn is_placeable(&self) -> bool {
        self.shape.as_ref().is_none_or(Shape::is_placeable)
    }
}

/// A geom to change.
#[derive(Debug)]
pub struct GeomMut<'w> {
    world: &'w mut World,
    id: GeomId,
    raw: dGeomID,
}

impl<'w> GeomMut<'w> {
    pub(super) fn new(world: &'w mut World, id: GeomId) -> Self {
        let raw = world.geoms.expect(id).raw;
        Self { world, id, raw }
    }

    /// The same geom to read.
    pub fn view(&self) -> Geom<'_> {
        self.world.geom(self.id)
    }

    /// Puts the geom on a body, at the body's origin, or takes it off: then it stays where it is.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the body is gone, or if the geom is a plane.
    pub fn set_body(&mut self, body: Option<BodyId>) -> Result<()> {
        self.expect_placeable()?;
        let raw_body = match body {
            Some(body) => *self.world.bodies.find(body)?,
            None => std::ptr::null_mut(),
        };
        // SAFETY: both are alive, the geom is placeable, and nothing collides while the world is borrowed mutably.
        unsafe { dGeomSetBody(self.raw, raw_body) };
        Ok(())
    }

    /// Places a geom that has no body.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the pose is not finite or beyond [`REACH`](super::REACH), for a plane, and for a geom on
    /// a body, which the body places.
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

    /// Places the geom on its body, away from the body's origin.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the offset is not finite or beyond [`REACH`](super::REACH), or without a body.
    pub fn set_offset(&mut self, offset: &Isometry3<f64>) -> Result<()> {
        check::pose("offset of the geom", offset)?;
        if self.view().body().is_none() {
            return Err(Error::argument(format!(
                "{:?}: expected a geom on a body, found one without",
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

    /// Puts the geom back to its body's origin. Nothing happens without an offset.
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
    /// [`Error::Argument`] if the space is gone.
    pub fn set_space(&mut self, space: SpaceId) -> Result<()> {
        let to = self.world.spaces.find(space)?.raw;
        let from = self.world.spaces.expect(self.view().space()).raw;
        // SAFETY: the geom is in `from`, both spaces are alive and nothing collides. A geom keeps its "clean" mark
        // when it changes spaces, so that the new space would overlook it without the last call.
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

    /// Gives the geom other sizes. The kind of shape stays, and polyhedra and meshes cannot be changed.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a shape of another kind, and for sizes as in [`World::add_geom`].
    pub fn set_shape(&mut self, shape: &Shape) -> Result<()> {
        let shape = shape.checked()?;
        let old = self.view().shape().cloned().ok_or_else(|| {
            Error::argument(format!(
                "{:?}: expected a geom of one of ODE's shapes, found a visual hull",
                self.id
            ))
        })?;
        // SAFETY: the geom is alive, was made from a shape of the kind of `old`, and the new sizes are checked.
        unsafe { old.resize(self.raw, &shape)? };
        if let Some(record) = self.world.geoms.get_mut(self.id.0) {
            record.shape = Some(shape);
        }
        Ok(())
    }

    /// Lets a ray start at `origin` towards `direction`.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a geom that is not a ray or is on a body, and for numbers that are not finite.
    pub fn set_ray(&mut self, origin: &Point3<f64>, direction: &Vector3<f64>) -> Result<()> {
        self.expect_ray()?;
        let direction = check::direction("direction of the ray", direction)?;
        self.set_pose(&Isometry3::from_parts((*origin).into(), rotation_from_z(&direction)))
    }

    /// What a ray reports.
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

    /// What the geom is, see [`Geom::category_bits`].
    pub fn set_category_bits(&mut self, bits: u32) {
        // SAFETY: the geom is alive.
        unsafe { dGeomSetCategoryBits(self.raw, bits.into()) };
    }

    /// What the geom collides with, see [`Geom::category_bits`].
    pub fn set_collide_bits(&mut self, bits: u32) {
        // SAFETY: the geom is alive.
        unsafe { dGeomSetCollideBits(self.raw, bits.into()) };
    }

    /// Whether the geom collides at all.
    pub fn set_enabled(&mut self, enabled: bool) {
        // SAFETY: the geom is alive.
        unsafe { if enabled { dGeomEnable(self.raw) } else { dGeomDisable(self.raw) } };
    }

    fn expect_placeable(&self) -> Result<()> {
        if self.view().record.is_placeable() {
            Ok(())
        } else {
            Err(Error::argument(format!(
                "{:?}: expected a geom that can be placed, found a plane: change its shape instead",
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

/// A rotation that takes the z axis to `direction`.
fn rotation_from_z(direction: &Unit<Vector3<f64>>) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between_axis(&Vector3::z_axis(), direction)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI))
}
