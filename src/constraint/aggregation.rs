//! One number for many: smooth stand-ins for the least of phi over some samples, with bounds, gradients and Hessians.
//!
//! Notation: x_i = phi_i / D, rho the sharpness, without unit; m the least x; e_i = exp(-rho (x_i - m)), S = sum e_i, a_i = e_i / S.
//!
//! | aggregate | below the least value | above it |
//! |---|---|---|
//! | KS (Kreisselmeier and Steinhauser 1979; paper 000, 3.5) | D (m - ln(S) / rho) | D (m - ln(S / n) / rho) |
//! | induced exponential (Kennedy and Hicken 2015) | sum a_i phi_i - D W / rho | sum a_i phi_i |
//! | p-norm, p = rho, of u_i = sqrt(1 + x_i^2) - x_i | D (1 / U - U) / 2, U = (sum u_i^p)^(1 / p) | the same of U / n^(1 / p) |
//! | minimum | min | min, not smooth |
//!
//! How far below or above is at most what the two differ by: D ln(n) / rho, D W / rho, and for the p-norm what U differs by; each lies on
//! its side for certain, but for rounding. W = W_0((n - 1) / e), W_0 Lambert's function: the excess of the induced exponential, sum t_i
//! e^-t_i / (1 + sum e^-t_i) with t = rho (x - m), is largest where all t_i but the least are one and the same t with (t - 1) e^(t - 1) =
//! (n - 1) / e, and t - 1 then. The transform u of the p-norm is positive, falls with x, and has the inverse (1 / u - u) / 2. As u =
//! exp(-asinh(x)), the p-norm is the KS of y = asinh(x), taken back by sinh; so one sum of exponentials serves all three.

use crate::{Error, Result};

/// How the values of samples become one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Not at all: a value a sample.
    None,
    /// The logarithm of a sum of exponentials.
    Ks,
    /// The mean under weights that fall exponentially.
    InducedExponential,
    /// The p-norm of a positive transform.
    PNorm,
    /// The least value, with the gradient of the first sample that has it. Not smooth.
    Minimum,
}

/// The side of the least value on which an aggregate lies for certain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Where it is positive, all values are: the safe side of a constraint.
    Below,
    /// Where it is negative, one value is.
    Above,
}

/// One number for many.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aggregation {
    /// The formula.
    pub kind: Kind,
    /// rho, without unit, in [1, 1e9]. Means nothing where there is none.
    pub sharpness: f64,
    /// Below or above the least value.
    pub side: Side,
}

impl Default for Aggregation {
    /// KS from below, within 1.9 % of D of the least of 10,000 values, and mostly much nearer.
    fn default() -> Self {
        Aggregation { kind: Kind::Ks, sharpness: 500.0, side: Side::Below }
    }
}

impl Aggregation {
    /// Checks the range of the sharpness.
    pub fn validate(self) -> Result<()> {
        let rho = self.sharpness;
        if (1.0..=1e9).contains(&rho) {
            return Ok(());
        }
        Err(Error::InvalidArgument(format!("sharpness is {rho}; it must lie in [1, 1e9]")))
    }

    /// Whether it has a Hessian.
    pub fn is_smooth(self) -> bool {
        self.kind != Kind::Minimum
    }

    /// Whether there is one value for all samples.
    pub fn is_one(self) -> bool {
        self.kind != Kind::None
    }

    /// How far below and above the least of `n` values, `least`, it may lie, but for rounding; both lengths in units of D, not negative.
    pub fn bounds(self, n: usize, least: f64) -> [f64; 2] {
        let by = self.reach(n);
        match (self.kind, self.side) {
            (Kind::PNorm, Side::Below) => [(least - (least.asinh() - by).sinh()).max(0.0), 0.0],
            (Kind::PNorm, Side::Above) => [0.0, ((least.asinh() + by).sinh() - least).max(0.0)],
            (_, Side::Below) => [by, 0.0],
            (_, Side::Above) => [0.0, by],
        }
    }

    /// What the sums of `n` values are moved by, in y, for the aggregate to lie on its side.
    pub(super) fn moved(self, n: usize) -> f64 {
        match (self.kind, self.side) {
            (Kind::Ks | Kind::PNorm, Side::Above) => self.reach(n),
            (Kind::InducedExponential, Side::Below) => -self.reach(n),
            _ => 0.0,
        }
    }

    /// What the aggregates of `n` values on the two sides differ by, in y.
    fn reach(self, n: usize) -> f64 {
        let n = n.max(1) as f64;
        match self.kind {
            Kind::Ks | Kind::PNorm => n.ln() / self.sharpness,
            Kind::InducedExponential => excess(n) / self.sharpness,
            Kind::None | Kind::Minimum => 0.0,
        }
    }
}

