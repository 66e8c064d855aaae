//! Priorities of threads: the simulation is not late because images are segmented or a picture is drawn.

/// What a thread works for.
#[derive(Debug, Clone, Copy)]
pub enum Work {
    /// Bodies are simulated.
    Simulation,
    /// Recorded images are decoded.
    Decoding,
    /// Images are segmented.
    Capture,
    /// Pictures are drawn.
    Drawing,
}

impl Work {
    /// Lets the calling thread, and threads and programs that it starts, work with this priority, where the system has priorities
    /// for threads. Without them everything works, less evenly.
    pub fn set_priority(self) {
        #[cfg(target_os = "linux")]
        linux::set_priority(self);
    }
}

#[cfg(target_os = "linux")]
mod linux {
    use super::Work;
    use rustix::{process::setpriority_process, thread::gettid};
    use std::sync::LazyLock;
    use thread_priority::{
        RealtimeThreadSchedulePolicy::Fifo, ThreadPriority, ThreadSchedulePolicy::Realtime,
        set_thread_priority_and_policy, thread_native_id,
    };

    pub(super) fn set_priority(work: Work) {
        let nice = match (work, *IS_REAL_TIME_ALLOWED) {
            (Work::Simulation, true) => return drop(run_in_real_time()),
            (Work::Simulation, false) | (Work::Capture, true) => 0,
            // A thread with nice value 15 gets a thirtieth of a processor that one with 0 wants too. One that gets more of it keeps
            // the simulation waiting for whole time slices, which are half of a step.
            (Work::Decoding, _) => 10,
            (Work::Capture, false) => 15,
            (Work::Drawing, _) => 19,
        };
        // Linux has a nice value for each thread, under the number of the thread.
        let _ = setpriority_process(Some(gettid()), nice);
    }

    /// Whether the user may let threads run in real time, found by doing so, and others can run on another processor meanwhile.
    static IS_REAL_TIME_ALLOWED: LazyLock<bool> = LazyLock::new(|| {
        let has_others = std::thread::available_parallelism().is_ok_and(|processors| processors.get() > 1);
        has_others && std::thread::spawn(run_in_real_time).join().is_ok_and(|done| done.is_ok())
    });

    /// Lets the calling thread run whenever it has work, before all threads of other programs too: only that keeps steps from ever
    /// waiting for the end of a time slice.
    fn run_in_real_time() -> Result<(), thread_priority::Error> {
        set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Min, Realtime(Fifo))
    }
}
