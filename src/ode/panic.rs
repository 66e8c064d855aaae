//! Panics never unwind through ODE: a callback that panics returns a default value to ODE, and the panic resumes once
//! ODE has returned.

use super::per_thread::per_thread;
use std::any::Any;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

per_thread! {
    /// The first panic in a callback since the last call of `take_parked`.
    static PARKED: Box<dyn Any + Send>
}

thread_local! {
    /// The number of nested `catch` calls that this thread is in.
    static FENCES: Cell<usize> = const { Cell::new(0) };
}

/// The result of `call`, or the payload of the panic that ended it.
pub(crate) fn catch<T>(call: impl FnOnce() -> T) -> Result<T, Box<dyn Any + Send>> {
    FENCES.set(FENCES.get() + 1);
    let outcome = catch_unwind(AssertUnwindSafe(call));
    FENCES.set(FENCES.get() - 1);
    outcome
}

/// Whether a panic on this thread will be caught.
pub(crate) fn is_fenced() -> bool {
    FENCES.get() > 0
}

/// The result of `callback`. If it panics, the panic is parked on this thread and `default` is returned.
pub(super) fn fence<T>(default: T, callback: impl FnOnce() -> T) -> T {
    catch(callback).unwrap_or_else(|payload| {
        PARKED.set(PARKED.take().unwrap_or(payload));
        default
    })
}

/// Takes the panic parked on this thread, if any.
pub(crate) fn take_parked() -> Option<Box<dyn Any + Send>> {
    PARKED.take()
}

/// Resumes the panic parked on this thread, if any.
pub(super) fn resume_parked() {
    if let Some(payload) = take_parked() {
        resume_unwind(payload);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panicking_callback_returns_the_default_and_only_its_first_panic_is_parked() {
        assert_eq!(fence(7, || panic!("first")), 7);
        assert_eq!(fence(8, || panic!("second")), 8);
        assert_eq!(
            take_parked().and_then(|payload| payload.downcast::<&str>().ok()).as_deref(),
            Some(&"first")
        );
        assert!(take_parked().is_none());
        assert_eq!(fence(7, || 1), 1);
        assert!(fence(false, is_fenced) && !is_fenced());
    }
}
