// How time and memory grow with the field.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../timing.hpp"
#include "common.hpp"

namespace bench {

// Sizes a factor 8 apart in control points; samples grow as the surface in cells does, by 4.
void growth(const Data &data) {
    const Mesh bunny = read_mesh(data(BUNNY));
    const struct {
        Counts grid;
        std::size_t samples;
    } sizes[] = {{{16, 16, 12}, 6250}, {BUNNY_GRID, 25000}, {{64, 62, 50}, 100000}};
    const char *const keys[] = {"growth_3k", "growth_25k", "growth_200k"};
    double n[3], time[3], iterations[3];
    const Pinned pinned;
    for (int i = 0; i < 3; ++i) {
        const Field field = fit(sample(bunny, sizes[i].samples), options_of(sizes[i].grid));
        const ko_fit_report report = report_of(field);
        n[i] = static_cast<double>(report.n_unknowns), time[i] = seconds_of(report), iterations[i] = report.iterations;
        print_fit(keys[i], field);
        print_count(std::string(keys[i]) + "_field_bytes", report.bytes, "bytes");
        const std::vector<double> points = draw_in_box(report, N_POINTS, IN_BOX);
        std::vector<double> values(N_POINTS), gradients(3 * N_POINTS), times;
        for (int round = 0; round < 5; ++round)
            times.push_back(seconds([&] { eval(field, points, values.data(), gradients.data()); }));
        print(std::string(keys[i]) + "_eval_value_and_gradient", median(times) / N_POINTS * 1e9, "ns/point");
    }
    const auto exponent = [&](const double *y, int from, int to) { return std::log(y[to] / y[from]) / std::log(n[to] / n[from]); };
    print("growth_fit_seconds_exponent_3k_25k", exponent(time, 0, 1));
    print("growth_fit_seconds_exponent_25k_200k", exponent(time, 1, 2));
    print("growth_fit_seconds_exponent", exponent(time, 0, 2));
    print("growth_fit_iterations_exponent", exponent(iterations, 0, 2));
}

}  // namespace bench
