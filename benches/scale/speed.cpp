// Evaluation beside the floor, round by round, since other programs share the machine: the least time of each over the rounds.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../library.hpp"
#include "../measure.hpp"
#include "../points.hpp"
#include "../stats.hpp"
#include "../timing.hpp"
#include "floor.hpp"

#include <functional>
#include <limits>
#include <stdexcept>
#include <thread>

namespace bench {

namespace {

constexpr Counts IN_CACHE = {32, 31, 25};  // the paper's 24,800
constexpr Counts OUT_OF_CACHE = {256, 256, 256};
constexpr double LOWER[3] = {-1, -1.1, -1.2}, UPPER[3] = {1, 1.2, 1.3};
const char *const ORDERS[] = {"value", "gradient", "hessian"};  // each with those before it

// A field with the control points that the floor reads: its own copy.
struct Subjects {
    std::vector<double> control_points;
    Field field;
    FloorField floor;

    explicit Subjects(Counts counts) : control_points(std::size_t{1} * counts[0] * counts[1] * counts[2]) {
        // Waves of a few cells and more, so that neighbours differ.
        std::size_t at = 0;
        for (std::uint32_t i = 0; i < counts[0]; ++i)
            for (std::uint32_t j = 0; j < counts[1]; ++j)
                for (std::uint32_t k = 0; k < counts[2]; ++k)
                    control_points[at++] = std::sin(0.9 * i) + std::cos(0.7 * j + 0.3 * i) + std::sin(1.1 * k - 0.2 * j);
        ko_field *made = nullptr;
        check(ko_field_from_control_points(3, counts.data(), LOWER, UPPER, KO_FEASIBLE_OUTSIDE, 1, control_points.data(),
                                           control_points.size(), &made),
              "ko_field_from_control_points");
        field.reset(made);
        floor.control_points = control_points.data();
        for (int a = 0; a < 3; ++a) {
            floor.counts[a] = counts[a];
            floor.lower[a] = LOWER[a];
            floor.cell[a] = (UPPER[a] - LOWER[a]) / (counts[a] - 3.0);
        }
    }
};

// Room for all outputs.
struct Room {
    std::vector<double> values, gradients, hessians;

