// keepout.hpp: motions, parts and pairs of co-generation.

#include <keepout.hpp>

#include "check.h"
#include <algorithm>
#include <array>
#include <numeric>

static_assert(!std::is_copy_constructible_v<keepout::Motion> && std::is_nothrow_move_constructible_v<keepout::Motion>);
static_assert(!std::is_copy_constructible_v<keepout::Part> && std::is_nothrow_move_constructible_v<keepout::Part>);
static_assert(!std::is_copy_constructible_v<keepout::Pair>);

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

using keepout::Law;
using keepout::Motion;
using keepout::Part;

static const double TAU = 6.283185307179586;

static std::vector<double> moved(const Motion &motion, double t, const std::vector<double> &p) {
    const keepout::Pose pose = motion.pose(t);
    std::vector<double> to = pose.translation;
    for (std::size_t a = 0; a < to.size(); a++) {
        for (std::size_t b = 0; b < to.size(); b++) {
            to[a] += pose.rotation[to.size() * a + b] * p[b];
        }
    }
    return to;
}

static void near_point(const std::vector<double> &p, const std::vector<double> &q, double tolerance) {
    CHECK(p.size() == q.size());
    for (std::size_t a = 0; a < p.size(); a++) {
        CHECK_NEAR(p[a], q[a], tolerance);
    }
}

static void motions_move() {
    const std::vector<double> p = {0.3, -0.2, 0.5};
    const Motion still = Motion::fixed(3), slide = Motion::slide(std::array<double, 3>{1, 2, 3}, Law{0.5, 0.25, {}});
    near_point(moved(still, 0.2, p), p, 0.0);
    near_point(moved(slide, 0.4, p), {0.9, 1.0, 2.3}, 1e-15);
    const Motion screw = Motion::screw(std::array<double, 3>{}, std::array<double, 3>{0, 0, 1}, 0.2, Law{0.0, 1.0, {{0.1, 1.0, 0.0}}});
    const double f = 0.25 + 0.1 * std::cos(TAU * 0.25);
    near_point(moved(screw, 0.25, p), {std::cos(f) * 0.3 + std::sin(f) * 0.2, std::sin(f) * 0.3 - std::cos(f) * 0.2, 0.5 + 0.2 * f}, 1e-14);
    near_point(moved(screw.product(slide).inverse(), 0.7, moved(screw, 0.7, moved(slide, 0.7, p))), p, 1e-14);
    CHECK(screw.dim() == 3);

    const Motion turn = Motion::turn(std::array<double, 2>{1, 0}, Law{0.0, 1.0, {}});
    std::vector<double> rotations, translations;
    for (const double t : {0.0, 0.5, 1.0}) {
        const keepout::Pose pose = turn.pose(t);
        rotations.insert(rotations.end(), pose.rotation.begin(), pose.rotation.end());
        translations.insert(translations.end(), pose.translation.begin(), pose.translation.end());
    }
    const Motion sampled = Motion::sampled(2, rotations, translations);
    const Motion asked = Motion::from_function(2, [&](double t, double *r, double *s) { turn.eval({&t, 1}, {r, 4}, {s, 2}); }, 3);
    for (const Motion *other : {&sampled, &asked}) {
        near_point(moved(*other, 0.3, {0.4, 0.6}), moved(turn, 0.3, {0.4, 0.6}), 1e-14);
    }
    bool caught = false;
    try {
        Motion::from_function(2, [](double, double *, double *) { throw std::out_of_range("no"); }, 3);
    } catch (const std::out_of_range &) {
        caught = true;
    }
    CHECK(caught);
    THROWS(Motion::from_function(2, [](double, double *, double *) {}, 3), KO_ERR_INVALID_ARGUMENT, "pose 0, at time 0: an entry");
    const Part part = Part::create(std::array<double, 2>{0, 0}, 1.0, std::array<std::size_t, 2>{1, 1});
    const auto quarter = [&](double t, double *r, double *s) { turn.eval({&t, 1}, {r, 4}, {s, 2}); };
    THROWS(Motion::from_function(2, quarter, 3, &part, 0.1), KO_ERR_INVALID_ARGUMENT, "the motion jumps");
    THROWS(Motion::turn(std::array<double, 3>{}, Law{}), KO_ERR_INVALID_ARGUMENT, "center has room for 3");
    THROWS(still.product(turn), KO_ERR_INVALID_ARGUMENT, "outer dim 3");
    THROWS(Motion(nullptr).inverse(), KO_ERR_INVALID_ARGUMENT, "of is NULL");

    const auto wheels = Motion::gears(std::array<double, 4>{0, 0, 2, 0}, 1.0, 1.0);
    near_point(moved(wheels[0], 0.25, {1, 0}), {0, 1}, 1e-15);
    near_point(moved(wheels[1], 0.25, {1, 0}), {2, 1}, 1e-15);
    const auto bars = Motion::four_bar(std::array<double, 4>{0, 0, 1, 0}, std::array<double, 3>{0.3, 0.9, 0.7}, 0.0, TAU, 1, 32);
    near_point(moved(bars[1], 0.5, {0.9, 0}), moved(bars[2], 0.5, {0.7, 0}), 1e-12);
}

