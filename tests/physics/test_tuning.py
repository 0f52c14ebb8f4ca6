"""Parameters that are set between steps: taken over at the communication point, their work booked."""

import functools

import numpy as np
import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError, Status
from support.checks import check_close, run, start
from support.reference.integrator import TunedMotion

STEP = 5e-4  # s
POSITION, VELOCITY = [0.02, 0.01, 0.6015], [0.1, 0.0, -1.0]
LAW = {"contact.penalty_factor": 1e5, "contact.viscous_penalty_factor": 60.0, "gravity": [0.0, 0.0, -9.81]}
BALL = {"source.center": POSITION, "source.initial_velocity": VELOCITY, **LAW}
# The ball touches after 1.8 ms, is deepest after 6.3 ms and gone after 12 ms.
CHANGES = {
    "in flight": {1e-3: {"contact.penalty_factor": 3e5, "gravity": [0.3, 0.0, -40.0]}},
    "in compression": {4e-3: {"contact.penalty_factor": 4e5, "contact.viscous_penalty_factor": 5.0}},
    "in restitution": {8e-3: {"contact.penalty_factor": 2e4, "gravity": [0.0, 2.0, 0.0]}},
    "until it would pull, and back": {8.5e-3: {"contact.viscous_penalty_factor": 900.0},
        9.5e-3: {"contact.viscous_penalty_factor": 2.0}},
    "without damping": {3e-3: {"contact.viscous_penalty_factor": 0.0}, 5e-3: LAW},
    "no spring": {4e-3: {"contact.penalty_factor": 0.0}, 6e-3: {"contact.penalty_factor": 2e5}},
    "another dashpot": {8e-3: {"contact.dashpot": "approach_only", "contact.viscous_penalty_factor": 500.0},
        9e-3: {"contact.dashpot": "unclamped"}, 10e-3: {"contact.dashpot": "non_adhesive"}},
}  # fmt: skip
# m: the tolerance asked for, 1e-10, times what the impact makes of it
ALLOWED = {"event_driven": 1e-12, "cvode_bdf": 2e-9, "cvode_adams": 2e-9}


def tuned(fmu, changes, steps=60):
    for k in range(steps):
        for name, value in next((v for t, v in changes.items() if round(t / STEP) == k), {}).items():
            fmu[name] = value
        fmu.step((k + 1) * STEP - fmu.time)
    return fmu


@functools.cache
def reference(when, dashpot):
    motion = TunedMotion({**LAW, "contact.dashpot": dashpot}, POSITION, VELOCITY)
    for time, changes in CHANGES[when].items():
        motion.run(time).change(changes)
    return motion.run(60 * STEP)


def everything(fmu):
    return {
        name: np.asarray(fmu[name]).tobytes()
        for name, one in fmu.variables.items()
        if one.causality == "output"
    }


@pytest.mark.parametrize("when", CHANGES)
def test_a_run_goes_on_as_one_that_starts_there_with_the_new_values(opened, when, dashpot, method):
    values = {**BALL, "contact.dashpot": dashpot}
    fmu = tuned(start(opened("SphereSphere"), values, 1e-10, method), CHANGES[when])
    motion = reference(when, dashpot)
    check_close("position", fmu["source.position"], motion.position["source"], ALLOWED[method])
    check_close("velocity", fmu["source.velocity"], motion.velocity["source"], 1e3 * ALLOWED[method])
    check_close("dissipated", fmu["energy.dissipated"], motion.dissipated, 1e3 * ALLOWED[method])
    check_close("work", fmu["energy.external_work"], motion.external_work, 1e3 * ALLOWED[method])
    total = 0.5 * np.dot(VELOCITY, VELOCITY) + 9.81 * POSITION[2]
    check_close("total", fmu["energy.total"], total, 1e3 * ALLOWED[method])
    assert fmu["contact.onsets"] == 1


