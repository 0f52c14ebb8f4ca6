"""Messages: who hears which, and that each is a complete text of bounded length whatever its parts are."""

import ctypes
from ctypes import byref, c_char_p, c_double, c_int, c_size_t, c_uint

import pytest

from support.caller import Caller
from support.fmi2 import raw
from support.fmi2.call_table import FUNCTIONS, allowed
from support.fmi2.raw import DISCARD, ERROR, OK, WARNING, array
from support.fmi2.runs import RUNS, begin, go_on, step
from support.fmi2.states import bring_to

CATEGORIES = ["logEvents", "logStatusWarning", "logStatusDiscard", "logStatusError", "logStatusFatal"]
CATEGORIES += ["logAll"]
STATUS_CATEGORIES = {raw.OK: "logEvents", raw.WARNING: "logStatusWarning", raw.DISCARD: "logStatusDiscard"}
STATUS_CATEGORIES |= {raw.ERROR: "logStatusError", raw.FATAL: "logStatusFatal"}


def choose(instance: raw.Instance, on: bool, *names: bytes) -> int:
    return instance.call("SetDebugLogging", int(on), len(names), array(c_char_p, names) if names else None)


def complain(instance: raw.Instance) -> list[str]:
    """One discarded value and one wrong call: the categories of the messages they bring"""
    del instance.messages[:]
    assert instance.set_one(instance.fmu.variables["source.radius"], -1.0) == DISCARD
    assert instance.call("Terminate") == ERROR
    return [message.category for message in instance.messages]


def test_the_description_lists_the_categories(fmu):
    text = (fmu.folder / "modelDescription.xml").read_text()
    assert [name for name in CATEGORIES if f'<Category name="{name}"' not in text] == []
    assert text.count("<Category ") == len(CATEGORIES)


@pytest.mark.parametrize("logging", [False, True])
def test_refusals_are_told_whether_logging_is_on_or_off(fmu, logging):
    with raw.Instance(fmu, logging=logging) as instance:
        assert complain(instance) == ["logStatusDiscard", "logStatusError"]


def test_chosen_categories_are_the_only_ones(instance):
    both = ["logStatusDiscard", "logStatusError"]
    cases = [((b"logStatusDiscard",), both[:1]), ((b"logStatusError",), both[1:]), ((b"logEvents",), [])]
    cases += [((b"logAll",), both), ((), both), ((b"logStatusFatal", b"logStatusError"), both[1:])]
    for names, heard in cases:
        assert choose(instance, True, *names) == OK
        assert complain(instance) == heard, names


def test_switching_off_leaves_the_refusals(fmu):
    with raw.Instance(fmu, logging=True) as instance:
        for names in [(), (b"logEvents",), (b"logStatusError",)]:
            assert choose(instance, True, b"logEvents") == OK
            assert complain(instance) == []
            assert choose(instance, False, *names) == OK
            assert complain(instance) == ["logStatusDiscard", "logStatusError"]


@pytest.mark.parametrize(
    "name", [b"logEverything", b"", b"logall", b"logStatusError ", "große %s".encode(), b"x" * 9999]
)
def test_an_unknown_category_is_refused_naming_the_known(instance, name):
    instance.expect(ERROR, "fmi2SetDebugLogging", *CATEGORIES)(choose(instance, True, b"logEvents", name))
    assert complain(instance) == ["logStatusDiscard", "logStatusError"]


def test_a_null_category_is_refused(instance):
    refused = instance.expect(ERROR, "fmi2SetDebugLogging")
    refused(instance.call("SetDebugLogging", 1, 2, (c_char_p * 2)(b"logAll", None)))


def test_events_are_told_only_when_asked_for():
    run = RUNS["sphere in contact"]
    heard = {}
    for logging in (False, True):
        with begin(run, logging=logging) as instance:
            go_on(instance, run, 0)
            assert instance.get("contact.onsets") >= 1
            heard[logging] = [message for message in instance.messages if message.category == "logEvents"]
            assert heard[logging] == instance.messages
    assert heard[False] == []
    assert heard[True]
    assert {message.status for message in heard[True]} == {OK}