/// W_0((n - 1) / e)
fn excess(n: f64) -> f64 {
    let x = (n - 1.0) / std::f64::consts::E;
    if x == 0.0 {
        return 0.0;
    }
    // Newton's method on w + ln(w) = ln(x): a few steps to the last bit.
    let mut w = x.ln_1p();
    for _ in 0..20 {
        w *= (1.0 + x.ln() - w.ln()) / (1.0 + w);
    }
    w
}

/// Sums of exponentials over samples, of which the least is found on the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SoftMin {
    /// m, of y.
    pub least: f64,
    /// S
    pub sum: f64,
    /// sum e (y - m), in units of D.
    pub first: f64,
}

impl SoftMin {
    /// Of no sample.
    pub const EMPTY: Self = SoftMin { least: f64::INFINITY, sum: 0.0, first: 0.0 };

    /// Brings the sums to a `least` that is no larger.
    fn lower(&mut self, least: f64, rho: f64) {
        if self.sum > 0.0 {
            let by = self.least - least;
            let factor = (-rho * by).exp();
            self.first = factor * (self.first + by * self.sum);
            self.sum *= factor;
        }
        self.least = least;
    }

    /// Takes in other sums.
    pub fn merge(&mut self, mut other: Self, rho: f64) {
        let least = self.least.min(other.least);
        self.lower(least, rho);
        other.lower(least, rho);
        self.sum += other.sum;
        self.first += other.first;
    }
}

/// An aggregate whose sums are known: its value, and what each sample counts for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Aggregate {
    of: Aggregation,
    /// D
    unit: f64,
    sums: SoftMin,
    /// What it is moved by, in y, to its side.
    moved: f64,
    /// The KS of y, moved.
    soft: f64,
}

/// How an aggregate changes with the value of one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SampleWeight {
    /// a, of sum 1.
    pub share: f64,
    /// The first derivative w.
    pub first: f64,
    /// The diagonal's part of the second derivative.
    pub second: f64,
}

impl Aggregate {
    /// Of `n` samples with these `sums`.
    pub fn new(of: Aggregation, unit: f64, sums: SoftMin, n: usize) -> Self {
        Self::moved_by(of, unit, sums, of.moved(n))
    }

    /// Of samples with these `sums`, for whose number [`Aggregation::moved`] gives `moved`.
    pub fn moved_by(of: Aggregation, unit: f64, sums: SoftMin, moved: f64) -> Self {
        let soft = sums.least - sums.sum.ln() / of.sharpness + moved;
        Aggregate { of, unit, sums, moved, soft }
    }

    /// The value.
    pub fn value(&self) -> f64 {
        let SoftMin { least, sum, first } = self.sums;
        self.unit
            * match self.of.kind {
                Kind::Ks => self.soft,
                Kind::InducedExponential => least + first / sum + self.moved,
                Kind::PNorm => self.soft.sinh(),
                Kind::Minimum | Kind::None => least,
            }
    }

    /// What sums of e y' and e (y - m) are multiplied with to be the first derivative.
    pub fn of_moments(&self) -> [f64; 2] {
        let SoftMin { sum, first, .. } = self.sums;
        match self.of.kind {
            Kind::InducedExponential => [(1.0 + self.of.sharpness * first / sum) / sum, -self.of.sharpness / sum],
            Kind::PNorm => [self.soft.cosh() / sum, 0.0],
            _ => [1.0 / sum, 0.0],
        }
    }

    /// How the value changes with a sample of value `phi`.
    pub fn weight(&self, phi: f64) -> SampleWeight {
        // Rounded as in the sums, and none below the least: far away a last bit would be a large exponent.
        let x = phi * (1.0 / self.unit);
        let t = y_of(self.of.kind, x).max(self.sums.least) - self.sums.least;
        self.weight_of(x, t, (-self.of.sharpness * t).exp())
    }

    /// The same of a sample of which x, t = y - m and `e` = exp(-rho t) are known.
    #[inline]
    pub fn weight_of(&self, x: f64, t: f64, e: f64) -> SampleWeight {
        let SoftMin { sum, first, .. } = self.sums;
        let (rho, d) = (self.of.sharpness, self.unit);
        let share = e / sum;
        match self.of.kind {
            Kind::InducedExponential => {
                let w = share * (1.0 - rho * (t - first / sum));
                SampleWeight { share, first: w, second: -rho / d * (w + share) }
            }
            Kind::PNorm => {
                // y' = 1 / sqrt(1 + x^2), y'' = -x y'^3
                let slope = slope(x);
                let c = self.soft.cosh();
                let second = c / d * share * slope * slope * (-rho - x * slope);
                SampleWeight { share, first: c * share * slope, second }
            }
            Kind::Ks => SampleWeight { share, first: share, second: -rho / d * share },
            Kind::Minimum | Kind::None => SampleWeight { share, first: share, second: 0.0 },
        }
    }

