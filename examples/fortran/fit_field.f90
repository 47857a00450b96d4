! SPDX-License-Identifier: Apache-2.0 OR MIT
! Keepout's main job in Fortran: a torus, points on it, a field fitted to them, its values and derivatives.
!
!   fit_field_fortran [POINTS]     points to sample; 20000 otherwise
program fit_field
  use keepout
  use progress
  use torus
  implicit none

  integer, parameter :: N = 8
  type(keepout_mesh) :: mesh
  type(keepout_cloud) :: cloud
  type(keepout_field) :: field
  type(shown_progress) :: shown
  real(c_double) :: points(3, N), values(N), gradients(3, N), hessians(6, N), differences(3, N)
  integer :: i

  call make_torus(mesh)
  call mesh%sample(wanted_points(), 1, cloud)
  ! Any call without `stat` ends the program when it fails, with the library's message.
  call field%fit(cloud, listener=shown)
  call print_report()

  do i = 1, N
    points(:, i) = [0.4_c_double + 0.2_c_double * i, 0.1_c_double, 0.05_c_double]
  end do
  call field%eval(points, values, gradients, hessians)
  differences = differences_of_values()

  print "(/, a)", "               point          phi     distance                   grad phi      trace of Hessian"
  do i = 1, N
    print "(3f8.3, f11.5, f13.5, 3x, 3f9.4, f14.4)", points(:, i), values(i), torus_distance(points(:, i)), gradients(:, i), &
      hessians(1, i) + hessians(4, i) + hessians(6, i)
  end do
  print "(/, a, es9.2)", "gradients differ from central differences by at most", maxval(abs(differences - gradients))
  if (maxval(abs(differences - gradients)) > 1e-6_c_double) error stop "the gradient is not that of the values"

contains

  integer function wanted_points()
    character(len=32) :: argument
    integer :: iostat
    wanted_points = 20000
    if (command_argument_count() == 0) return
    call get_command_argument(1, argument)
    read (argument, *, iostat=iostat) wanted_points
    if (iostat /= 0 .or. wanted_points < 1) error stop "usage: fit_field_fortran [POINTS]"
  end function

  subroutine print_report()
    type(ko_fit_report) :: report
    call field%report(report)
    print "(2a)", "Keepout ", keepout_version()
    print "(a, i0)", "  points                ", report%n_points
    print "(a, i0, 3(a, i0), a)", "  control points        ", report%n_unknowns, " (", report%control_points(1), " x ", &
      report%control_points(2), " x ", report%control_points(3), ")"
    print "(a, f0.2, a, i0, a)", "  solve                 ", report%seconds_solve, " s, ", report%iterations, " iterations"
    print "(2(a, es8.1), a, f6.3)", "  |phi| at the points  ", report%rms, " D rms,", report%max, " D at most; D =", &
      report%diagonal
  end subroutine

  ! Central differences of the field's values at `points`, one column a point.
  function differences_of_values() result(differences)
    real(c_double), parameter :: STEP = 1e-5_c_double
    real(c_double) :: differences(3, N), moved(3, N), ahead(N), behind(N)
    integer :: axis
    do axis = 1, 3
      moved = points
      moved(axis, :) = points(axis, :) + STEP
      call field%eval(moved, ahead)
      moved(axis, :) = points(axis, :) - STEP
      call field%eval(moved, behind)
      differences(axis, :) = (ahead - behind) / (2 * STEP)
    end do
  end function
end program
