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
 * Points that disagree with the others count for less, at last for nothing: against noise, outliers and wrong normals. Two solves more, the
 * first of them much smoother.
 */
#define KO_REWEIGHT_ROBUST 1

/**
 * Points of a surface in space (dim 3) or of a curve in the plane (dim 2) with unit normals. Freed by `ko_cloud_free`.
 */
typedef struct ko_cloud ko_cloud;

/**
 * A level-set function phi, close to the signed distance to a shape. Freed by `ko_field_free`.
 */
typedef struct ko_field ko_field;

/**
 * A triangulated surface in space (dim 3), or polylines in the plane (dim 2). Freed by `ko_mesh_free`.
 */
typedef struct ko_mesh ko_mesh;

/**
 * What can be said of a mesh. Filled by `ko_mesh_get_report`. In the plane read segment for triangle, end of a segment for edge, length for
 * area, area for volume; entries along z are 0.
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
 * Called on the caller's thread with the fraction done in [0, 1], the stage's name (valid during the call) and `progress_data`; not 0 cancels.
 * It must not unwind, throw or jump out.
 */
typedef int32_t (*ko_progress)(double fraction, const char *stage, void *data);

/**
 * Options of `ko_field_fit`. Initialise by `ko_fit_options_init`, then set what shall differ. Weights have no unit: lengths are taken in
 * units of D, the diagonal of the cloud's bounding box.
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
     * Rounds in which points are weighted anew, as `reweighting` says; at most 100. 0: the paper's fit. Default 3.
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
     * What the rounds of reweighting are for: KO_REWEIGHT_LARGEST (default) or KO_REWEIGHT_ROBUST.
     */
    int32_t reweighting;
    /**
     * Must be 0.
     */
    uint32_t reserved_2;
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
     * Control points along x, y, z; an axis of n has n - 3 cells.
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
     * Bytes that the field holds.
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
     * Seconds to sort the points and build the system.
     */
    double seconds_assembly;
    /**
     * Seconds of the solve.
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
} ko_fit_report;

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
 * `loop_starts` begins with 0 and ascends. `closed` 1: each polyline goes back to its first point, which may be given again as its last; 0:
 * none does. A solid lies on the left of closed polylines: counter-clockwise around it, clockwise around a hole in it. A point that repeats
 * the one before it is dropped. The arrays are copied. `*mesh` is the caller's to free.
 * Errors: KO_ERR_INVALID_ARGUMENT for a point that is not finite, starts that do not ascend, fewer than 2 points, closed 3; for polylines
 * that cross, touch or overlap themselves or each other, with the segments and the place; for loops right inside one another that run the
 * same way, naming the one to turn around; KO_ERR_OUT_OF_MEMORY. Threads: any.
 * Cost: O(n_points log n_points) where segments are short, and the number of loops times that of the segments below each one's leftmost
 * point.
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
 * Normals are smooth across edges, in the plane corners, of less than 40 degrees and sharp across others. The cloud remembers triangle and barycentric
 * coordinates of each point: `ko_cloud_copy_origins`. The same mesh, count and seed give the same bits. `*cloud` is the caller's to free.
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
 * The side is that of the generalised winding number (Jacobson et al. 2013), inside from 1/2 on, so that open meshes have sides too.
 * Errors: KO_ERR_INVALID_ARGUMENT, naming the first point that is not finite; KO_ERR_OUT_OF_MEMORY for the tree.
 * Threads: any number at once. Cost: O(log n_triangles) a point; the first call on a mesh builds its tree, O(n_triangles log n_triangles).
 */
int32_t ko_mesh_signed_distance(const struct ko_mesh *mesh,
                                const double *points,
                                size_t n_points,
                                double *distances);

