"""An independent reference for contacts by either law, with restitution: the equations of motion in world
coordinates, as DESIGN sections 1 and 6 write them, by extrapolation (Gragg, Bulirsch, Stoer).

Nothing is made of what is known about the contact: time is the variable, steps shrink by error control
where the force is not smooth, and an event is the root of its function in the length of the last step."""

from typing import NamedTuple

import mpmath
import numpy as np

from support.reference.kept import kept

LONG = np.longdouble
COLUMNS = 8  # of the extrapolation: order 16
TOLERANCE = LONG("1e-15")  # of a step, relative to sizes and speeds
LANDED = LONG("1e-18")  # of an event, relative to the step
APART, FULL, SPRING, CLIPPED = "apart", "full", "spring", "clipped"


class HertzPair(NamedTuple):
    """One ball and its counterpart; a mass of infinity moves as it is given."""

    stiffness: float  # k_h, or p_n
    chi: float  # or p_nv
    dashpot: str
    reach: float  # d at g = 0
    side: int  # +1 outside, -1 inside
    masses: tuple
    gravity: tuple = (0.0, 0.0, 0.0)
    axis: tuple | None = None  # of a cylinder, unit length
    plane: tuple | None = None  # the outward normal of a plane, unit length
    ends: tuple | None = None  # r_d and L/2 of a capped cylinder; d is then the distance from that solid
    linear: bool = False
    damped: float | None = None  # chi times the speed of each onset, where chi follows from that
    given: tuple = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))  # accelerations of what does not move freely

    def across(self, c):
        return c if self.axis is None else c - (c @ self.axis) * self.axis

    def gap_and_rate(self, state):
        if self.ends is not None:
            return self.gap_of_solid(state)
        c, w = self.across(state[3:6] - state[0:3]), self.across(state[9:12] - state[6:9])
        if self.plane is not None:
            return -(c @ self.plane) - self.reach, -(w @ self.plane), -self.plane
        d = np.sqrt(c @ c)
        n = c / d
        return self.side * (d - self.reach), self.side * (n @ w), n

    def gap_of_solid(self, state):
        """Of a capped cylinder, which is a box in the half-plane of rho and z"""
        c, w = state[3:6] - state[0:3], state[9:12] - state[6:9]
        z, across = -(c @ self.axis), -self.across(c)
        rho = np.sqrt(across @ across)
        dr, dz = rho - self.ends[0], abs(z) - self.ends[1]
        outward, up = across / (rho if rho > 0 else LONG(1)), np.copysign(LONG(1), z) * self.axis
        if dr > 0 and dz > 0:
            d = np.sqrt(dr * dr + dz * dz)
            n = -(dr * outward + dz * up) / d
        else:
            d, n = (dr, -outward) if dr >= dz else (dz, -up)
        return d - self.reach, n @ w, n

    def force(self, gap, rate, branch):
        depth = max(-gap, LONG(0))
        chi = self.chi if branch == FULL else LONG(0)
        if branch in (APART, CLIPPED):
            return LONG(0)
        if self.linear:
            return self.stiffness * depth - chi * rate
        return self.stiffness * depth * np.sqrt(depth) * (1 - chi * rate)

    def stored(self, gap):
        depth = max(-gap, LONG(0))
        if self.linear:
            return self.stiffness * depth * depth / 2
        return LONG("0.4") * self.stiffness * depth * depth * np.sqrt(depth)

    def slope(self, state, branch):
        """Returns positions of both bodies, their velocities, dissipated energy."""
        gap, rate, n = self.gap_and_rate(state)
        force = self.force(gap, rate, branch)
        spring = self.force(gap, LONG(0), SPRING)
        out = np.empty(13, LONG)
        out[0:6] = state[6:12]
        for i, sign in ((0, -self.side), (1, self.side)):
            mass = self.masses[i]
            pull = self.gravity + (sign * force / mass) * n
            out[6 + 3 * i : 9 + 3 * i] = pull if np.isfinite(mass) else self.given[i]
        out[12] = -(force - spring) * rate if branch != APART else 0
        return out

    def margin(self, state, branch):
        """Falls through zero where the branch ends."""
        gap, rate, _ = self.gap_and_rate(state)
        if branch == APART:
            return gap
        if self.chi == 0 or self.dashpot == "unclamped":
            return -gap
        if self.dashpot == "approach_only":
            law = -rate if branch == FULL else rate
        else:
            formula = -self.stiffness * gap - self.chi * rate if self.linear else 1 - self.chi * rate
            law = formula if branch == FULL else -formula
        return (-gap, law)

    def onset(self, state):
        """Returns the pair with the damping of a contact that begins. Its speed is that of the touch, or of
        motion and stored energy, or, where that is slower, the fastest to which the load alone presses a body
        at rest (v^2 = 6/5 a (a m/k)^(2/3))."""
        if self.damped is None:
            return self
        gap, rate, n = self.gap_and_rate(state)
        per_mass = sum(1 / mass for mass in self.masses)
        across = self.across(state[9:12] - state[6:9])
        turning = np.zeros(3, LONG)
        if self.plane is None:
            d = self.side * gap + self.reach
            turning = n * ((across @ across - (across @ n) ** 2) / d)
        pulls = [self.gravity if np.isfinite(m) else g for m, g in zip(self.masses, self.given, strict=True)]
        load = max(-self.side * (n @ (pulls[1] - pulls[0] + turning)), LONG(0))
        square = rate * rate + 2 * self.stored(gap) * per_mass
        depth = np.cbrt((load / (self.stiffness * per_mass)) ** 2)
        return self._replace(chi=self.damped / np.sqrt(max(square, LONG("1.2") * load * depth)))

    def begins(self, state):
        """Returns the branch at the start, and the pair with its damping."""
        gap, rate, _ = self.gap_and_rate(state)
        if gap > 0 or (gap == 0 and rate >= 0):
            return self, APART
        pair = self.onset(state)
        if pair.chi == 0 or pair.dashpot == "unclamped" or np.atleast_1d(pair.margin(state, FULL))[-1] > 0:
            return pair, FULL
        return pair, SPRING if pair.dashpot == "approach_only" else CLIPPED


