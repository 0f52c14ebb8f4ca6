"""tests/platforms/host.c, the importer that compiles everywhere: how it is asked, what it answers"""

import itertools
import os
import subprocess
import zipfile
from pathlib import Path

import fmpy

from support.sources import ROOT

OUTPUTS = [f"source.{name}[{axis}]" for name in ("position", "velocity") for axis in (1, 2, 3)]
OUTPUTS += ["contact.gap", "contact.peak_force", "energy.dissipated"]
STEPS = 37  # communication steps that no contact begins or ends at
SOURCE = ROOT / "tests" / "platforms" / "host.c"
HEADERS = Path(fmpy.__file__).parent / "c-code"


def unpacked(fmu, folder):
    """The folder, with the FMU in it"""
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder)
    return folder


def settings(about, configuration):
    """(variable, value) of one number each: of vectors three, of an enumeration's names their numbers"""
    by_name = {variable.name: variable for variable in about.modelVariables}
    for name, value in configuration.items():
        parts = value if isinstance(value, list) else [value]
        names = [f"{name}[{i + 1}]" for i in range(3)] if isinstance(value, list) else [name]
        for one, part in zip(names, parts, strict=True):
            variable = by_name[one]
            if variable.type == "Enumeration":
                (part,) = [item.value for item in variable.declaredType.items if item.name == part]
            yield variable, part


def host_arguments(folder, configuration, end):
    """Start values and outputs as host.c takes them, by value references"""
    about = fmpy.read_model_description(str(folder))
    words = [about.guid, str(end), str(STEPS)]
    for variable, value in settings(about, configuration):
        words += ["r" if variable.type == "Real" else "i", variable.valueReference, value]
    by_name = {variable.name: variable for variable in about.modelVariables}
    for name in OUTPUTS:
        if name in by_name:
            words += ["get", by_name[name].valueReference]
    return [str(word) for word in words]


def motion(host, library, folder, configuration, end, environment=None):
    """What host.c prints, a line of time and outputs for each step; host: the words that start it"""
    command = [*map(str, host), str(library), *host_arguments(folder, configuration, end)]
    run = subprocess.run(
        command, capture_output=True, text=True, timeout=300, env={**os.environ, **(environment or {})}
    )
    assert run.returncode == 0, run.stderr
    assert len(run.stdout.splitlines()) == STEPS
    return run.stdout


def numbers(text):
    return [[float(word) for word in line.split()] for line in text.splitlines()]


def difference(text, reference):
    pairs = zip(itertools.chain(*numbers(text)), itertools.chain(*numbers(reference)), strict=True)
    return max(abs(a - b) / max(1.0, abs(b)) for a, b in pairs)
