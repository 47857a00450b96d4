// keepout.hpp: every call, its errors, and exceptions that must not cross C.

#include <keepout.hpp>

#include "check.h"
#include <algorithm>
#include <array>

static_assert(!std::is_copy_constructible_v<keepout::Mesh> && std::is_nothrow_move_constructible_v<keepout::Mesh>);
static_assert(!std::is_copy_constructible_v<keepout::Cloud> && std::is_nothrow_move_constructible_v<keepout::Cloud>);
static_assert(!std::is_copy_constructible_v<keepout::Field> && std::is_nothrow_move_constructible_v<keepout::Field>);
static_assert(!std::is_copy_constructible_v<keepout::Sensitivity> &&
              std::is_nothrow_move_constructible_v<keepout::Sensitivity>);
static_assert(!std::is_copy_constructible_v<keepout::Body> && std::is_nothrow_move_constructible_v<keepout::Body>);
static_assert(!std::is_copy_constructible_v<keepout::Explicit> && std::is_nothrow_move_constructible_v<keepout::Explicit>);
static_assert(!std::is_copy_constructible_v<keepout::Constraints> && std::is_nothrow_move_constructible_v<keepout::Constraints>);

static_assert(std::is_convertible_v<std::vector<double>, keepout::Span<const double>>);
static_assert(std::is_convertible_v<std::vector<double> &, keepout::Span<double>>);
static_assert(std::is_convertible_v<keepout::Span<double>, keepout::Span<const double>>);
static_assert(!std::is_convertible_v<std::vector<double>, keepout::Span<double>>, "results would go with the temporary");
static_assert(!std::is_convertible_v<std::array<double, 3>, keepout::Span<double>>, "they would here too");
static_assert(!std::is_convertible_v<double (&&)[3], keepout::Span<double>>, "and here");
static_assert(std::is_convertible_v<std::array<double, 3>, keepout::Span<const double>>);
static_assert(std::is_convertible_v<std::array<double, 3> &, keepout::Span<double>>);

/// As std::span is: a temporary one may be written through, since it holds no numbers.
struct View {
    double *data() const { return nullptr; }
    std::size_t size() const { return 0; }
};
static_assert(std::is_convertible_v<View, keepout::Span<double>>);

static_assert(std::is_same_v<decltype(std::declval<const keepout::Mesh &>().get()), const ko_mesh *>);
static_assert(std::is_same_v<decltype(std::declval<const keepout::Cloud &>().get()), const ko_cloud *>);
static_assert(std::is_same_v<decltype(std::declval<const keepout::Field &>().get()), const ko_field *>);
static_assert(std::is_same_v<decltype(std::declval<keepout::Field &>().get()), ko_field *>);

