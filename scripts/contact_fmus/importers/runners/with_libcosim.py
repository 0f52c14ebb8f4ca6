"""libcosim by its Python package: C++ on FMI Library. Its clock counts nanoseconds."""

from importlib.metadata import version

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave
from request import answer, request

asked = request()
log_output_level(CosimLogLevel.ERROR)
execution = CosimExecution.from_step_size(round(asked.step * 1e9))
index = execution.add_local_slave(CosimLocalSlave(asked.fmu, "tried"))
for name, reference, value in asked.settings:
    if not execution.integer_initial_value(index, reference, value):
        raise SystemExit(f"{name} cannot be set")
observer = CosimObserver.create_last_value()
if not execution.add_observer(observer):
    raise SystemExit("no observer")
for _ in range(asked.count):
    if not execution.step():
        raise SystemExit("a step failed")
values = observer.last_real_values(index, list(asked.references.values()))
answer(version("libcosimpy"), asked.references, list(values))
