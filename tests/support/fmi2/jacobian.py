"""Directional derivatives that an FMU gives, compared with difference quotients through the FMU itself"""

import numpy as np

from support.fmi2 import raw
from support.fmi2.raw import OK

STEP = 1e-4


def jacobian(instance: raw.Instance, unknowns, knowns) -> np.ndarray:
    columns = []
    rows = [variable.reference for variable in unknowns]
    for known in knowns:
        status, values = instance.directional(rows, [known.reference], [1.0])
        assert status == OK, instance.texts()
        columns.append(values)
    return np.array(columns).T


def moved(instance: raw.Instance, known, by: float, unknowns, blob: bytes) -> np.ndarray:
    assert instance.set_one(known, instance.get_one(known) + by) == OK
    values = np.array(instance.reals(unknowns))
    instance.restore(blob)
    return values


def differences(instance: raw.Instance, unknowns, knowns) -> np.ndarray:
    blob = instance.save()
    columns = []
    for known in knowns:
        near, far = (
            moved(instance, known, h, unknowns, blob) - moved(instance, known, -h, unknowns, blob)
            for h in (STEP, 2 * STEP)
        )
        columns.append((8 * near - far) / (12 * STEP))
    return np.array(columns).T


def checked_jacobian(instance: raw.Instance, unknowns, knowns) -> np.ndarray:
    """The Jacobian the FMU gives, after comparison with difference quotients."""
    given = jacobian(instance, unknowns, knowns)
    expected = differences(instance, unknowns, knowns)
    # Rounding of the values over the step, and the formula's own error on slopes as large as the largest.
    size = np.abs(instance.reals(unknowns))[:, None] * 1e-15 / STEP
    allowed = 100 * size + 1e-7 * np.max(np.abs(expected), axis=1, keepdims=True) + 1e-9
    wrong = [
        f"d {unknowns[i].name} / d {knowns[j].name}: {given[i, j]}, differences {expected[i, j]}"
        for i, j in np.argwhere(~(np.abs(given - expected) <= allowed))
    ]
    assert wrong == []
    return given
