#!/usr/bin/env python3
"""Runs the bundled edits of the STEP solids and checks what was written, number by number.

usage: solids.py ISOCHOR [--out FOLDER]

For each edit of data/edits on a solid: the volume is kept to 1e-13 by the program's own measure and by
a second one, made here in rational numbers from the poles in both files; the asked point is reached;
the file is valid, no tolerance or gap grew; what lies outside the extent has the same bits; names and
colours stay. After the refined edit near a window: the bulge comes near, the window did not move.

The second measure is the integral of y dz dx over the B-spline faces, where the program integrates
z dx dy. It is the whole volume, because on every flat face of these models dx is zero or dz is a
multiple of dx. Window faces lie on the skin's surface; skin and windows together cover its domain once, and no
moved pole acts inside a window (checked), so the skin's surface is integrated over all of its domain.

Exit status 1 when a law is broken.
"""
import argparse
import json
import math
import pathlib
import re
import struct
import sys
import tempfile
from fractions import Fraction

from ledger import Ledger, run, run_json
from part21 import StepFile
from splines import Curve, Line, Surface, flux, pole_bits

DATA = pathlib.Path(__file__).resolve().parents[2] / "data"
CASES = [("fuselage.step", "fuselage_pull.json"), ("fuselage.step", "fuselage_window.json"),
         ("fuselage12.step", "fuselage12_pull.json"), ("hull.step", "hull_pull.json")]
KEPT = 1e-13          # relative change of the volume
REACHED = 1e-12       # distance from the asked point, over the size of the model
COLOUR = 1e-6         # colours pass through single precision
ROUNDING = 2.0 ** -50  # of coordinates, over the size of the model: what a gap may differ by
BULGE = 0.1           # the bulge: where the surface moved by this part of the largest displacement
SPANS = 2             # ... and how near to a window it must come, in spans of the refined surface


class Solid:
    """The faces of a file, with surfaces; `sheets` are the faces that are integrated."""

    def __init__(self, path):
        self.path, self.file = path, StepFile(path)
        self.faces = self.file.faces()
        self.surfaces = [self.file.surface(face.surface) for face in self.faces]
        colours = self.file.colours()
        self.colours = [colours[face.entity] for face in self.faces]

    def sheets(self):
        """The first face of each B-spline surface: the others lie on the same one."""
        first = {}
        for k, surface in enumerate(self.surfaces):
            if isinstance(surface, Surface):
                first.setdefault(self.faces[k].surface, k)
        return list(first.values())

    def volume(self, sheets):
        return sum(flux(self.surfaces[k]) * (1 if self.faces[k].same_sense else -1) for k in sheets)

    def size(self, sheets):
        """Diagonal of the box of surface points at the knots."""
        points = [s.at(u, v) for s in (self.surfaces[k] for k in sheets)
                  for u in breaks(s.u_knots) for v in breaks(s.v_knots)]
        return math.dist(*zip(*((min(c), max(c)) for c in zip(*points))))


def breaks(knots):
    return sorted(set(knots))


def edge_range(edge):
    """Parameters of the edge's curve at its ends."""
    curve = edge.curve
    if isinstance(curve, Curve):
        return curve.domain()
    length = sum(d * d for d in curve.direction)
    return [sum((p - o) * d for p, o, d in zip(end, curve.origin, curve.direction)) / length
            for end in edge.ends]


def edge_points(edge, curve, steps=8):
    begin, end = edge_range(edge)
    return [curve.at(begin + (end - begin) * k / steps) for k in range(steps + 1)]


def gaps(solid):
    """Largest distances: edge curve to surface at equal parameters, vertex to the curve's end."""
    at_surface = at_vertex = 0.0
    for face, surface in zip(solid.faces, solid.surfaces):
        for edge in solid.file.edges(face):
            points = edge_points(edge, edge.curve)
            at_vertex = max(at_vertex, math.dist(points[0], edge.ends[0]),
                            math.dist(points[-1], edge.ends[1]))
            for curve in edge.parameter_curves:
                for point, uv in zip(points, edge_points(edge, curve)):
                    at_surface = max(at_surface, math.dist(point, surface.at(*uv)))
    return at_surface, at_vertex


def outline(solid, k):
    """(u0, u1, v0, v1) around a face's edges in its parameters."""
    points = [uv for edge in solid.file.edges(solid.faces[k])
              for curve in edge.parameter_curves for uv in edge_points(edge, curve)]
    us, vs = zip(*points)
    return min(us), max(us), min(vs), max(vs)


def ulps(a, b):
    """How many doubles lie between two numbers."""
    def rank(x):
        bits, = struct.unpack("<q", struct.pack("<d", x))
        return bits if bits >= 0 else -(bits & 0x7FFFFFFFFFFFFFFF)
    return abs(rank(a) - rank(b))


