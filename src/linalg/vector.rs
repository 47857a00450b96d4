//! Vector sums in a fixed order: the same bits on any number of threads.

use crate::par::Workers;

/// Entries of one item of work.
pub const CHUNK: usize = 8192;

/// x . y
pub fn dot(workers: &Workers, x: &[f64], y: &[f64]) -> f64 {
    debug_assert_eq!(x.len(), y.len());
    let partial = |c: usize| {
        let (x, y) = (chunk(x, c), chunk(y, c));
        // Four sums at once, so that the compiler may use vectors.
        let mut s = [0.0; 4];
        let (x4, y4) = (x.chunks_exact(4), y.chunks_exact(4));
        let rest: f64 = x4.remainder().iter().zip(y4.remainder()).map(|(x, y)| x * y).sum();
        for (x, y) in x4.zip(y4) {
            for k in 0..4 {
                s[k] += x[k] * y[k];
            }
        }
        (s[0] + s[1]) + (s[2] + s[3]) + rest
    };
    workers.map(x.len().div_ceil(CHUNK), partial).into_iter().sum()
}

/// |x|
pub fn norm(workers: &Workers, x: &[f64]) -> f64 {
    dot(workers, x, x).sqrt()
}

/// y = f(x, y), entry by entry.
pub fn update(workers: &Workers, y: &mut [f64], x: &[f64], f: impl Fn(f64, f64) -> f64 + Send + Sync) {
    workers.for_each(y.chunks_mut(CHUNK).zip(x.chunks(CHUNK)), |(y, x)| {
        y.iter_mut().zip(x).for_each(|(y, x)| *y = f(*x, *y));
    });
}

fn chunk(x: &[f64], c: usize) -> &[f64] {
    &x[c * CHUNK..((c + 1) * CHUNK).min(x.len())]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dot_is_the_sum_of_products_at_every_length() {
        for n in (0..10).chain([CHUNK - 1, CHUNK, CHUNK + 1, 3 * CHUNK + 5]) {
            // Small integers, whose sums are exact in any order.
            let x: Vec<f64> = (0..n).map(|i| (i % 7) as f64).collect();
            let y: Vec<f64> = (0..n).map(|i| (i % 5) as f64 - 2.0).collect();
            let expected: f64 = x.iter().zip(&y).map(|(x, y)| x * y).sum();
            assert_eq!(dot(&Workers::caller_only(), &x, &y), expected, "length {n}");
        }
    }
}
