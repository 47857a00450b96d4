//! `ko_motion`, and laws.

use super::guard::{guard, guard_free};
use super::part::ko_part;
use super::pointer::{
    Sized_, array, array_mut, create, create_all, free, object, object_or_none, place, read_sized, write_sized,
};
use crate::cogen::mechanism::{Bend, FourBar, gears};
use crate::cogen::{Grid, Law, Motion, SpeedLimit, Wave};
use crate::dimension::{OfDimension, differ, in_its_dimension, no_dim};
use crate::error::try_with_capacity;
use crate::geometry::rigid::Rigid;
use crate::geometry::vec::number;
use crate::{Error, Result};
use std::ffi::c_void;

/// A rigid motion tau(t) of one parameter t in [0, 1], in the plane or in space: (3) and (4) of Morris and Behandish 2022. It takes points of a
/// part to where they are in the world at t. Freed by `ko_motion_free`; what was made of it goes on.
#[allow(non_camel_case_types)]
pub struct ko_motion(pub(super) OfDimension<Motion<2>, Motion<3>>);

/// How far along its way a motion is at t: f(t) = offset + slope t + sum over k of a_k cos(2 pi c_k t + p_k). Initialise by `ko_law_init`.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_law {
    /// sizeof(ko_law), set by ko_law_init.
    pub struct_size: usize,
    /// f without the rest: radians of a turn or screw; of a slide a factor. 0 by ko_law_init.
    pub offset: f64,
    /// By how much the even part grows while t goes from 0 to 1. 0 by ko_law_init.
    pub slope: f64,
    /// [3 * n_waves]: amplitude a_k, cycles c_k while t goes from 0 to 1, phase p_k in radians. Read during a call only. NULL by ko_law_init.
    pub waves: *const f64,
    /// Waves. 0 by ko_law_init.
    pub n_waves: usize,
}

// SAFETY: repr(C), starts with a usize, plain numbers and an address without padding (checked below).
unsafe impl Sized_ for ko_law {
    const FIRST_SIZE: usize = 3 * size_of::<usize>() + 16;
}

const _: () = assert!(size_of::<ko_law>() == <ko_law as Sized_>::FIRST_SIZE);

/// Writes the pose at `time` in [0, 1] to `rotation` [dim * dim], row-major, and `translation` [dim], and returns 0; not 0 is an error. Called
/// on the caller's thread only. It must not unwind, throw or jump out.
#[allow(non_camel_case_types)]
pub type ko_pose_function =
    Option<unsafe extern "C" fn(time: f64, rotation: *mut f64, translation: *mut f64, data: *mut c_void) -> i32>;

/// Fills `law` with f(t) = 0. `struct_size` is sizeof *law.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_law_init(law: *mut ko_law, struct_size: usize) -> i32 {
    guard(|| {
        let zero =
            ko_law { struct_size: size_of::<ko_law>(), offset: 0.0, slope: 0.0, waves: std::ptr::null(), n_waves: 0 };
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(law, struct_size, zero, "law") }
    })
}

impl ko_law {
    /// The law at `pointer`.
    ///
    /// # Safety
    /// `pointer` is NULL or points to as many bytes as its `struct_size` says, and its waves to three numbers each.
    unsafe fn read(pointer: *const Self) -> Result<Law> {
        let zero = ko_law { struct_size: 0, offset: 0.0, slope: 0.0, waves: std::ptr::null(), n_waves: 0 };
        // SAFETY: the caller's promise.
        let law = unsafe { read_sized(pointer, zero, "law") }?;
        // SAFETY: as above.
        let waves = unsafe { array(law.waves.cast::<[f64; 3]>(), law.n_waves, "law's waves") }?;
        let mut own = try_with_capacity(waves.len(), "the law's waves")?;
        own.extend(waves.iter().map(|&[amplitude, cycles, phase]| Wave { amplitude, cycles, phase }));
        Ok(Law { offset: law.offset, slope: law.slope, waves: own })
    }
}

