//! Fields on disk.
//!
//! A file is, all little-endian, with offsets in bytes:
//!
//! ```text
//!   0  magic, 8 bytes: 89 4B 4F 46 0D 0A 1A 0A; the line ends tell a transfer that changed them
//!   8  u32 version, 1 of one grid
//!  12  u32 dimension, 2 or 3; in the plane what is said of z below is 0
//!  16  u32 control points along x, y, z
//!  28  u32 feasible side: 0 outside, 1 inside
//!  32  f64 lower corner of the box x, y, z
//!  56  f64 cell edge along x, y, z
//!  80  f64 diagonal D of the cloud
//!  88  u64 points of the cloud
//!  96  u32 iterations
//! 100  u32 outliers that a robust fit left out
//! 104  f64 residual; seconds of assembly, solve, check; rms, max, mean gradient at the points
//! 160  f64 control points, row-major, the last axis contiguous
//! end  u32 CRC-32 (IEEE 802.3) of all before
//! ```
//!
//! A refined field has version 2, counts and cells of the grid that was refined, and from 160 on
//!
//! ```text
//! 160  u64 tiles that were cut, n
//! 168  u32 their indices [n], in the order of the cuts: see [`Tree`]
//! then f64 control points of the active functions, in the order of [`Space`]
//! end  u32 CRC-32 of all before
//! ```

use super::refined::Refined;
use super::{Feasible, Field, FitReport, domain, unusable};
use crate::Result;
use crate::dimension::OfDimension;
use crate::error::{Error, Place, try_with_capacity};
use crate::replace::replace;
use crate::spline::hierarchical::Space;
use crate::spline::tree::Tree;
use crate::spline::{Axis, Grid};
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

const MAGIC: [u8; 8] = *b"\x89KOF\r\n\x1a\n";
const VERSION: u32 = 1;
const REFINED: u32 = 2;
const HEADER: usize = 160;
const CHECKSUM: usize = 4;

impl<const D: usize> Field<D> {
    /// Writes the field to `path`. What stood there is replaced whole or, on failure, left as it was.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let cuts = self.refined.as_ref().map(|r| r.tree().cuts()).transpose()?;
        replace(path.as_ref(), |out| self.write_to(cuts.as_deref(), out))
    }

    /// [`load`], for a field whose dimension is known.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let (header, content) = read(path)?;
        if header.dimension == D {
            return header.field(path, content);
        }
        let message = format!("the field has dimension {}; {D} is asked for", header.dimension);
        Err(Error::Format { path: path.to_owned(), place: Place::Byte(12), message })
    }

    /// `cuts` are those of a refined field.
    fn write_to(&self, cuts: Option<&[u32]>, out: &mut impl Write) -> io::Result<()> {
        let mut crc = crc32fast::Hasher::new();
        let mut put = |bytes: &[u8]| {
            crc.update(bytes);
            out.write_all(bytes)
        };
        put(&self.header())?;
        if let Some(cuts) = cuts {
            put(&(cuts.len() as u64).to_le_bytes())?;
            for cut in cuts {
                put(&cut.to_le_bytes())?;
            }
        }
        for c in self.refined.as_ref().map_or(&self.coefficients[..], |r| r.active()) {
            put(&c.to_le_bytes())?;
        }
        out.write_all(&crc.finalize().to_le_bytes())
    }

    fn header(&self) -> Vec<u8> {
        let r = &self.report;
        // In the plane what belongs to z is 0.
        let along = |f: fn(&Axis) -> f64| [0, 1, 2].map(|a| self.grid.axes.get(a).map_or(0.0, f));
        let side = match self.feasible {
            Feasible::Outside => 0u32,
            Feasible::Inside => 1,
        };
        let mut h = Vec::with_capacity(HEADER);
        h.extend(MAGIC);
        let version = if self.is_refined() { REFINED } else { VERSION };
        h.extend([version, D as u32].iter().flat_map(|x| x.to_le_bytes()));
        h.extend(r.control_points.iter().flat_map(|n| n.to_le_bytes()));
        h.extend(side.to_le_bytes());
        h.extend(along(|a| a.lower).iter().chain(&along(|a| a.cell)).flat_map(|x| x.to_le_bytes()));
        h.extend(self.diagonal.to_le_bytes());
        h.extend(r.n_points.to_le_bytes());
        h.extend([r.iterations, u32::try_from(r.n_outliers).unwrap_or(u32::MAX)].iter().flat_map(|x| x.to_le_bytes()));
        let figures = [r.residual, r.seconds_assembly, r.seconds_solve, r.seconds_check, r.rms, r.max, r.mean_gradient];
        h.extend(figures.iter().flat_map(|x| x.to_le_bytes()));
        debug_assert_eq!(h.len(), HEADER);
        h
    }
}

