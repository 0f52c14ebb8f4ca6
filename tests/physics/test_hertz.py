"""Hertz's law: closed forms of the power law and of Hunt and Crossley's damping, restitution at every speed,
prescribed motion, derivatives, published impacts."""

import math

import mpmath
import numpy as np
import pytest
from mpmath import mpf
from scipy.integrate import solve_ivp

from contact_fmus.bench.problems import law_benchmarks
from contact_fmus.published import IMPACTS, outcome, setup_of
from contact_fmus.stability.motions import elliptic_stiffness
from support.checks import FMU, check_close, check_relative, impulse_and_peak, run, start
from support.reference.hertz import follow, restitution_of
from support.scenes.head_on import GEOMETRIES, of_size, shared_out, speed_after
from support.scenes.law_scenes import by_hertz

# Relative, at the tolerance 1e-12 of CVODE; what event_driven does does not depend on the tolerance so.
ACCURACY = {"event_driven": 1e-10, "cvode_bdf": 1e-10, "cvode_adams": 1e-10}
TOLERANCE = 1e-12
# Of an undamped impact, times speed over depth: 2.943275184...
DURATION = 2 * math.sqrt(math.pi) * math.gamma(7 / 5) / math.gamma(9 / 10)
MASSES = {"source free": ("free", "fixed", 0.75, 9.0), "both free": ("free", "free", 1.0, 3.0)}
REDUCED = 0.75  # kg, of either


def deepest(stiffness, speed, mass=REDUCED):
    return (5 * mass * speed**2 / (4 * stiffness)) ** 0.4


def impact(shape, location, stiffness=1e9, speed=1.0, masses="source free", **more):
    """Bodies as large as the impact asks for start four depths apart. Also returns the impact's end."""
    depth = deepest(stiffness, speed)
    radius = 100 * depth
    gap = 4 * depth
    values = of_size(shape, location, radius, gap, speed)
    values = shared_out(values, *MASSES[masses]) | {
        "contact.law": "hertz",
        "contact.hertz_stiffness": stiffness,
        "solver.absolute_tolerance": 1e-12 * min(speed, depth),
    }
    values |= {name.replace("_", ".", 1): value for name, value in more.items()}
    restitution = values.get("contact.restitution", 0.3)
    return values, (gap + 30 * depth / max(restitution, 0.05)) / speed


@pytest.mark.parametrize("masses", MASSES)
@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_an_undamped_impact_is_that_of_the_power_law(opened, shape, location, masses, method):
    for stiffness, speed in ((1e4, 1e-6), (1e6, 0.3), (1e10, 1e-3), (1e13, 40.0), (1e12, 1e3)):
        values, end = impact(shape, location, stiffness, speed, masses, contact_method="penalty")
        fmu = run(opened(FMU[shape]), values, end, 1, TOLERANCE, method)
        depth, allowed = deepest(stiffness, speed), ACCURACY[method]
        if method == "event_driven":
            allowed = 1e-12
            assert fmu["solver.steps"] < 20 and fmu["solver.fallbacks"] == 0
        assert (fmu["contact.onsets"], fmu["contact.active"]) == (1, False)
        check_relative("depth", fmu["contact.peak_penetration"], depth, allowed)
        check_relative("force", fmu["contact.peak_force"], stiffness * depth**1.5, allowed)
        check_relative("duration", fmu["contact.last_duration"], DURATION * depth / speed, allowed)
        check_relative("speed", speed_after(fmu, location), speed, allowed)


def test_restitution_holds_at_every_speed(opened, dashpot, method):
    """The depth is Hunt and Crossley's for the damping chi v of this restitution."""
    fmu = opened("SphereSphere")
    for stiffness, speed in ((1e4, 1e-6), (1e9, 1.0), (1e13, 1e3)):
        for restitution in (0.05, 0.5, 0.9, 1.0):
            values, end = impact(
                "sphere", "outside", stiffness, speed, "both free", contact_method="penalty_dynamic",
                contact_viscous_control="restitution", contact_restitution=restitution,
                contact_dashpot=dashpot,
            )  # fmt: skip
            kinetic = start(fmu, values)["energy.total"]
            run(fmu, values, end, 1, TOLERANCE, method)
            what, allowed = f"v = {speed}, e = {restitution}", 10 * ACCURACY[method]
            if method == "event_driven":
                allowed = 1e-11
                check_relative("energy", fmu["energy.total"], kinetic, 1e-12)
            assert fmu["contact.onsets"] == 1, what
            check_relative(what, speed_after(fmu, "outside"), restitution * speed, allowed)
            chi = fmu["contact.effective_hunt_crossley_factor"]
            check_relative("e", restitution_of(chi * speed, dashpot) if chi else 1.0, restitution, 1e-12)
            lost = 2 * (chi * speed - math.log1p(chi * speed)) / chi**2 if chi else speed**2
            depth = deepest(stiffness, math.sqrt(lost))
            check_relative("depth", fmu["contact.peak_penetration"], depth, allowed)


