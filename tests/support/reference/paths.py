"""Given motions of the reference: where an importer puts a body, as polynomials of time.

The place of a prescribed body is its displacement input with the derivatives given for it. Where none are
given, the displacement follows the velocity input, unless every body of the scene is prescribed: then it
stays where it was put. Its velocity is the velocity input with its own derivatives,
whatever the displacement does: the two disagree where the importer makes them.
"""


def shifted(coefficients, time):
    """The polynomial's coefficients about `time`, by Horner's scheme."""
    row = list(coefficients)
    for done in range(len(row) - 1):
        for i in range(len(row) - 2, done - 1, -1):
            row[i] = row[i] + time * row[i + 1]
    return row


class GivenPath:
    """Rows of coefficients in time: three of the position and three of the velocity."""

    def __init__(self, values, body, number):
        def rows(name, orders):
            given = [values[name], *values.get(f"{name}.derivatives", [])]
            given += [[0.0] * 3] * (orders - len(given))
            return [[number(x) for x in row] for row in zip(*given, strict=True)]

        place = f"{body}.prescribed_displacement"
        speed = rows(f"{body}.prescribed_velocity", 3)
        self.velocity = [[v, a, j / 2] for v, a, j in speed]
        center = [number(x) for x in values[f"{body}.center"]]
        alone = all(values[f"{name}.motion"] == "prescribed" for name in ("source", "destination"))
        moved = rows(place, 3)
        if f"{place}.derivatives" in values or alone:
            self.position = [[c + u, v, a / 2, number(0)] for c, (u, v, a) in zip(center, moved, strict=True)]
        else:
            self.position = [
                [c + u[0], v, a / 2, j / 6] for c, u, (v, a, j) in zip(center, moved, speed, strict=True)
            ]

    def at(self, time):
        return tuple([shifted(row, time) for row in rows] for rows in (self.position, self.velocity))