/// Reads a field that [`Field::save`] wrote, of the dimension that the file tells. It evaluates to the same bits.
pub fn load(path: impl AsRef<Path>) -> Result<OfDimension<Field<2>, Field<3>>> {
    let path = path.as_ref();
    let (header, content) = read(path)?;
    Ok(match header.dimension {
        2 => OfDimension::Plane(header.field(path, content)?),
        _ => OfDimension::Space(header.field(path, content)?),
    })
}

/// What comes after a header.
struct Content {
    /// Of a refined field.
    cuts: Option<Vec<u32>>,
    control_points: Vec<f64>,
}

/// A file that is read.
struct Source<'a> {
    path: &'a Path,
    file: File,
    /// Bytes in all.
    length: u128,
    /// Of what was read.
    crc: crc32fast::Hasher,
}

/// The header and the rest of the file at `path`.
fn read(path: &Path) -> Result<(Header, Content)> {
    let mut source = Source::open(path)?;
    let header = source.header()?;
    let n_cuts = source.check_length(&header)?;
    let numbers = source.rest(if header.refined { HEADER + 8 } else { HEADER })?;
    let (cuts, numbers) = numbers.split_at(4 * n_cuts.unwrap_or(0) as usize);
    let cuts = n_cuts.map(|_| integers(cuts)).transpose()?;
    let control_points = source.control_points(numbers)?;
    Ok((header, Content { cuts, control_points }))
}

impl<'a> Source<'a> {
    fn open(path: &'a Path) -> Result<Self> {
        let io_error = |e: io::Error| Error::io(path, &e);
        let file = File::open(path).map_err(io_error)?;
        let length = u128::from(file.metadata().map_err(io_error)?.len());
        Ok(Source { path, file, length, crc: crc32fast::Hasher::new() })
    }

    fn wrong(&self, place: Place, message: String) -> Error {
        Error::Format { path: self.path.to_owned(), place, message }
    }

    fn too_short(&self, expected: u128) -> Error {
        let length = self.length;
        let message =
            format!("the file has {length} bytes; its header announces {expected}: it is cut short or altered");
        self.wrong(Place::Whole, message)
    }

    fn header(&mut self) -> Result<Header> {
        let mut header = Vec::with_capacity(HEADER);
        (&mut self.file).take(HEADER as u64).read_to_end(&mut header).map_err(|e| Error::io(self.path, &e))?;
        self.crc.update(&header);
        parse_header(&header).map_err(|(place, message)| self.wrong(place, message))
    }

    /// The header's counts are believed only as far as the file is long. Gives the number of cuts of a refined field, which it reads.
    fn check_length(&mut self, header: &Header) -> Result<Option<u64>> {
        let n_control = header.control_points[..header.dimension].iter().map(|&n| u128::from(n)).product::<u128>();
        let of_grid = HEADER as u128 + 8 * n_control + CHECKSUM as u128;
        if !header.refined {
            return if self.length == of_grid { Ok(None) } else { Err(self.too_short(of_grid)) };
        }
        let mut count = [0; 8];
        self.file.read_exact(&mut count).map_err(|_| self.too_short(HEADER as u128 + 8))?;
        self.crc.update(&count);
        let n_cuts = u64::from_le_bytes(count);
        // A cut is an index, and leaves 2^D - 1 functions more than there were, at least.
        let of_cut = 4 + 8 * ((1 << header.dimension) - 1);
        let least = of_grid + 8 + u128::from(n_cuts) * of_cut;
        if self.length < least { Err(self.too_short(least)) } else { Ok(Some(n_cuts)) }
    }

