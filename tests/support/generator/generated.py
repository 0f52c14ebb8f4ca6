"""The generated files of every scene, and readers of each that share no code with the generator."""

import json
import re
import subprocess
import sys
import tempfile
import tomllib
from functools import cache
from pathlib import Path

from lxml import etree, html

ROOT = Path(__file__).resolve().parents[3]
FOLDER = ROOT / "modelDescription"
SCENES = sorted(path.stem for path in (FOLDER / "scenes").glob("*.toml"))
CATALOGUE = tomllib.loads((FOLDER / "variables.toml").read_text(encoding="utf-8"))
LARGEST = sys.float_info.max


def run(*arguments) -> subprocess.CompletedProcess:
    """generate.py as users call it."""
    command = [sys.executable, "-B", str(FOLDER / "generate.py"), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60)


def generate(scene: str | Path, output: Path) -> dict[str, str]:
    """Text of each file that generate.py writes for a scene, by its path in the output folder."""
    path = scene if isinstance(scene, Path) else FOLDER / "scenes" / f"{scene}.toml"
    done = run("--scene", path, "--output", output)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    files = (path for path in output.rglob("*") if path.is_file())
    return {path.relative_to(output).as_posix(): path.read_text(encoding="utf-8") for path in files}


@cache
def table() -> dict:
    return json.loads(run("--table").stdout)


@cache
def describe(scene: str) -> dict:
    """parse_xml of a scene of the repository."""
    with tempfile.TemporaryDirectory() as folder:
        return parse_xml(generate(scene, Path(folder))["modelDescription.xml"])


def parse_xml(text: str) -> dict[str, dict]:
    """Name -> what modelDescription.xml says of the variable, with what its declared type adds."""
    root = etree.fromstring(text.encode())
    types = {entry.get("name"): entry[0] for entry in root.find("TypeDefinitions")}
    variables = {}
    for scalar in root.find("ModelVariables").iterchildren("ScalarVariable"):
        value = scalar[0]
        declared = types[value.get("declaredType")]
        attribute = {**declared.attrib, **value.attrib}
        low, high = attribute.get("min"), attribute.get("max")
        if value.tag == "Boolean":
            low, high = "0", "1"
        assert scalar.get("name") not in variables
        variables[scalar.get("name")] = {
            "reference": int(scalar.get("valueReference")),
            "base": value.tag,
            "type": value.get("declaredType"),
            "causality": scalar.get("causality"),
            "variability": scalar.get("variability"),
            "initial": scalar.get("initial"),
            "unit": attribute.get("unit"),
            "quantity": attribute.get("quantity"),
            "nominal": attribute.get("nominal"),
            "min": float(low) if low else -LARGEST,
            "max": float(high) if high else LARGEST,
            "start": value.get("start"),
            "items": {item.get("name"): int(item.get("value")) for item in declared.iterchildren("Item")},
            "description": scalar.get("description"),
        }
    return variables


ROW = re.compile(
    r'^\s*\{"(?P<name>[^"]+)", (?P<min>[^,]+), (?P<max>[^,]+), (?P<reference>\d+), '
    r"offsetof\(struct scene_values, (?P<member>[^)]+)\), ROW_(?P<row>\w+), "
    r"VARIABLE_(?P<base>\w+), VARIABLE_(?P<causality>\w+), (?P<element>\d+), (?P<component>\d+)\},$",
    re.MULTILINE,
)


def parse_c(text: str) -> dict[str, dict]:
    """Name -> the fields of the C table, in the words of FMI."""
    causality = {"CALCULATED_PARAMETER": "calculatedParameter"}
    variables = {}
    for match in ROW.finditer(text):
        fields = match.groupdict()
        assert fields["name"] not in variables
        variables[fields["name"]] = {
            "reference": int(fields["reference"]),
            "base": fields["base"].capitalize(),
            "causality": causality.get(fields["causality"], fields["causality"].lower()),
            "min": float(fields["min"]),
            "max": float(fields["max"]),
            **{key: fields[key] for key in ("member", "row")},
            **{key: int(fields[key]) for key in ("element", "component")},
        }
    return variables


def parse_page(text: str) -> dict[str, dict]:
    """Name of each scalar -> the cells of its row in the tables of the documentation page."""
    variables = {}
    for row in html.fromstring(text).xpath("//table[@class='variables']/tr[td]"):
        cells = [" ".join(cell.text_content().split()) for cell in row.findall("td")]
        name, reference, causality, type_name, unit, start, low, high, symbol, meaning = cells
        count = 3 if name.endswith("[1..3]") else 1
        first, *last = map(int, reference.split(".."))
        assert last == ([first + 2] if count == 3 else [])
        starts = start.strip("()").split(", ") if start else [None] * count
        for k in range(count):
            scalar = name.replace("[1..3]", f"[{k + 1}]")
            assert scalar not in variables
            variables[scalar] = {
                "reference": first + k,
                "causality": causality,
                "type": type_name,
                "unit": unit or None,
                "start": starts[k],
                "min": low,
                "max": high,
                "symbol": symbol,
                "meaning": meaning,
            }
    return variables


def row_of(name: str, scene: dict) -> tuple[str, dict]:
    """Key and row of variables.toml of a scalar variable, from its name and the scene file alone."""
    plain = name.partition("[")[0]
    owner, _, field = plain.partition(".")
    if any(body["name"] == owner for body in scene["body"]):
        plain = f"body.{field}"
    elif any(contact["name"] == owner for contact in scene["contact"]):
        plain = f"contact.{field}"
    return plain, CATALOGUE["variable"][plain]


def scene_file(scene: str) -> dict:
    return tomllib.loads((FOLDER / "scenes" / f"{scene}.toml").read_text(encoding="utf-8"))
