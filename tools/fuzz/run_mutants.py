#!/usr/bin/env python3
"""Feeds damaged STEP files to the program and looks whether it ever dies, hangs or tells an untruth.

usage: run_mutants.py ISOCHOR FILE... [--count N] [--seed S] [--jobs J] [--limit SECONDS] [--keep DIR]

For each mutant: `info`, `check`, `suggest` and the suggested `edit`. It must hold that
  - exit codes are 0, 1, 2 or 3, never a signal, and no run exceeds the limit;
  - an error names the file, and what failed leaves neither an output nor a temporary file;
  - the face entities of the text, counted here, are all accounted for: read, lost or used by no shape;
  - a mutant with fewer faces than the original says so by name or by the rule that it breaks;
  - what `check` calls good is complete, and has the faces, area and volume that `info` tells;
  - an edited file, measured by a fresh process, has the faces, area and volume of the report.
Prints a table by kind of damage, and each failure with the command that makes the mutant again.
"""
import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

from mutate_step import KINDS, mutant

SAME = 1e-9  # relative: two measurements of one shape
_FACE = re.compile(rb"=\s*(?:ADVANCED_FACE|FACE_SURFACE)\s*\(")


class Run:
    """One run of the program."""

    def __init__(self, isochor, words, folder, limit):
        started = time.monotonic()
        self.words = [str(word) for word in words]
        try:
            # Five times the limit by the clock is what the program allows its children.
            done = subprocess.run([isochor, *self.words, "--time-limit", str(limit),
                                   "--memory-limit", "2048"], cwd=folder, capture_output=True,
                                  timeout=6 * limit + 60)
            self.code = done.returncode
            self.out = done.stdout.decode("utf-8", "replace")
            self.err = done.stderr.decode("utf-8", "replace")
        except subprocess.TimeoutExpired:
            self.code, self.out, self.err = None, "", "over the limit"
        self.seconds = time.monotonic() - started

    def json(self):
        try:
            return json.loads(self.out)
        except ValueError:
            return None


def same(a, b, slack=0.0):
    if a is None or b is None:
        return a is b
    return abs(a - b) <= SAME * max(abs(a), abs(b)) + slack


class Mutant:
    """One damaged file and what the program said about it."""

    def __init__(self, isochor, original, faces_before, seed, limit):
        self.isochor, self.limit, self.seed, self.original = isochor, limit, seed, original
        self.faces_before, self.failures, self.outcome = faces_before, [], "refused"
        self.kind, self.text = mutant(original.read_bytes(), seed)

    def fail(self, text):
        self.failures.append(text)

    def run(self, folder, *words, leaves=()):
        before = {p.name for p in folder.iterdir()}
        done = Run(self.isochor, words, folder, self.limit)
        if done.code not in (0, 1, 2, 3):
            self.fail(f"{words[0]}: exit {done.code}: {done.err.strip()[-300:]}")
        if done.code == 3 and "mutant.step" not in done.err and "out.step" not in done.err:
            self.fail(f"{words[0]}: the error does not name the file: {done.err.strip()[-300:]}")
        new = {p.name for p in folder.iterdir()} - before
        allowed = set(leaves) if done.code == 0 else set(leaves) & {"report.json"}
        if new - allowed:
            self.fail(f"{words[0]}: exit {done.code} leaves {sorted(new - allowed)}")
        return done

    def examine(self):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="isochor-mutant-"))
        try:
            (folder / "mutant.step").write_bytes(self.text)
            info = self.run(folder, "info", "mutant.step", "--json")
            check = self.run(folder, "check", "mutant.step", "--json")
            if info.code == 0:
                self.judge(folder, info.json(), check)
            elif check.code == 0:
                self.fail("check calls good what info cannot read")
        finally:
            shutil.rmtree(folder)
        return self

    def judge(self, folder, told, check):
        if told is None or (check.code in (0, 1) and check.json() is None):
            return self.fail("no JSON")
        self.judge_account(told["import"])
        self.outcome = "read, not good"
        if check.code == 0:
            self.outcome = "good"
            self.judge_good(told, check.json())
        suggested = self.run(folder, "suggest", "mutant.step", "-o", "edits.json",
                             leaves=["edits.json"])
        if suggested.code != 0:
            return None
        edited = self.run(folder, "edit", "mutant.step", "edits.json", "-o", "out.step", "--report",
                          "report.json", leaves=["out.step", "report.json"])
        if edited.code == 0:
            self.outcome += ", edited"
            self.judge_edit(folder, told)
        return None

    def judge_account(self, account):
        """Each face that the text states is read, lost or unused; fewer than before is said."""
        in_text = len(_FACE.findall(self.text))
        told = account["read"]["faces"] + len(account["lost_faces"]) + len(account["unused_faces"])
        if told < in_text and not account["broken_rules"]:
            self.fail(f"{in_text} faces in the text, {told} accounted for")
        if account["read"]["faces"] < self.faces_before:
            if not (account["lost_faces"] or account["unused_faces"] or account["broken_rules"]):
                self.fail(f"{account['read']['faces']} faces instead of {self.faces_before}, "
                          "and no word about it")

    def judge_good(self, told, found):
        account = told["import"]
        if not account["complete"] or account["lost_faces"] or account["broken_rules"]:
            self.fail("good, but not complete")
        if account["read"]["faces"] < self.faces_before:
            self.fail(f"good with {account['read']['faces']} faces instead of {self.faces_before}")
        if len(told["faces"]) != found["faces"]:
            self.fail("good with another number of faces")
        if not same(told["volume"], found["volume"]):
            self.fail("good with another volume")
        if not same(sum(face["area"] for face in told["faces"]), found["area"]):
            if len(told["faces"]) == account["read"]["faces"]:  # no part is used twice
                self.fail("good with another area")

    def judge_edit(self, folder, told):
        report = json.loads((folder / "report.json").read_text())
        by_lines = report["check"]["written_by"] == "line by line"
        if told["import"]["broken_rules"] or (told["import"]["lost_faces"] and not by_lines):
            self.fail("edited, but not read completely")
        again = Run(self.isochor, ["check", "out.step", "--json"], folder, self.limit)
        found = again.json()
        if again.code not in (0, 1) or found is None:
            return self.fail(f"what was written cannot be read: {again.err.strip()[-300:]}")
        meant, reread = report["check"]["rebuilt"], report["check"]["reread"]
        if reread["closed"] and not all(
                what["volume_bound"] is not None and what["volume_bound"] < abs(what["volume"])
                for what in (meant, reread)):
            return self.fail("edited, but the volume is not determined")
        # What was written is measured again to the digit; what was meant, up to the gaps it has.
        gap = max(reread["max_tolerance"], reread["max_edge_gap"])
        if found["faces"] != len(told["faces"]):
            self.fail(f"{found['faces']} faces written instead of {len(told['faces'])}")
        if found["import"]["complete"] != told["import"]["complete"]:
            self.fail("what was written is not as complete as what was read")
        for what, slack in ((reread, 0.0), (meant, gap)):
            if found["volume"] is not None and not same(found["volume"], what["volume"],
                                                        slack * what["area"] +
                                                        (slack > 0) * (what["volume_bound"] or 0.0)):
                self.fail(f"volume {found['volume']!r}, the report says {what['volume']!r}")
            if not same(found["area"], what["area"], slack * found["faces"] * what["area"] ** 0.5):
                self.fail(f"area {found['area']!r}, the report says {what['area']!r}")
        return None


