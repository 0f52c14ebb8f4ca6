"""Two given motions passing by: random scenes, and what the FMU says of them. The truth is in passing.py."""

import numpy as np

from support.checks import start

# The families of scenes, and the FMU of each.
FAMILIES = {
    "sphere outside": "SphereSphere",
    "sphere inside": "SphereSphere",
    "cylinder outside": "SphereCylinder",
    "cylinder inside": "SphereCylinder",
    "finite outside": "SphereCylinder",
    "finite inside": "SphereCylinder",
}
DASHPOTS = ["non_adhesive", "unclamped", "approach_only", "none"]
STEPS = [1, 4, 20, 200, 2000]  # communication steps in 2 s
END = 2.0


def unit_vector(random):
    direction = random.normal(size=3)
    return direction / np.linalg.norm(direction)


def scene(seed):
    """FMU, configuration, communication steps. A number of a few digits now and then, as people write."""
    random = np.random.default_rng([11, 4, seed])
    family = list(FAMILIES)[seed % len(FAMILIES)]
    dashpot = DASHPOTS[seed // len(FAMILIES) % len(DASHPOTS)]
    viscous_only = dashpot != "none" and random.random() < 0.2
    inside = family.endswith("inside")
    cylinder = not family.startswith("sphere")
    digits = 2 if random.random() < 0.3 else 17
    r_d = random.uniform(0.3, 0.6)
    r_s = r_d * random.uniform(0.1, 0.5)
    reach = r_d - r_s if inside else r_d + r_s
    stiffness = 10 ** random.uniform(3, 7)
    values = {
        "source.motion": "prescribed",
        "source.radius": round(r_s, digits),
        "destination.radius": round(r_d, digits),
        "contact.location": "inside" if inside else "outside",
        "contact.method": "penalty" if dashpot == "none" else "penalty_dynamic",
        "contact.penalty_control": "viscous_only" if viscous_only else "user_defined",
        "contact.penalty_factor": float(f"{stiffness:.3g}"),
        "contact.viscous_penalty_factor": float(f"{stiffness * 10 ** random.uniform(-4, -0.5):.3g}"),
        "gravity": [0.0, 0.0, 0.0],
    }
    if dashpot != "none":
        values["contact.dashpot"] = dashpot
    axis = unit_vector(random) if random.random() < 0.5 else np.eye(3)[random.integers(3)]
    if cylinder:
        values["destination.axis"] = axis.tolist()
    if family.startswith("finite"):
        values["destination.finite_length"] = True
        values["destination.length"] = round(random.uniform(0.2, 1.0), digits)
    # The closest approach of the straight path is at `b`, some time within the run.
    speed = 10 ** random.uniform(-0.5, 0.7)
    along = unit_vector(random)
    away = unit_vector(random)
    away -= (away @ along) * along
    away /= np.linalg.norm(away)
    nearest = reach * (random.uniform(0.02, 1.3) if not inside else random.uniform(0.0, 0.95))
    middle = random.uniform(0.3, 1.2)
    at = nearest * away - middle * speed * along
    velocity = speed * along
    bend = np.zeros(3)
    if random.random() < 0.5:
        bend = random.normal(size=3) * speed
    both = random.random() < 0.5
    rounded = lambda a: [round(float(x), digits) for x in a]  # noqa: E731
    values["source.center"] = rounded(at)
    carried = random.normal(size=3) * 0.5 * speed if both else np.zeros(3)
    for body, v, a in (("source", velocity + carried, bend), ("destination", carried, np.zeros(3))):
        if body == "destination" and not both:
            continue
        v, a = rounded(v), rounded(a)
        values[f"{body}.motion"] = "prescribed"
        values[f"{body}.prescribed_velocity"] = v
        if both or bend.any():
            values[f"{body}.prescribed_displacement.derivatives"] = [v, a]
            values[f"{body}.prescribed_velocity.derivatives"] = [a]
    steps = int(random.choice(STEPS, p=[0.35, 0.25, 0.25, 0.12, 0.03]))
    return FAMILIES[family], values, steps


def measured(fmu, values, steps, end, method, tolerance):
    """What the FMU says of the scene."""
    start(fmu, {**values, "solver.max_internal_steps": 20_000}, tolerance, method)
    impulse, force, penetration = np.zeros(3), 0.0, 0.0
    for k in range(steps):
        before = fmu.time
        fmu.step(end * (k + 1) / steps - before)
        impulse += fmu["contact.mean_force"] * (fmu.time - before)
        force = max(force, fmu["contact.peak_force"])
        penetration = max(penetration, fmu["contact.peak_penetration"])
    return {
        "events": fmu["solver.events"],
        "onsets": fmu["contact.onsets"],
        "onset": fmu["contact.last_onset_time"],
        "duration": fmu["contact.last_duration"],
        "dissipated": fmu["energy.dissipated"],
        "work": fmu["energy.external_work"],
        "total": fmu["energy.total"],
        "impulse": impulse,
        "peak_force": force,
        "peak_penetration": penetration,
    }
