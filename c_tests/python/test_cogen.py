"""The Python module: motions, parts and pairs of co-generation."""

import unittest

import numpy as np

from keepout import Cell, Conflicts, FamilyOptions, Law, Motion, OptimiseOptions, Pair, PairOptions, Part, Rule, Status
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
        with self.fails(Status.INVALID_ARGUMENT, "rotation has 1 rows; 2 are needed"):
            Motion.from_function(2, lambda t: ([[1, 0]], [0, 0]), 3)
        with self.fails(Status.INVALID_ARGUMENT, "pose 1, at time 0.5: the pose is not rigid"):
            Motion.from_function(2, lambda t: ([[1 + t, 0], [0, 1]], [0, 0]), 3)
        with self.fails(Status.INVALID_ARGUMENT, "rotations (2, 3, 3) and translations (2, 2)"):
            Motion.sampled(np.zeros((2, 3, 3)), np.zeros((2, 2)))
        with self.fails(Status.INVALID_ARGUMENT, "time 0 is 2"):
            turn.eval(2)
        with self.fails(Status.INVALID_ARGUMENT, "outer has dim 2, inner has dim 3"):
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


if __name__ == "__main__":
    unittest.main()
