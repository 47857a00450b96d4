// SPDX-License-Identifier: Apache-2.0 OR MIT
// A cable laid through a knot by Ceres: as short and straight as it goes with its distance to the knot kept. All samples of the cable are
// evaluated in ONE batch for each step, in an EvaluationCallback; cost functions only look up their share. The result is checked by the
// gradient of the cost, and by exact distances of the whole cable to the knot.
//
//   keepout_path [PICTURE.obj]      writes the knot and the cable there
//   keepout_path --broken-start     starts with a point beyond all bounds: shows what becomes of a point that Keepout refuses
#include <keepout.hpp>

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using Point = std::array<double, 3>;

constexpr double turn = 6.283185307179586;
constexpr int n_segments = 150, per_segment = 8;
constexpr double clearance = 0.15;  // wanted between cable and knot
constexpr double softness = 0.02;   // how gradually the clearance sets in
constexpr double force = 30, tension = 1, stiffness = 10; // weights of clearance, length, and bending

Point cross(const Point &a, const Point &b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Point unit(const Point &a) {
    const double length = std::hypot(a[0], a[1], a[2]);
    return {a[0] / length, a[1] / length, a[2] / length};
}

// A tube around c(t) = (2 cos 2t - cos t, sin t + 2 sin 2t, 0.65 sin 3t), by the curve's normals and binormals.
keepout::Mesh make_knot() {
    constexpr std::uint32_t along = 360, around = 48;
    constexpr double radius = 0.42, rise = 0.65;
    std::vector<double> vertices;
    std::vector<std::uint32_t> triangles;
    for (std::uint32_t i = 0; i < along; ++i) {
        const double t = turn * i / along;
        const Point centre = {2 * std::cos(2 * t) - std::cos(t), std::sin(t) + 2 * std::sin(2 * t), rise * std::sin(3 * t)};
        const Point first = {std::sin(t) - 4 * std::sin(2 * t), std::cos(t) + 4 * std::cos(2 * t), 3 * rise * std::cos(3 * t)};
        const Point second = {std::cos(t) - 8 * std::cos(2 * t), -std::sin(t) - 8 * std::sin(2 * t), -9 * rise * std::sin(3 * t)};
        const Point binormal = unit(cross(first, second)), normal = unit(cross(binormal, first));
        for (std::uint32_t j = 0; j < around; ++j) {
            const double angle = turn * j / around;
            for (int k = 0; k < 3; ++k)
                vertices.push_back(centre[k] + radius * (std::cos(angle) * normal[k] + std::sin(angle) * binormal[k]));
            const std::uint32_t next_i = (i + 1) % along, next_j = (j + 1) % around;
            const std::uint32_t a = i * around + j, b = i * around + next_j, c = next_i * around + next_j, d = next_i * around + j;
            triangles.insert(triangles.end(), {a, b, c, a, c, d});
        }
    }
    return keepout::Mesh::from_triangles(vertices, triangles);
}

// `count` points of each segment of the cable, evenly.
std::vector<double> samples_of(const std::vector<Point> &cable, int count) {
    std::vector<double> samples;
    for (std::size_t i = 0; i + 1 < cable.size(); ++i)
        for (int s = 0; s < count; ++s)
            for (int k = 0; k < 3; ++k)
                samples.push_back(cable[i][k] + (s + 0.5) / count * (cable[i + 1][k] - cable[i][k]));
    return samples;
}

// phi and its gradients along the whole cable. Ceres calls this before it asks any cost function for a new point: first for residuals, and
// where it takes the point for Jacobians too. Gradients come at half the price of values, so they are taken at once.
class Batch : public ceres::EvaluationCallback {
public:
    Batch(const keepout::Field &field, const std::vector<Point> &cable)
        : values(n_segments * per_segment), gradients(3 * values.size()), field_(field), cable_(cable) {}

    void PrepareForEvaluation(bool, bool new_point) override {
        if (!new_point)
            return;
        ++batches;
        const std::vector<double> points = samples_of(cable_, per_segment);
        valid = ko_field_eval_parallel(field_.get(), points.data(), values.size(), values.data(), gradients.data(), nullptr,
                                       /*all cores*/ 0) >= 0;
        if (!valid)
            failure = ko_last_error();
    }

    std::vector<double> values, gradients;
    bool valid = false;
    std::string failure;
    int batches = 0;

private:
    const keepout::Field &field_;
    const std::vector<Point> &cable_;
};

// The clearance of one segment between two points: residuals force * softness * ln(1 + exp((clearance - phi) / softness)), twice
// differentiable, unlike max(0, clearance - phi), which it is close to. A point that Keepout refuses is an evaluation that failed: Ceres
// tries a shorter step.
class Clearance : public ceres::SizedCostFunction<per_segment, 3, 3> {
public:
    Clearance(const Batch &batch, int segment) : batch_(batch), first_(segment * per_segment) {}

    bool Evaluate(double const *const *, double *residuals, double **jacobians) const override {
        if (!batch_.valid)
            return false;
        const double scale = force / std::sqrt(per_segment);
        for (int s = 0; s < per_segment; ++s) {
            const double at = (clearance - batch_.values[first_ + s]) / softness;
            residuals[s] = scale * softness * (std::max(at, 0.0) + std::log1p(std::exp(-std::fabs(at))));
            const double slope = -scale / (1 + std::exp(-at)), to_end = (s + 0.5) / per_segment;
            for (int k = 0; jacobians != nullptr && k < 3; ++k) {
                const double by_sample = slope * batch_.gradients[3 * (first_ + s) + k];
                if (jacobians[0] != nullptr)
                    jacobians[0][3 * s + k] = (1 - to_end) * by_sample;
                if (jacobians[1] != nullptr)
                    jacobians[1][3 * s + k] = to_end * by_sample;
            }
        }
        return true;
    }

private:
    const Batch &batch_;
    int first_;
};

struct Tension {
    template <class T>
    bool operator()(const T *a, const T *b, T *residuals) const {
        for (int k = 0; k < 3; ++k)
            residuals[k] = tension * (b[k] - a[k]);
        return true;
    }
};

struct Bending {
    template <class T>
    bool operator()(const T *a, const T *b, const T *c, T *residuals) const {
        for (int k = 0; k < 3; ++k)
            residuals[k] = stiffness * (a[k] - 2.0 * b[k] + c[k]);
        return true;
    }
};

void add_costs(const Batch &batch, std::vector<Point> &cable, ceres::Problem &problem) {
    for (int i = 0; i < n_segments; ++i) {
        double *const a = cable[i].data(), *const b = cable[i + 1].data();
        problem.AddResidualBlock(new Clearance(batch, i), nullptr, a, b);
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Tension, 3, 3, 3>(new Tension), nullptr, a, b);
        if (i > 0)
            problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Bending, 3, 3, 3, 3>(new Bending), nullptr, cable[i - 1].data(), a, b);
    }
    problem.SetParameterBlockConstant(cable.front().data());
    problem.SetParameterBlockConstant(cable.back().data());
}

