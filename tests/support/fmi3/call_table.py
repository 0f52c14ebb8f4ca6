"""The state machines of FMI 3.0.2 for Co-Simulation (sections 2.3 and 4.2) and for Model Exchange (2.3 and
3.2), each transcribed as a table.

Columns: Instantiated, Initialization Mode, Event Mode, Step Mode or Continuous-Time Mode, Terminated, after
fmi3Error, after fmi3Fatal. 'x': allowed, '.': not allowed. "get" and "set" stand for all types but Float64.
Functions that are in no row are those of what these FMUs do not have (clocks, structural parameters,
Scheduled Execution, element dependencies, fmi3EvaluateDiscreteStates), or of the other kind: never right."""

from support.fmi3.raw import ARGUMENTS, TYPES, WITHOUT_INSTANCE

COMMON = ("instantiated", "initialization", "event")
AFTER = ("terminated", "error", "fatal")
STATES = {"CoSimulation": (*COMMON, "step", *AFTER), "ModelExchange": (*COMMON, "continuous", *AFTER)}

_COMMON = """
SetDebugLogging           x x x x x x .
EnterInitializationMode   x . . . . . .
ExitInitializationMode    . x . . . . .
EnterEventMode            . . . x . . .
UpdateDiscreteStates      . . x . . . .
Terminate                 . . x x . . .
Reset                     x x x x x x .
get                       . x x x x x .
GetFloat64                . x x x x x .
GetFMUState               x x x x x x .
SetFMUState               x x x x x x .
FreeFMUState              x x x x x x .
SerializedFMUStateSize    x x x x x x .
SerializeFMUState         x x x x x x .
DeserializeFMUState       x x x x x x .
GetDirectionalDerivative  . x x x x x .
GetAdjointDerivative      . x x x x x .
SetFloat64                x x x x . . .
"""
_OWN = {
    "CoSimulation": """
set                       x x x x . . .
EnterStepMode             . . x . . . .
GetOutputDerivatives      . . . x x x .
DoStep                    . . . x . . .
""",
    "ModelExchange": """
set                       x x x . . . .
EnterContinuousTimeMode        . . x . . . .
CompletedIntegratorStep        . . . x . . .
SetTime                        . . . x . . .
SetContinuousStates            . . . x . . .
GetContinuousStateDerivatives  . x x x x x .
GetContinuousStates            . x x x x x .
GetEventIndicators             . x x x x x .
GetNominalsOfContinuousStates  . x x x x x .
GetNumberOfContinuousStates    x . x . . . .
GetNumberOfEventIndicators     x . x . . . .
""",
}

TYPED = [*TYPES, "Binary"]
NUMBERS = ("GetNumberOfContinuousStates", "GetNumberOfEventIndicators")
# Start values may be read while instantiated, and numbers that never change are told: that harms nobody.
_LENIENT = {
    "instantiated": {f"Get{name}" for name in TYPED},
    **{state: set(NUMBERS) for state in ("initialization", "continuous", "terminated", "error")},
}

FUNCTIONS = [name for name in ARGUMENTS if name not in (*WITHOUT_INSTANCE, "FreeInstance")]


def _rows(text: str) -> dict[str, str]:
    rows = {}
    for line in filter(None, text.split("\n")):
        name, *marks = line.split()
        others = [kind for kind in TYPED if kind != "Float64"]
        names = [f"{name.title()}{kind}" for kind in others] if name in ("get", "set") else [name]
        rows |= {one: "".join(marks) for one in names}
    return rows


_TABLES = {kind: _rows(_COMMON + own) for kind, own in _OWN.items()}
# Of the other kind alone: refused whatever the state of the instance is.
FOREIGN = {
    kind: [name for name in FUNCTIONS if name in _TABLES[other] and name not in _TABLES[kind]]
    for kind, other in (("CoSimulation", "ModelExchange"), ("ModelExchange", "CoSimulation"))
}


def allowed(function: str, state: str, kind: str = "CoSimulation") -> bool:
    marks = _TABLES[kind].get(function)
    if marks is None:
        return False
    return marks[STATES[kind].index(state)] == "x" or function in _LENIENT.get(state, set())
