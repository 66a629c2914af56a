#!/usr/bin/env python3
"""Edits STEP files and compares input and output line by line.

usage: line_by_line.py PROGRAM [FOLDER] [--out FOLDER] [--seconds N]

PROGRAM is isochor. The bundled models of data/step are edited by the scripts of data/edits and by what
`suggest` proposes; with FOLDER (default: ISOCHOR_EXTRA_DATA), its STEP files by what `suggest` proposes. Of
each file that was written line by line this must hold:

- every line of the input is in the output, in its order; nothing else is, but appended lines;
- appended lines are new instances, numbered on from the largest number of the input, before an ENDSEC;
- a line that changed differs in references alone, and each new one names an appended instance;
- the other lines have one checksum in both files;
- `convert` from STEP to STEP gives every byte.

The bundled models must all be written this way; of the others the reason why not is printed. Where FreeCAD is
installed (freecadcmd), it opens input and output: valid alike, the same number of faces and of solids, the
same labels, and about the same volume (the edits keep it; FreeCAD integrates it to a few digits). Exit status 1
when a law is broken.
"""
import argparse
import collections
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from ledger import Ledger

HERE = pathlib.Path(__file__).resolve().parent.parent.parent
STEP = {".step", ".stp"}
REFERENCES = re.compile(rb"#\d+(?:\s*,\s*#\d+)*")
INSTANCE = re.compile(rb"#(\d+)\s*=\s*\(?\s*(\w+)")
BY_LINES = "line by line"
ROUGHLY = 1e-2  # what adaptive integration with few points may be off

FREECAD = """
import json, os
import FreeCAD, Import, Part
document = FreeCAD.newDocument()
Import.insert(os.environ["ISOCHOR_STEP"], document.Name)
shapes = [o for o in document.Objects if getattr(o, "Shape", None) is not None and not o.Shape.isNull()
          and not o.InList]
print("\\n@" + json.dumps({
    "valid": all(o.Shape.isValid() for o in shapes), "volume": sum(o.Shape.Volume for o in shapes),
    "faces": sum(len(o.Shape.Faces) for o in shapes), "solids": sum(len(o.Shape.Solids) for o in shapes),
    "labels": sorted(o.Label for o in document.Objects)}), flush=True)
"""


def lines_of(path):
    return path.read_bytes().splitlines(keepends=True)


def checksum(lines):
    return hashlib.sha256(b"".join(lines)).hexdigest()[:16]


class Comparison:
    """Walks both files once. `fault` says what breaks a law, else None."""

    def __init__(self, before, after):
        self.same, self.changed, self.appended = [], [], []
        self.fault = None
        numbers = [int(n) for line in before for n in re.findall(rb"#(\d+)", line)]
        self.largest = max(numbers, default=0)
        kept, at = [], 0
        for line in after:
            old = before[at] if at < len(before) else b""
            if line == old:
                self.same.append(old)
                kept.append(line)
                at += 1
            elif self._is_new(line):
                self.appended.append(line)
            elif REFERENCES.sub(b"#", line) == REFERENCES.sub(b"#", old):
                self.changed.append((old, line))
                at += 1
            else:
                self.fault = f"line {at + 1} changed: {old[:60]!r} became {line[:60]!r}"
                return
        if at < len(before):
            self.fault = f"line {at + 1} is missing: {before[at][:60]!r}"
        elif checksum(kept) != checksum(self.same):
            self.fault = "checksums differ"
        else:
            self.fault = self._numbers() or self._references() or self._places(after)

    def _is_new(self, line):
        found = INSTANCE.match(line)
        return found is not None and int(found.group(1)) > self.largest

    def _numbers(self):
        numbers = sorted(int(INSTANCE.match(line).group(1)) for line in self.appended)
        wanted = list(range(self.largest + 1, self.largest + 1 + len(numbers)))
        return None if numbers == wanted else "appended numbers do not go on from the largest"

    def _references(self):
        last = self.largest + len(self.appended)
        for old, new in self.changed:
            before, after = re.findall(rb"#(\d+)", old), re.findall(rb"#(\d+)", new)
            fresh = collections.Counter(map(int, after)) - collections.Counter(map(int, before))
            if not fresh or not all(self.largest < n <= last for n in fresh):
                return f"a reference to an old instance is new in {new[:60]!r}"
        return None

    def _places(self, after):
        """Appended lines stand in one block before an ENDSEC, per data section."""
        block = False
        for line in after:
            new = self._is_new(line)
            if block and not new and not line.lstrip().startswith(b"ENDSEC"):
                return f"{line[:60]!r} stands behind appended lines"
            block = new
        return None

    def kinds(self):
        found = collections.Counter(INSTANCE.match(line).group(2).decode() for line in self.appended)
        return ", ".join(f"{count} {kind}" for kind, count in sorted(found.items()))


