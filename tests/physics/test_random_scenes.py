"""Random scenes of every kind against the independent integrator: motion, work, counts and times, with both
CVODE methods.
"""

from functools import cache

import pytest

from support.checks import METHODS, check_close, run
from support.reference.integrator import Reference
from support.scenes.random_scenes import DELICATE, SCENES, random_scene

ALLOWED = 1e-6  # m, m/s and J, at tolerance 1e-10
FMU = {"sphere": "SphereSphere", "cylinder": "SphereCylinder"}


@cache
def reference(shape, kind, seed):
    configuration, end = random_scene(shape, kind, seed)
    return Reference(configuration, shape).run(end)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("steps", [1, 10])
@pytest.mark.parametrize("shape, kind, seed", SCENES)
def test_motion_and_work_are_those_of_the_reference(opened, shape, kind, seed, steps, method):
    configuration, end = random_scene(shape, kind, seed)
    expected = reference(shape, kind, seed)
    fmu = run(opened(FMU[shape]), configuration, end, steps, method=method)
    for body in ("source", "destination"):
        check_close(f"{body}.position", fmu[f"{body}.position"], expected.position[body], ALLOWED)
        check_close(f"{body}.velocity", fmu[f"{body}.velocity"], expected.velocity[body], 10 * ALLOWED)
    assert fmu["contact.onsets"] == expected.onsets
    check_close("last_onset_time", fmu["contact.last_onset_time"], expected.onset_times[-1], ALLOWED)
    lasting = expected.touching and expected.within
    duration = end - expected.onset_times[-1] if lasting else expected.durations[-1]
    check_close("last_duration", fmu["contact.last_duration"], duration, ALLOWED)
    works = {"energy.contact": expected.stored_energy(), "energy.dissipated": expected.dissipated}
    for name, work in (works | {"energy.external_work": expected.external_work}).items():
        check_close(name, fmu[name], work, ALLOWED * max(1, abs(work)))


@pytest.mark.parametrize("shape, kind, seed", SCENES)
def test_mean_force_of_one_huge_step_is_the_impulse(opened, shape, kind, seed):
    configuration, end = random_scene(shape, kind, seed)
    fmu = run(opened(FMU[shape]), configuration, end, 1)
    expected = [impulse / end for impulse in reference(shape, kind, seed).impulse]
    check_close("contact.mean_force", fmu["contact.mean_force"], expected, 10 * ALLOWED)


@pytest.mark.parametrize("tolerance", [1e-8, 1e-9, 1e-10, 1e-11, 1e-12])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("shape, kind, seed", DELICATE)
def test_no_tolerance_finds_another_motion(opened, shape, kind, seed, method, tolerance):
    """A wrong branch after a switch does not care for tolerances; it comes and goes with them."""
    configuration, end = random_scene(shape, kind, seed)
    fmu = run(opened(FMU[shape]), configuration, end, 1, tolerance, method)
    position = reference(shape, kind, seed).position["source"]
    check_close("source.position", fmu["source.position"], position, max(ALLOWED, 1e3 * tolerance))
