//! Values on an affine lattice: a line (one step), a slice (two) or, in space, a box (three), in any directions.

use super::eval::check_points;
use super::{Field, Function};
use crate::par::Workers;
use crate::progress::Progress;
use crate::{Error, Result};
use std::ops::Range;

/// Points placed and evaluated at a time.
const BLOCK: usize = 256;

/// Points that a thread takes at a time.
const ITEM: usize = 16 * BLOCK;

/// Points between two words of progress.
const STAGE: usize = 64 * ITEM;

/// The points origin + i_1 step_1 + ... + i_k step_k, 0 <= i_j < count_j, row-major: the last index runs fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Lattice<const D: usize> {
    origin: [f64; D],
    steps: Vec<[f64; D]>,
    counts: Vec<usize>,
    len: usize,
}

impl<const D: usize> Lattice<D> {
    /// The lattice at `origin` of `steps` [k x D], 1 <= k <= D, in the caller's units, with `counts` `[k]` points along each.
    pub fn new(origin: [f64; D], steps: &[[f64; D]], counts: &[usize]) -> Result<Self> {
        let wrong = |text: String| Err(Error::InvalidArgument(text));
        let k = steps.len();
        if k == 0 || k > D || counts.len() != k {
            let n = counts.len();
            return wrong(format!(
                "{k} steps and {n} counts; as many of one as of the other are needed, from 1 to {D}"
            ));
        }
        if let Some(x) = origin.iter().chain(steps.as_flattened()).find(|x| !x.is_finite()) {
            return wrong(format!("the origin or a step has a coordinate {x}; it must be finite"));
        }
        if let Some(j) = counts.iter().position(|&n| n == 0) {
            return wrong(format!("count {j} is 0; at least 1 point along each step is needed"));
        }
        // Bytes of the gradients must be countable too.
        let largest = isize::MAX as usize / size_of::<[f64; D]>();
        let len = counts.iter().try_fold(1_usize, |len, &n| len.checked_mul(n).filter(|&len| len <= largest));
        let Some(len) = len else {
            return wrong(format!("the lattice of {counts:?} points has more points than memory can count"));
        };
        Ok(Lattice { origin, steps: steps.to_vec(), counts: counts.to_vec(), len })
    }

    /// Points in all, at least 1.
    #[expect(clippy::len_without_is_empty)]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Point `i` in row-major order.
    pub fn point(&self, mut i: usize) -> [f64; D] {
        let mut p = self.origin;
        for (step, &count) in self.steps.iter().zip(&self.counts).rev() {
            // By the index, not from point to point: what a point is does not depend on where a block began.
            let along = (i % count) as f64;
            i /= count;
            p = std::array::from_fn(|a| p[a] + along * step[a]);
        }
        p
    }

    /// Values `[len]` of `phi` and gradients [len x D], each where wanted, in row-major order; `tell` hears the fraction done. The same
    /// bits on any number of threads. After an error the outputs are unspecified.
    pub(crate) fn eval(
        &self,
        phi: &impl Function<D>,
        values: Option<&mut [f64]>,
        gradients: Option<&mut [[f64; D]]>,
        workers: &Workers,
        tell: impl FnMut(f64) -> Result<()>,
    ) -> Result<()> {
        let rooms = [
            ("values", values.as_ref().map_or(self.len, |v| v.len())),
            ("gradients", gradients.as_ref().map_or(self.len, |g| g.len())),
        ];
        if let Some((name, room)) = rooms.iter().find(|(_, room)| *room != self.len) {
            let n = self.len;
            return Err(Error::InvalidArgument(format!("{name} has room for {room} points; the lattice has {n}")));
        }
        self.eval_some(phi, (self.len, |places| places), values, gradients, workers, tell)
    }

