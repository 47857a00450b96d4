//! Fields on disk.
//!
//! A file is, all little-endian, with offsets in bytes:
//!
//! ```text
//!   0  magic, 8 bytes: 89 4B 4F 46 0D 0A 1A 0A; the line ends tell a transfer that changed them
//!   8  u32 version, 1
//!  12  u32 dimension, 3
//!  16  u32 control points along x, y, z
//!  28  u32 feasible side: 0 outside, 1 inside
//!  32  f64 lower corner of the box x, y, z
//!  56  f64 cell edge along x, y, z
//!  80  f64 diagonal D of the cloud
//!  88  u64 points of the cloud
//!  96  u32 iterations
//! 100  u32 zero
//! 104  f64 residual; seconds of assembly, solve, check; rms, max, mean gradient at the points
//! 160  f64 control points, row-major, z contiguous
//! end  u32 CRC-32 (IEEE 802.3) of all before
//! ```

use super::{Feasible, Field, FitReport};
use crate::Result;
use crate::error::{Error, Place, try_with_capacity};
use crate::replace::replace;
use crate::spline::{Axis, Grid};
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

const MAGIC: [u8; 8] = *b"\x89KOF\r\n\x1a\n";
const VERSION: u32 = 1;
const HEADER: usize = 160;
const CHECKSUM: usize = 4;

impl Field {
    /// Writes the field to `path`. What stood there is replaced whole or, on failure, left as it was.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        replace(path.as_ref(), |out| self.write_to(out))
    }

    /// Reads a field that [`Field::save`] wrote. It evaluates to the same bits.
    pub fn load(path: impl AsRef<Path>) -> Result<Field> {
        let path = path.as_ref();
        let io_error = |e: io::Error| Error::io(path, &e);
        let wrong = |place, message| Error::Format { path: path.to_owned(), place, message };
        let mut file = File::open(path).map_err(io_error)?;
        let mut header = Vec::with_capacity(HEADER);
        (&mut file).take(HEADER as u64).read_to_end(&mut header).map_err(io_error)?;
        let fields = parse_header(&header).map_err(|(place, message)| wrong(place, message))?;

        // The header's counts are believed only as far as the file is long.
        let n = fields.grid.axes.iter().map(|a| a.n_control() as u128).product::<u128>();
        let expected = HEADER as u128 + 8 * n + CHECKSUM as u128;
        let length = u128::from(file.metadata().map_err(io_error)?.len());
        if length != expected {
            let message =
                format!("the file has {length} bytes; its header announces {expected}: it is cut short or altered");
            return Err(wrong(Place::Whole, message));
        }
        let mut rest = try_with_capacity(expected as usize - HEADER, "the control points of the file")?;
        file.take(expected as u64).read_to_end(&mut rest).map_err(io_error)?;
        let Some((numbers, checksum)) = rest.split_last_chunk::<CHECKSUM>().filter(|(c, _)| c.len() as u128 == 8 * n)
        else {
            return Err(wrong(Place::Whole, "the file changed while it was read".into()));
        };
        let mut crc = crc32fast::Hasher::new();
        crc.update(&header);
        crc.update(numbers);
        let (found, stored) = (crc.finalize(), u32::from_le_bytes(*checksum));
        if found != stored {
            let message = format!("the checksum is {found:08x} where {stored:08x} is stored: the file is altered");
            return Err(wrong(Place::Whole, message));
        }
        let mut coefficients = try_with_capacity(n as usize, "the control points")?;
        coefficients.extend(numbers.as_chunks().0.iter().map(|c| f64::from_le_bytes(*c)));
        if let Some(i) = coefficients.iter().position(|c| !c.is_finite()) {
            let message = format!("control point {i} is {}; it must be finite", coefficients[i]);
            return Err(wrong(Place::Byte(HEADER + 8 * i), message));
        }
        Ok(Field::new(fields.grid, coefficients, fields.feasible, fields.diagonal, fields.report))
    }

    fn write_to(&self, out: &mut impl Write) -> io::Result<()> {
        let mut crc = crc32fast::Hasher::new();
        let mut put = |bytes: &[u8]| {
            crc.update(bytes);
            out.write_all(bytes)
        };
        put(&self.header())?;
        for c in &self.coefficients {
            put(&c.to_le_bytes())?;
        }
        out.write_all(&crc.finalize().to_le_bytes())
    }

    fn header(&self) -> Vec<u8> {
        let r = &self.report;
        let axes = &self.grid.axes;
        let side = match self.feasible {
            Feasible::Outside => 0u32,
            Feasible::Inside => 1,
        };
        let mut h = Vec::with_capacity(HEADER);
        h.extend(MAGIC);
        h.extend([VERSION, 3].iter().flat_map(|x| x.to_le_bytes()));
        h.extend(axes.iter().flat_map(|a| (a.n_control() as u32).to_le_bytes()));
        h.extend(side.to_le_bytes());
        h.extend(axes.iter().flat_map(|a| a.lower.to_le_bytes()));
        h.extend(axes.iter().flat_map(|a| a.cell.to_le_bytes()));
        h.extend(self.diagonal.to_le_bytes());
        h.extend(r.n_points.to_le_bytes());
        h.extend([r.iterations, 0].iter().flat_map(|x| x.to_le_bytes()));
        let figures = [r.residual, r.seconds_assembly, r.seconds_solve, r.seconds_check, r.rms, r.max, r.mean_gradient];
        h.extend(figures.iter().flat_map(|x| x.to_le_bytes()));
        debug_assert_eq!(h.len(), HEADER);
        h
    }
}

