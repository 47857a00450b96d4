// A fitted field beside what else an optimiser could ask how far a point is from a shape: a kernel by hand on the same control points,
// closest points of the mesh by CGAL and parry3d-f64, cubics on grids by interpn. The crates' program is `benches/peers`.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../library.hpp"
#include "../points.hpp"
#include "../stats.hpp"
#include "../timing.hpp"
#include "floor.hpp"

#include <cstdio>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>

#include <unistd.h>

namespace bench {

namespace {

const char *const SHAPE = "stanford/bunny_lsdo_genie.stl";
constexpr Counts GRID = {32, 31, 25};  // the paper's 24,800
constexpr std::size_t N_SAMPLES = 25000;
constexpr std::size_t N_POINTS = 100000;  // a multiple of the distances of those near
constexpr std::uint64_t HELD_OUT = 20230601;  // a seed that no fit uses
constexpr int ROUNDS = 5;
constexpr int REPEATS = 10;  // of works of milliseconds in one round; as often in benches/peers
const char *const PROGRAM = "KEEPOUT_BENCH_PEERS";  // names the program of the crates; benches/run sets it

// Arrays of doubles that the program of the crates reads and writes; gone with this.
class Folder {
public:
    Folder() : path_((std::filesystem::temp_directory_path() / "keepout_peers_XXXXXX").string()) {
        if (!mkdtemp(&path_[0])) throw std::runtime_error("cannot make a folder " + path_);
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(const Folder &) = delete;
    Folder &operator=(const Folder &) = delete;

    const std::string &path() const { return path_; }

    void write(const std::string &name, const std::vector<double> &numbers) const {
        std::ofstream file(path_ + "/" + name, std::ios::binary);
        file.write(reinterpret_cast<const char *>(numbers.data()), static_cast<std::streamsize>(sizeof(double) * numbers.size()));
        if (!file.flush()) throw std::runtime_error("cannot write to " + path_);
    }

    std::vector<double> read(const std::string &name, std::size_t n) const {
        std::vector<double> numbers(n);
        std::ifstream file(path_ + "/" + name, std::ios::binary);
        if (!file.read(reinterpret_cast<char *>(numbers.data()), static_cast<std::streamsize>(sizeof(double) * n)))
            throw std::runtime_error("the program of the crates left no " + name);
        return numbers;
    }

private:
    std::string path_;
};

// The median over the rounds of the time of each key, in the order in which keys came: as many times of each, whatever it takes.
class Times {
public:
    // The time of one round.
    void add(const std::string &key, double time) {
        const auto known = std::find_if(of_.begin(), of_.end(), [&](const auto &entry) { return entry.first == key; });
        (known == of_.end() ? of_.emplace_back(key, std::vector<double>()) : *known).second.push_back(time);
    }

    // The least of `repeats` times of `work` at `n` points.
    template <class Work> void take(const std::string &key, std::size_t n, int repeats, Work work) {
        double least = std::numeric_limits<double>::infinity();
        for (int i = 0; i < repeats; ++i) least = std::min(least, seconds(work));
        add(key, 1e9 * least / static_cast<double>(n));
    }

    double operator()(const std::string &key) const {
        for (const auto &[known, times] : of_)
            if (known == key) return median(times);
        throw std::out_of_range(key);
    }

    // Those of `place`, each with how many times as long as Keepout's it is: what gives a value alone beside its value, all else, and
    // closest points tell the direction too, beside its value and gradient.
    void print_all(const std::string &place) const {
        for (const auto &[key, times] : of_) {
            if (key.rfind(place, 0) != 0) continue;
            const double time = median(times);
            print(key, time, "ns/point");
            if (key.rfind(place + "_keepout_", 0) == 0 && key != place + "_keepout_mesh_signed_distance") continue;
            const bool value_only = key.compare(key.size() - 6, 6, "_value") == 0;
            print(key + "_over_keepout", time / (*this)(place + (value_only ? "_keepout_value" : "_keepout_value_and_gradient")));
        }
    }

private:
    std::vector<std::pair<std::string, std::vector<double>>> of_;
};

struct Fitted {
    Mesh mesh;
    Facets facets;
    Field field;
    ko_fit_report report;
    std::vector<double> control_points;
    FloorField floor;

