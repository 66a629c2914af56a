#!/usr/bin/env python3
"""Half models closed by planes agree with their whole models: volume, moments and shape after an edit.

usage: half_models.py ISOCHOR [--out FOLDER]

The bundled hull and fuselage are cut to their B-spline skins, half (one side; the fuselage's skin is cut
along the crown) and whole (both sides). The half is closed by its mirror plane; stern, deck and aft cap are closed by planes in
both. The same edit is made on both, the whole model held symmetric, the half model closed by the mirror
plane. Poles are compared one by one. Exit status 1 when a law is broken.
"""
import argparse
import json
import pathlib
import sys
import tempfile
from fractions import Fraction

from ledger import Ledger, run, run_json
from part21 import StepFile
from splines import Surface

DATA = pathlib.Path(__file__).resolve().parents[2] / "data" / "step"
AGREE = 1e-12
KEPT = 1e-13


class Case:
    def __init__(self, file, planes, side, edit, close):
        self.file, self.planes, self.side, self.edit = file, planes, side, edit
        self.close = close  # the other planes, as an edits file has them


CASES = [
    Case("hull.step", ["x=0", "-0.03125,0,1,4.5"], -1,
         {"name": "fuller shoulders", "scale": {"every": 2}, "extent": {"radius": 9.0},
          "move": [{"patch": "starboard", "uv": [14, 8], "by": [0, -0.4, 0.1]}],
          "method": "isotropic", "metric": "coefficients"},
         [{"plane": {"normal": [1, 0, 0], "offset": 0}},
          {"plane": {"normal": [-0.03125, 0, 1], "offset": 4.5}}]),
    Case("hull.step", ["x=0", "-0.03125,0,1,4.5"], -1,
         {"name": "lift the sheer", "scale": {"every": 2}, "extent": {"radius": 9.0},
          "move": [{"patch": "starboard", "uv": [14, 12], "by": [0, -0.3, 0]}],
          "method": "isotropic", "metric": "coefficients"},
         [{"plane": {"normal": [1, 0, 0], "offset": 0}},
          {"plane": {"normal": [-0.03125, 0, 1], "offset": 4.5}}]),
    Case("fuselage.step", ["x=28"], 0,
         {"name": "raise the crown", "extent": {"radius": 3.5},
          "move": [{"patch": "starboard", "uv": [24, 16], "by": [0.1, 0, 0.3]}],
          "method": "isotropic", "metric": "coefficients"},
         [{"plane": {"normal": [1, 0, 0], "offset": 28}}]),
    Case("fuselage.step", ["x=28"], 0,
         {"name": "fuller tail", "extent": {"radius": 4},
          "move": [{"patch": "starboard", "uv": [46, 10], "by": [0, 0.1, 0.1]}],
          "method": "isotropic", "metric": "coefficients"},
         [{"plane": {"normal": [1, 0, 0], "offset": 28}}])]


def skins(path):
    """[(name, surface, outward)] of the B-spline faces."""
    file = StepFile(path)
    found = []
    for face in file.faces():
        surface = file.surface(face.surface)
        if isinstance(surface, Surface):
            found.append((face.name, surface, face.same_sense))
    return found


def model_text(faces):
    """`.isochor.json` of faces; equal poles are one point. And the poles of each face in order."""
    points, ids, patches = [], {}, []
    for name, surface, outward in faces:
        rows = []
        for row in surface.poles:
            rows.append([])
            for pole in row:
                pole = tuple(p + 0.0 for p in pole)  # -0 is 0
                if pole not in ids:
                    ids[pole] = len(points)
                    points.append(pole)
                rows[-1].append(ids[pole])
        patches.append({"name": name, "degree": list(surface.degrees),
                        "knots": [list(surface.u_knots), list(surface.v_knots)], "poles": rows,
                        "weights": None, "reversed": not outward})
    return {"isochor_model": 1, "unit": "m", "points": points, "patches": patches}


def poles_of(model):
    return {p["name"]: [model["points"][i] for row in p["poles"] for i in row] for p in model["patches"]}


def halves(case):
    """(whole, half): lists of faces. side 0: a skin around is cut along the crown, and mirrored."""
    faces = skins(DATA / case.file)
    if case.side:
        return faces, [f for f in faces if all(case.side * p[1] >= 0 for row in f[1].poles for p in row)]
    skin = max(faces, key=lambda face: len(face[1].poles) * len(face[1].poles[0]))[1]
    half = cut_v(skin, 16)
    image = Surface(half.degrees, half.u_knots, half.v_knots,
                    [[(p[0], -p[1], p[2]) for p in row] for row in half.poles])
    return ([("starboard", half, True), ("port", image, False)], [("starboard", half, True)])


