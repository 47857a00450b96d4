//! The caller's progress function.

use std::ffi::{CString, c_char, c_void};
use std::ops::ControlFlow;

/// Called on the caller's thread with the fraction done in [0, 1], the stage's name (valid during the call) and `progress_data`; not 0
/// cancels. It must not unwind, throw or jump out.
#[allow(non_camel_case_types)]
pub type ko_progress = Option<unsafe extern "C" fn(fraction: f64, stage: *const c_char, data: *mut c_void) -> i32>;

/// What hands the library's progress to the caller's function, or to no one.
///
/// # Safety
/// `progress` may be called with `data` for as long as what is returned lives.
pub(super) unsafe fn listener(progress: ko_progress, data: *mut c_void) -> impl FnMut(f64, &str) -> ControlFlow<()> {
    move |fraction, stage| {
        let Some(progress) = progress else { return ControlFlow::Continue(()) };
        let stage = CString::new(stage).unwrap_or_default();
        // SAFETY: the caller's promise.
        match unsafe { progress(fraction, stage.as_ptr(), data) } {
            0 => ControlFlow::Continue(()),
            _ => ControlFlow::Break(()),
        }
    }
}
