"""The impacts of Y. C. Chung, J. Y. Ooi, Benchmark tests for verifying discrete element modelling codes at
particle impact level, Granular Matter 13 (2011) 643: tests 1 to 3, normal impacts of elastic spheres
"""

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jinja2

from contact_fmus.errors import CLAIM_FAILED, DONE

from .fmu.contact_fmu import ContactFmu, fmu_file
from .options import parse


@dataclass(frozen=True)
class Impact:
    """Head-on, without gravity: of two equal spheres that both come, or of one on a rigid plane"""

    test: int
    material: dict[str, Any]  # name, youngs_modulus in Pa, poissons_ratio, density in kg/m^3
    radius: float  # m
    speed: float  # m/s, of each sphere
    on_plane: bool
    restitution: float | None  # None: without damping
    force: float | None = None  # N, published
    depth: float | None = None  # m, published

    @property
    def mass(self) -> float:
        return self.material["density"] * 4 / 3 * math.pi * self.radius**3


TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
MATERIALS = {name: {"name": name} | values for name, values in TABLE["material"].items()}
IMPACTS = tuple(
    Impact(**row | {"material": MATERIALS[row["material"]], "restitution": restitution})
    for row in TABLE["impact"]
    for restitution in row.get("restitution", [None])
)


@dataclass(frozen=True)
class Outcome:
    force: float  # N
    depth: float  # m
    restitution: float  # speed after over speed before

    def is_published(self, impact: Impact) -> bool:
        expected = 1.0 if impact.restitution is None else impact.restitution
        pairs = [(self.restitution, expected), (self.force, impact.force), (self.depth, impact.depth)]
        return all(there is None or abs(here - there) <= DIGITS * there for here, there in pairs)


def setup_of(impact: Impact) -> dict[str, Any]:
    return TABLE["setup"]["on_plane" if impact.on_plane else "both_come"]


def start_values(impact: Impact) -> dict[str, Any]:
    material, setup = impact.material, setup_of(impact)
    values = {
        "source.radius": impact.radius,
        "source.mass": impact.mass,
        "source.center": [0.0, 0.0, setup["apart"] * impact.radius],
        "source.initial_velocity": [0.0, 0.0, -impact.speed],
        "source.youngs_modulus": material["youngs_modulus"],
        "source.poissons_ratio": material["poissons_ratio"],
        "destination.poissons_ratio": material["poissons_ratio"],
        "contact.method": "penalty" if impact.restitution is None else "penalty_dynamic",
        "contact.restitution": 1.0 if impact.restitution is None else impact.restitution,
    }
    if not impact.on_plane:
        same = ("radius", "mass", "youngs_modulus")
        values |= {f"destination.{name}": values[f"source.{name}"] for name in same}
        values["destination.initial_velocity"] = [0.0, 0.0, impact.speed]
    return TABLE["start"] | setup["start"] | values


def outcome(fmu: ContactFmu, impact: Impact, method: str, tolerance: float) -> Outcome:
    """The FMU runs the impact in one step: its peaks are those of the motion, not of samples."""
    before = impact.speed if impact.on_plane else 2 * impact.speed
    fmu.reset()
    fmu.start(start_values(impact) | {"solver.method": method}, tolerance=tolerance)
    fmu.step(0.2 * impact.radius / before)
    after = fmu["source.velocity"][2] - fmu["destination.velocity"][2]
    return Outcome(fmu["contact.peak_force"], fmu["contact.peak_penetration"], after / before)


# The command published: docs/chung-ooi.md

METHODS = ("event_driven", "cvode_bdf", "cvode_adams")
TOLERANCE = 1e-10
DIGITS = 5e-4  # published forces have four digits at least, depths five


def main(arguments: list[str] | None = None) -> int:
    """0: all figures are the published ones to their digits; 1: one is not"""
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
