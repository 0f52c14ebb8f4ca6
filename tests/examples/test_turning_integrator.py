"""The hand-written integrator around TurningForceElement against an independent integration of both."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from contact_fmus.fmu.files import fmu_file
from support.checks import check_close
from support.reference.turning_run import follow

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
END = 0.06  # s: the ball has come, slid and left


@pytest.fixture(scope="module")
def example():
    spec = importlib.util.spec_from_file_location("turning_integrator", EXAMPLES / "turning_integrator.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


def test_a_hand_written_integrator_moves_both_bodies_as_the_reference(example):
    contact = example.ContactLoads(str(fmu_file("TurningForceElement")))
    state = example.move(contact, END)
    contact.close()
    moments = example.inertia(example.CYLINDER)
    values = {
        "source.radius": 0.1, "source.mass": 1.0, "source.center": example.BALL["center"],
        "source.rotation": "free", "source.initial_velocity": example.VELOCITY,
        "source.initial_angular_velocity": example.SPIN, "destination.radius": 0.5, "destination.mass": 20.0,
        "destination.motion": "free", "destination.rotation": "free", "gravity": [0.0, 0.0, 0.0],
        "destination.inertia_control": "user_defined", "destination.axial_inertia": moments[2],
        "destination.transverse_inertia": moments[0], "contact.location": "outside",
        "contact.friction": "regularized",
        **{name: value for name, value in example.LAW.items() if name != "contact.slip_velocity_control"},
        "contact.slip_velocity_control": "user_defined",
    }  # fmt: skip
    right = follow(values, "cylinder", END).figures()
    assert right["contact.onsets"] == 1
    for body, part in (("source", state[:13]), ("destination", state[13:])):
        check_close(f"{body}.position", part[:3], right[f"{body}.position"], 1e-6)
        check_close(f"{body}.velocity", part[3:6], right[f"{body}.velocity"], 2e-5)
        check_close(f"{body}.angular_velocity", part[10:], right[f"{body}.angular_velocity"], 2e-4)
    strayed = np.max(np.abs(example.momenta(state) - example.momenta(example.begin())))
    check_close("momenta", strayed, 0.0, 1e-12)
