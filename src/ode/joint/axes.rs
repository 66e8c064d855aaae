//! Axes that two bodies carry, one each, and that must not become parallel: ODE aborts on parallel ones, in setters and
//! in steps, or reads numbers that it never set.
//!
//! ODE cannot say which axes a joint without bodies keeps. So they are remembered here, in the frames of the bodies.

use nalgebra::Vector3;
use ode_sys::*;

use crate::ode::arena::JointId;
use crate::ode::convert;
use crate::ode::world::World;
use crate::{Error, Result};

use super::{JointRecord, JointType};

/// The sine of the angle below which two axes count as parallel. ODE itself fails where it is 0 but for rounding.
const PARALLEL: f64 = 1e-9;

impl JointType {
    /// Whether each body carries one of two axes that must not be parallel.
    pub(super) fn has_crossed_axes(self) -> bool {
        matches!(self, Self::Hinge2 | Self::Universal | Self::PrismaticUniversal | Self::EulerMotor)
    }
}

impl JointRecord {
    /// ODE's ids of the first and second body; null for the world, both null for a joint that is not attached.
    pub(super) fn raw_bodies(&self) -> [dBodyID; 2] {
        // SAFETY: a joint is alive as long as its record.
        [0, 1].map(|index| unsafe { dJointGetBody(self.raw, index) })
    }

    pub(super) fn is_attached(&self) -> bool {
        self.raw_bodies().iter().any(|body| !body.is_null())
    }

    /// Whether the axes are parallel at the poses of `bodies`.
    ///
    /// # Safety
    ///
    /// The bodies are alive or null.
    pub(super) unsafe fn is_parallel_between(&self, bodies: [dBodyID; 2]) -> bool {
        self.body_axes.is_some_and(|[first, second]| {
            // SAFETY: the caller guarantees that the bodies are alive or null.
            let axes = unsafe { [to_world(bodies[0], &first), to_world(bodies[1], &second)] };
            axes[0].cross(&axes[1]).norm() < PARALLEL
        })
    }

    /// Whether the joint is attached and its axes are parallel.
    pub(super) fn is_parallel(&self) -> bool {
        // SAFETY: the bodies of a joint are alive or null.
        self.is_attached() && unsafe { self.is_parallel_between(self.raw_bodies()) }
    }

    /// Remembers the crossed axes, given in the world's frame, of a kind that has them.
    pub(super) fn remember_axes(&mut self, axes: &[Vector3<f64>; 3]) {
        let [first, second] = self.raw_bodies();
        // SAFETY: the joint is attached, and its bodies are alive or null.
        let body_axes = unsafe { [to_frame_of(first, &axes[0]), to_frame_of(second, &axes[1])] };
        self.body_axes = self.kind.has_crossed_axes().then_some(body_axes);
    }
}

impl World {
    /// Refuses a step while the axes of an enabled joint are parallel, since ODE would abort.
    pub(in crate::ode) fn check_joint_axes(&self) -> Result<()> {
        for (key, record) in self.joints.iter() {
            // SAFETY: a joint is alive as long as its record.
            if record.is_parallel() && unsafe { dJointIsEnabled(record.raw) } != 0 {
                return Err(parallel(JointId(key)));
            }
        }
        Ok(())
    }
}

/// The error for a joint whose axes are parallel.
pub(super) fn parallel(id: JointId) -> Error {
    Error::argument(format!(
        "{id:?}: expected axes that are not parallel, found parallel ones: turn one of its bodies, or disable or \
         remove the joint"
    ))
}

/// Attaches a new joint with crossed axes and sets these.
///
/// `dJointAttach` computes with the axes that the joint has so far, in the frames of the new bodies, where they may be
/// parallel. So the axes are set with a stand-in for the second body, turned as the moment requires.
///
/// # Safety
///
/// Everything is alive and of `world`, or null for the second body. The joint is new and of a kind with crossed axes
/// that is no motor, and the axes are checked.
pub(super) unsafe fn attach_crossed(
    kind: JointType,
    world: dWorldID,
    raw: dJointID,
    [first, second]: [dBodyID; 2],
    axes: &[Vector3<f64>; 3],
) {
    // SAFETY: the caller guarantees living objects, and the stand-in lives until no joint refers to it. No step is
    // taken, so nothing moves.
    unsafe {
        let stand_in = dBodyCreate(world);

        // In bodies that are turned alike the axes of a new joint are perpendicular.
        dBodySetQuaternion(stand_in, dBodyGetQuaternion(first));
        dJointAttach(raw, first, stand_in);

        if second.is_null() {
            dBodySetQuaternion(stand_in, [1.0, 0.0, 0.0, 0.0].as_ptr());
        } else {
            dBodySetQuaternion(stand_in, dBodyGetQuaternion(second));
        }
        set_axes(kind, raw, axes);

        dJointAttach(raw, first, second);
        dBodyDestroy(stand_in);
    }
}

