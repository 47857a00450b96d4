//! Reweighting: what turns least squares towards the least maximum.
//!
//! The energy (10) is a sum of squares, so its minimum gives small features away for a better sum; paper 000, section 4.2, sees
//! its largest error grow with the number of points for that reason. A constraint is only as good as its largest error. So after a solve
//! points that are far from the surface phi = 0 count for more, and the solve goes on from where it was (Lawson's algorithm, in its tame
//! form: Rice and Usow 1968).

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

/// Turns distances `[N]` into the factors of the weights.
pub fn factors(distances: &mut [f64]) {
    let rms = (distances.iter().map(|d| d * d).sum::<f64>() / distances.len() as f64).sqrt();
    if rms == 0.0 {
        distances.fill(1.0);
        return;
    }
    for d in distances {
        *d = (*d / (TOLERATED * rms)).clamp(1.0, LARGEST_FACTOR);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_points_keep_their_weight_and_far_ones_gain_within_bounds() {
        let mut d = vec![0.1; 1000];
        d[0] = 0.35;
        d[1] = 3.0;
        factors(&mut d);
        assert!(d[2..].iter().all(|f| *f == 1.0));
        assert!(d[0] > 1.0 && d[0] < d[1] && d[1] < LARGEST_FACTOR);
        let mut d = vec![0.1; 1000];
        d[1] = 100.0;
        factors(&mut d);
        assert_eq!(d[1], LARGEST_FACTOR);
    }

    #[test]
    fn a_perfect_fit_changes_nothing() {
        let mut d = vec![0.0; 3];
        factors(&mut d);
        assert_eq!(d, [1.0; 3]);
    }
}
