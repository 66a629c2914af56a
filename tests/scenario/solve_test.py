#!/usr/bin/env python3
"""isochor solve as scripts meet it: the bundled problems checked by fractions, mistakes, mutants, megabytes.

usage: solve_test.py ISOCHOR SOURCE_FOLDER WORK_FOLDER [unittest options]
"""
import copy
import json
import pathlib
import random
import re
import resource
import shutil
import subprocess
import sys
import time
import unittest
from fractions import Fraction

ISOCHOR, SOURCE, WORK = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
PROBLEMS = SOURCE / "data/problems"
sys.set_int_max_str_digits(0)  # "1e9999" is a number
NAMES = sorted(path.name for path in PROBLEMS.glob("*.json"))


def isochor(*words, timeout=120):
    return subprocess.run([ISOCHOR, "solve", *map(str, words)], cwd=WORK, capture_output=True, text=True,
                          timeout=timeout)


def exact(number):
    """As the program reads it: texts and words exactly, others as the double they denote."""
    if isinstance(number, int) and not -2**63 <= number < 2**64:
        number = float(number)
    return Fraction(number)


def combined(problem, combination, values):
    """(coefficients of the sum of multipliers times constraints, its right side minus what values make of it)."""
    constraints = {c["name"]: c for c in problem["constraints"]}
    left, right = {}, [Fraction(0)] * problem.get("dimension", 1)
    for name, text in zip(combination["constraints"], combination["multipliers"], strict=True):
        for parameter, coefficient in constraints[name]["terms"].items():
            left[parameter] = left.get(parameter, 0) + Fraction(text) * exact(coefficient)
        right = [r + Fraction(text) * exact(q) for r, q in zip(right, constraints[name]["equals"])]
    for parameter, coefficient in left.items():
        if parameter in values:
            right = [r - coefficient * v for r, v in zip(right, values[parameter])]
    return {p: c for p, c in left.items() if c}, right


