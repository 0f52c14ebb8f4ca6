"""Contact between bodies that the importer moves: random scenes of numbers that people type, and the scenes
in which a run once hung, was changed by a reading, or missed a change of the law."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from support.checks import DASHPOTS, check_close, impulse_and_peak, run, start
from support.scenes.agreement import Scene, answer, check_agreement, pick, seeds
from support.scenes.turning_scenes import any_resistance

UNITS = [np.array(e, float) for e in np.vstack([np.eye(3), -np.eye(3)])]
# Impulses, torques and energies come from quadratures to the tolerance; of what they are a fraction the
# scene's stiffness times a length says, once.
PENALTY = (1e3, 1e4, 1e6)


def typed(vector):
    return [float(round(x, 12)) for x in vector]


def law(random, values):
    values["contact.dashpot"] = pick(random, *DASHPOTS, "non_adhesive")
    values["contact.penalty_factor"] = pick(random, *PENALTY)
    values["contact.viscous_penalty_factor"] = pick(random, 0.0, 10.0, 100.0, 1000.0)
    return values["contact.penalty_factor"]


def motion(values, body, velocity, acceleration):
    """The body starts with this velocity and keeps this acceleration."""
    values[f"{body}.motion"] = "prescribed"
    values[f"{body}.prescribed_velocity"] = typed(velocity)
    values[f"{body}.prescribed_displacement.derivatives"] = [typed(velocity), typed(acceleration)]
    values[f"{body}.prescribed_velocity.derivatives"] = [typed(acceleration)]


def pass_by(random, values, middle, speeds=(0.5, 1.0, 2.0)):
    """The source comes to `middle` after 0.5 or 0.4 of the run, straight or on a parabola that turns there.
    The end of the run is round, so that events often fall on communication points."""
    end = pick(random, 0.5, 1.0, 2.0)
    speed = pick(random, *speeds)
    along = UNITS[random.integers(6)] if random.random() < 0.7 else np.array([0.6, 0.8, 0.0])
    # A parabola across the normal has a top of the fourth order, which peaks are not searched for.
    bends = random.random() < 0.5 and abs(along @ middle) > 1e-9
    velocity = speed * along
    turn = (0.4 if bends else 0.5) * end
    acceleration = -velocity / turn if bends else np.zeros(3)
    at = np.asarray(middle, float) - turn * velocity - 0.5 * turn**2 * acceleration
    values["source.center"] = typed(at)
    motion(values, "source", velocity, acceleration)
    if random.random() < 0.3:  # the world moves along
        drift = UNITS[random.integers(6)] * pick(random, 0.5, 1.0)
        motion(values, "source", velocity + drift, acceleration)
        motion(values, "destination", drift, np.zeros(3))
    return 1.25 * end  # an event in the last instant may or may not be part of the run


def scales(stiffness, **more):
    """Returns the scales of errors: a force's is that at a penetration of a tenth of a metre."""
    force = 0.1 * stiffness
    energies = dict.fromkeys(("contact", "dissipated", "external_work", "total", "friction"), 0.1 * force)
    forces = dict.fromkeys(("mean_force", "peak_force"), force)
    torques = dict.fromkeys(("mean_source_torque", "mean_destination_torque"), force)
    return energies | forces | torques | {"peak_penetration": 0.1} | more


def at_a_face(random, fmu):
    """Returns places of the source near a touch: on axes, at equal radii, at edges, in the centre."""
    values = {"gravity": [0.0, 0.0, 0.0], "source.radius": pick(random, 0.1, 0.5)}
    depth = pick(random, 1e-3, 0.01, 0.05)  # a graze of exactly zero is whatever rounding makes of it
    if fmu == "SpherePlane":
        return values, [0.0, 0.0, values["source.radius"] - depth]
    values["destination.radius"] = 0.5
    reach = values["source.radius"] + 0.5 - depth
    direction = UNITS[random.integers(6)] if random.random() < 0.7 else np.array([0.6, 0.0, 0.8])
    if fmu == "SphereCylinder":
        values["destination.axis"] = typed(UNITS[random.integers(6)])
        axis = np.array(values["destination.axis"])
        direction = direction - (direction @ axis) * axis
        if not direction.any():
            direction = np.roll(axis, 1)
        if random.random() < 0.6:
            values |= {"destination.finite_length": True, "destination.length": pick(random, 0.5, 1.0)}
    return values, typed(reach * direction)


