"""What a scene pins away is gone: from the interface, from the binary, from the state.

Strings are read from the library inside the FMU, functions and lines of source from the library before it was
stripped. Each claim of absence stands beside one of presence in the universal FMU, which finds new names."""

import re
import zipfile

import fmpy
import numpy as np
import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu
from support.checks import METHODS
from support.fmi2 import elf
from support.generator.generated import scene_file
from support.sources import BUILD, ROOT, units_of

LIBRARIES = BUILD / "libraries"

# Each pinned scene and the universal FMU whose choices it pins.
UNIVERSAL = {"BallOnSphere": "SphereSphere", "BallInShell": "SphereSphere", "BallOffRoller": "SphereCylinder"}
UNIVERSAL |= {"PinnedEvent": "SphereCylinder", "ForceElement": "SphereCylinder"}
UNIVERSAL |= {"HertzImpact": "SphereSphere", "Bowling": "SpherePlane", "TippingRoller": "SphereCylinder"}
# Others that move as the universal FMU does.
MORE = {"BouncingBall": "SpherePlane", "SpinningBall": "SpherePlane", "Turntable": "SpherePlane"}
MORE |= {"GolfersDilemma": "SphereCylinder"}
# Where an axis is at rest that the universal FMU knows by another start value.
UPRIGHT = {"Turntable": "destination.prescribed_axis", "GolfersDilemma": "destination.axis"}
LINEAR = [scene for scene in UNIVERSAL if scene != "HertzImpact"]
pinned_scenes = pytest.mark.parametrize("scene", UNIVERSAL)
SPHERES = ["SphereSphere", "BallOnSphere", "BallInShell"]


def open_start(fmu, name):
    """What lets the FMU with every choice open do the same: what the scene pins, without choices that keep
    several of their items, and all parameters and inputs, whose start values are others there"""
    given = [one for one, of in fmu.variables.items() if of.causality in ("parameter", "input")]
    pinned = {
        key: value
        for key, value in scene_file(name).get("pinned", {}).items()
        if not (isinstance(value, list) and isinstance(value[0], str))
    }
    upright = {UPRIGHT[name]: [0.0, 0.0, 1.0]} if name in UPRIGHT else {}
    return {one: fmu[one] for one in given if not one.endswith("]")} | pinned | upright


BY_CVODE = [(one, by) for one in ("BallOnSphere", "BallInShell", "BallOffRoller") for by in METHODS[1:]]


@pytest.mark.parametrize("scene, method", [*((scene, METHODS[0]) for scene in UNIVERSAL | MORE), *BY_CVODE])
def test_the_universal_fmu_does_the_same(fmu_path, scene, method):
    """With all start values of the scene's FMU: the universal one has others, and other steps by CVODE."""
    ends, start = [], {}
    for name in (scene, (UNIVERSAL | MORE)[scene]):
        with ContactFmu(fmu_path(name)) as fmu:
            start = start or ({"solver.method": method} if "solver.method" in fmu else {})
            fmu.start(start)
            start = open_start(fmu, scene)
            for _ in range(100):
                fmu.step(0.01)
            ends.append({one: fmu[one] for one, of in fmu.variables.items() if of.causality == "output"})
    common = [one for one in ends[0] if one in ends[1] and not one.startswith("solver.")]
    assert len(common) > 10
    allowed = 1e-9 if start.get("solver.method", METHODS[0]) == METHODS[0] else 1e-6
    for one in common:
        if isinstance(ends[0][one], str):
            assert ends[0][one] == ends[1][one], one
        else:
            assert np.allclose(ends[0][one], ends[1][one], rtol=allowed, atol=allowed), one


@pytest.fixture(scope="session")
def variables(fmu_path):
    return lambda scene: {v.name for v in fmpy.read_model_description(str(fmu_path(scene))).modelVariables}


@pytest.fixture(scope="session")
def library_bytes(fmu_path):
    """Size of the stripped library, as it lies in the FMU."""
    return lambda scene: zipfile.ZipFile(fmu_path(scene)).getinfo(f"binaries/linux64/{scene}.so").file_size


@pytest.fixture
def strings(fmu_path, tmp_path):
    """The printable strings of the library inside the FMU."""
    library = "binaries/linux64/{}.so".format
    return lambda scene: elf.text(zipfile.ZipFile(fmu_path(scene)).extract(library(scene), tmp_path))


@pytest.fixture(scope="session")
def state_bytes(fmu_path):
    def size(scene):
        with ContactFmu(fmu_path(scene)) as fmu:
            fmu.start({})
            return len(fmu.save())

    return size


def functions(scene):
    return elf.symbols(LIBRARIES / f"{scene}.so")


def matching(names, pattern):
    return sorted(name for name in names if re.search(pattern, name))


def code_of_lines(scene, pattern, folder="."):
    """Lines of fmu_src with the pattern that left an instruction in the scene's library."""
    texts = {}  # the debug information has no folders, and files of two folders may have one name
    for file in units_of(scene, "fmi2"):
        if file.is_relative_to(ROOT / "fmu_src" / folder):
            texts.setdefault(file.name, []).append(file.read_text().splitlines())
    return [
        f"{name}:{line}: {lines[line - 1].strip()}"
        for name, line in sorted(elf.lines_with_code(LIBRARIES / f"{scene}.so"))
        for lines in texts.get(name, [])
        if line <= len(lines) and re.search(pattern, lines[line - 1])
        if not lines[line - 1].lstrip().startswith(("/*", "*"))  # of two files with one name
    ]


@pinned_scenes
def test_a_pinned_scene_has_no_other_variable_no_larger_library_and_a_smaller_state(
    variables, library_bytes, state_bytes, scene
):
    whole = UNIVERSAL[scene]
    assert variables(scene) <= variables(whole) and library_bytes(scene) <= library_bytes(whole)
    assert state_bytes(scene) < state_bytes(whole)


