"""Writing the files of a scene. The same input gives the same bytes: no time, path or random number in it."""

import json
import uuid
from dataclasses import asdict, astuple, replace
from pathlib import Path

import jinja2

from . import arrays, c_code, page, terminals
from . import guide as scene_guide
from .catalogue import BEHIND_BLOCKS, Catalogue
from .resolve import Resolved

# Namespace of the guids; a guid is the version-5 UUID of what the FMU is: equal FMUs have equal guids.
NAMESPACE = uuid.UUID("6d3c1d1e-0f2a-5b7e-9a51-6c1f4a0c7d42")
TEMPLATES = Path(__file__).resolve().parent.parent / "templates"


def environment() -> jinja2.Environment:
    result = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        undefined=jinja2.StrictUndefined,
        autoescape=jinja2.select_autoescape(["xml", "html"]),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    result.filters["number"] = number
    result.filters["limit"] = page.limit
    result.filters["symbol"] = page.symbol
    result.filters["own_range"] = page.own_range
    result.filters["body_shape"] = lambda body, scene: scene.bodies[body].shape
    return result


def number(value) -> str:
    """As XML Schema and C write it; repr gives the shortest text that reads back as the same double."""
    return ("true" if value else "false") if isinstance(value, bool) else repr(value)


def render(resolved: Resolved) -> dict[str, str]:
    """Text of every generated file by its name in the output folder."""
    templates = environment()
    context = _context(resolved)
    xml = templates.get_template("modelDescription.xml")
    identity = _identity(resolved, xml.render(context, guid=""))
    context["guid"] = f"{{{identity}}}"
    third = templates.get_template("modelDescription3.xml").render(context, token="")
    context["token"] = f"{{{_identity(resolved, third)}}}"
    context["hash"] = f"0x{identity.int >> 96:08x}u"
    descriptions = ("modelDescription.xml", "modelDescription3.xml")
    names = (
        *descriptions,
        "scene.h",
        "scene_variables.c",
        "scene.cmake",
        "documentation/index.html",
    )
    files = {name: templates.get_template(name).render(context) for name in names}
    files["resources/scene.json"] = _scene_for_viewers(resolved)
    connectors = templates.get_template("terminalsAndIcons.xml")
    for folder, whole in (("terminals2", False), ("terminals3", True)):
        found = terminals.terminals(resolved, whole)
        files[f"{folder}/terminalsAndIcons.xml"] = connectors.render(terminals=found)
    # Symbols as character references: some readers of descriptions take one byte for one character.
    for name in descriptions:
        files[name] = files[name].encode("ascii", "xmlcharrefreplace").decode()
    return files


def _scene_for_viewers(resolved: Resolved) -> str:
    """What a viewer of results needs and modelDescription.xml does not tell: shapes, which bodies a contact
    joins, and what the scene pins. Values are as a user writes them: items by name, vectors as lists."""
    scene = resolved.scene
    content = {
        "format": 1,  # goes up where a reader of this file would misunderstand a newer one
        "name": scene.name,
        "title": scene.title,
        "bodies": [
            {"name": body.name, "shape": body.shape}
            | ({"parts": list(map(asdict, body.parts))} if body.parts else {})
            for body in scene.bodies
        ],
        "contacts": [
            {
                "name": contact.name,
                "source": scene.bodies[contact.source].name,
                "destination": scene.bodies[contact.destination].name,
                **_parts_met(contact),
            }
            for contact in scene.contacts
        ],
        "pinned": {
            name: value
            for name, value in scene.pinned.items()
            if name in {c.name for c in resolved.cells if c.pinned}
        },
    }
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _parts_met(contact) -> dict[str, str]:
    """The names of the parts of compounds that meet"""
    ends = {"source_part": contact.source_part, "destination_part": contact.destination_part}
    return {end: part.name for end, part in ends.items() if part}


def guide(catalogue: Catalogue) -> str:
    """docs/scenes.md"""
    template = environment().get_template("scenes.md")
    return template.render(scene_guide.context(catalogue)).rstrip() + "\n"