/// Sets the axes of a joint that is attached, in the world's frame. Motors have functions of their own.
///
/// # Safety
///
/// The joint is alive, attached and of this kind; the axes are checked.
pub(super) unsafe fn set_axes(kind: JointType, raw: dJointID, axes: &[Vector3<f64>; 3]) {
    let [first, second, third] = *axes;
    // SAFETY: the caller guarantees a joint of this kind, and that the first body is no null pointer.
    unsafe {
        match kind {
            JointType::Hinge => dJointSetHingeAxis(raw, first.x, first.y, first.z),
            JointType::Slider => dJointSetSliderAxis(raw, first.x, first.y, first.z),
            JointType::Piston => dJointSetPistonAxis(raw, first.x, first.y, first.z),
            JointType::Hinge2 => {
                let (first, second) = (convert::ode_vector(&first), convert::ode_vector(&second));
                dJointSetHinge2Axes(raw, first.as_ptr(), second.as_ptr());
            }
            JointType::PrismaticRotoide => {
                dJointSetPRAxis1(raw, first.x, first.y, first.z);
                dJointSetPRAxis2(raw, second.x, second.y, second.z);
            }
            JointType::Universal => {
                set_one_by_one(
                    raw,
                    axes,
                    dJointGetUniversalAxis1,
                    dJointSetUniversalAxis1,
                    dJointSetUniversalAxis2,
                );
            }
            JointType::PrismaticUniversal => {
                set_one_by_one(raw, axes, dJointGetPUAxis1, dJointSetPUAxis1, dJointSetPUAxis2);
                dJointSetPUAxis3(raw, third.x, third.y, third.z);
            }
            JointType::EulerMotor => {
                dJointSetAMotorAxis(raw, 0, 1, first.x, first.y, first.z);
                dJointSetAMotorAxis(raw, 2, 2, second.x, second.y, second.z);
            }
            _ => {}
        }
    }
}

type Getter = unsafe extern "C" fn(dJointID, *mut dReal);
type Setter = unsafe extern "C" fn(dJointID, dReal, dReal, dReal);

/// Sets the two axes of a universal joint, which ODE takes one by one, so that they are not parallel in between.
///
/// # Safety
///
/// The functions are of the joint's kind, and it has a first body.
unsafe fn set_one_by_one(raw: dJointID, axes: &[Vector3<f64>; 3], get1: Getter, set1: Setter, set2: Setter) {
    let mut old = [0.0; 4];
    // SAFETY: the caller guarantees the joint's kind and body; the array holds four numbers.
    unsafe { get1(raw, old.as_mut_ptr()) };

    // Perpendicular to the old first axis and to the new one.
    let both = convert::vector(&old).cross(&axes[0]);
    let any = axes[0].cross(&Vector3::ith(axes[0].iamin(), 1.0));
    let between = if both.norm() > 1e-3 { both } else { any };

    // SAFETY: as above; no axis has length 0.
    unsafe {
        set2(raw, between.x, between.y, between.z);
        set1(raw, axes[0].x, axes[0].y, axes[0].z);
        set2(raw, axes[1].x, axes[1].y, axes[1].z);
    }
}

/// A vector of the world's frame in the frame of a body, or unchanged for the world.
///
/// # Safety
///
/// `body` is alive or null.
pub(super) unsafe fn to_frame_of(body: dBodyID, vector: &Vector3<f64>) -> Vector3<f64> {
    // SAFETY: the caller guarantees a living body, where there is one.
    unsafe { turned(body, vector, dBodyVectorFromWorld) }
}

/// A vector of a body's frame in the world's frame, or unchanged for the world.
///
/// # Safety
///
/// `body` is alive or null.
pub(super) unsafe fn to_world(body: dBodyID, vector: &Vector3<f64>) -> Vector3<f64> {
    // SAFETY: the caller guarantees a living body, where there is one.
    unsafe { turned(body, vector, dBodyVectorToWorld) }
}

type Turn = unsafe extern "C" fn(dBodyID, dReal, dReal, dReal, *mut dReal);

unsafe fn turned(body: dBodyID, vector: &Vector3<f64>, turn: Turn) -> Vector3<f64> {
    if body.is_null() {
        return *vector;
    }
    let mut result = [0.0; 4];
    // SAFETY: the caller guarantees a living body; the array holds four numbers.
    unsafe { turn(body, vector.x, vector.y, vector.z, result.as_mut_ptr()) };
    convert::vector(&result)
}
