//! From derivatives by the points and normals of a cloud to derivatives by the vertices of its mesh: the transpose of
//! [`Cloud::follow`](super::Cloud::follow), with the origins and the groups of corners that have one normal standing still.
//!
//! Notation: a bar is the derivative of J by what stands under it. From the end on, with v = sum of b_k N_k, N = S / |S| and S = sum of w m,
//! N the corner normals, S their sums over the facets of a group, m the facets' unit normals and w what they weigh at a corner:
//!
//! ```text
//! p = sum of b_k V_k:     V_k bar += b_k p bar
//! n = v / |v|:            v bar = (n bar - n (n . n bar)) / |v|,   N_k bar += b_k v bar;  so N to S
//! S:                      m bar += w S bar,  w bar += m . S bar
//! ```
//!
//! then by the angle or the length that w is, and by the cross product that m is, to the vertices.

use super::cloud::Cloud;
use super::normals::{CornerNormals, weight};
use super::unit::Unit;
use super::vec::{add, cross, dot, norm, normalized, scale, sub};
use super::{Mesh, facet};
use crate::error::try_vec;
use crate::{Error, Result};

/// What the memory is for, should it run out.
const WHAT: &str = "the derivatives by the vertices";

impl<const D: usize> Cloud<D> {
    /// dJ/dV [V x D] by the vertices of `mesh`, from which this cloud was taken or which it [follows](Cloud::follow), into `vertices`, from
    /// dJ/dp and dJ/dn [N x D] by its points and normals; `None` for zeros.
    pub fn pull_back(
        &self,
        mesh: &Mesh<D>,
        points: Option<&[[f64; D]]>,
        normals: Option<&[[f64; D]]>,
        vertices: &mut [[f64; D]],
    ) -> Result<()> {
        let (n, n_vertices) = (self.len(), mesh.vertices().len());
        for (name, given) in [("points", points), ("normals", normals)] {
            if let Some(given) = given.map(<[_]>::len).filter(|given| *given != n) {
                return Err(Error::InvalidArgument(format!(
                    "{given} derivatives by {name} are given; the cloud has {n} points, and one for each is needed"
                )));
            }
        }
        if vertices.len() != n_vertices {
            let room = vertices.len();
            return Err(Error::InvalidArgument(format!(
                "there is room for derivatives by {room} vertices; the mesh has {n_vertices}"
            )));
        }
        let origins = self.origins_on(mesh)?;
        vertices.fill([0.0; D]);
        if let Some(normals) = normals {
            self.pull_normals(mesh, normals, vertices)?;
        }
        for (origin, by_point) in origins.iter().zip(points.unwrap_or_default()) {
            for (k, v) in mesh.facets()[origin.facet as usize].iter().enumerate() {
                let to = &mut vertices[*v as usize];
                *to = add(*to, scale(origin.barycentric[k], *by_point));
            }
        }
        Ok(())
    }

    /// Puts into `vertices` what comes by the normals.
    fn pull_normals(&self, mesh: &Mesh<D>, normals: &[[f64; D]], vertices: &mut [[f64; D]]) -> Result<()> {
        let unit = Unit::of(mesh);
        let mesh = &unit.shrunk(mesh)?;
        let corners = CornerNormals::of(mesh)?;
        let mut by = By::nothing(mesh)?;
        for (origin, by_normal) in self.origins_on(mesh)?.iter().zip(normals) {
            let f = origin.facet as usize;
            let v = facet::point(&corners.normals[f], origin.barycentric);
            match normalized(v).filter(|n| dot(*n, corners.faces[f]) > 0.0) {
                // Where the corners' normals cancel or turn against the facet's, that was taken.
                None => by.faces[f] = add(by.faces[f], *by_normal),
                Some(n) => {
                    let by_v = of_length(*by_normal, n, norm(v));
                    for k in 0..D {
                        by.corners[f][k] = add(by.corners[f][k], scale(origin.barycentric[k], by_v));
                    }
                }
            }
        }
        by.pull_corners(mesh, corners, vertices);
        by.pull_faces(mesh, vertices);
        // The normals were those of the shrunk mesh.
        vertices.iter_mut().for_each(|v| *v = scale(unit.shrink, *v));
        Ok(())
    }
}

/// From a derivative by n = v / |v| to one by v.
fn of_length<const D: usize>(by_n: [f64; D], n: [f64; D], length: f64) -> [f64; D] {
    scale(1.0 / length, sub(by_n, scale(dot(n, by_n), n)))
}

