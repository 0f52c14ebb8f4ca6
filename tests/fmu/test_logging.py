"""Messages: who hears which, and that each is a complete text of bounded length whatever its parts are."""

import ctypes
from ctypes import c_char_p

import pytest

from support.fmi2 import raw
from support.fmi2.raw import DISCARD, ERROR, OK, array
from support.fmi2.runs import RUNS, begin, go_on

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
    with instance.expect(ERROR, "fmi2SetDebugLogging", *CATEGORIES) as got:
        got(choose(instance, True, b"logEvents", name))
    assert complain(instance) == ["logStatusDiscard", "logStatusError"]


def test_a_null_category_is_refused(fmu):
    with raw.Instance(fmu) as instance, instance.expect(ERROR, "fmi2SetDebugLogging") as got:
        got(instance.call("SetDebugLogging", 1, 2, (c_char_p * 2)(b"logAll", None)))


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
        with instance.expect(
            DISCARD, "tested ball", "1.25 s", variable.name, "1.25e+200", "-1e+150", "1e+150"
        ) as got:
            got(instance.set_one(variable, 1.25e200))


def test_every_message_carries_the_category_of_its_status(fmu):
    with raw.Instance(fmu, logging=True) as instance:
        complain(instance)
        instance.initialize()
        instance.call("DoStep", 0.0, -1.0, 1)
        instance.call("CancelStep")
        instance.run([0.5] * 4)
        assert [
            message for message in instance.messages if STATUS_CATEGORIES[message.status] != message.category
        ] == []