def write(files: dict[str, str | bytes], folder: Path) -> None:
    """Writes what differs, so that a build sees only real changes."""
    for name, content in files.items():
        path, data = folder / name, content if isinstance(content, bytes) else content.encode()
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists() or path.read_bytes() != data:
            path.write_bytes(data)


def counts(resolved: Resolved) -> dict[str, int]:
    result = {"variables": len(resolved.variables)}
    for causality in ("parameter", "calculatedParameter", "input", "output", "local"):
        result[causality] = sum(v.cell.row.causality == causality for v in resolved.variables)
    result["value_bytes"] = _value_bytes(resolved)
    return result


def _value_bytes(resolved: Resolved) -> int:
    count = {"body": len(resolved.scene.bodies), "contact": len(resolved.scene.contacts), "world": 1}
    return sum(count[struct.owner] * struct.bytes for struct in c_code.structs(resolved))


def _identity(resolved: Resolved, xml: str) -> uuid.UUID:
    """From the description and what it does not show: bodies, contacts and the values compiled in."""
    scene = resolved.scene
    hidden = {
        "bodies": [(body.name, body.shape, *map(astuple, body.parts)) for body in scene.bodies],
        "contacts": [
            (contact.name, contact.source, contact.destination, *_parts_met(contact).items())
            for contact in scene.contacts
        ],
        "constants": {
            cell.name: cell.value for cell in resolved.cells if cell.row.has_start and not cell.open
        },
    }
    return uuid.uuid5(NAMESPACE, xml + json.dumps(hidden, sort_keys=True))


def _context(resolved: Resolved) -> dict:
    rows = resolved.catalogue.rows.values()
    variables = resolved.variables
    types = _types(resolved)
    units, used = resolved.catalogue.units, {t.unit for t in types}
    near = max(v.reference for v in variables if v.reference < BEHIND_BLOCKS) + 1
    return {
        "scene": resolved.scene,
        "project": resolved.catalogue.project,
        "resolved": resolved,
        "variables": variables,
        "types": types,
        "units": {name: unit for name, unit in units.items() if name in used},
        "units_with_time": {name: unit for name, unit in units.items() if name in used | {"s"}},
        "outputs": [
            (i, resolved.dependencies(variable))
            for i, variable in enumerate(variables, 1)
            if variable.cell.row.causality == "output"
        ],
        "arrays": (whole := arrays.arrays(resolved)),
        "array_rates": arrays.in_role(whole, "rate"),
        "array_indicators": arrays.in_role(whole, "indicator"),
        "unknowns": _unknowns(variables),
        "has_inputs": any(v.cell.row.causality == "input" for v in variables),
        "has_derivatives": any(
            v.cell.row.causality == "output" and v.cell.row.type.base == "Real" for v in variables
        ),
        **_facts(resolved),
        "rows": list(rows),
        "present": c_code.rows_present(resolved),
        "structs": c_code.structs(resolved),
        "value_bytes": _value_bytes(resolved),
        "readers": c_code.readers(resolved),
        "writers": c_code.writers(resolved),
        "start_statements": c_code.start_statements(resolved),
        "table": c_code.table(resolved),
        "reals": c_code.reals(resolved),
        "tolerance": next((i for i, v in enumerate(variables) if v.cell.row.tolerance), None),
        "idles": c_code.idles(resolved),
        "refusals": c_code.refusals(resolved),
        "positions": c_code.positions(resolved),
        "nominals": c_code.nominals(resolved),
        "state_of": _state_of(resolved),
        "near_references": near,
        "far_references": BEHIND_BLOCKS if any(v.reference >= BEHIND_BLOCKS for v in variables) else 0,
        "references": [
            (v.reference if v.reference < BEHIND_BLOCKS else v.reference - BEHIND_BLOCKS + near, i)
            for i, v in enumerate(variables, 1)
        ],
        "page": page.context(resolved),
        "contacts_of_bodies": _contacts_of_bodies(resolved),
    }


