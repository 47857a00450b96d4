// SPDX-License-Identifier: Apache-2.0 OR MIT
// A follower as stiff as it can be that never collides with its cam, by NLopt's CCSA: the follower's compliance from a small finite-element model,
// its volume and the cam's, and the collision measures g_21 + g_12 of Morris and Behandish 2022 as a constraint, with the library's sensitivities.
// The start is in collision. What comes out is made exactly collision-free by a minimum cut weighted with the densities, and looked at again.
//
//   keepout_compliance [PICTURE.svg]
#include "plate.hpp"

#include <keepout.h>
#include <nlopt.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <memory>
#include <string>

namespace {

constexpr std::size_t n = 60;  // cells along the cam's edge, and the follower's longer one
constexpr std::size_t rows[2] = {n, n / 2};
constexpr double edge = 1.0 / n;
constexpr double corners[2][2] = {{-0.5, -0.5}, {-0.5, -0.25}};
constexpr double most_follower = 0.55, least_cam = 0.82;  // volumes, as fractions of their grids
// What the measures may be, of what they are at the start: it is come down to by thirds, since at once the follower gives way everywhere, and
// what is empty has no stiffness to gain.
constexpr double collision = 0.3 / 243;
constexpr int evaluations = 40;  // at each
constexpr double reach = 1.6;    // cells, of the filter

struct Free {
    void operator()(ko_part *part) const { ko_part_free(part); }
    void operator()(ko_motion *motion) const { ko_motion_free(motion); }
    void operator()(ko_pair *pair) const { ko_pair_free(pair); }
};
using Part = std::unique_ptr<ko_part, Free>;
using Motion = std::unique_ptr<ko_motion, Free>;
using Pair = std::unique_ptr<ko_pair, Free>;
using Numbers = std::vector<double>;
using Cells = std::vector<std::uint8_t>;

void check(std::int32_t status) {
    if (status < 0) throw std::runtime_error(ko_last_error());
}

std::size_t n_cells(int part) { return n * rows[part]; }

// The two pins at the follower's lower corners, where the forces are: 3 x 3 cells each, which it keeps.
bool is_pin(std::size_t column, std::size_t row) {
    const std::size_t from_side = std::min(column, n - 1 - column);
    return from_side >= 3 && from_side < 6 && row >= 5 && row < 8;
}

// The cam, or the follower with its pins.
Part make_part(int which) {
    const std::size_t counts[2] = {n, rows[which]};
    Cells cells(n_cells(which), KO_CELL_FREE);
    for (std::size_t i = 0; which == 1 && i < cells.size(); ++i)
        if (is_pin(i / rows[1], i % rows[1])) cells[i] = KO_CELL_FROZEN;
    ko_part *part = nullptr;
    check(ko_part_create(2, corners[which], edge, counts, cells.data(), cells.size(), &part));
    return Part(part);
}

// The paper's cam and follower, section 5.2: conflicts of whole cells at all times, and its measures.
Pair make_pair() {
    const double pi = 3.14159265358979323846, center[2] = {0, 0}, up[2] = {0, 1}, wave[3] = {0.125, 2, 0};
    ko_law turn, lift;
    check(ko_law_init(&turn, sizeof turn));
    check(ko_law_init(&lift, sizeof lift));
    turn.slope = 2 * pi;
    lift.offset = 0.75;
    lift.waves = wave;
    lift.n_waves = 1;
    ko_motion *motions[2] = {};
    check(ko_motion_turn(center, &turn, &motions[0]));
    const Motion cam(motions[0]);
    check(ko_motion_slide(2, up, &lift, &motions[1]));
    const Motion follower(motions[1]);
    ko_pair_options options;
    check(ko_pair_options_init(&options, sizeof options));
    options.measure_steps = 500;
    const Part first = make_part(0), second = make_part(1);
    ko_pair *pair = nullptr;
    check(ko_pair_create(first.get(), cam.get(), second.get(), follower.get(), &options, &pair));
    return Pair(pair);
}

// Means of densities within reach, weighted by what is left of it: no cells that hold by their corners alone.
class Filter {
public:
    explicit Filter(int part) : near_(n_cells(part)) {
        const long width = static_cast<long>(std::floor(reach)), height = static_cast<long>(rows[part]);
        for (long x = 0; x < static_cast<long>(n); ++x)
            for (long y = 0; y < height; ++y) {
                auto &list = near_[static_cast<std::size_t>(x * height + y)];
                double sum = 0;
                for (long i = std::max(0L, x - width); i <= std::min(static_cast<long>(n) - 1, x + width); ++i)
                    for (long j = std::max(0L, y - width); j <= std::min(height - 1, y + width); ++j) {
                        const double weight = reach - std::hypot(static_cast<double>(i - x), static_cast<double>(j - y));
                        if (weight <= 0) continue;
                        list.push_back({static_cast<std::size_t>(i * height + j), weight});
                        sum += weight;
                    }
                for (auto &[cell, weight] : list) weight /= sum;
            }
    }
    Numbers operator()(const double *x) const {
        Numbers densities(near_.size());
        for (std::size_t i = 0; i < near_.size(); ++i)
            for (const auto &[cell, weight] : near_[i]) densities[i] += weight * x[cell];
        for (double &density : densities) density = std::min(std::max(density, 0.0), 1.0);  // rounding
        return densities;
    }
    void add_back(const Numbers &by_density, double *by_x) const {
        for (std::size_t i = 0; i < near_.size(); ++i)
            for (const auto &[cell, weight] : near_[i]) by_x[cell] += weight * by_density[i];
    }

private:
    std::vector<std::vector<std::pair<std::size_t, double>>> near_;
};

// A function of both parts' densities, with its gradients; 0 where one does not count.
struct Value {
    double value;
    Numbers by[2];
};

struct Problem {
    Pair pair = make_pair();
    Plate plate = make_plate();
    Filter filters[2] = {Filter(0), Filter(1)};
    double first_compliance = 1, first_measure = 1, most_collision = collision;
    int n_evaluations = 0;

