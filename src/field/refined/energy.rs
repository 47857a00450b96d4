//! The energy (10) on hierarchical splines: a sum over the leaves of the tree, in each of which phi is a spline of one level.

use super::super::data::Data;
use super::super::distance::CLEAR;
use super::super::distance_sampler::{DistanceSampler, Hint};
use super::super::energy::{self, EnergyWeights};
use super::super::held::{Held, HeldCell};
use super::leaf_terms::{Diagonal, Errors, LeafTerm, Product, RightHandSide, Strays, Tables};
use crate::Result;
use crate::error::{try_reserve_exact, try_vec, try_with_capacity};
use crate::geometry::Cloud;
use crate::geometry::vec::{norm, sub};
use crate::isa::dispatch;
use crate::linalg::cg;
use crate::linalg::vector::update;
use crate::par::Workers;
use crate::spline::hierarchical::{Space, per_pack, per_table, strides};
use crate::spline::kernel::Stencil;
use crate::spline::tile_gram::TileGram;
use crate::spline::tree::{SIDE, Tile, Tree, in_tile};
use std::ops::Range;

/// Tiles of an item of work.
const CHUNK: usize = 16;

/// How distances are held away from the surface.
#[derive(Debug, Clone, Copy)]
pub struct Holding {
    /// In units of lambda_r / h^4; 0: not at all.
    pub weight: f64,
    /// Distance from which on they are, in cells of the leaf that the nearest point is in.
    pub nearest: f64,
    /// The same in the spacing of that leaf's points: what is nearer is farther from them than from the surface. The larger one counts.
    pub spacings: f64,
}

/// What lambda_n falls by from level to level, as h^2: the gradient's part of a function's energy beside that of its values stays the same.
const NORMAL_FALL: f64 = 0.25;

/// What lambda_r falls by from level to level, as h^2.3. With 1/8, as h^3, smoothness would keep its proportion to the values' energy too; but
/// beside edges phi would then pass through 0 more often where no surface is.
const SMOOTH_FALL: f64 = 0.2;

/// The terms in the cells of one level.
pub(super) struct LevelTerms<const D: usize> {
    pub(super) gram: TileGram<D>,
    /// 1 / h_a
    pub(super) per_cell: [f64; D],
    pub(super) normal_weight: f64,
    /// What s of a cell is multiplied with.
    pub(super) distance_weight: f64,
    longest_cell: f64,
}

/// The form on the splines of one tree.
pub struct RefinedEnergy<const D: usize> {
    /// Its grid in units of D.
    pub(super) tree: Tree<D>,
    pub(super) space: Space<D>,
    pub(super) levels: Vec<LevelTerms<D>>,
    weights: EnergyWeights,
    pub(super) data: Data<D>,
    /// Points of each tile.
    pub(super) points: Vec<Range<usize>>,
    pub(super) far: Option<Far<D>>,
    /// What each tile adds to a product.
    tables: Vec<f64>,
    /// A vector of control points: what was unfolded, or room.
    pub(super) scratch: Vec<f64>,
    /// The preconditioner: the inverse of the form's diagonal, 0 for functions that are not active.
    inverse: Vec<f64>,
}

/// What the memory is for, should it run out.
const WHAT: &str = "the distances that are held";

/// No point.
const NONE: u32 = u32::MAX;

/// Tiles of which distances are measured between two words of progress.
const ROUND: usize = 64 * CHUNK;

/// Distances to hold.
pub(super) struct Far<const D: usize> {
    /// `None` where distances stay held where they were.
    sampler: Option<DistanceSampler<D>>,
    /// Numbers in the cloud of the points that the sampler has; none without one.
    pub(super) numbers: Vec<u32>,
    holding: Holding,
    /// The point nearest to the middle of each cell of leaves, by its place in the sampler, or without one by its number in the cloud
    /// [tiles][4^D].
    nearest: Vec<u32>,
    /// d in the middle of each cell, and lambda_d times its share of the cells; of a tile that is cut only the shares, as its parts have them
    /// [tiles][4^D].
    pub(super) distance: Vec<f64>,
    pub(super) mass: Vec<f64>,
    /// Cells of leaves that are far, and those of them whose side is clear.
    counts: [u64; 2],
}

