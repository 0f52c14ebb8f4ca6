"""contact.peak_force and contact.peak_penetration, against a reference that follows every turn of a contact.

The reference is the motion of a ball pressed on a fixed body in a plane, in polar coordinates about the
body's centre, so that the gap has digits of its own:

    side g'' = H^2 / d^3 + n.f / m - side (p_n g + p_nv g') / m,   H' = d n x f / m,   d = reach + side g
"""

import math
from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from contact_fmus.fmu.contact_fmu import FmuError
from support.checks import FMU, check_close, run, start
from support.scenes.agreement import seeds
from support.scenes.head_on import GEOMETRIES, head_on
from support.scenes.random_scenes import random_scene
from support.scenes.stiff_scenes import SCENES, stiff_scene

METHOD = "event_driven"
TOLERANCE = 1e-10
RADII = {"inside": 0.4, "outside": 0.6}  # r_d - r_s, r_d + r_s


class Pressed(NamedTuple):
    """`force` holds a value and two time derivatives, in the plane of n at the start and of `along`."""

    location: str
    mass: float
    stiffness: float
    damping: float
    depth: float
    closing: float  # -g' at the start [m/s]
    along: float  # speed along the contact [m/s]
    force: np.ndarray

    @property
    def side(self):
        return -1 if self.location == "inside" else 1


def frame(random):
    """Returns n, a direction across it, and one across both."""
    return np.linalg.qr(random.normal(size=(3, 3)))[0].T


def configuration(scene, shape, dashpot, axes):
    n, across, axis = axes
    reach = RADII[scene.location]
    force = [row[0] * n + row[1] * across for row in scene.force]
    values = head_on(
        shape, scene.location, source_mass=scene.mass, source_center=(reach * n).tolist(),
        source_initial_displacement=(-scene.side * scene.depth * n).tolist(),
        source_initial_velocity=(-scene.side * scene.closing * n + scene.along * across).tolist(),
        source_external_force=force[0].tolist(), contact_method="penalty_dynamic", contact_dashpot=dashpot,
        contact_penalty_factor=scene.stiffness, contact_viscous_penalty_factor=scene.damping,
    )  # fmt: skip
    values["source.external_force.derivatives"] = [row.tolist() for row in force[1:]]
    if shape == "cylinder":
        values["destination.axis"] = axis.tolist()
    return values


def top(samples, function, times):
    """Returns the largest value of a function between its samples, searched for about the largest sample."""
    best = int(np.argmax(samples))
    about = times[max(best - 1, 0)], times[min(best + 1, len(times) - 1)]
    limit = {"xatol": 1e-9 * (about[1] - about[0])}
    found = minimize_scalar(lambda t: -function(t), bounds=about, method="bounded", options=limit)
    return max(samples[best], -found.fun)


def reference_peaks(scene, gap, rate, end):
    """Returns peak force and penetration while contact lasts, else None. Time is in 1/omega."""
    m, k, c, side = scene.mass, scene.stiffness, scene.damping, scene.side
    unit, reach = math.sqrt(m / k), RADII[scene.location]

    def slope(tau, y):
        d, t = reach + side * y[0], tau * unit
        fx, fy = scene.force[0] + t * scene.force[1] + t * t / 2 * scene.force[2]
        cosine, sine = math.cos(y[2]), math.sin(y[2])
        along_n, across = (fx * cosine + fy * sine) / m, (fy * cosine - fx * sine) / m
        bend = side * (y[3] ** 2 / d**3 + along_n) - (k * y[0] + c * y[1]) / m
        return [unit * y[1], unit * bend, unit * y[3] / d**2, unit * d * across]

    begin = [gap, rate, 0.0, (reach + side * gap) * scene.along]
    size = (abs(scene.force[0][0]) + m * scene.along**2 / reach) / k
    small = [1e-14 * size, 1e-14 * size / unit, 1e-15, 1e-15 * max(abs(begin[3]), 1e-9)]
    options = {"rtol": 1e-13, "atol": small, "dense_output": True, "max_step": 0.5}
    path = solve_ivp(slope, (0, end / unit), begin, "DOP853", **options)

    def force(tau):
        y = path.sol(tau)
        return -(k * y[0] + c * y[1])

    forces = np.array([force(tau) for tau in path.t])
    if np.max(path.y[0][1:]) > 0 or np.min(forces[1:]) < 1e-6 * np.max(forces):
        return None
    return top(forces, force, path.t), top(-path.y[0], lambda tau: -path.sol(tau)[0], path.t)


