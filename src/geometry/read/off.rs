//! OFF: a header, the counts, a line per vertex, a line per face.
//!
//! A vertex line begins with its coordinates whatever the header's prefix (ST, C, N) adds after them, and a face line with
//! its corners; what follows on the line is left unread.

use super::builder::Builder;
use super::fault::{Fault, Read};
use super::text::{Lines, number, quote, without_comment, words};
use crate::Error;
use crate::error::Place;
use crate::geometry::Mesh;
use crate::geometry::vec::Vec3;

/// Whether `bytes` begin as OFF does, after comments.
pub(super) fn is_off(bytes: &[u8]) -> bool {
    let first = ContentLines(Lines::new(bytes)).next();
    first.and_then(|(_, line)| words(line).next()).is_some_and(|word| prefix(word).is_some())
}

/// The mesh of an OFF file.
pub(super) fn read(bytes: &[u8]) -> Read<Mesh> {
    let mut lines = ContentLines(Lines::new(bytes));
    let (n_vertices, n_faces) = counts(&mut lines)?;
    let left = lines.0.remaining();
    // `0 0 0` and a line end are the shortest vertex, `3 0 0 0` the shortest face; the last line may lack its end.
    if n_vertices.saturating_mul(6).saturating_add(n_faces.saturating_mul(8)) > left + 1 {
        return Err(Fault::line(
            lines.0.number(),
            format!("{n_vertices} vertices and {n_faces} faces are announced, but only {left} bytes follow"),
        ));
    }
    let mut builder = Builder::with_room(n_vertices, n_faces)?;
    for i in 0..n_vertices {
        let (line, content) = lines.expect("vertex", i, n_vertices)?;
        builder.vertex(vertex(content, i, line)?, Place::Line(line))?;
    }
    let mut corners = Vec::new();
    for i in 0..n_faces {
        let (line, content) = lines.expect("face", i, n_faces)?;
        face(content, i, line, &mut corners)?;
        builder.face(&corners, n_vertices, Place::Line(line))?;
    }
    builder.finish()
}

/// Lines that hold more than white space and comments.
struct ContentLines<'a>(Lines<'a>);

impl<'a> Iterator for ContentLines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        self.0.by_ref().map(|(i, line)| (i, without_comment(line))).find(|(_, line)| words(line).next().is_some())
    }
}

impl<'a> ContentLines<'a> {
    fn expect(&mut self, what: &str, i: usize, n: usize) -> Read<(usize, &'a [u8])> {
        self.next().ok_or_else(|| {
            Fault::line(self.0.number(), format!("the file ends before {what} {i} of the {n} announced (from 0)"))
        })
    }
}

/// What stands before `OFF` in the header's keyword; `None` when `word` is no such keyword.
fn prefix(word: &[u8]) -> Option<&[u8]> {
    let prefix = word.strip_suffix(b"OFF")?;
    [&b""[..], b"C", b"N", b"CN", b"ST", b"STC", b"STN", b"STCN", b"4", b"n", b"4n"].contains(&prefix).then_some(prefix)
}

/// Reads header and counts, on one line or on two: `OFF`, then vertices, faces and, if the writer likes, edges.
fn counts(lines: &mut ContentLines) -> Read<(usize, usize)> {
    let (line, content) = lines.next().ok_or_else(|| Fault::whole("the file holds no OFF header"))?;
    let mut rest = words(content).peekable();
    let keyword = rest.next().unwrap_or_default();
    let Some(prefix) = prefix(keyword) else {
        return Err(Fault::line(line, format!("`OFF` was expected, found {}", quote(keyword))));
    };
    if prefix.iter().any(|b| matches!(b, b'4' | b'n')) || rest.peek() == Some(&&b"BINARY"[..]) {
        let message = "OFF is read as text and in three dimensions only; write the mesh as plain OFF, PLY or STL";
        return Err(Error::Unsupported(message.into()).into());
    }
    if rest.peek().is_some() {
        return two_counts(rest, line);
    }
    let Some((line, content)) = lines.next() else {
        return Err(Fault::line(line, "the file ends before the counts of vertices and faces"));
    };
    two_counts(words(content), line)
}

fn two_counts<'a>(mut words: impl Iterator<Item = &'a [u8]>, line: usize) -> Read<(usize, usize)> {
    let mut count = |what: &str| {
        let word = words.next().unwrap_or_default();
        number(word)
            .ok_or_else(|| Fault::line(line, format!("the number of {what} was expected, found {}", quote(word))))
    };
    Ok((count("vertices")?, count("faces")?))
}

fn vertex(content: &[u8], i: usize, line: usize) -> Read<Vec3> {
    let mut words = words(content);
    let mut p = [0.0; 3];
    for x in &mut p {
        let word = words.next().unwrap_or_default();
        *x = number(word).ok_or_else(|| {
            Fault::line(line, format!("vertex {i} needs 3 coordinates, found {} for one", quote(word)))
        })?;
    }
    Ok(p)
}

/// Reads `n` and as many corners into `corners`.
fn face(content: &[u8], i: usize, line: usize, corners: &mut Vec<i64>) -> Read<()> {
    let mut words = words(content);
    let word = words.next().unwrap_or_default();
    let n: usize = number(word).ok_or_else(|| {
        Fault::line(line, format!("face {i} must begin with its corner count, found {}", quote(word)))
    })?;
    corners.clear();
    // The words of the line bound the buffer, not `n`.
    for word in words.take(n) {
        let corner = number(word)
            .ok_or_else(|| Fault::line(line, format!("face {i} names vertex {}; an integer is needed", quote(word))))?;
        super::builder::push(corners, corner, "the corners of a face")?;
    }
    if corners.len() < n {
        let found = corners.len();
        return Err(Fault::line(line, format!("face {i} announces {n} corners, but its line holds {found}")));
    }
    Ok(())
}