    static Plate make_plate() {
        Plate shape(n, rows[1], {}, {});
        std::vector<std::size_t> held;
        for (std::size_t column = 0; column <= n; ++column) held.push_back(shape.node(column, rows[1]));
        // On each pin down the slope that the cam's flank has, and outward.
        return Plate(n, rows[1], held, {{shape.node(5, 6), -1, 1}, {shape.node(n - 5, 6), 1, 1}});
    }

    Value compliance(const Numbers (&densities)[2]) {
        Value c{};
        c.value = plate.compliance(densities[1], c.by[1]) / first_compliance;
        for (double &g : c.by[1]) g /= first_compliance;
        return c;
    }

    Value measure(const Numbers (&densities)[2]) const {
        double g21 = 0, g12 = 0;
        check(ko_pair_measures(pair.get(), densities[0].data(), n_cells(0), densities[1].data(), n_cells(1), 0, &g21, &g12));
        Value g{(g21 + g12) / first_measure, {Numbers(n_cells(0)), Numbers(n_cells(1))}};
        Numbers other[2] = {Numbers(n_cells(0)), Numbers(n_cells(1))};
        check(ko_pair_sensitivities(pair.get(), densities[0].data(), n_cells(0), densities[1].data(), n_cells(1), 0, g.by[0].data(),
                                    g.by[1].data(), other[0].data(), other[1].data()));
        for (int part = 0; part < 2; ++part)
            for (std::size_t i = 0; i < n_cells(part); ++i) g.by[part][i] = (g.by[part][i] + other[part][i]) / first_measure;
        return g;
    }

    static Value volume(const Numbers (&densities)[2], int part) {
        Value v{};
        v.by[part].assign(n_cells(part), 1.0 / static_cast<double>(n_cells(part)));
        for (const double density : densities[part]) v.value += density / static_cast<double>(n_cells(part));
        return v;
    }
};

enum Kind { COMPLIANCE, COLLISION, FOLLOWER, CAM };

struct Function {
    Problem *problem;
    Kind kind;

