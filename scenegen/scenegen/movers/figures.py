"""People as movers: a body that fits its speed, dressed for the season, and its gait."""

from __future__ import annotations

from functools import cache

import numpy as np
from jaxtyping import Float64

from scenegen.geometry.part import Part
from scenegen.geometry.template import Template, place
from scenegen.movers.gait import Gait
from scenegen.parts.people.body import body
from scenegen.parts.people.outfit import outfits
from scenegen.parts.people.posture import HEIGHT_M
from scenegen.parts.workshop import Workshop

RUNNING_MPS = 2.0
"""From here on people run."""
_PHASES = 16
_CHILDREN = 0.12


def person(speed_mps: float, shop: Workshop, rng: np.random.Generator) -> tuple[Part, Gait]:
    """Somebody who goes at a speed; the rest pose is the start of the step.

    A stride is 0.8 of the height at an easy walk and grows with the square root of the speed; runners leave the
    ground and take longer ones.
    """
    young = bool(rng.uniform() < _CHILDREN)
    tall = float(rng.uniform(1.05, 1.45) if young else np.clip(rng.normal(1.72, 0.08), 1.5, 1.95))
    wide = tall * float(rng.uniform(0.93, 1.12))
    scale = np.array([wide, wide, tall]) / HEIGHT_M
    runs = speed_mps >= RUNNING_MPS
    posture = "running" if runs else "walking"
    owner = np.array([shop.builder.new_objects()])
    zero, cycle = np.zeros((1, 3)), (_cycle(posture, young) * scale).astype(np.float32)
    part = place(_rest(posture, young), zero, zero[:, 0], scale[None], outfits(1, shop, rng), owner)
    pace = np.sqrt(speed_mps / 3.0) * 1.3 if runs else np.sqrt(speed_mps / 1.3) * 0.8
    return part, Gait(float(pace * tall), cycle)


@cache
def _rest(posture: str, young: bool) -> Template:
    return body(posture, 0.0, young)


@cache
def _cycle(posture: str, young: bool) -> Float64[np.ndarray, "phases vertices 3"]:
    """Vertices at even phases of the step, the lower foot a centimetre in the ground."""
    cycle = np.stack([body(posture, k / _PHASES, young).vertices for k in range(_PHASES)])
    cycle[..., 2] -= cycle[..., 2].min(axis=1, keepdims=True) + 0.01
    return cycle
