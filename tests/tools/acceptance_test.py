"""The means of tools/acceptance: exact where they say so, and able to say no."""

import contextlib
import io
import pathlib
import sys
import tempfile
import unittest
from fractions import Fraction

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools/acceptance"))

from ledger import Ledger  # noqa: E402
from part21 import StepFile  # noqa: E402
from solids import ulps  # noqa: E402
from whole_solids import LEFT_OPEN, Face, judge  # noqa: E402
from splines import Surface, basis, flux, span_polynomials  # noqa: E402

KNOTS = [0.0, 0.0, 0.0, 0.5, 1.25, 1.25, 3.0, 3.0, 3.0]  # degree 2, a double knot

STEP = """ISO-10303-21;
DATA;
#1=CARTESIAN_POINT('a;b #9',(0.,0.,0.));
#2 = CARTESIAN_POINT('',(0.0E+00,
  2.,0.));
#3=CARTESIAN_POINT('',(1.,0.,0.));
#4=CARTESIAN_POINT('',(1.,2.,3.));
#5=B_SPLINE_SURFACE_WITH_KNOTS('',1,1,((#1,#2),(#3,#4)),.UNSPECIFIED.,.F.,.F.,.F.,(2,2),(2,2),
  (0.,1.),(0.,1.),.UNSPECIFIED.);
ENDSEC;
"""


class FakeProbe:
    """Answers like isochor_solid_probe, from tables."""

    def __init__(self, slow, faces=None, third=None):
        self.slow, self.faces, self.third = slow, faces, third

    def run(self, _path, _number, method, argument, *_):
        if method == "adaptive":
            value = self.slow.get(argument)
            return None if value is None else {"volume": value}
        if method == "faces":
            return self.faces and {"faces": self.faces}
        return self.third


class WholeSolids(unittest.TestCase):
    OURS = {"cones": 100.0, "cones_bound": 1e-11, "spread": 1e-12, "tolerance": 1e-7, "edge_gap": 0.0,
            "area": 100.0, "open": 1e-6}
    FACES = {0: Face(60.0, 60.0, 1e-12), 1: Face(40.0, 40.0 + 1e-6, 1e-12)}

    def verdict(self, *answers, **changes):
        return judge(FakeProbe(*answers), ("solid.step", 0), {**self.OURS, **changes})[:2]

    def test_agreement(self):
        near = {"1e-10": 100.0 + 1e-8, "1e-12": 100.0 - 5e-12}
        self.assertEqual(self.verdict(near), ("within our bound", []))
        moving = {"1e-10": 100.0 + 3e-9, "1e-12": 100.0 + 1e-9}
        self.assertEqual(self.verdict(moving), ("within its last change", []))
        lost = {"1e-10": 101.0, "1e-12": 100.1, "1e-14": 100.03}
        self.assertEqual(self.verdict(lost), ("not converged", []))
        self.assertEqual(self.verdict({"1e-10": 100.0}), ("no result of OpenCASCADE in time", []))

    def test_disagreement_is_settled_by_the_third_method(self):
        off = dict.fromkeys(("1e-10", "1e-12", "1e-14"), 100.0 + 1e-6)

        def third(volume, change=1e-9, left_open=0.0):
            return {"volume": volume, "change": change, "open": left_open}

        for answer, expected in ((third(40.0), "OpenCASCADE is wrong"),
                                 (third(40.0, left_open=1e-6), "OpenCASCADE " + LEFT_OPEN),
                                 (third(40.0 + 1e-6), "OURS"),
                                 (third(40.0 + 5e-7), "UNEXPLAINED"),
                                 (third(40.0, change=1e-6), "UNEXPLAINED"), (None, "UNEXPLAINED")):
            verdict, reasons = self.verdict(off, self.FACES, answer)
            self.assertEqual(verdict, expected)
            self.assertEqual(len(reasons), 1)
            self.assertIn("face 2", reasons[0])
        left_open = third(40.0, left_open=1e-6)
        self.assertEqual(self.verdict(off, self.FACES, left_open, open=1e-9)[0], "UNEXPLAINED")
        same = {0: Face(60.0, 60.0, 1e-12)}
        self.assertEqual(self.verdict(off, same), ("UNEXPLAINED", []))
        self.assertEqual(self.verdict(off)[0], "UNEXPLAINED")

    def test_axes_that_differ_beyond_the_gaps_are_ours(self):
        near = {"1e-10": 100.0, "1e-12": 100.0}
        self.assertEqual(self.verdict(near, spread=1e-6)[0], "within our bound")
        self.assertEqual(self.verdict(near, spread=1e-4)[0], "OURS")
        self.assertEqual(self.verdict(near, spread=float("nan"))[0], "OURS")


class Splines(unittest.TestCase):
    def test_basis_is_the_polynomials_of_its_span(self):
        for t in (Fraction(1, 4), Fraction(1, 2), Fraction(7, 5), Fraction(3)):
            first, values = basis(2, KNOTS, t)
            self.assertEqual(sum(values), 1)
            k = first + 2
            rows, denominator = span_polynomials(2, KNOTS, k)
            s = (t - Fraction(KNOTS[k])) / (Fraction(KNOTS[k + 1]) - Fraction(KNOTS[k]))
            self.assertEqual(values, [Fraction(c0 + c1 * s + c2 * s * s) / denominator
                                      for c0, c1, c2 in rows])

    def test_flux_by_hand(self):
        # x = u, y = 2 v, z = 3 u v: y dz dx = 2 v (z_u x_v - z_v x_u) = -6 u v, over the square -3/2.
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "patch.step"
            path.write_text(STEP)
            step = StepFile(path)
            surface = step.surface(step.of_type("B_SPLINE_SURFACE_WITH_KNOTS")[0])
            with self.assertRaisesRegex(ValueError, "#1 is CARTESIAN_POINT"):
                step.surface(1)
        self.assertEqual(surface.at(0.5, 0.5), (0.5, 1.0, 0.75))
        self.assertEqual(flux(surface), Fraction(-3, 2))

    def test_flux_does_not_depend_on_knots(self):
        grid = [[(0.5 * i * i, j + 0.25 * i, 0.125 * i * j * j) for j in range(6)] for i in range(3)]
        flat = Surface((2, 2), [0.0] * 3 + [1.0] * 3, KNOTS, grid)
        wide = Surface((2, 2), [4.0] * 3 + [9.0] * 3, [8 * t - 1 for t in KNOTS], grid)
        self.assertEqual(flux(flat), flux(wide))
        self.assertNotEqual(flux(flat), 0)


class Verdicts(unittest.TestCase):
    def finish(self, *laws):
        ledger = Ledger()
        with contextlib.redirect_stdout(io.StringIO()) as text:
            for measured, bound in laws:
                ledger.law("law", measured, bound)
            status = ledger.finish()
        return status, text.getvalue()

    def test_only_laws_that_hold_are_ok(self):
        self.assertEqual(self.finish((1e-14, 1e-13))[0], 0)
        for broken in ((2e-13, 1e-13), (float("nan"), 1e-13)):
            status, text = self.finish((0, 1), broken)
            self.assertEqual(status, 1)
            self.assertIn("NOT OK: 1 of 2", text)

    def test_nothing_measured_is_not_ok(self):
        self.assertEqual(self.finish()[0], 1)

    def test_ulps(self):
        self.assertEqual([ulps(1.0, 1.0), ulps(1.0, 1.0 + 2.0 ** -52), ulps(0.0, -0.0)], [0, 1, 0])
        self.assertEqual(ulps(5e-324, -5e-324), 2)


if __name__ == "__main__":
    unittest.main()
