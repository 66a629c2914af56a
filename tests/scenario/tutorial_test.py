#!/usr/bin/env python3
"""Runs the commands of a page of the documentation and compares what they print with what it shows.

usage: tutorial_test.py ISOCHOR PAGE.md DATA_FOLDER WORK_FOLDER

Blocks marked `console`: a line that starts with "$ " is a command of the shell, the lines up to the next
one are its output, both streams. There, "..." stands for any text on the line, and a line that is only
"..." for any number of lines. Blocks marked `json NAME` are saved as NAME. Other blocks are not run.
Commands run in WORK_FOLDER, where DATA_FOLDER is `data` and ISOCHOR is on the PATH.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

BLOCK = re.compile(r"^```(\w+)(?: (\S+))?\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def pattern_of(shown):
    """The regular expression of the output that a page shows."""
    parts = []
    for line in shown:
        if line == "...":
            parts.append(r"(?:[^\n]*\n)*?")
        else:
            parts.append(r"[^\n]*".join(map(re.escape, line.split("..."))) + r"\n")
    return re.compile("".join(parts))


def commands_of(block):
    """[(command, lines shown)] of a console block."""
    commands = []
    for line in block.splitlines():
        if line.startswith("$ "):
            commands.append((line[2:], []))
        elif not commands:
            raise SystemExit(f"a console block begins with output: {line}")
        else:
            commands[-1][1].append(line)
    return commands


def run(command, shown, folder, environment):
    """Whether the output is what the page shows."""
    done = subprocess.run(["bash", "-c", command], cwd=folder, env=environment, text=True, timeout=300,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    output = done.stdout if not done.stdout or done.stdout.endswith("\n") else done.stdout + "\n"
    holds = done.returncode == 0 and pattern_of(shown).fullmatch(output)
    print(f"{'ok  ' if holds else 'FAIL'}  {command}", flush=True)
    if not holds:
        print(f"exit status {done.returncode}; the page shows\n" + "\n".join(shown) +
              f"\nthe command printed\n{output}")
    return bool(holds)


def check_patterns():
    """The comparison itself: what must match does, what must not does not."""
    assert pattern_of(["a 1...2 b", "...", "end"]).fullmatch("a 1x2 b\nmore\nend\n")
    assert pattern_of(["...", "end"]).fullmatch("end\n")
    assert not pattern_of(["a..."]).fullmatch("a\nb\n")
    assert not pattern_of(["a.c"]).fullmatch("abc\n")
    assert not pattern_of([]).fullmatch("anything\n")


def main():
    isochor, page, data, work = map(pathlib.Path, sys.argv[1:])
    check_patterns()
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    (work / "data").symlink_to(data.resolve(), target_is_directory=True)
    environment = {**os.environ, "LC_ALL": "C",
                   "PATH": f"{isochor.resolve().parent}{os.pathsep}{os.environ['PATH']}"}
    judged = []
    for kind, name, block in BLOCK.findall(page.read_text(encoding="utf-8")):
        if kind == "json" and name:
            json.loads(block)
            (work / name).write_text(block, encoding="utf-8")
        elif kind == "console":
            judged += [run(command, shown, work, environment)
                       for command, shown in commands_of(block)]
    print(f"{len(judged)} commands, {judged.count(False)} failures")
    return 0 if judged and all(judged) else 1


if __name__ == "__main__":
    sys.exit(main())
