"""Derivatives of inputs move the model inside a communication step; those of outputs belong to the motion.

With gravity off and no contact a free body under a polynomial force has a polynomial motion, so that one
communication step has a closed form: F(t) = F0 + F1 t + F2 t^2/2 gives v = (F0 t + F1 t^2/2 + F2 t^3/6)/m and
u = (F0 t^2/2 + F1 t^3/6 + F2 t^4/24)/m.
"""

import pytest

from support.fmi2 import raw

FREE = {"gravity": [0.0, 0.0, 0.0], "source.center": [0.0, 0.0, 50.0], "source.mass": 2.0}
# Both solvers run at this tolerance; a hundred times of it is allowed on numbers of the order of one.
TOLERANCE = 1e-10
METHODS = ["event_driven", "cvode_bdf", "cvode_adams"]


def close(found: list[float], expected: list[float], scale: float = 1.0) -> None:
    assert found == pytest.approx(expected, rel=100 * TOLERANCE, abs=100 * TOLERANCE * scale)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("orders", [(0,), (0, 1), (0, 2), (0, 1, 2)])
def test_a_polynomial_force_is_followed_inside_one_step(method, orders):
    force = [[0.4, 0.0, -0.3], [1.5, -2.0, 0.7], [-3.0, 1.0, 2.5]]
    force = [row if order in orders else [0.0] * 3 for order, row in enumerate(force)]
    t, mass = 0.8, FREE["source.mass"]
    with raw.Instance(raw.load("SphereSphere")) as instance:
        instance.initialize(
            {**FREE, "solver.method": method, "source.external_force": force[0]}, tolerance=TOLERANCE
        )
        for order in orders[1:]:
            instance.feed("source.external_force", order, force[order])
        instance.ok("DoStep", 0.0, t, 1)
        close(
            instance.get("source.velocity"),
            [(a * t + b * t**2 / 2 + c * t**3 / 6) / mass for a, b, c in zip(*force, strict=True)],
        )
        close(
            instance.get("source.displacement"),
            [(a * t**2 / 2 + b * t**3 / 6 + c * t**4 / 24) / mass for a, b, c in zip(*force, strict=True)],
        )


def test_value_and_derivative_may_come_in_either_order():
    ends = []
    for first in ("value", "derivative"):
        with raw.Instance(raw.load("SphereSphere")) as instance:
            instance.initialize(FREE, tolerance=TOLERANCE)
            for what in (first, "derivative" if first == "value" else "value"):
                if what == "value":
                    instance.set({"source.external_force": [1.0, 0.0, 0.0]})
                else:
                    instance.feed("source.external_force", 1, [4.0, 0.0, 0.0])
            instance.ok("DoStep", 0.0, 0.5, 1)
            ends.append(instance.bits("output"))
    assert ends[0] == ends[1]


@pytest.mark.parametrize("scene", ["SphereSphere", "SphereCylinder"])
@pytest.mark.parametrize("orders", [(), (1,), (2,), (1, 2)])
def test_a_prescribed_body_goes_on_by_its_derivatives_or_its_velocity(scene, orders):
    start, given = [0.1, -0.2, 0.3], {1: [1.0, 2.0, -0.5], 2: [-4.0, 0.0, 6.0]}
    velocity, t = [0.25, 0.0, -1.0], 0.75
    with raw.Instance(raw.load(scene)) as instance:
        instance.initialize(
            {
                "source.center": [0.0, 0.0, 80.0],
                "destination.motion": "prescribed",
                "destination.prescribed_displacement": start,
                "destination.prescribed_velocity": velocity,
            }
        )
        for order in orders:
            instance.feed("destination.prescribed_displacement", order, given[order])
        instance.ok("DoStep", 0.0, t, 1)
        zero = [0.0, 0.0, 0.0]
        rate = given[1] if 1 in orders else zero
        curvature = given[2] if 2 in orders else zero
        if not orders:
            rate = velocity
        close(
            instance.get("destination.displacement"),
            [u + v * t + a * t**2 / 2 for u, v, a in zip(start, rate, curvature, strict=True)],
        )
