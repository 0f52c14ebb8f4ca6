"""Runs that differ in everything a saved state has to hold, for the tests of states, threads and memory.

As a program: restores the saved states that it is given in a new process, goes on, and tells the digests."""

import hashlib
import math
import pickle
import sys
from collections.abc import Callable
from typing import Any, NamedTuple

from support.fmi2 import raw

# Communication steps of changing size; a thousandth of a second is far less than a contact lasts here.
SIZES = (0.01, 0.003, 0.017, 0.0001)
BODIES = ("source", "destination")
SOFT = {"contact.penalty_factor": 2e3, "contact.viscous_penalty_factor": 5.0}
OVER_CYLINDER = {"destination.axis": [0.0, 1.0, 0.0], "source.center": [0.05, 0.0, 0.7]}
TOWARDS_THE_END = {**OVER_CYLINDER, **SOFT, "destination.finite_length": 1, "source.center": [0.0, 0.3, 0.6]}
TOWARDS_THE_END |= {"source.initial_velocity": [0.0, 1.0, 0.0]}


class Run(NamedTuple):
    """An FMU, its parameters, its inputs as a function of time, and the step at which the state is saved"""

    scene: str
    values: dict[str, Any]
    saved_at: int  # steps
    touching: bool  # whether the bodies touch there
    inputs: Callable[[float], dict[str, Any]] = lambda time: {}
    derivatives: Callable[[float], dict[str, Any]] = lambda time: {}
    steps: int = 90
    tolerance: float | None = None


def _shaken(time: float) -> dict[str, Any]:
    return {
        "destination.prescribed_displacement": [0.0, 0.0, 0.2 * math.sin(9 * time)],
        "destination.prescribed_velocity": [0.0, 0.0, 1.8 * math.cos(9 * time)],
    }


def _pushed(time: float) -> dict[str, Any]:
    return {"source.external_force": [math.sin(20 * time), 0.0, 3 * math.cos(7 * time)]}


def _fed(time: float) -> dict[str, Any]:
    return {
        "source.prescribed_displacement": [0.55, 0.3 * math.sin(5 * time), -0.1 * time],
        "source.prescribed_velocity": [0.0, 1.5 * math.cos(5 * time), -0.1],
    }


def _fed_and_turned(time: float) -> dict[str, Any]:
    return _fed(time) | {
        "source.prescribed_angular_velocity": [0.4, math.sin(3 * time), 2.0],
        "destination.prescribed_angular_velocity": [0.2 * time, -0.3, 0.1],
    }


RUBBING = {"contact.friction": "elastic", "contact.tangential_stiffness": 600.0}
RUBBING |= {"contact.tangential_damping": 3.0}
FOLLOWING = {**RUBBING, "contact.law": "hertz", "contact.hertz_stiffness": 2e4}
FOLLOWING |= {"contact.tangential_law": "mindlin", "contact.tangential_ratio": 0.6}
FOLLOWING |= {"contact.tangential_damping": 30.0}  # relaxes slowly enough for difference quotients
ROLLING = {"contact.friction": "regularized", "contact.slip_velocity_control": "user_defined"}
ROLLING |= {"contact.characteristic_slip_velocity": 1e-2}
SPINNING = {"source.rotation": "free"}


def _of_both(values):
    """The same values for rolling and spinning, whose names stand for {}"""
    kinds = ("rolling", "spinning")
    return {f"contact.{name.format(kind)}": one for kind in kinds for name, one in values.items()}


RESISTING = _of_both({"{}": "regularized", "{}_coefficient": 0.2, "characteristic_{}_rate": 2.0})
YIELDING = _of_both({"{}": "elastic", "{}_coefficient": 0.2, "{}_stiffness": 20.0, "{}_damping": 0.3})
ALL_GIVEN = {f"{body}.{kind}": "prescribed" for body in BODIES for kind in ("motion", "rotation")}
TILTED = [0.1, 0.2, 1.0]
WEIGHTLESS = {"destination.motion": "free", "gravity": [0, 0, 0]}
SHAKEN = {**SOFT, "destination.motion": "prescribed"}


def _at(*center: float, **law: Any) -> dict[str, Any]:
    """Returns the source's centre, and choices of the contact."""
    return {"source.center": list(center)} | {f"contact.{name}": value for name, value in law.items()}


