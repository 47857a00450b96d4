#!/usr/bin/env python3
"""Draws paper 000's Figure 8 from what `benches/run constraints figure_8` printed, and prints its table as Markdown.

usage: benches/figure_8.py OUTPUT PICTURE
"""
# SPDX-License-Identifier: Apache-2.0 OR MIT
import re
import sys

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

# The bench's names, those of the picture, and how lines look.
LINES = [
    ("field", "field", "C0-o"),
    ("fine_field", "three times as fine", "C4-o"),
    ("hicken_kaur_linear", "Hicken-Kaur", "C1-s"),
    ("hicken_kaur_linear_10_nearest", "Hicken-Kaur, 10 nearest", "C1--s"),
    ("hicken_kaur_quadratic", "quadratic", "C2-^"),
    ("hicken_kaur_quadratic_10_nearest", "quadratic, 10 nearest", "C2--^"),
    ("lin", "Lin", "C3-D"),
]
COLUMNS = ["time", "on_surface", "0.005", "0.01"]


def read(path):
    """Figures by line, number of samples and column; off the surface the root mean square of both sides."""
    text = open(path, encoding="utf-8").read()
    numbers = dict(re.findall(r"^(figure_8_\w+?_n_\d+_[\w.]+) = (\S+)", text, re.M))
    samples = sorted({int(n) for n in re.findall(r"^figure_8_field_n_(\d+)_time", text, re.M)})

    def figure(line, n, column):
        def number(name):
            return float(numbers[f"figure_8_{line}_n_{n}_{name}"])

        if column == "time":
            return number("time")
        if line == "lin":
            return None
        if column == "on_surface":
            return number("on_surface_rms")
        return ((number(f"plus_{column}_rms") ** 2 + number(f"minus_{column}_rms") ** 2) / 2) ** 0.5

    return samples, {line: {c: [figure(line, n, c) for n in samples] for c in COLUMNS} for line, _, _ in LINES}


def draw(samples, figures, path):
    """Three panels, as the paper's."""
    _, (time, on, off) = pyplot.subplots(1, 3, figsize=(13, 4.2), layout="constrained")
    for line, name, look in LINES:
        of = figures[line]
        time.loglog(samples, of["time"], look, label=name, markersize=4)
        if line != "lin":
            on.loglog(samples, of["on_surface"], look, label=name, markersize=4)
        if line in ("field", "fine_field", "hicken_kaur_linear", "hicken_kaur_quadratic"):
            off.loglog(samples, of["0.005"], look, label=f"{name}, 0.005 D", markersize=4)
            off.loglog(samples, of["0.01"], look[:2] + ":" + look[-1], label=f"{name}, 0.01 D", markersize=4)
    time.set_title("value and gradient, ns a point")
    on.set_title("RMS error on the surface, D")
    off.set_title("RMS error beside it, D")
    for axes in (time, on, off):
        axes.set_xlabel("samples")
        axes.grid(alpha=0.3)
        axes.legend(fontsize=7)
    pyplot.savefig(path, dpi=110)


def table(samples, figures):
    """Errors on the surface and 0.01 D beside it, and times."""
    errors = ["field", "fine_field", "hicken_kaur_linear", "hicken_kaur_quadratic"]
    times = ["field", "fine_field", "hicken_kaur_linear", "hicken_kaur_linear_10_nearest", "lin"]
    names = {line: name for line, name, _ in LINES}
    print("| samples | " + " | ".join([names[line] for line in errors] + ["us: " + names[line] for line in times]) + " |")
    print("|--:" * (1 + len(errors) + len(times)) + "|")
    for k, n in enumerate(samples):
        cells = [f"{figures[line]['on_surface'][k]:.1e}; {figures[line]['0.01'][k]:.1e}" for line in errors]
        cells += [f"{figures[line]['time'][k] / 1000:.3g}" for line in times]
        print(f"| {n:,} | " + " | ".join(cells) + " |")


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    samples, figures = read(sys.argv[1])
    draw(samples, figures, sys.argv[2])
    table(samples, figures)


if __name__ == "__main__":
    main()