// The largest entry of the gradient of half the sum of squares by the points that move.
double gradient_norm(ceres::Problem &problem, std::vector<Point> &cable) {
    ceres::Problem::EvaluateOptions options;
    for (int i = 1; i < n_segments; ++i)
        options.parameter_blocks.push_back(cable[i].data());
    std::vector<double> gradient;
    double cost, largest = 0;
    if (!problem.Evaluate(options, &cost, nullptr, &gradient, nullptr))
        return HUGE_VAL;
    for (const double entry : gradient)
        largest = std::max(largest, std::fabs(entry));
    return largest;
}

double exact_clearance(const keepout::Mesh &knot, const std::vector<Point> &cable) {
    const std::vector<double> distances = knot.signed_distance(samples_of(cable, 200));
    return *std::min_element(distances.begin(), distances.end());
}

double length_of(const std::vector<Point> &cable) {
    double length = 0;
    for (std::size_t i = 0; i + 1 < cable.size(); ++i)
        length += std::hypot(cable[i + 1][0] - cable[i][0], cable[i + 1][1] - cable[i][1], cable[i + 1][2] - cable[i][2]);
    return length;
}

// The knot, and the cable as a tube of three sides.
void write_picture(const keepout::Mesh &knot, const std::vector<Point> &cable, const char *path) {
    std::vector<double> vertices = knot.vertices();
    std::vector<std::uint32_t> triangles = knot.triangles();
    auto v = static_cast<std::uint32_t>(vertices.size() / 3);
    for (std::size_t i = 0; i < cable.size(); ++i, v += 3) {
        const Point &p = cable[i];
        vertices.insert(vertices.end(), {p[0], p[1] + 0.06, p[2], p[0], p[1] - 0.03, p[2] + 0.05, p[0], p[1] - 0.03, p[2] - 0.05});
        for (std::uint32_t j = 0; i > 0 && j < 3; ++j) {
            const std::uint32_t a = v + j, b = v + (j + 1) % 3;
            triangles.insert(triangles.end(), {a - 3, b - 3, b, a - 3, b, a});
        }
    }
    keepout::Mesh::from_triangles(vertices, triangles).write(path);
    std::printf("Wrote %s\n", path);
}

