//! OBJ: lines that begin with a keyword. Vertices, `v`, and faces, `f`, are read; all else is passed over.
//!
//! A face's corner is `vertex`, `vertex/texture`, `vertex//normal` or all three, counted from 1 or, if negative, back from the vertex
//! before the face. A backslash at a line's end joins the next line to it. Weights and colours after the coordinates are left unread. A
//! file cut within its last number passes for a whole one.

use super::builder::{Builder, push};
use super::fault::{Fault, Read};
use super::text::{Lines, number, quote, without_comment, words};
use crate::error::Place;
use crate::geometry::Mesh;
use crate::geometry::vec::Vec3;

/// The mesh of an OBJ file.
pub(super) fn read(text: &[u8]) -> Read<Mesh> {
    // Counted first: for the room, and because a face may name vertices that come after it.
    let mut counted = Statements::new(text);
    while counted.advance()?.is_some() {}
    let mut builder = Builder::with_room(counted.n_vertices, counted.n_faces)?;
    let mut statements = Statements::new(text);
    let mut corners = Vec::new();
    while let Some(kind) = statements.advance()? {
        let place = Place::Line(statements.line);
        match kind {
            Kind::Vertex => builder.vertex(statements.vertex()?, place)?,
            Kind::Face => {
                corners.clear();
                for word in &statements.words[1..] {
                    push(&mut corners, statements.corner(word, counted.n_vertices)?, "the corners of a face")?;
                }
                builder.face(&corners, counted.n_vertices, place)?;
            }
        }
    }
    builder.finish()
}

/// What a line says.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Vertex,
    Face,
}

/// The `v` and `f` of a text, one after the other.
struct Statements<'a> {
    lines: Lines<'a>,
    /// The words of the one now read, keyword first, and the number of its line.
    words: Vec<&'a [u8]>,
    line: usize,
    /// With the one now read.
    n_vertices: usize,
    n_faces: usize,
}

impl<'a> Statements<'a> {
    fn new(text: &'a [u8]) -> Self {
        Statements { lines: Lines::new(text), words: Vec::new(), line: 0, n_vertices: 0, n_faces: 0 }
    }

    /// Moves to the next one; `None` at the end.
    fn advance(&mut self) -> Read<Option<Kind>> {
        while let Some((line, content)) = self.lines.next() {
            let content = without_comment(content);
            let (kind, count) = match words(content).next() {
                Some(b"v") => (Kind::Vertex, &mut self.n_vertices),
                Some(b"f") => (Kind::Face, &mut self.n_faces),
                _ => continue,
            };
            *count += 1;
            self.line = line;
            self.split(content)?;
            return Ok(Some(kind));
        }
        Ok(None)
    }

    /// Takes the words of a line and of those that a backslash at the end joins to it.
    fn split(&mut self, mut content: &'a [u8]) -> Read<()> {
        self.words.clear();
        loop {
            let joined = content.trim_ascii_end().strip_suffix(b"\\");
            for word in words(joined.unwrap_or(content)) {
                push(&mut self.words, word, "the words of a line")?;
            }
            match joined.and_then(|_| self.lines.next()) {
                Some((_, next)) => content = without_comment(next),
                None => return Ok(()),
            }
        }
    }

    /// The coordinates of the vertex now read.
    fn vertex(&self) -> Read<Vec3> {
        let mut p = [0.0; 3];
        for (k, x) in p.iter_mut().enumerate() {
            let word = self.words.get(k + 1).and_then(|word| number(word));
            *x = word.ok_or_else(|| self.fault("a vertex needs 3 coordinates, as in `v 0 1 2`"))?;
        }
        Ok(p)
    }

    /// The vertex, from 0, at a corner of the face now read, in a file of `n` vertices.
    fn corner(&self, word: &[u8], n: usize) -> Read<i64> {
        let position = word.split(|&b| b == b'/').next().unwrap_or_default();
        let face = self.n_faces - 1;
        if position.is_empty() {
            return Err(Fault::line(self.line, format!("face {face} has a corner without vertex, {}", quote(word))));
        }
        let named: i64 =
            number(position).ok_or_else(|| self.fault("a face needs the numbers of its vertices, as in `f 1 2 3`"))?;
        let first = -(self.n_vertices as i64);
        if named < first || named == 0 || named > n as i64 {
            let range = format!("1 to {n}, or {first} to -1 here, are there");
            return Err(Fault::line(self.line, format!("face {face} names vertex {named}; {range}")));
        }
        Ok(if named < 0 { named - first } else { named - 1 })
    }

    fn fault(&self, needed: &str) -> Fault {
        Fault::line(self.line, format!("{needed}; found {}", quote(&self.words.join(&b' '))))
    }
}
