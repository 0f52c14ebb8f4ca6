"""Bodies and contacts are lists: three balls in a row, two contacts on the middle one; two pairs at a time.

The reference of the three balls is three_balls.py, that of each pair the FMU of the pair alone."""

import numpy as np
import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu
from support.checks import check_close
from support.reference.three_balls import BRIEF, CASES, END, NAMED, reference

BALLS = ("left", "middle", "right")


def values_of(case, method="event_driven"):
    values = {"solver.method": method, "gravity": [0, 0, 0]}
    laws = zip(("first", "second"), case.laws, case.stiffness, case.damping, strict=True)
    for contact, law, stiffness, damping in laws:
        factor = "hertz_stiffness" if law == "hertz" else "penalty_factor"
        values |= {f"{contact}.law": law, f"{contact}.penalty_control": "user_defined"}
        values |= {f"{contact}.method": "penalty", f"{contact}.{factor}": stiffness}
        if damping:
            values |= {f"{contact}.method": "penalty_dynamic", f"{contact}.viscous_control": "user_defined"}
            values |= {f"{contact}.dashpot": case.dashpot, f"{contact}.viscous_penalty_factor": damping}
    for k, ball in enumerate(BALLS):
        values |= {f"{ball}.center": case.places[k], f"{ball}.initial_velocity": case.velocities[k]}
        values |= {f"{ball}.mass": case.masses[k], f"{ball}.radius": case.radii[k]}
    return values


@pytest.mark.parametrize("steps", [1, 2, 40])
@pytest.mark.parametrize("name", BRIEF)
def test_a_brief_contact_is_felt_however_long_the_step(built, name, steps):
    """The contact is brief, begins without a force as under Hertz's law, or happens in passing."""
    case, expected = BRIEF[name], reference(name)
    with ContactFmu(built["ThreeBalls"]) as fmu:
        fmu.start(values_of(case), tolerance=1e-9)
        energy, moving = fmu["energy.total"], fmu["energy.kinetic"]
        for _ in range(steps):
            fmu.step(case.end / steps)
        check_close("energy", fmu["energy.total"], energy, 1e-9 * moving)
        size = np.abs(expected).max()
        for k, ball in enumerate(BALLS):
            check_close(f"{ball}.position", fmu[f"{ball}.position"], expected[k], 1e-8 * size)


@pytest.mark.parametrize("steps", [1, 100])
@pytest.mark.parametrize("case", CASES)
def test_a_ball_between_two_others_moves_as_in_the_reference(built, case, method, steps):
    velocities, masses = CASES[case].velocities, CASES[case].masses
    expected = reference(case)
    values = values_of(CASES[case], method)
    with ContactFmu(built["ThreeBalls"]) as fmu:
        fmu.start(values, tolerance=1e-10)
        for _ in range(steps):
            fmu.step(END / steps)
        momentum = sum(mass * fmu[f"{ball}.velocity"] for ball, mass in zip(BALLS, masses, strict=True))
        check_close("momentum", momentum, np.array(masses) @ np.array(velocities), 1e-12 * max(masses))
        for k, ball in enumerate(BALLS):
            allowed = 1e-8 if case in NAMED else 1e-6
            check_close(f"{ball}.position", fmu[f"{ball}.position"], expected[k], allowed)
        if case in NAMED:  # a chain in closed form or the series of an island moves the balls
            assert fmu["solver.fallbacks"] == 0


@pytest.mark.parametrize("case", CASES)
def test_saving_is_only_looking_where_event_driven_falls_back_to_cvode(built, case):
    values = values_of(CASES[case])
    ends = []
    for saves in (False, True):
        with ContactFmu(built["ThreeBalls"]) as fmu:
            fmu.start(values, tolerance=1e-10)
            for _ in range(50):
                if saves:
                    fmu.save()
                fmu.step(END / 50)
            ends.append([fmu[f"{b}.{what}"].tobytes() for b in BALLS for what in ("position", "velocity")])
    assert ends[0] == ends[1]


