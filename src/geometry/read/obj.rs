//! OBJ, parsed by the crate `tobj`.
//!
//! `tobj` numbers vertices as faces first use them, per group and material, and names no places. So it sees plain `v` and
//! `f` lines only, after a face of our own that uses every vertex in turn: its numbers are then those of the file. A fault
//! that it finds is looked up in the text once more.
//!
//! Weights and colours after the coordinates are left unread. A file cut within its last number passes for a whole one.

use std::io::{self, BufRead};

use tobj::{LoadError, LoadOptions};

use super::builder::{self, check_corner_count, check_finite, check_vertex_count};
use super::fault::{Fault, Read};
use super::text::{Lines, number, quote, without_comment, words};
use crate::error::{Place, try_with_capacity};
use crate::geometry::Mesh;
use crate::geometry::vec::Vec3;

/// The mesh of an OBJ file.
pub(super) fn read(text: &[u8]) -> Read<Mesh> {
    // `tobj` cannot report that memory ran out, so ask first: its faces and maps take up to this many times the text.
    drop(try_with_capacity::<[u8; 64]>(text.len(), "reading OBJ")?);
    let mut lines = PlainLines::new(text);
    while lines.advance()?.is_some() {}
    let n_vertices = lines.n_vertices;
    check_vertex_count(n_vertices)?;
    if lines.n_faces == 0 || n_vertices == 0 {
        return Err(Fault::whole(format!(
            "the file has {n_vertices} vertices and {} faces; at least 1 face is needed",
            lines.n_faces
        )));
    }
    let mut lines = PlainLines::new(text);
    let n_extra = lines.put_face_of_all(n_vertices)?;
    let options = LoadOptions { single_index: true, triangulate: true, ..LoadOptions::default() };
    let loaded = tobj::load_obj_buf(&mut lines, &options, |_| Err(LoadError::GenericFailure));
    let (models, _) = loaded.map_err(|error| explain(error, &lines, text, n_vertices))?;
    let Some(mesh) = models.into_iter().next().map(|model| model.mesh) else {
        return Err(Fault::whole("no mesh was found"));
    };
    let vertices: Vec<Vec3> = mesh.positions.as_chunks().0.to_vec();
    if vertices.iter().flatten().any(|x| !x.is_finite()) {
        find_vertex_not_finite(text)?;
    }
    builder::mesh(vertices, mesh.indices.as_chunks().0[n_extra..].to_vec())
}

/// What a line says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Vertex,
    Face,
}

/// The `v` and `f` lines of a text without what a mesh can do without: `f 1/2/3 4/5/6 7` becomes `f 1 4 7`.
struct PlainLines<'a> {
    lines: Lines<'a>,
    /// The plain line now read, and how much of it is.
    plain: Vec<u8>,
    read: usize,
    /// Number in the file of the line now read.
    line: usize,
    n_vertices: usize,
    n_faces: usize,
}

impl<'a> PlainLines<'a> {
    fn new(text: &'a [u8]) -> Self {
        let lines = Lines::new(text);
        PlainLines { lines, plain: Vec::new(), read: 0, line: 1, n_vertices: 0, n_faces: 0 }
    }

    /// Puts before the lines a face that uses vertices 1 to `n` in turn; gives the number of its triangles.
    fn put_face_of_all(&mut self, n: usize) -> Read<usize> {
        const LONGEST: usize = " 4294967295".len();
        self.plain = try_with_capacity(LONGEST * (n + 3), "numbering the vertices of OBJ")?;
        self.plain.push(b'f');
        // With fewer than 3 vertices, the last stands for the missing corners.
        for i in 1..=n.max(3) {
            self.plain.extend_from_slice(format!(" {}", i.min(n)).as_bytes());
        }
        self.plain.push(b'\n');
        Ok(n.max(3) - 2)
    }

    /// Moves to the next plain line; `None` at the end.
    fn advance(&mut self) -> Read<Option<Kind>> {
        self.plain.clear();
        self.read = 0;
        while let Some((line, content)) = self.lines.next() {
            let content = without_comment(content);
            let kind = match words(content).next() {
                Some(b"v") => Kind::Vertex,
                Some(b"f") => Kind::Face,
                _ => continue,
            };
            self.line = line;
            let n_words = self.copy(kind, content);
            self.plain.push(b'\n');
            match kind {
                Kind::Vertex => self.n_vertices += 1,
                Kind::Face => {
                    check_corner_count(n_words - 1, self.n_faces, Place::Line(line))?;
                    self.n_faces += 1;
                }
            }
            return Ok(Some(kind));
        }
        Ok(None)
    }

