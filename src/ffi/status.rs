//! Status codes, and the text behind the last error of a thread.

use crate::Error;
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};

/// The call did what it says.
pub const KO_OK: i32 = 0;
/// A success with a remark: the level set meets the field's box, and its mesh is open there.
pub const KO_OPEN_AT_BOX: i32 = 1;
/// A success with a remark: refinement came to the end of its control points, of its memory, or of what the points tell, before the error
/// asked for; a certificate to the end of its boxes before its tolerance.
pub const KO_BUDGET_REACHED: i32 = 2;
/// A success with a remark: the mesh bounds no solid, so that a certificate covers what is near it, and no side.
pub const KO_SIDE_NOT_CERTIFIED: i32 = 3;
/// A success with a remark: no cell of one part ever meets one of the other.
pub const KO_NEVER_MEET: i32 = 4;
/// An argument is not one that the call takes: NULL where something is needed, a wrong length, a NaN, a value out of range.
pub const KO_ERR_INVALID_ARGUMENT: i32 = -1;
/// The call would take more memory than its limit, or than the system gives.
pub const KO_ERR_OUT_OF_MEMORY: i32 = -2;
/// The operating system could not read or write a file.
pub const KO_ERR_IO: i32 = -3;
/// A file's content is not what its format asks for.
pub const KO_ERR_FORMAT: i32 = -4;
/// The request is sound, but this version does not serve it.
pub const KO_ERR_UNSUPPORTED: i32 = -5;
/// The geometry gives no such result: all points equal, say.
pub const KO_ERR_DEGENERATE: i32 = -6;
/// The solve stopped short of its tolerance.
pub const KO_ERR_NOT_CONVERGED: i32 = -7;
/// The caller's progress function asked to stop.
pub const KO_ERR_CANCELLED: i32 = -8;
/// A fault of this library. The handles of the call are as they were; please report the message.
pub const KO_ERR_INTERNAL: i32 = -9;

thread_local! {
    static LAST_ERROR: RefCell<Option<CString>> = const { RefCell::new(None) };
}

/// The code of an error.
pub(super) fn code(error: &Error) -> i32 {
    match error {
        Error::InvalidArgument(_) => KO_ERR_INVALID_ARGUMENT,
        Error::OutOfMemory { .. } => KO_ERR_OUT_OF_MEMORY,
        Error::Io { .. } => KO_ERR_IO,
        Error::Format { .. } => KO_ERR_FORMAT,
        Error::Unsupported(_) => KO_ERR_UNSUPPORTED,
        Error::Degenerate(_) => KO_ERR_DEGENERATE,
        Error::NotConverged { .. } => KO_ERR_NOT_CONVERGED,
        Error::Cancelled => KO_ERR_CANCELLED,
    }
}

/// Keeps `message` for `ko_last_error` on this thread.
pub(super) fn remember(message: &str) {
    // A path may hold any byte but NUL on the way in; a panic's text may hold even that.
    let message = CString::new(message.replace('\0', "?")).unwrap_or_default();
    // A thread on its way out has no place to keep it.
    let _ = LAST_ERROR.try_with(|last| last.replace(Some(message)));
}

/// Message of the last call that failed on this thread: what was wrong, where, and what would be right.
///
/// Never NULL; "" when no call failed yet. Owned by the library; valid until the next failing call on this thread. A call that succeeds
/// leaves it as it is. Threads: each has its own. Cost: none.
#[unsafe(no_mangle)]
pub extern "C" fn ko_last_error() -> *const c_char {
    const NONE: &CStr = c"";
    LAST_ERROR
        .try_with(|last| last.borrow().as_ref().map_or(NONE.as_ptr(), |message| message.as_ptr()))
        .unwrap_or(NONE.as_ptr())
}

/// Name of a status code, "KO_OK" for 0, say; "unknown status" for a number that is none. Never NULL; static. Any thread.
#[unsafe(no_mangle)]
pub extern "C" fn ko_status_string(status: i32) -> *const c_char {
    let name = match status {
        KO_OK => c"KO_OK",
        KO_OPEN_AT_BOX => c"KO_OPEN_AT_BOX",
        KO_BUDGET_REACHED => c"KO_BUDGET_REACHED",
        KO_SIDE_NOT_CERTIFIED => c"KO_SIDE_NOT_CERTIFIED",
        KO_NEVER_MEET => c"KO_NEVER_MEET",
        KO_ERR_INVALID_ARGUMENT => c"KO_ERR_INVALID_ARGUMENT",
        KO_ERR_OUT_OF_MEMORY => c"KO_ERR_OUT_OF_MEMORY",
        KO_ERR_IO => c"KO_ERR_IO",
        KO_ERR_FORMAT => c"KO_ERR_FORMAT",
        KO_ERR_UNSUPPORTED => c"KO_ERR_UNSUPPORTED",
        KO_ERR_DEGENERATE => c"KO_ERR_DEGENERATE",
        KO_ERR_NOT_CONVERGED => c"KO_ERR_NOT_CONVERGED",
        KO_ERR_CANCELLED => c"KO_ERR_CANCELLED",
        KO_ERR_INTERNAL => c"KO_ERR_INTERNAL",
        _ => c"unknown status",
    };
    name.as_ptr()
}
