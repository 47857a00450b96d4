// What co-generation gives, against definitions that are worked out here cell by cell, and against Boost's maximum flow.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../points.hpp"
#include "../stats.hpp"
#include "pairs.hpp"

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/push_relabel_max_flow.hpp>
#include <cmath>

namespace bench {

namespace {

constexpr int CLOSURES = 4000, TINY_CUTS = 400, MEDIUM_CUTS = 6;

// Two grids and a motion at random: cells are of edge 1, and the parts mostly meet.
struct RandomStudy : study {
    RandomStudy(std::uint32_t dimension, std::size_t most, Uniform &uniform) : study{} {
        name = title = "at random";
        dim = dimension;
        edge[0] = edge[1] = 1;
        steps = 7 + static_cast<std::uint64_t>(20 * uniform());
        for (int part = 0; part < 2; ++part) {
            n_cells[part] = 1;
            for (std::uint32_t a = 0; a < 3; ++a) {
                counts[part][a] = a < dim ? 1 + static_cast<std::size_t>(static_cast<double>(most) * uniform()) : 1;
                corner[part][a] = a < dim ? -0.5 * static_cast<double>(counts[part][a]) + uniform() - 0.5 : 0;
                n_cells[part] *= counts[part][a];
            }
            check(ko_part_create(dim, corner[part], edge[part], counts[part], nullptr, 0, &parts[part]), "ko_part_create");
            make_motion(part, static_cast<double>(most), uniform);
        }
    }
    RandomStudy(const RandomStudy &) = delete;
    RandomStudy &operator=(const RandomStudy &) = delete;
    ~RandomStudy() { study_free(this); }

private:
    // A screw or turn with waves, moved aside.
    void make_motion(int part, double size, Uniform &uniform) {
        ko_law law;
        check(ko_law_init(&law, sizeof law), "ko_law_init");
        const double wave[3] = {uniform(), std::floor(3 * uniform()), 6 * uniform()};
        law.offset = 6 * uniform();
        law.slope = 4 * uniform() - 2;
        law.waves = wave;
        law.n_waves = 1;
        double place[3], axis[3];
        for (int a = 0; a < 3; ++a) {
            place[a] = size * (uniform() - 0.5);
            axis[a] = uniform() - 0.5;
        }
        check(dim == 2 ? ko_motion_turn(place, &law, &motions[part])
                       : ko_motion_screw(place, axis, uniform() - 0.5, &law, &motions[part]),
              "a motion");
    }
};

using Edges = std::vector<std::vector<bool>>;

// The pairs of cells of which one's centre is in the other at a time (k + 1/2) / K.
Edges edges_of(const study &of) {
    Edges edges(of.n_cells[0], std::vector<bool>(of.n_cells[1]));
    for (std::uint64_t k = 0; k < of.steps; ++k) {
        const RelativePose pose = relative_pose(of, (static_cast<double>(k) + 0.5) / static_cast<double>(of.steps));
        for (std::size_t j = 0; j < of.n_cells[1]; ++j) {
            const std::size_t i = cell_at(of, 0, pose(center_of(of, 1, j).data()));
            if (i != NO_CELL) edges[i][j] = true;
        }
        for (std::size_t i = 0; i < of.n_cells[0]; ++i) {
            const std::size_t j = cell_at(of, 1, pose.back(center_of(of, 0, i).data()));
            if (j != NO_CELL) edges[i][j] = true;
        }
    }
    return edges;
}

bool is_apart(const Edges &edges, const Sets &sets) {
    for (std::size_t i = 0; i < sets[0].size(); ++i)
        for (std::size_t j = 0; sets[0][i] && j < sets[1].size(); ++j)
            if (sets[1][j] && edges[i][j]) return false;
    return true;
}

// Whether each cell that is left out conflicts with one that is kept.
bool is_maximal(const Edges &edges, const Sets &sets) {
    for (std::size_t i = 0; i < sets[0].size(); ++i) {
        bool meets = sets[0][i];
        for (std::size_t j = 0; !meets && j < sets[1].size(); ++j) meets = sets[1][j] && edges[i][j];
        if (!meets) return false;
    }
    for (std::size_t j = 0; j < sets[1].size(); ++j) {
        bool meets = sets[1][j];
        for (std::size_t i = 0; !meets && i < sets[0].size(); ++i) meets = sets[0][i] && edges[i][j];
        if (!meets) return false;
    }
    return true;
}

void expect(bool holds, const char *what) {
    if (!holds) throw std::runtime_error(what);
}

Set random_set(std::size_t n, Uniform &uniform) {
    Set set(n);
    for (std::uint8_t &is : set) is = uniform() < 0.5;
    return set;
}

void expect_sound(const Edges &edges, const Pair &pair, const Sets &sets, const char *what) {
    expect(is_apart(edges, sets), what);
    expect(is_maximal(edges, sets), what);
    const auto g = measures_of(pair, sets);
    expect(g[0] == 0 && g[1] == 0, "a measure of a pair that was given back is not 0");
}

void closures(Uniform &uniform) {
    std::size_t with_edges = 0;
    for (int k = 0; k < CLOSURES; ++k) {
        const RandomStudy of(k % 2 ? 2 : 3, k % 2 ? 7 : 4, uniform);
        const Edges edges = edges_of(of);
        const Pair pair = paper_pair(of, of.steps);
        std::uint64_t n_edges = 0;
        for (const auto &row : edges) n_edges += static_cast<std::uint64_t>(std::count(row.begin(), row.end(), true));
        expect(report_of(pair).n_edges == n_edges, "the graph of a measure has other edges than centres in cells");
        with_edges += n_edges > 0;
        const std::uint32_t from = static_cast<std::uint32_t>(3 * uniform());
        expect_sound(edges, pair, close(pair, {random_set(of.n_cells[0], uniform), random_set(of.n_cells[1], uniform)}, from),
                     "a closed pair collides or can grow");
        // The unsweeps of both parts as a whole: what no centre meets.
        const Family ends = family_of(pair, {0, 1});
        for (int whole = 0; whole < 2; ++whole) {
            Sets right{Set(of.n_cells[0], 1), Set(of.n_cells[1], 1)};
            for (std::size_t i = 0; i < of.n_cells[0]; ++i)
                for (std::size_t j = 0; j < of.n_cells[1]; ++j)
                    if (edges[i][j]) (whole == 0 ? right[1][j] : right[0][i]) = 0;
            expect(ends.sets[static_cast<std::size_t>(whole)] == right, "gamma = 0 or 1 is not the unsweep");
        }
    }
    print_count("exact_closures_and_unsweeps", CLOSURES);
    print_count("exact_closures_of_parts_that_meet", with_edges);
    if (with_edges == 0) throw std::runtime_error("no parts meet: closures are of nothing");
}

// Weights that are whole numbers, so that sums are exact.
std::vector<double> random_weights(std::size_t n, Uniform &uniform) {
    std::vector<double> weights(n);
    for (double &w : weights) w = std::floor(10 * uniform());
    return weights;
}

double weight_of(const Set &set, const std::vector<double> &weights) {
    double sum = 0;
    for (std::size_t i = 0; i < set.size(); ++i) sum += set[i] ? weights[i] : 0;
    return sum;
}

void tiny_cuts(Uniform &uniform) {
    for (int k = 0; k < TINY_CUTS; ++k) {
        const RandomStudy of(k % 2 ? 2 : 3, k % 2 ? 4 : 2, uniform);
        const Edges edges = edges_of(of);
        const Pair pair = paper_pair(of, of.steps);
        const std::vector<double> w_1 = random_weights(of.n_cells[0], uniform), w_2 = random_weights(of.n_cells[1], uniform);
        double best = 0;
        for (std::uint32_t chosen = 0; chosen < 1u << of.n_cells[0]; ++chosen) {
            double weight = 0;
            for (std::size_t i = 0; i < of.n_cells[0]; ++i) weight += chosen >> i & 1 ? w_1[i] : 0;
            for (std::size_t j = 0; j < of.n_cells[1]; ++j) {
                bool meets = false;
                for (std::size_t i = 0; !meets && i < of.n_cells[0]; ++i) meets = chosen >> i & 1 && edges[i][j];
                weight += meets ? 0 : w_2[j];
            }
            best = std::max(best, weight);
        }
        const Cut cut = cut_of(pair, w_1.data(), w_2.data());
        expect(cut.weight == best && cut.bound == best, "a cut is not the best of all pairs");
        expect(weight_of(cut.cells[0], w_1) + weight_of(cut.cells[1], w_2) == best, "a cut's cells have another weight");
        expect_sound(edges, pair, cut.cells, "a cut collides or can grow");
    }
    print_count("exact_cuts_against_all_pairs", TINY_CUTS);
}

// All weights less the maximum flow from part 1 through conflicts to part 2, by Boost.
double best_by_boost(const Edges &edges, const std::vector<double> &w_1, const std::vector<double> &w_2) {
    using namespace boost;
    using Traits = adjacency_list_traits<vecS, vecS, directedS>;
    using Graph = adjacency_list<
        vecS, vecS, directedS, no_property,
        property<edge_capacity_t, long,
                 property<edge_residual_capacity_t, long, property<edge_reverse_t, Traits::edge_descriptor>>>>;
    const std::size_t n_1 = w_1.size(), n_2 = w_2.size(), source = n_1 + n_2, sink = source + 1;
    Graph graph(sink + 1);
    const auto join = [&](std::size_t from, std::size_t to, long capacity) {
        const auto there = add_edge(from, to, graph).first, back = add_edge(to, from, graph).first;
        put(edge_capacity, graph, there, capacity);
        put(edge_capacity, graph, back, 0L);
        put(edge_reverse, graph, there, back);
        put(edge_reverse, graph, back, there);
    };
    double all = 0;
    for (std::size_t i = 0; i < n_1; ++i) {
        join(source, i, static_cast<long>(w_1[i]));
        all += w_1[i];
        for (std::size_t j = 0; j < n_2; ++j)
            if (edges[i][j]) join(i, n_1 + j, 1L << 40);
    }
    for (std::size_t j = 0; j < n_2; ++j) {
        join(n_1 + j, sink, static_cast<long>(w_2[j]));
        all += w_2[j];
    }
    return all - static_cast<double>(push_relabel_max_flow(graph, source, sink));
}

void medium_cuts(Uniform &uniform) {
    std::size_t most_edges = 0;
    for (int k = 0; k < MEDIUM_CUTS; ++k) {
        const bool plane = k % 2 == 0;
        const Study of(plane ? (k % 4 ? "cam" : "gears") : (k % 4 == 1 ? "cam_3d" : "bolt"), plane ? 36 : k % 4 == 1 ? 12 : 10);
        study copy = of;
        copy.steps = 97;
        const Edges edges = edges_of(copy);
        const Pair pair = paper_pair(of, copy.steps);
        const std::vector<double> w_1 = random_weights(of.n_cells[0], uniform), w_2 = random_weights(of.n_cells[1], uniform);
        const double best = best_by_boost(edges, w_1, w_2);
        const Cut cut = cut_of(pair, w_1.data(), w_2.data());
        expect(cut.weight == best && cut.bound == best, "a cut is not what Boost's maximum flow tells");
        expect_sound(edges, pair, cut.cells, "a cut collides or can grow");
        most_edges = std::max<std::size_t>(most_edges, report_of(pair).n_edges);
        for (const Sets &sets : family_of(pair, papers_gammas()).sets) expect_sound(edges, pair, sets, "a pair of a family collides or can grow");
        expect_sound(edges, pair, optimise(pair, 0.5).cells, "an optimised pair collides or can grow");
    }
    print_count("exact_cuts_against_boost", MEDIUM_CUTS);
    print_count("exact_most_conflicts_of_these", most_edges);
}

}  // namespace

void exact(const Data &) {
    Uniform uniform(3);
    closures(uniform);
    tiny_cuts(uniform);
    medium_cuts(uniform);
}

}  // namespace bench
