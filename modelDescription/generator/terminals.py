"""terminalsAndIcons/terminalsAndIcons.xml: a terminal for each body.

FMI 3.0 section 2.4.9 defines the file. FMI 2.0 has none of its own, so the same file serves both: with the
names of scalars in FMI 2.0, and of arrays in FMI 3.0.
"""

from __future__ import annotations

from dataclasses import dataclass

from .resolve import Resolved

# The kind of all terminals. Members are named alike in all FMUs; those that a scene leaves out are absent.
KIND = "contact-fmus.body"

# Member -> row of a body; what comes first is what a tool that moves the body itself connects.
MEMBERS = {
    "prescribed_displacement": "body.prescribed_displacement",
    "prescribed_velocity": "body.prescribed_velocity",
    "prescribed_axis": "body.prescribed_axis",
    "prescribed_orientation": "body.prescribed_orientation",
    "prescribed_angular_velocity": "body.prescribed_angular_velocity",
    "external_force": "body.external_force",
    "external_torque": "body.external_torque",
    "displacement": "body.displacement",
    "position": "body.position",
    "velocity": "body.velocity",
    "orientation": "body.orientation",
    "axis": "body.current_axis",
    "angular_velocity": "body.angular_velocity",
    "contact_force": "body.contact_force",
    "contact_torque": "body.contact_torque",
}
# Of a contact, on its two bodies: the members are "force" and "torque", numbered where a body is in several
# contacts.
LOADS = {
    "force": {"source": "contact.source_force", "destination": "contact.destination_force"},
    "torque": {"source": "contact.source_torque", "destination": "contact.destination_torque"},
}


@dataclass(frozen=True)
class Member:
    variable: str
    name: str
    kind: str  # variableKind: what of a connection it is; "signal": joined to its kin with the same value


@dataclass(frozen=True)
class Terminal:
    name: str
    description: str
    members: tuple[Member, ...]
    kind: str = KIND


def terminals(resolved: Resolved, arrays: bool) -> list[Terminal]:
    """arrays: a vector is one variable, as in FMI 3.0, and not three."""
    result = []
    for index, body in enumerate(resolved.scene.bodies):
        members = [member for found in _cells(resolved, index) for member in _members(*found, arrays)]
        if members:
            result.append(Terminal(body.name, f"Motion of {body.name} and the forces on it", tuple(members)))
    return result


def _cells(resolved: Resolved, body: int):
    """(member, cell) of what the body has, then of the forces and torques of its contacts"""
    for member, key in MEMBERS.items():
        yield from ((member, cell) for cell in resolved.of(key) if cell.element == body and cell.open)
    for load, keys in LOADS.items():
        found = [
            cell
            for j, contact in enumerate(resolved.scene.contacts)
            for role, key in keys.items()
            if getattr(contact, role) == body
            for cell in resolved.of(key)
            if cell.element == j and cell.open
        ]
        several = len(found) > 1
        yield from ((f"{load}_{n}" if several else load, cell) for n, cell in enumerate(found, 1))


def _members(name: str, cell, arrays: bool):
    if arrays:
        yield Member(cell.name, name, "signal")
        return
    for component in range(1, cell.row.dim + 1):
        yield Member(f"{cell.name}[{component}]", f"{name}[{component}]", "signal")
