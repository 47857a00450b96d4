//! Pairs by the method of moving asymptotes, for comparison.

use super::guard::guard_with_remark;
use super::pair::{Graph, ko_pair};
use super::pair_options::ko_optimise_options;
use super::pair_shapes::{outputs, put_pair};
use super::pointer::{Sized_, check_sized, object, wanted, write_sized};
use super::progress::listener;
use super::status::{KO_BUDGET_REACHED, KO_OK};
use crate::cogen::{Design, Optimised, optimise};
use crate::dimension::in_its_dimension;
use crate::par::Workers;
use crate::progress::Progress;

/// What an optimisation found. Filled by `ko_pair_optimise`.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_optimise_report {
    /// sizeof(ko_optimise_report) as the caller knows it.
    pub struct_size: usize,
    /// gamma of the closed pair, as `ko_pair_volumes` tells: NaN where nothing is left of the colliding cells. Colliding by the conflict graph, while
    /// the optimisation's own gamma, and its history, are of the cells that collide by the measure.
    pub gamma: f64,
    /// Areas or volumes of what is left of the colliding cells of part 1 and 2 in the closed pair.
    pub volumes: [f64; 2],
    /// g_21 and g_12 of the last densities: 0 of the closed pair.
    pub measures: [f64; 2],
    /// The part of the colliding volume that the last iteration changed.
    pub change: f64,
    /// Iterations.
    pub n_iterations: u32,
    /// 1: the last change is below the tolerance, and the constraints hold within `feasibility`. 0: KO_BUDGET_REACHED.
    pub converged: i32,
}

// SAFETY: repr(C), starts with a usize, plain numbers without padding (checked below).
unsafe impl Sized_ for ko_optimise_report {
    const FIRST_SIZE: usize = size_of::<usize>() + 6 * 8 + 8;
}

const _: () = assert!(size_of::<ko_optimise_report>() == <ko_optimise_report as Sized_>::FIRST_SIZE);

/// Optimises densities by the method of moving asymptotes, (37) to (43) of Morris and Behandish 2022, and closes what it gives: `cells_1` [n_1]
/// and `cells_2` [n_2], a pair that never collides and cannot grow.
///
/// It maximises V_1 + V_2 over the densities of the colliding cells with g_21 = 0, g_12 = 0 and gamma V_1 = (1 - gamma) V_2, each within
/// `feasibility`; then densities above 1/2 are closed in the pair's conflict graph. `densities_1` [n_1] and `densities_2` [n_2] get what it ends
/// with, and `history` [5 * (max_iterations + 1)] a row for the beginning and each iteration: V_1, V_2, g_21, g_12, and the part of the
/// colliding volume that changed; rows behind the last are left as they are. Each of these three may be NULL. `options` NULL: the defaults;
/// `report_size` is sizeof *report. A minimum cut, `ko_pair_cut` or `ko_pair_family`, gives better pairs sooner; this is for comparison, and for
/// objectives of one's own. Returns KO_BUDGET_REACHED, a success, where iterations ended before the tolerance was reached. Errors:
/// KO_ERR_INVALID_ARGUMENT for a pair without measures or without conflict graph, another number of cells, an option out of its range;
/// KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. Threads: any number at once; `progress` is called on the caller's. Cost: sensitivities an iteration;
/// some 30 numbers a colliding cell.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_pair_optimise(
    pair: *const ko_pair,
    options: *const ko_optimise_options,
    n_1: usize,
    n_2: usize,
    densities_1: *mut f64,
    densities_2: *mut f64,
    cells_1: *mut u8,
    cells_2: *mut u8,
    history: *mut f64,
    report_size: usize,
    report: *mut ko_optimise_report,
) -> i32 {
    guard_with_remark(|| {
        // SAFETY: the header asks for a pair, NULL or initialised options, and NULL or arrays of these lengths.
        let (ko_pair(pair), options, rho, outs) = unsafe {
            (
                object(pair, "pair")?,
                ko_optimise_options::read(options)?,
                [wanted(densities_1, n_1, "densities_1")?, wanted(densities_2, n_2, "densities_2")?],
                outputs(cells_1, n_1, cells_2, n_2)?,
            )
        };
        // SAFETY: the header asks for NULL or an array of this length.
        let rows = unsafe { wanted(history.cast::<[f64; 5]>(), options.max_iterations as usize + 1, "history") }?;
        // Before the work, not after it.
        check_sized(report, report_size, "report")?;
        // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
        let mut told = unsafe { listener(options.progress, options.progress_data) };
        let (own, workers) = (options.to_optimise_options()?, Workers::new(options.n_threads)?);
        in_its_dimension!(pair, pair => {
            pair.check(n_1, n_2)?;
            let Graph { conflicts, room, .. } = pair.graph()?;
            let frozen = pair.frozen();
            let design = Design { correlation: pair.correlation()?, conflicts, room, frozen };
            let found = optimise(&design, &own, &workers, &mut Progress::new(&mut told))?;
            let told = told_of(&found, pair.volumes(&found.pair)?);
            // SAFETY: the header asks for a struct of this size.
            unsafe { write_sized(report, report_size, told, "report") }?;
            put_pair(&found.pair, outs);
            for (to, from) in rho.into_iter().zip(&found.densities) {
                if let Some(to) = to {
                    to.copy_from_slice(from);
                }
            }
            for (to, it) in rows.into_iter().flatten().zip(&found.history) {
                *to = [it.volumes[0], it.volumes[1], it.measures.g21, it.measures.g12, it.change];
            }
            Ok(if found.converged { KO_OK } else { KO_BUDGET_REACHED })
        })
    })
}

fn told_of(found: &Optimised, (volumes, gamma): ([f64; 2], f64)) -> ko_optimise_report {
    let last = found.history.last().expect("there is a beginning");
    ko_optimise_report {
        struct_size: size_of::<ko_optimise_report>(),
        gamma,
        volumes,
        measures: [last.measures.g21, last.measures.g12],
        change: last.change,
        n_iterations: (found.history.len() - 1) as u32,
        converged: i32::from(found.converged),
    }
}
