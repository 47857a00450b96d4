// SPDX-License-Identifier: Apache-2.0 OR MIT
// Packs five bodies into a tank by IPOPT, as near to the pump and as upright as they go, with exact Hessians and with IPOPT's own
// approximation of them, and checks both optima without trusting either IPOPT or the fields.
//
//   keepout_layout [PICTURE.obj]     writes the packed tank there
//   keepout_layout --starts 10       from ten starts, to compare the two
//   keepout_layout --broken-start    from a quaternion of length 0: shows what becomes of a point that Keepout refuses
#include "constraints_nlp.hpp"
#include "shapes.hpp"

#include <IpIpoptApplication.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace {

using Body = std::unique_ptr<ko_body, decltype(&ko_body_free)>;
using Constraints = std::unique_ptr<ko_constraints, decltype(&ko_constraints_free)>;

constexpr double least = 5e-3;     // every value is kept above this: room for the fields' error, beside KS, which is on the safe side
constexpr double covering = 0.03;  // no point of a body is farther than this from one that is looked at
constexpr double pump[3] = {0.15, 0.1, -0.3};
constexpr double upright = 0.1;    // what turning a body weighs beside moving it

// A thing to pack: its surface, the field around it, the points that stand for it in other fields, and where it starts, in the way of others.
struct Thing {
    const char *name;
    keepout::Mesh mesh;
    keepout::Field field;
    Body body;
    double mass;
    double start[3];
};

void check(std::int32_t status) {
    if (status < 0)
        throw keepout::Error(status, ko_last_error());
}

keepout::Field fit(const keepout::Mesh &mesh, std::int32_t feasible, double margin) {
    keepout::FitOptions options;
    options.feasible = feasible;
    options.margin = margin;
    return keepout::Field::fit(mesh.sample(10000, /*seed*/ 1), options);
}

Thing make_thing(const char *name, keepout::Mesh mesh, double mass, double x, double y, double z) {
    // Most of the others' points are beside this thing: a wide box, since outside of it a field takes ten times as long.
    keepout::Field field = fit(mesh, KO_FEASIBLE_OUTSIDE, /*margin*/ 1.5);
    ko_body *body = nullptr;
    check(ko_body_from_mesh(mesh.get(), covering, &body));
    return {name, std::move(mesh), std::move(field), Body(body, ko_body_free), mass, {x, y, z}};
}

std::vector<Thing> make_things() {
    std::vector<Thing> things;
    things.push_back(make_thing("battery", make_box(0.36, 0.22, 0.2, 4), 3, 0.1, 0.0, -0.3));
    things.push_back(make_thing("motor", make_box(0.3, 0.24, 0.24, 2), 2, 0.4, 0.1, 0.0));
    things.push_back(make_thing("pipe", make_box(0.5, 0.12, 0.12, 4), 1, 0.1, 0.4, -0.1));
    things.push_back(make_thing("plate", make_box(0.3, 0.3, 0.08, 4), 1, 0.1, -0.1, 0.2));
    things.push_back(make_thing("valve", make_box(0.18, 0.18, 0.18, 2), 1, -0.3, -0.1, 0.0));
    return things;
}

// Each thing in the tank, and each in the field of each other, both ways: an edge of one may be in a face of the other, or the reverse.
Constraints make_constraints(const std::vector<Thing> &things, const keepout::Field &tank) {
    ko_constraints *made = nullptr;
    check(ko_constraints_create(3, &made));
    Constraints constraints(made, ko_constraints_free);
    ko_aggregation sharp;
    check(ko_aggregation_init(&sharp, sizeof sharp)); // KS from below
    sharp.sharpness = 250; // the default, 500, packs closer, and takes twice the iterations
    std::vector<std::uint32_t> frames(things.size());
    for (std::uint32_t &frame : frames)
        check(ko_constraints_add_frame(made, KO_ROTATION_QUATERNION, KO_SCALE_ONE, &frame));
    for (std::size_t i = 0; i < things.size(); ++i) {
        const ko_body *body = things[i].body.get();
        check(ko_constraints_keep_body(made, body, frames[i], tank.get(), KO_WORLD, &sharp, nullptr));
        for (std::size_t j = 0; j < things.size(); ++j)
            if (j != i)
                check(ko_constraints_keep_body(made, body, frames[i], things[j].field.get(), frames[j], &sharp, nullptr));
    }
    return constraints;
}

