"""Parameters that make the work unbounded: solver.max_internal_steps ends the step with fmi2Discard at the
time reached, with a state that is whole and can go on; what cannot be computed is never answered wrongly."""

import math

import numpy as np
import pytest
from fmpy import fmi2
from mpmath import mpf, workdps

from contact_fmus.fmu.contact_fmu import FmuError, Status
from support.checks import check_close, start
from support.reference.plane_motion import plane_motion
from support.scenes.benchmarks import BENCHMARKS

METHOD, TOLERANCE = "event_driven", 1e-12
LIMIT = 20_000
SHELL = {"destination.radius": 0.5, "source.center": [0.1, 0.0, 0.0], "contact.location": "inside"}
SHELL |= {"contact.method": "penalty", "contact.penalty_factor": 1e13, "gravity": [0.0, 0.0, 0.0]}
DROP = {"source.center": [0.0, 0.0, 1.1], "contact.method": "penalty"}
DAMPED_DROP = {"source.center": [0.0, 0.0, 1.1], "contact.method": "penalty_dynamic"}
UNBOUNDED = {
    # configuration and the communication step
    "1e9 bounces across": ({**SHELL, "source.initial_velocity": [1e6, 0.0, 0.0]}, 800.0),
    "1e9 bounces around": ({**SHELL, "source.initial_velocity": [1e6, 3e5, 2e5]}, 800.0),
    "1e9 hops": ({**DROP, "source.center": [0, 0, 0.6 + 1e-9], "contact.penalty_factor": 1e13}, 3e4),
    "contact time below that of time": ({**DROP, "contact.penalty_factor": 1e40}, 1e3),
    "a penalty factor at the end of its range": ({**DROP, "contact.penalty_factor": 1e150}, 1e3),
    "a damped one": ({**DAMPED_DROP, "contact.penalty_factor": 1e40, "contact.viscous_penalty_factor": 1e20},
        1e3),
    "a dashpot without spring": ({**DAMPED_DROP, "contact.penalty_control": "viscous_only",
        "contact.viscous_penalty_factor": 1e40}, 1e3),
    "at rest on a rock": ({**DAMPED_DROP, "source.center": [0, 0, 0.6], "contact.penalty_factor": 1e30}, 1e3),
}  # fmt: skip


def limited(fmu, configuration, limit=LIMIT):
    return start(fmu, {**configuration, "solver.max_internal_steps": limit}, TOLERANCE, METHOD)


def mechanical(fmu):
    return fmu["energy.total"] - fmu["energy.dissipated"]


def stepped(fmu, size):
    """The status of one step: done, or discarded at the limit"""
    try:
        fmu.step(size)
    except FmuError as error:
        return error.status
    return Status.OK


def everything(fmu):
    """Every Real output, and the counters"""
    names = [v.name for v in fmu.variables.values() if v.causality == "output" and v.type == "Real"]
    return {name: fmu[name] for name in [*names, "contact.onsets", "solver.steps"]}


def discarded(fmu, size):
    """One step that is expected to reach the limit; how far it got and what was said"""
    before = fmu.time
    with pytest.raises(FmuError) as caught:
        fmu.step(size)
    assert caught.value.status == Status.DISCARD
    assert before <= fmu.time < before + size
    assert fmu.slave.getStatus(fmi2.fmi2DoStepStatus) == Status.DISCARD
    return caught.value.messages


@pytest.mark.parametrize("case", UNBOUNDED)
def test_the_work_is_bounded_and_nothing_breaks(opened, case):
    """The step is done after all, or discarded at a time in between; then the same call goes on."""
    configuration, size = UNBOUNDED[case]
    fmu = limited(opened("SphereSphere"), configuration)
    energy = mechanical(fmu)
    slack = 1e-9 * (1 + fmu["energy.kinetic"] + abs(fmu["energy.potential"]))
    reached, done = [0.0], 0
    for _ in range(5):
        assert stepped(fmu, size - fmu.time) in (Status.OK, Status.DISCARD)
        assert reached[-1] < fmu.time <= size
        reached.append(fmu.time)
        assert 0 <= fmu["solver.steps"] - done <= LIMIT
        done = fmu["solver.steps"]
        for name, value in everything(fmu).items():
            assert np.all(np.isfinite(value)), f"{name} = {value}"
        assert mechanical(fmu) <= energy + slack
        check_close("energy.total", fmu["energy.total"], energy, 10 * slack)
        if fmu.time == size:
            break


