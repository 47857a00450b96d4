! Keepout for Fortran 2008, over keepout.h, whose docs hold here too. Compile this file with the program, and link libkeepout.
! SPDX-License-Identifier: Apache-2.0 OR MIT
!
! Module keepout_c: the C calls, structs and constants under their own names.
! Module keepout: those, and handles that free themselves, arrays that tell their sizes, messages as Fortran strings.
!
! Arrays. Points are (dim, n): column by column that is C's row-major [n x dim], so nothing is copied or transposed. Hessians are
!   (dim (dim + 1) / 2, n). An array section that is not contiguous is copied by the compiler on its way.
! Indices (triangles, loop_starts, origins, frames, variables, values) count from 0, as in C.
! Unsigned numbers of C are integers of the same size here.

module keepout_c
  use, intrinsic :: iso_c_binding
  implicit none

  integer(c_int32_t), parameter :: KO_OK = 0
  integer(c_int32_t), parameter :: KO_OPEN_AT_BOX = 1
  integer(c_int32_t), parameter :: KO_BUDGET_REACHED = 2
  integer(c_int32_t), parameter :: KO_SIDE_NOT_CERTIFIED = 3
  integer(c_int32_t), parameter :: KO_NEVER_MEET = 4
  integer(c_int32_t), parameter :: KO_ERR_INVALID_ARGUMENT = -1
  integer(c_int32_t), parameter :: KO_ERR_OUT_OF_MEMORY = -2
  integer(c_int32_t), parameter :: KO_ERR_IO = -3
  integer(c_int32_t), parameter :: KO_ERR_FORMAT = -4
  integer(c_int32_t), parameter :: KO_ERR_UNSUPPORTED = -5
  integer(c_int32_t), parameter :: KO_ERR_DEGENERATE = -6
  integer(c_int32_t), parameter :: KO_ERR_NOT_CONVERGED = -7
  integer(c_int32_t), parameter :: KO_ERR_CANCELLED = -8
  integer(c_int32_t), parameter :: KO_ERR_INTERNAL = -9
  ! KO_ABI_VERSION of C: Fortran does not tell that name from the function's.
  integer(c_int32_t), parameter :: KO_MODULE_ABI_VERSION = 0
  integer(c_int64_t), parameter :: KO_CAPABILITY_3D = 1
  integer(c_int64_t), parameter :: KO_CAPABILITY_GZIP = 2
  integer(c_int64_t), parameter :: KO_CAPABILITY_2D = 4
  integer(c_int8_t), parameter :: KO_POINT_COPY = 1
  integer(c_int8_t), parameter :: KO_POINT_OUTLIER = 2
  integer(c_int8_t), parameter :: KO_POINT_DEGENERATE = 4
  integer(c_int8_t), parameter :: KO_POINT_DOUBTFUL = 8
  integer(c_int32_t), parameter :: KO_FEASIBLE_OUTSIDE = 0
  integer(c_int32_t), parameter :: KO_FEASIBLE_INSIDE = 1
  integer(c_int32_t), parameter :: KO_REWEIGHT_LARGEST = 0
  integer(c_int32_t), parameter :: KO_REWEIGHT_ROBUST = 1
  integer(c_int32_t), parameter :: KO_REWEIGHT_KEEP = 2
  integer(c_int32_t), parameter :: KO_AGGREGATE_NONE = 0
  integer(c_int32_t), parameter :: KO_AGGREGATE_KS = 1
  integer(c_int32_t), parameter :: KO_AGGREGATE_INDUCED_EXPONENTIAL = 2
  integer(c_int32_t), parameter :: KO_AGGREGATE_P_NORM = 3
  integer(c_int32_t), parameter :: KO_AGGREGATE_MINIMUM = 4
  integer(c_int32_t), parameter :: KO_BELOW = 0
  integer(c_int32_t), parameter :: KO_ABOVE = 1
  integer(c_int32_t), parameter :: KO_LEAST = 0
  integer(c_int32_t), parameter :: KO_LARGEST = 1
  integer(c_int32_t), parameter :: KO_ROTATION_NONE = 0
  integer(c_int32_t), parameter :: KO_ROTATION_QUATERNION = 1
  integer(c_int32_t), parameter :: KO_ROTATION_VECTOR = 2
  integer(c_int32_t), parameter :: KO_ROTATION_ANGLE = 3
  integer(c_int32_t), parameter :: KO_SCALE_ONE = 0
  integer(c_int32_t), parameter :: KO_SCALE_FREE = 1
  integer(c_int32_t), parameter :: KO_WORLD = 0
  integer(c_int32_t), parameter :: KO_EXPLICIT_HICKEN_KAUR_LINEAR = 0
  integer(c_int32_t), parameter :: KO_EXPLICIT_HICKEN_KAUR_QUADRATIC = 1
  integer(c_int32_t), parameter :: KO_EXPLICIT_LIN = 2
  integer(c_int32_t), parameter :: KO_EXPLICIT_NEAREST_PLANE = 3
  integer(c_int32_t), parameter :: KO_EXPLICIT_NEAREST_POINT = 4
  integer(c_int8_t), parameter :: KO_CELL_FORBIDDEN = 0
  integer(c_int8_t), parameter :: KO_CELL_FREE = 1
  integer(c_int8_t), parameter :: KO_CELL_FROZEN = 2
  integer(c_int32_t), parameter :: KO_WITHIN_CELLS = 0
  integer(c_int32_t), parameter :: KO_WITHIN_ANYWHERE = 1
  integer(c_int32_t), parameter :: KO_CONFLICTS_OF_OVERLAP = 0
  integer(c_int32_t), parameter :: KO_CONFLICTS_OF_MEASURE = 1
  integer(c_int32_t), parameter :: KO_CONFLICTS_NONE = 2
  integer(c_int32_t), parameter :: KO_AVOID = 0
  integer(c_int32_t), parameter :: KO_STAY_IN = 1
  integer(c_int32_t), parameter :: KO_CHANGE_PUT = 0
  integer(c_int32_t), parameter :: KO_CHANGE_TAKE = 1

  type, bind(c) :: ko_mesh_report
    integer(c_size_t) :: struct_size
    integer(c_int64_t) :: n_vertices
    integer(c_int64_t) :: n_triangles
    integer(c_int64_t) :: n_components
    integer(c_int64_t) :: n_boundary_edges
    integer(c_int64_t) :: n_non_manifold_edges
    integer(c_int64_t) :: n_non_manifold_vertices
    integer(c_int64_t) :: n_degenerate
    integer(c_int64_t) :: n_duplicate
    integer(c_int64_t) :: n_unreferenced
    integer(c_int32_t) :: closed
    integer(c_int32_t) :: oriented
    integer(c_int32_t) :: manifold
    integer(c_int32_t) :: inside_out
    real(c_double) :: bounds_min(3)
    real(c_double) :: bounds_max(3)
    real(c_double) :: area
    real(c_double) :: volume
  end type

  ! Made by keepout_normal_options() with the defaults.
  type, bind(c) :: ko_normal_options
    integer(c_size_t) :: struct_size
    integer(c_int32_t) :: neighbours
    integer(c_int32_t) :: n_threads
    real(c_double) :: outlier_factor
    integer(c_int64_t) :: memory_limit
    type(c_funptr) :: progress
    type(c_ptr) :: progress_data
  end type

  type, bind(c) :: ko_normal_report
    integer(c_size_t) :: struct_size
    integer(c_int64_t) :: n_components
    integer(c_int64_t) :: n_copies
    integer(c_int64_t) :: n_outliers
    integer(c_int64_t) :: n_degenerate
    integer(c_int64_t) :: n_doubtful
    real(c_double) :: agreement
    real(c_double) :: seconds
  end type

  ! Made by keepout_smooth_options() with the defaults.
  type, bind(c) :: ko_smooth_options
    integer(c_size_t) :: struct_size
    integer(c_int32_t) :: neighbours
    integer(c_int32_t) :: rounds
    integer(c_int32_t) :: n_threads
    integer(c_int32_t) :: reserved
    type(c_funptr) :: progress
    type(c_ptr) :: progress_data
  end type

  ! Made by keepout_fit_options() with the defaults.
  type, bind(c) :: ko_fit_options
    integer(c_size_t) :: struct_size
    integer(c_int32_t) :: control_points(3)
    integer(c_int32_t) :: reweightings
    real(c_double) :: margin
    real(c_double) :: lambda_normal
    real(c_double) :: lambda_smooth
    real(c_double) :: distance_weight
    real(c_double) :: tolerance
    integer(c_int32_t) :: feasible
    integer(c_int32_t) :: max_iterations
    integer(c_int64_t) :: memory_limit
    integer(c_int32_t) :: n_threads
    integer(c_int32_t) :: reserved
    type(c_funptr) :: progress
    type(c_ptr) :: progress_data
    integer(c_int32_t) :: reweighting
    integer(c_int32_t) :: reserved_2
    real(c_double) :: max_error
    integer(c_int64_t) :: max_unknowns
  end type

  type, bind(c) :: ko_fit_report
    integer(c_size_t) :: struct_size
    integer(c_int32_t) :: dim
    integer(c_int32_t) :: feasible
    integer(c_int32_t) :: control_points(3)
    integer(c_int32_t) :: iterations
    integer(c_int64_t) :: n_unknowns
    integer(c_int64_t) :: n_points
    integer(c_int64_t) :: bytes
    real(c_double) :: box_min(3)
    real(c_double) :: box_max(3)
    real(c_double) :: diagonal
    real(c_double) :: residual
    real(c_double) :: seconds_assembly
    real(c_double) :: seconds_solve
    real(c_double) :: seconds_check
    real(c_double) :: rms
    real(c_double) :: max
    real(c_double) :: mean_gradient
    integer(c_int64_t) :: n_outliers
    real(c_double) :: clear_sides
    real(c_double) :: convergence_rate
    integer(c_int64_t) :: n_levels
  end type

  ! Made by keepout_level_set_options() with the defaults.
  type, bind(c) :: ko_level_set_options
    integer(c_size_t) :: struct_size
    integer(c_int32_t) :: subdivisions
    integer(c_int32_t) :: n_threads
    real(c_double) :: shortest_edge
    integer(c_int32_t) :: relaxations
    integer(c_int32_t) :: reserved
    integer(c_int64_t) :: memory_limit
    type(c_funptr) :: progress
    type(c_ptr) :: progress_data
  end type

  ! Made by keepout_certify_options() with the defaults.
  type, bind(c) :: ko_certify_options
    integer(c_size_t) :: struct_size
    real(c_double) :: tolerance
    integer(c_int64_t) :: max_boxes
    integer(c_int32_t) :: n_threads
    integer(c_int32_t) :: reserved
    type(c_funptr) :: progress
    type(c_ptr) :: progress_data
  end type

  type, bind(c) :: ko_certificate
    integer(c_size_t) :: struct_size
    real(c_double) :: threshold
    real(c_double) :: largest_found
    real(c_double) :: place(3)
    real(c_double) :: surface_error
    real(c_double) :: steepest
    real(c_double) :: steepest_beyond
    integer(c_int64_t) :: n_boxes
    integer(c_int64_t) :: n_components
    integer(c_int32_t) :: side_certified
    integer(c_int32_t) :: budget_reached
  end type

  ! Made by keepout_explicit_options() with the defaults.
  type, bind(c) :: ko_explicit_options
    integer(c_size_t) :: struct_size
    real(c_double) :: smoothing
    real(c_double) :: softening
    integer(c_int32_t) :: formulation
    integer(c_int32_t) :: n_nearest
    integer(c_int32_t) :: exponent
    integer(c_int32_t) :: feasible
  end type

  type, bind(c) :: ko_separation
    integer(c_size_t) :: struct_size
    real(c_double) :: minimum_distance
    real(c_double) :: intersection_length
    real(c_double) :: distance_by_translation(3)
    real(c_double) :: length_by_translation(3)
    integer(c_int32_t) :: b_in_a
    integer(c_int32_t) :: a_in_b
  end type

  ! Made by keepout_aggregation() with the defaults.
  type, bind(c) :: ko_aggregation
    integer(c_size_t) :: struct_size
    real(c_double) :: sharpness
    integer(c_int32_t) :: kind
    integer(c_int32_t) :: side
  end type

  ! Made by keepout_law().
  type, bind(c) :: ko_law
    integer(c_size_t) :: struct_size
    real(c_double) :: offset
    real(c_double) :: slope
    type(c_ptr) :: waves
    integer(c_size_t) :: n_waves
  end type

  ! Made by keepout_pair_options() with the defaults.
  type, bind(c) :: ko_pair_options
    integer(c_size_t) :: struct_size
    real(c_double) :: slack
    integer(c_int64_t) :: n_steps
    integer(c_int64_t) :: measure_steps
    real(c_double) :: clearance
    integer(c_int64_t) :: max_bytes
    integer(c_int32_t) :: conflicts
    integer(c_int32_t) :: n_threads
    type(c_funptr) :: progress
    type(c_ptr) :: progress_data
  end type

  ! Made by keepout_family_options() with the defaults.
  type, bind(c) :: ko_family_options
    integer(c_size_t) :: struct_size
    real(c_double) :: gap
    type(c_ptr) :: symmetries
    integer(c_size_t) :: n_symmetries
    real(c_double) :: symmetry_excess
    integer(c_int32_t) :: n_threads
    integer(c_int32_t) :: reserved
    type(c_funptr) :: progress
    type(c_ptr) :: progress_data
  end type

  ! Made by keepout_optimise_options() with the defaults.
  type, bind(c) :: ko_optimise_options
    integer(c_size_t) :: struct_size
    real(c_double) :: gamma
    real(c_double) :: tolerance
    real(c_double) :: feasibility
    integer(c_int32_t) :: max_iterations
    integer(c_int32_t) :: close_from
    integer(c_int32_t) :: n_threads
    integer(c_int32_t) :: reserved
    type(c_funptr) :: progress
    type(c_ptr) :: progress_data
  end type

  ! Made by keepout_persistence_options() with the defaults.
  type, bind(c) :: ko_persistence_options
    integer(c_size_t) :: struct_size
    real(c_double) :: scale
    real(c_double) :: gammas(2)
    integer(c_int64_t) :: n_times
    integer(c_int64_t) :: max_tries
    integer(c_int32_t) :: n_threads
    integer(c_int32_t) :: reserved
    type(c_funptr) :: progress
    type(c_ptr) :: progress_data
  end type

  type, bind(c) :: ko_pair_report
    integer(c_size_t) :: struct_size
    integer(c_int64_t) :: n_cells(2)
    integer(c_int64_t) :: n_colliding(2)
    integer(c_int64_t) :: n_edges
    integer(c_int64_t) :: graph_bytes
    integer(c_int64_t) :: measure_steps
    integer(c_int64_t) :: n_visits
    integer(c_int64_t) :: measure_bytes
    integer(c_int32_t) :: dim
    integer(c_int32_t) :: has_graph
  end type

  type, bind(c) :: ko_optimise_report
    integer(c_size_t) :: struct_size
    real(c_double) :: gamma
    real(c_double) :: volumes(2)
    real(c_double) :: measures(2)
    real(c_double) :: change
    integer(c_int32_t) :: n_iterations
    integer(c_int32_t) :: converged
  end type

  ! Made by keepout_arrange_options() with the defaults.
  type, bind(c) :: ko_arrange_options
    integer(c_size_t) :: struct_size
    integer(c_int32_t) :: max_rounds
    integer(c_int32_t) :: max_starts
    type(c_funptr) :: progress
    type(c_ptr) :: progress_data
  end type

  type, bind(c) :: ko_assembly_report
    integer(c_size_t) :: struct_size
    integer(c_int64_t) :: n_cells
    integer(c_int64_t) :: n_meetings
    integer(c_int64_t) :: n_edges
    integer(c_int64_t) :: graph_bytes
    integer(c_int32_t) :: n_parts
    integer(c_int32_t) :: dim
  end type

  abstract interface
    ! ko_progress; its address by c_funloc.
    function ko_progress(fraction, stage, data) bind(c) result(cancel)
      import
      real(c_double), value :: fraction
      type(c_ptr), value :: stage
      type(c_ptr), value :: data
      integer(c_int32_t) :: cancel
    end function

    ! ko_pose_function; its address by c_funloc. rotation is row by row: rotation(2) is R_12.
    function ko_pose_function(time, rotation, translation, data) bind(c) result(failed)
      import
      real(c_double), value :: time
      type(c_ptr), value :: rotation
      type(c_ptr), value :: translation
      type(c_ptr), value :: data
      integer(c_int32_t) :: failed
    end function
  end interface

  ! Handles, and arrays that may be NULL, are type(c_ptr): c_loc gives an array's address, c_null_ptr is NULL. Strings end with
  ! c_null_char.
  interface
    function ko_last_error() bind(c) result(message)
      import
      type(c_ptr) :: message
    end function

    function ko_status_string(status) bind(c) result(name)
      import
      integer(c_int32_t), value :: status
      type(c_ptr) :: name
    end function

    function ko_version() bind(c) result(version)
      import
      type(c_ptr) :: version
    end function

    function ko_abi_version() bind(c) result(version)
      import
      integer(c_int32_t) :: version
    end function

    function ko_capabilities() bind(c) result(capabilities)
      import
      integer(c_int64_t) :: capabilities
    end function

    function ko_mesh_read(path, mesh) bind(c) result(status)
      import
      character(kind=c_char), intent(in) :: path(*)
      type(c_ptr), intent(out) :: mesh
      integer(c_int32_t) :: status
    end function

    function ko_mesh_write(mesh, path) bind(c) result(status)
      import
      type(c_ptr), value :: mesh
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int32_t) :: status
    end function

    function ko_mesh_from_triangles(vertices, n_vertices, triangles, n_triangles, mesh) bind(c) result(status)
      import
      real(c_double), intent(in) :: vertices(*)
      integer(c_size_t), value :: n_vertices
      integer(c_int32_t), intent(in) :: triangles(*)
      integer(c_size_t), value :: n_triangles
      type(c_ptr), intent(out) :: mesh
      integer(c_int32_t) :: status
    end function

    function ko_mesh_from_polylines(points, n_points, loop_starts, n_loops, closed, mesh) bind(c) result(status)
      import
      real(c_double), intent(in) :: points(*)
      integer(c_size_t), value :: n_points
      integer(c_size_t), intent(in) :: loop_starts(*)
      integer(c_size_t), value :: n_loops
      integer(c_int32_t), value :: closed
      type(c_ptr), intent(out) :: mesh
      integer(c_int32_t) :: status
    end function

    subroutine ko_mesh_free(mesh) bind(c)
      import
      type(c_ptr), value :: mesh
    end subroutine

    function ko_mesh_get_dim(mesh, dim) bind(c) result(status)
      import
      type(c_ptr), value :: mesh
      integer(c_int32_t), intent(inout) :: dim
      integer(c_int32_t) :: status
    end function

    function ko_mesh_get_size(mesh, n_vertices, n_triangles) bind(c) result(status)
      import
      type(c_ptr), value :: mesh
      integer(c_size_t), intent(inout) :: n_vertices
      integer(c_size_t), intent(inout) :: n_triangles
      integer(c_int32_t) :: status
    end function

    function ko_mesh_copy(mesh, n_vertices, n_triangles, vertices, triangles) bind(c) result(status)
      import
      type(c_ptr), value :: mesh
      integer(c_size_t), value :: n_vertices
      integer(c_size_t), value :: n_triangles
      type(c_ptr), value :: vertices
      type(c_ptr), value :: triangles
      integer(c_int32_t) :: status
    end function

    function ko_mesh_get_polylines_size(mesh, n_points, n_loops) bind(c) result(status)
      import
      type(c_ptr), value :: mesh
      integer(c_size_t), intent(inout) :: n_points
      integer(c_size_t), intent(inout) :: n_loops
      integer(c_int32_t) :: status
    end function

    function ko_mesh_copy_polylines(mesh, n_points, n_loops, points, loop_starts, closed) bind(c) result(status)
      import
      type(c_ptr), value :: mesh
      integer(c_size_t), value :: n_points
      integer(c_size_t), value :: n_loops
      type(c_ptr), value :: points
      type(c_ptr), value :: loop_starts
      type(c_ptr), value :: closed
      integer(c_int32_t) :: status
    end function

    function ko_mesh_get_report(mesh, struct_size, report) bind(c) result(status)
      import
      type(c_ptr), value :: mesh
      integer(c_size_t), value :: struct_size
      type(ko_mesh_report), intent(inout) :: report
      integer(c_int32_t) :: status
    end function

    function ko_mesh_flip(mesh) bind(c) result(status)
      import
      type(c_ptr), value :: mesh
      integer(c_int32_t) :: status
    end function

    function ko_mesh_sample(mesh, n_points, seed, cloud) bind(c) result(status)
      import
      type(c_ptr), value :: mesh
      integer(c_size_t), value :: n_points
      integer(c_int64_t), value :: seed
      type(c_ptr), intent(out) :: cloud
      integer(c_int32_t) :: status
    end function

    function ko_mesh_signed_distance(mesh, points, n_points, distances) bind(c) result(status)
      import
      type(c_ptr), value :: mesh
      real(c_double), intent(in) :: points(*)
      integer(c_size_t), value :: n_points
      real(c_double), intent(inout) :: distances(*)
      integer(c_int32_t) :: status
    end function

    function ko_cloud_from_points(dim, points, normals, n_points, cloud) bind(c) result(status)
      import
      integer(c_int32_t), value :: dim
      real(c_double), intent(in) :: points(*)
      type(c_ptr), value :: normals
      integer(c_size_t), value :: n_points
      type(c_ptr), intent(out) :: cloud
      integer(c_int32_t) :: status
    end function

    subroutine ko_cloud_free(cloud) bind(c)
      import
      type(c_ptr), value :: cloud
    end subroutine

    function ko_cloud_get_dim(cloud, dim) bind(c) result(status)
      import
      type(c_ptr), value :: cloud
      integer(c_int32_t), intent(inout) :: dim
      integer(c_int32_t) :: status
    end function

    function ko_cloud_get_size(cloud, n_points) bind(c) result(status)
      import
      type(c_ptr), value :: cloud
      integer(c_size_t), intent(inout) :: n_points
      integer(c_int32_t) :: status
    end function

    function ko_cloud_copy(cloud, n_points, points, normals) bind(c) result(status)
      import
      type(c_ptr), value :: cloud
      integer(c_size_t), value :: n_points
      type(c_ptr), value :: points
      type(c_ptr), value :: normals
      integer(c_int32_t) :: status
    end function

    function ko_cloud_set_weights(cloud, weights, n_points) bind(c) result(status)
      import
      type(c_ptr), value :: cloud
      real(c_double), intent(in) :: weights(*)
      integer(c_size_t), value :: n_points
      integer(c_int32_t) :: status
    end function

    function ko_cloud_sides(cloud, points, n_points, sides) bind(c) result(status)
      import
      type(c_ptr), value :: cloud
      real(c_double), intent(in) :: points(*)
      integer(c_size_t), value :: n_points
      real(c_double), intent(inout) :: sides(*)
      integer(c_int32_t) :: status
    end function

    function ko_cloud_copy_origins(cloud, n_points, triangles, barycentric) bind(c) result(status)
      import
      type(c_ptr), value :: cloud
      integer(c_size_t), value :: n_points
      type(c_ptr), value :: triangles
      type(c_ptr), value :: barycentric
      integer(c_int32_t) :: status
    end function

    function ko_normal_options_init(options, struct_size) bind(c) result(status)
      import
      type(ko_normal_options), intent(inout) :: options
      integer(c_size_t), value :: struct_size
      integer(c_int32_t) :: status
    end function

    function ko_cloud_estimate_normals(dim, points, n_points, options, cloud, flags, report_size, report) &
      bind(c) result(status)
      import
      integer(c_int32_t), value :: dim
      real(c_double), intent(in) :: points(*)
      integer(c_size_t), value :: n_points
      type(ko_normal_options), intent(in) :: options
      type(c_ptr), intent(out) :: cloud
      type(c_ptr), value :: flags
      integer(c_size_t), value :: report_size
      type(c_ptr), value :: report
      integer(c_int32_t) :: status
    end function

    function ko_smooth_options_init(options, struct_size) bind(c) result(status)
      import
      type(ko_smooth_options), intent(inout) :: options
      integer(c_size_t), value :: struct_size
      integer(c_int32_t) :: status
    end function

    function ko_cloud_smooth(cloud, options, smoothed) bind(c) result(status)
      import
      type(c_ptr), value :: cloud
      type(ko_smooth_options), intent(in) :: options
      type(c_ptr), intent(out) :: smoothed
      integer(c_int32_t) :: status
    end function

    function ko_fit_options_init(options, struct_size) bind(c) result(status)
      import
      type(ko_fit_options), intent(inout) :: options
      integer(c_size_t), value :: struct_size
      integer(c_int32_t) :: status
    end function

    function ko_field_fit(cloud, options, field) bind(c) result(status)
      import
      type(c_ptr), value :: cloud
      type(ko_fit_options), intent(in) :: options
      type(c_ptr), intent(out) :: field
      integer(c_int32_t) :: status
    end function

    function ko_field_refit(start, cloud, options, field) bind(c) result(status)
      import
      type(c_ptr), value :: start
      type(c_ptr), value :: cloud
      type(ko_fit_options), intent(in) :: options
      type(c_ptr), intent(out) :: field
      integer(c_int32_t) :: status
    end function

    function ko_field_from_control_points(dim, counts, box_min, box_max, feasible, diagonal, &
      control_points, n_control_points, field) bind(c) result(status)
      import
      integer(c_int32_t), value :: dim
      integer(c_int32_t), intent(in) :: counts(*)
      real(c_double), intent(in) :: box_min(*)
      real(c_double), intent(in) :: box_max(*)
      integer(c_int32_t), value :: feasible
      real(c_double), value :: diagonal
      real(c_double), intent(in) :: control_points(*)
      integer(c_size_t), value :: n_control_points
      type(c_ptr), intent(out) :: field
      integer(c_int32_t) :: status
    end function

    function ko_field_copy_control_points(field, n_control_points, control_points) bind(c) result(status)
      import
      type(c_ptr), value :: field
      integer(c_size_t), value :: n_control_points
      real(c_double), intent(inout) :: control_points(*)
      integer(c_int32_t) :: status
    end function

    function ko_field_eval(field, points, n_points, values, gradients, hessians) bind(c) result(status)
      import
      type(c_ptr), value :: field
      real(c_double), intent(in) :: points(*)
      integer(c_size_t), value :: n_points
      type(c_ptr), value :: values
      type(c_ptr), value :: gradients
      type(c_ptr), value :: hessians
      integer(c_int32_t) :: status
    end function

    function ko_field_eval_parallel(field, points, n_points, values, gradients, hessians, n_threads) bind(c) result(status)
      import
      type(c_ptr), value :: field
      real(c_double), intent(in) :: points(*)
      integer(c_size_t), value :: n_points
      type(c_ptr), value :: values
      type(c_ptr), value :: gradients
      type(c_ptr), value :: hessians
      integer(c_int32_t), value :: n_threads
      integer(c_int32_t) :: status
    end function

    function ko_field_eval_lattice(field, origin, steps, counts, n_steps, values, gradients, n_threads) &
      bind(c) result(status)
      import
      type(c_ptr), value :: field
      real(c_double), intent(in) :: origin(*)
      real(c_double), intent(in) :: steps(*)
      integer(c_size_t), intent(in) :: counts(*)
      integer(c_int32_t), value :: n_steps
      type(c_ptr), value :: values
      type(c_ptr), value :: gradients
      integer(c_int32_t), value :: n_threads
      integer(c_int32_t) :: status
    end function

    function ko_field_outside_box(field, points, n_points, outside) bind(c) result(status)
      import
      type(c_ptr), value :: field
      real(c_double), intent(in) :: points(*)
      integer(c_size_t), value :: n_points
      integer(c_int8_t), intent(inout) :: outside(*)
      integer(c_int32_t) :: status
    end function

    function ko_field_get_report(field, struct_size, report) bind(c) result(status)
      import
      type(c_ptr), value :: field
      integer(c_size_t), value :: struct_size
      type(ko_fit_report), intent(inout) :: report
      integer(c_int32_t) :: status
    end function

    function ko_field_save(field, path) bind(c) result(status)
      import
      type(c_ptr), value :: field
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int32_t) :: status
    end function

    function ko_field_load(path, field) bind(c) result(status)
      import
      character(kind=c_char), intent(in) :: path(*)
      type(c_ptr), intent(out) :: field
      integer(c_int32_t) :: status
    end function

    subroutine ko_field_free(field) bind(c)
      import
      type(c_ptr), value :: field
    end subroutine

    function ko_level_set_options_init(options, struct_size) bind(c) result(status)
      import
      type(ko_level_set_options), intent(inout) :: options
      integer(c_size_t), value :: struct_size
      integer(c_int32_t) :: status
    end function

    function ko_field_level_set(field, level, options, mesh) bind(c) result(status)
      import
      type(c_ptr), value :: field
      real(c_double), value :: level
      type(ko_level_set_options), intent(in) :: options
      type(c_ptr), intent(out) :: mesh
      integer(c_int32_t) :: status
    end function

    function ko_certify_options_init(options, struct_size) bind(c) result(status)
      import
      type(ko_certify_options), intent(inout) :: options
      integer(c_size_t), value :: struct_size
      integer(c_int32_t) :: status
    end function

    function ko_field_certify(field, mesh, clearance, covering_radius, options, certificate_size, certificate) bind(c) &
      result(status)
      import
      type(c_ptr), value :: field
      type(c_ptr), value :: mesh
      real(c_double), value :: clearance
      real(c_double), value :: covering_radius
      type(ko_certify_options), intent(in) :: options
      integer(c_size_t), value :: certificate_size
      type(ko_certificate), intent(inout) :: certificate
      integer(c_int32_t) :: status
    end function

    function ko_mesh_get_component_count(mesh, n_components) bind(c) result(status)
      import
      type(c_ptr), value :: mesh
      integer(c_size_t), intent(inout) :: n_components
      integer(c_int32_t) :: status
    end function

    function ko_mesh_copy_component_points(mesh, n_components, points) bind(c) result(status)
      import
      type(c_ptr), value :: mesh
      integer(c_size_t), value :: n_components
      real(c_double), intent(inout) :: points(*)
      integer(c_int32_t) :: status
    end function

    function ko_aggregation_init(aggregation, struct_size) bind(c) result(status)
      import
      type(ko_aggregation), intent(inout) :: aggregation
      integer(c_size_t), value :: struct_size
      integer(c_int32_t) :: status
    end function

    function ko_aggregate(aggregation, extreme, unit, values, n_values, value, gradient, hessian) bind(c) result(status)
      import
      type(ko_aggregation), intent(in) :: aggregation
      integer(c_int32_t), value :: extreme
      real(c_double), value :: unit
      real(c_double), intent(in) :: values(*)
      integer(c_size_t), value :: n_values
      real(c_double), intent(inout) :: value
      type(c_ptr), value :: gradient
      type(c_ptr), value :: hessian
      integer(c_int32_t) :: status
    end function

    function ko_aggregation_bounds(aggregation, n_values, least, below, above) bind(c) result(status)
      import
      type(ko_aggregation), intent(in) :: aggregation
      integer(c_size_t), value :: n_values
      real(c_double), value :: least
      real(c_double), intent(inout) :: below
      real(c_double), intent(inout) :: above
      integer(c_int32_t) :: status
    end function

    function ko_body_from_points(dim, points, n_points, covering_radius, body) bind(c) result(status)
      import
      integer(c_int32_t), value :: dim
      real(c_double), intent(in) :: points(*)
      integer(c_size_t), value :: n_points
      real(c_double), value :: covering_radius
      type(c_ptr), intent(out) :: body
      integer(c_int32_t) :: status
    end function

    function ko_body_from_mesh(mesh, covering_radius, body) bind(c) result(status)
      import
      type(c_ptr), value :: mesh
      real(c_double), value :: covering_radius
      type(c_ptr), intent(out) :: body
      integer(c_int32_t) :: status
    end function

    subroutine ko_body_free(body) bind(c)
      import
      type(c_ptr), value :: body
    end subroutine

    function ko_body_get_dim(body, dim) bind(c) result(status)
      import
      type(c_ptr), value :: body
      integer(c_int32_t), intent(inout) :: dim
      integer(c_int32_t) :: status
    end function

    function ko_body_get_size(body, n_points) bind(c) result(status)
      import
      type(c_ptr), value :: body
      integer(c_size_t), intent(inout) :: n_points
      integer(c_int32_t) :: status
    end function

    function ko_body_get_covering_radius(body, covering_radius) bind(c) result(status)
      import
      type(c_ptr), value :: body
      real(c_double), intent(inout) :: covering_radius
      integer(c_int32_t) :: status
    end function

    function ko_body_copy_points(body, n_points, points) bind(c) result(status)
      import
      type(c_ptr), value :: body
      integer(c_size_t), value :: n_points
      real(c_double), intent(inout) :: points(*)
      integer(c_int32_t) :: status
    end function

    function ko_constraints_create(dim, constraints) bind(c) result(status)
      import
      integer(c_int32_t), value :: dim
      type(c_ptr), intent(out) :: constraints
      integer(c_int32_t) :: status
    end function

    subroutine ko_constraints_free(constraints) bind(c)
      import
      type(c_ptr), value :: constraints
    end subroutine

    function ko_constraints_add_frame(constraints, rotation, scale, frame) bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      integer(c_int32_t), value :: rotation
      integer(c_int32_t), value :: scale
      integer(c_int32_t), intent(inout) :: frame
      integer(c_int32_t) :: status
    end function

    function ko_constraints_add_fixed_frame(constraints, rotation, scale, parameters, n_parameters, frame) &
      bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      integer(c_int32_t), value :: rotation
      integer(c_int32_t), value :: scale
      real(c_double), intent(in) :: parameters(*)
      integer(c_size_t), value :: n_parameters
      integer(c_int32_t), intent(inout) :: frame
      integer(c_int32_t) :: status
    end function

    function ko_constraints_add_points(constraints, n_points, points) bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      integer(c_size_t), value :: n_points
      integer(c_int32_t), intent(inout) :: points
      integer(c_int32_t) :: status
    end function

    function ko_constraints_keep_body(constraints, body, frame, field, field_frame, aggregation, first_value) &
      bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      type(c_ptr), value :: body
      integer(c_int32_t), value :: frame
      type(c_ptr), value :: field
      integer(c_int32_t), value :: field_frame
      type(ko_aggregation), intent(in) :: aggregation
      integer(c_size_t), intent(inout) :: first_value
      integer(c_int32_t) :: status
    end function

    function ko_constraints_keep_points(constraints, points, field, field_frame, aggregation, first_value) &
      bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      integer(c_int32_t), value :: points
      type(c_ptr), value :: field
      integer(c_int32_t), value :: field_frame
      type(ko_aggregation), intent(in) :: aggregation
      integer(c_size_t), intent(inout) :: first_value
      integer(c_int32_t) :: status
    end function

    function ko_constraints_keep_body_in_fields(constraints, body, frame, fields, n_fields, extreme, combination, &
      field_frame, aggregation, first_value) bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      type(c_ptr), value :: body
      integer(c_int32_t), value :: frame
      type(c_ptr), intent(in) :: fields(*)
      integer(c_size_t), value :: n_fields
      integer(c_int32_t), value :: extreme
      type(ko_aggregation), intent(in) :: combination
      integer(c_int32_t), value :: field_frame
      type(ko_aggregation), intent(in) :: aggregation
      integer(c_size_t), intent(inout) :: first_value
      integer(c_int32_t) :: status
    end function

    function ko_constraints_keep_points_in_fields(constraints, points, fields, n_fields, extreme, combination, &
      field_frame, aggregation, first_value) bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      integer(c_int32_t), value :: points
      type(c_ptr), intent(in) :: fields(*)
      integer(c_size_t), value :: n_fields
      integer(c_int32_t), value :: extreme
      type(ko_aggregation), intent(in) :: combination
      integer(c_int32_t), value :: field_frame
      type(ko_aggregation), intent(in) :: aggregation
      integer(c_size_t), intent(inout) :: first_value
      integer(c_int32_t) :: status
    end function

    function ko_constraints_get_size(constraints, n_variables, n_values, n_jacobian, n_hessian) bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      integer(c_size_t), intent(inout) :: n_variables
      integer(c_size_t), intent(inout) :: n_values
      integer(c_size_t), intent(inout) :: n_jacobian
      integer(c_size_t), intent(inout) :: n_hessian
      integer(c_int32_t) :: status
    end function

    function ko_constraints_get_frame_variables(constraints, frame, first, n_variables) bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      integer(c_int32_t), value :: frame
      integer(c_size_t), intent(inout) :: first
      integer(c_size_t), intent(inout) :: n_variables
      integer(c_int32_t) :: status
    end function

    function ko_constraints_get_points_variables(constraints, points, first, n_variables) bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      integer(c_int32_t), value :: points
      integer(c_size_t), intent(inout) :: first
      integer(c_size_t), intent(inout) :: n_variables
      integer(c_int32_t) :: status
    end function

    function ko_constraints_values(constraints, x, n_variables, n_values, values) bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      real(c_double), intent(in) :: x(*)
      integer(c_size_t), value :: n_variables
      integer(c_size_t), value :: n_values
      real(c_double), intent(inout) :: values(*)
      integer(c_int32_t) :: status
    end function

    function ko_constraints_jacobian_pattern(constraints, n_entries, rows, columns) bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      integer(c_size_t), value :: n_entries
      integer(c_int32_t), intent(inout) :: rows(*)
      integer(c_int32_t), intent(inout) :: columns(*)
      integer(c_int32_t) :: status
    end function

    function ko_constraints_jacobian(constraints, x, n_variables, n_entries, values) bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      real(c_double), intent(in) :: x(*)
      integer(c_size_t), value :: n_variables
      integer(c_size_t), value :: n_entries
      real(c_double), intent(inout) :: values(*)
      integer(c_int32_t) :: status
    end function

    function ko_constraints_values_and_jacobian(constraints, x, n_variables, n_values, values, n_entries, entries) &
      bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      real(c_double), intent(in) :: x(*)
      integer(c_size_t), value :: n_variables
      integer(c_size_t), value :: n_values
      real(c_double), intent(inout) :: values(*)
      integer(c_size_t), value :: n_entries
      real(c_double), intent(inout) :: entries(*)
      integer(c_int32_t) :: status
    end function

    function ko_constraints_dense_jacobian(constraints, x, n_variables, n_values, jacobian) bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      real(c_double), intent(in) :: x(*)
      integer(c_size_t), value :: n_variables
      integer(c_size_t), value :: n_values
      real(c_double), intent(inout) :: jacobian(*)
      integer(c_int32_t) :: status
    end function

    function ko_constraints_jacobian_times(constraints, x, v, n_variables, n_values, product) bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      real(c_double), intent(in) :: x(*)
      real(c_double), intent(in) :: v(*)
      integer(c_size_t), value :: n_variables
      integer(c_size_t), value :: n_values
      real(c_double), intent(inout) :: product(*)
      integer(c_int32_t) :: status
    end function

    function ko_constraints_transposed_jacobian_times(constraints, x, n_variables, w, n_values, product) &
      bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      real(c_double), intent(in) :: x(*)
      integer(c_size_t), value :: n_variables
      real(c_double), intent(in) :: w(*)
      integer(c_size_t), value :: n_values
      real(c_double), intent(inout) :: product(*)
      integer(c_int32_t) :: status
    end function

    function ko_constraints_hessian_pattern(constraints, n_entries, rows, columns) bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      integer(c_size_t), value :: n_entries
      integer(c_int32_t), intent(inout) :: rows(*)
      integer(c_int32_t), intent(inout) :: columns(*)
      integer(c_int32_t) :: status
    end function

    function ko_constraints_hessian(constraints, x, n_variables, lambda, n_values, n_entries, entries) bind(c) result(status)
      import
      type(c_ptr), value :: constraints
      real(c_double), intent(in) :: x(*)
      integer(c_size_t), value :: n_variables
      real(c_double), intent(in) :: lambda(*)
      integer(c_size_t), value :: n_values
      integer(c_size_t), value :: n_entries
      real(c_double), intent(inout) :: entries(*)
      integer(c_int32_t) :: status
    end function

    function ko_cloud_follow(cloud, mesh, moved) bind(c) result(status)
      import
      type(c_ptr), value :: cloud
      type(c_ptr), value :: mesh
      type(c_ptr), intent(out) :: moved
      integer(c_int32_t) :: status
    end function

    function ko_cloud_pull_back(cloud, mesh, d_points, d_normals, n_points, n_vertices, d_vertices) bind(c) result(status)
      import
      type(c_ptr), value :: cloud
      type(c_ptr), value :: mesh
      type(c_ptr), value :: d_points
      type(c_ptr), value :: d_normals
      integer(c_size_t), value :: n_points
      integer(c_size_t), value :: n_vertices
      real(c_double), intent(inout) :: d_vertices(*)
      integer(c_int32_t) :: status
    end function

    function ko_sensitivity_create(field, cloud, options, sensitivity) bind(c) result(status)
      import
      type(c_ptr), value :: field
      type(c_ptr), value :: cloud
      type(ko_fit_options), intent(in) :: options
      type(c_ptr), intent(out) :: sensitivity
      integer(c_int32_t) :: status
    end function

    function ko_sensitivity_solve(sensitivity, points, weights, n_points, options, n_cloud_points, d_points, d_normals) bind(c) &
      result(status)
      import
      type(c_ptr), value :: sensitivity
      real(c_double), intent(in) :: points(*)
      type(c_ptr), value :: weights
      integer(c_size_t), value :: n_points
      type(c_ptr), value :: options
      integer(c_size_t), value :: n_cloud_points
      type(c_ptr), value :: d_points
      type(c_ptr), value :: d_normals
      integer(c_int32_t) :: status
    end function

    subroutine ko_sensitivity_free(sensitivity) bind(c)
      import
      type(c_ptr), value :: sensitivity
    end subroutine

    function ko_explicit_options_init(options, struct_size) bind(c) result(status)
      import
      type(ko_explicit_options), intent(inout) :: options
      integer(c_size_t), value :: struct_size
      integer(c_int32_t) :: status
    end function

    function ko_explicit_create(cloud, options, formula) bind(c) result(status)
      import
      type(c_ptr), value :: cloud
      type(ko_explicit_options), intent(in) :: options
      type(c_ptr), intent(out) :: formula
      integer(c_int32_t) :: status
    end function

    subroutine ko_explicit_free(formula) bind(c)
      import
      type(c_ptr), value :: formula
    end subroutine

    function ko_explicit_get_smoothing(formula, smoothing) bind(c) result(status)
      import
      type(c_ptr), value :: formula
      real(c_double), intent(inout) :: smoothing
      integer(c_int32_t) :: status
    end function

    function ko_explicit_eval(formula, points, n_points, values, gradients) bind(c) result(status)
      import
      type(c_ptr), value :: formula
      real(c_double), intent(in) :: points(*)
      integer(c_size_t), value :: n_points
      type(c_ptr), value :: values
      type(c_ptr), value :: gradients
      integer(c_int32_t) :: status
    end function

    function ko_meshes_separation(mesh_a, mesh_b, translation, sharpness, n_vertices, struct_size, separation, &
      distance_gradients, length_gradients) bind(c) result(status)
      import
      type(c_ptr), value :: mesh_a
      type(c_ptr), value :: mesh_b
      type(c_ptr), value :: translation
      real(c_double), value :: sharpness
      integer(c_size_t), value :: n_vertices
      integer(c_size_t), value :: struct_size
      type(ko_separation), intent(inout) :: separation
      type(c_ptr), value :: distance_gradients
      type(c_ptr), value :: length_gradients
      integer(c_int32_t) :: status
    end function

    function ko_law_init(law, struct_size) bind(c) result(status)
      import
      type(ko_law), intent(inout) :: law
      integer(c_size_t), value :: struct_size
      integer(c_int32_t) :: status
    end function

    function ko_motion_fixed(dim, rotation, translation, motion) bind(c) result(status)
      import
      integer(c_int32_t), value :: dim
      type(c_ptr), value :: rotation
      type(c_ptr), value :: translation
      type(c_ptr), intent(out) :: motion
      integer(c_int32_t) :: status
    end function

    function ko_motion_slide(dim, along, law, motion) bind(c) result(status)
      import
      integer(c_int32_t), value :: dim
      real(c_double), intent(in) :: along(*)
      type(ko_law), intent(in) :: law
      type(c_ptr), intent(out) :: motion
      integer(c_int32_t) :: status
    end function

    function ko_motion_turn(center, law, motion) bind(c) result(status)
      import
      real(c_double), intent(in) :: center(*)
      type(ko_law), intent(in) :: law
      type(c_ptr), intent(out) :: motion
      integer(c_int32_t) :: status
    end function

    function ko_motion_screw(point, axis, lead, law, motion) bind(c) result(status)
      import
      real(c_double), intent(in) :: point(*)
      real(c_double), intent(in) :: axis(*)
      real(c_double), value :: lead
      type(ko_law), intent(in) :: law
      type(c_ptr), intent(out) :: motion
      integer(c_int32_t) :: status
    end function

    function ko_motion_sampled(dim, rotations, translations, n_poses, motion) bind(c) result(status)
      import
      integer(c_int32_t), value :: dim
      real(c_double), intent(in) :: rotations(*)
      real(c_double), intent(in) :: translations(*)
      integer(c_size_t), value :: n_poses
      type(c_ptr), intent(out) :: motion
      integer(c_int32_t) :: status
    end function

    function ko_motion_from_function(dim, pose, data, n_poses, part, max_speed, motion) bind(c) result(status)
      import
      integer(c_int32_t), value :: dim
      type(c_funptr), value :: pose
      type(c_ptr), value :: data
      integer(c_size_t), value :: n_poses
      type(c_ptr), value :: part
      real(c_double), value :: max_speed
      type(c_ptr), intent(out) :: motion
      integer(c_int32_t) :: status
    end function

    function ko_motion_gears(centers, turns, ratio, first, second) bind(c) result(status)
      import
      real(c_double), intent(in) :: centers(*)
      real(c_double), value :: turns
      real(c_double), value :: ratio
      type(c_ptr), intent(out) :: first
      type(c_ptr), intent(out) :: second
      integer(c_int32_t) :: status
    end function

    function ko_motion_four_bar(pivots, lengths, from, by, bend, n_steps, crank, coupler, rocker) bind(c) result(status)
      import
      real(c_double), intent(in) :: pivots(*)
      real(c_double), intent(in) :: lengths(*)
      real(c_double), value :: from
      real(c_double), value :: by
      integer(c_int32_t), value :: bend
      integer(c_size_t), value :: n_steps
      type(c_ptr), intent(out) :: crank
      type(c_ptr), intent(out) :: coupler
      type(c_ptr), intent(out) :: rocker
      integer(c_int32_t) :: status
    end function

    function ko_motion_product(outer, inner, motion) bind(c) result(status)
      import
      type(c_ptr), value :: outer
      type(c_ptr), value :: inner
      type(c_ptr), intent(out) :: motion
      integer(c_int32_t) :: status
    end function

    function ko_motion_inverse(of, motion) bind(c) result(status)
      import
      type(c_ptr), value :: of
      type(c_ptr), intent(out) :: motion
      integer(c_int32_t) :: status
    end function

    subroutine ko_motion_free(motion) bind(c)
      import
      type(c_ptr), value :: motion
    end subroutine

    function ko_motion_get_dim(motion, dim) bind(c) result(status)
      import
      type(c_ptr), value :: motion
      integer(c_int32_t), intent(inout) :: dim
      integer(c_int32_t) :: status
    end function

    function ko_motion_eval(motion, times, n_times, rotations, translations) bind(c) result(status)
      import
      type(c_ptr), value :: motion
      real(c_double), intent(in) :: times(*)
      integer(c_size_t), value :: n_times
      real(c_double), intent(inout) :: rotations(*)
      real(c_double), intent(inout) :: translations(*)
      integer(c_int32_t) :: status
    end function

    function ko_part_create(dim, corner, cell_edge, counts, cells, n_cells, part) bind(c) result(status)
      import
      integer(c_int32_t), value :: dim
      real(c_double), intent(in) :: corner(*)
      real(c_double), value :: cell_edge
      integer(c_size_t), intent(in) :: counts(*)
      type(c_ptr), value :: cells
      integer(c_size_t), value :: n_cells
      type(c_ptr), intent(out) :: part
      integer(c_int32_t) :: status
    end function

    subroutine ko_part_free(part) bind(c)
      import
      type(c_ptr), value :: part
    end subroutine

    function ko_part_get_size(part, dim, n_cells) bind(c) result(status)
      import
      type(c_ptr), value :: part
      integer(c_int32_t), intent(inout) :: dim
      integer(c_size_t), intent(inout) :: n_cells
      integer(c_int32_t) :: status
    end function

    function ko_part_get_grid(part, corner, cell_edge, counts) bind(c) result(status)
      import
      type(c_ptr), value :: part
      real(c_double), intent(inout) :: corner(*)
      real(c_double), intent(inout) :: cell_edge
      integer(c_size_t), intent(inout) :: counts(*)
      integer(c_int32_t) :: status
    end function

    function ko_part_copy_cells(part, n_cells, cells) bind(c) result(status)
      import
      type(c_ptr), value :: part
      integer(c_size_t), value :: n_cells
      integer(c_int8_t), intent(inout) :: cells(*)
      integer(c_int32_t) :: status
    end function

    function ko_part_fractions_of_mesh(part, mesh, samples, n_threads, n_cells, fractions) bind(c) result(status)
      import
      type(c_ptr), value :: part
      type(c_ptr), value :: mesh
      integer(c_int32_t), value :: samples
      integer(c_int32_t), value :: n_threads
      integer(c_size_t), value :: n_cells
      real(c_double), intent(inout) :: fractions(*)
      integer(c_int32_t) :: status
    end function

    function ko_part_fractions_of_field(part, field, steepness, samples, n_threads, n_cells, fractions) bind(c) result(status)
      import
      type(c_ptr), value :: part
      type(c_ptr), value :: field
      real(c_double), value :: steepness
      integer(c_int32_t), value :: samples
      integer(c_int32_t), value :: n_threads
      integer(c_size_t), value :: n_cells
      real(c_double), intent(inout) :: fractions(*)
      integer(c_int32_t) :: status
    end function

    function ko_part_fractions_of_box(part, box_min, box_max, samples, n_threads, n_cells, fractions) bind(c) result(status)
      import
      type(c_ptr), value :: part
      real(c_double), intent(in) :: box_min(*)
      real(c_double), intent(in) :: box_max(*)
      integer(c_int32_t), value :: samples
      integer(c_int32_t), value :: n_threads
      integer(c_size_t), value :: n_cells
      real(c_double), intent(inout) :: fractions(*)
      integer(c_int32_t) :: status
    end function

    function ko_part_fractions_of_ball(part, center, radius, samples, n_threads, n_cells, fractions) bind(c) result(status)
      import
      type(c_ptr), value :: part
      real(c_double), intent(in) :: center(*)
      real(c_double), value :: radius
      integer(c_int32_t), value :: samples
      integer(c_int32_t), value :: n_threads
      integer(c_size_t), value :: n_cells
      real(c_double), intent(inout) :: fractions(*)
      integer(c_int32_t) :: status
    end function

    function ko_part_fractions_of_cylinder(part, ends, radius, samples, n_threads, n_cells, fractions) bind(c) result(status)
      import
      type(c_ptr), value :: part
      real(c_double), intent(in) :: ends(*)
      real(c_double), value :: radius
      integer(c_int32_t), value :: samples
      integer(c_int32_t), value :: n_threads
      integer(c_size_t), value :: n_cells
      real(c_double), intent(inout) :: fractions(*)
      integer(c_int32_t) :: status
    end function

    function ko_part_mesh_of_cells(part, cells, n_cells, within, rounds, progress, progress_data, &
      mesh) bind(c) result(status)
      import
      type(c_ptr), value :: part
      integer(c_int8_t), intent(in) :: cells(*)
      integer(c_size_t), value :: n_cells
      integer(c_int32_t), value :: within
      integer(c_int32_t), value :: rounds
      type(c_funptr), value :: progress
      type(c_ptr), value :: progress_data
      type(c_ptr), intent(out) :: mesh
      integer(c_int32_t) :: status
    end function

    function ko_part_mesh_of_densities(part, densities, n_cells, level, within, rounds, progress, progress_data, &
      mesh) bind(c) result(status)
      import
      type(c_ptr), value :: part
      real(c_double), intent(in) :: densities(*)
      integer(c_size_t), value :: n_cells
      real(c_double), value :: level
      integer(c_int32_t), value :: within
      integer(c_int32_t), value :: rounds
      type(c_funptr), value :: progress
      type(c_ptr), value :: progress_data
      type(c_ptr), intent(out) :: mesh
      integer(c_int32_t) :: status
    end function

    function ko_pair_options_init(options, struct_size) bind(c) result(status)
      import
      type(ko_pair_options), intent(inout) :: options
      integer(c_size_t), value :: struct_size
      integer(c_int32_t) :: status
    end function

    function ko_family_options_init(options, struct_size) bind(c) result(status)
      import
      type(ko_family_options), intent(inout) :: options
      integer(c_size_t), value :: struct_size
      integer(c_int32_t) :: status
    end function

    function ko_optimise_options_init(options, struct_size) bind(c) result(status)
      import
      type(ko_optimise_options), intent(inout) :: options
      integer(c_size_t), value :: struct_size
      integer(c_int32_t) :: status
    end function

    function ko_persistence_options_init(options, struct_size) bind(c) result(status)
      import
      type(ko_persistence_options), intent(inout) :: options
      integer(c_size_t), value :: struct_size
      integer(c_int32_t) :: status
    end function

    function ko_part_sweep(part, cells, n_cells, motion, still, still_motion, options, n_still, swept) bind(c) result(status)
      import
      type(c_ptr), value :: part
      type(c_ptr), value :: cells
      integer(c_size_t), value :: n_cells
      type(c_ptr), value :: motion
      type(c_ptr), value :: still
      type(c_ptr), value :: still_motion
      type(ko_pair_options), intent(in) :: options
      integer(c_size_t), value :: n_still
      integer(c_int8_t), intent(inout) :: swept(*)
      integer(c_int32_t) :: status
    end function

    function ko_part_unsweep(part, motion, body, body_cells, n_body, body_motion, rule, options, n_cells, &
      kept) bind(c) result(status)
      import
      type(c_ptr), value :: part
      type(c_ptr), value :: motion
      type(c_ptr), value :: body
      type(c_ptr), value :: body_cells
      integer(c_size_t), value :: n_body
      type(c_ptr), value :: body_motion
      integer(c_int32_t), value :: rule
      type(ko_pair_options), intent(in) :: options
      integer(c_size_t), value :: n_cells
      integer(c_int8_t), intent(inout) :: kept(*)
      integer(c_int32_t) :: status
    end function

    function ko_pair_create(part_1, motion_1, part_2, motion_2, options, pair) bind(c) result(status)
      import
      type(c_ptr), value :: part_1
      type(c_ptr), value :: motion_1
      type(c_ptr), value :: part_2
      type(c_ptr), value :: motion_2
      type(ko_pair_options), intent(in) :: options
      type(c_ptr), intent(out) :: pair
      integer(c_int32_t) :: status
    end function

    subroutine ko_pair_free(pair) bind(c)
      import
      type(c_ptr), value :: pair
    end subroutine

    function ko_pair_get_report(pair, report_size, report) bind(c) result(status)
      import
      type(c_ptr), value :: pair
      integer(c_size_t), value :: report_size
      type(ko_pair_report), intent(inout) :: report
      integer(c_int32_t) :: status
    end function

    function ko_pair_measures(pair, densities_1, n_1, densities_2, n_2, n_threads, g21, g12) bind(c) result(status)
      import
      type(c_ptr), value :: pair
      real(c_double), intent(in) :: densities_1(*)
      integer(c_size_t), value :: n_1
      real(c_double), intent(in) :: densities_2(*)
      integer(c_size_t), value :: n_2
      integer(c_int32_t), value :: n_threads
      real(c_double), intent(inout) :: g21
      real(c_double), intent(inout) :: g12
      integer(c_int32_t) :: status
    end function

    function ko_pair_local_measures(pair, densities_1, n_1, densities_2, n_2, n_threads, l21, l12) bind(c) result(status)
      import
      type(c_ptr), value :: pair
      real(c_double), intent(in) :: densities_1(*)
      integer(c_size_t), value :: n_1
      real(c_double), intent(in) :: densities_2(*)
      integer(c_size_t), value :: n_2
      integer(c_int32_t), value :: n_threads
      type(c_ptr), value :: l21
      type(c_ptr), value :: l12
      integer(c_int32_t) :: status
    end function

    function ko_pair_sensitivities(pair, densities_1, n_1, densities_2, n_2, n_threads, d21_d1, d21_d2, d12_d1, &
      d12_d2) bind(c) result(status)
      import
      type(c_ptr), value :: pair
      real(c_double), intent(in) :: densities_1(*)
      integer(c_size_t), value :: n_1
      real(c_double), intent(in) :: densities_2(*)
      integer(c_size_t), value :: n_2
      integer(c_int32_t), value :: n_threads
      real(c_double), intent(inout) :: d21_d1(*)
      real(c_double), intent(inout) :: d21_d2(*)
      real(c_double), intent(inout) :: d12_d1(*)
      real(c_double), intent(inout) :: d12_d2(*)
      integer(c_int32_t) :: status
    end function

    function ko_pair_topological_sensitivities(pair, densities_1, n_1, densities_2, n_2, change, n_threads, d21_d1, d21_d2, &
      d12_d1, d12_d2) bind(c) result(status)
      import
      type(c_ptr), value :: pair
      real(c_double), intent(in) :: densities_1(*)
      integer(c_size_t), value :: n_1
      real(c_double), intent(in) :: densities_2(*)
      integer(c_size_t), value :: n_2
      integer(c_int32_t), value :: change
      integer(c_int32_t), value :: n_threads
      real(c_double), intent(inout) :: d21_d1(*)
      real(c_double), intent(inout) :: d21_d2(*)
      real(c_double), intent(inout) :: d12_d1(*)
      real(c_double), intent(inout) :: d12_d2(*)
      integer(c_int32_t) :: status
    end function

    function ko_pair_colliding(pair, n_1, n_2, cells_1, cells_2) bind(c) result(status)
      import
      type(c_ptr), value :: pair
      integer(c_size_t), value :: n_1
      integer(c_size_t), value :: n_2
      integer(c_int8_t), intent(inout) :: cells_1(*)
      integer(c_int8_t), intent(inout) :: cells_2(*)
      integer(c_int32_t) :: status
    end function

    function ko_pair_volumes(pair, set_1, n_1, set_2, n_2, volumes, gamma, n_lost) bind(c) result(status)
      import
      type(c_ptr), value :: pair
      integer(c_int8_t), intent(in) :: set_1(*)
      integer(c_size_t), value :: n_1
      integer(c_int8_t), intent(in) :: set_2(*)
      integer(c_size_t), value :: n_2
      real(c_double), intent(inout) :: volumes(*)
      real(c_double), intent(inout) :: gamma
      integer(c_size_t), intent(inout) :: n_lost
      integer(c_int32_t) :: status
    end function

    function ko_pair_close(pair, set_1, set_2, from, n_1, n_2, cells_1, cells_2, gamma) bind(c) result(status)
      import
      type(c_ptr), value :: pair
      type(c_ptr), value :: set_1
      type(c_ptr), value :: set_2
      integer(c_int32_t), value :: from
      integer(c_size_t), value :: n_1
      integer(c_size_t), value :: n_2
      integer(c_int8_t), intent(inout) :: cells_1(*)
      integer(c_int8_t), intent(inout) :: cells_2(*)
      real(c_double), intent(inout) :: gamma
      integer(c_int32_t) :: status
    end function

    function ko_pair_cut(pair, weights_1, weights_2, options, n_1, n_2, cells_1, cells_2, weight, bound, &
      gamma) bind(c) result(status)
      import
      type(c_ptr), value :: pair
      type(c_ptr), value :: weights_1
      type(c_ptr), value :: weights_2
      type(ko_family_options), intent(in) :: options
      integer(c_size_t), value :: n_1
      integer(c_size_t), value :: n_2
      integer(c_int8_t), intent(inout) :: cells_1(*)
      integer(c_int8_t), intent(inout) :: cells_2(*)
      real(c_double), intent(inout) :: weight
      real(c_double), intent(inout) :: bound
      real(c_double), intent(inout) :: gamma
      integer(c_int32_t) :: status
    end function

    function ko_pair_family(pair, weights_1, weights_2, gammas, n_gammas, options, n_1, n_2, cells_1, cells_2, reached, &
      volumes, bounds) bind(c) result(status)
      import
      type(c_ptr), value :: pair
      type(c_ptr), value :: weights_1
      type(c_ptr), value :: weights_2
      real(c_double), intent(in) :: gammas(*)
      integer(c_size_t), value :: n_gammas
      type(ko_family_options), intent(in) :: options
      integer(c_size_t), value :: n_1
      integer(c_size_t), value :: n_2
      integer(c_int8_t), intent(inout) :: cells_1(*)
      integer(c_int8_t), intent(inout) :: cells_2(*)
      type(c_ptr), value :: reached
      type(c_ptr), value :: volumes
      type(c_ptr), value :: bounds
      integer(c_int32_t) :: status
    end function

    function ko_pair_optimise(pair, options, n_1, n_2, densities_1, densities_2, cells_1, cells_2, history, report_size, &
      report) bind(c) result(status)
      import
      type(c_ptr), value :: pair
      type(ko_optimise_options), intent(in) :: options
      integer(c_size_t), value :: n_1
      integer(c_size_t), value :: n_2
      type(c_ptr), value :: densities_1
      type(c_ptr), value :: densities_2
      integer(c_int8_t), intent(inout) :: cells_1(*)
      integer(c_int8_t), intent(inout) :: cells_2(*)
      type(c_ptr), value :: history
      integer(c_size_t), value :: report_size
      type(ko_optimise_report), intent(inout) :: report
      integer(c_int32_t) :: status
    end function

    function ko_pair_contact(pair, set_1, n_1, set_2, n_2, n_times, n_threads, progress, progress_data, gaps, cells, places, &
      largest, mean) bind(c) result(status)
      import
      type(c_ptr), value :: pair
      integer(c_int8_t), intent(in) :: set_1(*)
      integer(c_size_t), value :: n_1
      integer(c_int8_t), intent(in) :: set_2(*)
      integer(c_size_t), value :: n_2
      integer(c_size_t), value :: n_times
      integer(c_int32_t), value :: n_threads
      type(c_funptr), value :: progress
      type(c_ptr), value :: progress_data
      type(c_ptr), value :: gaps
      type(c_ptr), value :: cells
      type(c_ptr), value :: places
      real(c_double), intent(inout) :: largest
      real(c_double), intent(inout) :: mean
      integer(c_int32_t) :: status
    end function

    function ko_pair_more_persistent(pair, set_1, set_2, weights_1, weights_2, options, n_1, n_2, cells_1, cells_2, before, &
      after, n_tries) bind(c) result(status)
      import
      type(c_ptr), value :: pair
      integer(c_int8_t), intent(in) :: set_1(*)
      integer(c_int8_t), intent(in) :: set_2(*)
      type(c_ptr), value :: weights_1
      type(c_ptr), value :: weights_2
      type(ko_persistence_options), intent(in) :: options
      integer(c_size_t), value :: n_1
      integer(c_size_t), value :: n_2
      integer(c_int8_t), intent(inout) :: cells_1(*)
      integer(c_int8_t), intent(inout) :: cells_2(*)
      real(c_double), intent(inout) :: before
      real(c_double), intent(inout) :: after
      integer(c_size_t), intent(inout) :: n_tries
      integer(c_int32_t) :: status
    end function

    function ko_arrange_options_init(options, struct_size) bind(c) result(status)
      import
      type(ko_arrange_options), intent(inout) :: options
      integer(c_size_t), value :: struct_size
      integer(c_int32_t) :: status
    end function

    function ko_assembly_create(parts, motions, n_parts, options, assembly) bind(c) result(status)
      import
      type(c_ptr), intent(in) :: parts(*)
      type(c_ptr), intent(in) :: motions(*)
      integer(c_size_t), value :: n_parts
      type(ko_pair_options), intent(in) :: options
      type(c_ptr), intent(out) :: assembly
      integer(c_int32_t) :: status
    end function

    subroutine ko_assembly_free(assembly) bind(c)
      import
      type(c_ptr), value :: assembly
    end subroutine

    function ko_assembly_get_report(assembly, report_size, report) bind(c) result(status)
      import
      type(c_ptr), value :: assembly
      integer(c_size_t), value :: report_size
      type(ko_assembly_report), intent(inout) :: report
      integer(c_int32_t) :: status
    end function

    function ko_assembly_copy_meetings(assembly, n_meetings, meetings) bind(c) result(status)
      import
      type(c_ptr), value :: assembly
      integer(c_size_t), value :: n_meetings
      integer(c_size_t), intent(inout) :: meetings(*)
      integer(c_int32_t) :: status
    end function

    function ko_assembly_close(assembly, sets, order, n_cells, cells) bind(c) result(status)
      import
      type(c_ptr), value :: assembly
      integer(c_int8_t), intent(in) :: sets(*)
      type(c_ptr), value :: order
      integer(c_size_t), value :: n_cells
      integer(c_int8_t), intent(inout) :: cells(*)
      integer(c_int32_t) :: status
    end function

    function ko_assembly_arrange(assembly, weights, options, n_cells, cells, weight, bound, n_cuts) bind(c) result(status)
      import
      type(c_ptr), value :: assembly
      type(c_ptr), value :: weights
      type(ko_arrange_options), intent(in) :: options
      integer(c_size_t), value :: n_cells
      integer(c_int8_t), intent(inout) :: cells(*)
      real(c_double), intent(inout) :: weight
      real(c_double), intent(inout) :: bound
      integer(c_size_t), intent(inout) :: n_cuts
      integer(c_int32_t) :: status
    end function
  end interface
