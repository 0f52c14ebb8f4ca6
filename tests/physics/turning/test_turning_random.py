"""Random scenes of bodies that turn and rub against the reference, in all that a run says."""

from functools import cache

import numpy as np
import pytest

from support.checks import by_methods, check_close, run, start
from support.reference.turning import TurningPair, follow, outputs
from support.scenes import turning_cases as cases
from support.scenes.agreement import seeds
from support.scenes.random_scenes import even
from support.scenes.scene_checks import FMU
from support.scenes.turning_checks import TERMS, failures
from support.scenes.turning_scenes import FRICTIONS, PLACES, driven_scene, random_turning_scene


@cache
def expected(seed):
    scene = random_turning_scene(seed)
    return follow(scene.values, scene.shape, scene.end)


# Two events at once, of which neither may be passed over: Hertz's law with a dashpot that may pull, whose
# force ends with the contact (342, 394, 409, 642); the slip stops stretching the spring (410, 457).
TWO_EVENTS = (342, 394, 409, 410, 457, 642)
# Neither turns nor rubs: only the mean torque is new.
NO_TURNING = (179, 329, 537, 657)
# A dashpot that pulls lifts elastic friction, whose spring relaxes through its own dashpot.
RELAXING = (1248,)


@pytest.mark.parametrize("seed", dict.fromkeys([*seeds(30), *TWO_EVENTS, *NO_TURNING, *RELAXING]))
def test_a_scene_goes_as_the_reference_says(opened, seed):
    scene, right = random_turning_scene(seed), expected(seed)
    run_of = (opened(FMU[scene.shape]), scene.values, scene.end, scene.steps)
    wrong = by_methods(lambda method: failures(*run_of, method, right))
    assert not wrong, f"{wrong}\n{scene}"


def test_the_scenes_reach_what_they_are_about():
    scenes = [random_turning_scene(seed) for seed in range(120)]
    assert {scene.shape for scene in scenes} == {"sphere", "cylinder", "plane"}
    for name, choices in (
        ("contact.friction", {"none", "regularized", "elastic"}),
        ("contact.law", {"linear", "hertz"}),
        ("source.rotation", {"none", "prescribed", "free"}),
        ("destination.rotation", {"none", "prescribed", "free"}),
        ("destination.motion", {"fixed", "prescribed", "free"}),
    ):
        assert {scene.values[name] for scene in scenes} == choices, name


