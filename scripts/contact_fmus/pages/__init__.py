"""What all pages of results share: base.html (layout, style sheet), parts.html and parts.md (tables, figures)

Filters for words with formulas between $: typeset in HTML, plain in Markdown and attributes.
A page is a Jinja template in the package that shows it; it extends base.html or imports from parts.
"""

from __future__ import annotations

import base64
import json
import os
import platform
import re
import subprocess
import time
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

import rich.table
from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape
from markupsafe import Markup, escape
from rich.console import Console

from contact_fmus.fmu.files import repository
from contact_fmus.fmu.host import host_file

# Formulas in the words of a page: $p_n = f_p E_ref diag$ becomes MathML, or plain text outside HTML
#
# Formulas between two $ may have numbers (1e6 is 10 to the 6th), names with one index (p_n, E_ref), Greek names
# (tau, pi), powers (x^2), sqrt(...), brackets and operators.

FORMULA = re.compile(r"\$([^$\n]+)\$")
GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "zeta": "ζ", "lambda": "λ",
    "mu": "μ", "omega": "ω", "pi": "π", "rho": "ρ", "sigma": "σ", "tau": "τ", "phi": "φ",
}  # fmt: skip
SIGNS = {"-": "−", "*": "·", "<=": "≤", ">=": "≥"}
TOKEN = re.compile(
    r"\s*(?:(?P<number>\d+(?:\.\d+)?)(?:e(?P<power>[-+]?\d+))?"
    r"|(?P<name>[A-Za-zΑ-ω]+)(?:_(?P<index>\w+))?"
    r"|(?P<sign><=|>=|[-+*/=<>,()|·√^]))"
)


class FormulaError(ValueError):
    """Something that formulas do not have"""


def typeset(text: str) -> Markup:
    """The text for HTML, its formulas as MathML"""
    parts = FORMULA.split(text)
    return Markup("").join(
        Markup("<math>{}</math>").format(_Row(part).all()) if k % 2 else escape(part) for k, part in enumerate(parts)
    )


def plain(text: str) -> str:
    """The text for a terminal or Markdown: $sqrt(m/p_n)$ is √(m/p_n)"""
    return FORMULA.sub(lambda match: _plain(match[1]), text)


def _plain(formula: str) -> str:
    names = "|".join(GREEK)
    formula = re.sub(rf"\b({names})(?=\b|_)", lambda match: GREEK[match[1]], formula)
    return formula.replace("sqrt(", "√(").replace("<=", "≤").replace(">=", "≥").replace("*", "·")


class _Row:
    """One formula, read from left to right"""

    def __init__(self, text: str):
        self.text, self.tokens, at = text, [], 0
        while text[at:].strip():
            match = TOKEN.match(text, at)
            if match is None:
                raise FormulaError(f"formula '{text}': '{text[at:].strip()[0]}' is not known here")
            self.tokens.append(match)
            at = match.end()
        self.place = 0

    def all(self) -> Markup:
        row = self.until("")
        if self.place < len(self.tokens):
            raise FormulaError(f"formula '{self.text}': a bracket too many")
        return row

    def until(self, end: str) -> Markup:
        """What stands before the sign `end`"""
        parts: list[Markup] = []
        while self.place < len(self.tokens) and self.tokens[self.place]["sign"] != (end or ")"):
            if self.tokens[self.place]["sign"] == "^":
                self.place += 1
                parts.append(Markup("<msup>{}{}</msup>").format(parts.pop(), self.one()))
            else:
                if parts and self.place > 0 and not self.after_sign() and self.sign() in (None, "("):
                    parts.append(Markup('<mspace width="0.2em"/>'))  # a product
                parts.append(self.one())
        if end and self.place == len(self.tokens):
            raise FormulaError(f"formula '{self.text}': '{end}' is missing")
        return Markup("").join(parts)

    def one(self) -> Markup:
        """A number, a name, a root, a bracket or a sign"""
        if self.place == len(self.tokens):
            raise FormulaError(f"formula '{self.text}' ends too early")
        token = self.tokens[self.place]
        self.place += 1
        if token["number"]:
            return _number(token["number"], token["power"])
        if token["name"] == "sqrt" and self.sign() == "(":
            return Markup("<msqrt>{}</msqrt>").format(self.bracket())
        if token["name"]:
            return _name(token["name"], token["index"])
        if token["sign"] == "(":
            self.place -= 1
            return Markup("<mrow><mo>(</mo>{}<mo>)</mo></mrow>").format(self.bracket())
        return Markup("<mo>{}</mo>").format(SIGNS.get(token["sign"], token["sign"]))

    def after_sign(self) -> bool:
        """Whether an operator stands just before, so that what follows is no factor of a product"""
        return self.tokens[self.place - 1]["sign"] not in (None, ")")

    def sign(self) -> str | None:
        return self.tokens[self.place]["sign"] if self.place < len(self.tokens) else None

    def bracket(self) -> Markup:
        """What a pair of brackets holds; the place is at the opening one"""
        self.place += 1
        inner = self.until(")")
        self.place += 1
        return inner


def _number(digits: str, power: str | None) -> Markup:
    if power is None:
        return Markup("<mn>{}</mn>").format(digits)
    exponent = str(int(power)).replace("-", "−")
    ten = Markup("<msup><mn>10</mn><mn>{}</mn></msup>").format(exponent)
    return ten if digits == "1" else Markup("<mn>{}</mn><mo>·</mo>{}").format(digits, ten)


