// Ten wheels, in a train and as ninepins stand: what they weigh beside the bound, and seconds.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../stats.hpp"
#include "../timing.hpp"
#include "pairs.hpp"

namespace bench {

namespace {

struct FreeAssembly {
    void operator()(ko_assembly *assembly) const { ko_assembly_free(assembly); }
    void operator()(ko_part *part) const { ko_part_free(part); }
    void operator()(ko_motion *motion) const { ko_motion_free(motion); }
};
using Assembly = std::unique_ptr<ko_assembly, FreeAssembly>;
using Part = std::unique_ptr<ko_part, FreeAssembly>;
using Motion = std::unique_ptr<ko_motion, FreeAssembly>;
using Center = std::array<double, 2>;

// Squares of `cells`^2 cells around the centres, every other one turning the other way, once.
Assembly assembly_of(const std::vector<Center> &centers, std::size_t cells) {
    std::vector<Part> parts;
    std::vector<Motion> motions;
    std::vector<const ko_part *> of;
    std::vector<const ko_motion *> by;
    for (const Center &center : centers) {
        const double corner[2] = {center[0] - 0.5, center[1] - 0.5};
        const std::size_t counts[2] = {cells, cells};
        ko_part *part = nullptr;
        ko_motion *motion = nullptr;
        ko_law law;
        check(ko_law_init(&law, sizeof law), "ko_law_init");
        law.slope = (parts.size() % 2 == 0 ? 2 : -2) * 3.14159265358979323846;
        check(ko_part_create(2, corner, 1.0 / static_cast<double>(cells), counts, nullptr, 0, &part), "ko_part_create");
        parts.emplace_back(part);
        check(ko_motion_turn(center.data(), &law, &motion), "ko_motion_turn");
        motions.emplace_back(motion);
        of.push_back(part);
        by.push_back(motion);
    }
    ko_assembly *assembly = nullptr;
    check(ko_assembly_create(of.data(), by.data(), of.size(), nullptr, &assembly), "ko_assembly_create");
    return Assembly(assembly);
}

void arrange(const std::string &key, const std::vector<Center> &centers, std::size_t cells) {
    Assembly assembly;
    const double graph = seconds([&] { assembly = assembly_of(centers, cells); });
    ko_assembly_report report;
    check(ko_assembly_get_report(assembly.get(), sizeof report, &report), "ko_assembly_get_report");
    Set set(report.n_cells), again(report.n_cells);
    double weight = 0, bound = 0;
    std::size_t n_cuts = 0;
    const double time = seconds([&] {
        check(ko_assembly_arrange(assembly.get(), nullptr, nullptr, set.size(), set.data(), &weight, &bound, &n_cuts),
              "ko_assembly_arrange");
    });
    check(ko_assembly_close(assembly.get(), set.data(), nullptr, set.size(), again.data()), "ko_assembly_close");
    if (set != again) throw std::runtime_error(key + " is not closed");
    print_count(key + "_meetings", report.n_meetings);
    print(key + "_conflicts", static_cast<double>(report.n_edges));
    print(key + "_graph_time", graph, "s");
    print(key + "_arrange_time", time, "s");
    print_count(key + "_cuts", n_cuts);
    print(key + "_weight", weight);
    print(key + "_bound", bound);
    print(key + "_below_bound", 1 - weight / bound, "of the bound");
}

}  // namespace

void assembly(const Data &) {
    std::vector<Center> train, pins;
    for (int k = 0; k < 10; ++k) train.push_back({0.8 * k, 0.3 * (k % 2)});
    // Four, three, two and one: each three neighbours meet.
    for (int row = 0; row < 4; ++row)
        for (int k = 0; k < 4 - row; ++k) pins.push_back({k + 0.5 * row, 0.9 * row});
    for (const std::size_t cells : {50, 100, 200}) {
        arrange("assembly_train_of_" + std::to_string(cells), train, cells);
        arrange("assembly_ninepins_of_" + std::to_string(cells), pins, cells);
    }
}

}  // namespace bench
