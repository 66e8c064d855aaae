//! Joints between two bodies, or between a body and the world.

mod axes;
mod create;
mod feedback;
mod kind;
mod motor;
mod param;
mod view;
mod view_mut;

use nalgebra::Vector3;
use ode_sys::*;

use super::arena::{Arena, BodyId, JointGroupId, JointId, Key};
use super::world::World;
use crate::{Error, Result};

use feedback::FeedbackMemory;
use param::HingeStops;

pub use feedback::JointFeedback;
pub(super) use feedback::MeasuredContact;
pub use kind::{JointAxis, JointKind, JointType};
pub use motor::{AxisFrame, MotorAxis};
pub use param::JointParam;
pub use view::Joint;
pub use view_mut::JointMut;

/// A joint that a world owns.
#[derive(Debug)]
pub(super) struct JointRecord {
    pub(super) raw: dJointID,
    pub(super) group: Option<Key>,
    kind: JointType,
    /// The crossed axes, in the frames of the first and second body, of the kinds that have them.
    body_axes: Option<[Vector3<f64>; 2]>,
    /// What the axes of a linear or angular motor move with.
    motor_frames: [Option<AxisFrame>; 3],
    hinge_stops: HingeStops,
    /// The memory for the joint's forces, if they are measured.
    feedback: Option<FeedbackMemory>,
}

/// A joint group that a world owns.
#[derive(Debug)]
pub(super) struct GroupRecord {
    pub(super) raw: dJointGroupID,
    members: Vec<Key>,
}

impl World {
    /// Adds a joint between two bodies, or between a body and the world (`None`).
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if a body was removed, if both are `None` or the same body, or if the kind of joint cannot
    /// connect them (see [`JointKind`]); for numbers that are not finite, and axes of length 0 or of a wrong angle to
    /// each other.
    pub fn add_joint(&mut self, bodies: [Option<BodyId>; 2], kind: &JointKind) -> Result<JointId> {
        self.create_joint(bodies, kind, None)
    }

    /// Adds a joint to a group, so that all joints of the group can be removed together.
    ///
    /// # Errors
    ///
    /// The errors of [`add_joint`](Self::add_joint), and [`Error::Argument`] if the group was removed.
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

        kind.check(bodies)?;
        // SAFETY: the world is alive, group and bodies were found alive in it, and the kind is checked.
        let record = unsafe { JointRecord::create(kind, self.raw, raw_group, raw_bodies)? };

        let key = self.joints.insert(JointRecord { group: group.map(|group| group.0), ..record });
        if let Some(group) = group.and_then(|group| self.groups.get_mut(group.0)) {
            group.members.push(key);
        }
        Ok(JointId(key))
    }

    /// ODE's ids of two different bodies, null for `None`.
    pub(super) fn raw_pair(&self, bodies: [Option<BodyId>; 2]) -> Result<[dBodyID; 2]> {
        if bodies[0] == bodies[1] {
            return Err(Error::argument(format!("joint: expected two different bodies, found {bodies:?}")));
        }
        let raw =
            |id: Option<BodyId>| id.map_or(Ok(std::ptr::null_mut()), |id| self.bodies.find(id).copied());
        Ok([raw(bodies[0])?, raw(bodies[1])?])
    }

    /// Removes a joint. Returns false if it was removed before.
    pub fn remove_joint(&mut self, id: JointId) -> bool {
        let Some(record) = self.joints.remove(id.0) else { return false };
        // ODE destroys the joints of a group only together. So a joint of a group is detached, and has no effect.
        // SAFETY: the joint was alive, and its record was just removed, so it is destroyed only once. It does not write
        // to its memory for forces, which is freed with the record.
        unsafe {
            match record.group {
                None => dJointDestroy(record.raw),
                Some(_) => {
                    dJointAttach(record.raw, std::ptr::null_mut(), std::ptr::null_mut());
                    dJointSetFeedback(record.raw, std::ptr::null_mut());
                }
            }
        }
        true
    }

    /// Whether the joint exists in this world.
    pub fn contains_joint(&self, id: JointId) -> bool {
        self.joints.get(id.0).is_some()
    }

    /// The ids of all joints, without the contacts that [`collide`](Self::collide) attached.
    pub fn joints(&self) -> impl Iterator<Item = JointId> + '_ {
        self.joints.iter().map(|(key, _)| JointId(key))
    }

    /// Read access to a joint. [`get_joint`](Self::get_joint) does not panic.
    ///
    /// # Panics
    ///
    /// If the joint was removed or belongs to another world.
    #[track_caller]
    pub fn joint(&self, id: JointId) -> Joint<'_> {
        Joint::new(self, self.joints.expect(id), id)
    }

    /// Read access to a joint, if it exists in this world.
    pub fn get_joint(&self, id: JointId) -> Option<Joint<'_>> {
        self.joints.get(id.0).map(|record| Joint::new(self, record, id))
    }

    /// Write access to a joint.
    ///
    /// # Panics
    ///
    /// If the joint was removed or belongs to another world.
    #[track_caller]
    pub fn joint_mut(&mut self, id: JointId) -> JointMut<'_> {
        self.joints.expect(id);
        JointMut::new(self, id)
    }

    /// Adds an empty group of joints.
    pub fn add_joint_group(&mut self) -> JointGroupId {
        // SAFETY: ODE is open as long as the world lives.
        let raw = unsafe { dJointGroupCreate(0) };
        JointGroupId(self.groups.insert(GroupRecord { raw, members: Vec::new() }))
    }

    /// Removes all joints of a group.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the group was removed.
    pub fn empty_joint_group(&mut self, id: JointGroupId) -> Result<()> {
        let raw = self.groups.find(id)?.raw;
        if let Some(group) = self.groups.get_mut(id.0) {
            remove_records(&mut self.joints, &mut group.members);
        }
        // SAFETY: the group is alive, and no record of its joints is left.
        unsafe { dJointGroupEmpty(raw) };
        Ok(())
    }

    /// Removes a group with its joints. Returns false if it was removed before.
    pub fn remove_joint_group(&mut self, id: JointGroupId) -> bool {
        let Some(mut record) = self.groups.remove(id.0) else { return false };
        remove_records(&mut self.joints, &mut record.members);
        // SAFETY: the group was alive; its record and those of its joints were just removed.
        unsafe { dJointGroupDestroy(record.raw) };
        true
    }

    /// Whether the joint group exists in this world.
    pub fn contains_joint_group(&self, id: JointGroupId) -> bool {
        self.groups.get(id.0).is_some()
    }
}

/// Removes the records of a group's joints, which ODE destroys with the group.
fn remove_records(joints: &mut Arena<JointRecord>, members: &mut Vec<Key>) {
    for key in members.drain(..) {
        joints.remove(key);
    }
}
