"""The commands build and new"""

import json
import os
import platform
import re
import shutil
import sys
import tempfile
import time
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import jinja2
from rich.console import Console

from contact_fmus.errors import UserError
from contact_fmus.fmu.files import repository
from contact_fmus.options import parse

from .cmake_build import How, Scene, build_fmus, check_scene, find_compiler
from .platforms import join, toolchains

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
# The scene files that `contact-fmus new` writes: a free ball that bounces, or one of SCENES
SHAPES = tomllib.loads(Path(__file__).with_name("shapes.toml").read_text(encoding="utf-8"))
TEMPLATE = Path(__file__).with_name("scene.toml")
SCENES = SHAPES["scenes"]


def scene_text(name: str, scene: str | None, shape: str, inside: bool, pinned: list[str]) -> str:
    """The text of the scene file; UserError for a name or a choice that cannot be one"""
    if not NAME.fullmatch(name):
        raise UserError(f"'{name}' is no name of a scene: a letter, then letters, digits and _")
    if scene:
        if inside or pinned or shape != "sphere":
            raise UserError("--scene goes without --shape, --inside and --pinned: it is a whole scene")
        file = repository() / "modelDescription" / "scenes" / f"{SCENES[scene]}.toml"
        return file.read_text(encoding="utf-8").replace(f'"{SCENES[scene]}"', f'"{name}"')
    if shape == "plane" and inside:
        raise UserError("--inside goes with a sphere, a cylinder or a torus: a plane has no inside")
    about = SHAPES[f"{shape} inside" if inside else shape]
    body = about["body"]
    chosen = {name.format(body=body): value for name, value in SHAPES["pinned"].items()}
    if shape == "plane":  # which has no inside
        del chosen["contact.location"]
    elif inside:
        chosen["contact.location"] = "inside"
    chosen |= dict(_choice(text) for text in pinned)
    start = {key: value for key, value in about["start"].items() if key not in chosen}
    template = jinja2.Template(TEMPLATE.read_text(encoding="utf-8"), trim_blocks=True, keep_trailing_newline=True)
    return template.render(name=name, shape=shape, inside=inside, body=body, start=_lines(start), pinned=_lines(chosen))


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


def build(arguments: list[str] | None = None) -> int:
    """0: the FMUs are there; 2: a scene or the compiler will not do; 3: building failed"""
    options = parse("build", arguments)
    for file in options.scenes:
        if not file.is_file():
            raise UserError(f"{file}: there is no such file")
    if options.sundials_source and not (options.sundials_source / "src" / "cvode").is_dir():
        raise UserError(f"--sundials-source: {options.sundials_source} has no folder src/cvode")
    wanted = toolchains(options.platforms) if options.platforms is not None else [None]
    begin = time.monotonic()
    scenes = _checked(options.scenes)
    compiler = find_compiler(options.compiler, options.platforms)
    options.output.mkdir(parents=True, exist_ok=True)
    made = []
    with _progress() as say:
        for toolchain in wanted:
            what = ", ".join(scene.name for scene in scenes) + (f" for {toolchain}" if toolchain else "")
            how = How(tuple(compiler), toolchain, options.sundials_source, options.fmi, options.choices)
            made.append(build_fmus(scenes, how, lambda text, what=what: say(f"{what}: {text}")))
            if toolchain in (None, f"{platform.machine()}-{platform.system().lower()}"):
                say(f"{what}: initializing")
                for scene, fmu in zip(scenes, made[-1], strict=True):
                    _expect_to_initialize(scene, fmu)
    for scene, of_platforms in zip(scenes, zip(*made, strict=True), strict=True):
        fmu = options.output / f"{scene.name}.fmu"
        if len(of_platforms) == 1:
            shutil.copyfile(of_platforms[0], fmu)
        else:
            join(list(of_platforms), fmu)
        size, made_by, seconds = fmu.stat().st_size, " ".join(compiler), round(time.monotonic() - begin, 1)
        about = json.dumps({"fmu": str(fmu), "bytes": size, "compiler": made_by, "seconds": seconds})
        print(about if options.json else f"{fmu}: {size / 1e3:.0f} kB by {made_by} in {seconds} s")
    return 0


@contextmanager
def _progress() -> Iterator[Callable[[str], None]]:
    """Tells on stderr what is being done: in a line that changes on a terminal, else line by line"""
    console = Console(stderr=True)
    if console.is_terminal:
        with console.status("") as status:
            yield status.update
    else:
        yield lambda text: print(text, file=sys.stderr, flush=True)


def _expect_to_initialize(scene: Scene, fmu: Path) -> None:
    """UserError with the FMU's own sentence where the start values of the scene contradict each other"""
    from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError, Status

    with ContactFmu(fmu) as instance:
        try:
            instance.start()
        except FmuError as error:
            told = [message.text for message in error.messages if message.status >= Status.DISCARD]
            raise UserError(f"{scene.file}: this scene cannot run: {' '.join(told) or error}") from None


def _checked(files: list[Path]) -> list[Scene]:
    """UserError where the generator has a complaint, or two scenes would make the same file"""
    scenes: dict[str, Scene] = {}
    for file in files:
        with tempfile.TemporaryDirectory() as folder:
            scene = check_scene(file, Path(folder))
        if scene.name in scenes:
            raise UserError(f"{file}: 'name' is '{scene.name}', as in {scenes[scene.name].file}")
        scenes[scene.name] = scene
    return list(scenes.values())


def new(arguments: list[str] | None = None) -> int:
    """0: written; 2: the name or a pinned choice makes no sense"""
    options = parse("new", arguments)
    file = options.output / f"{options.name}.toml"
    if file.exists() and not options.force:
        raise UserError(f"{file} exists: another name, or --force to overwrite it")
    text = scene_text(options.name, options.scene, options.shape, options.inside, options.pinned)
    with tempfile.TemporaryDirectory() as folder:  # so that nothing is written that cannot be built
        trial = Path(folder) / "new" / file.name
        trial.parent.mkdir()
        trial.write_text(text, encoding="utf-8")
        try:
            check_scene(trial, Path(folder))
        except UserError as error:
            raise UserError(str(error).replace(f"{trial.parent}{os.sep}", "")) from None
    options.output.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")
    print(f"{file}: build it with contact-fmus build {file}")
    return 0
