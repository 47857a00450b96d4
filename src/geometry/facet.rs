//! One facet, a triangle of space or a segment of the plane, and one point: normal, closest point, solid angle.

use super::vec::{cross, dot, scale, sub};
use super::{segment, triangle};
use std::f64::consts::PI;

/// The closest point of a facet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Closest<const D: usize> {
    pub distance_squared: f64,
    /// Not negative, of sum 1.
    pub barycentric: [f64; D],
}

/// Solid angle of all directions: the length of the unit circle, the area of the unit sphere.
pub(super) const fn all_directions<const D: usize>() -> f64 {
    if D == 2 { 2.0 * PI } else { 4.0 * PI }
}

/// The unit normal times the length of a segment, or twice the area of a triangle. A segment's lies to its right: out of a solid on its
/// left.
#[inline]
pub(crate) fn normal<const D: usize>(corners: &[[f64; D]; D]) -> [f64; D] {
    let along = sub(corners[1], corners[0]);
    match D {
        2 => cut([along[1], -along[0], 0.0]),
        _ => cut(cross(cut(along), cut(sub(corners[2], corners[0])))),
    }
}

/// Length of a segment, area of a triangle.
pub(super) fn area<const D: usize>(corners: &[[f64; D]; D]) -> f64 {
    let n = normal(corners);
    dot(n, n).sqrt() / (D - 1) as f64
}

/// The point at barycentric coordinates `b`.
#[inline]
pub(super) fn point<const D: usize>(corners: &[[f64; D]; D], b: [f64; D]) -> [f64; D] {
    (1..D).fold(scale(b[0], corners[0]), |p, k| super::vec::add(p, scale(b[k], corners[k])))
}

/// The point closest to `p`.
#[inline]
pub(super) fn closest<const D: usize>(p: [f64; D], corners: &[[f64; D]; D]) -> Closest<D> {
    match D {
        2 => {
            let found = segment::closest(cut(p), &cut_all(corners));
            Closest { distance_squared: found.distance_squared, barycentric: cut(found.barycentric) }
        }
        _ => {
            let found = triangle::closest(cut(p), &cut_all(corners));
            Closest { distance_squared: found.distance_squared, barycentric: cut(found.barycentric) }
        }
    }
}

/// The solid angle seen from `p`, positive from behind.
#[inline]
pub(super) fn solid_angle<const D: usize>(p: [f64; D], corners: &[[f64; D]; D]) -> f64 {
    match D {
        2 => segment::solid_angle(cut(p), &cut_all(corners)),
        _ => triangle::solid_angle(cut(p), &cut_all(corners)),
    }
}

/// Cosine and sine of 2 pi w, times a common factor; w is the facet's winding number around `p`, the solid angle by that of all directions.
#[inline]
pub(super) fn turn<const D: usize>(p: [f64; D], corners: &[[f64; D]; D]) -> [f64; 2] {
    match D {
        2 => segment::angle(cut(p), &cut_all(corners)),
        _ => triangle::half_angle(cut(p), &cut_all(corners)),
    }
}

/// The first N coordinates; zeros where there are fewer. What D is told by `match` alone, this tells the compiler.
#[inline]
pub(super) fn cut<const M: usize, const N: usize>(a: [f64; M]) -> [f64; N] {
    std::array::from_fn(|k| if k < M { a[k] } else { 0.0 })
}

#[inline]
fn cut_all<const M: usize, const N: usize>(corners: &[[f64; M]; M]) -> [[f64; N]; N] {
    std::array::from_fn(|i| if i < M { cut(corners[i]) } else { [0.0; N] })
}
