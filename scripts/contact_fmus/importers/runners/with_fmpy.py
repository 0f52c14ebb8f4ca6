"""fmpy: the calls of the standard one by one"""

import tempfile
from importlib.metadata import version

import fmpy
from fmpy.fmi2 import FMU2Slave
from request import answer, request

asked = request()
about = fmpy.read_model_description(asked.fmu)
with tempfile.TemporaryDirectory() as folder:
    fmpy.extract(asked.fmu, folder)
    fmu = FMU2Slave(
        guid=about.guid, unzipDirectory=folder, modelIdentifier=about.coSimulation.modelIdentifier, instanceName="tried"
    )
    fmu.instantiate()
    for _, reference, value in asked.settings:
        fmu.setInteger([reference], [value])
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    for k in range(asked.count):
        fmu.doStep(k * asked.step, asked.step)
    values = fmu.getReal(list(asked.references.values()))
    fmu.terminate()
    fmu.freeInstance()
answer(version("fmpy"), asked.references, values)
