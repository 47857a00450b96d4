# SPDX-License-Identifier: Apache-2.0 OR MIT
"""Keepout's main job in Python: a flower in the plane, then a torus in space, or a mesh of yours: points, a field, its values."""

from __future__ import annotations

import argparse
import sys

import numpy as np

import keepout


def flower() -> keepout.Mesh:
    """A closed curve with five petals; the solid lies on its left."""
    angle = np.linspace(0, 2 * np.pi, 500, endpoint=False)
    radius = 1 + 0.3 * np.cos(5 * angle)
    return keepout.Mesh.from_polylines(np.column_stack((radius * np.cos(angle), radius * np.sin(angle))))


def torus(ring: float = 1.0, tube: float = 0.35, along: int = 180, around: int = 64) -> keepout.Mesh:
    """Around the z axis; triangles are counter-clockwise seen from outside."""
    angle, tilt = np.meshgrid(
        np.linspace(0, 2 * np.pi, along, endpoint=False), np.linspace(0, 2 * np.pi, around, endpoint=False), indexing="ij"
    )
    radius = ring + tube * np.cos(tilt)
    vertices = np.stack((radius * np.cos(angle), radius * np.sin(angle), tube * np.sin(tilt)), axis=-1).reshape(-1, 3)
    here = np.arange(along * around).reshape(along, around)
    ahead, above = np.roll(here, -1, axis=0), np.roll(here, -1, axis=1)
    across = np.roll(ahead, -1, axis=1)
    triangles = np.concatenate((np.stack((here, ahead, across), -1), np.stack((here, across, above), -1))).reshape(-1, 3)
    return keepout.Mesh.from_triangles(vertices, triangles)


class Show:
    """A bar on a terminal, elsewhere a line for each stage."""

    def __init__(self) -> None:
        self.stage = ""

    def __call__(self, fraction: float, stage: str) -> None:
        if sys.stderr.isatty():
            end = "\n" if fraction == 1 else ""
            print(f"\r[{'#' * int(40 * fraction):40}] {fraction:4.0%} {stage:12.12}", end=end, file=sys.stderr, flush=True)
        elif stage != self.stage:
            print(f"{fraction:4.0%} {stage}", file=sys.stderr, flush=True)
        self.stage = stage


def differ(field: keepout.Field, points: keepout.Array, gradients: keepout.Array) -> float:
    """How far gradients are from central differences of values."""
    step = 1e-5
    axes = step * np.eye(field.dim)
    differences = [(field(points + axis) - field(points - axis)) / (2 * step) for axis in axes]
    return float(np.abs(np.stack(differences, axis=-1) - gradients).max())


def work(mesh: keepout.Mesh, n_points: int) -> None:
    """Fits a field to the mesh and prints it along its box's diagonal, a tenth beyond either end."""
    if mesh.report().inside_out:
        mesh.flip()
    with mesh.sample(n_points, seed=1) as cloud:
        field = keepout.Field.fit(cloud, progress=Show())
    report = field.report()
    control_points = " x ".join(str(n) for n in report.control_points[: field.dim])
    print(f"\n{report.n_points} points, dimension {field.dim}, {control_points} control points, {report.seconds_solve:.2f} s")
    print(f"|phi| at the points: {report.rms:.1e} D rms, {report.max:.1e} D at most; D = {report.diagonal:.4g}")

    low, high = (np.array(corner[: field.dim]) for corner in (report.box_min, report.box_max))
    points = low + np.linspace(-0.1, 1.1, 9)[:, None] * (high - low)
    values, gradients, hessians = field.eval(points, derivatives=2)
    distances = mesh.signed_distance(points)
    curvatures = np.trace(keepout.unpack_hessians(hessians), axis1=1, axis2=2)
    print(f"{'point':>{9 * field.dim}} {'phi':>9} {'distance':>9} {'|grad|':>7} {'trace H':>9}  box")
    lengths = np.linalg.norm(gradients, axis=1)
    for point, phi, distance, length, trace, outside in zip(
        points, values, distances, lengths, curvatures, field.outside_box(points)
    ):
        place = "".join(f"{x:9.3f}" for x in point)
        print(f"{place} {phi:9.4f} {distance:9.4f} {length:7.3f} {trace:9.3f}  {'outside' if outside else 'in'}")
    difference = differ(field, points, gradients)
    print(f"gradients differ from central differences by at most {difference:.1e}")
    if not difference <= 1e-5:
        sys.exit("fit_field.py: the gradients are wrong: 1e-5 is allowed")


def main() -> None:
    """Reads the arguments."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("mesh", nargs="?", help="OBJ, STL, PLY or OFF file")
    parser.add_argument("--points", type=int, default=10000, help="points to sample (default: %(default)s)")
    arguments = parser.parse_args()
    print(f"Keepout {keepout.version()}")
    try:
        for mesh in [keepout.Mesh.read(arguments.mesh)] if arguments.mesh else [flower(), torus()]:
            work(mesh, arguments.points)
    except keepout.Error as error:
        sys.exit(f"fit_field.py: {error}")


if __name__ == "__main__":
    main()
