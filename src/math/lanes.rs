//! What loops over lanes are made of: plain operations that the compiler turns into vector instructions.

/// Whole numbers are these ones' lowest bits once added to them.
const WHOLE_F32: f32 = 8_388_608.0;
const WHOLE_F64: f64 = 4_503_599_627_370_496.0;

/// Branch-free select; both operands are evaluated.
#[inline(always)]
pub(crate) fn select<T>(condition: bool, yes: T, no: T) -> T {
    if condition { yes } else { no }
}

/// The bits of lanes that hold zero or one.
#[inline(always)]
pub(crate) fn lane_mask<const N: usize>(lanes: &[u32; N]) -> u32 {
    lanes.iter().enumerate().fold(0, |bits, (k, one)| bits | one << k)
}

/// The places of the bits set, ascending.
#[inline(always)]
pub(crate) fn set_bits(word: impl Into<u64>) -> impl Iterator<Item = usize> {
    let mut word = word.into();
    std::iter::from_fn(move || {
        let place = word.trailing_zeros();
        word &= word.wrapping_sub(1);
        (place < u64::BITS).then_some(place as usize)
    })
}

/// The whole number below `x`, which is brought between one half and `most`; NaN becomes the lower bound.
#[inline(always)]
pub(crate) fn floor_clamped(x: f32, most: f32) -> u32 {
    let x = select(x > 0.5, x, 0.5);
    let x = select(x < most, x, most);
    // Half is taken off since the sum rounds to the nearest.
    round_u32(x - 0.5)
}

/// The whole number nearest to `x`, which is not negative and below 2^23.
#[inline(always)]
fn round_u32(x: f32) -> u32 {
    (x + WHOLE_F32).to_bits() & 0x007f_ffff
}

/// The whole number below `x`, which is not negative and below 2^51.
#[inline(always)]
pub(crate) fn floor(x: f64) -> f64 {
    let nearest = (x + WHOLE_F64) - WHOLE_F64;
    select(nearest > x, nearest - 1.0, nearest)
}

/// A whole number that is not negative and below 2^32.
#[inline(always)]
pub(crate) fn index(x: f64) -> u32 {
    (x + WHOLE_F64).to_bits() as u32
}
