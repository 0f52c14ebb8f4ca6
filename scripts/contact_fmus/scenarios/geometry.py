"""The contact geometry and force law once more, from DESIGN's formulas in NumPy, to compare the FMU with"""

from __future__ import annotations

import numpy as np

from . import closed_forms
from .experiment import Recording, RunError


def _pair(run: Recording) -> tuple[str, str, str]:
    """Names of contact, source and destination; RunError where the scene has more than one contact"""
    contacts = run.motion.scene.contacts
    if len(contacts) != 1:
        text = f"the claim is about one contact, and {run.scenario.fmu} has {len(contacts)}"
        raise RunError(f"{run.scenario.name}: {text}")
    return contacts[0].name, contacts[0].source, contacts[0].destination


def recompute_force(run: Recording) -> tuple[np.ndarray, float]:
    """Force on a source outside the destination, both prescribed; and the size of the largest term in it"""
    contact, source, destination = _pair(run)
    apart, closing = (_relative(run, kind) for kind in ("displacement", "velocity"))
    axis, is_plane = run.motion.axis(destination), run.motion.is_plane(destination)
    if axis is not None and not is_plane:
        along = apart @ axis
        apart = apart - np.outer(along, axis)
    distance = apart @ -axis if is_plane else np.linalg.norm(apart, axis=1)
    normal = np.tile(-axis, (len(apart), 1)) if is_plane else apart / distance[:, None]
    gap = distance - run.value(f"{source}.radius") - (run.motion.radius(destination) or 0.0)
    rate = np.sum(closing * normal, axis=1)
    touching = gap < 0.0
    if not is_plane and axis is not None and run.value(f"{destination}.finite_length"):
        touching &= np.abs(along) <= 0.5 * run.value(f"{destination}.length")
    elastic = -run.value(f"{contact}.penalty_factor") * gap
    viscous = -run.value(f"{contact}.viscous_penalty_factor") * rate
    dashpot = run.value(f"{contact}.dashpot")
    if dashpot == "approach_only":
        viscous = np.where(rate < 0.0, viscous, 0.0)
    force = elastic + viscous
    if dashpot == "non_adhesive":
        force = np.maximum(force, 0.0)
    scale = float(np.max(np.where(touching, np.abs(elastic) + np.abs(viscous), 0.0)))
    return -np.where(touching, force, 0.0)[:, None] * normal, scale


def _relative(run: Recording, kind: str) -> np.ndarray:
    """Destination minus source: location of the centres, or their velocity"""
    _, source, destination = _pair(run)
    relative = run.series[f"{destination}.prescribed_{kind}"] - run.series[f"{source}.prescribed_{kind}"]
    if kind == "displacement":
        relative = relative + (
            np.asarray(run.value(f"{destination}.center")) - np.asarray(run.value(f"{source}.center"))
        )
    return relative


def diagonal(run: Recording) -> float:
    """Diagonal of the bounding box of both bodies at the start; of an infinite cylinder, its cross-section,
    and nothing of a plane"""
    centers, extents = [], []
    for body in _pair(run)[1:]:
        if run.motion.is_plane(body):
            continue
        radius, axis = run.value(f"{body}.radius"), run.motion.axis(body)
        centers.append(np.asarray(run.value(f"{body}.position"), dtype=float))
        if axis is None:
            extents.append(closed_forms.sphere_extent(radius))
        else:
            extents.append(closed_forms.cylinder_extent(radius, axis, run.motion.length(body) or 0.0))
    lower = [center - extent for center, extent in zip(centers, extents, strict=True)]
    upper = [center + extent for center, extent in zip(centers, extents, strict=True)]
    return closed_forms.box_diagonal(lower, upper)
