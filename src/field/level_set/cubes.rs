//! The lattice of cubes on the box of a field.

use super::super::Lattice;
use super::CubeEdge;
use crate::spline::Axis;
use crate::{Error, Result};

/// Lattice vertices, row-major, the last axis contiguous.
#[derive(Debug, Clone)]
pub(super) struct Cubes<const D: usize> {
    /// Vertices along each axis: one more than cubes.
    pub shape: [usize; D],
    /// Distance in memory between neighbours along each axis.
    pub strides: [usize; D],
    /// Edge of a cube along each axis.
    pub edges: [f64; D],
    pub lower: [f64; D],
    pub upper: [f64; D],
}

impl<const D: usize> Cubes<D> {
    /// Each cell of `axes` cut into `subdivisions` along each axis.
    pub fn new(axes: [Axis; D], subdivisions: u32) -> Result<Self> {
        let s = subdivisions as usize;
        let shape = axes.map(|a| a.n_cells.saturating_mul(s).saturating_add(1));
        // The strides must not overflow before the memory limit refuses them.
        if shape.iter().map(|&n| n as u128).product::<u128>() >= 1 << 60 {
            return Err(Error::InvalidArgument(format!(
                "a lattice of {shape:?} points is beyond any memory; fewer subdivisions are needed"
            )));
        }
        let strides = std::array::from_fn(|a| shape[a + 1..].iter().product());
        let edges = axes.map(|a| a.cell / s as f64);
        Ok(Cubes { shape, strides, edges, lower: axes.map(|a| a.lower), upper: axes.map(|a| a.upper()) })
    }

    /// Lattice vertices.
    pub fn len(&self) -> usize {
        self.shape[0] * self.strides[0]
    }

    /// Cubes along each axis.
    pub fn counts(&self) -> [usize; D] {
        self.shape.map(|n| n - 1)
    }

    /// The vertices as a lattice of points.
    pub fn lattice(&self) -> Result<Lattice<D>> {
        let steps: Vec<[f64; D]> =
            (0..D).map(|a| std::array::from_fn(|b| if a == b { self.edges[a] } else { 0.0 })).collect();
        Lattice::new(self.lower, &steps, &self.shape)
    }

    /// The index of a lattice vertex along each axis.
    pub fn coordinates(&self, vertex: usize) -> [usize; D] {
        std::array::from_fn(|a| vertex / self.strides[a] % self.shape[a])
    }

    /// How far in memory the corner or step with these axis bits lies.
    pub fn offset(&self, bits: usize) -> usize {
        (0..D).filter(|a| bits >> a & 1 == 1).map(|a| self.strides[a]).sum()
    }

    /// The vector of a step along these axes.
    pub fn vector(&self, axes: usize) -> [f64; D] {
        std::array::from_fn(|a| if axes >> a & 1 == 1 { self.edges[a] } else { 0.0 })
    }

    /// The shortest edge of a cube.
    pub fn shortest_edge(&self) -> f64 {
        self.edges.iter().fold(f64::INFINITY, |m, &e| m.min(e))
    }

    /// Faces of the box that hold an edge of the lattice: bit a the lower face of axis a, bit D + a the upper.
    pub fn faces(&self, at: [usize; D], edge: CubeEdge) -> u8 {
        let across = (0..D).filter(|a| edge.axes >> a & 1 == 0);
        across.fold(0, |faces, a| {
            let (low, high) = (at[a] == 0, at[a] == self.shape[a] - 1);
            faces | u8::from(low) << a | u8::from(high) << (D + a)
        })
    }
}
