"""Writes node_tables.c, with 60 digits: constants of collocation at Lobatto's and Radau's nodes.

    python make_nodes.py OUTPUT

Lobatto's nodes of [-1, 1] are -1, 1 and the roots of P'_{n-1} (Abramowitz and Stegun, 25.4.32). Radau's are
the roots of P_{n-1} - P_n, of which 1 is one (25.4.31, mirrored). With l_j the Lagrange polynomials of the n
nodes:

    integral     [j n + i]: the integral of l_j from -1 to node i
    monomial     [j n + k]: the coefficient of sigma^k in l_j

Radau IIA of s stages has the right Radau nodes c of [0, 1]. With A_ij the
integral of l_j from 0 to c_i:

    integral     A, row by row
    inverse      A^-1, row by row
    once, twice  A and A^2, column by column
    chebyshev    from values at the nodes to the s + 1 Chebyshev coefficients of the polynomial through them
                 and through zero at 0; by coefficients
    bernstein    from values at 0 and at the nodes to the s + 1 Bernstein coefficients; by places

The tables `touch` and `release` are for steps whose time is a function of sigma (math/radau_step.h): A_ij is
then the integral of l_j times the pace dt/dsigma at c_j, and `node` holds the times at the nodes.
"""

import decimal
import math
import operator
import sys
import textwrap
from decimal import Decimal
from pathlib import Path

LOBATTO = (8, 12)
RADAU = 12
STAGES = (4, 8, 12)
REST = Decimal(1) / 1024  # RADAU_REST of node_tables.h
DIGITS = 100  # of the arithmetic: roots of twelfth degree and products with inverses lose some forty
ROOT_DIGITS = 80  # of roots


class Complex:
    """A complex number of decimals."""

    def __init__(self, re, im=0):
        self.re, self.im = Decimal(re), Decimal(im)

    def __add__(self, other):
        return Complex(self.re + other.re, self.im + other.im)

    def __sub__(self, other):
        return Complex(self.re - other.re, self.im - other.im)

    def __mul__(self, other):
        return Complex(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)

    def __truediv__(self, other):
        square = other.square()
        both = self * Complex(other.re, -other.im)
        return Complex(both.re / square, both.im / square)

    def square(self):
        """|z|^2"""
        return self.re * self.re + self.im * self.im


def roots(polynomial: list) -> list:
    """All roots, by the iterations of Weierstrass; coefficients of lowest degree first."""
    degree = len(polynomial) - 1
    found = [Complex(1)]
    while len(found) < degree:
        found.append(found[-1] * Complex("0.4", "0.9"))
    change = 1
    while change > Decimal(10) ** (-2 * ROOT_DIGITS):
        change = 0
        for i, root in enumerate(found):
            value = Complex(0)
            for coefficient in reversed(polynomial):
                value = value * root + Complex(coefficient / polynomial[-1])
            for other in found[:i] + found[i + 1 :]:
                value = value / (root - other)
            found[i] = root - value
            change = max(change, value.square() / found[i].square()) if found[i].square() else change
    return found


