// Shapes that the benches make: parts of aircraft after paper 000, section 4.4, and curves of the plane after its section 4.1.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include "../library.hpp"

#include <functional>

namespace bench {

// A smooth body of revolution about x, blunter in front, 4 long and 1.4 thick.
Mesh fuselage();

// A box of 0.55 x 0.75 x 0.35 with edges rounded to a radius of 0.05.
Mesh luggage();

// A NACA 0012 from tip to tip along y, 5 long, its chord tapering from 1 in the middle to 0.5, with flat tips and a sharp trailing edge.
Mesh wing();

// A flat box of 2 x 6 x 0.4.
Mesh battery_pack();

// A sphere of radius 1, and a torus about z of radii 1 and 0.35.
Mesh sphere();
Mesh torus();

// The faces of `group` of an OBJ file, which Keepout reads as one mesh.
Mesh group_of_obj(const std::string &path, const std::string &group);

struct Circle {
    double x, y, radius;
};

// Circles that do not meet, as polygons so fine (2,000 sides) that they count as circles.
Mesh circles(const std::vector<Circle> &circles);

// A rectangle about 0, 0.
Mesh rectangle(double width, double height);

// Two walls, open, that draw together and go on as a neck: figure 2. The infeasible side is beyond the walls.
Mesh funnel();

// Curves from a file, by the reader of the C example.
Mesh curves_from(const std::string &path);

}  // namespace bench