/// The call throws an Error with this status and these words.
#define THROWS(call, right, words)                                                      \
    do {                                                                                \
        std::int32_t status = KO_OK;                                                    \
        std::string message;                                                            \
        try {                                                                           \
            call;                                                                       \
        } catch (const keepout::Error &error) {                                         \
            status = error.status();                                                    \
            message = error.what();                                                     \
        }                                                                               \
        check_that(status == (right) && message.find(words) != message.npos, #call, __FILE__, __LINE__); \
    } while (0)

static keepout::Mesh cube() { return keepout::Mesh::from_triangles(check_cube_vertices, check_cube_triangles); }

/// The square [-1, 1]^2 around the square hole [-0.5, 0.5]^2.
static const std::vector<double> frame_points = {-1, -1, 1, -1, 1, 1, -1, 1, -0.5, -0.5, -0.5, 0.5, 0.5, 0.5, 0.5, -0.5};

static keepout::Mesh frame() {
    return keepout::Mesh::from_polylines(frame_points, std::array<std::size_t, 2>{0, 4});
}

static keepout::FitOptions small_fit() {
    keepout::FitOptions options;
    std::fill(std::begin(options.control_points), std::end(options.control_points), 8u);
    options.n_threads = 1;
    return options;
}

static void meshes_and_clouds() {
    keepout::Mesh mesh = cube();
    CHECK(mesh.dim() == 3 && mesh.n_vertices() == 8 && mesh.n_triangles() == 12);
    CHECK(mesh.vertices() == std::vector<double>(std::begin(check_cube_vertices), std::end(check_cube_vertices)));
    CHECK(mesh.triangles().size() == 36 && mesh.triangles()[35] == 6);
    CHECK(mesh.report().closed == 1);
    mesh.flip();
    CHECK(mesh.report().inside_out == 1);
    mesh.flip();
    CHECK_NEAR(mesh.signed_distance(std::array<double, 3>{2, 0, 0}).at(0), 1.0, 1e-15);
    const double origin[3] = {0, 0, 0};
    CHECK_NEAR(mesh.signed_distance({origin, 3}).at(0), -1.0, 1e-15);

    const keepout::Cloud cloud = mesh.sample(300, 1);
    CHECK(cloud.dim() == 3 && cloud.size() == 300 && cloud.points().size() == 900 && cloud.normals().size() == 900);
    CHECK(cloud.origins().triangles.size() == 300 && cloud.origins().barycentric.size() == 900);
    const keepout::Cloud copy = keepout::Cloud::from_points(cloud.points(), cloud.normals());
    CHECK(copy.points() == cloud.points());
}

static void fields() {
    const keepout::Field field = keepout::Field::fit(cube().sample(500, 1), small_fit());
    CHECK(field.dim() == 3 && field.report().n_unknowns == 512);
    const std::vector<double> points = {0, 0, 0, 1.1, 0.2, 0, 5, 5, 5};
    const keepout::Field::Evaluation all = field.eval(points);
    CHECK(all.values[0] < 0.0 && all.values[1] > 0.0 && all.gradients[3] > 0.5);
    CHECK(field.values(points) == all.values);
    CHECK((field.outside_box(points) == std::vector<std::uint8_t>{0, 0, 1}));
    std::array<double, 3> values{};
    std::vector<double> gradients(9), hessians(18);
    field.eval(points, values, gradients);
    CHECK(gradients == all.gradients);
    field.eval_parallel(2, points, values, gradients, hessians);
    CHECK(hessians == all.hessians);

    field.save("hpp.kof");
    CHECK(keepout::Field::load("hpp.kof").values(points) == all.values);
    CHECK(std::remove("hpp.kof") == 0);
}

static void planes() {
    keepout::Mesh mesh = frame();
    CHECK(mesh.dim() == 2 && mesh.n_vertices() == 8 && mesh.n_triangles() == 8);
    CHECK(mesh.vertices() == frame_points && mesh.triangles().size() == 16);
    CHECK_NEAR(mesh.report().volume, 3.0, 1e-14);
    mesh.flip();
    CHECK(mesh.report().inside_out == 1);
    mesh.flip();
    CHECK((mesh.signed_distance(std::array<double, 4>{0, 0, 0.75, 0}) == std::vector<double>{0.5, -0.25}));
    const keepout::Mesh line = keepout::Mesh::from_polylines(std::array<double, 4>{0, 0, 1, 0}, std::array<std::size_t, 1>{0},
                                                             keepout::Polylines::open);
    CHECK(line.n_triangles() == 1);

    keepout::Cloud cloud = mesh.sample(400, 1);
    CHECK(cloud.dim() == 2 && cloud.points().size() == 800 && cloud.normals().size() == 800);
    CHECK(cloud.origins().triangles.size() == 400 && cloud.origins().barycentric.size() == 800);
    const keepout::Cloud copy = keepout::Cloud::from_points(cloud.points(), cloud.normals(), 2);
    CHECK(copy.dim() == 2 && copy.points() == cloud.points());

    keepout::FitOptions options = small_fit();
    std::fill(std::begin(options.control_points), std::end(options.control_points), 16u);
    const keepout::Field field = keepout::Field::fit(cloud, options);
    CHECK(field.dim() == 2 && field.report().n_unknowns == 256);
    const std::vector<double> points = {0, 0, 0.75, 0.1, 1.05, 0.2, 5, 5};
    const keepout::Field::Evaluation all = field.eval(points);
    CHECK(all.values.size() == 4 && all.gradients.size() == 8 && all.hessians.size() == 12);
    CHECK(all.values[0] > 0.0 && all.values[1] < 0.0 && all.values[3] > 0.0 && all.gradients[4] > 0.5);
    CHECK(field.values(points) == all.values);
    CHECK((field.outside_box(points) == std::vector<std::uint8_t>{0, 0, 0, 1}));
    std::vector<double> values(4), gradients(8), hessians(12);
    field.eval_parallel(2, points, values, gradients, hessians);
    CHECK(values == all.values && gradients == all.gradients && hessians == all.hessians);
    field.save("hpp_plane.kof");
    const keepout::Field loaded = keepout::Field::load("hpp_plane.kof");
    CHECK(loaded.dim() == 2 && loaded.values(points) == all.values);
    CHECK(std::remove("hpp_plane.kof") == 0);

    THROWS(field.eval(std::vector<double>(3)), KO_ERR_INVALID_ARGUMENT, "a multiple of 2");
    THROWS(field.eval(points, values, gradients, gradients), KO_ERR_INVALID_ARGUMENT, "hessians has room for 8 entries; 12");
    THROWS(keepout::Mesh::from_polylines(frame_points, std::array<std::size_t, 2>{4, 0}), KO_ERR_INVALID_ARGUMENT, "start");
}

/// The curves of a mesh of the plane, and files of meshes.
static void meshes_are_given_away() {
    const keepout::Mesh::Curves curves = frame().polylines();
    CHECK(curves.points == frame_points);
    CHECK((curves.loop_starts == std::vector<std::size_t>{0, 4} && curves.closed == std::vector<std::uint8_t>{1, 1}));
    THROWS(cube().polylines(), KO_ERR_INVALID_ARGUMENT, "");
    cube().write("hpp.ply");
    CHECK(keepout::Mesh::read("hpp.ply").vertices() == cube().vertices());
    CHECK(std::remove("hpp.ply") == 0);
    THROWS(cube().write("hpp.txt"), KO_ERR_UNSUPPORTED, "hpp.txt");
}

static void normals_are_estimated() {
    for (const std::uint32_t dim : {2u, 3u}) {
        const std::size_t n = 400;
        double *shape = dim == 2 ? check_circle_points(n) : check_sphere_points(n);
        std::vector<double> points(shape, shape + dim * n);
        std::free(shape);
        points.insert(points.end(), points.begin(), points.begin() + dim);
        double last = -1.0;
        keepout::NormalOptions options;
        options.n_threads = 1;
        options.on_progress = [&](double fraction, const char *) {
            last = fraction;
            return keepout::Progress::go_on;
        };
        const keepout::Cloud::Estimate found = keepout::Cloud::estimate_normals(points, dim, options);
        CHECK(last == 1.0 && found.cloud.dim() == dim && found.cloud.points() == points);
        CHECK(found.report.n_copies == 1 && found.report.agreement > 0.9 && found.flags.size() == n + 1);
        CHECK(found.flags[n] == KO_POINT_COPY && found.flags[0] == 0);
        const std::vector<double> normals = found.cloud.normals();
        for (std::size_t i = 0; i < points.size(); i++) {
            CHECK_NEAR(normals[i], points[i], 0.2);
        }
        CHECK(keepout::Cloud::from_points(points, dim).normals() == normals);
        options.on_progress = [](double, const char *) { return keepout::Progress::cancel; };
        THROWS(keepout::Cloud::estimate_normals(points, dim, options), KO_ERR_CANCELLED, "cancelled");
    }
    THROWS(keepout::Cloud::estimate_normals(std::vector<double>(7)), KO_ERR_INVALID_ARGUMENT, "points has 7 numbers");
}

static void clouds_are_smoothed() {
    for (const std::uint32_t dim : {2u, 3u}) {
        const std::size_t n = 1000;
        double *shape = dim == 2 ? check_circle_points(n) : check_sphere_points(n);
        const std::vector<double> normals(shape, shape + dim * n);
        std::free(shape);
        std::vector<double> points = normals;
        std::uint64_t seed = 5;
        for (double &x : points) {
            x += 0.02 * (2.0 * check_random(&seed) - 1.0);
        }
        const auto error = [&](const keepout::Cloud &cloud) {
            double sum = 0.0;
            const std::vector<double> found = cloud.points();
            for (std::size_t i = 0; i < n; i++) {
                double squares = 0.0;
                for (std::size_t a = 0; a < dim; a++) {
                    squares += found[dim * i + a] * found[dim * i + a];
                }
                sum += std::abs(std::sqrt(squares) - 1.0);
            }
            return sum;
        };
        const keepout::Cloud cloud = keepout::Cloud::from_points(points, normals, dim), once = cloud.smooth();
        CHECK(once.dim() == dim && once.size() == n && error(once) < 0.75 * error(cloud));
        double last = -1.0;
        keepout::SmoothOptions options;
        options.rounds = 3;
        options.on_progress = [&](double fraction, const char *) {
            last = fraction;
            return keepout::Progress::go_on;
        };
        CHECK(error(cloud.smooth(options)) < error(once) && last == 1.0);
        options.on_progress = [](double, const char *) { return keepout::Progress::cancel; };
        THROWS(cloud.smooth(options), KO_ERR_CANCELLED, "cancelled");
        options.on_progress = nullptr;
        options.rounds = 0;
        THROWS(cloud.smooth(options), KO_ERR_INVALID_ARGUMENT, "rounds is 0");
        for (const double when : {0.0, 1.0}) {
            options.rounds = 1;
            options.on_progress = [&](double fraction, const char *stage) {
                if (fraction >= when) {
                    throw std::out_of_range(stage);
                }
                return keepout::Progress::go_on;
            };
            bool caught = false;
            try {
                cloud.smooth(options);
            } catch (const std::out_of_range &) {
                caught = true;
            }
            CHECK(caught);
        }
    }
}

static void clouds_have_sides() {
    const keepout::Cloud space = cube().sample(1000, 1), plane = frame().sample(400, 1);
    const std::vector<double> found = space.sides(std::array<double, 9>{0, 0, 0, 1.5, 0, 0, 9, 9, 9});
    CHECK(found.size() == 3 && found[0] < -0.75 && found[1] > 0.75 && found[2] > 0.75);
    std::vector<double> sides(2);
    const std::vector<double> points = {0, 0, 0.75, 0};
    plane.sides(points, sides);
    CHECK(sides[0] > 0.75 && sides[1] < -0.75 && plane.sides(points) == sides);
    CHECK(space.sides({}).empty());
    CHECK_NEAR(keepout::Field::fit(space, small_fit()).report().clear_sides, 1.0, 0.01);
    THROWS(space.sides(std::vector<double>(4)), KO_ERR_INVALID_ARGUMENT, "points has 4 numbers");
    THROWS(plane.sides(std::vector<double>(6), sides), KO_ERR_INVALID_ARGUMENT, "sides has room for 2 entries; 3");
    THROWS(plane.sides(std::vector<double>{0, 0, 0, NAN}), KO_ERR_INVALID_ARGUMENT, "point 1 is ");
}

/// A field goes on to a cloud nearby, and comes back from its control points.
static void fields_are_made_of_fields() {
    const keepout::Cloud cloud = cube().sample(500, 1);
    const keepout::Field field = keepout::Field::fit(cloud, small_fit());
    const keepout::Field again = field.refit(cloud, small_fit());
    CHECK(2 * again.report().iterations < field.report().iterations && again.report().n_unknowns == 512);
    THROWS(field.refit(frame().sample(100, 1), small_fit()), KO_ERR_INVALID_ARGUMENT, "dim");

    const ko_fit_report report = field.report();
    const std::vector<double> control_points = field.control_points();
    const keepout::Field made = keepout::Field::from_control_points(report.control_points, report.box_min, report.box_max,
                                                                    report.feasible, report.diagonal, control_points);
    CHECK(made.dim() == 3 && made.control_points() == control_points);
    const double origin[3] = {0, 0, 0};
    CHECK_NEAR(made.values({origin, 3})[0], field.values({origin, 3})[0], 1e-12);
    THROWS(keepout::Field::from_control_points(report.control_points, {origin, 2}, report.box_max, 0, 1.0, control_points),
           KO_ERR_INVALID_ARGUMENT, "box_min has room for 2");
}

static void lattices_are_evaluated() {
    const keepout::Field field = keepout::Field::fit(cube().sample(500, 1), small_fit());
    const std::array<double, 3> origin{-1, -1, 0.2};
    const std::array<double, 6> steps{0.5, 0, 0.1, 0, 0.25, 0};
    const std::array<std::size_t, 2> counts{3, 4};
    std::vector<double> points, values(12), gradients(36);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            points.insert(points.end(), {-1 + 0.5 * i, -1 + 0.25 * j, 0.2 + 0.1 * i});
        }
    }
    field.eval_lattice(2, origin, steps, counts, values, gradients);
    const keepout::Field::Evaluation right = field.eval(points);
    for (int i = 0; i < 12; i++) {
        CHECK_NEAR(values[i], right.values[i], 1e-12);
        CHECK_NEAR(gradients[3 * i + 1], right.gradients[3 * i + 1], 1e-12);
    }
    THROWS(field.eval_lattice(1, origin, steps, counts, gradients), KO_ERR_INVALID_ARGUMENT, "values has room for 36 entries; 12");
    THROWS(field.eval_lattice(1, origin, origin, counts, values), KO_ERR_INVALID_ARGUMENT, "steps has room for 3");
    THROWS(field.eval_lattice(1, origin, {}, {}, {}), KO_ERR_INVALID_ARGUMENT, "");
}

