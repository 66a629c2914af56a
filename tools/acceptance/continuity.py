#!/usr/bin/env python3
"""Pulls smooth skins where they could crease and measures what became of angles and curvatures.

usage: continuity.py PROGRAM [--out FOLDER]

PROGRAM is isochor. Models: the fuselage of twelve patches (across a join), and the rational cylinder,
torus and spindle (at knot lines, at a crossing of two, next to a pole). Angles (atan2 of cross and dot
product) and curvatures are measured before and after in rational arithmetic, by formulas of its own; the
volume is that of the report. Then wishes that contradict each other and a wish that is said twice.
Exit status 1 when a law is broken.
"""
import argparse
import json
import pathlib
import subprocess
import sys

from ledger import Ledger
from part21 import StepFile
from smoothness import Patch, diagonal, jumps, read_model

HERE = pathlib.Path(__file__).resolve().parent.parent.parent
SMOOTH = 1e-4        # a place with a larger angle before the edit is no smooth one
CURVED = 1e-3        # a jump of the curvature, times the diagonal, above this is none to keep
KEPT = 1e-12
VOLUME = 1e-13

PULLS = [
    ("fuselage12.step", "across a join", {"radius": 4},
     {"patch": "cabin top", "uv01": [0, 0.5], "by": [0, 0, 0.2]}),
    ("fuselage12.step", "at a corner of four patches", "all",
     {"patch": "cabin top", "uv01": [0, 0], "by": [0, 0.1, 0.1]}),
    ("cylinder.isochor.json", "at a knot line", "all",
     {"patch": "wall", "uv": [1, 0.5], "by": [0, 0.2, 0]}),
    ("torus.isochor.json", "where two knot lines cross", "all",
     {"patch": "ring", "uv": [1, 1], "by": [0, 0.1, 0.3]}),
    ("torus.isochor.json", "at its seam", {"radius": 6},
     {"patch": "ring", "uv": [0, 0.5], "by": [0.2, 0, 0.1]}),
    ("spindle.isochor.json", "next to the nose", "all",
     {"patch": "skin", "uv": [1, 0.15], "by": [0.05, 0.1, -0.1]}),
    ("spindle.isochor.json", "at its widest knot line", "all",
     {"patch": "skin", "uv": [0.5, 1], "by": [0.1, 0.1, 0]}),
]


def patches_of(path):
    if path.suffix == ".json":
        return read_model(path)
    file = StepFile(path)
    surfaces = [(face.name, file.surface(face.surface)) for face in file.faces()]
    return [Patch(name, s.degrees, s.u_knots, s.v_knots, s.poles) for name, s in surfaces
            if hasattr(s, "poles")]


def script(path, edit):
    path.write_text(json.dumps({"isochor_edits": 1, "edits": [{"metric": "coefficients", **edit}]}))
    return path


def run(program, model, edits, out, report):
    return subprocess.run([program, "edit", model, edits, "-o", out, "--report", report],
                          capture_output=True, text=True, timeout=600)


def largest(samples):
    return max((abs(x) for x in samples), default=0.0)


def room_for_curvature(place, patches):
    """Rows for curvature exist across joins and knot lines of cubics and more, not of quadratics."""
    degrees = {p.name: p.degrees for p in patches}
    if len(place) == 4:
        p, one, q, other = place
        return min(degrees[p][one[0]], degrees[q][other[0]]) >= 3
    return len(place) == 3 and degrees[place[0]]["uv".index(place[1])] >= 3