def straight_or_bent(random):
    """Nothing turns in universal FMUs and the force element. Events often fall on communication points."""
    fmu = pick(random, "SphereSphere", "SphereCylinder", "SpherePlane")
    values, middle = at_a_face(random, fmu)
    return Scene(fmu, values, pass_by(random, values, middle), floor=scales(law(random, values)))


def over_a_rim(random):
    """The source passes a capped cylinder's rim once or twice, shallow or deep."""
    values = {"gravity": [0.0, 0.0, 0.0], "destination.axis": [0.0, 0.0, 1.0]}
    values |= {"destination.finite_length": True, "destination.length": 1.0, "destination.ends": "capped"}
    values |= {"source.radius": pick(random, 0.05, 0.1, 0.5)}
    across = np.array([1.0, 0.0, 0.0]) if random.random() < 0.7 else np.array([0.6, 0.8, 0.0])
    depth = values["source.radius"] * pick(random, 0.01, 0.1, 0.5, 0.9)
    height = 0.5 + values["source.radius"] - depth
    middle = pick(random, 0.0, 0.4, 0.5, 0.55) * across + np.array([0.0, 0.0, height])
    stiffness = law(random, values)
    return Scene("SphereCylinder", values, pass_by(random, values, middle), floor=scales(stiffness))


def turning_and_rubbing(random):
    """Both bodies may turn, and the normal of plane or cylinder with them. Friction is of every kind."""
    fmu = pick(random, "SphereSphere", "SphereCylinder", "SpherePlane", "TurningForceElement")
    values, middle = at_a_face(random, "SphereCylinder" if fmu.startswith("Turning") else fmu)
    stiffness = law(random, values)
    end = pass_by(random, values, middle)
    if fmu.startswith("Turning"):
        values = {name: value for name, value in values.items() if name != "gravity"}
    values["contact.location"] = "outside"
    if fmu == "SpherePlane":
        del values["contact.location"]
    for body in ("source", "destination"):
        spin = UNITS[random.integers(6)] * pick(random, 0.0, 0.5, 1.0, 10.0)
        if body == "destination" and np.linalg.norm(spin) > 1.0:
            spin = spin / 10.0
        values[f"{body}.rotation"] = "prescribed"
        values[f"{body}.prescribed_angular_velocity"] = typed(spin)
    values["destination.prescribed_axis"] = values.get("destination.axis", [0.0, 0.0, 1.0])
    if fmu == "SphereSphere":
        del values["destination.prescribed_axis"]
    values["contact.friction"] = pick(random, "none", "regularized", "elastic")
    if values["contact.friction"] == "elastic":
        values |= {"contact.tangential_stiffness": 0.5 * stiffness}
        values |= {"contact.tangential_damping": pick(random, 1.0, 100.0)}
        values |= {"contact.static_friction_coefficient": 0.5}
    values["contact.friction_coefficient"] = pick(random, 0.0, 0.5)
    values |= any_resistance(random, "contact", 1e-3 * stiffness)
    if fmu.startswith("Turning"):
        pinned = ("source.motion", "destination.motion", "source.rotation", "destination.rotation")
        values = {name: value for name, value in values.items() if name not in pinned}
    return Scene(fmu, values, end, floor=scales(stiffness))


def force_element(random):
    """The element has no state: means and peaks of one step are those of many."""
    values, middle = at_a_face(random, "SphereCylinder")
    stiffness = law(random, values)
    end = pass_by(random, values, middle)
    given = {name: value for name, value in values.items() if name not in ("gravity", "source.motion")}
    given.pop("destination.motion", None)
    return Scene("ForceElement", given | {"contact.location": "outside"}, end, floor=scales(stiffness))


FAMILIES = [straight_or_bent, over_a_rim, turning_and_rubbing, force_element]


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.__name__)
# In 91161 and 91237 a force rests at a rim. In 110041 the source passes through its circle; in 110089 it
# slides along the side at a gap of zero and turns back.
@pytest.mark.parametrize("seed", [*seeds(), 91161, 91237, 110041, 110089])
def test_a_given_motion_has_one_answer(opened, family, seed):
    check_agreement(opened, family(np.random.default_rng([seed, FAMILIES.index(family)])), seed)


