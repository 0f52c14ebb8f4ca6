"""ecos by its Python package ecospy: C++, made for systems of many FMUs"""

from importlib.metadata import version

from ecospy.EcosParameterSet import EcosParameterSet
from ecospy.EcosSimulation import EcosSimulation
from ecospy.EcosSimulationStructure import EcosSimulationStructure
from request import answer, request

asked = request()
structure = EcosSimulationStructure()
structure.add_model("tried", asked.fmu)
settings = EcosParameterSet()
for name, _, value in asked.settings:
    settings.add_int(f"tried::{name}", value)
structure.add_parameter_set("settings", settings)
simulation = EcosSimulation(structure=structure, step_size=asked.step)
if simulation.init(parameter_set="settings") is False:
    raise SystemExit("initialization failed")
simulation.step(asked.count)
values = [simulation.get_real(f"tried::{name}") for name in asked.references]
simulation.terminate()
answer(version("ecospy"), asked.references, values)
