//! The cases of a cube: the facets that separate its corners of one sign from those of the other.
//!
//! A cube is cut into D! simplices (Kuhn 1960, Freudenthal 1942): for each order of the axes, the chain of corners that takes one step
//! along each axis in that order. Neighbouring cubes cut their common face alike, so that the linear interpolant of the corners' values
//! is one continuous function, and where no value is 0 its zero set is a manifold (Allgower and Gnutzmann 1987). In a simplex with p + 1
//! negative and q + 1 positive vertices, p + q = D - 1, that set is a product of two simplices, with a vertex on each edge between the
//! signs; it is cut into facets along its staircase paths, one facet a path. One code path serves every D.

use crate::geometry::facet;
use crate::geometry::vec::{dot, sub};

/// An edge of the subdivision inside a cube.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct CubeEdge {
    /// The corner where it begins; bit a is set where the corner is the upper one along axis a.
    pub from: usize,
    /// The axes along which it runs, as bits: not 0.
    pub axes: usize,
}

/// For each set of negative corners (bit c set where corner c is negative) the facets that separate them from the others, as the edges
/// on which their vertices lie, each with its normal to the positive side.
pub(super) type Cases<const D: usize> = Vec<Vec<[CubeEdge; D]>>;

/// All cases of a cube.
pub(super) fn cases<const D: usize>() -> Cases<D> {
    let simplices = simplices(D);
    let facets_of = |negative: usize| {
        let mut facets = Vec::new();
        for simplex in &simplices {
            let (below, above) = simplex.iter().partition(|&&corner| negative >> corner & 1 == 1);
            separate(below, above, &mut facets);
        }
        facets
    };
    (0..1_usize << (1 << D)).map(facets_of).collect()
}

/// The simplices of a cube, as chains of corners.
fn simplices(d: usize) -> Vec<Vec<usize>> {
    let mut chains = vec![vec![0]];
    for _ in 0..d {
        let longer = |chain: &Vec<usize>| {
            let chain = chain.clone();
            let last = chain[chain.len() - 1];
            let free = (0..d).filter(move |a| last >> a & 1 == 0);
            free.map(move |a| [&chain[..], &[last | 1 << a]].concat()).collect::<Vec<_>>()
        };
        chains = chains.iter().flat_map(longer).collect();
    }
    chains
}

/// Appends the facets between the corners `below` and `above` of a simplex.
fn separate<const D: usize>(below: Vec<usize>, above: Vec<usize>, facets: &mut Vec<[CubeEdge; D]>) {
    if below.is_empty() || above.is_empty() {
        return;
    }
    // A path from (0, 0) to (p, q); bit s of `path` tells whether step s advances p.
    for path in (0..1_usize << (D - 1)).filter(|path| path.count_ones() as usize == below.len() - 1) {
        let mut pairs = [(0, 0); D];
        let (mut i, mut j) = (0, 0);
        for (s, pair) in pairs.iter_mut().enumerate() {
            *pair = (below[i], above[j]);
            if path >> s & 1 == 1 { i += 1 } else { j += 1 }
        }
        let upward = sub(middle::<D>(&above), middle::<D>(&below));
        if dot(facet::normal(&pairs.map(|(b, a)| middle::<D>(&[b, a]))), upward) < 0.0 {
            pairs.swap(D - 2, D - 1);
        }
        // Corners of a simplex are a chain: one of the two holds the other's bits.
        facets.push(pairs.map(|(b, a)| CubeEdge { from: b & a, axes: b ^ a }));
    }
}

/// The mean of some corners of the unit cube.
fn middle<const D: usize>(corners: &[usize]) -> [f64; D] {
    std::array::from_fn(|a| corners.iter().map(|c| (c >> a & 1) as f64).sum::<f64>() / corners.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_simplices_fill_the_cube() {
        for (d, n) in [(2, 2), (3, 6), (4, 24)] {
            let simplices = simplices(d);
            assert_eq!(simplices.len(), n);
            assert!(simplices.iter().all(|s| s.len() == d + 1 && s[d] == (1 << d) - 1));
        }
    }

    #[test]
    fn facets_cross_edges_between_signs() {
        let cases = cases::<3>();
        assert!(cases[0].is_empty() && cases[255].is_empty());
        for (negative, facets) in cases.iter().enumerate() {
            assert!(facets.len() <= 12);
            for edge in facets.iter().flatten() {
                let (a, b) = (edge.from, edge.from | edge.axes);
                assert!(negative >> a & 1 != negative >> b & 1 && edge.axes & edge.from == 0 && edge.axes != 0);
            }
        }
        assert_eq!(super::cases::<2>().iter().map(Vec::len).max(), Some(2));
    }

    #[test]
    fn the_cases_turn_over_with_the_signs() {
        // The same area vector, negated: what one case counts as outward is inward to its complement.
        let area = |facets: &Vec<[CubeEdge; 3]>| {
            facets.iter().fold([0.0; 3], |sum, facet| {
                let n = facet::normal(&facet.map(|e| middle::<3>(&[e.from, e.from | e.axes])));
                std::array::from_fn(|a| sum[a] + n[a])
            })
        };
        let cases = cases::<3>();
        for negative in 0..256 {
            let (one, other) = (area(&cases[negative]), area(&cases[255 - negative]));
            assert!((0..3).all(|a| (one[a] + other[a]).abs() < 1e-14));
        }
    }
}
