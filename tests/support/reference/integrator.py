"""An independent reference for the motion: Taylor series of the equations of DESIGN section 1 with events
found on the series.

The motion is integrated regime by regime: within a regime the right-hand side is analytic, a step carries
the power series of positions and velocities to a high order, and an event is the first root of a series,
isolated by Bernstein signs (nothing is missed between samples, there are none). Free flight is a polynomial
and takes one step however long it is. Which side of an event the motion is on is remembered, not recomputed
from a rounded gap.

The number type is float (quick) or decimal.Decimal (40 digits, the check of float). Dissipated work,
external work and impulse ride along as further states.
"""

from support.reference.law import ReferenceContact, complete, start_motion
from support.reference.paths import GivenPath, shifted
from support.reference.series import evaluate, first_root, highest, square_root
from support.reference.span import CLIPPED, FLIGHT, FULL, SPRING, SpanMaker

# A gap at the start that eight roundings of its terms could have made is none: the bodies just touch. With
# forty digits the gap is that of the numbers given, to the last one.
START_ROUNDING = 8 * 2.0**-53
SLIGHT = 1e-10  # m/s of the rate, m of the gap: the tolerance that runs are asked for


class Reference(SpanMaker):
    """Configuration as for ReferenceContact; "<input>.derivatives" gives a list of first and second
    derivatives at time 0.

    `straight`: the bodies move on the line through their centres (or across the axis) and may pass the
    centre, where the normal turns round. The distance is then the place on that line with a sign, whose
    change is an event."""

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
        """Whether bodies that just touch, at rest, are about to overlap: by the first power of the time in
        which the gap of a flight changes."""
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
        """The branch of the law by the gap and its rate of now."""
        gap, rate, _, _ = self.present()
        formula = -self.penalty * (self.zero if self.on_root == "gap" else gap) - self.viscous * rate
        self.law_regime = FULL
        parts = rate > 0 or (rate == 0 and not self.from_rest)
        if self.dashpot == "approach_only" and self.viscous and parts:
            self.law_regime = SPRING
        if self.dashpot == "non_adhesive" and self.viscous and formula < 0:
            self.law_regime = CLIPPED

    def sure_events(self):
        """How many events there are in any case; two at the same instant may count as one."""
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
            if self.law_regime == FULL and abs(self.present()[0]) < SLIGHT:
                self.slight.add(len(self.event_times))  # let go this near the surface is to part
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
        """How far the contact's series have converged to the digits of the number type."""
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
                self.position[body], self.velocity[body] = (
                    [r[0] for r in rows] for rows in path.at(self.time)
                )
            if event is not None:
                self.happen(event)
        return self

    def note_peaks(self, span, step):
        if span.loads and self.dashpot == "approach_only":
            side = -1 if self.law_regime == FULL else 1
            rate = [side * c for c in span.loads[2]]
            self.clearest = highest(rate, step, self.number, self.clearest)
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
