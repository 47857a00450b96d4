// SPDX-License-Identifier: Apache-2.0 OR MIT
// Twelve wind turbines on a site with a bay and a hole, by NLopt's SLSQP: as little power as may be lost in each other's wakes, all
// turbines on the site, none too near to another. The optimum is checked by its KKT residual and by exact distances to the boundary.
//
//   keepout_site [PICTURE.svg]      draws the site there
//   keepout_site --broken-start     starts beyond all bounds: shows what becomes of a point that Keepout refuses
#include <keepout.hpp>

#include <nlopt.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

namespace {

constexpr std::size_t n_turbines = 12;
constexpr double pi = 3.14159265358979323846;
constexpr double spacing = 0.6;     // km, between two turbines
constexpr double setback = 0.02;    // km, of a turbine from the boundary; the field is nearer to the boundary than that
constexpr double rotor = 0.12;      // km, how wide a wake begins
constexpr double fading = 1.5;      // km, along which a wake fades to a quarter

struct Wind {
    double x, y, weight;
};

// Where the wind blows to, and how often: 24 directions, mostly from the west.
std::vector<Wind> wind_rose() {
    std::vector<Wind> rose;
    for (int k = 0; k < 24; ++k) {
        const double angle = 2 * pi * k / 24;
        rose.push_back({std::cos(angle), std::sin(angle), (1 + 0.6 * std::cos(angle)) / 24});
    }
    return rose;
}

// The land, counter-clockwise, then a lake in it, clockwise; km.
keepout::Mesh make_site() {
    std::vector<double> points;
    constexpr int n = 400, n_lake = 100;
    for (int i = 0; i < n; ++i) {
        const double t = 2 * pi * i / n, r = 1 + 0.25 * std::cos(3 * t) - 0.1 * std::sin(2 * t);
        points.insert(points.end(), {1.2 * r * std::cos(t), r * std::sin(t)});
    }
    for (int i = 0; i < n_lake; ++i) {
        const double t = -2 * pi * i / n_lake;
        points.insert(points.end(), {0.1 + 0.25 * std::cos(t), 0.05 + 0.18 * std::sin(t)});
    }
    return keepout::Mesh::from_polylines(points, std::vector<std::size_t>{0, n});
}

void check(std::int32_t status) {
    if (status < 0)
        throw keepout::Error(status, ko_last_error());
}

// The deficit of wind at (dx, dy) from a turbine, and its derivatives: a bell across, ever wider and weaker along, and next to nothing
// upwind. It is smooth, as SLSQP needs: `down` is a softplus of the way along the wind.
double wake(double dx, double dy, const Wind &wind, double derivative[2]) {
    const double along = dx * wind.x + dy * wind.y, across = dx * wind.y - dy * wind.x;
    const double on = 1 / (1 + std::exp(-along / rotor)), on_along = on * (1 - on) / rotor;
    const double down = std::max(along, 0.0) + rotor * std::log1p(std::exp(-std::fabs(along) / rotor));
    const double width = 0.5 * rotor + 0.05 * down, width_along = 0.05 * on;
    const double fade = 1 / ((1 + down / fading) * (1 + down / fading)), fade_along = -2 * fade * on / (fading + down);
    const double bell = std::exp(-0.5 * across * across / (width * width));
    const double bell_along = bell * across * across * width_along / (width * width * width);
    const double by_along = on_along * fade * bell + on * fade_along * bell + on * fade * bell_along;
    const double by_across = -on * fade * bell * across / (width * width);
    derivative[0] = by_along * wind.x + by_across * wind.y;
    derivative[1] = by_along * wind.y - by_across * wind.x;
    return on * fade * bell;
}

// What is lost in wakes, of the power of one turbine, and its gradient.
double lost_power(const std::vector<double> &x, std::vector<double> &gradient) {
    static const std::vector<Wind> rose = wind_rose();
    std::vector<double> slope(x.size());
    double lost = 0;
    for (const Wind &wind : rose) {
        for (std::size_t i = 0; i < x.size(); i += 2) {
            for (std::size_t j = 0; j < x.size(); j += 2) {
                double derivative[2];
                if (i == j)
                    continue;
                lost += wind.weight * wake(x[i] - x[j], x[i + 1] - x[j + 1], wind, derivative);
                for (int k = 0; k < 2; ++k) {
                    slope[i + k] += wind.weight * derivative[k];
                    slope[j + k] -= wind.weight * derivative[k];
                }
            }
        }
    }
    if (!gradient.empty())
        gradient = slope;
    return lost;
}

// Which constraints there are, and what Keepout said of a point that it refused.
struct Site {
    const ko_constraints *constraints;
    std::size_t n_values;
    std::string failure;
    int evaluations = 0;
};

double objective(const std::vector<double> &x, std::vector<double> &gradient, void *data) {
    ++static_cast<Site *>(data)->evaluations;
    return lost_power(x, gradient);
}

// NLopt wants c(x) <= 0, rows of the gradient a constraint. A point that Keepout refuses stops the optimiser: NLopt has no way back from it.
void on_site(unsigned m, double *c, unsigned n, const double *x, double *gradient, void *data) {
    Site &site = *static_cast<Site *>(data);
    std::int32_t status = ko_constraints_values(site.constraints, x, n, m, c);
    if (status >= 0 && gradient != nullptr)
        status = ko_constraints_dense_jacobian(site.constraints, x, n, m, gradient);
    if (status < 0) {
        site.failure = ko_last_error();
        throw nlopt::forced_stop();
    }
    for (unsigned i = 0; i < m; ++i)
        c[i] = setback - c[i];
    for (unsigned i = 0; gradient != nullptr && i < m * n; ++i)
        gradient[i] = -gradient[i];
}

// spacing^2 - |x_i - x_j|^2 <= 0 of all pairs.
void apart(unsigned m, double *c, unsigned n, const double *x, double *gradient, void *) {
    if (gradient != nullptr)
        std::fill_n(gradient, m * n, 0.0);
    for (unsigned i = 0; i < n; i += 2) {
        for (unsigned j = 0; j < i; j += 2, ++c) {
            const double dx = x[i] - x[j], dy = x[i + 1] - x[j + 1];
            *c = spacing * spacing - dx * dx - dy * dy;
            if (gradient == nullptr)
                continue;
            gradient[i] = -2 * dx;
            gradient[j] = 2 * dx;
            gradient[i + 1] = -2 * dy;
            gradient[j + 1] = 2 * dy;
            gradient += n;
        }
    }
}

// The gradient of the Lagrangian at x, its largest entry: NLopt gives no multipliers, so those of active constraints are made here, the best
// that are not negative, by cyclic descent along each.
double kkt_residual(const std::vector<double> &x, Site &site, std::size_t &n_active) {
    const unsigned n = static_cast<unsigned>(x.size()), n_pairs = n / 2 * (n / 2 - 1) / 2, m = static_cast<unsigned>(site.n_values);
    std::vector<double> residual(n), c(m + n_pairs), rows((m + n_pairs) * n), multipliers(m + n_pairs);
    lost_power(x, residual);
    on_site(m, c.data(), n, x.data(), rows.data(), &site);
    apart(n_pairs, &c[m], n, x.data(), &rows[m * n], nullptr);
    std::vector<unsigned> active;
    for (unsigned i = 0; i < c.size(); ++i)
        if (c[i] > -1e-6)
            active.push_back(i);
    n_active = active.size();
    for (int sweep = 0; sweep < 100000; ++sweep) {
        for (const unsigned i : active) {
            double product = 0, square = 0;
            for (unsigned k = 0; k < n; ++k) {
                product += rows[i * n + k] * residual[k];
                square += rows[i * n + k] * rows[i * n + k];
            }
            const double step = std::max(-product / square, -multipliers[i]);
            multipliers[i] += step;
            for (unsigned k = 0; k < n; ++k)
                residual[k] += step * rows[i * n + k];
        }
    }
    double largest = 0;
    for (const double entry : residual)
        largest = std::max(largest, std::fabs(entry));
    return largest;
}

void draw(const keepout::Mesh &site, const std::vector<double> &x, const char *path) {
    std::ofstream svg(path);
    svg << "<svg xmlns='http://www.w3.org/2000/svg' viewBox='-1.8 -1.5 3.6 3' width='900' height='750'>\n"
        << "<rect x='-1.8' y='-1.5' width='3.6' height='3' fill='#9ecae1'/>\n<path fill='#e5f0d0' stroke='#333' stroke-width='.008' d='";
    const keepout::Mesh::Curves curves = site.polylines();
    for (std::size_t i = 0; i < curves.points.size() / 2; ++i) {
        const bool first = std::find(curves.loop_starts.begin(), curves.loop_starts.end(), i) != curves.loop_starts.end();
        svg << (first ? "M" : "L") << curves.points[2 * i] << ' ' << -curves.points[2 * i + 1] << ' ';
    }
    svg << "'/>\n";
    for (std::size_t i = 0; i < x.size(); i += 2) {
        svg << "<circle cx='" << x[i] << "' cy='" << -x[i + 1] << "' r='" << spacing / 2 << "' fill='#3182bd' fill-opacity='.2'/>"
            << "<circle cx='" << x[i] << "' cy='" << -x[i + 1] << "' r='.025' fill='#a50f15'/>\n";
    }
    svg << "</svg>\n";
    std::printf(svg ? "Wrote %s\n" : "%s could not be written\n", path);
}

// A grid of turbines, some in the lake and some in the sea.
std::vector<double> make_start(bool broken) {
    std::vector<double> x;
    for (std::size_t i = 0; i < n_turbines; ++i) {
        x.push_back(-1.0 + 0.65 * (i % 4) + 0.07 * (i / 4));
        x.push_back(-0.7 + 0.7 * (i / 4) + 0.05 * (i % 4));
    }
    if (broken)
        x[6] = 1e152;
    return x;
}

int run(const char *argument) {
    const bool broken = argument != nullptr && std::string(argument) == "--broken-start";
    const keepout::Mesh mesh = make_site();
    keepout::FitOptions options;
    options.feasible = KO_FEASIBLE_INSIDE;
    const keepout::Field field = keepout::Field::fit(mesh.sample(4000, /*seed*/ 1), options);
    std::printf("The field misses the boundary by %.5f km at most\n", field.report().max * field.report().diagonal);

    ko_constraints *made = nullptr;
    check(ko_constraints_create(2, &made));
    const std::unique_ptr<ko_constraints, decltype(&ko_constraints_free)> constraints(made, ko_constraints_free);
    ko_aggregation none;
    check(ko_aggregation_init(&none, sizeof none));
    none.kind = KO_AGGREGATE_NONE;
    std::uint32_t turbines;
    check(ko_constraints_add_points(made, n_turbines, &turbines));
    check(ko_constraints_keep_points(made, turbines, field.get(), KO_WORLD, &none, nullptr));

    Site site{made, n_turbines, "", 0};
    std::vector<double> x = make_start(broken), no_gradient;
    nlopt::opt slsqp(nlopt::LD_SLSQP, static_cast<unsigned>(x.size()));
    slsqp.set_min_objective(objective, &site);
    slsqp.add_inequality_mconstraint(on_site, &site, std::vector<double>(n_turbines, 1e-9));
    slsqp.add_inequality_mconstraint(apart, nullptr, std::vector<double>(n_turbines * (n_turbines - 1) / 2, 1e-9));
    slsqp.set_xtol_rel(1e-10);
    slsqp.set_maxeval(2000);
    std::printf("Start:   %.6f of one turbine's power lost\n", lost_power(x, no_gradient));
    double lost;
    try {
        slsqp.optimize(x, lost);
    } catch (const nlopt::forced_stop &) {
        std::printf("NLopt was stopped; Keepout said: %s\n", site.failure.c_str());
        return 1;
    }

    std::size_t n_active;
    const double residual = kkt_residual(x, site, n_active);
    double clearance = 1, nearest = 10;
    for (const double distance : mesh.signed_distance(x))
        clearance = std::min(clearance, -distance);
    for (std::size_t i = 0; i < x.size(); i += 2)
        for (std::size_t j = 0; j < i; j += 2)
            nearest = std::min(nearest, std::hypot(x[i] - x[j], x[i + 1] - x[j + 1]));
    std::printf("Optimum: %.6f, after %d evaluations\n", lost, site.evaluations);
    std::printf("KKT residual %.1e, %zu active constraints\n", residual, n_active);
    std::printf("Exactly %.5f km from the boundary, %.5f km from each other, at least\n", clearance, nearest);
    if (argument != nullptr && !broken)
        draw(mesh, x, argument);
    // SLSQP tells costs apart to some 1e-15, so turbines are where they are to some 1e-8, and the curvature of wakes is in the hundreds.
    const bool ok = residual < 1e-4 && clearance > 0 && nearest > spacing - 1e-6;
    std::printf(ok ? "An optimum on the site.\n" : "NOT an optimum on the site.\n");
    return ok ? 0 : 1;
}

} // namespace

int main(int argc, char **argv) {
    try {
        return run(argc > 1 ? argv[1] : nullptr);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "keepout_site: %s\n", error.what());
        return 1;
    }
}
