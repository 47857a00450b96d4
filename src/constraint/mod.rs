//! Constraints that an optimiser takes: samples of a design in level-set fields, placed by poses, aggregated, differentiated. Paper 000.
//!
//! Takes bodies, frames, fields; gives values to be kept at or above 0, Jacobians, products with them, and the Hessian of the Lagrangian.
//!
//! Notation: phi(x) > 0 where the design may be; p a sample in its frame; x_w = s R p + t its place in the world by a pose; z = M p + m its
//! place in a field's frame; D the diagonal of the field; rho the sharpness of an aggregate; lambda the multipliers of the values.
//!
//! | paper 000 | here |
//! |---|---|
//! | section 1, representative points of a design | [`body`], points that are variables: [`set`] |
//! | section 1, layout, shape, path | [`pose`], `relative`, [`set`] |
//! | section 3.5, aggregation | [`aggregation`] |
//! | beyond the paper: unions and intersections of feasible sets | [`region`] |
//! | the constraint phi(x_i) >= 0, with derivatives | `term`, `hessian`, `moments` |
//! | section 2.1, 2.2.3 with (1): the formulations of others | [`formulations`] |
//!
//! The paper keeps to translations and leaves the derivatives to its frameworks. Here all that poses do to a sample goes through the affine
//! map z = M p + m: derivatives are summed over the samples by its twelve numbers, so that a body of many points costs little more than
//! its points in the field, however many parameters its pose has: `moments`.
//!
//! A set of constraints is evaluated without allocation and without locks; any number of threads may share one.

#![forbid(unsafe_code)]

pub mod aggregation;
pub mod body;
mod exponential;
pub mod formulations;
mod hessian;
mod layout;
mod moments;
pub mod pose;
pub mod region;
mod relative;
pub mod set;
mod term;

pub use aggregation::{Aggregation, Derivatives, Extreme, Kind, Side, aggregate};
pub use body::Body;
pub use pose::{PoseKind, Rotation, Scale};
pub use region::Region;
pub use set::{Constraints, FrameId, PointsId, Size, WORLD};

#[cfg(test)]
mod tests;