impl<const D: usize> Far<D> {
    /// Without distances.
    fn none_yet(holding: Holding) -> Self {
        let (numbers, nearest, distance, mass) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Far { sampler: None, numbers, holding, nearest, distance, mass, counts: [0; 2] }
    }

    /// The number in the cloud of the point nearest to a cell.
    pub(super) fn number(&self, cell: usize) -> u32 {
        match &self.sampler {
            Some(sampler) => self.numbers[sampler.number(self.nearest[cell]) as usize],
            None => self.nearest[cell],
        }
    }

    /// The masses of tiles that are cut, from those of their parts, and how many cells are far.
    fn sum_up(&mut self, tree: &Tree<D>, levels: &[LevelTerms<D>]) {
        let n = per_pack::<D>();
        // Parts come after what they are parts of.
        for i in (0..tree.tiles().len()).rev() {
            let tile = tree.tiles()[i];
            if tile.is_leaf() {
                continue;
            }
            self.mass[i * n..(i + 1) * n].fill(0.0);
            for part in 0..1_usize << D {
                for c in 0..n {
                    let at: [usize; D] = in_tile(c);
                    let to = (0..D).fold(0, |to, a| SIDE * to + (at[a] + SIDE * (part >> (D - 1 - a) & 1)) / 2);
                    self.mass[i * n + to] += self.mass[(tile.child as usize + part) * n + c];
                }
            }
        }
        self.counts = [0; 2];
        for (tile, mass) in tree.tiles().iter().zip(self.mass.chunks(n)).filter(|(t, _)| t.is_leaf()) {
            let whole = levels[tile.level as usize].distance_weight;
            let of = |least: f64| mass.iter().filter(|m| **m > least * whole).count() as u64;
            self.counts = [self.counts[0] + of(0.0), self.counts[1] + of(CLEAR)];
        }
    }
}

impl<const D: usize> RefinedEnergy<D> {
    /// The form on the cells of `tree`, its grid in units of D, with its functions `space`, for `data` in its cells. Distances to the points
    /// are held as `holding` says. `tell` is called from time to time, and may stop.
    pub fn new(
        (tree, space): (Tree<D>, Space<D>),
        data: Data<D>,
        weights: EnergyWeights,
        holding: Holding,
        workers: &Workers,
        mut tell: impl FnMut() -> Result<()>,
    ) -> Result<Self> {
        let far = if holding.weight > 0.0 {
            let mut numbers = try_with_capacity(data.number.len(), "the numbers of the points")?;
            numbers.extend_from_slice(&data.number);
            let axes = tree.grid().axes;
            let mut points = try_with_capacity(data.xi.len(), "the points in units of D")?;
            points.extend(data.xi.iter().map(|xi| std::array::from_fn(|a| xi[a] * axes[a].cell)));
            let mut normals = try_with_capacity(data.xi.len(), "the normals")?;
            normals.extend_from_slice(&data.normals);
            tell()?;
            let sampler = Some(DistanceSampler::new(Cloud::new(points, normals)?, workers)?);
            Some(Far { sampler, numbers, ..Far::none_yet(holding) })
        } else {
            None
        };
        RefinedEnergy::of((tree, space), data, weights, far, workers, tell)
    }

