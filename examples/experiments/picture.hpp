// SPDX-License-Identifier: Apache-2.0 OR MIT
// Shapes of triangles drawn as SVG, seen from afar: what is farther away is drawn first.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

using Vector = std::array<double, 3>;

inline Vector operator-(const Vector &a, const Vector &b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

inline double dot(const Vector &a, const Vector &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

inline Vector cross(const Vector &a, const Vector &b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline Vector unit(const Vector &a) {
    const double length = std::sqrt(dot(a, a));
    return {a[0] / length, a[1] / length, a[2] / length};
}

// Which triangles of a shape are drawn: those that face the viewer, or, to look into it, those that face away.
enum class Faces { front, back };

// A picture seen along -`toward`, with `up` upwards.
class Picture {
public:
    Picture(const Vector &toward, const Vector &up)
        : toward_(unit(toward)), right_(unit(cross(up, toward_))), up_(cross(toward_, right_)) {}

    // Shapes of a later layer are drawn over those of an earlier one, as if these were farther away. Colours are red, green, blue up to 1.
    void add(const std::vector<double> &vertices, const std::vector<std::uint32_t> &triangles, const Vector &colour, Faces faces,
             int layer) {
        for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
            Drawn drawn{};
            Vector corners[3];
            for (int k = 0; k < 3; ++k) {
                const double *at = &vertices[3 * triangles[t + k]];
                corners[k] = {at[0], at[1], at[2]};
                drawn.at[k] = {dot(corners[k], right_), -dot(corners[k], up_)};
                drawn.depth += dot(corners[k], toward_);
            }
            const Vector normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
            const double towards = dot(normal, toward_), length = std::sqrt(dot(normal, normal));
            if (!(faces == Faces::front ? towards > 0 : towards < 0))
                continue;
            for (const auto &point : drawn.at) {
                least_ = {std::min(least_[0], point[0]), std::min(least_[1], point[1])};
                most_ = {std::max(most_[0], point[0]), std::max(most_[1], point[1])};
            }
            const double light = 0.3 + 0.7 * std::max(0.0, std::fabs(towards) + 0.4 * dot(normal, up_)) / (1.1 * length);
            for (int k = 0; k < 3; ++k)
                drawn.colour[k] = static_cast<int>(std::lround(255 * std::min(1.0, light) * colour[k]));
            drawn.layer = layer;
            drawn_.push_back(drawn);
        }
    }

    void write(const std::string &path) {
        std::sort(drawn_.begin(), drawn_.end(), [](const Drawn &a, const Drawn &b) {
            return a.layer != b.layer ? a.layer < b.layer : a.depth < b.depth;
        });
        std::FILE *svg = std::fopen(path.c_str(), "w");
        if (svg == nullptr) {
            std::printf("%s could not be written\n", path.c_str());
            return;
        }
        constexpr double width = 900, rim = 10;
        const double scale = (width - 2 * rim) / (most_[0] - least_[0]), height = scale * (most_[1] - least_[1]) + 2 * rim;
        std::fprintf(svg,
                     "<svg xmlns='http://www.w3.org/2000/svg' width='%.0f' height='%.0f'>\n"
                     "<rect width='100%%' height='100%%' fill='#fff'/>\n",
                     width, height);
        for (const Drawn &drawn : drawn_) {
            // Its edges too, so that no gaps show between neighbours.
            std::fprintf(svg, "<path fill='#%02x%02x%02x' stroke='#%02x%02x%02x' stroke-width='.5' d='", drawn.colour[0], drawn.colour[1],
                         drawn.colour[2], drawn.colour[0], drawn.colour[1], drawn.colour[2]);
            for (int k = 0; k < 3; ++k)
                std::fprintf(svg, "%c%.1f %.1f", k == 0 ? 'M' : 'L', rim + scale * (drawn.at[k][0] - least_[0]),
                             rim + scale * (drawn.at[k][1] - least_[1]));
            std::fprintf(svg, "z'/>\n");
        }
        std::fprintf(svg, "</svg>\n");
        std::fclose(svg);
        std::printf("Wrote %s\n", path.c_str());
    }

private:
    struct Drawn {
        std::array<double, 2> at[3];
        double depth;
        int colour[3], layer;
    };

    Vector toward_, right_, up_;
    std::vector<Drawn> drawn_;
    std::array<double, 2> least_ = {1e300, 1e300}, most_ = {-1e300, -1e300};
};

// A tube of eight sides around a path of points [3 * n].
inline void make_tube(const std::vector<double> &path, double radius, std::vector<double> &vertices,
                      std::vector<std::uint32_t> &triangles) {
    constexpr std::uint32_t around = 8;
    const std::size_t n = path.size() / 3;
    const auto at = [&](std::size_t i) { return Vector{path[3 * i], path[3 * i + 1], path[3 * i + 2]}; };
    Vector side = {0.31, 0.87, 0.38}; // carried along, so that the tube does not twist
    for (std::size_t i = 0; i < n; ++i) {
        const Vector along = unit(at(i + 1 < n ? i + 1 : i) - at(i > 0 ? i - 1 : 0)), other = unit(cross(along, side));
        side = cross(other, along);
        for (std::uint32_t j = 0; j < around; ++j) {
            const double angle = 2 * std::acos(-1.0) * j / around;
            for (int k = 0; k < 3; ++k)
                vertices.push_back(path[3 * i + k] + radius * (std::cos(angle) * side[k] + std::sin(angle) * other[k]));
            const auto a = static_cast<std::uint32_t>(i * around + j), b = static_cast<std::uint32_t>(i * around + (j + 1) % around);
            if (i > 0)
                triangles.insert(triangles.end(), {a - around, b - around, b, a - around, b, a});
        }
    }
}
