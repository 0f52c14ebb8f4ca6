"""Communication points end no phase of motion: steps within a phase are computed when they are read.

Whoever reads, and when, gets the same bits, in contact as in flight, with and without rotation and
friction, and a saved state goes on with the same bits."""

import random

import pytest

from contact_fmus.bench.problems import benchmarks, law_benchmarks, turning_problems
from support.fmi2 import raw

PROBLEMS = {**benchmarks(), **law_benchmarks(), **turning_problems()}
STEPS = 61


def start(name, steps):
    problem = PROBLEMS[name]
    instance = raw.Instance(raw.load(problem.fmu))
    instance.initialize(problem.start, tolerance=1e-9)
    return instance, problem.stop / steps


def step(instance, size, index):
    instance.ok("DoStep", size * index, size, 1)


@pytest.mark.parametrize("name", PROBLEMS)
def test_reading_changes_no_bit_and_shows_the_step_before(name):
    """One instance is read after each step, one now and then, one at the end alone."""
    draw = random.Random(name)
    instances = [start(name, STEPS) for _ in range(3)]
    always, sometimes, never = (instance for instance, _ in instances)
    size = instances[0][1]
    with always, sometimes, never:
        for index in range(STEPS):
            for instance in (always, sometimes, never):
                step(instance, size, index)
            shown = always.bits("output")
            if draw.random() < 0.2:
                assert sometimes.bits("output") == shown, index
        assert never.bits("output") == always.bits("output") == sometimes.bits("output")


@pytest.mark.parametrize("name", PROBLEMS)
def test_a_state_saved_within_a_phase_goes_on_with_the_same_bits(name):
    """The state is saved while steps are deferred, and goes on in an instance that has made no such step: one
    that has made others, or one that has not been initialized."""
    draw = random.Random(name)
    (saved, size), (other, _) = start(name, STEPS), start(name, STEPS)
    with saved, other:
        for index in range(STEPS):
            step(saved, size, index)
            if draw.random() < 0.2:
                state = saved.save()
                other.restore(state)
                with raw.Instance(other.fmu) as fresh:
                    fresh.restore(state)
                    assert fresh.bits("output") == other.bits("output") == saved.bits("output"), index
            elif index:
                step(other, size, index)
            else:
                other.restore(saved.save())
        assert other.bits("output") == saved.bits("output")


@pytest.mark.parametrize("name", PROBLEMS)
def test_steps_add_up(name):
    """The impulses of all steps add up to that of one step over all of them, and its peak is the largest."""
    (one, whole), (many, size) = start(name, 1), start(name, STEPS)
    with one, many:
        step(one, whole, 0)
        impulse, peaks = [0.0, 0.0, 0.0], []
        for index in range(STEPS):
            step(many, size, index)
            mean = many.get("contact.mean_force")
            impulse = [before + size * part for before, part in zip(impulse, mean, strict=True)]
            peaks.append((many.get("contact.peak_force"), many.get("contact.peak_penetration")))
        force, depth = (max(values) for values in zip(*peaks, strict=True))
        expected = one.get("contact.peak_force")
        assert [part / whole for part in impulse] == pytest.approx(
            one.get("contact.mean_force"), rel=1e-7, abs=1e-7 * expected
        )
        assert force == pytest.approx(expected, rel=1e-7)
        assert depth == pytest.approx(one.get("contact.peak_penetration"), rel=1e-7)


@pytest.mark.parametrize("name", [name for name in PROBLEMS if name.startswith(("P3", "F"))])
def test_a_thousand_communication_steps_take_few_internal_steps_more(name):
    (one, whole), (many, size) = start(name, 1), start(name, 1000)
    with one, many:
        step(one, whole, 0)
        for index in range(1000):
            step(many, size, index)
        steps = one.get("solver.steps")
        # a step that is read must be ten times as exact within: of order eight, it is shorter by a third
        assert many.get("solver.steps") <= 10 ** (1 / 8) * steps + 2 * one.get("solver.events") + 4
