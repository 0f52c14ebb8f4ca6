"""An independent reference for the motion: Taylor series of the equations of DESIGN section 1, with events.

Within a regime the right-hand side is analytic: a step carries power series of positions and velocities to
a high order, and an event is the first root of a series, isolated by Bernstein signs, so that none is missed.
Free flight is one step however long it is. The side of an event on which the motion is, is remembered.

The number type is float (quick) or decimal.Decimal (40 digits, the check of float). Dissipated work,
external work and impulse ride along as further states."""

import math
from dataclasses import dataclass
from decimal import Decimal, getcontext
from functools import lru_cache
from itertools import pairwise
from operator import mul

from support.reference.law import ReferenceContact, complete, start_motion

# The next functions give the prescribed motions: polynomials of time for where an importer puts a body.
#
# The place of a prescribed body is its displacement input with the derivatives given for it. Where none are
# given, the displacement follows the velocity input, unless every body of the scene is prescribed: then it
# stays where it was put. Its velocity is the velocity input with its own derivatives,
# whatever the displacement does: the two disagree where the importer makes them.


def shifted(coefficients, time):
    """Returns the polynomial's coefficients about `time`, by Horner's scheme."""
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
            terms = zip(center, moved, speed, strict=True)
            self.position = [[c + u[0], v, a / 2, j / 6] for c, u, (v, a, j) in terms]

    def at(self, time):
        return tuple([shifted(row, time) for row in rows] for rows in (self.position, self.velocity))


# Truncated power series of an ordinary differential equation, and the first root of one.
#
# A Tape is a list of rows of coefficients with the rule that makes coefficient k of each from what stands
# before it; `grow` runs it order by order. The numbers may be float or decimal.Decimal.

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
        """Returns a row that starts with its value and goes on by integration, see `integrate`."""
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
    """Returns the matrix whose row i turns the coefficients of t^k on [0, 1] into Bernstein coefficient i."""
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
    """Returns the first place in [start, start + width] where the polynomial goes below zero, or None."""
    if all(p >= 0 for p in points):
        return None
    if points[0] < 0 or depth == 0:
        return start
    left, right = split(points)
    found = first_crossing(left, start, width / 2, depth - 1)
    return found if found is not None else first_crossing(right, start + width / 2, width / 2, depth - 1)


def first_root(row, span, number, fresh=False):
    """First time in (0, span] where the series, positive at first, goes below zero; None if it does not.

    `fresh`: the series starts exactly on its root; the factor t is divided out."""
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
    points = [sum(map(mul, weights, scaled)) for weights in bernstein_matrix(degree, number)]
    bits = 60 if number is float else 120
    place = first_crossing(points, number(0), number(1), bits)
    return None if place is None else polished(scaled, place, number) * span


