// What flaws of a cloud do to its field, as Markdown: the default fit beside the robust one.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "library.hpp"
#include "measure.hpp"
#include "oracle.hpp"
#include "program.hpp"

namespace {

using namespace bench;

const Counts GRID = {32, 31, 25};
const std::size_t N_SAMPLES = 25000, N_HELD_OUT = 50000, N_SIGNS = 20000;
const double PI = 3.14159265358979323846;

using Vec = std::array<double, 3>;

// Points with normals that a flaw is worked into.
struct Points {
    std::vector<Vec> at, normals;

    std::size_t size() const { return at.size(); }
    void add(const Vec &p, const Vec &n) { at.push_back(p), normals.push_back(n); }
};

// Of the clean cloud: D, and the box that outliers are strewn in.
struct Frame {
    double D;
    Vec lower, upper;
};

double square_between(const Vec &a, const Vec &b) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

// Normally distributed, by Box and Muller.
double gauss(Uniform &uniform) {
    const double u = 1 - uniform(), v = uniform();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * PI * v);
}

Vec direction(Uniform &uniform) {
    Vec d;
    for (double &x : d) x = gauss(uniform);
    const double length = std::sqrt(square_between(d, {0, 0, 0}));
    for (double &x : d) x /= length;
    return d;
}

Points gaussian(Points points, const Frame &frame, double deviation) {
    Uniform uniform(1);
    for (Vec &p : points.at)
        for (double &x : p) x += deviation * frame.D * gauss(uniform);
    return points;
}

// `share` of the cloud's points more, anywhere in the box, with any normals.
Points outliers(Points points, const Frame &frame, double share) {
    Uniform uniform(2);
    const auto n = static_cast<std::size_t>(share * static_cast<double>(points.size()));
    for (std::size_t i = 0; i < n; ++i) {
        Vec p;
        for (int k = 0; k < 3; ++k) p[k] = frame.lower[k] + uniform() * (frame.upper[k] - frame.lower[k]);
        points.add(p, direction(uniform));
    }
    return points;
}

// Marks points within equal balls about points of the cloud until `share` of all is marked.
std::vector<bool> in_balls(const Points &points, double radius, double share, std::uint64_t seed) {
    Uniform uniform(seed);
    std::vector<bool> marked(points.size());
    const double wanted = share * static_cast<double>(points.size());
    for (std::size_t n = 0; static_cast<double>(n) < wanted;) {
        const Vec centre = points.at[static_cast<std::size_t>(uniform() * static_cast<double>(points.size()))];
        for (std::size_t i = 0; i < points.size() && static_cast<double>(n) < wanted; ++i) {
            if (marked[i] || square_between(points.at[i], centre) > radius * radius) continue;
            marked[i] = true;
            ++n;
        }
    }
    return marked;
}

Points without(const Points &points, const std::vector<bool> &marked) {
    Points kept;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (!marked[i]) kept.add(points.at[i], points.normals[i]);
    return kept;
}

Points holes(Points points, const Frame &frame, double share) {
    return without(points, in_balls(points, 0.04 * frame.D, share, 3));
}

// Keeps a point with a probability that falls from 1 at one end of x to 1 / `factor` at the other.
Points uneven(Points points, const Frame &frame, double factor) {
    Uniform uniform(4);
    std::vector<bool> dropped;
    for (const Vec &p : points.at) {
        const double along = (p[0] - frame.lower[0]) / (frame.upper[0] - frame.lower[0]);
        dropped.push_back(uniform() > std::pow(factor, -along));
    }
    return without(points, dropped);
}

void flip(Vec &normal) {
    for (double &x : normal) x = -x;
}

Points flipped(Points points, const Frame &, double share) {
    Uniform uniform(5);
    for (Vec &normal : points.normals)
        if (uniform() < share) flip(normal);
    return points;
}

