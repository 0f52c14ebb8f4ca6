"""The scene files that `contact-fmus new` writes: a free ball that bounces"""

from __future__ import annotations

import json
import re

from contact_fmus.errors import UserError

SHAPES = ("sphere", "cylinder", "plane")
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")

# What the ball meets, by shape and side. No name is also a key of the file, as "source" is: replacing a name
# everywhere renames the body.
BODY = {
    ("sphere", False): "globe",
    ("sphere", True): "shell",
    ("cylinder", False): "tube",
    ("cylinder", True): "tube",
    ("plane", False): "floor",
}
# The ball falls onto the body's top, or inside it onto its bottom. All bounce in the first second.
START = {
    ("sphere", False): {"ball.center": [0.0, 0.0, 1.0]},
    ("sphere", True): {"ball.center": [0.1, 0.0, 0.0]},
    ("cylinder", False): {"ball.center": [0.0, 0.0, 1.0], "{body}.axis": [0.0, 1.0, 0.0]},
    ("cylinder", True): {"ball.center": [0.1, 0.0, 0.0], "{body}.axis": [0.0, 1.0, 0.0]},
    ("plane", False): {"ball.center": [0.0, 0.0, 0.5], "{body}.axis": [0.0, 0.0, 1.0]},
}
RADIUS = '"{body}.radius" = 0.5 # m'
TEMPLATE = """\
# A scene: its bodies, its contacts, and which choices are pinned.
#   contact-fmus build {name}.toml          makes {name}.fmu
#   contact-fmus run {name}.fmu             prints where the ball ends and what it did
#   contact-fmus run {name}.fmu --plot      draws it; pip install 'contact-fmus[plot]' brings what that needs
name = "{name}" # of the FMU
title = "{title}"
description = "A free ball bounces {place} a fixed {shape}."

# Every variable has a start value; those of radius, mass and the like are changed under [start].
[[body]]
name = "ball"
shape = "sphere"

[[body]]
name = "{body}"
shape = "{shape}"

# The source of a contact is a sphere. A scene may have more bodies and contacts, of any names.
[[contact]]
name = "contact"
source = "ball"
destination = "{body}"

# Start values: SI units, vectors as lists. They may still be changed when the FMU runs.
[start]
"ball.radius" = 0.1 # m
"ball.mass" = 1.0 # kg
{start}
"contact.penalty_factor" = 1e6 # stiffness of the contact, N/m
"contact.viscous_penalty_factor" = 100.0 # its damping, N s/m

# Choices fixed now: what only other choices would need is left out of the FMU, variables and code.
# Without its line a choice stays open. rotation = "free" with friction = "regularized" lets the ball roll.
# An open solver.method brings CVODE into the FMU, to compare methods with; event_driven is the one to use.
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
    if shape == "plane" and inside:
        raise UserError("--inside goes with a sphere or a cylinder: a plane has no inside")
    body = BODY[shape, inside]
    chosen = {
        "ball.motion": "free",
        f"{body}.motion": "fixed",
        "ball.rotation": "none",
        f"{body}.rotation": "none",
        "contact.friction": "none",
        "contact.location": "inside" if inside else "outside",
        "contact.method": "penalty_dynamic",
        "contact.penalty_control": "user_defined",
        "contact.viscous_control": "user_defined",
        "solver.method": "event_driven",
    }
    if shape == "plane":  # which has no inside
        del chosen["contact.location"]
    chosen |= dict(_choice(text) for text in pinned)
    start = {key.format(body=body): value for key, value in START[shape, inside].items()}
    start = {key: value for key, value in start.items() if key not in chosen}
    hollow = "hollow " if inside else ""
    return TEMPLATE.format(
        name=name,
        body=body,
        title=f"A ball bouncing {'in' if inside else 'on'} a {hollow}{shape}",
        place="in" if inside else "on",
        shape=shape,
        start="\n".join(filter(None, (RADIUS.format(body=body) if shape != "plane" else "", _lines(start)))),
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
