#!/usr/bin/env python3
"""Edits every CAD file of a folder and prints a table: what was read, pulled, kept, checked.

usage: real_files.py ISOCHOR [FOLDER] [--out FOLDER] [--seconds N]

FOLDER defaults to ISOCHOR_EXTRA_DATA; with neither, nothing runs and the exit status is 77.

Each file goes through `info`, `suggest` (a pull of 1 % of the diagonal at the freest place, volume
kept), `edit` and `info` of what was written, each in a process of its own. A refusal is an answer
when it has a reason. Failures are: a crash (a signal, exit code 4), a run over the time limit, a
refusal without a reason, and an edit called done whose report or whose file does not hold.

Closed models are counted in two classes: those with an untrimmed B-spline face without weights must
all be edited, and of the others at least half. Exit status 0 when that holds and nothing failed.
Where ISOCHOR_EXTRA_DATA_LOG names a file, a line per model is appended to it.
"""
import json
import pathlib
import subprocess
import sys
import time

from real_folder import SKIPPED, files_of, note_run, options_of

SUFFIXES = {".step", ".stp", ".igs", ".iges", ".brep", ".brp"}
UNTRIMMED = ("natural", "iso-box")
PULL = 0.01        # of the diagonal
KEPT = 1e-13       # relative change of the volume
ROUNDING = 1e-12   # of the diagonal, where gaps are compared
GAPS = ("max_edge_gap", "max_vertex_gap")
ULPS = 4           # of the largest coordinate: analytic faces are the same points


