//! Eigenvalues and eigenvectors of a small symmetric matrix, by cyclic Jacobi rotations (Golub and Van Loan 2013, algorithm 8.5.2).
//!
//! Three rotations a sweep and a handful of sweeps: a solver for matrices of any size would be a dependency for 40 lines. Unlike the
//! closed form for D = 3, rotations lose no digit when eigenvalues meet, as they do in flat and line-like neighbourhoods.

use super::super::vec::{add, scale, sub};

/// Sweeps after which the matrix is diagonal to rounding; convergence is quadratic, and five have been enough.
const MOST_SWEEPS: usize = 16;

/// Eigenvalues, ascending, and a unit eigenvector for each, of the symmetric matrix `c`.
pub fn eigen<const D: usize>(mut c: [[f64; D]; D]) -> ([f64; D], [[f64; D]; D]) {
    // Row a is the image of axis a under the rotations so far: an eigenvector at the end.
    let mut vectors: [[f64; D]; D] = std::array::from_fn(|a| std::array::from_fn(|b| f64::from(u8::from(a == b))));
    for _ in 0..MOST_SWEEPS {
        let mut rotated = false;
        for p in 0..D {
            for q in p + 1..D {
                // Below rounding of both diagonal entries, an entry changes neither.
                if c[p][p].abs() + c[p][q].abs() == c[p][p].abs() && c[q][q].abs() + c[p][q].abs() == c[q][q].abs() {
                    continue;
                }
                rotate(&mut c, &mut vectors, p, q);
                rotated = true;
            }
        }
        if !rotated {
            break;
        }
    }
    let mut order: [usize; D] = std::array::from_fn(|a| a);
    order.sort_by(|&a, &b| c[a][a].total_cmp(&c[b][b]).then(a.cmp(&b)));
    (order.map(|a| c[a][a]), order.map(|a| vectors[a]))
}

/// Turns axes p and q so that c_pq becomes 0.
fn rotate<const D: usize>(c: &mut [[f64; D]; D], vectors: &mut [[f64; D]; D], p: usize, q: usize) {
    // tan of the smaller of the two angles that do: t^2 + 2 theta t - 1 = 0.
    let theta = (c[q][q] - c[p][p]) / (2.0 * c[p][q]);
    let t = 1f64.copysign(theta) / (theta.abs() + theta.hypot(1.0));
    let cos = 1.0 / t.hypot(1.0);
    let sin = t * cos;
    let shift = t * c[p][q];
    c[p][p] -= shift;
    c[q][q] += shift;
    (c[p][q], c[q][p]) = (0.0, 0.0);
    for r in (0..D).filter(|&r| r != p && r != q) {
        let (rp, rq) = (c[r][p], c[r][q]);
        (c[r][p], c[r][q]) = (cos * rp - sin * rq, sin * rp + cos * rq);
        (c[p][r], c[q][r]) = (c[r][p], c[r][q]);
    }
    let (x, y) = (vectors[p], vectors[q]);
    vectors[p] = sub(scale(cos, x), scale(sin, y));
    vectors[q] = add(scale(sin, x), scale(cos, y));
}

#[cfg(test)]
mod tests {
    use super::super::super::random::SplitMix64;
    use super::super::super::vec::dot;
    use super::*;

    fn check<const D: usize>(c: [[f64; D]; D]) {
        let (values, vectors) = eigen(c);
        let largest = c.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
        for a in 0..D {
            assert!(a == 0 || values[a - 1] <= values[a]);
            for b in 0..D {
                assert!((dot(vectors[a], vectors[b]) - f64::from(u8::from(a == b))).abs() < 1e-14);
            }
            let image = c.map(|row| dot(row, vectors[a]));
            let rest = sub(image, scale(values[a], vectors[a]));
            assert!(rest.iter().all(|x| x.abs() <= 1e-14 * largest), "{c:?}: {rest:?}");
        }
    }

    #[test]
    fn eigenpairs_reproduce_random_and_singular_matrices() {
        let mut random = SplitMix64::new(4);
        for rank in [0, 1, 2, 5] {
            for exponent in [0, -200, 200] {
                let rows: Vec<[f64; 3]> = (0..rank)
                    .map(|_| std::array::from_fn(|_| random.between(-1.0, 1.0) * 2f64.powi(exponent)))
                    .collect();
                let sum = |a: usize, b: usize| rows.iter().map(|r| r[a] * r[b]).sum::<f64>();
                check::<3>(std::array::from_fn(|a| std::array::from_fn(|b| sum(a, b))));
                check::<2>(std::array::from_fn(|a| std::array::from_fn(|b| sum(a, b))));
            }
        }
        check([[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        check([[1.0, 1.0], [1.0, 1.0]]);
    }
}