def check_volume(ledger, before, after, report, sheets):
    exact_before, exact_after = before.volume(sheets), after.volume(sheets)
    readme = (DATA / "step/README.md").read_text(encoding="utf-8")
    stated = re.search(rf"`{before.path.name}`.*?(\d+\.\d{{20}}) ", readme)[1]
    ledger.law("rational volume of the input - the one in data/step/README.md",
               abs(exact_before - Fraction(stated)), 1e-20)
    change = (exact_after - exact_before) / exact_before
    ledger.law("relative change of volume, rational, from both files", abs(change), KEPT)
    own = report["edits"][-1]["volume"]
    ledger.law("relative change of volume, the program's report", abs(own["relative_change"]), KEPT)
    ledger.law("  report and rational measure agree, relative to the volume",
               abs(change - Fraction(own["relative_change"])), own["bound"] + ROUNDING)
    return exact_before, exact_after


def check_program_volume(ledger, isochor, solid, exact, text):
    told = run_json(isochor, "volume", solid.path)
    ledger.law(f"`isochor volume` of the {text} - rational volume, within its bound",
               abs(Fraction(told["volume"]) - exact), told["bound"])


def check_moves(ledger, before, after, edits, size):
    names = [face.name for face in before.faces]
    for move in edits["edits"][-1]["move"]:
        k, uv = names.index(move["patch"]), [Fraction(t) for t in move["uv"]]
        start, end = before.surfaces[k].at(*uv), after.surfaces[k].at(*uv)
        wanted = [s + Fraction(b) for s, b in zip(start, move["by"])]
        ledger.law("distance from the asked point, over the size of the model",
                   math.dist([float(e - w) for e, w in zip(end, wanted)], (0, 0, 0)) / size, REACHED)


def check_validity(ledger, isochor, before, after, size):
    was, now = (run_json(isochor, "check", solid.path) for solid in (before, after))
    ledger.fact("valid and closed before and after", was["valid"] and now["valid"] and
                was["closed"] and now["closed"])
    ledger.law("largest tolerance, and that of the input", now["max_tolerance"], was["max_tolerance"])
    rounding = ROUNDING * size
    ledger.law("largest gap, the program's measure, and that of the input (+ rounding)",
               now["max_gap"], was["max_gap"] + rounding)
    for text, new, old in zip(("edge to surface", "vertex to edge"), gaps(after), gaps(before)):
        ledger.law(f"largest gap, {text}, and that of the input (+ rounding)", new, old + rounding)


def check_untouched(ledger, before, after, report):
    """Faces the report does not call edited, poles outside the extent, flat faces, names, colours."""
    same = moved = far = edges = changed_edges = 0
    for k, (old, new) in enumerate(zip(before.surfaces, after.surfaces)):
        if not isinstance(old, Surface):
            far = max(far, *map(ulps, old.numbers, new.numbers))
        elif old.bits() == new.bits():
            same += 1
        else:
            moved += 1
            continue
        bits, bits_after = edge_bits(before, k), edge_bits(after, k)
        edges += len(bits)
        changed_edges += sum(a != b for a, b in zip(bits, bits_after, strict=True))
    told = report["check"]
    ledger.fact("every B-spline face outside the extent has the same bits",
                moved == told["edited_faces"] and same == told["untouched_bspline_faces_identical"],
                f"{same} of {same + moved}")
    ledger.fact("edges of those and of the flat faces, with vertices, that lost a bit",
                changed_edges == 0, f"{changed_edges} of {edges}")
    ledger.law("flat faces, units in the last place", far, 4)
    names, names_after = ([face.name for face in solid.faces] for solid in (before, after))
    ledger.fact("names and their order", names == names_after, f"{len(names)} faces")
    ledger.law("colours", max(abs(a - b) for old, new in zip(before.colours, after.colours)
                              for a, b in zip(old, new)), COLOUR)


def moved_poles(old, new):
    """Indices, where both surfaces have the same knots."""
    return [(i, j) for i, row in enumerate(old.poles) for j, pole in enumerate(row)
            if pole_bits(pole) != pole_bits(new.poles[i][j])]


def windows_on(solid, sheet):
    """Boxes of the other faces that lie on the same surface."""
    return [outline(solid, k) for k, face in enumerate(solid.faces)
            if k != sheet and face.surface == solid.faces[sheet].surface]


def same_poles_mean_same_surface(old, new):
    """The first and the last knot act nowhere in the domain."""
    return old.u_knots[1:-1] == new.u_knots[1:-1] and old.v_knots[1:-1] == new.v_knots[1:-1]


