"""A contact FMU as a force element: the caller moves the source and gets the force on it.

Both bodies are prescribed, the destination rests. The source's displacement over a communication step is a
polynomial of second degree at most, as far as fmi2SetRealInputDerivatives gives it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contact_fmus.fmu.contact_fmu import ContactFmu

BOTH_PRESCRIBED = {"source.motion": "prescribed", "destination.motion": "prescribed"}
STILL = np.zeros(3)


class DrivenContact:
    """`values`: start values of the FMU besides the motions, which are prescribed. At rest at the start."""

    def __init__(self, fmu: ContactFmu, values: dict[str, Any]):
        self.fmu, self.steps, self.taken_back = fmu, 0, 0
        fmu.reset()
        fmu.start(values | {name: value for name, value in BOTH_PRESCRIBED.items() if name in fmu})
        kinds = ("displacement", "velocity")
        self._displacement, self._velocity = (fmu.variable(f"source.prescribed_{kind}").references for kind in kinds)

    def force_at(self, displacement: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """The force of this state, at once: no step is needed, because the force has no memory."""
        self.fmu.call("setReal", self._displacement + self._velocity, [*displacement, *velocity])
        return self.fmu["contact.source_force"]

    def force_after(
        self,
        size: float,
        displacement: np.ndarray,
        velocity: np.ndarray,
        rate: np.ndarray = STILL,
        curvature: np.ndarray = STILL,
        acceleration: np.ndarray = STILL,
    ) -> np.ndarray:
        """The force at the end of a step over which displacement + rate t + curvature t^2/2 goes on, and
        velocity + acceleration t; without those both are held."""
        self._step(size, displacement, velocity, rate, curvature, acceleration)
        return self.fmu["contact.source_force"]

    def mean_force(self, size: float, displacement, velocity, rate, curvature, acceleration) -> np.ndarray:
        """The mean force over such a step: its impulse divided by the step"""
        self._step(size, displacement, velocity, rate, curvature, acceleration)
        return self.fmu["contact.mean_force"]

    def remember(self) -> None:
        self._state = self.fmu.save()

    def take_back(self) -> None:
        """Back to what was remembered: the step is done again with another path."""
        self.fmu.restore(self._state)
        self.taken_back += 1

    def go_on(self, size: float) -> None:
        """A step with the inputs as they are"""
        self.fmu.step(size)
        self.steps += 1

    def _step(self, size, displacement, velocity, rate, curvature, acceleration) -> None:
        self.fmu.call("setReal", self._displacement + self._velocity, [*displacement, *velocity])
        if rate is not STILL:
            references = self._displacement * 2 + self._velocity
            orders = [order for order in (1, 2, 1) for _ in range(3)]
            self.fmu.call("setRealInputDerivatives", references, orders, [*rate, *curvature, *acceleration])
        self.go_on(size)
