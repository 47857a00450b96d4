//! A mesh: vertices and vertex indices, checked once. Triangles in space, segments in the plane.

use super::vec::{is_finite, text};
use super::{Bounds, DistanceTree, facet};
use crate::{Error, Result};
use std::sync::{Arc, OnceLock};

/// A surface in space made of triangles, or a curve in the plane made of segments: facets with D corners, open or closed. Every
/// coordinate is finite and every index in range; nothing else is promised: [`Mesh::report`] tells the rest.
#[derive(Debug, Clone)]
pub struct Mesh<const D: usize = 3> {
    vertices: Vec<[f64; D]>,
    facets: Vec<[u32; D]>,
    /// Made when first asked for; clones share it.
    distance_tree: OnceLock<Arc<DistanceTree<D>>>,
}

impl<const D: usize> Mesh<D> {
    /// What a facet is called.
    pub(crate) const FACET: &str = if D == 2 { "segment" } else { "triangle" };

    /// A mesh of `vertices` [V x D] and `facets` [F x D], indices from 0: triangles counter-clockwise seen from outside, segments with
    /// the solid on their left.
    pub fn new(vertices: Vec<[f64; D]>, facets: Vec<[u32; D]>) -> Result<Self> {
        const { assert!(D == 2 || D == 3, "meshes are of the plane or of space") };
        let name = Self::FACET;
        Self::check_count(facets.len())?;
        if let Some((i, v)) = vertices.iter().enumerate().find(|(_, v)| !is_finite(&v[..])) {
            return Err(Error::InvalidArgument(format!("vertex {i} is {}; coordinates must be finite", text(v))));
        }
        let n = vertices.len();
        if let Some((i, f)) = facets.iter().enumerate().find(|(_, f)| f.iter().any(|&v| v as usize >= n)) {
            let f = f.map(f64::from);
            return Err(Error::InvalidArgument(format!(
                "{name} {i} is {}, but the mesh has {n} vertices, counted from 0",
                text(&f)
            )));
        }
        Ok(Mesh { vertices, facets, distance_tree: OnceLock::new() })
    }

    /// Refuses to have no facets, or too many.
    pub(crate) fn check_count(n: usize) -> Result<()> {
        // Trees over the facets count up to twice as many nodes in 32 bits.
        const MOST: usize = (1 << 31) - 1;
        let name = Self::FACET;
        match n {
            0 => Err(Error::InvalidArgument(format!("the mesh has no {name}s; at least 1 is needed"))),
            1..=MOST => Ok(()),
            _ => Err(Error::InvalidArgument(format!("the mesh has {n} {name}s; at most {MOST} are taken"))),
        }
    }

    /// Vertices [V x D].
    pub fn vertices(&self) -> &[[f64; D]] {
        &self.vertices
    }

    /// Vertex indices of the facets [F x D].
    pub fn facets(&self) -> &[[u32; D]] {
        &self.facets
    }

    /// The corners of facet `f`.
    pub fn corners(&self, f: usize) -> [[f64; D]; D] {
        self.facets[f].map(|v| self.vertices[v as usize])
    }

    /// The unit normal of facet `f` times its length (D = 2) or twice its area (D = 3).
    pub fn area_normal(&self, f: usize) -> [f64; D] {
        facet::normal(&self.corners(f))
    }

    /// The box around the vertices that facets use.
    pub fn bounds(&self) -> Bounds<D> {
        Bounds::of(self.facets.iter().flatten().map(|&v| &self.vertices[v as usize]))
    }

    /// The tree that answers distances to this mesh, built by the first call.
    pub fn distance_tree(&self) -> Result<&DistanceTree<D>> {
        if let Some(tree) = self.distance_tree.get() {
            return Ok(tree);
        }
        // Two threads may both build; they build the same, and one is kept.
        let tree = Arc::new(DistanceTree::new(self)?);
        Ok(self.distance_tree.get_or_init(|| tree))
    }

    /// Turns every facet over, so that an inside-out solid becomes a solid.
    pub fn flip(&mut self) {
        for f in &mut self.facets {
            f.swap(D - 2, D - 1);
        }
        self.distance_tree = OnceLock::new();
    }
}

impl Mesh<3> {
    /// Vertex indices of the triangles [T x 3].
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.facets
    }
}

impl Mesh<2> {
    /// Vertex indices of the segments [S x 2].
    pub fn segments(&self) -> &[[u32; 2]] {
        &self.facets
    }
}
