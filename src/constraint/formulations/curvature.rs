//! Curvatures of a cloud's surface, by a local fit to its normals.
//!
//! In the tangent plane of point i, with coordinates t of the neighbours and m the part of their normals that lies in the plane, m = S t to
//! first order: S, symmetric, is the shape operator, of which the eigenvalues are the principal curvatures, positive where the solid is
//! convex. It is fitted by least squares to the nearest points that face the same way; on a sphere it is exact. Normals are known to first
//! order where heights over the plane are but to second, so that the fit is steadier than one of heights. The principal curvatures are cut
//! to 1 / the distance of the farthest neighbour: near sharp edges larger ones mean nothing.

use crate::Result;
use crate::error::try_with_capacity;
use crate::geometry::Cloud;
use crate::geometry::matrix::matrix;
use crate::geometry::neighbours::{Neighbour, Neighbours};
use crate::geometry::surfels::tangents;
use crate::geometry::vec::{dot, sub};
use crate::linalg::dense::solve_cholesky;

/// Points of the fit, the point itself among them.
const fn points<const D: usize>() -> usize {
    if D == 2 { 5 } else { MOST_POINTS }
}
const MOST_POINTS: usize = 13;

/// Neighbours so close to a line that the fit is not told by them: a pivot below this part of its diagonal entry.
const LEAST_PIVOT: f64 = 1e-6;

/// K, of which n . r + r . K r / 2 is the distance to the paraboloid; K n = 0.
pub(super) type Tensor<const D: usize> = [[f64; D]; D];

/// K of each point `[N]`; 0, a plane, where the neighbours do not tell.
pub(super) fn tensors<const D: usize>(cloud: &Cloud<D>, tree: &Neighbours<D>) -> Result<Vec<Tensor<D>>> {
    let mut tensors = try_with_capacity(cloud.len(), "the curvatures of the formulation")?;
    tensors.extend((0..cloud.len()).map(|i| tensor(cloud, tree, i)));
    Ok(tensors)
}

fn tensor<const D: usize>(cloud: &Cloud<D>, tree: &Neighbours<D>, i: usize) -> Tensor<D> {
    let (p, n) = (cloud.points()[i], cloud.normals()[i]);
    let axes = tangents(n);
    let mut nearest = [Neighbour { index: 0, distance_squared: 0.0 }; MOST_POINTS];
    let faces_along = |j: usize| dot(n, cloud.normals()[j]) > 0.0;
    let found = tree.nearest(p, faces_along, &mut nearest[..points::<D>()]);
    // In the plane there is no second axis: its coordinates are 0.
    let along = |v: [f64; D]| [0, 1].map(|a| if a < D - 1 { dot(v, axes[a]) } else { 0.0 });
    let (mut tt, mut tm) = ([[0.0; 2]; 2], [[0.0; 2]; 2]);
    for neighbour in &nearest[..found] {
        let j = neighbour.index as usize;
        let (t, m) = (along(sub(cloud.points()[j], p)), along(cloud.normals()[j]));
        for a in 0..2 {
            for b in 0..2 {
                tt[a][b] += t[a] * t[b];
                tm[a][b] += t[a] * m[b];
            }
        }
    }
    let farthest = nearest[..found].last().map_or(0.0, |n| n.distance_squared).sqrt();
    let Some(s) = shape_operator::<D>(&tt, &tm).filter(|_| farthest > 0.0) else { return [[0.0; D]; D] };
    let s = limited(s, 1.0 / farthest);
    let entry = |i: usize, j: usize| -> f64 {
        let pairs = (0..D - 1).flat_map(|a| (0..D - 1).map(move |b| (a, b)));
        pairs.map(|(a, b)| s[a][b] * axes[a][i] * axes[b][j]).sum()
    };
    matrix(entry)
}