static void level_sets_are_meshes() {
    keepout::FitOptions wide_box = small_fit();
    wide_box.margin = 0.5;
    const keepout::Field field = keepout::Field::fit(cube().sample(500, 1), wide_box);
    keepout::LevelSetOptions options;
    double last = -1.0;
    options.on_progress = [&](double fraction, const char *) {
        last = fraction;
        return keepout::Progress::go_on;
    };
    const keepout::Field::LevelSet zero = field.level_set(0.0, options);
    CHECK(last == 1.0 && !zero.open_at_box && zero.mesh.report().closed == 1);
    for (const double value : field.values(zero.mesh.vertices())) {
        CHECK_NEAR(value, 0.0, 1e-8);
    }
    const keepout::Field::LevelSet wide = field.level_set(0.6);
    CHECK(wide.open_at_box && wide.mesh.report().closed == 0);
    THROWS(field.level_set(100.0), KO_ERR_DEGENERATE, "");
    options.on_progress = [](double, const char *stage) -> keepout::Progress { throw std::out_of_range(stage); };
    bool caught = false;
    try {
        field.level_set(0.0, options);
    } catch (const std::out_of_range &) {
        caught = true;
    }
    CHECK(caught);
    const keepout::Field::LevelSet curves = keepout::Field::fit(frame().sample(400, 1)).level_set(0.0);
    CHECK(!curves.open_at_box && curves.mesh.polylines().closed.size() == 2);
}

