//! Joints: what holds two bodies together, or a body to the world.

mod param;
mod view;

use nalgebra::{Point3, Vector3};
use ode_sys::*;

use super::arena::{Arena, BodyId, JointGroupId, JointId, Key};
use super::check;
use super::collide::{ContactGeom, create_contact};
use super::surface::Surface;
use super::world::World;
use crate::{Error, Result};

pub use param::JointParam;
pub use view::{Joint, JointMut};

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
    pub(super) fn raw_pair(&self, bodies: [Option<BodyId>; 2]) -> Result<[dBodyID; 2]> {
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
        Joint::new(self, self.joints.expect(id), id)
    }

    /// A joint to read, if it is there.
    pub fn get_joint(&self, id: JointId) -> Option<Joint<'_>> {
        self.joints.get(id.0).map(|record| Joint::new(self, record, id))
    }

    /// A joint to change.
    ///
    /// # Panics
    ///
    /// If the joint was removed, or is of another world.
    #[track_caller]
    pub fn joint_mut(&mut self, id: JointId) -> JointMut<'_> {
        self.joints.expect(id);
        JointMut::new(self, id)
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
