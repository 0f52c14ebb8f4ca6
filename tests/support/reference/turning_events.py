"""Where a function of time passes zero, between samples and at extremes between them; for turning_run.py."""

from scipy.optimize import brentq, minimize_scalar

FALLS, RISES, BOTH = -1, 1, 0


def crossing(function, times_, of, direction):
    """First time at which the function passes zero in the direction, or None."""
    if direction == BOTH:
        found = [crossing(function, times_, of, one) for one in (FALLS, RISES)]
        return min((t for t in found if t is not None), default=None)
    for i in range(len(of) - 1):
        a, b = direction * of[i], direction * of[i + 1]
        if a < 0 <= b or (a == 0 and i == 0 and b > 0):
            return place(function, times_[i], times_[i + 1])
        top = extreme(function, times_, of, i, direction)
        if top is not None:
            return place(function, times_[i], top)
    return None


def extreme(function, times_, of, i, direction):
    """A time between samples i and i + 1 past the crossing, of a function that is back at the next sample."""
    around = [direction * of[j] for j in range(max(i - 1, 0), min(i + 3, len(of)))]
    if (
        max(direction * of[i], direction * of[i + 1]) >= 0
        or max(around) < max(around[0], around[-1]) + 1e-300
    ):
        return None
    spread = max(around) - min(around)
    if -max(around) > spread:  # a smooth function does not reach zero from there
        return None
    top = minimize_scalar(
        lambda t: -direction * function(t), bounds=(times_[i], times_[i + 1]), method="bounded",
        options={"xatol": 1e-9 * (times_[i + 1] - times_[i])},
    )  # fmt: skip
    return top.x if -top.fun > 0 else None


def place(function, low, high):
    a, b = function(low), function(high)
    if a * b >= 0:
        return low if abs(a) < abs(b) else high
    return brentq(function, low, high, xtol=1e-300, rtol=1e-15)
