//! The largest phi where no sample may be: on the infeasible side, and within `reach` of the shape.
//!
//! A box is left alone where that set does not meet it: where the exact distance of its centre c is more than `reach` + h, h half its
//! diagonal, and it is on the feasible side. It does not meet the shape then, so that all of it is on the side of c. In a box on the feasible
//! side that stays in play only what lies in a half-space counts: `geometry::distance::half_space`.

use super::parts::{Cells, Part};
use super::search::{Look, Problem};
use super::value;
use super::{bounds, outside};
use crate::field::Outputs;
use crate::geometry::vec::{add, scale, sub};
use crate::geometry::{Bounds, DistanceTree, HalfSpace};
use crate::spline::hull::Window;

/// Boxes larger than this many times `reach` are not worth a half-space: facets all around are in its way.
const LARGEST: f64 = 1.0;

/// A found point lies this much nearer to the shape than `reach`, as a fraction, so that it is within reach for sure.
const WITHIN: f64 = 1.0 - 1e-12;

/// What is known of the side of a box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Known {
    Nothing,
    /// Off the shape, on the feasible side.
    Feasible,
    /// Off the shape, on the infeasible side.
    Infeasible,
}

/// A part, and what is known of its side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node<const D: usize> {
    part: Part<D>,
    side: Known,
}

/// The search for the threshold.
pub(super) struct Clearance<'a, const D: usize> {
    pub cells: Cells<'a, D>,
    pub tree: &'a DistanceTree<D>,
    /// What holds the set; without end where the infeasible side is.
    pub range: Bounds<D>,
    /// d + r
    pub reach: f64,
    /// What distances may be off by.
    pub slack: f64,
    /// Whether points inside are infeasible, or those outside; `None` where sides are not certified.
    pub infeasible_inside: Option<bool>,
}

impl<const D: usize> Problem<D> for Clearance<'_, D> {
    type Node = Node<D>;

    fn n_groups(&self) -> usize {
        self.cells.n_groups()
    }

    fn group(&self, group: usize, visit: &mut dyn FnMut(Node<D>)) {
        self.cells.in_group(group, |cell| {
            self.cells.parts(cell, &self.range, |part| visit(Node { part, side: Known::Nothing }));
        });
    }

    fn split(&self, node: &Node<D>, visit: &mut dyn FnMut(Node<D>)) {
        self.cells.split(&node.part, |part| visit(Node { part, ..*node }));
    }

    fn look(&self, mut node: Node<D>, floor: f64) -> Look<Node<D>, D> {
        let points = self.cells.bezier(&node.part);
        let upper = self.cells.range(&node.part, &points).high;
        let mut look = Look { node, upper, found: f64::NEG_INFINITY, place: [0.0; D], n_bounds: 1 };
        let bounds = self.cells.bounds(&node.part);
        let extents = bounds.extents();
        // A part without end is to be cut.
        if upper <= floor || extents.contains(&f64::INFINITY) {
            return look;
        }
        let (center, h) = (bounds.center(), 0.5 * bounds.diagonal() + self.slack);
        let mut is_within = false;
        if node.side != Known::Infeasible {
            // Coordinates are finite.
            let Ok(closest) = self.tree.closest_point(center) else { return look };
            is_within = closest.distance <= WITHIN * self.reach;
            if closest.distance > h && node.side == Known::Nothing {
                node.side = self.side(center);
                look.node = node;
            }
            if node.side != Known::Infeasible {
                if closest.distance - h > self.reach && node.side == Known::Feasible {
                    return Look { upper: f64::NEG_INFINITY, ..look };
                }
                let share = if closest.distance > 0.0 { WITHIN * self.reach / closest.distance } else { 0.0 };
                look.place = add(closest.point, scale(share, sub(center, closest.point)));
                if node.side == Known::Feasible && h < LARGEST * self.reach {
                    let reach = self.reach + 2.0 * self.slack;
                    if let Some(half) = self.tree.half_space(center, h, reach) {
                        look.upper = upper.min(self.highest_in(&half, &node.part, &points, &bounds));
                    }
                }
            }
        }
        if node.side == Known::Infeasible {
            look.place = center;
        }
        look.found = value(self.cells.field, look.place);
        if is_within {
            // Where the shape is on both sides the point as far off as reach lets it be is past the largest phi.
            let phi = value(self.cells.field, center);
            if phi > look.found {
                (look.found, look.place) = (phi, center);
            }
        }
        look
    }
}

impl<const D: usize> Clearance<'_, D> {
    /// The largest of phi on a part that lies in a half-space told from its middle.
    fn highest_in(&self, half: &HalfSpace<D>, part: &Part<D>, points: &Window, bounds: &Bounds<D>) -> f64 {
        let (extents, HalfSpace { normal, offset }) = (bounds.extents(), half);
        if part.is_inside() {
            return bounds::highest_below(points, &extents, normal, *offset);
        }
        let (mut phi, mut slopes) = ([f64::INFINITY], [[0.0; D]]);
        let outputs = Outputs { values: Some(&mut phi), gradients: Some(&mut slopes), hessians: None };
        // Too far to be evaluated: no bound.
        let _ = self.cells.field.eval(&[bounds.center()], outputs);
        outside::highest_below((phi[0], slopes[0]), &self.cells.gradient_beyond(part), &extents, normal, *offset)
    }

    /// The side of a point off the shape. Where sides are not certified none is infeasible.
    fn side(&self, point: [f64; D]) -> Known {
        match self.infeasible_inside {
            Some(inside) if self.tree.is_inside(point) == inside => Known::Infeasible,
            _ => Known::Feasible,
        }
    }
}