    /// The second derivative's part that couples samples: c (w, w) and c ((a, w) + (w, a)).
    pub fn coupling(&self) -> [f64; 2] {
        let (rho, d) = (self.of.sharpness, self.unit);
        match self.of.kind {
            Kind::Ks => [rho / d, 0.0],
            Kind::InducedExponential => [0.0, rho / d],
            Kind::PNorm => {
                // (sinh + rho cosh) / cosh^2
                [(self.soft.tanh() + rho) / (d * self.soft.cosh()), 0.0]
            }
            Kind::Minimum | Kind::None => [0.0; 2],
        }
    }
}

/// dy / dx where y is asinh(x).
#[inline(always)]
pub(super) fn slope(x: f64) -> f64 {
    1.0 / (1.0 + x * x).sqrt()
}

/// y, of which the exponentials are.
#[inline(always)]
pub(super) fn y_of(kind: Kind, x: f64) -> f64 {
    if kind == Kind::PNorm { x.asinh() } else { x }
}

/// Which end of the values is aggregated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extreme {
    /// The least: the intersection of feasible sets, positive where all are.
    Least,
    /// The largest, the negative of the least of the negatives: the union of feasible sets, positive where one is.
    Largest,
}

impl Extreme {
    /// The sign with which values, and their aggregate, come from and go to an aggregate of the least; and that aggregate for `of`.
    pub(super) fn by_the_least(self, of: Aggregation) -> (f64, Aggregation) {
        match (self, of.side) {
            (Extreme::Least, _) => (1.0, of),
            // Below the largest is above the least of the negatives.
            (Extreme::Largest, Side::Below) => (-1.0, Aggregation { side: Side::Above, ..of }),
            (Extreme::Largest, Side::Above) => (-1.0, Aggregation { side: Side::Below, ..of }),
        }
    }
}

/// Where the results of [`aggregate`] go; `None` where one is not wanted.
#[derive(Default)]
pub struct Derivatives<'a> {
    /// d J / d phi_i `[n]`
    pub gradient: Option<&'a mut [f64]>,
    /// d^2 J / d phi_i d phi_j, rows of the lower triangle [n (n + 1) / 2], in 1 / the unit of phi.
    pub hessian: Option<&'a mut [f64]>,
}

/// The aggregate of `values`, with D the `unit`: any numbers, the caller's own constraints too. [`Side::Below`] is below the least, or the
/// largest, value.
pub fn aggregate(of: Aggregation, extreme: Extreme, unit: f64, values: &[f64], wanted: Derivatives) -> Result<f64> {
    check(of, unit, values, &wanted)?;
    let (sign, of) = extreme.by_the_least(of);
    let signed = values.iter().map(|v| sign * v);
    if of.kind == Kind::Minimum {
        let at = first_least(signed);
        if let Some(gradient) = wanted.gradient {
            gradient.fill(0.0);
            gradient[at] = 1.0;
        }
        return Ok(values[at]);
    }
    let one = Aggregate::new(of, unit, sums(of, unit, signed), values.len());
    let weight = |i: usize| one.weight(sign * values[i]);
    if let Some(gradient) = wanted.gradient {
        (0..values.len()).for_each(|i| gradient[i] = weight(i).first);
    }
    if let Some(hessian) = wanted.hessian {
        let [ww, aw] = one.coupling();
        let mut rest = hessian;
        for i in 0..values.len() {
            let (row, behind) = rest.split_at_mut(i + 1);
            let wi = weight(i);
            for (j, h) in row.iter_mut().enumerate() {
                let wj = weight(j);
                let own = if i == j { wi.second } else { 0.0 };
                let coupled = ww * wi.first * wj.first + aw * (wi.share * wj.first + wi.first * wj.share);
                *h = sign * (own + coupled);
            }
            rest = behind;
        }
    }
    Ok(sign * one.value())
}

/// The number of the first of the least values.
pub(super) fn first_least(values: impl Iterator<Item = f64>) -> usize {
    values.enumerate().fold((0, f64::INFINITY), |least, (i, v)| if v < least.1 { (i, v) } else { least }).0
}

