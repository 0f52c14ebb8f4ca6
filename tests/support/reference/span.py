"""The equations of motion of integrator.py as power series over one step: states, conditions whose
roots are events, and what is integrated along with them."""

from dataclasses import dataclass

from support.reference.paths import shifted
from support.reference.series import Tape

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
        """Row of accelerations without the contact, and the external force as polynomials in the
        time since now."""
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
        """g, its rate, the formula's force, the force and its vector on the source (along -/+ rho
        outside/inside)."""
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
