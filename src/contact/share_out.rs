//! Division of a list of bodies among threads.

use super::SampledBody;

/// Runs `work` on parts of `bodies` and their `results`, on the threads of rayon's current pool.
#[cfg(feature = "threads")]
pub(super) fn share_out<T: Send>(
    bodies: &[SampledBody],
    results: &mut [T],
    work: &(impl Fn(&[SampledBody], &mut [T]) + Sync),
) {
    /// Smallest number of bodies in a part. Fewer leave too many lanes of a batch empty.
    const MIN_BODIES: usize = 32;
    /// Parts per thread: enough that no thread idles for long at the end.
    const PARTS: usize = 4;

    let threads = rayon::current_num_threads();
    if threads == 1 || bodies.len() < 2 * MIN_BODIES {
        return work(bodies, results);
    }
    let min_bodies = (bodies.len() / (PARTS * threads)).max(MIN_BODIES);
    halve(bodies, results, min_bodies, work);
}

/// Divides `bodies` recursively into parts of fewer than `2 * min_bodies`, and runs `work` on each.
#[cfg(feature = "threads")]
fn halve<T: Send>(
    bodies: &[SampledBody],
    results: &mut [T],
    min_bodies: usize,
    work: &(impl Fn(&[SampledBody], &mut [T]) + Sync),
) {
    if bodies.len() < 2 * min_bodies {
        return work(bodies, results);
    }
    let (left, right) = bodies.split_at(bodies.len() / 2);
    let (of_left, of_right) = results.split_at_mut(left.len());
    rayon::join(|| halve(left, of_left, min_bodies, work), || halve(right, of_right, min_bodies, work));
}

/// Runs `work` on all `bodies` and their `results`, on the calling thread.
#[cfg(not(feature = "threads"))]
pub(super) fn share_out<T>(
    bodies: &[SampledBody],
    results: &mut [T],
    work: &impl Fn(&[SampledBody], &mut [T]),
) {
    work(bodies, results);
}
