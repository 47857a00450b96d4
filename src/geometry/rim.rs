//! The rim of an open mesh, and facets that close the mesh there.
//!
//! Facets from each edge of the rim to one point close the mesh. The winding number of a closed mesh is an integer, so that of the open one
//! is known modulo 1 from the closing facets alone: exactly, from as many of them as the rim has edges. A rough sum over the mesh
//! tells the integer.

use super::Mesh;
use super::edges::{Edges, Side};
use super::facet::turn;
use crate::Result;
use crate::error::{try_vec, try_with_capacity};
use std::f64::consts::PI;

/// Facets that close a mesh, as many times as is needed.
#[derive(Debug)]
pub(super) struct Closing<const D: usize>(Vec<[[f64; D]; D]>);

impl<const D: usize> Closing<D> {
    /// Facets that close `mesh`, none where it is closed; `None` where they are no fewer than its own.
    pub fn of(mesh: &Mesh<D>) -> Result<Option<Self>> {
        let n = mesh.vertices().len();
        let mut edges = Edges::of(mesh.facets(), n)?;
        if edges.iter().any(|sides| times(sides) != 0) {
            // Facets may touch without sharing vertices.
            let first = first_equal(mesh.vertices())?;
            let mut facets = try_with_capacity(mesh.facets().len(), "the facets that close the mesh")?;
            facets.extend(mesh.facets().iter().map(|f| f.map(|v| first[v as usize])));
            drop(edges);
            edges = Edges::of(&facets, n)?;
        }
        let rim = || edges.iter().map(|sides| (sides[0].edge, times(sides)));
        let n_closing = rim().map(|(_, times)| times.unsigned_abs()).sum::<u64>() as usize;
        if n_closing >= mesh.facets().len() {
            return Ok(None);
        }
        // Beside the middle, lest the closing facets of flat and of symmetric meshes lie where points are asked for.
        let bounds = mesh.bounds();
        let widest = bounds.extents().into_iter().fold(0.0, f64::max);
        let apex = std::array::from_fn(|a| bounds.center()[a] + [0.37, 0.71, 0.53][a] * widest);
        let mut closing = try_with_capacity(n_closing, "the facets that close the mesh")?;
        for ([low, high], times) in rim() {
            // Against the mesh's own way along the edge; in the plane, to where a segment starts.
            let [low, high] = [low, high].map(|v| mesh.vertices()[v as usize]);
            let corners = if D == 2 { [apex, low, apex] } else { [high, low, apex] };
            let mut corners: [_; D] = std::array::from_fn(|k| corners[k]);
            if times < 0 {
                corners.swap(0, 1);
            }
            closing.extend((0..times.unsigned_abs()).map(|_| corners));
        }
        Ok(Some(Closing(closing)))
    }

    /// How many facets there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// The winding number around `q`, from -1/2 to 1/2, modulo 1: by a product of complex numbers, since angles take longer.
    pub fn fraction(&self, q: [f64; D]) -> f64 {
        let [x, y] = self.0.iter().fold([1.0, 0.0], |[x, y]: [f64; 2], corners| {
            let [a, b] = turn(q, corners);
            let length = (a * a + b * b).sqrt();
            // Seen from its own edge or corner, a facet has no angle.
            let [a, b] = if length == 0.0 { [1.0, 0.0] } else { [a / length, b / length] };
            [x * a - y * b, x * b + y * a]
        });
        y.atan2(x) / (2.0 * PI)
    }
}

/// How many more sides run forward along their edge than backward.
fn times<const D: usize>(sides: &[Side<D>]) -> i64 {
    sides.iter().map(|side| if side.forward { 1 } else { -1 }).sum()
}

/// For each vertex the first in an order by place that lies where it does.
fn first_equal<const D: usize>(vertices: &[[f64; D]]) -> Result<Vec<u32>> {
    // -0.0 + 0.0 is 0.0: the two zeros are one place.
    let place = |&v: &u32| vertices[v as usize].map(|x| (x + 0.0).to_bits());
    let mut order = try_with_capacity(vertices.len(), "the order of the vertices")?;
    order.extend(0..vertices.len() as u32);
    order.sort_unstable_by_key(place);
    let mut first = try_vec(vertices.len(), 0, "the order of the vertices")?;
    for equal in order.chunk_by(|a, b| place(a) == place(b)) {
        equal.iter().for_each(|&v| first[v as usize] = equal[0]);
    }
    Ok(first)
}
