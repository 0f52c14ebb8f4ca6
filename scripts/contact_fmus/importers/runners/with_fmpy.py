"""fmpy: the calls of the standard one by one"""

import tempfile
from importlib.metadata import version

import fmpy
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from request import answer, request

asked = request()
about = fmpy.read_model_description(asked.fmu)
is_fmi3 = about.fmiVersion.startswith("3")
with tempfile.TemporaryDirectory() as folder:
    fmpy.extract(asked.fmu, folder)
    fmu = (FMU3Slave if is_fmi3 else FMU2Slave)(
        guid=about.guid, unzipDirectory=folder, modelIdentifier=about.coSimulation.modelIdentifier, instanceName="tried"
    )
    fmu.instantiate()
    for _, reference, value in asked.settings:
        (fmu.setInt64 if is_fmi3 else fmu.setInteger)([reference], [value])
    if not is_fmi3:
        fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    for k in range(asked.count):
        fmu.doStep(k * asked.step, asked.step)
    values = list((fmu.getFloat64 if is_fmi3 else fmu.getReal)(list(asked.references.values())))
    fmu.terminate()
    fmu.freeInstance()
answer(version("fmpy"), asked.references, values)
