"""Several contacts at once: Newton's cradle, ball bearings, a Galton board, and the islands they make."""

import numpy as np
import pytest
from scipy.optimize import brentq

from contact_fmus.bench.instructions import instructions
from contact_fmus.fmu.contact_fmu import ContactFmu
from contact_fmus.fmu.host import Case
from support.checks import METHODS, check_close, run, start
from support.reference.chain import velocities
from support.reference.islands import Islands
from support.reference.kept import kept
from support.scenes.agreement import pick, seeds

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


def test_a_light_ball_on_a_heavy_one_is_as_accurate_as_alone(opened_several):
    """The rounding of a heavy contact must not count as an error that is allowed in a light ball."""
    values = {"ball[1].mass": 1e4, "ball[2].mass": 1e-3, "ball[1].radius": 0.5, "ball[2].radius": 0.05}
    values |= {"ball[1].center": [0, 0, 0.5 - 9.81e-5], "ball[2].center": [0.1, 0, 0.5 + 0.540823]}
    for i, name in ((1, "land[1]"), (2, "touch[1,2]")):
        values |= {f"ball[{i}].motion": "free", f"ball[{i}].rotation": "free", f"{name}.friction": "elastic"}
        values |= {f"{name}.friction_coefficient": 0.3, f"{name}.penalty_factor": (1e9, 1e3)[i - 1]}
        values |= {f"{name}.tangential_stiffness": (8e8, 8e2)[i - 1], f"{name}.method": "penalty"}
    values |= {"touch[1,2].viscous_penalty_factor": 0.1, "touch[1,2].tangential_damping": 0.01}
    fmu, ends = opened_several("Islands"), []
    for method, tolerance in (("event_driven", 1e-9), ("cvode_bdf", 1e-12)):
        run(fmu, values, 0.3, 1, tolerance, method)
        ends.append(fmu["ball[2].angular_velocity"].copy())
    assert fmu["touch[1,2].onsets"] > 0
    check_close("spin", ends[0], ends[1], 1e-7)


def test_an_island_under_hertz_law_takes_few_series(fmu_path):
    """The force bends at a touch and at a release, where a series in time converges ever more slowly."""
    values = {f"touch[{i}].law": "hertz" for i in range(1, 5)}
    values |= {f"touch[{i}].hertz_stiffness": 1e8 for i in range(1, 5)}
    with ContactFmu(fmu_path("NewtonsCradle")) as fmu:
        run(fmu, values, 0.03, 1, 1e-5, None)
        found = [fmu[f"ball[{i}].velocity"][0] for i in range(1, 6)]
        check_close("velocities", found, velocities(5, "hertz", 60.0), 1e-10)
        assert fmu["solver.fallbacks"] == 0
        assert fmu["solver.steps"] < 50


@pytest.mark.parametrize("law", ["linear", "hertz"])
def test_communication_points_and_saved_states_end_no_step_of_an_island(fmu_path, law):
    """If each communication point began a new step, 997 of them would cost ten times as much."""
    values = {f"touch[{i}].law": law for i in range(1, 5)}

    def go(fmu, steps, first=0, last=1.0):
        for _ in range(first, round(last * steps)):
            fmu.step(0.03 / steps)
        names = [f"ball[{i}].{one}" for i in range(1, 6) for one in ("velocity", "position")]
        names += [f"touch[{i}].{one}" for i in range(1, 5) for one in ("normal_force", "onsets")]
        return np.hstack([np.ravel(fmu[name]) for name in [*names, "energy.total"]])

    with ContactFmu(fmu_path("NewtonsCradle")) as fmu:
        evaluations, ends = [], []
        for steps in (1, 997):
            start(fmu, values, 1e-9)
            ends.append(go(fmu, steps))
            evaluations.append(fmu["solver.force_evaluations"])
        check_close("the end", ends[1], ends[0], 1e-9)
        # the phase of a chain that follows an event in a short step ends with the step, the next is long
        assert evaluations[1] < (4 if law == "linear" else 2) * evaluations[0]
        start(fmu, values, 1e-9)
        within = go(fmu, 997, last=0.02)  # the balls overlap
        assert within[-9:-1:2].max() > 0.0
        kept = fmu.save()
        assert np.array_equal(go(fmu, 997, 20), ends[1]), "saving is not seen"
        fmu.restore(kept)
        assert np.array_equal(go(fmu, 997, 20), ends[1])
        with ContactFmu(fmu_path("NewtonsCradle")) as other:
            start(other, values, 1e-9)
            other.restore(bytes(kept))
            assert np.array_equal(go(other, 997, 20), ends[1])


