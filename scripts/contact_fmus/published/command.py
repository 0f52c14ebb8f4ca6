"""The command published: docs/chung-ooi.md"""

from __future__ import annotations

import argparse
from pathlib import Path

from contact_fmus.errors import CLAIM_FAILED, DONE
from contact_fmus.fmu.contact_fmu import ContactFmu, fmu_file

from .chung_ooi import IMPACTS, Impact, Outcome, outcome, scene_of

METHODS = ("event_driven", "cvode_bdf", "cvode_adams")
TOLERANCE = 1e-10
DIGITS = 5e-4  # published forces have four digits at least, depths five

HEAD = f"""# Published impacts

`contact-fmus published -o docs/chung-ooi.md` runs the normal impacts of Y. C. Chung and J. Y. Ooi,
*Benchmark tests for verifying discrete element modelling codes at particle impact level*, Granular Matter 13
(2011) 643, on `SphereSphere.fmu` and `SpherePlane.fmu` with `contact.law = hertz`, stiffness from Young's
modulus, Poisson's ratio and radii, tolerance {TOLERANCE:g}. A rigid plane has a modulus of 1e150 Pa.
Peaks are those of the whole motion, which is one communication step.
"""


def main(arguments: list[str] | None = None) -> int:
    """0: all figures are the published ones to their digits; 1: one is not"""
    parser = argparse.ArgumentParser(
        prog="contact-fmus published", description="Runs published benchmark impacts and compares."
    )
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="the page, as docs/chung-ooi.md")
    options = parser.parse_args(arguments)
    found = [(impact, _outcomes(impact)) for impact in IMPACTS]
    good = all(_is_published(impact, one) for impact, outcomes in found for one in outcomes.values())
    text = _page(found)
    if options.output:
        options.output.write_text(text, encoding="utf-8")
    else:
        print(text, end="")
    return DONE if good else CLAIM_FAILED


def _outcomes(impact: Impact) -> dict[str, Outcome]:
    with ContactFmu(fmu_file(scene_of(impact))) as fmu:
        return {method: outcome(fmu, impact, method, TOLERANCE) for method in METHODS}


def _is_published(impact: Impact, got: Outcome) -> bool:
    expected = 1.0 if impact.restitution is None else impact.restitution
    pairs = [(got.restitution, expected), (got.force, impact.force), (got.depth, impact.depth)]
    return all(there is None or abs(here - there) <= DIGITS * there for here, there in pairs)


def _page(found: list[tuple[Impact, dict[str, Outcome]]]) -> str:
    lines = [HEAD, "## Tests 1 and 2: without damping", ""]
    lines += [
        "Two equal spheres of 10 mm that meet at 10 m/s each; a sphere of 100 mm on a rigid plane at",
        "0.2 m/s.",
        "",
        f"| test | material | largest force, published | {' | '.join(METHODS)} |"
        f" largest overlap, published | {' | '.join(METHODS)} |",
        f"| --- | --- |{' ---: |' * (2 + 2 * len(METHODS))}",
    ]
    for impact, outcomes in found:
        if impact.force is not None and impact.depth is not None:
            forces = " | ".join(f"{one.force / 1e3:.3f} kN" for one in outcomes.values())
            depths = " | ".join(f"{one.depth * 1e6:.3f} µm" for one in outcomes.values())
            lines.append(
                f"| {impact.test} | {impact.material.name} | {impact.force / 1e3:.3f} kN | {forces} |"
                f" {impact.depth * 1e6:.5g} µm | {depths} |"
            )
    lines += [
        "",
        "## Test 3: with a coefficient of restitution",
        "",
        "A sphere of 2.5 mm on a rigid plane at 3.9 m/s. The speed after the impact over the speed before",
        "it is to be the coefficient itself.",
        "",
        f"| material | coefficient | {' | '.join(METHODS)} |",
        f"| --- |{' ---: |' * (1 + len(METHODS))}",
    ]
    for impact, outcomes in found:
        if impact.restitution is not None:
            ratios = " | ".join(f"{one.restitution:.9f}" for one in outcomes.values())
            lines.append(f"| {impact.material.name} | {impact.restitution:g} | {ratios} |")
    return "\n".join(lines) + "\n"