@pytest.mark.parametrize("seed", range(12))
def test_a_grazing_impact_with_friction_gains_no_energy(opened, seed):
    """Ten to a hundred times as fast along the surface as towards it, spinning: nothing drives it, so what
    is not stored or in motion only grows."""
    random = np.random.default_rng([16, seed])
    shape = ("plane", "sphere", "cylinder")[seed % 3]
    friction = ("regularized", "elastic")[seed // 3 % 2]
    values = {
        "source.center": [0.0, 0.0, 0.105] if shape == "plane" else [0.0, 0.0, 0.600001],
        "source.initial_velocity": [random.uniform(5, 20), random.uniform(-5, 5), random.uniform(-0.5, -0.2)],
        "source.rotation": "free",
        "source.initial_angular_velocity": (50 * random.normal(size=3)).tolist(),
        "contact.friction": friction, "contact.friction_coefficient": random.uniform(0.1, 1.0),
        "contact.static_friction_coefficient": 1.2,
        "contact.method": ("penalty", "penalty_dynamic")[seed % 2],
        "contact.viscous_penalty_factor": 60.0, "contact.penalty_factor": 10 ** random.uniform(4, 6),
        "contact.tangential_stiffness": 10 ** random.uniform(4, 5.5),
        "contact.tangential_damping": random.choice([0.0, 20.0]), "gravity": [0.0, 0.0, 0.0],
    }  # fmt: skip
    if shape == "cylinder":
        values |= {"destination.axis": [1.0, 0.0, 0.0], "contact.location": "outside"}
    if shape == "sphere":
        values["contact.location"] = "outside"
    fmu = start(opened(FMU[shape]), values, 1e-10)
    begin = fmu["energy.total"]
    lost, size = 0.0, max(abs(fmu[f"energy.{name}"]) for name in TERMS)
    for stop in even(0.05, 200):
        fmu.step(stop - fmu.time)
        now = fmu["energy.friction"] + fmu["energy.dissipated"]
        assert now >= lost - 1e-10 * size, f"{lost} J to {now} J at {fmu.time} s"
        lost = max(lost, now)
    assert fmu["contact.onsets"] == 1
    check_close("balance", fmu["energy.total"], begin, 1e-9 * size)


# In the next tests bodies turn or rub in many communication steps: an internal step goes on beyond several.

MANY = 400


def positions(fmu, case, steps, **options):
    rows = []
    run(fmu, case.values, case.end, steps, each=lambda fmu: rows.append(fmu["source.position"]), **options)
    return np.array(rows)


def test_positions_within_a_step_are_those_of_the_closed_form(opened):
    """At the default tolerance: what is read within a step is as good as what the tolerance asks for."""
    case = cases.golfers_tube(5e-10, turns=1.0)
    read = positions(opened(FMU[case.shape]), case, MANY, tolerance=1e-8)
    closed = np.array([
        cases.golfers_tube(5e-10, turns=k / MANY).expected["source.position"] for k in range(1, MANY + 1)
    ])  # fmt: skip
    check_close("position", read[1:], closed, 2e-9)


def test_peaks_are_those_of_each_communication_step(opened):
    """A ball that bounces in a bowl, with peaks of force in the midst of steps: compared with those of short
    steps, whose ends are next to any peak."""
    case = cases.bowl(1e-3, 1e3)
    values = case.values | {"source.initial_velocity": [0.0, 0.0, -0.5]}
    peaks = {}
    for steps in (20, 2000):
        of_step = []

        def note(fmu, rows=of_step):
            rows.append([fmu["contact.peak_force"], fmu["contact.peak_penetration"]])

        run(opened(FMU[case.shape]), values, 0.2, steps, each=note)
        peaks[steps] = np.array(of_step[1:])
    short = peaks[2000].reshape(20, 100, 2).max(axis=1)
    assert np.ptp(short[:, 0]) > 0.1 * short[:, 0].max()
    check_close("force", peaks[20][:, 0], short[:, 0], 1e-6 * short[:, 0].max())
    check_close("penetration", peaks[20][:, 1], short[:, 1], 1e-6 * short[:, 1].max())


@pytest.mark.parametrize("changes", [0, 1, 7])
def test_inputs_end_the_step_that_goes_on(opened, changes):
    """Forces that change at a few communication points, among many or at these alone."""
    case = cases.turntable(1e-3)
    forces = [[0.1 * k, -0.2, 0.0] for k in range(changes + 1)]
    ended = []
    for steps in (1, 60):
        fmu = start(opened(FMU[case.shape]), case.values, tolerance=1e-8)
        for k, force in enumerate(forces):
            for i in range(steps):
                fmu["source.external_force"] = force
                fmu.step((k + (i + 1) / steps) * case.end / len(forces) - fmu.time)
        ended.append(np.concatenate([fmu["source.position"], fmu["source.angular_velocity"]]))
    check_close("position and spin", ended[1], ended[0], 1e-9)


# Contacts that turn and rub while the importer moves both bodies, against the reference's integration.
#
# The source comes to touch, presses, slides or sticks, and parts again, all within one communication step:
# mean force and torques, energies, springs, onsets and durations.

# The reference begins sliding without a dashpot from free bodies only; such springs have a test of their own.
WITHOUT_DASHPOT = ("elastic", "elastic, static")
SCENES = [
    seed
    for seed in range(len(PLACES) * len(FRICTIONS))
    if FRICTIONS[seed // len(PLACES)] not in WITHOUT_DASHPOT
]
INCREMENTS = 4000  # of the incremental spring, whose error goes with the first power of the step


@pytest.mark.parametrize("seed", SCENES)
def test_a_given_motion_has_the_forces_that_the_reference_says(opened, seed):
    shape, values, end, _ = driven_scene(seed)
    lines = failures(opened(FMU[shape]), values, end, 1, "event_driven", follow(values, shape, end))
    assert not lines, f"{lines}\n{values}"


def incremental(values, shape, end):
    """Impulse on the source by Cundall and Strack's increments: the spring grows by the slip, stays tangent,
    and is cut back to where k_t times its length is mu F_n."""
    pair, rubbing = TurningPair(values | {"contact.friction": "none"}, shape), TurningPair(values, shape)
    speed, bend = map(np.array, values["source.prescribed_displacement.derivatives"])
    omega = np.array(values["source.prescribed_angular_velocity"])
    m = {
        name: np.zeros(3)
        for name in ("destination.displacement", "destination.velocity", "destination.omega")
    }
    m |= {name: np.array(values[name]) for name in ("source.center", "destination.center")}
    m |= {"source.omega": omega, "axis": np.array(values.get("destination.axis", (0.0, 0.0, 1.0)))}
    spring, impulse, step = np.zeros(3), np.zeros(3), end / INCREMENTS
    for k in range(INCREMENTS):
        t = (k + 0.5) * step
        m["source.displacement"], m["source.velocity"] = speed * t + bend * t**2 / 2, speed + bend * t
        now = outputs(pair, m)
        normal = now["direction"]
        k_t = rubbing.stiffness_of(rubbing.opposed["slip"], now["gap"][0])
        spring = spring + step * now["slip_velocity"]
        spring = spring - (spring @ normal) * normal
        limit = values["contact.friction_coefficient"] * now["normal_force"][0]
        size = k_t * np.linalg.norm(spring)
        spring = spring * min(1.0, limit / size) if size > 0.0 else np.zeros(3)
        impulse += step * (now["source_force"] - k_t * spring)
    return impulse


HERTZ = {"contact.law": "hertz", "contact.hertz_stiffness": 1e6, "contact.tangential_law": "mindlin"}


@pytest.mark.parametrize("law", [{}, HERTZ], ids=["linear", "mindlin"])
@pytest.mark.parametrize("number", range(len(PLACES)))
def test_a_spring_without_a_dashpot_slides_as_increments_say(opened, number, law):
    """In turn so soft that it sticks for long, and so stiff that it slides nearly at once"""
    shape, values, end, _ = driven_scene(number)
    stiffness = 5e4
    values = {name: value for name, value in values.items() if not name.startswith("contact.")} | {
        "contact.location": values.get("contact.location"),
        "contact.law": "linear", "contact.method": "penalty",
        "contact.penalty_factor": stiffness, "contact.friction": "elastic",
        "contact.friction_coefficient": 0.4, "contact.static_friction_coefficient": 0.4,
        "destination.prescribed_angular_velocity": [0.0, 0.0, 0.0],
    }  # fmt: skip
    values = {name: value for name, value in values.items() if value is not None}
    values["contact.tangential_stiffness"] = (0.02, 0.5)[number % 2] * stiffness
    values |= law | {"contact.tangential_ratio": (0.02, 0.5)[number % 2]} if law else {}
    fmu = start(opened(FMU[shape]), values)
    fmu.step(end)
    right = incremental(values, shape, end)
    assert np.linalg.norm(end * fmu["contact.mean_force"] - right) < 3e-3 * np.linalg.norm(right)


@pytest.mark.parametrize("dashpot", ["unclamped", "non_adhesive"])
def test_a_spring_relaxes_through_its_dashpot_while_the_contact_pulls(opened, dashpot):
    """A ball is drawn off the plane. Over the last millimetre E_t falls as exp(-2 k_t t / c_t)."""
    values = {"source.motion": "prescribed", "source.radius": 0.1, "source.center": [0.0, 0.0, 0.098]}
    values |= {"source.prescribed_velocity": [0.05, 0.0, 0.1]}
    values |= {"source.prescribed_displacement.derivatives": [[0.05, 0.0, 0.1]]}
    values |= {"contact.penalty_factor": 1e4, "contact.viscous_penalty_factor": 100.0}
    values |= {"contact.dashpot": dashpot, "contact.friction": "elastic"}
    values |= {"contact.tangential_stiffness": 1e4, "contact.tangential_damping": 50.0}
    fmu = start(opened("SpherePlane"), values)
    fmu.step(0.012)
    assert fmu["contact.normal_force"] < 0.0 or dashpot == "non_adhesive"
    assert fmu["contact.normal_force"] <= 0.0
    before = fmu["energy.tangential"]
    fmu.step(0.004)
    assert before > 1e-9
    expected = before * np.exp(-2.0 * 1e4 / 50.0 * 0.004)
    check_close("energy.tangential", fmu["energy.tangential"], expected, 1e-9 * before)


def test_a_spring_that_relaxes_is_there_when_the_contact_presses_again(opened, method):
    """The rebound of a thrown ball is so slow that it falls back while it still overlaps, without a force."""
    values = {"source.rotation": "free", "source.radius": 0.1, "source.center": [0.0, 0.0, 0.1]}
    values |= {"source.initial_velocity": [1.0, 0.0, -0.4], "contact.method": "penalty_dynamic"}
    values |= {"contact.penalty_factor": 1e4, "contact.viscous_penalty_factor": 60.0}
    values |= {"contact.tangential_stiffness": 2e3, "contact.tangential_damping": 40.0}
    values |= {"contact.friction": "elastic", "contact.dashpot": "non_adhesive", "gravity": [0.0, 0.0, -9.81]}
    right = follow(values, "plane", 0.1)
    assert right["events"].count("corner") == 2 and "release" not in right["events"]
    assert not failures(opened("SpherePlane"), values, 0.1, 3, method, right)
