"""An FMU that ends the process it runs in: that run has a row that says so, and the others have theirs"""

import zipfile

import pyarrow.parquet as pq
import pytest

from support.programs import checked
from support.sources import fmi_headers
from support.sweeps import sweep

STUDY = """
outputs = { there = "x" }
fmu = "crashing.fmu"
experiment.stop_time = 1.0
vary.x = [1.0, 2.0, 3.0]
"""
DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Crashing" guid="g">
  <CoSimulation modelIdentifier="Crashing" canHandleVariableCommunicationStepSize="true"/>
  <ModelVariables>
    <ScalarVariable name="x" valueReference="0" causality="output" variability="discrete" initial="exact">
      <Real start="1.0"/>
    </ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="1"/></Outputs></ModelStructure>
</fmiModelDescription>
"""
# One number, kept as it is set; a step from 2 aborts. What a sweep loads and never needs here does nothing.
CODE = """
#include <stdlib.h>
#include "fmi2Functions.h"
static fmi2Real x;
fmi2Component fmi2Instantiate(fmi2String a, fmi2Type b, fmi2String c, fmi2String d,
    const fmi2CallbackFunctions *e, fmi2Boolean f, fmi2Boolean g) { return &x; }
void fmi2FreeInstance(fmi2Component c) {}
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean a, fmi2Real b, fmi2Real d, fmi2Boolean e,
    fmi2Real f) { return fmi2OK; }
#define PLAIN(name) fmi2Status name(fmi2Component c) { return fmi2OK; }
PLAIN(fmi2EnterInitializationMode) PLAIN(fmi2ExitInitializationMode) PLAIN(fmi2Reset) PLAIN(fmi2Terminate)
#define NUMBERS const fmi2ValueReference *r, size_t n
fmi2Status fmi2GetReal(fmi2Component c, NUMBERS, fmi2Real *v) { *v = x; return fmi2OK; }
fmi2Status fmi2SetReal(fmi2Component c, NUMBERS, const fmi2Real *v) { x = *v; return fmi2OK; }
fmi2Status fmi2GetInteger(fmi2Component c, NUMBERS, fmi2Integer *v) { return fmi2OK; }
fmi2Status fmi2SetInteger(fmi2Component c, NUMBERS, const fmi2Integer *v) { return fmi2OK; }
fmi2Status fmi2GetBoolean(fmi2Component c, NUMBERS, fmi2Boolean *v) { return fmi2OK; }
fmi2Status fmi2SetBoolean(fmi2Component c, NUMBERS, const fmi2Boolean *v) { return fmi2OK; }
fmi2Status fmi2SetString(fmi2Component c, NUMBERS, const fmi2String *v) { return fmi2OK; }
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean n)
    { if (x == 2.0) abort(); return fmi2OK; }
"""


@pytest.fixture
def crashing(tmp_path):
    code, library, made = (tmp_path / f"crashing.{kind}" for kind in ("c", "so", "fmu"))
    code.write_text(CODE)
    checked(["gcc", "-shared", "-fPIC", "-o", library, "-isystem", fmi_headers(), code])
    with zipfile.ZipFile(made, "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION)
        archive.write(library, "binaries/linux64/Crashing.so")
    return made


def test_a_run_that_ends_its_process_is_found_and_kept_as_a_row(tmp_path, crashing):
    study = crashing.with_name("study.toml")
    study.write_text(STUDY)
    assert "3 runs (2 ok, 1 crash)" in sweep(study, "-o", tmp_path / "out", "--workers", "1").stdout
    rows = pq.read_table(tmp_path / "out" / "results.parquet")
    assert rows["status"].to_pylist() == ["ok", "crash", "ok"]
    assert rows.column(2).to_pylist() == [1.0, None, 3.0]
    assert "ended" in rows["message"][1].as_py()