def turned(rotation, axis):
    """`axis` turned about the direction of `rotation` by its length."""
    angle = np.sqrt(rotation @ rotation)
    if angle == 0.0:
        return axis
    about = rotation / angle
    across = axis - (about @ axis) * about
    return axis + np.sin(angle) * np.cross(about, axis) + (np.cos(angle) - 1) * across


def closing_acceleration(gap, time):
    """Returns -g'' by the central difference of eighth order."""
    step = np.longdouble(1e-3)
    weights = (-205 / np.longdouble(72), 8 / np.longdouble(5), -1 / np.longdouble(5))
    weights += (8 / np.longdouble(315), -1 / np.longdouble(560))
    terms = [w * (gap(time + k * step) + gap(time - k * step)) for k, w in enumerate(weights)]
    terms[0] /= 2
    return -sum(terms) / step**2


@pytest.mark.parametrize("seed", range(20))
def test_the_load_of_an_onset_knows_how_its_surface_turns(opened, seed):
    """A ball sinks onto a plane or a cylinder that moves and turns ever faster. chi is that of the speed to
    which -g'' would bring it, found here by differences of the gap."""
    random = np.random.default_rng(seed)
    shape, name = (("plane", "SpherePlane"), ("cylinder", "SphereCylinder"))[seed % 2]
    axis = random.normal(size=3)
    axis /= np.linalg.norm(axis)
    across = np.cross(axis, random.normal(size=3))
    across /= np.linalg.norm(across)
    normal, height = (axis, 0.1) if shape == "plane" else (across, 0.6)
    along = np.cross(normal, random.normal(size=3)) if shape == "plane" else random.normal() * axis
    start_at = height * normal + along
    omega = random.normal(size=3)
    faster = 3.0 * random.normal() * omega  # about one direction, so that the angle is its integral
    moves, pulled = random.normal(size=3), random.normal(size=3)
    velocity = moves + np.cross(omega, start_at) + np.cross(normal, random.normal(size=3))
    load = random.normal(size=3) - 20.0 * normal
    apart, stiffness, chi_v = 1e-8, 1e6, 0.3

    def gap(t):
        c = start_at + (velocity - moves) * t + (load - pulled) * t**2 / 2
        e = turned(np.asarray(omega * t + faster * t**2 / 2, np.longdouble), np.longdouble(axis))
        return c @ e if shape == "plane" else np.sqrt(c @ c - (c @ e) ** 2)

    values = {
        "source.center": (start_at + apart * normal).tolist(),
        "source.initial_velocity": velocity.tolist(), "gravity": load.tolist(),
        "destination.motion": "prescribed", "destination.rotation": "prescribed",
        "destination.axis": axis.tolist(), "destination.prescribed_axis": axis.tolist(),
        "destination.prescribed_velocity": moves.tolist(),
        "destination.prescribed_velocity.derivatives": [pulled.tolist()],
        "destination.prescribed_angular_velocity": omega.tolist(),
        "destination.prescribed_angular_velocity.derivatives": [faster.tolist()], "contact.law": "hertz",
        "contact.hertz_stiffness": stiffness, "contact.viscous_control": "restitution",
        "contact.restitution": restitution_of(chi_v, "unclamped"), "contact.dashpot": "unclamped",
    }  # fmt: skip
    fmu = start(opened(name), values)
    fmu.step(1e-3)
    pressing = float(closing_acceleration(gap, np.longdouble(fmu["contact.last_onset_time"])))
    assert pressing > 0.0
    speed = math.sqrt(1.2 * pressing * (pressing / stiffness) ** (2 / 3))
    check_relative("speed", chi_v / fmu["contact.effective_hunt_crossley_factor"], speed, 1e-7)


