//! Small dense systems: of a few unknowns on the stack, of some hundreds by a stored factor.

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

/// The Cholesky factor L of a symmetric positive definite matrix, A = L L^T.
///
/// A library's would be faster and bring fifty packages; this solves systems of some hundreds of unknowns in a tenth of a millisecond.
pub struct Cholesky {
    n: usize,
    /// Rows of the lower triangle, one after the other [n (n + 1) / 2].
    rows: Vec<f64>,
}

impl Cholesky {
    /// Factors the matrix of which `rows` is the lower triangle, row after row. A pivot that falls below `least` of its diagonal entry is
    /// raised to it: the factor is then that of a matrix nearby.
    pub fn new(n: usize, mut rows: Vec<f64>, least: f64) -> Self {
        debug_assert_eq!(rows.len(), n * (n + 1) / 2);
        let start = |i: usize| i * (i + 1) / 2;
        for i in 0..n {
            let (above, row) = rows.split_at_mut(start(i));
            for j in 0..i {
                let other = &above[start(j)..start(j + 1)];
                row[j] = (row[j] - dot(&row[..j], &other[..j])) / other[j];
            }
            let diagonal = row[i];
            row[i] = (diagonal - dot(&row[..i], &row[..i])).max(least * diagonal).sqrt();
        }
        Cholesky { n, rows }
    }

    /// Unknowns.
    pub fn n_unknowns(&self) -> usize {
        self.n
    }

    /// b becomes the x of A x = b.
    pub fn solve(&self, b: &mut [f64]) {
        let row = |i: usize| &self.rows[i * (i + 1) / 2..][..i + 1];
        for i in 0..self.n {
            let row = row(i);
            b[i] = (b[i] - dot(&row[..i], &b[..i])) / row[i];
        }
        for i in (0..self.n).rev() {
            let row = row(i);
            b[i] /= row[i];
            let x = b[i];
            b[..i].iter_mut().zip(row).for_each(|(b, l)| *b -= l * x);
        }
    }
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
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
    fn a_factor_solves_at_every_small_size() {
        let mut random = SplitMix64::new(2);
        for n in (0..20).chain([100]) {
            // A = M M^T + I
            let m: Vec<Vec<f64>> = (0..n).map(|_| (0..n).map(|_| random.between(-1.0, 1.0)).collect()).collect();
            let entry = |i: usize, j: usize| f64::from(u8::from(i == j)) + dot(&m[i], &m[j]);
            let rows = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|(i, j)| entry(i, j)).collect();
            let x: Vec<f64> = (0..n).map(|_| random.between(-1.0, 1.0)).collect();
            let mut b: Vec<f64> = (0..n).map(|i| (0..n).map(|j| entry(i, j) * x[j]).sum()).collect();
            let factor = Cholesky::new(n, rows, 0.0);
            assert_eq!(factor.n_unknowns(), n);
            factor.solve(&mut b);
            assert!(b.iter().zip(&x).all(|(b, x)| (b - x).abs() < 1e-11), "size {n}");
        }
    }

    #[test]
    fn singular_matrices_have_no_solution() {
        assert_eq!(solve_cholesky([[1.0, 1.0], [1.0, 1.0]], [1.0, 1.0], 1e-12), None);
        assert_eq!(solve_cholesky([[0.0]], [1.0], 1e-12), None);
        assert_eq!(solve_cholesky([[f64::NAN]], [1.0], 1e-12), None);
    }
}