def random_pressed(random):
    location = ["inside", "outside"][random.integers(2)]
    side = -1 if location == "inside" else 1
    mass, stiffness = 10 ** random.uniform(-2, 1), 10 ** random.uniform(4, 12)
    omega = math.sqrt(stiffness / mass)
    ratio = [
        random.uniform(0.005, 0.5),
        random.uniform(0.5, 1.0),
        random.uniform(0.9, 1.1),
        random.uniform(1, 2),
        10 ** random.uniform(0, 2),
    ][random.integers(5)]
    load = 10 ** random.uniform(-0.5, 1.5) * mass
    depth = load / stiffness
    end = 10 ** random.uniform(0, 2.5) / omega
    force = np.zeros((3, 2))
    force[0] = -side * load, random.uniform(-1, 1) * load * random.integers(2)
    if random.integers(2):
        force[1:] = random.normal(size=(2, 2)) * random.choice([0.1, 0.5, 2.0]) * load / end
        force[2] /= end
    part = random.choice([0.0, 0.0, 1.0, random.uniform(0, 1), random.uniform(1, 1.9)])
    closing = depth * omega * random.uniform(0, 3) * random.integers(2)
    along = random.uniform(0, 0.3) * math.sqrt(load / mass * RADII[location]) * random.integers(2)
    damping = 2 * ratio * math.sqrt(stiffness * mass)
    return Pressed(location, mass, stiffness, damping, part * depth, closing, along, force), end


@pytest.mark.parametrize("dashpot", ["unclamped", "non_adhesive"])
# tops within a swing that dies away, a low top after it, a top after a start from rest
@pytest.mark.parametrize("portion", [*seeds(1), 97004, 97007, 98014, 98041])
def test_peaks_of_a_lasting_contact(opened, shape, dashpot, portion):
    """A ball is set down, lands, has settled or is pressed deeper within one communication step, with hardly
    any damping to 100 times critical, under forces that change."""
    random = np.random.default_rng([portion, len(shape), len(dashpot)])
    compared = 0
    for _ in range(8):
        scene, end = random_pressed(random)
        values = configuration(scene, shape, dashpot, frame(random))
        fmu = start(opened(FMU[shape]), values, TOLERANCE, METHOD)
        expected = reference_peaks(scene, fmu["contact.gap"], fmu["contact.gap_rate"], end)
        if expected is None:
            continue
        fmu.step(end)
        compared += 1
        check_close(f"force of {scene}", fmu["contact.peak_force"] / expected[0], 1.0, 3e-8)
        check_close(f"penetration of {scene}", fmu["contact.peak_penetration"] / expected[1], 1.0, 3e-8)
    assert compared >= 4


@pytest.mark.parametrize("steps", [7, 35, 70])
def test_the_peak_of_a_step_is_the_largest_of_its_parts(opened, steps):
    """The load has a top, on which an oscillation has nearly died away."""
    values, end = random_scene("plane", "driven by a force", 21119)
    peaks = {steps: [], 700: []}
    for count, list_of in peaks.items():
        add_peak = lambda fmu, to=list_of: to.append(fmu["contact.peak_force"])  # noqa: E731
        run(opened("SpherePlane"), values, end, count, TOLERANCE, each=add_peak)
    parts = np.reshape(peaks[700][1:], (steps, -1)).max(axis=1)
    check_close("peaks", peaks[steps][1:], parts, 1e-8)


@pytest.mark.parametrize("ratio", [1.05, 1.2, 3.0, 30.0])
@pytest.mark.parametrize("stiffness", [1e6, 1e8, 1e9])
@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_a_body_set_down_presses_harder_than_its_weight(opened, shape, location, dashpot, stiffness, ratio):
    """Beyond critical damping F = W - m s'' has its largest value where s'''' = 0: with the two rates a > b
    and s''' = W / m (a^2 e^(-a t) - b^2 e^(-b t)) / (a - b) = 0 there. The depth only grows towards W / p_n.
    """
    mass, weight = 1.0, 10.0
    omega = math.sqrt(stiffness / mass)
    spread = math.sqrt(ratio**2 - 1)
    slow, fast = omega / (ratio + spread), omega * (ratio + spread)
    late = 2 * math.log(fast / slow) / (fast - slow)
    bend = weight / mass * (fast * math.exp(-fast * late) - slow * math.exp(-slow * late)) / (fast - slow)
    side = -1 if location == "inside" else 1
    axes = frame(np.random.default_rng(1))
    force = np.array([[-side * weight, 0.0], [0.0, 0.0], [0.0, 0.0]])
    damping = 2 * ratio * math.sqrt(stiffness * mass)
    scene = Pressed(location, mass, stiffness, damping, 0.0, 0.0, 0.0, force)
    values = configuration(scene, shape, dashpot, axes)
    fmu = run(opened(FMU[shape]), values, 60 / slow, 1, TOLERANCE, METHOD)
    rounding = stiffness * 2.0**-52  # of the first gap, of some 0.5 m
    check_close("force", fmu["contact.peak_force"], weight - mass * bend, rounding + 1e-12 * weight)
    check_close("depth", fmu["contact.peak_penetration"] * stiffness, weight, rounding + 1e-12 * weight)


