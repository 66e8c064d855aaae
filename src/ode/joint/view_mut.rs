//! Write access to joints: bodies, anchors and axes.

use nalgebra::{Point3, Vector3};
use ode_sys::*;

use super::feedback::FeedbackMemory;
use super::{Joint, JointAxis, JointRecord, JointType, axes, kind, motor};
use crate::ode::arena::{BodyId, JointId};
use crate::ode::check;
use crate::ode::world::World;
use crate::{Error, Result};

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

    fn record(&self) -> &JointRecord {
        self.world.joints.expect(self.id)
    }

    pub(super) fn record_mut(&mut self) -> &mut JointRecord {
        self.world.joints.get_mut(self.id.0).expect("`World::joint_mut` has found the joint")
    }

    pub(super) fn raw(&self) -> dJointID {
        self.record().raw
    }

    /// Attaches the joint to other bodies at their current poses; `None` stands for the world.
    ///
    /// Anchors and axes keep their place in the frame of the first body, or of the second where each body has its own;
    /// angles and positions become 0.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if a body was removed, if both are `None` or the same body, or if this kind of joint cannot
    /// connect them (see [`JointKind`](super::JointKind)) or would have parallel axes.
    pub fn attach(&mut self, bodies: [Option<BodyId>; 2]) -> Result<()> {
        let raw_bodies = self.world.raw_pair(bodies)?;
        let record = self.record();
        record.kind.check_bodies(bodies)?;
        motor::check_frames(&record.motor_frames, bodies[1].is_some())?;
        // SAFETY: the bodies were found alive, or are null.
        if unsafe { record.is_parallel_between(raw_bodies) } {
            return Err(axes::parallel(self.id));
        }

        let [first, second] = raw_bodies;
        // SAFETY: joint and bodies are alive and of one world, and the bodies differ and are as the kind requires.
        unsafe { dJointAttach(record.raw, first, second) };
        record.feedback.iter().for_each(FeedbackMemory::clear);

        // ODE renews the reference of an Euler motor's angles only when its axes are set.
        if let (JointType::EulerMotor, Some([of_first, of_second])) = (record.kind, record.body_axes) {
            // SAFETY: both bodies are alive or null, and the joint is attached to them.
            unsafe {
                let world_axes = [axes::to_world(first, &of_first), axes::to_world(second, &of_second)];
                axes::set_axes(record.kind, record.raw, &[world_axes[0], world_axes[1], Vector3::zeros()]);
            }
        }
        Ok(())
    }

    /// Sets the joint's anchor, in the world's frame. Sliders, fixed joints, motors, plane2d joints and contacts have
    /// none.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for kinds of joint without an anchor, for a joint without bodies or with parallel axes, and
    /// for numbers that are not finite.
    pub fn set_anchor(&mut self, anchor: &Point3<f64>) -> Result<()> {
        check::point("anchor of the joint", anchor)?;
        let kind = self.record().kind;
        let set = anchor_setter(kind).ok_or_else(|| self.has_no("an anchor", kind))?;
        self.expect_attached()?;
        self.expect_crossed()?;

        // SAFETY: the joint is alive, has a body, and is of the kind that `set` takes.
        unsafe { set(self.raw(), anchor.x, anchor.y, anchor.z) };
        Ok(())
    }

    /// Sets the axis of a hinge, slider or piston, in the world's frame. The angle or position becomes 0 at the bodies'
    /// current poses.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for other kinds of joint, for a joint without bodies, and for axes that are not finite or of
    /// length 0.
    pub fn set_axis(&mut self, axis: &Vector3<f64>) -> Result<()> {
        let kind = self.record().kind;
        if !matches!(kind, JointType::Hinge | JointType::Slider | JointType::Piston) {
            return Err(self.has_no("a single axis", kind));
        }
        self.set_checked_axes(std::slice::from_ref(axis))
    }

    /// Sets all axes of a hinge2, universal, PR or PU joint or an Euler motor, in the world's frame and in the order of
    /// [`JointKind`](super::JointKind): three for a PU joint, otherwise two. Angles become 0 at the bodies' current
    /// poses.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for other kinds of joint and other numbers of axes, for a joint without bodies, and for axes
    /// that are not finite or of length 0, or parallel or not perpendicular where they must be.
    pub fn set_axes(&mut self, axes: &[Vector3<f64>]) -> Result<()> {
        let kind = self.record().kind;
        let expected = match kind {
            JointType::Hinge2
            | JointType::Universal
            | JointType::PrismaticRotoide
            | JointType::EulerMotor => 2,
            JointType::PrismaticUniversal => 3,
            _ => return Err(self.has_no("several axes", kind)),
        };
        if axes.len() != expected {
            return Err(Error::argument(format!(
                "axes of the {kind:?} joint: expected {expected}, found {}: pass all of them",
                axes.len()
            )));
        }
        self.set_checked_axes(axes)
    }

    fn set_checked_axes(&mut self, axes: &[Vector3<f64>]) -> Result<()> {
        let units = kind::check_axes(self.record().kind, axes)?;
        self.expect_attached()?;

        let record = self.record_mut();
        // SAFETY: the joint is alive, attached and of this kind; the axes are checked.
        unsafe { axes::set_axes(record.kind, record.raw, &units) };
        record.remember_axes(&units);
        Ok(())
    }

    /// Enables the joint, or disables it, so that it has no effect.
    pub fn set_enabled(&mut self, enabled: bool) {
        // SAFETY: the joint is alive.
        unsafe { if enabled { dJointEnable(self.raw()) } else { dJointDisable(self.raw()) } };
    }

    pub(super) fn has_no(&self, what: &str, kind: JointType) -> Error {
        Error::argument(format!(
            "{:?}: expected a joint with {what}, found a joint of type {kind:?}: use another kind of joint",
            self.id
        ))
    }

    pub(super) fn expect_attached(&self) -> Result<()> {
        if self.record().is_attached() {
            Ok(())
        } else {
            Err(Error::argument(format!(
                "{:?}: expected a joint attached to a body, found one without: call `attach` first",
                self.id
            )))
        }
    }

    /// Refuses an axis that the joint does not have.
    pub(super) fn expect_axis(&self, axis: JointAxis) -> Result<()> {
        let count = self.record().axis_count();
        if axis.index() < count {
            return Ok(());
        }
        Err(Error::argument(format!(
            "{:?}: expected one of its {count} axes, found {axis:?}: add the axis, or use another kind of joint",
            self.id
        )))
    }

    /// Refuses a joint whose axes are parallel, on which ODE aborts.
    pub(super) fn expect_crossed(&self) -> Result<()> {
        if self.record().is_parallel() { Err(axes::parallel(self.id)) } else { Ok(()) }
    }
}

type Setter = unsafe extern "C" fn(dJointID, dReal, dReal, dReal);

/// ODE's function that sets the anchor of an attached joint of this kind.
pub(super) fn anchor_setter(kind: JointType) -> Option<Setter> {
    Some(match kind {
        JointType::Ball => dJointSetBallAnchor,
        JointType::Hinge => dJointSetHingeAnchor,
        JointType::Hinge2 => dJointSetHinge2Anchor,
        JointType::Universal => dJointSetUniversalAnchor,
        JointType::PrismaticRotoide => dJointSetPRAnchor,
        JointType::PrismaticUniversal => dJointSetPUAnchor,
        JointType::Piston => dJointSetPistonAnchor,
        _ => return None,
    })
}
