//! Short edges collapsed: marching simplices leave slivers wherever the level set passes a lattice vertex closely.
//!
//! An edge a b is collapsed by moving a onto b. That keeps the topology where the link condition holds (Dey, Edelsbrunner, Guha and
//! Nekhayev 1999): vertices that both a and b are joined to are joined to them by the facets at the edge only, and no two facets become
//! one. It keeps the place where each facet that changes still faces the side that the level set faces (the gradient's, not the facet's
//! before, which of a sliver is noise), as the normal test of Hoppe's progressive meshes (1996) does. Vertices stay on the level set: none
//! moves but onto another.
//!
//! On the faces of the box a vertex moves only along the faces that hold it, and only along an edge of the boundary.

use super::Surface;
use super::quality::Quality;
use super::queue::{Entry, Queue};
use super::rings::Rings;
use crate::Result;
use crate::error::try_vec;
use crate::geometry::vec::{dot, sub};

/// What the memory is for, should it run out.
const WORK: &str = "the short edges of the level set";

/// A collapse may worsen the worst shape around it as long as it stays above this.
const GOOD_SHAPE: f64 = 0.5;

/// A collapse may lean a facet as long as this cosine is kept.
const UPRIGHT: f64 = 0.9;

/// Facets of less shape have no direction to compare with.
const NO_SHAPE: f64 = 0.05;

/// Passes over all short edges at most: a collapse may allow others around it that were not before.
const MOST_PASSES: i32 = 4;

/// The corners of facets that are gone.
const GONE: u32 = u32::MAX;

/// The surface while edges are collapsed.
struct Collapse<'a, const D: usize> {
    surface: &'a mut Surface<D>,
    rings: Rings,
    queue: Queue,
    /// Length of the result's edges.
    h: f64,
    /// Edges shorter than this are collapsed.
    shortest: f64,
    /// The vertices around the edge's a and b, in order, but for these two themselves; a < b.
    around: [Vec<u32>; 2],
}

/// Collapses edges shorter than `shortest`, the shortest first, and renumbers what is left in the old order; `h` is the length of the
/// result's edges. `tell` hears the fraction done.
pub(super) fn collapse<const D: usize>(
    surface: &mut Surface<D>,
    shortest: f64,
    h: f64,
    mut tell: impl FnMut(f64) -> Result<()>,
) -> Result<()> {
    let rings = Rings::of(&surface.facets, surface.vertices.len())?;
    let queue = Queue::new(surface.facets.len(), WORK)?;
    let mut work = Collapse { surface, rings, queue, h, shortest, around: [Vec::new(), Vec::new()] };
    for pass in 0..MOST_PASSES {
        // Each pass finds much less to do than the one before.
        let left = 0.25f64.powi(pass);
        if work.pass(|done| tell(1.0 - left * (1.0 - 0.75 * done)))? == 0 {
            break;
        }
    }
    compact(surface)
}