static void fields_are_certified() {
    const keepout::Mesh mesh = cube(), curves = frame();
    const keepout::Field field = keepout::Field::fit(mesh.sample(500, 1), small_fit());
    keepout::CertifyOptions options;
    options.n_threads = 1;
    double last = -1.0;
    options.on_progress = [&](double fraction, const char *) {
        last = fraction;
        return keepout::Progress::go_on;
    };
    const ko_certificate found = field.certify(mesh, 0.1, 0.05, options);
    CHECK(last == 1.0 && found.side_certified == 1 && found.budget_reached == 0 && found.n_components == mesh.n_components());
    CHECK(found.threshold > 0.05 && found.threshold > found.largest_found);
    CHECK(field.values(found.place)[0] == found.largest_found);
    options.max_boxes = 1;
    options.tolerance = 1e-4;
    CHECK(field.certify(mesh, 0.1, 0.05, options).budget_reached == 1);
    const keepout::Mesh open =
        keepout::Mesh::from_triangles(check_cube_vertices, keepout::Span<const std::uint32_t>(check_cube_triangles, 33));
    CHECK(field.certify(open, 0.1, 0.0).side_certified == 0);
    CHECK((curves.n_components() == 2 && curves.component_points() == std::vector<double>{-1, -1, -0.5, -0.5}));
    THROWS(field.certify(mesh, -1.0, 0.0), KO_ERR_INVALID_ARGUMENT, "clearance");
    options.on_progress = [](double, const char *stage) -> keepout::Progress { throw std::out_of_range(stage); };
    bool caught = false;
    try {
        field.certify(mesh, 0.1, 0.05, options);
    } catch (const std::out_of_range &) {
        caught = true;
    }
    CHECK(caught);
}

