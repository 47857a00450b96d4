//! The system of a fit and its preconditioner: multilevel diagonal scaling (Bramble, Pasciak and Xu 1990; Zhang 1992).
//!
//! ```text
//! M = sum_l P_l D_l^-1 P_l^T
//! ```
//!
//! over nested grids with cells 2^l times as long: P_l the two-scale relation down to the finest grid, D_l the diagonal of the energy on
//! grid l. An application costs less than one of A, since nothing but diagonals is kept of the coarser grids. What is left to slow the solve is
//! the contrast between data and regularisation inside a cell, which no hierarchy of grids sees.

use super::energy::Energy;
use crate::Result;
use crate::error::try_vec;
use crate::linalg::cg::System;
use crate::linalg::vector::update;
use crate::par::Workers;
use crate::spline::twoscale::Along;

/// One grid of the hierarchy.
struct Level {
    shape: [usize; 3],
    /// 1 / diagonal of the energy [n]
    inverse_diagonal: Vec<f64>,
    /// What has been restricted to this level, then its correction [n]
    residual: Vec<f64>,
}

impl Level {
    fn new(energy: &mut Energy, workers: &Workers) -> Result<Self> {
        let mut inverse_diagonal = energy.diagonal(workers)?;
        inverse_diagonal.iter_mut().for_each(|d| *d = 1.0 / *d);
        let residual = try_vec(inverse_diagonal.len(), 0.0, "a level of the preconditioner")?;
        Ok(Level { shape: energy.shape(), inverse_diagonal, residual })
    }
}

/// A x = b of the minimum (11), with M.
pub struct Multilevel {
    energy: Energy,
    /// Finest first.
    levels: Vec<Level>,
    scratch: [Vec<f64>; 2],
}

impl Multilevel {
    /// The system of `energy`, with grids down to one cell along every axis.
    pub fn new(mut energy: Energy, workers: &Workers) -> Result<Self> {
        energy.reserve()?;
        let mut levels = vec![Level::new(&mut energy, workers)?];
        let n = levels[0].residual.len();
        let scratch = || try_vec(n, 0.0, "the work space of the preconditioner");
        let scratch = [scratch()?, scratch()?];
        let mut coarsest = energy.coarser()?;
        // Once no axis has more than one cell a coarser grid has the same functions.
        while levels.last().is_some_and(|l| l.shape.iter().any(|&n| n > 4)) {
            levels.push(Level::new(&mut coarsest, workers)?);
            coarsest = coarsest.coarser()?;
        }
        Ok(Multilevel { energy, levels, scratch })
    }

    /// The energy whose minimum solves the system.
    pub fn into_energy(self) -> Energy {
        self.energy
    }
}

impl System for Multilevel {
    fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]) {
        self.energy.apply(workers, x, y);
    }

    fn precondition(&mut self, workers: &Workers, r: &[f64], z: &mut [f64]) {
        let [s, t] = &mut self.scratch;
        self.levels[0].residual.copy_from_slice(r);
        for l in 1..self.levels.len() {
            let (fine, coarse) = self.levels.split_at_mut(l);
            let (fine, coarse) = (&fine[l - 1], &mut coarse[0]);
            restrict(&fine.residual, fine.shape, &mut coarse.residual, coarse.shape, s, t);
        }
        for level in &mut self.levels {
            update(workers, &mut level.residual, &level.inverse_diagonal, |d, r| d * r);
        }
        for l in (1..self.levels.len()).rev() {
            let (fine, coarse) = self.levels.split_at_mut(l);
            let (fine, coarse) = (&mut fine[l - 1], &coarse[0]);
            prolong(&coarse.residual, coarse.shape, &mut fine.residual, fine.shape, s, t);
        }
        z.copy_from_slice(&self.levels[0].residual);
    }
}

/// coarse = P^T fine, axis by axis: x, then y, then z.
fn restrict(fine: &[f64], f: [usize; 3], coarse: &mut [f64], c: [usize; 3], s: &mut [f64], t: &mut [f64]) {
    let s = &mut s[..c[0] * f[1] * f[2]];
    let t = &mut t[..c[0] * c[1] * f[2]];
    s.fill(0.0);
    t.fill(0.0);
    coarse.fill(0.0);
    Along { outer: 1, inner: f[1] * f[2] }.restrict(fine, f[0], s, c[0]);
    Along { outer: c[0], inner: f[2] }.restrict(s, f[1], t, c[1]);
    Along { outer: c[0] * c[1], inner: 1 }.restrict(t, f[2], coarse, c[2]);
}

/// fine += P coarse, axis by axis: z, then y, then x.
fn prolong(coarse: &[f64], c: [usize; 3], fine: &mut [f64], f: [usize; 3], s: &mut [f64], t: &mut [f64]) {
    let t = &mut t[..c[0] * c[1] * f[2]];
    let s = &mut s[..c[0] * f[1] * f[2]];
    t.fill(0.0);
    s.fill(0.0);
    Along { outer: c[0] * c[1], inner: 1 }.prolong(coarse, c[2], t, f[2]);
    Along { outer: c[0], inner: f[2] }.prolong(t, c[1], s, f[1]);
    Along { outer: 1, inner: f[1] * f[2] }.prolong(s, c[0], fine, f[0]);
}
