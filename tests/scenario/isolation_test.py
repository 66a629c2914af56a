#!/usr/bin/env python3
"""Limits, progress and Ctrl-C, as users meet them: a file that never ends is a pipe nobody writes to.

usage: isolation_test.py ISOCHOR SOURCE_FOLDER WORK_FOLDER [unittest options]
"""
import os
import pathlib
import pty
import re
import select
import shutil
import signal
import subprocess
import sys
import time
import unittest

ISOCHOR, SOURCE, WORK = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
FUSELAGE = SOURCE / "data/step/fuselage.step"
PULL = SOURCE / "data/edits/fuselage_pull.json"
PATIENCE = 60.0


def wait_for(condition):
    """True as soon as the condition holds."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.005)
    return False


def children_of(pid):
    tasks = pathlib.Path(f"/proc/{pid}/task")
    return [int(child) for task in tasks.iterdir()
            for child in (task / "children").read_text().split()]


def alive(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


class Isolation(unittest.TestCase):
    def setUp(self):
        """An empty folder."""
        shutil.rmtree(WORK, ignore_errors=True)
        WORK.mkdir(parents=True)
        self.slow = WORK / "slow.step"

    def start(self, *words, **options):
        return subprocess.Popen([ISOCHOR, *map(str, words)], cwd=WORK, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, **options)

    def cancelled(self, process):
        out, err = process.communicate(timeout=PATIENCE)
        self.assertEqual((process.returncode, out, err), (130, "", "isochor: cancelled\n"))

    def test_ctrl_c_while_reading_ends_the_child_too(self):
        os.mkfifo(self.slow)
        for kind in (signal.SIGINT, signal.SIGTERM):
            process = self.start("info", self.slow)
            self.assertTrue(wait_for(lambda: children_of(process.pid)), "no child was started")
            (child,) = children_of(process.pid)
            process.send_signal(kind)
            self.cancelled(process)
            self.assertFalse(alive(child))

    def test_keys_reach_the_whole_group_and_mean_the_same(self):
        os.mkfifo(self.slow)
        process = self.start("check", self.slow, start_new_session=True)
        self.assertTrue(wait_for(lambda: children_of(process.pid)), "no child was started")
        os.killpg(process.pid, signal.SIGINT)
        self.cancelled(process)

    def test_ctrl_c_while_writing_removes_the_temporary_file(self):
        out = WORK / "out.step"
        out.write_text("older")
        process = self.start("edit", FUSELAGE, PULL, "-o", out, "--report", "report.json")
        temporary = lambda: [p for p in WORK.iterdir() if p.name.startswith(".out.")]
        self.assertTrue(wait_for(temporary), "no temporary file appeared")
        process.send_signal(signal.SIGINT)
        self.cancelled(process)
        self.assertEqual([p.name for p in WORK.iterdir()], ["out.step"])
        self.assertEqual(out.read_text(), "older")

    def test_a_time_limit_names_the_file_the_limit_and_the_remedy(self):
        os.mkfifo(self.slow)
        process = self.start("info", self.slow, "--time-limit", "0.1")
        out, err = process.communicate(timeout=PATIENCE)
        self.assertEqual((process.returncode, out), (3, ""))
        self.assertEqual(err, f"isochor: {self.slow}: took longer than the 0.1 s allowed; "
                              "--time-limit SECONDS allows more\n")

    def test_a_memory_limit_names_the_file_the_limit_and_the_remedy(self):
        for words in (("info", FUSELAGE), ("check", FUSELAGE),
                      ("convert", FUSELAGE, WORK / "out.brep")):
            process = self.start(*words, "--memory-limit", "1")
            out, err = process.communicate(timeout=PATIENCE)
            self.assertEqual((process.returncode, out), (3, ""), words)
            self.assertEqual(err, f"isochor: {FUSELAGE}: needs more memory than the 1 MB allowed; "
                                  "--memory-limit MEGABYTES allows more\n")
            self.assertEqual(list(WORK.iterdir()), [])

    def bars(self, *words):
        """What is drawn on a terminal: a list of (filled cells or None, words after the bar)."""
        try:
            ours, theirs = pty.openpty()
        except OSError as error:
            self.skipTest(f"this machine has no terminals: {error}")
        process = subprocess.Popen([ISOCHOR, *map(str, words)], cwd=WORK, stderr=theirs,
                                   stdout=subprocess.DEVNULL)
        os.close(theirs)
        text = b""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            if not select.select([ours], [], [], 0.1)[0]:
                continue
            try:
                text += os.read(ours, 65536)
            except OSError:  # the program has ended
                break
        os.close(ours)
        self.assertEqual(process.wait(PATIENCE), 0)
        drawn = re.findall(r"\[([ =]{20})\] ([^\r\x1b]*)  \d+ s", text.decode())
        return [(len(bar.rstrip()) if bar.rstrip() == "=" * len(bar.rstrip()) else None, said)
                for bar, said in drawn]

    def test_the_bar_fills_and_names_the_stages(self):
        # Long enough to be drawn: the bar waits for a second before it appears.
        many = WORK / "many.step"
        many.write_text(FUSELAGE.read_text())
        drawn = self.bars("edit", many, PULL, "-o", "out.step")
        of_file = [(bar, said) for bar, said in drawn if "many.step: " in said or "out.step: " in said]
        if not of_file:
            self.skipTest("the machine is too fast for a bar")
        for step in ("reading", "writing"):
            filled = [bar for bar, said in of_file if said.startswith(step) and bar is not None]
            self.assertEqual(filled, sorted(filled))

    def test_no_bar_without_a_terminal_or_when_it_is_off(self):
        process = self.start("info", FUSELAGE)
        self.assertEqual(process.communicate(timeout=PATIENCE)[1], "")
        self.assertEqual(self.bars("info", FUSELAGE, "--progress", "never"), [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
