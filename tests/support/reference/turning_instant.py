"""The outputs of a contact that turns and rubs at one instant, by turning.py.

All functions are analytic within a regime, so that a complex step gives exact derivatives.
"""

import numpy as np

from support.reference.turning import BODIES
from support.reference.turning_rates import forces
from support.reference.turning_vectors import first_orientation, unit


def outputs(pair, m):
    """Name of an output without `contact.` -> its value in the motion m: {name: vector}, both bodies led"""
    y = []
    for body in BODIES:
        has_axis = body == "destination" and pair.shape != "sphere"
        axis = unit(m["axis"]) if has_axis else (0.0, 0.0, 1.0)
        y += [*(m[f"{body}.center"] + m[f"{body}.displacement"]), *m[f"{body}.velocity"]]
        y += [*first_orientation(axis), *m[f"{body}.omega"]]
    y += [0.0] * 9
    place = pair.geometry(y)
    now = forces(pair, y, place.gap.real < 0.0, sticking=())
    slip, arm, _ = pair.slip(place)
    n, point = np.array(place.n), np.add(place.src.x, arm)
    spin = np.subtract(place.src.omega, place.dst.omega)
    found = {
        "gap": place.gap, "gap_rate": place.rate, "normal_force": now.force,
        "distance": pair.side * (place.gap + pair.r_s) + pair.r_d,
        "direction": -n if pair.shape == "cylinder" and pair.side < 0 else n,
        "source_force": now.on_source, "destination_force": -np.array(now.on_source),
        "friction_force": now.friction, "slip_velocity": slip, "source_point": point,
        "point": point + place.gap * pair.side * n,
        "rolling_torque": now.resistance, "rolling_rate": spin - (spin @ n) * n,
        "spinning_rate": pair.side * (spin @ n),
        "source_torque": now.source_torque, "destination_torque": now.destination_torque,
    }  # fmt: skip
    if pair.shape != "sphere":
        found["current_axis"] = place.dst.axis
    return {name: np.atleast_1d(value) for name, value in found.items()}
