"""How smoothly B-spline surfaces meet, for checking: angles and curvatures in rational arithmetic.

Written apart from the program: one-sided derivatives from the polynomials of the spans, exact as
fractions; only the last step, an angle or a curvature, is a float. An angle is atan2 of cross and dot
product.
"""
import json
import math
from fractions import Fraction

from splines import span_polynomials, spans

SAMPLES = (Fraction(1, 7), Fraction(1, 2), Fraction(5, 6))   # of each span


class Patch:
    """Poles[i][j] as doubles, weights[i][j] or None."""

    def __init__(self, name, degrees, u_knots, v_knots, poles, weights=None):
        self.name, self.degrees = name, degrees
        self.knots = (u_knots, v_knots)
        self.poles, self.weights = poles, weights
        self._bases = {}

    def basis(self, direction, span, s):
        """Values and two derivatives of the functions on a span at s in [0, 1] of it."""
        key = (direction, span, s)
        if key not in self._bases:
            degree, knots = self.degrees[direction], self.knots[direction]
            rows, denominator = span_polynomials(degree, knots, span)
            width = Fraction(knots[span + 1]) - Fraction(knots[span])
            table = []
            for order in range(3):
                values = []
                for row in rows:
                    value = Fraction(0)
                    for power in range(order, degree + 1):
                        factor = math.perm(power, order)
                        value += row[power] * factor * s ** (power - order)
                    values.append(value / denominator / width ** order)
                table.append(values)
            self._bases[key] = table
        return self._bases[key]

    def derivatives(self, u_span, s, v_span, t):
        """{(a, b): the vector d^a/du^a d^b/dv^b S} for a + b <= 2, exact."""
        in_u, in_v = self.basis(0, u_span, s), self.basis(1, v_span, t)
        i0, j0 = u_span - self.degrees[0], v_span - self.degrees[1]
        numerator = {}
        for a in range(3):
            for b in range(3 - a):
                sums = [Fraction(0)] * 4
                for i, x in enumerate(in_u[a]):
                    for j, y in enumerate(in_v[b]):
                        weight = 1 if self.weights is None else Fraction(self.weights[i0 + i][j0 + j])
                        factor = x * y * weight
                        for axis in range(3):
                            sums[axis] += factor * Fraction(self.poles[i0 + i][j0 + j][axis])
                        sums[3] += factor
                numerator[a, b] = sums
        result = {}
        for a, b in ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)):
            vector = list(numerator[a, b][:3])
            for c in range(a + 1):
                for d in range(b + 1):
                    if (c, d) == (0, 0):
                        continue
                    factor = math.comb(a, c) * math.comb(b, d) * numerator[c, d][3]
                    for axis in range(3):
                        vector[axis] -= factor * result[a - c, b - d][axis]
            result[a, b] = [x / numerator[0, 0][3] for x in vector]
        return result


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def length(a):
    """A float, also of tiny exact vectors."""
    largest = max(abs(x) for x in a)
    return float(largest) * math.sqrt(sum(float(x / largest) ** 2 for x in a)) if largest else 0.0


def angle(a, b):
    return math.atan2(length(cross(a, b)), float(dot(a, b)))


def across(at, direction):
    """The normal, and the normal curvature across the line where parameter `direction` is constant;
    None where the surface is singular."""
    su, sv = at[1, 0], at[0, 1]
    normal = cross(su, sv)
    square = dot(normal, normal)
    if not square:
        return None
    d = cross(normal, sv if direction == 0 else su)
    a, b = dot(cross(d, sv), normal) / square, dot(cross(su, d), normal) / square
    second = a * a * dot(at[2, 0], normal) + 2 * a * b * dot(at[1, 1], normal) + b * b * dot(at[0, 2], normal)
    return normal, float(second / dot(d, d)) / math.sqrt(float(square))


def place(patch, direction, line, span):
    """Arguments of `derivatives` on both sides of a knot line, sample by sample along a span."""
    knots = patch.knots[direction]
    below = max(k for k in spans(patch.degrees[direction], knots) if knots[k + 1] == line)
    above = min(k for k in spans(patch.degrees[direction], knots) if knots[k] == line)
    for t in SAMPLES:
        sides = ((below, Fraction(1)), (above, Fraction(0)))
        yield [(k, s, span, t) if direction == 0 else (span, t, k, s) for k, s in sides]


