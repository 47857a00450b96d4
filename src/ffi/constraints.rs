//! `ko_constraints`.

use super::aggregation::{extreme_of, ko_aggregation};
use super::body::ko_body;
use super::field::ko_field;
use super::guard::{guard, guard_free};
use super::mesh::check_count;
use super::pointer::{array, array_mut, check_wanted_place, create, free, object, place, tell};
use crate::constraint::{Aggregation, Constraints, Extreme, FrameId, PointsId, PoseKind, Region, Rotation, Scale};
use crate::dimension::{OfDimension, differ, in_its_dimension, no_dim};
use crate::field::Field;
use crate::{Error, Result};
use std::sync::Arc;

/// A frame that is not turned: no parameter.
pub const KO_ROTATION_NONE: i32 = 0;
/// A frame turned by a quaternion w, x, y, z of a length in [1e-6, 1e6], in space. It is divided by its length; derivatives are those by its
/// entries as they are. A row that keeps its length near 1 helps optimisers.
pub const KO_ROTATION_QUATERNION: i32 = 1;
/// A frame turned by a rotation vector, along the axis and as long as the angle in radians, in space. Near 2 pi another one is better.
pub const KO_ROTATION_VECTOR: i32 = 2;
/// A frame turned by an angle in radians, counter-clockwise, in the plane.
pub const KO_ROTATION_ANGLE: i32 = 3;

/// A frame that is not scaled: no parameter.
pub const KO_SCALE_ONE: i32 = 0;
/// A frame scaled by a parameter in [1e-30, 1e30].
pub const KO_SCALE_FREE: i32 = 1;

/// Frame 0 of all constraints: the world, which does not move.
pub const KO_WORLD: u32 = 0;

/// Requirements that samples of a design lie where fields are positive, as values, Jacobian and Hessian over one vector of variables. Freed
/// by `ko_constraints_free`.
///
/// Variables are the parameters of frames, and the coordinates of points, in the order in which they are added. A pose maps a frame to the
/// world: x_w = s R x + t, its parameters t [dim], those of the rotation, s.
#[allow(non_camel_case_types)]
pub struct ko_constraints(OfDimension<Constraints<2>, Constraints<3>>);

/// Makes a set of constraints of dimension `dim`, 2 or 3, without variables and values; `*constraints` is the caller's to free.
///
/// Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_create(dim: u32, constraints: *mut *mut ko_constraints) -> i32 {
    guard(|| {
        let make = || {
            Ok(ko_constraints(match dim {
                2 => OfDimension::Plane(Constraints::new()),
                3 => OfDimension::Space(Constraints::new()),
                _ => return Err(no_dim(dim)),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(constraints, "constraints", make) }
    })
}

/// Frees a set of constraints. NULL is taken. No other thread may be using it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_free(constraints: *mut ko_constraints) {
    // SAFETY: the header asks for NULL or constraints that were not freed.
    guard_free(|| unsafe { free(constraints) });
}

/// Adds a frame, of which all parameters are variables; `*frame` is its number.
///
/// `rotation` is a KO_ROTATION_, `scale` a KO_SCALE_ constant. Errors: KO_ERR_INVALID_ARGUMENT for others, and for a rotation of the other
/// dimension. Threads: needs the handle alone. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_add_frame(
    constraints: *mut ko_constraints,
    rotation: i32,
    scale: i32,
    frame: *mut u32,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints and a place to write.
        let (ko_constraints(set), frame) = unsafe { (place(constraints, "constraints")?, place(frame, "frame")?) };
        let kind = kind(rotation, scale)?;
        *frame = number(in_its_dimension!(set, set => set.add_frame(kind))?.0);
        Ok(())
    })
}

