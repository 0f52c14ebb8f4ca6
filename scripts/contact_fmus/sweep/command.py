"""The command sweep: runs a study, keeps its results, draws them"""

import argparse
import contextlib
import json
import os
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from contact_fmus.errors import DONE, INTERRUPTED, UserError, similar
from contact_fmus.fmu.files import repository
from contact_fmus.options import parse
from contact_fmus.results import PICTURES, output_file

FOLDER = Path("results")


def main(arguments: list[str] | None = None) -> int:
    options = parse("sweep", arguments, guide=str(repository() / "docs" / "sweep.md"))
    options.study = _study(options.study)
    if options.workers is not None and options.workers < 1:
        raise UserError(f"--workers: a whole number from 1 is wanted, not {options.workers}")
    from .study import columns_of, read_study

    study = read_study(options.study)
    folder = options.output or FOLDER / options.study.stem
    drawn = None
    if options.plot is not None:
        target = output_file(Path(options.plot or folder / "plot.png"), "", PICTURES)
        drawn = target, columns_of(study, options.x, options.y, options.color)
    from .store import Store

    store = Store(folder, study)
    store.open(options.resume)
    try:
        return _sweep(store, options, drawn)
    finally:
        store.close()


def _study(given: Path) -> Path:
    """The file, or the shipped study of this name"""
    if given.is_file() or given.suffix:
        return given
    shipped = {file.stem: file for file in (repository() / "scripts" / "studies").glob("*.toml")}
    if given.name not in shipped:
        known = f"{similar(given.name, shipped)}; studies: {', '.join(sorted(shipped))}"
        raise UserError(f"'{given}' is no shipped study and no file NAME.toml{known}")
    return shipped[given.name]


def _sweep(store, options: argparse.Namespace, drawn: tuple[Path, list[str]] | None) -> int:
    begin = time.perf_counter()
    store.check()
    before = store.done()
    try:
        if not store.complete:
            _run(store, options)
        files = [store.results]
        if options.csv:
            files.append(store.write_csv())
        if drawn:
            from .plot import draw

            files.append(draw(store, *drawn))
    except KeyboardInterrupt:
        said = f"interrupted: {store.done():,} of {store.runs:,} runs are kept in {store.folder}"
        print(f"contact-fmus sweep: {said}; --resume goes on", file=sys.stderr)
        return INTERRUPTED
    _report(store, options, files, store.runs - before, time.perf_counter() - begin)
    return DONE


def _report(store, options: argparse.Namespace, files: list[Path], done: int, seconds: float) -> None:
    counts, warned = store.counts()
    if options.json:
        about = {"runs": store.runs, "done_now": done, "seconds": seconds, "status": counts, "warned": warned}
        print(json.dumps(about | {"files": [str(file) for file in files]}))
        return
    states = ", ".join(f"{count:,} {name}" for name, count in sorted(counts.items(), key=lambda one: -one[1]))
    print(f"{store.runs:,} runs ({states}); {done:,} of them now, in {seconds:.3g} s")
    if warned:
        told = "the column warnings counts them, contact-fmus run tells what they say"
        print(f"the FMU warned in {warned:,} of {store.runs:,} runs: {told}", file=sys.stderr)
    for file in files:
        print(file)


def _run(store, options: argparse.Namespace) -> None:
    """Makes the missing runs, with a bar on a terminal. Rows are merged while the workers end."""
    from .drive import Drive, Interrupts, connected, make_work

    samples, interrupts = store.study.samples(), Interrupts()
    # The strata of a million samples take as long as the workers need to start.
    pool = ThreadPoolExecutor(1)
    preparing = pool.submit(samples.prepare)
    workers = options.workers or len(os.sched_getaffinity(0))
    with interrupts.answered(), connected(options.scheduler, workers, options.dashboard) as client, _bar(store) as told:
        preparing.result()
        drive = Drive(client, store.study, samples, store, make_work(store.study))
        with interrupts.looked_for():
            drive.run(told, interrupts.look)
        merging = pool.submit(store.merge)
    merging.result()


@contextlib.contextmanager
def _bar(store) -> Iterator[Callable[[int], None]]:
    """Runs done, time passed and time left, on the terminal and nowhere else"""
    from rich import progress
    from rich.console import Console

    columns = (
        progress.TextColumn("{task.description}"),
        progress.BarColumn(),
        progress.TextColumn("{task.completed:,.0f} of {task.total:,.0f} runs"),
        progress.TimeElapsedColumn(),
        progress.TimeRemainingColumn(),
    )
    console = Console(stderr=True)
    with progress.Progress(*columns, console=console, disable=not console.is_terminal) as bar:
        task = bar.add_task("sweep", total=store.runs, completed=store.done())
        yield lambda runs: bar.advance(task, runs)
