//! Smoothing of the boundary of cells, within them: surface nets (Gibson 1998), each vertex held near its home, with a test that no facet leaves
//! the cells.
//!
//! With u the way from a vertex to the mean of its neighbours, each vertex goes to where the sum of |u|^2 is least, as a thin plate would, and a
//! little towards where its faces pass the level: a membrane, which the means themselves would give, shrinks, and is dented by each cell that it
//! must not come into. It goes there, or part of the way, or along what stops it, or not at all: never so that a facet of it turns over, or comes
//! into a cell that is not kept. A facet is apart from the inside of such a cell if their shadows on some axis are (as in `separation`): on the
//! grid's own axes exactly, on others by a little more than rounding.
//!
//! Lengths are in cells; cell p reaches from p to p + 1.

use super::bits::Bits;
use super::grid::Grid;
use crate::Result;
use crate::error::{try_vec, try_with_capacity};
use crate::geometry::vec::{Vec3, add, cross, dot, norm, scale, sub};
use crate::progress::Progress;

/// A vertex's home.
#[derive(Debug, Clone, Copy)]
pub struct Home<const D: usize> {
    /// Where it begins.
    pub place: [f64; D],
    /// Where its faces pass the level, on average.
    pub aim: [f64; D],
    /// How far it may go from its place along each axis.
    pub reach: [f64; D],
}

impl<const D: usize> Default for Home<D> {
    fn default() -> Self {
        Home { place: [0.0; D], aim: [0.0; D], reach: [0.0; D] }
    }
}

/// Facets, and what they look along: an axis, up or down.
pub struct Facets<const D: usize> {
    pub corners: Vec<[u32; D]>,
    pub looks: Vec<(u8, bool)>,
}

/// Shadows on other axes than the grid's are apart by this much at least.
const CLEAR: f64 = 1e-9;

/// What a facet's normal, in the length of [`crate::geometry::Mesh::area_normal`], has at least along what it looks along.
const UPRIGHT: f64 = 0.01;

/// How vertices are moved.
pub struct Relaxing<'a, const D: usize> {
    /// The cells that facets stay in, if they are to.
    pub kept: Option<(&'a Grid<D>, &'a Bits)>,
    /// Times that each is moved.
    pub rounds: usize,
    /// What part of the way is towards the aim.
    pub pull: f64,
}

/// Moves `places`.
pub fn relax<const D: usize>(
    places: &mut [[f64; D]],
    homes: &[Home<D>],
    facets: &mut Facets<D>,
    how: &Relaxing<'_, D>,
    progress: &mut Progress<'_>,
) -> Result<()> {
    let Relaxing { kept, rounds, pull } = *how;
    let around = Around::new(places.len(), &facets.corners)?;
    // u, from each vertex to the mean of its neighbours.
    let mut means: Vec<[f64; D]> = try_with_capacity(places.len(), "the mesh of a part")?;
    for v in 0..places.len() {
        let (mut u, n) = ([0.0; D], around.n_neighbours::<D>(v));
        around.each(&facets.corners, v, |w| (0..D).for_each(|a| u[a] += (places[w][a] - places[v][a]) / n));
        means.push(u);
    }
    for round in 0..rounds {
        progress.tell(round as f64 / rounds as f64, "mesh of a part")?;
        for v in 0..places.len() {
            let old = places[v];
            let home = &homes[v];
            let plate = level(v, &means, &around, &facets.corners);
            let to = std::array::from_fn(|a| {
                let to = old[a] + (1.0 - pull) * plate[a] + pull * (home.aim[a] - old[a]);
                to.clamp(home.place[a] - home.reach[a], home.place[a] + home.reach[a])
            });
            go(v, to, places, &around, facets, kept);
            let moved = sub(places[v], old);
            if moved != [0.0; D] {
                means[v] = sub(means[v], moved);
                around.each(&facets.corners, v, |w| {
                    means[w] = add(means[w], scale(1.0 / around.n_neighbours::<D>(w), moved));
                });
            }
        }
    }
    if D == 3 && rounds > 0 {
        turn_diagonals(places, facets, kept);
    }
    Ok(())
}

