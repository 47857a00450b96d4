//! Where to refine: where the surface misses points by more than it may, where parts are thin, and where phi is far from the distances held.

use super::energy::RefinedEnergy;
use crate::Result;
use crate::error::{try_reserve_entry, try_with_capacity};
use crate::geometry::vec::{add, norm};
use crate::spline::tree::{DEEPEST, SIDE, Tree};
use std::cmp::Ordering;
use std::collections::HashMap;

/// Cells of the coarser level around a point that are refined: those that its four finer functions along an axis reach.
const REACH: f64 = 1.5;

/// Points below which a tile tells nothing that finer cells could follow.
const FEWEST: usize = 4;

/// Mean of the normals of a tile's points below which surface faces surface there.
const FACING: f64 = 0.5;

/// Cells, in `max_error`, that are fine enough for thin parts.
const THIN: f64 = 8.0;

/// A place to refine, by how much it wants it.
pub struct Mark<const D: usize> {
    /// In cells of the grid.
    at: [f64; D],
    level: u32,
    /// How many times as large as wanted the error is.
    excess: f64,
}

/// Marks the points that the surface misses by more than `max_error`, by their `errors`, both in units of D; and, but where `strays` is empty, points of thin parts
/// and the tiles for which it is true. The worst come first.
pub fn marks<const D: usize>(
    energy: &RefinedEnergy<D>,
    errors: &[f64],
    strays: &[bool],
    max_error: f64,
) -> Result<Vec<Mark<D>>> {
    let (tree, data) = (energy.tree(), energy.data());
    let longest = tree.grid().longest_cell();
    let may_be_thin = |level: u32| !strays.is_empty() && longest * 0.5f64.powi(level as i32) > THIN * max_error;
    let leaves = || tree.tiles().iter().enumerate().filter(|(_, t)| t.is_leaf());
    let mut sums = NormalSums { of_tile: HashMap::new() };
    for (tile, t) in leaves().filter(|(_, t)| may_be_thin(t.level)) {
        for p in energy.points_of(tile) {
            sums.add(t.level, &data.xi[p], data.normals[p])?;
        }
    }
    let mut marks = try_with_capacity(errors.len() + strays.len(), "the marks of a refinement")?;
    for (tile, t) in leaves().filter(|(_, t)| t.level < DEEPEST) {
        let points = energy.points_of(tile);
        if points.len() < FEWEST {
            continue;
        }
        for p in points {
            let excess = errors[p] / max_error;
            let is_thin = may_be_thin(t.level) && sums.face(t.level, &data.xi[p]);
            if excess > 1.0 || is_thin {
                marks.push(Mark { at: data.xi[p], level: t.level, excess });
            }
        }
    }
    for (_, t) in leaves().filter(|(i, t)| strays.get(*i) == Some(&true) && may_be_thin(t.level)) {
        let per_tile = SIDE as f64 / f64::from(1u32 << t.level);
        let at = t.place.map(|p| (f64::from(p) + 0.5) * per_tile);
        marks.push(Mark { at, level: t.level, excess: 1.0 });
    }
    // Marks as bad as each other by their place, so that there is one outcome.
    let place = |a: &Mark<D>, b: &Mark<D>| {
        a.at.iter().zip(&b.at).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    };
    marks.sort_unstable_by(|a, b| b.excess.total_cmp(&a.excess).then_with(|| place(a, b)));
    Ok(marks)
}

/// A tile, or, shifted, one that begins in the middle of tiles: twice its level, and 1 more where it is shifted; and its place.
type Window<const D: usize> = (u32, [u32; D]);

/// Sums of the points' normals in tiles.
struct NormalSums<const D: usize> {
    /// With the number of points.
    of_tile: HashMap<Window<D>, ([f64; D], f64)>,
}

impl<const D: usize> NormalSums<D> {
    /// The tile of a point given in cells of the grid, and the shifted one: parts that face each other across a tile's face are in that.
    fn windows(level: u32, xi: &[f64; D]) -> [Window<D>; 2] {
        let per_tile = f64::from(1u32 << level) / SIDE as f64;
        [(0, 0.0), (1, 0.5)].map(|(shifted, by)| (2 * level + shifted, xi.map(|x| (x * per_tile + by) as u32)))
    }

    fn add(&mut self, level: u32, xi: &[f64; D], normal: [f64; D]) -> Result<()> {
        for window in Self::windows(level, xi) {
            try_reserve_entry(&mut self.of_tile, "the sums of normals")?;
            let (sum, n) = self.of_tile.entry(window).or_insert(([0.0; D], 0.0));
            (*sum, *n) = (add(*sum, normal), *n + 1.0);
        }
        Ok(())
    }

    /// Whether surface faces surface in a tile of the point.
    fn face(&self, level: u32, xi: &[f64; D]) -> bool {
        // With numbers where there is no entry: jumps are then by what is set, which valgrind sees.
        let sum_in = |window: &Window<D>| self.of_tile.get(window).copied().unwrap_or(([0.0; D], 0.0));
        let [own, shifted] = Self::windows(level, xi);
        [sum_in(&own), sum_in(&shifted)].iter().any(|(sum, n)| norm(*sum) < FACING * n)
    }
}

/// Cuts the tiles around the places marked.
pub fn cut<const D: usize>(tree: &mut Tree<D>, marks: &[Mark<D>]) -> Result<()> {
    for mark in marks {
        let per_tile = f64::from(1u32 << mark.level) / SIDE as f64;
        let range: [[u32; 2]; D] = std::array::from_fn(|a| {
            let reach = REACH / SIDE as f64;
            // Below 0 becomes 0; beyond the box nothing is cut.
            [mark.at[a] * per_tile - reach, mark.at[a] * per_tile + reach].map(|x| x as u32)
        });
        for bits in 0..1_usize << D {
            let place = std::array::from_fn(|a| range[a][bits >> a & 1]);
            tree.cut(mark.level, place)?;
        }
    }
    Ok(())
}
