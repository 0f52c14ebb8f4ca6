#!/usr/bin/env python3
"""Two rigid bodies that turn and rub: scipy moves them, TurningForceElement gives forces and torques.

python examples/turning_integrator.py [FMU]      default build/fmus/TurningForceElement.fmu

A spinning ball hits a cylinder that floats freely, near its end: the cylinder is pushed away and tips. The
state of a body is position, velocity, orientation (quaternion w, x, y, z) and angular velocity, all in the
world frame. Momentum and angular momentum are kept to rounding, whatever the friction.
"""

import sys

import fmpy
import numpy as np
from fmpy import fmi2
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

BALL = {"radius": 0.1, "mass": 1.0, "center": [0.65, 0.0, 0.3]}  # m, kg
CYLINDER = {"radius": 0.5, "mass": 20.0, "length": 1.0, "center": [0.0, 0.0, 0.0]}
VELOCITY = [-2.0, 0.5, 0.0]  # m/s of the ball
SPIN = [0.0, 20.0, 10.0]  # rad/s of the ball
LAW = {
    "contact.penalty_factor": 1e5,
    "contact.viscous_penalty_factor": 50.0,
    "contact.friction_coefficient": 0.3,
    "contact.slip_velocity_control": 2,
    "contact.characteristic_slip_velocity": 1e-2,
}
INPUTS = ("displacement", "velocity", "angular_velocity")
LOADS = [f"{body}_{load}" for body in ("source", "destination") for load in ("force", "torque")]


def inertia(body: dict) -> np.ndarray:
    """Of a homogeneous ball or cylinder in its own frame, whose z is the axis: kg m2"""
    m, r = body["mass"], body["radius"]
    if "length" not in body:
        return np.full(3, 0.4 * m * r**2)
    across = m * (3 * r**2 + body["length"] ** 2) / 12
    return np.array([across, across, 0.5 * m * r**2])


class ContactLoads:
    """The FMU as a function of the motion of both bodies"""

    def __init__(self, fmu: str):
        folder, description = fmpy.extract(fmu), fmpy.read_model_description(fmu)
        self.variables = {variable.name: variable for variable in description.modelVariables}
        self.slave = fmi2.FMU2Slave(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="loads",
        )
        names = [f"{body}.prescribed_{name}" for body in ("source", "destination") for name in INPUTS]
        self.inputs = self.references([*names, "destination.prescribed_axis"])
        self.outputs = self.references([f"contact.{load}" for load in LOADS])
        self.slave.instantiate()
        self.slave.setupExperiment()
        for body, values in (("source", BALL), ("destination", CYLINDER)):
            self.slave.setReal(self.references([f"{body}.center"]), values["center"])
            self.slave.setReal([self.variables[f"{body}.radius"].valueReference], [values["radius"]])
        for name, value in LAW.items():
            variable = self.variables[name]
            write = self.slave.setReal if variable.type == "Real" else self.slave.setInteger
            write([variable.valueReference], [value])
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def references(self, vectors: list[str]) -> list[int]:
        return [self.variables[f"{name}[{k}]"].valueReference for name in vectors for k in (1, 2, 3)]

    def at(self, ball: tuple, cylinder: tuple, axis: np.ndarray) -> np.ndarray:
        """Rows: force and torque on the ball, on the cylinder; of a body displacement, velocity, spin"""
        self.slave.setReal(self.inputs, np.concatenate([*ball, *cylinder, axis]).tolist())
        return np.reshape(self.slave.getReal(self.outputs), (4, 3))

    def close(self) -> None:
        self.slave.terminate()
        self.slave.freeInstance()


def parts(state: np.ndarray) -> tuple:
    """Position, velocity, orientation and angular velocity of one body"""
    return state[0:3], state[3:6], Rotation.from_quat(state[[7, 8, 9, 6]]), state[10:13]


def spin_rate(body: dict, turned: Rotation, spin: np.ndarray, torque: np.ndarray) -> np.ndarray:
    """Euler's equations in the body's frame, rad/s2 in the world's"""
    own, moments = turned.inv().apply(spin), inertia(body)
    return turned.apply((turned.inv().apply(torque) - np.cross(own, moments * own)) / moments)


def rates(state: np.ndarray, contact: ContactLoads) -> np.ndarray:
    bodies = [parts(state[:13]), parts(state[13:])]
    given = [
        (x - np.array(body["center"]), v, spin)
        for body, (x, v, _, spin) in zip((BALL, CYLINDER), bodies, strict=True)
    ]
    loads = contact.at(*given, bodies[1][2].apply([0.0, 0.0, 1.0]))
    found = []
    for n, (body, (_, v, turned, spin)) in enumerate(zip((BALL, CYLINDER), bodies, strict=True)):
        force, torque = loads[2 * n : 2 * n + 2]
        w, q = state[13 * n + 6], state[13 * n + 7 : 13 * n + 10]
        orientation = 0.5 * np.concatenate([[-spin @ q], w * spin + np.cross(spin, q)])
        found += [v, force / body["mass"], orientation, spin_rate(body, turned, spin, torque)]
    return np.concatenate(found)


def begin() -> np.ndarray:
    still, upright = [0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]
    return np.array(
        [*BALL["center"], *VELOCITY, *upright, *SPIN, *CYLINDER["center"], *still, *upright, *still]
    )


def momenta(state: np.ndarray) -> np.ndarray:
    """Momentum, and angular momentum about the world's origin"""
    linear, angular = np.zeros(3), np.zeros(3)
    for body, (x, v, turned, spin) in zip(
        (BALL, CYLINDER), (parts(state[:13]), parts(state[13:])), strict=True
    ):
        linear += body["mass"] * v
        angular += np.cross(x, body["mass"] * v) + turned.apply(inertia(body) * turned.inv().apply(spin))
    return np.concatenate([linear, angular])


def move(contact: ContactLoads, end: float = 0.1, tolerance: float = 1e-10) -> np.ndarray:
    """The state at `end` s"""
    return solve_ivp(
        lambda _, state: rates(state, contact), (0.0, end), begin(), "DOP853",
        rtol=tolerance, atol=1e-3 * tolerance, max_step=1e-3,
    ).y[:, -1]  # fmt: skip


def main(fmu: str) -> None:
    contact = ContactLoads(fmu)
    state = move(contact)
    contact.close()
    _, v, _, spin = parts(state[:13])
    print(f"the ball leaves with {v} m/s and {spin} rad/s")
    print(f"the cylinder turns with {state[23:26]} rad/s")
    print(f"momenta stray by {np.max(np.abs(momenta(state) - momenta(begin()))):.1e}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "build/fmus/TurningForceElement.fmu")
