//! Taking a lock. Every change under one of this crate's locks is a single assignment, so that what a panic leaves
//! behind is valid and a poisoned lock is taken as any other.

#[cfg(not(thread_sanitizer))]
use std::sync::PoisonError;
use std::sync::{Mutex, MutexGuard};

/// Waits for `mutex` and holds it.
#[cfg(not(thread_sanitizer))]
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The same for `tests/thread_sanitizer.sh`: the sanitizer sees what is compiled with this crate, as `try_lock` is,
/// but not how the ready-made standard library waits, and would report a race after each wait.
#[cfg(thread_sanitizer)]
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    use std::sync::TryLockError;
    loop {
        match mutex.try_lock() {
            Ok(guard) => return guard,
            Err(TryLockError::Poisoned(poisoned)) => return poisoned.into_inner(),
            Err(TryLockError::WouldBlock) => std::thread::yield_now(),
        }
    }
}
