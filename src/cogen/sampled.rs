//! Motions sampled from functions.

use super::frozen::brief;
use super::grid::Grid;
use super::motion::Motion;
use crate::error::try_with_capacity;
use crate::geometry::rigid::Rigid;
use crate::geometry::vec::{norm, number, sub};
use crate::{Error, Result};

/// How fast a part's points are, at most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedLimit<const D: usize> {
    /// The part's grid.
    pub grid: Grid<D>,
    /// Way in the world that no point of it goes more of, by unit of t.
    pub speed: f64,
}

impl<const D: usize> Motion<D> {
    /// The motion that `pose` gives, sampled at `n` even times from 0 to 1: the screws from each sample to the next, as of
    /// [`Motion::sampled`]. The error tells at which time a pose is none, and with a limit of speed, where the motion jumps.
    pub fn of_function(
        n: usize,
        limit: Option<SpeedLimit<D>>,
        mut pose: impl FnMut(f64) -> Result<Rigid<D>>,
    ) -> Result<Self> {
        if let Some(SpeedLimit { speed, .. }) = limit
            && !(speed >= 0.0 && speed.is_finite())
        {
            let text = format!("a limit of speed of {}; it must be 0 or more, and finite", number(speed));
            return Err(Error::InvalidArgument(text));
        }
        let n_steps = n.max(2) - 1;
        let time = |k: usize| k as f64 / n_steps as f64;
        let mut poses: Vec<Rigid<D>> = try_with_capacity(n, "a motion's poses")?;
        for k in 0..n {
            let next =
                pose(time(k)).and_then(|next| Rigid::new(next.turn, next.shift)).map_err(|error| match error {
                    Error::InvalidArgument(text) => {
                        Error::InvalidArgument(format!("pose {k}, at time {}: {text}", number(time(k))))
                    }
                    other => other,
                })?;
            if let (Some(SpeedLimit { grid, speed }), Some(last)) = (limit, poses.last()) {
                let way = grid.corners().map(|p| norm(sub(next.apply(p), last.apply(p)))).fold(0.0, f64::max);
                let most = speed / n_steps as f64;
                if way > most * (1.0 + 1e-9) {
                    let [from, to, way, most, speed] = brief([time(k - 1), time(k), way, most, speed]).map(number);
                    return Err(Error::InvalidArgument(format!(
                        "the motion jumps: from time {from} to time {to} the part goes by {way}, more than the {most} that a speed of {speed} \
                         allows"
                    )));
                }
            }
            poses.push(next);
        }
        Motion::sampled(poses)
    }
}

#[cfg(test)]
mod tests {
    use super::super::motion::Law;
    use super::*;

    #[test]
    fn functions_that_jump_or_give_no_pose_are_refused() {
        let slide = Motion::<2>::slide([1.0, 0.0], Law::even(0.5)).unwrap();
        let limit = SpeedLimit { grid: Grid::new([0.0; 2], 0.1, [10, 10]).unwrap(), speed: 0.5 };
        let of = |pose: &dyn Fn(f64) -> Rigid<2>| Motion::of_function(101, Some(limit), |t| Ok(pose(t)));
        let sampled = of(&|t| slide.at(t)).unwrap();
        for t in [0.0, 0.111, 0.5, 1.0] {
            assert!(norm(sub(sampled.at(t).shift, slide.at(t).shift)) < 1e-15);
        }
        let told = of(&|t| slide.at(if t < 0.405 { t } else { t + 0.1 })).unwrap_err().to_string();
        assert!(told.contains("the motion jumps: from time 0.4 to time 0.41 the part goes by 0.055"), "{told}");
        // A turn about a corner moves the other one by its diagonal.
        let turn = Motion::turn([0.0; 2], Law::even(0.4)).unwrap();
        assert!(of(&|t| turn.at(t)).unwrap_err().to_string().contains("from time 0 to time 0.01"));
        let nan = of(&|t| if t > 0.7 { Rigid { shift: [f64::NAN; 2], ..Rigid::IDENTITY } } else { Rigid::IDENTITY });
        let told = nan.unwrap_err().to_string();
        assert!(told.contains("pose 71, at time 0.71: an entry of the pose is not finite"), "{told}");
        let bent = of(&|_| Rigid { turn: [[1.0, 0.0], [0.1, 1.0]], shift: [0.0; 2] }).unwrap_err().to_string();
        assert!(bent.contains("pose 0, at time 0: the pose is not rigid"), "{bent}");
        assert!((0..2).all(|n| Motion::<2>::of_function(n, None, |_| Ok(Rigid::IDENTITY)).is_err()));
        assert_eq!(Motion::<2>::of_function(5, None, |_| Err(Error::Cancelled)).unwrap_err(), Error::Cancelled);
    }
}