# The source passes exactly through the destination's centre or axis while one of them turns (the first three
# under a dashpot that is clipped, the next one with a spring that sticks), or touches with a spring at rest.
# In 110200 a spring turns fast where F_n vanishes, in 91029 a spring decays to nothing.
@pytest.mark.parametrize("seed", [44, 51, 124, 334, 387, 683, 110200, 91029])
def test_what_passes_through_the_centre_and_turns_has_one_answer(opened, seed):
    random = np.random.default_rng([seed, FAMILIES.index(turning_and_rubbing)])
    check_agreement(opened, turning_and_rubbing(random), seed)


# The source is prescribed; it goes straight on with this velocity from this displacement.
def straight(center, velocity, **more):
    values = {"source.motion": "prescribed", "source.center": center, "source.prescribed_velocity": velocity}
    return values | {name.replace("__", "."): value for name, value in more.items()}


END_PLANE = {"destination.axis": [0.0, 1.0, 0.0], "destination.finite_length": True}
END_PLANE |= {"destination.length": 1.0, "contact.penalty_factor": 1e4, "contact.method": "penalty"}


# The source comes at -1.5 m/s and turns back: z = 1.1 - 1.5 t + t^2 is 0.6 at 0.5 s and at 1 s.
COMES_AND_GOES = straight([0.0, 0.0, 1.1], [0.0, 0.0, -1.5], contact__viscous_penalty_factor=10.0) | {
    "source.prescribed_displacement.derivatives": [[0.0, 0.0, -1.5], [0.0, 0.0, 2.0]],
    "source.prescribed_velocity.derivatives": [[0.0, 0.0, 2.0]],
}
# It turns back just over the rim's circle, half-way between its two passages: the distance from the axis is
# 0.5 at 0.10718, 0.8 and 1.49282 s; the gap is zero where it is 0.5433.
TURNS_AT_THE_CIRCLE = straight([0.02, -0.64, 0.525], [1.2, 1.6, 0.0]) | {"gravity": [0.0, 0.0, 0.0]}
TURNS_AT_THE_CIRCLE |= {"destination.axis": [0.0, 0.0, 1.0], "destination.finite_length": True}
TURNS_AT_THE_CIRCLE |= {"destination.length": 1.0, "destination.ends": "capped", "source.radius": 0.05}
TURNS_AT_THE_CIRCLE |= {"source.prescribed_displacement.derivatives": [[1.2, 1.6, 0.0], [-1.5, -2.0, 0.0]]}
TURNS_AT_THE_CIRCLE |= {"source.prescribed_velocity.derivatives": [[-1.5, -2.0, 0.0]]}
TURNS_AT_THE_CIRCLE |= {"contact.penalty_factor": 1e4, "contact.viscous_penalty_factor": 0.0}
ALONG_THE_SIDE = TURNS_AT_THE_CIRCLE | {"source.center": [0.55, 0.0, 0.775]}
ALONG_THE_SIDE |= {"source.prescribed_velocity": [0.0, 0.0, -0.5]}
ALONG_THE_SIDE |= {"source.prescribed_displacement.derivatives": [[0.0, 0.0, -0.5]]}
ALONG_THE_SIDE |= {"source.prescribed_velocity.derivatives": [[0.0, 0.0, 0.0]]}
CLIPPED_BEFORE_THE_RELEASE = TURNS_AT_THE_CIRCLE | {
    "source.radius": 0.5, "source.center": [0.55, 0.0, 1.795], "source.prescribed_velocity": [0.0, 0.0, -2.0],
    "source.prescribed_displacement.derivatives": [[0.0, 0.0, -2.0], [0.0, 0.0, 2.5]],
    "source.prescribed_velocity.derivatives": [[0.0, 0.0, 2.5]], "contact.penalty_factor": 1e6,
    "contact.viscous_penalty_factor": 100.0,
}  # fmt: skip
ONSETS, BEGAN, LASTED = "contact.onsets", "contact.last_onset_time", "contact.last_duration"
LOST, TOTAL, CYLINDER = "energy.dissipated", "energy.total", "SphereCylinder"
TURNED = 0.0691576057658999  # s, when it comes to the circle
# FMU, values, end, numbers of steps, what is so at the end and to what
WAYS = {
    "leaves by the end": (CYLINDER, straight([0.0, 0.0, 0.59], [0.0, 1.0, 0.0]) | END_PLANE, 1.0, (10,),
        {LOST: 0.5, TOTAL: 0.5}, 1e-12),
    "passes both ends on communication points": (CYLINDER,
        straight([0.0, -1.0, 0.59], [0.0, 1.0, 0.0]) | END_PLANE, 2.0, (8,),
        {ONSETS: 1, LASTED: 1.0, LOST: 0.0}, 1e-12),
    "touches on a communication point": ("SpherePlane", straight([0.0, 0.0, 0.6], [0.0, 0.0, -1.0]), 1.0,
        (4,), {ONSETS: 1, BEGAN: 0.5}, 1e-12),
    "parts on a communication point": ("SphereSphere", COMES_AND_GOES, 2.0, (8,),
        {ONSETS: 1, BEGAN: 0.5, LASTED: 0.5}, 1e-12),
    "turns back at an edge and is over the cap between": (CYLINDER, TURNS_AT_THE_CIRCLE, 2.5, (1, 2, 22),
        {ONSETS: 1, BEGAN: TURNED, LASTED: 2.0 * (0.8 - TURNED)}, 1e-12),
    "goes along the side without depth": (CYLINDER, ALONG_THE_SIDE, 1.25, (1, 5, 22), {ONSETS: 0}, 0.0),
    "has its dashpot clipped before the release wherever a step ends": (CYLINDER, CLIPPED_BEFORE_THE_RELEASE,
        2.5, (1, 100), {LOST: 0.0366930944}, 1e-9),
}  # fmt: skip


