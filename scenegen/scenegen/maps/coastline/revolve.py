"""Solids of revolution for templates: towers, domes, galleries."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from scenegen.geometry.modelling import Modeller


def revolve(
    model: Modeller,
    profile: Sequence[tuple[float, float]],
    slots: Sequence[int],
    semantic: int,
    sides: int = 24,
    sites: int = 6,
) -> None:
    """Turn a profile around the z axis.

    Parameters
    ----------
    model : Modeller
    profile : sequence of (float, float)
        Radius and height [m] of its corners, upwards along the outside.
    slots : sequence of int
        Of each piece of the profile.
    semantic : int
    sides : int
        Around the axis.
    sites : int
        Thermal sites around each piece.
    """
    turn = 2 * np.pi * np.arange(sides) / sides
    around = np.column_stack([np.cos(turn), np.sin(turn)])
    k, after = np.arange(sides), (np.arange(sides) + 1) % sides
    for (r0, z0), (r1, z1), slot in zip(profile[:-1], profile[1:], slots, strict=True):
        ring = np.concatenate(
            [np.column_stack([around * r, np.full(sides, z)]) for r, z in ((r0, z0), (r1, z1))]
        )
        out = np.array([z1 - z0, -(r1 - r0)])
        out = out / np.linalg.norm(out)
        first = -1
        for angle in 2 * np.pi * (np.arange(sites) + 0.5) / sites:
            level = np.array([np.cos(angle), np.sin(angle)])
            place = np.append(level * ((r0 + r1) / 2 + 0.03 * out[0]), (z0 + z1) / 2 + 0.03 * out[1])
            made = model.site(place, np.append(level * out[0], out[1]))
            first = made if first < 0 else first
        faces = np.stack([k, after, after + sides, k + sides], axis=1)[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
        owner = np.repeat(first + (k * sites) // sides, 2)
        model.mesh(ring, faces, slot, semantic, np.repeat(owner[:, None], 3, axis=1))
