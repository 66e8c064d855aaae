//! Turns an ODE call that would `abort()` the process into an error.
//!
//! Debian's ODE reports a failed assertion to a debug handler and then aborts. ODE has no function to find out whether
//! its table of user classes is full. So the one call that registers a class runs under a debug handler that unwinds
//! out of ODE before it aborts.

use crate::lock::lock;
use ode_sys::{__va_list_tag, dGetDebugHandler, dMessageFunction, dSetDebugHandler};
use std::cell::Cell;
use std::ffi::{CStr, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Mutex;

/// Held while our debug handler is installed, since ODE has one handler for all threads.
static HANDLER_LOCK: Mutex<()> = Mutex::new(());

thread_local! {
    /// Whether this thread is in a guarded call. On other threads the handler returns and ODE aborts as usual.
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// The panic payload that carries ODE's message out of the call.
struct Refusal(String);

/// The result of `call`, or ODE's message where ODE would have aborted.
///
/// # Safety
/// `call` calls one ODE function, declared `extern "C-unwind"`, which holds no lock and has changed nothing when its
/// assertion fails.
pub(super) unsafe fn guarded<T>(call: impl FnOnce() -> T) -> Result<T, String> {
    // SAFETY: the two types differ only in the permission to unwind, and ODE's C++ frames let an exception pass.
    let unwinding: dMessageFunction =
        Some(unsafe { std::mem::transmute::<Handler, unsafe extern "C" fn(_, _, _)>(refuse) });

    let handler_guard = lock(&HANDLER_LOCK);
    // SAFETY: reads and stores a function that lives as long as the process.
    let previous = unsafe {
        let previous = dGetDebugHandler();
        dSetDebugHandler(unwinding);
        previous
    };

    GUARDED.set(true);
    let outcome = catch_unwind(AssertUnwindSafe(call));
    GUARDED.set(false);

    // SAFETY: restores the handler that was installed before.
    unsafe { dSetDebugHandler(previous) };
    drop(handler_guard);

    outcome.map_err(|payload| match payload.downcast::<Refusal>() {
        Ok(refusal) => refusal.0,
        Err(other) => resume_unwind(other),
    })
}

type Handler = unsafe extern "C-unwind" fn(c_int, *const c_char, *mut __va_list_tag);

unsafe extern "C-unwind" fn refuse(_: c_int, message: *const c_char, _: *mut __va_list_tag) {
    if !GUARDED.get() {
        // Another thread's failure: ODE aborts once this returns.
        return;
    }
    // SAFETY: ODE passes a C string, the format of its message.
    let text = unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned();
    // `resume_unwind` skips the panic hook, so nothing is printed.
    resume_unwind(Box::new(Refusal(text)));
}