/// Makes the motion of a part that stays at a pose: `rotation` [dim * dim], row-major, NULL for none, then `translation` [dim], NULL for 0.
///
/// `dim` is 2 or 3. x_w = R x + t: the columns of R are where the part's axes point in the world. R is made a rotation to rounding.
/// `*motion` is the caller's to free.
/// Errors: KO_ERR_INVALID_ARGUMENT for a number that is not finite and for R that mirrors, or is off a rotation by more than 1e-6 in an entry of
/// R^T R, telling by how much. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_motion_fixed(
    dim: u32,
    rotation: *const f64,
    translation: *const f64,
    motion: *mut *mut ko_motion,
) -> i32 {
    guard(|| {
        let make = || {
            Ok(ko_motion(match dim {
                // SAFETY: the header asks for arrays of these lengths.
                2 => OfDimension::Plane(unsafe { fixed(rotation, translation) }?),
                // SAFETY: as above.
                3 => OfDimension::Space(unsafe { fixed(rotation, translation) }?),
                _ => return Err(no_dim(dim)),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(motion, "motion", make) }
    })
}

/// # Safety
/// Both are NULL or arrays of D^2 and D.
unsafe fn fixed<const D: usize>(rotation: *const f64, translation: *const f64) -> Result<Motion<D>> {
    // SAFETY: the caller's promise.
    let (turn, shift) =
        unsafe { (object_or_none(rotation.cast(), "rotation")?, object_or_none(translation.cast(), "translation")?) };
    let still = Rigid::<D>::IDENTITY;
    Ok(Motion::at_pose(Rigid::new(*turn.unwrap_or(&still.turn), *shift.unwrap_or(&still.shift))?))
}

/// Makes a slide: at t the part is moved by f(t) times `along` [dim], f being the `law`.
///
/// `dim` is 2 or 3. `*motion` is the caller's to free. Errors: KO_ERR_INVALID_ARGUMENT for a number that is not finite, and for no law. Threads:
/// any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_motion_slide(
    dim: u32,
    along: *const f64,
    law: *const ko_law,
    motion: *mut *mut ko_motion,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for an initialised struct.
            let law = unsafe { ko_law::read(law) }?;
            Ok(ko_motion(match dim {
                // SAFETY: the header asks for an array of this length.
                2 => OfDimension::Plane(Motion::slide(*unsafe { object(along.cast(), "along") }?, law)?),
                // SAFETY: as above.
                3 => OfDimension::Space(Motion::slide(*unsafe { object(along.cast(), "along") }?, law)?),
                _ => return Err(no_dim(dim)),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(motion, "motion", make) }
    })
}

/// Makes a turn in the plane about `center` [2], by f(t) radians counter-clockwise, f being the `law`.
///
/// `*motion` is the caller's to free. Errors: KO_ERR_INVALID_ARGUMENT for a number that is not finite, and for no law. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_motion_turn(center: *const f64, law: *const ko_law, motion: *mut *mut ko_motion) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for an initialised struct and an array of this length.
            let (law, center) = unsafe { (ko_law::read(law)?, object(center.cast(), "center")?) };
            Ok(ko_motion(OfDimension::Plane(Motion::turn(*center, law)?)))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(motion, "motion", make) }
    })
}

/// Makes a screw in space about the line through `point` [3] along `axis` [3]: a turn by f(t) radians, right-handed, and a slide along the axis
/// by `lead` times f(t), f being the `law`.
///
/// The axis is divided by its length. `lead` is a length a radian; 0 makes a turn. `*motion` is the caller's to free.
/// Errors: KO_ERR_INVALID_ARGUMENT for a number that is not finite, an axis of length 0, and for no law. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_motion_screw(
    point: *const f64,
    axis: *const f64,
    lead: f64,
    law: *const ko_law,
    motion: *mut *mut ko_motion,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for an initialised struct and arrays of these lengths.
            let (law, point, axis) =
                unsafe { (ko_law::read(law)?, object(point.cast(), "point")?, object(axis.cast(), "axis")?) };
            Ok(ko_motion(OfDimension::Space(Motion::screw(*point, *axis, lead, law)?)))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(motion, "motion", make) }
    })
}

