"""What an inertial measurement unit on the airframe reports: specific force and body rates at an even rate.

The ideal samples follow from the motion in closed form. Noise, where asked for, is white noise and a bias that walks at
random, the two terms every data sheet names (IEEE Std 952-1997, annex C: N and K).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from jaxtyping import Float64
from pydantic import Field

from scenegen.foundation.section import Number, Section
from scenegen_flythrough.quadrotor.limits import GRAVITY_MPS2
from scenegen_flythrough.quadrotor.motion import Motion

RATE_HZ = 200.0
"""Samples a second; sample k is taken k / 200 s after the first stored frame."""


class ImuKnobs(Section):
    """Noise of the inertial unit. The defaults are those of a good MEMS unit on a drone."""

    noise: bool = False
    """Report noisy samples beside the ideal ones."""

    force_noise: Annotated[Number, Field(ge=0.0, le=1.0)] = 1.7e-3
    """White noise of the specific force [m/s^2/sqrt(Hz)]."""

    rate_noise: Annotated[Number, Field(ge=0.0, le=0.1)] = 2.4e-4
    """White noise of the body rates [rad/s/sqrt(Hz)]."""

    force_walk: Annotated[Number, Field(ge=0.0, le=0.1)] = 2.0e-4
    """Random walk of the bias of the specific force [m/s^2/sqrt(s)]."""

    rate_walk: Annotated[Number, Field(ge=0.0, le=0.01)] = 1.0e-5
    """Random walk of the bias of the body rates [rad/s/sqrt(s)]."""

    force_bias: Annotated[Number, Field(ge=0.0, le=5.0)] = 0.05
    """Standard deviation of that bias when the clip begins [m/s^2]."""

    rate_bias: Annotated[Number, Field(ge=0.0, le=1.0)] = 2.0e-3
    """Standard deviation of that bias when the clip begins [rad/s]."""


@dataclass(frozen=True, eq=False)
class ImuSamples:
    """Samples of a clip, in order of time.

    Attributes
    ----------
    time_s : float64 (samples,)
        Clip time.
    force_mps2 : float64 (samples, 3)
        Ideal specific force along nose, left, up: +9.81 upwards when hovering.
    rates_radps : float64 (samples, 3)
        Ideal angular velocity about nose, left, up.
    measured : float64 (samples, 6) or None
        Force and rates with noise.
    """

    time_s: Float64[np.ndarray, "samples"]
    force_mps2: Float64[np.ndarray, "samples 3"]
    rates_radps: Float64[np.ndarray, "samples 3"]
    measured: Float64[np.ndarray, "samples 6"] | None = None

    def between(self, start_s: float, end_s: float) -> Float64[np.ndarray, "rows columns"]:
        """Samples with ``start_s <= time < end_s`` as rows: time, force, rates, and what was measured if noisy."""
        first, last = np.searchsorted(self.time_s, [start_s, end_s])
        columns = [self.time_s[:, None], self.force_mps2, self.rates_radps]
        if self.measured is not None:
            columns.append(self.measured)
        return np.concatenate([column[first:last] for column in columns], axis=1)


def feel(
    motion: Motion, zero_s: float, span_s: tuple[float, float], knobs: ImuKnobs, rng: np.random.Generator
) -> ImuSamples:
    """Samples over a span of clip time.

    Parameters
    ----------
    motion : Motion
    zero_s : float
        Motion time of clip time zero.
    span_s : (float, float)
        Clip time from, to; the end is not included.
    knobs : ImuKnobs
    rng : numpy.random.Generator
        For the noise.
    """
    count = int(np.ceil(span_s[1] * RATE_HZ))
    time_s = np.arange(int(np.ceil(span_s[0] * RATE_HZ)), count) / RATE_HZ
    time_s = time_s[time_s < span_s[1]]
    t = time_s + zero_s
    attitude = motion.attitude(t)
    push = motion.position.at(t, 2) + np.array([0.0, 0.0, GRAVITY_MPS2])
    force = np.einsum("nij,ni->nj", attitude.world_from_body, push)
    ideal = np.concatenate([force, attitude.rates_radps], axis=1)
    return ImuSamples(time_s, force, attitude.rates_radps, _noisy(ideal, knobs, rng) if knobs.noise else None)


def _noisy(
    ideal: Float64[np.ndarray, "samples 6"], knobs: ImuKnobs, rng: np.random.Generator
) -> Float64[np.ndarray, "samples 6"]:
    white_rng, walk_rng, bias_rng = rng.spawn(3)
    white = np.repeat([knobs.force_noise, knobs.rate_noise], 3) * np.sqrt(RATE_HZ)
    step = np.repeat([knobs.force_walk, knobs.rate_walk], 3) / np.sqrt(RATE_HZ)
    bias = np.repeat([knobs.force_bias, knobs.rate_bias], 3) * bias_rng.normal(size=6)
    walk = np.cumsum(step * walk_rng.normal(size=ideal.shape), axis=0)
    return np.asarray(ideal + bias + walk + white * white_rng.normal(size=ideal.shape))
