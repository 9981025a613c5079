"""One thermal state on the device: what every face emits and reflects, and the air around it."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float32

from scenegen.foundation.errors import InputError
from scenegen.materials.material import Build, Surface
from scenegen.movers.company import Company
from scenegen.radiometry.band import mirror_index
from scenegen.thermal_state import ThermalState
from scenegen_render import backend
from scenegen_render.scene import LoadedWorld
from scenegen_render.trace import open_air
from scenegen_render.trace.air import Air, device_air
from scenegen_render.trace.ripples import slope_per_axis
from scenegen_render.trace.scenery import Scenery, scenery
from scenegen_render.trace.troupe import face_object, face_record


@dataclass(frozen=True, eq=False)
class Lit(Scenery):
    """A loaded world at one moment, ready to be photographed from anywhere.

    Attributes
    ----------
    face : mitsuba.Float, 8 per face
        Temperatures [K] of the three corners, ``surface | semantic << 16``; irradiances [W m^-2] of the three
        corners, packed normal (none for movers). One 32-byte row holds all a hit needs.
    object : mitsuba.UInt, 1 per face
        Instance ids.
    surface : mitsuba.Float, 4 per palette entry
        Emissivity, texture amplitude [K], 1 / texture scale [1/m], 1 where mirror-like.
    mirror : mitsuba.Float, 4 per palette entry
        Refractive index n and k (0 for bare metals), constant reflectance, slope of the ripples (0 but for water).
    material : mitsuba.UInt, 1 per palette entry
        Material ids.
    air : Air
    texture_seed : mitsuba.UInt
        Belongs to the world: the texture stays when weather and hour change.
    """

    face: Any
    object: Any
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
    cast: Sequence[int] = (),
) -> Lit:
    """Put temperatures, diffuse irradiance and air on the device.

    Parameters
    ----------
    loaded : LoadedWorld
    state : ThermalState
    irradiance : float32 (sites,)
        Diffuse in-band irradiance of each site [W m^-2].
    band_um : (float, float)
    cast : sequence of int
        Movers that appear, see `scenegen_render.trace.casting`; their irradiance is the open sky's.

    Raises
    ------
    InputError
        If a site's temperature or irradiance is missing, non-finite or not positive.
    """
    mi, dr = backend.modules()
    world = loaded.world
    _check("temperature", state.temperature_K, len(world.sites.area), "sites")
    _check("irradiance", irradiance, len(world.sites.area), "sites")
    counts = [len(m.body.site_position) for m in world.movers]
    _check("temperature", state.moving_K, sum(counts), "sites of the movers")
    shape = scenery(loaded, cast)
    company = shape.troupe.company
    parts = np.split(state.moving_K, np.cumsum(counts)[:-1])
    warm = np.concatenate([state.temperature_K, *(parts[k] for k in cast)])
    shone = np.concatenate([irradiance, open_air.irradiance(company, world, state, irradiance, band_um)])
    air_seed = zlib.crc32(repr((world.map, state.season, state.hour, state.weather)).encode())
    face, objects = _face_tables(loaded, company, backend.upload(warm), backend.upload(shone))
    return Lit(
        loaded=loaded,
        troupe=shape.troupe,
        first_moving=shape.first_moving,
        face=face,
        object=objects,
        surface=backend.upload(_surface_table(world.palette, state.texture_K)),
        mirror=backend.upload(_mirror_table(world.palette, band_um, slope_per_axis(state.weather.wind_mps))),
        material=backend.upload(np.array([s.material.id for s in world.palette], np.uint32)),
        air=device_air(state.atmosphere, band_um, air_seed),
        texture_seed=dr.opaque(mi.UInt, loaded.texture_seed),
    )


def _check(name: str, values: Float32[np.ndarray, "values"], count: int, what: str) -> None:
    if len(values) != count:
        raise InputError(f"{name} has {len(values)} values for the {count} {what} of the world")
    if not (np.isfinite(values).all() and (values >= 0).all()):
        raise InputError(f"{name} of the world's {what} must be finite and not negative")


def _face_tables(
    loaded: LoadedWorld, company: Company, temperature_K: Any, irradiance: Any
) -> tuple[Any, Any]:
    """`Lit.face` and `Lit.object`: the rows of the world, then those of the movers."""
    mi, dr = backend.modules()
    own = face_record(company, len(loaded.world.sites.area))
    first = dr.width(loaded.face_object)
    table, objects = dr.empty(mi.Float, (first + len(own)) * 8), dr.empty(mi.UInt, first + len(own))
    moving = backend.upload(own), dr.opaque(mi.UInt, 0, len(own)), backend.upload(face_object(company))
    standing = loaded.face_record, loaded.face_normal, loaded.face_object
    for (record, packed, owner), start in ((standing, 0), (moving, first)):
        row = dr.arange(mi.UInt, dr.width(owner))
        a, b, c, what = dr.gather(mi.Vector4u, record, row)
        warm = [dr.gather(mi.Float, temperature_K, site) for site in (a, b, c)]
        lit = [dr.gather(mi.Float, irradiance, site) for site in (a, b, c)]
        place = row + dr.opaque(mi.UInt, start)  # opaque: every world has another number of faces
        dr.scatter(table, mi.Vector4f(*warm, dr.reinterpret_array(mi.Float, what)), place * 2)
        dr.scatter(table, mi.Vector4f(*lit, dr.reinterpret_array(mi.Float, packed)), place * 2 + 1)
        dr.scatter(objects, owner, place)
        dr.eval(table, objects)
    return table, objects


def _surface_table(
    palette: tuple[Surface, ...], texture_K: Float32[np.ndarray, "palette"]
) -> np.ndarray[Any, np.dtype[np.float32]]:
    rows = [
        (s.emissivity, amplitude, 1.0 / s.material.texture_scale_m, float(_mirrors(s)))
        for s, amplitude in zip(palette, texture_K, strict=True)
    ]
    return np.array(rows, np.float32).reshape(-1)


def _mirror_table(
    palette: tuple[Surface, ...], band_um: tuple[float, float], sea_slope: float
) -> np.ndarray[Any, np.dtype[np.float32]]:
    rows = []
    for s in palette:
        index = mirror_index(s.material, band_um)
        n, k = (index.n, index.k) if index else (0.0, 0.0)
        slope = sea_slope if s.material.build is Build.WATER else 0.0
        rows.append((n, k, s.material.mirror_reflectance or 0.0, slope))
    return np.array(rows, np.float32).reshape(-1)


def _mirrors(surface: Surface) -> bool:
    return surface.material.mirror is not None or surface.material.mirror_reflectance is not None
