! keepout.f90: motions, parts, pairs and assemblies of co-generation.

module cogen_test
  use keepout
  use check
  implicit none

  private
  public :: cogen_works

  real(c_double), parameter :: tau = 6.283185307179586_c_double

  ! Cancels at once.
  type, extends(keepout_listener) :: stopper
  contains
    procedure :: hear => stop_it
  end type

contains

  subroutine stop_it(self, fraction, stage, cancel)
    class(stopper), intent(inout) :: self
    real(c_double), intent(in) :: fraction
    character(len=*), intent(in) :: stage
    logical, intent(inout) :: cancel
    cancel = same_type_as(self, self) .and. fraction >= 0 .and. len(stage) > 0
  end subroutine

  subroutine cogen_works()
    call motions_move()
    call parts_are_grids()
    call meshes_bound_cells()
    call pairs_never_collide()
    call pairs_are_chosen()
    call trains_are_arranged()
  end subroutine

  ! What a motion makes of a point.
  function moved(motion, t, p) result(q)
    type(keepout_motion), intent(in) :: motion
    real(c_double), intent(in) :: t, p(:)
    real(c_double) :: q(size(p)), r(size(p), size(p), 1), s(size(p), 1)
    call motion%eval([t], r, s)
    q = matmul(r(:, :, 1), p) + s(:, 1)
  end function

  subroutine near_point(p, q, tolerance, what)
    real(c_double), intent(in) :: p(:), q(:), tolerance
    character(len=*), intent(in) :: what
    call near(maxval(abs(p - q)), 0.0_c_double, tolerance, what)
  end subroutine

  ! A turn by a quarter over the motion, as a function of C.
  function quarter(time, rotation, translation, data) bind(c, name="") result(failed)
    real(c_double), value :: time
    type(c_ptr), value :: rotation, translation, data
    integer(c_int32_t) :: failed
    real(c_double), pointer :: r(:), s(:)
    call c_f_pointer(rotation, r, [4])
    call c_f_pointer(translation, s, [2])
    r = [cos(time * tau / 4), -sin(time * tau / 4), sin(time * tau / 4), cos(time * tau / 4)]
    s = 0
    failed = merge(5_c_int32_t, 0_c_int32_t, c_associated(data) .and. time > 0.5)
  end function

  subroutine motions_move()
    type(keepout_motion) :: slide, screw, both, back, turn, sampled, asked, first, second, crank, coupler, rocker, fixed
    type(ko_law) :: law
    real(c_double), target :: waves(3, 1)
    real(c_double) :: p(3), q(3), f, r(2, 2, 3), s(2, 3), axis(3)
    integer, target :: something
    type(c_funptr) :: asks
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    p = [0.3_c_double, -0.2_c_double, 0.5_c_double]
    axis = [0, 0, 1]
    waves(:, 1) = [0.1_c_double, 1.0_c_double, 0.0_c_double]
    call slide%slide([1.0_c_double, 2.0_c_double, 3.0_c_double], keepout_law(0.25_c_double, 0.5_c_double))
    q = moved(slide, 0.4_c_double, p)
    call near_point(q, p + 0.6_c_double * [1, 2, 3], 1e-15_c_double, "motion%slide")
    law = keepout_law(1.0_c_double, waves=waves)
    call screw%screw([0.0_c_double, 0.0_c_double, 0.0_c_double], axis, 0.2_c_double, law)
    f = 0.25_c_double + 0.1_c_double * cos(tau / 4)
    call near_point(moved(screw, 0.25_c_double, p), [cos(f) * p(1) - sin(f) * p(2), sin(f) * p(1) + cos(f) * p(2), &
      p(3) + 0.2_c_double * f], 1e-14_c_double, "motion%screw")
    call both%product(screw, slide)
    call back%inverse(both)
    call near_point(moved(back, 0.7_c_double, moved(screw, 0.7_c_double, moved(slide, 0.7_c_double, p))), p, 1e-14_c_double, &
      "motion%product and inverse")
    call fixed%fixed(2, reshape([0.0_c_double, 1.0_c_double, -1.0_c_double, 0.0_c_double], [2, 2]), [3.0_c_double, 4.0_c_double])
    call near_point(moved(fixed, 0.5_c_double, [1.0_c_double, 2.0_c_double]), [1.0_c_double, 5.0_c_double], 0.0_c_double, &
      "motion%fixed")
    call fixed%fixed(3)
    call holds(fixed%dim() == 3, "motion%dim")
    call turn%turn([0.0_c_double, 0.0_c_double], keepout_law(tau / 4))
    call turn%eval([0.0_c_double, 0.5_c_double, 1.0_c_double], r, s)
    call near(r(2, 1, 3), 1.0_c_double, 1e-15_c_double, "rotations are matrices")
    call sampled%sampled(r, s)
    asks = c_funloc(quarter)
    call asked%from_function(2, asks, c_null_ptr, 3)
    call near_point(moved(sampled, 0.3_c_double, p(:2)), moved(turn, 0.3_c_double, p(:2)), 1e-14_c_double, "motion%sampled")
    call near_point(moved(asked, 0.3_c_double, p(:2)), moved(turn, 0.3_c_double, p(:2)), 1e-14_c_double, "motion%from_function")
    call asked%from_function(2, asks, c_loc(something), 3, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "pose 2, at time 1: the function returned 5")
    call asked%from_function(2, asks, c_null_ptr, 3, stat, errmsg, max_speed=1.0_c_double)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "max_speed is 1 and part is NULL")
    call keepout_gears(reshape([0.0_c_double, 0.0_c_double, 2.0_c_double, 0.0_c_double], [2, 2]), 1.0_c_double, 1.0_c_double, &
      first, second)
    call near_point(moved(first, 0.25_c_double, [1.0_c_double, 0.0_c_double]), [0.0_c_double, 1.0_c_double], 1e-15_c_double, &
      "gears")
    call keepout_four_bar(reshape([0.0_c_double, 0.0_c_double, 1.0_c_double, 0.0_c_double], [2, 2]), &
      [0.3_c_double, 0.9_c_double, 0.7_c_double], 0.0_c_double, tau, 1, 32, crank, coupler, rocker)
    call near_point(moved(coupler, 0.5_c_double, [0.9_c_double, 0.0_c_double]), moved(rocker, 0.5_c_double, &
      [0.7_c_double, 0.0_c_double]), 1e-12_c_double, "four bars")
    call both%product(turn, screw, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "outer dim 2")
    call turn%eval([0.5_c_double], r, s, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "rotations has 3 matrices; 1 are needed")
    call turn%free()
    call holds(turn%dim() == 0 .and. .not. c_associated(turn%c_handle()), "motion%free")
  end subroutine

  subroutine parts_are_grids()
    type(keepout_part) :: part, table, space
    type(keepout_motion) :: slide
    type(keepout_mesh) :: mesh
    type(keepout_cloud) :: cloud
    type(keepout_field) :: field
    type(ko_pair_options) :: options
    type(stopper) :: listener
    integer(c_int8_t) :: cells(20), first(20), swept(40), kept(20), pin(40)
    integer(c_int8_t), allocatable :: copied(:)
    integer(c_size_t) :: counts(2)
    real(c_double) :: corner(2), edge, out(20), ball(216), points(3, 1728), values(1728)
    integer :: i, j, k, n
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    corner = [-0.5_c_double, 0.0_c_double]
    cells = KO_CELL_FREE
    cells(4) = KO_CELL_FROZEN
    call part%create(corner, 0.25_c_double, [4, 5], cells)
    call part%copy_cells(copied)
    call holds(part%dim() == 2 .and. part%n_cells() == 20, "part%create")
    call holds(size(copied) == 20, "size of cells")
    call holds(count(copied == cells) == 20, "part%copy_cells")
    call part%grid(corner, edge, counts)
    call holds(counts(1) == 4 .and. counts(2) == 5, "part%grid")
    call near(edge, 0.25_c_double, 0.0_c_double, "edge")
    call part%fractions_of_box([-0.25_c_double, 0.25_c_double], [0.25_c_double, 1.0_c_double], 4, out)
    call near(sum(out), 6.0_c_double, 1e-12_c_double, "part%fractions_of_box")
    call part%fractions_of_ball([0.0_c_double, 0.5_c_double], 0.4_c_double, 32, out, 1)
    call near(sum(out) / 16, tau / 2 * 0.16_c_double, 2e-3_c_double, "part%fractions_of_ball")
    call part%fractions_of_cylinder(reshape([-0.25_c_double, 0.5_c_double, 0.25_c_double, 0.5_c_double], [2, 2]), 0.25_c_double, &
      4, out)
    call near(sum(out), 4.0_c_double, 1e-12_c_double, "part%fractions_of_cylinder")
    call space%create([-1.5_c_double, -1.5_c_double, -1.5_c_double], 0.5_c_double, [6, 6, 6])
    call cube(mesh)
    call space%fractions_of_mesh(mesh, 2, ball)
    call near(sum(ball), 64.0_c_double, 1e-12_c_double, "part%fractions_of_mesh")
    call mesh%sample(300, 1, cloud)
    call field%fit(cloud, small_fit(6))
    call space%fractions_of_field(field, 30.0_c_double, 2, ball)
    n = 0
    do i = 0, 11
      do j = 0, 11
        do k = 0, 11
          n = n + 1
          points(:, n) = -1.375_c_double + 0.25_c_double * [i, j, k]
        end do
      end do
    end do
    call field%eval(points, values)
    call near(sum(ball), count(values < 0) / 8.0_c_double, 1e-12_c_double, "part%fractions_of_field")
    call part%fractions_of_mesh(mesh, 2, out, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "the mesh dim 3")

    call table%create(corner, 0.25_c_double, [8, 5])
    call slide%slide([1.0_c_double, 0.0_c_double], keepout_law(0.5_c_double))
    options = keepout_pair_options()
    options%n_threads = 1
    first = 0
    first(1) = 1
    call part%sweep(slide, table, swept, cells=first, options=options)
    call holds(sum(int(swept)) == 3 .and. swept(1) == 1 .and. swept(6) == 1 .and. swept(11) == 1, "part%sweep")
    kept = 1
    pin = 0
    pin(11) = 1
    call part%unsweep(slide, table, KO_AVOID, kept, body_cells=pin)
    call holds(sum(int(kept)) == 17 .and. kept(1) == 0 .and. kept(6) == 0 .and. kept(11) == 0, "part%unsweep")
    call part%unsweep(slide, table, KO_STAY_IN, kept, listener=listener, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_CANCELLED, "cancelled")
    call part%free()
    call holds(part%dim() == 0 .and. .not. c_associated(part%c_handle()), "part%free")
  end subroutine

  subroutine pairs_never_collide()
    type(keepout_part) :: one, two
    type(keepout_motion) :: first, second
    type(keepout_pair) :: pair, far
    type(ko_pair_options) :: options
    type(ko_pair_report) :: report
    type(ko_optimise_options) :: plan
    type(ko_optimise_report) :: found
    type(stopper) :: listener
    real(c_double) :: rho_1(100), rho_2(90), l21(100), l12(90), d21_d1(100), d21_d2(90), d12_d1(100), d12_d2(90)
    real(c_double) :: g21, g12, weight, bound, gamma, volumes(2), reached(3), left(2, 3), bounds(3), history(5, 201)
    real(c_double) :: gaps(20), places(2, 20), largest, mean
    integer(c_int8_t) :: cells_1(100), cells_2(90), again_1(100), again_2(90), all_1(100, 3), all_2(90, 3)
    integer(c_size_t) :: n_lost, nearest(2, 20)
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    call one%create([-0.5_c_double, -0.5_c_double], 0.1_c_double, [10, 10])
    call two%create([0.4_c_double, -0.5_c_double], 0.1_c_double, [10, 9])
    call keepout_gears(reshape([0.0_c_double, 0.0_c_double, 0.9_c_double, 0.0_c_double], [2, 2]), 1.0_c_double, 1.0_c_double, &
      first, second)
    options = keepout_pair_options()
    options%conflicts = KO_CONFLICTS_OF_MEASURE
    options%measure_steps = 60
    options%n_threads = 1
    call pair%create(one, two, first, second, options, stat=stat)
    call holds(stat == KO_OK, "pair%create")
    call pair%report(report)
    call holds(report%n_cells(1) == 100 .and. report%n_cells(2) == 90 .and. report%n_edges > 100, "pair%report")
    rho_1 = 0.5_c_double
    rho_2 = 1
    call pair%measures(rho_1, rho_2, g21, g12, 1)
    call pair%local_measures(rho_1, rho_2, l21, l12)
    call pair%sensitivities(rho_1, rho_2, d21_d1, d21_d2, d12_d1, d12_d2)
    call holds(g21 > 1e-3_c_double .and. g12 > 1e-3_c_double, "pair%measures")
    call near(g12, 0.01_c_double * sum(rho_1 * l21), 1e-14_c_double, "l21")
    call near(g21, 0.01_c_double * sum(rho_2 * l12), 1e-14_c_double, "l12")
    call near(g21, sum(d21_d1 * rho_1), 1e-14_c_double, "d21_d1")
    call near(g21, sum(d21_d2 * rho_2), 1e-14_c_double, "d21_d2")
    call near(g12, sum(d12_d1 * rho_1), 1e-14_c_double, "d12_d1")
    call near(g12, sum(d12_d2 * rho_2), 1e-14_c_double, "d12_d2")
    call pair%colliding(cells_1, cells_2)
    call holds(sum(int(cells_1)) == report%n_colliding(1) .and. sum(int(cells_2)) == report%n_colliding(2), "pair%colliding")
    call pair%cut(cells_1, cells_2, weight, bound, gamma)
    call near(weight, 0.01_c_double * (sum(int(cells_1)) + sum(int(cells_2))), 1e-12_c_double, "pair%cut")
    call near(weight, bound, 0.0_c_double, "bound")
    call pair%volumes(cells_1, cells_2, volumes, reached(1), n_lost)
    call holds(n_lost == 0 .and. volumes(1) > 0, "pair%volumes")
    call near(reached(1), gamma, 0.0_c_double, "gamma")
    call pair%close(cells_1, cells_2, 0, again_1, again_2, gamma)
    call holds(count(again_1 == cells_1) == 100 .and. count(again_2 == cells_2) == 90, "pair%close")
    call pair%family([0.0_c_double, 0.5_c_double, 1.0_c_double], all_1, all_2, reached, left, bounds)
    call holds(all(left(1, :) + left(2, :) <= bounds * (1 + 1e-9_c_double)), "pair%family")
    call near(reached(3) - reached(1), 1.0_c_double, 0.0_c_double, "ends of the family")
    call pair%cut(again_1, again_2, weight, bound, gamma, spread(1.0_c_double, 1, 100), &
      spread(1e-4_c_double, 1, 90))
    call holds(sum(int(again_1)) == 100, "pair%cut with weights")
    plan = keepout_optimise_options()
    call pair%optimise(again_1, again_2, found, plan, rho_1, rho_2, history, stat=stat)
    call holds(stat == KO_OK .and. found%converged == 1 .and. found%n_iterations > 1, "pair%optimise")
    call near(sum(history(1:2, found%n_iterations + 1)), sum(left(:, 2)), 0.5_c_double * sum(left(:, 2)), "history")
    call pair%contact(cells_1, cells_2, gaps, largest, mean, nearest, places, 1)
    call near(mean, sum(gaps) / 20, 1e-14_c_double, "pair%contact")
    call near(largest, maxval(gaps), 0.0_c_double, "largest gap")
    call pair%contact(cells_1, cells_2, gaps, largest, mean, listener=listener, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_CANCELLED, "cancelled")
    call pair%cut(cells_1, cells_2, weight, bound, gamma, rho_2, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "weights_1 has 90 entries; 100 are needed")
    call pair%measures(rho_2, rho_1, g21, g12, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "90 densities for part 1's 100 cells")
    call two%create([50.0_c_double, 0.0_c_double], 0.1_c_double, [3, 3])
    call far%create(one, two, stat=stat)
    call holds(stat == KO_NEVER_MEET, "KO_NEVER_MEET")
    call pair%free()
    call holds(.not. c_associated(pair%c_handle()), "pair%free")
  end subroutine

  subroutine meshes_bound_cells()
    type(keepout_part) :: part, disc
    type(keepout_mesh) :: mesh
    type(ko_mesh_report) :: report
    type(stopper) :: listener
    ! The last axis is the fastest.
    integer(c_int8_t) :: ring(6, 8), cells(576)
    real(c_double) :: rho(576), filled(576), area
    integer(c_int32_t) :: stat
    character(len=200) :: errmsg
    call part%create([-1.0_c_double, 2.0_c_double], 0.25_c_double, [8, 6])
    ring = 0
    ring(1:4, 1:5) = 1
    ring(2:3, 2:4) = 0
    call part%mesh_of_cells(reshape(ring, [48]), mesh, rounds=0)
    call mesh%report(report)
    call holds(mesh%dim() == 2 .and. mesh%n_triangles() == 28 .and. report%n_components == 2, "part%mesh_of_cells")
    call holds(report%closed == 1 .and. report%inside_out == 0, "a closed mesh")
    call near(report%volume, 14.0_c_double / 16, 1e-12_c_double, "the area of a mesh")
    call near_point([report%bounds_min(:2), report%bounds_max(:2)], [-1.0_c_double, 2.0_c_double, 0.25_c_double, 3.0_c_double], &
      0.0_c_double, "the bounds of a mesh")

    call disc%create([-1.2_c_double, -1.2_c_double], 0.1_c_double, [24, 24])
    call disc%fractions_of_ball([0.03_c_double, -0.02_c_double], 1.0_c_double, 16, rho)
    cells = merge(1_c_int8_t, 0_c_int8_t, rho > 0.5_c_double)
    area = 0.01_c_double * sum(int(cells))
    call disc%mesh_of_cells(cells, mesh)
    call mesh%report(report)
    call holds(report%volume < area .and. report%volume > 0.85_c_double * area, "a mesh within its cells")
    call disc%fractions_of_mesh(mesh, 8, filled)
    call near(sum(filled, mask=cells == 0), 0.0_c_double, 0.0_c_double, "KO_WITHIN_CELLS")
    call disc%mesh_of_cells(cells, mesh, KO_WITHIN_ANYWHERE, 20)
    call mesh%report(report)
    call near(report%volume, area, 0.02_c_double * area, "KO_WITHIN_ANYWHERE")
    call disc%mesh_of_densities(rho, mesh, within=KO_WITHIN_ANYWHERE)
    call mesh%report(report)
    call near(report%volume, tau / 2, 0.01_c_double * tau, "part%mesh_of_densities")
    call disc%mesh_of_densities(rho, mesh, 0.9_c_double, KO_WITHIN_CELLS, 5)
    call mesh%report(report)
    call holds(report%volume < 0.01_c_double * count(rho > 0.9_c_double), "a mesh of the densest cells")

    call part%mesh_of_cells(cells, mesh, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "a set of 576 cells for a grid of 48")
    call disc%mesh_of_cells(cells, mesh, within=2_c_int32_t, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "within is 2")
    call disc%mesh_of_densities(rho, mesh, 1.0_c_double, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "the level is 1")
    call disc%mesh_of_cells(cells, mesh, listener=listener, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_CANCELLED, "cancelled")
    cells = 0
    call disc%mesh_of_cells(cells, mesh, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_DEGENERATE, "no cells")
    call holds(mesh%dim() == 2, "a mesh stays where none is made")
  end subroutine

  ! Whether a quarter of a turn about the middle carries a square of cells onto itself.
  logical function is_turned(cells)
    integer(c_int8_t), intent(in) :: cells(576)
    integer(c_int8_t) :: square(24, 24)
    square = reshape(cells, [24, 24])
    is_turned = all(square == transpose(square(:, 24:1:-1)))
  end function

  ! Two wheels turn against each other, in steps that quarters of a turn carry onto each other.
  subroutine pairs_are_chosen()
    integer, parameter :: n = 576
    type(keepout_part) :: one, two
    type(keepout_motion) :: first, second
    type(keepout_pair) :: pair
    type(ko_pair_options) :: options
    type(ko_family_options) :: exact
    type(ko_persistence_options) :: few
    type(stopper) :: listener
    real(c_double), dimension(n) :: rho_1, rho_2, weights, d21_d1, d21_d2, d12_d1, d12_d2, p21_d1, p21_d2, p12_d1, p12_d2
    real(c_double) :: quarter(2, 2), half(2, 2), zero(2), half_turn(12, 1), quarters(12, 2)
    real(c_double) :: weight, plain, bound, gamma, reached(2), volumes(2, 2), bounds(2), gaps(60), largest, mean, before, after
    real(c_double) :: area
    integer(c_int8_t), dimension(n) :: cells_1, cells_2, plain_1, plain_2
    integer(c_int8_t) :: all_1(n, 2), all_2(n, 2)
    integer(c_size_t) :: n_lost, n_tries
    integer(c_int32_t) :: stat
    integer :: i
    character(len=300) :: errmsg
    area = 1.0_c_double / n
    call one%create([-0.5_c_double, -0.5_c_double], 1.0_c_double / 24, [24, 24])
    call two%create([0.5_c_double, -0.5_c_double], 1.0_c_double / 24, [24, 24])
    call keepout_gears(reshape([0.0_c_double, 0.0_c_double, 1.0_c_double, 0.0_c_double], [2, 2]), 1.0_c_double, 1.0_c_double, &
      first, second)
    options = keepout_pair_options()
    options%n_steps = 400
    options%measure_steps = 60
    call pair%create(one, two, first, second, options)

    rho_1 = [(modulo(37 * i, 101) / 100.0_c_double, i = 1, n)]
    rho_2 = [(max(0.0_c_double, modulo(53 * i, 103) / 51.0_c_double - 1), i = 1, n)]
    call pair%sensitivities(rho_1, rho_2, d21_d1, d21_d2, d12_d1, d12_d2)
    call pair%topological_sensitivities(rho_1, rho_2, KO_CHANGE_PUT, p21_d1, p21_d2, p12_d1, p12_d2)
    call near_point(p21_d1, (1 - rho_1) * d21_d1 / area, 1e-12_c_double, "cells put to part 1, of g21")
    call near_point(p21_d2, (1 - rho_2) * d21_d2 / area, 1e-12_c_double, "cells put to part 2, of g21")
    call near_point(p12_d1, (1 - rho_1) * d12_d1 / area, 1e-12_c_double, "cells put to part 1, of g12")
    call near_point(p12_d2, (1 - rho_2) * d12_d2 / area, 1e-12_c_double, "cells put to part 2, of g12")
    call holds(count(p21_d1 > 0) > 20, "pair%topological_sensitivities")
    call pair%topological_sensitivities(rho_1, rho_2, KO_CHANGE_TAKE, p21_d1, p21_d2, p12_d1, p12_d2, 1)
    call near_point(p21_d1, rho_1 * d21_d1 / area, 1e-12_c_double, "cells taken from part 1, of g21")
    call near_point(p12_d2, rho_2 * d12_d2 / area, 1e-12_c_double, "cells taken from part 2, of g12")
    call pair%topological_sensitivities(rho_1, rho_2, 2_c_int32_t, p21_d1, p21_d2, p12_d1, p12_d2, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "change is 2")
    call pair%topological_sensitivities(rho_1, rho_2, KO_CHANGE_PUT, p21_d1(:9), p21_d2, p12_d1, p12_d2, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "d21_d1 has 9 entries; 576 are needed")

    ! Columns are what the axes become.
    zero = 0
    half = reshape([-1.0_c_double, 0.0_c_double, 0.0_c_double, -1.0_c_double], [2, 2])
    quarter = reshape([0.0_c_double, 1.0_c_double, -1.0_c_double, 0.0_c_double], [2, 2])
    half_turn(:, 1) = keepout_symmetry(half, zero, half, [2.0_c_double, 0.0_c_double])
    quarters(:, 1) = keepout_symmetry(quarter, zero, transpose(quarter), [1.0_c_double, 1.0_c_double])
    call near_point(quarters(:, 1), real([0, -1, 1, 0, 0, 0, 0, 1, -1, 0, 1, 1], c_double), 0.0_c_double, "keepout_symmetry")
    quarters(:, 2) = half_turn(:, 1)
    call pair%cut(plain_1, plain_2, plain, bound, gamma)
    call pair%cut(cells_1, cells_2, weight, bound, gamma, symmetries=half_turn)
    call near(weight, bound, 0.0_c_double, "the bound of symmetric pairs")
    call near(weight, plain, 1e-12_c_double, "the weight of symmetric pairs")
    call holds(all(cells_1 == cells_1(n:1:-1)) .and. all(cells_2 == cells_2(n:1:-1)), "half turns")
    ! Weights that are not symmetric: the best symmetric pair is lighter.
    weights = [(merge(1.0_c_double, 2.0_c_double, modulo(7919 * i, 101) < 50), i = 1, n)]
    exact = keepout_family_options()
    exact%symmetry_excess = 1e-3_c_double
    call pair%cut(cells_1, cells_2, weight, bound, gamma, weights, weights, exact, quarters)
    call pair%cut(all_1(:, 1), all_2(:, 1), mean, bound, gamma, weights, weights)
    call holds(weight < mean .and. weight > 0.5_c_double * mean .and. .not. is_turned(all_1(:, 1)), "symmetric pairs are lighter")
    call holds(is_turned(cells_1) .and. is_turned(cells_2), "quarters of a turn")
    call pair%volumes(cells_1, cells_2, volumes(:, 1), gamma, n_lost)
    call holds(n_lost == 0, "symmetric pairs never collide")
    call pair%family([0.0_c_double, 1.0_c_double], all_1, all_2, reached, volumes, bounds, symmetries=quarters)
    call near(reached(2) - reached(1), 1.0_c_double, 0.0_c_double, "ends of the symmetric family")
    call holds(is_turned(all_1(:, 1)) .and. is_turned(all_1(:, 2)) .and. is_turned(all_2(:, 1)), "a symmetric family")
    quarters(:, 2) = keepout_symmetry(quarter, zero, quarter, [1.0_c_double, -1.0_c_double])
    call pair%cut(cells_1, cells_2, weight, bound, gamma, symmetries=quarters(:, 2:), stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "map 0 does not carry conflicts onto conflicts")
    call pair%cut(cells_1, cells_2, weight, bound, gamma, symmetries=quarters(:9, :), stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "symmetries has 9 rows; 12 are needed")
    exact%symmetry_excess = 1
    call pair%family([0.5_c_double], all_1(:, :1), all_2(:, :1), reached(:1), volumes(:, :1), bounds(:1), options=exact, &
      symmetries=half_turn, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "excess of edges is 1")

    few = keepout_persistence_options()
    few%n_times = 60
    few%max_tries = 40
    n_tries = 0
    call pair%more_persistent(plain_1, plain_2, cells_1, cells_2, before, after, options=few, n_tries=n_tries)
    call holds(after >= before .and. n_tries > 0 .and. n_tries <= 40, "pair%more_persistent")
    call holds(sum(int(cells_1)) + sum(int(cells_2)) == sum(int(plain_1)) + sum(int(plain_2)), "persistent pairs are as heavy")
    call pair%volumes(cells_1, cells_2, volumes(:, 1), gamma, n_lost)
    call holds(n_lost == 0, "persistent pairs never collide")
    call pair%contact(plain_1, plain_2, gaps, largest, mean)
    call near(sum(1 / (1 + 24 * gaps)) / 60, before, 1e-12_c_double, "persistence before")
    call pair%contact(cells_1, cells_2, gaps, largest, mean)
    call near(sum(1 / (1 + 24 * gaps)) / 60, after, 1e-12_c_double, "persistence after")
    weights = 3
    few%scale = 0.1_c_double
    call pair%more_persistent(cells_1, cells_2, plain_1, plain_2, before, after, weights, weights, few)
    call near(sum(1 / (1 + gaps / 0.1_c_double)) / 60, before, 1e-12_c_double, "persistence by another scale")
    few%gammas = [0.7_c_double, 0.3_c_double]
    call pair%more_persistent(cells_1, cells_2, plain_1, plain_2, before, after, options=few, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "from 0.7 to 0.3")
    call pair%more_persistent(cells_1, cells_2, plain_1, plain_2, before, after, listener=listener, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_CANCELLED, "cancelled")
    call pair%more_persistent(cells_1(:9), cells_2, plain_1, plain_2, before, after, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "cells_1 has 576 entries; 9 are needed")
    cells_1(maxloc(cells_1)) = 0
    call pair%more_persistent(cells_1, cells_2, plain_1, plain_2, before, after, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "the pair collides, could grow")
  end subroutine

  ! Three wheels in a row, each of which turns against the next.
  subroutine trains_are_arranged()
    integer, parameter :: n = 280, counts(2, 3) = reshape([10, 10, 10, 9, 9, 10], [2, 3])
    type(keepout_part) :: wheels(3), boxes(3)
    ! The last two of what slides stay.
    type(keepout_motion) :: turns(3), slides(3)
    type(keepout_pair) :: pair
    type(keepout_assembly) :: train, bored, apart
    type(ko_pair_options) :: options
    type(ko_arrange_options) :: plan
    type(ko_assembly_report) :: report
    type(stopper) :: listener
    integer(c_int8_t), dimension(n) :: cells, again, other, all_of, none
    integer(c_int8_t) :: cells_1(100), cells_2(90), blocks(152), block(6, 6, 2)
    integer(c_size_t), allocatable :: meetings(:, :)
    integer(c_size_t) :: n_lost, n_cuts
    real(c_double) :: weights(n), weight, bound, volumes(2), gamma
    integer(c_int32_t) :: stat
    integer :: k
    character(len=200) :: errmsg
    all_of = 1
    none = 0
    do k = 1, 3
      call wheels(k)%create([0.9_c_double * (k - 1) - 0.5_c_double, -0.5_c_double], 0.1_c_double, counts(:, k))
      call turns(k)%turn([0.9_c_double * (k - 1), 0.0_c_double], keepout_law(merge(-tau, tau, k == 2)))
    end do
    options = keepout_pair_options()
    options%n_threads = 1
    call train%create(wheels, turns, options, stat=stat)
    call holds(stat == KO_OK .and. train%dim() == 2 .and. train%n_parts() == 3 .and. train%n_cells() == n, "assembly%create")
    call train%report(report)
    call holds(report%n_parts == 3 .and. report%n_cells == n .and. report%n_meetings == 2, "assembly%report")
    call holds(report%n_edges > 100 .and. report%graph_bytes > 0 .and. report%dim == 2, "the graph of an assembly")
    call train%copy_meetings(meetings)
    call holds(size(meetings, 2) == 2 .and. all(reshape(meetings, [4]) == [0, 1, 1, 2]), "assembly%copy_meetings")

    n_cuts = 0
    call train%arrange(cells, weight, bound, n_cuts=n_cuts)
    call near(weight, bound, 0.0_c_double, "trains get the best")
    call near(weight, 0.01_c_double * sum(int(cells)), 1e-12_c_double, "assembly%arrange")
    call holds(n_cuts >= 1, "n_cuts")
    call train%close(cells, again, [2, 0, 1])
    call holds(all(again == cells), "what is closed stays")
    call pair%create(wheels(2), wheels(3), turns(2), turns(3), options)
    call pair%volumes(cells(101:190), cells(191:), volumes, gamma, n_lost)
    call holds(n_lost == 0, "the second and the third wheel")
    call pair%create(wheels(1), wheels(2), turns(1), turns(2), options)
    call pair%volumes(cells(:100), cells(101:190), volumes, gamma, n_lost)
    call holds(n_lost == 0, "the first and the second wheel")
    ! The first keeps all, the second what it leaves, as in a pair.
    call train%close(all_of, again)
    call train%close(none, other)
    call pair%close(all_of(:100), none(:90), 1, cells_1, cells_2, gamma)
    call holds(all(again(:100) == 1) .and. all(again(101:190) == cells_2) .and. sum(int(cells_2)) < 90, "assembly%close")
    call holds(all(other == again), "closure of nothing")
    call train%close(all_of, again, [1, 0, 2])
    call holds(all(again(101:190) == 1) .and. sum(int(again)) < n, "closure in another order")
    weights = 0.01_c_double
    call train%arrange(again, weight, bound, weights)
    call holds(all(again == cells), "weights that are areas")
    weights(101:190) = 10
    call train%arrange(again, weight, bound, weights)
    call holds(all(again(101:190) == 1) .and. weight > 900, "assembly%arrange with weights")

    ! In space: a bar slides through two blocks, and bores its way.
    call boxes(1)%create([0.0_c_double, 0.0_c_double, 0.0_c_double], 0.5_c_double, [2, 2, 2])
    call boxes(2)%create([1.0_c_double, -1.0_c_double, -1.0_c_double], 0.5_c_double, [2, 6, 6])
    call boxes(3)%create([2.5_c_double, -1.0_c_double, -1.0_c_double], 0.5_c_double, [2, 6, 6])
    call slides(1)%slide([3.0_c_double, 0.0_c_double, 0.0_c_double], keepout_law(1.0_c_double))
    call bored%create(boxes, slides)
    call bored%close(all_of(:152), blocks)
    block = 1
    block(3:4, 3:4, :) = 0
    call holds(bored%dim() == 3 .and. all(blocks(:8) == 1), "a bar that bores")
    call holds(all(blocks(9:80) == reshape(block, [72])) .and. all(blocks(81:) == reshape(block, [72])), "blocks that are bored")
    call apart%create(boxes(2:), slides(2:), stat=stat)
    call holds(stat == KO_NEVER_MEET .and. apart%n_cells() == 144, "KO_NEVER_MEET of an assembly")
    call apart%copy_meetings(meetings)
    call holds(size(meetings, 2) == 0, "no meetings")

    call apart%create(wheels, turns(:2), stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "motions has 2 entries; 3 are needed")
    call apart%create(wheels(:0), turns(:0), stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "n_parts is 0")
    call apart%create(wheels, slides, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "part 0: a part dim 2, its motion dim 3")
    call apart%create(wheels, turns, listener=listener, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_CANCELLED, "cancelled")
    options%measure_steps = 5
    call apart%create(wheels, turns, options, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "measure_steps must be 0")
    call holds(apart%n_parts() == 2, "an assembly stays where none is made")
    call boxes(3)%free()
    call apart%create(boxes, slides, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "parts[2] is NULL")
    call train%close(all_of, again, [0, 1, 1], stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "the order [0, 1, 1] does not name each of 3 parts once")
    call train%close(all_of, again, [0, 1], stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "order has 2 entries; 3 are needed")
    call train%close(all_of(:9), again, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "sets has 9 entries; 280 are needed")
    call train%close(all_of(:9), again(:9), stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "n_cells is 9")
    call train%arrange(again, weight, bound, weights(:9), stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "weights has 9 entries; 280 are needed")
    weights(191) = -1
    call train%arrange(again, weight, bound, weights, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "weight 190 is -1")
    plan = keepout_arrange_options()
    plan%max_rounds = 0
    call train%arrange(again, weight, bound, options=plan, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "0 rounds")
    call train%arrange(again, weight, bound, listener=listener, stat=stat, errmsg=errmsg)
    call fails(stat, errmsg, KO_ERR_CANCELLED, "cancelled")
    call train%free()
    call holds(train%n_cells() == 0 .and. .not. c_associated(train%c_handle()), "assembly%free")
    call train%report(report, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "assembly is NULL")
  end subroutine
end module