// Of a frame's parameters, a place and a quaternion w, x, y, z: the rotation, row by row.
void rotation_of(const double *pose, double r[9]) {
    const double *q = pose + 3, length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
    const double rows[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                            2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                            2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)};
    std::copy(rows, rows + 9, r);
}

// Points of a body's frame to the world, or, `back`, those of the world to it.
std::vector<double> moved(const std::vector<double> &points, const double *pose, bool back) {
    double r[9];
    rotation_of(pose, r);
    std::vector<double> to(points.size());
    for (std::size_t i = 0; i < points.size(); i += 3)
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l)
                to[i + k] += back ? r[3 * l + k] * (points[i + l] - pose[l]) : r[3 * k + l] * points[i + l] + (l == k ? pose[k] : 0);
    return to;
}

// The least distance of densely sampled bodies to the tank's wall and to each other, by the meshes alone; negative where they collide.
double exact_clearance(const std::vector<Thing> &things, const keepout::Mesh &tank, const std::vector<double> &x) {
    double clearance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < things.size(); ++i) {
        const std::vector<double> points = moved(things[i].mesh.sample(5000, /*seed*/ 2).points(), &x[7 * i], false);
        for (const double distance : tank.signed_distance(points))
            clearance = std::min(clearance, -distance);
        for (std::size_t j = 0; j < things.size(); ++j)
            if (j != i)
                for (const double distance : things[j].mesh.signed_distance(moved(points, &x[7 * j], true)))
                    clearance = std::min(clearance, distance);
    }
    return clearance;
}

// How far x is from an optimum, by the Karush-Kuhn-Tucker conditions: the gradient of the Lagrangian, constraints that are missed,
// multipliers of the wrong sign, and those of constraints that are not active.
double kkt_residual(ConstraintsNlp &problem, const ko_constraints *constraints) {
    const std::size_t n = problem.x.size(), m = problem.values.size();
    std::vector<double> gradient(n), pull(n), values(m);
    problem.eval_grad_f(static_cast<int>(n), problem.x.data(), true, gradient.data());
    check(ko_constraints_transposed_jacobian_times(constraints, problem.x.data(), n, problem.multipliers.data(), m, pull.data()));
    check(ko_constraints_values(constraints, problem.x.data(), n, m, values.data()));
    double residual = 0;
    for (std::size_t k = 0; k < n; ++k)
        residual = std::max(residual, std::fabs(gradient[k] + pull[k]));
    for (std::size_t i = 0; i < m; ++i) {
        const double room = values[i] - least, multiplier = -problem.multipliers[i];
        residual = std::max({residual, -room, -multiplier, std::fabs(multiplier * room)});
    }
    return residual;
}

// Each thing is to be at the pump, weighed by its mass, and not turned. That term also keeps the quaternions' lengths, which mean nothing
// else: turned by an angle a, the best one is cos(a / 2).
Ipopt::SmartPtr<ConstraintsNlp> make_problem(const std::vector<Thing> &things, const ko_constraints *constraints,
                                             const std::vector<double> &start) {
    std::vector<double> weights, targets;
    for (const Thing &thing : things) {
        weights.insert(weights.end(), {thing.mass, thing.mass, thing.mass, upright, upright, upright, upright});
        targets.insert(targets.end(), {pump[0], pump[1], pump[2], 1, 0, 0, 0});
    }
    return new ConstraintsNlp(constraints, least, weights, targets, start);
}

// Start 0 is that of the list of things; others lie up to 0.15 beside it along each axis.
std::vector<double> make_start(const std::vector<Thing> &things, unsigned number, double quaternion_length) {
    std::mt19937 random(number);
    std::vector<double> start;
    for (const Thing &thing : things) {
        for (const double coordinate : thing.start)
            start.push_back(coordinate + (number == 0 ? 0 : 0.3 * (random() / 4294967296.0 - 0.5)));
        start.insert(start.end(), {quaternion_length, 0, 0, 0});
    }
    return start;
}

