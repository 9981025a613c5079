"""Planck's law, the path and the sky inside a kernel; coefficients come from `scenegen.radiometry`."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from statistics import NormalDist
from typing import Any

import numpy as np

from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.radiometry.path import path_terms
from scenegen.radiometry.planck import PlanckFit
from scenegen.radiometry.sky import sky_radiance
from scenegen_render import backend
from scenegen_render.trace import noise

_SKY_NODES = 2048
_CLOUD_RAMP = 1.2
"""Width of a cloud's edge, in standard deviations of the noise that shapes it."""
_CLOUD_OCTAVES = ((1.0, 1.0), (2.3, 0.55), (5.3, 0.3))
"""Frequency and amplitude."""
_CLOUD_SPACING = 0.6
"""Lattice spacing of the largest octave, in heights of the cloud base."""


@dataclass(frozen=True, eq=False)
class Air:
    """Air and sky of one moment as opaque kernel arguments.

    Attributes
    ----------
    planck : tuple of mitsuba.Float
        ``ln B`` in powers of ``300/T - 1``, constant first.
    weight, attenuation_per_m : tuple of mitsuba.Float
        Of the path's three exponentials.
    air_radiance, below_radiance : mitsuba.Float
        B(T_air); what directions below the horizon show where there is no ground.
    sky : mitsuba.Float, 4 per node
        Clear and overcast radiance over sqrt(sin(elevation)), then their steps to the next node.
    cloud_fraction, cloud_threshold : mitsuba.Float
    patchy : mitsuba.Bool
    seed : mitsuba.UInt
    """

    planck: tuple[Any, ...]
    weight: tuple[Any, ...]
    attenuation_per_m: tuple[Any, ...]
    air_radiance: Any
    below_radiance: Any
    sky: Any
    cloud_fraction: Any
    cloud_threshold: Any
    patchy: Any
    seed: Any

    def blackbody(self, temperature_K: Any) -> Any:
        """B(T) [W m^-2 sr^-1]."""
        _, dr = backend.modules()
        y = 300.0 / temperature_K - 1.0
        total = self.planck[-1]
        for c in reversed(self.planck[:-1]):
            total = dr.fma(total, y, c)
        return dr.exp(total)

    def transmission(self, range_m: Any) -> Any:
        """Share of radiance that survives a path of that length."""
        _, dr = backend.modules()
        return sum(w * dr.exp(-k * range_m) for w, k in zip(self.weight, self.attenuation_per_m, strict=True))

    def through(self, radiance: Any, range_m: Any) -> Any:
        """Radiance after a path of that length."""
        _, dr = backend.modules()
        return dr.fma(self.transmission(range_m), radiance - self.air_radiance, self.air_radiance)

    def sky_towards(self, direction: Any) -> Any:
        """Radiance of the sky in unit directions (ENU); all the air between here and space is part of it."""
        mi, dr = backend.modules()
        x = dr.sqrt(dr.maximum(direction.z, 0.0)) * (_SKY_NODES - 1)
        node = dr.minimum(mi.UInt(x), _SKY_NODES - 2)
        clear, overcast, clear_step, overcast_step = dr.gather(mi.Vector4f, self.sky, node)
        step = x - mi.Float(node)
        clear, overcast = dr.fma(step, clear_step, clear), dr.fma(step, overcast_step, overcast)
        cover = dr.if_stmt(
            args=(direction,),
            cond=self.patchy & (direction.z > 0.0),
            true_fn=self._cover,
            false_fn=lambda d: mi.Float(self.cloud_fraction),
            label="clouds",
        )
        radiance = dr.fma(cover, overcast - clear, clear)
        return dr.select(direction.z < 0.0, self.below_radiance, radiance)

    def _cover(self, direction: Any) -> Any:
        """Cloud cover 0..1 in a direction; a mean of `cloud_fraction`, to which it fades near the horizon."""
        mi, dr = backend.modules()
        stretch = 1.0 / ((direction.z + 0.05) * _CLOUD_SPACING)
        place = mi.Vector3f(direction.x * stretch, direction.y * stretch, 0.5)
        shape = sum(
            a * noise.value_noise(noise.tilted(place * f), self.seed + k)
            for k, (f, a) in enumerate(_CLOUD_OCTAVES)
        )
        norm = noise.UNIT / math.sqrt(sum(a * a for _, a in _CLOUD_OCTAVES))
        cover = dr.clip((shape * norm - self.cloud_threshold) / _CLOUD_RAMP + 0.5, 0.0, 1.0)
        return dr.lerp(self.cloud_fraction, cover, dr.clip((direction.z - 0.03) / 0.12, 0.0, 1.0))


def device_air(atmosphere: Atmosphere, band_um: tuple[float, float], seed: int) -> Air:
    """Put the atmosphere of a thermal state on the device for one band."""
    mi, dr = backend.modules()
    path = path_terms(atmosphere, band_um)
    fraction = float(atmosphere.cloud_fraction)
    patchy = 0.0 < fraction < 1.0 and not math.isfinite(atmosphere.uniform_sky_K)
    spread = math.sqrt(1.0 + _CLOUD_RAMP**2 / 12)
    threshold = spread * NormalDist().inv_cdf(1.0 - fraction) if patchy else 0.0
    return Air(
        planck=opaque(PlanckFit.of(band_um).radiance_coefficients),
        weight=opaque(path.weight),
        attenuation_per_m=opaque(path.attenuation_per_m),
        air_radiance=dr.opaque(mi.Float, path.air_radiance),
        below_radiance=dr.opaque(mi.Float, float(sky_radiance(np.array(-1.0), atmosphere, band_um))),
        sky=backend.upload(_sky_table(atmosphere, band_um)),
        cloud_fraction=dr.opaque(mi.Float, fraction),
        cloud_threshold=dr.opaque(mi.Float, threshold),
        patchy=dr.opaque(mi.Bool, patchy),
        seed=dr.opaque(mi.UInt, seed & 0xFFFFFFFF),
    )


def opaque(values: tuple[float, ...]) -> tuple[Any, ...]:
    """Numbers as kernel arguments instead of constants compiled into it."""
    mi, dr = backend.modules()
    return tuple(dr.opaque(mi.Float, float(v)) for v in values)


def _sky_table(atmosphere: Atmosphere, band_um: tuple[float, float]) -> np.ndarray[Any, np.dtype[np.float32]]:
    sin_elevation = np.linspace(0.0, 1.0, _SKY_NODES) ** 2
    columns = [
        sky_radiance(sin_elevation, replace(atmosphere, cloud_fraction=n), band_um) for n in (0.0, 1.0)
    ]
    steps = [np.append(np.diff(c), 0.0) for c in columns]
    return np.stack(columns + steps, axis=-1).astype(np.float32).reshape(-1)
