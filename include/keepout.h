/*
 * Keepout: geometric non-interference for gradient-based design.
 * SPDX-License-Identifier: Apache-2.0 OR MIT
 *
 * Status. Calls that can fail return int32_t: KO_OK is 0, errors are negative, positive values are successes with a remark, so test < 0.
 *   ko_last_error() has the message. After an error outputs are as they were (batches: unspecified) and handles too.
 * Handles. A ko_x comes from a call with an output `ko_x **x`, set to NULL first; it goes by ko_x_free, which takes NULL.
 * Arguments. Inputs first, outputs last; arrays are row-major doubles, aligned as C aligns them, and do not overlap outputs. NULL is an
 *   error where something is required, "not wanted" for an output that is said to be optional, fine for an array of no entries.
 * Threads. A `const` handle is not changed: any number of threads may make such calls on it at once. Other calls need the handle alone.
 * Memory. What grows with the input is refused as KO_ERR_OUT_OF_MEMORY when it cannot be had; a small allocation that fails aborts.
 * Structs. Those that begin with struct_size grow at their end in later versions; the size tells which one the caller knows.
 * Lengths are in the caller's unit, errors and weights in units of D, the diagonal of the cloud's bounding box. Equations are those of
 *   Dunn et al., "Scalable enforcement of geometric non-interference constraints for gradient-based optimization" (2023).
 */


#ifndef KEEPOUT_H
#define KEEPOUT_H

/* Generated from src/ffi by cbindgen: change it there. */

#include <stddef.h>
#include <stdint.h>

/**
 * The call did what it says.
 */
#define KO_OK 0

/**
 * A success with a remark: the level set meets the field's box, and its mesh is open there.
 */
#define KO_OPEN_AT_BOX 1

/**
 * A success with a remark: refinement came to the end of its control points, of its memory, or of what the points tell, before the error
 * asked for; a certificate to the end of its boxes before its tolerance.
 */
#define KO_BUDGET_REACHED 2

/**
 * A success with a remark: the mesh bounds no solid, so that a certificate covers what is near it, and no side.
 */
#define KO_SIDE_NOT_CERTIFIED 3

/**
 * An argument is not one that the call takes: NULL where something is needed, a wrong length, a NaN, a value out of range.
 */
#define KO_ERR_INVALID_ARGUMENT -1

/**
 * The call would take more memory than its limit, or than the system gives.
 */
#define KO_ERR_OUT_OF_MEMORY -2

/**
 * The operating system could not read or write a file.
 */
#define KO_ERR_IO -3

/**
 * A file's content is not what its format asks for.
 */
#define KO_ERR_FORMAT -4

/**
 * The request is sound, but this version does not serve it.
 */
#define KO_ERR_UNSUPPORTED -5

/**
 * The geometry gives no such result: all points equal, say.
 */
#define KO_ERR_DEGENERATE -6

/**
 * The solve stopped short of its tolerance.
 */
#define KO_ERR_NOT_CONVERGED -7

/**
 * The caller's progress function asked to stop.
 */
#define KO_ERR_CANCELLED -8

/**
 * A fault of this library. The handles of the call are as they were; please report the message.
 */
#define KO_ERR_INTERNAL -9

/**
 * Version of the ABI that this header describes; it is the number in the soname. It moves when the ABI breaks, and only then.
 */
#define KO_ABI_VERSION 0

/**
 * Bit of `ko_capabilities`: meshes and fields in three dimensions.
 */
#define KO_CAPABILITY_3D 1

/**
 * Bit of `ko_capabilities`: files compressed by gzip are read.
 */
#define KO_CAPABILITY_GZIP 2

/**
 * Bit of `ko_capabilities`: curves and fields in the plane.
 */
#define KO_CAPABILITY_2D 4

/**
 * Bit of a point's flags: it lies at the very place of an earlier point, whose normal it shares.
 */
#define KO_POINT_COPY 1

/**
 * Bit of a point's flags: it is far from its neighbours, for how near those are to theirs.
 */
#define KO_POINT_OUTLIER 2

/**
 * Bit of a point's flags: it lies on a line with its neighbours; no plane could be told, and its normal is one of many.
 */
#define KO_POINT_DEGENERATE 4

/**
 * Bit of a point's flags: its neighbours ask, in sum, for the other sign of its normal.
 */
#define KO_POINT_DOUBTFUL 8

/**
 * phi > 0 on the side that the normals point to: outside a solid. grad phi = +n on the surface.
 */
#define KO_FEASIBLE_OUTSIDE 0

/**
 * phi > 0 on the other side: inside a solid. grad phi = -n on the surface.
 */
#define KO_FEASIBLE_INSIDE 1

/**
 * Points that the surface misses count for more: against the largest error, for clouds to be trusted.
 */
#define KO_REWEIGHT_LARGEST 0

/**
 * Points that disagree with the others count for less, at last for nothing: against noise, outliers and wrong normals. Two solves more,
 * the first of them much smoother.
 */
#define KO_REWEIGHT_ROBUST 1

/**
 * For `ko_field_refit` alone, of the same points, moved: each counts for what it counted for at last in the fit of `start`, D stays, and
 * distances are held in the same cells, as much, to the points that were nearest then. One solve and nothing to measure: the fastest refit,
 * and that of which `ko_sensitivity_solve` gives the derivatives. After moves of cells' lengths refit by the default.
 */
#define KO_REWEIGHT_KEEP 2

/**
 * No aggregate: a value a sample.
 */
#define KO_AGGREGATE_NONE 0

/**
 * KS (Kreisselmeier and Steinhauser 1979): -(D / rho) ln sum exp(-rho phi / D), from below within D ln(n) / rho of the least of n values.
 */
#define KO_AGGREGATE_KS 1

/**
 * Induced exponential (Kennedy and Hicken 2015): the mean under weights exp(-rho phi / D), from above within D W / rho of the least value,
 * W Lambert's function at (n - 1) / e; from below, less D W / rho.
 */
#define KO_AGGREGATE_INDUCED_EXPONENTIAL 2

/**
 * p-norm, p = rho, of the positive u = sqrt(1 + x^2) - x, x = phi / D, taken back by x = (1 / u - u) / 2.
 */
#define KO_AGGREGATE_P_NORM 3

/**
 * The least value, to a rounding in which it may lie above it, with the gradient of the first sample that has it. Not smooth: no Hessian,
 * and a gradient that jumps.
 */
#define KO_AGGREGATE_MINIMUM 4

/**
 * The aggregate is at most the least value: where it is positive, all values are. The safe side.
 */
#define KO_BELOW 0

/**
 * The aggregate is at least the least value.
 */
#define KO_ABOVE 1

/**
 * The least of the values: feasible where all are, the intersection of feasible sets.
 */
#define KO_LEAST 0

/**
 * The largest of the values: feasible where one is, the union of feasible sets. KO_BELOW is below the largest value, the safe side here too.
 */
#define KO_LARGEST 1

/**
 * A frame that is not turned: no parameter.
 */
#define KO_ROTATION_NONE 0

/**
 * A frame turned by a quaternion w, x, y, z of a length in [1e-6, 1e6], in space. It is divided by its length; derivatives are those by its
 * entries as they are. A row that keeps its length near 1 helps optimisers.
 */
#define KO_ROTATION_QUATERNION 1

/**
 * A frame turned by a rotation vector, along the axis and as long as the angle in radians, in space. Near 2 pi another one is better.
 */
#define KO_ROTATION_VECTOR 2

/**
 * A frame turned by an angle in radians, counter-clockwise, in the plane.
 */
#define KO_ROTATION_ANGLE 3

/**
 * A frame that is not scaled: no parameter.
 */
#define KO_SCALE_ONE 0

/**
 * A frame scaled by a parameter in [1e-30, 1e30].
 */
#define KO_SCALE_FREE 1

/**
 * Frame 0 of all constraints: the world, which does not move.
 */
#define KO_WORLD 0

/**
 * Hicken and Kaur 2022, (1), linear: signed distances d_i to the planes at the points p_i, averaged under weights exp(-rho (Delta_i -
 * Delta_min) / D), Delta_i = |x - p_i|. Differentiable over all points, but at the points themselves, where the gradient jumps by up to
 * 2 rho |phi| / D; over the k nearest value and gradient jump where another point becomes one of them.
 */
#define KO_EXPLICIT_HICKEN_KAUR_LINEAR 0

/**
 * Hicken and Kaur 2022, (1), quadratic: d_i + (kappa_1 u^2 + kappa_2 v^2) / 2 for d_i, with u and v along the principal directions of
 * curvature at p_i. These are fitted to the normals of the 12 nearest points that face the same way, in the plane 4, by least squares,
 * positive where the solid is convex, and cut to 1 / the distance of the farthest of these. Jumps where the linear form does.
 */
#define KO_EXPLICIT_HICKEN_KAUR_QUADRATIC 1

/**
 * Lin et al. 2022, a reconstruction, as their formula was not at hand: d_i averaged under weights (Delta_i^2 + e^2)^(-q / 2). Smooth over
 * all points; no distance, but of its sign near the surface. Read comparisons as trends.
 */
#define KO_EXPLICIT_LIN 2

/**
 * Distance to the plane at the nearest point, after Criado Risco et al. 2023. Value and gradient jump where the nearest point changes; the
 * gradient is that plane's normal. `ko_mesh_signed_distance` has the distance to edges and triangles themselves.
 */
#define KO_EXPLICIT_NEAREST_PLANE 3

/**
 * Mean distance to the k nearest points, after Bergeles et al. 2015, with the sign of the side of the nearest one's plane. Value and
 * gradient jump where the nearest points change, and where x crosses the surface between points.
 */
#define KO_EXPLICIT_NEAREST_POINT 4

/**
 * Points of a design that move with it, and how densely they cover its surface. Freed by `ko_body_free`; constraints that were made of it
 * go on.
 */
typedef struct ko_body ko_body;

/**
 * Points of a surface in space (dim 3) or of a curve in the plane (dim 2) with unit normals. Freed by `ko_cloud_free`.
 */
typedef struct ko_cloud ko_cloud;

/**
 * Requirements that samples of a design lie where fields are positive, as values, Jacobian and Hessian over one vector of variables. Freed
 * by `ko_constraints_free`.
 *
 * Variables are the parameters of frames, and the coordinates of points, in the order in which they are added. A pose maps a frame to the
 * world: x_w = s R x + t, its parameters t [dim], those of the rotation, s.
 */
typedef struct ko_constraints ko_constraints;

/**
 * A formulation that is a formula of the points of a cloud, to compare a field with. Freed by `ko_explicit_free`.
 */
typedef struct ko_explicit ko_explicit;

/**
 * A level-set function phi, close to the signed distance to a shape. Freed by `ko_field_free`.
 */
typedef struct ko_field ko_field;

/**
 * A triangulated surface in space (dim 3), or polylines in the plane (dim 2). Freed by `ko_mesh_free`.
 */
typedef struct ko_mesh ko_mesh;

/**
 * How values of a field change as its cloud does: a field and its cloud, ready for any number of `ko_sensitivity_solve`. Freed by
 * `ko_sensitivity_free`.
 */
typedef struct ko_sensitivity ko_sensitivity;

/**
 * What can be said of a mesh. Filled by `ko_mesh_get_report`. In the plane read segment for triangle, end of a segment for edge, length
 * for area, area for volume; entries along z are 0.
 */
