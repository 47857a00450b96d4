//! A mesh in the making: every vertex and face is checked as it comes, while its place in the file is known.

use super::fault::{Fault, Read};
use crate::Error;
use crate::error::{Place, try_reserve, try_with_capacity};
use crate::geometry::Mesh;
use crate::geometry::vec::Vec3;

/// Vertices are numbered by `u32`.
const MOST_VERTICES: usize = u32::MAX as usize;

/// Vertices and triangles so far.
pub(super) struct Builder {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    faces: usize,
}

impl Builder {
    /// Room for what is expected; the caller has made sure that the file is long enough to hold it.
    pub fn with_room(vertices: usize, faces: usize) -> Read<Self> {
        check_vertex_count(vertices)?;
        Ok(Builder {
            vertices: try_with_capacity(vertices, "the vertices")?,
            triangles: try_with_capacity(faces, "the triangles")?,
            faces: 0,
        })
    }

    /// Takes the next vertex, read at `place`.
    pub fn vertex(&mut self, p: Vec3, place: Place) -> Read<()> {
        check_finite(p, self.vertices.len(), place)?;
        check_vertex_count(self.vertices.len() + 1)?;
        push(&mut self.vertices, p, "the vertices")
    }

    /// Takes the next face, read at `place`, whose corners count from 0 in a file of `n_vertices`.
    pub fn face(&mut self, corners: &[i64], n_vertices: usize, place: Place) -> Read<()> {
        let i = self.faces;
        check_corner_count(corners.len(), i, place)?;
        if let Some(bad) = corners.iter().find(|&&c| usize::try_from(c).map_or(true, |c| c >= n_vertices)) {
            let message = format!("face {i} names vertex {bad}; the file has {n_vertices} vertices, counted from 0");
            return Err(Fault::at(place, message));
        }
        self.faces += 1;
        // In range, so the casts lose nothing.
        for side in corners[1..].windows(2) {
            push(&mut self.triangles, [corners[0] as u32, side[0] as u32, side[1] as u32], "the triangles")?;
        }
        Ok(())
    }

    /// The mesh.
    pub fn finish(self) -> Read<Mesh> {
        mesh(self.vertices, self.triangles)
    }
}

/// The mesh of what a reader has found and checked.
pub(super) fn mesh(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Read<Mesh> {
    if triangles.is_empty() {
        let n = vertices.len();
        return Err(Fault::whole(format!("the file has {n} vertices and 0 faces; at least 1 face is needed")));
    }
    Ok(Mesh::new(vertices, triangles)?)
}

/// Refuses vertex `i` at `place` when it is not finite.
pub(super) fn check_finite(p: Vec3, i: usize, place: Place) -> Read<()> {
    if p.iter().all(|x| x.is_finite()) {
        return Ok(());
    }
    Err(Fault::at(place, format!("vertex {i} is ({}, {}, {}); coordinates must be finite", p[0], p[1], p[2])))
}

/// Refuses face `i` at `place` when it has too few corners.
pub(super) fn check_corner_count(n: usize, i: usize, place: Place) -> Read<()> {
    if n >= 3 {
        return Ok(());
    }
    Err(Fault::at(place, format!("face {i} has {n} corners; at least 3 are needed")))
}

/// Refuses more vertices than indices can tell apart.
pub(super) fn check_vertex_count(n: usize) -> Read<()> {
    if n <= MOST_VERTICES {
        return Ok(());
    }
    Err(Error::Unsupported(format!("the mesh has {n} vertices; at most {MOST_VERTICES} are supported")).into())
}

/// Appends `value` to `vec`, or reports that memory for `what` ran out.
pub(super) fn push<T>(vec: &mut Vec<T>, value: T, what: &str) -> Read<()> {
    try_reserve(vec, 1, what)?;
    vec.push(value);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_become_fans() {
        for n in 0..8 {
            let mut builder = Builder::with_room(0, 0).unwrap();
            for i in 0..n {
                builder.vertex([i as f64, 0.0, 0.0], Place::Line(i + 1)).unwrap();
            }
            let corners: Vec<i64> = (0..n as i64).collect();
            let face = builder.face(&corners, n, Place::Line(9));
            assert_eq!(face.is_ok(), n >= 3);
            assert_eq!(builder.triangles.len(), n.saturating_sub(2));
        }
    }

    #[test]
    fn indices_have_room_for_no_more_vertices() {
        assert!(check_vertex_count(MOST_VERTICES).is_ok());
        assert!(check_vertex_count(MOST_VERTICES + 1).is_err());
    }

    #[test]
    fn corners_are_in_range() {
        let mut builder = Builder::with_room(0, 0).unwrap();
        for bad in [-1, 3, i64::MAX, i64::MIN] {
            assert!(builder.face(&[0, 1, bad], 3, Place::Whole).is_err());
        }
        assert!(builder.face(&[0, 1, 2], 3, Place::Whole).is_ok());
    }
}
