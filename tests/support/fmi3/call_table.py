"""The state machine of FMI 3.0.2 for Co-Simulation (sections 2.3 and 4.2), transcribed as a table.

Columns: Instantiated, Initialization Mode, Event Mode, Step Mode, Terminated, after fmi3Error, after
fmi3Fatal. 'x': allowed, '.': not allowed. "get" and "set" stand for all types. Functions that are in no row
are those of what these FMUs do not have (clocks, structural parameters, Model Exchange, Scheduled Execution,
dependencies of elements, fmi3EvaluateDiscreteStates): nowhere in order.
"""

from support.fmi3.prototypes import ARGUMENTS, TYPES, WITHOUT_INSTANCE

STATES = ("instantiated", "initialization", "event", "step", "terminated", "error", "fatal")

_STANDARD = """
SetDebugLogging           x x x x x x .
EnterInitializationMode   x . . . . . .
ExitInitializationMode    . x . . . . .
EnterEventMode            . . . x . . .
EnterStepMode             . . x . . . .
UpdateDiscreteStates      . . x . . . .
Terminate                 . . x x . . .
Reset                     x x x x x x .
get                       . x x x x x .
set                       x x x x . . .
GetFMUState               x x x x x x .
SetFMUState               x x x x x x .
FreeFMUState              x x x x x x .
SerializedFMUStateSize    x x x x x x .
SerializeFMUState         x x x x x x .
DeserializeFMUState       x x x x x x .
GetDirectionalDerivative  . x x x x x .
GetAdjointDerivative      . x x x x x .
GetOutputDerivatives      . . . x x x .
DoStep                    . . . x . . .
"""

TYPED = [*TYPES, "Binary"]
# Start values may be read while instantiated, which harms nobody.
LENIENT = {("instantiated", f"Get{name}") for name in TYPED}

FUNCTIONS = [name for name in ARGUMENTS if name not in (*WITHOUT_INSTANCE, "FreeInstance")]
_rows: dict[str, str] = {}
for _line in _STANDARD.split("\n"):
    if _line:
        _name, *_marks = _line.split()
        _names = [f"{_name.title()}{kind}" for kind in TYPED] if _name in ("get", "set") else [_name]
        _rows |= {name: "".join(_marks) for name in _names}


def allowed(function: str, state: str) -> bool:
    marks = _rows.get(function, "." * len(STATES))
    return marks[STATES.index(state)] == "x" or (state, function) in LENIENT
