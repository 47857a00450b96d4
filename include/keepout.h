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
 *   Dunn et al., "Scalable enforcement of geometric non-interference constraints for gradient-based optimization" (2023), and, where they are
 *   named, of Morris and Behandish, "Co-generation of collision-free shapes for arbitrary one-parametric motion" (2022).
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
 * A success with a remark: no cell of one part ever meets one of the other.
 */
#define KO_NEVER_MEET 4

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
 * The part never has the cell.
 */
#define KO_CELL_FORBIDDEN 0

/**
 * The part may have the cell: of its initial design, say.
 */
#define KO_CELL_FREE 1

/**
 * The part keeps the cell whatever happens.
 */
#define KO_CELL_FROZEN 2

/**
 * The mesh lies in the cells: meshes of parts that do not collide do not.
 */
#define KO_WITHIN_CELLS 0

/**
 * About as much of the mesh lies outside of the cells as inside, which keeps their volume: meshes of parts that do not collide may.
 */
#define KO_WITHIN_ANYWHERE 1

/**
 * Conflicts are those of whole cells at all times, none missed: parts without them never overlap.
 */
#define KO_CONFLICTS_OF_OVERLAP 0

/**
 * Conflicts are those of the paper's measure, the nonzeros of w^12 and w^21: of cells' centres at `measure_steps` times. Parts without them may
 * still overlap in between.
 */
#define KO_CONFLICTS_OF_MEASURE 1

/**
 * No conflict graph: the pair serves measures and sensitivities alone.
 */
#define KO_CONFLICTS_NONE 2

/**
 * The part must overlap no cell of the body.
 */
#define KO_AVOID 0

/**
 * The part must lie within the cells of the body: an enclosure.
 */
#define KO_STAY_IN 1

/**
 * Cells are put to a part.
 */
#define KO_CHANGE_PUT 0

/**
 * Cells are taken from a part.
 */
#define KO_CHANGE_TAKE 1

/**
 * Parts and their motions, any number of them: which of their cells conflict. Freed by `ko_assembly_free`.
 *
 * What takes a set of cells takes n_cells bytes, those of all parts, part after part in the order in which they were given; weights likewise.
 */
typedef struct ko_assembly ko_assembly;

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
 * A rigid motion tau(t) of one parameter t in [0, 1], in the plane or in space: (3) and (4) of Morris and Behandish 2022. It takes points of a
 * part to where they are in the world at t. Freed by `ko_motion_free`; what was made of it goes on.
 */
typedef struct ko_motion ko_motion;

/**
 * Two parts and their motions: collision measures, which depend on motions and grids alone, and the conflict graph, of which pairs that never
 * collide are the independent sets. Morris and Behandish 2022. Freed by `ko_pair_free`.
 *
 * What takes a set for each part takes n_1 and n_2 bytes, numbers of cells of part 1 and of part 2; densities likewise.
 */
typedef struct ko_pair ko_pair;

/**
 * A grid of square or cubic cells in a part's own frame, (A.2) of Morris and Behandish 2022, and what the part may do with each. Freed by
 * `ko_part_free`; what was made of it goes on.
 *
 * Cells are numbered row-major: the last axis runs fastest. Sets of a part's cells are arrays of a byte a cell, 1 where it is in the set, 0
 * where not; densities are arrays of a number in [0, 1] a cell.
 */
typedef struct ko_part ko_part;

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

/**
 * How far along its way a motion is at t: f(t) = offset + slope t + sum over k of a_k cos(2 pi c_k t + p_k). Initialise by `ko_law_init`.
 */
typedef struct ko_law {
    /**
     * sizeof(ko_law), set by ko_law_init.
     */
    size_t struct_size;
    /**
     * f without the rest: radians of a turn or screw; of a slide a factor. 0 by ko_law_init.
     */
    double offset;
    /**
     * By how much the even part grows while t goes from 0 to 1. 0 by ko_law_init.
     */
    double slope;
    /**
     * [3 * n_waves]: amplitude a_k, cycles c_k while t goes from 0 to 1, phase p_k in radians. Read during a call only. NULL by ko_law_init.
     */
    const double *waves;
    /**
     * Waves. 0 by ko_law_init.
     */
    size_t n_waves;
} ko_law;

/**
 * Writes the pose at `time` in [0, 1] to `rotation` [dim * dim], row-major, and `translation` [dim], and returns 0; not 0 is an error. Called
 * on the caller's thread only. It must not unwind, throw or jump out.
 */
typedef int32_t (*ko_pose_function)(double time, double *rotation, double *translation, void *data);

/**
 * Options of `ko_pair_create`, `ko_part_sweep` and `ko_part_unsweep`. Initialise by `ko_pair_options_init`, then set what shall differ.
 */
typedef struct ko_pair_options {
    /**
     * sizeof(ko_pair_options), set by ko_pair_options_init.
     */
    size_t struct_size;
    /**
     * How finely time is cut for overlaps, which are never missed: so that cells are kept apart by about this much of the smaller cell's edge
     * more than they must, at most. Above 0. Default 0.05.
     */
    double slack;
    /**
     * Even steps of time for overlaps instead; 0 (default): as many as `slack` asks for.
     */
    uint64_t n_steps;
    /**
     * K, the times (k + 1/2) / K at which centres of cells are looked at for the measures (A.14) to (A.17); 0 (default): no measures.
     */
    uint64_t measure_steps;
    /**
     * Distance that parts keep from each other at all times, in the unit of length, at least 0; with KO_CONFLICTS_OF_OVERLAP. Default 0.
     */
    double clearance;
    /**
     * Bytes that measures and conflict graph may take together; more is refused as soon as it is seen, with what it would take. Default 8 GiB.
     */
    uint64_t max_bytes;
    /**
     * A KO_CONFLICTS_ constant. Default KO_CONFLICTS_OF_OVERLAP.
     */
    int32_t conflicts;
    /**
     * Threads, at most 1024: 0 (default) for all cores, 1 for none but the caller's. The result does not depend on it.
     */
    uint32_t n_threads;
    /**
     * Told of progress, or NULL (default).
     */
    ko_progress progress;
    /**
     * Handed to `progress`.
     */
    void *progress_data;
} ko_pair_options;

/**
 * Options of `ko_pair_cut` and `ko_pair_family`. Initialise by `ko_family_options_init`, then set what shall differ.
 */
