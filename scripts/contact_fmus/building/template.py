"""The scene files that `contact-fmus new` writes: a free ball that bounces"""

from __future__ import annotations

import json
import re

from contact_fmus.errors import UserError

SHAPES = ("sphere", "cylinder", "plane")
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")

# The ball falls onto the body's top, or inside it onto its bottom. All bounce in the first second.
START = {
    ("sphere", False): {"source.center": [0.0, 0.0, 1.0]},
    ("sphere", True): {"source.center": [0.1, 0.0, 0.0]},
    ("cylinder", False): {"source.center": [0.0, 0.0, 1.0], "destination.axis": [0.0, 1.0, 0.0]},
    ("cylinder", True): {"source.center": [0.1, 0.0, 0.0], "destination.axis": [0.0, 1.0, 0.0]},
    ("plane", False): {"source.center": [0.0, 0.0, 0.5], "destination.axis": [0.0, 0.0, 1.0]},
}
RADIUS = '"destination.radius" = 0.5 # m'
TEMPLATE = """\
# A scene: its bodies, its contacts, and which choices are pinned.
#   contact-fmus build {name}.toml          makes {name}.fmu
#   contact-fmus run {name}.fmu --plot      shows what it does
name = "{name}" # of the FMU
title = "{title}"
description = "A free ball bounces {place} a fixed {shape}."

# Every variable has a start value; those of radius, mass and the like are changed under [start].
[[body]]
name = "source"
shape = "sphere"

[[body]]
name = "destination"
shape = "{shape}"

# The source of a contact is a sphere. A scene may have more bodies and contacts, of any names.
[[contact]]
name = "contact"
source = "source"
destination = "destination"

# Start values: SI units, vectors as lists. They may still be changed when the FMU runs.
[start]
"source.radius" = 0.1 # m
"source.mass" = 1.0 # kg
{start}
"contact.penalty_factor" = 1e6 # stiffness of the contact, N/m
"contact.viscous_penalty_factor" = 100.0 # its damping, N s/m

# Choices fixed now: what only other choices would need is left out of the FMU, variables and code.
# Without its line a choice stays open. rotation = "free" with friction = "regularized" lets the ball roll.
[pinned]
{pinned}

# What an importer takes where its user says nothing.
[experiment]
stop_time = 2.0 # s
step_size = 1e-3 # communication step, s
tolerance = 1e-8
"""


def scene_text(name: str, shape: str, inside: bool, pinned: list[str]) -> str:
    """The text of the scene file; UserError for a name or a choice that cannot be one"""
    if not NAME.fullmatch(name):
        raise UserError(f"'{name}' is no name of a scene: a letter, then letters, digits and _")
    chosen = {
        "source.motion": "free",
        "destination.motion": "fixed",
        "source.rotation": "none",
        "destination.rotation": "none",
        "contact.friction": "none",
        "contact.location": "inside" if inside else "outside",
        "contact.method": "penalty_dynamic",
        "contact.penalty_control": "user_defined",
        "contact.viscous_control": "user_defined",
    }
    if shape == "plane":  # which has no inside
        if inside:
            raise UserError("--inside goes with a sphere or a cylinder: a plane has no inside")
        del chosen["contact.location"]
    chosen |= dict(_choice(text) for text in pinned)
    start = {key: value for key, value in START[shape, inside].items() if key not in chosen}
    hollow = "hollow " if inside else ""
    return TEMPLATE.format(
        name=name,
        title=f"A ball bouncing {'in' if inside else 'on'} a {hollow}{shape}",
        place="in" if inside else "on",
        shape=f"{shape}",
        start="\n".join(filter(None, (RADIUS if shape != "plane" else "", _lines(start)))),
        pinned=_lines(chosen),
    )


def _choice(text: str) -> tuple[str, str | float | bool]:
    name, equals, value = text.partition("=")
    if not equals or not name.strip() or not value.strip():
        raise UserError(f"--pinned takes NAME=VALUE, such as contact.dashpot=unclamped, not '{text}'")
    try:
        return name.strip(), json.loads(value)
    except json.JSONDecodeError:
        return name.strip(), value.strip()


def _lines(values: dict[str, object]) -> str:
    return "\n".join(f"{json.dumps(name)} = {json.dumps(value)}" for name, value in values.items())
