#!/usr/bin/env python3
"""The command line as scripts meet it: the shape of the JSON, exit codes, which files appear.

usage: cli_test.py ISOCHOR SOURCE_FOLDER WORK_FOLDER [unittest options]
"""
import base64
import json
import math
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import unittest

ISOCHOR, SOURCE, WORK = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
CUBE = SOURCE / "data/step/cube.isochor.json"
CUBE_STEP = SOURCE / "data/step/cube.step"
HULL = SOURCE / "data/step/hull.step"
PATCHWORK = SOURCE / "data/step/patchwork.step"
PULL = SOURCE / "data/edits/cube_figure4.json"
HULL_PULL = SOURCE / "data/edits/hull_pull.json"
HALF_HULL = SOURCE / "data/step/half_hull.step"
HALF_HULL_PULL = SOURCE / "data/edits/half_hull_pull.json"


def isochor(*words):
    return subprocess.run([ISOCHOR, *map(str, words)], cwd=WORK, capture_output=True, text=True,
                          timeout=120)


class Scenario(unittest.TestCase):
    def setUp(self):
        """An empty folder."""
        shutil.rmtree(WORK, ignore_errors=True)
        WORK.mkdir(parents=True)

    def run_json(self, *words, code=0):
        """The one JSON value on standard output."""
        done = isochor(*words, "--json")
        self.assertEqual(done.returncode, code, done.stderr)
        return json.loads(done.stdout)

    def expect(self, code, *words, says="", leaves=()):
        """Exit code, a text on standard error, and exactly these files in the folder."""
        before = {p.name for p in WORK.iterdir()}
        done = isochor(*words)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertIn(says, done.stderr)
        if code > 1:
            self.assertEqual(done.stdout, "")
        self.assertEqual({p.name for p in WORK.iterdir()} - before, set(leaves))

    def open_cube(self):
        model = json.loads(CUBE.read_text())
        model["patches"].pop()
        (WORK / "open.isochor.json").write_text(json.dumps(model))
        return "open.isochor.json"

    def reach(self, model):
        """The least and the greatest x of its patches' poles."""
        self.assertEqual(isochor("convert", model, "reach.stl").returncode, 0)
        raw = (WORK / "reach.stl").read_bytes()
        count = struct.unpack_from("<I", raw, 80)[0]
        xs = [struct.unpack_from("<9f", raw, 84 + 50 * k + 12)[0::3] for k in range(count)]
        return min(map(min, xs)), max(map(max, xs))

    def pulled(self):
        self.assertEqual(isochor("edit", CUBE, PULL, "-o", "pulled.isochor.json").returncode, 0)
        return "pulled.isochor.json"


class Info(Scenario):
    def test_joins_in_different_bases_are_tied_in_a_common_one(self):
        done = isochor("info", PATCHWORK)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("tied in a common basis (7 poles against 9)", done.stdout)
        self.assertIn("tied in a common basis (a part of a side)", done.stdout)
        self.assertNotIn("locked", done.stdout)
        joins = self.run_json("info", PATCHWORK)["joins"]
        self.assertEqual(sum(join["common_basis"] for join in joins), 7)
        self.assertTrue(all(join["tied"] for join in joins))
        self.assertEqual({join["bases"] for join in joins if join["common_basis"]},
                         {"7 poles against 9", "a part of a side"})

    def test_patches_and_joins_of_a_patch_model(self):
        info = self.run_json("info", CUBE)
        self.assertEqual([p["name"] for p in info["patches"]],
                         ["top", "bottom", "front", "back", "left", "right"])
        self.assertEqual([p["handle"] for p in info["patches"]],
                         [f"face:{k}" for k in range(1, 7)])
        for k, patch in enumerate(info["patches"]):
            self.assertEqual((patch["degree"], patch["poles"], patch["free_poles"]),
                             ([3, 3], [15, 15], 225))
            self.assertEqual(patch["rows"], [225 * k, 225 * k + 224])
        self.assertEqual(len(info["joins"]), 12)
        self.assertEqual({join["continuity"] for join in info["joins"]}, {"C0"})
        self.assertEqual((info["unit"], info["closed"]), ("m", True))
        self.assertLessEqual(abs(info["volume"] - 1), info["bound"])

    def test_faces_of_a_solid_with_locks_and_reasons(self):
        info = self.run_json("info", HULL)
        self.assertEqual([f["name"] for f in info["faces"]], ["starboard", "port", "transom", "deck"])
        self.assertEqual([f["editable"] for f in info["faces"]], [True] * 2 + [False] * 2)
        self.assertEqual([f["convertible"] for f in info["faces"]], [False] * 2 + [True] * 2)
        self.assertTrue(info["valid"] and info["closed"])
        for patch in info["patches"]:
            held = sum(lock["poles"] for lock in patch["locked"])
            self.assertTrue(all(lock["reason"] for lock in patch["locked"]))
            count = math.prod(patch["poles"])
            self.assertLess(patch["free_poles"], count)
            self.assertGreaterEqual(patch["free_poles"] + held, count)
        self.assertEqual([p["reversed"] for p in info["patches"]], [False, True])


