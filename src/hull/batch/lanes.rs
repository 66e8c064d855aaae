//! What the lanes are reckoned with: plain operations that the compiler turns into vector instructions.

use super::super::points::LANES;

/// Whole numbers are this one's lowest bits once added to it.
const WHOLE: f32 = 8_388_608.0;

/// Both are computed, and one is taken: no branch for the compiler to stumble over.
#[inline(always)]
pub(super) fn either(condition: bool, yes: f32, no: f32) -> f32 {
    if condition { yes } else { no }
}

/// Zeros and ones as bits, a lane each.
#[inline(always)]
pub(super) fn bits(ones: &[u32; LANES]) -> u32 {
    ones.iter().enumerate().fold(0, |bits, (k, one)| bits | one << k)
}

/// The whole number below `x`, which is brought between one half and `most`; NaN becomes the lower bound.
#[inline(always)]
pub(super) fn whole(x: f32, most: f32) -> u32 {
    let x = either(x > 0.5, x, 0.5);
    let x = either(x < most, x, most);
    // Half is taken off since the sum rounds to the nearest.
    bits_of(x - 0.5)
}

/// The whole number nearest to `x`, which is not negative and below 2^23.
#[inline(always)]
pub(super) fn bits_of(x: f32) -> u32 {
    (x + WHOLE).to_bits() & 0x007f_ffff
}

/// The places of the bits set, ascending.
#[inline(always)]
pub(super) fn ones(word: u32) -> impl Iterator<Item = usize> {
    let rest = |word: &u32| Some(word & (word - 1)).filter(|&rest| rest != 0);
    std::iter::successors(Some(word).filter(|&word| word != 0), rest)
        .map(|word| word.trailing_zeros() as usize)
}