STILL = (0.0, 0.0, 0.0)


def factors(values):
    """Returns stiffness and damping as a scene gives them."""
    kinds = ("hertz_stiffness", "hunt_crossley_factor")
    if values.get("contact.law") != "hertz":
        kinds = ("penalty_factor", "viscous_penalty_factor")
    stiffness, damping = (values.get(f"contact.{kind}", 0.0) for kind in kinds)
    return stiffness, 0.0 if values.get("contact.method") == "penalty" else damping


def pair_of(fmu, values, stiffness, damping, damped=None):
    """Returns the pair of a scene, with factors of its own, and its state at the start."""
    ball, other = LONG(values["source.radius"]), LONG(values.get("destination.radius", 0.0))
    inside = values.get("contact.location") == "inside"
    capped = values.get("destination.ends") == "capped"
    motions = {"source": "free", "destination": "fixed"}
    motions = {body: values.get(f"{body}.motion", kind) for body, kind in motions.items()}
    axis = values.get("destination.axis")
    if axis is not None:
        axis = np.array(axis, LONG)
        axis = axis / np.sqrt(axis @ axis)
    begin = {"free": "initial", "prescribed": "prescribed", "fixed": "no"}
    pair = HertzPair(
        stiffness, damping, values.get("contact.dashpot", "non_adhesive"),
        ball if capped else other - ball if inside else other + ball, -1 if inside else 1,
        tuple(values.get(f"{b}.mass", 1.0) if motions[b] == "free" else np.inf for b in motions),
        values.get("gravity", (0.0, 0.0, -9.81)), axis if fmu == "SphereCylinder" else None,
        axis if fmu == "SpherePlane" else None,
        (other, values["destination.length"] / 2) if capped else None,
        linear=values.get("contact.law") != "hertz", damped=damped,
        given=tuple(values.get(f"{b}.prescribed_velocity.derivatives", [STILL])[0] for b in motions),
    )  # fmt: skip
    centers = [x for body in motions for x in values.get(f"{body}.center", STILL)]
    rates = [x for b, kind in motions.items() for x in values.get(f"{b}.{begin[kind]}_velocity", STILL)]
    return pair, [*centers, *rates]


def precise(pair):
    vectors = {
        k: np.array(getattr(pair, k), LONG)
        for k in ("gravity", "axis", "plane", "ends")
        if getattr(pair, k) is not None
    }
    numbers = {k: LONG(getattr(pair, k)) for k in ("stiffness", "chi", "reach")}
    masses = tuple(LONG(m) for m in pair.masses)
    given = tuple(np.array(g, LONG) for g in pair.given)
    return pair._replace(**vectors, **numbers, masses=masses, given=given)


def step_of(pair, state, branch, h):
    """Returns the state after h, and the difference of the last two columns, relative."""
    rows, counts = [], [2 * (k + 1) for k in range(COLUMNS)]
    start = pair.slope(state, branch)
    for k, count in enumerate(counts):
        part = h / count
        before, now = state, state + part * start
        for _ in range(count - 1):
            before, now = now, before + 2 * part * pair.slope(now, branch)
        row = [(now + before + part * pair.slope(now, branch)) / 2]
        for j in range(k):
            ratio = (LONG(count) / counts[k - 1 - j]) ** 2 - 1
            row.append(row[j] + (row[j] - rows[-1][j]) / ratio)
        rows.append(row)
    best = rows[-1][-1]
    scale = np.max(np.abs(best[0:6])), np.max(np.abs(best[6:12]))
    off = np.abs(best - rows[-1][-2])
    # The power of a dashpot that is clipped jumps where a centre passes from face to face, but no force does.
    of_dissipated = off[12] / max(LONG(1), abs(best[12]))
    return best, max(np.max(off[0:6]) / scale[0], np.max(off[6:12]) / scale[1], of_dissipated)


