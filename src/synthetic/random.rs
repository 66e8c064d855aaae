//! Reproducible random numbers: the same seed gives the same numbers on every machine and in every version.

/// Hashes a number to 64 well-mixed bits (the finaliser of SplitMix64; Steele, Lea, Flood 2014).
pub(super) fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// Converts random bits to a number in [0, 1).
pub(super) fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

/// A stream of random numbers.
pub(super) struct Random {
    state: u64,
}

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self { state: mix(seed) }
    }

    /// The next number, uniform in [0, 1).
    pub(super) fn even(&mut self) -> f64 {
        self.state = self.state.wrapping_add(1);
        unit(mix(self.state))
    }

    /// The next two numbers of a normal distribution with mean 0 and standard deviation 1 (Box and Muller 1958).
    pub(super) fn normal_pair(&mut self) -> [f64; 2] {
        let length = (-2.0 * (1.0 - self.even()).ln()).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * self.even()).sin_cos();
        [length * cos, length * sin]
    }
}
