//! A call that ODE answers with `abort()` where it could have said no.
//!
//! Debian's ODE reports a failed assertion to a debug handler and then aborts. There is no other way to learn that
//! the table of user classes is full, so the one call that fills it runs under a handler that unwinds out of ODE
//! before it aborts.

use crate::lock::lock;
use ode_sys::{__va_list_tag, dGetDebugHandler, dMessageFunction, dSetDebugHandler};
use std::cell::Cell;
use std::ffi::{CStr, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Mutex;

/// Held for as long as our handler stands, since ODE has one handler for all threads.
static HANDLER_LOCK: Mutex<()> = Mutex::new(());

thread_local! {
    /// Whether this thread is in a guarded call: on another one ODE aborts as ever.
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// What ODE said, as it is unwound.
struct Refusal(String);

/// The result of `call`, or ODE's words where ODE would have aborted.
///
/// # Safety
/// `call` calls one function of ODE, declared `extern "C-unwind"`, that holds no lock and has changed nothing when
/// it refuses.
pub(super) unsafe fn guarded<T>(call: impl FnOnce() -> T) -> Result<T, String> {
    // SAFETY: only the ABI differs, by the leave to unwind: ODE is C++, whose frames let an exception through.
    let unwinding: dMessageFunction =
        Some(unsafe { std::mem::transmute::<Handler, unsafe extern "C" fn(_, _, _)>(refuse) });
    let one_at_a_time = lock(&HANDLER_LOCK);
    // SAFETY: reads and stores a function that lives as long as the process.
    let before = unsafe {
        let before = dGetDebugHandler();
        dSetDebugHandler(unwinding);
        before
    };
    GUARDED.set(true);
    let outcome = catch_unwind(AssertUnwindSafe(call));
    GUARDED.set(false);
    // SAFETY: puts back what was there.
    unsafe { dSetDebugHandler(before) };
    drop(one_at_a_time);
    outcome.map_err(|payload| match payload.downcast::<Refusal>() {
        Ok(refusal) => refusal.0,
        Err(other) => resume_unwind(other),
    })
}

type Handler = unsafe extern "C-unwind" fn(c_int, *const c_char, *mut __va_list_tag);

unsafe extern "C-unwind" fn refuse(_: c_int, message: *const c_char, _: *mut __va_list_tag) {
    if !GUARDED.get() {
        // ODE aborts when this returns.
        return;
    }
    // SAFETY: ODE passes a C string, the format of its message.
    let text = unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned();
    // Not a panic of ours: nothing is printed.
    resume_unwind(Box::new(Refusal(text)));
}