def test_the_message_says_how_far_and_the_bounces_so_far_are_those_of_the_closed_form(opened):
    """Head-on through the middle of the shell: 0.8 m and a contact of pi sqrt(m / p_n) each time"""
    configuration, size = UNBOUNDED["1e9 bounces across"]
    fmu = limited(opened("SphereSphere"), configuration)
    text = " ".join(message.text for message in discarded(fmu, size))
    for word in ("800", f"{fmu.time!r} s", "solver.max_internal_steps", str(LIMIT), "smaller", "larger"):
        assert word in text
    speed, contact = 1e6, math.pi / math.sqrt(1e13)
    period, first = 0.8 / speed + contact, 0.3 / speed
    expected = math.floor((fmu.time - first) / period + 1e-6) + 1
    assert abs(fmu["contact.onsets"] - expected) <= (1 if expected < 10 else 0)
    last = first + (fmu["contact.onsets"] - 1) * period
    check_close("last_onset_time", fmu["contact.last_onset_time"], last, 1e-9 * last)


def test_what_happened_in_a_discarded_step_is_told_of_the_part_done(opened):
    """The mean force is over the time from the step's start to the time reached."""
    configuration = {**DROP, "source.center": [0.01, 0.02, 0.7], "gravity": [0.0, 0.0, -9.81]}
    fmu = limited(opened("SphereSphere"), configuration, limit=2)
    speed = fmu["source.velocity"]
    discarded(fmu, 1.0)
    assert fmu["contact.onsets"] >= 1
    impulse = fmu["source.velocity"] - speed - fmu.time * np.array([0.0, 0.0, -9.81])
    check_close("mean_force", fmu["contact.mean_force"] * fmu.time, impulse, 1e-12)


