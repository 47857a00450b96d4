//! PLY, binary and little-endian: coordinates as `double`, indices as `uint`.

use crate::geometry::vec::Vec3;
use std::io::{self, Write};

/// Writes `vertices` [V x 3] and `triangles` [T x 3].
pub(super) fn write(vertices: &[Vec3], triangles: &[[u32; 3]], out: &mut impl Write) -> io::Result<()> {
    let (n_vertices, n_triangles) = (vertices.len(), triangles.len());
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\nelement vertex {n_vertices}\nproperty double x\nproperty double y\n\
         property double z\nelement face {n_triangles}\nproperty list uchar uint vertex_indices\nend_header\n"
    )?;
    for x in vertices.as_flattened() {
        out.write_all(&x.to_le_bytes())?;
    }
    for triangle in triangles {
        out.write_all(&[3])?;
        for v in triangle {
            out.write_all(&v.to_le_bytes())?;
        }
    }
    Ok(())
}
