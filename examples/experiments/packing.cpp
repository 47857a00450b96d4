// SPDX-License-Identifier: Apache-2.0 OR MIT
// What an aircraft carries, packed into its fuselage: two battery packs and four other bodies, placed and turned by IPOPT so that all of
// them can be as large as may be, by one common factor. They start in each other and in the walls. Every body is kept in the field of the
// fuselage and in those of all others by one smooth value each; the optimum is checked by the triangles: how far they are apart, whether
// they cross, which side they are on.
//
//   keepout_packing DATA [PICTURE.svg]
#include "../ipopt/shapes.hpp"
#include "picture.hpp"
#include "problem.hpp"

namespace {

constexpr double dm = 100;          // of the files' mm: variables are of the order of 1
constexpr double covering = 0.06;   // dm; no point of a body is farther than this from one that is looked at
constexpr double least = 0.015;     // dm; room for the fields' errors at edges, and for what is between samples
constexpr std::size_t n_pose = 8;   // a place, a quaternion, a scale

// A body: its surface, the field around it, the points that stand for it in other fields, where it starts.
struct Thing {
    const char *name;
    Vector colour;
    keepout::Mesh mesh;
    keepout::Field field;
    keepout::Body body;
    Vector start;
};

keepout::Mesh read_mesh(const std::string &path) {
    const keepout::Mesh mesh = keepout::Mesh::read(path);
    std::vector<double> vertices = mesh.vertices();
    for (double &coordinate : vertices)
        coordinate /= dm;
    return keepout::Mesh::from_triangles(vertices, mesh.triangles());
}

Thing make_thing(const char *name, const Vector &colour, keepout::Mesh mesh, const Vector &start, Outcome &outcome) {
    keepout::FitOptions options = fit_options(KO_FEASIBLE_OUTSIDE);
    options.margin = 1; // others are beside it: outside of its box a field takes ten times as long
    keepout::Field field = fit(name, mesh, 20000, options, outcome);
    keepout::Body body = keepout::Body::from_mesh(mesh, covering);
    return {name, colour, std::move(mesh), std::move(field), std::move(body), start};
}

std::vector<Thing> make_things(const std::string &data, Outcome &outcome) {
    const std::string battery = data + "/aircraft/battery_pack_skinny_b.stl";
    const Vector yellow = {0.95, 0.75, 0.2}, green = {0.3, 0.7, 0.4}, blue = {0.3, 0.5, 0.85}, red = {0.85, 0.35, 0.3};
    const Vector violet = {0.6, 0.4, 0.75};
    std::vector<Thing> things;
    things.push_back(make_thing("battery 1", yellow, read_mesh(battery), {0.1, 0.2, -0.05}, outcome));
    things.push_back(make_thing("battery 2", yellow, read_mesh(battery), {-0.1, 0.4, 0.2}, outcome));
    things.push_back(make_thing("autopilot", green, make_box(0.2, 0.35, 0.12, 4), {0.1, 1.2, 0.15}, outcome));
    things.push_back(make_thing("computer", blue, make_box(0.35, 0.25, 0.1, 4), {-0.2, -0.3, 0.1}, outcome));
    things.push_back(make_thing("camera", red, make_box(0.2, 0.2, 0.2, 2), {0.25, 1.6, 0}, outcome));
    things.push_back(make_thing("receiver", violet, make_box(0.15, 0.15, 0.08, 4), {-0.3, 0.9, 0.2}, outcome));
    return things;
}

// The poses of the bodies are the variables. Own values are the squares of the quaternions' lengths, which are to be 1, and how much each
// scale is above the first, which is to be 0. The objective is that first scale, to be large, for which it is taken off.
class Packing : public Problem {
public:
    Packing(const keepout::Constraints &kept, const std::vector<double> &start)
        : Problem(kept, std::vector<double>(kept.size().n_values, least), start), n_(static_cast<Index>(start.size() / n_pose)) {
        for (Index i = 0; i < n_; ++i) {
            add_own_value(1, 1);
            for (Index k = 3; k < 7; ++k) {
                own_jacobian_.push_back({i, 8 * i + k});
                own_hessian_.push_back({8 * i + k, 8 * i + k});
            }
        }
        for (Index i = 1; i < n_; ++i) {
            add_own_value(0, 0);
            own_jacobian_.push_back({n_ + i - 1, 8 * i + 7});
            own_jacobian_.push_back({n_ + i - 1, 7});
        }
    }

