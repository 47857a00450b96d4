// SPDX-License-Identifier: Apache-2.0 OR MIT
// Shapes that the example makes itself: surfaces that every ray from the origin meets once.
#pragma once

#include <keepout.hpp>

#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

// An octahedron whose triangles are quartered `times` times, its vertices put at `radius` of their unit direction.
inline keepout::Mesh star_shape(int times, const std::function<double(double x, double y, double z)> &radius) {
    std::vector<double> v = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    std::vector<std::uint32_t> t = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    for (; times > 0; --times) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto next = static_cast<std::uint32_t>(v.size() / 3);
            const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), next);
            for (int k = 0; is_new && k < 3; ++k)
                v.push_back(0.5 * (v[3 * a + k] + v[3 * b + k]));
            return place->second;
        };
        std::vector<std::uint32_t> finer;
        for (std::size_t i = 0; i < t.size(); i += 3) {
            const std::uint32_t a = t[i], b = t[i + 1], c = t[i + 2], ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
        }
        t = finer;
    }
    for (std::size_t i = 0; i < v.size(); i += 3) {
        const double length = std::hypot(v[i], v[i + 1], v[i + 2]);
        const double r = radius(v[i] / length, v[i + 1] / length, v[i + 2] / length);
        for (int k = 0; k < 3; ++k)
            v[i + k] *= r / length;
    }
    return keepout::Mesh::from_triangles(v, t);
}

// A tank with three lobes and a waist: what a box around it says of it is wrong nearly everywhere.
inline keepout::Mesh make_tank() {
    return star_shape(6, [](double x, double y, double z) {
        const double across = std::hypot(x, y);
        return 0.75 * (1 + 0.18 * std::cos(3 * std::atan2(y, x)) * across * across * across - 0.15 * z * z);
    });
}

// A box of these half-extents with rounded edges, (x/a)^4 + (y/b)^4 + (z/c)^4 = 1; power 2 makes an ellipsoid.
inline keepout::Mesh make_box(double a, double b, double c, double power) {
    return star_shape(4, [=](double x, double y, double z) {
        const double sum = std::pow(std::fabs(x) / a, power) + std::pow(std::fabs(y) / b, power) + std::pow(std::fabs(z) / c, power);
        return std::pow(sum, -1 / power);
    });
}
