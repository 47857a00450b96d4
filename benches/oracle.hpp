// Exact distance and side by CGAL, which this project did not write.
// CGAL's packages used here are under the GPL: they link into benches and tests, never into the library.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include "library.hpp"

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include <cmath>

namespace bench {

// Closest points of a triangle soup. In plain doubles, which is CGAL's fastest kernel: as a peer it shall not be slowed.
class ClosestPoints {
    using Kernel = CGAL::Simple_cartesian<double>;
    using Soup = std::vector<Kernel::Triangle_3>;
    using Primitive = CGAL::AABB_triangle_primitive<Kernel, Soup::const_iterator>;
    using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

public:
    explicit ClosestPoints(const Triangles &mesh) : soup_(soup_of(mesh)), tree_(soup_.begin(), soup_.end()) {
        tree_.accelerate_distance_queries();
    }

    double distance(const double *p) const {
        const Kernel::Point_3 query(p[0], p[1], p[2]);
        return std::sqrt(CGAL::squared_distance(query, tree_.closest_point_and_primitive(query).first));
    }

private:
    static Soup soup_of(const Triangles &mesh) {
        const auto vertex = [&](std::size_t corner) {
            const double *v = &mesh.vertices[3 * mesh.triangles[corner]];
            return Kernel::Point_3(v[0], v[1], v[2]);
        };
        Soup soup;
        for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
            const Kernel::Triangle_3 triangle(vertex(t), vertex(t + 1), vertex(t + 2));
            if (!triangle.is_degenerate()) soup.push_back(triangle);  // CGAL's tree asks for that
        }
        return soup;
    }

    Soup soup_;
    Tree tree_;
};

// Side of a closed mesh, by exact predicates.
class Side {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

public:
    explicit Side(const Triangles &mesh) : surface_(surface_of(mesh)), side_(surface_) {}

    bool outside(const double *p) const {
        return side_(Kernel::Point_3(p[0], p[1], p[2])) == CGAL::ON_UNBOUNDED_SIDE;
    }

private:
    static Surface surface_of(const Triangles &mesh) {
        std::vector<Kernel::Point_3> points;
        for (std::size_t v = 0; v < mesh.vertices.size(); v += 3)
            points.emplace_back(mesh.vertices[v], mesh.vertices[v + 1], mesh.vertices[v + 2]);
        std::vector<std::array<std::size_t, 3>> faces;
        for (std::size_t t = 0; t < mesh.triangles.size(); t += 3)
            faces.push_back({mesh.triangles[t], mesh.triangles[t + 1], mesh.triangles[t + 2]});
        namespace processing = CGAL::Polygon_mesh_processing;
        if (!processing::is_polygon_soup_a_polygon_mesh(faces))
            throw std::runtime_error("CGAL's side needs a manifold, oriented mesh, and this is none");
        Surface surface;
        processing::polygon_soup_to_polygon_mesh(points, faces, surface);
        if (!CGAL::is_closed(surface)) throw std::runtime_error("CGAL's side needs a closed mesh, and this is open");
        return surface;
    }

    Surface surface_;
    CGAL::Side_of_triangle_mesh<Surface, Kernel> side_;
};

// Exact signed distances of `points` [n x 3], positive outside. An open mesh has no side by CGAL: there the library's winding number tells it.
inline std::vector<double> exact_distances(const Mesh &mesh, const std::vector<double> &points) {
    const Triangles arrays = triangles_of(mesh);
    const ClosestPoints closest(arrays);
    const bool closed = report_of(mesh).closed != 0;
    std::vector<double> distances = closed ? std::vector<double>(points.size() / 3) : signed_distances(mesh, points);
    if (closed) {
        const Side side(arrays);
        for (std::size_t i = 0; i < distances.size(); ++i) distances[i] = side.outside(&points[3 * i]) ? 1 : -1;
    }
    for (std::size_t i = 0; i < distances.size(); ++i)
        distances[i] = std::copysign(closest.distance(&points[3 * i]), distances[i]);
    return distances;
}

}  // namespace bench
