// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>

namespace {

constexpr double scale = 9, margin = 16; // pixels a mm; mm around what is drawn

Vec3 difference(const Vec3 &a, const Vec3 &b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vec3 &a, const Vec3 &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3 cross(const Vec3 &a, const Vec3 &b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }

Vec3 unit(const Vec3 &a) {
    const double length = std::sqrt(dot(a, a));
    return {a[0] / length, a[1] / length, a[2] / length};
}

// The plane's own axes: to the right from a to b, and across.
struct View {
    Vec3 origin, right, up, normal;
    double left = 1e30, bottom = 1e30, width = -1e30, height = -1e30;

    std::array<double, 2> at(const double *p) const {
        const Vec3 from = difference({p[0], p[1], p[2]}, origin);
        return {dot(from, right), dot(from, up)};
    }

    double side(const double *p) const { return dot(difference({p[0], p[1], p[2]}, origin), normal); }
};

std::string pixels(double mm) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f", scale * mm);
    return text;
}

std::string moved(const View &view, const std::array<double, 2> &at) {
    return pixels(at[0] - view.left) + " " + pixels(view.height - (at[1] - view.bottom)) + " ";
}

// Ends of the segments in which the plane cuts triangles.
std::vector<std::array<double, 2>> section(const keepout::Mesh &mesh, const View &view) {
    const std::vector<double> v = mesh.vertices();
    const std::vector<std::uint32_t> t = mesh.triangles();
    std::vector<std::array<double, 2>> ends;
    for (std::size_t i = 0; i < t.size(); i += 3)
        for (int k = 0; k < 3; ++k) {
            const double *p = &v[3 * t[i + k]], *q = &v[3 * t[i + (k + 1) % 3]];
            const double a = view.side(p), b = view.side(q);
            if ((a < 0) == (b < 0))
                continue;
            const double share = a / (a - b);
            const double cut[3] = {p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1]), p[2] + share * (q[2] - p[2])};
            ends.push_back(view.at(cut));
        }
    return ends;
}

} // namespace

void write_picture(const std::string &file, const keepout::Mesh &mesh, const Vec3 &a, const Vec3 &b, const Vec3 &c,
                   const std::vector<Panel> &panels) {
    View view;
    view.origin = a;
    view.right = unit(difference(b, a));
    view.normal = unit(cross(view.right, difference(c, a)));
    view.up = cross(view.normal, view.right);
    double right = -1e30, top = -1e30;
    for (const Panel &panel : panels)
        for (std::size_t j = 0; j < panel.path.size(); j += 3) {
            const std::array<double, 2> at = view.at(&panel.path[j]);
            view.left = std::min(view.left, at[0] - margin);
            view.bottom = std::min(view.bottom, at[1] - margin);
            right = std::max(right, at[0] + margin);
            top = std::max(top, at[1] + margin);
        }
    view.width = right - view.left;
    view.height = top - view.bottom;

    std::ofstream svg(file);
    svg << "<svg xmlns='http://www.w3.org/2000/svg' width='" << pixels(view.width * panels.size()) << "' height='" << pixels(view.height)
        << "' font-family='sans-serif' font-size='14'>\n<rect width='100%' height='100%' fill='white'/>\n"
        << "<clipPath id='panel'><rect width='" << pixels(view.width - 1) << "' height='" << pixels(view.height) << "'/></clipPath>\n";
    const std::vector<std::array<double, 2>> wall = section(mesh, view);
    for (std::size_t k = 0; k < panels.size(); ++k) {
        const Panel &panel = panels[k];
        svg << "<g clip-path='url(#panel)' transform='translate(" << pixels(view.width * k) << " 0)' fill='none' stroke-linejoin='round'>\n";
        svg << "<path stroke='black' stroke-width='1.5' d='";
        for (std::size_t i = 0; i + 1 < wall.size(); i += 2)
            svg << "M" << moved(view, wall[i]) << "L" << moved(view, wall[i + 1]);
        svg << "'/>\n";
        for (std::size_t r = 0; r < panel.robots.size(); ++r) {
            const std::vector<double> &points = panel.robots[r];
            const bool last = r + 1 == panel.robots.size();
            // A stroke for each part of one radius, with every tenth of its points: the picture needs no more.
            const std::vector<double> &radii = panel.radii[r];
            for (std::size_t first = 0, end; first < radii.size(); first = end) {
                end = std::find_if(radii.begin() + first, radii.end(), [&](double radius) { return radius != radii[first]; }) - radii.begin();
                svg << "<path stroke='" << (last ? "#1f5fa8" : "#a8c8e8") << "' stroke-width='" << pixels(2 * radii[first]) << "' d='";
                for (std::size_t j = first; j < end; j += 10)
                    svg << (j == first ? "M" : "L") << moved(view, view.at(&points[3 * j]));
                svg << "L" << moved(view, view.at(&points[3 * (end - 1)])) << "'/>\n";
            }
        }
        svg << "<path stroke='#d05010' stroke-width='1.5' stroke-dasharray='5 4' d='";
        for (std::size_t j = 0; j < panel.path.size(); j += 3)
            svg << (j == 0 ? "M" : "L") << moved(view, view.at(&panel.path[j]));
        svg << "'/>\n<text x='10' y='20' fill='black'>" << panel.title << "</text>\n</g>\n";
    }
    svg << "</svg>\n";
    if (!svg.flush())
        throw std::runtime_error("cannot write " + file);
}