# Prescribed motion: gap 0.01 - t + 20 t^2


def prescribed(dashpot, control):
    values = {"source.motion": "prescribed", "destination.motion": "fixed", "source.center": [0.0, 0.0, 0.61]}
    values |= {"source.prescribed_velocity": [0.0, 0.0, -1.0]}
    values |= {"source.prescribed_displacement.derivatives": [[0.0, 0.0, -1.0], [0.0, 0.0, 40.0]]}
    values |= {"source.prescribed_velocity.derivatives": [[0.0, 0.0, 40.0], [0.0, 0.0, 0.0]]}
    values |= {"contact.law": "hertz", "contact.hertz_stiffness": 1e8, "contact.viscous_control": control}
    values |= {"contact.hunt_crossley_factor": 1.5, "contact.restitution": 0.4, "contact.dashpot": dashpot}
    return values


def impulse(dashpot, chi):
    """Integrates over u with t = touch + u^2 and release - u^2, in which the force is smooth."""
    root = mpmath.sqrt(mpmath.mpf(1) / 5)
    touch, deep, release = (1 - root) / 40, mpmath.mpf(1) / 40, (1 + root) / 40
    clip = (1 / mpmath.mpf(chi) + 1) / 40

    def force(t):
        depth, rate = t - 20 * t**2 - mpmath.mpf("0.01"), 40 * t - 1
        factor = 1 if dashpot == "approach_only" and rate > 0 else 1 - chi * rate
        factor = max(factor, 0) if dashpot == "non_adhesive" else factor
        return 10**8 * mpmath.mpf(max(depth, 0)) ** 1.5 * factor

    down = mpmath.quad(lambda u: 2 * u * force(touch + u * u), [0, mpmath.sqrt(deep - touch)])
    kinks = [mpmath.sqrt(release - clip)] if clip < release else []
    up = mpmath.quad(lambda u: 2 * u * force(release - u * u), [0, *kinks, mpmath.sqrt(release - deep)])
    return float(down + up)


@pytest.mark.parametrize("steps", [1, 3, 16])
@pytest.mark.parametrize("control", ["user_defined", "restitution"])
def test_the_impulse_of_a_prescribed_pass_is_the_integral_of_the_force(opened, dashpot, control, steps):
    fmu = opened("SphereSphere")
    total, _ = impulse_and_peak(fmu, prescribed(dashpot, control), 0.045, steps, 1e-10)
    chi = fmu["contact.effective_hunt_crossley_factor"]
    if control == "restitution":
        check_relative("e", restitution_of(chi / math.sqrt(5), dashpot), 0.4, 1e-12)
    check_relative("impulse", total[2], impulse(dashpot, chi), 1e-11)
    check_relative("energy", fmu["energy.dissipated"], fmu["energy.external_work"], 1e-11)


# Derivatives


def check_jacobian(fmu, force, state, relative, absolute=0.0):
    """Checks the normal force's derivatives. `force` is a function of depth and rate."""
    check_relative("force", fmu["contact.normal_force"], float(force(*state)), 1e-12)
    for order, (name, sign) in enumerate((("displacement", -1), ("velocity", 1))):
        known = [fmu.variable(f"source.prescribed_{name}").references[2]]
        unknown = fmu.variable("contact.normal_force").references
        got = fmu.call("getDirectionalDerivative", unknown, known, [1.0])[0]
        expected = sign * float(mpmath.diff(force, state, (1 - order, order)))
        check_close(f"by {name}", got, expected, relative * abs(expected) + absolute)