def legendre(degree: int) -> list:
    """Coefficients of P_n, lowest degree first."""
    row = [Decimal(0)] * (degree + 1)
    for k in range(degree // 2 + 1):
        number = (-1) ** k * math.comb(degree, k) * math.comb(2 * degree - 2 * k, degree)
        row[degree - 2 * k] = Decimal(number) / 2**degree
    return row


def lobatto_nodes(points: int) -> list:
    """The Gauss-Lobatto nodes, ascending."""
    slope = [k * a for k, a in enumerate(legendre(points - 1))][1:]
    return [Decimal(-1), *sorted(root.re for root in roots(slope)), Decimal(1)]


def radau_nodes(points: int) -> list:
    """The right Radau nodes, ascending."""
    row = [a - b for a, b in zip([*legendre(points - 1), 0], legendre(points), strict=True)]
    return [*sorted(root.re for root in roots(row))[:-1], Decimal(1)]


def lagrange(at: list, j: int) -> list:
    """Coefficients of l_j, lowest degree first."""
    coefficients = [Decimal(1)]
    for i, node in enumerate(at):
        if i != j:
            shifted = [Decimal(0), *coefficients]
            scaled = [-node * c for c in coefficients] + [Decimal(0)]
            coefficients = [(a + b) / (at[j] - node) for a, b in zip(shifted, scaled, strict=True)]
    return coefficients


def integral(coefficients: list, start, end) -> Decimal:
    """Of a polynomial between two places."""
    return sum(c * (end ** (k + 1) - start ** (k + 1)) / (k + 1) for k, c in enumerate(coefficients))


def number(x) -> str:
    """A C literal that reads back as the nearest double."""
    value = float(x)
    return "0.0" if abs(value) < 1e-40 else repr(value)


def to_chebyshev(monomials: list) -> list:
    """Coefficients of T_k(2 s - 1) from those of s^k: by Horner's scheme, with s T_k = (T_{k-1} + 2 T_k +
    T_{k+1})/4 and s T_0 = (T_0 + T_1)/2."""
    row = [Decimal(0)] * (len(monomials) + 1)
    for coefficient in reversed(monomials):
        grown = [a / 2 for a in row]
        for k, a in enumerate(row[:-1]):
            grown[k + 1] += a / 4 if k else a / 2
            grown[max(k - 1, 0)] += a / 4 if k else 0
        row = [grown[0] + coefficient, *grown[1:]]
    return row[:-1]


def to_bernstein(monomials: list) -> list:
    """Bernstein coefficients from those of s^k."""
    degree = len(monomials) - 1
    return [
        sum(math.comb(i, k) * monomials[k] / math.comb(degree, k) for k in range(i + 1))
        for i in range(degree + 1)
    ]


def table(name: str, rows: list) -> str:
    """A C array, row after row, in lines of up to 110 columns."""
    flat = [number(x) for row in rows for x in row]
    lines = [f"static const double {name}[{len(flat)}] = {{"]
    lines += textwrap.wrap(", ".join(flat) + ",", 110, initial_indent="    ", subsequent_indent="    ")
    return "\n".join([*lines, "};\n"])


def inverted(matrix: list) -> list:
    """The inverse, by rows."""
    size = len(matrix)
    rows = [[*row, *(Decimal(i == j) for j in range(size))] for i, row in enumerate(matrix)]
    for k in range(size):
        pivot = max(range(k, size), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [x / rows[k][k] for x in rows[k]]
        for i in range(size):
            if i != k:
                rows[i] = [x - rows[i][k] * y for x, y in zip(rows[i], rows[k], strict=True)]
    return [row[size:] for row in rows]


def even(x: Decimal) -> tuple[Decimal, Decimal]:
    """Time at a place of the step, and its derivative."""
    return x, Decimal(1)


def from_touch(x: Decimal) -> tuple[Decimal, Decimal]:
    return x * x, 2 * x


def to_release(x: Decimal) -> tuple[Decimal, Decimal]:
    root = REST.sqrt()
    apart = (1 + REST).sqrt() - root
    left = root + (1 - x) * apart
    return 1 + REST - left * left, 2 * left * apart


PACES = {"touch": from_touch, "release": to_release}


def stage_tables(stages: int, pace: str = "") -> str:
    """The tables of a number of stages, and the struct of them; of another pace only what depends on it."""
    at = [(x + 1) / 2 for x in radau_nodes(stages)]
    basis = [lagrange(at, j) for j in range(stages)]
    times, paces = zip(*map(PACES.get(pace, even), at), strict=True)
    a = [[integral(b, 0, x) * faster for b, faster in zip(basis, paces, strict=True)] for x in at]
    inverse = inverted(a)
    squared = [[sum(map(operator.mul, row, column)) for column in zip(*a, strict=True)] for row in a]
    places = [Decimal(0), *at]
    through_zero = [lagrange(places, j) for j in range(stages + 1)]
    named = {
        "node": [times],
        "integral": a,
        "inverse": inverse,
        "once": zip(*a, strict=True),
        "twice": zip(*squared, strict=True),
    }
    alike = {
        "chebyshev": zip(*(to_chebyshev(b) for b in through_zero[1:]), strict=True),
        "bernstein": [to_bernstein(b) for b in through_zero],
    }
    own = pace or stages
    arrays = [table(f"radau_{name}_{own}", rows) for name, rows in named.items()]
    arrays += [table(f"radau_{name}_{stages}", rows) for name, rows in alike.items() if not pace]
    members = [f"radau_{name}_{own}" for name in named] + [
        f"radau_{name}_{stages}" for name in ("node", *alike)
    ]
    kind = {"touch": "RADAU_FROM_TOUCH", "release": "RADAU_TO_RELEASE"}.get(pace, "RADAU_EVEN")
    struct = f"const struct radau_stages radau_stages_{own} = {{\n    {stages}, {kind},\n    "
    return "\n".join([*arrays, struct + ",\n    ".join(members) + "};\n"])


def node_tables(name: str, at: list) -> str:
    """The tables of some nodes of [-1, 1]."""
    basis = [lagrange(at, j) for j in range(len(at))]
    return "\n".join(
        [
            table(f"node_{name}", [at]),
            table(f"integral_{name}", [[integral(b, -1, x) for x in at] for b in basis]),
            table(f"monomial_{name}", basis),
        ]
    )


def members(name: str, points: int) -> str:
    """The values of the struct of some nodes."""
    return f"{{{points}, node_{name}, integral_{name}, monomial_{name}}}"


def text() -> str:
    """The file."""
    decimal.getcontext().prec = DIGITS
    return "\n".join(
        [
            "/* Written by cmake/make_nodes.py, which says what each array holds. */",
            '#include "math/node_tables.h"\n\n/* clang-format off */',
            *(node_tables(str(points), lobatto_nodes(points)) for points in LOBATTO),
            "const struct lobatto lobatto[LOBATTO_SIZES] = {",
            *(f"    {members(str(points), points)}," for points in LOBATTO),
            "};\n",
            *(stage_tables(stages) for stages in STAGES),
            *(stage_tables(RADAU, pace) for pace in PACES),
            "/* clang-format on */",
        ]
    )


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(f"{text()}\n", encoding="utf-8")
