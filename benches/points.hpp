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

// Points of a surface, or of curves in the plane, with the normals of their facets, both [n x dim].
struct SurfacePoints {
    std::size_t dim;
    std::vector<double> points, normals;

    std::size_t size() const { return points.size() / dim; }
};

// The normal of a facet as long as the facet's area (in space twice that) or length.
inline std::array<double, 3> area_of(const Facets &mesh, std::size_t facet) {
    const double *a = mesh.vertex(facet, 0), *b = mesh.vertex(facet, 1);
    if (mesh.dim == 2) return {b[1] - a[1], a[0] - b[0], 0};
    const double *c = mesh.vertex(facet, 2);
    std::array<double, 3> area;
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        area[k] = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
    }
    return area;
}

// `n` points, independent and uniform by area or length.
inline SurfacePoints draw_by_area(const Facets &mesh, std::size_t n, std::uint64_t seed) {
    const std::size_t dim = mesh.dim;
    std::vector<double> cumulative(mesh.size());
    double sum = 0;
    for (std::size_t f = 0; f < cumulative.size(); ++f) {
        const auto area = area_of(mesh, f);
        cumulative[f] = sum += std::hypot(area[0], area[1], area[2]);
    }
    Uniform uniform(seed);
    SurfacePoints drawn{dim, std::vector<double>(dim * n), std::vector<double>(dim * n)};
    for (std::size_t i = 0; i < n; ++i) {
        // upper_bound passes over facets without area
        const auto at = std::upper_bound(cumulative.begin(), cumulative.end() - 1, uniform() * sum);
        const auto facet = static_cast<std::size_t>(at - cumulative.begin());
        const double root = dim == 2 ? uniform() : std::sqrt(uniform());
        const double u = dim == 2 ? root : root * (1 - uniform()), v = root - u;
        const double *a = mesh.vertex(facet, 0), *b = mesh.vertex(facet, 1), *c = mesh.vertex(facet, dim - 1);
        const auto area = area_of(mesh, facet);
        const double length = std::hypot(area[0], area[1], area[2]);
        for (std::size_t k = 0; k < dim; ++k) {
            drawn.points[dim * i + k] = a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]);
            drawn.normals[dim * i + k] = area[k] / length;
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
    std::vector<double> points(field.dim * n);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double lower = field.box_min[i % field.dim], upper = field.box_max[i % field.dim];
        points[i] = lower + uniform() * (upper - lower);
    }
    return points;
}

}  // namespace bench
