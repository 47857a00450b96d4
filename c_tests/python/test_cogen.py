"""The Python module: motions, parts and pairs of co-generation."""

import gc
import unittest

import numpy as np

from keepout import ArrangeOptions, Assembly, Cell, Change, Conflicts, FamilyOptions, Law, Motion, OptimiseOptions, Pair
from keepout import PairOptions, Part, PersistenceOptions, Rule, Status, Within
from test_keepout import TestCase, cube, made_field

TAU = 2 * np.pi


def moved(motion: Motion, t: float, p: object) -> np.ndarray:
    turns, shifts = motion.eval([t])
    return turns[0] @ np.asarray(p) + shifts[0]


class Motions(TestCase):
    def test_motions_move_as_they_say(self):
        p = np.array([0.3, -0.2, 0.5])
        slide = Motion.slide([1, 2, 3], Law(offset=0.5, slope=0.25))
        screw = Motion.screw([0, 0, 0], [0, 0, 1], 0.2, Law(slope=1, waves=[[0.1, 1, 0]]))
        f = 0.25 + 0.1 * np.cos(TAU / 4)
        np.testing.assert_allclose(moved(slide, 0.4, p), p + 0.6 * np.array([1, 2, 3]), atol=1e-15)
        right = [np.cos(f) * p[0] - np.sin(f) * p[1], np.sin(f) * p[0] + np.cos(f) * p[1], p[2] + 0.2 * f]
        np.testing.assert_allclose(moved(screw, 0.25, p), right, atol=1e-15)
        both = screw @ slide
        self.assertEqual(both.dim, 3)
        np.testing.assert_allclose(moved(both.inverse(), 0.7, moved(screw, 0.7, moved(slide, 0.7, p))), p, atol=1e-14)
        at = Motion.fixed(2, [[0, -1], [1, 0]], [3, 4])
        np.testing.assert_array_equal(moved(at, 0.5, [1, 2]), [1, 5])
        np.testing.assert_array_equal(moved(Motion.fixed(2), 0.5, [1, 2]), [1, 2])

    def test_samples_and_functions(self):
        turn = Motion.turn([1, 0], Law(slope=1))
        sampled = Motion.sampled(*turn.eval([0, 0.5, 1]))
        asked = Motion.from_function(2, lambda t: (turn.eval(t)[0][0], turn.eval(t)[1][0]), 3)
        for other in (sampled, asked):
            np.testing.assert_allclose(moved(other, 0.3, [0.4, 0.6]), moved(turn, 0.3, [0.4, 0.6]), atol=1e-14)
        with self.assertRaises(ZeroDivisionError):
            Motion.from_function(2, lambda t: 1 / 0, 3)
        with self.fails(Status.INVALID_ARGUMENT, "the motion jumps"):
            part = Part.create([0, 0], 1, [1, 1])
            Motion.from_function(2, lambda t: (np.eye(2), [t, 0]), 3, part, 0.5)
        with self.fails(Status.INVALID_ARGUMENT, "members of Cell"):
            Part.create([0, 0], 1, [1, 1], [1.7])
        with self.fails(Status.INVALID_ARGUMENT, "rotation has 1 rows; 2 are needed"):
            Motion.from_function(2, lambda t: ([[1, 0]], [0, 0]), 3)
        with self.fails(Status.INVALID_ARGUMENT, "pose 1, at time 0.5: the pose is not rigid"):
            Motion.from_function(2, lambda t: ([[1 + t, 0], [0, 1]], [0, 0]), 3)
        with self.fails(Status.INVALID_ARGUMENT, "rotations (2, 3, 3) and translations (2, 2)"):
            Motion.sampled(np.zeros((2, 3, 3)), np.zeros((2, 2)))
        with self.fails(Status.INVALID_ARGUMENT, "time 0 is 2"):
            turn.eval(2)
        with self.fails(Status.INVALID_ARGUMENT, "outer dim 2, inner dim 3"):
            turn @ Motion.fixed(3)

    def test_mechanisms(self):
        first, second = Motion.gears([[0, 0], [2, 0]], 1, 1)
        np.testing.assert_allclose(moved(first, 0.25, [1, 0]), [0, 1], atol=1e-15)
        np.testing.assert_allclose(moved(second, 0.25, [1, 0]), [2, 1], atol=1e-15)
        _, coupler, rocker = Motion.four_bar([[0, 0], [1, 0]], [0.3, 0.9, 0.7], 0, TAU, n_steps=32)
        np.testing.assert_allclose(moved(coupler, 0.5, [0.9, 0]), moved(rocker, 0.5, [0.7, 0]), atol=1e-12)
        with self.fails(Status.INVALID_ARGUMENT, "lengths has 2 entries; 3 are needed"):
            Motion.four_bar([[0, 0], [1, 0]], [0.3, 0.9], 0, TAU)


