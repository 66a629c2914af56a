#!/usr/bin/env python3
"""One model in five units: the same volume, outcomes, changes and poles, up to the unit.

usage: unit_twins.py ISOCHOR [--out FOLDER]

The bundled fuselage with twelve patches, in metres, is rewritten as text in millimetres, centimetres,
inches and feet: lengths are scaled as decimals and rounded once to a double, unit entities exchanged. The
same edit, scaled, is applied to each. What may differ are roundings: of the coordinates of inches and
feet (decimal factors are exact), and of the program's own sums.
"""
import argparse
import json
import math
import pathlib
import re
import subprocess
import sys
from decimal import Decimal, getcontext
from fractions import Fraction

from ledger import Ledger, run_json

getcontext().prec = 60
ROOT = pathlib.Path(__file__).resolve().parents[2]
MODEL = ROOT / "data/step/fuselage12.step"
EDIT = ROOT / "data/edits/fuselage12_pull.json"
# Units in a metre.
UNITS = {"mm": Fraction(1000), "cm": Fraction(100), "inch": Fraction(10000, 254),
         "foot": Fraction(10000, 3048), "m": Fraction(1)}
VOLUME = 1e-12   # relative: the rounding of coordinates times what a volume is more sensitive, and sums
POLES = 1e-10    # of the diagonal: a solve repeats its roundings at another scale
_NUMBER = re.compile(r"[-+]?\d+\.\d*(?:E[-+]?\d+)?")
_STATEMENT = re.compile(r"#(\d+)=((?:[^';]|'[^']*')*);")


def scaled(text, factor):
    """All reals in a text, times a rational, rounded to the nearest double."""
    def one(match):
        exact = Fraction(Decimal(match.group())) * factor
        value = repr(float(exact)).upper()
        if "." not in value:
            value = value.replace("E", ".E") if "E" in value else value + "."
        return value
    return _NUMBER.sub(one, text)


class Twin:
    """The text of the model in another unit."""

    def __init__(self, text, unit):
        self.factor, self.unit = UNITS[unit], unit
        self.bodies = {int(n): body for n, body in _STATEMENT.findall(text)}
        self.lengths = self.in_planes()
        self.next = max(self.bodies) + 1
        self.text = _STATEMENT.sub(lambda m: self.statement(int(m.group(1)), m.group(2)), text)

    def in_planes(self):
        """Points and vectors of parameter curves in planes: those parameters are lengths."""
        found = set()
        for body in self.bodies.values():
            if not body.startswith("PCURVE"):
                continue
            surface, representation = map(int, re.findall(r"#(\d+)", body)[:2])
            if self.bodies[surface].startswith("PLANE"):
                found |= self.below(representation)
        return found

    def below(self, number):
        """The points and vectors that an instance leads to, contexts and their units left out."""
        kind = self.bodies[number].split("(", 1)[0]
        if kind in ("CARTESIAN_POINT", "VECTOR"):
            return {number}
        if kind not in ("DEFINITIONAL_REPRESENTATION", "LINE", "B_SPLINE_CURVE_WITH_KNOTS"):
            return set()
        return set().union(*(self.below(int(n)) for n in re.findall(r"#(\d+)", self.bodies[number])))

    def statement(self, number, body):
        if body.startswith("CARTESIAN_POINT"):
            if len(_NUMBER.findall(body)) == 3 or number in self.lengths:
                body = scaled(body, self.factor)
        elif body.startswith("UNCERTAINTY") or number in self.lengths:
            body = scaled(body, self.factor)
        elif body.startswith("(LENGTH_UNIT()"):
            return self.length_unit(number)
        return f"#{number}={body};"

    def length_unit(self, number):
        prefix = {"mm": ".MILLI.", "cm": ".CENTI.", "m": "$"}.get(self.unit)
        if prefix:
            return f"#{number}=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({prefix},.METRE.));"
        metre, measure, powers = self.next, self.next + 1, self.next + 2
        in_metres = repr(float(1 / self.factor))
        return (f"#{number}=(CONVERSION_BASED_UNIT('{self.unit.upper()}',#{measure})LENGTH_UNIT()"
                f"NAMED_UNIT(#{powers}));\n"
                f"#{metre}=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));\n"
                f"#{measure}=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE({in_metres}),#{metre});\n"
                f"#{powers}=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);")

    def edit(self):
        script = json.loads(EDIT.read_text())
        for edit in script["edits"]:
            edit["extent"]["radius"] = float(Fraction(str(edit["extent"]["radius"])) * self.factor)
            for move in edit["move"]:
                move["by"] = [float(Fraction(str(x)) * self.factor) for x in move["by"]]
        return script


