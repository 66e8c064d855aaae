//! Priorities of threads: the simulation is not late because images are segmented or a picture is drawn.

use ode_visual_hull::{Error, Result};

/// What a thread works for. Each goes before those after it; the simulation goes before all of them.
#[derive(Debug, Clone, Copy)]
pub enum Work {
    /// Images are segmented, while the simulation runs in real time.
    CaptureBesideRealTime,
    /// Recorded images are decoded.
    Decoding,
    /// Images are segmented, while the simulation has a nice value of 0.
    Capture,
    /// Pictures are drawn.
    Drawing,
}

impl Work {
    /// Lets the calling thread, and threads and programs that it starts, work with this priority, where the system has priorities for
    /// threads. Without them everything works, less evenly.
    pub fn set_priority(self) {
        // Nice values: a thread with 15 gets a thirtieth of a processor that one with 0 wants too. A thread that gets more of it
        // keeps a simulation with nice value 0 waiting for whole time slices, which are half of a step.
        #[cfg(target_os = "linux")]
        {
            let nice = match self {
                Self::CaptureBesideRealTime => 0,
                Self::Decoding => 10,
                Self::Capture => 15,
                Self::Drawing => 19,
            };
            // Linux has a priority for each thread, under the number of the thread.
            let _ = rustix::process::setpriority_process(Some(rustix::thread::gettid()), nice);
        }
    }
}

/// Tries whether a thread may run in real time.
///
/// # Errors
/// As [`run_in_real_time`].
pub fn check_real_time() -> Result<()> {
    // On a thread of its own, which then ends.
    std::thread::spawn(run_in_real_time).join().unwrap_or(Ok(()))
}

/// Lets the calling thread, and threads that it starts, run whenever they have work, before all other threads of the machine: it
/// does not wait for the end of their time slices.
///
/// # Errors
/// A user who may not, a system without real time.
pub fn run_in_real_time() -> Result<()> {
    in_real_time().map_err(|found| {
        Error::argument(format!(
            "expected to run the simulation in real time, found: {found}; let the user do so by a line such as \"USER - rtprio 1\" in \
             a file of /etc/security/limits.d and log in again, or leave real time out"
        ))
    })
}

#[cfg(target_os = "linux")]
fn in_real_time() -> std::result::Result<(), String> {
    use thread_priority::{
        RealtimeThreadSchedulePolicy::Fifo, ThreadPriority, ThreadSchedulePolicy::Realtime,
        set_thread_priority_and_policy, thread_native_id,
    };
    let set = set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Min, Realtime(Fifo));
    set.map_err(|e| match e {
        thread_priority::Error::OS(number) => std::io::Error::from_raw_os_error(number).to_string(),
        other => other.to_string(),
    })
}

#[cfg(not(target_os = "linux"))]
fn in_real_time() -> std::result::Result<(), String> {
    Err("a system other than Linux".into())
}