# The values of body and contact in a pair, by the names they have in the FMU of the pair alone.
PAIRS = {
    "SphereSphere": {"source": "ball", "destination": "floor", "contact": "first"},
    "SphereCylinder": {"source": "marble", "destination": "bowl", "contact": "second"},
}
BALL = {"source.radius": 0.1, "source.mass": 0.7, "source.center": [0.02, 0.01, 0.4]}
BALL |= {"source.initial_velocity": [0.3, -0.1, -2.0], "source.motion": "free", "destination.radius": 0.3}
BALL |= {"destination.center": [0.0, 0.0, 0.0], "destination.motion": "fixed", "contact.penalty_factor": 3e4}
BALL |= {"contact.viscous_penalty_factor": 20.0, "contact.dashpot": "unclamped"}
MARBLE = {"source.radius": 0.02, "source.mass": 0.05, "source.center": [5.0, 1.0, 0.325]}
MARBLE |= {"source.initial_velocity": [-0.2, 0.5, -1.0], "source.motion": "free", "destination.radius": 0.3}
MARBLE |= {"destination.center": [5.0, 0.0, 0.0], "destination.axis": [0.0, 1.0, 0.0]}
MARBLE |= {"destination.motion": "free", "destination.mass": 3.0, "contact.penalty_factor": 2e6}
MARBLE |= {"contact.viscous_penalty_factor": 1.5, "contact.dashpot": "non_adhesive"}
COMMON = {"contact.penalty_control": "user_defined", "contact.viscous_control": "user_defined"}
RESTING = {"source.initial_velocity": [0.1, 0.0, 0.0], "source.center": [0.0, 0.0, 0.3999]}
SIDE_BY_SIDE = {  # ball, marble
    "both strike": (BALL, MARBLE),
    "one lies, one strikes": ({**BALL, **RESTING, "contact.viscous_penalty_factor": 500.0}, MARBLE),
    "one creeps, one strikes": ({**BALL, **RESTING, "contact.viscous_penalty_factor": 5e4}, MARBLE),
    "one lies on a stiff floor, one strikes a stiff bowl": (
        {**BALL, **RESTING, "contact.penalty_factor": 1e9, "source.center": [0.0, 0.0, 0.4]},
        {**MARBLE, "contact.penalty_factor": 1e11},
    ),
}


def motion_of(fmu, names):
    """Returns positions, velocities and deepest penetration of a pair."""
    bodies = [fmu[f"{names[e]}.{of}"] for e in ("source", "destination") for of in ("position", "velocity")]
    return np.concatenate([*bodies, [fmu[f"{names['contact']}.peak_penetration"]]])


def motion_alone(path, values, times):
    with ContactFmu(path) as fmu:
        fmu.start({**COMMON, **values, "contact.location": "outside"}, tolerance=1e-12)
        steps, motions = np.diff(times), []
        for size in steps:
            fmu.step(size)
            motions.append(motion_of(fmu, {name: name for name in ("source", "destination", "contact")}))
        return motions, fmu["contact.onsets"]


def side_by_side(*pairs):
    """Returns the values of TwoPairs, from those of each pair alone."""
    return {
        f"{names[part]}.{row}": value
        for names, pair in zip(PAIRS.values(), pairs, strict=True)
        for (part, row), value in ((name.split(".", 1), value) for name, value in {**COMMON, **pair}.items())
    }


@pytest.mark.parametrize("steps", [1, 40])
@pytest.mark.parametrize("case", SIDE_BY_SIDE)
def test_each_of_two_pairs_moves_as_if_it_were_alone(built, fmu_path, case, steps):
    times = np.linspace(0.0, 0.3, steps + 1)
    values = side_by_side(*SIDE_BY_SIDE[case])
    both = {name: [] for name in PAIRS}
    with ContactFmu(built["TwoPairs"]) as fmu:
        fmu.start(values | {"solver.method": "event_driven"}, tolerance=1e-12)
        energy = fmu["energy.total"]
        for size in np.diff(times):
            fmu.step(size)
            for name, names in PAIRS.items():
                both[name].append(motion_of(fmu, names))
        assert fmu["solver.fallbacks"] == 0
        # What a contact still stores as it is released is dissipated, whatever the other pair does.
        check_close("energy", fmu["energy.total"], energy, 1e-12 * abs(energy))
        if case == "both strike":
            start = [fmu[f"{contact}.last_onset_time"] for contact in ("first", "second")]
            end = [fmu[f"{k}.last_onset_time"] + fmu[f"{k}.last_duration"] for k in ("first", "second")]
            assert max(start) < min(end), "at the same time"
        onsets = {name: fmu[f"{names['contact']}.onsets"] for name, names in PAIRS.items()}
    for name, pair in zip(PAIRS, SIDE_BY_SIDE[case], strict=True):
        expected, onsets_alone = motion_alone(fmu_path(name), pair, times)
        # The events of the other pair interrupt the oscillation of this one; communication points do not.
        # Each interruption rounds the place of the ball, which is 0.4 m from the origin.
        swings = (pair["contact.penalty_factor"] / pair["source.mass"]) ** 0.5 if "floor" in case else 0.0
        allowed = 1e-13 + (8 * np.finfo(float).eps * 0.4 * swings if name == "SphereSphere" else 0.0)
        check_close(name, both[name], expected, allowed)
        assert onsets[name] == onsets_alone > 0


