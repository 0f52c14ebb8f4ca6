"""The claims of scenarios: each check takes a recording and gives the measured and the expected value.

A check's further arguments are keys of its [[claim]] table. Expected values come from closed_forms.py, from a
literal in the scenario file, or from a recomputation here; never from the FMU that is measured.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import closed_forms
from .experiment import ENERGIES, Claim, Recording, RunError

# The contact geometry and force law once more, in NumPy, to compare the FMU with


def _pair(run: Recording) -> tuple[str, str, str]:
    """Names of contact, source and destination; RunError where the scene has more than one contact"""
    contacts = run.motion.scene.contacts
    if len(contacts) != 1:
        text = f"the claim is about one contact, and {run.scenario.fmu} has {len(contacts)}"
        raise RunError(f"{run.scenario.name}: {text}")
    return contacts[0].name, contacts[0].source, contacts[0].destination


def recompute_force(run: Recording) -> tuple[np.ndarray, float]:
    """Force on a source outside the destination, both prescribed; and the size of the largest term in it"""
    contact, source, destination = _pair(run)
    apart, closing = (_relative(run, kind) for kind in ("displacement", "velocity"))
    axis, is_plane = run.motion.axis(destination), run.motion.is_plane(destination)
    if axis is not None and not is_plane:
        along = apart @ axis
        apart = apart - np.outer(along, axis)
    distance = apart @ -axis if is_plane else np.linalg.norm(apart, axis=1)
    normal = np.tile(-axis, (len(apart), 1)) if is_plane else apart / distance[:, None]
    gap = distance - run.value(f"{source}.radius") - (run.motion.radius(destination) or 0.0)
    rate = np.sum(closing * normal, axis=1)
    touching = gap < 0.0
    if not is_plane and axis is not None and run.value(f"{destination}.finite_length"):
        touching &= np.abs(along) <= 0.5 * run.value(f"{destination}.length")
    elastic = -run.value(f"{contact}.penalty_factor") * gap
    viscous = -run.value(f"{contact}.viscous_penalty_factor") * rate
    dashpot = run.value(f"{contact}.dashpot")
    if dashpot == "approach_only":
        viscous = np.where(rate < 0.0, viscous, 0.0)
    force = elastic + viscous
    if dashpot == "non_adhesive":
        force = np.maximum(force, 0.0)
    scale = float(np.max(np.where(touching, np.abs(elastic) + np.abs(viscous), 0.0)))
    return -np.where(touching, force, 0.0)[:, None] * normal, scale


def _relative(run: Recording, kind: str) -> np.ndarray:
    """Destination minus source: location of the centres, or their velocity"""
    _, source, destination = _pair(run)
    relative = run.series[f"{destination}.prescribed_{kind}"] - run.series[f"{source}.prescribed_{kind}"]
    if kind == "displacement":
        relative = relative + (
            np.asarray(run.value(f"{destination}.center")) - np.asarray(run.value(f"{source}.center"))
        )
    return relative


def recomputed_diagonal(run: Recording) -> float:
    """Diagonal of the bounding box of both bodies at the start; of an infinite cylinder, its cross-section,
    and nothing of a plane"""
    corners = []
    for body in _pair(run)[1:]:
        if run.motion.is_plane(body):
            continue
        extent, axis = np.full(3, run.value(f"{body}.radius")), run.motion.axis(body)
        if axis is not None:
            ring = run.motion.ring(body)
            around = closed_forms.cylinder_extent(ring or extent[0], axis, run.motion.length(body) or 0.0)
            extent = around + extent if ring else around
        center = np.asarray(run.value(f"{body}.position"), dtype=float)
        corners += [center - extent, center + extent]
    return float(np.linalg.norm(np.ptp(corners, axis=0)))


@dataclass(frozen=True)
class Outcome:
    measured: Any
    expected: Any
    unit: str
    scale: float | None = None  # of relative errors, where it is not the expected value's size

    @property
    def error(self) -> float:
        return float(np.max(np.abs(np.asarray(self.measured, dtype=float) - np.asarray(self.expected, dtype=float))))

    def error_of(self, claim: Claim) -> float:
        if not claim.relative:
            return self.error
        scale = self.scale if self.scale is not None else float(np.max(np.abs(self.expected)))
        return self.error / scale if scale > 0.0 else math.inf

    def holds(self, claim: Claim) -> bool:
        """A comparison with NaN is false, so a NaN never passes."""
        return self.error_of(claim) <= claim.allowed


CHECKS: dict[str, Callable[..., Outcome]] = {}


def check(function: Callable[..., Outcome]) -> Callable[..., Outcome]:
    CHECKS[function.__name__] = function
    return function


def evaluate(claim: Claim, run: Recording) -> Outcome:
    return CHECKS[claim.check](run, **claim.options)


# what several checks need


def _mass(run: Recording, body: str) -> float:
    """Infinite where the contact force does not move the body"""
    return run.value(f"{body}.mass") if run.value(f"{body}.motion") == "free" else math.inf


def _effective_mass(run: Recording) -> float:
    """The reduced one of both"""
    return 1.0 / (1.0 / _mass(run, "source") + 1.0 / _mass(run, "destination"))


def _damping(run: Recording) -> float:
    if run.value("contact.method") != "penalty_dynamic":
        return 0.0
    if run.value("contact.viscous_control") != "restitution":
        return run.value("contact.viscous_penalty_factor")
    zeta = closed_forms.ratio_for(run.value("contact.restitution"), run.value("contact.dashpot"))
    return 2.0 * zeta * math.sqrt(run.value("contact.penalty_factor") * _effective_mass(run))


def _restitution(run: Recording) -> float:
    if _damping(run) > 0.0 and run.value("contact.viscous_control") == "restitution":
        return run.value("contact.restitution")
    stiffness, damping = run.value("contact.penalty_factor"), _damping(run)
    if damping == 0.0:
        return 1.0
    zeta = closed_forms.damping_ratio(_effective_mass(run), stiffness, damping)
    return closed_forms.restitution(run.value("contact.dashpot"), zeta)


def _gravity(run: Recording) -> float:
    return float(np.linalg.norm(run.value("gravity")))


def _worst_point(run: Recording, name: str, expected: np.ndarray, unit: str, scale: float | None = None) -> Outcome:
    """The communication point where a recorded series is furthest from what is expected of it"""
    difference = np.abs(run.series[name] - expected).reshape(len(expected), -1)
    worst = int(np.argmax(np.max(difference, axis=1)))  # the first NaN, where there is one
    size = float(np.max(np.abs(expected))) if scale is None else scale
    return Outcome(run.series[name][worst], expected[worst], unit, size)


# checks


@check
def final_value(run: Recording, variable: str, expected: Any, unit: str = "m") -> Outcome:
    return Outcome(run.final[variable], expected, unit)


@check
def contact_duration(run: Recording) -> Outcome:
    """How long the last contact lasted: gravity off, head-on"""
    damping, stiffness = _damping(run), run.value("contact.penalty_factor")
    dashpot = run.value("contact.dashpot") if damping else "unclamped"
    expected = closed_forms.overlap_duration(dashpot, _effective_mass(run), stiffness, damping)
    return Outcome(run.final["contact.last_duration"], expected, "s")


@check
def restitution(run: Recording) -> Outcome:
    """Gap rate after against gap rate before: gravity off, head-on"""
    rate = run.series["contact.gap_rate"]
    return Outcome(-rate[-1] / rate[0], _restitution(run), "1", 1.0)


@check
def velocities_after(run: Recording) -> Outcome:
    """Velocities of source and destination along the line of a head-on impact"""
    line = run.value("contact.direction")
    before = [float(run.series[f"{body}.velocity"][0] @ line) for body in ("source", "destination")]
    after = [float(run.series[f"{body}.velocity"][-1] @ line) for body in ("source", "destination")]
    expected = closed_forms.velocities_after(
        _mass(run, "source"), before[0], _mass(run, "destination"), before[1], _restitution(run)
    )
    return Outcome(after, expected, "m/s")


@check
def momentum(run: Recording) -> Outcome:
    """Largest change of the momentum of two free bodies, gravity off, against the bodies' own momenta"""
    parts = [_mass(run, body) * run.series[f"{body}.velocity"] for body in ("source", "destination")]
    change = np.linalg.norm(parts[0] + parts[1] - parts[0][0] - parts[1][0], axis=1)
    return Outcome(float(np.max(change)), 0.0, "kg.m/s", float(max(np.max(np.abs(part)) for part in parts)))


