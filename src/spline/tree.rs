//! Cells refined where they need be: a forest of tiles of 4^D cells each, of which any may be cut into 2^D tiles of cells half as long.
//!
//! Level 0 is a grid, its last tiles along an axis with fewer cells where their number is no multiple of 4; level l has cells 2^l times
//! as short. A *leaf* is a tile that is not cut. Leaves cover the box once.

use super::{Axis, Grid, place_of};
use crate::Result;
use crate::error::{try_reserve, try_vec, try_with_capacity};

/// Cells of a tile along an axis.
pub const SIDE: usize = 4;

/// Where number `i` of 4^D stands, the last axis fastest.
pub fn in_tile<const D: usize>(i: usize) -> [usize; D] {
    place_of(i, [SIDE; D])
}

/// Levels beyond that of the grid, at most: coordinates in cells stay exact.
pub const DEEPEST: u32 = 16;

/// Some cells of one level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tile<const D: usize> {
    /// 0 for the grid's own cells.
    pub level: u32,
    /// In tiles of its level.
    pub place: [u32; D],
    /// The first of its 2^D parts, the last axis fastest; 0 for a leaf.
    pub child: u32,
}

impl<const D: usize> Tile<D> {
    /// Whether the tile is not cut.
    pub fn is_leaf(&self) -> bool {
        self.child == 0
    }
}

/// Tiles beyond which none is cut: indices are numbers of 32 bits.
const MOST_TILES: usize = u32::MAX as usize - 16;

/// The tiles of a box.
#[derive(Debug, Clone, PartialEq)]
pub struct Tree<const D: usize> {
    grid: Grid<D>,
    /// Tiles of the grid along each axis.
    roots: [usize; D],
    /// Those of the grid first, row-major; parts of a tile stand together.
    tiles: Vec<Tile<D>>,
    /// The largest coordinates below the upper faces, in cells of the grid.
    below_end: [f64; D],
}

impl<const D: usize> Tree<D> {
    /// The cells of `grid`, none of them cut.
    pub fn new(grid: Grid<D>) -> Result<Self> {
        let roots = grid.n_cells().map(|n| n.div_ceil(SIDE));
        let none = Tile { level: 0, place: [0; D], child: 0 };
        let mut tiles = try_vec(roots.iter().product(), none, "the tiles of the grid")?;
        for (i, tile) in tiles.iter_mut().enumerate() {
            tile.place = place_of(i, roots).map(|x| x as u32);
        }
        Ok(Tree { grid, roots, tiles, below_end: grid.n_cells().map(|n| (n as f64).next_down()) })
    }

    /// The cells of level 0.
    pub fn grid(&self) -> &Grid<D> {
        &self.grid
    }

    /// All tiles.
    pub fn tiles(&self) -> &[Tile<D>] {
        &self.tiles
    }

    /// Levels, the grid's own counted.
    pub fn n_levels(&self) -> u32 {
        1 + self.tiles.iter().fold(0, |m, t| m.max(t.level))
    }

    /// Cells of level `level` along axis `a`.
    pub fn n_cells(&self, level: u32, a: usize) -> usize {
        self.grid.axes[a].n_cells << level
    }

    /// How many times as short as the grid's the cells of tile `tile` are.
    #[inline(always)]
    pub fn times_as_short(&self, tile: usize) -> f64 {
        (1u64 << self.tiles[tile].level) as f64
    }

    /// The grid of the cells of `level` all over the box.
    pub fn grid_of(&self, level: u32) -> Grid<D> {
        Grid {
            axes: self.grid.axes.map(|a| Axis {
                cell: a.cell * 0.5f64.powi(level as i32),
                n_cells: a.n_cells << level,
                ..a
            }),
        }
    }

    /// A copy, where there is room for one.
    pub fn try_clone(&self) -> Result<Self> {
        let mut tiles = try_with_capacity(self.tiles.len(), "the tiles")?;
        tiles.extend_from_slice(&self.tiles);
        Ok(Tree { tiles, ..*self })
    }

