"""The command stability: runs the atlas's scenes and writes runs.csv, summary.csv, figures, index.html and README.md"""

import argparse
import multiprocessing
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contact_fmus.options import parse
from contact_fmus.pages import stopwatch

from .motions import GEOMETRIES, LAWS, HeadOn
from .page import draw_page, groups, write_csv
from .run import SceneRun, not_right, run_all, run_scene, thinned
from .scenes import Scene, all_scenes, power


def radii(random: np.random.Generator, inside: bool) -> tuple[float, float]:
    """Source, destination: 1e-12 to 1e9 m, ratios to 1e-12, shells filled but for 1e-13 of their radius"""
    large = power(random, -12, 9)
    small = large * power(random, -12, -0.02)
    if inside and random.random() < 0.3:
        small = large * (1 - power(random, -13, -1))
    return (small, large) if inside or random.integers(2) else (large, small)


def stiffness(random: np.random.Generator, mass: float, speed: float, reach: float) -> float:
    """The stiffness gives a depth of 1e-8 to 1e8 times the reach, or any depth."""
    chosen = mass * (speed / (reach * power(random, -8, 8))) ** 2 if random.random() < 0.6 else power(random, -6, 20)
    return min(max(chosen, 1e-290), 1e290)


def finite(random: np.random.Generator, motion: HeadOn) -> HeadOn:
    """Some of the cylinders, and the ball on its way along them"""
    if not motion.geometry.startswith("cylinder") or random.random() >= 0.3:
        return motion
    length = motion.reach * power(random, -1, 2)
    along = float(random.uniform(-0.6, 0.6) * length)
    speed = float(random.choice([-1, 1]) * motion.speed * power(random, -2, 1))
    return replace(motion, length=length, along=along, along_speed=speed)


def drawn(seed: int) -> Scene:
    random = np.random.default_rng([77, seed])
    geometry = GEOMETRIES[random.integers(4)]
    inside = geometry.endswith("inside")
    source, destination = radii(random, inside)
    reach = destination - source if inside else destination + source
    mass = power(random, -15, 15)
    other = mass * power(random, -16, 16) if random.integers(2) else None
    speed = power(random, -9, 8)
    motion = HeadOn(
        penalty=stiffness(random, mass * other / (mass + other) if other else mass, speed, reach),
        geometry=geometry,
        law=LAWS[random.integers(5)],
        dashpot=LAWS[1 + random.integers(3)],
        source_radius=source,
        destination_radius=destination,
        gap=reach * power(random, -9, -0.01 if inside else 1),
        speed=speed,
        source_mass=mass,
        destination_mass=other,
        ratio=power(random, -6, 5),
        gravity=float(power(random, -3, 3) * random.integers(2)),
        force=float(power(random, -9, 15) * (random.random() < 0.3)),
        offset=float(power(random, 0, 9) * (random.random() < 0.15)),
    )
    return Scene("beyond", seed, finite(random, motion), steps=(1, int(random.integers(2, 40))))


def run_seed(seed: int) -> list[SceneRun] | str:
    """The runs of one scene, or the reason why it has no closed form"""
    try:
        return run_scene(drawn(seed), ("event_driven",))
    except ArithmeticError as error:
        return str(error)


def line_of(row: SceneRun) -> str:
    what = row.wrong if row.status == "ok" else f"{row.status}: {row.message}"
    return (
        f"{row.value:.0f}, {row.geometry}, {row.law}, {row.communication_steps} steps: {what}; "
        f"error {row.error:.2g}, energy {row.balance:.2g}, "
        f"{row.onsets} of {row.expected_onsets} impacts, {row.steps} internal steps"
    )


def beyond(first: int, last: int, workers: int) -> None:
    """Random head-on scenes far beyond the atlas's axes, one for each seed, by event_driven, against the closed
    form: all that is wrong or refused is named. Nobody claims that all are right: where bodies go so far together,
    or swing so far beyond the clearance between them, that positions of 16 digits do not tell the gap any more,
    impacts are lost or without end."""
    count: Counter[str] = Counter()
    seeds = range(first, last + 1)
    with multiprocessing.get_context("spawn").Pool(workers) as pool:
        for seed, rows in zip(seeds, pool.imap(run_seed, seeds, chunksize=4), strict=True):
            if isinstance(rows, str):
                count["not compared"] += 1
                print(f"{seed}: not compared, because the reference has no answer ({rows})", flush=True)
                continue
            for row in rows:
                count += Counter(runs=1, wrong=int(bool(row.wrong)), refused=int(row.status != "ok"))
                if row.wrong or row.status != "ok":
                    print(line_of(row), flush=True)
    print(
        f"{count['runs']} runs, {count['wrong']} wrong, {count['refused']} refused"
        + (f"; {count['not compared']} seeds not compared" if count["not compared"] else "")
    )


QUICK = 37  # every so many-th scene


def main(arguments: list[str] | None = None) -> int:
    """0: done; 1: with --check, a run of event_driven is wrong or did not end; 2: something is not built"""
    options = parse("stability", arguments)
    if options.beyond:
        beyond(*options.beyond, options.workers)
        return 0
    options.output.mkdir(parents=True, exist_ok=True)
    rows = _measured(options)
    write_csv(rows, options.output / "runs.csv")
    write_csv(groups(rows), options.output / "summary.csv")
    plan = "A quick run with few of the scenes. " if options.quick else ""
    for file in draw_page(rows, options.output, plan):
        print(file)
    print(ending(rows))
    failed = not_right(rows, "event_driven")
    for row in failed if options.check else ():
        print(f"not right: {row.family}, {row.value:g}, {row.geometry}, {row.law}: {row.wrong or row.message}")
    return int(options.check and bool(failed))


def ending(rows: Sequence[SceneRun]) -> str:
    """How many runs are wrong or refused, and of which method"""
    wrong = Counter(row.method for row in rows if row.wrong)
    refused = Counter(row.method for row in rows if row.status != "ok")
    return f"{len(rows)} runs, {_of_methods('wrong', wrong)}, {_of_methods('refused', refused)}"


def _of_methods(what: str, count: Counter[str]) -> str:
    """4 wrong (cvode_bdf 3, cvode_adams 1)"""
    each = ", ".join(f"{method} {number}" for method, number in count.most_common())
    return f"{count.total()} {what}" + (f" ({each})" if each else "")


def _measured(options: argparse.Namespace) -> list[SceneRun]:
    say, family, rows = stopwatch(), "", []
    for scene, found in run_all(thinned(all_scenes(), QUICK if options.quick else 1), options.workers):
        if scene.family != family:
            family = scene.family
            say(family)
        rows += found
    say("done")
    return rows
