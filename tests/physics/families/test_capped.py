"""Capped cylinders and open ends: random scenes round what once went wrong there, and those very scenes."""

import numpy as np
import pytest
from scipy.optimize import brentq

from support.checks import check_close, run
from support.reference import hertz
from support.scenes.agreement import Scene, check_agreement, pick, seeds

R_S, R_D, LENGTH = 0.1, 0.5, 2.0
STIFFNESS, DAMPING = 1e6, 100.0
CAPPED = {"source.radius": R_S, "destination.radius": R_D, "destination.axis": [0.0, 0.0, 1.0]}
CAPPED |= {"destination.finite_length": True, "destination.length": LENGTH, "destination.ends": "capped"}
CAPPED |= {"gravity": [0.0, 0.0, 0.0]}
# Where a ball meets the solid: the point of it, and its normal.
PLACES = {
    "side": ((R_D, 0.0, 0.0), (1.0, 0.0, 0.0)),
    "cap": ((0.3, 0.1, 0.5 * LENGTH), (0.0, 0.0, 1.0)),
    "middle of the cap": ((0.0, 0.0, 0.5 * LENGTH), (0.0, 0.0, 1.0)),
    "rim": ((R_D, 0.0, 0.5 * LENGTH), (0.6, 0.0, 0.8)),
    "edge of the side": ((R_D, 0.0, 0.5 * LENGTH), (1.0, 0.0, 0.0)),
    "edge of the cap": ((R_D, 0.0, -0.5 * LENGTH), (0.0, 0.0, -1.0)),
}


def touching(place, gap):
    point, normal = (np.array(of) for of in PLACES[place])
    return point + (R_S + gap) * normal, normal


def loaded(place, gap, order, force=10.0, aside=0.0):
    """The ball rests at a gap. A force against the normal, and one over an edge, grow as t^order / order!."""
    center, normal = touching(place, gap)
    rows = [[0.0, 0.0, 0.0]] * (order - 1) + [list(np.array([aside, 0.0, aside]) - force * normal)]
    return CAPPED | {"source.center": list(center), "source.external_force.derivatives": rows}


@pytest.mark.parametrize("steps", [1, 10])
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("gap", [0.0, 1e-15, -1e-15])
@pytest.mark.parametrize("place", PLACES)
def test_a_ball_that_touches_is_met_by_a_force_that_grows_from_zero(opened, place, gap, order, steps):
    """Then the depth follows the load: m x'' + c x' + k x = F has a polynomial as its solution."""
    fmu = run(opened("SphereCylinder"), loaded(place, gap, order, aside=1e-7), 1.0, steps, 1e-10)
    load = 10.0 / (order * STIFFNESS)
    rate, bend = DAMPING / STIFFNESS, (DAMPING**2 / STIFFNESS - 1.0) / STIFFNESS
    depth = load * (1.0 - order * rate + (order - 1) * 2.0 * bend)
    check_close("gap", fmu["contact.gap"], -depth, 1e-12)
    assert fmu["contact.onsets"] == 1
    assert fmu["contact.last_onset_time"] < 1e-3


def grown_load(random):
    """A ball at or near a touch slides and may turn back, under a force that grows from zero."""
    place = str(random.choice(list(PLACES)))
    gap = float(random.choice([0.0, 0.0, 1e-15, -1e-15, 1e-6, 1e-3]))
    values = loaded(place, gap, int(random.choice([1, 2])), float(random.choice([0.1, 1.0, 10.0])))
    normal = np.array(PLACES[place][1])
    along = np.cross(normal, [0.0, 1.0, 0.0]) * float(random.choice([0.0, 0.0, 0.1, 0.5]))
    along += np.array([0.0, float(random.choice([0.0, 0.0, 0.1])), 0.0])
    values |= {"source.initial_velocity": list(along)}
    values |= {"contact.penalty_factor": float(random.choice([1e3, 1e5, 1e6]))}
    values |= {"contact.dashpot": str(random.choice(["non_adhesive", "unclamped", "approach_only"]))}
    # Second and later touches are as slow as 1e-3 m/s, so that a nanometre makes a microsecond.
    least = {"last_onset_time": 1e2, "last_duration": 1e2}
    return Scene("SphereCylinder", values, end=float(random.choice([0.5, 1.0])), floor=least)


