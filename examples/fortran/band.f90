! SPDX-License-Identifier: Apache-2.0 OR MIT
! A rubber band around the tube of a torus, through its hole: a chain of points that pulls itself together, kept outside by the field. Solved
! by an augmented Lagrangian and Newton's method with the field's Hessians, both written here. The answer is known: a regular polygon.
program band
  use keepout
  use torus
  implicit none

  integer, parameter :: N = 24, NX = 3 * N
  real(c_double), parameter :: TURN = 8 * atan(1.0_c_double)
  real(c_double), parameter :: PENALTY = 30
  type(keepout_mesh) :: mesh
  type(keepout_cloud) :: cloud
  type(keepout_field) :: field
  ! Of each point: its multiplier; phi, its gradient and its Hessian xx xy xz yy yz zz.
  real(c_double) :: points(3, N), multipliers(N), values(N), gradients(3, N), hessians(6, N)
  real(c_double) :: residual, distances(N), energy, known
  integer :: outer, newton_steps

  call make_torus(mesh)
  call mesh%sample(20000, 1, cloud)
  call field%fit(cloud)

  call start()
  multipliers = 0
  print "(a)", "outer  Newton steps        energy   KKT residual      least phi"
  do outer = 1, 50
    call minimise(newton_steps)
    ! First-order update; a point that is clear of the torus has no multiplier.
    multipliers = max(0.0_c_double, multipliers - PENALTY * values)
    residual = kkt_residual()
    print "(i5, i14, f14.8, 2es15.2)", outer, newton_steps, energy_of(points), residual, minval(values)
    if (residual < 1e-9_c_double) exit
  end do

  energy = energy_of(points)
  known = 4 * N * (TUBE * sin(TURN / (2 * N)))**2
  call mesh%signed_distance(points, distances)
  print "(/, 2(a, f11.8))", "energy ", energy, ", of a regular polygon around the tube ", known
  print "(a, es9.2)", "exact distance of its corners to the torus at most", maxval(abs(distances))
  if (residual > 1e-9_c_double) error stop "no optimum"
  if (abs(energy - known) > 5e-3_c_double * known) error stop "not the known answer"
  if (maxval(abs(distances)) > 2e-3_c_double) error stop "corners off the torus"
  print "(a)", "The known answer."

