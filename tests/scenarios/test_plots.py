"""Pictures of scenarios: bodies where and as they are, and axes that show no rounding"""

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from contact_fmus.fmu.files import Body, Contact, Scene
from contact_fmus.plot import path, picture
from contact_fmus.plot.panels import ENERGIES
from contact_fmus.scenarios.experiment import Motion

SIDE = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])


def made(shape, values=None, **series):
    """A ball, the source, and a destination at rest in the origin, at two times"""
    bodies = (Body("source", "sphere"), Body("destination", shape))
    scene = Scene("made", "made", bodies, (Contact("contact", "source", "destination"),), {})
    known = {
        "source.radius": 0.1,
        "destination.center": (0.0, 0.0, 0.0),
        "destination.axis": (0.0, 0.0, 1.0),
    } | (values or {})
    kept = {name.replace("__", "."): np.asarray(value, dtype=float) for name, value in series.items()}
    return Motion(scene, np.array([0.0, 1.0]), known.get, kept.get)


@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_what_goes_to_minus_x_is_drawn_at_minus_x(way):
    run = made("plane", source__position=[[0.0, 0.0, 0.1], [way, 0.0, 0.1]])
    assert path._horizontal(run) @ [way, 0.0, 0.1] == way
    assert not path._seen_from_above(run)


def test_level_motion_both_ways_is_seen_from_above():
    assert path._seen_from_above(made("plane", source__position=[[0.0, 0.0, 0.1], [1.0, -0.3, 0.1]]))


def test_a_cylinder_is_drawn_as_it_has_turned():
    values = {"destination.radius": 0.1, "destination.finite_length": True, "destination.length": 0.8}
    turned = [[0.0, 0.0, 1.0], [0.0, 0.6, 0.8]]
    run = made("cylinder", values, source__position=np.zeros((2, 3)), destination__current_axis=turned)
    for index, axis in enumerate(turned):
        corners = path.outline(run, "destination", index, SIDE, {}).get_xy()[:4]
        assert np.max(corners @ axis[1:]) == pytest.approx(0.4)
        assert np.max(corners @ [-axis[2], axis[1]]) == pytest.approx(0.1)
    assert isinstance(path.outline(run, "source", 0, SIDE, {}), Circle)


def test_a_long_low_path_lies_above_the_other_panels():
    places = [[0.0, 0.0, 0.1], [8.0, 0.0, 0.1]]
    figure = Figure()
    wide = path.is_wide([made("plane", {"source.radius": 0.1}, source__position=places)])
    way, rows = picture.layout(figure, wide, 4)
    assert way.get_subplotspec().get_topmost_subplotspec().is_first_row()
    assert [axes.get_subplotspec().is_first_row() for axes in rows] == [False] * 4


@pytest.mark.parametrize("values", [[9.81, 9.81 + 1e-12], [-2.4e-5, -2.4e-5 - 1e-14], [1e-17, 9.81]])
def test_rounding_is_no_chatter_and_labels_differ(values):
    axes = Figure().subplots()
    axes.plot([0.0, 1.0], values)
    picture.calm(axes)
    axes.figure.canvas.draw()
    low, high = axes.get_ylim()
    assert low <= min(values) and max(values) <= high
    assert high - low >= picture.LEAST_SPAN * max(abs(low), abs(high))
    texts = [label.get_text() for label in axes.get_yticklabels()]
    assert len(set(texts)) == len(texts)
    assert "+" not in axes.yaxis.get_offset_text().get_text()


def test_each_energy_has_a_colour_of_its_own():
    assert len(set(path.COLORS)) >= len(ENERGIES)