typedef struct ko_mesh_report {
    /**
     * sizeof(ko_mesh_report) as the caller knows it.
     */
    size_t struct_size;
    /**
     * Vertices, used by a triangle or not.
     */
    uint64_t n_vertices;
    /**
     * Triangles.
     */
    uint64_t n_triangles;
    /**
     * Parts that are connected through shared edges.
     */
    uint64_t n_components;
    /**
     * Edges with one triangle.
     */
    uint64_t n_boundary_edges;
    /**
     * Edges with more than two triangles.
     */
    uint64_t n_non_manifold_edges;
    /**
     * Vertices whose triangles form more than one fan.
     */
    uint64_t n_non_manifold_vertices;
    /**
     * Triangles without area: a vertex twice, or a height of at most 1e-10 of the longest side.
     */
    uint64_t n_degenerate;
    /**
     * Triangles whose three vertices another triangle before them has too.
     */
    uint64_t n_duplicate;
    /**
     * Vertices that no triangle uses.
     */
    uint64_t n_unreferenced;
    /**
     * 1: no boundary edge.
     */
    int32_t closed;
    /**
     * 1: neighbours run through their shared edge in opposite directions.
     */
    int32_t oriented;
    /**
     * 1: at most two triangles at an edge, one fan at a vertex.
     */
    int32_t manifold;
    /**
     * 1: closed and oriented with normals that point into the solid (volume < 0): `ko_mesh_flip` turns it.
     */
    int32_t inside_out;
    /**
     * Lower corner of the bounding box.
     */
    double bounds_min[3];
    /**
     * Upper corner of the bounding box.
     */
    double bounds_max[3];
    /**
     * Area, in the square of the mesh's unit.
     */
    double area;
    /**
     * Signed volume, in the cube of the mesh's unit; it means something for a closed, oriented mesh.
     */
    double volume;
} ko_mesh_report;

/**
 * Called on the caller's thread with the fraction done in [0, 1], the stage's name (valid during the call) and `progress_data`; not 0
 * cancels. It must not unwind, throw or jump out.
 */
typedef int32_t (*ko_progress)(double fraction, const char *stage, void *data);

/**
 * Options of `ko_cloud_estimate_normals`. Initialise by `ko_normal_options_init`, then set what shall differ.
 */
typedef struct ko_normal_options {
    /**
     * sizeof(ko_normal_options), set by ko_normal_options_init.
     */
    size_t struct_size;
    /**
     * Nearest neighbours that a normal is taken from, in [3, 64]; 0 (the default) for 10 in space and 4 in the plane. More smooth noise,
     * and edges with it.
     */
    uint32_t neighbours;
    /**
     * Threads, at most 1024: 0 (default) for all cores, 1 for none but the caller's. The result does not depend on it.
     */
    uint32_t n_threads;
    /**
     * A point whose mean distance to its neighbours is this many times the median of theirs is an outlier; above 1. Default 2.5.
     */
    double outlier_factor;
    /**
     * Bytes that the call may take; more is refused before any is taken. Default 8 GiB.
     */
    uint64_t memory_limit;
    /**
     * Told of progress, or NULL (default).
     */
    ko_progress progress;
    /**
     * Handed to `progress`.
     */
    void *progress_data;
} ko_normal_options;

/**
 * What an estimate of normals found. Filled by `ko_cloud_estimate_normals`, the `flags` of which tell which points are counted here.
 */
typedef struct ko_normal_report {
    /**
     * sizeof(ko_normal_report) as the caller knows it.
     */
    size_t struct_size;
    /**
     * Parts that neighbours connect; each has a sign of its own.
     */
    uint64_t n_components;
    /**
     * Points at the place of an earlier one: KO_POINT_COPY.
     */
    uint64_t n_copies;
    /**
     * Points far from their neighbours: KO_POINT_OUTLIER.
     */
    uint64_t n_outliers;
    /**
     * Points on a line with their neighbours: KO_POINT_DEGENERATE.
     */
    uint64_t n_degenerate;
    /**
     * Points whose neighbours ask for the other sign: KO_POINT_DOUBTFUL.
     */
    uint64_t n_doubtful;
    /**
     * Of what all pairs of neighbours ask for, by weight, the fraction that the signs meet: 1 is all. Below 0.9, look at the result.
     */
    double agreement;
    /**
     * Seconds of the call.
     */
    double seconds;
} ko_normal_report;

/**
 * Options of `ko_cloud_smooth`. Initialise by `ko_smooth_options_init`, then set what shall differ.
 */
typedef struct ko_smooth_options {
    /**
     * sizeof(ko_smooth_options), set by ko_smooth_options_init.
     */
    size_t struct_size;
    /**
     * Nearest points that a point is smoothed by, itself among them, in [4, 128]; 0 (the default) for 40 in space and 12 in the plane.
     * More smooth more.
     */
    uint32_t neighbours;
    /**
     * Times that the whole cloud is smoothed, in [1, 100]. Default 1.
     */
    uint32_t rounds;
    /**
     * Threads, at most 1024: 0 (default) for all cores, 1 for none but the caller's. The result does not depend on it.
     */
    uint32_t n_threads;
    /**
     * Must be 0.
     */
    uint32_t reserved;
    /**
     * Told of progress, or NULL (default).
     */
    ko_progress progress;
    /**
     * Handed to `progress`.
     */
    void *progress_data;
} ko_smooth_options;

/**
 * Options of `ko_field_fit` and `ko_field_refit`. Initialise by `ko_fit_options_init`, then set what shall differ. Weights have no unit:
 * lengths are taken in units of D, the diagonal of the cloud's bounding box.
 */
typedef struct ko_fit_options {
    /**
     * sizeof(ko_fit_options), set by ko_fit_options_init.
     */
    size_t struct_size;
    /**
     * Control points along x, y, z: at least 4 each, honoured exactly; 0 (the default) lets the fit choose: near-cubic cells, about
     * twice as many control points as points, between 4096 and 262144. In the plane z is ignored, and N points get N^2 / 100, between
     * 1024 and 65536.
     */
    uint32_t control_points[3];
    /**
     * Rounds in which points are weighted anew, as `reweighting` says; at most 100. 0: none, the paper's fit; a robust fit weighs them
     * once all the same. With `max_error` cells are cut instead, and only points reweighted that are missed where no more can be cut.
     * Default 3.
     */
    uint32_t reweightings;
    /**
     * How much longer than the cloud the box is along each axis, in [0, 100]. Default 0.15: 1.15 times the extents.
     */
    double margin;
    /**
     * lambda_n of (10): weight of the normals, in [1e-12, 1e12]. Default 1e-4.
     */
    double lambda_normal;
    /**
     * lambda_r of (10): weight of the smoothness, in [1e-20, 1e12]. Default 3e-10.
     */
    double lambda_smooth;
    /**
     * Weight of the distance energy (9), kept to cells away from the surface, in units of lambda_smooth / h^4, h the longest cell edge in
     * units of D. It keeps the sign right far from the data. In [0, 1e6]; 0: none, the paper's fit. Default 150.
     */
    double distance_weight;
    /**
     * Relative residual of the solve to reach, in [1e-15, 0.5]. Default 1e-4.
     */
    double tolerance;
    /**
     * KO_FEASIBLE_OUTSIDE (default) or KO_FEASIBLE_INSIDE: where phi > 0.
     */
    int32_t feasible;
    /**
     * Iterations in all after which not having reached the tolerance is KO_ERR_NOT_CONVERGED; at least 1. Default 20000.
     */
    uint32_t max_iterations;
    /**
     * Bytes that the fit may take; a larger one is refused before any is taken. Default 8 GiB.
     */
    uint64_t memory_limit;
    /**
     * Threads, at most 1024: 0 (default) for all cores, 1 for none but the caller's. The result does not depend on it.
     */
    uint32_t n_threads;
    /**
     * Must be 0.
     */
    uint32_t reserved;
    /**
     * Told of progress, or NULL (default).
     */
    ko_progress progress;
    /**
     * Handed to `progress`.
     */
    void *progress_data;
    /**
     * What the rounds of reweighting are for: KO_REWEIGHT_LARGEST (default) or KO_REWEIGHT_ROBUST; or KO_REWEIGHT_KEEP, for none.
     */
    int32_t reweighting;
    /**
     * Must be 0.
     */
    uint32_t reserved_2;
    /**
     * Largest error on the surface that is wanted, as a fraction of D, in [1e-9, 1]: cells are halved, again and again, where |phi| at the
     * cloud's points is larger, and where parts are thin. The grid is then coarse where no `control_points` are asked for, lambda_normal
     * and lambda_smooth are those of its cells, and fall by 4 and 5 with each halving. Not with KO_REWEIGHT_ROBUST or KO_REWEIGHT_KEEP. 0
     * (default): one grid.
     */
    double max_error;
    /**
     * Control points that refinement may take, at least 1; a fit that needs more, or more than `memory_limit`, ends with
     * KO_BUDGET_REACHED. The grid that it begins with has no more either, but four along each axis, or the `control_points` asked for.
     * Default 2000000. Without `max_error` it means nothing.
     */
    uint64_t max_unknowns;
} ko_fit_options;

/**
 * What a field is and what its fit did. Filled by `ko_field_get_report`. Errors are fractions of D.
 */
typedef struct ko_fit_report {
    /**
     * sizeof(ko_fit_report) as the caller knows it.
     */
    size_t struct_size;
    /**
     * 2 in the plane, where entries along z are 0; 3 in space.
     */
    uint32_t dim;
    /**
     * KO_FEASIBLE_OUTSIDE or KO_FEASIBLE_INSIDE.
     */
    int32_t feasible;
    /**
     * Control points along x, y, z; an axis of n has n - 3 cells. Of a refined field those of the longest cells.
     */
    uint32_t control_points[3];
    /**
     * Iterations of the solve, all rounds together.
     */
    uint32_t iterations;
    /**
     * Unknowns of the solve: control points in all.
     */
    uint64_t n_unknowns;
    /**
     * Points of the cloud.
     */
    uint64_t n_points;
    /**
     * Bytes that the field holds for evaluation. A field that was fitted, not loaded, remembers besides up to 24 bytes a point and 16 a cell.
     */
    uint64_t bytes;
    /**
     * Lower corner of the box.
     */
    double box_min[3];
    /**
     * Upper corner of the box.
     */
    double box_max[3];
    /**
     * D: diagonal of the cloud's bounding box.
     */
    double diagonal;
    /**
     * Relative residual reached.
     */
    double residual;
    /**
     * Seconds to bring the points in order and to measure the far distances; of refined fits, those to bring functions in order too, and
     * all of it on the cells of each round.
     */
    double seconds_assembly;
    /**
     * Seconds of the solves, with right-hand sides, preconditioners, and what looks at their outcome between them.
     */
    double seconds_solve;
    /**
     * Seconds to measure the errors.
     */
    double seconds_check;
    /**
     * Root mean square of phi at the points of the cloud.
     */
    double rms;
    /**
     * Largest |phi| at the points of the cloud.
     */
    double max;
    /**
     * Mean of |grad phi| at the points of the cloud: 1 for a distance.
     */
    double mean_gradient;
    /**
     * Points that a robust fit (KO_REWEIGHT_ROBUST) left out at last.
     */
    uint64_t n_outliers;
    /**
     * Of the cells farther than one from the points (refined: than half of one of theirs, and than their spacing), the part on whose
     * side there is little doubt: 1 for closed shapes. Less for open ones: beyond their rim and far from them the sign of phi is one of
     * many; `ko_cloud_sides` tells where. Not a number where distance_weight was 0, and for a field that was loaded or made.
     */
    double clear_sides;
    /**
     * Mean factor by which an iteration of the last round lowered the residual: 0.1 gains a digit each. Not a number for a field that
     * was loaded or made.
     */
    double convergence_rate;
    /**
     * Levels of cells, those of each half as long as those of the one before: 1 where nothing was refined.
     */
    uint64_t n_levels;
} ko_fit_report;