@pytest.mark.parametrize("read", [False, True])
@pytest.mark.parametrize("way", WAYS)
def test_events_at_edges_and_communication_points_are_those_of_the_closed_form(opened, way, read):
    name, values, end, counts, expected, allowed = WAYS[way]
    for steps in counts:
        fmu = start(opened(name), values)
        for _ in range(steps):
            fmu.step(end / steps)
            if read:
                fmu["contact.gap"], fmu["energy.total"], fmu["contact.active"]
        for output, value in expected.items():
            check_close(f"{output} in {steps} steps", fmu[output], value, allowed)


@pytest.mark.parametrize("axial", [0.5, -0.5])
@pytest.mark.parametrize("velocity", [[0.0, 0.0, 0.0], [0.0, 1e-3, 0.0]])
def test_a_force_element_in_the_plane_of_an_open_end_agrees_with_itself(opened, axial, velocity):
    """|c.e_d| = L/2 is within the cylinder: an active contact has a mean and a peak."""
    values = {"destination.axis": [0.0, 0.0, 1.0], "destination.finite_length": True}
    values |= {"destination.length": 1.0, "source.center": [0.599, 0.0, axial]}
    values |= {"source.prescribed_displacement.derivatives": [velocity]}
    values |= {"contact.viscous_penalty_factor": 0.0}
    fmu = start(opened("ForceElement"), values)
    fmu.step(0.1)
    assert fmu["contact.active"] and fmu["contact.within_extents"]
    check_close("peak", fmu["contact.peak_force"], 1000.0, 1e-3)
    check_close("mean", fmu["contact.mean_force"][0], 1000.0, 1.0)


def test_the_dashpot_is_clipped_as_the_source_leaves_by_a_rim(opened):
    values = straight([-1.0, 0.0, 0.55], [1.0, 0.0, 0.0]) | {"destination.axis": [0.0, 0.0, 1.0]}
    values |= {"destination.finite_length": True, "destination.ends": "capped"}
    fmu = run(opened("SphereCylinder"), values, 2.0, 1, 1e-10)
    check_close("mean force", fmu["contact.mean_force"], [-3.422391823, 0.0, 27254.663548], 1e-5)
    check_close("dissipated", fmu["energy.dissipated"], 6.844783647, 1e-8)


HANGING = {"source.radius": 0.1, "destination.radius": 0.5, "destination.axis": [0.0, 0.0, 1.0]}
HANGING |= {"contact.location": "outside", "contact.penalty_factor": 1e4}
HANGING |= {"contact.viscous_penalty_factor": 200.0, "source.center": [0.0, 0.0, 0.0]}
HANGING |= {"source.prescribed_displacement": [0.59, 0.0, 0.0], "contact.friction": "none"}


