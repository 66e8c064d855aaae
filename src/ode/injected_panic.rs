//! Lets a test make a callback panic, to check that the panic does not unwind through ODE.

use std::cell::Cell;

thread_local! {
    static ARMED: Cell<bool> = const { Cell::new(false) };
}

/// Makes the next callback on this thread panic.
pub(crate) fn inject_panic() {
    ARMED.set(true);
}

/// Panics if [`inject_panic`] was called on this thread since the last panic of this function.
pub(super) fn panic_if_injected() {
    assert!(!ARMED.replace(false), "a panic injected by a test");
}
