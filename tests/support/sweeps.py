"""Studies written, run in this process and as commands; a scheduler and workers as processes of their own"""

import contextlib
import json
import subprocess
import sys
import time

from contact_fmus.sweep.drive import make_batch, make_work
from contact_fmus.sweep.study import read_study
from contact_fmus.sweep.worker import run_batch
from support.programs import PATIENCE, environment, finished, python

# Eight parameters of a ball that bounces on a fixed sphere
BOUNCES = {"source.radius": "{ range = [0.05, 0.15] }"}
BOUNCES |= {"source.mass": '{ range = [0.1, 10.0], scale = "log" }'}
BOUNCES |= {"source.center[3]": "{ range = [0.8, 1.5] }"}
BOUNCES |= {"source.initial_velocity[3]": "{ range = [-2.0, 2.0] }"}
BOUNCES |= {"destination.radius": "{ range = [0.4, 0.6] }"}
BOUNCES |= {"contact.penalty_factor": '{ range = [1e5, 1e8], scale = "log" }'}
BOUNCES |= {"contact.viscous_penalty_factor": '{ range = [1.0, 300.0], scale = "log" }'}
BOUNCES |= {"contact.dashpot": '{ choices = ["unclamped", "non_adhesive"] }'}
OUTPUTS = {"height": '"source.position[3]"', "bounces": '"contact.onsets"', "touching": '"contact.active"'}
OUTPUTS |= {"dashpot": '"contact.dashpot"'}
OUTPUTS |= {"peak_force": '{ variable = "contact.peak_force", reduce = "max" }'}
OUTPUTS |= {"gap": '{ variable = "contact.gap", reduce = ["min", "mean"] }'}
OUTPUTS |= {"speed_then": '{ variable = "source.velocity[3]", at = 0.7 }'}


def study_text(vary=BOUNCES, outputs=OUTPUTS, count=50, experiment="stop_time = 2.0\nsteps = 4", **more):
    """`more`: other lines of the file's head, fmu among them"""
    lines = [f"{key} = {value}" for key, value in {"fmu": '"SphereSphere"', **more}.items()]
    lines += ["[experiment]", experiment, "[start]", '"contact.method" = "penalty_dynamic"', "[vary]"]
    lines += [f'"{name}" = {entry}' for name, entry in vary.items()]
    lines += ["[samples]", f"count = {count}", "seed = 3"] if count else []
    lines += ["[outputs]"] + [f'"{name}" = {entry}' for name, entry in outputs.items()]
    return "\n".join(lines) + "\n"


def write_study(folder, text=None, **options):
    file = folder / "study.toml"
    file.write_text(study_text(**options) if text is None else text, encoding="utf-8")
    return file


def run_here(study, first=0, count=None, compiled=True):
    """Parameters and rows of a stretch of runs, without a cluster"""
    samples = study.samples()
    values = samples.values(first, samples.runs if count is None else count)
    work = make_work(study)
    work = type(work)(work.fmu, work.plan, work.single, compiled)
    return values, run_batch(work, make_batch(study, first, values))


def command(file, *options):
    return python("contact_fmus", "sweep", file, *options)


def sweep(file, *options, status=0):
    """Returns the finished command; its status is checked, and that no traceback was printed."""
    said = finished(command(file, *options), env=environment())
    assert said.returncode == status, said.stderr
    assert "Traceback" not in said.stderr
    return said


def read(file):
    return read_study(file)


def wait_for(happened):
    end = time.monotonic() + PATIENCE
    while not happened():
        assert time.monotonic() < end, "nothing happened"
        time.sleep(0.02)


class Cluster:
    """dask's scheduler on the loopback and workers without a nanny, each a process that can be killed"""

    def __init__(self, folder):
        self.folder = folder
        self.file = folder / "scheduler.json"
        self.processes = []
        self.workers = []
        self._start("scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(self.file))
        wait_for(self._is_told)
        self.address = json.loads(self.file.read_text())["address"]

    def _is_told(self):
        """The scheduler writes its file in pieces: it is complete when it can be read"""
        try:
            return "address" in json.loads(self.file.read_text())
        except (FileNotFoundError, json.JSONDecodeError):
            return False

    def _start(self, *arguments):
        line = [sys.executable, "-m", "distributed.cli.dask_" + arguments[0], *arguments[1:]]
        line += ["--no-dashboard"]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        self.processes.append(subprocess.Popen(line, cwd=self.folder, env=environment(), **quiet))
        return self.processes[-1]

    def add_worker(self):
        options = ("--no-nanny", "--nthreads", "1", "--memory-limit", "0", "--local-directory")
        options += (str(self.folder),)
        self.workers.append(self._start("worker", self.address, "--host", "127.0.0.1", *options))

    def close(self):
        for process in self.processes:
            with contextlib.suppress(ProcessLookupError):
                process.kill()
            process.wait()
