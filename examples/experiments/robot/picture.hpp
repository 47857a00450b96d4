// SPDX-License-Identifier: Apache-2.0 OR MIT
// The anatomy, cut by a plane, and what moves in it, as SVG.
#pragma once

#include "tubes.hpp"

#include <keepout.hpp>

#include <string>
#include <vector>

// One panel: a path and the robot at some points of it, seen along the plane's normal.
struct Panel {
    std::string title;
    std::vector<double> path;                // [3 x n]
    std::vector<std::vector<double>> robots; // [3 x n] each
    std::vector<std::vector<double>> radii;  // [n] each
};

// Panels side by side, cut by the plane through three points.
void write_picture(const std::string &file, const keepout::Mesh &mesh, const Vec3 &a, const Vec3 &b, const Vec3 &c,
                   const std::vector<Panel> &panels);