/**
 * Options of `ko_field_level_set`. Initialise by `ko_level_set_options_init`, then set what shall differ.
 */
typedef struct ko_level_set_options {
    /**
     * sizeof(ko_level_set_options), set by ko_level_set_options_init.
     */
    size_t struct_size;
    /**
     * Lattice edges per cell of the field, along each axis, in [1, 1024]. What is thinner than a lattice edge may be missed, or joined:
     * this decides the topology, and most of the cost. Default 4.
     */
    uint32_t subdivisions;
    /**
     * Threads, at most 1024: 0 (default) for all cores, 1 for none but the caller's. The result does not depend on it.
     */
    uint32_t n_threads;
    /**
     * Edges of the result shorter than this fraction of the field's shortest cell edge are collapsed, where that changes neither topology
     * nor side and bends nothing far from the level set; in [0, 1], 0 keeps them all. It decides the size of the result. Default 0.3.
     */
    double shortest_edge;
    /**
     * Rounds in which vertices move along the level set towards the middle of their neighbours; at most 1000. Default 6.
     */
    uint32_t relaxations;
    /**
     * Must be 0.
     */
    uint32_t reserved;
    /**
     * Bytes that the call may take; more is refused before it is taken. Default 8 GiB.
     */
    uint64_t memory_limit;
    /**
     * Told of progress, or NULL (default).
     */
    ko_progress progress;
    /**
     * Handed to `progress`.
     */
    void *progress_data;
} ko_level_set_options;

/**
 * Options of `ko_field_certify`. Initialise by `ko_certify_options_init`, then set what shall differ.
 */
typedef struct ko_certify_options {
    /**
     * sizeof(ko_certify_options), set by ko_certify_options_init.
     */
    size_t struct_size;
    /**
     * How far bounds may be above the largest value that is found, as a fraction of it, or of 1e-3 D where it is less; in [1e-4, 1e4].
     * Default 0.05.
     */
    double tolerance;
    /**
     * Bounds that each of four searches may take of boxes that it splits off, at least 1: one a box, and one for each cell that a piece of
     * the shape meets. Where more are needed the search's result is sound but looser, and the call ends with KO_BUDGET_REACHED. Beside the
     * first look at every cell and triangle it bounds time, a few microseconds a bound, and memory, some 150 bytes a bound. Default 4000000.
     */
    uint64_t max_boxes;
    /**
     * Threads, at most 1024: 0 (default) for all cores, 1 for none but the caller's. The result does not depend on it.
     */
    uint32_t n_threads;
    /**
     * Must be 0.
     */
    uint32_t reserved;
    /**
     * Told of progress, or NULL (default).
     */
    ko_progress progress;
    /**
     * Handed to `progress`.
     */
    void *progress_data;
} ko_certify_options;

/**
 * What was certified of a field. Filled by `ko_field_certify`. Lengths are in the mesh's unit.
 */
typedef struct ko_certificate {
    /**
     * sizeof(ko_certificate) as the caller knows it.
     */
    size_t struct_size;
    /**
     * t: larger than phi, as `ko_field_eval` gives it, at every point that is on the infeasible side or within the clearance and the
     * covering radius together of the shape; in the box and beyond it.
     */
    double threshold;
    /**
     * The largest phi that was found at such points: `threshold` over it tells how tight the threshold is at least.
     */
    double largest_found;
    /**
     * Where that was; z is 0 in the plane. A finer field there, or a field that fits better, lowers the threshold.
     */
    double place[3];
    /**
     * eps: at least |phi| at every point of the shape. Infinite where a budget ended before triangles longer than two cells were cut up.
     */
    double surface_error;
    /**
     * G: at least the length of grad phi at every point of the box.
     */
    double steepest;
    /**
     * At least the length of grad phi at every point beyond the box, often by a fifth too large or more; infinite where the box's faces are
     * of both sides.
     */
    double steepest_beyond;
    /**
     * Boxes that were looked at.
     */
    uint64_t n_boxes;
    /**
     * Components of the shape, as `ko_mesh_get_component_count` tells.
     */
    uint64_t n_components;
    /**
     * 1: the mesh bounds a solid, so that the infeasible side has its part in `threshold`. 0: KO_SIDE_NOT_CERTIFIED.
     */
    int32_t side_certified;
    /**
     * 1: a search ended before its tolerance was reached; that for `steepest_beyond` does not count.
     */
    int32_t budget_reached;
} ko_certificate;

/**
 * How values of samples become one. Initialise by `ko_aggregation_init`, then set what shall differ.
 */
typedef struct ko_aggregation {
    /**
     * sizeof(ko_aggregation), set by ko_aggregation_init.
     */
    size_t struct_size;
    /**
     * rho, without unit, in [1, 1e9]: the larger, the nearer to the least value, and the more curved. Default 500: KS is then within 1.9 %
     * of D of the least of 10,000 values, and mostly much nearer. Means nothing with KO_AGGREGATE_NONE and KO_AGGREGATE_MINIMUM.
     */
    double sharpness;
    /**
     * KO_AGGREGATE_KS (default) or another KO_AGGREGATE_.
     */
    int32_t kind;
    /**
     * KO_BELOW (default) or KO_ABOVE: the side of the least value on which the aggregate lies for certain, but for rounding.
     */
    int32_t side;
} ko_aggregation;

/**
 * How an explicit formulation is made. Initialise by `ko_explicit_options_init`, then set what shall differ.
 */
typedef struct ko_explicit_options {
    /**
     * sizeof(ko_explicit_options), set by ko_explicit_options_init.
     */
    size_t struct_size;
    /**
     * rho of (1), in 1 / D, in [1, 1e9]; 0 (default): 8 D / the points' spacing, the mean distance to the fourth nearest, in the plane to the
     * second. Means nothing but for KO_EXPLICIT_HICKEN_KAUR_.
     */
    double smoothing;
    /**
     * e of KO_EXPLICIT_LIN, in units of D, in [1e-6, 1]. Default 0.01.
     */
    double softening;
    /**
     * KO_EXPLICIT_HICKEN_KAUR_LINEAR (default) or another KO_EXPLICIT_.
     */
    int32_t formulation;
    /**
     * k, at most 64: the nearest points that count. 0 (default): all, and 1 for KO_EXPLICIT_NEAREST_POINT. KO_EXPLICIT_NEAREST_PLANE takes 0
     * or 1.
     */
    uint32_t n_nearest;
    /**
     * q of KO_EXPLICIT_LIN, in [1, 32]. Default 4.
     */
    uint32_t exponent;
    /**
     * KO_FEASIBLE_OUTSIDE (default) or KO_FEASIBLE_INSIDE: where the value is positive.
     */
    int32_t feasible;
} ko_explicit_options;

/**
 * How two triangulations lie to each other. Filled by `ko_meshes_separation`.
 */
typedef struct ko_separation {
    /**
     * sizeof(ko_separation) as the caller knows it.
     */
    size_t struct_size;
    /**
     * Minimum distance of their triangles, or its KS; 0 where they cross, by KS below 0 there.
     */
    double minimum_distance;
    /**
     * Length of all segments along which their triangles cross; triangles that lie in one plane have none.
     */
    double intersection_length;
    /**
     * Derivatives of minimum_distance by the translation of mesh_b.
     */
    double distance_by_translation[3];
    /**
     * Derivatives of intersection_length by the translation of mesh_b.
     */
    double length_by_translation[3];
    /**
     * 1: a vertex of mesh_b, one for each part that is connected by vertices, lies inside mesh_a; 0: none does. Parts that do not cross mesh_a
     * lie inside it whole or not at all.
     */
    int32_t b_in_a;
    /**
     * The same of mesh_a in mesh_b.
     */
    int32_t a_in_b;
} ko_separation;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Message of the last call that failed on this thread: what was wrong, where, and what would be right.
 *
 * Never NULL; "" when no call failed yet. Owned by the library; valid until the next failing call on this thread. A call that succeeds
 * leaves it as it is. Threads: each has its own. Cost: none.
 */
const char *ko_last_error(void);

/**
 * Name of a status code, "KO_OK" for 0, say; "unknown status" for a number that is none. Never NULL; static. Any thread.
 */
const char *ko_status_string(int32_t status);

/**
 * Version of the library as "major.minor.patch". Never NULL; static. Any thread.
 */
const char *ko_version(void);

/**
 * Version of the ABI of the library that is loaded: compare with `KO_ABI_VERSION`, that of the header. Any thread.
 */
uint32_t ko_abi_version(void);

/**
 * What this build can do, as an or of `KO_CAPABILITY_` bits. Any thread.
 */
uint64_t ko_capabilities(void);

/**
 * Reads a mesh from `path`: OBJ, STL (binary, ASCII), PLY (binary, ASCII) or OFF, each also compressed by gzip.
 *
 * The format is told by the content where it has a mark, else by the name's ending. Polygons are cut into fans of triangles; the equal
 * vertices of an STL are merged. `path` is UTF-8 on Windows, bytes elsewhere. `*mesh` is the caller's to free.
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL or an empty path, KO_ERR_IO, KO_ERR_FORMAT with line or byte, KO_ERR_UNSUPPORTED for other
 * formats, KO_ERR_OUT_OF_MEMORY, also for more than 4 GiB after unpacking. Threads: any. Cost: one pass over the file.
 */
int32_t ko_mesh_read(const char *path,
                     struct ko_mesh **mesh);

/**
 * Writes the mesh to the file `path`, in the format that its ending names: .obj, .off, .ply or .stl, in small letters or capitals.
 *
 * OBJ, OFF and PLY (binary) hold every bit of the coordinates; STL (binary) rounds them to `float`, and vertices that become one are one
 * when it is read. A mesh of the plane is written as OBJ: lines, z = 0. A file that stood there is replaced whole or, after an error, left
 * as it was. `path` is UTF-8 on Windows, bytes elsewhere.
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL, an empty path, or a coordinate that an STL cannot hold; KO_ERR_UNSUPPORTED for other endings;
 * KO_ERR_IO. Threads: any. Cost: one pass.
 */
int32_t ko_mesh_write(const struct ko_mesh *mesh,
                      const char *path);

/**
 * Makes a mesh from `vertices` [3 * n_vertices] and `triangles` [3 * n_triangles], indices from 0, counter-clockwise seen from outside.
 *
 * The arrays are copied. `*mesh` is the caller's to free.
 * Errors: KO_ERR_INVALID_ARGUMENT for no triangle, a coordinate that is not finite, an index out of range; KO_ERR_OUT_OF_MEMORY.
 * Threads: any. Cost: O(n_vertices + n_triangles).
 */
int32_t ko_mesh_from_triangles(const double *vertices,
                               size_t n_vertices,
                               const uint32_t *triangles,
                               size_t n_triangles,
                               struct ko_mesh **mesh);

