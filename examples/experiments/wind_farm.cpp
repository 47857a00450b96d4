// SPDX-License-Identifier: Apache-2.0 OR MIT
// A wind farm in the Borssele IIIa boundary: 25 turbines of 10 MW, placed by IPOPT so that as little energy as may be is lost in each
// other's wakes, all of them in the boundary, none nearer to another than two rotor diameters. The field's certificate proves that turbines
// are in the boundary, and exact distances to the polygon check it.
//
//   keepout_wind_farm DATA [PICTURE.svg]
#include "problem.hpp"

#include <fstream>

namespace {

constexpr int n_turbines = 25;
constexpr double rotor = 0.198;     // km, its diameter D
constexpr double spacing = 2 * rotor;
constexpr double wind_speed = 9.8, cut_in = 4, rated = 11; // m/s
constexpr double rated_power = 10;  // MW
constexpr int n_winds = 36;
constexpr double pi = 3.14159265358979323846;

// A function of (dx, dy) with its derivatives.
struct Jet {
    double v, x, y, xx, xy, yy;
};

Jet operator+(const Jet &a, const Jet &b) { return {a.v + b.v, a.x + b.x, a.y + b.y, a.xx + b.xx, a.xy + b.xy, a.yy + b.yy}; }

Jet operator*(double s, const Jet &a) { return {s * a.v, s * a.x, s * a.y, s * a.xx, s * a.xy, s * a.yy}; }

Jet operator*(const Jet &a, const Jet &b) {
    return {a.v * b.v,
            a.x * b.v + a.v * b.x,
            a.y * b.v + a.v * b.y,
            a.xx * b.v + 2 * a.x * b.x + a.v * b.xx,
            a.xy * b.v + a.x * b.y + a.y * b.x + a.v * b.xy,
            a.yy * b.v + 2 * a.y * b.y + a.v * b.yy};
}

Jet constant(double s) { return {s, 0, 0, 0, 0, 0}; }

// f(a), of a function with the value f, the slope f_1 and the second derivative f_2 at a.
Jet chain(const Jet &a, double f, double f_1, double f_2) {
    return {f, f_1 * a.x, f_1 * a.y, f_2 * a.x * a.x + f_1 * a.xx, f_2 * a.x * a.y + f_1 * a.xy, f_2 * a.y * a.y + f_1 * a.yy};
}

// Where the wind blows to, and how often.
struct Wind {
    double x, y, weight;
};

std::vector<Wind> wind_rose() {
    std::vector<Wind> rose;
    for (int k = 0; k < n_winds; ++k) {
        const double to = 2 * pi * k / n_winds, off = to - pi / 6; // mostly from the west-south-west
        rose.push_back({std::cos(to), std::sin(to), (1 + 0.5 * std::cos(off) + 0.2 * std::cos(2 * off)) / n_winds});
    }
    return rose;
}

// The square of the part of the wind that is lost at (dx, dy) from a turbine: Bastankhah and Porte-Agel's Gaussian wake as IEA Task 37 has
// simplified it, thrust coefficient 8/9, widening by 0.0324555. It begins at the rotor as a step; here it sets in along a quarter of D, so
// that it is smooth.
Jet squared_deficit(double dx, double dy, const Wind &wind) {
    constexpr double thrust = 8.0 / 9, widening = 0.0324555, onset = rotor / 4;
    const Jet along = {dx * wind.x + dy * wind.y, wind.x, wind.y, 0, 0, 0}, across = {dx * wind.y - dy * wind.x, wind.y, -wind.x, 0, 0, 0};
    const double s = 1 / (1 + std::exp(-along.v / onset)), s_1 = s * (1 - s) / onset, s_2 = s_1 * (1 - 2 * s) / onset;
    const Jet on = chain(along, s, s_1, s_2);
    const double softplus = std::max(along.v, 0.0) + onset * std::log1p(std::exp(-std::fabs(along.v) / onset));
    const Jet sigma = widening * chain(along, softplus, s, s_1) + constant(rotor / std::sqrt(8.0));
    const double w = 1 / (sigma.v * sigma.v);
    const Jet inverse = chain(sigma, w, -2 * w / sigma.v, 6 * w * w); // 1 / sigma^2
    const Jet radical = constant(1) + (-thrust * rotor * rotor / 8) * inverse;
    const double root = std::sqrt(radical.v);
    const Jet depth = constant(1) + -1.0 * chain(radical, root, 0.5 / root, -0.25 / (root * radical.v));
    const Jet exponent = -1.0 * across * across * inverse; // of the square of the bell
    const double bell = std::exp(exponent.v);
    return on * on * depth * depth * chain(exponent, bell, bell, bell);
}

// What is lost, in powers of a turbine that stands alone, and its derivatives: gradient [n] and hessian, the lower triangle row by row.
double lost_power(const double *x, double *gradient, double *hessian) {
    static const std::vector<Wind> rose = wind_rose();
    constexpr int n = 2 * n_turbines;
    constexpr double soft = 0.02, steepness = wind_speed / (wind_speed - cut_in);
    if (gradient != nullptr)
        std::fill_n(gradient, n, 0.0);
    if (hessian != nullptr)
        std::fill_n(hessian, n * (n + 1) / 2, 0.0);
    double lost = 0;
    std::vector<Jet> jets(n_turbines);
    std::vector<double> slope(n);
    for (const Wind &wind : rose) {
        for (int i = 0; i < n_turbines; ++i) {
            // Wakes add up by squares, rounded off where there is none; power grows as the cube of what the wind is above cut-in.
            double sum = 0;
            std::fill(slope.begin(), slope.end(), 0.0);
            for (int j = 0; j < n_turbines; ++j) {
                if (j == i)
                    continue;
                jets[j] = squared_deficit(x[2 * i] - x[2 * j], x[2 * i + 1] - x[2 * j + 1], wind);
                sum += jets[j].v;
                slope[2 * i] += jets[j].x;
                slope[2 * i + 1] += jets[j].y;
                slope[2 * j] -= jets[j].x;
                slope[2 * j + 1] -= jets[j].y;
            }
            const double root = std::sqrt(sum + soft * soft), u = std::max(1 - steepness * (root - soft), 0.0);
            const double u_1 = -0.5 * steepness / root, u_2 = 0.25 * steepness / (root * root * root);
            const double f_1 = -wind.weight * 3 * u * u * u_1, f_2 = -wind.weight * (6 * u * u_1 * u_1 + 3 * u * u * u_2);
            lost += wind.weight * (1 - u * u * u);
            for (int k = 0; gradient != nullptr && k < n; ++k)
                gradient[k] += f_1 * slope[k];
            if (hessian == nullptr)
                continue;
            for (int k = 0; k < n; ++k)
                for (int l = 0; slope[k] != 0 && l <= k; ++l)
                    hessian[k * (k + 1) / 2 + l] += f_2 * slope[k] * slope[l];
            for (int j = 0; j < n_turbines; ++j) {
                if (j == i)
                    continue;
                const double block[2][2] = {{jets[j].xx, jets[j].xy}, {jets[j].xy, jets[j].yy}};
                for (int k = 0; k < 2; ++k) {
                    for (int l = 0; l < 2; ++l) {
                        const int ik = 2 * i + k, il = 2 * i + l, jk = 2 * j + k, jl = 2 * j + l;
                        if (l <= k) {
                            hessian[ik * (ik + 1) / 2 + il] += f_1 * block[k][l];
                            hessian[jk * (jk + 1) / 2 + jl] += f_1 * block[k][l];
                        }
                        const int high = i > j ? ik : jk, low = i > j ? jl : il;
                        hessian[high * (high + 1) / 2 + low] -= f_1 * block[k][l];
                    }
                }
            }
        }
    }
    return lost;
}

// The turbines' places are the variables; own values are the squares of their distances.
class WindFarm : public Problem {
public:
    WindFarm(const keepout::Constraints &kept, double least, const std::vector<double> &start)
        : Problem(kept, std::vector<double>(n_turbines, least), start) {
        for (Index i = 0; i < n_turbines; ++i) {
            for (Index j = 0; j < i; ++j) {
                const Index row = i * (i - 1) / 2 + j;
                add_own_value(spacing * spacing, unbounded);
                for (const Index column : {2 * i, 2 * i + 1, 2 * j, 2 * j + 1})
                    own_jacobian_.push_back({row, column});
            }
        }
        for (Index k = 0; k < 2 * n_turbines; ++k)
            for (Index l = 0; l <= k; ++l)
                own_hessian_.push_back({k, l});
    }

