"""What a scenario is, once read, and what a run of it leaves: the types that all other files here share"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from pathlib import Path
from typing import Any, Self

import numpy as np

from contact_fmus.errors import RunFailure
from contact_fmus.fmu.files import Contact, Scene, fmu_file, has_scene, read_scene

# Inputs over time: straight lines between points, a sinusoid, or the time derivative of another input

FORMS = {
    "table": {"times", "values"},
    "sinusoid": {"offset", "amplitude", "frequency", "phase"},
    "derivative": {"derivative_of"},
}


@dataclass(frozen=True)
class InputSignal:
    variable: str
    derivatives: int  # how many are given to the FMU besides the value
    evaluate: Callable[[float, int], np.ndarray]  # (time, order of the derivative)

    @classmethod
    def make(cls, variable: str, derivatives: int, options: dict[str, Any]) -> Self:
        """ValueError where the options are not one of the forms"""
        if derivatives not in (0, 1, 2):
            raise ValueError(f"derivatives = {derivatives} is not 0, 1 or 2")
        if not options:
            raise ValueError("give times and values, or amplitude and frequency, or derivative_of")
        form = next((name for name, keys in FORMS.items() if set(options) <= keys), None)
        if form == "table":
            return cls(variable, derivatives, _table(**options))
        if form == "sinusoid":
            return cls(variable, derivatives, _sinusoid(**options))
        if form == "derivative":
            original = options["derivative_of"].evaluate
            return cls(variable, derivatives, lambda time, order: original(time, order + 1))
        raise ValueError(
            f"{', '.join(options)} do not go together: give times and values, or amplitude and "
            "frequency, or derivative_of"
        )


def _table(times: list[float] | None = None, values: list | None = None) -> Callable[[float, int], np.ndarray]:
    if not times or not values or len(times) != len(values) or not np.all(np.diff(times) > 0.0):
        raise ValueError("times must rise, with one of values for each")
    points, nodes = np.array(times, dtype=float), np.array(values, dtype=float).reshape(len(times), -1)

    def evaluate(time: float, order: int) -> np.ndarray:
        # A corner belongs to the line after it: that is the derivative the FMU needs from this point on.
        line = int(np.searchsorted(points, time, side="right")) - 1
        if line < 0 or line >= len(points) - 1:
            return nodes[max(0, min(line, len(points) - 1))] * (order == 0)
        slope = (nodes[line + 1] - nodes[line]) / (points[line + 1] - points[line])
        return (nodes[line] + slope * (time - points[line]), slope)[order] if order < 2 else 0.0 * slope

    return evaluate


def _sinusoid(
    amplitude: Any = None, frequency: float | None = None, offset: Any = 0.0, phase: float = 0.0
) -> Callable[[float, int], np.ndarray]:
    if amplitude is None or frequency is None:
        raise ValueError("a sinusoid needs amplitude and frequency")
    size, middle = np.atleast_1d(np.array(amplitude, dtype=float)), np.array(offset, dtype=float)
    rate = 2.0 * math.pi * frequency

    def evaluate(time: float, order: int) -> np.ndarray:
        # The n-th derivative of sin is sin turned by n quarter turns.
        wave = size * rate**order * math.sin(rate * time + phase + 0.5 * math.pi * order)
        return wave + middle if order == 0 else wave

    return evaluate


# Where the bodies of any scene are over time, and what they look like: for pictures and animations

STILL = 1e-12  # a body that moves by less than this part of the scene's size stands still in a picture


@dataclass(frozen=True)
class Motion:
    """One run of one scene"""

    scene: Scene
    time: np.ndarray  # s
    value: Callable[[str], Any]  # a parameter, pinned or open; None where the FMU has none of this name
    series: Callable[[str], np.ndarray | None]  # a variable over time, vectors one row a time; None as above

    def shape(self, body: str) -> str:
        return next(one.shape for one in self.scene.bodies if one.name == body)

    def position(self, body: str) -> np.ndarray:
        """Centre of a body: an output, or what a fixed or driven body starts from"""
        found = self.series(f"{body}.position")
        if found is not None:
            return found
        center = self.value(f"{body}.center")
        center = np.zeros(3) if center is None else np.asarray(center, dtype=float)
        driven = self.series(f"{body}.prescribed_displacement")
        if driven is None or self.value(f"{body}.motion") != "prescribed":
            return np.tile(center, (len(self.time), 1))
        return center + driven

    def velocity(self, body: str) -> np.ndarray | None:
        """None where the run does not tell"""
        found = self.series(f"{body}.velocity")
        driven = self.value(f"{body}.motion") == "prescribed"
        return self.series(f"{body}.prescribed_velocity") if found is None and driven else found

    def parts(self, body: str) -> tuple:
        """Radii and centres of the spheres of a compound; none of other bodies"""
        return next(one.parts for one in self.scene.bodies if one.name == body)

    def radius(self, body: str) -> float | None:
        """None for a shape without one; of a compound what reaches round it"""
        around = [part["radius"] + float(np.linalg.norm(part["center"])) for part in self.parts(body)]
        radius = max(around) if around else self.value(f"{body}.radius")
        return None if radius is None else float(radius)

    def ring(self, body: str) -> float:
        """Radius of the circle in the middle of a torus; 0 of other bodies"""
        return float(self.value(f"{body}.ring_radius") or 0.0)

    def is_plane(self, body: str) -> bool:
        return self.shape(body) == "plane"

    def axis(self, body: str) -> np.ndarray | None:
        """Unit vector: a cylinder's axis, a plane's outward normal; None for a sphere"""
        axis = self.value(f"{body}.axis")
        if axis is None:
            return None
        # The FMU takes an axis of any length: first scaled, so that its square stays inside a double.
        axis = np.asarray(axis, dtype=float)
        axis = axis / np.max(np.abs(axis))
        return axis / np.linalg.norm(axis)

    def length(self, body: str) -> float | None:
        """None for a sphere and for an infinite cylinder"""
        return float(self.value(f"{body}.length")) if self.value(f"{body}.finite_length") else None

    def orientation(self, body: str) -> np.ndarray | None:
        """Unit quaternions w, x, y, z from the body to the world; None for bodies that do not turn"""
        found = self.series(f"{body}.orientation")
        return None if found is None or np.all(np.ptp(found, axis=0) == 0.0) else found

    def contacts_of(self, body: str) -> list[Contact]:
        return [one for one in self.scene.contacts if body in (one.source, one.destination)]

    def size(self) -> float:
        """The longest side of the box around all centres, or the largest radius where they are one point; the
        point of a plane may be anywhere"""
        bodies = [body.name for body in self.scene.bodies if not self.is_plane(body.name)]
        centers = np.concatenate([self.position(body) for body in bodies])
        radii = [(self.radius(body.name) or 0.0) + self.ring(body.name) for body in self.scene.bodies]
        return float(max(np.max(np.ptp(centers, axis=0)), *radii))

    def moves(self, body: str) -> bool:
        return bool(np.max(np.ptp(self.position(body), axis=0)) > STILL * self.size())

    def is_hollow(self, body: str) -> bool:
        """Whether a contact has its source inside this body"""
        return any(self._inside(contact) for contact in self.scene.contacts if contact.destination == body)

    def _inside(self, contact: Contact) -> bool:
        """The FMU decides this by the parameter, or by the start where it is automatic."""
        if self.is_plane(contact.destination):
            return False
        location = self.value(f"{contact.name}.location")
        if location != "automatic":
            return location == "inside"
        radius, inner = self.radius(contact.destination), self.radius(contact.source)
        if radius is None or inner is None:
            return False
        apart = self.position(contact.source)[0] - self.position(contact.destination)[0]
        axis = self.axis(contact.destination)
        along = 0.0 if axis is None else float(apart @ axis)
        across = float(np.linalg.norm(apart - along * (0.0 if axis is None else axis)))
        ring = self.ring(contact.destination)
        return bool((math.hypot(across - ring, along) if ring else across) < radius and inner < radius)


@dataclass(frozen=True)
class Claim:
    check: str
    text: str
    allowed: float
    relative: bool
    options: dict[str, Any] = field(default_factory=dict)
    when: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Variant:
    """One run of a scenario: what [vary] chose for it"""

    choice: dict[str, Any]
    start: dict[str, Any]
    steps: int
    tolerance: float | None

    @property
    def label(self) -> str:
        return ", ".join(_describe(name, value) for name, value in self.choice.items())


@dataclass(frozen=True)
class Experiment:
    """What is run: an FMU with settings, or one variant of a scenario. Times in s"""

    name: str
    title: str
    fmu: Path
    start_time: float
    stop_time: float
    step: float
    tolerance: float | None = None
    values: dict[str, Any] = field(default_factory=dict)
    inputs: tuple[InputSignal, ...] = ()
    label: str = ""  # what tells it from the other runs of a scenario


@dataclass(frozen=True)
class Scenario:
    name: str
    title: str
    description: str
    fmu: str
    start_time: float
    stop_time: float
    variants: list[Variant]
    inputs: list[InputSignal]
    claims: list[Claim]
    plot_steps: int
    plot_compare: str | None

    def plotted(self) -> list[Variant]:
        """The runs that are drawn: the last choice of everything but what is compared"""
        last = self.variants[-1].choice
        compared = [
            {name: one.choice[name] for name in one.choice if name == self.plot_compare} for one in self.variants
        ]
        return [
            replace(variant, choice=choice, steps=self.plot_steps)
            for variant, choice in zip(self.variants, compared, strict=True)
            if variant.choice == last | choice
        ]


def _describe(name: str, value: Any) -> str:
    """A choice in words: cvode_bdf; 10 steps; finite_length true; penalty_factor 1e+06"""
    if isinstance(value, str):
        return value
    if name == "steps":
        return f"{value} step{'' if value == 1 else 's'}"
    if isinstance(value, list):
        text = "(" + ", ".join(f"{entry:g}" for entry in value) + ")"
    else:
        text = str(value).lower() if isinstance(value, bool) else f"{value:g}"
    return f"{name.split('.')[-1]} {text}"


ENERGIES = ("kinetic", "rotational", "potential", "contact", "tangential", "dissipated", "friction")


class RunError(RunFailure):
    """The FMU refused something, or lacks a variable the scenario names"""


@dataclass(frozen=True)
class Recording:
    scenario: Scenario
    variant: Variant
    time: np.ndarray
    series: dict[str, np.ndarray]  # recorded names, one row a communication point
    initial: dict[str, Any]  # every variable after initialization
    final: dict[str, Any]  # every variable at the end
    warnings: Sequence[str] = ()  # of the FMU

    def value(self, name: str) -> Any:
        """A parameter, pinned or open, or an output at the start"""
        if self.has(name):
            return (pinned_values(self.scenario.fmu) | self.initial)[name]
        raise RunError(f"{self.scenario.name}: {self.scenario.fmu} has no variable {name}")

    @cached_property
    def motion(self) -> Motion:
        """The run as pictures need it"""
        scene = read_scene(fmu_file(self.scenario.fmu))
        return Motion(scene, self.time, lambda name: self.value(name) if self.has(name) else None, self.series.get)

    def has(self, name: str) -> bool:
        return name in self.initial or name in pinned_values(self.scenario.fmu)


@cache
def pinned_values(fmu: str) -> dict[str, Any]:
    """What the FMU's scene pins, so that it is no variable any more; empty for an FMU from elsewhere"""
    file = fmu_file(fmu)
    return read_scene(file).pinned if has_scene(file) else {}
