// SPDX-License-Identifier: Apache-2.0 OR MIT
// A wing and the battery in it, shaped together: drag as small as may be, of a wing that a box of given volume fits into. Variables are the
// wing's span, chords and thicknesses, and the box's place, angles and edges. For each wing IPOPT tries, the field is refitted by
// KO_REWEIGHT_KEEP; one smooth value, KS of phi at samples of the box, keeps the box inside. Its derivatives by the box are those of
// Keepout's constraints, those by the wing go from the adjoint of the fit to the cloud, to the mesh's vertices, to the wing's variables.
// It begins with a box that sticks out of the wing; the end is checked by the wing's triangles.
//
//   keepout_wing DATA [PICTURE.svg]     (it makes its shapes itself: nothing of DATA is read)
#include "picture.hpp"
#include "problem.hpp"

#include <optional>

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double mm = 1000; // of metres

// What the wing is for.
constexpr double weight = 6000;        // N, what it carries
constexpr double pressure = 1240;      // Pa, of the air stream
constexpr double friction = 0.0045;    // of a turbulent boundary layer, by area
constexpr double area_needed = 9;      // m^2, of both halves
constexpr double volume_needed = 0.12; // m^3, of the battery in each half
constexpr double wanted = 0.010;       // m, from the battery to the skin
constexpr double least = 0.005;        // m, of KS, which lies some 6 mm below the least phi here: 11 are left of it
constexpr double newtons = 100;        // of drag's unit: it is of the order of 1

// The variables: those of the wing, then those of the battery.
enum : int { span, chord, thickness = 4, n_wing = 7, place = n_wing, angle = 10, edge = 13, n_all = 16 };
using Numbers = std::array<double, n_all>;

// Half-span in m; chords at root, middle, tip in m; thicknesses there in tenths of the chord. The battery's middle in m; yaw, roll and
// pitch in radians; its edges along the chord, the span and upwards in m.
constexpr Numbers first = {3.8, 1.5, 1.25, 0.7, 1.4, 1.5, 1.4, 0.3, 1.2, 0.03, 0, 0, 0, 0.5, 1.4, 0.2};
constexpr Numbers lowest = {2.5, 0.6, 0.6, 0.6, 1.1, 1.1, 1.1, -1, 0, -0.3, -1, -1, -1, 0.1, 0.1, 0.03};
constexpr Numbers highest = {4, 3, 3, 3, 2, 2, 2, 2, 5, 0.5, 1, 1, 1, 2, 5, 0.5};
// How far a wing's variable may be from where the field was fitted: further on it is fitted anew.
constexpr std::array<double, n_wing> reach = {0.2, 0.1, 0.1, 0.1, 0.15, 0.15, 0.15};

// Of the three that a chord or a thickness is given by: parabolas that are 1 at one of root, middle and tip.
std::array<double, 3> parabolas(double eta) { return {(1 - eta) * (1 - 2 * eta), 4 * eta * (1 - eta), eta * (2 * eta - 1)}; }

double along(const std::array<double, 3> &l, const double *of) { return l[0] * of[0] + l[1] * of[1] + l[2] * of[2]; }

// Half a wing lofted over NACA's four-digit sections with 2 % of camber: swept, twisted and raised by angles that do not change, closed by
// flat ends at root and tip. x is downstream, y along the span, z up.
class Loft {
public:
    Loft() {
        for (std::uint32_t m = 0; m < stations; ++m)
            for (std::uint32_t j = 0; j < around; ++j) {
                const std::uint32_t a = m * around + j, b = m * around + (j + 1) % around;
                add(a, b, b + around);
                add(a, b + around, a + around);
            }
        // Of each end, between what is above and what is below; vertex 0 is the trailing edge, around / 2 the leading edge.
        for (std::uint32_t j = 0; j < around / 2; ++j) {
            const std::uint32_t quad[4] = {j, (around - j) % around, around - j - 1, j + 1}, tip = stations * around;
            if (quad[0] != quad[1]) {
                add(quad[0], quad[1], quad[2]);
                add(tip + quad[0], tip + quad[2], tip + quad[1]);
            }
            if (quad[2] != quad[3]) {
                add(quad[0], quad[2], quad[3]);
                add(tip + quad[0], tip + quad[3], tip + quad[2]);
            }
        }
    }

