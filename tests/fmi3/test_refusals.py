"""Bad input: FMI 2.0 and FMI 3.0 refuse the same with the same status in the same words.

A row of the tables is what is asked, and of Model Exchange also the status and the words of the message."""

import contextlib
import math
from ctypes import c_double, c_uint, c_void_p
from typing import NamedTuple

import pytest

from support.fmi2 import raw as raw2
from support.fmi3 import raw
from support.fmi3.raw import DISCARD, ERROR, OK
from support.outside import Outside

SCENE = "SphereSphere"
STATES = raw2.load(SCENE).roles["state"]
COUNT = len(STATES)
WANTED, ELEMENTS = f"values, expected {COUNT}", f"{COUNT} elements"
GAPS = f"expected {len(raw2.load(SCENE).roles['indicator'])}"
STOP = 1.0
START = {"destination.motion": "free", "source.center": [0.1, 0.0, 0.7]}
# Names of functions and types of FMI 2.0 -> of FMI 3.0
THIRD = {"GetDerivatives": "GetContinuousStateDerivatives", "NewDiscreteStates": "UpdateDiscreteStates"}
THIRD |= {"GetRealOutputDerivatives": "GetOutputDerivatives", "SetupExperiment": "EnterInitializationMode"}
THIRD |= {"SetReal": "SetFloat64", "GetReal": "GetFloat64", "Real": "Float64"}
THIRD |= {"SetFMUstate": "SetFMUState", "FMUstate": "FMUState", "fmi2": "fmi3", "[1]": ""}


class Version(NamedTuple):
    """One version of the standard: an instance, and how it is called"""

    number: int
    instance: raw2.Instance | raw.Instance
    outside: Outside | None = None  # of Model Exchange

    def name(self, function: str) -> str:
        return THIRD.get(function, function) if self.number == 3 else function

    def call(self, function: str, *arguments) -> int:
        return self.instance.call(self.name(function), *arguments)

    def vector(self, function: str, values, count: int | None = None) -> int:
        """A function that takes an array and its length"""
        array = None if values is None else (c_double * max(1, len(values)))(*values)
        return self.call(function, array, len(values or ()) if count is None else count)

    def states(self, change: dict[str, float]) -> int:
        """Sets the present states with some of them changed"""
        states = self.outside.states()
        for name, value in change.items():
            states[STATES.index(name)] = value
        return self.vector("SetContinuousStates", states.tolist())

    def reference(self, name: str) -> int:
        known = self.instance.fmu.variables
        return known[name if name in known else f"{name}[1]"].reference

    def set_real(self, name: str, value: float) -> int:
        """All components of a variable to the same value; FMI 2.0 is told of the first one alone"""
        count = self.instance.fmu.variables[name].length if self.number == 3 else 1
        more = (count,) if self.number == 3 else ()
        one, values = (c_uint * 1)(self.reference(name)), (c_double * count)(*[value] * count)
        return self.call("SetReal", one, 1, values, *more)

    def slope(self, unknown: str, known: str, seed: float) -> int:
        """A directional derivative"""
        counts = [1, 1]
        if self.number == 3:
            counts = [self.instance.fmu.variables[name].length for name in (unknown, known)]
        one = [(c_uint * 1)(self.reference(name)) for name in (unknown, known)]
        about = ("GetDirectionalDerivative", one[0], 1, one[1], 1)
        seeds, values = (c_double * 3)(seed, seed, seed), (c_double * 3)()
        if self.number == 2:
            return self.call(*about, seeds, values)
        return self.call(*about, seeds, counts[1], values, counts[0])

    def event_mode(self) -> None:
        self.instance.ok("EnterEventMode")

    def step(self, time: float, size: float, stop: float | None = None) -> None:
        """The first one, of Co-Simulation"""
        self.instance.initialize(stop=stop)
        if self.number == 3:
            self.instance.step(time, size)
        else:
            self.instance.call("DoStep", time, size, 1)

    def look(self) -> bytes:
        return self.instance.save() if self.outside is None else self.outside.states().tobytes()


def in_event_mode(attempt):
    def run(one):
        one.event_mode()
        return attempt(one)

    return run


def at(one, time):
    one.instance.ok("SetTime", time)


def far_out(one):
    """A velocity and a force in range whose power is not"""
    assert one.states({"source.velocity_state[1]": 1e200}) == OK
    assert one.set_real("source.external_force", 1e150) == OK
    return one.vector("GetDerivatives", [0.0] * COUNT)