/**
 * Makes a cloud from `points` [dim * n_points] with `normals` [dim * n_points] out of the solid, of any length but 0.
 *
 * `dim` is 2 or 3. This version needs normals: KO_ERR_UNSUPPORTED answers NULL normals (to be estimated). The arrays are copied. `*cloud` is the caller's to free. Errors: KO_ERR_INVALID_ARGUMENT for no points, for a point or normal that is not finite and for
 * a normal of length 0, naming the first; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: O(n_points).
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
 * A point of weight 0 takes no part in a fit, as if it were not there. `n_points` must be that of `ko_cloud_get_size`. The array is copied.
 * Errors: KO_ERR_INVALID_ARGUMENT for a weight that is negative, not a number or above 1e100, naming the first, and where all are 0;
 * KO_ERR_OUT_OF_MEMORY. After an error the weights are as they were. No other thread may be using the cloud. Cost: a copy.
 */
int32_t ko_cloud_set_weights(struct ko_cloud *cloud,
                             const double *weights,
                             size_t n_points);

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
 * `*field` is the caller's to free; it does not refer to the cloud.
 * Errors: KO_ERR_INVALID_ARGUMENT for an option out of its range or D outside [1e-90, 1e90], KO_ERR_DEGENERATE for points that are all
 * equal and for normals that cancel out, KO_ERR_UNSUPPORTED for an option that this library does not know, KO_ERR_OUT_OF_MEMORY with the
 * bytes that it would take, KO_ERR_NOT_CONVERGED, KO_ERR_CANCELLED.
 * Threads: any; `progress` is called on the caller's. Cost: an iteration takes some 70 ns a point and 40 ns a control point on one
 * thread; a few hundred are usual. Memory: about 600 bytes a point and 200 a control point.
 */
int32_t ko_field_fit(const struct ko_cloud *cloud,
                     const struct ko_fit_options *options,
                     struct ko_field **field);

/**
 * Evaluates the field at `points` [dim * n_points]: `values` [n_points] in the cloud's unit of length, `gradients` [dim * n_points],
 * `hessians` by rows of the upper triangle, in space [6 * n_points], xx xy xz yy yz zz, in the plane [3 * n_points], xx xy yy.
 *
 * Each output may be NULL. Analytic derivatives of (5). Outside the box, where (5) ends, the field goes on, C2 and growing like a distance:
 * with t the distance beyond a face along an axis, l a quarter of the cell's edge there, s = l tanh(t / l), P the boundary cell's
 * polynomial, r the length of the vector of t - s over the axes, L the box's diagonal and m the mean of phi over the faces,
 *     phi = m + (P(face + s) - m) L^2 / (L^2 + r^2) + sigma r.
 * sigma is the sign of m: for a closed shape +1 when feasible is outside, -1 when it is inside, so |phi| grows on the way out, and the
 * gradient tends to length 1. Where |m| is at most half the mean of |phi| on the faces (a sheet that reaches the box), m = 0 and
 * sigma = tanh(P / longest cell edge), steep where P crosses 0. `ko_field_outside_box` tells which points are outside.
 * Errors: KO_ERR_INVALID_ARGUMENT, naming the first point that is not finite or has a coordinate beyond 1e150; outputs are
 * unspecified then.
 * Threads: any number at once. Cost: about 50 ns a point with gradient on one thread in cache; no allocation, no lock.
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
 * Threads: any number at once. Cost: starts the threads and joins them, which takes some 100 microseconds and memory: for batches of many
 * thousand points.
 */
int32_t ko_field_eval_parallel(const struct ko_field *field,
                               const double *points,
                               size_t n_points,
                               double *values,
                               double *gradients,
                               double *hessians,
                               uint32_t n_threads);

/**
 * Writes to `outside` [n_points] 1 for each of `points` [dim * n_points] outside the field's box, 0 for each inside or on a face.
 *
 * Errors: KO_ERR_INVALID_ARGUMENT, naming the first point that is not finite or has a coordinate beyond 1e150. Threads: any number at once.
 * No allocation, no lock.
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

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* KEEPOUT_H */
