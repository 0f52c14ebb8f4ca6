"""Scene -> FMU by this project's own CMake files, in a folder of the user's cache

A folder for each tree, compiler and platform is kept: what CMake finds out about a compiler is found out
once.
"""

import fcntl
import hashlib
import importlib.util
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import platformdirs

from contact_fmus.errors import RunFailure, UserError
from contact_fmus.fmu.files import is_clone, repository

# Finds a C compiler that works: the one asked for, that of the variable CC, or a usual one

USUAL = ("gcc", "clang", "cc", "zig")
# What an FMU needs of a compiler: the C library's headers, which Debian's gcc does not bring.
TRIAL = "#include <math.h>\n#include <string.h>\ndouble half(double x) { return fabs(x) / 2.0; }\n"
ZIG_ADVICE = "pip install 'contact-fmus[zig]'"
ADVICE = f"apt-get install gcc libc6-dev, or take zig's from PyPI: {ZIG_ADVICE}"


def find_compiler(asked: str | None, platforms: str | None = None) -> list[str]:
    """Program and fixed arguments, such as [".../ziglang/zig", "cc"]; UserError where none works, or none for these
    platforms, which are zig's"""
    tried, chosen = [], "zig" if platforms else asked or os.environ.get("CC")
    for name in [chosen] if chosen else USUAL:
        command = _command(name)
        if command is None:
            tried.append(f"{name}: not found")
            continue
        complaint = _complaint(command)
        if complaint is None:
            return command
        tried.append(f"{name}: {complaint}")
    if platforms:
        raise UserError(
            f"--platforms {platforms} needs zig, which compiles for any platform ({tried[0]}): {ZIG_ADVICE}"
        )
    raise UserError(f"no C compiler that works ({'; '.join(tried)}): {ADVICE}")


def _command(name: str) -> list[str] | None:
    if name == "zig":
        program = _packaged("ziglang", "zig") or shutil.which("zig")
        return [program, "cc"] if program else None
    program, *arguments = shlex.split(name)
    found = shutil.which(program)
    return [found, *arguments] if found else None


def _packaged(package: str, program: str) -> str | None:
    """The program that a Python package brings"""
    found = importlib.util.find_spec(package)
    if found is None or found.origin is None:
        return None
    folder = Path(found.origin).parent
    files = (folder / "data" / "bin" / program, folder / program)
    return next((str(file) for file in files if file.is_file()), None)


def _complaint(command: list[str]) -> str | None:
    """The compiler's first error for a small file, None where it compiles"""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "trial.c"
        file.write_text(TRIAL, encoding="utf-8")
        run = subprocess.run(
            [*command, "-c", str(file), "-o", str(file.with_suffix(".o"))],
            capture_output=True,
            text=True,
            check=False,
            stdin=subprocess.DEVNULL,
        )
    if run.returncode == 0:
        return None
    lines = [line.partition("error: ")[2] for line in run.stderr.splitlines() if "error: " in line]
    return lines[0] if lines else f"ends with status {run.returncode}"


# A user's own flags may let a compiler choose digits; cmake/ContactWarnings.cmake has those of all FMUs.
FLAGS_OF_OTHERS = ("CFLAGS", "CPPFLAGS", "LDFLAGS", "CC")

# zig compiles a run-time library, in seconds, once for each kind of build: here one kind for CMake's trials
# and for FMUs alike. -s leaves symbols out, since strip may not be installed; zig takes it when it compiles
# as well, and CMake's first trial, which knows no flags of the linker, would else have one of its own.
ZIG = {"CMAKE_C_FLAGS": "-O2 -s"}

# What ninja prints when a step has ended
STEP = re.compile(r"\[([1-9]\d*)/(\d+)\]")
# CMake's names of the projects that fetch SUNDIALS
FETCHING_FAILED = re.compile(r"sundials-(?:subbuild|populate)")


@dataclass(frozen=True)
class Scene:
    """A scene file that the generator has no complaint about"""

    file: Path
    name: str
    has_cvode: bool


@dataclass(frozen=True)
class How:
    """What makes the FMU, and for which version of the standard"""

    compiler: tuple[str, ...]
    toolchain: str | None = None  # a file of cmake/platforms, which is zig's; None: for this machine
    sundials: Path | None = None  # a checkout, where the toolchain needs the sources
    fmi: int = 2
    choices: str = ""  # "integer" or "enumeration"; empty: as the scene file says


def check_scene(file: Path, folder: Path) -> Scene:
    """What the generator says of the scene; what it warns of goes to stderr"""
    generator = repository() / "modelDescription" / "generate.py"
    if file.suffix == ".fmu":
        raise UserError(f"{file}: this is an FMU; a scene (.toml) is needed")
    command = [sys.executable, "-B", str(generator), "--scene", str(file), "--output", str(folder)]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if run.returncode == 2:
        raise UserError(" ".join(run.stderr.split()))
    if run.returncode != 0:
        raise RunFailure(f"{file}: the generator failed: {run.stderr.strip().splitlines()[-1]}")
    sys.stderr.write(run.stderr)
    text = (folder / "scene.cmake").read_text(encoding="utf-8")

    def told(name: str) -> str:
        return text.partition(f"set({name} ")[2].partition(")")[0].strip('"')

    return Scene(file, told("SCENE_NAME"), told("SCENE_HAS_CVODE") == "ON")


