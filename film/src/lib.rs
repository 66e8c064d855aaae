//! Virtual bodies and a captured subject in one simulation, and what there is to see of it.
//!
//! ```text
//!   Capture ──► HullData ──► Simulation (ODE) ──► Easel (one camera's view with the bodies in it) ──► Film (GIF)
//!                                   └───────────► Log ──► CSV, plot, table
//! ```
//!
//! `run` goes all the way. A [`Capture`] is whatever gives silhouettes in the course of time: rendered cameras or a
//! recording. It, the simulation and the film each have steps of their own. World z is up, the floor at z = 0; metres,
//! seconds, radians.
//!
//! Without the feature `ode`, which is on by default, there is no simulation, and no log of it: what is left are
//! captures, and pictures of bodies whose poses come from elsewhere.

mod capture;
mod compositor;
mod film;
mod form;
#[cfg(feature = "ode")]
mod log;
#[cfg(feature = "ode")]
mod plot;
#[cfg(feature = "ode")]
mod run;
#[cfg(feature = "ode")]
mod simulation;
#[cfg(feature = "ode")]
mod summary;

pub use capture::{Capture, FRAME_RATE, Window, view_of};
pub use compositor::{Compositor, Drawn, Real};
pub use film::Film;
pub use form::Form;
#[cfg(feature = "ode")]
pub use log::{Entry, Log};
#[cfg(feature = "ode")]
pub use run::{FilmOptions, run_film};
#[cfg(feature = "ode")]
pub use simulation::{STEPS_PER_SECOND, SimulatedBody, Simulation, State, Support, lean_deg};
