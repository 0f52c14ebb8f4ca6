"""The sources in the FMUs: any C11 compiler makes a library of them that gives the bits of the one inside"""

import importlib
import sys
import zipfile
from functools import cache

import fmpy
import pytest

from support import portable_host
from support.fmi2.elf import exported, needed
from support.portable_host import HEADERS, SOURCE, motion
from support.programs import checked, finished
from support.release import cases_of, few_cases_of
from support.scenes.benchmarks import BENCHMARKS
from support.sources import BUILD, ROOT

sys.path.insert(0, str(ROOT / "cmake"))
prune = importlib.import_module("prune")
WARNINGS = ["-Wall", "-Wextra", "-pedantic", "-Werror"]
LIBRARIES = {"libc.so.6", "libm.so.6"}

SCENE_FILES = (ROOT / "modelDescription" / "scenes").glob("*.toml")


def compile_c(*arguments, cwd):
    run = finished(["gcc", "-std=c11", *map(str, arguments)], cwd=cwd)
    assert (run.returncode, run.stderr) == (0, "")


@pytest.fixture(scope="module")
def host(tmp_path_factory):
    """host.c, the importer that compiles everywhere"""
    program = tmp_path_factory.mktemp("host") / "host"
    compile_c(*WARNINGS, "-O1", f"-I{HEADERS}", SOURCE, "-ldl", "-o", program, cwd=ROOT)
    return program


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory):
    """Folders of FMUs, each unpacked once"""

    @cache
    def unpack(name):
        return portable_host.unpacked(BUILD / "fmus" / f"{name}.fmu", tmp_path_factory.mktemp(name))

    return unpack


@pytest.fixture(scope="module")
def compiled(unpacked):
    """Libraries of the sources, each compiled once, without any help of this project's build. Without an
    optimizer too, all that is called is there."""

    @cache
    def library(name, *definitions):
        folder = unpacked(name) / "sources"
        file = folder / f"{name}{len(definitions)}.so"
        options = [*WARNINGS, "-O0", "-shared", "-fPIC", "-Wl,-z,defs", *definitions]
        compile_c(*options, "-o", file, "contact.c", "-lm", cwd=folder)
        return file

    return library


def run(host, library, folder, benchmark):
    return motion([host], library, folder, benchmark.configuration, benchmark.end)


@pytest.mark.parametrize("name", BENCHMARKS)
def test_a_plain_compiler_gives_the_bits_of_the_library_inside(host, unpacked, compiled, name):
    """Of one FMU with the compiler's extensions, of the other by C11 alone"""
    benchmark = BENCHMARKS[name]
    folder = unpacked(benchmark.fmu)
    inside = folder / "binaries" / "linux64" / f"{benchmark.fmu}.so"
    definitions = ["-DCONTACT_PLAIN_C"] if benchmark.fmu == "SphereCylinder" else []
    own = run(host, compiled(benchmark.fmu, *definitions), folder, benchmark)
    assert own == run(host, inside, folder, benchmark)
    position = [float(word) for word in own.splitlines()[-1].split()[1:4]]
    assert position == pytest.approx(benchmark.position, abs=1e-9)


def test_the_library_shows_only_the_functions_of_fmi(unpacked, compiled):
    library = compiled("SphereSphere")
    inside = unpacked("SphereSphere") / "binaries" / "linux64" / "SphereSphere.so"
    assert exported(library) == exported(inside)
    assert needed(library) <= LIBRARIES


@pytest.mark.parametrize("name", ["ForceElement", "PinnedEvent", "TippingRoller"])
def test_all_that_is_called_is_there_without_an_optimizer_too(compiled, name):
    assert compiled(name).is_file()


def test_the_file_has_no_branch_that_the_scene_decides(unpacked):
    text = (unpacked("PinnedEvent") / "sources" / "contact.c").read_text()
    assert "#if defined __GNUC__" in text
    assert "#if SCENE_" not in text
    assert "#ifndef CONTACT_ANY_" not in text
    assert "plane_gap" not in text


LOST = """\
static const double LOST[] = {
    1.0,
};
"""
# One that other files see is as lost, with what it is made of.
SHARED = """\
static const double node[1] = {
    0.5,
};
const struct pair shared = {1.0, node};
"""
# A structure that only another of which nobody speaks has
UNNAMED = """\
struct inner {
    double a;
};
struct outer {
    struct inner b;
};
"""
DECLARED = "static double helper(const double *x,\n                     double y);\n"
BRANCH = "#if SCENE_A && !SCENE_B\n"
LAST_BRANCH = "#elif SCENE_C\nint other;\n#endif\n"
OF_D = "#ifdef CONTACT_ANY_D\n"
NOT_D = "#else\nint gone;\n#endif\n"
ASKED_BY_NOBODY = """\
static double near_by(void);
static double near_by(void)
{
    return LOST[0];
}
CONTACT_NOT_FUSED struct pair
of_a_long_type(double x)
{
    return (struct pair){x, near_by()};
}
"""
SOURCES = f"""\
#define NEAR(x) near_(x)
static const double FAR = 3.0;
{LOST}struct pair {{
    double first, near_by;
}};
extern const struct pair shared;
{DECLARED}{UNNAMED}{SHARED}{BRANCH}double near_(double x);
{LAST_BRANCH}{OF_D}#ifdef __GNUC__
int kept;
#endif
{NOT_D}static double helper(const double *x,
                     double y)
{{
    const double near_by = x[0];
    return near_by + y + FAR;
}}
{ASKED_BY_NOBODY}double near_(double x)
{{
    return apply(helper, x);
}}
int fmi2Call(void)
{{
    return (int)NEAR(1.0);
}}
"""