def test_listening_does_not_change_the_run():
    run = RUNS["pushed about"]
    with begin(run, logging=True) as heard, begin(run) as quiet, begin(run, with_logger=False) as mute:
        assert go_on(heard, run, 0) == go_on(quiet, run, 0) == go_on(mute, run, 0)


def test_reset_returns_to_the_logging_of_the_instantiation(instance):
    choose(instance, True, b"logEvents")
    assert complain(instance) == []
    instance.ok("Reset")
    assert complain(instance) == ["logStatusDiscard", "logStatusError"]


@pytest.mark.parametrize("name", [
    "ball", "Kugel Nr. 3", "50 %", "%s%n%d%%", "#r100#", "ß 汉字 🎱", "a\nb\tc", "x" * 5000, "ü" * 5000,
    "€" * 5000, "x€" * 2000, "a🎱" * 2000, "%" * 3000,
])  # fmt: skip
def test_any_instance_name_makes_a_good_message(universal, name):
    with raw.Instance(universal, name=name.encode()) as instance:
        complain(instance)
        assert instance.loggers == [name.encode()] * 2
        for message in instance.messages:
            assert name[:50] in message.text
            assert len(message.raw) < 2048
            assert as_printf(message) == message.text.replace("#", "##").encode()


@pytest.mark.parametrize(("name", "shown"), [
    (b"Stra\xdfe", "Stra?e at"),  # Latin-1
    (b"\xff\xfe", "?? at"),
    (b"\x80ball\xe2\x82", "?ball?? at"),
    (b"\xc0\xaf\xf5\x80", "???? at"),  # never in UTF-8
    (b"\xf5\x80\x80\x80", "???? at"),
    (("€" * 67).encode(), "€" * 66 + "?? at"),  # cut after 200 bytes
])  # fmt: skip
def test_what_is_no_utf_8_becomes_question_marks(universal, name, shown):
    with raw.Instance(universal, name=name) as instance:
        complain(instance)
        assert instance.loggers == [name] * 2
        assert instance.messages[0].text.startswith(shown)


def as_printf(message: raw.Message) -> bytes:
    """The message as an importer's printf shows it: it is given as a format, without arguments"""
    libc = ctypes.CDLL(None)
    buffer = ctypes.create_string_buffer(10_000)
    libc.snprintf(buffer, ctypes.c_size_t(10_000), message.raw.encode())
    return buffer.value


def test_a_message_says_instance_time_variable_value_and_range(fmu):
    with raw.Instance(fmu, name=b"tested ball") as instance:
        instance.initialize(start=1.0)
        instance.run([0.25], start=1.0)
        variable = fmu.select("input", kind="Real")[0]
        words = ("tested ball", "1.25 s", variable.name, "1.25e+200", "-1e+150", "1e+150")
        instance.expect(DISCARD, *words)(instance.set_one(variable, 1.25e200))


def test_every_message_carries_the_category_of_its_status(fmu):
    with raw.Instance(fmu, logging=True) as instance:
        complain(instance)
        instance.initialize()
        instance.call("DoStep", 0.0, -1.0, 1)
        instance.call("CancelStep")
        instance.run([0.5] * 4)
        assert [m for m in instance.messages if STATUS_CATEGORIES[m.status] != m.category] == []


# In the next tests a logger calls the instance that is telling it something. The instance answers readings
# and refuses everything else without a message, and the run goes as it does without such a logger.

READING = {
    *(f"Get{kind}" for kind in ("Real", "Integer", "Boolean", "String")),
    *(f"Get{kind}Status" for kind in ("", "Real", "Integer", "Boolean", "String")),
    *("SerializedFMUstateSize", "SerializeFMUstate", "GetDirectionalDerivative", "GetRealOutputDerivatives"),
}
UNKNOWN = 4_000_000_000
STATES = ("instantiated", "initialization", "complete", "terminated", "error", "fatal")