    /// The same with distances where they were `held`, to the points as they are now; the tree is the one of then.
    pub fn keeping(
        parts: (Tree<D>, Space<D>),
        data: Data<D>,
        weights: EnergyWeights,
        (holding, held): (Holding, &Held),
        workers: &Workers,
        tell: impl FnMut() -> Result<()>,
    ) -> Result<Self> {
        let far = (holding.weight > 0.0).then(|| Far::none_yet(holding));
        let mut energy = RefinedEnergy::of(parts, data, weights, far, workers, tell)?;
        let Some(mut far) = energy.far.take() else { return Ok(energy) };
        let (places, axes, n) = (energy.data.places()?, energy.tree.grid().axes, per_pack::<D>());
        for HeldCell { cell, point, side } in held.cells() {
            let c = *cell as usize;
            let tile = &energy.tree.tiles()[c / n];
            let xi = energy.data.xi[places[*point as usize] as usize];
            let p = std::array::from_fn(|a| xi[a] * axes[a].cell);
            far.nearest[c] = *point;
            far.distance[c] = norm(sub(p, energy.middle(tile, c % n))).copysign(*side);
            far.mass[c] = energy.levels[tile.level as usize].distance_weight * side.abs();
        }
        far.sum_up(&energy.tree, &energy.levels);
        energy.far = Some(far);
        Ok(energy)
    }

    fn of(
        (tree, space): (Tree<D>, Space<D>),
        data: Data<D>,
        weights: EnergyWeights,
        far: Option<Far<D>>,
        workers: &Workers,
        tell: impl FnMut() -> Result<()>,
    ) -> Result<Self> {
        let mut energy = RefinedEnergy {
            tree,
            space,
            levels: Vec::new(),
            weights,
            data,
            points: Vec::new(),
            far,
            tables: Vec::new(),
            scratch: Vec::new(),
            inverse: Vec::new(),
        };
        energy.renew(workers, tell)?;
        Ok(energy)
    }

    /// The tree.
    pub fn tree(&self) -> &Tree<D> {
        &self.tree
    }

    /// The splines.
    pub fn space(&self) -> &Space<D> {
        &self.space
    }

    /// The points.
    pub fn data(&self) -> &Data<D> {
        &self.data
    }

    /// Points of tile `tile`.
    pub fn points_of(&self, tile: usize) -> Range<usize> {
        self.points[tile].clone()
    }

    /// The part of the far cells on whose side there is little doubt; NaN where no distances are held.
    pub fn clear(&self) -> f64 {
        match &self.far {
            None => f64::NAN,
            Some(Far { counts: [0, _], .. }) => 1.0,
            Some(Far { counts: [far, clear], .. }) => *clear as f64 / *far as f64,
        }
    }

    /// The tree and its functions.
    pub fn into_tree(self) -> (Tree<D>, Space<D>) {
        (self.tree, self.space)
    }

    /// Bytes that a tile takes: itself, its table and that of the field, nearest points, distances and masses, its points.
    pub fn bytes_of_tile() -> u64 {
        let of_cells = per_pack::<D>() * (size_of::<u32>() + 2 * size_of::<f64>());
        (size_of::<Tile<D>>() + 8 * 2 * per_table::<D>() + of_cells + size_of::<Range<usize>>()) as u64
    }

    /// Goes over to `tree`, of the same tiles with more of them cut, and the functions `space` of it; x of the same spline there. `tell` is
    /// called from time to time, and may stop, after which the form is of no use.
    pub fn refine(
        &mut self,
        tree: Tree<D>,
        space: Space<D>,
        x: &[f64],
        workers: &Workers,
        tell: impl FnMut() -> Result<()>,
    ) -> Result<Vec<f64>> {
        let x = space.take_over(&self.space, x, workers)?;
        (self.tree, self.space) = (tree, space);
        self.renew(workers, tell)?;
        Ok(x)
    }

