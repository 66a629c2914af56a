#!/usr/bin/env python3
"""STEP files through OpenCASCADE's writer and back: what stays, and each exception with its cause.

usage: round_trip.py ISOCHOR [FOLDER] [--out FOLDER] [--seconds S]

`isochor convert --rewrite` writes every STEP file of the folder anew. Input and output are then read
here, by a reader of their text that knows nothing of either program, and compared: the B-spline surfaces
of faces (degrees, poles, knots, multiplicities, weights, as doubles), names of faces and products, colours,
the tree of the assembly. A difference without a cause that the program gave is a failure; colours that the writer
states by name, and a product without a name that gets its id, are the same. And without
`--rewrite` the copy must be the same bytes. FOLDER defaults to $ISOCHOR_EXTRA_DATA; without either it is
skipped (exit code 77).
"""
import collections
import json
import re
import subprocess
import sys

from real_folder import SKIPPED, files_of, options_of

_STATEMENT = re.compile(r"#(\d+)\s*=\s*((?:[^';]|'[^']*')*);")
_COMMENT = re.compile(r"/\*.*?\*/", re.S)
_TOKEN = re.compile(r"'(?:[^']|'')*'|#\d+|[(),]|\.\w+\.|[-+]?\d[-+.\dEe]*|[$*]|[A-Za-z_]\w*|\"[^\"]*\"")


# The writer states these by name.
PREDEFINED = {"black": "000", "red": "100", "green": "010", "blue": "001", "yellow": "110",
              "magenta": "101", "cyan": "011", "white": "111"}


def parse(body):
    """[(keyword, arguments)] of an instance: one, or the parts of a complex one."""
    stack = [[]]
    for token in _TOKEN.findall(body):
        if token == "(":
            stack.append([])
        elif token == ")":
            done = stack.pop()
            stack[-1].append(done)
        elif token != ",":
            stack[-1].append(token)
    items = stack[0]
    if items and isinstance(items[0], list):
        items = items[0]
    return [(items[k].upper(), items[k + 1]) for k in range(0, len(items) - 1, 2)]


class Step:
    """What is compared of one file."""

    def __init__(self, path):
        text = _COMMENT.sub("", path.read_text(encoding="latin-1"))
        self.bodies = dict(_STATEMENT.findall(text[text.index("DATA;"):]))
        self.made = {}
        self.surfaces, self.names, self.colours = (collections.Counter() for _ in range(3))
        self.products, self.tree = collections.Counter(), collections.Counter()
        for number, body in self.bodies.items():
            self.look_at(number, body.lstrip()[:40].split("(", 1)[0].strip())

    def parts(self, reference):
        return dict(parse(self.bodies[reference.lstrip("#")]))

    def look_at(self, number, keyword):
        if keyword in ("ADVANCED_FACE", "FACE_SURFACE"):
            name, _, surface, _ = self.parts(number)[keyword]
            self.names[name] += name not in ("''", "$")
            self.surfaces[self.surface(surface)] += 1
        elif keyword == "COLOUR_RGB":
            self.colours[tuple(round(float(x), 6) for x in self.parts(number)[keyword][1:])] += 1
        elif keyword == "PRODUCT":
            self.products[self.product_name(number)] += 1
        elif keyword == "DRAUGHTING_PRE_DEFINED_COLOUR":
            name = self.parts(number)[keyword][0].strip("'").lower()
            if name in PREDEFINED:
                self.colours[tuple(float(bit) for bit in PREDEFINED[name])] += 1
        elif keyword == "NEXT_ASSEMBLY_USAGE_OCCURRENCE":
            arguments = self.parts(number)[keyword]
            self.tree[self.product(arguments[3]), self.product(arguments[4])] += 1

    def product(self, definition):
        formation = self.parts(definition)["PRODUCT_DEFINITION"][2]
        parts = self.parts(formation)
        return self.product_name(next(iter(parts.values()))[2])

    def product_name(self, reference):
        """OpenCASCADE gives a product without a name its id as name."""
        identity, name = self.parts(reference)["PRODUCT"][:2]
        return identity if name in ("''", "$") else name

    def surface(self, reference):
        """A B-spline surface as numbers; None for another."""
        if reference not in self.made:
            self.made[reference] = self.read_surface(self.parts(reference))
        return self.made[reference]

    def read_surface(self, parts):
        if "B_SPLINE_SURFACE" in parts:
            shape = parts["B_SPLINE_SURFACE"]
            knots = parts.get("B_SPLINE_SURFACE_WITH_KNOTS")
            weights = parts.get("RATIONAL_B_SPLINE_SURFACE")
        elif "B_SPLINE_SURFACE_WITH_KNOTS" in parts:
            arguments = parts["B_SPLINE_SURFACE_WITH_KNOTS"]
            shape, knots, weights = arguments[1:8], arguments[8:12], None
        else:
            return None
        if knots is None:
            return None
        poles = tuple(tuple(self.point(p) for p in row) for row in shape[2])
        weights = weights and tuple(tuple(map(float, row)) for row in weights[0])
        if weights and len({w for row in weights for w in row}) == 1:
            weights = None
        lists = [tuple(map(int, knots[0])), tuple(map(int, knots[1]))]
        lists += [tuple(map(float, knots[2])), tuple(map(float, knots[3]))]
        return (int(shape[0]), int(shape[1]), poles, *lists, weights)

    def point(self, reference):
        return tuple(map(float, self.parts(reference)["CARTESIAN_POINT"][1]))