// The points nearest to one of them.
Points flipped_patch(Points points, const Frame &, double share) {
    const Vec centre = points.at[points.size() / 3];
    std::vector<std::size_t> order(points.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    const auto n = static_cast<std::ptrdiff_t>(share * static_cast<double>(points.size()));
    std::nth_element(order.begin(), order.begin() + n, order.end(), [&](std::size_t a, std::size_t b) {
        return square_between(points.at[a], centre) < square_between(points.at[b], centre);
    });
    for (auto i = order.begin(); i != order.begin() + n; ++i) flip(points.normals[*i]);
    return points;
}

// `share` of the points again, nine times each.
Points copies(Points points, const Frame &, double share) {
    Uniform uniform(6);
    const std::size_t n = points.size();
    for (std::size_t i = 0; i < n; ++i) {
        if (uniform() >= share) continue;
        for (int again = 0; again < 9; ++again) points.add(points.at[i], points.normals[i]);
    }
    return points;
}

enum class Treatment { NONE, ESTIMATED, SMOOTHED };

struct Flaw {
    const char *name;
    Points (*work_in)(Points points, const Frame &frame, double amount);
    double amount;
    Treatment treatment = Treatment::NONE;
};

const Flaw FLAWS[] = {
    {"none", nullptr, 0},
    {"Gaussian noise of 0.001 D", gaussian, 0.001},
    {"Gaussian noise of 0.003 D", gaussian, 0.003},
    {"Gaussian noise of 0.01 D", gaussian, 0.01},
    {"outliers, 1 %", outliers, 0.01},
    {"outliers, 5 %", outliers, 0.05},
    {"outliers, 20 %", outliers, 0.20},
    {"holes, 1 %", holes, 0.01},
    {"holes, 5 %", holes, 0.05},
    {"holes, 20 %", holes, 0.20},
    {"density falling 10 times", uneven, 10},
    {"density falling 100 times", uneven, 100},
    {"normals flipped, 5 %", flipped, 0.05},
    {"normals flipped, 20 %", flipped, 0.20},
    {"normals flipped in a patch, 2 %", flipped_patch, 0.02},
    {"normals flipped in a patch, 10 %", flipped_patch, 0.10},
    {"copies, 10 % of the points ten times", copies, 0.10},
    {"any normals flipped, estimated anew", nullptr, 0, Treatment::ESTIMATED},
    {"Gaussian noise of 0.001 D, normals estimated", gaussian, 0.001, Treatment::ESTIMATED},
    {"Gaussian noise of 0.003 D, normals estimated", gaussian, 0.003, Treatment::ESTIMATED},
    {"outliers, 5 %, normals estimated", outliers, 0.05, Treatment::ESTIMATED},
    {"density falling 100 times, normals estimated", uneven, 100, Treatment::ESTIMATED},
    {"none, smoothed", nullptr, 0, Treatment::SMOOTHED},
    {"Gaussian noise of 0.001 D, smoothed", gaussian, 0.001, Treatment::SMOOTHED},
    {"Gaussian noise of 0.003 D, smoothed", gaussian, 0.003, Treatment::SMOOTHED},
    {"Gaussian noise of 0.01 D, smoothed", gaussian, 0.01, Treatment::SMOOTHED},
};

Cloud cloud_of(const Points &points, Treatment treatment) {
    std::vector<double> at, normals;
    for (std::size_t i = 0; i < points.size(); ++i) {
        at.insert(at.end(), points.at[i].begin(), points.at[i].end());
        normals.insert(normals.end(), points.normals[i].begin(), points.normals[i].end());
    }
    ko_cloud *cloud = nullptr;
    if (treatment == Treatment::NONE) return cloud_from(3, at, normals);
    if (treatment == Treatment::SMOOTHED) {
        ko_smooth_options options;
        check(ko_smooth_options_init(&options, sizeof options), "ko_smooth_options_init");
        options.rounds = 2;
        check(ko_cloud_smooth(cloud_from(3, at, normals).get(), &options, &cloud), "ko_cloud_smooth");
        return Cloud(cloud);
    }
    check(ko_cloud_estimate_normals(3, at.data(), points.size(), nullptr, &cloud, nullptr, 0, nullptr), "ko_cloud_estimate_normals");
    return Cloud(cloud);
}

// The clean shape, which every field is judged on.
struct Truth {
    Points cloud;
    Frame frame;
    std::vector<double> on_surface, in_box, exact;
};

Truth truth_of(const std::string &path) {
    const Mesh mesh = read_mesh(path);
    const Cloud cloud = sample(mesh, N_SAMPLES);
    std::vector<double> at(3 * N_SAMPLES), normals(3 * N_SAMPLES);
    check(ko_cloud_copy(cloud.get(), N_SAMPLES, at.data(), normals.data()), "ko_cloud_copy");
    Truth truth;
    for (std::size_t i = 0; i < 3 * N_SAMPLES; i += 3)
        truth.cloud.add({at[i], at[i + 1], at[i + 2]}, {normals[i], normals[i + 1], normals[i + 2]});
    const ko_fit_report clean = report_of(fit(cloud, options_of(GRID)));
    truth.frame.D = clean.diagonal;
    std::copy(clean.box_min, clean.box_min + 3, truth.frame.lower.begin());
    std::copy(clean.box_max, clean.box_max + 3, truth.frame.upper.begin());
    truth.on_surface = draw_by_area(facets_of(mesh), N_HELD_OUT, /*seed*/ 20230601).points;
    truth.in_box = draw_in_box(clean, N_SIGNS, /*seed*/ 7);
    truth.exact = exact_distances(mesh, truth.in_box);
    return truth;
}

void print_cells(const Cloud &cloud, std::int32_t reweighting, const Truth &truth) {
    ko_fit_options options = options_of(GRID);
    options.reweighting = reweighting;
    try {
        const Field field = fit(cloud, options);
        const OnSurface found = on_surface(field, truth.on_surface, truth.frame.D);
        const Signs signs = signs_of(field, truth.in_box, truth.exact);
        std::printf(" %.1e | %.1e | %.3f | %zu |", found.phi.rms(), found.phi.max(), found.mean_gradient, signs.wrong_far);
        const ko_fit_report report = report_of(field);
        const double left_out = static_cast<double>(report.n_outliers) / static_cast<double>(report.n_points);
        if (reweighting == KO_REWEIGHT_ROBUST) std::printf(" %.1f %% |", 100 * left_out);
    } catch (const LibraryError &error) {
        // A cloud that cannot be fitted is a result.
        std::printf(" %s | | | |%s", ko_status_string(error.status), reweighting == KO_REWEIGHT_ROBUST ? " |" : "");
    }
}

void print_row(const std::string &name, const Cloud &cloud, const Truth &truth) {
    std::printf("| %s |", name.c_str());
    for (const std::int32_t reweighting : {KO_REWEIGHT_LARGEST, KO_REWEIGHT_ROBUST}) print_cells(cloud, reweighting, truth);
    std::printf("\n");
    std::fflush(stdout);
}

const char *const INTRODUCTION =
    "# Noise\n\n"
    "What flaws of a cloud do to its field, made by `benches/run noise` with keepout %s: the bunny (bunny_lsdo_genie.stl), 25,000\n"
    "samples, 32 x 31 x 25 control points, one flaw worked in at a time. Each row has the default fit, which weights points more that\n"
    "the surface misses (KO_REWEIGHT_LARGEST), and the robust one, which weights them less (KO_REWEIGHT_ROBUST), otherwise with default\n"
    "options.\n\n"
    "How to read it: rms and max are of |phi| at 50,000 points of the clean surface, in units of D, the diagonal of the clean cloud's\n"
    "bounding box. Gradient is the mean of |grad phi| there, 1 for a distance: a small |phi| beside a gradient far below 1 is no\n"
    "accuracy. Wrong signs are those of 20,000 points in the clean cloud's box that lie farther than one cell (0.026 D) from the clean\n"
    "surface. Left out is the share of its points that the robust fit did without. The first row is the measure for the others: a flaw\n"
    "whose row looks like it does no harm. Points that are wrong, in place or normal, are those that the default fit believes most: take\n"
    "the robust one for outliers and normals flipped here and there; under noise it keeps more of the gradient. Where points are right\n"
    "but missing, or their density is uneven, it is the worse of both: it takes sparse points for outliers. Neither finds a patch of\n"
    "flipped normals, in which each point agrees with its neighbours; the rows near the end drop all normals and estimate them\n"
    "by ko_cloud_estimate_normals, and the last smooth points and normals by two rounds of ko_cloud_smooth.\n\n"
    "Flaws: Gaussian noise moves each point by that deviation along each axis and leaves the normals. Outliers are added, uniform in the\n"
    "box, with any normals. Holes are the points within balls of radius 0.04 D, removed. Density falls along x. Normals are flipped at\n"
    "random, or those of the points nearest to one of them. Copies are points that are given again.\n\n";

void all(const Data &data) {
    const Truth truth = truth_of(data("stanford/bunny_lsdo_genie.stl"));
    std::printf(INTRODUCTION, ko_version());
    std::printf("| flaw | default: rms | max | gradient | wrong signs | robust: rms | max | gradient | wrong signs | left out |\n");
    std::printf("|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
    for (const Flaw &flaw : FLAWS) {
        const Points points = flaw.work_in ? flaw.work_in(truth.cloud, truth.frame, flaw.amount) : truth.cloud;
        print_row(flaw.name, cloud_of(points, flaw.treatment), truth);
    }
}

}  // namespace

int main(int argc, char **argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: %s DATA_FOLDER\n", argv[0]);
        return EXIT_FAILURE;
    }
    return run("noise", [&] { all(Data(argv[1])); });
}
