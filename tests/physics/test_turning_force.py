"""Forces, torques, slip and friction of bodies that turn, and their directional derivatives, against the
reference's formulas (support/reference/turning.py): at random motions, all shapes, outside and
inside, every dashpot. Derivatives are complex steps of those formulas, exact to rounding."""

import numpy as np
import pytest

from support.checks import start
from support.reference.turning import TurningPair, outputs

COUNT = 40
VALUES, DERIVATIVES = 1e-12, 1e-9
# A gap of 1e-3 m is the difference of coordinates of a metre: some 1e-16 m of rounding, times p_n [N].
ROUNDED_FORCE = 1e6 * 2e-15 / VALUES
SCENES = [("SphereSphere", "sphere", 1), ("SphereSphere", "sphere", -1), ("SphereCylinder", "cylinder", 1)]
SCENES += [("SphereCylinder", "cylinder", -1), ("SpherePlane", "plane", 1)]
MOTION = {"source.prescribed_displacement": "source.displacement"}
MOTION |= {"destination.prescribed_displacement": "destination.displacement"}
MOTION |= {"source.prescribed_velocity": "source.velocity"}
MOTION |= {"destination.prescribed_velocity": "destination.velocity"}
MOTION |= {"source.prescribed_angular_velocity": "source.omega"}
MOTION |= {"destination.prescribed_angular_velocity": "destination.omega"}
MOTION |= {"destination.prescribed_axis": "axis"}


def random_case(rng, shape, side):
    """Returns values of the formulas, and a motion that overlaps three times out of four."""
    v = {"shape": shape, "side": side, "r_s": rng.uniform(0.05, 0.2), "r_d": rng.uniform(0.4, 0.8)}
    v |= {"p_n": 1e6, "p_nv": rng.choice([0.0, 100.0, 3000.0]), "unclamped": bool(rng.integers(2))}
    v |= {"mu": rng.uniform(0.0, 1.0), "v_0": 10 ** rng.uniform(-4, 0), "largest": rng.choice([1e300, 200.0])}
    for kind in ("rolling", "spinning"):
        v[kind] = str(rng.choice(["none", "regularized", "regularized"]))
        v[f"{kind}_coefficient"], v[f"{kind}_rate"] = rng.uniform(0.0, 1.0), 10 ** rng.uniform(-2, 1)
    m = {name: rng.normal(size=3) for name in MOTION.values()}
    for name in ("source.displacement", "destination.displacement"):
        m[name] *= 0.01
    m["axis"] *= 10.0 ** rng.uniform(-3, 3)
    e = m["axis"] / np.linalg.norm(m["axis"])
    normal = rng.normal(size=3)
    if shape == "cylinder":
        normal -= normal @ e * e
    normal = -e if shape == "plane" else normal / np.linalg.norm(normal)
    gap = rng.uniform(-3e-3, 1e-3)
    reach = side * v["r_s"] + (0.0 if shape == "plane" else v["r_d"])
    c = (side * gap + reach) * normal
    if shape != "sphere":
        across = np.cross(e, rng.normal(size=3)) if shape == "plane" else e
        c = c + rng.normal() * across
    m["source.center"] = rng.normal(size=3)
    place = m["source.center"] + m["source.displacement"]
    m["destination.center"] = place + c - m["destination.displacement"]
    return v, m


def settings(v):
    values = {"source.motion": "prescribed", "destination.motion": "prescribed"}
    values |= {"source.rotation": "prescribed", "destination.rotation": "prescribed"}
    values |= {"contact.friction": "regularized", "contact.slip_velocity_control": "user_defined"}
    values |= {"contact.characteristic_slip_velocity": v["v_0"], "contact.friction_coefficient": v["mu"]}
    values |= {"contact.maximum_friction_force": v["largest"], "contact.viscous_penalty_factor": v["p_nv"]}
    values |= {"source.radius": v["r_s"]}
    values |= {"contact.dashpot": "unclamped" if v["unclamped"] else "non_adhesive"}
    for kind in ("rolling", "spinning"):
        values |= {f"contact.{kind}": v[kind], f"contact.{kind}_coefficient": v[f"{kind}_coefficient"]}
        values |= {f"contact.characteristic_{kind}_rate": v[f"{kind}_rate"]}
    if v["shape"] != "plane":
        values |= {
            "destination.radius": v["r_d"],
            "contact.location": "outside" if v["side"] > 0 else "inside",
        }
    return values


def inputs(v, m):
    return {name: m[field] for name, field in MOTION.items() if field != "axis" or v["shape"] != "sphere"}


def names_of(found):
    return {name: ("destination." if name == "current_axis" else "contact.") + name for name in found}


def begun(fmu, v, m):
    """The scene is initialized at rest, then the motion m is set as new inputs."""
    centers = {name: m[name] for name in ("source.center", "destination.center")}
    start(fmu, settings(v) | centers)
    for name, value in inputs(v, m).items():
        fmu[name] = value
    return fmu


@pytest.mark.parametrize(("scene", "shape", "side"), SCENES)
def test_outputs_are_those_of_the_formulas(opened, scene, shape, side):
    rng = np.random.default_rng(7)
    rubbing = 0
    for _ in range(COUNT):
        v, m = random_case(rng, shape, side)
        expected = outputs(TurningPair(settings(v), shape), m)
        fmu = begun(opened(scene), v, m)
        for name, full in names_of(expected).items():
            got, wanted = np.atleast_1d(fmu[full]), expected[name]
            size = np.linalg.norm(wanted) + (ROUNDED_FORCE if "force" in name or "torque" in name else 1.0)
            assert np.linalg.norm(got - wanted) <= VALUES * size, (name, got, wanted, v, m)
        rubbing += np.linalg.norm(expected["friction_force"]) > 0
        assert fmu["contact.sticking"] == (
            expected["gap"][0] < 0 and np.linalg.norm(expected["slip_velocity"]) < v["v_0"]
        )
    assert rubbing > COUNT / 3


@pytest.mark.parametrize(("scene", "shape", "side"), SCENES)
def test_directional_derivatives_are_complex_steps_of_the_formulas(opened, scene, shape, side):
    rng = np.random.default_rng(8)
    step = 1e-30
    for _ in range(COUNT // 2):
        v, m = random_case(rng, shape, side)
        pair = TurningPair(settings(v), shape)
        names = names_of(outputs(pair, m))
        fmu = begun(opened(scene), v, m)
        for given in inputs(v, m):
            given_columns = {name: np.atleast_2d(fmu.jacobian(full, given)) for name, full in names.items()}
            for k in range(3):
                moved = {name: value.astype(complex) for name, value in m.items()}
                moved[MOTION[given]][k] += 1j * step
                wanted = outputs(pair, moved)
                for name, columns in given_columns.items():
                    got = columns[:, k]
                    exact = wanted[name].imag / step
                    # p_n times a unit of change is 1e6 N: parts that cancel leave 1e-9 of it at most
                    size = np.linalg.norm(exact) + np.linalg.norm(wanted[name].real) + 10.0
                    assert np.linalg.norm(got - exact) <= DERIVATIVES * size, (name, given, k, got, exact, v)
