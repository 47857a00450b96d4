//! The rows of four control points of a stencil, checked once: a check of each of the 16 took 8 ns of the 22 of a value.
//!
//! The only unsafe code of this room.

#![allow(unsafe_code)]

use super::kernel::Stencil;

/// The rows of a stencil in a tensor that holds all of them.
#[derive(Clone, Copy)]
pub struct Rows<'c> {
    tensor: &'c [f64],
    first: usize,
    /// Distance between layers along x, 0 in the plane, and between rows along y.
    strides: [usize; 2],
}

impl<'c> Rows<'c> {
    /// Those of `stencil`; panics where one reaches beyond the tensor.
    #[inline(always)]
    pub fn of<const D: usize>(stencil: &Stencil<D>, tensor: &'c [f64]) -> Self {
        let (first, strides) = (stencil.first, [if D == 3 { stencil.strides[0] } else { 0 }, stencil.strides[D - 2]]);
        // Of numbers below 2^60 the sum is below 2^63, so it does not wrap.
        let small = (first | strides[0] | strides[1]) >> 60 == 0;
        assert!(
            small && first + 3 * (strides[0] + strides[1]) + 4 <= tensor.len(),
            "a stencil reaches beyond its tensor"
        );
        Rows { tensor, first, strides }
    }

    /// The row of layer `i` along x and `j` along y, both at most 3.
    #[inline(always)]
    pub fn get(&self, i: usize, j: usize) -> &'c [f64; 4] {
        assert!(i < 4 && j < 4, "a stencil has rows 0 to 3");
        let start = self.first + i * self.strides[0] + j * self.strides[1];
        // SAFETY: `of` checked the row (3, 3), and no row of smaller i or j ends behind it.
        unsafe { &*self.tensor.as_ptr().add(start).cast() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_those_of_the_tensor() {
        let tensor: Vec<f64> = (0..8 * 6 * 5).map(f64::from).collect();
        let rows = Rows::of(&Stencil { first: 131, strides: [30, 5, 1] }, &tensor);
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            assert_eq!(rows.get(i, j)[..], tensor[131 + 30 * i + 5 * j..][..4]);
        }
    }

    #[test]
    #[should_panic(expected = "beyond its tensor")]
    fn rows_beyond_the_tensor_are_refused() {
        Rows::of(&Stencil { first: 132, strides: [30, 5, 1] }, &[0.0; 8 * 6 * 5 - 1]);
    }

    #[test]
    #[should_panic(expected = "beyond its tensor")]
    fn strides_that_wrap_are_refused() {
        Rows::of(&Stencil { first: 0, strides: [usize::MAX / 3, 5, 1] }, &[0.0; 240]);
    }
}