def freecad(program, path, seconds):
    """What FreeCAD finds in a file; None when it fails."""
    with tempfile.TemporaryDirectory() as folder:
        script = pathlib.Path(folder) / "look.py"
        script.write_text(FREECAD)
        try:
            done = subprocess.run([program, str(script)], capture_output=True, text=True, timeout=seconds,
                                  stdin=subprocess.DEVNULL,
                                  env={**os.environ, "ISOCHOR_STEP": str(path), "HOME": folder})
        except subprocess.TimeoutExpired:
            return None
    found = [line for line in done.stdout.splitlines() if line.startswith("@{")]
    return json.loads(found[-1][1:]) if found else None


class Bench:
    def __init__(self, options):
        self.options, self.ledger = options, Ledger()
        self.freecad = shutil.which("freecadcmd") or shutil.which("FreeCADCmd")
        self.by_lines, self.anew, self.refused = [], [], []

    def run(self, *words):
        try:
            return subprocess.run([str(self.options.program), *map(str, words)], capture_output=True,
                                  text=True, timeout=self.options.seconds)
        except subprocess.TimeoutExpired:
            return subprocess.CompletedProcess(words, None, "", f"over {self.options.seconds} s")

    def copy(self, model):
        output = self.options.out / ("copy_" + model.name)
        done = self.run("convert", model, output)
        same = done.returncode == 0 and output.read_bytes() == model.read_bytes()
        self.ledger.fact("convert keeps every byte", same, checksum(lines_of(model)))

    def edit(self, model, script, ours):
        if script is None:
            script = self.options.out / (model.name + ".json")
            done = self.run("suggest", model, "-o", script)
            if done.returncode != 0:
                return self.refuse(model, "suggest", done, ours)
        output, report = self.options.out / model.name, self.options.out / (model.name + ".report.json")
        done = self.run("edit", model, script, "-o", output, "--report", report)
        if done.returncode != 0:
            return self.refuse(model, script.name, done, ours)
        report = json.loads(report.read_text())
        check = report["check"]
        if check["written_by"] != BY_LINES:
            self.anew.append((model.name, check["not_line_by_line"]))
            print(f"  written anew: {check['not_line_by_line']}")
            if ours:
                self.ledger.fact("written line by line", False, check["not_line_by_line"])
            return None
        self.by_lines.append(model.name)
        found = Comparison(lines_of(model), lines_of(output))
        self.ledger.fact("only references changed, only instances were appended", found.fault is None,
                         found.fault or f"{len(found.same)} lines the same ({checksum(found.same)}), "
                         f"{len(found.changed)} re-pointed, appended {found.kinds()}")
        self.ledger.fact("the report counts what was appended",
                         check["lines_appended"] == len(found.appended), check["lines_appended"])
        self.look(model, output)
        return None

    def refuse(self, model, what, done, ours):
        reason = (done.stderr.strip().splitlines() or ["no reason"])[-1]
        self.refused.append((model.name, reason))
        print(f"  {what}: {reason[:200]}")
        self.ledger.fact("refused with a reason", done.returncode in (1, 3) and not ours)

    def look(self, model, output):
        if self.freecad is None:
            return
        before, after = (freecad(self.freecad, path, self.options.seconds) for path in (model, output))
        if before is None:
            return print("  FreeCAD does not open the input")
        keys = ("valid", "faces", "solids", "labels")
        self.ledger.fact("FreeCAD: validity, faces, solids, labels as before",
                         after is not None and all(before[k] == after[k] for k in keys),
                         f"{before['faces']} faces, {before['solids']} solids, valid: {before['valid']}")
        if after is not None and before["solids"]:
            self.ledger.law("FreeCAD: the volume, roughly",
                            abs(after["volume"] / before["volume"] - 1), ROUGHLY)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("folder", nargs="?", type=pathlib.Path,
                        default=os.environ.get("ISOCHOR_EXTRA_DATA"))
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/line_by_line"))
    parser.add_argument("--seconds", type=float, default=600)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    bench = Bench(options)
    for model in sorted((HERE / "data" / "step").glob("*.step")):
        bench.ledger.section(model.name)
        bench.copy(model)
        scripts = [s for s in sorted((HERE / "data" / "edits").glob("*.json"))
                   if s.name.split("_")[0] == model.stem]
        for script in [None, *scripts]:
            print(f"  {script.name if script else 'suggested edit'}")
            bench.edit(model, script, True)
    others = sorted(p for p in pathlib.Path(options.folder).rglob("*")
                    if p.suffix.lower() in STEP) if options.folder else []
    for model in others:
        bench.ledger.section(model.name)
        bench.edit(model, None, False)
    print(f"{len(bench.by_lines)} edits written line by line, {len(bench.anew)} anew, "
          f"{len(bench.refused)} refused" + ("" if bench.freecad else "; FreeCAD is not installed"))
    return bench.ledger.finish()


if __name__ == "__main__":
    sys.exit(main())
