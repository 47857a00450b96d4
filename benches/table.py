#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0 OR MIT
"""Writes the tables of README.md and docs/scale.md from what `benches/run scale` printed, each between two marker lines.

table.py PROJECT OUTPUT...   of the project in that folder; later outputs win, and all are kept in docs/scale.txt; `benches/run table` calls this
table.py --check PROJECT     whether its tables are those of docs/scale.txt; where there is none, whether they have the form that this writes
A figure that is missing, or no number, ends it with a message; both documents then stay as they were.
"""

import itertools
import math
import os
import re
import shutil
import sys

ORDERS = ("value", "gradient", "hessian")
PLACES = ("uniform", "near", "surface")
# Each shape with the `max_error` that is shown of those that the bench measures.
SHAPES = {"armadillo": "6e-04", "fandisk": "6e-04", "bunny": "6e-04", "dragon": "6e-04"}
# Those of which docs/scale.md shows refined fits, as the bench has them.
ERRORS = ("2e-03", "1e-03", "6e-04")
# Each closed shape with its name in docs/scale.md.
SIDES = {
    "bunny_lsdo_genie": "bunny",
    "armadillo_cgal": "armadillo",
    "femur_cgal": "femur",
    "rotor": "rotor",
    "bwb": "bwb",
    "fandisk": "fandisk",
    "joint": "joint",
    "spool": "spool",
    "knot1": "knot",
    "double-torus": "double-torus",
}


class Refused(Exception):
    """What stands in the way of the tables."""


class Output:
    """Lines `key = value unit` of a bench."""

    def __init__(self, paths):
        self.texts = {}
        for path in paths:
            with open(path, encoding="utf-8") as file:
                for line in file:
                    key, equals, text = line.strip().partition(" = ")
                    if equals:
                        self.texts[key] = text

    def text(self, key):
        if not self.texts.get(key):
            raise Refused(f"there is no {key} in the output of the bench")
        return self.texts[key]

    def number(self, key):
        text = self.text(key)
        try:
            number = float(text.split()[0])
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise Refused(f"{key} is '{text}', which is no number")
        return number

    def largest_grid(self, shape):
        """Control points of the largest grid of `shape` of a million at most."""
        found = (re.fullmatch(rf"accuracy_{shape}_(\d+)_rms", key) for key in self.texts)
        counts = [int(match[1]) for match in found if match and int(match[1]) <= 10**6]
        if not counts:
            raise Refused(f"there is no accuracy_{shape}_N_rms in the output of the bench")
        return max(counts)


class Ones(Output):
    """An output with every figure, for the form of the tables alone."""

    def __init__(self):
        super().__init__([])

    def text(self, key):
        return "1"

    def largest_grid(self, shape):
        return 1


def short(x, more=0):
    """Three digits, two beside an exponent, and `more`; and no exponent that a reader could do without."""
    if x == 0:
        return "0"
    if abs(x) >= 100:
        return f"{x:,.{more}f}"
    if abs(x) < 1e-2:
        return f"{x:.{1 + more}e}".replace("e-0", "e-")
    return f"{x:.{3 + more}g}"


def missed(x, goal):
    """A number above its goal, with as many digits as tell it from the goal."""
    def shown(text):
        return float(text.replace(",", ""))

    texts = (short(x, more) for more in range(18))
    return "**" + next((text for text in texts if shown(text) != shown(short(goal))), short(x)) + "**"


def listed(numbers, unit="", goals=()):
    """Numbers above their goals are bold."""
    bounds = list(goals) or [math.inf] * len(numbers)
    texts = [short(x) if x <= bound else missed(x, bound) for x, bound in zip(numbers, bounds)]
    return "; ".join(texts) + (f" {unit}" if unit else "")


def row(figure, reached, goals=(), unit="", beside=""):
    """A line of the first table."""
    return [figure, listed(reached, unit, goals), listed(goals, unit) if goals else "", beside]


