"""Truncated power series of an ordinary differential equation, and the first root of one: tools of
integrator.py.

A Tape is a list of rows of coefficients with the rule that makes coefficient k of each from what stands
before it; `grow` runs it order by order. The numbers may be float or decimal.Decimal.
"""

import math
from decimal import Decimal, getcontext
from functools import lru_cache
from itertools import pairwise
from operator import mul

getcontext().prec = 40


def square_root(value):
    return value.sqrt() if isinstance(value, Decimal) else math.sqrt(value)


class Tape:
    def __init__(self, number):
        self.number = number
        self.zero = number(0)
        self.rows = []
        self.states = []

    def row(self, rule):
        coefficients = []
        self.rows.append((coefficients, rule))
        return coefficients

    def state(self, value):
        """A row that starts with its value and goes on by integration, see `integrate`."""
        return [value]

    def integrate(self, state, rate):
        self.states.append((state, rate))

    def polynomial(self, coefficients):
        return self.row(lambda k: coefficients[k] if k < len(coefficients) else self.zero)

    def linear(self, terms, constant=None):
        """Sum of factor * row over `terms`, plus a constant."""

        def rule(k):
            total = constant if k == 0 and constant is not None else self.zero
            for factor, row in terms:
                total = total + factor * row[k]
            return total

        return self.row(rule)

    def dot(self, first, second):
        """Sum of the products of two lists of rows."""
        pairs = list(zip(first, second, strict=True))

        def rule(k):
            total = self.zero
            for a, b in pairs:
                total = total + sum(map(mul, a[: k + 1], b[k::-1]))
            return total

        return self.row(rule)

    def product(self, a, b):
        return self.dot([a], [b])

    def root(self, square):
        result = []

        def rule(k):
            if k == 0:
                return square_root(square[0])
            middle = sum(map(mul, result[1:k], result[k - 1 : 0 : -1]))
            return (square[k] - middle) / (2 * result[0])

        self.rows.append((result, rule))
        return result

    def quotient(self, a, b):
        result = []

        def rule(k):
            known = sum(map(mul, b[1 : k + 1], result[k - 1 :: -1])) if k else self.zero
            return (a[k] - known) / b[0]

        self.rows.append((result, rule))
        return result

    def grow(self, order):
        for k in range(order):
            for row, rule in self.rows:
                row.append(rule(k))
            for state, rate in self.states:
                state.append(rate[k] / (k + 1))


def evaluate(row, step):
    total = row[-1]
    for coefficient in row[-2::-1]:
        total = total * step + coefficient
    return total


@lru_cache
def bernstein_matrix(degree, number):
    """Row i: what turns the coefficients of t^k on [0, 1] into Bernstein coefficient i."""
    return [
        [number(math.comb(i, k)) / number(math.comb(degree, k)) for k in range(i + 1)]
        for i in range(degree + 1)
    ]


def split(points):
    """de Casteljau at 1/2: Bernstein coefficients of the left and the right half."""
    left, right = [points[0]], [points[-1]]
    while len(points) > 1:
        points = [(a + b) / 2 for a, b in pairwise(points)]
        left.append(points[0])
        right.append(points[-1])
    return left, right[::-1]


def first_crossing(points, start, width, depth):
    """First place in [start, start + width] where the polynomial goes below zero; None when it stays
    above."""
    if all(p >= 0 for p in points):
        return None
    if points[0] < 0 or depth == 0:
        return start
    left, right = split(points)
    found = first_crossing(left, start, width / 2, depth - 1)
    return found if found is not None else first_crossing(right, start + width / 2, width / 2, depth - 1)


def first_root(row, span, number, fresh=False):
    """First time in (0, span] where the series, positive at first, goes below zero; None if it does not.

    `fresh`: the series starts exactly on its root; the factor t is divided out instead of trusting the
    rounding of row[0]."""
    scaled, power = [], number(1)
    for coefficient in row:
        scaled.append(coefficient * power)
        power = power * span
    if fresh:
        scaled = scaled[1:]
        noise = max(map(abs, scaled)) * number(10) ** (-14)
        while len(scaled) > 1 and scaled[0] <= 0 and -scaled[0] < noise:
            scaled = scaled[1:]
    if scaled[0] > sum(map(abs, scaled[1:])):
        return None
    degree = len(scaled) - 1
    matrix = bernstein_matrix(degree, number)
    points = [sum(map(mul, weights, scaled)) for weights in matrix]
    bits = 60 if number is float else 120
    place = first_crossing(points, number(0), number(1), bits)
    return None if place is None else polished(scaled, place, number) * span


def highest(row, span, number, known):
    """The larger of `known` and the largest value of the series on [0, span], to 14 digits: Bernstein
    coefficients bound it, and halves that cannot hold more than is known are left alone."""
    scaled, power = [], number(1)
    for coefficient in row:
        scaled.append(coefficient * power)
        power = power * span
    open_parts = [[sum(map(mul, weights, scaled)) for weights in bernstein_matrix(len(row) - 1, number)]]
    best = max(known, open_parts[0][0], open_parts[0][-1])
    slack = max(map(abs, open_parts[0])) * number(10) ** (-14)
    while open_parts:
        points = open_parts.pop()
        if max(points) > best + slack:
            left, right = split(points)
            best = max(best, right[0])
            open_parts += [left, right]
    return best


def polished(scaled, place, number):
    """Newton on a root known to rounding of the bisection; refused where the root is nearly double."""
    slopes = [k * c for k, c in enumerate(scaled)][1:]
    for _ in range(3):
        slope = evaluate(slopes, place) if slopes else number(0)
        if slope == 0:
            break
        better = place - evaluate(scaled, place) / slope
        if abs(better - place) > number(10) ** (-9):
            break
        place = max(better, number(0))
    return place
