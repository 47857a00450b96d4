// Level sets as meshes: their topology beside the mesh's, and offsets against exact ones.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../timing.hpp"
#include "common.hpp"

#include <map>

namespace bench {

namespace {

Mesh level_set(const Field &field, double level) {
    ko_level_set_options options;
    check(ko_level_set_options_init(&options, sizeof options), "ko_level_set_options_init");
    ko_mesh *mesh = nullptr;
    check(ko_field_level_set(field.get(), level, &options, &mesh), "ko_field_level_set");
    return Mesh(mesh);
}

// Euler characteristic: vertices - edges + triangles.
struct Topology {
    std::uint64_t components = 0, boundary_edges = 0, non_manifold = 0;
    std::int64_t euler = 0;
};

// Smaller components of a level set: voids in the solid, and islands beside it.
struct Crumbs {
    std::size_t n = 0;
    double largest = 0;  // diagonal of the box around the largest, in the mesh's unit
};

Topology topology_of(const Mesh &mesh) {
    const ko_mesh_report report = report_of(mesh);
    const Facets facets = facets_of(mesh);
    std::vector<std::uint64_t> edges;
    for (std::size_t f = 0; f < facets.size(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const std::uint64_t a = facets.facets[3 * f + k], b = facets.facets[3 * f + (k + 1) % 3];
            edges.push_back(std::min(a, b) << 32 | std::max(a, b));
        }
    }
    std::sort(edges.begin(), edges.end());
    const auto n_edges = std::unique(edges.begin(), edges.end()) - edges.begin();
    const auto n_others = static_cast<std::int64_t>(report.n_vertices - report.n_unreferenced + facets.size());
    return {report.n_components, report.n_boundary_edges, report.n_non_manifold_edges + report.n_non_manifold_vertices,
            n_others - n_edges};
}

double diagonal_of(const Mesh &mesh) {
    const ko_mesh_report report = report_of(mesh);
    double square = 0;
    for (int k = 0; k < 3; ++k) square += std::pow(report.bounds_max[k] - report.bounds_min[k], 2);
    return std::sqrt(square);
}

// The component with the longest diagonal; the others are summed up in `crumbs`.
Mesh largest_component(const Mesh &mesh, Crumbs &crumbs) {
    const Facets facets = facets_of(mesh);
    std::vector<std::uint32_t> parent(facets.vertices.size() / 3);
    for (std::uint32_t v = 0; v < parent.size(); ++v) parent[v] = v;
    const auto root = [&](std::uint32_t v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    for (std::size_t f = 0; f < facets.size(); ++f)
        for (int k = 1; k < 3; ++k) parent[root(facets.facets[3 * f + k])] = root(facets.facets[3 * f]);
    std::map<std::uint32_t, std::vector<std::uint32_t>> triangles;
    for (std::size_t f = 0; f < facets.size(); ++f) {
        auto &of = triangles[root(facets.facets[3 * f])];
        of.insert(of.end(), &facets.facets[3 * f], &facets.facets[3 * f] + 3);
    }
    Mesh largest;
    for (const auto &component : triangles) {
        std::vector<double> vertices;
        std::vector<std::uint32_t> corners;
        std::map<std::uint32_t, std::uint32_t> number_of;
        for (const std::uint32_t v : component.second) {
            const auto [at, fresh] = number_of.emplace(v, static_cast<std::uint32_t>(number_of.size()));
            if (fresh) vertices.insert(vertices.end(), &facets.vertices[3 * v], &facets.vertices[3 * v] + 3);
            corners.push_back(at->second);
        }
        Mesh other = mesh_from(vertices, corners);
        if (!largest || diagonal_of(other) > diagonal_of(largest)) std::swap(largest, other);
        if (!other) continue;
        ++crumbs.n;
        crumbs.largest = std::max(crumbs.largest, diagonal_of(other));
    }
    return largest;
}

std::string text(const Topology &topology) {
    return std::to_string(topology.components) + " components, Euler characteristic " + std::to_string(topology.euler) + ", " +
           std::to_string(topology.boundary_edges) + " boundary edges";
}

bool same(const Topology &a, const Topology &b) {
    return a.components == b.components && a.euler == b.euler && a.boundary_edges == b.boundary_edges && b.non_manifold == 0;
}

struct Named {
    const char *name, *path;
};

const Named SHAPES[] = {{"bunny", "stanford/bunny_lsdo_genie.stl"},     {"armadillo", "stanford/armadillo_cgal.off"},
                        {"femur", "anatomy/femur_cgal.off"},             {"rotor", "mechanical/rotor.off"},
                        {"bwb", "aircraft/bwb.stl"},                     {"fandisk", "mechanical/fandisk.obj"},
                        {"joint", "mechanical/joint.off"},               {"spool", "mechanical/spool.off"},
                        {"knot", "mechanical/knot1.off"},                {"double_torus", "mechanical/double-torus.off"},
                        {"heart", "anatomy/heart_sphinxsys.stl"},        {"head", "anatomy/head_with_ears_tuberlin.ply"}};

// What differed, of all level sets.
struct Differing {
    std::uint64_t n = 0, whole = 0, largest = 0;
};

void topology_of_shape(const std::string &key, const Mesh &mesh, const Topology &expected, std::size_t n, Differing &differing) {
    const Field field = fit(sample(mesh, n), options_of());
    Mesh found;
    const double time = seconds([&] { found = level_set(field, 0); });
    const Topology whole = topology_of(found);
    Crumbs crumbs;
    const Topology largest = topology_of(largest_component(found, crumbs));
    print(key, text(whole) + (same(expected, whole) ? "" : ": differs"));
    print(key + "_largest_component", text(largest) + (same(expected, largest) ? "" : ": differs"));
    if (crumbs.n > 0) print(key + "_largest_of_the_others", crumbs.largest / cell_of(report_of(field)), "cells");
    print_count(key + "_triangles", report_of(found).n_triangles);
    print(key + "_seconds", time, "s");
    ++differing.n;
    differing.whole += !same(expected, whole);
    differing.largest += !same(expected, largest);
}

void topology(const Data &data) {
    Differing differing;
    for (const Named &shape : SHAPES) {
        const Mesh mesh = read_mesh(data(shape.path));
        const Topology expected = topology_of(mesh);
        const std::string key = std::string("level_set_") + shape.name;
        print(key + "_mesh", text(expected));
        for (const std::size_t n : {25000, 40000})
            topology_of_shape(key + "_" + std::to_string(n / 1000) + "k", mesh, expected, n, differing);
    }
    const std::string of = "of " + std::to_string(differing.n);
    print_count("level_sets_of_other_topology_than_the_mesh", differing.whole, of.c_str());
    print_count("level_sets_of_other_topology_than_the_mesh_limit", 0, of.c_str());
    print_count("level_sets_whose_largest_component_has_another", differing.largest, of.c_str());
}

// Figure 7: how far vertices of the level set phi = level are from the surface, less the level; and the level set 0 for comparison.
void offsets(const Data &data) {
    const Mesh mesh = read_mesh(data("stanford/bunny_lsdo_genie.stl"));
    const Field field = fit(sample(mesh, N_SAMPLES), options_of());
    print_fit("offsets_bunny", field);
    const double D = report_of(field).diagonal;
    const std::pair<const char *, double> levels[] = {
        {"0", 0}, {"plus_0.005", 0.005}, {"minus_0.005", -0.005}, {"plus_0.01", 0.01}, {"minus_0.01", -0.01}};
    for (const auto &[name, level] : levels) {
        const std::vector<double> vertices = facets_of(level_set(field, level * D)).vertices;
        const std::vector<double> exact = exact_distances(mesh, vertices);
        Errors errors;
        for (const double distance : exact) errors.add(distance / D - level);
        print_errors(std::string("offsets_bunny_") + name, errors);
    }
}

}  // namespace

void level_sets(const Data &data) {
    topology(data);
    offsets(data);
}

}  // namespace bench
