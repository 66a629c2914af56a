#!/usr/bin/env python3
"""Edits every CAD file of a folder and prints a table: read, repaired, editable, edited, checked, re-read.

usage: real_files.py ISOCHOR [FOLDER] [--out FOLDER] [--seconds N]

FOLDER defaults to ISOCHOR_EXTRA_DATA; with neither, nothing runs and the exit status is 77.

Each file goes through `info`, `suggest` (a pull of 1 % of the diagonal at the freest place, volume
kept), `edit`, and `info` and `check` of what was written, each in a process of its own. An open model is
closed by the planes that `info` names, where they do and a place is free with them; else it is edited open,
its volume free. A refusal is an answer when it has a reason. Failures are: a crash (a signal, exit code 4),
a run over the time limit, a refusal without a reason, and an edit called done whose report or whose
file does not hold, or whose file has more faults than the input.

The floor: every closed solid with an untrimmed B-spline face, rational or not, is edited, and so are at
least half of the other closed ones; the volume is kept to 1e-13 (relative, as the reports state it, proven).
Exit status 0 when that holds and nothing failed. Where ISOCHOR_EXTRA_DATA_LOG names a file, a line per
model is appended to it.
"""
import json
import pathlib
import re
import subprocess
import sys
import textwrap
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


def broken_promises(report, diagonal, planes):
    """What a report called done must show."""
    wrong = []
    edit, check = report["edits"][-1], report["check"]
    before, reread = check["before"], check["reread"]
    if before["closed"] or planes:
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
    return f"re-read, a gap of {', '.join(larger)}, inside the tolerance" if larger else ""


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
    return any("B-spline" in face["surface"] or "Bezier" in face["surface"] for face in info["faces"]
               if face["trim"] in UNTRIMMED)


def closing_planes(opening):
    """The planes that `info` says would close a model; none where they do not."""
    if not re.search(r" closes? it$", opening or ""):
        return []
    return [plane.strip('"') for plane in re.findall(r'--close ("[^"]*"|\S+)', opening)]


def repairs_of(account):
    """What the reader did to a file, in few words."""
    sewing = account["sewing"]
    counts = [(sum(item["count"] for item in account["repairs"]), "mended"),
              (sum(item["count"] for item in account["failures"]), "unread"),
              (len(account["lost_faces"]), "lost"), (account["added_faces"], "added"),
              (len(account["faces_without_area"]), "no area"), (len(sewing["dropped_faces"]), "dropped"),
              (account["junk_bytes"], "bytes skipped"), (len(account["broken_rules"]), "rules broken")]
    words = [f"{count} {what}" for count, what in counts if count]
    if sewing["done"]:
        words.insert(0, f"{sewing['faces']} sewn")
    return ", ".join(words) or "-"


def shortened(text, width):
    return text if len(text) <= width else text[:width - 1] + "~"


COLUMNS = [("file", 26), ("read", 7), ("repaired", 17), ("editable", 8), ("closed", 8), ("edited", 8),
           ("change", 7), ("checked", 10), ("re-read", 7), ("s", 4)]


def row_of(cells):
    return "  ".join(f"{shortened(str(cell), width):<{width}}" for cell, (_, width) in zip(cells, COLUMNS)).rstrip()


class Examined:
    """One file: its row of the table, what became of it, and what is to be said below the table."""

    def __init__(self, path):
        self.name, self.started = path.name.split("__")[-1], time.monotonic()
        self.read = self.repaired = self.editable = self.closed = ""
        self.way = self.change = self.checked = self.reread = "-"
        self.edited = self.failed = self.first_class = self.whole = False
        self.remarks = []

    def answer(self, path, code, message):
        """A refusal or an error: fine when it is one and says why."""
        reason = message.split(f"{path}: ", 1)[-1].removeprefix("isochor: ").strip()
        self.remarks.append("not edited: " + (reason.removeprefix("refused: ") or "no reason given"))
        self.failed = code not in (1, 3) or not reason
        return self

    def row(self):
        cells = [self.name, self.read, self.repaired, self.editable, self.closed, self.way, self.change,
                 self.checked, self.reread, f"{time.monotonic() - self.started:.0f}"]
        return row_of(cells) + ("  <- failure" if self.failed else "")

    def take(self, info):
        account = info["import"]
        stated = account["stated"]
        self.read = f"{account['read']['faces']}" + (f"/{stated['faces']}" if stated else "")
        self.repaired = repairs_of(account)
        self.editable = str(sum(face["editable"] for face in info["faces"]))
        self.whole = info["closed"]
        self.closed = "yes" if info["closed"] else "no"
        self.first_class = must_be_edited(info)
        if account["sewing"]["declined"]:
            self.remarks.append("not sewn: " + account["sewing"]["declined"])
        if not info["closed"]:
            self.remarks.append(info["opening"] or info["why_open"])


def counted_faults(texts):
    return f"{len(texts)} fault" + ("" if len(texts) == 1 else "s")