static keepout::PairOptions one_thread() {
    keepout::PairOptions options;
    options.n_threads = 1;
    return options;
}

static void parts_are_grids() {
    const std::array<std::size_t, 2> counts = {4, 5};
    std::vector<std::uint8_t> cells(20, KO_CELL_FREE);
    cells[3] = KO_CELL_FROZEN;
    const Part part = Part::create(std::array<double, 2>{-0.5, 0}, 0.25, counts, cells);
    CHECK(part.dim() == 2 && part.size() == 20 && part.cells() == cells);
    const Part::Grid grid = part.grid();
    CHECK(grid.corner[0] == -0.5 && grid.cell_edge == 0.25 && grid.counts[1] == 5);
    const auto sum = [](const std::vector<double> &x) { return std::accumulate(x.begin(), x.end(), 0.0); };
    CHECK_NEAR(sum(part.fractions_of_box(std::array<double, 2>{-0.25, 0.25}, std::array<double, 2>{0.25, 1.0})), 6.0, 1e-12);
    CHECK_NEAR(sum(part.fractions_of_ball(std::array<double, 2>{0, 0.5}, 0.4, 32, 1)) / 16, 0.5026, 2e-3);
    CHECK_NEAR(sum(part.fractions_of_cylinder(std::array<double, 4>{-0.25, 0.5, 0.25, 0.5}, 0.25)), 4.0, 1e-12);
    THROWS(part.fractions_of_ball(std::array<double, 3>{}, 1.0), KO_ERR_INVALID_ARGUMENT, "center has room for 3");

    const Part space = Part::create(std::array<double, 3>{-1.5, -1.5, -1.5}, 0.5, std::array<std::size_t, 3>{6, 6, 6});
    const keepout::Mesh cube = keepout::Mesh::from_triangles(check_cube_vertices, check_cube_triangles);
    CHECK_NEAR(sum(space.fractions(cube, 2)), 64.0, 1e-12);
    const keepout::Field field(check_made_field(3));
    double inside = 0.0;
    for (int i = 0; i < 24 * 24 * 24; i++) {
        const std::array<double, 3> p = {-1.4375 + 0.125 * (i / 576), -1.4375 + 0.125 * (i / 24 % 24), -1.4375 + 0.125 * (i % 24)};
        inside += field.values(p)[0] < 0.0 ? 1.0 / 64 : 0.0;
    }
    CHECK(inside > 1.0);
    CHECK_NEAR(sum(space.fractions(field, 3.0, 4)), inside, 1e-12);
    THROWS(part.fractions(cube), KO_ERR_INVALID_ARGUMENT, "the mesh dim 3");
    THROWS(Part(nullptr).size(), KO_ERR_INVALID_ARGUMENT, "part is NULL");

    /* The part slides over a table. */
    const Part table = Part::create(std::array<double, 2>{-0.5, 0}, 0.25, std::array<std::size_t, 2>{8, 5});
    const Motion slide = Motion::slide(std::array<double, 2>{1, 0}, Law{0.0, 0.5, {}}), still = Motion::fixed(2);
    keepout::CellSet first(20, 0);
    first[0] = 1;
    const keepout::CellSet swept = part.sweep(slide, table, still, first, one_thread());
    CHECK(std::count(swept.begin(), swept.end(), 1) == 3 && swept[0] == 1 && swept[5] == 1 && swept[10] == 1);
    keepout::CellSet kept(20, 1), pin(40, 0);
    pin[10] = 1;
    part.unsweep(slide, table, still, KO_AVOID, kept, pin, one_thread());
    CHECK(std::count(kept.begin(), kept.end(), 0) == 3 && kept[0] == 0 && kept[5] == 0 && kept[10] == 0);
    THROWS(part.unsweep(slide, table, still, 5, kept), KO_ERR_INVALID_ARGUMENT, "rule is 5");
}

