//! Shapes: triangle meshes, oriented point clouds, and exact distances between them and points.
//!
//! Takes files or arrays; gives [`Mesh`], [`Cloud`] and numbers. All coordinates are in the caller's units: scaling by the
//! bounding-box diagonal D happens at the door of the room that needs it. Normals of a solid point out of it; signed distances
//! are positive outside.
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

pub use bounds::Bounds;
pub use cloud::{Cloud, Origin};
pub use distance::{ClosestPoint, DistanceTree};
pub use mesh::Mesh;
pub use read::read;
pub use report::MeshReport;