class Sewing(Scenario):
    """A cube of which the file states the six surfaces only."""

    def loose_cube(self, surfaces=slice(None)):
        lines = CUBE_STEP.read_text().splitlines(keepends=True)
        numbers = [line.split("=")[0] for line in lines if "=B_SPLINE_SURFACE_WITH_KNOTS(" in line]
        self.assertEqual(len(numbers), 6)
        text = "".join(lines)
        for old, new in [("MANIFOLD_SOLID_BREP('cube',#1331)",
                          f"GEOMETRIC_SET('cube',({','.join(numbers[surfaces])}))"),
                         ("ADVANCED_BREP_SHAPE_REPRESENTATION",
                          "GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION")]:
            self.assertIn(old, text)
            text = text.replace(old, new)
        (WORK / "loose.step").write_text(text)
        return "loose.step"

    def test_surfaces_become_a_solid_and_say_so(self):
        info = self.run_json("info", self.loose_cube())
        self.assertEqual((info["closed"], info["valid"], info["solids"]), (True, True, 1))
        self.assertLessEqual(abs(info["volume"] - 1), 1e-12)
        sewing = info["import"]["sewing"]
        self.assertEqual((sewing["done"], sewing["declined"]), (True, ""))
        self.assertEqual([sewing[key] for key in ("faces", "shells", "solids", "free_edges_before",
                                                  "free_edges_after", "dropped_faces")],
                         [6, 1, 1, 24, 0, []])
        self.assertIn("sewn within", isochor("info", "loose.step").stdout)
        check = self.run_json("check", "loose.step")
        self.assertEqual([(f["kind"], f["severity"]) for f in check["findings"]][0], ("import", "warning"))

    def test_edits_keep_the_volume_and_the_numbers_of_faces(self):
        model = self.loose_cube()
        self.assertEqual(isochor("suggest", model, "-o", "edits.json").returncode, 0)
        edit = self.run_json("edit", model, "edits.json", "-o", "out.step")
        self.assertTrue(edit["edits"][-1]["volume"]["kept"])
        after = self.run_json("info", "out.step")
        self.assertTrue(after["closed"])
        self.assertEqual(len(after["faces"]), 6)
        against = self.run_json("check", "out.step", "--against", model)["against"]
        self.assertEqual([face["handle"] for face in against], [f"face:{k}" for k in range(1, 7)])
        pulled = json.loads((WORK / "edits.json").read_text())["edits"][0]["move"][0]
        for face in against:
            self.assertLessEqual(face["max_distance"], 3 * math.hypot(*pulled["by"]), face)
        self.assertGreater(against[int(pulled["patch"].removeprefix("face:")) - 1]["moved_poles"], 0)

    def test_what_gains_nothing_stays(self):
        sewing = self.run_json("info", self.loose_cube(slice(1)))["import"]["sewing"]
        self.assertEqual((sewing["done"], sewing["declined"]), (False, ""))
        self.assertFalse(self.run_json("info", CUBE_STEP)["import"]["sewing"]["done"])


