"""The sources as the architecture tests see them: files, layers, compiler calls."""

import importlib.util
import os
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "fmu_src"
BUILD = Path(os.environ.get("CONTACT_BUILD", ROOT / "build")).resolve()

# The order in which data flows; a file includes its own layer and those before it.
LAYERS = ("math", "contact", "scene", "flight", "prescribed", "touch", "integrator", "model", "fmi", "fmi2")
LAYERS += ("fmi3",)
ADAPTERS = ("fmi2", "fmi3")  # side by side: neither includes the other
COMPILERS = ("gcc", "clang")
WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wdouble-promotion"]
WARNINGS += ["-Wmissing-prototypes", "-Werror"]

HEADERS = sorted(SOURCE.rglob("*.h"))
UNITS = sorted(SOURCE.rglob("*.c"))
HOST_SOURCES = sorted((ROOT / "scripts" / "tools" / "fmu_host").glob("*.c"))
# A universal scene, a small one with its choices pinned, and a force element: together they have all code.
SCENES = ("SphereCylinder", "PinnedEvent", "ForceElement")


def label(path):
    return path.relative_to(ROOT).as_posix()


def layer(path):
    return path.relative_to(SOURCE).parts[0]


def units_of(scene, adapter=None):
    """Returns the sources that CMake compiles for the scene, for one adapter or all, generated ones too."""
    files = {"fmi2": "units.txt", "fmi3": "units3.txt"}
    lists = [(BUILD / "scenes" / scene / files[a]).read_text() for a in ADAPTERS if adapter in (None, a)]
    return [Path(line) for line in dict.fromkeys(line for text in lists for line in text.splitlines())]


def headers_of(scene):
    """Returns the headers that they include, directly or by way of others."""
    found = set()
    ahead = units_of(scene)
    while ahead:
        inner = {SOURCE / name for name, quoted in includes(ahead.pop()) if quoted and "/" in name} - found
        found |= inner
        ahead += inner
    return sorted(found)


def python_files():
    folders = ("cmake", "modelDescription", "scripts", "tests")
    return sorted(path for folder in folders for path in (ROOT / folder).rglob("*.py"))


def includes(path):
    """(text between the brackets or quotes, whether quotes) of each include."""
    return [
        (match[2], match[1] == '"')
        for match in re.finditer(r'^\s*#\s*include\s*(["<])([^">]+)', path.read_text(), re.MULTILINE)
    ]


def fmi_headers():
    return Path(importlib.util.find_spec("fmpy").origin).parent / "c-code"


def code_only(text):
    """C without comments and without the contents of strings; the lines stay where they are."""

    def blank(match):
        kept = '""' if match[0].startswith('"') else " "
        return kept + "\n" * match[0].count("\n")

    return re.sub(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', blank, text, flags=re.DOTALL)


def compile_c(compiler, file, scene, *options):
    """Runs the compiler on the file as the scene's code; returns what it says, nothing when it is content."""
    command = [
        *(compiler, "-std=c11", *WARNINGS, *options),
        *(f"-I{SOURCE}", f"-I{BUILD / 'scenes' / scene}", "-isystem", str(fmi_headers())),
        str(file),
    ]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    return run.stderr or ("" if run.returncode == 0 else f"exit code {run.returncode}")