def halves(fmu, values, method, between, split=9):
    """Returns the bits of all outputs after each step of a run. `between(fmu)` comes between two steps."""
    start(fmu, values, 1e-10, method)
    rows = []
    for k in range(40):
        if k == split:
            between(fmu)
        fmu.step((k + 1) * STEP - fmu.time)
        rows.append(everything(fmu))
    return rows


def set_all_again(fmu):
    for name in TUNABLE:
        fmu[name] = fmu[name]


def there_and_back(fmu):
    changes = {"gravity": [1.0, 2.0, 3.0], "contact.penalty_factor": 7e4, "contact.dashpot": "unclamped"}
    for name, value in changes.items():
        before = fmu[name]
        fmu[name] = value
        fmu[name] = before


def of_no_use(fmu):
    for name in ("penalty_multiplier", "characteristic_time", "reference_modulus"):
        fmu[f"contact.{name}"] = 3.0


def refused(fmu):
    for name, value in {
        "contact.penalty_factor": -1.0,
        "gravity": [0.0, 0.0, np.nan],
        "solver.relative_tolerance": 1.0,
    }.items():
        before = fmu[name]
        with pytest.raises(FmuError) as error:
            fmu[name] = value
        assert error.value.status == Status.DISCARD
        assert name in str(error.value)
        assert np.array_equal(fmu[name], before)


TUNABLE = ["contact.penalty_multiplier", "contact.penalty_factor", "contact.characteristic_time"]
TUNABLE += ["contact.viscous_penalty_factor", "contact.reference_modulus", "contact.dashpot", "gravity"]
TUNABLE += ["contact.hertz_stiffness", "contact.hunt_crossley_factor", "contact.restitution"]
TUNABLE += ["solver.relative_tolerance", "solver.absolute_tolerance", "solver.max_internal_steps"]


@pytest.mark.parametrize("split", [2, 9, 18, 30])  # in flight, compression, restitution, flight again
@pytest.mark.parametrize("between", [set_all_again, there_and_back, of_no_use, refused])
def test_what_changes_nothing_does_not_change_one_bit(opened, between, split, method):
    fmu = opened("SphereSphere")
    plain = halves(fmu, BALL, method, lambda _: None)
    assert halves(fmu, BALL, method, between, split) == plain


def test_what_may_be_set_is_told_so(opened):
    variables = opened("SphereSphere").description.modelVariables
    told = {one.name.partition("[")[0] for one in variables if one.variability == "tunable"}
    effective = ("penalty_factor", "viscous_penalty_factor", "hertz_stiffness")
    assert told == {*TUNABLE, *(f"contact.effective_{factor}" for factor in effective)}


def test_automatic_factors_follow(opened, method):
    """The bits equal those of a run to which the products are given."""
    automatic = {**BALL, "contact.penalty_control": "automatic", "contact.viscous_control": "automatic"}
    automatic |= {"contact.reference_modulus": 1e5, "contact.characteristic_time": 1e-3}
    fmu = start(opened("SphereSphere"), automatic, 1e-10, method)
    diagonal = fmu["contact.diagonal"]
    # Between deepest and gone, so that the regime of the new law is another one.
    changes = {"contact.reference_modulus": 2e5, "contact.penalty_multiplier": 0.75}
    changes |= {"contact.characteristic_time": 2e-2}

    def follow(fmu):
        for name, value in changes.items():
            fmu[name] = value
        stiffness = 0.75 * (2e5 * diagonal)
        assert fmu["contact.effective_penalty_factor"] == stiffness
        assert fmu["contact.effective_viscous_penalty_factor"] == 2e-2 * stiffness
        assert fmu["contact.diagonal"] == diagonal

    def given(fmu):
        fmu["contact.penalty_factor"] = 0.75 * (2e5 * diagonal)
        fmu["contact.viscous_penalty_factor"] = 2e-2 * (0.75 * (2e5 * diagonal))
        fmu["contact.gap"]  # as `follow` reads between

    rows = halves(fmu, automatic, method, follow, 16)
    factors = {
        "contact.penalty_factor": 1e5 * diagonal,
        "contact.viscous_penalty_factor": 1e-3 * (1e5 * diagonal),
    }
    assert halves(fmu, {**BALL, **factors}, method, given, 16) == rows


