"""Adjoint derivatives against directional ones: u (J v) = (u J) v, and both against J column by column."""

import numpy as np
import pytest

from support.fmi3 import raw
from support.fmi3.raw import DISCARD, ERROR, Instance, reals, references

SCENES = ["SphereSphere", "SphereCylinder", "ForceElement"]


@pytest.fixture(params=SCENES)
def instance(request):
    """Both bodies prescribed and overlapping, so that every input is felt"""
    fmu = raw.load(request.param)
    with Instance(fmu) as made:
        values = {"source.motion": "prescribed", "destination.motion": "prescribed"}
        values |= {"source.center": [0.0, 0.0, 1.1], "destination.axis": [0.0, 0.0, 1.0]}
        made.initialize({name: value for name, value in values.items() if name in fmu.variables})
        made.set({"source.prescribed_displacement": [0.55, 0.05, -1.0]})
        made.set({"source.prescribed_velocity": [0.3, -0.2, -0.4]})
        assert made.step(0.0, 0.001).status == raw.OK
        assert abs(max(made.get("contact.source_force"), key=abs)) > 1.0
        yield made


def jacobian(instance, unknowns, knowns):
    columns = np.eye(sum(one.length for one in knowns))
    return np.array([instance.product("Directional", unknowns, knowns, column) for column in columns]).T


def test_both_are_products_with_one_matrix_of_any_number_of_unknowns_and_knowns(instance):
    """More than one chunk of both, each several times over"""
    unknowns = instance.fmu.select("output", kind="Float64") * 5
    knowns = instance.fmu.select("input") * 9
    matrix = jacobian(instance, unknowns, knowns)
    random = np.random.default_rng(4)
    left, right = (random.normal(size=count) for count in matrix.shape)
    assert matrix.shape[0] > 64 and matrix.shape[1] > 64 and np.count_nonzero(matrix) > 450
    names = [one.name for one in unknowns for _ in range(one.length)]
    forces = np.array([name.endswith("_force") for name in names])
    torques = np.array([name.endswith("_torque") for name in names])
    for given, terms, of_torque in (
        (instance.product("Directional", unknowns, knowns, right), matrix * right, torques),
        (instance.product("Adjoint", unknowns, knowns, left), matrix.T * left, False),
    ):
        sizes = np.sum(np.abs(terms), axis=1)
        if np.any(of_torque):  # of a force along its arm of half a metre: a rounding of the product
            sizes = np.where(of_torque, np.max(sizes[forces]), sizes)
        assert np.all(np.abs(given - np.sum(terms, axis=1)) <= 1e-13 * sizes + 1e-300)


def test_without_knowns_or_unknowns(instance):
    force = [instance.fmu.variables["contact.source_force"]]
    assert instance.product("Directional", force, [], []).tolist() == [0.0, 0.0, 0.0]
    assert not instance.product("Adjoint", [], instance.fmu.select("input"), []).any()


@pytest.mark.parametrize("kind", ["Directional", "Adjoint"])
def test_wrong_arguments_are_refused_in_words(instance, kind):
    force = [instance.fmu.variables["contact.source_force"]]
    known = instance.fmu.select("input")[:1]

    def call(unknowns, knowns, seeds, count=3):
        return instance.call(
            f"Get{kind}Derivative",
            *(references(unknowns), len(unknowns), references(knowns), len(knowns)),
            *(reals(seeds), len(seeds), reals([0.0] * count), count),
        )

    refused = instance.expect(ERROR, f"fmi3Get{kind}Derivative", "nSeed = 2", "expected 3")
    refused(call(force, known, [1.0, 2.0]))
    instance.expect(ERROR, "nSensitivity = 4", "expected 3")(call(force, known, [1.0, 2.0, 3.0], 4))
    instance.expect(ERROR, "no Float64 output")(call(known, known, [1.0, 2.0, 3.0]))
    instance.expect(ERROR, "no Float64 input")(call(force, force, [1.0, 2.0, 3.0]))
    instance.expect(DISCARD, "seed of", "nan")(call(force, known, [1.0, float("nan"), 3.0]))
