//! Vertices moved along the level set towards the middle of their neighbours, where that betters the worst facet around them.
//!
//! Each round proposes all moves at once: the tangential part of the way to the neighbours' mean, then Newton's method along the gradient
//! back to the level set. They are taken in the order of the vertices, each against the places that its neighbours then have (Freitag's
//! smart Laplacian smoothing, 1997), so that the worst quality never falls and the topology is not touched. Vertices on the faces of the
//! box stay.

use super::quality::Quality;
use super::rings::Rings;
use super::{Function, Surface};
use crate::Result;
use crate::error::try_vec;
use crate::geometry::vec::{add, dot, norm, normalized, scale, sub};
use crate::par::Workers;

/// Vertices that one thread moves together.
const BLOCK: usize = 256;

/// The part of the way to the neighbours' mean that is taken.
const PACE: f64 = 0.8;

/// Newton's steps back to the level set at most: a move is short, so a few do, or the move is not taken.
const MOST_STEPS: usize = 8;

/// A step this short, in edges of the surface, is the last: the error after it is about its square.
const CONVERGED: f64 = 1e-8;

/// Facets that lean less than this are not worsened for a better shape.
const UPRIGHT: f64 = 0.9;

/// What of a question all rounds share.
pub(super) struct Relaxation<'a, F, const D: usize> {
    pub phi: &'a F,
    pub level: f64,
    /// Normals run along this times grad phi.
    pub sign: f64,
    /// Length of the surface's edges.
    pub h: f64,
    /// The box.
    pub lower: [f64; D],
    pub upper: [f64; D],
}

/// Where a vertex would move, and the unit normal there.
type Move<const D: usize> = Option<([f64; D], [f64; D])>;

impl<F: Function<D>, const D: usize> Relaxation<'_, F, D> {
    /// Runs `rounds` rounds on `surface`; `tell` hears the fraction done.
    pub fn run(
        &self,
        surface: &mut Surface<D>,
        rounds: u32,
        workers: &Workers,
        mut tell: impl FnMut(f64) -> Result<()>,
    ) -> Result<()> {
        if rounds == 0 {
            return Ok(());
        }
        let rings = Rings::of(&surface.facets, surface.vertices.len())?;
        let mut moves: Vec<Move<D>> = try_vec(surface.vertices.len(), None, "the moves of the level set's vertices")?;
        for round in 0..rounds {
            let seen = &*surface;
            workers.try_for_each(moves.chunks_mut(BLOCK).enumerate(), |(i, moves)| {
                self.propose(seen, &rings, i * BLOCK, moves)
            })?;
            for (v, step) in moves.iter().enumerate() {
                if let Some((p, n)) = *step {
                    self.take(surface, &rings, v, p, n);
                }
            }
            tell(f64::from(round + 1) / f64::from(rounds))?;
        }
        Ok(())
    }

    /// The moves of the vertices from `first` on.
    fn propose(&self, surface: &Surface<D>, rings: &Rings, first: usize, moves: &mut [Move<D>]) -> Result<()> {
        let mut active = Vec::with_capacity(moves.len());
        let mut points = [[0.0; D]; BLOCK];
        for (i, step) in moves.iter_mut().enumerate() {
            *step = None;
            if surface.faces[first + i] == 0 {
                points[i] = target(surface, rings, first + i);
                active.push(i);
            }
        }
        let (mut asked, mut f, mut g) = ([[0.0; D]; BLOCK], [0.0; BLOCK], [[0.0; D]; BLOCK]);
        for _ in 0..MOST_STEPS {
            let n = active.len();
            active.iter().zip(&mut asked).for_each(|(&i, p)| *p = points[i]);
            self.phi.gradients(&asked[..n], &mut f[..n], &mut g[..n])?;
            let mut k = 0;
            active.retain(|&i| {
                let (f, g) = (f[k] - self.level, g[k]);
                k += 1;
                let step = f / dot(g, g);
                points[i] = sub(points[i], scale(step, g));
                let length = (step * norm(g)).abs();
                let inside = (0..D).all(|a| points[i][a] > self.lower[a] && points[i][a] < self.upper[a]);
                // Far from where it was the vertex might land on another sheet. A NaN is not near.
                let near = norm(sub(points[i], surface.vertices[first + i])) <= self.h;
                if length <= CONVERGED * self.h && inside && near {
                    moves[i] = Some((points[i], normalized(scale(self.sign, g)).unwrap_or([0.0; D])));
                }
                length > CONVERGED * self.h && length < self.h
            });
        }
        Ok(())
    }

    /// Moves vertex `v` to `p`, of normal `n`, unless that worsens the facets around it.
    fn take(&self, surface: &mut Surface<D>, rings: &Rings, v: usize, p: [f64; D], n: [f64; D]) {
        let worst = |surface: &Surface<D>| {
            rings.corners(v as u32).fold(Quality::BEST, |worst, corner| {
                let at = |w: u32| (surface.vertices[w as usize], surface.normals[w as usize]);
                worst.worse(Surface::quality(surface.facets[corner / D], self.h, at))
            })
        };
        let before = worst(surface);
        let old = (surface.vertices[v], surface.normals[v]);
        (surface.vertices[v], surface.normals[v]) = (p, n);
        let after = worst(surface);
        if after.shape < before.shape || after.cosine < before.cosine.min(UPRIGHT) {
            (surface.vertices[v], surface.normals[v]) = old;
        }
    }
}

/// Where vertex `v` would go along its tangent.
fn target<const D: usize>(surface: &Surface<D>, rings: &Rings, v: usize) -> [f64; D] {
    let (p, n) = (surface.vertices[v], surface.normals[v]);
    let (mut way, mut count) = ([0.0; D], 0.0);
    for corner in rings.corners(v as u32) {
        for &w in surface.facets[corner / D].iter().filter(|&&w| w as usize != v) {
            way = add(way, sub(surface.vertices[w as usize], p));
            count += 1.0;
        }
    }
    let way = way.map(|x| PACE * x / count);
    sub(add(p, way), scale(dot(way, n), n))
}