/// Makes the motion through `n_poses` poses at even times from 0 to 1, pose k at k / (n_poses - 1): `rotations` [dim * dim * n_poses], row-major
/// each, and `translations` [dim * n_poses].
///
/// `dim` is 2 or 3. Between two poses it is by definition the screw of the smallest turn from one to the other. The arrays are copied.
/// `*motion` is the caller's to free.
/// Errors: KO_ERR_INVALID_ARGUMENT for fewer than 2 poses; for one that is not finite, mirrors, or is not rigid, naming the first, and how far it
/// is off; for a turn of more than 3 radians from a pose to the next, which could be either way round; KO_ERR_OUT_OF_MEMORY. Threads: any.
/// Cost: less than a microsecond a pose.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_motion_sampled(
    dim: u32,
    rotations: *const f64,
    translations: *const f64,
    n_poses: usize,
    motion: *mut *mut ko_motion,
) -> i32 {
    guard(|| {
        let make = || {
            Ok(ko_motion(match dim {
                // SAFETY: the header asks for arrays of these lengths.
                2 => OfDimension::Plane(unsafe { sampled(rotations, translations, n_poses) }?),
                // SAFETY: as above.
                3 => OfDimension::Space(unsafe { sampled(rotations, translations, n_poses) }?),
                _ => return Err(no_dim(dim)),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(motion, "motion", make) }
    })
}

/// # Safety
/// Both are NULL or arrays of `n` times D^2 and D.
unsafe fn sampled<const D: usize>(rotations: *const f64, translations: *const f64, n: usize) -> Result<Motion<D>> {
    // SAFETY: the caller's promise.
    let (turns, shifts) = unsafe {
        (
            array(rotations.cast::<[[f64; D]; D]>(), n, "rotations")?,
            array(translations.cast::<[f64; D]>(), n, "translations")?,
        )
    };
    let mut poses = try_with_capacity(n, "the motion's poses")?;
    for (k, (turn, shift)) in turns.iter().zip(shifts).enumerate() {
        poses.push(Rigid::new(*turn, *shift).map_err(|error| at(&format!("pose {k}"), error))?);
    }
    Motion::sampled(poses)
}

/// Makes the motion through `n_poses` poses that `pose` is asked for, in order, at even times from 0 to 1; between two of them it is the screw
/// from one to the other, as in `ko_motion_sampled`.
///
/// `dim` is 2 or 3. `data` is handed to `pose`, which is called during this call only. `part` and `max_speed` tell a jump: from a pose to the next no
/// point of the part's grid may go more than max_speed times the time between, in lengths by unit of t; NULL and 0: any way is taken for a fast
/// move. `*motion` is the caller's to free; it does not refer to `part`.
/// Errors: those of `ko_motion_sampled`, and KO_ERR_INVALID_ARGUMENT where `pose` does not return 0, with the pose's number and time, where the
/// motion jumps, with the times, the way and what is allowed, for a max_speed below 0, and for one without a part. Threads: any. Cost: the calls,
/// and less than a microsecond a pose.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_motion_from_function(
    dim: u32,
    pose: ko_pose_function,
    data: *mut c_void,
    n_poses: usize,
    part: *const ko_part,
    max_speed: f64,
    motion: *mut *mut ko_motion,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for NULL or a part.
            let part = unsafe { object_or_none(part, "part") }?;
            if part.is_none() && max_speed != 0.0 {
                let text =
                    format!("max_speed is {} and part is NULL; points of a part have a speed", number(max_speed));
                return Err(Error::InvalidArgument(text));
            }
            let differs = |part: &ko_part| differ(&[("the motion", dim), ("part", part.0.dim())]);
            Ok(ko_motion(match dim {
                2 => {
                    let grid = part.map(|p| p.0.plane().map(|p| *p.grid()).ok_or_else(|| differs(p))).transpose()?;
                    // SAFETY: the header asks for a function that may be called with `data`.
                    OfDimension::Plane(unsafe { from_function(pose, data, n_poses, grid, max_speed) }?)
                }
                3 => {
                    let grid = part.map(|p| p.0.space().map(|p| *p.grid()).ok_or_else(|| differs(p))).transpose()?;
                    // SAFETY: as above.
                    OfDimension::Space(unsafe { from_function(pose, data, n_poses, grid, max_speed) }?)
                }
                _ => return Err(no_dim(dim)),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(motion, "motion", make) }
    })
}

/// # Safety
/// `pose` may be called with `data`.
unsafe fn from_function<const D: usize>(
    pose: ko_pose_function,
    data: *mut c_void,
    n: usize,
    grid: Option<Grid<D>>,
    speed: f64,
) -> Result<Motion<D>> {
    let Some(pose) = pose else { return Err(Error::InvalidArgument("pose is NULL; it is required".into())) };
    let limit = grid.map(|grid| SpeedLimit { grid, speed });
    Motion::of_function(n, limit, |time| {
        // What is not written is told.
        let (mut turn, mut shift) = ([[f64::NAN; D]; D], [f64::NAN; D]);
        // SAFETY: the caller's promise.
        let status = unsafe { pose(time, turn.as_flattened_mut().as_mut_ptr(), shift.as_mut_ptr(), data) };
        if status != 0 {
            return Err(Error::InvalidArgument(format!("the function returned {status}; 0 is a success")));
        }
        Rigid::new(turn, shift)
    })
}

/// Makes the motions of two wheels that turn against each other, as gears do, about `centers` [4], x y of the first and of the second: the first
/// by `turns` full turns counter-clockwise while t goes from 0 to 1, the second by `ratio` times that clockwise.
///
/// Parts cut from what they leave of each other have teeth with the pitch radii r_1 = ratio r_2. Both handles are the caller's to free.
/// Errors: KO_ERR_INVALID_ARGUMENT for a number that is not finite and a ratio that is not above 0. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_motion_gears(
    centers: *const f64,
    turns: f64,
    ratio: f64,
    first: *mut *mut ko_motion,
    second: *mut *mut ko_motion,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for an array of this length.
            let centers = unsafe { object(centers.cast(), "centers") }?;
            Ok(gears(*centers, turns, ratio)?.map(|motion| ko_motion(OfDimension::Plane(motion))))
        };
        // SAFETY: the header asks for handles to write.
        unsafe { create_all([(first, "first"), (second, "second")], make) }
    })
}

