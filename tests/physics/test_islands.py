"""Several contacts at once: Newton's cradle, ball bearings, a Galton board, and the islands they make."""

import numpy as np
import pytest
from scipy.optimize import brentq

from contact_fmus.fmu.contact_fmu import ContactFmu
from support.checks import check_close
from support.reference.chain import velocities

# Of the last balls, in units of the first one's speed, as published for such chains
LAST = {
    (3, "linear"): (-0.130261695, 0.150229569, 0.980032126),
    (3, "hertz"): (-0.070952354, 0.076403039, 0.994549315),
    (10, "linear"): (0.877671242,),
    (10, "hertz"): (0.985865866,),
}


def chain(fmu, balls, law):
    """Starts a cradle; the other balls of the scene are far away."""
    values = {f"touch[{i}].law": law for i in range(1, 40)} | {"ball[1].initial_velocity": [1, 0, 0]}
    values |= {f"ball[{i}].center": [1e3 * i, 0, 0] for i in range(balls + 1, 41)}
    fmu.start(values, tolerance=1e-12)


@pytest.mark.parametrize(("balls", "law"), LAST)
def test_balls_in_touch_leave_with_the_speeds_of_the_reference(opened_several, balls, law):
    fmu, end = opened_several("Chain"), 30.0 if balls == 3 else 60.0
    expected = velocities(balls, law, end)
    check_close("published", expected[-len(LAST[balls, law]) :], LAST[balls, law], 1e-9)
    fmu.reset()
    chain(fmu, balls, law)
    islands = []
    for _ in range(6):
        fmu.step(end / 6)
        islands.append((fmu["solver.islands"], fmu["solver.largest_island"]))
    found = [fmu[f"ball[{i}].velocity"][0] for i in range(1, balls + 1)]
    check_close("velocities", found, expected, 1e-10)
    check_close("momentum", sum(found), 1.0, 1e-12)
    assert islands[-1] == (0, 0)  # all apart


def test_steps_under_hertz_law_end_at_releases(fmu_path):
    """At a touch and at a release the force bends: steps across them are inaccurate, and many shorter ones
    are tried. Steps from a touch and to a release follow the force."""
    values = {f"touch[{i}].law": "hertz" for i in range(1, 5)}
    values |= {f"touch[{i}].hertz_stiffness": 1e8 for i in range(1, 5)}
    with ContactFmu(fmu_path("NewtonsCradle")) as fmu:
        fmu.start(values, tolerance=1e-5)
        fmu.step(0.03)
        found = [fmu[f"ball[{i}].velocity"][0] for i in range(1, 6)]
        check_close("velocities", found, velocities(5, "hertz", 60.0), 1e-9)
        assert fmu["solver.force_evaluations"] < 1400


@pytest.mark.parametrize("law", ["linear", "hertz"])
def test_communication_points_and_saved_states_end_no_step_of_an_island(fmu_path, law):
    """Where each communication point begins a new step, 997 of them cost ten times as much."""
    start = {f"touch[{i}].law": law for i in range(1, 5)}

    def run(fmu, steps, first=0, last=1.0):
        for _ in range(first, round(last * steps)):
            fmu.step(0.03 / steps)
        names = [f"ball[{i}].{one}" for i in range(1, 6) for one in ("velocity", "position")]
        names += [f"touch[{i}].{one}" for i in range(1, 5) for one in ("normal_force", "onsets")]
        return np.hstack([np.ravel(fmu[name]) for name in [*names, "energy.total"]])

    with ContactFmu(fmu_path("NewtonsCradle")) as fmu:
        evaluations, ends = [], []
        for steps in (1, 997):
            fmu.reset()
            fmu.start(start, tolerance=1e-9)
            ends.append(run(fmu, steps))
            evaluations.append(fmu["solver.force_evaluations"])
        check_close("the end", ends[1], ends[0], 1e-9)
        # the phase of a chain that follows an event in a short step ends with the step, the next is long
        assert evaluations[1] < (4 if law == "linear" else 2) * evaluations[0]
        fmu.reset()
        fmu.start(start, tolerance=1e-9)
        within = run(fmu, 997, last=0.02)  # the balls overlap
        assert within[-9:-1:2].max() > 0.0
        kept = fmu.save()
        assert np.array_equal(run(fmu, 997, 20), ends[1]), "saving is not seen"
        fmu.restore(kept)
        assert np.array_equal(run(fmu, 997, 20), ends[1])
        with ContactFmu(fmu_path("NewtonsCradle")) as other:
            other.start(start, tolerance=1e-9)
            other.restore(bytes(kept))
            assert np.array_equal(run(other, 997, 20), ends[1])