    /// What comes after the first `begun` bytes, but for the checksum, which it has.
    fn rest(&mut self, begun: usize) -> Result<Vec<u8>> {
        let left = self.length - begun as u128;
        let mut rest = try_with_capacity(left as usize, "the control points of the file")?;
        (&mut self.file).take(self.length as u64).read_to_end(&mut rest).map_err(|e| Error::io(self.path, &e))?;
        let Some((numbers, checksum)) = rest.split_last_chunk::<CHECKSUM>().filter(|_| rest.len() as u128 == left)
        else {
            return Err(self.wrong(Place::Whole, "the file changed while it was read".into()));
        };
        self.crc.update(numbers);
        let (found, stored) = (self.crc.clone().finalize(), u32::from_le_bytes(*checksum));
        if found != stored {
            let message = format!("the checksum is {found:08x} where {stored:08x} is stored: the file is altered");
            return Err(self.wrong(Place::Whole, message));
        }
        rest.truncate(rest.len() - CHECKSUM);
        Ok(rest)
    }

    /// The control points with which the file ends, but for its checksum.
    fn control_points(&self, bytes: &[u8]) -> Result<Vec<f64>> {
        if !bytes.len().is_multiple_of(8) {
            return Err(self.wrong(Place::Whole, "the control points are no whole number: the file is altered".into()));
        }
        let mut control_points = try_with_capacity(bytes.len() / 8, "the control points")?;
        control_points.extend(bytes.as_chunks().0.iter().map(|c| f64::from_le_bytes(*c)));
        if let Some((i, message)) = unusable(&control_points) {
            let first = self.length as usize - CHECKSUM - bytes.len();
            return Err(self.wrong(Place::Byte(first + 8 * i), message));
        }
        Ok(control_points)
    }
}

/// The indices of cuts.
fn integers(bytes: &[u8]) -> Result<Vec<u32>> {
    let mut indices = try_with_capacity(bytes.len() / 4, "the cut tiles")?;
    indices.extend(bytes.as_chunks().0.iter().map(|c| u32::from_le_bytes(*c)));
    Ok(indices)
}

/// What a header says.
struct Header {
    refined: bool,
    dimension: usize,
    control_points: [u32; 3],
    lower: [f64; 3],
    cell: [f64; 3],
    feasible: Feasible,
    diagonal: f64,
    report: FitReport,
}

impl Header {
    fn check_box(&self) -> std::result::Result<(), Wrong> {
        let Header { dimension, control_points, lower, cell, diagonal, .. } = self;
        // Neither the number nor its inverse may leave the range of doubles.
        let usable = |x: f64| x > 0.0 && x.is_normal() && x.recip().is_normal();
        if !(lower.iter().all(|x| x.is_finite()) && cell[..*dimension].iter().all(|&c| usable(c)) && usable(*diagonal))
        {
            let message = "the box is not finite, or an edge or the diagonal is no normal number above 0".into();
            return Err((Place::Byte(32), message));
        }
        if *dimension == 2 && (control_points[2] != 0 || lower[2] != 0.0 || cell[2] != 0.0) {
            let message = "the field is of the plane, but has entries along z, which must be 0".into();
            return Err((Place::Byte(16), message));
        }
        Ok(())
    }

