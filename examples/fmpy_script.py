#!/usr/bin/env python3
"""A ball bounces on a sphere: one FMU, fmpy and nothing else.

python examples/fmpy_script.py [FMU]      default build/fmus/BallOnSphere.fmu
"""

import sys

import fmpy
import numpy as np

UNCLAMPED = 2  # contact.dashpot; fmpy wants the number of an item, `fmpy info` lists them


def main(fmu: str) -> None:
    result = fmpy.simulate_fmu(
        fmu,
        stop_time=1.5,
        output_interval=1e-3,  # communication step, s; impacts in between are not missed
        relative_tolerance=1e-10,
        start_values={
            "source.center[1]": 0.03,  # m: a little off the top, so that it leaves to the side
            "source.center[2]": 0.04,
            "contact.dashpot": UNCLAMPED,
            "contact.viscous_penalty_factor": 200.0,  # N s/m
        },
        output=["source.position[3]", "contact.onsets", "contact.last_onset_time", "contact.peak_force"],
    )
    impacts = np.flatnonzero(np.diff(result["contact.onsets"])) + 1  # the steps in which one began
    print("impact at s   peak force in N in that millisecond")
    for row in result[impacts]:
        print(f"{row['contact.last_onset_time']:11.6f}   {row['contact.peak_force']:11.1f}")
    print(f"height after {result['time'][-1]:g} s: {result['source.position[3]'][-1]:.5f} m")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "build/fmus/BallOnSphere.fmu")