@pytest.mark.parametrize("control", ["user_defined", "automatic", "restitution"])
def test_derivatives_are_those_of_the_formula(opened, dashpot, control):
    """The force is differentiated by place and speed, and up to twice by time, before and after its peak."""
    fmu = opened("SphereSphere")
    for instant in (0.021, 0.0262):
        run(fmu, prescribed(dashpot, control) | {"contact.characteristic_time": 0.9}, instant, 1, 1e-10)
        chi = fmu["contact.effective_hunt_crossley_factor"]
        acts = dashpot != "approach_only" or instant < 0.025

        def force(depth, rate, chi=chi if acts else 0.0):
            return 10**8 * depth ** mpmath.mpf(1.5) * (1 - chi * rate)

        def in_time(t, force=force):
            return force(t - 20 * t**2 - mpmath.mpf("0.01"), 40 * t - 1)

        state = (-fmu["contact.gap"], fmu["contact.gap_rate"])
        check_jacobian(fmu, force, state, 1e-11)
        for order in (1, 2):
            expected = float(mpmath.diff(in_time, instant, order))
            check_relative(f"order {order}", fmu.derivative("contact.normal_force", order), expected, 1e-9)


@pytest.mark.parametrize("index", range(len(IMPACTS)))
def test_published_impacts_come_out_to_their_digits(opened, index):
    """Results of Chung and Ooi, Granular Matter 13 (2011) 643, agree to half a unit of the last digit."""
    case = IMPACTS[index]
    got = outcome(opened(setup_of(case)["fmu"]), case, "event_driven", 1e-10)
    if case.restitution is None:
        check_close("force", got.force, case.force, 0.5)
        check_close("depth", got.depth, case.depth, 5e-9 if case.test == 1 else 5e-10)
    turns = case.test == 8  # one of two spheres, which then move along the surface: the normal turns too
    check_close("restitution", got.restitution, case.restitution or 1.0, 2e-4 if turns else 1e-9)
    if case.test != 7 and (case.angle or 0) >= 70:
        check_relative("sliding", got.slip, got.sliding, 5e-4 if turns else 1e-8)
    if case.read is not None:  # two digits of a figure
        check_close("read", got.along / got.first, case.read, 0.015)
    if case.lammps is not None:  # whose last digit is that of its steps
        check_close("LAMMPS", got.slip / got.first, case.lammps, 3e-6)


@pytest.mark.parametrize("motion", ["fixed", "free"])
def test_until_initialization_ends_the_damping_of_a_start_in_overlap_follows_it(opened, motion, dashpot):
    """Central differences of the formula chi v = y, v^2 = g'^2 + (4/5) k_h delta^(5/2)/m_red agree."""
    depth, rate, mass = 2e-3, -0.7, 3.0
    values = prescribed(dashpot, "restitution") | {"source.center": [0.0, 0.0, 0.6 - depth]}
    values |= {"destination.motion": motion, "destination.mass": mass}
    values |= {"source.prescribed_velocity": [0.0, 0.0, rate], "gravity": [0.0, 0.0, 0.0]}
    values = {name: value for name, value in values.items() if not name.endswith("derivatives")}
    fmu = opened("SphereSphere")
    fmu.call("setupExperiment", 1e-8, 0.0, None)
    for name, value in values.items():
        fmu[name] = value
    fmu.call("enterInitializationMode")

    def speed(d, r):
        spring = mpmath.mpf("0.8e8") * d ** mpmath.mpf(2.5) / mass if motion == "free" else 0
        return mpmath.sqrt(r**2 + spring)

    number = fmu["contact.effective_hunt_crossley_factor"] * float(speed(depth, rate))

    def force(d, r):
        return 10**8 * d ** mpmath.mpf(1.5) * (1 - number / speed(d, r) * r)

    check_jacobian(fmu, force, (depth, rate), 0.0, 1e-9 * float(force(depth, rate)) / depth)


# The stiffness that Hertz's theory makes of materials and radii; a ball that hardly fits.

MATERIALS = {"source": (7e10, 0.33), "destination": (2e9, 0.4)}
MODULUS = 1 / sum((1 - nu**2) / e for e, nu in MATERIALS.values())


def automatic(radius, shell, location):
    values = {"contact.law": "hertz", "contact.penalty_control": "automatic", "contact.location": location}
    values |= {"source.radius": radius, "destination.radius": shell, "source.center": [0.0, 0.5 * shell, 0.0]}
    for body, (modulus, ratio) in MATERIALS.items():
        values |= {f"{body}.youngs_modulus": modulus, f"{body}.poissons_ratio": ratio}
    return values


