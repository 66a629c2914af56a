"""A small reading of STEP files (ISO 10303-21): the faces of B-rep solids, number by number.

Reads what the bundled files and the program's output contain: polynomial B-splines, lines, planes,
names, colours. Anything else that is asked for is an error that names the entity.
"""
import re

from splines import Curve, Line, Plane, Surface

_STATEMENT = re.compile(r"#(\d+)\s*=\s*((?:[^';]|'[^']*')*);")
_TOKEN = re.compile(r"'(?:[^']|'')*'|#\d+|[(),]|\.\w+\.|[-+]?\d[-+.\dEe]*|[$*]|\w+")


class Ref(int):
    """The number of an entity."""


class Word(str):
    """An enumeration, a type name, $ or *."""


class Face:
    def __init__(self, entity, name, bounds, surface, same_sense):
        self.entity, self.name, self.bounds = entity, name, bounds
        self.surface, self.same_sense = surface, same_sense


class Edge:
    """One edge of a face: its curve in space, its curves in the face's parameters, its ends."""

    def __init__(self, entity, curve, parameter_curves, ends):
        self.entity, self.curve, self.ends = entity, curve, ends
        self.parameter_curves = parameter_curves


class StepFile:
    def __init__(self, path):
        text = path.read_text(encoding="latin-1")
        self._texts = {int(n): body for n, body in _STATEMENT.findall(text[text.index("DATA;"):])}
        self._made = {}

    def of_type(self, kind):
        return [Ref(n) for n, body in self._texts.items() if re.match(kind + r"\s*\(", body)]

    def arguments(self, ref, kind=None):
        """(type, arguments) of an entity; with `kind`, the arguments, and another type is an error."""
        tokens = _TOKEN.findall(self._texts[ref])
        found, arguments = tokens[0], _parse(tokens[1:])
        if kind is None:
            return found, arguments
        if found != kind:
            raise ValueError(f"#{ref} is {found}, expected {kind}")
        return arguments

    def point(self, ref):
        return tuple(map(float, self.arguments(ref, "CARTESIAN_POINT")[1]))

    def direction(self, ref):
        return tuple(map(float, self.arguments(ref, "DIRECTION")[1]))

    def surface(self, ref):
        return self._once(ref, self._read_surface)

    def curve(self, ref):
        return self._once(ref, self._read_curve)

    def faces(self):
        """Those of the file's only shell, in its order."""
        (shell,) = self.of_type("CLOSED_SHELL")
        return [self._face(ref) for ref in self.arguments(shell, "CLOSED_SHELL")[1]]

    def edges(self, face):
        """Each edge of a face once, with its parameter curves on the face's surface."""
        found = {}
        for bound in face.bounds:
            kind, arguments = self.arguments(bound)
            for oriented in self.arguments(arguments[1], "EDGE_LOOP")[1]:
                entity = self.arguments(oriented, "ORIENTED_EDGE")[3]
                found[entity] = self._edge(entity, face.surface)
        return list(found.values())

    def colours(self):
        """{face entity: (red, green, blue)}."""
        colours = {}
        for ref in self.of_type("STYLED_ITEM"):
            _, styles, item = self.arguments(ref, "STYLED_ITEM")
            seen = list(styles)
            while seen:
                kind, arguments = self.arguments(seen.pop())
                if kind == "COLOUR_RGB":
                    colours[item] = tuple(map(float, arguments[1:]))
                seen += [a for a in _flat(arguments) if isinstance(a, Ref)]
        return colours

    def _once(self, ref, read):
        if ref not in self._made:
            self._made[ref] = read(ref)
        return self._made[ref]

    def _read_surface(self, ref):
        kind, a = self.arguments(ref)
        if kind == "PLANE":
            _, origin, z, x = self.arguments(a[1], "AXIS2_PLACEMENT_3D")
            origin, z, x = self.point(origin), self.direction(z), self.direction(x)
            y = tuple(z[i - 2] * x[i - 1] - z[i - 1] * x[i - 2] for i in range(3))
            return Plane(origin, x, y, origin + z + x)
        if kind != "B_SPLINE_SURFACE_WITH_KNOTS":
            raise ValueError(f"#{ref} is {kind}, expected a B-spline surface or a plane")
        poles = [[self.point(p) for p in row] for row in a[3]]
        return Surface((a[1], a[2]), _knots(a[8], a[10]), _knots(a[9], a[11]), poles)

    def _read_curve(self, ref):
        kind, a = self.arguments(ref)
        if kind == "LINE":
            _, along, length = self.arguments(a[2], "VECTOR")
            return Line(self.point(a[1]), tuple(length * d for d in self.direction(along)))
        if kind != "B_SPLINE_CURVE_WITH_KNOTS":
            raise ValueError(f"#{ref} is {kind}, expected a B-spline curve or a line")
        return Curve(a[1], _knots(a[6], a[7]), [self.point(p) for p in a[2]])

    def _face(self, ref):
        name, bounds, surface, same_sense = self.arguments(ref, "ADVANCED_FACE")
        return Face(ref, name, bounds, surface, same_sense == ".T.")

    def _edge(self, ref, surface):
        _, start, end, geometry, same_sense = self.arguments(ref, "EDGE_CURVE")
        kind, a = self.arguments(geometry)
        if kind not in ("SURFACE_CURVE", "SEAM_CURVE"):
            raise ValueError(f"#{geometry} is {kind}, expected a curve with its parameter curves")
        on_surface = []
        for pcurve in a[2]:
            _, basis_surface, representation = self.arguments(pcurve, "PCURVE")
            if basis_surface == surface:
                items = self.arguments(representation, "DEFINITIONAL_REPRESENTATION")[1]
                on_surface.append(self.curve(items[0]))
        ends = [self.point(self.arguments(v, "VERTEX_POINT")[1]) for v in (start, end)]
        if same_sense == ".F.":
            ends.reverse()
        return Edge(ref, self.curve(a[1]), on_surface, ends)


def _parse(tokens):
    """The nested list of one entity's arguments."""
    stack = [[]]
    for token in tokens:
        first = token[0]
        if first == "(":
            stack.append([])
        elif first == ")":
            done = stack.pop()
            stack[-1].append(done)
        elif first == "#":
            stack[-1].append(Ref(token[1:]))
        elif first == "'":
            stack[-1].append(token[1:-1].replace("''", "'"))
        elif first in "+-0123456789":
            stack[-1].append(float(token) if "." in token else int(token))
        elif first != ",":
            stack[-1].append(Word(token))
    return stack[0][0]


def _flat(values):
    for value in values:
        if isinstance(value, list):
            yield from _flat(value)
        else:
            yield value


def _knots(multiplicities, values):
    return [float(t) for m, t in zip(multiplicities, values) for _ in range(m)]
