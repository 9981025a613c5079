"""Shrubs: several stems from the ground under a dome of leaf sprays; half of the kinds keep their leaves in winter."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import Part
from scenegen.geometry.template import Template, place
from scenegen.parts.vegetation.branches import GOLDEN_RAD, Branches, sprout, unit
from scenegen.parts.vegetation.cards import FACES, sprays
from scenegen.parts.vegetation.foliage import leaf_fraction
from scenegen.parts.vegetation.lumps import DOWN, UP, crown_sites, ring, supports, thrice, wood_sites
from scenegen.parts.vegetation.mesh import Mesh, merged
from scenegen.parts.vegetation.tubes import tubes
from scenegen.parts.workshop import Workshop

BARK, LEAVES = 0, 1
"""Surface slots of a shrub."""
_FORMS = 4
_SPRAYS, _STEMS, _SHOOTS = 84, 7, 4
_FOOT, _LOWEST = -0.06, 0.08
_BARE = 0.04
_SITES = np.concatenate([UP, ring(4, 12.0), DOWN])
_WOOD_SITES = np.concatenate([UP, ring(2, 0.0)])


def shrubs(
    position: Float64[np.ndarray, "n 3"],
    size_m: Float64[np.ndarray, "n 3"],
    heading_rad: Float64[np.ndarray, "n"],
    shop: Workshop,
    rng: np.random.Generator,
) -> list[Part]:
    """Free-standing shrubs, each with its own instance id, about 190 triangles.

    Parameters
    ----------
    position : float64 (n, 3)
        Where they stand on the ground [m].
    size_m : float64 (n, 3)
        Length, width and height; no leaf lies outside this box.
    heading_rad : float64 (n,)
    shop : Workshop
        Its season strips the deciduous kinds.
    rng : numpy.random.Generator
    """
    count = len(position)
    owner = shop.builder.new_objects(count) + np.arange(count)
    skins = np.column_stack(
        [
            np.asarray(shop.palette.variants(name), np.int64)[rng.integers(0, len(shop.palette.variants(name)), count)]
            for name in ("twigs_bare", "tree_crown")
        ]
    )  # fmt: skip
    form = rng.integers(0, _FORMS, count)
    deciduous = leaf_fraction(shop.season)
    parts = []
    for k, child in enumerate(rng.spawn(_FORMS)):
        mine = np.flatnonzero(form == k)
        if len(mine):
            template = shrub(1.0 if k % 2 == 0 else deciduous, child)
            parts.append(
                place(template, position[mine], heading_rad[mine], size_m[mine], skins[mine], owner[mine])
            )
    return parts


def shrub(in_leaf: float, rng: np.random.Generator) -> Template:
    """A shrub in the box -0.5..0.5, -0.5..0.5, 0..1, rooted a little below.

    Parameters
    ----------
    in_leaf : float
        Share of its foliage, 0..1.
    rng : numpy.random.Generator
    """
    stems = _stems(rng)
    model = Modeller()
    if in_leaf < _BARE:
        wood = _boxed(merged([tubes(b, 3, True) for b in (stems, _shoots(stems, rng))]), True)
        first = supports(model, wood.vertices, _WOOD_SITES)
        _add(model, wood, BARK, first + wood_sites(wood, _WOOD_SITES))
    else:
        wood, leaves = _boxed(tubes(stems, 3, True), False), _leaves(in_leaf, rng)
        first = supports(model, wood.vertices.mean(axis=0)[None], UP)
        _add(model, wood, BARK, np.full(len(wood), first))
        first = supports(model, leaves.vertices, _SITES)
        _add(model, leaves, LEAVES, first + crown_sites(leaves, _SITES, rng, FACES))
    return model.finish()


def _add(model: Modeller, mesh: Mesh, slot: int, site: Int64[np.ndarray, "faces"]) -> None:
    model.mesh(mesh.vertices, mesh.faces, slot, Semantic.SHRUB, thrice(site))


def _boxed(wood: Mesh, fills: bool) -> Mesh:
    """Wood inside the box, reaching its top if it has to fill it; what is in the ground stays there."""
    vertices = wood.vertices.copy()
    above, top = vertices[:, 2] > 0.0, vertices[:, 2].max()
    vertices[above, 2] /= top if fills else max(top / 0.9, 1.0)
    reach = np.abs(vertices[:, :2]).max()
    vertices[:, :2] *= min(1.0, 0.5 / reach)
    return Mesh(vertices, wood.faces)


def _stems(rng: np.random.Generator) -> Branches:
    k = np.arange(_STEMS)
    spread = np.sqrt((k + 0.5) / _STEMS)
    turn = GOLDEN_RAD * k + rng.uniform(0, 2 * np.pi)
    out = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(_STEMS)])
    start = 0.12 * spread[:, None] * out + np.array([0.0, 0.0, _FOOT])
    direction = 0.62 * spread[:, None] * out + np.array([0.0, 0.0, 1.0])
    length = (0.95 - 0.25 * spread) * rng.uniform(0.75, 1.0, _STEMS)
    thick = np.full(_STEMS, 0.016)
    return sprout(start, unit(direction), length, (thick, 0.3 * thick), 3, 0.1, 0.12, rng)


def _shoots(stems: Branches, rng: np.random.Generator) -> Branches:
    parent = np.repeat(np.arange(_STEMS), _SHOOTS)
    start, along, thick = stems.at(parent, rng.uniform(0.3, 0.9, len(parent)))
    direction = unit(along + 0.8 * rng.normal(size=along.shape) + np.array([0.0, 0.0, 0.4]))
    length = rng.uniform(0.2, 0.4, len(parent))
    return sprout(start, direction, length, (0.7 * thick, 0.2 * thick), 2, 0.0, 0.0, rng)


def _leaves(in_leaf: float, rng: np.random.Generator) -> Mesh:
    """Sprays on a lumpy dome and inside it."""
    count = max(12, round(in_leaf * _SPRAYS))
    rank = (np.arange(count) + rng.uniform(size=count)) / count
    rise, turn = np.arcsin(rank**0.8), GOLDEN_RAD * np.arange(count)
    shell = np.column_stack([np.cos(turn) * np.cos(rise), np.sin(turn) * np.cos(rise), np.sin(rise)])
    lump = 0.86 + 0.14 * np.sin(3.0 * turn + rng.uniform(0, 6.3)) * np.cos(4.0 * rise + rng.uniform(0, 6.3))
    deep = np.where(rng.uniform(size=count) < 0.25, 0.55, 1.0) * rng.uniform(0.8, 1.05, count)
    base = shell * (lump * deep)[:, None] * np.array([0.40, 0.40, 0.72]) + np.array([0.0, 0.0, 0.14])
    spin = unit(rng.normal(size=(count, 3)))
    length = rng.uniform(0.22, 0.40, count)
    facing = shell + 0.7 * unit(rng.normal(size=(count, 3)))
    heading = unit(0.9 * spin + 0.5 * shell + np.array([0.0, 0.0, 0.35]))
    made = sprays(base - 0.25 * length[:, None] * heading, heading, facing, length, 1.3)
    vertices = made.vertices.copy()
    vertices[:, :2] *= 0.5 / np.abs(vertices[:, :2]).max()
    low, high = vertices[:, 2].min(), vertices[:, 2].max()
    vertices[:, 2] = _LOWEST + (1.0 - _LOWEST) * (vertices[:, 2] - low) / (high - low)
    return Mesh(vertices, made.faces)
