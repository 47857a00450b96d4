//! Which way each component faces: out of the solid.
//!
//! V = (1 / D) sum of A_i (p_i - c) . n_i, the divergence theorem with c the component's centre, is made positive: closed shapes face
//! outward, open ones to the side they bulge to. Where V is nothing beside its terms, on a plane, the largest coordinate of the sum of
//! A_i n_i is made positive.
//!
//! A component inside an odd number of others is then turned: the boundary of a cavity. Whether it is that, or a solid that floats in a
//! closed shell without thickness, no cloud tells.

use super::super::vec::{add, dot, norm, scale, sub};
use super::super::{Cloud, DistanceTree};
use super::graph::Graph;
use super::merge::Signs;
use super::planes::Plane;
use crate::Result;
use crate::error::{try_vec, try_with_capacity};

/// V counts from this fraction of the sum of its terms' lengths on: rounding is far below, a bulge of 1e-6 of the size above.
const CLEAR: f64 = 1e-6;

/// Points of a component at which it is asked how many others are around it.
const PROBES: usize = 64;

/// Sums over a component.
#[derive(Clone, Copy)]
struct Sums<const D: usize> {
    area: f64,
    /// Sum of A p; c once divided by the area.
    center: [f64; D],
    /// Sum of A (p - c) . n: D V.
    volume: f64,
    /// Sum of A |p - c|.
    reach: f64,
    /// Sum of A n.
    flux: [f64; D],
}

/// Signs the normals of `planes` by `signs`, each component outward. Points that `skip` names have no say: an outlier's area is large.
pub fn outward<const D: usize>(
    graph: &Graph<D>,
    planes: &[Plane<D>],
    skip: &[bool],
    signs: &Signs,
) -> Result<Vec<[f64; D]>> {
    let mut normals = try_with_capacity(graph.len(), "the normals")?;
    normals.extend(planes.iter().zip(&signs.sign).map(|(plane, sign)| scale(*sign, plane.normal)));
    let counted = |i: &usize| !skip[*i];
    let sums = sums(graph.points(), &normals, planes, signs, counted)?;
    let inward: Vec<bool> = sums.iter().map(is_inward).collect();
    turn(&mut normals, signs, &inward);
    if signs.n_components > 1 {
        let nested = nested(graph, &normals, signs, counted)?;
        turn(&mut normals, signs, &nested);
    }
    Ok(normals)
}

fn turn<const D: usize>(normals: &mut [[f64; D]], signs: &Signs, which: &[bool]) {
    for (normal, c) in normals.iter_mut().zip(&signs.component) {
        if which[*c as usize] {
            *normal = scale(-1.0, *normal);
        }
    }
}

fn sums<const D: usize>(
    points: &[[f64; D]],
    normals: &[[f64; D]],
    planes: &[Plane<D>],
    signs: &Signs,
    counted: impl Fn(&usize) -> bool,
) -> Result<Vec<Sums<D>>> {
    let nothing = Sums { area: 0.0, center: [0.0; D], volume: 0.0, reach: 0.0, flux: [0.0; D] };
    let mut sums = try_vec(signs.n_components, nothing, "the volumes of the components")?;
    for i in (0..points.len()).filter(&counted) {
        let s = &mut sums[signs.component[i] as usize];
        s.area += planes[i].area;
        s.center = add(s.center, scale(planes[i].area, points[i]));
    }
    for s in sums.iter_mut().filter(|s| s.area > 0.0) {
        s.center = scale(1.0 / s.area, s.center);
    }
    for i in (0..points.len()).filter(&counted) {
        let s = &mut sums[signs.component[i] as usize];
        let (r, a_n) = (sub(points[i], s.center), scale(planes[i].area, normals[i]));
        s.volume += dot(r, a_n);
        s.reach += norm(r) * planes[i].area;
        s.flux = add(s.flux, a_n);
    }
    Ok(sums)
}

fn is_inward<const D: usize>(s: &Sums<D>) -> bool {
    if s.volume.abs() > CLEAR * s.reach {
        return s.volume < 0.0;
    }
    let largest = (0..D).fold(0, |most, a| if s.flux[a].abs() > s.flux[most].abs() { a } else { most });
    s.flux[largest] < 0.0
}

/// Which components lie inside an odd number of others; `normals` face outward.
fn nested<const D: usize>(
    graph: &Graph<D>,
    normals: &[[f64; D]],
    signs: &Signs,
    counted: impl Fn(&usize) -> bool,
) -> Result<Vec<bool>> {
    let mut points = try_with_capacity(graph.len(), "the points of the surfels")?;
    points.extend_from_slice(graph.points());
    let mut directions = try_with_capacity(graph.len(), "the normals of the surfels")?;
    directions.extend_from_slice(normals);
    let surfels = Cloud::new(points, directions)?.surfels(graph.tree())?;
    let sides = DistanceTree::of_surfels(&surfels)?;
    let mut left = try_vec(signs.n_components, 0usize, "the sizes of the components")?;
    (0..graph.len()).filter(&counted).for_each(|i| left[signs.component[i] as usize] += 1);
    let every: Vec<usize> = left.iter().map(|n| n.div_ceil(PROBES).max(1)).collect();
    let mut sums = try_vec(signs.n_components, (0.0, 0.0), "the winding numbers of the components")?;
    for i in (0..graph.len()).filter(&counted) {
        let c = signs.component[i] as usize;
        left[c] -= 1;
        if left[c].is_multiple_of(every[c]) {
            let step = scale(graph.spacing(i), normals[i]);
            let [before, behind] = [add(graph.points()[i], step), sub(graph.points()[i], step)];
            let w = 0.5 * (sides.winding_number(before) + sides.winding_number(behind));
            sums[c] = (sums[c].0 + w, sums[c].1 + 1.0);
        }
    }
    // On a closed surface its own share is 1/2, on a plane 0, and 1 for each around it.
    let inside_of = |(sum, n): &(f64, f64)| if *n > 0.0 { (sum / n + 0.25).floor() } else { 0.0 };
    Ok(sums.iter().map(|s| inside_of(s).rem_euclid(2.0) == 1.0).collect())
}
