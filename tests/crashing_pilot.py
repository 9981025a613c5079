"""A pilot of the tests that goes down like native code does. It imports little, because its process starts often."""

import os
import signal

import numpy as np

from scenegen_flythrough.loop.pilot import Observation


class Crashing:
    """All is far, until it is asked about flight 2 in the air."""

    name = "crashing"
    needs: frozenset[str] = frozenset()

    def estimate(self, seen: Observation) -> np.ndarray:
        if seen.time_s > 0.5 and 2 in seen.flight:
            os.kill(os.getpid(), signal.SIGSEGV)
        if seen.time_s < 0.0:
            raise ValueError("asked before the start")
        shape = (len(seen.flight), seen.camera.height_px, seen.camera.width_px)
        return np.full(shape, 50.0, np.float32)
