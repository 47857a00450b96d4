// SPDX-License-Identifier: Apache-2.0 OR MIT
// A concentric tube robot for the heart's right ventricle, with the field and with Lin's formulation: table 6 of the paper.
//
//   keepout_robot DATA [PICTURE.svg]      DATA: the folder of the test data
//   keepout_robot DATA --starts NUMBER    the design from that many starts: how much of the times is luck
//
// For each formulation: a path between two points, then tubes whose tip follows it, by IPOPT with the same options from the same start. What
// is found is checked against the mesh alone. Ends with status 1 where a robot penetrates the anatomy or IPOPT finds no optimum.
#include "checks.hpp"
#include "design.hpp"
#include "path.hpp"
#include "picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace {

const char *const mesh_file = "anatomy/heart_sphinxsys.stl";

// From above the rim of the right ventricle at one end of its crescent to inside at the other: the septum is in the straight line's way.
constexpr Vec3 entry = {26, 76, 15}, goal = {24, 52, 46}; // mm

constexpr std::size_t n_field_points = 20000, n_lin_points = 1842; // the latter is the paper's
constexpr std::size_t n_poses = 20;
constexpr double first_pose = 0.2;         // how much of the path is behind the first pose: shorter robots have no room for three tubes
constexpr double sharpness = 1000; // of KS: the clearance of a row of samples is then at most a millimetre more than its KS
constexpr double path_clearance = 1.4;
constexpr double spare = 0.3;              // what the robot's surface is kept off the anatomy, for the fields' error [mm]
constexpr double straight_guide = 100;     // from where the tubes are turned to the entry [mm]

// How much of the path is behind each pose.
std::vector<double> pose_shares() {
    std::vector<double> shares;
    for (std::size_t k = 0; k < n_poses; ++k)
        shares.push_back(first_pose + (1 - first_pose) * static_cast<double>(k) / (n_poses - 1));
    return shares;
}

struct Outcome {
    const char *name;
    double fit_seconds;
    Solution path, design;
    double path_length;
    std::vector<double> curve;      // the path, densely
    std::vector<Parameters> poses;
    double path_clearance, robot_clearance; // by the mesh
    double tip_error;
    double formulation_seconds, model_seconds; // of the design's

    double seconds() const { return fit_seconds + path.seconds + design.seconds; }
    bool good() const { return path.solved() && design.solved() && robot_clearance > 0; }
};

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// The guide points to the goal; the design may tilt it.
Mat3 guide_frame() {
    Vec3 z, x;
    double length = 0;
    for (int k = 0; k < 3; ++k) {
        z[k] = goal[k] - entry[k];
        length = std::hypot(length, z[k]);
    }
    for (double &coordinate : z)
        coordinate /= length;
    const double across = std::hypot(z[1], z[0]);
    x = {z[1] / across, -z[0] / across, 0};
    const Vec3 y = {z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]};
    return {x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]};
}

Tubes make_tubes() {
    Tubes tubes = nitinol({0.6, 1.0, 1.4}, {0.4, 0.75, 1.15});
    tubes.entry = entry;
    tubes.frame = guide_frame();
    tubes.n_elements = 80;
    return tubes;
}

struct Dense {
    std::vector<std::vector<double>> points, radii; // of each pose
    double clearance = std::numeric_limits<double>::infinity();
};

// The robot at each pose, a point each 0.1 mm or nearer, and its least distance to the mesh, the radius taken off.
Dense check_robot(const Tubes &tubes, const std::vector<Parameters> &poses, const keepout::Mesh &mesh) {
    Dense dense;
    Shape shape;
    for (const Parameters &pose : poses) {
        solve(tubes, pose, shape);
        dense.points.emplace_back();
        dense.radii.emplace_back();
        dense_points(tubes, pose, shape, 10, dense.points.back(), dense.radii.back());
        const std::vector<double> distances = mesh.signed_distance(dense.points.back());
        for (std::size_t j = 0; j < distances.size(); ++j)
            dense.clearance = std::min(dense.clearance, distances[j] - dense.radii.back()[j]);
    }
    return dense;
}

void tell_failure(const char *what, const Solution &solution) {
    if (!solution.solved())
        std::printf("  %s: IPOPT ends with status %d%s%s\n", what, solution.status, solution.failure.empty() ? "" : "; Keepout said: ",
                    solution.failure.c_str());
}

