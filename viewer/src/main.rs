//! `vhull-view`.
fn main() {}