def knot_lines(patch):
    """(direction, knot) of the inner lines at which the basis alone keeps no curvature."""
    for direction in (0, 1):
        degree, knots = patch.degrees[direction], patch.knots[direction]
        for knot in sorted(set(knots)):
            inside = knots[degree] < knot < knots[-degree - 1]
            if inside and degree - knots.count(knot) < 2:
                yield direction, knot


def line_jumps(patch):
    """{(patch, "u" or "v", knot): [(angle, curvature jump) of each sample]}"""
    found = {}
    for direction, knot in knot_lines(patch):
        samples = []
        for span in spans(patch.degrees[1 - direction], patch.knots[1 - direction]):
            for sides in place(patch, direction, knot, span):
                frames = [across(patch.derivatives(*side), direction) for side in sides]
                if None not in frames:
                    samples.append((angle(frames[0][0], frames[1][0]), frames[1][1] - frames[0][1]))
        found[patch.name, "uv"[direction], knot] = samples
    return found


SIDES = [(0, 0), (0, -1), (1, 0), (1, -1)]   # direction that is constant, which end


def side_poles(patch, side, depth=0):
    direction, end = side
    row = depth if end == 0 else -1 - depth
    return patch.poles[row] if direction == 0 else [line[row] for line in patch.poles]


def near(a, b, tolerance):
    return all(abs(x - y) <= tolerance for x, y in zip(a, b))


def joins(patches, tolerance):
    """(patch, side, patch, side, reversed) of sides with the same poles and knots of the same shape."""
    all_sides = [(p, side) for p in patches for side in SIDES]
    for k, (p, one) in enumerate(all_sides):
        for q, other in all_sides[k + 1:]:
            a, b = side_poles(p, one), side_poles(q, other)
            if len(a) != len(b) or near(a[0], a[-1], tolerance) and all(
                    near(a[0], x, tolerance) for x in a):
                continue
            for turned in (False, True):
                if all(near(x, y, tolerance) for x, y in zip(a, reversed(b) if turned else b)):
                    yield p, one, q, other, turned
                    break


def side_samples(patch, side, turned):
    direction, end = side
    mine, other = direction, 1 - direction
    own = spans(patch.degrees[mine], patch.knots[mine])
    k, s = (own[0], Fraction(0)) if end == 0 else (own[-1], Fraction(1))
    along = spans(patch.degrees[other], patch.knots[other])
    for span in reversed(along) if turned else along:
        for t in SAMPLES:
            t = 1 - t if turned else t
            yield (k, s, span, t) if mine == 0 else (span, t, k, s)


def join_jumps(patches, tolerance):
    """{(patch, side, patch, side): samples}; normals of the two sides compared up to sign."""
    found = {}
    for p, one, q, other, turned in joins(patches, tolerance):
        samples = []
        for a, b in zip(side_samples(p, one, False), side_samples(q, other, turned)):
            first = across(p.derivatives(*a), one[0])
            second = across(q.derivatives(*b), other[0])
            if first is None or second is None:
                continue
            sign = 1 if dot(first[0], second[0]) > 0 else -1
            samples.append((angle(first[0], [sign * x for x in second[0]]),
                            sign * second[1] - first[1]))
        found[p.name, one, q.name, other] = samples
    return found


def pole_angles(patch, tolerance):
    """{(patch, side): angles between the limits of the normals at a collapsed side and the first}"""
    found = {}
    for side in SIDES:
        poles = side_poles(patch, side)
        if not all(near(poles[0], x, tolerance) for x in poles):
            continue
        normals = []
        for at in side_samples(patch, side, False):
            d = patch.derivatives(*at)
            # Next to the pole S = P + h D(t), so the normal tends to D' x D.
            normal = cross(d[1, 1], d[1, 0] if side[0] == 0 else d[0, 1])
            if any(normal):
                normals.append(normal)
        found[patch.name, side] = [(angle(normals[0], n), 0.0) for n in normals]
    return found


def jumps(patches, size):
    """All of the above, of one model."""
    found = dict(join_jumps(patches, 1e-9 * size))
    for patch in patches:
        found.update(line_jumps(patch))
        found.update(pole_angles(patch, 1e-9 * size))
    return found


def read_model(path):
    """The patches of an `.isochor.json` file."""
    model = json.loads(path.read_text())
    points = model["points"]
    return [Patch(p["name"] or f"face:{k + 1}", p["degree"], *p["knots"],
                  [[points[i] for i in row] for row in p["poles"]], p["weights"])
            for k, p in enumerate(model["patches"])]


def diagonal(patches):
    corners = list(zip(*(pole for p in patches for row in p.poles for pole in row)))
    return math.dist([min(x) for x in corners], [max(x) for x in corners])