    /// What depends on the tree.
    fn renew(&mut self, workers: &Workers, tell: impl FnMut() -> Result<()>) -> Result<()> {
        let grid = *self.tree.grid();
        let volume: f64 = grid.axes.iter().map(|a| a.cell * a.n_cells as f64).product();
        let n_cells: f64 = grid.axes.iter().map(|a| a.n_cells as f64).product();
        for l in self.levels.len() as i32..self.tree.n_levels() as i32 {
            let cell = grid.axes.map(|a| a.cell * 0.5f64.powi(l));
            let smooth = self.weights.smooth * SMOOTH_FALL.powi(l);
            let longest_cell = cell.iter().fold(0.0, |m: f64, c| m.max(*c));
            let relative = self.far.as_ref().map_or(0.0, |far| far.holding.weight);
            self.levels.push(LevelTerms {
                gram: TileGram::new(cell, smooth / volume)?,
                per_cell: cell.map(|c| 1.0 / c),
                normal_weight: self.weights.normal * NORMAL_FALL.powi(l),
                distance_weight: relative * smooth / longest_cell.powi(4) / (n_cells * f64::from(1 << D).powi(l)),
                longest_cell,
            });
        }
        self.sort_points()?;
        self.measure_distances(workers, tell)?;
        self.tables = try_vec(self.tree.tiles().len() * per_table::<D>(), 0.0, "the tables of the tiles")?;
        self.scratch = try_vec(self.space.n_numbers(), 0.0, "the control points")?;
        self.inverse = try_vec(self.space.n_numbers(), 0.0, "the preconditioner")?;
        Ok(())
    }

    /// Brings the points into the order of the leaves, by depth, so that those of every tile stand together.
    fn sort_points(&mut self) -> Result<()> {
        let n = self.data.xi.len();
        let tiles = self.tree.tiles();
        let mut points = try_vec(tiles.len(), 0..0, "the points of the tiles")?;
        let mut leaf_of = try_vec(n, 0u32, "the order of the points")?;
        for (leaf, xi) in leaf_of.iter_mut().zip(&self.data.xi) {
            let leaf_index = self.tree.locate(xi).0;
            *leaf = leaf_index as u32;
            points[leaf_index].end += 1;
        }
        let mut at = 0;
        self.tree.walk(|tile, entering| {
            if entering {
                points[tile] = at..at + points[tile].end;
                at = points[tile].end;
            } else {
                points[tile].end = at;
            }
        });
        let mut next = try_with_capacity(points.len(), "the order of the points")?;
        next.extend(points.iter().map(|p| p.start));
        let mut order = try_vec(n, 0u32, "the order of the points")?;
        for (i, leaf) in leaf_of.iter().enumerate() {
            order[next[*leaf as usize]] = i as u32;
            next[*leaf as usize] += 1;
        }
        let Data { xi, normals, share, mass, number } = &mut self.data;
        permute(xi, &order)?;
        permute(normals, &order)?;
        permute(share, &order)?;
        permute(mass, &order)?;
        permute(number, &order)?;
        self.points = points;
        Ok(())
    }

