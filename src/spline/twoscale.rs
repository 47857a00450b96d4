//! The two-scale relation of uniform cubic B-splines: every spline on cells of edge 2h is one on cells of edge h.
//!
//! B^{2h}_I = sum_k s_k B^h_{2I - 3 + k}, s = (1, 4, 6, 4, 1) / 8; fine functions without support in the box are dropped.

const S: [f64; 5] = [0.125, 0.5, 0.75, 0.5, 0.125];

/// Cells of the axis with cells twice as long: the last one may reach beyond the box.
pub fn coarser(n_cells: usize) -> usize {
    n_cells.div_ceil(2)
}

/// Fine control points under the coarse one `big_i`, with their coefficients.
fn children(big_i: usize, n_fine: usize) -> impl Iterator<Item = (usize, f64)> {
    (0..5).filter_map(move |k| {
        let i = (2 * big_i + k).checked_sub(3)?;
        (i < n_fine).then_some((i, S[k]))
    })
}

/// A tensor of control points as `outer` slices of `n` rows of `inner` contiguous numbers: one axis of it in the middle.
#[derive(Debug, Clone, Copy)]
pub struct Along {
    /// Product of the lengths of the axes before.
    pub outer: usize,
    /// Product of the lengths of the axes behind.
    pub inner: usize,
}

impl Along {
    /// fine += P coarse along this axis, P the two-scale matrix.
    pub fn prolong(self, coarse: &[f64], n_coarse: usize, fine: &mut [f64], n_fine: usize) {
        let m = self.inner;
        for o in 0..self.outer {
            let coarse = &coarse[o * n_coarse * m..][..n_coarse * m];
            let fine = &mut fine[o * n_fine * m..][..n_fine * m];
            for big_i in 0..n_coarse {
                let from = &coarse[big_i * m..][..m];
                for (i, s) in children(big_i, n_fine) {
                    fine[i * m..][..m].iter_mut().zip(from).for_each(|(f, c)| *f += s * c);
                }
            }
        }
    }

    /// coarse += P^T fine along this axis.
    pub fn restrict(self, fine: &[f64], n_fine: usize, coarse: &mut [f64], n_coarse: usize) {
        let m = self.inner;
        for o in 0..self.outer {
            let fine = &fine[o * n_fine * m..][..n_fine * m];
            let coarse = &mut coarse[o * n_coarse * m..][..n_coarse * m];
            for big_i in 0..n_coarse {
                let to = &mut coarse[big_i * m..][..m];
                for (i, s) in children(big_i, n_fine) {
                    to.iter_mut().zip(&fine[i * m..][..m]).for_each(|(c, f)| *c += s * f);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::basis::Weights;

    fn value(c: &[f64], xi: f64) -> f64 {
        let i = (xi as usize).min(c.len() - 4);
        Weights::at(xi - i as f64).w.iter().zip(&c[i..]).map(|(w, c)| w * c).sum()
    }

    #[test]
    fn a_prolonged_spline_is_the_same_function_on_odd_and_even_axes() {
        for n_cells in 1..=9 {
            let n_coarse = coarser(n_cells) + 3;
            let coarse: Vec<f64> = (0..n_coarse).map(|i| ((i * i * 7 + 3) % 11) as f64).collect();
            let mut fine = vec![0.0; n_cells + 3];
            Along { outer: 1, inner: 1 }.prolong(&coarse, n_coarse, &mut fine, n_cells + 3);
            for step in 0..=10 * n_cells {
                let xi = step as f64 / 10.0;
                assert!((value(&fine, xi) - value(&coarse, xi / 2.0)).abs() < 1e-13, "{n_cells} cells at {xi}");
            }
        }
    }

    #[test]
    fn restriction_is_the_transpose_of_prolongation() {
        let (n_cells, along) = (6, Along { outer: 2, inner: 3 });
        let (nf, nc) = (n_cells + 3, coarser(n_cells) + 3);
        let fine: Vec<f64> = (0..6 * nf).map(|i| (i as f64 * 0.7).sin()).collect();
        let coarse: Vec<f64> = (0..6 * nc).map(|i| (i as f64 * 1.3).cos()).collect();
        let (mut up, mut down) = (vec![0.0; 6 * nf], vec![0.0; 6 * nc]);
        along.prolong(&coarse, nc, &mut up, nf);
        along.restrict(&fine, nf, &mut down, nc);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        assert!((dot(&up, &fine) - dot(&coarse, &down)).abs() < 1e-12);
    }
}