    double objective_at(const double *x, double *gradient) const override { return lost_power(x, gradient, nullptr); }

    void own_values(const double *x, double *g) const override {
        for (int i = 0; i < n_turbines; ++i)
            for (int j = 0; j < i; ++j)
                *g++ = square(x[2 * i] - x[2 * j]) + square(x[2 * i + 1] - x[2 * j + 1]);
    }

    void own_jacobian(const double *x, double *entries) const override {
        for (int i = 0; i < n_turbines; ++i) {
            for (int j = 0; j < i; ++j) {
                const double dx = 2 * (x[2 * i] - x[2 * j]), dy = 2 * (x[2 * i + 1] - x[2 * j + 1]);
                for (const double entry : {dx, dy, -dx, -dy})
                    *entries++ = entry;
            }
        }
    }

    void own_hessian(const double *x, double factor, const double *lambda, double *entries) const override {
        lost_power(x, slope_.data(), entries);
        for (std::size_t k = 0; k < own_hessian_.size(); ++k)
            entries[k] *= factor;
        const auto at = [&](int k, int l) -> double & { return entries[k * (k + 1) / 2 + l]; };
        for (int i = 0; i < n_turbines; ++i) {
            for (int j = 0; j < i; ++j, ++lambda) {
                for (int k = 0; k < 2; ++k) {
                    at(2 * i + k, 2 * i + k) += 2 * *lambda;
                    at(2 * j + k, 2 * j + k) += 2 * *lambda;
                    at(2 * i + k, 2 * j + k) -= 2 * *lambda;
                }
            }
        }
    }

private:
    static double square(double s) { return s * s; }

