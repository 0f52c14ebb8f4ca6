"""scene.h and scene_variables.c: compiled by both compilers, and the compiled table read back."""

import ctypes
import functools
import re
import shutil
import sys

import numpy as np
import pytest
from numpy.polynomial import chebyshev, legendre

from support.generator.generated import ROOT, SCENES, describe, folder_of, generate, scene_file
from support.programs import checked, finished

WARNINGS = ["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wdouble-promotion"]
WARNINGS += ["-Wmissing-prototypes", "-Werror"]
COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]
CHAIN = """
name = "Chain"
title = "Three bodies, two contacts"
description = "Lists longer than a pair."
[[body]]
name = "ball"
shape = "sphere"
[[body]]
name = "middle"
shape = "sphere"
[[body]]
name = "roller"
shape = "cylinder"
[[contact]]
name = "upper"
source = "ball"
destination = "middle"
[[contact]]
name = "lower"
source = "middle"
destination = "roller"
[start]
"middle.center" = [0.0, 0.0, 0.8]
"roller.center" = [0.0, 3.0, 0.0]
[pinned]
"ball.motion" = "free"
"roller.motion" = "fixed"
"upper.dashpot" = "unclamped"
"lower.penalty_control" = "automatic"
[leave_out]
outputs = ["upper.point", "body.displacement"]
"""


class Variable(ctypes.Structure):
    """struct variable of model/variable.h."""

    _fields_ = [
        ("name", ctypes.c_char_p),
        *((field, ctypes.c_double) for field in ("min", "max")),
        *((field, ctypes.c_uint32) for field in ("reference", "offset")),
        ("row", ctypes.c_uint16),
        *((field, ctypes.c_uint8) for field in ("type", "causality")),
        ("element", ctypes.c_uint16),
        *(("component", ctypes.c_uint8, 2), ("length", ctypes.c_uint8, 3)),
        *((field, ctypes.c_uint8, 1) for field in ("reinit", "tunable")),
    ]


def compiled(compiler, folder, source, output, *options):
    command = [compiler, *WARNINGS, *options, "-I", ROOT / "fmu_src", "-I", folder, source, "-o", output]
    checked(command)


@pytest.fixture(scope="module")
def scene_folder(tmp_path_factory):
    root = tmp_path_factory.mktemp("c")
    (root / "Chain.toml").write_text(CHAIN)

    @functools.cache
    def get(scene):
        if scene != "Chain":
            return folder_of(scene)
        generate(root / "Chain.toml", root / scene)
        return root / scene

    return get


@pytest.mark.parametrize("scene", [*SCENES, "Chain"])
@pytest.mark.parametrize("compiler", COMPILERS)
def test_header_and_table_compile_without_a_warning(scene_folder, tmp_path, compiler, scene):
    folder = scene_folder(scene)
    alone = tmp_path / "alone.c"
    alone.write_text('#include "scene.h"\n')
    compiled(compiler, folder, alone, tmp_path / "alone.o", "-c")
    compiled(compiler, folder, folder / "scene_variables.c", tmp_path / "table.o", "-c")


def load(folder):
    library = folder.with_suffix(".so")  # beside the folder, whose files are texts
    if not library.exists():
        compiled(COMPILERS[0], folder, folder / "scene_variables.c", library, "-shared", "-fPIC")
    loaded = ctypes.CDLL(str(library))
    loaded.scene_variable.restype = ctypes.POINTER(Variable)
    loaded.scene_variable.argtypes = [ctypes.c_uint32]
    return loaded


