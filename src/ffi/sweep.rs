//! Sweep and unsweep of parts.

use super::cells::{bits_of, put, read_set};
use super::guard::guard;
use super::mesh::check_count;
use super::motion::{in_plane, in_space, ko_motion};
use super::pair_options::ko_pair_options;
use super::part::ko_part;
use super::pointer::{array_mut, object, object_or_none};
use super::progress::listener;
use crate::cogen::sweep::{Body, Rule, sweep, unsweep};
use crate::cogen::{Bits, Motion, Part, Relative};
use crate::dimension::{OfDimension, differ};
use crate::geometry::vec::number;
use crate::par::Workers;
use crate::progress::Progress;
use crate::{Error, Result};

/// The part must overlap no cell of the body.
pub const KO_AVOID: i32 = 0;
/// The part must lie within the cells of the body: an enclosure.
pub const KO_STAY_IN: i32 = 1;

/// Tells which cells of `still` a moving part passes over: `swept` [n_still] is 1 for each that a cell of `part` among `cells` [n_cells] overlaps
/// at any time, (1) of Morris and Behandish 2022; none is missed, and cells that are only nearly overlapped may be 1 as well.
///
/// `cells` NULL with n_cells 0: all that the part may have. `motion` and `still_motion` are those of both in the world; NULL: it stays. What `still`
/// may do with its cells does not count. Of the options `slack`, `n_steps`, `n_threads` and `progress` are taken; NULL: the defaults.
/// Errors: KO_ERR_INVALID_ARGUMENT for another dimension or number of cells, an entry that is not 0 or 1, a clearance other than 0, a motion with a
/// number that is not finite; KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. Threads: any number at once; `progress` is called on the caller's. Cost: for
/// each cell and each step of time, and for each cell that it passes over then.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_part_sweep(
    part: *const ko_part,
    cells: *const u8,
    n_cells: usize,
    motion: *const ko_motion,
    still: *const ko_part,
    still_motion: *const ko_motion,
    options: *const ko_pair_options,
    n_still: usize,
    swept: *mut u8,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for parts, NULL or motions, initialised options, a set and an array of these lengths.
        let (ko_part(part), ko_part(still), motions, options, set, swept) = unsafe {
            (
                object(part, "part")?,
                object(still, "still")?,
                [object_or_none(motion, "motion")?, object_or_none(still_motion, "still_motion")?],
                ko_pair_options::read(options)?,
                read_set(cells, n_cells, "cells")?,
                array_mut(swept, n_still, "swept")?,
            )
        };
        if options.clearance != 0.0 {
            let text = format!("the clearance is {}; a sweep has none: it must be 0", number(options.clearance));
            return Err(Error::InvalidArgument(text));
        }
        match (part, still) {
            (OfDimension::Plane(part), OfDimension::Plane(still)) => {
                let [motion, still_motion] = motions.map(in_plane);
                // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
                unsafe { swept_into(part, &set, (motion?, still_motion?), still, &options, swept) }
            }
            (OfDimension::Space(part), OfDimension::Space(still)) => {
                let [motion, still_motion] = motions.map(in_space);
                // SAFETY: as above.
                unsafe { swept_into(part, &set, (motion?, still_motion?), still, &options, swept) }
            }
            _ => Err(differ(&[("part", part.dim()), ("still", still.dim())])),
        }
    })
}

/// # Safety
/// The options' function may be called with their data.
unsafe fn swept_into<const D: usize>(
    part: &Part<D>,
    set: &Bits,
    (motion, still_motion): (Motion<D>, Motion<D>),
    still: &Part<D>,
    options: &ko_pair_options,
    swept: &mut [u8],
) -> Result<()> {
    check_count("n_still", swept.len(), still.grid().n_cells())?;
    let cells = cells_or_all(set, part, "n_cells")?;
    // SAFETY: the caller's promise.
    let mut tell = unsafe { listener(options.progress, options.progress_data) };
    let relative = Relative { from: still_motion, of: motion };
    let (workers, mut progress) = (Workers::new(options.n_threads)?, Progress::new(&mut tell));
    let found = sweep(part.grid(), cells, &relative, still.grid(), options.sampling()?, &workers, &mut progress)?;
    put(&found, swept);
    Ok(())
}

