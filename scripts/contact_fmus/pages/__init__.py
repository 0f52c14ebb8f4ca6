"""What all pages of results share: base.html (layout, style sheet), parts.html and parts.md (tables, figures)

Filters for words with formulas between $: with indices and powers in HTML, plain in Markdown and attributes.
A page is a Jinja template in the package that shows it; it extends base.html or imports from parts.
"""

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

import rich.markup
import rich.table
from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape
from markupsafe import Markup, escape
from rich.console import Console

from contact_fmus.fmu.files import repository
from contact_fmus.fmu.host import host_file

# Formulas in the words of a page: $p_n = f_p E_ref diag$ becomes HTML, or plain text outside of it. They may have names
# with one index (p_n, E_ref), Greek names (tau, pi), powers (x^2, delta^(3/2)), sqrt(...), brackets and operators.

FORMULA = re.compile(r"\$([^$\n]+)\$")
GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "zeta": "ζ", "lambda": "λ",
    "mu": "μ", "omega": "ω", "pi": "π", "rho": "ρ", "sigma": "σ", "tau": "τ", "phi": "φ",
}  # fmt: skip
SIGNS = {"sqrt(": "√(", "<=": "≤", ">=": "≥", "*": "·"}
NAME, POWER = re.compile(r"(?<!&)\b([^\W\d_]+)(?:_(\w+))?"), re.compile(r"\^(\d+|\([^()]*\))")


def typeset(text: str) -> Markup:
    """The text for HTML: names slanted, indices below, powers above"""
    parts = FORMULA.split(text)
    return Markup("").join(_marked(part) if k % 2 else escape(part) for k, part in enumerate(parts))


def _marked(formula: str) -> Markup:
    text = str(escape(_plain(formula).replace("-", "−")))
    text = NAME.sub(lambda name: f"<i>{name[1]}</i>" + (f"<sub>{name[2]}</sub>" if name[2] else ""), text)
    return Markup(POWER.sub(r"<sup>\1</sup>", text))


def plain(text: str) -> str:
    """The text for a terminal or Markdown: $sqrt(m/p_n)$ is √(m/p_n)"""
    return FORMULA.sub(lambda match: _plain(match[1]), text)


def _plain(formula: str) -> str:
    formula = re.sub(rf"\b({'|'.join(GREEK)})(?=\b|_)", lambda match: GREEK[match[1]], formula)
    for sign, shown in SIGNS.items():
        formula = formula.replace(sign, shown)
    return formula


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
    """Prints the table on the terminal. Its cells may have rich's markup; brackets in the header hold units."""
    drawn = rich.table.Table(title=table.caption, title_justify="left", header_style="bold")
    for place, head in enumerate(table.header):
        drawn.add_column(rich.markup.escape(head), justify="left" if place < table.numbers else "right")
    for row in table.rows:
        drawn.add_row(*row)
    (console or make_console()).print(drawn)


# The machine and the versions a report was made with; nothing that names a host, a user or a folder

PACKAGES = ("fmpy", "numpy", "scipy", "matplotlib")


def versions() -> dict[str, str]:
    file = host_file().parent / "CMakeCache.txt"
    lines = file.read_text(encoding="utf-8").splitlines() if file.is_file() else []  # none in an installed package
    cache = {match[1]: match[2] for line in lines if (match := re.match(r"([\w-]+):\w+=(.*)", line))}
    compiler = cache.get("CMAKE_C_COMPILER", "cc")
    said = subprocess.run([compiler, "--version"], capture_output=True, text=True, check=False).stdout.splitlines()
    processor = matched(r"^model name\s*:\s*(.+)$", Path("/proc/cpuinfo"), "unknown processor")
    found = {
        "processor": f"{processor}, {os.cpu_count()} cores, {platform.machine()}",
        "system": platform.freedesktop_os_release().get("PRETTY_NAME", platform.system()),
        "compiler": f"{said[0].strip() if said else Path(compiler).name}, {cache.get('CMAKE_BUILD_TYPE', '')}",
        "SUNDIALS": _sundials(cache),
        "FMUs": matched(r"project\(\w+ VERSION ([\d.]+)", repository() / "CMakeLists.txt", "unknown"),
        "Python": platform.python_version(),
    }
    return found | {name: metadata.version(name) for name in PACKAGES}


def matched(pattern: str, file: Path, otherwise: str) -> str:
    """What the group of the pattern matches first in the file"""
    match = re.search(pattern, file.read_text(encoding="utf-8"), re.MULTILINE)
    return match[1].strip() if match else otherwise


def _sundials(cache: dict[str, str]) -> str:
    """The installed one says its version in its CMake package; else the build has fetched one."""
    file = Path(cache.get("SUNDIALS_DIR", "")) / "SUNDIALSConfigVersion.cmake"
    own = cache.get("CONTACT_SUNDIALS_FIT") == "TRUE" or file.is_file()
    if own and (installed := matched(r'PACKAGE_VERSION "([\d.]+)"', file, "")):
        return installed
    fetched = matched(r"# v([\d.]+)", repository() / "cmake" / "ContactSundials.cmake", "")
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

    def embedded(name: str) -> str:
        file = folder / name
        return f"data:{IMAGES[file.suffix]};base64,{base64.b64encode(file.read_bytes()).decode()}"

    made = environment(templates, OWN)
    made.filters["embedded"] = embedded
    files = []
    for template, name in names.items():
        page = made.get_template(template).render(context)
        (folder / name).write_text(page.rstrip() + "\n", encoding="utf-8")
        files.append(folder / name)
    return files


def environment(*folders: Path) -> Environment:
    made = Environment(
        loader=FileSystemLoader(folders),
        autoescape=select_autoescape(["html"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    made.filters |= {"typeset": typeset, "plain": plain}
    made.filters["cell"] = lambda text: str(text).replace("|", "\\|").replace("\n", " ")
    return made