class Meddler(raw.Instance):
    """Its logger makes every call there is, wrong ones too, each time it is told something"""

    awake = False  # before the arguments are ready there is nothing to call with
    calls = 0
    depth = 0

    def prepare(self) -> None:
        self.caller = Caller(self)
        self.arguments = {name: self.caller.arguments(name) for name in FUNCTIONS}
        for name in ("SetReal", "SetInteger", "SetBoolean"):
            self.arguments[name] = self._first_input(name)
        del self.messages[:]
        self.awake = True

    def _first_input(self, function: str) -> tuple:
        """An input, for those may always be set, with another value"""
        reference = self.fmu.select("input", kind="Real")[0].reference
        if function != "SetReal":
            return array(c_uint, [reference]), 1, array(c_int, [1])
        return array(c_uint, [reference]), 1, array(c_double, [0.25])

    def _log(self, environment, name, status, category, message) -> None:
        super()._log(environment, name, status, category, message)
        if not self.awake:
            return
        self.depth += 1
        assert self.depth == 1
        self.calls += 1
        told = len(self.messages)
        answers = {name: self.call(name, *arguments) for name, arguments in self.arguments.items()}
        answers["wrong reading"] = self.call("GetReal", array(c_uint, [UNKNOWN]), 1, array(c_double, [0.0]))
        self.faults += [f"{name}: {status}" for name, status in answers.items() if self.is_odd(name, status)]
        if len(self.messages) != told:
            self.faults.append(f"told while telling: {self.texts()[told:]}")
        self.depth -= 1

    state = "complete"  # a column of the table of calls

    def is_odd(self, function: str, status: int | None) -> bool:
        if function == "FreeInstance":
            return status is not None
        if function in READING and allowed(function, self.state):
            return status not in (OK, DISCARD)
        return status != ERROR

    def free(self) -> None:
        self.awake = False
        if hasattr(self, "caller"):
            self.caller.end()
        super().free()

    def __init__(self, *arguments, **options):
        self.faults: list[str] = []
        super().__init__(*arguments, **options)


def wrong_reading(instance: raw.Instance) -> int:
    return instance.call("GetReal", array(c_uint, [UNKNOWN]), 1, array(c_double, [0.0]))


def everything(instance: Meddler) -> tuple:
    """What can be read, and all that is saved once it has been read"""
    if instance.state == "fatal":
        return ()
    given = ("parameter", "input") if instance.state == "instantiated" else ()
    return instance.bits(*given), instance.save()


@pytest.mark.parametrize("state", STATES)
def test_in_every_phase_reading_is_answered_and_the_rest_refused(fmu, state):
    with Meddler(fmu) as instance:
        bring_to(instance, state)
        instance.state = state
        before = everything(instance)
        instance.prepare()
        assert wrong_reading(instance) == ERROR
        assert (instance.calls, len(instance.messages), instance.faults) == (1, 1, [])
        instance.awake = False
        assert everything(instance) == before


@pytest.mark.parametrize("name", RUNS)
def test_a_run_goes_the_way_it_goes_without(name):
    """A refusal before each step, and the events of each; the bits are those of a run that nobody watches"""
    run = RUNS[name]
    plain = begin(run, logging=True)
    meddled = Meddler(raw.load(run.scene), logging=True)
    meddled.initialize({**run.values, **run.inputs(0.0)}, tolerance=run.tolerance)
    with plain, meddled:
        plain.save()  # as preparing does; it lets the integrator start afresh
        plain.messages.clear()  # likewise: of a deep start
        meddled.prepare()
        for index in range(run.steps):
            assert wrong_reading(meddled) == ERROR
            assert step(meddled, run, index) == step(plain, run, index)
        assert meddled.faults == []
        events = sum(message.category == "logEvents" for message in plain.messages)
        assert meddled.calls == run.steps + events
        assert [message for message in meddled.messages if message.status != ERROR] == plain.messages


