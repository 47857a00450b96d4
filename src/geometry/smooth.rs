//! Smoothing of noisy clouds: each point goes to the surface that its neighbours tell.
//!
//! Paper 000, section 4.5, smooths its heart before the fit and does not say how. Here it is moving least squares (Alexa et al. 2003), one
//! step from the point itself: a quadratic height h over the plane of the neighbours' mean normal, fitted to the nearest points that face
//! the same way, near ones counting more,
//!
//! ```text
//! minimise sum_j w_j (h(u_j) - n . (p_j - p))^2,   p <- p + h(0) n,   n <- n - grad h(0), of length 1
//! ```
//!
//! u_j the neighbour's place in the plane, w_j = (1 - (r_j / r)^2)^2, r the distance to the k-th. A plane in place of the quadratic would
//! pull curved surfaces inwards. Edges are rounded over about r.

use super::Cloud;
use super::neighbours::{Neighbour, Neighbours};
use super::surfels::tangents;
use super::unit::Unit;
use super::vec::{add, dot, normalized, scale, sub};
use crate::error::{try_vec, try_with_capacity};
use crate::linalg::dense::solve_cholesky;
use crate::par::Workers;
use crate::progress::Progress;
use crate::{Error, Result};

/// Neighbours that a point is smoothed by at most.
const MOST_NEIGHBOURS: usize = 128;

/// Rounds at most; after a few the cloud changes little.
const MOST_ROUNDS: u32 = 100;

/// A pivot below this part of its diagonal entry tells that the neighbours do not span what is fitted.
const SINGULAR: f64 = 1e-9;

/// Options of [`Cloud::smoothed`].
#[derive(Debug, Clone, PartialEq)]
pub struct SmoothOptions {
    /// k: nearest points that a point is smoothed by, itself among them; 0 for 40 in space and 12 in the plane. More smooth more.
    pub neighbours: u32,
    /// Times that the whole cloud is smoothed.
    pub rounds: u32,
    /// Threads: 0 for all cores, 1 for none but the caller's.
    pub n_threads: u32,
}

impl Default for SmoothOptions {
    fn default() -> Self {
        SmoothOptions { neighbours: 0, rounds: 1, n_threads: 0 }
    }
}

impl SmoothOptions {
    /// Checks every range.
    pub fn validate(&self) -> Result<()> {
        let wrong = |text: String| Err(Error::InvalidArgument(text));
        if self.neighbours != 0 && !(4..=MOST_NEIGHBOURS as u32).contains(&self.neighbours) {
            let k = self.neighbours;
            return wrong(format!(
                "neighbours is {k}; it must lie in [4, {MOST_NEIGHBOURS}], and 0 lets the call choose"
            ));
        }
        if !(1..=MOST_ROUNDS).contains(&self.rounds) {
            return wrong(format!("rounds is {}; it must lie in [1, {MOST_ROUNDS}]", self.rounds));
        }
        Workers::check(self.n_threads)
    }

    fn k<const D: usize>(&self) -> usize {
        match (self.neighbours, D) {
            (0, 2) => 12,
            (0, _) => 40,
            (k, _) => k as usize,
        }
    }
}

/// A point with its normal.
type Oriented<const D: usize> = ([f64; D], [f64; D]);

impl<const D: usize> Cloud<D> {
    /// The cloud with noise smoothed out of points and normals, which must be about right before; weights stay, origins go. The same bits
    /// on any number of threads, and a power of two in the coordinates changes none. Cost: about 6 microseconds a point and round on one
    /// thread, in the plane 1.5.
    pub fn smoothed(&self, options: &SmoothOptions, progress: &mut Progress) -> Result<Self> {
        const CHUNK: usize = 1024;
        const STAGE: usize = 32;
        options.validate()?;
        let workers = Workers::new(options.n_threads)?;
        let unit = Unit::of_bounds(&self.bounds());
        let n = self.len();
        let mut points = try_with_capacity(n, "the smoothed points")?;
        points.extend(self.points().iter().map(|p| scale(unit.shrink, *p)));
        let mut normals = try_with_capacity(n, "the smoothed normals")?;
        normals.extend_from_slice(self.normals());
        for round in 0..options.rounds {
            let before = Cloud::new(points, normals)?;
            let tree = Neighbours::new(before.points())?;
            let mut after: Vec<Oriented<D>> = try_vec(n, ([0.0; D], [0.0; D]), "the smoothed points")?;
            let mut chunks = after.chunks_mut(CHUNK).enumerate();
            // Some chunks at a time, so that the caller hears of them.
            for done in (0..n).step_by(STAGE * CHUNK) {
                let part = done as f64 / n as f64;
                progress.tell((f64::from(round) + part) / f64::from(options.rounds), "smoothing")?;
                workers.for_each(chunks.by_ref().take(STAGE), |(chunk, after)| {
                    for (i, after) in after.iter_mut().enumerate() {
                        *after = before.smoothed_at(chunk * CHUNK + i, &tree, options.k::<D>());
                    }
                });
            }
            (points, normals) = (try_with_capacity(n, "the smoothed points")?, try_with_capacity(n, "the normals")?);
            points.extend(after.iter().map(|a| a.0));
            normals.extend(after.iter().map(|a| a.1));
        }
        points.iter_mut().for_each(|p| *p = scale(unit.grow, *p));
        let mut smoothed = Cloud::new(points, normals)?;
        if let Some(weights) = self.weights() {
            let mut copy = try_with_capacity(weights.len(), "the weights")?;
            copy.extend_from_slice(weights);
            smoothed.set_weights(copy)?;
        }
        progress.tell(1.0, "done")?;
        Ok(smoothed)
    }

