// Keepout's pairs of parts as the bench uses them, and the paper's cases.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include "../library.hpp"

extern "C" {
#include "../../examples/cogen/cases.h"
}

namespace bench {

struct FreePair {
    void operator()(ko_pair *pair) const { ko_pair_free(pair); }
};
using Pair = std::unique_ptr<ko_pair, FreePair>;
using Set = std::vector<std::uint8_t>;
using Sets = std::array<Set, 2>;

// A case of the paper.
struct Study : study {
    Study(const char *name, std::size_t cells) {
        if (!study_make(name, cells, this)) throw std::runtime_error(std::string("there is no case ") + name);
    }
    Study(const Study &) = delete;
    Study &operator=(const Study &) = delete;
    ~Study() { study_free(this); }
    Sets none() const { return {Set(n_cells[0]), Set(n_cells[1])}; }
};

inline ko_pair_options pair_options() {
    ko_pair_options options;
    check(ko_pair_options_init(&options, sizeof options), "ko_pair_options_init");
    return options;
}

inline Pair pair_of(const study &of, const ko_pair_options &options) {
    ko_pair *pair = nullptr;
    check(ko_pair_create(of.parts[0], of.motions[0], of.parts[1], of.motions[1], &options, &pair), "ko_pair_create");
    return Pair(pair);
}

// The conflicts that are the default.
inline Pair safe_pair(const study &of) { return pair_of(of, pair_options()); }

// Those of the paper's measure, with `steps` times, and the measure.
inline Pair paper_pair(const study &of, std::uint64_t steps) {
    ko_pair_options options = pair_options();
    options.conflicts = KO_CONFLICTS_OF_MEASURE;
    options.measure_steps = steps;
    return pair_of(of, options);
}

inline ko_pair_report report_of(const Pair &pair) {
    ko_pair_report report{};
    check(ko_pair_get_report(pair.get(), sizeof report, &report), "ko_pair_get_report");
    return report;
}

struct Cut {
    Sets cells;
    double weight, bound, gamma;
};

inline Cut cut_of(const Pair &pair, const double *weights_1 = nullptr, const double *weights_2 = nullptr) {
    const ko_pair_report report = report_of(pair);
    Cut cut{{Set(report.n_cells[0]), Set(report.n_cells[1])}, 0, 0, 0};
    check(ko_pair_cut(pair.get(), weights_1, weights_2, nullptr, report.n_cells[0], report.n_cells[1], cut.cells[0].data(),
                      cut.cells[1].data(), &cut.weight, &cut.bound, &cut.gamma),
          "ko_pair_cut");
    return cut;
}

inline Sets close(const Pair &pair, const Sets &sets, std::uint32_t from) {
    const std::size_t n[2] = {sets[0].size(), sets[1].size()};
    Sets closed{Set(n[0]), Set(n[1])};
    check(ko_pair_close(pair.get(), sets[0].data(), sets[1].data(), from, n[0], n[1], closed[0].data(), closed[1].data(), nullptr),
          "ko_pair_close");
    return closed;
}

struct Family {
    std::vector<double> gammas, reached, volumes, bounds;
    std::vector<Sets> sets;
};

inline Family family_of(const Pair &pair, std::vector<double> gammas) {
    const ko_pair_report report = report_of(pair);
    const std::size_t n = gammas.size(), n_1 = report.n_cells[0], n_2 = report.n_cells[1];
    Family found{std::move(gammas), std::vector<double>(n), std::vector<double>(2 * n), std::vector<double>(n), {}};
    Set first(n * n_1), second(n * n_2);
    check(ko_pair_family(pair.get(), nullptr, nullptr, found.gammas.data(), n, nullptr, n_1, n_2, first.data(), second.data(),
                         found.reached.data(), found.volumes.data(), found.bounds.data()),
          "ko_pair_family");
    const auto row = [](const Set &sets, std::size_t k, std::size_t m) {
        return Set(sets.begin() + static_cast<std::ptrdiff_t>(k * m), sets.begin() + static_cast<std::ptrdiff_t>((k + 1) * m));
    };
    for (std::size_t k = 0; k < n; ++k) found.sets.push_back({row(first, k, n_1), row(second, k, n_2)});
    return found;
}

// Eleven, from 0 to 1, as in the paper.
inline std::vector<double> papers_gammas() {
    std::vector<double> gammas;
    for (int k = 0; k <= 10; ++k) gammas.push_back(0.1 * k);
    gammas.back() = 1;
    return gammas;
}

struct Optimised {
    Sets cells;
    ko_optimise_report report;
};

inline Optimised optimise(const Pair &pair, double gamma) {
    ko_optimise_options options;
    check(ko_optimise_options_init(&options, sizeof options), "ko_optimise_options_init");
    options.gamma = gamma;
    const ko_pair_report of = report_of(pair);
    Optimised found{{Set(of.n_cells[0]), Set(of.n_cells[1])}, {}};
    check(ko_pair_optimise(pair.get(), &options, of.n_cells[0], of.n_cells[1], nullptr, nullptr, found.cells[0].data(),
                           found.cells[1].data(), nullptr, sizeof found.report, &found.report),
          "ko_pair_optimise");
    return found;
}

// g_21 and g_12 of sets of cells.
inline std::array<double, 2> measures_of(const Pair &pair, const Sets &sets) {
    const std::vector<double> first(sets[0].begin(), sets[0].end()), second(sets[1].begin(), sets[1].end());
    std::array<double, 2> g{};
    check(ko_pair_measures(pair.get(), first.data(), first.size(), second.data(), second.size(), 0, &g[0], &g[1]), "ko_pair_measures");
    return g;
}

inline std::size_t count(const Set &set) {
    std::size_t n = 0;
    for (const std::uint8_t is : set) n += is;
    return n;
}

// A pose of part 2 as seen from part 1: p_1 = turn p_2 + shift; the third axis stands still in the plane.
struct RelativePose {
    double turn[9], shift[3];

