//! An oriented point cloud: points on a surface with unit normals.

use super::Bounds;
use super::vec3::{Vec3, dot, normalized};
use crate::{Error, Result};

/// Where on a mesh a point of a cloud was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Origin {
    /// Index of the triangle.
    pub triangle: u32,
    /// Barycentric coordinates in it: not negative, of sum 1.
    pub barycentric: [f64; 3],
}

/// Points [N x 3] with unit normals [N x 3] that point out of the solid.
#[derive(Debug, Clone)]
pub struct Cloud {
    points: Vec<Vec3>,
    normals: Vec<Vec3>,
    origins: Option<Vec<Origin>>,
}

impl Cloud {
    /// A cloud of `points` with `normals` of any length but 0.
    pub fn new(points: Vec<Vec3>, mut normals: Vec<Vec3>) -> Result<Self> {
        if points.is_empty() {
            return Err(Error::InvalidArgument("the cloud has no points; at least 1 is needed".into()));
        }
        if points.len() != normals.len() {
            return Err(Error::InvalidArgument(format!(
                "{} points come with {} normals; one normal a point is needed",
                points.len(),
                normals.len()
            )));
        }
        for (i, p) in points.iter().enumerate() {
            if !p.iter().all(|x| x.is_finite()) {
                return Err(Error::InvalidArgument(format!(
                    "point {i} is ({}, {}, {}); coordinates must be finite",
                    p[0], p[1], p[2]
                )));
            }
        }
        for (i, n) in normals.iter_mut().enumerate() {
            // Kept to the bit, so that a cloud made from another's points and normals is the same.
            if (dot(*n, *n) - 1.0).abs() <= 4.0 * f64::EPSILON {
                continue;
            }
            *n = normalized(*n).ok_or_else(|| {
                Error::InvalidArgument(format!(
                    "normal {i} is ({}, {}, {}); a finite vector longer than 0 is needed",
                    n[0], n[1], n[2]
                ))
            })?;
        }
        Ok(Cloud { points, normals, origins: None })
    }

    /// The cloud with the places on a mesh from which its points were taken, one a point.
    pub(crate) fn with_origins(mut self, origins: Vec<Origin>) -> Self {
        debug_assert_eq!(origins.len(), self.points.len());
        self.origins = Some(origins);
        self
    }

    /// Number of points N.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether the cloud has no point: never, since [`Cloud::new`] refuses it.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Points [N x 3].
    pub fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// Unit normals [N x 3].
    pub fn normals(&self) -> &[Vec3] {
        &self.normals
    }

    /// Triangle and barycentric coordinates of each point, when the cloud was sampled from a mesh.
    pub fn origins(&self) -> Option<&[Origin]> {
        self.origins.as_deref()
    }

    /// The box around the points.
    pub fn bounds(&self) -> Bounds {
        Bounds::of(&self.points)
    }
}
