//! The linear system of the minimum (11) and its preconditioners: the inverse of the diagonal, and the multigrid.
//!
//! The diagonal costs nothing, and where distances are held iterations with it fall as the grid is refined: 870, 375 for a bunny of 25,000
//! and 64,000 points to 1e-6 in four rounds. Without them they grow: 517, 1407. A V-cycle takes 11 and 11, each at some fifteen times the
//! cost, after work worth eighty. So a solve begins with the diagonal, and goes on with the multigrid where too much seems to be left.

use super::data::DataTerm;
use super::energy::Energy;
use super::levels::{Level, Terms};
use crate::Result;
use crate::linalg::cg;
use crate::linalg::multigrid::{Level as _, Multigrid};
use crate::linalg::vector::update;
use crate::par::Workers;
use std::ops::{Deref, DerefMut};

/// Iterations with the diagonal that are waited for. A solve by multigrid costs as much as some 200 of them; but where 150 seem to be left,
/// more mostly are.
pub const PATIENCE: usize = 150;

/// Unknowns below which the diagonal does: its iterations are few there, and take microseconds.
pub const FEW: usize = 4096;

/// A x = b, without b, preconditioned by the diagonal.
pub struct Diagonal<'a, const D: usize = 3> {
    data: &'a DataTerm<D>,
    terms: &'a mut Terms<D>,
    /// 1 / diagonal of A [n]
    inverse: Vec<f64>,
}

impl<'a, const D: usize> Diagonal<'a, D> {
    /// The system of `energy`.
    pub fn new(energy: &'a mut Energy<D>, workers: &Workers) -> Result<Self> {
        let (data, terms) = energy.parts_mut();
        Diagonal::of(data, terms, workers)
    }

    /// The system of the energy of `data` and `terms`.
    pub(super) fn of(data: &'a DataTerm<D>, terms: &'a mut Terms<D>, workers: &Workers) -> Result<Self> {
        terms.smoothness.reserve()?;
        let mut inverse = terms.diagonal(data, workers)?;
        inverse.iter_mut().for_each(|d| *d = 1.0 / *d);
        Ok(Diagonal { data, terms, inverse })
    }
}

impl<const D: usize> cg::System for Diagonal<'_, D> {
    fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]) {
        self.terms.apply(self.data, workers, x, y);
    }

    fn precondition(&mut self, workers: &Workers, r: &[f64], z: &mut [f64]) {
        z.copy_from_slice(r);
        update(workers, z, &self.inverse, |d, r| d * r);
    }
}