@pytest.mark.parametrize("law", ["linear", "hertz"])
def test_the_peaks_of_one_long_step_are_the_tops_of_all_short_ones(fmu_path, law):
    start = {f"touch[{i}].law": law for i in range(1, 5)}
    forces = [f"touch[{i}].normal_force" for i in range(1, 5)]
    with ContactFmu(fmu_path("NewtonsCradle")) as fmu:
        fmu.start(start, tolerance=1e-9)
        fmu.step(0.03)
        peaks = np.array([fmu[f"touch[{i}].peak_force"] for i in range(1, 5)])
        fmu.reset()
        fmu.start(start, tolerance=1e-9)
        tops = np.zeros(4)
        for _ in range(3000):
            fmu.step(1e-5)
            tops = np.maximum(tops, [fmu[name] for name in forces])
    assert np.all(peaks >= tops * (1.0 - 1e-9))
    check_close("peaks", peaks / tops, np.ones(4), 1e-3)  # a sample lies beside the top


def test_a_chain_of_beads_carries_a_solitary_wave(opened_several):
    """Its peak force, the speed of its beads and its own, as of the long wave in a chain under Hertz's law
    (units of stiffness, mass and the speed of the striker)"""
    fmu = opened_several("Chain")
    fmu.reset()
    chain(fmu, 40, "hertz")
    step, rows = 0.02, []
    for _ in range(1950):
        fmu.step(step)
        rows.append(
            [fmu["touch[21].normal_force"], fmu["touch[31].normal_force"], fmu["ball[25].velocity[1]"]]
        )

    def peak(column):
        """Time and height, by a parabola"""
        k = int(np.argmax(column))
        a, b, c = np.polyfit(step * np.arange(-2, 3), column[k - 2 : k + 3], 2)
        return k * step - b / (2.0 * a), c - b * b / (4.0 * a)

    (early, force), (late, _), (_, speed) = map(peak, np.array(rows).T)
    check_close("peak force", force, 0.6395542, 2e-6)
    check_close("speed of a bead", speed, 0.681632, 2e-6)
    check_close("beads per second", 10.0 / (late - early), 0.9055158 * force ** (1.0 / 6.0), 1e-5)


def test_islands_are_contacts_in_touch_that_share_free_bodies(opened_several):
    """Of eight balls, two rows of three and a pair touch, overlapping a little; the middle one is prescribed
    by nobody: a gap parts the rows"""
    fmu = opened_several("Chain")
    fmu.reset()
    places = [0, 0.99, 1.98, 10, 10.99, 20, 20.99, 21.98, 22.97]
    values = {f"ball[{i}].center": [x, 0, 0] for i, x in enumerate(places, 1)}
    fmu.start(values | {f"ball[{i}].center": [1e3 * i, 0, 0] for i in range(len(places) + 1, 41)})
    assert (fmu["solver.islands"], fmu["solver.largest_island"]) == (3, 3)
    fmu.step(20.0)
    assert (fmu["solver.islands"], fmu["solver.largest_island"]) == (0, 0)


