//! Turns an ODE call that would `abort()` the process into an error.
//!
//! Debian's ODE reports a failed assertion to a debug handler and then aborts. Some failures cannot be foreseen: ODE
//! has no function to find out whether its table of user classes is full, and a step fails where its constraints
//! contradict each other so strongly that a motion is not finite. So these calls run under a debug handler that
//! unwinds out of ODE before it aborts.

use crate::lock::lock;
use ode_sys::{__va_list_tag, dGetDebugHandler, dMessageFunction, dSetDebugHandler};
use std::cell::Cell;
use std::ffi::{CStr, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Mutex;

/// Our debug handler's place in ODE, which has one handler for all threads.
struct Installed {
    /// The number of guarded calls under way, on all threads.
    calls: usize,
    /// The handler to restore when the last one ends.
    previous: dMessageFunction,
}

static INSTALLED: Mutex<Installed> = Mutex::new(Installed { calls: 0, previous: None });

thread_local! {
    /// Whether this thread is in a guarded call. On other threads the handler returns and ODE aborts as usual.
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// The panic payload that carries ODE's message out of the call.
struct Refusal(String);

/// The result of `call`, or ODE's message where ODE would have aborted.
///
/// # Safety
/// `call` calls one ODE function, declared `extern "C-unwind"`, which holds no lock when its assertion fails, and
/// either has changed nothing by then, or what it has changed is repaired before ODE uses it again.
pub(super) unsafe fn guarded<T>(call: impl FnOnce() -> T) -> Result<T, String> {
    begin();
    GUARDED.set(true);
    let outcome = catch_unwind(AssertUnwindSafe(call));
    GUARDED.set(false);
    end();

    outcome.map_err(|payload| match payload.downcast::<Refusal>() {
        Ok(refusal) => refusal.0,
        Err(other) => resume_unwind(other),
    })
}

/// Installs our handler, unless another call has done so.
fn begin() {
    // SAFETY: the two types differ only in the permission to unwind, and ODE's C++ frames let an exception pass.
    let unwinding: dMessageFunction =
        Some(unsafe { std::mem::transmute::<Handler, unsafe extern "C" fn(_, _, _)>(refuse) });

    let mut installed = lock(&INSTALLED);
    if installed.calls == 0 {
        // SAFETY: reads and stores functions that live as long as the process.
        unsafe {
            installed.previous = dGetDebugHandler();
            dSetDebugHandler(unwinding);
        }
    }
    installed.calls += 1;
}

/// Restores the program's handler, unless another call still needs ours.
fn end() {
    let mut installed = lock(&INSTALLED);
    installed.calls -= 1;
    if installed.calls == 0 {
        // SAFETY: restores the handler that was installed before.
        unsafe { dSetDebugHandler(installed.previous) };
    }
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
