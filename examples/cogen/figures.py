#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0 OR MIT
"""Draws figures 5 to 16 of Morris and Behandish (2022), those of docs/cogen_figures.md, with the Python module.

It needs NumPy, matplotlib, Pillow and a built library. The unit of length is L, the edge of a square part.
"""

from __future__ import annotations

import argparse
import functools
import io
import pathlib
import sys
import time
from typing import Any, NamedTuple, Optional

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import MultipleLocator
from PIL import Image

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "examples/python"))
import keepout  # noqa: E402
from keepout import (  # noqa: E402
    Array,
    Cell,
    Contact,
    FamilyOptions,
    Law,
    Member,
    Motion,
    Optimised,
    OptimiseOptions,
    Pair,
    PairOptions,
    Part,
    Progress,
)

TAU = 2 * np.pi
COLOURS = ("#4075b8", "#ed8c33")
"""Of part 1 and of part 2."""
INK, GREY = "#222222", "#888888"
GAMMAS = tuple(k / 10 for k in range(11))
"""Those of the paper."""
FINE_GAMMAS = tuple(k / 20 for k in range(21))
SMALL = 60_000
"""Bytes of a picture that needs no palette."""

Sets = tuple[Array, Array]
Corner = tuple[float, float, float]


# ---- The case studies


class Mechanism:
    """Two parts, how they move, and what was found of them, which is worked out once."""

    def __init__(
        self, studio: Studio, name: str, parts: tuple[Part, Part], motions: tuple[Motion, Motion], steps: int
    ) -> None:
        """`steps` is K of the measures."""
        self.studio, self.name, self.parts, self.motions, self.steps = studio, name, parts, motions, steps
        self.families: dict[tuple[float, ...], list[Member]] = {}
        self.optima: dict[float, Optimised] = {}
        self.contacts: dict[float, Contact] = {}

    @property
    def whole(self) -> Sets:
        """The initial designs."""
        first, second = (part.cells() != Cell.FORBIDDEN for part in self.parts)
        return first, second

    @functools.cached_property
    def pair(self) -> Pair:
        """Conflicts are those of whole cells at all times, measures those of the paper."""
        (first, second), (move_first, move_second) = self.parts, self.motions
        options = PairOptions(measure_steps=self.steps)
        return Pair.create(first, move_first, second, move_second, options, self.studio.step(f"{self.name}: conflicts"))

    def family(self, gammas: tuple[float, ...]) -> list[Member]:
        """By minimum cuts."""
        if gammas not in self.families:
            pair, listen = self.pair, self.studio.step(f"{self.name}: family of {len(gammas)}")
            self.families[gammas] = pair.family(gammas, progress=listen)
        return self.families[gammas]

    def optimised(self, gamma: float) -> Optimised:
        """By moving asymptotes, then closed."""
        if gamma not in self.optima:
            pair, listen = self.pair, self.studio.step(f"{self.name}: moving asymptotes, gamma {gamma:g}")
            self.optima[gamma] = pair.optimise(OptimiseOptions(gamma=gamma), progress=listen)
        return self.optima[gamma]

    def contact(self, member: Member) -> Contact:
        """Gaps at the times of the measures."""
        if member.gamma not in self.contacts:
            listen = self.studio.step(f"{self.name}: gaps, gamma {member.gamma:.3f}")
            self.contacts[member.gamma] = self.pair.contact(*sets_of(member), self.steps, progress=listen)
        return self.contacts[member.gamma]


def discs(studio: Studio) -> Mechanism:
    """Of figure 5: S_1 stays, S_2 turns about its own centre."""
    n, radius, apart = studio.cells, 0.5, 0.75

    def disc(x: float) -> Part:
        corner, counts = (x - radius, -radius), (n, n)
        filled = Part.create(corner, 1 / n, counts).fractions_of_ball((x, 0), radius) > 0.5
        return Part.create(corner, 1 / n, counts, np.where(filled, Cell.FREE, Cell.FORBIDDEN))

    motions = Motion.fixed(2), Motion.turn((apart, 0), Law(slope=TAU))
    return Mechanism(studio, "discs", (disc(0), disc(apart)), motions, 500)


