"""Reference results inside the FMUs: valid by fmi-ls-ref 1.0.0-beta.1, and equal to what a new run gives."""

import csv
import importlib.util
import json
import re
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from lxml import etree

from contact_fmus.fmu.files import fmu_file
from support.fmi2.raw import SCENES

FOLDER = "extra/org.fmi-standard.fmi-ls-ref/"
SPACE = "{http://fmi-standard.org/fmi-ls-manifest}"
# As schema/fmi3LayeredStandardReferenceManifest.xsd of the tag v1.0.0-beta.1 has them.
ATTRIBUTES = {
    f"{SPACE}fmi-ls-name": "org.fmi-standard.fmi-ls-ref",
    f"{SPACE}fmi-ls-version": "1.0.0-beta.1",
    f"{SPACE}fmi-ls-description": (
        "Layered Standard providing information on related files included in an FMU."
    ),
}
ROLES = (
    "document|requirement|specification|model|parameter|system|testcase|"
    "experiment(/(smoke-test|validation|uncertainty-analysis))?|result|method|rationale|report|request|delivery|"
    "configuration|signature|serialized-state(/.*)?|meta-data|other"
)
SCHEMAS = Path(importlib.util.find_spec("fmpy").origin).parent / "ssp" / "schema"


def related(scene):
    """Files of the manifest by their roles"""
    with zipfile.ZipFile(fmu_file(scene)) as fmu:
        root = etree.fromstring(fmu.read(f"{FOLDER}fmi-ls-manifest.xml"))
        inside = {name.removeprefix(FOLDER) for name in fmu.namelist() if name.startswith(FOLDER)}
        assert (root.tag, dict(root.attrib)) == ("fmiReferences", ATTRIBUTES)
        assert {one.tag for one in root} == {"Related"}
        assert all(set(one.attrib) <= {"type", "source", "role", "description"} for one in root)
        assert all(re.fullmatch(ROLES, one.get("role")) for one in root)
        assert {one.get("source") for one in root} == inside - {"fmi-ls-manifest.xml"}
        return {one.get("role"): fmu.read(FOLDER + one.get("source")).decode() for one in root}


def columns(text):
    names, *rows = csv.reader(text.splitlines())
    return dict(zip(names, np.array(rows, dtype=float).T, strict=True))


def run(scene, files, kind="CoSimulation", **start):
    """The experiment as an importer makes it of the files alone: the columns at the times of the result"""
    times, expected = json.loads(files["experiment/smoke-test"]), columns(files["result"])
    space = "{http://ssp-standard.org/SSP1/SystemStructureParameterValues}"
    values = {
        one.get("name"): one[0].get("value")
        for one in etree.fromstring(files["parameter"].encode()).iter(f"{space}Parameter")
    }
    names = [name for name in expected if name != "time"]
    found = fmpy.simulate_fmu(
        str(fmu_file(scene)), fmi_type=kind, start_values=values | start, output=names,
        start_time=times["start_time"], stop_time=times["stop_time"], output_interval=times["step_size"],
        relative_tolerance=times["tolerance"] if kind == "CoSimulation" else 1e-11,
    )  # fmt: skip
    rows = [int(np.argmin(np.abs(found["time"] - time))) for time in expected["time"]]
    return {name: found[name][rows] for name in expected}


@pytest.mark.parametrize("scene", SCENES)
def test_the_manifest_names_what_is_inside_and_a_new_run_gives_the_same_bits(scene):
    files = related(scene)
    assert set(files) == {"parameter", "experiment/smoke-test", "result", "testcase"}
    schema = etree.XMLSchema(etree.parse(SCHEMAS / "SystemStructureParameterValues.xsd"))
    schema.assertValid(etree.fromstring(files["parameter"].encode()))
    expected, found = columns(files["result"]), run(scene, files)
    assert len(expected["time"]) > 10
    for name, column in expected.items():
        assert np.array_equal(found[name], column), name


@pytest.mark.parametrize("scene", ["SphereCylinder", "BallInShell"])
def test_an_integrator_outside_comes_to_them_and_another_parameter_does_not(scene):
    """fmpy's CVODE moves the bodies of Model Exchange; the deviation allowed tells of another stiffness."""
    files = related(scene)
    expected, allowed = columns(files["result"]), json.loads(files["testcase"])["allowed"]

    def deviation(found):
        names = [name for name in expected if name.endswith("]") and np.any(expected[name])]
        return max(np.max(np.abs(found[n] - expected[n])) / np.max(np.abs(expected[n])) for n in names)

    assert deviation(run(scene, files, "ModelExchange")) < allowed
    assert deviation(run(scene, files, **{"contact.penalty_factor": 1.001e6})) > allowed
