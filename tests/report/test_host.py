"""fmu_host measures what it says: the same bits as fmpy, all runs told, clear refusals, no leak."""

import os

import pytest

from contact_fmus.fmu.host import Case, HostError, HostTimeout, case_arguments, host_file, run_host
from support.programs import finished
from support.scenes.benchmarks import BENCHMARKS
from support.sources import HOST_SOURCES, fmi_headers

OUTPUTS = ("source.position", "contact.onsets", "contact.active", "solver.method", "contact.gap")


def case_of(fmu_path, name, method="event_driven", steps=7, **changes):
    problem = BENCHMARKS[name]
    start = {**problem.configuration, "solver.method": method, **changes.pop("start", {})}
    about = (f"{name} {method}", fmu_path(problem.fmu), problem.end, steps, start)
    return Case(*about, outputs=OUTPUTS, **changes)


def without_sanitizer():
    return {name: one for name, one in os.environ.items() if name not in ("LD_PRELOAD", "ASAN_OPTIONS")}


def run_raw(*arguments):
    return finished([host_file(), *arguments])


@pytest.mark.parametrize("steps", [1, 7])
@pytest.mark.parametrize("method", ["event_driven", "cvode_adams"])
@pytest.mark.parametrize("name", ["P1", "P2"])
def test_the_host_computes_what_fmpy_computes(fmu_path, opened, name, method, steps):
    result = run_host([case_of(fmu_path, name, method, steps, tolerance=1e-9)])[0]
    problem = BENCHMARKS[name]
    fmu = opened(problem.fmu)
    fmu.start({**problem.configuration, "solver.method": method}, tolerance=1e-9)
    for k in range(steps):
        fmu.step(problem.end * ((k + 1) / steps) - fmu.time)
    assert result.outputs["source.position"].tolist() == fmu["source.position"].tolist()
    assert result.outputs["contact.gap"] == fmu["contact.gap"]
    assert {key: result.outputs[key] for key in OUTPUTS[1:4]} == {key: fmu[key] for key in OUTPUTS[1:4]}


@pytest.mark.parametrize("fresh", [False, True])
def test_repeated_runs_end_with_the_same_bits(fmu_path, fresh):
    cases = [case_of(fmu_path, "P2", "cvode_bdf"), case_of(fmu_path, "P2")]
    once = [result.outputs["source.position"].tolist() for result in run_host(cases)]
    again = [result.outputs["source.position"].tolist() for result in run_host(cases, 3, fresh=fresh)]
    assert again == once


@pytest.fixture
def squares(tmp_path, monkeypatch):
    """The host's clock shows 0, 1, 4, 9, ... s, whatever time it is. Run r asks it three times, so that its
    initialization takes 6 r + 1 s and its stepping 6 r + 3 s."""
    source, library = tmp_path / "squares.c", tmp_path / "squares.so"
    source.write_text(
        "#include <time.h>\n"
        "int clock_gettime(clockid_t id, struct timespec *time)\n"
        "{\n    static long asked;\n    (void)id;\n    *time = (struct timespec){asked * asked, 0};\n"
        "    asked++;\n    return 0;\n}\n"
    )
    finished(["gcc", "-shared", "-fPIC", source, "-o", library], check=True)
    monkeypatch.setenv("LD_PRELOAD", " ".join(filter(None, [os.environ.get("LD_PRELOAD"), str(library)])))


@pytest.mark.usefixtures("squares")
def test_every_run_has_its_times_and_they_are_those_that_pass(fmu_path):
    results = run_host([case_of(fmu_path, "P1"), case_of(fmu_path, "P2")], repeat=3, burst=2)
    for result, runs in zip(results, ([0, 1, 4, 5, 8, 9], [2, 3, 6, 7, 10, 11]), strict=True):
        assert result.times == [6 * run + 3 for run in runs]
        assert result.initialization == [6 * run + 1 for run in runs]
        assert (result.least, result.median) == (6 * runs[0] + 3, 3 * (runs[2] + runs[3]) + 3)


@pytest.mark.usefixtures("squares")
def test_a_spent_budget_ends_the_repetition(fmu_path):
    first, second = run_host([case_of(fmu_path, "P1"), case_of(fmu_path, "P2")], 5, budget=20)
    assert (first.times, second.times) == ([3, 15, 27], [9, 21])


def test_reading_after_every_step_changes_nothing(fmu_path):
    plain, reading = (
        run_host([case_of(fmu_path, "P1", steps=2000, get=get)])[0]
        for get in ((), [["source.position"], ["source.velocity", "contact.gap"]])
    )
    assert plain.outputs["source.position"].tolist() == reading.outputs["source.position"].tolist()


def test_a_refusing_fmu_is_named_and_the_others_go_on(fmu_path):
    cases = [case_of(fmu_path, "P1", start={"source.radius": -1.0}), case_of(fmu_path, "P2")]
    with pytest.raises(HostError, match=r"case P1 event_driven: fmi2SetReal returned fmi2Discard: .*radius"):
        run_host(cases)
    refused, good = run_host(cases, keep_going=True)
    assert "source.radius" in refused.error
    assert good.outputs["contact.onsets"] == 2


