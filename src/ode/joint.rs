//! Joints: what holds two bodies together, or a body to the world.

use nalgebra::{Point3, Vector3};
use ode_sys::*;

use super::arena::{Arena, BodyId, JointGroupId, JointId, Key};
use super::collide::{ContactGeom, create_contact};
use super::surface::Surface;
use super::world::World;
use super::{check, convert};
use crate::{Error, Result};

/// A joint to be made: its kind, and where it is, in the world's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointKind {
    /// Both bodies share a point.
    Ball {
        /// That point.
        anchor: Point3<f64>,
    },
    /// Both bodies share an axis, and turn about it. The angle is 0 where they are now.
    Hinge {
        /// A point of the axis.
        anchor: Point3<f64>,
        /// Its direction; any length but 0.
        axis: Vector3<f64>,
    },
    /// Both bodies keep their relative rotation, and move along an axis. The position is 0 where they are now.
    Slider {
        /// Its direction; any length but 0.
        axis: Vector3<f64>,
    },
    /// Both bodies stay as they are to each other.
    Fixed,
    /// The bodies do not move into each other at a point. A contact lasts until it is removed.
    Contact {
        /// Where they touch; the normal points into the first body.
        contact: ContactGeom,
        /// How they act on each other.
        surface: Surface,
    },
}

/// The kind of a joint that exists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "see `JointKind`")]
pub enum JointType {
    Ball,
    Hinge,
    Slider,
    Fixed,
    Contact,
}

/// A number of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum JointParam {
    /// Lowest angle (rad, above -pi to act) or position (m); minus infinity is none.
    LowStop,
    /// Highest angle (rad, below pi to act) or position (m); infinity is none.
    HighStop,
    /// What the motor aims at, rad/s or m/s.
    MotorVelocity,
    /// The largest torque (N m) or force (N) of the motor; 0 is no motor.
    MotorMaxForce,
    /// How much of an excess force at a stop is left, 0 to 1.
    FudgeFactor,
    /// Restitution of the stops, 0 to 1.
    Bounce,
    /// Constraint force mixing away from the stops; of ball and fixed joints, of the joint itself.
    Cfm,
    /// Error reduction of ball and fixed joints.
    Erp,
    /// Error reduction of the stops.
    StopErp,
    /// Constraint force mixing of the stops.
    StopCfm,
}

/// A joint of ODE that a world owns.
#[derive(Debug)]
pub(super) struct JointRecord {
    pub(super) raw: dJointID,
    pub(super) group: Option<Key>,
    kind: JointType,
}

/// A group of ODE that a world owns.
#[derive(Debug)]
pub(super) struct GroupRecord {
    pub(super) raw: dJointGroupID,
    members: Vec<Key>,
}

impl JointKind {
    /// Its kind alone.
    pub fn joint_type(&self) -> JointType {
        match self {
            Self::Ball { .. } => JointType::Ball,
            Self::Hinge { .. } => JointType::Hinge,
            Self::Slider { .. } => JointType::Slider,
            Self::Fixed => JointType::Fixed,
            Self::Contact { .. } => JointType::Contact,
        }
    }

    fn check(&self) -> Result<()> {
        if let Self::Ball { anchor } | Self::Hinge { anchor, .. } = self {
            check::point("anchor of the joint", anchor)?;
        }
        if let Self::Hinge { axis, .. } | Self::Slider { axis } = self {
            check::direction("axis of the joint", axis)?;
        }
        Ok(())
    }