@pytest.mark.parametrize("way", ["the same step again", "smaller steps", "a larger limit", "a fresh run"])
@pytest.mark.parametrize("name", BENCHMARKS)
def test_going_on_after_a_discard_changes_nothing(opened, name, way):
    problem = BENCHMARKS[name]
    fmu = start(opened(problem.fmu), problem.configuration, TOLERANCE, METHOD)
    fmu.step(problem.end)
    whole, work = everything(fmu), fmu["solver.steps"]
    fmu = limited(opened(problem.fmu), problem.configuration, max(3, work // 7))
    discarded(fmu, problem.end)
    if way == "a larger limit":
        fmu["solver.max_internal_steps"] = 10 * work + 100
        fmu.step(problem.end - fmu.time)
    if way == "a fresh run":  # with a larger limit
        fmu = limited(opened(problem.fmu), problem.configuration, 10 * work + 100)
        fmu.step(problem.end)
    size, discards = problem.end / 40 if way == "smaller steps" else problem.end, 0
    while fmu.time < problem.end:
        status = stepped(fmu, min(size, problem.end - fmu.time))
        assert status in (Status.OK, Status.DISCARD)
        discards += status == Status.DISCARD
        assert discards < 20
    parts = everything(fmu)
    assert parts["contact.onsets"] == whole["contact.onsets"]
    for key in ("source.position", "source.velocity", "energy.total", "energy.dissipated"):
        check_close(key, parts[key], whole[key], 1e-10)
    for key in ("contact.last_onset_time", "contact.last_duration"):
        check_close(key, parts[key], whole[key], 1e-10)


def test_a_discarded_state_is_saved_and_goes_on_elsewhere(opened):
    problem = BENCHMARKS["P3b"]
    fmu = limited(opened(problem.fmu), problem.configuration, 50)
    discarded(fmu, problem.end)
    state, time = fmu.save(), fmu.time
    ends = []
    for _ in range(2):
        while fmu.time < problem.end:
            assert stepped(fmu, problem.end - fmu.time) in (Status.OK, Status.DISCARD)
        ends.append(everything(fmu))
        fmu.restore(state)
        assert fmu.time == time
    assert {k: np.asarray(v).tobytes() for k, v in ends[0].items()} == {
        k: np.asarray(v).tobytes() for k, v in ends[1].items()
    }
    check_close("position", ends[0]["source.position"], problem.position, 1e-9)


@pytest.mark.parametrize("begin", [0.0, 1e9])
@pytest.mark.parametrize("stiffness", [1e12, 1e15, 1e18, 1e20, 1e22, 1e24, 1e26, 1e28, 1e30, 1e40, 1e150])
def test_an_impact_is_right_or_refused_however_short_it_is(opened, stiffness, begin):
    """Down to contacts that last no longer than the last digit of the time, and are no deeper than the last
    digit of the radius; at a late time as at zero."""
    fmu = opened("SphereSphere")
    values = {**DROP, "contact.penalty_factor": stiffness, "solver.max_internal_steps": LIMIT}
    fmu.start({**values, "solver.method": METHOD}, start_time=begin)
    energy = fmu["energy.total"]
    status = stepped(fmu, 0.5)
    if status != Status.OK:
        assert status == Status.DISCARD
        check_close("energy.total", fmu["energy.total"], energy, 1e-9)
        return
    with workdps(200):  # at 1e150 N/m the contact lasts 1e-75 s
        right = plane_motion(mpf(1.1) - mpf(0.1) - mpf(0.5), 0, -9.81, 1, stiffness, 0, "unclamped", 0.5)
        lasts, expected = right.end_times[0] - right.onset_times[0], mpf(0.1) + mpf(0.5) + right.place
    check_close("height", fmu["source.position"][2], float(expected), 1e-9)
    check_close("energy.total", fmu["energy.total"], energy, 1e-8)
    assert fmu["contact.onsets"] == 1
    check_close("last_duration", fmu["contact.last_duration"], float(lasts), 1e-3 * float(lasts) + 1e-15)


LEAST_WORK = 2_000_000  # integrator/phases.c
EVALUATION_WORK = 6  # integrator/phases.h
HOPS = {"source.rotation": "free", "contact.friction": "regularized", **DROP, "source.center": [0, 0, 0.65]}


def test_evaluations_of_the_general_segment_end_a_step_as_internal_steps_do(opened):
    """A ball that turns and bounces without damping: a hundred evaluations an internal step"""
    fmu = limited(opened("SphereSphere"), HOPS, limit=1_000_000)
    said = " ".join(message.text for message in discarded(fmu, 1e9))
    assert "solver.max_internal_steps = 1000000 are used up, by number or by work" in said
    assert fmu["solver.steps"] + fmu["solver.events"] < 1_000_000
    most = LEAST_WORK // EVALUATION_WORK
    assert 0.9 * most <= fmu["solver.force_evaluations"] <= most + 10_000
    time = fmu.time
    fmu.step(1.0)  # from there it goes on
    assert fmu.time > time


def test_a_larger_limit_than_the_start_value_allows_more_evaluations(opened):
    fmu = opened("SphereSphere")
    fmu.start({})
    assert fmu["solver.max_internal_steps"] == LEAST_WORK
    limit = 2 * LEAST_WORK
    fmu = limited(fmu, HOPS, limit)
    discarded(fmu, 1e9)
    assert fmu["solver.force_evaluations"] > LEAST_WORK // EVALUATION_WORK + 100_000
    assert fmu["solver.force_evaluations"] <= limit // EVALUATION_WORK + 10_000


BOWL = {**SHELL, "gravity": [0.0, 0.0, -9.81], "source.center": [0.2, 0.0, -0.34]}
ENDLESS = {
    # one step of 1e9 s; how many internal steps and events each may take at most
    "a ball that bounces on a plane": ("SpherePlane", DROP, METHOD, LEAST_WORK),
    "a ball that bounces on a hollow": ("SphereSphere",
        {**BOWL, "contact.penalty_factor": 1e6, "source.initial_velocity": [1.0, 0.3, 0.2]}, METHOD,
        LEAST_WORK // 3),
    "a ball that swings in a bowl": ("SphereSphere",
        {**BOWL, "contact.penalty_factor": 1e6, "contact.method": "penalty_dynamic"}, METHOD,
        LEAST_WORK // 40),
    "a ball that bounces by CVODE": ("SpherePlane", DROP, "cvode_bdf", LEAST_WORK // 20),
}  # fmt: skip


@pytest.mark.parametrize("case", ENDLESS)
def test_an_endless_step_is_ended_by_its_work(opened, case):
    """What takes more instructions a step is ended after fewer steps, each case within about a second."""
    name, configuration, method, most = ENDLESS[case]
    fmu = start(opened(name), {**configuration, "solver.max_internal_steps": LEAST_WORK}, TOLERANCE, method)
    discarded(fmu, 1e9)
    assert most / 2 <= fmu["solver.steps"] + fmu["solver.events"] <= most + 1


def test_a_small_limit_counts_internal_steps_alone(opened):
    fmu = limited(opened("SphereSphere"), HOPS)
    fmu.step(500.0)
    assert fmu["solver.steps"] + fmu["solver.events"] < LIMIT < fmu["solver.force_evaluations"]
