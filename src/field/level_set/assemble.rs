//! Facets: the case of each cube through which the level set goes, written in numbers of crossed edges.

use super::crossings::Crossings;
use super::kuhn::{CubeEdge, cases};
use super::near::Near;
use crate::Result;
use crate::error::{try_vec, try_with_capacity};
use crate::par::Workers;

/// The facets [F x D] of the level set of `f` in the order of the cubes, with normals to the side where `sign` times f grows.
pub(super) fn facets<const D: usize>(
    near: &Near<D>,
    f: &[f64],
    crossings: &Crossings,
    sign: f64,
    workers: &Workers,
) -> Result<Vec<[u32; D]>> {
    let cases = cases::<D>();
    let n_layers = near.counts()[0];
    let mut counts = try_vec(n_layers, 0, "the layers of the lattice")?;
    workers.for_each(counts.iter_mut().enumerate(), |(layer, count)| {
        near.each_mixed_cube(f, layer, |cube| *count += cases[cube.negative].len());
    });
    let mut facets = try_vec(counts.iter().sum(), [0; D], "the facets of the level set")?;
    let mut items = try_with_capacity(n_layers, "the layers of the lattice")?;
    let mut rest = &mut facets[..];
    for (layer, &count) in counts.iter().enumerate() {
        let (mine, behind) = rest.split_at_mut(count);
        items.push((layer, mine));
        rest = behind;
    }
    workers.for_each(items, |(layer, facets)| {
        let mut slots = facets.iter_mut();
        near.each_mixed_cube(f, layer, |cube| {
            for (case, facet) in cases[cube.negative].iter().zip(&mut slots) {
                *facet = case.map(|CubeEdge { from, axes }| crossings.number(cube.place(from), axes));
                if sign < 0.0 {
                    facet.swap(D - 2, D - 1);
                }
            }
        });
    });
    Ok(facets)
}
