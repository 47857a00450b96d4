//! Whether a mesh has two sides that can be told for sure, and on which of them a point lies.

use super::super::facet::normal;
use super::super::vec::{dot, sub};
use super::super::winding::Side;
use super::DistanceTree;

impl<const D: usize> DistanceTree<D> {
    /// Whether the mesh bounds a solid: every edge, told by the places of its ends, is run through as often one way as the other, so that
    /// the winding number is an integer and constant away from the mesh, and the volume is positive.
    pub(crate) fn bounds_solid(&self) -> bool {
        // The volume by the divergence theorem, from one of its own corners on.
        let origin = self.corners[0][0];
        let volume: f64 = self.corners.iter().map(|facet| dot(sub(facet[0], origin), normal(facet))).sum();
        self.winding.is_closed() && volume > 0.0
    }

    /// Whether a finite point is inside: where the winding number is 1/2 or more.
    pub(crate) fn is_inside(&self, point: [f64; D]) -> bool {
        self.winding.side(&self.tree, &self.corners, self.query(point).point) == Side::Inside
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::Mesh;
    use super::super::super::shapes::{box_mesh, rectangle};

    #[test]
    fn solids_are_closed_by_place_and_not_inside_out() {
        let cube = box_mesh([5.0; 3], [6.0; 3]).unwrap();
        let tree = cube.distance_tree().unwrap();
        assert!(tree.bounds_solid() && tree.is_inside([5.5; 3]) && !tree.is_inside([6.5; 3]));
        // The same with vertices of their own for each triangle.
        let corners: Vec<_> = (0..12).flat_map(|t| cube.corners(t)).collect();
        let apart = Mesh::new(corners, (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()).unwrap();
        assert!(apart.distance_tree().unwrap().bounds_solid());
        let open = Mesh::new(cube.vertices().to_vec(), cube.triangles()[1..].to_vec()).unwrap();
        assert!(!open.distance_tree().unwrap().bounds_solid());
        let mut turned = rectangle([0.0; 2], [1.0; 2]).unwrap();
        assert!(turned.distance_tree().unwrap().bounds_solid());
        turned.flip();
        assert!(!turned.distance_tree().unwrap().bounds_solid());
    }
}
