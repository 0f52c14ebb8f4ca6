"""Prints fmu_src/math/node_tables.c, with 60 digits: constants of collocation at Lobatto's and Radau's nodes.

    python scripts/tools/make_nodes.py > fmu_src/math/node_tables.c

Lobatto's nodes of [-1, 1] are -1, 1 and the roots of P'_{n-1} (Abramowitz and Stegun, 25.4.32). Radau's are
the roots of P_{n-1} - P_n, of which 1 is one (25.4.31, mirrored). With l_j the Lagrange polynomials of the n
nodes:

    integral     [j n + i]: the integral of l_j from -1 to node i
    monomial     [j n + k]: the coefficient of sigma^k in l_j

Simplified Newton iterations for Radau IIA of s stages use the right Radau nodes c of [0, 1]. With A_ij the
integral of l_j from 0 to c_i:

    integral     A, row by row
    inverse      A^-1, row by row
    eigenvalue   those of A^-1 with positive imaginary part: all are complex where s is even; (re, im) each
    into         the rows of T^-1 that belong to them, A^-1 = T diag T^-1; all re of a row, then all im
    back         twice the columns of T: a real vector is the real part of their sum; by rows, (re, -im) each
    chebyshev    from values at the nodes to the s + 1 Chebyshev coefficients of the polynomial through them
                 and through zero at 0; by coefficients
    bernstein    from values at 0 and at the nodes to the s + 1 Bernstein coefficients; by places
"""

import textwrap

import mpmath

LOBATTO = (4, 8, 12)
RADAU = 12
STAGES = (4, 8, 12)


def lobatto_nodes(points: int) -> list:
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


def integral(coefficients: list, start, end) -> mpmath.mpf:
    """Of a polynomial between two places."""
    return sum(c * (end ** (k + 1) - start ** (k + 1)) / (k + 1) for k, c in enumerate(coefficients))


def number(x) -> str:
    """A C literal that reads back as the nearest double."""
    value = float(x)
    return "0.0" if abs(value) < 1e-40 else repr(value)


def eigenvectors(inverse) -> tuple[list, list, list]:
    """Eigenvalues of positive imaginary part, by that; their rows of T^-1, and twice the columns of T."""
    values, columns = mpmath.eig(inverse)
    rows = columns**-1
    upper = sorted((k for k in range(len(values)) if mpmath.im(values[k]) > 0), key=lambda k: mpmath.im(values[k]))
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
    """A C array, row after row, in lines of up to 110 columns."""
    flat = [number(x) for row in rows for x in row]
    lines = [f"static const double {name}[{len(flat)}] = {{"]
    lines += textwrap.wrap(", ".join(flat) + ",", 110, initial_indent="    ", subsequent_indent="    ")
    return "\n".join([*lines, "};\n"])


def stage_tables(stages: int) -> str:
    """The tables of a number of stages, and the struct of them."""
    at = [(x + 1) / 2 for x in radau_nodes(stages)]
    basis = [lagrange(at, j) for j in range(stages)]
    a = mpmath.matrix([[integral(b, 0, x) for b in basis] for x in at])
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
            *(row for x in back for row in ([mpmath.re(y) for y in x], [-mpmath.im(y) for y in x])), strict=True
        ),
        "chebyshev": zip(*(to_chebyshev(b) for b in through_zero[1:]), strict=True),
        "bernstein": [to_bernstein(b) for b in through_zero],
    }
    arrays = [table(f"radau_{name}_{stages}", rows) for name, rows in named.items()]
    members = ", ".join(f"\n    radau_{name}_{stages}" for name in named).replace(", ", ",")
    struct = f"const struct radau_stages radau_stages_{stages} = {{\n    {stages},{members}}};\n"
    return "\n".join([*arrays, struct])


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


def main() -> None:
    """Prints the file."""
    mpmath.mp.dps = 60
    print("/* Written by scripts/tools/make_nodes.py; not to be edited. */")
    print('#include "math/node_tables.h"\n\n/* clang-format off */')
    for points in LOBATTO:
        print(node_tables(str(points), lobatto_nodes(points)))
    print("const struct lobatto lobatto[LOBATTO_SIZES] = {")
    for points in LOBATTO:
        print(f"    {members(str(points), points)},")
    print("};\n")
    print(node_tables(f"radau_{RADAU}", radau_nodes(RADAU)))
    print(f"const struct lobatto radau = {members(f'radau_{RADAU}', RADAU)};\n")
    print("\n".join(stage_tables(stages) for stages in STAGES), end="")
    print("/* clang-format on */")


if __name__ == "__main__":
    main()