def decay(mass, stiffness, damping, speed, time):
    """Returns the depth after a touch with `speed`, beyond critical damping."""
    half = 0.5 * damping / mass
    split = np.sqrt(half**2 - stiffness / mass)
    return speed / split * np.exp(-half * time) * np.sinh(split * time)


def test_a_start_on_the_edge_of_cap_and_rim_goes_inward(opened):
    values = CAPPED | {"source.radius": 0.5, "source.mass": 0.1, "contact.dashpot": "unclamped"}
    values |= {"source.center": [9.910557280900008, 0.044721359549995794, 0.6]}
    values |= {"source.initial_velocity": [0.4472135954999579, -0.22360679774997896, -2.0]}
    values |= {"destination.center": [10.0, 0.0, 0.0], "destination.radius": 0.1, "destination.length": 0.2}
    values |= {"contact.penalty_factor": 1e7, "contact.viscous_penalty_factor": 2e4}
    fmu = run(opened("SphereCylinder"), values, 0.002, 1, 1e-10)
    check_close("gap", fmu["contact.gap"], -decay(0.1, 1e7, 2e4, 2.0, 0.002), 1e-13)
    check_close("x", fmu["source.position"][0], 9.910557280900008 + 0.002 * 0.4472135954999579, 1e-14)
    assert fmu["contact.zone"] == "cap"


def edge_start(random):
    """A ball at the edge of a rim, in a cap or side or over it, moves inward, outward or along the edge."""
    r_s, r_d = float(random.choice([0.05, 0.1, 0.5])), float(random.choice([0.1, 0.5, 1.0]))
    length = float(random.choice([0.2, 1.0, 2.0]))
    angle = float(random.choice([0.0, 0.5 * np.pi, np.arctan2(3, 4), np.arctan2(1, -2), -0.75 * np.pi]))
    out = np.array([np.cos(angle), np.sin(angle), 0.0])
    up = np.array([0.0, 0.0, float(random.choice([1, -1]))])
    normal, inward = (up, -out) if random.random() < 0.5 else (out, -up)
    gap = float(random.choice([0.0, 0.0, 1e-3, -1e-3]))
    move = -float(random.choice([0.0, 0.5, 2.0])) * normal
    move += float(random.choice([0.5, 0.5, 0.0, -0.5])) * inward
    move += float(random.choice([0.0, 0.5])) * np.cross(normal, inward)
    center = np.array([float(random.choice([0.0, 10.0])), 0.0, 0.0])
    values = CAPPED | {"source.radius": r_s, "source.mass": float(random.choice([0.1, 1.0]))}
    values |= {"contact.penalty_factor": float(random.choice([1e4, 1e6, 1e7]))}
    values |= {"source.center": list(center + r_d * out + 0.5 * length * up + (r_s + gap) * normal)}
    values |= {"source.initial_velocity": list(move), "destination.center": list(center)}
    values |= {"destination.radius": r_d, "destination.length": length}
    values |= {"gravity": list(-float(random.choice([0.0, 10.0])) * normal)}
    values |= {"contact.viscous_penalty_factor": float(random.choice([0.0, 10.0, 2e3, 2e4]))}
    values |= {"contact.dashpot": str(random.choice(["non_adhesive", "unclamped", "approach_only"]))}
    # A dashpot of 2e4 N s/m makes 1e-9 N of what is rounding in a speed.
    return Scene("SphereCylinder", values, end=float(random.choice([0.0025, 0.03, 0.1])), slack=50.0)


@pytest.mark.parametrize("stiffness", [1e12, 1e16, 1e17, 1e18, 1e20, 1e24])
@pytest.mark.parametrize("part", [1.0, 1.5, 3.0])
def test_a_ball_comes_to_rest_on_a_stiff_cap(opened, stiffness, part):
    """Its hops end as on a plane, and with them the steps."""
    values = {"source.center": [0.0, 0.35, 2.1], "source.initial_velocity": [0.0, -1.0, -0.5]}
    values |= {"gravity": [0.0, 0.0, -10.0], "destination.radius": 0.3, "contact.penalty_factor": stiffness}
    values |= {"contact.viscous_penalty_factor": 2.0 * part * np.sqrt(stiffness)}
    fmu = run(opened("SphereCylinder"), CAPPED | values, 0.62, 1, 1e-10)
    check_close("depth", fmu["contact.gap"], -10.0 / stiffness, 1e-6 * 10.0 / stiffness)
    check_close("y", fmu["source.position"][1], 0.35 - 0.62, 1e-12)
    assert fmu["solver.events"] < 500


