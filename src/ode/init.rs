//! Opening and closing ODE.

use crate::lock::lock;
use std::cell::Cell;
use std::sync::{Mutex, MutexGuard};

use ode_sys::{dAllocateMaskAll, dAllocateODEDataForThread, dCheckConfiguration, dCloseODE, dInitODE2};
use ode_sys::{dRandGetSeed, dRandSetSeed};

use crate::{Error, Result};

/// How ODE is open in this process. The lock around it also guards ODE's own reference counter, which is not
/// thread-safe.
#[derive(Debug)]
struct Openings {
    /// The number of living [`Ode`] values.
    open: usize,
    /// How often ODE went from closed to open.
    epoch: u64,
}

static OPENINGS: Mutex<Openings> = Mutex::new(Openings { open: 0, epoch: 0 });

thread_local! {
    /// The epoch for which this thread has allocated ODE's per-thread data.
    static THREAD_EPOCH: Cell<u64> = const { Cell::new(0) };
}

fn openings() -> MutexGuard<'static, Openings> {
    lock(&OPENINGS)
}

/// A counted reference to ODE, which is open as long as one exists.
///
/// ODE itself counts the references: it closes when the last `Ode` in the process is dropped, and may be opened again.
/// Every [`World`](super::World) holds one, so that ODE cannot be closed while the world exists. It may be cloned and
/// used on any thread.
#[derive(Debug)]
pub struct Ode(());

impl Ode {
    /// Opens ODE, or takes one more reference if it is open already.
    ///
    /// # Errors
    ///
    /// [`Error::Ode`] if ODE cannot be opened, or if the loaded library computes in single precision.
    pub fn init() -> Result<Self> {
        let mut openings = openings();

        // SAFETY: the name is a C string; the function only compares it with a constant.
        if openings.open == 0 && unsafe { dCheckConfiguration(c"ODE_double_precision".as_ptr()) } == 0 {
            return Err(Error::Ode(
                "expected a double-precision library, found one in single precision: install Debian's libode8".into(),
            ));
        }

        // SAFETY: the lock keeps other threads of this crate out of ODE's unguarded counter.
        if unsafe { dInitODE2(0) } == 0 {
            return Err(Error::Ode("dInitODE2 failed, most likely because memory ran out".into()));
        }

        // Per-thread data of an earlier opening is gone: a new epoch makes every thread allocate it again.
        if openings.open == 0 {
            openings.epoch += 1;
        }
        openings.open += 1;
        Ok(Self(()))
    }

    /// Drops this reference without calling `dCloseODE`, for a program that has already called it once too often.
    pub(super) fn forget(self) {
        openings().open -= 1;
        std::mem::forget(self);
    }

    /// Allocates ODE's per-thread data for this thread if it has none yet. Call it before each collide and step.
    pub(crate) fn ensure_thread_data(&self) -> Result<()> {
        let epoch = openings().epoch;
        if THREAD_EPOCH.get() == epoch {
            return Ok(());
        }
        // SAFETY: ODE is open as long as `self` lives.
        if unsafe { dAllocateODEDataForThread(dAllocateMaskAll as u32) } == 0 {
            return Err(Error::Ode(
                "dAllocateODEDataForThread failed, most likely because memory ran out".into(),
            ));
        }
        THREAD_EPOCH.set(epoch);
        Ok(())
    }
}

/// The result of `probe`, which runs while ODE is open: a closed ODE is opened for it, and closed again. `None` if ODE cannot
/// be opened.
pub(super) fn with_ode_open<T>(probe: impl FnOnce() -> T) -> Option<T> {
    let _openings = openings();
    // SAFETY: the lock keeps other threads of this crate out of ODE's unguarded counter, which is as before after the two
    // calls.
    unsafe {
        if dInitODE2(0) == 0 {
            return None;
        }
        let result = probe();
        dCloseODE();
        Some(result)
    }
}

impl Clone for Ode {
    fn clone(&self) -> Self {
        // Opening an open ODE only counts references: it allocates nothing, and the precision was checked before.
        Self::init().expect("opening an open ODE only counts references")
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

/// Seeds ODE's random number generator, which [`World::quick_step`](super::World::quick_step) uses.
///
/// The process has one generator: for bitwise equal runs, seed it before each run and let no other thread step.
pub fn set_random_seed(seed: u32) {
    // SAFETY: the call stores a number, and ODE need not be open.
    unsafe { dRandSetSeed(seed.into()) };
}

/// The current state of ODE's random number generator, which [`set_random_seed`] restores.
pub fn random_seed() -> u32 {
    // SAFETY: the call loads a number, and ODE need not be open.
    let seed = unsafe { dRandGetSeed() };
    // ODE keeps a 32-bit state and returns it as a `long`.
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
    fn ode_stays_open_until_its_last_reference_is_dropped() {
        let first = Ode::init().unwrap();
        let second = first.clone();
        drop(first);
        second.ensure_thread_data().unwrap();
        second.ensure_thread_data().unwrap();
    }
}