def evaluation(of):
    def times(key, what=""):
        return [of.number(f"{key}_{order}{what}") for order in ORDERS]

    rows = []
    for name, key, halved in (
        ("24,800 control points", "in_cache_uniform", []),
        ("256^3 control points", "out_of_cache_uniform", ORDERS),  # half the time of the kernel by hand is the goal
        ("256^3, points sorted by bricks of 16 cells", "out_of_cache_sorted_by_caller", []),
    ):
        key = "speed_" + key
        goals = [of.number(f"{key}_{order}_floor") / 2 for order in halved]
        over = listed(times(key, "_over_floor"), "times its time")
        beside = f"kernel by hand {listed(times(key, '_floor'), 'ns')}, {over}"
        rows.append(row(f"{name}: value; with gradient; with Hessian", times(key), goals, "ns", beside))
    ours = times("speed_in_cache_uniform")
    rows[0][-1] += "; paper about 1000 ns with gradient"
    rows.insert(1, row("Hessian over gradient", [ours[2] / ours[1]], [1.4], "times"))
    over_one = times("speed_refined_in_box", "_over_one_grid")
    rows.append(row("three levels over one grid: value; gradient; Hessian", over_one, [3, 3, 3], "times"))
    return rows


def peers(of):
    rows = []
    for name, key in (
        ("CGAL's closest point", "cgal_closest_point"),
        ("parry3d-f64's signed distance", "parry_signed_distance"),
        ("interpn's B-spline of the same control points", "interpn_bspline_value_and_gradient"),
    ):
        key = [f"peers_{place}_{key}" for place in PLACES]
        faster = [of.number(k + "_over_keepout") for k in key]
        beside = listed([of.number(k) for k in key], "ns")
        rows.append(row(f"times faster than {name}: uniform points; near; on the surface", faster, beside=beside))
    return rows


def fits(of):
    rows = []
    for n, key in (("24,800", "fit_24800"), ("71,280", "fit_71280")):
        fit = f"{key}_1e-6_papers_energy"
        name = f"fit of {n} control points to 1e-6, the paper's energy, {short(of.number(fit + '_iterations'))} iterations"
        beside = f"paper {short(of.number(key + '_paper'))} s"
        rows.append(row(name, [of.number(fit + "_seconds")], [of.number(key + "_1e-6_limit")], "s", beside))
    grown = [f"growth_{what}_" for what in ("iterations", "time_a_control_point")]
    rows.append(
        row(
            "the same, 2^21 control points over 2^15: iterations; time a control point",
            [of.number(key + "papers_energy") for key in grown],
            [of.number(key + "limit") for key in grown],
            "times",
        )
    )
    rows.append(row("fit of 10^6, two threads", [of.number("fit_1e6_seconds")], [of.number("fit_1e6_limit")], "s"))
    memory = "fit_1e6_peak_memory"
    rows.append(row("its peak memory, the whole process", [of.number(memory)], [of.number(memory + "_limit")], "MB"))
    return rows


def sides(of):
    """Of the closed shapes: what goes wrong off their surfaces."""

    def each(kind, what):
        return [of.number(f"sides_{shape}{kind}_{what}") for shape in SIDES]

    off, wrong = [], []
    for kind in ("_one_grid", "_refined"):
        off.append(max(each(kind, "a_cell_off_medial_axis_gradient_off_1_beyond_0.2")))
        wrong.append([sum(each(kind, "wrong_signs")), sum(each(kind, "components")) - sum(each("", "components"))])
    points = len(SIDES) * of.number("sides_points")
    name = f"wrong signs of {short(points)}; parts of level sets too many, {len(SIDES)} closed shapes"
    return [
        row(f"{name}: one grid", wrong[0], [0, 0]),
        row("the same, refined", wrong[1], [0, 0]),
        row("away from them, abs(grad phi) off 1 by more than 0.2, the worst shape: one grid; refined", off, [0, 0], "%"),
    ]


