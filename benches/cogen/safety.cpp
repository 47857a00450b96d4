// Whether pairs that never collide by the library's word do collide between its samples: points of kept cells, 3 along each edge, at times four
// times as fine as the paper's, looked up in the other part; and whole cells at random times, by separating axes that are worked out here.
// Beside them the paper's measure, whose pairs do.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../points.hpp"
#include "../stats.hpp"
#include "pairs.hpp"

#include <cmath>

namespace bench {

namespace {

constexpr std::size_t TIMES = 2000;
// Points looked up of a case, about: beyond it a cell is looked at at some of the times only, at random.
constexpr double LOOKUPS = 3e9;

// Cells of a set with a neighbour, across a corner even, that is not of it: others are met after these.
std::vector<std::size_t> rim_of(const study &of, int part, const Set &set) {
    std::vector<std::size_t> rim;
    const std::size_t *n = of.counts[part];
    for (std::size_t i = 0; i < set.size(); ++i) {
        if (!set[i]) continue;
        const std::size_t place[3] = {i / (n[1] * n[2]), i / n[2] % n[1], i % n[2]};
        bool inner = true;
        for (int k = 0; inner && k < 27; ++k) {
            std::size_t at = 0;
            bool within = true;
            int rest = k;
            for (std::uint32_t a = 0; a < 3; ++a) {
                const int by = rest % 3 - 1;
                rest /= 3;
                if (a >= of.dim) continue;
                within = within && !(by < 0 && place[a] == 0) && !(by > 0 && place[a] + 1 == n[a]);
                at = at * n[a] + place[a] + static_cast<std::size_t>(by);
            }
            inner = within && set[at];
        }
        if (!inner) rim.push_back(i);
    }
    return rim;
}

struct Overlap {
    std::uint64_t looked_up = 0, inside = 0;
    std::size_t cells = 0, bad_cells = 0;  // of part 2, on the rim
};

Overlap look_up(const study &of, const Sets &sets, Uniform &uniform) {
    const std::vector<std::size_t> rim = rim_of(of, 1, sets[1]);
    const int per_cell = of.dim == 2 ? 9 : 27;
    const std::uint64_t times = 4 * of.steps;
    const double chance = std::min(1.0, LOOKUPS / (static_cast<double>(rim.size()) * per_cell * static_cast<double>(times)));
    std::vector<bool> is_bad(rim.size());
    Overlap found;
    found.cells = rim.size();
    for (std::uint64_t k = 0; k < times; ++k) {
        const RelativePose pose = relative_pose(of, (static_cast<double>(k) + 0.5) / static_cast<double>(times));
        for (std::size_t c = 0; c < rim.size(); ++c) {
            if (chance < 1 && uniform() >= chance) continue;
            const auto center = center_of(of, 1, rim[c]);
            for (int s = 0; s < per_cell; ++s) {
                double p[3] = {center[0], center[1], center[2]};
                for (int a = 0, rest = s; a < static_cast<int>(of.dim); ++a, rest /= 3) p[a] += of.edge[1] * (rest % 3 - 1) / 3;
                const std::size_t i = cell_at(of, 0, pose(p));
                if (i == NO_CELL || !sets[0][i]) continue;
                ++found.inside;
                is_bad[c] = true;
            }
            found.looked_up += static_cast<std::uint64_t>(per_cell);
        }
    }
    for (const bool bad : is_bad) found.bad_cells += bad;
    return found;
}

// How deep two cells are in each other, in cells: the least overlap of their shadows over the axes that can separate boxes. `off` is from one's
// centre to the other's, `turn` the other's axes in columns.
double depth(const double *off, const double *turn, std::uint32_t dim) {
    double least = 1e300;
    const auto along = [&](const double *n) {
        double length = 0, reach = 0, distance = 0;
        for (int a = 0; a < 3; ++a) length += n[a] * n[a];
        if (length < 1e-12) return;
        length = std::sqrt(length);
        for (std::uint32_t a = 0; a < dim; ++a) {
            double other = 0;
            for (int i = 0; i < 3; ++i) other += turn[3 * i + static_cast<int>(a)] * n[i];
            reach += 0.5 * (std::abs(n[a]) + std::abs(other));
            distance += off[a] * n[a];
        }
        least = std::min(least, (reach - std::abs(distance)) / length);
    };
    double own[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, others[3][3];
    for (int a = 0; a < 3; ++a)
        for (int i = 0; i < 3; ++i) others[a][i] = turn[3 * i + a];
    for (std::uint32_t a = 0; a < dim; ++a) {
        along(own[a]);
        along(others[a]);
        for (std::uint32_t b = 0; dim == 3 && b < dim; ++b) {
            const double *u = own[a], *v = others[b];
            const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
            along(n);
        }
    }
    return least;
}

struct Depth {
    double deepest = -1e300;  // in cells, below 0 where parts are apart
    std::uint64_t pairs = 0;
};

Depth deepest(const study &of, const Sets &sets, Uniform &uniform) {
    const std::vector<std::size_t> rim = rim_of(of, 1, sets[1]);
    const double share = std::min(1.0, 2e4 / static_cast<double>(rim.size()));
    const int reach = of.dim == 2 ? 1 : 2;  // half of both diagonals, rounded up, less half a cell
    Depth found;
    for (std::size_t k = 0; k < TIMES; ++k) {
        const RelativePose pose = relative_pose(of, uniform());
        for (const std::size_t cell : rim) {
            if (share < 1 && uniform() >= share) continue;
            const auto at = pose(center_of(of, 1, cell).data());
            double in_cells[3] = {0, 0, 0};
            long middle[3] = {0, 0, 0};
            for (std::uint32_t a = 0; a < of.dim; ++a) {
                in_cells[a] = (at[a] - of.corner[0][a]) / of.edge[0] - 0.5;
                middle[a] = std::lround(in_cells[a]);
            }
            long by[3];
            for (by[0] = -reach; by[0] <= reach; ++by[0])
                for (by[1] = -reach; by[1] <= reach; ++by[1])
                    for (by[2] = of.dim == 3 ? -reach : 0; by[2] <= (of.dim == 3 ? reach : 0); ++by[2]) {
                        std::size_t i = 0;
                        bool within = true;
                        double off[3] = {0, 0, 0};
                        for (std::uint32_t a = 0; a < of.dim; ++a) {
                            const long place = middle[a] + by[a];
                            within = within && place >= 0 && place < static_cast<long>(of.counts[0][a]);
                            i = i * of.counts[0][a] + static_cast<std::size_t>(within ? place : 0);
                            off[a] = in_cells[a] - static_cast<double>(place);
                        }
                        if (!within || !sets[0][i]) continue;
                        found.deepest = std::max(found.deepest, depth(off, pose.turn, of.dim));
                        ++found.pairs;
                    }
        }
    }
    return found;
}

void look_at(const std::string &key, const study &of, const Sets &sets, bool must_be_apart) {
    Uniform uniform(21);
    const Overlap overlap = look_up(of, sets, uniform);
    const Depth depth = deepest(of, sets, uniform);
    print(key + "_points_looked_up", static_cast<double>(overlap.looked_up));
    print(key + "_points_inside_the_other", static_cast<double>(overlap.inside));
    print(key + "_rim_cells_with_such_points", static_cast<double>(overlap.bad_cells) / static_cast<double>(overlap.cells), "of them");
    print(key + "_pairs_by_separating_axes", static_cast<double>(depth.pairs));
    print(key + "_deepest_overlap", depth.deepest, "cells");
    if (must_be_apart && (overlap.inside > 0 || depth.deepest > 1e-8)) throw std::runtime_error(key + ": kept cells overlap");
}

}  // namespace

void safety(const Data &) {
    for (const char *const *name = STUDIES; *name; ++name) {
        const Study of(*name, 0);
        const std::string key = std::string("safety_") + *name;
        const Pair pair = safe_pair(of);
        // In space the largest pair, whatever its gamma: families take minutes on graphs of that size.
        Sets sets;
        double gamma = 0;
        if (of.dim == 2) {
            const Family safe = family_of(pair, {of.gamma});
            sets = safe.sets[0];
            gamma = safe.reached[0];
        } else {
            const Cut safe = cut_of(pair);
            sets = safe.cells;
            gamma = safe.gamma;
        }
        print(key + "_gamma", gamma);
        look_at(key, of, sets, true);
        if (of.dim == 2) look_at(key + "_by_the_papers_measure", of, family_of(paper_pair(of, of.steps), {of.gamma}).sets[0], false);
    }
}

}  // namespace bench
