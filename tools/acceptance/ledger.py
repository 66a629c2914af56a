"""A list of laws, each printed with what was measured and the bound it must stay below."""
import json
import subprocess


class Ledger:
    """Prints a line per law as it is judged; `finish` prints the verdict and gives the exit status."""

    def __init__(self):
        self.judged = 0
        self.broken = []

    def section(self, title):
        print(title, flush=True)

    def law(self, text, measured, bound):
        """Holds when measured <= bound (so never for NaN)."""
        self._judge(measured <= bound, f"{text}: {float(measured):.3g} <= {float(bound):.3g}", text)

    def fact(self, text, holds, detail=""):
        self._judge(bool(holds), f"{text}: {detail}" if detail else text, text)

    def _judge(self, holds, line, text):
        self.judged += 1
        if not holds:
            self.broken.append(text)
        print(f"  {'ok  ' if holds else 'FAIL'}  {line}", flush=True)

    def finish(self):
        if self.broken or not self.judged:
            print(f"NOT OK: {len(self.broken)} of {self.judged} laws are broken")
            return 1
        print(f"ok: {self.judged} laws hold")
        return 0


def run(*command, seconds=600):
    """Standard output of a command that must succeed."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True,
                          timeout=seconds)
    if done.returncode != 0:
        words = " ".join(str(word) for word in command)
        raise SystemExit(f"NOT OK: exit status {done.returncode} of: {words}\n{done.stderr.strip()}")
    return done.stdout


def run_json(*command):
    return json.loads(run(*command, "--json"))