def test_a_state_saved_after_setting_holds_what_was_set(opened, fmu_path, method):
    fmu = start(opened("SphereSphere"), BALL, 1e-10, method)
    for k in range(8):
        fmu.step((k + 1) * STEP - fmu.time)
    fmu["contact.penalty_factor"] = 3e5
    fmu["gravity"] = [0.0, 5.0, 0.0]
    state, ends = bytes(fmu.save()), []
    with ContactFmu(fmu_path("SphereSphere")) as other:
        other.start({**BALL, "solver.method": method})
        for one in (fmu, other, fmu):
            one.restore(state)
            one["contact.viscous_penalty_factor"] = 200.0
            one.step(0.01)
            ends.append(everything(one))
    assert ends[0] == ends[1] == ends[2]


def test_a_deferred_flight_keeps_the_gravity_it_had(opened):
    """Steps that nobody looks at are computed later, with the gravity that acted then."""
    seen, unseen = [0.0, 0.0, 9.0], []
    for look in (True, False):
        fmu = start(opened("SphereSphere"), {"source.center": seen})
        for k in range(100):
            if k == 50:
                fmu["gravity"] = [1.0, 0.0, 2.0]
            fmu.step((k + 1) * 1e-3 - fmu.time)
            if look:
                fmu["source.position"]
        unseen.append(fmu["source.position"])
    half = 0.05
    expected = [0.5 * half**2, 0.0, 9.0 - 9.81 * half * (0.5 * half + half) + half**2]
    check_close("position", unseen[0], expected, 1e-14)
    assert np.array_equal(*unseen)


def test_what_would_be_beyond_numbers_is_refused_and_the_old_value_stays(opened):
    automatic = {"contact.penalty_control": "automatic", "contact.viscous_control": "automatic"}
    fmu = start(opened("SphereSphere"), {**BALL, **automatic})
    values = {"contact.reference_modulus": 1e150, "contact.penalty_multiplier": 1e140}
    values |= {"gravity": [0.0, 0.0, 1e150]}
    for name, value in values.items():
        fmu[name] = value  # finite, whatever it is good for
    factor = fmu["contact.effective_viscous_penalty_factor"]
    with pytest.raises(FmuError, match=r"contact.characteristic_time = 1e\+30 refused") as error:
        fmu["contact.characteristic_time"] = 1e30
    assert error.value.status == Status.DISCARD
    assert fmu["contact.characteristic_time"] == 1e-4
    assert fmu["contact.effective_viscous_penalty_factor"] == factor


def test_the_solver_goes_on_with_another_limit_and_tolerance(opened):
    fmu = start(opened("SphereSphere"), {**BALL, "solver.max_internal_steps": 3}, 1e-4, "cvode_bdf")
    with pytest.raises(FmuError) as error:
        fmu.step(0.03)
    assert error.value.status == Status.DISCARD
    fmu["solver.max_internal_steps"] = 100000
    fmu["solver.relative_tolerance"] = 1e-11
    coarse, steps = fmu.time, fmu["solver.steps"]
    assert fmu["solver.relative_tolerance"] == 1e-11
    fmu.step(0.03 - coarse)
    assert fmu["solver.steps"] > 10 * steps
    exact = run(opened("SphereSphere"), BALL, 0.03, 1, 1e-12, "event_driven")
    position = exact["source.position"].copy()
    check_close("position", fmu["source.position"], position, 1e-6)


def test_another_tolerance_within_a_contact_leaves_the_motion_as_it_was(opened):
    ends = []
    for tolerance in (1e-8, 2e-8):
        fmu = start(opened("SphereSphere"), BALL, 1e-8, "event_driven")
        for _ in range(16):
            fmu.step(STEP)
            fmu["solver.relative_tolerance"] = tolerance if fmu["contact.active"] else 1e-8
        ends.append(np.hstack([fmu["source.position"], fmu["energy.total"]]))
    check_close("the end", ends[1], ends[0], 1e-10)