    /// # Safety
    ///
    /// `world` is alive, `group` null or alive, `bodies` null or alive and of `world`, not both null and not equal.
    unsafe fn create(&self, world: dWorldID, group: dJointGroupID, bodies: [dBodyID; 2]) -> Result<dJointID> {
        self.check()?;
        let [first, second] = bodies;
        // SAFETY: as the caller vouches; the axes have a length.
        unsafe {
            let raw = match self {
                Self::Ball { .. } => dJointCreateBall(world, group),
                Self::Hinge { .. } => dJointCreateHinge(world, group),
                Self::Slider { .. } => dJointCreateSlider(world, group),
                Self::Fixed => dJointCreateFixed(world, group),
                Self::Contact { contact, surface } => {
                    return create_contact(world, group, bodies, contact, surface);
                }
            };
            dJointAttach(raw, first, second);
            match *self {
                Self::Ball { anchor } => dJointSetBallAnchor(raw, anchor.x, anchor.y, anchor.z),
                Self::Hinge { anchor, axis } => {
                    dJointSetHingeAnchor(raw, anchor.x, anchor.y, anchor.z);
                    dJointSetHingeAxis(raw, axis.x, axis.y, axis.z);
                }
                Self::Slider { axis } => dJointSetSliderAxis(raw, axis.x, axis.y, axis.z),
                Self::Fixed => dJointSetFixed(raw),
                Self::Contact { .. } => {}
            }
            Ok(raw)
        }
    }
}

impl World {
    /// A joint between two bodies, or between one and the world (`None`).
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if a body is gone, if there is none or twice the same, or for numbers that are not finite
    /// and axes of length 0.
    pub fn add_joint(&mut self, bodies: [Option<BodyId>; 2], kind: &JointKind) -> Result<JointId> {
        self.create_joint(bodies, kind, None)
    }

    /// The same as [`add_joint`](Self::add_joint), in a group, to be removed together with the group's others.
    ///
    /// # Errors
    ///
    /// As [`add_joint`](Self::add_joint), and if the group is gone.
    pub fn add_joint_in(
        &mut self,
        group: JointGroupId,
        bodies: [Option<BodyId>; 2],
        kind: &JointKind,
    ) -> Result<JointId> {
        self.create_joint(bodies, kind, Some(group))
    }

    fn create_joint(
        &mut self,
        bodies: [Option<BodyId>; 2],
        kind: &JointKind,
        group: Option<JointGroupId>,
    ) -> Result<JointId> {
        let raw_bodies = self.raw_pair(bodies)?;
        let raw_group = match group {
            Some(group) => self.groups.find(group)?.raw,
            None => std::ptr::null_mut(),
        };
        // SAFETY: the world is alive, group and bodies were found alive in it.
        let raw = unsafe { kind.create(self.raw, raw_group, raw_bodies)? };
        let key = self.joints.insert(JointRecord {
            raw,
            group: group.map(|group| group.0),
            kind: kind.joint_type(),
        });
        if let Some(group) = group.and_then(|group| self.groups.get_mut(group.0)) {
            group.members.push(key);
        }
        Ok(JointId(key))
    }

    /// Two bodies as ODE takes them.
    fn raw_pair(&self, bodies: [Option<BodyId>; 2]) -> Result<[dBodyID; 2]> {
        if bodies[0] == bodies[1] {
            return Err(Error::argument(format!("joint: expected two different bodies, found {bodies:?}")));
        }
        let raw =
            |id: Option<BodyId>| id.map_or(Ok(std::ptr::null_mut()), |id| self.bodies.find(id).copied());
        Ok([raw(bodies[0])?, raw(bodies[1])?])
    }

    /// Removes a joint; false if it was gone already.
    pub fn remove_joint(&mut self, id: JointId) -> bool {
        let Some(record) = self.joints.remove(id.0) else { return false };
        // SAFETY: the record was alive, and is gone now. ODE destroys the joints of a group only together: one that
        // is attached to nothing no longer acts.
        unsafe {
            match record.group {
                None => dJointDestroy(record.raw),
                Some(_) => dJointAttach(record.raw, std::ptr::null_mut(), std::ptr::null_mut()),
            }
        }
        true
    }

    /// Whether the joint is there.
    pub fn contains_joint(&self, id: JointId) -> bool {
        self.joints.get(id.0).is_some()
    }