    // The mesh of a wing, wing [n_wing].
    keepout::Mesh mesh(const double *wing) const {
        std::vector<double> vertices;
        each_vertex(wing, [&](const Vertex &v) {
            vertices.insert(vertices.end(), {v.x + v.chord * v.back, v.y, v.z + v.chord * v.up});
        });
        return keepout::Mesh::from_triangles(vertices, triangles_);
    }

    // Derivatives by the vertices, [3 * n_vertices], back to those by the wing's variables, which are added to d_wing [n_wing].
    void pull_back(const double *wing, const std::vector<double> &d_vertices, double *d_wing) const {
        const double *d = d_vertices.data();
        each_vertex(wing, [&](const Vertex &v) {
            d_wing[span] += v.eta * (d[0] * std::tan(sweep) + d[1] + d[2] * std::tan(dihedral));
            const std::array<double, 3> l = parabolas(v.eta);
            for (int i = 0; i < 3; ++i) {
                d_wing[chord + i] += l[i] * (d[0] * v.back + d[2] * v.up);
                d_wing[thickness + i] += l[i] * v.chord * v.half * (d[0] * std::sin(v.twist) + d[2] * std::cos(v.twist));
            }
            d += 3;
        });
    }

private:
    static constexpr double sweep = 8 * pi / 180, dihedral = 2 * pi / 180, washout = 2 * pi / 180;
    static constexpr std::uint32_t stations = 40, around = 96;

    // x, y, z is a point of the line of quarter chords; the vertex is `back` and `up` chords from it, `half` what a unit of thickness adds
    // to its height above the chord.
    struct Vertex {
        double eta, twist, x, y, z, chord, back, up, half;
    };

    template <class Take>
    void each_vertex(const double *wing, const Take &take) const {
        for (std::uint32_t m = 0; m <= stations; ++m) {
            Vertex v{};
            v.eta = static_cast<double>(m) / stations;
            const std::array<double, 3> l = parabolas(v.eta);
            v.chord = along(l, wing + chord);
            v.twist = -washout * v.eta;
            v.y = v.eta * wing[span];
            v.x = v.y * std::tan(sweep);
            v.z = v.y * std::tan(dihedral);
            for (std::uint32_t j = 0; j < around; ++j) {
                const double turn = 2 * pi * j / around, xi = 0.5 * (1 + std::cos(turn)), root = std::fabs(std::cos(0.5 * turn));
                v.half = 0.1 * 5 * (0.2969 * root + xi * (-0.1260 + xi * (-0.3516 + xi * (0.2843 - 0.1036 * xi))));
                v.half *= j == 0 ? 0 : 2 * j < around ? 1 : -1;
                const double camber = xi < 0.4 ? 0.02 / 0.16 * xi * (0.8 - xi) : 0.02 / 0.36 * (0.2 + 0.8 * xi - xi * xi);
                const double u = xi - 0.25, w = camber + v.half * along(l, wing + thickness);
                v.back = u * std::cos(v.twist) + w * std::sin(v.twist);
                v.up = w * std::cos(v.twist) - u * std::sin(v.twist);
                take(v);
            }
        }
    }

    void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) { triangles_.insert(triangles_.end(), {a, c, b}); }

    std::vector<std::uint32_t> triangles_;
};