def test_a_force_element_has_the_new_force_at_once(opened):
    moves = {"source.prescribed_velocity": [-0.2, 0.0, 0.0]}  # 1 mm deep beside the cylinder, deeper still
    fmu = start(opened("ForceElement"), {**moves, "contact.viscous_penalty_factor": 100.0})
    fmu["contact.penalty_factor"] = 2e4
    fmu["contact.viscous_penalty_factor"] = 30.0
    check_close("force", fmu["contact.normal_force"], 2e4 * 1e-3 + 30.0 * 0.2, 1e-11)
    fmu["source.prescribed_velocity"] = [0.2, 0.0, 0.0]
    fmu["contact.viscous_penalty_factor"] = 150.0  # would pull by 10 N
    assert fmu["contact.normal_force"] == 0.0
    fmu["contact.dashpot"] = "unclamped"
    check_close("force", fmu["contact.normal_force"], -10.0, 1e-11)
    fmu["contact.dashpot"] = "approach_only"
    check_close("force", fmu["contact.normal_force"], 20.0, 1e-11)
    fmu.step(1e-3)
    check_close("mean force", fmu["contact.mean_force"], [20.0, 0.0, 0.0], 1e-11)


# Beside a cylinder, or on a plane, 1 mm deep: 10 N press, and 5 N of friction resist a pull of 1 m/s.
PULLED = {"contact.friction": "elastic", "contact.penalty_factor": 1e4, "contact.friction_coefficient": 0.5}
PULLED |= {"contact.static_friction_coefficient": 0.6, "contact.tangential_stiffness": 1.1e3}
PULLED |= {"contact.tangential_damping": 0.0}
ON_PLANE = {"source.center": [0.0, 0.0, 0.099], "source.prescribed_velocity": [1.0, 0.0, 0.0]}
ON_PLANE |= {"source.motion": "prescribed", "destination.motion": "prescribed"}
BESIDE = {"source.prescribed_velocity": [0.0, 0.0, 1.0], "source.prescribed_angular_velocity": [0.0] * 3}
PULLS = {"SpherePlane": (ON_PLANE, [0.0, 0.0, -1e-3]), "TurningForceElement": (BESIDE, [-1e-3, 0.0, 0.0])}


@pytest.mark.parametrize("name", PULLS)
@pytest.mark.parametrize("jump, force", [("softer", 5), ("stiffer", 20), ("pressed", 20), ("none", 10)])
def test_a_jump_of_the_normal_force_stretches_no_friction_spring(opened, name, jump, force):
    values, deeper = PULLS[name]
    jumps = {"softer": {"contact.penalty_factor": 5e3}, "stiffer": {"contact.penalty_factor": 2e4}}
    jumps |= {"pressed": {"source.prescribed_displacement": deeper}, "none": {"gravity": [1.0, 0.0, 0.0]}}
    fmu = start(opened(name), {**values, **PULLED})
    fmu.step(0.01)
    for variable, value in jumps[jump].items():
        if variable in fmu.variables:
            fmu[variable] = value
    for k in range(12):
        carried = 5.0 + 1.1 * k  # N: the spring goes on from its length, until it breaks away
        sliding = 0.5 * force if force <= 10.0 or carried >= 0.6 * force else carried
        check_close("friction", np.linalg.norm(fmu["contact.friction_force"]), sliding, 1e-9)
        fmu.step(1e-3)
    phases = [(6.0, 5.0, 10.0 - 6.0 / 1.1)]  # N, N, ms: the force before and while it slides so long
    phases += [(5.0, 0.5 * force, 12.0) if force <= 10.0 else (12.0, 10.0, 12.0 - 7.0 / 1.1)]
    lost = sum(0.5 * (f**2 - g**2) / 1.1e3 + 1e-3 * g * lasts for f, g, lasts in phases)
    if name == "SpherePlane":
        check_close("friction", fmu["energy.friction"], lost, 1e-11)