/**
 * Makes a mesh of the plane from polylines: `points` [2 * n_points], of which polyline i begins at `loop_starts`[i] [n_loops].
 *
 * `loop_starts` begins with 0 and ascends. `closed` 1: each polyline goes back to its first point, which may be given again as its last;
 * 0: none does. A solid lies on the left of closed polylines: counter-clockwise around it, clockwise around a hole in it. A point that
 * repeats the one before it is dropped. The arrays are copied. `*mesh` is the caller's to free.
 * Errors: KO_ERR_INVALID_ARGUMENT for a point that is not finite, starts that do not ascend, fewer than 2 points, closed 3; for polylines
 * that cross, touch or overlap themselves or each other, with the segments and the place; for loops right inside one another that run the
 * same way, naming the one to turn around; KO_ERR_OUT_OF_MEMORY. Threads: any.
 * Cost: O(n_points log n_points) where segments are short.
 */
int32_t ko_mesh_from_polylines(const double *points,
                               size_t n_points,
                               const size_t *loop_starts,
                               size_t n_loops,
                               int32_t closed,
                               struct ko_mesh **mesh);

/**
 * Frees a mesh. NULL is taken. No other thread may be using it.
 */
void ko_mesh_free(struct ko_mesh *mesh);

/**
 * Tells the dimension of the mesh: 3 for triangles in space, 2 for segments in the plane.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
 */
int32_t ko_mesh_get_dim(const struct ko_mesh *mesh, uint32_t *dim);

/**
 * Tells how many vertices and triangles, in the plane segments, the mesh has. Either output may be NULL.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for no mesh. Threads: any. Cost: none.
 */
int32_t ko_mesh_get_size(const struct ko_mesh *mesh, size_t *n_vertices, size_t *n_triangles);

/**
 * Copies the mesh to `vertices` [dim * n_vertices] and `triangles` [dim * n_triangles], in the plane the segments; either may be NULL.
 *
 * The counts must be those of `ko_mesh_get_size`. Errors: KO_ERR_INVALID_ARGUMENT, also for other counts. Threads: any. Cost: a copy.
 */
int32_t ko_mesh_copy(const struct ko_mesh *mesh,
                     size_t n_vertices,
                     size_t n_triangles,
                     double *vertices,
                     uint32_t *triangles);

/**
 * Tells how many points and polylines `ko_mesh_copy_polylines` gives of a mesh of the plane. Either output may be NULL.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for no mesh and for one of space; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: O(n_vertices), with some 30
 * bytes a vertex taken meanwhile.
 */
int32_t ko_mesh_get_polylines_size(const struct ko_mesh *mesh,
                                   size_t *n_points,
                                   size_t *n_loops);

/**
 * Copies the curves that the segments of a mesh of the plane make, as `ko_mesh_from_polylines` takes them: `points` [2 * n_points], of
 * which polyline i begins at `loop_starts`[i] [n_loops] and is closed where `closed`[i] [n_loops] is 1, else 0. Each may be NULL.
 *
 * Open polylines come first, then closed ones, which do not repeat their first point; each kind in the order of the mesh's vertices. A
 * solid lies on the left. The counts must be those of `ko_mesh_get_polylines_size`.
 * Errors: KO_ERR_INVALID_ARGUMENT, also for a mesh of space and for other counts; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: that of
 * `ko_mesh_get_polylines_size`, and a copy.
 */
int32_t ko_mesh_copy_polylines(const struct ko_mesh *mesh,
                               size_t n_points,
                               size_t n_loops,
                               double *points,
                               size_t *loop_starts,
                               uint8_t *closed);

/**
 * Fills `report` with what can be said of the mesh: closed, oriented, manifold, components, flaws, extents. See `ko_mesh_report`.
 *
 * `struct_size` is sizeof *report. Errors: KO_ERR_INVALID_ARGUMENT, KO_ERR_OUT_OF_MEMORY. Threads: any.
 * Cost: O(n_triangles log n_triangles), with some 100 bytes a triangle taken meanwhile.
 */
int32_t ko_mesh_get_report(const struct ko_mesh *mesh,
                           size_t struct_size,
                           struct ko_mesh_report *report);

/**
 * Turns every triangle, in the plane every segment, over, so that an inside-out solid becomes a solid.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL. No other thread may be using the mesh. Cost: O(n_triangles).
 */
int32_t ko_mesh_flip(struct ko_mesh *mesh);

/**
 * Samples `n_points` points of the surface with normals, spread evenly by area (blue noise: Yuksel 2015), into a cloud; of curves in the
 * plane evenly by length.
 *
 * Normals are smooth across edges, in the plane corners, of less than 40 degrees and sharp across others. The cloud remembers triangle and
 * barycentric coordinates of each point: `ko_cloud_copy_origins`. The same mesh, count and seed give the same bits. `*cloud` is the
 * caller's to free.
 * Errors: KO_ERR_INVALID_ARGUMENT for no points or more than 2^30 - 1, KO_ERR_DEGENERATE for a mesh without area, KO_ERR_OUT_OF_MEMORY.
 * Threads: any. Cost: O(n_points log n_points + n_triangles).
 */
int32_t ko_mesh_sample(const struct ko_mesh *mesh,
                       size_t n_points,
                       uint64_t seed,
                       struct ko_cloud **cloud);

/**
 * Exact signed distances of `points` [dim * n_points] to the mesh, into `distances` [n_points]: positive outside, in the mesh's unit.
 *
 * The side is that of the generalised winding number W (Jacobson et al. 2013), inside from 1/2 on. By this rule an open mesh has an inside
 * only where it takes up half of what is seen from there: a bowl has one, a flat sheet has none, and its distances are positive behind it
 * too. The two sides of a sheet are told by `ko_cloud_sides`, of a sample of the mesh, and by the sign of a field fitted to one.
 * Errors: KO_ERR_INVALID_ARGUMENT, naming the first point that is not finite; KO_ERR_OUT_OF_MEMORY for the tree.
 * Threads: any number at once. Cost: O(log n_triangles) a point, and where W is so near to 1/2 that sums over far triangles do not tell the
 * side, as close behind a flat sheet, some tens of nanoseconds more for each edge of the mesh's rim, or for each triangle among hundreds of
 * nested shells; the first call on a mesh builds its tree, O(n_triangles log n_triangles).
 */
int32_t ko_mesh_signed_distance(const struct ko_mesh *mesh,
                                const double *points,
                                size_t n_points,
                                double *distances);

/**
 * Tells how many components the mesh has: parts that hang together by vertices that triangles share, in the plane segments.
 *
 * There may be fewer than `n_components` of `ko_mesh_get_report`, which a vertex alone does not connect. Errors: KO_ERR_INVALID_ARGUMENT
 * for NULL, KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: a pass over the triangles.
 */
int32_t ko_mesh_get_component_count(const struct ko_mesh *mesh,
                                    size_t *n_components);

/**
 * Copies a vertex of each component of the mesh to `points` [dim * n_components]: what a body that swallows the component holds.
 *
 * `n_components` must be that of `ko_mesh_get_component_count`, or of a certificate. Errors: KO_ERR_INVALID_ARGUMENT, also for another
 * count; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: a pass over the triangles.
 */
int32_t ko_mesh_copy_component_points(const struct ko_mesh *mesh,
                                      size_t n_components,
                                      double *points);

/**
 * Makes a cloud from `points` [dim * n_points] with `normals` [dim * n_points] out of the solid, of any length but 0.
 *
 * `dim` is 2 or 3. NULL normals are estimated, on all cores, by `ko_cloud_estimate_normals` with its default options, where the errors and
 * the cost of that are told. The arrays are copied. `*cloud` is the caller's to free.
 * Errors: KO_ERR_INVALID_ARGUMENT for no points or more than 2^30, for a point or normal that is not finite and for a normal of length 0,
 * naming the first; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: O(n_points).
 */
int32_t ko_cloud_from_points(uint32_t dim,
                             const double *points,
                             const double *normals,
                             size_t n_points,
                             struct ko_cloud **cloud);

/**
 * Frees a cloud. NULL is taken. No other thread may be using it.
 */
void ko_cloud_free(struct ko_cloud *cloud);

/**
 * Tells the dimension of the cloud, 2 or 3. Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
 */
int32_t ko_cloud_get_dim(const struct ko_cloud *cloud, uint32_t *dim);

/**
 * Tells how many points the cloud has. Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
 */
int32_t ko_cloud_get_size(const struct ko_cloud *cloud, size_t *n_points);

/**
 * Copies the cloud to `points` [dim * n_points] and `normals` [dim * n_points], of length 1; either may be NULL.
 *
 * `n_points` must be that of `ko_cloud_get_size`. Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: a copy.
 */
int32_t ko_cloud_copy(const struct ko_cloud *cloud, size_t n_points, double *points, double *normals);

/**
 * Gives each point a weight, `weights` [n_points]: how much a fit trusts it, compared with the others. All count alike without.
 *
 * A point of weight 0 takes no part in a fit, as if it were not there. `n_points` must be that of `ko_cloud_get_size`. The array is
 * copied.
 * Errors: KO_ERR_INVALID_ARGUMENT for a weight that is negative, not a number or above 1e100, naming the first, and where all are 0;
 * KO_ERR_OUT_OF_MEMORY. After an error the weights are as they were. No other thread may be using the cloud. Cost: a copy.
 */
int32_t ko_cloud_set_weights(struct ko_cloud *cloud,
                             const double *weights,
                             size_t n_points);

/**
 * Tells on which side of the cloud each of `points` [dim * n_points] lies, into `sides` [n_points]: 1 where the normals clearly point to,
 * -1 clearly behind them, between where an open shape has no clear side: around its rim and far from it.
 *
 * 2 (W_s - W), with W the generalised winding number of the cloud (Barill et al. 2018), to about 0.1, and W_s its mean of both sides of
 * the surface nearby. Where it is small, so is the meaning of a field's sign.
 * Errors: KO_ERR_INVALID_ARGUMENT, naming the first point that is not finite; KO_ERR_OUT_OF_MEMORY. Threads: any number at once.
 * Cost: O(N log N) with about 500 bytes for each of the cloud's N points, and then some 10 microseconds a point: ask for many at once.
 */
int32_t ko_cloud_sides(const struct ko_cloud *cloud,
                       const double *points,
                       size_t n_points,
                       double *sides);

/**
 * Copies where on its mesh each point was taken: index of the triangle, in the plane the segment, into
 * `triangles` [n_points], coordinates into `barycentric` [dim * n_points].
 *
 * Either may be NULL. `n_points` must be that of `ko_cloud_get_size`. Errors: KO_ERR_INVALID_ARGUMENT, also for a cloud that was not
 * sampled from a mesh. Threads: any. Cost: a copy.
 */
int32_t ko_cloud_copy_origins(const struct ko_cloud *cloud,
                              size_t n_points,
                              uint32_t *triangles,
                              double *barycentric);

/**
 * Makes the cloud of the same places, triangles and barycentric coordinates, on `mesh`: the one that `cloud` was sampled from, with its
 * vertices moved.
 *
 * Points and normals are made as `ko_mesh_sample` makes them; weights stay. On a mesh whose vertices did not move `*moved` is `cloud`. It is
 * the caller's to free. With `ko_field_refit` it makes the field follow a shape of parameters, with `ko_cloud_pull_back` derivatives by
 * them.
 * Errors: KO_ERR_INVALID_ARGUMENT for a cloud that was not sampled from a mesh, for a mesh of another dimension and for one that lacks a
 * triangle of the cloud's; KO_ERR_DEGENERATE for a triangle with a point that has lost its area; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost:
 * O(n_points + n_triangles).
 */
