//! Time stepping.

use nalgebra::Isometry3;
use ode_sys::{
    dBodyDisable, dBodySetAngularVel, dBodySetForce, dBodySetLinearVel, dBodySetPosition, dBodySetQuaternion,
    dBodySetTorque, dReal, dThreadingAllocateSelfThreadedImplementation,
    dThreadingImplementationGetFunctions, dWorldCleanupWorkingMemory, dWorldID, dWorldQuickStep,
    dWorldSetStepThreadingImplementation, dWorldStep,
};

use super::arena::BodyId;
use super::body::Body;
use super::world::World;
use super::{abort, check, convert};
use crate::{Error, Result};

/// The type of ODE's two step functions, `dWorldStep` and `dWorldQuickStep`.
type Stepper = unsafe extern "C-unwind" fn(dWorldID, dReal) -> i32;

impl World {
    /// Advances the world by `dt` seconds with ODE's direct solver. It is exact, but its time grows with the third
    /// power of the number of connected contacts.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if `dt` is not within 1 ns to 1000 s, or if the two axes of an enabled hinge2, universal
    /// or PU joint or Euler motor are parallel; nothing has moved then. [`Error::Ode`] if memory runs out, or if
    /// bodies had to be stopped: a body that leaves [`REACH`](super::REACH), or whose motion is no longer finite, is
    /// put back to its pose before the step, at rest and asleep. The other bodies have moved, and the world remains
    /// usable. [`stopped_bodies`](Self::stopped_bodies) lists the stopped ones.
    pub fn step(&mut self, dt: f64) -> Result<()> {
        self.advance(dt, dWorldStep)
    }

    /// Advances the world by `dt` seconds with ODE's iterative solver.
    ///
    /// The number of iterations is set with [`set_quick_step_iterations`](Self::set_quick_step_iterations), their
    /// random order with [`set_random_seed`](super::set_random_seed).
    ///
    /// # Errors
    ///
    /// The errors of [`step`](Self::step).
    pub fn quick_step(&mut self, dt: f64) -> Result<()> {
        self.advance(dt, dWorldQuickStep)
    }

    /// The bodies that the last step stopped, for the reasons listed at [`step`](Self::step).
    pub fn stopped_bodies(&self) -> &[BodyId] {
        &self.stopped
    }

    fn advance(&mut self, dt: f64, stepper: Stepper) -> Result<()> {
        check::within("time step", dt, 1e-9, 1e3)?;
        self.ode.ensure_thread_data()?;
        self.check_joint_axes()?;
        self.last_dt = dt;
        self.clear_feedback();
        self.stopped.clear();

        let mut poses_before = self.buffers.poses.take();
        poses_before.clear();
        poses_before.extend(self.bodies.iter().map(|(key, &raw)| Body::new(raw, BodyId(key)).pose()));
        // SAFETY: the world is alive, the step is positive, and this thread has ODE's data. The world steps on this
        // thread alone, without locks. What a failed step leaves behind is replaced below, or put back.
        let outcome = unsafe { abort::guarded(|| stepper(self.raw, dt)) };
        if outcome.is_err() {
            self.discard_failed_step();
        }

        // ODE aborts in the next collide on a body that is not finite or too far away, so such bodies are stopped here.
        for ((key, &raw), pose) in self.bodies.iter().zip(&poses_before) {
            let body = Body::new(raw, BodyId(key));
            if !is_valid(&body) {
                stop(&body, pose);
                self.stopped.push(body.id());
            }
        }
        self.buffers.poses.set(poses_before);

        if outcome == Ok(0) {
            return Err(Error::Ode("memory ran out in a step".into()));
        }
        match self.stopped.as_slice() {
            [] => outcome.map(|_| ()).map_err(|message| {
                Error::Ode(format!("a step failed and has moved only some of the bodies: {message}"))
            }),
            [first, rest @ ..] => Err(Error::Ode(format!(
                "{first:?} and {} more bodies left the world (expected coordinates within {:e} m) or lost finite \
                 motion; they were put back and stopped: remove bodies that fall for ever, and check masses, forces and \
                 the time step",
                rest.len(),
                check::REACH
            ))),
        }
    }
}

impl World {
    /// Replaces what ODE's step functions left unfinished when one of their assertions failed. They keep nothing else
    /// from one step to the next but what the world's objects hold.
    fn discard_failed_step(&mut self) {
        // SAFETY: the world is alive. The threading object still lists the work that remained, so it cannot be freed,
        // and is leaked; the world does not use it any more.
        unsafe {
            let threading = dThreadingAllocateSelfThreadedImplementation();
            assert!(!threading.is_null(), "memory ran out");
            let functions = dThreadingImplementationGetFunctions(threading);
            dWorldSetStepThreadingImplementation(self.raw, functions, threading);
            dWorldCleanupWorkingMemory(self.raw);
            self.threading = threading;

            // Forces are cleared at the end of a step.
            for (_, &body) in self.bodies.iter() {
                dBodySetForce(body, 0.0, 0.0, 0.0);
                dBodySetTorque(body, 0.0, 0.0, 0.0);
            }
        }
    }
}

/// Whether the body's pose and velocities are finite and within [`check::REACH`].
pub(super) fn is_valid(body: &Body<'_>) -> bool {
    check::pose("", &body.pose()).is_ok()
        && check::vector("", &body.linear_velocity()).is_ok()
        && check::vector("", &body.angular_velocity()).is_ok()
}

/// Puts a body to sleep at `pose`, without velocity or force.
fn stop(body: &Body<'_>, pose: &Isometry3<f64>) {
    let (position, quaternion) = (pose.translation.vector, convert::ode_quaternion(&pose.rotation));

    // SAFETY: the body is alive, and the pose is finite, since ODE's step began with it.
    unsafe {
        let raw = body.raw();
        dBodySetPosition(raw, position.x, position.y, position.z);
        dBodySetQuaternion(raw, quaternion.as_ptr());
        dBodySetLinearVel(raw, 0.0, 0.0, 0.0);
        dBodySetAngularVel(raw, 0.0, 0.0, 0.0);
        dBodySetForce(raw, 0.0, 0.0, 0.0);
        dBodySetTorque(raw, 0.0, 0.0, 0.0);
        dBodyDisable(raw);
    }
}
