//! Instruction sets: one source of a kernel, compiled for each, and the best that the machine has taken at run time.
//!
//! A kernel is written once over [`Isa`], with every function down to the arithmetic `#[inline(always)]`, so that the whole of it is
//! compiled with the instructions of the set that it runs on. Results of two sets differ by rounding: a fused multiply-add rounds once. On
//! one machine they are the same bits in every run.
//!
//! The unsafe code is the instructions on registers. Plain arrays of four and eight numbers in their place, compiled for the same set, took
//! two to four times as long: 36, 43 and 73 ns a point for value, gradient and Hessian instead of 10.6, 18.2 and 30.0, and an iteration of
//! a fit, with the solves of its blocks, 52 ms instead of 24.

/// What a set of instructions adds to Rust's arithmetic.
pub trait Isa: Copy + Send + Sync {
    /// Four numbers that are reckoned with at once.
    type Four: Copy;

    /// Whether [`Isa::mul_add`] is one instruction that rounds once: then polynomials are cheapest by Horner's rule.
    const FUSED: bool;

    /// a b + c, rounded once or twice.
    fn mul_add(a: f64, b: f64, c: f64) -> f64;

    /// The whole part of a number that is at least 0 and below 2^63, in both types.
    fn whole(x: f64) -> (usize, f64);

    /// Four numbers from memory.
    fn load(row: &[f64; 4]) -> Self::Four;

    /// Four numbers to memory.
    fn store(x: Self::Four, row: &mut [f64; 4]);

    /// One number four times.
    fn splat(x: f64) -> Self::Four;

    /// a + b
    fn add_4(a: Self::Four, b: Self::Four) -> Self::Four;

    /// a - b
    fn sub_4(a: Self::Four, b: Self::Four) -> Self::Four;

    /// a b
    fn mul_4(a: Self::Four, b: Self::Four) -> Self::Four;

    /// a b + c, rounded once or twice.
    fn mul_add_4(a: Self::Four, b: Self::Four, c: Self::Four) -> Self::Four;

    /// (x_0 + x_1) + (x_2 + x_3)
    fn sum(x: Self::Four) -> f64;

    /// [`Isa::sum`] of each of four, in fewer steps: the same bits.
    fn sum_4(x: [Self::Four; 4]) -> Self::Four;

    /// Eight numbers of single precision that are reckoned with at once.
    type Eight: Copy;

    /// Eight numbers from memory.
    fn load_8(row: &[f32; 8]) -> Self::Eight;

    /// Eight numbers to memory.
    fn store_8(x: Self::Eight, row: &mut [f32; 8]);

    /// One number eight times.
    fn splat_8(x: f32) -> Self::Eight;

    /// a + b
    fn add_8(a: Self::Eight, b: Self::Eight) -> Self::Eight;

    /// a b
    fn mul_8(a: Self::Eight, b: Self::Eight) -> Self::Eight;

    /// c - a b, rounded once or twice.
    fn mul_sub_8(a: Self::Eight, b: Self::Eight, c: Self::Eight) -> Self::Eight;
}

/// What every target has.
#[derive(Debug, Clone, Copy)]
pub struct Portable;

impl Isa for Portable {
    type Four = [f64; 4];

    const FUSED: bool = false;

    #[inline(always)]
    fn mul_add(a: f64, b: f64, c: f64) -> f64 {
        a * b + c
    }

    #[inline(always)]
    fn whole(x: f64) -> (usize, f64) {
        (x as usize, x as i64 as f64)
    }

    #[inline(always)]
    fn load(row: &[f64; 4]) -> [f64; 4] {
        *row
    }

    #[inline(always)]
    fn store(x: [f64; 4], row: &mut [f64; 4]) {
        *row = x;
    }

    #[inline(always)]
    fn splat(x: f64) -> [f64; 4] {
        [x; 4]
    }

