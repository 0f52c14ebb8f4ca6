"""Maestro: Java, by its command line and a program in its language MaBL; the first argument is its jar"""

import csv
import subprocess
import sys
import zipfile
from decimal import Decimal
from pathlib import Path
from xml.etree import ElementTree

import jinja2
from request import Request, answer, request


def program(asked: Request) -> str:
    about = ElementTree.fromstring(zipfile.ZipFile(asked.fmu).read("modelDescription.xml"))
    template = jinja2.Template(Path(__file__).with_suffix(".mabl").read_text(encoding="utf-8"), trim_blocks=True)
    step = f"{Decimal(repr(asked.step)):f}"  # the language has no exponents
    return template.render(asked=asked, guid=about.get("guid"), step=step, size=len(asked.references))


jar = sys.argv.pop(1)
asked = request()
Path("tried.mabl").write_text(program(asked))
Path("tried.runtime.json").write_text('{"DataWriter": [{"filename": "outputs.csv", "type": "CSV"}]}')
command = ["java", "-Djava.awt.headless=true", "-jar", jar, "interpret"]
run = subprocess.run(
    [*command, "-runtime", "tried.runtime.json", "tried.mabl"], capture_output=True, text=True, check=False
)
if run.returncode or not Path("outputs.csv").is_file():
    said = [line for line in (run.stdout + run.stderr).splitlines() if "rror" in line or "xception" in line]
    raise SystemExit(said[-1] if said else f"status {run.returncode}")
with Path("outputs.csv").open(newline="") as file:
    _, (_, failed, *values) = csv.reader(file)
if float(failed):
    raise SystemExit("a call failed")
answer("3.1.1", asked.references, map(float, values))
