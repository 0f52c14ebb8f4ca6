"""Directional derivatives of every FMU: differences through the FMU itself, and what ModelStructure says.

At some communication point of a run each input is moved a little and every Real output is read again; a
saved state undoes the move. Fourth-order differences with steps of 1e-4 of a metre or of a metre per
second are right to about 1e-9 where nothing changes its regime on the way."""

import xml.etree.ElementTree as ElementTree
from contextlib import contextmanager
from ctypes import c_double, c_uint

import numpy as np
import pytest

from support.fmi2 import raw
from support.fmi2.jacobian import checked_jacobian, jacobian
from support.fmi2.raw import DISCARD, ERROR, OK, array
from support.fmi2.runs import RUNS, begin, go_on, time_after

UNKNOWN = 4_000_000_000


def declared(fmu: raw.Fmu, causality: str = "input") -> dict[str, dict[str, str]]:
    """Output -> input (or state: local) -> dependenciesKind, as ModelStructure has them"""
    root = ElementTree.parse(fmu.folder / "modelDescription.xml").getroot()
    names = list(fmu.variables)
    found = {}
    for entry in root.findall("ModelStructure/Outputs/Unknown"):
        indices = entry.get("dependencies").split()
        pairs = zip(indices, entry.get("dependenciesKind", "").split(), strict=True)
        found[names[int(entry.get("index")) - 1]] = {
            names[int(i) - 1]: kind
            for i, kind in pairs
            if fmu.variables[names[int(i) - 1]].causality == causality
        }
    return found


@contextmanager
def saved_point(name):
    """An instance at the saved point of a run, its Real outputs and its Real inputs"""
    run = RUNS[name]
    with begin(run) as instance:
        go_on(instance, run, 0, run.saved_at)
        instance.set(run.inputs(time_after(run.saved_at)))
        yield instance, *(instance.fmu.select(causality, kind="Real") for causality in ("output", "input"))


@pytest.mark.parametrize("name", RUNS)
def test_derivatives_are_those_of_difference_quotients(name):
    with saved_point(name) as (instance, unknowns, knowns):
        given = checked_jacobian(instance, unknowns, knowns)
        structure = declared(instance.fmu)
        undeclared = [
            (unknowns[i].name, knowns[j].name)
            for i, j in np.argwhere(given != 0.0)
            if knowns[j].name not in structure[unknowns[i].name]
        ]
        assert undeclared == []


def test_some_run_makes_every_kind_of_dependency_felt():
    """Difference quotients pass an input that moves nothing. Here each dependency of a pair shows."""
    felt = set()
    for name in ("both prescribed, turning and rubbing", "on a shaken sphere", "force element"):
        with saved_point(name) as (instance, unknowns, knowns):
            for i, j in np.argwhere(jacobian(instance, unknowns, knowns) != 0.0):
                felt.add((unknowns[i].name.partition("[")[0], knowns[j].name.partition("[")[0]))
    structure = declared(raw.load("SphereSphere"))
    kinds = {variable.name: variable.type for variable in raw.load("SphereSphere").variables.values()}
    claimed = {
        (output.partition("[")[0], known.partition("[")[0])
        for output, entries in structure.items()
        for known in entries
        if kinds[output] == "Real" and not output.startswith("contact.last_")
    }
    # The energies of springs and friction depend on speeds where bodies slide, the gap's rate on the turning
    # of a cylinder. Scenes declare both where they may happen; both are zero for spheres that stick.
    elsewhere = {
        *((one, f"{body}.prescribed_{speed}") for one in ("energy.tangential", "energy.friction")
          for body in ("source", "destination") for speed in ("velocity", "angular_velocity")),
        ("contact.gap_rate", "source.prescribed_angular_velocity"),
        ("contact.normal_force", "source.prescribed_angular_velocity"),
    }  # fmt: skip
    assert felt == claimed - elsewhere


@pytest.mark.parametrize("scene", raw.ALL)
def test_fixed_dependencies_are_ones_or_zeros(scene):
    """dependenciesKind fixed: bodies go where they are put, whatever the place"""
    fmu = raw.load(scene)
    entries = [(o, k) for o, known in declared(fmu).items() for k, kind in known.items() if kind == "fixed"]
    moved = {"source.prescribed_displacement[1]", "source.position[1]"} <= set(fmu.variables)
    turned = any(".prescribed_angular_velocity" in name for name in fmu.variables)
    assert bool(entries) == moved or turned
    with raw.Instance(fmu) as instance:
        instance.initialize()
        for output, known in entries:
            body, _, field = known.partition(".")
            choice = f"{body}.{'rotation' if 'angular' in field else 'motion'}"
            prescribed = choice not in fmu.variables or instance.get(choice) == 2
            found = jacobian(instance, [fmu.variables[output]], [fmu.variables[known]])
            assert found == [[float(prescribed)]]


