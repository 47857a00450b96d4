//! An oriented point cloud: points on a surface with unit normals.

use super::Bounds;
use super::vec::{add, dot, is_finite, normalized, text};
use crate::error::try_with_capacity;
use crate::{Error, Result};
use std::cmp::Ordering;

/// Where on a mesh a point of a cloud was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Origin<const D: usize = 3> {
    /// Index of the facet: triangle or segment.
    pub facet: u32,
    /// Barycentric coordinates in it: not negative, of sum 1.
    pub barycentric: [f64; D],
}

/// Points [N x D] with unit normals [N x D] that point out of the solid.
#[derive(Debug, Clone)]
pub struct Cloud<const D: usize = 3> {
    points: Vec<[f64; D]>,
    normals: Vec<[f64; D]>,
    origins: Option<Vec<Origin<D>>>,
}

impl<const D: usize> Cloud<D> {
    /// A cloud of `points` with `normals` of any length but 0.
    pub fn new(points: Vec<[f64; D]>, mut normals: Vec<[f64; D]>) -> Result<Self> {
        if points.is_empty() {
            return Err(Error::InvalidArgument("the cloud has no points; at least 1 is needed".into()));
        }
        // Three corners a surfel are counted in 32 bits.
        const MOST: usize = 1 << 30;
        if points.len() > MOST {
            let n = points.len();
            return Err(Error::InvalidArgument(format!("the cloud has {n} points; at most {MOST} are taken")));
        }
        if points.len() != normals.len() {
            return Err(Error::InvalidArgument(format!(
                "{} points come with {} normals; one normal a point is needed",
                points.len(),
                normals.len()
            )));
        }
        for (i, p) in points.iter().enumerate() {
            if !is_finite(p) {
                return Err(Error::InvalidArgument(format!("point {i} is {}; coordinates must be finite", text(p))));
            }
        }
        for (i, n) in normals.iter_mut().enumerate() {
            // Kept to the bit, so that a cloud made from another's points and normals is the same.
            if (dot(*n, *n) - 1.0).abs() <= 4.0 * f64::EPSILON {
                continue;
            }
            *n = normalized(*n).ok_or_else(|| {
                Error::InvalidArgument(format!("normal {i} is {}; a finite vector longer than 0 is needed", text(n)))
            })?;
        }
        Ok(Cloud { points, normals, origins: None })
    }

    /// The cloud with the places on a mesh from which its points were taken, one a point.
    pub(crate) fn with_origins(mut self, origins: Vec<Origin<D>>) -> Self {
        debug_assert_eq!(origins.len(), self.points.len());
        self.origins = Some(origins);
        self
    }

    /// The cloud with points that are given more than once, as the vertices of a triangle soup are, made one where their normals agree:
    /// it has the mean of their normals. Copies that face against each other are the two sides of a sheet, and stay.
    pub(crate) fn without_copies(self) -> Result<Self> {
        let mut order = try_with_capacity(self.len(), "the order of the points")?;
        order.extend(0..self.len());
        // -0.0 + 0.0 is 0.0: the two zeros are one place.
        let place = |&i: &usize| self.points[i].map(|x| x + 0.0);
        let by_place = |a: &[f64; D], b: &[f64; D]| {
            a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
        };
        order.sort_unstable_by(|i, j| by_place(&place(i), &place(j)).then(i.cmp(j)));
        if order.windows(2).all(|pair| place(&pair[0]) != place(&pair[1])) {
            return Ok(self);
        }
        let mut points = try_with_capacity(self.len(), "the points given once")?;
        let mut normals: Vec<[f64; D]> = try_with_capacity(self.len(), "the normals of the points given once")?;
        for copies in order.chunk_by(|i, j| place(i) == place(j)) {
            let first = points.len();
            for &i in copies {
                let normal = self.normals[i];
                match normals[first..].iter_mut().find(|sum| dot(**sum, normal) > 0.0) {
                    Some(sum) => *sum = add(*sum, normal),
                    None => {
                        points.push(self.points[i]);
                        normals.push(normal);
                    }
                }
            }
        }
        Cloud::new(points, normals)
    }

    /// Number of points N.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether the cloud has no point: never, since [`Cloud::new`] refuses it.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Points [N x D].
    pub fn points(&self) -> &[[f64; D]] {
        &self.points
    }

    /// Unit normals [N x D].
    pub fn normals(&self) -> &[[f64; D]] {
        &self.normals
    }

    /// Facet and barycentric coordinates of each point, when the cloud was sampled from a mesh.
    pub fn origins(&self) -> Option<&[Origin<D>]> {
        self.origins.as_deref()
    }

    /// The box around the points.
    pub fn bounds(&self) -> Bounds<D> {
        Bounds::of(&self.points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_that_face_alike_become_one_point_with_the_mean_normal() {
        let (up, down, side) = ([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.6, 0.0, 0.8]);
        let points = vec![[1.0; 3], [0.0; 3], [1.0; 3], [-0.0; 3], [1.0; 3]];
        let cloud = Cloud::new(points, vec![up, up, side, down, up]).unwrap().without_copies().unwrap();
        assert_eq!(cloud.points(), [[0.0; 3], [0.0; 3], [1.0; 3]]);
        assert_eq!(cloud.normals()[..2], [up, down]);
        assert_eq!(Some(cloud.normals()[2]), normalized([0.6, 0.0, 2.8]));
        let kept = Cloud::new(vec![[2.0; 3], [1.0; 3]], vec![up, down]).unwrap().without_copies().unwrap();
        assert_eq!(kept.points(), [[2.0; 3], [1.0; 3]]);
    }
}
