//! What one leaf adds to a product, a right-hand side or a diagonal, on a table of its own functions.

use super::super::data::Mass;
use super::super::distance::CLEAR;
use super::energy::RefinedEnergy;
use crate::isa::{Isa, Kernel};
use crate::spline::basis::Weights;
use crate::spline::hierarchical::{LARGEST_TABLE, per_pack, per_table};
use crate::spline::tile_gram::{self, add_from_middles, at_middles};
use crate::spline::tree::Tile;

/// What a leaf adds to a vector.
pub(super) trait LeafTerm<const D: usize>: Copy + Send + Sync {
    /// Adds to `y` what tile `tile` does.
    fn add<I: Isa>(self, energy: &RefinedEnergy<D>, tile: usize, y: &mut [f64]);
}

/// The tables of some tiles.
pub(super) struct Tables<'a, const D: usize, C, T: LeafTerm<D>> {
    pub energy: &'a RefinedEnergy<D>,
    pub first: usize,
    pub tables: &'a mut [f64],
    pub counts: C,
    pub term: T,
}

impl<const D: usize, C: Fn(&Tile<D>) -> bool, T: LeafTerm<D>> Kernel for Tables<'_, D, C, T> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let Tables { energy, first, tables, counts, term } = self;
        for (tile, y) in (first..).zip(tables.chunks_exact_mut(per_table::<D>())) {
            let t = &energy.tree.tiles()[tile];
            if counts(t) && energy.tree.holds(t) {
                y.fill(0.0);
                term.add::<I>(energy, tile, y);
            }
        }
    }
}

/// The product with the control points in `scratch`.
#[derive(Clone, Copy)]
pub(super) struct Product;

impl<const D: usize> LeafTerm<D> for Product {
    #[inline(always)]
    fn add<I: Isa>(self, energy: &RefinedEnergy<D>, index: usize, y: &mut [f64]) {
        let tile = &energy.tree.tiles()[index];
        let (level, cells) = (&energy.levels[tile.level as usize], energy.tree.cells(tile));
        let mut x = [0.0; LARGEST_TABLE];
        let x = &mut x[..per_table::<D>()];
        energy.space.gather(index, &energy.scratch, x);
        level.gram.add_product::<I>(cells, x, y);
        if let Some(far) = &energy.far {
            let n = per_pack::<D>();
            let mass = &far.mass[index * n..(index + 1) * n];
            if mass.iter().any(|m| *m > 0.0) {
                let mut values = [0.0; 64];
                let values = &mut values[..n];
                at_middles::<I, D>(x, values);
                values.iter_mut().zip(mass).for_each(|(v, m)| *v *= m);
                add_from_middles::<I, D>(values, y, &tile_gram::VALUES);
            }
        }
        for p in energy.points[index].clone() {
            let (stencil, u) = energy.place(tile, &cells, p);
            let b = Weights::along::<I, D>(&u);
            let (value, gradient) = stencil.value_gradient::<I>(x, &b);
            let Mass { value: mass, gradient: pull } = energy.data.mass[p];
            let pull = level.normal_weight * pull;
            let gradient = std::array::from_fn(|a| pull * level.per_cell[a] * level.per_cell[a] * gradient[a]);
            stencil.scatter::<I>(y, &b, mass * value, gradient);
        }
    }
}

#[derive(Clone, Copy)]
pub(super) struct RightHandSide {
    pub sign: f64,
    /// With the distances.
    pub held: bool,
}

impl<const D: usize> LeafTerm<D> for RightHandSide {
    #[inline(always)]
    fn add<I: Isa>(self, energy: &RefinedEnergy<D>, index: usize, y: &mut [f64]) {
        let tile = &energy.tree.tiles()[index];
        let (level, cells) = (&energy.levels[tile.level as usize], energy.tree.cells(tile));
        if let Some(far) = energy.far.as_ref().filter(|_| self.held) {
            let n = per_pack::<D>();
            let mut values = [0.0; 64];
            let values = &mut values[..n];
            let held = far.mass[index * n..].iter().zip(&far.distance[index * n..]);
            values.iter_mut().zip(held).for_each(|(v, (m, d))| *v = m * self.sign * d);
            add_from_middles::<I, D>(values, y, &tile_gram::VALUES);
        }
        for p in energy.points[index].clone() {
            let (stencil, u) = energy.place(tile, &cells, p);
            let pull = level.normal_weight * energy.data.mass[p].gradient * self.sign;
            let gradient = std::array::from_fn(|a| pull * level.per_cell[a] * energy.data.normals[p][a]);
            stencil.scatter::<I>(y, &Weights::along::<I, D>(&u), 0.0, gradient);
        }
    }
}

