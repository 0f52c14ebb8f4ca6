"""Equal balls on a line, the first of which hits the others: Newton's cradle and a chain of beads.

In units of the ball's mass, the contact's stiffness and the speed of the first ball. All touch at the
start without a force. The force of a contact is the overlap (linear law) or its power 3/2 (Hertz); kinks
of it are met by the integrator's own control of its error."""

import numpy as np
from scipy.integrate import solve_ivp

POWER = {"linear": 1.0, "hertz": 1.5}


def velocities(balls: int, law: str, end: float) -> np.ndarray:
    """Returns velocities of the balls at the time `end`, to 1e-11."""
    return motion(balls, law, end)[balls:]


def motion(balls: int, law: str, end: float, relative: float = 1e-13) -> np.ndarray:
    """Returns how far the balls have come by the time `end`, and their velocities."""

    def rates(_, y):
        place, velocity = y[:balls], y[balls:]
        force = np.maximum(place[:-1] - place[1:], 0.0) ** POWER[law]
        return np.concatenate([velocity, np.diff(-force, prepend=0.0, append=0.0)])

    start = np.zeros(2 * balls)
    start[balls] = 1.0
    return solve_ivp(rates, (0.0, end), start, method="DOP853", rtol=relative, atol=1e-15).y[:, -1]