class Solve(unittest.TestCase):
    def setUp(self):
        shutil.rmtree(WORK, ignore_errors=True)
        WORK.mkdir(parents=True)

    def solve(self, problem, code=0):
        path = WORK / "problem.json"
        path.write_text(json.dumps(problem) if not isinstance(problem, str) else problem)
        done = isochor(path, "--json")
        self.assertEqual(done.returncode, code, done.stderr)
        return json.loads(done.stdout)

    def refuse(self, problem, *says):
        """Exit code 3, nothing printed or written, all these texts in the message."""
        path = WORK / "wrong.json"
        path.write_text(problem if isinstance(problem, str) else json.dumps(problem))
        done = isochor(path, "-o", "out.json", "--json")
        self.assertEqual((done.returncode, done.stdout), (3, ""), done.stderr)
        for text in ("wrong.json", *says):
            self.assertIn(text, done.stderr)
        self.assertLess(len(done.stderr), 1000)
        self.assertFalse((WORK / "out.json").exists())

    def check(self, problem, solution):
        """What the solution says, by arithmetic of fractions."""
        start = {p["name"]: [exact(v) for v in p["value"]] for p in problem["parameters"]}
        anchors = {p: [exact(v) for v in value] for p, value in problem.get("anchors", {}).items()}
        derived = problem.get("derived", {})
        given = {p: anchors.get(p, value) for p, value in start.items() if p not in derived}
        self.assertTrue(solution["proofs_verified"])
        relevant = [c["name"] for c in problem["constraints"]
                    if any(exact(c["terms"][p]) for p in c["terms"] if p in anchors or p in derived)]
        self.assertEqual(solution["relevant"], relevant)
        self.assertEqual(solution["freedom_left"], len(derived) - solution["rank"])
        for key in ("conflicts", "redundant_because", "obstructions"):
            for combination in solution[key]:
                left, residual = combined(problem, combination, given)
                self.assertFalse(set(left) & set(derived), "derived parameters cancel")
                self.assertEqual({p: str(c) for p, c in left.items() if p in anchors},
                                 combination["anchors"])
                self.assertEqual([str(r) for r in residual], combination["residual"])
                if key == "redundant_because":
                    self.assertFalse(any(residual))
                self.assertTrue(any(residual) or key != "conflicts" or combination["anchors"])
        self.assertEqual(not solution["obstructions"], solution["strongly_solvable"])
        if solution["outcome"] != "solved":
            self.assertEqual(solution["values"], {})
            return
        values = {p: [Fraction(v) for v in value] for p, value in solution["values"].items()}
        self.assertEqual(list(values), list(start))
        for p in start:
            if p not in derived:
                self.assertEqual(values[p], given[p])
        for c in problem["constraints"]:
            if c["name"] in relevant:
                for k, q in enumerate(c["equals"]):
                    self.assertEqual(sum(exact(f) * values[p][k] for p, f in c["terms"].items()), exact(q))

    def test_bundled_problems(self):
        self.assertGreaterEqual(len(NAMES), 6)
        readme = (PROBLEMS / "README.md").read_text()
        for name in NAMES:
            with self.subTest(name):
                self.assertIn(f"`{name}`", readme)
                problem = json.loads((PROBLEMS / name).read_text())
                contradicts = name == "overdimensioned.json"
                solution = self.solve(problem, code=1 if contradicts else 0)
                self.check(problem, solution)
                self.assertEqual(bool(solution["redundant"]), name in ("flowsheet.json", "plate.json"))
                for method in ("gcd", "turner", "plain"):
                    again = self.solve({**problem, "method": method}, code=1 if contradicts else 0)
                    self.assertEqual(again, solution)
                problem["constraints"].reverse()
                problem["parameters"].reverse()
                again = self.solve(problem, code=1 if contradicts else 0)
                for key in ("values", "conflicts", "redundant", "redundant_because", "rank"):
                    self.assertEqual(again[key], solution[key])

    def test_contradiction_is_named_and_nothing_but_the_report_is_written(self):
        done = isochor(PROBLEMS / "overdimensioned.json", "-o", "solution.json")
        self.assertEqual(done.returncode, 1)
        self.assertIn("1 x equal spacing + 2 x pitch - 1 x reach reads 0 = -10", done.stderr)
        self.assertEqual([p.name for p in WORK.iterdir()], ["solution.json"])
        solution = json.loads((WORK / "solution.json").read_text())
        self.assertEqual(solution["outcome"], "not_weakly_solvable")
        self.assertEqual(solution["conflicts"][0]["constraints"], ["equal spacing", "pitch", "reach"])
        self.assertEqual(solution["conflicts"][0]["multipliers"], ["1", "2", "-1"])
        quiet = isochor(PROBLEMS / "overdimensioned.json", "-q")
        self.assertEqual((quiet.returncode, quiet.stdout), (1, ""))
        self.assertEqual(quiet.stderr.count("reads 0 = -10"), 1)
        self.assertEqual(isochor(PROBLEMS / "pumps.json", "-q").stdout, "")

    def test_mistakes(self):
        good = json.loads((PROBLEMS / "pumps.json").read_text())

        def wrong(change):
            problem = copy.deepcopy(good)
            change(problem)
            return problem

        self.refuse(wrong(lambda p: p["constraints"][0]["terms"].update(p9=1)),
                    "constraints[0].terms.p9", 'no parameter "p9"')
        self.refuse(wrong(lambda p: p["derived"]["p3"].update(weight=0)), "derived.p3.weight", "positive")
        self.refuse(wrong(lambda p: p["derived"]["p3"].update(weight=-2)), "derived.p3.weight", "-2")
        self.refuse(wrong(lambda p: p.update(dimension=2)), "parameters[0].value", "2 numbers")
        self.refuse(wrong(lambda p: p["anchors"].update(p3=[1])), "derived.p3", "already an anchor")
        self.refuse(wrong(lambda p: p.update(parameters=[])), "parameters", "empty")
        self.refuse(wrong(lambda p: p.update(constraints=[])), "constraints", "empty")
        self.refuse(wrong(lambda p: p.update(anchors={}, derived={})), "anchors", "nothing to do")
        self.refuse(wrong(lambda p: p["constraints"][1].update(terms={})), "constraints[1].terms", "no terms")
        self.refuse(wrong(lambda p: p["parameters"][1].update(name="p1")), "parameters[1].name", '"p1"')
        self.refuse(wrong(lambda p: p.update(ancors={})), '"ancors"')
        self.refuse(wrong(lambda p: p["parameters"][1].update(value=["NaN"])), "parameters[1].value[0]")
        self.refuse(json.dumps(good).replace("[8]", "[NaN]"), "not valid JSON")
        self.refuse(wrong(lambda p: p.update(requires=["quadratic"])), '"quadratic"')
        self.refuse("", "not valid JSON")
        missing = isochor("nowhere.json")
        self.assertEqual(missing.returncode, 3)
        self.assertIn("nowhere.json", missing.stderr)
        self.assertEqual(isochor().returncode, 2)
        self.assertEqual(isochor(PROBLEMS / "pumps.json", "-o", "nowhere/out.json").returncode, 3)

    def test_truncated_files(self):
        text = (PROBLEMS / "flowsheet.json").read_text().rstrip()
        for length in range(0, len(text), 97):
            self.refuse(text[:length], "not valid JSON")

    def test_mutants_are_answered(self):
        """Small changes of good files: solved, an honest no or a named error, never anything else."""
        rng = random.Random(20170401)
        pieces = ["0", "1", "-1", "1e400", "1e-300", '"1/3"', '"1e9999"', "null", "[]", "{}", "true", '"p1"', ":",
                  ",", "9" * 40, '"\\ud800"', "\x00"]
        seen = {0: 0, 1: 0, 3: 0}
        for trial in range(120):
            text = (PROBLEMS / rng.choice(NAMES)).read_text()
            numbers = list(re.finditer(r"-?\d+(?=[\]},])", text))  # in values, terms, hints and weights
            if trial % 2 == 0:  # another number
                for _ in range(rng.randint(1, 3)):
                    old = rng.choice(numbers)
                    new = rng.choice([old[0], "2", "-1", "0", "7", "0.1", '"1/3"', "1e300"])
                    text = text.replace(old[0] + text[old.end()], new + text[old.end()], rng.randint(1, 2))
            else:
                at = rng.randrange(len(text))
                if trial % 3 == 0:
                    text = text[:at] + text[at + rng.randint(1, 9):]
                else:
                    at = rng.choice(numbers).start() if trial % 3 == 1 else at
                    text = text[:at] + rng.choice(pieces) + text[at + 1:]
            (WORK / "mutant.json").write_text(text)
            done = isochor("mutant.json", "--json", timeout=60)
            self.assertIn(done.returncode, seen, f"{trial}: {done.stderr}\n{text}")
            seen[done.returncode] += 1
            if done.returncode == 3:
                self.assertIn("mutant.json", done.stderr)
            else:
                self.check(json.loads(text), json.loads(done.stdout))
        print(f"mutants: {seen}")
        self.assertGreater(min(seen.values()), 0)

    def measured(self, what, text, code, *says):
        """Runs within a minute and 2 GB; prints what it took."""
        path = WORK / "large.json"
        path.write_text(text)
        before = time.monotonic()
        done = isochor(path, "-q", "-o", "out.json", timeout=300)
        seconds = time.monotonic() - before
        peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e3
        print(f"{what}: {len(text) / 1e6:.1f} MB, exit {done.returncode}, {seconds:.1f} s, "
              f"at most {peak:.0f} MB so far")
        self.assertEqual(done.returncode, code, done.stderr[:1000])
        for text in says:
            self.assertIn(text, done.stderr)
        self.assertLess(len(done.stderr), 10000)
        self.assertLess(seconds, 60)
        self.assertLess(peak, 2000)

    def test_ten_megabytes_of_nonsense_are_named_quickly(self):
        size = 10_000_000
        self.measured("brackets", "[" * size, 3, "nested")
        self.measured("digits", "1" * size, 3, "large.json")
        self.measured("text without end", '{"' + "a" * size, 3, "not valid JSON")
        self.measured("keys", "{" + ",".join(f'"k{i}":1' for i in range(size // 12)) + "}", 3,
                      "isochor_problem")
        self.measured("huge numbers", json.dumps({
            "isochor_problem": 1, "dimension": 600_000, "constraints": [],
            "parameters": [{"name": "p", "value": ["1e9999"] * 600_000}]}), 3, "128 MB")

    def chains(self, length, count):
        """Chains of pumps: flows in a row that drop by one each."""
        parameters, constraints, derived = [], [], {}
        for chain in range(count):
            for k in range(length):
                name = f"flow {chain}/{k}"
                parameters.append({"name": name, "value": [length - k]})
                if k > 0:
                    derived[name] = {"hint": [k % 3]}
                    constraints.append({"name": f"drop {chain}/{k}", "equals": [1],
                                        "terms": {f"flow {chain}/{k - 1}": 1, name: -1}})
        return {"isochor_problem": 1, "parameters": parameters, "constraints": constraints,
                "anchors": {"flow 0/0": [7]}, "derived": derived}

    def test_ten_megabytes_of_a_good_problem(self):
        problem = self.chains(25, 2300)
        self.measured("2300 chains of 25", json.dumps(problem), 0)
        self.check(problem, json.loads((WORK / "out.json").read_text()))

    def test_ten_megabytes_that_would_need_gigabytes(self):
        loops = self.chains(58_000, 1)
        for k in range(0, 57_000, 2):  # each flow also leaks into the one after the next
            del loops["constraints"][k // 2]
            loops["constraints"][k // 2]["terms"][f"flow 0/{k // 2 + 3}"] = 2
        self.measured("one chain with leaks", json.dumps(loops), 1, "refused", "the limit is 65536")
        refused = json.loads((WORK / "out.json").read_text())
        self.assertEqual((refused["outcome"], refused["values"]), ("refused", {}))
        self.assertTrue(refused["proofs_verified"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
