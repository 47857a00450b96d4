// SPDX-License-Identifier: Apache-2.0 OR MIT
// A drone's path around the armadillo: from one side of it to the other in a given time, as short and as smooth as goes with the drone, a
// ball, clear of the armadillo; the path starts straight through it. The certificate of the field proves that the whole path is clear, not
// only the points that IPOPT looks at, and exact distances of points between them check it.
//
//   keepout_drone DATA [PICTURE.svg]
#include "picture.hpp"
#include "problem.hpp"

namespace {

constexpr std::size_t n_points = 201;
constexpr double metre = 10;          // of the file's unit: a monument, 15.1 m high
constexpr double radius = 0.3;        // of the drone, m
constexpr double longest_step = 0.12; // m; a path with longer steps is not proved by the certificate
constexpr double bending = 0.01;      // what acceleration weighs beside speed
constexpr Vector from = {-9.5, 3, 0}, to = {9.5, 4.5, 1};

// p_0, ..., p_n at even times of a unit of time: the mean square of speed and, weighed, of acceleration, both over the distance from
// start to end. 1 is what a straight path takes. The objective is a quadratic form, the same along each axis.
class Path : public Problem {
public:
    Path(const keepout::Constraints &kept, double least, const std::vector<double> &start)
        : Problem(kept, std::vector<double>(n_points, least), start) {
        for (const std::size_t end : {std::size_t{0}, n_points - 1})
            std::fill_n(held.begin() + 3 * end, 3, char{1});
        for (Index k = 0; k < static_cast<Index>(start.size()); ++k)
            for (Index back = 0; back <= 2 && k - 3 * back >= 0; ++back)
                own_hessian_.push_back({k, k - 3 * back});
    }

    double objective_at(const double *x, double *gradient) const override {
        double sum = 0;
        if (gradient != nullptr)
            std::fill_n(gradient, 3 * n_points, 0.0);
        each_term([&](std::size_t first, const std::vector<double> &factors, double weight) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                double term = 0;
                for (std::size_t k = 0; k < factors.size(); ++k)
                    term += factors[k] * x[3 * (first + k) + axis];
                sum += weight * term * term;
                for (std::size_t k = 0; gradient != nullptr && k < factors.size(); ++k)
                    gradient[3 * (first + k) + axis] += 2 * weight * term * factors[k];
            }
        });
        return sum;
    }

    void own_hessian(const double *, double factor, const double *, double *entries) const override {
        std::vector<double> band(3 * n_points); // of one axis: a row's entries with itself, the one before, and that before it
        each_term([&](std::size_t first, const std::vector<double> &factors, double weight) {
            for (std::size_t k = 0; k < factors.size(); ++k)
                for (std::size_t l = 0; l <= k; ++l)
                    band[3 * (first + k) + (k - l)] += 2 * weight * factors[k] * factors[l];
        });
        for (std::size_t k = 0; k < own_hessian_.size(); ++k) {
            const Entry &entry = own_hessian_[k];
            entries[k] = factor * band[entry.row / 3 * 3 + (entry.row - entry.column) / 3];
        }
    }

private:
    // The objective is a sum of weight * (factors . p_first ...)^2 along each axis.
    template <class Take>
    static void each_term(const Take &take) {
        const double step = 1.0 / (n_points - 1), distance = dot(to - from, to - from);
        for (std::size_t i = 0; i + 1 < n_points; ++i)
            take(i, {-1, 1}, 1 / (step * distance));
        for (std::size_t i = 0; i + 2 < n_points; ++i)
            take(i, {1, -2, 1}, bending / (step * step * step * distance));
    }
};

keepout::Mesh read_monument(const std::string &path) {
    const keepout::Mesh mesh = keepout::Mesh::read(path);
    std::vector<double> vertices = mesh.vertices();
    for (double &coordinate : vertices)
        coordinate /= metre;
    return keepout::Mesh::from_triangles(vertices, mesh.triangles());
}

// `count` points of each step, evenly.
std::vector<double> between(const std::vector<double> &path, int count) {
    std::vector<double> points;
    for (std::size_t i = 0; i + 3 < path.size(); i += 3)
        for (int s = 0; s < count; ++s)
            for (int k = 0; k < 3; ++k)
                points.push_back(path[i + k] + (s + 0.5) / count * (path[i + 3 + k] - path[i + k]));
    return points;
}

