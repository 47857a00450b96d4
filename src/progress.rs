//! Progress and cancellation of long calls.

use crate::{Error, Result};
use std::ops::ControlFlow;

/// A caller's view of a long call: told the fraction done in [0, 1] and the stage's name, on the caller's thread only.
/// `ControlFlow::Break` cancels.
pub type ProgressFn<'a> = dyn FnMut(f64, &str) -> ControlFlow<()> + 'a;

/// Hands progress to a caller who may not be listening.
pub struct Progress<'a> {
    listener: Option<&'a mut ProgressFn<'a>>,
    /// The largest fraction told: a residual may rise for a while, a bar must not fall.
    told: f64,
}

impl<'a> Progress<'a> {
    /// Progress told to `listener`.
    pub fn new(listener: &'a mut ProgressFn<'a>) -> Self {
        Progress { listener: Some(listener), told: 0.0 }
    }

    /// Progress told to no one.
    pub fn silent() -> Self {
        Progress { listener: None, told: 0.0 }
    }

    /// Tells `fraction` done in `stage`, or the fraction told before where that is larger; [`Error::Cancelled`] when the listener asks to
    /// stop.
    pub fn tell(&mut self, fraction: f64, stage: &str) -> Result<()> {
        self.told = self.told.max(fraction).min(1.0);
        if let Some(listener) = &mut self.listener
            && listener(self.told, stage).is_break()
        {
            return Err(Error::Cancelled);
        }
        Ok(())
    }

    /// Does a part of the work, of which a fraction f is the fraction `from` + (`to` - `from`) f of all.
    pub fn part<T>(&mut self, from: f64, to: f64, work: impl FnOnce(&mut Progress<'_>) -> T) -> T {
        let mut relay = |fraction: f64, stage: &str| match self.tell(from + (to - from) * fraction, stage) {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        };
        work(&mut Progress::new(&mut relay))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_never_fall_and_stay_within_one() {
        let mut told = Vec::new();
        let mut listen = |fraction: f64, _: &str| {
            told.push(fraction);
            ControlFlow::Continue(())
        };
        let mut progress = Progress::new(&mut listen);
        for fraction in [0.1, 0.5, 0.3, f64::NAN, 2.0, 0.9] {
            progress.tell(fraction, "stage").unwrap();
        }
        assert_eq!(told, [0.1, 0.5, 0.5, 0.5, 1.0, 1.0]);
    }

    #[test]
    fn parts_tell_their_share_and_are_cancelled_with_the_whole() {
        let mut told = Vec::new();
        let mut listen = |fraction: f64, _: &str| {
            told.push(fraction);
            if fraction < 0.75 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let mut progress = Progress::new(&mut listen);
        progress.part(0.0, 0.5, |p| p.tell(0.5, "first")).unwrap();
        let end = progress.part(0.5, 1.0, |p| p.tell(0.25, "second").and_then(|()| p.tell(0.5, "second")));
        assert!(matches!(end, Err(Error::Cancelled)));
        assert_eq!(told, [0.25, 0.625, 0.75]);
    }
}