    /// All joints, without the contacts of [`collide`](Self::collide).
    pub fn joints(&self) -> impl Iterator<Item = JointId> + '_ {
        self.joints.iter().map(|(key, _)| JointId(key))
    }

    /// A joint to read.
    ///
    /// # Panics
    ///
    /// If the joint was removed, or is of another world. [`get_joint`](Self::get_joint) does not.
    #[track_caller]
    pub fn joint(&self, id: JointId) -> Joint<'_> {
        Joint { world: self, record: self.joints.expect(id), id }
    }

    /// A joint to read, if it is there.
    pub fn get_joint(&self, id: JointId) -> Option<Joint<'_>> {
        self.joints.get(id.0).map(|record| Joint { world: self, record, id })
    }

    /// A joint to change.
    ///
    /// # Panics
    ///
    /// If the joint was removed, or is of another world.
    #[track_caller]
    pub fn joint_mut(&mut self, id: JointId) -> JointMut<'_> {
        self.joints.expect(id);
        JointMut { world: self, id }
    }

    /// A new, empty group of joints.
    pub fn add_joint_group(&mut self) -> JointGroupId {
        // SAFETY: ODE is open as long as the world lives.
        let raw = unsafe { dJointGroupCreate(0) };
        JointGroupId(self.groups.insert(GroupRecord { raw, members: Vec::new() }))
    }

    /// Removes all joints of a group.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the group is gone.
    pub fn empty_joint_group(&mut self, id: JointGroupId) -> Result<()> {
        let raw = self.groups.find(id)?.raw;
        if let Some(group) = self.groups.get_mut(id.0) {
            forget(&mut self.joints, &mut group.members);
        }
        // SAFETY: the group is alive, and no record of its joints is left.
        unsafe { dJointGroupEmpty(raw) };
        Ok(())
    }

    /// Removes a group with its joints; false if it was gone already.
    pub fn remove_joint_group(&mut self, id: JointGroupId) -> bool {
        let Some(mut record) = self.groups.remove(id.0) else { return false };
        forget(&mut self.joints, &mut record.members);
        // SAFETY: the record was alive and is gone now, as are the records of the group's joints.
        unsafe { dJointGroupDestroy(record.raw) };
        true
    }

    /// Whether the group is there.
    pub fn contains_joint_group(&self, id: JointGroupId) -> bool {
        self.groups.get(id.0).is_some()
    }
}

fn forget(joints: &mut Arena<JointRecord>, members: &mut Vec<Key>) {
    for key in members.drain(..) {
        joints.remove(key);
    }
}

/// A joint to read. What a kind of joint does not have, and what depends on bodies that were removed, is `None`.
#[derive(Debug, Clone, Copy)]
pub struct Joint<'w> {
    world: &'w World,
    record: &'w JointRecord,
    id: JointId,
}

