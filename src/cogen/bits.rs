//! Sets of cells.

use crate::Result;
use crate::error::try_vec;
use std::ops::Range;

/// A set of numbers below `len`, a bit each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bits {
    words: Vec<u64>,
    len: usize,
}

impl Bits {
    /// The empty set.
    pub fn none(len: usize) -> Result<Self> {
        Ok(Bits { words: try_vec(len.div_ceil(64), 0, "a set of cells")?, len })
    }

    /// All numbers below `len`.
    pub fn all(len: usize) -> Result<Self> {
        let mut bits = Bits { words: try_vec(len.div_ceil(64), !0, "a set of cells")?, len };
        if let Some(last) = bits.words.last_mut()
            && !len.is_multiple_of(64)
        {
            *last = (1 << (len % 64)) - 1;
        }
        Ok(bits)
    }

    /// The numbers of which `is_in` says so.
    pub fn of(len: usize, is_in: impl Fn(usize) -> bool) -> Result<Self> {
        let mut bits = Bits::none(len)?;
        (0..len).filter(|&i| is_in(i)).for_each(|i| bits.insert(i));
        Ok(bits)
    }

    /// Numbers that could be in the set.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether no number could be in the set.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether `i` is in the set.
    #[inline]
    pub fn has(&self, i: usize) -> bool {
        self.words[i / 64] >> (i % 64) & 1 == 1
    }

    /// Puts `i` into the set.
    #[inline]
    pub fn insert(&mut self, i: usize) {
        self.words[i / 64] |= 1 << (i % 64);
    }

    /// Takes `i` out of the set.
    #[inline]
    pub fn remove(&mut self, i: usize) {
        self.words[i / 64] &= !(1 << (i % 64));
    }

    /// How many are in the set.
    pub fn count(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }

    /// The numbers in the set, in order.
    pub fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        self.words.iter().enumerate().flat_map(|(k, &w)| ones(w).map(move |b| 64 * k + b))
    }

    /// Takes out what `other` has.
    pub fn subtract(&mut self, other: &Bits) {
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a &= !b);
    }

    /// Puts in what `other` has.
    pub fn unite(&mut self, other: &Bits) {
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a |= b);
    }

    /// Keeps what `other` has too.
    pub fn intersect(&mut self, other: &Bits) {
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a &= b);
    }

    /// Takes out a range.
    #[inline]
    pub fn remove_range(&mut self, range: Range<usize>) {
        pieces(range, |k, mask| self.words[k] &= !mask);
    }

    /// Puts in a range.
    #[inline]
    pub fn insert_range(&mut self, range: Range<usize>) {
        pieces(range, |k, mask| self.words[k] |= mask);
    }

    /// Whether one of the range is in the set.
    #[inline]
    pub fn has_some(&self, range: Range<usize>) -> bool {
        let mut some = 0;
        pieces(range, |k, mask| some |= self.words[k] & mask);
        some != 0
    }

    /// The first of the range in the set.
    #[inline]
    pub fn first_in(&self, range: Range<usize>) -> Option<usize> {
        let mut first = None;
        pieces(range, |k, mask| {
            let found = self.words[k] & mask;
            if first.is_none() && found != 0 {
                first = Some(64 * k + found.trailing_zeros() as usize);
            }
        });
        first
    }

    /// Calls `take` for each of the range in the set, in order.
    #[inline]
    pub fn each_in(&self, range: Range<usize>, mut take: impl FnMut(usize)) {
        pieces(range, |k, mask| ones(self.words[k] & mask).for_each(|b| take(64 * k + b)));
    }
}

/// Calls `of` for each word that the range has a part of, with that part.
#[inline]
fn pieces(range: Range<usize>, mut of: impl FnMut(usize, u64)) {
    let (mut at, end) = (range.start, range.end);
    while at < end {
        let (k, from) = (at / 64, at % 64);
        let n = (64 - from).min(end - at);
        of(k, (!0 >> (64 - n)) << from);
        at += n;
    }
}

/// Places of the ones of a word, in order.
#[inline]
fn ones(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let b = word.trailing_zeros() as usize;
        if word == 0 {
            return None;
        }
        word &= word - 1;
        Some(b)
    })
}

