//! Meshes to files: OBJ, OFF, PLY and STL. What stood at a path is replaced whole or, on failure, left as it was.
//!
//! | format | holds | read back |
//! |---|---|---|
//! | OBJ, OFF | text, the shortest digits that give the same `f64` | the same bits |
//! | PLY | binary, little-endian, `double` | the same bits |
//! | STL | binary, `f32`, each triangle with its own corners | rounded; vertices that round to one are one |
//!
//! Curves in the plane, as segments, are written as OBJ: `l` lines, z = 0.

mod obj;
mod off;
mod ply;
mod stl;
#[cfg(test)]
mod tests;

use super::Mesh;
use crate::replace::replace;
use crate::{Error, Result};
use std::path::Path;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Obj,
    Off,
    Ply,
    Stl,
}

impl Mesh<3> {
    /// Writes the mesh to `path`, in the format that its ending names: .obj, .off, .ply or .stl, in small letters or capitals. See
    /// [`write`](self). [`Error::Unsupported`] on another ending, [`Error::InvalidArgument`] on a coordinate that STL cannot hold; both
    /// before the file is touched.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let (vertices, triangles) = (self.vertices(), self.triangles());
        match format_of(path)? {
            Format::Obj => replace(path, |out| obj::write(vertices, triangles, out)),
            Format::Off => replace(path, |out| off::write(vertices, triangles, out)),
            Format::Ply => replace(path, |out| ply::write(vertices, triangles, out)),
            Format::Stl => {
                stl::check(self)?;
                replace(path, |out| stl::write(self, out))
            }
        }
    }
}

impl Mesh<2> {
    /// Writes the curves to the OBJ file at `path`, as `l` lines. [`Error::Unsupported`] on another ending than .obj, before the file is
    /// touched.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        match format_of(path) {
            Ok(Format::Obj) => replace(path, |out| obj::write(self.vertices(), self.segments(), out)),
            _ => Err(Error::Unsupported(format!("{}: curves are written to files that end in .obj", path.display()))),
        }
    }
}

fn format_of(path: &Path) -> Result<Format> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    match extension.as_str() {
        "obj" => Ok(Format::Obj),
        "off" => Ok(Format::Off),
        "ply" => Ok(Format::Ply),
        "stl" => Ok(Format::Stl),
        _ => Err(Error::Unsupported(format!(
            "{}: meshes are written to files that end in .obj, .off, .ply or .stl",
            path.display()
        ))),
    }
}