def run(command, seconds):
    """Exit code (None: over the limit), standard output, last line of standard error."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=seconds)
    except subprocess.TimeoutExpired:
        return None, "", f"over {seconds} s"
    lines = done.stderr.strip().splitlines()
    return done.returncode, done.stdout, lines[-1] if lines else ""


def broken_promises(report, diagonal):
    """What a report called done must show."""
    wrong = []
    edit, check = report["edits"][-1], report["check"]
    before, reread = check["before"], check["reread"]
    if before["closed"]:
        if edit["resolved"]["volume"] != "keep" or not edit["volume"]["kept"]:
            wrong.append("volume not kept")
        if not abs(edit["volume"]["relative_change"]) <= KEPT:
            wrong.append(f"relative change {edit['volume']['relative_change']:.2g}")
    for when in ("before", "rebuilt", "reread"):
        if not check[when]["valid"]:
            wrong.append(f"not valid ({when})")
        if check[when]["closed"] != before["closed"]:
            wrong.append(f"closed changed ({when})")
    for gap in GAPS:
        if check["rebuilt"][gap] > before[gap] + ROUNDING * diagonal:
            wrong.append("a gap grew")
        if reread[gap] > max(before[gap], before["max_tolerance"]) + ROUNDING * diagonal:
            wrong.append("a gap grew beyond the tolerance when re-read")
    if check["tolerance_growth"] > 0 or reread["max_tolerance"] > before["max_tolerance"] * (1 + 1e-9):
        wrong.append("a tolerance grew")
    if check["untouched_bspline_faces"] != check["untouched_bspline_faces_identical"]:
        wrong.append("an untouched face changed")
    if check["analytic_faces_ulps"] > ULPS:
        wrong.append("an analytic face moved")
    return wrong


def larger_gaps(report, diagonal):
    """Files do not store where edges end on their curves: a reader finds that anew."""
    before, reread = report["check"]["before"], report["check"]["reread"]
    larger = [f"{reread[gap]:.2g} for {before[gap]:.2g}" for gap in GAPS
              if reread[gap] > before[gap] + ROUNDING * diagonal]
    return f" (re-read, a gap of {', '.join(larger)}, inside the tolerance)" if larger else ""


def other_model(before, after):
    """What differs between two models as `info` describes them, apart from the shape of faces."""
    wrong = [what for what in ("closed", "valid", "solids", "unit") if before[what] != after[what]]
    names = [sorted(face["name"] for face in model["faces"]) for model in (before, after)]
    if len(names[0]) != len(names[1]):
        wrong.append("number of faces")
    elif before["format"] == after["format"] == "STEP" and names[0] != names[1]:
        wrong.append("names of faces")
    return [what + " changed" for what in wrong]


def must_be_edited(info):
    return any(face["surface"].startswith(("B-spline", "Bezier")) and face["trim"] in UNTRIMMED
               for face in info["faces"])


class Examined:
    """One file: its row of the table and what became of it."""

    def __init__(self, path):
        self.name, self.started = path.name, time.monotonic()
        self.faces = self.editable = self.closed = self.pull = self.change = self.check = ""
        self.edited = self.failed = self.first_class = False

    def answer(self, path, code, message):
        """A refusal or an error: fine when it is one and says why."""
        reason = message.split(f"{path}: ", 1)[-1].removeprefix("isochor: ").strip()
        self.check = reason or "no reason given"
        self.failed = code not in (1, 3) or not reason
        return self

    def row(self):
        cells = [self.name, self.faces, self.editable, self.closed, self.pull, self.change, self.check,
                 f"{time.monotonic() - self.started:.1f}"]
        return "| " + " | ".join(map(str, cells)) + " |" + (" <- failure" if self.failed else "")


def examine(isochor, path, out, seconds):
    found = Examined(path)
    code, text, message = run([isochor, "info", path, "--json"], seconds)
    if code != 0:
        return found.answer(path, code, message)
    info = json.loads(text)
    found.faces = len(info["faces"])
    found.editable = sum(face["editable"] for face in info["faces"])
    found.closed = "yes" if info["closed"] else "no"
    found.first_class = must_be_edited(info)
    edits = out / (path.name + ".edits.json")
    code, _, message = run([isochor, "suggest", path, "-o", edits], seconds)
    if code != 0:
        return found.answer(path, code, message)
    result = out / ("edited_" + path.name)
    report_path = out / (path.name + ".report.json")
    for old in (result, report_path):
        old.unlink(missing_ok=True)
    code, _, message = run([isochor, "edit", path, edits, "-o", result, "--report", report_path],
                           seconds)
    if code != 0:
        return found.answer(path, code, message)
    report = json.loads(report_path.read_text())
    edit = report["edits"][-1]
    pull = sum(x * x for x in edit["moves"][0]["got"]) ** 0.5
    found.pull, found.change = f"{pull:.3g}", f"{edit['volume']['relative_change']:.1e}"
    code, text, message = run([isochor, "info", result, "--json"], seconds)
    if code != 0:
        wrong = [f"what was written cannot be read ({message})"]
    else:
        wrong = broken_promises(report, pull / PULL) + other_model(info, json.loads(text))
    found.check = "FAILED: " + ", ".join(wrong) if wrong else "ok" + larger_gaps(report, pull / PULL)
    found.edited, found.failed = not wrong, bool(wrong)
    return found


def counted(closed, first_class):
    of_class = [found for found in closed if found.first_class == first_class]
    return sum(found.edited for found in of_class), len(of_class)


def main():
    options = options_of(__doc__.splitlines()[0], "isochor", 240.0, "real_files_out")
    if not options.folder:
        return SKIPPED
    files = files_of(options.folder, SUFFIXES)
    print("| file | faces | editable faces | closed | pull | relative change | check | seconds |")
    print("|---|---|---|---|---|---|---|---|")
    examined = []
    for path in files:
        examined.append(examine(options.isochor, path, options.out, options.seconds))
        print(examined[-1].row(), flush=True)
        note_run(path)
    closed = [found for found in examined if found.closed == "yes"]
    edited, all_of_them = counted(closed, True)
    others_edited, others = counted(closed, False)
    failures = sum(found.failed for found in examined)
    print(f"\nclosed, with an untrimmed B-spline face without weights: {edited} of {all_of_them} edited "
          "(all must be)")
    print(f"other closed models: {others_edited} of {others} edited (half must be)")
    print(f"{len(files)} files, {sum(found.edited for found in examined)} edited, {failures} failures")
    return 1 if failures or edited < all_of_them or 2 * others_edited < others else 0


if __name__ == "__main__":
    sys.exit(main())
