//! Read access to joints.

use nalgebra::{Point3, Vector3};
use ode_sys::*;

use super::kind::Motion;
use super::{JointAxis, JointRecord, JointType};
use crate::ode::arena::{BodyId, JointId};
use crate::ode::convert;
use crate::ode::world::World;

/// Read access to a joint.
///
/// A value is `None` if this kind of joint does not have it, or if the bodies it depends on were removed.
#[derive(Debug, Clone, Copy)]
pub struct Joint<'w> {
    world: &'w World,
    pub(super) record: &'w JointRecord,
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
        self.record.raw_bodies().map(|body| unsafe { self.world.body_id(body) })
    }

    /// Whether the joint is attached to a body. It is not after one of its bodies was removed.
    pub fn is_attached(&self) -> bool {
        self.record.is_attached()
    }

    /// Whether the joint is enabled. A disabled joint has no effect.
    pub fn is_enabled(&self) -> bool {
        // SAFETY: the joint is alive.
        unsafe { dJointIsEnabled(self.record.raw) != 0 }
    }

    /// The joint's anchor as a point of the first body, in the world's frame. That of PR and PU joints, which have one
    /// alone, is a point of the second body.
    pub fn anchor(&self) -> Option<Point3<f64>> {
        let get = match self.record.kind {
            JointType::Ball => dJointGetBallAnchor,
            JointType::Hinge => dJointGetHingeAnchor,
            JointType::Hinge2 => dJointGetHinge2Anchor,
            JointType::Universal => dJointGetUniversalAnchor,
            JointType::PrismaticRotoide => dJointGetPRAnchor,
            JointType::PrismaticUniversal => dJointGetPUAnchor,
            JointType::Piston => dJointGetPistonAnchor,
            _ => return None,
        };
        self.read(get).map(Point3::from)
    }

    /// The joint's anchor as a point of the second body, or of the world, in the world's frame. Its distance from
    /// [`anchor`](Self::anchor) is the error of a ball, hinge or universal joint; a hinge2's suspension and a piston's
    /// position belong to the distance.
    pub fn anchor2(&self) -> Option<Point3<f64>> {
        let get = match self.record.kind {
            JointType::Ball => dJointGetBallAnchor2,
            JointType::Hinge => dJointGetHingeAnchor2,
            JointType::Hinge2 => dJointGetHinge2Anchor2,
            JointType::Universal => dJointGetUniversalAnchor2,
            JointType::Piston => dJointGetPistonAnchor2,
            _ => return None,
        };
        self.read(get).map(Point3::from)
    }

    /// The joint's first axis, as [`axis_of`](Self::axis_of) returns it.
    pub fn axis(&self) -> Option<Vector3<f64>> {
        self.axis_of(JointAxis::First)
    }

    /// An axis of the joint in the world's frame. It is a unit vector, except for the first and third axis of an Euler
    /// motor, whose length is the sine of the angle between the two axes that the bodies carry.
    pub fn axis_of(&self, axis: JointAxis) -> Option<Vector3<f64>> {
        let get: VectorGetter = match (self.record.kind, axis) {
            (JointType::Hinge, JointAxis::First) => dJointGetHingeAxis,
            (JointType::Slider, JointAxis::First) => dJointGetSliderAxis,
            (JointType::Hinge2, JointAxis::First) => dJointGetHinge2Axis1,
            (JointType::Hinge2, JointAxis::Second) => dJointGetHinge2Axis2,
            (JointType::Universal, JointAxis::First) => dJointGetUniversalAxis1,
            (JointType::Universal, JointAxis::Second) => dJointGetUniversalAxis2,
            (JointType::PrismaticRotoide, JointAxis::First) => dJointGetPRAxis1,
            (JointType::PrismaticRotoide, JointAxis::Second) => dJointGetPRAxis2,
            (JointType::PrismaticUniversal, JointAxis::First) => dJointGetPUAxis1,
            (JointType::PrismaticUniversal, JointAxis::Second) => dJointGetPUAxis2,
            (JointType::PrismaticUniversal, JointAxis::Third) => dJointGetPUAxis3,
            (JointType::Piston, JointAxis::First | JointAxis::Second) => dJointGetPistonAxis,
            (JointType::Plane2d, axis) => return self.is_attached().then(|| Vector3::ith(axis.index(), 1.0)),
            (JointType::LinearMotor, axis) => {
                return self.has_axis(axis).then(|| self.record.linear_motor_axis(axis));
            }
            (JointType::AngularMotor | JointType::EulerMotor, axis) => return self.angular_motor_axis(axis),
            _ => return None,
        };
        self.read(get)
    }

    fn angular_motor_axis(&self, axis: JointAxis) -> Option<Vector3<f64>> {
        let mut vector = [0.0; 4];
        // ODE would abort on the parallel axes of an Euler motor.
        (self.has_axis(axis) && !self.record.is_parallel()).then(|| {
            // SAFETY: the joint is an attached angular motor with this axis; the array holds four numbers.
            unsafe { dJointGetAMotorAxis(self.record.raw, axis.index() as i32, vector.as_mut_ptr()) };
            convert::vector(&vector)
        })
    }

    /// Whether the joint is attached and has the axis.
    fn has_axis(&self, axis: JointAxis) -> bool {
        self.is_attached() && axis.index() < self.record.axis_count()
    }

    fn read(&self, get: VectorGetter) -> Option<Vector3<f64>> {
        let mut vector = [0.0; 4];
        // SAFETY: the joint is alive and of the kind that `get` takes; the array holds four numbers.
        self.is_attached().then(|| unsafe { get(self.record.raw, vector.as_mut_ptr()) })?;
        Some(convert::vector(&vector))
    }

    /// The angle about the joint's first axis that rotates, in radians.
    pub fn angle(&self) -> Option<f64> {
        self.angle_of(self.first_rotation()?)
    }

    /// The angular velocity about the joint's first axis that rotates, rad/s.
    pub fn angle_rate(&self) -> Option<f64> {
        self.angle_rate_of(self.first_rotation()?)
    }

    fn first_rotation(&self) -> Option<JointAxis> {
        let motions = self.record.kind.motions();
        JointAxis::ALL
            .into_iter()
            .zip(motions)
            .find(|&(_, &motion)| motion == Motion::Rotation)
            .map(|(axis, _)| axis)
    }

    /// The angle about an axis, in radians. An Euler motor has those of the last step, an angular motor those that were
    /// set. Universal and PU joints have none while their axes are parallel.
    pub fn angle_of(&self, axis: JointAxis) -> Option<f64> {
        let get: NumberGetter = match (self.record.kind, axis) {
            (JointType::Hinge, JointAxis::First) => dJointGetHingeAngle,
            (JointType::Hinge2, JointAxis::First) => dJointGetHinge2Angle1,
            (JointType::Hinge2, JointAxis::Second) => dJointGetHinge2Angle2,
            (JointType::Universal, JointAxis::First) => dJointGetUniversalAngle1,
            (JointType::Universal, JointAxis::Second) => dJointGetUniversalAngle2,
            (JointType::PrismaticRotoide, JointAxis::Second) => dJointGetPRAngle,
            (JointType::PrismaticUniversal, JointAxis::First) => dJointGetPUAngle1,
            (JointType::PrismaticUniversal, JointAxis::Second) => dJointGetPUAngle2,
            (JointType::Piston, JointAxis::Second) => dJointGetPistonAngle,
            (JointType::AngularMotor | JointType::EulerMotor, axis) => {
                return self.motor_number(axis, dJointGetAMotorAngle);
            }
            _ => return None,
        };
        self.number(get)
    }

    /// The angular velocity about an axis, rad/s. Universal and PU joints and Euler motors have none while their axes
    /// are parallel.
    pub fn angle_rate_of(&self, axis: JointAxis) -> Option<f64> {
        let get: NumberGetter = match (self.record.kind, axis) {
            (JointType::Hinge, JointAxis::First) => dJointGetHingeAngleRate,
            (JointType::Hinge2, JointAxis::First) => dJointGetHinge2Angle1Rate,
            (JointType::Hinge2, JointAxis::Second) => dJointGetHinge2Angle2Rate,
            (JointType::Universal, JointAxis::First) => dJointGetUniversalAngle1Rate,
            (JointType::Universal, JointAxis::Second) => dJointGetUniversalAngle2Rate,
            (JointType::PrismaticRotoide, JointAxis::Second) => dJointGetPRAngleRate,
            (JointType::PrismaticUniversal, JointAxis::First) => dJointGetPUAngle1Rate,
            (JointType::PrismaticUniversal, JointAxis::Second) => dJointGetPUAngle2Rate,
            (JointType::Piston, JointAxis::Second) => dJointGetPistonAngleRate,
            (JointType::AngularMotor | JointType::EulerMotor, axis) => {
                return self.motor_number(axis, dJointGetAMotorAngleRate);
            }
            _ => return None,
        };
        self.number(get)
    }

    /// The position of a slider, piston, PR or PU joint along its axis, in metres.
    pub fn position(&self) -> Option<f64> {
        self.number(match self.record.kind {
            JointType::Slider => dJointGetSliderPosition,
            JointType::PrismaticRotoide => dJointGetPRPosition,
            JointType::PrismaticUniversal => dJointGetPUPosition,
            JointType::Piston => dJointGetPistonPosition,
            _ => return None,
        })
    }

    /// The velocity of a slider, piston, PR or PU joint along its axis, m/s.
    pub fn position_rate(&self) -> Option<f64> {
        self.number(match self.record.kind {
            JointType::Slider => dJointGetSliderPositionRate,
            JointType::PrismaticRotoide => dJointGetPRPositionRate,
            JointType::PrismaticUniversal => dJointGetPUPositionRate,
            JointType::Piston => dJointGetPistonPositionRate,
            _ => return None,
        })
    }

    fn number(&self, get: NumberGetter) -> Option<f64> {
        // SAFETY: the joint is alive, of the kind that `get` takes, and attached: without a body ODE would read through
        // a null pointer. From parallel axes it would compute with numbers that it never set.
        (self.is_attached() && !self.record.is_parallel()).then(|| unsafe { get(self.record.raw) })
    }

    fn motor_number(
        &self,
        axis: JointAxis,
        get: unsafe extern "C" fn(dJointID, i32) -> dReal,
    ) -> Option<f64> {
        // SAFETY: the joint is an attached angular motor with this axis, and not of parallel axes.
        (self.has_axis(axis) && !self.record.is_parallel())
            .then(|| unsafe { get(self.record.raw, axis.index() as i32) })
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
/// The type of ODE's functions that return a joint's angle, position, or rate.
type NumberGetter = unsafe extern "C" fn(dJointID) -> dReal;