FALLING = {**SOFT, **_at(0.05, 0.0, 1.1)}
ADAMS, EVENT_DRIVEN = ({"solver.method": method} for method in ("cvode_adams", "event_driven"))
AUTOMATIC = _at(0, 0, 0.65, penalty_control="automatic", viscous_control="automatic", reference_modulus=2e3)
VISCOUS = _at(0.0, 0.0, 0.65, penalty_control="viscous_only", viscous_penalty_factor=300.0)
CROSSED = {**SOFT, **_at(0.05, 0.02, 0.62, axes="skew"), "source.length": 0.8, "destination.length": 0.9}
CROSSED |= {f"{body}.finite_length": 1 for body in BODIES} | {f"{body}.rotation": "free" for body in BODIES}
CROSSED |= {"source.axis": [1.0, 0.3, 0.1], "destination.axis": [0.0, 1.0, 0.0]}
CROSSED |= {"source.initial_angular_velocity": [10.0, 3.0, 1.0]}
HIT = {"source.center": [-0.62, 0.2, 0.03], "source.initial_velocity": [2.0, 0.1, 0.2]}
HIT |= {"destination.axis": [0.0, 1.0, 0.0], "destination.rotation": "free", "destination.finite_length": 1}


def _stepped(time: float) -> dict[str, Any]:
    """A foot rolls over its balls, with its angular velocity along x."""
    values = {"foot.prescribed_displacement": [0.1 * time, 0.0, 0.001 * math.sin(9 * time)]}
    values |= {"foot.prescribed_velocity": [0.1, 0.0, 0.009 * math.cos(9 * time)]}
    values |= {"foot.prescribed_orientation": [1.5, 0.03 * math.sin(4 * time), 0.0, 0.0]}
    values |= {"foot.prescribed_angular_velocity": [0.08 * math.cos(4 * time), 0.0, 0.0]}
    return values


FOOT = {f"{part}.friction": "regularized" for part in ("left_heel", "left_ball", "right_ball")}
TRIPOD = {"tripod.initial_angular_velocity": [0.3, -0.2, 2.0]}
for _foot in ("front", "left", "right"):
    TRIPOD |= {
        name.replace("contact", _foot): value
        for name, value in (SOFT | ROLLING).items()
        if "friction" not in name
    }
    TRIPOD[f"{_foot}.characteristic_slip_velocity"] = 0.1
PINNED = {"lower.friction": "elastic", "lower.tangential_stiffness": 200.0, "lower.tangential_damping": 0.1}
PINNED |= {f"{end}.penalty_factor": 500.0 for end in ("lower", "upper")} | {"hole.radius": 0.03}
PINNED |= {f"{end}.viscous_penalty_factor": 1.0 for end in ("lower", "upper")}
PINNED |= {"pin.principal_inertia": [9e-4, 9e-4, 9e-5], "pin.initial_velocity": [0.5, 0.05, 0.0]}
PINNED |= {"pin.initial_displacement": [0.02, 0.0, 0.0]}

_OF_SPHERES = {
    "sphere in flight": ({}, 20, False),
    "sphere in contact": (FALLING, 46, True),
    "adams in contact": ({**FALLING, **ADAMS}, 46, True),
    "event driven in contact": ({**FALLING, **EVENT_DRIVEN}, 46, True),
    "adams in flight": (ADAMS, 30, False),
    "two free bodies": ({**SOFT, **WEIGHTLESS, "source.initial_velocity": [0.1, 0.0, -2.0]}, 36, True),
    "on a shaken sphere": ({**SHAKEN, **_at(0.02, 0.0, 0.65)}, 8, True, _shaken),
    "pushed about": ({**SOFT, **_at(0.0, 0.0, 0.65)}, 20, True, _pushed),
    "unclamped dashpot": ({**SOFT, **_at(0.1, 0, 0.65, dashpot="unclamped")}, 22, True),
    "approach only": ({**SOFT, **_at(0.1, 0, 0.65, dashpot="approach_only")}, 22, True),
    "viscous only": (VISCOUS, 40, True),
    "automatic factors": (AUTOMATIC, 17, True),
    "penalty": ({**SOFT, **_at(0.0, 0.0, 0.65, method="penalty")}, 22, True),
    "both prescribed, turning and rubbing": ({**ALL_GIVEN, **RUBBING, **RESISTING, **_at(0, 0, 0)}, 15, True,
        _fed_and_turned),
    "both prescribed, the tangential stiffness follows": ({**ALL_GIVEN, **FOLLOWING, **_at(0, 0, 0)}, 15,
        True, _fed_and_turned),
    "spinning off a sphere, the tangential stiffness follows": ({**FOLLOWING, **SPINNING,
        **_at(0.05, 0.0, 0.62), "source.initial_angular_velocity": [3.0, -8.0, 1.0]}, 12, True),
    "both prescribed, turning and yielding": ({**ALL_GIVEN, **RUBBING, **YIELDING, **_at(0, 0, 0)}, 15, True,
        _fed_and_turned),
    "spinning on springs": ({**SOFT, **RUBBING, **SPINNING, **YIELDING, **_at(0.05, 0.0, 0.62),
        "source.initial_angular_velocity": [3.0, -8.0, 2.0]}, 12, True),
    "spinning off a sphere": ({**SOFT, **RUBBING, **SPINNING, **_at(0.05, 0.0, 0.62),
        "source.initial_angular_velocity": [3.0, -8.0, 1.0]}, 12, True),
    "force with a rate": ({**SOFT, **_at(0.0, 0.0, 0.65)}, 20, True, _pushed,
        lambda time: {"source.external_force": [20 * math.cos(20 * time), 0.0, 1.0]}),
}  # fmt: skip


