"""Integrates turning.py: Dormand and Prince's method of order 8 (scipy) at 1e-13, stopped and begun anew at
every event: touch, release, end of a cylinder, corner of a law, stick and slip.

An event is looked for on the dense output of every step, between samples and at their extremes, and then
placed by steps of the method itself, which are more accurate than its dense output.
"""

import math

import numpy as np
from scipy.integrate import DOP853

from support.reference.turning import (
    BODIES,
    DISSIPATED,
    EACH,
    FRICTION,
    SIZE,
    SPRING,
    SPRINGS,
    SUMS,
    WORK,
    TurningPair,
)
from support.reference.turning_events import BOTH, FALLS, RISES, crossing
from support.reference.turning_rates import forces, growth_of_limit, rates, sliding_rate
from support.reference.turning_vectors import dot, norm, times

RELATIVE, ABSOLUTE = 1e-13, 1e-15
# A spring without a dashpot turns ever faster as the normal force ends, so that steps end before the
# release. A gap this close to zero [m] counts as one.
NEXT_TO_RELEASE = 1e-14
SAMPLES = 8  # of a step, between which an event may hide only if its function has two extremes there


class TurningRun:
    """State and events of one scene; `run` moves it on."""

    def __init__(self, values, shape, longest=math.inf, relative=RELATIVE):
        self.pair, self.time, self.longest, self.relative = TurningPair(values, shape), 0.0, longest, relative
        self.y = np.array(self.pair.first_state())
        self.onset_times, self.durations, self.events = [], [], []
        self.touching, self.sticking = False, set()  # the opposed motions that stick
        self.ends = 0.0  # to energy.dissipated by the ends of a cylinder
        place = self.pair.geometry(list(self.y))
        self.within = abs(place.along) <= self.pair.half_length
        if place.gap < 0 and self.within:
            self._touch()
        self.begin = self.energies()["total"]

    def _touch(self):
        pair = self.pair
        self.touching = True
        self.onset_times.append(self.time)
        self.y[SPRING:SUMS] = 0.0
        place = pair.geometry(list(self.y))
        force = pair.normal_force(min(place.gap, 0.0), place.rate)
        self.sticking = {kind for kind in pair.elastic() if self._begins_to_stick(kind, place, force)}

    def _begins_to_stick(self, kind, place, force):
        pair, one = self.pair, self.pair.opposed[kind]
        speed = norm(pair.motions(place)[kind])
        if force > 1e-12 * pair.stiffness * pair.r_s or one.c > 0 or speed == 0.0:
            return one.c * speed <= pair.limit(one, force, True)
        if pair.hertz and not one.follows:
            return False
        # both grow from zero, with the same power of time: which one faster
        ratio = pair.stiffness_of(one, -1.0) / pair.stiffness
        damped = 1 - pair.viscous * place.rate if pair.hertz else 1.0
        return ratio * speed <= one.mu_static * damped * -place.rate

    def _release(self):
        self.y[SPRING:SUMS] = 0.0
        self.touching, self.sticking = False, set()
        self.durations.append(self.time - self.onset_times[-1])

    def _functions(self):
        """name -> (function of the state, direction) of what may end the present stretch."""
        pair, found = self.pair, {}
        if math.isfinite(pair.half_length):
            found["end"] = lambda y: abs(pair.geometry(y).along) - pair.half_length, BOTH
        if not self.touching:
            if self.within:
                found["touch"] = lambda y: pair.geometry(y).gap, FALLS
            return found
        found["release"] = lambda y: pair.geometry(y).gap, RISES
        if pair.viscous > 0 and pair.dashpot == "approach_only":
            found["corner"] = lambda y: pair.geometry(y).rate, BOTH
        elif pair.viscous > 0:
            found["corner"] = lambda y: self._law(y), BOTH
        slip = pair.opposed["slip"]
        if slip.law != "none" and slip.largest < 1e299:
            found["largest"] = lambda y: slip.mu * self._law(y) - slip.largest, BOTH
        for kind in pair.elastic():
            found |= self._stick_and_slip(kind)
        return found

    def _law(self, y):
        place = self.pair.geometry(y)
        if self.pair.hertz:  # the sign alone, whatever the depth
            return 1 - self.pair.viscous * place.rate
        return self.pair.law_force(place.gap, place.rate)

    def _over(self, kind, y, static):
        pair, one = self.pair, self.pair.opposed[kind]
        place = pair.geometry(y)
        trial = norm(pair.trial(one, place, pair.motions(place)[kind], y[SPRINGS[kind]]))
        return trial - pair.limit(one, pair.normal_force(place.gap, place.rate), static)

    def _stick_and_slip(self, kind):
        if kind in self.sticking:
            return {f"{kind} slips": (lambda y: self._over(kind, y, True), RISES)}
        if self.pair.opposed[kind].c > 0:
            return {f"{kind} sticks": (lambda y: self._over(kind, y, False), FALLS)}
        return {f"{kind} sticks": (lambda y: sliding_rate(self.pair, kind, y, self.sticking), FALLS)}

    def _happen(self, name):
        self.events.append((self.time, name))
        pair, y = self.pair, list(self.y)
        if name == "touch":
            self._touch()
        elif name == "release":
            self._release()
        elif name.endswith(" sticks"):
            self.sticking.add(name.split()[0])
        elif name.endswith(" slips"):
            self._begin_to_slip(name.split()[0], y)
        elif name == "corner":
            for kind in pair.elastic():
                if pair.opposed[kind].c == 0.0:
                    self._rub_again(kind, y)
        elif name == "end":
            self._pass_end(pair.geometry(y))

    def _begin_to_slip(self, kind, y):
        pair, one = self.pair, self.pair.opposed[kind]
        self.sticking.discard(kind)
        if one.c == 0.0:
            place = pair.geometry(y)
            spring = y[SPRINGS[kind]]
            longest = pair.limit(one, pair.normal_force(place.gap, place.rate))
            longest /= pair.stiffness_of(one, place.gap)
            size = norm(spring)
            if longest < size:
                self.y[SPRINGS[kind]] = times(longest / size, spring)
                # Where the slip does not stretch it on from there it sticks again at once.
                if sliding_rate(pair, kind, list(self.y), self.sticking) < 0.0:
                    self.sticking.add(kind)

    def _rub_again(self, kind, y):
        """A normal force that ends leaves no spring; one that begins again finds none."""
        pair, one = self.pair, self.pair.opposed[kind]
        place = pair.geometry(y)
        if pair.dashpot == "approach_only":  # behind the corner slip may no longer stretch the spring
            if sliding_rate(pair, kind, y, self.sticking) < 0.0:
                self.sticking.add(kind)
            return
        if pair.hertz and place.gap >= 0:
            return
        self.y[SPRINGS[kind]] = 0.0
        y[SPRINGS[kind]] = [0.0] * 3
        speed = norm(pair.motions(place)[kind])
        if pair.stiffness_of(one, place.gap) * speed <= growth_of_limit(pair, one, y):
            self.sticking.add(kind)
        else:
            self.sticking.discard(kind)

    def _pass_end(self, place):
        self.within = not self.within
        if place.gap >= 0:
            return
        stored = self.pair.stored(place.gap)
        self.ends += stored if self.touching else -stored
        self._release() if self.touching else self._touch()

    def _rates(self, t, y):
        return rates(self.pair, y, self.touching, self.sticking)

    def _solver(self, end, first=None):
        scale = ABSOLUTE * np.ones(SIZE)
        return DOP853(
            self._rates, self.time, self.y, end, first_step=first, max_step=self.longest,
            rtol=self.relative, atol=scale,
        )  # fmt: skip

    def _after(self, length):
        """The state `length` later."""
        if self.time + length <= self.time:
            return self.y
        end = self.time + length
        solver = self._solver(end, end - self.time)
        while solver.status == "running":
            solver.step()
        return solver.y

    def run(self, end):
        last = None
        while self.time < end:
            last = self._stretch(end, last)
        return self

    def _stretch(self, end, last):
        """Steps up to the next event; its name, None at the end."""
        functions = self._functions()
        solver = self._solver(end)
        # An event that has just happened leaves its function at zero, give or take a rounding.
        started = last
        while solver.status == "running":
            message = solver.step()
            if (
                solver.status == "failed"
                and self.touching
                and abs(self.pair.geometry(self.y).gap) < NEXT_TO_RELEASE
            ):
                self._happen("release")
                return "release"
            if solver.status == "failed":
                raise ValueError(f"the reference is stuck at {self.time} s: {message}")
            found = self._first(functions, solver.dense_output(), solver.t_old, solver.t, started)
            if found:
                return self._land(*found, functions, solver)
            started = None
            self.time, self.y = solver.t, solver.y.copy()
        return None

    def _first(self, functions, dense, low, high, started):
        times_ = np.linspace(low, high, SAMPLES + 1)
        rows = [dense(t).tolist() for t in times_]
        rows[0] = self.y.tolist()
        best = None
        for name, (function, direction) in functions.items():
            of = [function(row) for row in rows]
            if name == started:
                of[0] = math.copysign(1e-300, of[1])
            where = crossing(lambda t, f=function: f(dense(t).tolist()), times_, of, direction)
            if where is not None and (best is None or where < best[0]):
                best = where, name
        return best

    def _land(self, where, name, functions, solver):
        """Newton's steps on the motion itself; the dense output gives the slope."""
        function = functions[name][0]
        low, dense = solver.t_old, solver.dense_output()
        self.time, length = low, where - low
        apart = 1e-3 * (solver.t - low)
        a, b = max(where - apart, low), min(where + apart, solver.t)
        rise = function(dense(b).tolist()) - function(dense(a).tolist())
        slope = rise / (b - a) if b > a else 0.0
        for _ in range(2):
            value = function(list(self._after(length)))
            if slope != 0 and abs(value / slope) < 0.1 * (solver.t - low):
                length = max(length - value / slope, 0.0)
        self.y = np.array(self._after(length))
        self.time = low + length
        self._happen(name)
        return name

    # What a run says.

    def energies(self):
        pair, y = self.pair, list(self.y)
        place = pair.geometry(y)
        found = dict.fromkeys(("kinetic", "rotational", "potential", "contact", "tangential"), 0.0)
        for index, body in enumerate(pair.bodies):
            here = (place.src, place.dst)[index]
            if body.mass:
                found["kinetic"] += 0.5 * body.mass * dot(here.v, here.v)
                found["potential"] -= body.mass * dot(pair.gravity, here.x)
            if body.inertia:
                at = EACH * index + 10
                found["rotational"] += 0.5 * dot(here.omega, y[at : at + 3])
        if self.touching:
            found["contact"] = pair.stored(place.gap)
            found["tangential"] = sum(pair.held(kind, place, y[SPRINGS[kind]]) for kind in pair.elastic())
        found["dissipated"] = y[DISSIPATED] + self.ends
        found["friction"] = y[FRICTION] - found["tangential"]  # friction's work less what it stores
        found["external_work"] = y[WORK]
        found["total"] = sum(found.values()) - 2 * y[WORK]
        return found

    def ends_at(self, name):
        """Of one body: position, velocity, orientation, angular velocity, axis."""
        here = self.pair.body_at(list(self.y), BODIES.index(name))
        q = np.array(here.q) / np.linalg.norm(here.q)
        return {
            "position": np.array(here.x), "velocity": np.array(here.v), "orientation": q,
            "angular_velocity": np.array(here.omega), "current_axis": np.array(here.axis),
        }  # fmt: skip

    def now(self):
        """Forces and torques at this instant."""
        return forces(self.pair, list(self.y), self.touching, self.sticking)

    def figures(self):
        """By the names of FMI; impulses and the spring, which no variable has, under names of their own."""
        now, found = self.now(), {f"energy.{name}": value for name, value in self.energies().items()}
        for body in BODIES:
            found |= {f"{body}.{name}": value for name, value in self.ends_at(body).items()}
        found |= {
            "contact.gap": now.place.gap, "contact.gap_rate": now.place.rate,
            "contact.normal_force": now.force, "contact.source_force": np.array(now.on_source),
            "contact.source_torque": np.array(now.source_torque),
            "contact.destination_torque": np.array(now.destination_torque),
            "contact.friction_force": np.array(now.friction), "contact.slip_velocity": np.array(now.slip),
            "contact.onsets": len(self.onset_times), "impulse": self.y[SUMS : SUMS + 3].copy(),
            "source_torque_impulse": self.y[SUMS + 3 : SUMS + 6].copy(),
            "destination_torque_impulse": self.y[SUMS + 6 : SUMS + 9].copy(),
            "spring": self.y[SPRINGS["slip"]].copy(),
        }  # fmt: skip
        if self.onset_times:
            lasting = self.time - self.onset_times[-1]
            found["contact.last_onset_time"] = self.onset_times[-1]
            found["contact.last_duration"] = lasting if self.touching else self.durations[-1]
        return found


def follow(values, shape, end, **more):
    return TurningRun(values, shape, **more).run(end)
