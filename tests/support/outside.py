"""An integrator outside of an FMU: the classical Runge-Kutta method, events found by halving the step.

It asks for derivatives as the standard has it, with the inputs of each instant, and drives instances of
FMI 2.0 and of FMI 3.0 by the same numbers."""

from __future__ import annotations

from collections.abc import Callable
from ctypes import c_double

import numpy as np

from support.fmi2 import raw
from support.fmi3 import raw as raw3

NO_INPUTS: Callable[[float], dict] = lambda _time: {}  # noqa: E731


class Outside:
    """An instance of Model Exchange and the steps it takes"""

    def __init__(self, instance: raw.Instance | raw3.Instance, inputs: Callable[[float], dict] = NO_INPUTS):
        self.instance, self.inputs = instance, inputs
        self.count = {role: len(names) for role, names in instance.fmu.roles.items()}
        self.time = 0.0
        self.announced: float | None = None  # the next event; the steps here find it by themselves

    def read(self, function: str, role: str = "state") -> np.ndarray:
        values = raw.array(c_double, [0.0] * self.count[role])
        self.instance.ok(function, values, self.count[role])
        return np.array(values)

    def states(self) -> np.ndarray:
        return self.read("GetContinuousStates")

    def feed(self, time: float) -> None:
        """Sets time and the inputs of that instant."""
        self.instance.ok("SetTime", time)
        self.instance.set(self.inputs(time))

    def put(self, time: float, states: np.ndarray) -> None:
        self.feed(time)
        self.instance.ok("SetContinuousStates", raw.array(c_double, states), len(states))

    def rates(self, time: float, states: np.ndarray) -> np.ndarray:
        self.put(time, states)
        return self.read(self.instance.RATES)

    def indicators(self) -> np.ndarray:
        return self.read("GetEventIndicators", "indicator")

    def update(self) -> bool:
        """Event mode until nothing changes any more; whether a state has jumped"""
        jumped = False
        for _ in range(10):
            again, now, self.announced = self.instance.update_discrete_states()
            jumped = jumped or now
            if not again:
                return jumped
        raise AssertionError("event iteration does not end")

    def begin(self) -> Outside:
        self.update()
        self.instance.ok("EnterContinuousTimeMode")
        return self

    def event(self) -> None:
        self.instance.ok("EnterEventMode")
        self.update()
        self.instance.ok("EnterContinuousTimeMode")

    def _ahead(self, states: np.ndarray, size: float) -> np.ndarray:
        time = self.time
        first = self.rates(time, states)
        second = self.rates(time + size / 2, states + size / 2 * first)
        third = self.rates(time + size / 2, states + size / 2 * second)
        fourth = self.rates(time + size, states + size * third)
        return states + size / 6 * (first + 2 * second + 2 * third + fourth)

    def _try(self, states: np.ndarray, size: float, signs: np.ndarray) -> bool:
        """Takes a step; whether no indicator changes its sign in it"""
        self.put(self.time + size, self._ahead(states, size))
        return bool((np.sign(self.indicators()) == signs).all())

    def step(self, size: float) -> None:
        states = self.states()
        signs = np.sign(self.indicators())
        if not self._try(states, size, signs):
            low, high = 0.0, size
            while high - low > 1e-15 + 1e-14 * self.time:
                middle = (low + high) / 2
                low, high = (middle, high) if self._try(states, middle, signs) else (low, middle)
            self._try(states, high, signs)
            self._accept(high)
            self.event()
            size -= high
            if size > 0.0:
                self.step(size)
            return
        self._accept(size)

    def _accept(self, size: float) -> None:
        self.time += size
        self.instance.complete_step()

    def run(self, stop: float, size: float) -> None:
        for _ in range(round((stop - self.time) / size)):
            self.step(size)