def stiff_landing(random):
    """A ball falls on a cap, a rim's top or a side and hops to rest, in stiff contact."""
    place = str(random.choice(["cap", "middle of the cap", "side", "edge of the cap"]))
    center, normal = touching(place, float(random.choice([0.0, 0.01, 1.0])))
    along = np.cross(normal, [0.6, 0.0, 0.8]) if place == "side" else np.array([0.6, -0.8, 0.0])
    stiffness = float(random.choice([1e8, 1e12, 1e16, 1e18, 1e20]))
    values = CAPPED | {
        "gravity": list(-10.0 * normal), "source.center": list(center),
        "source.initial_velocity": list(-float(random.choice([0.0, 0.5,
            1.0])) * normal - float(random.choice([0.0, 0.0, 0.1])) * along),
        "contact.penalty_factor": stiffness,
        "contact.viscous_penalty_factor": float(random.choice([0.2, 1.0, 3.0])) * 2.0 * np.sqrt(stiffness),
        "contact.dashpot": str(random.choice(["non_adhesive", "approach_only"])),
    }  # fmt: skip
    # Hops become smaller without end, and how many of them are seen is rounding's.
    hops = {"onsets": np.inf, "last_onset_time": np.inf, "last_duration": np.inf}
    return Scene("SphereCylinder", values, end=float(random.choice([0.5, 1.0])), floor=hops)


# A ball falls on a cylinder beside which it is exactly in the plane of an open end.
IN_THE_PLANE = {"source.radius": 1.0, "source.center": [0.0, -5.0, 12.0], "destination.radius": 10.0}
IN_THE_PLANE |= {"destination.axis": [0.0, 1.0, 0.0], "destination.finite_length": True}
IN_THE_PLANE |= {"destination.length": 10.0}


@pytest.mark.parametrize("steps", [1, 10, 300])
def test_the_plane_of_an_open_end_is_within(opened, steps):
    """The ball bounces as on a cylinder without ends."""
    values = IN_THE_PLANE | {"destination.finite_length": False}
    fmu = run(opened("SphereCylinder"), values, 1.0, steps, 1e-10)
    endless = fmu["source.position"], fmu["energy.dissipated"]
    fmu = run(opened("SphereCylinder"), IN_THE_PLANE, 1.0, steps, 1e-10)
    check_close("position", fmu["source.position"], endless[0], 1e-12)
    check_close("dissipated", fmu["energy.dissipated"], endless[1], 1e-10)
    assert fmu["contact.within_extents"] and fmu["contact.onsets"] == 1


@pytest.mark.parametrize("spin", [0.0, 1.0])
def test_the_plane_of_an_open_end_is_within_although_the_cylinder_may_turn(opened, spin):
    """The ball is met as a nanometre within. The axis has rounding that puts the ball beyond the end."""
    turns = {"destination.rotation": "free", "destination.initial_angular_velocity": [0.0, spin, 0.0]}
    turns |= IN_THE_PLANE | {"gravity": [0.0, 0.0, 9.81]}
    starts = [{"source.center": [0.0, y, -12.0]} for y in (-5.0, -5.0 + 1e-9)]
    ends = [run(opened("SphereCylinder"), turns | one, 1.0, 1, 1e-10)["source.position"] for one in starts]
    check_close("position", *ends, 1e-8)


def test_a_growing_force_takes_a_source_out_of_the_plane_of_an_open_end(opened):
    force = {"source.external_force.derivatives": [[0.0, -60.0, 0.0]]}
    values = IN_THE_PLANE | force | {"source.center": [0.0, -5.0, 11.0 - 1e-5]}
    assert 0.0 < run(opened("SphereCylinder"), values, 0.2, 1, 1e-10)["contact.last_duration"] < 1e-4


def at_an_end(random):
    """A ball is in or near the plane of an end, to rounding, in contact or not. The axis is random."""
    axis = random.choice([[0, 1, 0], [0, 0, 1], [3, 0, 4], [1, 1, 0], [1, 2, 2], [0, -1, 0]])
    axis = axis / np.linalg.norm(axis)
    across = np.cross(axis, [1.0, 0.0, 0.0] if abs(axis[0]) < 0.5 else [0.0, 0.0, 1.0])
    across /= np.linalg.norm(across)
    inside = bool(random.random() < 0.4)
    r_s, r_d = float(random.choice([0.1, 0.5, 1.0])), float(random.choice([2.0, 10.0]))
    length = float(random.choice([0.2, 1.0, 10.0]))
    gap = float(random.choice([0.0, 0.01, 0.5, -0.001]))
    over = float(random.choice([0.0, 0.0, 0.0, 1.0, -1.0, 3.0])) * np.spacing(0.5 * length)
    center = axis * (0.5 * length + over) * float(random.choice([1.0, -1.0]))
    center = center + across * (r_d - r_s - gap if inside else r_d + r_s + gap)
    towards = across if inside else -across
    values = {"source.radius": r_s, "source.center": list(center)}
    values |= {"source.initial_velocity": list(towards * float(random.choice([0.0, 0.0, 1.0])))}
    values |= {"destination.radius": r_d, "destination.axis": list(axis), "destination.finite_length": True}
    values |= {"destination.length": length, "contact.location": "inside" if inside else "outside"}
    values |= {"contact.penalty_factor": float(random.choice([1e4, 1e6]))}
    values |= {"gravity": list(towards * float(random.choice([0.0, 10.0])))}
    return Scene("SphereCylinder", values, end=1.0)


@pytest.mark.parametrize("seed", [*seeds(), 95161])
def test_outputs_agree_at_an_end_whichever_side_rounding_takes(opened, seed):
    random = np.random.default_rng(seed)
    scene, fmu = at_an_end(random), opened("SphereCylinder")

    def outputs_agree(fmu):
        gap, within = fmu["contact.gap"], fmu["contact.within_extents"]
        assert (gap > 1e29) == (not within), scene
        if fmu["contact.active"]:
            assert within and gap < 1e-13, scene
        else:
            assert not within or gap > -1e-13, scene
            assert fmu["contact.normal_force"] == 0.0

    steps = int(random.choice([1, 3, 10, 50]))
    run(fmu, scene.values, scene.end, steps, float(random.choice([1e-4, 1e-8, 1e-12])), each=outputs_agree)
    assert fmu["solver.events"] < 1000, scene


# The centre goes inside the solid, where the nearest face pushes it out.
THROUGH_THE_AXIS = CAPPED | {"source.center": [-1.0, 0.0, 0.95], "source.initial_velocity": [4.0, 0.0, -5.5]}
THROUGH_THE_AXIS |= {"contact.penalty_factor": 10.0, "contact.method": "penalty"}
THREE_FACES_AS_NEAR = CAPPED | {"source.radius": 0.05, "destination.radius": 0.3, "destination.length": 0.3}
THREE_FACES_AS_NEAR |= {"source.center": [0.15, 0.0, 0.3], "source.initial_velocity": [0.0, 0.0, -2.0]}
THREE_FACES_AS_NEAR |= {"contact.penalty_factor": 1.0, "contact.method": "penalty"}
CAP_TO_CAP = CAPPED | {"source.radius": 0.1, "destination.radius": 0.1, "destination.length": 0.1}
CAP_TO_CAP |= {"source.mass": 2.0, "source.center": [0.03, 0.0, -0.3]}
CAP_TO_CAP |= {"source.initial_velocity": [0.0, 0.0, 5.0], "contact.penalty_factor": 1e3}
CAP_TO_CAP |= {"contact.viscous_penalty_factor": 10.0, "contact.dashpot": "approach_only"}


@pytest.mark.parametrize("tolerance", [1e-5, 1e-12])
@pytest.mark.parametrize("steps", [1, 7, 10])
@pytest.mark.parametrize(
    ("values", "end"), [(THROUGH_THE_AXIS, 0.5), (CAP_TO_CAP, 0.2)], ids=["through the axis", "cap to cap"]
)
def test_a_centre_inside_passes_from_face_to_face(opened, values, end, steps, tolerance):
    fmu = run(opened("SphereCylinder"), values, end, steps, tolerance)
    right, _ = hertz.follow("SphereCylinder", values, end)
    check_close("position", fmu["source.position"], right[0:3], 1e-11)
    check_close("dissipated", fmu["energy.dissipated"], right[12], 1e-10)
    issue = {0.5: 0.885885, 0.2: 0.554541}[end]
    assert np.min(np.abs(fmu["source.position"] - issue)) < 5e-7


@pytest.mark.parametrize("method", ["event_driven", "cvode_bdf"])
@pytest.mark.parametrize("steps", [1, 7, 10])
def test_a_point_as_near_to_both_caps_as_to_the_side_is_passed_straight_on(opened, steps, method):
    """From cap to cap the side is no nearer anywhere. A spring gives back what it took."""
    tolerance = 1e-10 if method == "event_driven" else 1e-7
    fmu = run(opened("SphereCylinder"), THREE_FACES_AS_NEAR, 0.3, steps, 1e-10, method)
    inside = 2.0 * np.arcsin(0.1)
    check_close("position", fmu["source.position"], [0.15, 0.0, -0.2 - 2.0 * (0.25 - inside)], tolerance)
    check_close("velocity", fmu["source.velocity"], [0.0, 0.0, -2.0], tolerance)
    check_close("dissipated", fmu["energy.dissipated"], 0.0, 1e-14)


def soft_law(random, energy, mass, depth):
    """The contact gives by some of `depth` before it has taken `energy`."""
    stiffness = float(f"{energy / (0.5 * depth**2) * pick(random, 0.05, 0.3, 0.9, 1.5):.1g}")
    if random.random() < 0.25:
        values = {"contact.law": "hertz", "contact.penalty_control": "user_defined"}
        values |= {"contact.hertz_stiffness": float(f"{stiffness / depth**0.5:.1g}")}
        values |= {"contact.viscous_control": "user_defined"}
        values |= {"contact.hunt_crossley_factor": pick(random, 0.0, 0.01, 0.1)}
        return values
    if random.random() < 0.5:
        return {"contact.method": "penalty", "contact.penalty_factor": stiffness}
    damping = pick(random, 0.0, 0.05, 0.3) * float(f"{2.0 * np.sqrt(stiffness * mass):.1g}")
    return {"contact.penalty_factor": stiffness, "contact.viscous_penalty_factor": damping}


# None at 45 degrees: along where cap and side are as near, which of them pushes is left to rounding.
WAYS = ((0, 0, 1), (1, 0, 0), (0, 1, 0), (4, 0, -5.5), (1, 0, -1.5), (0.6, 0, 0.8), (3, 4, 5), (1, 0.5, -2))


def deep_inside(random, aside=(0.0, 0.0, 0.001)):
    """A ball flies through a soft solid, towards a point of the axis, half-way between the caps or nearby."""
    r_s, r_d = pick(random, 0.05, 0.1, 0.5), pick(random, 0.1, 0.3, 0.5, 1.0)
    length = pick(random, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0, r_d, 2.0 * r_d)
    aim = np.array(
        [
            pick(random, 0.0, 0.5 * r_d, 0.03, 0.15) * pick(random, 1.0, -1.0),
            pick(random, *aside),
            pick(random, 0.0, 0.0, 0.25 * length, -0.125 * length),
        ]
    )
    way = np.array(pick(random, *WAYS), float) * pick(random, 1.0, -1.0)
    way /= np.linalg.norm(way)
    speed, mass = pick(random, 1.0, 2.0, 5.0, 10.0), pick(random, 0.1, 1.0, 2.0)
    far = r_s + r_d + 0.5 * length + np.linalg.norm(aim)
    values = CAPPED | {"source.radius": r_s, "source.mass": mass}
    values |= {"source.center": [float(x) for x in np.round(aim - pick(random, 1.0, 1.5) * far * way, 3)]}
    values |= {"source.initial_velocity": [float(x) for x in speed * way], "destination.radius": r_d}
    values |= {"destination.length": length, "contact.dashpot": pick(random, "non_adhesive", "approach_only")}
    values |= {"gravity": [0.0, 0.0, pick(random, 0.0, 0.0, 0.0, -10.0)]}
    values |= soft_law(random, 0.5 * mass * speed**2, mass, r_s + min(r_d, 0.5 * length))
    if random.random() < 0.25:
        values |= {"destination.motion": "free", "destination.mass": pick(random, 1.0, 5.0)}
    return Scene("SphereCylinder", values, end=float(f"{pick(random, 2.0, 4.0) * far / speed:.2g}"))


