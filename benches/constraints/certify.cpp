// Certificates: how tight they are, beside an attack by random points and climbs whose distances CGAL tells, and how their cost grows.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "../oracle.hpp"
#include "../points.hpp"
#include "../stats.hpp"
#include "../timing.hpp"

#include <cmath>
#include <limits>

namespace bench {

namespace {

constexpr const char *BUNNY = "stanford/bunny_lsdo_genie.stl", *JOINT = "mechanical/joint.off";
constexpr std::size_t SAMPLES = 25000;
// d and r, in D.
constexpr double CLEARANCE = 0.01, COVERING = 0.005;
constexpr double TIGHT_LIMIT = 1.3;
// Random points of the attack, in batches; points that phi is climbed from, and steps of each climb.
constexpr std::size_t ATTACK = 10000000, BATCH = 100000, CLIMBS = 60;
constexpr int STEPS = 400;

struct Found {
    double phi;
    std::array<double, 3> place;
};

double phi_at(const Field &field, const std::array<double, 3> &place) {
    double phi = 0;
    check(ko_field_eval(field.get(), place.data(), 1, &phi, nullptr, nullptr), "ko_field_eval");
    return phi;
}

// The largest phi within `reach` of the shape, as far as random points of it, moved by at most that, and climbs from the best of them find it.
double attack(const Field &field, const Mesh &mesh, double reach) {
    const Facets facets = facets_of(mesh);
    const ClosestPoints shape(facets);
    Uniform uniform(5);
    std::vector<Found> best;
    std::vector<double> phi(BATCH);
    for (std::size_t batch = 0; batch < ATTACK / BATCH; ++batch) {
        SurfacePoints drawn = draw_by_area(facets, BATCH, /*seed*/ batch);
        for (std::size_t i = 0; i < BATCH; ++i) {
            double by[3], squared = 0;
            for (double &x : by) squared += (x = 2 * uniform() - 1) * x;
            const double scale = reach * uniform() / std::max(std::sqrt(squared), 1e-9);
            for (int a = 0; a < 3; ++a) drawn.points[3 * i + a] += scale * by[a];
        }
        eval(field, drawn.points, phi.data());
        for (std::size_t i = 0; i < BATCH; ++i) {
            if (best.size() == CLIMBS && !(phi[i] > best.back().phi)) continue;
            const Found found{phi[i], {drawn.points[3 * i], drawn.points[3 * i + 1], drawn.points[3 * i + 2]}};
            best.insert(std::upper_bound(best.begin(), best.end(), found, [](auto &a, auto &b) { return a.phi > b.phi; }), found);
            if (best.size() > CLIMBS) best.pop_back();
        }
    }
    double largest = -std::numeric_limits<double>::infinity();
    for (Found at : best) {
        double step = 0.3 * reach;
        for (int k = 0; k < STEPS; ++k) {
            Found next = at;
            for (double &x : next.place) x += step * (2 * uniform() - 1);
            next.phi = phi_at(field, next.place);
            const bool better = next.phi > at.phi && shape.distance(next.place.data()) <= reach;
            if (better) at = next;
            step *= better ? 1.5 : 0.95;
        }
        largest = std::max(largest, at.phi);
    }
    return largest;
}

struct Certified {
    ko_certificate certificate;
    double seconds;
};

Certified certify_on(const Field &field, const Mesh &mesh, std::uint32_t n_threads) {
    ko_certify_options options;
    check(ko_certify_options_init(&options, sizeof options), "ko_certify_options_init");
    options.n_threads = n_threads;
    const double D = report_of(field).diagonal;
    Certified made{};
    made.seconds = seconds([&] {
        check(ko_field_certify(field.get(), mesh.get(), CLEARANCE * D, COVERING * D, &options, sizeof made.certificate, &made.certificate),
              "ko_field_certify");
    });
    if (!made.certificate.side_certified) throw std::runtime_error("the side is not certified");
    return made;
}

void tightness(const char *name, const Mesh &mesh, const ko_fit_options &options) {
    const std::string key = std::string("certify_") + name;
    const Field field = fit(sample(mesh, SAMPLES), options);
    const ko_fit_report report = report_of(field);
    const double D = report.diagonal;
    certify_on(field, mesh, 1);  // the mesh keeps its tree of distances
    const Certified one = certify_on(field, mesh, 1), two = certify_on(field, mesh, 2);
    const ko_certificate &certificate = two.certificate;
    const double largest = attack(field, mesh, (CLEARANCE + COVERING) * D);
    print_count(key + "_control_points", report.n_unknowns);
    print(key + "_threshold", certificate.threshold / D, "D");
    print(key + "_largest_found", certificate.largest_found / D, "D");
    print(key + "_largest_by_attack", largest / D, "D");
    if (!(largest < certificate.threshold)) throw std::runtime_error(key + ": the attack broke the threshold");
    print(key + "_threshold_over_attack", certificate.threshold / largest, "times");
    print(key + "_threshold_over_attack_limit", TIGHT_LIMIT, "times");
    print(key + "_surface_error", certificate.surface_error / D, "D");
    print(key + "_steepest", certificate.steepest);
    print_count(key + "_boxes", certificate.n_boxes);
    print(key + "_one_thread", one.seconds, "s");
    print(key + "_two_threads", two.seconds, "s");
    print(key + "_over_fit", one.seconds / (report.seconds_assembly + report.seconds_solve), "times, one thread");
}

// Each triangle cut into four: the same shape.
Mesh cut_in_four(const Mesh &mesh) {
    const Facets coarse = facets_of(mesh);
    std::vector<double> vertices;
    std::vector<std::uint32_t> triangles;
    for (std::size_t f = 0; f < coarse.size(); ++f) {
        const auto first = static_cast<std::uint32_t>(vertices.size() / 3);
        const double *corners[3] = {coarse.vertex(f, 0), coarse.vertex(f, 1), coarse.vertex(f, 2)};
        for (const double *corner : corners) vertices.insert(vertices.end(), corner, corner + 3);
        // The sum of two is the same in either order, so that neighbours share their vertices.
        for (int k = 0; k < 3; ++k)
            for (int a = 0; a < 3; ++a) vertices.push_back(0.5 * (corners[k][a] + corners[(k + 1) % 3][a]));
        for (const std::uint32_t corner : {0, 3, 5, 3, 1, 4, 5, 4, 2, 3, 4, 5}) triangles.push_back(first + corner);
    }
    return mesh_from(vertices, triangles);
}

struct Size {
    double n, seconds;
};

double exponent(const Size &from, const Size &to) { return std::log(to.seconds / from.seconds) / std::log(to.n / from.n); }

void growth(const Mesh &bunny) {
    const Cloud cloud = sample(bunny, SAMPLES);
    std::vector<Size> sizes;
    for (const Counts counts : {Counts{20, 19, 16}, Counts{32, 31, 25}, Counts{51, 49, 40}, Counts{82, 79, 64}}) {
        const Field field = fit(cloud, options_of(counts));
        certify_on(field, bunny, 1);
        const Certified made = certify_on(field, bunny, 1);
        const std::uint64_t n = report_of(field).n_unknowns;
        const std::string key = "certify_bunny_of_" + std::to_string(n) + "_control_points";
        print(key + "_time", made.seconds, "s");
        print_count(key + "_boxes", made.certificate.n_boxes);
        sizes.push_back({static_cast<double>(n), made.seconds});
    }
    print("certify_time_exponent_by_control_points", exponent(sizes.front(), sizes.back()));

    const Field field = fit(cloud, options_of({32, 31, 25}));
    sizes.clear();
    Mesh mesh = cut_in_four(bunny);
    for (int k = 0; k < 3; ++k) {
        if (k > 0) mesh = cut_in_four(mesh);
        const std::size_t n = facets_of(mesh).size();
        certify_on(field, mesh, 1);
        const Certified made = certify_on(field, mesh, 1);
        const std::string key = "certify_bunny_of_" + std::to_string(n) + "_triangles";
        print(key + "_time", made.seconds, "s");
        print_count(key + "_boxes", made.certificate.n_boxes);
        sizes.push_back({static_cast<double>(n), made.seconds});
    }
    print("certify_time_exponent_by_triangles", exponent(sizes.front(), sizes.back()));
}

}  // namespace

void certify(const Data &data) {
    const Mesh bunny = read_mesh(data(BUNNY));
    print_count("certify_attack_points", ATTACK);
    tightness("bunny", bunny, options_of({32, 31, 25}));
    ko_fit_options refined = options_of();
    refined.max_error = 2e-3;
    refined.tolerance = 1e-3;
    tightness("refined_bunny", bunny, refined);
    tightness("joint", read_mesh(data(JOINT)), options_of());
    growth(bunny);
}

}  // namespace bench