/// Adds a frame that stands still at a pose of `parameters` [n_parameters]; `*frame` is its number.
///
/// Errors: those of `ko_constraints_add_frame`; KO_ERR_INVALID_ARGUMENT for another number of parameters, and for one out of its range.
/// Threads: needs the handle alone. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_add_fixed_frame(
    constraints: *mut ko_constraints,
    rotation: i32,
    scale: i32,
    parameters: *const f64,
    n_parameters: usize,
    frame: *mut u32,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints and a place to write.
        let (ko_constraints(set), frame) = unsafe { (place(constraints, "constraints")?, place(frame, "frame")?) };
        // SAFETY: the header asks for an array of this length.
        let parameters = unsafe { array(parameters, n_parameters, "parameters") }?;
        let kind = kind(rotation, scale)?;
        *frame = number(in_its_dimension!(set, set => set.add_fixed_frame(kind, parameters))?.0);
        Ok(())
    })
}

/// Adds `n_points` points of the world whose coordinates [dim * n_points] are variables: of a path, or of a design that the caller moves
/// and differentiates itself. `*points` is their number.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for no points, and for more than 2^31 - 1 variables in all. Threads: needs the handle alone. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_add_points(
    constraints: *mut ko_constraints,
    n_points: usize,
    points: *mut u32,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints and a place to write.
        let (ko_constraints(set), points) = unsafe { (place(constraints, "constraints")?, place(points, "points")?) };
        *points = number(in_its_dimension!(set, set => set.add_points(n_points))?.0);
        Ok(())
    })
}

/// Requires that `body` in `frame` lies where phi of `field` in `field_frame` is positive: one value more by `aggregation` over the body's
/// points, or, with KO_AGGREGATE_NONE, one a point. `*first_value`, which may be NULL, is the number of the first.
///
/// The value is s phi, s the scale of the field's frame. Frames are numbers that `ko_constraints_add_frame` gave, or KO_WORLD. A body and a
/// field that both move are kept apart by two calls, each body's points in the other's field. `aggregation` NULL: KS. The body and the field
/// stay in use until the constraints are freed, and may be freed before.
/// Errors: KO_ERR_INVALID_ARGUMENT for another dimension, a number that is no frame's, one moving frame for both, and for more than
/// 2^31 - 1 values or entries. Threads: needs `constraints` alone. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_keep_body(
    constraints: *mut ko_constraints,
    body: *const ko_body,
    frame: u32,
    field: *const ko_field,
    field_frame: u32,
    aggregation: *const ko_aggregation,
    first_value: *mut usize,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints, a body and a field.
        let (ko_constraints(set), ko_body(body), ko_field(field)) =
            unsafe { (place(constraints, "constraints")?, object(body, "body")?, object(field, "field")?) };
        // SAFETY: the header asks for NULL or an initialised struct.
        let aggregation = unsafe { ko_aggregation::read(aggregation) }?;
        check_wanted_place(first_value, "first_value")?;
        let frames = [frame, field_frame].map(|f| FrameId(f as usize));
        let value = match (set, body, field) {
            (OfDimension::Plane(set), OfDimension::Plane(body), OfDimension::Plane(field)) => {
                set.keep_body((body.clone(), frames[0]), (field.clone(), frames[1]), aggregation)?
            }
            (OfDimension::Space(set), OfDimension::Space(body), OfDimension::Space(field)) => {
                set.keep_body((body.clone(), frames[0]), (field.clone(), frames[1]), aggregation)?
            }
            (set, body, field) => {
                return Err(differ(&[
                    ("the constraints", set.dim()),
                    ("the body", body.dim()),
                    ("the field", field.dim()),
                ]));
            }
        };
        // SAFETY: the header asks for NULL or a place to write.
        unsafe { tell(first_value, value) }
    })
}

