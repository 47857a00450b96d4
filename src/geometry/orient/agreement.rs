//! What two neighbours ask of each other's signs.
//!
//! ```text
//! a_ij = n_i . n_j - c (n_i . u) (n_j . u),   u = (p_j - p_i) / |p_j - p_i|, kept to [-1, 1]
//! ```
//!
//! Positive, the planes' normals point to the same side as they stand; negative, one must turn. c = 0 is Hoppe's criterion, which takes the
//! sides of a right-angled edge for unrelated. c = 2 is the product of n_i with n_j reflected through the plane between the points (Koenig
//! and Gumhold 2009): 1 for any two points of one circle. It takes two parallel planes for the sides of a sheet where u leaves them by
//! more than 45 degrees; a larger c where it leaves them by less, 39 for 2.5, so that thinner sheets have two sides, but so has noise:
//! see the table in [`super`].

use super::super::vec::{dot, normalized, sub};
use super::graph::Graph;
use super::merge::Link;
use crate::Result;
use crate::error::{try_vec, try_with_capacity};

/// c
const CROSSING: f64 = 2.5;

/// a_ij for the points `p` with normals `n`, of two neighbours.
fn agreement<const D: usize>(p: [[f64; D]; 2], n: [[f64; D]; 2]) -> f64 {
    // Of places whose difference is nothing no direction is known.
    let u = normalized(sub(p[1], p[0])).unwrap_or([0.0; D]);
    (dot(n[0], n[1]) - CROSSING * dot(n[0], u) * dot(n[1], u)).clamp(-1.0, 1.0)
}

/// A link for each pair of neighbours of `graph`, whose normals are `normals`.
pub fn links<const D: usize>(graph: &Graph<D>, normals: &[[f64; D]]) -> Result<Vec<Link>> {
    let pairs = graph.pairs();
    let mut links = try_with_capacity(pairs.clone().count(), "the edges of the graph")?;
    links.extend(pairs.map(|[i, j]| {
        let at = |of: &[[f64; D]]| [of[i as usize], of[j as usize]];
        Link { clusters: [i, j], sum: agreement(at(graph.points()), at(normals)) }
    }));
    Ok(links)
}

/// How far normals meet what their neighbours ask for.
pub struct Consent {
    /// Sum of a_ij over the neighbours of each point.
    pub of_point: Vec<f64>,
    /// Sum of the positive a_ij, as a fraction of that of all |a_ij|; 1 where these are all 0.
    pub overall: f64,
}

/// The consent of `normals`, signs included.
pub fn consent<const D: usize>(graph: &Graph<D>, normals: &[[f64; D]]) -> Result<Consent> {
    let mut of_point = try_vec(graph.len(), 0.0, "the agreement of the points")?;
    let (mut met, mut all) = (0.0, 0.0);
    for [i, j] in graph.pairs() {
        let (i, j) = (i as usize, j as usize);
        let a = agreement([graph.points()[i], graph.points()[j]], [normals[i], normals[j]]);
        of_point[i] += a;
        of_point[j] += a;
        met += a.max(0.0);
        all += a.abs();
    }
    Ok(Consent { of_point, overall: if all > 0.0 { met / all } else { 1.0 } })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_of_an_edge_agree_and_sides_of_a_sheet_face_apart() {
        let s = 0.5f64.sqrt();
        // Beside a right-angled edge, convex and concave.
        for turn in [1.0, -1.0] {
            assert!(agreement([[-1.0, 0.0], [0.0, -turn]], [[0.0, 1.0], [turn, 0.0]]) > 0.99);
        }
        // Two points of a circle.
        assert!(agreement([[1.0, 0.0], [s, s]], [[1.0, 0.0], [s, s]]) > 0.99);
        // Two sides of a sheet, across and a little aslant.
        assert_eq!(agreement([[0.0, 0.0, 1.0], [0.0; 3]], [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]), 1.0);
        assert!(agreement([[0.5, 0.0, 1.0], [0.0; 3]], [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]) > 0.99);
        // One plane.
        assert_eq!(agreement([[3.0, 0.0, 0.0], [0.0; 3]], [[0.0, 0.0, 1.0]; 2]), 1.0);
    }
}
