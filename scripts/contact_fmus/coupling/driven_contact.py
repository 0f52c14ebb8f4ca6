"""A contact FMU as a force element: the caller moves the source and gets the force on it.

Both bodies are prescribed, the destination rests. The source's displacement over a communication step is a
polynomial of second degree at most, as far as fmi2SetRealInputDerivatives gives it. Thousands of steps are
wanted, so the calls go to the library with argument arrays that are made once.
"""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np

from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError, Status

BOTH_PRESCRIBED = {"source.motion": "prescribed", "destination.motion": "prescribed"}
STILL = np.zeros(3)
DOUBLES = ctypes.POINTER(ctypes.c_double)


class Reals:
    """References and values of Real variables, as the FMI functions take them"""

    def __init__(self, fmu: ContactFmu, *names: str):
        references = [reference for name in names for reference in fmu.variable(name).references]
        self.count = ctypes.c_size_t(len(references))
        self.references = (ctypes.c_uint * len(references))(*references)
        self.values = np.zeros(len(references))
        self.pointer = self.values.ctypes.data_as(DOUBLES)

    def orders(self, *orders: int) -> ctypes.Array:
        return (ctypes.c_int * len(self.values))(*(order for order in orders for _ in range(3)))


class DrivenContact:
    """`values`: start values of the FMU besides the motions, which are prescribed. At rest at the start."""

    def __init__(self, fmu: ContactFmu, values: dict[str, Any]):
        self.fmu, self.library, self.component = fmu, fmu.slave.dll, ctypes.c_void_p(fmu.slave.component)
        fmu.reset()
        pinned = {name: value for name, value in BOTH_PRESCRIBED.items() if name in fmu}
        fmu.start({**values, **pinned})
        displacement, velocity = "source.prescribed_displacement", "source.prescribed_velocity"
        self._inputs = Reals(fmu, displacement, velocity)
        self._rates = Reals(fmu, displacement, displacement, velocity)
        self._orders = self._rates.orders(1, 2, 1)
        self._force = Reals(fmu, "contact.source_force")
        self._mean = Reals(fmu, "contact.mean_force") if "contact.mean_force" in fmu else None
        self._state = ctypes.c_void_p()
        self._time, self.steps, self.taken_back = 0.0, 0, 0

    def close(self) -> None:
        """Frees the saved state; the FMU stays open."""
        if self._state.value:
            self._call("fmi2FreeFMUstate", ctypes.byref(self._state))

    def _call(self, function: str, *arguments: Any) -> None:
        status = getattr(self.library, function)(self.component, *arguments)
        if status > Status.WARNING:
            raise FmuError(function, status, self.fmu.messages[-1:])

    def _read(self, reals: Reals) -> np.ndarray:
        self._call("fmi2GetReal", reals.references, reals.count, reals.pointer)
        return reals.values.copy()

    def force_at(self, displacement: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """The force of this state, at once: no step is needed, because the force has no memory."""
        self._place(displacement, velocity)
        return self._read(self._force)

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
        return self._read(self._force)

    def mean_force(self, size: float, displacement, velocity, rate, curvature, acceleration) -> np.ndarray:
        """The mean force over such a step: its impulse divided by the step"""
        self._step(size, displacement, velocity, rate, curvature, acceleration)
        return self._read(self._mean)

    def remember(self) -> None:
        self._call("fmi2GetFMUstate", ctypes.byref(self._state))
        self._remembered = self._time

    def take_back(self) -> None:
        """Back to what was remembered: the step is done again with another path."""
        self._call("fmi2SetFMUstate", self._state)
        self._time = self._remembered
        self.taken_back += 1

    def go_on(self, size: float) -> None:
        """A step with the inputs as they are"""
        self._call("fmi2DoStep", ctypes.c_double(self._time), ctypes.c_double(size), ctypes.c_int(1))
        self._time += size
        self.steps += 1

    def _place(self, displacement: np.ndarray, velocity: np.ndarray) -> None:
        inputs = self._inputs
        inputs.values[:3], inputs.values[3:] = displacement, velocity
        self._call("fmi2SetReal", inputs.references, inputs.count, inputs.pointer)

    def _step(self, size, displacement, velocity, rate, curvature, acceleration) -> None:
        self._place(displacement, velocity)
        if rate is not STILL:
            rates = self._rates
            rates.values[:3], rates.values[3:6], rates.values[6:] = rate, curvature, acceleration
            self._call("fmi2SetRealInputDerivatives", rates.references, rates.count, self._orders, rates.pointer)
        self.go_on(size)