@pytest.mark.parametrize("location", ["outside", "inside"])
def test_stiffness_of_spheres_is_that_of_hertz(opened, location):
    for radius, shell in ((0.1, 0.5), (2.0, 2.5), (1e-3, 40.0)):
        fmu = start(opened("SphereSphere"), automatic(radius, shell, location))
        sign = 1 if location == "outside" else -1
        expected = 4 / 3 * MODULUS * math.sqrt(radius * shell / (shell + sign * radius))
        check_relative("k_h", fmu["contact.effective_hertz_stiffness"], expected, 1e-14)


@pytest.mark.parametrize("location", ["outside", "inside"])
def test_stiffness_of_sphere_and_cylinder_is_that_of_the_elliptic_contact(opened, location):
    for radius, shell in ((0.1, 0.5), (0.4, 0.5), (1e-2, 40.0)):
        fmu = start(opened("SphereCylinder"), automatic(radius, shell, location))
        sign = 1 if location == "outside" else -1
        across = 0.5 * (1 / radius + sign / shell)
        expected = float(elliptic_stiffness(MODULUS, *map(mpf, sorted((0.5 / radius, across)))))
        check_relative("k_h", fmu["contact.effective_hertz_stiffness"], expected, 1e-9)


def test_a_ball_hardly_smaller_than_its_shell_is_warned_of(opened):
    fmu = opened("SphereSphere")
    for radius, warned in ((0.92, True), (0.88, False)):
        start(fmu, automatic(radius, 1.0, "inside") | {"source.center": [0.0, 0.01, 0.0]})
        found = [message for message in fmu.messages if "source.radius" in message.text]
        assert bool(found) == warned
        assert not found or "destination.radius" in found[0].text


# The next tests are of lasting contact under Hertz's law. A creeping body takes few steps, and its force is
# as exact as its motion. An oscillation is followed while it matters. The work is the same for any modulus.

RADIUS, OTHER = 0.1, 0.5


def values_of(stiffness, chi, depth, speed, load, dashpot):
    values = {"source.radius": RADIUS, "source.mass": 1.0}
    values |= {"source.center": [0.0, 0.0, RADIUS + OTHER - depth]}
    values |= {"source.initial_velocity": [0.0, 0.0, -speed], "destination.radius": OTHER}
    values |= {"contact.dashpot": dashpot, "gravity": [0.0, 0.0, -load], "solver.max_internal_steps": 20_000}
    values |= {**by_hertz(stiffness, chi)}
    return values


def creep(stiffness, chi, depth, speed, load, end):
    """Returns depth, rate and force of a unit mass by scipy's Radau method, in parts of depth and 1/chi."""

    def force(y):
        return stiffness * max(depth * y[0], 0.0) ** 1.5 * (1 + y[1])

    def rates(_t, y):
        return y[1] / (chi * depth), chi * (load - force(y))

    y = solve_ivp(rates, (0, end), (1.0, chi * speed), "Radau", rtol=1e-11, atol=1e-13).y[:, -1]
    return depth * y[0], y[1] / chi, force(y)


@pytest.mark.parametrize("chi, depth, speed, load, end, most", [
    (1e6, 1e-4, 0.0, 9.81, 0.1, 20),  # less deep than at rest: it sinks
    (1e5, 4e-3, 0.0, 9.81, 0.05, 40),  # deeper: it rises
    (1e3, 0.03, 0.0, 0.0, 15.0, 40),  # pushed out without a load
    (1e3, 0.03, 0.0, -20.0, 15.0, 40),  # and pulled
    (1e7, 1e-7, 0.2, 9.81, 0.2, 100),  # an impact that hardly ends
])  # fmt: skip
def test_it_creeps_in_few_steps(opened, chi, depth, speed, load, end, most):
    stiffness, fmu = 1e6, opened("SphereSphere")
    deep, rate, force = creep(stiffness, chi, depth, speed, load, end)
    values = values_of(stiffness, chi, depth, speed, load, "unclamped")
    total = start(fmu, values, 1e-10, "event_driven")["energy.total"]
    for steps in (1, 3):
        run(fmu, values, end, steps, 1e-10)
        check_close("depth", -fmu["contact.gap"], deep, 1e-10)
        check_close("rate", -fmu["contact.gap_rate"], rate, 1e-10)
        largest = max(abs(force), stiffness * deep**1.5)
        check_close("force", fmu["contact.normal_force"], force, 1e-8 * largest)
        check_close("energy", fmu["energy.total"], total, 1e-10 * abs(total))
        assert fmu["solver.steps"] <= most


