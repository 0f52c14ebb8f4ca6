"""Reference results of an FMU, as the layered standard fmi-ls-ref 1.0.0-beta.1 has related files:

    python make_reference.py LIBRARY PLATFORM SCENE_FOLDER OUTPUT_FOLDER

Runs the default experiment of the description in SCENE_FOLDER with the library, as Co-Simulation by fmpy, and
writes into OUTPUT_FOLDER/extra the manifest, the start values (role parameter), the experiment, what it gave
(result) and the test case that joins them, and beside it the text that explains them. The same library
gives the same bytes. Where the experiment does not run there is neither result nor test case, and a sentence
says why.
"""

import csv
import io
import json
import shutil
import sys
import tempfile
from pathlib import Path
from xml.sax.saxutils import quoteattr

import fmpy

MOST_ROWS = 20  # besides the first: enough to see where a run goes astray, and a kilobyte
SHOWN = ("position", "gap", "normal_force", "total")  # last parts of the names of the outputs kept
MOST_STEPS = 100_000  # a build is no place for a run of more than some seconds
# Part of a column's largest value by which another processor or importer may differ: P1-P3b agree within
# 1e-9 on all platforms, and an importer may take other steps.
ALLOWED = 1e-6

RELATED = (
    ("application/x-ssp-parameter-set", "start.ssv", "parameter", "All parameters with their start values"),
    (
        "application/json",
        "experiment.json",
        "experiment/smoke-test",
        "The default experiment: times and tolerance",
    ),
    ("text/csv", "result.csv", "result", "What the experiment gave: outputs by time, in SI units"),
    (
        "application/json",
        "testcase.json",
        "testcase",
        "Which of these belong together, and the deviation allowed",
    ),
)
ABOUT = """\
Files in extra/org.fmi-standard.fmi-ls-ref (layered standard fmi-ls-ref 1.0.0-beta.1)

start.ssv        every parameter with its start value; applying it changes nothing
experiment.json  times in s and relative tolerance of the default experiment
result.csv       outputs at some of its communication points
testcase.json    parameters, experiment and result as one test; `allowed` is the part of a column's largest
                 value by which a run may differ from it

The build made result.csv by running this FMU's own library on Linux (x86-64), as Co-Simulation of FMI 2.0
in fmpy {version} with the step size and tolerance of the experiment and no inputs. It shows whether the FMU
runs here as it ran there; it is no proof that the model is right: that is what the project's tests are for.
"""


def unpacked(library: Path, platform: str, scene: Path, folder: Path) -> Path:
    """What fmpy needs of an FMU"""
    binaries = folder / "binaries" / platform
    binaries.mkdir(parents=True)
    shutil.copy(library, binaries / f"{scene.name}{library.suffix}")
    shutil.copy(scene / "modelDescription.xml", folder)
    return folder


def outputs(description) -> list[str]:
    real = [
        one.name for one in description.modelVariables if one.causality == "output" and one.type == "Real"
    ]
    return [name for name in real if name.partition("[")[0].rpartition(".")[2] in SHOWN] or real[:3]


def result(folder: Path, description) -> str:
    experiment, names = description.defaultExperiment, outputs(description)
    steps = (float(experiment.stopTime) - float(experiment.startTime)) / float(experiment.stepSize)
    if steps > MOST_STEPS:
        raise ValueError(f"the default experiment has {steps:.0f} steps (allowed: {MOST_STEPS})")
    found = fmpy.simulate_fmu(
        str(folder), fmi_type="CoSimulation", validate=False, output=names,
        start_time=float(experiment.startTime), stop_time=float(experiment.stopTime),
        output_interval=float(experiment.stepSize), relative_tolerance=float(experiment.tolerance),
    )  # fmt: skip
    last = len(found) - 1
    rows = range(0, last + 1, -(-last // MOST_ROWS))
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["time", *names])
    table.writerows([repr(float(found[name][i])) for name in ("time", *names)] for i in rows)
    return text.getvalue()


def parameters(description) -> str:
    """System Structure Parameter Values 1.0; an enumeration by its number, as FMI 2.0 sets it."""
    lines = []
    for one in description.modelVariables:
        if one.causality == "parameter":
            base = "Integer" if one.type == "Enumeration" else one.type
            lines.append(
                f'<ssv:Parameter name="{one.name}"><ssv:{base} value="{one.start}"/></ssv:Parameter>\n'
            )
    space = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<ssv:ParameterSet xmlns:ssv="{space}" version="1.0" name="start">\n<ssv:Parameters>\n'
        f"{''.join(lines)}</ssv:Parameters>\n</ssv:ParameterSet>\n"
    )


def manifest(present: dict[str, str]) -> str:
    related = "".join(
        f'  <Related type="{kind}" source="{source}" role="{role}" description={quoteattr(text)}/>\n'
        for kind, source, role, text in RELATED
        if source in present
    )
    about = "Layered Standard providing information on related files included in an FMU."
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<fmiReferences xmlns:fmi-ls="http://fmi-standard.org/fmi-ls-manifest"\n'
        '  fmi-ls:fmi-ls-name="org.fmi-standard.fmi-ls-ref" fmi-ls:fmi-ls-version="1.0.0-beta.1"\n'
        f'  fmi-ls:fmi-ls-description="{about}">\n{related}</fmiReferences>\n'
    )


def files(folder: Path) -> dict[str, str]:
    description = fmpy.read_model_description(str(folder), validate=False)
    experiment = description.defaultExperiment
    times = {
        "start_time": float(experiment.startTime), "stop_time": float(experiment.stopTime),
        "step_size": float(experiment.stepSize), "tolerance": float(experiment.tolerance),
    }  # fmt: skip
    made = {"start.ssv": parameters(description), "experiment.json": json.dumps(times, indent=1) + "\n"}
    case = {
        "parameters": "start.ssv",
        "experiment": "experiment.json",
        "result": "result.csv",
        "allowed": ALLOWED,
    }
    try:
        made["result.csv"] = result(folder, description)
        made["testcase.json"] = json.dumps(case, indent=1) + "\n"
    except Exception as error:  # fmpy has no class of its own for what a call refuses
        print(f"{description.modelName}: no reference results inside: {error}", file=sys.stderr)
    return {"fmi-ls-manifest.xml": manifest(made), **made}


def main(library: str, platform: str, scene: str, output: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        made = files(unpacked(Path(library), platform, Path(scene), Path(folder)))
    extra = Path(output) / "extra"
    shutil.rmtree(extra, ignore_errors=True)
    extra.mkdir(parents=True)
    for name, text in made.items():
        (extra / name).write_text(text, encoding="utf-8")
    (Path(output) / "fmi-ls-ref.txt").write_text(ABOUT.format(version=fmpy.__version__), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