def highest(row, span, number, known):
    """Returns the larger of `known` and the largest value of the series on [0, span], to 14 digits. Bernstein
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


# The equations of motion as power series over one step: states, conditions whose roots are events, and sums.

FLIGHT, FULL, SPRING, CLIPPED = "flight", "spring and dashpot", "spring alone", "clipped"


@dataclass
class Span:
    """The series of one step: states by name, and what events and step length are read from."""

    states: dict
    conditions: list  # (event name, row, sign that makes it positive now)
    resolved: list  # rows that limit the step; none in flight
    loads: tuple = ()  # rows of normal force, gap and its rate, whose extremes are noted; none in flight


class SpanMaker:
    """The part of Reference that makes its series, from its present position, velocity and regime."""

    def outer_rate(self, body):
        """Returns accelerations without the contact, and the external force, as polynomials of time."""
        kind = self.values[f"{body}.motion"]
        force = [[self.zero]] * 3
        if kind != "free":
            return [[self.zero]] * 3, force
        given = [
            self.values[f"{body}.external_force"],
            *self.values.get(f"{body}.external_force.derivatives", []),
        ]
        given += [[0.0] * 3] * (3 - len(given))
        mass = self.number(self.values[f"{body}.mass"])
        rates, forces = [], []
        for weight, row in zip(self.vector("gravity"), zip(*given, strict=True), strict=True):
            f0, f1, f2 = map(self.number, row)
            forces.append(shifted([f0, f1, f2 / 2], self.time))
            rates.append([weight + forces[-1][0] / mass, forces[-1][1] / mass, forces[-1][2] / mass])
        return rates, forces

    def span(self, regime):
        tape = Tape(self.number)
        x = {body: [tape.state(p) for p in self.position[body]] for body in self.position}
        v = {body: [tape.state(p) for p in self.velocity[body]] for body in self.velocity}
        for body, path in self.given.items():
            x[body], v[body] = ([tape.polynomial(row) for row in rows] for rows in path.at(self.time))
        c = [tape.linear([(1, b), (-1, a)]) for a, b in zip(x["source"], x["destination"], strict=True)]
        w = [tape.linear([(1, b), (-1, a)]) for a, b in zip(v["source"], v["destination"], strict=True)]
        conditions = []
        if self.axis:
            along = tape.linear(list(zip(self.axis, c, strict=True)))
            along_rate = tape.linear(list(zip(self.axis, w, strict=True)))
            c = [tape.linear([(1, row), (-e, along)]) for e, row in zip(self.axis, c, strict=True)]
            w = [tape.linear([(1, row), (-e, along_rate)]) for e, row in zip(self.axis, w, strict=True)]
            if self.half_length is not None:
                conditions += [
                    (name, tape.linear([(side, along)], self.half_length), 1)
                    for name, side in (("end+", -1), ("end-", 1))
                ]
        if self.line:
            distance = tape.linear(list(zip(self.line, c, strict=True)))
            beyond = tape.linear([(self.sign, distance)], -self.sign * self.surface)
            if not self.flat and (regime != FLIGHT or self.inside):
                conditions.append(("centre", distance, 1))
        else:
            square = tape.dot(c, c)
            beyond = tape.linear([(self.sign, square)], -self.sign * self.surface**2)
            distance = tape.root(square) if regime != FLIGHT else None
        conditions.append(("gap", beyond, -1 if self.touching else 1))  # g times a positive length
        push, rates, resolved, loads = None, {}, [], ()
        if regime != FLIGHT:
            gap, gap_rate, formula, force, push = self.contact_rows(tape, regime, c, w, distance)
            resolved, loads = [*c, gap], (force, gap, gap_rate)
            if self.dashpot == "approach_only" and self.viscous:
                conditions.append(("rate", gap_rate, -1 if regime == FULL else 1))
            if self.dashpot == "non_adhesive" and self.viscous:  # without a dashpot the gap ends it all
                conditions.append(("force", formula, -1 if regime == CLIPPED else 1))
            lost = tape.linear([(1, force), (self.penalty, gap)])
            rates["dissipated"] = tape.linear([(-1, tape.product(lost, gap_rate))])
        states = {("position", body): x[body] for body in x} | {("velocity", body): v[body] for body in v}
        powers = []
        for body, side in (("source", 1), ("destination", -1)):
            self.equation_of_motion(tape, body, side, x[body], v[body], push, powers)
        rates["external_work"] = tape.linear([(1, power) for power in powers])
        if push:
            states["impulse"] = [tape.state(p) for p in self.impulse]
            for state, row in zip(states["impulse"], push, strict=True):
                tape.integrate(state, row)
        for name, row in rates.items():
            states[name] = tape.state(getattr(self, name))
            tape.integrate(states[name], row)
        tape.grow(10 if regime == FLIGHT else self.order)
        return Span(states, self.oriented(conditions), resolved, loads)

    def contact_rows(self, tape, regime, c, w, distance):
        """g, its rate, the formula's force, the force and its vector on the source (along -/+ rho)"""
        if self.line:
            rate = tape.linear(list(zip(self.line, w, strict=True)))
        else:
            rate = tape.quotient(tape.dot(c, w), distance)
        gap = tape.linear([(self.sign, distance)], -self.sign * self.surface)
        gap_rate = tape.linear([(self.sign, rate)])
        formula = tape.linear([(-self.penalty, gap), (-self.viscous, gap_rate)])
        force = {
            FULL: formula,
            SPRING: tape.linear([(-self.penalty, gap)]),
            CLIPPED: tape.polynomial([self.zero]),
        }[regime]
        if self.line:
            push = [tape.linear([(-self.sign * n, force)]) for n in self.line]
            return gap, gap_rate, formula, force, push
        ratio = tape.quotient(force, distance)
        push = [tape.linear([(-self.sign, tape.product(ratio, row))]) for row in c]
        return gap, gap_rate, formula, force, push

    def equation_of_motion(self, tape, body, side, position, velocity, push, powers):
        outer, force = self.outer_rate(body)
        kind = self.values[f"{body}.motion"]
        mass = self.number(self.values[f"{body}.mass"])
        for i in range(3):
            if kind != "prescribed":
                rate = tape.polynomial(outer[i])
                if push and kind == "free":
                    rate = tape.linear([(1, rate), (side / mass, push[i])])
                tape.integrate(position[i], velocity[i])
                tape.integrate(velocity[i], rate)
            if kind == "free":
                powers.append(tape.product(tape.polynomial(force[i]), velocity[i]))
            elif kind == "prescribed" and push:  # what moves the body works against the contact
                powers.append(tape.linear([(-side, tape.product(push[i], velocity[i]))]))

    def oriented(self, conditions):
        """Each condition with the sign that makes it positive on this side of its event."""
        result = []
        for name, row, sign in conditions:
            if name.startswith("end"):
                sign = 1 if self.within or name != self.nearer_end() else -1
            result.append((name, [sign * c for c in row]))
        return result

    def nearer_end(self):
        return "end+" if self.present()[2] > 0 else "end-"