static void values_have_derivatives_by_the_cloud() {
    const keepout::Mesh mesh = cube();
    const keepout::Cloud cloud = mesh.sample(500, 1);
    CHECK(cloud.follow(mesh).points() == cloud.points());
    keepout::FitOptions options = small_fit();
    const keepout::Field field = keepout::Field::fit(cloud, options);
    options.reweighting = KO_REWEIGHT_KEEP;
    CHECK_NEAR(field.refit(cloud, options).report().rms, field.report().rms, 1e-3);
    options.reweighting = KO_REWEIGHT_LARGEST;
    keepout::Sensitivity sensitivity = keepout::Sensitivity::create(field, cloud, options);
    CHECK(sensitivity.n_points() == 500);
    const std::array<double, 3> point = {1.1, 0.5, 0.6};
    const std::array<double, 1> weight = {2.0};
    std::vector<double> by_points(1500), by_normals(1500), doubled(1500), by_vertices(24);
    sensitivity.solve(point, {}, by_points, by_normals);
    options.n_threads = 2;
    sensitivity.solve(point, weight, options, doubled);
    CHECK(doubled[7] == 2.0 * by_points[7]);
    cloud.pull_back(mesh, by_points, by_normals, by_vertices);
    double of_points = 0.0, of_vertices = 0.0;
    for (std::size_t k = 0; k < 1500; k += 3) {
        of_points += by_points[k];
    }
    for (std::size_t k = 0; k < 24; k += 3) {
        of_vertices += by_vertices[k];
    }
    CHECK(std::abs(of_points) > 0.1);
    CHECK_NEAR(of_vertices, of_points, 1e-9);
    THROWS(sensitivity.solve(point, {}, keepout::Span<double>(doubled.data(), 9)), KO_ERR_INVALID_ARGUMENT, "d_points");
    THROWS(cloud.pull_back(mesh, by_points, {}, doubled), KO_ERR_INVALID_ARGUMENT, "d_vertices");
    options.on_progress = [](double, const char *) { return keepout::Progress::cancel; };
    THROWS(keepout::Sensitivity::create(field, cloud, options), KO_ERR_CANCELLED, "cancelled");
    THROWS(sensitivity.solve(point, {}, options, doubled), KO_ERR_CANCELLED, "cancelled");
}

static void formulas_are_evaluated() {
    const keepout::Cloud cloud = cube().sample(2000, 1);
    keepout::ExplicitOptions options;
    options.formulation = KO_EXPLICIT_NEAREST_PLANE;
    const keepout::Explicit plane = keepout::Explicit::create(cloud, options), smooth = keepout::Explicit::create(cloud);
    const std::array<double, 6> points = {0.1, 0.2, 1.1, 0.9, 0.0, -0.1};
    std::array<double, 2> values;
    std::array<double, 6> gradients;
    plane.eval(points, values, gradients);
    CHECK(plane.dim() == 3 && plane.smoothing() == 0.0 && smooth.smoothing() > 0.0);
    CHECK_NEAR(values[0], 0.1, 1e-14);
    CHECK_NEAR(values[1], -0.1, 1e-14);
    CHECK_NEAR(gradients[2], 1.0, 1e-14);
    CHECK_NEAR(smooth.values(points)[0], 0.1, 1e-2);
    options.feasible = KO_FEASIBLE_INSIDE;
    CHECK(keepout::Explicit::create(cloud, options).values(points)[0] == -values[0]);
    CHECK(keepout::Explicit::create(frame().sample(100, 1)).dim() == 2);
    THROWS(plane.eval(points, keepout::Span<double>(gradients.data(), 3)), KO_ERR_INVALID_ARGUMENT, "values has room");
    options.n_nearest = 2;
    THROWS(keepout::Explicit::create(cloud, options), KO_ERR_INVALID_ARGUMENT, "n_nearest");
}

static void meshes_are_separated() {
    const keepout::Mesh a = cube(), b = cube();
    const std::array<double, 3> apart = {5, 0.5, 6}, through = {1.5, 1.25, 0.5};
    std::array<double, 24> by_distance, by_length;
    ko_separation found = keepout::separation(a, b, apart, 0.0, by_distance, by_length);
    CHECK_NEAR(found.minimum_distance, 5.0, 1e-14);
    CHECK(found.intersection_length == 0.0 && found.a_in_b == 0 && by_length[0] == 0.0);
    double sum = 0.0;
    for (std::size_t i = 0; i < 24; i += 3) sum += by_distance[i];
    CHECK_NEAR(sum, found.distance_by_translation[0], 1e-15);
    CHECK(keepout::separation(a, b, apart, 1000.0).minimum_distance <= found.minimum_distance);
    found = keepout::separation(a, b, through);
    CHECK(found.minimum_distance == 0.0);
    CHECK_NEAR(found.intersection_length, 5.5, 1e-12);
    THROWS(keepout::separation(a, frame()), KO_ERR_UNSUPPORTED, "mesh_b");
    THROWS(keepout::separation(a, b, apart, 0.0, keepout::Span<double>(by_distance.data(), 3)), KO_ERR_INVALID_ARGUMENT,
           "distance_gradients has room");
}

/// Weights leave points out, and a robust fit finds them by itself.
static void clouds_are_not_trusted_alike() {
    const keepout::Cloud whole = cube().sample(400, 1);
    std::vector<double> points = whole.points(), normals = whole.normals(), weights(400, 1.0);
    for (int i = 0; i < 5; i++) {
        points[3 * i] *= 0.5, points[3 * i + 1] *= 0.5, points[3 * i + 2] *= 0.5;
        weights[i] = 0.0;
    }
    keepout::Cloud cloud = keepout::Cloud::from_points(points, normals);
    keepout::FitOptions options = small_fit();
    options.reweighting = KO_REWEIGHT_ROBUST;
    CHECK(keepout::Field::fit(cloud, options).report().n_outliers >= 5);
    cloud.set_weights(weights);
    const double origin[3] = {0, 0, 0};
    CHECK(keepout::Field::fit(cloud, small_fit()).values({origin, 3})[0] < 0.0);
    weights[7] = -1.0;
    THROWS(cloud.set_weights(weights), KO_ERR_INVALID_ARGUMENT, "weight 7");
    THROWS(cloud.set_weights({origin, 3}), KO_ERR_INVALID_ARGUMENT, "3 weights");
}