// Drag of both halves in units of 100 N: friction, more of it on thick sections (Hoerner's 1 + 2 t + 60 t^4), and what lift takes, with
// lift along the span as the chords are, of which the first four harmonics count. A measure of drag's kind. Adds to gradient [n_all] if
// that is not null.
double drag(const double *x, double *gradient) {
    double total = 0;
    constexpr int n = 40, n_harmonics = 4;
    for (int k = 0; k <= n; ++k) {
        const double eta = static_cast<double>(k) / n, simpson = (k == 0 || k == n ? 1 : k % 2 == 1 ? 4 : 2) / (3.0 * n);
        const std::array<double, 3> l = parabolas(eta);
        const double c = along(l, x + chord), t = 0.1 * along(l, x + thickness), form = 1 + 2 * t + 60 * t * t * t * t;
        const double of = simpson * 4 * pressure * friction / newtons; // two sides of two halves
        total += of * x[span] * c * form;
        if (gradient == nullptr)
            continue;
        gradient[span] += of * c * form;
        for (int i = 0; i < 3; ++i) {
            gradient[chord + i] += of * x[span] * l[i] * form;
            gradient[thickness + i] += of * x[span] * c * 0.1 * l[i] * (2 + 240 * t * t * t);
        }
    }
    // A_n = 4 / pi times the integral of the chord at eta = cos(theta) by sin(n theta), up to a factor that all have.
    double a[n_harmonics] = {}, d_a[n_harmonics][3] = {}, sum = 0;
    for (int h = 0; h < n_harmonics; ++h) {
        for (int k = 0; k < 400; ++k) {
            const double theta = 0.5 * pi * (k + 0.5) / 400, sine = std::sin((2 * h + 1) * theta);
            const std::array<double, 3> l = parabolas(std::cos(theta));
            for (int i = 0; i < 3; ++i)
                d_a[h][i] += l[i] * sine / 400;
        }
        a[h] = d_a[h][0] * x[chord] + d_a[h][1] * x[chord + 1] + d_a[h][2] * x[chord + 2];
        sum += (2 * h + 1) * a[h] * a[h];
    }
    const double best = weight * weight / (pressure * pi * 4 * x[span] * x[span]) / newtons, induced = best * sum / (a[0] * a[0]);
    if (gradient != nullptr) {
        gradient[span] -= 2 * induced / x[span];
        for (int i = 0; i < 3; ++i) {
            for (int h = 0; h < n_harmonics; ++h)
                gradient[chord + i] += best * 2 * (2 * h + 1) * a[h] * d_a[h][i] / (a[0] * a[0]);
            gradient[chord + i] -= 2 * induced / a[0] * d_a[0][i];
        }
    }
    return total + induced;
}

using Matrix = std::array<double, 9>;

Matrix times(const Matrix &a, const Matrix &b) {
    Matrix product{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k)
                product[3 * i + j] += a[3 * i + k] * b[3 * k + j];
    return product;
}

// Yaw, roll or pitch: a turn around the axis z, x or y; or its derivative by the angle.
Matrix turn(int axis, double by, bool derivative) {
    const double c = derivative ? -std::sin(by) : std::cos(by), s = derivative ? std::cos(by) : std::sin(by);
    Matrix r{};
    r[4 * axis] = derivative ? 0 : 1;
    const int j = (axis + 1) % 3, k = (axis + 2) % 3;
    r[4 * j] = r[4 * k] = c;
    r[3 * j + k] = -s;
    r[3 * k + j] = s;
    return r;
}

// R of the three angles, or its derivative by one of them.
Matrix rotation(const double *angles, int by = -1) {
    return times(times(turn(2, angles[0], by == 0), turn(0, angles[1], by == 1)), turn(1, angles[2], by == 2));
}

Vector turned(const Matrix &r, const Vector &v) {
    return {r[0] * v[0] + r[1] * v[1] + r[2] * v[2], r[3] * v[0] + r[4] * v[1] + r[5] * v[2], r[6] * v[0] + r[7] * v[1] + r[8] * v[2]};
}

// The box [-1, 1]^3 as a grid on its faces, with `cells` cells along each edge.
struct Box {
    std::vector<double> points;
    std::vector<std::uint32_t> triangles;

    explicit Box(const std::array<int, 3> &cells) {
        for (int axis = 0; axis < 3; ++axis)
            for (int side = -1; side <= 1; side += 2) {
                const int j = (axis + 1) % 3, k = (axis + 2) % 3, n = cells[k] + 1;
                const auto begin = static_cast<std::uint32_t>(points.size() / 3);
                for (int a = 0; a <= cells[j]; ++a)
                    for (int b = 0; b <= cells[k]; ++b) {
                        double at[3];
                        at[axis] = side;
                        at[j] = 2.0 * a / cells[j] - 1;
                        at[k] = 2.0 * b / cells[k] - 1;
                        points.insert(points.end(), at, at + 3);
                        if (a == 0 || b == 0)
                            continue;
                        const std::uint32_t v = begin + a * n + b, quad[4] = {v - n - 1, v - 1, v, v - n};
                        for (const int corner : side > 0 ? std::array<int, 6>{0, 1, 2, 0, 2, 3} : std::array<int, 6>{0, 2, 1, 0, 3, 2})
                            triangles.push_back(quad[corner]);
                    }
            }
    }