impl<P, T, const D: usize> cg::System for Multigrid<Level<P, T, D>>
where
    P: Deref<Target = DataTerm<D>>,
    T: DerefMut<Target = Terms<D>>,
{
    fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]) {
        self.finest().apply(workers, x, y);
    }

    fn precondition(&mut self, workers: &Workers, r: &[f64], z: &mut [f64]) {
        self.cycle(workers, r, z);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::data::Data;
    use crate::field::distance::FarDistances;
    use crate::field::energy::EnergyWeights;
    use crate::field::levels;
    use crate::geometry::random::SplitMix64;
    use crate::geometry::shapes::{circle, sphere};
    use crate::linalg::cg::System as _;
    use crate::spline::{Axis, Grid};

    fn energy(n_cells: [usize; 3]) -> Energy {
        energy_of(n_cells, 1000, 3e-10, false)
    }

    fn energy_of(n_cells: [usize; 3], n_points: usize, smooth: f64, held: bool) -> Energy {
        let cloud = sphere([0.5; 3], 0.4, 3).unwrap().sample(n_points, 1).unwrap();
        let axes = n_cells.map(|n| Axis { lower: 0.0, cell: 1.0 / n as f64, n_cells: n });
        let grid = Grid { axes };
        let data = Data::new(&cloud, &grid).unwrap();
        let mut energy = Energy::new(data, grid, EnergyWeights { normal: 1e-4, smooth }).unwrap();
        if held {
            let far = FarDistances::new(cloud, &grid, &Workers::caller_only(), |_| Ok(())).unwrap();
            energy.hold(far, 150.0).unwrap();
        }
        energy.reserve().unwrap();
        energy
    }

    #[test]
    fn the_matrix_is_symmetric_and_positive_and_its_diagonal_is_that_of_unit_vectors() {
        let workers = Workers::caller_only();
        for n_cells in [[1, 1, 1], [1, 2, 5], [7, 6, 9]] {
            let mut energy = energy(n_cells);
            let n = energy.grid().n_control();
            let mut system = Diagonal::new(&mut energy, &workers).unwrap();
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

    /// Iterations from zero to `tolerance`, and the solution, with the diagonal or the multigrid.
    fn solve<const D: usize>(energy: &mut Energy<D>, by_multigrid: bool, n_threads: u32) -> (usize, Vec<f64>) {
        let workers = Workers::new(n_threads).unwrap();
        let b = energy.right_hand_side(&workers, 1.0).unwrap();
        let (x, stop) = (vec![0.0; b.len()], cg::Stop { tolerance: 1e-10, max_iterations: 20_000, patience: None });
        let observe = |_, _| Ok(());
        let (x, done) = if by_multigrid {
            cg::solve(&mut energy.multigrid(&workers).unwrap(), &b, x, stop, &workers, observe)
        } else {
            cg::solve(&mut Diagonal::new(energy, &workers).unwrap(), &b, x, stop, &workers, observe)
        }
        .unwrap();
        (done.iterations, x)
    }

    /// At counts that are even, odd, coprime and minimal, with and without distances, for stiff data and dense and sparse clouds.
    #[test]
    fn the_multigrid_finds_the_solution_of_the_diagonal_in_few_iterations() {
        let cells = [[8, 8, 8], [9, 7, 11], [13, 5, 8], [1, 16, 25], [30, 2, 3], [16, 15, 17]];
        for (n_cells, (n_points, smooth, held)) in cells.into_iter().zip(
            [(1000, 3e-10, true), (300, 3e-10, false), (4000, 1e-8, false), (1000, 1e-8, true)].into_iter().cycle(),
        ) {
            let mut energy = energy_of(n_cells, n_points, smooth, held);
            assert!(levels::serve(energy.grid()));
            let (_, x) = solve(&mut energy, false, 1);
            let (iterations, y) = solve(&mut energy, true, 1);
            let size = x.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            let apart = x.iter().zip(&y).fold(0.0, |m: f64, (x, y)| m.max((x - y).abs()));
            assert!(apart < 1e-5 * size, "{n_cells:?}: {apart:e} of {size:e}");
            assert!(iterations <= 60, "{n_cells:?}: {iterations}");
            assert_eq!((iterations, y), solve(&mut energy, true, 2), "threads change bits at {n_cells:?}");
        }
    }

    #[test]
    fn the_plane_has_a_multigrid_too() {
        for (n_cells, held) in [([40, 33], true), ([9, 70], false), ([64, 64], false)] {
            let cloud = circle([0.5; 2], 0.4, 400).unwrap().sample(500, 1).unwrap();
            let axes = n_cells.map(|n| Axis { lower: 0.0, cell: 1.0 / n as f64, n_cells: n });
            let grid = Grid { axes };
            let data = Data::new(&cloud, &grid).unwrap();
            let mut energy = Energy::new(data, grid, EnergyWeights { normal: 1e-4, smooth: 3e-10 }).unwrap();
            if held {
                let far = FarDistances::new(cloud, &grid, &Workers::caller_only(), |_| Ok(())).unwrap();
                energy.hold(far, 150.0).unwrap();
            }
            energy.reserve().unwrap();
            let (_, x) = solve(&mut energy, false, 1);
            let (iterations, y) = solve(&mut energy, true, 1);
            let size = x.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            let apart = x.iter().zip(&y).fold(0.0, |m: f64, (x, y)| m.max((x - y).abs()));
            assert!(
                apart < 1e-5 * size && iterations <= 60,
                "{n_cells:?}: {iterations} iterations, {apart:e} of {size:e}"
            );
        }
    }
}