    #[inline(always)]
    fn add_4(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|k| a[k] + b[k])
    }

    #[inline(always)]
    fn sub_4(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|k| a[k] - b[k])
    }

    #[inline(always)]
    fn mul_4(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|k| a[k] * b[k])
    }

    #[inline(always)]
    fn mul_add_4(a: [f64; 4], b: [f64; 4], c: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|k| a[k] * b[k] + c[k])
    }

    #[inline(always)]
    fn sum(x: [f64; 4]) -> f64 {
        (x[0] + x[1]) + (x[2] + x[3])
    }

    #[inline(always)]
    fn sum_4(x: [[f64; 4]; 4]) -> [f64; 4] {
        std::array::from_fn(|k| Self::sum(x[k]))
    }

    type Eight = [f32; 8];

    #[inline(always)]
    fn load_8(row: &[f32; 8]) -> [f32; 8] {
        *row
    }

    #[inline(always)]
    fn store_8(x: [f32; 8], row: &mut [f32; 8]) {
        *row = x;
    }

    #[inline(always)]
    fn splat_8(x: f32) -> [f32; 8] {
        [x; 8]
    }

    #[inline(always)]
    fn add_8(a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        std::array::from_fn(|k| a[k] + b[k])
    }

    #[inline(always)]
    fn mul_8(a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        std::array::from_fn(|k| a[k] * b[k])
    }

    #[inline(always)]
    fn mul_sub_8(a: [f32; 8], b: [f32; 8], c: [f32; 8]) -> [f32; 8] {
        std::array::from_fn(|k| c[k] - a[k] * b[k])
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::Isa;
    use std::arch::x86_64::*;

    /// AVX2 with fused multiply-add: x86-64 since 2013. Seen by [`super::dispatch`] alone, which takes it where the machine has both: so
    /// every function here runs on such a machine.
    #[derive(Debug, Clone, Copy)]
    pub(super) struct Avx2;

    impl Isa for Avx2 {
        type Four = __m256d;

        const FUSED: bool = true;

        #[inline(always)]
        fn mul_add(a: f64, b: f64, c: f64) -> f64 {
            a.mul_add(b, c)
        }

        #[inline(always)]
        fn whole(x: f64) -> (usize, f64) {
            // The double not from the index: that conversion writes half a register, and would wait for what it held for the last point.
            // SAFETY: every x86-64 has SSE2.
            (unsafe { _mm_cvttsd_si64(_mm_set_sd(x)) as usize }, x.floor())
        }

        #[inline(always)]
        fn load(row: &[f64; 4]) -> __m256d {
            // SAFETY: see `Avx2`; the row has four numbers.
            unsafe { _mm256_loadu_pd(row.as_ptr()) }
        }

        #[inline(always)]
        fn store(x: __m256d, row: &mut [f64; 4]) {
            // SAFETY: see `Avx2`; the row has room for four numbers.
            unsafe { _mm256_storeu_pd(row.as_mut_ptr(), x) }
        }

        #[inline(always)]
        fn splat(x: f64) -> __m256d {
            // SAFETY: see `Avx2`.
            unsafe { _mm256_set1_pd(x) }
        }

        #[inline(always)]
        fn add_4(a: __m256d, b: __m256d) -> __m256d {
            // SAFETY: see `Avx2`.
            unsafe { _mm256_add_pd(a, b) }
        }

        #[inline(always)]
        fn sub_4(a: __m256d, b: __m256d) -> __m256d {
            // SAFETY: see `Avx2`.
            unsafe { _mm256_sub_pd(a, b) }
        }

        #[inline(always)]
        fn mul_4(a: __m256d, b: __m256d) -> __m256d {
            // SAFETY: see `Avx2`.
            unsafe { _mm256_mul_pd(a, b) }
        }

        #[inline(always)]
        fn mul_add_4(a: __m256d, b: __m256d, c: __m256d) -> __m256d {
            // SAFETY: see `Avx2`.
            unsafe { _mm256_fmadd_pd(a, b, c) }
        }

        #[inline(always)]
        fn sum(x: __m256d) -> f64 {
            // SAFETY: see `Avx2`.
            unsafe {
                let pairs = _mm256_hadd_pd(x, x);
                _mm_cvtsd_f64(_mm_add_sd(_mm256_castpd256_pd128(pairs), _mm256_extractf128_pd::<1>(pairs)))
            }
        }

        #[inline(always)]
        fn sum_4(x: [__m256d; 4]) -> __m256d {
            // SAFETY: see `Avx2`.
            unsafe {
                let (a, b) = (_mm256_hadd_pd(x[0], x[1]), _mm256_hadd_pd(x[2], x[3]));
                _mm256_add_pd(_mm256_blend_pd::<0b1100>(a, b), _mm256_permute2f128_pd::<0x21>(a, b))
            }
        }

        type Eight = __m256;

        #[inline(always)]
        fn load_8(row: &[f32; 8]) -> __m256 {
            // SAFETY: see `Avx2`; the row has eight numbers.
            unsafe { _mm256_loadu_ps(row.as_ptr()) }
        }

        #[inline(always)]
        fn store_8(x: __m256, row: &mut [f32; 8]) {
            // SAFETY: see `Avx2`; the row has room for eight numbers.
            unsafe { _mm256_storeu_ps(row.as_mut_ptr(), x) }
        }

        #[inline(always)]
        fn splat_8(x: f32) -> __m256 {
            // SAFETY: see `Avx2`.
            unsafe { _mm256_set1_ps(x) }
        }

        #[inline(always)]
        fn add_8(a: __m256, b: __m256) -> __m256 {
            // SAFETY: see `Avx2`.
            unsafe { _mm256_add_ps(a, b) }
        }

        #[inline(always)]
        fn mul_8(a: __m256, b: __m256) -> __m256 {
            // SAFETY: see `Avx2`.
            unsafe { _mm256_mul_ps(a, b) }
        }

        #[inline(always)]
        fn mul_sub_8(a: __m256, b: __m256, c: __m256) -> __m256 {
            // SAFETY: see `Avx2`.
            unsafe { _mm256_fnmadd_ps(a, b, c) }
        }
    }
}