    explicit Room(std::size_t n) : values(n), gradients(3 * n), hessians(6 * n) {}
    double *gradients_of(int order) { return order >= 1 ? gradients.data() : nullptr; }
    double *hessians_of(int order) { return order >= 2 ? hessians.data() : nullptr; }
};

std::vector<double> uniform_points(std::size_t n) {
    Uniform uniform(7);
    std::vector<double> points(3 * n);
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = LOWER[i % 3] + uniform() * (UPPER[i % 3] - LOWER[i % 3]);
    return points;
}

// Along a closed curve, in steps of a small part of a cell.
std::vector<double> path_points(std::size_t n) {
    std::vector<double> points(3 * n);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double turn = static_cast<double>(i / 3) / (1000.0 + 300.0 * static_cast<double>(i % 3));
        points[i] = LOWER[i % 3] + (0.5 + 0.49 * std::sin(6.2831853 * turn)) * (UPPER[i % 3] - LOWER[i % 3]);
    }
    return points;
}

// `points` brick after brick of 16 cells.
std::vector<double> sorted_points(const std::vector<double> &points, const FloorField &of) {
    std::vector<std::pair<std::uint64_t, std::size_t>> order(points.size() / 3);
    for (std::size_t i = 0; i < order.size(); ++i) {
        std::uint64_t brick = 0;
        for (int a = 0; a < 3; ++a) brick = 4096 * brick + static_cast<std::uint64_t>((points[3 * i + a] - of.lower[a]) / of.cell[a]) / 16;
        order[i] = {brick, i};
    }
    std::sort(order.begin(), order.end());
    std::vector<double> sorted;
    for (const auto &[brick, i] : order) sorted.insert(sorted.end(), &points[3 * i], &points[3 * i] + 3);
    return sorted;
}

double largest_difference(const std::vector<double> &a, const std::vector<double> &b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

// The least nanoseconds a point of each of `works` over `rounds` in which they take turns.
std::vector<double> least_times(const std::vector<std::function<void()>> &works, std::size_t n_points, int rounds) {
    std::vector<double> least(works.size(), std::numeric_limits<double>::infinity());
    for (int round = 0; round < rounds; ++round)
        for (std::size_t i = 0; i < works.size(); ++i)
            least[i] = std::min(least[i], seconds(works[i]) * 1e9 / static_cast<double>(n_points));
    return least;
}

// Ours, the floor and how they compare, for all three orders on one thread.
void beside_floor(const std::string &key, const Subjects &of, const std::vector<double> &points, int rounds) {
    const Pinned pinned;
    const std::size_t n = points.size() / 3;
    Room ours(n), theirs(n);
    std::vector<std::function<void()>> works;
    for (int order = 0; order < 3; ++order) {
        works.emplace_back([&, order] {
            eval(of.field, points, ours.values.data(), ours.gradients_of(order), ours.hessians_of(order));
        });
        works.emplace_back([&, order] {
            if (has_floor() && floor_eval(of.floor, points.data(), n, theirs.values.data(), theirs.gradients_of(order),
                                          theirs.hessians_of(order)) != n)
                throw std::runtime_error("the floor refused a point");
        });
    }
    const std::vector<double> least = least_times(works, n, rounds);
    for (std::size_t order = 0; order < 3; ++order) {
        const std::string name = key + "_" + ORDERS[order];
        print(name, least[2 * order], "ns/point");
        if (!has_floor()) continue;
        print(name + "_floor", least[2 * order + 1], "ns/point");
        print(name + "_over_floor", least[2 * order] / least[2 * order + 1]);
    }
    print(key + "_hessian_over_gradient", least[4] / least[2]);
    if (!has_floor()) return;
    print(key + "_largest_difference_of_values", largest_difference(ours.values, theirs.values));
    print(key + "_largest_difference_of_gradients", largest_difference(ours.gradients, theirs.gradients));
    print(key + "_largest_difference_of_hessians", largest_difference(ours.hessians, theirs.hessians));
}

// One thread, two of the library's, and two of the caller's with half of the points each: what this machine gives at the time.
void on_two_threads(const std::string &key, const Subjects &of, const std::vector<double> &points, int rounds) {
    const std::size_t n = points.size() / 3, half = n / 2;
    Room room(n);
    double *values = room.values.data(), *gradients = room.gradients.data();
    const auto by_library = [&](std::uint32_t n_threads) {
        check(ko_field_eval_parallel(of.field.get(), points.data(), n, values, gradients, nullptr, n_threads), "ko_field_eval_parallel");
    };
    std::int32_t status[2];
    const auto from = [&](int thread, std::size_t first, std::size_t count) {
        status[thread] = ko_field_eval(of.field.get(), &points[3 * first], count, values + first, gradients + 3 * first, nullptr);
    };
    const std::vector<double> least = least_times({[&] { by_library(1); }, [&] { by_library(2); },
                                                   [&] {
                                                       std::thread other([&] { from(0, 0, half); });
                                                       from(1, half, n - half);
                                                       other.join();
                                                       if (status[0] || status[1]) throw std::runtime_error("ko_field_eval failed");
                                                   }},
                                                  n, rounds);
    print(key + "_gradient_1_thread", least[0], "ns/point");
    print(key + "_gradient_2_threads", least[1], "ns/point");
    print(key + "_times_faster_on_2_threads", least[0] / least[1]);
    print(key + "_times_faster_on_2_threads_of_the_caller", least[0] / least[2]);
}

// A field of three levels beside that of one grid, at points all over the box and at some of its surface, where its cells are short.
void refined(const Data &data, const Subjects &of, std::size_t n, int rounds) {
    const Mesh mesh = read_mesh(data("stanford/armadillo_cgal.off"));
    const Cloud cloud = sample(mesh, 50000);
    ko_fit_options options = options_of();
    options.max_error = 3e-3;
    options.tolerance = 1e-3;
    const Field field = fit(cloud, options);
    const ko_fit_report report = report_of(field);
    print("speed_refined_levels", static_cast<double>(report.n_levels));
    print("speed_refined_control_points", static_cast<double>(report.n_unknowns));
    print("speed_refined_megabytes", report.bytes / 1e6, "MB");
    std::vector<double> in_box = uniform_points(n), at_surface = draw_by_area(facets_of(mesh), n, /*seed*/ 3).points;
    for (std::size_t i = 0; i < in_box.size(); ++i) {
        const std::size_t a = i % 3;
        const double part = (in_box[i] - LOWER[a]) / (UPPER[a] - LOWER[a]);
        in_box[i] = report.box_min[a] + part * (report.box_max[a] - report.box_min[a]);
    }
    const std::vector<double> plain = uniform_points(n);
    const Pinned pinned;
    Room room(n);
    for (const bool all_over : {true, false}) {
        const std::vector<double> &points = all_over ? in_box : at_surface;
        const std::size_t count = std::min(n, points.size() / 3);
        std::vector<std::function<void()>> works;
        for (int order = 0; order < 3; ++order)
            for (const bool one_grid : {true, false})
                works.emplace_back([&, order, one_grid] {
                    check(ko_field_eval(one_grid ? of.field.get() : field.get(), one_grid ? plain.data() : points.data(), count,
                                        room.values.data(), room.gradients_of(order), room.hessians_of(order)),
                          "ko_field_eval");
                });
        const std::vector<double> least = least_times(works, count, rounds);
        for (std::size_t order = 0; order < 3; ++order) {
            const std::string name = std::string("speed_refined_") + (all_over ? "in_box_" : "at_surface_") + ORDERS[order];
            print(name, least[2 * order + 1], "ns/point");
            print(name + "_over_one_grid", least[2 * order + 1] / least[2 * order]);
        }
    }
}

}  // namespace

void speed(const Data &data) {
    print("speed_floor_flags", std::string(BENCH_FLOOR_FLAGS));
    constexpr std::size_t FEW = 100000, MANY = 1000000;
    {
        const Subjects small(IN_CACHE);
        print_count("speed_in_cache_control_points", small.control_points.size());
        print_count("speed_in_cache_points", FEW);
        beside_floor("speed_in_cache_uniform", small, uniform_points(FEW), 60);
        beside_floor("speed_in_cache_path", small, path_points(FEW), 60);
        print_count("speed_threads_points", MANY);
        on_two_threads("speed_in_cache", small, uniform_points(MANY), 20);
        refined(data, small, FEW, 20);
    }
    const Subjects large(OUT_OF_CACHE);
    const std::vector<double> points = uniform_points(MANY);
    print_count("speed_out_of_cache_control_points", large.control_points.size());
    print_count("speed_out_of_cache_points", MANY);
    // The floor reads rows as they come, from memory as the allocator gives it.
    beside_floor("speed_out_of_cache_uniform", large, points, 5);
    beside_floor("speed_out_of_cache_sorted_by_caller", large, sorted_points(points, large.floor), 5);
    on_two_threads("speed_out_of_cache", large, points, 5);
}

}  // namespace bench
