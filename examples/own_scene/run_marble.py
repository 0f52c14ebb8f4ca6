#!/usr/bin/env python3
"""The FMU of MarbleOnPipe.toml, driven step by step with the marble pushed along the pipe for a while.

python examples/own_scene/run_marble.py [FMU]      default build/fmus/MarbleOnPipe.fmu

Build it first, from the root of the project:

.venv/bin/contact-fmus build examples/own_scene/MarbleOnPipe.toml -o build/fmus
"""

import sys

import fmpy
import numpy as np
from fmpy import fmi2

PUSH = 0.01  # N along the pipe, for the first half second


def main(fmu: str) -> None:
    folder, description = fmpy.extract(fmu), fmpy.read_model_description(fmu)
    references = {variable.name: variable.valueReference for variable in description.modelVariables}

    def vector(name: str) -> list[int]:
        return [references[f"{name}[{k}]"] for k in (1, 2, 3)]

    marble = fmi2.FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="marble",
    )
    marble.instantiate()
    marble.setupExperiment(tolerance=1e-9, stopTime=1.0)
    marble.enterInitializationMode()
    marble.exitInitializationMode()
    for step in range(100):
        marble.setReal(vector("marble.external_force"), [0.0, PUSH if step < 50 else 0.0, 0.0])
        marble.doStep(0.01 * step, 0.01)
    place = marble.getReal(vector("marble.position"))
    bounces = marble.getInteger([references["touch.onsets"]])[0]
    print(f"after 1 s and {bounces} bounces the marble is at {np.round(place, 5)} m")
    marble.terminate()
    marble.freeInstance()


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "build/fmus/MarbleOnPipe.fmu")
