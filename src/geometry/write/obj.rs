//! OBJ: a `v` line per vertex, then an `f` line per triangle, or an `l` line per segment. Numbers count from 1.

use std::io::{self, Write};

/// Writes `vertices` [V x D] and `facets` [F x D]: triangles in space, segments in the plane z = 0.
pub(super) fn write<const D: usize>(
    vertices: &[[f64; D]],
    facets: &[[u32; D]],
    out: &mut impl Write,
) -> io::Result<()> {
    for v in vertices {
        let [x, y, z]: [f64; 3] = std::array::from_fn(|a| v.get(a).copied().unwrap_or(0.0));
        // Debug's digits: as few as give the same number, with an exponent where there would be many zeros.
        writeln!(out, "v {x:?} {y:?} {z:?}")?;
    }
    let keyword = if D == 2 { "l" } else { "f" };
    for facet in facets {
        write!(out, "{keyword}")?;
        for &v in facet {
            write!(out, " {}", u64::from(v) + 1)?;
        }
        writeln!(out)?;
    }
    Ok(())
}
