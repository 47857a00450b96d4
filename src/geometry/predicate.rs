//! On which side of a line a point of the plane lies, without error.
//!
//! A filter decides where rounding cannot; else the determinant is summed up exactly, as a sum of numbers that do not overlap. After
//! Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates" (1997):
//!
//! | there | here |
//! |---|---|
//! | figure 21, first stage: error bound (3 + 16 eps) eps | [`orientation`] |
//! | theorem 18, two-product, here by fused multiply-add | [`two_product`] |
//! | theorem 7, two-sum | [`two_sum`] |
//! | theorem 10, grow-expansion | [`exact_orientation`] |
//!
//! Exact while no product of coordinates under- or overflows: with coordinates of size 1, for those that are 0 or above 1e-140.

use std::cmp::Ordering;

/// Shewchuk's eps is half of Rust's.
const FILTER: f64 = (3.0 + 8.0 * f64::EPSILON) * 0.5 * f64::EPSILON;

/// `Greater` where c lies to the left of the line from a to b, `Less` to its right, `Equal` on it.
pub(super) fn orientation(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Ordering {
    let left = (a[0] - c[0]) * (b[1] - c[1]);
    let right = (a[1] - c[1]) * (b[0] - c[0]);
    let det = left - right;
    if det.abs() > FILTER * (left.abs() + right.abs()) {
        return if det > 0.0 { Ordering::Greater } else { Ordering::Less };
    }
    exact_orientation(a, b, c)
}

/// The sign of a x b + b x c + c x a.
#[cold]
fn exact_orientation(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Ordering {
    let products = [(a[0], b[1]), (-a[1], b[0]), (b[0], c[1]), (-b[1], c[0]), (c[0], a[1]), (-c[1], a[0])];
    let mut expansion = [0.0; 12];
    let terms = products.iter().flat_map(|&(x, y)| two_product(x, y));
    for (n, mut carry) in terms.enumerate() {
        for e in &mut expansion[..n] {
            (carry, *e) = two_sum(carry, *e);
        }
        expansion[n] = carry;
    }
    // The numbers do not overlap and grow: the last that is not 0 outweighs all before it.
    let sign = expansion.iter().rfind(|e| **e != 0.0).copied().unwrap_or(0.0);
    sign.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}

/// x y as its rounding error and its rounded value: small first, as an expansion grows.
fn two_product(x: f64, y: f64) -> [f64; 2] {
    let product = x * y;
    [x.mul_add(y, -product), product]
}

/// x + y as its rounded value and its rounding error.
fn two_sum(x: f64, y: f64) -> (f64, f64) {
    let sum = x + y;
    let of_y = sum - x;
    (sum, (x - (sum - of_y)) + (y - of_y))
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::*;

    #[test]
    fn agrees_with_integers_on_and_beside_lines() {
        let mut random = SplitMix64::new(1);
        let mut on_the_line = 0;
        for k in 0..20_000 {
            // Up to 2^50, so that coordinates are exact and determinants are not.
            let size = 1_i64 << (10 + k % 41);
            let mut below = |n: i64| (random.bits() % (2 * n as u64)) as i64 - n;
            let a = [below(size), below(size)];
            let step = [below(size), below(size)];
            let (s, t) = (below(4), below(4));
            let along = |t: i64, off: [i64; 2]| [a[0] + t * step[0] + off[0], a[1] + t * step[1] + off[1]];
            let (b, c) = (along(s, [0, 0]), along(t, [below(1), below(1)]));
            let [ux, uy] = [0, 1].map(|i| i128::from(b[i] - a[i]));
            let [vx, vy] = [0, 1].map(|i| i128::from(c[i] - a[i]));
            let expected = (ux * vy).cmp(&(uy * vx));
            on_the_line += i32::from(expected.is_eq());
            let [a, b, c] = [a, b, c].map(|p| p.map(|x| x as f64 / (1_u64 << 53) as f64));
            assert_eq!(orientation(a, b, c), expected, "{a:?} {b:?} {c:?}");
            assert_eq!(orientation(c, a, b), expected);
            assert_eq!(orientation(b, a, c), expected.reverse());
        }
        assert!(on_the_line > 2000, "{on_the_line}");
    }

    #[test]
    fn one_bit_beside_a_line_is_seen() {
        let (a, b) = ([12.0, 12.0], [24.0, 24.0]);
        for i in 0..100_u64 {
            for j in 0..100_u64 {
                let c = [0.5 + i as f64 * 0.5 * f64::EPSILON, 0.5 + j as f64 * 0.5 * f64::EPSILON];
                assert_eq!(orientation(a, b, c), j.cmp(&i));
            }
        }
    }
}
