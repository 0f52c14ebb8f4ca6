"""Head-on motion, Hertz's law, coefficients of restitution and inputs: answers that do not depend on how
a run is stepped, and the closed forms that they must agree with."""

import numpy as np
import pytest

from support.checks import check_close, check_relative, run, start
from support.scenes.agreement import TOLERANCES, Scene, check_agreement, pick, seeds

STEPS = (1, 2, 7, 22, 100, 300)


def ended(opened, scene, random):
    """Returns the FMU at the scene's end. Tolerance and number of steps are random."""
    tolerance, steps = float(pick(random, *TOLERANCES)), pick(random, *STEPS)
    return run(opened(scene.fmu), scene.values, scene.end, steps, tolerance)


# A body at rest on another one for long: the force is the load, whatever the length of the steps.


def _supports(random):
    """Returns FMU, values and the direction from the destination to the source."""
    shape = pick(random, "sphere", "shell", "plane", "cylinder", "tube", "cap")
    up = np.array(pick(random, (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0)))
    if shape == "plane":
        up = np.array(pick(random, tuple(up), (0.6, 0.0, 0.8), (3 / 7, -2 / 7, 6 / 7)))
        return "SpherePlane", {"destination.axis": list(up), "source.center": list(0.1 * up)}, up
    if shape == "cap":
        values = {"destination.axis": list(up), "destination.finite_length": True}
        values |= {"destination.ends": "capped"}
        return "SphereCylinder", values | {"source.center": list(0.6 * up)}, up
    inside = shape in ("shell", "tube")
    away = -0.4 if inside else 0.6
    values = {"source.center": list(away * up), "contact.location": "inside" if inside else "outside"}
    if shape in ("sphere", "shell"):
        return "SphereSphere", values, up
    return "SphereCylinder", values | {"destination.axis": list(np.roll(up, 1))}, up


def resting(random):
    """A ball is laid down without speed, or falls a little, and rests until the end."""
    fmu, values, up = _supports(random)
    stiffness = float(pick(random, 1e4, 1e6, 1e9, 1e12))
    mass = float(pick(random, 0.1, 1.0, 2.0))
    critical = 2.0 * np.sqrt(stiffness * mass)
    values |= {"source.mass": mass, "contact.penalty_factor": stiffness}
    values |= {"contact.viscous_penalty_factor": critical * float(pick(random, 0.1, 0.5, 1.0, 3.0))}
    values |= {"contact.dashpot": str(pick(random, "non_adhesive", "unclamped", "approach_only"))}
    load = 9.81 * mass
    pushed = pick(random, "gravity", "force", "both free")
    if pushed == "gravity":
        values["gravity"] = list(-9.81 * up)
    else:
        values["gravity"] = [0.0, 0.0, 0.0]
        values["source.external_force"] = list(-load * up)
    if pushed == "both free":
        values["destination.motion"] = "free"
        values["destination.mass"] = float(pick(random, 1.0, 5.0))
        values["destination.external_force"] = list(load * up)
        reduced = mass * values["destination.mass"] / (mass + values["destination.mass"])
        values["contact.viscous_penalty_factor"] *= np.sqrt(reduced / mass)
    end = float(pick(random, 10.0, 1e2, 1e3, 1e4, 1e5))
    return Scene(fmu, values, end, floor={"velocity": 1.0}), load


@pytest.mark.parametrize("seed", seeds())
def test_a_body_at_rest_presses_with_its_load_however_long_it_rests(opened, seed):
    random = np.random.default_rng(seed)
    scene, load = resting(random)
    before = start(opened(scene.fmu), scene.values)["energy.total"]
    fmu = ended(opened, scene, random)
    check_relative(f"force {scene}", fmu["contact.normal_force"], load, 1e-9)
    check_relative("gap", fmu["contact.gap"], -load / scene.values["contact.penalty_factor"], 1e-9)
    check_close("velocity", np.asarray(fmu["source.velocity"]), np.zeros(3), 1e-9)
    check_close("energy", fmu["energy.total"], before, 1e-11 * (1.0 + abs(before)))


@pytest.mark.parametrize("seed", [*seeds(), 31443, 31787])  # on a slanted plane for 1e5 s
def test_a_body_comes_to_rest_the_same_however_it_is_stepped(opened, seed):
    scene, _ = resting(np.random.default_rng(seed))
    check_agreement(opened, scene, seed, runs=3)


