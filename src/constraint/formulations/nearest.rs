//! Distances to the nearest points: Criado Risco et al. 2023 and Bergeles et al. 2015, as paper 000 tells of them (sections 1, 2.1, 2.2.3).
//!
//! Criado Risco et al. take the edge nearest to x and its normal: n . (x - p). Here p is the nearest point of the cloud. Bergeles et al. take
//! a potential of the distances to the k nearest points; here it is their mean, with the sign of the side of the nearest one's plane. Both
//! jump, value and gradient, where the nearest points become others; the second also where x crosses the surface between points, as its size
//! is 0 at the points alone.

use crate::geometry::Cloud;
use crate::geometry::neighbours::Neighbour;
use crate::geometry::vec::{add, dot, norm, scale, sub};

/// Distance to the plane at the nearest point, and its gradient.
pub(super) fn plane<const D: usize>(cloud: &Cloud<D>, x: [f64; D], nearest: &Neighbour) -> (f64, [f64; D]) {
    let i = nearest.index as usize;
    let n = cloud.normals()[i];
    (dot(n, sub(x, cloud.points()[i])), n)
}

/// Mean distance to the `nearest` points, and its gradient; at a point the part of that point in the gradient is 0.
pub(super) fn points<const D: usize>(cloud: &Cloud<D>, x: [f64; D], nearest: &[Neighbour]) -> (f64, [f64; D]) {
    let side = if plane(cloud, x, &nearest[0]).0 < 0.0 { -1.0 } else { 1.0 };
    let per_point = side / nearest.len() as f64;
    let (mut sum, mut gradient) = (0.0, [0.0; D]);
    for neighbour in nearest {
        let r = sub(x, cloud.points()[neighbour.index as usize]);
        let delta = norm(r);
        sum += delta;
        if delta > 0.0 {
            gradient = add(gradient, scale(per_point / delta, r));
        }
    }
    (per_point * sum, gradient)
}
