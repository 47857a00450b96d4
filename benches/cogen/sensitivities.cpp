// Measures and their sensitivities against sums over all cells and times, and against differences.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../points.hpp"
#include "../stats.hpp"
#include "pairs.hpp"

#include <cmath>

namespace bench {

namespace {

struct Gradients {
    std::vector<double> d21_d1, d21_d2, d12_d1, d12_d2;
};

std::array<double, 2> measures(const Pair &pair, const std::vector<double> &first, const std::vector<double> &second) {
    std::array<double, 2> g{};
    check(ko_pair_measures(pair.get(), first.data(), first.size(), second.data(), second.size(), 0, &g[0], &g[1]), "ko_pair_measures");
    return g;
}

Gradients gradients(const Pair &pair, const std::vector<double> &first, const std::vector<double> &second) {
    const std::size_t n_1 = first.size(), n_2 = second.size();
    Gradients by{std::vector<double>(n_1), std::vector<double>(n_2), std::vector<double>(n_1), std::vector<double>(n_2)};
    check(ko_pair_sensitivities(pair.get(), first.data(), n_1, second.data(), n_2, 0, by.d21_d1.data(), by.d21_d2.data(), by.d12_d1.data(),
                                by.d12_d2.data()),
          "ko_pair_sensitivities");
    return by;
}

// (29) and (30) by their definition: volumes of cells times the fraction of times at which their centres are in the other part.
std::array<double, 2> by_definition(const study &of, std::uint64_t steps, const std::vector<double> &first, const std::vector<double> &second) {
    std::array<double, 2> g{};
    for (std::uint64_t k = 0; k < steps; ++k) {
        const RelativePose pose = relative_pose(of, (static_cast<double>(k) + 0.5) / static_cast<double>(steps));
        for (std::size_t j = 0; j < of.n_cells[1]; ++j) {
            const std::size_t i = cell_at(of, 0, pose(center_of(of, 1, j).data()));
            if (i != NO_CELL) g[0] += first[i] * second[j];
        }
        for (std::size_t i = 0; i < of.n_cells[0]; ++i) {
            const std::size_t j = cell_at(of, 1, pose.back(center_of(of, 0, i).data()));
            if (j != NO_CELL) g[1] += first[i] * second[j];
        }
    }
    const double scale = std::pow(of.edge[0], of.dim) / static_cast<double>(steps);
    return {scale * g[0], scale * g[1]};
}

// The largest difference of a gradient to differences of g along random cells, over its largest entry.
double off(const Pair &pair, std::vector<double> first, std::vector<double> second, int which, int part, const std::vector<double> &gradient,
           Uniform &uniform) {
    std::vector<double> &moved = part == 0 ? first : second;
    double largest = 0, worst = 0;
    for (const double g : gradient) largest = std::max(largest, std::abs(g));
    for (int k = 0; k < 50; ++k) {
        const auto i = static_cast<std::size_t>(static_cast<double>(moved.size()) * uniform());
        const double at = moved[i];
        moved[i] = 1;
        const double above = measures(pair, first, second)[static_cast<std::size_t>(which)];
        moved[i] = 0;
        const double below = measures(pair, first, second)[static_cast<std::size_t>(which)];
        moved[i] = at;
        worst = std::max(worst, std::abs(above - below - gradient[i]) / largest);
    }
    return worst;
}

}  // namespace

void sensitivities(const Data &) {
    Uniform uniform(9);
    const std::uint64_t steps = 61;
    double measure = 0, difference = 0;
    for (const char *const *name = STUDIES; *name; ++name) {
        const Study of(*name, std::string(*name).find("3d") != std::string::npos || std::string(*name) == "bolt" ? 12 : 40);
        const Pair pair = paper_pair(of, steps);
        std::vector<double> first(of.n_cells[0]), second(of.n_cells[1]);
        for (double &x : first) x = uniform();
        for (double &x : second) x = uniform();
        const auto g = measures(pair, first, second), right = by_definition(of, steps, first, second);
        for (std::size_t k = 0; k < 2; ++k) measure = std::max(measure, std::abs(g[k] - right[k]) / right[k]);
        const Gradients by = gradients(pair, first, second);
        const std::vector<double> *of_gradients[2][2] = {{&by.d21_d1, &by.d21_d2}, {&by.d12_d1, &by.d12_d2}};
        for (int which = 0; which < 2; ++which)
            for (int part = 0; part < 2; ++part)
                difference = std::max(difference, off(pair, first, second, which, part, *of_gradients[which][part], uniform));
    }
    print("sensitivities_measures_off_definition", measure, "relative");
    print("sensitivities_off_differences", difference, "of the largest");
    print("sensitivities_limit", 1e-9, "");
    if (!(measure < 1e-9 && difference < 1e-9)) throw std::runtime_error("measures or sensitivities are off");
}

}  // namespace bench
