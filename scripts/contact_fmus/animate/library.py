"""three.js, in one file that scripts/build_backend.py makes of its npm package when the project is set up or
the wheel is built; it is no part of the repository.
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
        text = f"animations need three.js: {FILE} is missing; run scripts/build_backend.py in the clone"
        raise UserError(text) from None
