"""Comparisons that print both values and fail on NaN, and runs of an FMU from a configuration."""

import numpy as np
import pytest

METHODS = ["event_driven", "cvode_bdf", "cvode_adams"]
DASHPOTS = ["non_adhesive", "unclamped", "approach_only"]
FMU = {"sphere": "SphereSphere", "cylinder": "SphereCylinder"}


def differences(what, value, expected, allowed):
    """Returns nothing when all |value - expected| <= allowed (scalars or vectors), else a line with both."""
    value, expected = np.asarray(value, np.longdouble), np.asarray(expected, np.longdouble)
    error = np.max(np.abs(value - expected))
    if error <= allowed:  # False for NaN
        return []
    return [
        f"{what}: got {shown(value)}, expected {shown(expected)}, "
        f"off by {float(error):.3g} > {float(allowed):.3g}"
    ]


def shown(values):
    text = ", ".join(f"{float(x):.17g}" for x in np.ravel(values))
    return f"({text})" if np.ndim(values) else text


def check_close(what, value, expected, allowed):
    wrong = differences(what, value, expected, allowed)
    assert not wrong, wrong[0]


def check_relative(what, value, expected, relative):
    check_close(what, value, expected, relative * float(np.max(np.abs(np.asarray(expected, np.longdouble)))))


def start(fmu, configuration, tolerance=None, method=None):
    """Starts a run at time 0. "<input>.derivatives" lists first and second derivatives given at time 0."""
    fmu.reset()
    fmu.messages.clear()
    values = {name: value for name, value in configuration.items() if not name.endswith(".derivatives")}
    if method:
        values["solver.method"] = method
    if "solver.max_internal_steps" in fmu:  # far more than any run needs: one that is stuck fails soon
        values.setdefault("solver.max_internal_steps", 300_000)
    fmu.start(values, tolerance=tolerance)
    # Tests set more than a scene needs, such as that limit; test_idle_parameters.py has these warnings.
    fmu.messages[:] = [one for one in fmu.messages if "was set and is not in force" not in one.text]
    for name, rows in configuration.items():
        if name.endswith(".derivatives"):
            for order, row in enumerate(rows, start=1):
                fmu.set_derivative(name.removesuffix(".derivatives"), row, order=order)
    return fmu


def run(fmu, configuration, end, steps=10, tolerance=1e-10, method="event_driven", each=None):
    """From 0 to `end` in equal communication steps; calls `each(fmu)` at the start and after every step."""
    start(fmu, configuration, tolerance, method)
    if each:
        each(fmu)
    for k in range(steps):
        fmu.step(end * (k + 1) / steps - fmu.time)
        if each:
            each(fmu)
    return fmu


def by_methods(failures_of):
    """Returns what `failures_of(method)` lists, for the methods for which it lists anything."""
    found = {method: failures_of(method) for method in METHODS}
    return {method: lines for method, lines in found.items() if lines}


def impulse_and_peak(fmu, configuration, end, steps, tolerance=None, method=None):
    """Of the force on the source, over all steps of such a run"""
    start(fmu, configuration, tolerance, method)
    impulse, peak = np.zeros(3), 0.0
    for k in range(steps):
        size = end * (k + 1) / steps - fmu.time
        fmu.step(size)
        impulse += size * fmu["contact.mean_force"]
        peak = max(peak, fmu["contact.peak_force"])
    return impulse, peak


@pytest.fixture(autouse=True)
def the_fmu_prints_nothing(capfd):
    """An FMU talks through the logger alone: standard output and standard error stay empty in every test."""
    yield
    printed = capfd.readouterr()
    assert (printed.out, printed.err) == ("", "")