@pytest.mark.parametrize("law", ["linear", "hertz"])
def test_the_peaks_of_one_long_step_are_the_tops_of_all_short_ones(fmu_path, law):
    values, tops = {f"touch[{i}].law": law for i in range(1, 5)}, []
    forces = [f"touch[{i}].normal_force" for i in range(1, 5)]
    with ContactFmu(fmu_path("NewtonsCradle")) as fmu:
        run(fmu, values, 0.03, 1, 1e-9, None)
        peaks = np.array([fmu[f"touch[{i}].peak_force"] for i in range(1, 5)])
        run(fmu, values, 0.03, 3000, 1e-9, None, lambda fmu: tops.append([fmu[name] for name in forces]))
    tops = np.max(tops, axis=0)
    assert np.all(peaks >= tops * (1.0 - 1e-9))
    check_close("peaks", peaks / tops, np.ones(4), 1e-3)  # a sample lies beside the top


def test_a_chain_of_beads_carries_a_solitary_wave(opened_several):
    """Its peak force, the speed of its beads and its own speed are those of the long wave in a chain under
    Hertz's law, in units of stiffness, mass and the speed of the striker."""
    fmu = opened_several("Chain")
    chain(fmu, 40, "hertz")
    step, rows = 0.02, []
    for _ in range(1950):
        fmu.step(step)
        rows.append([fmu[f"touch[{i}].normal_force"] for i in (21, 31)] + [fmu["ball[25].velocity[1]"]])

    def peak(column):
        """Returns time and height of the peak, by a parabola."""
        k = int(np.argmax(column))
        a, b, c = np.polyfit(step * np.arange(-2, 3), column[k - 2 : k + 3], 2)
        return k * step - b / (2.0 * a), c - b * b / (4.0 * a)

    (early, force), (late, _), (_, speed) = map(peak, np.array(rows).T)
    check_close("peak force", force, 0.6395542, 2e-6)
    check_close("speed of a bead", speed, 0.681632, 2e-6)
    check_close("beads per second", 10.0 / (late - early), 0.9055158 * force ** (1.0 / 6.0), 1e-5)


def test_islands_are_contacts_in_touch_that_share_free_bodies(opened_several):
    """Two rows of three balls and a pair overlap a little. A gap parts the rows."""
    fmu = opened_several("Chain")
    places = [0, 0.99, 1.98, 10, 10.99, 20, 20.99, 21.98, 22.97]
    values = {f"ball[{i}].center": [x, 0, 0] for i, x in enumerate(places, 1)}
    fmu.start(values | {f"ball[{i}].center": [1e3 * i, 0, 0] for i in range(len(places) + 1, 41)})
    assert (fmu["solver.islands"], fmu["solver.largest_island"]) == (3, 3)
    fmu.step(20.0)
    assert (fmu["solver.islands"], fmu["solver.largest_island"]) == (0, 0)


def bouncing(friction, moving, stiffness, heights):
    """Returns start values of Islands.fmu: balls bounce and slide on the floor one after another, too far
    from each other to touch. Balls not in `moving` are fixed far away. An external force acts on each."""
    values = {"gravity": [0.0, 0.0, -9.81]}
    for i in range(1, 7):
        values |= {
            f"land[{i}].friction": friction,
            f"land[{i}].method": "penalty",
            f"land[{i}].penalty_factor": stiffness,
            f"ball[{i}].center": [i, 1e3, 1e3],
        }
        if i not in moving:
            values[f"ball[{i}].motion"] = "fixed"
            continue
        values |= {
            f"ball[{i}].rotation": "free",
            f"ball[{i}].center": [i, 0.0, 0.13 + 0.02 * heights[i - 1]],
            f"ball[{i}].initial_velocity": [0.3, 0.02 * i, 0.0],
            f"ball[{i}].initial_angular_velocity": [2.0, -5.0, float(i)],
            f"ball[{i}].external_force": [0.1 * i, 0.0, 0.5],
        }
    return values


