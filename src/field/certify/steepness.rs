//! The largest |grad phi|, in the box or beyond it.

use super::parts::{Cells, Part};
use super::search::{Look, Problem};
use crate::field::Outputs;
use crate::geometry::Bounds;
use crate::geometry::vec::norm;

/// The search for the steepest place.
pub(super) struct Steepness<'a, const D: usize> {
    pub cells: Cells<'a, D>,
    /// Whether to look beyond the box, and not in it.
    pub beyond: bool,
    /// What control points may be off by.
    pub rounding: f64,
}

impl<const D: usize> Problem<D> for Steepness<'_, D> {
    type Node = Part<D>;

    fn n_groups(&self) -> usize {
        self.cells.n_groups()
    }

    fn group(&self, group: usize, visit: &mut dyn FnMut(Part<D>)) {
        let everywhere = Bounds { min: [f64::NEG_INFINITY; D], max: [f64::INFINITY; D] };
        self.cells.in_group(group, |cell| {
            self.cells.parts(cell, &everywhere, |part| {
                if part.is_inside() != self.beyond {
                    visit(part);
                }
            });
        });
    }

    fn split(&self, part: &Part<D>, visit: &mut dyn FnMut(Part<D>)) {
        self.cells.split(part, visit);
    }

    fn look(&self, part: Part<D>, _floor: f64) -> Look<Part<D>, D> {
        let upper = self.cells.slope(&part, self.rounding);
        let bounds = self.cells.bounds(&part);
        let center = bounds.center();
        if center.iter().any(|x| !x.is_finite()) {
            return Look { node: part, upper, found: 0.0, place: [0.0; D], n_bounds: 1 };
        }
        let mut gradient = [[0.0; D]];
        let outputs = Outputs { gradients: Some(&mut gradient), ..Outputs::default() };
        let served = self.cells.field.eval(&[center], outputs).is_ok();
        let found = if served { norm(gradient[0]) } else { 0.0 };
        Look { node: part, upper, found, place: center, n_bounds: 1 }
    }
}
