//! What the points of a fit counted for in its last solve, and the distances that it held: which form the field is the minimum of, beside its
//! options.

use super::data::{Data, Mass};
use super::held::Held;
use crate::Result;
use crate::error::try_with_capacity;

/// The points that counted for more or less than their share, by their numbers in the cloud; those that the caller gives no weight are not
/// counted.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Weighed {
    /// Points of the fit; 0 where nothing is known of it.
    n_points: usize,
    /// Masses that are not the share, as factors on it, by number.
    factors: Vec<(u32, Mass)>,
    /// `None` where no distances were held, or nothing is known of them.
    held: Option<Held>,
}

/// What the memory is for, should it run out.
const WHAT: &str = "what the points counted for";

impl Weighed {
    /// Of the masses that `data` has now, and the distances `held`.
    pub fn of<const D: usize>(data: &Data<D>, held: Option<Held>) -> Result<Self> {
        let differs = |place: &usize| data.mass[*place] != data.own_mass(*place);
        let places = || (0..data.mass.len()).filter(differs);
        let factor = |place: usize| {
            let (Mass { value, gradient }, share) = (data.mass[place], data.share[place]);
            Mass { value: value / share, gradient: gradient / share }
        };
        let mut factors = try_with_capacity(places().count(), WHAT)?;
        factors.extend(places().map(|place| (data.number[place], factor(place))));
        factors.sort_unstable_by_key(|(number, _)| *number);
        Ok(Weighed { n_points: data.mass.len(), factors, held })
    }

    /// Gives the points of `data` the masses that they had in the last solve.
    pub fn weigh<const D: usize>(&self, data: &mut Data<D>) {
        data.reset_weights();
        for place in 0..data.mass.len() {
            if let Ok(i) = self.factors.binary_search_by_key(&data.number[place], |(number, _)| *number) {
                let (factor, share) = (self.factors[i].1, data.share[place]);
                data.mass[place] = Mass { value: share * factor.value, gradient: share * factor.gradient };
            }
        }
    }

    /// Points of the fit; 0 where nothing is known of it.
    pub fn n_points(&self) -> usize {
        self.n_points
    }

    /// The distances held.
    pub fn held(&self) -> Option<&Held> {
        self.held.as_ref()
    }
}
