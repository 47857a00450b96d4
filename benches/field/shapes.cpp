// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "shapes.hpp"

#include "../../examples/c/curves.h"

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

namespace bench {

namespace {

using Point = std::array<double, 3>;

const double PI = 3.14159265358979323846;

// Rings of `n` points each, every one joined to the next.
class Rings {
public:
    explicit Rings(std::size_t n) : n_(n) {}

    void add(const std::vector<Point> &ring) {
        for (const Point &p : ring) vertices_.insert(vertices_.end(), p.begin(), p.end());
        const std::size_t last = vertices_.size() / 3 - n_;
        if (last > 0) join(last - n_, last);
    }

    // Closes both ends by fans about the middle of their rings.
    Mesh capped() {
        const std::size_t last = vertices_.size() / 3 - n_;
        const auto middle = [&](std::size_t first) {
            Point sum = {0, 0, 0};
            for (std::size_t i = 0; i < 3 * n_; ++i) sum[i % 3] += vertices_[3 * first + i] / static_cast<double>(n_);
            return sum;
        };
        for (const Point &p : {middle(0), middle(last)}) vertices_.insert(vertices_.end(), p.begin(), p.end());
        for (std::size_t i = 0; i < n_; ++i) {
            const std::size_t j = (i + 1) % n_;
            add_triangle(last + n_, i, j);
            add_triangle(last + n_ + 1, last + j, last + i);
        }
        return mesh_from(vertices_, triangles_);
    }

    // Joins the last ring to the first.
    Mesh joined() {
        join(vertices_.size() / 3 - n_, 0);
        return mesh_from(vertices_, triangles_);
    }

private:
    void join(std::size_t a, std::size_t b) {
        for (std::size_t i = 0; i < n_; ++i) {
            const std::size_t j = (i + 1) % n_;
            add_triangle(a + i, b + i, b + j);
            add_triangle(a + i, b + j, a + j);
        }
    }

    void add_triangle(std::size_t a, std::size_t b, std::size_t c) {
        for (const std::size_t corner : {a, b, c}) triangles_.push_back(static_cast<std::uint32_t>(corner));
    }

    std::size_t n_;
    std::vector<double> vertices_;
    std::vector<std::uint32_t> triangles_;
};

// Turns the mesh where its normals point inwards: generators need not think of it.
Mesh outward(Mesh mesh) {
    if (report_of(mesh).inside_out) check(ko_mesh_flip(mesh.get()), "ko_mesh_flip");
    return mesh;
}

std::vector<Point> ring(std::size_t n, const std::function<Point(double angle)> &point) {
    std::vector<Point> points;
    for (std::size_t i = 0; i < n; ++i) points.push_back(point(2 * PI * (static_cast<double>(i) + 0.5) / static_cast<double>(n)));
    return points;
}

// What a sphere's point `d` becomes where the sphere is rolled along a box of half extents `half`: a rounded box.
Point rounded(const Point &d, const Point &half, double radius) {
    Point p;
    for (int k = 0; k < 3; ++k) p[k] = radius * d[k] + std::copysign(half[k] - radius, d[k]);
    return p;
}

// Rings of a sphere from pole to pole, without the poles and without the equator.
Mesh over_sphere(const std::function<Point(const Point &)> &place) {
    const std::size_t n_around = 256, n_along = 128;
    Rings rings(n_around);
    for (std::size_t j = 0; j < n_along; ++j) {
        const double t = PI * (static_cast<double>(j) + 0.5) / static_cast<double>(n_along);
        rings.add(ring(n_around, [&](double a) { return place({std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t)}); }));
    }
    return outward(rings.capped());
}

Mesh box(double width, double depth, double height) {
    Rings rings(4);
    for (const double z : {-0.5, 0.5})
        rings.add(ring(4, [&](double a) {
            return Point{std::copysign(0.5, std::cos(a)) * width, std::copysign(0.5, std::sin(a)) * depth, z * height};
        }));
    return outward(rings.capped());
}

Mesh polylines(const std::vector<std::vector<double>> &lines, bool closed) {
    std::vector<double> points;
    std::vector<std::size_t> starts;
    for (const auto &line : lines) {
        starts.push_back(points.size() / 2);
        points.insert(points.end(), line.begin(), line.end());
    }
    ko_mesh *mesh = nullptr;
    check(ko_mesh_from_polylines(points.data(), points.size() / 2, starts.data(), starts.size(), closed, &mesh),
          "ko_mesh_from_polylines");
    return Mesh(mesh);
}

// Half thickness of the NACA 0012 with a sharp trailing edge, at x of the chord.
double naca_0012(double x) {
    return 0.6 * (0.2969 * std::sqrt(x) + x * (-0.1260 + x * (-0.3516 + x * (0.2843 - x * 0.1036))));
}

}  // namespace

