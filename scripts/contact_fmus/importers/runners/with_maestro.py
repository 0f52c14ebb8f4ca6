"""Maestro: Java, by its command line and a program in its language MaBL; the first argument is its jar"""

import csv
import subprocess
import sys
import zipfile
from decimal import Decimal
from pathlib import Path
from xml.etree import ElementTree

from request import Request, answer, request

# setInteger takes an array, which has a name of its own.
SETTING = """uint reference_{at}[1] = {{{reference}}};
    int value_{at}[1] = {{{value}}};
    failed = failed + tried.setInteger(reference_{at}, 1, value_{at});
    """


def program(asked: Request) -> str:
    about = ElementTree.fromstring(zipfile.ZipFile(asked.fmu).read("modelDescription.xml"))
    size = len(asked.references)
    return (
        Path(__file__)
        .with_suffix(".mabl")
        .read_text(encoding="utf-8")
        .format(
            guid=about.get("guid"),
            fmu=asked.fmu,
            settings="".join(
                SETTING.format(at=at, reference=reference, value=value)
                for at, (_, reference, value) in enumerate(asked.settings)
            ).rstrip(),
            count=asked.count,
            step=f"{Decimal(repr(asked.step)):f}",  # the language has no exponents
            size=size,
            size_and_one=size + 1,
            references=", ".join(map(str, asked.references.values())),
            zeros=", ".join(["0.0"] * size),
            headers=", ".join(f'"{at}"' for at in range(size + 1)),
            values=", ".join(f"values[{at}]" for at in range(size)),
        )
    )


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
