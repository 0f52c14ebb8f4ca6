"""One run of a scene that turns and rubs, compared with the reference in all that it says."""

import numpy as np

from contact_fmus.fmu.contact_fmu import FmuError
from support.checks import differences, start
from support.scenes.random_scenes import even

ALLOWED = {"event_driven": 1e-7, "cvode_bdf": 1e-5, "cvode_adams": 1e-5}
BALANCE = {"event_driven": 1e-9, "cvode_bdf": 1e-7, "cvode_adams": 1e-7}
TOLERANCE = 1e-10
MOST_STEPS = 300_000
TERMS = ("kinetic", "rotational", "potential", "contact", "tangential", "dissipated", "friction")
TERMS += ("external_work",)
BODIES = ("source", "destination")


class TurningFmuRun:
    """What is summed over the communication steps of a run."""

    def __init__(self, fmu, values, end, steps, method, tolerance=TOLERANCE):
        self.fmu = fmu
        self.impulses = {
            "force": np.zeros(3), "source_torque": np.zeros(3), "destination_torque": np.zeros(3),
        }  # fmt: skip
        start(fmu, {"solver.max_internal_steps": MOST_STEPS, **values}, tolerance, method)
        self.begin, self.stray, self.in_play = fmu["energy.total"], 0.0, 0.0
        self._look()
        for stop in even(end, steps):
            size = stop - fmu.time
            fmu.step(size)
            for name, sum_ in self.impulses.items():
                sum_ += size * fmu[f"contact.mean_{name}"]
            self._look()

    def _look(self):
        self.in_play = max(self.in_play, *(abs(self.fmu[f"energy.{name}"]) for name in TERMS))
        self.stray = max(self.stray, abs(self.fmu["energy.total"] - self.begin))


def failures(fmu, values, end, steps, method, expected):
    """Returns a line for each figure that is not as in `expected`, or for the refusal of the run."""
    try:
        run = TurningFmuRun(fmu, values, end, steps, method)
    except FmuError as error:
        return [f"refused at {fmu.time!r} s: {error}"]
    lines = []
    for name, (value, right, allowed) in rows(run, expected, ALLOWED[method]).items():
        lines += differences(name, value, right, allowed)
    lines += differences("energy balance", run.stray, 0.0, BALANCE[method] * max(1.0, run.in_play))
    if fmu["contact.onsets"] != expected["contact.onsets"]:
        lines.append(f"onsets: got {fmu['contact.onsets']}, expected {expected['contact.onsets']}")
    return lines


def rows(run, expected, allowed):
    """By name: value, right value, and how far off it may be."""
    fmu, found = run.fmu, {}
    energy = allowed * max(1.0, run.in_play)
    for body in BODIES:
        for name in ("position", "velocity", "angular_velocity", "orientation", "current_axis"):
            if f"{body}.{name}" in fmu:
                right = expected[f"{body}.{name}"]
                value = fmu[f"{body}.{name}"]
                if name == "orientation" and value @ right < 0:  # q and -q are the same rotation
                    value = -value
                found[f"{body}.{name}"] = value, right, allowed * max(1.0, float(np.linalg.norm(right)))
    for name in TERMS:
        found[f"energy.{name}"] = fmu[f"energy.{name}"], expected[f"energy.{name}"], energy
    impulses = {"force": "impulse", "source_torque": "source_torque_impulse"}
    for name, sum_ in run.impulses.items():
        right = expected[impulses.get(name, "destination_torque_impulse")]
        found[f"mean_{name}"] = sum_, right, allowed * max(1.0, float(np.linalg.norm(right)))
    for name in ("last_onset_time", "last_duration"):
        if f"contact.{name}" in expected:
            found[name] = fmu[f"contact.{name}"], expected[f"contact.{name}"], allowed
    return found
