// Totals over gamma: pairs by minimum cuts, the bound that no pair passes, and moving asymptotes.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../stats.hpp"
#include "../timing.hpp"
#include "pairs.hpp"

#include <cmath>

namespace bench {

namespace {

std::string named(double gamma) {
    char text[16];
    std::snprintf(text, sizeof text, "%.1f", gamma);
    return text;
}

void print_family(const std::string &key, const Family &found) {
    double worst = 0;
    for (std::size_t k = 0; k < found.gammas.size(); ++k) {
        const double sum = found.volumes[2 * k] + found.volumes[2 * k + 1];
        const std::string of = key + "_gamma_" + named(found.gammas[k]);
        print(of + "_reached", found.reached[k]);
        print(of + "_total", sum);
        print(of + "_bound", found.bounds[k]);
        worst = std::max(worst, 1 - sum / found.bounds[k]);
    }
    print(key + "_farthest_below_bound", worst, "of the bound");
}

}  // namespace

void family(const Data &) {
    for (const char *const name : {"gears", "cam"}) {
        const Study of(name, 0);
        const std::string key = std::string("family_") + name;
        const Pair safe = safe_pair(of), paper = paper_pair(of, of.steps);
        Family found;
        const double safe_time = seconds([&] { found = family_of(safe, papers_gammas()); });
        print_family(key, found);
        print(key + "_time", safe_time, "s");
        const double paper_time = seconds([&] { found = family_of(paper, papers_gammas()); });
        print_family(key + "_by_the_papers_measure", found);
        print(key + "_by_the_papers_measure_time", paper_time, "s");
        for (const double gamma : {0.2, 0.4, 0.5, 0.6, 0.8}) {
            Optimised by;
            const double time = seconds([&] { by = optimise(paper, gamma); });
            const std::string at = key + "_by_asymptotes_gamma_" + named(gamma);
            const auto g = measures_of(paper, by.cells);
            if (g[0] != 0 || g[1] != 0) throw std::runtime_error(at + " collides");
            print(at + "_reached", by.report.gamma);
            print(at + "_total", by.report.volumes[0] + by.report.volumes[1]);
            print_count(at + "_iterations", by.report.n_iterations);
            print(at + "_time", time, "s");
        }
    }
}

}  // namespace bench
