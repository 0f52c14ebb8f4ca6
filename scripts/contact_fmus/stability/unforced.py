"""What all motions have in common where nothing but the contact acts on the bodies"""

from __future__ import annotations

import numpy as np


class Unforced:
    """Neither gravity nor an external force, and nothing that is led"""

    def given_impulse(self, body: str, time: float) -> np.ndarray:
        return np.zeros(3)

    def passive(self) -> bool:
        return True