def differences(before, after):
    """{what: how many}."""
    found = {}
    splines = [collections.Counter({k: n for k, n in step.surfaces.items() if k is not None})
               for step in (before, after)]
    found["B-spline surfaces"] = sum((splines[0] - splines[1]).values())
    for what, ours, theirs in (("names of faces", before.names, after.names),
                               ("products", before.products, after.products),
                               ("tree", before.tree, after.tree)):
        found[what] = sum((ours - theirs).values())
    found["colours"] = len(set(before.colours) - set(after.colours))
    return {what: count for what, count in found.items() if count}, sum(splines[0].values())


# What the program says, and what that explains.
CAUSES = [("periodic", "B-spline surfaces"), ("not the file's", "B-spline surfaces"),
          ("other poles", "B-spline surfaces"), ("another form", "B-spline surfaces"),
          ("repaired", "B-spline surfaces")]


def explained(what, notices):
    return [notice for notice in notices for word, of in CAUSES if of == what and word in notice]


def examine(isochor, path, out, seconds):
    """(cells of the table, failures)."""
    copy, anew = out / ("copy_" + path.name), out / ("anew_" + path.name)
    failures = []
    for target, words in ((copy, []), (anew, ["--rewrite"])):
        target.unlink(missing_ok=True)
        done = subprocess.run([isochor, "convert", path, target, "--json", *words],
                              capture_output=True, text=True, timeout=seconds)
        if done.returncode not in (0, 1, 3) or (done.returncode and target.exists()):
            failures.append(f"exit {done.returncode}: {done.stderr.strip()[-200:]}")
        if target is copy and done.returncode == 0 and copy.read_bytes() != path.read_bytes():
            failures.append("the copy differs from the file")
        if target is copy and done.returncode != 0:
            failures.append("no copy: " + done.stderr.strip()[-200:])
    if done.returncode != 0:
        return ["", "refused: " + done.stderr.strip().split(": ", 2)[-1], ""], failures
    notices = json.loads(done.stdout)["notices"]
    found, total = differences(Step(path), Step(anew))
    causes = []
    for what, count in found.items():
        why = explained(what, notices)
        if not why:
            failures.append(f"{count} {what} differ, and no cause is given ({notices})")
        causes += [f"{count} {what}: {reason}" for reason in why]
    same = total - found.get("B-spline surfaces", 0)
    return [f"{same} of {total}", "ok" if not found else ", ".join(found), "; ".join(causes)], failures


def main():
    options = options_of(__doc__.splitlines()[0], "isochor", 600.0, "out/round_trip")
    if not options.folder:
        return SKIPPED
    files = files_of(options.folder, (".step", ".stp"))
    print("| file | B-spline surfaces identical | differs | cause |\n|---|---|---|---|")
    failed = 0
    for path in files:
        cells, failures = examine(options.isochor, path, options.out, options.seconds)
        failed += bool(failures)
        print("| " + " | ".join([path.name, *cells]) + " |" +
              "".join(f"\n  FAILED: {text}" for text in failures), flush=True)
    print(f"{len(files)} files, {failed} failures")
    return 1 if failed or not files else 0


if __name__ == "__main__":
    sys.exit(main())
