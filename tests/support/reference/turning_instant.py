"""A contact that turns and rubs at one instant, written once more from DESIGN's formulas.

All functions are analytic within a regime, so that a complex step gives exact derivatives: no absolute
values, no conjugates.
"""

import numpy as np


def norm(a):
    return np.sqrt(np.sum(a * a))


def geometry(v, m):
    """Distance, normal, gap, unit axis of a motion m: {name: vector}; v: values of the scene"""
    c = m["destination.center"] + m["destination.displacement"]
    c = c - m["source.center"] - m["source.displacement"]
    axis = None
    if v["shape"] != "sphere":
        axis = m["axis"] / norm(m["axis"])
    if v["shape"] == "plane":
        normal, radius = -axis, 0.0
        distance = np.sum(normal * c)
    else:
        offset = c if axis is None else c - np.sum(c * axis) * axis
        distance, radius = norm(offset), v["r_d"]
        normal = offset / distance
    gap = v["side"] * (distance - (v["side"] * v["r_s"] + radius))
    return c, axis, distance, normal, gap


def normal_force(v, gap, rate):
    force = -v["p_n"] * gap - v["p_nv"] * rate
    return force if gap.real < 0.0 and (v["unclamped"] or force.real > 0.0) else 0.0 * force


def friction(v, force, slip):
    """The regularized law, v["mu"] = 0: none"""
    limit = v["mu"] * force
    if limit.real > v["largest"]:
        limit = v["largest"]
    if not np.real(limit) > 0.0:
        return 0.0 * slip
    speed = norm(slip)
    if speed == 0.0:
        return -limit / v["v_0"] * slip
    return -limit * (1.0 - np.exp(-speed / v["v_0"])) / speed * slip


def outputs(v, m):
    """Name of an output without `contact.` -> its value"""
    c, axis, distance, normal, gap = geometry(v, m)
    w = m["destination.velocity"] - m["source.velocity"]
    omega_s, omega_d = m["source.omega"], m["destination.omega"]
    e = v["side"] * normal
    rate = np.sum(e * (w - np.cross(omega_d, c)))
    arm = v["r_s"] * e
    far = arm - c
    slip = (m["source.velocity"] + np.cross(omega_s, arm)) - (
        m["destination.velocity"] + np.cross(omega_d, far)
    )
    slip = slip - np.sum(slip * normal) * normal
    force = normal_force(v, gap, rate)
    rubbing = friction(v, force, slip)
    source_force = -force * e + rubbing
    centre = m["source.center"] + m["source.displacement"]
    found = {
        "gap": gap, "gap_rate": rate, "distance": distance, "normal_force": force,
        "direction": -normal if v["shape"] == "cylinder" and v["side"] < 0 else normal,
        "source_force": source_force, "destination_force": -source_force, "friction_force": rubbing,
        "slip_velocity": slip, "source_point": centre + arm, "point": centre + arm + gap * e,
        "source_torque": np.cross(arm, source_force), "destination_torque": np.cross(far, -source_force),
    }  # fmt: skip
    if axis is not None:
        found["current_axis"] = axis
    return {name: np.atleast_1d(value) for name, value in found.items()}
