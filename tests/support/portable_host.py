"""tests/platforms/host.c and host3.c, importers that compile everywhere: how asked, what they answer"""

import itertools
import os
import zipfile
from pathlib import Path

import fmpy

from support.programs import finished
from support.sources import ROOT

# Outputs, of a scene those that it has, and how many numbers: separate in FMI 2.0, an array in FMI 3.0.
LENGTHS = {f"{body}.{name}": 3 for body in ("source", "destination") for name in ("position", "velocity")}
LENGTHS |= {"contact.gap": 0, "contact.peak_force": 0, "energy.dissipated": 0, "energy.friction": 0}
for body in ("source", "destination"):
    LENGTHS |= {f"{body}.orientation": 4, f"{body}.angular_velocity": 3}
LENGTHS |= {f"contact.{name}": 3 for name in ("mean_force", "mean_source_torque", "mean_destination_torque")}
STEPS = 37  # communication steps that no contact begins or ends at
PLATFORM_TESTS = ROOT / "tests" / "platforms"
SOURCE = PLATFORM_TESTS / "host.c"
SOURCES = {2: SOURCE, 3: PLATFORM_TESTS / "host3.c"}  # by version of FMI
HEADERS = Path(fmpy.__file__).parent / "c-code"


def unpacked(fmu, folder):
    """Unpacks the FMU into the folder and returns the folder."""
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


def components(name, length):
    return [f"{name}[{k + 1}]" for k in range(length)] if length else [name]


def outputs(about):
    """Returns names of what the host for FMI 2.0 prints after the time."""
    there = {variable.name for variable in about.modelVariables}
    names = [one for name, length in LENGTHS.items() for one in components(name, length)]
    return [name for name in names if name in there]


def host_arguments(folder, configuration, end):
    """Returns start values and outputs as the hosts take them, by value references."""
    about = fmpy.read_model_description(str(folder))
    by_name = {variable.name: variable for variable in about.modelVariables}
    words = [about.guid, str(end), str(STEPS)]
    if about.fmiVersion.startswith("3"):
        words += _of_arrays(by_name, configuration)
    else:
        for variable, value in settings(about, configuration):
            words += ["r" if variable.type == "Real" else "i", variable.valueReference, value]
        for name in outputs(about):
            words += ["get", by_name[name].valueReference]
    return [str(word) for word in words]


def _of_arrays(by_name, configuration):
    """As host3.c takes them: how many values, and the values of floating point variables"""
    for name, value in configuration.items():
        variable = by_name[name]
        if variable.type == "Enumeration":
            (number,) = [item.value for item in variable.declaredType.items if item.name == value]
            yield from ("i", variable.valueReference, number)
        else:
            values = value if isinstance(value, list) else [value]
            yield from ("f", variable.valueReference, len(values), *values)
    for name, length in LENGTHS.items():
        if name in by_name:
            yield from ("get", by_name[name].valueReference, length or 1)


def motion(host, library, folder, configuration, end, environment=None):
    """Returns the host's output: a line of time and outputs each step. `host` begins its command."""
    command = [*map(str, host), str(library), *host_arguments(folder, configuration, end)]
    run = finished(command, env={**os.environ, **(environment or {})})
    assert run.returncode == 0, run.stderr
    assert len(run.stdout.splitlines()) == STEPS
    return run.stdout


def numbers(text):
    return [[float(word) for word in line.split()] for line in text.splitlines()]


def difference(text, reference):
    pairs = zip(itertools.chain(*numbers(text)), itertools.chain(*numbers(reference)), strict=True)
    return max(abs(a - b) / max(1.0, abs(b)) for a, b in pairs)
