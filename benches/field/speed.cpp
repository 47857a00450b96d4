// Time of a fit, and of evaluations beside CGAL's closest point.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "common.hpp"
#include "../timing.hpp"

namespace bench {

namespace {

// The fit's time, by the clock around the call.
void fit_time(const Cloud &cloud) {
    const Pinned pinned;
    std::vector<double> runs, processor;
    for (int i = 0; i < 3; ++i) {
        runs.push_back(seconds([&] {
            processor.push_back(processor_seconds([&] { fit(cloud, options_of(BUNNY_GRID)); }));
        }));
    }
    print("bunny_fit_seconds_fastest_of_3", minimum(runs), "s");
    print("bunny_fit_seconds_median_of_3", median(runs), "s");
    print("bunny_fit_seconds_limit", 3, "s");
    print("bunny_fit_processor_seconds_fastest_of_3", minimum(processor), "s");
}

// An evaluation beside a closest point of CGAL's, round by round, since other programs share the machine.
void eval_time(const Shape &bunny, const Cloud &cloud) {
    const Field field = fit(cloud, options_of(BUNNY_GRID));
    const std::vector<double> points = draw_in_box(report_of(field), N_POINTS, IN_BOX);
    const ClosestPoints closest(facets_of(bunny.mesh));
    std::vector<double> values(N_POINTS), gradients(3 * N_POINTS), hessians(6 * N_POINTS), distances(N_POINTS);
    const auto per_point = [](double time) { return time / static_cast<double>(N_POINTS) * 1e9; };

    std::vector<double> ours, peer, ratios, value, hessian, parallel;
    for (int round = 0; round < 5; ++round) {
        {
            const Pinned pinned;
            ours.push_back(per_point(seconds([&] { eval(field, points, values.data(), gradients.data()); })));
            peer.push_back(per_point(seconds([&] {
                for (std::size_t i = 0; i < N_POINTS; ++i) distances[i] = closest.distance(&points[3 * i]);
            })));
            ratios.push_back(peer.back() / ours.back());
            value.push_back(per_point(seconds([&] { eval(field, points, values.data()); })));
            hessian.push_back(
                per_point(seconds([&] { eval(field, points, values.data(), gradients.data(), hessians.data()); })));
        }
        parallel.push_back(per_point(seconds([&] {
            check(ko_field_eval_parallel(field.get(), points.data(), N_POINTS, values.data(), gradients.data(), nullptr, 2),
                  "ko_field_eval_parallel");
        })));
    }
    print_count("eval_points", N_POINTS, "uniform in the box");
    print("eval_value_and_gradient", median(ours), "ns/point");
    print("eval_cgal_closest_point_and_primitive", median(peer), "ns/point");
    print("eval_times_faster_than_cgal_median_of_5", median(ratios));
    print("eval_times_faster_than_cgal_limit", 100);
    print("eval_value_only", median(value), "ns/point");
    print("eval_value_gradient_and_hessian", median(hessian), "ns/point");
    print("eval_value_and_gradient_2_threads", median(parallel), "ns/point");
    signed_distances(bunny.mesh, {points[0], points[1], points[2]});  // builds the mesh's tree
    print("mesh_signed_distance", per_point(seconds([&] { signed_distances(bunny.mesh, points); })), "ns/point");
    // Both sought the same surface: how far they are apart near it, so that speed is not told without accuracy.
    Errors near;
    const double D = report_of(field).diagonal;
    for (std::size_t i = 0; i < N_POINTS; ++i)
        if (distances[i] < 0.01 * D) near.add((std::abs(values[i]) - distances[i]) / D);
    print("eval_against_cgal_within_0.01_rms", near.rms(), "D");
}

}  // namespace

void speed(const Data &data) {
    const Shape bunny(data(BUNNY));
    const Cloud cloud = sample(bunny.mesh, N_SAMPLES);
    fit_time(cloud);
    eval_time(bunny, cloud);
}

void fit_only(const Data &data) { fit(sample(read_mesh(data(BUNNY)), N_SAMPLES), options_of(BUNNY_GRID)); }

}  // namespace bench
