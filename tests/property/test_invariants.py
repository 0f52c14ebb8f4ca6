"""What holds in every scene: no pull, action and reaction, steps may be cut, fixed is prescribed at rest."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from support.checks import FMU, METHODS, check_close, run, start
from support.scenes.strategies import BOUNDED, RESULTS, build, scenes

ENDS = ["source.position", "source.velocity", "destination.position", "destination.velocity"]
ALLOWED = 1e-7


def ends_of(fmu, names):
    return {name: fmu[name] for name in names}


def check_same(ends, expected):
    for name in expected:
        check_close(name, ends[name], expected[name], ALLOWED)


@pytest.mark.parametrize("motion", ["fixed", "prescribed", "free"])
@pytest.mark.parametrize("location", ["outside", "inside"])
@pytest.mark.parametrize("shape", FMU)
def test_nearly_all_scenes_touch(opened, shape, location, motion):
    """Without contacts the claims below say nothing."""
    touched = 0
    for seed in range(20):
        scene = build(shape, location, "penalty_dynamic", "unclamped", motion, seed)
        touched += run(opened(FMU[shape]), scene.configuration, scene.end, 1)["contact.onsets"] >= 1
    assert touched >= 14, touched


def check_action_and_reaction(fmu):
    """To the last bit, along the contact direction, with the size of the normal force"""
    force, reaction = fmu["contact.source_force"], fmu["contact.destination_force"]
    assert np.array_equal(force, -reaction), (force, reaction)
    size = abs(fmu["contact.normal_force"])
    check_close("size of the force", np.linalg.norm(force), size, 1e-14 * size)
    check_close("force across e_c", np.cross(force, fmu["contact.direction"]), np.zeros(3), 1e-14 * size)
    assert fmu["contact.active"] or size == 0
    assert fmu["contact.active"] == (fmu["contact.gap"] < 0)


def check_push(fmu, outside):
    assert fmu["contact.normal_force"] >= 0, fmu["contact.normal_force"]
    away = fmu["source.position"] - fmu["destination.position"]
    if "destination.axis" in fmu:
        axis = np.array(fmu["destination.axis"]) / np.linalg.norm(fmu["destination.axis"])
        away = away - (away @ axis) * axis
    push = fmu["contact.source_force"] @ (away if outside else -away)
    assert push >= 0, f"pulled towards the wall: {push}"


TERMS = [f"energy.{name}" for name in ("kinetic", "potential", "contact", "dissipated", "external_work")]
BALANCE = 1e-8  # of the largest term, at tolerance 1e-10


def check_energy(fmu, values, seen):
    """The total is that of its terms and stays; what is dissipated never falls, and is nothing for a spring
    alone. Where a cylinder ends the energy of the spring comes and goes at once."""
    terms = {name: fmu[name] for name in TERMS}
    size, lost = max(map(abs, terms.values())), terms["energy.dissipated"]
    total = sum(terms.values()) - 2 * terms["energy.external_work"]
    check_close("energy.total against its terms", fmu["energy.total"], total, 1e-14 * size)
    slack = BALANCE * max([size, *(largest for _, _, largest in seen)])
    for begin, _, _ in seen[:1]:
        check_close("energy.total along the run", total, begin, slack)
    if not values.get("destination.finite_length"):
        assert lost >= max((before for _, before, _ in seen), default=0.0) - slack
        assert values["contact.method"] != "penalty" or abs(lost) <= slack
    seen.append((total, lost, size))


@pytest.mark.parametrize("method", METHODS)
@BOUNDED
@given(scene=scenes())
def test_all_outputs_are_numbers_and_forces_those_of_a_contact(opened, method, scene):
    """Action equals reaction; a non-adhesive contact never pulls; outputs are numbers; no energy is lost."""
    fmu, values = opened(FMU[scene.shape]), scene.configuration
    outputs = [name for name, one in fmu.variables.items() if (one.causality, one.type) == ("output", "Real")]
    assert len(outputs) > 20
    looks, energies = itertools.count(), []

    def check(fmu):
        check_action_and_reaction(fmu)
        if values["contact.dashpot"] == "non_adhesive" or values["contact.method"] == "penalty":
            check_push(fmu, values["contact.location"] == "outside")
        if next(looks) % 10:
            return
        check_energy(fmu, values, energies)
        for name in outputs:
            assert np.all(np.isfinite(fmu[name])), f"{name} = {fmu[name]}"

    run(fmu, values, scene.end, 50, method=method, each=check)


@pytest.mark.parametrize("method", METHODS)
@BOUNDED
@given(scene=scenes(), cuts=st.lists(st.floats(0.001, 0.999), max_size=12))
def test_communication_steps_may_be_cut_anywhere(opened, method, scene, cuts):
    fmu = run(opened(FMU[scene.shape]), scene.configuration, scene.end, 1, method=method)
    names = [*ENDS, "energy.dissipated", "contact.onsets", "contact.last_duration", "contact.last_onset_time"]
    whole = ends_of(fmu, names)
    impulse = fmu["contact.mean_force"] * scene.end
    start(fmu, scene.configuration, 1e-10, method)
    pieces = np.zeros(3)
    for cut in [*sorted(set(cuts)), 1.0]:
        size = cut * scene.end - fmu.time
        fmu.step(size)
        pieces += size * fmu["contact.mean_force"]
    check_same(ends_of(fmu, names), whole)
    check_close("sum of the impulses", pieces, impulse, ALLOWED)


@pytest.mark.parametrize("method", METHODS)
@BOUNDED
@given(scene=scenes(motions=["fixed"]))
def test_fixed_and_prescribed_at_rest_are_the_same(opened, method, scene):
    ends = []
    for motion in ("fixed", "prescribed"):
        values = {**scene.configuration, "destination.motion": motion}
        fmu = run(opened(FMU[scene.shape]), values, scene.end, 2, method=method)
        ends.append(ends_of(fmu, [*ENDS, *RESULTS]))
    check_same(ends[1], ends[0])


@pytest.mark.parametrize("method", METHODS)
@BOUNDED
@given(scene=scenes(motions=["fixed", "free"]), speed=st.sampled_from([0.5, -3.0]))
def test_the_same_motion_is_seen_from_a_moving_frame(opened, method, scene, speed):
    """Galilei: all bodies get the same velocity; a fixed destination becomes a prescribed one."""
    drift = speed * np.array([0.6, -0.48, 0.64])
    values = dict(scene.configuration)
    moving = dict(values)
    moving["source.initial_velocity"] = (np.array(values["source.initial_velocity"]) + drift).tolist()
    if values["destination.motion"] == "free":
        velocity = np.array(values["destination.initial_velocity"])
        moving["destination.initial_velocity"] = (velocity + drift).tolist()
    else:
        moving.update({"destination.motion": "prescribed", "destination.prescribed_velocity": drift.tolist()})
    names = [*ENDS, *RESULTS]
    still = ends_of(run(opened(FMU[scene.shape]), values, scene.end, 1, method=method), names)
    again = ends_of(run(opened(FMU[scene.shape]), moving, scene.end, 1, method=method), names)
    for name in ENDS:
        again[name] = again[name] - (drift * scene.end if name.endswith("position") else drift)
    check_same(again, still)