@pytest.mark.parametrize("share", [0.1, 0.5])
@pytest.mark.parametrize("case", [(1e36, 1.0, 10.0, 1.0), (1e15, 1e-9, 1e-6, 1e5), (1e60, 1.0, 10.0, 1.0)])
@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_the_search_ends_where_a_turn_has_no_digits(opened, shape, location, case, share):
    """A ball settles under a load that doubles until mid-step and falls back: the peaks are the load's."""
    stiffness, mass, pull, end = case
    load = pull * mass
    side = -1 if location == "inside" else 1
    force = -side * np.array([[load, 0.0], [4 * load / end, 0.0], [-8 * load / end**2, 0.0]])
    damping = 2 * share * math.sqrt(stiffness * mass)
    scene = Pressed(location, mass, stiffness, damping, 0.0, 0.0, 0.0, force)
    fmu = opened(FMU[shape])
    values = configuration(scene, shape, "unclamped", np.eye(3))
    values["source.radius"] = 0.125  # the gap at the start is zero to the last digit
    values["source.center"] = [0.5 + side * 0.125, 0.0, 0.0]
    run(fmu, values, end, 1, TOLERANCE, METHOD)
    assert fmu["contact.onsets"] == 1
    assert fmu["solver.steps"] < 100
    check_close("force", fmu["contact.peak_force"], 2 * load, 1e-9 * load)
    check_close("depth", fmu["contact.peak_penetration"] * stiffness, 2 * load, 1e-9 * load)


@pytest.mark.parametrize("method", ["cvode_bdf", "cvode_adams"])
def test_the_dashpot_presses_up_to_the_centre(opened, dashpot, method):
    """A ball goes straight through a solid one: g' and the force fall at the centre, g' from -v to +v."""
    values = head_on("sphere", "outside", speed=48.0) | {"contact.method": "penalty_dynamic"}
    values |= {"contact.dashpot": dashpot, "contact.penalty_factor": 20.0}
    values |= {"contact.viscous_penalty_factor": 0.6, "source.mass": 1.0}
    peaks = []
    for by in (METHOD, method):
        peaks.append(run(opened("SphereSphere"), values, 0.1, 1, 1e-9, by)["contact.peak_force"])
    check_close("force", peaks[1], peaks[0], 1e-6 * peaks[0])


@pytest.mark.parametrize("scene", ["SphereSphere", "SphereCylinder", "ForceElement"])
def test_a_ball_that_is_led_through_the_centre_presses_hardest_before_it(opened, scene, dashpot):
    """F = p_n (reach - d) + p_nv v until d = 0."""
    stiffness, damping, speed, reach, size = 300.0, 7.0, 1.7, 0.6, 1.3
    way = np.array([0.6, 0.8, 0.0])
    values = {"source.motion": "prescribed", "destination.motion": "fixed", "source.radius": 0.1}
    values |= {"destination.radius": 0.5, "destination.axis": [0.0, 0.0, 1.0]}
    values |= {"source.center": (-0.5 * size * way).tolist()}
    values |= {"source.prescribed_velocity": (speed * way).tolist()}
    values |= {"source.prescribed_displacement.derivatives": [(speed * way).tolist()]}
    values |= {"contact.location": "outside", "contact.method": "penalty_dynamic", "contact.dashpot": dashpot}
    values |= {"contact.penalty_factor": stiffness, "contact.viscous_penalty_factor": damping}
    fmu = opened(scene)
    known = {variable.name.partition("[")[0] for variable in fmu.description.modelVariables}
    values = {name: x for name, x in values.items() if name.removesuffix(".derivatives") in known}
    method = METHOD if "solver.method" in known else None
    start(fmu, values, TOLERANCE, method).step(size / speed)
    check_close("force", fmu["contact.peak_force"], stiffness * reach + damping * speed, 1e-10 * stiffness)
    check_close("depth", fmu["contact.peak_penetration"], reach, 1e-14)