static void numbers_are_aggregated() {
    const std::vector<double> numbers = {0.5, 0.1, 0.3};
    keepout::Aggregation aggregation;
    CHECK(aggregation.kind == KO_AGGREGATE_KS && aggregation.side == KO_BELOW && aggregation.sharpness == 500.0);
    aggregation.sharpness = 20.0;
    std::vector<double> gradient(3), hessian(6);
    const double least = keepout::aggregate(aggregation, KO_LEAST, 1.0, numbers, gradient, hessian);
    const keepout::Bounds bounds = keepout::aggregation_bounds(aggregation, 3);
    CHECK(least <= 0.1 && least >= 0.1 - bounds.below && bounds.above == 0.0);
    CHECK_NEAR(gradient[0] + gradient[1] + gradient[2], 1.0, 1e-14);
    CHECK_NEAR(hessian[1] + hessian[2] + hessian[4], 0.0, 1e-13);
    aggregation.kind = KO_AGGREGATE_MINIMUM;
    CHECK(keepout::aggregate(aggregation, KO_LARGEST, 1.0, numbers) == 0.5);
    THROWS(keepout::aggregate(aggregation, KO_LEAST, 1.0, numbers, gradient, hessian), KO_ERR_UNSUPPORTED, "not smooth");
    THROWS(keepout::aggregate(aggregation, KO_LEAST, 1.0, {}), KO_ERR_INVALID_ARGUMENT, "no values");
    THROWS(keepout::aggregate(aggregation, KO_LEAST, 1.0, numbers, hessian), KO_ERR_INVALID_ARGUMENT,
           "gradient has room for 6 entries; 3");
    THROWS(keepout::aggregate(aggregation, KO_LEAST, 1.0, numbers, {}, gradient), KO_ERR_INVALID_ARGUMENT,
           "hessian has room for 3 entries; 6");
    THROWS(keepout::aggregation_bounds(aggregation, 0), KO_ERR_INVALID_ARGUMENT, "n_values is 0");
}

static void bodies_are_points() {
    const std::vector<double> points = {0, 0, 1, 0, 0, 1};
    const keepout::Body flat = keepout::Body::from_points(points, 0.5, 2), one = keepout::Body::from_points(points);
    CHECK(flat.dim() == 2 && flat.size() == 3 && flat.covering_radius() == 0.5 && flat.points() == points);
    CHECK(one.dim() == 3 && one.size() == 2 && one.covering_radius() == 0.0 && one.points() == points);
    const keepout::Body covered = keepout::Body::from_mesh(frame(), 0.1);
    CHECK(covered.dim() == 2 && covered.size() > 60 && covered.covering_radius() == 0.1);
    CHECK(keepout::Body::from_mesh(cube(), 10.0).size() == 8);
    THROWS(keepout::Body::from_points(std::vector<double>(7)), KO_ERR_INVALID_ARGUMENT, "points has 7 numbers");
    THROWS(keepout::Body::from_points(points, -1.0), KO_ERR_INVALID_ARGUMENT, "covering_radius is -1");
    THROWS(keepout::Body::from_mesh(cube(), 0.0), KO_ERR_INVALID_ARGUMENT, "covering_radius is 0");
    THROWS(keepout::Body(nullptr).size(), KO_ERR_INVALID_ARGUMENT, "body is NULL");
}

/// A body in a frame and a path of points, in a field that is gone when they are evaluated.
static keepout::Constraints make_constraints() {
    ko_field *handle = check_made_field(3);
    const keepout::Field field(handle);
    const keepout::Body body(check_body(3, 20, 1));
    keepout::Constraints set = keepout::Constraints::create();
    const std::uint32_t frame = set.add_frame(KO_ROTATION_QUATERNION), path = set.add_points(4);
    const std::uint32_t still = set.add_fixed_frame(KO_ROTATION_NONE, KO_SCALE_FREE, std::vector<double>{0.1, 0.2, 0.3, 1.5});
    CHECK(frame == 1 && still == 2 && path == 0);
    keepout::Aggregation each;
    each.kind = KO_AGGREGATE_NONE;
    CHECK(set.keep_body(body, frame, field) == 0);
    CHECK(set.keep_points(path, field, still, each) == 1);
    CHECK(set.keep_body(body, KO_WORLD, field, frame, each) == 5);
    CHECK(set.keep_points(path, field) == 25);
    THROWS(set.keep_body(body, frame, field, frame), KO_ERR_INVALID_ARGUMENT, "both move with frame 1");
    THROWS(set.keep_points(1, field), KO_ERR_INVALID_ARGUMENT, "no set of points 1");
    return set;
}

