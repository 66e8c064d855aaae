//! Reuse of the memory of lists.

/// An empty list in the memory of `list`, for elements that differ only in their lifetimes.
pub(crate) fn recycle<T, U>(mut list: Vec<T>) -> Vec<U> {
    list.clear();
    // Collected in place: there is no element to convert.
    list.into_iter().map(|_| unreachable!("the list was cleared")).collect()
}
