#!/usr/bin/env python3
"""Writes the generated files of one FMU from its scene file and variables.toml.

generate.py --scene scenes/BallOnSphere.toml --output DIR   modelDescription.xml, C table, documentation
generate.py --scene ... --output DIR --icon model.png       the icon as well
generate.py --scene ... --output DIR --choices integer      choices as Integers, not Enumerations
generate.py --table                                         JSON: how many variables each scene has
generate.py --guide docs/scenes.md                          every key of a scene file
"""

import argparse
import json
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from generator.emit import counts, guide, render, write  # noqa: E402
from generator.errors import InputError  # noqa: E402
from generator.icon import draw  # noqa: E402
from generator.icon_svg import draw_svg  # noqa: E402
from generator.resolve import Resolved, resolve  # noqa: E402
from generator.scene import CHOICES, read_scene  # noqa: E402
from generator.start import Start, check_start  # noqa: E402
from generator.variables_file import read_catalogue  # noqa: E402


def load(path: Path, choices: str | None = None) -> Resolved:
    """choices: instead of what the scene file says of them"""
    catalogue = read_catalogue(HERE / "variables.toml")
    scene = read_scene(path, catalogue)
    if (choices or scene.choices) == "integer":
        catalogue = catalogue.with_integer_choices()
    resolved = resolve(scene, catalogue)
    for warning in check_start(resolved):
        print(f"{resolved.scene.file}: warning: {warning}", file=sys.stderr)
    return resolved


def licence() -> dict[str, str]:
    """The project's own licence, for documentation/licenses inside the FMU."""
    file = HERE.parent / "LICENSE"
    return {"documentation/licenses/license.txt": file.read_text(encoding="utf-8")} if file.exists() else {}


def arguments(args: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--scene", type=Path, action="append", help="scene file; with --table more than once or left out"
    )
    parser.add_argument("--output", type=Path, help="folder to write to")
    parser.add_argument(
        "--table", action="store_true", help="print a JSON table of variable counts instead of writing files"
    )
    parser.add_argument("--icon", type=Path, help="PNG file to draw the scene in; icon.svg beside it")
    parser.add_argument("--choices", choices=CHOICES, help="instead of what the scene file says")
    parser.add_argument("--guide", type=Path, help="file to write the guide to scene files to")
    result = parser.parse_args(args)
    if not (result.table or result.guide) and (result.output is None or len(result.scene or []) != 1):
        parser.error("one --scene and --output are needed, or --table, or --guide")
    return result


def main(args: list[str] | None = None) -> int:
    options = arguments(args)
    try:
        if options.table:
            scenes = [load(path) for path in options.scene or sorted((HERE / "scenes").glob("*.toml"))]
            print(json.dumps({resolved.scene.name: counts(resolved) for resolved in scenes}, indent=2))
        elif options.guide:
            text = guide(read_catalogue(HERE / "variables.toml"))
            write({options.guide.name: text}, options.guide.parent)
        else:
            resolved = load(options.scene[0], options.choices)
            write(render(resolved) | licence(), options.output)
            if options.icon:
                start = Start(resolved)
                icons = {options.icon.name: draw(start), "icon.svg": draw_svg(start).encode()}
                write(icons, options.icon.parent)
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    except OSError as error:
        print(f"{error.filename}: cannot be written: {error.strerror}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