PUSH, PULL = 0.03, 0.025  # s, towards each other and apart again
DRIVEN = {**BALL, "source.center": [0.0, 0.0, 0.41], "source.motion": "prescribed"}
DRIVEN |= {"destination.motion": "prescribed", "contact.dashpot": "non_adhesive"}


@pytest.mark.parametrize("steps", [1, 7])
def test_a_driven_pair_beside_a_free_one_is_no_burden_to_it(built, fmu_path, method, steps):
    """A pair driven together and apart at a speed V has F = p_n s + p_nv V, then p_n s - p_nv V >= 0."""
    stiffness, damping = DRIVEN["contact.penalty_factor"], DRIVEN["contact.viscous_penalty_factor"]
    speed = 1.5
    deepest, open_at = speed * PUSH - 0.01, damping * speed / stiffness  # F = 0 on the way back
    values = {"solver.method": method, "gravity": [0.0, 0.0, 0.0]} | side_by_side(DRIVEN, MARBLE)
    values["ball.prescribed_velocity"] = [0.0, 0.0, 0.4 - speed]
    values["floor.prescribed_velocity"] = [0.0, 0.0, 0.4]
    with ContactFmu(built["TwoPairs"]) as fmu:
        fmu.start(values, tolerance=1e-12)
        energy, impulse, peak = fmu["energy.total"], 0.0, 0.0
        for time in (PUSH, PULL):
            for _ in range(steps):
                fmu.step(time / steps)
                impulse += fmu["first.mean_force"][2] * time / steps
                peak = max(peak, fmu["first.peak_force"])
            fmu["ball.prescribed_velocity"] = [0.0, 0.0, 0.4 + speed]
        assert fmu["solver.fallbacks"] == 0
        marble = motion_of(fmu, PAIRS["SphereCylinder"])[:-1]
        driven = fmu["energy.external_work"]
        check_close("energy", fmu["energy.total"], energy, 1e-9 * abs(driven))
        assert fmu["first.onsets"] == fmu["second.onsets"] == 1 and not fmu["first.active"]
    pushed = stiffness * deepest**2 / 2 + damping * speed * deepest
    pulled = stiffness * (deepest**2 - open_at**2) / 2 - damping * speed * (deepest - open_at)
    tolerance = 1e-12 if method == "event_driven" else 1e-8
    check_close("impulse", impulse, (pushed + pulled) / speed, tolerance * pushed / speed)
    check_close("work", driven, pushed - pulled, tolerance * pushed)
    check_close("peak", peak, stiffness * deepest + damping * speed, 1e-9 * stiffness)
    times = np.linspace(0.0, PUSH + PULL, 3)
    alone, _ = motion_alone(fmu_path("SphereCylinder"), {**MARBLE, "gravity": [0.0, 0.0, 0.0]}, times)
    check_close("marble", marble, alone[-1][:-1], 1e-13 if method == "event_driven" else 1e-7)


@pytest.mark.parametrize("steps", [1, 6, 7, 50])
def test_a_symmetric_squeeze_leaves_the_middle_ball_where_it_is(built, method, steps):
    """Both contacts end at once, to the digits that an integrator leaves. Each outer ball leaves with its own
    energy: v = s sqrt(k / m)."""
    stiffness, mass, end = 338385515.34282333, 443.6687330978607, 0.017977067641294291
    radii = (1.0802115387737352, 6.6608462908091539, 6.6608462908091539)
    places = (0.0, 7.0749732005019741, 19.730581153039367)
    depth = radii[0] + radii[1] - places[1]
    values = {"solver.method": method, "gravity": [0.0, 0.0, 0.0]}
    values |= {"solver.relative_tolerance": 1e-9, "solver.absolute_tolerance": 1e-12}
    for ball, radius, place in zip(BALLS, radii, places, strict=True):
        values |= {f"{ball}.radius": radius, f"{ball}.mass": mass, f"{ball}.center": [place, 0.0, 0.0]}
        values[f"{ball}.initial_velocity"] = [0.0, 0.0, 0.0]
    for contact in ("first", "second"):
        values |= {f"{contact}.penalty_control": "user_defined", f"{contact}.penalty_factor": stiffness}
    with ContactFmu(built["ThreeBalls"]) as fmu:
        fmu.start(values)
        for _ in range(steps):
            fmu.step(end / steps)
        rate = (stiffness / mass) ** 0.5
        speed, way = depth * rate, depth + depth * (rate * end - np.pi / 2)  # after a quarter of a turn
        for ball, side in zip(BALLS, (-1.0, 0.0, 1.0), strict=True):
            check_close(f"{ball}.velocity", fmu[f"{ball}.velocity"], [side * speed, 0.0, 0.0], 1e-6 * speed)
            check_close(f"{ball}.displacement", fmu[f"{ball}.displacement"], [side * way, 0, 0], 1e-6 * way)
        assert fmu["first.onsets"] == fmu["second.onsets"] == 1