    mutable std::vector<double> slope_ = std::vector<double>(2 * n_turbines);
};

// The corners of the boundary, counter-clockwise, in km.
keepout::Mesh read_boundary(const std::string &path) {
    std::ifstream file(path);
    std::vector<double> corners;
    for (std::string line; std::getline(file, line);) {
        double x, y;
        if (std::sscanf(line.c_str(), " - [ %lf , %lf ]", &x, &y) == 2)
            corners.insert(corners.end(), {1e-3 * x, 1e-3 * y});
    }
    const std::size_t n = corners.size() / 2;
    if (n < 3)
        throw std::runtime_error(path + " has no boundary");
    double area = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t j = (i + 1) % n;
        area += 0.5 * (corners[2 * i] * corners[2 * j + 1] - corners[2 * j] * corners[2 * i + 1]);
    }
    if (area < 0)
        for (std::size_t i = 0; i < n / 2; ++i)
            std::swap_ranges(&corners[2 * i], &corners[2 * i] + 2, &corners[2 * (n - 1 - i)]);
    std::printf("Borssele IIIa: %zu corners, %.2f km^2\n", n, std::fabs(area));
    return keepout::Mesh::from_polylines(corners, std::vector<std::size_t>{0});
}

// Five rows of five over the bounding box, skewed a little, since rows along the wind are a saddle: many of them are out at sea.
std::vector<double> make_start(const ko_mesh_report &site) {
    std::vector<double> x;
    for (int i = 0; i < n_turbines; ++i) {
        const double to[2] = {(i % 5 + 0.5) / 5 + 0.02 * (i / 5 - 2), (i / 5 + 0.5) / 5 + 0.02 * (i % 5 - 2)};
        for (int k = 0; k < 2; ++k)
            x.push_back(site.bounds_min[k] + to[k] * (site.bounds_max[k] - site.bounds_min[k]));
    }
    return x;
}

double exact_clearance(const keepout::Mesh &site, const std::vector<double> &x) {
    const std::vector<double> distances = site.signed_distance(x);
    return -*std::max_element(distances.begin(), distances.end());
}

double nearest_pair(const std::vector<double> &x) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < x.size(); i += 2)
        for (std::size_t j = 0; j < i; j += 2)
            nearest = std::min(nearest, std::hypot(x[i] - x[j], x[i + 1] - x[j + 1]));
    return nearest;
}

