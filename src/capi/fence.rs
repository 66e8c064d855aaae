//! Between C and Rust: errors become messages, and no panic crosses.

use crate::Result;
use crate::ode::{catch, is_fenced, take_last_error, take_parked_panic};
use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::panic;
use std::sync::Once;

thread_local! {
    static MESSAGE: RefCell<CString> = RefCell::default();
    /// Where the last panic behind a fence began.
    static PLACE: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Keeps panics that become messages from being printed; all others are printed as before.
pub(super) fn keep_quiet() {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| {
        let print = panic::take_hook();
        panic::set_hook(Box::new(move |panic| {
            if is_fenced() {
                PLACE.set(panic.location().map(ToString::to_string).unwrap_or_default());
            } else {
                print(panic);
            }
        }));
    });
}

/// What `call` returns, or `failure` after its error, or its panic, became this thread's message.
pub(super) fn fenced<T>(failure: T, call: impl FnOnce() -> Result<T>) -> T {
    let problem = match catch(call) {
        Ok(Ok(value)) => return value,
        Ok(Err(error)) => error.to_string(),
        Err(payload) => panic_message(payload.as_ref()),
    };
    set_message(problem);
    failure
}

/// This thread's message; what went wrong in a callback that ODE made of us since is told first.
pub(super) fn message() -> *const c_char {
    if let Some(trouble) = take_last_error() {
        set_message(trouble);
    }
    if let Some(payload) = take_parked_panic() {
        set_message(panic_message(payload.as_ref()));
    }
    // The string stays until the next failure on this thread.
    MESSAGE.with_borrow(|message| message.as_ptr())
}

fn set_message(text: String) {
    // C strings end at their first zero, which no message needs.
    let text = CString::new(text.replace('\0', "?")).unwrap_or_default();
    MESSAGE.set(text);
}

fn panic_message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("no words");
    let place = PLACE.take();
    format!("a panic_message of this library, not of its caller: {text} ({place}); please report it")
}

/// The text at `text`, a path for instance.
///
/// # Safety
/// `text` is NULL or a C string.
pub(super) unsafe fn utf8<'a>(text: *const c_char, what: &str) -> Result<&'a str> {
    if text.is_null() {
        return Err(crate::Error::argument(format!("{what}: expected a string, found NULL")));
    }
    // SAFETY: the caller vouches for a C string.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|_| crate::Error::argument(format!("{what}: expected UTF-8, found {text:?}")))
}
