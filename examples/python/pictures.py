# SPDX-License-Identifier: Apache-2.0 OR MIT
"""The pictures of docs/pictures.md: figures 3, 4, 6 and 7 of Dunn et al. (2023) made with this library, and curves of the plane.

They need matplotlib. Where the test data are not, a knot takes the bunny's place, and the curves are left out.
"""

from __future__ import annotations

import argparse
import io
import os
import pathlib
import sys
import time
from typing import Callable, NamedTuple, Optional

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.colors import Normalize
from PIL import Image

import keepout
import raster
from keepout import Array, Field, FitOptions, Mesh

LEVELS = (-0.01, -0.005, 0.0, 0.005, 0.01)
"""In units of D."""
LARGE = 250_000
"""Bytes of a picture that is worth a palette."""
INK, EXACT, FITTED = "#222222", "#c0392b", "#1f5f99"


class Sizes(NamedTuple):
    """How much is done."""

    samples: int
    """Points of the clouds in space."""
    held_out: int
    """Points at which errors are taken."""
    control_points: tuple[int, int, int]
    factors: int
    """Weights in a sweep."""
    pixels: int
    """Width and height of a surface's picture."""
    lattice: int
    """Points along an axis of a contour plot."""


FULL = Sizes(25000, 20000, (31, 31, 26), 13, 520, 400)
QUICK = Sizes(1500, 500, (12, 12, 10), 3, 60, 40)


class Solid(NamedTuple):
    """The shape of figures 6 and 7."""

    mesh: Mesh
    name: str


class Studio:
    """Where pictures go, and what they are made of."""

    def __init__(self, out: pathlib.Path, data: pathlib.Path, sizes: Sizes) -> None:
        self.out, self.data, self.sizes = out, data, sizes
        self.start = time.monotonic()
        out.mkdir(parents=True, exist_ok=True)

    def tell(self, text: str) -> None:
        """Progress, with the seconds since the start."""
        print(f"{time.monotonic() - self.start:6.1f} s  {text}", flush=True)

    def save(self, figure: plt.Figure, name: str, dpi: int = 100) -> None:
        """Closes the figure."""
        buffer = io.BytesIO()
        figure.savefig(buffer, dpi=dpi, format="png", facecolor="white", bbox_inches="tight", pad_inches=0.1)
        plt.close(figure)
        self.save_image(Image.open(buffer), name)

    def save_image(self, image: Image.Image, name: str) -> None:
        """As a PNG, of 256 dithered colours where it would be large with all of them."""
        path = self.out / name
        image = image.convert("RGB")
        image.save(path, optimize=True)
        if path.stat().st_size > LARGE:
            palette = image.quantize(256, method=Image.Quantize.MAXCOVERAGE)
            image.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG).save(path, optimize=True)
        self.tell(f"{path} ({path.stat().st_size / 1000:.0f} kB)")

    def solid(self) -> Solid:
        """The bunny that the paper's authors ship, or a knot."""
        path = self.data / "stanford/bunny_lsdo_genie.stl"
        return Solid(Mesh.read(path), path.name) if path.exists() else Solid(knot(), "a knot")