/// Requires that the points with number `points` lie where phi of `field` in `field_frame` is positive: as `ko_constraints_keep_body`.
///
/// An aggregate couples all of them in the Hessian, with (dim n)^2 / 2 entries; KO_AGGREGATE_NONE has a value, and a small block, a point.
/// Errors: KO_ERR_INVALID_ARGUMENT as there. Threads: needs `constraints` alone. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_keep_points(
    constraints: *mut ko_constraints,
    points: u32,
    field: *const ko_field,
    field_frame: u32,
    aggregation: *const ko_aggregation,
    first_value: *mut usize,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints and a field.
        let (ko_constraints(set), ko_field(field)) =
            unsafe { (place(constraints, "constraints")?, object(field, "field")?) };
        // SAFETY: the header asks for NULL or an initialised struct.
        let aggregation = unsafe { ko_aggregation::read(aggregation) }?;
        check_wanted_place(first_value, "first_value")?;
        let (points, frame) = (PointsId(points as usize), FrameId(field_frame as usize));
        let value = match (set, field) {
            (OfDimension::Plane(set), OfDimension::Plane(field)) => {
                set.keep_points(points, (field.clone(), frame), aggregation)?
            }
            (OfDimension::Space(set), OfDimension::Space(field)) => {
                set.keep_points(points, (field.clone(), frame), aggregation)?
            }
            (set, field) => return Err(differ(&[("the constraints", set.dim()), ("the field", field.dim())])),
        };
        // SAFETY: the header asks for NULL or a place to write.
        unsafe { tell(first_value, value) }
    })
}

/// Requires that `body` in `frame` lies in the union or the intersection of the feasible sets of `fields` [n_fields], all in `field_frame`:
/// as `ko_constraints_keep_body`, phi of a sample being that of the fields there, combined.
///
/// `extreme` is KO_LARGEST, for the union: each sample in one of two tanks, say, and a body across both; or KO_LEAST, for the intersection:
/// outside several obstacles, as one value. `combination` tells how the fields' phi become one, sample by sample, NULL: KS; with KO_BELOW
/// it lies below the largest or the least of them, the safe side of both. KS lies at most D ln(n_fields) / rho below: below the least where
/// the fields are equal, below the largest where one is much larger than the others, so that the walls of a union are that much nearer.
/// `aggregation` is over the samples, and works on what `combination` gives. D of both is the largest of the fields'. phi of all fields must
/// be in one unit of length. With KO_AGGREGATE_MINIMUM as `combination` phi is the least or largest itself, with the gradient of the first
/// field that has it: not smooth, no Hessian. One field is as `ko_constraints_keep_body` has it.
/// Errors: those of `ko_constraints_keep_body`; KO_ERR_INVALID_ARGUMENT for no fields or more than 256, for NULL and for another dimension
/// among them, naming the first, for another `extreme`, for KO_AGGREGATE_NONE as `combination`. Threads: needs `constraints` alone. Cost:
/// none; evaluated, about that of one requirement a field.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_keep_body_in_fields(
    constraints: *mut ko_constraints,
    body: *const ko_body,
    frame: u32,
    fields: *const *const ko_field,
    n_fields: usize,
    extreme: i32,
    combination: *const ko_aggregation,
    field_frame: u32,
    aggregation: *const ko_aggregation,
    first_value: *mut usize,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints and a body.
        let (ko_constraints(set), ko_body(body)) =
            unsafe { (place(constraints, "constraints")?, object(body, "body")?) };
        // SAFETY: the header asks for an array of fields, and for NULL or an initialised struct.
        let combined = unsafe { Combined::read(fields, n_fields, extreme, combination) }?;
        // SAFETY: the header asks for NULL or an initialised struct.
        let aggregation = unsafe { ko_aggregation::read(aggregation) }?;
        check_wanted_place(first_value, "first_value")?;
        let frames = [frame, field_frame].map(|f| FrameId(f as usize));
        let value = match (set, body) {
            (OfDimension::Plane(set), OfDimension::Plane(body)) => {
                let region = combined.region(OfDimension::plane)?;
                set.keep_body((body.clone(), frames[0]), (region, frames[1]), aggregation)?
            }
            (OfDimension::Space(set), OfDimension::Space(body)) => {
                let region = combined.region(OfDimension::space)?;
                set.keep_body((body.clone(), frames[0]), (region, frames[1]), aggregation)?
            }
            (set, body) => return Err(differ(&[("the constraints", set.dim()), ("the body", body.dim())])),
        };
        // SAFETY: the header asks for NULL or a place to write.
        unsafe { tell(first_value, value) }
    })
}

