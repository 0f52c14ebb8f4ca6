"""Writes tests/unit/rotor_references.h: torque-free symmetric tops after many turns, 80 digits by mpmath.

PYTHONPATH=tests:scripts python -m support.reference.make_rotor_references

The orientation is that of matrices, so that nothing of it is shared with the code under test:
R(t) = Rot(L/|L|, |L| t/I_1) R(0) Rot(e_3, (1 - I_3/I_1) omega_3 t).
"""

import random
from pathlib import Path

from mpmath import cos, diag, matrix, mp, mpf, pi, sin, sqrt

FILE = Path(__file__).parents[2] / "unit" / "rotor_references.h"

mp.dps = 80

# transverse and axial inertia: needle, homogeneous cylinders, nearly a sphere, sphere, disc, ring
INERTIAS = [(1.0, 1e-6), (0.3, 0.07), (0.1 + 1e-13, 0.1), (0.4, 0.4), (0.25, 0.5), (1e-3, 2e-3 - 1e-9)]
# turns of the faster of both rotations
TURNS = [1e-18, 1e-6, 0.37, 1e3, 1e6, 1e12, 1e15]


def turned(axis, angle):
    """The matrix of a rotation about a unit vector."""
    x, y, z = axis
    cross = matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return diag([1, 1, 1]) + sin(angle) * cross + (1 - cos(angle)) * cross * cross


def oriented(q):
    """The matrix of a quaternion of any length."""
    w, x, y, z = (mpf(a) for a in q)
    size = sqrt(w * w + x * x + y * y + z * z)
    if x == y == z == 0:
        return diag([1, 1, 1])
    across = sqrt(x * x + y * y + z * z)
    return turned([x / across, y / across, z / across], 2 * mp.atan2(across / size, w / size))


def case(rng, transverse, axial, turns):
    """One line of the table: start and end."""
    q = [rng.gauss(0, 1) for _ in range(4)]
    size = sum(a * a for a in q) ** 0.5
    q = [a / size for a in q]
    scale = 10 ** rng.uniform(-3, 3)
    omega = [scale * rng.gauss(0, 1) for _ in range(3)]
    start = oriented(q)
    axis = start[:, 2]
    w = matrix([mpf(a) for a in omega])
    along = (axis.T * w)[0]
    ratio = mpf(axial) / mpf(transverse)
    momentum = w + (ratio - 1) * along * axis
    rate = sqrt((momentum.T * momentum)[0])
    time = float(turns * 2 * pi / max(rate, abs((1 - ratio) * along)))
    direction = [a / rate for a in momentum]
    by_momentum = turned(direction, rate * mpf(time))
    end = by_momentum * start * turned([0, 0, 1], (1 - ratio) * along * mpf(time))
    columns = [float(end[i, j]) for j in range(3) for i in range(3)]
    rates = [float(a) for a in by_momentum * w]
    numbers = [transverse, axial, time, *q, *omega, *columns, *rates]
    words = [repr(float(a)) for a in numbers]
    rows = [", ".join(words[i : i + 4]) for i in range(0, len(words), 4)]
    return "    {" + ",\n     ".join(rows) + "},\n"


def main():
    rng = random.Random(15)
    lines = [case(rng, *inertia, turns) for inertia in INERTIAS for turns in TURNS]
    FILE.write_text(
        "/* Made by tests/support/reference/make_rotor_references.py: torque-free tops with 80 digits.\n"
        " * I_1, I_3, time, orientation w x y z and angular velocity at the start; the axes of the body's\n"
        " * frame and the angular velocity at the end. */\n"
        "#ifndef ROTOR_REFERENCES_H\n#define ROTOR_REFERENCES_H\n\n"
        "enum { ROTOR_NUMBERS = 22 };\n\n"
        "/* clang-format off */\n"
        "static const double rotor_references[][ROTOR_NUMBERS] = {\n" + "".join(lines) + "};\n"
        "/* clang-format on */\n\n#endif\n",
        encoding="utf-8",
    )


if __name__ == "__main__":
    main()