    // Its points in the world, as the battery's variables of x [n_all] say.
    std::vector<double> placed(const double *x) const {
        const Matrix r = rotation(x + angle);
        std::vector<double> world;
        for (std::size_t i = 0; i < points.size(); i += 3) {
            const Vector v = turned(r, half_of(x, i));
            world.insert(world.end(), {x[place] + v[0], x[place + 1] + v[1], x[place + 2] + v[2]});
        }
        return world;
    }

    // Derivatives by the placed points back to those by the battery's variables, which are added to gradient [n_all].
    void pull_back(const double *x, const std::vector<double> &d_points, double *gradient) const {
        const Matrix r = rotation(x + angle);
        for (std::size_t i = 0; i < points.size(); i += 3) {
            const Vector d = {d_points[i], d_points[i + 1], d_points[i + 2]}, half = half_of(x, i);
            for (int k = 0; k < 3; ++k) {
                gradient[place + k] += d[k];
                gradient[angle + k] += dot(d, turned(rotation(x + angle, k), half));
                gradient[edge + k] += 0.5 * points[i + k] * (d[0] * r[k] + d[1] * r[3 + k] + d[2] * r[6 + k]);
            }
        }
    }

private:
    Vector half_of(const double *x, std::size_t i) const {
        return {0.5 * x[edge] * points[i], 0.5 * x[edge + 1] * points[i + 1], 0.5 * x[edge + 2] * points[i + 2]};
    }
};

// What refits and adjoints took, and how many there were.
struct Work {
    int refits = 0, adjoints = 0;
    double seconds_refits = 0, seconds_adjoints = 0;
};

// KS of phi at the box's samples in the field of the wing, for wings near the one that the field was fitted to.
class Inside {
public:
    Inside(const Loft &loft, const Box &box, const double *wing, Outcome &outcome, Work &work)
        : loft_(loft), box_(box), work_(work), keep_(keep_options()),
          sampled_(loft.mesh(wing).sample(n_samples, /*seed*/ 1)), // as fit does
          fitted_(fit("the wing", loft.mesh(wing), n_samples, wing_options(), outcome)) {
        sharp_.sharpness = 2000;
    }

    // At x [n_all]; adds to the gradient [n_all] if that is not null.
    double value(const double *x, double *gradient) {
        if (!std::equal(x, x + n_wing, wing_.begin()) || !field_)
            refit(x);
        const std::vector<double> world = box_.placed(x);
        keepout::Constraints kept = keepout::Constraints::create(3);
        kept.keep_points(kept.add_points(world.size() / 3), *field_, KO_WORLD, sharp_);
        const double value = kept.values(world)[0];
        if (gradient == nullptr)
            return value;
        box_.pull_back(x, kept.dense_jacobian(world), gradient);

        // By the wing: KS moves as the sum of phi at the samples does, with weights that are its derivatives by these.
        const double begin = processor_seconds();
        const std::vector<double> phi = field_->values(world);
        std::vector<double> weights(phi.size()), d_points(3 * n_samples), d_normals(3 * n_samples), d_vertices(3 * mesh_->n_vertices());
        keepout::aggregate(sharp_, KO_LEAST, field_->report().diagonal, phi, weights);
        if (!adjoint_)
            adjoint_.emplace(keepout::Sensitivity::create(*field_, *cloud_, keep_));
        adjoint_->solve(world, weights, d_points, d_normals);
        cloud_->pull_back(*mesh_, d_points, d_normals, d_vertices);
        loft_.pull_back(x, d_vertices, gradient);
        ++work_.adjoints;
        work_.seconds_adjoints += processor_seconds() - begin;
        return value;
    }

private:
    static constexpr std::size_t n_samples = 2500;

    static keepout::FitOptions wing_options() {
        keepout::FitOptions options = fit_options(KO_FEASIBLE_INSIDE);
        const std::uint32_t cells[3] = {22, 9, 6}; // the longest along the span, where the shape changes least
        for (int axis = 0; axis < 3; ++axis)
            options.control_points[axis] = cells[axis] + 3;
        options.margin = 0.2; // the wing moves within the box
        options.reweightings = 1;
        return options;
    }

    // Solved so far that values are smooth and derivatives theirs.
    static keepout::FitOptions keep_options() {
        keepout::FitOptions options = wing_options();
        options.reweighting = KO_REWEIGHT_KEEP;
        options.tolerance = 1e-10;
        options.max_iterations = 100000;
        return options;
    }

