"""fmuloader: a thin binding by ctypes"""

import zipfile
from importlib.metadata import version
from xml.etree import ElementTree

from fmuloader.fmi2 import Fmi2Slave, Fmi2Status, Fmi2Type
from fmuloader.fmi3 import Fmi3Slave
from request import answer, request

asked = request()
about = ElementTree.fromstring(zipfile.ZipFile(asked.fmu).read("modelDescription.xml"))
is_fmi3 = about.get("fmiVersion").startswith("3")
fmu = (Fmi3Slave if is_fmi3 else Fmi2Slave)(
    asked.fmu, model_identifier=about.find("CoSimulation").get("modelIdentifier")
)
if is_fmi3:
    fmu.instantiate_co_simulation("tried", instantiation_token=about.get("instantiationToken"))
else:
    # The allocateMemory of fmuloader hands back the lower half of an address only: every FMU that uses it ends there.
    own = {"cannot_use_memory_management_functions": True}
    fmu.instantiate("tried", Fmi2Type.CO_SIMULATION, guid=about.get("guid"), **own)
for name, reference, value in asked.settings:
    if is_fmi3:
        fmu.set_int64([reference], [value])
    elif fmu.set_integer([reference], [value]) != Fmi2Status.OK:
        raise SystemExit(f"{name} cannot be set")
if is_fmi3:
    fmu.enter_initialization_mode(start_time=0.0)
else:
    fmu.setup_experiment(start_time=0.0)
    fmu.enter_initialization_mode()
fmu.exit_initialization_mode()
for k in range(asked.count):
    fmu.do_step(k * asked.step, asked.step)
values = list((fmu.get_float64 if is_fmi3 else fmu.get_real)(list(asked.references.values())))
fmu.terminate()
fmu.free_instance()
answer(version("fmuloader"), asked.references, values)
