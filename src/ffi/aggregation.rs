//! `ko_aggregation`, and aggregates of any values.

use super::guard::guard;
use super::pointer::{Sized_, array, check_wanted_place, read_sized_or, tell, wanted, write_sized};
use crate::constraint::{Aggregation, Derivatives, Extreme, Kind, Side, aggregate};
use crate::{Error, Result};

/// No aggregate: a value a sample.
pub const KO_AGGREGATE_NONE: i32 = 0;
/// KS (Kreisselmeier and Steinhauser 1979): -(D / rho) ln sum exp(-rho phi / D), from below within D ln(n) / rho of the least of n values.
pub const KO_AGGREGATE_KS: i32 = 1;
/// Induced exponential (Kennedy and Hicken 2015): the mean under weights exp(-rho phi / D), from above within D W / rho of the least value,
/// W Lambert's function at (n - 1) / e; from below, less D W / rho.
pub const KO_AGGREGATE_INDUCED_EXPONENTIAL: i32 = 2;
/// p-norm, p = rho, of the positive u = sqrt(1 + x^2) - x, x = phi / D, taken back by x = (1 / u - u) / 2.
pub const KO_AGGREGATE_P_NORM: i32 = 3;
/// The least value, to a rounding in which it may lie above it, with the gradient of the first sample that has it. Not smooth: no Hessian,
/// and a gradient that jumps.
pub const KO_AGGREGATE_MINIMUM: i32 = 4;

/// The aggregate is at most the least value: where it is positive, all values are. The safe side.
pub const KO_BELOW: i32 = 0;
/// The aggregate is at least the least value.
pub const KO_ABOVE: i32 = 1;

/// The least of the values: feasible where all are, the intersection of feasible sets.
pub const KO_LEAST: i32 = 0;
/// The largest of the values: feasible where one is, the union of feasible sets. KO_BELOW is below the largest value, the safe side here too.
pub const KO_LARGEST: i32 = 1;

/// How values of samples become one. Initialise by `ko_aggregation_init`, then set what shall differ.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_aggregation {
    /// sizeof(ko_aggregation), set by ko_aggregation_init.
    pub struct_size: usize,
    /// rho, without unit, in [1, 1e9]: the larger, the nearer to the least value, and the more curved. Default 500: KS is then within 1.9 %
    /// of D of the least of 10,000 values, and mostly much nearer. Means nothing with KO_AGGREGATE_NONE and KO_AGGREGATE_MINIMUM.
    pub sharpness: f64,
    /// KO_AGGREGATE_KS (default) or another KO_AGGREGATE_.
    pub kind: i32,
    /// KO_BELOW (default) or KO_ABOVE: the side of the least value on which the aggregate lies for certain, but for rounding.
    pub side: i32,
}

// SAFETY: repr(C), starts with a usize, plain numbers without padding (checked below).
unsafe impl Sized_ for ko_aggregation {
    const FIRST_SIZE: usize = size_of::<usize>() + 16;
}

const _: () = assert!(size_of::<ko_aggregation>() == <ko_aggregation as Sized_>::FIRST_SIZE);

/// Fills `aggregation` with the defaults. `struct_size` is sizeof *aggregation.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_aggregation_init(aggregation: *mut ko_aggregation, struct_size: usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(aggregation, struct_size, ko_aggregation::defaults(), "aggregation") }
    })
}

impl ko_aggregation {
    fn defaults() -> Self {
        ko_aggregation {
            struct_size: size_of::<ko_aggregation>(),
            sharpness: Aggregation::default().sharpness,
            kind: KO_AGGREGATE_KS,
            side: KO_BELOW,
        }
    }

    /// The aggregation at `pointer`, or the default for NULL.
    ///
    /// # Safety
    /// `pointer` is NULL or points to as many bytes as its `struct_size` says.
    pub(super) unsafe fn read(pointer: *const Self) -> Result<Aggregation> {
        // SAFETY: the caller's promise.
        let Self { kind, sharpness, side, .. } = unsafe { read_sized_or(pointer, Self::defaults(), "aggregation") }?;
        let wrong = |text: String| Err(Error::InvalidArgument(text));
        let kind = match kind {
            KO_AGGREGATE_NONE => Kind::None,
            KO_AGGREGATE_KS => Kind::Ks,
            KO_AGGREGATE_INDUCED_EXPONENTIAL => Kind::InducedExponential,
            KO_AGGREGATE_P_NORM => Kind::PNorm,
            KO_AGGREGATE_MINIMUM => Kind::Minimum,
            other => return wrong(format!("kind is {other}; it must be a KO_AGGREGATE_ constant, 0 to 4")),
        };
        let side = match side {
            KO_BELOW => Side::Below,
            KO_ABOVE => Side::Above,
            other => return wrong(format!("side is {other}; it must be KO_BELOW (0) or KO_ABOVE (1)")),
        };
        let aggregation = Aggregation { kind, sharpness, side };
        aggregation.validate()?;
        Ok(aggregation)
    }
}

