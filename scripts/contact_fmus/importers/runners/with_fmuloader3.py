"""fmuloader: a thin binding by ctypes, FMI 3.0"""

import zipfile
from importlib.metadata import version
from xml.etree import ElementTree

from fmuloader.fmi3 import Fmi3Slave
from request import answer, request

asked = request()
about = ElementTree.fromstring(zipfile.ZipFile(asked.fmu).read("modelDescription.xml"))
fmu = Fmi3Slave(asked.fmu, model_identifier=about.find("CoSimulation").get("modelIdentifier"))
fmu.instantiate_co_simulation("tried", instantiation_token=about.get("instantiationToken"))
for _, reference, value in asked.settings:
    fmu.set_int64([reference], [value])
fmu.enter_initialization_mode(start_time=0.0)
fmu.exit_initialization_mode()
for k in range(asked.count):
    fmu.do_step(k * asked.step, asked.step)
values = fmu.get_float64(list(asked.references.values()))
fmu.terminate()
fmu.free_instance()
answer(version("fmuloader"), asked.references, values)