Outcome plan_path(const char *name, double fit_seconds, Clearance &clearance, const keepout::Mesh &mesh, double diagonal) {
    Outcome found{};
    found.name = name;
    found.fit_seconds = fit_seconds;
    PathProblem path(entry, goal, clearance, LeastOf(diagonal, sharpness), path_clearance);
    found.path = solve_by_ipopt(path, path.start());
    tell_failure("path", found.path);
    found.curve = path.points(found.path.x, 1001);
    const std::vector<double> distances = mesh.signed_distance(found.curve);
    found.path_clearance = *std::min_element(distances.begin(), distances.end());
    std::printf("Path by %s: %d iterations\n", name, found.path.iterations);
    std::fflush(stdout);
    return found;
}

// Start 0 is the problem's own; of others the tubes are turned, all poses alike, by up to 1 rad, and up to 30 % more or less curved.
std::vector<double> perturbed(std::vector<double> x, const DesignProblem &design, unsigned number) {
    std::mt19937 random(number);
    const auto between = [&](double low, double high) { return low + (high - low) * random() / 4294967296.0; };
    for (int i = 0; i < n_tubes && number > 0; ++i) {
        const double factor = between(0.7, 1.3), turn = between(-1, 1);
        x[design.variable(kappa_0 + i, 0)] *= factor;
        for (std::size_t pose = 0; pose < n_poses; ++pose)
            x[design.variable(psi_0 + i, pose)] += turn;
    }
    return x;
}

void design_robot(Outcome &found, Clearance &clearance, const keepout::Mesh &mesh, const Tubes &tubes, double diagonal, unsigned start) {
    const std::vector<double> targets = points_along(found.curve, pose_shares(), found.path_length);
    clearance.seconds = 0;
    DesignProblem design(tubes, targets, clearance, LeastOf(diagonal, sharpness), tubes.radius[n_tubes - 1] + spare);
    found.design = solve_by_ipopt(design, perturbed(design.start(pose_shares(), found.path_length), design, start));
    tell_failure("design", found.design);
    std::printf("Robot by %s: %d iterations\n", found.name, found.design.iterations);
    std::fflush(stdout);
    found.formulation_seconds = clearance.seconds;
    found.model_seconds = design.model_seconds;

    Shape shape;
    found.poses.clear();
    found.tip_error = 0;
    for (std::size_t k = 0; k < n_poses; ++k) {
        found.poses.push_back(design.parameters(found.design.x.data(), k));
        solve(tubes, found.poses.back(), shape);
        const Vec3 tip = shape.tip();
        const double *target = &targets[3 * k];
        found.tip_error = std::max(found.tip_error, std::hypot(tip[0] - target[0], tip[1] - target[1], tip[2] - target[2]));
    }
    found.robot_clearance = check_robot(tubes, found.poses, mesh).clearance;
}

// Whether the tubes, turned at their bases, stay as they are: the least determinant of base by tip angles, over the poses. It begins at 1
// for the shortest robot; at 0 it would snap.
double least_stability(const Tubes &tubes, const std::vector<Parameters> &poses) {
    double least = std::numeric_limits<double>::infinity(), longest[n_tubes] = {0, 0, 0};
    for (const Parameters &pose : poses)
        for (int i = 0; i < n_tubes; ++i)
            longest[i] = std::max(longest[i], pose[end_0 + i]);
    Shape shape;
    for (const Parameters &pose : poses) {
        solve(tubes, pose, shape);
        Mat3 by{};
        for (int i = 0; i < n_tubes; ++i) {
            const double guided = straight_guide + longest[i] - pose[end_0 + i];
            for (int k = 0; k < n_tubes; ++k)
                by[3 * i + k] = shape.base_angle[i].by[psi_0 + k] - guided * shape.base_twist[i].by[psi_0 + k];
        }
        least = std::min(least, by[0] * (by[4] * by[8] - by[5] * by[7]) - by[1] * (by[3] * by[8] - by[5] * by[6]) +
                                    by[2] * (by[3] * by[7] - by[4] * by[6]));
    }
    return least;
}

