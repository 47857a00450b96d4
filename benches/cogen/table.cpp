// Seconds and memory of the paper's cases, each in a process of its own, and their growth with resolution.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../stats.hpp"
#include "../timing.hpp"
#include "pairs.hpp"

#include <cmath>
#include <functional>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace bench {

namespace {

// Runs `work` in a process of its own, and prints how much memory that took at most.
void alone(const std::string &key, const std::function<void()> &work) {
    std::fflush(stdout);
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("there is no other process");
    if (child == 0) _exit(run("cogen", work));
    int status = 0;
    rusage usage{};
    if (wait4(child, &status, 0, &usage) != child || !WIFEXITED(status) || WEXITSTATUS(status) != EXIT_SUCCESS)
        throw std::runtime_error(key + " failed");
    print(key + "_peak_memory", static_cast<double>(usage.ru_maxrss) * 1024 / 1e9, "GB");
}

struct Limits {
    const char *name;
    double cut, optimised, memory;  // seconds; GB, 0 for none
    bool whole_family;
};

// Of the cut, of moving asymptotes, of memory; four times the first, and 12 GB, where nothing may be missed.
constexpr Limits LIMITS[] = {
    {"gears", 2, 5, 0, false}, {"cam", 40, 8, 0, true}, {"cam_3d", 90, 600, 6, false}, {"bolt", 20, 400, 3, false}};

// Graph, cut and closure, or the family.
void cut_case(const std::string &key, const Limits &limits, bool safe) {
    const Study of(limits.name, 0);
    Pair pair;
    const double graph = seconds([&] { pair = safe ? safe_pair(of) : paper_pair(of, of.steps); });
    double weight = 0;
    const double rest = seconds([&] {
        if (limits.whole_family) {
            const Family found = family_of(pair, papers_gammas());
            weight = found.volumes[10] + found.volumes[11];
        } else {
            const Cut cut = cut_of(pair);
            if (cut.weight != cut.bound) throw std::runtime_error("the flow does not meet the cut");
            weight = cut.weight;
        }
    });
    print(key + "_graph_time", graph, "s");
    print(key + (limits.whole_family ? "_family_time" : "_cut_time"), rest, "s");
    print(key + "_time", graph + rest, "s");
    print(key + "_time_limit", safe ? 4 * limits.cut : limits.cut, "s");
    print(key + "_conflicts", static_cast<double>(report_of(pair).n_edges));
    print(key + "_weight", weight);
}

void optimise_case(const std::string &key, const Limits &limits) {
    const Study of(limits.name, 0);
    Optimised found;
    const double time = seconds([&] { found = optimise(paper_pair(of, of.steps), of.gamma); });
    print(key + "_time", time, "s");
    print(key + "_time_limit", limits.optimised, "s");
    print_count(key + "_iterations", found.report.n_iterations);
    print(key + "_gamma", found.report.gamma);
    print(key + "_total", found.report.volumes[0] + found.report.volumes[1]);
}

}  // namespace

void table(const Data &) {
    for (const Limits &limits : LIMITS) {
        const std::string key = std::string("table_") + limits.name;
        const std::string paper = key + "_by_the_papers_measure", asymptotes = key + "_by_asymptotes";
        alone(key, [&] { cut_case(key, limits, true); });
        print(key + "_peak_memory_limit", 12, "GB");
        alone(paper, [&] { cut_case(paper, limits, false); });
        if (limits.memory > 0) print(paper + "_peak_memory_limit", limits.memory, "GB");
        alone(asymptotes, [&] { optimise_case(asymptotes, limits); });
    }
}

void growth(const Data &) {
    const struct {
        const char *name;
        std::size_t cells[3];
    } cases[] = {{"gears", {200, 400, 800}}, {"cam", {200, 400, 800}}, {"cam_3d", {30, 60, 90}}, {"bolt", {20, 30, 40}}};
    for (const auto &of : cases) {
        double first = 0, last = 0;
        const std::string name = std::string("growth_") + of.name;
        for (const std::size_t cells : of.cells) {
            const Study study(of.name, cells);
            Pair pair;
            Cut cut;
            const double time = seconds([&] {
                pair = safe_pair(study);
                cut = cut_of(pair);
            });
            const std::string key = name + "_of_" + std::to_string(cells);
            print(key + "_time", time, "s");
            print(key + "_graph_bytes", static_cast<double>(report_of(pair).graph_bytes) / 1e6, "MB");
            print(key + "_conflicts", static_cast<double>(report_of(pair).n_edges));
            (cells == of.cells[0] ? first : last) = time;
        }
        print(name + "_time_exponent_by_cells_along_an_edge",
              std::log(last / first) / std::log(static_cast<double>(of.cells[2]) / static_cast<double>(of.cells[0])));
    }
}

}  // namespace bench
