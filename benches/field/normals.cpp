// Normals estimated from points alone, beside those that the points came with.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "common.hpp"
#include "shapes.hpp"

namespace bench {

namespace {

// A normal is right when it is on the side of the true one. The angle between both, whatever their signs, is told apart.
void estimate(const std::string &key, const Mesh &mesh, std::size_t n) {
    const std::size_t dim = dim_of(mesh);
    std::vector<double> points(dim * n), given(dim * n), found(dim * n);
    check(ko_cloud_copy(sample(mesh, n).get(), n, points.data(), given.data()), "ko_cloud_copy");
    ko_normal_options options;
    check(ko_normal_options_init(&options, sizeof options), "ko_normal_options_init");
    options.n_threads = 1;
    ko_normal_report report{};
    ko_cloud *cloud = nullptr;
    check(ko_cloud_estimate_normals(static_cast<std::uint32_t>(dim), points.data(), n, &options, &cloud, nullptr, sizeof report, &report),
          "ko_cloud_estimate_normals");
    const Cloud estimated(cloud);
    check(ko_cloud_copy(estimated.get(), n, nullptr, found.data()), "ko_cloud_copy");
    std::size_t right = 0;
    double squares = 0;
    for (std::size_t i = 0; i < n; ++i) {
        double cosine = 0;
        for (std::size_t k = 0; k < dim; ++k) cosine += given[dim * i + k] * found[dim * i + k];
        right += cosine > 0;
        const double angle = std::acos(std::min(std::abs(cosine), 1.0)) * 57.29577951308232;
        squares += angle * angle;
    }
    print_count(key + "_points", n);
    print(key + "_right_side", 100 * static_cast<double>(right) / static_cast<double>(n), "%");
    print(key + "_right_side_limit", 99.9, "%");
    print_count(key + "_wrong_side", n - right, "points");
    print(key + "_angle_rms", std::sqrt(squares / static_cast<double>(n)), "degrees");
    print(key + "_agreement", report.agreement);
    print(key + "_seconds", report.seconds, "s");
}

}  // namespace

void normals(const Data &data) {
    const std::pair<const char *, const char *> files[] = {{"bunny", "stanford/bunny_lsdo_genie.stl"},
                                                           {"armadillo", "stanford/armadillo_cgal.off"},
                                                           {"fandisk", "mechanical/fandisk.obj"},
                                                           {"knot", "mechanical/knot1.off"}};
    for (const auto &[name, path] : files) estimate(std::string("normals_") + name, read_mesh(data(path)), N_SAMPLES);
    estimate("normals_sphere", sphere(), N_SAMPLES);
    estimate("normals_torus", torus(), N_SAMPLES);
    for (const char *name : {"clarky", "naca0012", "rae2822", "s1223"})
        estimate(std::string("normals_") + name, curves_from(data((std::string("curves2d/") + name + ".dat").c_str())), 2000);
}

}  // namespace bench
