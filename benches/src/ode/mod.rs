//! What calls ODE past the library's wrapper.

pub mod mesh;
