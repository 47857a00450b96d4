#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0 OR MIT
"""Tests table.py, and that the README's tables have the form that it writes."""

import os
import re
import shutil
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
import table  # noqa: E402

README = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "README.md")


class Asked(table.Ones):
    """Notes which figures the tables ask for."""

    def text(self, key):
        self.texts[key] = "1"
        return "1"


class Tables(unittest.TestCase):
    def setUp(self):
        self.room = tempfile.TemporaryDirectory()
        self.addCleanup(self.room.cleanup)
        self.readme = os.path.join(self.room.name, "README.md")
        shutil.copy(README, self.readme)
        asked = Asked()
        table.tables(asked)
        self.figures = asked.texts

    def output(self, figures):
        path = os.path.join(self.room.name, "output")
        with open(path, "w", encoding="utf-8") as file:
            file.writelines(f"{key} = {text}\n" for key, text in figures.items())
        return table.Output([path])

    def written(self, **figures):
        table.write(self.readme, self.output({**self.figures, **figures}))
        return table.parted(self.readme)[1]

    def refused(self, figures, saying):
        before = table.read(self.readme)
        with self.assertRaisesRegex(table.Refused, saying):
            table.write(self.readme, self.output(figures))
        self.assertEqual(table.read(self.readme), before)

    def test_the_readme_has_the_form(self):
        table.check(README)

    def test_another_form_is_told(self):
        with open(self.readme, "w", encoding="utf-8") as file:
            file.write(table.read(README).replace("| goal |", "| aim |", 1))
        self.assertRaisesRegex(table.Refused, "run benches/run table", table.check, self.readme)

    def test_only_what_is_between_the_markers_changes(self):
        before, _, behind = table.parted(self.readme)
        first = self.written(fit_1e6_seconds="2.5 s")
        self.assertEqual(self.written(fit_1e6_seconds="2.5 s"), first)
        self.assertEqual(table.parted(self.readme), (before, first, behind))
        self.assertEqual(sorted(os.listdir(self.room.name)), ["README.md", "output"])
        table.check(self.readme)

    def test_figures_above_their_goals_are_marked(self):
        [line] = [line for line in self.written() if "10^6, two threads" in line]
        self.assertEqual(line, "| fit of 10^6, two threads | 1 s | 1 s | |")
        [line] = [line for line in self.written(fit_1e6_seconds="2.5 s") if "10^6, two threads" in line]
        self.assertEqual(line, "| fit of 10^6, two threads | **2.5** s | 1 s | |")
        [line] = [line for line in self.written(accuracy_bunny_goal_max="0.5 D") if line.startswith("| 10^6")]
        self.assertEqual(line.split("|")[4], " 1; **1** D, 1 s ")

    def test_a_figure_that_is_missing_is_named_and_nothing_written(self):
        self.assertGreater(len(self.figures), 100)
        for key in self.figures:
            grid = re.match(r"(accuracy_[a-z]+_)1_", key)  # any grid would do
            self.refused({other: text for other, text in self.figures.items() if other != key}, grid[1] if grid else key)

    def test_what_is_no_number_is_refused(self):
        self.refused({**self.figures, "fit_1e6_seconds": "not for this machine"}, "fit_1e6_seconds is 'not for this machine'")
        self.refused({**self.figures, "fit_1e6_seconds": "nan s"}, "fit_1e6_seconds is 'nan s'")

    def test_a_readme_without_markers_is_refused(self):
        with open(self.readme, "w", encoding="utf-8") as file:
            file.write("no tables\n")
        self.refused(self.figures, "has not one line")


if __name__ == "__main__":
    unittest.main()
