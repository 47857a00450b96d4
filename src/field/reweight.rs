//! Reweighting: what turns least squares towards the least maximum.
//!
//! The energy (10) is a sum of squares, so its minimum gives small features away for a better sum; paper 000, section 4.2, sees
//! its largest error grow with the number of points for that reason. A constraint is only as good as its largest error. So after a solve
//! points that are far from the surface phi = 0 count for more, and the solve goes on from where it was (Lawson's algorithm, in its tame
//! form: Rice and Usow 1968).

use super::data::Misfit;

/// A point counts for more from this many root-mean-square distances on.
const TOLERATED: f64 = 1.5;

/// What one round may multiply a weight with.
const LARGEST_FACTOR: f64 = 16.0;

/// |grad phi| below which a field is taken to be flat, so that |phi| / |grad phi| stays a distance.
pub const FLATTEST: f64 = 0.1;

/// Relative residual to which the rounds before the last are solved, for `tolerance` in the last: as much as tells far points from near
/// ones; but where the caller asks for digits, all of them, since the weights carry an error on.
pub fn rough_tolerance(tolerance: f64) -> f64 {
    const ROUGH: f64 = 1e-2;
    const DIGITS_BELOW: f64 = 1e-5;
    if tolerance < DIGITS_BELOW { tolerance } else { tolerance.max(ROUGH) }
}

/// The factors of the weights, by the points' distances.
pub fn factors(misfits: &[Misfit]) -> impl Iterator<Item = f64> {
    let rms = (misfits.iter().map(|m| m.distance * m.distance).sum::<f64>() / misfits.len() as f64).sqrt();
    let tolerated = TOLERATED * rms;
    misfits.iter().map(move |m| if rms > 0.0 { (m.distance / tolerated).clamp(1.0, LARGEST_FACTOR) } else { 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factors_of(distances: &[f64]) -> Vec<f64> {
        let misfits: Vec<Misfit> = distances.iter().map(|&distance| Misfit { distance, ..Misfit::default() }).collect();
        factors(&misfits).collect()
    }

    #[test]
    fn near_points_keep_their_weight_and_far_ones_gain_within_bounds() {
        let mut d = vec![0.1; 1000];
        (d[0], d[1]) = (0.35, 3.0);
        let f = factors_of(&d);
        assert!(f[2..].iter().all(|f| *f == 1.0));
        assert!(f[0] > 1.0 && f[0] < f[1] && f[1] < LARGEST_FACTOR);
        d[1] = 100.0;
        assert_eq!(factors_of(&d)[1], LARGEST_FACTOR);
    }

    #[test]
    fn a_perfect_fit_changes_nothing() {
        assert_eq!(factors_of(&[0.0; 3]), [1.0; 3]);
    }
}