def faces_of(isochor, path):
    done = Run(isochor, ["info", path, "--json"], path.parent, 60)
    if done.code != 0:
        raise SystemExit(f"{path}: cannot be read undamaged: {done.err.strip()}")
    return done.json()["import"]["read"]["faces"]


def table(mutants):
    outcomes = sorted({m.outcome for m in mutants})
    print("| kind | " + " | ".join(outcomes) + " | mutants | failures |")
    print("|---" * (len(outcomes) + 3) + "|")
    for kind in [*sorted(KINDS), "all"]:
        of_kind = [m for m in mutants if kind in (m.kind, "all")]
        counts = collections.Counter(m.outcome for m in of_kind)
        cells = [counts[outcome] for outcome in outcomes]
        cells += [len(of_kind), sum(bool(m.failures) for m in of_kind)]
        print(f"| {kind} | " + " | ".join(map(str, cells)) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("isochor", type=pathlib.Path)
    parser.add_argument("files", nargs="+", type=pathlib.Path)
    parser.add_argument("--count", type=int, default=100, help="mutants of all files together")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--limit", type=float, default=10.0, help="seconds of processor time a run")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for mutants that fail")
    options = parser.parse_args()
    isochor = options.isochor.resolve()
    files = [path.resolve() for path in options.files]
    faces = {path: faces_of(isochor, path) for path in files}

    def examine(k):
        path = files[k % len(files)]
        # The kinds take turns within each file.
        seed = options.seed * 1_000_000 + k // len(files)
        found = Mutant(isochor, path, faces[path], seed, options.limit)
        try:
            found.examine()
        except Exception as error:  # a judge that stumbles has not judged
            found.fail(f"could not be judged: {type(error).__name__}: {error}")
        for failure in found.failures:
            print(f"FAILED: mutate_step.py {path.name} --seed {seed} ({found.kind}): {failure}",
                  flush=True)
        if found.failures and options.keep:
            options.keep.mkdir(parents=True, exist_ok=True)
            (options.keep / f"{path.stem}_{seed}.step").write_bytes(found.text)
        return found

    started = time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        mutants = list(pool.map(examine, range(options.count)))
    table(mutants)
    failed = sum(bool(m.failures) for m in mutants)
    print(f"{len(mutants)} mutants of {len(files)} files, {failed} failures, "
          f"{time.monotonic() - started:.0f} s")
    return 1 if failed or not mutants else 0


if __name__ == "__main__":
    sys.exit(main())
