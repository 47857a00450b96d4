//! Pseudo-random numbers from a seed: the same on every machine, and in every version of this crate.

/// SplitMix64: Steele, Lea and Flood, "Fast splittable pseudorandom number generators" (2014). Every seed is a good seed.
#[derive(Debug, Clone)]
pub struct SplitMix64 {
    state: u64,
}

impl SplitMix64 {
    /// A generator that starts at `seed`.
    pub fn new(seed: u64) -> Self {
        SplitMix64 { state: seed }
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// The next number of [0, 1), uniform, a multiple of 2^-53.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * f64::EPSILON * 0.5
    }

    /// The next number of [low, high), uniform.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gives_the_published_sequence() {
        let mut random = SplitMix64::new(1_234_567);
        assert_eq!(
            [random.bits(), random.bits(), random.bits()],
            [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]
        );
    }

    #[test]
    fn unit_has_the_moments_of_the_uniform_distribution() {
        let mut random = SplitMix64::new(7);
        let n = 100_000;
        let u: Vec<f64> = (0..n).map(|_| random.unit()).collect();
        let mean = u.iter().sum::<f64>() / n as f64;
        let square = u.iter().map(|x| x * x).sum::<f64>() / n as f64;
        // Five standard deviations: sqrt(1/12 / n) and sqrt(4/45 / n).
        assert!((mean - 0.5).abs() < 5.0 * (1.0 / 12.0 / n as f64).sqrt());
        assert!((square - 1.0 / 3.0).abs() < 5.0 * (4.0 / 45.0 / n as f64).sqrt());
        assert!(u.iter().all(|x| (0.0..1.0).contains(x)));
    }
}
