"""The model for C users: installed, found by CMake, linked by examples/c without FMI"""

import re

import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu
from contact_fmus.fmu.files import fmu_file
from support.programs import checked
from support.sources import BUILD, ROOT


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("installed")
    checked(["cmake", "--install", BUILD, "--component", "c", "--prefix", folder])
    return folder


@pytest.fixture(scope="module")
def said(installed, tmp_path_factory):
    """Lines of numbers: time, height, gap"""
    build = tmp_path_factory.mktemp("bounce")
    options = [f"-DCMAKE_PREFIX_PATH={installed}", "-DCMAKE_C_FLAGS=-Wall -Wextra -pedantic -Werror"]
    checked(["cmake", "-S", ROOT / "examples" / "c", "-B", build, *options])
    checked(["cmake", "--build", build])
    lines = checked([build / "bounce"]).splitlines()
    return [[float(word) for word in re.findall(r"-?\d[\d.e-]*", line)] for line in lines]


def test_the_example_has_the_numbers_of_the_fmu(said):
    with ContactFmu(fmu_file("SphereSphere")) as fmu:
        fmu.start({"source.center": [0.03, 0.04, 1.1], "contact.dashpot": "unclamped"}, tolerance=1e-10)
        for time, height, gap in said:
            fmu.step(0.125)
            assert (time, height, gap) == (fmu.time, fmu["source.position"][2], fmu["contact.gap"])
    assert len(said) == 12


def test_every_installed_header_compiles_alone(installed, tmp_path):
    headers = installed / "include" / "contact_fmus"
    names = sorted(file.relative_to(headers).as_posix() for file in headers.rglob("*.h"))
    assert "model/model.h" in names
    for name in names:
        file = tmp_path / "alone.c"
        file.write_text(f'#include "{name}"\nint alone;\n')
        warnings = ["-std=c11", "-Wall", "-Wextra", "-pedantic", "-Werror"]
        checked(["gcc", *warnings, "-fsyntax-only", f"-I{headers}", file])
