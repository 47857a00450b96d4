// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "oracle.hpp"

#include <CGAL/AABB_segment_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2_algorithms.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/version.h>

#include <cmath>
#include <map>

namespace bench {

namespace {

using Plain = CGAL::Simple_cartesian<double>;
using Exact = CGAL::Exact_predicates_inexact_constructions_kernel;

// CGAL's tree knows no plane: it gets z = 0.
Plain::Point_3 plain(const double *p, std::size_t dim) { return {p[0], p[1], dim == 3 ? p[2] : 0}; }

template <class Primitive_of, class Soup> struct Tree {
    using Type = CGAL::AABB_tree<CGAL::AABB_traits<Plain, Primitive_of>>;
    Soup soup;
    Type tree;

    explicit Tree(Soup facets) : soup(std::move(facets)), tree(soup.begin(), soup.end()) { tree.accelerate_distance_queries(); }
    double distance(const Plain::Point_3 &query) const {
        return std::sqrt(CGAL::squared_distance(query, tree.closest_point_and_primitive(query).first));
    }
};

using Segments = std::vector<Plain::Segment_3>;
using Soup = std::vector<Plain::Triangle_3>;
using SegmentTree = Tree<CGAL::AABB_segment_primitive<Plain, Segments::const_iterator>, Segments>;
using TriangleTree = Tree<CGAL::AABB_triangle_primitive<Plain, Soup::const_iterator>, Soup>;

// CGAL's trees ask that no facet is degenerate.
Segments segments_of(const Facets &mesh) {
    Segments segments;
    for (std::size_t f = 0; f < mesh.size(); ++f) {
        const Plain::Segment_3 segment(plain(mesh.vertex(f, 0), 2), plain(mesh.vertex(f, 1), 2));
        if (!segment.is_degenerate()) segments.push_back(segment);
    }
    return segments;
}

Soup soup_of(const Facets &mesh) {
    Soup soup;
    for (std::size_t f = 0; f < mesh.size(); ++f) {
        const Plain::Triangle_3 triangle(plain(mesh.vertex(f, 0), 3), plain(mesh.vertex(f, 1), 3), plain(mesh.vertex(f, 2), 3));
        if (!triangle.is_degenerate()) soup.push_back(triangle);
    }
    return soup;
}

// Side of a closed mesh in space, by exact predicates.
class Side {
    using Surface = CGAL::Surface_mesh<Exact::Point_3>;

public:
    explicit Side(const Facets &mesh) : surface_(surface_of(mesh)), side_(surface_) {}

    bool outside(const double *p) const { return side_(Exact::Point_3(p[0], p[1], p[2])) == CGAL::ON_UNBOUNDED_SIDE; }

private:
    static Surface surface_of(const Facets &mesh) {
        std::vector<Exact::Point_3> points;
        for (std::size_t v = 0; v < mesh.vertices.size(); v += 3)
            points.emplace_back(mesh.vertices[v], mesh.vertices[v + 1], mesh.vertices[v + 2]);
        std::vector<std::array<std::size_t, 3>> faces;
        for (std::size_t t = 0; t < mesh.facets.size(); t += 3)
            faces.push_back({mesh.facets[t], mesh.facets[t + 1], mesh.facets[t + 2]});
        namespace processing = CGAL::Polygon_mesh_processing;
        if (!processing::is_polygon_soup_a_polygon_mesh(faces))
            throw std::runtime_error("CGAL's side needs a manifold, oriented mesh, and this is none");
        Surface surface;
        processing::polygon_soup_to_polygon_mesh(points, faces, surface);
        if (!CGAL::is_closed(surface)) throw std::runtime_error("CGAL's side needs a closed mesh, and this is open");
        return surface;
    }

    Surface surface_;
    CGAL::Side_of_triangle_mesh<Surface, Exact> side_;
};

// Side of closed curves in the plane, by exact predicates: inside what an odd number of them goes around.
class SideOfCurves {
public:
    explicit SideOfCurves(const Facets &mesh) {
        std::map<std::uint32_t, std::uint32_t> next;
        for (std::size_t f = 0; f < mesh.size(); ++f) next[mesh.facets[2 * f]] = mesh.facets[2 * f + 1];
        while (!next.empty()) {
            loops_.emplace_back();
            for (auto at = next.begin(); at != next.end();) {
                const std::uint32_t to = at->second;
                loops_.back().emplace_back(mesh.vertices[2 * at->first], mesh.vertices[2 * at->first + 1]);
                next.erase(at);
                at = next.find(to);
            }
        }
    }

    bool outside(const double *p) const {
        bool outside = true;
        for (const auto &loop : loops_)
            outside ^= CGAL::bounded_side_2(loop.begin(), loop.end(), Exact::Point_2(p[0], p[1])) == CGAL::ON_BOUNDED_SIDE;
        return outside;
    }

private:
    std::vector<std::vector<Exact::Point_2>> loops_;
};

template <class SideOf> void give_side(const SideOf &side, const std::vector<double> &points, std::size_t dim, std::vector<double> &signs) {
    for (std::size_t i = 0; i < signs.size(); ++i) signs[i] = side.outside(&points[dim * i]) ? 1 : -1;
}

}  // namespace

struct ClosestPoints::Trees {
    std::unique_ptr<SegmentTree> segments;
    std::unique_ptr<TriangleTree> triangles;
};

ClosestPoints::ClosestPoints(const Facets &mesh) : trees_(new Trees) {
    if (mesh.dim == 2)
        trees_->segments.reset(new SegmentTree(segments_of(mesh)));
    else
        trees_->triangles.reset(new TriangleTree(soup_of(mesh)));
}

ClosestPoints::~ClosestPoints() = default;

double ClosestPoints::distance(const double *p) const {
    return trees_->triangles ? trees_->triangles->distance(plain(p, 3)) : trees_->segments->distance(plain(p, 2));
}

std::array<double, 3> ClosestPoints::closest(const double *p) const {
    const Plain::Point_3 q = trees_->triangles ? trees_->triangles->tree.closest_point(plain(p, 3))
                                               : trees_->segments->tree.closest_point(plain(p, 2));
    return {q.x(), q.y(), q.z()};
}

std::vector<double> exact_distances(const Mesh &mesh, const std::vector<double> &points) {
    const Facets facets = facets_of(mesh);
    const std::size_t dim = facets.dim;
    std::vector<double> distances(points.size() / dim);
    if (!report_of(mesh).closed)
        distances = signed_distances(mesh, points);
    else if (dim == 2)
        give_side(SideOfCurves(facets), points, dim, distances);
    else
        give_side(Side(facets), points, dim, distances);
    const ClosestPoints closest(facets);
    for (std::size_t i = 0; i < distances.size(); ++i)
        distances[i] = std::copysign(closest.distance(&points[dim * i]), distances[i]);
    return distances;
}

const char *oracle_version() { return CGAL_VERSION_STR; }

}  // namespace bench
