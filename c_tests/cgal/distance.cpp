// ko_mesh_signed_distance against CGAL, which reads the same files by its own readers.
//
//   cgal_distance FOLDER           FOLDER is that of the test data

#include "../check.h"
#include "oracle.h"

#include <keepout.hpp>

/// Largest difference of distances in units of D, and points on the wrong side among those farther than 1e-9 D.
static void compare(const char *what, const Oracle &oracle, const keepout::Mesh &mesh, const std::vector<Oracle::Point> &points) {
    const std::vector<double> distances = mesh.signed_distance(flat(points));
    double worst = 0.0;
    int wrong = 0;
    for (std::size_t i = 0; i < points.size(); i++) {
        const double right = oracle.distance(points[i]) / oracle.diagonal();
        worst = std::max(worst, std::abs(std::abs(distances[i]) / oracle.diagonal() - right));
        wrong += right > 1e-9 && (distances[i] < 0.0) != oracle.inside(points[i]);
    }
    std::printf("  %-12s %zu points: distances within %.1e D, %d on the wrong side\n", what, points.size(), worst, wrong);
    CHECK(worst <= 1e-12);
    CHECK(wrong == 0);
}

int main(int argc, char **argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: cgal_distance FOLDER\n");
        return EXIT_FAILURE;
    }
    for (const char *file : {"stanford/bunny_lsdo_genie.stl", "stanford/armadillo_cgal.off", "mechanical/fandisk.obj",
                             "anatomy/femur_cgal.off", "mechanical/rotor.off"}) {
        std::printf("%s\n", file);
        const std::string path = std::string(argv[1]) + "/" + file;
        const Oracle oracle(path);
        const keepout::Mesh mesh = keepout::Mesh::read(path);
        std::mt19937_64 random(1);
        std::vector<Oracle::Point> box, near, on;
        for (int i = 0; i < 5000; i++) {
            box.push_back(oracle.in_box(random, 1.3));
            on.push_back(oracle.on_surface(random));
            const double reach = 0.02 * oracle.diagonal();
            const auto shift = [&] { return reach * (2.0 * Oracle::unit(random) - 1.0); };
            near.push_back(on.back() + Oracle::Kernel::Vector_3(shift(), shift(), shift()));
        }
        compare("in the box", oracle, mesh, box);
        compare("near", oracle, mesh, near);
        compare("on it", oracle, mesh, on);
    }
    return check_result();
}