end module

! Handles. A keepout_mesh, _cloud, _field, _sensitivity, _body, _constraints, _explicit, _motion, _part, _pair or _assembly is filled by a
!   call on it (`call field%fit(cloud)`), which frees what it held, and is freed by free() or when it goes out of scope. It has one owner:
!   assigning one ends the program.
!   Fortran copies past that assignment in `allocate (c, source=mesh)` and in structure constructors, holder(mesh): never do either, both
!   would free what there is once. To move a handle make it allocatable and call move_alloc.
! Errors. Each call ends with stat and errmsg, both optional, as those of allocate: stat is KO_OK, a remark (KO_OPEN_AT_BOX,
!   KO_BUDGET_REACHED) or one of KO_ERR_..., errmsg is set on failure. A call that fails without stat ends the program with its message.
! Threads. As in C: calls that take their handle as intent(in) may be made at once from any number of threads.
module keepout
  use keepout_c
  use, intrinsic :: iso_fortran_env, only: error_unit
  implicit none

  private :: error_unit, has_room, is_path

  ! Whether polylines go back to their first points.
  integer, parameter :: KEEPOUT_OPEN = 0
  integer, parameter :: KEEPOUT_CLOSED = 1

  ! A triangulated surface in space, or polylines in the plane: there a triangle is a segment.
  type :: keepout_mesh
    type(c_ptr), private :: handle = c_null_ptr
    integer, private :: width = 0
    integer(c_size_t), private :: vertices = 0
    integer(c_size_t), private :: triangles = 0
  contains
    procedure :: read => mesh_read
    procedure :: write => mesh_write
    procedure :: from_triangles => mesh_from_triangles
    procedure :: from_polylines => mesh_from_polylines
    procedure :: free => mesh_free
    procedure :: dim => mesh_dim
    procedure :: n_vertices => mesh_n_vertices
    procedure :: n_triangles => mesh_n_triangles
    procedure :: copy => mesh_copy
    procedure :: copy_polylines => mesh_copy_polylines
    procedure :: report => mesh_report
    procedure :: flip => mesh_flip
    procedure :: sample => mesh_sample
    procedure :: signed_distance => mesh_signed_distance
    procedure :: copy_component_points => mesh_copy_component_points
    procedure :: c_handle => mesh_c_handle
    procedure, private :: mesh_assign
    generic :: assignment(=) => mesh_assign
    final :: mesh_final
  end type

  ! Points of a surface in space, or of a curve in the plane, with unit normals.
  type :: keepout_cloud
    type(c_ptr), private :: handle = c_null_ptr
    integer, private :: width = 0
    integer(c_size_t), private :: points = 0
  contains
    procedure :: from_points => cloud_from_points
    procedure :: estimate_normals => cloud_estimate_normals
    procedure :: free => cloud_free
    procedure :: dim => cloud_dim
    procedure :: n_points => cloud_n_points
    procedure :: copy => cloud_copy
    procedure :: copy_origins => cloud_copy_origins
    procedure :: set_weights => cloud_set_weights
    procedure :: smooth => cloud_smooth
    procedure :: sides => cloud_sides
    procedure :: follow => cloud_follow
    procedure :: pull_back => cloud_pull_back
    procedure :: c_handle => cloud_c_handle
    procedure, private :: cloud_assign
    generic :: assignment(=) => cloud_assign
    final :: cloud_final
  end type

  ! A level-set function phi, close to the signed distance to a shape.
  type :: keepout_field
    type(c_ptr), private :: handle = c_null_ptr
    integer, private :: width = 0
  contains
    procedure :: fit => field_fit
    procedure :: refit => field_refit
    procedure :: from_control_points => field_from_control_points
    procedure :: load => field_load
    procedure :: save => field_save
    procedure :: free => field_free
    procedure :: dim => field_dim
    procedure :: report => field_report
    procedure :: control_points => field_control_points
    procedure :: eval => field_eval
    procedure :: eval_parallel => field_eval_parallel
    procedure :: eval_lattice => field_eval_lattice
    procedure :: level_set => field_level_set
    procedure :: certify => field_certify
    procedure :: outside_box => field_outside_box
    procedure :: c_handle => field_c_handle
    procedure, private :: field_assign
    generic :: assignment(=) => field_assign
    final :: field_final
  end type

  ! How values of a field change as its cloud does: ready for any number of solves, one a J = sum of w_j phi(x_j).
  type :: keepout_sensitivity
    type(c_ptr), private :: handle = c_null_ptr
    integer, private :: width = 0
    integer(c_size_t), private :: points = 0
  contains
    procedure :: create => sensitivity_create
    procedure :: free => sensitivity_free
    procedure :: solve => sensitivity_solve
    procedure :: c_handle => sensitivity_c_handle
    procedure, private :: sensitivity_assign
    generic :: assignment(=) => sensitivity_assign
    final :: sensitivity_final
  end type

  ! Points of a design that move with it, and how densely they cover its surface.
  type :: keepout_body
    type(c_ptr), private :: handle = c_null_ptr
    integer, private :: width = 0
    integer(c_size_t), private :: points = 0
  contains
    procedure :: from_points => body_from_points
    procedure :: from_mesh => body_from_mesh
    procedure :: free => body_free
    procedure :: dim => body_dim
    procedure :: n_points => body_n_points
    procedure :: covering_radius => body_covering_radius
    procedure :: copy_points => body_copy_points
    procedure :: c_handle => body_c_handle
    procedure, private :: body_assign
    generic :: assignment(=) => body_assign
    final :: body_final
  end type

  ! Requirements that samples of a design lie where fields are positive, over one vector of variables x (n_variables).
  type :: keepout_constraints
    type(c_ptr), private :: handle = c_null_ptr
  contains
    procedure :: create => constraints_create
    procedure :: free => constraints_free
    procedure :: add_frame => constraints_add_frame
    procedure :: add_fixed_frame => constraints_add_fixed_frame
    procedure :: add_points => constraints_add_points
    procedure :: keep_body => constraints_keep_body
    procedure :: keep_points => constraints_keep_points
    procedure :: keep_body_in_fields => constraints_keep_body_in_fields
    procedure :: keep_points_in_fields => constraints_keep_points_in_fields
    procedure :: get_size => constraints_get_size
    procedure :: frame_variables => constraints_frame_variables
    procedure :: points_variables => constraints_points_variables
    procedure :: values => constraints_values
    procedure :: jacobian_pattern => constraints_jacobian_pattern
    procedure :: jacobian => constraints_jacobian
    procedure :: values_and_jacobian => constraints_values_and_jacobian
    procedure :: dense_jacobian => constraints_dense_jacobian
    procedure :: jacobian_times => constraints_jacobian_times
    procedure :: transposed_jacobian_times => constraints_transposed_jacobian_times
    procedure :: hessian_pattern => constraints_hessian_pattern
    procedure :: hessian => constraints_hessian
    procedure :: c_handle => constraints_c_handle
    procedure, private :: constraints_assign
    generic :: assignment(=) => constraints_assign
    final :: constraints_final
  end type

  ! A formulation that is a formula of the points of a cloud, to compare a field with.
  type :: keepout_explicit
    type(c_ptr), private :: handle = c_null_ptr
    integer, private :: width = 0
  contains
    procedure :: create => explicit_create
    procedure :: free => explicit_free
    procedure :: dim => explicit_dim
    procedure :: smoothing => explicit_smoothing
    procedure :: eval => explicit_eval
    procedure :: c_handle => explicit_c_handle
    procedure, private :: explicit_assign
    generic :: assignment(=) => explicit_assign
    final :: explicit_final
  end type

  ! A rigid motion of one parameter t in [0, 1], from a part's frame to the world. Rotations are matrices R here: x_w = R x + t.
  type :: keepout_motion
    type(c_ptr), private :: handle = c_null_ptr
    integer, private :: width = 0
  contains
    procedure :: fixed => motion_fixed
    procedure :: slide => motion_slide
    procedure :: turn => motion_turn
    procedure :: screw => motion_screw
    procedure :: sampled => motion_sampled
    procedure :: from_function => motion_from_function
    procedure :: product => motion_product
    procedure :: inverse => motion_inverse
    procedure :: free => motion_free
    procedure :: dim => motion_dim
    procedure :: eval => motion_eval
    procedure :: c_handle => motion_c_handle
    procedure, private :: motion_assign
    generic :: assignment(=) => motion_assign
    final :: motion_final
  end type

  ! A grid of square or cubic cells, and what a part may do with each. Cells are numbered with the last axis the fastest; sets of them are arrays
  ! of 0 and 1, densities arrays of numbers in [0, 1].
  type :: keepout_part
    type(c_ptr), private :: handle = c_null_ptr
    integer, private :: width = 0
    integer(c_size_t), private :: n = 0
  contains
    procedure :: create => part_create
    procedure :: free => part_free
    procedure :: dim => part_dim
    procedure :: n_cells => part_n_cells
    procedure :: grid => part_grid
    procedure :: copy_cells => part_copy_cells
    procedure :: fractions_of_mesh => part_fractions_of_mesh
    procedure :: fractions_of_field => part_fractions_of_field
    procedure :: fractions_of_box => part_fractions_of_box
    procedure :: fractions_of_ball => part_fractions_of_ball
    procedure :: fractions_of_cylinder => part_fractions_of_cylinder
    procedure :: mesh_of_cells => part_mesh_of_cells
    procedure :: mesh_of_densities => part_mesh_of_densities
    procedure :: sweep => part_sweep
    procedure :: unsweep => part_unsweep
    procedure :: c_handle => part_c_handle
    procedure, private :: part_assign
    generic :: assignment(=) => part_assign
    final :: part_final
  end type

  ! Two parts in relative motion: how they collide, and sets of cells that never do.
  type :: keepout_pair
    type(c_ptr), private :: handle = c_null_ptr
    integer, private :: width = 0
    integer(c_size_t), private :: n(2) = 0
  contains
    procedure :: create => pair_create
    procedure :: free => pair_free
    procedure :: report => pair_report
    procedure :: measures => pair_measures
    procedure :: local_measures => pair_local_measures
    procedure :: sensitivities => pair_sensitivities
    procedure :: topological_sensitivities => pair_topological_sensitivities
    procedure :: colliding => pair_colliding
    procedure :: volumes => pair_volumes
    procedure :: close => pair_close
    procedure :: cut => pair_cut
    procedure :: family => pair_family
    procedure :: optimise => pair_optimise
    procedure :: contact => pair_contact
    procedure :: more_persistent => pair_more_persistent
    procedure :: c_handle => pair_c_handle
    procedure, private :: pair_assign
    generic :: assignment(=) => pair_assign
    final :: pair_final
  end type

  ! Any number of parts, none of which collides with another. Sets and weights are of the cells of all parts, part after part.
  type :: keepout_assembly
    type(c_ptr), private :: handle = c_null_ptr
    integer, private :: width = 0
    integer, private :: parts = 0
    integer(c_size_t), private :: n = 0
  contains
    procedure :: create => assembly_create
    procedure :: free => assembly_free
    procedure :: dim => assembly_dim
    procedure :: n_parts => assembly_n_parts
    procedure :: n_cells => assembly_n_cells
    procedure :: report => assembly_report
    procedure :: copy_meetings => assembly_copy_meetings
    procedure :: close => assembly_close
    procedure :: arrange => assembly_arrange
    procedure :: c_handle => assembly_c_handle
    procedure, private :: assembly_assign
    generic :: assignment(=) => assembly_assign
    final :: assembly_final
  end type

  ! Extended by who wants to be told of progress, with what he keeps meanwhile.
  type, abstract :: keepout_listener
  contains
    procedure(hear_progress), deferred :: hear
  end type

  abstract interface
    ! fraction: done, in [0, 1]. stage: its name. cancel: set to .true. to stop; the call then fails with KO_ERR_CANCELLED.
    subroutine hear_progress(self, fraction, stage, cancel)
      import :: keepout_listener, c_double
      class(keepout_listener), intent(inout) :: self
      real(c_double), intent(in) :: fraction
      character(len=*), intent(in) :: stage
      logical, intent(inout) :: cancel
    end subroutine
  end interface

  ! A listener on its way through C, which knows addresses of plain types only.
  type, private :: listener_box
    class(keepout_listener), pointer :: listener => null()
  end type

  interface
    function keepout_strlen(text) bind(c, name="strlen") result(length)
      import
      type(c_ptr), value :: text
      integer(c_size_t) :: length
    end function
  end interface

  private :: keepout_strlen, from_c, to_c, settle, conclude, refuse, right_shape, right_size, of_cloud, mesh_adopt, cloud_adopt
  private :: field_adopt
  private :: mesh_read, mesh_from_triangles, mesh_from_polylines, mesh_free, mesh_dim, mesh_n_vertices, mesh_n_triangles, mesh_copy
  private :: mesh_report, mesh_flip, mesh_sample, mesh_signed_distance, mesh_c_handle, mesh_assign, mesh_final
  private :: mesh_write, mesh_copy_polylines, cloud_estimate_normals, field_refit, field_from_control_points, field_control_points
  private :: field_eval_lattice, field_level_set, field_certify, mesh_copy_component_points, listen
  private :: cloud_from_points, cloud_free, cloud_dim, cloud_n_points, cloud_copy, cloud_copy_origins, cloud_set_weights
  private :: cloud_smooth, cloud_sides, cloud_c_handle, cloud_assign, cloud_final
  private :: field_fit, field_load, field_save, field_free, field_dim, field_report, field_eval, field_eval_parallel
  private :: body_from_points, body_from_mesh, body_free, body_dim, body_n_points, body_covering_radius, body_copy_points
  private :: body_c_handle, body_assign, body_final, body_adopt
  private :: constraints_create, constraints_free, constraints_add_frame, constraints_add_fixed_frame, constraints_add_points
  private :: constraints_keep_body, constraints_keep_points, constraints_get_size, constraints_frame_variables
  private :: constraints_points_variables, constraints_values, constraints_jacobian_pattern, constraints_jacobian
  private :: constraints_values_and_jacobian, constraints_dense_jacobian, constraints_jacobian_times
  private :: constraints_transposed_jacobian_times, constraints_hessian_pattern, constraints_hessian, constraints_c_handle
  private :: constraints_assign, constraints_final, constraints_keep_body_in_fields, constraints_keep_points_in_fields
  private :: explicit_create, explicit_free, explicit_dim, explicit_smoothing, explicit_eval, explicit_c_handle, explicit_assign
  private :: explicit_final, cloud_follow, cloud_pull_back, sensitivity_create, sensitivity_free, sensitivity_solve
  private :: sensitivity_c_handle, sensitivity_assign, sensitivity_final
  private :: field_outside_box, field_c_handle, field_assign, field_final, addresses, pass_on, hear_progress
  private :: motion_fixed, motion_slide, motion_turn, motion_screw, motion_sampled, motion_from_function, motion_product
  private :: motion_inverse, motion_free, motion_dim, motion_eval, motion_c_handle, motion_assign, motion_final, motion_adopt
  private :: part_create, part_free, part_dim, part_n_cells, part_grid, part_copy_cells, part_fractions_of_mesh
  private :: part_fractions_of_field, part_fractions_of_box, part_fractions_of_ball, part_fractions_of_cylinder, part_sweep
  private :: part_unsweep, part_c_handle, part_assign, part_final
  private :: pair_create, pair_free, pair_report, pair_measures, pair_local_measures, pair_sensitivities, pair_colliding
  private :: pair_volumes, pair_close, pair_cut, pair_family, pair_optimise, pair_contact, pair_c_handle, pair_assign, pair_final
  private :: part_mesh_of_cells, part_mesh_of_densities, pair_topological_sensitivities, pair_more_persistent
  private :: assembly_create, assembly_free, assembly_dim, assembly_n_parts, assembly_n_cells, assembly_report
  private :: assembly_copy_meetings, assembly_close, assembly_arrange, assembly_c_handle, assembly_assign, assembly_final
  private :: of_pair, given, motion_of, with_symmetries, boundary

