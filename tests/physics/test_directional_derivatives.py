"""fmi2GetDirectionalDerivative of a force element: contact stiffness and damping against eighth-order
differences of the independent recomputation of reference/law.py in extended precision, on random
configurations.

Each is read after new inputs without a step, and in initialization mode, where the automatic factors follow
the start. A difference reaches over points of one regime only; where the steps for that would have to be too
small the configuration is left out, and no more than a few are.
"""

from dataclasses import replace

import numpy as np
import pytest

from support.checks import differences, start
from support.reference.law import REAL, Motion, ReferenceContact, norm, vector
from support.scenes.configurations import INPUTS, SHAPES, motion_of, random_configuration, random_inputs

COUNT = 60
RELATIVE = 1e-10
# Fornberg, Mathematics of Computation 51 (1988) 699: first derivative, order eight.
WEIGHTS = {1: REAL(4) / 5, 2: -REAL(1) / 5, 3: REAL(4) / 105, 4: -REAL(1) / 280}
FIELDS = {name: name.replace(".prescribed_", "_") for name in INPUTS}  # of Motion
UNKNOWNS = [f"contact.{name}" for name in (
    "gap", "gap_rate", "distance", "direction", "normal_force", "source_force", "destination_force", "point"
)]  # fmt: skip
FACTORS = [f"contact.{name}" for name in (
    "diagonal", "effective_penalty_factor", "effective_viscous_penalty_factor"
)]  # fmt: skip


def regime(contact, outputs):
    """What must not change between the points of a difference: overlap, extents, and how the dashpot acts"""
    touching, dashpot = outputs["contact.active"][0], contact.values["contact.dashpot"]
    acts = None
    if touching and dashpot == "approach_only":
        acts = bool(outputs["contact.gap_rate"][0] < 0)
    elif touching and dashpot == "non_adhesive":
        acts = bool(outputs["contact.normal_force"][0] > 0)
    return touching, acts, "contact.point" in outputs


def box_regime(contact, motion):
    """Which body's edges bound the box around both, direction by direction"""
    still = replace(motion, source_velocity=vector([0] * 3), destination_velocity=vector([0] * 3))
    apart, _ = contact.connection(still)
    reach = np.full(3, contact.destination_radius, dtype=REAL)
    if contact.axis is not None:
        reach = contact.destination_radius * np.sqrt(np.maximum(0, 1 - contact.axis**2))
        if contact.half_length is not None:
            reach = reach + contact.half_length * np.abs(contact.axis)
    return (*(apart + reach > contact.source_radius), *(apart - reach < -contact.source_radius))


class Reference:
    """Outputs at a motion, and their differences; `starting`: the motion is also the start."""

    def __init__(self, values, shape, starting):
        self.values, self.shape, self.starting = values, shape, starting
        self.contact = ReferenceContact(values, shape)

    def at(self, motion):
        if not self.starting:
            outputs = self.contact.evaluate(motion)
            return outputs, (regime(self.contact, outputs),)
        moved = {name: getattr(motion, field) for name, field in FIELDS.items()}
        contact = ReferenceContact({**self.values, **moved}, self.shape)
        outputs = {**contact.evaluate(motion), **contact.constants()}
        return outputs, (regime(contact, outputs), contact.location, box_regime(contact, motion))

    def column(self, motion, known, component, step):
        """Output name -> difference quotient, or None where the regime changes on the way"""
        here, kind = self.at(motion)
        sums = {name: 0 * value for name, (value, size) in here.items() if size is not None}
        for reach, weight in WEIGHTS.items():
            for sign in (1, -1):
                values = getattr(motion, FIELDS[known]).copy()
                values[component] += sign * reach * step
                outputs, other = self.at(replace(motion, **{FIELDS[known]: values}))
                if other != kind:
                    return None
                for name in sums:
                    sums[name] = sums[name] + sign * weight * outputs[name][0]
        return {name: value / step for name, value in sums.items()}

    def jacobian(self, motion, known):
        """Output name -> matrix, or None"""
        distance = self.contact.separation(motion)[0]
        scale = distance if known.endswith("displacement") else REAL(1)
        for fraction in (1e-2, 1e-3, 1e-5, 1e-7):
            columns = [self.column(motion, known, k, REAL(fraction) * scale) for k in range(3)]
            if None not in columns:
                names = columns[0]
                return {name: np.array([np.atleast_1d(c[name]) for c in columns]).T for name in names}
        return None


def wrong_in(fmu, reference, motion, known, unknowns):
    """What differs in one block of columns; None where the reference has no difference"""
    expected = reference.jacobian(motion, known)
    if expected is None:
        return None
    outputs, _ = reference.at(motion)
    distance, _, _, length = reference.contact.separation(motion)
    distance = abs(distance)  # below a plane it is negative
    wrong = []
    for name in unknowns:
        if name in fmu and name in expected:
            size = np.max(np.abs(expected[name])) * (1 + length / distance)
            speed = norm(motion.destination_velocity - motion.source_velocity)
            size += outputs[name][1] / (
                distance if known.endswith("displacement") else max(speed, REAL(1e-3))
            )
            wrong += differences(f"d {name} / d {known}", fmu.jacobian(name, known).ravel(),
                                 expected[name].ravel(), RELATIVE * size)  # fmt: skip
    return wrong


def configuration(random, name):
    values, inside = random_configuration(random, SHAPES[name])
    if name == "ForceElement":  # pinned
        pinned = {"contact.penalty_control": "user_defined", "contact.viscous_control": "user_defined"}
        values.update(pinned, **{"contact.method": "penalty_dynamic"})
    return values, inside


def enter(fmu, values):
    """As far as initialization mode"""
    fmu.reset()
    fmu.call("setupExperiment", None, 0.0, None)
    for name, value in values.items():
        if name in fmu:
            fmu[name] = value
    fmu.call("enterInitializationMode")


def compare(fmu, name, seed, starting):
    random = np.random.default_rng(seed)
    left_out = 0
    seen = set()
    for k in range(COUNT):
        values, inside = configuration(random, name)
        reference = Reference(values, SHAPES[name], starting)
        if starting:
            motion = motion_of(values)
            enter(fmu, values)
        else:
            inputs = random_inputs(random, values, SHAPES[name], inside, 1.0)
            motion = motion_of(inputs)
            start(fmu, {key: value for key, value in values.items() if key in fmu})
            for key in INPUTS:
                fmu[key] = inputs[key]
        for known in INPUTS:
            found = wrong_in(fmu, reference, motion, known, UNKNOWNS + FACTORS * starting)
            left_out += found is None
            assert not found, f"configuration {k} of seed {seed}: {values}\n" + "\n".join(found)
        seen.add((fmu["contact.normal_force"] > 0, fmu["contact.active"]))
    assert seen >= {(False, False), (True, True), (False, True)}
    assert left_out <= 0.05 * COUNT * len(INPUTS)


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("name", SHAPES)
def test_stiffness_and_damping_are_those_of_the_law(opened, name, seed):
    compare(opened(name), name, seed, starting=False)


@pytest.mark.parametrize("name", SHAPES)
def test_until_the_end_of_initialization_the_automatic_factors_follow(opened, name):
    compare(opened(name), name, seed=3, starting=True)


def test_a_motion_has_the_fields_of_the_inputs():
    assert set(FIELDS.values()) == set(Motion.__dataclass_fields__)
