//! The forces that joints exert, as the last step computed them.

use std::ptr::NonNull;

use nalgebra::Vector3;
use ode_sys::{dJointFeedback, dJointGetBody, dJointID, dJointSetFeedback};

use super::{Joint, JointMut};
use crate::ode::contacts::ContactGeom;
use crate::ode::convert;
use crate::ode::world::World;

/// The forces and torques of one joint in the last step, in the world's frame. All are zero if the joint had no effect
/// in that step, because it was disabled or its bodies were asleep.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointFeedback {
    /// The force on the first and on the second body, N; zero on the world.
    pub forces: [Vector3<f64>; 2],
    /// The torque about the centre of mass of the first and of the second body, N m; zero on the world.
    pub torques: [Vector3<f64>; 2],
}

/// The memory that ODE writes the forces of one joint to.
///
/// ODE keeps a pointer to it, so it is not borrowed by a `Box`, which may not be moved while others write to it.
#[derive(Debug)]
pub(in crate::ode) struct FeedbackMemory(NonNull<dJointFeedback>);

/// A contact of the last collide whose forces are measured.
#[derive(Debug)]
pub(in crate::ode) struct MeasuredContact {
    contact: ContactGeom,
    raw: dJointID,
    memory: FeedbackMemory,
}

impl FeedbackMemory {
    /// New memory that the joint writes to.
    ///
    /// # Safety
    ///
    /// The joint is alive, and is destroyed, or given other memory or none, before a step that follows the drop of this
    /// value.
    unsafe fn of(joint: dJointID) -> Self {
        let memory = NonNull::from(Box::leak(Box::new(dJointFeedback::default())));
        // SAFETY: the joint is alive, and the caller guarantees that the memory outlives its use.
        unsafe { dJointSetFeedback(joint, memory.as_ptr()) };
        Self(memory)
    }

    /// Forgets the forces of the last step.
    pub(super) fn clear(&self) {
        // SAFETY: the memory is alive, and ODE writes to it only during a step.
        unsafe { self.0.write(dJointFeedback::default()) };
    }

    /// The forces that `joint`, which is alive, wrote.
    fn read(&self, joint: dJointID) -> JointFeedback {
        // SAFETY: as in `clear`.
        let raw = unsafe { self.0.read() };
        let mut forces = [&raw.f1, &raw.f2].map(convert::vector);
        let mut torques = [&raw.t1, &raw.t2].map(convert::vector);

        // ODE always takes a body as the first, and notes that the two were swapped.
        // SAFETY: the caller guarantees a living joint.
        if unsafe { dJointGetBody(joint, 0) }.is_null() {
            forces.swap(0, 1);
            torques.swap(0, 1);
        }
        JointFeedback { forces, torques }
    }
}

impl Drop for FeedbackMemory {
    fn drop(&mut self) {
        // SAFETY: the memory was leaked from a box, and is freed once. No step follows in which a joint writes to it.
        drop(unsafe { Box::from_raw(self.0.as_ptr()) });
    }
}

impl Joint<'_> {
    /// The forces of the joint in the last step, if they are measured: see
    /// [`JointMut::set_feedback`](super::JointMut::set_feedback).
    pub fn feedback(&self) -> Option<JointFeedback> {
        self.record.feedback.as_ref().map(|memory| memory.read(self.record.raw))
    }
}

impl JointMut<'_> {
    /// Sets whether each step records the forces that this joint exerts.
    pub fn set_feedback(&mut self, on: bool) {
        let record = self.record_mut();
        // SAFETY: the joint is alive. It gets other memory, or none, before its old memory is freed.
        record.feedback = unsafe {
            if !on {
                dJointSetFeedback(record.raw, std::ptr::null_mut());
            }
            on.then(|| FeedbackMemory::of(record.raw))
        };
    }
}

impl World {
    /// The contacts that the last [`collide`](Self::collide) attached with
    /// [`attach_measured`](super::super::Pair::attach_measured), in this order, and their forces in the last step.
    pub fn contact_feedback(&self) -> Vec<(ContactGeom, JointFeedback)> {
        let measured = self.buffers.measured.borrow();
        measured.iter().map(|each| (each.contact, each.memory.read(each.raw))).collect()
    }

    /// Measures the forces of a contact joint until the contacts are cleared.
    ///
    /// # Safety
    ///
    /// The joint is alive, and belongs to this world's group of contacts.
    pub(in crate::ode) unsafe fn measure_contact(&self, raw: dJointID, contact: &ContactGeom) {
        // SAFETY: the caller guarantees the group, which is emptied before the list is.
        let memory = unsafe { FeedbackMemory::of(raw) };
        self.buffers.measured.borrow_mut().push(MeasuredContact { contact: *contact, raw, memory });
    }

    /// Forgets the forces of the last step, so that joints without effect in the next have none.
    pub(in crate::ode) fn clear_feedback(&self) {
        let joints = self.joints.iter().filter_map(|(_, record)| record.feedback.as_ref());
        let measured = self.buffers.measured.borrow();
        joints.chain(measured.iter().map(|each| &each.memory)).for_each(FeedbackMemory::clear);
    }
}
