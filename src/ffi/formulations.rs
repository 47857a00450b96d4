//! `ko_explicit` and `ko_meshes_separation`: the other formulations, for comparison.

use super::cloud::ko_cloud;
use super::fit_options::{KO_FEASIBLE_OUTSIDE, feasible};
use super::guard::{guard, guard_free};
use super::mesh::{check_count, ko_mesh};
use super::pointer::{
    Sized_, array, check_wanted_sized, create, free, object, object_or_none, place, read_sized_or, wanted, write_sized,
};
use crate::constraint::formulations::brelje::{ByVertices, PairDistance, separation};
use crate::constraint::formulations::{Explicit, ExplicitOptions, Formulation};
use crate::dimension::{OfDimension, in_its_dimension};
use crate::geometry::Mesh;
use crate::{Error, Result};

/// Hicken and Kaur 2022, (1), linear: signed distances d_i to the planes at the points p_i, averaged under weights exp(-rho (Delta_i -
/// Delta_min) / D), Delta_i = |x - p_i|. Differentiable over all points, but at the points themselves, where the gradient jumps by up to
/// 2 rho |phi| / D; over the k nearest value and gradient jump where another point becomes one of them.
pub const KO_EXPLICIT_HICKEN_KAUR_LINEAR: i32 = 0;
/// Hicken and Kaur 2022, (1), quadratic: d_i + (kappa_1 u^2 + kappa_2 v^2) / 2 for d_i, with u and v along the principal directions of
/// curvature at p_i. These are fitted to the normals of the 12 nearest points that face the same way, in the plane 4, by least squares,
/// positive where the solid is convex, and cut to 1 / the distance of the farthest of these. Jumps where the linear form does.
pub const KO_EXPLICIT_HICKEN_KAUR_QUADRATIC: i32 = 1;
/// Lin et al. 2022, a reconstruction, as their formula was not at hand: d_i averaged under weights (Delta_i^2 + e^2)^(-q / 2). Smooth over
/// all points; no distance, but of its sign near the surface. Read comparisons as trends.
pub const KO_EXPLICIT_LIN: i32 = 2;
/// Distance to the plane at the nearest point, after Criado Risco et al. 2023. Value and gradient jump where the nearest point changes; the
/// gradient is that plane's normal. `ko_mesh_signed_distance` has the distance to edges and triangles themselves.
pub const KO_EXPLICIT_NEAREST_PLANE: i32 = 3;
/// Mean distance to the k nearest points, after Bergeles et al. 2015, with the sign of the side of the nearest one's plane. Value and
/// gradient jump where the nearest points change, and where x crosses the surface between points.
pub const KO_EXPLICIT_NEAREST_POINT: i32 = 4;

/// How an explicit formulation is made. Initialise by `ko_explicit_options_init`, then set what shall differ.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_explicit_options {
    /// sizeof(ko_explicit_options), set by ko_explicit_options_init.
    pub struct_size: usize,
    /// rho of (1), in 1 / D, in [1, 1e9]; 0 (default): 8 D / the points' spacing, the mean distance to the fourth nearest, in the plane to the
    /// second. Means nothing but for KO_EXPLICIT_HICKEN_KAUR_.
    pub smoothing: f64,
    /// e of KO_EXPLICIT_LIN, in units of D, in [1e-6, 1]. Default 0.01.
    pub softening: f64,
    /// KO_EXPLICIT_HICKEN_KAUR_LINEAR (default) or another KO_EXPLICIT_.
    pub formulation: i32,
    /// k, at most 64: the nearest points that count. 0 (default): all, and 1 for KO_EXPLICIT_NEAREST_POINT. KO_EXPLICIT_NEAREST_PLANE takes 0
    /// or 1.
    pub n_nearest: u32,
    /// q of KO_EXPLICIT_LIN, in [1, 32]. Default 4.
    pub exponent: u32,
    /// KO_FEASIBLE_OUTSIDE (default) or KO_FEASIBLE_INSIDE: where the value is positive.
    pub feasible: i32,
}

