"""The calling sequence of FMI 2.0.5 for co-simulation (section 4.2.4), transcribed from the standard's table.

Columns: start/end, instantiated, Initialization Mode, stepComplete, stepFailed, terminated, error, fatal. The
columns stepInProgress and stepCanceled are left out: no fmi2DoStep here runs asynchronously. 'x': allowed,
'.': not allowed. Conditions on variables (the numbers 1, 2, 3, 6 in the standard) are tested by themselves;
7 and 8 allow the call.
"""

STATES = ("start", "instantiated", "initialization", "complete", "failed", "terminated", "error", "fatal")

_STANDARD = """
SetDebugLogging           . x x x x x x .
FreeInstance              . x x x x x x .
SetupExperiment           . x . . . . . .
EnterInitializationMode   . x . . . . . .
ExitInitializationMode    . . x . . . . .
Terminate                 . . . x x . . .
Reset                     . x x x x x x .
GetReal                   . . x x x x x .
GetInteger                . . x x x x x .
GetBoolean                . . x x x x x .
GetString                 . . x x x x x .
SetReal                   . x x x . . . .
SetInteger                . x x x . . . .
SetBoolean                . x x x . . . .
SetString                 . x x x . . . .
GetFMUstate               . x x x x x x .
SetFMUstate               . x x x x x x .
FreeFMUstate              . x x x x x x .
SerializedFMUstateSize    . x x x x x x .
SerializeFMUstate         . x x x x x x .
DeSerializeFMUstate       . x x x x x x .
GetDirectionalDerivative  . . x x x x x .
SetRealInputDerivatives   . x x x . . . .
GetRealOutputDerivatives  . . . x x x x .
DoStep                    . . . x . . . .
CancelStep                . . . . . . . .
GetStatus                 . . . x x x . .
GetRealStatus             . . . x x x . .
GetIntegerStatus          . . . x x x . .
GetBooleanStatus          . . . x x x . .
GetStringStatus           . . . x x x . .
"""

# Of Model Exchange alone: refused on an instance of Co-Simulation, whatever its state.
EXCHANGE = (
    "EnterEventMode", "NewDiscreteStates", "EnterContinuousTimeMode", "CompletedIntegratorStep", "SetTime",
    "SetContinuousStates", "GetDerivatives", "GetEventIndicators", "GetContinuousStates",
    "GetNominalsOfContinuousStates",
)  # fmt: skip

# Calls these FMUs allow beyond the standard, none of which can harm:
# - start values may be read while instantiated;
# - after a discarded step an importer may go on from fmi2LastSuccessfulTime without restoring a state;
# - the status functions answer after a failed step as well.
_LENIENT = {
    "instantiated": {"GetReal", "GetInteger", "GetBoolean", "GetString"},
    "failed": {"DoStep", "SetReal", "SetInteger", "SetBoolean", "SetString", "SetRealInputDerivatives"},
    "error": {"GetStatus", "GetRealStatus", "GetIntegerStatus", "GetBooleanStatus", "GetStringStatus"},
}

STANDARD: dict[str, dict[str, bool]] = {}
for _line in _STANDARD.split("\n"):
    if _line:
        _function, *_marks = _line.split()
        STANDARD[_function] = {state: mark == "x" for state, mark in zip(STATES, _marks, strict=True)}

STANDARD |= {function: dict.fromkeys(STATES, False) for function in EXCHANGE}
FUNCTIONS = tuple(STANDARD)


def allowed(function: str, state: str) -> bool:
    return STANDARD[function][state] or function in _LENIENT.get(state, set())
