//! Weights of cells as whole numbers, which cuts take: areas and volumes, or what an outside objective makes of them.
//!
//! Weights that are whole multiples of one number, such as those of equal cells, stay what they are. Others are rounded up to multiples of a
//! small fraction of their sum: no pair then weighs more than its whole numbers say, so that bounds hold.

use crate::error::try_vec;
use crate::geometry::vec::number;
use crate::{Error, Result};

/// Whole numbers of a cut may sum up to this.
pub const MOST_OF_CUT: u64 = 1 << 40;

/// Those of a family: their products must fit 64 bits.
pub const MOST_OF_FAMILY: u64 = u32::MAX as u64;

/// The common number that weights are multiples of may be the smallest of them divided by this.
const MOST_PARTS: u32 = 64;

/// What the cells of a part weigh.
#[derive(Debug, Clone, Copy)]
pub enum Weights<'a> {
    /// Each what is given for it, `[n]`, not below 0.
    Each(&'a [f64]),
    /// All the same.
    Even {
        /// Of each cell.
        weight: f64,
        /// n
        n_cells: usize,
    },
}

/// Weights of N parts' cells in whole numbers, and what 1 stands for.
#[derive(Debug)]
pub struct CellWeights<const N: usize> {
    units: [Vec<u64>; N],
    unit: f64,
}

impl Weights<'_> {
    fn len(&self) -> usize {
        match self {
            Weights::Each(weights) => weights.len(),
            Weights::Even { n_cells, .. } => *n_cells,
        }
    }

    fn at(&self, i: usize) -> f64 {
        match self {
            Weights::Each(weights) => weights[i],
            Weights::Even { weight, .. } => *weight,
        }
    }

    /// Those that differ.
    fn values(&self) -> &[f64] {
        match self {
            Weights::Each(weights) => weights,
            Weights::Even { weight, .. } => std::slice::from_ref(weight),
        }
    }
}

impl<const N: usize> CellWeights<N> {
    /// In numbers whose sum is at most `most`.
    pub fn new(weights: [Weights<'_>; N], most: u64) -> Result<Self> {
        for (k, of) in weights.iter().enumerate() {
            if let Some((i, x)) = of.values().iter().enumerate().find(|(_, x)| !(**x >= 0.0 && x.is_finite())) {
                let of_part = if N > 1 { format!(" of part {}", k + 1) } else { String::new() };
                let text = format!("weight {i}{of_part} is {}; it must be at least 0 and finite", number(*x));
                return Err(Error::InvalidArgument(text));
            }
        }
        let n = weights.iter().map(Weights::len).sum::<usize>() as u64;
        if n > most / 2 {
            return Err(Error::InvalidArgument(format!("{n} cells are too many to weigh; at most {}", most / 2)));
        }
        let sum = weights.iter().map(|of| (0..of.len()).map(|i| of.at(i)).sum::<f64>()).sum::<f64>();
        if !sum.is_finite() {
            return Err(Error::InvalidArgument("the weights' sum is not finite; it must be".into()));
        }
        let values = || weights.iter().flat_map(|of| of.values()).copied().filter(|x| *x > 0.0);
        let least = values().fold(f64::INFINITY, f64::min);
        let is_unit = |unit: f64| sum / unit < most as f64 && values().all(|x| is_whole(x / unit));
        // With none above 0 each is a multiple of anything.
        let whole =
            if sum > 0.0 { (1..=MOST_PARTS).map(|q| least / f64::from(q)).find(|u| is_unit(*u)) } else { Some(1.0) };
        let unit = whole.unwrap_or(sum / (most - n) as f64 * (1.0 + 1e-9));
        let of = |k: usize| -> Result<Vec<u64>> {
            let mut units = try_vec(weights[k].len(), 0, "the cells' weights")?;
            for (i, to) in units.iter_mut().enumerate() {
                let x = weights[k].at(i) / unit;
                *to = if whole.is_some() { x.round() } else { x.ceil() } as u64;
            }
            Ok(units)
        };
        let mut all = [const { Vec::new() }; N];
        for (k, units) in all.iter_mut().enumerate() {
            *units = of(k)?;
        }
        Ok(CellWeights { units: all, unit })
    }

    /// The whole numbers, `[n]` for each part.
    pub fn units(&self) -> [&[u64]; N] {
        self.units.each_ref().map(Vec::as_slice)
    }

    /// What 1 stands for.
    pub fn unit(&self) -> f64 {
        self.unit
    }
}

/// Whether `x` is a whole number but for rounding.
fn is_whole(x: f64) -> bool {
    (x - x.round()).abs() <= 1e-9 * x
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn units(weights: [Weights<'_>; 2], most: u64) -> (Vec<u64>, Vec<u64>, f64) {
        let found = CellWeights::new(weights, most).unwrap();
        let [a, b] = found.units();
        (a.to_vec(), b.to_vec(), found.unit())
    }

    #[test]
    fn areas_and_volumes_stay_what_they_are() {
        let even = |edge: f64, n_cells| Weights::Even { weight: edge.powi(2), n_cells };
        assert_eq!(units([even(0.02, 2), even(0.02, 1)], 100).0, [1, 1]);
        let (one, two, unit) = units([even(0.02, 2), even(0.03, 1)], 100);
        assert_eq!((&one[..], &two[..]), (&[4, 4][..], &[9][..]));
        assert!((unit - 1e-4).abs() < 1e-18);
        assert_eq!(units([Weights::Each(&[0.0, 0.0]), Weights::Each(&[])], 100).0, [0, 0]);
    }

    #[test]
    fn what_is_no_weight_is_refused() {
        let told =
            |x: f64| CellWeights::new([Weights::Each(&[1.0]), Weights::Each(&[2.0, x])], 100).unwrap_err().to_string();
        assert!(told(-1.0).contains("weight 1 of part 2 is -1") && told(f64::NAN).contains("NaN"));
        assert!(told(f64::INFINITY).contains("finite"));
    }

    proptest! {
        #[test]
        fn rounded_weights_are_no_less_and_little_more(
            v in prop::collection::vec(0.0..3.0_f64, 1..40),
            w in prop::collection::vec(0.0..1e3_f64, 0..9),
        ) {
            let most = 1 << 20;
            let (one, two, unit) = units([Weights::Each(&v), Weights::Each(&w)], most);
            prop_assert!(one.iter().chain(&two).sum::<u64>() <= most);
            for (x, n) in v.iter().chain(&w).zip(one.iter().chain(&two)) {
                let up = *n as f64 * unit;
                prop_assert!(up >= x * (1.0 - 1e-9) && up <= x + unit, "{x} {up} {unit}");
            }
        }
    }
}