def gears(studio: Studio) -> Mechanism:
    """5.1: two squares that turn against each other about their middles, L apart."""
    n = studio.cells
    parts = Part.create((-0.5, -0.5), 1 / n, (n, n)), Part.create((0.5, -0.5), 1 / n, (n, n))
    return Mechanism(studio, "gears", parts, Motion.gears([[0, 0], [1, 0]], 1, 1), 500)


def cam(studio: Studio, start: float) -> Mechanism:
    """5.2: a square turns, from the angle `start` on, and a rectangle above it goes up and down twice, (44)."""
    n = studio.cells
    parts = Part.create((-0.5, -0.5), 1 / n, (n, n)), Part.create((-0.5, -0.25), 1 / n, (n, n // 2))
    turn, lift = Law(offset=start, slope=TAU), Law(offset=0.75, waves=[[0.125, 2, 0]])
    motions = Motion.turn((0, 0), turn), Motion.slide((0, 1), lift)
    return Mechanism(studio, f"cam from {np.degrees(start):.0f} degrees", parts, motions, 1000)


def cam_in_space(studio: Studio) -> Mechanism:
    """5.3: a cube turns about z, (45), and a box beside it is tilted about x, (46), both against the right hand."""
    n = studio.cells_in_space
    parts = Part.create([-0.5] * 3, 1 / n, [n] * 3), Part.create((-0.5, 0.25, -0.5), 1 / n, (n, n * 4 // 3, n))

    def tilt(t: float) -> tuple[Array, Array]:
        angle = 0.5 * abs(np.sin(TAU * t))
        c, s = np.cos(angle), np.sin(angle)
        return np.array([[1, 0, 0], [0, c, s], [0, -s, c]]), np.zeros(3)

    motions = Motion.screw((0, 0, 0), (0, 0, 1), 0, Law(slope=-TAU)), Motion.from_function(3, tilt, 201)
    return Mechanism(studio, "cam in space", parts, motions, 5000)


# ---- Drawing


class Window(NamedTuple):
    """What of the plane is shown."""

    low: tuple[float, float]
    high: tuple[float, float]

    @property
    def extent(self) -> tuple[float, float, float, float]:
        return self.low[0], self.high[0], self.low[1], self.high[1]


class Studio:
    """Where pictures go, and the mechanisms that they share."""

    def __init__(self, folder: pathlib.Path, cells: int, cells_in_space: int) -> None:
        """`cells` along L in the plane."""
        self.folder, self.cells, self.cells_in_space = folder, cells, cells_in_space
        self.start = time.monotonic()
        folder.mkdir(parents=True, exist_ok=True)

    def tell(self, text: str) -> None:
        """Progress, with the seconds since the start."""
        print(f"{time.monotonic() - self.start:7.1f} s  {text.replace('$', '')}", file=sys.stderr, flush=True)

    def step(self, what: str) -> Optional[Progress]:
        """Tells what begins, and gives what a call tells of its progress to, where somebody looks on."""
        self.tell(what)
        if not sys.stderr.isatty():
            return None

        def show(fraction: float, stage: str) -> None:
            print(f"\r{stage} {100 * fraction:.0f} %\033[K", end="\r", file=sys.stderr, flush=True)

        return show

    @functools.cached_property
    def gears(self) -> Mechanism:
        return gears(self)

    @functools.cached_property
    def cam(self) -> Mechanism:
        """From the cam's corner on: as the follower is highest, so is the cam."""
        return cam(self, TAU / 8)

    @functools.cached_property
    def cam_from_side(self) -> Mechanism:
        """With the cam's sides along the axes as (44) begins."""
        return cam(self, 0)

    def save(self, figure: plt.Figure, number: int, margin: float = 0.08) -> None:
        """Closes the figure. Where it would be large with all colours it gets a palette."""
        buffer = io.BytesIO()
        figure.savefig(buffer, dpi=90, format="png", facecolor="white", bbox_inches="tight", pad_inches=margin)
        plt.close(figure)
        path = self.folder / f"cogen_figure_{number}.png"
        image = Image.open(buffer).convert("RGB")
        image.save(path, optimize=True)
        if path.stat().st_size > SMALL:
            image.quantize(256, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(path, optimize=True)
        self.tell(f"{path} ({path.stat().st_size / 1000:.0f} kB)")


def rgb(colour: str) -> Array:
    return np.array(matplotlib.colors.to_rgb(colour))


def covered(part: Part, cells: Array, motion: Motion, t: float, points: Array) -> Array:
    """Which of the points [..., dim] lie in one of the part's cells at time t."""
    turns, shifts = motion.eval([t])
    # x' R is R^T x: back to the part's own frame.
    at = np.floor(((points - shifts[0]) @ turns[0] - part.corner) / part.cell_edge).astype(int)
    inside = np.all((at >= 0) & (at < part.shape), axis=-1)
    at[~inside] = 0
    return inside & cells[tuple(np.moveaxis(at, -1, 0))]


def picture(mechanism: Mechanism, sets: Sets, t: float, window: Window, pixels: int) -> Array:
    """Colours [height, width, 3] at time t, `pixels` to L: means of 3 x 3 points. Where both are, both are mixed."""
    size = np.subtract(window.high, window.low)
    width, height = (3 * np.round(pixels * size)).astype(int)
    x = window.low[0] + (np.arange(width) + 0.5) / width * size[0]
    y = window.low[1] + (np.arange(height) + 0.5) / height * size[1]
    points = np.stack(np.meshgrid(x, y), axis=-1)
    first, second = (
        covered(part, own, motion, t, points) for part, own, motion in zip(mechanism.parts, sets, mechanism.motions)
    )
    colours = np.ones((height, width, 3))
    colours[first], colours[second] = rgb(COLOURS[0]), rgb(COLOURS[1])
    colours[first & second] = (rgb(COLOURS[0]) + rgb(COLOURS[1])) / 2
    return colours.reshape(height // 3, 3, width // 3, 3, 3).mean(axis=(1, 3))


def draw_boxes(axes: plt.Axes, mechanism: Mechanism, t: float) -> None:
    """Outlines of both grids at time t."""
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])
    for part, motion in zip(mechanism.parts, mechanism.motions):
        turns, shifts = motion.eval([t])
        corners = (part.corner + square * part.cell_edge * np.array(part.shape)) @ turns[0].T + shifts[0]
        axes.plot(*corners.T, color=GREY, lw=0.6)


def draw_pair(axes: plt.Axes, mechanism: Mechanism, sets: Sets, t: float, window: Window, pixels: int = 240) -> None:
    """Both parts at time t, without axes."""
    shown = picture(mechanism, sets, t, window, pixels)
    axes.imshow(shown, origin="lower", extent=window.extent, interpolation="bilinear")
    axes.set_axis_off()


def sets_of(found: Any) -> Sets:
    """Of a Member, a Closed, a Cut, an Optimised."""
    return found.first, found.second


def draw_map(axes: plt.Axes, part: Part, numbers: Array) -> None:
    """Numbers of a part's cells in its own frame, and their scale; cells of 0 are grey."""
    high = part.corner + part.cell_edge * np.array(part.shape)
    window = Window(tuple(part.corner), tuple(high))
    colours = matplotlib.colormaps["viridis"].with_extremes(bad="#e4e4e4")
    axes.set_axis_off()
    image = axes.imshow(np.ma.masked_equal(numbers, 0).T, origin="lower", extent=window.extent, cmap=colours, vmin=0)
    axes.figure.colorbar(image, cax=axes.inset_axes((1.04, 0, 0.05, 1)))


def arrow(axes: plt.Axes, start: tuple[float, float], end: tuple[float, float], style: str) -> None:
    look = {"arrowstyle": style, "color": INK, "lw": 0.9, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", end, start, arrowprops=look)


def dimension(
    axes: plt.Axes, start: tuple[float, float], end: tuple[float, float], text: str, at: tuple[float, float]
) -> None:
    """A line with two heads, and what it measures."""
    arrow(axes, start, end, "<->")
    axes.text(*at, text, ha="center", va="center", fontsize=9, color=INK)


def rotation(axes: plt.Axes, center: tuple[float, float], radius: float, way: int) -> None:
    """An arrow round a centre: way 1 counter-clockwise, -1 clockwise."""
    angle = np.radians(np.linspace(-60, 210, 60))[::way]
    x, y = center[0] + radius * np.cos(angle), center[1] + radius * np.sin(angle)
    axes.plot(x[:-3], y[:-3], color=INK, lw=1)
    arrow(axes, (x[-4], y[-4]), (x[-1], y[-1]), "-|>")
    axes.plot(*center, "o", color=INK, ms=2.5)


# ---- The figures


def figure_5(studio: Studio) -> None:
    """Discs: two maximal pairs, and one that is free of collisions and not maximal."""
    both = discs(studio)
    # Closure keeps the part that it begins with.
    keeps_second, keeps_first = (sets_of(both.pair.close(*both.whole, start=part)) for part in (2, 1))
    neither = keeps_second[0], keeps_first[1]
    if both.pair.volumes(*neither).n_lost:
        raise RuntimeError("two unsweeps collide")
    window = Window((-0.55, -0.55), (1.3, 0.55))
    figure, axes = plt.subplots(2, 2, figsize=(7.2, 5.2), layout="constrained")
    panels = [
        ("initial designs", both.whole),
        ("(a) S$_2$ whole, S$_1$ an unsweep: maximal", keeps_second),
        ("(b) S$_1$ whole, S$_2$ an unsweep: maximal", keeps_first),
        ("(c) both unsweeps: not maximal", neither),
    ]
    for axis, (title, sets) in zip(axes.flat, panels):
        draw_pair(axis, both, sets, 0, window)
        areas = [own.sum() / studio.cells**2 for own in sets]
        axis.set_title(f"{title}\nareas {areas[0]:.3f} and {areas[1]:.3f}", fontsize=9)
        studio.tell(f"figure 5: {title}: areas {areas[0]:.4f} and {areas[1]:.4f}")
    first = axes[0, 0]
    rotation(first, (0.75, 0), 0.16, 1)
    first.text(-0.25, 0, "S$_1$", fontsize=12, ha="center", va="center", color="white")
    first.text(1.05, 0.15, "S$_2$", fontsize=12, ha="center", va="center", color="white")
    studio.save(figure, 5)


def draw_local_measures(axes: tuple[plt.Axes, plt.Axes], mechanism: Mechanism, names: tuple[str, str]) -> None:
    """(14) and (15) of the initial designs, in the parts' own frames."""
    measures = mechanism.pair.local_measures(*mechanism.whole)
    for axis, part, numbers, name in zip(axes, mechanism.parts, measures, names):
        draw_map(axis, part, numbers)
        axis.set_title(name, fontsize=10)
        free = np.mean(numbers == 0)
        mechanism.studio.tell(f"{mechanism.name}: {name} at most {numbers.max():.4f}, 0 in {free:.3f} of the cells")


def figure_6(studio: Studio) -> None:
    """Gears: initial designs, and their local collision measures."""
    figure = plt.figure(figsize=(7, 6.6), layout="constrained")
    axes = figure.subplot_mosaic([["initial", "initial"], ["first", "second"]], height_ratios=(1, 1.1))
    window = Window((-0.6, -0.68), (1.6, 0.52))
    top = axes["initial"]
    draw_pair(top, studio.gears, studio.gears.whole, 0, window)
    draw_boxes(top, studio.gears, 0)
    rotation(top, (0, 0), 0.25, 1)
    rotation(top, (1, 0), 0.25, -1)
    for x, name in ((-0.38, "S$_1$"), (1.38, "S$_2$")):
        top.text(x, 0.38, name, fontsize=12, ha="center", va="center", color="white")
    dimension(top, (-0.5, -0.57), (0, -0.57), "L/2", (-0.25, -0.63))
    dimension(top, (0, -0.57), (1, -0.57), "L", (0.75, -0.63))
    top.set_title("initial designs", fontsize=10)
    names = "S$_1$: fraction of the motion in S$_2$, (14)", "S$_2$: fraction of the motion in S$_1$, (15)"
    draw_local_measures((axes["first"], axes["second"]), studio.gears, names)
    studio.save(figure, 6)


def figure_7(studio: Studio) -> None:
    """Gears: sums over gamma, and some of the pairs."""
    members = studio.gears.family(GAMMAS)
    optima = [studio.gears.optimised(gamma) for gamma in GAMMAS[1:-1]]
    shown = (0, 3, 5, 7, 10)
    figure = plt.figure(figsize=(9, 6), layout="constrained")
    grid = figure.add_gridspec(2, len(shown), height_ratios=(3, 1))
    chart = figure.add_subplot(grid[0, :])
    sums = [sum(member.volumes) for member in members]
    bounds, reached = [member.bound for member in members], [member.gamma for member in members]
    chart.plot(GAMMAS, bounds, color=GREY, ls="dashed", lw=1, label="no pair of this $\\gamma$ passes")
    chart.plot(reached, sums, "o-", color=COLOURS[0], lw=1, ms=5, label="minimum cuts")
    rings = [(found.report.gamma, sum(found.report.volumes)) for found in optima]
    chart.plot(*zip(*rings), "o", mfc="none", color="#c0392b", ms=6, label="moving asymptotes, closed")
    chart.set_xlabel("$\\gamma$")
    chart.set_ylabel("V$_1$ + V$_2$, L$^2$")
    chart.set_xticks(GAMMAS)
    chart.grid(color="#dddddd", lw=0.6)
    chart.legend(frameon=False, fontsize=9, loc="lower center", bbox_to_anchor=(0.5, 1), ncols=3)
    for column, k in enumerate(shown):
        axis = figure.add_subplot(grid[1, column])
        draw_pair(axis, studio.gears, sets_of(members[k]), 0, Window((-0.52, -0.52), (1.52, 0.52)), 150)
        axis.set_title(f"$\\gamma$ = {GAMMAS[k]:g}", fontsize=9)
    for gamma, member, total in zip(GAMMAS, members, sums):
        studio.tell(f"figure 7: gamma {gamma:g}: reached {member.gamma:.4f}, sum {total:.4f} of {member.bound:.4f}")
    for gamma, (to, total) in zip(GAMMAS[1:-1], rings):
        studio.tell(f"figure 7: gamma {gamma:g}: asymptotes reached {to:.4f}, sum {total:.4f}")
    studio.save(figure, 7)


def draw_convergence(axes: plt.Axes, found: Optimised, bound: float) -> None:
    """V_1 + V_2 and the measures over iterations, with the closed pair's sum and the bound."""
    iterations = np.arange(len(found.history))
    (sums,) = axes.plot(iterations, found.history[:, :2].sum(axis=1), color=COLOURS[0], lw=1.6)
    closed = axes.axhline(sum(found.report.volumes), color="#c0392b", lw=1, ls="dotted")
    limit = axes.axhline(bound, color=GREY, lw=1, ls="dashed")
    right = axes.twinx()
    (collision,) = right.semilogy(iterations, found.history[:, 2:4].sum(axis=1), color=COLOURS[1], lw=1)
    axes.set_xlabel("iteration")
    axes.set_ylabel("V$_1$ + V$_2$")
    right.set_ylabel("g$_{21}$ + g$_{12}$", color=COLOURS[1])
    axes.set_ylim(0)
    names = ("V$_1$ + V$_2$ of densities", "of the closed pair", "no pair passes", "g$_{21}$ + g$_{12}$")
    axes.legend((sums, closed, limit, collision), names, fontsize=8, loc="upper right")


def tell_convergence(studio: Studio, number: int, found: Optimised, bound: float) -> None:
    """A line of progress."""
    report = found.report
    densities, closed = found.history[-1, :2].sum(), sum(report.volumes)
    sums = f"densities {densities:.4f}, closed {closed:.4f} at gamma {report.gamma:.4f}, bound {bound:.4f}"
    studio.tell(f"figure {number}: {report.n_iterations} iterations, {sums}")


def figure_8(studio: Studio) -> None:
    """Gears: convergence of moving asymptotes."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained")
    for axis, gamma in zip(axes, (0.4, 0.5)):
        found, bound = studio.gears.optimised(gamma), studio.gears.family(GAMMAS)[GAMMAS.index(gamma)].bound
        draw_convergence(axis, found, bound)
        axis.set_title(f"$\\gamma$ = {gamma:g}", fontsize=10)
        tell_convergence(studio, 8, found, bound)
    studio.save(figure, 8)


def figure_9(studio: Studio) -> None:
    """Cam and follower: initial designs, and their local collision measures."""
    figure = plt.figure(figsize=(9, 5.2), layout="constrained")
    rows = [["initial", "follower"], ["initial", "cam"]]
    axes = figure.subplot_mosaic(rows, width_ratios=(1.25, 1), height_ratios=(1, 1.8))
    left = axes["initial"]
    draw_pair(left, studio.cam, studio.cam.whole, 0, Window((-1, -0.75), (0.75, 1.25)))
    draw_boxes(left, studio.cam, 0)
    rotation(left, (0, 0), 0.22, 1)
    arrow(left, (0, 0.8), (0, 1.06), "<|-|>")
    left.text(0.36, 0, "S$_C$", fontsize=12, ha="center", va="center", color="white")
    left.text(0.36, 0.93, "S$_F$", fontsize=12, ha="center", va="center", color="white")
    dimension(left, (-0.5, 1.15), (0.5, 1.15), "L", (0, 1.2))
    dimension(left, (-0.57, 0.625), (-0.57, 1.125), "L/2", (-0.66, 1))
    dimension(left, (-0.72, 0), (-0.72, 0.875), "7L/8", (-0.86, 0.44))
    left.set_title("initial designs, $\\theta_C$ = 0", fontsize=10)
    names = "S$_C$: fraction of the motion in S$_F$, (14)", "S$_F$: fraction of the motion in S$_C$, (15)"
    draw_local_measures((axes["cam"], axes["follower"]), studio.cam, names)
    studio.save(figure, 9)


def gaps_of_whole_parts(start: float, n: int) -> Array:
    """Gaps of the initial designs of cam and follower at n times, over the cam's highest corner; no pair's are smaller."""
    angle = TAU * (np.arange(n) + 0.5) / n
    underside = 0.75 + 0.125 * np.cos(2 * angle) - 0.25
    top = (np.abs(np.cos(start + angle)) + np.abs(np.sin(start + angle))) / 2
    return np.maximum(0, underside - top)


def draw_largest_gap(axes: plt.Axes, mechanism: Mechanism, member: Member) -> None:
    """The pair at the time when it is farthest apart."""
    contact = mechanism.contact(member)
    worst = int(np.argmax(contact.gaps))
    t = (worst + 0.5) / len(contact.gaps)
    draw_pair(axes, mechanism, sets_of(member), t, Window((-0.75, -0.76), (0.75, 1.15)))
    turns, shifts = mechanism.motions[0].eval([t])
    place = turns[0] @ contact.places[worst] + shifts[0]
    look = {"arrowstyle": "->", "color": INK}
    axes.annotate(f"{contact.largest:.3f} L", place, (0.5, 0.45), fontsize=9, arrowprops=look, va="center")
    axes.set_title(f"$\\gamma$ = {member.gamma:g}, $\\theta_C$ = {360 * t:.0f}°", fontsize=10)


def figure_10(studio: Studio) -> None:
    """Cam and follower: where the unsweep of the follower loses contact, and gaps over the motion."""
    members, others = (mechanism.family(FINE_GAMMAS) for mechanism in (studio.cam, studio.cam_from_side))
    at = FINE_GAMMAS.index(0.8)
    figure, (scene, chart) = plt.subplots(1, 2, figsize=(9.5, 4.2), layout="constrained", width_ratios=(1, 1.5))
    draw_largest_gap(scene, studio.cam, members[0])
    lines = (
        (studio.cam, members[0], INK, "0, the follower an unsweep"),
        (studio.cam, members[at], "#c0392b", "0.8"),
        (studio.cam_from_side, others[at], COLOURS[0], "0.8, from the cam's side"),
    )
    for mechanism, member, colour, name in lines:
        gaps = mechanism.contact(member).gaps
        angles = 360 * (np.arange(len(gaps)) + 0.5) / len(gaps)
        chart.plot(angles, gaps, color=colour, lw=1.2, label=f"$\\gamma$ = {name}")
        studio.tell(f"figure 10: gamma {name}: gap at most {gaps.max():.4f}, mean {gaps.mean():.4f}")
    least = gaps_of_whole_parts(0, len(gaps))
    chart.plot(angles, least, color=COLOURS[0], lw=1, ls="dashed", label="no pair from the side has less")
    chart.axhline(1 / studio.cells, color=GREY, lw=1, ls="dotted", label="a cell")
    chart.set_xlabel("$\\theta_C$, degrees")
    chart.set_xticks(range(0, 361, 45))
    chart.set_title("gap, L", fontsize=10)
    chart.set_ylim(0, 1.35 * studio.cam.contact(members[0]).largest)
    chart.margins(x=0)
    chart.legend(fontsize=8, loc="upper center", ncols=2)
    studio.save(figure, 10)


def figure_11(studio: Studio) -> None:
    """Cam and follower: mean and largest gap over gamma, from both starts."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.9), layout="constrained")
    for mechanism, colour, name in (
        (studio.cam_from_side, COLOURS[0], "from the cam's side"),
        (studio.cam, COLOURS[1], "from its corner"),
    ):
        members = mechanism.family(FINE_GAMMAS)
        contacts = [mechanism.contact(member) for member in members]
        gammas = [member.gamma for member in members]
        for axis, gaps in zip(axes, ([c.mean for c in contacts], [c.largest for c in contacts])):
            axis.plot(gammas, gaps, "o-", color=colour, lw=1.2, ms=3.5, label=name)
        for asked, member, contact in zip(FINE_GAMMAS, members, contacts):
            gaps = f"mean {contact.mean:.4f}, largest {contact.largest:.4f}"
            sums = f"sum {sum(member.volumes):.4f} of {member.bound:.4f}"
            studio.tell(f"figure 11: {mechanism.name}: gamma {asked:g}, reached {member.gamma:.4f}: {gaps}, {sums}")
    least = gaps_of_whole_parts(0, 1000)
    studio.tell(f"figure 11: from the cam's side at least mean {least.mean():.4f}, largest {least.max():.4f}")
    for axis, title, bound in zip(axes, ("mean gap over the motion, L", "largest gap, L"), (least.mean(), least.max())):
        axis.axhline(bound, color=COLOURS[0], lw=1, ls="dashed", label="no pair from the side has less")
        axis.axhline(1 / studio.cells, color=GREY, lw=1, ls="dotted", label="a cell")
        axis.axvspan(0.7, 0.9, color="#eeeeee", lw=0, label="the paper: persistent contact")
        axis.set_title(title, fontsize=10)
        axis.set_xlabel("$\\gamma$")
        axis.set_ylim(0)
    axes[1].legend(fontsize=8)
    studio.save(figure, 11)


def figure_12(studio: Studio) -> None:
    """Cam and follower: the pair of gamma 0.8 at times of its motion."""
    member = studio.cam.family(FINE_GAMMAS)[FINE_GAMMAS.index(0.8)]
    figure, axes = plt.subplots(2, 5, figsize=(9.5, 4.8), layout="constrained")
    for k, axis in enumerate(axes.flat):
        draw_pair(axis, studio.cam, sets_of(member), k / 10, Window((-0.74, -0.74), (0.74, 1.15)), 200)
        axis.set_title(f"$\\theta_C$ = {36 * k}°", fontsize=9)
    studio.save(figure, 12)


def figure_13(studio: Studio) -> None:
    """Cam and follower: the four sensitivities, (31) and (32), at the initial designs."""
    by = studio.cam.pair.sensitivities(*studio.cam.whole)
    figure, axes = plt.subplots(2, 2, figsize=(8.5, 6.2), layout="constrained", height_ratios=(1.8, 1))
    panels = [
        (axes[0, 0], 0, by.g21_by_1, "F,C", "C", "(31)"),
        (axes[1, 0], 1, by.g21_by_2, "F,C", "F", "(31)"),
        (axes[0, 1], 0, by.g12_by_1, "C,F", "C", "(32)"),
        (axes[1, 1], 1, by.g12_by_2, "C,F", "F", "(32)"),
    ]
    for axis, which, field, measure, by_part, equation in panels:
        part = studio.cam.parts[which]
        # Of a cell's area, so that both parts' are fractions of the motion.
        draw_map(axis, part, field / part.cell_edge**2)
        axis.set_title(f"$\\partial g_{{{measure}}} / \\partial \\rho_{by_part}$, {equation}", fontsize=10)
        largest = field.max() / part.cell_edge**2
        studio.tell(f"figure 13: g_{measure} by rho_{by_part}: at most {largest:.4f}, sum {field.sum():.5f}")
    studio.save(figure, 13)


def draw_wires(axes: Any, low: Corner, high: Corner, colour: str) -> None:
    """The edges of a box: from each corner to those that differ by one bit."""
    for i in range(8):
        for a in range(3):
            if not i >> a & 1:
                ends = [[(low, high)[j >> b & 1][b] for b in range(3)] for j in (i, i | 1 << a)]
                axes.plot(*zip(*ends), color=colour, lw=1.4)


def save_wires(studio: Studio, number: int, boxes: list[tuple[str, Corner, Corner]]) -> None:
    """Initial designs in space."""
    figure = plt.figure(figsize=(4.8, 4.8))
    axes = figure.add_subplot(projection="3d")
    for (name, low, high), colour in zip(boxes, COLOURS):
        draw_wires(axes, low, high, colour)
        axes.plot([], [], color=colour, label=name)
    axes.legend(loc="upper left", frameon=False)
    axes.set_box_aspect([hi - lo for lo, hi in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())])
    for axis, letter in ((axes.xaxis, "x"), (axes.yaxis, "y"), (axes.zaxis, "z")):
        axis.set_major_locator(MultipleLocator(0.5 if number == 14 else 1))
        axis.set_label_text(f"{letter}, L")
    axes.tick_params(labelsize=8)
    axes.yaxis.labelpad = 12
    axes.view_init(22, -58)
    # A tight box leaves out labels of axes in space.
    studio.save(figure, number, margin=0.3)


def figure_14(studio: Studio) -> None:
    """The initial designs of cam and follower in space."""
    cube = "S$_C$", (-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)
    box = "S$_F$", (-0.5, 0.25, -0.5), (0.5, 0.25 + 4 / 3, 0.5)
    save_wires(studio, 14, [cube, box])


def figure_15(studio: Studio) -> None:
    """Cam and follower in space: convergence of moving asymptotes."""
    mechanism = cam_in_space(studio)
    found = mechanism.optimised(0.5)
    # The bound is all that is asked for, and it is found long before a pair that is close to it.
    options, listen = FamilyOptions(gap=0.05), studio.step(f"{mechanism.name}: bound")
    bound = mechanism.pair.family(0.5, options=options, progress=listen)[0].bound
    figure, axes = plt.subplots(figsize=(5.6, 3.8), layout="constrained")
    draw_convergence(axes, found, bound)
    tell_convergence(studio, 15, found, bound)
    studio.save(figure, 15)


def figure_16(studio: Studio) -> None:
    """The initial designs of nut and bolt."""
    save_wires(studio, 16, [("nut", (-1, -1, 0), (1, 1, 1)), ("bolt", (-0.5, -0.5, -1), (0.5, 0.5, 2))])


OF_DISCS_AND_GEARS = (figure_5, figure_6, figure_7, figure_8)
OF_THE_CAM = (figure_9, figure_10, figure_11, figure_12, figure_13)
IN_SPACE = (figure_14, figure_15, figure_16)
FIGURES = dict(enumerate(OF_DISCS_AND_GEARS + OF_THE_CAM + IN_SPACE, start=5))


def main() -> None:
    """Reads the arguments."""
    parser = argparse.ArgumentParser(description=__doc__)
    add, folder = parser.add_argument, TOP / "docs/pictures"
    add("figures", nargs="*", type=int, metavar="NUMBER", help="figures, from 5 to 16 (default: all)")
    add("--cells", type=int, default=400, metavar="N", help="cells along L in the plane, even (default: 400)")
    add("--cells-3d", type=int, default=105, metavar="N", help="and in space, a multiple of 3 (default: 105)")
    add("--folder", type=pathlib.Path, default=folder, metavar="PATH", help="where they go (default: docs/pictures)")
    arguments = parser.parse_args()
    unknown = sorted(set(arguments.figures) - FIGURES.keys())
    if unknown:
        parser.error(f"there is no figure {unknown[0]}; there are 5 to 16")
    if arguments.cells < 2 or arguments.cells % 2:
        parser.error(f"--cells is {arguments.cells}; an even number from 2 on is needed")
    if arguments.cells_3d < 3 or arguments.cells_3d % 3:
        parser.error(f"--cells-3d is {arguments.cells_3d}; a multiple of 3 from 3 on is needed")
    studio = Studio(arguments.folder, arguments.cells, arguments.cells_3d)
    cells = f"{studio.cells} cells along L in the plane, {studio.cells_in_space} in space"
    studio.tell(f"Keepout {keepout.version()}, {cells}")
    for number in arguments.figures or FIGURES:
        FIGURES[number](studio)


if __name__ == "__main__":
    try:
        main()
    except keepout.Error as error:
        sys.exit(f"figures.py: {error}")
