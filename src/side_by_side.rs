//! Work for several views at once.

use crate::Result;
use crate::lock::lock;
use std::num::NonZero;
use std::sync::{Mutex, OnceLock};

/// Calls `work` for each item, on as many threads as there are processors, and returns the results, or the first item's error,
/// in the items' order. The calling thread is one of them: what it keeps in its caches and in memory of its own is used again.
pub(crate) fn side_by_side<T: Send, R: Send>(
    items: impl Iterator<Item = T>,
    work: impl Fn(T) -> Result<R> + Sync,
) -> Result<Vec<R>> {
    // Asking the system takes as long as a small mask.
    static PROCESSORS: OnceLock<usize> = OnceLock::new();
    let processors = *PROCESSORS.get_or_init(|| std::thread::available_parallelism().map_or(1, NonZero::get));
    let items: Vec<T> = items.collect();
    let threads = processors.min(items.len());

    let items = Mutex::new(items.into_iter().enumerate());
    let next = || lock(&items).next();
    let run = || {
        let each = std::iter::from_fn(next).map(|(place, item)| (place, work(item)));
        each.collect::<Vec<_>>()
    };
    let mut results = std::thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(run)).collect();
        let mut results = run();
        for other in others {
            results.extend(other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        results
    });
    results.sort_by_key(|(place, _)| *place);
    results.into_iter().map(|(_, result)| result).collect()
}
