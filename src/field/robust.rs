//! Robust weights: points that disagree with the others count for less, at last for nothing.
//!
//! Iteratively reweighted least squares with Tukey's biweight (Beaton and Tukey 1974): a point whose misfit is r counts for (1 - (r /
//! c)^2)^2, and for nothing from c on. c is 4.685 times the scale of the misfits, 1.4826 times their median, which gives 95% of the
//! efficiency of least squares on normal errors. A lone outlier bends a field that has cells to spare around it, and so hides; so the first
//! fit is much smoother than the one asked for, and smoothness falls from round to round (graduated as in Blake and Zisserman 1987).
//!
//! A point's value and its normal are weighed apart, so that a good point with a bad normal still counts; an outlier's normal never does.

use super::data::{Mass, Misfit};
use crate::Result;
use crate::error::try_with_capacity;

/// Factor on lambda_r in the first round.
pub const START: f64 = 1e4;

/// c / scale of Tukey's biweight.
const TUKEY: f64 = 4.685;

/// Median of |x| of a normal distribution: its inverse.
const NORMAL: f64 = 1.4826;

/// The least c of distances, in cells: what a cell cannot resolve is no outlier.
const LEAST_DISTANCE: f64 = 0.25;

/// The least c of normals: a third of a right angle.
const LEAST_NORMAL: f64 = 0.5;

/// What each point shall count for, as a factor on its share; `cell` is the longest edge of a cell, in units of D.
pub fn masses(misfits: &[Misfit], cell: f64) -> Result<impl Iterator<Item = Mass>> {
    let distance = (TUKEY * scale(misfits, |m| m.distance)?).max(LEAST_DISTANCE * cell);
    let normal = (TUKEY * scale(misfits, |m| m.normal)?).max(LEAST_NORMAL);
    Ok(misfits.iter().map(move |m| {
        let value = biweight(m.distance / distance);
        Mass { value, gradient: value * biweight(m.normal / normal) }
    }))
}

fn biweight(r: f64) -> f64 {
    let q = (1.0 - r * r).max(0.0);
    q * q
}

fn scale(misfits: &[Misfit], of: impl Fn(&Misfit) -> f64) -> Result<f64> {
    let mut sizes = try_with_capacity(misfits.len(), "the misfits of the points")?;
    sizes.extend(misfits.iter().map(of));
    let (_, median, _) = sizes.select_nth_unstable_by(misfits.len() / 2, f64::total_cmp);
    Ok(NORMAL * *median)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outliers_count_for_nothing_and_bad_normals_leave_the_value() {
        let mut misfits = vec![Misfit { value: 0.0, distance: 0.01, normal: 0.1 }; 99];
        misfits.push(Misfit { value: 0.0, distance: 0.2, normal: 0.1 });
        misfits.push(Misfit { value: 0.0, distance: 0.01, normal: 2.0 });
        let masses: Vec<Mass> = masses(&misfits, 0.02).unwrap().collect();
        assert!(masses[..99].iter().all(|m| m.value > 0.9 && m.gradient > 0.8 * m.value));
        assert_eq!(masses[99], Mass { value: 0.0, gradient: 0.0 });
        assert!(masses[100].value > 0.9 && masses[100].gradient == 0.0);
    }

    #[test]
    fn misfits_below_what_a_cell_resolves_leave_every_point_in() {
        let misfits: Vec<Misfit> = (0..100)
            .map(|i| Misfit { value: 0.0, distance: 1e-5 * f64::from(i % 7), normal: 0.0 })
            .chain([Misfit { value: 0.0, distance: 1e-3, normal: 0.0 }])
            .collect();
        assert!(masses(&misfits, 0.02).unwrap().all(|m| m.value > 0.9));
    }
}
