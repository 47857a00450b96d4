//! Segments of the plane, joined end to end: what [`Mesh::from_polylines`] takes, given back.

use super::Mesh;
use crate::Result;
use crate::error::{Error, try_vec, try_with_capacity};

/// What the memory is for, should it run out.
const WORK: &str = "the polylines of the mesh";

/// Curves in the plane, each a run of points; a solid lies on their left.
#[derive(Debug, Clone, PartialEq)]
pub struct Polylines {
    /// Points [N x 2], curve after curve. A closed curve does not repeat its first point.
    pub points: Vec<[f64; 2]>,
    /// Where each curve starts among the points `[n]`.
    pub starts: Vec<usize>,
    /// Whether each curve's last point is joined to its first `[n]`.
    pub closed: Vec<bool>,
}

impl Polylines {
    /// The points of curve `i`.
    pub fn curve(&self, i: usize) -> &[[f64; 2]] {
        let end = self.starts.get(i + 1).copied().unwrap_or(self.points.len());
        &self.points[self.starts[i]..end]
    }
}

const NONE: u32 = u32::MAX;

impl Mesh<2> {
    /// The curves that the segments make: first the open ones, then the closed ones, each in the order of their first vertex.
    /// [`Error::InvalidArgument`] where two segments start, or two end, at one vertex: no curve runs on from there.
    pub fn polylines(&self) -> Result<Polylines> {
        let n = self.vertices().len();
        let mut next = try_vec(n, NONE, WORK)?;
        let mut ends_here = try_vec(n, false, WORK)?;
        for &[a, b] in self.segments() {
            for (v, taken) in [(a, next[a as usize] != NONE), (b, ends_here[b as usize])] {
                if taken {
                    return Err(Error::InvalidArgument(format!(
                        "two segments start, or two end, at vertex {v}; curves need one before and one behind"
                    )));
                }
            }
            next[a as usize] = b;
            ends_here[b as usize] = true;
        }
        let mut lines = Polylines {
            points: try_with_capacity(n, WORK)?,
            starts: try_with_capacity(n, WORK)?,
            closed: try_with_capacity(n, WORK)?,
        };
        let mut used = try_vec(n, false, WORK)?;
        for closed in [false, true] {
            for first in 0..n {
                // What is still unused when the open curves are done is on closed ones.
                if used[first] || next[first] == NONE || (!closed && ends_here[first]) {
                    continue;
                }
                lines.starts.push(lines.points.len());
                lines.closed.push(closed);
                let mut v = first;
                loop {
                    used[v] = true;
                    lines.points.push(self.vertices()[v]);
                    match next[v] {
                        NONE => break,
                        after if used[after as usize] => break,
                        after => v = after as usize,
                    }
                }
            }
        }
        Ok(lines)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Ends;
    use super::*;

    #[test]
    fn polylines_come_back_as_they_were_given() -> Result<()> {
        let points = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [1.0, 1.0], [1.0, 2.0], [2.0, 2.0]];
        for (ends, closed) in [(Ends::Closed, true), (Ends::Open, false)] {
            let lines = Mesh::from_polylines(points.clone(), &[0, 4], ends)?.polylines()?;
            assert_eq!(lines, Polylines { points: points.clone(), starts: vec![0, 4], closed: vec![closed; 2] });
        }
        Ok(())
    }

    #[test]
    fn open_curves_come_first_and_forks_are_refused() -> Result<()> {
        let vertices = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [5.0, 5.0], [6.0, 5.0], [7.0, 7.0]];
        let mesh = Mesh::new(vertices.clone(), vec![[0, 1], [1, 2], [2, 0], [4, 3]])?;
        let lines = mesh.polylines()?;
        assert_eq!((lines.starts, lines.closed), (vec![0, 2], vec![false, true]));
        assert_eq!(lines.points[..2], [[6.0, 5.0], [5.0, 5.0]]);
        for fork in [[[0, 1], [0, 2]], [[1, 0], [2, 0]]] {
            assert!(Mesh::new(vertices.clone(), fork.to_vec())?.polylines().is_err());
        }
        Ok(())
    }
}
