//! Virtual bodies and a captured subject in one simulation, and films of it.
//!
//! ```text
//!   Frames ──► HullData ──► Simulation (ODE) ──► Compositor (bodies in one camera's view) ──► Film (GIF)
//!                                  └───────────► Log ──► CSV, plot, table
//! ```
//!
//! `run_film` does all of it, from a capture: its [`Frames`] are what the cameras see at each time, rendered or recorded,
//! and its [`Story`] is what to show of them. Capture, simulation and film have time steps of their own. World z is up,
//! the floor at z = 0; metres, seconds, radians.
//!
//! Without the feature `ode`, which is on by default, there is no simulation and no log: captures remain, recorded ones
//! too, and pictures of bodies whose poses come from elsewhere.

mod arguments;
mod bodies_file;
#[cfg(feature = "ode")]
mod body_shape;
mod capture;
mod compositor;
mod film;
mod finished_run;
#[cfg(feature = "ode")]
mod log;
#[cfg(feature = "ode")]
mod paced;
#[cfg(feature = "ode")]
mod part;
mod playback_options;
#[cfg(feature = "ode")]
mod plot;
mod ray_cast;
mod recorded;
#[cfg(feature = "ode")]
mod run;
mod sensor;
#[cfg(feature = "ode")]
mod simulated_body;
#[cfg(feature = "ode")]
mod simulation;
mod states;
#[cfg(feature = "ode")]
mod states_writer;
mod studio;
#[cfg(feature = "ode")]
mod subject_speed;
#[cfg(feature = "ode")]
mod summary;
mod window;

pub use arguments::{
    Movement, UnseenPolicy, VolumeOptions, numbers, parse_bounds, parse_frames, parse_positive, parse_rate,
    parse_size, parse_times, shown_frames,
};
pub use bodies_file::{BodiesFile, DrawnPart, PlayedRecording};
pub use capture::{FRAME_RATE, Frames, STEPS_PER_SECOND, Story, view_of};
pub use compositor::{Compositor, Drawn, Real};
pub use film::Film;
pub use finished_run::FinishedRun;
#[cfg(feature = "ode")]
pub use log::{Entry, Log};
#[cfg(feature = "ode")]
pub use paced::{Pace, PaceReport, PacedFrames, Steps, Tally, run_paced};
#[cfg(feature = "ode")]
pub use part::Part;
pub use playback_options::PlaybackOptions;
pub use recorded::{
    ASSUMED_RATE, BackgroundImages, FrameTime, FrameTimes, FramesCsv, Playback, RecordedHulls, check_subject,
    ground, in_the_way,
};
#[cfg(feature = "ode")]
pub use run::{FilmOptions, FilmReport, run_film};
#[cfg(feature = "ode")]
pub use simulated_body::{SimulatedBody, State, Support};
#[cfg(feature = "ode")]
pub use simulation::{HullContact, Simulation, lean_deg};
pub use states::States;
#[cfg(feature = "ode")]
pub use states_writer::StatesWriter;
pub use studio::{Scenario, Studio};
pub use window::Window;