void print_robot(const Tubes &tubes, const Outcome &found) {
    std::printf("\nThe robot by %s: tip within %.2f mm of the path; stability %.2f\n", found.name, found.tip_error,
                least_stability(tubes, found.poses));
    std::printf("  %-6s %10s %14s %14s %14s\n", "tube", "radius", "curvature", "curved length", "pushed to");
    for (int i = 0; i < n_tubes; ++i) {
        double from = found.poses[0][end_0 + i], to = from;
        for (const Parameters &pose : found.poses) {
            from = std::min(from, pose[end_0 + i]);
            to = std::max(to, pose[end_0 + i]);
        }
        std::printf("  %-6d %7.2f mm %9.4f 1/mm %11.1f mm %6.1f to %.1f mm\n", i + 1, tubes.radius[i], found.poses[0][kappa_0 + i],
                    found.poses[0][curved_0 + i], from, to);
    }
}

void print_table(const Outcome &field, const Outcome &lin) {
    std::printf("\n%-22s %9s | %11s %9s | %11s %9s | %9s | %9s %9s\n", "", "fit", "path: eval.", "time", "design: ev.",
                "time", "all", "clearance:", "robot");
    std::printf("%-22s %9s | %11s %9s | %11s %9s | %9s | %10s %8s\n", "", "s", "", "s", "", "s", "s", "path, mm", "mm");
    for (const Outcome *found : {&lin, &field})
        std::printf("%-22s %9.2f | %11d %9.2f | %11d %9.2f | %9.2f | %10.2f %8.2f\n", found->name, found->fit_seconds, found->path.evaluations,
                    found->path.seconds, found->design.evaluations, found->design.seconds, found->seconds(), found->path_clearance,
                    found->robot_clearance);
    std::printf("%-22s %9s | %11d %9.1f | %11d %9d | %9.1f |\n", "paper, Lin et al.", "", 37, 4.2, 35142, 11460, 11464.2);
    std::printf("%-22s %9.1f | %11d %9.1f | %11d %9d | %9.1f |\n", "paper, field", 8.7, 62, 0.9, 20793, 5040, 5049.6);
    std::printf("\nTimes are of the processor, one thread. The field takes %.2f of the time with Lin's formulation, its fit "
                "included (limit 0.33; the paper: 0.44)\n",
                field.seconds() / lin.seconds());
    for (const Outcome *found : {&lin, &field})
        std::printf("Of the design's time with %s: %.2f s in the formulation, %.2f s in the model of the robot, the rest IPOPT's own\n",
                    found->name, found->formulation_seconds, found->model_seconds);
}

// Of all the starts: what each took, and the mean.
bool compare_starts(Outcome &lin, Clearance &by_lin, Outcome &field, Clearance &by_field, const keepout::Mesh &mesh, const Tubes &tubes,
                    double diagonal, unsigned n_starts) {
    std::vector<Outcome> found[2];
    for (unsigned start = 0; start < n_starts; ++start) {
        design_robot(lin, by_lin, mesh, tubes, diagonal, start);
        design_robot(field, by_field, mesh, tubes, diagonal, start);
        found[0].push_back(lin);
        found[1].push_back(field);
    }
    std::printf("\nFit, path and design from each start; exact clearance [mm]\n%-6s | %-33s | %-33s | %s\n%-6s | %11s %9s %11s | %11s %9s %11s |\n",
                "", "Lin's formulation", "field", "field / Lin", "start",
                "design: ev.", "all, s", "clearance", "design: ev.", "all, s", "clearance");
    double sum[2] = {0, 0};
    bool good = true;
    for (unsigned start = 0; start < n_starts; ++start) {
        std::printf("%-6u |", start);
        for (int way = 0; way < 2; ++way) {
            const Outcome &one = found[way][start];
            std::printf(" %11d %9.2f %11.2f%s |", one.design.evaluations, one.seconds(), one.robot_clearance, one.design.solved() ? "" : "!");
            sum[way] += one.seconds();
            good = good && one.good();
        }
        std::printf(" %.2f\n", found[1][start].seconds() / found[0][start].seconds());
    }
    std::printf("%-6s | %11s %9.2f %11s | %11s %9.2f %11s | %.2f\n", "mean", "", sum[0] / n_starts, "", "",
                sum[1] / n_starts, "", sum[1] / sum[0]);
    return good;
}

