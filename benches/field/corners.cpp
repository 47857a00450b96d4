// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "corners.hpp"

#include <cmath>
#include <limits>
#include <map>

namespace bench {

std::vector<double> corners_of(const Facets &curves, double degrees) {
    std::map<std::uint32_t, std::array<double, 2>> arriving;  // direction of the segment that ends at a vertex
    const auto direction = [&](std::size_t f) {
        const double *a = curves.vertex(f, 0), *b = curves.vertex(f, 1);
        return std::array<double, 2>{b[0] - a[0], b[1] - a[1]};
    };
    for (std::size_t f = 0; f < curves.size(); ++f) arriving[curves.facets[2 * f + 1]] = direction(f);
    std::vector<double> corners;
    for (std::size_t f = 0; f < curves.size(); ++f) {
        const auto found = arriving.find(curves.facets[2 * f]);
        if (found == arriving.end()) continue;
        const auto &in = found->second, out = direction(f);
        const double turn = std::atan2(in[0] * out[1] - in[1] * out[0], in[0] * out[0] + in[1] * out[1]);
        if (std::abs(turn) * 57.29577951308232 > degrees) corners.insert(corners.end(), curves.vertex(f, 0), curves.vertex(f, 0) + 2);
    }
    return corners;
}

std::vector<double> rim_of(const Facets &mesh, double spacing) {
    const std::size_t dim = mesh.dim;
    std::map<std::vector<std::uint32_t>, std::size_t> ridges;  // and how many facets are at each
    for (std::size_t f = 0; f < mesh.size(); ++f) {
        for (std::size_t k = 0; k < dim; ++k) {
            std::vector<std::uint32_t> ridge = {mesh.facets[dim * f + k]};
            if (dim == 3) ridge.push_back(mesh.facets[dim * f + (k + 1) % 3]);
            std::sort(ridge.begin(), ridge.end());
            ++ridges[ridge];
        }
    }
    std::vector<double> rim;
    for (const auto &[ridge, count] : ridges) {
        if (count != 1) continue;
        const double *a = &mesh.vertices[dim * ridge.front()], *b = &mesh.vertices[dim * ridge.back()];
        double square = 0;
        for (std::size_t k = 0; k < dim; ++k) square += (b[k] - a[k]) * (b[k] - a[k]);
        const double steps = std::ceil(std::sqrt(square) / spacing);
        for (double i = 0; i <= steps; ++i)
            for (std::size_t k = 0; k < dim; ++k) rim.push_back(a[k] + (steps > 0 ? i / steps : 0) * (b[k] - a[k]));
    }
    return rim;
}

double nearest(const double *p, const std::vector<double> &points, std::size_t dim) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < points.size(); i += dim) {
        double square = 0;
        for (std::size_t k = 0; k < dim; ++k) square += (p[k] - points[i + k]) * (p[k] - points[i + k]);
        least = std::min(least, square);
    }
    return std::sqrt(least);
}

std::vector<double> farther_than(double distance, const std::vector<double> &points, const std::vector<double> &others,
                                 std::size_t dim) {
    std::vector<double> far;
    for (std::size_t i = 0; i < points.size(); i += dim)
        if (nearest(&points[i], others, dim) > distance) far.insert(far.end(), &points[i], &points[i] + dim);
    return far;
}

}  // namespace bench
