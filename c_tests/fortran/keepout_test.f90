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
  implicit none

  call layouts_agree()
  call versions_are_told()
  call meshes_and_clouds()
  call planes()
  call fields()
  call derivatives_are_those_of_the_values()
  call clouds_are_not_trusted_alike()
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
