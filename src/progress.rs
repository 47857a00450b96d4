//! Progress and cancellation of long calls.

use crate::{Error, Result};
use std::ops::ControlFlow;

/// A caller's view of a long call: told the fraction done in [0, 1] and the stage's name, on the caller's thread only.
/// `ControlFlow::Break` cancels.
pub type ProgressFn<'a> = dyn FnMut(f64, &str) -> ControlFlow<()> + 'a;

/// Hands progress to a caller who may not be listening.
pub struct Progress<'a> {
    listener: Option<&'a mut ProgressFn<'a>>,
}

impl<'a> Progress<'a> {
    /// Progress told to `listener`.
    pub fn new(listener: &'a mut ProgressFn<'a>) -> Self {
        Progress { listener: Some(listener) }
    }

    /// Progress told to no one.
    pub fn silent() -> Self {
        Progress { listener: None }
    }

    /// Tells `fraction` done in `stage`; [`Error::Cancelled`] when the listener asks to stop.
    pub fn tell(&mut self, fraction: f64, stage: &str) -> Result<()> {
        if let Some(listener) = &mut self.listener
            && listener(fraction.clamp(0.0, 1.0), stage).is_break()
        {
            return Err(Error::Cancelled);
        }
        Ok(())
    }
}
