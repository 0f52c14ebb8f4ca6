"""A master for tube.ssp that uses what the FMUs offer beyond values at fixed steps.

The wiring and the start values are read from the .ssp by fmpy. `Ways` says what is used; run_ssp.py compares:

  derivatives   inputs go on as polynomials: fmi2GetRealOutputDerivatives here, fmi2SetRealInputDerivatives
                there
  variable      a step in which the ball touches or leaves the tube is taken back (fmi2SetFMUstate) and ends
                there
  repeat        a step is taken back and repeated with a second derivative of the carriage's force, so that at
                the end the carriage has been given the force that the ball has there
  slope         that takes the force's feedback on itself from fmi2GetDirectionalDerivative: Newton's method
"""

from typing import NamedTuple

import fmpy
from fmpy import fmi2
from fmpy.ssp.simulation import set_parameters
from fmpy.ssp.ssd import read_ssd, read_ssv

DISPLACEMENT, VELOCITY = "destination.prescribed_displacement[3]", "destination.prescribed_velocity[3]"
FORCE, GIVEN = "contact.destination_force[3]", "source.external_force[3]"
PAST = 1e-9  # s: so far beyond an event steps end, so that there is no doubt on which side they do


class Ways(NamedTuple):
    derivatives: bool = False
    variable: bool = False
    repeat: bool = False
    slope: bool = False


class Result(NamedTuple):
    ball: float  # height at the end [m]
    carriage: float  # displacement at the end [m]
    taken_back: int  # steps
    mismatch: float  # of the force given and the ball's force at the end of a step in contact, at most [N]


class Part:
    """An FMU of the system"""

    def __init__(self, component, folder, parameter_set):
        file = f"{folder}/{component.source}"
        description = fmpy.read_model_description(file)
        self.name, self.parent = component.name, component.parent
        self.variables = {one.name: one for one in description.modelVariables}
        identifier = description.coSimulation.modelIdentifier
        self.fmu = fmi2.FMU2Slave(
            guid=description.guid, unzipDirectory=fmpy.extract(file), modelIdentifier=identifier,
            instanceName=component.name,
        )  # fmt: skip
        self.fmu.instantiate()
        self.fmu.setupExperiment()
        set_parameters(self, parameter_set)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def reference(self, name):
        return [self.variables[name].valueReference]

    def get(self, name):
        kind = self.variables[name].type
        return getattr(self.fmu, f"get{kind}")(self.reference(name))[0]

    def set(self, name, value):
        self.fmu.setReal(self.reference(name), [value])

    def derivative(self, name, order):
        return self.fmu.getRealOutputDerivatives(self.reference(name), [order])[0]

    def set_derivative(self, name, order, value):
        self.fmu.setRealInputDerivatives(self.reference(name), [order], [value])

    def slope(self, output, given):
        """d output / d input"""
        return self.fmu.getDirectionalDerivative(self.reference(output), self.reference(given), [1.0])[0]