    /// Copies what is needed of a line, and of those that a backslash at the end joins to it; gives the words in it.
    fn copy(&mut self, kind: Kind, mut content: &'a [u8]) -> usize {
        let wanted = if kind == Kind::Vertex { 4 } else { usize::MAX };
        let mut n_words = 0;
        loop {
            let joined = content.trim_ascii_end().strip_suffix(b"\\");
            for word in words(joined.unwrap_or(content)) {
                if n_words < wanted {
                    self.plain.extend_from_slice(if kind == Kind::Face { position(word) } else { word });
                    self.plain.push(b' ');
                }
                n_words += 1;
            }
            match joined.and_then(|_| self.lines.next()) {
                Some((_, next)) => content = without_comment(next),
                None => return n_words,
            }
        }
    }

    /// The words after the keyword of the line now read.
    fn arguments(&self) -> impl Iterator<Item = &[u8]> {
        words(&self.plain).skip(1)
    }
}

/// The vertex number of a corner, texture and normal left out; a corner without one stays as it is, to be refused.
fn position(corner: &[u8]) -> &[u8] {
    corner.split(|&b| b == b'/').next().filter(|number| !number.is_empty()).unwrap_or(corner)
}

impl io::Read for PlainLines<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let n = self.fill_buf()?.read(into)?;
        self.consume(n);
        Ok(n)
    }
}

impl BufRead for PlainLines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.read == self.plain.len() {
            self.advance().map_err(|_| io::ErrorKind::InvalidData)?;
        }
        Ok(&self.plain[self.read..])
    }

    fn consume(&mut self, n: usize) {
        self.read += n;
    }
}

/// The fault behind an error of `tobj`, which had got as far as `lines`.
fn explain(error: LoadError, lines: &PlainLines, text: &[u8], n_vertices: usize) -> Fault {
    let (line, found) = (lines.line, quote(lines.plain.trim_ascii()));
    match error {
        LoadError::ReadError => Fault::line(line, format!("{found} is no text")),
        LoadError::PositionParseError => {
            Fault::line(line, format!("a vertex needs 3 coordinates, as in `v 0 1 2`; found {found}"))
        }
        LoadError::FaceParseError => {
            Fault::line(line, format!("a face needs the numbers of its vertices, as in `f 1 2 3`; found {found}"))
        }
        LoadError::FaceVertexOutOfBounds => match find_corner_out_of_range(text, n_vertices) {
            Err(fault) => fault,
            Ok(()) => Fault::whole("a face names a vertex that the file does not have"),
        },
        other => Fault::line(line, other.to_string()),
    }
}

/// Reports the first corner that names none of the `n` vertices of the file.
fn find_corner_out_of_range(text: &[u8], n: usize) -> Read<()> {
    let mut lines = PlainLines::new(text);
    while let Some(kind) = lines.advance()? {
        if kind == Kind::Vertex {
            continue;
        }
        let face = lines.n_faces - 1;
        for word in lines.arguments() {
            let Some(corner) = number::<i64>(word) else {
                return Err(Fault::line(
                    lines.line,
                    format!("face {face} has a corner without vertex, {}", quote(word)),
                ));
            };
            // Negative numbers count back from the vertex before the face.
            let first = -(lines.n_vertices as i64);
            if corner < first || corner == 0 || corner > n as i64 {
                let range = format!("1 to {n}, or {first} to -1 here, are there");
                return Err(Fault::line(lines.line, format!("face {face} names vertex {corner}; {range}")));
            }
        }
    }
    Ok(())
}

/// Reports the first vertex that is not finite.
fn find_vertex_not_finite(text: &[u8]) -> Read<()> {
    let mut lines = PlainLines::new(text);
    while let Some(kind) = lines.advance()? {
        if kind == Kind::Vertex {
            let mut words = lines.arguments();
            let p = std::array::from_fn(|_| words.next().and_then(number).unwrap_or(0.0));
            check_finite(p, lines.n_vertices - 1, Place::Line(lines.line))?;
        }
    }
    Ok(())
}
