#!/usr/bin/env python3
"""Figure 4 of Sauvage, Hahmann, Bonneau and Elber (2008) on the bundled unit cube.

usage: figure_four.py ISOCHOR [--out FOLDER]

The point (0.7, 0.8) of the top patch moves by (0.2, 0.2, 0.9), the poles within 0.5 of it are free. By
the methods `axis` and `isotropic`, at the finest scale and at every second and third knot: the volume is
1 to 1e-14 as a rational number (by `isochor volume --exact` and by an integral made here, which must be
the same number), the point is reached, the bottom keeps its bits. `isotropic` does not know the axes:
turning the model, editing it and turning it back is the same as editing it.

Exit status 1 when a law is broken.
"""
import argparse
import json
import math
import pathlib
import sys
import tempfile
from fractions import Fraction

from ledger import Ledger, run, run_json
from splines import Surface, flux, pole_bits

CUBE = pathlib.Path(__file__).resolve().parents[2] / "data/step/cube.isochor.json"
UV = ("7/10", "4/5")
BY = (0.2, 0.2, 0.9)
RADIUS = 0.5
KEPT = 1e-14      # of the volume, which is 1
REACHED = 1e-12   # distance from the asked point; the cube's edge is 1
TURNED = 1e-12    # largest difference of a pole
# A rotation without zeros: about (1, 2, 3) by 1 radian.
TURN_AXIS, TURN_ANGLE = (1.0, 2.0, 3.0), 1.0


def rotation():
    length = math.hypot(*TURN_AXIS)
    n = [x / length for x in TURN_AXIS]
    c, s = math.cos(TURN_ANGLE), math.sin(TURN_ANGLE)
    cross = ((0, -n[2], n[1]), (n[2], 0, -n[0]), (-n[1], n[0], 0))
    return [[c * (i == j) + (1 - c) * n[i] * n[j] + s * cross[i][j] for j in range(3)]
            for i in range(3)]


def turn(matrix, p):
    return [math.fsum(m * x for m, x in zip(row, p)) for row in matrix]


def turned(matrix, model):
    return {**model, "points": [turn(matrix, p) for p in model["points"]]}


def surfaces(model):
    points = [tuple(map(float, p)) for p in model["points"]]
    return [Surface(tuple(patch["degree"]), *([float(t) for t in knots] for knots in patch["knots"]),
                    [[points[i] for i in row] for row in patch["poles"]])
            for patch in model["patches"]]


def volume(model):
    return sum(-flux(surface) if patch.get("reversed") else flux(surface)
               for patch, surface in zip(model["patches"], surfaces(model)))


def edited(isochor, out, name, model, by, method, scale):
    """The model after the edit, and its file."""
    source, script, result = (out / f"{name}{end}" for end in
                              (".in.isochor.json", ".edits.json", ".isochor.json"))
    source.write_text(json.dumps(model))
    edit = {"name": name, "scale": scale, "extent": {"radius": RADIUS},
            "move": [{"patch": "top", "uv": [0.7, 0.8], "by": by}],
            "volume": "keep", "method": method, "metric": "coefficients"}
    script.write_text(json.dumps({"isochor_edits": 1, "edits": [edit]}))
    run(isochor, "edit", source, script, "-o", result)
    return json.loads(result.read_text()), result


def check_edit(ledger, isochor, before, after, path):
    exact = volume(after)
    ledger.law("rational volume - 1", abs(exact - 1), KEPT)
    told = run_json(isochor, "volume", path, "--exact")
    ledger.fact("`isochor volume --exact` is the same rational number",
                Fraction(told["exact"]) == exact)
    top = [patch["name"] for patch in before["patches"]].index("top")
    uv = [Fraction(t) for t in UV]
    start, end = surfaces(before)[top].at(*uv), surfaces(after)[top].at(*uv)
    ledger.law("distance from the asked point",
               math.dist([float(e - s) for e, s in zip(end, start)], BY), REACHED)
    far = [pole_bits(map(float, a)) == pole_bits(map(float, b))
           for a, b in zip(before["points"], after["points"]) if a[2] == 0]
    ledger.fact("points of the bottom keep their bits", far and all(far),
                f"{len(far)} points")


def check_turned(ledger, isochor, out, before, after, name, scale):
    matrix = rotation()
    back = [list(column) for column in zip(*matrix)]
    model, _ = edited(isochor, out, name + "_turned", turned(matrix, before), turn(matrix, BY),
                      "isotropic", scale)
    distance = max(math.dist(a, turn(back, b))
                   for a, b in zip(after["points"], model["points"]))
    ledger.law("largest difference to the edit of the turned model, turned back", distance, TURNED)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("isochor")
    parser.add_argument("--out", type=pathlib.Path)
    options = parser.parse_args()
    ledger = Ledger()
    before = json.loads(CUBE.read_text())
    with tempfile.TemporaryDirectory(prefix="isochor-figure-") as temporary:
        out = options.out or pathlib.Path(temporary)
        out.mkdir(parents=True, exist_ok=True)
        ledger.section("the cube")
        ledger.fact("its rational volume is 1", volume(before) == 1)
        for scale in ("finest", {"every": 2}, {"every": 3}):
            for method in ("axis", "isotropic"):
                every = 1 if scale == "finest" else scale["every"]
                ledger.section(f"{method}, scale {scale}")
                name = f"{method}_{every}"
                after, path = edited(options.isochor, out, name, before, BY, method, scale)
                check_edit(ledger, options.isochor, before, after, path)
                if method == "isotropic":
                    check_turned(ledger, options.isochor, out, before, after, name, scale)
    return ledger.finish()


if __name__ == "__main__":
    sys.exit(main())