# Where rounding counts, contact.peak_force and contact.peak_penetration are right, or cannot be read.

STIFF = (1e23, 1e24, 1e25, 1e26, 1e27, 1e28, 1e30, 1e33, 1e36, 1e50, 1e100)


def peaks_or_none(fmu, stiffness):
    """Returns the force, and the penetration times the stiffness, or None where both are refused."""
    peaks = []
    for name, scale in (("contact.peak_force", 1.0), ("contact.peak_penetration", stiffness)):
        try:
            peaks.append(fmu[name] * scale)
        except FmuError as error:
            if f"{name} is not known: " not in str(error):
                raise
    assert len(peaks) != 1
    return peaks or None


def peaks_of_steps(fmu, name, stiffness, share, steps):
    _, values, end = stiff_scene(name, stiffness, share)
    fmu = start(fmu, values, TOLERANCE, METHOD)
    peaks = []
    for k in range(steps):
        fmu.step(end * (k + 1) / steps - fmu.time)
        peaks.append(peaks_or_none(fmu, stiffness))
        assert math.isfinite(fmu["contact.normal_force"]) and math.isfinite(fmu["energy.total"])
    return peaks


@pytest.mark.parametrize("steps", [1, 5, 37])
@pytest.mark.parametrize("share", [0.1, 0.5, 1.0, 1.2, 5.0])
@pytest.mark.parametrize("name", SCENES)
def test_peaks_are_right_or_refused(opened, name, share, steps):
    """Peaks of each step equal those at 1e22 N/m, where rounding does not count yet. Only the step in which
    the contact begins may refuse them, and not below 1e26 N/m."""
    fmu = opened(FMU[SCENES[name][0]])
    expected = peaks_of_steps(fmu, name, 1e22, share, steps)
    assert None not in expected
    for stiffness in STIFF:
        peaks = peaks_of_steps(fmu, name, stiffness, share, steps)
        assert None not in peaks[1:]
        assert stiffness >= 1e26 or peaks[0]
        for now, then in zip(peaks, expected, strict=True):
            if now:
                check_close(f"force at {stiffness} N/m", now[0], then[0], 1e-6 * then[0])
                check_close(f"depth at {stiffness} N/m", now[1], then[1], 1e-6 * then[1])


@pytest.mark.parametrize("stiffness", [1e22, 1e33, 1e54, 1e70, 1e100])
def test_an_undamped_oscillation_keeps_its_amplitude(opened, stiffness):
    """P3 starts where the load is a fifth of that at the bottom, and oscillates by it ever after. The force
    is largest at the bottom, 5 m g / 2 in all."""
    shape, values, end = stiff_scene("P3", stiffness, 0.0)
    largest = peaks_or_none(run(opened(FMU[shape]), values, end, 1, TOLERANCE, METHOD), stiffness)
    check_close("force", largest[0], 2.4525, 1e-7)
    check_close("depth", largest[1], 2.4525, 1e-7)


@pytest.mark.parametrize("name", ["P3", "tilted cylinder", "free sphere", "on top"])
def test_a_set_down_ball_whose_speed_is_rounding_is_at_rest(opened, name):
    """Rounding gives it a speed of 1e-16 m/s along n, which would make as much force as the load."""
    peaks = [peaks_of_steps(opened(FMU[SCENES[name][0]]), name, k, 0.5, 1)[0] for k in (1e15, 1e33)]
    check_close("peaks", peaks[1], peaks[0], 1e-7 * peaks[0][0])


@pytest.mark.parametrize("stiffness", [1e7, 1e20, 1e33, 1e70, 1e100])
@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_the_peak_of_an_impact_is_known_at_any_stiffness(opened, shape, location, stiffness):
    """The peak is v sqrt(m k): the touch is an event, where the gap is zero."""
    values = head_on(
        shape, location, source_mass=2.0, contact_method="penalty_dynamic", contact_penalty_factor=stiffness,
        contact_viscous_penalty_factor=0.0,
    )  # fmt: skip
    fmu = start(opened(FMU[shape]), values, TOLERANCE, METHOD)
    speed = np.linalg.norm(np.array(values["source.initial_velocity"]))
    fmu.step(1.0)
    assert fmu["contact.onsets"] >= 1
    expected = speed * math.sqrt(2.0 * stiffness)
    check_close("force", fmu["contact.peak_force"] / expected, 1.0, 1e-9)
