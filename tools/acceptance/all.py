#!/usr/bin/env python3
"""Runs every acceptance command on one build and ends with a line for each.

usage: all.py BUILD_FOLDER [REAL_FILES]

BUILD_FOLDER is a CMake build tree such as build/release. REAL_FILES, a folder of CAD files, defaults to
ISOCHOR_EXTRA_DATA; without either, real_files.py, round_trip.py and whole_solids.py are skipped. Exit status 1 when a
command fails.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import time

SKIPPED = 77


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build_folder", type=pathlib.Path)
    parser.add_argument("real_files", nargs="?", default=os.environ.get("ISOCHOR_EXTRA_DATA"))
    options = parser.parse_args()
    program = options.build_folder / "bin" / "isochor"
    real_files = [program] + ([options.real_files] if options.real_files else [])
    real_files += ["--out", options.build_folder / "acceptance" / "real_files"]
    round_trip = [*real_files[:-1], options.build_folder / "acceptance" / "round_trip"]
    commands = [("laws.py", [options.build_folder]), ("figure_four.py", [program]),
                ("solids.py", [program]), ("half_models.py", [program]), ("below_plane.py", [program]),
                ("continuity.py", [program, "--out", options.build_folder / "acceptance" / "continuity"]),
                ("line_by_line.py", [program, *([options.real_files] if options.real_files else []),
                                     "--out", options.build_folder / "acceptance" / "line_by_line"]),
                ("unit_twins.py", [program, "--out", options.build_folder / "acceptance" / "unit_twins"]),
                ("round_trip.py", round_trip),
                ("real_files.py", real_files),
                ("whole_solids.py", [options.build_folder / "bin" / "isochor_solid_probe",
                                     *([options.real_files] if options.real_files else [])])]
    here = pathlib.Path(__file__).resolve().parent
    verdicts = []
    for name, arguments in commands:
        print(f"\n== {name}", flush=True)
        started = time.monotonic()
        status = subprocess.run([sys.executable, "-B", here / name, *map(str, arguments)]).returncode
        verdicts.append((name, status, time.monotonic() - started))
    print("\n== summary")
    for name, status, seconds in verdicts:
        word = {0: "ok", SKIPPED: "skipped"}.get(status, "NOT OK")
        print(f"{name:16} {word:8} {seconds:6.1f} s")
    failed = any(status not in (0, SKIPPED) for _, status, _ in verdicts)
    print("NOT OK" if failed else "ok")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