# A gap at the start that eight roundings of its terms could have made is none: the bodies just touch. With
# forty digits the gap is that of the numbers given, to the last one.
START_ROUNDING = 8 * 2.0**-53
SLIGHT = 1e-10  # m/s of the rate, m of the gap: the tolerance that runs are asked for


class Reference(SpanMaker):
    """Configuration as for ReferenceContact; "<input>.derivatives" are the first and second at time 0.

    `straight`: the bodies move on the line through their centres (or across the axis) and may pass the
    centre, where the normal turns round. The distance then has a sign, whose change is an event."""

    def __init__(self, configuration, shape, number=float, order=24, straight=False):
        derivatives = {k: v for k, v in configuration.items() if k.endswith(".derivatives")}
        plain = {k: v for k, v in configuration.items() if k not in derivatives}
        law = ReferenceContact(plain, shape)
        self.values = {**complete(plain), **derivatives}
        self.number, self.order, self.zero = number, order, number(0)
        motion = start_motion(self.values)
        self.position, self.velocity, self.given = {}, {}, {}
        for body in ("source", "destination"):
            if self.values[f"{body}.motion"] == "prescribed":
                self.given[body] = GivenPath(self.values, body, number)
            shift = getattr(motion, f"{body}_displacement")
            center = self.vector(f"{body}.center")
            self.position[body] = [c + number(float(u)) for c, u in zip(center, shift, strict=True)]
            self.velocity[body] = [number(float(v)) for v in getattr(motion, f"{body}_velocity")]
        radii = [number(float(law.destination_radius)), number(self.values["source.radius"])]
        self.inside = law.location == "inside"
        self.surface = radii[0] - radii[1] if self.inside else radii[0] + radii[1]  # d at g = 0
        self.sign = -1 if self.inside else 1  # g = sign * (d - surface)
        self.penalty, self.viscous = number(float(law.penalty)), number(float(law.viscous))
        self.dashpot = self.values["contact.dashpot"]
        self.axis = self.half_length = None
        if shape == "cylinder":
            axis = self.vector("destination.axis")
            length = square_root(sum(a * a for a in axis))
            self.axis = [a / length for a in axis]
            if self.values["destination.finite_length"]:
                self.half_length = number(self.values["destination.length"]) / 2
        self.time = self.dissipated = self.external_work = self.zero
        self.impulse = [self.zero] * 3  # of the contact on the source
        self.onsets, self.onset_times, self.durations, self.steps = 0, [], [], 0
        self.happened = set()  # names of conditions that went through zero
        self.event_times = []  # when the regime of the contact changed
        # The most that the gap's rate was on its side of zero since it changed sign, and the events that
        # begin or end less than SLIGHT of that: nobody with a tolerance can be asked to see them.
        self.clearest, self.slight = self.zero, set()
        self.law_regime, self.on_root = FULL, None
        self.line = self.line_through_the_centre() if straight else None
        self.flat = shape == "plane"  # the distance is then that along the normal, which never turns
        if self.flat:
            normal = self.vector("destination.axis")
            length = square_root(sum(a * a for a in normal))
            self.line = [-a / length for a in normal]
        self.window = self.peak_force = self.peak_penetration = self.zero  # peaks are those from `window` on
        self.within = True
        self.decide_start()
        self.from_rest = False

    def line_through_the_centre(self):
        c = self.apart(self.position)[0]
        length = square_root(sum(x * x for x in c))
        return [x / length for x in c]

    def apart(self, rows):
        """Source to destination across the axis, and along it."""
        c = [b - a for a, b in zip(rows["source"], rows["destination"], strict=True)]
        if not self.axis:
            return c, self.zero
        along = sum(x * e for x, e in zip(c, self.axis, strict=True))
        return [x - along * e for x, e in zip(c, self.axis, strict=True)], along

    def vector(self, name):
        return [self.number(x) for x in self.values[name]]

    # Where the motion is: touching (g < 0), within (the ends), and the branch of the law.

    def present(self):
        """g, its rate, c.e_d and its rate, now."""
        (c, along), (w, along_rate) = self.apart(self.position), self.apart(self.velocity)
        if self.line:
            distance, rate = (sum(x * n for x, n in zip(row, self.line, strict=True)) for row in (c, w))
            return self.sign * (distance - self.surface), self.sign * rate, along, along_rate
        distance = square_root(sum(x * x for x in c))
        rate = sum(x * y for x, y in zip(c, w, strict=True)) / distance if distance else self.zero
        return self.sign * (distance - self.surface), self.sign * rate, along, along_rate

    def decide_start(self):
        gap, rate, along, _ = self.present()
        rounding = self.surface * START_ROUNDING if self.number is float else self.zero
        if abs(gap) <= rounding:
            gap, self.on_root = self.zero, "gap"
            self.close_gap()
        self.just_touches = self.on_root == "gap"
        self.from_rest = gap == 0 and rate == 0
        self.touching = gap < 0 or (gap == 0 and rate < 0) or (self.from_rest and self.closes_from_rest())
        self.within = self.half_length is None or abs(along) <= self.half_length
        self.begin_contact()

    def close_gap(self):
        """The gap is zero here and now: its rounding would look like another event soon."""
        self.surface = self.surface + self.sign * self.present()[0]

    def closes_from_rest(self):
        """Returns whether bodies that just touch, at rest, are about to overlap, by the first power of time
        that changes the gap of a flight."""
        self.touching = False
        row = next(row for name, row in self.span(FLIGHT).conditions if name == "gap")
        noise = max(map(abs, row)) * self.number(10) ** (-13)
        return next((c < 0 for c in row[1:] if abs(c) > noise), False)

    def begin_contact(self):
        if not (self.touching and self.within):
            return
        self.onsets += 1
        self.onset_times.append(self.time)
        self.begin_law()

    def begin_law(self):
        """Returns the branch of the law by the gap and its rate of now."""
        gap, rate, _, _ = self.present()
        formula = -self.penalty * (self.zero if self.on_root == "gap" else gap) - self.viscous * rate
        self.law_regime = FULL
        parts = rate > 0 or (rate == 0 and not self.from_rest)
        if self.dashpot == "approach_only" and self.viscous and parts:
            self.law_regime = SPRING
        if self.dashpot == "non_adhesive" and self.viscous and formula < 0:
            self.law_regime = CLIPPED

    def sure_events(self):
        """Returns how many events there are at least. Two at one instant may count as one."""
        slight = set(self.slight)
        if self.happened & {"rate"} and self.clearest < SLIGHT:
            slight.add(len(self.event_times) - 1)
        return len({time for i, time in enumerate(self.event_times) if i not in slight})

    def regime(self):
        return self.law_regime if self.touching and self.within else FLIGHT

    def stored_energy(self):
        if not (self.touching and self.within):
            return self.zero
        gap = self.present()[0]
        return self.penalty * gap * gap / 2

    def happen(self, event):
        self.on_root = event
        self.happened.add(event)
        before, regime = self.touching and self.within, self.regime()
        stored = self.stored_energy()
        if event == "gap":
            self.touching = not self.touching
            self.close_gap()
        elif event.startswith("end"):
            self.within = not self.within
        elif event == "rate":
            if self.clearest < SLIGHT:
                self.slight |= {len(self.event_times) - 1, len(self.event_times)}
            self.clearest = self.zero
            self.law_regime = SPRING if self.law_regime == FULL else FULL
        elif event == "force":
            # A contact let go this near the surface parts. A force that is clipped from the start never acts.
            if self.law_regime == FULL and (abs(self.present()[0]) < SLIGHT or self.time == 0):
                self.slight.add(len(self.event_times))
            self.law_regime = CLIPPED if self.law_regime == FULL else FULL
        elif event == "centre":
            self.line = [-n for n in self.line]
            self.begin_law()
        after = self.touching and self.within
        if before and not after:
            self.durations.append(self.time - self.onset_times[-1])
        if after and not before:
            self.begin_contact()
        if event.startswith("end"):
            self.dissipated = self.dissipated + stored - self.stored_energy()
        if self.regime() != regime:
            self.event_times.append(self.time)

    # Running.

    def step_limit(self, span):
        """Returns how far the contact's series have converged to the digits of the number type."""
        exponent = -17 if self.number is float else -37
        limit = None
        for row in span.resolved:
            for k in (self.order - 1, self.order - 2):
                if row[k] != 0:
                    ratio = self.number(10) ** exponent * self.surface / abs(row[k])
                    reach = ratio ** (1 / self.number(k))
                    limit = reach if limit is None else min(limit, reach)
        return limit

    def run(self, end):
        end = self.number(end)
        while self.time < end:
            regime = self.regime()
            span = self.span(regime)
            step, event = end - self.time, None
            if regime != FLIGHT:
                limit = self.step_limit(span)
                step = step if limit is None else min(step, limit)
            for name, row in span.conditions:
                root = first_root(row, step, self.number, fresh=name == self.on_root)
                if root is not None:
                    step, event = root, name
            self.steps += 1
            self.note_peaks(span, step)
            self.advance(span, step)
            self.on_root = None
            self.time = end if event is None and step >= end - self.time else self.time + step
            for body, path in self.given.items():
                place, speed = path.at(self.time)
                self.position[body], self.velocity[body] = [r[0] for r in place], [r[0] for r in speed]
            if event is not None:
                self.happen(event)
        return self

    def note_peaks(self, span, step):
        if span.loads and self.dashpot == "approach_only":
            side = -1 if self.law_regime == FULL else 1
            self.clearest = highest([side * c for c in span.loads[2]], step, self.number, self.clearest)
        skipped = max(self.zero, self.window - self.time)
        if span.loads and skipped <= step:
            force, gap, _ = (shifted(row, skipped) if skipped else row for row in span.loads)
            depth = [-c for c in gap]
            rest = step - skipped
            self.peak_force = highest(force, rest, self.number, self.peak_force)
            self.peak_penetration = highest(depth, rest, self.number, self.peak_penetration)

    def advance(self, span, step):
        for key, rows in span.states.items():
            if isinstance(key, tuple):
                getattr(self, key[0])[key[1]] = [evaluate(row, step) for row in rows]
            elif key == "impulse":
                self.impulse = [evaluate(row, step) for row in rows]
            else:
                setattr(self, key, evaluate(rows, step))


# The reference for parameters that change during a run: it goes on with new ones from where it stands.


class TunedMotion(Reference):
    """A ball of 0.1 m and 1 kg meets a fixed sphere of 0.5 m at the origin; `values` by their FMI names."""

    def __init__(self, values, position, velocity):
        start = {"source.center": position, "source.initial_velocity": velocity}
        super().__init__({**start, "contact.location": "outside", **values}, "sphere")

    def energies(self):
        """Returns potential and stored energy."""
        gravity = self.vector("gravity")
        height = sum(g * x for g, x in zip(gravity, self.position["source"], strict=True))
        return self.stored_energy() - height

    def change(self, values):
        before = self.energies()
        self.values |= values
        self.penalty = self.values["contact.penalty_factor"]
        self.viscous = self.values["contact.viscous_penalty_factor"]
        self.dashpot = self.values["contact.dashpot"]
        self.external_work += self.energies() - before
        if self.touching:
            self.begin_law()
