// Fields fitted with the defaults against CGAL: on held-out points of the surface, and by the sign in the box.
//
//   cgal_fit FOLDER           FOLDER is that of the test data
//
// Limits are loose enough to outlive a tuning of the defaults, and far tighter than any mistake of scale, side or normals would pass.

#include "../check.h"
#include "oracle.h"

#include <keepout.hpp>

struct Case {
    const char *file;
    double rms, max; ///< Limits on the surface, fractions of D.
    int wrong_signs; ///< Limit, of 20,000 points in the box, among those farther than one cell.
};

static double longest_cell(const ko_fit_report &report) {
    double longest = 0.0;
    for (int a = 0; a < 3; a++) {
        longest = std::max(longest, (report.box_max[a] - report.box_min[a]) / (report.control_points[a] - 3));
    }
    return longest;
}

static void check_surface(const Case &limits, const Oracle &oracle, const keepout::Field &field) {
    enum { N = 20000 };
    std::mt19937_64 random(20240229);
    std::vector<Oracle::Point> points;
    for (int i = 0; i < N; i++) {
        points.push_back(oracle.on_surface(random));
    }
    const auto at = field.eval(flat(points));
    double squares = 0.0, max = 0.0, slopes = 0.0;
    for (std::size_t i = 0; i < N; i++) {
        const double slope = std::hypot(at.gradients[3 * i], at.gradients[3 * i + 1], at.gradients[3 * i + 2]);
        // To first order, how far phi = 0 is from the point.
        const double off = std::max(std::abs(at.values[i]), std::abs(at.values[i]) / slope) / oracle.diagonal();
        squares += off * off;
        max = std::max(max, off);
        slopes += slope;
    }
    const double rms = std::sqrt(squares / N);
    std::printf("  on the surface: rms %.2e D, max %.2e D, mean slope %.4f\n", rms, max, slopes / N);
    CHECK(rms <= limits.rms);
    CHECK(max <= limits.max);
    CHECK_NEAR(slopes / N, 1.0, 0.05);
}

/// Near the surface phi is the distance, give or take.
static void check_beside(const Oracle &oracle, const keepout::Field &field) {
    enum { N = 2000 };
    std::mt19937_64 random(3);
    std::vector<Oracle::Point> points;
    for (int i = 0; i < N; i++) {
        const auto shift = [&] { return 0.005 * oracle.diagonal() * (2.0 * Oracle::unit(random) - 1.0); };
        points.push_back(oracle.on_surface(random) + Oracle::Kernel::Vector_3(shift(), shift(), shift()));
    }
    const std::vector<double> values = field.values(flat(points));
    double squares = 0.0;
    for (std::size_t i = 0; i < N; i++) {
        const double right = (oracle.inside(points[i]) ? -1.0 : 1.0) * oracle.distance(points[i]);
        squares += std::pow((values[i] - right) / oracle.diagonal(), 2);
    }
    std::printf("  within 0.005 D of it: rms against the distance %.2e D\n", std::sqrt(squares / N));
    CHECK(std::sqrt(squares / N) <= 2e-3);
}

static void check_signs(const Case &limits, const Oracle &oracle, const keepout::Field &field) {
    std::mt19937_64 random(4);
    std::vector<Oracle::Point> points;
    for (int i = 0; i < 20000; i++) {
        points.push_back(oracle.in_box(random, 1.15));
    }
    const std::vector<double> values = field.values(flat(points));
    const double cell = longest_cell(field.report());
    int wrong = 0;
    for (std::size_t i = 0; i < points.size(); i++) {
        wrong += (values[i] < 0.0) != oracle.inside(points[i]) && oracle.distance(points[i]) > cell;
    }
    std::printf("  farther than a cell, %.4f D: %d wrong signs\n", cell / oracle.diagonal(), wrong);
    CHECK(wrong <= limits.wrong_signs);
}

int main(int argc, char **argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: cgal_fit FOLDER\n");
        return EXIT_FAILURE;
    }
    const Case cases[] = {
        {"stanford/bunny_lsdo_genie.stl", 1.5e-3, 1.0e-2, 0},
        {"stanford/armadillo_cgal.off", 2.0e-3, 1.5e-2, 0},
        {"mechanical/fandisk.obj", 2.0e-3, 1.5e-2, 0},
    };
    for (const Case &limits : cases) {
        std::printf("%s\n", limits.file);
        const std::string path = std::string(argv[1]) + "/" + limits.file;
        const Oracle oracle(path);
        const keepout::Field field = keepout::Field::fit(keepout::Mesh::read(path).sample(25000, 1));
        check_surface(limits, oracle, field);
        check_beside(oracle, field);
        check_signs(limits, oracle, field);
    }
    return check_result();
}
