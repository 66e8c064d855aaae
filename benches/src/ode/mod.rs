//! Benchmarks that call ODE directly, without the library's wrapper.

pub mod mesh;