@check
def static_penetration(run: Recording) -> Outcome:
    weight = run.value("source.mass") * _gravity(run)
    return Outcome(-run.final["contact.gap"], weight / run.value("contact.penalty_factor"), "m")


@check
def static_force(run: Recording) -> Outcome:
    return Outcome(run.final["contact.normal_force"], run.value("source.mass") * _gravity(run), "N")


@check
def energy_balance(run: Recording) -> Outcome:
    """Largest change of the sum of the energies, against the largest of its terms"""
    names = [f"energy.{name}" for name in ENERGIES]
    terms = [run.series[name] for name in names if name in run.series]
    terms.append(-run.series["energy.external_work"])
    total = np.sum(terms, axis=0)
    return Outcome(float(np.max(np.abs(total - total[0]))), 0.0, "J", float(np.max(np.abs(terms))))


@check
def bounce_gap(run: Recording) -> Outcome:
    """Gap at every communication point of a body dropped head-on, undamped"""
    expected = closed_forms.elastic_bounce_gap(
        run.time, run.value("contact.gap"), run.value("source.mass"), _gravity(run), run.value("contact.penalty_factor")
    )
    return _worst_point(run, "contact.gap", expected, "m")


@check
def viscous_sinking(run: Recording) -> Outcome:
    """Gap at every communication point of a body laid on a viscous-only contact"""
    expected = run.value("contact.gap") - closed_forms.viscous_sinking(
        run.time, run.value("source.mass"), _gravity(run), run.value("contact.viscous_penalty_factor")
    )
    return _worst_point(run, "contact.gap", expected, "m")


