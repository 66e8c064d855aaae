//! From image positions to pixels.

/// The pixel `(floor u, floor v)`, kept within `i32` for points far outside the image.
#[inline]
pub(crate) fn floor_pixel(u: f64, v: f64) -> (i32, i32) {
    (floor(u), floor(v))
}

/// The whole number below `x`, kept within `i32`: `as` saturates, so that a point near the camera's plane lands far
/// outside every image.
#[inline]
pub(crate) fn floor(x: f64) -> i32 {
    // `f64::floor` is a function call on the baseline x86-64, which has no SSE 4.1; `as` rounds towards zero.
    let towards_zero = x as i32;
    if f64::from(towards_zero) > x { towards_zero.saturating_sub(1) } else { towards_zero }
}