struct Run {
    Ipopt::SmartPtr<ConstraintsNlp> problem;
    Ipopt::ApplicationReturnStatus status = Ipopt::Internal_Error;
    double seconds = 0; // of processor time
};

Run solve(const Ipopt::SmartPtr<ConstraintsNlp> &problem, const char *hessian) {
    Ipopt::SmartPtr<Ipopt::IpoptApplication> ipopt = new Ipopt::IpoptApplication();
    ipopt->Options()->SetStringValue("hessian_approximation", hessian);
    ipopt->Options()->SetStringValue("sb", "yes"); // no banner
    ipopt->Options()->SetIntegerValue("print_level", 0);
    ipopt->Options()->SetStringValue("mu_strategy", "adaptive");
    ipopt->Options()->SetNumericValue("tol", 1e-8);
    ipopt->Options()->SetNumericValue("acceptable_tol", 1e-8); // nothing less
    ipopt->Options()->SetIntegerValue("max_iter", 1000);
    ipopt->Initialize();
    const std::clock_t begin = std::clock();
    const Ipopt::ApplicationReturnStatus status = ipopt->OptimizeTNLP(problem);
    return {problem, status, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC};
}

// The tank's lower half and the bodies, as one mesh for a viewer.
void write_picture(const std::vector<Thing> &things, const keepout::Mesh &tank, const std::vector<double> &x, const char *path) {
    std::vector<double> vertices = tank.vertices();
    std::vector<std::uint32_t> triangles;
    const std::vector<std::uint32_t> wall = tank.triangles();
    for (std::size_t i = 0; i < wall.size(); i += 3)
        if (vertices[3 * wall[i] + 2] < 0)
            triangles.insert(triangles.end(), {wall[i], wall[i + 1], wall[i + 2]});
    for (std::size_t i = 0; i < things.size(); ++i) {
        const auto first = static_cast<std::uint32_t>(vertices.size() / 3);
        for (const double coordinate : moved(things[i].mesh.vertices(), &x[7 * i], false))
            vertices.push_back(coordinate);
        for (const std::uint32_t corner : things[i].mesh.triangles())
            triangles.push_back(first + corner);
    }
    keepout::Mesh::from_triangles(vertices, triangles).write(path);
    std::printf("Wrote %s\n", path);
}

// Solves from one start both ways, into `runs`; the optimum by exact Hessians is left in `x`. False where one of them found none.
bool compare(const std::vector<Thing> &things, const keepout::Mesh &tank, const ko_constraints *constraints, std::vector<double> &x,
             Run runs[2]) {
    const char *const ways[2] = {"exact", "limited-memory"};
    bool solved = true;
    for (int way = 0; way < 2; ++way) {
        runs[way] = solve(make_problem(things, constraints, x), ways[way]);
        const ConstraintsNlp &problem = *runs[way].problem;
        if (runs[way].status != Ipopt::Solve_Succeeded) {
            std::printf("%-16s %10d %8.2f IPOPT ends with status %d%s%s\n", ways[way], problem.iterations, runs[way].seconds, runs[way].status,
                        problem.failure.empty() ? "" : "; Keepout said: ", problem.failure.c_str());
            solved = false;
            continue;
        }
        const double residual = kkt_residual(*runs[way].problem, constraints);
        const double clearance = exact_clearance(things, tank, problem.x);
        const bool good = residual < 1e-6 && clearance > 0;
        std::printf("%-16s %10d %8.2f %11.6f %10.1e %10.5f%s\n", ways[way], problem.iterations, runs[way].seconds, problem.objective, residual,
                    clearance, good ? "" : " NOT an optimum without collisions");
        std::fflush(stdout);
        solved = solved && good;
    }
    if (solved)
        x = runs[0].problem->x;
    return solved;
}

void print_poses(const std::vector<Thing> &things, const std::vector<double> &x) {
    for (std::size_t i = 0; i < things.size(); ++i) {
        const double *pose = &x[7 * i];
        const double turned = 2 * std::atan2(std::hypot(pose[4], pose[5], pose[6]), pose[3]);
        std::printf("%-8s at %7.4f %7.4f %7.4f, turned by %5.1f degrees\n", things[i].name, pose[0], pose[1], pose[2], turned * 180 / M_PI);
    }
}