def _run(scene: str, saved_at: int, touching: bool, *parts: dict[str, Any], **more: Any) -> Run:
    """Of parameters that stand in several dictionaries"""
    values: dict[str, Any] = {}
    for part in parts:
        values |= part
    return Run(scene, values, saved_at, touching, **more)


def _torqued(time: float) -> dict[str, Any]:
    return {"destination.external_torque": [0.3, 3.0 - time, 0.2]}


def _fed_beside_a_tilted_axis(time: float) -> dict[str, Any]:
    still = {"destination.prescribed_angular_velocity": [0, 0, 0], "destination.prescribed_axis": TILTED}
    return _fed_and_turned(time) | still


_GIVEN = {"source.motion": "prescribed", "destination.motion": "prescribed"}
_UNTURNED = {f"{body}.rotation": "none" for body in BODIES}
_ROLLS = {name: value for name, value in RESISTING.items() if "spinning" not in name}
_ROLLER = {"source.initial_velocity": [0.1, 0.3, 0.0], "source.initial_angular_velocity": [0.0, 7.0, 0.0]}
_RACE = {"destination.side": "outer_race", "destination.rotation": "free", "destination.radius": 0.3}
_RACE |= {
    "source.initial_velocity": [1.0, 0.6, 0.4],
    "destination.initial_angular_velocity": [0.5, -0.3, 0.8],
}
RUNS = {name: Run("SphereSphere", *run) for name, run in _OF_SPHERES.items()} | {
    "both prescribed": _run("SphereCylinder", 15, True, _GIVEN, _at(0, 0, 0), inputs=_fed),
    "on a cylinder": _run("SphereCylinder", 25, True, SOFT, OVER_CYLINDER),
    "in a cylinder": _run("SphereCylinder", 40, True, SOFT, OVER_CYLINDER, _at(0.3, 0, 0)),
    "cylinder in flight": _run("SphereCylinder", 20, False, OVER_CYLINDER, _at(0.05, 0.0, 1.2)),
    "off a cylinder's end": Run("SphereCylinder", TOWARDS_THE_END, 30, False),
    "up to a cylinder's end": Run("SphereCylinder", TOWARDS_THE_END, 20, True),
    "a cylinder hit off its middle": _run("SphereCylinder", 6, True, SOFT, ROLLING, SPINNING, WEIGHTLESS,
        HIT),
    "a cylinder hit that resists rolling": _run("SphereCylinder", 6, True, SOFT, RESISTING, SPINNING,
        WEIGHTLESS, HIT, {"contact.dashpot": "unclamped"}),
    "on an inclined plane": _run("SpherePlane", 20, True, SOFT, {"destination.axis": [0.3, -0.1, 1.0]},
        _at(0.05, 0.0, 0.15)),
    "on a shaken plane": _run("SpherePlane", 8, True, SHAKEN, _at(0.02, 0.0, 0.15), inputs=_shaken),
    "sliding on a plane, the tangential stiffness follows": _run(*("SpherePlane", 9, True, FOLLOWING,
        SPINNING, _at(0.0, 0.0, 0.095, tangential_damping=0.0)),
        {"source.initial_velocity": [1.0, 0.2, 0.0]}),
    "rolling on a plane": _run(*("SpherePlane", 20, True, SOFT, ROLLING, SPINNING, _at(0.0, 0.0, 0.0955)),
        {"source.initial_velocity": [1.0, 0.0, 0.0]}),
    "a roller on another": _run(*("CylinderCylinder", 12, True, SOFT, RUBBING, _ROLLS, SPINNING,
        _at(0.05, 0.02, 0.62), _ROLLER), *({"destination.rotation": "free"}, ), inputs=_torqued),
    "across another roller": _run(*("CylinderCylinder", 12, True, CROSSED, RUBBING,
        {"source.initial_velocity": [0.1, 0.3, -0.2]}), inputs=_torqued),
    "across the end of another roller": _run(*("CylinderCylinder", 9, True, CROSSED, ROLLING,
        _at(0.05, 0.47, 0.6)), {"source.initial_velocity": [0.1, 0.8, -0.4]}),
    "end to end with another roller": _run(*("CylinderCylinder", 4, True, CROSSED, RUBBING,
        _at(0.47, 0.6, 0.6)), {"source.initial_velocity": [0.5, 0.2, -0.4]}),
    "moved across another roller": _run("CylinderCylinder", 15, True, CROSSED, ALL_GIVEN, RUBBING,
        _at(0, 0, 0), _UNTURNED, inputs=_fed),
    "both turning and rubbing on a torus": _run(*("SphereTorus", 15, True, ALL_GIVEN, RUBBING, _at(0, 0, 0),
        {"destination.axis": TILTED}), inputs=_fed_beside_a_tilted_axis),
    "rolling on a torus": _run(*("SphereTorus", 12, True, SOFT, ROLLING, RESISTING, SPINNING,
        _at(1.05, 0.1, 0.62)), {"destination.radius": 0.5, "contact.characteristic_slip_velocity": 0.1}),
    "a ball in a tumbling race": _run(*("SphereTorus", 9, True, SOFT, RUBBING, SPINNING, YIELDING,
        WEIGHTLESS), *(_at(1.1, 0.2, 0.1, location="inside"), _RACE)),
    "a foot that is moved": Run("FootForceElement", FOOT, 15, True, _stepped),
    "a tripod that slides": Run("Tripod", TRIPOD, 12, True,
        lambda time: {"tripod.external_torque": [0.3, 3.0 - time, 0.2]}),
    "a pin in a hole": Run("PinInHole", PINNED, 19, True),
    "bouncing ball": Run("BouncingBall", _at(0.0, 0.0, 0.11), 30, False),
    "ball on sphere": _run("BallOnSphere", 24, True, _at(0.03, 0.04, 0.7), SOFT),
    "ball in shell": Run("BallInShell", SOFT, 45, True),
    "ball on roller": Run("BallOffRoller", SOFT, 20, True),
    "ball off roller": Run("BallOffRoller", SOFT, 85, False),
    "force element": Run("ForceElement", _at(0, 0, 0), 15, True, _fed),
    "force element extrapolating": Run(*("ForceElement", _at(0, 0, 0), 15, True, _fed),
        lambda time: {"source.prescribed_displacement": [0.0, 1.5 * math.cos(5 * time), -0.1]}),
}  # fmt: skip
RUNS["adams in contact"] = RUNS["adams in contact"]._replace(tolerance=1e-10)


