"""Symmetries of the model, on configurations chosen by hypothesis: turned, moved, roles changed, rescaled."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact_fmus.stability.motions import TABLE
from support.checks import FMU, METHODS, check_close, run
from support.scenes.strategies import BOUNDED, RESULTS, VECTORS, scenes, seeds

ALLOWED = 1e-7  # of the size of the motion; both runs at tolerance 1e-10
OUTPUTS = ["source.position", "source.velocity", "destination.position", "destination.velocity"]


def outcome(opened, scene, method, steps=3):
    fmu = run(opened(FMU[scene.shape]), scene.configuration, scene.end, steps, method=method)
    return {name: np.array(fmu[name]) for name in [*OUTPUTS, *RESULTS]}


def check_same(ends, expected, size=1.0):
    for name in expected:
        check_close(name, ends[name], expected[name], ALLOWED * size)


def rotation(seed):
    """A random proper rotation, by the orthogonal factor of a random matrix."""
    matrix, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return matrix * np.linalg.det(matrix)


@pytest.mark.parametrize("method", METHODS)
@BOUNDED
@given(scene=scenes(), seed=seeds)
def test_turning_the_world_turns_the_motion(opened, method, scene, seed):
    turn = rotation(seed)
    turned = {n: (turn @ v).tolist() if n in VECTORS else v for n, v in scene.configuration.items()}
    expected = {n: turn @ v if np.ndim(v) else v for n, v in outcome(opened, scene, method).items()}
    check_same(outcome(opened, scene._replace(configuration=turned), method), expected)


@pytest.mark.parametrize("method", METHODS)
@BOUNDED
@given(scene=scenes(), seed=seeds)
def test_moving_the_world_a_million_metres_moves_the_motion_only(opened, method, scene, seed):
    """X and u are kept apart: u, v, forces, energies lose nothing; x = X + u is rounded, 1e6 m to 1.2e-10 m.

    X + shift is exact: the shift is a power of two times whole numbers and X a multiple of 2^-30."""
    shift = 2.0**20 * np.random.default_rng(seed).integers(-1, 2, size=3)
    base = dict(scene.configuration)
    for name in ("source.center", "destination.center"):
        base[name] = (np.round(np.array(base[name]) * 2**30) / 2**30).tolist()
    moved = {n: (v + shift).tolist() if n.endswith(".center") else v for n, v in base.items()}
    names = [f"{body}.{row}" for body in ("source", "destination") for row in ("displacement", "velocity")]
    ends = []
    for configuration in (base, moved):
        fmu = run(opened(FMU[scene.shape]), configuration, scene.end, 3, method=method)
        ends.append({name: fmu[name] for name in [*names, *RESULTS]})
        ends[-1]["relative position"] = fmu["source.position"] - fmu["source.center"]
    relative = ends[1].pop("relative position"), ends[0].pop("relative position")
    check_close("source.position", *relative, 1e-9 + ALLOWED)
    check_same(ends[1], ends[0])


@pytest.mark.parametrize("method", METHODS)
@BOUNDED
@given(scene=scenes(shapes=["sphere"], locations=["outside"]))
def test_two_spheres_may_change_their_roles(opened, method, scene):
    other = {"source": "destination", "destination": "source"}

    def swap(name):
        body, _, rest = name.partition(".")
        return f"{other[body]}.{rest}" if body in other else name

    swapped = {swap(name): value for name, value in scene.configuration.items()}
    ends = outcome(opened, scene, method)
    again = outcome(opened, scene._replace(configuration=swapped), method)
    check_same({swap(n): again[n] for n in OUTPUTS}, {n: ends[n] for n in OUTPUTS})
    again["contact.mean_force"] = -again["contact.mean_force"]  # on the source, which was the destination
    check_same({n: again[n] for n in RESULTS}, {n: ends[n] for n in RESULTS})


# Exponents of metre, kilogram and second for what a configuration and its results are measured in.
DIMENSIONS = TABLE["dimensions"] | {"position": (1, 0, 0), "absolute_tolerance": (1, 0, 0)}
DIMENSIONS |= {"force": (1, 1, -2), "duration": (0, 0, 1), "dissipated": (2, 1, -2)}


def unit_factor(name, metre, second, kilogram):
    row = name.split(".")[-1]
    for key in sorted(DIMENSIONS, key=len, reverse=True):
        if row.endswith(key):
            length, mass, time = DIMENSIONS[key]
            return metre**length * second**time * kilogram**mass
    return 1.0


@pytest.mark.parametrize("method", METHODS)
@BOUNDED
@given(scene=scenes(), powers=st.tuples(*[st.integers(-8, 8)] * 3))
def test_units_do_not_matter(opened, method, scene, powers):
    """Powers of two rescale without rounding; the solver's absolute tolerance is scaled as a length."""
    units = [2.0**power for power in powers]
    rescaled = {
        name: (np.array(value) * unit_factor(name, *units)).tolist()
        if isinstance(value, float | list)
        else value
        for name, value in {**scene.configuration, "solver.absolute_tolerance": 1e-14}.items()
    }
    ends = outcome(opened, scene, method)
    again = outcome(opened, scene._replace(configuration=rescaled, end=scene.end * units[1]), method)
    check_same({name: value / unit_factor(name, *units) for name, value in again.items()}, ends)


@pytest.mark.parametrize("method", METHODS)
@BOUNDED
@given(scene=scenes(shapes=["cylinder"]), factor=st.sampled_from([-1.0, 1e-3, -1e140, 1e-140]))
def test_length_and_sign_of_the_axis_do_not_matter(opened, method, scene, factor):
    axis = np.array(scene.configuration["destination.axis"]) * factor
    again = {**scene.configuration, "destination.axis": axis.tolist()}
    check_same(outcome(opened, scene._replace(configuration=again), method), outcome(opened, scene, method))
