"""Writes the page of one animation"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from contact_fmus.plot import payload
from contact_fmus.plot.page import environment
from contact_fmus.plot.panels import usual
from contact_fmus.plot.source import Run, motion_of

from . import stage
from .library import read_three

HERE = Path(__file__).parent
SCRIPTS = ("path.js", "playback.js", "world.js", "overlay.js", "controls.js", "main.js")


def write_page(run: Run, file: Path) -> None:
    library = read_three()
    result = stage.thinned(run.result)
    motion = motion_of(result)
    thin = Run(run.title, run.label, result)
    content: dict[str, Any] = stage.content(result, motion)
    content["times"] = [content["time"]]
    content["charts"] = payload.charts(usual(result), [thin])
    text = (
        environment()
        .get_template("page.html")
        .render(
            title=", ".join(part for part in (run.title, run.label) if part),
            scene=motion.scene.name,
            bodies=[body.name for body in motion.scene.bodies],
            library=library,
            scripts=[(HERE / "viewer" / name).read_text(encoding="utf-8") for name in SCRIPTS],
            data=payload.script_json(content),
        )
    )
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")