# what is asked -> how, status, words
REFUSALS = {
    "a time that is no number": (lambda one: one.call("SetTime", math.nan), ERROR, "time", "nan",
        "allowed: finite, from the last event at 0 s on"),
    "a time without end": (lambda one: one.call("SetTime", math.inf), ERROR, "inf", "allowed: finite"),
    "a time before the last event": (lambda one: one.call("SetTime", -0.5), ERROR, "-0.5",
        "from the last event at 0 s on"),
    "a state that is no number": (lambda one: one.states({"source.velocity_state[2]": math.nan}), DISCARD,
        "source.velocity_state[2] = nan refused", "allowed: -1e+300 .. 1e+300", "stays as it was"),
    "an infinite state": (lambda one: one.states({"energy.friction_state": -math.inf}), DISCARD,
        "energy.friction_state"),
    "a state out of range": (lambda one: one.states({"energy.dissipated_state": 1.1e300}), DISCARD,
        "energy.dissipated_state"),
    "too few states": (lambda one: one.vector("SetContinuousStates", [0.0] * 3), ERROR, f"3 {WANTED}"),
    "too many rates": (lambda one: one.vector("GetDerivatives", [0.0] * (COUNT + 1)), ERROR,
        f"{COUNT + 1} {WANTED}"),
    "too few nominals": (lambda one: one.vector("GetNominalsOfContinuousStates", [0.0]), ERROR,
        f"1 {WANTED}"),
    "indicators without end": (lambda one: one.vector("GetEventIndicators", [0.0], 2**64 - 1), ERROR, GAPS),
    "no array of states": (lambda one: one.vector("SetContinuousStates", None, COUNT), ERROR, "null pointer",
        ELEMENTS),
    "no array for states": (lambda one: one.vector("GetContinuousStates", None, COUNT), ERROR, "null pointer",
        ELEMENTS),
    "no place for what a step says": (lambda one: one.call("CompletedIntegratorStep", 1, None, None), ERROR,
        "enterEventMode"),
    "a step past the stop time": (lambda one: (at(one, 1.5), one.instance.complete_step()), ERROR,
        "step to 1.5 s goes past stopTime = 1 s"),
    "a force that is no number": (lambda one: one.set_real("source.external_force", math.nan), DISCARD,
        "source.external_force", "nan refused", "allowed: -1e+150 .. 1e+150"),
    "a parameter while it runs": (lambda one: one.set_real("source.radius", 0.3), ERROR,
        "source.radius is a parameter, fixed after initialization"),
    "a rate": (lambda one: one.set_real("source.acceleration", 0.0), ERROR, "calculated and cannot be set"),
    "an indicator": (lambda one: one.set_real("contact.touch_indicator", 0.0), ERROR,
        "calculated and cannot be set"),
    "numbers too large for their power": (far_out, DISCARD, "beyond the range of numbers", "allowed:"),
    "a slope of what is no unknown": (lambda one: one.slope("source.velocity_state", "source.velocity_state",
        1.0), ERROR, "source.velocity_state", "output"),
    "a slope by what is no known": (lambda one: one.slope("source.acceleration", "source.radius", 1.0), ERROR,
        "source.radius"),
    "a seed that is no number": (lambda one: one.slope("source.acceleration", "source.velocity_state",
        math.inf), DISCARD, "source.velocity_state", "inf refused", "allowed: finite"),
    "continuous time twice": (lambda one: one.call("EnterContinuousTimeMode"), ERROR,
        "called in phase continuous-time mode, allowed in: event mode"),
    "states in event mode": (in_event_mode(lambda one: one.states({})), ERROR,
        "called in phase event mode, allowed in: continuous-time mode"),
    "a step in event mode": (in_event_mode(lambda one: one.instance.complete_step()), ERROR,
        "called in phase event mode, allowed in: continuous-time mode"),
    "a new event between events": (lambda one: one.instance.update_discrete_states(), ERROR,
        "called in phase continuous-time mode, allowed in: event mode"),
    "initialization again": (lambda one: one.call("ExitInitializationMode"), ERROR,
        "called in phase continuous-time mode, allowed in: initialization mode"),
    "a state of nobody": (lambda one: one.call("SetFMUstate", None), ERROR, "null pointer"),
    "derivatives of outputs": (lambda one: one.call("GetRealOutputDerivatives", None, 0, None, None,
        *[0] * (one.number - 2)), ERROR,
        "called on an instance of Model Exchange, allowed: of Co-Simulation"),
}  # fmt: skip


def contradict(one):
    one.instance.set({"contact.location": "inside", "source.radius": 0.6})
    one.instance.initialize()


