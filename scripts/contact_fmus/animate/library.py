"""three.js, bundled from its npm package when the project is set up (scripts/setup.sh)

By hand: `npm ci && npm run bundle`. The bundle is no part of the repository.
A wheel carries it beside this file.
"""

from __future__ import annotations

from pathlib import Path

from contact_fmus.errors import UserError

FILE = Path(__file__).parent / "three.bundle.js"


def read_three() -> str:
    """The script that defines THREE, with its licence in a comment"""
    try:
        # The words that would end the page's script element
        return FILE.read_text(encoding="utf-8").replace("</script", "<\\/script")
    except FileNotFoundError:
        text = "animations need three.js: run scripts/setup.sh in the repository and install again"
        raise UserError(text) from None
