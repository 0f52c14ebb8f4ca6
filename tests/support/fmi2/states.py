"""Brings an instance into any state of the call tables"""

from ctypes import byref

from support.fmi2 import raw
from support.fmi2.blob import PHASES, forge
from support.fmi2.raw import DISCARD, OK

NAMES = {
    "instantiated": "instantiated", "initialization": "initialization mode", "complete": "step mode",
    "failed": "step mode", "step": "step mode", "event": "event mode", "continuous": "continuous-time mode",
    "terminated": "terminated", "error": "error", "fatal": "fatal",
}  # fmt: skip


def bring_to(instance: raw.Instance, state: str) -> None:
    """From instantiated to a state of the table; `error` and `fatal`, out of reach else, by a forged state"""
    if state == "failed":
        fail_a_step(instance)
        return
    instance.ok("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
    if state == "instantiated":
        return
    instance.ok("EnterInitializationMode")
    if state == "initialization":
        return
    instance.ok("ExitInitializationMode")
    instance.ok("DoStep", 0.0, 0.01, 1)
    if state == "terminated":
        instance.ok("Terminate")
    elif state in ("error", "fatal"):
        status, handle = instance.deserialize(forge(instance.save(), phase=PHASES[state]))
        assert (status, instance.call("SetFMUstate", handle)) == (OK, OK), instance.texts()
        instance.call("FreeFMUstate", byref(handle))


def fail_a_step(instance: raw.Instance) -> None:
    """A step that the solver cannot finish in one internal step: a ball dropped on the other body"""
    drop = {"solver.method": 2, "solver.max_internal_steps": 1}
    if instance.fmu.name not in ("HertzImpact", "TippingRoller"):  # which hit as they start
        drop |= {"source.center[1]": 1.1, "gravity[1]": -9.81}
    instance.initialize({name: value for name, value in drop.items() if name in instance.fmu.variables})
    assert instance.call("DoStep", 0.0, 1.0, 1) == DISCARD, instance.texts()
    del instance.messages[:]