    void refit(const double *x) {
        const double begin = processor_seconds();
        mesh_.emplace(loft_.mesh(x));
        cloud_.emplace(sampled_.follow(*mesh_));
        field_.emplace(fitted_.refit(*cloud_, keep_)); // always from there, so that it depends on the wing alone
        adjoint_.reset();
        std::copy_n(x, n_wing, wing_.begin());
        ++work_.refits;
        work_.seconds_refits += processor_seconds() - begin;
    }

    const Loft &loft_;
    const Box &box_;
    Work &work_;
    keepout::FitOptions keep_;
    keepout::Aggregation sharp_;
    keepout::Cloud sampled_;
    keepout::Field fitted_;
    // Of the wing that was looked at last:
    std::array<double, n_wing> wing_{};
    std::optional<keepout::Mesh> mesh_;
    std::optional<keepout::Cloud> cloud_;
    std::optional<keepout::Field> field_;
    std::optional<keepout::Sensitivity> adjoint_;
};

// For IPOPT: drag, over the values KS of phi, the battery's volume and the wing's area.
class WingProblem : public Ipopt::TNLP {
public:
    using Index = Ipopt::Index;
    using Number = Ipopt::Number;

    WingProblem(Inside &inside, const Numbers &start) : x(start), inside_(inside), lower_(lowest), upper_(highest) {
        for (int k = 0; k < n_wing; ++k) {
            lower_[k] = std::max(lowest[k], start[k] - reach[k]);
            upper_[k] = std::min(highest[k], start[k] + reach[k]);
        }
    }

    static constexpr int n_values = 3;
    static constexpr double bounds[n_values] = {least, volume_needed, area_needed};

    Numbers x; // the start, then the optimum
    int iterations = 0;
    double kkt = std::numeric_limits<double>::infinity();
    std::string failure;

    // Whether a wing's variable at x is kept by the reach from where it would go, rather than by its limits.
    bool held_by_reach() const {
        for (int k = 0; k < n_wing; ++k) {
            const double near = 0.01 * reach[k];
            if ((lower_[k] > lowest[k] && x[k] - lower_[k] < near) || (upper_[k] < highest[k] && upper_[k] - x[k] < near))
                return true;
        }
        return false;
    }

    // The values, and their Jacobian [n_values * n_all] if that is not null.
    void values(const double *at, double *g, double *jacobian) {
        if (jacobian != nullptr)
            std::fill_n(jacobian, n_values * n_all, 0.0);
        g[0] = inside_.value(at, jacobian);
        g[1] = at[edge] * at[edge + 1] * at[edge + 2];
        const double of[3] = {1.0 / 3, 4.0 / 3, 1.0 / 3}; // of both halves
        const double mean = of[0] * at[chord] + of[1] * at[chord + 1] + of[2] * at[chord + 2];
        g[2] = at[span] * mean;
        if (jacobian == nullptr)
            return;
        jacobian[2 * n_all + span] = mean;
        for (int k = 0; k < 3; ++k) {
            jacobian[n_all + edge + k] = g[1] / at[edge + k];
            jacobian[2 * n_all + chord + k] = at[span] * of[k];
        }
    }

    bool get_nlp_info(Index &n, Index &m, Index &nnz_jac_g, Index &nnz_h_lag, IndexStyleEnum &index_style) override {
        n = n_all;
        m = n_values;
        nnz_jac_g = n_values * n_all;
        nnz_h_lag = 0;
        index_style = C_STYLE;
        return true;
    }

    bool get_bounds_info(Index, Number *x_l, Number *x_u, Index, Number *g_l, Number *g_u) override {
        std::copy(lower_.begin(), lower_.end(), x_l);
        std::copy(upper_.begin(), upper_.end(), x_u);
        std::copy_n(bounds, n_values, g_l);
        std::fill_n(g_u, n_values, unbounded);
        return true;
    }

    bool get_starting_point(Index, bool, Number *start, bool, Number *, Number *, Index, bool, Number *) override {
        std::copy(x.begin(), x.end(), start);
        return true;
    }

    bool eval_f(Index, const Number *at, bool, Number &f) override {
        f = drag(at, nullptr);
        return true;
    }

