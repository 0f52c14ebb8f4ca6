"""A ball fired at a finite cylinder that tumbles: onsets by an independent reference without friction.

Flights: the axis by Rodrigues' formula about the angular momentum, and the first touch by samples with a
certificate. Where both ends of an interval are farther from contact than the fastest motion could cover in
it, there is no touch; any other interval is cut into four, down to 1e-13 of the flight. Impacts: scipy's
DOP853 at 1e-12, ended where the gap opens or the ball passes an end."""

import math

import numpy as np
from scipy.integrate import solve_ivp

from contact_fmus.fmu.contact_fmu import FmuError
from support.checks import start
from support.scenes.random_scenes import unit_vector

CLEARED = 1e-13  # of the horizon: intervals are not cut below
STIFFNESS_DIGITS = 1e-12
# Bodies that have just parted do not touch again so soon [s]: their gap opens at a speed that the parting's
# place, known to some 1e-12 m, does not decide.
JUST_PARTED = 1e-9


def cylinder_inertia(mass, radius, length):
    """About the axis, across it."""
    return 0.5 * mass * radius**2, mass * (3 * radius**2 + length**2) / 12


class TumblingPair:
    """State: separation c (cylinder - ball), its rate, the axis, the angular momentum over the transverse
    inertia. The ball's own turning does not matter, nor gravity unless the cylinder's centre is held."""

    def __init__(self, values):
        self.r_s, self.r_d = values["source.radius"], values["destination.radius"]
        self.half_length = 0.5 * values["destination.length"]
        self.capped = values.get("destination.ends") == "capped"
        self.stiffness = values["contact.penalty_factor"]
        held = values["destination.motion"] == "fixed"
        mass, other = values["source.mass"], values["destination.mass"]
        self.inverse_mass = 1 / mass + (0 if held else 1 / other)
        self.pull = -np.array(values["gravity"]) if held else np.zeros(3)
        axial, self.inertia = cylinder_inertia(other, self.r_d, 2 * self.half_length)
        self.c = np.array(values["destination.center"]) - np.array(values["source.center"])
        velocity = np.array(values.get("destination.initial_velocity", (0, 0, 0)))
        self.w = velocity * (not held) - np.array(values["source.initial_velocity"])
        self.axis = np.array(values["destination.axis"], float)
        self.axis /= np.linalg.norm(self.axis)
        omega = np.array(values["destination.initial_angular_velocity"], float)
        # L / I_1
        self.momentum = omega + (axial / self.inertia - 1) * (omega @ self.axis) * self.axis
        self.time, self.onsets = 0.0, []

    def axes_at(self, times):
        """The axis goes round the angular momentum at the rate |L| / I_1."""
        rate = np.linalg.norm(self.momentum)
        if rate == 0:
            return np.broadcast_to(self.axis, (len(times), 3))
        u = self.momentum / rate
        once = np.cross(u, self.axis)
        angle = (rate * times)[:, None]
        return self.axis + np.sin(angle) * once + 2 * np.sin(angle / 2) ** 2 * np.cross(u, once)

    def separations_at(self, times):
        t = times[:, None]
        return self.c + t * (self.w + 0.5 * t * self.pull)

    def heights(self, times):
        """Returns the distances from contact: the larger of the gap and the way beyond the ends."""
        c, e = self.separations_at(times), self.axes_at(times)
        along = np.einsum("ij,ij->i", c, e)
        radial = np.linalg.norm(c - along[:, None] * e, axis=1) - self.r_d
        axial = np.abs(along) - self.half_length
        if not self.capped:
            return np.maximum(radial - self.r_s, axial)
        beyond_both = (radial > 0) & (axial > 0)
        return np.where(beyond_both, np.hypot(radial, axial), np.maximum(radial, axial)) - self.r_s

    def fastest(self, lows, width):
        """Returns bounds of the speed of the separation in the axis' frame, over intervals."""
        middle = lows + 0.5 * width
        rates = np.linalg.norm(self.w + middle[:, None] * self.pull, axis=1)
        speed = rates + 0.5 * width * np.linalg.norm(self.pull)
        far = np.linalg.norm(self.separations_at(middle), axis=1) + 0.5 * speed * width
        return speed + np.linalg.norm(self.momentum) * far

    def first_touch(self, horizon, start):
        """Returns the time from now to the first touch after `start`, inf if there is none."""
        width = (horizon - start) / 4096
        lows = start + width * np.arange(4096)
        while len(lows):
            starts, ends = self.heights(lows), self.heights(lows + width)
            inside = np.flatnonzero(ends < 0)
            last = inside[0] if len(inside) else len(lows) - 1  # nothing after a touch matters
            keep = starts + ends <= self.fastest(lows, width) * width
            keep[last + 1 :] = False
            lows = lows[keep]
            if width < CLEARED * horizon:
                touching = self.heights(lows + width) < 0
                return float(lows[touching][0] + 0.5 * width) if touching.any() else math.inf
            lows = (lows[:, None] + width / 4 * np.arange(4)).ravel()
            width /= 4
        return math.inf

    def fly(self, time):
        at = np.array([time])
        self.axis = self.axes_at(at)[0]
        self.c = self.separations_at(at)[0]
        self.w = self.w + time * self.pull
        self.time += time

    def _nearest(self, c, e):
        """Returns the distance of the ball's centre from the surface, and the direction there."""
        along = c @ e
        across = c - along * e
        distance = np.linalg.norm(across)
        radial, axial = distance - self.r_d, abs(along) - self.half_length
        outward, end = across / distance, math.copysign(1, along) * e
        if not self.capped or axial <= min(radial, 0):
            return radial, outward
        if radial <= 0:
            return axial, end
        far = math.hypot(radial, axial)
        return far, (radial * outward + axial * end) / far

    def _rates(self, _, y):
        c, w, e, momentum = y.reshape(4, 3)
        distance, normal = self._nearest(c, e)
        on_cylinder = max(0.0, self.stiffness * (self.r_s - distance)) * normal
        arm = self.r_s * normal - c
        rate = self.inverse_mass * on_cylinder + self.pull
        return np.concatenate([w, rate, np.cross(momentum, e), np.cross(arm, on_cylinder) / self.inertia])

    def _gap(self, _, y):
        return self._nearest(y[:3], y[6:9])[0] - self.r_s

    def _beyond(self, _, y):
        return -1.0 if self.capped else abs(y[:3] @ y[6:9]) - self.half_length

    def impact(self, horizon):
        """From the touch to where contact ends."""
        self._gap.__func__.terminal = self._beyond.__func__.terminal = True
        self._gap.__func__.direction = self._beyond.__func__.direction = 1
        y = np.concatenate([self.c, self.w, self.axis, self.momentum])
        size = np.abs(y).max()
        done = solve_ivp(
            self._rates, (0, horizon), y, method="DOP853", rtol=STIFFNESS_DIGITS, atol=1e-14 * size,
            events=(self._gap, self._beyond), first_step=1e-3 / math.sqrt(self.stiffness * self.inverse_mass),
        )  # fmt: skip
        self.c, self.w, self.axis, self.momentum = done.y[:, -1].reshape(4, 3)
        self.axis = self.axis / np.linalg.norm(self.axis)
        self.time += done.t[-1]

    def run(self, end, most=100):
        """Returns onset times until `end`."""
        while self.time < end and len(self.onsets) < most:
            touch = self.first_touch(end - self.time, JUST_PARTED if self.onsets else 0.0)
            if not touch < end - self.time:
                break
            self.fly(touch)
            self.onsets.append(self.time)
            self.impact(end - self.time)
        return self.onsets


