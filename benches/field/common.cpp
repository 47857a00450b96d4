// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "common.hpp"

namespace bench {

std::string text(Counts counts) {
    return std::to_string(counts[0]) + "x" + std::to_string(counts[1]) + (counts[2] ? "x" + std::to_string(counts[2]) : "");
}

double seconds_of(const ko_fit_report &report) {
    return report.seconds_assembly + report.seconds_solve + report.seconds_check;
}

void print_fit(const std::string &key, const Field &field) {
    const ko_fit_report report = report_of(field);
    print(key + "_control_points", text({report.control_points[0], report.control_points[1], report.control_points[2]}));
    print_count(key + "_samples", report.n_points);
    print_count(key + "_fit_iterations", report.iterations);
    print(key + "_fit_seconds", seconds_of(report), "s");
}

void print_errors(const std::string &key, const Errors &errors, Limits limit, const char *suffix) {
    print(key + "_rms", errors.rms(), "D");
    if (limit.rms > 0) print(key + "_rms" + suffix, limit.rms, "D");
    print(key + "_max", errors.max(), "D");
    if (limit.max > 0) print(key + "_max" + suffix, limit.max, "D");
}

void print_on_surface(const std::string &key, const OnSurface &found, Limits limit) {
    print_errors(key + "_on_surface", found.phi, limit);
    print_errors(key + "_on_surface_over_gradient", found.distance, limit);
    print(key + "_mean_gradient", found.mean_gradient);
}

void print_paper(const std::string &key, Limits paper) {
    print(key + "_on_surface_rms_paper", paper.rms, "D");
    print(key + "_on_surface_max_paper", paper.max, "D");
}

void print_signs(const std::string &key, const Signs &signs, std::size_t n_points) {
    print_count(key + "_points_beyond_a_cell", signs.far, ("of " + std::to_string(n_points)).c_str());
    print_count(key + "_wrong_beyond_a_cell", signs.wrong_far, "points");
    print_count(key + "_wrong_beyond_a_cell_limit", 0, "points");
    print_count(key + "_wrong_anywhere", signs.wrong, "points");
    print(key + "_farthest_wrong", signs.farthest_wrong, "cells");
}

Signs signs_in_box(const Field &field, const Mesh &mesh, std::size_t n_points) {
    const std::vector<double> points = draw_in_box(report_of(field), n_points, IN_BOX);
    return signs_of(field, points, exact_distances(mesh, points));
}

}  // namespace bench
