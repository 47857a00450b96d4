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

/// Weights are relative; those between 0 and this keep their sums and quotients in the range of doubles.
const LARGEST_WEIGHT: f64 = 1e100;

/// Points [N x D] with unit normals [N x D] that point out of the solid.
#[derive(Debug, Clone)]
pub struct Cloud<const D: usize = 3> {
    points: Vec<[f64; D]>,
    normals: Vec<[f64; D]>,
    origins: Option<Vec<Origin<D>>>,
    weights: Option<Vec<f64>>,
}

impl<const D: usize> Cloud<D> {
    /// A cloud of `points` with `normals` of any length but 0.
    pub fn new(points: Vec<[f64; D]>, mut normals: Vec<[f64; D]>) -> Result<Self> {
        Self::check_count(points.len())?;
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
        Ok(Cloud { points, normals, origins: None, weights: None })
    }

    /// Refuses to have no points, or too many.
    pub(crate) fn check_count(n: usize) -> Result<()> {
        // Three corners a surfel are counted in 32 bits.
        const MOST: usize = 1 << 30;
        match n {
            0 => Err(Error::InvalidArgument("the cloud has no points; at least 1 is needed".into())),
            1..=MOST => Ok(()),
            _ => Err(Error::InvalidArgument(format!("the cloud has {n} points; at most {MOST} are taken"))),
        }
    }

    /// The cloud with the places on a mesh from which its points were taken, one a point.
    pub(crate) fn with_origins(mut self, origins: Vec<Origin<D>>) -> Self {
        debug_assert_eq!(origins.len(), self.points.len());
        self.origins = Some(origins);
        self
    }

    /// Gives each point a weight, `weights` `[N]`: how much a fit trusts it, compared with the others. A point of weight 0 takes no part in
    /// a fit, as if it were not there.
    pub fn set_weights(&mut self, weights: Vec<f64>) -> Result<()> {
        self.check_weight_count(weights.len())?;
        if let Some(i) = weights.iter().position(|w| !(0.0..=LARGEST_WEIGHT).contains(w)) {
            let w = weights[i];
            return Err(Error::InvalidArgument(format!("weight {i} is {w}; it must lie in [0, {LARGEST_WEIGHT:e}]")));
        }
        if weights.iter().all(|w| *w == 0.0) {
            return Err(Error::InvalidArgument("all weights are 0; at least one point must count".into()));
        }
        self.weights = Some(weights);
        Ok(())
    }

    /// Refuses `n` weights where there are not as many points.
    pub(crate) fn check_weight_count(&self, n: usize) -> Result<()> {
        if n == self.len() {
            return Ok(());
        }
        let points = self.len();
        Err(Error::InvalidArgument(format!("{points} points come with {n} weights; one a point is needed")))
    }

    /// The places of the points that count.
    pub(crate) fn counted_points(&self) -> impl Iterator<Item = &[f64; D]> + Clone {
        let counts = |i: usize| self.weights.as_ref().is_none_or(|w| w[i] > 0.0);
        self.points.iter().enumerate().filter(move |(i, _)| counts(*i)).map(|(_, p)| p)
    }

    /// The points that count, or all of them, without origins: a copy that memory may be short of.
    pub(crate) fn copy_of_counted(&self) -> Result<Self> {
        if let Some(counted) = self.counted()? {
            return Ok(counted);
        }
        let copy = |of: &[[f64; D]]| -> Result<Vec<[f64; D]>> {
            let mut made = try_with_capacity(of.len(), "the copy of a cloud")?;
            made.extend_from_slice(of);
            Ok(made)
        };
        Ok(Cloud { points: copy(&self.points)?, normals: copy(&self.normals)?, origins: None, weights: None })
    }

    /// The points that count, without origins; `None` where all do.
    pub(crate) fn counted(&self) -> Result<Option<Self>> {
        let Some(weights) = self.weights.as_ref().filter(|w| w.contains(&0.0)) else { return Ok(None) };
        let n = weights.iter().filter(|w| **w > 0.0).count();
        let mut counted = Cloud {
            points: try_with_capacity(n, "the points that count")?,
            normals: try_with_capacity(n, "the normals of the points that count")?,
            origins: None,
            weights: None,
        };
        let mut kept = try_with_capacity(n, "the weights of the points that count")?;
        for (i, w) in weights.iter().enumerate().filter(|(_, w)| **w > 0.0) {
            counted.points.push(self.points[i]);
            counted.normals.push(self.normals[i]);
            kept.push(*w);
        }
        counted.weights = Some(kept);
        Ok(Some(counted))
    }

    /// The cloud with points that are given more than once, as the vertices of a triangle soup are, made one where their normals agree:
    /// it has the mean of their normals. Copies that face against each other are the two sides of a sheet, and stay. With the numbers of
    /// the points that are left, of the first of copies; `None` where all are.
    pub(crate) fn without_copies(self) -> Result<(Self, Option<Vec<u32>>)> {
        let mut order = try_with_capacity(self.len(), "the order of the points")?;
        order.extend(0..self.len());
        // -0.0 + 0.0 is 0.0: the two zeros are one place.
        let place = |&i: &usize| self.points[i].map(|x| x + 0.0);
        let by_place = |a: &[f64; D], b: &[f64; D]| {
            a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
        };
        order.sort_unstable_by(|i, j| by_place(&place(i), &place(j)).then(i.cmp(j)));
        if order.windows(2).all(|pair| place(&pair[0]) != place(&pair[1])) {
            return Ok((self, None));
        }
        let mut points = try_with_capacity(self.len(), "the points given once")?;
        let mut numbers = try_with_capacity(self.len(), "the numbers of the points given once")?;
        let mut normals: Vec<[f64; D]> = try_with_capacity(self.len(), "the normals of the points given once")?;
        for copies in order.chunk_by(|i, j| place(i) == place(j)) {
            let first = points.len();
            for &i in copies {
                let normal = self.normals[i];
                match normals[first..].iter_mut().find(|sum| dot(**sum, normal) > 0.0) {
                    Some(sum) => *sum = add(*sum, normal),
                    None => {
                        points.push(self.points[i]);
                        numbers.push(i as u32);
                        normals.push(normal);
                    }
                }
            }
        }
        Ok((Cloud::new(points, normals)?, Some(numbers)))
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

    /// How much each point counts `[N]`, where not all count alike.
    pub fn weights(&self) -> Option<&[f64]> {
        self.weights.as_deref()
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
        let (cloud, numbers) = Cloud::new(points, vec![up, up, side, down, up]).unwrap().without_copies().unwrap();
        assert_eq!(numbers, Some(vec![1, 3, 0]));
        assert_eq!(cloud.points(), [[0.0; 3], [0.0; 3], [1.0; 3]]);
        assert_eq!(cloud.normals()[..2], [up, down]);
        assert_eq!(Some(cloud.normals()[2]), normalized([0.6, 0.0, 2.8]));
        let (kept, numbers) = Cloud::new(vec![[2.0; 3], [1.0; 3]], vec![up, down]).unwrap().without_copies().unwrap();
        assert!(kept.points() == [[2.0; 3], [1.0; 3]] && numbers.is_none());
    }
}
