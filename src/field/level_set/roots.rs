//! Where a crossed edge meets the level set: Newton's method along the edge, kept in a bracket; many edges at a time.

use super::crossings::Crossing;
use super::cubes::Cubes;
use super::near::Near;
use super::{Function, Question, Surface};
use crate::Result;
use crate::error::{try_vec, try_with_capacity};
use crate::geometry::vec::{add, dot, normalized, scale};
use crate::par::Workers;

/// Edges that one thread solves together.
const BLOCK: usize = 256;

/// Edges between two words of progress.
const STAGE: usize = 256 * BLOCK;

/// A step this short, as a fraction of the edge, is the last: the error after it is about its square.
const CONVERGED: f64 = 1e-11;

/// Steps after which the bracket is as short as it gets.
const MOST_STEPS: usize = 120;

/// Vertices keep this distance from the ends of their edge, as a fraction of it, so that no two are at one point where the level set
/// goes through a lattice vertex.
const FROM_ENDS: f64 = 1e-9;

/// The search on one edge from a + 0 e to a + 1 e.
#[derive(Clone, Copy)]
struct Search<const D: usize> {
    a: [f64; D],
    e: [f64; D],
    /// Where f has the sign that it has at 0, and the other.
    low: f64,
    high: f64,
    /// Whether f < 0 at 0.
    rises: bool,
    t: f64,
    /// |f| one step ago.
    size: f64,
    slot: usize,
}

impl<const D: usize> Search<D> {
    /// Takes f and its gradient at t, moves t, and tells whether that was the last step.
    fn step(&mut self, f: f64, gradient: [f64; D]) -> bool {
        if f == 0.0 {
            return true;
        }
        if (f < 0.0) == self.rises {
            self.low = self.t
        } else {
            self.high = self.t
        }
        let newton = self.t - f / dot(gradient, self.e);
        if (newton - self.t).abs() <= CONVERGED {
            self.t = newton.clamp(0.0, 1.0);
            return true;
        }
        // Where Newton's method leaves the bracket or hardly gains, halving does gain. A NaN is in no bracket.
        let gains = f.abs() <= 0.5 * self.size && newton > self.low && newton < self.high;
        self.t = if gains { newton } else { 0.5 * (self.low + self.high) };
        self.size = f.abs();
        self.high - self.low <= CONVERGED
    }
}

/// The vertices of the level set on `crossings`, given phi - level `f` at the vertices of `near`, and the unit normals there, outward; `tell`
/// hears the fraction done.
pub(super) fn find<F: Function<D>, const D: usize>(
    question: &Question<F, D>,
    (cubes, near, f): (&Cubes<D>, &Near<D>, &[f64]),
    crossings: &[Crossing],
    workers: &Workers,
    mut tell: impl FnMut(f64) -> Result<()>,
) -> Result<Surface<D>> {
    const WORK: &str = "the vertices of the level set";
    let n = crossings.len();
    let mut vertices = try_vec(n, [0.0; D], WORK)?;
    let mut normals = try_vec(n, [0.0; D], WORK)?;
    let lattice = cubes.lattice()?;
    for (i, stage) in crossings.chunks(STAGE).enumerate() {
        let range = i * STAGE..i * STAGE + stage.len();
        let places = vertices[range.clone()].chunks_mut(BLOCK).zip(normals[range.clone()].chunks_mut(BLOCK));
        workers.try_for_each(stage.chunks(BLOCK).zip(places), |(crossings, (vertices, normals))| {
            let mut searches = crossings.iter().enumerate().map(|(slot, c)| {
                let [f0, f1] = [0, cubes.offset(c.axes)].map(|offset| f[near.place(c.vertex + offset)]);
                let (a, e) = (lattice.point(c.vertex), cubes.vector(c.axes));
                Search { a, e, low: 0.0, high: 1.0, rises: f0 < 0.0, t: f0 / (f0 - f1), size: f64::INFINITY, slot }
            });
            solve(question, &mut searches, vertices, normals)?;
            normals.iter_mut().for_each(|g| *g = normalized(scale(question.outward, *g)).unwrap_or([0.0; D]));
            Ok(())
        })?;
        tell(range.end as f64 / n as f64)?;
    }
    let mut faces = try_with_capacity(n, WORK)?;
    faces.extend(crossings.iter().map(|c| c.faces));
    Ok(Surface { vertices, normals, faces, facets: Vec::new() })
}

/// Runs at most a block of searches side by side; writes where each ends, and the last gradient that it saw.
fn solve<F: Function<D>, const D: usize>(
    question: &Question<F, D>,
    searches: &mut dyn Iterator<Item = Search<D>>,
    vertices: &mut [[f64; D]],
    gradients: &mut [[f64; D]],
) -> Result<()> {
    let mut active: Vec<Search<D>> = searches.collect();
    let (mut points, mut f, mut g) = ([[0.0; D]; BLOCK], [0.0; BLOCK], [[0.0; D]; BLOCK]);
    for step in 0..MOST_STEPS {
        let n = active.len();
        if n == 0 {
            break;
        }
        for (p, s) in points.iter_mut().zip(&active) {
            *p = add(s.a, scale(s.t, s.e));
        }
        question.phi.gradients(&points[..n], &mut f[..n], &mut g[..n])?;
        let mut i = 0;
        active.retain_mut(|s| {
            let done = s.step(f[i] - question.level, g[i]) || step + 1 == MOST_STEPS;
            if done {
                vertices[s.slot] = add(s.a, scale(s.t.clamp(FROM_ENDS, 1.0 - FROM_ENDS), s.e));
                gradients[s.slot] = g[i];
            }
            i += 1;
            !done
        });
    }
    Ok(())
}