impl Joint<'_> {
    /// Its id.
    pub fn id(&self) -> JointId {
        self.id
    }

    /// Its kind.
    pub fn joint_type(&self) -> JointType {
        self.record.kind
    }

    /// The bodies that it joins.
    pub fn bodies(&self) -> [Option<BodyId>; 2] {
        // SAFETY: the view borrows the world, so the joint is alive, and so are its bodies.
        [0, 1].map(|index| unsafe { self.world.body_id(dJointGetBody(self.record.raw, index)) })
    }

    /// Whether it joins anything: not after both of its bodies were taken away.
    pub fn is_attached(&self) -> bool {
        // SAFETY: the joint is alive.
        unsafe { dJointGetNumBodies(self.record.raw) > 0 }
    }

    /// Whether it acts.
    pub fn is_enabled(&self) -> bool {
        // SAFETY: the joint is alive.
        unsafe { dJointIsEnabled(self.record.raw) != 0 }
    }

    /// The point of the first body that is held, in the world.
    pub fn anchor(&self) -> Option<Point3<f64>> {
        self.vector(dJointGetBallAnchor, dJointGetHingeAnchor).map(Point3::from)
    }

    /// The same point of the second body, or of the world. How far the two are apart is the joint's error.
    pub fn anchor2(&self) -> Option<Point3<f64>> {
        self.vector(dJointGetBallAnchor2, dJointGetHingeAnchor2).map(Point3::from)
    }

    fn vector(&self, ball: VectorGetter, hinge: VectorGetter) -> Option<Vector3<f64>> {
        let get = match self.record.kind {
            JointType::Ball => ball,
            JointType::Hinge => hinge,
            JointType::Slider | JointType::Fixed | JointType::Contact => return None,
        };
        self.read(get)
    }

    /// The axis of a hinge or slider, a unit vector in the world.
    pub fn axis(&self) -> Option<Vector3<f64>> {
        match self.record.kind {
            JointType::Hinge => self.read(dJointGetHingeAxis),
            JointType::Slider => self.read(dJointGetSliderAxis),
            JointType::Ball | JointType::Fixed | JointType::Contact => None,
        }
    }

    fn read(&self, get: VectorGetter) -> Option<Vector3<f64>> {
        let mut vector = [0.0; 4];
        // SAFETY: the joint is alive and of the kind that `get` takes; the array holds four numbers.
        self.is_attached().then(|| unsafe { get(self.record.raw, vector.as_mut_ptr()) })?;
        Some(convert::vector(&vector))
    }

    /// The angle of a hinge, rad.
    pub fn angle(&self) -> Option<f64> {
        self.number(JointType::Hinge, dJointGetHingeAngle)
    }

    /// The angular velocity of a hinge, rad/s.
    pub fn angle_rate(&self) -> Option<f64> {
        self.number(JointType::Hinge, dJointGetHingeAngleRate)
    }

    /// The position of a slider, m.
    pub fn position(&self) -> Option<f64> {
        self.number(JointType::Slider, dJointGetSliderPosition)
    }

    /// The velocity of a slider, m/s.
    pub fn position_rate(&self) -> Option<f64> {
        self.number(JointType::Slider, dJointGetSliderPositionRate)
    }

    fn number(&self, kind: JointType, get: unsafe extern "C" fn(dJointID) -> dReal) -> Option<f64> {
        // SAFETY: the joint is alive and of the kind that `get` takes. Without a body ODE reads through a null pointer.
        (self.record.kind == kind && self.is_attached()).then(|| unsafe { get(self.record.raw) })
    }

    /// A number of the joint, if its kind has it.
    pub fn param(&self, param: JointParam) -> Option<f64> {
        let get = match self.record.kind {
            JointType::Ball => dJointGetBallParam,
            JointType::Hinge => dJointGetHingeParam,
            JointType::Slider => dJointGetSliderParam,
            JointType::Fixed => dJointGetFixedParam,
            JointType::Contact => return None,
        };
        // SAFETY: the joint is alive and of the kind that `get` takes.
        param.is_of(self.record.kind).then(|| unsafe { get(self.record.raw, param.number()) })
    }

    /// ODE's own id.
    ///
    /// # Safety
    ///
    /// Valid until the joint is removed. As for [`World::raw`].
    pub unsafe fn raw(&self) -> dJointID {
        self.record.raw
    }
}

type VectorGetter = unsafe extern "C" fn(dJointID, *mut dReal);

/// A joint to change.
#[derive(Debug)]
pub struct JointMut<'w> {
    world: &'w mut World,
    id: JointId,
}