@pytest.mark.parametrize("damped", [30.0, 1e3, 1e5])
def test_the_force_of_a_ball_that_settles(opened, damped):
    """The damping is `damped` times the critical one. The ball is set down at the depth at rest."""
    stiffness, load = 1e8, 9.81
    depth = (load / stiffness) ** (2 / 3)
    chi = 2 * damped * np.sqrt(1.5 * stiffness * depth**0.5) / load
    values = values_of(stiffness, chi, 0.5 * depth, 0.0, load, "unclamped")
    _, _, force = creep(stiffness, chi, 0.5 * depth, 0.0, load, 0.01)
    fmu = run(opened("SphereSphere"), values, 0.01, 1, 1e-10, "event_driven")
    check_relative("force", fmu["contact.normal_force"], force, 1e-9)


@pytest.mark.parametrize("pull", [1e-7, 5e-6, 1e-3])
def test_a_light_load_adds_to_the_speed_at_which_a_deep_overlap_is_left(opened, pull):
    """The load is down to 1e-10 of the spring's force. The dashpot limits the speed to 1/chi."""
    stiffness, chi, deepest, end = 1e6, 20.0, 0.01, 0.1
    values = values_of(stiffness, chi, deepest, 0.0, -pull, "non_adhesive")
    right, _ = follow("SphereSphere", values, end)
    fmu = run(opened("SphereSphere"), values, end, 1, 1e-10)
    check_close("speed", fmu["source.velocity"][2], right[8], 1e-12)
    check_close("place", fmu["source.position"][2], right[2], 1e-13)
    assert fmu["solver.events"] == 1


def test_an_oscillation_is_followed_as_long_as_the_tolerance_asks(opened):
    """P3 slides on after its oscillation has died away: coarser tolerances see that sooner, as exactly."""
    problem = law_benchmarks()["P3 Hertz"]
    fmu, values, end = problem.fmu, problem.start, problem.stop
    steps = []
    for time in (0.25 * end, end):  # while it dies away, and long after
        fine = run(opened(fmu), values, time, 1, 1e-12)["contact.normal_force"]
        for tolerance in (1e-4, 1e-6, 1e-9):
            made = run(opened(fmu), values, time, 1, tolerance)
            check_relative("force", made["contact.normal_force"], fine, 3 * tolerance)
            steps.append(made["solver.steps"])
    check_close("position", made["source.position"], problem.position, 1e-12)
    assert steps[3] < 0.9 * steps[5]


def resting(modulus, share):
    """A ball slides along and about the axis in a hollow cylinder, as deep as its load presses it, with this
    share of the critical damping there."""
    speed, mass, reach = 0.5, 0.1, OTHER - RADIUS
    stiffness = 4 / 3 * modulus * np.sqrt(RADIUS * OTHER / reach)
    load = 9.81 + speed**2 / reach
    depth = (mass * load / stiffness) ** (2 / 3)
    critical = 2 * np.sqrt(1.5 * stiffness * np.sqrt(depth) * mass)
    values = {"source.radius": RADIUS, "source.mass": mass, "source.motion": "free"}
    values |= {"source.center": [0.0, 0.0, -reach - depth], "source.initial_velocity": [speed, 0.1, 0.0]}
    values |= {"destination.radius": OTHER, "destination.motion": "fixed"}
    values |= {"destination.axis": [0.0, 1.0, 0.0], "contact.location": "inside"}
    values |= {"contact.dashpot": "unclamped"}
    values |= {**by_hertz(stiffness, share * critical / (stiffness * depth**1.5))}
    return values


@pytest.mark.parametrize("share", [0.1, 1.0, 20.0])
def test_the_work_does_not_follow_the_modulus(opened, share):
    """Counts internal steps. At 1e13 Pa the contact oscillates 1e5 times a second."""
    steps = []
    for modulus in (1e7, 1e9, 1e11, 1e13):
        fmu = run(opened("SphereCylinder"), resting(modulus, share), 2.0, 1, 1e-8)
        steps.append(fmu["solver.steps"])
        assert fmu["solver.fallbacks"] == 0
    assert max(steps) <= 1.5 * steps[0] + 20, steps