Mesh fuselage() {
    const std::size_t n_around = 300, n_along = 400;
    Rings rings(n_around);
    for (std::size_t j = 0; j < n_along; ++j) {
        const double s = -std::cos(PI * (static_cast<double>(j) + 0.5) / static_cast<double>(n_along));
        const double radius = 0.68 * std::sqrt(1 - s * s) * (1 - 0.25 * s);
        rings.add(ring(n_around, [&](double a) { return Point{2 * s, radius * std::cos(a), radius * std::sin(a)}; }));
    }
    return outward(rings.capped());
}

Mesh luggage() {
    return over_sphere([](const Point &d) { return rounded(d, {0.275, 0.375, 0.175}, 0.05); });
}

Mesh wing() {
    const std::size_t n_side = 150, n_along = 101;
    Rings rings(2 * n_side);
    for (std::size_t j = 0; j < n_along; ++j) {
        const double y = 5 * (static_cast<double>(j) / static_cast<double>(n_along - 1) - 0.5);
        const double chord = 1 - 0.2 * std::abs(y);
        std::vector<Point> section;  // from the trailing edge over the upper side to the nose, and back
        for (std::size_t i = 0; i < 2 * n_side; ++i) {
            const double turn = PI * static_cast<double>(i) / static_cast<double>(n_side), x = 0.5 * (1 + std::cos(turn));
            section.push_back({chord * (x - 0.25), y, (i < n_side ? chord : -chord) * naca_0012(x)});
        }
        rings.add(section);
    }
    return outward(rings.capped());
}

Mesh battery_pack() { return box(2, 6, 0.4); }

Mesh sphere() {
    return over_sphere([](const Point &d) { return d; });
}

Mesh torus() {
    const std::size_t n = 200;
    Rings rings(n);
    for (std::size_t j = 0; j < 2 * n; ++j) {
        const double t = PI * static_cast<double>(j) / static_cast<double>(n);
        rings.add(ring(n, [&](double a) {
            const double r = 1 + 0.35 * std::cos(a);
            return Point{r * std::cos(t), r * std::sin(t), 0.35 * std::sin(a)};
        }));
    }
    return outward(rings.joined());
}

Mesh group_of_obj(const std::string &path, const std::string &group) {
    std::ifstream file(path);
    if (!file) throw std::runtime_error(path + " cannot be opened");
    std::vector<double> vertices, kept;
    std::vector<std::uint32_t> triangles;
    std::map<std::size_t, std::uint32_t> number_of;  // of those vertices that the group uses
    const auto corner = [&](std::size_t v) {
        const auto [at, fresh] = number_of.emplace(v, static_cast<std::uint32_t>(number_of.size()));
        if (fresh) kept.insert(kept.end(), &vertices.at(3 * v), &vertices.at(3 * v) + 3);
        return at->second;
    };
    bool in_group = false;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "v") {
            for (double x; words >> x;) vertices.push_back(x);
        } else if (word == "g") {
            words >> word;
            in_group = word == group;
        } else if (word == "f" && in_group) {
            std::vector<std::uint32_t> polygon;
            while (words >> word) polygon.push_back(corner(std::stoul(word) - 1));
            for (std::size_t i = 2; i < polygon.size(); ++i)
                for (const std::size_t k : {std::size_t{0}, i - 1, i}) triangles.push_back(polygon[k]);
        }
    }
    return mesh_from(kept, triangles);
}

Mesh circles(const std::vector<Circle> &circles) {
    const std::size_t n = 2000;
    std::vector<std::vector<double>> lines;
    for (const Circle &circle : circles) {
        lines.emplace_back();
        for (std::size_t i = 0; i < n; ++i) {
            const double a = 2 * PI * static_cast<double>(i) / static_cast<double>(n);
            lines.back().push_back(circle.x + circle.radius * std::cos(a));
            lines.back().push_back(circle.y + circle.radius * std::sin(a));
        }
    }
    return polylines(lines, true);
}

Mesh rectangle(double width, double height) {
    const double x = width / 2, y = height / 2;
    return polylines({{-x, -y, x, -y, x, y, -x, y}}, true);
}

Mesh funnel() {
    const int n = 200;
    std::vector<double> upper, lower;  // the solid lies on the left of either: the upper runs to the right, the lower back
    for (int i = 0; i <= n; ++i) {
        const double x = 3.0 * i / n, back = 3 - x;
        const auto half = [](double at) { return 0.35 + 0.325 * (1 - std::tanh(4 * (at - 1))); };
        upper.insert(upper.end(), {x, half(x)});
        lower.insert(lower.end(), {back, -half(back)});
    }
    return polylines({upper, lower}, false);
}

Mesh curves_from(const std::string &path) {
    ko_mesh *mesh = nullptr;
    if (!curves_read(path.c_str(), &mesh)) throw std::runtime_error(path + " cannot be read");
    return Mesh(mesh);
}

}  // namespace bench