def faults(isochor, path, planes, seconds):
    """The faults that `check` finds, in words; None when it cannot."""
    code, text, _ = run([isochor, "check", path, "--json"] + [f"--close={plane}" for plane in planes], seconds)
    if code not in (0, 1):
        return None
    return [finding["text"] for finding in json.loads(text)["findings"] if finding["severity"] == "fault"]


def judged(found, isochor, path, planes, seconds):
    """Faults of a file, noted in the table."""
    texts = faults(isochor, path, planes, seconds)
    found.checked = "no answer" if texts is None else counted_faults(texts) if texts else "ok"
    if texts:
        found.remarks.append(f"check finds {counted_faults(texts)}, first: {texts[0]}")
    return texts


def suggest(isochor, path, planes, edits, seconds):
    return run([isochor, "suggest", path, "-o", edits] + [f"--close={plane}" for plane in planes], seconds)


def examine(isochor, path, out, seconds):
    found = Examined(path)
    code, text, message = run([isochor, "info", path, "--json"], seconds)
    if code != 0:
        return found.answer(path, code, message)
    info = json.loads(text)
    found.take(info)
    edits = out / (path.name + ".edits.json")
    result = out / ("edited_" + path.name)
    report_path = out / (path.name + ".report.json")
    for old in (edits, result, report_path):
        old.unlink(missing_ok=True)
    planes = [] if info["closed"] else closing_planes(info["opening"])
    code, _, message = suggest(isochor, path, planes, edits, seconds)
    if code == 1 and planes:
        found.remarks.append("with these planes, " + message.split("refused: ", 1)[-1].split(";")[0])
        planes = []
        code, _, message = suggest(isochor, path, planes, edits, seconds)
    if code == 0:
        code, _, message = run([isochor, "edit", path, edits, "-o", result, "--report", report_path], seconds)
    if code != 0:
        judged(found, isochor, path, planes, seconds)
        return found.answer(path, code, message)
    return judge_edit(found, isochor, (path, info), result, json.loads(report_path.read_text()), planes, seconds)


def judge_edit(found, isochor, given, result, report, planes, seconds):
    path, info = given
    edit = report["edits"][-1]
    diagonal = sum(x * x for x in edit["moves"][0]["got"]) ** 0.5 / PULL
    if planes:
        found.closed = f"{len(planes)} plane" + ("s" if len(planes) > 1 else "")
    found.way = "by lines" if report["check"]["written_by"] == "line by line" else "anew"
    found.change = f"{edit['volume']['relative_change']:.0e}" if found.whole or planes else "free"
    if edit["resolved"].get("continuity", "measured") == "C0":
        found.remarks.append("creases allowed: nothing was free without")
    if report["check"]["not_line_by_line"]:
        found.remarks.append("written anew: " + report["check"]["not_line_by_line"])
    code, text, message = run([isochor, "info", result, "--json"], seconds)
    if code != 0:
        wrong = [f"what was written cannot be read ({message})"]
    else:
        wrong = broken_promises(report, diagonal, planes) + other_model(info, json.loads(text))
    texts = judged(found, isochor, result, planes, seconds)
    if texts is None:
        wrong.append("check gives no answer")
    elif texts and len(texts) > len(faults(isochor, path, planes, seconds) or []):
        wrong.append("more faults than before: " + texts[0])
    gaps = larger_gaps(report, diagonal)
    if gaps:
        found.remarks.append(gaps)
    found.reread = "FAILED" if wrong else "ok, gap" if gaps else "ok"
    if wrong:
        found.remarks.append("FAILED: " + ", ".join(wrong))
    found.edited, found.failed = not wrong, bool(wrong)
    return found


def print_remarks(examined):
    print()
    for found in examined:
        for remark in found.remarks:
            print(textwrap.fill(f"{found.name}: {remark}", 120, subsequent_indent="    "))


def counted(closed, first_class):
    of_class = [found for found in closed if found.first_class == first_class]
    return sum(found.edited for found in of_class), len(of_class)


def main():
    options = options_of(__doc__.splitlines()[0], "isochor", 240.0, "out/real_files")
    if not options.folder:
        return SKIPPED
    files = files_of(options.folder, SUFFIXES)
    print(row_of([title for title, _ in COLUMNS]))
    examined = []
    for path in files:
        examined.append(examine(options.isochor, path, options.out, options.seconds))
        print(examined[-1].row(), flush=True)
        note_run(path)
    print_remarks(examined)
    closed = [found for found in examined if found.whole]
    edited, all_of_them = counted(closed, True)
    others_edited, others = counted(closed, False)
    by_planes = sum(found.edited and "plane" in found.closed for found in examined)
    failures = sum(found.failed for found in examined)
    print(f"\nclosed, with an untrimmed B-spline face, rational or not: {edited} of {all_of_them} edited "
          "(all must be)")
    print(f"other closed models: {others_edited} of {others} edited (half must be)")
    print(f"open models edited closed by the planes that info names: {by_planes}")
    print(f"{len(files)} files, {sum(found.edited for found in examined)} edited, {failures} failures")
    return 1 if failures or edited < all_of_them or 2 * others_edited < others else 0


if __name__ == "__main__":
    sys.exit(main())