def accuracy(of):
    def figures(shape, by):
        return [of.number(f"accuracy_{shape}_{by}_{what}") for what in ("rms", "max", "processor_seconds")]

    def cell(numbers, goals=()):
        return listed(numbers[:2], "D", goals[:2]) + ", " + listed(numbers[2:], "s", goals[2:])

    goals = {shape: figures(shape, "goal") for shape in SHAPES}
    refined = {shape: f"refined_{error}" for shape, error in SHAPES.items()}

    def grid(shape):
        return figures(shape, of.largest_grid(shape))

    def cells(shape):
        points = of.number(f"accuracy_{shape}_{refined[shape]}_control_points")
        megabytes = of.number(f"accuracy_{shape}_{refined[shape]}_megabytes")
        return f"{float(SHAPES[shape]):.0e}; {short(points)}; {short(megabytes)} MB".replace("e-0", "e-")

    weights = ", ".join(f"{name} {short(of.number('accuracy_' + name))}" for name in ("lambda_normal", "lambda_smooth"))
    tolerance = short(of.number("accuracy_refined_tolerance"))
    return [
        [f"10^6 control points, {weights}", *(cell(grid(s), goals[s]) for s in SHAPES)],
        [f"refined cells, default weights, tolerance {tolerance}", *(cell(figures(s, refined[s]), goals[s]) for s in SHAPES)],
        ["their max_error; control points; memory", *map(cells, SHAPES)],
        ["goal", *(cell(goals[s]) for s in SHAPES)],
        ["screened Poisson, depth 8", *(cell(figures(s, "poisson")) for s in SHAPES)],
        ["SSD, depth 8", *(cell(figures(s, "ssd")) for s in SHAPES)],
    ]


def markdown(heads, rows):
    lines = [heads, ["---"] + ["--:"] * (len(heads) - 1), *rows]
    return ["|" + "|".join(f" {cell} " if cell.strip() else cell or " " for cell in line) + "|" for line in lines]


def measured(of):
    processor = f"{of.text('machine_cpu')}, {of.text('machine_cores')} cores"
    load = of.text("machine_load_of_last_minute")
    return f"Measured on {of.text('machine_date')} by `benches/run table`: {processor}, load {load} before it."


def figures(of):
    """The README's lines between the markers."""
    return [
        measured(of) + " One thread but where two are",
        "named; nanoseconds are those of a point; bold is what misses its goal.",
        "",
        *markdown(["size and speed", "reached", "goal", "beside"], evaluation(of) + peers(of) + fits(of) + sides(of)),
        "",
        *markdown(["RMS; largest distance, processor time", *SHAPES], accuracy(of)),
    ]


def refined_cells(of):
    """Refined fits of docs/scale.md."""

    def on_surface(key):
        return ", ".join(short(of.number(f"{key}_{what}")) for what in ("rms", "max")) + " D"

    def seconds(key):
        return f"{short(of.number(key + '_processor_seconds'))} s"

    rows = []
    for shape in SHAPES:
        beside = [f"{on_surface(key)}, {seconds(key)}" for key in (f"accuracy_{shape}_poisson", f"accuracy_{shape}_goal")]
        for error in ERRORS:
            key = f"accuracy_{shape}_refined_{error}"
            points, levels = (short(of.number(f"{key}_{what}")) for what in ("control_points", "levels"))
            rows.append([shape, error.replace("e-0", "e-"), points, levels, on_surface(key), seconds(key), *beside])
            beside = ["  ", "  "]
    heads = ["shape", "`max_error`", "control points", "levels", "reached", "time", "Poisson, depth 8", "goal"]
    return [measured(of), "", *markdown(heads, rows)]


def side_errors(of):
    """Wrong signs and parts of level sets, for docs/scale.md."""

    def wrong(key):
        count, farthest = of.number(key + "_wrong_signs"), of.number(key + "_farthest_wrong_sign")
        return short(count) + (f", to {short(farthest)} D" if count else "")

    rows = []
    for shape, name in SIDES.items():
        keys = [f"sides_{shape}{kind}" for kind in ("_one_grid", "_refined")]
        rows.append([name, *map(wrong, keys), *(short(of.number(key + "_components")) for key in keys)])
    heads = ["shape", "wrong signs, one grid", "refined", "parts, one grid", "refined"]
    return [measured(of), "", *markdown(heads, rows)]


