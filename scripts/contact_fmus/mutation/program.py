"""The C code built file by file, so that a change costs the compilation of one file.

Everything follows from the commands of the build that stands already: the flags and sources of a scene from
its one unit, the C tests from their own compilation. Each scene becomes one shared library, which serves as
the library inside its FMU and as what the C tests are linked to.
"""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
import zipfile
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property
from pathlib import Path

OPTIMIZATION = "-O1"
_LAUNCHER = re.compile(r"^\S*\b(ccache|sccache|distcc) ")  # CMAKE_C_COMPILER_LAUNCHER, before the compiler
_DROPPED = ("-O", "-flto", "-fno-fat-lto", "-g", "-MD", "-W", "-fvisibility", "-ffile-prefix-map")


class Program:
    """The FMUs and C tests of `build`, made of a copy of `source`, with everything it makes in `folder`"""

    def __init__(self, source: Path, build: Path, folder: Path):
        self.source, self.build, self.folder = source, build, folder
        self.commands = json.loads(_output(["ninja", "-C", str(build), "-t", "compdb"]))
        for command in self.commands:
            command["command"] = _LAUNCHER.sub("", command["command"])
        self.copies = {}  # slot: folder with a copy of the source

    @cached_property
    def scenes(self) -> list[str]:
        """Scenes that have a library and an FMU"""
        fmus = sorted((self.build / "fmus").glob("*.fmu"))
        return [fmu.stem for fmu in fmus if (self.build / "libraries" / f"{fmu.stem}.so").is_file()]

    @cached_property
    def main_scenes(self) -> list[str]:
        """Those the C tests are linked to, the one with every choice open first"""
        named = {name for test in self.unit_tests if (name := _scene_of(self._test_command(test)))}
        return sorted(named, key=lambda name: (-len(self.units(name)), name))

    def copy(self, slot: str) -> Path:
        """The source as it is, in a folder of the slot's own"""
        if slot not in self.copies:
            to = self.folder / slot / "source"
            shutil.rmtree(to, ignore_errors=True)
            shutil.copytree(self.source, to)
            self.copies[slot] = to
        return self.copies[slot]

    def _unit_command(self, scene: str) -> dict:
        output = re.compile(rf"fmu_src/CMakeFiles/{scene}\.dir/.*\.o")
        return next(one for one in self.commands if output.fullmatch(one["output"]))

    def units(self, scene: str) -> list[str]:
        """The sources of a scene: relative to fmu_src, or the absolute path of a generated one"""
        text = Path(self._unit_command(scene)["file"]).read_text(encoding="utf-8")
        root = f"{self.source}/"
        return [name.removeprefix(root) for name in re.findall(r'#include "([^"]+)"', text)]

    def _flags(self, command: str) -> list[str]:
        words = iter(shlex.split(command)[1:])
        kept = []
        for word in words:
            if word in ("-o", "-c", "-MT", "-MF"):
                next(words)
            elif word == f"-I{self.source}":
                kept.append("-I.")
            elif not word.startswith(_DROPPED):
                kept.append(word)
        return kept

    def object_of(self, scene: str, unit: str, folder: Path, optimization: str = OPTIMIZATION) -> Path:
        return folder / scene / optimization / (unit.strip("/").replace("/", "-") + ".o")

    def compile(
        self, scene: str, units: list[str], slot: str, folder: Path, optimization: str = OPTIMIZATION
    ) -> str:
        """Compiles units as they stand in the slot's copy; returns what the compiler says against it"""
        compiler = shlex.split(self._unit_command(scene)["command"])[0]
        for unit in units:
            output = self.object_of(scene, unit, folder, optimization)
            output.parent.mkdir(parents=True, exist_ok=True)
            command = [compiler, *self._flags(self._unit_command(scene)["command"]), "-w", optimization]
            done = _run(
                [*command, "-MMD", "-MF", f"{output}.d", "-c", unit, "-o", str(output)], self.copy(slot)
            )
            if done.returncode != 0:
                return done.stderr
        return ""

    def link(self, scene: str, objects: list[Path], library: Path) -> None:
        command = next(one for one in self.commands if one["output"] == f"libraries/{scene}.so")["command"]
        needed = [word for word in shlex.split(command) if word.endswith(".a") or word.startswith("-l")]
        library.parent.mkdir(parents=True, exist_ok=True)
        compiler = shlex.split(self._unit_command(scene)["command"])[0]
        options = ["-shared", "-Wl,-Bsymbolic", f"-Wl,-soname,{scene}.so"]
        done = _run([compiler, *options, *map(str, objects), *needed, "-o", str(library)], self.build)
        if done.returncode != 0:
            raise RuntimeError(done.stderr)

    def pack(self, scene: str, library: Path, fmus: Path) -> None:
        """The FMU of the build with another library in it"""
        fmus.mkdir(parents=True, exist_ok=True)
        with (
            zipfile.ZipFile(self.build / "fmus" / f"{scene}.fmu") as original,
            zipfile.ZipFile(fmus / f"{scene}.fmu", "w") as changed,
        ):
            for name in original.namelist():
                if name.endswith(".so"):
                    changed.write(library, name)
                elif not name.startswith("documentation"):
                    changed.writestr(name, original.read(name))

    @property
    def base(self) -> Path:
        return self.folder / "base"

    def make_scene(self, scene: str, jobs: int = 1) -> None:
        """Objects, library and FMU of the code as it is"""
        units = self.units(scene)
        self.copy("base")
        if (self.base / "fmus" / f"{scene}.fmu").is_file() and (
            self.base / "libraries" / f"{scene}.so"
        ).is_file():
            return
        with ThreadPoolExecutor(jobs) as pool:
            said = pool.map(lambda unit: self.compile(scene, [unit], "base", self.base), units)
        if wrong := "".join(said):
            raise RuntimeError(wrong)
        library = self.base / "libraries" / f"{scene}.so"
        self.link(scene, [self.object_of(scene, unit, self.base) for unit in units], library)
        self.pack(scene, library, self.base / "fmus")

    def readers(self, scene: str, file: str) -> list[str]:
        """The units of a scene that a change of the file changes"""
        units = self.units(scene)
        if file.endswith(".c"):
            return [file] if file in units else []
        return [unit for unit in units if _reads(Path(f"{self.object_of(scene, unit, self.base)}.d"), file)]

    # The C tests

    @cached_property
    def unit_tests(self) -> list[str]:
        """Names of the programs in tests/unit"""
        found = re.compile(r"tests/CMakeFiles/unit_(\w+)\.dir/.*\.o")
        return sorted(match[1] for one in self.commands if (match := found.fullmatch(one["output"])))

    def _test_command(self, test: str) -> dict:
        output = re.compile(rf"tests/CMakeFiles/unit_{test}\.dir/.*\.o")
        return next(one for one in self.commands if output.fullmatch(one["output"]))

    def scene_of_test(self, test: str) -> str:
        return _scene_of(self._test_command(test)) or self.main_scenes[0]

    def make_test(self, test: str, slot: str, folder: Path) -> str:
        """The program, from the slot's headers and libraries; what the compiler says against it

        It finds its scene's library where LD_LIBRARY_PATH says.
        """
        entry = self._test_command(test)
        words = shlex.split(entry["command"])
        program = folder / "unit" / test
        program.parent.mkdir(parents=True, exist_ok=True)
        library = self.base / "libraries" / f"{self.scene_of_test(test)}.so"
        flags = [*self._flags(entry["command"]), "-w", OPTIMIZATION, "-MMD", "-MF", f"{program}.d"]
        command = [words[0], *flags, entry["file"], str(library), "-lm", "-o", str(program)]
        return _run(command, self.copy(slot)).stderr

    def tests_that_read(self, file: str) -> list[str]:
        """Those whose program is another one when the header changes"""
        return [test for test in self.unit_tests if _reads(self.base / "unit" / f"{test}.d", file)]

    def needs(self, test: str, file: str) -> bool:
        """Whether the test's program calls a function of the file itself"""
        scene = self.scene_of_test(test)
        if file not in self.units(scene):
            return False
        # Undefined there, or data of the library that the linker has copied into the program.
        names = ["nm", "--dynamic", "--format=just-symbols", str(self.base / "unit" / test)]
        wanted = set(_output(names).split())
        given = _output(
            ["nm", "--defined-only", "--format=just-symbols", str(self.object_of(scene, file, self.base))]
        ).split()
        return not wanted.isdisjoint(given)


def _reads(dependencies: Path, file: str) -> bool:
    return file in dependencies.read_text(encoding="utf-8").replace("\\\n", " ").split()


def _scene_of(entry: dict) -> str | None:
    found = re.search(r"/scenes/(\w+)", entry["command"])
    return found[1] if found else None


def _run(command: list[str], folder: Path) -> subprocess.CompletedProcess:
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def _output(command: list[str]) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout
