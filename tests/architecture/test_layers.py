"""No include points back: math, contact, scene, flight, prescribed, touch, integrator, model, fmi, fmi2."""

import pytest

from support import sources
from support.graph import circle, file_graph, object_symbols, symbols, upward
from support.sources import ADAPTERS, HEADERS, LAYERS, SCENES, SOURCE, UNITS, includes, label, layer

C_LIBRARY = {"assert.h", "float.h", "limits.h", "math.h", "stdarg.h", "stdbool.h", "stddef.h", "stdint.h"}
C_LIBRARY |= {"stdio.h", "stdlib.h", "string.h"}
SUNDIALS = ("cvode", "nvector", "sundials", "sunlinsol", "sunmatrix", "sunnonlinsol")

every_file = pytest.mark.parametrize("file", HEADERS + UNITS, ids=label)


def test_the_layers_are_the_folders():
    assert {layer(file) for file in HEADERS + UNITS} == set(LAYERS)


@every_file
def test_an_include_never_points_back(file):
    own = LAYERS.index(layer(file))
    for name, quoted in includes(file):
        if quoted and "/" in name:
            assert LAYERS.index(name.partition("/")[0]) <= own, name
            assert (SOURCE / name).is_file()
            others = set(ADAPTERS) - {layer(file)} if layer(file) in ADAPTERS else set()
            assert name.partition("/")[0] not in others


@every_file
def test_each_layer_includes_only_the_libraries_it_may(file):
    """The FMI headers are their adapter's, SUNDIALS the integrator's, the scene not for math, contact."""
    for name, quoted in includes(file):
        if name in C_LIBRARY or (quoted and "/" in name):
            continue
        if name == "scene.h":
            assert layer(file) not in ("math", "contact")
        elif name.startswith(ADAPTERS):
            assert layer(file) == name[:4]
        else:
            assert name.partition("/")[0] in SUNDIALS
            assert layer(file) == "integrator"
            assert file.stem.startswith("cvode")


def test_no_header_includes_itself_by_way_of_others():
    graph = {label(file): [f"fmu_src/{name}" for name, _ in includes(file)] for file in HEADERS}

    def visit(name, path):
        assert name not in path, " -> ".join([*path, name])
        for target in graph.get(name, []):
            visit(target, [*path, name])

    for name in graph:
        visit(name, [])


def test_every_source_is_one_of_some_scene():
    assert set(UNITS) <= {unit for scene in SCENES for unit in sources.units_of(scene)}
    assert set(HEADERS) == {header for scene in SCENES for header in sources.headers_of(scene)}


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("compiler", sources.COMPILERS)
def test_every_header_compiles_alone(tmp_path, compiler, scene):
    said = {}
    for file in sources.headers_of(scene):
        unit = tmp_path / "alone.c"
        name = file.relative_to(SOURCE).as_posix()
        unit.write_text(f'#include "{name}"\n#include "{name}"\n')
        said[name] = sources.compile_c(compiler, unit, scene, "-fsyntax-only")
    assert {name: text for name, text in said.items() if text} == {}


# For their symbols gcc compiles the units of the other scenes, with the same warnings.
@pytest.mark.parametrize("compiler, scene", [("gcc", "PinnedEvent"), *(("clang", scene) for scene in SCENES)])
def test_every_unit_compiles_by_itself(tmp_path, compiler, scene):
    """The FMUs compile all of it as one unit, which would hide a missing include."""
    header = tmp_path / "alone.c"
    header.write_text('#include "scene.h"\n#include "scene.h"\n')
    units = [header, *sources.units_of(scene)]
    said = {unit.name: sources.compile_c(compiler, unit, scene, "-fsyntax-only") for unit in units}
    assert {name: text for name, text in said.items() if text} == {}


@pytest.mark.parametrize("scene", SCENES[1:])
def test_a_scene_links_without_optimization(tmp_path, scene):
    """A Debug build keeps calls into files that the scene leaves out, unless SCENE_ANY_... guards them."""
    unity = tmp_path / "unity.c"
    unity.write_text("".join(f'#include "{unit}"\n' for unit in sources.units_of(scene, "fmi2")))
    link = ["-shared", "-fPIC", "-fvisibility=hidden", "-ffunction-sections", "-Wl,--gc-sections,-z,defs"]
    linked = ["-Wl,--no-as-needed", "-lm", "-o", str(tmp_path / "scene.so")]
    assert sources.compile_c("gcc", unity, scene, "-O0", *link, *linked) == ""


# The file graph of fmu_src, read off the object files' own symbols: no circle, no edge to a later folder.
#
# Includes tell less: two files may include each other's headers' headers without needing each other, and a
# prototype may be declared where no include shows it.


@pytest.mark.parametrize("scene", ["SphereCylinder", "ForceElement"])
def test_there_is_no_global_mutable_state(scene):
    """No symbol in .data or .bss"""
    found = {
        unit: [row for row in symbols(unit, scene) if row[-2] in "dDbBgGsSC"]
        for unit in sources.units_of(scene)
    }
    assert {unit: rows for unit, rows in found.items() if rows} == {}


# The scene that has all files but the one in which a scene's motion is given, and each adapter
@pytest.fixture(scope="module", params=[("SphereCylinder", "fmi2"), ("ForceElement", "fmi3")], ids=str)
def edges(request):
    scene, adapter = request.param
    units = {
        unit.relative_to(SOURCE).as_posix(): object_symbols(unit, scene)
        for unit in sources.units_of(scene, adapter)
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
