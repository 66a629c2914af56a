#!/usr/bin/env python3
"""What solids have below and above a plane adds up to the whole, in volume and centroid.

usage: below_plane.py ISOCHOR [FILES...]

Without FILES the bundled solids. Each is cut through its centroid by two planes. Both sides are measured with
fields of their own, the whole by `volume --moments`, so three computations must agree: within their bounds and
what gaps between faces leave undefined (on files with gaps the flux of every field is another). Files that are
open are named and left out. Exit status 1 when a law is broken.
"""
import argparse
import json
import math
import pathlib
import subprocess
import sys

from ledger import Ledger, run_json

DATA = pathlib.Path(__file__).resolve().parents[2] / "data" / "step"
NORMALS = [(0, 0, 1), (0.36, 0.48, 0.8)]


def below(program, path, normal, height):
    return run_json(program, "volume", path, "--below=" + ",".join(repr(x) for x in (*normal, height)))["below"]


def check(program, path, ledger):
    done = subprocess.run([str(program), "volume", str(path), "--moments", "--json"], capture_output=True, text=True)
    if done.returncode != 0:
        ledger.section(f"{path.name}: left out, exit status {done.returncode}")
        return
    ledger.section(path.name)
    whole = json.loads(done.stdout)
    volume, moments, loose = whole["volume"], whole["moments"], whole["undefined_by_gaps"]
    for normal in NORMALS:
        height = math.fsum(a * b for a, b in zip(normal, moments["centroid"]))
        parts = [below(program, path, normal, height), below(program, path, [-a for a in normal], -height)]
        total = sum(part["volume"] for part in parts)
        bound = sum(part["bound"] for part in parts) + whole["bound"]
        size = max(math.dist(part["centroid"], moments["centroid"]) for part in parts)
        both = [math.fsum(part["volume"] * part["centroid"][k] for part in parts) / total for k in range(3)]
        centroids = sum(part["centroid_bound"] for part in parts) + max(moments["centroid_bound"])
        slack = 4 * loose / abs(volume) * (size + math.hypot(*moments["centroid"]))
        ledger.law(f"{normal}: both sides are the whole", abs(total - volume), bound + loose)
        ledger.law(f"{normal}: so are their centroids", math.dist(both, moments["centroid"]), centroids + slack)
        ledger.fact(f"{normal}: the plane cuts", all(part["extent"] == "part" for part in parts))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("files", nargs="*", type=pathlib.Path)
    options = parser.parse_args()
    ledger = Ledger()
    for path in options.files or sorted(DATA.glob("*.step")) + sorted(DATA.glob("*.isochor.json")):
        check(options.program, path, ledger)
    return ledger.finish()


if __name__ == "__main__":
    sys.exit(main())
