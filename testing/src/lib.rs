//! Code that tests, figures and benchmarks share. For development only.
//!
//! | module | what it holds |
//! |---|---|
//! | [`random`] | one repeatable random generator |
//! | [`scene`] | a table that is its own visual hull, with cameras and masks |
//! | `world` (feature `ode`) | worlds of ODE on that table |
//! | `touches` (feature `ode`) | scripted touches of bodies with the parts of a hull whose masks flicker |
//! | `trajectories` (feature `ode`) | the motion of bodies on a hull, compared with that on ODE's box |
//! | [`rendered`] | a synthetic subject as cameras see it at one moment, and its hull |
//! | [`quality`] | the hull from pixels, compared with the analytic hull of its cameras |
//! | [`captures`] | real recordings, where they are present |
//! | [`degenerate_lines`] | lines on which something is zero but for rounding, held against inside tests |
//! | [`manifolds`] | invariants of contacts on random hulls and bodies |
//! | [`edge_noise`] | masks whose outlines are displaced at random |
//! | [`hand`] | a synthetic hand of capsules |
//! | [`mask_errors`] | masks with gross errors: speckle, parts that are missing |
//! | [`figure`], [`figure_table`] | measured numbers, their bounds, and the file that they are written to |
//!
//! Unit tests of the library use the package of [`random`] alone, because this package links a second build of the
//! library with distinct types.

pub mod captures;
pub mod degenerate_lines;
pub mod edge_noise;
pub mod figure;
pub mod figure_table;
pub mod hand;
pub mod manifolds;
pub mod mask_errors;
pub mod quality;
pub mod rendered;
pub mod scene;
#[cfg(feature = "ode")]
pub mod touches;
#[cfg(feature = "ode")]
pub mod trajectories;
#[cfg(feature = "ode")]
pub mod world;

pub use ode_visual_hull_random as random;

/// The median; for an even count the mean of the two middle values.
///
/// # Panics
///
/// If there are no values.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let n = values.len();
    0.5 * (values[(n - 1) / 2] + values[n / 2])
}
