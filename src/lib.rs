//! Keepout keeps shapes from running into each other inside gradient-based design optimisation.
//!
//! A shape is read ([`geometry`]), sampled into an oriented point cloud, and a smooth level-set function is fitted to it once
//! ([`field`]); an optimiser then evaluates value, gradient and Hessian at any number of points, at a cost that does not depend
//! on the shape. The method is that of Dunn et al., "Scalable enforcement of geometric non-interference constraints for
//! gradient-based optimization" (2023), called *paper 000* in this crate; where we depart from it, the room's page says why.
//!
//! | room | takes | gives |
//! |---|---|---|
//! | [`geometry`] | files, arrays | meshes, reports, oriented clouds, exact signed distances |
//! | [`spline`] | a box and a resolution | uniform cubic B-splines, exact Gram matrices, operators on control points, evaluation |
//! | [`linalg`] | operators | solutions by conjugate gradients, preconditioned by multigrid |
//! | [`field`] | a cloud | a level-set field: fit, evaluation, file |
//! | [`constraint`] | bodies, poses, fields | constraints with Jacobians and Hessians, aggregates |
//! | [`cogen`] | two grids of cells and a motion | collision measures, pairs of parts that never collide |
//! | [`dimension`], [`error`], [`isa`], [`par`], [`progress`] | | what all share: plane or space, errors, instructions, threads, progress |
//! | `ffi` | all of the above | `libkeepout`, the C ABI of `include/keepout.h` |
//!
//! Data flows one way, top to bottom. No room but `ffi` knows that C exists.
//!
//! Unsafe code is in `ffi` for the pointers of C, in [`isa`] for instructions, in `pages` for a hint to the system, in [`spline::rows`] for
//! rows that were checked before, and nowhere else.

pub mod cogen;
pub mod constraint;
pub mod dimension;
pub mod error;
pub mod ffi;
pub mod field;
pub mod geometry;
pub mod isa;
pub mod linalg;
mod pages;
pub mod par;
pub mod progress;
mod replace;
pub mod spline;

pub use error::{Error, Result};