/// What a header says.
struct Header {
    grid: Grid,
    feasible: Feasible,
    diagonal: f64,
    report: FitReport,
}

/// Reads little-endian numbers one after the other.
struct Cursor<'a>(&'a [u8]);

impl Cursor<'_> {
    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let (head, tail) = self.0.split_first_chunk().expect("the header was measured");
        self.0 = tail;
        *head
    }

    fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.bytes())
    }

    fn u64(&mut self) -> u64 {
        u64::from_le_bytes(self.bytes())
    }

    fn f64(&mut self) -> f64 {
        f64::from_le_bytes(self.bytes())
    }
}

fn parse_header(header: &[u8]) -> std::result::Result<Header, (Place, String)> {
    if header.len() < HEADER {
        let message = format!("the file has {} bytes; a field has more than {HEADER}", header.len());
        return Err((Place::Whole, message));
    }
    let mut at = Cursor(header);
    if at.bytes() != MAGIC {
        return Err((Place::Byte(0), "this is no field: the file does not begin with its magic number".into()));
    }
    match at.u32() {
        VERSION => {}
        v => return Err((Place::Byte(8), format!("the file has version {v}; this library reads version {VERSION}"))),
    }
    match at.u32() {
        3 => {}
        d => return Err((Place::Byte(12), format!("the field has dimension {d}; this library reads dimension 3"))),
    }
    let control_points = [at.u32(), at.u32(), at.u32()];
    if let Some(n) = control_points.iter().find(|&&n| n < 4) {
        return Err((Place::Byte(16), format!("{n} control points along an axis; at least 4 are needed")));
    }
    let feasible = match at.u32() {
        0 => Feasible::Outside,
        1 => Feasible::Inside,
        s => return Err((Place::Byte(28), format!("the feasible side is {s}; 0 (outside) or 1 (inside) is right"))),
    };
    let lower: [f64; 3] = std::array::from_fn(|_| at.f64());
    let cell: [f64; 3] = std::array::from_fn(|_| at.f64());
    let diagonal = at.f64();
    // Neither the number nor its inverse may leave the range of doubles.
    let usable = |x: f64| x > 0.0 && x.is_normal() && x.recip().is_normal();
    if !(lower.iter().all(|x| x.is_finite()) && cell.iter().all(|&c| usable(c)) && usable(diagonal)) {
        let message = "the box is not finite, or an edge or the diagonal is no normal number above 0".into();
        return Err((Place::Byte(32), message));
    }
    let axes =
        std::array::from_fn(|a| Axis { lower: lower[a], cell: cell[a], n_cells: control_points[a] as usize - 3 });
    let n_points = at.u64();
    let iterations = at.u32();
    if at.u32() != 0 {
        return Err((
            Place::Byte(100),
            "bytes that must be 0 are not: the file is of a newer version, or altered".into(),
        ));
    }
    let report = FitReport {
        control_points,
        n_points,
        n_unknowns: control_points.iter().fold(1u64, |n, &c| n.saturating_mul(u64::from(c))),
        iterations,
        residual: at.f64(),
        seconds_assembly: at.f64(),
        seconds_solve: at.f64(),
        seconds_check: at.f64(),
        rms: at.f64(),
        max: at.f64(),
        mean_gradient: at.f64(),
    };
    Ok(Header { grid: Grid { axes }, feasible, diagonal, report })
}