/// Derivatives by the normals of corners [F x D x D] and of facets [F x D].
struct By<const D: usize> {
    corners: Vec<[[f64; D]; D]>,
    faces: Vec<[f64; D]>,
}

impl<const D: usize> By<D> {
    fn nothing(mesh: &Mesh<D>) -> Result<Self> {
        let n = mesh.facets().len();
        Ok(By { corners: try_vec(n, [[0.0; D]; D], WHAT)?, faces: try_vec(n, [0.0; D], WHAT)? })
    }

    /// From the corners' normals to those of the facets and, by what these weigh, to the vertices.
    fn pull_corners(&mut self, mesh: &Mesh<D>, mut normals: CornerNormals<D>, vertices: &mut [[f64; D]]) {
        let n_corners = D * self.faces.len();
        // From N to S, gathered at the first corner of each group, which comes before the others.
        for corner in 0..n_corners {
            let group = normals.groups.find(corner);
            let (sum, n) = (normals.sums.as_flattened()[group], normals.normals.as_flattened()[corner]);
            let by_n = std::mem::replace(&mut self.corners.as_flattened_mut()[corner], [0.0; D]);
            if normalized(sum).is_some() {
                let to = &mut self.corners.as_flattened_mut()[group];
                *to = add(*to, of_length(by_n, n, norm(sum)));
            } else {
                self.faces[corner / D] = add(self.faces[corner / D], by_n);
            }
        }
        for corner in 0..n_corners {
            let (f, k) = (corner / D, corner % D);
            let (face, by_sum) = (normals.faces[f], self.corners.as_flattened()[normals.groups.find(corner)]);
            if face == [0.0; D] || by_sum == [0.0; D] {
                continue;
            }
            let corners = mesh.corners(f);
            self.faces[f] = add(self.faces[f], scale(weight(&corners, k), by_sum));
            let by_weight = dot(face, by_sum);
            for (v, slope) in mesh.facets()[f].iter().zip(weight_slopes(&corners, k, face)) {
                let to = &mut vertices[*v as usize];
                *to = add(*to, scale(by_weight, slope));
            }
        }
    }

    /// From the facets' normals to the vertices.
    fn pull_faces(&self, mesh: &Mesh<D>, vertices: &mut [[f64; D]]) {
        for (f, by_face) in self.faces.iter().enumerate() {
            let area_normal = mesh.area_normal(f);
            let Some(face) = normalized(area_normal) else { continue };
            let slopes = pull_area_normal(&mesh.corners(f), of_length(*by_face, face, norm(area_normal)));
            for (v, slope) in mesh.facets()[f].iter().zip(slopes) {
                let to = &mut vertices[*v as usize];
                *to = add(*to, slope);
            }
        }
    }
}

/// Derivatives, by the corners, of what a facet of unit normal `face` weighs at its corner k.
fn weight_slopes<const D: usize>(corners: &[[f64; D]; D], k: usize, face: [f64; D]) -> [[f64; D]; D] {
    let mut slopes = [[0.0; D]; D];
    if D == 2 {
        // 1 / l
        let along = sub(corners[1], corners[0]);
        let l = norm(along);
        slopes[0] = scale(1.0 / (l * l * l), along);
        slopes[1] = scale(-1.0, slopes[0]);
        return slopes;
    }
    // The angle from u to v: it grows as u turns back, and as v turns on, about the facet's normal.
    let turned = |other: usize| {
        let edge = sub(corners[other], corners[k]);
        scale(1.0 / dot(edge, edge), facet::cut(cross(facet::cut(face), facet::cut(edge))))
    };
    let (u, v) = ((k + 1) % D, (k + 2) % D);
    slopes[u] = scale(-1.0, turned(u));
    slopes[v] = turned(v);
    slopes[k] = scale(-1.0, add(slopes[u], slopes[v]));
    slopes
}