@pytest.mark.parametrize("friction", ["none", "regularized", "elastic"])
@pytest.mark.parametrize("steps", [1, 29])
def test_balls_that_never_meet_move_as_each_does_alone(opened_several, friction, steps):
    fmu, names = opened_several("Islands"), ("position", "velocity", "angular_velocity", "orientation")

    def run(moving):
        start(fmu, bouncing(friction, moving, 1e4, (1, 2, 3, 0, 1, 2)), 1e-9)
        before, islands = fmu["energy.total"], 0
        for _ in range(steps):
            fmu.step(0.5 / steps)
            islands = max(islands, fmu["solver.islands"])
        check_close("energy", fmu["energy.total"], before, 1e-9)
        return {i: np.hstack([fmu[f"ball[{i}].{name}"] for name in names]) for i in moving}, islands

    together, islands = run(range(1, 7))
    assert steps == 1 or islands > 1
    assert friction != "none" or fmu["solver.fallbacks"] == 0, "each is a pair, although all are listed"
    for i in (1, 4, 6):
        check_close(f"ball {i}", together[i], run([i])[0][i], 1e-9)


def test_fixed_bodies_that_overlap_press_while_a_ball_bounces_and_rubs(opened_several):
    fmu, ends = opened_several("Islands"), []
    for height in (1e3, 0.09):
        values = {"ball[2].center": [2.0, 0.0, height]}
        run(fmu, bouncing("regularized", [1], 1e4, (1, 1, 1, 1, 1, 1)) | values, 0.3, 1, 1e-9)
        ends.append(np.hstack([fmu["ball[1].velocity"], fmu["ball[1].angular_velocity"]]))
    check_close("mean force", fmu["land[2].mean_force"], [0.0, 0.0, 100.0], 1e-9)
    check_close("motion", ends[1], ends[0], 1e-8)


def test_friction_of_prescribed_bodies_is_the_same_beside_a_free_one(opened_several):
    """At the touch the limit of friction is zero, and no body feels how it grows. The slip turns."""
    fmu, speed, bend, forces = opened_several("Islands"), [0.6, -0.5, -0.5], [0.0, 30.0, 0.0], []
    for moving in ([], [2]):
        values = bouncing("elastic", moving, 1e4, [1] * 6) | {"ball[1].motion": "prescribed"}
        values |= {"ball[1].center": [0, 0, 0.101], "ball[1].prescribed_velocity": speed}
        values |= {"ball[1].prescribed_displacement.derivatives": [speed, bend], "land[1].law": "hertz"}
        run(fmu, values | {"ball[1].prescribed_velocity.derivatives": [bend]}, 0.02, 1, 1e-9)
        forces.append(fmu["land[1].mean_force"])
    check_close("mean force", forces[1], forces[0], 1e-9)


@pytest.mark.parametrize("loads", ["a touch", "gravity"])
@pytest.mark.parametrize("method", METHODS[:2])
def test_friction_sticks_where_its_limit_grows_faster_than_its_spring(opened_several, method, loads):
    """A load that jumps makes the limit rise at once, by the dashpot of the normal force."""
    values = {"ball[1].motion": "free", "ball[2].motion": "fixed" if loads == "gravity" else "free"}
    values |= {"ball[1].center": [0.0, 0.0, 0.1 - 9.81e-4], "ball[1].initial_velocity": [0.1, 0.0, 0.0]}
    values |= {"ball[2].center": [0.0, 0.0, 0.31], "ball[2].initial_velocity": [0.0, 0.0, -1.0]}
    values |= {"land[1].method": "penalty_dynamic", "land[1].tangential_stiffness": 1e4}
    fmu = run(opened_several("Islands"), bouncing("elastic", [], 1e4, []) | values, 0.01, 1, 1e-10, method)
    place, speed = fmu["ball[1].position"][0], fmu["ball[1].velocity"][0]
    fmu["gravity"] = [0.0, 0.0, -109.81 if loads == "gravity" else -9.81]
    fmu.step(0.001)
    slides = max(fmu["touch[1,2].last_onset_time"] - 0.01, 0.0)
    stretched = fmu["ball[1].position"][0] - place - slides * (speed - 0.15 * 9.81 * slides)
    check_close("friction", fmu["land[1].friction_force"][0], -(0.3 * 9.81 + 1e4 * stretched), 1e-8)


