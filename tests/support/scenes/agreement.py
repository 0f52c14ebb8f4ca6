"""Families of random scenes whose answer must not depend on how it was asked for.

A family is a function that takes a numpy random generator and returns a Scene. `disagreements` runs the
scene once at the tightest tolerance in one communication step, then at looser tolerances, in more steps,
with and without readings between them, and lists every quantity that differs by more than allowed:

    def rim_passed(random): ...; return Scene("SphereCylinder", values, end=2.0)

    @pytest.mark.parametrize("seed", seeds())
    def test_a_rim_passed(opened, seed):
        check_agreement(opened, rim_passed(np.random.default_rng(seed)), seed)

CONTACT_SCENES=1000 runs a thousand scenes of each family, CONTACT_FIRST_SCENE=5000 begins at that seed."""

import os
from dataclasses import dataclass, field

import numpy as np

from support.checks import start

TIGHTEST = 1e-12
TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12)
STEPS = (1, 1, 2, 3, 5, 7, 10, 22, 50, 100, 300)

# What is compared at the end, with the least scale [SI unit] that a difference is taken as a fraction of.
BODY = {"position": 1.0, "velocity": 1.0, "angular_velocity": 1.0, "orientation": 1.0}
ENERGY = ("kinetic", "rotational", "potential", "contact", "tangential", "dissipated", "friction")
ENERGY += ("external_work", "total")
CONTACT = {"onsets": 1.0, "last_onset_time": 1.0, "last_duration": 1.0}
# Sums and maxima over all communication steps; they need a reading after every step.
SUMS = ("mean_force", "mean_source_torque", "mean_destination_torque")
PEAKS = ("peak_force", "peak_penetration")


@dataclass
class Scene:
    """`values` as of support.checks.start; `floor` replaces least scales, by a quantity's last name;
    `slack` is how many tolerances a quantity may be off (the family says why it is more than 10);
    `each` is called with the FMU before every step, for what the importer does on the way;
    `bodies` and `contacts` are the names of those that are compared, where they are not a pair's."""

    fmu: str
    values: dict
    end: float
    floor: dict = field(default_factory=dict)
    slack: float = 10.0
    each: object = None
    bodies: tuple = ("source", "destination")
    contacts: tuple = ("contact",)


def seeds(default=40):
    """`default` seeds, or as many as CONTACT_SCENES says, from CONTACT_FIRST_SCENE on."""
    first = int(os.environ.get("CONTACT_FIRST_SCENE", "0"))
    return range(first, first + int(os.environ.get("CONTACT_SCENES", str(default))))


def pick(random, *choices):
    return choices[int(random.integers(len(choices)))]


def answer(fmu, scene, tolerance, steps, readings, method="event_driven"):
    """Returns the figures at the run's end, with sums and maxima where there were readings or one step."""
    if "solver.method" not in fmu:  # a force element
        tolerance, method = None, None
    start(fmu, scene.values, tolerance, method)
    sums, peaks = {}, {}
    for k in range(steps):
        if scene.each:
            scene.each(fmu)
        size = scene.end * (k + 1) / steps - fmu.time
        fmu.step(size)
        if readings or steps == 1:
            for name in (f"{contact}.{one}" for contact in scene.contacts for one in SUMS):
                if name in fmu:
                    sums[name] = sums.get(name, 0.0) + size * fmu[name]
            for name in (f"{contact}.{one}" for contact in scene.contacts for one in PEAKS):
                if name in fmu:
                    peaks[name] = max(peaks.get(name, 0.0), fmu[name])
    names = [f"{body}.{one}" for body in scene.bodies for one in BODY]
    names += [f"energy.{one}" for one in ENERGY]
    names += [f"{contact}.{one}" for contact in scene.contacts for one in CONTACT]
    return {name: fmu[name] for name in names if name in fmu} | sums | peaks


def _scale(scene, name, right):
    last = name.split(".")[1]
    least = scene.floor.get(last, (BODY | CONTACT).get(last, 1.0))
    return max(least, float(np.max(np.abs(right))))


def disagreements(opened, scene, random, runs=5):
    """Returns lines about what differs, and the worst ratio of a difference to what is allowed."""
    fmu = opened(scene.fmu)
    right = answer(fmu, scene, TIGHTEST, 1, readings=True)
    lines, worst = [], 0.0
    for _ in range(runs):
        tolerance, steps = float(random.choice(TOLERANCES)), int(random.choice(STEPS))
        readings = bool(random.integers(2))
        for name, value in answer(fmu, scene, tolerance, steps, readings).items():
            allowed = scene.slack * max(tolerance, 1e-11) * _scale(scene, name, right[name])
            off = float(np.max(np.abs(np.asarray(value, float) - np.asarray(right[name], float))))
            worst = max(worst, off / allowed) if off == off else np.inf
            if not off <= allowed:
                lines.append(
                    f"{name}: {value} at tolerance {tolerance:g} in {steps} steps, readings {readings}; "
                    f"{right[name]} in one step at {TIGHTEST:g}; off by {off:.3g}, allowed {allowed:.3g}"
                )
    return lines, worst


def check_agreement(opened, scene, seed, runs=5):
    """Fails with every quantity that differs, and all values of the scene."""
    lines, _ = disagreements(opened, scene, np.random.default_rng([seed, 1]), runs)
    assert not lines, "\n".join([*lines, f"{scene.fmu} {scene.values} end {scene.end}"])
