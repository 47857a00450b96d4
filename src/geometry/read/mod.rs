//! Meshes from files: OBJ, OFF, PLY and STL, each also packed with gzip.
//!
//! All have readers of their own, because the crates at hand give neither line nor byte of an error, and allocate what a header claims
//! or cannot say that memory ran out.
//!
//! What a reader promises, on any bytes: no panic, an error that names its line or byte, and memory in proportion to the
//! bytes that are there, never to the counts that a header claims. Polygons are cut into a fan around their first corner;
//! normals, colours, textures, groups and materials are left unread. Messages count vertices and faces from 0, save that
//! they quote the corners of an OBJ face as they stand there.
//!
//! | step | file |
//! |---|---|
//! | file to bytes, gzip | `load.rs` |
//! | bytes to words, with their lines | `text.rs` |
//! | words to vertices and faces | `obj.rs`, `off.rs`, `ply/`, `stl.rs` |
//! | equal vertices merged (STL) | `weld.rs` |
//! | checks, fans, the mesh | `builder.rs` |

mod builder;
mod fault;
mod load;
mod obj;
mod off;
mod ply;
mod stl;
mod text;
mod weld;

use std::path::Path;

use super::Mesh;
use crate::{Error, Result};
use fault::Fault;

/// Largest file that [`read`] takes, in bytes after unpacking: a small gzip file can hold any number of zeros.
pub const MAX_UNPACKED_BYTES: u64 = 4 << 30;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Obj,
    Off,
    Ply,
    Stl,
}

/// The mesh in the file at `path`. Its content tells the format where it can (gzip, OFF, PLY), its extension elsewhere.
pub fn read(path: &Path) -> Result<Mesh> {
    let bytes = load::load(path, MAX_UNPACKED_BYTES)?;
    let format = format_of(path, &bytes)?;
    parse(format, &bytes).map_err(|fault| fault.in_file(path))
}

impl Mesh {
    /// The mesh in the file at `path`: see [`read`].
    pub fn read(path: impl AsRef<Path>) -> Result<Mesh> {
        read(path.as_ref())
    }
}

fn parse(format: Format, bytes: &[u8]) -> std::result::Result<Mesh, Fault> {
    if bytes.is_empty() {
        return Err(Fault::whole("the file is empty"));
    }
    match format {
        Format::Obj => obj::read(bytes),
        Format::Off => off::read(bytes),
        Format::Ply => ply::read(bytes),
        Format::Stl => stl::read(bytes),
    }
}

fn format_of(path: &Path, bytes: &[u8]) -> Result<Format> {
    if ply::is_ply(bytes) {
        return Ok(Format::Ply);
    }
    if off::is_off(bytes) {
        return Ok(Format::Off);
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    match name.rsplit_once('.').map(|(_, extension)| extension) {
        Some("obj") => Ok(Format::Obj),
        Some("off") => Ok(Format::Off),
        Some("ply") => Ok(Format::Ply),
        Some("stl") => Ok(Format::Stl),
        _ => Err(Error::Unsupported(format!(
            "{}: no mesh format is known by this name; .obj, .off, .ply and .stl are read, each also with .gz",
            path.display()
        ))),
    }
}

#[cfg(test)]
mod tests;