contains

  ! A slack, dented loop around the tube where it crosses y = 0.
  subroutine start()
    integer :: i
    real(c_double) :: angle, wide
    do i = 1, N
      angle = TURN * i / N
      wide = 1.4_c_double * TUBE + 0.1_c_double * cos(3 * angle)
      points(:, i) = [RING + wide * cos(angle), 0.15_c_double * sin(2 * angle), wide * sin(angle)]
    end do
  end subroutine

  ! The squared lengths of the links, summed: least where links are equal, and short.
  pure real(c_double) function energy_of(x)
    real(c_double), intent(in) :: x(3, N)
    energy_of = sum((cshift(x, 1, 2) - x)**2)
  end function

  ! Energy and the augmented Lagrangian's terms max(0, multiplier - PENALTY phi)^2 / (2 PENALTY).
  real(c_double) function lagrangian(x)
    real(c_double), intent(in) :: x(3, N)
    real(c_double) :: phi(N)
    integer :: stat
    ! A point that the library refuses is no better than any other: the line search goes back from it.
    lagrangian = huge(lagrangian)
    call field%eval(x, phi, stat=stat)
    if (stat < 0) return
    lagrangian = energy_of(x) + sum(max(0.0_c_double, multipliers - PENALTY * phi)**2) / (2 * PENALTY)
  end function

  ! d energy / d points
  function pull() result(gradient)
    real(c_double) :: gradient(3, N)
    gradient = 2 * (2 * points - cshift(points, 1, 2) - cshift(points, -1, 2))
  end function

  ! The gradient of the Lagrangian, constraints that are missed, and multipliers where there is room.
  real(c_double) function kkt_residual()
    real(c_double) :: gradient(3, N)
    gradient = pull() - spread(multipliers, 1, 3) * gradients
    kkt_residual = max(maxval(abs(gradient)), maxval(-values), maxval(abs(multipliers * values)))
  end function

  ! Newton's method from `points`, for the multipliers as they are.
  subroutine minimise(steps)
    integer, intent(out) :: steps
    real(c_double) :: gradient(3, N), force(N), matrix(NX, NX), step(3, N), slope, now, length
    do steps = 0, 100
      call field%eval(points, values, gradients, hessians)
      force = max(0.0_c_double, multipliers - PENALTY * values)
      gradient = pull() - spread(force, 1, 3) * gradients
      if (maxval(abs(gradient)) < 1e-10_c_double) return
      call assemble(force, matrix)
      call solve(matrix, reshape(-gradient, [NX]), step)
      slope = sum(gradient * step)
      now = lagrangian(points)
      length = 1
      do while (lagrangian(points + length * step) > now + 1e-4_c_double * length * slope + 1e-14_c_double)
        length = length / 2
        if (length < 1e-10_c_double) return
      end do
      points = points + length * step
    end do
  end subroutine

  ! The Hessian of the augmented Lagrangian: that of the energy, and a block a point,
  ! -force hess phi, and PENALTY grad phi grad phi^T where the constraint acts.
  subroutine assemble(force, matrix)
    real(c_double), intent(in) :: force(N)
    real(c_double), intent(out) :: matrix(NX, NX)
    integer, parameter :: PACKED(3, 3) = reshape([1, 2, 3, 2, 4, 5, 3, 5, 6], [3, 3])
    integer :: i, k, l, at, next
    matrix = 0
    do i = 1, N
      at = 3 * (i - 1)
      next = 3 * modulo(i, N)
      do k = 1, 3
        matrix(at + k, at + k) = matrix(at + k, at + k) + 4
        matrix(at + k, next + k) = matrix(at + k, next + k) - 2
        matrix(next + k, at + k) = matrix(next + k, at + k) - 2
      end do
      if (force(i) <= 0) cycle
      do l = 1, 3
        do k = 1, 3
          matrix(at + k, at + l) = matrix(at + k, at + l) + PENALTY * gradients(k, i) * gradients(l, i) &
            - force(i) * hessians(PACKED(k, l), i)
        end do
      end do
    end do
  end subroutine

  ! Solves (matrix + shift 1) step = right by Cholesky, with the first shift of 0, 1e-6, 1e-5, ... that makes it positive definite: a step
  ! that goes down.
  subroutine solve(matrix, right, step)
    real(c_double), intent(in) :: matrix(NX, NX), right(NX)
    real(c_double), intent(out) :: step(3, N)
    real(c_double) :: factor(NX, NX), x(NX), shift
    logical :: definite
    integer :: i
    shift = 0
    do
      factor = matrix
      do i = 1, NX
        factor(i, i) = factor(i, i) + shift
      end do
      call factorise(factor, definite)
      if (definite) exit
      shift = max(1e-6_c_double, 10 * shift)
    end do
    x = right
    do i = 1, NX
      x(i) = (x(i) - dot_product(factor(i, :i - 1), x(:i - 1))) / factor(i, i)
    end do
    do i = NX, 1, -1
      x(i) = (x(i) - dot_product(factor(i + 1:, i), x(i + 1:))) / factor(i, i)
    end do
    step = reshape(x, [3, N])
  end subroutine

  ! matrix = L L^T, L in its lower triangle.
  pure subroutine factorise(matrix, definite)
    real(c_double), intent(inout) :: matrix(NX, NX)
    logical, intent(out) :: definite
    integer :: i, j
    definite = .false.
    do j = 1, NX
      matrix(j, j) = matrix(j, j) - dot_product(matrix(j, :j - 1), matrix(j, :j - 1))
      if (matrix(j, j) <= 1e-8_c_double) return
      matrix(j, j) = sqrt(matrix(j, j))
      do i = j + 1, NX
        matrix(i, j) = (matrix(i, j) - dot_product(matrix(i, :j - 1), matrix(j, :j - 1))) / matrix(j, j)
      end do
    end do
    definite = .true.
  end subroutine
end program
