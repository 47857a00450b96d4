//! OFF: the counts, a line per vertex, a line per triangle.

use crate::geometry::vec::Vec3;
use std::io::{self, Write};

/// Writes `vertices` [V x 3] and `triangles` [T x 3].
pub(super) fn write(vertices: &[Vec3], triangles: &[[u32; 3]], out: &mut impl Write) -> io::Result<()> {
    // The count of edges is there for old readers; none uses it.
    writeln!(out, "OFF\n{} {} 0", vertices.len(), triangles.len())?;
    for [x, y, z] in vertices {
        writeln!(out, "{x:?} {y:?} {z:?}")?;
    }
    for [a, b, c] in triangles {
        writeln!(out, "3 {a} {b} {c}")?;
    }
    Ok(())
}