@check
def free_flight(run: Recording, after: float = 0.0) -> Outcome:
    """Final position of a source that moves straight and evenly for `after` seconds and falls from then on"""
    position, velocity = run.value("source.position"), run.value("source.velocity")
    leaving = closed_forms.free_flight(after, position, velocity, np.zeros(3))
    falling = float(run.time[-1] - run.time[0]) - after
    return Outcome(
        run.final["source.position"], closed_forms.free_flight(falling, leaving, velocity, run.value("gravity")), "m"
    )


@check
def force_law(run: Recording) -> Outcome:
    """Force on the source at every communication point, recomputed from where the importer put the bodies"""
    expected, scale = recompute_force(run)
    return _worst_point(run, "contact.source_force", expected, "N", scale)


@check
def opposite_forces(run: Recording) -> Outcome:
    """The forces on source and destination cancel"""
    both = run.series["contact.source_force"] + run.series["contact.destination_force"]
    return Outcome(float(np.max(np.abs(both))), 0.0, "N", float(np.max(np.abs(run.series["contact.source_force"]))))


@check
def automatic_factor(run: Recording, variable: str) -> Outcome:
    """diagonal, effective_penalty_factor or effective_viscous_penalty_factor under automatic control"""
    diagonal = recomputed_diagonal(run)
    modulus, time = run.value("contact.reference_modulus"), run.value("contact.characteristic_time")
    viscous_only = run.value("contact.penalty_control") == "viscous_only"
    stiffness = modulus * diagonal * (1.0 if viscous_only else run.value("contact.penalty_multiplier"))
    expected = {
        "contact.diagonal": (diagonal, "m"),
        "contact.effective_penalty_factor": (stiffness, "N/m"),
        "contact.effective_viscous_penalty_factor": (time * stiffness, "N.s/m"),
    }
    return Outcome(run.value(variable), *expected[variable])


# Checks of bodies that turn


