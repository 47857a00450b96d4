//! A fit takes no more memory than its limit: every allocation of the process is counted.

use keepout::Error;
use keepout::field::{Field, FitOptions, fit};
use keepout::geometry::shapes::{circle, torus};
use keepout::geometry::{Cloud, Mesh};
use keepout::progress::Progress;
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The system's allocator, with the bytes that are taken and the most that were.
struct Counting;

static TAKEN: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: all work is the system's.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let taken = TAKEN.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        MOST.fetch_max(taken, Ordering::Relaxed);
        // SAFETY: the caller's word on `layout`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, start: *mut u8, layout: Layout) {
        TAKEN.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's word on both, of memory that came from the system.
        unsafe { System.dealloc(start, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// A fit to `n_points` samples of `mesh`, and the most bytes that it and its cloud took.
fn fit_counted<const D: usize>(
    mesh: &Mesh<D>,
    n_points: usize,
    options: &FitOptions,
) -> (Result<Field<D>, Error>, u64) {
    counted(mesh, n_points, |cloud| Field::fit(cloud, options, &mut Progress::silent()))
}

/// What `fit` makes of `n_points` samples of `mesh`, and the most bytes that it and its cloud took.
fn counted<const D: usize>(
    mesh: &Mesh<D>,
    n_points: usize,
    fit: impl Fn(&Cloud<D>) -> Result<Field<D>, Error>,
) -> (Result<Field<D>, Error>, u64) {
    let before = TAKEN.load(Ordering::Relaxed);
    let cloud = mesh.sample(n_points, 1).unwrap();
    // As from arrays, without what tells the samples' triangles.
    let cloud = Cloud::new(cloud.points().to_vec(), cloud.normals().to_vec()).unwrap();
    MOST.store(TAKEN.load(Ordering::Relaxed), Ordering::Relaxed);
    let end = fit(&cloud);
    (end, (MOST.load(Ordering::Relaxed) - before) as u64)
}

/// Fits to `n_points` samples of `mesh` stay within limits from the least that is needed to the least with which a multigrid fits.
fn check<const D: usize>(mesh: &Mesh<D>, n_points: usize, control_points: [u32; 3]) {
    let least = fit::memory(n_points as u128, std::array::from_fn::<u128, D, _>(|a| control_points[a].into())) as u64;
    let mut limit = least;
    while !stays_within(limit, mesh, n_points, control_points) {
        limit += limit / 4;
        assert!(limit < 100 * least, "no multigrid");
    }
}

/// Whether a fit to the paper's energy goes on by multigrid; that with distances stays within the limit too.
fn stays_within<const D: usize>(limit: u64, mesh: &Mesh<D>, n_points: usize, control_points: [u32; 3]) -> bool {
    let converges = [150.0, 0.0].map(|distance_weight| {
        let options = FitOptions {
            control_points,
            distance_weight,
            reweightings: 0,
            tolerance: 1e-8,
            // Of the diagonal hundreds are needed.
            max_iterations: 80,
            n_threads: 1,
            memory_limit: limit,
            ..FitOptions::default()
        };
        let (end, taken) = fit_counted(mesh, n_points, &options);
        assert!(taken <= limit, "{control_points:?}, {n_points} points: {taken} bytes of {limit}");
        match end {
            Ok(_) => true,
            Err(Error::NotConverged { .. }) => false,
            Err(error) => panic!("{error}"),
        }
    });
    converges[1]
}

/// Fits that would refine without end stay within their limits, and use them.
fn check_refining<const D: usize>(mesh: &Mesh<D>, n_points: usize, megabytes: [u64; 3]) {
    for limit in megabytes.map(|m| m << 20) {
        let options = FitOptions {
            control_points: [10; 3],
            max_error: 1e-7,
            max_unknowns: u64::MAX,
            reweightings: 0,
            tolerance: 0.1,
            n_threads: 1,
            memory_limit: limit,
            ..FitOptions::default()
        };
        let (end, taken) = fit_counted(mesh, n_points, &options);
        let field = end.unwrap();
        assert!(
            taken <= limit && field.is_refined(),
            "{n_points} points: {taken} bytes of {limit}, {:?}",
            field.report()
        );
        assert!(taken > limit / 2, "{n_points} points: {taken} bytes of {limit}, {:?}", field.report());
    }
}

/// Refits keep their limits where they begin with more than that allows, and refuse then.
fn check_refits<const D: usize>(mesh: &Mesh<D>, n_points: usize, n_threads: u32) {
    let options =
        FitOptions { control_points: [10; 3], max_error: 1e-4, tolerance: 0.1, n_threads, ..FitOptions::default() };
    let refined = fit_counted(mesh, n_points, &options).0.unwrap();
    assert!(refined.is_refined());
    let mut served = [0; 2];
    // From what holds the cloud on.
    for limit in (0..11).map(|i| 1_u64 << (19 + i)) {
        for max_error in [0.0, 1e-4] {
            let options = FitOptions { max_error, memory_limit: limit, ..options.clone() };
            let (end, taken) = counted(mesh, n_points, |cloud| refined.refit(cloud, &options, &mut Progress::silent()));
            match end {
                Ok(_) => assert!(taken <= limit, "{n_points} points: {taken} bytes of {limit}"),
                Err(Error::OutOfMemory { limit: Some(of), bytes, .. }) => {
                    assert!(of == limit.into() && bytes > of && taken < limit + (1 << 16), "{bytes} of {of}, {taken}");
                }
                Err(error) => panic!("{error}"),
            }
            served[usize::from(taken > limit / 2)] += 1;
        }
    }
    assert!(served[0] > 0 && served[1] > 0, "{served:?}");
}

// One test: allocations of another at the same time would count too.
#[test]
fn a_fit_stays_within_its_limit_with_a_multigrid_and_without_and_refining() {
    let ring = torus(1.0, 0.4, 60, 30).unwrap();
    // Cells a third as long along z as along the others, and more points than control points; then far fewer.
    check(&ring, 6000, [20, 20, 20]);
    check(&ring, 500, [17, 17, 16]);
    check(&ring, 1000, [40, 40, 5]);
    check(&circle([0.0; 2], 1.0, 200).unwrap(), 300, [66, 63, 0]);
    check(&circle([0.0; 2], 1.0, 200).unwrap(), 5000, [66, 63, 0]);
    check_refining(&ring, 3000, [16, 40, 100]);
    check_refining(&circle([0.0; 2], 1.0, 200).unwrap(), 1000, [3, 5, 9]);
    for n_threads in [1, 2] {
        check_refits(&ring, 3000, n_threads);
        check_refits(&circle([0.0; 2], 1.0, 200).unwrap(), 1000, n_threads);
    }
}