    std::array<double, 3> operator()(const double *p) const {
        std::array<double, 3> q;
        for (int i = 0; i < 3; ++i) q[i] = turn[3 * i] * p[0] + turn[3 * i + 1] * p[1] + turn[3 * i + 2] * p[2] + shift[i];
        return q;
    }
    std::array<double, 3> back(const double *q) const {
        std::array<double, 3> p;
        for (int i = 0; i < 3; ++i) {
            p[i] = 0;
            for (int j = 0; j < 3; ++j) p[i] += turn[3 * j + i] * (q[j] - shift[j]);
        }
        return p;
    }
};

RelativePose relative_pose(const study &of, double time);

// The centre of a cell in its part's frame.
inline std::array<double, 3> center_of(const study &of, int part, std::size_t cell) {
    std::array<double, 3> center{};
    for (int a = 2; a >= 0; --a) {
        const std::size_t n = of.counts[part][a];
        if (static_cast<std::uint32_t>(a) < of.dim) center[a] = of.corner[part][a] + of.edge[part] * (static_cast<double>(cell % n) + 0.5);
        cell /= n;
    }
    return center;
}

constexpr std::size_t NO_CELL = static_cast<std::size_t>(-1);

// The cell that a point of a part's frame lies in.
inline std::size_t cell_at(const study &of, int part, const std::array<double, 3> &p) {
    std::size_t cell = 0;
    for (std::uint32_t a = 0; a < of.dim; ++a) {
        const double at = (p[a] - of.corner[part][a]) / of.edge[part];
        if (!(at >= 0 && at < static_cast<double>(of.counts[part][a]))) return NO_CELL;
        cell = cell * of.counts[part][a] + static_cast<std::size_t>(at);
    }
    return cell;
}

}  // namespace bench