static void pairs_never_collide() {
    const Part one = Part::create(std::array<double, 2>{-0.5, -0.5}, 0.1, std::array<std::size_t, 2>{10, 10});
    const Part two = Part::create(std::array<double, 2>{0.4, -0.5}, 0.1, std::array<std::size_t, 2>{10, 9});
    const auto wheels = Motion::gears(std::array<double, 4>{0, 0, 0.9, 0}, 1.0, 1.0);
    keepout::PairOptions options = one_thread();
    options.conflicts = KO_CONFLICTS_OF_MEASURE;
    options.measure_steps = 60;
    int told = 0;
    options.on_progress = [&](double, const char *) {
        told++;
        return keepout::Progress::go_on;
    };
    const keepout::Pair pair = keepout::Pair::create(one, wheels[0], two, wheels[1], options);
    const ko_pair_report report = pair.report();
    CHECK(told > 0 && report.n_cells[0] == 100 && report.n_cells[1] == 90 && report.n_edges > 100 && report.measure_steps == 60);

    const std::vector<double> rho_1(100, 0.5), rho_2(90, 1.0);
    const auto g = pair.measures(rho_1, rho_2, 1);
    const auto local = pair.local_measures(rho_1, rho_2, 1);
    const auto by = pair.sensitivities(rho_1, rho_2, 1);
    double sum = 0.0, of_local = 0.0;
    for (std::size_t i = 0; i < 100; i++) {
        sum += by.g12.first[i] * rho_1[i];
        of_local += 0.01 * rho_1[i] * local.first[i];
    }
    CHECK(g.g12 > 1e-3 && g.g21 > 1e-3);
    CHECK_NEAR(g.g12, sum, 1e-14);
    CHECK_NEAR(g.g12, of_local, 1e-14);
    CHECK_NEAR(g.g21, std::accumulate(by.g21.second.begin(), by.g21.second.end(), 0.0), 1e-14);

    const auto hit = pair.colliding();
    CHECK(std::count(hit.first.begin(), hit.first.end(), 1) == static_cast<std::ptrdiff_t>(report.n_colliding[0]));
    const auto best = pair.cut();
    CHECK_NEAR(best.weight, 0.01 * static_cast<double>(std::count(best.cells.first.begin(), best.cells.first.end(), 1) +
                                                       std::count(best.cells.second.begin(), best.cells.second.end(), 1)), 1e-12);
    CHECK(best.weight == best.bound);
    const auto what = pair.volumes(best.cells);
    CHECK(what.n_lost == 0 && what.gamma == best.gamma && what.volumes[0] > 0.0);
    CHECK(pair.close(best.cells).cells.first == best.cells.first);
    const auto ends = pair.family(std::array<double, 3>{0.0, 0.5, 1.0});
    CHECK(ends.size() == 3 && ends[0].gamma == 0.0 && ends[2].gamma == 1.0 && std::fabs(ends[1].gamma - 0.5) < 0.05);
    for (const auto &member : ends) {
        CHECK(member.volumes[0] + member.volumes[1] <= member.bound * (1 + 1e-9) && pair.volumes(member.cells).n_lost == 0);
    }
    const std::vector<double> heavy(100, 1.0), light(90, 1e-3);
    const auto all = pair.cut(heavy, light);
    CHECK(std::count(all.cells.first.begin(), all.cells.first.end(), 1) == 100);
    const auto found = pair.optimise();
    CHECK(found.report.converged == 1 && found.history.size() == found.report.n_iterations + 1u && pair.volumes(found.cells).n_lost == 0);
    CHECK(found.history[0][0] > found.history.back()[0]);
    const auto touch = pair.contact(best.cells, 20, 1);
    CHECK(touch.gaps.size() == 20 && touch.places.size() == 40 && touch.mean <= touch.largest);

    THROWS(pair.contact(best.cells, 20, 1, [](double, const char *) { return keepout::Progress::cancel; }), KO_ERR_CANCELLED, "cancelled");
    THROWS(pair.measures(rho_2, rho_1), KO_ERR_INVALID_ARGUMENT, "90 densities for part 1's 100 cells");
    THROWS(pair.cut(light), KO_ERR_INVALID_ARGUMENT, "weights_1 has room for 90");
    THROWS(pair.close({}), KO_ERR_INVALID_ARGUMENT, "the first set has room for 0");
    THROWS(keepout::Pair(nullptr).report(), KO_ERR_INVALID_ARGUMENT, "pair is NULL");
    options.on_progress = [](double, const char *) -> keepout::Progress { throw std::out_of_range("stop"); };
    bool caught = false;
    try {
        keepout::Pair::create(one, wheels[0], two, wheels[1], options);
    } catch (const std::out_of_range &) {
        caught = true;
    }
    CHECK(caught);
}

