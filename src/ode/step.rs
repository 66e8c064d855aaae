//! Moving the world on in time.

use nalgebra::Isometry3;
use ode_sys::{
    dBodyDisable, dBodySetAngularVel, dBodySetForce, dBodySetLinearVel, dBodySetPosition, dBodySetQuaternion,
    dBodySetTorque, dReal, dWorldID, dWorldQuickStep, dWorldStep,
};

use super::arena::BodyId;
use super::body::Body;
use super::world::World;
use super::{check, convert};
use crate::{Error, Result};

/// One of ODE's two steppers.
type Stepper = unsafe extern "C" fn(dWorldID, dReal) -> i32;

impl World {
    /// Moves the world on by `dt` seconds, solving all constraints together: exact, but its time grows with the third
    /// power of the number of contacts that hang together.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if `dt` is not within 1 ns to 1000 s; [`Error::Ode`] if there is no memory, or if bodies
    /// had to be stopped. A body that leaves [`REACH`](super::REACH), or whose motion is no longer finite, is put back
    /// to where it was before the step, at rest and asleep; the others have moved on, and the world works on. The
    /// bodies concerned are in [`stopped_bodies`](Self::stopped_bodies).
    pub fn step(&mut self, dt: f64) -> Result<()> {
        self.advance(dt, dWorldStep)
    }

    /// Moves the world on by `dt` seconds, solving the constraints by iteration: see
    /// [`set_quick_step_iterations`](Self::set_quick_step_iterations) and
    /// [`set_random_seed`](super::set_random_seed).
    ///
    /// # Errors
    ///
    /// As for [`step`](Self::step).
    pub fn quick_step(&mut self, dt: f64) -> Result<()> {
        self.advance(dt, dWorldQuickStep)
    }

    /// The bodies that the last step stopped, see [`step`](Self::step).
    pub fn stopped_bodies(&self) -> &[BodyId] {
        &self.stopped
    }

    fn advance(&mut self, dt: f64, stepper: Stepper) -> Result<()> {
        check::within("time step", dt, 1e-9, 1e3)?;
        self.ode.ensure_thread_data()?;
        self.stopped.clear();
        let mut before = self.buffers.poses.take();
        before.clear();
        before.extend(self.bodies.iter().map(|(key, &raw)| Body::new(raw, BodyId(key)).pose()));
        // SAFETY: the world is alive, the step is positive, and this thread has ODE's data.
        let done = unsafe { stepper(self.raw, dt) };
        for ((key, &raw), pose) in self.bodies.iter().zip(&before) {
            let body = Body::new(raw, BodyId(key));
            if !is_sane(&body) {
                stop(&body, pose);
                self.stopped.push(body.id());
            }
        }
        self.buffers.poses.set(before);
        if done == 0 {
            return Err(Error::Ode("no memory for a step".into()));
        }
        match self.stopped.as_slice() {
            [] => Ok(()),
            [first, rest @ ..] => Err(Error::Ode(format!(
                "{first:?} and {} more left the world or lost a finite motion; they were put back and stopped: expected \
                 coordinates within {:e} m, so remove bodies that fall for ever, and check masses, forces and the step",
                rest.len(),
                check::REACH
            ))),
        }
    }
}

fn is_sane(body: &Body<'_>) -> bool {
    check::pose("", &body.pose()).is_ok()
        && check::vector("", &body.linear_velocity()).is_ok()
        && check::vector("", &body.angular_velocity()).is_ok()
}

/// Puts a body to sleep at a pose that was good.
fn stop(body: &Body<'_>, at: &Isometry3<f64>) {
    let (position, quaternion) = (at.translation.vector, convert::ode_quaternion(&at.rotation));
    // SAFETY: the body is alive, and the pose was read from ODE before the step, when it was finite.
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