def _slide(run: Recording, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Way and speed along x of a ball on a level plane, which slides and then rolls"""
    speed, spin = run.value("source.velocity")[0], run.value("source.angular_velocity")[1]
    slip = speed - run.value("source.radius") * spin
    return closed_forms.slide_to_roll(time, speed, slip, run.value("contact.friction_coefficient"), _gravity(run))


@check
def slides_then_rolls(run: Recording) -> Outcome:
    """Place of a ball along x at every communication point, on a level plane"""
    expected = run.series["source.position"].copy()
    expected[:, 0] = run.value("source.position")[0] + _slide(run, run.time)[0]
    return _worst_point(run, "source.position", expected, "m")


@check
def rolls_at_last(run: Recording) -> Outcome:
    """Velocity of that ball at the end"""
    final = _slide(run, run.time[-1:])[1]
    return Outcome(run.final["source.velocity"], [float(final[0]), 0.0, 0.0], "m/s")


@check
def rolls_round_a_tube(run: Recording) -> Outcome:
    """Place of a ball in a vertical tube at every communication point"""
    x, speed = run.value("source.position")[0], run.value("source.velocity")[1]
    rate = speed / x
    height = closed_forms.vertical_tube(run.time, rate, _gravity(run))
    angle = rate * run.time
    expected = np.stack([x * np.cos(angle), x * np.sin(angle), height], axis=-1)
    return _worst_point(run, "source.position", expected, "m")


@check
def swings_in_a_hole(run: Recording) -> Outcome:
    """Place of a cylinder in a hole across z at every communication point, let go at rest beside x = 0: it
    rolls where there is friction, and its inertia about the line of contact is 3/2 of m r^2"""
    contact, pin, _ = _pair(run)
    place = run.value(f"{pin}.position")
    length, inertia = float(np.linalg.norm(place)), 1.0 if run.value(f"{contact}.friction") == "none" else 1.5
    rate = math.sqrt(_gravity(run) / (inertia * length))
    angle = closed_forms.pendulum(run.time, math.atan2(place[0], -place[2]), rate)
    expected = length * np.stack([np.sin(angle), np.zeros_like(angle), -np.cos(angle)], axis=-1)
    return _worst_point(run, f"{pin}.position", expected, "m")


@check
def rolls_in_a_groove(run: Recording) -> Outcome:
    """Place along x and y of a ball at the bottom of an outer race around y, at every communication point"""
    contact, ball, torus = _pair(run)
    pressed = _mass(run, ball) * _gravity(run) / run.value(f"{contact}.penalty_factor")
    across = run.value(f"{torus}.radius") - run.value(f"{ball}.radius") + pressed
    lengths = np.array([run.value(f"{torus}.ring_radius") + across, across])
    expected = closed_forms.rolling_in_a_groove(run.time, run.value(f"{ball}.position")[:2], lengths, _gravity(run))
    places = np.concatenate([expected, run.series[f"{ball}.position"][:, 2:]], axis=1)
    return _worst_point(run, f"{ball}.position", places, "m")


@check
def friction_drive(run: Recording) -> Outcome:
    """Angular velocity at every communication point of a roller at rest in place, pressed on one that turns"""
    contact, source, destination = _pair(run)
    radius, drive = run.value(f"{source}.radius"), run.value(f"{destination}.prescribed_angular_velocity")
    rate = float(np.linalg.norm(drive))
    apart = np.cross(run.value(f"{source}.position") - run.value(f"{destination}.position"), drive / rate)
    between = float(np.linalg.norm(apart))  # of the axes
    depth = radius + run.value(f"{destination}.radius") - between
    limit = run.value(f"{contact}.friction_coefficient") * run.value(f"{contact}.penalty_factor") * depth
    lever = between - radius
    inertia, slip = 0.5 * run.value(f"{source}.mass") * radius**2, run.value(f"{contact}.characteristic_slip_velocity")
    turns = closed_forms.friction_drive(run.time, rate * lever, radius, inertia, limit, slip)
    return _worst_point(run, f"{source}.angular_velocity", np.outer(turns, -drive / rate), "rad/s")


@check
def rolls_on_a_turntable(run: Recording) -> Outcome:
    """Place of a ball on a plane that turns about z, at every communication point"""
    rate = run.value("destination.prescribed_angular_velocity")[2]
    start, velocity = run.value("source.position"), run.value("source.velocity")
    place, _ = closed_forms.turntable(run.time, start[:2], velocity[:2], rate)
    expected = np.concatenate([place, np.full((len(place), 1), start[2])], axis=1)
    return _worst_point(run, "source.position", expected, "m")


@check
def tumbles(run: Recording) -> Outcome:
    """Speeds along y of ball and cylinder and the cylinder's angular velocity about x, at the end: the ball
    came along y, the cylinder lay along z"""
    inertia = _moment(run)
    lever = run.value("source.position")[2] - run.value("destination.position")[2]
    speed = run.value("source.velocity")[1]
    expected = closed_forms.hit_beside(speed, _mass(run, "source"), _mass(run, "destination"), inertia, lever)
    found = run.final["source.velocity"][1], run.final["destination.velocity"][1]
    return Outcome([*found, -run.final["destination.angular_velocity"][0]], expected, "m/s")


@check
def angular_momentum(run: Recording) -> Outcome:
    """Largest change of the angular momentum about the origin of a ball that does not turn and a free
    cylinder, gravity off, against the bodies' own"""
    parts = [
        _mass(run, body) * np.cross(run.series[f"{body}.position"], run.series[f"{body}.velocity"])
        for body in ("source", "destination")
    ]
    axis, spin = run.series["destination.current_axis"], run.series["destination.angular_velocity"]
    along = 0.5 * _mass(run, "destination") * run.value("destination.radius") ** 2
    turning = np.sum(spin * axis, axis=1, keepdims=True) * axis
    parts.append(_moment(run) * (spin - turning) + along * turning)
    total = np.sum(parts, axis=0)
    largest = float(max(np.max(np.abs(part)) for part in parts))
    return Outcome(float(np.max(np.abs(total - total[0]))), 0.0, "kg.m2/s", largest)


def _moment(run: Recording) -> float:
    """Of inertia of the solid cylinder about a line across its axis through its middle"""
    mass, radius, length = (run.value(f"destination.{name}") for name in ("mass", "radius", "length"))
    return mass * (3.0 * radius**2 + length**2) / 12.0