/// The way of vertex `v` to where the sum of |u|^2 is least, its own and its neighbours'.
fn level<const D: usize>(v: usize, means: &[[f64; D]], around: &Around, corners: &[[u32; D]]) -> [f64; D] {
    let (mut way, mut weight) = (means[v], 1.0);
    around.each(corners, v, |w| {
        let share = 1.0 / around.n_neighbours::<D>(w);
        // Each neighbour comes D - 1 times.
        weight += share * share * (D - 1) as f64;
        way = sub(way, scale(share, means[w]));
    });
    scale(1.0 / weight, way)
}

/// Moves a vertex to `to`, or half or a quarter of the way, or along some axes, as far as its facets are good there.
fn go<const D: usize>(
    v: usize,
    to: [f64; D],
    places: &mut [[f64; D]],
    around: &Around,
    facets: &Facets<D>,
    kept: Option<(&Grid<D>, &Bits)>,
) {
    let old = places[v];
    let mut good = |p: [f64; D]| {
        let before = std::mem::replace(&mut places[v], p);
        let fits = |f: &u32| is_good(places, facets.corners[*f as usize], facets.looks[*f as usize], kept);
        let good = p == before || around.facets(v).iter().all(fits);
        if !good {
            places[v] = before;
        }
        good
    };
    let part = |s: f64| std::array::from_fn(|a| old[a] + s * (to[a] - old[a]));
    if good(to) || good(part(0.5)) || good(part(0.25)) {
        return;
    }
    // Along what stops it.
    let mut at = old;
    for a in 0..D {
        for x in [to[a], 0.5 * (old[a] + to[a])] {
            let mut p = at;
            p[a] = x;
            if good(p) {
                at = p;
                break;
            }
        }
    }
}

/// Takes the shorter diagonal of each face, where that is as good.
fn turn_diagonals<const D: usize>(places: &[[f64; D]], facets: &mut Facets<D>, kept: Option<(&Grid<D>, &Bits)>) {
    for f in 0..facets.corners.len() - 1 {
        let (one, two) = (facets.corners[f], facets.corners[f + 1]);
        // Both triangles of a face: (0, 1, 2) and (0, 2, 3).
        let is_pair = one[0] == two[0] && one[2 % D] == two[1];
        let (p, q, r, s) = (one[0], one[1], one[2 % D], two[2 % D]);
        let length = |v: u32, w: u32| norm(sub(places[v as usize], places[w as usize]));
        if !is_pair || length(q, s) >= length(p, r) {
            continue;
        }
        let turned = [[p, q, s], [q, r, s]].map(|t| std::array::from_fn(|k| t[k % 3]));
        if turned.iter().all(|t| is_good(places, *t, facets.looks[f], kept)) {
            [facets.corners[f], facets.corners[f + 1]] = turned;
        }
    }
}

/// The facets around each vertex.
struct Around {
    ends: Vec<u32>,
    facets: Vec<u32>,
}

impl Around {
    fn new<const D: usize>(n: usize, corners: &[[u32; D]]) -> Result<Self> {
        let mut ends = try_vec(n + 1, 0_u32, "the mesh of a part")?;
        corners.iter().flatten().for_each(|&v| ends[v as usize + 1] += 1);
        (0..n).for_each(|v| ends[v + 1] += ends[v]);
        let mut facets = try_vec(D * corners.len(), 0, "the mesh of a part")?;
        let mut at = try_with_capacity(n, "the mesh of a part")?;
        at.extend_from_slice(&ends[..n]);
        for (f, corner) in corners.iter().enumerate() {
            for &v in corner {
                facets[at[v as usize] as usize] = f as u32;
                at[v as usize] += 1;
            }
        }
        Ok(Around { ends, facets })
    }

    /// Calls `take` for the other vertices of each facet around `v`: in space each neighbour comes twice.
    fn each<const D: usize>(&self, corners: &[[u32; D]], v: usize, mut take: impl FnMut(usize)) {
        for &f in self.facets(v) {
            corners[f as usize].iter().map(|&w| w as usize).filter(|&w| w != v).for_each(&mut take);
        }
    }

