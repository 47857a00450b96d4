//! Small dense systems, on the stack.

/// Solves A x = b for a symmetric positive definite A of which the lower triangle is given, by A = L L^T. `None` where a pivot falls below
/// `least` of its diagonal entry: A is singular, or nearly.
pub fn solve_cholesky<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N], least: f64) -> Option<[f64; N]> {
    for j in 0..N {
        let pivot = (0..j).fold(a[j][j], |p, k| p - a[j][k] * a[j][k]);
        if pivot.is_nan() || pivot <= least * a[j][j] {
            return None;
        }
        let root = pivot.sqrt();
        for i in j + 1..N {
            a[i][j] = (0..j).fold(a[i][j], |s, k| s - a[i][k] * a[j][k]) / root;
        }
        a[j][j] = root;
    }
    // L y = b, then L^T x = y.
    for i in 0..N {
        b[i] = (0..i).fold(b[i], |s, k| s - a[i][k] * b[k]) / a[i][i];
    }
    for i in (0..N).rev() {
        b[i] = (i + 1..N).fold(b[i], |s, k| s - a[k][i] * b[k]) / a[i][i];
    }
    Some(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;

    fn check<const N: usize>(random: &mut SplitMix64) {
        // A = M M^T + I
        let m: [[f64; N]; N] = std::array::from_fn(|_| std::array::from_fn(|_| random.between(-1.0, 1.0)));
        let a: [[f64; N]; N] = std::array::from_fn(|i| {
            std::array::from_fn(|j| f64::from(i == j) + (0..N).map(|k| m[i][k] * m[j][k]).sum::<f64>())
        });
        let x: [f64; N] = std::array::from_fn(|_| random.between(-1.0, 1.0));
        let b = std::array::from_fn(|i| (0..N).map(|j| a[i][j] * x[j]).sum());
        let found = solve_cholesky(a, b, 1e-12).unwrap();
        assert!(found.iter().zip(&x).all(|(f, x)| (f - x).abs() < 1e-13), "{found:?} {x:?}");
    }

    #[test]
    fn solves_what_was_multiplied() {
        let mut random = SplitMix64::new(1);
        for _ in 0..20 {
            check::<1>(&mut random);
            check::<3>(&mut random);
            check::<6>(&mut random);
        }
    }

    #[test]
    fn singular_matrices_have_no_solution() {
        assert_eq!(solve_cholesky([[1.0, 1.0], [1.0, 1.0]], [1.0, 1.0], 1e-12), None);
        assert_eq!(solve_cholesky([[0.0]], [1.0], 1e-12), None);
        assert_eq!(solve_cholesky([[f64::NAN]], [1.0], 1e-12), None);
    }
}