def touches(instance: raw.Instance) -> bool:
    """Returns whether any contact touches."""
    return any(instance.get(name) for name in instance.fmu.variables if name.endswith(".active"))


def time_after(count: int) -> float:
    """Returns the communication point after so many steps, added up as an importer does."""
    time = 0.0
    for index in range(count):
        time += SIZES[index % len(SIZES)]
    return time


def begin(run: Run, fmu: raw.Fmu | None = None, **options: Any) -> raw.Instance:
    instance = raw.Instance(fmu or raw.load(run.scene), **options)
    return instance.initialize({**run.values, **run.inputs(0.0)}, tolerance=run.tolerance)


def step(instance: raw.Instance, run: Run, index: int) -> dict[str, bytes]:
    time = time_after(index)
    instance.set(run.inputs(time))
    for name, value in run.derivatives(time).items():
        instance.feed(name, 1, value)
    instance.ok("DoStep", time, SIZES[index % len(SIZES)], 1)
    return instance.bits("output")


def go_on(instance: raw.Instance, run: Run, first: int, last: int | None = None) -> list[dict[str, bytes]]:
    """Returns the bits of all outputs after each of the steps."""
    return [step(instance, run, index) for index in range(first, run.steps if last is None else last)]


def digest(rows: list[dict[str, bytes]]) -> str:
    return hashlib.sha256(b"".join(value for row in rows for _, value in sorted(row.items()))).hexdigest()


def _main() -> None:
    """{name: state} comes in, {name: digest of what follows} goes out."""
    digests = {}
    for name, blob in pickle.load(sys.stdin.buffer).items():
        with raw.Instance(raw.load(RUNS[name].scene)) as instance:
            instance.restore(blob)
            digests[name] = digest(go_on(instance, RUNS[name], RUNS[name].saved_at))
    pickle.dump(digests, sys.stdout.buffer)


if __name__ == "__main__":
    _main()