/// Requires that the points with number `points` lie in the union or the intersection of the feasible sets of `fields` [n_fields], all in
/// `field_frame`: as `ko_constraints_keep_body_in_fields`, and in the Hessian as `ko_constraints_keep_points`.
///
/// Errors, threads and cost: as of these two.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_keep_points_in_fields(
    constraints: *mut ko_constraints,
    points: u32,
    fields: *const *const ko_field,
    n_fields: usize,
    extreme: i32,
    combination: *const ko_aggregation,
    field_frame: u32,
    aggregation: *const ko_aggregation,
    first_value: *mut usize,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints.
        let ko_constraints(set) = unsafe { place(constraints, "constraints") }?;
        // SAFETY: the header asks for an array of fields, and for NULL or an initialised struct.
        let combined = unsafe { Combined::read(fields, n_fields, extreme, combination) }?;
        // SAFETY: the header asks for NULL or an initialised struct.
        let aggregation = unsafe { ko_aggregation::read(aggregation) }?;
        check_wanted_place(first_value, "first_value")?;
        let (points, frame) = (PointsId(points as usize), FrameId(field_frame as usize));
        let value = match set {
            OfDimension::Plane(set) => {
                set.keep_points(points, (combined.region(OfDimension::plane)?, frame), aggregation)?
            }
            OfDimension::Space(set) => {
                set.keep_points(points, (combined.region(OfDimension::space)?, frame), aggregation)?
            }
        };
        // SAFETY: the header asks for NULL or a place to write.
        unsafe { tell(first_value, value) }
    })
}

/// Tells how many variables and values there are, and entries of the Jacobian's pattern and of the Hessian's; each may be NULL.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL constraints. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_get_size(
    constraints: *const ko_constraints,
    n_variables: *mut usize,
    n_values: *mut usize,
    n_jacobian: *mut usize,
    n_hessian: *mut usize,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints.
        let ko_constraints(set) = unsafe { object(constraints, "constraints") }?;
        let size = in_its_dimension!(set, set => set.size());
        let outputs = [
            (n_variables, size.n_variables, "n_variables"),
            (n_values, size.n_rows, "n_values"),
            (n_jacobian, size.n_jacobian, "n_jacobian"),
            (n_hessian, size.n_hessian, "n_hessian"),
        ];
        outputs.iter().try_for_each(|(to, _, name)| check_wanted_place(*to, name))?;
        // SAFETY: the header asks for NULL or places to write.
        outputs.iter().try_for_each(|(to, n, _)| unsafe { tell(*to, *n) })
    })
}

/// Tells the first variable of a frame and how many it has, 0 of one that stands still.
///
/// Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_get_frame_variables(
    constraints: *const ko_constraints,
    frame: u32,
    first: *mut usize,
    n_variables: *mut usize,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints and places to write.
        let (ko_constraints(set), first, n) = unsafe {
            (object(constraints, "constraints")?, place(first, "first")?, place(n_variables, "n_variables")?)
        };
        (*first, *n) = in_its_dimension!(set, set => set.frame_variables(FrameId(frame as usize)))?;
        Ok(())
    })
}

/// Tells the first variable of points, and how many they have.
///
/// Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_get_points_variables(
    constraints: *const ko_constraints,
    points: u32,
    first: *mut usize,
    n_variables: *mut usize,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints and places to write.
        let (ko_constraints(set), first, n) = unsafe {
            (object(constraints, "constraints")?, place(first, "first")?, place(n_variables, "n_variables")?)
        };
        (*first, *n) = in_its_dimension!(set, set => set.points_variables(PointsId(points as usize)))?;
        Ok(())
    })
}