@pytest.mark.parametrize("steps", [1, 10, 30])
@pytest.mark.parametrize("speed", [1.0, 0.4])
@pytest.mark.parametrize("spin", [0.0, 1.0])
def test_a_clipped_dashpot_of_what_turns_holds_up_no_step(opened, steps, speed, spin):
    """gap = speed t - 0.01. At 1 m/s the dashpot would pull from the start. At 0.4 m/s it would from 2 mm on,
    where 1e4 N/m 2 mm = 200 N s/m 0.4 m/s / 4: clipped from 1e4 (0.01 - 0.4 t) = 80, t = 5 ms, on."""
    values = HANGING | {"source.prescribed_velocity": [speed, 0.0, 0.0]}
    values |= {"source.prescribed_displacement.derivatives": [[speed, 0.0, 0.0]]}
    values |= {"source.prescribed_angular_velocity": [0.0, 0.0, spin]}
    impulse, _ = impulse_and_peak(opened("TurningForceElement"), values, 0.03, steps)
    until = max(0.0, (0.01 - 200.0 * speed / 1e4) / speed)
    expected = (100.0 - 200.0 * speed) * until - 0.5e4 * speed * until**2
    check_close("impulse", impulse, [expected, 0.0, 0.0], 1e-12)


@pytest.mark.parametrize("steps", [1, 2, 7])
def test_a_source_passes_the_axis_of_a_cylinder_that_turns_about_its_path(opened, dashpot, steps):
    """The distance is |x|, x = t - 0.5: F_n = k (R - |x|) + c before the axis. Behind it the force is
    reversed, with -c as far as the dashpot allows."""
    stiffness, damping, reach = 1e4, 1e3, 0.6
    values = HANGING | {"source.prescribed_displacement": [-0.5, 0.0, 0.0]}
    values |= {"source.prescribed_velocity": [1.0, 0.0, 0.0]}
    values |= {"source.prescribed_displacement.derivatives": [[1.0, 0.0, 0.0]]}
    values |= {"destination.prescribed_angular_velocity": [0.7, 0.0, 0.0]}
    values |= {"contact.viscous_penalty_factor": damping, "contact.dashpot": dashpot}
    impulse, peak = impulse_and_peak(opened("TurningForceElement"), values, 1.0, steps)
    pulls = 0.0 if dashpot == "approach_only" else damping
    until = reach - pulls / stiffness if dashpot == "non_adhesive" else reach
    until = min(until, 0.5)  # the run ends there
    before = stiffness * (reach * 0.5 - 0.125) + damping * 0.5
    behind = (stiffness * reach - pulls) * until - 0.5 * stiffness * until**2
    check_close("impulse", impulse, [behind - before, 0.0, 0.0], 1e-9)
    check_close("peak", peak, stiffness * reach + damping, 1e-7)


@pytest.mark.parametrize("spin", [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]])
@pytest.mark.parametrize("steps", [1, 10])
def test_a_gap_rate_that_is_rounding_holds_up_no_step(opened, spin, steps):
    """An approach_only dashpot acts under a cylinder that begins to turn away from a source at rest."""
    values = {"contact.dashpot": "approach_only", "destination.axis": [1.0, 0.0, 0.0]}
    values |= {"destination.prescribed_axis": [1.0, 0.0, 0.0], "source.center": [0.18, 0.52, 0.0]}
    values |= {"destination.prescribed_angular_velocity": spin}
    fmu = run(opened("TurningForceElement"), values, 1.0, steps, None, None)
    axis = Rotation.from_rotvec(spin).apply([1.0, 0.0, 0.0])
    place = np.array([0.18, 0.52, 0.0])
    distance = np.linalg.norm(place - (place @ axis) * axis)
    reach = fmu["source.radius"] + fmu["destination.radius"]
    assert fmu["contact.gap"] == pytest.approx(distance - reach, abs=1e-14)


