#!/usr/bin/env python3
"""Runs the tests that prove the numeric laws and prints the worst deviation each of them measured.

usage: laws.py BUILD_FOLDER

    volume and gradients: published, fast and Gauss against exact rational numbers, degrees 1 to 6 mixed,
    13 x 7, 22 x 1, uneven knots, 1 to 1000 spans, 10,000 random patches; a thousand poles a side;
    the laws of the volume form; gradients against differences;
    coarse gradients: transposed knot insertion, the published knot removal, direct integration.

The tests record what they measured (properties `worst_NAME` and `bound_NAME`). Exit status 1 when a test
fails, is not there, or records a worst deviation above its bound; and when one that must record does not.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

from ledger import Ledger

# program, test, names of what it records
TESTS = [
    ("volume", "VolumeBound.ValueHoldsAgainstExactRationals",
     ["error_over_proven_bound", "proven_bound"]),
    ("volume", "VolumeBound.GradientsHoldAgainstExactRationals", ["gradient"]),
    ("volume", "FourMethods.AllPairsOfDegreesUpToSix", []),
    ("volume", "FourMethods.HighDegrees", []),
    ("volume", "FourMethods.FromOneSpanToAThousand", []),
    ("volume", "FourMethods.TenThousandRandomPatches",
     ["median_pessimism_of_the_printed_bound", "median_pessimism_fast", "median_pessimism_gauss",
      "median_pessimism_published"]),
    ("volume", "Contraction.ExactRationals",
     ["contraction_exact_value", "contraction_exact_gradient"]),
    ("volume", "Contraction.AThousandPolesASide", ["gradient_over_four_eps_m"]),
    ("volume", "Contraction.TranslationChangesNoBit", []),
    ("volume", "Contraction.ThreadsChangeNoBit", []),
    ("volume", "Contraction.UnitCubeAMillionAway", ["unit_cube_a_million_away"]),
    ("volume", "VolumeForm.Translation", ["translation"]),
    ("volume", "VolumeForm.LinearMap", ["linear_map"]),
    ("volume", "VolumeForm.Orientation", []),
    ("volume", "VolumeForm.Linearity", ["linearity"]),
    ("volume", "VolumeForm.Locality", ["locality"]),
    ("volume", "VolumeForm.Gradient", ["difference"]),
    ("volume", "ExactVolume.GradientIsTheExactSlopeInEachCoordinate", []),
    ("multires", "TwoScale.CoarseGradientThreeWays", ["published", "direct"]),
    ("multires", "TwoScale.PublishedRemovalOfAPatchGradient", ["patch"]),
]


def run_tests(program, names, folder):
    """{test: its entry in gtest's JSON} of one test program."""
    if not program.exists():
        return {}
    report = folder / f"{program.name}.json"
    done = subprocess.run([program, f"--gtest_filter={':'.join(names)}",
                           f"--gtest_output=json:{report}", "--gtest_brief=1"],
                          capture_output=True, text=True, timeout=600)
    if done.returncode != 0:
        print(done.stdout)
    suites = json.loads(report.read_text())["testsuites"] if report.exists() else []
    return {f"{suite['name']}.{test['name']}": test for suite in suites
            for test in suite["testsuite"]}


def judge(ledger, name, test, records):
    passed = test is not None and test["status"] == "RUN" and not test.get("failures")
    ledger.fact(name, passed, "passed" if passed else "failed or not there")
    for record in records if passed else []:
        worst, bound = test.get(f"worst_{record}"), test.get(f"bound_{record}")
        if worst is None or bound is None:
            ledger.fact(f"  {record}", False, "not recorded")
        else:
            ledger.law(f"  {record.replace('_', ' ')}", float(worst), float(bound))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build_folder", type=pathlib.Path)
    options = parser.parse_args()
    ledger = Ledger()
    with tempfile.TemporaryDirectory(prefix="isochor-laws-") as temporary:
        for layer in dict.fromkeys(layer for layer, _, _ in TESTS):
            program = options.build_folder / "bin" / f"isochor_{layer}_tests"
            ledger.section(program.name)
            mine = [(name, records) for where, name, records in TESTS if where == layer]
            found = run_tests(program, [name for name, _ in mine], pathlib.Path(temporary))
            for name, records in mine:
                judge(ledger, name, found.get(name), records)
    return ledger.finish()


if __name__ == "__main__":
    sys.exit(main())