/// Evaluates the constraints at `x` [n_variables]: `values` [n_values], each to be kept at or above 0, in the fields' unit of length times
/// the scale of their frames.
///
/// Errors: KO_ERR_INVALID_ARGUMENT, naming the variable, frame or value, for lengths other than those of `ko_constraints_get_size`, for a
/// variable that is not finite, a quaternion or a scale out of range, a sample beyond 1e150: an optimiser's adapter reports an evaluation
/// that failed then. `values` are unspecified after an error. Threads: any number at once. Cost: some 20 ns a sample, ten times that for one
/// outside its field's box (a fit with a larger `margin` has it inside), a microsecond a requirement; no allocation, no lock.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_values(
    constraints: *const ko_constraints,
    x: *const f64,
    n_variables: usize,
    n_values: usize,
    values: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints and arrays of these lengths.
        let (ko_constraints(set), x, values) = unsafe {
            (object(constraints, "constraints")?, array(x, n_variables, "x")?, array_mut(values, n_values, "values")?)
        };
        in_its_dimension!(set, set => set.values(x, values))
    })
}

/// Tells `rows` [n_entries] and `columns` [n_entries] of the Jacobian's entries, counted from 0: values, and variables.
///
/// Row by row; within a row points come first, then the samples' frame, then the field's; no place comes twice. `n_entries` must be that of
/// `ko_constraints_get_size`. Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: a few nanoseconds an entry.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_jacobian_pattern(
    constraints: *const ko_constraints,
    n_entries: usize,
    rows: *mut i32,
    columns: *mut i32,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints and arrays of this length.
        let (ko_constraints(set), rows, columns) = unsafe {
            (
                object(constraints, "constraints")?,
                array_mut(rows, n_entries, "rows")?,
                array_mut(columns, n_entries, "columns")?,
            )
        };
        check_count("n_entries", n_entries, in_its_dimension!(set, set => set.size()).n_jacobian)?;
        let mut places = rows.iter_mut().zip(columns);
        in_its_dimension!(set, set => set.jacobian_pattern(|row, column| write(&mut places, row, column)));
        Ok(())
    })
}

/// Evaluates the Jacobian at `x` [n_variables]: `entries` [n_entries] in the order of `ko_constraints_jacobian_pattern`.
///
/// Errors and threads: those of `ko_constraints_values`. Cost: some 1.4 times `ko_field_eval` with gradients at the same points for bodies,
/// twice that for points that are aggregated; no allocation, no lock.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_jacobian(
    constraints: *const ko_constraints,
    x: *const f64,
    n_variables: usize,
    n_entries: usize,
    entries: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints and arrays of these lengths.
        let (ko_constraints(set), x, entries) = unsafe {
            (
                object(constraints, "constraints")?,
                array(x, n_variables, "x")?,
                array_mut(entries, n_entries, "entries")?,
            )
        };
        in_its_dimension!(set, set => set.jacobian(x, entries))
    })
}

/// Evaluates values and Jacobian at once, in one pass over the samples of bodies: `values` [n_values] and `entries` [n_entries], as
/// `ko_constraints_values` and `ko_constraints_jacobian` give them.
///
/// Errors, threads and cost: those of `ko_constraints_jacobian`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_values_and_jacobian(
    constraints: *const ko_constraints,
    x: *const f64,
    n_variables: usize,
    n_values: usize,
    values: *mut f64,
    n_entries: usize,
    entries: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints and arrays of these lengths.
        let (ko_constraints(set), x, values, entries) = unsafe {
            (
                object(constraints, "constraints")?,
                array(x, n_variables, "x")?,
                array_mut(values, n_values, "values")?,
                array_mut(entries, n_entries, "entries")?,
            )
        };
        in_its_dimension!(set, set => set.values_and_jacobian(x, values, entries))
    })
}

