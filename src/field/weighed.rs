//! What the points of a fit counted for in its last solve: which form the field is the minimum of, beside its options.

use super::data::{Data, Mass};
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
    /// Points from which no distances were held, by number: they did not count when these were measured.
    without_distances: Vec<u32>,
}

/// What the memory is for, should it run out.
const WHAT: &str = "what the points counted for";

impl Weighed {
    /// Of the masses that `data` has now; `without_distances` are numbers of points, in order.
    pub fn of<const D: usize>(data: &Data<D>, without_distances: Vec<u32>) -> Result<Self> {
        let differs = |place: &usize| data.mass[*place] != data.own_mass(*place);
        let places = || (0..data.mass.len()).filter(differs);
        let factor = |place: usize| {
            let (Mass { value, gradient }, share) = (data.mass[place], data.share[place]);
            Mass { value: value / share, gradient: gradient / share }
        };
        let mut factors = try_with_capacity(places().count(), WHAT)?;
        factors.extend(places().map(|place| (data.number[place], factor(place))));
        factors.sort_unstable_by_key(|(number, _)| *number);
        Ok(Weighed { n_points: data.mass.len(), factors, without_distances })
    }

    /// The numbers of the points of `data` whose normals count for so little that no distances are held from them.
    pub fn doubtful<const D: usize>(data: &Data<D>) -> Result<Vec<u32>> {
        let places = || (0..data.mass.len()).filter(|place| !data.counts(*place));
        let mut numbers = try_with_capacity(places().count(), WHAT)?;
        numbers.extend(places().map(|place| data.number[place]));
        numbers.sort_unstable();
        Ok(numbers)
    }

    /// Gives the points of `data`, which have their shares, the masses that they had when distances were measured: as far as these tell
    /// which count.
    pub fn weigh_for_distances<const D: usize>(&self, data: &mut Data<D>) {
        for place in 0..data.mass.len() {
            if self.without_distances.binary_search(&data.number[place]).is_ok() {
                data.mass[place] = Mass { value: 0.0, gradient: 0.0 };
            }
        }
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

    /// Numbers of the points from which no distances are held, in order.
    pub fn without_distances(&self) -> &[u32] {
        &self.without_distances
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> usize {
        size_of::<(u32, Mass)>() * self.factors.capacity() + size_of::<u32>() * self.without_distances.capacity()
    }
}
