//! The boundary between C and Rust: errors and panics become messages, and no panic unwinds into C.

use crate::Result;
use crate::ode::per_thread::per_thread;
use crate::ode::{catch, is_fenced, take_last_error, take_parked_panic};
use std::any::Any;
use std::ffi::{CStr, CString, c_char};
use std::panic;
use std::sync::Once;

per_thread! {
    /// The message of this thread's last failure.
    static MESSAGE: CString
}

per_thread! {
    /// The source location of the last fenced panic.
    static PLACE: String
}

/// Installs a panic hook that does not print fenced panics, which become messages. It prints all others as before.
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

/// The result of `call`. If it fails or panics, the error becomes this thread's message and `failure` is returned.
pub(super) fn fenced<T>(failure: T, call: impl FnOnce() -> Result<T>) -> T {
    let problem = match catch(call) {
        Ok(Ok(value)) => return value,
        Ok(Err(error)) => error.to_string(),
        Err(payload) => panic_message(payload.as_ref()),
    };
    set_message(problem);
    failure
}

/// This thread's message. An error or panic in a callback since the last failure replaces it.
pub(super) fn message() -> *const c_char {
    if let Some(error) = take_last_error() {
        set_message(error);
    }
    if let Some(payload) = take_parked_panic() {
        set_message(panic_message(payload.as_ref()));
    }
    // The string's memory stays where it is, and is valid until the next failure on this thread.
    let Some(message) = MESSAGE.take() else { return c"".as_ptr() };
    let start = message.as_ptr();
    MESSAGE.set(message);
    start
}

/// Makes `text` this thread's message.
fn set_message(text: String) {
    // A zero byte would end the C string early.
    let text = CString::new(text.replace('\0', "?")).unwrap_or_default();
    MESSAGE.set(text);
}

/// The message for a panic: its text, its source location, and a request to report it.
fn panic_message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied();
    let text =
        text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("without a message");
    let place = PLACE.take().unwrap_or_default();
    format!("internal error of this library, not of its caller: {text} ({place}); please report it")
}

/// The caller's string, such as a path.
///
/// # Safety
/// `text` is NULL or a C string.
pub(super) unsafe fn utf8<'a>(text: *const c_char, what: &str) -> Result<&'a str> {
    if text.is_null() {
        return Err(crate::Error::argument(format!("{what}: expected a string, found NULL")));
    }
    // SAFETY: the caller guarantees a C string.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|_| crate::Error::argument(format!("{what}: expected UTF-8, found {text:?}")))
}