    double objective_at(const double *x, double *gradient) const override {
        if (gradient != nullptr) {
            std::fill_n(gradient, n_pose * n_, 0.0);
            gradient[7] = -1;
        }
        return -x[7];
    }

    void own_values(const double *x, double *g) const override {
        for (Index i = 0; i < n_; ++i) {
            const double *q = x + 8 * i + 3;
            g[i] = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        }
        for (Index i = 1; i < n_; ++i)
            g[n_ + i - 1] = x[8 * i + 7] - x[7];
    }

    void own_jacobian(const double *x, double *entries) const override {
        for (Index i = 0; i < n_; ++i)
            for (Index k = 3; k < 7; ++k)
                *entries++ = 2 * x[8 * i + k];
        for (Index i = 1; i < n_; ++i) {
            *entries++ = 1;
            *entries++ = -1;
        }
    }

    void own_hessian(const double *, double, const double *lambda, double *entries) const override {
        for (Index i = 0; i < n_; ++i)
            for (Index k = 3; k < 7; ++k)
                *entries++ = 2 * lambda[i];
    }

private:
    Index n_;
};

// The body at a pose, as a mesh of the world.
keepout::Mesh placed(const keepout::Mesh &mesh, const double *pose) {
    const double *q = pose + 3, length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                         2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)};
    const std::vector<double> from = mesh.vertices();
    std::vector<double> to(from.size());
    for (std::size_t i = 0; i < from.size(); i += 3)
        for (int k = 0; k < 3; ++k)
            to[i + k] = pose[k] + pose[7] * (r[3 * k] * from[i] + r[3 * k + 1] * from[i + 1] + r[3 * k + 2] * from[i + 2]);
    return keepout::Mesh::from_triangles(to, mesh.triangles());
}

std::vector<keepout::Mesh> all_placed(const std::vector<Thing> &things, const std::vector<double> &x) {
    std::vector<keepout::Mesh> meshes;
    for (std::size_t i = 0; i < things.size(); ++i)
        meshes.push_back(placed(things[i].mesh, &x[n_pose * i]));
    return meshes;
}

// The least distance between triangles of any two, 0 where they cross or one is in the other, or is not in the fuselage.
double triangles_apart(const std::vector<keepout::Mesh> &bodies, const keepout::Mesh &fuselage) {
    double apart = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const ko_separation wall = keepout::separation(fuselage, bodies[i]);
        apart = std::min(apart, wall.b_in_a == 1 && wall.intersection_length == 0 ? wall.minimum_distance : 0);
        for (std::size_t j = 0; j < i; ++j) {
            const ko_separation two = keepout::separation(bodies[i], bodies[j]);
            const bool off = two.a_in_b == 0 && two.b_in_a == 0 && two.intersection_length == 0;
            apart = std::min(apart, off ? two.minimum_distance : 0);
        }
    }
    return apart;
}

// The least exact distance of densely sampled bodies to the wall and to each other, negative where they collide: how deep.
double exact_clearance(const std::vector<keepout::Mesh> &bodies, const keepout::Mesh &fuselage) {
    double clearance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const std::vector<double> points = bodies[i].sample(20000, /*seed*/ 2).points();
        for (const double distance : fuselage.signed_distance(points))
            clearance = std::min(clearance, -distance);
        for (std::size_t j = 0; j < bodies.size(); ++j)
            if (j != i)
                for (const double distance : bodies[j].signed_distance(points))
                    clearance = std::min(clearance, distance);
    }
    return clearance;
}