def test_a_ball_that_spin_drives_while_it_bounces_meets_its_neighbour(opened_several):
    """Before the bounce is over, friction turns spin into a speed several times that of the impact. If the
    bound of that speed left the energy of rotation out, the neighbour would count as far until then."""
    values = bouncing("regularized", [], 1e3, []) | {"gravity": [0.0, 0.0, 0.0]}
    values |= {"ball[1].motion": "free", "ball[1].rotation": "free", "ball[2].motion": "free"}
    values |= {"ball[1].center": [0.0, 0.0, 0.1001], "ball[1].initial_velocity": [0.0, 0.0, -0.3]}
    values |= {"ball[1].initial_angular_velocity": [0.0, 200.0, 0.0], "ball[2].center": [0.25, 0.0, 0.12]}
    values |= {"land[1].friction_coefficient": 20.0, "land[1].slip_velocity_control": "user_defined"}
    values |= {"land[1].characteristic_slip_velocity": 0.1}
    values |= {"touch[1,2].method": "penalty", "touch[1,2].penalty_factor": 1e5}
    fmu, ends = opened_several("Islands"), {}
    for method in METHODS[:2]:
        run(fmu, values, 0.1, 1, 1e-10, method)
        ends[method] = np.hstack([fmu[f"ball[{i}].{u}"] for i in (1, 2) for u in ("position", "velocity")])
    assert fmu["touch[1,2].onsets"] == 1
    check_close("motion", ends["event_driven"], ends["cvode_bdf"], 1e-7)


def test_what_flies_is_not_integrated_and_islands_are_solved_one_by_one(built):
    """Six balls cost about six times as much as one, although they touch the floor at different times. Where
    all were integrated whenever one was in contact, they cost twelve times as much."""
    counts = []
    for moving in ([1], range(1, 7)):
        start = bouncing("elastic", moving, 1e6, range(1, 7))
        counts.append(instructions(Case("balls", built["Islands"], 0.5, start=start, tolerance=1e-9)))
    assert counts[1] < 9 * counts[0]


@pytest.mark.parametrize("law", ["linear", "hertz"])
def test_the_races_share_a_load_as_springs_do(fmu_path, law):
    """The force is the discrete sum over the balls below. Handbooks give 4.37 F/Z for many balls (Hertz)."""
    load, power = 10.0, {"linear": 1.0, "hertz": 1.5}[law]
    down = np.maximum(np.cos(np.radians(40.0 * np.arange(9))), 0.0)
    expected = load * down**power / np.sum(down ** (power + 1.0))
    values = {"gravity": [0, 0, 0]} | {f"ball[{i}].initial_velocity": [0, 0, 0] for i in range(1, 10)}
    values |= {f"on_{race}[{i}].law": law for race in ("inner", "outer") for i in range(1, 10)}
    values |= {f"on_{row}[{i}].hunt_crossley_factor": 2e3 for row in ("inner", "outer") for i in range(1, 10)}
    with ContactFmu(fmu_path("BallBearing")) as fmu:
        start(fmu, values, 1e-9)
        fmu.step({"linear": 3e-3, "hertz": 8e-3}[law])  # until the damping has brought it to rest
        found = [fmu[f"on_inner[{i}].normal_force"] for i in range(1, 10)]
        assert fmu["solver.islands"] == 1
        check_close("shares", found, expected, 5e-5 * load)
    if law == "hertz":
        check_close("handbook", max(found), 4.37 * load / 9, 0.01 * load)


def test_a_tight_tolerance_costs_a_bearing_few_steps_more(fmu_path):
    """Without room for rounding there would be 14 times as many. A release makes few of them too long."""
    with ContactFmu(fmu_path("BallBearing")) as fmu:
        steps = [run(fmu, {}, 0.01, 1, tolerance, None)["solver.steps"] for tolerance in (1e-5, 1e-9)]
        assert steps[1] < 2 * steps[0] and fmu["solver.rejected_steps"] < 4


