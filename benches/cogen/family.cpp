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

void print_gaps(const std::string &key, const Study &of, const Pair &pair, const Sets &sets) {
    double largest = 0, mean = 0;
    check(ko_pair_contact(pair.get(), sets[0].data(), of.n_cells[0], sets[1].data(), of.n_cells[1], of.steps, 0, nullptr, nullptr, nullptr,
                          nullptr, nullptr, &largest, &mean),
          "ko_pair_contact");
    print(key + "_largest_gap", largest);
    print(key + "_mean_gap", mean);
}

void print_family(const std::string &key, const Study &of, const Pair &pair, const Family &found) {
    double worst = 0;
    for (std::size_t k = 0; k < found.gammas.size(); ++k) {
        const double sum = found.volumes[2 * k] + found.volumes[2 * k + 1];
        const std::string at = key + "_gamma_" + named(found.gammas[k]);
        print(at + "_reached", found.reached[k]);
        print(at + "_total", sum);
        print(at + "_bound", found.bounds[k]);
        print_gaps(at, of, pair, found.sets[k]);
        worst = std::max(worst, 1 - sum / found.bounds[k]);
    }
    print(key + "_farthest_below_bound", worst, "of the bound");
}

// The largest pair, and one as large that keeps better in touch.
void persistence(const std::string &key, const Study &of, const Pair &pair) {
    const Cut cut = cut_of(pair);
    Sets next = of.none();
    double before = 0, after = 0;
    std::size_t n_tries = 0;
    const double time = seconds([&] {
        check(ko_pair_more_persistent(pair.get(), cut.cells[0].data(), cut.cells[1].data(), nullptr, nullptr, nullptr, of.n_cells[0],
                                      of.n_cells[1], next[0].data(), next[1].data(), &before, &after, &n_tries),
              "ko_pair_more_persistent");
    });
    print(key + "_persistence_before", before);
    print(key + "_persistence_after", after);
    print_count(key + "_persistence_tries", n_tries);
    print(key + "_persistence_time", time, "s");
    print_gaps(key, of, pair, cut.cells);
    print_gaps(key + "_more_persistent", of, pair, next);
}

}  // namespace

void family(const Data &) {
    for (const char *const name : {"gears", "cam", "cam_diamond"}) {
        const Study of(name, 0);
        const std::string key = std::string("family_") + name;
        const Pair safe = safe_pair(of), paper = paper_pair(of, of.steps);
        Family found;
        const double safe_time = seconds([&] { found = family_of(safe, papers_gammas()); });
        print_family(key, of, safe, found);
        print(key + "_time", safe_time, "s");
        const double paper_time = seconds([&] { found = family_of(paper, papers_gammas()); });
        print_family(key + "_by_the_papers_measure", of, paper, found);
        print(key + "_by_the_papers_measure_time", paper_time, "s");
        for (const double gamma : {0.2, 0.4, 0.5, 0.6, 0.8}) {
            Optimised by;
            const double time = seconds([&] { by = optimise(paper, gamma); });
            const std::string at = key + "_by_asymptotes_gamma_" + named(gamma);
            const auto g = measures_of(paper, by.cells);
            if (g[0] != 0 || g[1] != 0) throw std::runtime_error(at + " collides");
            print(at + "_reached", by.report.gamma);
            print(at + "_total", by.report.volumes[0] + by.report.volumes[1]);
            print_gaps(at, of, paper, by.cells);
            print_count(at + "_iterations", by.report.n_iterations);
            print(at + "_time", time, "s");
        }
        persistence(key + "_cut", of, safe);
    }
}

}  // namespace bench
