// What the unit of length changes: nothing.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "common.hpp"

#include <cstring>

namespace bench {

namespace {

// phi / D of a cloud and of the same cloud in another unit, at corresponding points.
void scale_of(const Cloud &cloud) {
    std::vector<double> points(3 * N_SAMPLES), normals(3 * N_SAMPLES);
    check(ko_cloud_copy(cloud.get(), N_SAMPLES, points.data(), normals.data()), "ko_cloud_copy");
    const auto scaled = [](std::vector<double> numbers, double factor) {
        for (double &number : numbers) number *= factor;
        return numbers;
    };
    const auto fit_scaled = [&](double factor, double tolerance) {
        ko_fit_options options = options_of(BUNNY_GRID);
        if (tolerance > 0) options.tolerance = tolerance;
        return fit(cloud_from(3, scaled(points, factor), normals), options);
    };
    const auto relative = [&](const Field &field, const std::vector<double> &at, double factor) {
        return scaled(values_of(field, scaled(at, factor)), 1 / report_of(field).diagonal);
    };

    const Field as_it_is = fit_scaled(1, 0);
    const std::vector<double> at = draw_in_box(report_of(as_it_is), 10000, IN_BOX);
    const std::vector<double> expected = relative(as_it_is, at, 1);
    for (const auto &[key, factor] : {std::pair{"2^10", 0x1p10}, {"2^-10", 0x1p-10}}) {
        const std::vector<double> found = relative(fit_scaled(factor, 0), at, factor);
        std::uint64_t differing = 0;
        for (std::size_t i = 0; i < at.size() / 3; ++i) differing += std::memcmp(&found[i], &expected[i], sizeof(double)) != 0;
        print_count(std::string("scale_") + key + "_values_that_differ", differing, "of 10000");
        print_count(std::string("scale_") + key + "_values_that_differ_limit", 0, "of 10000");
    }
    const std::vector<double> tight = relative(fit_scaled(1, 1e-12), at, 1);
    for (const auto &[key, factor] : {std::pair{"1e3", 1e3}, {"1e-3", 1e-3}}) {
        const std::vector<double> found = relative(fit_scaled(factor, 1e-12), at, factor);
        Errors errors;
        for (std::size_t i = 0; i < found.size(); ++i) errors.add(found[i] - tight[i]);
        print(std::string("scale_") + key + "_largest_difference", errors.max(), "D");
        print(std::string("scale_") + key + "_largest_difference_limit", 1e-9, "D");
    }
}

}  // namespace

void scale(const Data &data) { scale_of(sample(read_mesh(data(BUNNY)), N_SAMPLES)); }

}  // namespace bench
