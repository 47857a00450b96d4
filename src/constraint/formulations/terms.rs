//! Means of distances d_i under weights w_i, with gradients: what Hicken and Kaur's and Lin's formulas share.
//!
//! g = sum w_i d_i / S, S = sum w_i, and with grad w_i = w_i c_i r_i, r_i = x - p_i:
//! grad g = (sum w_i grad d_i + sum w_i c_i d_i r_i - g sum w_i c_i r_i) / S.
//! d_i = n_i . r_i, and for paraboloids + r_i . K_i r_i / 2, of which the gradient is n_i + K_i r_i.
//!
//! Points lie in blocks of eight, coordinate by coordinate, so that the loops are of vectors. The sums are eight, one a place in the block,
//! and added in a fixed order.

// Coordinates and places in a block, as in the formulas.
#![allow(clippy::needless_range_loop)]

use super::curvature::Tensor;
use crate::Result;
use crate::error::try_with_capacity;
use crate::geometry::Cloud;
use crate::isa::{Isa, Kernel};

/// Points of a block.
pub(super) const LANES: usize = 8;

/// One number a point of a block.
pub(super) type Lanes = [f64; LANES];

/// Planes of some points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block<const D: usize> {
    pub points: [Lanes; D],
    pub normals: [Lanes; D],
}

/// K of some points.
pub(super) type Curvatures<const D: usize> = [[Lanes; D]; D];

/// The distances d_i.
#[derive(Debug)]
pub(super) struct Terms<const D: usize> {
    n: usize,
    /// The last is filled up with the last point.
    blocks: Vec<Block<D>>,
    /// As many as blocks, or none: planes.
    curvatures: Vec<Curvatures<D>>,
}

impl<const D: usize> Terms<D> {
    /// Those of the cloud's planes, or of its paraboloids of curvature `tensors` `[N]`.
    pub fn new(cloud: &Cloud<D>, tensors: Option<&[Tensor<D>]>) -> Result<Self> {
        let (n, n_blocks) = (cloud.len(), cloud.len().div_ceil(LANES));
        let mut blocks = try_with_capacity(n_blocks, "the points of the formulation")?;
        let at = |b: usize, lane: usize| (b * LANES + lane).min(n - 1);
        let of = |b: usize, from: &[[f64; D]], a: usize| -> Lanes { std::array::from_fn(|lane| from[at(b, lane)][a]) };
        blocks.extend((0..n_blocks).map(|b| Block {
            points: std::array::from_fn(|a| of(b, cloud.points(), a)),
            normals: std::array::from_fn(|a| of(b, cloud.normals(), a)),
        }));
        let mut curvatures = Vec::new();
        if let Some(tensors) = tensors {
            curvatures = try_with_capacity(n_blocks, "the curvatures of the formulation")?;
            let entry =
                |b: usize, i: usize, j: usize| -> Lanes { std::array::from_fn(|lane| tensors[at(b, lane)][i][j]) };
            curvatures.extend((0..n_blocks).map(|b| std::array::from_fn(|i| std::array::from_fn(|j| entry(b, i, j)))));
        }
        Ok(Terms { n, blocks, curvatures })
    }

    /// All of them.
    pub fn all(&self) -> Chosen<'_, D> {
        Chosen { n: self.n, blocks: &self.blocks, curvatures: &self.curvatures }
    }

    /// Those of the points `indices`, at most as many as `to` has places for, copied to it.
    pub fn some<'a>(&self, indices: impl ExactSizeIterator<Item = usize>, to: &'a mut Picked<D>) -> Chosen<'a, D> {
        let n = indices.len();
        let mut last = 0;
        let mut copy = |place: usize, from: usize| {
            let (b, lane, from_b, from_lane) = (place / LANES, place % LANES, from / LANES, from % LANES);
            for a in 0..D {
                to.blocks[b].points[a][lane] = self.blocks[from_b].points[a][from_lane];
                to.blocks[b].normals[a][lane] = self.blocks[from_b].normals[a][from_lane];
                if !self.curvatures.is_empty() {
                    (0..D).for_each(|c| to.curvatures[b][a][c][lane] = self.curvatures[from_b][a][c][from_lane]);
                }
            }
        };
        for (place, i) in indices.enumerate() {
            copy(place, i);
            last = i;
        }
        let n_blocks = n.div_ceil(LANES);
        (n..n_blocks * LANES).for_each(|place| copy(place, last));
        let n_curvatures = if self.curvatures.is_empty() { 0 } else { n_blocks };
        Chosen { n, blocks: &to.blocks[..n_blocks], curvatures: &to.curvatures[..n_curvatures] }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.blocks[..]) + size_of_val(&self.curvatures[..])
    }
}

/// Room for the terms of the nearest points.
pub(super) struct Picked<const D: usize> {
    blocks: [Block<D>; super::MOST_NEAREST / LANES],
    curvatures: [Curvatures<D>; super::MOST_NEAREST / LANES],
}

impl<const D: usize> Picked<D> {
    pub fn new() -> Self {
        let zeros = [[0.0; LANES]; D];
        Picked {
            blocks: [Block { points: zeros, normals: zeros }; super::MOST_NEAREST / LANES],
            curvatures: [[zeros; D]; super::MOST_NEAREST / LANES],
        }
    }
}