    /// The field of the file at `path` with these control points, in the header's dimension.
    fn field<const D: usize>(mut self, path: &Path, content: Content) -> Result<Field<D>> {
        debug_assert_eq!(self.dimension, D);
        let axis =
            |a: usize| Axis { lower: self.lower[a], cell: self.cell[a], n_cells: self.control_points[a] as usize - 3 };
        let grid = Grid { axes: std::array::from_fn(axis) };
        domain::check(&grid, self.diagonal).map_err(|error| Error::Format {
            path: path.to_owned(),
            place: Place::Byte(32),
            message: error.to_string(),
        })?;
        let Content { cuts, control_points } = content;
        let Some(cuts) = cuts else {
            return Ok(Field::new(grid, control_points, self.feasible, self.diagonal, self.report));
        };
        let wrong = |place, message| Error::Format { path: path.to_owned(), place, message };
        let mut tree = Tree::new(grid)?;
        for (i, cut) in cuts.iter().enumerate() {
            if !tree.cut_index(*cut)? {
                let message = format!("cut {i} is of tile {cut}, which is none, or is cut already");
                return Err(wrong(Place::Byte(HEADER + 8 + 4 * i), message));
            }
        }
        let space = Space::new(&tree)?;
        let (n, active) = (control_points.len(), space.n_active());
        if n != active {
            let message = format!("the file has {n} control points; its cells have {active}");
            return Err(wrong(Place::Whole, message));
        }
        (self.report.n_unknowns, self.report.n_levels) = (active as u64, tree.n_levels());
        let refined = Refined::new(tree, &space, control_points)?;
        Ok(Field::of_refined(refined, self.feasible, self.diagonal, self.report))
    }
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

/// Where a header is wrong, and what is.
type Wrong = (Place, String);

fn parse_header(header: &[u8]) -> std::result::Result<Header, Wrong> {
    if header.len() < HEADER {
        let message = format!("the file has {} bytes; a field has more than {HEADER}", header.len());
        return Err((Place::Whole, message));
    }
    let mut at = Cursor(header);
    let refined = parse_version(&mut at)?;
    let dimension = match at.u32() {
        d @ (2 | 3) => d as usize,
        d => return Err((Place::Byte(12), format!("the field has dimension {d}; it must be 2 or 3"))),
    };
    let control_points = [at.u32(), at.u32(), at.u32()];
    if let Some(n) = control_points[..dimension].iter().find(|&&n| n < 4) {
        return Err((Place::Byte(16), format!("{n} control points along an axis; at least 4 are needed")));
    }
    let feasible = match at.u32() {
        0 => Feasible::Outside,
        1 => Feasible::Inside,
        s => return Err((Place::Byte(28), format!("the feasible side is {s}; 0 (outside) or 1 (inside) is right"))),
    };
    let (lower, cell) = ([at.f64(), at.f64(), at.f64()], [at.f64(), at.f64(), at.f64()]);
    let diagonal = at.f64();
    let report = parse_report(&mut at, control_points);
    let header = Header { refined, dimension, control_points, lower, cell, feasible, diagonal, report };
    header.check_box()?;
    Ok(header)
}

/// Whether the field is refined, by its version.
fn parse_version(at: &mut Cursor) -> std::result::Result<bool, Wrong> {
    if at.bytes() != MAGIC {
        return Err((Place::Byte(0), "this is no field: the file does not begin with its magic number".into()));
    }
    match at.u32() {
        VERSION => Ok(false),
        REFINED => Ok(true),
        v => {
            let message = format!("the file has version {v}; this library reads versions {VERSION} and {REFINED}");
            Err((Place::Byte(8), message))
        }
    }
}

/// What the header says of the fit, as far as files keep it, of a grid of `control_points`.
fn parse_report(at: &mut Cursor, control_points: [u32; 3]) -> FitReport {
    let n_points = at.u64();
    let iterations = at.u32();
    let n_outliers = u64::from(at.u32());
    FitReport {
        control_points,
        n_points,
        // Along z 0 in the plane.
        n_unknowns: control_points.iter().fold(1u64, |n, &c| n.saturating_mul(u64::from(c.max(1)))),
        n_outliers,
        n_levels: 1,
        clear_sides: f64::NAN,
        iterations,
        residual: at.f64(),
        convergence_rate: f64::NAN,
        seconds_assembly: at.f64(),
        seconds_solve: at.f64(),
        seconds_check: at.f64(),
        rms: at.f64(),
        max: at.f64(),
        mean_gradient: at.f64(),
    }
}
