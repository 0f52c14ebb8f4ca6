"""The calling sequence of FMI 2.0.5 for co-simulation (section 4.2.4), transcribed from the standard's table,
and that of the main functions for Model Exchange (section 3.2.3).

Columns: start/end, instantiated, Initialization Mode, stepComplete, stepFailed, terminated, error, fatal.
stepInProgress and stepCanceled are left out: no fmi2DoStep here runs asynchronously. 'x': allowed, '.': not.
Conditions on variables (1, 2, 3, 6 in the standard) have tests of their own; 7 and 8 allow the call."""

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

EXCHANGE_STATES = ("instantiated", "initialization", "event", "continuous", "terminated")
_EXCHANGE = """
SetupExperiment               x . . . .
EnterInitializationMode       x . . . .
ExitInitializationMode        . x . . .
Terminate                     . . x x .
SetReal                       x x x x .
SetInteger                    x x x . .
SetBoolean                    x x x . .
GetReal                       x x x x x
GetFMUstate                   x x x x x
EnterEventMode                . . x x .
NewDiscreteStates             . . x . .
EnterContinuousTimeMode       . . x . .
CompletedIntegratorStep       . . . x .
SetTime                       . . x x .
SetContinuousStates           . . . x .
GetDerivatives                . x x x x
GetEventIndicators            . x x x x
GetContinuousStates           . x x x x
GetNominalsOfContinuousStates x x x x x
DoStep                        . . . . .
SetRealInputDerivatives       . . . . .
GetRealOutputDerivatives      . . . . .
GetStatus                     . . . . .
"""

# Of Model Exchange alone: refused on an instance of Co-Simulation, whatever its state.
EXCHANGE = ("EnterEventMode", "NewDiscreteStates", "EnterContinuousTimeMode", "CompletedIntegratorStep")
EXCHANGE += ("SetTime", "SetContinuousStates", "GetDerivatives", "GetEventIndicators", "GetContinuousStates")
EXCHANGE += ("GetNominalsOfContinuousStates",)

# Calls these FMUs allow beyond the standard, none of which can harm:
# - start values may be read while instantiated;
# - after a discarded step an importer may go on from fmi2LastSuccessfulTime without restoring a state;
# - the status functions answer after a failed step as well.
_LENIENT = {
    "instantiated": {"GetReal", "GetInteger", "GetBoolean", "GetString"},
    "failed": {"DoStep", "SetReal", "SetInteger", "SetBoolean", "SetString", "SetRealInputDerivatives"},
    "error": {"GetStatus", "GetRealStatus", "GetIntegerStatus", "GetBooleanStatus", "GetStringStatus"},
}


def _table(text: str, states: tuple[str, ...]) -> dict[str, dict[str, bool]]:
    return {
        function: {state: mark == "x" for state, mark in zip(states, marks, strict=True)}
        for function, *marks in [line.split() for line in text.split("\n") if line]
    }


STANDARD = _table(_STANDARD, STATES) | {function: dict.fromkeys(STATES, False) for function in EXCHANGE}
IN_EXCHANGE = _table(_EXCHANGE, EXCHANGE_STATES)
# Of Co-Simulation alone: refused on an instance of Model Exchange.
FOREIGN = {function for function, marks in IN_EXCHANGE.items() if not any(marks.values())}
FUNCTIONS = tuple(STANDARD)


def allowed(function: str, state: str) -> bool:
    return STANDARD[function][state] or function in _LENIENT.get(state, set())