@pytest.mark.parametrize("law", ["linear", "hertz"])
def test_the_races_share_a_load_as_springs_do(fmu_path, law):
    """The discrete sum over the balls below; 4.37 F/Z is what handbooks say of many balls (Hertz)."""
    load, power = 10.0, {"linear": 1.0, "hertz": 1.5}[law]
    down = np.maximum(np.cos(np.radians(40.0 * np.arange(9))), 0.0)
    expected = load * down**power / np.sum(down ** (power + 1.0))
    values = {"gravity": [0, 0, 0]} | {f"ball[{i}].initial_velocity": [0, 0, 0] for i in range(1, 10)}
    values |= {f"on_{race}[{i}].law": law for race in ("inner", "outer") for i in range(1, 10)}
    values |= {
        f"on_{race}[{i}].hunt_crossley_factor": 2e3 for race in ("inner", "outer") for i in range(1, 10)
    }
    with ContactFmu(fmu_path("BallBearing")) as fmu:
        fmu.start(values, tolerance=1e-9)
        fmu.step({"linear": 3e-3, "hertz": 8e-3}[law])  # until the damping has brought it to rest
        found = [fmu[f"on_inner[{i}].normal_force"] for i in range(1, 10)]
        assert fmu["solver.islands"] == 1
        check_close("shares", found, expected, 5e-5 * load)
    if law == "hertz":
        check_close("handbook", max(found), 4.37 * load / 9, 0.01 * load)


def test_a_tight_tolerance_costs_a_bearing_few_steps_more(fmu_path):
    """Where errors by rounding were not allowed for, the steps became fourteen times as many."""
    steps = {}
    with ContactFmu(fmu_path("BallBearing")) as fmu:
        for tolerance in (1e-5, 1e-9):
            fmu.reset()
            fmu.start({}, tolerance=tolerance)
            fmu.step(0.01)
            steps[tolerance] = fmu["solver.steps"]
    assert steps[1e-9] < 2 * steps[1e-5]


@pytest.mark.parametrize(("law", "thrust"), [("linear", 100.0), ("linear", 700.0), ("hertz", 700.0)])
def test_a_thrust_opens_the_angle_of_contact(fmu_path, law, thrust):
    """F = 9 Q sin alpha, with Q of two springs in series, stretched by A / cos alpha - A."""
    apart, stiffness, power = 4e-4, *{"linear": (1e8, 1.0), "hertz": (1e10, 1.5)}[law]

    def load(alpha):
        return stiffness * (0.5 * apart * (1.0 / np.cos(alpha) - 1.0)) ** power

    alpha = brentq(lambda alpha: 9.0 * load(alpha) * np.sin(alpha) - thrust, 1e-3, 1.0, xtol=1e-15)
    races = [f"on_{race}[{i}]" for race in ("inner", "outer") for i in range(1, 10)]
    values = {f"{one}.law": law for one in races} | {f"{one}.hunt_crossley_factor": 5.0 for one in races}
    with ContactFmu(fmu_path("GroovedBearing")) as fmu:
        fmu.start(values | {"inner.external_force": [0, thrust, 0]}, tolerance=1e-10)
        fmu.step(0.06)  # until the damping has brought it to rest
        check_close("loads", [fmu[f"{one}.normal_force"] for one in races], load(alpha), 1e-6 * load(alpha))
        check_close("shift", fmu["inner.displacement"], [0, apart * np.tan(alpha), 0], 1e-11)


def fall(fmu, x, steps=1):
    """Where the ball of a Galton board is after 0.3 s, some ten impacts"""
    fmu.reset()
    fmu.start({"ball.center": [x, 0, 0.018]}, tolerance=1e-11)
    for _ in range(steps):
        fmu.step(0.3 / steps)
    return fmu["ball.position"]


@pytest.mark.parametrize("x", [1e-4, 2.3e-4, 4.1e-4])
def test_a_ball_among_pegs_goes_by_closed_forms(opened, x):
    """Each impact is that of a pair, though the ball has thirty contacts; mirrored starts fall mirrored."""
    fmu = opened("GaltonBoard")
    once = fall(fmu, x)
    impacts = sum(fmu[f"hit[{i}].onsets"] for i in range(1, 29)) + sum(
        fmu[f"side[{i}].onsets"] for i in (1, 2)
    )
    assert impacts >= 3 and fmu["solver.fallbacks"] == 0
    check_close("mirrored", fall(fmu, -x), once * [-1, 1, 1], 1e-9)
    check_close("in 50 steps", fall(fmu, x, 50), once, 1e-9)
