// Keepout's C calls as the benches use them: handles that free themselves, statuses that become exceptions.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include <keepout.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace bench {

struct Free {
    void operator()(ko_mesh *mesh) const { ko_mesh_free(mesh); }
    void operator()(ko_cloud *cloud) const { ko_cloud_free(cloud); }
    void operator()(ko_field *field) const { ko_field_free(field); }
};
using Mesh = std::unique_ptr<ko_mesh, Free>;
using Cloud = std::unique_ptr<ko_cloud, Free>;
using Field = std::unique_ptr<ko_field, Free>;
using Counts = std::array<std::uint32_t, 3>;

struct LibraryError : std::runtime_error {
    LibraryError(const char *call, std::int32_t code)
        : std::runtime_error(std::string(call) + ": " + ko_status_string(code) + ": " + ko_last_error()), status(code) {}
    std::int32_t status;
};

inline void check(std::int32_t status, const char *call) {
    if (status < 0) throw LibraryError(call, status);
}

inline Mesh read_mesh(const std::string &path) {
    ko_mesh *mesh = nullptr;
    check(ko_mesh_read(path.c_str(), &mesh), "ko_mesh_read");
    return Mesh(mesh);
}

inline ko_mesh_report report_of(const Mesh &mesh) {
    ko_mesh_report report{};
    check(ko_mesh_get_report(mesh.get(), sizeof report, &report), "ko_mesh_get_report");
    return report;
}

inline std::size_t dim_of(const Mesh &mesh) {
    std::uint32_t dim = 0;
    check(ko_mesh_get_dim(mesh.get(), &dim), "ko_mesh_get_dim");
    return dim;
}

inline Mesh mesh_from(const std::vector<double> &vertices, const std::vector<std::uint32_t> &triangles) {
    ko_mesh *mesh = nullptr;
    check(ko_mesh_from_triangles(vertices.data(), vertices.size() / 3, triangles.data(), triangles.size() / 3, &mesh),
          "ko_mesh_from_triangles");
    return Mesh(mesh);
}

// A mesh's arrays: vertices [n x dim], facets [n x dim], which are triangles or, in the plane, segments.
struct Facets {
    std::size_t dim;
    std::vector<double> vertices;
    std::vector<std::uint32_t> facets;

    const double *vertex(std::size_t facet, std::size_t corner) const { return &vertices[dim * facets[dim * facet + corner]]; }
    std::size_t size() const { return facets.size() / dim; }
};

inline Facets facets_of(const Mesh &mesh) {
    std::size_t n_vertices = 0, n_facets = 0;
    check(ko_mesh_get_size(mesh.get(), &n_vertices, &n_facets), "ko_mesh_get_size");
    const std::size_t dim = dim_of(mesh);
    Facets arrays{dim, std::vector<double>(dim * n_vertices), std::vector<std::uint32_t>(dim * n_facets)};
    check(ko_mesh_copy(mesh.get(), n_vertices, n_facets, arrays.vertices.data(), arrays.facets.data()), "ko_mesh_copy");
    return arrays;
}

inline std::vector<double> signed_distances(const Mesh &mesh, const std::vector<double> &points) {
    std::vector<double> distances(points.size() / dim_of(mesh));
    check(ko_mesh_signed_distance(mesh.get(), points.data(), distances.size(), distances.data()), "ko_mesh_signed_distance");
    return distances;
}

inline Cloud sample(const Mesh &mesh, std::size_t n_points) {
    ko_cloud *cloud = nullptr;
    check(ko_mesh_sample(mesh.get(), n_points, /*seed*/ 1, &cloud), "ko_mesh_sample");
    return Cloud(cloud);
}

inline Cloud cloud_from(std::size_t dim, const std::vector<double> &points, const std::vector<double> &normals) {
    ko_cloud *cloud = nullptr;
    check(ko_cloud_from_points(static_cast<std::uint32_t>(dim), points.data(), normals.data(), points.size() / dim, &cloud),
          "ko_cloud_from_points");
    return Cloud(cloud);
}

// The library's defaults on one thread; counts of 0 leave the grid to the library.
inline ko_fit_options options_of(Counts control_points = {0, 0, 0}) {
    ko_fit_options options;
    check(ko_fit_options_init(&options, sizeof options), "ko_fit_options_init");
    std::copy(control_points.begin(), control_points.end(), options.control_points);
    options.n_threads = 1;
    return options;
}

inline Field fit(const Cloud &cloud, const ko_fit_options &options) {
    ko_field *field = nullptr;
    check(ko_field_fit(cloud.get(), &options, &field), "ko_field_fit");
    return Field(field);
}

inline ko_fit_report report_of(const Field &field) {
    ko_fit_report report{};
    check(ko_field_get_report(field.get(), sizeof report, &report), "ko_field_get_report");
    return report;
}

inline void eval(const Field &field, const std::vector<double> &points, double *values, double *gradients = nullptr,
                 double *hessians = nullptr) {
    check(ko_field_eval(field.get(), points.data(), points.size() / report_of(field).dim, values, gradients, hessians),
          "ko_field_eval");
}

inline std::vector<double> values_of(const Field &field, const std::vector<double> &points) {
    std::vector<double> values(points.size() / report_of(field).dim);
    eval(field, points, values.data());
    return values;
}

}  // namespace bench