    /// The same tiles on the cells of `grid`, which differs in its unit.
    pub fn on(self, grid: Grid<D>) -> Self {
        Tree { grid, ..self }
    }

    /// Cells of `tile` along each axis: 4, fewer at the upper faces, 0 beyond them.
    pub fn cells(&self, tile: &Tile<D>) -> [usize; D] {
        std::array::from_fn(|a| self.n_cells(tile.level, a).saturating_sub(SIDE * tile.place[a] as usize).min(SIDE))
    }

    /// Whether `tile` has cells in the box.
    pub fn holds(&self, tile: &Tile<D>) -> bool {
        self.cells(tile).iter().all(|n| *n > 0)
    }

    /// The leaf that holds a point of the box given in cells of the grid, and the point in the leaf's cells from its lower corner on.
    #[inline(always)]
    pub fn locate(&self, xi: &[f64; D]) -> (usize, [f64; D]) {
        let (mut index, mut y) = (0, [0.0; D]);
        for a in 0..D {
            let x = if xi[a] < self.below_end[a] { xi[a] } else { self.below_end[a] };
            let place = (x * (1.0 / SIDE as f64)) as usize;
            y[a] = x - (SIDE * place) as f64;
            index = index * self.roots[a] + place;
        }
        while self.tiles[index].child != 0 {
            let mut part = 0;
            for y in &mut y {
                let upper = *y >= 2.0;
                *y = 2.0 * (*y - if upper { 2.0 } else { 0.0 });
                part = 2 * part + usize::from(upper);
            }
            index = self.tiles[index].child as usize + part;
        }
        (index, y)
    }

    /// The deepest tile that holds the tile at `place` of `level`, and is not deeper; `None` beyond the box.
    fn holder(&self, level: u32, place: [u32; D]) -> Option<usize> {
        if (0..D).any(|a| SIDE * place[a] as usize >= self.n_cells(level, a)) {
            return None;
        }
        let at = |of: u32, a: usize| (place[a] >> (level - of)) as usize;
        let mut index = (0..D).fold(0, |index, a| index * self.roots[a] + at(0, a));
        while self.tiles[index].level < level && !self.tiles[index].is_leaf() {
            let below = self.tiles[index].level + 1;
            let part = (0..D).fold(0, |part, a| 2 * part + (at(below, a) & 1));
            index = self.tiles[index].child as usize + part;
        }
        Some(index)
    }

    /// The tile at `place` of `level`, where there is one.
    #[cfg(test)]
    fn find(&self, level: u32, place: [u32; D]) -> Option<usize> {
        self.holder(level, place).filter(|&i| self.tiles[i].level == level)
    }

    /// Calls `visit(tile, true)` on the way into each tile, then for its parts in order, and `visit(tile, false)` on the way out.
    pub fn walk(&self, mut visit: impl FnMut(usize, bool)) {
        (0..self.roots.iter().product()).for_each(|root| self.walk_from(root, &mut visit));
    }

    fn walk_from(&self, tile: usize, visit: &mut impl FnMut(usize, bool)) {
        visit(tile, true);
        let Tile { child, .. } = self.tiles[tile];
        if child != 0 {
            (0..1_usize << D).for_each(|part| self.walk_from(child as usize + part, visit));
        }
        visit(tile, false);
    }