/// Evaluates the Jacobian at `x` [n_variables] as a whole: `jacobian` [n_values * n_variables], row-major, with its zeros.
///
/// Errors, threads and cost: those of `ko_constraints_jacobian`, and the zeros.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_dense_jacobian(
    constraints: *const ko_constraints,
    x: *const f64,
    n_variables: usize,
    n_values: usize,
    jacobian: *mut f64,
) -> i32 {
    guard(|| {
        let n = n_values.saturating_mul(n_variables);
        // SAFETY: the header asks for constraints and arrays of these lengths.
        let (ko_constraints(set), x, jacobian) = unsafe {
            (object(constraints, "constraints")?, array(x, n_variables, "x")?, array_mut(jacobian, n, "jacobian")?)
        };
        in_its_dimension!(set, set => set.dense_jacobian(x, jacobian))
    })
}

/// Evaluates J v at `x` [n_variables] for `v` [n_variables]: `product` [n_values].
///
/// Errors, threads and cost: those of `ko_constraints_jacobian`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_jacobian_times(
    constraints: *const ko_constraints,
    x: *const f64,
    v: *const f64,
    n_variables: usize,
    n_values: usize,
    product: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints and arrays of these lengths.
        let (ko_constraints(set), x, v, product) = unsafe {
            (
                object(constraints, "constraints")?,
                array(x, n_variables, "x")?,
                array(v, n_variables, "v")?,
                array_mut(product, n_values, "product")?,
            )
        };
        in_its_dimension!(set, set => set.jacobian_times(x, v, product))
    })
}

/// Evaluates J^T w at `x` [n_variables] for `w` [n_values]: `product` [n_variables].
///
/// Errors, threads and cost: those of `ko_constraints_jacobian`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_transposed_jacobian_times(
    constraints: *const ko_constraints,
    x: *const f64,
    n_variables: usize,
    w: *const f64,
    n_values: usize,
    product: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints and arrays of these lengths.
        let (ko_constraints(set), x, w, product) = unsafe {
            (
                object(constraints, "constraints")?,
                array(x, n_variables, "x")?,
                array(w, n_values, "w")?,
                array_mut(product, n_variables, "product")?,
            )
        };
        in_its_dimension!(set, set => set.transposed_jacobian_times(x, w, product))
    })
}

/// Tells `rows` [n_entries] and `columns` [n_entries] of the entries of the Hessian's lower triangle, both variables, counted from 0.
///
/// No column is above its row, and no place comes twice. `n_entries` must be that of `ko_constraints_get_size`. Errors:
/// KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: a few nanoseconds an entry.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_hessian_pattern(
    constraints: *const ko_constraints,
    n_entries: usize,
    rows: *mut i32,
    columns: *mut i32,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints and arrays of this length.
        let (ko_constraints(set), rows, columns) = unsafe {
            (
                object(constraints, "constraints")?,
                array_mut(rows, n_entries, "rows")?,
                array_mut(columns, n_entries, "columns")?,
            )
        };
        check_count("n_entries", n_entries, in_its_dimension!(set, set => set.size()).n_hessian)?;
        let mut places = rows.iter_mut().zip(columns);
        in_its_dimension!(set, set => set.hessian_pattern(|row, column| write(&mut places, row, column)));
        Ok(())
    })
}

/// Evaluates the Hessian of the sum of `lambda` [n_values] times the values at `x` [n_variables]: the constraints' part of the Lagrangian's.
/// `entries` [n_entries] are in the order of `ko_constraints_hessian_pattern`.
///
/// Errors: those of `ko_constraints_values`; KO_ERR_INVALID_ARGUMENT for a multiplier that is not finite, KO_ERR_UNSUPPORTED for one other
/// than 0 of a value by KO_AGGREGATE_MINIMUM, over samples or over fields. Threads: any number at once. Cost: some 90 ns a sample of a
/// requirement whose multiplier is not 0, and the entries of points that are coupled; no allocation, no lock.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_constraints_hessian(
    constraints: *const ko_constraints,
    x: *const f64,
    n_variables: usize,
    lambda: *const f64,
    n_values: usize,
    n_entries: usize,
    entries: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for constraints and arrays of these lengths.
        let (ko_constraints(set), x, lambda, entries) = unsafe {
            (
                object(constraints, "constraints")?,
                array(x, n_variables, "x")?,
                array(lambda, n_values, "lambda")?,
                array_mut(entries, n_entries, "entries")?,
            )
        };
        in_its_dimension!(set, set => set.hessian(x, lambda, entries))
    })
}

