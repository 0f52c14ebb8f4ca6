"""Where the bodies of any scene are over time, and what they look like: for pictures and animations"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact_fmus.fmu.scene import Contact, Scene

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
        center = self._center(body)
        driven = self.series(f"{body}.prescribed_displacement")
        if driven is None or self.value(f"{body}.motion") != "prescribed":
            return np.tile(center, (len(self.time), 1))
        return center + driven

    def velocity(self, body: str) -> np.ndarray | None:
        """None where the run does not tell"""
        found = self.series(f"{body}.velocity")
        driven = self.value(f"{body}.motion") == "prescribed"
        return self.series(f"{body}.prescribed_velocity") if found is None and driven else found

    def _center(self, body: str) -> np.ndarray:
        center = self.value(f"{body}.center")
        return np.zeros(3) if center is None else np.asarray(center, dtype=float)

    def radius(self, body: str) -> float | None:
        """None for a shape without one"""
        radius = self.value(f"{body}.radius")
        return None if radius is None else float(radius)

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

    def axis_at(self, body: str, index: int) -> np.ndarray | None:
        """The axis as it has turned, at one of the times"""
        turned = self.series(f"{body}.current_axis")
        return self.axis(body) if turned is None else turned[index]

    def length(self, body: str) -> float | None:
        """None for a sphere and for an infinite cylinder"""
        if not self.value(f"{body}.finite_length"):
            return None
        return float(self.value(f"{body}.length"))

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
        radii = [self.radius(body.name) or 0.0 for body in self.scene.bodies]
        return float(max(np.max(np.ptp(centers, axis=0)), *radii))

    def moves(self, body: str) -> bool:
        return bool(np.max(np.ptp(self.position(body), axis=0)) > STILL * self.size())

    def is_hollow(self, body: str) -> bool:
        """Whether a contact has its source inside this body"""
        return any(self._inside(contact) for contact in self.scene.contacts if contact.destination == body)

    def _inside(self, contact: Contact) -> bool:
        """As the FMU decides: by the parameter, or by the start where it is automatic"""
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
        if axis is not None:
            apart = apart - (apart @ axis) * axis
        return bool(np.linalg.norm(apart) < radius and inner < radius)
