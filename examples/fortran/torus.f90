! SPDX-License-Identifier: Apache-2.0 OR MIT
! A torus around the z axis: its mesh, and the distance to it, which the field should be close to.
module torus
  use keepout
  implicit none

  private
  public :: make_torus, torus_distance, RING, TUBE

  real(c_double), parameter :: TURN = 8 * atan(1.0_c_double)
  ! Of the circle along the tube, and of the tube.
  real(c_double), parameter :: RING = 1.0_c_double, TUBE = 0.35_c_double
  integer, parameter :: ALONG = 180, AROUND = 64

contains

  subroutine make_torus(mesh)
    type(keepout_mesh), intent(inout) :: mesh
    real(c_double), allocatable :: vertices(:, :)
    integer(c_int32_t), allocatable :: triangles(:, :)
    real(c_double) :: angle, tilt
    integer :: i, j, k, next_i, next_j
    allocate (vertices(3, ALONG * AROUND), triangles(3, 2 * ALONG * AROUND))
    k = 0
    do i = 0, ALONG - 1
      next_i = modulo(i + 1, ALONG)
      do j = 0, AROUND - 1
        next_j = modulo(j + 1, AROUND)
        angle = TURN * i / ALONG
        tilt = TURN * j / AROUND
        k = k + 1
        vertices(:, k) = [(RING + TUBE * cos(tilt)) * cos(angle), (RING + TUBE * cos(tilt)) * sin(angle), TUBE * sin(tilt)]
        ! Counter-clockwise seen from outside; indices count from 0.
        triangles(:, 2 * k - 1) = [i * AROUND + j, next_i * AROUND + j, next_i * AROUND + next_j]
        triangles(:, 2 * k) = [i * AROUND + j, next_i * AROUND + next_j, i * AROUND + next_j]
      end do
    end do
    call mesh%from_triangles(vertices, triangles)
  end subroutine

  pure real(c_double) function torus_distance(point)
    real(c_double), intent(in) :: point(3)
    torus_distance = hypot(hypot(point(1), point(2)) - RING, point(3)) - TUBE
  end function
end module
