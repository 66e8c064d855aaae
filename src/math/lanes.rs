//! Plain operations for loops over lanes, which the compiler turns into vector instructions.

/// 2^23: a whole number below it that is added to it stands in the lowest bits of the sum, and other numbers are
/// rounded to the nearest whole one.
const WHOLE_F32: f32 = 8_388_608.0;
/// 2^52: the counterpart of [`WHOLE_F32`] in double precision.
const WHOLE_F64: f64 = 4_503_599_627_370_496.0;

/// Selects `yes` or `no` without a branch; both are evaluated.
#[inline(always)]
pub(crate) fn select<T>(condition: bool, yes: T, no: T) -> T {
    if condition { yes } else { no }
}

/// A bit mask of lanes that hold zero or one: bit k is lane k.
#[inline(always)]
pub(crate) fn lane_mask<const N: usize>(lanes: &[u32; N]) -> u32 {
    lanes.iter().enumerate().fold(0, |bits, (k, one)| bits | one << k)
}

/// The indices of the bits that are set, ascending.
#[inline(always)]
pub(crate) fn set_bits(word: impl Into<u64>) -> impl Iterator<Item = usize> {
    let mut word = word.into();
    std::iter::from_fn(move || {
        let place = word.trailing_zeros();
        word &= word.wrapping_sub(1);
        (place < u64::BITS).then_some(place as usize)
    })
}

/// The whole number below `x`, with `x` clamped between one half and `max`; NaN becomes the lower bound.
#[inline(always)]
pub(crate) fn floor_clamped(x: f32, max: f32) -> u32 {
    let x = select(x > 0.5, x, 0.5);
    let x = select(x < max, x, max);
    // One half is subtracted because `round_u32` rounds to the nearest.
    round_u32(x - 0.5)
}

/// The whole number nearest to `x`, for `0 <= x < 2^23`.
#[inline(always)]
fn round_u32(x: f32) -> u32 {
    (x + WHOLE_F32).to_bits() & 0x007f_ffff
}

/// The whole number nearest to `x`, for `|x| < 2^22`.
#[inline(always)]
pub(crate) fn round_i32(x: f32) -> i32 {
    // Half the range is added, so that numbers below zero have no borrow from the exponent.
    (x + 1.5 * WHOLE_F32).to_bits() as i32 - (1.5 * WHOLE_F32).to_bits() as i32
}

/// The whole number below `x`, for `|x| < 2^51`.
#[inline(always)]
pub(crate) fn floor(x: f64) -> f64 {
    // Half the range is added, so that numbers below zero are not rounded to halves.
    let nearest = (x + 1.5 * WHOLE_F64) - 1.5 * WHOLE_F64;
    select(nearest > x, nearest - 1.0, nearest)
}

/// The whole number `x` as an integer, for `0 <= x < 2^32`.
#[inline(always)]
pub(crate) fn index(x: f64) -> u32 {
    (x + WHOLE_F64).to_bits() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_whole_number_below_is_that_of_the_standard_library_on_both_sides_of_zero() {
        // The cells above and to the left of an image begin half a pixel before it.
        let halves = (-4000..4000).map(|k| 0.125 * f64::from(k));
        for x in halves.chain([-1e-20, 1e-20, -0.4999999, -3e9 - 0.3, 3e9 + 0.7]) {
            assert_eq!(floor(x), x.floor(), "{x}");
        }
    }
}
