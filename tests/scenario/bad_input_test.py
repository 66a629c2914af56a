#!/usr/bin/env python3
"""Bad input: the exit code, the named entity, and that nothing is written.

usage: bad_input_test.py ISOCHOR SOURCE_FOLDER WORK_FOLDER
"""
import json
import pathlib
import subprocess
import sys

isochor, source, work = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
work.mkdir(parents=True, exist_ok=True)
cube = source / "data/step/cube.isochor.json"
fuselage = source / "data/step/fuselage.step"
failures = []


def script(name, **keys):
    edit = {"name": name, "move": [{"patch": "top", "uv": [0.7, 0.8], "by": [0, 0, 0.1]}],
            "extent": {"radius": 0.5}, "metric": "coefficients"}
    edit.update(keys)
    path = work / (name + ".json")
    path.write_text(json.dumps({"isochor_edits": 1, "edits": [edit]}))
    return path


def expect(name, code, words, *arguments, output=None):
    done = subprocess.run([isochor, *map(str, arguments)], capture_output=True, text=True,
                          timeout=120)
    text = done.stdout + done.stderr
    missing = [word for word in words if word not in text]
    written = output is not None and output.exists()
    if done.returncode != code or missing or written:
        failures.append(name)
        print(f"{name}: exit {done.returncode}, expected {code}; missing {missing}; "
              f"written {written}\n{text}")
    else:
        print(f"{name}: exit {code}: {text.strip().splitlines()[-1]}")


def edit(name, code, words, model, edits):
    suffix = ".isochor.json" if str(model).endswith(".json") else ".step"
    out = work / ("out_" + name + suffix)
    out.unlink(missing_ok=True)
    expect(name, code, words, "edit", model, edits, "-o", out, output=out)


def move_of(patch, uv, by=(0, 0, 0.1)):
    return [{"patch": patch, "uv": list(uv), "by": list(by)}]


edit("missing", 3, ["nowhere.step", "no such file"], "nowhere.step", script("good"))
edit("missing_edits", 3, ["nowhere.json", "no such file"], cube, "nowhere.json")
truncated = work / "truncated.step"
truncated.write_bytes(fuselage.read_bytes()[:100_000])
edit("truncated", 3, ["truncated.step"], truncated, script("good"))
empty = work / "empty.step"
empty.write_bytes(b"")
edit("empty_file", 3, ["empty.step"], empty, script("good"))
edit("wrong_key", 3, ["wrong_key.json", "edits[0]", '"exent"'], cube, script("wrong_key", exent=3))
broken = work / "broken.json"
broken.write_text('{"isochor_edits": 1, "edits": [')
edit("broken_json", 3, ["broken.json", "not valid JSON"], cube, broken)
edit("uv_outside", 3, ["move[0]", "(0.7, 1.8)", "domain"], cube,
     script("uv_outside", move=move_of("top", (0.7, 1.8))))
edit("trimmed_away", 3, ["move[0]", "trimmed away"], fuselage,
     script("trimmed_away", move=move_of("window left 1", (1, 1))))
edit("unknown_patch", 3, ['"tpo"', "there are: face:1"], cube,
     script("unknown_patch", move=move_of("tpo", (0.7, 0.8))))
twins = json.loads(cube.read_text())
for patch in twins["patches"]:
    patch["name"] = "side"
twin_file = work / "twins.isochor.json"
twin_file.write_text(json.dumps(twins))
edit("ambiguous_patch", 3, ['"side"', "ambiguous", "face:1"], twin_file,
     script("ambiguous_patch", move=move_of("side", (0.7, 0.8))))
edit("nan_text", 3, ["move[0].by[2]"], cube,
     script("nan_text", move=move_of("top", (0.7, 0.8), (0, 0, "NaN"))))
nan = work / "nan.isochor.json"
nan.write_text(cube.read_text().replace("0.0", "NaN", 1))
edit("nan_number", 3, ["nan.isochor.json"], nan, script("good"))
edit("empty_extent", 1, ["no free coefficient"], cube,
     script("empty_extent", extent={"radius": 1e-9}))
edit("too_small_extent", 1, ["volume"], cube,
     script("too_small_extent", extent={"poles": {"top": [[7, 7]]}},
            move=[{"patch": "top", "pole": [7, 7], "by": [0, 0, 0.1]}]))
opened = json.loads(cube.read_text())
opened["patches"].pop()
open_file = work / "open.isochor.json"
open_file.write_text(json.dumps(opened))
edit("open_shell", 1, ["open", "side"], open_file, script("open_shell"))
expect("open_volume", 1, ["open"], "volume", open_file)
edit("energy", 3, ['"energy"', "coefficients"], cube, script("energy", metric="energy"))
expect("no_arguments", 2, ["subcommand"])
expect("unknown_option", 2, ["--colour"], "info", cube, "--colour")
expect("not_yet", 2, ["not available in this version"], "sculpt", "a.obj", "b.json")
expect("unknown_format", 3, ["unknown model format"], "info", source / "README.md")

print(f"{len(failures)} failures")
sys.exit(1 if failures else 0)
