! keepout.f90: motions, parts and pairs of co-generation.

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
    call pairs_never_collide()
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
    call keepout_gears(reshape([0.0_c_double, 0.0_c_double, 2.0_c_double, 0.0_c_double], [2, 2]), 1.0_c_double, 1.0_c_double, &
      first, second)
    call near_point(moved(first, 0.25_c_double, [1.0_c_double, 0.0_c_double]), [0.0_c_double, 1.0_c_double], 1e-15_c_double, &
      "gears")
    call keepout_four_bar(reshape([0.0_c_double, 0.0_c_double, 1.0_c_double, 0.0_c_double], [2, 2]), &
      [0.3_c_double, 0.9_c_double, 0.7_c_double], 0.0_c_double, tau, 1, 32, crank, coupler, rocker)
    call near_point(moved(coupler, 0.5_c_double, [0.9_c_double, 0.0_c_double]), moved(rocker, 0.5_c_double, &
      [0.7_c_double, 0.0_c_double]), 1e-12_c_double, "four bars")
    call both%product(turn, screw, stat, errmsg)
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "outer has dim 2")
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
    call fails(stat, errmsg, KO_ERR_INVALID_ARGUMENT, "the mesh has dim 3")

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
end module