@pytest.mark.parametrize("motion", ["free", "prescribed"])
@pytest.mark.parametrize("steps", [1, 3])
def test_what_rises_above_a_spinning_cap_before_it_falls_is_met(opened, motion, steps):
    """gap = 0.2 + t - 2 t^2: the axis of the cylinder stands still, and the source moves along it alone."""
    values = {"source.motion": motion, "source.radius": 0.1, "source.center": [0.2, 0.0, 0.8]}
    values |= {"destination.axis": [0.0, 0.0, 1.0], "destination.finite_length": True}
    values |= {"destination.length": 1.0, "destination.ends": "capped", "destination.rotation": "prescribed"}
    values |= {"destination.prescribed_axis": [0.0, 0.0, 1.0]}
    values |= {"destination.prescribed_angular_velocity": [0.0, 0.0, 1.0], "contact.penalty_factor": 1.0}
    values |= {"contact.viscous_penalty_factor": 0.0}
    if motion == "free":
        values |= {"source.initial_velocity": [0.0, 0.0, 1.0], "gravity": [0.0, 0.0, -4.0]}
    else:
        values |= {"source.prescribed_velocity": [0.0, 0.0, 1.0]}
        values |= {"source.prescribed_displacement.derivatives": [[0.0, 0.0, 1.0], [0.0, 0.0, -4.0]]}
        values |= {"source.prescribed_velocity.derivatives": [[0.0, 0.0, -4.0]]}
    fmu = run(opened("SphereCylinder"), values, 3.0, steps, None, None)
    assert (fmu["contact.onsets"], fmu["contact.active"]) == (1, False)
    check_close("onset", fmu["contact.last_onset_time"], 0.25 * (1.0 + np.sqrt(2.6)), 1e-12)


@pytest.mark.parametrize("steps", [1, 7, 30])
def test_friction_without_a_dashpot_ends_with_the_normal_force(opened, steps):
    """gap = 0.4 t - 0.35: the normal force falls from 3100 N to 0 at 0.775 s. The slip is (5, 0, 0.4) m/s."""
    values = HANGING | {"source.radius": 0.5, "source.prescribed_displacement": [0.0, 0.65, 0.0]}
    values |= {"source.prescribed_velocity": [0.0, 0.4, 0.4]}
    values |= {"source.prescribed_displacement.derivatives": [[0.0, 0.4, 0.4]]}
    values |= {"source.prescribed_angular_velocity": [0.0, 1.0, 10.0]}
    values |= {"contact.viscous_penalty_factor": 1000.0, "contact.friction": "elastic"}
    values |= {"contact.friction_coefficient": 0.3, "contact.static_friction_coefficient": 0.5}
    values |= {"contact.tangential_stiffness": 5e3, "contact.tangential_damping": 0.0}
    impulse, _ = impulse_and_peak(opened("TurningForceElement"), values, 1.0, steps)
    check_close("impulse", impulse[1], 3100.0 * 0.775 / 2.0, 1e-6)
    check_close("friction", impulse[2] / impulse[0], 0.4 / 5.0, 1e-9)


def test_a_source_that_slides_along_a_cylinder_exactly_at_the_touch_holds_up_no_step(opened):
    """Rounding decides whether it touches: the force is that of a gap of some 1e-16 m."""
    values = HANGING | {"source.center": [0.0, 0.6, 0.0], "source.prescribed_displacement": [0.0, 0.0, 0.0]}
    values |= {"source.prescribed_velocity": [0.0, 0.0, 1.0]}
    values |= {"source.prescribed_displacement.derivatives": [[0.0, 0.0, 1.0]]}
    values |= {"contact.dashpot": "approach_only", "contact.friction": "elastic"}
    fmu = start(opened("TurningForceElement"), values)
    fmu.step(1.0)
    check_close("mean force", fmu["contact.mean_force"], [0.0, 0.0, 0.0], 1e-11)


def test_what_changes_without_end_is_refused_with_a_message(opened):
    """A wheel goes round a million times in one step, about a direction that turns."""
    values = HANGING | {"source.prescribed_velocity": [0.0, 0.0, 0.0]}
    values |= {"destination.prescribed_angular_velocity": [1e6, 0.0, 0.0]}
    values |= {"destination.prescribed_angular_velocity.derivatives": [[0.0, 1e6, 0.0]]}
    fmu = start(opened("TurningForceElement"), values)
    with pytest.raises(Exception, match="more often than can be followed"):
        fmu.step(10.0)
    assert fmu.time == 0.0
    fmu.step(1e-6)


def test_springs_of_elastic_friction_count_for_the_work_that_they_take(opened):
    """A panel with springs counts as three: turning on for 2,000 s takes more panels than one step may."""
    values = {"source.motion": "prescribed", "source.rotation": "prescribed"}
    values |= {"source.center": [0.0, 0.0, 0.05], "source.prescribed_angular_velocity": [1.0, 2.0, 3.0]}
    values |= {"destination.motion": "prescribed", "destination.rotation": "prescribed"}
    values |= {"destination.prescribed_angular_velocity": [0.1, 1.0, 0.3], "contact.friction": "elastic"}
    fmu = start(opened("SpherePlane"), values)
    with pytest.raises(Exception, match="more often than can be followed"):
        fmu.step(2000.0)
    assert fmu.time == 0.0
    fmu.step(100.0)


