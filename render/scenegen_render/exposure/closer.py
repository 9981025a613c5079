"""A closer look at what one flight shows: most rays for the few sites that fill most of its frames.

Sixty-four rays a site leave a tenth of a kelvin of error in a sunny afternoon, and a fifth of that would cost nine
times the rays. But a flight shows a few thousand of a city's hundreds of thousands of sites, and a few hundred of them
fill most of its pixels. The variance of a site with n rays falls as n^-3/2 (low-discrepancy points, sharp edges) and
counts with the weight w of the site in the pixels; for a given number of rays the mean is smallest at n ~ w^(2/5).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.exposure import CloserList, Exposure
from scenegen.heat.emitters import group_sites
from scenegen.materials.material import Build
from scenegen.world import World
from scenegen_render import backend
from scenegen_render.camera import Camera
from scenegen_render.exposure.hemisphere import gather_list
from scenegen_render.exposure.knobs import ExposureKnobs
from scenegen_render.exposure.rays import SiteRays
from scenegen_render.exposure.views import shares
from scenegen_render.scene import LoadedWorld

_LOOKS, _ACROSS = 33, 64
"""Frames looked through at most, and pixels looked through along the width of each."""
_TIERS = (128, 256, 512, 1024, 2048)
"""Numbers of rays a site can get; one set of directions each."""
_CALM = {Build.CANOPY_GROUND: 0.4, Build.LEAF: 0.4, Build.WATER: 0.0}
"""How much less than others the temperature of a surface answers to what it sees: leaves evaporate and give their heat
to the air, water keeps its own temperature. Measured in a July city at 14 h: 60 mK where others have 150 to 200."""
_PLASTIC = 1.32471795724474602596


def look_closer(
    loaded: LoadedWorld,
    exposure: Exposure,
    camera: Camera,
    world_from_camera: Float64[np.ndarray, "frames 4 4"],
    rng: np.random.Generator,
    knobs: ExposureKnobs | None = None,
) -> Exposure:
    """Look again, with more rays, from the sites that the frames of a flight show.

    Parameters
    ----------
    loaded : LoadedWorld
    exposure : Exposure
        Of the same world; stays as it is.
    camera : Camera
        What counts is its field of view, not how many pixels it has.
    world_from_camera : float64 (frames, 4, 4)
        Poses of the frames.
    rng : numpy.random.Generator
        Turns the direction sets.
    knobs : ExposureKnobs, optional

    Returns
    -------
    Exposure
        Sky view and neighbours of those sites replaced, their rays in `Exposure.closer`.
    """
    budget = (knobs or ExposureKnobs()).closer_rays * len(world_from_camera)
    world = loaded.world
    weight = _pixels_of_sites(loaded, camera, world_from_camera)
    sky, share = exposure.sky_view.copy(), exposure.neighbour_share.copy()
    group, groups = group_sites(world)
    tiers = _allotted(weight * _answer(world) ** 2, budget)
    lists = []
    for directions, rays in zip(tiers, SiteRays.of_some(world, *tiers.values()), strict=True):
        turn = rng.random(len(group), dtype=np.float32)
        gather = gather_list(loaded, rays, directions, turn)
        sky[rays.order], share[rays.order] = shares(gather, group, groups)
        lists.append(CloserList(rays.order, gather))
    return replace(exposure, sky_view=sky, neighbour_share=share, closer=tuple(lists))


def _pixels_of_sites(
    loaded: LoadedWorld, camera: Camera, world_from_camera: Float64[np.ndarray, "frames 4 4"]
) -> Float64[np.ndarray, "sites"]:
    """Weight of the error of each site in the frames: the squares of its shares in the pixels, summed."""
    mi, _ = backend.modules()
    every = -(-len(world_from_camera) // _LOOKS)
    origin, toward = _looks(camera, world_from_camera[::every])
    axes = (mi.Point3f(*map(backend.upload, origin.T)), mi.Vector3f(*map(backend.upload, toward.T)))
    hit = loaded.scene.ray_intersect_preliminary(mi.Ray3f(*axes), coherent=True)
    met = np.asarray(hit.is_valid())
    face, u, v = np.asarray(hit.prim_index)[met], *(np.asarray(x)[met] for x in hit.prim_uv)
    share = np.stack([1.0 - u - v, u, v], axis=1).astype(np.float64)
    corner = loaded.world.corner_site[face].astype(np.int64)
    return np.bincount(
        corner.ravel(), weights=(share**2).ravel(), minlength=len(loaded.world.sites.area)
    ).astype(np.float64)


def _looks(
    camera: Camera, world_from_camera: Float64[np.ndarray, "frames 4 4"]
) -> tuple[np.ndarray, np.ndarray]:
    """Origins and unit directions (rays, 3), float32: a coarse grid through each frame, shifted from frame to frame."""
    step = camera.width_px / _ACROSS
    down = max(1, round(camera.height_px / step))
    k = np.arange(len(world_from_camera))[:, None]
    shift = (k / np.array([_PLASTIC, _PLASTIC**2])) % 1.0  # Roberts' R2 sequence
    column, row = (grid.ravel() for grid in np.meshgrid(np.arange(_ACROSS), np.arange(down)))
    pixel = (np.stack([column, row], axis=1)[None] + shift[:, None]) * (step, camera.height_px / down)
    plane = (pixel - camera.centre_px) / camera.focal_px
    local = np.concatenate([plane, np.ones((*plane.shape[:2], 1))], axis=2)
    local /= np.linalg.norm(local, axis=2, keepdims=True)
    toward = np.einsum("fij,fpj->fpi", world_from_camera[:, :3, :3], local)
    origin = np.broadcast_to(world_from_camera[:, None, :3, 3], toward.shape)
    return origin.reshape(-1, 3).astype(np.float32), toward.reshape(-1, 3).astype(np.float32)


def _answer(world: World) -> Float64[np.ndarray, "sites"]:
    """How strongly the temperature of each site answers to an error in what it sees, relative to bare surfaces."""
    palette = np.array([_CALM.get(s.material.build, 1.0) for s in world.palette])
    return np.asarray(palette[world.sites.surface], np.float64)


def _allotted(weight: Float64[np.ndarray, "sites"], budget: int) -> dict[int, Int64[np.ndarray, "_"]]:
    """Sites of each number of rays, so that all together spend at most `budget` as ``weight ** 0.4`` asks."""
    seen = np.flatnonzero(weight)
    if not budget or not seen.size:
        return {}
    wish = weight[seen] ** 0.4
    log_low, log_high = 0.0, float(np.log(2.0 * _TIERS[-1] / wish.min()))
    for _ in range(40):
        middle = 0.5 * (log_low + log_high)
        spent = int(_rounded(wish * np.exp(middle)).sum())
        log_low, log_high = (middle, log_high) if spent <= budget else (log_low, middle)
    rays = _rounded(wish * np.exp(log_low))
    return {directions: seen[rays == directions] for directions in _TIERS if (rays == directions).any()}


def _rounded(wanted: Float64[np.ndarray, "sites"]) -> Int64[np.ndarray, "sites"]:
    """The next tier below, 0 below the first."""
    return np.asarray(np.array((0, *_TIERS))[np.searchsorted(_TIERS, wanted, side="right")], np.int64)
