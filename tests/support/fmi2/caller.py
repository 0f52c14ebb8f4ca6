"""Calls any function of FMI 2.0 with good arguments, whatever the state of the instance."""

import ctypes
from ctypes import byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p

from support.fmi2 import raw
from support.fmi2.raw import DISCARD, OK, array


class Caller:
    """Calls any function with good arguments"""

    def __init__(self, instance: raw.Instance):
        self.instance = instance
        self.state = c_void_p()
        self.bytes = b""

    def prepare(self) -> None:
        """Whatever needs a state finds one; where no state can be had, a null pointer serves"""
        if self.instance.call("GetFMUstate", byref(self.state)) == OK:
            self.bytes = self.instance.save()

    def call(self, function: str) -> int:
        return self.instance.call(function, *getattr(self, function, tuple)())

    def end(self) -> None:
        if self.state.value is not None:
            self.instance.call("FreeFMUstate", byref(self.state))

    def _values(self, kind: str, setting: bool) -> tuple:
        """Arrays for a parameter while those may be set, else for an input; empty where there is none"""
        fixed = self.instance.call("DoStep", 0.0, -1.0, 1) == DISCARD
        found = (
            [
                variable
                for variable in self.instance.fmu.select("input" if fixed else "parameter")
                if variable.call_type == kind
            ]
            if kind != "String"
            else []
        )
        del self.instance.messages[:]
        ctype = {"Real": c_double, "String": c_char_p}.get(kind, c_int)
        if not found:
            return None, 0, None
        value = found[0].start_value if setting else 0
        return array(c_uint, [found[0].reference]), 1, array(ctype, [value])

    def SetDebugLogging(self) -> tuple:
        return 0, 0, None

    def SetupExperiment(self) -> tuple:
        return 0, 0.0, 0.0, 0, 0.0

    def DoStep(self) -> tuple:
        time = c_double()
        self.instance.call("GetRealStatus", raw.LAST_SUCCESSFUL_TIME, byref(time))
        del self.instance.messages[:]
        return time.value, 1e-6, 1

    def GetFMUstate(self) -> tuple:
        return (byref(self.state),)

    def SetFMUstate(self) -> tuple:
        return (self.state,)

    def FreeFMUstate(self) -> tuple:
        return (byref(self.state),)

    def SerializedFMUstateSize(self) -> tuple:
        return self.state, byref(c_size_t())

    def SerializeFMUstate(self) -> tuple:
        return self.state, ctypes.create_string_buffer(max(1, len(self.bytes))), len(self.bytes)

    def DeSerializeFMUstate(self) -> tuple:
        return self.bytes, len(self.bytes), byref(self.state)

    def GetDirectionalDerivative(self) -> tuple:
        return None, 0, None, 0, None, None

    def _derivatives(self, causality: str) -> tuple:
        variable = next(
            v for v in self.instance.fmu.select(causality, kind="Real") if "gap_rate" not in v.name
        )
        return array(c_uint, [variable.reference]), 1, array(c_int, [1]), array(c_double, [0.0])

    def SetRealInputDerivatives(self) -> tuple:
        return self._derivatives("input")

    def GetRealOutputDerivatives(self) -> tuple:
        return None, 0, None, None

    def GetStatus(self) -> tuple:
        return raw.DO_STEP_STATUS, byref(c_int())

    def GetRealStatus(self) -> tuple:
        return raw.LAST_SUCCESSFUL_TIME, byref(c_double())

    def GetIntegerStatus(self) -> tuple:
        return raw.PENDING_STATUS, byref(c_int())

    def GetBooleanStatus(self) -> tuple:
        return raw.TERMINATED, byref(c_int())

    def GetStringStatus(self) -> tuple:
        return raw.PENDING_STATUS, byref(c_char_p())

    def NewDiscreteStates(self) -> tuple:
        return (byref(raw.EventInfo()),)

    def CompletedIntegratorStep(self) -> tuple:
        return 1, byref(c_int()), byref(c_int())

    def SetTime(self) -> tuple:
        return (1e-3,)

    def _states(self) -> tuple:
        count = len(self.instance.fmu.roles["state"])
        return array(c_double, [0.0] * count), count

    SetContinuousStates = GetDerivatives = GetContinuousStates = GetNominalsOfContinuousStates = _states

    def GetEventIndicators(self) -> tuple:
        count = len(self.instance.fmu.roles["indicator"])
        return array(c_double, [0.0] * count), count


for _kind in ("Real", "Integer", "Boolean", "String"):
    setattr(Caller, f"Get{_kind}", lambda self, kind=_kind: self._values(kind, setting=False))
    setattr(Caller, f"Set{_kind}", lambda self, kind=_kind: self._values(kind, setting=True))
