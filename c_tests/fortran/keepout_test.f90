! keepout.f90: every call, in space and in the plane, its errors, and who owns what.

module listeners
  use keepout
  implicit none

  ! Counts, and cancels from the fraction `until` on.
  type, extends(keepout_listener) :: counter
    integer :: calls = 0
    real(c_double) :: last = -1
    real(c_double) :: until = 2
    logical :: ascends = .true.
  contains
    procedure :: hear => count_call
  end type

contains

  subroutine count_call(self, fraction, stage, cancel)
    class(counter), intent(inout) :: self
    real(c_double), intent(in) :: fraction
    character(len=*), intent(in) :: stage
    logical, intent(inout) :: cancel
    self%ascends = self%ascends .and. fraction >= self%last .and. len(stage) > 0
    self%calls = self%calls + 1
    self%last = fraction
    cancel = fraction >= self%until
  end subroutine
end module

program keepout_test
  use keepout
  use check
  use layout
  use listeners
  use cogen_test
  implicit none

  call layouts_agree()
  call versions_are_told()
  call meshes_and_clouds()
  call planes()
  call fields()
  call derivatives_are_those_of_the_values()
  call meshes_are_given_away()
  call normals_are_estimated()
  call clouds_are_smoothed()
  call clouds_have_sides()
  call fields_are_made_of_fields()
  call lattices_are_evaluated()
  call level_sets_are_meshes()
  call fields_are_certified()
  call clouds_are_not_trusted_alike()
  call numbers_are_aggregated()
  call bodies_are_points()
  call fields_are_combined()
  call constraints_are_differentiated()
  call constraints_are_checked()
  call values_have_derivatives_by_the_cloud()
  call formulas_are_evaluated()
  call meshes_are_separated()
  call cogen_works()
  call progress_is_heard()
  call errors_are_told()
  call handles_have_one_owner()
  call finish()

