//! Parts of the space on which phi is one formula: parts of cells and, beyond the faces of the box, what is continued from a cell.

use super::super::Field;
use crate::geometry::Bounds;
use crate::spline::hierarchical::{per_table, strides};
use crate::spline::tree::{SIDE, Tree, in_tile};

/// Coordinates in a cell this close to its faces are taken for them.
const ASIDE: f64 = 1e-9;

/// A cell of a field.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell<const D: usize> {
    /// Cells of the grid are 2^level times as long.
    pub level: u32,
    /// In cells of its level.
    pub place: [u32; D],
    /// Where its control points begin.
    pub first: usize,
}

/// Where a part stands along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stand {
    Inside,
    /// Beyond the lower face.
    Below,
    /// Beyond the upper face.
    Above,
}

/// Up to three stands along an axis, with their spans.
type Stands = [Option<(Stand, [f64; 2])>; 3];

/// A box in one cell, or beyond it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part<const D: usize> {
    pub cell: Cell<D>,
    pub stand: [Stand; D],
    /// From and to along each axis: inside in cells, from the cell's lower face on; beyond a face the distance from it, which may go on
    /// for ever.
    pub span: [[f64; 2]; D],
}

impl<const D: usize> Part<D> {
    /// Whether it lies in the box.
    pub fn is_inside(&self) -> bool {
        self.stand == [Stand::Inside; D]
    }
}

/// The cells of a field.
pub(super) struct Cells<'a, const D: usize> {
    pub field: &'a Field<D>,
    pub control_points: &'a [f64],
    pub strides: [usize; D],
    /// max |c|
    pub size: f64,
}

