//! What the adjoint of a refined fit asks of its form: see [`sensitivity`](super::super::sensitivity).

use super::super::data::Mass;
use super::energy::{RefinedEnergy, middle};
use crate::Result;
use crate::error::try_vec;
use crate::par::Workers;
use crate::spline::hierarchical::per_pack;
use crate::spline::tree::{Tile, in_tile};

impl<const D: usize> RefinedEnergy<D> {
    /// What each point counts for: its number, and its masses, of which that of the gradient is times lambda_n.
    pub fn forces(&self) -> impl Iterator<Item = (u32, Mass)> {
        let leaves = self.tree.tiles().iter().zip(&self.points).filter(|(tile, _)| tile.is_leaf());
        leaves.flat_map(move |(tile, points)| {
            let normal_weight = self.levels[tile.level as usize].normal_weight;
            points.clone().map(move |p| {
                let Mass { value, gradient } = self.data.mass[p];
                (self.data.number[p], Mass { value, gradient: normal_weight * gradient })
            })
        })
    }

    /// The cells in which distances are held: their middles from the lower corner of the box on, masses and d.
    pub fn held(&self) -> impl Iterator<Item = ([f64; D], f64, f64)> + Clone {
        let n = per_pack::<D>();
        let tiles = self.far.iter().flat_map(move |far| far.mass.chunks(n).zip(far.distance.chunks(n)));
        let leaves = self.tree.tiles().iter().zip(tiles).filter(|(tile, _)| tile.is_leaf());
        leaves.flat_map(move |(tile, (mass, distance))| {
            let held = mass.iter().zip(distance).enumerate().filter(|(_, (m, _))| **m > 0.0);
            held.map(move |(c, (m, d))| (self.middle(tile, c), *m, *d))
        })
    }

    /// Holds in the cells in which `other`, on the same tree, does, as much and with the same sign, what `distance` gives for their middles.
    #[cfg(test)]
    pub fn hold_as(&mut self, other: &Self, distance: impl Fn([f64; D]) -> f64) {
        let Some((mut far, theirs)) = self.far.take().zip(other.far.as_ref()) else { return };
        let n = per_pack::<D>();
        far.mass.copy_from_slice(&theirs.mass);
        for (i, tile) in self.tree.tiles().iter().enumerate().filter(|(_, t)| t.is_leaf()) {
            for c in (0..n).filter(|c| far.mass[i * n + c] > 0.0) {
                far.distance[i * n + c] = distance(self.middle(tile, c)).copysign(theirs.distance[i * n + c]);
            }
        }
        self.far = Some(far);
    }

    /// The middle of cell `c` of `tile`.
    fn middle(&self, tile: &Tile<D>, c: usize) -> [f64; D] {
        middle(tile, &self.levels[tile.level as usize].per_cell, in_tile(c))
    }

    /// The vector of the functional that is `sums`, a table a tile, on the functions of each leaf.
    pub fn functional(&mut self, workers: &Workers, sums: &[f64]) -> Result<Vec<f64>> {
        let mut g = try_vec(self.space.n_numbers(), 0.0, "the functional")?;
        let tiles = self.tree.tiles();
        self.space.sum_tables(workers, sums, |t| tiles[t].is_leaf(), &mut g);
        self.space.restrict(workers, &mut g, &mut self.scratch);
        Ok(g)
    }
}
