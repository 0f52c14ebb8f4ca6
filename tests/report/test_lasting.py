"""What docs/lasting_contact.md says of Radau IIA and exponential collocation."""

import json
import math

import numpy as np
import pytest

from contact_fmus.lasting import study as lasting
from contact_fmus.lasting.radau import radau
from contact_fmus.lasting.study import DAMPING, EXPONENTIAL, PENALTIES, Method, amplitude, measure

UNDAMPED = 0.0
WANTED = 1e-9  # m
both = pytest.mark.parametrize("variables", ["plane", "space"])


def test_three_stages_have_the_coefficients_of_the_literature():
    """Hairer and Wanner, Solving Ordinary Differential Equations II, table IV.5.6"""
    root = math.sqrt(6.0)
    table = [
        [(88 - 7 * root) / 360, (296 - 169 * root) / 1800, (-2 + 3 * root) / 225],
        [(296 + 169 * root) / 1800, (88 + 7 * root) / 360, (-2 - 3 * root) / 225],
        [(16 - root) / 36, (16 + root) / 36, 1 / 9],
    ]
    assert (
        np.max(np.abs(radau(3).matrix - table)) < 5e-15
    )  # the nodes and a linear system, each some roundings


@both
@pytest.mark.parametrize("stages", [3, 5])
def test_radau_has_its_order_in_damped_contact(stages, variables):
    """The error falls by 2^(2 s - 1) where the step is halved."""
    coarse, fine = (measure(Method(variables, stages), DAMPING, 1e9, count).error for count in (20, 40))
    assert math.log2(coarse / fine) == pytest.approx(2 * stages - 1, abs=0.6)


@both
def test_a_step_is_exact_to_its_stages_order_of_quadrature(variables):
    """As many stages as the exponential method has nodes: the same step takes either to 1e-11."""
    for method in (Method(variables, 12), EXPONENTIAL):
        assert measure(method, DAMPING, 1e7, 5).error < 1e-11


@pytest.mark.parametrize("penalty", PENALTIES[DAMPING])
def test_both_reach_the_damped_motion_whatever_the_stiffness(penalty):
    assert measure(Method("space", 8), DAMPING, penalty, 10).error < WANTED
    assert measure(Method("plane", 8), DAMPING, penalty, 5).error < WANTED
    assert measure(EXPONENTIAL, DAMPING, penalty, 5).error < WANTED


@pytest.mark.parametrize("penalty", PENALTIES[UNDAMPED])
@pytest.mark.parametrize("count", [10, 20, 40])
def test_exponential_collocation_keeps_the_undamped_oscillation(penalty, count):
    error = measure(EXPONENTIAL, UNDAMPED, penalty, count).error
    assert error < WANTED
    assert error < 0.1 * amplitude(penalty)


@both
@pytest.mark.parametrize("penalty", PENALTIES[UNDAMPED])
@pytest.mark.parametrize("stages, count", [(8, 20), (8, 100), (12, 10), (12, 40)])
def test_radau_loses_the_undamped_oscillation(stages, count, penalty, variables):
    """Off by about its amplitude, with long steps and with shorter ones"""
    error = measure(Method(variables, stages), UNDAMPED, penalty, count).error
    assert 0.2 * amplitude(penalty) < error < 1.2 * amplitude(penalty)


def test_radau_keeps_the_oscillation_once_it_sees_it():
    """5 radians of the oscillation in a step"""
    assert measure(Method("plane", 12), UNDAMPED, 1e5, 400).error < WANTED


@pytest.mark.parametrize("damping", PENALTIES)
def test_the_work_does_not_grow_with_the_stiffness(damping):
    for method in (Method("space", 8), EXPONENTIAL):
        counts = [measure(method, damping, penalty, 10).evaluations for penalty in PENALTIES[damping][1:]]
        assert max(counts) <= 1.02 * min(counts)


def test_a_sweep_evaluates_every_node_and_solves_nothing():
    point = measure(EXPONENTIAL, DAMPING, 1e7, 5)
    assert point.evaluations == 12 * point.iterations
    assert point.solves == 0
    assert 10 * 5 < point.iterations < 20 * 5


def test_the_command_writes_data_figure_and_tables(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(lasting, "COUNTS", (5, 10))
    lasting.main(["--output", str(tmp_path), "--quick"])
    points = json.loads((tmp_path / "lasting.json").read_text())
    assert len(points) == 9 * 2 * len(lasting.METHODS)
    assert (tmp_path / "lasting.png").read_bytes().startswith(b"\x89PNG")
    assert "</svg>" in (tmp_path / "lasting.svg").read_text()
    assert "| undamped | 1e7 |" in capsys.readouterr().out
