#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0 OR MIT
"""Tests table.py, and that the tables of the documents are those that it writes."""

import os
import re
import shutil
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
import table  # noqa: E402

PROJECT = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir)


class Asked(table.Ones):
    """Notes which figures the tables ask for."""

    def text(self, key):
        self.texts[key] = "1"
        return "1"


class Tables(unittest.TestCase):
    def setUp(self):
        self.room = tempfile.TemporaryDirectory()
        self.addCleanup(self.room.cleanup)
        self.project = os.path.join(self.room.name, "project")
        os.makedirs(os.path.join(self.project, "docs"))
        self.documents = [os.path.join(self.project, document) for document in table.DOCUMENTS]
        for document in table.DOCUMENTS:
            shutil.copy(os.path.join(PROJECT, document), os.path.join(self.project, document))
        self.readme, self.scale = self.documents
        asked = Asked()
        for tables in table.DOCUMENTS.values():
            for lines in tables.values():
                lines(asked)
        self.figures = asked.texts

    def output(self, figures):
        path = os.path.join(self.room.name, "output")
        with open(path, "w", encoding="utf-8") as file:
            file.writelines(f"{key} = {text}\n" for key, text in figures.items())
        return table.Output([path])

    def texts(self):
        return [table.read(path) for path in self.documents]

    def parted(self, path, name):
        return table.parted(table.read(path), path, name)

    def written(self, path=None, name="figures", **figures):
        table.write(self.project, self.output({**self.figures, **figures}))
        return self.parted(path or self.readme, name)[1]

    def refused(self, figures, saying):
        before = self.texts()
        with self.assertRaisesRegex(table.Refused, saying):
            table.write(self.project, self.output(figures))
        self.assertEqual(self.texts(), before)

    def change(self, path, old, new):
        text = table.read(path)
        self.assertIn(old, text)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text.replace(old, new, 1))

    def test_the_documents_are_as_written(self):
        table.check(PROJECT)

    def test_another_form_is_told(self):
        self.change(self.readme, "| goal |", "| aim |")
        self.assertRaisesRegex(table.Refused, "run benches/run table", table.check, self.project)

    def test_another_form_is_told_of_each_document(self):
        self.change(self.scale, "| femur |", "| thigh |")
        self.assertRaisesRegex(table.Refused, "scale.md has\n  . thigh", table.check, self.project)
        self.change(self.scale, "| thigh |", "| femur |")
        table.check(self.project)
        lines = table.read(self.scale).split("\n")
        self.change(self.scale, next(line for line in lines if line.startswith("| dragon | 1e-3")) + "\n", "")
        self.assertRaises(table.Refused, table.check, self.project)

    def test_only_what_is_between_the_markers_changes(self):
        names = [(os.path.join(self.project, document), name) for document, tables in table.DOCUMENTS.items() for name in tables]
        before = [self.parted(*at)[::2] for at in names]
        first = self.written(fit_1e6_seconds="2.5 s")
        self.assertEqual(self.written(fit_1e6_seconds="2.5 s"), first)
        self.assertEqual(self.parted(self.readme, "figures"), (before[0][0], first, before[0][1]))
        # Of several in one document, what comes before the first and behind the last.
        self.assertEqual(self.parted(*names[1])[0], before[1][0])
        self.assertEqual(self.parted(*names[-1])[2], before[-1][1])
        self.assertEqual(sorted(os.listdir(self.project)), ["README.md", "docs"])
        self.assertEqual(sorted(os.listdir(os.path.join(self.project, "docs"))), ["scale.md", "scale.txt"])
        table.check(self.project)

    def test_another_number_than_that_of_the_output_is_told(self):
        self.written(fit_1e6_seconds="2.5 s")
        table.check(self.project)
        self.change(self.readme, "| **2.5** s |", "| **2.4** s |")
        self.assertRaisesRegex(table.Refused, r"\*\*2.4\*\* s(.|\n)*\*\*2.5\*\* s", table.check, self.project)
        self.written(fit_1e6_seconds="2.5 s")
        self.change(self.scale, "| femur | 1", "| femur | 7")
        self.assertRaisesRegex(table.Refused, "scale.txt gives", table.check, self.project)

    def test_an_output_that_lacks_a_figure_is_told(self):
        self.written()
        kept = os.path.join(self.project, table.KEPT)
        lines = [line for line in table.read(kept).splitlines(True) if not line.startswith("fit_1e6_seconds")]
        with open(kept, "w", encoding="utf-8") as file:
            file.writelines(lines)
        self.assertRaisesRegex(table.Refused, "there is no fit_1e6_seconds", table.check, self.project)

    def test_figures_of_docs_scale_are_those_of_the_output(self):
        key = "accuracy_fandisk_refined_1e-03_"
        figures = {key + "rms": "9.9e-05 D", key + "max": "0.00113 D", key + "control_points": "168600", key + "levels": "4"}
        rows = [line for line in self.written(self.scale, "refined cells", **figures) if line.startswith("| fandisk")]
        self.assertEqual(rows[0], "| fandisk | 2e-3 | 1 | 1 | 1, 1 D | 1 s | 1, 1 D, 1 s | 1, 1 D, 1 s |")
        self.assertEqual(rows[1], "| fandisk | 1e-3 | 168,600 | 4 | 9.9e-5, 1.1e-3 D | 1 s |  |  |")
        figures = {"sides_femur_cgal_one_grid_wrong_signs": "0", "sides_femur_cgal_refined_wrong_signs": "3"}
        [row] = [line for line in self.written(self.scale, "sides", **figures) if line.startswith("| femur")]
        self.assertEqual(row, "| femur | 0 | 3, to 1 D | 1 | 1 |")
        figures = {"sides_rotor_away_points": "8", "sides_rotor_away_points_a_cell_off_medial_axis": "6"}
        figures["sides_rotor_refined_two_cells_off_medial_axis_gradient_off_1_beyond_0.2"] = "2.94 %"
        [row] = [line for line in self.written(self.scale, "slopes", **figures) if line.startswith("| rotor")]
        self.assertEqual(row, "| rotor | 75 %, 12 % | 1 % | 1 % | 1, 1 | 1 % | 2.94 % | 1, 1 |")

    def test_what_misses_its_goal_by_little_does_not_look_like_it(self):
        self.assertEqual(table.listed([1.0e-3, 1.02e-3, 1.00004e-3], "D", [1.0e-3] * 3), "1.0e-3; **1.02e-3**; **1.00004e-3** D")
        self.assertEqual(table.listed([8.0, 8.001, 15.2], "s", [8, 8, 15]), "8; **8.001**; **15.2** s")
        self.assertEqual(table.listed([1500, 1500.4], "MB", [1500, 1500]), "1,500; **1,500.4** MB")

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

    def test_a_document_without_markers_is_refused(self):
        for path in reversed(self.documents):
            with open(path, "w", encoding="utf-8") as file:
                file.write("no tables\n")
            self.refused(self.figures, os.path.basename(path) + " has not one line")


if __name__ == "__main__":
    unittest.main()