def margins(pair, state, branch):
    return np.atleast_1d(np.array(pair.margin(state, branch), LONG))


def after_event(pair, branch, which):
    if branch == APART:
        return FULL
    if which == 0:
        return APART
    return (SPRING if pair.dashpot == "approach_only" else CLIPPED) if branch == FULL else FULL


def locate(pair, state, branch, h, which):
    """Returns the length of a step that ends at the event, by regula falsi (Illinois)."""
    low, high = LONG(0), h
    at_low = margins(pair, state, branch)[which]
    at_low = at_low if at_low > 0 else LONG("1e-40")
    at_high = margins(pair, step_of(pair, state, branch, h)[0], branch)[which]
    for _ in range(200):
        if high - low <= LANDED * h:
            break
        middle = (low * at_high - high * at_low) / (at_high - at_low)
        if not low < middle < high:
            middle = (low + high) / 2
        value = margins(pair, step_of(pair, state, branch, middle)[0], branch)[which]
        if value == 0:
            return middle
        if value < 0:
            high, at_high, at_low = middle, value, at_low / 2
        else:
            low, at_low, at_high = middle, value, at_high / 2
    return high


def dips(pair, state, then, branch, h):
    """Where the gap falls below zero and rises again in this step: the length of a shorter one, at whose end
    the bodies overlap and approach each other. None: it does not"""
    first, last = pair.gap_and_rate(state), pair.gap_and_rate(then)
    if branch != APART or not first[1] < 0 < last[1]:
        return None
    low, high = LONG(0), h
    for _ in range(60):  # to the lowest place, by halving
        middle = (low + high) / 2
        gap, rate, _ = pair.gap_and_rate(step_of(pair, state, branch, middle)[0])
        if gap < 0 and rate < 0:
            return middle
        low, high = (middle, high) if rate < 0 else (low, middle)
    return None


def run(pair, state, end, first=None, tolerance=TOLERANCE):
    """Returns the state at `end` (positions, velocities, dissipated) and events: (time, next branch)."""
    pair = precise(pair)
    state = np.concatenate([np.array(state, LONG), [LONG(0)]])
    time, end, events = LONG(0), LONG(end), []
    pair, branch = pair.begins(state)
    h = LONG(first or end / 100)
    while time < end:
        h = min(h, end - time, end / 100)
        then, error = step_of(pair, state, branch, h)
        if error > tolerance and h > LONG("1e-12") * end:
            h *= max(LONG("0.2"), LONG("0.8") * (tolerance / error) ** (LONG(1) / 15))
            continue
        before, after = margins(pair, state, branch), margins(pair, then, branch)
        shorter = dips(pair, state, then, branch, h)
        if shorter is not None:
            h = shorter
            continue
        fallen = [i for i in range(len(after)) if after[i] < 0 and (before[i] > 0 or events)]
        opens = pair.gap_and_rate(then)[1] > 0  # what rounding left of a gap of zero is no event
        if 0 in fallen and opens == (branch == APART):
            fallen.remove(0)
        if fallen:
            lengths = [locate(pair, state, branch, h, i) for i in fallen]
            first_one = int(np.argmin(lengths))
            state, _ = step_of(pair, state, branch, lengths[first_one])
            time += lengths[first_one]
            begins = branch == APART
            branch = after_event(pair, branch, fallen[first_one])
            events.append((time, branch))
            h = min(h, end / 1000)
            state = settle(pair, state, branch)
            pair = pair.onset(state) if begins else pair
            continue
        state, time = then, time + h
        h *= min(LONG(2), LONG("0.8") * (tolerance / max(error, LONG("1e-30"))) ** (LONG(1) / 15))
    return state, events


def follow(fmu, values, end, tolerance="1e-14"):
    """Moves a scene with factors of its own from its start to `end`."""

    def find():
        return run(*pair_of(fmu, values, *factors(values)), end, tolerance=LONG(tolerance))

    return kept(["hertz", fmu, values, end, tolerance], find)


def settle(pair, state, branch):
    """At a touch and a release the gap is zero: what rounding left of it is taken out of the lighter body."""
    gap, _, n = pair.gap_and_rate(state)
    if abs(gap) < pair.reach * LONG("1e-17") and branch in (APART, FULL):
        state = state.copy()
        state[0:3] += pair.side * gap * n
    return state


def restitution_of(number, dashpot):
    """Returns e of Hunt and Crossley by y = chi v, or of full damping: u exp(-u) = (1 + y) exp(-1 - y), u = 1
    - e y."""
    y = mpmath.mpf(number)
    if dashpot == "approach_only":
        return float(mpmath.sqrt(2 * (y - mpmath.log(1 + y))) / y)
    with mpmath.workdps(40):
        return float((1 + mpmath.re(mpmath.lambertw(-(1 + y) * mpmath.exp(-1 - y)))) / y)
