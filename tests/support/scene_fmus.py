"""The FMUs of the scenes that only tests have, in a build of their own. The ordinary build makes them too, so
that tests find them there and make only what has changed since."""

import fcntl
import sys

from support.programs import checked
from support.sources import BUILD, ROOT

FOLDER = BUILD / "tests" / "scenes"
SCENES = sorted((ROOT / "tests" / "physics" / "scenes").glob("*.toml"))
PLAIN = {"LD_PRELOAD": ""}  # a sanitizer is the tests' own


def built():
    """Returns the file of each scene by its name. One process at a time makes missing files."""
    found = {scene.stem: FOLDER / "fmus" / f"{scene.stem}.fmu" for scene in SCENES}
    FOLDER.mkdir(parents=True, exist_ok=True)
    with (FOLDER / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not all(file.exists() for file in found.values()):
            configure()
        checked(["cmake", "--build", FOLDER], environment=PLAIN)
    return found


def configure():
    """Their bits are those of Release, and they are built sooner."""
    options = {"CONTACT_SCENES": ";".join(map(str, SCENES)), "Python3_EXECUTABLE": sys.executable}
    options |= {"CMAKE_BUILD_TYPE": "Debug", "CMAKE_C_FLAGS_DEBUG": "-O1", "CONTACT_FMI3": "OFF"}
    given = [f"-D{name}={value}" for name, value in options.items()]
    checked(["cmake", "-S", ROOT, "-B", FOLDER, "-G", "Ninja", *given], environment=PLAIN)


if __name__ == "__main__":
    built()
