#!/usr/bin/env python3
"""A multibody integrator around ForceElement: scipy moves the ball, the FMU gives the contact force.

python examples/multibody_integrator.py [FMU]      default build/fmus/ForceElement.fmu

A ball of 1 kg hangs on a spring above a lying cylinder and bounces on it. The integrator is implicit (Radau):
it asks the FMU for the force at any displacement and velocity, and for its derivatives, without a step of the
FMU. The energy shows whether the two fit together.
"""

import sys
from dataclasses import dataclass

import fmpy
import numpy as np
from fmpy import fmi2
from scipy.integrate import solve_ivp

MASS, GRAVITY = 1.0, np.array([0.0, 0.0, -9.81])  # kg, m/s2
PENALTY = 1e5  # N/m
START = np.array(
    [0.02, 0.0, 0.8]
)  # m: the cylinder's axis is 0.8 m below, its radius 0.5 m, the ball's 0.1 m


class ContactForce:
    """The FMU as a function of displacement and velocity"""

    def __init__(self, fmu: str, start: np.ndarray = START):
        folder, description = fmpy.extract(fmu), fmpy.read_model_description(fmu)
        references = {variable.name: variable.valueReference for variable in description.modelVariables}
        names = ("prescribed_displacement", "prescribed_velocity")
        self.inputs = [references[f"source.{name}[{k}]"] for name in names for k in (1, 2, 3)]
        self.outputs = [references[f"contact.source_force[{k}]"] for k in (1, 2, 3)]
        self.slave = fmi2.FMU2Slave(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="force",
        )
        self.slave.instantiate()
        self.slave.setupExperiment()
        self.slave.setReal([references[f"source.center[{k}]"] for k in (1, 2, 3)], list(start))
        self.slave.setReal([references[f"destination.axis[{k}]"] for k in (1, 2, 3)], [0.0, 1.0, 0.0])
        self.slave.setReal([references["contact.penalty_factor"]], [PENALTY])
        self.slave.setReal([references["contact.viscous_penalty_factor"]], [0.0])
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def force(self, state: np.ndarray) -> np.ndarray:
        """N on the ball; `state` is displacement and velocity"""
        self.slave.setReal(self.inputs, state.tolist())
        return np.array(self.slave.getReal(self.outputs))

    def jacobian(self, state: np.ndarray) -> np.ndarray:
        """d force / d state: minus the contact's stiffness and damping"""
        self.slave.setReal(self.inputs, state.tolist())
        along = [self.slave.getDirectionalDerivative(self.outputs, self.inputs, list(e)) for e in np.eye(6)]
        return np.array(along).T

    def close(self) -> None:
        self.slave.terminate()
        self.slave.freeInstance()


@dataclass
class Ball:
    """A ball on a spring of `stiffness` N/m, relaxed at the start"""

    contact: ContactForce
    stiffness: float = 20.0

    def rates(self, _time: float, state: np.ndarray) -> np.ndarray:
        spring = -self.stiffness * state[:3]
        return np.concatenate([state[3:], GRAVITY + (spring + self.contact.force(state)) / MASS])

    def jacobian(self, _time: float, state: np.ndarray) -> np.ndarray:
        result = np.zeros((6, 6))
        result[:3, 3:] = np.eye(3)
        result[3:] = self.contact.jacobian(state) / MASS
        result[3:, :3] -= self.stiffness * np.eye(3) / MASS
        return result

    def energy(self, state: np.ndarray) -> float:
        """J: kinetic, of gravity, of the spring, and F^2 / (2 p_n) in the contact"""
        u, v = state[:3], state[3:]
        force = self.contact.force(state)
        stored = force @ force / (2 * PENALTY)
        return MASS * (v @ v / 2 - GRAVITY @ u) + self.stiffness * u @ u / 2 + stored


def move(ball: Ball, end: float):
    """Displacements and velocities up to `end` s, as solve_ivp gives them"""
    return solve_ivp(
        ball.rates, (0.0, end), np.zeros(6), "Radau", jac=ball.jacobian, rtol=1e-8, atol=1e-10, max_step=2e-3
    )


def main(fmu: str) -> None:
    ball = Ball(ContactForce(fmu))
    motion = move(ball, 1.0)
    energies = [ball.energy(state) for state in motion.y.T]
    pressed = [bool(ball.contact.force(state).any()) for state in motion.y.T]
    impacts = np.count_nonzero(np.diff(pressed) & pressed[1:])
    print(f"{impacts} impacts in {motion.t[-1]:g} s, {motion.nfev} forces, {motion.njev} Jacobians")
    print(f"the ball ends at {START + motion.y[:3, -1]} m")
    fastest = MASS * np.max(np.sum(motion.y[3:] ** 2, axis=0)) / 2
    print(f"the energy strays by {np.ptp(energies):.1e} J; the ball has up to {fastest:.2g} J")
    ball.contact.close()


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "build/fmus/ForceElement.fmu")
