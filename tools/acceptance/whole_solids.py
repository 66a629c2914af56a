#!/usr/bin/env python3
"""Compares the volume of every closed solid of a folder with OpenCASCADE's slow adaptive result.

usage: whole_solids.py PROBE [FOLDER] [--seconds N]

PROBE is the program isochor_solid_probe. FOLDER defaults to ISOCHOR_EXTRA_DATA; with neither, nothing
runs and the exit status is 77. Every volume is computed in a process of its own, N seconds of its
processor time at most (120).

A solid whose faces leave gaps has a volume only up to about the gap times the area, and integrals that
agree without gaps differ by as much. So both sides compute the same integral here, of p . n / 3 about
the point that OpenCASCADE takes as origin; the column `gaps` is the tolerance times the area, `axes` how
far our integrals about the three axes are apart, which must be less. All numbers but volumes are
relative to the volume.

OpenCASCADE's tolerance is its own estimate and no bound. Its result counts as converged up to the change
between its last two tolerances. Where ours is farther away than that and our bound, the faces are
compared one by one, and those that differ are integrated a third time by brute force. A disagreement is
settled when that settles every such face. Where brute force does not converge, but our three axes agree to
rounding, it is called NOT SETTLED and does not fail. Exit status 1 when a disagreement is ours or unexplained.
"""
import collections
import resource
import signal
import subprocess
import sys

from real_folder import SKIPPED, files_of, options_of

SUFFIXES = {".step", ".stp", ".igs", ".iges", ".brep", ".brp"}
TOLERANCES = ("1e-10", "1e-12", "1e-14")
ROUNDING = 2e-15     # of OpenCASCADE's own sums, relative to the volume
UNSETTLED = 1e-7     # a change between tolerances by which a result has not converged at all
AXES = 1e-13         # of the volume: three axes that agree
SHARE = 0.1          # of a disagreement that a third method may be away from one side
LEFT_OPEN = "leaves a gap in a loop open"
SUSPECTS = 6         # faces looked at, the worst first

Face = collections.namedtuple("Face", "ours theirs bound")


class Probe:
    def __init__(self, program, seconds):
        self.program, self.seconds = program, seconds

    def run(self, *arguments):
        """Names and numbers, `faces` by number; None when it took too long; raises when it failed."""
        command = [str(self.program), *map(str, arguments)]

        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (self.seconds, self.seconds + 1))

        done = subprocess.run(command, capture_output=True, text=True, preexec_fn=limit)
        if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
            return None
        if done.returncode != 0:
            lines = done.stderr.strip().splitlines()
            raise RuntimeError(lines[-1] if lines else f"exit status {done.returncode}")
        result = {"faces": {}}
        for line in done.stdout.splitlines():
            words = line.split()
            if words[:2] == [":", "face"]:
                result["faces"][int(words[2])] = Face(*map(float, words[3:6]))
            elif words[:1] == [":"]:
                result[words[1]] = float(words[2])
        return result


def slow_results(probe, place):
    """OpenCASCADE's volumes at ever smaller tolerances, as far as time allows."""
    results = []
    for tolerance in TOLERANCES:
        result = probe.run(*place, "adaptive", tolerance)
        if result is None:
            break
        results.append(result["volume"])
    return results


def suspects(before, after):
    """Faces on which two results of OpenCASCADE agree better with each other than with us."""
    found = []
    for number, face in after.items():
        unsure = abs(face.theirs - before[number].theirs) + face.bound
        if abs(face.ours - face.theirs) > 2.0 * unsure:
            found.append((abs(face.ours - face.theirs), number))
    worst = max(found, default=(0.0, 0))[0]
    return [number for off, number in sorted(found, reverse=True) if off >= SHARE * worst][:SUSPECTS]


def settle(probe, place, number, face):
    """(who is right, why) about one face."""
    off = abs(face.ours - face.theirs)
    third = probe.run(*place, "third", number, SHARE * off / 2.0)
    if third is None:
        return "nobody", f"face {number + 1}: the third method took too long"
    from_ours, from_theirs = abs(third["volume"] - face.ours), abs(third["volume"] - face.theirs)
    if third["change"] > SHARE * off:
        return "nobody", f"face {number + 1}: the third method did not converge ({third['change']:.1e})"
    if from_ours <= SHARE * off:
        if off <= 2.0 * third["open"]:
            return "ours", f"face {number + 1}: OpenCASCADE {LEFT_OPEN}, worth {off:.1e}"
        return "ours", f"face {number + 1}: OpenCASCADE is off by {off:.1e}, a third method by {from_ours:.1e}"
    if from_theirs <= SHARE * off:
        return "theirs", f"face {number + 1}: ours is off by {off:.1e}, a third method agrees with theirs"
    return "nobody", f"face {number + 1}: a third method is away by {from_ours:.1e} and {from_theirs:.1e}"


