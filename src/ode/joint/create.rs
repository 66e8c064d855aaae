//! Creation of joints in ODE.

use nalgebra::Vector3;
use ode_sys::*;

use super::param::HingeStops;
use super::view_mut::anchor_setter;
use super::{JointKind, JointRecord, axes, kind};
use crate::Result;
use crate::ode::contacts::create_contact;

impl JointRecord {
    /// Creates a joint in ODE and attaches it.
    ///
    /// # Safety
    ///
    /// `world` is alive, `group` is null or alive, and `bodies` are null or alive and of `world`, and not equal. `kind`
    /// has passed [`JointKind::check`] for them.
    pub(super) unsafe fn create(
        kind: &JointKind,
        world: dWorldID,
        group: dJointGroupID,
        bodies: [dBodyID; 2],
    ) -> Result<Self> {
        let units = kind::check_axes(kind.joint_type(), kind.axes())?;

        // SAFETY: the caller guarantees living objects and a checked kind.
        unsafe {
            let raw = match kind {
                JointKind::Contact { contact, surface } => {
                    create_contact(world, group, bodies, contact, surface)?
                }
                _ => create_attached(kind, world, group, bodies, &units),
            };
            let mut record = Self {
                raw,
                group: None,
                kind: kind.joint_type(),
                body_axes: None,
                motor_frames: [None; 3],
                hinge_stops: HingeStops::default(),
                feedback: None,
            };
            record.remember_axes(&units);
            if let JointKind::LinearMotor { axes } | JointKind::AngularMotor { axes } = kind {
                record.set_motor_axes(axes);
            }
            Ok(record)
        }
    }
}

/// Creates a joint of any kind but a contact, and sets its axes and anchor. The axes of linear and angular motors
/// remain to be set.
///
/// # Safety
///
/// As for [`JointRecord::create`].
unsafe fn create_attached(
    kind: &JointKind,
    world: dWorldID,
    group: dJointGroupID,
    bodies: [dBodyID; 2],
    units: &[Vector3<f64>; 3],
) -> dJointID {
    let joint_type = kind.joint_type();
    let create = match kind {
        JointKind::Ball { .. } => dJointCreateBall,
        JointKind::Hinge { .. } => dJointCreateHinge,
        JointKind::Slider { .. } => dJointCreateSlider,
        JointKind::Hinge2 { .. } => dJointCreateHinge2,
        JointKind::Universal { .. } => dJointCreateUniversal,
        JointKind::PrismaticRotoide { .. } => dJointCreatePR,
        JointKind::PrismaticUniversal { .. } => dJointCreatePU,
        JointKind::Piston { .. } => dJointCreatePiston,
        JointKind::LinearMotor { .. } => dJointCreateLMotor,
        JointKind::AngularMotor { .. } | JointKind::EulerMotor { .. } => dJointCreateAMotor,
        JointKind::Plane2d => dJointCreatePlane2D,
        JointKind::Fixed | JointKind::Contact { .. } => dJointCreateFixed,
    };

    // ODE computes anchors and axes relative to the bodies, so the joint must be attached first.
    // SAFETY: the caller guarantees living objects and a checked kind.
    unsafe {
        let raw = create(world, group);
        match kind {
            JointKind::Hinge2 { .. } | JointKind::Universal { .. } | JointKind::PrismaticUniversal { .. } => {
                axes::attach_crossed(joint_type, world, raw, bodies, units);
            }
            _ => {
                dJointAttach(raw, bodies[0], bodies[1]);
                if let JointKind::EulerMotor { .. } = kind {
                    dJointSetAMotorMode(raw, dAMotorEuler as i32);
                }
                axes::set_axes(joint_type, raw, units);
            }
        }

        if let (Some(set), Some(anchor)) = (anchor_setter(joint_type), kind.anchor()) {
            set(raw, anchor.x, anchor.y, anchor.z);
        }
        if let JointKind::Fixed = kind {
            dJointSetFixed(raw);
        }
        raw
    }
}
