//! Shapes: meshes, triangles in space and segments in the plane, oriented point clouds, and exact distances between them and points.
//!
//! One path serves both dimensions, by a const D; `facet` holds what differs, and curves alone have [`polylines`] and their even samples
//! (`along_curves`). Takes files or arrays; gives [`Mesh`], [`Cloud`] and numbers. All coordinates are in the caller's units: scaling by
//! the bounding-box diagonal D happens at the door of the room that needs it. Normals of a solid point out of it; signed distances
//! are positive outside.
//!
//! | source | here |
//! |---|---|
//! | paper 000 (1) and (2), signed distance | [`distance`] |
//! | paper 000, Algorithm 1, step 1 | [`sample`] |
//! | Ericson 2005, 5.1.5, closest point of a triangle | `triangle::closest` |
//! | the same, 5.1.9, nearest points of segments; of triangles, and where these cross | `triangle_pair`, `pairs` |
//! | van Oosterom and Strackee 1983, (8), solid angle | `triangle::solid_angle` |
//! | Jacobson et al. 2013, winding number | `winding::Winding::exact` |
//! | Barill et al. 2018, its far field; winding number of a cloud | `winding::Moments::far_field`; [`surfels`] |
//! | how far the sides of an open shape mean something, after paper 000 (2) | [`sides`] |
//! | Wald 2007, binned surface area heuristic | `bvh` |
//! | paper 000, section 4.5, smoothing; Alexa et al. 2003, moving least squares | [`smooth`] |
//! | Morton 1966, Z curve | `morton` |
//! | Yuksel 2015, sample elimination | `eliminate` |
//! | Shewchuk 1997, exact orientation of three points | `predicate` |
//! | Thuermer and Wuethrich 1998, normals by angle | [`normals`] |
//! | Hoppe et al. 1992, normals of points that come without | [`orient`] |
//! | Steele, Lea and Flood 2014, SplitMix64 | [`random`] |
//! | clouds that follow their mesh, and derivatives by its vertices | `follow`, `pull_back` |
//!
//! Where we depart: sides come from the winding number, not from the nearest normal as in (1), and sample elimination measures along
//! the surface.
//!
//! Notation: V vertices, F facets: T triangles or S segments, p a point, n a unit normal, b barycentric coordinates in a facet.

#![forbid(unsafe_code)]

mod along_curves;
pub mod bounds;
mod bvh;
mod chains;
pub mod cloud;
mod components;
mod crossings;
pub mod distance;
pub(crate) mod edges;
mod eliminate;
pub(crate) mod facet;
mod follow;
pub(crate) mod matrix;
pub mod mesh;
mod morton;
pub mod neighbours;
mod nesting;
pub mod normals;
pub mod orient;
pub(crate) mod pairs;
pub mod polylines;
mod predicate;
mod pull_back;
pub mod random;
pub mod read;
pub mod report;
pub mod rigid;
mod rim;
pub mod sample;
mod segment;
pub mod shapes;
pub mod sides;
pub mod smooth;
pub mod surfels;
mod triangle;
pub(crate) mod triangle_pair;
mod unit;
pub mod vec;
mod winding;
pub mod write;

pub use bounds::Bounds;
pub use chains::Polylines;
pub use cloud::{Cloud, Origin};
pub(crate) use distance::HalfSpace;
pub use distance::{ClosestPoint, DistanceTree};
pub use mesh::Mesh;
pub use polylines::Ends;
pub use read::read;
pub use report::MeshReport;
pub use sides::Sides;