// Whether the arguments are some that the head of this file has; n_starts is set where it is given.
bool understood(const std::vector<std::string> &arguments, unsigned &n_starts) {
    const std::string first = arguments.empty() ? "" : arguments[0];
    if (first == "--starts") {
        const std::string number = arguments.size() == 2 ? arguments[1] : "";
        const bool counts = !number.empty() && number.size() <= 6 && number.find_first_not_of("0123456789") == std::string::npos;
        n_starts = counts ? static_cast<unsigned>(std::stoul(number)) : 0;
        return n_starts > 0;
    }
    return arguments.size() <= 1 && (first.empty() || first[0] != '-' || first == "--broken-start");
}

int run(const std::vector<std::string> &arguments) {
    const std::string first = arguments.empty() ? "" : arguments[0];
    unsigned n_starts = 1;
    if (!understood(arguments, n_starts)) {
        std::fprintf(stderr, "usage: keepout_layout [PICTURE.obj | --starts NUMBER | --broken-start]\n");
        return 1;
    }
    std::printf("Fitting the tank and five bodies ...\n");
    const keepout::Mesh tank_mesh = make_tank();
    const keepout::Field tank = fit(tank_mesh, KO_FEASIBLE_INSIDE, /*margin*/ 0.15);
    const std::vector<Thing> things = make_things();
    const Constraints constraints = make_constraints(things, tank);

    std::size_t n, m, samples = 0, size;
    check(ko_constraints_get_size(constraints.get(), &n, &m, nullptr, nullptr));
    for (const Thing &thing : things) {
        check(ko_body_get_size(thing.body.get(), &size));
        samples += size * things.size();
    }
    std::printf("%zu variables, %zu constraints over %zu samples\n", n, m, samples);
    std::printf("Start: exact clearance %.4f\n", exact_clearance(things, tank_mesh, make_start(things, 0, 1)));

    std::printf("\n%-16s %10s %8s %11s %10s %10s\n", "Hessian", "iterations", "seconds", "objective", "KKT", "clearance");
    double iterations[2] = {0, 0}, seconds[2] = {0, 0};
    unsigned n_solved = 0;
    std::vector<double> x;
    for (unsigned number = 0; number < n_starts; ++number) {
        x = make_start(things, number, first == "--broken-start" ? 0 : 1);
        Run runs[2];
        if (!compare(things, tank_mesh, constraints.get(), x, runs))
            continue;
        ++n_solved;
        for (int way = 0; way < 2; ++way) {
            iterations[way] += runs[way].problem->iterations;
            seconds[way] += runs[way].seconds;
        }
    }
    if (n_solved == 0)
        return 1;
    if (n_starts > 1) {
        std::printf("\nMeans of %u starts that both solve: exact %.1f iterations, %.2f s; limited-memory %.1f iterations, %.2f s\n", n_solved,
                    iterations[0] / n_solved, seconds[0] / n_solved, iterations[1] / n_solved, seconds[1] / n_solved);
        if (n_solved < n_starts)
            std::printf("%u of %u starts were not solved both ways\n", n_starts - n_solved, n_starts);
        return n_solved < n_starts ? 1 : 0;
    }
    std::printf("\n");
    print_poses(things, x);
    std::vector<double> values(m);
    check(ko_constraints_values(constraints.get(), x.data(), n, m, values.data()));
    const auto active = [](double value) { return value < least + 1e-6; };
    std::printf("%td of %zu constraints are active\n", std::count_if(values.begin(), values.end(), active), m);
    if (!first.empty() && first[0] != '-')
        write_picture(things, tank_mesh, x, first.c_str());
    std::printf("An optimum without collisions.\n");
    return 0;
}

} // namespace

int main(int argc, char **argv) {
    try {
        return run(std::vector<std::string>(argv + 1, argv + argc));
    } catch (const std::exception &error) {
        std::fprintf(stderr, "keepout_layout: %s\n", error.what());
        return 1;
    }
}