    explicit Fitted(const std::string &path)
        : mesh(read_mesh(path)), facets(facets_of(mesh)), field(fit(sample(mesh, N_SAMPLES), options_of(GRID))),
          report(report_of(field)), control_points(report.n_unknowns) {
        check(ko_field_copy_control_points(field.get(), control_points.size(), control_points.data()), "ko_field_copy_control_points");
        floor.control_points = control_points.data();
        for (int a = 0; a < 3; ++a) {
            floor.counts[a] = report.control_points[a];
            floor.lower[a] = report.box_min[a];
            floor.cell[a] = (report.box_max[a] - report.box_min[a]) / (report.control_points[a] - 3.0);
        }
    }
};

// Points and what was found there.
struct Place {
    std::string name;
    std::vector<double> points, values, gradients, distances;

    Place(const char *called, std::vector<double> at)
        : name(called), points(std::move(at)), values(points.size() / 3), gradients(points.size()), distances(points.size() / 3) {}
};

// 0.005 D and 0.01 D from the surface, on both sides.
std::vector<double> points_near(const Fitted &fitted) {
    const double steps[] = {-0.01, -0.005, 0.005, 0.01};
    const SurfacePoints surface = draw_by_area(fitted.facets, N_POINTS / std::size(steps), HELD_OUT);
    std::vector<double> points;
    for (const double step : steps) {
        const std::vector<double> moved = displaced(surface, step * fitted.report.diagonal);
        points.insert(points.end(), moved.begin(), moved.end());
    }
    return points;
}

// As many nodes as control points, those outside on the faces of the box.
std::vector<double> nodes_of(const ko_fit_report &report) {
    std::vector<double> nodes;
    std::uint32_t at[3];
    for (at[0] = 0; at[0] < GRID[0]; ++at[0])
        for (at[1] = 0; at[1] < GRID[1]; ++at[1])
            for (at[2] = 0; at[2] < GRID[2]; ++at[2])
                for (int a = 0; a < 3; ++a)
                    nodes.push_back(report.box_min[a] + (report.box_max[a] - report.box_min[a]) * at[a] / (GRID[a] - 1.0));
    return nodes;
}

void write_all(const Folder &folder, const Fitted &fitted, const std::vector<Place> &places) {
    folder.write("vertices", fitted.facets.vertices);
    folder.write("triangles", {fitted.facets.facets.begin(), fitted.facets.facets.end()});
    folder.write("counts", {GRID.begin(), GRID.end()});
    folder.write("lower", {fitted.report.box_min, fitted.report.box_min + 3});
    folder.write("upper", {fitted.report.box_max, fitted.report.box_max + 3});
    folder.write("control_points", fitted.control_points);
    const std::vector<double> nodes = nodes_of(fitted.report);
    folder.write("grid_phi", values_of(fitted.field, nodes));
    folder.write("grid_exact", exact_distances(fitted.mesh, nodes));
    for (const Place &place : places) folder.write(place.name, place.points);
}

void time_here(const Fitted &fitted, const ClosestPoints &closest, Place &place, Times &times) {
    const std::size_t n = place.distances.size();
    const std::string key = "peers_" + place.name;
    double *values = place.values.data(), *gradients = place.gradients.data();
    for (double *derivative : {static_cast<double *>(nullptr), gradients}) {
        const char *what = derivative ? "_value_and_gradient" : "_value";
        times.take(key + "_keepout" + what, n, REPEATS, [&] { eval(fitted.field, place.points, values, derivative); });
        if (!has_floor()) continue;
        times.take(key + "_by_hand" + what, n, REPEATS, [&] {
            if (floor_eval(fitted.floor, place.points.data(), n, values, derivative, nullptr) != n)
                throw std::runtime_error("the kernel by hand refused a point");
        });
    }
    times.take(key + "_cgal_closest_point", n, 1, [&] {
        for (std::size_t i = 0; i < n; ++i) place.distances[i] = closest.distance(&place.points[3 * i]);
    });
    times.take(key + "_keepout_mesh_signed_distance", n, 1, [&] {
        check(ko_mesh_signed_distance(fitted.mesh.get(), place.points.data(), n, place.distances.data()), "ko_mesh_signed_distance");
    });
}

// One round of the program of the crates: its times, and of its other lines those that are not known yet are printed.
void time_crates(const Folder &folder, Times &times, bool print_others) {
    std::FILE *program = popen(("\"$" + std::string(PROGRAM) + "\" '" + folder.path() + "'").c_str(), "r");
    if (!program) throw std::runtime_error("cannot run the program of the crates");
    char line[256];
    while (std::fgets(line, sizeof line, program)) {
        std::istringstream words(line);
        std::string key, equals, value, unit;
        words >> key >> equals >> value >> unit;
        if (unit == "ns/point")
            times.add(key, std::stod(value));
        else if (print_others)
            std::fputs(line, stdout);
    }
    if (pclose(program) != 0) throw std::runtime_error("the program of the crates failed");
}

void print_errors(const std::string &key, const std::vector<double> &values, const std::vector<double> &exact, double D) {
    Errors errors;
    for (std::size_t i = 0; i < values.size(); ++i) errors.add((values[i] - exact[i]) / D);
    print(key + "_rms", errors.rms(), "D");
    print(key + "_max", errors.max(), "D");
}

// How far each is from the exact signed distance, so that speed is not told without accuracy.
void print_accuracy(const Fitted &fitted, const Place &place, const Folder *crates) {
    const std::vector<double> exact = exact_distances(fitted.mesh, place.points), phi = values_of(fitted.field, place.points);
    const double D = fitted.report.diagonal;
    const std::string key = "peers_" + place.name + "_off_exact_";
    print_errors(key + "keepout", phi, exact, D);
    print_errors(key + "keepout_mesh_signed_distance", signed_distances(fitted.mesh, place.points), exact, D);
    // The kernel by hand was the last to write there.
    if (has_floor()) print_errors("peers_" + place.name + "_by_hand_off_keepout", place.values, phi, D);
    if (!crates) return;
    const auto found = [&](const char *by) { return crates->read(place.name + "_" + by, exact.size()); };
    for (const char *by : {"parry", "interpn_cubic_of_phi", "interpn_cubic_of_distances"}) print_errors(key + by, found(by), exact, D);
    print_errors("peers_" + place.name + "_interpn_bspline_off_keepout", found("interpn_bspline"), phi, D);
}

}  // namespace

void peers(const Data &data) {
    const char *program = std::getenv(PROGRAM);
    const bool with_crates = program && *program;
    const Fitted fitted(data(SHAPE));
    const ClosestPoints closest(fitted.facets);
    std::vector<Place> places;
    places.emplace_back("uniform", draw_in_box(fitted.report, N_POINTS, 7));
    places.emplace_back("near", points_near(fitted));
    places.emplace_back("surface", draw_by_area(fitted.facets, N_POINTS, HELD_OUT).points);
    const Folder folder;
    if (with_crates) write_all(folder, fitted, places);

    print_count("peers_triangles", fitted.facets.size());
    print_count("peers_samples", N_SAMPLES);
    print_count("peers_control_points", fitted.control_points.size());
    print_count("peers_points", N_POINTS);
    print("peers_hand_kernel", std::string(has_floor() ? BENCH_FLOOR_FLAGS : "not for this machine"));
    if (!with_crates) print("peers_crates", "parry3d-f64 and interpn are missing: " + std::string(PROGRAM) + " names no program");
    signed_distances(fitted.mesh, {0, 0, 0});  // builds the mesh's tree
    Times times;
    {
        const Pinned pinned;  // the program of the crates too, which inherits it
        for (int round = 0; round < ROUNDS; ++round) {
            for (Place &place : places) time_here(fitted, closest, place, times);
            if (with_crates) time_crates(folder, times, round == 0);
        }
    }
    for (const Place &place : places) times.print_all("peers_" + place.name);
    for (const Place &place : places) print_accuracy(fitted, place, with_crates ? &folder : nullptr);
}

}  // namespace bench
