//! Bounds of phi and of its gradient on a part of the space.
//!
//! In a cell, or beyond it as far as its polynomial P is continued, P lies between its Bezier points on the part ([`hull`]): these are
//! blossoms, for which it does not matter that the part is not in the cell. What is made of P beyond a face is in
//! `outside`.

use super::parts::{Cells, Part, Stand};
use crate::spline::hull::{self, Window};
use crate::spline::kernel::Stencil;

/// Where phi lies on a part.
pub(super) struct Range {
    pub low: f64,
    pub high: f64,
}

impl<const D: usize> Cells<'_, D> {
    /// The part in the cell's own coordinates, bent where it is beyond a face.
    pub fn local(&self, part: &Part<D>) -> [[f64; 2]; D] {
        let reach = self.field.beyond.reach;
        std::array::from_fn(|a| {
            let [low, high] = part.span[a];
            let times = (1u64 << part.cell.level) as f64;
            let s = |t: f64| reach * times * (t / (reach * self.field.grid.axes[a].cell)).tanh();
            match part.stand[a] {
                Stand::Inside => [low, high],
                Stand::Below => [-s(high), -s(low)],
                Stand::Above => [1.0 + s(low), 1.0 + s(high)],
            }
        })
    }

    /// The Bezier points of P on what is bent of a part.
    pub fn bezier(&self, part: &Part<D>) -> Window {
        self.bezier_on(part, &self.local(part))
    }

    pub fn bezier_on(&self, part: &Part<D>, local: &[[f64; 2]; D]) -> Window {
        let stencil = Stencil { first: part.cell.first, strides: self.strides };
        hull::bezier(&hull::window(&stencil, self.control_points), local)
    }

    /// Where phi lies on a part of which `points` are the Bezier points.
    pub fn range(&self, part: &Part<D>, points: &Window) -> Range {
        let (low, high) = hull::range::<D>(points);
        if part.is_inside() {
            return Range { low, high };
        }
        self.range_beyond(part, [low, high])
    }

    /// A bound of |grad phi| on a part; `rounding` is what control points may be off by.
    pub fn slope(&self, part: &Part<D>, rounding: f64) -> f64 {
        if !part.is_inside() {
            return self.slope_beyond(part, rounding);
        }
        let points = self.bezier(part);
        let along = |a: usize| {
            let width = self.edge(&part.cell, a) * (part.span[a][1] - part.span[a][0]);
            let [low, high] = steps::<D>(&points, a);
            3.0 * (high.max(-low) + rounding) / width
        };
        (0..D).map(along).fold(0.0, f64::hypot)
    }
}

/// The least and the largest difference between neighbours along axis `a`.
pub(super) fn steps<const D: usize>(points: &Window, a: usize) -> [f64; 2] {
    let stride = 4_usize.pow((D - 1 - a) as u32);
    let first = (0..4_usize.pow(D as u32)).filter(|i| i / stride % 4 < 3);
    first
        .map(|i| points[i + stride] - points[i])
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], step| [low.min(step), high.max(step)])
}

/// `points` of phi on a box of these `extents`, less `slope` times normal . (x - the box's middle), and `constant`.
pub(super) fn tilted<const D: usize>(
    points: &Window,
    extents: &[f64; D],
    normal: &[f64; D],
    [slope, constant]: [f64; 2],
) -> Window {
    let mut out = *points;
    for (i, out) in out[..4_usize.pow(D as u32)].iter_mut().enumerate() {
        // Bezier points of a linear function are its values at thirds.
        let along = |a: usize| (i / 4_usize.pow((D - 1 - a) as u32) % 4) as f64 / 3.0 - 0.5;
        let ahead: f64 = (0..D).map(|a| normal[a] * extents[a] * along(a)).sum();
        *out -= slope * ahead + constant;
    }
    out
}

/// About the derivative of phi along `normal` on a box of these `extents`; 0 for a box without width.
pub(super) fn derivative<const D: usize>(points: &Window, extents: &[f64; D], normal: &[f64; D]) -> f64 {
    let n = 4_usize.pow(D as u32);
    let along = |a: usize| {
        let stride = 4_usize.pow((D - 1 - a) as u32);
        let ends = (0..n).filter(|i| (i / stride).is_multiple_of(4));
        let rise = ends.map(|i| points[i + 3 * stride] - points[i]).sum::<f64>();
        if extents[a] > 0.0 { normal[a] * rise / (extents[a] * (n / 4) as f64) } else { 0.0 }
    };
    (0..D).map(along).sum()
}

/// The largest of phi on the points x of a box with normal . (x - the box's middle) <= offset: by Lagrange's multiplier slope >= 0 it is at
/// most that of phi - slope normal . (x - middle) on all the box, and slope offset.
pub(super) fn highest_below<const D: usize>(
    points: &Window,
    extents: &[f64; D],
    normal: &[f64; D],
    offset: f64,
) -> f64 {
    let slope = derivative(points, extents, normal).max(0.0);
    hull::range::<D>(&tilted(points, extents, normal, [slope, 0.0])).1 + slope * offset
}