/// Makes the motions of a planar four-bar linkage: its crank and its rocker turn about `pivots` [4], x y of the crank's and of the rocker's, and
/// a coupler joins their ends.
///
/// `lengths` [3] are those of crank, coupler and rocker from joint to joint. While t goes from 0 to 1 the crank turns from the angle `from` by
/// `by`, in radians counter-clockwise from the x axis. Seen from the crank's joint towards the rocker's pivot, the rocker's joint lies to the left
/// with `bend` 1, to the right with -1. Each part is given in a frame of its own: crank and rocker with the origin in their pivots and the x axis
/// towards their joints, the coupler with the origin in the crank's joint and the x axis towards the rocker's. The poses are sampled at
/// n_steps + 1 even times, with screws between them: of coupler and rocker these come near to the linkage as 1 / n_steps^2.
/// All three handles are the caller's to free.
/// Errors: KO_ERR_INVALID_ARGUMENT for a length that is not above 0, a number that is not finite, another `bend`, for 0 steps or so few that a bar
/// turns by more than 3 radians in one, and for an angle at which the linkage does not close, naming the first; KO_ERR_OUT_OF_MEMORY. Threads: any.
/// Cost: a microsecond a step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_motion_four_bar(
    pivots: *const f64,
    lengths: *const f64,
    from: f64,
    by: f64,
    bend: i32,
    n_steps: usize,
    crank: *mut *mut ko_motion,
    coupler: *mut *mut ko_motion,
    rocker: *mut *mut ko_motion,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for arrays of these lengths.
            let (pivots, lengths) = unsafe {
                (object(pivots.cast::<[[f64; 2]; 2]>(), "pivots")?, object(lengths.cast::<[f64; 3]>(), "lengths")?)
            };
            let side = match bend {
                1 => Bend::Left,
                -1 => Bend::Right,
                _ => return Err(Error::InvalidArgument(format!("bend is {bend}; it must be 1 (left) or -1 (right)"))),
            };
            let [crank, coupler, rocker] = *lengths;
            let linkage = FourBar { pivots: *pivots, crank, coupler, rocker, from, by, side };
            Ok(linkage.motions(n_steps)?.map(|motion| ko_motion(OfDimension::Plane(motion))))
        };
        // SAFETY: the header asks for handles to write.
        unsafe { create_all([(crank, "crank"), (coupler, "coupler"), (rocker, "rocker")], make) }
    })
}

