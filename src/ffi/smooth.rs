//! Smoothing of clouds.

use super::cloud::ko_cloud;
use super::guard::guard;
use super::pointer::{Sized_, create, object, read_sized_or, write_sized};
use super::progress::{ko_progress, listener};
use crate::dimension::OfDimension;
use crate::geometry::smooth::SmoothOptions;
use crate::progress::Progress;
use crate::{Error, Result};
use std::ffi::c_void;

/// Options of `ko_cloud_smooth`. Initialise by `ko_smooth_options_init`, then set what shall differ.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_smooth_options {
    /// sizeof(ko_smooth_options), set by ko_smooth_options_init.
    pub struct_size: usize,
    /// Nearest points that a point is smoothed by, itself among them, in [4, 128]; 0 (the default) for 40 in space and 12 in the plane.
    /// More smooth more.
    pub neighbours: u32,
    /// Times that the whole cloud is smoothed, in [1, 100]. Default 1.
    pub rounds: u32,
    /// Threads, at most 1024: 0 (default) for all cores, 1 for none but the caller's. The result does not depend on it.
    pub n_threads: u32,
    /// Must be 0.
    pub reserved: u32,
    /// Told of progress, or NULL (default).
    pub progress: ko_progress,
    /// Handed to `progress`.
    pub progress_data: *mut c_void,
}

// SAFETY: repr(C), starts with a usize, and no padding, by the order of its fields (checked below). Every pattern of bits is a value:
// `progress` may be any address, as in C, and is only ever called as the caller promised.
unsafe impl Sized_ for ko_smooth_options {
    const FIRST_SIZE: usize = 2 * size_of::<usize>() + 16 + size_of::<ko_progress>();
}

const _: () = assert!(size_of::<ko_smooth_options>() == <ko_smooth_options as Sized_>::FIRST_SIZE);

/// Fills `options` with the defaults. `struct_size` is sizeof *options.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_smooth_options_init(options: *mut ko_smooth_options, struct_size: usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(options, struct_size, ko_smooth_options::defaults(), "options") }
    })
}

impl ko_smooth_options {
    fn defaults() -> Self {
        let d = SmoothOptions::default();
        ko_smooth_options {
            struct_size: size_of::<ko_smooth_options>(),
            neighbours: d.neighbours,
            rounds: d.rounds,
            n_threads: d.n_threads,
            reserved: 0,
            progress: None,
            progress_data: std::ptr::null_mut(),
        }
    }

    /// The options at `pointer`, or the defaults for NULL.
    ///
    /// # Safety
    /// `pointer` is NULL or points to as many bytes as its `struct_size` says.
    unsafe fn read(pointer: *const Self) -> Result<Self> {
        // SAFETY: the caller's promise.
        let options = unsafe { read_sized_or(pointer, Self::defaults(), "options") }?;
        match options.reserved {
            0 => Ok(options),
            r => Err(Error::InvalidArgument(format!("reserved is {r}; it must be 0"))),
        }
    }
}

/// Smooths noise out of points and normals, which must be about right before, into a new cloud: moving least squares (Alexa et al. 2003).
///
/// Each point goes to a quadratic through the nearest points that face the same way. Edges are rounded over about the distance of the last
/// of these. Weights stay, origins go. `options` NULL: the defaults. `*smoothed` is the caller's to free; `cloud` is left as it is.
/// Errors: KO_ERR_INVALID_ARGUMENT for an option out of its range, KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. Threads: any; `progress` is
/// called on the caller's. Cost: about 6 microseconds a point and round on one thread, in the plane 1.5; about 300 bytes a point meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_cloud_smooth(
    cloud: *const ko_cloud,
    options: *const ko_smooth_options,
    smoothed: *mut *mut ko_cloud,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for a cloud.
            let ko_cloud(cloud) = unsafe { object(cloud, "cloud") }?;
            // SAFETY: the header asks for NULL or initialised options.
            let options = unsafe { ko_smooth_options::read(options) }?;
            // SAFETY: the header asks for a function that may be called with `progress_data`.
            let mut tell = unsafe { listener(options.progress, options.progress_data) };
            let mut progress = Progress::new(&mut tell);
            let ko_smooth_options { neighbours, rounds, n_threads, .. } = options;
            let options = SmoothOptions { neighbours, rounds, n_threads };
            Ok(ko_cloud(match cloud {
                OfDimension::Plane(cloud) => OfDimension::Plane(cloud.smoothed(&options, &mut progress)?),
                OfDimension::Space(cloud) => OfDimension::Space(cloud.smoothed(&options, &mut progress)?),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(smoothed, "smoothed", make) }
    })
}