int32_t ko_cloud_follow(const struct ko_cloud *cloud,
                        const struct ko_mesh *mesh,
                        struct ko_cloud **moved);

/**
 * Takes derivatives of some J by the points and normals of `cloud`, `d_points` [dim * n_points] and `d_normals` [dim * n_points], those of
 * `ko_sensitivity_solve` say, back to derivatives by the vertices of `mesh`: `d_vertices` [dim * n_vertices].
 *
 * The transpose of the derivative of `ko_cloud_follow`: of points as sums of corners with barycentric coordinates, of normals through the
 * corners' normals, the angles, in the plane the inverse lengths, that triangles weigh in these, and the triangles' own normals. Triangles,
 * barycentric coordinates and which edges are sharp are held. `cloud` is the one that was sampled from `mesh`, or that followed it. NULL
 * for `d_points` or `d_normals` stands for zeros. What `d_vertices` held before is lost; vertices without a triangle get 0.
 * Errors: KO_ERR_INVALID_ARGUMENT for a cloud that was not sampled from a mesh, a mesh of another dimension, one that lacks a triangle of
 * the cloud's, and for other counts than those of `ko_cloud_get_size` and `ko_mesh_get_size`; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost:
 * O(n_points + n_triangles); with `d_normals` some 300 bytes a triangle meanwhile.
 */
int32_t ko_cloud_pull_back(const struct ko_cloud *cloud,
                           const struct ko_mesh *mesh,
                           const double *d_points,
                           const double *d_normals,
                           size_t n_points,
                           size_t n_vertices,
                           double *d_vertices);

/**
 * Fills `options` with the defaults. `struct_size` is sizeof *options.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
 */
int32_t ko_normal_options_init(struct ko_normal_options *options, size_t struct_size);

/**
 * Makes a cloud from `points` [dim * n_points] that come without normals: a plane through each point's neighbours (Hoppe et al. 1992), and
 * signs that agree, the most sure ones first.
 *
 * `dim` is 2 or 3. `options` NULL: the defaults. All points stay, in their order. Closed parts face outward; a part inside an odd number
 * of others is the boundary of a cavity and faces into it; open parts face the side they bulge to, flat ones that of their largest
 * coordinate. Sides of a sheet nearer to each other than the points of one side are not told apart.
 * `*cloud` is the caller's to free. `flags` [n_points] gets an or of KO_POINT_ bits for each point, 0 for most, and `report`, of
 * `report_size` bytes (sizeof *report), what was found; either may be NULL. To leave points out of fits, give them weight 0 by
 * `ko_cloud_set_weights`. The array is copied. The same points give the same bits.
 * Errors: KO_ERR_INVALID_ARGUMENT for fewer than dim + 1 points or more than 2^30 / dim, for one that is not finite, naming the first, and
 * for an option out of its range; KO_ERR_DEGENERATE for points at fewer than dim + 1 places and for points of space all on a line;
 * KO_ERR_UNSUPPORTED for an option that this library does not know; KO_ERR_OUT_OF_MEMORY with the bytes that it would take;
 * KO_ERR_CANCELLED.
 * Threads: any; `progress` is called on the caller's. Cost: O(n_points log n_points), some 20 microseconds a point of space on one
 * thread. Memory: at most 1000 bytes a point and 32 a neighbour.
 */
int32_t ko_cloud_estimate_normals(uint32_t dim,
                                  const double *points,
                                  size_t n_points,
                                  const struct ko_normal_options *options,
                                  struct ko_cloud **cloud,
                                  uint8_t *flags,
                                  size_t report_size,
                                  struct ko_normal_report *report);

/**
 * Fills `options` with the defaults. `struct_size` is sizeof *options.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
 */
int32_t ko_smooth_options_init(struct ko_smooth_options *options, size_t struct_size);

/**
 * Smooths noise out of points and normals, which must be about right before, into a new cloud: moving least squares (Alexa et al. 2003).
 *
 * Each point goes to a quadratic through the nearest points that face the same way. Edges are rounded over about the distance of the last
 * of these. Weights stay, origins go. `options` NULL: the defaults. `*smoothed` is the caller's to free; `cloud` is left as it is.
 * Errors: KO_ERR_INVALID_ARGUMENT for an option out of its range, KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. Threads: any; `progress` is
 * called on the caller's. Cost: about 6 microseconds a point and round on one thread, in the plane 1.5; about 300 bytes a point meanwhile.
 */
int32_t ko_cloud_smooth(const struct ko_cloud *cloud,
                        const struct ko_smooth_options *options,
                        struct ko_cloud **smoothed);

/**
 * Fills `options` with the defaults. `struct_size` is sizeof *options.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
 */
int32_t ko_fit_options_init(struct ko_fit_options *options, size_t struct_size);

/**
 * Fits a field to `cloud`: the minimum of the energy (10) of Dunn et al. 2023 over cubic B-splines on a box around the cloud, with the
 * smoothness integrated exactly, distances held away from the surface, and points that the surface misses weighted more.
 *
 * `options` NULL: the defaults. phi > 0 on the feasible side; |phi| is close to the distance near the surface and smooth everywhere.
 * `*field` is the caller's to free; it does not refer to the cloud. With `max_error` its cells are refined where the error is larger: by
 * hierarchical B-splines, C2 as well (Kraft 1997).
 * Returns KO_BUDGET_REACHED, a success, where `max_error` was not reached within `max_unknowns` and `memory_limit`, or by cells as fine as
 * the points tell. Errors: KO_ERR_INVALID_ARGUMENT for an option out of its range or D outside [1e-90, 1e90], KO_ERR_DEGENERATE for points
 * that are all equal and for normals that cancel out, KO_ERR_UNSUPPORTED for an option that this library does not know and for
 * KO_REWEIGHT_ROBUST with `max_error`, KO_ERR_OUT_OF_MEMORY with the bytes that it would take, KO_ERR_NOT_CONVERGED, KO_ERR_CANCELLED.
 * Threads: any; `progress` is called on the caller's. Cost: an iteration takes some 30 ns a point and 25 ns a control point on one
 * thread; a hundred or two are usual. Where many more seem to be left the solve goes on by multigrid, in some ten iterations however many
 * control points there are, each at fifteen times the cost. Memory: about 600 bytes a point and 200 a control point; a multigrid takes up
 * to 4000 a control point more, for a million of them 700 to 1700, and is left out where `memory_limit` has no room for it. With
 * `max_error` there is no multigrid: a control point takes some 350 bytes, and the solves some hundreds of iterations in all with
 * default options, but thousands with a margin of several times the shape.
 */
int32_t ko_field_fit(const struct ko_cloud *cloud,
                     const struct ko_fit_options *options,
                     struct ko_field **field);

/**
 * Fits a field to `cloud` on the box of `start`, from its control points on: for a shape that moves a little from fit to fit, which then
 * takes few iterations.
 *
 * As `ko_field_fit`, but that the options' control points and margin do not count. `*field` is the caller's to free; it refers to neither
 * `start` nor the cloud, and `start` stays as it is.
 * With `max_error` the cells of `start` are refined further where they must be; those that it has stay. With KO_REWEIGHT_KEEP the points of
 * the cloud are those of the fit of `start`, as many in the same order, moved: each counts for what it counted for there, D is the one of
 * `start`, distances are held where they were, and one solve does, where the default measures and reweights as a fit does. A field that was
 * loaded or made does not know what points counted for.
 * Returns KO_BUDGET_REACHED as `ko_field_fit` does. Errors: those of `ko_field_fit`; KO_ERR_INVALID_ARGUMENT for a cloud of another
 * dimension or, with KO_REWEIGHT_KEEP, of another number of points, for a point outside the box, naming the first, and for a cloud of a
 * diagonal of less than a hundredth of the longest cell; KO_ERR_UNSUPPORTED for KO_REWEIGHT_ROBUST where `start` has refined cells. Threads,
 * cost, memory: those of `ko_field_fit`, in fewer iterations.
 */
int32_t ko_field_refit(const struct ko_field *start,
                       const struct ko_cloud *cloud,
                       const struct ko_fit_options *options,
                       struct ko_field **field);

/**
 * Makes a field (5) of given control points: one that another library fitted, say, or an optimiser moved.
 *
 * `dim` is 2 or 3. `counts` [dim], at least 4 each, are the control points along each axis of the box from `box_min` [dim] to `box_max`
 * [dim], an axis of n having n - 3 cells; `control_points` [n_control_points], as many as the product of the counts, row-major, the last
 * axis contiguous, are in the caller's unit of length, like the box and `diagonal`, the D that the field's report shall have. `feasible`
 * is KO_FEASIBLE_OUTSIDE or KO_FEASIBLE_INSIDE. The arrays are copied. `*field` is the caller's to free; what its report says of a fit is
 * 0.
 * Errors: KO_ERR_INVALID_ARGUMENT for fewer control points along an axis, for another number of them in all, for one that is not finite or
 * beyond 1e100, naming the first, for a box that is none, for cells or a diagonal outside [1e-90, 1e90]; KO_ERR_OUT_OF_MEMORY. Threads:
 * any. Cost: a copy.
 */
int32_t ko_field_from_control_points(uint32_t dim,
                                     const uint32_t *counts,
                                     const double *box_min,
                                     const double *box_max,
                                     int32_t feasible,
                                     double diagonal,
                                     const double *control_points,
                                     size_t n_control_points,
                                     struct ko_field **field);

/**
 * Copies the control points of (5) to `control_points` [n_control_points], row-major, the last axis contiguous, in the cloud's unit of
 * length.
 *
 * `n_control_points` must be `n_unknowns` of `ko_field_get_report`, which tells the counts and the box too. Errors:
 * KO_ERR_INVALID_ARGUMENT; KO_ERR_UNSUPPORTED for a field with `n_levels` above 1, whose control points are no tensor. Threads: any. Cost:
 * a copy.
 */
int32_t ko_field_copy_control_points(const struct ko_field *field,
                                     size_t n_control_points,
                                     double *control_points);

/**
 * Evaluates the field at `points` [dim * n_points]: `values` [n_points] in the cloud's unit of length, `gradients` [dim * n_points],
 * `hessians` by rows of the upper triangle, in space [6 * n_points], xx xy xz yy yz zz, in the plane [3 * n_points], xx xy yy.
 *
 * Each output may be NULL. Analytic derivatives of (5). Outside the box, where (5) ends, the field goes on, C2 and growing like a
 * distance: with t the distance beyond a face along an axis, l a quarter of the edge of the shortest cells on faces, s = l tanh(t / l), P
 * the boundary cell's polynomial, r the length of the vector of t - s over the axes, L the box's diagonal and m the mean of phi over the
 * faces,
 *     phi = m + (P(face + s) - m) L^2 / (L^2 + r^2) + sigma r.
 * sigma is the sign of m: for a closed shape +1 when feasible is outside, -1 when it is inside, so |phi| grows on the way out, and the
 * gradient tends to length 1. Where |m| is at most half the mean of |phi| on the faces (a sheet that reaches the box), m = 0 and
 * sigma = tanh(P / longest cell edge), steep where P crosses 0. `ko_field_outside_box` tells which points are outside.
 * Errors: KO_ERR_INVALID_ARGUMENT, naming the first point that is not finite or has a coordinate beyond 1e150; outputs are
 * unspecified then.
 * Threads: any number at once. Cost: 10 to 20 ns a point with gradient on one thread where the field fits into a cache, twice that without
 * AVX2, some two to three times where it is refined, and some 150 ns outside the box; no allocation, no lock. A field of more than some 8
 * MB waits for memory, up to 160 ns a point: there batches of a point and more for 256 control points, and of 8192 at least, are taken in
 * an order that keeps to the same control points, for which some 7 bytes a point are allocated, 4 MB at most, and up to half the time is saved;
 * where they cannot be had, points are taken as they come.
 */