# What instances of Co-Simulation refuse before they are initialized, or after it.
STEPPING = {
    "a radius of nothing": lambda one: one.set_real("source.radius", 0.0),
    "a force that is no number": lambda one: one.set_real("source.external_force", math.nan),
    "an output set": lambda one: one.set_real("contact.gap", 1.0),
    "a state set": lambda one: (one.instance.initialize(), one.set_real("source.velocity_state", 0.0)),
    "a parameter after the start": lambda one: (one.instance.initialize(), one.set_real("source.radius", 2)),
    "an output before the start": lambda one: one.instance.get("contact.gap"),
    "a step backwards": lambda one: one.step(0.0, -0.1),
    "a step of no length": lambda one: one.step(0.0, 0.0),
    "a step without end": lambda one: one.step(0.0, math.inf),
    "a step from elsewhere": lambda one: one.step(0.5, 0.1),
    "a step past the stop time": lambda one: one.step(0.0, 2.0, stop=1.0),
    "contradictory parameters": contradict,
    "a stop before the start": lambda one: one.instance.initialize(stop=-1.0),
}  # fmt: skip


def opened(number: int, exchange: bool = True) -> Version:
    if not exchange:
        module = {2: raw2, 3: raw}[number]
        return Version(number, module.Instance(module.load(SCENE), b"both"))
    if number == 2:
        instance = raw2.Instance(raw2.load(SCENE), b"both", kind=raw2.MODEL_EXCHANGE)
    else:
        instance = raw.Instance(raw.load(SCENE), b"both", exchange=True)
    return Version(number, instance, Outside(instance.initialize(START, stop=STOP)).begin())


def answer(one: Version, attempt):
    """Status and message of what is refused, and whether the states stay as they were"""
    before = one.look()
    del one.instance.messages[:]
    with contextlib.suppress(AssertionError):  # `ok` of a refused call; the message tells
        attempt(one)
    ((status, category, text),) = one.instance.messages
    unchanged = one.look() == before
    return status, category, text, unchanged


def in_words_of_fmi3(text: str) -> str:
    for second, third in THIRD.items():
        text = text.replace(second, third)
    return text


def answers(attempt, exchange=True):
    versions = [opened(number, exchange) for number in (2, 3)]
    try:
        return [answer(one, attempt) for one in versions]
    finally:
        for one in versions:
            one.instance.free()


@pytest.mark.parametrize("what", STEPPING)
def test_both_versions_refuse_in_the_same_words_in_co_simulation(what):
    second, third = answers(STEPPING[what], exchange=False)
    assert second[:2] == third[:2]
    assert in_words_of_fmi3(second[2]) == third[2].replace("[1]", "")


@pytest.mark.parametrize("what", REFUSALS)
def test_both_versions_refuse_with_one_status_in_one_wording(what):
    attempt, status, *words = REFUSALS[what]
    second, third = answers(attempt)
    for got in (second, third):
        assert got[0] == status, got
        assert [word for word in words if word not in got[2]] == [], got
        assert got[3] or what == "numbers too large for their power", "a refused call changed a state"
    assert second[1] == third[1] == {DISCARD: "logStatusDiscard", ERROR: "logStatusError"}[status]
    assert in_words_of_fmi3(second[2]) == third[2].replace("[1]", "")


def test_places_for_news_and_numbers_must_be_given():
    with raw.Instance(raw.load(SCENE), exchange=True) as instance:
        instance.initialize()
        names = ["discreteStatesNeedUpdate", "terminateSimulation", "nominalsOfContinuousStatesChanged"]
        names += ["valuesOfContinuousStatesChanged", "nextEventTimeDefined", "nextEventTime"]
        flag, time = raw.TYPES["Boolean"](), c_double()
        for missing, name in enumerate(names):
            places = [flag] * 5 + [time]
            places[missing] = None
            expected = instance.expect(ERROR, "fmi3UpdateDiscreteStates", name, "null pointer")
            expected(instance.call("UpdateDiscreteStates", *places))
        for name in ("nContinuousStates", "nEventIndicators"):
            function = name.replace("n", "GetNumberOf", 1)
            instance.expect(ERROR, f"fmi3{function}", name, "null pointer")(instance.call(function, None))


def test_states_of_one_kind_do_not_fit_the_other():
    fmu = raw.load(SCENE)
    with raw.Instance(fmu, exchange=True) as outside, raw.Instance(fmu) as stepping:
        for giver, taker, words in ((outside, stepping, "the model"), (stepping, outside, "the importer")):
            giver.ok("Reset")
            taker.ok("Reset")
            giver.initialize()
            taker.initialize()
            before = taker.bits("output")
            blob, state = giver.save(), c_void_p()
            assert taker.call("DeserializeFMUState", blob, len(blob), state) in (OK, ERROR)
            del taker.messages[:]
            if state.value is not None:
                assert taker.call("SetFMUState", state) == ERROR
                assert words in taker.texts()[0]
            assert taker.bits("output") == before