/// Terms that count.
#[derive(Clone, Copy)]
pub(super) struct Chosen<'a, const D: usize> {
    n: usize,
    blocks: &'a [Block<D>],
    curvatures: &'a [Curvatures<D>],
}

/// How a term counts.
pub(super) trait Weigh: Copy {
    /// w, relative to that of the nearest point, which is 1, and c, of squared distances of which the `least` of all points is known.
    fn weigh<I: Isa>(self, squared: &Lanes, least: f64) -> [Lanes; 2];
}

/// The mean at x, to be dispatched.
pub(super) struct Mean<'a, W, const D: usize> {
    pub x: [f64; D],
    pub terms: Chosen<'a, D>,
    pub weights: W,
    pub wants: Wants,
}

/// What is wanted of a formula.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wants {
    Value,
    ValueAndGradient,
}

impl<W: Weigh, const D: usize> Kernel for Mean<'_, W, D> {
    /// g and grad g.
    type Output = (f64, [f64; D]);

    #[inline(always)]
    fn run<I: Isa>(self) -> Self::Output {
        match (self.wants, self.terms.curvatures.is_empty()) {
            (Wants::Value, true) => self.sums::<I, false, false>().mean(),
            (Wants::Value, false) => self.sums::<I, true, false>().mean(),
            (Wants::ValueAndGradient, true) => self.sums::<I, false, true>().mean(),
            (Wants::ValueAndGradient, false) => self.sums::<I, true, true>().mean(),
        }
    }
}

/// Sums over the points of each place in a block.
struct Sums<const D: usize> {
    w: Lanes,
    wd: Lanes,
    /// w grad d
    wg: [Lanes; D],
    /// w c d r
    wcdr: [Lanes; D],
    /// w c r
    wcr: [Lanes; D],
}

impl<const D: usize> Sums<D> {
    #[inline(always)]
    fn mean(&self) -> (f64, [f64; D]) {
        let (s, sd) = (total(&self.w), total(&self.wd));
        let g = sd / s;
        let along = |a: usize| (total(&self.wg[a]) + (total(&self.wcdr[a]) - g * total(&self.wcr[a]))) / s;
        (g, std::array::from_fn(along))
    }
}

#[inline(always)]
fn total(lanes: &Lanes) -> f64 {
    let [a, b, c, d, e, f, g, h] = *lanes;
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}

impl<W: Weigh, const D: usize> Mean<'_, W, D> {
    /// x - p and its square.
    #[inline(always)]
    fn offsets(&self, block: &Block<D>) -> ([Lanes; D], Lanes) {
        let (mut r, mut squared) = ([[0.0; LANES]; D], [0.0; LANES]);
        for a in 0..D {
            for lane in 0..LANES {
                r[a][lane] = self.x[a] - block.points[a][lane];
                squared[lane] += r[a][lane] * r[a][lane];
            }
        }
        (r, squared)
    }

    /// Delta_min^2
    #[inline(always)]
    fn least(&self) -> f64 {
        let mut least = [f64::INFINITY; LANES];
        for block in self.terms.blocks {
            let (_, squared) = self.offsets(block);
            for lane in 0..LANES {
                // What fills the last block up is a point of it.
                least[lane] = if squared[lane] < least[lane] { squared[lane] } else { least[lane] };
            }
        }
        least.iter().fold(f64::INFINITY, |m, x| m.min(*x))
    }

    #[inline(always)]
    fn sums<I: Isa, const QUADRATIC: bool, const GRADIENT: bool>(&self) -> Sums<D> {
        let least = self.least();
        let zeros = [[0.0; LANES]; D];
        let mut sums = Sums { w: [0.0; LANES], wd: [0.0; LANES], wg: zeros, wcdr: zeros, wcr: zeros };
        let Chosen { n, blocks, curvatures } = self.terms;
        for (b, block) in blocks.iter().enumerate() {
            let (r, squared) = self.offsets(block);
            let [mut w, c] = self.weights.weigh::<I>(&squared, least);
            if n < (b + 1) * LANES {
                w[n - b * LANES..].fill(0.0);
            }
            let (mut d, mut gradient) = ([0.0; LANES], block.normals);
            for a in 0..D {
                for lane in 0..LANES {
                    d[lane] += block.normals[a][lane] * r[a][lane];
                }
            }
            if QUADRATIC {
                for i in 0..D {
                    let mut kr = [0.0; LANES];
                    for j in 0..D {
                        for lane in 0..LANES {
                            kr[lane] += curvatures[b][i][j][lane] * r[j][lane];
                        }
                    }
                    for lane in 0..LANES {
                        d[lane] += 0.5 * r[i][lane] * kr[lane];
                        gradient[i][lane] += kr[lane];
                    }
                }
            }
            for lane in 0..LANES {
                sums.w[lane] += w[lane];
                sums.wd[lane] += w[lane] * d[lane];
            }
            if GRADIENT {
                for a in 0..D {
                    for lane in 0..LANES {
                        let wcr = w[lane] * c[lane] * r[a][lane];
                        sums.wg[a][lane] += w[lane] * gradient[a][lane];
                        sums.wcdr[a][lane] += wcr * d[lane];
                        sums.wcr[a][lane] += wcr;
                    }
                }
            }
        }
        sums
    }
}