/// The end of the values that a constant names.
pub(super) fn extreme_of(extreme: i32) -> Result<Extreme> {
    match extreme {
        KO_LEAST => Ok(Extreme::Least),
        KO_LARGEST => Ok(Extreme::Largest),
        other => Err(Error::InvalidArgument(format!("extreme is {other}; it must be KO_LEAST (0) or KO_LARGEST (1)"))),
    }
}

/// Aggregates `values` [n_values], of fields or the caller's own constraints, to `*value`, with `gradient` [n_values], its derivatives by
/// the values, and `hessian` [n_values * (n_values + 1) / 2], the lower triangle of the second ones, row by row; each may be NULL.
///
/// `aggregation` NULL: KS. `extreme` is KO_LEAST or KO_LARGEST, `unit` the length D that rho is in: that of `ko_field_get_report`, or the
/// size of the values.
/// Errors: KO_ERR_INVALID_ARGUMENT for no values, for one that is not finite or beyond 1e12 units, naming the first, for a unit outside
/// [1e-90, 1e90], for KO_AGGREGATE_NONE; KO_ERR_UNSUPPORTED for a Hessian of KO_AGGREGATE_MINIMUM. Threads: any. Cost: some 20 ns a value,
/// and a nanosecond an entry of the Hessian; no allocation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_aggregate(
    aggregation: *const ko_aggregation,
    extreme: i32,
    unit: f64,
    values: *const f64,
    n_values: usize,
    value: *mut f64,
    gradient: *mut f64,
    hessian: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for NULL or an initialised struct.
        let aggregation = unsafe { ko_aggregation::read(aggregation) }?;
        // SAFETY: the header asks for an array of this length.
        let values = unsafe { array(values, n_values, "values") }?;
        let extreme = extreme_of(extreme)?;
        check_wanted_place(value, "value")?;
        let n_hessian = n_values.saturating_add(1).saturating_mul(n_values) / 2;
        // SAFETY: the header asks for NULL or arrays of these lengths.
        let (gradient, hessian) =
            unsafe { (wanted(gradient, n_values, "gradient")?, wanted(hessian, n_hessian, "hessian")?) };
        let found = aggregate(aggregation, extreme, unit, values, Derivatives { gradient, hessian })?;
        // SAFETY: the header asks for NULL or a place to write.
        unsafe { tell(value, found) }
    })
}

/// Tells how far an aggregate of KO_LEAST may lie from the least of `n_values` values: `*below` it and `*above` it, in units of D, not
/// negative. Each may be NULL. Beyond them come roundings of some 1e-15 times the values and D.
///
/// `aggregation` NULL: KS. `least` is the least value in units of D; it counts for KO_AGGREGATE_P_NORM alone.
/// Errors: KO_ERR_INVALID_ARGUMENT for no values and a `least` that is not finite or beyond 1e12 in size. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_aggregation_bounds(
    aggregation: *const ko_aggregation,
    n_values: usize,
    least: f64,
    below: *mut f64,
    above: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for NULL or an initialised struct.
        let aggregation = unsafe { ko_aggregation::read(aggregation) }?;
        if n_values == 0 {
            return Err(Error::InvalidArgument("n_values is 0; at least 1 is needed".into()));
        }
        if !(-1e12..=1e12).contains(&least) {
            return Err(Error::InvalidArgument(format!("least is {least}; it must lie in [-1e12, 1e12]")));
        }
        check_wanted_place(below, "below")?;
        check_wanted_place(above, "above")?;
        for (to, bound) in [below, above].into_iter().zip(aggregation.bounds(n_values, least)) {
            // SAFETY: the header asks for NULL or a place to write.
            unsafe { tell(to, bound) }?;
        }
        Ok(())
    })
}
