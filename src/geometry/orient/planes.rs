//! The plane of each point: the least-squares plane of its neighbourhood (Hoppe et al. 1992, section 3.2).
//!
//! C = (1 / m) sum over the neighbourhood of (x - mean)(x - mean)^T, the point itself included; n is the eigenvector of its smallest
//! eigenvalue, up to sign.

use super::super::neighbours::Neighbour;
use super::super::vec::{add, dot, scale, sub};
use super::eigen::eigen;
use super::graph::Graph;
use crate::Result;
use crate::error::try_vec;
use crate::par::Workers;

/// A neighbourhood in space is a line where its second variance is at most this fraction of the largest: a band 1e-5 times as wide as long.
const FLATTEST: f64 = 1e-10;

/// Neighbours that a line-like neighbourhood is widened to at most: rows of a scan that lie far apart.
const MOST_NEIGHBOURS: usize = 96;

/// A plane through a neighbourhood.
#[derive(Debug, Clone, Copy)]
pub struct Plane<const D: usize> {
    /// Unit normal.
    pub normal: [f64; D],
    /// Length (D = 2) or area (D = 3) that the point stands for, from the spread in the plane.
    pub area: f64,
    /// Whether the neighbourhood is a line or a point, so that the normal is one of many.
    pub degenerate: bool,
}

/// The planes of all points of `graph`. Where `facing` is given, a neighbourhood holds those neighbours alone whose normals there lie
/// within a right angle of the point's: not the other side of a thin sheet.
pub fn planes<const D: usize>(
    graph: &Graph<D>,
    facing: Option<&[[f64; D]]>,
    workers: &Workers,
) -> Result<Vec<Plane<D>>> {
    const CHUNK: usize = 1024;
    let nothing = Plane { normal: [0.0; D], area: 0.0, degenerate: true };
    let mut planes = try_vec(graph.len(), nothing, "the planes of the points")?;
    workers.for_each(planes.chunks_mut(CHUNK).enumerate(), |(chunk, planes)| {
        for (place, plane) in planes.iter_mut().enumerate() {
            let i = chunk * CHUNK + place;
            let alike = |j: usize| facing.is_none_or(|n| dot(n[i], n[j]) > 0.0);
            *plane = plane_of(graph.points(), i, graph.neighbours(i), alike);
            if plane.degenerate {
                *plane = widened(graph, i, *plane);
            }
        }
    });
    Ok(planes)
}

/// The plane of a wider neighbourhood of point `i`, the smallest that is no line; `narrow` where there is none.
fn widened<const D: usize>(graph: &Graph<D>, i: usize, narrow: Plane<D>) -> Plane<D> {
    let mut nearest = [Neighbour { index: 0, distance_squared: 0.0 }; MOST_NEIGHBOURS];
    let mut k = 2 * graph.k();
    while k <= MOST_NEIGHBOURS.min(graph.len() - 1) {
        let found = graph.tree().nearest(graph.points()[i], |j| j != i, &mut nearest[..k]);
        let plane = plane_of(graph.points(), i, &nearest[..found], |_| true);
        if !plane.degenerate {
            return plane;
        }
        k *= 2;
    }
    narrow
}

fn plane_of<const D: usize>(
    points: &[[f64; D]],
    i: usize,
    neighbours: &[Neighbour],
    alike: impl Fn(usize) -> bool,
) -> Plane<D> {
    // From the point itself, so that no digit is lost far from the origin.
    let offsets = || {
        let taken = neighbours.iter().map(|n| n.index as usize).filter(|&j| alike(j));
        taken.map(|j| sub(points[j], points[i])).chain([[0.0; D]])
    };
    let m = offsets().count() as f64;
    let mean = scale(1.0 / m, offsets().fold([0.0; D], add));
    let mut c = [[0.0; D]; D];
    for r in offsets().map(|r| sub(r, mean)) {
        for a in 0..D {
            c[a] = add(c[a], scale(r[a] / m, r));
        }
    }
    let (variances, directions) = eigen(c);
    let largest = variances[D - 1];
    let degenerate = !(largest > 0.0 && variances[1] > FLATTEST * largest);
    Plane { normal: directions[0], area: area_of(&variances, m), degenerate }
}

/// What a point stands for: see [`surfels`](super::super::surfels).
fn area_of<const D: usize>(variances: &[f64; D], m: f64) -> f64 {
    if D == 2 {
        return (12.0 * variances[1] / (m * m - 1.0).max(1.0)).sqrt();
    }
    4.0 * std::f64::consts::PI * (variances[1] * variances[D - 1]).max(0.0).sqrt() / m
}
