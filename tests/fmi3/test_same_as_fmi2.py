"""The FMI 3.0 FMU tells what the FMI 2.0 FMU of its scene tells, bit by bit, at every communication point."""

import numpy as np
import pytest
from fmpy.fmi2 import fmi2LastSuccessfulTime

from contact_fmus.fmu.contact_fmu import ContactFmu
from contact_fmus.fmu.files import fmu_file
from contact_fmus.fmu.variables import item_value
from support.checks import start
from support.fmi3 import raw
from support.scenes.random_scenes import KINDS, random_scene

PAIRS = {"sphere": "SphereSphere", "cylinder": "SphereCylinder", "plane": "SpherePlane"}
CASES = [(shape, kind) for shape, kinds in KINDS.items() for kind in kinds]
TOLERANCE = 1e-9
STEPS = 17
SEED = 500  # of scenes that no other test has


def numbers(value):
    return np.ravel(np.asarray(value, float)).tobytes()


def scalars(arrays):
    """Value references of all components, which FMI 2.0 has"""
    return [one.reference + k for one in arrays for k in range(one.length)]


def value_of(second, name):
    """Bytes of a value of FMI 2.0; of an enumeration the number"""
    value = second[name]
    return numbers(item_value(second.variables[name], value) if isinstance(value, str) else value)


def differing(second, third):
    """Names of outputs and calculated parameters whose bits differ"""
    names = [one.name for one in third.fmu.select("output", "calculatedParameter")]
    return [name for name in names if value_of(second, name) != numbers(third.get(name))]


@pytest.mark.parametrize("shape, kind", CASES)
def test_random_scenes_are_the_same_bits(opened, shape, kind, method):
    values, end = random_scene(shape, kind, SEED + len(method))
    values = {name: value for name, value in values.items() if not name.endswith(".derivatives")}
    values |= {"solver.method": method, "solver.max_internal_steps": 300_000}
    second = start(opened(PAIRS[shape]), values, TOLERANCE)
    with raw.Instance(raw.load(PAIRS[shape])) as third:
        third.initialize(values, TOLERANCE)
        assert differing(second, third) == []
        for k in range(STEPS):
            time = second.time
            size = end * (k + 1) / STEPS - time
            second.step(size)
            told = third.step(time, size)
            assert (told.status, told.event, told.terminate, told.early) == (raw.OK, False, False, False)
            assert told.time == time + size
            assert told.time == second.call("getRealStatus", fmi2LastSuccessfulTime)
            assert differing(second, third) == [], f"after step {k + 1}"


@pytest.mark.parametrize("scene", raw.ALL)
def test_inputs_that_change_give_the_same_bits(scene):
    """Each scene as it is shipped, with every input that it has moving at each communication point."""
    random = np.random.default_rng(len(scene))
    with ContactFmu(fmu_file(scene)) as second, raw.Instance(raw.load(scene)) as third:
        second.start({})
        third.initialize()
        for _ in range(12):
            for variable in third.fmu.select("input"):
                value = random.uniform(-0.1, 0.1, variable.length).tolist()
                second[variable.name] = value
                third.set({variable.name: value})
            time = second.time
            second.step(0.01)
            assert third.step(time, 0.01).status == raw.OK
            assert differing(second, third) == []


@pytest.mark.parametrize("scene", raw.ALL)
def test_derivatives_are_those_of_fmi2(scene):
    """Of outputs with respect to time, and with respect to inputs along a random direction."""
    random = np.random.default_rng(7)
    with ContactFmu(fmu_file(scene)) as second, raw.Instance(raw.load(scene)) as third:
        second.start({})
        third.initialize()
        second.step(0.02)
        third.step(0.0, 0.02)
        for variable in third.fmu.description.modelVariables:
            if variable.causality == "output" and variable.variability == "continuous":
                for order in (1, 2):
                    given = third.output_derivative(variable.name, order)
                    assert numbers(given) == numbers(second.derivative(variable.name, order))
        knowns = third.fmu.select("input")
        unknowns = third.fmu.select("output", kind="Float64")
        if knowns:
            seed = random.normal(size=sum(one.length for one in knowns))
            given = third.product("Directional", unknowns, knowns, seed)
            rows = [scalars(group) for group in (unknowns, knowns)]
            right = second.call("getDirectionalDerivative", *rows, seed.tolist())
            assert given.tobytes() == np.asarray(right, float).tobytes()
