//! Priorities of threads: the simulation is not late because images are segmented or a picture is drawn.

/// What a thread works for. Each goes before those after it; the simulation goes before all of them.
#[derive(Debug, Clone, Copy)]
pub enum Work {
    /// Recorded images are decoded.
    Decoding,
    /// Images are segmented.
    Capture,
    /// Pictures are drawn.
    Drawing,
}

impl Work {
    /// Lets the calling thread, and threads and programs that it starts, work with this priority, where the system has priorities for
    /// threads. Without them everything works, less evenly.
    pub fn set_priority(self) {
        // Nice values: a thread with 15 gets a thirtieth of a processor that one with 0 wants too. A thread that gets more of it
        // keeps the simulation waiting for whole time slices, which are half of a step.
        #[cfg(target_os = "linux")]
        {
            let nice = match self {
                Self::Decoding => 10,
                Self::Capture => 15,
                Self::Drawing => 19,
            };
            // Linux has a priority for each thread, under the number of the thread.
            let _ = rustix::process::setpriority_process(Some(rustix::thread::gettid()), nice);
        }
    }
}