@pytest.mark.parametrize("end", [1e3, 1e4, 1e5, 1e6])
@pytest.mark.parametrize("values, force", [({}, 9.81), ({"contact.law": "hertz"}, 9.81)])
def test_a_ball_on_a_ball_presses_with_its_weight_after_one_long_step(opened, values, force, end):
    fmu = start(opened("SphereSphere"), {"source.center": [0.0, 0.0, 0.6], **values}, None, "event_driven")
    before = fmu["energy.total"]
    fmu.step(end)
    check_relative("force", fmu["contact.normal_force"], force, 1e-12)
    check_close("energy", fmu["energy.total"], before, 1e-12)


def test_a_stiff_contact_keeps_the_digits_of_its_depth_over_ten_seconds(opened):
    values = {"contact.penalty_factor": 1e12, "contact.viscous_penalty_factor": 2e6}
    fmu = start(opened("SphereSphere"), values, None, "event_driven")
    fmu.step(10.0)
    check_relative("force", fmu["contact.normal_force"], 9.81, 1e-12)


def test_hops_below_rounding_end_on_a_cylinder_with_open_ends(opened):
    """Positions round away the gap of a ball that hops so low."""
    values = {"source.initial_velocity": [0.0, 0.0, 1.0], "contact.penalty_factor": 1e20}
    fmu = run(opened("BallOffRoller"), values | {"contact.viscous_penalty_factor": 1e9}, 20.0, 1, 1e-8)
    check_relative("force", fmu["contact.normal_force"], 9.81, 1e-12)


# Impacts under Hertz's law: the release is the end of one contact, not the start of another.


def hertz_impact(random):
    """Two balls meet in flight, head-on or not."""
    along = np.array(pick(random, (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.6, 0.0, 0.8), (3 / 7, -2 / 7, 6 / 7)))
    across = np.cross(along, np.roll(along, 1) + np.array([0.0, 0.5, 0.0]))
    across /= np.linalg.norm(across)
    offset = float(pick(random, 0.0, 0.0, 0.1, 0.3))
    speed = float(pick(random, 0.1, 1.0, 5.0))
    gap = float(pick(random, 0.0, 0.001, 0.01))
    values = {"gravity": [0.0, 0.0, 0.0], "contact.law": "hertz"}
    values |= {"contact.hertz_stiffness": float(pick(random, 1e6, 1e9, 1e12))}
    values |= {"contact.dashpot": str(pick(random, "non_adhesive", "unclamped", "approach_only"))}
    values |= {"source.center": list(along * (np.sqrt(0.36 - offset**2) + gap) + offset * across)}
    values |= {"source.initial_velocity": list(-speed * along)}
    values |= {"destination.motion": str(pick(random, "free", "fixed"))}
    if random.integers(4):
        values["contact.viscous_control"] = "restitution"
        values["contact.restitution"] = float(pick(random, 0.0, 0.05, 0.5, 0.95, 1.0))
    return Scene("SphereSphere", values, end=float(pick(random, 1.5, 4.0)) * gap / speed + 0.05)


# In 1803 (restitution 0) the bodies part at the speed at which the dashpot begins to be clipped.
@pytest.mark.parametrize("seed", [*seeds(), 1803])
def test_an_impact_under_hertz_s_law_is_one_contact(opened, seed):
    random = np.random.default_rng(seed)
    scene = hertz_impact(random)
    check_agreement(opened, scene, seed)
    assert ended(opened, scene, random)["contact.onsets"] <= 1, scene


@pytest.mark.parametrize("steps", [1, 33, 100, 1000])
@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
def test_marbles_touch_once_whatever_the_tolerance(opened, tolerance, steps):
    fmu = run(opened("HertzImpact"), {}, 1e-3, steps, tolerance)
    assert fmu["contact.onsets"] == 1
    check_close("onset", fmu["contact.last_onset_time"], 5e-4, 1e-14)
    check_relative("duration", fmu["contact.last_duration"], 6.42152384898e-05, 1e-11)


# Derivatives of an input: what is set ends higher derivatives, what is of lower order goes on.