@pytest.mark.parametrize(("law", "thrust"), [("linear", 100.0), ("linear", 700.0), ("hertz", 700.0)])
def test_a_thrust_opens_the_angle_of_contact(fmu_path, law, thrust):
    """F = 9 Q sin alpha, where two springs in series, stretched by A / cos alpha - A, give Q."""
    apart, stiffness, power = 4e-4, *{"linear": (1e8, 1.0), "hertz": (1e10, 1.5)}[law]

    def load(alpha):
        return stiffness * (0.5 * apart * (1.0 / np.cos(alpha) - 1.0)) ** power

    alpha = brentq(lambda alpha: 9.0 * load(alpha) * np.sin(alpha) - thrust, 1e-3, 1.0, xtol=1e-15)
    races = [f"on_{race}[{i}]" for race in ("inner", "outer") for i in range(1, 10)]
    values = {f"{one}.law": law for one in races} | {f"{one}.hunt_crossley_factor": 5.0 for one in races}
    with ContactFmu(fmu_path("GroovedBearing")) as fmu:
        start(fmu, values | {"inner.external_force": [0, thrust, 0]}, 1e-10)
        fmu.step(0.06)  # until the damping has brought it to rest
        check_close("loads", [fmu[f"{one}.normal_force"] for one in races], load(alpha), 1e-6 * load(alpha))
        check_close("shift", fmu["inner.displacement"], [0, apart * np.tan(alpha), 0], 1e-11)
        settled = fmu["solver.force_evaluations"]
        fmu.step(0.2)  # later, rounding makes the balls leave their places, which are unstable
        assert fmu["solver.force_evaluations"] < settled + 2000


def fall(fmu, x, steps=1):
    """Returns where the ball of a Galton board is after 0.3 s and some ten impacts."""
    return run(fmu, {"ball.center": [x, 0, 0.018]}, 0.3, steps, 1e-11, None)["ball.position"]


@pytest.mark.parametrize("x", [1e-4, 2.3e-4, 4.1e-4])
def test_a_ball_among_pegs_goes_by_closed_forms(opened, x):
    """Each impact is that of a pair, though the ball has thirty contacts. Mirrored starts fall mirrored."""
    fmu = opened("GaltonBoard")
    once = fall(fmu, x)
    onsets = [fmu[f"hit[{i}].onsets"] for i in range(1, 29)] + [fmu[f"side[{i}].onsets"] for i in (1, 2)]
    assert sum(onsets) >= 3 and fmu["solver.fallbacks"] == 0
    check_close("mirrored", fall(fmu, -x), once * [-1, 1, 1], 1e-9)
    check_close("in 50 steps", fall(fmu, x, 50), once, 1e-9)


# Balls that touch each other and two planes, in rows, rings, trees and heaps, against a reference; and rows
# that move along themselves, which are chains in closed form.
#
# CONTACT_SCENES=1000 runs a thousand of them.

END = 0.15  # s
AWAY = 1e4  # m, where balls are that a scene does not need
TOLERANCE = 1e-11


def places_of(random, kind, radii):
    """Returns centres of balls that touch or nearly do."""
    count = len(radii)
    if kind == "ring" and count > 2:
        radii[:] = radii[0]
        around = 2.0 * np.pi * np.arange(count) / count
        reach = radii[0] / np.sin(np.pi / count) * random.uniform(0.999, 1.01)
        return reach * np.array([np.cos(around), np.sin(around), np.zeros(count)]).T
    centres = [np.zeros(3)]
    while len(centres) < count:
        k = len(centres)
        on = k - 1 if kind == "row" else int(random.integers(k))
        way = random.normal(size=3) * (0.3 if kind == "row" else 1.0) + (kind == "row") * np.eye(3)[0]
        gap = pick(random, 0.1, 0.02) if kind == "heap" else pick(random, 0.0, -1e-4, 1e-3, 1e-2)
        new = centres[on] + way / np.linalg.norm(way) * (radii[on] + radii[k] + gap)
        apart = [np.linalg.norm(new - one) - r - radii[k] for one, r in zip(centres, radii, strict=False)]
        if all(far > 1e-3 for j, far in enumerate(apart) if j != on):
            centres.append(new)
    return np.array(centres)


def ball(random, radius, centre, turning, moves):
    turns = turning and random.random() < 0.8
    force = random.normal(size=3) if moves and random.random() < 0.2 else np.zeros(3)
    velocity = random.normal(size=3) * pick(random, 0.0, 0.3, 1.0) - 1.5 * centre * pick(random, 0.0, 1.0)
    values = {"radius": radius, "mass": random.uniform(0.2, 3.0), "motion": "free" if moves else "fixed"}
    values |= {"rotation": "free" if turns else "none", "center": centre}
    spin = random.normal(size=3) * pick(random, 0.0, 5.0) if turns else np.zeros(3)
    return values | {"velocity": velocity if moves else np.zeros(3), "spin": spin, "force": force}


