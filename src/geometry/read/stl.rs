//! STL, binary and text. Equal vertices are merged, since the format repeats them; stored normals are left unread.

use super::builder::{self, check_corner_count, check_finite, push};
use super::fault::{Fault, Read};
use super::text::{Lines, Words, quote};
use super::weld::Welder;
use crate::error::{Place, try_with_capacity};
use crate::geometry::Mesh;
use crate::geometry::vec::Vec3;

/// Bytes before the first triangle: a free text of 80 and the count.
const HEADER: usize = 84;
/// Bytes of a triangle: normal, three corners, a spare field of 2.
const RECORD: usize = 50;

/// The mesh of an STL file.
pub(super) fn read(bytes: &[u8]) -> Read<Mesh> {
    // The size decides first: the free text of a binary file may begin with `solid` too.
    let announced = announced(bytes);
    if announced.is_some_and(|n| expected_size(n) == bytes.len() as u64) {
        return read_binary(bytes);
    }
    if is_text(bytes) {
        return read_text(bytes);
    }
    let len = bytes.len();
    Err(match announced {
        None => Fault::byte(len, format!("the file ends within its header; binary STL has {HEADER} bytes there")),
        Some(n) => {
            let verdict = if expected_size(n) > len as u64 { "cut short" } else { "followed by something else" };
            let expected = expected_size(n);
            Fault::byte(len, format!("{n} triangles are announced, so {expected} bytes; the data is {verdict}"))
        }
    })
}

fn announced(bytes: &[u8]) -> Option<u32> {
    bytes.get(80..HEADER)?.try_into().ok().map(u32::from_le_bytes)
}

fn expected_size(n: u32) -> u64 {
    HEADER as u64 + RECORD as u64 * u64::from(n)
}

fn is_text(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(1024)];
    let word = start.trim_ascii_start();
    // The count of a binary file holds a zero byte for all but absurd sizes.
    word.len() >= 5 && word[..5].eq_ignore_ascii_case(b"solid") && !start.contains(&0)
}

fn read_binary(bytes: &[u8]) -> Read<Mesh> {
    let records = bytes[HEADER..].chunks_exact(RECORD);
    let mut welder = Welder::default();
    let mut triangles = try_with_capacity(records.len(), "the triangles")?;
    for (i, record) in records.enumerate() {
        let mut triangle = [0; 3];
        for (k, corner) in triangle.iter_mut().enumerate() {
            let at = 12 + 12 * k;
            let p: Vec3 = std::array::from_fn(|a| f64::from(f32_at(record, at + 4 * a)));
            check_finite(p, 3 * i + k, Place::Byte(HEADER + RECORD * i + at))?;
            *corner = welder.number(p)?;
        }
        triangles.push(triangle);
    }
    builder::mesh(welder.into_vertices(), triangles)
}

fn f32_at(record: &[u8], at: usize) -> f32 {
    f32::from_le_bytes(std::array::from_fn(|i| record[at + i]))
}

fn read_text(bytes: &[u8]) -> Read<Mesh> {
    let mut words = Words::of(Lines::new(bytes));
    let mut solid = Facets::default();
    // A file may hold several solids, one after the other.
    while let Some(word) = words.next() {
        keyword(word, "solid", words.line())?;
        words.skip_line();
        loop {
            let word = words.expect("`facet` or `endsolid`")?;
            if word.eq_ignore_ascii_case(b"endsolid") {
                words.skip_line();
                break;
            }
            keyword(word, "facet", words.line())?;
            solid.facet(&mut words)?;
        }
    }
    builder::mesh(solid.welder.into_vertices(), solid.triangles)
}

fn keyword(word: &[u8], expected: &str, line: usize) -> Read<()> {
    if word.eq_ignore_ascii_case(expected.as_bytes()) {
        return Ok(());
    }
    Err(Fault::line(line, format!("`{expected}` was expected, found {}", quote(word))))
}

/// The facets of a text so far.
#[derive(Default)]
struct Facets {
    welder: Welder,
    triangles: Vec<[u32; 3]>,
    corners: Vec<u32>,
    n_facets: usize,
    n_vertices: usize,
}

impl Facets {
    /// Reads a facet after its first word.
    fn facet(&mut self, words: &mut Words) -> Read<()> {
        // The normal may be missing or not a number: some writers give `nan` to a triangle without area.
        words.skip_line();
        for expected in ["outer", "loop"] {
            let word = words.expect("`outer loop`")?;
            keyword(word, expected, words.line())?;
        }
        self.corners.clear();
        loop {
            let word = words.expect("`vertex` or `endloop`")?;
            if word.eq_ignore_ascii_case(b"endloop") {
                break;
            }
            keyword(word, "vertex", words.line())?;
            let p = [words.number("x")?, words.number("y")?, words.number("z")?];
            check_finite(p, self.n_vertices, Place::Line(words.line()))?;
            self.n_vertices += 1;
            let corner = self.welder.number(p)?;
            push(&mut self.corners, corner, "the corners of a facet")?;
        }
        let word = words.expect("`endfacet`")?;
        keyword(word, "endfacet", words.line())?;
        check_corner_count(self.corners.len(), self.n_facets, Place::Line(words.line()))?;
        self.n_facets += 1;
        for side in self.corners[1..].windows(2) {
            push(&mut self.triangles, [self.corners[0], side[0], side[1]], "the triangles")?;
        }
        Ok(())
    }
}