/// The sums over `values`, which are gone through twice.
fn sums(of: Aggregation, unit: f64, values: impl Iterator<Item = f64> + Clone) -> SoftMin {
    let y = values.map(|v| y_of(of.kind, v * (1.0 / unit)));
    let least = y.clone().fold(f64::INFINITY, f64::min);
    y.fold(SoftMin { least, ..SoftMin::EMPTY }, |s, y| {
        let t = y - least;
        let e = (-of.sharpness * t).exp();
        SoftMin { sum: s.sum + e, first: s.first + e * t, ..s }
    })
}

/// Values up to this, in units of D, keep every step in the range of doubles.
const LARGEST: f64 = 1e12;

fn check(of: Aggregation, unit: f64, values: &[f64], wanted: &Derivatives) -> Result<()> {
    let wrong = |text: String| Err(Error::InvalidArgument(text));
    of.validate()?;
    if !of.is_one() {
        return wrong("no aggregation is asked for; KS, induced exponential, p-norm or minimum is needed".into());
    }
    let n = values.len();
    if n == 0 {
        return wrong("there are no values; at least 1 is needed".into());
    }
    if !(1e-90..=1e90).contains(&unit) {
        return wrong(format!("unit is {unit}; it must lie in [1e-90, 1e90]"));
    }
    // A NaN is in no range.
    let served = -LARGEST * unit..=LARGEST * unit;
    if let Some((i, v)) = values.iter().enumerate().find(|(_, v)| !served.contains(v)) {
        return wrong(format!(
            "value {i} is {v}; values must be finite, and at most {LARGEST:e} times the unit in size"
        ));
    }
    let lengths = [
        ("gradient", wanted.gradient.as_ref().map(|g| g.len()), n),
        ("hessian", wanted.hessian.as_ref().map(|h| h.len()), n * (n + 1) / 2),
    ];
    if let Some((name, len, right)) = lengths.iter().find(|(_, len, right)| len.is_some_and(|len| len != *right)) {
        return wrong(format!("{name} has {} entries; {right} are needed", len.unwrap_or(0)));
    }
    if wanted.hessian.is_some() && !of.is_smooth() {
        return Err(Error::Unsupported("the minimum is not smooth, and has no Hessian; take KS".into()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;

    const KINDS: [Kind; 3] = [Kind::Ks, Kind::InducedExponential, Kind::PNorm];

    fn all() -> impl Iterator<Item = (Aggregation, Extreme)> {
        let sides = [Side::Below, Side::Above];
        let of = KINDS.into_iter().flat_map(move |kind| {
            [3.0, 50.0].into_iter().flat_map(move |sharpness| sides.map(|side| Aggregation { kind, sharpness, side }))
        });
        of.flat_map(|of| [(of, Extreme::Least), (of, Extreme::Largest)])
    }

    fn values(n: usize, random: &mut SplitMix64) -> Vec<f64> {
        (0..n).map(|_| random.between(-3.0, 4.0) * 0.1f64.powf(random.between(0.0, 3.0))).collect()
    }

    #[test]
    fn aggregates_lie_on_their_side_within_their_bounds() {
        let mut random = SplitMix64::new(1);
        for n in [1, 2, 3, 10, 1000] {
            for (of, extreme) in all() {
                let (values, unit) = (values(n, &mut random), random.between(0.1, 10.0));
                let j = aggregate(of, extreme, unit, &values, Derivatives::default()).unwrap();
                let sign = if extreme == Extreme::Least { 1.0 } else { -1.0 };
                let end = sign * values.iter().map(|v| sign * v).fold(f64::INFINITY, f64::min);
                let (low, high) = if of.side == Side::Below { (f64::NEG_INFINITY, end) } else { (end, f64::INFINITY) };
                let slack = 1e-13 * unit;
                assert!(j >= low - slack && j <= high + slack, "{of:?} {extreme:?} of {n}: {j}, {end}");
                if extreme == Extreme::Least {
                    let [below, above] = of.bounds(n, end / unit).map(|b| b * unit + slack);
                    assert!(j >= end - below && j <= end + above, "{of:?} of {n}: {j} {end} {below} {above}");
                }
            }
        }
    }

    /// The bounds are reached: by equal values, and, of the induced exponential, where all but one lie at its worst place.
    #[test]
    fn bounds_are_tight() {
        let n = 100;
        for kind in KINDS {
            for side in [Side::Below, Side::Above] {
                let of = Aggregation { kind, sharpness: 20.0, side };
                let worst = 1.0 + excess(n as f64);
                let mut values = vec![if kind == Kind::InducedExponential { 0.3 + worst / 20.0 } else { 0.3 }; n];
                values[7] = 0.3;
                let j = aggregate(of, Extreme::Least, 1.0, &values, Derivatives::default()).unwrap();
                let [below, above] = of.bounds(n, 0.3);
                let ends = [0.3 - below, 0.3 + above];
                assert!(ends.iter().any(|end| (j - end).abs() < 1e-13), "{of:?}: {j} {ends:?}");
                // The other side is reached as well: by one value.
                let one = aggregate(of, Extreme::Least, 1.0, &[0.3], Derivatives::default()).unwrap();
                assert!((one - 0.3).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let mut random = SplitMix64::new(2);
        let n = 6;
        for (of, extreme) in all() {
            for unit in [0.3, 20.0] {
                let values: Vec<f64> = (0..n).map(|_| unit * random.between(-0.1, 0.1)).collect();
                let run = |values: &[f64]| {
                    let (mut gradient, mut hessian) = (vec![0.0; n], vec![0.0; n * (n + 1) / 2]);
                    let wanted = Derivatives { gradient: Some(&mut gradient), hessian: Some(&mut hessian) };
                    (aggregate(of, extreme, unit, values, wanted).unwrap(), gradient, hessian)
                };
                let (_, gradient, hessian) = run(&values);
                for i in 0..n {
                    let h = 1e-5 * unit;
                    let [plus, minus] = [h, -h].map(|h| {
                        let mut values = values.clone();
                        values[i] += h;
                        run(&values)
                    });
                    let slope = (plus.0 - minus.0) / (2.0 * h);
                    assert!((slope - gradient[i]).abs() < 1e-7, "{of:?} {extreme:?}: {slope} {}", gradient[i]);
                    for j in 0..=i {
                        let bend = (plus.1[j] - minus.1[j]) / (2.0 * h);
                        let own = hessian[i * (i + 1) / 2 + j];
                        assert!((bend - own).abs() * unit < 1e-5, "{of:?} {extreme:?} {i} {j}: {bend} {own}");
                    }
                }
            }
        }
    }

    #[test]
    fn sums_in_parts_are_those_of_the_whole() {
        let mut random = SplitMix64::new(4);
        let values = values(1000, &mut random);
        let of = Aggregation { sharpness: 30.0, ..Aggregation::default() };
        let whole = sums(of, 1.0, values.iter().copied());
        let mut parts = SoftMin::EMPTY;
        values.chunks(70).for_each(|part| parts.merge(sums(of, 1.0, part.iter().copied()), 30.0));
        assert!((parts.sum / whole.sum - 1.0).abs() < 1e-13 && (parts.first / whole.first - 1.0).abs() < 1e-12);
        assert_eq!(parts.least, whole.least);
    }

    #[test]
    fn far_values_and_sharp_aggregates_stay_finite() {
        for (of, extreme) in all() {
            for sharpness in [1.0, 1e9] {
                let values = [1e6, -1e6, 3.0, -1e6 + 1e-3];
                let mut gradient = [0.0; 4];
                let wanted = Derivatives { gradient: Some(&mut gradient), hessian: None };
                let j = aggregate(Aggregation { sharpness, ..of }, extreme, 1.0, &values, wanted).unwrap();
                assert!(
                    j.is_finite() && gradient.iter().all(|g| g.is_finite()),
                    "{of:?} {sharpness}: {j} {gradient:?}"
                );
            }
        }
    }

    #[test]
    fn bad_arguments_are_refused_with_what_is_wrong() {
        let text = |of: Aggregation, values: &[f64]| {
            aggregate(of, Extreme::Least, 1.0, values, Derivatives::default()).unwrap_err().to_string()
        };
        let ks = Aggregation::default();
        assert!(text(ks, &[]).contains("no values"));
        assert!(text(ks, &[1.0, f64::NAN]).contains("value 1 is NaN"));
        assert!(text(Aggregation { sharpness: 0.0, ..ks }, &[1.0]).contains("sharpness is 0"));
        assert!(text(Aggregation { kind: Kind::None, ..ks }, &[1.0]).contains("no aggregation"));
        let mut short = [0.0; 2];
        let wanted = Derivatives { gradient: Some(&mut short), hessian: None };
        assert!(aggregate(ks, Extreme::Least, 1.0, &[1.0], wanted).unwrap_err().to_string().contains("1 are needed"));
        let minimum = Aggregation { kind: Kind::Minimum, ..ks };
        let mut one = [0.0];
        let wanted = Derivatives { gradient: None, hessian: Some(&mut one) };
        assert!(matches!(aggregate(minimum, Extreme::Least, 1.0, &[1.0], wanted), Err(Error::Unsupported(_))));
    }
}