def slopes(of):
    """How far |grad phi| is from 1, for docs/scale.md."""
    rows = []
    for shape, name in SIDES.items():
        key = f"sides_{shape}"
        places = [f"{by}_off_medial_axis" for by in ("a_cell", "two_cells")]
        away = of.number(key + "_away_points")
        counted = [of.number(f"{key}_away_points_{place}") for place in places]
        cells = [name, ", ".join(f"{100 * n / away:.0f} %" for n in counted)]
        for kind in ("_one_grid", "_refined"):
            off = [f"{key}{kind}_{place}_gradient_off_1" for place in places]
            cells += [f"{short(of.number(key_of + '_beyond_0.2'))} %" for key_of in off]
            cells.append(", ".join(short(of.number(off[0] + what)) for what in ("_median", "_max")))
        rows.append(cells)
    heads = ["shape", "points that count: a cell off, two"]
    for kind in ("one grid", "refined"):
        heads += [f"{kind}: a cell off", "two", "median, largest"]
    return [measured(of), "", *markdown(heads, rows)]


# What is written into each document, by the name in its markers.
DOCUMENTS = {
    "README.md": {"figures": figures},
    os.path.join("docs", "scale.md"): {"refined cells": refined_cells, "sides": side_errors, "slopes": slopes},
}


# The lines of the bench that they were written from.
KEPT = os.path.join("docs", "scale.txt")


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def parted(text, path, name):
    """Lines of a document before, between and behind the markers of `name`."""
    lines = text.split("\n")
    begin, end = f"<!-- {name}: written by benches/run table -->", f"<!-- end of {name} -->"
    if lines.count(begin) != 1 or lines.count(end) != 1 or lines.index(begin) > lines.index(end):
        raise Refused(f"{path} has not one line '{begin}' and behind it one line '{end}'")
    at, behind = lines.index(begin), lines.index(end)
    return lines[: at + 1], lines[at + 1 : behind], lines[behind:]


def write(project, of):
    texts = {}
    for document, tables in DOCUMENTS.items():
        path = os.path.join(project, document)
        texts[path] = read(path)
        for name, table in tables.items():
            before, _, behind = parted(texts[path], path, name)
            texts[path] = "\n".join([*before, "", *table(of), "", *behind])
    kept = os.path.join(project, KEPT)
    texts[kept] = "".join(f"{key} = {text}\n" for key, text in of.texts.items())
    for path, text in texts.items():
        new = path + ".new"  # whole or not at all
        with open(new, "w", encoding="utf-8") as file:
            file.write(text)
        if os.path.exists(path):
            shutil.copymode(path, new)
        os.replace(new, path)


def form(lines):
    """The lines of tables, with # for each number; how far what there may be none of goes, is left out."""
    bare = [line.replace("**", "") for line in lines if line.startswith("|")]
    numbered = [re.sub(r"\d+(,\d{3})*(\.\d+)?(e-?\d+)?", "#", line) for line in bare]
    return [line.replace(", to # D", "") for line in numbered]


def check(project):
    kept = os.path.join(project, KEPT)
    of = Output([kept]) if os.path.exists(kept) else None
    for document, tables in DOCUMENTS.items():
        path = os.path.join(project, document)
        for name, table in tables.items():
            block = parted(read(path), path, name)[1]
            if of:
                for line, wanted in itertools.zip_longest(block, ["", *table(of), ""]):
                    if line != wanted:
                        raise Refused(f"{path} has\n  {line}\nwhere {KEPT} gives\n  {wanted}\nin its table of {name}: run benches/run table")
                continue
            expected, found = form(table(Ones())), form(block)
            for line, wanted in zip(found, expected):
                if line != wanted:
                    raise Refused(
                        f"{path} has\n  {line}\nwhere benches/table.py writes\n  {wanted}\nwith other numbers: run benches/run table"
                    )
            if len(found) != len(expected):
                lines = f"{len(found)} lines in its table of {name}, benches/table.py writes {len(expected)}"
                raise Refused(f"{path} has {lines}: run benches/run table")


def main(arguments):
    checking = len(arguments) == 2 and arguments[0] == "--check"
    if not checking and (len(arguments) < 2 or arguments[0].startswith("-")):
        sys.exit(__doc__)
    try:
        if checking:
            check(arguments[1])
        else:
            write(arguments[0], Output(arguments[1:]))
    except (Refused, OSError, UnicodeError) as error:
        sys.exit(f"benches/table.py: {error}" + ("" if checking else "; the documents stay as they were"))


if __name__ == "__main__":
    main(sys.argv[1:])