class System:
    """The two FMUs of the .ssp"""

    def __init__(self, ssp, ways):
        self.ways, self.time, self.taken_back, self.mismatch = ways, 0.0, 0, 0.0
        self.rate = self.curvature = 0.0  # of the force that the carriage is given
        folder, system = fmpy.extract(ssp), read_ssd(ssp).system
        values = read_ssv(ssp, "resources/start.ssv")
        self.parts = {one.name: Part(one, folder, values) for one in system.elements}
        self.wires = [
            (self.parts[one.startElement], one.startConnector, self.parts[one.endElement], one.endConnector)
            for one in system.connections
        ]
        self.carriage, self.tube = self.parts["Carriage"], self.parts["Tube"]
        self.mass = self.carriage.get("source.mass")
        self.exchange()

    def exchange(self):
        """Values along the wires, in the order that the .ssd has: motion to the tube, then its force back"""
        for source, output, target, given in self.wires:
            target.set(given, source.get(output))
        if self.ways.derivatives:
            self.exchange_derivatives()

    def exchange_derivatives(self):
        """Of velocity and force; the displacement follows the velocity. The carriage's acceleration needs its
        force, the force's derivative the acceleration, and so on."""
        carriage, tube = self.carriage, self.tube
        acceleration = carriage.derivative("source.velocity[3]", 1)
        tube.set_derivative(VELOCITY, 1, acceleration)
        self.rate, self.curvature = tube.derivative(FORCE, 1), 0.0
        carriage.set_derivative(GIVEN, 1, self.rate)
        tube.set_derivative(VELOCITY, 2, carriage.derivative("source.velocity[3]", 2))

    def save(self):
        return {name: part.fmu.getFMUstate() for name, part in self.parts.items()}, self.time

    def restore(self, saved):
        states, self.time = saved
        for name, part in self.parts.items():
            part.fmu.setFMUstate(states[name])
        self.taken_back += 1

    def free(self, saved):
        for name, part in self.parts.items():
            part.fmu.freeFMUstate(saved[0][name])

    def advance(self, size):
        for part in self.parts.values():
            part.fmu.doStep(self.time, size)
        self.time += size

    def event_time(self, before):
        """When the ball first touched or left the tube since `before`, or None"""
        onsets, active = before
        tube = self.tube
        if tube.get("contact.onsets") == onsets and tube.get("contact.active") == active:
            return None
        last = tube.get("contact.last_onset_time")
        return last + tube.get("contact.last_duration") if active else last

    def step(self, size):
        """One step, or a shorter one that ends at an event; the time reached is self.time"""
        saved = self.save()
        before = self.tube.get("contact.onsets"), self.tube.get("contact.active")
        given = self.carriage.get(GIVEN)
        self.advance(size)
        event = self.event_time(before) if self.ways.variable else None
        if event is not None and event + PAST < self.time:
            self.restore(saved)
            size = event + PAST - self.time
            self.advance(size)
        inside = before[1] and self.tube.get("contact.active")
        if self.ways.repeat and inside:
            self.repeat(saved, given, size)
        self.free(saved)
        expected = given + self.rate * size + self.curvature * size**2 / 2
        self.exchange()
        if inside:
            self.mismatch = max(self.mismatch, abs(self.carriage.get(GIVEN) - expected))

    def repeat(self, saved, given, size):
        """The force given was F + F' s. It is to be F + F' s + F'' s^2 / 2 and to end as the ball's force.
        That feels F'' too, by -(K s^4 / 24 + C s^3 / 6) / m for each N/s^2, with the contact's K and C, the
        directional derivatives of its force."""
        for name, output in ((DISPLACEMENT, "source.displacement[3]"), (VELOCITY, "source.velocity[3]")):
            self.tube.set(name, self.carriage.get(output))
        residual = self.tube.get(FORCE) - (given + self.rate * size)
        felt = 0.0
        if self.ways.slope:
            stiffness, damping = -self.tube.slope(FORCE, DISPLACEMENT), -self.tube.slope(FORCE, VELOCITY)
            felt = (stiffness * size**4 / 24 + damping * size**3 / 6) / self.mass
        self.restore(saved)
        self.curvature = residual / (felt + size**2 / 2)
        self.carriage.set_derivative(GIVEN, 2, self.curvature)
        self.advance(size)

    def close(self):
        for part in self.parts.values():
            part.fmu.terminate()
            part.fmu.freeInstance()


def run(ssp, ways, size, end):
    """From 0 s to the end in steps of a size, or of less where steps vary"""
    system = System(ssp, ways)
    while end - system.time > PAST:
        system.step(min(size, end - system.time))
    ball, carriage = system.tube.get("source.position[3]"), system.carriage.get("source.displacement[3]")
    system.close()
    return Result(ball, carriage, system.taken_back, system.mismatch)
