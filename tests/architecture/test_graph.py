"""The file graph of fmu_src, read off the object files' own symbols: no circle, no edge to a later folder.

Includes tell less: two files may include each other's headers' headers without needing each other, and a
prototype may be declared where no include shows it.
"""

import pytest

from support.graph import circle, file_graph, object_symbols, upward
from support.sources import LAYERS, SOURCE, units_of


# The scene that has all files but the one in which a scene's motion is given, and each adapter
@pytest.fixture(scope="module", params=[("SphereCylinder", "fmi2"), ("ForceElement", "fmi3")], ids=str)
def edges(request):
    scene, adapter = request.param
    units = {
        unit.relative_to(SOURCE).as_posix(): object_symbols(unit, scene)
        for unit in units_of(scene, adapter)
        if unit.is_relative_to(SOURCE)
    }
    return file_graph(units)


def test_the_graph_has_the_edges_that_one_knows(edges):
    step = "fmi2/fmi2.c" if "fmi2/fmi2.c" in edges else "fmi3/fmi3.c"
    assert {"model/model.c", "fmi/instance.c"} <= edges[step]
    assert "contact/law.c" in edges["model/outputs.c"]


def test_no_two_files_need_each_other_even_by_way_of_others(edges):
    assert circle(edges) is None


def test_no_file_needs_one_of_a_later_folder(edges):
    assert upward(edges, LAYERS) == []


def test_an_upward_edge_that_is_added_is_found(edges):
    assert upward(edges | {"math/polynomial.c": {"scene/evaluate.c"}}, LAYERS) == [
        "math/polynomial.c -> scene/evaluate.c"
    ]
