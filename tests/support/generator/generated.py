"""The generated files of every scene, and readers of each that share no code with the generator."""

import contextlib
import io
import json
import re
import subprocess
import sys
import tempfile
import tomllib
from functools import cache
from pathlib import Path

from lxml import etree, html

import generate as program

ROOT = Path(__file__).resolve().parents[3]
FOLDER = ROOT / "modelDescription"
SCENES = sorted(path.stem for path in (FOLDER / "scenes").glob("*.toml"))
PAIRS = [  # with one contact
    scene
    for scene in SCENES
    if (FOLDER / "scenes" / f"{scene}.toml").read_text().count("[[body]]") == 2
    and (FOLDER / "scenes" / f"{scene}.toml").read_text().count("[[contact]]") == 1
]
CATALOGUE = tomllib.loads((FOLDER / "variables.toml").read_text(encoding="utf-8"))
LARGEST = sys.float_info.max
# What sums up a step, and what is settled at each onset
SUMS_UP = {
    "mean_force", "mean_source_torque", "mean_destination_torque", "peak_force", "peak_penetration",
    "last_onset_time", "last_duration",
    "effective_hunt_crossley_factor",
}  # fmt: skip


@cache
def whole(name: str) -> str:
    """Returns the name of a variable without the number of its component."""
    return re.sub(r"\[\d\]$", "", name)


def run(*arguments) -> subprocess.CompletedProcess:
    """Returns what generate.py says to these arguments and the status that it ends with, in this process."""
    out, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
        try:
            status = program.main(list(map(str, arguments)))
        except SystemExit as ended:  # of argparse
            status = ended.code
    return subprocess.CompletedProcess(arguments, status, out.getvalue(), errors.getvalue())


def refused(done: subprocess.CompletedProcess, *words: str) -> None:
    """Checks for one line on stderr with these words in this order, nothing on stdout, status 2."""
    assert (done.returncode, done.stdout) == (2, "")
    line, end = done.stderr[:-1], done.stderr[-1]
    assert end == "\n" and "\n" not in line and "Traceback" not in line
    position = 0
    for word in words:
        assert word in line[position:], f"'{word}' is missing in: {line}"
        position = line.index(word, position) + len(word)


def generate(scene: Path, output: Path) -> dict[str, str]:
    """Returns the text of each file that generate.py writes for a scene, by its path in the output folder."""
    done = run("--scene", scene, "--output", output)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    return texts_in(output)


def texts_in(folder: Path) -> dict[str, str]:
    files = (
        path
        for path in folder.rglob("*")
        if path.is_file() and not path.name.startswith(("model.png", "icon"))
    )
    return {path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8") for path in files}


program.read_catalogue = cache(program.read_catalogue)  # it does not change while tests run
_kept = tempfile.TemporaryDirectory()


@cache
def folder_of(scene: str) -> Path:
    """Returns the files of a scene of the repository, its icons among them, made once."""
    folder = Path(_kept.name) / scene
    file = FOLDER / "scenes" / f"{scene}.toml"
    done = run("--scene", file, "--output", folder, "--icon", folder / "model.png")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    return folder


@cache
def files_of(scene: str) -> dict[str, str]:
    return texts_in(folder_of(scene))


@cache
def table() -> dict:
    return json.loads(run("--table").stdout)


@cache
def describe(scene: str) -> dict:
    """parse_xml of a scene of the repository."""
    return parse_xml(files_of(scene)["modelDescription.xml"])


def parse_xml(text: str) -> dict[str, dict]:
    """Returns name -> what modelDescription.xml says of the variable, with what its declared type adds."""
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
            "reference": int(scalar.get("valueReference")), "base": value.tag,
            "type": value.get("declaredType"), "causality": scalar.get("causality"),
            "variability": scalar.get("variability"), "tunable": scalar.get("variability") == "tunable",
            "initial": scalar.get("initial"), "unit": attribute.get("unit"),
            "quantity": attribute.get("quantity"), "nominal": attribute.get("nominal"),
            "min": float(low) if low else -LARGEST, "max": float(high) if high else LARGEST,
            "start": value.get("start"),
            "items": {item.get("name"): int(item.get("value")) for item in declared.iterchildren("Item")},
            "description": scalar.get("description"),
        }  # fmt: skip
    return variables


ROW = re.compile(
    r'^\s*\{"(?P<name>[^"]+)", (?P<min>[^,]+), (?P<max>[^,]+), (?P<reference>\d+), '
    r"(?:offsetof\(struct scene_values, (?P<member>[^)]+)\)|0), ROW_(?P<row>\w+), "
    r"VARIABLE_(?P<base>\w+), VARIABLE_(?P<causality>\w+), (?P<element>\d+), (?P<component>\d+), "
    r"(?P<length>\d+), (?P<reinit>[01]), (?P<tunable>[01])\},$",
    re.MULTILINE,
)


