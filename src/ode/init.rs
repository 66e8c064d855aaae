//! Opening and closing ODE.

use crate::lock::lock;
use std::cell::Cell;
use std::sync::{Mutex, MutexGuard};

use ode_sys::{dAllocateMaskAll, dAllocateODEDataForThread, dCheckConfiguration, dCloseODE, dInitODE2};
use ode_sys::{dRandGetSeed, dRandSetSeed};

use crate::{Error, Result};

/// How often ODE is open here, and the how manyth opening this is. ODE's own counter is not guarded against threads.
#[derive(Debug)]
struct Openings {
    open: usize,
    epoch: u64,
}

static OPENINGS: Mutex<Openings> = Mutex::new(Openings { open: 0, epoch: 0 });

thread_local! {
    /// The opening for which this thread has ODE's per-thread data.
    static THREAD_EPOCH: Cell<u64> = const { Cell::new(0) };
}

fn openings() -> MutexGuard<'static, Openings> {
    lock(&OPENINGS)
}

/// ODE, opened.
///
/// References are counted, by ODE itself: ODE closes when the last `Ode` in the process is dropped, and may be
/// opened again. Every [`World`](super::World) holds one, so that ODE cannot be closed under it. May be cloned and
/// used on any thread.
#[derive(Debug)]
pub struct Ode(());

impl Ode {
    /// Opens ODE, or takes one more reference on it.
    ///
    /// # Errors
    ///
    /// [`Error::Ode`] if ODE cannot be opened, or if the library that was loaded computes in single precision.
    pub fn init() -> Result<Self> {
        let mut openings = openings();
        // SAFETY: the name is a C string; the function only compares it with a constant.
        if unsafe { dCheckConfiguration(c"ODE_double_precision".as_ptr()) } == 0 {
            return Err(Error::Ode(
                "expected a library of double precision, but the loaded one is single: install Debian's libode8".into(),
            ));
        }
        // SAFETY: the lock keeps other threads of this crate out of ODE's unguarded counter.
        if unsafe { dInitODE2(0) } == 0 {
            return Err(Error::Ode("dInitODE2 failed, most likely for want of memory".into()));
        }
        if openings.open == 0 {
            openings.epoch += 1;
        }
        openings.open += 1;
        Ok(Self(()))
    }

    /// Lets go of a reference that somebody else has given back already, by one `dCloseODE` too many.
    pub(super) fn forget(self) {
        openings().open -= 1;
        std::mem::forget(self);
    }

    /// Makes sure that this thread has what ODE keeps per thread. Called before each collide and step.
    pub(crate) fn ensure_thread_data(&self) -> Result<()> {
        let epoch = openings().epoch;
        if THREAD_EPOCH.get() == epoch {
            return Ok(());
        }
        // SAFETY: ODE is open as long as `self` lives.
        if unsafe { dAllocateODEDataForThread(dAllocateMaskAll as u32) } == 0 {
            return Err(Error::Ode(
                "dAllocateODEDataForThread failed, most likely for want of memory".into(),
            ));
        }
        THREAD_EPOCH.set(epoch);
        Ok(())
    }
}

impl Clone for Ode {
    fn clone(&self) -> Self {
        // An ODE that is open only counts: it allocates nothing, and its precision is known.
        Self::init().expect("ODE is open, so that opening it once more only counts")
    }
}

impl Drop for Ode {
    fn drop(&mut self) {
        let mut openings = openings();
        openings.open -= 1;
        // SAFETY: pairs with the dInitODE2 that made `self`; the lock guards ODE's counter.
        unsafe { dCloseODE() };
    }
}

/// Seeds ODE's random numbers, which [`World::quick_step`](super::World::quick_step) draws on.
///
/// They are one sequence for the whole process: for the same bits in each run, seed before each run and let no
/// other thread step.
pub fn set_random_seed(seed: u32) {
    // SAFETY: stores a number; needs no open ODE.
    unsafe { dRandSetSeed(seed.into()) };
}

/// The present state of ODE's random numbers.
pub fn random_seed() -> u32 {
    // SAFETY: loads a number; needs no open ODE.
    let seed = unsafe { dRandGetSeed() };
    // ODE keeps 32 bits and returns them in a `long`.
    seed as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ode_may_be_used_on_several_threads() {
        fn assert_send_sync<T: Send + Sync>() {}
        assert_send_sync::<Ode>();
    }

    #[test]
    fn references_are_counted() {
        let first = Ode::init().unwrap();
        let second = first.clone();
        drop(first);
        second.ensure_thread_data().unwrap();
        second.ensure_thread_data().unwrap();
    }
}