int run(const char *argument) {
    const bool broken = argument != nullptr && std::string(argument) == "--broken-start";
    const keepout::Mesh knot = make_knot();
    const keepout::Field field = keepout::Field::fit(knot.sample(20000, /*seed*/ 1));

    // Straight through the knot.
    std::vector<Point> cable;
    for (int i = 0; i <= n_segments; ++i) {
        const double s = static_cast<double>(i) / n_segments;
        cable.push_back({-4 + 8 * s, -1.2 + 2.2 * s, 0.3 - 0.5 * s});
    }
    if (broken)
        cable[75][2] = 1e151;
    else
        std::printf("Start: length %.4f, exact clearance %.4f\n", length_of(cable), exact_clearance(knot, cable));

    Batch batch(field, cable);
    ceres::Problem::Options problem_options;
    problem_options.evaluation_callback = &batch;
    ceres::Problem problem(problem_options);
    add_costs(batch, cable, problem);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.max_num_iterations = 500;
    options.function_tolerance = 0;  // go on until the gradient is small
    options.parameter_tolerance = 0;
    options.gradient_tolerance = 1e-7;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    std::printf("%s\n", summary.BriefReport().c_str());
    if (summary.termination_type == ceres::FAILURE) {
        std::printf("Ceres failed; Keepout said: %s\n", batch.failure.c_str());
        return 1;
    }

    const double gradient = gradient_norm(problem, cable), exact = exact_clearance(knot, cable);
    std::printf("%d batches of %d points; %.3f s in all, %.3f s for residuals and Jacobians\n", batch.batches, n_segments * per_segment,
                summary.total_time_in_seconds, summary.residual_evaluation_time_in_seconds + summary.jacobian_evaluation_time_in_seconds);
    std::printf("End:   length %.4f, exact clearance %.4f, gradient %.1e\n", length_of(cable), exact, gradient);
    if (argument != nullptr && !broken)
        write_picture(knot, cable, argument);
    const bool ok = gradient < 1e-6 && exact > 0.5 * clearance;
    std::printf(ok ? "A cable clear of the knot.\n" : "NOT a minimum, or too near to the knot.\n");
    return ok ? 0 : 1;
}

} // namespace

int main(int argc, char **argv) {
    try {
        return run(argc > 1 ? argv[1] : nullptr);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "keepout_path: %s\n", error.what());
        return 1;
    }
}