def edge(values, unknown="contact.normal_force", known="source.prescribed_displacement[1]"):
    """A derivative of a ForceElement with a sphere beside a cylinder along z"""
    with raw.Instance(raw.load("ForceElement")) as instance:
        instance.initialize({"contact.viscous_penalty_factor": 100.0, **values})
        variables = instance.fmu.variables
        return jacobian(instance, [variables[unknown]], [variables[known]])[0, 0]


def test_on_an_edge_the_derivative_is_that_of_the_regime_in_force():
    """g = 0 counts as apart, a clipped force as clipped, and g' = 0 as restitution."""
    beside = {"source.radius": 0.25, "destination.radius": 0.5}
    touching = {**beside, "source.center": [0.75, 0.0, 0.0]}
    inwards = {**touching, "source.prescribed_velocity": [-1.0, 0.0, 0.0]}
    assert edge(inwards) == 0.0
    assert edge({**inwards, "source.center": [0.75 - 2**-20, 0.0, 0.0]}) == -1e6
    # The law is zero where p_n g = -p_nv g': 2^20 N/m times 2^-10 m and 2^10 N s/m times 1 m/s.
    clipped = {**beside, "source.center": [0.75 - 2**-10, 0.0, 0.0], "contact.penalty_factor": 2.0**20}
    clipped |= {"contact.viscous_penalty_factor": 2.0**10}
    speed = "source.prescribed_velocity[1]"
    for rate, expected in [(1.0, 0.0), (1.0 - 2**-40, -(2.0**20)), (1.5, 0.0)]:
        assert edge({**clipped, "source.prescribed_velocity": [rate, 0.0, 0.0]}) == expected
    restitution = {**clipped, "contact.dashpot": "approach_only"}
    for rate, expected in [(0.0, 0.0), (-(2.0**-40), -(2.0**10))]:
        assert edge({**restitution, "source.prescribed_velocity": [rate, 0.0, 0.0]}, known=speed) == expected
        assert edge({**restitution, "source.prescribed_velocity": [rate, 0.0, 0.0]}) == -(2.0**20)


def test_where_there_is_no_direction_the_one_in_use_is_held():
    """On the axis the normal is the documented one, x here; a step along it counts, one across does not."""
    on_axis = {"source.center": [0.0, 0.0, 0.0], "contact.location": "outside"}
    moved = [f"source.prescribed_displacement[{k}]" for k in (1, 2, 3)]
    slopes = [[edge(on_axis, f"contact.source_force[{row}]", one) for one in moved] for row in (1, 2)]
    assert sorted(np.abs(slopes).max(axis=1)) == [0.0, 1e6]
    assert edge(on_axis, "contact.direction[2]") == 0.0


def test_directions_add_up(fmu, instance):
    """J (a + b) = J a + J b; an input named twice counts twice."""
    instance.initialize()
    known, unknowns = fmu.select("input", kind="Real"), fmu.select("output", kind="Real")
    matrix = jacobian(instance, unknowns, known)
    direction = np.linspace(-1.0, 2.0, len(known))
    rows, columns = ([one.reference for one in several] for several in (unknowns, known))
    for repeat in (1, 2):
        status, values = instance.directional(rows, columns * repeat, list(direction) * repeat)
        assert status == OK, instance.texts()
        assert values == pytest.approx(list(repeat * matrix @ direction), rel=1e-12, abs=1e-12)


def ask(instance: raw.Instance, unknown: int, known: int, change: float = 1.0) -> int:
    return instance.directional([unknown], [known], [change])[0]


def test_wrong_references_are_refused(fmu, instance):
    gap = fmu.variables["contact.gap"].reference
    known = fmu.select("input", kind="Real")[0]
    instance.initialize()
    for wrong in ("source.radius", "contact.active", known.name):
        refused = instance.expect(ERROR, "fmi2GetDirectionalDerivative", wrong, "no Real output")
        refused(ask(instance, fmu.variables[wrong].reference, known.reference))
    for wrong in ("source.radius", "contact.active", "contact.gap_rate"):
        refused = instance.expect(ERROR, "fmi2GetDirectionalDerivative", wrong, "no Real input")
        refused(ask(instance, gap, fmu.variables[wrong].reference))
    for references in [(UNKNOWN, known.reference), (gap, UNKNOWN)]:
        instance.expect(ERROR, "unknown value reference", str(UNKNOWN))(ask(instance, *references))
    for change in (float("nan"), float("inf")):
        instance.expect(DISCARD, known.name, "finite")(ask(instance, gap, known.reference, change))
    value = array(c_double, [7.0])
    instance.ok("GetDirectionalDerivative", array(c_uint, [gap]), 1, None, 0, None, value)
    assert value[0] == 0.0  # along no input nothing changes


