// Held-out points: drawn by a generator and a sampler of the benches' own, so that no fault of the library's sampling hides in them.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include "library.hpp"

#include <cmath>
#include <random>

namespace bench {

// Uniform in [0, 1). std::uniform_real_distribution may differ between standard libraries; this does not.
class Uniform {
public:
    explicit Uniform(std::uint64_t seed) : generator_(seed) {}
    double operator()() { return static_cast<double>(generator_() >> 11) * 0x1p-53; }

private:
    std::mt19937_64 generator_;
};

// Points of a surface with the normals of their triangles, both [n x 3].
struct SurfacePoints {
    std::vector<double> points, normals;
};

// `n` points, independent and uniform by area.
inline SurfacePoints draw_by_area(const Triangles &mesh, std::size_t n, std::uint64_t seed) {
    struct Corner {
        std::array<double, 3> a, ab, ac, area;  // area: the triangle's vector area, twice
    };
    const auto corner = [&](std::size_t t) {
        Corner c{};
        const double *v[3];
        for (int k = 0; k < 3; ++k) v[k] = &mesh.vertices[3 * mesh.triangles[3 * t + k]];
        for (int k = 0; k < 3; ++k) c.a[k] = v[0][k], c.ab[k] = v[1][k] - v[0][k], c.ac[k] = v[2][k] - v[0][k];
        for (int k = 0; k < 3; ++k) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            c.area[k] = c.ab[i] * c.ac[j] - c.ab[j] * c.ac[i];
        }
        return c;
    };
    std::vector<double> cumulative(mesh.triangles.size() / 3);
    double sum = 0;
    for (std::size_t t = 0; t < cumulative.size(); ++t) {
        const auto area = corner(t).area;
        cumulative[t] = sum += std::hypot(area[0], area[1], area[2]);
    }
    Uniform uniform(seed);
    SurfacePoints drawn{std::vector<double>(3 * n), std::vector<double>(3 * n)};
    for (std::size_t i = 0; i < n; ++i) {
        // upper_bound passes over triangles without area
        const auto at = std::upper_bound(cumulative.begin(), cumulative.end() - 1, uniform() * sum);
        const Corner c = corner(static_cast<std::size_t>(at - cumulative.begin()));
        const double root = std::sqrt(uniform()), u = root * (1 - uniform()), v = root - u;
        const double length = std::hypot(c.area[0], c.area[1], c.area[2]);
        for (int k = 0; k < 3; ++k) {
            drawn.points[3 * i + k] = c.a[k] + u * c.ab[k] + v * c.ac[k];
            drawn.normals[3 * i + k] = c.area[k] / length;
        }
    }
    return drawn;
}

// `surface` moved by `distance` along its normals.
inline std::vector<double> displaced(const SurfacePoints &surface, double distance) {
    std::vector<double> moved = surface.points;
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += distance * surface.normals[i];
    return moved;
}

// `n` points, independent and uniform in the field's box.
inline std::vector<double> draw_in_box(const ko_fit_report &field, std::size_t n, std::uint64_t seed) {
    Uniform uniform(seed);
    std::vector<double> points(3 * n);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double lower = field.box_min[i % 3], upper = field.box_max[i % 3];
        points[i] = lower + uniform() * (upper - lower);
    }
    return points;
}

}  // namespace bench
