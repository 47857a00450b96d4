//! A triangle mesh: vertices and vertex indices, checked once.

use super::vec3::{Vec3, cross, sub};
use super::{Bounds, DistanceTree};
use crate::{Error, Result};
use std::sync::{Arc, OnceLock};

/// A triangulated surface, open or closed. Every coordinate is finite and every index in range; nothing else is promised:
/// [`Mesh::report`] tells the rest.
#[derive(Debug, Clone)]
pub struct Mesh {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Made when first asked for; clones share it.
    distance_tree: OnceLock<Arc<DistanceTree>>,
}

impl Mesh {
    /// A mesh of `vertices` [V x 3] and `triangles` [T x 3], counter-clockwise seen from outside, indices from 0.
    pub fn new(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self> {
        if triangles.is_empty() {
            return Err(Error::InvalidArgument("the mesh has no triangles; at least 1 is needed".into()));
        }
        // Trees over the triangles count up to twice as many nodes in 32 bits.
        const MOST: usize = (1 << 31) - 1;
        if triangles.len() > MOST {
            let n = triangles.len();
            return Err(Error::InvalidArgument(format!("the mesh has {n} triangles; at most {MOST} are taken")));
        }
        if let Some((i, v)) = vertices.iter().enumerate().find(|(_, v)| !v.iter().all(|x| x.is_finite())) {
            return Err(Error::InvalidArgument(format!(
                "vertex {i} is ({}, {}, {}); coordinates must be finite",
                v[0], v[1], v[2]
            )));
        }
        let n = vertices.len();
        if let Some((i, t)) = triangles.iter().enumerate().find(|(_, t)| t.iter().any(|&v| v as usize >= n)) {
            return Err(Error::InvalidArgument(format!(
                "triangle {i} is ({}, {}, {}), but the mesh has {n} vertices, counted from 0",
                t[0], t[1], t[2]
            )));
        }
        Ok(Mesh { vertices, triangles, distance_tree: OnceLock::new() })
    }

    /// Vertices [V x 3].
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// Vertex indices of the triangles [T x 3].
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of triangle `t`.
    pub fn corners(&self, t: usize) -> [Vec3; 3] {
        self.triangles[t].map(|v| self.vertices[v as usize])
    }

    /// Twice the area of triangle `t` times its unit normal.
    pub fn area_normal(&self, t: usize) -> Vec3 {
        let [a, b, c] = self.corners(t);
        cross(sub(b, a), sub(c, a))
    }

    /// The box around the vertices that triangles use.
    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.triangles.iter().flatten().map(|&v| &self.vertices[v as usize]))
    }

    /// The tree that answers distances to this mesh, built by the first call.
    pub fn distance_tree(&self) -> Result<&DistanceTree> {
        if let Some(tree) = self.distance_tree.get() {
            return Ok(tree);
        }
        // Two threads may both build; they build the same, and one is kept.
        let tree = Arc::new(DistanceTree::new(self)?);
        Ok(self.distance_tree.get_or_init(|| tree))
    }

    /// Turns every triangle over, so that an inside-out solid becomes a solid.
    pub fn flip(&mut self) {
        for t in &mut self.triangles {
            t.swap(1, 2);
        }
        self.distance_tree = OnceLock::new();
    }
}