contains

  ! ---- What has no handle

  ! Message of the last C call that failed on this thread.
  function keepout_last_error() result(message)
    character(:), allocatable :: message
    message = from_c(ko_last_error())
  end function

  ! Name of a status, "KO_ERR_IO", say.
  function keepout_status_string(status) result(name)
    integer(c_int32_t), intent(in) :: status
    character(:), allocatable :: name
    name = from_c(ko_status_string(status))
  end function

  ! Version of the library, "major.minor.patch".
  function keepout_version() result(version)
    character(:), allocatable :: version
    version = from_c(ko_version())
  end function

  ! Options of fits with the defaults.
  function keepout_fit_options() result(options)
    type(ko_fit_options) :: options
    call settle(ko_fit_options_init(options, c_sizeof(options)))
  end function

  ! Options of estimates of normals with the defaults.
  function keepout_normal_options() result(options)
    type(ko_normal_options) :: options
    call settle(ko_normal_options_init(options, c_sizeof(options)))
  end function

  ! Options of smoothing with the defaults.
  function keepout_smooth_options() result(options)
    type(ko_smooth_options) :: options
    call settle(ko_smooth_options_init(options, c_sizeof(options)))
  end function

  ! Options of level sets with the defaults.
  function keepout_level_set_options() result(options)
    type(ko_level_set_options) :: options
    call settle(ko_level_set_options_init(options, c_sizeof(options)))
  end function

  ! Options of certificates with the defaults.
  function keepout_certify_options() result(options)
    type(ko_certify_options) :: options
    call settle(ko_certify_options_init(options, c_sizeof(options)))
  end function

  ! Options of explicit formulations with the defaults.
  function keepout_explicit_options() result(options)
    type(ko_explicit_options) :: options
    call settle(ko_explicit_options_init(options, c_sizeof(options)))
  end function

  ! How values of samples become one, with the defaults: KS.
  function keepout_aggregation() result(aggregation)
    type(ko_aggregation) :: aggregation
    call settle(ko_aggregation_init(aggregation, c_sizeof(aggregation)))
  end function

  ! f(t) = offset + slope t + the sum of a cos(2 pi c t + p) over waves (3, n), each a, c, p. `waves` must be a target that stays as long as
  ! the law is used.
  function keepout_law(slope, offset, waves) result(law)
    real(c_double), intent(in), optional :: slope, offset
    real(c_double), intent(in), contiguous, target, optional :: waves(:, :)
    type(ko_law) :: law
    call settle(ko_law_init(law, c_sizeof(law)))
    if (present(slope)) law%slope = slope
    if (present(offset)) law%offset = offset
    if (present(waves)) then
      if (.not. right_size("waves", "rows", size(waves, 1), 3)) return
      law%n_waves = size(waves, 2, c_size_t)
      if (law%n_waves > 0) law%waves = c_loc(waves)
    end if
  end function

  ! Options of pairs, sweeps and unsweeps with the defaults.
  function keepout_pair_options() result(options)
    type(ko_pair_options) :: options
    call settle(ko_pair_options_init(options, c_sizeof(options)))
  end function

  ! Options of cuts and families with the defaults.
  function keepout_family_options() result(options)
    type(ko_family_options) :: options
    call settle(ko_family_options_init(options, c_sizeof(options)))
  end function

  ! Options of optimisations with the defaults.
  function keepout_optimise_options() result(options)
    type(ko_optimise_options) :: options
    call settle(ko_optimise_options_init(options, c_sizeof(options)))
  end function

  ! Options of searches for persistent pairs with the defaults.
  function keepout_persistence_options() result(options)
    type(ko_persistence_options) :: options
    call settle(ko_persistence_options_init(options, c_sizeof(options)))
  end function

  ! Options of arrangements of assemblies with the defaults.
  function keepout_arrange_options() result(options)
    type(ko_arrange_options) :: options
    call settle(ko_arrange_options_init(options, c_sizeof(options)))
  end function

  ! A map by which pairs shall be symmetric, a column of `symmetries` of pair%cut and pair%family: x goes to A x + b in the part's own frame, with
  ! A the matrix (dim, dim) and b the vector (dim) of each part.
  function keepout_symmetry(matrix_1, vector_1, matrix_2, vector_2) result(map)
    real(c_double), intent(in) :: matrix_1(:, :), vector_1(:), matrix_2(:, :), vector_2(:)
    real(c_double) :: map(2 * size(vector_1) * (size(vector_1) + 1))
    integer :: dim
    dim = size(vector_1)
    map = 0
    if (.not. right_size("vector_2", "entries", size(vector_2), dim)) return
    if (.not. right_shape("matrix_1", shape(matrix_1), [dim, dim])) return
    if (.not. right_shape("matrix_2", shape(matrix_2), [dim, dim])) return
    ! Rows one after another, as C has them.
    map = [transpose(matrix_1), vector_1, transpose(matrix_2), vector_2]
  end function

  ! The aggregate of values (n), with D the `unit`, and its derivatives: gradient (n), and hessian (n (n + 1) / 2), rows of the lower
  ! triangle. `extreme` is KO_LEAST or KO_LARGEST.
  subroutine keepout_aggregate(aggregation, extreme, unit, values, value, gradient, hessian, stat, errmsg)
    type(ko_aggregation), intent(in) :: aggregation
    integer(c_int32_t), intent(in) :: extreme
    real(c_double), intent(in) :: unit
    real(c_double), intent(in), contiguous :: values(:)
    real(c_double), intent(inout) :: value
    real(c_double), intent(inout), contiguous, target, optional :: gradient(:)
    real(c_double), intent(inout), contiguous, target, optional :: hessian(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: to(2)
    integer :: n
    to = c_null_ptr
    n = size(values)
    if (present(gradient)) then
      if (.not. right_size("gradient", "entries", size(gradient), n, stat, errmsg)) return
      if (n > 0) to(1) = c_loc(gradient)
    end if
    if (present(hessian)) then
      if (.not. right_size("hessian", "entries", size(hessian), n * (n + 1) / 2, stat, errmsg)) return
      if (n > 0) to(2) = c_loc(hessian)
    end if
    call settle(ko_aggregate(aggregation, extreme, unit, values, size(values, 1, c_size_t), value, to(1), to(2)), stat, errmsg)
  end subroutine

  ! How far `below` and `above` the least of `n_values` values an aggregate may lie, in units of D; `least` is the least value in units
  ! of D, and counts for KO_AGGREGATE_P_NORM alone.
  subroutine keepout_aggregation_bounds(aggregation, n_values, least, below, above, stat, errmsg)
    type(ko_aggregation), intent(in) :: aggregation
    integer, intent(in) :: n_values
    real(c_double), intent(in) :: least
    real(c_double), intent(inout) :: below, above
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_aggregation_bounds(aggregation, int(max(n_values, 0), c_size_t), least, below, above), stat, errmsg)
  end subroutine

  ! ---- Meshes

  ! From an OBJ, STL, PLY or OFF file. Blanks at the end of `path` do not count.
  subroutine mesh_read(self, path, stat, errmsg)
    class(keepout_mesh), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    if (.not. is_path(path, stat, errmsg)) return
    status = ko_mesh_read(to_c(path), handle)
    if (status >= KO_OK) call mesh_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! To the file `path`, whose ending names the format: .obj, .off, .ply or .stl. Blanks at the end of `path` do not count.
  subroutine mesh_write(self, path, stat, errmsg)
    class(keepout_mesh), intent(in) :: self
    character(len=*), intent(in) :: path
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (.not. is_path(path, stat, errmsg)) return
    call settle(ko_mesh_write(self%handle, to_c(path)), stat, errmsg)
  end subroutine

  ! From vertices (3, n_vertices) and triangles (3, n_triangles), indices from 0, counter-clockwise seen from outside.
  subroutine mesh_from_triangles(self, vertices, triangles, stat, errmsg)
    class(keepout_mesh), intent(inout) :: self
    real(c_double), intent(in), contiguous :: vertices(:, :)
    integer(c_int32_t), intent(in), contiguous :: triangles(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    if (.not. right_size("vertices", "rows", size(vertices, 1), 3, stat, errmsg)) return
    if (.not. right_size("triangles", "rows", size(triangles, 1), 3, stat, errmsg)) return
    status = ko_mesh_from_triangles(vertices, size(vertices, 2, c_size_t), triangles, size(triangles, 2, c_size_t), handle)
    if (status >= KO_OK) call mesh_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! From points (2, n) of the plane, of which polyline i begins at loop_starts(i), counted from 0. Without `kind` they are closed;
  ! a solid lies on the left of closed ones.
  subroutine mesh_from_polylines(self, points, loop_starts, kind, stat, errmsg)
    class(keepout_mesh), intent(inout) :: self
    real(c_double), intent(in), contiguous :: points(:, :)
    integer, intent(in) :: loop_starts(:)
    integer, intent(in), optional :: kind
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle
    integer(c_int32_t) :: status, closed
    if (.not. right_size("points", "rows", size(points, 1), 2, stat, errmsg)) return
    closed = KEEPOUT_CLOSED
    if (present(kind)) closed = int(kind, c_int32_t)
    status = ko_mesh_from_polylines(points, size(points, 2, c_size_t), int(loop_starts, c_size_t), &
      size(loop_starts, 1, c_size_t), closed, handle)
    if (status >= KO_OK) call mesh_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  subroutine mesh_free(self)
    class(keepout_mesh), intent(inout) :: self
    call ko_mesh_free(self%handle)
    self%handle = c_null_ptr
    self%width = 0
    self%vertices = 0
    self%triangles = 0
  end subroutine

  ! 3 in space, 2 in the plane, 0 where nothing is held.
  pure integer function mesh_dim(self)
    class(keepout_mesh), intent(in) :: self
    mesh_dim = self%width
  end function

  pure integer(c_size_t) function mesh_n_vertices(self)
    class(keepout_mesh), intent(in) :: self
    mesh_n_vertices = self%vertices
  end function

  pure integer(c_size_t) function mesh_n_triangles(self)
    class(keepout_mesh), intent(in) :: self
    mesh_n_triangles = self%triangles
  end function

  ! Allocates and fills vertices (dim, n_vertices) and triangles (dim, n_triangles).
  subroutine mesh_copy(self, vertices, triangles, stat, errmsg)
    class(keepout_mesh), intent(in) :: self
    real(c_double), allocatable, target, intent(out) :: vertices(:, :)
    integer(c_int32_t), allocatable, target, intent(out) :: triangles(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer :: failed
    allocate (vertices(self%width, self%vertices), triangles(self%width, self%triangles), stat=failed)
    if (.not. has_room(failed, stat, errmsg)) return
    call settle(ko_mesh_copy(self%handle, self%vertices, self%triangles, c_loc(vertices), c_loc(triangles)), stat, errmsg)
  end subroutine

  ! Allocates and fills points (2, n) with the curves that the segments of a mesh of the plane make: polyline i begins at
  ! loop_starts(i), counted from 0, and goes back to its first point where closed(i) is 1, else 0. Open ones come first.
  subroutine mesh_copy_polylines(self, points, loop_starts, closed, stat, errmsg)
    class(keepout_mesh), intent(in) :: self
    real(c_double), allocatable, target, intent(out) :: points(:, :)
    integer(c_size_t), allocatable, target, intent(out) :: loop_starts(:)
    integer(c_int8_t), allocatable, target, intent(out) :: closed(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_size_t) :: n_points, n_loops
    integer(c_int32_t) :: status
    integer :: failed
    n_points = 0
    n_loops = 0
    status = ko_mesh_get_polylines_size(self%handle, n_points, n_loops)
    allocate (points(2, n_points), loop_starts(n_loops), closed(n_loops), stat=failed)
    if (.not. has_room(failed, stat, errmsg)) return
    if (status >= KO_OK) status = ko_mesh_copy_polylines(self%handle, n_points, n_loops, c_loc(points), c_loc(loop_starts), &
      c_loc(closed))
    call settle(status, stat, errmsg)
  end subroutine

  ! What can be said of the mesh.
  subroutine mesh_report(self, report, stat, errmsg)
    class(keepout_mesh), intent(in) :: self
    type(ko_mesh_report), intent(out) :: report
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_mesh_get_report(self%handle, c_sizeof(report), report), stat, errmsg)
  end subroutine

  ! Turns every triangle over; an inside-out solid becomes a solid.
  subroutine mesh_flip(self, stat, errmsg)
    class(keepout_mesh), intent(inout) :: self
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_mesh_flip(self%handle), stat, errmsg)
  end subroutine

  ! `n_points` points of the surface or the curves with normals, evenly spread, into `cloud`.
  subroutine mesh_sample(self, n_points, seed, cloud, stat, errmsg)
    class(keepout_mesh), intent(in) :: self
    integer, intent(in) :: n_points
    integer, intent(in) :: seed
    type(keepout_cloud), intent(inout) :: cloud
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    status = ko_mesh_sample(self%handle, int(max(n_points, 0), c_size_t), int(seed, c_int64_t), handle)
    if (status >= KO_OK) call cloud_adopt(cloud, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! Exact distances of points (dim, n) into distances (n): positive outside.
  subroutine mesh_signed_distance(self, points, distances, stat, errmsg)
    class(keepout_mesh), intent(in) :: self
    real(c_double), intent(in), contiguous :: points(:, :)
    real(c_double), intent(inout), contiguous :: distances(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (self%width > 0) then
      if (.not. right_size("points", "rows", size(points, 1), self%width, stat, errmsg)) return
      if (.not. right_size("distances", "entries", size(distances), size(points, 2), stat, errmsg)) return
    end if
    call settle(ko_mesh_signed_distance(self%handle, points, size(points, 2, c_size_t), distances), stat, errmsg)
  end subroutine

  ! Allocates and fills points (dim, n_components) with a vertex of each component, of parts that hang together by vertices that
  ! triangles share: what a body that swallows the component holds.
  subroutine mesh_copy_component_points(self, points, stat, errmsg)
    class(keepout_mesh), intent(in) :: self
    real(c_double), allocatable, intent(out) :: points(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_size_t) :: n_components
    integer(c_int32_t) :: status
    integer :: failed
    n_components = 0
    status = ko_mesh_get_component_count(self%handle, n_components)
    allocate (points(self%width, n_components), stat=failed)
    if (.not. has_room(failed, stat, errmsg)) return
    if (status >= KO_OK) status = ko_mesh_copy_component_points(self%handle, n_components, points)
    call settle(status, stat, errmsg)
  end subroutine

  ! For calls of keepout_c; it stays the mesh's.
  pure function mesh_c_handle(self) result(handle)
    class(keepout_mesh), intent(in) :: self
    type(c_ptr) :: handle
    handle = self%handle
  end function

  ! ---- Clouds

  ! From points (dim, n) and normals (dim, n) out of the solid, dim 2 or 3. Without normals they are estimated by the defaults.
  subroutine cloud_from_points(self, points, normals, stat, errmsg)
    class(keepout_cloud), intent(inout) :: self
    real(c_double), intent(in), contiguous :: points(:, :)
    real(c_double), intent(in), contiguous, target, optional :: normals(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle, given
    integer(c_int32_t) :: status
    given = c_null_ptr
    if (present(normals)) then
      if (.not. right_shape("normals", shape(normals), shape(points), stat, errmsg)) return
      given = c_loc(normals)
    end if
    status = ko_cloud_from_points(size(points, 1, c_int32_t), points, given, size(points, 2, c_size_t), handle)
    if (status >= KO_OK) call cloud_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! From points (dim, n) that come without normals, dim 2 or 3. Allocates and fills flags (n), each an or of KO_POINT_ bits; `report`
  ! is what was found, and `listener` is told of progress, on this thread.
  subroutine cloud_estimate_normals(self, points, options, listener, flags, report, stat, errmsg)
    class(keepout_cloud), intent(inout) :: self
    real(c_double), intent(in), contiguous :: points(:, :)
    type(ko_normal_options), intent(in), optional :: options
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int8_t), allocatable, target, intent(out), optional :: flags(:)
    type(ko_normal_report), target, intent(out), optional :: report
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_normal_options) :: plain
    type(listener_box), target :: box
    type(c_ptr) :: handle, to(2)
    integer(c_size_t) :: report_size
    integer(c_int32_t) :: status
    integer :: failed
    plain = keepout_normal_options()
    if (present(options)) plain = options
    if (present(listener)) call listen(box, listener, plain%progress, plain%progress_data)
    to = c_null_ptr
    report_size = 0
    if (present(flags)) then
      allocate (flags(size(points, 2)), stat=failed)
      if (.not. has_room(failed, stat, errmsg)) return
      to(1) = c_loc(flags)
    end if
    if (present(report)) then
      to(2) = c_loc(report)
      report_size = c_sizeof(report)
    end if
    status = ko_cloud_estimate_normals(size(points, 1, c_int32_t), points, size(points, 2, c_size_t), plain, handle, to(1), &
      report_size, to(2))
    if (status >= KO_OK) call cloud_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  subroutine cloud_free(self)
    class(keepout_cloud), intent(inout) :: self
    call ko_cloud_free(self%handle)
    self%handle = c_null_ptr
    self%width = 0
    self%points = 0
  end subroutine

  ! 3 in space, 2 in the plane, 0 where nothing is held.
  pure integer function cloud_dim(self)
    class(keepout_cloud), intent(in) :: self
    cloud_dim = self%width
  end function

  pure integer(c_size_t) function cloud_n_points(self)
    class(keepout_cloud), intent(in) :: self
    cloud_n_points = self%points
  end function

  ! Allocates and fills points (dim, n) and normals (dim, n), of length 1.
  subroutine cloud_copy(self, points, normals, stat, errmsg)
    class(keepout_cloud), intent(in) :: self
    real(c_double), allocatable, target, intent(out) :: points(:, :)
    real(c_double), allocatable, target, intent(out) :: normals(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer :: failed
    allocate (points(self%width, self%points), normals(self%width, self%points), stat=failed)
    if (.not. has_room(failed, stat, errmsg)) return
    call settle(ko_cloud_copy(self%handle, self%points, c_loc(points), c_loc(normals)), stat, errmsg)
  end subroutine

  ! Allocates and fills triangles (n), indices from 0, and barycentric (dim, n): where on its mesh each point was taken.
  subroutine cloud_copy_origins(self, triangles, barycentric, stat, errmsg)
    class(keepout_cloud), intent(in) :: self
    integer(c_int32_t), allocatable, target, intent(out) :: triangles(:)
    real(c_double), allocatable, target, intent(out) :: barycentric(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer :: failed
    allocate (triangles(self%points), barycentric(self%width, self%points), stat=failed)
    if (.not. has_room(failed, stat, errmsg)) return
    call settle(ko_cloud_copy_origins(self%handle, self%points, c_loc(triangles), c_loc(barycentric)), stat, errmsg)
  end subroutine

  ! Gives each point a weight, weights (n): how much a fit trusts it. Points of weight 0 take no part.
  subroutine cloud_set_weights(self, weights, stat, errmsg)
    class(keepout_cloud), intent(inout) :: self
    real(c_double), intent(in), contiguous :: weights(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_cloud_set_weights(self%handle, weights, size(weights, 1, c_size_t)), stat, errmsg)
  end subroutine

  ! Makes `smoothed` this cloud with noise smoothed out of points and normals, which must be about right before; weights stay, origins
  ! go. `listener` is told of progress, on this thread.
  subroutine cloud_smooth(self, smoothed, options, listener, stat, errmsg)
    class(keepout_cloud), intent(in) :: self
    type(keepout_cloud), intent(inout) :: smoothed
    type(ko_smooth_options), intent(in), optional :: options
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_smooth_options) :: plain
    type(listener_box), target :: box
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    plain = keepout_smooth_options()
    if (present(options)) plain = options
    if (present(listener)) call listen(box, listener, plain%progress, plain%progress_data)
    status = ko_cloud_smooth(self%handle, plain, handle)
    if (status >= KO_OK) call cloud_adopt(smoothed, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! On which side points (dim, n) lie, into sides (n): 1 where the normals point to, -1 behind them, towards 0 where there are none.
  subroutine cloud_sides(self, points, sides, stat, errmsg)
    class(keepout_cloud), intent(in) :: self
    real(c_double), intent(in), contiguous :: points(:, :)
    real(c_double), intent(inout), contiguous :: sides(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (self%width > 0) then
      if (.not. right_size("points", "rows", size(points, 1), self%width, stat, errmsg)) return
      if (.not. right_size("sides", "entries", size(sides), size(points, 2), stat, errmsg)) return
    end if
    call settle(ko_cloud_sides(self%handle, points, size(points, 2, c_size_t), sides), stat, errmsg)
  end subroutine

  ! Makes `moved` the cloud of the same places on `mesh`: the one that this was sampled from, with its vertices moved.
  subroutine cloud_follow(self, mesh, moved, stat, errmsg)
    class(keepout_cloud), intent(in) :: self
    type(keepout_mesh), intent(in) :: mesh
    type(keepout_cloud), intent(inout) :: moved
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    status = ko_cloud_follow(self%handle, mesh%handle, handle)
    if (status >= KO_OK) call cloud_adopt(moved, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! Takes derivatives by points and normals, d_points and d_normals (dim, n_points), absent for zeros, back to those by the vertices of
  ! `mesh`, into d_vertices (dim, n_vertices).
  subroutine cloud_pull_back(self, mesh, d_vertices, d_points, d_normals, stat, errmsg)
    class(keepout_cloud), intent(in) :: self
    type(keepout_mesh), intent(in) :: mesh
    real(c_double), intent(inout), contiguous :: d_vertices(:, :)
    real(c_double), intent(in), contiguous, target, optional :: d_points(:, :), d_normals(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: from(2)
    from = c_null_ptr
    if (self%width > 0) then
      if (.not. right_size("d_vertices", "rows", size(d_vertices, 1), self%width, stat, errmsg)) return
    end if
    if (present(d_points)) then
      if (.not. of_cloud("d_points", shape(d_points), self%width, self%points, stat, errmsg)) return
      from(1) = c_loc(d_points)
    end if
    if (present(d_normals)) then
      if (.not. of_cloud("d_normals", shape(d_normals), self%width, self%points, stat, errmsg)) return
      from(2) = c_loc(d_normals)
    end if
    call settle(ko_cloud_pull_back(self%handle, mesh%handle, from(1), from(2), self%points, size(d_vertices, 2, c_size_t), &
      d_vertices), stat, errmsg)
  end subroutine

  ! For calls of keepout_c; it stays the cloud's.
  pure function cloud_c_handle(self) result(handle)
    class(keepout_cloud), intent(in) :: self
    type(c_ptr) :: handle
    handle = self%handle
  end function

  ! ---- Fields

  ! Fits a field to `cloud`; `listener` is told of progress, on this thread.
  subroutine field_fit(self, cloud, options, listener, stat, errmsg)
    class(keepout_field), intent(inout) :: self
    type(keepout_cloud), intent(in) :: cloud
    type(ko_fit_options), intent(in), optional :: options
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_fit_options) :: plain
    type(listener_box), target :: box
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    plain = keepout_fit_options()
    if (present(options)) plain = options
    if (present(listener)) call listen(box, listener, plain%progress, plain%progress_data)
    status = ko_field_fit(cloud%handle, plain, handle)
    if (status >= KO_OK) call field_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! The same on the box of `start`, from its control points on; `start` stays as it is.
  subroutine field_refit(self, start, cloud, options, listener, stat, errmsg)
    class(keepout_field), intent(inout) :: self
    type(keepout_field), intent(in) :: start
    type(keepout_cloud), intent(in) :: cloud
    type(ko_fit_options), intent(in), optional :: options
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_fit_options) :: plain
    type(listener_box), target :: box
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    plain = keepout_fit_options()
    if (present(options)) plain = options
    if (present(listener)) call listen(box, listener, plain%progress, plain%progress_data)
    status = ko_field_refit(start%handle, cloud%handle, plain, handle)
    if (status >= KO_OK) call field_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! Of control points, as many as the product of counts (dim), the last axis fastest, on the box from box_min (dim) to box_max (dim);
  ! `feasible` is KO_FEASIBLE_OUTSIDE or KO_FEASIBLE_INSIDE, `diagonal` the D that the report shall have.
  subroutine field_from_control_points(self, counts, box_min, box_max, feasible, diagonal, control_points, stat, errmsg)
    class(keepout_field), intent(inout) :: self
    integer(c_int32_t), intent(in), contiguous :: counts(:)
    real(c_double), intent(in), contiguous :: box_min(:), box_max(:)
    integer(c_int32_t), intent(in) :: feasible
    real(c_double), intent(in) :: diagonal
    real(c_double), intent(in), contiguous :: control_points(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    if (.not. right_size("box_min", "entries", size(box_min), size(counts), stat, errmsg)) return
    if (.not. right_size("box_max", "entries", size(box_max), size(counts), stat, errmsg)) return
    status = ko_field_from_control_points(size(counts, 1, c_int32_t), counts, box_min, box_max, feasible, diagonal, &
      control_points, size(control_points, 1, c_size_t), handle)
    if (status >= KO_OK) call field_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! Puts `listener` into a box, and the box into the options of a call.
  subroutine listen(box, listener, progress, progress_data)
    type(listener_box), target, intent(inout) :: box
    class(keepout_listener), target, intent(inout) :: listener
    type(c_funptr), intent(out) :: progress
    type(c_ptr), intent(out) :: progress_data
    box%listener => listener
    progress = c_funloc(pass_on)
    progress_data = c_loc(box)
  end subroutine

  ! Stands between C and a listener.
  function pass_on(fraction, stage, data) bind(c, name="") result(cancelled)
    real(c_double), value :: fraction
    type(c_ptr), value :: stage
    type(c_ptr), value :: data
    integer(c_int32_t) :: cancelled
    type(listener_box), pointer :: box
    logical :: cancel
    call c_f_pointer(data, box)
    cancel = .false.
    call box%listener%hear(fraction, from_c(stage), cancel)
    cancelled = merge(1_c_int32_t, 0_c_int32_t, cancel)
  end function

  ! From a file that save wrote. Blanks at the end of `path` do not count.
  subroutine field_load(self, path, stat, errmsg)
    class(keepout_field), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    if (.not. is_path(path, stat, errmsg)) return
    status = ko_field_load(to_c(path), handle)
    if (status >= KO_OK) call field_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! Blanks at the end of `path` do not count.
  subroutine field_save(self, path, stat, errmsg)
    class(keepout_field), intent(in) :: self
    character(len=*), intent(in) :: path
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (.not. is_path(path, stat, errmsg)) return
    call settle(ko_field_save(self%handle, to_c(path)), stat, errmsg)
  end subroutine

  subroutine field_free(self)
    class(keepout_field), intent(inout) :: self
    call ko_field_free(self%handle)
    self%handle = c_null_ptr
    self%width = 0
  end subroutine

  ! 3 in space, 2 in the plane, 0 where nothing is held.
  pure integer function field_dim(self)
    class(keepout_field), intent(in) :: self
    field_dim = self%width
  end function

  ! What the field is and what its fit did.
  subroutine field_report(self, report, stat, errmsg)
    class(keepout_field), intent(in) :: self
    type(ko_fit_report), intent(out) :: report
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_field_get_report(self%handle, c_sizeof(report), report), stat, errmsg)
  end subroutine

  ! Allocates and fills control_points (n), the last axis fastest; the report tells how many there are along each axis.
  subroutine field_control_points(self, control_points, stat, errmsg)
    class(keepout_field), intent(in) :: self
    real(c_double), allocatable, intent(out) :: control_points(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_fit_report) :: report
    integer(c_int32_t) :: status
    integer :: failed
    status = ko_field_get_report(self%handle, c_sizeof(report), report)
    if (status < KO_OK) report%n_unknowns = 0
    allocate (control_points(report%n_unknowns), stat=failed)
    if (.not. has_room(failed, stat, errmsg)) return
    if (status >= KO_OK) status = ko_field_copy_control_points(self%handle, size(control_points, 1, c_size_t), control_points)
    call settle(status, stat, errmsg)
  end subroutine

  ! Evaluates at points (dim, n) into values (n), gradients (dim, n) and hessians, (6, n: xx xy xz yy yz zz) in space and
  ! (3, n: xx xy yy) in the plane. No lock, and no allocation but for large fields, where arrays are contiguous.
  subroutine field_eval(self, points, values, gradients, hessians, stat, errmsg)
    class(keepout_field), intent(in) :: self
    real(c_double), intent(in), contiguous :: points(:, :)
    real(c_double), intent(inout), contiguous, target, optional :: values(:)
    real(c_double), intent(inout), contiguous, target, optional :: gradients(:, :)
    real(c_double), intent(inout), contiguous, target, optional :: hessians(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: to(3)
    if (.not. addresses(self%width, points, values, gradients, hessians, to, stat, errmsg)) return
    call settle(ko_field_eval(self%handle, points, size(points, 2, c_size_t), to(1), to(2), to(3)), stat, errmsg)
  end subroutine

  ! The same on `n_threads` threads; 0: all cores.
  subroutine field_eval_parallel(self, n_threads, points, values, gradients, hessians, stat, errmsg)
    class(keepout_field), intent(in) :: self
    integer, intent(in) :: n_threads
    real(c_double), intent(in), contiguous :: points(:, :)
    real(c_double), intent(inout), contiguous, target, optional :: values(:)
    real(c_double), intent(inout), contiguous, target, optional :: gradients(:, :)
    real(c_double), intent(inout), contiguous, target, optional :: hessians(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: to(3)
    if (.not. addresses(self%width, points, values, gradients, hessians, to, stat, errmsg)) return
    call settle(ko_field_eval_parallel(self%handle, points, size(points, 2, c_size_t), to(1), to(2), to(3), &
      int(n_threads, c_int32_t)), stat, errmsg)
  end subroutine

  ! Where values, gradients and hessians go: NULL for what is not wanted. False when one has not the shape that `points` asks for.
  logical function addresses(width, points, values, gradients, hessians, to, stat, errmsg)
    integer, intent(in) :: width
    real(c_double), intent(in) :: points(:, :)
    real(c_double), intent(inout), contiguous, target, optional :: values(:)
    real(c_double), intent(inout), contiguous, target, optional :: gradients(:, :)
    real(c_double), intent(inout), contiguous, target, optional :: hessians(:, :)
    type(c_ptr), intent(out) :: to(3)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer :: n
    to = c_null_ptr
    n = size(points, 2)
    addresses = .true.
    ! Without a handle the call itself fails, and without points nothing is written.
    if (width == 0 .or. n == 0) return
    addresses = right_size("points", "rows", size(points, 1), width, stat, errmsg)
    if (addresses .and. present(values)) then
      addresses = right_size("values", "entries", size(values), n, stat, errmsg)
      to(1) = c_loc(values)
    end if
    if (addresses .and. present(gradients)) then
      addresses = right_shape("gradients", shape(gradients), [width, n], stat, errmsg)
      to(2) = c_loc(gradients)
    end if
    if (addresses .and. present(hessians)) then
      addresses = right_shape("hessians", shape(hessians), [width * (width + 1) / 2, n], stat, errmsg)
      to(3) = c_loc(hessians)
    end if
  end function

  ! Evaluates at the points of a lattice, origin (dim) plus multiples, below counts (k), of steps (dim, k), 1 <= k <= dim, on
  ! `n_threads` threads (0: all cores), into values (n) and gradients (dim, n), n the product of the counts, the last index fastest.
  subroutine field_eval_lattice(self, n_threads, origin, steps, counts, values, gradients, stat, errmsg)
    class(keepout_field), intent(in) :: self
    integer, intent(in) :: n_threads
    real(c_double), intent(in), contiguous :: origin(:), steps(:, :)
    integer, intent(in) :: counts(:)
    real(c_double), intent(inout), contiguous, target, optional :: values(:)
    real(c_double), intent(inout), contiguous, target, optional :: gradients(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: to(2)
    integer :: n
    to = c_null_ptr
    n = product(max(counts, 0))
    ! Without a handle the call itself fails.
    if (self%width > 0) then
      if (.not. right_size("origin", "entries", size(origin), self%width, stat, errmsg)) return
      if (.not. right_shape("steps", shape(steps), [self%width, size(counts)], stat, errmsg)) return
      if (present(values)) then
        if (.not. right_size("values", "entries", size(values), n, stat, errmsg)) return
        if (n > 0) to(1) = c_loc(values)
      end if
      if (present(gradients)) then
        if (.not. right_shape("gradients", shape(gradients), [self%width, n], stat, errmsg)) return
        if (n > 0) to(2) = c_loc(gradients)
      end if
    end if
    call settle(ko_field_eval_lattice(self%handle, origin, steps, int(max(counts, 0), c_size_t), size(counts, 1, c_int32_t), &
      to(1), to(2), int(n_threads, c_int32_t)), stat, errmsg)
  end subroutine

  ! Makes `mesh` the level set phi = `level` within the field's box: triangles in space, curves in the plane. stat is KO_OPEN_AT_BOX
  ! where it meets the box and is open there. `listener` is told of progress, on this thread.
  subroutine field_level_set(self, level, mesh, options, listener, stat, errmsg)
    class(keepout_field), intent(in) :: self
    real(c_double), intent(in) :: level
    type(keepout_mesh), intent(inout) :: mesh
    type(ko_level_set_options), intent(in), optional :: options
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_level_set_options) :: plain
    type(listener_box), target :: box
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    plain = keepout_level_set_options()
    if (present(options)) plain = options
    if (present(listener)) call listen(box, listener, plain%progress, plain%progress_data)
    status = ko_field_level_set(self%handle, level, plain, handle)
    if (status >= KO_OK) call mesh_adopt(mesh, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! Certifies the field against `mesh`, which it was fitted to: phi at or above certificate%threshold at samples that cover a body's
  ! surface within `covering_radius` proves that the body is on the feasible side and farther than `clearance` from the shape, once
  ! the points of mesh%copy_component_points are outside the body. stat may be KO_SIDE_NOT_CERTIFIED or KO_BUDGET_REACHED, which
  ! are no errors. `listener` is told of progress, on this thread.
  subroutine field_certify(self, mesh, clearance, covering_radius, certificate, options, listener, stat, errmsg)
    class(keepout_field), intent(in) :: self
    type(keepout_mesh), intent(in) :: mesh
    real(c_double), intent(in) :: clearance, covering_radius
    type(ko_certificate), intent(inout) :: certificate
    type(ko_certify_options), intent(in), optional :: options
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_certify_options) :: plain
    type(listener_box), target :: box
    plain = keepout_certify_options()
    if (present(options)) plain = options
    if (present(listener)) call listen(box, listener, plain%progress, plain%progress_data)
    call settle(ko_field_certify(self%handle, mesh%handle, clearance, covering_radius, plain, c_sizeof(certificate), certificate), &
      stat, errmsg)
  end subroutine

  ! 1 into outside (n) for each of points (dim, n) outside the field's box, else 0.
  subroutine field_outside_box(self, points, outside, stat, errmsg)
    class(keepout_field), intent(in) :: self
    real(c_double), intent(in), contiguous :: points(:, :)
    integer(c_int8_t), intent(inout), contiguous :: outside(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (self%width > 0) then
      if (.not. right_size("points", "rows", size(points, 1), self%width, stat, errmsg)) return
      if (.not. right_size("outside", "entries", size(outside), size(points, 2), stat, errmsg)) return
    end if
    call settle(ko_field_outside_box(self%handle, points, size(points, 2, c_size_t), outside), stat, errmsg)
  end subroutine

  ! For calls of keepout_c; it stays the field's.
  pure function field_c_handle(self) result(handle)
    class(keepout_field), intent(in) :: self
    type(c_ptr) :: handle
    handle = self%handle
  end function

  ! ---- Bodies

  ! From points (dim, n), dim 2 or 3, of which one is within `covering_radius` of each point of the surface; 0: not known.
  subroutine body_from_points(self, points, covering_radius, stat, errmsg)
    class(keepout_body), intent(inout) :: self
    real(c_double), intent(in), contiguous :: points(:, :)
    real(c_double), intent(in) :: covering_radius
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    status = ko_body_from_points(size(points, 1, c_int32_t), points, size(points, 2, c_size_t), covering_radius, handle)
    if (status >= KO_OK) call body_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! Points on `mesh`, so many that one is within `covering_radius` of each point of its surface or curves.
  subroutine body_from_mesh(self, mesh, covering_radius, stat, errmsg)
    class(keepout_body), intent(inout) :: self
    type(keepout_mesh), intent(in) :: mesh
    real(c_double), intent(in) :: covering_radius
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    status = ko_body_from_mesh(mesh%handle, covering_radius, handle)
    if (status >= KO_OK) call body_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  subroutine body_free(self)
    class(keepout_body), intent(inout) :: self
    call ko_body_free(self%handle)
    self%handle = c_null_ptr
    self%width = 0
    self%points = 0
  end subroutine

  ! 3 in space, 2 in the plane, 0 where nothing is held.
  pure integer function body_dim(self)
    class(keepout_body), intent(in) :: self
    body_dim = self%width
  end function

  pure integer(c_size_t) function body_n_points(self)
    class(keepout_body), intent(in) :: self
    body_n_points = self%points
  end function

  ! Tells the covering radius; 0: not known.
  subroutine body_covering_radius(self, covering_radius, stat, errmsg)
    class(keepout_body), intent(in) :: self
    real(c_double), intent(inout) :: covering_radius
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_body_get_covering_radius(self%handle, covering_radius), stat, errmsg)
  end subroutine

  ! Allocates and fills points (dim, n).
  subroutine body_copy_points(self, points, stat, errmsg)
    class(keepout_body), intent(in) :: self
    real(c_double), allocatable, intent(out) :: points(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer :: failed
    allocate (points(self%width, self%points), stat=failed)
    if (.not. has_room(failed, stat, errmsg)) return
    call settle(ko_body_copy_points(self%handle, self%points, points), stat, errmsg)
  end subroutine

  ! For calls of keepout_c; it stays the body's.
  pure function body_c_handle(self) result(handle)
    class(keepout_body), intent(in) :: self
    type(c_ptr) :: handle
    handle = self%handle
  end function

  ! ---- Constraints

  ! Without variables and values; `dim` 2 or 3.
  subroutine constraints_create(self, dim, stat, errmsg)
    class(keepout_constraints), intent(inout) :: self
    integer, intent(in) :: dim
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    status = ko_constraints_create(int(dim, c_int32_t), handle)
    if (status >= KO_OK) then
      call self%free()
      self%handle = handle
    end if
    call settle(status, stat, errmsg)
  end subroutine

  subroutine constraints_free(self)
    class(keepout_constraints), intent(inout) :: self
    call ko_constraints_free(self%handle)
    self%handle = c_null_ptr
  end subroutine

  ! Adds a frame whose parameters are variables; `frame` is its number. `rotation` is a KO_ROTATION_, `scale` a KO_SCALE_ constant.
  subroutine constraints_add_frame(self, rotation, scale, frame, stat, errmsg)
    class(keepout_constraints), intent(inout) :: self
    integer(c_int32_t), intent(in) :: rotation, scale
    integer(c_int32_t), intent(inout) :: frame
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_constraints_add_frame(self%handle, rotation, scale, frame), stat, errmsg)
  end subroutine

  ! Adds a frame that stands still at `parameters`; `frame` is its number.
  subroutine constraints_add_fixed_frame(self, rotation, scale, parameters, frame, stat, errmsg)
    class(keepout_constraints), intent(inout) :: self
    integer(c_int32_t), intent(in) :: rotation, scale
    real(c_double), intent(in), contiguous :: parameters(:)
    integer(c_int32_t), intent(inout) :: frame
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_constraints_add_fixed_frame(self%handle, rotation, scale, parameters, size(parameters, 1, c_size_t), frame), &
      stat, errmsg)
  end subroutine

  ! Adds points whose coordinates are variables; `points` is their number.
  subroutine constraints_add_points(self, n_points, points, stat, errmsg)
    class(keepout_constraints), intent(inout) :: self
    integer, intent(in) :: n_points
    integer(c_int32_t), intent(inout) :: points
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_constraints_add_points(self%handle, int(max(n_points, 0), c_size_t), points), stat, errmsg)
  end subroutine

  ! Keeps `body` in `frame` where phi of `field` in `field_frame` is positive; `first_value` is the number of its first value. Without
  ! an aggregation: KS. Body and field may go.
  subroutine constraints_keep_body(self, body, frame, field, field_frame, aggregation, first_value, stat, errmsg)
    class(keepout_constraints), intent(inout) :: self
    type(keepout_body), intent(in) :: body
    integer(c_int32_t), intent(in) :: frame
    type(keepout_field), intent(in) :: field
    integer(c_int32_t), intent(in) :: field_frame
    type(ko_aggregation), intent(in), optional :: aggregation
    integer(c_size_t), intent(inout), optional :: first_value
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_aggregation) :: plain
    integer(c_size_t) :: first
    integer(c_int32_t) :: status
    plain = keepout_aggregation()
    if (present(aggregation)) plain = aggregation
    status = ko_constraints_keep_body(self%handle, body%handle, frame, field%handle, field_frame, plain, first)
    if (status >= KO_OK .and. present(first_value)) first_value = first
    call settle(status, stat, errmsg)
  end subroutine

  ! The same of points that are variables, by their number.
  subroutine constraints_keep_points(self, points, field, field_frame, aggregation, first_value, stat, errmsg)
    class(keepout_constraints), intent(inout) :: self
    integer(c_int32_t), intent(in) :: points
    type(keepout_field), intent(in) :: field
    integer(c_int32_t), intent(in) :: field_frame
    type(ko_aggregation), intent(in), optional :: aggregation
    integer(c_size_t), intent(inout), optional :: first_value
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_aggregation) :: plain
    integer(c_size_t) :: first
    integer(c_int32_t) :: status
    plain = keepout_aggregation()
    if (present(aggregation)) plain = aggregation
    status = ko_constraints_keep_points(self%handle, points, field%handle, field_frame, plain, first)
    if (status >= KO_OK .and. present(first_value)) first_value = first
    call settle(status, stat, errmsg)
  end subroutine

  ! Keeps `body` in `frame` in the union, KO_LARGEST, or the intersection, KO_LEAST, of the feasible sets of `fields`, all in
  ! `field_frame`, whose phi become one by `combination`; `first_value` is the number of its first value. Without a combination or an
  ! aggregation: KS. Body and fields may go.
  subroutine constraints_keep_body_in_fields(self, body, frame, fields, extreme, field_frame, combination, aggregation, &
    first_value, stat, errmsg)
    class(keepout_constraints), intent(inout) :: self
    type(keepout_body), intent(in) :: body
    integer(c_int32_t), intent(in) :: frame
    type(keepout_field), intent(in) :: fields(:)
    integer(c_int32_t), intent(in) :: extreme, field_frame
    type(ko_aggregation), intent(in), optional :: combination, aggregation
    integer(c_size_t), intent(inout), optional :: first_value
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_aggregation) :: of_fields, of_samples
    type(c_ptr) :: handles(size(fields))
    integer(c_size_t) :: first
    integer(c_int32_t) :: status
    integer :: f
    of_fields = keepout_aggregation()
    if (present(combination)) of_fields = combination
    of_samples = keepout_aggregation()
    if (present(aggregation)) of_samples = aggregation
    do f = 1, size(fields)
      handles(f) = fields(f)%handle
    end do
    status = ko_constraints_keep_body_in_fields(self%handle, body%handle, frame, handles, size(handles, 1, c_size_t), extreme, &
      of_fields, field_frame, of_samples, first)
    if (status >= KO_OK .and. present(first_value)) first_value = first
    call settle(status, stat, errmsg)
  end subroutine

  ! The same of points that are variables, by their number.
  subroutine constraints_keep_points_in_fields(self, points, fields, extreme, field_frame, combination, aggregation, &
    first_value, stat, errmsg)
    class(keepout_constraints), intent(inout) :: self
    integer(c_int32_t), intent(in) :: points
    type(keepout_field), intent(in) :: fields(:)
    integer(c_int32_t), intent(in) :: extreme, field_frame
    type(ko_aggregation), intent(in), optional :: combination, aggregation
    integer(c_size_t), intent(inout), optional :: first_value
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_aggregation) :: of_fields, of_samples
    type(c_ptr) :: handles(size(fields))
    integer(c_size_t) :: first
    integer(c_int32_t) :: status
    integer :: f
    of_fields = keepout_aggregation()
    if (present(combination)) of_fields = combination
    of_samples = keepout_aggregation()
    if (present(aggregation)) of_samples = aggregation
    do f = 1, size(fields)
      handles(f) = fields(f)%handle
    end do
    status = ko_constraints_keep_points_in_fields(self%handle, points, handles, size(handles, 1, c_size_t), extreme, &
      of_fields, field_frame, of_samples, first)
    if (status >= KO_OK .and. present(first_value)) first_value = first
    call settle(status, stat, errmsg)
  end subroutine

  ! How many variables and values there are, and entries of the Jacobian's pattern and of the Hessian's; 0 after an error.
  subroutine constraints_get_size(self, n_variables, n_values, n_jacobian, n_hessian, stat, errmsg)
    class(keepout_constraints), intent(in) :: self
    integer(c_size_t), intent(out), optional :: n_variables, n_values, n_jacobian, n_hessian
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_size_t) :: n(4)
    integer(c_int32_t) :: status
    n = 0
    status = ko_constraints_get_size(self%handle, n(1), n(2), n(3), n(4))
    if (present(n_variables)) n_variables = n(1)
    if (present(n_values)) n_values = n(2)
    if (present(n_jacobian)) n_jacobian = n(3)
    if (present(n_hessian)) n_hessian = n(4)
    call settle(status, stat, errmsg)
  end subroutine

  ! The first variable of a frame, and how many it has, 0 of one that stands still.
  subroutine constraints_frame_variables(self, frame, first, n_variables, stat, errmsg)
    class(keepout_constraints), intent(in) :: self
    integer(c_int32_t), intent(in) :: frame
    integer(c_size_t), intent(inout) :: first, n_variables
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_constraints_get_frame_variables(self%handle, frame, first, n_variables), stat, errmsg)
  end subroutine

  ! The first variable of points, and how many they have.
  subroutine constraints_points_variables(self, points, first, n_variables, stat, errmsg)
    class(keepout_constraints), intent(in) :: self
    integer(c_int32_t), intent(in) :: points
    integer(c_size_t), intent(inout) :: first, n_variables
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_constraints_get_points_variables(self%handle, points, first, n_variables), stat, errmsg)
  end subroutine

  ! Values (n_values) at x (n_variables), each to be kept at or above 0. No allocation, no lock, here and below, where arrays are
  ! contiguous.
  subroutine constraints_values(self, x, values, stat, errmsg)
    class(keepout_constraints), intent(in) :: self
    real(c_double), intent(in), contiguous :: x(:)
    real(c_double), intent(inout), contiguous :: values(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_constraints_values(self%handle, x, size(x, 1, c_size_t), size(values, 1, c_size_t), values), stat, errmsg)
  end subroutine

  ! Allocates and fills rows (n_jacobian), values, and columns (n_jacobian), variables, of the Jacobian's entries.
  subroutine constraints_jacobian_pattern(self, rows, columns, stat, errmsg)
    class(keepout_constraints), intent(in) :: self
    integer(c_int32_t), allocatable, intent(out) :: rows(:), columns(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_size_t) :: n, others(3)
    integer(c_int32_t) :: status
    integer :: failed
    n = 0
    status = ko_constraints_get_size(self%handle, others(1), others(2), n, others(3))
    allocate (rows(n), columns(n), stat=failed)
    if (.not. has_room(failed, stat, errmsg)) return
    if (status >= KO_OK) status = ko_constraints_jacobian_pattern(self%handle, n, rows, columns)
    call settle(status, stat, errmsg)
  end subroutine

  ! Entries (n_jacobian) of the Jacobian at x (n_variables), in the order of jacobian_pattern.
  subroutine constraints_jacobian(self, x, entries, stat, errmsg)
    class(keepout_constraints), intent(in) :: self
    real(c_double), intent(in), contiguous :: x(:)
    real(c_double), intent(inout), contiguous :: entries(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_constraints_jacobian(self%handle, x, size(x, 1, c_size_t), size(entries, 1, c_size_t), entries), stat, errmsg)
  end subroutine

  ! Both at once.
  subroutine constraints_values_and_jacobian(self, x, values, entries, stat, errmsg)
    class(keepout_constraints), intent(in) :: self
    real(c_double), intent(in), contiguous :: x(:)
    real(c_double), intent(inout), contiguous :: values(:)
    real(c_double), intent(inout), contiguous :: entries(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_constraints_values_and_jacobian(self%handle, x, size(x, 1, c_size_t), size(values, 1, c_size_t), values, &
      size(entries, 1, c_size_t), entries), stat, errmsg)
  end subroutine

  ! The Jacobian at x (n_variables) as a whole, a column a value: jacobian (n_variables, n_values).
  subroutine constraints_dense_jacobian(self, x, jacobian, stat, errmsg)
    class(keepout_constraints), intent(in) :: self
    real(c_double), intent(in), contiguous :: x(:)
    real(c_double), intent(inout), contiguous :: jacobian(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (.not. right_size("jacobian", "rows", size(jacobian, 1), size(x), stat, errmsg)) return
    call settle(ko_constraints_dense_jacobian(self%handle, x, size(x, 1, c_size_t), size(jacobian, 2, c_size_t), jacobian), &
      stat, errmsg)
  end subroutine

  ! J v, product (n_values), at x (n_variables) for v (n_variables).
  subroutine constraints_jacobian_times(self, x, v, product, stat, errmsg)
    class(keepout_constraints), intent(in) :: self
    real(c_double), intent(in), contiguous :: x(:), v(:)
    real(c_double), intent(inout), contiguous :: product(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (.not. right_size("v", "entries", size(v), size(x), stat, errmsg)) return
    call settle(ko_constraints_jacobian_times(self%handle, x, v, size(x, 1, c_size_t), size(product, 1, c_size_t), product), &
      stat, errmsg)
  end subroutine

  ! J^T w, product (n_variables), at x (n_variables) for w (n_values).
  subroutine constraints_transposed_jacobian_times(self, x, w, product, stat, errmsg)
    class(keepout_constraints), intent(in) :: self
    real(c_double), intent(in), contiguous :: x(:), w(:)
    real(c_double), intent(inout), contiguous :: product(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (.not. right_size("product", "entries", size(product), size(x), stat, errmsg)) return
    call settle(ko_constraints_transposed_jacobian_times(self%handle, x, size(x, 1, c_size_t), w, size(w, 1, c_size_t), product), &
      stat, errmsg)
  end subroutine

  ! Allocates and fills rows (n_hessian) and columns (n_hessian), both variables, of the entries of the Hessian's lower triangle.
  subroutine constraints_hessian_pattern(self, rows, columns, stat, errmsg)
    class(keepout_constraints), intent(in) :: self
    integer(c_int32_t), allocatable, intent(out) :: rows(:), columns(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_size_t) :: n, others(3)
    integer(c_int32_t) :: status
    integer :: failed
    n = 0
    status = ko_constraints_get_size(self%handle, others(1), others(2), others(3), n)
    allocate (rows(n), columns(n), stat=failed)
    if (.not. has_room(failed, stat, errmsg)) return
    if (status >= KO_OK) status = ko_constraints_hessian_pattern(self%handle, n, rows, columns)
    call settle(status, stat, errmsg)
  end subroutine

  ! Entries (n_hessian) of the Hessian of the sum of lambda (n_values) times the values, in the order of hessian_pattern.
  subroutine constraints_hessian(self, x, lambda, entries, stat, errmsg)
    class(keepout_constraints), intent(in) :: self
    real(c_double), intent(in), contiguous :: x(:), lambda(:)
    real(c_double), intent(inout), contiguous :: entries(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_constraints_hessian(self%handle, x, size(x, 1, c_size_t), lambda, size(lambda, 1, c_size_t), &
      size(entries, 1, c_size_t), entries), stat, errmsg)
  end subroutine

  ! For calls of keepout_c; it stays the constraints'.
  pure function constraints_c_handle(self) result(handle)
    class(keepout_constraints), intent(in) :: self
    type(c_ptr) :: handle
    handle = self%handle
  end function

  ! ---- Derivatives by the cloud

  ! Of `field` with respect to `cloud`, to which it was fitted with `options`; it refers to neither. `listener` is told of progress, on
  ! this thread.
  subroutine sensitivity_create(self, field, cloud, options, listener, stat, errmsg)
    class(keepout_sensitivity), intent(inout) :: self
    type(keepout_field), intent(in) :: field
    type(keepout_cloud), intent(in) :: cloud
    type(ko_fit_options), intent(in), optional :: options
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_fit_options) :: plain
    type(listener_box), target :: box
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    plain = keepout_fit_options()
    if (present(options)) plain = options
    if (present(listener)) call listen(box, listener, plain%progress, plain%progress_data)
    status = ko_sensitivity_create(field%handle, cloud%handle, plain, handle)
    if (status >= KO_OK) then
      call self%free()
      self%handle = handle
      self%width = cloud%width
      self%points = cloud%points
    end if
    call settle(status, stat, errmsg)
  end subroutine

  subroutine sensitivity_free(self)
    class(keepout_sensitivity), intent(inout) :: self
    call ko_sensitivity_free(self%handle)
    self%handle = c_null_ptr
    self%width = 0
    self%points = 0
  end subroutine

  ! dJ by points and normals of the cloud, into d_points and d_normals (dim, n_points of the cloud), of J over points (dim, n) with
  ! weights (n), absent for ones. `options` absent: to the tolerance of those of create.
  subroutine sensitivity_solve(self, points, weights, d_points, d_normals, options, stat, errmsg)
    class(keepout_sensitivity), intent(inout) :: self
    real(c_double), intent(in), contiguous :: points(:, :)
    real(c_double), intent(in), contiguous, target, optional :: weights(:)
    real(c_double), intent(inout), contiguous, target, optional :: d_points(:, :), d_normals(:, :)
    type(ko_fit_options), intent(in), target, optional :: options
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: from(2), to(2)
    from = c_null_ptr
    to = c_null_ptr
    if (self%width > 0) then
      if (.not. right_size("points", "rows", size(points, 1), self%width, stat, errmsg)) return
    end if
    if (present(weights)) then
      if (.not. right_size("weights", "entries", size(weights), size(points, 2), stat, errmsg)) return
      from(1) = c_loc(weights)
    end if
    if (present(options)) from(2) = c_loc(options)
    if (present(d_points)) then
      if (.not. of_cloud("d_points", shape(d_points), self%width, self%points, stat, errmsg)) return
      to(1) = c_loc(d_points)
    end if
    if (present(d_normals)) then
      if (.not. of_cloud("d_normals", shape(d_normals), self%width, self%points, stat, errmsg)) return
      to(2) = c_loc(d_normals)
    end if
    call settle(ko_sensitivity_solve(self%handle, points, from(1), size(points, 2, c_size_t), from(2), self%points, to(1), to(2)), &
      stat, errmsg)
  end subroutine

  ! For calls of keepout_c; it stays the sensitivity's.
  pure function sensitivity_c_handle(self) result(handle)
    class(keepout_sensitivity), intent(in) :: self
    type(c_ptr) :: handle
    handle = self%handle
  end function

  ! ---- Co-generation

  ! At a pose: rotation (dim, dim) and translation (dim), each none where it is absent.
  subroutine motion_fixed(self, dim, rotation, translation, stat, errmsg)
    class(keepout_motion), intent(inout) :: self
    integer, intent(in) :: dim
    real(c_double), intent(in), optional :: rotation(:, :)
    real(c_double), intent(in), contiguous, target, optional :: translation(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    real(c_double), target :: rows(max(dim, 0), max(dim, 0))
    type(c_ptr) :: from(2), handle
    integer(c_int32_t) :: status
    from = c_null_ptr
    if (present(rotation)) then
      if (.not. right_shape("rotation", shape(rotation), [dim, dim], stat, errmsg)) return
      rows = transpose(rotation)
      from(1) = c_loc(rows)
    end if
    if (present(translation)) then
      if (.not. right_size("translation", "entries", size(translation), dim, stat, errmsg)) return
      from(2) = c_loc(translation)
    end if
    status = ko_motion_fixed(int(dim, c_int32_t), from(1), from(2), handle)
    if (status >= KO_OK) call motion_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! A slide by f(t) times along (dim).
  subroutine motion_slide(self, along, law, stat, errmsg)
    class(keepout_motion), intent(inout) :: self
    real(c_double), intent(in), contiguous :: along(:)
    type(ko_law), intent(in) :: law
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    status = ko_motion_slide(size(along, 1, c_int32_t), along, law, handle)
    if (status >= KO_OK) call motion_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! A turn in the plane about `center`, by f(t) radians counter-clockwise.
  subroutine motion_turn(self, center, law, stat, errmsg)
    class(keepout_motion), intent(inout) :: self
    real(c_double), intent(in) :: center(2)
    type(ko_law), intent(in) :: law
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    status = ko_motion_turn(center, law, handle)
    if (status >= KO_OK) call motion_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! A screw in space about the line through `point` along `axis`: f(t) radians, and a slide of `lead` a radian.
  subroutine motion_screw(self, point, axis, lead, law, stat, errmsg)
    class(keepout_motion), intent(inout) :: self
    real(c_double), intent(in) :: point(3), axis(3), lead
    type(ko_law), intent(in) :: law
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    status = ko_motion_screw(point, axis, lead, law, handle)
    if (status >= KO_OK) call motion_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! Through poses at even times: rotations (dim, dim, n) and translations (dim, n), with screws between them.
  subroutine motion_sampled(self, rotations, translations, stat, errmsg)
    class(keepout_motion), intent(inout) :: self
    real(c_double), intent(in) :: rotations(:, :, :)
    real(c_double), intent(in), contiguous :: translations(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    real(c_double), allocatable :: rows(:, :, :)
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    integer :: k, failed
    if (.not. right_shape("each of rotations", [size(rotations, 1), size(rotations, 2)], &
      [size(translations, 1), size(translations, 1)], stat, errmsg)) return
    if (.not. right_size("rotations", "matrices", size(rotations, 3), size(translations, 2), stat, errmsg)) return
    allocate (rows(size(rotations, 1), size(rotations, 2), size(rotations, 3)), stat=failed)
    if (.not. has_room(failed, stat, errmsg)) return
    do k = 1, size(rotations, 3)
      rows(:, :, k) = transpose(rotations(:, :, k))
    end do
    status = ko_motion_sampled(size(translations, 1, c_int32_t), rows, translations, size(translations, 2, c_size_t), handle)
    if (status >= KO_OK) call motion_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! Through `n_poses` poses at even times that `pose`, the address of a ko_pose_function, is asked for with `data`. With a part a jump is an
  ! error: where a point of its grid would be faster than max_speed.
  subroutine motion_from_function(self, dim, pose, data, n_poses, stat, errmsg, part, max_speed)
    class(keepout_motion), intent(inout) :: self
    integer, intent(in) :: dim, n_poses
    type(c_funptr), intent(in) :: pose
    type(c_ptr), intent(in) :: data
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(keepout_part), intent(in), optional :: part
    real(c_double), intent(in), optional :: max_speed
    type(c_ptr) :: handle, of
    integer(c_int32_t) :: status
    real(c_double) :: most
    of = c_null_ptr
    if (present(part)) of = part%handle
    most = 0
    if (present(max_speed)) most = max_speed
    status = ko_motion_from_function(int(dim, c_int32_t), pose, data, int(max(n_poses, 0), c_size_t), of, most, handle)
    if (status >= KO_OK) call motion_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! Two wheels about centers (2, 2) that turn against each other: the first by `turns`, the second by `ratio` times that.
  subroutine keepout_gears(centers, turns, ratio, first, second, stat, errmsg)
    real(c_double), intent(in) :: centers(2, 2), turns, ratio
    type(keepout_motion), intent(inout) :: first, second
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handles(2)
    integer(c_int32_t) :: status
    status = ko_motion_gears(reshape(centers, [4]), turns, ratio, handles(1), handles(2))
    if (status >= KO_OK) then
      call motion_adopt(first, handles(1))
      call motion_adopt(second, handles(2))
    end if
    call settle(status, stat, errmsg)
  end subroutine

  ! The motions of a four-bar linkage with pivots (2, 2) and the lengths of crank, coupler and rocker: see ko_motion_four_bar.
  subroutine keepout_four_bar(pivots, lengths, from, by, bend, n_steps, crank, coupler, rocker, stat, errmsg)
    real(c_double), intent(in) :: pivots(2, 2), lengths(3), from, by
    integer, intent(in) :: bend, n_steps
    type(keepout_motion), intent(inout) :: crank, coupler, rocker
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handles(3)
    integer(c_int32_t) :: status
    status = ko_motion_four_bar(reshape(pivots, [4]), lengths, from, by, int(bend, c_int32_t), int(max(n_steps, 0), c_size_t), &
      handles(1), handles(2), handles(3))
    if (status >= KO_OK) then
      call motion_adopt(crank, handles(1))
      call motion_adopt(coupler, handles(2))
      call motion_adopt(rocker, handles(3))
    end if
    call settle(status, stat, errmsg)
  end subroutine

  ! The product of two motions: what `inner` does is seen from what `outer` moves.
  subroutine motion_product(self, outer, inner, stat, errmsg)
    class(keepout_motion), intent(inout) :: self
    type(keepout_motion), intent(in) :: outer, inner
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    status = ko_motion_product(outer%handle, inner%handle, handle)
    if (status >= KO_OK) call motion_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! The motion that undoes `of` at each time.
  subroutine motion_inverse(self, of, stat, errmsg)
    class(keepout_motion), intent(inout) :: self
    type(keepout_motion), intent(in) :: of
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    status = ko_motion_inverse(of%handle, handle)
    if (status >= KO_OK) call motion_adopt(self, handle)
    call settle(status, stat, errmsg)
  end subroutine

  subroutine motion_free(self)
    class(keepout_motion), intent(inout) :: self
    call ko_motion_free(self%handle)
    self%handle = c_null_ptr
    self%width = 0
  end subroutine

  ! 3 in space, 2 in the plane, 0 where nothing is held.
  pure integer function motion_dim(self)
    class(keepout_motion), intent(in) :: self
    motion_dim = self%width
  end function

  ! Poses at times (n): rotations (dim, dim, n) and translations (dim, n).
  subroutine motion_eval(self, times, rotations, translations, stat, errmsg)
    class(keepout_motion), intent(in) :: self
    real(c_double), intent(in), contiguous :: times(:)
    real(c_double), intent(inout), contiguous :: rotations(:, :, :)
    real(c_double), intent(inout), contiguous :: translations(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer :: k
    integer(c_int32_t) :: status
    if (self%width > 0) then
      if (.not. right_shape("each of rotations", [size(rotations, 1), size(rotations, 2)], [self%width, self%width], &
        stat, errmsg)) return
      if (.not. right_size("rotations", "matrices", size(rotations, 3), size(times), stat, errmsg)) return
      if (.not. right_shape("translations", shape(translations), [self%width, size(times)], stat, errmsg)) return
    end if
    status = ko_motion_eval(self%handle, times, size(times, 1, c_size_t), rotations, translations)
    if (status >= KO_OK) then
      do k = 1, size(rotations, 3)
        rotations(:, :, k) = transpose(rotations(:, :, k))
      end do
    end if
    call settle(status, stat, errmsg)
  end subroutine

  ! For calls of keepout_c; it stays the motion's.
  pure function motion_c_handle(self) result(handle)
    class(keepout_motion), intent(in) :: self
    type(c_ptr) :: handle
    handle = self%handle
  end function

  ! counts (dim) cells of this edge from corner (dim) on; cells (n_cells) are KO_CELL_ constants, all free where they are absent.
  subroutine part_create(self, corner, cell_edge, counts, cells, stat, errmsg)
    class(keepout_part), intent(inout) :: self
    real(c_double), intent(in), contiguous :: corner(:)
    real(c_double), intent(in) :: cell_edge
    integer, intent(in) :: counts(:)
    integer(c_int8_t), intent(in), contiguous, target, optional :: cells(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: handle, own
    integer(c_int32_t) :: status, dim
    integer(c_size_t) :: n
    if (.not. right_size("counts", "entries", size(counts), size(corner), stat, errmsg)) return
    own = c_null_ptr
    n = 0
    if (present(cells)) then
      n = size(cells, 1, c_size_t)
      if (n > 0) own = c_loc(cells)
    end if
    status = ko_part_create(size(corner, 1, c_int32_t), corner, cell_edge, int(max(counts, 0), c_size_t), own, n, handle)
    if (status >= KO_OK) then
      call self%free()
      self%handle = handle
      call settle(ko_part_get_size(handle, dim, self%n))
      self%width = int(dim)
    end if
    call settle(status, stat, errmsg)
  end subroutine

  subroutine part_free(self)
    class(keepout_part), intent(inout) :: self
    call ko_part_free(self%handle)
    self%handle = c_null_ptr
    self%width = 0
    self%n = 0
  end subroutine

  ! 3 in space, 2 in the plane, 0 where nothing is held.
  pure integer function part_dim(self)
    class(keepout_part), intent(in) :: self
    part_dim = self%width
  end function

  pure integer(c_size_t) function part_n_cells(self)
    class(keepout_part), intent(in) :: self
    part_n_cells = self%n
  end function

  ! The grid as it was given: corner (dim), the cells' edge, counts (dim).
  subroutine part_grid(self, corner, cell_edge, counts, stat, errmsg)
    class(keepout_part), intent(in) :: self
    real(c_double), intent(inout), contiguous :: corner(:)
    real(c_double), intent(inout) :: cell_edge
    integer(c_size_t), intent(inout), contiguous :: counts(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (self%width > 0) then
      if (.not. right_size("corner", "entries", size(corner), self%width, stat, errmsg)) return
      if (.not. right_size("counts", "entries", size(counts), self%width, stat, errmsg)) return
    end if
    call settle(ko_part_get_grid(self%handle, corner, cell_edge, counts), stat, errmsg)
  end subroutine

  ! Allocates and fills cells (n_cells): KO_CELL_ constants.
  subroutine part_copy_cells(self, cells, stat, errmsg)
    class(keepout_part), intent(in) :: self
    integer(c_int8_t), allocatable, intent(out) :: cells(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer :: failed
    allocate (cells(self%n), stat=failed)
    if (.not. has_room(failed, stat, errmsg)) return
    call settle(ko_part_copy_cells(self%handle, self%n, cells), stat, errmsg)
  end subroutine

  ! What part of each cell the mesh's solid fills, fractions (n_cells), by `samples` points along a cell's edge; n_threads 0: all cores.
  subroutine part_fractions_of_mesh(self, mesh, samples, fractions, n_threads, stat, errmsg)
    class(keepout_part), intent(in) :: self
    type(keepout_mesh), intent(in) :: mesh
    integer, intent(in) :: samples
    real(c_double), intent(inout), contiguous :: fractions(:)
    integer, intent(in), optional :: n_threads
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_part_fractions_of_mesh(self%handle, mesh%handle, int(max(samples, 0), c_int32_t), given(n_threads), &
      size(fractions, 1, c_size_t), fractions), stat, errmsg)
  end subroutine

  ! The same of a field's solid; `steepness` bounds the length of its gradient.
  subroutine part_fractions_of_field(self, field, steepness, samples, fractions, n_threads, stat, errmsg)
    class(keepout_part), intent(in) :: self
    type(keepout_field), intent(in) :: field
    real(c_double), intent(in) :: steepness
    integer, intent(in) :: samples
    real(c_double), intent(inout), contiguous :: fractions(:)
    integer, intent(in), optional :: n_threads
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_part_fractions_of_field(self%handle, field%handle, steepness, int(max(samples, 0), c_int32_t), &
      given(n_threads), size(fractions, 1, c_size_t), fractions), stat, errmsg)
  end subroutine

  ! The same of a box from box_min (dim) to box_max (dim).
  subroutine part_fractions_of_box(self, box_min, box_max, samples, fractions, n_threads, stat, errmsg)
    class(keepout_part), intent(in) :: self
    real(c_double), intent(in), contiguous :: box_min(:), box_max(:)
    integer, intent(in) :: samples
    real(c_double), intent(inout), contiguous :: fractions(:)
    integer, intent(in), optional :: n_threads
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (self%width > 0) then
      if (.not. right_size("box_min", "entries", size(box_min), self%width, stat, errmsg)) return
      if (.not. right_size("box_max", "entries", size(box_max), self%width, stat, errmsg)) return
    end if
    call settle(ko_part_fractions_of_box(self%handle, box_min, box_max, int(max(samples, 0), c_int32_t), given(n_threads), &
      size(fractions, 1, c_size_t), fractions), stat, errmsg)
  end subroutine

  ! The same of a ball, in the plane a disc, around center (dim).
  subroutine part_fractions_of_ball(self, center, radius, samples, fractions, n_threads, stat, errmsg)
    class(keepout_part), intent(in) :: self
    real(c_double), intent(in), contiguous :: center(:)
    real(c_double), intent(in) :: radius
    integer, intent(in) :: samples
    real(c_double), intent(inout), contiguous :: fractions(:)
    integer, intent(in), optional :: n_threads
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (self%width > 0) then
      if (.not. right_size("center", "entries", size(center), self%width, stat, errmsg)) return
    end if
    call settle(ko_part_fractions_of_ball(self%handle, center, radius, int(max(samples, 0), c_int32_t), given(n_threads), &
      size(fractions, 1, c_size_t), fractions), stat, errmsg)
  end subroutine

  ! The same of a cylinder, in the plane a strip, between the middles of its ends (dim, 2).
  subroutine part_fractions_of_cylinder(self, ends, radius, samples, fractions, n_threads, stat, errmsg)
    class(keepout_part), intent(in) :: self
    real(c_double), intent(in), contiguous :: ends(:, :)
    real(c_double), intent(in) :: radius
    integer, intent(in) :: samples
    real(c_double), intent(inout), contiguous :: fractions(:)
    integer, intent(in), optional :: n_threads
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (self%width > 0) then
      if (.not. right_shape("ends", shape(ends), [self%width, 2], stat, errmsg)) return
    end if
    call settle(ko_part_fractions_of_cylinder(self%handle, ends, radius, int(max(samples, 0), c_int32_t), given(n_threads), &
      size(fractions, 1, c_size_t), fractions), stat, errmsg)
  end subroutine

  ! Makes `mesh` bound cells (n_cells), a set: closed, in the part's frame. `within` is KO_WITHIN_CELLS, so where it is absent, or
  ! KO_WITHIN_ANYWHERE; each vertex is moved `rounds` times, 20 where it is absent, with 0 the mesh is the cells' faces. `listener` is told of
  ! progress, on this thread.
  subroutine part_mesh_of_cells(self, cells, mesh, within, rounds, listener, stat, errmsg)
    class(keepout_part), intent(in) :: self
    integer(c_int8_t), intent(in), contiguous :: cells(:)
    type(keepout_mesh), intent(inout) :: mesh
    integer(c_int32_t), intent(in), optional :: within
    integer, intent(in), optional :: rounds
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(listener_box), target :: box
    type(c_funptr) :: progress
    type(c_ptr) :: progress_data, handle
    integer(c_int32_t) :: status, how(2)
    progress = c_null_funptr
    progress_data = c_null_ptr
    if (present(listener)) call listen(box, listener, progress, progress_data)
    how = boundary(within, rounds)
    status = ko_part_mesh_of_cells(self%handle, cells, size(cells, 1, c_size_t), how(1), how(2), progress, progress_data, handle)
    if (status >= KO_OK) call mesh_adopt(mesh, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! The same of the cells whose density is above `level`, 1/2 where it is absent, with densities (n_cells); the mesh is drawn to where the density
  ! passes it.
  subroutine part_mesh_of_densities(self, densities, mesh, level, within, rounds, listener, stat, errmsg)
    class(keepout_part), intent(in) :: self
    real(c_double), intent(in), contiguous :: densities(:)
    type(keepout_mesh), intent(inout) :: mesh
    real(c_double), intent(in), optional :: level
    integer(c_int32_t), intent(in), optional :: within
    integer, intent(in), optional :: rounds
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(listener_box), target :: box
    type(c_funptr) :: progress
    type(c_ptr) :: progress_data, handle
    real(c_double) :: above
    integer(c_int32_t) :: status, how(2)
    progress = c_null_funptr
    progress_data = c_null_ptr
    if (present(listener)) call listen(box, listener, progress, progress_data)
    above = 0.5_c_double
    if (present(level)) above = level
    how = boundary(within, rounds)
    status = ko_part_mesh_of_densities(self%handle, densities, size(densities, 1, c_size_t), above, how(1), how(2), progress, &
      progress_data, handle)
    if (status >= KO_OK) call mesh_adopt(mesh, handle)
    call settle(status, stat, errmsg)
  end subroutine

  ! Where a mesh may be and how often its vertices are moved, as C has them.
  pure function boundary(within, rounds) result(how)
    integer(c_int32_t), intent(in), optional :: within
    integer, intent(in), optional :: rounds
    integer(c_int32_t) :: how(2)
    how = [KO_WITHIN_CELLS, 20_c_int32_t]
    if (present(within)) how(1) = within
    if (present(rounds)) how(2) = int(max(rounds, 0), c_int32_t)
  end function

  ! Which cells of `still` this part's `cells`, without them all that it may have, pass over, into swept. A part without motion stays.
  subroutine part_sweep(self, motion, still, swept, still_motion, cells, options, listener, stat, errmsg)
    class(keepout_part), intent(in) :: self
    type(keepout_motion), intent(in) :: motion
    type(keepout_part), intent(in) :: still
    integer(c_int8_t), intent(inout), contiguous :: swept(:)
    type(keepout_motion), intent(in), optional :: still_motion
    integer(c_int8_t), intent(in), contiguous, target, optional :: cells(:)
    type(ko_pair_options), intent(in), optional :: options
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_pair_options) :: plain
    type(listener_box), target :: box
    type(c_ptr) :: own
    integer(c_size_t) :: n
    plain = keepout_pair_options()
    if (present(options)) plain = options
    if (present(listener)) call listen(box, listener, plain%progress, plain%progress_data)
    own = c_null_ptr
    n = 0
    if (present(cells)) then
      n = size(cells, 1, c_size_t)
      if (n > 0) own = c_loc(cells)
    end if
    call settle(ko_part_sweep(self%handle, own, n, motion%handle, still%handle, motion_of(still_motion), plain, &
      size(swept, 1, c_size_t), swept), stat, errmsg)
  end subroutine

  ! Takes out of kept (n_cells) what breaks `rule`, KO_AVOID or KO_STAY_IN, about `body` and its cells, without them all that it may have.
  subroutine part_unsweep(self, motion, body, rule, kept, body_motion, body_cells, options, listener, stat, errmsg)
    class(keepout_part), intent(in) :: self
    type(keepout_motion), intent(in) :: motion
    type(keepout_part), intent(in) :: body
    integer(c_int32_t), intent(in) :: rule
    integer(c_int8_t), intent(inout), contiguous :: kept(:)
    type(keepout_motion), intent(in), optional :: body_motion
    integer(c_int8_t), intent(in), contiguous, target, optional :: body_cells(:)
    type(ko_pair_options), intent(in), optional :: options
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_pair_options) :: plain
    type(listener_box), target :: box
    type(c_ptr) :: own
    integer(c_size_t) :: n
    plain = keepout_pair_options()
    if (present(options)) plain = options
    if (present(listener)) call listen(box, listener, plain%progress, plain%progress_data)
    own = c_null_ptr
    n = 0
    if (present(body_cells)) then
      n = size(body_cells, 1, c_size_t)
      if (n > 0) own = c_loc(body_cells)
    end if
    call settle(ko_part_unsweep(self%handle, motion%handle, body%handle, own, n, motion_of(body_motion), rule, plain, &
      size(kept, 1, c_size_t), kept), stat, errmsg)
  end subroutine

  ! For calls of keepout_c; it stays the part's.
  pure function part_c_handle(self) result(handle)
    class(keepout_part), intent(in) :: self
    type(c_ptr) :: handle
    handle = self%handle
  end function

  ! The handle of a motion, NULL where it is absent.
  function motion_of(motion) result(handle)
    type(keepout_motion), intent(in), optional :: motion
    type(c_ptr) :: handle
    handle = c_null_ptr
    if (present(motion)) handle = motion%handle
  end function

  ! A number of threads, 0 where it is absent.
  pure integer(c_int32_t) function given(n_threads)
    integer, intent(in), optional :: n_threads
    given = 0
    if (present(n_threads)) given = int(n_threads, c_int32_t)
  end function

  ! Of two parts and their motions; a part without motion stays. stat may be KO_NEVER_MEET, which is no error. `listener` is told of progress.
  subroutine pair_create(self, part_1, part_2, motion_1, motion_2, options, listener, stat, errmsg)
    class(keepout_pair), intent(inout) :: self
    type(keepout_part), intent(in) :: part_1, part_2
    type(keepout_motion), intent(in), optional :: motion_1, motion_2
    type(ko_pair_options), intent(in), optional :: options
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_pair_options) :: plain
    type(listener_box), target :: box
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    plain = keepout_pair_options()
    if (present(options)) plain = options
    if (present(listener)) call listen(box, listener, plain%progress, plain%progress_data)
    status = ko_pair_create(part_1%handle, motion_of(motion_1), part_2%handle, motion_of(motion_2), plain, handle)
    if (status >= KO_OK) then
      call self%free()
      self%handle = handle
      self%width = part_1%width
      self%n = [part_1%n, part_2%n]
    end if
    call settle(status, stat, errmsg)
  end subroutine

  subroutine pair_free(self)
    class(keepout_pair), intent(inout) :: self
    call ko_pair_free(self%handle)
    self%handle = c_null_ptr
    self%width = 0
    self%n = 0
  end subroutine

  subroutine pair_report(self, report, stat, errmsg)
    class(keepout_pair), intent(in) :: self
    type(ko_pair_report), intent(inout) :: report
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_pair_get_report(self%handle, c_sizeof(report), report), stat, errmsg)
  end subroutine

  ! Whether an array has an entry for each cell of part `k`; of nothing held the call tells.
  logical function of_pair(self, name, found, k, stat, errmsg)
    class(keepout_pair), intent(in) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: found, k
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    of_pair = self%width == 0
    if (.not. of_pair) of_pair = right_size(name, "entries", found, int(self%n(k)), stat, errmsg)
  end function

  ! (29) and (30) of densities (n_1), (n_2).
  subroutine pair_measures(self, densities_1, densities_2, g21, g12, n_threads, stat, errmsg)
    class(keepout_pair), intent(in) :: self
    real(c_double), intent(in), contiguous :: densities_1(:), densities_2(:)
    real(c_double), intent(inout) :: g21, g12
    integer, intent(in), optional :: n_threads
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_pair_measures(self%handle, densities_1, size(densities_1, 1, c_size_t), densities_2, &
      size(densities_2, 1, c_size_t), given(n_threads), g21, g12), stat, errmsg)
  end subroutine

  ! (12), l21 (n_1), and (13), l12 (n_2).
  subroutine pair_local_measures(self, densities_1, densities_2, l21, l12, n_threads, stat, errmsg)
    class(keepout_pair), intent(in) :: self
    real(c_double), intent(in), contiguous :: densities_1(:), densities_2(:)
    real(c_double), intent(inout), contiguous, target :: l21(:), l12(:)
    integer, intent(in), optional :: n_threads
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (.not. right_size("l21", "entries", size(l21), size(densities_1), stat, errmsg)) return
    if (.not. right_size("l12", "entries", size(l12), size(densities_2), stat, errmsg)) return
    call settle(ko_pair_local_measures(self%handle, densities_1, size(densities_1, 1, c_size_t), densities_2, &
      size(densities_2, 1, c_size_t), given(n_threads), c_loc(l21), c_loc(l12)), stat, errmsg)
  end subroutine

  ! (31) and (32): of g21 by both parts' densities, d21_d1 (n_1) and d21_d2 (n_2), and of g12.
  subroutine pair_sensitivities(self, densities_1, densities_2, d21_d1, d21_d2, d12_d1, d12_d2, n_threads, stat, errmsg)
    class(keepout_pair), intent(in) :: self
    real(c_double), intent(in), contiguous :: densities_1(:), densities_2(:)
    real(c_double), intent(inout), contiguous :: d21_d1(:), d21_d2(:), d12_d1(:), d12_d2(:)
    integer, intent(in), optional :: n_threads
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (.not. right_size("d21_d1", "entries", size(d21_d1), size(densities_1), stat, errmsg)) return
    if (.not. right_size("d21_d2", "entries", size(d21_d2), size(densities_2), stat, errmsg)) return
    if (.not. right_size("d12_d1", "entries", size(d12_d1), size(densities_1), stat, errmsg)) return
    if (.not. right_size("d12_d2", "entries", size(d12_d2), size(densities_2), stat, errmsg)) return
    call settle(ko_pair_sensitivities(self%handle, densities_1, size(densities_1, 1, c_size_t), densities_2, &
      size(densities_2, 1, c_size_t), given(n_threads), d21_d1, d21_d2, d12_d1, d12_d2), stat, errmsg)
  end subroutine

  ! (B.1) and (B.2): how g21 changes, by the area or volume, as cells are put to both parts or taken from them, d21_d1 (n_1) and d21_d2 (n_2), and
  ! g12. `change` is KO_CHANGE_PUT or KO_CHANGE_TAKE.
  subroutine pair_topological_sensitivities(self, densities_1, densities_2, change, d21_d1, d21_d2, d12_d1, d12_d2, n_threads, &
    stat, errmsg)
    class(keepout_pair), intent(in) :: self
    real(c_double), intent(in), contiguous :: densities_1(:), densities_2(:)
    integer(c_int32_t), intent(in) :: change
    real(c_double), intent(inout), contiguous :: d21_d1(:), d21_d2(:), d12_d1(:), d12_d2(:)
    integer, intent(in), optional :: n_threads
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (.not. right_size("d21_d1", "entries", size(d21_d1), size(densities_1), stat, errmsg)) return
    if (.not. right_size("d21_d2", "entries", size(d21_d2), size(densities_2), stat, errmsg)) return
    if (.not. right_size("d12_d1", "entries", size(d12_d1), size(densities_1), stat, errmsg)) return
    if (.not. right_size("d12_d2", "entries", size(d12_d2), size(densities_2), stat, errmsg)) return
    call settle(ko_pair_topological_sensitivities(self%handle, densities_1, size(densities_1, 1, c_size_t), densities_2, &
      size(densities_2, 1, c_size_t), change, given(n_threads), d21_d1, d21_d2, d12_d1, d12_d2), stat, errmsg)
  end subroutine

  ! The initially colliding subdomains, (33) to (36): cells_1 (n_1) and cells_2 (n_2).
  subroutine pair_colliding(self, cells_1, cells_2, stat, errmsg)
    class(keepout_pair), intent(in) :: self
    integer(c_int8_t), intent(inout), contiguous :: cells_1(:), cells_2(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_pair_colliding(self%handle, size(cells_1, 1, c_size_t), size(cells_2, 1, c_size_t), cells_1, cells_2), &
      stat, errmsg)
  end subroutine

  ! Of any sets: what is left of the colliding cells, gamma, and how many cells of part 2 conflict with part 1's.
  subroutine pair_volumes(self, set_1, set_2, volumes, gamma, n_lost, stat, errmsg)
    class(keepout_pair), intent(in) :: self
    integer(c_int8_t), intent(in), contiguous :: set_1(:), set_2(:)
    real(c_double), intent(inout) :: volumes(2), gamma
    integer(c_size_t), intent(inout) :: n_lost
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_pair_volumes(self%handle, set_1, size(set_1, 1, c_size_t), set_2, size(set_2, 1, c_size_t), volumes, gamma, &
      n_lost), stat, errmsg)
  end subroutine

  ! From any sets to a pair that never collides and cannot grow, cells_1 (n_1) and cells_2 (n_2); `from` 1 or 2, 0: the larger.
  subroutine pair_close(self, set_1, set_2, from, cells_1, cells_2, gamma, stat, errmsg)
    class(keepout_pair), intent(in) :: self
    integer(c_int8_t), intent(in), contiguous, target :: set_1(:), set_2(:)
    integer, intent(in) :: from
    integer(c_int8_t), intent(inout), contiguous :: cells_1(:), cells_2(:)
    real(c_double), intent(inout) :: gamma
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (.not. right_size("cells_1", "entries", size(cells_1), size(set_1), stat, errmsg)) return
    if (.not. right_size("cells_2", "entries", size(cells_2), size(set_2), stat, errmsg)) return
    call settle(ko_pair_close(self%handle, c_loc(set_1), c_loc(set_2), int(from, c_int32_t), size(cells_1, 1, c_size_t), &
      size(cells_2, 1, c_size_t), cells_1, cells_2, gamma), stat, errmsg)
  end subroutine

  ! The pair of the greatest weight, cells_1 (n_1) and cells_2 (n_2), its `weight`, the `bound` that proves it, and its gamma. Weights (n_1)
  ! and (n_2) are areas or volumes where they are absent. With symmetries (2 dim (dim + 1), n), n maps of keepout_symmetry, it is the best of the
  ! pairs that all of them carry onto themselves.
  subroutine pair_cut(self, cells_1, cells_2, weight, bound, gamma, weights_1, weights_2, options, symmetries, listener, stat, &
    errmsg)
    class(keepout_pair), intent(in) :: self
    integer(c_int8_t), intent(inout), contiguous :: cells_1(:), cells_2(:)
    real(c_double), intent(inout) :: weight, bound, gamma
    real(c_double), intent(in), contiguous, target, optional :: weights_1(:), weights_2(:)
    type(ko_family_options), intent(in), optional :: options
    real(c_double), intent(in), contiguous, target, optional :: symmetries(:, :)
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_family_options) :: plain
    type(listener_box), target :: box
    type(c_ptr) :: from(2)
    plain = keepout_family_options()
    if (present(options)) plain = options
    if (present(listener)) call listen(box, listener, plain%progress, plain%progress_data)
    from = c_null_ptr
    if (present(weights_1)) then
      if (.not. of_pair(self, "weights_1", size(weights_1), 1, stat, errmsg)) return
      from(1) = c_loc(weights_1)
    end if
    if (present(weights_2)) then
      if (.not. of_pair(self, "weights_2", size(weights_2), 2, stat, errmsg)) return
      from(2) = c_loc(weights_2)
    end if
    if (present(symmetries)) then
      if (.not. with_symmetries(self, symmetries, plain, stat, errmsg)) return
    end if
    call settle(ko_pair_cut(self%handle, from(1), from(2), plain, size(cells_1, 1, c_size_t), size(cells_2, 1, c_size_t), cells_1, &
      cells_2, weight, bound, gamma), stat, errmsg)
  end subroutine

  ! A pair for each of gammas (n): cells_1 (n_1, n) and cells_2 (n_2, n), the gammas `reached` (n), what is left of the colliding cells,
  ! volumes (2, n), and bounds (n). Weights and symmetries as for cut.
  subroutine pair_family(self, gammas, cells_1, cells_2, reached, volumes, bounds, weights_1, weights_2, options, symmetries, &
    listener, stat, errmsg)
    class(keepout_pair), intent(in) :: self
    real(c_double), intent(in), contiguous :: gammas(:)
    integer(c_int8_t), intent(inout), contiguous :: cells_1(:, :), cells_2(:, :)
    real(c_double), intent(inout), contiguous, target :: reached(:), volumes(:, :), bounds(:)
    real(c_double), intent(in), contiguous, target, optional :: weights_1(:), weights_2(:)
    type(ko_family_options), intent(in), optional :: options
    real(c_double), intent(in), contiguous, target, optional :: symmetries(:, :)
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_family_options) :: plain
    type(listener_box), target :: box
    type(c_ptr) :: from(2)
    integer :: n
    n = size(gammas)
    if (.not. right_size("cells_1", "columns", size(cells_1, 2), n, stat, errmsg)) return
    if (.not. right_size("cells_2", "columns", size(cells_2, 2), n, stat, errmsg)) return
    if (.not. right_size("reached", "entries", size(reached), n, stat, errmsg)) return
    if (.not. right_shape("volumes", shape(volumes), [2, n], stat, errmsg)) return
    if (.not. right_size("bounds", "entries", size(bounds), n, stat, errmsg)) return
    plain = keepout_family_options()
    if (present(options)) plain = options
    if (present(listener)) call listen(box, listener, plain%progress, plain%progress_data)
    from = c_null_ptr
    if (present(weights_1)) then
      if (.not. of_pair(self, "weights_1", size(weights_1), 1, stat, errmsg)) return
      from(1) = c_loc(weights_1)
    end if
    if (present(weights_2)) then
      if (.not. of_pair(self, "weights_2", size(weights_2), 2, stat, errmsg)) return
      from(2) = c_loc(weights_2)
    end if
    if (present(symmetries)) then
      if (.not. with_symmetries(self, symmetries, plain, stat, errmsg)) return
    end if
    call settle(ko_pair_family(self%handle, from(1), from(2), gammas, size(gammas, 1, c_size_t), plain, &
      size(cells_1, 1, c_size_t), size(cells_2, 1, c_size_t), cells_1, cells_2, c_loc(reached), c_loc(volumes), c_loc(bounds)), &
      stat, errmsg)
  end subroutine

  ! Puts maps into the options of a cut. C takes their length from the pair, which must be right: of nothing held the call tells.
  logical function with_symmetries(self, symmetries, options, stat, errmsg)
    class(keepout_pair), intent(in) :: self
    real(c_double), intent(in), contiguous, target :: symmetries(:, :)
    type(ko_family_options), intent(inout) :: options
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer :: right
    right = 2 * self%width * (self%width + 1)
    with_symmetries = self%width == 0
    if (.not. with_symmetries) with_symmetries = right_size("symmetries", "rows", size(symmetries, 1), right, stat, errmsg)
    options%symmetries = c_null_ptr
    options%n_symmetries = size(symmetries, 2, c_size_t)
    if (size(symmetries) > 0) options%symmetries = c_loc(symmetries)
  end function

  ! Moving asymptotes, then closure: cells_1 (n_1) and cells_2 (n_2), and the densities before. history (5, n) gets V_1, V_2, g21, g12 and the
  ! change of each iterate, and must have a column more than there may be iterations. stat may be KO_BUDGET_REACHED, which is no error.
  subroutine pair_optimise(self, cells_1, cells_2, report, options, densities_1, densities_2, history, listener, stat, errmsg)
    class(keepout_pair), intent(in) :: self
    integer(c_int8_t), intent(inout), contiguous :: cells_1(:), cells_2(:)
    type(ko_optimise_report), intent(inout) :: report
    type(ko_optimise_options), intent(in), optional :: options
    real(c_double), intent(inout), contiguous, target, optional :: densities_1(:), densities_2(:), history(:, :)
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_optimise_options) :: plain
    type(listener_box), target :: box
    type(c_ptr) :: to(3)
    plain = keepout_optimise_options()
    if (present(options)) plain = options
    if (present(listener)) call listen(box, listener, plain%progress, plain%progress_data)
    to = c_null_ptr
    if (present(densities_1)) then
      if (.not. right_size("densities_1", "entries", size(densities_1), size(cells_1), stat, errmsg)) return
      to(1) = c_loc(densities_1)
    end if
    if (present(densities_2)) then
      if (.not. right_size("densities_2", "entries", size(densities_2), size(cells_2), stat, errmsg)) return
      to(2) = c_loc(densities_2)
    end if
    if (present(history)) then
      if (.not. right_shape("history", shape(history), [5, int(plain%max_iterations) + 1], stat, errmsg)) return
      to(3) = c_loc(history)
    end if
    call settle(ko_pair_optimise(self%handle, plain, size(cells_1, 1, c_size_t), size(cells_2, 1, c_size_t), to(1), to(2), &
      cells_1, cells_2, to(3), c_sizeof(report), report), stat, errmsg)
  end subroutine

  ! Gaps (n) between sets of a pair that does not collide, at n even times; the `cells` (2, n) that are nearest to each other, from 0, and
  ! `places` (dim, n) between them, in part 1's frame.
  subroutine pair_contact(self, set_1, set_2, gaps, largest, mean, cells, places, n_threads, listener, stat, errmsg)
    class(keepout_pair), intent(in) :: self
    integer(c_int8_t), intent(in), contiguous :: set_1(:), set_2(:)
    real(c_double), intent(inout), contiguous, target :: gaps(:)
    real(c_double), intent(inout) :: largest, mean
    integer(c_size_t), intent(inout), contiguous, target, optional :: cells(:, :)
    real(c_double), intent(inout), contiguous, target, optional :: places(:, :)
    integer, intent(in), optional :: n_threads
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(listener_box), target :: box
    type(c_funptr) :: progress
    type(c_ptr) :: progress_data, to(2)
    progress = c_null_funptr
    progress_data = c_null_ptr
    if (present(listener)) call listen(box, listener, progress, progress_data)
    to = c_null_ptr
    if (present(cells)) then
      if (.not. right_shape("cells", shape(cells), [2, size(gaps)], stat, errmsg)) return
      to(1) = c_loc(cells)
    end if
    if (present(places)) then
      if (.not. right_shape("places", shape(places), [self%width, size(gaps)], stat, errmsg)) return
      to(2) = c_loc(places)
    end if
    call settle(ko_pair_contact(self%handle, set_1, size(set_1, 1, c_size_t), set_2, size(set_2, 1, c_size_t), &
      size(gaps, 1, c_size_t), given(n_threads), progress, progress_data, c_loc(gaps), to(1), to(2), largest, mean), stat, errmsg)
  end subroutine

  ! Of the pairs that are as heavy as set_1 (n_1) and set_2 (n_2), which are of the greatest weight, such as those of a cut, one that keeps better
  ! in touch: cells_1 (n_1) and cells_2 (n_2). `before` is the persistence of the sets, `after` that of the cells, `n_tries` the pairs that were
  ! tried. Weights are those of the cut, absent where they were.
  subroutine pair_more_persistent(self, set_1, set_2, cells_1, cells_2, before, after, weights_1, weights_2, options, n_tries, &
    listener, stat, errmsg)
    class(keepout_pair), intent(in) :: self
    integer(c_int8_t), intent(in), contiguous :: set_1(:), set_2(:)
    integer(c_int8_t), intent(inout), contiguous :: cells_1(:), cells_2(:)
    real(c_double), intent(inout) :: before, after
    real(c_double), intent(in), contiguous, target, optional :: weights_1(:), weights_2(:)
    type(ko_persistence_options), intent(in), optional :: options
    integer(c_size_t), intent(inout), optional :: n_tries
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_persistence_options) :: plain
    type(listener_box), target :: box
    type(c_ptr) :: from(2)
    integer(c_size_t) :: tried
    integer(c_int32_t) :: status
    if (.not. right_size("cells_1", "entries", size(cells_1), size(set_1), stat, errmsg)) return
    if (.not. right_size("cells_2", "entries", size(cells_2), size(set_2), stat, errmsg)) return
    plain = keepout_persistence_options()
    if (present(options)) plain = options
    if (present(listener)) call listen(box, listener, plain%progress, plain%progress_data)
    from = c_null_ptr
    if (present(weights_1)) then
      if (.not. of_pair(self, "weights_1", size(weights_1), 1, stat, errmsg)) return
      from(1) = c_loc(weights_1)
    end if
    if (present(weights_2)) then
      if (.not. of_pair(self, "weights_2", size(weights_2), 2, stat, errmsg)) return
      from(2) = c_loc(weights_2)
    end if
    tried = 0
    status = ko_pair_more_persistent(self%handle, set_1, set_2, from(1), from(2), plain, size(cells_1, 1, c_size_t), &
      size(cells_2, 1, c_size_t), cells_1, cells_2, before, after, tried)
    if (status >= KO_OK .and. present(n_tries)) n_tries = tried
    call settle(status, stat, errmsg)
  end subroutine

  ! For calls of keepout_c; it stays the pair's.
  pure function pair_c_handle(self) result(handle)
    class(keepout_pair), intent(in) :: self
    type(c_ptr) :: handle
    handle = self%handle
  end function

  ! Of parts (n_parts) and their motions (n_parts); a part whose motion holds nothing stays. stat may be KO_NEVER_MEET, which is no error. It refers
  ! to neither parts nor motions. `listener` is told of progress.
  subroutine assembly_create(self, parts, motions, options, listener, stat, errmsg)
    class(keepout_assembly), intent(inout) :: self
    type(keepout_part), intent(in) :: parts(:)
    type(keepout_motion), intent(in) :: motions(:)
    type(ko_pair_options), intent(in), optional :: options
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_pair_options) :: plain
    type(listener_box), target :: box
    type(c_ptr) :: handle, of_parts(size(parts)), of_motions(size(parts))
    integer(c_int32_t) :: status
    integer :: k
    if (.not. right_size("motions", "entries", size(motions), size(parts), stat, errmsg)) return
    do k = 1, size(parts)
      of_parts(k) = parts(k)%handle
      of_motions(k) = motions(k)%handle
    end do
    plain = keepout_pair_options()
    if (present(options)) plain = options
    if (present(listener)) call listen(box, listener, plain%progress, plain%progress_data)
    status = ko_assembly_create(of_parts, of_motions, size(parts, 1, c_size_t), plain, handle)
    if (status >= KO_OK) then
      call self%free()
      self%handle = handle
      self%width = parts(1)%width
      self%parts = size(parts)
      self%n = sum(parts%n)
    end if
    call settle(status, stat, errmsg)
  end subroutine

  subroutine assembly_free(self)
    class(keepout_assembly), intent(inout) :: self
    call ko_assembly_free(self%handle)
    self%handle = c_null_ptr
    self%width = 0
    self%parts = 0
    self%n = 0
  end subroutine

  ! 3 in space, 2 in the plane, 0 where nothing is held.
  pure integer function assembly_dim(self)
    class(keepout_assembly), intent(in) :: self
    assembly_dim = self%width
  end function

  pure integer function assembly_n_parts(self)
    class(keepout_assembly), intent(in) :: self
    assembly_n_parts = self%parts
  end function

  ! Cells of all parts.
  pure integer(c_size_t) function assembly_n_cells(self)
    class(keepout_assembly), intent(in) :: self
    assembly_n_cells = self%n
  end function

  subroutine assembly_report(self, report, stat, errmsg)
    class(keepout_assembly), intent(in) :: self
    type(ko_assembly_report), intent(inout) :: report
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_assembly_get_report(self%handle, c_sizeof(report), report), stat, errmsg)
  end subroutine

  ! Allocates and fills meetings (2, n): pairs of parts of which some cells conflict, by their numbers from 0 on, the smaller one first.
  subroutine assembly_copy_meetings(self, meetings, stat, errmsg)
    class(keepout_assembly), intent(in) :: self
    integer(c_size_t), allocatable, intent(out) :: meetings(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_assembly_report) :: report
    integer(c_int32_t) :: status
    integer :: failed
    report%n_meetings = 0
    status = ko_assembly_get_report(self%handle, c_sizeof(report), report)
    allocate (meetings(2, report%n_meetings), stat=failed)
    if (.not. has_room(failed, stat, errmsg)) return
    if (status >= KO_OK) status = ko_assembly_copy_meetings(self%handle, size(meetings, 2, c_size_t), meetings)
    call settle(status, stat, errmsg)
  end subroutine

  ! From any sets (n_cells) to cells (n_cells) of parts that never collide and of which none can grow. Part by part in the order (n_parts), numbers
  ! from 0 on, each keeps of its set what those before it leave; without it they are taken as they were given.
  subroutine assembly_close(self, sets, cells, order, stat, errmsg)
    class(keepout_assembly), intent(in) :: self
    integer(c_int8_t), intent(in), contiguous :: sets(:)
    integer(c_int8_t), intent(inout), contiguous :: cells(:)
    integer, intent(in), optional :: order(:)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    integer(c_size_t), target :: numbers(self%parts)
    type(c_ptr) :: by
    if (.not. right_size("sets", "entries", size(sets), size(cells), stat, errmsg)) return
    by = c_null_ptr
    if (present(order) .and. self%parts > 0) then
      if (.not. right_size("order", "entries", size(order), self%parts, stat, errmsg)) return
      numbers = int(order, c_size_t)
      by = c_loc(numbers)
    end if
    call settle(ko_assembly_close(self%handle, sets, by, size(cells, 1, c_size_t), cells), stat, errmsg)
  end subroutine

  ! Parts of great weight that never collide and of which none can grow, cells (n_cells), their `weight`, and the `bound` that none weigh more than;
  ! both are the same where parts that meet take two colours. Weights (n_cells) are areas or volumes where they are absent. `n_cuts` counts the
  ! cuts that it took.
  subroutine assembly_arrange(self, cells, weight, bound, weights, options, n_cuts, listener, stat, errmsg)
    class(keepout_assembly), intent(in) :: self
    integer(c_int8_t), intent(inout), contiguous :: cells(:)
    real(c_double), intent(inout) :: weight, bound
    real(c_double), intent(in), contiguous, target, optional :: weights(:)
    type(ko_arrange_options), intent(in), optional :: options
    integer(c_size_t), intent(inout), optional :: n_cuts
    class(keepout_listener), intent(inout), target, optional :: listener
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_arrange_options) :: plain
    type(listener_box), target :: box
    type(c_ptr) :: from
    integer(c_size_t) :: cuts
    integer(c_int32_t) :: status
    plain = keepout_arrange_options()
    if (present(options)) plain = options
    if (present(listener)) call listen(box, listener, plain%progress, plain%progress_data)
    from = c_null_ptr
    if (present(weights)) then
      if (.not. right_size("weights", "entries", size(weights), size(cells), stat, errmsg)) return
      if (size(weights) > 0) from = c_loc(weights)
    end if
    cuts = 0
    status = ko_assembly_arrange(self%handle, from, plain, size(cells, 1, c_size_t), cells, weight, bound, cuts)
    if (status >= KO_OK .and. present(n_cuts)) n_cuts = cuts
    call settle(status, stat, errmsg)
  end subroutine

  ! For calls of keepout_c; it stays the assembly's.
  pure function assembly_c_handle(self) result(handle)
    class(keepout_assembly), intent(in) :: self
    type(c_ptr) :: handle
    handle = self%handle
  end function

  subroutine motion_adopt(self, handle)
    class(keepout_motion), intent(inout) :: self
    type(c_ptr), intent(in) :: handle
    integer(c_int32_t) :: dim
    call self%free()
    self%handle = handle
    call settle(ko_motion_get_dim(handle, dim))
    self%width = int(dim)
  end subroutine

  impure elemental subroutine motion_final(self)
    type(keepout_motion), intent(inout) :: self
    call self%free()
  end subroutine

  impure elemental subroutine part_final(self)
    type(keepout_part), intent(inout) :: self
    call self%free()
  end subroutine

  impure elemental subroutine pair_final(self)
    type(keepout_pair), intent(inout) :: self
    call self%free()
  end subroutine

  impure elemental subroutine assembly_final(self)
    type(keepout_assembly), intent(inout) :: self
    call self%free()
  end subroutine

  subroutine motion_assign(left, right)
    class(keepout_motion), intent(inout) :: left
    class(keepout_motion), intent(in) :: right
    if (c_associated(left%handle) .or. c_associated(right%handle)) error stop "keepout: a keepout_motion cannot be assigned"
  end subroutine

  subroutine part_assign(left, right)
    class(keepout_part), intent(inout) :: left
    class(keepout_part), intent(in) :: right
    if (c_associated(left%handle) .or. c_associated(right%handle)) error stop "keepout: a keepout_part cannot be assigned"
  end subroutine

  subroutine pair_assign(left, right)
    class(keepout_pair), intent(inout) :: left
    class(keepout_pair), intent(in) :: right
    if (c_associated(left%handle) .or. c_associated(right%handle)) error stop "keepout: a keepout_pair cannot be assigned"
  end subroutine

  subroutine assembly_assign(left, right)
    class(keepout_assembly), intent(inout) :: left
    class(keepout_assembly), intent(in) :: right
    if (c_associated(left%handle) .or. c_associated(right%handle)) error stop "keepout: a keepout_assembly cannot be assigned"
  end subroutine

  ! ---- Other formulations

  ! Of the points of `cloud`, to which it does not refer.
  subroutine explicit_create(self, cloud, options, stat, errmsg)
    class(keepout_explicit), intent(inout) :: self
    type(keepout_cloud), intent(in) :: cloud
    type(ko_explicit_options), intent(in), optional :: options
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(ko_explicit_options) :: plain
    type(c_ptr) :: handle
    integer(c_int32_t) :: status
    plain = keepout_explicit_options()
    if (present(options)) plain = options
    status = ko_explicit_create(cloud%handle, plain, handle)
    if (status >= KO_OK) then
      call self%free()
      self%handle = handle
      self%width = cloud%width
    end if
    call settle(status, stat, errmsg)
  end subroutine

  subroutine explicit_free(self)
    class(keepout_explicit), intent(inout) :: self
    call ko_explicit_free(self%handle)
    self%handle = c_null_ptr
    self%width = 0
  end subroutine

  ! 3 in space, 2 in the plane, 0 where nothing is held.
  pure integer function explicit_dim(self)
    class(keepout_explicit), intent(in) :: self
    explicit_dim = self%width
  end function

  ! Tells rho, in 1 / D; 0 where the formula has none.
  subroutine explicit_smoothing(self, smoothing, stat, errmsg)
    class(keepout_explicit), intent(in) :: self
    real(c_double), intent(inout) :: smoothing
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call settle(ko_explicit_get_smoothing(self%handle, smoothing), stat, errmsg)
  end subroutine

  ! Evaluates at points (dim, n) into values (n) and gradients (dim, n). No allocation, no lock, where the arrays are contiguous.
  subroutine explicit_eval(self, points, values, gradients, stat, errmsg)
    class(keepout_explicit), intent(in) :: self
    real(c_double), intent(in), contiguous :: points(:, :)
    real(c_double), intent(inout), contiguous, target, optional :: values(:)
    real(c_double), intent(inout), contiguous, target, optional :: gradients(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: to(3)
    if (.not. addresses(self%width, points, values, gradients, to=to, stat=stat, errmsg=errmsg)) return
    call settle(ko_explicit_eval(self%handle, points, size(points, 2, c_size_t), to(1), to(2)), stat, errmsg)
  end subroutine

  ! For calls of keepout_c; it stays the formulation's.
  pure function explicit_c_handle(self) result(handle)
    class(keepout_explicit), intent(in) :: self
    type(c_ptr) :: handle
    handle = self%handle
  end function

  ! How far two triangulations are apart, and how much they cross, with mesh_b moved by translation (3). `sharpness` 0, the default: the
  ! minimum distance itself, else its KS. The gradients (3, mesh_b%n_vertices()) are by the vertices of mesh_b.
  subroutine keepout_separation(mesh_a, mesh_b, separation, translation, sharpness, distance_gradients, length_gradients, stat, &
    errmsg)
    type(keepout_mesh), intent(in) :: mesh_a, mesh_b
    type(ko_separation), intent(inout) :: separation
    real(c_double), intent(in), target, optional :: translation(3)
    real(c_double), intent(in), optional :: sharpness
    real(c_double), intent(inout), contiguous, target, optional :: distance_gradients(:, :), length_gradients(:, :)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    type(c_ptr) :: by, to(2)
    real(c_double) :: rho
    integer :: right(2)
    by = c_null_ptr
    to = c_null_ptr
    rho = 0
    right = [3, int(mesh_b%vertices)]
    if (present(translation)) by = c_loc(translation)
    if (present(sharpness)) rho = sharpness
    if (present(distance_gradients)) then
      if (.not. right_shape("distance_gradients", shape(distance_gradients), right, stat, errmsg)) return
      to(1) = c_loc(distance_gradients)
    end if
    if (present(length_gradients)) then
      if (.not. right_shape("length_gradients", shape(length_gradients), right, stat, errmsg)) return
      to(2) = c_loc(length_gradients)
    end if
    call settle(ko_meshes_separation(mesh_a%handle, mesh_b%handle, by, rho, mesh_b%vertices, c_sizeof(separation), separation, &
      to(1), to(2)), stat, errmsg)
  end subroutine

  ! ---- Ownership

  subroutine mesh_adopt(self, handle)
    class(keepout_mesh), intent(inout) :: self
    type(c_ptr), intent(in) :: handle
    integer(c_int32_t) :: dim
    call self%free()
    self%handle = handle
    call settle(ko_mesh_get_dim(handle, dim))
    self%width = int(dim)
    call settle(ko_mesh_get_size(handle, self%vertices, self%triangles))
  end subroutine

  subroutine cloud_adopt(self, handle)
    class(keepout_cloud), intent(inout) :: self
    type(c_ptr), intent(in) :: handle
    integer(c_int32_t) :: dim
    call self%free()
    self%handle = handle
    call settle(ko_cloud_get_dim(handle, dim))
    self%width = int(dim)
    call settle(ko_cloud_get_size(handle, self%points))
  end subroutine

  subroutine field_adopt(self, handle)
    class(keepout_field), intent(inout) :: self
    type(c_ptr), intent(in) :: handle
    type(ko_fit_report) :: report
    call self%free()
    self%handle = handle
    call self%report(report)
    self%width = int(report%dim)
  end subroutine

  subroutine body_adopt(self, handle)
    class(keepout_body), intent(inout) :: self
    type(c_ptr), intent(in) :: handle
    integer(c_int32_t) :: dim
    call self%free()
    self%handle = handle
    call settle(ko_body_get_dim(handle, dim))
    self%width = int(dim)
    call settle(ko_body_get_size(handle, self%points))
  end subroutine

  impure elemental subroutine mesh_final(self)
    type(keepout_mesh), intent(inout) :: self
    call self%free()
  end subroutine

  impure elemental subroutine cloud_final(self)
    type(keepout_cloud), intent(inout) :: self
    call self%free()
  end subroutine

  impure elemental subroutine field_final(self)
    type(keepout_field), intent(inout) :: self
    call self%free()
  end subroutine

  impure elemental subroutine body_final(self)
    type(keepout_body), intent(inout) :: self
    call self%free()
  end subroutine

  impure elemental subroutine constraints_final(self)
    type(keepout_constraints), intent(inout) :: self
    call self%free()
  end subroutine

  impure elemental subroutine sensitivity_final(self)
    type(keepout_sensitivity), intent(inout) :: self
    call self%free()
  end subroutine

  impure elemental subroutine explicit_final(self)
    type(keepout_explicit), intent(inout) :: self
    call self%free()
  end subroutine

  ! A copy would be freed twice. Two that hold nothing are equal already. `allocate (c, source=mesh)` and structure constructors copy
  ! without a call of this, which no code here can prevent; move_alloc moves a handle that is allocatable.
  subroutine mesh_assign(left, right)
    class(keepout_mesh), intent(inout) :: left
    class(keepout_mesh), intent(in) :: right
    if (c_associated(left%handle) .or. c_associated(right%handle)) error stop "keepout: a keepout_mesh cannot be assigned"
  end subroutine

  subroutine cloud_assign(left, right)
    class(keepout_cloud), intent(inout) :: left
    class(keepout_cloud), intent(in) :: right
    if (c_associated(left%handle) .or. c_associated(right%handle)) error stop "keepout: a keepout_cloud cannot be assigned"
  end subroutine

  subroutine field_assign(left, right)
    class(keepout_field), intent(inout) :: left
    class(keepout_field), intent(in) :: right
    if (c_associated(left%handle) .or. c_associated(right%handle)) error stop "keepout: a keepout_field cannot be assigned"
  end subroutine

  subroutine body_assign(left, right)
    class(keepout_body), intent(inout) :: left
    class(keepout_body), intent(in) :: right
    if (c_associated(left%handle) .or. c_associated(right%handle)) error stop "keepout: a keepout_body cannot be assigned"
  end subroutine

  subroutine constraints_assign(left, right)
    class(keepout_constraints), intent(inout) :: left
    class(keepout_constraints), intent(in) :: right
    if (c_associated(left%handle) .or. c_associated(right%handle)) error stop "keepout: keepout_constraints cannot be assigned"
  end subroutine

  subroutine sensitivity_assign(left, right)
    class(keepout_sensitivity), intent(inout) :: left
    class(keepout_sensitivity), intent(in) :: right
    if (c_associated(left%handle) .or. c_associated(right%handle)) then
      error stop "keepout: a keepout_sensitivity cannot be assigned"
    end if
  end subroutine

  subroutine explicit_assign(left, right)
    class(keepout_explicit), intent(inout) :: left
    class(keepout_explicit), intent(in) :: right
    if (c_associated(left%handle) .or. c_associated(right%handle)) error stop "keepout: a keepout_explicit cannot be assigned"
  end subroutine

  ! ---- Strings and errors

  function from_c(text) result(copied)
    type(c_ptr), intent(in) :: text
    character(:), allocatable :: copied
    character(kind=c_char), pointer :: characters(:)
    integer :: i
    call c_f_pointer(text, characters, [keepout_strlen(text)])
    allocate (character(size(characters)) :: copied)
    do i = 1, size(characters)
      copied(i:i) = characters(i)
    end do
  end function

  ! C would end a path at a zero byte, and take another file.
  logical function is_path(path, stat, errmsg)
    character(len=*), intent(in) :: path
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    is_path = index(path, c_null_char) == 0
    if (.not. is_path) call refuse("the path has a zero byte in it", stat, errmsg)
  end function

  pure function to_c(text) result(ended)
    character(len=*), intent(in) :: text
    character(len=len_trim(text) + 1) :: ended
    ended = trim(text) // c_null_char
  end function

  ! Ends a call of C.
  subroutine settle(status, stat, errmsg)
    integer(c_int32_t), intent(in) :: status
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (status < KO_OK) then
      call conclude(status, keepout_last_error(), stat, errmsg)
    else if (present(stat)) then
      stat = status
    end if
  end subroutine

  ! Ends a call that failed.
  subroutine conclude(status, message, stat, errmsg)
    integer(c_int32_t), intent(in) :: status
    character(len=*), intent(in) :: message
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    if (present(errmsg)) errmsg = message
    if (present(stat)) then
      stat = status
    else
      write (error_unit, "(4a)") "keepout: ", message, " - ", keepout_status_string(status)
      error stop 1
    end if
  end subroutine

  ! `name` has `found` rows or entries and needs `right`.
  logical function right_size(name, unit, found, right, stat, errmsg)
    character(len=*), intent(in) :: name, unit
    integer, intent(in) :: found, right
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    character(len=100) :: message
    right_size = found == right
    if (right_size) return
    write (message, "(2a, i0, 2a)") name, " has ", found, " ", unit
    write (message(len_trim(message) + 1:), "(a, i0, a)") "; ", right, " are needed"
    call refuse(trim(message), stat, errmsg)
  end function

  ! `name` has the shape `found` and needs `right`.
  logical function right_shape(name, found, right, stat, errmsg)
    character(len=*), intent(in) :: name
    integer, intent(in) :: found(2), right(2)
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    character(len=120) :: message
    right_shape = all(found == right)
    if (right_shape) return
    write (message, "(2a, i0, a, i0, a, i0, a, i0, a)") name, " has the shape (", found(1), ", ", found(2), "); (", right(1), &
      ", ", right(2), ") is needed"
    call refuse(trim(message), stat, errmsg)
  end function

  ! Whether an allocation whose stat is `failed` got its memory.
  logical function has_room(failed, stat, errmsg)
    integer, intent(in) :: failed
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    has_room = failed == 0
    if (.not. has_room) call conclude(KO_ERR_OUT_OF_MEMORY, "there is no memory for the arrays to copy to", stat, errmsg)
  end function

  ! Whether an array has an entry for each coordinate of a cloud's points; of nothing held the call tells.
  logical function of_cloud(name, found, width, points, stat, errmsg)
    character(len=*), intent(in) :: name
    integer, intent(in) :: found(2), width
    integer(c_size_t), intent(in) :: points
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    of_cloud = width == 0
    if (.not. of_cloud) of_cloud = right_shape(name, found, [width, int(points)], stat, errmsg)
  end function

  subroutine refuse(message, stat, errmsg)
    character(len=*), intent(in) :: message
    integer(c_int32_t), intent(out), optional :: stat
    character(len=*), intent(inout), optional :: errmsg
    call conclude(KO_ERR_INVALID_ARGUMENT, message, stat, errmsg)
  end subroutine
end module
