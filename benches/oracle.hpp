// Exact distance and side by CGAL, which this project did not write.
// CGAL's packages used here are under the GPL: they link into benches and tests, never into the library.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include "library.hpp"

namespace bench {

// Closest points of triangles or, in the plane, segments. In plain doubles, which is CGAL's fastest kernel: as a peer it shall not be
// slowed.
class ClosestPoints {
public:
    explicit ClosestPoints(const Facets &mesh);
    ~ClosestPoints();
    double distance(const double *p) const;
    // In the plane its z is 0.
    std::array<double, 3> closest(const double *p) const;

private:
    struct Trees;
    std::unique_ptr<Trees> trees_;
};

// Exact signed distances of `points` [n x dim], positive outside. An open mesh has no side by CGAL: there the library's winding number
// tells it.
std::vector<double> exact_distances(const Mesh &mesh, const std::vector<double> &points);

const char *oracle_version();

}  // namespace bench
