"""What all pages of results share: base.html (layout, style sheet), parts.html and parts.md (tables, figures)

Filters for words with formulas between $ (formula.py): typeset in HTML, plain in Markdown and attributes.
A page is a Jinja template in the package that shows it; it extends base.html or imports from parts.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape

from .formula import plain, typeset

OWN = Path(__file__).parent
IMAGES = {".png": "image/png", ".svg": "image/svg+xml"}
BOTH = {"page.html": "index.html", "page.md": "README.md"}


def write_pages(
    templates: Path, folder: Path, context: Mapping[str, Any], names: Mapping[str, str] = BOTH
) -> list[Path]:
    """Renders each template of `names` as the file it stands for, next to the images it shows"""
    environment = _environment(templates, folder)
    files = []
    for template, name in names.items():
        page = environment.get_template(template).render(context)
        (folder / name).write_text(page.rstrip() + "\n", encoding="utf-8")
        files.append(folder / name)
    return files


def _environment(templates: Path, folder: Path) -> Environment:
    environment = Environment(
        loader=FileSystemLoader([templates, OWN]),
        autoescape=select_autoescape(["html"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )

    def embedded(name: str) -> str:
        file = folder / name
        return f"data:{IMAGES[file.suffix]};base64,{base64.b64encode(file.read_bytes()).decode()}"

    def cell(text: str) -> str:
        return str(text).replace("|", "\\|").replace("\n", " ")

    environment.filters |= {"embedded": embedded, "cell": cell, "typeset": typeset, "plain": plain}
    return environment