int32_t ko_field_eval(const struct ko_field *field,
                      const double *points,
                      size_t n_points,
                      double *values,
                      double *gradients,
                      double *hessians);

/**
 * `ko_field_eval` with the batch spread over `n_threads` threads (0: all cores, 1: none but the caller's); the same bits.
 *
 * Errors: those of `ko_field_eval`; KO_ERR_INVALID_ARGUMENT for more than 1024 threads; KO_ERR_OUT_OF_MEMORY for threads
 * that do not start. A batch of at most 4096 points stays on the caller's thread.
 * Threads: any number at once. Cost: the caller's thread takes part; the others are started and joined, some 50 microseconds: for batches
 * of many thousand points. A caller that has a thread for each core already takes `n_threads` 1, or `ko_field_eval`.
 */
int32_t ko_field_eval_parallel(const struct ko_field *field,
                               const double *points,
                               size_t n_points,
                               double *values,
                               double *gradients,
                               double *hessians,
                               uint32_t n_threads);

/**
 * Evaluates the field at the points of an affine lattice, a line, a slice or, in space, a box, in any directions: those at `origin` [dim]
 * plus i_1 steps_1 + ... + i_k steps_k, 0 <= i_j < counts_j, for k = `n_steps` rows of `steps` [dim * n_steps] and `counts` [n_steps].
 *
 * `n_steps` is at least 1 and at most dim. `values` [n] and `gradients` [dim * n], n the product of the counts, are row-major, the last
 * index fastest; either may be NULL. They are those of `ko_field_eval` at these points, inside the box and outside it, on `n_threads`
 * threads (0: all cores, 1: none but the caller's), with the same bits on any number.
 * Errors: KO_ERR_INVALID_ARGUMENT for a number of steps out of range, a count of 0, more points than memory can count, an origin or step
 * that is not finite, a corner of the lattice beyond 1e150, more than 1024 threads; KO_ERR_OUT_OF_MEMORY for threads that do not start.
 * Nothing is written then.
 * Threads: any number at once. Cost: that of `ko_field_eval`; takes some kilobytes, and starts and joins threads for more than 4096
 * points.
 */
int32_t ko_field_eval_lattice(const struct ko_field *field,
                              const double *origin,
                              const double *steps,
                              const size_t *counts,
                              uint32_t n_steps,
                              double *values,
                              double *gradients,
                              uint32_t n_threads);

/**
 * Writes to `outside` [n_points] 1 for each of `points` [dim * n_points] outside the field's box, 0 for each inside or on a face.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT, naming the first point that is not finite or has a coordinate beyond 1e150. Threads: any number at
 * once. No allocation, no lock.
 */
int32_t ko_field_outside_box(const struct ko_field *field,
                             const double *points,
                             size_t n_points,
                             uint8_t *outside);

/**
 * Fills `report` with what the field is and what its fit did. `struct_size` is sizeof *report.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: none.
 */
int32_t ko_field_get_report(const struct ko_field *field, size_t struct_size, struct ko_fit_report *report);

/**
 * Writes the field to the file `path`: little-endian, with version and checksum, the same on every machine.
 *
 * A file that stood there is replaced whole or, after an error, left as it was.
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL or an empty path, KO_ERR_IO. Threads: any. Cost: one pass.
 */
int32_t ko_field_save(const struct ko_field *field, const char *path);

/**
 * Reads a field that `ko_field_save` wrote; it evaluates to the same bits. `*field` is the caller's to free.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL or an empty path; KO_ERR_IO; KO_ERR_FORMAT for a file that is no field, of another version, cut
 * short or altered; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: one pass.
 */
int32_t ko_field_load(const char *path,
                      struct ko_field **field);

/**
 * Frees a field. NULL is taken. No other thread may be using it.
 */
void ko_field_free(struct ko_field *field);

/**
 * Makes ready for the derivatives of values of `field` with respect to the points and normals of `cloud`, to which it was fitted (by
 * `ko_field_fit` or `ko_field_refit`) with `options`; NULL: the defaults.
 *
 * Of the options lambda_normal, lambda_smooth and distance_weight tell the energy, and `tolerance` what the field is held to: it must be
 * the minimum to twice that. What reweighting, robust or not, made of the points the field remembers, and where distances are held, but not
 * in a file: a field that was loaded serves where it was fitted with `reweightings` 0. `*sensitivity` is the caller's to free; it refers to neither field nor cloud.
 * Errors: KO_ERR_INVALID_ARGUMENT for a cloud of another dimension or of another number of points, for a point outside the box, naming the
 * first, and for a field that is not the minimum for the cloud and the options, with the residual; KO_ERR_UNSUPPORTED for an option that
 * this library does not know, KO_ERR_OUT_OF_MEMORY with the bytes that it would take, KO_ERR_CANCELLED.
 * Threads: any; `progress` is called on the caller's, and no more after the call. Cost: some passes over points and cells, and nothing is
 * solved; for a field that was loaded the distances are measured again. Memory: that of the fit, and some 250 bytes a point and 100 a control point.
 */
int32_t ko_sensitivity_create(const struct ko_field *field,
                              const struct ko_cloud *cloud,
                              const struct ko_fit_options *options,
                              struct ko_sensitivity **sensitivity);

/**
 * The derivatives of J = sum of w_j phi(x_j), over `points` x [dim * n_points] with `weights` w [n_points], with respect to all points and
 * normals of the cloud: `d_points` [dim * n_cloud_points] and `d_normals` [dim * n_cloud_points].
 *
 * By one linear solve, however many points there are: the adjoint of the minimum (11), which Dunn et al. 2023, section 3.5, leave open. m
 * constraints that are to be differentiated apart, such as phi(x_1), ..., phi(x_m), take m calls. `weights` NULL: each is 1. Points may lie
 * outside the box. `n_cloud_points` must be that of `ko_cloud_get_size`; either output may be NULL, and is 0 for points of weight 0.
 * Outputs are in the caller's units: with w without unit `d_points` has none, and `d_normals` is a length. They are derivatives of the
 * field that a refit with KO_REWEIGHT_KEEP gives, with these held: the box, D, the weights, the cells and their levels, what each point
 * counts for after reweighting, and in which cells distances are held, how much, with which sign and to which point. The distances
 * themselves follow the points. Of such refits, solved to 1e-12, differences agree to 1e-6 of |dJ|; phi bends within 1e-4 D where every point
 * moves its own way, so differences want smaller steps, or extrapolation. Normals of a cloud have length 1: `d_normals` is at right angles to
 * them, and the derivative with respect to a normal given with length l is `d_normals` / l. `ko_cloud_pull_back` goes on to the vertices of
 * a mesh.
 * `options` NULL: tolerance, max_iterations and n_threads of `ko_sensitivity_create`, no progress; else those, and `progress`, are taken
 * from them, and nothing else counts. The tolerance is that of |g - A lambda| / |g|, g the derivatives of J by the control points, and with
 * it the relative error of the outputs goes down.
 * Errors: KO_ERR_INVALID_ARGUMENT, naming the first point or weight that is not finite, and for another n_cloud_points;
 * KO_ERR_NOT_CONVERGED, KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. After an error outputs are unspecified, and the handle serves on.
 * Threads: no other thread may be using the handle. The result depends neither on `n_threads` nor on earlier calls. Cost: that of one
 * solve of a fit, a value at each of `points`, and Hessians of two fields at each point of the cloud; where many iterations seem to be left,
 * the first such call makes a multigrid, which the later ones use.
 */
int32_t ko_sensitivity_solve(struct ko_sensitivity *sensitivity,
                             const double *points,
                             const double *weights,
                             size_t n_points,
                             const struct ko_fit_options *options,
                             size_t n_cloud_points,
                             double *d_points,
                             double *d_normals);

/**
 * Frees a sensitivity. NULL is taken. No other thread may be using it.
 */
void ko_sensitivity_free(struct ko_sensitivity *sensitivity);

/**
 * Fills `options` with the defaults. `struct_size` is sizeof *options.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
 */
int32_t ko_level_set_options_init(struct ko_level_set_options *options, size_t struct_size);

/**
 * Makes a mesh of the level set phi = `level` within the field's box: triangles in space, curves in the plane.
 *
 * `level` is in the cloud's unit of length: 0 gives the fitted shape, others a shape about that far from it, on the feasible side where
 * they are above 0. `options` NULL: the defaults.
 * Normals point out of the solid, and a solid lies on the left of curves, wherever the feasible side is. Vertices lie on the level set
 * but for rounding; between them it is missed by about an eighth of the square of an edge times its curvature, and what is smaller than an
 * edge may be missed or joined. The mesh is watertight wherever the level set stays within the box: marching simplices (Allgower and
 * Gnutzmann 1987) on the cells cut into `subdivisions`, vertices by Newton's method, then short edges collapsed (Dey et al. 1999).
 * Of a refined field these are the cells of the deepest level with which the lattice has no more than 2^26 vertices.
 * `*mesh` is the caller's to free. The same field and options give the same bits.
 * Returns KO_OPEN_AT_BOX, a success, where the level set meets the box and the mesh is open there: a larger `margin` of the fit may
 * close it. Errors: KO_ERR_INVALID_ARGUMENT for a level that is not finite and for an option out of its range; KO_ERR_DEGENERATE for a
 * level that phi does not take, with the range that it takes at the corners of cells; KO_ERR_UNSUPPORTED for an option that this library
 * does not know; KO_ERR_OUT_OF_MEMORY with the bytes that it would take; KO_ERR_CANCELLED.
 * Threads: any number at once; `progress` is called on the caller's. Cost: an evaluation a lattice vertex, about 5 with gradient a vertex
 * of the surface before the collapse, and the collapse. Memory: 13 bytes a lattice vertex and 320 a vertex of that surface. Of the lattice
 * only vertices near the level set count: blocks of it that the field's control points keep from the level are left out.
 */
int32_t ko_field_level_set(const struct ko_field *field,
                           double level,
                           const struct ko_level_set_options *options,
                           struct ko_mesh **mesh);

/**
 * Fills `options` with the defaults. `struct_size` is sizeof *options.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
 */
int32_t ko_certify_options_init(struct ko_certify_options *options, size_t struct_size);

