"""One thermal state on the device: what every face emits and reflects, and the air around it."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float32

from scenegen.foundation.errors import InputError
from scenegen.materials.material import Surface
from scenegen.radiometry.band import mirror_index
from scenegen.thermal_state import ThermalState
from scenegen_render import backend
from scenegen_render.scene import LoadedWorld
from scenegen_render.trace.air import Air, device_air


@dataclass(frozen=True, eq=False)
class Lit:
    """A loaded world at one moment, ready to be photographed from anywhere.

    Attributes
    ----------
    loaded : LoadedWorld
    face : mitsuba.Float, 8 per face
        Temperatures [K] of the three corners, ``surface | semantic << 16``; irradiances [W m^-2] of the three
        corners, packed normal. One 32-byte row holds all a hit needs.
    surface : mitsuba.Float, 4 per palette entry
        Emissivity, texture amplitude [K], 1 / texture scale [1/m], 1 where mirror-like.
    mirror : mitsuba.Float, 4 per palette entry
        Refractive index n and k (0 for bare metals), constant reflectance, unused.
    material : mitsuba.UInt, 1 per palette entry
        Material ids.
    air : Air
    texture_seed : mitsuba.UInt
        Belongs to the world: the texture stays when weather and hour change.
    """

    loaded: LoadedWorld
    face: Any
    surface: Any
    mirror: Any
    material: Any
    air: Air
    texture_seed: Any


def light(
    loaded: LoadedWorld,
    state: ThermalState,
    irradiance: Float32[np.ndarray, "sites"],
    band_um: tuple[float, float],
) -> Lit:
    """Put temperatures, diffuse irradiance and air on the device.

    Parameters
    ----------
    irradiance : float32 (sites,)
        Diffuse in-band irradiance of each site [W m^-2].

    Raises
    ------
    InputError
        If a site's temperature or irradiance is missing, non-finite or not positive.
    """
    mi, dr = backend.modules()
    world = loaded.world
    for name, values in (("temperature", state.temperature_K), ("irradiance", irradiance)):
        if len(values) != len(world.sites.area):
            raise InputError(
                f"{name} has {len(values)} values for the {len(world.sites.area)} sites of the world"
            )
        if not (np.isfinite(values).all() and (values >= 0).all()):
            raise InputError(f"{name} of the world's sites must be finite and not negative")
    air_seed = zlib.crc32(repr((world.map, state.season, state.hour, state.weather)).encode())
    return Lit(
        loaded=loaded,
        face=_face_table(loaded, backend.upload(state.temperature_K), backend.upload(irradiance)),
        surface=backend.upload(_surface_table(world.palette, state.texture_K)),
        mirror=backend.upload(_mirror_table(world.palette, band_um)),
        material=backend.upload(np.array([s.material.id for s in world.palette], np.uint32)),
        air=device_air(state.atmosphere, band_um, air_seed),
        texture_seed=dr.opaque(mi.UInt, loaded.texture_seed),
    )


def _face_table(loaded: LoadedWorld, temperature_K: Any, irradiance: Any) -> Any:
    mi, dr = backend.modules()
    count = dr.width(loaded.face_object)
    face = dr.arange(mi.UInt, count)
    a, b, c, what = dr.gather(mi.Vector4u, loaded.face_record, face)
    warm = [dr.gather(mi.Float, temperature_K, site) for site in (a, b, c)]
    lit = [dr.gather(mi.Float, irradiance, site) for site in (a, b, c)]
    table = dr.empty(mi.Float, count * 8)
    dr.scatter(table, mi.Vector4f(*warm, dr.reinterpret_array(mi.Float, what)), face * 2)
    packed = dr.gather(mi.UInt, loaded.face_normal, face)
    dr.scatter(table, mi.Vector4f(*lit, dr.reinterpret_array(mi.Float, packed)), face * 2 + 1)
    dr.eval(table)
    return table


def _surface_table(
    palette: tuple[Surface, ...], texture_K: Float32[np.ndarray, "palette"]
) -> np.ndarray[Any, np.dtype[np.float32]]:
    rows = [
        (s.emissivity, amplitude, 1.0 / s.material.texture_scale_m, float(_mirrors(s)))
        for s, amplitude in zip(palette, texture_K, strict=True)
    ]
    return np.array(rows, np.float32).reshape(-1)


def _mirror_table(
    palette: tuple[Surface, ...], band_um: tuple[float, float]
) -> np.ndarray[Any, np.dtype[np.float32]]:
    rows = []
    for s in palette:
        index = mirror_index(s.material, band_um)
        n, k = (index.n, index.k) if index else (0.0, 0.0)
        rows.append((n, k, s.material.mirror_reflectance or 0.0, 0.0))
    return np.array(rows, np.float32).reshape(-1)


def _mirrors(surface: Surface) -> bool:
    return surface.material.mirror is not None or surface.material.mirror_reflectance is not None