def on_a_held_body(seed):
    """Two balls of different stiffness are pressed, thrown or bounced against one body that does not move."""
    random = np.random.default_rng([3, seed])
    values = {"solver.method": "event_driven", "gravity": [random.choice([0.0, 20.0, 60.0]), 0.3, 0.0]}
    values |= {"middle.motion": "fixed", "middle.radius": 0.5, "middle.center": [0.0, 0.0, 0.0]}
    for contact, ball, side in (("first", "left", -1.0), ("second", "right", 1.0)):
        mass, stiffness = 10 ** random.uniform([-1, 2], [2, 10])
        away = np.array([side, 0.05 * random.normal(), 0.0])
        away *= (0.6 + random.choice([0.05, 1e-3, -0.01, -0.1])) / np.linalg.norm(away)
        speed = 0.3 * random.normal(size=3) - [side * random.choice([0.0, 1.0]), 0.0, 0.0]
        values |= {f"{ball}.radius": 0.1, f"{ball}.mass": mass, f"{ball}.center": away.tolist()}
        values |= {f"{ball}.initial_velocity": speed.tolist(), f"{contact}.penalty_factor": stiffness}
        damping = 2 * np.sqrt(stiffness * mass) * 10 ** random.uniform(-3, 1)
        values |= {f"{contact}.viscous_penalty_factor": damping, f"{contact}.method": "penalty_dynamic"}
        values[f"{contact}.dashpot"] = random.choice(["non_adhesive", "unclamped", "approach_only"])
    return values


def held_run(path, values, steps):
    """Returns displacements of both balls, and the onsets of both contacts."""
    with ContactFmu(path) as fmu:
        fmu.start(values, tolerance=1e-9)
        for _ in range(steps):
            fmu.step(END / steps)
        assert fmu["solver.fallbacks"] == 0
        moved = [fmu[f"{ball}.displacement"] for ball in ("left", "right")]
        return moved, [fmu["first.onsets"], fmu["second.onsets"]]


@pytest.mark.parametrize("seed", [*range(11), 211])  # in 211 an end was lost
def test_two_balls_on_one_held_body_move_as_if_alone(built, seed):
    """The ends of one ball's bounces may fall anywhere in the other's motion."""
    values = on_a_held_body(seed)
    both = [held_run(built["ThreeBalls"], values, steps) for steps in (1, 23)]
    for k, other in enumerate(("right", "left")):
        away = {f"{other}.motion": "fixed", f"{other}.center": [50.0, 30.0, 40.0]}
        moved, onsets = held_run(built["ThreeBalls"], values | away, 1)
        for of_both, onsets_of_both in both:
            check_close("displacement", of_both[k], moved[k], 1e-8)
            assert onsets_of_both[k] == onsets[k]


@pytest.mark.parametrize("steps", [1, 3, 40])
def test_what_a_driven_contact_still_stores_as_it_separates_is_dissipated_while_the_other_ball_flies(
    built, steps
):
    values = {"solver.method": "event_driven", "gravity": [0.0, 0.0, 0.0]}
    values |= side_by_side(DRIVEN, {**MARBLE, "source.initial_velocity": [0.0, 0.1, 0.0]})
    with ContactFmu(built["TwoPairs"]) as fmu:
        fmu.start(values | {"ball.prescribed_velocity": [0.0, 0.0, -1.5]}, tolerance=1e-12)
        energy = fmu["energy.total"]
        for time, velocity in ((PUSH, 1.5), (PULL, 0.0)):
            for _ in range(steps):
                fmu.step(time / steps)
            fmu["ball.prescribed_velocity"] = [0.0, 0.0, velocity]
        assert (fmu["first.onsets"], fmu["second.onsets"]) == (1, 0) and fmu["energy.dissipated"] > 0.0
        check_close("energy", fmu["energy.total"], energy, 1e-9 * fmu["energy.dissipated"])
