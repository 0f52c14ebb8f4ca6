"""The FMI 3.0 FMU as a file: valid, and the same variables as the FMI 2.0 FMU of its scene."""

import re
import xml.etree.ElementTree as ElementTree
import zipfile

import numpy as np
import pytest
from fmpy.validation import validate_fmu

from contact_fmus.fmu.files import fmu_file, unpack
from support.fmi2.elf import exported
from support.fmi3 import raw
from support.fmi3.raw import ARGUMENTS
from support.generator.generated import SUMS_UP

TYPES = {"Float64": "Real", "Int32": "Integer", "Boolean": "Boolean", "Enumeration": "Enumeration"}


@pytest.fixture(params=raw.SCENES)
def fmu(request):
    return raw.load(request.param)


def second(fmu):
    """The description of the FMI 2.0 FMU of the scene"""
    return unpack(fmu_file(fmu.name))[1]


def of_array(description, name):
    """Its scalars in the description of FMI 2.0"""
    return [one for one in description.modelVariables if one.name.partition("[")[0] == name]


def test_fmpy_and_the_schema_find_nothing(fmu, names_parsed_once):
    assert validate_fmu(str(raw.FMUS / f"{fmu.name}.fmu")) == []


def test_the_library_exports_the_functions_of_the_standard_and_nothing_else(fmu):
    assert exported(fmu.library_file) == {f"fmi3{name}" for name in ARGUMENTS}


def test_an_array_stands_for_the_scalars_of_fmi2(fmu):
    scalars = second(fmu)
    names = {one.name.partition("[")[0] for one in scalars.modelVariables}
    assert names | {"time"} == {one.name for one in fmu.description.modelVariables}
    for array in fmu.description.modelVariables[1:]:
        same = of_array(scalars, array.name)
        assert len(same) == fmu.variables[array.name].length
        first = same[0]
        assert array.valueReference == first.valueReference
        assert (TYPES[array.type], array.causality) == (first.type, first.causality)
        assert (array.unit, array.displayUnit, array.min, array.max, array.nominal) == (
            *(first.unit, first.displayUnit, first.min, first.max, first.nominal),
        )
        starts = [one.start for one in same]
        given = array.start if isinstance(array.start, list) else (array.start or "").split()
        assert [str(value) for value in given] == [value for value in starts if value is not None]


def test_what_sums_up_a_step_is_discrete(fmu):
    for variable in fmu.description.modelVariables[1:]:
        sums_up = variable.name.rpartition(".")[2] in SUMS_UP
        if variable.causality == "output":
            continuous = variable.type == "Float64" and not sums_up
            assert variable.variability == ("continuous" if continuous else "discrete"), variable.name


def dependencies(description):
    """Output -> {input: kind}, vectors as a whole"""
    return {
        (entry.variable.name.partition("[")[0]): {
            one.name.partition("[")[0]: kind
            for one, kind in zip(entry.dependencies, entry.dependenciesKind or [], strict=True)
        }
        for entry in description.outputs
    }


def test_the_model_structure_is_that_of_fmi2(fmu):
    assert dependencies(fmu.description) == dependencies(second(fmu))


def in_order(entries):
    """Names of arrays, each once, in the order of the entries"""
    return list(dict.fromkeys(entry.variable.name.partition("[")[0] for entry in entries))


def test_states_rates_and_unknowns_are_those_of_fmi2(fmu):
    third, scalars = fmu.description, second(fmu)
    assert in_order(third.derivatives) == in_order(scalars.derivatives)
    states = [[one.variable.derivative.name for one in about.derivatives] for about in (third, scalars)]
    assert states[0] == list(dict.fromkeys(name.partition("[")[0] for name in states[1]))
    assert in_order(third.initialUnknowns) == in_order(scalars.initialUnknowns)
    indicators = [entry.variable.name for entry in third.eventIndicators]
    assert indicators == [one.name for one in third.modelVariables if one.name.endswith("_indicator")]
    assert third.numberOfEventIndicators == scalars.numberOfEventIndicators
    assert third.numberOfContinuousStates == scalars.numberOfContinuousStates


def test_what_is_declared_of_model_exchange(fmu):
    """Only states that events make jump have reinit; the direction at a centre is kept at accepted steps."""
    root = ElementTree.parse(fmu.folder / "modelDescription.xml").getroot()
    declared = root.find("ModelExchange").attrib
    for name in ("canGetAndSetFMUState", "canSerializeFMUState", "needsCompletedIntegratorStep"):
        assert declared[name] == "true"
    assert declared["providesAdjointDerivatives"] == declared["providesDirectionalDerivatives"] == "true"
    jumping = {one.get("name") for one in root.find("ModelVariables") if one.get("reinit") == "true"}
    states = {one.get("name") for one in root.find("ModelVariables") if one.get("name").endswith("_state")}
    at_events = {"energy.dissipated_state", "energy.external_work_state", "energy.friction_state"}
    springs = {f"contact.{kind}spring_state" for kind in ("", "rolling_", "spinning_")}
    assert jumping == states & (at_events | springs)


def test_what_is_declared_of_steps(fmu):
    root = ElementTree.parse(fmu.folder / "modelDescription.xml").getroot()
    declared = root.find("CoSimulation").attrib
    still = ("ForceElement", "TurningForceElement")  # no body moves freely
    events = "false" if fmu.name in still else "true"
    for name in ("hasEventMode", "providesIntermediateUpdate", "mightReturnEarlyFromDoStep"):
        assert declared[name] == events
    assert declared["canReturnEarlyAfterIntermediateUpdate"] == events
    assert declared["providesAdjointDerivatives"] == declared["providesDirectionalDerivatives"] == "true"


def test_the_description_speaks_of_fmi3_only(fmu):
    assert re.findall(r"fmi2\w*|Slave", (fmu.folder / "modelDescription.xml").read_text()) == []


def test_documentation_and_licences_are_inside(fmu):
    names = zipfile.ZipFile(raw.FMUS / f"{fmu.name}.fmu").namelist()
    assert "documentation/index.html" in names
    assert "documentation/licenses/license.txt" in names
    assert f"binaries/x86_64-linux/{fmu.name}.so" in names


def test_start_values_are_those_of_the_description(fmu):
    words = {"true": 1.0, "false": 0.0}
    with raw.Instance(fmu) as instance:
        for variable in fmu.description.modelVariables:
            if variable.causality in ("parameter", "input"):
                text = variable.start if isinstance(variable.start, list) else str(variable.start).split()
                numbers = [words[one] if one in words else float(one) for one in text]
                assert np.array_equal(np.ravel(instance.get(variable.name)), numbers), variable.name