    bool eval_grad_f(Index, const Number *at, bool, Number *gradient) override {
        std::fill_n(gradient, +n_all, 0.0);
        drag(at, gradient);
        return true;
    }

    bool eval_g(Index, const Number *at, bool, Index, Number *g) override { return tried(at, g, nullptr); }

    bool eval_jac_g(Index, const Number *at, bool, Index, Index, Index *rows, Index *columns, Number *entries) override {
        double g[n_values];
        if (entries != nullptr)
            return tried(at, g, entries);
        for (Index k = 0; k < n_values * n_all; ++k) {
            rows[k] = k / n_all;
            columns[k] = k % n_all;
        }
        return true;
    }

    bool intermediate_callback(Ipopt::AlgorithmMode, Index iteration, Number f, Number missed, Number slope, Number, Number, Number, Number,
                               Number, Index, const Ipopt::IpoptData *, Ipopt::IpoptCalculatedQuantities *) override {
        iterations = iteration;
        if (iteration % 10 == 0)
            std::printf("  iteration %4d: drag %10.6f N, missed by %.1e, dual %.1e\n", iteration, newtons * f, missed, slope);
        std::fflush(stdout);
        return true;
    }

    // With the Karush-Kuhn-Tucker conditions looked at here: the gradient of the Lagrangian, what is out of its bounds, multipliers of the
    // wrong sign, and those of what is at no bound.
    void finalize_solution(Ipopt::SolverReturn, Index, const Number *at, const Number *z_l, const Number *z_u, Index, const Number *,
                           const Number *lambda, Number, const Ipopt::IpoptData *, Ipopt::IpoptCalculatedQuantities *) override {
        std::copy_n(at, +n_all, x.begin());
        double g[n_values], jacobian[n_values * n_all], gradient[n_all] = {};
        if (!tried(at, g, jacobian))
            return;
        drag(at, gradient);
        kkt = 0;
        for (int k = 0; k < n_all; ++k) {
            double sum = gradient[k] - z_l[k] + z_u[k];
            for (int i = 0; i < n_values; ++i)
                sum += lambda[i] * jacobian[i * n_all + k];
            kkt = std::max({kkt, std::fabs(sum), -z_l[k], -z_u[k], std::fabs(z_l[k] * (at[k] - lower_[k])),
                            std::fabs(z_u[k] * (upper_[k] - at[k])), lower_[k] - at[k], at[k] - upper_[k]});
        }
        for (int i = 0; i < n_values; ++i)
            kkt = std::max({kkt, bounds[i] - g[i], lambda[i], std::fabs(lambda[i] * (g[i] - bounds[i]))});
    }

private:
    bool tried(const double *at, double *g, double *jacobian) {
        try {
            values(at, g, jacobian);
            return true;
        } catch (const keepout::Error &error) {
            failure = error.what(); // IPOPT tries a shorter step
            return false;
        }
    }

    Inside &inside_;
    Numbers lower_, upper_;
};

// How far the derivatives of `problem` at x, those of drag and of all values, differ from central differences of sixth order, over the
// largest that was found: along random directions of the variables from `from` to `to`, each in proportion to its reach or 0.1.
double derivative_error(WingProblem &problem, const Numbers &x, int from, int to) {
    constexpr int n = WingProblem::n_values + 1;
    std::mt19937 random(1);
    double slopes[n][n_all] = {}, error[n] = {}, size[n] = {}, unused[n];
    drag(x.data(), slopes[0]);
    problem.values(x.data(), unused, slopes[1]);
    for (int trial = 0; trial < 3; ++trial) {
        Numbers v{};
        for (int k = from; k < to; ++k)
            v[k] = (random() / 2147483648.0 - 1) * (k < n_wing ? reach[k] : 0.1);
        double difference[n] = {};
        const double of[3] = {1.5, -0.6, 0.1}; // of differences over 2 h, 4 h and 6 h
        for (int s = -3; s <= 3; ++s) {
            if (s == 0)
                continue;
            constexpr double step = 3e-3;
            double g[n];
            Numbers there = x;
            for (int k = from; k < to; ++k)
                there[k] += s * step * v[k];
            g[0] = drag(there.data(), nullptr);
            problem.values(there.data(), g + 1, nullptr);
            for (int i = 0; i < n; ++i)
                difference[i] += of[std::abs(s) - 1] * g[i] / (2 * s * step);
        }
        for (int i = 0; i < n; ++i) {
            double slope = 0;
            for (int k = from; k < to; ++k)
                slope += slopes[i][k] * v[k];
            error[i] = std::max(error[i], std::fabs(difference[i] - slope));
            size[i] = std::max(size[i], std::fabs(slope));
        }
    }
    double largest = 0;
    for (int i = 0; i < n; ++i)
        largest = std::max(largest, size[i] > 0 ? error[i] / size[i] : error[i]);
    return largest;
}