def test_a_step_that_is_discarded_is_named(fmu_path):
    with pytest.raises(HostError, match=r"fmi2DoStep .* of step 1 from 0 s returned fmi2Discard: .*internal"):
        run_host([case_of(fmu_path, "P3", "cvode_bdf", start={"solver.max_internal_steps": 5})])


def test_a_run_that_takes_too_long_is_ended(fmu_path):
    with pytest.raises(HostTimeout, match=r"not done after 0\.2 s"):
        run_host([case_of(fmu_path, "P1", steps=10**9)], timeout=0.2)


def test_names_are_checked_before_anything_runs(fmu_path):
    with pytest.raises(KeyError, match=r"SphereSphere\.fmu has no variable 'source\.colour'"):
        run_host([case_of(fmu_path, "P1", start={"source.colour": 1})])
    with pytest.raises(ValueError, match=r"source\.center takes 3 numbers"):
        run_host([case_of(fmu_path, "P1", start={"source.center": 1.0})])


BAD = {
    "no case": ([], "no --case given"),
    "unknown": (["--case", "a", "--speed", "1"], "unknown option --speed"),
    "before a case": (["--steps", "1"], "--steps before the first --case"),
    "no value": (["--case"], "--case is no option, or lacks its value"),
    "repeat": (["--repeat", "0"], "--repeat 0: expected an integer from 1"),
    "budget": (["--budget", "nan"], "--budget nan: expected a finite number"),
    "steps": (["--case", "a", "--steps", "1.5"], "--steps 1.5: expected an integer"),
    "reference": (["--case", "a", "--set-real", "-1=2"], "expected a value reference"),
    "no number": (["--case", "a", "--set-real", "1=x"], "--set-real x: expected a number"),
    "no equals": (["--case", "a", "--set-integer", "1"], "expected REFERENCE=VALUE"),
    "Boolean": (["--case", "a", "--set-boolean", "1=2"], "expected an integer from 0 to 1"),
    "list": (["--case", "a", "--get", "1;2"], "with commas between them"),
    "states": (["--case", "a", "--states", "6,1,3"], "--states 6,1,3: expected N,M,K and a state"),
    "library": (["--case", "a", "--guid", "g", "--stop-time", "1"], "case a lacks --library"),
    "stop": (["--case", "a", "--guid", "g", "--library", "l", "--stop-time", "0"], "is not after the start"),
}


@pytest.mark.parametrize("arguments, message", BAD.values(), ids=BAD)
def test_bad_arguments_are_refused_with_what_was_expected(arguments, message):
    run = run_raw(*arguments)
    assert run.returncode == 2
    assert message in run.stderr
    assert run.stderr.startswith("fmu_host: ") and run.stderr.count("\n") == 1
    assert run.stdout == ""


def test_a_library_that_is_no_fmu_is_refused():
    missing = ["--case", "a", "--guid", "g", "--stop-time", "1", "--library"]
    run = run_raw(*missing, "nowhere.so")
    assert run.returncode == 1 and "nowhere.so" in run.stderr
    run = run_raw(*missing, "libm.so.6")
    assert run.returncode == 1 and "the library has no function fmi2GetTypesPlatform" in run.stderr


@pytest.fixture(scope="module")
def checked_host(tmp_path_factory):
    """The host with the address sanitizer, which looks for leaks at the end"""
    program = tmp_path_factory.mktemp("host") / "fmu_host"
    command = ["gcc", "-std=c11", "-D_POSIX_C_SOURCE=200809L", "-g", "-fsanitize=address,undefined"]
    command += ["-isystem", str(fmi_headers()), *map(str, HOST_SOURCES), "-o", str(program), "-lm", "-ldl"]
    finished(command, check=True)
    return program


def test_the_host_leaks_nothing_and_stays_within_its_memory(fmu_path, checked_host):
    environment = without_sanitizer()
    get = [["source.position"], ["contact.gap"]]
    arguments = case_arguments(case_of(fmu_path, "P2", "cvode_bdf", get=get))
    arguments += case_arguments(case_of(fmu_path, "P1", get=get))
    refused = case_arguments(case_of(fmu_path, "P1", start={"source.radius": -1.0}))
    for tried, status in (
        (["--repeat", "3", "--burst", "2", *arguments], 0),
        (["--repeat", "3", "--fresh", *arguments], 0),
        ([*arguments, *refused], 1),
        ([*arguments, "--get", "1,x"], 2),
        (["--help"], 0),
    ):
        run = finished([checked_host, *tried], env=environment)
        assert run.returncode == status, run.stderr
        assert "Sanitizer" not in run.stderr and "runtime error" not in run.stderr


def test_the_sanitized_host_would_tell_of_a_leak(checked_host, tmp_path):
    """Without this the test above could pass because nothing looks."""
    source = tmp_path / "leak.c"
    source.write_text("#include <stdlib.h>\nint main(void)\n{\n    return malloc(9) == (void *)1;\n}\n")
    program = tmp_path / "leak"
    finished(["gcc", "-O0", "-fsanitize=address", str(source), "-o", str(program)], check=True)
    run = finished([program], env=without_sanitizer())
    assert run.returncode != 0 and "LeakSanitizer" in run.stderr