class Driven:
    """Holds an input as an importer sets it, with its first and second integral over time."""

    def __init__(self):
        self.value, self.rate, self.bend, self.once, self.twice = 0.0, 0.0, 0.0, 0.0, 0.0

    def go_on(self, time):
        inner = self.value / 2 + time * (self.rate / 6 + time * self.bend / 24)
        self.twice += time * (self.once + time * inner)
        self.once += time * (self.value + time * (self.rate / 2 + time * self.bend / 6))
        self.value += time * (self.rate + time * self.bend / 2)
        self.rate += time * self.bend

    def set(self, fmu, name, orders, values):
        for order, value in zip(orders, values, strict=True):
            row = [value, 0.0, 0.0]
            if order == 0:
                fmu[name] = row
            else:
                fmu.set_derivative(name, row, order=order)
        if orders:
            lowest = min(orders)
            given = dict(zip(orders, values, strict=True))
            self.value = given.get(0, self.value)
            self.rate = given.get(1, 0.0 if lowest < 1 else self.rate)
            self.bend = given.get(2, 0.0 if lowest < 2 else self.bend)


@pytest.mark.parametrize("seed", seeds(20))
def test_what_is_not_set_of_an_input_goes_on(opened, seed, method):
    """A force on a free body of 1 kg and a prescribed displacement are set by calls in any order."""
    random = np.random.default_rng(seed)
    values = {"source.center": [50.0, 0.0, 0.0], "gravity": [0.0, 0.0, 0.0], "source.mass": 1.0}
    values["destination.motion"] = "prescribed"
    scene = str(pick(random, "SphereSphere", "SphereCylinder"))
    fmu = start(opened(scene), values, float(pick(random, *TOLERANCES)), method)
    force, place = Driven(), Driven()
    for _ in range(int(random.integers(1, 8))):
        for right, name in ((force, "source.external_force"), (place, "destination.prescribed_displacement")):
            orders = [int(order) for order in random.permutation(3)[: random.integers(4)]]
            right.set(fmu, name, orders, [float(pick(random, -1.0, 0.0, 0.5, 1.0, 4.0)) for _ in orders])
        if random.integers(2):
            _ = fmu["source.velocity"]
        size = float(pick(random, 0.1, 0.25, 1.0))
        fmu.step(size)
        for right in (force, place):
            right.go_on(size)
        for name, value in (
            ("source.velocity", force.once),
            ("source.displacement", force.twice),
            ("destination.displacement", place.value),
        ):
            check_close(name, fmu[name], [value, 0.0, 0.0], 1e-12 * (1 + abs(value)))


# Coefficients of restitution of the linear law, by which bodies without load part at e times their speed.


def rebound(random):
    """A free impact is head-on. The coefficient may be near zero."""
    scene = str(pick(random, "SphereSphere", "SpherePlane", "SphereCylinder"))
    touching = 0.1 if scene == "SpherePlane" else 0.6
    gap = float(pick(random, 0.0, 0.1, 0.5))
    coefficient = float(pick(random, 1e-5, 1e-4, 1e-3, 0.01, 0.1, 0.5, 0.9, 1.0))
    axis = [1.0, 0.0, 0.0] if scene == "SphereCylinder" else [0.0, 0.0, 1.0]
    values = {"gravity": [0.0, 0.0, 0.0], "source.center": [0.0, 0.0, touching + gap]}
    values |= {"source.initial_velocity": [0.0, 0.0, -1.0], "source.mass": float(pick(random, 0.1, 1.0, 5.0))}
    values |= {"contact.viscous_control": "restitution", "contact.restitution": coefficient}
    values |= {"contact.penalty_factor": float(pick(random, 1e4, 1e6, 1e9))}
    values |= {"contact.dashpot": str(pick(random, "non_adhesive", "unclamped", "approach_only"))}
    if scene != "SphereSphere":
        values["destination.axis"] = axis
    elif random.integers(2):
        values["destination.motion"] = "free"
    return Scene(scene, values, end=gap + 1.0), coefficient


@pytest.mark.parametrize("seed", seeds())
def test_bodies_part_at_the_coefficient_of_restitution_however_small(opened, seed):
    random = np.random.default_rng(seed)
    scene, coefficient = rebound(random)
    fmu = ended(opened, scene, random)
    parting = fmu["source.velocity"][2] - fmu["destination.velocity"][2]
    assert fmu["contact.onsets"] == 1, scene
    check_close(f"speed {scene}", parting, coefficient, 1e-12)