/// From a derivative by the normal times length, or twice the area, of a facet to those by its corners.
fn pull_area_normal<const D: usize>(corners: &[[f64; D]; D], by: [f64; D]) -> [[f64; D]; D] {
    let mut slopes = [[0.0; D]; D];
    if D == 2 {
        // (y, -x) of the way along.
        slopes[1] = facet::cut([-by[1], by[0]]);
    } else {
        // u x v: its differential is du x v + u x dv.
        let [u, v]: [[f64; 3]; 2] = [1, 2].map(|k: usize| facet::cut(sub(corners[k % D], corners[0])));
        slopes[1] = facet::cut(cross(v, facet::cut(by)));
        slopes[2 % D] = facet::cut(cross(facet::cut(by), u));
    }
    slopes[0] = scale(-1.0, (1..D).fold([0.0; D], |sum, k| add(sum, slopes[k])));
    slopes
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::super::shapes::{box_mesh, circle, sphere, torus};
    use super::*;

    /// Random vectors.
    fn vectors<const D: usize>(n: usize, seed: u64) -> Vec<[f64; D]> {
        let mut random = SplitMix64::new(seed);
        (0..n).map(|_| std::array::from_fn(|_| random.between(-1.0, 1.0))).collect()
    }

    fn sum<const D: usize>(x: &[[f64; D]], y: &[[f64; D]]) -> f64 {
        x.iter().zip(y).map(|(x, y)| dot(*x, *y)).sum()
    }

    /// The pull-back of random derivatives agrees with central differences of clouds that follow, along some random moves.
    fn check<const D: usize>(mesh: &Mesh<D>) {
        let cloud = mesh.sample(200, 1).unwrap();
        let (by_points, by_normals) = (vectors::<D>(200, 2), vectors::<D>(200, 3));
        let mut by_vertices = vec![[f64::NAN; D]; mesh.vertices().len()];
        cloud.pull_back(mesh, Some(&by_points), Some(&by_normals), &mut by_vertices).unwrap();
        let size = norm(sub(mesh.bounds().max, mesh.bounds().min));
        let h = 1e-6 * size;
        let j = |moves: &[[f64; D]], h: f64| {
            let moved = mesh.vertices().iter().zip(moves).map(|(v, m)| add(*v, scale(h, *m))).collect();
            let cloud = cloud.follow(&Mesh::new(moved, mesh.facets().to_vec()).unwrap()).unwrap();
            sum(cloud.points(), &by_points) + sum(cloud.normals(), &by_normals)
        };
        for seed in 4..8 {
            let moves = vectors::<D>(by_vertices.len(), seed);
            let (by_difference, by_pull) = ((j(&moves, h) - j(&moves, -h)) / (2.0 * h), sum(&by_vertices, &moves));
            let size: f64 = by_vertices.iter().map(|v| norm(*v)).sum::<f64>() / (by_vertices.len() as f64).sqrt();
            assert!((by_difference - by_pull).abs() < 1e-7 * size, "{by_difference} {by_pull} of {size}");
        }
        let mut by_points_alone = vec![[f64::NAN; D]; by_vertices.len()];
        cloud.pull_back(mesh, Some(&by_points), None, &mut by_points_alone).unwrap();
        let mut by_normals_alone = by_points_alone.clone();
        cloud.pull_back(mesh, None, Some(&by_normals), &mut by_normals_alone).unwrap();
        for (whole, (a, b)) in by_vertices.iter().zip(by_points_alone.iter().zip(&by_normals_alone)) {
            assert!(norm(sub(*whole, add(*a, *b))) <= 1e-13 * (1.0 + norm(*whole)));
        }
    }

    #[test]
    fn the_pull_back_agrees_with_differences_of_clouds_that_follow() {
        check(&sphere([0.3, 0.2, -0.1], 1.0, 2).unwrap());
        check(&torus(1.0, 0.4, 20, 12).unwrap());
        check(&box_mesh([-1.0, 0.0, 2.0], [1.0, 0.5, 3.0]).unwrap());
        check(&circle([0.5, -0.25], 300.0, 30).unwrap());
        let uneven = [[0.0, 0.0], [1.0, 0.1], [1.3, 0.3], [1.4, 1.5], [0.2, 1.4], [-0.2, 1.2], [-0.3, 0.3]];
        check(&Mesh::new(uneven.to_vec(), (0..7).map(|i| [i, (i + 1) % 7]).collect()).unwrap());
    }

    #[test]
    fn wrong_lengths_are_named() {
        let ball = sphere([0.0; 3], 1.0, 1).unwrap();
        let cloud = ball.sample(10, 1).unwrap();
        let mut vertices = vec![[0.0; 3]; ball.vertices().len()];
        let end = cloud.pull_back(&ball, Some(&[[0.0; 3]; 9]), None, &mut vertices);
        assert!(end.unwrap_err().to_string().contains("9 derivatives by points"));
        let end = cloud.pull_back(&ball, None, Some(&[[0.0; 3]; 11]), &mut vertices);
        assert!(end.unwrap_err().to_string().contains("11 derivatives by normals"));
        let end = cloud.pull_back(&ball, None, None, &mut vertices[1..]);
        assert!(end.unwrap_err().to_string().contains("room for derivatives by"));
    }
}
