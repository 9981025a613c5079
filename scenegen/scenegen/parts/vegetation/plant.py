"""Plant trees: a few templates per species and size, drawn anew for every world, baked as copies."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.foundation.errors import InputError, nearest
from scenegen.geometry.part import Part
from scenegen.geometry.template import place
from scenegen.parts.vegetation.foliage import leaf_fraction
from scenegen.parts.vegetation.growth import Plan
from scenegen.parts.vegetation.hedges import hedges
from scenegen.parts.vegetation.shrubs import shrubs
from scenegen.parts.vegetation.species import SPECIES, Species
from scenegen.parts.vegetation.tree import tree
from scenegen.parts.workshop import Workshop

__all__ = ["SPECIES", "crown_radius_m", "hedges", "plant", "shrubs", "triangles"]

_CLASS_TOP_M = (6.0, 9.5, 14.0)
"""Upper ends of the size classes but the last: a spray of leaves has one size, so tall trees have more of them."""
_FACES = (640, 1000, 1700, 3000)
"""Triangles of a tree of each size class."""
_AVERAGE_CROWN = 0.25
"""Radius times length of an average crown, for a tree of unit height."""
_SKINS = ("bark_trunk", "tree_crown", "twigs_bare")
_COPIES_PER_FORM = (1, 15, 60)
"""From how many trees of one species and size there is a first, second and third form."""
_WIDTH = (0.86, 1.0)
_BARE, _FULL = 0.03, 0.97
_UNEVEN = 0.18
"""Spread of the foliage among trees of one species while leaves unfold or fall."""


def crown_radius_m(species: str, height_m: float | Float64[np.ndarray, "n"]) -> Float64[np.ndarray, "*n"]:
    """How far any leaf or branch is from the tree's axis at most [m]; nothing of it stands outside.

    Parameters
    ----------
    species : str
        One of `SPECIES`.
    height_m : float or float64 (n,)
    """
    return np.asarray(_species(species).growth.outline.radius * np.asarray(height_m, np.float64))


def triangles(height_m: Float64[np.ndarray, "n"]) -> int:
    """About how many triangles trees of these heights [m] take at full detail; divide a budget by it for `detail`."""
    return int(np.asarray(_FACES)[np.searchsorted(_CLASS_TOP_M, height_m)].sum())


def plant(
    species: str,
    position: Float64[np.ndarray, "n 3"],
    height_m: Float64[np.ndarray, "n"],
    shop: Workshop,
    rng: np.random.Generator,
    detail: float = 1.0,
) -> list[Part]:
    """Trees of one species; call it once per species, since every call draws its own forms.

    Parameters
    ----------
    species : str
        One of `SPECIES`.
    position : float64 (n, 3)
        Where trunks meet the ground [m]; they reach 3 % of the height below it.
    height_m : float64 (n,)
        Exact heights.
    shop : Workshop
        Its season decides how much foliage deciduous trees carry.
    rng : numpy.random.Generator
    detail : float
        Scales the number of triangles: 640, 1,000, 1,700 and 3,000 for trees up to 6, 9.5, 14 m
        and above.

    Returns
    -------
    list of Part
        One per form; each tree has its own instance id.

    Raises
    ------
    InputError
        If there is no such species.
    """
    kind = _species(species)
    count = len(position)
    owner = shop.builder.new_objects(count) + np.arange(count)
    skins = np.column_stack([_drawn(name, count, shop, rng) for name in _SKINS])
    heading = rng.uniform(0.0, 2 * np.pi, count)
    wide = rng.uniform(*_WIDTH, count)
    scale = height_m[:, None] * np.column_stack([wide, wide, np.ones(count)])
    in_leaf = 1.0 if kind.evergreen else leaf_fraction(shop.season, kind.shift_d)
    size = np.searchsorted(_CLASS_TOP_M, height_m)
    parts = []
    for k, child in enumerate(rng.spawn(len(_FACES))):
        mine = np.flatnonzero(size == k)
        forms = int(np.searchsorted(_COPIES_PER_FORM, len(mine), side="right"))
        for form, grower in enumerate(child.spawn(forms)):
            some = mine[form::forms]
            template = tree(
                kind, Plan(round(detail * _share(kind) * _FACES[k]), _foliage(in_leaf, grower)), grower
            )
            parts.append(
                place(template, position[some], heading[some], scale[some], skins[some], owner[some])
            )
    return parts


def _species(name: str) -> Species:
    try:
        return SPECIES[name]
    except KeyError:
        raise InputError(f"unknown species '{name}'{nearest(name, SPECIES)}") from None


def _share(kind: Species) -> float:
    """Triangles against an average tree: a wide crown needs more."""
    outline = kind.growth.outline
    return float(np.sqrt(outline.radius * (1.0 - outline.base) / _AVERAGE_CROWN))


def _drawn(material: str, count: int, shop: Workshop, rng: np.random.Generator) -> Int64[np.ndarray, "count"]:
    """A variant of a material for each of so many plants."""
    options = np.asarray(shop.palette.variants(material), np.int64)
    return options[rng.integers(0, len(options), count)]


def _foliage(in_leaf: float, rng: np.random.Generator) -> float:
    """Foliage of one form; nearly none is none, nearly all is all."""
    own = in_leaf + rng.uniform(-_UNEVEN, _UNEVEN) * (0.0 < in_leaf < 1.0)
    return 0.0 if own < _BARE else 1.0 if own > _FULL else float(own)