@pytest.mark.parametrize("steps", [1, 2, 7])
@pytest.mark.parametrize("motion", ["prescribed", "free"])
def test_a_source_that_turns_enters_by_the_end_while_its_gap_stays(opened, motion, steps):
    """It moves along the cylinder, 1 mm deep, so that the end alone tells when contact begins and ends."""
    values = {"gravity": [0.0, 0.0, 0.0], "source.radius": 0.1, "source.center": [0.599, 0.0, 2.0]}
    values |= {"source.motion": motion, "source.rotation": motion, "destination.radius": 0.5}
    values |= {"destination.axis": [0.0, 0.0, 1.0], "destination.finite_length": True}
    values |= {"destination.length": 1.0, "contact.location": "outside", "contact.penalty_factor": 1000.0}
    if motion == "prescribed":
        values["source.prescribed_velocity"] = [0.0, 0.0, -2.0]
        values["source.prescribed_displacement.derivatives"] = [[0.0, 0.0, -2.0]]
    else:
        values["source.initial_velocity"] = [0.0, 0.0, -2.0]
    fmu = run(opened("SphereCylinder"), values, 2.5, steps, None, None)
    assert fmu["contact.onsets"] == 1
    check_close("onset", fmu["contact.last_onset_time"], 0.75, 1e-14)
    if motion == "prescribed":
        check_close("duration", fmu["contact.last_duration"], 0.5, 1e-14)


@pytest.mark.parametrize("steps", [1, 2, 100])
def test_a_spring_whose_slip_is_rounding_needs_no_panels(opened, steps):
    """A source sinks straight into a cylinder that turns about the normal."""
    values = {"source.radius": 0.1, "source.center": [0.0, 0.0, 1.09]}
    values |= {"source.prescribed_velocity": [0.0, 0.0, -0.5]}
    values |= {"source.prescribed_displacement.derivatives": [[0.0, 0.0, -0.5]], "destination.radius": 0.5}
    values |= {"destination.axis": [0.0, 1.0, 0.0], "destination.prescribed_axis": [0.0, 1.0, 0.0]}
    values |= {"destination.prescribed_angular_velocity": [0.0, 0.0, 0.5], "contact.penalty_factor": 1e6}
    values |= {"contact.viscous_penalty_factor": 10.0, "contact.friction": "elastic"}
    values |= {"contact.static_friction_coefficient": 0.5, "contact.tangential_stiffness": 5e5}
    values |= {"contact.tangential_damping": 1.0}
    fmu = run(opened("TurningForceElement"), values, 1.5, steps, None, None)
    check_close("force", fmu["contact.normal_force"], 0.26 * 1e6 + 0.5 * 10.0, 1e-6)
    check_close("friction", fmu["contact.friction_force"], [0.0, 0.0, 0.0], 1e-9)


def test_a_plane_that_moves_and_turns_away_has_no_deeper_penetration_than_samples_show(opened):
    """A contact that separates was once followed along the plane's first normal."""
    values = {"gravity": [0.0, 0.0, 0.0], "source.center": [-0.32, 0.0, 0.15]}
    values |= {"source.initial_velocity": [0.0, 0.0, -0.46], "contact.penalty_factor": 6.1e4}
    values |= {"contact.viscous_penalty_factor": 64.0, "destination.motion": "prescribed"}
    values |= {"destination.rotation": "prescribed", "destination.axis": [0.0, 0.0, 1.0]}
    values |= {"destination.prescribed_axis": [0.0, 0.0, 1.0]}
    values |= {"destination.prescribed_velocity": [0.33, 0.04, 0.11]}
    values |= {"destination.prescribed_displacement.derivatives": [[0.33, 0.04, 0.11]]}
    values |= {"destination.prescribed_angular_velocity": [0.0, -0.9, 0.17]}
    scene = Scene("SpherePlane", values, 0.5)
    whole = answer(opened("SpherePlane"), scene, 1e-10, 1, readings=True)
    peak = answer(opened("SpherePlane"), scene, 1e-10, 400, readings=True)["contact.peak_penetration"]
    assert peak > 1e-4
    check_close("peak penetration", whole["contact.peak_penetration"], peak, 1e-8 * peak)