double exact_clearance(const keepout::Mesh &mesh, const std::vector<double> &path) {
    const std::vector<double> distances = mesh.signed_distance(between(path, 50));
    return *std::min_element(distances.begin(), distances.end());
}

// The path's length, and its longest step.
std::pair<double, double> steps_of(const std::vector<double> &path) {
    double length = 0, longest = 0;
    for (std::size_t i = 0; i + 3 < path.size(); i += 3) {
        const double step = std::hypot(path[i + 3] - path[i], path[i + 4] - path[i + 1], path[i + 5] - path[i + 2]);
        length += step;
        longest = std::max(longest, step);
    }
    return {length, longest};
}

void draw(const keepout::Mesh &mesh, const std::vector<double> &start, const std::vector<double> &path, const std::string &file) {
    Picture picture(/*toward*/ {0.25, 0.45, -1}, /*up*/ {0, 1, 0});
    picture.add(mesh.vertices(), mesh.triangles(), {0.75, 0.78, 0.72}, Faces::front, 0);
    for (const bool is_end : {false, true}) {
        std::vector<double> vertices;
        std::vector<std::uint32_t> triangles;
        make_tube(is_end ? path : start, is_end ? radius : 0.3 * radius, vertices, triangles); // the room that the drone takes
        picture.add(vertices, triangles, is_end ? Vector{0.85, 0.2, 0.15} : Vector{0.5, 0.5, 0.9}, Faces::front, 0);
    }
    picture.write(file);
}

int run(const Arguments &arguments) {
    Outcome outcome;
    outcome.name = "drone";
    outcome.wanted = radius;
    outcome.unit = "m";
    const keepout::Mesh mesh = read_monument(arguments.data + "/stanford/armadillo_cgal.off");
    keepout::FitOptions options = fit_options(KO_FEASIBLE_OUTSIDE);
    options.max_error = 1e-3; // of the diagonal: the nearer the field, the less room the proof takes
    const keepout::Field field = fit("the armadillo", mesh, 100000, options, outcome);

    // No point of the path is farther than half a step from one of its points.
    keepout::CertifyOptions certify_options;
    certify_options.n_threads = 1;
    const double begin = processor_seconds();
    const ko_certificate certificate = field.certify(mesh, radius, longest_step / 2, certify_options);
    std::printf("Certified in %.2f s: phi above %.4f m at the points of a path keeps all of it %.1f m clear\n", processor_seconds() - begin,
                certificate.threshold, radius);

    keepout::Constraints kept = keepout::Constraints::create(3);
    keepout::Aggregation none;
    none.kind = KO_AGGREGATE_NONE;
    kept.keep_points(kept.add_points(n_points), field, KO_WORLD, none);
    std::vector<double> start;
    for (std::size_t i = 0; i < n_points; ++i)
        for (int k = 0; k < 3; ++k)
            start.push_back(from[k] + i / (n_points - 1.0) * (to[k] - from[k]));
    outcome.start = exact_clearance(mesh, start);
    std::printf("Start: length %.3f m, %.3f m from the armadillo\n", steps_of(start).first, outcome.start);
    const Ipopt::SmartPtr<Problem> problem = new Path(kept, certificate.threshold * 1.001, start);
    solve(problem, /*unit*/ 10, outcome);

    const std::vector<double> &path = problem->x, values = kept.values(path);
    outcome.field = *std::min_element(values.begin(), values.end());
    outcome.exact = exact_clearance(mesh, path);
    const auto [length, longest] = steps_of(path);
    std::printf("End:   length %.3f m, steps up to %.3f m; %.3f m at most for the proof\n", length, longest, longest_step);
    if (!arguments.picture.empty())
        draw(mesh, start, path, arguments.picture);
    outcome.solved = outcome.solved && longest < longest_step && certificate.side_certified == 1;
    return report(outcome) ? 0 : 1;
}

} // namespace

int main(int argc, char **argv) {
    try {
        return run(Arguments(argc, argv, "stanford/armadillo_cgal.off"));
    } catch (const std::exception &error) {
        std::fprintf(stderr, "keepout_drone: %s\n", error.what());
        return 1;
    }
}
