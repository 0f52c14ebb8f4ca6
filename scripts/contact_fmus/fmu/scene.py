"""The scene that an FMU was built from: its bodies, their shapes, its contacts and what it pins.

An FMU carries it as resources/scene.json; modelDescription.xml tells neither shapes nor pinned values:

    {"format": 1, "name": "BallInShell", "title": "...",
     "bodies": [{"name": "source", "shape": "sphere"}, ...],
     "contacts": [{"name": "contact", "source": "source", "destination": "destination"}, ...],
     "pinned": {"source.motion": "free", ...}}

A reader should take shapes that it does not know for what they have: a position, perhaps a radius.
"""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any

from contact_fmus.errors import UserError

from .files import unpack

MEMBER = "resources/scene.json"
FORMAT = 1


@dataclass(frozen=True)
class Body:
    name: str
    shape: str  # sphere, cylinder, plane; others later


@dataclass(frozen=True)
class Contact:
    name: str
    source: str  # name of a body
    destination: str


@dataclass(frozen=True)
class Scene:
    name: str
    title: str
    bodies: tuple[Body, ...]
    contacts: tuple[Contact, ...]
    pinned: dict[str, Any]  # by variable; vectors are lists, enumerations item names


def has_scene(fmu: str | os.PathLike) -> bool:
    return (unpack(fmu, kind="")[0] / MEMBER).is_file()


def read_scene(fmu: str | os.PathLike) -> Scene:
    """UserError where the FMU carries none: one of another vendor, or built before FMUs carried theirs"""
    file = unpack(fmu, kind="")[0] / MEMBER
    if not file.is_file():
        raise UserError(f"{fmu}: no {MEMBER} inside, so nothing tells its bodies: build it again")
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
        if content["format"] != FORMAT:
            raise UserError(f"{fmu}: {MEMBER} has format {content['format']!r}, known is {FORMAT}")
        return Scene(
            content["name"],
            content["title"],
            tuple(Body(body["name"], body["shape"]) for body in content["bodies"]),
            tuple(Contact(one["name"], one["source"], one["destination"]) for one in content["contacts"]),
            dict(content["pinned"]),
        )
    except (ValueError, KeyError, TypeError) as error:
        raise UserError(f"{fmu}: {MEMBER} is not what a viewer can read: {error!r}") from None
