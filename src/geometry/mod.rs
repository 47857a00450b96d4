//! Shapes: triangle meshes, oriented point clouds, and exact distances between them and points.
//!
//! Takes files or arrays; gives [`Mesh`], [`Cloud`] and numbers. All coordinates are in the caller's units: scaling by the
//! bounding-box diagonal D happens at the door of the room that needs it. Normals of a solid point out of it; signed distances
//! are positive outside.
//!
//! | source | here |
//! |---|---|
//! | paper 000 (1) and (2), signed distance | [`distance`] |
//! | paper 000, Algorithm 1, step 1 | [`sample`] |
//! | Ericson 2005, 5.1.5, closest point of a triangle | `triangle::closest` |
//! | van Oosterom and Strackee 1983, (8), solid angle | `triangle::solid_angle` |
//! | Jacobson et al. 2013, winding number | `winding::Winding::exact` |
//! | Barill et al. 2018, its far field; winding number of a cloud | `winding::Moments::far_field`; [`surfels`] |
//! | Wald 2007, binned surface area heuristic | `bvh` |
//! | Morton 1966, Z curve | `morton` |
//! | Yuksel 2015, sample elimination | `eliminate` |
//! | Thuermer and Wuethrich 1998, normals by angle | [`normals`] |
//! | Steele, Lea and Flood 2014, SplitMix64 | [`random`] |
//!
//! Where we depart: sides come from the winding number, not from the nearest normal as in (1), and sample elimination measures along
//! the surface.
//!
//! Notation: V vertices, T triangles, p a point, n a unit normal, b barycentric coordinates in a triangle (a, b, c).

#![forbid(unsafe_code)]

pub mod bounds;
mod bvh;
pub mod cloud;
pub mod distance;
mod edges;
mod eliminate;
pub mod mesh;
mod morton;
pub mod neighbours;
pub mod normals;
pub mod random;
pub mod read;
pub mod report;
pub mod sample;
pub mod shapes;
pub mod surfels;
mod triangle;
mod unit;
pub mod vec3;
mod winding;
pub mod write;

pub use bounds::Bounds;
pub use cloud::{Cloud, Origin};
pub use distance::{ClosestPoint, DistanceTree};
pub use mesh::Mesh;
pub use read::read;
pub use report::MeshReport;
