//! The candidates of the benchmarks. All of them work on the same masks and the same bodies.
//!
//! ```text
//!   scene      ┌─► ours     the library                                   ─► inside, responses, body vectors, contacts
//!   cameras, ──┤
//!   masks,     │   undistorted beforehand (not timed) where the cameras have lenses
//!   boxes      ├─► literal  the paper's algorithm, pixel by pixel         ─► inside, responses, body vectors
//!              └─► carve    voxels, by the library's inside test
//!                     ├─► nets ─┬─► ode       a triangle mesh of ODE      ─► contacts
//!                     │         └─► parry     a triangle mesh of parry3d  ─► contacts
//!                     └──────────► parry      voxels of parry3d           ─► contacts
//! ```
//!
//! The program `ode-visual-hull-bench` measures them; `benches/parts.rs` measures the library's parts alone.

#![deny(unsafe_code)]

pub mod carve;
pub mod literal;
pub mod masks;
pub mod nets;
pub mod ode;
pub mod ours;
pub mod parry;
pub mod scene;

#[cfg(test)]
mod tests;