FAMILIES = {"a load that grows from zero": grown_load, "a start on the edge": edge_start}
FAMILIES |= {"a stiff landing": stiff_landing, "a centre deep inside": deep_inside}


@pytest.mark.parametrize("seed", [*seeds(), 5121])  # in the last one a stiff dashpot holds a ball at rest
@pytest.mark.parametrize("family", FAMILIES)
def test_a_ball_at_a_cap_ends_the_same_however_it_is_stepped(opened, family, seed):
    check_agreement(opened, FAMILIES[family](np.random.default_rng(seed)), seed)


# In the last two a centre passes from face to face while the dashpot is clipped.
@pytest.mark.parametrize("seed", [*seeds(8), 5007, 5033])
def test_a_centre_deep_inside_as_the_reference_has_it(opened, seed):
    """On the axis any direction, in the middle either cap is right: starts are off it, sizes are compared."""
    scene = deep_inside(np.random.default_rng(seed), aside=(0.013, 0.029))
    fmu = run(opened("SphereCylinder"), scene.values, scene.end, 1, 1e-11)
    right, _ = hertz.follow(scene.fmu, scene.values, scene.end)
    check_close("source", np.abs(fmu["source.position"]), np.abs(right[0:3]), 1e-8)
    check_close("destination", np.abs(fmu["destination.position"]), np.abs(right[3:6]), 1e-8)
    check_close("dissipated", fmu["energy.dissipated"], right[12], 1e-8 * (1.0 + right[12]))


def test_on_the_axis_a_ball_is_pushed_out_in_the_direction_of_the_side(opened):
    """The cap from which it comes would push it along the axis. No energy is lost."""
    values = CAPPED | {"source.center": [0.0, 0.0, 1.5], "source.initial_velocity": [0.0, 0.0, -3.0]}
    values |= {"contact.penalty_factor": 20.0, "contact.method": "penalty"}
    fmu = run(opened("SphereCylinder"), values, 2.0, 4, 1e-10)
    assert fmu["contact.zone"] == "none"
    assert np.hypot(*fmu["source.position"][:2]) > 0.6
    check_close("dissipated", fmu["energy.dissipated"], 0.0, 1e-12)
    check_close("kinetic", fmu["energy.kinetic"], 4.5, 1e-12)


@pytest.mark.parametrize("steps", [1, 7, 50])
def test_the_peak_at_the_axis_is_that_of_the_side(opened, steps):
    """A dashpot on approach pushes most just before the axis, whatever the normal was before the touch."""
    values = CAPPED | {"source.radius": 0.05, "source.mass": 2.0, "source.center": [1.032, 0.0, 1.416]}
    values |= {"source.initial_velocity": [-0.6, 0.0, -0.8], "destination.radius": 0.1}
    values |= {"contact.dashpot": "approach_only", "contact.penalty_factor": 4.0}
    values |= {"contact.viscous_penalty_factor": 1.8}
    peaks = []

    def note(fmu):
        peaks.append(fmu["contact.peak_force"])

    run(opened("SphereCylinder"), values, 4.7, steps, 1e-10, each=note)
    half, turns = 0.45, np.sqrt(2.0 - 0.45**2)  # depth = 0.6 exp(-half t) sin(turns t) / turns
    time = brentq(lambda t: 0.6 * np.exp(-half * t) * np.sin(turns * t) / turns - 0.15, 0.0, 0.5)
    speed = 0.6 * np.exp(-half * time) * (np.cos(turns * time) - half / turns * np.sin(turns * time))
    check_close("peak", max(peaks), 4.0 * 0.15 + 1.8 * speed, 1e-11)