def _contacts_of_bodies(resolved: Resolved) -> dict[str, list[int]]:
    """The contacts of all bodies in one list, each ended by -1, and where those of each body begin."""
    first, contacts = [], []
    for body in range(len(resolved.scene.bodies)):
        first.append(len(contacts))
        contacts += [
            j for j, one in enumerate(resolved.scene.contacts) if body in (one.source, one.destination)
        ]
        contacts.append(-1)
    return {"first": first, "contacts": contacts}


def _facts(resolved: Resolved) -> dict:
    """What a scene may have: the macros SCENE_ANY_... and SCENE_HAS_... of scene.h"""
    resistances = resolved.of("contact.rolling") + resolved.of("contact.spinning")
    compound = any(body.parts for body in resolved.scene.bodies)
    return {
        "any_compound": compound,
        "any_free": resolved.may("body.motion", "free") or resolved.may("body.rotation", "free"),
        "any_prescribed": resolved.may("body.motion", "prescribed"),
        "any_prescribed_contact": any(
            all(
                any(resolved.may("body.motion", how, body) for how in ("fixed", "prescribed"))
                for body in (contact.source, contact.destination)
            )
            for contact in resolved.scene.contacts
        ),
        "any_cylinder": any(body.shape == "cylinder" for body in resolved.scene.bodies),
        "any_linear": resolved.may("contact.law", "linear"),
        "any_hertz": resolved.may("contact.law", "hertz"),
        "any_restitution": resolved.may("contact.viscous_control", "restitution"),
        "any_rotation": (
            rotation := compound or any(resolved.may("body.rotation", how) for how in ("prescribed", "free"))
        ),
        "any_free_rotation": resolved.may("body.rotation", "free"),
        "any_friction": (
            friction := any(resolved.may("contact.friction", law) for law in ("regularized", "elastic"))
        ),
        "any_elastic_friction": resolved.may("contact.friction", "elastic"),
        "any_mindlin": any(cell.may_be("mindlin") for cell in resolved.of("contact.tangential_law")),
        "any_rolling": any(cell.may_be("regularized") or cell.may_be("elastic") for cell in resistances),
        "any_elastic_rolling": any(cell.may_be("elastic") for cell in resistances),
        "any_turning": rotation or friction,
        "any_caps": resolved.may("body.ends", "capped"),
        "any_plane": any(body.shape == "plane" for body in resolved.scene.bodies),
        "any_skew": (skew := resolved.may("contact.axes", "skew")),
        "any_torus": any(body.shape == "torus" for body in resolved.scene.bodies),
        "any_endless": skew
        or resolved.may("body.finite_length", "false")
        or resolved.may("body.ends", "capped")
        or any(
            resolved.scene.bodies[contact.destination].shape != "cylinder"
            for contact in resolved.scene.contacts
        ),
        "any_curved": any(
            resolved.scene.bodies[contact.destination].shape != "plane" for contact in resolved.scene.contacts
        ),
        "has_cvode": resolved.may_need_cvode,
        "has_general": resolved.may_need_general,
    }


def _types(resolved: Resolved) -> list:
    """The declared types in use, in the order of the catalogue; of an enumeration the items that any choice
    has."""
    used: dict[str, list] = {}
    for variable in resolved.variables:
        used.setdefault(variable.cell.row.type.name, []).append(variable.cell.row.type.items)
    return [
        replace(
            kind, items=tuple(item for item in kind.items if any(item in items for items in used[kind.name]))
        )
        for kind in resolved.catalogue.types.values()
        if kind.name in used
    ]


def _unknowns(variables) -> list[int]:
    """1-based indices into ModelVariables of what initialization computes, as ModelStructure wants them."""
    return [
        i
        for i, variable in enumerate(variables, 1)
        if variable.cell.row.causality in ("output", "calculatedParameter")
        or variable.cell.row.role in ("state", "rate")
    ]


def _state_of(resolved: Resolved) -> dict[str, int]:
    """1-based index into ModelVariables of the state of each rate, by the name of the rate."""
    where = c_code.positions(resolved)["states"]
    return {rate.name: 1 + at for rate, at in zip(resolved.rates(), where, strict=True)}