    /// Point `i`, smoothed; as it is where its neighbours tell nothing.
    fn smoothed_at(&self, i: usize, tree: &Neighbours<D>, k: usize) -> Oriented<D> {
        let (p, normal) = (self.points()[i], self.normals()[i]);
        let faces_along = |j: usize| dot(normal, self.normals()[j]) > 0.0;
        let mut nearest = [Neighbour { index: 0, distance_squared: 0.0 }; MOST_NEIGHBOURS];
        let found = tree.nearest(p, faces_along, &mut nearest[..k]);
        let nearest = &nearest[..found];
        let reach = nearest.last().map_or(0.0, |n| n.distance_squared);
        if reach == 0.0 {
            return (p, normal);
        }
        let weight = |n: &Neighbour| (1.0 - n.distance_squared / reach).powi(2);
        let mean = nearest.iter().fold([0.0; D], |sum, n| add(sum, scale(weight(n), self.normals()[n.index as usize])));
        let n = normalized(mean).unwrap_or(normal);
        let frame = tangents(n);
        // Places in units of the reach, so that the powers are of one size.
        let per_reach = 1.0 / reach.sqrt();
        let samples = nearest.iter().map(|n| {
            let r = scale(per_reach, sub(self.points()[n.index as usize], p));
            (weight(n), frame.map(|t| dot(r, t)))
        });
        let Some((height, slope)) = height::<D>(samples) else { return (p, n) };
        let tilted = (0..D - 1).fold(n, |n, a| sub(n, scale(slope[a], frame[a])));
        (add(p, scale(height / per_reach, n)), normalized(tilted).unwrap_or(n))
    }
}

/// h(0) and grad h(0) of the quadratic through `samples`, each a weight and a place whose last coordinate is the height. A constant where
/// they span no more; `None` for none.
fn height<const D: usize>(samples: impl Iterator<Item = (f64, [f64; D])> + Clone) -> Option<(f64, [f64; 2])> {
    let quadratic = match D {
        2 => fitted(samples.clone(), |p| [1.0, p[0], p[0] * p[0]]).map(|[h, u, _]| (h, [u, 0.0])),
        _ => fitted(samples.clone(), |p| [1.0, p[0], p[1], p[0] * p[0], p[0] * p[1], p[1] * p[1]])
            .map(|[h, u, v, ..]| (h, [u, v])),
    };
    quadratic.or_else(|| fitted(samples, |_| [1.0]).map(|[h]| (h, [0.0; 2])))
}

