! The structs of keepout.f90 lie in memory as C's do: each field at its offset (layout.c), and no more behind the last.

module layout
  use keepout
  use check
  implicit none

  private
  public :: layouts_agree

  interface
    function layout_mesh_report(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_fit_options(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_fit_report(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_normal_options(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_normal_report(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_smooth_options(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_level_set_options(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_certify_options(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_certificate(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_aggregation(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_explicit_options(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_separation(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_law(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_pair_options(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_family_options(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_optimise_options(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_pair_report(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_optimise_report(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_persistence_options(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_arrange_options(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function

    function layout_assembly_report(offsets) bind(c) result(bytes)
      import :: c_size_t
      integer(c_size_t), intent(inout) :: offsets(*)
      integer(c_size_t) :: bytes
    end function
  end interface

contains

  subroutine layouts_agree()
    call check_mesh_report()
    call check_fit_options()
    call check_fit_report()
    call check_normal_options()
    call check_normal_report()
    call check_smooth_options()
    call check_level_set_options()
    call check_certify_options()
    call check_certificate()
    call check_aggregation()
    call check_explicit_options()
    call check_separation()
    call check_law()
    call check_pair_options()
    call check_family_options()
    call check_optimise_options()
    call check_pair_report()
    call check_optimise_report()
    call check_persistence_options()
    call check_arrange_options()
    call check_assembly_report()
  end subroutine

  ! Bytes from `start` to `field`.
  integer(c_size_t) function offset(start, field)
    type(c_ptr), intent(in) :: start, field
    offset = int(transfer(field, 0_c_intptr_t) - transfer(start, 0_c_intptr_t), c_size_t)
  end function

  subroutine check_mesh_report()
    type(ko_mesh_report), target :: x
    integer(c_size_t) :: right(18), found(18)
    call equal(c_sizeof(x), layout_mesh_report(right), "bytes of ko_mesh_report")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%n_vertices))
    found(3) = offset(c_loc(x), c_loc(x%n_triangles))
    found(4) = offset(c_loc(x), c_loc(x%n_components))
    found(5) = offset(c_loc(x), c_loc(x%n_boundary_edges))
    found(6) = offset(c_loc(x), c_loc(x%n_non_manifold_edges))
    found(7) = offset(c_loc(x), c_loc(x%n_non_manifold_vertices))
    found(8) = offset(c_loc(x), c_loc(x%n_degenerate))
    found(9) = offset(c_loc(x), c_loc(x%n_duplicate))
    found(10) = offset(c_loc(x), c_loc(x%n_unreferenced))
    found(11) = offset(c_loc(x), c_loc(x%closed))
    found(12) = offset(c_loc(x), c_loc(x%oriented))
    found(13) = offset(c_loc(x), c_loc(x%manifold))
    found(14) = offset(c_loc(x), c_loc(x%inside_out))
    found(15) = offset(c_loc(x), c_loc(x%bounds_min))
    found(16) = offset(c_loc(x), c_loc(x%bounds_max))
    found(17) = offset(c_loc(x), c_loc(x%area))
    found(18) = offset(c_loc(x), c_loc(x%volume))
    call holds(all(found == right), "offsets in ko_mesh_report")
  end subroutine

  subroutine check_fit_options()
    type(ko_fit_options), target :: x
    integer(c_size_t) :: right(19), found(19)
    call equal(c_sizeof(x), layout_fit_options(right), "bytes of ko_fit_options")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%control_points))
    found(3) = offset(c_loc(x), c_loc(x%reweightings))
    found(4) = offset(c_loc(x), c_loc(x%margin))
    found(5) = offset(c_loc(x), c_loc(x%lambda_normal))
    found(6) = offset(c_loc(x), c_loc(x%lambda_smooth))
    found(7) = offset(c_loc(x), c_loc(x%distance_weight))
    found(8) = offset(c_loc(x), c_loc(x%tolerance))
    found(9) = offset(c_loc(x), c_loc(x%feasible))
    found(10) = offset(c_loc(x), c_loc(x%max_iterations))
    found(11) = offset(c_loc(x), c_loc(x%memory_limit))
    found(12) = offset(c_loc(x), c_loc(x%n_threads))
    found(13) = offset(c_loc(x), c_loc(x%reserved))
    found(14) = offset(c_loc(x), c_loc(x%progress))
    found(15) = offset(c_loc(x), c_loc(x%progress_data))
    found(16) = offset(c_loc(x), c_loc(x%reweighting))
    found(17) = offset(c_loc(x), c_loc(x%reserved_2))
    found(18) = offset(c_loc(x), c_loc(x%max_error))
    found(19) = offset(c_loc(x), c_loc(x%max_unknowns))
    call holds(all(found == right), "offsets in ko_fit_options")
  end subroutine

  subroutine check_fit_report()
    type(ko_fit_report), target :: x
    integer(c_size_t) :: right(22), found(22)
    call equal(c_sizeof(x), layout_fit_report(right), "bytes of ko_fit_report")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%dim))
    found(3) = offset(c_loc(x), c_loc(x%feasible))
    found(4) = offset(c_loc(x), c_loc(x%control_points))
    found(5) = offset(c_loc(x), c_loc(x%iterations))
    found(6) = offset(c_loc(x), c_loc(x%n_unknowns))
    found(7) = offset(c_loc(x), c_loc(x%n_points))
    found(8) = offset(c_loc(x), c_loc(x%bytes))
    found(9) = offset(c_loc(x), c_loc(x%box_min))
    found(10) = offset(c_loc(x), c_loc(x%box_max))
    found(11) = offset(c_loc(x), c_loc(x%diagonal))
    found(12) = offset(c_loc(x), c_loc(x%residual))
    found(13) = offset(c_loc(x), c_loc(x%seconds_assembly))
    found(14) = offset(c_loc(x), c_loc(x%seconds_solve))
    found(15) = offset(c_loc(x), c_loc(x%seconds_check))
    found(16) = offset(c_loc(x), c_loc(x%rms))
    found(17) = offset(c_loc(x), c_loc(x%max))
    found(18) = offset(c_loc(x), c_loc(x%mean_gradient))
    found(19) = offset(c_loc(x), c_loc(x%n_outliers))
    found(20) = offset(c_loc(x), c_loc(x%clear_sides))
    found(21) = offset(c_loc(x), c_loc(x%convergence_rate))
    found(22) = offset(c_loc(x), c_loc(x%n_levels))
    call holds(all(found == right), "offsets in ko_fit_report")
  end subroutine

  subroutine check_normal_options()
    type(ko_normal_options), target :: x
    integer(c_size_t) :: right(7), found(7)
    call equal(c_sizeof(x), layout_normal_options(right), "bytes of ko_normal_options")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%neighbours))
    found(3) = offset(c_loc(x), c_loc(x%n_threads))
    found(4) = offset(c_loc(x), c_loc(x%outlier_factor))
    found(5) = offset(c_loc(x), c_loc(x%memory_limit))
    found(6) = offset(c_loc(x), c_loc(x%progress))
    found(7) = offset(c_loc(x), c_loc(x%progress_data))
    call holds(all(found == right), "offsets in ko_normal_options")
  end subroutine

  subroutine check_normal_report()
    type(ko_normal_report), target :: x
    integer(c_size_t) :: right(8), found(8)
    call equal(c_sizeof(x), layout_normal_report(right), "bytes of ko_normal_report")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%n_components))
    found(3) = offset(c_loc(x), c_loc(x%n_copies))
    found(4) = offset(c_loc(x), c_loc(x%n_outliers))
    found(5) = offset(c_loc(x), c_loc(x%n_degenerate))
    found(6) = offset(c_loc(x), c_loc(x%n_doubtful))
    found(7) = offset(c_loc(x), c_loc(x%agreement))
    found(8) = offset(c_loc(x), c_loc(x%seconds))
    call holds(all(found == right), "offsets in ko_normal_report")
  end subroutine

  subroutine check_smooth_options()
    type(ko_smooth_options), target :: x
    integer(c_size_t) :: right(7), found(7)
    call equal(c_sizeof(x), layout_smooth_options(right), "bytes of ko_smooth_options")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%neighbours))
    found(3) = offset(c_loc(x), c_loc(x%rounds))
    found(4) = offset(c_loc(x), c_loc(x%n_threads))
    found(5) = offset(c_loc(x), c_loc(x%reserved))
    found(6) = offset(c_loc(x), c_loc(x%progress))
    found(7) = offset(c_loc(x), c_loc(x%progress_data))
    call holds(all(found == right), "offsets in ko_smooth_options")
  end subroutine

  subroutine check_level_set_options()
    type(ko_level_set_options), target :: x
    integer(c_size_t) :: right(9), found(9)
    call equal(c_sizeof(x), layout_level_set_options(right), "bytes of ko_level_set_options")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%subdivisions))
    found(3) = offset(c_loc(x), c_loc(x%n_threads))
    found(4) = offset(c_loc(x), c_loc(x%shortest_edge))
    found(5) = offset(c_loc(x), c_loc(x%relaxations))
    found(6) = offset(c_loc(x), c_loc(x%reserved))
    found(7) = offset(c_loc(x), c_loc(x%memory_limit))
    found(8) = offset(c_loc(x), c_loc(x%progress))
    found(9) = offset(c_loc(x), c_loc(x%progress_data))
    call holds(all(found == right), "offsets in ko_level_set_options")
  end subroutine

  subroutine check_certify_options()
    type(ko_certify_options), target :: x
    integer(c_size_t) :: right(7), found(7)
    call equal(c_sizeof(x), layout_certify_options(right), "bytes of ko_certify_options")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%tolerance))
    found(3) = offset(c_loc(x), c_loc(x%max_boxes))
    found(4) = offset(c_loc(x), c_loc(x%n_threads))
    found(5) = offset(c_loc(x), c_loc(x%reserved))
    found(6) = offset(c_loc(x), c_loc(x%progress))
    found(7) = offset(c_loc(x), c_loc(x%progress_data))
    call holds(all(found == right), "offsets in ko_certify_options")
  end subroutine

  subroutine check_certificate()
    type(ko_certificate), target :: x
    integer(c_size_t) :: right(11), found(11)
    call equal(c_sizeof(x), layout_certificate(right), "bytes of ko_certificate")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%threshold))
    found(3) = offset(c_loc(x), c_loc(x%largest_found))
    found(4) = offset(c_loc(x), c_loc(x%place))
    found(5) = offset(c_loc(x), c_loc(x%surface_error))
    found(6) = offset(c_loc(x), c_loc(x%steepest))
    found(7) = offset(c_loc(x), c_loc(x%steepest_beyond))
    found(8) = offset(c_loc(x), c_loc(x%n_boxes))
    found(9) = offset(c_loc(x), c_loc(x%n_components))
    found(10) = offset(c_loc(x), c_loc(x%side_certified))
    found(11) = offset(c_loc(x), c_loc(x%budget_reached))
    call holds(all(found == right), "offsets in ko_certificate")
  end subroutine

  subroutine check_aggregation()
    type(ko_aggregation), target :: x
    integer(c_size_t) :: right(4), found(4)
    call equal(c_sizeof(x), layout_aggregation(right), "bytes of ko_aggregation")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%sharpness))
    found(3) = offset(c_loc(x), c_loc(x%kind))
    found(4) = offset(c_loc(x), c_loc(x%side))
    call holds(all(found == right), "offsets in ko_aggregation")
  end subroutine

  subroutine check_explicit_options()
    type(ko_explicit_options), target :: x
    integer(c_size_t) :: right(7), found(7)
    call equal(c_sizeof(x), layout_explicit_options(right), "bytes of ko_explicit_options")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%smoothing))
    found(3) = offset(c_loc(x), c_loc(x%softening))
    found(4) = offset(c_loc(x), c_loc(x%formulation))
    found(5) = offset(c_loc(x), c_loc(x%n_nearest))
    found(6) = offset(c_loc(x), c_loc(x%exponent))
    found(7) = offset(c_loc(x), c_loc(x%feasible))
    call holds(all(found == right), "offsets in ko_explicit_options")
  end subroutine

  subroutine check_separation()
    type(ko_separation), target :: x
    integer(c_size_t) :: right(7), found(7)
    call equal(c_sizeof(x), layout_separation(right), "bytes of ko_separation")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%minimum_distance))
    found(3) = offset(c_loc(x), c_loc(x%intersection_length))
    found(4) = offset(c_loc(x), c_loc(x%distance_by_translation))
    found(5) = offset(c_loc(x), c_loc(x%length_by_translation))
    found(6) = offset(c_loc(x), c_loc(x%b_in_a))
    found(7) = offset(c_loc(x), c_loc(x%a_in_b))
    call holds(all(found == right), "offsets in ko_separation")
  end subroutine

  subroutine check_law()
    type(ko_law), target :: x
    integer(c_size_t) :: right(5), found(5)
    call equal(c_sizeof(x), layout_law(right), "bytes of ko_law")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%offset))
    found(3) = offset(c_loc(x), c_loc(x%slope))
    found(4) = offset(c_loc(x), c_loc(x%waves))
    found(5) = offset(c_loc(x), c_loc(x%n_waves))
    call holds(all(found == right), "offsets in ko_law")
  end subroutine

  subroutine check_pair_options()
    type(ko_pair_options), target :: x
    integer(c_size_t) :: right(10), found(10)
    call equal(c_sizeof(x), layout_pair_options(right), "bytes of ko_pair_options")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%slack))
    found(3) = offset(c_loc(x), c_loc(x%n_steps))
    found(4) = offset(c_loc(x), c_loc(x%measure_steps))
    found(5) = offset(c_loc(x), c_loc(x%clearance))
    found(6) = offset(c_loc(x), c_loc(x%max_bytes))
    found(7) = offset(c_loc(x), c_loc(x%conflicts))
    found(8) = offset(c_loc(x), c_loc(x%n_threads))
    found(9) = offset(c_loc(x), c_loc(x%progress))
    found(10) = offset(c_loc(x), c_loc(x%progress_data))
    call holds(all(found == right), "offsets in ko_pair_options")
  end subroutine

  subroutine check_family_options()
    type(ko_family_options), target :: x
    integer(c_size_t) :: right(9), found(9)
    call equal(c_sizeof(x), layout_family_options(right), "bytes of ko_family_options")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%gap))
    found(3) = offset(c_loc(x), c_loc(x%symmetries))
    found(4) = offset(c_loc(x), c_loc(x%n_symmetries))
    found(5) = offset(c_loc(x), c_loc(x%symmetry_excess))
    found(6) = offset(c_loc(x), c_loc(x%n_threads))
    found(7) = offset(c_loc(x), c_loc(x%reserved))
    found(8) = offset(c_loc(x), c_loc(x%progress))
    found(9) = offset(c_loc(x), c_loc(x%progress_data))
    call holds(all(found == right), "offsets in ko_family_options")
  end subroutine

  subroutine check_optimise_options()
    type(ko_optimise_options), target :: x
    integer(c_size_t) :: right(10), found(10)
    call equal(c_sizeof(x), layout_optimise_options(right), "bytes of ko_optimise_options")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%gamma))
    found(3) = offset(c_loc(x), c_loc(x%tolerance))
    found(4) = offset(c_loc(x), c_loc(x%feasibility))
    found(5) = offset(c_loc(x), c_loc(x%max_iterations))
    found(6) = offset(c_loc(x), c_loc(x%close_from))
    found(7) = offset(c_loc(x), c_loc(x%n_threads))
    found(8) = offset(c_loc(x), c_loc(x%reserved))
    found(9) = offset(c_loc(x), c_loc(x%progress))
    found(10) = offset(c_loc(x), c_loc(x%progress_data))
    call holds(all(found == right), "offsets in ko_optimise_options")
  end subroutine

  subroutine check_pair_report()
    type(ko_pair_report), target :: x
    integer(c_size_t) :: right(10), found(10)
    call equal(c_sizeof(x), layout_pair_report(right), "bytes of ko_pair_report")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%n_cells))
    found(3) = offset(c_loc(x), c_loc(x%n_colliding))
    found(4) = offset(c_loc(x), c_loc(x%n_edges))
    found(5) = offset(c_loc(x), c_loc(x%graph_bytes))
    found(6) = offset(c_loc(x), c_loc(x%measure_steps))
    found(7) = offset(c_loc(x), c_loc(x%n_visits))
    found(8) = offset(c_loc(x), c_loc(x%measure_bytes))
    found(9) = offset(c_loc(x), c_loc(x%dim))
    found(10) = offset(c_loc(x), c_loc(x%has_graph))
    call holds(all(found == right), "offsets in ko_pair_report")
  end subroutine

  subroutine check_optimise_report()
    type(ko_optimise_report), target :: x
    integer(c_size_t) :: right(7), found(7)
    call equal(c_sizeof(x), layout_optimise_report(right), "bytes of ko_optimise_report")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%gamma))
    found(3) = offset(c_loc(x), c_loc(x%volumes))
    found(4) = offset(c_loc(x), c_loc(x%measures))
    found(5) = offset(c_loc(x), c_loc(x%change))
    found(6) = offset(c_loc(x), c_loc(x%n_iterations))
    found(7) = offset(c_loc(x), c_loc(x%converged))
    call holds(all(found == right), "offsets in ko_optimise_report")
  end subroutine

  subroutine check_persistence_options()
    type(ko_persistence_options), target :: x
    integer(c_size_t) :: right(9), found(9)
    call equal(c_sizeof(x), layout_persistence_options(right), "bytes of ko_persistence_options")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%scale))
    found(3) = offset(c_loc(x), c_loc(x%gammas))
    found(4) = offset(c_loc(x), c_loc(x%n_times))
    found(5) = offset(c_loc(x), c_loc(x%max_tries))
    found(6) = offset(c_loc(x), c_loc(x%n_threads))
    found(7) = offset(c_loc(x), c_loc(x%reserved))
    found(8) = offset(c_loc(x), c_loc(x%progress))
    found(9) = offset(c_loc(x), c_loc(x%progress_data))
    call holds(all(found == right), "offsets in ko_persistence_options")
  end subroutine

  subroutine check_arrange_options()
    type(ko_arrange_options), target :: x
    integer(c_size_t) :: right(5), found(5)
    call equal(c_sizeof(x), layout_arrange_options(right), "bytes of ko_arrange_options")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%max_rounds))
    found(3) = offset(c_loc(x), c_loc(x%max_starts))
    found(4) = offset(c_loc(x), c_loc(x%progress))
    found(5) = offset(c_loc(x), c_loc(x%progress_data))
    call holds(all(found == right), "offsets in ko_arrange_options")
  end subroutine

  subroutine check_assembly_report()
    type(ko_assembly_report), target :: x
    integer(c_size_t) :: right(7), found(7)
    call equal(c_sizeof(x), layout_assembly_report(right), "bytes of ko_assembly_report")
    found(1) = offset(c_loc(x), c_loc(x%struct_size))
    found(2) = offset(c_loc(x), c_loc(x%n_cells))
    found(3) = offset(c_loc(x), c_loc(x%n_meetings))
    found(4) = offset(c_loc(x), c_loc(x%n_edges))
    found(5) = offset(c_loc(x), c_loc(x%graph_bytes))
    found(6) = offset(c_loc(x), c_loc(x%n_parts))
    found(7) = offset(c_loc(x), c_loc(x%dim))
    call holds(all(found == right), "offsets in ko_assembly_report")
  end subroutine
end module
