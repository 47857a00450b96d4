//! The linear system of the minimum (11) and its preconditioner, the inverse of the diagonal.
//!
//! Summing corrections over coarser grids as well (Bramble, Pasciak and Xu 1990) was tried and took more iterations on the bunny: 2.3 times as
//! many at 16 x 16 x 13 control points and the default weights, 4.3 at 32 x 31 x 25, 6 at 64 x 62 x 50, and 2.1 without the distance term.

use super::energy::Energy;
use crate::Result;
use super::levels::Level;
use crate::linalg::cg;
use crate::linalg::multigrid::{Level as _, Multigrid};
use crate::linalg::vector::update;
use crate::par::Workers;

/// A x = b, without b.
pub enum System<'a, const D: usize = 3> {
    /// With the inverse of the diagonal.
    Diagonal(&'a mut Energy<D>, Vec<f64>),
    /// With a V-cycle.
    Multigrid(Multigrid<Level<'a, D>>),
}

impl<'a, const D: usize> System<'a, D> {
    /// The system of `energy`.
    pub fn new(energy: &'a mut Energy<D>, workers: &Workers) -> Result<Self> {
        energy.reserve()?;
        if std::env::var("MG").is_ok() {
            return Ok(System::Multigrid(energy.multigrid(workers)?.expect("large")));
        }
        let mut inverse_diagonal = energy.diagonal(workers)?;
        inverse_diagonal.iter_mut().for_each(|d| *d = 1.0 / *d);
        Ok(System::Diagonal(energy, inverse_diagonal))
    }
}

impl<const D: usize> cg::System for System<'_, D> {
    fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]) {
        match self {
            System::Diagonal(energy, _) => energy.apply(workers, x, y),
            System::Multigrid(multigrid) => multigrid.finest().apply(workers, x, y),
        }
    }

    fn precondition(&mut self, workers: &Workers, r: &[f64], z: &mut [f64]) {
        match self {
            System::Diagonal(_, inverse_diagonal) => {
                z.copy_from_slice(r);
                update(workers, z, inverse_diagonal, |d, r| d * r);
            }
            System::Multigrid(multigrid) => multigrid.cycle(workers, r, z),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::data::Data;
    use crate::field::energy::EnergyWeights;
    use crate::geometry::random::SplitMix64;
    use crate::geometry::shapes::sphere;
    use crate::linalg::cg::System as _;
    use crate::spline::{Axis, Grid};

    fn energy(n_cells: [usize; 3]) -> Energy {
        let cloud = sphere([0.5; 3], 0.4, 3).unwrap().sample(1000, 1).unwrap();
        let axes = n_cells.map(|n| Axis { lower: 0.0, cell: 1.0 / n as f64, n_cells: n });
        let grid = Grid { axes };
        let data = Data::new(&cloud, &grid).unwrap();
        Energy::new(data, grid, EnergyWeights { normal: 1e-4, smooth: 3e-10 }).unwrap()
    }

    #[test]
    fn the_matrix_is_symmetric_and_positive_and_its_diagonal_is_that_of_unit_vectors() {
        let workers = Workers::caller_only();
        for n_cells in [[1, 1, 1], [1, 2, 5], [7, 6, 9]] {
            let mut energy = energy(n_cells);
            let n = energy.grid().n_control();
            let mut system = System::new(&mut energy, &workers).unwrap();
            let mut random = SplitMix64::new(4);
            let mut vector = || (0..n).map(|_| random.between(-1.0, 1.0)).collect::<Vec<f64>>();
            let (r, s) = (vector(), vector());
            let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
            let (mut ar, mut a_s) = (vec![0.0; n], vec![0.0; n]);
            system.apply(&workers, &r, &mut ar);
            system.apply(&workers, &s, &mut a_s);
            assert!((dot(&s, &ar) - dot(&r, &a_s)).abs() < 1e-10 * dot(&r, &ar), "at {n_cells:?}");
            assert!(dot(&r, &ar) > 0.0);
            for i in (0..n).step_by(n / 50 + 1) {
                let (mut e, mut z) = (vec![0.0; n], vec![0.0; n]);
                e[i] = 1.0;
                system.apply(&workers, &e, &mut ar);
                system.precondition(&workers, &ar, &mut z);
                assert!((z[i] - 1.0).abs() < 1e-12, "entry {i} at {n_cells:?}: {}", z[i]);
            }
        }
    }
}
