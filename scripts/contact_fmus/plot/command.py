"""The command plot, and a result drawn in one call"""

from pathlib import Path

from contact_fmus.errors import UserError
from contact_fmus.fmu.files import has_scene, read_scene
from contact_fmus.options import parse
from contact_fmus.results import PICTURES, Result, output_file
from contact_fmus.scenarios.scenario import ANY, SCENARIOS, find

from . import page, panels, picture
from .panels import usual
from .source import Run, open_runs

SUFFIXES = (*PICTURES, ".html")


def draw(result: Result, file: str | Path) -> None:
    """Draws gaps, forces, positions and energies over time, as `contact-fmus run --plot` does"""
    output = output_file(Path(file), "", SUFFIXES)
    write = page.write_page if output.suffix == ".html" else picture.draw
    title = output.stem
    if result.fmu is not None:
        fmu = Path(result.fmu)
        title = read_scene(fmu).title if fmu.is_file() and has_scene(fmu) else fmu.stem
    write(title, [Run(title, "", result)], usual(result), output)


def main(arguments: list[str] | None = None) -> int:
    """0: drawn"""
    options = parse("plot", arguments)
    output = output_file(options.output, find(options.source, ANY).stem + ".png", SUFFIXES)
    runs = open_runs(options.source, options.set, options.stop, options.fmu)
    first = runs[0].result
    drawn = panels.chosen(first, options.variables) if options.variables else panels.usual(first)
    if not drawn:
        raise UserError(f"{options.source}: nothing to draw, it has no column but time")
    write = page.write_page if output.suffix == ".html" else picture.draw
    write(runs[0].title, runs, drawn, output)
    print(output)
    return 0


def draw_scenario(file: Path, output: Path) -> None:
    """The runs that the scenario compares, with the path"""
    runs = open_runs(str(file), (), None)
    picture.draw(runs[0].title, runs, usual(runs[0].result), output, path=True)


def scenario(arguments: list[str] | None = None) -> int:
    """0: drawn; 2: the request makes no sense; 3: an FMU refused"""
    options = parse("picture", arguments)
    file = find(options.file, SCENARIOS)
    output = output_file(options.output, f"{file.stem}.png", PICTURES)
    draw_scenario(file, output)
    print(output)
    return 0