def test_the_compiled_table_and_start_values_are_those_of_the_description(scene_folder, scene):
    loaded = load(scene_folder(scene))
    wanted = describe(scene)
    count = ctypes.c_int.in_dll(loaded, "scene_variable_count").value
    table = (Variable * count).in_dll(loaded, "scene_variables")
    values = ctypes.create_string_buffer(b"\xff" * 65536, 65536)
    loaded.scene_start(values)
    assert [entry.name.decode() for entry in table] == list(wanted)
    used = set()
    for entry in table:
        name = entry.name.decode()
        said = wanted[name]
        assert (entry.reference, entry.min, entry.max) == (said["reference"], said["min"], said["max"]), name
        if said["causality"] == "local":
            continue  # computed when it is asked for
        kind = ctypes.c_double if said["base"] == "Real" else ctypes.c_int32
        place = range(entry.offset, entry.offset + ctypes.sizeof(kind))
        assert used.isdisjoint(place), name
        used.update(place)
        start = {"true": 1, "false": 0, None: 0}.get(said["start"], said["start"])
        assert kind.from_buffer(values, entry.offset).value == float(start), name


def test_every_reference_is_found_and_no_other(scene_folder, scene):
    loaded = load(scene_folder(scene))
    names = {entry["reference"]: name for name, entry in describe(scene).items()}
    for reference in [*range(1000), 65535, 65536, 2**31, 2**32 - 1]:
        found = loaded.scene_variable(reference)
        assert (found.contents.name.decode() if found else None) == names.get(reference)


def test_reals_are_read_where_the_table_has_them(scene_folder, scene):
    loaded = load(scene_folder(scene))
    count = ctypes.c_int.in_dll(loaded, "scene_variable_count").value
    table = {entry.reference: entry for entry in (Variable * count).in_dll(loaded, "scene_variables")}
    wanted = describe(scene)
    motion = re.compile(r"\.(displacement|position|velocity)\[[123]\]$")
    reals = (ctypes.c_uint32 * (max(n for n in table if n < 1_000_000) + 1)).in_dll(loaded, "scene_reals")
    for reference, real in enumerate(reals):
        said = wanted[table[reference].name.decode()] if reference in table else None
        if said is None or said["base"] != "Real" or said["causality"] == "local":
            assert real == 0, reference
            continue
        given = said["causality"] in ("parameter", "input")
        name = table[reference].name.decode()
        source = 1 if given else 4 if motion.search(name) else 8
        length = 0 if table[reference].component else table[reference].length
        found = (real & 0xFFFFFF, real >> 24 & 15, real >> 28)
        assert found == (table[reference].offset, source, length), said


PROBE = """
#include <stdio.h>
#include "scene.h"
int main(void)
{
    struct scene_values v;
    scene_start(&v);
    put_body_velocity(&v, 1, vec3_make(1.0, 2.0, 3.0));
    put_body_velocity(&v, 2, vec3_make(7.0, 8.0, 9.0)); /* of a fixed body: goes nowhere */
    put_contact_point(&v, 1, vec3_make(4.0, 5.0, 6.0));
    put_contact_point(&v, 0, vec3_make(7.0, 8.0, 9.0)); /* left out */
    put_solver_relative_tolerance(&v, 1e-5);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        printf("%d %d %g %g %g; ", (int)body_shape(i), body_motion(&v, i), body_radius(&v, i),
               body_axis(&v, i).z, v.body[i].velocity[2]);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        printf("%d %d %d %d %g; ", contact_source(j), contact_destination(j), contact_dashpot(&v, j),
               contact_penalty_control(&v, j), v.contact[j].point[0]);
    }
    printf("%g %d %d", solver_relative_tolerance(&v), HAS_body_displacement, HAS_contact_point);
    return 0;
}
"""


@pytest.mark.parametrize("compiler", COMPILERS)
def test_accessors_of_longer_lists_tell_the_elements_apart(scene_folder, tmp_path, compiler):
    folder = scene_folder("Chain")
    (tmp_path / "probe.c").write_text(PROBE)
    compiled(compiler, folder, tmp_path / "probe.c", tmp_path / "probe", folder / "scene_variables.c", "-lm")
    assert finished([tmp_path / "probe"]).stdout == (
        "0 3 0.1 1 0; 0 3 0.1 1 3; 1 1 0.5 1 0; "  # shape, motion, radius, axis z, velocity z
        "0 1 2 2 0; 1 2 1 1 4; "  # source, destination, dashpot, penalty_control, point x
        "1e-05 0 1"
    )


