"""Boats as parts: drawn sizes and skins, one instance id each, warm where an engine runs."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.geometry.part import Part
from scenegen.geometry.template import place
from scenegen.parts.boats.boat import boat, size_m
from scenegen.parts.boats.slots import DECK, ENGINE, EXHAUST, GLASS, HULL, METAL, SAIL, SLOTS
from scenegen.parts.workshop import Workshop

__all__ = ["moor", "size_m"]

COVER_K = (310.0, 335.0)
"""Air under the cover of a running engine [K]."""
EXHAUST_K = (340.0, 430.0)


def moor(
    kind: str,
    position: Float64[np.ndarray, "boats 3"],
    heading_rad: Float64[np.ndarray, "boats"],
    shop: Workshop,
    rng: np.random.Generator,
    running: bool = False,
) -> list[Part]:
    """Boats of one kind.

    Parameters
    ----------
    kind : str
        "rowing", "sailing", "motor" or "fishing".
    position : float64 (boats, 3)
        Surface of the water under the middle [m].
    heading_rad : float64 (boats,)
        Where the bow points, counter-clockwise from east.
    shop : Workshop
    rng : numpy.random.Generator
    running : bool
        Engine cover and exhaust are warm; a sailing boat has its sails set.
    """
    size_m(kind)
    count = len(position)
    if not count:
        return []
    owner = shop.builder.new_objects(count) + np.arange(count)
    scale = np.repeat(rng.uniform(0.88, 1.1, count)[:, None], 3, axis=1)
    rows = skins(kind, count, running, shop, rng)
    return [place(boat(kind, running), position, heading_rad, scale, rows, owner)]


def skins(
    kind: str, count: int, running: bool, shop: Workshop, rng: np.random.Generator
) -> Int64[np.ndarray, "boats slots"]:
    """Palette indices for the slots of boats, one row each; warmth is drawn once per world."""
    palette = shop.palette
    cover_K, exhaust_K = float(rng.uniform(*COVER_K)), float(rng.uniform(*EXHAUST_K))

    def drawn(name: str, variants: int) -> Int64[np.ndarray, "boats"]:
        return np.array(palette.variants(name, variants), np.int64)[rng.integers(variants, size=count)]

    rows = np.empty((count, SLOTS), np.int64)
    rows[:, HULL] = drawn("timber_weathered", 2) if kind == "rowing" else drawn("gelcoat_white", 3)
    rows[:, DECK], rows[:, METAL] = drawn("timber_weathered", 2), drawn("steel_painted", 2)
    rows[:, SAIL] = drawn("netting_polymer" if kind == "fishing" else "sailcloth", 2)
    rows[:, GLASS] = palette.only("vehicle_glass")
    if running:
        rows[:, ENGINE] = palette.special("gelcoat_white", "engine cover", interior_K=cover_K)
        rows[:, EXHAUST] = palette.special("steel_oxidised", "boat exhaust", interior_K=exhaust_K)
    else:
        rows[:, ENGINE] = rows[:, HULL] if kind != "rowing" else rows[:, DECK]
        rows[:, EXHAUST] = palette.variants("steel_oxidised", 1)[0]
    return rows