# Seeded random scenes: a ball fired at a finite cylinder that tumbles, free to fly or held at its centre.
# Onsets of one, run in one communication step, are compared with the reference's.

FIRST_TOUCH = 1e-9  # s
TOLERANCE = 1e-10
AFTER = 1e-7  # s after the first touch, where the FMU tells when it was; less than any contact lasts here

END = 10.0  # s, one communication step


def random_tumbling_scene(seed, ends="open"):
    """The ball comes near the cylinder after some seconds and up to hundreds of turns; most touch."""
    random = np.random.default_rng([154, seed])
    radius, length = random.uniform(0.05, 0.4), random.uniform(0.4, 3.0)
    ball = random.uniform(0.03, 0.3)
    held = bool(random.integers(2))
    gravity = 9.81 * unit_vector(random)
    arrival = random.uniform(0.5, 9.0)
    reach = 0.5 * length + radius + ball
    start = unit_vector(random) * reach * random.uniform(1.1, 6.0)
    aim = unit_vector(random) * random.uniform(0.0, 1.0) * reach
    middle = random.normal(size=3)
    velocity = random.normal(size=3) * (not held)
    # both fall alike unless the cylinder is held
    thrown = (aim - start) / arrival + velocity - 0.5 * gravity * arrival * held
    return {
        "source.motion": "free", "source.radius": ball, "source.mass": float(10 ** random.uniform(-1, 1)),
        "source.center": (middle + start).tolist(),
        "source.initial_velocity": thrown.tolist(), "destination.motion": "fixed" if held else "free",
        "destination.rotation": "free", "destination.radius": radius,
        "destination.mass": float(10 ** random.uniform(-1, 1)), "destination.center": middle.tolist(),
        "destination.initial_velocity": velocity.tolist(),
        "destination.axis": (unit_vector(random) * random.uniform(0.5, 2)).tolist(),
        "destination.finite_length": True, "destination.ends": ends, "destination.length": length,
        "destination.initial_angular_velocity": (10 ** random.uniform(-0.5,
            2.3) * unit_vector(random)).tolist(),
        "gravity": gravity.tolist(), "contact.location": "outside", "contact.method": "penalty",
        "contact.penalty_factor": 1e6,
    }  # fmt: skip


def first_onset(fmu, values, expected, method):
    """By a step that ends just after the expected one; inf where nothing has touched by then."""
    start(fmu, values, TOLERANCE, method)
    fmu.step(expected + AFTER)
    return fmu["contact.last_onset_time"] if fmu["contact.onsets"] else math.inf


def failures(fmu, seed, method="event_driven", ends="open"):
    """Returns lines on what is wrong, and how far off the first touch was [s]."""
    values = random_tumbling_scene(seed, ends)
    onsets = TumblingPair(values).run(END)
    try:
        start(fmu, values, TOLERANCE, method)
        fmu.step(END)
        count = fmu["contact.onsets"]
        off = abs(first_onset(fmu, values, onsets[0], method) - onsets[0]) if onsets else 0.0
    except FmuError as error:
        return [f"seed {seed}, {ends}: {error}"], 0.0
    lines = []
    if count != len(onsets):
        lines.append(f"seed {seed}, {ends}: {count} onsets, expected {len(onsets)}, at {onsets[:4]}")
    if not off <= FIRST_TOUCH:
        lines.append(f"seed {seed}, {ends}: first touch off by {off} s, at {onsets[0]}")
    return lines, off
