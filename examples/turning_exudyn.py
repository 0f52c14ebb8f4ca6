#!/usr/bin/env python3
"""The ball and the cylinder of turning_integrator.py in Exudyn, TurningForceElement between them.

python examples/turning_exudyn.py [FMU]      needs exudyn (requirements-peers.txt)

Forces and torques come in as loads on the bodies' centres, whose user functions ask the FMU. Exudyn takes
forces, and torques of MarkerBodyRigid, in the world frame: nothing is to be turned.
"""

import sys
from pathlib import Path

import exudyn
import numpy as np
from exudyn.utilities import Force, MarkerBodyRigid, RigidBodyInertia, Torque

sys.path.insert(0, str(Path(__file__).resolve().parent))
from turning_integrator import BALL, CYLINDER, SPIN, VELOCITY, ContactLoads, inertia

OUTPUT = exudyn.OutputVariableType


def add_body(system, body: dict, velocity: list, spin: list) -> int:
    """A rigid body without gravity; its node"""
    solid = RigidBodyInertia(mass=body["mass"], inertiaTensor=np.diag(inertia(body)))
    made = system.CreateRigidBody(
        inertia=solid,
        referencePosition=body["center"],
        initialVelocity=velocity,
        initialAngularVelocity=spin,
        nodeType=exudyn.NodeType.RotationRotationVector,  # four Euler parameters exclude explicit methods
        returnDict=True,
    )
    return made["nodeNumber"], made["bodyNumber"]


def motion_of(system, node: int) -> tuple:
    kinds = (OUTPUT.Displacement, OUTPUT.Velocity, OUTPUT.AngularVelocity)
    return tuple(np.array(system.GetNodeOutput(node, kind)) for kind in kinds)


def move(contact: ContactLoads, end: float = 0.1, steps: int = 4000) -> np.ndarray:
    """Velocity and angular velocity of the ball, then of the cylinder, at `end` s"""
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    ball = add_body(system, BALL, VELOCITY, SPIN)
    cylinder = add_body(system, CYLINDER, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0])

    def load(row):
        def asked(_system, _time, _load):
            turned = np.reshape(system.GetNodeOutput(cylinder[0], OUTPUT.RotationMatrix), (3, 3))
            return contact.at(motion_of(system, ball[0]), motion_of(system, cylinder[0]), turned[:, 2])[row]

        return asked

    for n, (_, number) in enumerate((ball, cylinder)):
        marker = system.AddMarker(MarkerBodyRigid(bodyNumber=number))
        system.AddLoad(Force(markerNumber=marker, loadVector=[0, 0, 0], loadVectorUserFunction=load(2 * n)))
        torque = load(2 * n + 1)
        system.AddLoad(Torque(markerNumber=marker, loadVector=[0, 0, 0], loadVectorUserFunction=torque))
    system.Assemble()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = end
    settings.timeIntegration.verboseMode = 0
    settings.solution.file.write = False
    system.SolveDynamic(settings, solverType=exudyn.DynamicSolverType.RK44)
    return np.concatenate([np.concatenate(motion_of(system, node)[1:]) for node, _ in (ball, cylinder)])


def main(fmu: str) -> None:
    contact = ContactLoads(fmu)
    found = move(contact)
    contact.close()
    print(f"the ball leaves with {found[:3]} m/s and {found[3:6]} rad/s")
    print(f"the cylinder turns with {found[9:]} rad/s")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "build/fmus/TurningForceElement.fmu")