/// The symmetric S of least sum |S t - m|^2, from sums of t t^T and t m^T.
fn shape_operator<const D: usize>(tt: &[[f64; 2]; 2], tm: &[[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
    if D == 2 {
        return (tt[0][0] > 0.0).then(|| [[tm[0][0] / tt[0][0], 0.0], [0.0, 0.0]]);
    }
    // Unknowns S_11, S_12, S_22; the rows are the derivatives by them.
    let matrix = [[tt[0][0], 0.0, 0.0], [tt[0][1], tt[0][0] + tt[1][1], 0.0], [0.0, tt[0][1], tt[1][1]]];
    let [a, b, c] = solve_cholesky(matrix, [tm[0][0], tm[1][0] + tm[0][1], tm[1][1]], LEAST_PIVOT)?;
    Some([[a, b], [b, c]])
}

/// S with its eigenvalues cut to `most`.
fn limited(s: [[f64; 2]; 2], most: f64) -> [[f64; 2]; 2] {
    let (mean, half) = (0.5 * (s[0][0] + s[1][1]), 0.5 * (s[0][0] - s[1][1]));
    let apart = half.hypot(s[0][1]);
    let [k1, k2] = [mean + apart, mean - apart].map(|k| k.clamp(-most, most));
    if apart == 0.0 {
        return [[k1, 0.0], [0.0, k1]];
    }
    // S = mean I + (half, s_12) turned twice by the angle of the first direction.
    let (mean, by) = (0.5 * (k1 + k2), 0.5 * (k1 - k2) / apart);
    [[mean + by * half, by * s[0][1]], [by * s[0][1], mean - by * half]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;
    use crate::geometry::vec::{norm, normalized};

    #[test]
    fn a_sphere_and_a_circle_have_their_curvature() {
        let mut random = SplitMix64::new(3);
        let mut n: Vec<[f64; 3]> = Vec::new();
        while n.len() < 300 {
            n.extend(normalized(std::array::from_fn(|_| random.between(-1.0, 1.0))));
        }
        let cloud = Cloud::new(n.iter().map(|n| n.map(|x| 2.0 * x)).collect(), n).unwrap();
        for (k, n) in tensors(&cloud, &Neighbours::new(cloud.points()).unwrap()).unwrap().iter().zip(cloud.normals()) {
            for (a, row) in k.iter().enumerate() {
                for (b, entry) in row.iter().enumerate() {
                    let exact = 0.5 * (f64::from(u8::from(a == b)) - n[a] * n[b]);
                    assert!((entry - exact).abs() < 1e-9, "{k:?} {n:?}");
                }
            }
        }
        let n: Vec<[f64; 2]> = (0..40).map(|i| [(0.157 * f64::from(i)).cos(), (0.157 * f64::from(i)).sin()]).collect();
        let cloud = Cloud::new(n.iter().map(|n| n.map(|x| -3.0 * x)).collect(), n).unwrap();
        for k in tensors(&cloud, &Neighbours::new(cloud.points()).unwrap()).unwrap() {
            assert!((k[0][0] + k[1][1] + 1.0 / 3.0).abs() < 1e-9, "{k:?}");
        }
    }

    #[test]
    fn an_edge_is_cut_and_a_line_is_flat() {
        // Normals that turn by a right angle over a tenth of the radius of the fit.
        let points: Vec<[f64; 2]> = (-5..=5).map(|i| [f64::from(i), 0.0]).collect();
        let normals = (-5..=5).map(|i| if i < 0 { [-0.9, 1.0] } else { [0.9, 1.0] }).collect();
        let cloud = Cloud::new(points, normals).unwrap();
        for k in tensors(&cloud, &Neighbours::new(cloud.points()).unwrap()).unwrap() {
            assert!((k[0][0].hypot(k[0][1])).hypot(k[1][1]) <= 0.5 + 1e-12, "{k:?}");
        }
        // The turned normals are all near: the fit's own curvature is 8.8.
        let x = [-0.2, -0.15, -0.12, -0.1, 0.0];
        let normals = x.map(|x| if x < 0.0 { [-0.9, 1.0] } else { [0.9, 1.0] }).to_vec();
        let cloud = Cloud::new(x.map(|x| [x, 0.0]).to_vec(), normals).unwrap();
        let k = tensors(&cloud, &Neighbours::new(cloud.points()).unwrap()).unwrap()[4];
        assert!((norm([norm(k[0]), norm(k[1])]) - 1.0 / 0.2).abs() < 1e-12 && k[0][0] > 0.0, "{k:?}");
        let line = (0..20).map(|i| [f64::from(i), 0.0, 0.0]).collect();
        let cloud = Cloud::new(line, vec![[0.0, 0.0, 1.0]; 20]).unwrap();
        let flat = tensors(&cloud, &Neighbours::new(cloud.points()).unwrap()).unwrap();
        assert!(flat.iter().all(|k| k.iter().all(|row| norm(*row) == 0.0)));
    }
}
