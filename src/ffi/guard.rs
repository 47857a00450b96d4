//! The guard under which every entry runs: errors become codes, panics become `KO_ERR_INTERNAL`, nothing unwinds into C.

use super::status::{KO_ERR_INTERNAL, KO_OK, code, remember};
use crate::{Result, par};
use std::any::Any;
use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

thread_local! {
    static IN_CALL: Cell<bool> = const { Cell::new(false) };
}

/// Runs an entry's body and turns its end into a status.
pub(super) fn guard(body: impl FnOnce() -> Result<()>) -> i32 {
    guard_with_remark(|| body().map(|()| KO_OK))
}

/// [`guard`] for a body that may succeed with a remark: it gives the status itself, `KO_OK` or a positive one.
pub(super) fn guard_with_remark(body: impl FnOnce() -> Result<i32>) -> i32 {
    quiet_caught_panics();
    let outer = IN_CALL.replace(true);
    // Unwind safety: bodies build aside and swap, so a panic leaves every handle as it was.
    let end = panic::catch_unwind(AssertUnwindSafe(body));
    IN_CALL.set(outer);
    match end {
        Ok(Ok(status)) => {
            debug_assert!(status >= KO_OK);
            status
        }
        Ok(Err(error)) => {
            remember(&error.to_string());
            code(&error)
        }
        Err(payload) => {
            remember(&format!("internal error: {}; please report it", text(&payload)));
            // A payload may panic as it is dropped.
            let _ = panic::catch_unwind(AssertUnwindSafe(|| drop(payload)));
            KO_ERR_INTERNAL
        }
    }
}

/// Runs a body that cannot fail but by a panic, which is swallowed.
pub(super) fn guard_free(body: impl FnOnce()) {
    guard(|| {
        body();
        Ok(())
    });
}

fn text(payload: &Box<dyn Any + Send>) -> &str {
    let text = payload.downcast_ref::<&str>().copied();
    text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("a panic without text")
}

/// Panics that a guard will catch print nothing; all others go to the hook that was there before.
///
/// The hook is the one piece of state that calls share: the library must not print, and only a hook can keep a panic from it.
fn quiet_caught_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let previous = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            let ours = IN_CALL.try_with(Cell::get).unwrap_or(false)
                || std::thread::current().name().is_some_and(|name| name.starts_with(par::THREAD_NAME));
            if !ours {
                previous(info);
            }
        }));
    });
}

#[cfg(test)]
mod tests {
    use super::super::status::{KO_ERR_CANCELLED, KO_OPEN_AT_BOX, ko_last_error};
    use super::*;
    use crate::Error;
    use std::ffi::CStr;

    fn last_error() -> String {
        // SAFETY: never NULL, NUL-terminated, and no call fails on this thread before the text is copied.
        unsafe { CStr::from_ptr(ko_last_error()) }.to_string_lossy().into_owned()
    }

    #[test]
    fn errors_become_codes_and_success_leaves_the_last_message() {
        assert_eq!(guard(|| Err(Error::Cancelled)), KO_ERR_CANCELLED);
        let message = last_error();
        assert!(message.contains("cancelled"));
        assert_eq!(guard(|| Ok(())), KO_OK);
        assert_eq!(guard_with_remark(|| Ok(KO_OPEN_AT_BOX)), KO_OPEN_AT_BOX);
        assert_eq!(last_error(), message);
    }

    #[test]
    fn a_panic_is_an_internal_error_with_its_text() {
        assert_eq!(guard(|| panic!("the moon is {}", "full")), KO_ERR_INTERNAL);
        assert!(last_error().contains("the moon is full"));
        assert_eq!(guard(|| Ok(())), KO_OK);
    }

    #[test]
    fn a_panic_on_a_worker_thread_is_one_too() {
        let status = guard(|| {
            crate::par::Workers::new(2)?.for_each(0..4, |i| assert!(i != 2, "item {i} failed"));
            Ok(())
        });
        assert_eq!(status, KO_ERR_INTERNAL);
        assert!(last_error().contains("item 2 failed"));
    }
}