class Parts(TestCase):
    def test_grids(self):
        cells = np.full((4, 5), Cell.FREE)
        cells[0, 3] = Cell.FROZEN
        part = Part.create([-0.5, 0], 0.25, [4, 5], cells)
        self.assertEqual((part.dim, len(part), part.shape, part.cell_edge), (2, 20, (4, 5), 0.25))
        np.testing.assert_array_equal(part.cells(), cells)
        np.testing.assert_array_equal(part.corner, [-0.5, 0])
        np.testing.assert_allclose(part.centers()[1, 2], [-0.125, 0.625])
        with self.fails(Status.INVALID_ARGUMENT, "cell 2 is 3"):
            Part.create([0, 0], 1.0, [2, 2], [0, 1, 3, 0])
        with self.fails(Status.INVALID_ARGUMENT, "counts has 1 entries; 2 are needed"):
            Part.create([0, 0], 1.0, [2])

    def test_fractions(self):
        part = Part.create([-0.5, 0], 0.25, [4, 5])
        self.assertAlmostEqual(part.fractions_of_box([-0.25, 0.25], [0.25, 1.0]).sum(), 6.0, 12)
        self.assertAlmostEqual(part.fractions_of_ball([0, 0.5], 0.4, samples=32).sum() / 16, np.pi * 0.16, 2)
        self.assertAlmostEqual(part.fractions_of_cylinder([[-0.25, 0.5], [0.25, 0.5]], 0.25).sum(), 4.0, 12)
        space = Part.create([-1.5] * 3, 0.5, [6] * 3)
        self.assertAlmostEqual(space.fractions_of_mesh(cube(), samples=2).sum(), 64.0, 12)
        ball = space.fractions_of_field(made_field(3), 4.0, samples=2, n_threads=1)
        self.assertTrue(ball.shape == (6, 6, 6) and 0 < ball.sum() < 216)
        with self.fails(Status.INVALID_ARGUMENT, "radius is 0"):
            part.fractions_of_ball([0, 0], 0)

    def test_sweeps(self):
        part, table = Part.create([-0.5, 0], 0.25, [4, 5]), Part.create([-0.5, 0], 0.25, [8, 5])
        slide = Motion.slide([1, 0], Law(slope=0.5))
        first = np.zeros((4, 5), dtype=bool)
        first[0, 0] = True
        swept = part.sweep(slide, table, cells=first, options=PairOptions(n_threads=1))
        self.assertEqual(np.argwhere(swept).tolist(), [[0, 0], [1, 0], [2, 0]])
        pin = np.zeros(table.shape, dtype=bool)
        pin[2, 0] = True
        kept = part.unsweep(slide, table, body_cells=pin)
        self.assertEqual(np.argwhere(~kept).tolist(), [[0, 0], [1, 0], [2, 0]])
        left = part.unsweep(slide, table, rule=Rule.STAY_IN, kept=kept)
        np.testing.assert_array_equal(left, kept)
        with self.fails(Status.CANCELLED, "cancelled"):
            part.sweep(slide, table, progress=lambda fraction, stage: False)
        with self.fails(Status.INVALID_ARGUMENT, "cells has 3 cells; 20 are needed"):
            part.sweep(slide, table, cells=[0, 1, 1])
        with self.fails(Status.INVALID_ARGUMENT, "bools, or 0 and 1, are needed"):
            part.unsweep(slide, table, kept=np.full(20, 2))


