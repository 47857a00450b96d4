//! Segments in the plane, joined end to end.

use super::LevelSet;
use crate::Result;
use crate::error::{try_vec, try_with_capacity};

/// What the memory is for, should it run out.
const WORK: &str = "the polylines of the level set";

/// Curves in the plane, each a run of points; the solid is on the left.
#[derive(Debug, Clone, PartialEq)]
pub struct Polylines {
    /// Points [V x 2], curve after curve. A closed curve does not repeat its first point.
    pub points: Vec<[f64; 2]>,
    /// Where each curve starts among the points, and behind the last their number: `[n + 1]`.
    pub starts: Vec<usize>,
    /// Whether each curve's last point is joined to its first `[n]`.
    pub closed: Vec<bool>,
}

impl LevelSet<2> {
    /// The level set as curves: first the open ones, then the closed ones, each in the order of their first vertex.
    pub fn polylines(&self) -> Result<Polylines> {
        const NONE: u32 = u32::MAX;
        let n = self.vertices().len();
        let mut next = try_vec(n, NONE, WORK)?;
        let mut ends_here = try_vec(n, false, WORK)?;
        for &[a, b] in self.facets() {
            next[a as usize] = b;
            ends_here[b as usize] = true;
        }
        let mut lines = Polylines { points: try_with_capacity(n, WORK)?, starts: vec![0], closed: Vec::new() };
        let mut used = try_vec(n, false, WORK)?;
        for closed in [false, true] {
            for first in 0..n {
                // What is still unused when the open curves are done is on closed ones.
                if used[first] || (!closed && ends_here[first]) {
                    continue;
                }
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
                lines.starts.push(lines.points.len());
                lines.closed.push(closed);
            }
        }
        Ok(lines)
    }
}
