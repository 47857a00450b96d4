//! Facets around vertices, as lists that can be joined: what collapsing edges walks on.

use crate::Result;
use crate::error::{Error, try_vec};

const NONE: u32 = u32::MAX;

/// Per vertex, the list of its corners in facets; corner k of facet f is number D f + k.
pub(super) struct Rings {
    first: Vec<u32>,
    last: Vec<u32>,
    next: Vec<u32>,
}

impl Rings {
    /// The lists of `facets` over `n_vertices`.
    pub fn of<const D: usize>(facets: &[[u32; D]], n_vertices: usize) -> Result<Self> {
        const WORK: &str = "the facets around vertices of the level set";
        if D as u128 * facets.len() as u128 >= u128::from(NONE) {
            let n = facets.len();
            let text = format!("the level set has {n} facets, more than can be counted; fewer subdivisions are needed");
            return Err(Error::Unsupported(text));
        }
        let mut first = try_vec(n_vertices, NONE, WORK)?;
        let mut last = try_vec(n_vertices, NONE, WORK)?;
        let mut next = try_vec(D * facets.len(), NONE, WORK)?;
        // Backwards, so that the lists run forwards.
        for (corner, &v) in facets.as_flattened().iter().enumerate().rev() {
            let v = v as usize;
            if first[v] == NONE {
                last[v] = corner as u32;
            } else {
                next[corner] = first[v];
            }
            first[v] = corner as u32;
        }
        Ok(Rings { first, last, next })
    }

    /// Whether `v` has no corners, as after [`Rings::join`].
    pub fn is_empty(&self, v: u32) -> bool {
        self.first[v as usize] == NONE
    }

    /// Corners at `v`, those of facets that are gone among them.
    pub fn corners(&self, v: u32) -> impl Iterator<Item = usize> {
        let at = |corner: u32| (corner != NONE).then_some(corner);
        std::iter::successors(at(self.first[v as usize]), move |&c| at(self.next[c as usize])).map(|c| c as usize)
    }

    /// Appends the list of `from` to that of `to`; `from` has none then.
    pub fn join(&mut self, from: u32, to: u32) {
        let (from, to) = (from as usize, to as usize);
        let (first, last) = (std::mem::replace(&mut self.first[from], NONE), self.last[from]);
        if first == NONE {
            return;
        }
        if self.first[to] == NONE {
            self.first[to] = first;
        } else {
            self.next[self.last[to] as usize] = first;
        }
        self.last[to] = last;
    }

    /// Takes corners that are not `kept` out of the list of `v`.
    pub fn purge(&mut self, v: u32, kept: impl Fn(usize) -> bool) {
        let mut corner = std::mem::replace(&mut self.first[v as usize], NONE);
        let mut last = NONE;
        while corner != NONE {
            let after = std::mem::replace(&mut self.next[corner as usize], NONE);
            if kept(corner as usize) {
                match last {
                    NONE => self.first[v as usize] = corner,
                    last => self.next[last as usize] = corner,
                }
                last = corner;
            }
            corner = after;
        }
        self.last[v as usize] = last;
    }
}
