//! Co-generation: two parts in relative motion, shaped together until they never collide and cannot grow. Morris and Behandish 2022, *paper 002*.
//!
//! Takes two [`Part`]s, which are grids of cells and what each may do with its own, and a [`Relative`] motion; gives collision measures with
//! their derivatives, and pairs of parts. A pair is a set of cells for each; none of what is given back collides.
//!
//! | source | here |
//! |---|---|
//! | motions, (3), (4); of gears and linkages; relative motion, (8), (9) | [`motion`]; [`mechanism`]; [`steps`] |
//! | sweep and unsweep, (1), (2), (23), (24) | [`mod@sweep`] |
//! | cells, (A.2); densities, (A.3) | [`grid`], [`part`]; [`fraction`] |
//! | correlation weights, (A.14) to (A.17) | `trajectory`; of screws `pitch` |
//! | measures, (12) to (15) and (27) to (30); sensitivities, (31), (32) | [`correlation`] |
//! | topological sensitivities, appendix B | [`topological`] |
//! | initially colliding subdomains, (33) to (36) | [`Correlation::colliding`] |
//! | (37) to (43), Algorithm 1; Svanberg 1987, moving asymptotes | [`mod@optimise`]; [`mma`] |
//! | Definition 2, maximal pairs | [`closure`] |
//! | overlap of moving cells, none missed | `separation` |
//! | pairs as independent sets of a bipartite graph; the best as a minimum cut | [`conflict`], `rows`; [`mod@cut`] |
//! | weights of cells as whole numbers | [`weights`] |
//! | Goldberg and Tarjan 1988, push and relabel | `flow` |
//! | Picard and Queyranne 1980, all minimum cuts; Tarjan 1972 | `ties` |
//! | (25), (26), the family over gamma | [`mod@family`], `proximal` |
//! | symmetric pairs | [`symmetry`] |
//! | more than two parts; Nemhauser and Trotter 1975, the bound | [`assembly`]; `swept_box` |
//! | figure 11, gaps over the motion; Felzenszwalb and Huttenlocher 2012, distance maps | [`mod@contact`] |
//! | of pairs of one weight, those that keep in touch | [`persistent`] |
//! | meshes of parts; Gibson 1998, surface nets | [`boundary`]; `relax` |
//!
//! Where we depart from the paper, beyond what the pages of these say. Its measure looks at centres of cells at sampled times, so that pairs for
//! which it is 0 still overlap: conflicts are by default those of whole cells at all times ([`Conflicts::of_overlap`]), and the measure's own are
//! there as well ([`Correlation::conflicts`]). Lemma 1 speaks of the 0-superlevel set of the local measures, which is everything: it is their
//! zero set that is the unsweep. And its optimisation finds a pair, where a cut finds the best.
//!
//! Notation: S_i the cells of part i, A_i those that it may have, N(.) neighbours in the conflict graph, eps a cell's edge, K steps of time,
//! tau the pose of a part or, seen from the other, of both; w^12 and w^21 as in the paper. *Near* is the part whose cells the graph's rows are
//! of, *far* the other.

#![forbid(unsafe_code)]

pub mod assembly;
pub mod bits;
pub mod boundary;
pub mod closure;
pub mod conflict;
pub mod contact;
pub mod correlation;
mod cube;
pub mod cut;
pub mod family;
mod flow;
mod foresight;
pub mod fraction;
pub mod frozen;
pub mod grid;
pub mod mechanism;
pub mod mma;
pub mod motion;
pub mod optimise;
mod parcels;
pub mod part;
pub mod persistent;
mod pitch;
mod proximal;
mod relax;
mod rows;
mod sampled;
mod separation;
pub mod steps;
pub mod sweep;
mod swept_box;
pub mod symmetry;
mod ties;
pub mod topological;
mod trajectory;
pub mod weights;

pub use assembly::{ArrangeOptions, Arrangement, Assembly};
pub use bits::Bits;
pub use boundary::{BoundaryOptions, Within, mesh_of_cells, mesh_of_densities};
pub use closure::{Pair, close, larger, room};
pub use conflict::{Conflicts, OverlapOptions, Side};
pub use contact::{Contact, Gap, contact};
pub use correlation::{Correlation, Measures};
pub use cut::{Cut, cut};
pub use family::{FamilyOptions, Member, family};
pub use frozen::{Clash, Clashes, clashes};
pub use grid::Grid;
pub use motion::{Law, Motion, Wave};
pub use optimise::{Design, OptimiseOptions, Optimised, optimise};
pub use part::{Cell, Part};
pub use persistent::{PersistenceOptions, Persistent, more_persistent};
pub use sampled::SpeedLimit;
pub use steps::{Relative, Sampling};
pub use symmetry::{Folded, Symmetry};
pub use topological::Change;
pub use weights::{CellWeights, Weights};

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_boundary;
#[cfg(test)]
mod tests_gaps;
#[cfg(test)]
mod tests_limits;
#[cfg(test)]
mod tests_measures;
#[cfg(test)]
mod tests_periods;