contains

  subroutine versions_are_told()
    call holds(ko_abi_version() == KO_MODULE_ABI_VERSION, "ko_abi_version")
    call holds(len(keepout_version()) >= len("0.0.0"), "keepout_version")
    call holds(iand(ko_capabilities(), KO_CAPABILITY_3D) /= 0, "ko_capabilities")
    call holds(keepout_status_string(KO_ERR_NOT_CONVERGED) == "KO_ERR_NOT_CONVERGED", "keepout_status_string")
    call holds(keepout_last_error() == "", "keepout_last_error before any error")
  end subroutine

  subroutine meshes_and_clouds()
    type(keepout_mesh) :: mesh
    type(keepout_cloud) :: cloud, again
    type(ko_mesh_report) :: report
    real(c_double), allocatable :: vertices(:, :), points(:, :), normals(:, :), barycentric(:, :)
    real(c_double) :: distances(2)
    integer(c_int32_t), allocatable :: triangles(:, :), origins(:)
    call cube(mesh)
    call holds(mesh%dim() == 3 .and. mesh%n_vertices() == 8 .and. mesh%n_triangles() == 12, "size of the cube")
    call mesh%copy(vertices, triangles)
    call holds(all(abs(vertices - cube_vertices) <= 0) .and. all(triangles == cube_triangles), "mesh%copy")
    call mesh%flip()
    call mesh%report(report)
    call holds(report%closed == 1 .and. report%inside_out == 1, "mesh%flip")
    call mesh%flip()
    call mesh%report(report)
    call holds(report%struct_size == c_sizeof(report) .and. report%n_components == 1, "mesh%report")
    call near(report%volume, 8.0_c_double, 1e-14_c_double, "volume of the cube")
    call mesh%signed_distance(reshape(real([2, 0, 0, 0, 0, 0], c_double), [3, 2]), distances)
    call near(distances(1), 1.0_c_double, 1e-15_c_double, "distance outside")
    call near(distances(2), -1.0_c_double, 1e-15_c_double, "distance inside")

    call mesh%sample(300, 1, cloud)
    call holds(cloud%dim() == 3 .and. cloud%n_points() == 300, "size of the cloud")
    call cloud%copy(points, normals)
    call holds(all(shape(points) == [3, 300]), "shape of points")
    call near(maxval(sum(normals**2, 1)), 1.0_c_double, 1e-14_c_double, "length of normals")
    call near(minval(sum(points * normals, 1)), 1.0_c_double, 1e-14_c_double, "points lie on faces")
    call cloud%copy_origins(origins, barycentric)
    call holds(all(origins >= 0 .and. origins < 12) .and. all(shape(barycentric) == [3, 300]), "cloud%copy_origins")
    call again%from_points(points, normals)
    call holds(again%dim() == 3 .and. again%n_points() == 300, "cloud%from_points")
  end subroutine

  subroutine planes()
    type(keepout_mesh) :: mesh, line
    type(keepout_cloud) :: cloud, again
    type(keepout_field) :: field
    type(ko_fit_report) :: report
    real(c_double), allocatable :: points(:, :), normals(:, :), barycentric(:, :)
    real(c_double) :: at(2, 3), values(3), gradients(2, 3), hessians(3, 3), distances(3)
    integer(c_int32_t), allocatable :: origins(:)
    integer(c_int8_t) :: outside(3)
    call frame(mesh)
    call holds(mesh%dim() == 2 .and. mesh%n_triangles() == 8, "mesh%from_polylines")
    call line%from_polylines(frame_points(:, :2), [0], KEEPOUT_OPEN)
    call holds(line%n_triangles() == 1, "an open polyline")
    call mesh%sample(400, 1, cloud)
    call cloud%copy(points, normals)
    call cloud%copy_origins(origins, barycentric)
    call holds(all(shape(points) == [2, 400]) .and. all(shape(barycentric) == [2, 400]), "shapes in the plane")
    call again%from_points(points, normals)
    call holds(again%dim() == 2, "a cloud in the plane")

    call field%fit(cloud, small_fit(16))
    call field%report(report)
    call holds(field%dim() == 2 .and. report%dim == 2 .and. report%n_unknowns == 256, "a field in the plane")
    at = reshape(real([0, 0, 3, 0, 20, 20], c_double) / 4, [2, 3])
    call field%eval(at, values, gradients, hessians)
    call mesh%signed_distance(at, distances)
    call holds(values(1) > 0 .and. values(2) < 0 .and. values(3) > 0, "signs in the plane")
    call near(distances(2), -0.25_c_double, 1e-15_c_double, "distance in the plane")
    call field%outside_box(at, outside)
    call holds(all(outside == [0, 0, 1]), "field%outside_box in the plane")
  end subroutine

  subroutine fields()
    type(keepout_mesh) :: mesh
    type(keepout_cloud) :: cloud
    type(keepout_field) :: field, loaded
    type(ko_fit_report) :: report
    real(c_double) :: points(3, 3), values(3), gradients(3, 3), hessians(6, 3), again(3), slopes(3, 3), bends(6, 3)
    integer(c_int8_t) :: outside(3)
    integer :: unit
    call cube(mesh)
    call mesh%sample(500, 1, cloud)
    call field%fit(cloud, small_fit(8))
    call field%report(report)
    call holds(report%n_unknowns == 512 .and. report%struct_size == c_sizeof(report), "field%report")
    points = reshape(real([0, 0, 0, 11, 2, 0, 50, 50, 50], c_double) / 10, [3, 3])
    call field%eval(points, values, gradients, hessians)
    call holds(values(1) < 0 .and. values(2) > 0 .and. gradients(1, 2) > 0.5, "field%eval")
    call field%eval(points, values=again)
    call holds(all(abs(again - values) <= 0), "values alone")
    call field%eval(points(:, :0))
    call field%eval_parallel(2, points, again, slopes, bends)
    call holds(all(abs(again - values) <= 0) .and. all(abs(slopes - gradients) <= 0) .and. all(abs(bends - hessians) <= 0), &
      "field%eval_parallel")
    ! A section with gaps: copied in and out.
    again = 0
    call field%eval(points(:, 1:3:2), again(1:3:2))
    call holds(all(abs(again([1, 3]) - values([1, 3])) <= 0) .and. abs(again(2)) <= 0, "sections")
    call field%outside_box(points, outside)
    call holds(all(outside == [0, 0, 1]), "field%outside_box")

    call field%save("fortran.kof  ")
    call loaded%load("fortran.kof")
    call loaded%eval(points, again)
    call holds(loaded%dim() == 3 .and. all(abs(again - values) <= 0), "field%load")
    open (newunit=unit, file="fortran.kof", status="old")
    close (unit, status="delete")
  end subroutine

  subroutine derivatives_are_those_of_the_values()
    integer, parameter :: packed(3, 3) = reshape([1, 2, 3, 2, 4, 5, 3, 5, 6], [3, 3])
    real(c_double), parameter :: step = 1e-5_c_double
    type(keepout_mesh) :: mesh
    type(keepout_cloud) :: cloud
    type(keepout_field) :: field
    real(c_double) :: point(3, 1), gradient(3, 1), hessian(6, 1), ends(3, 2), values(2), gradients(3, 2)
    integer :: i, a
    call cube(mesh)
    call mesh%sample(500, 1, cloud)
    call field%fit(cloud, small_fit(8))
    do i = 1, 20
      point(:, 1) = [cos(1.0_c_double * i), sin(2.0_c_double * i), cos(3.0_c_double * i)]
      call field%eval(point, gradients=gradient, hessians=hessian)
      do a = 1, 3
        ends = spread(point(:, 1), 2, 2)
        ends(a, :) = ends(a, :) + [-step, step]
        call field%eval(ends, values, gradients)
        call near((values(2) - values(1)) / (2 * step), gradient(a, 1), 1e-8_c_double, "a difference of values")
        call near(maxval(abs((gradients(:, 2) - gradients(:, 1)) / (2 * step) - hessian(packed(:, a), 1))), 0.0_c_double, &
          1e-2_c_double, "a difference of gradients")
      end do
    end do
  end subroutine

  ! The curves of a mesh of the plane, and files of meshes.
  subroutine meshes_are_given_away()
    type(keepout_mesh) :: mesh
    real(c_double), allocatable :: points(:, :), vertices(:, :)
    integer(c_size_t), allocatable :: loop_starts(:)
    integer(c_int8_t), allocatable :: closed(:)
    integer(c_int32_t), allocatable :: triangles(:, :)
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    integer :: unit
    call frame(mesh)
    call mesh%copy_polylines(points, loop_starts, closed)
    call holds(all(shape(points) == [2, 8]) .and. all(loop_starts == [0, 4]) .and. all(closed == 1), "mesh%copy_polylines")
    call holds(all(abs(points - frame_points) <= 0), "points of polylines")
    call cube(mesh)
    call mesh%copy_polylines(points, loop_starts, closed, stat, errmsg)
    call holds(stat == KO_ERR_INVALID_ARGUMENT .and. size(points) == 0, "polylines of a mesh of space")
    call mesh%write("fortran.ply  ")
    call mesh%read("fortran.ply")
    call mesh%copy(vertices, triangles)
    call holds(all(abs(vertices - cube_vertices) <= 0) .and. all(triangles == cube_triangles), "mesh%write")
    call mesh%write("fortran.txt", stat, errmsg)
    call fails(stat, errmsg, KO_ERR_UNSUPPORTED, "fortran.txt")
    open (newunit=unit, file="fortran.ply", status="old")
    close (unit, status="delete")
  end subroutine

  subroutine normals_are_estimated()
    integer, parameter :: n = 400
    type(keepout_cloud) :: cloud, plain
    type(counter) :: listener
    type(ko_normal_options) :: options
    type(ko_normal_report) :: report
    real(c_double) :: shape_of(3, n + 1), r
    real(c_double), allocatable :: points(:, :), normals(:, :), others(:, :)
    integer(c_int8_t), allocatable :: flags(:)
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    integer :: i
    do i = 1, n
      shape_of(3, i) = 1 - (2.0_c_double * i - 1) / n
      r = sqrt(1 - shape_of(3, i)**2)
      shape_of(:2, i) = r * [cos(2.4_c_double * i), sin(2.4_c_double * i)]
    end do
    shape_of(:, n + 1) = shape_of(:, 1)
    options = keepout_normal_options()
    options%n_threads = 1
    call cloud%estimate_normals(shape_of, options, listener, flags, report)
    call holds(listener%last >= 1 .and. cloud%dim() == 3 .and. cloud%n_points() == n + 1, "cloud%estimate_normals")
    call holds(report%n_copies == 1 .and. report%agreement > 0.9, "report of estimated normals")
    call holds(size(flags) == n + 1 .and. iand(flags(n + 1), KO_POINT_COPY) /= 0 .and. flags(1) == 0, "flags of points")
    call cloud%copy(points, normals)
    call holds(minval(sum(points * normals, 1)) > 0.9, "estimated normals point out")
    call plain%from_points(shape_of)
    call plain%copy(points, others)
    call holds(all(abs(others - normals) <= 0), "points without normals")
    call plain%estimate_normals(shape_of(:2, :))
    call holds(plain%dim() == 2, "normals in the plane")
    listener = counter(until=0.0_c_double)
    call plain%estimate_normals(shape_of, listener=listener, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_CANCELLED, "cancelled")
    options%neighbours = 2
    call plain%estimate_normals(shape_of, options, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "neighbours")
    call holds(plain%dim() == 2, "an estimate that fails leaves the cloud as it was")
  end subroutine

  subroutine clouds_are_smoothed()
    integer, parameter :: n = 1000
    type(keepout_cloud) :: cloud, smoothed
    type(counter) :: listener
    type(ko_smooth_options) :: options
    real(c_double) :: sphere(3, n), noise(3, n), r
    real(c_double), allocatable :: points(:, :), normals(:, :)
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    integer :: i
    do i = 1, n
      sphere(3, i) = 1 - (2.0_c_double * i - 1) / n
      r = sqrt(1 - sphere(3, i)**2)
      sphere(:2, i) = r * [cos(2.4_c_double * i), sin(2.4_c_double * i)]
      noise(:, i) = 0.02_c_double * [sin(17.0_c_double * i), sin(29.0_c_double * i), sin(43.0_c_double * i)]
    end do
    call cloud%from_points(sphere + noise, sphere)
    options = keepout_smooth_options()
    call holds(options%rounds == 1 .and. options%neighbours == 0, "keepout_smooth_options")
    options%rounds = 2
    call cloud%smooth(smoothed, options, listener)
    call holds(listener%last >= 1 .and. smoothed%dim() == 3 .and. smoothed%n_points() == n, "cloud%smooth")
    call smoothed%copy(points, normals)
    call holds(sum((norm2(points, 1) - 1)**2) < sum((norm2(sphere + noise, 1) - 1)**2) / 2, "noise of a smoothed cloud")
    call cloud%from_points(sphere(:2, :) / spread(norm2(sphere(:2, :), 1), 1, 2), sphere(:2, :))
    call cloud%smooth(smoothed)
    call holds(smoothed%dim() == 2 .and. smoothed%n_points() == n, "smoothing in the plane")
    listener = counter(until=0.0_c_double)
    call cloud%smooth(smoothed, listener=listener, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_CANCELLED, "cancelled")
    options%rounds = 0
    call cloud%smooth(smoothed, options, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "rounds is 0")
    call holds(smoothed%dim() == 2, "smoothing that fails leaves the cloud as it was")
    call cloud%free()
    call cloud%smooth(smoothed, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "cloud is NULL")
  end subroutine

  subroutine clouds_have_sides()
    use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
    type(keepout_mesh) :: mesh
    type(keepout_cloud) :: cloud
    type(keepout_field) :: field
    type(ko_fit_report) :: report
    real(c_double) :: points(3, 2), sides(2)
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    call frame(mesh)
    call mesh%sample(400, 1, cloud)
    call cloud%sides(reshape(real([0, 0, 3, 0], c_double) / 4, [2, 2]), sides)
    call holds(sides(1) > 0.75 .and. sides(2) < -0.75, "sides in the plane")
    call cube(mesh)
    call mesh%sample(1000, 1, cloud)
    points = reshape(real([0, 0, 0, 3, 0, 0], c_double) / 2, [3, 2])
    call cloud%sides(points, sides)
    call holds(sides(1) < -0.75 .and. sides(2) > 0.75, "cloud%sides")
    call field%fit(cloud, small_fit(8))
    call field%report(report)
    call near(report%clear_sides, 1.0_c_double, 0.01_c_double, "clear_sides of a closed shape")
    call cloud%sides(points(:2, :), sides, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "points has 2 rows; 3 are needed")
    call cloud%sides(points, sides(:1), stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "sides has 1 entries; 2 are needed")
    points(2, 2) = ieee_value(points(2, 2), ieee_quiet_nan)
    call cloud%sides(points, sides, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "point 1 is ")
    call cloud%free()
    call cloud%sides(points, sides, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "cloud is NULL")
  end subroutine

  ! A field goes on to a cloud nearby, and comes back from its control points.
  subroutine fields_are_made_of_fields()
    type(keepout_mesh) :: mesh
    type(keepout_cloud) :: cloud
    type(keepout_field) :: field, again, made
    type(counter) :: listener
    type(ko_fit_report) :: report, other
    real(c_double), allocatable :: control_points(:), copied(:)
    real(c_double) :: points(3, 2), values(2), right(2)
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    call cube(mesh)
    call mesh%sample(500, 1, cloud)
    call field%fit(cloud, small_fit(8))
    call again%refit(field, cloud, small_fit(8), listener)
    call field%report(report)
    call again%report(other)
    call holds(listener%last >= 1 .and. other%n_unknowns == 512 .and. 2 * other%iterations < report%iterations, "field%refit")
    call frame(mesh)
    call mesh%sample(100, 1, cloud)
    call again%refit(field, cloud, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "dim")

    call field%control_points(control_points)
    call made%from_control_points(report%control_points, report%box_min, report%box_max, report%feasible, report%diagonal, &
      control_points)
    call made%control_points(copied)
    call holds(size(copied) == 512 .and. all(abs(copied - control_points) <= 0), "field%from_control_points")
    points = reshape(real([0, 0, 0, 11, 2, 0], c_double) / 10, [3, 2])
    call field%eval(points, right)
    call made%eval(points, values)
    call near(maxval(abs(values - right)), 0.0_c_double, 1e-12_c_double, "values of control points")
    call made%from_control_points(report%control_points, report%box_min(:2), report%box_max, report%feasible, report%diagonal, &
      control_points, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "box_min has 2 entries; 3 are needed")
    call again%free()
    call again%control_points(copied, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "field is NULL")
  end subroutine

  subroutine lattices_are_evaluated()
    type(keepout_mesh) :: mesh
    type(keepout_cloud) :: cloud
    type(keepout_field) :: field
    real(c_double), parameter :: origin(3) = [-1.0_c_double, -1.0_c_double, 0.25_c_double]
    real(c_double), parameter :: steps(3, 2) = reshape(real([4, 0, 1, 0, 2, 0], c_double) / 8, [3, 2])
    real(c_double) :: points(3, 12), values(12), gradients(3, 12), right(12), slopes(3, 12)
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    integer :: i, j
    call cube(mesh)
    call mesh%sample(500, 1, cloud)
    call field%fit(cloud, small_fit(8))
    do i = 0, 2
      do j = 0, 3
        points(:, 4 * i + j + 1) = origin + i * steps(:, 1) + j * steps(:, 2)
      end do
    end do
    call field%eval(points, right, slopes)
    call field%eval_lattice(2, origin, steps, [3, 4], values, gradients)
    call near(maxval(abs(values - right)), 0.0_c_double, 1e-12_c_double, "values of a lattice")
    call near(maxval(abs(gradients - slopes)), 0.0_c_double, 1e-12_c_double, "gradients of a lattice")
    call field%eval_lattice(1, origin, steps, [3, 4], gradients=gradients)
    call field%eval_lattice(1, origin, steps, [3, 4], values(:11), stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "values has 11 entries; 12 are needed")
    call field%eval_lattice(1, origin, steps, [3], values, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "steps has the shape (3, 2); (3, 1) is needed")
    call field%eval_lattice(1, origin, steps, [3, -4], values(:0), stat=stat, errmsg=errmsg)
    call holds(stat == KO_ERR_INVALID_ARGUMENT, "a count below 1")
  end subroutine

  subroutine level_sets_are_meshes()
    type(keepout_mesh) :: mesh, set
    type(keepout_cloud) :: cloud
    type(keepout_field) :: field
    type(counter) :: listener
    type(ko_fit_options) :: wide_box
    type(ko_level_set_options) :: options
    type(ko_mesh_report) :: report
    real(c_double), allocatable :: vertices(:, :), values(:)
    integer(c_int32_t), allocatable :: triangles(:, :)
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    call cube(mesh)
    call mesh%sample(500, 1, cloud)
    wide_box = small_fit(8)
    wide_box%margin = 0.5_c_double
    call field%fit(cloud, wide_box)
    options = keepout_level_set_options()
    options%n_threads = 1
    call field%level_set(0.0_c_double, set, options, listener, stat)
    call set%report(report)
    call holds(stat == KO_OK .and. report%closed == 1 .and. listener%last >= 1, "field%level_set")
    call set%copy(vertices, triangles)
    allocate (values(size(vertices, 2)))
    call field%eval(vertices, values)
    call near(maxval(abs(values)), 0.0_c_double, 1e-8_c_double, "vertices of a level set")
    call field%level_set(0.6_c_double, set, stat=stat)
    call set%report(report)
    call holds(stat == KO_OPEN_AT_BOX .and. report%closed == 0, "KO_OPEN_AT_BOX")
    ! A remark is no failure: without stat the program goes on.
    call field%level_set(0.6_c_double, set)
    call field%level_set(100.0_c_double, set, stat=stat, errmsg=errmsg)
    call holds(stat == KO_ERR_DEGENERATE .and. set%dim() == 3, "a level that phi does not take")
    listener = counter(until=0.0_c_double)
    call field%level_set(0.0_c_double, set, listener=listener, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_CANCELLED, "cancelled")
  end subroutine

  subroutine fields_are_certified()
    type(keepout_mesh) :: mesh, open, curves
    type(keepout_cloud) :: cloud
    type(keepout_field) :: field
    type(counter) :: listener
    type(ko_certify_options) :: options
    type(ko_certificate) :: found
    real(c_double), allocatable :: points(:, :)
    real(c_double) :: values(1)
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    call cube(mesh)
    call mesh%sample(500, 1, cloud)
    call field%fit(cloud, small_fit(8))
    options = keepout_certify_options()
    options%n_threads = 1
    call field%certify(mesh, 0.1_c_double, 0.05_c_double, found, options, listener, stat)
    call holds(stat == KO_OK .and. found%side_certified == 1 .and. listener%last >= 1, "field%certify")
    call holds(found%threshold > 0.05_c_double .and. found%threshold > found%largest_found, "threshold")
    call field%eval(reshape(found%place, [3, 1]), values)
    call near(values(1), found%largest_found, 0.0_c_double, "the largest phi is where the certificate says")
    options%max_boxes = 1
    options%tolerance = 1e-4_c_double
    call field%certify(mesh, 0.1_c_double, 0.05_c_double, found, options, stat=stat)
    call holds(stat == KO_BUDGET_REACHED .and. found%budget_reached == 1, "KO_BUDGET_REACHED")
    call open%from_triangles(cube_vertices, cube_triangles(:, :11))
    call field%certify(open, 0.1_c_double, 0.0_c_double, found, stat=stat)
    call holds(stat == KO_SIDE_NOT_CERTIFIED .and. found%side_certified == 0, "KO_SIDE_NOT_CERTIFIED")
    call field%certify(mesh, -1.0_c_double, 0.0_c_double, found, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "clearance")
    listener = counter(until=0.0_c_double)
    call field%certify(mesh, 0.1_c_double, 0.0_c_double, found, listener=listener, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_CANCELLED, "cancelled")
    call frame(curves)
    call curves%copy_component_points(points)
    call holds(all(shape(points) == [2, 2]), "shape of component points")
    call near(maxval(abs(points - frame_points(:, 1:5:4))), 0.0_c_double, 0.0_c_double, "mesh%copy_component_points")
  end subroutine

  subroutine values_have_derivatives_by_the_cloud()
    type(keepout_mesh) :: mesh
    type(keepout_cloud) :: cloud, same
    type(keepout_field) :: field
    type(keepout_sensitivity) :: sensitivity
    type(ko_fit_options) :: options
    real(c_double) :: point(3, 1), by_points(3, 500), by_normals(3, 500), twice(3, 500), by_vertices(3, 8)
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    point(:, 1) = [1.1_c_double, 0.5_c_double, 0.6_c_double]
    call cube(mesh)
    call mesh%sample(500, 1, cloud)
    call cloud%follow(mesh, same)
    call holds(same%n_points() == 500, "cloud%follow")
    options = small_fit(5)
    call field%fit(cloud, options)
    call sensitivity%create(field, cloud, options)
    call sensitivity%solve(point, d_points=by_points, d_normals=by_normals)
    call sensitivity%solve(point, [2.0_c_double], twice, options=options)
    call near(maxval(abs(twice - 2 * by_points)), 0.0_c_double, 0.0_c_double, "sensitivity%solve")
    call cloud%pull_back(mesh, by_vertices, by_points, by_normals)
    call near(sum(by_vertices(1, :)), sum(by_points(1, :)), 1e-9_c_double, "cloud%pull_back")
    call sensitivity%solve(point, [1.0_c_double, 2.0_c_double], twice, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "weights")
    call cloud%pull_back(mesh, by_vertices, by_points(:, 2:), stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "d_points")
    call sensitivity%free()
    call sensitivity%solve(point, d_points=twice, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "sensitivity is NULL")
  end subroutine

  subroutine formulas_are_evaluated()
    type(keepout_mesh) :: mesh
    type(keepout_cloud) :: cloud
    type(keepout_explicit) :: formula
    type(ko_explicit_options) :: options
    real(c_double) :: points(3, 2), values(2), gradients(3, 2), smoothing
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    points = reshape([0.1_c_double, 0.2_c_double, 1.1_c_double, 0.9_c_double, 0.0_c_double, -0.1_c_double], [3, 2])
    call cube(mesh)
    call mesh%sample(2000, 1, cloud)
    call formula%create(cloud)
    call formula%smoothing(smoothing)
    call holds(formula%dim() == 3 .and. smoothing > 0, "explicit%smoothing")
    call formula%eval(points, values)
    call near(values(1), 0.1_c_double, 1e-2_c_double, "explicit%eval")
    options = keepout_explicit_options()
    options%formulation = KO_EXPLICIT_NEAREST_PLANE
    call formula%create(cloud, options)
    call formula%eval(points, values, gradients)
    call near(maxval(abs(values - [0.1_c_double, -0.1_c_double])), 0.0_c_double, 1e-14_c_double, "distances to planes")
    call near(gradients(3, 1), 1.0_c_double, 1e-14_c_double, "the normal of a plane")
    call formula%eval(points, values(:1), stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "values")
    options%n_nearest = 2
    call formula%create(cloud, options, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "n_nearest")
    call holds(c_associated(formula%c_handle()), "what failed frees nothing")
    call formula%free()
    call formula%eval(points, values, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "NULL")
  end subroutine

  subroutine meshes_are_separated()
    type(keepout_mesh) :: a, b, plane
    type(ko_separation) :: found
    real(c_double), parameter :: apart(3) = [5.0_c_double, 0.5_c_double, 6.0_c_double]
    real(c_double) :: by_distance(3, 8), by_length(3, 8)
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    call cube(a)
    call cube(b)
    call keepout_separation(a, b, found, apart, distance_gradients=by_distance, length_gradients=by_length)
    call near(found%minimum_distance, 5.0_c_double, 1e-14_c_double, "keepout_separation")
    call near(maxval(abs(sum(by_distance, 2) - found%distance_by_translation)), 0.0_c_double, 1e-15_c_double, "by vertices")
    call near(maxval(abs(by_length)), 0.0_c_double, 0.0_c_double, "meshes apart have no intersection")
    call keepout_separation(a, b, found, apart, 1000.0_c_double)
    call holds(found%minimum_distance <= 5, "KS from below")
    call keepout_separation(a, b, found, [1.5_c_double, 1.25_c_double, 0.5_c_double])
    call near(found%intersection_length, 5.5_c_double, 1e-12_c_double, "intersection_length")
    call keepout_separation(a, b, found, distance_gradients=by_distance(:, :7), stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "distance_gradients")
    call frame(plane)
    call keepout_separation(a, plane, found, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_UNSUPPORTED, "mesh_b")
  end subroutine

  ! Weights leave points out, and a robust fit finds them by itself.
  subroutine clouds_are_not_trusted_alike()
    type(keepout_mesh) :: mesh
    type(keepout_cloud) :: cloud
    type(keepout_field) :: field
    type(ko_fit_options) :: options
    type(ko_fit_report) :: report
    real(c_double), allocatable :: points(:, :), normals(:, :)
    real(c_double) :: weights(400)
    call cube(mesh)
    call mesh%sample(400, 1, cloud)
    call cloud%copy(points, normals)
    points(:, :5) = points(:, :5) / 2
    call cloud%from_points(points, normals)
    options = small_fit(8)
    options%reweighting = KO_REWEIGHT_ROBUST
    call field%fit(cloud, options)
    call field%report(report)
    call holds(report%n_outliers >= 5, "a robust fit leaves out what is off")
    weights = 1
    weights(:5) = 0
    call cloud%set_weights(weights)
    call field%fit(cloud, small_fit(8))
    call field%report(report)
    call holds(report%n_points == 395, "points of weight 0 take no part")
  end subroutine

  subroutine numbers_are_aggregated()
    type(ko_aggregation) :: aggregation
    real(c_double), parameter :: numbers(3) = [0.5_c_double, 0.1_c_double, 0.3_c_double]
    real(c_double) :: value, gradient(3), hessian(6), below, above
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    aggregation = keepout_aggregation()
    call holds(aggregation%kind == KO_AGGREGATE_KS .and. aggregation%side == KO_BELOW, "keepout_aggregation")
    aggregation%sharpness = 20
    call keepout_aggregate(aggregation, KO_LEAST, 1.0_c_double, numbers, value, gradient, hessian)
    call keepout_aggregation_bounds(aggregation, 3, 0.0_c_double, below, above)
    call near(below, log(3.0_c_double) / 20, 1e-15_c_double, "keepout_aggregation_bounds")
    call holds(value <= 0.1_c_double .and. value >= 0.1_c_double - below .and. abs(above) <= 0, "keepout_aggregate")
    call near(sum(gradient), 1.0_c_double, 1e-14_c_double, "gradient of an aggregate")
    call near(hessian(2) + hessian(3) + hessian(5), 0.0_c_double, 1e-13_c_double, "hessian of an aggregate")
    aggregation%kind = KO_AGGREGATE_MINIMUM
    call keepout_aggregate(aggregation, KO_LARGEST, 1.0_c_double, numbers, value)
    call near(value, numbers(1), 0.0_c_double, "the largest value")
    call keepout_aggregate(aggregation, KO_LEAST, 1.0_c_double, numbers, value, hessian=hessian, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_UNSUPPORTED, "not smooth")
    call keepout_aggregate(aggregation, KO_LEAST, 1.0_c_double, numbers(:0), value, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "no values")
    call keepout_aggregate(aggregation, KO_LEAST, 1.0_c_double, numbers, value, gradient(:2), stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "gradient has 2 entries; 3 are needed")
    call keepout_aggregate(aggregation, KO_LEAST, 1.0_c_double, numbers, value, hessian=gradient, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "hessian has 3 entries; 6 are needed")
    call keepout_aggregation_bounds(aggregation, -1, 0.0_c_double, below, above, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "n_values is 0")
  end subroutine

  subroutine bodies_are_points()
    type(keepout_mesh) :: mesh
    type(keepout_body) :: body
    real(c_double), allocatable :: points(:, :)
    real(c_double) :: radius
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    call body%from_points(frame_points, 0.5_c_double)
    call body%covering_radius(radius)
    call body%copy_points(points)
    call holds(body%dim() == 2 .and. body%n_points() == 8 .and. abs(radius - 0.5) <= 0, "body%from_points")
    call holds(all(abs(points - frame_points) <= 0), "body%copy_points")
    call cube(mesh)
    call body%from_mesh(mesh, 10.0_c_double)
    call mesh%free()
    call holds(body%dim() == 3 .and. body%n_points() == 8, "body%from_mesh")
    call body%from_mesh(mesh, 1.0_c_double, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "mesh is NULL")
    call body%from_points(cube_vertices, -1.0_c_double, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "covering_radius is -1")
    call holds(body%n_points() == 8, "a body that fails leaves what was there")
    call body%free()
    call holds(body%dim() == 0 .and. .not. c_associated(body%c_handle()), "body%free")
    call body%copy_points(points, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "body is NULL")
    call body%covering_radius(radius, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "body is NULL")
  end subroutine

  ! The corners of a cube in a frame, and four points, in a field that is gone when they are evaluated.
  subroutine make_constraints(set)
    type(keepout_constraints), intent(inout) :: set
    type(keepout_field) :: field
    type(keepout_body) :: body
    type(ko_aggregation) :: each
    real(c_double) :: control_points(512)
    integer(c_int32_t) :: frame, still, path
    integer(c_size_t) :: first
    integer :: i, j, k
    ! About a ball of radius 0.6, and not quite round.
    control_points = [(((norm2(real([i, j, k], c_double) - 3.5_c_double) / 2.5_c_double - 0.6_c_double &
      + 0.05_c_double * sin(real(64 * i + 8 * j + k, c_double)), k=0, 7), j=0, 7), i=0, 7)]
    call field%from_control_points([8, 8, 8], spread(-1.0_c_double, 1, 3), spread(1.0_c_double, 1, 3), KO_FEASIBLE_OUTSIDE, &
      2.5_c_double, control_points)
    call body%from_points(0.3_c_double * cube_vertices, 0.0_c_double)
    call set%create(3)
    call set%add_frame(KO_ROTATION_QUATERNION, KO_SCALE_ONE, frame)
    call set%add_points(4, path)
    call set%add_fixed_frame(KO_ROTATION_NONE, KO_SCALE_FREE, [0.1_c_double, 0.2_c_double, 0.3_c_double, 1.5_c_double], still)
    call holds(frame == 1 .and. still == 2 .and. path == 0, "numbers of frames and points")
    each = keepout_aggregation()
    each%kind = KO_AGGREGATE_NONE
    call set%keep_body(body, frame, field, KO_WORLD, first_value=first)
    call equal(first, 0_c_size_t, "constraints%keep_body")
    call set%keep_points(path, field, still, each, first)
    call equal(first, 1_c_size_t, "constraints%keep_points")
    call set%keep_body(body, KO_WORLD, field, frame, each, first)
    call equal(first, 5_c_size_t, "a field that moves")
    call set%keep_points(path, field, KO_WORLD)
  end subroutine

  ! About the distance from a circle, positive inside.
  subroutine make_tank(field, center)
    type(keepout_field), intent(inout) :: field
    real(c_double), intent(in) :: center(2)
    real(c_double) :: control_points(64)
    integer :: i, j
    control_points = [((0.6_c_double - norm2((real([i, j], c_double) - 3.5_c_double) / 2.5_c_double - center), j=0, 7), i=0, 7)]
    call field%from_control_points([8, 8], spread(-1.0_c_double, 1, 2), spread(1.0_c_double, 1, 2), KO_FEASIBLE_OUTSIDE, &
      2.5_c_double, control_points)
  end subroutine

  ! A body and a path in the union of two tanks, and in their intersection.
  subroutine fields_are_combined()
    type(keepout_constraints) :: set
    type(keepout_field) :: tanks(2)
    type(keepout_body) :: body
    type(ko_aggregation) :: hard, each
    real(c_double) :: points(2, 3), phi(3, 2), values(8)
    integer(c_int32_t) :: path, stat
    integer(c_size_t) :: first
    character(len=200) :: errmsg
    points = reshape([-0.8_c_double, 0.0_c_double, 0.0_c_double, 0.1_c_double, 0.8_c_double, -0.1_c_double], [2, 3])
    call make_tank(tanks(1), [-0.5_c_double, 0.0_c_double])
    call make_tank(tanks(2), [0.5_c_double, 0.0_c_double])
    call tanks(1)%eval(points, phi(:, 1))
    call tanks(2)%eval(points, phi(:, 2))
    hard = keepout_aggregation()
    hard%kind = KO_AGGREGATE_MINIMUM
    each = keepout_aggregation()
    each%kind = KO_AGGREGATE_NONE
    call set%create(2)
    call set%add_points(3, path)
    call body%from_points(points, 0.0_c_double)
    call set%keep_points_in_fields(path, tanks, KO_LARGEST, KO_WORLD, hard, each, first)
    call equal(first, 0_c_size_t, "constraints%keep_points_in_fields")
    call set%keep_body_in_fields(body, KO_WORLD, tanks, KO_LEAST, KO_WORLD, hard, each, first)
    call equal(first, 3_c_size_t, "constraints%keep_body_in_fields")
    call set%keep_body_in_fields(body, KO_WORLD, tanks, KO_LARGEST, KO_WORLD)
    call set%keep_points_in_fields(path, tanks, KO_LEAST, KO_WORLD)
    call set%values(reshape(points, [6]), values)
    call near(maxval(abs(values(1:3) - maxval(phi, 2))), 0.0_c_double, 1e-14_c_double, "a union")
    call near(maxval(abs(values(4:6) - minval(phi, 2))), 0.0_c_double, 1e-14_c_double, "an intersection")
    call holds(values(7) > 0 .and. values(7) <= minval(values(1:3)), "a body in a union, by KS")
    call holds(values(8) < 0 .and. values(8) <= minval(phi), "a path in an intersection, by KS")
    call set%keep_points_in_fields(path, tanks(:0), KO_LEAST, KO_WORLD, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "0 fields are given")
    call tanks(2)%free()
    call set%keep_body_in_fields(body, KO_WORLD, tanks, KO_LEAST, KO_WORLD, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "field 1 of fields is NULL")
  end subroutine

  subroutine constraints_are_differentiated()
    integer, parameter :: n = 19, m = 14
    real(c_double), parameter :: step = 1e-6_c_double
    type(keepout_constraints) :: set
    integer(c_int32_t), allocatable :: rows(:), columns(:)
    real(c_double), allocatable :: entries(:), again(:)
    real(c_double) :: x(n), v(n), w(m), values(m), others(m), dense(n, m), scattered(n, m), jv(m), jtw(n), low(n), high(n), hv(n)
    integer(c_size_t) :: n_variables, n_values, n_jacobian, n_hessian, first
    integer :: i
    call make_constraints(set)
    call set%get_size(n_variables, n_values, n_jacobian, n_hessian)
    call holds(n_variables == n .and. n_values == m .and. n_jacobian == 7 + 12 + 8 * 7 + 12, "constraints%get_size")
    call set%frame_variables(1, first, n_variables)
    call holds(first == 0 .and. n_variables == 7, "constraints%frame_variables")
    call set%points_variables(0, first, n_variables)
    call holds(first == 7 .and. n_variables == 12, "constraints%points_variables")
    x = [(cos(3.0_c_double * i) / 2, i=1, n)]
    v = [(sin(5.0_c_double * i), i=1, n)]
    w = [(sin(7.0_c_double * i), i=1, m)]
    allocate (entries(n_jacobian), again(n_jacobian))
    call set%values(x, values)
    call set%jacobian_pattern(rows, columns)
    call set%jacobian(x, entries)
    call set%values_and_jacobian(x, others, again)
    call near(maxval(abs(others - values)), 0.0_c_double, 1e-13_c_double, "values of constraints%values_and_jacobian")
    call holds(all(abs(entries - again) <= 0), "entries of constraints%values_and_jacobian")
    call set%dense_jacobian(x, dense)
    scattered = 0
    do i = 1, size(rows)
      scattered(columns(i) + 1, rows(i) + 1) = entries(i)
    end do
    call holds(all(abs(dense - scattered) <= 0), "constraints%dense_jacobian")
    call set%jacobian_times(x, v, jv)
    call near(maxval(abs(jv - matmul(v, dense))), 0.0_c_double, 1e-12_c_double, "constraints%jacobian_times")
    call set%transposed_jacobian_times(x, w, jtw)
    call near(maxval(abs(jtw - matmul(dense, w))), 0.0_c_double, 1e-12_c_double, "constraints%transposed_jacobian_times")
    call set%values(x + step * v, values)
    call set%values(x - step * v, others)
    call near(maxval(abs((values - others) / (2 * step) - jv)), 0.0_c_double, 1e-7_c_double, "a difference of values")

    call set%hessian_pattern(rows, columns)
    deallocate (entries)
    allocate (entries(n_hessian))
    call set%hessian(x, w, entries)
    hv = 0
    do i = 1, size(rows)
      hv(rows(i) + 1) = hv(rows(i) + 1) + entries(i) * v(columns(i) + 1)
      if (rows(i) /= columns(i)) hv(columns(i) + 1) = hv(columns(i) + 1) + entries(i) * v(rows(i) + 1)
    end do
    call set%transposed_jacobian_times(x + step * v, w, high)
    call set%transposed_jacobian_times(x - step * v, w, low)
    call near(maxval(abs((high - low) / (2 * step) - hv)) / maxval(abs(hv)), 0.0_c_double, 1e-4_c_double, "constraints%hessian")
  end subroutine

  subroutine constraints_are_checked()
    type(keepout_constraints) :: set
    type(keepout_field) :: none
    type(keepout_body) :: nothing
    integer(c_int32_t), allocatable :: rows(:), columns(:)
    real(c_double) :: x(19), dense(19, 14)
    integer(c_size_t) :: n, other
    integer(c_int32_t) :: number, stat
    character(len=200) :: errmsg
    call make_constraints(set)
    x = 0.5_c_double
    call set%values(x, dense(:, 1), stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "values has 19 entries; there are 14 values")
    call set%jacobian(x, dense(:3, 1), stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "has 3 entries")
    call set%values_and_jacobian(x, dense(:14, 1), dense(:3, 2), stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "entries has 3 entries")
    call set%dense_jacobian(x, dense(:18, :), stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "jacobian has 18 rows; 19 are needed")
    call set%dense_jacobian(x, dense(:, :13), stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "jacobian has 247 entries")
    call set%jacobian_times(x, x(:3), dense(:, 1), stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "v has 3 entries; 19 are needed")
    call set%transposed_jacobian_times(x, x, dense(:3, 1), stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "product has 3 entries; 19 are needed")
    call set%hessian(x, x, dense(:, 1), stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "lambda has 19 entries")
    x(4:7) = 0
    call set%values(x, dense(1, :), stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "quaternion of length 0")
    call set%frame_variables(3, n, other, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "no frame 3")
    call set%points_variables(1, n, other, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "no set of points 1")
    call set%keep_body(nothing, 1, none, KO_WORLD, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "body is NULL")
    call set%keep_points(0, none, KO_WORLD, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "field is NULL")
    call set%create(4, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "dim is 4")
    call holds(c_associated(set%c_handle()), "a set that fails leaves what was there")
    call set%create(2)
    call set%add_frame(KO_ROTATION_VECTOR, KO_SCALE_ONE, number, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "not by a rotation vector")
    call set%add_fixed_frame(KO_ROTATION_ANGLE, KO_SCALE_ONE, x(:2), number, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "has 2 parameters; such a frame has 3")
    call set%add_points(-1, number, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "0 points")
    call set%free()
    call set%get_size(n, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "constraints is NULL")
    call set%jacobian_pattern(rows, columns, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "constraints is NULL")
    call set%hessian_pattern(rows, columns, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "constraints is NULL")
  end subroutine

  subroutine progress_is_heard()
    type(keepout_mesh) :: mesh
    type(keepout_cloud) :: cloud
    type(keepout_field) :: field
    type(counter) :: listener
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    call cube(mesh)
    call mesh%sample(300, 1, cloud)
    call field%fit(cloud, small_fit(8), listener)
    call holds(listener%calls > 3 .and. listener%ascends .and. listener%last >= 1, "progress")
    listener = counter(until=0.5_c_double)
    call field%fit(cloud, small_fit(8), listener, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_CANCELLED, "cancelled")
    call holds(field%dim() == 3, "a fit that is cancelled leaves the field as it was")
  end subroutine

  subroutine errors_are_told()
    type(keepout_mesh) :: mesh
    type(keepout_cloud) :: cloud
    type(keepout_field) :: field
    type(ko_fit_options) :: options
    real(c_double) :: points(3, 2), values(2), gradients(3, 2)
    integer(c_int8_t) :: outside(1)
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    call mesh%read("no-such-file.obj", stat, errmsg)
    call fails(stat, errmsg, KO_ERR_IO, "no-such-file.obj")
    call holds(keepout_last_error() == errmsg .and. mesh%dim() == 0, "the last error stays")
    call field%load("no-such-file.kof", stat, errmsg)
    call fails(stat, errmsg, KO_ERR_IO, "no-such-file.kof")
    ! C would end these paths at their zero byte.
    call mesh%read("a" // c_null_char // "b.obj", stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "zero byte")
    call field%load("a.kof" // c_null_char, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "zero byte")
    call mesh%write("a.obj" // c_null_char // "b.obj", stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "zero byte")
    call field%save("a.kof" // c_null_char // "b.kof", stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "zero byte")
    call field%save("nothing.kof", stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "field is NULL")
    call field%eval(points, values, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "field is NULL")
    call mesh%flip(stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "mesh is NULL")
    call mesh%from_triangles(cube_vertices(:2, :), cube_triangles, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "vertices has 2 rows; 3 are needed")
    call mesh%from_triangles(cube_vertices(:, :7), cube_triangles, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "triangle 2")
    call mesh%from_polylines(frame_points, [4, 0], stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "start")
    call mesh%from_polylines(frame_points, [0], kind=3, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "closed is 3")

    call cube(mesh)
    call mesh%sample(-1, 1, cloud, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "0 sample points")
    call mesh%sample(300, 1, cloud)
    call cloud%set_weights(values, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "2 weights")
    options = small_fit(8)
    options%margin = -1
    call field%fit(cloud, options, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "margin")
    call field%fit(cloud, small_fit(8), stat=stat)
    call holds(stat == KO_OK, "stat of a fit")

    points = 0
    call field%eval(points(:2, :), values, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "points has 2 rows; 3 are needed")
    call field%eval(points, values(:1), stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "values has 1 entries; 2 are needed")
    call field%eval(points, values, gradients(:, :1), stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "gradients has the shape (3, 1); (3, 2) is needed")
    call field%eval(points, hessians=gradients, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "hessians has the shape (3, 2); (6, 2) is needed")
    call field%outside_box(points, outside, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "outside has 1 entries; 2 are needed")
    points(2, 2) = huge(points)
    call field%eval(points, values, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "point 1 ")
    call cloud%from_points(points, points(:, :1), stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "normals has the shape (3, 1)")
  end subroutine

  subroutine handles_have_one_owner()
    type(keepout_mesh), allocatable :: mesh, other
    type(keepout_mesh) :: meshes(2)
    type(c_ptr) :: handle
    allocate (mesh)
    call cube(mesh)
    handle = mesh%c_handle()
    call move_alloc(mesh, other)
    call holds(c_associated(other%c_handle(), handle) .and. other%n_vertices() == 8, "move_alloc")
    deallocate (other)
    ! Filled twice: the first cube is freed.
    call cube(meshes(1))
    call cube(meshes(1))
    call cube(meshes(2))
    call meshes(2)%free()
    call meshes(2)%free()
    call holds(meshes(2)%dim() == 0, "free")
  end subroutine
end program
