#!/usr/bin/env python3
"""Edits every CAD file of a folder and prints a table: what was read, pulled, kept, checked.

usage: real_files.py ISOCHOR [FOLDER] [--out FOLDER] [--seconds N]

FOLDER defaults to ISOCHOR_EXTRA_DATA; with neither, nothing runs and the exit status is 77.

Each file goes through `info`, `suggest` (a pull of 1 % of the diagonal at the freest place, volume
kept) and `edit`, each in a process of its own. A refusal is an answer when it has a reason; a crash
(a signal, exit code 4) or a run over the time limit is a failure, and so is an edit called done
whose report does not hold. Exit status 0 when there is no failure.
Where ISOCHOR_EXTRA_DATA_LOG names a file, a line per model is appended to it.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import time

SUFFIXES = {".step", ".stp", ".igs", ".iges", ".brep", ".brp"}


def run(command, seconds):
    """Exit code (None: over the limit), standard output, last line of standard error."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=seconds)
    except subprocess.TimeoutExpired:
        return None, "", f"over {seconds} s"
    lines = done.stderr.strip().splitlines()
    return done.returncode, done.stdout, lines[-1] if lines else ""


def broken_promises(report):
    """What a report called done must show."""
    wrong = []
    edit = report["edits"][-1]
    if not edit["volume"]["kept"] and edit["resolved"]["volume"] == "keep":
        wrong.append("volume not kept")
    if abs(edit["volume"]["relative_change"]) > 1e-13 and edit["resolved"]["volume"] == "keep":
        wrong.append(f"relative change {edit['volume']['relative_change']:.2g}")
    check = report["check"]
    if not check["reread"]["valid"] and check["before"]["valid"]:
        wrong.append("not valid after re-reading")
    if check["tolerance_growth"] > 0:
        wrong.append("a tolerance grew")
    if check["untouched_bspline_faces"] != check["untouched_bspline_faces_identical"]:
        wrong.append("an untouched face changed")
    if check["analytic_faces_ulps"] > 4:
        wrong.append("an analytic face moved")
    return wrong


def examine(isochor, path, out, seconds):
    """One row of the table, and whether the program misbehaved."""
    row = {"file": path.name, "faces": "", "editable": "", "closed": "", "pull": "", "change": "",
           "check": ""}
    started = time.monotonic()
    code, text, message = run([isochor, "info", path, "--json"], seconds)
    if code != 0:
        row["check"] = message.split(": ", 2)[-1]
        row["seconds"] = time.monotonic() - started
        return row, code not in (1, 3)
    info = json.loads(text)
    row["faces"] = len(info["faces"])
    row["editable"] = sum(face["editable"] for face in info["faces"])
    row["closed"] = "yes" if info["closed"] else "no"
    edits = out / (path.name + ".edits.json")
    code, _, message = run([isochor, "suggest", path, "-o", edits], seconds)
    if code == 0:
        result = out / ("edited_" + path.name)
        report_path = out / (path.name + ".report.json")
        report_path.unlink(missing_ok=True)
        code, _, message = run(
            [isochor, "edit", path, edits, "-o", result, "--report", report_path], seconds)
        if code == 0:
            report = json.loads(report_path.read_text())
            edit = report["edits"][-1]
            move = edit["moves"][0]
            row["pull"] = "%.3g" % sum(x * x for x in move["got"]) ** 0.5
            row["change"] = "%.1e" % edit["volume"]["relative_change"]
            wrong = broken_promises(report)
            row["check"] = "ok" if not wrong else "FAILED: " + ", ".join(wrong)
            row["seconds"] = time.monotonic() - started
            return row, bool(wrong)
    row["check"] = message.split(": ", 2)[-1]
    row["seconds"] = time.monotonic() - started
    return row, code not in (1, 3)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("isochor")
    parser.add_argument("folder", nargs="?", default=os.environ.get("ISOCHOR_EXTRA_DATA"))
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("real_files_out"))
    parser.add_argument("--seconds", type=float, default=240.0)
    options = parser.parse_args()
    if not options.folder:
        print("skipped: no folder of real files (set ISOCHOR_EXTRA_DATA)")
        return 77
    options.out.mkdir(parents=True, exist_ok=True)
    files = sorted(p for p in pathlib.Path(options.folder).rglob("*")
                   if p.suffix.lower() in SUFFIXES)
    log = os.environ.get("ISOCHOR_EXTRA_DATA_LOG")
    failures = edited = 0
    print("| file | faces | editable | closed | pull | relative change | check | seconds |")
    print("|---|---|---|---|---|---|---|---|")
    for path in files:
        row, failed = examine(options.isochor, path, options.out, options.seconds)
        failures += failed
        edited += row["check"] == "ok"
        print("| {file} | {faces} | {editable} | {closed} | {pull} | {change} | {check} | "
              "{seconds:.1f} |".format(**row) + (" <- failure" if failed else ""), flush=True)
        if log:
            with open(log, "a", encoding="utf-8") as lines:
                lines.write(f"{path.name}\n")
    print(f"{len(files)} files, {edited} edited, {failures} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