def judge(probe, place, ours):
    """(verdict, list of reasons, slow results) for one solid."""
    slow = slow_results(probe, place)
    volume, bound = ours["cones"], ours["cones_bound"] + ROUNDING * abs(ours["cones"])
    if not ours["spread"] <= max(ours["tolerance"], ours["edge_gap"]) * ours["area"] + 3.0 * bound:
        return "OURS", ["the integrals about the axes differ by more than the gaps allow"], slow
    if len(slow) < 2:
        return "no result of OpenCASCADE in time", [], slow
    change = abs(slow[-1] - slow[-2])
    if abs(slow[-1] - volume) <= bound:
        return "within our bound", [], slow
    if abs(slow[-1] - volume) <= bound + 2.0 * change:
        word = "not converged" if change > UNSETTLED * abs(volume) else "within its last change"
        return word, [], slow
    last = TOLERANCES[len(slow) - 2:len(slow)]
    faces = [probe.run(*place, "faces", tolerance) for tolerance in last]
    if None in faces:
        return "UNEXPLAINED", ["the comparison of the faces took too long"], slow
    reasons, right = [], set()
    for number in suspects(faces[0]["faces"], faces[1]["faces"]):
        who, why = settle(probe, place, number, faces[1]["faces"][number])
        right.add(who)
        reasons.append(why)
    if right == {"ours"}:
        open_loops = all(LEFT_OPEN in why for why in reasons)
        if open_loops and abs(slow[-1] - volume) > 2.0 * ours["open"] + bound:
            return "UNEXPLAINED", reasons + ["all gaps in loops are worth less"], slow
        return f"OpenCASCADE {LEFT_OPEN if open_loops else 'is wrong'}", reasons, slow
    return ("OURS" if "theirs" in right else "UNEXPLAINED"), reasons, slow


def relative(number, volume):
    return f"{number / abs(volume):9.1e}"


def check_file(probe, path, name):
    """The number of solids, and how many failed."""
    try:
        count = int((probe.run(path) or {}).get("solids", 0))
    except RuntimeError as fault:
        print(f"{name}: not read: {fault}")
        return 0, 0
    failed = 0
    for k in range(count):
        place = (path, k)
        ours = probe.run(*place, "ours")
        if ours is None:
            print(f"{name} {k + 1}: ours took too long")
            failed += 1
            continue
        verdict, reasons, slow = judge(probe, place, ours)
        volume = ours["volume"]
        # Wrong fluxes of a closed solid would not agree along three axes.
        undecided = verdict == "UNEXPLAINED" and all("did not converge" in text for text in reasons)
        if undecided and reasons and ours["spread"] <= AXES * abs(volume):
            verdict = "NOT SETTLED by a third method; our three axes agree"
        gaps = max(ours["tolerance"], ours["edge_gap"]) * ours["area"]
        print(f"{name[:40]:40} {k + 1:2} {volume:15.8g} {relative(ours['bound'], volume)} "
              f"{relative(gaps, volume)} {relative(ours['spread'], volume)} "
              + " ".join(relative(value - ours["cones"], volume) for value in slow).ljust(29)
              + f"  {verdict}", flush=True)
        for reason in reasons:
            print(f"      {reason}", flush=True)
        failed += verdict in ("OURS", "UNEXPLAINED")
    return count, failed


def main():
    options = options_of(__doc__.splitlines()[0], "probe", 120)
    if not options.folder:
        return SKIPPED
    probe = Probe(options.probe, options.seconds)
    titles = " ".join(f"Eps {tolerance}".rjust(9) for tolerance in TOLERANCES)
    print(f"{'file':40} {'':2} {'volume':>15} {'bound':>9} {'gaps':>9} {'axes':>9} {titles}  verdict")
    solids = failed = 0
    for path in files_of(options.folder, SUFFIXES):
        count, wrong = check_file(probe, path, str(path.relative_to(options.folder)))
        solids, failed = solids + count, failed + wrong
    print(f"{solids} closed solids, {failed} disagreements that are ours or unexplained")
    return 1 if failed or not solids else 0


if __name__ == "__main__":
    sys.exit(main())
