//! What tests, figures and benchmarks share. For development only.
//!
//! | module | what it holds |
//! |---|---|
//! | [`random`] | one repeatable random generator |
//! | [`scene`] | a table whose hull is the table, its cameras and masks |
//! | `world` (feature `ode`) | worlds of ODE on that table |
//! | `trajectories` (feature `ode`) | bodies on a hull beside the same bodies on ODE's own box |
//! | [`quality`] | the hull from pixels beside the analytic hull of the same cameras |
//! | [`captures`] | real recordings, where they are present |
//! | [`figure`], [`figure_table`] | measured numbers, their bounds, and the file that they are written to |
//!
//! Unit tests of the library use [`random`] alone, by the package `ode-visual-hull-random`: this one stands on another build
//! of the library, with types of its own.

pub mod captures;
pub mod figure;
pub mod figure_table;
pub mod quality;
pub mod scene;
#[cfg(feature = "ode")]
pub mod trajectories;
#[cfg(feature = "ode")]
pub mod world;

pub use ode_visual_hull_random as random;

/// The median: of an even count the mean of the two in the middle.
///
/// # Panics
///
/// Without values.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let n = values.len();
    0.5 * (values[(n - 1) / 2] + values[n / 2])
}
