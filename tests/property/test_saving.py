"""With event_driven, saving a state is only looking: random scenes with and without saves, bit by bit."""

import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError, fmu_file
from support.checks import start
from support.scenes.random_scenes import KINDS, random_scene
from support.scenes.scene_checks import FMU

STEPS = 23
SEEDS = range(3)
OUTPUTS = ("source.position", "source.velocity", "contact.peak_force", "contact.mean_force", "energy.total")


def run(fmu, values, end, saves):
    """The bits of OUTPUTS after each step; a refused step ends the list"""
    start(fmu, values, 1e-9, "event_driven")
    told = []
    for k in range(STEPS):
        if saves:
            fmu.save()
        try:
            fmu.step(end * (k + 1) / STEPS - fmu.time)
        except FmuError as error:
            return [*told, str(error)]
        told.append([fmu[name] if isinstance(fmu[name], float) else fmu[name].tobytes() for name in OUTPUTS])
    return told


@pytest.mark.parametrize("shape", FMU)
def test_random_scenes_have_the_same_bits_with_saves(shape):
    with ContactFmu(fmu_file(FMU[shape])) as fmu:
        for kind in KINDS[shape]:
            for seed in SEEDS:
                values, end = random_scene(shape, kind, seed)
                assert run(fmu, values, end, saves=True) == run(fmu, values, end, saves=False), (kind, seed)