    /// Distances of the cells of leaves, held where they are farther from the surface than it is resolved there. What is measured once is
    /// kept; which are held depends on the tree alone, not on how it came about.
    fn measure_distances(&mut self, workers: &Workers, mut tell: impl FnMut() -> Result<()>) -> Result<()> {
        let Some(far) = &mut self.far else { return Ok(()) };
        let n = per_pack::<D>();
        let (tree, levels, points, holding) = (&self.tree, &self.levels, &self.points, far.holding);
        let more = tree.tiles().len() * n - far.distance.len();
        for of_cells in [&mut far.distance, &mut far.mass] {
            try_reserve_exact(of_cells, more, WHAT)?;
            of_cells.resize(of_cells.len() + more, 0.0);
        }
        try_reserve_exact(&mut far.nearest, more, WHAT)?;
        far.nearest.resize(far.nearest.len() + more, NONE);
        let axes = tree.grid().axes;
        let near = |p: [f64; D]| {
            let (leaf, _) = tree.locate(&std::array::from_fn(|a| p[a] / axes[a].cell));
            let cell = levels[tree.tiles()[leaf].level as usize].longest_cell;
            // One at least: rounding may place the point beyond a face of the leaf that counts it.
            let spacing = SIDE as f64 / (points[leaf].len().max(1) as f64).powf(1.0 / (D - 1) as f64);
            cell * holding.nearest.max(holding.spacings * spacing)
        };
        let Some(sampler) = &far.sampler else { return Ok(()) };
        let cells = far.nearest.chunks_mut(n).zip(far.distance.chunks_mut(n)).zip(far.mass.chunks_mut(n));
        let mut of_tiles = tree.tiles().iter().zip(cells);
        for _ in (0..tree.tiles().len()).step_by(ROUND) {
            tell()?;
            workers.for_each(of_tiles.by_ref().take(ROUND), |(tile, ((nearest, distance), mass))| {
                if !tile.is_leaf() {
                    return;
                }
                let (level, cells) = (&levels[tile.level as usize], tree.cells(tile));
                let mut hint = Hint::default();
                for (c, ((i, d), m)) in nearest.iter_mut().zip(distance).zip(mass).enumerate() {
                    let at: [usize; D] = in_tile(c);
                    if (0..D).any(|a| at[a] >= cells[a]) {
                        continue;
                    }
                    let x = middle(tile, &level.per_cell, at);
                    if *i == NONE {
                        (*d, *i) = sampler.nearest(x, &mut hint);
                    }
                    if d.abs() <= near(sampler.point(*i)) {
                        *m = 0.0;
                    } else if *m == 0.0 {
                        let s;
                        (*d, s) = sampler.side(x, d.abs(), &mut hint);
                        *m = level.distance_weight * s;
                    }
                }
            });
        }
        far.sum_up(&self.tree, &self.levels);
        Ok(())
    }

    /// b, for gradients `sign` n at the points and distances `sign` d away from them.
    pub fn right_hand_side(&mut self, workers: &Workers, sign: f64) -> Result<Vec<f64>> {
        let mut b = try_vec(self.space.n_numbers(), 0.0, "the right-hand side")?;
        self.by_leaf(workers, &mut b, RightHandSide { sign, held: true });
        Ok(b)
    }

    /// An error where the normals ask for nothing.
    pub fn check_normals(&mut self, workers: &Workers) -> Result<()> {
        let mut b = try_vec(self.space.n_numbers(), 0.0, "the right-hand side")?;
        self.by_leaf(workers, &mut b, RightHandSide { sign: 1.0, held: false });
        energy::check_normals(&b, self.weights.normal, self.tree.grid(), self.data.xi.len())
    }

    /// The preconditioner, by the diagonal as the cells of a function's own level have it.
    pub fn renew_preconditioner(&mut self, workers: &Workers) {
        let mut tables = std::mem::take(&mut self.tables);
        self.fill_tables(workers, &mut tables, |_| true, Diagonal);
        self.space.sum_tables(workers, &tables, |_| true, &mut self.inverse);
        self.space.keep_active(&mut self.inverse);
        self.inverse.iter_mut().filter(|d| **d > 0.0).for_each(|d| *d = 1.0 / *d);
        self.tables = tables;
    }

    /// Puts into `scratch` what the control points `x` are on the knots of each tile.
    fn unfold(&mut self, workers: &Workers, x: &[f64]) {
        self.scratch.copy_from_slice(x);
        self.space.accumulate(workers, &mut self.scratch);
    }

    /// Sums what `term` gives for each leaf; `scratch` is lost.
    fn by_leaf(&mut self, workers: &Workers, y: &mut [f64], term: impl LeafTerm<D>) {
        let mut tables = std::mem::take(&mut self.tables);
        self.fill_tables(workers, &mut tables, Tile::is_leaf, term);
        let tiles = self.tree.tiles();
        self.space.sum_tables(workers, &tables, |t| tiles[t].is_leaf(), y);
        self.tables = tables;
        self.space.restrict(workers, y, &mut self.scratch);
    }