/// Coefficients of the `basis` that meets the samples best.
fn fitted<const N: usize, const D: usize>(
    samples: impl Iterator<Item = (f64, [f64; D])>,
    basis: impl Fn([f64; D]) -> [f64; N],
) -> Option<[f64; N]> {
    let (mut a, mut b) = ([[0.0; N]; N], [0.0; N]);
    for (w, place) in samples {
        let f = basis(place);
        for i in 0..N {
            for j in 0..=i {
                a[i][j] += w * f[i] * f[j];
            }
            b[i] += w * f[i] * place[D - 1];
        }
    }
    solve_cholesky(a, b, SINGULAR)
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::super::shapes::{circle, sphere, torus};
    use super::super::vec::norm;
    use super::*;

    /// Root mean square of |p| - 1, and the mean angle between p and its normal.
    fn errors<const D: usize>(cloud: &Cloud<D>) -> (f64, f64) {
        let n = cloud.len() as f64;
        let squares: f64 = cloud.points().iter().map(|p| (norm(*p) - 1.0).powi(2)).sum();
        let cos = |(p, n): (&[f64; D], &[f64; D])| (dot(*p, *n) / norm(*p)).clamp(-1.0, 1.0).acos();
        ((squares / n).sqrt(), cloud.points().iter().zip(cloud.normals()).map(cos).sum::<f64>() / n)
    }

    fn noisy<const D: usize>(cloud: &Cloud<D>, size: f64) -> Cloud<D> {
        let mut random = SplitMix64::new(3);
        let mut shaken = |v: &[f64; D], size: f64| v.map(|x| x + size * random.between(-1.0, 1.0));
        let points = cloud.points().iter().map(|p| shaken(p, size)).collect();
        let normals = cloud.normals().iter().map(|n| shaken(n, 0.3)).collect();
        Cloud::new(points, normals).unwrap()
    }

    fn smoothed<const D: usize>(cloud: &Cloud<D>, rounds: u32) -> Cloud<D> {
        cloud.smoothed(&SmoothOptions { rounds, ..SmoothOptions::default() }, &mut Progress::silent()).unwrap()
    }

    #[test]
    fn noise_falls_in_space_and_in_the_plane() {
        let ball = noisy(&sphere([0.0; 3], 1.0, 4).unwrap().sample(4000, 1).unwrap(), 0.02);
        let (before, after) = (errors(&ball), errors(&smoothed(&ball, 2)));
        assert!(after.0 < 0.4 * before.0 && after.1 < 0.4 * before.1, "{before:?} {after:?}");
        let ring = noisy(&circle([0.0; 2], 1.0, 1000).unwrap().sample(1000, 1).unwrap(), 0.01);
        let (before, after) = (errors(&ring), errors(&smoothed(&ring, 2)));
        assert!(after.0 < 0.6 * before.0 && after.1 < 0.7 * before.1, "{before:?} {after:?}");
    }

    #[test]
    fn a_clean_curved_surface_stays_where_it_is() {
        let ball = sphere([0.0; 3], 1.0, 5).unwrap().sample(4000, 1).unwrap();
        let (before, after) = (errors(&ball), errors(&smoothed(&ball, 5)));
        assert!(after.0 < before.0 + 1e-4, "{before:?} {after:?}");
    }

    #[test]
    fn a_power_of_two_and_threads_change_no_bit() {
        let ring = noisy(&torus(1.0, 0.3, 40, 20).unwrap().sample(1500, 1).unwrap(), 0.01);
        let one = ring.smoothed(&SmoothOptions { n_threads: 1, ..SmoothOptions::default() }, &mut Progress::silent());
        let one = one.unwrap();
        let scaled = ring.points().iter().map(|p| scale(1024.0, *p)).collect();
        let scaled = Cloud::new(scaled, ring.normals().to_vec()).unwrap();
        let other = smoothed(&scaled, 1);
        assert!(one.points().iter().zip(other.points()).all(|(a, b)| scale(1024.0, *a) == *b));
        assert_eq!(one.normals(), other.normals());
    }

    #[test]
    fn lone_points_lines_and_copies_are_served() {
        let up = [0.0, 0.0, 1.0];
        for points in [vec![[0.0; 3]; 9], vec![[1.0; 3]], (0..9).map(|i| [f64::from(i), 0.0, 0.0]).collect()] {
            let cloud = Cloud::new(points.clone(), vec![up; points.len()]).unwrap();
            assert_eq!(smoothed(&cloud, 1).points(), points);
        }
        let wrong = SmoothOptions { rounds: 0, ..SmoothOptions::default() };
        let one = Cloud::new(vec![[1.0; 3]], vec![up]).unwrap();
        assert!(one.smoothed(&wrong, &mut Progress::silent()).is_err());
    }

    #[test]
    fn points_at_one_place_are_found_as_fast_as_others() {
        // Quadratic time would take minutes.
        let n = 100_000;
        let mut points = vec![[0.0; 3]; n];
        points.push([1.0; 3]);
        let cloud = Cloud::new(points, vec![[0.0, 0.0, 1.0]; n + 1]).unwrap();
        assert_eq!(smoothed(&cloud, 1).points(), cloud.points());
    }

    #[test]
    fn a_round_can_be_cancelled() {
        let cloud = sphere([0.0; 3], 1.0, 3).unwrap().sample(40_000, 1).unwrap();
        let mut told = Vec::new();
        let mut tell = |fraction: f64, _: &str| {
            told.push(fraction);
            if fraction > 0.0 { std::ops::ControlFlow::Break(()) } else { std::ops::ControlFlow::Continue(()) }
        };
        let cancelled = cloud.smoothed(&SmoothOptions::default(), &mut Progress::new(&mut tell));
        assert_eq!(cancelled.err(), Some(Error::Cancelled));
        assert!(told.len() == 2 && told[1] < 1.0, "{told:?}");
    }
}