impl<'a, const D: usize> Cells<'a, D> {
    pub fn of(field: &'a Field<D>) -> Self {
        let with = |control_points: &'a [f64], strides| {
            let size = control_points.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
            Cells { field, control_points, strides, size }
        };
        match &field.refined {
            Some(refined) => with(refined.tables(), strides::<D>()),
            None => {
                let mut by_axis = [1; D];
                for a in (1..D).rev() {
                    by_axis[a - 1] = by_axis[a] * field.grid.axes[a].n_control();
                }
                with(&field.coefficients, by_axis)
            }
        }
    }

    fn tree(&self) -> Option<&'a Tree<D>> {
        self.field.refined.as_ref().map(|r| r.tree())
    }

    /// Groups of cells that together are all: lines along the last axis, or tiles of a tree.
    pub fn n_groups(&self) -> usize {
        match self.tree() {
            Some(tree) => tree.tiles().len(),
            None => self.field.grid.n_cells()[..D - 1].iter().product(),
        }
    }

    /// The cells of a group.
    pub fn in_group(&self, group: usize, mut visit: impl FnMut(Cell<D>)) {
        if let Some(tree) = self.tree() {
            let tile = &tree.tiles()[group];
            if tile.is_leaf() && tree.holds(tile) {
                let n = tree.cells(tile);
                self.in_leaf(group, [[0; D], n], &mut visit);
            }
            return;
        }
        let (n, mut line) = (self.field.grid.n_cells(), group);
        let mut place = [0; D];
        for a in (0..D - 1).rev() {
            (place[a], line) = ((line % n[a]) as u32, line / n[a]);
        }
        for k in 0..n[D - 1] {
            place[D - 1] = k as u32;
            visit(self.on_grid(place));
        }
    }

    fn on_grid(&self, place: [u32; D]) -> Cell<D> {
        Cell { level: 0, place, first: (0..D).map(|a| place[a] as usize * self.strides[a]).sum() }
    }

    /// The cells from `from` to before `to` of leaf `tile`.
    fn in_leaf(&self, tile: usize, [from, to]: [[usize; D]; 2], visit: &mut impl FnMut(Cell<D>)) {
        let Some(tree) = self.tree() else { return };
        let of = &tree.tiles()[tile];
        for i in 0..SIDE.pow(D as u32) {
            let at: [usize; D] = in_tile(i);
            if (0..D).all(|a| (from[a]..to[a]).contains(&at[a])) {
                let first = tile * per_table::<D>() + (0..D).map(|a| at[a] * self.strides[a]).sum::<usize>();
                let place = std::array::from_fn(|a| SIDE as u32 * of.place[a] + at[a] as u32);
                visit(Cell { level: of.level, place, first });
            }
        }
    }

    /// The cells that meet `range`, and those from which the field is continued to where it lies beyond the box.
    pub fn near(&self, range: &Bounds<D>, mut visit: impl FnMut(Cell<D>)) {
        let axes = &self.field.grid.axes;
        // In cells of the grid, brought to the box.
        let ends: [[f64; 2]; D] = std::array::from_fn(|a| {
            let n = axes[a].n_cells as f64;
            [range.min[a], range.max[a]].map(|x| ((x - axes[a].lower) / axes[a].cell).clamp(0.0, n))
        });
        // The first and the last of the n cells of `edge` from `from` on.
        let clip = |a: usize, from: f64, edge: f64, n: usize| -> [usize; 2] {
            let last = (n - 1) as f64;
            let index = |x: f64, aside: f64| ((x - from) / edge + aside).floor().clamp(0.0, last) as usize;
            [index(ends[a][0], -ASIDE), index(ends[a][1], ASIDE) + 1]
        };
        let Some(tree) = self.tree() else {
            let n = self.field.grid.n_cells();
            let lines: [[usize; 2]; D] = std::array::from_fn(|a| clip(a, 0.0, 1.0, n[a]));
            return each(lines, |at| visit(self.on_grid(at.map(|x| x as u32))));
        };
        let n_roots = self.field.grid.n_cells().map(|n| n.div_ceil(SIDE));
        let mut stack = Vec::new();
        let roots: [[usize; 2]; D] = std::array::from_fn(|a| clip(a, 0.0, SIDE as f64, n_roots[a]));
        each(roots, |at| stack.push((0..D).fold(0, |index, a| index * n_roots[a] + at[a])));
        while let Some(index) = stack.pop() {
            let tile = &tree.tiles()[index];
            let edge = 0.5f64.powi(tile.level as i32);
            let from = |a: usize| edge * (SIDE as f64) * f64::from(tile.place[a]);
            let n = tree.cells(tile);
            let meets = |a: usize| {
                n[a] > 0 && ends[a][0] <= from(a) + edge * (n[a] as f64 + ASIDE) && ends[a][1] >= from(a) - edge * ASIDE
            };
            if !(0..D).all(meets) {
                continue;
            }
            if tile.is_leaf() {
                let lines: [[usize; 2]; D] = std::array::from_fn(|a| clip(a, from(a), edge, n[a]));
                self.in_leaf(index, [lines.map(|l| l[0]), lines.map(|l| l[1])], &mut visit);
            } else {
                stack.extend((0..1 << D).map(|part| tile.child as usize + part));
            }
        }
    }

    /// The parts of `range`, which may be without end, in `cell` and beyond it.
    pub fn parts(&self, cell: Cell<D>, range: &Bounds<D>, mut visit: impl FnMut(Part<D>)) {
        // Along each axis up to three stands, with their spans.
        let stands: [Stands; D] = std::array::from_fn(|a| self.stands(&cell, range, a));
        each([[0, 3]; D], |which| {
            let mut part = Part { cell, stand: [Stand::Inside; D], span: [[0.0; 2]; D] };
            for a in 0..D {
                let Some((stand, span)) = stands[a][which[a]] else { return };
                (part.stand[a], part.span[a]) = (stand, span);
            }
            visit(part);
        });
    }

    fn stands(&self, cell: &Cell<D>, range: &Bounds<D>, a: usize) -> Stands {
        let axis = self.field.grid.axes[a];
        let h = axis.cell * 0.5f64.powi(cell.level as i32);
        let place = cell.place[a];
        let [low, high] = [range.min[a], range.max[a]].map(|x| (x - axis.lower) / h - f64::from(place));
        let low = if low < ASIDE { 0.0 } else { low };
        let high = if high > 1.0 - ASIDE { 1.0 } else { high };
        let inside = (low <= 1.0 && high >= 0.0).then_some((Stand::Inside, [low, high.max(low)]));
        let is_last = place as usize + 1 == axis.n_cells << cell.level;
        // A part without width is in the box.
        let beyond = |stand, from: f64, to: f64| (to > 0.0).then_some((stand, [from.max(0.0), to]));
        let below =
            if place == 0 { beyond(Stand::Below, axis.lower - range.max[a], axis.lower - range.min[a]) } else { None };
        let above =
            if is_last { beyond(Stand::Above, range.min[a] - axis.upper(), range.max[a] - axis.upper()) } else { None };
        [inside, below, above]
    }

    /// The shortest edge of all cells.
    pub fn shortest_edge(&self) -> f64 {
        let axes = self.field.grid.axes.iter().map(|a| a.cell).fold(f64::INFINITY, f64::min);
        let level = self.tree().map_or(0, |tree| tree.tiles().iter().map(|t| t.level).max().unwrap_or(0));
        axes * 0.5f64.powi(level as i32)
    }

    /// Edge of a cell along axis `a`.
    pub fn edge(&self, cell: &Cell<D>, a: usize) -> f64 {
        self.field.grid.axes[a].cell * 0.5f64.powi(cell.level as i32)
    }

    /// Where a part is.
    pub fn bounds(&self, part: &Part<D>) -> Bounds<D> {
        let ends: [[f64; 2]; D] = std::array::from_fn(|a| {
            let axis = &self.field.grid.axes[a];
            let [low, high] = part.span[a];
            match part.stand[a] {
                Stand::Inside => {
                    let (h, place) = (self.edge(&part.cell, a), f64::from(part.cell.place[a]));
                    [low, high].map(|u| axis.lower + h * (place + u))
                }
                Stand::Below => [axis.lower - high, axis.lower - low],
                Stand::Above => [axis.upper() + low, axis.upper() + high],
            }
        });
        Bounds { min: ends.map(|e| e[0]), max: ends.map(|e| e[1]) }
    }

    /// Cuts a part in two along each axis along which it is not much shorter than along its longest. What goes on for ever is cut where it
    /// has doubled.
    pub fn split(&self, part: &Part<D>, mut visit: impl FnMut(Part<D>)) {
        let extents = self.bounds(part).extents();
        let longest = extents.iter().fold(0.0, |m: f64, e| m.max(*e));
        let pieces: [[Option<[f64; 2]>; 2]; D] = std::array::from_fn(|a| {
            let [low, high] = part.span[a];
            if extents[a] < 0.6 * longest || high <= low {
                return [Some([low, high]), None];
            }
            let middle = if high.is_finite() { 0.5 * (low + high) } else { 2.0 * low + self.field.grid.axes[a].cell };
            [Some([low, middle]), Some([middle, high])]
        });
        each([[0, 2]; D], |which| {
            let mut child = *part;
            for a in 0..D {
                let Some(span) = pieces[a][which[a]] else { return };
                child.span[a] = span;
            }
            visit(child);
        });
    }
}

/// Calls `visit` with every place from the first to before the second number along each axis.
fn each<const D: usize>(lines: [[usize; 2]; D], mut visit: impl FnMut([usize; D])) {
    if lines.iter().any(|[from, to]| from >= to) {
        return;
    }
    let mut at = lines.map(|l| l[0]);
    loop {
        visit(at);
        let Some(a) = (0..D).rev().find(|&a| at[a] + 1 < lines[a][1]) else { return };
        at[a] += 1;
        (a + 1..D).for_each(|b| at[b] = lines[b][0]);
    }
}
