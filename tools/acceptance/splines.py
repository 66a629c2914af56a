"""B-splines for checking: points by Cox and de Boor, volumes in rational numbers.

Written apart from the program, on other formulas: where both agree, neither is wrong by habit.
Knots are flat lists with repetitions. A surface has poles[i][j], i along u, j along v.
"""
from bisect import bisect_right
from fractions import Fraction
from math import lcm


class Curve:
    """A polynomial B-spline curve in any dimension."""

    def __init__(self, degree, knots, poles):
        self.degree, self.knots, self.poles = degree, knots, poles

    def domain(self):
        return self.knots[self.degree], self.knots[-self.degree - 1]

    def at(self, t):
        first, values = basis(self.degree, self.knots, t)
        return combine(values, self.poles[first:first + self.degree + 1])


class Line:
    def __init__(self, origin, direction):
        self.origin, self.direction = origin, direction

    def at(self, t):
        return tuple(o + t * d for o, d in zip(self.origin, self.direction))


class Plane:
    """origin + u x + v y with unit vectors x, y; `numbers` are those of the file."""

    def __init__(self, origin, x, y, numbers):
        self.origin, self.x, self.y, self.numbers = origin, x, y, numbers

    def at(self, u, v):
        return tuple(o + u * a + v * b for o, a, b in zip(self.origin, self.x, self.y))


class Surface:
    """A polynomial B-spline surface."""

    def __init__(self, degrees, u_knots, v_knots, poles):
        self.degrees, self.u_knots, self.v_knots, self.poles = degrees, u_knots, v_knots, poles

    def at(self, u, v):
        """With Fraction parameters the point is exact."""
        i, in_u = basis(self.degrees[0], self.u_knots, u)
        j, in_v = basis(self.degrees[1], self.v_knots, v)
        rows = self.poles[i:i + self.degrees[0] + 1]
        if isinstance(u, Fraction):
            rows = [[tuple(map(Fraction, pole)) for pole in row] for row in rows]
        return combine(in_u, [combine(in_v, row[j:j + self.degrees[1] + 1]) for row in rows])

    def bits(self):
        """All numbers of the surface, letter by letter."""
        return (self.degrees, [t.hex() for t in self.u_knots], [t.hex() for t in self.v_knots],
                [[pole_bits(pole) for pole in row] for row in self.poles])

    def support(self, i, j):
        """(u0, u1, v0, v1): outside, the pole (i, j) does nothing."""
        return (self.u_knots[i], self.u_knots[i + self.degrees[0] + 1],
                self.v_knots[j], self.v_knots[j + self.degrees[1] + 1])


def pole_bits(pole):
    return tuple(x.hex() for x in pole)


def combine(weights, points):
    return tuple(sum(w * x for w, x in zip(weights, column)) for column in zip(*points))


def span_of(degree, knots, t):
    """k with knots[k] <= t < knots[k + 1], at the end of the domain the last such span."""
    last = len(knots) - degree - 1
    k = min(max(bisect_right(knots, t) - 1, degree), last - 1)
    while knots[k] == knots[k + 1]:
        k -= 1
    return k


def basis(degree, knots, t):
    """First function that does not vanish at t, and the degree + 1 values (exact for a Fraction)."""
    k = span_of(degree, knots, t)
    local = knots[k - degree + 1:k + degree + 1]
    if isinstance(t, Fraction):
        local = [Fraction(knot) for knot in local]
    values = [t * 0 + 1]
    for d in range(1, degree + 1):
        raised = [t * 0] * (d + 1)
        for r in range(d):
            left, right = local[degree + r - d], local[degree + r]
            part = values[r] / (right - left)
            raised[r] += (right - t) * part
            raised[r + 1] += (t - left) * part
        values = raised
    return k - degree, values


def span_polynomials(degree, knots, k):
    """Of the functions k - degree .. k on span k: coefficients of 1, s, s^2, ... in s from 0 to 1
    along the span, as whole numbers over one denominator: (rows, denominator)."""
    exact = [Fraction(t) for t in knots[k - degree + 1:k + degree + 1]]
    begin, width = exact[degree - 1], exact[degree] - exact[degree - 1]
    rows = [[Fraction(1)]]
    for d in range(1, degree + 1):
        raised = [[Fraction(0)] * (d + 1) for _ in range(d + 1)]
        for r in range(d):
            left, right = exact[degree + r - d], exact[degree + r]
            for power, c in enumerate(rows[r]):
                c /= right - left
                raised[r][power] += (right - begin) * c
                raised[r][power + 1] -= width * c
                raised[r + 1][power] += (begin - left) * c
                raised[r + 1][power + 1] += width * c
        rows = raised
    denominator = lcm(*(c.denominator for row in rows for c in row))
    return [[int(c * denominator) for c in row] for row in rows], denominator


def spans(degree, knots):
    return [k for k in range(degree, len(knots) - degree - 1) if knots[k] < knots[k + 1]]


def flux(surface):
    """The integral of y dz dx over the surface, an exact rational number."""
    (du, dv), poles = surface.degrees, surface.poles
    exponent = max(x.as_integer_ratio()[1].bit_length() - 1 for row in poles for p in row for x in p)
    whole = [[[int(Fraction(p[axis]) * 2 ** exponent) for p in row] for row in poles]
             for axis in range(3)]
    common = lcm(*range(1, 3 * max(du, dv) + 1))
    weights = [common // (p + 1) for p in range(3 * max(du, dv))]
    in_v = [(k - dv,) + span_polynomials(dv, surface.v_knots, k) for k in spans(dv, surface.v_knots)]
    sums = {}
    for k in spans(du, surface.u_knots):
        rows, denominator_u = span_polynomials(du, surface.u_knots, k)
        strip = [contract_u(rows, axis[k - du:k + 1]) for axis in whole]
        for first, columns, denominator_v in in_v:
            x, y, z = (contract_v(columns, axis, first) for axis in strip)
            key = denominator_u * denominator_v
            sums[key] = sums.get(key, 0) + element_flux(x, y, z, weights)
    total = sum(Fraction(value, key ** 3) for key, value in sums.items())
    return Fraction(total) / (2 ** (3 * exponent) * common ** 2)


def contract_u(rows, lines):
    """Coefficients in u of each column of the poles `lines`."""
    return [[sum(row[p] * line[j] for row, line in zip(rows, lines)) for j in range(len(lines[0]))]
            for p in range(len(rows))]


def contract_v(columns, strip, first):
    degree = len(columns) - 1
    return [[sum(column[q] * line[first + j] for j, column in enumerate(columns))
             for q in range(degree + 1)] for line in strip]


def element_flux(x, y, z, weights):
    """Sum over the powers of y (z_u x_v - z_v x_u), each integrated over the unit square."""
    du, dv = len(x) - 1, len(x[0]) - 1
    jacobian = [[0] * (2 * dv) for _ in range(2 * du)]
    for a in range(du + 1):
        for b in range(dv + 1):
            for c in range(du + 1):
                for d in range(dv + 1):
                    factor = a * d - b * c
                    if factor:
                        jacobian[a + c - 1][b + d - 1] += factor * z[a][b] * x[c][d]
    total = 0
    for b in range(dv + 1):
        in_u = [sum(j * w for j, w in zip(row, weights[b:])) for row in jacobian]
        for a in range(du + 1):
            total += y[a][b] * sum(j * w for j, w in zip(in_u, weights[a:]))
    return total