def check_windows_apart(ledger, before, after, sheets, size):
    """The integrated surface is the same where other faces lie on it."""
    for sheet in sheets:
        old, new, boxes = before.surfaces[sheet], after.surfaces[sheet], windows_on(before, sheet)
        if not boxes:
            continue
        if same_poles_mean_same_surface(old, new):
            supports = [new.support(*pole) for pole in moved_poles(old, new)]
            acting = sum(any(u0 < b[1] and b[0] < u1 and v0 < b[3] and b[2] < v1 for b in boxes)
                         for u0, u1, v0, v1 in supports)
            ledger.fact(f"moved poles that act inside one of {len(boxes)} windows", acting == 0,
                        f"{acting} of {len(supports)}")
        else:
            ledger.law(f"displacement inside {len(boxes)} windows: rounding of the refinement",
                       max(displacement(old, new, box) for box in boxes), ROUNDING * size)


def displacement(old, new, box, steps=8):
    u0, u1, v0, v1 = box
    grid = [(u0 + (u1 - u0) * a / steps, v0 + (v1 - v0) * b / steps)
            for a in range(steps + 1) for b in range(steps + 1)]
    return max(math.dist(old.at(*uv), new.at(*uv)) for uv in grid)


def check_window(ledger, before, after, edits):
    """The bulge comes within SPANS spans of a window (whose edges check_untouched compares)."""
    box = edits["edits"][-1]["extent"]["box"]
    sheet = [face.name for face in before.faces].index(box["patch"])
    old, new = before.surfaces[sheet], after.surfaces[sheet]
    us, vs = (halved([t for t in breaks(k) if low <= t <= high])
              for k, (low, high) in ((new.u_knots, box["u"]), (new.v_knots, box["v"])))
    moved = {(u, v): math.dist(old.at(u, v), new.at(u, v)) for u in us for v in vs}
    top = max(moved.values())
    bulge = [uv for uv, distance in moved.items() if distance >= BULGE * top]
    steps = 2 * (us[1] - us[0]), 2 * (vs[1] - vs[0])  # one span each: the refinement is uniform
    nearest, name = min(
        (min(max(outside(u, low_u, high_u) / steps[0], outside(v, low_v, high_v) / steps[1])
             for u, v in bulge), before.faces[k].name)
        for k, (low_u, high_u, low_v, high_v) in
        ((k, outline(before, k)) for k, face in enumerate(before.faces) if "window" in face.name))
    ledger.law(f'spans from the bulge ({BULGE:.0%} of {top:.3g}) to "{name}"', nearest, SPANS)


def halved(breaks_):
    return sorted(breaks_ + [(a + b) / 2 for a, b in zip(breaks_, breaks_[1:])])


def outside(t, low, high):
    return max(low - t, t - high, 0.0)


def edge_bits(solid, k):
    """Curves, vertices and parameter curves of a face, letter by letter. Not the parameter curves of
    flat faces: these are projections of the edge, which readers make anew."""
    def curve_bits(curve):
        if isinstance(curve, Line):
            return pole_bits(curve.origin) + pole_bits(curve.direction)
        return [t.hex() for t in curve.knots], [pole_bits(p) for p in curve.poles]
    on_spline = isinstance(solid.surfaces[k], Surface)
    return [(curve_bits(e.curve), [pole_bits(p) for p in e.ends],
             [curve_bits(c) for c in e.parameter_curves if on_spline])
            for e in solid.file.edges(solid.faces[k])]


def examine(ledger, isochor, model, script, out):
    ledger.section(f"{script} on {model}")
    result, report_path = out / script.replace(".json", ".step"), out / script
    run(isochor, "edit", DATA / "step" / model, DATA / "edits" / script, "-o", result,
        "--report", report_path)
    before, after = Solid(DATA / "step" / model), Solid(result)
    edits = json.loads((DATA / "edits" / script).read_text(encoding="utf-8"))
    report = json.loads(report_path.read_text(encoding="utf-8"))
    sheets = before.sheets()
    size = before.size(sheets)
    exact_before, exact_after = check_volume(ledger, before, after, report, sheets)
    check_program_volume(ledger, isochor, before, exact_before, "input")
    check_program_volume(ledger, isochor, after, exact_after, "output")
    check_moves(ledger, before, after, edits, size)
    check_validity(ledger, isochor, before, after, size)
    check_untouched(ledger, before, after, report)
    check_windows_apart(ledger, before, after, sheets, size)
    if "refine" in edits["edits"][-1]:
        check_window(ledger, before, after, edits)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("isochor")
    parser.add_argument("--out", type=pathlib.Path)
    options = parser.parse_args()
    ledger = Ledger()
    with tempfile.TemporaryDirectory(prefix="isochor-solids-") as temporary:
        out = options.out or pathlib.Path(temporary)
        out.mkdir(parents=True, exist_ok=True)
        for model, script in CASES:
            examine(ledger, options.isochor, model, script, out)
    return ledger.finish()


if __name__ == "__main__":
    sys.exit(main())
