//! Linear algebra: solving A x = b for symmetric positive definite operators that need not be matrices.
//!
//! Takes operators that can be applied to a vector; gives solutions with the residual that was reached, measured and not inferred.
//!
//! [`cg`] solves, with a preconditioner: [`multigrid`], say, on operators of ever coarser grids. [`dense`] has what is small.

#![forbid(unsafe_code)]

pub mod cg;
pub mod dense;
pub mod multigrid;
pub mod vector;