def knot(along: int = 400, around: int = 40) -> Mesh:
    """A tube around a trefoil; triangles are counter-clockwise seen from outside."""
    t = np.linspace(0, 2 * np.pi, along, endpoint=False)
    centre = np.stack((np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)), axis=-1)
    ahead = np.roll(centre, -1, axis=0) - np.roll(centre, 1, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    side = np.cross(ahead, (0.0, 0.0, 1.0))
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    up = np.cross(side, ahead)
    tilt = np.linspace(0, 2 * np.pi, around, endpoint=False)[None, :, None]
    vertices = centre[:, None] + 0.45 * (np.cos(tilt) * side[:, None] + np.sin(tilt) * up[:, None])
    here = np.arange(along * around).reshape(along, around)
    next_, above = np.roll(here, -1, axis=0), np.roll(here, -1, axis=1)
    across = np.roll(next_, -1, axis=1)
    triangles = np.concatenate((np.stack((here, next_, across), -1), np.stack((here, across, above), -1))).reshape(-1, 3)
    mesh = Mesh.from_triangles(vertices.reshape(-1, 3), triangles)
    if mesh.report().inside_out:
        mesh.flip()
    return mesh


# ---- The plane


def box_of(field: Field) -> tuple[Array, Array]:
    """Lower and upper corner of the field's box."""
    report = field.report()
    return np.array(report.box_min)[: field.dim], np.array(report.box_max)[: field.dim]


def grid(low: Array, high: Array, n: int) -> tuple[Array, Array, Array]:
    """Points [n * n, 2] of a rectangle, x slowest, and its x and y as contour plots take them."""
    x, y = np.linspace(low[0], high[0], n), np.linspace(low[1], high[1], n)
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    return points, x, y


def explicit(cloud: keepout.Cloud, points: Array, rho: float) -> Array:
    """(1) of the paper, by Hicken and Kaur: distances to the planes of the points, the nearest of which weigh most."""
    values = np.empty(len(points))
    for some in np.array_split(np.arange(len(points)), len(points) // 1000 + 1):
        away = points[some, None, :] - cloud.points()
        distance = np.linalg.norm(away, axis=2)
        weights = np.exp(-rho * (distance - distance.min(axis=1, keepdims=True)))
        values[some] = (weights * np.einsum("ijk,jk->ij", away, cloud.normals())).sum(1) / weights.sum(1)
    return values


def started(field: Field, cloud: keepout.Cloud, rho: float) -> Field:
    """The field that the paper's fit starts from: control points of the value of (1) where they lie, on the box of `field`."""
    low, high = box_of(field)
    counts = np.array(field.control_points().shape)
    steps = (high - low) / (counts - 3)
    places = np.stack(np.meshgrid(*(low[a] + steps[a] * (np.arange(n) - 1) for a, n in enumerate(counts)), indexing="ij"), -1)
    values = explicit(cloud, places.reshape(-1, field.dim), rho)
    return Field.from_control_points(values.reshape(counts), low, high, field.report().diagonal)


def figure_3(studio: Studio) -> None:
    """A rectangle: the field that the paper starts from, and the fitted one."""
    half = np.array((3.0, 2.0))
    mesh = Mesh.from_polylines(half * [(-1, -1), (1, -1), (1, 1), (-1, 1)])
    cloud = mesh.sample(400, seed=1)
    # So few control points with the usual smoothness leave waves outside the corners.
    field = Field.fit(cloud, FitOptions(control_points=(40, 30), margin=1.6, lambda_smooth=3e-8))
    spacing = 20 / len(cloud)
    # One over the distance between points: with a larger one, one of the points nearest to a corner wins outside it.
    begun = started(field, cloud, rho=len(cloud) / mesh.report().area)
    points, x, y = grid(-half - 2.6, half + 2.6, studio.sizes.lattice)
    exact = mesh.signed_distance(points).reshape(len(x), -1)
    levels = (-1, 0, 1, 2)
    figure, axes = plt.subplots(1, 2, figsize=(11, 5.0), layout="constrained", sharey=True)
    counts = " x ".join(str(n) for n in field.control_points().shape)
    for axis, shown, title in zip(axes, (begun, field), ("before the fit: control points by (1)", "fitted")):
        values = shown(points).reshape(exact.shape)
        axis.contour(x, y, exact.T, levels, colors=EXACT, linestyles="dashed", linewidths=1.1)
        lines = axis.contour(x, y, values.T, levels, colors=FITTED, linestyles="solid", linewidths=1.8)
        axis.clabel(lines, fmt="%g", fontsize=10)
        worst = np.abs(shown(cloud.points())).max()
        axis.set_title(f"{title}\nlargest |phi| on the rectangle {worst:.2g}", fontsize=11)
        axis.set_aspect("equal")
        axis.set_xlabel("x")
    axes[0].set_ylabel("y")
    handles = [plt.Line2D([], [], color=FITTED, lw=1.8), plt.Line2D([], [], color=EXACT, lw=1.1, ls="dashed")]
    labels = [f"phi, {counts} control points", "exact distance"]
    figure.legend(handles, labels, loc="upper center", bbox_to_anchor=(0.5, 0), ncols=2, frameon=False)
    studio.save(figure, "figure_3.png")


def circles() -> Mesh:
    """Five of them, three on the x axis."""
    centres = ((-2.6, 0, 1.0), (0.1, 0, 0.55), (2.7, 0, 1.25), (-0.8, 1.7, 0.5), (0.6, -1.8, 0.65))
    angle = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    loops = [np.column_stack((x + r * np.cos(angle), y + r * np.sin(angle))) for x, y, r in centres]
    return Mesh.from_polylines(np.vstack(loops), 400 * np.arange(len(loops)))


def figure_4(studio: Studio) -> None:
    """Circles: contours of phi on the exact distance, and both along the x axis."""
    mesh = circles()
    field = Field.fit(mesh.sample(1500, seed=1), FitOptions(control_points=(60, 37)))
    low, high = box_of(field)
    points, x, y = grid(low, high, studio.sizes.lattice)
    exact, values = (f(points).reshape(len(x), -1) for f in (mesh.signed_distance, field))
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(9, 8.6), layout="constrained", height_ratios=(2.1, 1), sharex=True)
    reach = 1.75
    extent = (low[0], high[0], low[1], high[1])
    image = top.imshow(exact.T, origin="lower", extent=extent, cmap="RdBu", norm=Normalize(-reach, reach), aspect="equal")
    figure.colorbar(image, ax=top, label="exact distance", extend="both")
    lines = top.contour(x, y, values.T, np.arange(-1, 2.01, 0.25), colors=INK, linewidths=0.6, linestyles="solid")
    top.contour(x, y, values.T, [0], colors=INK, linewidths=2)
    top.clabel(lines, lines.levels[::2], fmt="%g", fontsize=8)
    top.axhline(0, color=INK, lw=0.8, ls="dotted")
    top.set_title("contours of phi on the exact distance")
    top.set_ylabel("y")
    along = np.linspace(low[0], high[0], 4 * studio.sizes.lattice)
    line = np.column_stack((along, np.zeros_like(along)))
    bottom.axhline(0, color="#999999", lw=0.8)
    bottom.plot(along, field(line), color="#7fb2dc", lw=4, label="phi")
    bottom.plot(along, mesh.signed_distance(line), color=EXACT, lw=1.2, ls="dashed", label="exact distance")
    bottom.set_xlabel("x, at y = 0")
    bottom.legend(frameon=False, ncols=2, loc="upper center")
    bottom.margins(x=0, y=0.18)
    studio.save(figure, "figure_4.png")


def airfoil(path: pathlib.Path) -> Array:
    """Points [n, 2], counter-clockwise: a line of title, then x and y a line."""
    rows = [line.split()[:2] for line in path.read_text().splitlines()[1:]]
    return np.array([[float(number) for number in row] for row in rows if len(row) == 2])


def site(path: pathlib.Path) -> Array:
    """Corners [n, 2] of a wind farm in km, counter-clockwise: lines like `- [10363.8, 6490.3]`, clockwise."""
    lines = path.read_text().split("boundaries:")[1].splitlines()
    corners = [line.strip()[3:-1].split(",") for line in lines if line.strip().startswith("- [")]
    return np.array([[float(number) / 1000 for number in corner] for corner in corners])[::-1]


def figure_curves(studio: Studio) -> None:
    """Airfoils, and the boundary of a wind farm."""
    folder = studio.data / "curves2d"
    if not folder.is_dir():
        studio.tell("curves.png left out: there are no data")
        return
    figure = plt.figure(figsize=(13, 4.4), layout="constrained")
    rows = [["naca0012", "clarky", "site"], ["rae2822", "s1223", "site"]]
    axes = figure.subplot_mosaic(rows, gridspec_kw={"width_ratios": (1, 1, 0.62)})
    titles = {"naca0012": "NACA 0012", "clarky": "Clark Y", "rae2822": "RAE 2822", "s1223": "S1223", "site": "Borssele IIIa, km"}
    for name, axis in axes.items():
        if name == "site":
            mesh = Mesh.from_polylines(site(folder / "iea37-boundary-cs3.yaml"))
            levels, margin = np.arange(-2, 2.1, 0.5), 0.35
        else:
            mesh = Mesh.from_polylines(airfoil(folder / f"{name}.dat"))
            levels, margin = np.arange(-0.06, 0.121, 0.02), 2.5
        field = Field.fit(mesh.sample(studio.sizes.samples // 10, seed=1), FitOptions(margin=margin))
        low, high = box_of(field)
        if name != "site":
            low, high = np.array((-0.15, -0.15)), np.array((1.15, 0.25))
        points, x, y = grid(low, high, studio.sizes.lattice)
        values = field(points).reshape(len(x), -1)
        reach = np.abs(levels).max()
        axis.contourf(x, y, values.T, levels, cmap="RdBu", norm=Normalize(-reach, reach), extend="both")
        axis.contour(x, y, values.T, levels, colors="white", linewidths=0.5, linestyles="solid")
        axis.contour(x, y, values.T, [0], colors=INK, linewidths=1.8)
        worst = np.abs(field(mesh.sample(studio.sizes.held_out // 10, seed=2).points())).max() / field.report().diagonal
        axis.set_title(f"{titles[name]}: |phi| at most {worst:.1g} D", fontsize=10)
        axis.set_aspect("equal")
    studio.save(figure, "curves.png")


# ---- Space


class Probe(NamedTuple):
    """Points at one distance from the surface."""

    offset: float
    """In units of D."""
    points: Array
    exact: Array
    """[n]: exact distances"""


def probes(solid: Solid, studio: Studio) -> list[Probe]:
    """Points on and off the surface, not those of the fit, and the exact distances there."""
    cloud = solid.mesh.sample(studio.sizes.held_out, seed=2)
    d = diagonal(solid.mesh)
    moved = [(offset, cloud.points() + offset * d * cloud.normals()) for offset in (0.0, 0.005, -0.005, 0.01, -0.01)]
    return [Probe(offset, points, solid.mesh.signed_distance(points)) for offset, points in moved]


def diagonal(mesh: Mesh) -> float:
    """D: that of the bounding box."""
    report = mesh.report()
    return float(np.linalg.norm(np.subtract(report.bounds_max, report.bounds_min)))


def fitted(solid: Solid, studio: Studio, **settings: float) -> Optional[Field]:
    """A fit to the solid; None where the solve does not converge."""
    options = FitOptions(control_points=studio.sizes.control_points, max_iterations=4000, **settings)
    try:
        return Field.fit(solid.mesh.sample(studio.sizes.samples, seed=1), options)
    except keepout.Error as error:
        if error.status != keepout.Status.NOT_CONVERGED:
            raise
        return None


def figure_6(studio: Studio, solid: Solid) -> None:
    """Errors on and off the surface, by the weights."""
    at = probes(solid, studio)
    d = diagonal(solid.mesh)
    styles = {0.0: ("#222222", "solid", "on the surface")}
    for offset, colour in ((0.005, "#1f5f99"), (0.01, "#c0392b")):
        styles[offset] = (colour, "solid", f"{offset:g} D outside")
        styles[-offset] = (colour, "dashed", f"{offset:g} D inside")
    figure, axes = plt.subplots(1, 2, figsize=(11, 5.2), layout="constrained", sharey=True)
    lowest: list[float] = []
    highest: list[float] = []
    for axis, name, letter in zip(axes, ("lambda_normal", "lambda_smooth"), ("n", "r")):
        middle = getattr(FitOptions(), name)
        weights = middle * np.logspace(-4, 4, studio.sizes.factors)
        errors = np.full((len(weights), len(at)), np.nan)
        for i, weight in enumerate(weights):
            field = fitted(solid, studio, **{name: weight})
            if field is not None:
                errors[i] = [np.sqrt(np.mean((field(probe.points) - probe.exact) ** 2)) / d for probe in at]
            studio.tell(f"figure 6: {name} {weight:.1e}, rms on the surface {errors[i, 0]:.1e} D")
        lowest.append(np.nanmin(errors))
        highest.append(np.nanmax(errors))
        for probe, column in zip(at, errors.T):
            colour, line, label = styles[probe.offset]
            axis.loglog(weights, column, color=colour, ls=line, marker="o", ms=3.5, lw=1.5, label=label)
        axis.axvline(middle, color="#888888", lw=1, ls="dotted")
        axis.text(1.2 * middle, 0.96, "default", transform=axis.get_xaxis_transform(), fontsize=9)
        axis.set_xlabel(f"{name} ($\\lambda_{letter}$)")
        axis.grid(True, which="major", color="#dddddd", lw=0.6)
    # Decades alone would be one label.
    ticks = [a * 10.0**b for b in range(-5, -1) for a in (1, 2, 5)]
    axes[0].set_yticks(ticks, [f"{tick:.0e}".replace("e-0", "e-") for tick in ticks])
    axes[0].set_ylim(np.nanmin(lowest) / 1.3, np.nanmax(highest) * 1.3)
    axes[0].set_ylabel("RMS of phi - distance, fraction of D")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper center", bbox_to_anchor=(0.5, 0), ncols=5, frameon=False)
    counts = " x ".join(str(n) for n in studio.sizes.control_points)
    figure.suptitle(f"{solid.name}, {studio.sizes.samples} samples, {counts} control points", fontsize=11)
    studio.save(figure, "figure_6.png")


def surface_of(mesh: Mesh, field: Field, numbers: Array, colours: Callable[[Array], Array]) -> raster.Surface:
    """A level set's mesh for drawing; its normals are phi's gradients."""
    vertices = mesh.vertices()
    gradients = field.eval(vertices)[1]
    normals = gradients / np.maximum(np.linalg.norm(gradients, axis=1, keepdims=True), 1e-12)
    return raster.Surface(vertices, mesh.triangles(), normals, numbers, colours)


def view_of(mesh: Mesh, pixels: int) -> raster.View:
    """The mesh, a little from the right and from above."""
    report = mesh.report()
    low, high = np.array(report.bounds_min), np.array(report.bounds_max)
    axes = raster.turned(around=18, above=12)
    corners = np.array([[(low, high)[(i >> a) & 1][a] for a in range(3)] for i in range(8)])
    half = np.abs((corners - (low + high) / 2) @ axes[:2].T).max()
    return raster.View(axes, (low + high) / 2, 1.02 * half, pixels)


def figure_7(studio: Studio, solid: Solid) -> None:
    """Level sets, coloured by how far they are from the exact offsets."""
    d = diagonal(solid.mesh)
    field = fitted(solid, studio)
    assert field is not None
    colours = matplotlib.cm.ScalarMappable(Normalize(-0.005, 0.005), matplotlib.colormaps["coolwarm"])
    figure, axes = plt.subplots(2, 3, figsize=(12, 8.3), layout="constrained")
    for axis in axes.flat:
        axis.set_axis_off()
    for level, axis in zip(LEVELS, axes.flat):
        mesh = field.level_set(level * d).mesh
        errors = solid.mesh.signed_distance(mesh.vertices()) / d - level
        worst, rms = np.abs(errors).max(), np.sqrt(np.mean(errors**2))
        surface = surface_of(mesh, field, errors, lambda k: colours.to_rgba(k)[:, :3])
        picture = raster.draw([surface], view_of(solid.mesh, studio.sizes.pixels))
        axis.imshow(picture, interpolation="lanczos")
        axis.set_title(f"phi = {level:g} D" if level else "phi = 0", fontsize=13)
        told = f"error at most {worst:.2g} D, RMS {rms:.2g} D"
        axis.text(0.5, -0.01, told, ha="center", va="top", transform=axis.transAxes, fontsize=10)
        studio.tell(f"figure 7: level {level:g} D, {mesh.n_triangles} triangles, {told}")
    last = axes[1, 2]
    bar = figure.colorbar(colours, cax=last.inset_axes((0.08, 0.5, 0.84, 0.06)), orientation="horizontal", extend="both")
    bar.set_label("exact distance of the level set less its level,\nfraction of D")
    bar.set_ticks([-0.005, -0.0025, 0, 0.0025, 0.005])
    last.text(0.5, 0.72, solid.name, ha="center", transform=last.transAxes, fontsize=12)
    studio.save(figure, "figure_7.png")


def bands(numbers: Array) -> Array:
    """Blues that darken with the number, in steps of 0.02, with a line between them."""
    steps = numbers / 0.02
    plain = matplotlib.colormaps["GnBu"](np.clip(0.15 + 0.05 * np.floor(steps), 0, 0.9))[:, :3]
    return plain * np.where(np.abs(steps - np.round(steps)) < 0.06, 0.7, 1)[:, None]


def emblem(studio: Studio, solid: Solid) -> None:
    """The solid's level set 0, and phi on a plane through its middle."""
    d = diagonal(solid.mesh)
    field = fitted(solid, studio)
    assert field is not None
    mesh = field.level_set().mesh
    sand = np.array((0.95, 0.76, 0.5))
    body = surface_of(mesh, field, np.zeros(mesh.n_vertices), lambda k: np.broadcast_to(sand, (len(k), 3)))
    view = view_of(solid.mesh, studio.sizes.pixels)
    low, high = box_of(field)
    n, reach = studio.sizes.lattice, 1.7 * view.half
    # Behind the middle, and beyond the box, where the field goes on.
    corner = np.array((*(view.centre - reach)[:2], 0.65 * low[2] + 0.35 * high[2]))
    steps = np.array(((2 * reach, 0, 0), (0, 2 * reach, 0))) / (n - 1)
    phi = field.eval_lattice(corner, steps, (n, n), derivatives=0)[0].reshape(-1) / d
    places = corner + np.stack(np.meshgrid(np.arange(n), np.arange(n), indexing="ij"), -1).reshape(-1, 2) @ steps
    here = np.arange(n * n).reshape(n, n)[:-1, :-1].reshape(-1)
    triangles = np.concatenate((np.stack((here, here + n, here + n + 1), -1), np.stack((here, here + n + 1, here + 1), -1)))
    plane = raster.Surface(places, triangles, np.broadcast_to((0.0, 0.3, 0.95), places.shape), phi, bands)
    picture = raster.draw([body, plane], view._replace(half=1.2 * view.half))
    rim = studio.sizes.pixels // 16
    studio.save_image(Image.fromarray((255 * picture[rim:-rim, :, :3]).round().astype(np.uint8)), "emblem.png")


def main() -> None:
    """Reads the arguments."""
    top = pathlib.Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=pathlib.Path, default=top / "docs/pictures", help="folder for them (default: docs/pictures)")
    parser.add_argument("--quick", action="store_true", help="small and coarse, to see that it runs")
    parser.add_argument("--only", action="append", metavar="NAME", help="3, 4, curves, 6, 7 or emblem; may be repeated")
    arguments = parser.parse_args()
    data = pathlib.Path(os.environ.get("KEEPOUT_DATA") or top / "../shared/data")
    studio = Studio(arguments.out, data, QUICK if arguments.quick else FULL)
    solid = studio.solid()
    pictures = {
        "3": lambda: figure_3(studio),
        "4": lambda: figure_4(studio),
        "curves": lambda: figure_curves(studio),
        "6": lambda: figure_6(studio, solid),
        "7": lambda: figure_7(studio, solid),
        "emblem": lambda: emblem(studio, solid),
    }
    unknown = set(arguments.only or ()) - pictures.keys()
    if unknown:
        parser.error(f"there is no picture {', '.join(sorted(unknown))}; there are {', '.join(pictures)}")
    studio.tell(f"Keepout {keepout.version()}; the solid is {solid.name}")
    for name in arguments.only or pictures:
        pictures[name]()


if __name__ == "__main__":
    try:
        main()
    except keepout.Error as error:
        sys.exit(f"pictures.py: {error}")