impl<const D: usize> Collapse<'_, D> {
    /// Goes through all short edges once; gives how many were collapsed. `tell` hears the fraction done.
    fn pass(&mut self, mut tell: impl FnMut(f64) -> Result<()>) -> Result<usize> {
        tell(0.0)?;
        self.queue.fill(short_edges(self.surface, self.shortest), WORK)?;
        let (mut judged, mut merged, mut last) = (0_usize, 0, (0, 0));
        while let Some((_, a, b)) = self.queue.pop() {
            // Offered more than once, the same edge comes out more than once in a row.
            if std::mem::replace(&mut last, (a, b)) == (a, b) {
                continue;
            }
            judged += 1;
            if judged.is_multiple_of(4096) {
                tell(judged as f64 / (judged + self.queue.len()) as f64)?;
            }
            if let Some((gone, kept)) = self.judge(a, b) {
                self.merge(gone, kept)?;
                merged += 1;
            }
        }
        Ok(merged)
    }

    /// Which of a and b may move onto the other, and onto which; `None` where neither may, or they are no edge any more.
    fn judge(&mut self, a: u32, b: u32) -> Option<(u32, u32)> {
        // Most edges that were there at first are gone with one of their ends.
        if self.rings.is_empty(a) || self.rings.is_empty(b) {
            return None;
        }
        let shared = self.facets_at(a).filter(|&f| self.surface.facets[f].contains(&b)).count();
        if shared == 0 || !self.keeps_topology(a, b, shared) {
            return None;
        }
        let faces = |v: u32| self.surface.faces[v as usize];
        // Two vertices on the boundary are joined along it, or across the surface, which a collapse would pinch.
        let along_boundary = D == 3 && shared == 1;
        if faces(a) != 0 && faces(b) != 0 && !along_boundary {
            return None;
        }
        // A vertex stays on the faces that hold it.
        let may = |gone: u32, kept: u32| faces(gone) & !faces(kept) == 0;
        let good = |after: Quality, than: Quality| after.shape >= than.shape && after.cosine >= than.cosine;
        let enough = Quality { shape: GOOD_SHAPE, cosine: UPRIGHT };
        let mut found = [None; 2];
        for ((gone, kept), found) in [(a, b), (b, a)].into_iter().zip(&mut found).filter(|((g, k), _)| may(*g, *k)) {
            let after = self.worst(gone, Some(kept), kept);
            if good(after, enough) {
                return Some((gone, kept));
            }
            *found = Some((gone, kept, after));
        }
        // What was there before is costly to know, and matters only where what comes is not good in itself.
        let before = enough.worse(self.worst(a, None, b)).worse(self.worst(b, None, a));
        found.into_iter().flatten().find(|m| good(m.2, before)).map(|(gone, kept, _)| (gone, kept))
    }

    /// Facets that are left at `v`.
    fn facets_at(&self, v: u32) -> impl Iterator<Item = usize> {
        self.rings.corners(v).map(|c| c / D).filter(|&f| self.surface.facets[f][0] != GONE)
    }

    /// The link condition for the edge of a and b, which `shared` facets hold.
    fn keeps_topology(&mut self, a: u32, b: u32, shared: usize) -> bool {
        let mut around = std::mem::take(&mut self.around);
        for (v, around) in [a, b].into_iter().zip(&mut around) {
            around.clear();
            around.extend(self.facets_at(v).flat_map(|f| self.surface.facets[f]).filter(|&w| w != a && w != b));
            around.sort_unstable();
            around.dedup();
        }
        let common = around[0].iter().filter(|v| around[1].binary_search(v).is_ok()).count();
        self.around = around;
        // A facet at the edge has D - 2 further vertices.
        if common != shared * (D - 2) {
            return false;
        }
        // Facets of a that do not hold b must stay, none of them as what a facet of b is already.
        let mut left = 0;
        for f in self.facets_at(a).filter(|&f| !self.surface.facets[f].contains(&b)) {
            left += 1;
            let moved = self.surface.facets[f].map(|v| if v == a { b } else { v });
            if self.facets_at(b).any(|g| moved.iter().all(|v| self.surface.facets[g].contains(v))) {
                return false;
            }
        }
        let others = self.facets_at(b).filter(|&f| !self.surface.facets[f].contains(&a)).count();
        left + others > 0
    }

    /// The worst of the facets at `v`, had it moved onto `to`; of those that hold `other` only where nothing moves.
    fn worst(&self, v: u32, to: Option<u32>, other: u32) -> Quality {
        let at = |w: u32| {
            let w = to.filter(|_| w == v).unwrap_or(w) as usize;
            (self.surface.vertices[w], self.surface.normals[w])
        };
        let staying = |f: &usize| to.is_none() || !self.surface.facets[*f].contains(&other);
        self.facets_at(v).filter(staying).fold(Quality::BEST, |worst, f| {
            let mut q = Surface::quality(self.surface.facets[f], self.h, at);
            if to.is_none() && q.shape < NO_SHAPE {
                q.cosine = 1.0;
            }
            worst.worse(q)
        })
    }

    /// Moves `gone` onto `kept`.
    fn merge(&mut self, gone: u32, kept: u32) -> Result<()> {
        let corners: Vec<usize> = self.rings.corners(gone).collect();
        for corner in corners {
            let facet = &mut self.surface.facets[corner / D];
            if facet.contains(&kept) {
                *facet = [GONE; D];
            } else if facet[0] != GONE {
                facet[corner % D] = kept;
            }
        }
        self.rings.join(gone, kept);
        let facets = &self.surface.facets;
        self.rings.purge(kept, |corner| facets[corner / D][0] != GONE);
        // The link condition has listed the vertices around both. Edges that only led to `gone` are new ones of `kept`.
        let around = std::mem::take(&mut self.around);
        let (of_gone, of_kept) = if gone < kept { (&around[0], &around[1]) } else { (&around[1], &around[0]) };
        for &w in of_gone.iter().filter(|w| of_kept.binary_search(w).is_err()) {
            if let Some(edge) = short_edge(self.surface, kept, w, self.shortest) {
                self.queue.push(edge, WORK)?;
            }
        }
        self.around = around;
        Ok(())
    }
}

/// The edge of a and b, if it is short.
fn short_edge<const D: usize>(surface: &Surface<D>, a: u32, b: u32, shortest: f64) -> Option<Entry> {
    let e = sub(surface.vertices[a as usize], surface.vertices[b as usize]);
    let squared = dot(e, e);
    // The bits of numbers above 0 are in the order of the numbers.
    (squared < shortest * shortest).then(|| (squared.to_bits(), a.min(b), a.max(b)))
}

/// All short edges, those that two facets run through in opposite directions once.
fn short_edges<const D: usize>(surface: &Surface<D>, shortest: f64) -> impl Iterator<Item = Entry> {
    surface.facets.iter().filter(|facet| facet[0] != GONE).flat_map(move |facet| {
        (0..if D == 2 { 1 } else { D }).filter_map(move |k| {
            let (a, b) = (facet[k], facet[(k + 1) % D]);
            // Between two triangles an edge runs both ways; a segment, or an edge on a face of the box, may run down only.
            let on_box = surface.faces[a as usize] != 0 && surface.faces[b as usize] != 0;
            if a < b || D == 2 || on_box { short_edge(surface, a, b, shortest) } else { None }
        })
    })
}

/// Takes out facets that are gone and vertices that no facet uses.
fn compact<const D: usize>(surface: &mut Surface<D>) -> Result<()> {
    surface.facets.retain(|facet| facet[0] != GONE);
    let mut number = try_vec(surface.vertices.len(), GONE, WORK)?;
    surface.facets.as_flattened().iter().for_each(|&v| number[v as usize] = 0);
    let mut n = 0;
    for (v, number) in number.iter_mut().enumerate().filter(|(_, number)| **number != GONE) {
        *number = n as u32;
        surface.vertices[n] = surface.vertices[v];
        surface.normals[n] = surface.normals[v];
        surface.faces[n] = surface.faces[v];
        n += 1;
    }
    surface.vertices.truncate(n);
    surface.normals.truncate(n);
    surface.faces.truncate(n);
    surface.facets.as_flattened_mut().iter_mut().for_each(|v| *v = number[*v as usize]);
    Ok(())
}