/// A set that is filled, read in order, and emptied again, over and over: which words are not 0 is known without looking at them.
#[derive(Debug)]
pub struct Marks {
    words: Vec<u64>,
    /// A bit for each word, set where that is not 0.
    used: Vec<u64>,
}

impl Marks {
    /// The empty set of numbers below `len`.
    pub fn new(len: usize) -> Result<Self> {
        let n = len.div_ceil(64);
        Ok(Marks { words: try_vec(n, 0, "a set of cells")?, used: try_vec(n.div_ceil(64), 0, "a set of cells")? })
    }

    /// Puts in a range.
    #[inline]
    pub fn insert_range(&mut self, range: Range<usize>) {
        let Marks { words, used } = self;
        pieces(range, |k, mask| {
            words[k] |= mask;
            used[k / 64] |= 1 << (k % 64);
        });
    }

    /// Calls `run` for each longest range of those that are in `within` too, in order, and empties the set; the first error of `run`, for
    /// which the rest is not called.
    pub fn take_runs(&mut self, within: &Bits, run: &mut dyn FnMut(Range<usize>) -> Result<()>) -> Result<()> {
        let mut done = Ok(());
        self.drain(within, |range| {
            if done.is_ok() {
                done = run(range);
            }
        });
        done
    }

    fn drain(&mut self, within: &Bits, mut run: impl FnMut(Range<usize>)) {
        // The range that may go on in the next word.
        let mut open: Option<Range<usize>> = None;
        let Marks { words, used } = self;
        for (j, many) in used.iter_mut().enumerate() {
            for k in ones(std::mem::take(many)).map(|b| 64 * j + b) {
                let mut word = std::mem::take(&mut words[k]) & within.words[k];
                while word != 0 {
                    let from = word.trailing_zeros() as usize;
                    let n = (word >> from).trailing_ones() as usize;
                    word &= if n == 64 { 0 } else { !(((1 << n) - 1) << from) };
                    let next = 64 * k + from..64 * k + from + n;
                    match &mut open {
                        Some(range) if range.end == next.start => range.end = next.end,
                        Some(range) => run(std::mem::replace(range, next)),
                        None => open = Some(next),
                    }
                }
            }
        }
        if let Some(range) = open {
            run(range);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        #[test]
        fn sets_are_as_those_of_the_library(ranges in prop::collection::vec((0..500_usize, 0..200_usize), 0..20), ask in 0..600_usize) {
            let len = 700;
            let within = Bits::of(len, |i| i % 97 != 5).unwrap();
            let (mut marks, mut bits, mut set) = (Marks::new(len).unwrap(), Bits::all(len).unwrap(), BTreeSet::new());
            for (from, n) in ranges {
                marks.insert_range(from..from + n);
                bits.remove_range(from..from + n);
                set.extend(from..from + n);
            }
            let rest: Vec<usize> = (0..len).filter(|i| !set.contains(i)).collect();
            prop_assert_eq!(bits.iter().collect::<Vec<_>>(), rest.clone());
            prop_assert_eq!(bits.count(), rest.len());
            prop_assert_eq!(bits.first_in(ask..ask + 90), rest.iter().copied().find(|i| (ask..ask + 90).contains(i)));
            prop_assert_eq!(bits.has_some(ask..ask + 90), bits.first_in(ask..ask + 90).is_some());
            let mut each = Vec::new();
            bits.each_in(ask..ask + 90, |i| each.push(i));
            prop_assert_eq!(each, rest.into_iter().filter(|i| (ask..ask + 90).contains(i)).collect::<Vec<_>>());

            let mut runs: Vec<Range<usize>> = Vec::new();
            marks.drain(&within, |run| runs.push(run));
            prop_assert!(runs.windows(2).all(|w| w[0].end < w[1].start));
            let taken: Vec<usize> = runs.into_iter().flatten().collect();
            prop_assert_eq!(taken, set.into_iter().filter(|&i| within.has(i)).collect::<Vec<_>>());
            marks.drain(&within, |_| panic!("it is not empty"));
        }
    }

    #[test]
    fn small_sets_are_exact() {
        for len in [0, 1, 63, 64, 65, 128] {
            let all = Bits::all(len).unwrap();
            assert_eq!((all.count(), all.len()), (len, len));
            assert_eq!(Bits::none(len).unwrap().count(), 0);
        }
    }
}