/// A body and a path in two fields: their union lies about the larger phi, their intersection about the least.
static void fields_are_combined() {
    const keepout::Field one(check_made_field(3)), other(check_sphere_field(8));
    const std::vector<double> point{0.3, 0.2, 0.1};
    keepout::Constraints set = keepout::Constraints::create();
    const std::uint32_t path = set.add_points(1);
    keepout::Aggregation hard;
    hard.kind = KO_AGGREGATE_MINIMUM;
    const keepout::Body body = keepout::Body::from_points(point);
    CHECK(set.keep_points_in_fields(path, {one, other}, KO_LARGEST, hard) == 0);
    CHECK(set.keep_points_in_fields(path, {one, other}, KO_LEAST) == 1);
    CHECK(set.keep_body_in_fields(body, KO_WORLD, {one, other}, KO_LEAST, hard) == 2);
    const std::vector<double> values = set.values(point);
    const double phi[2] = {one.eval(point).values[0], other.eval(point).values[0]};
    CHECK_NEAR(values[0], std::max(phi[0], phi[1]), 1e-14);
    CHECK(values[1] <= std::min(phi[0], phi[1]) && values[1] > std::min(phi[0], phi[1]) - 0.01);
    CHECK_NEAR(values[2], std::min(phi[0], phi[1]), 1e-14);
    THROWS(set.keep_body_in_fields(body, KO_WORLD, {}, KO_LEAST), KO_ERR_INVALID_ARGUMENT, "0 fields are given");
    THROWS(set.keep_points_in_fields(path, {one}, 2), KO_ERR_INVALID_ARGUMENT, "extreme is 2");
}

static void constraints_are_differentiated() {
    const keepout::Constraints set = make_constraints();
    const keepout::Constraints::Size size = set.size();
    const std::size_t n = 7 + 12, m = 26;
    CHECK(size.n_variables == n && size.n_values == m && size.n_jacobian == 7 + 4 * 3 + 20 * 7 + 12);
    CHECK(set.frame_variables(1).first == 0 && set.frame_variables(1).n == 7 && set.frame_variables(2).n == 0);
    CHECK(set.points_variables(0).first == 7 && set.points_variables(0).n == 12);
    std::vector<double> x(n), v(n), w(m);
    std::uint64_t seed = 3;
    for (std::vector<double> *numbers : {&x, &v, &w}) {
        for (double &number : *numbers) {
            number = check_random(&seed);
        }
    }
    const std::vector<double> values = set.values(x), entries = set.jacobian(x), dense = set.dense_jacobian(x);
    const keepout::Constraints::Pattern places = set.jacobian_pattern(), pairs = set.hessian_pattern();
    CHECK(values.size() == m && entries.size() == size.n_jacobian && dense.size() == m * n);
    CHECK(places.rows.size() == size.n_jacobian && pairs.columns.size() == size.n_hessian);
    std::vector<double> scattered(m * n), again(m), entries_again(size.n_jacobian);
    for (std::size_t k = 0; k < entries.size(); k++) {
        scattered[places.rows[k] * n + places.columns[k]] = entries[k];
    }
    CHECK(scattered == dense);
    set.values_and_jacobian(x, again, entries_again);
    CHECK(entries_again == entries);
    const std::vector<double> jv = set.jacobian_times(x, v), jtw = set.transposed_jacobian_times(x, w);
    double one = 0.0, other = 0.0;
    for (std::size_t i = 0; i < m; i++) {
        CHECK_NEAR(again[i], values[i], 1e-13);
        one += w[i] * jv[i];
    }
    for (std::size_t j = 0; j < n; j++) {
        other += jtw[j] * v[j];
    }
    CHECK_NEAR(one, other, 1e-11);

    // H v of the triangle against a difference of J^T w along v.
    const std::vector<double> triangle = set.hessian(x, w);
    std::vector<double> product(n), before = x, behind = x;
    for (std::size_t k = 0; k < triangle.size(); k++) {
        const std::size_t i = pairs.rows[k], j = pairs.columns[k];
        product[i] += triangle[k] * v[j];
        product[j] += i == j ? 0.0 : triangle[k] * v[i];
    }
    const double step = 1e-6;
    for (std::size_t j = 0; j < n; j++) {
        before[j] -= step * v[j], behind[j] += step * v[j];
    }
    const std::vector<double> low = set.transposed_jacobian_times(before, w), high = set.transposed_jacobian_times(behind, w);
    for (std::size_t j = 0; j < n; j++) {
        CHECK_NEAR((high[j] - low[j]) / (2.0 * step), product[j], 1e-4 * std::max(1.0, std::abs(product[j])));
    }
}

static void constraints_are_checked() {
    const keepout::Constraints set = make_constraints();
    std::vector<double> x(19, 0.5), values(25), jacobian(26 * 19 - 1);
    THROWS(set.values(x, values), KO_ERR_INVALID_ARGUMENT, "values has 25 entries; there are 26 values");
    THROWS(set.values({}), KO_ERR_INVALID_ARGUMENT, "x has 0 entries; there are 19 variables");
    THROWS(set.dense_jacobian(x, jacobian), KO_ERR_INVALID_ARGUMENT, "jacobian has room for 493 entries; 494");
    THROWS(set.jacobian_times(x, values), KO_ERR_INVALID_ARGUMENT, "v has room for 25 entries; 19");
    THROWS(set.transposed_jacobian_times(x, values), KO_ERR_INVALID_ARGUMENT, "w has 25 entries; there are 26");
    THROWS(set.transposed_jacobian_times(x, jacobian, values), KO_ERR_INVALID_ARGUMENT, "product has room for 25 entries; 19");
    THROWS(set.hessian(x, values), KO_ERR_INVALID_ARGUMENT, "lambda has 25 entries");
    x[3] = x[4] = x[5] = x[6] = 0.0;
    THROWS(set.values(x), KO_ERR_INVALID_ARGUMENT, "quaternion of length 0");
    THROWS(set.frame_variables(3), KO_ERR_INVALID_ARGUMENT, "no frame 3");
    THROWS(keepout::Constraints::create(4), KO_ERR_INVALID_ARGUMENT, "dim is 4");
    THROWS(keepout::Constraints(nullptr).size(), KO_ERR_INVALID_ARGUMENT, "constraints is NULL");
    keepout::Constraints plane = keepout::Constraints::create(2);
    THROWS(plane.add_frame(KO_ROTATION_VECTOR), KO_ERR_INVALID_ARGUMENT, "not by a rotation vector");
    THROWS(plane.add_fixed_frame(KO_ROTATION_ANGLE, KO_SCALE_ONE, {}), KO_ERR_INVALID_ARGUMENT, "has 0 parameters");
    THROWS(plane.add_points(0), KO_ERR_INVALID_ARGUMENT, "0 points");
    CHECK(plane.values({}).empty());
}

