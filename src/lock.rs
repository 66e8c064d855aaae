//! Locking that ignores poisoning. Every change under one of this crate's locks is a single assignment, so the data is
//! valid after a panic.

#[cfg(not(thread_sanitizer))]
use std::sync::PoisonError;
use std::sync::{Mutex, MutexGuard};

/// Locks `mutex`, poisoned or not.
#[cfg(not(thread_sanitizer))]
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Locks `mutex` for `tests/thread_sanitizer.sh`: the sanitizer sees code that is compiled with this crate, such as
/// `try_lock`, but not the waiting inside the precompiled standard library, and would report a race after each wait.
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
