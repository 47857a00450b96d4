//! What a fit did.

/// Figures of a fit; lengths are fractions of D.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FitReport {
    /// Control points along x, y, z, of a refined field those of its longest cells; 0 along z in the plane.
    pub control_points: [u32; 3],
    /// Points of the cloud.
    pub n_points: u64,
    /// Unknowns of the solve: control points in all.
    pub n_unknowns: u64,
    /// Levels of cells, each half as long as those of the one before: 1 for a field that is not refined.
    pub n_levels: u32,
    /// Points that a robust fit left out at last.
    pub n_outliers: u64,
    /// Of the cells in which distances are held, those farther than one from the points (refined: than half of one of theirs, and their
    /// spacing), the part on whose side there is little doubt: 1 for closed shapes. Less for open ones: beyond their rim and far from them
    /// the sign of phi is one of many; [`crate::geometry::sides`] tells where. NaN where no distances were held, and for a field that was
    /// loaded or made.
    pub clear_sides: f64,
    /// Iterations of conjugate gradients, over all rounds of reweighting and refinement.
    pub iterations: u32,
    /// Relative residual reached in the last round.
    pub residual: f64,
    /// Mean factor by which an iteration lowered it in that round, those with the last preconditioner alone; 0 where none
    /// was needed, NaN for a field that was loaded.
    pub convergence_rate: f64,
    /// Seconds to bring the points in order and to measure the far distances; of refined fits, those to bring functions in order too, and
    /// all of it on the cells of each round.
    pub seconds_assembly: f64,
    /// Seconds of the solves, with right-hand sides, preconditioners, and what looks at their outcome between them.
    pub seconds_solve: f64,
    /// Seconds to measure the figures below.
    pub seconds_check: f64,
    /// Root mean square of phi at the points of the cloud.
    pub rms: f64,
    /// Largest |phi| at the points of the cloud.
    pub max: f64,
    /// Mean of |grad phi| at the points of the cloud: 1 for a distance.
    pub mean_gradient: f64,
}