#[derive(Clone, Copy)]
pub(super) struct Diagonal;

impl<const D: usize> LeafTerm<D> for Diagonal {
    #[inline(always)]
    fn add<I: Isa>(self, energy: &RefinedEnergy<D>, index: usize, y: &mut [f64]) {
        let tile = &energy.tree.tiles()[index];
        let (level, cells) = (&energy.levels[tile.level as usize], energy.tree.cells(tile));
        level.gram.add_diagonal(cells, y);
        if let Some(far) = &energy.far {
            let n = per_pack::<D>();
            add_from_middles::<I, D>(&far.mass[index * n..(index + 1) * n], y, &tile_gram::SQUARES);
        }
        for p in energy.points[index].clone() {
            let (stencil, u) = energy.place(tile, &cells, p);
            let squares = Weights::along::<I, D>(&u)
                .map(|Weights { w, dw }| Weights { w: w.map(|w| w * w), dw: dw.map(|d| d * d) });
            let Mass { value, gradient } = energy.data.mass[p];
            let pull = level.normal_weight * gradient;
            let gradient = std::array::from_fn(|a| pull * level.per_cell[a] * level.per_cell[a]);
            stencil.scatter::<I>(y, &squares, value, gradient);
        }
    }
}

/// |phi| at the points of one leaf; control points are in `scratch`.
pub(super) struct Errors<'a, const D: usize> {
    pub energy: &'a RefinedEnergy<D>,
    pub tile: usize,
    pub errors: &'a mut [f64],
}

impl<const D: usize> Kernel for Errors<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let Errors { energy, tile: index, errors } = self;
        let tile = &energy.tree.tiles()[index];
        let cells = energy.tree.cells(tile);
        let mut x = [0.0; LARGEST_TABLE];
        let x = &mut x[..per_table::<D>()];
        energy.space.gather(index, &energy.scratch, x);
        for (p, error) in energy.points[index].clone().zip(errors) {
            let (stencil, u) = energy.place(tile, &cells, p);
            *error = stencil.value::<I>(x, u).abs();
        }
    }
}

/// Which of some tiles hold distances that phi, of the control points in `scratch`, is far from.
pub(super) struct Strays<'a, const D: usize> {
    pub energy: &'a RefinedEnergy<D>,
    pub first: usize,
    pub sign: f64,
    pub most: f64,
    pub strays: &'a mut [bool],
}

impl<const D: usize> Kernel for Strays<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let Strays { energy, first, sign, most, strays } = self;
        let Some(far) = &energy.far else { return };
        let n = per_pack::<D>();
        for (index, strays) in (first..).zip(strays) {
            let tile = &energy.tree.tiles()[index];
            let clear = CLEAR * energy.levels[tile.level as usize].distance_weight;
            let (mass, distance) = (&far.mass[index * n..(index + 1) * n], &far.distance[index * n..(index + 1) * n]);
            if !tile.is_leaf() || mass.iter().all(|m| *m < clear) {
                continue;
            }
            let (mut x, mut values) = ([0.0; LARGEST_TABLE], [0.0; 64]);
            let (x, values) = (&mut x[..per_table::<D>()], &mut values[..n]);
            energy.space.gather(index, &energy.scratch, x);
            at_middles::<I, D>(x, values);
            let held = mass.iter().zip(distance);
            *strays = values.iter().zip(held).any(|(v, (m, d))| *m >= clear && (v - sign * d).abs() > most * d.abs());
        }
    }
}