def test_both_compilers_are_there():
    assert COMPILERS == ["gcc", "clang"]


def test_pinned_choices_are_constants_of_the_header(scene_folder, scene):
    header = (scene_folder(scene) / "scene.h").read_text()
    for name, value in scene_file(scene).get("pinned", {}).items():
        if isinstance(value, list) and isinstance(value[0], str):  # some items of a choice, which stays open
            assert name in describe(scene)
            continue
        group, _, field = name.partition(".")
        if group == "solver":  # a member of the world is named in full
            others, field = [other for other in describe(scene) if other == name], f"{group}_{field}"
        else:
            of_world = ("solver.method", "energy.friction")  # not contact.method and contact.friction
            others = [name for name in describe(scene) if name.endswith(f".{field}") and name not in of_world]
        assert f" {field};" not in header, name
        assert others == [], name


# Tables of constants, which the build computes, satisfy what defines them.

TABLE = re.compile(r"static const double (\w+)\[\d+\] = \{([^}]*)\}")


@pytest.fixture(scope="module")
def tables(tmp_path_factory):
    file = tmp_path_factory.mktemp("nodes") / "node_tables.c"
    checked([sys.executable, ROOT / "cmake" / "make_nodes.py", file])
    return {name: np.array(eval(f"[{values}]")) for name, values in TABLE.findall(file.read_text())}


def legendre_series(*coefficients):
    return legendre.Legendre(coefficients)


@pytest.mark.parametrize("points", [8, 12])
def test_nodes_of_collocation_and_their_polynomials(tables, points):
    node = tables[f"node_{points}"]
    zero = legendre_series(*[0] * (points - 1), 1).deriv() * legendre_series(1 / 3, 0, -1 / 3)
    assert np.abs(zero(node) / zero.deriv()(node)).max() < 1e-15  # the way to the root, by Newton's method
    assert (np.diff(node) > 0).all()
    assert node[-1] == 1.0 and (node == -node[::-1]).all()
    # l_j is 1 at node j and 0 at the others; its integrals are those of its monomials
    lagrange = np.polynomial.polynomial.polyval(node, tables[f"monomial_{points}"].reshape(points, points).T)
    assert np.abs(lagrange - np.eye(points)).max() < 1e-12
    integral = tables[f"integral_{points}"].reshape(points, points)
    for k in range(points):
        assert node**k @ integral == pytest.approx((node ** (k + 1) - (-1) ** (k + 1)) / (k + 1), abs=1e-15)


@pytest.mark.parametrize("stages", [4, 8, 12])
def test_stages_of_radau_integrate_polynomials(tables, stages):
    node = tables[f"radau_node_{stages}"]
    integral, inverse = (tables[f"radau_{of}_{stages}"].reshape(stages, -1) for of in ("integral", "inverse"))
    for k in range(stages):
        assert integral @ node**k == pytest.approx(node ** (k + 1) / (k + 1), abs=1e-15)
    assert integral @ inverse == pytest.approx(np.eye(stages), abs=1e-13)


@pytest.mark.parametrize("stages", [4, 8, 12])
def test_bases_in_which_events_are_sought(tables, stages):
    node = tables[f"radau_node_{stages}"]
    to_chebyshev = tables[f"radau_chebyshev_{stages}"].reshape(stages + 1, stages)
    to_bernstein = tables[f"radau_bernstein_{stages}"].reshape(-1, stages + 1)
    for k in range(1, stages + 1):
        assert chebyshev.chebval(2 * node - 1, to_chebyshev @ node**k) == pytest.approx(node**k, abs=1e-13)
    for k in range(stages + 1):
        # s^k has the Bernstein coefficients binomial(i, k) / binomial(n, k)
        i = np.arange(stages + 1)
        exact = np.prod([(i - j) / (stages - j) for j in range(k)], axis=0) * np.ones(stages + 1)
        values = np.concatenate([[0.0], node]) ** k
        assert values @ to_bernstein == pytest.approx(exact, abs=1e-12)