static void versions_are_told() {
    CHECK(keepout::version() == ko_version() && keepout::abi_version() == KO_ABI_VERSION);
    CHECK((keepout::capabilities() & KO_CAPABILITY_3D) != 0);
    CHECK(keepout::status_string(KO_ERR_IO) == "KO_ERR_IO");
}

static void errors_are_exceptions() {
    THROWS(keepout::Mesh::read("no-such-file.obj"), KO_ERR_IO, "no-such-file.obj");
    THROWS(keepout::Field::load("no-such-file.kof"), KO_ERR_IO, "no-such-file.kof");
    const std::string cut("a\0b.obj", 7);
    THROWS(keepout::Mesh::read(cut), KO_ERR_INVALID_ARGUMENT, "'a' goes on behind a zero byte");
    THROWS(keepout::Field::load(cut), KO_ERR_INVALID_ARGUMENT, "zero byte");
    THROWS(cube().write(cut), KO_ERR_INVALID_ARGUMENT, "zero byte");
    THROWS(keepout::Mesh::from_triangles(std::vector<double>(7), check_cube_triangles), KO_ERR_INVALID_ARGUMENT,
           "vertices has 7 numbers");
    THROWS(keepout::Cloud::from_points(std::vector<double>(6), std::vector<double>(3)), KO_ERR_INVALID_ARGUMENT,
           "normals has room for 3");
    THROWS(cube().sample(0, 0), KO_ERR_INVALID_ARGUMENT, "0 sample points");
    keepout::Mesh mesh = cube();
    const keepout::Mesh taken = std::move(mesh);
    CHECK(taken.n_vertices() == 8);
    THROWS(mesh.n_vertices(), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    THROWS(keepout::Cloud(nullptr).points(), KO_ERR_INVALID_ARGUMENT, "cloud is NULL");
    THROWS(keepout::Cloud::from_points(std::vector<double>(6), std::vector<double>(6), 4), KO_ERR_INVALID_ARGUMENT, "dim is 4");

    const keepout::Field field = keepout::Field::fit(cube().sample(300, 1), small_fit());
    std::vector<double> points(9), values(2), gradients(9);
    THROWS(field.eval(points, values), KO_ERR_INVALID_ARGUMENT, "values has room for 2");
    THROWS(field.eval(std::vector<double>(8)), KO_ERR_INVALID_ARGUMENT, "points has 8 numbers");
    THROWS(field.eval(points, {}, values), KO_ERR_INVALID_ARGUMENT, "gradients has room for 2");
    points[4] = NAN;
    THROWS(field.values(points), KO_ERR_INVALID_ARGUMENT, "point 1 ");
}

static void progress_is_heard() {
    const keepout::Cloud cloud = cube().sample(300, 1);
    keepout::FitOptions options = small_fit();
    double last = -1.0;
    options.on_progress = [&](double fraction, const char *) {
        last = fraction;
        return keepout::Progress::go_on;
    };
    keepout::Field::fit(cloud, options);
    CHECK(last == 1.0);

    options.on_progress = [](double, const char *) { return keepout::Progress::cancel; };
    THROWS(keepout::Field::fit(cloud, options), KO_ERR_CANCELLED, "cancelled");

    for (const double when : {0.0, 0.02, 1.0}) {
        options.on_progress = [&](double fraction, const char *stage) {
            if (fraction >= when) {
                throw std::out_of_range(stage);
            }
            return keepout::Progress::go_on;
        };
        bool caught = false;
        try {
            keepout::Field::fit(cloud, options);
        } catch (const std::out_of_range &error) {
            caught = error.what()[0] != 0;
        }
        CHECK(caught);
    }
}

int main() {
    meshes_and_clouds();
    fields();
    planes();
    meshes_are_given_away();
    normals_are_estimated();
    clouds_are_smoothed();
    clouds_have_sides();
    fields_are_made_of_fields();
    lattices_are_evaluated();
    level_sets_are_meshes();
    fields_are_certified();
    clouds_are_not_trusted_alike();
    numbers_are_aggregated();
    bodies_are_points();
    fields_are_combined();
    constraints_are_differentiated();
    constraints_are_checked();
    values_have_derivatives_by_the_cloud();
    formulas_are_evaluated();
    meshes_are_separated();
    versions_are_told();
    errors_are_exceptions();
    progress_is_heard();
    return check_result();
}