def cut_v(surface, v):
    """The part from the start to v, by knot insertion; poles at its ends lie in y = 0."""
    d, knots, rows = surface.degrees[1], list(surface.v_knots), [list(row) for row in surface.poles]
    while knots.count(v) < d:
        k = max(i for i in range(len(knots) - 1) if knots[i] <= v)
        new = []
        for row in rows:
            line = []
            for i in range(len(row) + 1):
                if i <= k - d:
                    line.append(row[i])
                elif i > k - knots.count(v):
                    line.append(row[i - 1])
                else:
                    a = (v - knots[i]) / (knots[i + d] - knots[i])
                    line.append(tuple((1 - a) * p + a * q for p, q in zip(row[i - 1], row[i])))
            new.append(line)
        rows = new
        knots.insert(k + 1, v)
    size = next(i for i, knot in enumerate(knots) if knot == v)
    rows = [row[:size] for row in rows]
    for row in rows:
        for end in (0, -1):
            if abs(row[end][1]) > 1e-12:
                raise SystemExit("NOT OK: the cut is not in the mirror plane")
            row[end] = (row[end][0], 0.0, row[end][2])
    # The pole at the nose is one point.
    if max(abs(a - b) for p in rows[0] for a, b in zip(p, rows[0][0])) < 1e-12:
        rows[0] = [rows[0][0]] * size
    return Surface(surface.degrees, surface.u_knots, knots[:size] + [v] * (d + 1), rows)


def close_options(planes):
    return [f"--close={plane}" for plane in planes]


def check(program, case, folder, ledger):
    ledger.section(f"{case.file}: {case.edit['name']}")
    faces, half_faces = halves(case)
    if not 0 < len(half_faces) < len(faces):
        raise SystemExit(f"NOT OK: {case.file} has no half")
    stem = folder / (case.file.split(".")[0] + "_" + case.edit["name"].replace(" ", "_"))
    models = {"whole": model_text(faces), "half": model_text(half_faces)}
    paths = {kind: stem.with_name(f"{stem.name}_{kind}.isochor.json") for kind in models}
    for kind, model in models.items():
        paths[kind].write_text(json.dumps(model))

    step = run_json(program, "volume", DATA / case.file, "--moments")
    whole = run_json(program, "volume", paths["whole"], *close_options(case.planes))
    half = run_json(program, "volume", paths["half"], "--close=y=0", *close_options(case.planes))
    ledger.law("the whole skin closed by planes has the volume of the solid",
               abs(whole["volume"] / step["volume"] - 1), AGREE)
    ledger.law("twice the half is the whole", abs(2 * half["volume"] / whole["volume"] - 1), AGREE)
    ledger.law("the half's bound, relative", half["bound"] / half["volume"], 1e-12)
    gradient = paths["half"].with_suffix(".gradient")
    run(program, "volume", paths["half"], "--close=y=0", *close_options(case.planes), "--gradient", gradient)
    ledger.fact("one row of the gradient for each point",
                len(json.loads(gradient.read_text())) == len(models["half"]["points"]))
    moments = run_json(program, "volume", paths["half"], "--close=y=0", *close_options(case.planes),
                       "--moments")["moments"]
    size = max(abs(c) for p in models["half"]["points"] for c in p)
    for axis in (0, 2):
        ledger.law(f"centroid {'xyz'[axis]} of the half is that of the solid",
                   abs(moments["centroid"][axis] - step["moments"]["centroid"][axis]) / size, AGREE)

    edits = {"whole": {"isochor_edits": 1, "close": case.close,
                       "edits": [dict(case.edit, hold=[{"symmetry": "y"}])]},
             "half": {"isochor_edits": 1, "close": [{"symmetry": "y"}] + case.close, "edits": [case.edit]}}
    after, reports = {}, {}
    for kind in models:
        script = stem.with_name(f"{stem.name}_{kind}.edits.json")
        script.write_text(json.dumps(edits[kind]))
        output = stem.with_name(f"{stem.name}_{kind}_edited.isochor.json")
        reports[kind] = run_json(program, "edit", paths[kind], script, "-o", output)
        after[kind] = json.loads(output.read_text())
        volume = reports[kind]["edits"][0]["volume"]
        ledger.law(f"{kind}: volume kept", abs(volume["relative_change"]) + volume["bound"], KEPT)
        ledger.law(f"{kind}: moved as asked", reports[kind]["edits"][0]["moves"][0]["error"], 1e-12)
    whole_poles, half_poles, old = poles_of(after["whole"]), poles_of(after["half"]), poles_of(models["half"])
    worst = max(abs(a - b) for name in half_poles for p, q in zip(half_poles[name], whole_poles[name])
                for a, b in zip(p, q))
    ledger.law("poles of the half are those of the whole, over the size", worst / size, AGREE)
    moved = max(abs(a - b) for name in old for p, q in zip(half_poles[name], old[name]) for a, b in zip(p, q))
    ledger.fact("something moved", moved > 0.05, f"{moved:.3g} m")
    exact = 0
    for name in old:
        for p, q in zip(half_poles[name], old[name]):
            if q[1] == 0:
                exact = max(exact, abs(p[1]))
    ledger.law("poles in the mirror plane stay in it", exact, 0)
    for plane in edits["whole"]["close"]:
        normal, offset = plane["plane"]["normal"], plane["plane"]["offset"]
        off = 0
        for name in old:
            for p, q in zip(half_poles[name], old[name]):
                if sum(Fraction(n) * Fraction(c) for n, c in zip(normal, q)) == offset:
                    off = max(off, abs(sum(Fraction(n) * Fraction(c) for n, c in zip(normal, p)) - Fraction(offset)))
        ledger.law(f"poles in the plane {normal} stay in it", off / Fraction(size), 1e-14)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path)
    options = parser.parse_args()
    ledger = Ledger()
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.out or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for case in CASES:
            check(options.program, case, folder, ledger)
    return ledger.finish()


if __name__ == "__main__":
    sys.exit(main())