def contact(random, source, destination, turning):
    law = pick(random, "linear", "linear", "hertz")
    stiffness = 10.0 ** random.uniform(4.0, 7.0) * (20.0 if law == "hertz" else 0.3)
    damping = random.uniform(0.02, 0.5) if law == "hertz" else random.uniform(0.01, 0.6) * np.sqrt(stiffness)
    mu, c = random.uniform(0.05, 0.6), pick(random, 0.0, damping)
    values = {"source": source, "destination": destination, "law": law, "k": stiffness, "c": c}
    values |= {"dashpot": pick(random, "non_adhesive", "unclamped", "approach_only")}
    values |= {"friction": pick(random, "none", "regularized", "elastic") if turning else "none", "mu": mu}
    values |= {"mu_static": mu * pick(random, 1.0, 1.3), "v_0": 10.0 ** random.uniform(-3.0, -1.0)}
    values |= {"k_t": 10.0 ** random.uniform(3.0, 5.5), "c_t": 10.0 ** random.uniform(0.0, 2.0)}
    return values


def scene_of(seed):
    """Returns balls, planes, contacts and gravity."""
    random = np.random.default_rng(seed)
    count, turning = int(random.integers(2, 7)), random.random() < 0.6
    kind = pick(random, "row", "ring", "tree", "heap")
    radii = random.uniform(0.05, 0.15, count)
    centres = places_of(random, kind, radii)
    balls = [
        ball(random, radius, centre, turning, k == 0 or random.random() < 0.85)
        for k, (radius, centre) in enumerate(zip(radii, centres, strict=True))
    ]
    below, beside = (centres - radii[:, None]).min(axis=0)[[2, 0]]
    has_floor, has_wall = kind == "heap" or random.random() < 0.4, random.random() < 0.2
    tilted = np.array([1.0, 0.2, 0.1]) / np.linalg.norm([1.0, 0.2, 0.1])
    planes = [((0.0, 0.0, 1.0), (0.0, 0.0, below - pick(random, 0.0, 1e-3, 0.05) if has_floor else -50.0))]
    planes += [(tuple(tilted), (beside - 0.1 if has_wall else -50.0, 0.0, 0.0))]
    pairs = [(i, j) for i in range(count) for j in (*range(i + 1, count), -1, -2)]
    gravity = (0.0, 0.0, -9.81 if has_floor else pick(random, 0.0, -1.0))
    return balls, planes, [contact(random, i, j, turning) for i, j in pairs], gravity


def row_of(seed):
    """Returns a scene as scene_of does: six undamped balls in a row that move along it between two walls."""
    random = np.random.default_rng(seed)
    along = pick(random, np.eye(3)[int(random.integers(3))], random.normal(size=3))
    along = along / np.linalg.norm(along)
    radii = np.full(6, 0.1) if random.random() < 0.3 else random.uniform(0.05, 0.15, 6)
    gaps = [pick(random, 0.0, 0.0, -1e-4, 1e-3, 1e-2) for _ in range(5)]
    places = np.concatenate([[0.0], np.cumsum(radii[:-1] + radii[1:] + gaps)])
    fixed, forced = pick(random, -1, -1, -1, int(random.integers(6))), random.random() < 0.3
    balls = []
    for k in range(6):
        speed = random.normal() * pick(random, 0.0, 0.3, 1.0) - 1.5 * places[k] * pick(random, 0.0, 1.0)
        force = forced * 3.0 * random.normal()
        own = {"velocity": speed * along, "force": force * along} if k != fixed else {}
        balls.append(ball(random, radii[k], places[k] * along, False, k != fixed) | own)
        balls[k]["mass"] = pick(random, 1.0, balls[k]["mass"])
        balls[k]["force"] = balls[k]["force"] if own else np.zeros(3)
    away = [pick(random, 0.0, 1e-3, 0.05, 50.0) for _ in range(2)]
    planes = [(tuple(along), tuple((-radii[0] - away[0]) * along))]
    planes += [(tuple(-along), tuple((places[5] + radii[5] + away[1]) * along))]
    pairs = [(i, j) for i in range(6) for j in (*range(i + 1, 6), -1, -2)]
    made = (contact(random, i, j, False) | {"k": 10.0 ** random.uniform(3.5, 7.0)} for i, j in pairs)
    contacts = [one | {"law": "linear", "c": 0.0} for one in made]
    return balls, planes, contacts, tuple(-9.81 * pick(random, 0.0, 1.0) * along)