/// Makes the product of two motions, tau(t) = `outer`(t) `inner`(t): what `inner` does is seen from what `outer` moves.
///
/// A follower on a rocker, say, or a part's first pose before its motion. `*motion` is the caller's to free; it does not refer to the handles.
/// Errors: KO_ERR_INVALID_ARGUMENT for motions of different dimensions, and for a product of more than 1000 motions in all. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_motion_product(
    outer: *const ko_motion,
    inner: *const ko_motion,
    motion: *mut *mut ko_motion,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for motions.
            let (ko_motion(outer), ko_motion(inner)) = unsafe { (object(outer, "outer")?, object(inner, "inner")?) };
            Ok(ko_motion(match (outer, inner) {
                (OfDimension::Plane(outer), OfDimension::Plane(inner)) => OfDimension::Plane(outer.times(inner)?),
                (OfDimension::Space(outer), OfDimension::Space(inner)) => OfDimension::Space(outer.times(inner)?),
                _ => return Err(differ(&[("outer", outer.dim()), ("inner", inner.dim())])),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(motion, "motion", make) }
    })
}

/// Makes the inverse of a motion, which undoes it at each time. With a product it gives relative motions, tau_1^-1 tau_2, (8) and (9).
///
/// `*motion` is the caller's to free; it does not refer to `of`. Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_motion_inverse(of: *const ko_motion, motion: *mut *mut ko_motion) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for a motion.
            let ko_motion(of) = unsafe { object(of, "of") }?;
            Ok(ko_motion(match of {
                OfDimension::Plane(of) => OfDimension::Plane(of.inverse()),
                OfDimension::Space(of) => OfDimension::Space(of.inverse()),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(motion, "motion", make) }
    })
}

/// Frees a motion. NULL is taken. No other thread may be using it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_motion_free(motion: *mut ko_motion) {
    // SAFETY: the header asks for NULL or a motion that was not freed.
    guard_free(|| unsafe { free(motion) });
}

/// Tells the dimension of a motion, 2 or 3.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_motion_get_dim(motion: *const ko_motion, dim: *mut u32) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a motion and a place to write.
        let (ko_motion(motion), dim) = unsafe { (object(motion, "motion")?, place(dim, "dim")?) };
        *dim = motion.dim();
        Ok(())
    })
}

/// Evaluates a motion at `times` [n_times], each in [0, 1]: `rotations` [dim * dim * n_times], row-major each, and `translations`
/// [dim * n_times].
///
/// Errors: KO_ERR_INVALID_ARGUMENT, naming the first time outside [0, 1]. Threads: any number at once. Cost: some 100 ns a motion in a product
/// and a time; no allocation, no lock.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_motion_eval(
    motion: *const ko_motion,
    times: *const f64,
    n_times: usize,
    rotations: *mut f64,
    translations: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a motion and an array of this length.
        let (ko_motion(motion), times) = unsafe { (object(motion, "motion")?, array(times, n_times, "times")?) };
        in_its_dimension!(motion, motion => {
            // SAFETY: the header asks for arrays of these lengths.
            let (turns, shifts) = unsafe {
                (
                    array_mut(rotations.cast(), n_times, "rotations")?,
                    array_mut(translations.cast(), n_times, "translations")?,
                )
            };
            if let Some((k, t)) = times.iter().enumerate().find(|(_, t)| !(0.0..=1.0).contains(*t)) {
                return Err(Error::InvalidArgument(format!("time {k} is {}; it must be in [0, 1]", number(*t))));
            }
            for (t, (turn, shift)) in times.iter().zip(turns.iter_mut().zip(shifts)) {
                let pose = motion.at(*t);
                (*turn, *shift) = (pose.turn, pose.shift);
            }
            Ok(())
        })
    })
}

/// `error` of what is at `place`.
pub(super) fn at(place: &str, error: Error) -> Error {
    match error {
        Error::InvalidArgument(text) => Error::InvalidArgument(format!("{place}: {text}")),
        other => other,
    }
}

/// The motion of a part of the plane.
pub(super) fn in_plane(motion: Option<&ko_motion>) -> Result<Motion<2>> {
    match motion {
        None => Ok(Motion::fixed()),
        Some(ko_motion(OfDimension::Plane(motion))) => Ok(motion.clone()),
        Some(_) => Err(differ(&[("a part", 2), ("its motion", 3)])),
    }
}

/// The motion of a part of space.
pub(super) fn in_space(motion: Option<&ko_motion>) -> Result<Motion<3>> {
    match motion {
        None => Ok(Motion::fixed()),
        Some(ko_motion(OfDimension::Space(motion))) => Ok(motion.clone()),
        Some(_) => Err(differ(&[("a part", 3), ("its motion", 2)])),
    }
}
