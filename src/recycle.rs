//! Reuse of memory.

use std::cell::Cell;
use std::thread::LocalKey;

/// Takes the memory that `kept` keeps for this thread; new memory where it is in use, and while the thread ends, when
/// the library may still be called from C.
pub(crate) fn take_scratch<T: Default>(kept: &'static LocalKey<Cell<Option<T>>>) -> T {
    kept.try_with(Cell::take).ok().flatten().unwrap_or_default()
}

/// Keeps memory for this thread's next [`take_scratch`].
pub(crate) fn keep_scratch<T>(kept: &'static LocalKey<Cell<Option<T>>>, scratch: T) {
    // While the thread ends, the memory is freed.
    let _ = kept.try_with(|cell| cell.set(Some(scratch)));
}

/// An empty list in the memory of `list`, for elements that differ only in their lifetimes.
pub(crate) fn recycle<T, U>(mut list: Vec<T>) -> Vec<U> {
    list.clear();
    // Collected in place: there is no element to convert.
    list.into_iter().map(|_| unreachable!("the list was cleared")).collect()
}
