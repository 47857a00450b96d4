//! What part of each cell a solid fills: the densities of (A.3), as fractions of a cell.
//!
//! A solid is a function that is negative inside and changes by at most `steepness` a unit of length: a signed distance (1), or a field with a
//! bound of its gradient. Cells whose centres say that the surface does not reach them are full or empty; the others are sampled.

use super::grid::Grid;
use crate::geometry::vec::{dot, norm, number, sub};
use crate::geometry::{Bounds, DistanceTree};
use crate::par::Workers;
use crate::{Error, Result};

/// Simple solids.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Solid<const D: usize> {
    /// A box along the axes.
    Box(Bounds<D>),
    /// A disc or ball.
    Ball {
        /// Its middle.
        center: [f64; D],
        /// Its radius.
        radius: f64,
    },
    /// A cylinder with flat ends; in the plane a strip.
    Cylinder {
        /// The middles of its ends.
        ends: [[f64; D]; 2],
        /// Its radius; half the strip's width.
        radius: f64,
    },
}

impl<const D: usize> Solid<D> {
    /// Refuses a solid with a number that is not finite, a box whose corners are the wrong way round, a radius that is not above 0, and ends of a
    /// cylinder that are one point.
    pub fn check(&self) -> Result<()> {
        let (numbers, radius) = match self {
            Solid::Box(Bounds { min, max }) => ([*min, *max], 1.0),
            Solid::Ball { center, radius } => ([*center; 2], *radius),
            Solid::Cylinder { ends, radius } => (*ends, *radius),
        };
        if let Some(x) = numbers.as_flattened().iter().find(|x| !x.is_finite()) {
            return Err(Error::InvalidArgument(format!(
                "a coordinate of the solid is {}; it must be finite",
                number(*x)
            )));
        }
        if !(radius > 0.0 && radius.is_finite()) {
            let text = format!("the radius is {}; it must be above 0 and finite", number(radius));
            return Err(Error::InvalidArgument(text));
        }
        match self {
            Solid::Box(Bounds { min, max }) => match (0..D).find(|&a| min[a] >= max[a]) {
                Some(a) => Err(Error::InvalidArgument(format!(
                    "along axis {a} the box goes from {} to {}; its end must be above its beginning",
                    number(min[a]),
                    number(max[a])
                ))),
                None => Ok(()),
            },
            Solid::Cylinder { ends: [a, b], .. } if norm(sub(*a, *b)) == 0.0 => {
                Err(Error::InvalidArgument("both ends of the cylinder are one point; they must differ".into()))
            }
            _ => Ok(()),
        }
    }

    /// Distance of `p` to the surface, negative inside.
    pub fn signed_distance(&self, p: [f64; D]) -> f64 {
        match *self {
            Solid::Ball { center, radius } => norm(sub(p, center)) - radius,
            Solid::Box(Bounds { min, max }) => {
                of_sides(std::array::from_fn::<f64, D, _>(|a| (min[a] - p[a]).max(p[a] - max[a])))
            }
            Solid::Cylinder { ends: [a, b], radius } => {
                let (axis, from) = (sub(b, a), sub(p, a));
                let length = norm(axis);
                let along = dot(axis, from) / length;
                let across = (dot(from, from) - along * along).max(0.0).sqrt();
                of_sides([(-along).max(along - length), across - radius])
            }
        }
    }
}

/// Signed distance of a product of intervals, by how far one is beyond the nearer end of each.
fn of_sides<const N: usize>(beyond: [f64; N]) -> f64 {
    let outside = norm(beyond.map(|x| x.max(0.0)));
    outside + beyond.into_iter().fold(f64::NEG_INFINITY, f64::max).min(0.0)
}

/// How cells are sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FractionOptions {
    /// Points along each axis of a cell that the surface may pass through.
    pub samples: usize,
    /// Bound of how fast the function changes.
    pub steepness: f64,
}

impl Default for FractionOptions {
    fn default() -> Self {
        FractionOptions { samples: 8, steepness: 1.0 }
    }
}

