//! Read and write access to joints.

use nalgebra::{Point3, Vector3};
use ode_sys::*;

use super::{JointParam, JointRecord, JointType};
use crate::ode::arena::{BodyId, JointId};
use crate::ode::world::World;
use crate::ode::{check, convert};
use crate::{Error, Result};

/// Read access to a joint.
///
/// A value is `None` if this kind of joint does not have it, or if the bodies it depends on were removed.
#[derive(Debug, Clone, Copy)]
pub struct Joint<'w> {
    world: &'w World,
    record: &'w JointRecord,
    id: JointId,
}

impl<'w> Joint<'w> {
    pub(super) fn new(world: &'w World, record: &'w JointRecord, id: JointId) -> Self {
        Self { world, record, id }
    }

    /// The joint's id.
    pub fn id(&self) -> JointId {
        self.id
    }

    /// The joint's kind.
    pub fn joint_type(&self) -> JointType {
        self.record.kind
    }

    /// The bodies that the joint connects; `None` stands for the world.
    pub fn bodies(&self) -> [Option<BodyId>; 2] {
        // SAFETY: the view borrows the world, so the joint is alive, and so are its bodies.
        [0, 1].map(|index| unsafe { self.world.body_id(dJointGetBody(self.record.raw, index)) })
    }

    /// Whether the joint is attached to a body. It is not after its bodies were removed.
    pub fn is_attached(&self) -> bool {
        // SAFETY: the joint is alive.
        unsafe { dJointGetNumBodies(self.record.raw) > 0 }
    }

    /// Whether the joint is enabled. A disabled joint has no effect.
    pub fn is_enabled(&self) -> bool {
        // SAFETY: the joint is alive.
        unsafe { dJointIsEnabled(self.record.raw) != 0 }
    }

    /// The anchor of a ball joint or hinge as a point of the first body, in the world's frame.
    pub fn anchor(&self) -> Option<Point3<f64>> {
        self.anchor_with(dJointGetBallAnchor, dJointGetHingeAnchor).map(Point3::from)
    }

    /// The anchor of a ball joint or hinge as a point of the second body, or of the world, in the world's frame. Its
    /// distance from [`anchor`](Self::anchor) is the joint's error.
    pub fn anchor2(&self) -> Option<Point3<f64>> {
        self.anchor_with(dJointGetBallAnchor2, dJointGetHingeAnchor2).map(Point3::from)
    }

    fn anchor_with(&self, ball: VectorGetter, hinge: VectorGetter) -> Option<Vector3<f64>> {
        let get = match self.record.kind {
            JointType::Ball => ball,
            JointType::Hinge => hinge,
            JointType::Slider | JointType::Fixed | JointType::Contact => return None,
        };
        self.read(get)
    }

    /// The axis of a hinge or slider, as a unit vector in the world's frame.
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

    /// The angle of a hinge, in radians.
    pub fn angle(&self) -> Option<f64> {
        self.number(JointType::Hinge, dJointGetHingeAngle)
    }

    /// The angular velocity of a hinge, rad/s.
    pub fn angle_rate(&self) -> Option<f64> {
        self.number(JointType::Hinge, dJointGetHingeAngleRate)
    }

    /// The position of a slider, in metres.
    pub fn position(&self) -> Option<f64> {
        self.number(JointType::Slider, dJointGetSliderPosition)
    }

    /// The velocity of a slider, m/s.
    pub fn position_rate(&self) -> Option<f64> {
        self.number(JointType::Slider, dJointGetSliderPositionRate)
    }

    fn number(&self, kind: JointType, get: unsafe extern "C" fn(dJointID) -> dReal) -> Option<f64> {
        // SAFETY: the joint is alive, of the kind that `get` takes, and attached: without a body ODE would read through
        // a null pointer.
        (self.record.kind == kind && self.is_attached()).then(|| unsafe { get(self.record.raw) })
    }

    /// A parameter of the joint, if its kind has it.
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

    /// ODE's own id of the joint.
    ///
    /// # Safety
    ///
    /// The id is valid until the joint is removed, and its use must follow the rules of [`World::raw`].
    pub unsafe fn raw(&self) -> dJointID {
        self.record.raw
    }
}

/// The type of ODE's functions that write a joint's anchor or axis.
type VectorGetter = unsafe extern "C" fn(dJointID, *mut dReal);

/// Write access to a joint.
#[derive(Debug)]
pub struct JointMut<'w> {
    world: &'w mut World,
    id: JointId,
}

impl<'w> JointMut<'w> {
    pub(super) fn new(world: &'w mut World, id: JointId) -> Self {
        Self { world, id }
    }

    /// Read access to this joint.
    pub fn view(&self) -> Joint<'_> {
        self.world.joint(self.id)
    }

    fn raw(&self) -> dJointID {
        self.world.joints.expect(self.id).raw
    }

    /// Attaches the joint to other bodies at their current poses; `None` stands for the world.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if a body was removed, or if both are `None` or the same body.
    pub fn attach(&mut self, bodies: [Option<BodyId>; 2]) -> Result<()> {
        let [first, second] = self.world.raw_pair(bodies)?;
        // SAFETY: joint and bodies are alive and of one world, and the bodies differ, so at most one is null.
        unsafe { dJointAttach(self.raw(), first, second) };
        Ok(())
    }

    /// Sets the anchor of a ball joint or hinge, in the world's frame.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for other kinds of joint, for a joint without bodies, and for numbers that are not finite.
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

    /// Sets the axis of a hinge or slider, in the world's frame. The angle or position becomes 0 at the bodies' current
    /// poses.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for other kinds of joint, for a joint without bodies, and for axes that are not finite or of
    /// length 0.
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

    /// Sets a parameter of the joint.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if this kind of joint does not have the parameter, for NaN, and for numbers out of range.
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

    /// Enables the joint, or disables it, so that it has no effect.
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
                "{:?}: expected a joint attached to a body, found one without: call `attach` first",
                self.id
            )))
        }
    }
}
