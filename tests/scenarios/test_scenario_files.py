"""Shipped scenario files are valid, wrong ones are refused in one line that names file, place and key"""

from pathlib import Path

import numpy as np
import pytest

from contact_fmus.__main__ import main
from contact_fmus.errors import UserError
from contact_fmus.scenarios.experiment import InputSignal
from contact_fmus.scenarios.scenario import read_scenario

SHIPPED = sorted((Path(__file__).resolve().parents[2] / "scripts" / "scenarios").glob("*.toml"))

GOOD = """
title = "a title"
fmu = "SphereSphere"
[experiment]
stop_time = 1.0
steps = 10
[vary]
"solver.method" = ["cvode_bdf", "cvode_adams"]
[[input]]
variable = "source.external_force"
times = [0.0, 1.0]
values = [1.0, 2.0]
[[claim]]
check = "final_value"
text = "a claim"
variable = "contact.gap"
expected = 0.0
absolute = 1e-6
"""

WRONG = {
    "unknown top key": ('title = "a title"', 'tittle = "a title"', "unknown key 'tittle' (allowed: claim, "),
    "missing title": ('title = "a title"', "", "key 'title' is missing"),
    "unknown key of experiment": ("steps = 10", "step = 10", "[experiment]: unknown key 'step' (allowed: "),
    "type": ("steps = 10", "steps = 1.5", "[experiment]: steps = 1.5 is not of type int"),
    "no steps": ("steps = 10", "steps = 0", "0 is not a positive whole number"),
    "times": ("stop_time = 1.0", "stop_time = -1.0", "stop_time -1.0 is not after start_time 0.0"),
    "vary": ('["cvode_bdf", "cvode_adams"]', '"cvode_bdf"', "[vary]: solver.method needs a list"),
    "unknown key of input": ("values = [", "vales = [", "[[input]] 1: unknown key 'vales'"),
    "falling times": ("times = [0.0, 1.0]", "times = [1.0, 0.0]", "[[input]] 1: times must rise"),
    "mixed forms": ("values = [1.0, 2.0]", "frequency = 1.0", "times, frequency do not go together"),
    "derivative of nothing": ("times = [0.0, 1.0]\nvalues = [1.0, 2.0]", 'derivative_of = "x"',
        "[[input]] 1: derivative_of = 'x' is no input before it"),
    "unknown check": ('"final_value"', '"final"', "[[claim]] 1: check is one of angular_momentum, "),
    "unknown key of claim": ("variable = \"contact.gap\"", "vriable = 1", "unknown key 'vriable'"),
    "missing argument": ("expected = 0.0", "", "[[claim]] 1: key 'expected' is missing"),
    "no error allowed": ("absolute = 1e-6", "", "[[claim]] 1: give either absolute or relative"),
    "two errors allowed": ("absolute = 1e-6", "absolute = 1\nrelative = 1", "either absolute or relative"),
    "negative error": ("absolute = 1e-6", "absolute = -1.0", "the error allowed is -1.0"),
    "NaN error": ("absolute = 1e-6", "absolute = nan", "the error allowed is nan"),
    "when": ("absolute = 1e-6", 'absolute = 1.0\nwhen = { "x" = 1 }', "when: [vary] has no x = 1"),
    "compare": ("[vary]", '[plot]\ncompare = "x"\n[vary]', "compare = 'x' is not a name of [vary]"),
    "no TOML": ("[experiment]", "[experiment", "at line"),
}  # fmt: skip


@pytest.mark.parametrize("file", SHIPPED, ids=lambda file: file.stem)
def test_shipped_scenario_is_valid_and_each_of_its_claims_meets_a_run(file):
    scenario = read_scenario(file)
    for claim in scenario.claims:
        assert any(all(run.choice[n] == x for n, x in claim.when.items()) for run in scenario.variants)
    assert scenario.plotted()


@pytest.mark.parametrize("case", WRONG)
def test_wrong_file_is_refused_in_one_line_naming_file_place_and_key(case, tmp_path, capsys):
    old, new, message = WRONG[case]
    assert GOOD.count(old) == 1
    file = tmp_path / "wrong.toml"
    file.write_text(GOOD.replace(old, new))
    with pytest.raises(UserError) as refused:
        read_scenario(file)
    assert str(refused.value).startswith(f"{file}: ")
    assert message in str(refused.value)
    assert main(["scenarios", str(file), "--output", str(tmp_path)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(UserError, match=r"absent\.toml: No such file"):
        read_scenario(tmp_path / "absent.toml")


def test_vary_makes_a_run_of_every_combination(tmp_path):
    file = tmp_path / "good.toml"
    file.write_text(GOOD.replace("[vary]", "[vary]\nsteps = [1, 7]"))
    runs = read_scenario(file).variants
    assert [(run.steps, run.start["solver.method"]) for run in runs] == [
        (1, "cvode_bdf"),
        (1, "cvode_adams"),
        (7, "cvode_bdf"),
        (7, "cvode_adams"),
    ]
    assert runs[0].label == "1 step, cvode_bdf"


def test_table_input_is_straight_lines_and_a_corner_belongs_to_the_line_after_it():
    table = {"times": [1.0, 2.0, 4.0], "values": [[0.0, 5.0], [1.0, 5.0], [0.0, 9.0]]}
    signal = InputSignal.make("x", 1, table)
    times = (0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 9.0)
    assert [signal.evaluate(time, 0)[0] for time in times] == [0.0, 0.0, 0.5, 1.0, 0.5, 0.0, 0.0]
    assert [signal.evaluate(time, 1)[0] for time in times] == [0.0, 1.0, 1.0, -0.5, -0.5, 0.0, 0.0]
    assert signal.evaluate(3.0, 0)[1] == 7.0


def test_derivatives_of_a_sinusoid_are_those_of_finite_differences():
    options = {"amplitude": [2.0, 3.0], "frequency": 0.7, "phase": 0.4, "offset": [1.0, -1.0]}
    signal = InputSignal.make("x", 2, options)
    velocity = InputSignal.make("v", 0, {"derivative_of": signal})
    h = 1e-5
    for order in (0, 1):
        slope = (signal.evaluate(0.3 + h, order) - signal.evaluate(0.3 - h, order)) / (2.0 * h)
        assert signal.evaluate(0.3, order + 1) == pytest.approx(slope, rel=1e-8)
    assert np.array_equal(velocity.evaluate(0.3, 0), signal.evaluate(0.3, 1))