class Meshes(TestCase):
    def test_faces_of_cells(self):
        part = Part.create([-1, 2], 0.25, [8, 6])
        ring = np.zeros(part.shape, dtype=bool)
        ring[:5, :4] = True
        ring[1:4, 1:3] = False
        mesh = part.mesh_of_cells(ring, rounds=0)
        report = mesh.report()
        self.assertEqual((mesh.dim, mesh.n_triangles, report.n_components), (2, 18 + 10, 2))
        self.assertEqual((report.closed, report.manifold, report.inside_out), (1, 1, 0))
        self.assertAlmostEqual(report.volume, 14 / 16, 12)
        self.assertEqual((report.bounds_min[:2], report.bounds_max[:2]), ([-1, 2], [0.25, 3]))
        np.testing.assert_array_equal(part.mesh_of_densities(ring.astype(float), rounds=0).vertices(), mesh.vertices())
        space = Part.create([1, 0, -1], 0.5, [3, 4, 5])
        block = np.zeros(space.shape, dtype=bool)
        block[1:, 1:3, 1:4] = True
        mesh = space.mesh_of_cells(block, rounds=0)
        self.assertEqual((mesh.dim, mesh.n_triangles, mesh.report().closed), (3, 2 * 32, 1))
        self.assertAlmostEqual(mesh.report().volume, 12 / 8, 12)

    def test_moved_meshes(self):
        part, told = Part.create([-1.2, -1.2], 0.1, [24, 24]), []
        rho = part.fractions_of_ball([0.03, -0.02], 1, samples=16)
        cells = rho > 0.5
        area = 0.01 * cells.sum()
        inner = part.mesh_of_cells(cells, progress=lambda *what: told.append(what))
        self.assertTrue(told and all(0 <= fraction <= 1 for fraction, _ in told))
        self.assertTrue(0.85 * area < inner.report().volume < area)
        self.assertEqual(part.fractions_of_mesh(inner)[~cells].sum(), 0)
        whole = part.mesh_of_cells(cells, within=Within.ANYWHERE)
        self.assertAlmostEqual(whole.report().volume, area, delta=0.02 * area)
        drawn = part.mesh_of_densities(rho, within=Within.ANYWHERE)
        self.assertAlmostEqual(drawn.report().volume, np.pi, delta=0.02 * np.pi)
        self.assertLess(part.mesh_of_densities(rho, 0.9).report().volume, inner.report().volume)

    def test_what_is_no_mesh(self):
        part = Part.create([0, 0], 1.0, [3, 3])
        cells, rho = np.eye(3, dtype=bool), np.eye(3)
        with self.fails(Status.CANCELLED, "cancelled"):
            part.mesh_of_cells(cells, progress=lambda fraction, stage: False)
        with self.fails(Status.DEGENERATE, "no cells"):
            part.mesh_of_cells(~np.ones((3, 3), dtype=bool))
        with self.fails(Status.INVALID_ARGUMENT, "cells has 2 cells; 9 are needed"):
            part.mesh_of_cells([0, 1])
        with self.fails(Status.INVALID_ARGUMENT, "within is 2"):
            part.mesh_of_cells(cells, within=2)
        with self.fails(Status.INVALID_ARGUMENT, "rounds is -1; it must not be negative"):
            part.mesh_of_densities(rho, rounds=-1)
        with self.fails(Status.INVALID_ARGUMENT, "the level is 1"):
            part.mesh_of_densities(rho, 1)
        with self.fails(Status.INVALID_ARGUMENT, "densities has 2 cells; 9 are needed"):
            part.mesh_of_densities([0, 1])
        with self.fails(Status.INVALID_ARGUMENT, "density 4 is 1.5"):
            part.mesh_of_densities(np.diag([1, 1.5, 0]))