/// Fractions of the cells of `grid`, `[n]`, that are inside of what `solid`(points, values) gives: negative inside.
pub fn fractions<const D: usize>(
    grid: &Grid<D>,
    solid: impl Fn(&[[f64; D]], &mut [f64]) -> Result<()> + Sync,
    options: &FractionOptions,
    out: &mut [f64],
    workers: &Workers,
) -> Result<()> {
    let FractionOptions { samples, steepness } = *options;
    if samples == 0 || samples > 64 {
        return Err(Error::InvalidArgument(format!("{samples} samples along a cell's edge; it must be 1 to 64")));
    }
    if !(steepness > 0.0 && steepness.is_finite()) {
        return Err(Error::InvalidArgument(format!("a steepness of {}; it must be above 0", number(steepness))));
    }
    if out.len() != grid.n_cells() {
        return Err(Error::InvalidArgument(format!("{} fractions for a grid of {} cells", out.len(), grid.n_cells())));
    }
    // Beyond this the surface does not reach the cell.
    let clear = 0.5 * (D as f64).sqrt() * grid.cell() * steepness;
    let within: Vec<[f64; D]> = (0..samples.pow(D as u32))
        .map(|k| {
            let at = |a: usize| (k / samples.pow(a as u32) % samples) as f64;
            std::array::from_fn(|a| grid.cell() * ((at(a) + 0.5) / samples as f64 - 0.5))
        })
        .collect();
    let line = grid.counts()[D - 1];
    workers.try_for_each(out.chunks_mut(line).enumerate(), |(k, out)| {
        let centers: Vec<[f64; D]> = (0..line).map(|i| grid.center(k * line + i)).collect();
        solid(&centers, out)?;
        let (mut points, mut values) = (within.clone(), vec![0.0; within.len()]);
        for (value, center) in out.iter_mut().zip(centers) {
            if value.abs() >= clear {
                *value = f64::from(u8::from(*value < 0.0));
                continue;
            }
            for (point, off) in points.iter_mut().zip(&within) {
                *point = std::array::from_fn(|a| center[a] + off[a]);
            }
            solid(&points, &mut values)?;
            *value = values.iter().filter(|v| **v < 0.0).count() as f64 / values.len() as f64;
        }
        Ok(())
    })
}

/// The same of a simple solid.
pub fn fractions_of_solid<const D: usize>(
    grid: &Grid<D>,
    solid: &Solid<D>,
    samples: usize,
    out: &mut [f64],
    workers: &Workers,
) -> Result<()> {
    solid.check()?;
    let values = |points: &[[f64; D]], values: &mut [f64]| {
        values.iter_mut().zip(points).for_each(|(v, p)| *v = solid.signed_distance(*p));
        Ok(())
    };
    fractions(grid, values, &FractionOptions { samples, ..FractionOptions::default() }, out, workers)
}

/// The same of a closed mesh.
pub fn fractions_of_mesh<const D: usize>(
    grid: &Grid<D>,
    mesh: &DistanceTree<D>,
    samples: usize,
    out: &mut [f64],
    workers: &Workers,
) -> Result<()> {
    let values = |points: &[[f64; D]], values: &mut [f64]| mesh.signed_distances(points, values);
    fractions(grid, values, &FractionOptions { samples, ..FractionOptions::default() }, out, workers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shapes;

    #[test]
    fn fractions_sum_up_to_areas_and_volumes() {
        let workers = Workers::new(2).unwrap();
        let grid = Grid::new([-1.0, -1.1], 0.1, [20, 22]).unwrap();
        let area = |solid: Solid<2>| {
            let mut out = vec![0.0; grid.n_cells()];
            fractions_of_solid(&grid, &solid, 8, &mut out, &workers).unwrap();
            assert!(out.iter().all(|x| (0.0..=1.0).contains(x)));
            out.iter().sum::<f64>() * grid.measure()
        };
        let pi = std::f64::consts::PI;
        assert!((area(Solid::Ball { center: [0.03, 0.0], radius: 0.7 }) - pi * 0.49).abs() < 2e-3);
        assert!((area(Solid::Box(Bounds { min: [-0.5, -0.3], max: [0.25, 0.8] })) - 0.75 * 1.1).abs() < 1e-2);
        let strip = Solid::Cylinder { ends: [[-0.5, -0.5], [0.5, 0.4]], radius: 0.2 };
        assert!((area(strip) - 0.4 * 1.81_f64.sqrt()).abs() < 3e-3);

        let grid = Grid::new([-1.0; 3], 0.1, [20; 3]).unwrap();
        let mut out = vec![0.0; grid.n_cells()];
        let rod = Solid::Cylinder { ends: [[-0.4, 0.0, 0.1], [0.5, 0.1, 0.0]], radius: 0.3 };
        fractions_of_solid(&grid, &rod, 4, &mut out, &workers).unwrap();
        let volume = pi * 0.09 * 0.83_f64.sqrt();
        assert!((out.iter().sum::<f64>() * 1e-3 - volume).abs() < 4e-3);
    }

    #[test]
    fn fractions_of_a_mesh_are_those_of_its_solid() {
        let workers = Workers::caller_only();
        let mesh = shapes::sphere([0.0; 3], 0.7, 3).unwrap();
        let grid = Grid::new([-0.8; 3], 0.1, [16; 3]).unwrap();
        let mut out = vec![0.0; grid.n_cells()];
        fractions_of_mesh(&grid, mesh.distance_tree().unwrap(), 4, &mut out, &workers).unwrap();
        let volume = out.iter().sum::<f64>() * 1e-3;
        assert!((volume / (4.0 / 3.0 * std::f64::consts::PI * 0.343) - 1.0).abs() < 0.02, "{volume}");
        let told = fractions_of_mesh(&grid, mesh.distance_tree().unwrap(), 0, &mut out, &workers).unwrap_err();
        assert!(told.to_string().contains("0 samples"));
    }
}
