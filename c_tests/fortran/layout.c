/* Where C puts the fields of the structs of keepout.h: for layout.f90 to compare. Each function fills `offsets` and returns the size. */

#include <keepout.h>

size_t layout_mesh_report(size_t *offsets);
size_t layout_normal_options(size_t *offsets);
size_t layout_normal_report(size_t *offsets);
size_t layout_smooth_options(size_t *offsets);
size_t layout_fit_options(size_t *offsets);
size_t layout_fit_report(size_t *offsets);
size_t layout_level_set_options(size_t *offsets);
size_t layout_certify_options(size_t *offsets);
size_t layout_certificate(size_t *offsets);
size_t layout_aggregation(size_t *offsets);
size_t layout_explicit_options(size_t *offsets);
size_t layout_separation(size_t *offsets);
size_t layout_law(size_t *offsets);
size_t layout_pair_options(size_t *offsets);
size_t layout_family_options(size_t *offsets);
size_t layout_optimise_options(size_t *offsets);
size_t layout_pair_report(size_t *offsets);
size_t layout_optimise_report(size_t *offsets);
size_t layout_persistence_options(size_t *offsets);
size_t layout_arrange_options(size_t *offsets);
size_t layout_assembly_report(size_t *offsets);

#define PUT(field) *offsets++ = offsetof(STRUCT, field)