static void choices_are_served() {
    const std::array<std::size_t, 2> counts{12, 12};
    const Part one = Part::create(std::array<double, 2>{-0.5, -0.5}, 1.0 / 12, counts);
    const Part two = Part::create(std::array<double, 2>{0.5, -0.5}, 1.0 / 12, counts);
    const auto wheels = Motion::gears(std::array<double, 4>{0, 0, 1, 0}, 1.0, 1.0);
    keepout::PairOptions options = one_thread();
    options.n_steps = 200;
    options.measure_steps = 40;
    const keepout::Pair pair = keepout::Pair::create(one, wheels[0], two, wheels[1], options);

    /* Half a turn of both wheels about their centres. */
    const std::array<double, 12> half{-1, 0, 0, -1, 0, 0, -1, 0, 0, -1, 2, 0};
    keepout::FamilyOptions symmetric;
    symmetric.symmetries = half.data();
    symmetric.n_symmetries = 1;
    const auto best = pair.cut({}, {}, symmetric);
    for (std::size_t i = 0; i < 144; i++) {
        CHECK(best.cells.first[i] == best.cells.first[143 - i] && best.cells.second[i] == best.cells.second[143 - i]);
    }
    CHECK_NEAR(best.weight, pair.cut().weight, 1e-12);

    keepout::PersistenceOptions persistence;
    persistence.n_times = 40;
    persistence.max_tries = 20;
    persistence.n_threads = 1;
    const auto touching = pair.more_persistent(best.cells, {}, {}, persistence);
    CHECK(touching.after >= touching.before && touching.before > 0.0 && touching.n_tries <= 20);
    CHECK(pair.volumes(touching.cells).n_lost == 0);
    THROWS(pair.more_persistent({}), KO_ERR_INVALID_ARGUMENT, "the first set has room for 0");

    const std::vector<double> rho(144, 0.25);
    const auto by = pair.sensitivities(rho, rho, 1), put = pair.topological_sensitivities(rho, rho, KO_CHANGE_PUT, 1),
               take = pair.topological_sensitivities(rho, rho, KO_CHANGE_TAKE, 1);
    for (std::size_t i = 0; i < 144; i++) {
        CHECK_NEAR(put.g21.second[i], 0.75 * 144 * by.g21.second[i], 1e-12);
        CHECK_NEAR(take.g12.first[i], 0.25 * 144 * by.g12.first[i], 1e-12);
    }
    THROWS(pair.topological_sensitivities(rho, rho, 7), KO_ERR_INVALID_ARGUMENT, "change is 7");

    /* Meshes of what is kept. */
    const keepout::Mesh mesh = one.mesh_of_cells(best.cells.first, KO_WITHIN_CELLS, 0);
    CHECK_NEAR(mesh.report().volume, static_cast<double>(std::count(best.cells.first.begin(), best.cells.first.end(), 1)) / 144, 1e-12);
    std::vector<double> densities(best.cells.first.begin(), best.cells.first.end());
    CHECK(one.mesh_of_densities(densities, 0.5, KO_WITHIN_ANYWHERE, 5).report().closed == 1);
    THROWS(one.mesh_of_cells(keepout::CellSet(3)), KO_ERR_INVALID_ARGUMENT, "a set of 3 cells");
    const auto cancel = [](double, const char *) { return keepout::Progress::cancel; };
    THROWS(one.mesh_of_densities(densities, 0.5, KO_WITHIN_CELLS, 5, cancel), KO_ERR_CANCELLED, "cancelled");

    /* A third wheel, which meets the second alone. */
    const Part three = Part::create(std::array<double, 2>{1.5, -0.5}, 1.0 / 12, counts);
    const auto others = Motion::gears(std::array<double, 4>{2, 0, 1, 0}, 1.0, 1.0);
    const std::array<const Part *, 3> parts{&one, &two, &three};
    const std::array<const Motion *, 3> motions{&wheels[0], &wheels[1], &others[0]};
    const keepout::Assembly assembly = keepout::Assembly::create(parts, motions, one_thread());
    CHECK(assembly.report().n_parts == 3 && assembly.report().n_cells == 432);
    const auto meetings = assembly.meetings();
    CHECK(meetings.size() == 2 && meetings[0][0] == 0 && meetings[0][1] == 1 && meetings[1][0] == 1 && meetings[1][1] == 2);
    const auto train = assembly.arrange();
    CHECK(train.weight == train.bound && train.n_cuts >= 1);
    CHECK_NEAR(train.weight, static_cast<double>(std::count(train.cells.begin(), train.cells.end(), 1)) / 144, 1e-12);
    CHECK(assembly.close(train.cells, std::array<std::size_t, 3>{2, 0, 1}) == train.cells);
    const auto second = assembly.close(keepout::CellSet(432, 1), std::array<std::size_t, 3>{1, 0, 2});
    CHECK(std::count(second.begin() + 144, second.begin() + 288, 1) == 144 && std::count(second.begin(), second.end(), 1) < 432);
    THROWS(assembly.close(keepout::CellSet(3)), KO_ERR_INVALID_ARGUMENT, "sets has room for 3");
    THROWS(assembly.close(train.cells, std::array<std::size_t, 2>{0, 1}), KO_ERR_INVALID_ARGUMENT, "order has room for 2");
    THROWS(assembly.arrange(rho), KO_ERR_INVALID_ARGUMENT, "weights has room for 144");
    keepout::ArrangeOptions arrange;
    arrange.on_progress = cancel;
    THROWS(assembly.arrange({}, arrange), KO_ERR_CANCELLED, "cancelled");
    const std::array<const Part *, 1> none{nullptr};
    const std::array<const Motion *, 1> still{nullptr};
    THROWS(keepout::Assembly::create(none, still), KO_ERR_INVALID_ARGUMENT, "parts[0] is NULL");
    THROWS(keepout::Assembly(nullptr).report(), KO_ERR_INVALID_ARGUMENT, "assembly is NULL");
}

int main() {
    motions_move();
    parts_are_grids();
    pairs_never_collide();
    choices_are_served();
    return check_result();
}
