//! A fault that tests put into a callback, to see that it stays there.

use std::cell::Cell;

thread_local! {
    static ARMED: Cell<bool> = const { Cell::new(false) };
}

/// Lets the next callback on this thread panic.
pub(crate) fn inject_panic() {
    ARMED.set(true);
}

/// Panics where a fault was armed.
pub(super) fn panic_if_injected() {
    assert!(!ARMED.replace(false), "a fault put in by a test");
}
