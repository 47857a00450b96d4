//! Facets: the case of each cube through which the level set goes, written in numbers of crossed edges.

use super::crossings::Crossings;
use super::cubes::Cubes;
use super::kuhn::{CubeEdge, cases};
use crate::Result;
use crate::error::try_vec;
use crate::par::Workers;

/// The facets [F x D] of the level set of `f` in the order of the cubes, with normals to the side where `sign` times f grows.
pub(super) fn facets<const D: usize>(
    cubes: &Cubes<D>,
    f: &[f64],
    crossings: &Crossings,
    sign: f64,
    workers: &Workers,
) -> Result<Vec<[u32; D]>> {
    let cases = cases::<D>();
    let n_layers = cubes.shape[0] - 1;
    let counts = workers.map(n_layers, |layer| {
        let mut count = 0;
        each_active_cube(cubes, f, layer, |_, negative| count += cases[negative].len());
        count
    });
    let mut facets = try_vec(counts.iter().sum(), [0; D], "the facets of the level set")?;
    let mut items = Vec::with_capacity(n_layers);
    let mut rest = &mut facets[..];
    for (layer, &count) in counts.iter().enumerate() {
        let (mine, behind) = rest.split_at_mut(count);
        items.push((layer, mine));
        rest = behind;
    }
    let offsets: Vec<usize> = (0..1 << D).map(|corner| cubes.offset(corner)).collect();
    workers.for_each(items, |(layer, facets)| {
        let mut slots = facets.iter_mut();
        each_active_cube(cubes, f, layer, |cube, negative| {
            for (case, facet) in cases[negative].iter().zip(&mut slots) {
                *facet = case.map(|CubeEdge { from, axes }| crossings.number(cube + offsets[from], axes));
                if sign < 0.0 {
                    facet.swap(D - 2, D - 1);
                }
            }
        });
    });
    Ok(facets)
}

/// Calls `visit(cube, negative corners)` for each cube of a layer across the first axis whose corners are of both signs.
fn each_active_cube<const D: usize>(cubes: &Cubes<D>, f: &[f64], layer: usize, mut visit: impl FnMut(usize, usize)) {
    let offsets: Vec<usize> = (0..1 << D).map(|corner| cubes.offset(corner)).collect();
    let all = (1_usize << (1 << D)) - 1;
    let plane = cubes.strides[0];
    for cube in layer * plane..(layer + 1) * plane {
        let at = cubes.coordinates(cube);
        if (1..D).any(|a| at[a] == cubes.shape[a] - 1) {
            continue;
        }
        let negative = offsets.iter().enumerate().fold(0, |bits, (c, o)| bits | usize::from(f[cube + o] < 0.0) << c);
        if negative != 0 && negative != all {
            visit(cube, negative);
        }
    }
}