#define STRUCT ko_mesh_report
size_t layout_mesh_report(size_t *offsets) {
    PUT(struct_size);
    PUT(n_vertices);
    PUT(n_triangles);
    PUT(n_components);
    PUT(n_boundary_edges);
    PUT(n_non_manifold_edges);
    PUT(n_non_manifold_vertices);
    PUT(n_degenerate);
    PUT(n_duplicate);
    PUT(n_unreferenced);
    PUT(closed);
    PUT(oriented);
    PUT(manifold);
    PUT(inside_out);
    PUT(bounds_min);
    PUT(bounds_max);
    PUT(area);
    PUT(volume);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_fit_options
size_t layout_fit_options(size_t *offsets) {
    PUT(struct_size);
    PUT(control_points);
    PUT(reweightings);
    PUT(margin);
    PUT(lambda_normal);
    PUT(lambda_smooth);
    PUT(distance_weight);
    PUT(tolerance);
    PUT(feasible);
    PUT(max_iterations);
    PUT(memory_limit);
    PUT(n_threads);
    PUT(reserved);
    PUT(progress);
    PUT(progress_data);
    PUT(reweighting);
    PUT(reserved_2);
    PUT(max_error);
    PUT(max_unknowns);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_fit_report
size_t layout_fit_report(size_t *offsets) {
    PUT(struct_size);
    PUT(dim);
    PUT(feasible);
    PUT(control_points);
    PUT(iterations);
    PUT(n_unknowns);
    PUT(n_points);
    PUT(bytes);
    PUT(box_min);
    PUT(box_max);
    PUT(diagonal);
    PUT(residual);
    PUT(seconds_assembly);
    PUT(seconds_solve);
    PUT(seconds_check);
    PUT(rms);
    PUT(max);
    PUT(mean_gradient);
    PUT(n_outliers);
    PUT(clear_sides);
    PUT(convergence_rate);
    PUT(n_levels);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_normal_options
size_t layout_normal_options(size_t *offsets) {
    PUT(struct_size);
    PUT(neighbours);
    PUT(n_threads);
    PUT(outlier_factor);
    PUT(memory_limit);
    PUT(progress);
    PUT(progress_data);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_normal_report
size_t layout_normal_report(size_t *offsets) {
    PUT(struct_size);
    PUT(n_components);
    PUT(n_copies);
    PUT(n_outliers);
    PUT(n_degenerate);
    PUT(n_doubtful);
    PUT(agreement);
    PUT(seconds);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_smooth_options
size_t layout_smooth_options(size_t *offsets) {
    PUT(struct_size);
    PUT(neighbours);
    PUT(rounds);
    PUT(n_threads);
    PUT(reserved);
    PUT(progress);
    PUT(progress_data);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_level_set_options
size_t layout_level_set_options(size_t *offsets) {
    PUT(struct_size);
    PUT(subdivisions);
    PUT(n_threads);
    PUT(shortest_edge);
    PUT(relaxations);
    PUT(reserved);
    PUT(memory_limit);
    PUT(progress);
    PUT(progress_data);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_certify_options
size_t layout_certify_options(size_t *offsets) {
    PUT(struct_size);
    PUT(tolerance);
    PUT(max_boxes);
    PUT(n_threads);
    PUT(reserved);
    PUT(progress);
    PUT(progress_data);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_certificate
size_t layout_certificate(size_t *offsets) {
    PUT(struct_size);
    PUT(threshold);
    PUT(largest_found);
    PUT(place);
    PUT(surface_error);
    PUT(steepest);
    PUT(steepest_beyond);
    PUT(n_boxes);
    PUT(n_components);
    PUT(side_certified);
    PUT(budget_reached);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_aggregation
size_t layout_aggregation(size_t *offsets) {
    PUT(struct_size);
    PUT(sharpness);
    PUT(kind);
    PUT(side);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_explicit_options
size_t layout_explicit_options(size_t *offsets) {
    PUT(struct_size);
    PUT(smoothing);
    PUT(softening);
    PUT(formulation);
    PUT(n_nearest);
    PUT(exponent);
    PUT(feasible);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_separation
size_t layout_separation(size_t *offsets) {
    PUT(struct_size);
    PUT(minimum_distance);
    PUT(intersection_length);
    PUT(distance_by_translation);
    PUT(length_by_translation);
    PUT(b_in_a);
    PUT(a_in_b);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_law
size_t layout_law(size_t *offsets) {
    PUT(struct_size);
    PUT(offset);
    PUT(slope);
    PUT(waves);
    PUT(n_waves);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_pair_options
size_t layout_pair_options(size_t *offsets) {
    PUT(struct_size);
    PUT(slack);
    PUT(n_steps);
    PUT(measure_steps);
    PUT(clearance);
    PUT(max_bytes);
    PUT(conflicts);
    PUT(n_threads);
    PUT(progress);
    PUT(progress_data);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_family_options
size_t layout_family_options(size_t *offsets) {
    PUT(struct_size);
    PUT(gap);
    PUT(symmetries);
    PUT(n_symmetries);
    PUT(symmetry_excess);
    PUT(n_threads);
    PUT(reserved);
    PUT(progress);
    PUT(progress_data);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_optimise_options
size_t layout_optimise_options(size_t *offsets) {
    PUT(struct_size);
    PUT(gamma);
    PUT(tolerance);
    PUT(feasibility);
    PUT(max_iterations);
    PUT(close_from);
    PUT(n_threads);
    PUT(reserved);
    PUT(progress);
    PUT(progress_data);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_pair_report
size_t layout_pair_report(size_t *offsets) {
    PUT(struct_size);
    PUT(n_cells);
    PUT(n_colliding);
    PUT(n_edges);
    PUT(graph_bytes);
    PUT(measure_steps);
    PUT(n_visits);
    PUT(measure_bytes);
    PUT(dim);
    PUT(has_graph);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_optimise_report
size_t layout_optimise_report(size_t *offsets) {
    PUT(struct_size);
    PUT(gamma);
    PUT(volumes);
    PUT(measures);
    PUT(change);
    PUT(n_iterations);
    PUT(converged);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_persistence_options
size_t layout_persistence_options(size_t *offsets) {
    PUT(struct_size);
    PUT(scale);
    PUT(gammas);
    PUT(n_times);
    PUT(max_tries);
    PUT(n_threads);
    PUT(reserved);
    PUT(progress);
    PUT(progress_data);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_arrange_options
size_t layout_arrange_options(size_t *offsets) {
    PUT(struct_size);
    PUT(max_rounds);
    PUT(max_starts);
    PUT(progress);
    PUT(progress_data);
    return sizeof(STRUCT);
}
#undef STRUCT

#define STRUCT ko_assembly_report
size_t layout_assembly_report(size_t *offsets) {
    PUT(struct_size);
    PUT(n_cells);
    PUT(n_meetings);
    PUT(n_edges);
    PUT(graph_bytes);
    PUT(n_parts);
    PUT(dim);
    return sizeof(STRUCT);
}
#undef STRUCT
