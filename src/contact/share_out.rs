//! Bodies shared out among threads.

use super::SampledBody;

/// Runs `work` on `bodies` and the places of their answers: with the feature `threads` in parts, on the threads of
/// rayon's current pool.
#[cfg(feature = "threads")]
pub(super) fn share_out<T: Send>(
    bodies: &[SampledBody],
    answers: &mut [T],
    work: &(impl Fn(&[SampledBody], &mut [T]) + Sync),
) {
    /// Fewer bodies fill the lanes too badly to be worth a part of their own.
    const LEAST: usize = 32;
    /// Parts a thread: enough that none waits long for the last ones.
    const PARTS: usize = 4;
    let least = (bodies.len() / (PARTS * rayon::current_num_threads())).max(LEAST);
    if rayon::current_num_threads() == 1 || bodies.len() < 2 * LEAST {
        return work(bodies, answers);
    }
    halve(bodies, answers, least, work);
}

/// Runs `work` on halves of halves, down to parts of less than twice `least` bodies.
#[cfg(feature = "threads")]
fn halve<T: Send>(
    bodies: &[SampledBody],
    answers: &mut [T],
    least: usize,
    work: &(impl Fn(&[SampledBody], &mut [T]) + Sync),
) {
    if bodies.len() < 2 * least {
        return work(bodies, answers);
    }
    let (left, right) = bodies.split_at(bodies.len() / 2);
    let (of_left, of_right) = answers.split_at_mut(left.len());
    rayon::join(|| halve(left, of_left, least, work), || halve(right, of_right, least, work));
}

/// Runs `work` on `bodies` and the places of their answers: without the feature `threads`, at once.
#[cfg(not(feature = "threads"))]
pub(super) fn share_out<T>(
    bodies: &[SampledBody],
    answers: &mut [T],
    work: &impl Fn(&[SampledBody], &mut [T]),
) {
    work(bodies, answers);
}
