//! Numbers of several rays side by side: loops over them become vector instructions.

/// Rays of a packet.
pub const LANES: usize = 8;

/// One number for each ray.
pub type Lanes = [f32; LANES];

/// For each ray whether something holds: no bit is set, or all.
pub type Mask = [u32; LANES];

/// Added to a number, it leaves the nearest whole one in the low bits.
const WHOLE: f32 = 8_388_608.0;

/// The whole number below `x`, from 0 on; it may be 1 less where `x` is a whole number itself.
#[inline(always)]
pub fn whole(x: f32) -> i32 {
    (((x - 0.5).max(0.0) + WHOLE).to_bits() & 0x007f_ffff) as i32
}

/// Whether something holds for any ray.
#[inline(always)]
pub fn any(mask: &Mask) -> bool {
    let mut all = 0;
    for one in mask {
        all |= one;
    }
    all != 0
}

/// All bits, if `condition` holds.
#[inline(always)]
pub fn mask(condition: bool) -> u32 {
    u32::from(condition).wrapping_neg()
}

/// `yes` where all bits of the mask are set, else `no`. Bits, since a branch would become a store under a mask, which is slow.
#[inline(always)]
pub fn select(mask: u32, yes: f32, no: f32) -> f32 {
    f32::from_bits(yes.to_bits() & mask | no.to_bits() & !mask)
}