class Pairs(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.parts = Part.create([-0.5, -0.5], 0.1, [10, 10]), Part.create([0.4, -0.5], 0.1, [10, 9])
        cls.motions = Motion.gears([[0, 0], [0.9, 0]], 1, 1)
        options = PairOptions(conflicts=Conflicts.OF_MEASURE, measure_steps=60, n_threads=1)
        told = []
        cls.pair = Pair.create(
            cls.parts[0], cls.motions[0], cls.parts[1], cls.motions[1], options, lambda *what: told.append(what)
        )
        assert told

    def test_measures(self):
        rho_1, rho_2 = np.full((10, 10), 0.5), np.ones((10, 9))
        g = self.pair.measures(rho_1, rho_2)
        l21, l12 = self.pair.local_measures(rho_1, rho_2)
        by = self.pair.sensitivities(rho_1, rho_2, n_threads=1)
        self.assertGreater(min(g), 1e-3)
        self.assertAlmostEqual(g.g12, 0.01 * (rho_1 * l21).sum(), 14)
        self.assertAlmostEqual(g.g21, 0.01 * (rho_2 * l12).sum(), 14)
        self.assertAlmostEqual(g.g12, (by.g12_by_2 * rho_2).sum(), 14)
        self.assertAlmostEqual(g.g21, (by.g21_by_1 * rho_1).sum(), 14)
        with self.fails(Status.INVALID_ARGUMENT, "density 3 of part 2 is 2"):
            rho_2[0, 3] = 2
            self.pair.measures(rho_1, rho_2)
        with self.fails(Status.INVALID_ARGUMENT, "densities of 90 and 100 cells; (100, 90) are needed"):
            self.pair.local_measures(rho_2, rho_1)

    def test_cells_more_or_less(self):
        pair, random = self.pair, np.random.default_rng(9)
        rho_1, rho_2 = (np.clip(random.uniform(-0.5, 1.5, shape), 0, 1) for shape in pair.shapes)
        by = pair.sensitivities(rho_1, rho_2)
        put = pair.topological_sensitivities(rho_1, rho_2, Change.PUT)
        take = pair.topological_sensitivities(rho_1, rho_2, Change.TAKE, n_threads=1)
        for d, more, less, rho in zip(by, put, take, (rho_1, rho_2, rho_1, rho_2)):
            np.testing.assert_allclose(more, (1 - rho) * d / 0.01, atol=1e-12)
            np.testing.assert_allclose(less, rho * d / 0.01, atol=1e-12)
        # A cell that part 2 has not is put to it.
        i = np.argmax(put.g21_by_2 * (rho_2 == 0))
        before = pair.measures(rho_1, rho_2)
        rho_2.flat[i] = 1
        after = pair.measures(rho_1, rho_2)
        self.assertGreater(put.g21_by_2.flat[i], 0)
        self.assertAlmostEqual((after.g21 - before.g21) / 0.01, put.g21_by_2.flat[i], 10)
        self.assertAlmostEqual((after.g12 - before.g12) / 0.01, put.g12_by_2.flat[i], 10)
        with self.fails(Status.INVALID_ARGUMENT, "change is 2"):
            pair.topological_sensitivities(rho_1, rho_2, 2)
        with self.fails(Status.INVALID_ARGUMENT, "densities of 90 and 100 cells; (100, 90) are needed"):
            pair.topological_sensitivities(rho_2, rho_1, Change.PUT)

    def test_pairs(self):
        pair = self.pair
        report = pair.report()
        first, second = pair.colliding()
        self.assertEqual([first.sum(), second.sum()], list(report.n_colliding))
        best = pair.cut()
        self.assertEqual(best.first.shape, (10, 10))
        self.assertAlmostEqual(best.weight, 0.01 * (best.first.sum() + best.second.sum()), 12)
        self.assertEqual(best.weight, best.bound)
        g = pair.measures(best.first.astype(float), best.second.astype(float))
        self.assertEqual(tuple(g), (0.0, 0.0))
        what = pair.volumes(best.first, best.second)
        self.assertEqual((what.n_lost, what.gamma), (0, best.gamma))
        np.testing.assert_array_equal(pair.close(best.first, best.second).first, best.first)
        members = pair.family([0, 0.5, 1], options=FamilyOptions(gap=0.01))
        self.assertEqual((members[0].gamma, members[2].gamma), (0.0, 1.0))
        self.assertTrue(all(sum(m.volumes) <= m.bound * (1 + 1e-9) for m in members))
        whole = pair.close(np.ones((10, 10)).astype(bool), start=1)
        np.testing.assert_array_equal(whole.second, members[0].second)
        heavy = pair.cut(np.ones(100), np.full(90, 1e-3))
        self.assertTrue(heavy.first.all())
        with self.fails(Status.CANCELLED, "cancelled"):
            pair.cut(progress=lambda fraction, stage: False)
        with self.fails(Status.INVALID_ARGUMENT, "weights of 3 cells; 100 are needed"):
            pair.cut([1, 2, 3])
        with self.fails(Status.INVALID_ARGUMENT, "gamma 0 is 2"):
            pair.family(2)

    def test_optimised_pairs_and_contact(self):
        found = self.pair.optimise(OptimiseOptions(n_threads=1))
        self.assertEqual(found.report.converged, 1)
        self.assertEqual(found.history.shape, (found.report.n_iterations + 1, 5))
        self.assertEqual(self.pair.volumes(found.first, found.second).n_lost, 0)
        self.assertEqual(self.pair.optimise(OptimiseOptions(max_iterations=1)).report.converged, 0)
        best, told = self.pair.cut(), []
        touch = self.pair.contact(best.first, best.second, 20, progress=lambda *what: told.append(what))
        self.assertEqual((touch.gaps.shape, touch.cells.shape, touch.places.shape), ((20,), (20, 2), (20, 2)))
        self.assertAlmostEqual(touch.mean, touch.gaps.mean(), 14)
        self.assertEqual(touch.largest, touch.gaps.max())
        self.assertTrue(told)
        self.assertTrue(best.first.reshape(-1)[touch.cells[:, 0]].all())

    def test_what_never_meets_has_no_edges(self):
        far = Part.create([50, 50], 0.1, [3, 3])
        pair = Pair.create(self.parts[0], None, far, None)
        self.assertEqual(pair.report().n_edges, 0)
        with self.assertRaises(Exception) as caught:
            Pair.create(far, None, self.motions[0], None)
        self.assertIn("ko_part", str(caught.exception))
        with pair:
            self.assertEqual(pair.report().n_cells[1], 9)
        with self.fails(Status.INVALID_ARGUMENT, "pair is NULL"):
            pair.report()


QUARTER, BACK, MIRROR = np.array([[0, -1], [1, 0]]), np.array([[0, 1], [-1, 0]]), np.diag([1, -1])


def about(center: object, turn: object) -> tuple:
    """The map x -> A x + b that turns or mirrors about a point."""
    return turn, np.asarray(center) - np.asarray(turn) @ center


def on_wheels(first: object, second: object) -> tuple:
    """A map of both wheels' frames."""
    return about([0, 0], first), about([1, 0], second)


class Choices(TestCase):
    @classmethod
    def setUpClass(cls):
        n = 24
        parts = Part.create([-0.5, -0.5], 1 / n, [n, n]), Part.create([0.5, -0.5], 1 / n, [n, n])
        first, second = Motion.gears([[0, 0], [1, 0]], 1, 1)
        # Steps that quarters of a turn carry onto each other.
        cls.pair = Pair.create(parts[0], first, parts[1], second, PairOptions(n_steps=400))
        cls.plain = cls.pair.cut()

    def assert_maximal(self, first, second):
        self.assertEqual(self.pair.volumes(first, second).n_lost, 0)
        closed = self.pair.close(first, second, start=1)
        np.testing.assert_array_equal(closed.first, first)
        np.testing.assert_array_equal(closed.second, second)

    def test_symmetric_pairs(self):
        half = FamilyOptions(symmetries=[on_wheels(-np.eye(2), -np.eye(2))])
        best = self.pair.cut(options=half)
        self.assertEqual(best.weight, best.bound)
        self.assertAlmostEqual(best.weight, self.plain.weight, 12)
        for cells in (best.first, best.second):
            np.testing.assert_array_equal(cells[::-1, ::-1], cells)
        self.assert_maximal(best.first, best.second)
        # Weights that are not symmetric: the best symmetric pair is lighter. The maps are copied.
        random, turn = np.random.default_rng(5), QUARTER.astype(float)
        weights = [random.choice([1.0, 2.0], shape) for shape in self.pair.shapes]
        options = FamilyOptions(symmetries=[on_wheels(turn, BACK), on_wheels(MIRROR, MIRROR)], symmetry_excess=1e-3)
        turn[:] = 0
        gc.collect()
        heavy, plain = self.pair.cut(*weights, options), self.pair.cut(*weights)
        self.assertTrue(0.5 * plain.weight < heavy.weight < plain.weight)
        self.assertFalse((np.rot90(plain.first) == plain.first).all())
        members = self.pair.family([0, 0.4, 1], options=options)
        self.assertEqual((members[0].gamma, members[2].gamma), (0, 1))
        for pair in (heavy, *members):
            for cells in (pair.first, pair.second):
                np.testing.assert_array_equal(np.rot90(cells), cells)
                np.testing.assert_array_equal(cells[:, ::-1], cells)
            self.assert_maximal(pair.first, pair.second)
        options.symmetries = None
        np.testing.assert_array_equal(self.pair.cut(*weights, options).first, plain.first)

    def test_what_is_no_symmetry(self):
        quarters = on_wheels(QUARTER, BACK)
        with self.fails(Status.INVALID_ARGUMENT, "map 0 does not carry conflicts onto conflicts"):
            self.pair.cut(options=FamilyOptions(symmetries=[on_wheels(QUARTER, QUARTER)]))
        with self.fails(Status.INVALID_ARGUMENT, "symmetry 1: the map takes cell 0 of part 2"):
            self.pair.family(0.5, options=FamilyOptions(symmetries=[quarters, (quarters[0], quarters[0])]))
        with self.fails(Status.INVALID_ARGUMENT, "excess of edges is 1"):
            self.pair.cut(options=FamilyOptions(symmetries=[quarters], symmetry_excess=1))
        with self.fails(Status.INVALID_ARGUMENT, "reserved is 1"):
            self.pair.cut(options=FamilyOptions(reserved=1))
        space = np.eye(3), np.zeros(3)
        with self.fails(Status.INVALID_ARGUMENT, "symmetries have 24 numbers each; 12 are needed in dim 2"):
            self.pair.cut(options=FamilyOptions(symmetries=[(space, space)]))
        with self.fails(Status.INVALID_ARGUMENT, "symmetry 1 has 24 numbers; 12, as symmetry 0 has, are needed"):
            FamilyOptions(symmetries=[quarters, (space, space)])
        with self.fails(Status.INVALID_ARGUMENT, "the matrix of symmetry 0 has 1 rows; 2 are needed"):
            FamilyOptions(symmetries=[(quarters[0], ([[1, 0]], [0, 0]))])
        with self.assertRaisesRegex(AttributeError, "no option n_symmetries"):
            FamilyOptions(n_symmetries=1)

    def test_persistent_pairs(self):
        first, second, n, told = self.plain.first, self.plain.second, 60, []
        options = PersistenceOptions(n_times=n, max_tries=40, n_threads=1)
        found = self.pair.more_persistent(first, second, options=options, progress=lambda *what: told.append(what))
        self.assertTrue(told and found.after >= found.before and 0 < found.n_tries <= 40)
        self.assertEqual(found.first.sum() + found.second.sum(), first.sum() + second.sum())
        self.assert_maximal(found.first, found.second)
        for sets, right in (((first, second), found.before), ((found.first, found.second), found.after)):
            gaps = self.pair.contact(*sets, n).gaps
            self.assertAlmostEqual((1 / (1 + 24 * gaps)).mean(), right, 12)
        # From there on, by another scale, with weights that are alike, and between gears that are alike.
        options = PersistenceOptions(n_times=n, max_tries=10, scale=0.1, gammas=(0.25, 0.75))
        again = self.pair.more_persistent(found.first, found.second, np.full(576, 3), np.full(576, 3), options)
        gaps = self.pair.contact(found.first, found.second, n).gaps
        self.assertAlmostEqual((1 / (1 + gaps / 0.1)).mean(), again.before, 12)
        self.assertTrue(again.after >= again.before and again.n_tries <= 10)
        less = first.copy()
        less.flat[np.argmax(first)] = False
        with self.fails(Status.INVALID_ARGUMENT, "the pair collides, could grow"):
            self.pair.more_persistent(less, second)
        with self.fails(Status.INVALID_ARGUMENT, "from 0.7 to 0.3"):
            self.pair.more_persistent(first, second, options=PersistenceOptions(gammas=[0.7, 0.3]))
        with self.fails(Status.INVALID_ARGUMENT, "gammas has 1 entries; 2 are needed"):
            PersistenceOptions(gammas=[0.5])
        with self.fails(Status.INVALID_ARGUMENT, "second has 3 cells; 576 are needed"):
            self.pair.more_persistent(first, [0, 1, 1])
        with self.fails(Status.CANCELLED, "cancelled"):
            self.pair.more_persistent(first, second, progress=lambda fraction, stage: False)


class Assemblies(TestCase):
    @classmethod
    def setUpClass(cls):
        shapes, told = [(10, 10), (10, 9), (9, 10)], []
        cls.parts = [Part.create([0.9 * k - 0.5, -0.5], 0.1, shape) for k, shape in enumerate(shapes)]
        cls.motions = [Motion.turn([0.9 * k, 0], Law(slope=TAU * (-1) ** k)) for k in range(3)]
        cls.train = Assembly.create(cls.parts, cls.motions, PairOptions(n_threads=1), lambda *what: told.append(what))
        cls.all = [np.ones(shape, dtype=bool) for shape in shapes]
        assert told

    def pair(self, i, j):
        return Pair.create(self.parts[i], self.motions[i], self.parts[j], self.motions[j])

    def assert_same(self, found, right):
        self.assertEqual(len(found), len(right))
        for cells, others in zip(found, right):
            np.testing.assert_array_equal(cells, others)

    def assert_free(self, cells):
        for i, j in self.train.meetings().tolist():
            self.assertEqual(self.pair(i, j).volumes(cells[i], cells[j]).n_lost, 0)
        # Nor can any of them grow.
        self.assert_same(self.train.close(cells, [2, 0, 1]), cells)

    def test_a_train_gets_the_best(self):
        report = self.train.report()
        self.assertEqual((report.dim, report.n_parts, report.n_cells, report.n_meetings), (2, 3, 280, 2))
        self.assertTrue(report.n_edges > 100 and report.graph_bytes > 0)
        self.assertEqual(self.train.meetings().tolist(), [[0, 1], [1, 2]])
        best = self.train.arrange()
        self.assertEqual([cells.shape for cells in best.cells], [(10, 10), (10, 9), (9, 10)])
        self.assertEqual(best.weight, best.bound)
        self.assertAlmostEqual(best.weight, 0.01 * sum(cells.sum() for cells in best.cells), 12)
        self.assertGreaterEqual(best.n_cuts, 1)
        self.assert_free(best.cells)
        areas = [np.full(part.shape, 0.01) for part in self.parts]
        self.assert_same(self.train.arrange(areas).cells, best.cells)
        areas[1][:] = 10
        heavy = self.train.arrange(areas)
        self.assertTrue(heavy.cells[1].all() and heavy.weight >= 900)
        # Two parts get what a pair's cut gives.
        two = Assembly.create(self.parts[:2], self.motions[:2])
        self.assertAlmostEqual(two.arrange().weight, self.pair(0, 1).cut().weight, 12)

    def test_closure(self):
        none = [~cells for cells in self.all]
        closed = self.train.close(self.all)
        self.assertTrue(closed[0].all() and not closed[1].all())
        np.testing.assert_array_equal(closed[1], self.pair(0, 1).close(self.all[0], start=1).second)
        self.assert_same(self.train.close(none), closed)
        self.assert_free(closed)
        closed = self.train.close(self.all, [1, 0, 2])
        self.assertTrue(closed[1].all() and not closed[0].all() and not closed[2].all())
        self.assert_same(self.train.close(none, np.array([1, 2, 0])), closed)
        self.assert_free(closed)

    def test_three_that_meet_each_other(self):
        centers = [[0, 0], [0.9, 0], [0.45, 0.8]]
        parts = [Part.create(np.array(c) - 0.5, 0.1, [10, 10]) for c in centers]
        motions = [Motion.turn(c, Law(slope=TAU * (-1) ** k)) for k, c in enumerate(centers)]
        assembly, told = Assembly.create(parts, motions), []
        self.assertEqual(assembly.meetings().tolist(), [[0, 1], [0, 2], [1, 2]])
        found = assembly.arrange(progress=lambda *what: told.append(what))
        self.assertTrue(told and 0.8 * found.bound < found.weight <= found.bound)
        less = assembly.arrange(options=ArrangeOptions(max_rounds=1, max_starts=1))
        self.assertTrue(less.weight <= less.bound == found.bound and less.n_cuts <= found.n_cuts)
        self.assert_same(assembly.close(found.cells), found.cells)

    def test_parts_that_stay(self):
        # A bar slides through two blocks, and bores its way.
        bar = Part.create([0, 0, 0], 0.5, [2, 2, 2])
        blocks = [Part.create([x, -1, -1], 0.5, [2, 6, 6]) for x in (1, 2.5)]
        slide = Motion.slide([3, 0, 0], Law(slope=1))
        with Assembly.create([bar, *blocks], [slide, None, None]) as assembly:
            self.assertEqual(assembly.dim, 3)
            closed = assembly.close([np.ones(part.shape, dtype=np.uint8) for part in (bar, *blocks)])
        left = np.ones((2, 6, 6), dtype=bool)
        left[:, 2:4, 2:4] = False
        self.assert_same(closed, [np.ones((2, 2, 2), dtype=bool), left, left])
        with self.fails(Status.INVALID_ARGUMENT, "assembly is NULL"):
            assembly.report()
        # What never meets keeps all.
        alone = Assembly.create([bar, blocks[1]], [None, None])
        self.assertEqual(alone.meetings().shape, (0, 2))
        self.assertTrue(all(cells.all() for cells in alone.arrange().cells))

    def test_what_is_no_assembly(self):
        parts, motions, train = self.parts, self.motions, self.train
        with self.fails(Status.INVALID_ARGUMENT, "motions has 2 entries; 3 are needed"):
            Assembly.create(parts, motions[:2])
        with self.assertRaisesRegex(TypeError, "each must be a Part"):
            Assembly.create([*parts[:2], motions[2]], motions)
        with self.assertRaisesRegex(TypeError, "each must be a Motion or None"):
            Assembly.create(parts, [*motions[:2], parts[2]])
        with self.fails(Status.INVALID_ARGUMENT, "n_parts is 0"):
            Assembly.create([], [])
        with self.fails(Status.INVALID_ARGUMENT, "parts[0] dim 2, parts[1] dim 3"):
            Assembly.create([parts[0], Part.create([0, 0, 0], 1, [1, 1, 1])], [None, None])
        with self.fails(Status.INVALID_ARGUMENT, "part 1: a part dim 2, its motion dim 3"):
            Assembly.create(parts[:2], [None, Motion.fixed(3)])
        with self.fails(Status.INVALID_ARGUMENT, "measure_steps must be 0"):
            Assembly.create(parts, motions, PairOptions(measure_steps=5))
        with self.fails(Status.CANCELLED, "cancelled"):
            Assembly.create(parts, motions, progress=lambda fraction, stage: False)
        cold = Part.create([-0.5, -0.5], 0.1, [10, 10], np.full(100, Cell.FROZEN))
        with self.fails(Status.INVALID_ARGUMENT, "frozen cells collide"):
            Assembly.create([cold, cold], [None, None])
        with self.fails(Status.INVALID_ARGUMENT, "sets has 2 entries; 3, one for each part, are needed"):
            train.close(self.all[:2])
        with self.fails(Status.INVALID_ARGUMENT, "sets[1] has 100 cells; 90 are needed"):
            train.close([self.all[0], self.all[0], self.all[2]])
        with self.fails(Status.INVALID_ARGUMENT, "sets[2] holds int64; bools, or 0 and 1, are needed"):
            train.close([*self.all[:2], np.full(90, 2)])
        with self.fails(Status.INVALID_ARGUMENT, "the order [0, 1, 1] does not name each of 3 parts once"):
            train.close(self.all, [0, 1, 1])
        with self.fails(Status.INVALID_ARGUMENT, "order has 2 entries; 3 are needed"):
            train.close(self.all, [0, 1])
        with self.fails(Status.INVALID_ARGUMENT, "indices from 0 are needed"):
            train.close(self.all, [-1, 0, 1])
        weights = [np.ones(part.shape) for part in parts]
        weights[2][0, 0] = -1
        with self.fails(Status.INVALID_ARGUMENT, "weight 190 is -1"):
            train.arrange(weights)
        with self.fails(Status.INVALID_ARGUMENT, "weights[0] has 3 cells; 100 are needed"):
            train.arrange([np.ones(3), *weights[1:]])
        with self.fails(Status.INVALID_ARGUMENT, "0 rounds"):
            train.arrange(options=ArrangeOptions(max_rounds=0))
        with self.fails(Status.CANCELLED, "cancelled"):
            train.arrange(progress=lambda fraction, stage: False)


if __name__ == "__main__":
    unittest.main()
