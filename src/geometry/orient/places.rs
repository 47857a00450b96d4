//! Points given more than once, as the vertices of a triangle soup are: one place each.

use super::super::unit::Unit;
use super::super::vec::scale;
use crate::Result;
use crate::error::{try_vec, try_with_capacity};
use std::cmp::Ordering;

/// The different places of some points.
pub struct Places<const D: usize> {
    /// Of size 1, in the order in which they come first [n_places x D].
    pub points: Vec<[f64; D]>,
    /// Index into `points`, one a point.
    pub of_point: Vec<u32>,
    /// Points at the place of an earlier one.
    pub copies: Vec<u32>,
}

impl<const D: usize> Places<D> {
    /// The places of `points`, scaled by `unit`.
    pub fn of(points: &[[f64; D]], unit: Unit) -> Result<Self> {
        let n = points.len();
        let mut order: Vec<u32> = try_with_capacity(n, "the order of the points")?;
        order.extend(0..n as u32);
        // -0.0 + 0.0 is 0.0: the two zeros are one place.
        let place = |i: u32| scale(unit.shrink, points[i as usize]).map(|x| x + 0.0);
        let by_place = |a: [f64; D], b: [f64; D]| {
            a.iter().zip(&b).map(|(a, b)| a.total_cmp(b)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
        };
        order.sort_unstable_by(|&i, &j| by_place(place(i), place(j)).then(i.cmp(&j)));
        let mut first = try_vec(n, 0u32, "the first points of the places")?;
        for copies in order.chunk_by(|&i, &j| place(i) == place(j)) {
            copies.iter().for_each(|&i| first[i as usize] = copies[0]);
        }
        let n_places = (0..n).filter(|&i| first[i] as usize == i).count();
        let mut distinct = try_with_capacity(n_places, "the places of the points")?;
        let mut copies = try_with_capacity(n - n_places, "the points given more than once")?;
        let mut of_point = try_vec(n, 0, "the places of the points")?;
        for i in 0..n {
            if first[i] as usize == i {
                of_point[i] = distinct.len() as u32;
                distinct.push(place(i as u32));
            } else {
                of_point[i] = of_point[first[i] as usize];
                copies.push(i as u32);
            }
        }
        Ok(Places { points: distinct, of_point, copies })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_place_comes_once_in_the_order_of_the_points() {
        let points = [[1.0, 0.0], [0.0, 0.0], [1.0, 0.0], [-0.0, 0.0], [0.5, 1.0]];
        let places = Places::of(&points, Unit { shrink: 1.0, grow: 1.0 }).unwrap();
        assert_eq!(places.points, [[1.0, 0.0], [0.0, 0.0], [0.5, 1.0]]);
        assert_eq!(places.of_point, [0, 1, 0, 1, 2]);
        assert_eq!(places.copies, [2, 3]);
    }
}