def parse_c(text: str) -> dict[str, dict]:
    """Returns name -> the fields of the C table, in the words of FMI."""
    local = dict.fromkeys(("STATE", "RATE", "INDICATOR"), "local")
    causality = {"CALCULATED_PARAMETER": "calculatedParameter", **local}
    variables = {}
    for match in ROW.finditer(text):
        fields = match.groupdict()
        assert fields["name"] not in variables
        variables[fields["name"]] = {
            "reference": int(fields["reference"]), "base": fields["base"].capitalize(),
            "causality": causality.get(fields["causality"], fields["causality"].lower()),
            "min": float(fields["min"]), "max": float(fields["max"]),
            **{key: fields[key] for key in ("member", "row")},
            **{key: int(fields[key]) for key in ("element", "component", "length", "reinit")},
            "tunable": fields["tunable"] == "1",
        }  # fmt: skip
    return variables


def words(element) -> str:
    return " ".join(element.text_content().split())


def page_types(page) -> dict[str, tuple[str, str]]:
    """Returns name of each type -> its range on the documentation page."""
    rows = page.xpath("//table[@class='types']/tr[td]")
    return {words(row[0]): (words(row[2]), words(row[3])) for row in rows}


def page_range(limits: tuple[str, str], own: str, given: bool) -> tuple[str, str]:
    """As the page says: its own range, or that of its type, for what is given no further than 1e150."""
    if own:
        low, _, high = own.partition(" to ")
        return low, high
    bounded = [min(max(float(limit), -1e150), 1e150) for limit in limits] if given else limits
    return str(bounded[0]), str(bounded[1])


def parse_page(text: str) -> dict[str, dict]:
    """Returns name of each scalar -> what its row in the tables of the documentation page says."""
    variables = {}
    page = html.fromstring(text)
    types = page_types(page)
    for row in page.xpath("//table[@class='variables']/tr[td]"):
        name_cell, unit, start, symbol, meaning_cell = row.findall("td")
        reference, causality, type_name = words(name_cell.find("small")).split(", ")
        tunable, causality = causality.startswith("tunable "), causality.removeprefix("tunable ")
        own = meaning_cell.find("small")
        own_range = words(own) if own is not None else ""
        meaning = words(meaning_cell).removesuffix(own_range)
        name, unit, start, symbol = words(name_cell.find("code")), words(unit), words(start), words(symbol)
        low, high = "", ""
        if type_name in types and types[type_name][0] != "false":
            low, high = page_range(types[type_name], own_range, causality in ("parameter", "input"))
        count = int(name[-2]) if "[1.." in name else 1
        first, *last = map(int, reference.split(".."))
        assert last == ([first + count - 1] if count > 1 else [])
        starts = start.strip("()").split(", ") if start else [None] * count
        for k in range(count):
            scalar = name.replace(f"[1..{count}]", f"[{k + 1}]")
            assert scalar not in variables
            variables[scalar] = {
                "reference": first + k, "causality": causality, "tunable": tunable, "type": type_name,
                "unit": unit or None, "start": starts[k], "min": low, "max": high, "symbol": symbol,
                "meaning": meaning,
            }  # fmt: skip
    return variables


def row_of(name: str, scene: dict) -> tuple[str, dict]:
    """Returns key and row of variables.toml of a scalar variable, by its name and the scene file alone."""
    plain = whole(name)
    owner, _, field = plain.partition(".")
    shapes = {body["name"]: body["shape"] for body in scene["body"]}
    if owner in shapes:
        plain = f"body.{field}"
    for contact in scene["contact"]:
        if contact["name"] == owner:
            plain = f"contact.{field}"
            shapes[owner] = shapes[contact["destination"].partition(".")[0]]
    row = CATALOGUE["variable"][plain]
    return plain, row | row.get(f"of_{shapes.get(owner)}", {})


@cache
def scene_file(scene: str) -> dict:
    return written_out(tomllib.loads((FOLDER / "scenes" / f"{scene}.toml").read_text(encoding="utf-8")))


def written_out(scene: dict) -> dict:
    """Returns the scene with a table for each body and contact that `count` or `ball[*]` stands for. `block`
    of a table is the hundred in which its value references are."""
    stride = max(len(scene["body"]), len(scene["contact"]))
    count = {body["name"].partition("[")[0]: body.get("count", 1) for body in scene["body"]}
    result = {**scene, "body": [], "contact": [], "start": {}, "pinned": {}}
    copies = {}
    for kind, parity in (("body", 1), ("contact", 2)):
        for k, table in enumerate(scene[kind]):
            of_group = [count[text[:-3]] for text in table.values() if str(text).endswith("[*]")]
            number = table.get("count", of_group[0] if of_group else 1)
            copies[table["name"].partition("[")[0]] = number
            for i in range(1, number + 1):
                plain = {
                    key: text.replace("{i}", str(i)).replace("{i+1}", str(i + 1)).replace("*", str(i))
                    if isinstance(text, str)
                    else text
                    for key, text in table.items()
                    if key != "count"
                }
                result[kind].append(plain | {"block": parity + 2 * (k + stride * (i - 1))})
    for table in ("start", "pinned"):
        values = scene.get(table, {})
        for name, value in values.items():
            number = copies[name.partition("[")[0]] if "{i}" in name else 1
            several = isinstance(value, list) and (isinstance(value[0], list) or len(value) != 3)
            by_copy = several and "{i}" in name
            for i in range(1, number + 1):
                result[table][name.replace("{i}", str(i))] = value[i - 1] if by_copy else value
        result[table] |= {name: value for name, value in values.items() if "{i}" not in name}
    return result
