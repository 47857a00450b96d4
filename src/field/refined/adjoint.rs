//! What the adjoint of a refined fit asks of its form: see [`sensitivity`](super::super::sensitivity).

use super::super::data::Mass;
use super::super::held::{Held, Hold};
use super::energy::{Far, RefinedEnergy, middle};
use crate::Result;
use crate::error::try_vec;
use crate::par::Workers;
use crate::spline::hierarchical::per_pack;
use crate::spline::tree::{SIDE, Tile, in_tile};

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

    /// The cells in which distances are held, as a field remembers them: where no tile is cut, those of the grid.
    pub fn held(&self) -> Result<Option<Held>> {
        let Some(far) = &self.far else { return Ok(None) };
        let (n, n_cells, whole) = (per_pack::<D>(), self.tree.grid().n_cells(), self.tree.n_levels() == 1);
        let cells = self.held_cells(far).map(|(tile, cell)| {
            let (at, side): ([usize; D], _) =
                (in_tile(cell % n), far.mass[cell] / self.levels[tile.level as usize].distance_weight);
            let row_major = || (0..D).fold(0, |c, a| c * n_cells[a] + SIDE * tile.place[a] as usize + at[a]);
            (if whole { row_major() } else { cell }, far.number(cell), side.copysign(far.distance[cell]))
        });
        Held::new(cells, self.clear())
    }

    /// The same, as the form has them.
    pub fn holds(&self) -> impl Iterator<Item = Hold<D>> + Clone {
        let n = per_pack::<D>();
        let far = self.far.iter();
        far.flat_map(move |far| {
            self.held_cells(far).map(move |(tile, cell)| Hold {
                middle: self.middle(tile, cell % n),
                mass: far.mass[cell].copysign(far.distance[cell]),
                point: far.number(cell),
            })
        })
    }

    /// The cells of leaves in which distances are held, each with its tile.
    fn held_cells<'a>(&'a self, far: &'a Far<D>) -> impl Iterator<Item = (&'a Tile<D>, usize)> + Clone {
        let n = per_pack::<D>();
        let leaves = self.tree.tiles().iter().enumerate().filter(|(_, tile)| tile.is_leaf());
        leaves.flat_map(move |(i, tile)| {
            (n * i..n * (i + 1)).filter(|cell| far.mass[*cell] > 0.0).map(move |cell| (tile, cell))
        })
    }

    /// The middle of cell `c` of `tile`.
    pub(super) fn middle(&self, tile: &Tile<D>, c: usize) -> [f64; D] {
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