class Volume(Scenario):
    def test_value_bound_and_rational_number(self):
        plain = self.run_json("volume", CUBE)
        self.assertEqual(set(plain), {"volume", "bound", "undefined_by_gaps", "exact"})
        self.assertEqual(plain["undefined_by_gaps"], 0, "the patches share their points")
        self.assertIsNone(plain["exact"])
        self.assertLessEqual(abs(plain["volume"] - 1), plain["bound"])
        self.assertEqual(self.run_json("volume", CUBE, "--exact")["exact"], "1")
        self.assertIn("exact: 1\n", isochor("volume", CUBE, "--exact").stdout)

    def test_gradient_has_a_row_a_point_and_no_net_push(self):
        self.run_json("volume", CUBE, "--gradient", "gradient.json")
        rows = json.loads((WORK / "gradient.json").read_text())
        points = json.loads(CUBE.read_text())["points"]
        self.assertEqual(len(rows), len(points))
        for axis in range(3):  # a closed model does not feel translations; scaling gives V per axis
            self.assertLess(abs(math.fsum(row[axis] for row in rows)), 1e-14)
            scaled = math.fsum(row[axis] * point[axis] for row, point in zip(rows, points))
            self.assertAlmostEqual(scaled, 1, delta=1e-13)

    def test_threads_change_no_digit(self):
        one = self.run_json("volume", CUBE, "--gradient", "one.json")
        for threads in ("2", "3"):
            self.assertEqual(self.run_json("volume", CUBE, "--gradient", "more.json", "-j", threads), one)
            self.assertEqual((WORK / "more.json").read_text(), (WORK / "one.json").read_text())

    def test_open_models_need_the_word(self):
        model = self.open_cube()
        self.expect(1, "volume", model, says="--open")
        self.expect(1, "volume", model, "--gradient", "gradient.json", says="open")
        self.assertAlmostEqual(self.run_json("volume", model, "--open")["volume"], 1, delta=1e-12)

    def test_moments_of_the_unit_cube(self):
        result = self.run_json("volume", CUBE, "--moments")
        self.assertEqual(set(result), {"volume", "bound", "undefined_by_gaps", "exact",
                                       "moments"})
        moments = result["moments"]
        self.assertLessEqual(abs(moments["volume"] - 1), moments["volume_bound"])
        for i in range(3):
            self.assertLessEqual(abs(moments["centroid"][i] - 0.5), moments["centroid_bound"][i])
            self.assertLess(moments["centroid_bound"][i], 1e-11)
            for j in range(3):
                for key, expected in (("second_moments", 1 / 12), ("inertia", 1 / 6)):
                    error = abs(moments[key][i][j] - (expected if i == j else 0))
                    self.assertLessEqual(error, moments[key + "_bound"][i][j], (key, i, j))
            self.assertLessEqual(abs(moments["principal_moments"][i] - 1 / 6),
                                 moments["principal_moments_bound"])
            self.assertEqual(moments["principal_axes_bound"][i], math.pi / 2, "any axis will do")
        text = isochor("volume", CUBE, "--moments").stdout
        for words in ("centroid, m (", "inertia about the centroid", "not determined"):
            self.assertIn(words, text)

    def test_moments_of_a_solid_with_planes_and_trims(self):
        result = self.run_json("volume", HULL, "--moments")
        moments = result["moments"]
        self.assertAlmostEqual(moments["volume"], result["volume"], delta=result["bound"])
        # Port and starboard are alike, and the keel line is no axis of symmetry.
        self.assertLessEqual(abs(moments["centroid"][1]), moments["centroid_bound"][1])
        self.assertLessEqual(abs(moments["second_moments"][0][1]),
                             moments["second_moments_bound"][0][1])
        self.assertGreater(moments["second_moments"][0][2], 1000)
        trace = sum(moments["inertia"][i][i] for i in range(3))
        self.assertAlmostEqual(sum(moments["principal_moments"]), trace, delta=1e-9 * trace)
        for axis in moments["principal_axes"]:
            self.assertAlmostEqual(math.hypot(*axis), 1, delta=1e-14)

    def test_moments_of_an_open_model_are_refused(self):
        model = self.open_cube()
        self.expect(1, "volume", model, "--moments", says="it has no moments")
        self.expect(1, "volume", model, "--moments", "--open", says="open")
        refusal = self.run_json("volume", model, "--moments", "--open", code=1)
        self.assertEqual(refusal["outcome"], "refused")

    def test_section_of_the_unit_cube(self):
        result = self.run_json("volume", CUBE, "--section", "1,1,1,1.5")
        self.assertLessEqual({"volume", "bound", "exact", "section"}, set(result))
        section = result["section"]
        self.assertLessEqual(abs(section["area"] - 0.75 * math.sqrt(3)), section["bound"])
        self.assertLess(section["bound"], 1e-11)
        self.assertAlmostEqual(section["height"], 1.5 / math.sqrt(3), delta=1e-15)
        for x in section["centroid"]:
            self.assertAlmostEqual(x, 0.5, delta=section["centroid_bound"])
        self.assertFalse(section["coplanar"])
        self.assertIn("limit from below",
                      isochor("volume", CUBE, "--section", "0,0,1,1").stdout)
        beside = self.run_json("volume", CUBE, "--section=-1,0,0,2")["section"]
        self.assertEqual((beside["area"], beside["centroid"]), (0, None))

    def test_sections_that_are_refused(self):
        self.expect(1, "volume", self.open_cube(), "--section", "0,0,1,0.5", says="no sections")
        self.expect(2, "volume", CUBE, "--section", "0,0,1", says="section")
        self.expect(3, "volume", CUBE, "--section", "0,0,0,1", says="not zero")
        self.expect(3, "volume", HULL, "--section", "0,0,0,1", says="not zero")

    def test_sections_of_a_hull_add_up_to_its_volume(self):
        """Cavalieri: the integral of the areas of its stations is the volume."""
        parts = 8
        facts = self.run_json("volume", HULL)
        box = [self.run_json("volume", HULL, "--section", f"1,0,0,{x}")["section"] for x in (-1e3, 1e3)]
        for outside in box:
            self.assertLessEqual(abs(outside["area"]), outside["bound"])
        low, high = self.reach(HULL)
        nodes = [-0.7745966692414834, 0.0, 0.7745966692414834]
        weights = [5 / 9, 8 / 9, 5 / 9]
        total = 0.0
        for k in range(parts):
            half = (high - low) / parts / 2
            middle = low + (2 * k + 1) * half
            for node, weight in zip(nodes, weights):
                section = self.run_json("volume", HULL, f"--section=1,0,0,{middle + half * node}")["section"]
                self.assertLess(section["bound"], 1e-6 * abs(section["area"]) + 1e-6)
                total += half * weight * section["area"]
        self.assertAlmostEqual(total / facts["volume"], 1.0, delta=2e-3)

    def test_a_model_without_volume_has_no_centroid(self):
        model = json.loads(CUBE.read_text())
        model["points"] = [[x, y, 0] for x, y, _ in model["points"]]
        (WORK / "flat.isochor.json").write_text(json.dumps(model))
        self.expect(3, "volume", "flat.isochor.json", "--moments", says="not different from zero")

    def test_what_gaps_leave_open_stands_beside_the_volume(self):
        check, info = self.run_json("check", HULL), self.run_json("info", HULL)
        tolerance = max(check["max_gap"], check["max_tolerance"])
        open_part = tolerance * math.fsum(face["area"] for face in info["faces"])
        self.assertGreater(open_part, 0)
        for result in (check, info, self.run_json("volume", HULL)):
            self.assertAlmostEqual(result["undefined_by_gaps"], open_part, delta=1e-12 * open_part)
        words = f"gaps of up to {tolerance:.2g} m leave {open_part:.2g} m^3 of the volume undefined"
        for command in ("check", "info", "volume"):
            self.assertIn(words, isochor(command, HULL).stdout, command)
        self.expect(0, "edit", HULL, HULL_PULL, "-o", "hull.step", "--report", "report.json",
                    leaves={"hull.step", "report.json"})
        report = json.loads((WORK / "report.json").read_text())
        self.assertEqual(report["undefined_by_gaps"], info["undefined_by_gaps"])
        self.assertEqual(report["check"]["before"]["undefined_by_gaps"], info["undefined_by_gaps"])
        self.assertNotIn("undefined", isochor("info", CUBE).stdout)

    def test_models_that_are_not_polynomial_patches_have_no_rational_volume(self):
        self.expect(3, "volume", HULL, "--exact", says="omit --exact")


