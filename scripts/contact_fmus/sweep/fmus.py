"""The FMU that a study names: a file, a shipped name, or a scene that is built first"""

from __future__ import annotations

import atexit
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from contact_fmus.errors import RunFailure, UserError, similar
from contact_fmus.fmu.files import fmu_file, fmus_folder


def find_fmu(name: str, folder: Path) -> Path:
    """A file is looked for beside the study, then in the present folder"""
    where = "fmu"
    if Path(name).suffix in (".fmu", ".toml"):
        places = [folder / name, Path.cwd() / name]
        file = next((place for place in places if place.is_file()), None)
        if file is None:
            raise UserError(f"{where}: there is no file {places[0]}")
        return build_scene(file) if file.suffix == ".toml" else file.resolve()
    try:
        return Path(fmu_file(name))
    except (FileNotFoundError, UserError) as error:
        shipped = sorted(one.stem for one in fmus_folder().glob("*.fmu"))
        if not shipped:
            raise UserError(f"{where}: {error}") from None
        said = (
            f"{where}: '{name}' is no shipped FMU ({', '.join(shipped)}) and no file NAME.fmu or SCENE.toml"
        )
        raise UserError(said + similar(name, shipped)) from None


def build_scene(scene: Path) -> Path:
    """The scene's FMU, made by `contact-fmus build` in a folder that goes when the sweep ends"""
    target = Path(tempfile.mkdtemp(prefix=f"contact-{scene.stem}-"))
    atexit.register(shutil.rmtree, target, ignore_errors=True)
    command = [sys.executable, "-m", "contact_fmus", "build", str(scene), "-o", str(target)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    built = sorted(target.glob("*.fmu"))
    if done.returncode != 0 or len(built) != 1:
        lines = done.stderr.strip().splitlines() or ["no FMU came of it"]
        raise RunFailure(f"fmu: {scene} cannot be built: {lines[-1]}")
    return built[0]