    /// The same at `n` points only: those of indices `which(places)`, for `places` among 0 .. n.
    pub(super) fn eval_some<I: Iterator<Item = usize>>(
        &self,
        phi: &impl Function<D>,
        (n, which): (usize, impl Fn(Range<usize>) -> I + Sync),
        mut values: Option<&mut [f64]>,
        mut gradients: Option<&mut [[f64; D]]>,
        workers: &Workers,
        mut tell: impl FnMut(f64) -> Result<()>,
    ) -> Result<()> {
        for first in (0..n).step_by(STAGE) {
            let stage = first..(first + STAGE).min(n);
            let value_items = pieces(values.as_deref_mut().map(|v| &mut v[stage.clone()]));
            let gradient_items = pieces(gradients.as_deref_mut().map(|g| &mut g[stage.clone()]));
            let items = stage.clone().step_by(ITEM).zip(value_items.zip(gradient_items));
            workers.try_for_each(items, |(first, (values, gradients))| {
                let item = first..(first + ITEM).min(stage.end);
                self.eval_item(phi, (item, &which), values, gradients)
            })?;
            tell(stage.end as f64 / n as f64)?;
        }
        Ok(())
    }

    /// Evaluates at the points of `item`, of indices `which(item)`.
    fn eval_item<I: Iterator<Item = usize>>(
        &self,
        phi: &impl Function<D>,
        (item, which): (Range<usize>, &impl Fn(Range<usize>) -> I),
        mut values: Option<&mut [f64]>,
        mut gradients: Option<&mut [[f64; D]]>,
    ) -> Result<()> {
        let (mut points, mut unwanted) = ([[0.0; D]; BLOCK], [0.0; BLOCK]);
        let mut indices = which(item.clone());
        for first in item.clone().step_by(BLOCK) {
            let n = BLOCK.min(item.end - first);
            points[..n].iter_mut().zip(&mut indices).for_each(|(p, i)| *p = self.point(i));
            let block = first - item.start..first - item.start + n;
            let values = match &mut values {
                Some(values) => &mut values[block.clone()],
                None => &mut unwanted[..n],
            };
            match &mut gradients {
                None => phi.values(&points[..n], values)?,
                Some(gradients) => phi.gradients(&points[..n], values, &mut gradients[block])?,
            }
        }
        Ok(())
    }

    /// Indices of the lattice's corners, ascending: what is linear has its extremes there.
    fn corners(&self) -> impl Iterator<Item = usize> {
        let k = self.counts.len();
        (0..1_usize << k).map(move |corner| {
            let at = |j: usize| if corner >> (k - 1 - j) & 1 == 1 { self.counts[j] - 1 } else { 0 };
            (0..k).fold(0, |i, j| i * self.counts[j] + at(j))
        })
    }
}

/// An output in pieces of [`ITEM`], or nothing, as often as asked, where it is not wanted.
fn pieces<T>(output: Option<&mut [T]>) -> impl Iterator<Item = Option<&mut [T]>> {
    let mut pieces = output.map(|output| output.chunks_mut(ITEM));
    std::iter::from_fn(move || match &mut pieces {
        Some(pieces) => pieces.next().map(Some),
        None => Some(None),
    })
}

