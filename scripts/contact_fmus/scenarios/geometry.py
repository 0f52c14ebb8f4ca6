"""The contact geometry and force law once more, from DESIGN's formulas in NumPy, to compare the FMU with"""

from __future__ import annotations

import numpy as np

from . import closed_forms
from .experiment import Recording


def _is_cylinder(run: Recording) -> bool:
    return run.has("destination.axis")


def recompute_force(run: Recording) -> tuple[np.ndarray, float]:
    """Force on a source outside the destination, both prescribed; and the size of the largest term in it"""
    apart, closing = (_relative(run, kind) for kind in ("displacement", "velocity"))
    if _is_cylinder(run):
        axis = np.asarray(run.value("destination.axis"), dtype=float)
        axis = axis / np.linalg.norm(axis)
        along = apart @ axis
        apart = apart - np.outer(along, axis)
    distance = np.linalg.norm(apart, axis=1)
    normal = apart / distance[:, None]
    gap = distance - run.value("source.radius") - run.value("destination.radius")
    rate = np.sum(closing * normal, axis=1)
    touching = gap < 0.0
    if _is_cylinder(run) and run.value("destination.finite_length"):
        touching &= np.abs(along) <= 0.5 * run.value("destination.length")
    elastic, viscous = (
        -run.value("contact.penalty_factor") * gap,
        -run.value("contact.viscous_penalty_factor") * rate,
    )
    dashpot = run.value("contact.dashpot")
    if dashpot == "approach_only":
        viscous = np.where(rate < 0.0, viscous, 0.0)
    force = elastic + viscous
    if dashpot == "non_adhesive":
        force = np.maximum(force, 0.0)
    scale = float(np.max(np.where(touching, np.abs(elastic) + np.abs(viscous), 0.0)))
    return -np.where(touching, force, 0.0)[:, None] * normal, scale


def _relative(run: Recording, kind: str) -> np.ndarray:
    """Destination minus source: location of the centres, or their velocity"""
    relative = run.series[f"destination.prescribed_{kind}"] - run.series[f"source.prescribed_{kind}"]
    if kind == "displacement":
        relative = relative + (
            np.asarray(run.value("destination.center")) - np.asarray(run.value("source.center"))
        )
    return relative


def diagonal(run: Recording) -> float:
    """Diagonal of the bounding box of both bodies at the start; of an infinite cylinder, its cross-section"""
    centers, extents = [], []
    for body in ("source", "destination"):
        centers.append(np.asarray(run.value(f"{body}.position"), dtype=float))
        extents.append(closed_forms.sphere_extent(run.value(f"{body}.radius")))
    if _is_cylinder(run):
        finite = run.value("destination.finite_length")
        length = run.value("destination.length") if finite else 0.0
        extents[1] = closed_forms.cylinder_extent(
            run.value("destination.radius"), run.value("destination.axis"), length
        )
    lower = [center - extent for center, extent in zip(centers, extents, strict=True)]
    upper = [center + extent for center, extent in zip(centers, extents, strict=True)]
    return closed_forms.box_diagonal(lower, upper)