def build_fmus(scenes: list[Scene], how: How, say: Callable[[str], None]) -> list[Path]:
    """The FMUs in the cache; RunFailure with the compiler's first error where one cannot be built

    `say` hears of each step, the first time before anything takes long."""
    kind = "_fmi3" if how.fmi == 3 else ""
    about = ", ".join(str(scene.file) for scene in scenes)

    def count(line: str) -> None:
        if step := STEP.match(line):
            say(f"compiling, {step[1]} of {step[2]} steps done")

    with _folder(how, say) as folder:
        log = folder.with_suffix(".log")
        say("configuring")
        status, said = _run(_configuration(scenes, how, folder), log, how)
        if status != 0 and FETCHING_FAILED.search(said):
            raise RunFailure(_without_sundials(scenes, how))
        _expect_done(status, said, about, log)
        say("compiling")
        targets = [f"{scene.name}{kind}_fmu" for scene in scenes]
        command = [_program("cmake"), "--build", str(folder), "--target", *targets]
        _expect_done(*_run(command, log, how, count), about, log)
        finished = [folder.with_name(f"{scene.name}{kind}.fmu") for scene in scenes]
        for scene, fmu in zip(scenes, finished, strict=True):
            shutil.copyfile(folder / f"fmus{kind.replace('_', '-')}" / f"{scene.name}.fmu", fmu)
        return finished


def _configuration(scenes: list[Scene], how: How, folder: Path) -> list[str]:
    for scene in scenes:
        if ";" in str(scene.file):
            raise UserError(f"{scene.file}: CMake takes no path with a semicolon")
    values = {
        "CMAKE_BUILD_TYPE": "Release",
        "CMAKE_TRY_COMPILE_CONFIGURATION": "Release",
        "CMAKE_MAKE_PROGRAM": _program("ninja"),
        "Python3_EXECUTABLE": sys.executable,
        "CONTACT_SCENES": ";".join(str(scene.file.resolve()) for scene in scenes),
        "CONTACT_CHOICES": how.choices,
    }
    needs_sundials = any(scene.has_cvode for scene in scenes)
    values["CONTACT_SUNDIALS"] = "none" if not needs_sundials else "fetch" if how.toolchain or how.sundials else "auto"
    values["FETCHCONTENT_SOURCE_DIR_SUNDIALS"] = str(how.sundials.resolve()) if how.sundials else ""
    if how.toolchain is not None:
        values["CMAKE_TOOLCHAIN_FILE"] = str(repository() / "cmake" / "platforms" / f"{how.toolchain}.cmake")
    else:
        values["CMAKE_C_COMPILER"] = ";".join(how.compiler)
        if Path(how.compiler[0]).name == "zig":
            values |= ZIG
    definitions = [f"-D{name}={value}" for name, value in values.items()]
    return [
        *(_program("cmake"), "-Wno-dev", "-G", "Ninja"),
        *("-S", str(repository()), "-B", str(folder), *definitions),
    ]


def _program(name: str) -> str:
    """Finds the program in its Python package, which is new enough, else on the system"""
    folders = os.pathsep.join([str(Path(sys.executable).parent), os.defpath])
    found = _packaged(name, name) or shutil.which(name, path=folders) or shutil.which(name)
    if found is None:
        raise UserError(f"{name} is missing: pip install {name}")
    return found


@contextmanager
def _folder(how: How, say: Callable[[str], None]) -> Iterator[Path]:
    """The build folder of this compiler and platform, for one build at a time; it is made anew after an update"""
    about = "\n".join([str(repository()), *how.compiler, how.toolchain or "", sys.executable])
    name = hashlib.sha256(about.encode()).hexdigest()[:12]
    folder = Path(platformdirs.user_cache_path("contact-fmus")) / name / "build"
    folder.parent.mkdir(parents=True, exist_ok=True)
    with (folder.parent / "lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say("waiting for another build")
            fcntl.flock(lock, fcntl.LOCK_EX)
        stamp = folder.parent / "tree"
        if not stamp.is_file() or stamp.read_text(encoding="utf-8") != _tree():
            shutil.rmtree(folder, ignore_errors=True)
            stamp.write_text(_tree(), encoding="utf-8")
        yield folder


def _tree() -> str:
    """A digest of an installed package, which differs after an update, whose files may be older than the last build.
    In a clone CMake sees by itself what has changed."""
    if is_clone():
        return "clone"
    files = sorted(file for file in repository().rglob("*") if file.is_file())
    about = "\n".join(f"{file} {file.stat().st_size} {file.stat().st_mtime_ns}" for file in files)
    return hashlib.sha256(about.encode()).hexdigest()


def _run(command: list[str], log: Path, how: How, hear: Callable[[str], None] = lambda _line: None) -> tuple[int, str]:
    """The status and what was printed, which `log` keeps; `hear` gets each line of it at once"""
    environment = {name: value for name, value in os.environ.items() if name not in FLAGS_OF_OTHERS}
    environment["NINJA_STATUS"] = "[%f/%t] "
    if how.toolchain is not None:
        environment["CONTACT_ZIG_PROGRAM"] = how.compiler[0]
    lines = []
    with subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        env=environment,
    ) as process:
        for line in process.stdout or ():
            lines.append(line)
            hear(line)
    log.write_text("".join(lines), encoding="utf-8")
    return process.returncode, "".join(lines)


def _expect_done(status: int, said: str, about: str, log: Path) -> None:
    if status != 0:
        lines = [line.strip() for line in said.splitlines() if "error" in line.lower()]
        first = lines[0] if lines else f"the build ended with status {status}"
        raise RunFailure(f"{about}: building failed: {first} (all of it: {log})")


def _without_sundials(scenes: list[Scene], how: How) -> str:
    """Why SUNDIALS was wanted, and both ways to do without fetching it"""
    names = ", ".join(str(scene.file) for scene in scenes if scene.has_cvode)
    place = f" for {how.toolchain}" if how.toolchain else ""
    return (
        f"{names}: solver.method is open, so the FMU{place} holds CVODE, and the sources of SUNDIALS cannot "
        'be fetched; pin "solver.method" = "event_driven" in the scene file, or name a folder of them '
        "with --sundials-source"
    )
