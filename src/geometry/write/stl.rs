//! STL, binary: 80 bytes of text, the count, then per triangle a normal, three corners in `f32`, two bytes of zero.

use crate::geometry::Mesh;
use crate::geometry::vec::{Vec3, normalized};
use crate::{Error, Result};
use std::io::{self, Write};

/// Must not begin with `solid`, as text does.
const HEADER: &[u8] = b"binary STL written by keepout";

/// Refuses vertices that leave the range of `f32`.
pub(super) fn check(mesh: &Mesh) -> Result<()> {
    let fits = |x: &f64| (*x as f32).is_finite();
    match mesh.vertices().iter().enumerate().find(|(_, v)| !v.iter().all(fits)) {
        None => Ok(()),
        Some((i, [x, y, z])) => Err(Error::InvalidArgument(format!(
            "vertex {i} is ({x}, {y}, {z}), but STL holds coordinates up to {:e}; write .ply or .obj, or choose another unit",
            f32::MAX
        ))),
    }
}

/// Writes `mesh`; a normal that the triangle does not have is 0.
pub(super) fn write(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    let mut header = [b' '; 80];
    header[..HEADER.len()].copy_from_slice(HEADER);
    out.write_all(&header)?;
    // A mesh has less than 2^31 triangles.
    out.write_all(&(mesh.triangles().len() as u32).to_le_bytes())?;
    for t in 0..mesh.triangles().len() {
        put(normalized(mesh.area_normal(t)).unwrap_or_default(), out)?;
        mesh.corners(t).into_iter().try_for_each(|p| put(p, out))?;
        out.write_all(&[0; 2])?;
    }
    Ok(())
}

fn put(v: Vec3, out: &mut impl Write) -> io::Result<()> {
    v.iter().try_for_each(|x| out.write_all(&(*x as f32).to_le_bytes()))
}
