"""Prints constants for fmu_src/math/node_tables.c, with 60 digits: collocation at the Gauss-Lobatto nodes,
and the same at the nodes of Radau with `radau`.

    python scripts/tools/make_lobatto.py
    python scripts/tools/make_lobatto.py radau

Nodes: -1, 1 and the roots of P'_{n-1} (Abramowitz and Stegun, 25.4.32); of Radau the roots of P_{n-1} - P_n,
of which 1 is one (25.4.31, mirrored). With l_j the Lagrange polynomials
of the n nodes: `integral[j n + i]` is the integral of l_j from -1 to node i, `monomial[j n + k]` the
coefficient of sigma^k in l_j. Of Radau's nodes `twice[j n + i]` is the integral from -1 to node i of the
integral of l_j.
"""

import sys

import mpmath

POINTS = (4, 8, 12)
RADAU = 12


def nodes(points: int) -> list:
    """The Gauss-Lobatto nodes, ascending."""
    legendre = mpmath.taylor(lambda x: mpmath.legendre(points - 1, x), 0, points - 1)
    slope = [k * legendre[k] for k in range(points - 1, 0, -1)]
    inner = sorted(mpmath.re(root) for root in mpmath.polyroots(slope, maxsteps=500, extraprec=500))
    return [mpmath.mpf(-1), *inner, mpmath.mpf(1)]


def radau_nodes(points: int) -> list:
    """The right Radau nodes, ascending."""
    row = mpmath.taylor(lambda x: mpmath.legendre(points - 1, x) - mpmath.legendre(points, x), 0, points)
    roots = mpmath.polyroots(row[::-1], maxsteps=500, extraprec=500)
    return [*sorted(mpmath.re(root) for root in roots)[:-1], mpmath.mpf(1)]


def lagrange(at: list, j: int) -> list:
    """Coefficients of l_j, lowest degree first."""
    coefficients = [mpmath.mpf(1)]
    for i, node in enumerate(at):
        if i != j:
            shifted = [mpmath.mpf(0), *coefficients]
            scaled = [-node * c for c in coefficients] + [mpmath.mpf(0)]
            coefficients = [(a + b) / (at[j] - node) for a, b in zip(shifted, scaled, strict=True)]
    return coefficients


def integral(coefficients: list, end) -> mpmath.mpf:
    """Of a polynomial from -1 to `end`."""
    return sum(c * (end ** (k + 1) - mpmath.mpf(-1) ** (k + 1)) / (k + 1) for k, c in enumerate(coefficients))


def twice(at: list) -> list:
    """The integrals to the nodes of the integrals of each l_j: rows of j."""
    basis = [lagrange(at, j) for j in range(len(at))]
    once = [[integral(b, x) for x in at] for b in basis]
    return [[sum(row[k] * once[k][i] for k in range(len(at))) for i in range(len(at))] for row in once]


def number(x) -> str:
    """A C literal that reads back as the nearest double."""
    value = float(x)
    return "0.0" if abs(value) < 1e-40 else repr(value)


def table(name: str, rows: list) -> str:
    """A C array, row after row, in lines of four numbers."""
    count = sum(len(row) for row in rows)
    lines = [f"static const double {name}[{count}] = {{"]
    for row in rows:
        for first in range(0, len(row), 4):
            lines.append("    " + ", ".join(number(x) for x in row[first : first + 4]) + ",")
    return "\n".join([*lines, "};\n"])


def tables(at: list) -> str:
    """Those of so many nodes."""
    points = len(at)
    basis = [lagrange(at, j) for j in range(points)]
    return "\n".join(
        [
            table(f"node_{points}", [at]),
            table(f"integral_{points}", [[integral(b, x) for x in at] for b in basis]),
            table(f"monomial_{points}", basis),
        ]
    )


def print_radau() -> None:
    """Prints the file of Radau's nodes."""
    print("/* Written by scripts/tools/make_lobatto.py radau; not to be edited. */")
    print('#include "math/node_tables.h"\n\n/* clang-format off */')
    at = radau_nodes(RADAU)
    print(tables(at).replace(f"_{RADAU}[", f"_radau_{RADAU}["))
    public = "const double radau_twice[RADAU_POINTS * RADAU_POINTS]"
    print(table("", twice(at)).replace(f"static const double [{RADAU * RADAU}]", public))
    rows = ", ".join(f"{name}_radau_{RADAU}" for name in ("node", "integral", "monomial"))
    print(f"const struct lobatto radau = {{{RADAU}, {rows}}};\n/* clang-format on */")


def print_lobatto() -> None:
    """Prints the file of Lobatto's nodes."""
    print("/* Written by scripts/tools/make_lobatto.py; not to be edited. */")
    print('#include "math/node_tables.h"\n\n/* clang-format off */')
    for points in POINTS:
        print(tables(nodes(points)))
    print("const struct lobatto lobatto[LOBATTO_SIZES] = {")
    for points in POINTS:
        print(f"    {{{points}, node_{points}, integral_{points}, monomial_{points}}},")
    print("};\n/* clang-format on */")


def main() -> None:
    """Prints one of the two files."""
    mpmath.mp.dps = 60
    if sys.argv[1:] == ["radau"]:
        print_radau()
    else:
        print_lobatto()


if __name__ == "__main__":
    main()