def points_of(path):
    """All points in space, in file order."""
    points = []
    for _, body in _STATEMENT.findall(path.read_text(encoding="latin-1")):
        numbers = _NUMBER.findall(body) if body.startswith("CARTESIAN_POINT") else []
        if len(numbers) == 3:
            points.append(tuple(map(float, numbers)))
    return points


class Result:
    """What the program makes of one twin."""

    def __init__(self, isochor, text, unit, out):
        twin = Twin(text, unit)
        model, edits = out / f"twin_{unit}.step", out / f"twin_{unit}.json"
        model.write_text(twin.text)
        edits.write_text(json.dumps(twin.edit()))
        self.unit, self.factor = unit, float(twin.factor)
        self.info = run_json(isochor, "info", model)
        self.check = run_json(isochor, "check", model)
        written = out / f"edited_{unit}.step"
        done = subprocess.run([isochor, "edit", model, edits, "-o", written, "--json"],
                              capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"NOT OK: the edit in {unit}: {done.stderr.strip()}")
        self.report = json.loads(done.stdout)
        self.points = points_of(written)

    def edit(self):
        return self.report["edits"][0]


def difference(a, b):
    return abs(a - b) / max(abs(a), abs(b)) if a != b else 0.0


def compare(ledger, twin, metre):
    ledger.section(twin.unit)
    scale, cube = twin.factor, twin.factor**3
    ledger.fact("the unit is read", twin.info["unit"] == twin.unit, twin.info["unit"])
    for what in ("closed", "valid", "solids"):
        ledger.fact(f"{what} as in metres", twin.info[what] == metre.info[what], twin.info[what])
    ledger.law("volume over the cube of the unit", difference(twin.info["volume"] / cube,
                                                              metre.info["volume"]), VOLUME)
    ledger.law("area over its square", difference(twin.check["area"] / scale**2,
                                                  metre.check["area"]), VOLUME)
    for key in ("free_poles", "degree", "poles"):
        ledger.fact(f"{key} of all patches", [p[key] for p in twin.info["patches"]] ==
                    [p[key] for p in metre.info["patches"]])
    ledger.fact("continuity of all joins", [j["continuity"] for j in twin.info["joins"]] ==
                [j["continuity"] for j in metre.info["joins"]])
    ours, theirs = twin.edit(), metre.edit()
    ledger.fact("the outcome", twin.report["outcome"] == metre.report["outcome"] == "done")
    ledger.fact("the way of writing", twin.report["check"]["written_by"] ==
                metre.report["check"]["written_by"], twin.report["check"]["written_by"])
    ledger.law("relative change of the volume", abs(ours["volume"]["relative_change"]), 1e-13)
    for key in ("rows", "rank", "freedom_left"):
        ledger.fact(f"constraints: {key}", ours["constraints"][key] == theirs["constraints"][key],
                    ours["constraints"][key])
    ledger.fact("poles moved", ours["moved"]["poles"] == theirs["moved"]["poles"],
                ours["moved"]["poles"])
    ledger.law("largest move", difference(ours["moved"]["max_distance"] / scale,
                                          theirs["moved"]["max_distance"]), POLES)
    ledger.fact("number of points written", len(twin.points) == len(metre.points),
                len(twin.points))
    size = max(math.dist(p, metre.points[0]) for p in metre.points)
    worst = max((math.dist([x / scale for x in p], q) for p, q in zip(twin.points, metre.points)),
                default=math.inf)
    ledger.law("points written, over the size", worst / size, POLES)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("isochor")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/unit_twins"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    text = MODEL.read_text(encoding="latin-1")
    ledger = Ledger()
    results = {unit: Result(options.isochor, text, unit, options.out) for unit in UNITS}
    original = run_json(options.isochor, "info", MODEL)
    ledger.section("the twin in metres and the bundled file")
    ledger.fact("the same volume, bit for bit",
                original["volume"] == results["m"].info["volume"])
    for unit in ("mm", "cm", "inch", "foot"):
        compare(ledger, results[unit], results["m"])
    return ledger.finish()


if __name__ == "__main__":
    sys.exit(main())