def values_of(balls, planes, contacts, gravity):
    """Returns start values of Islands.fmu."""
    values = {"gravity": list(gravity)}
    for plane, (normal, place) in zip(("floor", "wall"), planes, strict=True):
        values |= {f"{plane}.axis": list(normal), f"{plane}.center": list(place)}
    names = {"velocity": "initial_velocity", "force": "external_force", "spin": "initial_angular_velocity"}
    for k in range(1, 7):
        one = balls[k - 1] if k <= len(balls) else {"motion": "fixed", "center": (AWAY * k, AWAY, AWAY)}
        unused = {"velocity", "force"} if one["motion"] == "fixed" else set()
        unused |= {"spin"} if one.get("rotation") != "free" else set()
        for name, value in one.items():
            if name not in unused:
                plain = value.tolist() if isinstance(value, np.ndarray) else value
                values[f"ball[{k}].{names.get(name, name)}"] = plain
    for one in contacts:
        i, j = one["source"] + 1, one["destination"] + 1
        name = {0: f"land[{i}]", -1: f"side[{i}]"}.get(j, f"touch[{i},{j}]")
        hertz = one["law"] == "hertz"
        values |= {f"{name}.{key}": one[key] for key in ("law", "dashpot", "friction")}
        values |= {f"{name}.method": "penalty_dynamic" if one["c"] else "penalty"}
        values |= {f"{name}.{'hertz_stiffness' if hertz else 'penalty_factor'}": one["k"]}
        values |= {f"{name}.{'hunt_crossley_factor' if hertz else 'viscous_penalty_factor'}": one["c"]}
        values |= {f"{name}.friction_coefficient": one["mu"]}
        values |= {f"{name}.static_friction_coefficient": one["mu_static"]}
        values |= {f"{name}.slip_velocity_control": "user_defined"}
        values |= {f"{name}.characteristic_slip_velocity": one["v_0"]}
        values |= {f"{name}.tangential_stiffness": one["k_t"], f"{name}.tangential_damping": one["c_t"]}
    return values


def found_twice(scene):
    (fine, onsets), (coarse, _) = (Islands(*scene).run(END, tolerance) for tolerance in (1e-13, 1e-12))
    return fine, coarse, onsets


def check_motion(fmu, scene, steps, least, tolerance=TOLERANCE):
    """Compares with the reference, within `least` or the reference's own uncertainty. Returns the number of
    contacts that began, and that of the reference."""
    fine, coarse, onsets = kept([*scene, END], lambda: found_twice(scene))
    values = values_of(*scene)
    start(fmu, values, tolerance)
    balls = range(1, len(scene[0]) + 1)
    energy = fmu["energy.total"]
    for _ in range(steps):
        fmu.step(END / steps)
    found = [
        [*fmu[f"ball[{k}].position"], *fmu[f"ball[{k}].velocity"], *fmu[f"ball[{k}].angular_velocity"]]
        for k in balls
    ]
    known = 10.0 * np.abs(coarse - fine).max()  # where motion multiplies errors, the reference does too
    check_close("motion", found, fine, max(least, known))
    check_close("energy", fmu["energy.total"], energy, 1e-9 * max(1.0, abs(energy)))
    touched = [name for name in values if name.endswith(".law")]
    return sum(fmu[name.replace(".law", ".onsets")] for name in touched), onsets


# In three a ball is far from the others: the rounding of its gaps must not loosen theirs. In 7624 a slip
# reverses within a step, where regularized friction bends. In 9245 balls touch right after the start, where
# the polynomial of a long step shows them nearer than they are.
CASES = [*((seed, TOLERANCE) for seed in (*seeds(8), 74, 386, 396)), (7624, 1e-9), (9245, 1e-5)]


@pytest.mark.parametrize("seed, tolerance", CASES)
def test_islands_move_as_in_the_reference(opened_several, seed, tolerance):
    least = max(1e-7, 10.0 * tolerance)
    found, expected = check_motion(opened_several("Islands"), scene_of(seed), 1, least, tolerance)
    assert found >= expected


@pytest.mark.parametrize("seed", seeds(12))
@pytest.mark.parametrize("steps", [1, 29])
def test_rows_are_chains_and_move_as_in_the_reference(opened_several, seed, steps):
    """Along an axis no rounding turns a normal, so that the general segment is never needed. Balls that rest
    at a touch, up to rounding, may bounce by as much: their contacts are not counted."""
    scene = row_of(seed)
    fmu = opened_several("Islands")
    check_motion(fmu, scene, steps, 1e-9)
    if np.count_nonzero(scene[1][0][0]) == 1:
        assert fmu["solver.fallbacks"] == 0
