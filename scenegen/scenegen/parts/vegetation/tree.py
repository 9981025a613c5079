"""A tree as a template: grown, brought to its height and reach, and given its thermal sites."""

from __future__ import annotations

import numpy as np
from jaxtyping import Int64

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M
from scenegen.geometry.template import Template
from scenegen.parts.vegetation import broadleaf, palm, whorled
from scenegen.parts.vegetation.cards import FACES
from scenegen.parts.vegetation.growth import Grown, Plan
from scenegen.parts.vegetation.habits import Broadleaf, Feather
from scenegen.parts.vegetation.lumps import (
    BARE,
    CROWN,
    DOWN,
    crown_sites,
    ring,
    supports,
    thrice,
    wood_sites,
)
from scenegen.parts.vegetation.mesh import Mesh, merged
from scenegen.parts.vegetation.species import Species

BARK, LEAVES, TWIGS = 0, 1, 2
"""Surface slots of a tree."""
_TRUNK_SIDES, SIDES = ring(3, 0.0), ring(4, 8.0)
_TRUNK_SITE_HEIGHT, _TRUNK_RING = 0.12, 5
_CROWN_BASE_QUANTILE = 0.08


def tree(species: Species, plan: Plan, rng: np.random.Generator) -> Template:
    """Model one tree of height 1, with no leaf or twig farther from its axis than the species' radius.

    Parameters
    ----------
    species : Species
    plan : Plan
        How many triangles, and how much foliage.
    rng : numpy.random.Generator
    """
    grown = _sized(_grow(species, plan, rng), species.growth.outline.radius * rng.uniform(0.9, 1.0))
    model = Modeller()
    if len(grown.leaves):
        _wood_in_leaf(model, grown)
        first = supports(model, grown.leaves.vertices, CROWN)
        together = FACES if isinstance(species.growth, Broadleaf) else 1
        site = first + crown_sites(grown.leaves, CROWN, rng, together)
        _add(model, grown.leaves, LEAVES, site)
    else:
        _add(model, grown.trunk, BARK, _trunk_sites(model, grown.trunk))
        first = supports(model, grown.limbs.vertices, BARE)
        _add(model, grown.limbs, BARK, first + wood_sites(grown.limbs, BARE))
        first = supports(model, grown.twigs.vertices, SIDES)
        _add(model, grown.twigs, TWIGS, first + wood_sites(grown.twigs, SIDES))
    return model.finish()


def _grow(species: Species, plan: Plan, rng: np.random.Generator) -> Grown:
    growth = species.growth
    if isinstance(growth, Broadleaf):
        return broadleaf.grow(growth, plan, rng)
    if isinstance(growth, Feather):
        return palm.grow(growth, plan, rng)
    return whorled.grow(growth, plan, rng)


def _sized(grown: Grown, radius: float) -> Grown:
    """Stretched so that it ends at height 1 and reaches just so far; its foot stays where it is."""
    everything = np.concatenate([m.vertices for m in (grown.trunk, grown.limbs, grown.twigs, grown.leaves)])
    top = everything[:, 2].max()
    wide = radius / np.hypot(everything[:, 0], everything[:, 1]).max()

    def stretched(mesh: Mesh) -> Mesh:
        vertices = mesh.vertices * np.array([wide, wide, 1.0])
        vertices[:, 2] = np.where(vertices[:, 2] > 0.0, vertices[:, 2] / top, vertices[:, 2])
        return Mesh(vertices, mesh.faces)

    return Grown(*(stretched(m) for m in (grown.trunk, grown.limbs, grown.twigs, grown.leaves)))


def _trunk_sites(model: Modeller, trunk: Mesh) -> Int64[np.ndarray, "faces"]:
    """Add sites around the trunk below its crown; returns the one of each face."""
    vertices = trunk.vertices
    near = np.argsort(np.abs(vertices[:, 2] - _TRUNK_SITE_HEIGHT), kind="stable")[:_TRUNK_RING]
    return supports(model, vertices[near], _TRUNK_SIDES) + wood_sites(trunk, _TRUNK_SIDES)


def _wood_in_leaf(model: Modeller, grown: Grown) -> None:
    """The free trunk has sides; wood in the crown has one site: what is in the shade sees leaves, and ground below."""
    crown_base = np.quantile(grown.leaves.vertices[:, 2], _CROWN_BASE_QUANTILE)
    sides = _trunk_sites(model, grown.trunk)
    wood = grown.limbs.vertices
    middle = wood[np.argmin(((wood - wood.mean(axis=0)) ** 2).sum(axis=1))]
    shaded = model.site(middle, DOWN[0], LUMP_STANDOFF_M)
    high = grown.trunk.corners()[..., 2].mean(axis=1) > crown_base
    _add(model, grown.trunk, BARK, np.where(high, shaded, sides))
    boughs = merged([grown.limbs, grown.twigs])
    _add(model, boughs, BARK, np.full(len(boughs), shaded))


def _add(model: Modeller, mesh: Mesh, slot: int, site: Int64[np.ndarray, "faces"]) -> None:
    model.mesh(mesh.vertices, mesh.faces, slot, Semantic.TREE, thrice(site))
