// What CGAL says of a mesh that CGAL read: distance to it, side of it, points of it.

#ifndef KEEPOUT_ORACLE_H
#define KEEPOUT_ORACLE_H

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/IO/polygon_mesh_io.h>
#include <CGAL/Polygon_mesh_processing/bbox.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

class Oracle {
public:
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Point = Kernel::Point_3;

    explicit Oracle(const std::string &path) : mesh_(read(path)), tree_(faces(mesh_).first, faces(mesh_).second, mesh_), side_(mesh_) {
        const CGAL::Bbox_3 box = CGAL::Polygon_mesh_processing::bbox(mesh_);
        for (int a = 0; a < 3; a++) {
            low_[a] = box.min(a);
            high_[a] = box.max(a);
        }
        diagonal_ = std::sqrt(CGAL::squared_distance(Point(low_[0], low_[1], low_[2]), Point(high_[0], high_[1], high_[2])));
        double area = 0.0;
        for (const auto face : faces(mesh_)) {
            area += CGAL::Polygon_mesh_processing::face_area(face, mesh_);
            areas_.push_back(area);
        }
        tree_.accelerate_distance_queries();
    }

    /// Diagonal of the bounding box.
    double diagonal() const { return diagonal_; }

    double distance(const Point &p) const { return std::sqrt(tree_.squared_distance(p)); }

    /// Whether the point lies in the solid or on its surface.
    bool inside(const Point &p) const { return side_(p) != CGAL::ON_UNBOUNDED_SIDE; }

    /// A point uniform in the bounding box made `stretch` times as large.
    Point in_box(std::mt19937_64 &random, double stretch) const {
        double x[3];
        for (int a = 0; a < 3; a++) {
            x[a] = 0.5 * (low_[a] + high_[a]) + stretch * (high_[a] - low_[a]) * (unit(random) - 0.5);
        }
        return Point(x[0], x[1], x[2]);
    }

    /// A point uniform on the surface.
    Point on_surface(std::mt19937_64 &random) const {
        const auto at = std::lower_bound(areas_.begin(), areas_.end(), unit(random) * areas_.back()) - areas_.begin();
        const auto face = *std::next(faces(mesh_).first, std::min<std::ptrdiff_t>(at, static_cast<std::ptrdiff_t>(areas_.size()) - 1));
        std::vector<Point> corner;
        for (const auto v : CGAL::vertices_around_face(mesh_.halfedge(face), mesh_)) {
            corner.push_back(mesh_.point(v));
        }
        const double root = std::sqrt(unit(random)), along = unit(random);
        return CGAL::barycenter(corner[0], 1.0 - root, corner[1], root * (1.0 - along), corner[2], root * along);
    }

    static double unit(std::mt19937_64 &random) { return std::generate_canonical<double, 53>(random); }

private:
    using Mesh = CGAL::Surface_mesh<Point>;
    using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_face_graph_triangle_primitive<Mesh>>>;

    static Mesh read(const std::string &path) {
        Mesh mesh;
        if (!CGAL::Polygon_mesh_processing::IO::read_polygon_mesh(path, mesh) || !CGAL::is_closed(mesh)) {
            throw std::runtime_error(path + " is no closed mesh to CGAL");
        }
        return mesh;
    }

    Mesh mesh_;
    Tree tree_;
    CGAL::Side_of_triangle_mesh<Mesh, Kernel> side_;
    std::vector<double> areas_;
    double low_[3], high_[3], diagonal_;
};

/// Points as the C calls take them: [3 * n].
inline std::vector<double> flat(const std::vector<Oracle::Point> &points) {
    std::vector<double> flat;
    for (const auto &p : points) {
        flat.insert(flat.end(), {p.x(), p.y(), p.z()});
    }
    return flat;
}

#endif
