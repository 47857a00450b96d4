//! The largest |phi| on the shape.
//!
//! A piece of a facet lies in its bounding box, and there n . (x - v) = 0, n the facet's normal and v a corner. So phi on it is phi - lambda n .
//! (x - v) for any lambda, of which the hull is taken on the part of each cell that the bounding box meets: with lambda the derivative
//! along n the box, which is wide where the facet is slanted, costs hardly more than the facet.

use super::bounds::{derivative, tilted};
use super::parts::Cells;
use super::search::{Look, Problem};
use super::value;
use crate::geometry::facet::normal;
use crate::geometry::vec::{dot, norm, scale, sub};
use crate::geometry::{Bounds, Mesh};
use crate::spline::hull;

/// Pieces longer than this many cells are split before they are looked at.
const LONGEST: f64 = 2.0;

/// Facets of a group.
const GROUP: usize = 32;

/// The sine of the angle at a corner below which a facet's normal is not trusted.
const SHARPEST: f64 = 1e-2;

/// A piece of a facet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece<const D: usize> {
    corners: [[f64; D]; D],
    facet: u32,
}

/// The search for the largest error on the surface.
pub(super) struct Surface<'a, const D: usize> {
    pub cells: Cells<'a, D>,
    pub mesh: &'a Mesh<D>,
    /// What coordinates of the mesh and of the box may be off by.
    pub slack: f64,
}

impl<const D: usize> Problem<D> for Surface<'_, D> {
    type Node = Piece<D>;

    fn n_groups(&self) -> usize {
        self.mesh.facets().len().div_ceil(GROUP)
    }

    fn group(&self, group: usize, visit: &mut dyn FnMut(Piece<D>)) {
        let first = group * GROUP;
        for facet in first..(first + GROUP).min(self.mesh.facets().len()) {
            visit(Piece { corners: self.mesh.corners(facet), facet: facet as u32 });
        }
    }

    /// At the middle of the longest edge.
    fn split(&self, piece: &Piece<D>, visit: &mut dyn FnMut(Piece<D>)) {
        let (mut longest, mut ends) = (-1.0, [0, 1]);
        for [i, j] in [[0, 1], [1, 2], [2, 0]].iter().filter(|ends| ends.iter().all(|k| *k < D)) {
            let length = norm(sub(piece.corners[*i], piece.corners[*j]));
            if length > longest {
                (longest, ends) = (length, [*i, *j]);
            }
        }
        let [p, q] = ends.map(|k| piece.corners[k]);
        let middle = std::array::from_fn(|a| 0.5 * p[a] + 0.5 * q[a]);
        for end in ends {
            let mut half = *piece;
            half.corners[end] = middle;
            visit(half);
        }
    }

    fn look(&self, piece: Piece<D>, _floor: f64) -> Look<Piece<D>, D> {
        let place = std::array::from_fn(|a| piece.corners.iter().map(|c| c[a]).sum::<f64>() / D as f64);
        let found = value(self.cells.field, place).abs();
        let bounds = Bounds::of(&piece.corners);
        let (extents, axes) = (bounds.extents(), &self.cells.field.grid().axes);
        let is_long = (0..D).any(|a| extents[a] > LONGEST * axes[a].cell);
        let (upper, n_bounds) = if is_long { (f64::INFINITY, 1) } else { self.bound(&piece, bounds) };
        Look { node: piece, upper, found, place, n_bounds }
    }
}

impl<const D: usize> Surface<'_, D> {
    /// A bound of |phi| on a piece, and how many it took: one a part of a cell.
    fn bound(&self, piece: &Piece<D>, bounds: Bounds<D>) -> (f64, u64) {
        let range = Bounds { min: bounds.min.map(|x| x - self.slack), max: bounds.max.map(|x| x + self.slack) };
        let (corner, unit) = self.plane(piece.facet as usize);
        let (mut largest, mut n_bounds): (f64, u64) = (0.0, 0);
        self.cells.near(&range, |cell| {
            self.cells.parts(cell, &range, |part| {
                n_bounds += 1;
                let points = self.cells.bezier(&part);
                let plain = self.cells.range(&part, &points);
                let mut bound = plain.high.max(-plain.low);
                if let Some(unit) = unit
                    && part.is_inside()
                {
                    let there = self.cells.bounds(&part);
                    let extents = there.extents();
                    let slope = derivative(&points, &extents, &unit);
                    let constant = slope * dot(unit, sub(there.center(), corner));
                    let (low, high) = hull::range::<D>(&tilted(&points, &extents, &unit, [slope, constant]));
                    bound = bound.min(high.max(-low));
                }
                largest = largest.max(bound);
            });
        });
        (largest, n_bounds.max(1))
    }

    /// A corner of a facet and its unit normal, where that is well determined.
    fn plane(&self, facet: usize) -> ([f64; D], Option<[f64; D]>) {
        let corners = self.mesh.corners(facet);
        let (n, sides) = (normal(&corners), (1..D).map(|k| norm(sub(corners[k], corners[0]))));
        let (length, most) = (norm(n), sides.product::<f64>());
        (corners[0], (length > SHARPEST * most).then(|| scale(1.0 / length, n)))
    }
}
