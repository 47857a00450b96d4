//! Instruction sets: one source of a kernel, compiled for each, and the best that the machine has taken at run time.
//!
//! A kernel is written once over [`Isa`], with every function down to the arithmetic `#[inline(always)]`, so that the whole of it is compiled
//! with the instructions of the set that it runs on. Results of two sets differ by rounding: a fused multiply-add rounds once. On one
//! machine they are the same bits in every run.

/// What a set of instructions adds to Rust's arithmetic.
pub trait Isa: Copy + Send + Sync {
    /// a b + c, rounded once or twice.
    fn mul_add(a: f64, b: f64, c: f64) -> f64;

    /// a b + c in single precision.
    fn mul_add_f32(a: f32, b: f32, c: f32) -> f32;
}

/// What every target has.
#[derive(Debug, Clone, Copy)]
pub struct Portable;

impl Isa for Portable {
    #[inline(always)]
    fn mul_add(a: f64, b: f64, c: f64) -> f64 {
        a * b + c
    }

    #[inline(always)]
    fn mul_add_f32(a: f32, b: f32, c: f32) -> f32 {
        a * b + c
    }
}

/// AVX2 with fused multiply-add: x86-64 since 2013.
#[derive(Debug, Clone, Copy)]
pub struct Avx2;

impl Isa for Avx2 {
    #[inline(always)]
    fn mul_add(a: f64, b: f64, c: f64) -> f64 {
        a.mul_add(b, c)
    }

    #[inline(always)]
    fn mul_add_f32(a: f32, b: f32, c: f32) -> f32 {
        a.mul_add(b, c)
    }
}

/// Work that is worth instructions of its own: a batch, not a point.
pub trait Kernel {
    /// What it gives.
    type Output;

    /// Does the work; `#[inline(always)]`, like all that it calls for each number.
    fn run<I: Isa>(self) -> Self::Output;
}

/// Runs `kernel` with the best instructions that this machine has.
#[inline]
pub fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx2,fma")]
        fn with_avx2<K: Kernel>(kernel: K) -> K::Output {
            kernel.run::<Avx2>()
        }
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
            // SAFETY: the machine has both features.
            return unsafe { with_avx2(kernel) };
        }
    }
    kernel.run::<Portable>()
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Dot<'a>(&'a [f64], &'a [f64]);

    impl Kernel for Dot<'_> {
        type Output = f64;

        #[inline(always)]
        fn run<I: Isa>(self) -> f64 {
            self.0.iter().zip(self.1).fold(0.0, |s, (x, y)| I::mul_add(*x, *y, s))
        }
    }

    #[test]
    fn sets_agree_to_rounding() {
        let x: Vec<f64> = (0..100).map(|i| f64::from(i).sin()).collect();
        let y: Vec<f64> = (0..100).map(|i| f64::from(i).cos()).collect();
        let (best, portable) = (dispatch(Dot(&x, &y)), Dot(&x, &y).run::<Portable>());
        assert!((best - portable).abs() < 1e-13, "{best} {portable}");
        // Bits do not depend on when it is run.
        assert_eq!(best, dispatch(Dot(&x, &y)));
    }
}
