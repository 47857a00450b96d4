//! The C ABI: the only door to C, and the only room where `unsafe` is allowed.
//!
//! One file per handle. Every entry has five beats: guard, handle, check, delegate, result. No mathematics happens here. The header
//! `include/keepout.h` is generated from these files; its conventions stand at its top, in `cbindgen.toml`.

// What a caller must keep to stands in each call's docs and at the top of the header, for all pointers alike.
#![allow(clippy::missing_safety_doc)]
// `values` [n_points] is a shape, not a link.
#![allow(rustdoc::broken_intra_doc_links)]

mod aggregation;
mod assembly;
mod body;
mod cells;
mod certify;
mod cloud;
mod constraints;
mod field;
mod fit_options;
mod formulations;
mod guard;
mod level_set;
mod mesh;
mod motion;
mod normals;
mod pair;
mod pair_contact;
mod pair_optimise;
mod pair_options;
mod pair_shapes;
mod part;
mod part_mesh;
mod pointer;
mod progress;
mod report;
mod sensitivity;
mod smooth;
mod status;
mod sweep;
mod version;

pub use aggregation::*;
pub use assembly::*;
pub use body::*;
pub use certify::*;
pub use cloud::*;
pub use constraints::*;
pub use field::*;
pub use fit_options::*;
pub use formulations::*;
pub use level_set::*;
pub use mesh::*;
pub use motion::*;
pub use normals::*;
pub use pair::*;
pub use pair_contact::*;
pub use pair_optimise::*;
pub use pair_options::*;
pub use pair_shapes::*;
pub use part::*;
pub use part_mesh::*;
pub use progress::*;
pub use report::*;
pub use sensitivity::*;
pub use smooth::*;
pub use status::*;
pub use sweep::*;
pub use version::*;
