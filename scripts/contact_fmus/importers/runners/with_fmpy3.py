"""fmpy: the calls of FMI 3.0 one by one"""

import tempfile
from importlib.metadata import version

import fmpy
from fmpy.fmi3 import FMU3Slave
from request import answer, request

asked = request()
about = fmpy.read_model_description(asked.fmu)
with tempfile.TemporaryDirectory() as folder:
    fmpy.extract(asked.fmu, folder)
    fmu = FMU3Slave(
        guid=about.guid, unzipDirectory=folder, modelIdentifier=about.coSimulation.modelIdentifier, instanceName="tried"
    )
    fmu.instantiate()
    for _, reference, value in asked.settings:
        fmu.setInt64([reference], [value])
    fmu.enterInitializationMode(startTime=0.0)
    fmu.exitInitializationMode()
    for k in range(asked.count):
        fmu.doStep(k * asked.step, asked.step)
    values = list(fmu.getFloat64(list(asked.references.values())))
    fmu.terminate()
    fmu.freeInstance()
answer(version("fmpy"), asked.references, values)
