"""The program that remakes the thesis' figures, run with few matrices.

usage: figures_test.py PROGRAM
"""

import csv
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

PROGRAM = sys.argv.pop() if len(sys.argv) > 1 else None
PLOTS = ["figure_2_3_rank", "figure_7_1", "figure_7_2", "figure_7_2_on_the_way"] + [
    f"figure_7_{k}" for k in range(3, 11)
]
IMAGES = pathlib.Path(__file__).resolve().parents[2] / "docs" / "images" / "ecles"


def run(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)


def columns(path):
    """The columns of a table by name, as numbers by abscissa; empty cells left out."""
    with open(path, newline="") as file:
        head, *lines = csv.reader(file)
    return {
        name: {float(line[0]): float(line[k]) for line in lines if line[k]}
        for k, name in enumerate(head)
        if k > 0
    }


class Figures(unittest.TestCase):
    def test_every_figure_is_written_and_the_same_again(self):
        with tempfile.TemporaryDirectory() as folder:
            first, second = pathlib.Path(folder, "a", "b"), pathlib.Path(folder, "c")
            for target in (first, second):
                result = run(target, "--matrices", 2)
                self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn("discarded though independent: 1", result.stdout)
            names = {f"{name}.{ending}" for name in PLOTS for ending in ("svg", "csv")}
            names.add("figure_2_3.svg")
            self.assertEqual({path.name for path in first.iterdir()}, names)
            for name in names:
                self.assertEqual(
                    first.joinpath(name).read_bytes(), second.joinpath(name).read_bytes(), name
                )
                if name.endswith(".svg"):
                    root = xml.etree.ElementTree.parse(first / name).getroot()
                    self.assertEqual(root.tag, "{http://www.w3.org/2000/svg}svg")
                else:
                    table = columns(first / name)
                    self.assertGreaterEqual(len(table), 3)
                    self.assertTrue(all(min(values.values()) > 0 for values in table.values()))

    def test_the_documented_numbers_say_what_the_page_says(self):
        ranks = columns(IMAGES / "figure_2_3_rank.csv")
        self.assertEqual(set(ranks["exact"].values()), {18})
        self.assertEqual(ranks["QR, threshold 1e-10"][40], 17)
        plain = columns(IMAGES / "figure_7_1.csv")["U"]
        for m in range(6, 15):  # doubles with each row until there are as many as columns
            self.assertAlmostEqual(plain[m + 1] / plain[m], 2, delta=0.2)
        self.assertLessEqual(max(plain[m] for m in range(17, 21)), plain[16])
        end = columns(IMAGES / "figure_7_2.csv")
        for name in "ULD":  # linear: twice the rows, about twice the bits
            self.assertAlmostEqual(end[name][40] / end[name][20], 2, delta=0.35)
        way = columns(IMAGES / "figure_7_2_on_the_way.csv")
        for name in ("L on the way", "D on the way"):  # quadratic
            self.assertAlmostEqual(way[name][40] / way[name][20], 4, delta=0.6)
        sparse = columns(IMAGES / "figure_7_8.csv")
        self.assertGreater(sparse["Turner"][10], 3 * sparse["GCD"][10])

    def test_wrong_commands_are_refused(self):
        for arguments in ([], ["x", "y"], ["x", "--matrices", "0"], ["x", "--matrices", "-3"]):
            result = run(*arguments)
            self.assertEqual(result.returncode, 2)
            self.assertIn("usage: isochor_thesis_figures OUTDIR", result.stderr)
        with tempfile.NamedTemporaryFile() as file:
            result = run(pathlib.Path(file.name, "below"), "--matrices", 1)
            self.assertEqual(result.returncode, 1)
            self.assertIn(file.name, result.stderr)


if __name__ == "__main__":
    unittest.main()