/**
 * Certifies `field` against `mesh`, the shape that it was fitted to: gives a threshold t such that phi >= t at the samples of a body proves
 * that the whole body is on the feasible side and farther than `clearance` from the shape.
 *
 * `clearance` d and `covering_radius` r, at least 0 and in the mesh's unit, are the distance that is wanted and the covering radius of the
 * body's samples: every point of its surface is within r of one. t is larger than phi at every point that is on the infeasible side or
 * within d + r of the shape, where the field is continued beyond its box too. `options` NULL: the defaults. `certificate_size` is sizeof
 * *certificate.
 *
 * The proof: a sample with phi >= t is on the feasible side and farther than d + r from the shape. So every point of the body's surface is
 * on the feasible side, since the side changes only on the shape, and farther than d. Each component of the shape is then in the body or
 * off it as a whole. To exclude that the body swallowed one, test the points of `ko_mesh_copy_component_points` against the body: once
 * each of them is outside it, all of the body is on the feasible side and farther than d from the shape. An aggregate that is at most
 * the least phi, KS(min) say, serves for phi at the samples. Values of `ko_constraints` are s phi, s the scale of the field's frame: the
 * test is value >= s t then; and d and r count in the field's frame, where lengths of the world are 1 / s times as long. What a pose rounds
 * is the caller's to add to r: some 1e-15 of the coordinates.
 *
 * t comes from a search by boxes, split where phi is large, with phi between its Bezier points on each and exact distances to the mesh;
 * what rounding can do is added. The mesh bounds a solid where every edge is run through as often one way as the other and the volume is
 * positive. Elsewhere sides are not certified: t covers what is within d + r of the shape, on both sides.
 * Returns KO_SIDE_NOT_CERTIFIED, a success, for a mesh that bounds no solid; KO_BUDGET_REACHED, a success, where `max_boxes` made a bound
 * looser than `tolerance`. The certificate tells of both. The same input gives the same bits.
 * Errors: KO_ERR_INVALID_ARGUMENT for a length or an option out of its range, for a mesh of another dimension, and where the coordinates and
 * d + r together are above 1e11 times the shortest cell, so that rounding would lose the cells; KO_ERR_DEGENERATE where
 * phi grows without end on the infeasible side, as of a field that does not have this mesh inside its box, or with the other side
 * feasible; KO_ERR_UNSUPPORTED for an option that this library does not know; KO_ERR_OUT_OF_MEMORY; KO_ERR_CANCELLED.
 * Threads: any number at once; `progress` is called on the caller's. Cost: every cell is bounded, a microsecond or two, and every triangle;
 * then boxes are split near the largest phi, the fewer the more it stands out. The mesh keeps the tree of its distances, about 200 bytes
 * a triangle, as after `ko_mesh_signed_distance`.
 */
int32_t ko_field_certify(const struct ko_field *field,
                         const struct ko_mesh *mesh,
                         double clearance,
                         double covering_radius,
                         const struct ko_certify_options *options,
                         size_t certificate_size,
                         struct ko_certificate *certificate);

/**
 * Fills `aggregation` with the defaults. `struct_size` is sizeof *aggregation.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
 */
int32_t ko_aggregation_init(struct ko_aggregation *aggregation, size_t struct_size);

/**
 * Aggregates `values` [n_values], of fields or the caller's own constraints, to `*value`, with `gradient` [n_values], its derivatives by
 * the values, and `hessian` [n_values * (n_values + 1) / 2], the lower triangle of the second ones, row by row; each may be NULL.
 *
 * `aggregation` NULL: KS. `extreme` is KO_LEAST or KO_LARGEST, `unit` the length D that rho is in: that of `ko_field_get_report`, or the
 * size of the values.
 * Errors: KO_ERR_INVALID_ARGUMENT for no values, for one that is not finite or beyond 1e12 units, naming the first, for a unit outside
 * [1e-90, 1e90], for KO_AGGREGATE_NONE; KO_ERR_UNSUPPORTED for a Hessian of KO_AGGREGATE_MINIMUM. Threads: any. Cost: some 20 ns a value,
 * and a nanosecond an entry of the Hessian; no allocation.
 */
int32_t ko_aggregate(const struct ko_aggregation *aggregation,
                     int32_t extreme,
                     double unit,
                     const double *values,
                     size_t n_values,
                     double *value,
                     double *gradient,
                     double *hessian);

/**
 * Tells how far an aggregate of KO_LEAST may lie from the least of `n_values` values: `*below` it and `*above` it, in units of D, not
 * negative. Each may be NULL. Beyond them come roundings of some 1e-15 times the values and D.
 *
 * `aggregation` NULL: KS. `least` is the least value in units of D; it counts for KO_AGGREGATE_P_NORM alone.
 * Errors: KO_ERR_INVALID_ARGUMENT for no values and a `least` that is not finite or beyond 1e12 in size. Threads: any. Cost: none.
 */
int32_t ko_aggregation_bounds(const struct ko_aggregation *aggregation,
                              size_t n_values,
                              double least,
                              double *below,
                              double *above);

/**
 * Makes a body of `points` [dim * n_points] in a frame of its own.
 *
 * `dim` is 2 or 3. No point of the body's surface must be farther than `covering_radius` from one of its points, in their unit of length;
 * 0 where that is not known, or the points are all there is. The points are copied. `*body` is the caller's to free.
 * Errors: KO_ERR_INVALID_ARGUMENT for no points or more than 2^30, for one that is not finite or beyond 1e90, naming the first, for a
 * radius below 0; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: a copy.
 */
int32_t ko_body_from_points(uint32_t dim,
                            const double *points,
                            size_t n_points,
                            double covering_radius,
                            struct ko_body **body);

/**
 * Makes a body of points on `mesh`, so many that no point of its triangles, in the plane of its segments, is farther than
 * `covering_radius` from one of them, in the mesh's unit of length.
 *
 * They are the vertices of its facets, halved along their longest edges until these are at most sqrt(3) radii long, in the plane 2: a
 * surface of area S gets some 0.7 to 1.3 S / radius^2 beside the mesh's own. `*body` is the caller's to free; it does not refer to the mesh.
 * Errors: KO_ERR_INVALID_ARGUMENT for a radius outside [1e-90, 1e90], or so small that it asks for more than 2^30 points or for points
 * that doubles do not tell apart: at once where area or length alone tell so, with the smallest radius that they let through;
 * KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: less than a microsecond, and some 100 bytes, a point.
 */
int32_t ko_body_from_mesh(const struct ko_mesh *mesh,
                          double covering_radius,
                          struct ko_body **body);

/**
 * Frees a body. NULL is taken. No other thread may be using it.
 */
void ko_body_free(struct ko_body *body);

/**
 * Tells the dimension of the body, 2 or 3. Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
 */
int32_t ko_body_get_dim(const struct ko_body *body, uint32_t *dim);

/**
 * Tells how many points the body has. Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
 */
int32_t ko_body_get_size(const struct ko_body *body, size_t *n_points);

/**
 * Tells the body's covering radius; 0 where it is not known. Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
 */
int32_t ko_body_get_covering_radius(const struct ko_body *body,
                                    double *covering_radius);

/**
 * Copies the body's points to `points` [dim * n_points].
 *
 * `n_points` must be that of `ko_body_get_size`. Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: a copy.
 */
int32_t ko_body_copy_points(const struct ko_body *body, size_t n_points, double *points);

/**
 * Makes a set of constraints of dimension `dim`, 2 or 3, without variables and values; `*constraints` is the caller's to free.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: none.
 */
int32_t ko_constraints_create(uint32_t dim,
                              struct ko_constraints **constraints);

/**
 * Frees a set of constraints. NULL is taken. No other thread may be using it.
 */
void ko_constraints_free(struct ko_constraints *constraints);

/**
 * Adds a frame, of which all parameters are variables; `*frame` is its number.
 *
 * `rotation` is a KO_ROTATION_, `scale` a KO_SCALE_ constant. Errors: KO_ERR_INVALID_ARGUMENT for others, and for a rotation of the other
 * dimension. Threads: needs the handle alone. Cost: none.
 */
int32_t ko_constraints_add_frame(struct ko_constraints *constraints,
                                 int32_t rotation,
                                 int32_t scale,
                                 uint32_t *frame);

/**
 * Adds a frame that stands still at a pose of `parameters` [n_parameters]; `*frame` is its number.
 *
 * Errors: those of `ko_constraints_add_frame`; KO_ERR_INVALID_ARGUMENT for another number of parameters, and for one out of its range.
 * Threads: needs the handle alone. Cost: none.
 */
int32_t ko_constraints_add_fixed_frame(struct ko_constraints *constraints,
                                       int32_t rotation,
                                       int32_t scale,
                                       const double *parameters,
                                       size_t n_parameters,
                                       uint32_t *frame);

/**
 * Adds `n_points` points of the world whose coordinates [dim * n_points] are variables: of a path, or of a design that the caller moves
 * and differentiates itself. `*points` is their number.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for no points, and for more than 2^31 - 1 variables in all. Threads: needs the handle alone. Cost: none.
 */
int32_t ko_constraints_add_points(struct ko_constraints *constraints,
                                  size_t n_points,
                                  uint32_t *points);

/**
 * Requires that `body` in `frame` lies where phi of `field` in `field_frame` is positive: one value more by `aggregation` over the body's
 * points, or, with KO_AGGREGATE_NONE, one a point. `*first_value`, which may be NULL, is the number of the first.
 *
 * The value is s phi, s the scale of the field's frame. Frames are numbers that `ko_constraints_add_frame` gave, or KO_WORLD. A body and a
 * field that both move are kept apart by two calls, each body's points in the other's field. `aggregation` NULL: KS. The body and the field
 * stay in use until the constraints are freed, and may be freed before.
 * Errors: KO_ERR_INVALID_ARGUMENT for another dimension, a number that is no frame's, one moving frame for both, and for more than
 * 2^31 - 1 values or entries. Threads: needs `constraints` alone. Cost: none.
 */
int32_t ko_constraints_keep_body(struct ko_constraints *constraints,
                                 const struct ko_body *body,
                                 uint32_t frame,
                                 const struct ko_field *field,
                                 uint32_t field_frame,
                                 const struct ko_aggregation *aggregation,
                                 size_t *first_value);

/**
 * Requires that the points with number `points` lie where phi of `field` in `field_frame` is positive: as `ko_constraints_keep_body`.
 *
 * An aggregate couples all of them in the Hessian, with (dim n)^2 / 2 entries; KO_AGGREGATE_NONE has a value, and a small block, a point.
 * Errors: KO_ERR_INVALID_ARGUMENT as there. Threads: needs `constraints` alone. Cost: none.
 */
int32_t ko_constraints_keep_points(struct ko_constraints *constraints,
                                   uint32_t points,
                                   const struct ko_field *field,
                                   uint32_t field_frame,
                                   const struct ko_aggregation *aggregation,
                                   size_t *first_value);

/**
 * Requires that `body` in `frame` lies in the union or the intersection of the feasible sets of `fields` [n_fields], all in `field_frame`:
 * as `ko_constraints_keep_body`, phi of a sample being that of the fields there, combined.
 *
 * `extreme` is KO_LARGEST, for the union: each sample in one of two tanks, say, and a body across both; or KO_LEAST, for the intersection:
 * outside several obstacles, as one value. `combination` tells how the fields' phi become one, sample by sample, NULL: KS; with KO_BELOW
 * it lies below the largest or the least of them, the safe side of both. KS lies at most D ln(n_fields) / rho below: below the least where
 * the fields are equal, below the largest where one is much larger than the others, so that the walls of a union are that much nearer.
 * `aggregation` is over the samples, and works on what `combination` gives. D of both is the largest of the fields'. phi of all fields must
 * be in one unit of length. With KO_AGGREGATE_MINIMUM as `combination` phi is the least or largest itself, with the gradient of the first
 * field that has it: not smooth, no Hessian. One field is as `ko_constraints_keep_body` has it.
 * Errors: those of `ko_constraints_keep_body`; KO_ERR_INVALID_ARGUMENT for no fields or more than 256, for NULL and for another dimension
 * among them, naming the first, for another `extreme`, for KO_AGGREGATE_NONE as `combination`. Threads: needs `constraints` alone. Cost:
 * none; evaluated, about that of one requirement a field.
 */