    /// Cuts the tile at `place` of `level`, and before that all that hold it; whether it was a leaf. Nothing is done beyond the box and at
    /// the deepest level.
    pub fn cut(&mut self, level: u32, place: [u32; D]) -> Result<bool> {
        while let Some(index) = self.holder(level, place) {
            if !self.cut_index(index as u32)? {
                return Ok(false);
            }
            if self.tiles[index].level == level {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Cuts tile `index`; whether there was such a leaf.
    pub fn cut_index(&mut self, index: u32) -> Result<bool> {
        let Some(&tile) = self.tiles.get(index as usize) else { return Ok(false) };
        // Places are numbers of 32 bits too.
        let too_deep = tile.level >= DEEPEST || (0..D).any(|a| self.n_cells(tile.level + 1, a) > u32::MAX as usize);
        if !tile.is_leaf() || too_deep || !self.holds(&tile) || self.tiles.len() > MOST_TILES {
            return Ok(false);
        }
        try_reserve(&mut self.tiles, 1 << D, "the tiles")?;
        self.tiles[index as usize].child = self.tiles.len() as u32;
        for part in 0..1_usize << D {
            let place = std::array::from_fn(|a| 2 * tile.place[a] + (part >> (D - 1 - a) & 1) as u32);
            self.tiles.push(Tile { level: tile.level + 1, place, child: 0 });
        }
        Ok(true)
    }

    /// The tiles that are cut, in the order in which they were.
    pub fn cuts(&self) -> Result<Vec<u32>> {
        let is_cut = |i: &u32| !self.tiles[*i as usize].is_leaf();
        let mut cuts = try_with_capacity(self.tiles.len() >> D, "the cuts")?;
        cuts.extend((0..self.tiles.len() as u32).filter(is_cut));
        cuts.sort_unstable_by_key(|i| self.tiles[*i as usize].child);
        Ok(cuts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;

    fn tree(n_cells: [usize; 3]) -> Tree<3> {
        Tree::new(Grid { axes: n_cells.map(|n| Axis { lower: 0.0, cell: 1.0, n_cells: n }) }).unwrap()
    }

    #[test]
    fn every_point_of_the_box_lies_in_one_leaf_with_cells() {
        let mut random = SplitMix64::new(3);
        let mut tree = tree([5, 4, 9]);
        for _ in 0..40 {
            let level = (4.0 * random.unit()) as u32;
            let place = std::array::from_fn(|a| (tree.n_cells(level, a) as f64 / 4.0 * random.unit()) as u32);
            tree.cut(level, place).unwrap();
        }
        assert!(tree.n_levels() > 3);
        for i in 0..2000 {
            let xi: [f64; 3] = std::array::from_fn(|a| {
                let n = tree.n_cells(0, a) as f64;
                [0.0, n, (n * 8.0 * random.unit()).floor() / 8.0, n * random.unit()][(i >> (2 * a)) % 4]
            });
            let (leaf, y) = tree.locate(&xi);
            let tile = tree.tiles()[leaf];
            assert!(tile.is_leaf());
            let cells = tree.cells(&tile);
            for a in 0..3 {
                assert!(y[a] >= 0.0 && y[a] < cells[a] as f64, "{xi:?} is {y:?} of {cells:?}");
                let there = (f64::from(4 * tile.place[a]) + y[a]) / f64::from(1 << tile.level);
                assert!((there - xi[a]).abs() < 1e-14);
            }
            assert_eq!(tree.find(tile.level, tile.place), Some(leaf));
        }
    }

    #[test]
    fn leaves_cover_the_box_once() {
        let mut tree = tree([5, 4, 9]);
        let mut cut = |level, place| tree.cut(level, place).unwrap();
        assert!(cut(3, [9, 1, 17]), "with all that hold it");
        assert!(!cut(3, [9, 1, 17]) && !cut(1, [2, 0, 4]), "it is cut already");
        assert!(!cut(0, [2, 0, 0]), "beyond the box");
        let volume = |t: &Tile<3>| tree.cells(t).iter().product::<usize>() as f64 / 8f64.powi(t.level as i32);
        let leaves = tree.tiles().iter().filter(|t| t.is_leaf());
        assert_eq!(leaves.map(volume).sum::<f64>(), 5.0 * 4.0 * 9.0);
        assert_eq!(tree.find(2, [0, 0, 0]), None);
        assert_eq!(tree.n_levels(), 5);
    }
}