def pull(ledger, program, folder, number, file, where, extent, move):
    model = HERE / "data" / "step" / file
    ledger.section(f"{file}, pulled {where}")
    out = folder / f"{number}{''.join(model.suffixes)}"
    report = folder / f"{number}.report.json"
    out.unlink(missing_ok=True)
    edits = script(folder / f"{number}.edits.json", {"extent": extent, "move": [move], "volume": "keep"})
    done = run(program, model, edits, out, report)
    ledger.fact("the edit is done", done.returncode == 0, done.stderr.strip().splitlines()[-1:] or "")
    if done.returncode != 0:
        return
    record = json.loads(report.read_text())["edits"][0]
    before, after = patches_of(model), patches_of(out)
    size = diagonal(before)
    old, new = jumps(before, size), jumps(after, size)
    ledger.fact("the same joins, knot lines and poles", old.keys() == new.keys(), f"{len(old)} places")
    smooth = curved = 0
    angles, curvatures, angle_before = [], [], []
    for place, samples in old.items():
        if not samples or largest(a for a, _ in samples) > SMOOTH:
            continue
        smooth += 1
        angle_before.append(largest(a for a, _ in samples))
        angles += [b[0] - a[0] for a, b in zip(samples, new[place])]
        if room_for_curvature(place, before) and largest(k for _, k in samples) * size <= CURVED:
            curved += 1
            curvatures += [(b[1] - a[1]) * size for a, b in zip(samples, new[place])]
    print(f"        {smooth} smooth places (angles up to {max(angle_before):.1e} rad before), {curved} with "
          f"curvature; moved by at most {record['moved']['max_distance']:.3g}")
    ledger.law("largest change of an angle, rad", largest(angles), KEPT)
    ledger.law("largest change of a curvature jump, times the diagonal", largest(curvatures), KEPT)
    ledger.law("relative change of the volume", abs(record["volume"]["relative_change"]), VOLUME)
    ledger.law("the point arrives, distance", record["moves"][0]["error"], KEPT * size)
    locked = max(record["locked"], key=lambda lock: lock["coefficients"], default=None)
    print("        largest locked region: " + ("none" if locked is None else
          f"{locked['coefficients']} of {record['moved']['coefficients'] + sum(x['coefficients'] for x in record['locked'])}"
          f" coefficients of {locked['patch']}: {locked['reason']}"))


def wishes(ledger, program, folder):
    ledger.section("wishes that contradict each other, and one that is said twice")
    model = HERE / "data" / "step" / "cylinder.isochor.json"
    out, report = folder / "wishes.isochor.json", folder / "wishes.report.json"
    out.unlink(missing_ok=True)
    place = {"patch": "wall", "uv": [0.5, 0.5]}
    edit = {"extent": "all", "volume": "keep",
            "move": [{"patch": "wall", "uv": [1.5, 0.5], "by": [0, 0.1, 0]}, {**place, "by": [0.1, 0, 0]}],
            "hold": [{"patch": "wall", "uv": [3, 0.5]}, place]}
    done = run(program, model, script(folder / "contradiction.json", edit), out, report)
    record = json.loads(report.read_text())["edits"][0]["constraints"]
    ledger.fact("exit status 1, nothing written", done.returncode == 1 and not out.exists(),
                f"exit status {done.returncode}")
    proofs = [dict(zip(c["constraints"], c["multipliers"])) for c in record["conflicts"]]
    ledger.fact("both are named, with multipliers", proofs == [{"move[1]": "1", "hold[1]": "-1"}], proofs)
    print("        " + done.stderr.strip())
    edit["move"].pop()
    edit["hold"].append(place)
    done = run(program, model, script(folder / "twice.json", edit), out, report)
    record = json.loads(report.read_text())["edits"][0]["constraints"]
    ledger.fact("one hold twice: done, one of them redundant",
                done.returncode == 0 and record["redundant"] == ["hold[2]"],
                f"exit status {done.returncode}, redundant {record['redundant']}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/continuity"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    ledger = Ledger()
    for number, arguments in enumerate(PULLS):
        pull(ledger, options.program.resolve(), options.out, number, *arguments)
    wishes(ledger, options.program.resolve(), options.out)
    return ledger.finish()


if __name__ == "__main__":
    sys.exit(main())