def test_what_nothing_asks_for_is_left_out_of_the_sources():
    """A function that is handed over is asked for; a variable or a member of its name is not it. One that is
    defined first needs no declaration, unless a macro names it."""
    header = "#define SCENE_A 1 /* one */\n#define SCENE_B 0\n"
    wanted = SOURCES
    for part in (LOST, DECLARED, UNNAMED, SHARED, BRANCH, LAST_BRANCH, OF_D, NOT_D, ASKED_BY_NOBODY):
        assert part in wanted
        wanted = wanted.replace(part, "")
    assert prune.pruned(SOURCES, header, ["CONTACT_ANY_D"]) == wanted


PINNED = """\
#define SCENE_A 1
#define SCENE_B 0
#define SCENE_CONTACTS 1
static inline enum law contact_law(const struct values *v, int contact)
{
    (void)v;
    (void)contact;
    return LAW_LINEAR;
}
"""
# Before and after
DECIDED = [
    ("x = SCENE_A && a(y) ? b(y) : c(y);", "x = a(y) ? b(y) : c(y);"),
    ("x = SCENE_B && a(y) ? b(y) : c(y);", "x = c(y);"),
    ("return y > 1 ? (struct s){b(y), SCENE_B ? 1 : 2} : e;", "return y > 1 ? (struct s){b(y), 2} : e;"),
    ("x = a(y, !SCENE_A || y);", "x = a(y, y);"),
    ("x = SCENE_CONTACTS > 1 || contact_law(v, y) == LAW_HERTZ || y;", "x = y;"),
    ("x = y || SCENE_A;", "x = true;"),
    ("x = x || SCENE_B;\n    a(y);", "a(y);"),
    ("x = a(y) * SCENE_CONTACTS;", "x = a(y) * SCENE_CONTACTS;"),
    ("if (contact_law(v, y) != LAW_LINEAR) {\n        a(y);\n    }\n    b(y);", "b(y);"),
    ("if (SCENE_A) {\n        return a(y);\n    }\n    return b(y);", "return a(y);"),
    ("if (SCENE_A) {\n        x = a(y);\n    } else {\n        x = b(y);\n    }",
        "{\n        x = a(y);\n    }"),
    (
        "if (y) {\n        x = a(y);\n    } else if (SCENE_A) {\n        x = b(y);\n"
        "    } else {\n        c(y);\n    }",
        "if (y) {\n        x = a(y);\n    } else {\n        x = b(y);\n    }",
    ),
    ("for (int i = 0; i < y && SCENE_B; ++i) {\n        a(i);\n    }\n    b(y);", "b(y);"),
    ("while (SCENE_A && y) {\n        a(y);\n    }", "while (y) {\n        a(y);\n    }"),
    ("const bool known = SCENE_B;\n    x = known && a(y);", "const bool known = SCENE_B;\n    x = false;"),
    ("const bool known = a(y) ? b(y) : c(y) || SCENE_A;\n    x = known && a(y);",
        "const bool known = a(y) ? b(y) : true;\n    x = known && a(y);"),
    ("const bool SCENE_A = y;\n    x = SCENE_A && a(y);",
        "const bool SCENE_A = y;\n    x = SCENE_A && a(y);"),
]  # fmt: skip


@pytest.mark.parametrize(("before", "after"), DECIDED)
def test_what_the_scene_decides_is_decided_in_the_sources(before, after):
    """Whatever stays has the value that it had."""
    text = "enum law {\n    LAW_LINEAR,\n    LAW_HERTZ\n};\nint fmi2Call(int y)\n{\n    %s\n}\n"
    assert prune.pruned(text % before, PINNED, []) == text % after


HEADER = """\
#ifndef SCENE_H
#define SCENE_H
#define SCENE_BODIES 2
#define HAS_body_radius 1
#define HAS_body_mass 0
static inline int body_count(void)
{
    return SCENE_BODIES;
}
static inline int body_shape(int body)
{
    return body;
}
#endif
"""
UNUSED = ("#define HAS_body_mass 0\n", "static inline int body_shape(int body)\n{\n    return body;\n}\n")


def test_the_header_of_the_sources_has_what_they_ask_for():
    wanted = HEADER
    for part in UNUSED:
        assert part in wanted
        wanted = wanted.replace(part, "")
    assert prune.pruned_header(HEADER, "int a = HAS_body_radius * body_count();") == wanted


def test_fmpy_compiles_the_sources(unpacked, tmp_path):
    """The command of fmpy's users; its CMake project links no libm, which Python itself has"""
    folder = unpacked("ForceElement")
    fmu = tmp_path / "ForceElement.fmu"
    with zipfile.ZipFile(fmu, "w") as archive:
        for file in sorted(folder.rglob("*")):
            place = file.relative_to(folder)
            if file.is_file() and place.parts[0] != "binaries":
                archive.write(file, place)
    checked([sys.executable, "-m", "fmpy", "compile", fmu])
    made = fmpy.simulate_fmu(str(fmu), stop_time=0.1, output_interval=0.01)
    inside = fmpy.simulate_fmu(str(BUILD / "fmus" / "ForceElement.fmu"), stop_time=0.1, output_interval=0.01)
    assert made.tobytes() == inside.tobytes()


@pytest.mark.parametrize("scene", sorted(path.stem for path in SCENE_FILES))
def test_every_check_of_a_release_has_a_case_of_any_scene(scene):
    """scripts/package.sh --check takes the scenes that it is given."""
    assert scene in cases_of([scene]) and few_cases_of([scene])