    /// How many come.
    fn n_neighbours<const D: usize>(&self, v: usize) -> f64 {
        ((D - 1) * self.facets(v).len()) as f64
    }

    fn facets(&self, v: usize) -> &[u32] {
        &self.facets[self.ends[v] as usize..self.ends[v + 1] as usize]
    }
}

/// Whether a facet looks where it did and is within the cells.
fn is_good<const D: usize>(
    places: &[[f64; D]],
    corners: [u32; D],
    (axis, up): (u8, bool),
    kept: Option<(&Grid<D>, &Bits)>,
) -> bool {
    let p = corners.map(|v| places[v as usize]);
    let along = crate::geometry::facet::normal(&p)[axis as usize];
    if (if up { along } else { -along }) < UPRIGHT {
        return false;
    }
    kept.is_none_or(|(grid, cells)| is_within(&p, grid, cells))
}

/// Whether a facet is within the cells.
fn is_within<const D: usize>(p: &[[f64; D]; D], grid: &Grid<D>, cells: &Bits) -> bool {
    // Cells along each axis into which it comes; both that it lies between where it has no extent.
    let (mut from, mut to, mut flat) = ([0_i64; D], [0_i64; D], [false; D]);
    for a in 0..D {
        let (low, high) = p.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), q| (l.min(q[a]), h.max(q[a])));
        (from[a], to[a]) = (low.floor() as i64, high.ceil() as i64);
        if from[a] == to[a] {
            flat[a] = true;
            to[a] += 1;
        }
    }
    let has = |cell: [i64; D]| {
        let inside = (0..D).all(|a| (0..grid.counts()[a] as i64).contains(&cell[a]));
        inside && cells.has(grid.number(cell.map(|x| x as usize)))
    };
    // A facet on a grid's plane is in the cell on either side.
    let is_kept = |cell: [i64; D]| {
        (0..1 << D).any(|sides: u32| {
            let beyond = |a: usize| sides >> a & 1 == 1;
            (0..D).all(|a| flat[a] || !beyond(a)) && has(std::array::from_fn(|a| cell[a] - i64::from(beyond(a))))
        })
    };
    let mut cell = from;
    loop {
        if !is_kept(cell) && meets(p, cell.map(|x| x as f64), flat) {
            return false;
        }
        let Some(a) = (0..D).rev().find(|&a| cell[a] + 1 < to[a]) else { return true };
        cell[a] += 1;
        cell[a + 1..].copy_from_slice(&from[a + 1..]);
    }
}

/// Whether a facet may come into a cell, whose axes have been looked at; along axes on which it is flat the cell before counts as well.
fn meets<const D: usize>(p: &[[f64; D]; D], cell: [f64; D], flat: [bool; D]) -> bool {
    let half: [f64; D] = std::array::from_fn(|a| if flat[a] { 1.0 } else { 0.5 });
    let middle: [f64; D] = std::array::from_fn(|a| cell[a] + if flat[a] { 0.0 } else { 0.5 });
    let q = p.map(|p| sub(p, middle));
    let is_apart = |n: [f64; D]| {
        let at = q.map(|q| dot(n, q));
        let (low, high) = at.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
        let reach: f64 = (0..D).map(|a| half[a] * n[a].abs()).sum();
        let length = norm(n);
        length > 1e-6 && (low - reach > CLEAR * length || -reach - high > CLEAR * length)
    };
    if is_apart(crate::geometry::facet::normal(&q)) {
        return false;
    }
    if D == 2 {
        return true;
    }
    let three = |v: [f64; D]| -> Vec3 { std::array::from_fn(|k| v[k % D]) };
    for k in 0..D {
        let edge = three(sub(q[(k + 1) % D], q[k]));
        for a in 0..D {
            let mut axis = [0.0; 3];
            axis[a] = 1.0;
            let n = cross(edge, axis);
            if is_apart(std::array::from_fn(|b| n[b % 3])) {
                return false;
            }
        }
    }
    true
}