/// Fields and what shall become of them, as C hands them over.
struct Combined<'a> {
    fields: Vec<&'a ko_field>,
    extreme: Extreme,
    combination: Aggregation,
}

impl<'a> Combined<'a> {
    /// # Safety
    /// `fields` is NULL or points to `n_fields` handles, each NULL or a field that lives for `'a`; `combination` is NULL or initialised.
    unsafe fn read(
        fields: *const *const ko_field,
        n_fields: usize,
        extreme: i32,
        combination: *const ko_aggregation,
    ) -> Result<Self> {
        Region::<3>::check_count(n_fields)?;
        // SAFETY: the caller's promise.
        let handles = unsafe { array(fields, n_fields, "fields") }?;
        // SAFETY: the caller's promise.
        let each = handles.iter().enumerate().map(|(i, f)| unsafe { object(*f, &format!("field {i} of fields")) });
        let fields = each.collect::<Result<_>>()?;
        let extreme = extreme_of(extreme)?;
        // SAFETY: the caller's promise.
        let combination = unsafe { ko_aggregation::read(combination) }.map_err(|error| match error {
            Error::InvalidArgument(text) => Error::InvalidArgument(format!("combination of the fields: {text}")),
            other => other,
        })?;
        Ok(Combined { fields, extreme, combination })
    }

    /// The region, of fields that are of its dimension by `in_dimension`.
    fn region<const D: usize>(
        &self,
        in_dimension: impl Fn(&OfDimension<Arc<Field<2>>, Arc<Field<3>>>) -> Option<&Arc<Field<D>>>,
    ) -> Result<Region<D>> {
        let each = self.fields.iter().enumerate().map(|(i, ko_field(field))| match in_dimension(field) {
            Some(field) => Ok(field.clone()),
            None => Err(differ(&[("the constraints", D as u32), (&format!("field {i} of fields"), field.dim())])),
        });
        Region::new(each.collect::<Result<_>>()?, self.extreme, self.combination)
    }
}

fn kind(rotation: i32, scale: i32) -> Result<PoseKind> {
    let rotation = match rotation {
        KO_ROTATION_NONE => Rotation::None,
        KO_ROTATION_QUATERNION => Rotation::Quaternion,
        KO_ROTATION_VECTOR => Rotation::Vector,
        KO_ROTATION_ANGLE => Rotation::Angle,
        other => {
            return Err(Error::InvalidArgument(format!(
                "rotation is {other}; it must be a KO_ROTATION_ constant, 0 to 3"
            )));
        }
    };
    let scale = match scale {
        KO_SCALE_ONE => Scale::One,
        KO_SCALE_FREE => Scale::Free,
        other => {
            return Err(Error::InvalidArgument(format!(
                "scale is {other}; it must be KO_SCALE_ONE (0) or KO_SCALE_FREE (1)"
            )));
        }
    };
    Ok(PoseKind { rotation, scale })
}

/// A number of a frame or of points for C: there are fewer than variables, which fit 32 bits, but for frames that stand still.
fn number(n: usize) -> u32 {
    u32::try_from(n).expect("four thousand million frames do not fit memory")
}

fn write<'a>(places: &mut impl Iterator<Item = (&'a mut i32, &'a mut i32)>, row: usize, column: usize) {
    let (to_row, to_column) = places.next().expect("there is a place for each entry");
    // Entries are within 2^31, as a set of constraints sees to.
    (*to_row, *to_column) = (row as i32, column as i32);
}