constexpr double derivative_limit = 1e-5;

bool derivatives_agree(Inside &inside, const Numbers &x, const char *where) {
    const Ipopt::SmartPtr<WingProblem> problem = new WingProblem(inside, x);
    const double wing = derivative_error(*problem, x, 0, n_wing), battery = derivative_error(*problem, x, n_wing, n_all);
    std::fflush(stdout);
    std::printf("Derivatives at the %s differ from differences by %.1e along wings, by %.1e along batteries\n", where, wing, battery);
    return wing < derivative_limit && battery < derivative_limit;
}

// The least exact distance from the battery to the skin, by points of its faces 1 cm apart or so and by the triangles, negative where it
// sticks out: how far.
double exact_clearance(const Loft &loft, const Numbers &x) {
    const keepout::Mesh wing = loft.mesh(x.data());
    const Box fine({60, 200, 20});
    const std::vector<double> points = fine.placed(x.data());
    double clearance = std::numeric_limits<double>::infinity();
    for (const double distance : wing.signed_distance(points))
        clearance = std::min(clearance, -distance);
    const ko_separation apart = keepout::separation(wing, keepout::Mesh::from_triangles(points, fine.triangles));
    if (apart.b_in_a != 1 || apart.intersection_length > 0)
        return std::min(clearance, 0.0);
    return std::min(clearance, apart.minimum_distance);
}

// The start and, beside it, the end, from above and into the wing: of it only what faces away.
void draw(const Loft &loft, const Numbers &start, const Numbers &end, const std::string &file) {
    Picture picture(/*toward*/ {0.6, -0.5, 1}, /*up*/ {-1, 0, 0});
    const Box box({1, 1, 1});
    for (const Numbers *x : {&start, &end}) {
        const keepout::Mesh wing = loft.mesh(x->data());
        const auto aside = [&](std::vector<double> points) {
            for (std::size_t i = 0; i < points.size(); i += 3)
                points[i] += x == &end ? 2 : 0;
            return points;
        };
        picture.add(aside(wing.vertices()), wing.triangles(), {0.85, 0.88, 0.92}, Faces::back, 0);
        picture.add(aside(box.placed(x->data())), box.triangles, {0.95, 0.75, 0.2}, Faces::front, 1);
    }
    picture.write(file);
}

void tell(const char *when, const Numbers &x) {
    std::printf("%s half-span %.3f m; chords %.3f, %.3f, %.3f m; %.1f, %.1f, %.1f %% thick\n", when, x[span], x[chord], x[chord + 1],
                x[chord + 2], 10 * x[thickness], 10 * x[thickness + 1], 10 * x[thickness + 2]);
    std::printf("  battery %.3f x %.3f x %.3f m at %.3f %.3f %.3f m, yaw %.2f, roll %.2f, pitch %.2f degrees; %.4f m^3; drag %.3f N\n",
                x[edge], x[edge + 1], x[edge + 2], x[place], x[place + 1], x[place + 2], 180 / pi * x[angle], 180 / pi * x[angle + 1],
                180 / pi * x[angle + 2], x[edge] * x[edge + 1] * x[edge + 2], newtons * drag(x.data(), nullptr));
    std::fflush(stdout);
}