def test_a_derivative_beyond_the_range_of_numbers_is_refused():
    fmu = raw.load("ForceElement")
    with raw.Instance(fmu) as instance:
        instance.initialize({"source.center": [0.55, 0.0, 0.0], "contact.penalty_factor": 1e150})
        names = ("contact.normal_force", "source.prescribed_displacement[1]")
        references = [fmu.variables[name].reference for name in names]
        assert ask(instance, *references) == OK
        refused = instance.expect(DISCARD, "contact.normal_force", "range of numbers")
        refused(ask(instance, *references, 1e200))


def test_in_initialization_mode_inputs_are_known_and_parameters_are_not(fmu, instance):
    gap = fmu.variables["contact.gap"].reference
    instance.ok("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
    assert ask(instance, gap, fmu.select("input")[0].reference) == ERROR
    instance.ok("EnterInitializationMode")
    for output in fmu.select("output", "calculatedParameter", kind="Real"):
        assert ask(instance, output.reference, fmu.select("input")[0].reference) == OK
    refused = instance.expect(DISCARD, "parameter source.radius", "not provided")
    refused(ask(instance, gap, fmu.variables["source.radius"].reference))
    instance.ok("ExitInitializationMode")
    for constant in fmu.select("calculatedParameter"):
        assert ask(instance, constant.reference, fmu.select("input")[0].reference) == ERROR


# The next tests compare the directional derivatives of all Real unknowns of initialization mode, energies and
# peaks too, with differences through the FMU. Inputs move the start: no work is done, and factors follow.

# Bodies that overlap (the gap is -0.04 m) and move; the free one has kinetic and potential energy.
TOUCHING = {"source.center": [0.3, 0.1, 0.45], "destination.prescribed_displacement": [0.01, -0.02, 0.0]}
TOUCHING |= {"destination.prescribed_velocity": [0.2, 0.0, 1.5]}
TOUCHING |= {"source.prescribed_velocity": [0.0, 0.1, -0.4], "source.initial_velocity": [0.3, 0.2, -1.0]}
TOUCHING |= {"contact.penalty_factor": 2e3, "contact.viscous_penalty_factor": 5.0}
LYING = {"destination.axis": [0.3, 1.0, 0.2]}
# p_n g + p_nv g' > 0
RECEDING = {"source.initial_velocity": [6.0, 2.0, 9.0], "contact.viscous_penalty_factor": 50.0}
AUTOMATIC = {"contact.viscous_control": "automatic", "contact.reference_modulus": 2e3}
# The destination is prescribed where a start says nothing else.
STARTS = {
    "a moved destination": {},
    "a moved source": {"source.motion": "prescribed", "destination.motion": "free"},
    "both moved": {"source.motion": "prescribed"},
    "apart": {"source.center": [0.0, 0.3, 0.9]},
    "inside, apart": {"source.center": [0.1, 0.2, 0.1]},
    "automatic factors": AUTOMATIC | {"contact.penalty_control": "automatic"},
    "automatic stiffness": {"contact.penalty_control": "automatic", "contact.reference_modulus": 2e3},
    "automatic damping": AUTOMATIC,
    "viscous only": AUTOMATIC | {"contact.penalty_control": "viscous_only", "contact.reference_modulus": 1e6},
    "no dashpot": {"contact.method": "penalty"},
    "pulling": RECEDING | {"contact.dashpot": "unclamped"},
    "clipped": RECEDING | {"contact.dashpot": "non_adhesive"},
    "restitution": RECEDING | {"contact.dashpot": "approach_only"},
}


@pytest.mark.parametrize("scene", ["SphereSphere", "SphereCylinder"])
@pytest.mark.parametrize("name", STARTS)
def test_derivatives_of_the_start_are_those_of_difference_quotients(scene, name):
    fmu = raw.load(scene)
    with raw.Instance(fmu) as instance:
        lying = LYING if scene == "SphereCylinder" else {}
        instance.enter_initialization(TOUCHING | lying | {"destination.motion": "prescribed"} | STARTS[name])
        unknowns = fmu.select("output", "calculatedParameter", kind="Real")
        given = checked_jacobian(instance, unknowns, fmu.select("input", kind="Real"))
        names = [variable.name for variable in unknowns]
        felt = {names[i] for i in np.argwhere(given != 0.0)[:, 0]}
        touching = bool(instance.get("contact.active"))
        assert touching == ("apart" not in name)
        assert "contact.gap" in felt
        assert ("contact.peak_penetration" in felt) == touching
        of_the_diagonal = name in ("automatic factors", "automatic stiffness")
        assert ("contact.effective_penalty_factor" in felt) == of_the_diagonal