/// Takes those cells of `part` out of `kept` [n_cells], a set, that break a rule about a `body` at any time of the motion: what is left is the
/// unsweep, (2), (23) and (24) of Morris and Behandish 2022. Against several bodies, call it for each with the same array.
///
/// `body_cells` [n_body] are those of the body; NULL with n_body 0: all that it may have. `rule` KO_AVOID: no cell that is left overlaps one of
/// them, or comes nearer than the options' clearance; KO_STAY_IN: none gets out of them, or nearer than that to what is not theirs. It holds for
/// whole cells at all times; cells that only nearly break it may go as well. Cells that the part may not have go; frozen ones that must go are
/// gone too. `motion` and `body_motion` are those of both in the world; NULL: it stays. Of the options `slack`, `n_steps`, `clearance`,
/// `n_threads` and `progress` are taken; NULL: the defaults.
/// Errors: KO_ERR_INVALID_ARGUMENT for another dimension, number of cells or rule, an entry that is not 0 or 1, a clearance below 0, a motion with a
/// number that is not finite; KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. After an error `kept` is as it was. Threads: any number at once; `progress` is
/// called on the caller's. Cost: as `ko_part_sweep`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_part_unsweep(
    part: *const ko_part,
    motion: *const ko_motion,
    body: *const ko_part,
    body_cells: *const u8,
    n_body: usize,
    body_motion: *const ko_motion,
    rule: i32,
    options: *const ko_pair_options,
    n_cells: usize,
    kept: *mut u8,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for parts, NULL or motions, initialised options, a set and an array of these lengths.
        let (ko_part(part), ko_part(body), motions, options, set, kept) = unsafe {
            (
                object(part, "part")?,
                object(body, "body")?,
                [object_or_none(motion, "motion")?, object_or_none(body_motion, "body_motion")?],
                ko_pair_options::read(options)?,
                read_set(body_cells, n_body, "body_cells")?,
                array_mut(kept, n_cells, "kept")?,
            )
        };
        let rule = match rule {
            KO_AVOID => Rule::Avoid,
            KO_STAY_IN => Rule::StayIn,
            _ => {
                return Err(Error::InvalidArgument(format!(
                    "rule is {rule}; it must be KO_AVOID (0) or KO_STAY_IN (1)"
                )));
            }
        };
        match (part, body) {
            (OfDimension::Plane(part), OfDimension::Plane(body)) => {
                let [motion, body_motion] = motions.map(in_plane);
                // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
                unsafe { left_of(part, (motion?, body_motion?), (body, &set, rule), &options, kept) }
            }
            (OfDimension::Space(part), OfDimension::Space(body)) => {
                let [motion, body_motion] = motions.map(in_space);
                // SAFETY: as above.
                unsafe { left_of(part, (motion?, body_motion?), (body, &set, rule), &options, kept) }
            }
            _ => Err(differ(&[("part", part.dim()), ("body", body.dim())])),
        }
    })
}

/// # Safety
/// The options' function may be called with their data.
unsafe fn left_of<const D: usize>(
    part: &Part<D>,
    (motion, body_motion): (Motion<D>, Motion<D>),
    (body, set, rule): (&Part<D>, &Bits, Rule),
    options: &ko_pair_options,
    kept: &mut [u8],
) -> Result<()> {
    check_count("n_cells", kept.len(), part.grid().n_cells())?;
    let part = part.within(&bits_of(kept, "kept")?);
    let body = Body {
        grid: *body.grid(),
        cells: cells_or_all(set, body, "n_body")?,
        relative: Relative { from: body_motion, of: motion },
        rule,
        clearance: options.clearance,
    };
    // SAFETY: the caller's promise.
    let mut tell = unsafe { listener(options.progress, options.progress_data) };
    let (workers, mut progress) = (Workers::new(options.n_threads)?, Progress::new(&mut tell));
    put(&unsweep(&part, &[body], options.sampling()?, &workers, &mut progress)?, kept);
    Ok(())
}

/// The cells of a set that was given, or all that the part may have.
fn cells_or_all<'a, const D: usize>(set: &'a Bits, part: &'a Part<D>, name: &str) -> Result<&'a Bits> {
    if set.is_empty() {
        return Ok(part.allowed());
    }
    check_count(name, set.len(), part.grid().n_cells())?;
    Ok(set)
}
