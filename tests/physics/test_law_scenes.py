"""Random scenes of planes, of Hertz's law and of restitution (support/scenes/law_scenes.py) with all methods,
against the reference in world coordinates."""

import numpy as np
import pytest

from contact_fmus.bench.problems import law_benchmarks
from support.checks import by_methods, differences, run
from support.reference import hertz
from support.scenes.agreement import seeds
from support.scenes.law_scenes import factors, law_scene

STEPS = (1, 3, 29)  # communication steps of a run, by the seed
# m, m/s, J; CVODE holds its tolerance of 1e-10 by the step, and its steps add up.
ALLOWED = {"event_driven": 1e-8, "cvode_bdf": 1e-6, "cvode_adams": 1e-6}
BALANCE = {"event_driven": 1e-10, "cvode_bdf": 1e-6, "cvode_adams": 1e-6}  # of the energy in play, or 1 J


def failures(fmu, scene, seed, method, reference, onsets):
    """Returns a line for each figure that is off."""
    _, values, end = scene
    state, events = reference
    totals, sizes = [], [1.0]

    def look(made):
        totals.append(made["energy.total"])
        sizes.append(abs(made["energy.kinetic"]) + abs(made["energy.external_work"]))

    run(fmu, values, end, STEPS[seed % 3], 1e-10, method, look)
    found = [fmu[f"{body}.{row}"] for row in ("position", "velocity") for body in ("source", "destination")]
    lines = differences("positions, velocities", np.concatenate(found), state[:12], ALLOWED[method])
    lines += differences("dissipated", fmu["energy.dissipated"], state[12], ALLOWED[method])
    balance = BALANCE[method] * max(sizes)
    lines += differences("energy.total", totals, [totals[0]] * len(totals), balance)
    if fmu["contact.onsets"] != onsets:
        lines.append(f"onsets: got {fmu['contact.onsets']}, expected {onsets}")
    if method == "event_driven":
        if fmu["solver.events"] != len(events):
            lines.append(f"events: got {fmu['solver.events']}, expected {len(events)}")
        if fmu["solver.fallbacks"] != 0:
            lines.append("left to CVODE")
    return lines


@pytest.mark.parametrize("seed", seeds(12))
def test_a_scene_goes_as_the_reference_says(opened, seed):
    scene = law_scene(seed)
    pair, state = hertz.pair_of(*scene[:2], *factors(*scene[:2]))
    reference = hertz.run(pair, state, scene[2])
    first = hertz.precise(pair).begins(np.array(state, np.longdouble))[1]
    branches = [first, *(name for _, name in reference[1])]  # a contact may begin before the start
    onsets = sum(a == hertz.APART != b for a, b in zip([hertz.APART, *branches], branches, strict=False))
    wrong = by_methods(lambda one: failures(opened(scene[0]), scene, seed, one, reference, onsets))
    assert not wrong, f"{wrong}\n{scene}"


def test_the_scenes_are_what_they_are_about():
    """The first 60 have both laws, all shapes, sides, motions and dashpots. Most have a contact."""
    scenes = [law_scene(seed) for seed in range(60)]
    kinds = {(name, values.get("contact.location"), values["contact.law"]) for name, values, _ in scenes}
    motions = {(values["source.motion"], values["destination.motion"]) for _, values, _ in scenes}
    dampings = {(values["contact.dashpot"], values["contact.viscous_control"]) for _, values, _ in scenes}
    assert (len(kinds), len(motions), len(dampings)) == (10, 4, 6)


@pytest.mark.parametrize("steps", [1, 997])
@pytest.mark.parametrize("name", law_benchmarks())
def test_the_benchmarks_by_hertz_on_a_plane_and_over_a_rim_end_at_their_references(opened, name, steps):
    problem = law_benchmarks()[name]
    fmu = run(opened(problem.fmu), problem.start, problem.stop, steps, 1e-9)
    assert problem.error(fmu["source.position"]) <= 1e-9
    assert fmu["solver.fallbacks"] == 0


@pytest.mark.parametrize("direction", [(0.0, 0.0, 1.0), (0.6, 0.0, 0.8), (0.48, 0.6, 0.64), (0.3, -0.2, 0.7)])
def test_a_ball_pushed_out_of_another_takes_what_was_stored(opened, direction):
    """Without gravity it moves along any line through the centres. Rounding across the line is no motion."""
    along = np.array(direction) / np.linalg.norm(direction)
    values = {"source.radius": 0.0102, "source.mass": 0.001, "source.motion": "free"}
    values |= {"source.center": [0.0, 0.0, 0.0], "destination.radius": 0.01, "destination.motion": "fixed"}
    values |= {"destination.center": (1e-3 * along).tolist(), "contact.location": "outside"}
    values |= {"contact.law": "hertz", "contact.hertz_stiffness": 3e4, "contact.method": "penalty"}
    values |= {"gravity": [0.0, 0.0, 0.0]}
    for steps in (1, 40):
        fmu = run(opened("SphereSphere"), values, 2e-3, steps, 1e-10)
        speed = np.sqrt(2 * 0.4 * 3e4 * 0.0192**2.5 / 0.001)
        assert np.allclose(fmu["source.velocity"], -speed * along, rtol=0, atol=1e-9 * speed)
        assert np.isclose(fmu["energy.total"], 0.4 * 3e4 * 0.0192**2.5, rtol=1e-11, atol=0)