impl<const D: usize> Field<D> {
    /// phi `[n]`, in the caller's unit of length, and grad phi [n x D], each where wanted, at the n points of `lattice`, in row-major
    /// order, on `n_threads` threads as [`Workers::new`] takes them; the same bits on any number. Points outside the box are served as
    /// [`Field::eval`] serves them. After a cancellation the outputs are unspecified. Allocates a few kilobytes.
    pub fn eval_lattice(
        &self,
        lattice: &Lattice<D>,
        values: Option<&mut [f64]>,
        gradients: Option<&mut [[f64; D]]>,
        n_threads: u32,
        progress: &mut Progress,
    ) -> Result<()> {
        Workers::check(n_threads)?;
        // Where the corners can be served all points can, and here their indices are known.
        lattice.corners().try_for_each(|i| check_points(i, &[lattice.point(i)]))?;
        if values.is_none() && gradients.is_none() {
            return Ok(());
        }
        let workers = if lattice.len() <= ITEM { Workers::caller_only() } else { Workers::new(n_threads)? };
        lattice.eval(self, values, gradients, &workers, |fraction| progress.tell(fraction, "lattice"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x + 10 y + 100 z
    struct Linear;

    impl Function<3> for Linear {
        fn values(&self, points: &[[f64; 3]], values: &mut [f64]) -> Result<()> {
            points.iter().zip(values).for_each(|(p, v)| *v = p[0] + 10.0 * p[1] + 100.0 * p[2]);
            Ok(())
        }

        fn gradients(&self, points: &[[f64; 3]], values: &mut [f64], gradients: &mut [[f64; 3]]) -> Result<()> {
            gradients.fill([1.0, 10.0, 100.0]);
            self.values(points, values)
        }
    }

    fn values(lattice: &Lattice<3>, n_threads: u32) -> Vec<f64> {
        let (mut values, mut gradients) = (vec![0.0; lattice.len()], vec![[0.0; 3]; lattice.len()]);
        let workers = Workers::new(n_threads).unwrap();
        lattice.eval(&Linear, Some(&mut values), Some(&mut gradients), &workers, |_| Ok(())).unwrap();
        assert!(gradients.iter().all(|g| *g == [1.0, 10.0, 100.0]));
        let mut alone = vec![0.0; lattice.len()];
        lattice.eval(&Linear, Some(&mut alone), None, &workers, |_| Ok(())).unwrap();
        assert_eq!(alone, values);
        gradients.fill([0.0; 3]);
        lattice.eval(&Linear, None, Some(&mut gradients), &workers, |_| Ok(())).unwrap();
        assert!(gradients.iter().all(|g| *g == [1.0, 10.0, 100.0]));
        lattice.eval(&Linear, None, None, &workers, |_| Ok(())).unwrap();
        values
    }

    #[test]
    fn values_come_in_rows() {
        let slice = Lattice::new([1.0, 0.0, 0.0], &[[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]], &[2, 3]).unwrap();
        assert_eq!(values(&slice, 1), [1.0, 11.0, 21.0, 101.0, 111.0, 121.0]);
        let line = Lattice::new([0.0; 3], &[[0.5, 0.0, 1.0]], &[3]).unwrap();
        assert_eq!(values(&line, 1), [0.0, 100.5, 201.0]);
        let one = Lattice::new([0.0, 0.0, 2.0], &[[1.0; 3]; 3], &[1; 3]).unwrap();
        assert_eq!(values(&one, 1), [200.0]);
    }

    #[test]
    fn threads_do_not_change_the_values() {
        let steps = [[0.1, 0.0, 0.3], [0.0, 0.2, 0.1], [0.7, 0.0, 0.0]];
        let lattice = Lattice::new([0.3; 3], &steps, &[67, 68, 69]).unwrap();
        let alone = values(&lattice, 1);
        assert_eq!(values(&lattice, 3), alone);
        assert_eq!(alone[lattice.len() - 1], {
            let mut last = [0.0];
            Linear.values(&[lattice.point(lattice.len() - 1)], &mut last).unwrap();
            last[0]
        });
    }

    #[test]
    fn corners_are_where_indices_are_first_or_last() {
        let steps = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let corners =
            |k: usize| Lattice::new([0.0; 3], &steps[..k], &[4, 3, 2][..k]).unwrap().corners().collect::<Vec<_>>();
        assert_eq!(corners(1), [0, 3]);
        assert_eq!(corners(2), [0, 2, 9, 11]);
        assert_eq!(corners(3), [0, 1, 4, 5, 18, 19, 22, 23]);
    }

    #[test]
    fn refuses_lattices_that_are_none() {
        let x = [1.0, 0.0, 0.0];
        assert!(Lattice::<3>::new([0.0; 3], &[], &[]).is_err());
        assert!(Lattice::new([0.0; 3], &[x; 4], &[1; 4]).is_err());
        assert!(Lattice::new([0.0; 3], &[x; 2], &[1]).is_err());
        assert!(Lattice::new([0.0; 3], &[x; 2], &[1, 0]).is_err());
        assert!(Lattice::new([f64::NAN; 3], &[x], &[1]).is_err());
        assert!(Lattice::new([0.0; 3], &[x; 3], &[usize::MAX; 3]).is_err());
        let two = Lattice::new([0.0; 3], &[x], &[2]).unwrap();
        assert!(two.eval(&Linear, Some(&mut [0.0]), None, &Workers::caller_only(), |_| Ok(())).is_err());
    }
}