    fn fill_tables(
        &self,
        workers: &Workers,
        tables: &mut [f64],
        counts: impl Fn(&Tile<D>) -> bool + Copy + Send + Sync,
        term: impl LeafTerm<D>,
    ) {
        workers.for_each(tables.chunks_mut(CHUNK * per_table::<D>()).enumerate(), |(chunk, tables)| {
            dispatch(Tables { energy: self, first: chunk * CHUNK, tables, counts, term });
        });
    }

    /// |phi| at each point, in units of D; `x` are control points.
    pub fn errors(&mut self, workers: &Workers, x: &[f64], errors: &mut [f64]) -> Result<()> {
        let mut items = try_with_capacity(self.tree.tiles().len(), "the leaves with points")?;
        self.unfold(workers, x);
        // By leaf: the points of one after those of another.
        let mut rest = errors;
        self.tree.walk(|tile, entering| {
            if entering && self.tree.tiles()[tile].is_leaf() && !self.points[tile].is_empty() {
                let (own, behind) = std::mem::take(&mut rest).split_at_mut(self.points[tile].len());
                rest = behind;
                items.push((tile, own));
            }
        });
        workers.for_each(items, |(tile, errors)| dispatch(Errors { energy: self, tile, errors }));
        Ok(())
    }

    /// For each tile whether phi is far from the distance that is held in one of its cells, by more than `most` of it; `x` are control
    /// points.
    pub fn strays(&mut self, workers: &Workers, x: &[f64], sign: f64, most: f64) -> Result<Vec<bool>> {
        let mut strays = try_vec(self.tree.tiles().len(), false, "the tiles to refine")?;
        if self.far.is_none() {
            return Ok(strays);
        }
        self.unfold(workers, x);
        workers.for_each(strays.chunks_mut(CHUNK).enumerate(), |(chunk, strays)| {
            dispatch(Strays { energy: self, first: chunk * CHUNK, sign, most, strays });
        });
        Ok(strays)
    }

    /// Multiplies what the value of each point counts for by a factor of its own.
    pub fn reweight(&mut self, factors: impl Iterator<Item = f64>) {
        self.data.reweight(factors);
    }

    /// Makes each point count for its share again.
    pub fn reset_weights(&mut self) {
        self.data.reset_weights();
    }

    /// The cell of `tile` that holds point `p`, and the place in it.
    #[inline(always)]
    pub(super) fn place(&self, tile: &Tile<D>, cells: &[usize; D], p: usize) -> (Stencil<D>, [f64; D]) {
        let per_cell = f64::from(1u32 << tile.level);
        let strides = strides::<D>();
        let (mut first, mut u) = (0, [0.0; D]);
        for a in 0..D {
            let y = self.data.xi[p][a] * per_cell - (SIDE * tile.place[a] as usize) as f64;
            let cell = (y as usize).min(cells[a] - 1);
            first += cell * strides[a];
            u[a] = y - cell as f64;
        }
        (Stencil { first, strides }, u)
    }
}

/// The middle of the cell at `at` of `tile`, of which `per_cell` is 1 / h_a.
pub(super) fn middle<const D: usize>(tile: &Tile<D>, per_cell: &[f64; D], at: [usize; D]) -> [f64; D] {
    std::array::from_fn(|a| ((SIDE * tile.place[a] as usize + at[a]) as f64 + 0.5) / per_cell[a])
}

fn permute<T: Copy>(x: &mut Vec<T>, order: &[u32]) -> Result<()> {
    let mut permuted = try_with_capacity(x.len(), "the points in order")?;
    permuted.extend(order.iter().map(|i| x[*i as usize]));
    *x = permuted;
    Ok(())
}

impl<const D: usize> cg::System for RefinedEnergy<D> {
    fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]) {
        self.unfold(workers, x);
        self.by_leaf(workers, y, Product);
    }

    fn precondition(&mut self, workers: &Workers, r: &[f64], z: &mut [f64]) {
        update(workers, z, r, |r, _| r);
        update(workers, z, &self.inverse, |inverse, z| inverse * z);
    }
}

#[cfg(test)]
mod tests;