// SAFETY: repr(C), starts with a usize, plain numbers without padding (checked below).
unsafe impl Sized_ for ko_explicit_options {
    const FIRST_SIZE: usize = size_of::<usize>() + 32;
}

const _: () = assert!(size_of::<ko_explicit_options>() == <ko_explicit_options as Sized_>::FIRST_SIZE);

impl ko_explicit_options {
    fn defaults() -> Self {
        let d = ExplicitOptions::default();
        ko_explicit_options {
            struct_size: size_of::<ko_explicit_options>(),
            smoothing: d.smoothing,
            softening: d.softening,
            formulation: KO_EXPLICIT_HICKEN_KAUR_LINEAR,
            n_nearest: d.nearest as u32,
            exponent: d.exponent,
            feasible: KO_FEASIBLE_OUTSIDE,
        }
    }

    /// The options at `pointer`, or the defaults for NULL.
    ///
    /// # Safety
    /// `pointer` is NULL or points to as many bytes as its `struct_size` says.
    unsafe fn read(pointer: *const Self) -> Result<ExplicitOptions> {
        // SAFETY: the caller's promise.
        let given = unsafe { read_sized_or(pointer, Self::defaults(), "options") }?;
        let formulation = match given.formulation {
            KO_EXPLICIT_HICKEN_KAUR_LINEAR => Formulation::HickenKaurLinear,
            KO_EXPLICIT_HICKEN_KAUR_QUADRATIC => Formulation::HickenKaurQuadratic,
            KO_EXPLICIT_LIN => Formulation::Lin,
            KO_EXPLICIT_NEAREST_PLANE => Formulation::NearestPlane,
            KO_EXPLICIT_NEAREST_POINT => Formulation::NearestPoint,
            other => {
                let text = format!("formulation is {other}; it must be a KO_EXPLICIT_ constant, 0 to 4");
                return Err(Error::InvalidArgument(text));
            }
        };
        Ok(ExplicitOptions {
            formulation,
            nearest: given.n_nearest as usize,
            smoothing: given.smoothing,
            exponent: given.exponent,
            softening: given.softening,
            feasible: feasible(given.feasible)?,
        })
    }
}

/// Fills `options` with the defaults. `struct_size` is sizeof *options.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_explicit_options_init(options: *mut ko_explicit_options, struct_size: usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(options, struct_size, ko_explicit_options::defaults(), "options") }
    })
}

/// A formulation that is a formula of the points of a cloud, to compare a field with. Freed by `ko_explicit_free`.
#[allow(non_camel_case_types)]
pub struct ko_explicit(OfDimension<Explicit<2>, Explicit<3>>);

/// Makes an explicit formulation of the points of `cloud`; those of weight 0 take no part, other weights count alike.
///
/// `options` NULL: the defaults, (1) over all points. `*formula` is the caller's to free; it does not refer to the cloud.
/// Errors: KO_ERR_INVALID_ARGUMENT for an option out of its range or D outside [1e-90, 1e90], KO_ERR_DEGENERATE for points that are all
/// equal, KO_ERR_UNSUPPORTED for an option that this library does not know, KO_ERR_OUT_OF_MEMORY.
/// Threads: any. Cost: a copy; where nearest points, a spacing or curvatures are needed some microseconds a point. Memory: 100 bytes a point,
/// with curvatures 170, with nearest points 80 more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_explicit_create(
    cloud: *const ko_cloud,
    options: *const ko_explicit_options,
    formula: *mut *mut ko_explicit,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for a cloud.
            let ko_cloud(cloud) = unsafe { object(cloud, "cloud") }?;
            // SAFETY: the header asks for NULL or initialised options.
            let options = unsafe { ko_explicit_options::read(options) }?;
            Ok(ko_explicit(match cloud {
                OfDimension::Plane(cloud) => OfDimension::Plane(Explicit::new(cloud, &options)?),
                OfDimension::Space(cloud) => OfDimension::Space(Explicit::new(cloud, &options)?),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(formula, "formula", make) }
    })
}