int run_all(const std::string &data, const std::string &picture, unsigned n_starts) {
    const Tubes tubes = make_tubes();
    if (!check_model(tubes))
        return 1;

    const keepout::Mesh mesh = keepout::Mesh::read(data + "/" + mesh_file);
    std::printf("%s: %zu triangles\n", mesh_file, mesh.n_triangles());
    const keepout::Cloud dense = mesh.sample(n_field_points, /*seed*/ 1), coarse = mesh.sample(n_lin_points, /*seed*/ 1);
    double begin = processor_seconds();
    keepout::FitOptions fit_options;
    fit_options.n_threads = 1;
    fit_options.margin = 0.3; // the entry lies above the rim, and is to be in the box
    keepout::Field fitted = keepout::Field::fit(dense, fit_options);
    const double fit_seconds = processor_seconds() - begin;
    const ko_fit_report report = fitted.report();
    std::printf("Field: %u x %u x %u control points, fitted to %zu points in %.2f s; on the surface %.1e D RMS, %.1e D at most\n",
                report.control_points[0], report.control_points[1], report.control_points[2], n_field_points, fit_seconds, report.rms,
                report.max);
    begin = processor_seconds();
    keepout::ExplicitOptions lin_options;
    lin_options.formulation = KO_EXPLICIT_LIN;
    LinClearance by_lin(keepout::Explicit::create(coarse, lin_options));
    const double lin_seconds = processor_seconds() - begin;
    FieldClearance by_field(std::move(fitted));

    // Derivatives of both problems, before an optimiser sees them.
    const LeastOf least_of(report.diagonal, sharpness);
    for (Clearance *clearance : {static_cast<Clearance *>(&by_field), static_cast<Clearance *>(&by_lin)}) {
        PathProblem path(entry, goal, *clearance, least_of, path_clearance);
        double length;
        DesignProblem design(tubes, points_along(path.points(path.start(), 1001), pose_shares(), length), *clearance, least_of, 0);
        std::vector<double> at[2] = {path.start(), design.start(pose_shares(), length)};
        for (std::vector<double> &x : at) // off the straight line, where the path's energy has no gradient
            for (std::size_t k = 0; k < x.size(); ++k)
                x[k] += 0.1 * std::sin(static_cast<double>(k + 1));
        const double errors[2] = {derivative_error(path, at[0]), derivative_error(design, at[1])};
        std::printf("Derivatives with %s, to central differences, relative: path %.1e, design %.1e\n",
                    clearance == &by_field ? "the field" : "Lin's sum", errors[0], errors[1]);
        if (errors[0] > 1e-5 || errors[1] > 1e-5)
            return 1;
    }

    Outcome lin = plan_path("Lin's formulation", lin_seconds, by_lin, mesh, report.diagonal);
    Outcome field = plan_path("field", fit_seconds, by_field, mesh, report.diagonal);
    if (n_starts > 1)
        return compare_starts(lin, by_lin, field, by_field, mesh, tubes, report.diagonal, n_starts) ? 0 : 1;
    design_robot(lin, by_lin, mesh, tubes, report.diagonal, 0);
    design_robot(field, by_field, mesh, tubes, report.diagonal, 0);
    print_table(field, lin);
    print_robot(tubes, field);
    print_robot(tubes, lin);

    if (!picture.empty()) {
        std::vector<Panel> panels;
        for (const Outcome *found : {&field, &lin}) {
            const Dense shown = check_robot(tubes, found->poses, mesh);
            panels.push_back({std::string(found->name) + ": path and robot", found->curve, shown.points, shown.radii});
        }
        const std::vector<double> &curve = field.curve;
        const std::size_t middle = curve.size() / 6 * 3;
        write_picture(picture, mesh, entry, goal, {curve[middle], curve[middle + 1], curve[middle + 2]}, panels);
        std::printf("\nWrote %s\n", picture.c_str());
    }
    for (const Outcome *found : {&lin, &field})
        if (!found->good())
            std::printf("\nNOT a robot without collisions: %s\n", found->name);
    return lin.good() && field.good() ? 0 : 1;
}

} // namespace

int main(int argc, char **argv) {
    if (argc < 2) {
        std::fprintf(stderr, "keepout_robot DATA [PICTURE.svg | --starts NUMBER]: DATA is the folder of the test data\n");
        return 2;
    }
    try {
        const bool many = argc > 3 && std::string(argv[2]) == "--starts";
        return run_all(argv[1], argc > 2 && !many ? argv[2] : "", many ? static_cast<unsigned>(std::stoul(argv[3])) : 1);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "keepout_robot: %s\n", error.what());
        return 1;
    }
}
