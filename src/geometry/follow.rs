//! Clouds that follow the mesh they were taken from, as its vertices move.

use super::cloud::{Cloud, Origin};
use super::sample::taken;
use super::unit::Unit;
use super::{Mesh, facet};
use crate::error::try_with_capacity;
use crate::{Error, Result};

impl<const D: usize> Cloud<D> {
    /// The cloud of the same places, facets and barycentric coordinates, on `mesh`: the one that this cloud was taken from, with its
    /// vertices moved. Points and normals are made as [`Mesh::sample`] makes them; weights stay. [`Error::Degenerate`] where a facet with a
    /// point has lost its area.
    pub fn follow(&self, mesh: &Mesh<D>) -> Result<Self> {
        let from = self.origins_on(mesh)?;
        let unit = Unit::of(mesh);
        let shrunk = unit.shrunk(mesh)?;
        let has_area = |o: &Origin<D>| facet::area(&shrunk.corners(o.facet as usize)) > 0.0;
        if let Some(i) = from.iter().position(|o| !has_area(o)) {
            let (name, f) = (Mesh::<D>::FACET, from[i].facet);
            return Err(Error::Degenerate(format!(
                "point {i} is on {name} {f}, which has lost its area, and so its normal"
            )));
        }
        let mut origins = try_with_capacity(from.len(), "the sample origins")?;
        origins.extend_from_slice(from);
        let mut cloud = taken(&shrunk, unit, origins)?;
        if let Some(weights) = self.weights() {
            let mut copy = try_with_capacity(weights.len(), "the weights")?;
            copy.extend_from_slice(weights);
            cloud.set_weights(copy)?;
        }
        Ok(cloud)
    }

    /// The points' places on `mesh`; an error for a cloud that has none, and for a mesh that lacks one of their facets.
    pub(super) fn origins_on(&self, mesh: &Mesh<D>) -> Result<&[Origin<D>]> {
        let Some(origins) = self.origins() else {
            let text = "the cloud was made from points; only one that was sampled from a mesh has origins";
            return Err(Error::InvalidArgument(text.into()));
        };
        let n = mesh.facets().len();
        let Some(i) = origins.iter().position(|o| o.facet as usize >= n) else { return Ok(origins) };
        let (name, f) = (Mesh::<D>::FACET, origins[i].facet);
        Err(Error::InvalidArgument(format!(
            "point {i} was taken from {name} {f}, but the mesh has {n} {name}s, counted from 0; the mesh that was sampled is needed, its \
             vertices moved or not"
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::super::shapes::{box_mesh, circle, torus};
    use super::super::vec::scale;
    use super::*;

    #[test]
    fn a_cloud_follows_its_own_mesh_to_itself_and_a_scaled_one_scaled() {
        let ring = torus(1.0, 0.4, 20, 12).unwrap();
        let mut cloud = ring.sample(300, 1).unwrap();
        cloud.set_weights((0..300).map(f64::from).collect()).unwrap();
        let same = cloud.follow(&ring).unwrap();
        assert_eq!((same.points(), same.normals()), (cloud.points(), cloud.normals()));
        assert_eq!((same.origins(), same.weights()), (cloud.origins(), cloud.weights()));
        let doubled = ring.vertices().iter().map(|v| scale(2.0, *v)).collect();
        let larger = cloud.follow(&Mesh::new(doubled, ring.facets().to_vec()).unwrap()).unwrap();
        assert_eq!(larger.normals(), cloud.normals());
        assert!(larger.points().iter().zip(cloud.points()).all(|(a, b)| *a == scale(2.0, *b)));
    }

    #[test]
    fn other_meshes_and_clouds_without_origins_are_refused() {
        let round = circle([0.0; 2], 1.0, 40).unwrap();
        let cloud = round.sample(100, 1).unwrap();
        let fewer = circle([0.0; 2], 1.0, 20).unwrap();
        assert!(cloud.follow(&fewer).unwrap_err().to_string().contains("but the mesh has 20 segments"));
        let points = Cloud::new(cloud.points().to_vec(), cloud.normals().to_vec()).unwrap();
        assert!(points.follow(&round).unwrap_err().to_string().contains("has origins"));
        let cube = box_mesh([0.0; 3], [1.0; 3]).unwrap();
        let flat = Mesh::new(vec![[0.0; 3]; cube.vertices().len()], cube.facets().to_vec()).unwrap();
        assert!(matches!(cube.sample(10, 1).unwrap().follow(&flat), Err(Error::Degenerate(_))));
    }
}
