"""The Python module: every call, in space and in the plane, its errors, and who owns what."""

import copy
import gc
import pathlib
import pickle
import tempfile
import threading
import unittest
import weakref

import numpy as np

import keepout
from keepout import Aggregate, Aggregation, Body, Cloud, Constraints, Error, Field, FitOptions, Mesh, Rotation, Scale, Status

CUBE = np.array([[x, y, z] for z in (-1.0, 1.0) for y in (-1.0, 1.0) for x in (-1.0, 1.0)])
CUBE_TRIANGLES = np.array(
    [0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6]
).reshape(12, 3)
# The square [-1, 1]^2 around the square hole [-0.5, 0.5]^2.
FRAME = np.array([[-2, -2], [2, -2], [2, 2], [-2, 2], [-1, -1], [-1, 1], [1, 1], [1, -1]]) / 2


def cube() -> Mesh:
    return Mesh.from_triangles(CUBE, CUBE_TRIANGLES)


def frame() -> Mesh:
    return Mesh.from_polylines(FRAME, [0, 4])


def small_fit(n: int = 8, **settings: object) -> FitOptions:
    return FitOptions(control_points=n, n_threads=1, **settings)


class TestCase(unittest.TestCase):
    def fails(self, status: Status, words: str):
        """The block raises an Error with this status and these words."""
        test = self

        class Fails:
            def __enter__(self):
                return self

            def __exit__(self, kind, error, trace):
                test.assertIsInstance(error, Error)
                test.assertEqual(error.status, status)
                test.assertIn(words, str(error))
                return True

        return Fails()