// From above, into the fuselage: of it only what faces away.
void draw(const std::vector<Thing> &things, const std::vector<keepout::Mesh> &bodies, const keepout::Mesh &fuselage,
          const std::string &file) {
    Picture picture(/*toward*/ {0.5, -0.35, 1}, /*up*/ {0, 1, 0});
    picture.add(fuselage.vertices(), fuselage.triangles(), {0.85, 0.88, 0.92}, Faces::back, 0);
    for (std::size_t i = 0; i < bodies.size(); ++i)
        picture.add(bodies[i].vertices(), bodies[i].triangles(), things[i].colour, Faces::front, 1);
    picture.write(file);
}

int run(const Arguments &arguments) {
    Outcome outcome;
    outcome.name = "packing";
    outcome.unit = "mm";
    outcome.scale = dm;
    const keepout::Mesh fuselage = read_mesh(arguments.data + "/aircraft/fuselage_skinny_b.stl");
    const keepout::Field inside = fit("the fuselage", fuselage, 50000, fit_options(KO_FEASIBLE_INSIDE), outcome);
    const std::vector<Thing> things = make_things(arguments.data, outcome);

    // Each in the fuselage, and in the field of each other, both ways: an edge of one may be in a face of the other, or the reverse.
    keepout::Constraints kept = keepout::Constraints::create(3);
    std::vector<std::uint32_t> frames;
    std::vector<double> start;
    std::size_t n_samples = 0;
    for (const Thing &thing : things) {
        frames.push_back(kept.add_frame(KO_ROTATION_QUATERNION, KO_SCALE_FREE));
        start.insert(start.end(), {thing.start[0], thing.start[1], thing.start[2], 1, 0, 0, 0, 1});
        n_samples += thing.body.size() * things.size();
    }
    for (std::size_t i = 0; i < things.size(); ++i) {
        kept.keep_body(things[i].body, frames[i], inside);
        for (std::size_t j = 0; j < things.size(); ++j)
            if (j != i)
                kept.keep_body(things[i].body, frames[i], things[j].field, frames[j]);
    }
    outcome.start = dm * exact_clearance(all_placed(things, start), fuselage);
    std::printf("%zu samples of bodies in fields; at the start they are up to %.1f mm in each other or in the wall\n", n_samples,
                -outcome.start);
    const Ipopt::SmartPtr<Problem> problem = new Packing(kept, start);
    solve(problem, /*unit*/ 1, outcome);

    const std::vector<double> &x = problem->x, values = kept.values(x);
    const std::vector<keepout::Mesh> bodies = all_placed(things, x);
    outcome.field = dm * *std::min_element(values.begin(), values.end());
    outcome.exact = dm * exact_clearance(bodies, fuselage);
    const double apart = dm * triangles_apart(bodies, fuselage);
    for (std::size_t i = 0; i < things.size(); ++i) {
        const double *pose = &x[n_pose * i];
        std::printf("%-9s at %6.1f %6.1f %6.1f mm, turned by %5.1f degrees\n", things[i].name, dm * pose[0], dm * pose[1], dm * pose[2],
                    2 * 180 / std::acos(-1.0) * std::atan2(std::hypot(pose[4], pose[5], pose[6]), std::fabs(pose[3])));
    }
    std::printf("All %.4f times as large as given; triangles of two are %.4f mm apart at least, and on their sides\n", x[7], apart);
    if (!arguments.picture.empty())
        draw(things, bodies, fuselage, arguments.picture);
    outcome.exact = std::min(outcome.exact, apart);
    return report(outcome) ? 0 : 1;
}

} // namespace

int main(int argc, char **argv) {
    try {
        return run(Arguments(argc, argv, "aircraft/fuselage_skinny_b.stl"));
    } catch (const std::exception &error) {
        std::fprintf(stderr, "keepout_packing: %s\n", error.what());
        return 1;
    }
}