/// Frees an explicit formulation. NULL is taken. No other thread may be using it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_explicit_free(formula: *mut ko_explicit) {
    // SAFETY: the header asks for NULL or a formulation that was not freed.
    guard_free(|| unsafe { free(formula) });
}

/// Tells rho, in 1 / D, 0 where the formula has none. Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_explicit_get_smoothing(formula: *const ko_explicit, smoothing: *mut f64) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a formulation and a place to write.
        let (ko_explicit(explicit), smoothing) =
            unsafe { (object(formula, "formula")?, place(smoothing, "smoothing")?) };
        *smoothing = in_its_dimension!(explicit, explicit => explicit.smoothing());
        Ok(())
    })
}

/// Evaluates the formulation at `points` [dim * n_points]: `values` [n_points] in the caller's unit of length, `gradients` [dim * n_points];
/// each may be NULL.
///
/// Gradients are exact; where the formula jumps or kinks, told at its KO_EXPLICIT_, they are those of one side, at a point of the cloud the
/// mean of opposite sides'. There are no Hessians.
/// Errors: KO_ERR_INVALID_ARGUMENT, naming the first point that is not finite or farther than 1e12 D from the cloud's middle along an axis.
/// Threads: any number at once. Cost: over all N points O(N) a point, a nanosecond or some for each; over the k nearest a search of some
/// microseconds. No allocation, no lock.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_explicit_eval(
    formula: *const ko_explicit,
    points: *const f64,
    n_points: usize,
    values: *mut f64,
    gradients: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a formulation.
        let ko_explicit(explicit) = unsafe { object(formula, "formula") }?;
        in_its_dimension!(explicit, explicit => {
            // SAFETY: the header asks for arrays of these lengths, outputs NULL or used by no one else.
            let (points, values, gradients) = unsafe {
                let points = array(points.cast(), n_points, "points")?;
                (points, wanted(values, n_points, "values")?, wanted(gradients.cast(), n_points, "gradients")?)
            };
            explicit.eval(points, values, gradients)
        })
    })
}

/// How two triangulations lie to each other. Filled by `ko_meshes_separation`.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_separation {
    /// sizeof(ko_separation) as the caller knows it.
    pub struct_size: usize,
    /// Minimum distance of their triangles, or its KS; 0 where they cross, by KS below 0 there.
    pub minimum_distance: f64,
    /// Length of all segments along which their triangles cross; triangles that lie in one plane have none.
    pub intersection_length: f64,
    /// Derivatives of minimum_distance by the translation of mesh_b.
    pub distance_by_translation: [f64; 3],
    /// Derivatives of intersection_length by the translation of mesh_b.
    pub length_by_translation: [f64; 3],
    /// 1: a vertex of mesh_b, one for each part that is connected by vertices, lies inside mesh_a; 0: none does. Parts that do not cross mesh_a
    /// lie inside it whole or not at all.
    pub b_in_a: i32,
    /// The same of mesh_a in mesh_b.
    pub a_in_b: i32,
}

// SAFETY: repr(C), starts with a usize, plain numbers without padding (checked below).
unsafe impl Sized_ for ko_separation {
    const FIRST_SIZE: usize = size_of::<usize>() + 72;
}

const _: () = assert!(size_of::<ko_separation>() == <ko_separation as Sized_>::FIRST_SIZE);