@pytest.mark.parametrize("scene", raw.SOLVER_SCENES)
def test_a_step_that_stops_early_may_be_watched(scene):
    """Each stop is told from the midst of fmi2DoStep; what is read there is what is read afterwards"""
    busy = {"solver.max_internal_steps": 1}
    if scene != "HertzImpact":
        busy["contact.penalty_factor"] = 1e5
    lying = {"destination.axis": [0.0, 1.0, 0.0]} if scene == "SphereCylinder" else {}
    fmu = raw.load(scene)
    height = fmu.variables["source.position[3]"]

    class Watcher(Meddler):
        def _log(self, *told) -> None:
            super()._log(*told)
            if self.awake:
                self.seen = self.get_one(height)

    with Watcher(fmu) as meddled, raw.Instance(fmu) as plain:
        for instance in (meddled, plain):
            instance.initialize({**busy, **lying})
            instance.get_one(height)
        plain.save()
        meddled.prepare()
        time, stops = 0.0, 0
        while time < 1.0 and stops < 200:
            answers = [instance.call("DoStep", time, 1.0 - time, 1) for instance in (meddled, plain)]
            assert answers[0] == answers[1]
            assert meddled.bits() == plain.bits()
            if answers[0] == DISCARD:
                stops += 1
                assert meddled.seen == meddled.get_one(height)
            time = plain.time()
        assert stops > 1
        assert (meddled.faults, meddled.calls) == ([], stops)


def test_a_warning_may_be_watched(universal):
    """It comes from the midst of reading: the bodies overlap and have no direction"""
    values = {"source.center": [0.0, 0.0, 0.0], "contact.location": "outside", "source.motion": "fixed"}
    with Meddler(universal) as meddled, raw.Instance(universal) as plain:
        for instance in (meddled, plain):
            instance.enter_initialization(values)
        meddled.state = "initialization"
        meddled.prepare()
        plain.save()
        assert meddled.bits() == plain.bits()
        assert [message.status for message in meddled.messages] == [WARNING]
        assert (meddled.faults, meddled.calls) == ([], 1)
        meddled.awake = False
        assert meddled.save() == plain.save()


def test_a_refused_initialization_and_a_refused_state_may_be_watched(universal):
    with Meddler(universal) as instance:
        instance.enter_initialization({"contact.location": "inside", "destination.radius": 0.05})
        instance.state = "initialization"
        instance.prepare()
        assert instance.call("ExitInitializationMode") == ERROR
        wrong = bytearray(instance.caller.bytes)
        wrong[-1] ^= 1
        assert instance.deserialize(bytes(wrong))[0] == ERROR
        assert (instance.faults, instance.calls) == ([], 2)
        instance.set({"destination.radius": 0.5, "contact.location": "outside"})
        instance.ok("ExitInitializationMode")
        instance.run([0.1])


def test_what_is_not_freed_while_telling_is_freed_afterwards(fmu):
    """An instance that its own logger tried to free lives on and can be freed"""
    with Meddler(fmu) as instance:
        instance.initialize()
        instance.prepare()
        assert wrong_reading(instance) == ERROR
        state, size = instance.taken(), c_size_t()
        instance.ok("SerializedFMUstateSize", state, byref(size))
        instance.ok("FreeFMUstate", byref(state))
        instance.run([0.1])


def test_another_instance_may_be_called_meanwhile(fmu):
    """What is refused is the instance that is telling, not the others"""
    with raw.Instance(fmu) as other:
        other.initialize()

        class Neighbour(raw.Instance):
            def _log(self, *told) -> None:
                super()._log(*told)
                other.run([0.125], start=other.time())

        with Neighbour(fmu) as instance:
            assert wrong_reading(instance) == ERROR
        assert other.time() == 0.125