int32_t ko_constraints_keep_body_in_fields(struct ko_constraints *constraints,
                                           const struct ko_body *body,
                                           uint32_t frame,
                                           const struct ko_field *const *fields,
                                           size_t n_fields,
                                           int32_t extreme,
                                           const struct ko_aggregation *combination,
                                           uint32_t field_frame,
                                           const struct ko_aggregation *aggregation,
                                           size_t *first_value);

/**
 * Requires that the points with number `points` lie in the union or the intersection of the feasible sets of `fields` [n_fields], all in
 * `field_frame`: as `ko_constraints_keep_body_in_fields`, and in the Hessian as `ko_constraints_keep_points`.
 *
 * Errors, threads and cost: as of these two.
 */
int32_t ko_constraints_keep_points_in_fields(struct ko_constraints *constraints,
                                             uint32_t points,
                                             const struct ko_field *const *fields,
                                             size_t n_fields,
                                             int32_t extreme,
                                             const struct ko_aggregation *combination,
                                             uint32_t field_frame,
                                             const struct ko_aggregation *aggregation,
                                             size_t *first_value);

/**
 * Tells how many variables and values there are, and entries of the Jacobian's pattern and of the Hessian's; each may be NULL.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL constraints. Threads: any. Cost: none.
 */
int32_t ko_constraints_get_size(const struct ko_constraints *constraints,
                                size_t *n_variables,
                                size_t *n_values,
                                size_t *n_jacobian,
                                size_t *n_hessian);

/**
 * Tells the first variable of a frame and how many it has, 0 of one that stands still.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: none.
 */
int32_t ko_constraints_get_frame_variables(const struct ko_constraints *constraints,
                                           uint32_t frame,
                                           size_t *first,
                                           size_t *n_variables);

/**
 * Tells the first variable of points, and how many they have.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: none.
 */
int32_t ko_constraints_get_points_variables(const struct ko_constraints *constraints,
                                            uint32_t points,
                                            size_t *first,
                                            size_t *n_variables);

/**
 * Evaluates the constraints at `x` [n_variables]: `values` [n_values], each to be kept at or above 0, in the fields' unit of length times
 * the scale of their frames.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT, naming the variable, frame or value, for lengths other than those of `ko_constraints_get_size`, for a
 * variable that is not finite, a quaternion or a scale out of range, a sample beyond 1e150: an optimiser's adapter reports an evaluation
 * that failed then. `values` are unspecified after an error. Threads: any number at once. Cost: some 20 ns a sample, ten times that for one
 * outside its field's box (a fit with a larger `margin` has it inside), a microsecond a requirement; no allocation, no lock.
 */
int32_t ko_constraints_values(const struct ko_constraints *constraints,
                              const double *x,
                              size_t n_variables,
                              size_t n_values,
                              double *values);

/**
 * Tells `rows` [n_entries] and `columns` [n_entries] of the Jacobian's entries, counted from 0: values, and variables.
 *
 * Row by row; within a row points come first, then the samples' frame, then the field's; no place comes twice. `n_entries` must be that of
 * `ko_constraints_get_size`. Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: a few nanoseconds an entry.
 */
int32_t ko_constraints_jacobian_pattern(const struct ko_constraints *constraints,
                                        size_t n_entries,
                                        int32_t *rows,
                                        int32_t *columns);

/**
 * Evaluates the Jacobian at `x` [n_variables]: `entries` [n_entries] in the order of `ko_constraints_jacobian_pattern`.
 *
 * Errors and threads: those of `ko_constraints_values`. Cost: some 1.4 times `ko_field_eval` with gradients at the same points for bodies,
 * twice that for points that are aggregated; no allocation, no lock.
 */
int32_t ko_constraints_jacobian(const struct ko_constraints *constraints,
                                const double *x,
                                size_t n_variables,
                                size_t n_entries,
                                double *entries);

/**
 * Evaluates values and Jacobian at once, in one pass over the samples of bodies: `values` [n_values] and `entries` [n_entries], as
 * `ko_constraints_values` and `ko_constraints_jacobian` give them.
 *
 * Errors, threads and cost: those of `ko_constraints_jacobian`.
 */
int32_t ko_constraints_values_and_jacobian(const struct ko_constraints *constraints,
                                           const double *x,
                                           size_t n_variables,
                                           size_t n_values,
                                           double *values,
                                           size_t n_entries,
                                           double *entries);

/**
 * Evaluates the Jacobian at `x` [n_variables] as a whole: `jacobian` [n_values * n_variables], row-major, with its zeros.
 *
 * Errors, threads and cost: those of `ko_constraints_jacobian`, and the zeros.
 */
int32_t ko_constraints_dense_jacobian(const struct ko_constraints *constraints,
                                      const double *x,
                                      size_t n_variables,
                                      size_t n_values,
                                      double *jacobian);

/**
 * Evaluates J v at `x` [n_variables] for `v` [n_variables]: `product` [n_values].
 *
 * Errors, threads and cost: those of `ko_constraints_jacobian`.
 */
int32_t ko_constraints_jacobian_times(const struct ko_constraints *constraints,
                                      const double *x,
                                      const double *v,
                                      size_t n_variables,
                                      size_t n_values,
                                      double *product);

/**
 * Evaluates J^T w at `x` [n_variables] for `w` [n_values]: `product` [n_variables].
 *
 * Errors, threads and cost: those of `ko_constraints_jacobian`.
 */
int32_t ko_constraints_transposed_jacobian_times(const struct ko_constraints *constraints,
                                                 const double *x,
                                                 size_t n_variables,
                                                 const double *w,
                                                 size_t n_values,
                                                 double *product);

/**
 * Tells `rows` [n_entries] and `columns` [n_entries] of the entries of the Hessian's lower triangle, both variables, counted from 0.
 *
 * No column is above its row, and no place comes twice. `n_entries` must be that of `ko_constraints_get_size`. Errors:
 * KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: a few nanoseconds an entry.
 */
int32_t ko_constraints_hessian_pattern(const struct ko_constraints *constraints,
                                       size_t n_entries,
                                       int32_t *rows,
                                       int32_t *columns);

/**
 * Evaluates the Hessian of the sum of `lambda` [n_values] times the values at `x` [n_variables]: the constraints' part of the Lagrangian's.
 * `entries` [n_entries] are in the order of `ko_constraints_hessian_pattern`.
 *
 * Errors: those of `ko_constraints_values`; KO_ERR_INVALID_ARGUMENT for a multiplier that is not finite, KO_ERR_UNSUPPORTED for one other
 * than 0 of a value by KO_AGGREGATE_MINIMUM, over samples or over fields. Threads: any number at once. Cost: some 90 ns a sample of a
 * requirement whose multiplier is not 0, and the entries of points that are coupled; no allocation, no lock.
 */
int32_t ko_constraints_hessian(const struct ko_constraints *constraints,
                               const double *x,
                               size_t n_variables,
                               const double *lambda,
                               size_t n_values,
                               size_t n_entries,
                               double *entries);

/**
 * Fills `options` with the defaults. `struct_size` is sizeof *options.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
 */
int32_t ko_explicit_options_init(struct ko_explicit_options *options, size_t struct_size);

/**
 * Makes an explicit formulation of the points of `cloud`; those of weight 0 take no part, other weights count alike.
 *
 * `options` NULL: the defaults, (1) over all points. `*formula` is the caller's to free; it does not refer to the cloud.
 * Errors: KO_ERR_INVALID_ARGUMENT for an option out of its range or D outside [1e-90, 1e90], KO_ERR_DEGENERATE for points that are all
 * equal, KO_ERR_UNSUPPORTED for an option that this library does not know, KO_ERR_OUT_OF_MEMORY.
 * Threads: any. Cost: a copy; where nearest points, a spacing or curvatures are needed some microseconds a point. Memory: 100 bytes a point,
 * with curvatures 170, with nearest points 80 more.
 */
int32_t ko_explicit_create(const struct ko_cloud *cloud,
                           const struct ko_explicit_options *options,
                           struct ko_explicit **formula);

/**
 * Frees an explicit formulation. NULL is taken. No other thread may be using it.
 */
void ko_explicit_free(struct ko_explicit *formula);

/**
 * Tells rho, in 1 / D, 0 where the formula has none. Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
 */
int32_t ko_explicit_get_smoothing(const struct ko_explicit *formula,
                                  double *smoothing);

/**
 * Evaluates the formulation at `points` [dim * n_points]: `values` [n_points] in the caller's unit of length, `gradients` [dim * n_points];
 * each may be NULL.
 *
 * Gradients are exact; where the formula jumps or kinks, told at its KO_EXPLICIT_, they are those of one side, at a point of the cloud the
 * mean of opposite sides'. There are no Hessians.
 * Errors: KO_ERR_INVALID_ARGUMENT, naming the first point that is not finite or farther than 1e12 D from the cloud's middle along an axis.
 * Threads: any number at once. Cost: over all N points O(N) a point, a nanosecond or some for each; over the k nearest a search of some
 * microseconds. No allocation, no lock.
 */
int32_t ko_explicit_eval(const struct ko_explicit *formula,
                         const double *points,
                         size_t n_points,
                         double *values,
                         double *gradients);

/**
 * Tells how far two triangulations are apart, and how much they cross: the pair of constraints of Brelje et al. 2020, minimum distance > 0
 * and intersection length = 0, with the test that must go with them, of `mesh_b` moved by `translation` [3], NULL for none. The meshes stay.
 *
 * `sharpness` 0: the minimum itself; in [1, 1e9]: KS from below, -(D / rho) ln sum exp(-rho d_ij / D) over the pairs of triangles, D the
 * diagonal of mesh_a. `distance_gradients` and `length_gradients` [3 * n_vertices] are the derivatives by the vertices of mesh_b, `n_vertices`
 * of `ko_mesh_get_size`; each may be NULL. `separation` may be NULL; `struct_size` is sizeof *separation.
 * What is differentiable: the minimum is not where another pair, or another feature of it, becomes the nearest; KS is not where another
 * feature of a pair does. Where the meshes cross, the minimum is 0 with gradient 0. The length is continuous but where triangles come to
 * lie in one plane, has kinks where its ends go to other edges, and no bounded gradient where two triangles begin to cross. b_in_a and
 * a_in_b have no derivatives: inside the other mesh nothing tells the way out. There are no Hessians.
 * Errors: KO_ERR_UNSUPPORTED for meshes of the plane; KO_ERR_INVALID_ARGUMENT for a translation that is not finite, a sharpness out of its
 * range, a wrong n_vertices, a diagonal outside [1e-90, 1e90], coordinates beyond 1e90; KO_ERR_OUT_OF_MEMORY.
 * Threads: any number at once. Cost: the first call on a mesh builds its tree, some microseconds a triangle; then about a microsecond for
 * each pair of triangles about as near as the nearest, or crossing, with KS for each pair no farther apart than the least distance and 37 D /
 * sharpness: below some 40 these are all n_a n_b pairs, minutes for meshes of 20,000 triangles, with no way to cancel. A test of sides for
 * each connected part, and some nanoseconds a vertex.
 */
int32_t ko_meshes_separation(const struct ko_mesh *mesh_a,
                             const struct ko_mesh *mesh_b,
                             const double *translation,
                             double sharpness,
                             size_t n_vertices,
                             size_t struct_size,
                             struct ko_separation *separation,
                             double *distance_gradients,
                             double *length_gradients);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* KEEPOUT_H */