    // At most 0 where it is a constraint.
    double operator()(const double *x, double *gradient) const {
        Numbers densities[2] = {problem->filters[0](x), problem->filters[1](x + n_cells(0))};
        Value value{};
        switch (kind) {
        case COMPLIANCE: value = problem->compliance(densities); break;
        case COLLISION: value = problem->measure(densities); value.value -= problem->most_collision; break;
        case FOLLOWER: value = Problem::volume(densities, 1); value.value -= most_follower; break;
        case CAM:
            value = Problem::volume(densities, 0);
            value.value = least_cam - value.value;
            for (double &g : value.by[0]) g = -g;
            break;
        }
        if (kind == COMPLIANCE) ++problem->n_evaluations;
        if (gradient) {
            std::fill(gradient, gradient + n_cells(0) + n_cells(1), 0.0);
            for (int part = 0; part < 2; ++part)
                if (!value.by[part].empty()) problem->filters[part].add_back(value.by[part], gradient + (part == 0 ? 0 : n_cells(0)));
        }
        return value.value;
    }
};

double evaluate(const std::vector<double> &x, std::vector<double> &gradient, void *data) {
    return (*static_cast<Function *>(data))(x.data(), gradient.empty() ? nullptr : gradient.data());
}

// The largest difference of the gradient to central differences, over its largest entry, away from the bounds.
double off_differences(const Function &function, std::vector<double> x) {
    for (double &at : x) at = std::min(at, 0.9);
    std::vector<double> gradient(x.size());
    function(x.data(), gradient.data());
    double largest = 0, worst = 0;
    for (const double g : gradient) largest = std::max(largest, std::fabs(g));
    for (std::size_t i = 17; i < x.size(); i += 97) {
        const double at = x[i], h = 1e-4;
        x[i] = at + h;
        const double above = function(x.data(), nullptr);
        x[i] = at - h;
        const double below = function(x.data(), nullptr);
        x[i] = at;
        worst = std::max(worst, std::fabs((above - below) / (2 * h) - gradient[i]) / largest);
    }
    return worst;
}

struct Result {
    Cells cells[2];
    double volumes[2], compliance;
    std::size_t n_lost;  // cells of the follower that conflict with the cam
};

double compliance_of(Problem &problem, const Cells &follower) {
    Numbers gradient;
    return problem.plate.compliance(Numbers(follower.begin(), follower.end()), gradient) / problem.first_compliance;
}

// Of all pairs that never collide that of the greatest sum of densities, less what the densities do not ask for.
Result make_exact(Problem &problem, const std::vector<double> &x) {
    Result result{};
    Numbers densities[2] = {problem.filters[0](x.data()), problem.filters[1](x.data() + n_cells(0))};
    for (int part = 0; part < 2; ++part) result.cells[part].resize(n_cells(part));
    check(ko_pair_cut(problem.pair.get(), densities[0].data(), densities[1].data(), nullptr, n_cells(0), n_cells(1), result.cells[0].data(),
                      result.cells[1].data(), nullptr, nullptr, nullptr));
    for (int part = 0; part < 2; ++part)
        for (std::size_t i = 0; i < n_cells(part); ++i) {
            const bool frozen = part == 1 && is_pin(i / rows[1], i % rows[1]);
            result.cells[part][i] = result.cells[part][i] && (frozen || densities[part][i] > 0.5);
            result.volumes[part] += result.cells[part][i] / static_cast<double>(n_cells(part));
        }
    check(ko_pair_volumes(problem.pair.get(), result.cells[0].data(), n_cells(0), result.cells[1].data(), n_cells(1), nullptr, nullptr,
                          &result.n_lost));
    result.compliance = compliance_of(problem, result.cells[1]);
    return result;
}

void draw(const Result &result, const std::string &path) {
    std::ofstream file(path);
    file << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << n + 4 << ' ' << rows[0] + rows[1] + 8
         << "\" width=\"640\" shape-rendering=\"crispEdges\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
    for (int part = 0; part < 2; ++part)
        for (std::size_t i = 0; i < n_cells(part); ++i) {
            const std::size_t x = 2 + i / rows[part], y = i % rows[part];
            const std::size_t top = part == 1 ? 2 + rows[1] - 1 - y : 6 + rows[1] + rows[0] - 1 - y;
            const char *colour = part == 0 ? (result.cells[0][i] ? "#4075b8" : "#e6edf6")
                                 : is_pin(i / rows[1], y) ? "#803c00" : result.cells[1][i] ? "#ed8c33" : "#fdf1e6";
            file << "<rect x=\"" << x << "\" y=\"" << top << "\" width=\"1\" height=\"1\" fill=\"" << colour << "\"/>\n";
        }
    file << "</svg>\n";
    if (!file.flush()) throw std::runtime_error("writing " + path + " failed");
    std::printf("Wrote %s: the follower above, its pins dark, the cam below\n", path.c_str());
}

bool holds(bool right, const char *what) {
    if (!right) std::fprintf(stderr, "keepout_compliance: %s\n", what);
    return right;
}

bool run(const char *picture) {
    Problem problem;
    const std::size_t n_variables = n_cells(0) + n_cells(1);
    std::vector<double> x(n_variables, 0.9), lower(n_variables, 0.0), upper(n_variables, 1.0);
    for (std::size_t i = 0; i < n_cells(1); ++i) {
        x[n_cells(0) + i] = 0.5;
        if (is_pin(i / rows[1], i % rows[1])) x[n_cells(0) + i] = lower[n_cells(0) + i] = 1;
    }
    Function functions[] = {{&problem, COMPLIANCE}, {&problem, COLLISION}, {&problem, FOLLOWER}, {&problem, CAM}};
    problem.first_compliance = functions[COMPLIANCE](x.data(), nullptr);
    problem.first_measure = functions[COLLISION](x.data(), nullptr) + collision;
    double off = 0;
    for (const Function &function : functions) off = std::max(off, off_differences(function, x));
    std::printf("%zu densities; gradients off central differences by %.1e of the largest\n", n_variables, off);

    double compliance = 0;
    problem.n_evaluations = 0;
    for (problem.most_collision = 0.3; problem.most_collision > 0.9 * collision; problem.most_collision /= 3) {
        nlopt::opt optimiser(nlopt::LD_CCSAQ, static_cast<unsigned>(n_variables));
        optimiser.set_lower_bounds(lower);
        optimiser.set_upper_bounds(upper);
        optimiser.set_min_objective(evaluate, &functions[COMPLIANCE]);
        for (const Kind kind : {COLLISION, FOLLOWER, CAM}) optimiser.add_inequality_constraint(evaluate, &functions[kind], 1e-5);
        optimiser.set_maxeval(evaluations);
        optimiser.optimize(x, compliance);
    }
    problem.most_collision = collision;

    const Result result = make_exact(problem, x);
    std::printf("%d evaluations; of what they are at the start: compliance %.4f, measures %.2e (at most %.2e)\n", problem.n_evaluations,
                compliance, functions[COLLISION](x.data(), nullptr) + collision, collision);
    std::printf("follower %.3f of its grid (at most %.2f), cam %.3f (at least %.2f)\n", functions[FOLLOWER](x.data(), nullptr) + most_follower,
                most_follower, least_cam - functions[CAM](x.data(), nullptr), least_cam);
    std::printf("made exact by a cut: follower %.3f, cam %.3f, compliance %.4f; %zu cells in conflict\n", result.volumes[1], result.volumes[0],
                result.compliance, result.n_lost);
    if (picture) draw(result, picture);
    // Volumes of sets differ from sums of densities by rims that are half full.
    return holds(off < 1e-6, "a gradient is wrong") & holds(compliance < 0.5, "the follower is not stiffer than at the start") &
           holds(functions[COLLISION](x.data(), nullptr) < 1e-4, "the densities collide") &
           holds(result.n_lost == 0, "cells that were kept conflict") & holds(result.compliance < 0.6, "the exact follower is too soft") &
           holds(result.volumes[0] > least_cam - 0.03 && result.volumes[1] < most_follower + 0.03, "a volume is far from its limit");
}

}  // namespace

int main(int argc, char **argv) {
    try {
        return run(argc > 1 ? argv[1] : nullptr) ? 0 : 1;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "keepout_compliance: %s\n", error.what());
        return 1;
    }
}