/// Asks for the memory of `x`, which is to be read soon: a hint.
#[inline(always)]
pub fn prefetch(x: &f64) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: every x86-64 has the instruction; it reads nothing that a program sees.
    unsafe {
        std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(std::ptr::from_ref(x).cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = x;
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
            kernel.run::<avx2::Avx2>()
        }
        /// The same instructions, and so the same bits, with 32 registers for 16: evaluations spill fewer numbers.
        #[target_feature(enable = "avx2,fma,avx512f,avx512vl")]
        fn with_more_registers<K: Kernel>(kernel: K) -> K::Output {
            kernel.run::<avx2::Avx2>()
        }
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
            if std::arch::is_x86_feature_detected!("avx512f") && std::arch::is_x86_feature_detected!("avx512vl") {
                // SAFETY: the machine has all four features.
                return unsafe { with_more_registers(kernel) };
            }
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

    /// Four vectors of numbers that round when they are added.
    struct Sums([[f64; 4]; 4]);

    impl Kernel for Sums {
        type Output = ([f64; 4], [f64; 4]);

        #[inline(always)]
        fn run<I: Isa>(self) -> Self::Output {
            let x = [I::load(&self.0[0]), I::load(&self.0[1]), I::load(&self.0[2]), I::load(&self.0[3])];
            let mut together = [0.0; 4];
            I::store(I::sum_4(x), &mut together);
            (together, [I::sum(x[0]), I::sum(x[1]), I::sum(x[2]), I::sum(x[3])])
        }
    }

    #[test]
    fn four_sums_together_are_those_one_by_one() {
        for i in 0..100 {
            let x = std::array::from_fn(|a| std::array::from_fn(|b| f64::from(i + 100 * (4 * a + b) as i32).sin()));
            let (together, apart) = dispatch(Sums(x));
            assert_eq!(together, apart);
            assert_eq!(together, x.map(Portable::sum));
            assert_eq!(Sums(x).run::<Portable>(), (together, apart));
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