int run(const Arguments &arguments) {
    Outcome outcome;
    outcome.name = "wing and battery";
    outcome.unit = "mm";
    outcome.scale = mm;
    outcome.wanted = mm * wanted;
    outcome.n_unknowns = n_all;
    outcome.n_values = WingProblem::n_values;
    const Loft loft;
    const Box box({8, 16, 3});
    const ko_mesh_report shape = loft.mesh(first.data()).report();
    if (shape.closed != 1 || shape.oriented != 1 || shape.manifold != 1 || shape.inside_out != 0)
        throw std::runtime_error("the loft is no solid");
    Work work;
    Numbers x = first;
    outcome.start = mm * exact_clearance(loft, x);
    tell("Start: ", x);
    std::printf("The battery sticks out of the wing by %.1f mm\n", -outcome.start);

    // Rounds: each fits the wing anew, and solves for wings within reach of that; roughly, until one ends with the wing not held by the
    // reach, and then to the end.
    constexpr int most_rounds = 10, most_iterations = 200;
    bool agree = true, held = true;
    const double begin = processor_seconds();
    int rounds = 0;
    bool done = false;
    while (!done && rounds < most_rounds) {
        ++rounds;
        Inside inside(loft, box, x.data(), outcome, work);
        if (rounds == 1)
            agree = derivatives_agree(inside, x, "start");
        const Ipopt::SmartPtr<WingProblem> problem = new WingProblem(inside, x);
        Ipopt::SmartPtr<Ipopt::IpoptApplication> ipopt = new Ipopt::IpoptApplication();
        ipopt->Options()->SetStringValue("sb", "yes"); // no banner
        ipopt->Options()->SetIntegerValue("print_level", 0);
        ipopt->Options()->SetStringValue("hessian_approximation", "limited-memory");
        ipopt->Options()->SetNumericValue("mu_init", 1e-2);
        // Where other samples come to be the least KS turns within 2 mm, along other directions it is flat: with the last 6 steps alone,
        // which is IPOPT's default, the multipliers swing and IPOPT does not end. So all steps are kept.
        ipopt->Options()->SetIntegerValue("limited_memory_max_history", most_iterations);
        const double tolerance = held ? 3e-2 : 1e-7;
        ipopt->Options()->SetNumericValue("tol", tolerance);
        ipopt->Options()->SetNumericValue("acceptable_tol", tolerance); // nothing less
        ipopt->Options()->SetIntegerValue("max_iter", most_iterations);
        ipopt->Initialize();
        const Ipopt::ApplicationReturnStatus status = ipopt->OptimizeTNLP(problem);
        outcome.iterations += problem->iterations;
        outcome.kkt = problem->kkt;
        double moved = 0;
        for (int k = 0; k < n_wing; ++k)
            moved = std::max(moved, std::fabs(problem->x[k] - x[k]) / reach[k]);
        std::printf("Round %d: status %d after %d iterations, KKT %.1e; the wing moved by %.4f of its reach%s%s\n", rounds, status,
                    problem->iterations, problem->kkt, moved, problem->failure.empty() ? "" : "; of a point on the way Keepout said: ",
                    problem->failure.c_str());
        x = problem->x;
        tell("  there", x);
        std::printf("  KS of phi %.2f mm, exactly %.2f mm clear\n", mm * inside.value(x.data(), nullptr), mm * exact_clearance(loft, x));
        if (status != Ipopt::Solve_Succeeded)
            break;
        done = !held && !problem->held_by_reach();
        held = problem->held_by_reach();
        if (done) {
            outcome.field = mm * inside.value(x.data(), nullptr);
            agree = derivatives_agree(inside, x, "end") && agree;
        }
    }
    outcome.seconds_solve = processor_seconds() - begin - outcome.seconds_fit;
    outcome.solved = done && agree;
    outcome.exact = mm * exact_clearance(loft, x);
    tell("End:   ", x);
    std::printf("\n| variables of wing and battery | fits, refits | adjoints | a refit | an adjoint | drag at the start | at the end |\n"
                "|--:|--:|--:|--:|--:|--:|--:|\n"
                "| %d, %d | %d, %d | %d | %.3f s | %.3f s | %.4f N | %.4f N |\n",
                +n_wing, n_all - n_wing, rounds, work.refits, work.adjoints, work.seconds_refits / std::max(work.refits, 1),
                work.seconds_adjoints / std::max(work.adjoints, 1), newtons * drag(first.data(), nullptr),
                newtons * drag(x.data(), nullptr));
    if (!arguments.picture.empty())
        draw(loft, first, x, arguments.picture);
    return report(outcome) ? 0 : 1;
}

} // namespace

int main(int argc, char **argv) {
    try {
        return run(Arguments(argc, argv, nullptr));
    } catch (const std::exception &error) {
        std::fprintf(stderr, "keepout_wing: %s\n", error.what());
        return 1;
    }
}