class Geometry(TestCase):
    def test_versions_are_told(self):
        self.assertRegex(keepout.version(), r"^\d+\.\d+\.\d+$")
        self.assertEqual(keepout.abi_version(), keepout.ABI_VERSION)
        self.assertTrue(keepout.capabilities() & keepout.Capability.SPACE)
        self.assertEqual(keepout.status_string(Status.IO), "KO_ERR_IO")

    def test_status_names_are_those_of_c(self):
        for status in Status:
            name = f"KO_{status.name}" if status >= 0 else f"KO_ERR_{status.name}"
            self.assertEqual(keepout.status_string(status), name)

    def test_mesh(self):
        mesh = cube()
        self.assertEqual((mesh.dim, mesh.n_vertices, mesh.n_triangles), (3, 8, 12))
        np.testing.assert_array_equal(mesh.vertices(), CUBE)
        np.testing.assert_array_equal(mesh.triangles(), CUBE_TRIANGLES)
        mesh.flip()
        self.assertEqual(mesh.report().inside_out, 1)
        mesh.flip()
        self.assertAlmostEqual(mesh.report().volume, 8.0)
        self.assertIn("bounds_max=(1.0, 1.0, 1.0)", repr(mesh.report()))
        np.testing.assert_allclose(mesh.signed_distance([[2, 0, 0], [0, 0, 0]]), [1, -1])

    def test_cloud(self):
        cloud = cube().sample(300, seed=1)
        self.assertEqual((cloud.dim, len(cloud)), (3, 300))
        points, normals = cloud.points(), cloud.normals()
        np.testing.assert_allclose(np.einsum("ij,ij->i", points, normals), 1)
        triangles, barycentric = cloud.origins()
        corners = CUBE[CUBE_TRIANGLES[triangles]]
        np.testing.assert_allclose(np.einsum("ij,ijk->ik", barycentric, corners), points, atol=1e-15)
        again = Cloud.from_points(points, 5 * normals)
        np.testing.assert_allclose(again.normals(), normals)
        with self.fails(Status.INVALID_ARGUMENT, "made from points"):
            again.origins()

    def test_plane(self):
        mesh = frame()
        self.assertEqual((mesh.dim, mesh.n_vertices, mesh.n_triangles), (2, 8, 8))
        np.testing.assert_array_equal(mesh.vertices(), FRAME)
        np.testing.assert_allclose(mesh.signed_distance([[0, 0], [0.75, 0]]), [0.5, -0.25])
        self.assertEqual(Mesh.from_polylines([[0, 0], [1, 0]], kind=keepout.Polylines.OPEN).n_triangles, 1)
        cloud = mesh.sample(400, seed=1)
        self.assertEqual((cloud.dim, cloud.points().shape, cloud.normals().shape), (2, (400, 2), (400, 2)))
        self.assertEqual(cloud.origins().barycentric.shape, (400, 2))
        self.assertEqual(Cloud.from_points(cloud.points(), cloud.normals()).dim, 2)


    def test_polylines(self):
        points, starts, closed = frame().polylines()
        np.testing.assert_array_equal(points, FRAME)
        self.assertEqual((list(starts), list(closed)), ([0, 4], [True, True]))
        self.assertEqual([len(loop) for loop in frame().polylines().split()], [5, 5])
        line = Mesh.from_polylines([[0, 0], [1, 0]], kind=keepout.Polylines.OPEN).polylines()
        self.assertEqual(list(line.closed), [False])
        with self.fails(Status.INVALID_ARGUMENT, ""):
            cube().polylines()

    def test_written_meshes(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "wü.ply"
            cube().write(path)
            np.testing.assert_array_equal(Mesh.read(path).vertices(), CUBE)
            with self.fails(Status.UNSUPPORTED, "cube.txt"):
                cube().write(pathlib.Path(folder) / "cube.txt")

    def test_normals(self):
        angle = np.linspace(0, 2 * np.pi, 300, endpoint=False)
        circle = np.column_stack((np.cos(angle), np.sin(angle)))
        ball = np.random.default_rng(5).normal(size=(1000, 3))
        for shape in (circle, ball / np.linalg.norm(ball, axis=1)[:, None]):
            points = np.vstack((shape, shape[:1]))
            heard = []
            options = keepout.NormalOptions(neighbours=8, n_threads=1)
            cloud, flags, report = Cloud.estimate_normals(points, options, lambda *told: heard.append(told[0]))
            self.assertEqual((cloud.dim, len(cloud), heard[-1]), (points.shape[1], len(points), 1.0))
            self.assertTrue(flags[-1] & keepout.Point.COPY)
            self.assertEqual(report.n_copies, 1)
            self.assertGreater(np.einsum("ij,ij->i", cloud.normals(), points).min(), 0.8)
            plain = Cloud.from_points(points).normals()
            np.testing.assert_array_equal(Cloud.estimate_normals(points).cloud.normals(), plain)
            with self.fails(Status.CANCELLED, "cancelled"):
                Cloud.estimate_normals(points, progress=lambda *_: False)
        with self.fails(Status.INVALID_ARGUMENT, "neighbours"):
            Cloud.estimate_normals(circle, keepout.NormalOptions(neighbours=2))
        with self.fails(Status.INVALID_ARGUMENT, "dim is 4"):
            Cloud.from_points(np.ones((5, 4)))

    def test_smoothing(self):
        angle = np.linspace(0, 2 * np.pi, 500, endpoint=False)
        circle = np.column_stack((np.cos(angle), np.sin(angle)))
        random = np.random.default_rng(7)
        ball = random.normal(size=(1500, 3))

        def error(cloud: Cloud) -> float:
            return np.abs(np.linalg.norm(cloud.points(), axis=1) - 1).mean()

        for normals in (circle, ball / np.linalg.norm(ball, axis=1)[:, None]):
            cloud = Cloud.from_points(normals + random.uniform(-0.02, 0.02, normals.shape), normals)
            once, heard = cloud.smooth(), []
            options = keepout.SmoothOptions(rounds=3, n_threads=1)
            thrice = cloud.smooth(options, lambda *told: heard.append(told[0]))
            self.assertEqual((once.dim, len(once), heard[-1]), (cloud.dim, len(cloud), 1.0))
            self.assertLess(error(once), 0.75 * error(cloud))
            self.assertLess(error(thrice), error(once))
            with self.fails(Status.CANCELLED, "cancelled"):
                cloud.smooth(progress=lambda *_: False)
            with self.fails(Status.INVALID_ARGUMENT, "neighbours is 3"):
                cloud.smooth(keepout.SmoothOptions(neighbours=3))

    def test_sides(self):
        np.testing.assert_allclose(cube().sample(1000).sides([[0, 0, 0], [1.5, 0, 0], [9, 9, 9]]), [-1, 1, 1], atol=0.25)
        plane = frame().sample(400)
        np.testing.assert_allclose(plane.sides([[0, 0], [0.75, 0]]), [1, -1], atol=0.25)
        self.assertEqual(plane.sides(np.empty((0, 2))).shape, (0,))
        line = Cloud.from_points(np.column_stack((np.linspace(-1, 1, 200), np.zeros(200))), np.tile([0.0, 1.0], (200, 1)))
        np.testing.assert_allclose(line.sides([[0, 0.05], [0, -0.05], [0, 20]]), [1, -1, 0], atol=0.15)
        self.assertAlmostEqual(Field.fit(plane, small_fit(16)).report().clear_sides, 1)
        angle = np.linspace(0, np.pi, 200)
        half = np.column_stack((np.cos(angle), np.sin(angle)))
        self.assertLess(Field.fit(Cloud.from_points(half, half), small_fit(16)).report().clear_sides, 0.9)
        with self.fails(Status.INVALID_ARGUMENT, "points has the shape (1, 3); [n, 2] is needed"):
            plane.sides([[0, 0, 0]])
        with self.fails(Status.INVALID_ARGUMENT, "point 1 is "):
            plane.sides([[0, 0], [0, np.nan]])


class Fields(TestCase):
    def check_derivatives(self, field: Field, half: float) -> None:
        """Central differences against gradients and Hessians, inside the box and out of it."""
        points = np.random.default_rng(1).uniform(-half, half, (50, field.dim))
        values, gradients, hessians = field.eval(points, derivatives=2)
        matrices = keepout.unpack_hessians(hessians)
        np.testing.assert_array_equal(field(points), values)
        step = 1e-5
        for i, axis in enumerate(step * np.eye(field.dim)):
            ahead, behind = field.eval(points + axis), field.eval(points - axis)
            np.testing.assert_allclose((ahead[0] - behind[0]) / (2 * step), gradients[:, i], atol=1e-7)
            np.testing.assert_allclose((ahead[1] - behind[1]) / (2 * step), matrices[:, i], atol=2e-2)

    def test_space(self):
        field = Field.fit(cube().sample(500, seed=1), small_fit())
        report = field.report()
        self.assertEqual((field.dim, report.n_unknowns, tuple(report.control_points)), (3, 512, (8, 8, 8)))
        points = [[0, 0, 0], [1.1, 0.2, 0], [5, 5, 5]]
        self.assertEqual(list(np.sign(field(points))), [-1, 1, 1])
        self.assertEqual(list(field.outside_box(points)), [False, False, True])
        self.check_derivatives(field, 1.5)

    def test_plane(self):
        field = Field.fit(frame().sample(400, seed=1), small_fit(16))
        self.assertEqual((field.dim, field.report().n_unknowns), (2, 256))
        points = [[0, 0], [0.75, 0.1], [5, 5]]
        self.assertEqual(list(np.sign(field(points))), [1, -1, 1])
        self.assertEqual(list(field.outside_box(points)), [False, False, True])
        self.check_derivatives(field, 1.5)

    def test_one_point_none_and_what_is_not_contiguous(self):
        field = Field.fit(cube().sample(300), small_fit(6))
        self.assertEqual(field([0, 0, 0]).shape, (1,))
        self.assertEqual([array.shape for array in field.eval(np.empty((0, 3)), 2)], [(0,), (0, 3), (0, 6)])
        points = np.random.default_rng(2).uniform(-1, 1, (20, 3))
        np.testing.assert_array_equal(field(np.asfortranarray(points)), field(points))
        np.testing.assert_array_equal(field(np.repeat(points, 2, axis=0)[::2]), field(points))
        np.testing.assert_array_equal(field(points.astype(">f8")), field(points))

    def test_caller_s_arrays_are_written(self):
        field = Field.fit(cube().sample(300), small_fit(6))
        points = np.random.default_rng(3).uniform(-1, 1, (6000, 3))
        right = field.eval(points, derivatives=2)
        arrays = [np.empty_like(array) for array in right]
        field.eval_into(points, *arrays, n_threads=2)
        for array, expected in zip(arrays, right):
            np.testing.assert_array_equal(array, expected)
        gradients = np.empty((6000, 3))
        field.eval_into(points, gradients=gradients)
        np.testing.assert_array_equal(gradients, right[1])

    def test_files(self):
        field = Field.fit(frame().sample(300), small_fit())
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "fält.kof"
            field.save(path)
            loaded = Field.load(path)
        self.assertEqual(loaded.dim, 2)
        np.testing.assert_array_equal(loaded(FRAME), field(FRAME))

    def test_refits(self):
        cloud = cube().sample(500, seed=1)
        field = Field.fit(cloud, small_fit())
        again = field.refit(Cloud.from_points(cloud.points() + 1e-3, cloud.normals()), small_fit(5))
        self.assertEqual(again.report().n_unknowns, 512)
        self.assertLess(again.report().iterations, field.report().iterations)
        with self.fails(Status.CANCELLED, "cancelled"):
            field.refit(cloud, progress=lambda *_: False)
        with self.fails(Status.INVALID_ARGUMENT, "dim"):
            field.refit(frame().sample(100))

    def test_control_points(self):
        for cloud in (cube().sample(300), frame().sample(300)):
            field = Field.fit(cloud, small_fit((7, 8, 9)))
            report, control_points = field.report(), field.control_points()
            self.assertEqual(control_points.shape, (7, 8, 9)[: field.dim])
            low, high = (np.array(corner)[: field.dim] for corner in (report.box_min, report.box_max))
            made = Field.from_control_points(control_points, low, high, report.diagonal)
            np.testing.assert_array_equal(made.control_points(), control_points)
            points = np.random.default_rng(6).uniform(-1, 1, (20, field.dim))
            np.testing.assert_allclose(made(points), field(points), atol=1e-12)
            with self.fails(Status.INVALID_ARGUMENT, "box_min 4"):
                Field.from_control_points(control_points, np.zeros(4), high, 1)

    def test_lattices(self):
        field = Field.fit(cube().sample(300), small_fit(6))
        origin, steps = np.array([-1, -1, 0.1]), np.array([[0.5, 0, 0], [0, 0.2, 0.1]])
        values, gradients = field.eval_lattice(origin, steps, (4, 5), n_threads=2)
        points = origin + np.stack(np.meshgrid(np.arange(4), np.arange(5), indexing="ij"), -1).reshape(-1, 2) @ steps
        right = field.eval(points)
        np.testing.assert_allclose(values, right[0].reshape(4, 5), atol=1e-12)
        np.testing.assert_allclose(gradients, right[1].reshape(4, 5, 3), atol=1e-12)
        self.assertEqual(len(field.eval_lattice(origin, steps, (4, 5), derivatives=0)), 1)
        with self.fails(Status.INVALID_ARGUMENT, "2 steps and 1 counts"):
            field.eval_lattice(origin, steps, (4,))
        with self.fails(Status.INVALID_ARGUMENT, "derivatives is 2"):
            field.eval_lattice(origin, steps, (4, 5), derivatives=2)

    def test_level_sets(self):
        field = Field.fit(cube().sample(500, seed=1), small_fit(margin=0.5))
        heard = []
        mesh, open_at_box = field.level_set(0.0, progress=lambda *told: heard.append(told[0]))
        self.assertEqual((mesh.report().closed, open_at_box, heard[-1]), (1, False, 1.0))
        np.testing.assert_allclose(field(mesh.vertices()), 0, atol=1e-8)
        self.assertTrue(field.level_set(0.6).open_at_box)
        coarse = field.level_set(0.0, keepout.LevelSetOptions(subdivisions=1, n_threads=1)).mesh
        self.assertLess(coarse.n_triangles, mesh.n_triangles)
        with self.fails(Status.DEGENERATE, ""):
            field.level_set(100.0)
        plane = Field.fit(frame().sample(400, seed=1)).level_set().mesh
        self.assertEqual(list(plane.polylines().closed), [True, True])

    def test_certificates(self):
        mesh = cube()
        field = Field.fit(mesh.sample(500, seed=1), small_fit())
        heard = []
        found = field.certify(mesh, 0.1, 0.05, progress=lambda *told: heard.append(told[0]))
        self.assertEqual((found.side_certified, found.budget_reached, found.n_components, heard[-1]), (1, 0, 1, 1.0))
        self.assertGreater(found.threshold, max(0.05, found.largest_found))
        self.assertEqual(field(found.place)[0], found.largest_found)
        options = keepout.CertifyOptions(max_boxes=1, tolerance=1e-4, n_threads=1)
        self.assertEqual(field.certify(mesh, 0.1, 0.05, options).budget_reached, 1)
        self.assertEqual(field.certify(Mesh.from_triangles(CUBE, CUBE_TRIANGLES[:11]), 0.1).side_certified, 0)
        with self.fails(Status.INVALID_ARGUMENT, "clearance"):
            field.certify(mesh, -1.0)
        with self.assertRaises(ZeroDivisionError):
            field.certify(mesh, 0.1, progress=lambda *_: 1 / 0)
        np.testing.assert_array_equal(frame().component_points(), FRAME[[0, 4]])

    def test_feasible_side(self):
        cloud = cube().sample(300)
        inside = Field.fit(cloud, small_fit(feasible=keepout.Feasible.INSIDE))
        self.assertGreater(inside([0, 0, 0])[0], 0)

    def test_weights_and_robust_fits(self):
        cloud = cube().sample(400, seed=1)
        points, normals, weights = cloud.points(), cloud.normals(), np.ones(400)
        points[:5] *= 0.5
        weights[:5] = 0
        cloud = Cloud.from_points(points, normals)
        robust = Field.fit(cloud, small_fit(reweighting=keepout.Reweight.ROBUST))
        self.assertGreaterEqual(robust.report().n_outliers, 5)
        cloud.set_weights(weights)
        self.assertEqual(Field.fit(cloud, small_fit()).report().n_points, 395)

    def test_many_threads_may_evaluate(self):
        field = Field.fit(cube().sample(300), small_fit(6))
        points = np.random.default_rng(4).uniform(-1, 1, (20000, 3))
        right = field(points)
        found = [np.empty(0)] * 4

        def evaluate(i: int) -> None:
            found[i] = field(points)

        threads = [threading.Thread(target=evaluate, args=(i,)) for i in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for values in found:
            np.testing.assert_array_equal(values, right)


def made_field(dim: int) -> Field:
    """About a ball of radius 0.6, not quite round, on the box [-1, 1]^dim; without a fit."""
    places = np.stack(np.meshgrid(*[np.arange(-1.4, 1.5, 0.4)] * dim, indexing="ij"), -1)
    numbers = np.sqrt((places**2).sum(-1) + 0.05) - 0.6 + 0.05 * np.sin(3 * places).sum(-1)
    return Field.from_control_points(numbers, -np.ones(dim), np.ones(dim), 2.5)


def rotated(q: np.ndarray, points: np.ndarray) -> np.ndarray:
    """By the quaternion w, x, y, z."""
    w, v = q[0], q[1:]
    cross = np.cross(v, points)
    return points + 2 * (w * cross + np.cross(v, cross)) / (q @ q)


class Bounding(TestCase):
    def test_aggregates(self):
        numbers = np.array([0.5, 0.1, 0.3])
        for kind in (Aggregate.KS, Aggregate.INDUCED_EXPONENTIAL, Aggregate.P_NORM):
            for side in keepout.Side:
                of = Aggregation(kind=kind, side=side, sharpness=20)
                value, gradient, packed = keepout.aggregate(numbers, 2.0, of, derivatives=2)
                below, above = keepout.aggregation_bounds(3, of, numbers.min() / 2)
                self.assertTrue(-2 * below - 1e-14 <= value - numbers.min() <= 2 * above + 1e-14)
                hessian = np.zeros((3, 3))
                hessian[np.tril_indices(3)] = packed
                hessian += np.tril(hessian, -1).T
                for i, axis in enumerate(1e-5 * np.eye(3)):
                    ahead = keepout.aggregate(numbers + axis, 2.0, of, derivatives=1)
                    behind = keepout.aggregate(numbers - axis, 2.0, of, derivatives=1)
                    np.testing.assert_allclose((ahead[0] - behind[0]) / 2e-5, gradient[i], atol=1e-7)
                    np.testing.assert_allclose((ahead[1] - behind[1]) / 2e-5, hessian[i], atol=1e-5)
        minimum = Aggregation(kind=Aggregate.MINIMUM)
        self.assertEqual(keepout.aggregate(numbers, 1, minimum, keepout.Extreme.LARGEST), (0.5,))
        self.assertEqual(keepout.aggregate(numbers, 1), keepout.aggregate(numbers, 1, Aggregation()))
        self.assertEqual(keepout.aggregation_bounds(3).above, 0)
        with self.fails(Status.UNSUPPORTED, "not smooth"):
            keepout.aggregate(numbers, 1, minimum, derivatives=2)
        with self.fails(Status.INVALID_ARGUMENT, "no values"):
            keepout.aggregate([], 1)
        with self.fails(Status.INVALID_ARGUMENT, "derivatives is 3"):
            keepout.aggregate(numbers, 1, derivatives=3)
        with self.fails(Status.INVALID_ARGUMENT, "n_values is -1"):
            keepout.aggregation_bounds(-1)
        with self.fails(Status.INVALID_ARGUMENT, "sharpness is 0"):
            keepout.aggregation_bounds(3, Aggregation(sharpness=0))
        with self.assertRaisesRegex(AttributeError, "there is no option rho; there are sharpness, kind, side"):
            Aggregation(rho=3)

    def test_bodies(self):
        for points in (FRAME, CUBE):
            body = Body.from_points(points, 0.5)
            self.assertEqual((body.dim, len(body), body.covering_radius), (points.shape[1], 8, 0.5))
            np.testing.assert_array_equal(body.points(), points)
        mesh = frame()
        body = Body.from_mesh(mesh, 0.1)
        np.testing.assert_allclose(mesh.signed_distance(body.points()), 0, atol=1e-14)
        self.assertEqual((body.dim, body.covering_radius), (2, 0.1))
        self.assertEqual(len(Body.from_mesh(cube(), 10)), 8)
        with self.fails(Status.INVALID_ARGUMENT, "covering_radius is -1"):
            Body.from_points(CUBE, -1)
        with self.fails(Status.INVALID_ARGUMENT, "covering_radius is 0"):
            Body.from_mesh(mesh, 0)
        with self.fails(Status.INVALID_ARGUMENT, "dim is 4"):
            Body.from_points(np.zeros((3, 4)))
        body.close()
        with self.fails(Status.INVALID_ARGUMENT, "body is NULL"):
            len(body)

    def check_derivatives(self, constraints: Constraints, x: np.ndarray) -> None:
        """All forms of the Jacobian agree, with differences of the values too, and the Hessian with those of the Jacobian."""
        n, m, n_jacobian, n_hessian = constraints.size()
        values, entries = constraints.values_and_jacobian(x)
        np.testing.assert_allclose(constraints.values(x), values, atol=1e-13)
        np.testing.assert_array_equal(constraints.jacobian(x), entries)
        pattern, dense = constraints.jacobian_pattern(), constraints.dense_jacobian(x)
        self.assertEqual((len(entries), pattern.rows.dtype, dense.shape), (n_jacobian, np.int32, (m, n)))
        scattered = np.zeros((m, n))
        scattered[pattern] = entries
        np.testing.assert_array_equal(scattered, dense)
        random = np.random.default_rng(5)
        v, w = random.uniform(-1, 1, n), random.uniform(-1, 1, m)
        np.testing.assert_allclose(constraints.jacobian_times(x, v), dense @ v, atol=1e-12)
        np.testing.assert_allclose(constraints.transposed_jacobian_times(x, w), w @ dense, atol=1e-12)

        pairs, triangle = constraints.hessian_pattern(), constraints.hessian(x, w)
        self.assertTrue(len(triangle) == n_hessian and (pairs.columns <= pairs.rows).all())
        hessian = np.zeros((n, n))
        hessian[pairs] = triangle
        hessian += np.tril(hessian, -1).T
        for i, axis in enumerate(1e-5 * np.eye(n)):
            difference = (constraints.values(x + axis) - constraints.values(x - axis)) / 2e-5
            np.testing.assert_allclose(difference, dense[:, i], atol=1e-6)
            ahead, behind = (constraints.transposed_jacobian_times(x + by, w) for by in (axis, -axis))
            np.testing.assert_allclose((ahead - behind) / 2e-5, hessian[i], atol=1e-3)

    def test_constraints_in_space(self):
        field, body = made_field(3), Body.from_points(np.random.default_rng(7).uniform(-0.4, 0.4, (30, 3)))
        each, points = Aggregation(kind=Aggregate.NONE), body.points()
        constraints = Constraints.create()
        moving = constraints.add_frame(Rotation.QUATERNION, Scale.FREE)
        path = constraints.add_points(5)
        still = constraints.add_fixed_frame([0.1, 0.2, 0.3, 1.5], scale=Scale.FREE)
        self.assertEqual((moving, path, still), (1, 0, 2))
        self.assertEqual(constraints.keep_body(body, moving, field, still, each), 0)
        self.assertEqual(constraints.keep_points(path, field, keepout.WORLD, each), 30)
        self.assertEqual(constraints.keep_body(body, moving, field, aggregation=Aggregation(sharpness=20)), 35)
        self.assertEqual(constraints.keep_points(path, field, moving, Aggregation(sharpness=20)), 36)
        self.assertEqual(constraints.size()[:2], (8 + 15, 37))
        self.assertEqual(constraints.frame_variables(moving), slice(0, 8))
        self.assertEqual(constraints.frame_variables(still), slice(0, 0))
        self.assertEqual(constraints.points_variables(path), slice(8, 23))
        x = np.random.default_rng(8).uniform(0.2, 0.6, 23)
        x[7] = 1.2
        world = 1.2 * rotated(x[3:7], points) + x[:3]
        values = constraints.values(x)
        np.testing.assert_allclose(values[:30], 1.5 * field((world - [0.1, 0.2, 0.3]) / 1.5), atol=1e-13)
        np.testing.assert_allclose(values[30:35], field(x[8:].reshape(5, 3)), atol=1e-13)
        ks = keepout.aggregate(field(world), field.report().diagonal, Aggregation(sharpness=20))
        np.testing.assert_allclose(values[35], ks[0], atol=1e-13)
        # Body and field may go before.
        body.close()
        field.close()
        np.testing.assert_array_equal(constraints.values(x), values)
        self.check_derivatives(constraints, x)

    def test_constraints_in_sets_of_fields(self):
        random = np.random.default_rng(7)
        body, box = Body.from_points(random.uniform(-0.4, 0.4, (30, 2))), np.ones(2)
        fields = made_field(2), Field.from_control_points(random.uniform(-0.5, 0.5, (9, 8)), -box, box, 3.0)
        each, hard = Aggregation(kind=Aggregate.NONE), Aggregation(kind=Aggregate.MINIMUM)
        smooth, points = Aggregation(sharpness=20), body.points()
        constraints = Constraints.create(2)
        moving, path = constraints.add_frame(Rotation.ANGLE), constraints.add_points(3)
        Extreme, keep_body = keepout.Extreme, constraints.keep_body_in_fields
        keep_points = constraints.keep_points_in_fields
        self.assertEqual(keep_body(body, moving, fields, Extreme.LARGEST, smooth, aggregation=each), 0)
        self.assertEqual(keep_body(body, moving, fields, Extreme.LEAST, smooth, keepout.WORLD, smooth), 30)
        self.assertEqual(keep_points(path, fields, Extreme.LEAST, smooth, moving, each), 31)
        self.assertEqual(keep_points(path, list(fields[:1]), Extreme.LARGEST), 34)
        x = np.array([0.1, -0.2, 0.7, 0.3, 0.1, -0.2, 0.2, 0.4, -0.3])
        turn = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
        values, world = constraints.values(x), points @ turn.T + x[:2]
        largest = np.maximum(*(field(world) for field in fields))
        self.assertTrue((values[:30] <= largest + 1e-13).all() and (values[:30] > largest - 3.0 * np.log(2) / 20 - 1e-13).all())
        self.assertLess(values[30], min(field(world).min() for field in fields) + 1e-13)
        self.check_derivatives(constraints, x)
        keep_body(body, keepout.WORLD, fields, Extreme.LARGEST, hard, aggregation=each)
        largest = np.maximum(*(field(points) for field in fields))
        np.testing.assert_allclose(constraints.values(x)[35:], largest, atol=1e-13)
        with self.fails(Status.INVALID_ARGUMENT, "0 fields are given"):
            keep_points(path, [], Extreme.LEAST)
        with self.fails(Status.INVALID_ARGUMENT, "field 1 of fields dim 3"):
            keep_body(body, moving, [fields[0], made_field(3)], Extreme.LEAST)
        with self.fails(Status.INVALID_ARGUMENT, "no combination"):
            keep_body(body, moving, fields, Extreme.LEAST, each)
        with self.assertRaises(TypeError):
            keep_points(path, [body], Extreme.LEAST)
        fields[1].close()
        with self.fails(Status.INVALID_ARGUMENT, "field 1 of fields is NULL"):
            keep_points(path, fields, Extreme.LEAST)

    def test_constraints_are_written_to_the_caller_s_arrays(self):
        field, constraints = made_field(2), Constraints.create(2)
        keep = (field, keepout.WORLD, Aggregation(kind=Aggregate.NONE))
        constraints.keep_points(constraints.add_points(3), *keep)
        for n in (3, 5):  # sizes follow what is added
            x = np.linspace(-0.5, 0.5, 2 * n)
            values, entries = np.empty(n), np.empty(2 * n)
            constraints.values_into(x, values)
            constraints.jacobian_into(x, entries)
            np.testing.assert_array_equal(values, field(x.reshape(n, 2)))
            np.testing.assert_array_equal(entries, field.eval(x.reshape(n, 2))[1].ravel())
            both = np.zeros(n), np.zeros(2 * n)
            constraints.values_and_jacobian_into(x, *both)
            np.testing.assert_array_equal(both[0], constraints.values(x))
            np.testing.assert_array_equal(both[1], constraints.jacobian(x))
            with self.fails(Status.INVALID_ARGUMENT, f"values is float64 (1,); an array of float64 ({n},)"):
                constraints.values_into(x, np.empty(1))
            with self.fails(Status.INVALID_ARGUMENT, "entries is NoneType"):
                constraints.jacobian_into(x, None)
            constraints.keep_points(constraints.add_points(2), *keep)
        constraints.close()
        with self.fails(Status.INVALID_ARGUMENT, "constraints is NULL"):
            constraints.values(x)

    def test_constraints_in_the_plane(self):
        field, body = made_field(2), Body.from_points(np.random.default_rng(7).uniform(-0.4, 0.4, (30, 2)))
        constraints = Constraints.create(2)
        frames = [constraints.add_frame(Rotation.ANGLE, Scale.FREE), constraints.add_frame()]
        constraints.keep_body(body, frames[0], field, frames[1], Aggregation(sharpness=20, kind=Aggregate.P_NORM))
        constraints.keep_body(body, frames[1], field, frames[0], Aggregation(kind=Aggregate.NONE))
        x = np.array([0.1, -0.2, 0.7, 1.2, 0.3, 0.1])
        turn = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
        inside = (body.points() + x[4:] - x[:2]) @ turn / 1.2
        np.testing.assert_allclose(constraints.values(x)[1:], 1.2 * field(inside), atol=1e-13)
        self.check_derivatives(constraints, x)

    def test_constraints_are_checked(self):
        field, body = made_field(3), Body.from_points(CUBE)
        constraints = Constraints.create()
        moving = constraints.add_frame(Rotation.QUATERNION)
        constraints.keep_body(body, moving, field)
        x = np.array([0, 0, 0, 1, 0, 0, 0])
        with self.fails(Status.INVALID_ARGUMENT, "x has 6 entries; there are 7 variables"):
            constraints.values(x[:6])
        with self.fails(Status.INVALID_ARGUMENT, "x has the shape (1, 7); [n] is needed"):
            constraints.jacobian(x[None])
        with self.fails(Status.INVALID_ARGUMENT, "jacobian has 6 entries"):
            constraints.dense_jacobian(x[:6])
        with self.fails(Status.INVALID_ARGUMENT, "v has 6 entries; 7 are needed"):
            constraints.jacobian_times(x, x[:6])
        with self.fails(Status.INVALID_ARGUMENT, "w has 7 entries; there are 1 values"):
            constraints.transposed_jacobian_times(x, x)
        with self.fails(Status.INVALID_ARGUMENT, "lambda has 7 entries"):
            constraints.hessian(x, x)
        with self.fails(Status.INVALID_ARGUMENT, "quaternion of length 0"):
            constraints.values(0 * x)
        with self.fails(Status.INVALID_ARGUMENT, "no frame 5"):
            constraints.keep_body(body, 5, field)
        with self.fails(Status.INVALID_ARGUMENT, "frame is -1"):
            constraints.keep_body(body, -1, field)
        with self.fails(Status.INVALID_ARGUMENT, "no set of points 0"):
            constraints.keep_points(0, field)
        with self.fails(Status.INVALID_ARGUMENT, "the field dim 2"):
            constraints.keep_body(body, moving, made_field(2))
        with self.fails(Status.INVALID_ARGUMENT, "has 2 parameters; such a frame has 3"):
            constraints.add_fixed_frame([1, 2])
        with self.fails(Status.INVALID_ARGUMENT, "0 points"):
            constraints.add_points(0)
        with self.fails(Status.INVALID_ARGUMENT, "not by an angle"):
            constraints.add_frame(Rotation.ANGLE)
        with self.fails(Status.INVALID_ARGUMENT, "dim is 4"):
            Constraints.create(4)
        with self.assertRaises(Exception) as caught:
            constraints.keep_body(field, moving, field)
        self.assertIn("ko_body", str(caught.exception))
        constraints.close()
        with self.fails(Status.INVALID_ARGUMENT, "constraints is NULL"):
            constraints.values(x)


class Sensitivities(TestCase):
    def test_derivatives_by_the_cloud(self):
        mesh = cube()
        cloud = mesh.sample(500, seed=1)
        np.testing.assert_array_equal(cloud.follow(mesh).points(), cloud.points())
        field = keepout.Field.fit(cloud, small_fit())
        kept = field.refit(cloud, small_fit(reweighting=keepout.Reweight.KEEP))
        self.assertAlmostEqual(kept.report().rms, field.report().rms, delta=1e-3)
        sensitivity = keepout.Sensitivity.create(field, cloud, small_fit())
        point = [1.1, 0.5, 0.6]
        by = sensitivity.solve(point)
        self.assertEqual(by.normals.shape, (500, 3))
        twice = sensitivity.solve(point, [2.0], FitOptions(n_threads=2))
        np.testing.assert_array_equal(twice.points, 2 * by.points)
        by_vertices = cloud.pull_back(mesh, by.points, by.normals)
        np.testing.assert_allclose(by_vertices.sum(axis=0), by.points.sum(axis=0), atol=1e-9)
        self.assertTrue((cloud.pull_back(mesh) == 0.0).all())
        with self.fails(Status.INVALID_ARGUMENT, "weights has 2 rows"):
            sensitivity.solve(point, [1.0, 2.0])
        with self.fails(Status.INVALID_ARGUMENT, "d_points has 499 rows"):
            cloud.pull_back(mesh, by.points[1:])
        with self.fails(Status.CANCELLED, "cancelled"):
            sensitivity.solve(point, progress=lambda fraction, stage: False)
        sensitivity.close()
        with self.fails(Status.INVALID_ARGUMENT, "sensitivity is NULL"):
            sensitivity.solve(point)


class Formulations(TestCase):
    def test_formulas(self):
        cloud = cube().sample(2000, seed=1)
        points = [[0.1, 0.2, 1.1], [0.9, 0.0, -0.1]]
        smooth = keepout.Explicit.create(cloud)
        self.assertGreater(smooth.smoothing, 0.0)
        np.testing.assert_allclose(smooth(points), [0.1, -0.1], atol=1e-2)
        options = keepout.ExplicitOptions(formulation=keepout.Formulation.NEAREST_PLANE)
        values, gradients = keepout.Explicit.create(cloud, options).eval(points)
        np.testing.assert_allclose(values, [0.1, -0.1], atol=1e-14)
        np.testing.assert_allclose(gradients, [[0, 0, 1], [1, 0, 0]], atol=1e-14)
        self.assertEqual(keepout.Explicit.create(frame().sample(100)).dim, 2)
        options.n_nearest = 2
        with self.fails(Status.INVALID_ARGUMENT, "n_nearest"):
            keepout.Explicit.create(cloud, options)
        smooth.close()
        with self.fails(Status.INVALID_ARGUMENT, "formula is NULL"):
            smooth(points)

    def test_separation(self):
        a, b, apart = cube(), cube(), [5, 0.5, 6]
        by_distance, by_length = np.empty((8, 3)), np.empty((8, 3))
        found = keepout.separation(a, b, apart, distance_gradients=by_distance, length_gradients=by_length)
        self.assertAlmostEqual(found.minimum_distance, 5.0)
        np.testing.assert_allclose(by_distance.sum(axis=0), found.distance_by_translation, atol=1e-15)
        np.testing.assert_array_equal(by_length, 0)
        self.assertLessEqual(keepout.separation(a, b, apart, sharpness=1000.0).minimum_distance, found.minimum_distance)
        self.assertAlmostEqual(keepout.separation(a, b, [1.5, 1.25, 0.5]).intersection_length, 5.5)
        with self.fails(Status.UNSUPPORTED, "mesh_b"):
            keepout.separation(a, frame())
        for wrong in ({"translation": [1, 2]}, {"translation": np.empty((0, 3))}, {"length_gradients": by_length[:7]}):
            with self.fails(Status.INVALID_ARGUMENT, next(iter(wrong))):
                keepout.separation(a, b, **wrong)


class ProgressIsHeard(TestCase):
    def test_progress(self):
        heard = []
        Field.fit(cube().sample(300), small_fit(), lambda fraction, stage: heard.append((fraction, stage)))
        fractions = [fraction for fraction, _ in heard]
        self.assertEqual((fractions, fractions[-1]), (sorted(fractions), 1.0))
        self.assertIn("solve", [stage for _, stage in heard])

    def test_false_cancels(self):
        with self.fails(Status.CANCELLED, "cancelled"):
            Field.fit(cube().sample(300), small_fit(), lambda fraction, stage: fraction < 0.5)

    def test_exceptions_come_out(self):
        for when in (0.0, 0.5, 1.0):

            def stop(fraction: float, stage: str) -> None:
                if fraction >= when:
                    raise KeyboardInterrupt(stage)

            with self.assertRaises(KeyboardInterrupt):
                Field.fit(cube().sample(300), small_fit(), stop)

    def test_exceptions_that_are_false_come_out(self):
        class Empty(Exception):
            def __len__(self) -> int:
                return 0

        def stop(*_: object) -> None:
            raise Empty

        with self.assertRaises(Empty):
            Field.fit(cube().sample(300), small_fit(), stop)

    def test_nothing_that_was_heard_is_kept(self):
        class Witness:
            pass

        def fit(cloud: Cloud, stops: bool) -> weakref.ref:
            witness = Witness()

            def progress(*_: object, held: Witness = witness) -> None:
                if stops:
                    raise KeyboardInterrupt

            try:
                Field.fit(cloud, small_fit(), progress)
            except KeyboardInterrupt:
                pass
            return weakref.ref(witness)

        cloud = cube().sample(300)
        gc.collect()
        gc.disable()
        try:
            self.assertIsNone(fit(cloud, stops=False)())
            self.assertIsNone(fit(cloud, stops=True)())
        finally:
            gc.enable()

    def test_what_cancels(self):
        cloud = cube().sample(300)
        for answer in (False, np.False_):
            with self.fails(Status.CANCELLED, "cancelled"):
                Field.fit(cloud, small_fit(), lambda *_: answer)
        for answer in (None, 0, True, np.True_):
            Field.fit(cloud, small_fit(), lambda *_: answer)


class Errors(TestCase):
    def test_files(self):
        with self.fails(Status.IO, "no-such-file.obj"):
            Mesh.read("no-such-file.obj")
        with self.fails(Status.IO, "no-such-file.kof"):
            Field.load("no-such-file.kof")
        with self.fails(Status.INVALID_ARGUMENT, "zero byte"):
            Mesh.read("a\0b.obj")

    def test_shapes(self):
        with self.fails(Status.INVALID_ARGUMENT, "vertices has the shape (7, 2); [n, 3] is needed"):
            Mesh.from_triangles(np.zeros((7, 2)), CUBE_TRIANGLES)
        with self.fails(Status.INVALID_ARGUMENT, "4 points come with 3 normals"):
            Cloud.from_points(np.ones((4, 3)), np.ones((3, 3)))
        with self.fails(Status.INVALID_ARGUMENT, "points has the shape (3,)"):
            Cloud.from_points(np.ones(3), np.ones(3))
        with self.fails(Status.INVALID_ARGUMENT, "dim is 4"):
            Cloud.from_points(np.ones((5, 4)), np.ones((5, 4)))
        cloud = cube().sample(300)
        with self.fails(Status.INVALID_ARGUMENT, "2 weights"):
            cloud.set_weights([1, 1])
        with self.fails(Status.INVALID_ARGUMENT, "[n] is needed"):
            cloud.set_weights(np.ones((300, 1)))

    def test_indices(self):
        for indices in (CUBE_TRIANGLES - 1, CUBE_TRIANGLES.astype(float), CUBE_TRIANGLES + 2**32):
            with self.fails(Status.INVALID_ARGUMENT, "indices from 0 are needed"):
                Mesh.from_triangles(CUBE, indices)
        with self.fails(Status.INVALID_ARGUMENT, "triangle 2"):
            Mesh.from_triangles(CUBE[:7], CUBE_TRIANGLES)
        with self.fails(Status.INVALID_ARGUMENT, "loop_starts holds int"):
            Mesh.from_polylines(FRAME, [-4, 0])
        with self.fails(Status.INVALID_ARGUMENT, "start"):
            Mesh.from_polylines(FRAME, [4, 0])

    def test_counts(self):
        for n in (-1, 0):
            with self.fails(Status.INVALID_ARGUMENT, ""):
                cube().sample(n)
        with self.fails(Status.INVALID_ARGUMENT, "n_threads is -1"):
            FitOptions(n_threads=-1)
        with self.fails(Status.INVALID_ARGUMENT, "control_points is -8"):
            FitOptions(control_points=(8, -8))
        self.assertEqual(tuple(FitOptions(control_points=(8, 9)).control_points), (8, 9, 0))
        for counts in ((), (8, 9, 10, 11)):
            with self.fails(Status.INVALID_ARGUMENT, f"control_points has {len(counts)} entries"):
                FitOptions(control_points=counts)

    def test_numbers_that_c_has_no_room_for(self):
        too_many = "4294967295 is the largest"
        for make, words in (
            (lambda: FitOptions(control_points=2**32 + 20), too_many),
            (lambda: FitOptions(n_threads=2**32), too_many),
            (lambda: FitOptions(feasible=2**32 + 1), "feasible is 4294967297; 2147483647 is the largest"),
            (lambda: FitOptions(feasible=-(2**31) - 1), "feasible is -2147483649"),
            (lambda: FitOptions(max_unknowns=2**64), "max_unknowns is 18446744073709551616"),
            (lambda: Constraints.create(2**32 + 2), "dim is 4294967298"),
            (lambda: Constraints.create().add_frame(2**32), "rotation is 4294967296"),
            (lambda: Constraints.create().frame_variables(2**32), "frame is 4294967296"),
            (lambda: cube().sample(2**64 + 10), "n_points is"),
            (lambda: cube().sample(10, seed=2**64 + 5), "seed is"),
            (lambda: cube().sample(10, seed=-1), "seed is -1"),
            (lambda: Mesh.from_polylines(FRAME, [0, 4], 2**32), "kind is"),
            (lambda: made_field(3).eval(np.zeros((3, 3)), n_threads=2**32 + 1), too_many),
            (lambda: Field.from_control_points(np.ones((5, 5)), [0, 0], [1, 1], 1.0, 2**32), "feasible is"),
            (lambda: keepout.aggregate([1.0], 1.0, extreme=2**32), "extreme is"),
        ):
            with self.fails(Status.INVALID_ARGUMENT, words):
                make()
        self.assertEqual(len(cube().sample(10, seed=2**64 - 1)), 10)

    def test_arrays_that_are_not_plain(self):
        field = made_field(2)
        right = field([[0.25, 0.5], [0.1, 0.2]])
        unaligned = np.frombuffer(bytearray(33), dtype=np.float64, count=4, offset=1).reshape(2, 2)
        self.assertTrue(unaligned.flags.c_contiguous and not unaligned.flags.aligned)
        unaligned[:] = [[0.25, 0.5], [0.1, 0.2]]
        np.testing.assert_array_equal(field(unaligned), right)
        with self.fails(Status.INVALID_ARGUMENT, "values must be C-contiguous, aligned and writeable"):
            field.eval_into(unaligned, unaligned.reshape(-1)[:2])
        with self.fails(Status.INVALID_ARGUMENT, "points holds complex128; real numbers are needed"):
            field(np.array([[0.25 + 1e-20j, 0.5]]))
        with self.fails(Status.INVALID_ARGUMENT, "points holds complex128"):
            Cloud.from_points([[1j, 0]])
        with self.fails(Status.INVALID_ARGUMENT, "control_points holds complex128"):
            Field.from_control_points(np.ones((5, 5), dtype=complex), [0, 0], [1, 1], 1.0)
        with self.fails(Status.INVALID_ARGUMENT, "points has masked entries"):
            field(np.ma.masked_array([[0.25, 0.5]], mask=[[True, False]]))
        with self.fails(Status.INVALID_ARGUMENT, "triangles has masked entries"):
            Mesh.from_triangles(CUBE, np.ma.masked_array(CUBE_TRIANGLES, mask=CUBE_TRIANGLES == 3))
        np.testing.assert_array_equal(field(np.ma.masked_array([[0.25, 0.5], [0.1, 0.2]])), right)

    def test_errors_travel(self):
        error = pickle.loads(pickle.dumps(Error(Status.IO, "no such file")))
        self.assertEqual((type(error), error.status, str(error)), (Error, Status.IO, "no such file"))
        newer = Error(-999, "of a newer library")
        self.assertEqual((newer.status, str(newer)), (-999, "of a newer library"))
        self.assertEqual(pickle.loads(pickle.dumps(newer)).status, -999)

    def test_a_library_without_a_call_is_too_old(self):
        with self.assertRaisesRegex(ImportError, r"libkeepout \d+\.\d+\.\d+, is too old for this module: it has no ko_no_such_call"):
            keepout._bind("ko_no_such_call", None)

    def test_options(self):
        with self.assertRaisesRegex(AttributeError, "there is no option marign; there are .*margin"):
            FitOptions(marign=0.3)
        with self.fails(Status.INVALID_ARGUMENT, "margin"):
            Field.fit(cube().sample(300), FitOptions(margin=-1))

    def test_evaluation(self):
        field = Field.fit(cube().sample(300), small_fit(6))
        points = np.zeros((2, 3))
        with self.fails(Status.INVALID_ARGUMENT, "points has the shape (2, 2); [n, 3] is needed"):
            field(points[:, :2])
        with self.fails(Status.INVALID_ARGUMENT, "values is float64 (1,); an array of float64 (2,)"):
            field.eval_into(points, np.empty(1))
        with self.fails(Status.INVALID_ARGUMENT, "gradients is float32"):
            field.eval_into(points, gradients=np.empty((2, 3), dtype=np.float32))
        with self.fails(Status.INVALID_ARGUMENT, "gradients must be C-contiguous"):
            field.eval_into(points, gradients=np.empty((2, 3), order="F"))
        with self.fails(Status.INVALID_ARGUMENT, "values is list"):
            field.eval_into(points, [0.0, 0.0])
        with self.fails(Status.INVALID_ARGUMENT, "derivatives is 3"):
            field.eval(points, derivatives=3)
        points[1, 2] = np.nan
        with self.fails(Status.INVALID_ARGUMENT, "point 1 "):
            field(points)

    def test_types_are_not_mixed_up(self):
        with self.assertRaises(Exception) as caught:
            Field.fit(cube())
        self.assertIn("ko_cloud", str(caught.exception))


class Ownership(TestCase):
    def test_closed_handles_are_refused(self):
        with cube() as mesh:
            cloud = mesh.sample(300)
        mesh.close()
        with self.fails(Status.INVALID_ARGUMENT, "mesh is NULL"):
            mesh.flip()
        field = Field.fit(cloud, small_fit(6))
        cloud.close()
        with self.fails(Status.INVALID_ARGUMENT, "cloud is NULL"):
            len(cloud)
        field.close()
        with self.fails(Status.INVALID_ARGUMENT, "field is NULL"):
            field([0, 0, 0])

    def test_handles_have_one_owner(self):
        cloud = cube().sample(300)
        body, constraints = Body.from_points(CUBE), Constraints.create()
        for handle in (cube(), cloud, made_field(3), body, constraints, keepout.Explicit.create(cloud)):
            for take in (copy.copy, copy.deepcopy, pickle.dumps):
                with self.assertRaisesRegex(TypeError, f"a {type(handle).__name__} cannot be copied"):
                    take(handle)

    def test_the_last_reference_frees(self):
        mesh = cube()
        finalizer = mesh._finalizer
        self.assertTrue(finalizer.alive)
        del mesh
        gc.collect()
        self.assertFalse(finalizer.alive)


if __name__ == "__main__":
    unittest.main()