def _name(name: str, index: str | None) -> Markup:
    shown = Markup("<mi>{}</mi>").format(GREEK.get(name, name))
    return Markup("<msub>{}<mtext>{}</mtext></msub>").format(shown, index) if index else shown


# A table of a page: header and cells of text, the same for HTML and Markdown


@dataclass(frozen=True)
class Table:
    """Columns from the `numbers`-th on are aligned to the right."""

    caption: str
    header: Sequence[str]
    rows: Sequence[Sequence[str]]
    numbers: int = 1


WIDTH = 170  # of a terminal's tables where no terminal says otherwise


def make_console() -> Console:
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=WIDTH)


def stopwatch() -> Callable[[str], None]:
    """Prints texts behind the seconds that have passed"""
    begin = time.monotonic()
    return lambda text: print(f"{time.monotonic() - begin:6.1f} s  {text}", flush=True)


def write_json(file: Path, content: Any) -> None:
    file.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def show(table: Table, console: Console | None = None) -> None:
    """Prints the table on the terminal"""
    drawn = rich.table.Table(title=table.caption, title_justify="left", header_style="bold")
    for place, head in enumerate(table.header):
        drawn.add_column(head, justify="left" if place < table.numbers else "right")
    for row in table.rows:
        drawn.add_row(*row)
    (console or make_console()).print(drawn)


# The machine and the versions a report was made with; nothing that names a host, a user or a folder

PACKAGES = ("fmpy", "numpy", "scipy", "matplotlib")


def versions() -> dict[str, str]:
    cache = _cmake_cache(host_file().parent / "CMakeCache.txt")
    compiler = cache.get("CMAKE_C_COMPILER", "cc")
    said = subprocess.run([compiler, "--version"], capture_output=True, text=True, check=False).stdout.splitlines()
    processor = _matched(r"^model name\s*:\s*(.+)$", Path("/proc/cpuinfo"), "unknown processor")
    found = {
        "processor": f"{processor}, {os.cpu_count()} cores, {platform.machine()}",
        "system": platform.freedesktop_os_release().get("PRETTY_NAME", platform.system()),
        "compiler": f"{said[0].strip() if said else Path(compiler).name}, {cache.get('CMAKE_BUILD_TYPE', '')}",
        "SUNDIALS": _sundials(cache),
        "FMUs": _matched(r"project\(\w+ VERSION ([\d.]+)", repository() / "CMakeLists.txt", "unknown"),
        "Python": platform.python_version(),
    }
    return found | {name: metadata.version(name) for name in PACKAGES}


def _matched(pattern: str, file: Path, otherwise: str) -> str:
    """What the group of the pattern matches first in the file"""
    match = re.search(pattern, file.read_text(encoding="utf-8"), re.MULTILINE)
    return match[1].strip() if match else otherwise


def _cmake_cache(file: Path) -> dict[str, str]:
    if not file.is_file():  # an installed package has programs without their build
        return {}
    lines = file.read_text(encoding="utf-8").splitlines()
    return {match[1]: match[2] for line in lines if (match := re.match(r"([\w-]+):\w+=(.*)", line))}


def _sundials(cache: dict[str, str]) -> str:
    """The installed one says its version in its CMake package; else the build has fetched one."""
    file = Path(cache.get("SUNDIALS_DIR", "")) / "SUNDIALSConfigVersion.cmake"
    own = cache.get("CONTACT_SUNDIALS_FIT") == "TRUE" or file.is_file()
    if own and (installed := _matched(r'PACKAGE_VERSION "([\d.]+)"', file, "")):
        return installed
    fetched = _matched(r"# v([\d.]+)", repository() / "cmake" / "ContactSundials.cmake", "")
    return f"{fetched}, built with the FMUs" if fetched else "unknown"


OWN = Path(__file__).parent
IMAGES = {".png": "image/png", ".svg": "image/svg+xml"}
BOTH = {"page.html": "index.html", "page.md": "README.md"}


def read_words(module: str) -> dict[str, Any]:
    """What words.toml beside the module says"""
    return tomllib.loads(Path(module).with_name("words.toml").read_text(encoding="utf-8"))


def write_pages(
    templates: Path, folder: Path, context: Mapping[str, Any], names: Mapping[str, str] = BOTH
) -> list[Path]:
    """Renders each template of `names` as the file it stands for, next to the images it shows"""
    environment = _environment(templates, folder)
    files = []
    for template, name in names.items():
        page = environment.get_template(template).render(context)
        (folder / name).write_text(page.rstrip() + "\n", encoding="utf-8")
        files.append(folder / name)
    return files


def _environment(templates: Path, folder: Path) -> Environment:
    environment = Environment(
        loader=FileSystemLoader([templates, OWN]),
        autoescape=select_autoescape(["html"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )

    def embedded(name: str) -> str:
        file = folder / name
        return f"data:{IMAGES[file.suffix]};base64,{base64.b64encode(file.read_bytes()).decode()}"

    def cell(text: str) -> str:
        return str(text).replace("|", "\\|").replace("\n", " ")

    environment.filters |= {"embedded": embedded, "cell": cell, "typeset": typeset, "plain": plain}
    return environment
