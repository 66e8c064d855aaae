//! Virtual bodies and a captured subject in one simulation, and what there is to see of it.
//!
//! ```text
//!   Capture ──► HullData ──► Simulation (ODE) ──► Easel (one camera's view with the bodies in it) ──► Film (GIF)
//!                                   └───────────► Log ──► CSV, plot, table
//! ```
//!
//! [`shoot`] goes all the way. A [`Capture`] is whatever gives silhouettes in the course of time: rendered cameras or a
//! recording. It, the simulation and the film each have steps of their own. World z is up, the floor at z = 0; metres,
//! seconds, radians.

mod capture;
mod easel;
mod film;
mod form;
mod log;
mod plot;
mod report;
mod shoot;
mod simulation;

pub use capture::{Capture, FRAME_RATE, Window, view_of};
pub use easel::{Drawn, Easel, Real};
pub use film::Film;
pub use form::Form;
pub use log::{Entry, Log};
pub use shoot::{Shooting, shoot};
pub use simulation::{Body, STEPS_PER_SECOND, Simulation, State, Support, lean_deg};