typedef struct ko_family_options {
    /**
     * sizeof(ko_family_options), set by ko_family_options_init.
     */
    size_t struct_size;
    /**
     * Pairs of a family are good enough at this fraction below the bound, in [0, 1); with 0 the convex hull of all pairs' volumes is looked for at
     * each gamma. A cut is exact whatever it is. Default 0.005.
     */
    double gap;
    /**
     * Maps by which pairs shall be symmetric, [2 * dim * (dim + 1) * n_symmetries]; NULL (default) for none. Of each map a matrix A [dim * dim],
     * row-major, and a vector b [dim] for part 1, then A and b for part 2: x goes to A x + b in the part's own frame, a turn or a mirror. They must
     * carry the grids onto themselves, and conflicts onto conflicts; only whole orbits of cells are in a pair then.
     */
    const double *symmetries;
    /**
     * Maps.
     */
    size_t n_symmetries;
    /**
     * The fraction of the conflicts that may miss their images, in [0, 1), such as where steps of time are not carried onto steps; images that are
     * missed count as conflicts. Default 0.
     */
    double symmetry_excess;
    /**
     * Threads for symmetries, at most 1024: 0 (default) for all cores, 1 for none but the caller's. The result does not depend on it.
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
} ko_family_options;

/**
 * Options of `ko_pair_optimise`. Initialise by `ko_optimise_options_init`, then set what shall differ.
 */
typedef struct ko_optimise_options {
    /**
     * sizeof(ko_optimise_options), set by ko_optimise_options_init.
     */
    size_t struct_size;
    /**
     * gamma of (37d), in [0, 1]: V_2 / (V_1 + V_2) of what is left of the colliding cells. Default 0.5.
     */
    double gamma;
    /**
     * It ends when an iteration changes less than this fraction of the colliding cells' volume; in (0, 1). Default 1e-4.
     */
    double tolerance;
    /**
     * What the measures may be at the end, as fractions of what they begin with, and the two sides of (37d), as one of the volume; in (0, 1).
     * Default 1e-3.
     */
    double feasibility;
    /**
     * Iterations, at most. Default 200.
     */
    uint32_t max_iterations;
    /**
     * The part from which closure begins, 1 or 2; 0 (default): that with the larger volume.
     */
    uint32_t close_from;
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
} ko_optimise_options;

/**
 * Options of `ko_pair_more_persistent`. Initialise by `ko_persistence_options_init`, then set what shall differ.
 */
typedef struct ko_persistence_options {
    /**
     * sizeof(ko_persistence_options), set by ko_persistence_options_init.
     */
    size_t struct_size;
    /**
     * h, the gap at which persistence is 1/2, in the unit of length; 0 (default): the edge of the larger of both parts' cells.
     */
    double scale;
    /**
     * gamma of the pairs that are looked at, from and to, in [0, 1]. Default 0 and 1.
     */
    double gammas[2];
    /**
     * Even times at which gaps are measured. Default 200.
     */
    uint64_t n_times;
    /**
     * Pairs that are tried, at most. Default 100.
     */
    uint64_t max_tries;
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
} ko_persistence_options;

/**
 * What a pair is. Filled by `ko_pair_get_report`.
 */
typedef struct ko_pair_report {
    /**
     * sizeof(ko_pair_report) as the caller knows it.
     */
    size_t struct_size;
    /**
     * n_1 and n_2, cells of both grids.
     */
    uint64_t n_cells[2];
    /**
     * Cells that each part may have beside those that the other keeps, and that conflict with cells of the other.
     */
    uint64_t n_colliding[2];
    /**
     * Edges of the conflict graph.
     */
    uint64_t n_edges;
    /**
     * Bytes that it takes.
     */
    uint64_t graph_bytes;
    /**
     * K, 0 for a pair without measures.
     */
    uint64_t measure_steps;
    /**
     * Visits of centres in cells that the measures are of.
     */
    uint64_t n_visits;
    /**
     * Bytes that they take.
     */
    uint64_t measure_bytes;
    /**
     * 2 or 3.
     */
    uint32_t dim;
    /**
     * 1: there is a conflict graph.
     */
    int32_t has_graph;
} ko_pair_report;

/**
 * What an optimisation found. Filled by `ko_pair_optimise`.
 */
typedef struct ko_optimise_report {
    /**
     * sizeof(ko_optimise_report) as the caller knows it.
     */
    size_t struct_size;
    /**
     * gamma of the closed pair, as `ko_pair_volumes` tells: NaN where nothing is left of the colliding cells. Colliding by the conflict graph, while
     * the optimisation's own gamma, and its history, are of the cells that collide by the measure.
     */
    double gamma;
    /**
     * Areas or volumes of what is left of the colliding cells of part 1 and 2 in the closed pair.
     */
    double volumes[2];
    /**
     * g_21 and g_12 of the last densities: 0 of the closed pair.
     */
    double measures[2];
    /**
     * The part of the colliding volume that the last iteration changed.
     */
    double change;
    /**
     * Iterations.
     */
    uint32_t n_iterations;
    /**
     * 1: the last change is below the tolerance, and the constraints hold within `feasibility`. 0: KO_BUDGET_REACHED.
     */
    int32_t converged;
} ko_optimise_report;

/**
 * Options of `ko_assembly_arrange`. Initialise by `ko_arrange_options_init`, then set what shall differ.
 */
typedef struct ko_arrange_options {
    /**
     * sizeof(ko_arrange_options), set by ko_arrange_options_init.
     */
    size_t struct_size;
    /**
     * How often each team of parts is given a cut, at most. Default 20.
     */
    uint32_t max_rounds;
    /**
     * Teams that may be the first, each of which leads to a result of its own; at most. Default 4.
     */
    uint32_t max_starts;
    /**
     * Told of progress, or NULL (default).
     */
    ko_progress progress;
    /**
     * Handed to `progress`.
     */
    void *progress_data;
} ko_arrange_options;

/**
 * What an assembly is. Filled by `ko_assembly_get_report`.
 */
typedef struct ko_assembly_report {
    /**
     * sizeof(ko_assembly_report) as the caller knows it.
     */
    size_t struct_size;
    /**
     * Cells of all parts' grids.
     */
    uint64_t n_cells;
    /**
     * Pairs of parts of which some cells conflict.
     */
    uint64_t n_meetings;
    /**
     * Pairs of cells that conflict.
     */
    uint64_t n_edges;
    /**
     * Bytes that the conflict graph takes.
     */
    uint64_t graph_bytes;
    /**
     * Parts.
     */
    uint32_t n_parts;
    /**
     * 2 or 3.
     */
    uint32_t dim;
} ko_assembly_report;

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
 * test is value >= s t then; and d and r count in the field's frame, where lengths of the world are 1 / s times as long. A body in a frame of
 * scale b has its samples b times as far apart, so r is b / s times its covering radius, with the largest b and the least s that there may
 * be where scales are free. What a pose rounds is the caller's to add to r: some 1e-15 of the coordinates.
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
 * Tells the body's covering radius in its own unit of length: in a frame of scale s it is s times that. 0 where it is not known. Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
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

/**
 * Fills `law` with f(t) = 0. `struct_size` is sizeof *law.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
 */
int32_t ko_law_init(struct ko_law *law, size_t struct_size);

/**
 * Makes the motion of a part that stays at a pose: `rotation` [dim * dim], row-major, NULL for none, then `translation` [dim], NULL for 0.
 *
 * `dim` is 2 or 3. x_w = R x + t: the columns of R are where the part's axes point in the world. R is made a rotation to rounding.
 * `*motion` is the caller's to free.
 * Errors: KO_ERR_INVALID_ARGUMENT for a number that is not finite and for R that mirrors, or is off a rotation by more than 1e-6 in an entry of
 * R^T R, telling by how much. Threads: any. Cost: none.
 */
int32_t ko_motion_fixed(uint32_t dim,
                        const double *rotation,
                        const double *translation,
                        struct ko_motion **motion);

/**
 * Makes a slide: at t the part is moved by f(t) times `along` [dim], f being the `law`.
 *
 * `dim` is 2 or 3. `*motion` is the caller's to free. Errors: KO_ERR_INVALID_ARGUMENT for a number that is not finite, and for no law. Threads:
 * any. Cost: none.
 */
int32_t ko_motion_slide(uint32_t dim,
                        const double *along,
                        const struct ko_law *law,
                        struct ko_motion **motion);

/**
 * Makes a turn in the plane about `center` [2], by f(t) radians counter-clockwise, f being the `law`.
 *
 * `*motion` is the caller's to free. Errors: KO_ERR_INVALID_ARGUMENT for a number that is not finite, and for no law. Threads: any. Cost: none.
 */
int32_t ko_motion_turn(const double *center,
                       const struct ko_law *law,
                       struct ko_motion **motion);

/**
 * Makes a screw in space about the line through `point` [3] along `axis` [3]: a turn by f(t) radians, right-handed, and a slide along the axis
 * by `lead` times f(t), f being the `law`.
 *
 * The axis is divided by its length. `lead` is a length a radian; 0 makes a turn. `*motion` is the caller's to free.
 * Errors: KO_ERR_INVALID_ARGUMENT for a number that is not finite, an axis of length 0, and for no law. Threads: any. Cost: none.
 */
int32_t ko_motion_screw(const double *point,
                        const double *axis,
                        double lead,
                        const struct ko_law *law,
                        struct ko_motion **motion);

/**
 * Makes the motion through `n_poses` poses at even times from 0 to 1, pose k at k / (n_poses - 1): `rotations` [dim * dim * n_poses], row-major
 * each, and `translations` [dim * n_poses].
 *
 * `dim` is 2 or 3. Between two poses it is by definition the screw of the smallest turn from one to the other. The arrays are copied.
 * `*motion` is the caller's to free.
 * Errors: KO_ERR_INVALID_ARGUMENT for fewer than 2 poses; for one that is not finite, mirrors, or is not rigid, naming the first, and how far it
 * is off; for a turn of more than 3 radians from a pose to the next, which could be either way round; KO_ERR_OUT_OF_MEMORY. Threads: any.
 * Cost: less than a microsecond a pose.
 */
int32_t ko_motion_sampled(uint32_t dim,
                          const double *rotations,
                          const double *translations,
                          size_t n_poses,
                          struct ko_motion **motion);

/**
 * Makes the motion through `n_poses` poses that `pose` is asked for, in order, at even times from 0 to 1; between two of them it is the screw
 * from one to the other, as in `ko_motion_sampled`.
 *
 * `dim` is 2 or 3. `data` is handed to `pose`, which is called during this call only. `part` and `max_speed` tell a jump: from a pose to the next no
 * point of the part's grid may go more than max_speed times the time between, in lengths by unit of t; NULL and 0: any way is taken for a fast
 * move. `*motion` is the caller's to free; it does not refer to `part`.
 * Errors: those of `ko_motion_sampled`, and KO_ERR_INVALID_ARGUMENT where `pose` does not return 0, with the pose's number and time, where the
 * motion jumps, with the times, the way and what is allowed, for a max_speed below 0, and for one without a part. Threads: any. Cost: the calls,
 * and less than a microsecond a pose.
 */
int32_t ko_motion_from_function(uint32_t dim,
                                ko_pose_function pose,
                                void *data,
                                size_t n_poses,
                                const struct ko_part *part,
                                double max_speed,
                                struct ko_motion **motion);

/**
 * Makes the motions of two wheels that turn against each other, as gears do, about `centers` [4], x y of the first and of the second: the first
 * by `turns` full turns counter-clockwise while t goes from 0 to 1, the second by `ratio` times that clockwise.
 *
 * Parts cut from what they leave of each other have teeth with the pitch radii r_1 = ratio r_2. Both handles are the caller's to free.
 * Errors: KO_ERR_INVALID_ARGUMENT for a number that is not finite and a ratio that is not above 0. Threads: any. Cost: none.
 */
int32_t ko_motion_gears(const double *centers,
                        double turns,
                        double ratio,
                        struct ko_motion **first,
                        struct ko_motion **second);

/**
 * Makes the motions of a planar four-bar linkage: its crank and its rocker turn about `pivots` [4], x y of the crank's and of the rocker's, and
 * a coupler joins their ends.
 *
 * `lengths` [3] are those of crank, coupler and rocker from joint to joint. While t goes from 0 to 1 the crank turns from the angle `from` by
 * `by`, in radians counter-clockwise from the x axis. Seen from the crank's joint towards the rocker's pivot, the rocker's joint lies to the left
 * with `bend` 1, to the right with -1. Each part is given in a frame of its own: crank and rocker with the origin in their pivots and the x axis
 * towards their joints, the coupler with the origin in the crank's joint and the x axis towards the rocker's. The poses are sampled at
 * n_steps + 1 even times, with screws between them: of coupler and rocker these come near to the linkage as 1 / n_steps^2.
 * All three handles are the caller's to free.
 * Errors: KO_ERR_INVALID_ARGUMENT for a length that is not above 0, a number that is not finite, another `bend`, for 0 steps or so few that a bar
 * turns by more than 3 radians in one, and for an angle at which the linkage does not close, naming the first; KO_ERR_OUT_OF_MEMORY. Threads: any.
 * Cost: a microsecond a step.
 */
int32_t ko_motion_four_bar(const double *pivots,
                           const double *lengths,
                           double from,
                           double by,
                           int32_t bend,
                           size_t n_steps,
                           struct ko_motion **crank,
                           struct ko_motion **coupler,
                           struct ko_motion **rocker);

/**
 * Makes the product of two motions, tau(t) = `outer`(t) `inner`(t): what `inner` does is seen from what `outer` moves.
 *
 * A follower on a rocker, say, or a part's first pose before its motion. `*motion` is the caller's to free; it does not refer to the handles.
 * Errors: KO_ERR_INVALID_ARGUMENT for motions of different dimensions, and for a product of more than 1000 motions in all. Threads: any. Cost: none.
 */
int32_t ko_motion_product(const struct ko_motion *outer,
                          const struct ko_motion *inner,
                          struct ko_motion **motion);

/**
 * Makes the inverse of a motion, which undoes it at each time. With a product it gives relative motions, tau_1^-1 tau_2, (8) and (9).
 *
 * `*motion` is the caller's to free; it does not refer to `of`. Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: none.
 */
int32_t ko_motion_inverse(const struct ko_motion *of,
                          struct ko_motion **motion);

/**
 * Frees a motion. NULL is taken. No other thread may be using it.
 */
void ko_motion_free(struct ko_motion *motion);

/**
 * Tells the dimension of a motion, 2 or 3.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
 */
int32_t ko_motion_get_dim(const struct ko_motion *motion, uint32_t *dim);

/**
 * Evaluates a motion at `times` [n_times], each in [0, 1]: `rotations` [dim * dim * n_times], row-major each, and `translations`
 * [dim * n_times].
 *
 * Errors: KO_ERR_INVALID_ARGUMENT, naming the first time outside [0, 1]. Threads: any number at once. Cost: some 100 ns a motion in a product
 * and a time; no allocation, no lock.
 */
int32_t ko_motion_eval(const struct ko_motion *motion,
                       const double *times,
                       size_t n_times,
                       double *rotations,
                       double *translations);

/**
 * Makes a part of `counts` [dim] cells of edge `cell_edge` along each axis, from `corner` [dim] on, its smallest coordinates.
 *
 * `dim` is 2 or 3. `cells` [n_cells], as many as the product of the counts, are KO_CELL_ constants; NULL with n_cells 0: all are free. The arrays
 * are copied. `*part` is the caller's to free.
 * Errors: KO_ERR_INVALID_ARGUMENT for a count of 0, more than 2^32 - 2 cells, an edge that is not above 0, a number that is not finite, another
 * number of cells, or what is no KO_CELL_ constant, naming the first; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: a pass; two bits a cell.
 */
int32_t ko_part_create(uint32_t dim,
                       const double *corner,
                       double cell_edge,
                       const size_t *counts,
                       const uint8_t *cells,
                       size_t n_cells,
                       struct ko_part **part);

/**
 * Frees a part. NULL is taken. No other thread may be using it.
 */
void ko_part_free(struct ko_part *part);

/**
 * Tells the dimension of a part, 2 or 3, and the number of its cells. Either output may be NULL.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for no part. Threads: any. Cost: none.
 */
int32_t ko_part_get_size(const struct ko_part *part, uint32_t *dim, size_t *n_cells);

/**
 * Tells the grid of a part as it was given: `corner` [dim], `*cell_edge`, `counts` [dim]. Each output may be NULL.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for no part. Threads: any. Cost: none.
 */
int32_t ko_part_get_grid(const struct ko_part *part, double *corner, double *cell_edge, size_t *counts);

/**
 * Copies what the part may do with its cells to `cells` [n_cells], KO_CELL_ constants.
 *
 * `n_cells` must be that of `ko_part_get_size`. Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: a pass.
 */
int32_t ko_part_copy_cells(const struct ko_part *part, size_t n_cells, uint8_t *cells);

/**
 * Tells which part of each cell a solid fills, `fractions` [n_cells] in [0, 1]: densities, (A.3) of Morris and Behandish 2022. Here the solid is
 * what `mesh` bounds, in the part's frame.
 *
 * A cell that the surface may pass through is sampled at `samples` points along each of its edges, 1 to 64: fractions are off by about
 * 1 / samples^dim to 1 / samples. What is inside is told by the generalised winding number, for open meshes too, roughly there.
 * `n_cells` must be that of `ko_part_get_size`; whether the part may have a cell does not count. `n_threads` is as elsewhere, and the bits do not
 * depend on it.
 * Errors: KO_ERR_INVALID_ARGUMENT for a mesh of another dimension, samples out of their range, another n_cells; KO_ERR_OUT_OF_MEMORY. Threads: any
 * number at once. Cost: a distance a cell, and samples^dim of them for each that the surface may pass through; the mesh keeps the tree of its
 * distances, about 200 bytes a triangle.
 */
int32_t ko_part_fractions_of_mesh(const struct ko_part *part,
                                  const struct ko_mesh *mesh,
                                  uint32_t samples,
                                  uint32_t n_threads,
                                  size_t n_cells,
                                  double *fractions);

/**
 * The same of the solid that `field` was fitted to: where phi < 0, or phi > 0 with KO_FEASIBLE_INSIDE.
 *
 * `steepness` is at least the length of grad phi on the grid, such as `steepest` and `steepest_beyond` of `ko_field_certify`; of most fields 2 is
 * more than that near the shape. Where it is less, cells that the surface passes through may be taken for full or empty. Errors: those of
 * `ko_part_fractions_of_mesh`; KO_ERR_INVALID_ARGUMENT for a steepness that is not above 0. Threads: any number at once. Cost: a value a cell and a
 * sample.
 */
int32_t ko_part_fractions_of_field(const struct ko_part *part,
                                   const struct ko_field *field,
                                   double steepness,
                                   uint32_t samples,
                                   uint32_t n_threads,
                                   size_t n_cells,
                                   double *fractions);

/**
 * The same of a box along the part's axes, from `box_min` [dim] to `box_max` [dim].
 *
 * Errors: those of `ko_part_fractions_of_mesh`; KO_ERR_INVALID_ARGUMENT for a box that is none. Threads: any number at once. Cost: nanoseconds a
 * cell and a sample.
 */
int32_t ko_part_fractions_of_box(const struct ko_part *part,
                                 const double *box_min,
                                 const double *box_max,
                                 uint32_t samples,
                                 uint32_t n_threads,
                                 size_t n_cells,
                                 double *fractions);

/**
 * The same of a ball, in the plane a disc, around `center` [dim].
 *
 * Errors: those of `ko_part_fractions_of_mesh`; KO_ERR_INVALID_ARGUMENT for a radius that is not above 0. Threads: any number at once. Cost:
 * nanoseconds a cell and a sample.
 */
int32_t ko_part_fractions_of_ball(const struct ko_part *part,
                                  const double *center,
                                  double radius,
                                  uint32_t samples,
                                  uint32_t n_threads,
                                  size_t n_cells,
                                  double *fractions);

/**
 * The same of a cylinder with flat ends, in the plane a strip, whose ends have their middles at `ends` [2 * dim]; `radius` is half the strip's
 * width.
 *
 * Errors: those of `ko_part_fractions_of_mesh`; KO_ERR_INVALID_ARGUMENT for a radius that is not above 0, and ends that are one point. Threads: any
 * number at once. Cost: nanoseconds a cell and a sample.
 */
int32_t ko_part_fractions_of_cylinder(const struct ko_part *part,
                                      const double *ends,
                                      double radius,
                                      uint32_t samples,
                                      uint32_t n_threads,
                                      size_t n_cells,
                                      double *fractions);

/**
 * Makes the mesh that bounds `cells` [n_cells], a set of the part's cells, in the part's frame: closed, in the plane curves with the cells on
 * their left, in space triangles whose normals point outwards.
 *
 * `within` is a KO_WITHIN_ constant. Each vertex is moved `rounds` times, 20 do; with 0 the mesh is the cells' faces. It lies within a cell of
 * these, and is moved into a part by a quarter of its thickness there at most. Every edge has two triangles, every vertex one fan of them; where
 * cells touch by an edge or a corner the mesh may touch itself. It is not proven that moved triangles do not pass through each other. `*mesh` is
 * the caller's to free; a field is fitted to what `ko_mesh_sample` draws from it. `progress` is told of progress with `progress_data`, or NULL.
 * Errors: KO_ERR_INVALID_ARGUMENT for another number of cells, an entry that is not 0 or 1, another `within`; KO_ERR_DEGENERATE for no cells;
 * KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. Threads: any number at once; `progress` is called on the caller's. Cost: some microseconds a face of a
 * cell.
 */
int32_t ko_part_mesh_of_cells(const struct ko_part *part,
                              const uint8_t *cells,
                              size_t n_cells,
                              int32_t within,
                              uint32_t rounds,
                              ko_progress progress,
                              void *progress_data,
                              struct ko_mesh **mesh);

/**
 * The same of the cells whose density is above `level`, with `densities` [n_cells] in [0, 1]; the mesh is drawn to where the density passes it.
 *
 * `level` is in [0, 1), mostly 1/2. With KO_WITHIN_CELLS the mesh lies in those cells. Errors, threads, cost: those of `ko_part_mesh_of_cells`;
 * KO_ERR_INVALID_ARGUMENT for a density outside [0, 1], naming the first, and another level.
 */
int32_t ko_part_mesh_of_densities(const struct ko_part *part,
                                  const double *densities,
                                  size_t n_cells,
                                  double level,
                                  int32_t within,
                                  uint32_t rounds,
                                  ko_progress progress,
                                  void *progress_data,
                                  struct ko_mesh **mesh);

/**
 * Fills `options` with the defaults. `struct_size` is sizeof *options.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
 */
int32_t ko_pair_options_init(struct ko_pair_options *options, size_t struct_size);

/**
 * Fills `options` with the defaults. `struct_size` is sizeof *options.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
 */
int32_t ko_family_options_init(struct ko_family_options *options, size_t struct_size);

/**
 * Fills `options` with the defaults. `struct_size` is sizeof *options.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
 */
int32_t ko_optimise_options_init(struct ko_optimise_options *options, size_t struct_size);

/**
 * Fills `options` with the defaults. `struct_size` is sizeof *options.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
 */
int32_t ko_persistence_options_init(struct ko_persistence_options *options, size_t struct_size);

/**
 * Tells which cells of `still` a moving part passes over: `swept` [n_still] is 1 for each that a cell of `part` among `cells` [n_cells] overlaps
 * at any time, (1) of Morris and Behandish 2022; none is missed, and cells that are only nearly overlapped may be 1 as well.
 *
 * `cells` NULL with n_cells 0: all that the part may have. `motion` and `still_motion` are those of both in the world; NULL: it stays. What `still`
 * may do with its cells does not count. Of the options `slack`, `n_steps`, `n_threads` and `progress` are taken; NULL: the defaults.
 * Errors: KO_ERR_INVALID_ARGUMENT for another dimension or number of cells, an entry that is not 0 or 1, a clearance other than 0, a motion with a
 * number that is not finite; KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. Threads: any number at once; `progress` is called on the caller's. Cost: for
 * each cell and each step of time, and for each cell that it passes over then.
 */
int32_t ko_part_sweep(const struct ko_part *part,
                      const uint8_t *cells,
                      size_t n_cells,
                      const struct ko_motion *motion,
                      const struct ko_part *still,
                      const struct ko_motion *still_motion,
                      const struct ko_pair_options *options,
                      size_t n_still,
                      uint8_t *swept);

/**
 * Takes those cells of `part` out of `kept` [n_cells], a set, that break a rule about a `body` at any time of the motion: what is left is the
 * unsweep, (2), (23) and (24) of Morris and Behandish 2022. Against several bodies, call it for each with the same array.
 *
 * `body_cells` [n_body] are those of the body; NULL with n_body 0: all that it may have. `rule` KO_AVOID: no cell that is left overlaps one of
 * them, or comes nearer than the options' clearance; KO_STAY_IN: none gets out of them, or nearer than that to what is not theirs. It holds for
 * whole cells at all times; cells that only nearly break it may go as well. Cells that the part may not have go; frozen ones that must go are
 * gone too. `motion` and `body_motion` are those of both in the world; NULL: it stays. Of the options `slack`, `n_steps`, `clearance`,
 * `n_threads` and `progress` are taken; NULL: the defaults.
 * Errors: KO_ERR_INVALID_ARGUMENT for another dimension, number of cells or rule, an entry that is not 0 or 1, a clearance below 0, a motion with a
 * number that is not finite; KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. After an error `kept` is as it was. Threads: any number at once; `progress` is
 * called on the caller's. Cost: as `ko_part_sweep`.
 */
int32_t ko_part_unsweep(const struct ko_part *part,
                        const struct ko_motion *motion,
                        const struct ko_part *body,
                        const uint8_t *body_cells,
                        size_t n_body,
                        const struct ko_motion *body_motion,
                        int32_t rule,
                        const struct ko_pair_options *options,
                        size_t n_cells,
                        uint8_t *kept);

/**
 * Makes a pair of two parts and their motions in the world: `motion_1` takes part 1's frame to the world, `motion_2` part 2's; NULL: the part
 * stays. `options` NULL: the defaults, which make a conflict graph and no measures.
 *
 * Conflicts of overlap are between cells that overlap at any time, or come nearer than the clearance: none is missed, by separating axes at steps of
 * time between which displacements are bounded; touching is no overlap. `*pair` is the caller's to free; it refers to neither parts nor motions.
 * Returns KO_NEVER_MEET, a success, where no cell of a part meets one of the other, which mostly is a mistake in frames or motions.
 * Errors: KO_ERR_INVALID_ARGUMENT for different dimensions, an option out of its range, a motion with a number that is not finite or so fast that
 * it takes more than 10 million steps, and for frozen cells of both parts that collide, naming two of them, and when and where they do;
 * KO_ERR_OUT_OF_MEMORY with the bytes that it would take; KO_ERR_UNSUPPORTED for an option that this library does not know; KO_ERR_CANCELLED.
 * Threads: any; `progress` is called on the caller's. Cost: of the graph for each cell of the part with fewer of them and each step, and for each
 * cell that it passes over then, some nanoseconds; of measures some nanoseconds for each cell and each of K steps, and two bytes a visit.
 */
int32_t ko_pair_create(const struct ko_part *part_1,
                       const struct ko_motion *motion_1,
                       const struct ko_part *part_2,
                       const struct ko_motion *motion_2,
                       const struct ko_pair_options *options,
                       struct ko_pair **pair);

/**
 * Frees a pair. NULL is taken. No other thread may be using it.
 */
void ko_pair_free(struct ko_pair *pair);

/**
 * Tells what a pair is; `report_size` is sizeof *report.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT. Threads: any number at once. Cost: a pass over the sets of cells.
 */
int32_t ko_pair_get_report(const struct ko_pair *pair, size_t report_size, struct ko_pair_report *report);

/**
 * Evaluates the collision measures (29) and (30) of Morris and Behandish 2022 for `densities_1` [n_1] and `densities_2` [n_2]: `*g21`, the area or
 * volume of part 2 that is in part 1, times the fraction of the motion that it is; `*g12`, that of part 1 in part 2. Either may be NULL.
 *
 * The weights are (A.14) to (A.17) with densities as fractions of cells, w^12 = eps_2^dim n_12 / K: unit of length to the power dim. Both are 0 for
 * densities of pairs without KO_CONFLICTS_OF_MEASURE. A density must be 0 where the part may not have the cell.
 * Errors: KO_ERR_INVALID_ARGUMENT for a pair without measures, another number of cells, or a density outside [0, 1], naming the first;
 * KO_ERR_OUT_OF_MEMORY. Threads: any number at once; `n_threads` is as elsewhere, and the bits do not depend on it. Cost: some nanoseconds a
 * visit of `ko_pair_get_report`; a number a cell.
 */
int32_t ko_pair_measures(const struct ko_pair *pair,
                         const double *densities_1,
                         size_t n_1,
                         const double *densities_2,
                         size_t n_2,
                         uint32_t n_threads,
                         double *g21,
                         double *g12);

/**
 * Evaluates the local measures (12) and (13) of Morris and Behandish 2022: `l21` [n_1], for each cell of part 1 the fraction of the motion that its
 * centre is in part 2, with part 2's densities; `l12` [n_2], for those of part 2 in part 1. Either may be NULL.
 *
 * A cell that its part may not have gets 0. Errors, threads, cost: those of `ko_pair_measures`.
 */
int32_t ko_pair_local_measures(const struct ko_pair *pair,
                               const double *densities_1,
                               size_t n_1,
                               const double *densities_2,
                               size_t n_2,
                               uint32_t n_threads,
                               double *l21,
                               double *l12);

/**
 * Evaluates the sensitivities (31) and (32) of Morris and Behandish 2022: derivatives of g_21 by both parts' densities, `d21_d1` [n_1] and `d21_d2`
 * [n_2], and of g_12, `d12_d1` [n_1] and `d12_d2` [n_2].
 *
 * The measures are bilinear: g_21 is the sum of d21_d2 times densities_2, g_12 that of d12_d1 times densities_1. The right-hand sides of the paper's
 * (32) are the wrong way round; here dg_12/drho_1 = (w^21)^T rho_2, dg_12/drho_2 = w^21 rho_1.
 * Errors, threads: those of `ko_pair_measures`. Cost: twice that.
 */
int32_t ko_pair_sensitivities(const struct ko_pair *pair,
                              const double *densities_1,
                              size_t n_1,
                              const double *densities_2,
                              size_t n_2,
                              uint32_t n_threads,
                              double *d21_d1,
                              double *d21_d2,
                              double *d12_d1,
                              double *d12_d2);

/**
 * Evaluates the topological sensitivities (B.1) and (B.2) of Morris and Behandish 2022: how g_21 changes, by the area or volume, as a cell is put
 * to a part or taken from it, `d21_d1` [n_1] and `d21_d2` [n_2], and g_12, `d12_d1` [n_1] and `d12_d2` [n_2].
 *
 * `change` is a KO_CHANGE_ constant. They have no unit: what (B.5), (B.6) and (B.12) tend to, the fraction of the motion that the place is in the
 * other part. Of a cell that the part fills there is nothing to put, of one that it has not there is nothing to take: 0. In cells that the
 * surface cuts the paper leaves the limit open; here they have their shares, 1 - density and density.
 * Errors, threads, cost: those of `ko_pair_sensitivities`; KO_ERR_INVALID_ARGUMENT for another change.
 */
int32_t ko_pair_topological_sensitivities(const struct ko_pair *pair,
                                          const double *densities_1,
                                          size_t n_1,
                                          const double *densities_2,
                                          size_t n_2,
                                          int32_t change,
                                          uint32_t n_threads,
                                          double *d21_d1,
                                          double *d21_d2,
                                          double *d12_d1,
                                          double *d12_d2);

/**
 * Tells the initially colliding subdomains, (33) to (36) of Morris and Behandish 2022: the cells of each part that conflict with cells that the
 * other may have, sets `cells_1` [n_1] and `cells_2` [n_2]. Either may be NULL.
 *
 * Only they can have to go. Cells that may not be beside frozen ones of the other part are left out. (33) and (34) with one direction miss cells
 * whose centres the other's cells meet while theirs meet none; here it is the union of both. Errors: KO_ERR_INVALID_ARGUMENT for a pair without
 * conflict graph, and another number of cells. Threads: any number at once. Cost: a pass.
 */
int32_t ko_pair_colliding(const struct ko_pair *pair,
                          size_t n_1,
                          size_t n_2,
                          uint8_t *cells_1,
                          uint8_t *cells_2);

/**
 * Tells of the sets `set_1` [n_1] and `set_2` [n_2], whatever they are, the areas or volumes `volumes` [2] of what is left of the colliding
 * cells, `*gamma` = V_2 / (V_1 + V_2) as in (37d) of Morris and Behandish 2022, NaN where nothing is left, and `*n_lost`, the cells of part 2
 * in its set that conflict with cells of part 1 in its: 0 of a pair that never collides. Each output may be NULL.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for a pair without conflict graph, another number of cells, an entry that is not 0 or 1. Threads: any number
 * at once. Cost: a pass over the edges of part 1's set.
 */
int32_t ko_pair_volumes(const struct ko_pair *pair,
                        const uint8_t *set_1,
                        size_t n_1,
                        const uint8_t *set_2,
                        size_t n_2,
                        double *volumes,
                        double *gamma,
                        size_t *n_lost);

/**
 * Closes a pair: from any sets to one that never collides and cannot grow, `cells_1` [n_1] and `cells_2` [n_2]; `*gamma`, which may be NULL, is
 * what it reached, as `ko_pair_volumes` tells.
 *
 * `from` is the part whose set is kept as far as the other's frozen cells let it, 1 or 2; 0: that with the larger area or volume. With A_i the
 * cells that part i may have beside the frozen ones of the other, and N(.) the cells in conflict: from part 1, S_2 = A_2 \ N(S_1), then S_1 =
 * A_1 \ N(S_2); maximal pairs of Definition 2 of Morris and Behandish 2022. With all of part 1 and from 1 it is the unsweep, gamma = 0; all of
 * part 2 and from 2 give gamma = 1. `set_1` [n_1] and `set_2` [n_2] are sets; that of the part that one does not begin with may be NULL, unless
 * `from` is 0. Errors: KO_ERR_INVALID_ARGUMENT for a pair without conflict graph, another number of cells, an entry that is not 0 or 1, another
 * `from`; KO_ERR_OUT_OF_MEMORY. Threads: any number at once. Cost: two passes over the edges.
 */
int32_t ko_pair_close(const struct ko_pair *pair,
                      const uint8_t *set_1,
                      const uint8_t *set_2,
                      uint32_t from,
                      size_t n_1,
                      size_t n_2,
                      uint8_t *cells_1,
                      uint8_t *cells_2,
                      double *gamma);

/**
 * Finds the pair of the greatest weight among all that never collide, `cells_1` [n_1] and `cells_2` [n_2]: a minimum cut of the conflict graph,
 * which is globally optimal. It is maximal too.
 *
 * `weights_1` [n_1] and `weights_2` [n_2], at least 0, are what cells count for, such as an outside objective's sensitivities; NULL: the cell's
 * area or volume. `*weight` is the pair's, and `*bound`, all cells' less the flow that meets the cut, what no pair weighs more than: the same,
 * which is the proof. Either may be NULL. Weights that are multiples of a common unit, down to 1/64 of the smallest, are taken as they are;
 * others are rounded up to multiples of 2^-40 of their sum. `*gamma`, which may be NULL, is what the pair reached, by volume, as
 * `ko_pair_volumes` tells. Of several best pairs it is always the same.
 * `options` NULL: the defaults; `gap` does not count. With symmetries it is the best of the pairs that all maps carry onto themselves; the graph is
 * folded by them anew in each call, by a pass over its edges for each map, and in the memory of a graph of orbits.
 * Errors: KO_ERR_INVALID_ARGUMENT for a pair without conflict graph, another number of cells, a weight that is below 0 or not finite, naming
 * the first, a map that carries a cell onto none or a conflict onto none, naming them, and a frozen cell onto one that its part may not have; KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. Threads: any number at once; the call takes one; `progress` is called on it. Cost: some
 * seconds for 160,000 cells a part and 2 10^7 edges, two gears; a few numbers a cell and a flow between two.
 */
int32_t ko_pair_cut(const struct ko_pair *pair,
                    const double *weights_1,
                    const double *weights_2,
                    const struct ko_family_options *options,
                    size_t n_1,
                    size_t n_2,
                    uint8_t *cells_1,
                    uint8_t *cells_2,
                    double *weight,
                    double *bound,
                    double *gamma);

/**
 * Finds a family of pairs that never collide, one for each of `gammas` [n_gammas] in [0, 1], (25) and (26) of Morris and Behandish 2022: sets
 * `cells_1` [n_gammas * n_1] and `cells_2` [n_gammas * n_2], a row each for every gamma.
 *
 * `reached` [n_gammas] are the gammas of the pairs, V_2 / (V_1 + V_2) as in (37d), `volumes` [2 * n_gammas] V_1 and V_2, what is left of the
 * colliding cells, and `bounds` [n_gammas] what no pair of the gamma that was asked for has for V_1 + V_2. Each of these may be NULL. Volumes
 * are by `weights_1` [n_1] and `weights_2` [n_2], at least 0; NULL: the cell's area or volume. Weights that are no multiples of a common unit,
 * see `ko_pair_cut`, are rounded up to multiples of 2^-32 of their sum. gamma 0 and 1 are the unsweeps. A gamma that no pair reaches gets one
 * near to it. `options` NULL: the defaults.
 * Errors: those of `ko_pair_cut`; KO_ERR_INVALID_ARGUMENT for a gamma outside [0, 1], naming the first, and a gap outside [0, 1). Threads: as
 * `ko_pair_cut`. Cost: some cuts, not one for each gamma; n_1 + n_2 bytes a gamma and more inside.
 */
int32_t ko_pair_family(const struct ko_pair *pair,
                       const double *weights_1,
                       const double *weights_2,
                       const double *gammas,
                       size_t n_gammas,
                       const struct ko_family_options *options,
                       size_t n_1,
                       size_t n_2,
                       uint8_t *cells_1,
                       uint8_t *cells_2,
                       double *reached,
                       double *volumes,
                       double *bounds);

/**
 * Tells the gaps between the sets `set_1` [n_1] and `set_2` [n_2] of a pair that does not collide, at `n_times` even times (k + 1/2) / n_times:
 * figure 11 of Morris and Behandish 2022.
 *
 * `gaps` [n_times] are the distances between the nearest cells, 0 where they touch, `cells` [2 * n_times] these cells of part 1 and of part 2,
 * and `places` [dim * n_times] points between them, in part 1's frame. `*largest` and `*mean` are those of the gaps. Each output may be NULL.
 * `progress` is told of progress with `progress_data`, or NULL.
 * Errors: KO_ERR_INVALID_ARGUMENT for another number of cells, an entry that is not 0 or 1, for no times or more than 10 million;
 * KO_ERR_DEGENERATE where a part has no cells; KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. Threads: any number at once; `progress` is called on the
 * caller's; `n_threads` is as elsewhere. Cost: a look at each boundary cell of part 2 a time, and a closer one at few of them; a number a cell
 * of part 1.
 */
int32_t ko_pair_contact(const struct ko_pair *pair,
                        const uint8_t *set_1,
                        size_t n_1,
                        const uint8_t *set_2,
                        size_t n_2,
                        size_t n_times,
                        uint32_t n_threads,
                        ko_progress progress,
                        void *progress_data,
                        double *gaps,
                        size_t *cells,
                        double *places,
                        double *largest,
                        double *mean);

/**
 * Finds among the pairs of the greatest weight one that keeps better in touch than `set_1` [n_1] and `set_2` [n_2], which is one of them, such
 * as `ko_pair_cut` gives: `cells_1` [n_1] and `cells_2` [n_2], as heavy, free of collisions and maximal.
 *
 * Of gaps g at even times, as `ko_pair_contact` tells them, persistence is the mean of 1 / (1 + g / h), with h the options' scale: 1 where the
 * parts never part, 1/2 where they always are h from each other. `*before` is that of the sets, `*after` that of the cells, at least the same,
 * and `*n_tries` counts the pairs that were tried; each may be NULL. It is a local search, around the largest gaps. `weights_1` and
 * `weights_2` are those that the sets are of the greatest weight by, as of `ko_pair_cut`; `options` NULL: the defaults.
 * Errors: KO_ERR_INVALID_ARGUMENT for a pair without conflict graph, another number of cells, an entry that is not 0 or 1, sets that are not of
 * the greatest weight, telling both weights in the cut's units, an option out of its range; KO_ERR_DEGENERATE where a part has no cells;
 * KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. Threads: any number at once; `progress` is called on the caller's. Cost: a cut, and
 * `ko_pair_contact` a try.
 */
int32_t ko_pair_more_persistent(const struct ko_pair *pair,
                                const uint8_t *set_1,
                                const uint8_t *set_2,
                                const double *weights_1,
                                const double *weights_2,
                                const struct ko_persistence_options *options,
                                size_t n_1,
                                size_t n_2,
                                uint8_t *cells_1,
                                uint8_t *cells_2,
                                double *before,
                                double *after,
                                size_t *n_tries);

/**
 * Optimises densities by the method of moving asymptotes, (37) to (43) of Morris and Behandish 2022, and closes what it gives: `cells_1` [n_1]
 * and `cells_2` [n_2], a pair that never collides and cannot grow.
 *
 * It maximises V_1 + V_2 over the densities of the colliding cells with g_21 = 0, g_12 = 0 and gamma V_1 = (1 - gamma) V_2, each within
 * `feasibility`; then densities above 1/2 are closed in the pair's conflict graph. `densities_1` [n_1] and `densities_2` [n_2] get what it ends
 * with, and `history` [5 * (max_iterations + 1)] a row for the beginning and each iteration: V_1, V_2, g_21, g_12, and the part of the
 * colliding volume that changed; rows behind the last are left as they are. Each of these three may be NULL. `options` NULL: the defaults;
 * `report_size` is sizeof *report. A minimum cut, `ko_pair_cut` or `ko_pair_family`, gives better pairs sooner; this is for comparison, and for
 * objectives of one's own. Returns KO_BUDGET_REACHED, a success, where iterations ended before the tolerance was reached. Errors:
 * KO_ERR_INVALID_ARGUMENT for a pair without measures or without conflict graph, another number of cells, an option out of its range;
 * KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. Threads: any number at once; `progress` is called on the caller's. Cost: sensitivities an iteration;
 * some 30 numbers a colliding cell.
 */
int32_t ko_pair_optimise(const struct ko_pair *pair,
                         const struct ko_optimise_options *options,
                         size_t n_1,
                         size_t n_2,
                         double *densities_1,
                         double *densities_2,
                         uint8_t *cells_1,
                         uint8_t *cells_2,
                         double *history,
                         size_t report_size,
                         struct ko_optimise_report *report);

/**
 * Fills `options` with the defaults. `struct_size` is sizeof *options.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
 */
int32_t ko_arrange_options_init(struct ko_arrange_options *options, size_t struct_size);

/**
 * Makes an assembly of `parts` [n_parts] and `motions` [n_parts]: `motions[k]` takes part k's frame to the world; NULL: the part stays.
 *
 * Conflicts are those of overlap, as `ko_pair_create` makes them, of all pairs of parts whose swept boxes meet. Of `options` `slack`, `n_steps`,
 * `clearance`, `max_bytes`, `n_threads` and `progress` are taken; NULL: the defaults. `max_bytes` holds for the graphs of pairs and of all
 * together. `*assembly` is the caller's to free; it refers to neither parts nor motions.
 * Returns KO_NEVER_MEET, a success, where no cell meets one of another part. Errors: KO_ERR_INVALID_ARGUMENT for no parts, different dimensions,
 * more than 2^32 - 2 cells in all, other conflicts or measures asked for, and for frozen cells of two parts that collide, naming two of them, and
 * when and where they do; the others of `ko_pair_create`. Threads: any; `progress` is called on the caller's. Cost: that of `ko_pair_create` for
 * each pair that may meet.
 */
int32_t ko_assembly_create(const struct ko_part *const *parts,
                           const struct ko_motion *const *motions,
                           size_t n_parts,
                           const struct ko_pair_options *options,
                           struct ko_assembly **assembly);

/**
 * Frees an assembly. NULL is taken. No other thread may be using it.
 */
void ko_assembly_free(struct ko_assembly *assembly);

/**
 * Tells what an assembly is; `report_size` is sizeof *report.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT. Threads: any number at once. Cost: none.
 */
int32_t ko_assembly_get_report(const struct ko_assembly *assembly,
                               size_t report_size,
                               struct ko_assembly_report *report);

/**
 * Copies the pairs of parts of which some cells conflict to `meetings` [2 * n_meetings]: numbers of parts, from 0 on, the smaller one first.
 *
 * `n_meetings` must be that of `ko_assembly_get_report`. Errors: KO_ERR_INVALID_ARGUMENT. Threads: any number at once. Cost: a copy.
 */
int32_t ko_assembly_copy_meetings(const struct ko_assembly *assembly,
                                  size_t n_meetings,
                                  size_t *meetings);

/**
 * Closes an assembly: from any `sets` [n_cells] to `cells` [n_cells], parts that never collide and of which none can grow.
 *
 * Part by part in the `order` [n_parts], numbers from 0 on, each keeps of its set what those before it leave; then all take up what is left.
 * NULL: in the order in which they were given. `n_cells` must be that of `ko_assembly_get_report`. Errors: KO_ERR_INVALID_ARGUMENT for another
 * number of cells, an entry that is not 0 or 1, an order that does not name each part once; KO_ERR_OUT_OF_MEMORY. Threads: any number at once.
 * Cost: two passes over the edges.
 */
int32_t ko_assembly_close(const struct ko_assembly *assembly,
                          const uint8_t *sets,
                          const size_t *order,
                          size_t n_cells,
                          uint8_t *cells);

/**
 * Finds parts of great weight among all that never collide, `cells` [n_cells], of which none can grow; the heaviest where parts can be given two
 * colours so that those that meet differ, as in a train of gears.
 *
 * `weights` [n_cells], at least 0, are what cells count for; NULL: the cell's area or volume. They are rounded as by `ko_pair_cut`. `*weight` is
 * that of all cells, and `*bound` what no parts weigh more than, by the double cover of the conflict graph (Nemhauser and Trotter 1975): at most
 * bound - weight is lost. `*n_cuts` counts the cuts that it took. Each of the three may be NULL. `options` NULL: the defaults. Where three parts
 * meet each other, teams of two colours get a cut in turn until none gains.
 * Errors: KO_ERR_INVALID_ARGUMENT for another number of cells, a weight that is below 0 or not finite, naming the first, 0 rounds or starts;
 * KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. Threads: any number at once; the call takes one; `progress` is called on it. Cost: cuts.
 */
int32_t ko_assembly_arrange(const struct ko_assembly *assembly,
                            const double *weights,
                            const struct ko_arrange_options *options,
                            size_t n_cells,
                            uint8_t *cells,
                            double *weight,
                            double *bound,
                            size_t *n_cuts);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* KEEPOUT_H */