// The site, where turbines started, and where they are, with half their spacing around them.
void draw(const keepout::Mesh &site, const std::vector<double> &start, const std::vector<double> &x, const std::string &path) {
    const ko_mesh_report box = site.report();
    const double width = box.bounds_max[0] - box.bounds_min[0] + 0.6, height = box.bounds_max[1] - box.bounds_min[1] + 0.6;
    std::ofstream svg(path);
    svg << "<svg xmlns='http://www.w3.org/2000/svg' width='" << 120 * width << "' height='" << 120 * height << "' viewBox='"
        << box.bounds_min[0] - 0.3 << ' ' << -box.bounds_max[1] - 0.3 << ' ' << width << ' ' << height << "'>\n"
        << "<rect x='" << box.bounds_min[0] - 0.3 << "' y='" << -box.bounds_max[1] - 0.3 << "' width='" << width << "' height='" << height
        << "' fill='#fff'/>\n<path fill='#deebf7' stroke='#08519c' stroke-width='.02' d='";
    const std::vector<double> corners = site.polylines().points;
    for (std::size_t i = 0; i < corners.size(); i += 2)
        svg << (i == 0 ? "M" : "L") << corners[i] << ' ' << -corners[i + 1];
    svg << "z'/>\n";
    for (std::size_t i = 0; i < x.size(); i += 2) {
        svg << "<path stroke='#bbb' stroke-width='.015' d='M" << start[i] << ' ' << -start[i + 1] << 'L' << x[i] << ' ' << -x[i + 1]
            << "'/><circle cx='" << start[i] << "' cy='" << -start[i + 1] << "' r='.03' fill='#bbb'/>\n";
    }
    for (std::size_t i = 0; i < x.size(); i += 2) {
        svg << "<circle cx='" << x[i] << "' cy='" << -x[i + 1] << "' r='" << spacing / 2 << "' fill='#3182bd' fill-opacity='.25'/>"
            << "<circle cx='" << x[i] << "' cy='" << -x[i + 1] << "' r='.05' fill='#a50f15'/>\n";
    }
    svg << "</svg>\n";
    std::printf(svg ? "Wrote %s\n" : "%s could not be written\n", path.c_str());
}

int run(const Arguments &arguments) {
    const keepout::Mesh site = read_boundary(arguments.data + "/curves2d/iea37-boundary-cs3.yaml");
    Outcome outcome;
    outcome.name = "wind farm";
    outcome.unit = "km";

    // Not refined: the boundary ends in a splinter, 10 m long and less than 1 m wide, and phi as fine as that may have a top within it,
    // where no room is for a turbine and IPOPT gets stuck.
    const keepout::Field field = fit("the boundary", site, 20000, fit_options(KO_FEASIBLE_INSIDE), outcome);

    // Where phi is above the threshold a turbine is in the boundary, whatever the field's error.
    keepout::CertifyOptions certify_options;
    certify_options.n_threads = 1;
    const ko_certificate certificate = field.certify(site, /*clearance*/ 0, /*covering radius*/ 0, certify_options);
    std::printf("Certified: phi above %.5f km is in the boundary\n", certificate.threshold);

    keepout::Constraints kept = keepout::Constraints::create(2);
    keepout::Aggregation none;
    none.kind = KO_AGGREGATE_NONE;
    kept.keep_points(kept.add_points(n_turbines), field, KO_WORLD, none);
    const std::vector<double> start = make_start(site.report());
    const Ipopt::SmartPtr<Problem> problem = new WindFarm(kept, certificate.threshold * 1.001, start);

    // A year of a turbine that stands alone, in GWh.
    const double year = rated_power * std::pow((wind_speed - cut_in) / (rated - cut_in), 3) * 8760 / 1000;
    const auto energy = [&](double lost) { return year * (n_turbines - lost); };
    outcome.start = exact_clearance(site, start);
    std::printf("Start: %.2f GWh a year, %.4f km from the boundary, %.4f km from each other\n",
                energy(lost_power(start.data(), nullptr, nullptr)), outcome.start, nearest_pair(start));
    solve(problem, /*unit*/ 1, outcome);

    const std::vector<double> &x = problem->x, values = kept.values(x);
    outcome.field = *std::min_element(values.begin(), values.end());
    outcome.exact = exact_clearance(site, x);
    const double lost = lost_power(x.data(), nullptr, nullptr), nearest = nearest_pair(x);
    std::printf("End:   %.2f GWh a year, of %.2f without wakes; %.4f km from each other, %.4f wanted\n", energy(lost), energy(0), nearest,
                spacing);
    if (!arguments.picture.empty())
        draw(site, start, x, arguments.picture);
    outcome.solved = outcome.solved && nearest > spacing * (1 - 1e-6);
    return report(outcome) ? 0 : 1;
}

} // namespace

int main(int argc, char **argv) {
    try {
        return run(Arguments(argc, argv, "curves2d/iea37-boundary-cs3.yaml"));
    } catch (const std::exception &error) {
        std::fprintf(stderr, "keepout_wind_farm: %s\n", error.what());
        return 1;
    }
}
