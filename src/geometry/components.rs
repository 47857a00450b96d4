//! The connected parts of a mesh, by a point of each.

use super::Mesh;
use super::edges::Sets;
use crate::Result;
use crate::error::try_reserve;

impl<const D: usize> Mesh<D> {
    /// A vertex of each part of the mesh that hangs together by vertices that its facets share, in the order of the parts' first facets.
    /// Facets without area belong to the mesh too. In O(V + F).
    pub fn component_points(&self) -> Result<Vec<[f64; D]>> {
        let mut parts = Sets::new(self.vertices().len())?;
        for facet in self.facets() {
            facet[1..].iter().for_each(|&v| parts.join(facet[0] as usize, v as usize));
        }
        // A part is known by its smallest vertex, and told where that is met the first time.
        let mut told = crate::error::try_vec(self.vertices().len(), false, "the parts of the mesh")?;
        let mut points = Vec::new();
        for facet in self.facets() {
            let part = parts.find(facet[0] as usize);
            if !std::mem::replace(&mut told[part], true) {
                try_reserve(&mut points, 1, "the points of the mesh's parts")?;
                points.push(self.vertices()[facet[0] as usize]);
            }
        }
        Ok(points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_hang_together_by_vertices() {
        let vertices = (0..9).map(|i| [f64::from(i), 0.5, 0.0]).collect();
        // Two triangles that share a vertex, one of no area apart, and a vertex that none uses.
        let mesh = Mesh::<3>::new(vertices, vec![[5, 6, 7], [1, 2, 3], [3, 4, 0], [8, 8, 8]]).unwrap();
        let x: Vec<f64> = mesh.component_points().unwrap().iter().map(|p| p[0]).collect();
        assert_eq!(x, [5.0, 1.0, 8.0]);
        let curves = Mesh::<2>::new(vec![[0.0; 2], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]], vec![[3, 2], [0, 1]]).unwrap();
        assert_eq!(curves.component_points().unwrap(), [[3.0, 0.0], [0.0, 0.0]]);
    }
}