impl JointMut<'_> {
    /// The same joint to read.
    pub fn view(&self) -> Joint<'_> {
        self.world.joint(self.id)
    }

    fn raw(&self) -> dJointID {
        self.world.joints.expect(self.id).raw
    }

    /// Lets the joint hold other bodies, as they are now.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if a body is gone, if there is none or twice the same.
    pub fn attach(&mut self, bodies: [Option<BodyId>; 2]) -> Result<()> {
        let [first, second] = self.world.raw_pair(bodies)?;
        // SAFETY: joint and bodies are alive and of one world; there is one body at least, and not twice the same.
        unsafe { dJointAttach(self.raw(), first, second) };
        Ok(())
    }

    /// Sets where a ball joint or hinge holds its bodies, in the world.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for other kinds, without bodies, and for numbers that are not finite.
    pub fn set_anchor(&mut self, anchor: &Point3<f64>) -> Result<()> {
        check::point("anchor of the joint", anchor)?;
        let set = match self.view().joint_type() {
            JointType::Ball => dJointSetBallAnchor,
            JointType::Hinge => dJointSetHingeAnchor,
            other => return Err(self.has_no("anchor", other)),
        };
        self.expect_attached()?;
        // SAFETY: the joint is alive, has a body, and is of the kind that `set` takes.
        unsafe { set(self.raw(), anchor.x, anchor.y, anchor.z) };
        Ok(())
    }

    /// Sets the axis of a hinge or slider, in the world. Its angle or position becomes 0 where the bodies are now.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for other kinds, without bodies, and for axes that are not finite or have no length.
    pub fn set_axis(&mut self, axis: &Vector3<f64>) -> Result<()> {
        let axis = check::direction("axis of the joint", axis)?;
        let set = match self.view().joint_type() {
            JointType::Hinge => dJointSetHingeAxis,
            JointType::Slider => dJointSetSliderAxis,
            other => return Err(self.has_no("axis", other)),
        };
        self.expect_attached()?;
        // SAFETY: the joint is alive, has a body, and is of the kind that `set` takes; the axis has a length.
        unsafe { set(self.raw(), axis.x, axis.y, axis.z) };
        Ok(())
    }

    /// Sets a number of the joint.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if this kind of joint does not have it, for NaN, and for numbers out of range.
    pub fn set_param(&mut self, param: JointParam, value: f64) -> Result<()> {
        let kind = self.view().joint_type();
        let set = match kind {
            JointType::Ball => dJointSetBallParam,
            JointType::Hinge => dJointSetHingeParam,
            JointType::Slider => dJointSetSliderParam,
            JointType::Fixed => dJointSetFixedParam,
            JointType::Contact => return Err(self.has_no("parameter", kind)),
        };
        if !param.is_of(kind) {
            return Err(self.has_no(&format!("{param:?}"), kind));
        }
        param.check(value)?;
        // SAFETY: the joint is alive and of the kind that `set` takes; the number is checked.
        unsafe { set(self.raw(), param.number(), value) };
        Ok(())
    }

    /// Whether the joint acts.
    pub fn set_enabled(&mut self, enabled: bool) {
        // SAFETY: the joint is alive.
        unsafe { if enabled { dJointEnable(self.raw()) } else { dJointDisable(self.raw()) } };
    }

    fn has_no(&self, what: &str, kind: JointType) -> Error {
        Error::argument(format!(
            "{:?}: expected a joint with {what}, found a joint of type {kind:?}",
            self.id
        ))
    }

    fn expect_attached(&self) -> Result<()> {
        if self.view().is_attached() {
            Ok(())
        } else {
            Err(Error::argument(format!(
                "{:?}: expected a joint with a body, found none: attach it",
                self.id
            )))
        }
    }
}

impl JointParam {
    fn number(self) -> i32 {
        let number = match self {
            Self::LowStop => dParamLoStop,
            Self::HighStop => dParamHiStop,
            Self::MotorVelocity => dParamVel,
            Self::MotorMaxForce => dParamFMax,
            Self::FudgeFactor => dParamFudgeFactor,
            Self::Bounce => dParamBounce,
            Self::Cfm => dParamCFM,
            Self::Erp => dParamERP,
            Self::StopErp => dParamStopERP,
            Self::StopCfm => dParamStopCFM,
        };
        number as i32
    }

    fn is_of(self, kind: JointType) -> bool {
        match kind {
            JointType::Hinge | JointType::Slider => self != Self::Erp,
            JointType::Ball | JointType::Fixed => matches!(self, Self::Erp | Self::Cfm),
            JointType::Contact => false,
        }
    }

    fn check(self, value: f64) -> Result<()> {
        let name = format!("{self:?} of the joint");
        match self {
            Self::LowStop if value == f64::NEG_INFINITY => Ok(value),
            Self::HighStop if value == f64::INFINITY => Ok(value),
            Self::LowStop | Self::HighStop | Self::MotorVelocity => check::finite(&name, value),
            Self::MotorMaxForce | Self::Cfm | Self::StopCfm => check::not_negative(&name, value),
            Self::FudgeFactor | Self::Bounce | Self::Erp | Self::StopErp => {
                check::within(&name, value, 0.0, 1.0)
            }
        }
        .map(|_| ())
    }
}
