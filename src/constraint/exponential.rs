//! exp of many numbers at once, for weights that fall exponentially.
//!
//! 2^k exp(r) with k the nearest whole number to x / ln 2 and |r| <= ln(2) / 2, exp(r) by its series to the thirteenth power, whose rest is
//! below 1e-17. A loop without branches: the compiler makes vectors of it, where the system's exp takes some 5 ns a number.

use crate::isa::Isa;

/// ln 2 in two parts: k times the first is exact.
const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];

/// Added to a number of moderate size it leaves the nearest whole number in the last bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// Below it exp is taken to be 0: it is about to leave the range of normal numbers.
const SMALLEST: f64 = -708.0;

/// 1 / n!
const FACTORIALS: [f64; 14] = [
    1.0,
    1.0,
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5_040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
];

/// exp(x) of a number that is at most 0, to some 2e-16 of it; 0 below [`SMALLEST`], where it is below 4e-308.
#[inline(always)]
pub fn exp_of_negative<I: Isa>(x: f64) -> f64 {
    let small = x < SMALLEST;
    let x = if small { SMALLEST } else { x };
    let rounded = I::mul_add(x, std::f64::consts::LOG2_E, ROUND);
    let k = rounded - ROUND;
    let r = I::mul_add(-k, LN_2[1], I::mul_add(-k, LN_2[0], x));
    let mut series = FACTORIALS[13];
    for c in FACTORIALS[..13].iter().rev() {
        series = I::mul_add(series, r, *c);
    }
    // The exponent's bits are above the 52 of the fraction.
    let power = f64::from_bits(series.to_bits().wrapping_add(rounded.to_bits() << 52));
    if small { 0.0 } else { power }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;
    use crate::isa::{Kernel, Portable, dispatch};

    struct Exponentials<'a>(&'a [f64]);

    impl Kernel for Exponentials<'_> {
        type Output = Vec<f64>;

        #[inline(always)]
        fn run<I: Isa>(self) -> Vec<f64> {
            self.0.iter().map(|x| exp_of_negative::<I>(*x)).collect()
        }
    }

    #[test]
    fn it_is_exp() {
        let mut random = SplitMix64::new(1);
        let mut x =
            vec![0.0, -0.0, -1e-300, -1e-17, -0.5 * std::f64::consts::LN_2, -707.9, -708.1, -1e300, f64::NEG_INFINITY];
        x.extend((0..100_000).map(|_| -random.unit() * 10f64.powf(random.between(-6.0, 2.8))));
        for values in [dispatch(Exponentials(&x)), Exponentials(&x).run::<Portable>()] {
            for (x, e) in x.iter().zip(values) {
                let exact = if *x < SMALLEST { 0.0 } else { x.exp() };
                assert!((e - exact).abs() <= 4e-16 * exact, "{x}: {e} {exact}");
            }
        }
    }
}
