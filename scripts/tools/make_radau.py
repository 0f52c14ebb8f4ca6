"""Prints constants for fmu_src/math/node_tables.c, with 60 digits: simplified Newton iterations
for Radau IIA.

    python scripts/tools/make_radau.py 4 8
    python scripts/tools/make_radau.py 12

Of s stages at the right Radau nodes c of [0, 1] (make_lobatto.py), A_ij the integral of l_j from 0 to c_i:

    integral     A, row by row
    inverse      A^-1, row by row
    eigenvalue   those of A^-1 with positive imaginary part: all are complex where s is even; (re, im) each
    into         the rows of T^-1 that belong to them, A^-1 = T diag T^-1; all re of a row, then all im
    back         twice the columns of T: a real vector is the real part of their sum; by rows, (re, -im) each
    chebyshev    from values at the nodes to the s + 1 Chebyshev coefficients of the polynomial through them
                 and through zero at 0; by coefficients
    bernstein    from values at 0 and at the nodes to the s + 1 Bernstein coefficients; by places
"""

import sys

import mpmath
from make_lobatto import lagrange, number, radau_nodes


def integral(coefficients: list, end) -> mpmath.mpf:
    """Of a polynomial from 0 to `end`."""
    return sum(c * end ** (k + 1) / (k + 1) for k, c in enumerate(coefficients))


def eigenvectors(inverse) -> tuple[list, list, list]:
    """Eigenvalues of positive imaginary part, by that; their rows of T^-1, and twice the columns of T."""
    values, columns = mpmath.eig(inverse)
    rows = columns**-1
    upper = sorted(
        (k for k in range(len(values)) if mpmath.im(values[k]) > 0), key=lambda k: mpmath.im(values[k])
    )
    size = range(len(values))
    into, back = [], []
    for k in upper:
        scale = max((columns[i, k] for i in size), key=abs)
        into.append([rows[k, j] * scale for j in size])
        back.append([2 * columns[i, k] / scale for i in size])
    return [values[k] for k in upper], into, back


def split(rows: list) -> list:
    """Each row's real parts, then its imaginary ones."""
    return [[*(mpmath.re(x) for x in row), *(mpmath.im(x) for x in row)] for row in rows]


def to_chebyshev(monomials: list) -> list:
    """Coefficients of T_k(2 s - 1) from those of s^k."""
    degree = len(monomials) - 1
    angles = [mpmath.pi * (i + mpmath.mpf(1) / 2) / (degree + 1) for i in range(degree + 1)]
    at = [mpmath.polyval(monomials[::-1], (mpmath.cos(a) + 1) / 2) for a in angles]
    row = []
    for k in range(degree + 1):
        total = sum(value * mpmath.cos(k * a) for value, a in zip(at, angles, strict=True))
        row.append(total * (1 if k == 0 else 2) / (degree + 1))
    return row


def to_bernstein(monomials: list) -> list:
    """Bernstein coefficients from those of s^k."""
    degree = len(monomials) - 1
    return [
        sum(mpmath.binomial(i, k) / mpmath.binomial(degree, k) * monomials[k] for k in range(i + 1))
        for i in range(degree + 1)
    ]


def table(name: str, rows: list) -> str:
    """A C array, row after row, in lines of four numbers."""
    flat = [x for row in rows for x in row]
    lines = [f"static const double {name}[{len(flat)}] = {{"]
    for first in range(0, len(flat), 4):
        lines.append("    " + ", ".join(number(x) for x in flat[first : first + 4]) + ",")
    return "\n".join([*lines, "};\n"])


def tables(stages: int) -> str:
    """Those of so many stages, and the struct of them."""
    at = [(x + 1) / 2 for x in radau_nodes(stages)]
    basis = [lagrange(at, j) for j in range(stages)]
    a = mpmath.matrix([[integral(b, x) for b in basis] for x in at])
    inverse = a**-1
    values, into, back = eigenvectors(inverse)
    places = [mpmath.mpf(0), *at]
    through_zero = [lagrange(places, j) for j in range(stages + 1)]
    named = {
        "node": [at],
        "integral": a.tolist(),
        "inverse": inverse.tolist(),
        "eigenvalue": [[mpmath.re(x), mpmath.im(x)] for x in values],
        "into": split(into),
        "back": zip(
            *(row for x in back for row in ([mpmath.re(y) for y in x], [-mpmath.im(y) for y in x])),
            strict=True,
        ),
        "chebyshev": zip(*(to_chebyshev(b) for b in through_zero[1:]), strict=True),
        "bernstein": [to_bernstein(b) for b in through_zero],
    }
    arrays = [table(f"radau_{name}_{stages}", rows) for name, rows in named.items()]
    members = ", ".join(f"\n    radau_{name}_{stages}" for name in named).replace(", ", ",")
    struct = f"const struct radau_stages radau_stages_{stages} = {{\n    {stages},{members}}};\n"
    return "\n".join([*arrays, struct])


def main() -> None:
    """Prints one file."""
    mpmath.mp.dps = 60
    print("/* Written by scripts/tools/make_radau.py; not to be edited. */")
    print('#include "math/node_tables.h"\n\n/* clang-format off */')
    print("\n".join(tables(int(stages)) for stages in sys.argv[1:]), end="")
    print("/* clang-format on */")


if __name__ == "__main__":
    main()
