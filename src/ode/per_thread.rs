//! Values per thread that stay usable while their thread ends.
//!
//! Rust destroys a thread's local values when the thread ends. C and C++ programs still call this library after that: in
//! destructors of global objects, in `atexit` functions, in destructors of other thread-local values. There one value
//! that all ending threads share takes the place of the thread's own.

use crate::lock::lock;
use std::cell::Cell;
use std::sync::Mutex;
use std::thread::LocalKey;

/// Declares a static [`PerThread`] value.
macro_rules! per_thread {
    ($(#[$doc:meta])* static $name:ident: $type:ty) => {
        $(#[$doc])*
        static $name: $crate::ode::per_thread::PerThread<$type> = {
            static LATE: std::sync::Mutex<Option<$type>> = std::sync::Mutex::new(None);
            thread_local! {
                static OWN: $crate::ode::per_thread::Slot<$type> =
                    const { $crate::ode::per_thread::Slot::new(&LATE) };
            }
            $crate::ode::per_thread::PerThread::new(&OWN, &LATE)
        };
    };
}

pub(crate) use per_thread;

/// A value of each thread, empty at first.
#[derive(Debug)]
pub(crate) struct PerThread<T: 'static> {
    own: &'static LocalKey<Slot<T>>,
    late: &'static Mutex<Option<T>>,
}

/// The place of a thread's own value.
pub(crate) struct Slot<T: 'static> {
    value: Cell<Option<T>>,
    late: &'static Mutex<Option<T>>,
}

impl<T> PerThread<T> {
    pub(crate) const fn new(own: &'static LocalKey<Slot<T>>, late: &'static Mutex<Option<T>>) -> Self {
        Self { own, late }
    }

    /// Takes this thread's value, if it has one.
    pub(crate) fn take(&self) -> Option<T> {
        self.own.try_with(|slot| slot.value.take()).unwrap_or_else(|_| lock(self.late).take())
    }

    /// Sets this thread's value.
    pub(crate) fn set(&self, value: T) {
        let mut value = Some(value);
        // The closure does not run where the thread's own value is destroyed.
        let stored = self.own.try_with(|slot| slot.value.set(value.take()));
        if stored.is_err() {
            *lock(self.late) = value;
        }
    }
}

impl<T> Slot<T> {
    pub(crate) const fn new(late: &'static Mutex<Option<T>>) -> Self {
        Self { value: Cell::new(None), late }
    }
}

impl<T> Drop for Slot<T> {
    fn drop(&mut self) {
        // The destructors of global objects run on the main thread, and may still read what was set before they began.
        // SAFETY: both functions only return a number.
        if unsafe { libc::getpid() == libc::gettid() } {
            *lock(self.late) = self.value.take();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU32, Ordering};

    per_thread! {
        static VALUE: u32
    }

    /// What a destructor that ran after that of `VALUE`'s slot has set and taken again.
    static TAKEN: AtomicU32 = AtomicU32::new(0);

    struct Late;

    impl Drop for Late {
        fn drop(&mut self) {
            VALUE.set(7);
            TAKEN.store(VALUE.take().unwrap_or(0), Ordering::Relaxed);
        }
    }

    thread_local! {
        static LATE: Late = const { Late };
    }

    #[test]
    fn a_value_can_be_set_and_taken_after_the_threads_own_was_destroyed() {
        let thread = std::thread::spawn(|| {
            // Destroyed in the reverse order of their first use.
            LATE.with(|_| ());
            VALUE.set(1);
            assert_eq!(VALUE.take(), Some(1));
        });
        thread.join().unwrap();
        assert_eq!(TAKEN.load(Ordering::Relaxed), 7);
    }

    #[test]
    fn each_thread_has_a_value_of_its_own() {
        VALUE.set(1);
        std::thread::spawn(|| assert_eq!(VALUE.take(), None)).join().unwrap();
        assert_eq!(VALUE.take(), Some(1));
    }
}