@pinned_scenes
def test_the_library_names_no_variable_that_the_interface_lacks(variables, strings, scene):
    """The strings of the library hold the names of its variables, and none of those pinned away."""
    inside = set(strings(scene).split("\n"))
    assert inside & variables(scene)
    gone = variables(UNIVERSAL[scene]) - variables(scene)
    assert gone
    assert inside & gone == set()


def test_the_force_element_has_a_library_of_at_most_113_kb(library_bytes):
    """60 kB for the force at an instant, 4 kB for the functions of Model Exchange and their messages, 20 kB
    for mean and peaks over a step: the polynomials that tell when contact begins and ends within it, their
    roots, the quadrature between; 4 kB for factors that may be set between steps and the search for peaks;
    4 kB for changes of the law that are located where a dashpot is clipped, and for warnings of parameters
    that were set and are not in force; 4 kB for values and messages that go one way in FMI 2 and FMI 3; 16 kB
    for conservative advancement, which replaces polynomials that missed peaks and knows every shape."""
    assert library_bytes("ForceElement") <= 113_000


THROWN = ["BallOnSphere", "BallInShell", "BallOffRoller", "PinnedEvent"]
CVODE = r"^CV|SUN|N_V[A-Z]"
MOTION = r"^solver\.|^energy\.|^gravity|\.initial_|\.mass$|external_force"
HERTZ = r"hertz|hunt_crossley|youngs_modulus|poissons_ratio|contact\.law|restitution$"
FACTORS = r"penalty_factor|penalty_multiplier|reference_modulus|characteristic_time|diagonal"
ON_PLANES = ["SpherePlane", "BouncingBall", "Bowling", "SpinningBall", "Turntable"]
AXIS = r"axis|finite_length|\.length|within_extents|beyond_ends"
# Scenes that lack something, the scene that has it (None: the universal one of each), where, and what it is.
GONE = [
    (["ForceElement"], None, "functions", CVODE + "|solver|integrator"),
    (["ForceElement"], None, "code of integrator", ""),
    (["ForceElement"], None, "strings", "CVODE|SUNDIALS|solver"),
    (["ForceElement"], None, "variables", MOTION),
    (["PinnedEvent"], "BallOffRoller", "functions", CVODE),
    (["PinnedEvent"], "BallOffRoller", "strings", "CVODE"),
    (LINEAR, "SphereCylinder", "variables", HERTZ),
    (LINEAR, "SphereCylinder", "strings", "(?i)hertz"),
    (["HertzImpact"], None, "variables", FACTORS),
    (SPHERES, "SphereCylinder", "variables", AXIS),
    (SPHERES, "SphereCylinder", "strings", AXIS),
    (ON_PLANES, "SphereSphere", "strings", "no defined normal"),
    (ON_PLANES, "SphereSphere", "code of .", r"singularity_|\bleave_centre"),
    (THROWN, None, "code of .", r"r->mismatch\["),
    ([*UNIVERSAL], None, "variables", "rolling|spinning"),
    ([*UNIVERSAL], None, "strings", "rolling|spinning"),
    ([*UNIVERSAL], None, "code of .", "resist"),
    ([*UNIVERSAL], None, "variables", "tangential_(law|ratio)"),
    ([*UNIVERSAL], None, "strings", "tangential_law|mindlin"),
    ([*UNIVERSAL], None, "code of .", "mindlin_stiffness|ONSET_POWER"),
    (THROWN, None, "variables", "prescribed"),
    (THROWN, None, "strings", "prescribed"),
    (THROWN, None, "code of .", "(?<!contact_is_)prescribed"),  # whether a contact is so is a constant
]


@pytest.mark.parametrize("scene, other, where, what", [(one, *row) for ones, *row in GONE for one in ones])
def test_what_a_scene_pins_away_is_gone(variables, strings, scene, other, where, what):
    def found(name):
        if where == "strings":
            return re.findall(what, strings(name), re.MULTILINE)
        if where.startswith("code"):
            return code_of_lines(name, what, where.removeprefix("code of "))
        return matching(variables(name) if where == "variables" else functions(name), what)

    assert found(other or UNIVERSAL[scene])
    assert found(scene) == []


def test_the_pinned_method_halves_the_library_and_counts_nothing_of_cvode(variables, library_bytes):
    counted_by_cvode = {"solver.method", "solver.rejected_steps", "solver.fallbacks"}
    assert variables("BallOffRoller") - variables("PinnedEvent") == counted_by_cvode
    assert library_bytes("PinnedEvent") <= 0.5 * library_bytes("BallOffRoller")


@pytest.mark.parametrize("scene", SPHERES)
def test_scenes_of_spheres_have_no_code_for_cylinders(variables, scene):
    geometry = r"\baxis\b|\bhalf_length\b"
    assert len(code_of_lines("SphereCylinder", geometry)) > 10
    found = code_of_lines(scene, geometry)
    if "source.rotation" in variables(scene):  # any body that turns has a frame, and that a third axis
        turns = "evaluate|inputs|model_exchange|ode|outputs|prescribed|rotor|scene_jet|sensitivity"
        turns += "|conservative_advancement"
        found = [line for line in found if not re.match(turns, line)]
    assert found == []
    assert matching(functions(scene), "cylinder") == []


def test_a_scene_without_rotation_has_no_variable_of_it(variables):
    gone = ("rotation", "angular", "inertia", "torque", "friction", "slip", "orientation", "tangential")
    assert [name for name in variables("BouncingBall") if any(word in name for word in gone)] == []
    assert [name for name in variables("SpherePlane") if "torque" in name]
