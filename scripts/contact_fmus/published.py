"""The impacts of Y. C. Chung, J. Y. Ooi, Benchmark tests for verifying discrete element modelling codes at
particle impact level, Granular Matter 13 (2011) 643: normal (1 to 3) and oblique impacts of elastic spheres
"""

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import jinja2

from contact_fmus.errors import CLAIM_FAILED, DONE

from .fmu.contact_fmu import ContactFmu, fmu_file
from .options import parse


class Impact(SimpleNamespace):
    """Its fields are those of [[impact]] in the table, None where it has none."""


TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
MATERIALS = {name: {"name": name} | values for name, values in TABLE["material"].items()}
IMPACTS = tuple(
    Impact(**dict.fromkeys(TABLE["fields"]) | row | one | {"material": MATERIALS[row["material"]]})
    for row in TABLE["impact"]
    for one in row.pop("each", [{}])
)


@dataclass(frozen=True)
class Outcome:
    force: float  # N
    depth: float  # m
    restitution: float  # speed after over speed before
    first: float  # m/s, velocity of the source's point of contact along the other body at the start
    slip: float  # m/s, and at the end
    sliding: float | None  # m/s, the same where the impact slides throughout
    along: float  # m/s, velocity of the source along the surface
    spin: float  # rad/s

    def is_published(self, impact: Impact) -> bool:
        pairs = [(self.force, impact.force), (self.depth, impact.depth), (self.slip, self.sliding)]
        pairs.append((self.restitution, impact.restitution or 1.0))
        return all(there is None or abs(here - there) <= DIGITS * there for here, there in pairs)


def setup_of(impact: Impact) -> dict[str, Any]:
    return TABLE["setup"][impact.setup]


def start_values(impact: Impact) -> dict[str, Any]:
    material, setup = impact.material, setup_of(impact)
    values = {
        "source.radius": impact.radius,
        "source.mass": material["density"] * 4 / 3 * math.pi * impact.radius**3,
        "source.center": [0.0, 0.0, setup["apart"] * impact.radius],
        "source.initial_velocity": [0.0, 0.0, -impact.speed],
        "source.youngs_modulus": material["youngs_modulus"],
        "source.poissons_ratio": material["poissons_ratio"],
        "destination.poissons_ratio": material["poissons_ratio"],
        "contact.method": "penalty" if impact.restitution is None else "penalty_dynamic",
        "contact.restitution": impact.restitution or 1.0,
    }
    if setup["fmu"] == "SphereSphere":
        same = ("radius", "mass", "youngs_modulus")
        values |= {f"destination.{name}": values[f"source.{name}"] for name in same}
        values["destination.initial_velocity"] = [0.0, 0.0, setup["comes"] * impact.speed]
    return TABLE["start"] | setup["start"] | values | (impact.start or {})


def outcome(fmu: ContactFmu, impact: Impact, method: str, tolerance: float) -> Outcome:
    """The FMU runs the impact in one step: its peaks are those of the motion, not of samples."""
    setup = setup_of(impact)
    before = (1 + setup["comes"]) * impact.speed
    fmu.reset()
    fmu.start(start_values(impact) | {"solver.method": method}, tolerance=tolerance)
    first = slip_of(fmu, impact)
    fmu.step(0.2 * impact.radius / before)
    after = fmu["source.velocity"][2] - fmu["destination.velocity"][2]
    kick = 3.5 * setup["start"].get("contact.friction_coefficient", 0.0) * (before + after)
    slips = first, slip_of(fmu, impact), first - kick if 0.0 < kick < 0.95 * first else None
    peaks = fmu["contact.peak_force"], fmu["contact.peak_penetration"]
    return Outcome(*peaks, after / before, *slips, fmu["source.velocity"][0], fmu["source.angular_velocity"][1])


def slip_of(fmu: ContactFmu, impact: Impact) -> float:
    along = fmu["source.velocity"][0] - fmu["destination.velocity"][0]
    return along - impact.radius * (fmu["source.angular_velocity"][1] + fmu["destination.angular_velocity"][1])


METHODS = ("event_driven", "cvode_bdf", "cvode_adams")
TOLERANCE = 1e-10
DIGITS = 5e-4  # published forces have four digits at least, depths five


def main(arguments: list[str] | None = None) -> int:
    """docs/chung-ooi.md. 0: all figures are the published ones to their digits; 1: one is not"""
    options = parse("published", arguments)
    found = []
    for impact in IMPACTS:
        with ContactFmu(fmu_file(setup_of(impact)["fmu"])) as fmu:
            found.append((impact, {method: outcome(fmu, impact, method, TOLERANCE) for method in METHODS}))
    good = all(one.is_published(impact) for impact, outcomes in found for one in outcomes.values())
    template = jinja2.Template(Path(__file__).with_suffix(".md").read_text(encoding="utf-8"), trim_blocks=True)
    text = template.render(found=found, methods=METHODS, tolerance=f"{TOLERANCE:g}")
    if options.output:
        options.output.write_text(text, encoding="utf-8")
    else:
        print(text, end="")
    return DONE if good else CLAIM_FAILED
