"""Calls any function of FMI 2.0 and FMI 3.0 with good arguments, whatever the state of the instance."""

import ctypes
from ctypes import byref, c_bool, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p

from support.fmi2 import raw as fmi2
from support.fmi3 import raw as fmi3
from support.fmi3.raw import ERROR
from support.prototypes import OK, AnyInstance

NUMBERS = ("GetNumberOfContinuousStates", "GetNumberOfEventIndicators")
VECTORS = ("SetContinuousStates", "GetContinuousStates", "GetContinuousStateDerivatives", "GetDerivatives")
VECTORS += ("GetNominalsOfContinuousStates",)


def nothing(kind):
    """Zero, or no place"""
    return 0 if kind in (c_bool, c_double, c_size_t, c_uint, c_int) else None


def no_arguments(instance: AnyInstance, function: str) -> list:
    """Without values where there may be none"""
    if instance.prefix == "fmi3":
        return [nothing(kind) for kind in fmi3.ARGUMENTS[function]]
    return [nothing(kind) for kind in fmi2.ARGUMENTS[f"fmi2{function}"][1:]]


class Caller:
    """Whatever needs a state finds one; where no state can be had, a null pointer serves."""

    def __init__(self, instance: AnyInstance):
        self.instance = instance
        self.state = c_void_p()
        self.bytes = self.look()
        instance.call(f"Get{instance.STATE}", byref(self.state))
        del instance.messages[:]

    def look(self) -> bytes:
        """Returns the saved state, empty where there is none."""
        state = c_void_p()
        if self.instance.call(f"Get{self.instance.STATE}", byref(state)) != OK:
            return b""
        self.instance.ok(f"Free{self.instance.STATE}", byref(state))
        return self.instance.save()

    def call(self, function: str) -> int:
        return self.instance.call(function, *self.arguments(function))

    def fault(self, function: str, allowed: bool, where: str, answer: int = OK) -> str | None:
        """Returns what is wrong about the answer to a call in or out of order, or None."""
        before, arguments = self.look(), self.arguments(function)
        del self.instance.messages[:]
        status, texts = self.instance.call(function, *arguments), self.instance.texts()
        told = f"{function}: status {status}, messages {texts}"
        if allowed:
            return None if status == answer else told
        if status != ERROR or len(texts) != 1:
            return told
        if f"{self.instance.prefix}{function} called {where}" not in texts[0]:
            return f"{told}: the message does not say what was called when"
        return None if self.look() == before else f"{told}: refused, yet it changed the instance"

    def end(self) -> None:
        if self.state.value is not None:
            self.instance.call(f"Free{self.instance.STATE}", byref(self.state))

    def _vector(self, role: str) -> tuple:
        count = len(self.instance.fmu.roles[role])
        return (c_double * count)(), count

    def arguments(self, function: str) -> tuple | list:
        kind, third = self.instance.STATE, self.instance.prefix == "fmi3"
        flags = [byref(c_bool() if third else c_int()) for _ in range(5)]
        number, size = byref(c_double()), byref(c_size_t())
        buffer = ctypes.create_string_buffer(max(1, len(self.bytes)))
        special = {
            "UpdateDiscreteStates": (*flags, number), "NewDiscreteStates": (byref(fmi2.EventInfo()),),
            "CompletedIntegratorStep": (True, *flags[:2]), "SetTime": (1e-3,),
            "DoStep": (self._time(function), 1e-6, True, *((*flags[:3], number) if third else ())),
            **dict.fromkeys(NUMBERS, (size,)), **dict.fromkeys(VECTORS, self._vector("state")),
            "GetEventIndicators": self._vector("indicator"), f"Get{kind}": (byref(self.state),),
            f"Set{kind}": (self.state,), f"Free{kind}": (byref(self.state),),
            f"Serialized{kind}Size": (self.state, size),
            f"Serialize{kind}": (self.state, buffer, len(self.bytes)),
            **dict.fromkeys((f"DeSerialize{kind}", f"Deserialize{kind}"),
                (self.bytes, len(self.bytes), byref(self.state))),
            "GetStatus": (fmi2.DO_STEP_STATUS, byref(c_int())),
            "GetRealStatus": (fmi2.LAST_SUCCESSFUL_TIME, number),
            "GetIntegerStatus": (fmi2.PENDING_STATUS, byref(c_int())),
            "GetBooleanStatus": (fmi2.TERMINATED, byref(c_int())),
            "GetStringStatus": (fmi2.PENDING_STATUS, byref(c_char_p())),
        }  # fmt: skip
        return special[function] if function in special else no_arguments(self.instance, function)

    def _time(self, function: str) -> float:
        """Where the next step has to begin, or 0"""
        time = c_double()
        if function == "DoStep" and self.instance.prefix == "fmi2":
            self.instance.call("GetRealStatus", fmi2.LAST_SUCCESSFUL_TIME, byref(time))
        elif function == "DoStep":
            clock = fmi3.references([self.instance.fmu.variables["time"]])
            self.instance.call("GetFloat64", clock, 1, byref(time), 1)
        del self.instance.messages[:]
        return time.value