/// Tells how far two triangulations are apart, and how much they cross: the pair of constraints of Brelje et al. 2020, minimum distance > 0
/// and intersection length = 0, with the test that must go with them, of `mesh_b` moved by `translation` [3], NULL for none. The meshes stay.
///
/// `sharpness` 0: the minimum itself; in [1, 1e9]: KS from below, -(D / rho) ln sum exp(-rho d_ij / D) over the pairs of triangles, D the
/// diagonal of mesh_a. `distance_gradients` and `length_gradients` [3 * n_vertices] are the derivatives by the vertices of mesh_b, `n_vertices`
/// of `ko_mesh_get_size`; each may be NULL. `separation` may be NULL; `struct_size` is sizeof *separation.
/// What is differentiable: the minimum is not where another pair, or another feature of it, becomes the nearest; KS is not where another
/// feature of a pair does. Where the meshes cross, the minimum is 0 with gradient 0. The length is continuous but where triangles come to
/// lie in one plane, has kinks where its ends go to other edges, and no bounded gradient where two triangles begin to cross. b_in_a and
/// a_in_b have no derivatives: inside the other mesh nothing tells the way out. There are no Hessians.
/// Errors: KO_ERR_UNSUPPORTED for meshes of the plane; KO_ERR_INVALID_ARGUMENT for a translation that is not finite, a sharpness out of its
/// range, a wrong n_vertices, a diagonal outside [1e-90, 1e90], coordinates beyond 1e90; KO_ERR_OUT_OF_MEMORY.
/// Threads: any number at once. Cost: the first call on a mesh builds its tree, some microseconds a triangle; then about a microsecond for
/// each pair of triangles about as near as the nearest, or crossing, with KS for each pair no farther apart than the least distance and 37 D /
/// sharpness: below some 40 these are all n_a n_b pairs, minutes for meshes of 20,000 triangles, with no way to cancel. A test of sides for
/// each connected part, and some nanoseconds a vertex.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_meshes_separation(
    mesh_a: *const ko_mesh,
    mesh_b: *const ko_mesh,
    translation: *const f64,
    sharpness: f64,
    n_vertices: usize,
    struct_size: usize,
    separation: *mut ko_separation,
    distance_gradients: *mut f64,
    length_gradients: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for meshes.
        let (a, b) = unsafe { (in_space(mesh_a, "mesh_a")?, in_space(mesh_b, "mesh_b")?) };
        // SAFETY: the header asks for NULL or three numbers.
        let by = unsafe { object_or_none(translation.cast(), "translation") }?.copied().unwrap_or([0.0; 3]);
        check_wanted_sized(separation, struct_size, "separation")?;
        // SAFETY: the header asks for NULL or arrays of this length, used by no one else.
        let to = unsafe {
            ByVertices {
                distance: wanted(distance_gradients.cast(), n_vertices, "distance_gradients")?,
                length: wanted(length_gradients.cast(), n_vertices, "length_gradients")?,
            }
        };
        if to.distance.is_some() || to.length.is_some() {
            check_count("n_vertices", n_vertices, b.vertices().len())?;
        }
        let distance = if sharpness == 0.0 { PairDistance::Minimum } else { PairDistance::Ks(sharpness) };
        let found = self::separation(a, b, by, distance, to)?;
        if separation.is_null() {
            return Ok(());
        }
        let filled = ko_separation {
            struct_size,
            minimum_distance: found.minimum_distance,
            intersection_length: found.intersection_length,
            distance_by_translation: found.distance_by_translation,
            length_by_translation: found.length_by_translation,
            b_in_a: i32::from(found.second_in_first),
            a_in_b: i32::from(found.first_in_second),
        };
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(separation, struct_size, filled, "separation") }
    })
}

/// # Safety
/// `mesh` is NULL or a mesh that lives for `'a`.
unsafe fn in_space<'a>(mesh: *const ko_mesh, name: &str) -> Result<&'a Mesh<3>> {
    // SAFETY: the caller's promise.
    match &unsafe { object(mesh, name) }?.0 {
        OfDimension::Space(mesh) => Ok(mesh),
        OfDimension::Plane(_) => {
            Err(Error::Unsupported(format!("{name} is a mesh of the plane; separations are of triangles in space")))
        }
    }
}
