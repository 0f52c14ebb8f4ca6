"""The command compatibility: what FMI's cross check wants to know of an exported FMU

NAME_ref.csv   outputs as this project runs it, with rows at both sides of each onset and release of a contact
NAME_in.csv    inputs, where the FMU has any
NAME_ref.opt   times, step and tolerance
NAME_cc.csv    outputs as fmpy runs it, an importer that others have written
ReadMe.txt     what made these files
"""

import csv
import shutil
from pathlib import Path

import fmpy

from contact_fmus.fmu.files import unpack
from contact_fmus.fmu.variables import read_variables
from contact_fmus.options import parse
from contact_fmus.results import Result
from contact_fmus.running.exchange import by_fmpy
from contact_fmus.scenarios.experiment import Experiment
from contact_fmus.scenarios.recording import simulate
from contact_fmus.scenarios.scenario import find, first_run


def main(arguments: list[str] | None = None) -> int:
    """0: written"""
    options = parse("compatibility", arguments)
    experiments = {target: first_run(find(target))[0] for target in options.targets}
    for target, experiment in experiments.items():
        folder = options.output / unpack(experiment.fmu)[1].fmiVersion / experiment.fmu.stem
        folder.mkdir(parents=True, exist_ok=True)
        _write(folder, target, experiment)
        print(folder)
    return 0


def _write(folder: Path, target: str, experiment: Experiment) -> None:
    unzipped, description = unpack(experiment.fmu)
    variables, begin = read_variables(description), folder / experiment.fmu.stem
    own, fmpys = simulate(experiment), by_fmpy(experiment, kind="coSimulation")
    own.tell_warnings()
    outputs, inputs = (
        [name for name in fmpys.columns if variables[name].causality == kind] for kind in ("output", "input")
    )
    _table(Path(f"{begin}_ref.csv"), own, outputs)
    _table(Path(f"{begin}_cc.csv"), fmpys, outputs)
    if inputs:
        _table(Path(f"{begin}_in.csv"), fmpys, inputs)
    lines = {"StartTime": experiment.start_time, "StopTime": experiment.stop_time}
    lines |= {"StepSize": experiment.step, "RelTol": experiment.tolerance or 0.0}
    text = "".join(f"{key},{value!r}\n" for key, value in lines.items())
    Path(f"{begin}_ref.opt").write_text(text, encoding="utf-8")
    about = Path(__file__).with_suffix(".txt").read_text(encoding="utf-8")
    about = about.format(
        name=experiment.fmu.stem,
        title=experiment.title,
        version=description.fmiVersion,
        kinds="Co-Simulation" + (" and Model Exchange" if description.modelExchange else ""),
        platforms=", ".join(sorted(path.name for path in (unzipped / "binaries").iterdir())),
        target=target,
        fmpy=fmpy.__version__,
        step=experiment.step,
        values=", ".join(f"{name} = {value}" for name, value in experiment.values.items()) or "the FMU's own",
    )
    (folder / "ReadMe.txt").write_text(about, encoding="utf-8")
    shutil.copy(experiment.fmu, folder)


def _table(file: Path, result: Result, names: list[str]) -> None:
    """Names in quotation marks, Booleans as 0 and 1, items of enumerations by name"""
    with open(file, "w", newline="", encoding="utf-8") as opened:
        csv.writer(opened, quoting=csv.QUOTE_ALL, lineterminator="\n").writerow(["time", *names])
        csv.writer(opened, lineterminator="\n").writerows(result.rows(names))