class SuggestAndEdit(Scenario):
    def test_a_suggestion_runs_as_it_is(self):
        self.assertEqual(self.run_json("suggest", CUBE, "-o", "edits.json"),
                         {"outcome": "done", "edits": "edits.json"})
        written = (WORK / "edits.json").read_text()
        self.assertEqual(json.loads(isochor("suggest", CUBE).stdout), json.loads(written))
        edits = json.loads(written)
        self.assertEqual((edits["isochor_edits"], edits["defaults"]), (1, 1))
        report = self.run_json("edit", CUBE, "edits.json", "-o", "out.isochor.json")
        self.assertEqual((report["isochor_report"], report["outcome"]), (1, "done"))
        self.assertTrue((WORK / "out.isochor.json").exists())

    def test_report_has_the_promised_entries(self):
        self.expect(0, "edit", CUBE, PULL, "-o", "out.isochor.json", "--report", "report.json",
                    leaves={"out.isochor.json", "report.json"})
        edit, = json.loads((WORK / "report.json").read_text())["edits"]
        self.assertLessEqual({"before", "after", "relative_change", "bound"}, set(edit["volume"]))
        move, = edit["moves"]
        self.assertLessEqual({"asked", "got", "error"}, set(move))
        self.assertEqual(move["asked"], [0.2, 0.2, 0.9])
        for key, entries in {"joins": {"count", "max_gap", "max_angle_rad"},
                             "constraints": {"rows", "rank", "redundant", "conflicting",
                                             "freedom_left"},
                             "moved": {"coefficients", "poles", "max_distance"},
                             "energy": {"before", "after"}}.items():
            self.assertLessEqual(entries, set(edit[key]), key)
        self.assertEqual(edit["joins"]["max_gap"], 0)
        self.assertEqual(edit["resolved"]["continuity"], "measured")

    def test_a_converted_cylinder_stays_smooth(self):
        model = SOURCE / "data/step/cylinder.isochor.json"
        edits = SOURCE / "data/edits/cylinder_bulge.json"
        done = isochor("edit", model, edits, "-o", "out.isochor.json", "--report", "r.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("kept smooth      14 joins, knot lines or poles", done.stdout)
        record = json.loads((WORK / "r.json").read_text())["edits"][0]
        self.assertEqual(record["skin"]["relations"], 14)
        self.assertLess(record["skin"]["angle_change_rad"], 1e-12)
        self.assertLess(abs(record["volume"]["relative_change"]), 1e-13)
        self.assertEqual(record["locked"], [])
        info = self.run_json("info", model)
        self.assertEqual(len(info["relations"]), 14)
        self.assertEqual({r["lambda"] for r in info["relations"] if "one point" not in r["text"]}, {"1"})

    def test_wishes_that_contradict_each_other_are_named_with_multipliers(self):
        place = {"patch": "top", "uv": [0.5, 0.5]}
        edit = {"extent": "all", "metric": "coefficients", "hold": [place, place],
                "move": [{**place, "by": [0, 0, 0.1]}]}
        (WORK / "e.json").write_text(json.dumps({"isochor_edits": 1, "edits": [edit]}))
        self.expect(1, "edit", CUBE, "e.json", "-o", "out.isochor.json", "--report", "r.json",
                    says="contradict each other within the extent", leaves=["r.json"])
        record = json.loads((WORK / "r.json").read_text())["edits"][0]
        self.assertEqual(record["outcome"], "conflicting")
        for conflict in record["constraints"]["conflicts"]:
            self.assertEqual(sorted(conflict["multipliers"]), ["-1", "1"])
            self.assertIn("move[0]", conflict["constraints"])
        edit["move"] = [{"patch": "top", "uv": [0.3, 0.5], "by": [0, 0, 0.1]}]
        (WORK / "e.json").write_text(json.dumps({"isochor_edits": 1, "edits": [edit]}))
        done = isochor("edit", CUBE, "e.json", "-o", "out.isochor.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("redundant        hold[1] (follows from the others: ignored)", done.stdout)

    def test_a_refusal_writes_the_report_only(self):
        edits = json.loads(PULL.read_text())
        edits["edits"][0]["extent"] = {"radius": 1e-9}
        (WORK / "none.json").write_text(json.dumps(edits))
        self.expect(1, "edit", CUBE, "none.json", "-o", "out.isochor.json", "--report", "report.json",
                    "--picture", "picture.png", says="no free coefficient", leaves={"report.json"})
        report = json.loads((WORK / "report.json").read_text())
        self.assertIn(report["outcome"], ("refused", "infeasible"))
        self.assertTrue(report["edits"][-1]["reason"])

    def test_a_refusal_says_why_once_also_when_quiet(self):
        edits = json.loads(PULL.read_text())
        edits["edits"][0]["extent"] = {"radius": 1e-9}
        (WORK / "none.json").write_text(json.dumps(edits))
        for words in ([], ["-q"]):
            done = isochor("edit", CUBE, "none.json", "-o", "out.isochor.json", *words)
            self.assertEqual(done.returncode, 1)
            self.assertEqual((done.stdout + done.stderr).count("no free coefficient"), 1)

    def test_a_pole_that_goes_far_is_worth_a_remark(self):
        edits = json.loads(PULL.read_text())
        edit = edits["edits"][0]
        edit["extent"] = {"poles": {"top": [[10, 10]]}}
        edit["volume"] = "free"
        (WORK / "far.json").write_text(json.dumps(edits))
        done = isochor("edit", CUBE, "far.json", "-o", "far.isochor.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stderr, r"a pole moved [0-9.e+]+ times as far as asked")
        self.assertEqual(isochor("edit", CUBE, PULL, "-o", "near.isochor.json").stderr, "")

    def test_the_page_holds_numbers_checks_and_picture(self):
        self.expect(0, "edit", HULL, HULL_PULL, "-o", "hull.step", "--html", "page.html",
                    leaves={"hull.step", "page.html"})
        page = (WORK / "page.html").read_text(encoding="utf-8")
        for text in ("759.334406376", "fuller shoulders", "isochor_report", "<li>check: valid"):
            self.assertIn(text, page)
        picture = page.split("base64,", 1)[1].split('"', 1)[0]
        self.assertEqual(base64.b64decode(picture, validate=True)[:8], b"\x89PNG\r\n\x1a\n")

    def test_a_refusal_has_a_page_too(self):
        edits = json.loads(PULL.read_text())
        edits["edits"][0]["extent"] = {"radius": 1e-9}
        (WORK / "none.json").write_text(json.dumps(edits))
        self.expect(1, "edit", CUBE, "none.json", "-o", "out.isochor.json", "--html", "page.html",
                    says="no free coefficient", leaves={"page.html"})
        self.assertIn("no free coefficient", (WORK / "page.html").read_text(encoding="utf-8"))

    def test_nothing_is_written_unless_all_can_be(self):
        for words in (["--report", "nowhere/report.json"], ["--picture", "nowhere/picture.png"],
                      ["--picture", "picture.jpg"], ["--html", "nowhere/page.html"]):
            self.expect(3, "edit", CUBE, PULL, "-o", "out.isochor.json", *words, says=words[1])

    def test_formats_that_cannot_be_written_leave_nothing(self):
        self.expect(3, "edit", CUBE, PULL, "-o", "out.stl", says="cannot write this format")
        self.expect(3, "edit", CUBE, PULL, "-o", "nowhere/out.isochor.json", says="nowhere")


class Check(Scenario):
    def test_valid_and_open(self):
        check = self.run_json("check", CUBE)
        self.assertLessEqual({"valid", "findings", "closed", "max_gap", "max_tolerance", "volume",
                              "bound"}, set(check))
        self.assertEqual((check["valid"], check["findings"], check["max_gap"]), (True, [], 0))
        self.assertEqual(check["max_smooth_angle_rad"], 0, "no edge of the cube is a smooth one")
        check = self.run_json("check", self.open_cube(), code=1)
        self.assertEqual((check["valid"], check["closed"], check["volume"]), (False, False, None))
        self.assertEqual(len(check["findings"]), 4)

    def test_findings_have_places_limits_and_a_picture(self):
        done = isochor("check", self.open_cube(), "--picture", "check.png")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("belongs to one face only", done.stdout)
        self.assertTrue((WORK / "check.png").read_bytes().startswith(b"\x89PNG"))
        check = self.run_json("check", self.open_cube(), code=1)
        for finding in check["findings"]:
            self.assertEqual((finding["kind"], finding["severity"]), ("free edge", "fault"))
            self.assertEqual(len(finding["at"]), 3)
        self.assertIn("--close", check["opening"])
        self.assertEqual(sum(row["edges"] for row in check["edges_by_angle"]), 8)
        self.expect(3, "check", CUBE, "--picture", "check.jpg", says="png")

    def test_findings_name_entities_of_a_step_file(self):
        text = HULL.read_text()
        shell = re.search(r"=CLOSED_SHELL\('[^']*',\((#\d+(?:,#\d+)*)\)\)", text)
        faces = shell[1].split(",")
        (WORK / "lost.step").write_text(text.replace(shell[1], ",".join(faces[:-1])))
        check = self.run_json("check", "lost.step", code=1)
        free = [f for f in check["findings"] if f["kind"] == "free edge"]
        self.assertGreater(len(free), 1)
        for finding in free:
            self.assertRegex(text, finding["entity"] + r"\s*=\s*EDGE_CURVE\(")
            self.assertEqual(len(finding["face_entities"]), 1)
            self.assertIn(finding["face_entities"][0], faces[:-1])
            self.assertIn(f"[{finding['entity']}; face {finding['face_entities'][0]}]", finding["text"])
        self.assertEqual(len({f["entity"] for f in free}), len(free))
        self.assertIn(f"[{free[0]['entity']}; face", isochor("check", "lost.step").stdout)
        for finding in self.run_json("check", self.open_cube(), code=1)["findings"]:
            self.assertEqual((finding["entity"], finding["face_entities"]), (None, []), "no STEP file")

    def dipped_cube(self):
        """A cube whose top is pushed down through its bottom, z = 0."""
        model = json.loads(CUBE.read_text())
        top = {k for row in model["patches"][0]["poles"] for k in row}
        for k in top:
            x, y, _ = model["points"][k]
            if max(abs(x - 0.5), abs(y - 0.5)) < 0.3:
                model["points"][k][2] = -0.1
        (WORK / "dipped.isochor.json").write_text(json.dumps(model))
        self.assertEqual(isochor("convert", "dipped.isochor.json", "dipped.step").returncode, 0)
        return "dipped.step"

    def test_faces_that_cut_through_each_other(self):
        check = self.run_json("check", self.dipped_cube(), "--self-intersections", code=1)
        pairs = check["self_intersections"]
        self.assertEqual((pairs["pairs"], pairs["apart"], pairs["neighbours_apart"], pairs["crossing"]),
                         (15, 2, 12, 1))
        self.assertEqual((pairs["undecided"], pairs["undecided_pairs"]), (0, []))
        self.assertEqual((pairs["faces"], pairs["faces_crossing"]), (6, 0))
        self.assertEqual(pairs["faces_free"] + pairs["faces_undecided"], 6)
        found, = [f for f in check["findings"] if f["kind"] == "self-intersection"]
        self.assertEqual(found["severity"], "fault")
        self.assertLess(abs(found["at"][2]), 1e-9, "the bottom is flat")
        self.assertGreater(found["value"], found["limit"])
        text = (WORK / "dipped.step").read_text()
        for entity in found["face_entities"]:
            self.assertRegex(text, entity + r"\s*=\s*ADVANCED_FACE\(")
        self.assertEqual(len(found["face_entities"]), 2)
        plain = json.loads(isochor("check", "dipped.step", "--json").stdout)
        self.assertNotIn("self_intersections", plain, "not asked for")
        done = isochor("check", "dipped.step", "--self-intersections", "--picture", "dipped.png")
        self.assertIn("cut through each other at", done.stdout)
        self.assertIn("15 pairs of faces: 2 proven apart", done.stdout)
        self.assertTrue((WORK / "dipped.png").read_bytes().startswith(b"\x89PNG"))

    def test_self_intersections_of_patch_models_are_not_looked_for(self):
        self.expect(3, "check", CUBE, "--self-intersections", says="STEP, IGES and BREP files only")

    def test_volume_below_a_plane(self):
        below = self.run_json("volume", CUBE, "--below", "z=0.25")["below"]
        self.assertEqual((below["extent"], below["proven"]), ("part", True))
        self.assertLessEqual(abs(below["volume"] - 0.25), below["bound"])
        self.assertLess(below["bound"], 1e-11)
        self.assertAlmostEqual(below["centroid"][2], 0.125, delta=below["centroid_bound"])
        above = self.run_json("volume", CUBE, "--below=0,0,-2,-0.5")["below"]
        self.assertLessEqual(abs(above["volume"] - 0.75), above["bound"])
        text = isochor("volume", CUBE, "--below", "z=2").stdout
        self.assertIn("the plane misses the model: everything of it lies below", text)
        nothing = self.run_json("volume", CUBE, "--below", "z=-1")["below"]
        self.assertEqual((nothing["extent"], nothing["volume"], nothing["centroid"]), ("nothing", 0, None))

    def test_displacement_of_a_hull_is_its_sections_added_up(self):
        draughts = [self.run_json("volume", HULL, "--below", f"z={z}")["below"] for z in (1, 1.01)]
        area = [self.run_json("volume", HULL, f"--section=0,0,1,{z}")["section"]["area"] for z in (1, 1.005, 1.01)]
        simpson = 0.01 / 6 * (area[0] + 4 * area[1] + area[2])
        self.assertAlmostEqual(draughts[1]["volume"] - draughts[0]["volume"], simpson, delta=1e-8)
        self.assertFalse(draughts[0]["proven"], "trims are an estimate")
        self.assertAlmostEqual(draughts[0]["centroid"][1], 0, delta=draughts[0]["centroid_bound"])
        text = isochor("volume", HULL, "--below", "z=1").stdout
        self.assertIn("centroid of that part, m", text)

    def test_half_models_below_a_plane(self):
        option = self.run_json("check", self.open_cube(), code=1)["opening"].split(": ")[-1].split()[1]
        below = self.run_json("volume", self.open_cube(), "--close", option, "--below", "0.6,0.8,0,0.7")["below"]
        self.assertLessEqual(abs(below["volume"] - 0.5), below["bound"])
        self.assertIn("closed by the plane", below["counted"])
        self.assertIn("without any mirror image", below["counted"])
        refused = self.run_json("volume", self.open_cube(), "--below", "z=0.5", code=1)
        self.assertIn("--close", refused["opening"])
        self.expect(1, "volume", self.open_cube(), "--below", "z=0.5", says="nothing below a plane")
        self.expect(3, "volume", CUBE, "--below", "z<1", says="--below")
        self.expect(3, "volume", self.open_cube(), "--close", "x=0", "--close", "y=0", "--close=1,1,1,0", "--close=1,-1,2,3",
                    "--below", "z=0.5", says="close")

    def test_half_a_hull_is_closed_by_the_planes_that_info_names(self):
        opening = self.run_json("info", HALF_HULL)["opening"]
        planes = re.findall(r'--close "?([^ "]+)', opening)
        self.assertEqual(len(planes), 3, opening)
        half = self.run_json("volume", HALF_HULL, *(f"--close={plane}" for plane in planes))
        whole = self.run_json("volume", HULL)
        self.assertAlmostEqual(2 * half["volume"] / whole["volume"], 1, delta=1e-12)
        self.expect(0, "edit", HALF_HULL, HALF_HULL_PULL, "-o", "half.step", "--report", "half.json",
                    leaves={"half.step", "half.json"})
        report = json.loads((WORK / "half.json").read_text())
        self.assertEqual(len(report["closed_by"]), 3)
        after = self.run_json("volume", "half.step", *(f"--close={plane}" for plane in planes))
        self.assertAlmostEqual(after["volume"] / half["volume"], 1, delta=1e-12)

    def test_planes_close_the_cube(self):
        option = self.run_json("check", self.open_cube(), code=1)["opening"].split(": ")[-1].split()[1]
        check = self.run_json("check", self.open_cube(), "--close", option)
        self.assertEqual((check["valid"], check["closed_by"]), (True, [option.replace("=", " = ")]))
        volume = self.run_json("volume", self.open_cube(), "--close", option, "--moments")
        self.assertAlmostEqual(volume["volume"], 1, delta=1e-14)
        for axis in range(3):
            self.assertAlmostEqual(volume["moments"]["centroid"][axis], 0.5, delta=1e-14)
        self.expect(3, "volume", self.open_cube(), "--close", "z=0.25", says="leaves the plane z = 0.25 by")
        self.expect(3, "volume", self.open_cube(), "--close", "z", says="y=0")
        self.expect(3, "volume", CUBE, "--close", "z=0", says="needs no closing planes")

    def test_against_tells_the_faces_apart_and_keeps_the_exit_code(self):
        against = self.run_json("check", self.pulled(), "--against", CUBE)["against"]
        self.assertEqual([face["handle"] for face in against], [f"face:{k}" for k in range(1, 7)])
        before, after = (json.loads(path.read_text())
                         for path in (CUBE, WORK / "pulled.isochor.json"))
        for face, patch in zip(against, before["patches"]):
            pairs = [(before["points"][i], after["points"][i]) for row in patch["poles"] for i in row]
            self.assertEqual(face["moved_poles"], sum(a != b for a, b in pairs), face["name"])
            self.assertAlmostEqual(face["max_distance"], max(math.dist(*pair) for pair in pairs),
                                   delta=1e-15)
        self.assertEqual(against[1]["text"], "the same bit for bit")

    def test_against_something_else_says_so(self):
        against = self.run_json("check", CUBE, "--against", HULL)["against"]
        self.assertEqual(against[0]["text"], "15 x 15 poles instead of 27 x 15")
        self.assertEqual(against[2]["text"], "not a B-spline face in the original")


class Convert(Scenario):
    def test_there_and_back_through_step_keeps_every_bit(self):
        self.assertEqual(self.run_json("convert", self.pulled(), "cube.step"),
                         {"outcome": "done", "output": "cube.step", "notices": []})
        back = self.run_json("convert", "cube.step", "back.isochor.json")
        self.assertTrue(back["notices"])
        first, second = (json.loads((WORK / name).read_text())
                         for name in ("pulled.isochor.json", "back.isochor.json"))
        self.assertEqual(first["unit"], second["unit"])
        written = {patch["name"]: patch for patch in second["patches"]}
        self.assertEqual(len(written), len(first["patches"]))
        for a in first["patches"]:
            b = written[a["name"]]
            self.assertEqual((a["degree"], a["knots"]), (b["degree"], b["knots"]))
            for row, other in zip(a["poles"], b["poles"], strict=True):
                self.assertEqual([first["points"][i] for i in row],
                                 [second["points"][i] for i in other])

    def test_iges_and_brep_keep_the_volume(self):
        for name in ("hull.igs", "hull.brep"):
            told = self.run_json("convert", HULL, name)
            self.assertTrue(told["notices"], name)  # what the format cannot hold
            volume = self.run_json("volume", name)
            self.assertAlmostEqual(volume["volume"], 759.33440637659101, delta=1e-9)

    def test_triangles_say_that_they_approximate(self):
        for name in ("cube.stl", "cube.obj", "cube.glb"):
            self.expect(0, "convert", CUBE, name, says="not exact", leaves={name})
        self.assertEqual((WORK / "cube.glb").read_bytes()[:4], b"glTF")
        stl = (WORK / "cube.stl").read_bytes()
        count, = struct.unpack("<I", stl[80:84])
        self.assertEqual(len(stl), 84 + 50 * count)
        obj = (WORK / "cube.obj").read_text().splitlines()
        self.assertTrue(any(line.startswith("f ") for line in obj))

    def test_what_a_format_cannot_hold_is_refused(self):
        self.expect(3, "convert", HULL, "hull.isochor.json", says="face:3 (plane)")
        self.expect(3, "convert", CUBE, "cube.xyz", says="cannot be written")
        self.expect(3, "convert", CUBE, "nowhere/cube.step", says="'nowhere' does not exist")


class Render(Scenario):
    def png_size(self, name):
        data = (WORK / name).read_bytes()
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(data[-8:-4], b"IEND")
        return struct.unpack(">II", data[16:24])

    def test_picture_and_deviation(self):
        model = self.pulled()
        self.assertEqual(self.run_json("render", model, "-o", "a.png"),
                         {"outcome": "done", "picture": "a.png"})
        done = isochor("render", model, "-o", "b.png", "--compare", CUBE)
        self.assertIn("deviation from", done.stdout)
        for name in ("a.png", "b.png"):
            self.assertGreaterEqual(min(self.png_size(name)), 400)
        self.assertNotEqual((WORK / "a.png").read_bytes(), (WORK / "b.png").read_bytes())

    def test_same_model_same_bits(self):
        for name in ("a.png", "b.png"):
            self.expect(0, "render", CUBE, "-o", name, "-j", 1 if name == "a.png" else 2,
                        leaves={name})
        self.assertEqual((WORK / "a.png").read_bytes(), (WORK / "b.png").read_bytes())

    def test_a_mesh_is_drawn(self):
        self.assertEqual(isochor("convert", CUBE, "cube.obj").returncode, 0)
        self.expect(0, "render", "cube.obj", "-o", "mesh.png", leaves={"mesh.png"})
        self.assertGreaterEqual(min(self.png_size("mesh.png")), 400)
        (WORK / "bad.obj").write_text("v 0 0 0\nf 1 2 3\n")
        self.expect(3, "render", "bad.obj", "-o", "bad.png", says="bad.obj: line 2: '2'")
        self.expect(3, "render", "cube.obj", "-o", "a.png", "--compare", CUBE, says="cannot be compared")

    def test_nowhere_to_write(self):
        self.expect(3, "render", CUBE, "-o", "nowhere/a.png", says="nowhere")
        self.expect(3, "render", CUBE, "-o", "a.jpg", says=".png")


class Usage(Scenario):
    def test_wrong_words_are_exit_code_2(self):
        for words in ([], ["draw", CUBE], ["info"], ["info", CUBE, HULL], ["edit", CUBE, PULL],
                      ["render", CUBE], ["convert", CUBE], ["info", CUBE, "-j", 0],
                      ["check", CUBE, "--against"], ["suggest", CUBE, "--gradient", "g"],
                      ["info", CUBE, "--progress", "sometimes"]):
            self.expect(2, *words)

    def test_missing_files_are_exit_code_3(self):
        for command in ("info", "volume", "suggest", "check"):
            self.expect(3, command, "nowhere.step", says="nowhere.step")
        self.expect(3, "render", "nowhere.step", "-o", "a.png", says="nowhere.step")
        self.expect(3, "convert", "nowhere.step", "a.brep", says="nowhere.step")
        self.expect(3, "check", CUBE, "--against", "nowhere.step", says="nowhere.step")

    def test_quiet_is_silent(self):
        for words in (["info", CUBE], ["check", CUBE], ["suggest", CUBE, "-o", "edits.json"],
                      ["edit", CUBE, PULL, "-o", "out.isochor.json"]):
            done = isochor(*words, "-q")
            self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""), words)

    def test_help_and_version(self):
        self.assertRegex(isochor("--version").stdout, r"^isochor \d+\.\d+\.\d+\n$")
        for command in ("info", "volume", "suggest", "edit", "check", "convert", "render",
                        "solve"):
            done = isochor(command, "--help")
            self.assertEqual(done.returncode, 0)
            self.assertIn("--json", done.stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
