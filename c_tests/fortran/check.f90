! What the tests in Fortran share: checks that count, and shapes.

module check
  use keepout
  use, intrinsic :: iso_fortran_env, only: error_unit
  implicit none

  private
  public :: holds, near, equal, fails, finish, cube, frame, small_fit, cube_vertices, cube_triangles, frame_points

  integer :: failures = 0

  ! The cube [-1, 1]^3.
  real(c_double), parameter :: cube_vertices(3, 8) = reshape(real([-1, -1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1, &
    -1, -1, 1, 1, -1, 1, -1, 1, 1, 1, 1, 1], c_double), [3, 8])
  integer(c_int32_t), parameter :: cube_triangles(3, 12) = reshape([0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4, &
    2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6], [3, 12])

  ! The square [-1, 1]^2 around the square hole [-0.5, 0.5]^2.
  real(c_double), parameter :: frame_points(2, 8) = reshape(0.5_c_double * [-2, -2, 2, -2, 2, 2, -2, 2, -1, -1, -1, 1, 1, 1, &
    1, -1], [2, 8])

contains

  subroutine holds(condition, what)
    logical, intent(in) :: condition
    character(len=*), intent(in) :: what
    if (condition) return
    failures = failures + 1
    write (error_unit, "(2a)") "not so: ", what
  end subroutine

  subroutine near(a, b, tolerance, what)
    real(c_double), intent(in) :: a, b, tolerance
    character(len=*), intent(in) :: what
    ! False for NaN.
    if (abs(a - b) <= tolerance) return
    failures = failures + 1
    write (error_unit, "(2a, 2es24.16)") "not equal: ", what, a, b
  end subroutine

  subroutine equal(a, b, what)
    integer(c_size_t), intent(in) :: a, b
    character(len=*), intent(in) :: what
    if (a == b) return
    failures = failures + 1
    write (error_unit, "(2a, 2i12)") "not equal: ", what, a, b
  end subroutine

  ! A call ended with the status `right` and a message that contains `words`.
  subroutine fails(stat, errmsg, right, words)
    integer(c_int32_t), intent(in) :: stat, right
    character(len=*), intent(in) :: errmsg, words
    if (stat == right .and. index(errmsg, words) > 0) return
    failures = failures + 1
    write (error_unit, "(9a)") keepout_status_string(stat), " """, trim(errmsg), """; right is ", keepout_status_string(right), &
      " with """, words, """"
  end subroutine

  subroutine finish()
    if (failures == 0) return
    write (error_unit, "(i0, a)") failures, " checks failed"
    error stop 1
  end subroutine

  subroutine cube(mesh)
    type(keepout_mesh), intent(inout) :: mesh
    call mesh%from_triangles(cube_vertices, cube_triangles)
  end subroutine

  subroutine frame(mesh)
    type(keepout_mesh), intent(inout) :: mesh
    call mesh%from_polylines(frame_points, [0, 4])
  end subroutine

  ! Options of a small fit on this thread alone: `n` control points along each axis.
  function small_fit(n) result(options)
    integer, intent(in) :: n
    type(ko_fit_options) :: options
    options = keepout_fit_options()
    options%control_points = n
    options%n_threads = 1
  end function
end module
